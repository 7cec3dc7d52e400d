//! The ball's arc in a real profile: robust search, trimmed fit, and a reason where there is none.

use crate::geometry::stats::robust_std_about_zero;
use crate::geometry::{Mat3, Profile};

use super::ransac::{CircleSearch, find_circle};
use super::{ArcRefusal, Circle, CircleFit, FitError, algebraic, robust};

/// What is known before looking at a profile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArcOptions {
    /// The ball's radius, mm: no section is larger.
    pub ball_radius_mm: f64,
    /// Noise of a point along the range axis, mm, where known; estimated otherwise.
    pub profile_std_mm: Option<f64>,
}

/// What a point of a profile was taken for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PointClass {
    /// No valid range.
    Missing,
    /// On the arc, and used.
    Inlier,
    /// Near the arc's span but off the circle, or on its biased flanks: left out.
    Outlier,
    /// Elsewhere: table, background.
    Unused,
}

/// The ball's section in the laser plane.
#[derive(Clone, Debug, PartialEq)]
pub struct ArcFit {
    /// Centre (x1, z1) and radius l of the section, mm.
    pub circle: Circle,
    /// Covariance of (x1, z1, l), mm².
    pub covariance: Mat3,
    /// Estimated noise of a point across the circle, mm.
    pub point_std_mm: f64,
    /// Root mean square distance of the inliers, mm.
    pub rms_mm: f64,
    /// Angle that the inliers span, seen from the centre, rad.
    pub angle_rad: f64,
    /// One class a point of the profile.
    pub classes: Vec<PointClass>,
    /// The inliers' positions across the line, mm.
    pub inlier_x_mm: Vec<f64>,
    /// The inliers' positions along the range axis, mm.
    pub inlier_z_mm: Vec<f64>,
}

impl ArcFit {
    /// Standard deviations of (x1, z1, l), mm.
    #[must_use]
    pub fn std_mm(&self) -> [f64; 3] {
        [0, 1, 2].map(|idx| self.covariance[(idx, idx)].max(0.0).sqrt())
    }

    /// Number of points on the arc.
    #[must_use]
    pub fn num_inliers(&self) -> usize {
        self.inlier_x_mm.len()
    }
}

/// Fewer points than this make no arc.
const MIN_POINTS: usize = 8;
/// Arcs shorter than this say next to nothing about where their centre is.
const MIN_ANGLE_DEG: f64 = 20.0;
/// Sections above the ball's radius by up to this part are taken for noise: kept, flagged later.
const RADIUS_EXCESS: f64 = 0.05;
/// Sections smaller than this part of the ball's radius are more likely something else.
const MIN_RADIUS_PART: f64 = 0.15;
/// The search takes points within this part of the radius, or four standard deviations of the noise, whichever is more.
const SEARCH_TOLERANCE_PART: f64 = 0.002;
/// How far beside the centre points are used, as parts of the radius: up to an incidence of 70°, where the light grazes the
/// ball, and, where the flanks prove to be biased, of 60°, 50° or 40°.
const FLANK_PARTS: [f64; 4] = [0.94, 0.87, 0.77, 0.64];
/// Fits with and without the outer flanks that differ by more than this many standard deviations tell of a bias.
const BIASED_AT_STDS: f64 = 3.0;
/// If this part of the points agrees with a fit to all of them, nothing but the ball is in view.
const ONLY_BALL_PART: f64 = 0.9;

/// Finds the ball's arc in a profile: random search → consensus → trimmed orthogonal fit.
///
/// The arc may be convex towards either side of the range axis, and x may fall as well as rise. Beside the ball there may
/// be a table; there may be holes, spikes and biased flanks.
///
/// # Frame and units
/// Laser plane of the sensor, mm.
///
/// # Errors
/// [`ArcRefusal`], with the reason in words.
pub fn extract_arc(profile: &Profile, options: &ArcOptions) -> Result<ArcFit, ArcRefusal> {
    let (mut x_mm, mut z_mm) = (Vec::with_capacity(profile.len()), Vec::with_capacity(profile.len()));
    for (_, x, z) in profile.valid_points() {
        x_mm.push(x);
        z_mm.push(z);
    }
    if x_mm.len() < MIN_POINTS {
        return Err(ArcRefusal::TooFewPoints { found: x_mm.len(), needed: MIN_POINTS });
    }
    let noise_mm = options.profile_std_mm.unwrap_or_else(|| local_noise(&z_mm));
    let tolerance_mm = (4.0 * noise_mm).max(SEARCH_TOLERANCE_PART * options.ball_radius_mm);
    let limit_mm = (1.0 + RADIUS_EXCESS) * options.ball_radius_mm;
    let start = if let Some(circle) = only_ball(&x_mm, &z_mm, limit_mm, tolerance_mm) {
        circle
    } else {
        search(&x_mm, &z_mm, options, limit_mm, tolerance_mm)?
    };
    let (near_x, near_z) = near(&x_mm, &z_mm, start, 3.0 * tolerance_mm);
    let (coarse, _) = robust::fit_from(&near_x, &near_z, start)?;
    let (fit, kept) = fit_without_biased_flanks(&near_x, &near_z, coarse.circle)
        .ok_or(ArcRefusal::NoArc { limit_mm, num_points: x_mm.len() })??;
    finish(profile, options, limit_mm, &fit, kept)
}

