//! Circle fits that minimise the circle's equation: closed up to one root of a polynomial, so they need no start.
//!
//! All four minimise the same algebraic distance and differ in the constraint that fixes the scale of the equation.
//!
//! # Source
//! N. Chernov, "Circular and linear regression", 2010, chapter 5, for the normalisations; the root is found by Newton's
//! method from zero, which converges from below to the smallest one (theorem 5.4 there).

use super::sums::sum_over;
use super::{Circle, FitError};

/// Second and mixed moments of the points about their mean, with w = x² + z².
struct Moments {
    mean_x: f64,
    mean_z: f64,
    xx: f64,
    xz: f64,
    zz: f64,
    xw: f64,
    zw: f64,
    ww: f64,
}

/// Least squares of the equation itself (Kåsa 1976). On short arcs it shrinks the circle.
///
/// # Errors
/// [`FitError::TooFewPoints`] below 3, [`FitError::Collinear`] if the points do not bend.
pub fn kasa(x_mm: &[f64], z_mm: &[f64]) -> Result<Circle, FitError> {
    let m = moments(x_mm, z_mm)?;
    circle_at(&m, 0.0, 0.0)
}

/// Pratt's fit (1987): the gradient of the equation has unit length on the circle.
///
/// # Errors
/// As [`kasa`].
pub fn pratt(x_mm: &[f64], z_mm: &[f64]) -> Result<Circle, FitError> {
    let m = moments(x_mm, z_mm)?;
    let root = smallest_root(&m, Normalisation::Pratt);
    circle_at(&m, root, 2.0 * root)
}

/// Taubin's fit (IEEE PAMI 13(11), 1991): the gradient has unit length in the mean over the points.
///
/// # Errors
/// As [`kasa`].
pub fn taubin(x_mm: &[f64], z_mm: &[f64]) -> Result<Circle, FitError> {
    let m = moments(x_mm, z_mm)?;
    let root = smallest_root(&m, Normalisation::Taubin);
    circle_at(&m, root, 0.0)
}

/// Al-Sharadqah and Chernov's "hyper" (2009): no essential bias, the best start for an orthogonal fit.
///
/// # Errors
/// As [`kasa`].
pub fn hyper(x_mm: &[f64], z_mm: &[f64]) -> Result<Circle, FitError> {
    let m = moments(x_mm, z_mm)?;
    let root = smallest_root(&m, Normalisation::Pratt);
    circle_at(&m, root, -2.0 * root)
}

fn moments(x_mm: &[f64], z_mm: &[f64]) -> Result<Moments, FitError> {
    let num_points = x_mm.len().min(z_mm.len());
    if num_points < 3 {
        return Err(FitError::TooFewPoints { found: num_points, needed: 3 });
    }
    #[expect(clippy::cast_precision_loss, reason = "a profile has far fewer than 2^52 points")]
    let scale = 1.0 / num_points as f64;
    let [sum_x, sum_z] = sum_over(x_mm, z_mm, |x, z| [x, z]);
    let (mean_x, mean_z) = (sum_x * scale, sum_z * scale);
    let sums = sum_over(x_mm, z_mm, |x, z| {
        let (x, z) = (x - mean_x, z - mean_z);
        let w = x * x + z * z;
        [x * x, x * z, z * z, x * w, z * w, w * w]
    });
    let [xx, xz, zz, xw, zw, ww] = sums.map(|sum| sum * scale);
    Ok(Moments { mean_x, mean_z, xx, xz, zz, xw, zw, ww })
}

#[derive(Clone, Copy, PartialEq)]
enum Normalisation {
    Pratt,
    Taubin,
}

/// The smallest non-negative root of the characteristic polynomial.
fn smallest_root(m: &Moments, normalisation: Normalisation) -> f64 {
    let w = m.xx + m.zz;
    let det = m.xx * m.zz - m.xz * m.xz;
    let var_w = m.ww - w * w;
    let a0 = m.xw * (m.xw * m.zz - m.zw * m.xz) + m.zw * (m.zw * m.xx - m.xw * m.xz) - var_w * det;
    let a1 = var_w * w + 4.0 * det * w - m.xw * m.xw - m.zw * m.zw;
    let (a2, a3, a4) = match normalisation {
        Normalisation::Pratt => (4.0 * det - 3.0 * w * w - m.ww, 0.0, 4.0),
        Normalisation::Taubin => (-3.0 * w * w - m.ww, 4.0 * w, 0.0),
    };
    let mut root = 0.0_f64;
    let mut value = a0;
    for _ in 0..50 {
        let slope = a1 + root * (2.0 * a2 + root * (3.0 * a3 + root * 4.0 * a4));
        let next = root - value / slope;
        let next_value = a0 + next * (a1 + next * (a2 + next * (a3 + next * a4)));
        // Past the rounding floor the value grows again: the last root stands.
        if !next.is_finite() || next_value.abs() >= value.abs() {
            break;
        }
        root = next;
        value = next_value;
    }
    root.max(0.0)
}

fn circle_at(m: &Moments, root: f64, radius_term: f64) -> Result<Circle, FitError> {
    /// Determinant over squared spread of points on a line, up to rounding; an arc of 0.1° is at 1e-7.
    const FLAT: f64 = 1e-13;
    let w = m.xx + m.zz;
    let bend = m.xx * m.zz - m.xz * m.xz;
    let det = root * root - root * w + bend;
    // Not `<=`: NaN must land here too.
    if !(bend > FLAT * w * w && det != 0.0) {
        return Err(FitError::Collinear);
    }
    let x = (m.xw * (m.zz - root) - m.zw * m.xz) / (2.0 * det);
    let z = (m.zw * (m.xx - root) - m.xw * m.xz) / (2.0 * det);
    let radius_mm = (x * x + z * z + w + radius_term).sqrt();
    if !(x.is_finite() && z.is_finite() && radius_mm.is_finite()) {
        return Err(FitError::Diverged);
    }
    Ok(Circle { x_mm: x + m.mean_x, z_mm: z + m.mean_z, radius_mm })
}
