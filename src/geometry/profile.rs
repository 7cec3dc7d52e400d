//! One reading of the laser line: points (x, z) in the plane of the sensor.

use thiserror::Error;

/// Why a list of numbers is not a profile.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum ProfileError {
    /// The two coordinates differ in number.
    #[error("found {num_x} x values and {num_z} z values; a profile needs as many of each")]
    LengthMismatch {
        /// How many x values there are.
        num_x: usize,
        /// How many z values there are.
        num_z: usize,
    },
    /// A coordinate that no profiler measures.
    #[error("found {axis} = {value} mm at point {index}; finite values within ±{limit_mm} mm are needed")]
    OutOfRange {
        /// `x` or `z`.
        axis: char,
        /// Position in the list, from 0.
        index: usize,
        /// The value found.
        value: f64,
        /// The largest size allowed.
        limit_mm: f64,
    },
}

/// One reading of the laser line, in the sensor's plane `y = 0`, mm. A point without a valid range has `z = NaN`.
#[derive(Clone, Debug, Default)]
pub struct Profile {
    x_mm: Vec<f64>,
    z_mm: Vec<f64>,
}

impl Profile {
    /// No profiler sees further than this; anything beyond is a mistake of units or a broken file.
    pub const LIMIT_MM: f64 = 1e5;

    /// From the coordinates across the line and along the range axis; `None` where there is no valid range.
    ///
    /// # Errors
    /// [`ProfileError::LengthMismatch`] and [`ProfileError::OutOfRange`].
    pub fn new(x_mm: Vec<f64>, z_mm: &[Option<f64>]) -> Result<Self, ProfileError> {
        if x_mm.len() != z_mm.len() {
            return Err(ProfileError::LengthMismatch { num_x: x_mm.len(), num_z: z_mm.len() });
        }
        let check = |axis: char, index: usize, value: f64| {
            if value.is_finite() && value.abs() <= Self::LIMIT_MM {
                Ok(())
            } else {
                Err(ProfileError::OutOfRange { axis, index, value, limit_mm: Self::LIMIT_MM })
            }
        };
        for (index, (x, z)) in x_mm.iter().zip(z_mm).enumerate() {
            check('x', index, *x)?;
            if let Some(z) = z {
                check('z', index, *z)?;
            }
        }
        Ok(Self { x_mm, z_mm: z_mm.iter().map(|z| z.unwrap_or(f64::NAN)).collect() })
    }

    /// Number of points, valid or not.
    #[must_use]
    pub fn len(&self) -> usize {
        self.x_mm.len()
    }

    /// Whether the profile has no points at all.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.x_mm.is_empty()
    }

    /// Positions across the line, mm.
    #[must_use]
    pub fn x_mm(&self) -> &[f64] {
        &self.x_mm
    }

    /// Positions along the range axis, mm; NaN where there is no valid point.
    #[must_use]
    pub fn z_mm(&self) -> &[f64] {
        &self.z_mm
    }

    /// The valid points as (index, x, z).
    pub fn valid_points(&self) -> impl Iterator<Item = (usize, f64, f64)> + '_ {
        self.x_mm
            .iter()
            .zip(&self.z_mm)
            .enumerate()
            .filter(|(_, (_, z))| !z.is_nan())
            .map(|(index, (x, z))| (index, *x, *z))
    }
}

/// Equal point by point; missing points are equal to missing points.
impl PartialEq for Profile {
    fn eq(&self, other: &Self) -> bool {
        self.x_mm == other.x_mm
            && self.z_mm.len() == other.z_mm.len()
            && self.z_mm.iter().zip(&other.z_mm).all(|(a, b)| a == b || (a.is_nan() && b.is_nan()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn missing_points_are_skipped() {
        let profile = Profile::new(vec![0.0, 1.0, 2.0], &[Some(5.0), None, Some(6.0)]).expect("valid");
        let points: Vec<_> = profile.valid_points().collect();
        assert_eq!(points, [(0, 0.0, 5.0), (2, 2.0, 6.0)]);
    }

    #[test]
    fn wrong_lengths_and_sizes_are_refused() {
        assert_eq!(Profile::new(vec![0.0], &[]), Err(ProfileError::LengthMismatch { num_x: 1, num_z: 0 }));
        for bad in [f64::NAN, f64::INFINITY, 1e9] {
            let refusal = Profile::new(vec![0.0], &[Some(bad)]);
            assert!(matches!(refusal, Err(ProfileError::OutOfRange { axis: 'z', index: 0, .. })));
        }
    }
}
