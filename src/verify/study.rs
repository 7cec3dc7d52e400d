//! All calibrations at hand on all targets at hand.

use crate::calibrate::joint::{JointSolution, solve_joint};
use crate::calibrate::motion::CameraPose;
use crate::calibrate::{Method, MethodResult, Problem, Reading, SolveError, Station, best_available};
use crate::fit::Refusal;
use crate::geometry::{Flange, Sensor, Transform, Vec3};
use crate::watch::{Cancelled, Watch};

use super::{Evaluation, NotEvaluated, evaluate};

/// An error on other data that is so many times that of a calibration computed from them is a contradiction, not chance:
/// own data flatter by some tens of percent at most.
const DOUBT_RATIO: f64 = 3.0;
/// Errors below this are those of a good arm, whatever their ratio, mm.
const LEAST_DOUBT_MM: f64 = 0.05;

/// A target with its data, and what the methods made of it.
#[derive(Clone, Debug)]
pub struct TargetCase {
    /// The user's name for it.
    pub name: String,
    /// Its place among the session's further targets; `None` for the session's own.
    pub further_idx: Option<usize>,
    /// Its data.
    pub problem: Problem,
    /// One entry a method that was run on it.
    pub results: Vec<MethodResult>,
    /// Where its ball's centre or tip is known to be, in the base, mm.
    pub touched_mm: Option<Vec3>,
}

/// Where a calibration comes from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Origin {
    /// Computed from one of the targets.
    Solved {
        /// The target's place in the study.
        target_idx: usize,
        /// By this method.
        method: Method,
    },
    /// Computed from several targets at once.
    Joint {
        /// Their places in the study.
        target_idxs: Vec<usize>,
    },
    /// From elsewhere: a file, a paper, another program.
    Given {
        /// What the user calls it.
        name: String,
        /// Whether it was no rotation, and the nearest one is judged in its place.
        is_nearest: bool,
    },
}

impl Origin {
    /// Whether it was computed from a target's data, so that its errors there are in sample.
    #[must_use]
    pub fn has_seen(&self, target_idx: usize) -> bool {
        match self {
            Self::Solved { target_idx: from, .. } => *from == target_idx,
            Self::Joint { target_idxs } => target_idxs.contains(&target_idx),
            Self::Given { .. } => false,
        }
    }

    /// The method, where it was computed here from one target.
    #[must_use]
    pub const fn method(&self) -> Option<Method> {
        match self {
            Self::Solved { method, .. } => Some(*method),
            Self::Joint { .. } | Self::Given { .. } => None,
        }
    }
}

/// A calibration to be judged.
#[derive(Clone, Debug, PartialEq)]
pub struct Calibration {
    /// Where it comes from.
    pub origin: Origin,
    /// The calibration.
    pub flange_from_sensor: Transform<Flange, Sensor>,
    /// Standard deviation of a point in the workspace that it states itself, mm.
    pub workspace_point_std_mm: Option<f64>,
}

/// What all calibrations make of one target.
#[derive(Clone, Debug)]
pub struct TargetEvidence {
    /// The user's name for it.
    pub name: String,
    /// Its place among the session's further targets; `None` for the session's own.
    pub further_idx: Option<usize>,
    /// Its data.
    pub problem: Problem,
    /// One entry a method that was run on it.
    pub results: Vec<MethodResult>,
    /// One entry a calibration, in the order of [`Verification::calibrations`].
    pub rows: Vec<Result<Evaluation, NotEvaluated>>,
}

/// The evidence for and against every calibration.
#[derive(Clone, Debug, Default)]
pub struct Verification {
    /// Those of the first target's methods, of each further target's best, of all targets together, and those given.
    pub calibrations: Vec<Calibration>,
    /// One entry a target: the columns of the cross-target table.
    pub targets: Vec<TargetEvidence>,
    /// The calibration from all targets that can be solved by themselves, where there are several.
    pub joint: Option<Joint>,
}

/// The calibration from several targets at once.
#[derive(Clone, Debug)]
pub struct Joint {
    /// The targets' places in the study.
    pub target_idxs: Vec<usize>,
    /// It, or why there is none.
    pub outcome: Result<JointSolution, SolveError>,
}

