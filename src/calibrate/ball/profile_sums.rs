//! All points of a profile reduced to ten sums: its residuals depend on the nine unknowns only through the ball's centre
//! in the sensor frame.

use crate::fit::ArcFit;
use crate::fit::sums::sum_over;
use crate::geometry::{Mat3, Vec3};

/// Sums over the inliers of a profile for r = |p − s| − R.
#[derive(Clone, Copy, Debug)]
pub(super) struct ProfileSums {
    /// Σ u uᵀ with u = (p − s)/|p − s|.
    pub information: Mat3,
    /// Σ u r: half the negative gradient of the cost by s.
    pub pull: Vec3,
    /// Σ r².
    pub cost: f64,
}

/// One pass over the points of a profile for a ball centred at `centre` in the sensor frame.
pub(super) fn profile_sums(arc: &ArcFit, centre: Vec3, ball_radius_mm: f64) -> ProfileSums {
    // Of u = (dx, −y, dz)/d the middle part is −y/d: its sums follow from those of 1/d.
    let sums = sum_over(&arc.inlier_x_mm, &arc.inlier_z_mm, |x, z| {
        terms(x - centre.x, z - centre.z, centre.y, ball_radius_mm)
    });
    let [uu, uw, ww, u_inverse, w_inverse, inverse_squared, ur, wr, inverse_r, cost] = sums;
    let y = -centre.y;
    let (uv, vw, vv, vr) = (y * u_inverse, y * w_inverse, y * y * inverse_squared, y * inverse_r);
    ProfileSums { information: Mat3::new(uu, uv, uw, uv, vv, vw, uw, vw, ww), pull: Vec3::new(ur, vr, wr), cost }
}

#[inline]
fn terms(dx: f64, dz: f64, y: f64, ball_radius_mm: f64) -> [f64; 10] {
    let squared = dx * dx + dz * dz + y * y;
    let inverse = 1.0 / squared.sqrt();
    let residual = squared * inverse - ball_radius_mm;
    let (u, w) = (dx * inverse, dz * inverse);
    [
        u * u,
        u * w,
        w * w,
        u * inverse,
        w * inverse,
        inverse * inverse,
        u * residual,
        w * residual,
        inverse * residual,
        residual * residual,
    ]
}
