/// x
/// # Errors
/// x
pub fn kasa(_x:&[f64],_z:&[f64])->Result<super::Circle,super::FitError>{Err(super::FitError::Collinear)}
/// x
/// # Errors
/// x
pub fn pratt(_x:&[f64],_z:&[f64])->Result<super::Circle,super::FitError>{Err(super::FitError::Collinear)}
/// x
/// # Errors
/// x
pub fn taubin(_x:&[f64],_z:&[f64])->Result<super::Circle,super::FitError>{Err(super::FitError::Collinear)}
/// x
/// # Errors
/// x
pub fn hyper(_x:&[f64],_z:&[f64])->Result<super::Circle,super::FitError>{Err(super::FitError::Collinear)}
