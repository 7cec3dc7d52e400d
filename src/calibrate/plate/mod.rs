//! Methods for the right-angle plate (Chen et al. 2023, section 3, and ours).
//!
//! `plate-orthogonal` is the published one, `plate-bundle` ours. Both begin at the operator's rough mounting or at many
//! orientations, and end in the same form: the sensor on the flange and the plate in the base, with the points on its
//! edges.

pub mod descent;
pub mod nine_elements;
pub mod orthogonal;
pub mod points;

mod assemble;
mod bundle;
mod measured;
mod noise;
mod refit;
mod start;

pub(crate) use noise::of_pose;
pub use points::{EdgePoint, PlateState};
pub use refit::{PlateReduced, PlateRefit};

use crate::geometry::Rigid;

use super::{AboveStated, Method, PlateProblem, Solution, SolveError, Starts, Warning};
use assemble::Found;
use bundle::Settled;
use measured::measured;
use noise::PlateNoise;
use points::EdgePoint as Point;

/// From so many points an edge on the figures are worth believing (Chen et al. 2023, section 3).
pub const RECOMMENDED_POINTS: usize = 6;
/// Starts that end this near to each other (rad, mm/100) have ended in one minimum.
const SAME_MINIMUM: f64 = 1e-5;
/// A minimum with a residual (RMS) this many times that of the best fits about as well.
const ABOUT_EQUAL: f64 = 2.0;

/// Solves by one of [`Method::PLATE`].
///
/// # Errors
/// [`SolveError`] if nothing can be computed from this problem.
pub fn solve(problem: &PlateProblem, method: Method) -> Result<Solution, SolveError> {
    let (measured, poses) = measured(problem)?;
    let points: Vec<Point> = measured.iter().map(|measured| measured.point).collect();
    let starts = start::starts(problem);
    let is_published = method == Method::PlateOrthogonal;
    let mut minima: Vec<Candidate> = starts
        .iter()
        .filter_map(|start| if is_published { published_at(&points, start) } else { bundle_at(&points, start) })
        .collect();
    minima.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    let best = *minima.first().ok_or(SolveError::Diverged)?;
    let is_same =
        |candidate: &&Candidate| apart(&candidate.flange_from_sensor, &best.flange_from_sensor) < SAME_MINIMUM;
    let agreed = Starts { num_tried: starts.len(), num_agreed: minima.iter().filter(is_same).count() };
    let mut warnings = Vec::new();
    if let Some(other) = minima.iter().find(|candidate| candidate.converged && !is_same(candidate)) {
        let ratio = (other.cost / best.cost).sqrt();
        if ratio < ABOUT_EQUAL {
            warnings.push(Warning::OtherMinimum { ratio, distance_mm: distance_mm(&best, other) });
        }
    }
    let start = start::state_at(&points, &best.flange_from_sensor).ok_or(SolveError::Diverged)?;
    let Settled { points, minimum, noise } = bundle::settle(&measured, start, PlateNoise::of(problem))?;
    Found { method, problem, measured, points, poses, minimum, noise, best, starts: agreed, warnings }.into_solution()
}

/// RMS distance of the points from their edges by the bundle, all weighed alike and from a few starts only, mm: enough to
/// tell which of many readings of the poses fits. `None` if none does.
#[must_use]
pub fn rough_fit_mm(problem: &PlateProblem) -> Option<f64> {
    /// Nearly every start leads to the one minimum.
    const EVERY: usize = 8;
    let (measured, _) = measured(problem).ok()?;
    let points: Vec<Point> = measured.iter().map(|measured| measured.point).collect();
    let costs = start::starts(problem).into_iter().step_by(EVERY).filter_map(|start| bundle_at(&points, &start));
    let least = costs.map(|candidate| candidate.cost).min_by(f64::total_cmp)?;
    #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^52 points")]
    let num_points = points.len() as f64;
    Some((least / num_points).sqrt())
}

/// Where one start led.
#[derive(Clone, Copy, Debug)]
struct Candidate {
    flange_from_sensor: Rigid,
    /// The sum that the method minimises, all points weighed alike.
    cost: f64,
    num_iterations: usize,
    converged: bool,
}

fn bundle_at(points: &[Point], start: &Rigid) -> Option<Candidate> {
    let found = bundle::from_start(points, start).ok()?;
    Some(Candidate {
        flange_from_sensor: found.unknowns.flange_from_sensor,
        cost: found.sums.cost,
        num_iterations: found.num_iterations,
        converged: found.converged,
    })
}

fn published_at(points: &[Point], start: &Rigid) -> Option<Candidate> {
    let found = orthogonal::minimise(points, start, |_| 1.0).ok()?;
    Some(Candidate {
        flange_from_sensor: found.unknowns.0,
        cost: found.sums.cost,
        num_iterations: found.num_iterations,
        converged: found.converged,
    })
}

/// Rad, and mm over 100.
fn apart(a: &Rigid, b: &Rigid) -> f64 {
    let change = a.inverse() * b;
    change.rotation.angle() + change.translation.vector.norm() / descent::LEVER_MM
}

fn distance_mm(a: &Candidate, b: &Candidate) -> f64 {
    (a.flange_from_sensor.translation.vector - b.flange_from_sensor.translation.vector).norm()
}
