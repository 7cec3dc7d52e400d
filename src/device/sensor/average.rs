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

#[cfg(test)]
mod tests {
    use super::*;
    use rand_core::{RngCore as _, SeedableRng as _};

    fn profile(z_mm: &[Option<f64>]) -> Arc<Profile> {
        let x_mm = (0..z_mm.len()).map(|idx| as_f64(idx) * 0.02).collect();
        Arc::new(Profile::new(x_mm, z_mm).expect("finite"))
    }

    #[test]
    fn points_are_missing_where_less_than_half_are_valid() {
        let profiles = [
            profile(&[Some(1.0), Some(1.0), Some(1.0), Some(1.0), None]),
            profile(&[Some(3.0), Some(3.0), Some(3.0), None, None]),
            profile(&[Some(2.0), Some(2.0), None, None, None]),
            profile(&[Some(6.0), None, None, None, None]),
        ];
        let average = average(&profiles).expect("an average");
        assert_eq!(average.profile, profile(&[Some(3.0), Some(2.0), Some(2.0), None, None]));
        // Only the first column is valid in all: 4 + 0 + 1 + 9 over 3.
        let std_mm = average.repeat_std_mm.expect("repeats");
        assert!((std_mm - (14.0_f64 / 3.0).sqrt()).abs() < 1e-12);
    }

    #[test]
    fn one_profile_is_itself_and_says_nothing_of_noise() {
        let one = profile(&[Some(1.0), None]);
        let alone = average(std::slice::from_ref(&one)).expect("an average");
        assert!(Arc::ptr_eq(&alone.profile, &one) && alone.repeat_std_mm.is_none());
        let never_both = average(&[profile(&[Some(1.0), None]), profile(&[None, Some(1.0)])]).expect("an average");
        assert_eq!(never_both.repeat_std_mm, None);
        assert_eq!(never_both.profile, profile(&[Some(1.0), Some(1.0)]));
    }

    #[test]
    fn other_grids_are_refused() {
        let shifted = Arc::new(Profile::new(vec![0.001, 0.021], &[None, None]).expect("finite"));
        let one = profile(&[None, None]);
        assert_eq!(average(&[]), Err(AverageError::NoProfile));
        for other in [profile(&[None]), shifted] {
            let profiles = [Arc::clone(&one), Arc::clone(&one), other];
            assert_eq!(average(&profiles), Err(AverageError::GridMismatch { profile_idx: 2 }));
        }
    }

    #[test]
    fn the_noise_is_that_of_a_single_point() {
        const STD_MM: f64 = 0.01;
        let mut random = rand_pcg::Pcg64Mcg::seed_from_u64(3);
        // The sum of twelve even numbers has a σ of 1.
        let mut normal = || (0..12).map(|_| f64::from(random.next_u32()) / 4_294_967_296.0).sum::<f64>() - 6.0;
        let profiles: Vec<_> = (0..4)
            .map(|_| profile(&(0..800).map(|idx| Some(as_f64(idx) * 0.01 + STD_MM * normal())).collect::<Vec<_>>()))
            .collect();
        let std_mm = average(&profiles).expect("an average").repeat_std_mm.expect("repeats");
        // 2400 degrees of freedom know a σ to 1.4 %; four times that.
        assert!((std_mm / STD_MM - 1.0).abs() < 0.06, "{std_mm}");
    }
}
