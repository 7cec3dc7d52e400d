//! What a calibration is worth on other data than its own: distances to lines and planes, a touched point, other targets
//! (Chen et al. 2023, section 4).
