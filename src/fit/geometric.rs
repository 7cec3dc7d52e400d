//! Circle fit by orthogonal distances: the maximum-likelihood fit for equal noise across the circle.

use crate::geometry::{Mat3, Vec3};

use super::sums::sum_over;
use super::{Circle, CircleFit, FitError};

/// Gauss–Newton gains a factor noise/radius a step, so it needs three or four; more means that it wanders.
const MAX_ITERATIONS: usize = 40;
/// A step below this part of the radius changes nothing that a profiler could see.
const SETTLED: f64 = 1e-12;

/// Sums of one pass over the points.
struct Normal {
    matrix: Mat3,
    gradient: Vec3,
    cost: f64,
}

/// Minimises the squared distances to the circle from a start, by damped Gauss–Newton.
///
/// # Frame and units
/// Points and circle in the laser plane, mm.
///
/// # Errors
/// [`FitError::TooFewPoints`] below 3, [`FitError::Diverged`] if no finite circle is found.
pub fn fit(x_mm: &[f64], z_mm: &[f64], start: Circle) -> Result<CircleFit, FitError> {
    let num_points = x_mm.len().min(z_mm.len());
    if num_points < 3 {
        return Err(FitError::TooFewPoints { found: num_points, needed: 3 });
    }
    let mut circle = start;
    let mut normal = normal_equations(x_mm, z_mm, circle);
    let mut damping = 0.0;
    for _ in 0..MAX_ITERATIONS {
        let damped = normal.matrix + Mat3::from_diagonal(&(normal.matrix.diagonal() * damping));
        let Some(step) = damped.cholesky().map(|factor| -factor.solve(&normal.gradient)) else {
            damping = (10.0 * damping).max(1e-6);
            if damping > 1e6 {
                return Err(FitError::Diverged);
            }
            continue;
        };
        let trial =
            Circle { x_mm: circle.x_mm + step.x, z_mm: circle.z_mm + step.y, radius_mm: circle.radius_mm + step.z };
        let small = step.norm() <= SETTLED * circle.radius_mm.abs();
        // The cost predicted at the minimum of the quadratic: with a step this small another pass would tell nothing new.
        let negligible = step.dot(&normal.gradient).abs() <= 1e-9 * normal.cost && damping <= 0.0;
        if small || negligible {
            circle = trial;
            break;
        }
        let trial_normal = normal_equations(x_mm, z_mm, trial);
        if trial_normal.cost <= normal.cost {
            circle = trial;
            normal = trial_normal;
            damping *= 0.1;
        } else {
            damping = (10.0 * damping).max(1e-6);
            if damping > 1e6 {
                break;
            }
        }
    }
    finish(circle, &normal, num_points)
}

fn finish(circle: Circle, normal: &Normal, num_points: usize) -> Result<CircleFit, FitError> {
    #[expect(clippy::cast_precision_loss, reason = "a profile has far fewer than 2^52 points")]
    let (count, freedom) = (num_points as f64, num_points.saturating_sub(3).max(1) as f64);
    let covariance = normal.matrix.try_inverse().map(|inverse| inverse * (normal.cost / freedom));
    match covariance {
        Some(covariance) if circle.radius_mm.is_finite() && covariance.iter().all(|v| v.is_finite()) => {
            Ok(CircleFit { circle, covariance, rms_mm: (normal.cost / count).sqrt() })
        }
        _ => Err(FitError::Diverged),
    }
}

/// One pass: `JᵀJ`, Jᵀr and the cost for r = distance from the centre − radius.
fn normal_equations(x_mm: &[f64], z_mm: &[f64], circle: Circle) -> Normal {
    let [uu, uv, vv, u, v, ur, vr, r, rr] = sum_over(x_mm, z_mm, |x, z| {
        let (dx, dz) = (x - circle.x_mm, z - circle.z_mm);
        let squared = dx * dx + dz * dz;
        let inverse = 1.0 / squared.sqrt();
        let residual = squared * inverse - circle.radius_mm;
        let (u, v) = (dx * inverse, dz * inverse);
        [u * u, u * v, v * v, u, v, u * residual, v * residual, residual, residual * residual]
    });
    #[expect(clippy::cast_precision_loss, reason = "a profile has far fewer than 2^52 points")]
    let count = x_mm.len() as f64;
    Normal {
        // The Jacobian's rows are (−u, −v, −1).
        matrix: Mat3::new(uu, uv, u, uv, vv, v, u, v, count),
        gradient: -Vec3::new(ur, vr, r),
        cost: rr,
    }
}
