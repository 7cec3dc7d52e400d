%%%
  VERSION:1
%%%
MODULE Cell
! the frame of the table
TASK PERS wobjdata wTable:=[FALSE,TRUE,"",[[100,0,50],[0.7071068,0,0,0.7071068]],[[0,0,0],[1,0,0,0]]];
LOCAL VAR robtarget pNone;
PROC main()
  MoveJ [[500,0,300],[0,0,1,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],v100,z10,tool0\WObj:=wTable;
  MoveL [[510,5,300],[0,0.2588190,0.9659258,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],v100,fine,tool0\WObj:=wTable;
ENDPROC
ENDMODULE
