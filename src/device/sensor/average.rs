//! Several profiles of the same scene as one, and the noise of a point by their differences. Pure.

use std::sync::Arc;

use thiserror::Error;

use crate::geometry::Profile;

/// Two points of one column are no further apart along the line than this, mm: far below any pitch, above rounding.
const SAME_X_MM: f64 = 1e-6;

/// Why profiles cannot be put together.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum AverageError {
    /// There are none.
    #[error("found no profile, needed at least one")]
    NoProfile,
    /// They are of different grids.
    #[error(
        "found profiles of different columns along the line (profile {profile_idx} differs from the first), needed the same in all; leave the sensor's settings alone while it measures"
    )]
    GridMismatch {
        /// The first that differs.
        profile_idx: usize,
    },
}

/// Several profiles as one.
#[derive(Clone, Debug, PartialEq)]
pub struct Average {
    /// The mean of the valid points of each column; missing where less than half of them are valid.
    pub profile: Arc<Profile>,
    /// Noise of a point of one profile along z, mm; `None` where no column was valid in all of at least two profiles.
    pub repeat_std_mm: Option<f64>,
}

/// Puts profiles of one grid together.
///
/// The noise is pooled over the columns that are valid in every profile: columns that come and go lie at edges, where the
/// spread is that of the edge.
///
/// # Errors
/// [`AverageError`].
pub fn average(profiles: &[Arc<Profile>]) -> Result<Average, AverageError> {
    let first = profiles.first().ok_or(AverageError::NoProfile)?;
    if let Some(profile_idx) = profiles.iter().position(|profile| !has_same_grid(first, profile)) {
        return Err(AverageError::GridMismatch { profile_idx });
    }
    if profiles.len() == 1 {
        return Ok(Average { profile: Arc::clone(first), repeat_std_mm: None });
    }
    let (mut sum_of_squares, mut num_free) = (0.0, 0);
    let mut z_mm = Vec::with_capacity(first.len());
    for column in 0..first.len() {
        let valid = || profiles.iter().map(|profile| profile.z_mm()[column]).filter(|z| !z.is_nan());
        let num_valid = valid().count();
        if 2 * num_valid < profiles.len() {
            z_mm.push(None);
            continue;
        }
        let mean = valid().sum::<f64>() / as_f64(num_valid);
        z_mm.push(Some(mean));
        if num_valid == profiles.len() {
            sum_of_squares += valid().map(|z| (z - mean).powi(2)).sum::<f64>();
            num_free += num_valid - 1;
        }
    }
    let repeat_std_mm = (num_free > 0).then(|| (sum_of_squares / as_f64(num_free)).sqrt());
    // Means of checked coordinates are within the same limits.
    let profile = Profile::new(first.x_mm().to_vec(), &z_mm).unwrap_or_default();
    Ok(Average { profile: Arc::new(profile), repeat_std_mm })
}

fn has_same_grid(a: &Profile, b: &Profile) -> bool {
    a.len() == b.len() && a.x_mm().iter().zip(b.x_mm()).all(|(a, b)| (a - b).abs() <= SAME_X_MM)
}

#[expect(clippy::cast_precision_loss, reason = "profiles and their columns are counted in thousands")]
const fn as_f64(count: usize) -> f64 {
    count as f64
}