/// The fit to the widest part of the arc whose flanks agree with its middle; `None` if hardly a point is left.
///
/// The wider fit is the better one unless the flanks are biased; the narrower one is worse but unbiased. Without bias their
/// difference has the variance of the one minus that of the other (Hausman 1978), so a larger one tells.
fn fit_without_biased_flanks(
    x_mm: &[f64],
    z_mm: &[f64],
    start: Circle,
) -> Option<Result<(CircleFit, robust::Kept), FitError>> {
    let fit_within = |part: f64| {
        let (front_x, front_z) = within_flanks(x_mm, z_mm, start, part);
        (front_x.len() >= MIN_POINTS).then(|| (front_x.len(), robust::fit_from(&front_x, &front_z, start)))
    };
    let (mut num_points, widest) = fit_within(FLANK_PARTS[0])?;
    let mut wide = match widest {
        Ok(wide) => wide,
        Err(error) => return Some(Err(error)),
    };
    for part in &FLANK_PARTS[1..] {
        let Some((num_narrow, Ok(narrow))) = fit_within(*part) else { break };
        if num_narrow == num_points || agree(&wide.0, &narrow.0) {
            break;
        }
        (num_points, wide) = (num_narrow, narrow);
    }
    Some(Ok(wide))
}

/// Whether the radii and the centres along the range differ no more than noise lets them.
fn agree(wide: &CircleFit, narrow: &CircleFit) -> bool {
    let within = |difference: f64, idx: usize| {
        let variance = narrow.covariance[(idx, idx)];
        let expected = (variance - wide.covariance[(idx, idx)]).max(0.1 * variance).sqrt();
        // Neighbouring points of a real sensor err together, so their fits scatter more than their covariance says: a
        // difference below twice the noise of a point is no reason to give points up.
        difference.abs() <= (BIASED_AT_STDS * expected).max(2.0 * wide.rms_mm)
    };
    within(wide.circle.radius_mm - narrow.circle.radius_mm, 2) && within(wide.circle.z_mm - narrow.circle.z_mm, 1)
}

/// The circle of a profile that shows the ball and nothing else, found without a search.
fn only_ball(x_mm: &[f64], z_mm: &[f64], limit_mm: f64, tolerance_mm: f64) -> Option<Circle> {
    let circle = algebraic::hyper(x_mm, z_mm).ok()?;
    let num_near = x_mm.iter().zip(z_mm).filter(|(x, z)| circle.distance_mm(**x, **z).abs() <= tolerance_mm).count();
    #[expect(clippy::cast_precision_loss, reason = "a part of the number of points")]
    let part = num_near as f64 / x_mm.len() as f64;
    (circle.radius_mm <= limit_mm && part >= ONLY_BALL_PART).then_some(circle)
}

fn search(
    x_mm: &[f64],
    z_mm: &[f64],
    options: &ArcOptions,
    limit_mm: f64,
    tolerance_mm: f64,
) -> Result<Circle, ArcRefusal> {
    let within = |max_radius_mm: f64| {
        let search =
            CircleSearch { min_radius_mm: MIN_RADIUS_PART * options.ball_radius_mm, max_radius_mm, tolerance_mm };
        #[expect(clippy::cast_precision_loss, reason = "a profile has far fewer than 2^52 points")]
        let needed_part = MIN_POINTS as f64 / x_mm.len() as f64;
        find_circle(x_mm, z_mm, &search).filter(|(_, part)| *part >= needed_part.max(0.05))
    };
    let found = within(limit_mm);
    // An arc of a larger ball shows as a wrong radius in the session, so look for one before giving a poor answer.
    let larger = within(2.0 * options.ball_radius_mm).filter(|(circle, part)| {
        circle.radius_mm > limit_mm && *part > 0.3 && found.is_none_or(|(_, found_part)| *part > 1.5 * found_part)
    });
    if let Some((circle, _)) = larger {
        let (near_x, near_z) = near(x_mm, z_mm, circle, 3.0 * tolerance_mm);
        let (fit, _) = robust::fit_from(&near_x, &near_z, circle)?;
        if fit.circle.radius_mm > limit_mm && fit.circle.radius_mm < 2.0 * options.ball_radius_mm {
            return Err(ArcRefusal::LargerThanBall {
                found_mm: fit.circle.radius_mm,
                ball_radius_mm: options.ball_radius_mm,
            });
        }
    }
    found.map(|(circle, _)| circle).ok_or(ArcRefusal::NoArc { limit_mm, num_points: x_mm.len() })
}

