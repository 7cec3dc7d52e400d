pub fn solve(_p:&crate::calibrate::BallProblem)->Result<crate::calibrate::Solution,crate::calibrate::SolveError>{Err(crate::calibrate::SolveError::Diverged)}
