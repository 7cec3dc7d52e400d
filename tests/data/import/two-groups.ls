/PROG  TWO
/POS
P[1]{
   GP1:
	UF : 2, UT : 3,		CONFIG : 'F U T, 0, 0, 0',
	X =   100.000  mm,	Y =   -20.000  mm,	Z =    30.000  mm,
	W =  -179.000 deg,	P =     0.000 deg,	R =    10.000 deg
   GP2:
	UF : 0, UT : 1,
	J1=     5.000  mm
};
P[2]{
   GP1:
	UF : 2, UT : 3,
	J1=    10.000 deg,	J2=    20.000 deg,	J3=   -30.000 deg,
	J4=     0.000 deg,	J5=   -60.000 deg,	J6=     0.000 deg
};
/END