/// Noise along the range axis from second differences, to which the shape of the ball adds next to nothing.
fn local_noise(z_mm: &[f64]) -> f64 {
    let mut differences: Vec<f64> = z_mm.windows(3).map(|z| (z[0] - 2.0 * z[1] + z[2]) / 6.0_f64.sqrt()).collect();
    if differences.is_empty() { 0.0 } else { robust_std_about_zero(&mut differences) }
}

fn near(x_mm: &[f64], z_mm: &[f64], circle: Circle, distance_mm: f64) -> (Vec<f64>, Vec<f64>) {
    x_mm.iter().zip(z_mm).filter(|(x, z)| circle.distance_mm(**x, **z).abs() <= distance_mm).unzip()
}

fn within_flanks(x_mm: &[f64], z_mm: &[f64], circle: Circle, part: f64) -> (Vec<f64>, Vec<f64>) {
    x_mm.iter().zip(z_mm).filter(|(x, _)| (**x - circle.x_mm).abs() <= part * circle.radius_mm).unzip()
}

fn finish(
    profile: &Profile,
    options: &ArcOptions,
    limit_mm: f64,
    fit: &CircleFit,
    kept: robust::Kept,
) -> Result<ArcFit, ArcRefusal> {
    let circle = fit.circle;
    if kept.x_mm.len() < MIN_POINTS {
        return Err(ArcRefusal::TooFewPoints { found: kept.x_mm.len(), needed: MIN_POINTS });
    }
    if circle.radius_mm > limit_mm {
        return Err(ArcRefusal::LargerThanBall { found_mm: circle.radius_mm, ball_radius_mm: options.ball_radius_mm });
    }
    let angle_rad = spanned_angle(&kept, circle);
    if angle_rad.to_degrees() < MIN_ANGLE_DEG {
        return Err(ArcRefusal::TooShort { found_deg: angle_rad.to_degrees(), needed_deg: MIN_ANGLE_DEG });
    }
    #[expect(clippy::cast_precision_loss, reason = "a profile has far fewer than 2^52 points")]
    let (count, freedom) = (kept.x_mm.len() as f64, (kept.x_mm.len() - 3) as f64);
    Ok(ArcFit {
        circle,
        covariance: fit.covariance,
        point_std_mm: fit.rms_mm * (count / freedom).sqrt(),
        rms_mm: fit.rms_mm,
        angle_rad,
        classes: classify(profile, &kept),
        inlier_x_mm: kept.x_mm,
        inlier_z_mm: kept.z_mm,
    })
}

/// The angle that the points span, seen from the centre. It is below a full turn, as the back of a ball is never seen.
fn spanned_angle(points: &robust::Kept, circle: Circle) -> f64 {
    let (mut toward_x, mut toward_z) = (0.0, 0.0);
    for (x, z) in points.x_mm.iter().zip(&points.z_mm) {
        toward_x += x - circle.x_mm;
        toward_z += z - circle.z_mm;
    }
    let (mut least, mut most) = (0.0_f64, 0.0_f64);
    for (x, z) in points.x_mm.iter().zip(&points.z_mm) {
        let (dx, dz) = (x - circle.x_mm, z - circle.z_mm);
        let angle = (toward_x * dz - toward_z * dx).atan2(toward_x * dx + toward_z * dz);
        least = least.min(angle);
        most = most.max(angle);
    }
    most - least
}

/// The inliers are a subsequence of the valid points, so one walk along both tells them apart.
fn classify(profile: &Profile, kept: &robust::Kept) -> Vec<PointClass> {
    let mut classes = vec![PointClass::Missing; profile.len()];
    let mut next_kept = 0;
    for (idx, x, z) in profile.valid_points() {
        // Copies of the same numbers, so equal bit by bit.
        let is_kept = next_kept < kept.x_mm.len()
            && kept.x_mm[next_kept].to_bits() == x.to_bits()
            && kept.z_mm[next_kept].to_bits() == z.to_bits();
        next_kept += usize::from(is_kept);
        classes[idx] = if is_kept { PointClass::Inlier } else { PointClass::Unused };
    }
    let first = classes.iter().position(|class| *class == PointClass::Inlier);
    let last = classes.iter().rposition(|class| *class == PointClass::Inlier);
    if let (Some(first), Some(last)) = (first, last) {
        for class in &mut classes[first..=last] {
            if *class == PointClass::Unused {
                *class = PointClass::Outlier;
            }
        }
    }
    classes
}
