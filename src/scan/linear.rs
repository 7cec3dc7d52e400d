//! Linear least squares, trimmed, with a covariance from how whole profiles scatter.

use nalgebra::{SMatrix, SVector};

use crate::geometry::stats::{STD_OVER_MAD, median};

/// Points farther off than this many σ are of something else.
const TRIM_AT_STD: f64 = 3.5;
/// Passes of trimming.
const MAX_PASSES: usize = 12;
/// Below this nothing is trimmed, mm.
const RESOLUTION_MM: f64 = 1e-6;

/// One point: `terms · solution` should be `value`.
#[derive(Clone, Debug)]
pub(super) struct Row<const N: usize> {
    pub(super) terms: SVector<f64, N>,
    pub(super) value: f64,
    pub(super) profile: u32,
}

/// The solution, and what is known of it.
#[derive(Clone, Debug)]
pub(super) struct Linear<const N: usize> {
    pub(super) solution: SVector<f64, N>,
    pub(super) covariance: SMatrix<f64, N, N>,
    /// Root mean square of what is left over by the points used.
    pub(super) rms: f64,
    pub(super) num_used: usize,
    /// Profiles that hold them.
    pub(super) num_profiles: usize,
    /// Whether the covariance tells how whole profiles scatter, or takes every point for itself: few profiles do not tell.
    pub(super) is_from_profiles: bool,
}

/// Solves; `None` where the rows do not determine a solution.
#[expect(clippy::cast_precision_loss, reason = "counts of points")]
pub(super) fn solve<const N: usize>(rows: &[Row<N>]) -> Option<Linear<N>> {
    let mut limit = f64::INFINITY;
    let mut solution = SVector::zeros();
    let mut num_used = 0;
    let left_over = |row: &Row<N>, solution: &SVector<f64, N>| row.value - row.terms.dot(solution);
    let mut inverse = SMatrix::zeros();
    for _ in 0..MAX_PASSES {
        let (mut normal, mut right, mut num) = (SMatrix::<f64, N, N>::zeros(), SVector::zeros(), 0);
        for row in rows.iter().filter(|row| left_over(row, &solution).abs() <= limit) {
            normal += row.terms * row.terms.transpose();
            right += row.terms * row.value;
            num += 1;
        }
        if num <= N {
            return None;
        }
        inverse = normal.cholesky()?.inverse();
        solution = inverse * right;
        if num == num_used {
            break;
        }
        num_used = num;
        let mut sizes: Vec<f64> = rows.iter().map(|row| left_over(row, &solution).abs()).collect();
        limit = TRIM_AT_STD * (STD_OVER_MAD * median(&mut sizes)).max(RESOLUTION_MM);
    }
    let used = || rows.iter().filter(|row| left_over(row, &solution).abs() <= limit);
    let squares: f64 = used().map(|row| left_over(row, &solution).powi(2)).sum();
    let mut scores: Vec<(u32, SVector<f64, N>)> =
        used().map(|row| (row.profile, row.terms * left_over(row, &solution))).collect();
    scores.sort_by_key(|(profile, _)| *profile);
    let num_left = scores.len();
    let profiles = || scores.chunk_by(|a, b| a.0 == b.0);
    let num_profiles = profiles().count();
    let is_from_profiles = num_profiles > N + 3;
    let covariance = if is_from_profiles {
        let factor = num_profiles as f64 / (num_profiles - N) as f64;
        profiles()
            .map(|profile| inverse * profile.iter().fold(SVector::<f64, N>::zeros(), |sum, (_, score)| sum + score))
            .fold(SMatrix::zeros(), |sum, influence| sum + influence * influence.transpose() * factor)
    } else {
        inverse * (squares / (num_left.saturating_sub(N)).max(1) as f64)
    };
    Some(Linear {
        solution,
        covariance,
        rms: (squares / num_left.max(1) as f64).sqrt(),
        num_used: num_left,
        num_profiles,
        is_from_profiles,
    })
}

/// Variance of whole profiles about the mean of their group, from many groups of (profile, value) with few profiles each;
/// `None` where no group has two.
#[expect(clippy::cast_precision_loss, reason = "counts of profiles")]
pub(super) fn pooled_scatter(groups: impl IntoIterator<Item = Vec<(u32, f64)>>) -> Option<f64> {
    let (mut squares, mut freedom) = (0.0, 0);
    for mut group in groups {
        group.sort_by_key(|(profile, _)| *profile);
        let middles: Vec<f64> = group
            .chunk_by(|a, b| a.0 == b.0)
            .map(|profile| median(&mut profile.iter().map(|(_, value)| *value).collect::<Vec<_>>()))
            .collect();
        let mean = middles.iter().sum::<f64>() / middles.len().max(1) as f64;
        squares += middles.iter().map(|middle| (middle - mean).powi(2)).sum::<f64>();
        freedom += middles.len().saturating_sub(1);
    }
    (freedom > 0).then(|| squares / freedom as f64)
}

#[cfg(test)]
mod tests {
    use nalgebra::vector;

    use super::*;

    #[test]
    fn wild_points_are_trimmed() {
        let rows: Vec<Row<2>> = (0..60_u32)
            .map(|idx| {
                let x = f64::from(idx);
                let noise = if idx % 2 == 0 { 0.01 } else { -0.01 };
                let wild = if idx % 12 == 5 { 7.0 } else { 0.0 };
                Row { terms: vector![1.0, x], value: 3.0 + 0.5 * x + noise + wild, profile: idx / 3 }
            })
            .collect();
        let fit = solve(&rows).expect("two unknowns");
        assert!((fit.solution - vector![3.0, 0.5]).amax() < 0.01, "{}", fit.solution);
        assert_eq!(fit.num_used, 55);
        assert!(fit.rms < 0.011);
        assert!(solve(&rows[..2]).is_none());
    }
}
