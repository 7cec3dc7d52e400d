//! The rigid motion between two sets of points in space, by singular values (Kabsch 1976, Umeyama 1991).

use crate::geometry::{Mat3, Rigid, Vec3, so3};
use nalgebra::Translation3;

/// The motion that brings the points of `src` nearest to those of `dst` in the sense of least squares; `None` for fewer
/// than three, and for points on one line, about which the motion can turn.
///
/// The patent has two pairs fix the motion: they leave the turn about the line through both points open.
#[must_use]
pub fn dst_from_src(dst: &[Vec3], src: &[Vec3]) -> Option<Rigid> {
    /// Points nearer to a line than this part of their length lie on it.
    const LEAST_WIDTH: f64 = 1e-3;
    let num = dst.len().min(src.len());
    if num < 3 {
        return None;
    }
    let (dst, src) = (&dst[..num], &src[..num]);
    #[expect(clippy::cast_precision_loss, reason = "a number of points")]
    let mean = |points: &[Vec3]| points.iter().sum::<Vec3>() / num as f64;
    let (dst_mean, src_mean) = (mean(dst), mean(src));
    let mut covariance = Mat3::zeros();
    let mut spread = Mat3::zeros();
    for (dst, src) in dst.iter().zip(src) {
        let (dst, src) = (dst - dst_mean, src - src_mean);
        covariance += dst * src.transpose();
        spread += src * src.transpose();
    }
    // The two smaller eigenvalues of a symmetric matrix are small together with the sum of its minors.
    let trace = spread.trace();
    let minors = 0.5 * (trace * trace - (spread * spread).trace());
    if minors.is_nan() || minors <= LEAST_WIDTH * LEAST_WIDTH * trace * trace {
        return None;
    }
    let rotation = so3::nearest_rotation(&covariance)?;
    Some(Rigid::from_parts(Translation3::from(dst_mean - rotation * src_mean), rotation))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::stats::SplitMix;

    fn points(count: usize) -> Vec<Vec3> {
        let mut random = SplitMix::new(1);
        let mut value = || f64::from(u32::try_from(random.below(2000)).unwrap_or(0)) - 1000.0;
        (0..count).map(|_| Vec3::new(value(), value(), value() + 2000.0)).collect()
    }

    #[test]
    fn three_points_or_many_give_the_motion_exactly() {
        for (count, angle) in [(3, 0.02), (3, 3.1), (100, 1.0), (100, std::f64::consts::PI)] {
            let src = points(count);
            let motion = Rigid::new(Vec3::new(30.0, -400.0, 7.0), Vec3::new(0.6, -0.64, 0.48) * angle);
            let dst: Vec<Vec3> = src.iter().map(|p| motion.rotation * p + motion.translation.vector).collect();
            let found = dst_from_src(&dst, &src).expect("a motion");
            // Rounding of distances of a few metres.
            assert!((found.translation.vector - motion.translation.vector).norm() < 1e-9, "{found}");
            assert!(found.rotation.angle_to(&motion.rotation) < 1e-12, "{found}");
        }
    }

    #[test]
    fn two_points_and_points_on_a_line_do_not_fix_it() {
        let src = points(2);
        assert_eq!(dst_from_src(&src, &src), None);
        let line: Vec<Vec3> = (0..10).map(|step| src[0] + (src[1] - src[0]) * f64::from(step)).collect();
        assert_eq!(dst_from_src(&line, &line), None);
        assert_eq!(dst_from_src(&[Vec3::zeros(); 5], &[Vec3::zeros(); 5]), None);
        assert_eq!(dst_from_src(&[Vec3::from_element(f64::NAN); 5], &[Vec3::zeros(); 5]), None);
    }
}