/// Calibrations that differ by less are the same, written down and read again, mm and rad.
const SAME_MM: f64 = 1e-6;
const SAME_RAD: f64 = 1e-8;

impl Verification {
    /// Whether a calibration was computed from a target's data, also where it came back in a file.
    #[must_use]
    pub fn has_seen(&self, calibration_idx: usize, target_idx: usize) -> bool {
        let Some(calibration) = self.calibrations.get(calibration_idx) else { return false };
        let is_same = |other: &Calibration| {
            let (a, b) = (&calibration.flange_from_sensor, &other.flange_from_sensor);
            (a.translation_mm() - b.translation_mm()).norm() < SAME_MM
                && a.rotation().angle_to(&b.rotation()) < SAME_RAD
        };
        let mut computed = self.calibrations.iter().filter(|other| other.origin.has_seen(target_idx));
        match calibration.origin {
            Origin::Given { .. } => computed.any(is_same),
            Origin::Solved { .. } | Origin::Joint { .. } => calibration.origin.has_seen(target_idx),
        }
    }

    /// A calibration on a target.
    #[must_use]
    pub fn cell(&self, calibration_idx: usize, target_idx: usize) -> Option<&Result<Evaluation, NotEvaluated>> {
        self.targets.get(target_idx)?.rows.get(calibration_idx)
    }

    /// The place of the answer: the best calibration of the first target.
    #[must_use]
    pub fn answer_idx(&self) -> Option<usize> {
        Method::BEST_FIRST.into_iter().find_map(|method| {
            let origin = Origin::Solved { target_idx: 0, method };
            self.calibrations.iter().position(|calibration| calibration.origin == origin)
        })
    }

    /// Whether other targets bear out the answer, the best calibration of the first target: on none of them its error is far
    /// above that of the calibration computed from that very target. `None` without such a target.
    #[must_use]
    pub fn is_borne_out(&self) -> Option<bool> {
        let best = self.answer_idx()?;
        let mut held_out = self.targets.iter().enumerate().skip(1).filter_map(|(target_idx, target)| {
            let rms_mm = |idx: usize| Some(target.rows.get(idx)?.as_ref().ok()?.figures.rms_mm);
            let own = self.calibrations.iter().position(
                |calibration| matches!(calibration.origin, Origin::Solved { target_idx: from, .. } if from == target_idx),
            )?;
            Some((rms_mm(best)?, rms_mm(own)?))
        });
        let first = held_out.next()?;
        let is_fine = |(of_best, of_own): (f64, f64)| of_best < LEAST_DOUBT_MM || of_best < DOUBT_RATIO * of_own;
        Some(std::iter::once(first).chain(held_out).all(is_fine))
    }

    /// The sensor's middle as the data have it: the mean of all points seen, in the sensor frame, mm. Where calibrations
    /// differ is told there.
    #[must_use]
    pub fn reference_point_in_sensor_mm(&self) -> Vec3 {
        let points: Vec<Vec3> = self.targets.iter().flat_map(|target| points_in_sensor(&target.problem)).collect();
        #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^52 points")]
        let count = points.len().max(1) as f64;
        points.iter().sum::<Vec3>() / count
    }
}

/// The stations that a problem was posed with; streams have none.
fn stations(problem: &Problem) -> Vec<&Station> {
    match problem {
        Problem::Ball(ball) | Problem::Point(ball) => ball.stations.iter().collect(),
        Problem::Motion(motion) => motion.stations.iter().collect(),
        Problem::Plate(plate) => plate.stations.iter().map(|at_plate| &at_plate.station).collect(),
        Problem::Streams(_) => Vec::new(),
    }
}

fn points_in_sensor(problem: &Problem) -> Vec<Vec3> {
    if let Problem::Streams(streams) = problem {
        let world_in_sensor = |pose: &CameraPose| pose.world_from_sensor.inverse().translation_mm();
        return streams.camera.iter().map(world_in_sensor).collect();
    }
    let captures = stations(problem).into_iter().flat_map(|station| &station.captures);
    let seen = captures.filter_map(|capture| match &capture.reading {
        Reading::Arc(arc) => Some(Vec3::new(arc.circle.x_mm, 0.0, arc.circle.z_mm)),
        other => other.point_in_sensor_mm(),
    });
    seen.collect()
}

