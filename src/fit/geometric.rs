pub fn fit(_x:&[f64],_z:&[f64],_s:super::Circle)->Result<super::CircleFit,super::FitError>{Err(super::FitError::Collinear)}
