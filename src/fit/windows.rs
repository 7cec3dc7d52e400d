//! What the seeded searches for circles and for lines share: the points that a hypothesis is scored on, and the windows of
//! neighbours that it is drawn from.

/// Every so-many-th of the first `num_points` values, so that about `most` are left.
pub(super) fn thinned(values: &[f64], num_points: usize, most: usize) -> Vec<f64> {
    values.iter().copied().step_by(num_points.div_ceil(most).max(1)).collect()
}

/// A part of the number of points, from 1 to `most`.
#[expect(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a part of the number of points"
)]
pub(super) fn width(num_points: usize, part: f64, most: usize) -> usize {
    ((num_points as f64 * part) as usize).clamp(1, most)
}