/// A profile of a target in which nothing of it was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RefusedCapture<'a> {
    /// The label of its station.
    pub station: &'a str,
    /// Its place in that.
    pub capture_idx: usize,
    /// Why.
    pub refusal: &'a Refusal,
}

impl TargetEvidence {
    /// How many captures its stations have, refused ones among them.
    #[must_use]
    pub fn num_captures(&self) -> usize {
        match &self.problem {
            Problem::Streams(streams) => streams.camera.len(),
            problem => stations(problem).iter().map(|station| station.captures.len()).sum(),
        }
    }

    /// The captures that no calibration is held against, as nothing was found in them.
    pub fn refused(&self) -> impl Iterator<Item = RefusedCapture<'_>> {
        stations(&self.problem).into_iter().flat_map(|station| {
            station.captures.iter().enumerate().filter_map(|(capture_idx, capture)| match &capture.reading {
                Reading::Refused(refusal) => Some(RefusedCapture { station: &station.label, capture_idx, refusal }),
                _ => None,
            })
        })
    }
}

/// The calibrations computed from the targets: of the first one every method's, of the others the best.
fn solved_calibrations(targets: &[TargetCase]) -> Vec<Calibration> {
    let mut calibrations = Vec::new();
    for (target_idx, target) in targets.iter().enumerate() {
        let solutions = target.results.iter().filter_map(|result| result.outcome.as_ref().ok());
        let best = best_available(&target.results).map(|solution| solution.method);
        for solution in solutions.filter(|solution| target_idx == 0 || best == Some(solution.method)) {
            calibrations.push(Calibration {
                origin: Origin::Solved { target_idx, method: solution.method },
                flange_from_sensor: solution.flange_from_sensor,
                workspace_point_std_mm: solution.uncertainty.as_ref().map(|known| known.workspace_point_std_mm),
            });
        }
    }
    calibrations
}

impl Joint {
    /// Solves all targets together that have a solution of their own; `None` for fewer than two.
    #[must_use]
    pub fn of(targets: &[TargetCase]) -> Option<Self> {
        let target_idxs: Vec<usize> =
            (0..targets.len()).filter(|idx| best_available(&targets[*idx].results).is_some()).collect();
        if target_idxs.len() < 2 {
            return None;
        }
        let problems: Vec<Problem> = target_idxs.iter().map(|idx| targets[*idx].problem.clone()).collect();
        Some(Self { target_idxs, outcome: solve_joint(&problems) })
    }

    /// It as a calibration to be judged.
    #[must_use]
    pub fn calibration(&self) -> Option<Calibration> {
        let solution = self.outcome.as_ref().ok()?;
        Some(Calibration {
            origin: Origin::Joint { target_idxs: self.target_idxs.clone() },
            flange_from_sensor: solution.flange_from_sensor,
            workspace_point_std_mm: Some(solution.uncertainty.workspace_point_std_mm),
        })
    }
}

/// Evaluates the calibrations computed from the targets, that of all together, and those `given`, on every target.
///
/// # Errors
/// [`Cancelled`] if `watch` says so.
pub fn verify(
    targets: Vec<TargetCase>,
    given: &[Calibration],
    watch: &mut dyn Watch,
) -> Result<Verification, Cancelled> {
    let mut calibrations = solved_calibrations(&targets);
    watch.report(0, targets.len() * calibrations.len())?;
    let joint = Joint::of(&targets);
    calibrations.extend(joint.as_ref().and_then(Joint::calibration));
    calibrations.extend(given.iter().cloned());
    let total = targets.len() * calibrations.len();
    let mut evidence = Vec::with_capacity(targets.len());
    for target in targets {
        let mut rows = Vec::with_capacity(calibrations.len());
        for calibration in &calibrations {
            watch.report(evidence.len() * calibrations.len() + rows.len(), total)?;
            rows.push(evaluate(&target.problem, &calibration.flange_from_sensor, target.touched_mm));
        }
        evidence.push(TargetEvidence {
            name: target.name,
            further_idx: target.further_idx,
            problem: target.problem,
            results: target.results,
            rows,
        });
    }
    Ok(Verification { calibrations, targets: evidence, joint })
}
