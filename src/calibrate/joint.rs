//! One `flange_from_sensor` from several targets of one sensor: ball, plate and tip together.
//!
//! Each target is solved by itself first. Around those minima its data are sums of squares in the sensor and in the target's
//! own unknowns (the ball's centre, the tip, the plate's frame), by the weights of its own noise. The target's unknowns are
//! eliminated from its normal equations, what is left is added up, and the whole is linearised anew until it stays where it
//! is.

use nalgebra::{Matrix6, SMatrix, SVector, Vector6};

use crate::geometry::{Flange, Rigid, Sensor, Transform, Vec3, se3, stats};

use super::observation::{NUM_UNKNOWNS, State};
use super::plate::PlateState;
use super::plate::descent::inverse_of;
use super::plate::points::{NUM_UNKNOWNS as NUM_PLATE_UNKNOWNS, sums_of, tangent_size};
use super::uncertainty::{doubt_in_the_noise, of_sensor, point_by_sensor};
use super::{Mount, PlateReduced, Problem, Reduced, RmsMax, Solution, SolveError, Uncertainty, best_available};

/// From minima near each other a few steps settle it.
const MAX_ITERATIONS: usize = 50;
/// A step below this (rad, mm/100) is the end.
const SETTLED: f64 = 1e-12;
/// A step below this at the end still is a solution.
const CONVERGED: f64 = 1e-8;

/// What became of one target in the joint solution.
#[derive(Clone, Debug, PartialEq)]
pub struct JointTarget {
    /// The target's own calibration.
    pub alone: Solution,
    /// The target's point by the joint calibration, mm: the ball's centre, the tip, or the plate's corner.
    pub target_in_base_mm: Vec3,
    /// The plate by the joint calibration.
    pub base_from_plate: Option<Rigid>,
    /// Distances of the stations' balls or tips from it, or of the points from their edges.
    pub scatter: RmsMax,
    /// How far the joint calibration puts the workspace point from where the target's own has it, mm.
    pub moved_mm: f64,
    /// Probability that the target's own calibration is so far from the joint one by chance; small where the targets
    /// contradict each other.
    pub p_value: f64,
}

/// A calibration from several targets of one sensor.
#[derive(Clone, Debug, PartialEq)]
pub struct JointSolution {
    /// Where the sensor is. For [`Mount::Fixed`] read "base" for flange and "flange" for base in the names below.
    pub mount: Mount,
    /// The hand-eye calibration.
    pub flange_from_sensor: Transform<Flange, Sensor>,
    /// How well it is known.
    pub uncertainty: Uncertainty,
    /// One entry a problem, in order.
    pub targets: Vec<JointTarget>,
    /// Steps taken.
    pub num_iterations: usize,
    /// Whether the last step was negligible.
    pub converged: bool,
}

/// What a target says about the sensor once its own unknowns are eliminated.
#[derive(Clone, Copy, Debug)]
struct Reach {
    information: Matrix6<f64>,
    pull: Vector6<f64>,
}

/// A target's data, with its own unknowns.
#[derive(Clone, Copy, Debug)]
enum Block<'a> {
    Point { reduced: &'a Reduced, factor: f64, point_in_base: Vec3, by_radius: Vector6<f64> },
    Plate { reduced: &'a PlateReduced, base_from_plate: Rigid },
}

/// How a target's own unknowns follow a step of the sensor; those of a point are the first three.
#[derive(Clone, Copy, Debug)]
struct Follows {
    by_sensor: Matrix6<f64>,
    own: Vector6<f64>,
}

/// What normal equations of the sensor (six unknowns) and of a target (M) say about the sensor, the target eliminated.
fn eliminated<const N: usize, const M: usize>(
    hessian: &SMatrix<f64, N, N>,
    gradient: &SVector<f64, N>,
) -> Result<(Reach, Follows), SolveError> {
    let own = inverse_of(&hessian.fixed_view::<M, M>(6, 6).into_owned())?;
    let coupling = hessian.fixed_view::<M, 6>(6, 0).into_owned();
    let own_pull = gradient.fixed_rows::<M>(6).into_owned();
    let by_sensor = -own * coupling;
    let information = hessian.fixed_view::<6, 6>(0, 0) + coupling.transpose() * by_sensor;
    let pull = gradient.fixed_rows::<6>(0) + by_sensor.transpose() * own_pull;
    let mut follows = Follows { by_sensor: Matrix6::zeros(), own: Vector6::zeros() };
    follows.by_sensor.fixed_view_mut::<M, 6>(0, 0).copy_from(&by_sensor);
    follows.own.fixed_rows_mut::<M>(0).copy_from(&(own * own_pull));
    Ok((Reach { information, pull }, follows))
}

impl<'a> Block<'a> {
    fn of(solution: &'a Solution, radius_std_mm: f64) -> Result<Self, SolveError> {
        if let Some(plate) = &solution.plate {
            return Ok(Self::Plate { reduced: &plate.reduced, base_from_plate: plate.base_from_plate });
        }
        let reduced = solution.reduced.as_ref().ok_or(SolveError::Diverged)?;
        // Back from the flange's axes to those of the sensor, in which the sums are.
        let (rotation, translation) = se3::split(&solution.change_by_radius);
        let by_radius = se3::join(rotation, solution.flange_from_sensor.rotation().inverse() * translation);
        Ok(Self::Point {
            reduced,
            factor: reduced.variance_factor.unwrap_or(1.0),
            point_in_base: reduced.state.ball_in_base,
            by_radius: by_radius * radius_std_mm,
        })
    }

    /// What it says about the sensor, and how its own unknowns follow.
    fn reach(&self, flange_from_sensor: &Rigid) -> Result<(Reach, Follows), SolveError> {
        match self {
            Self::Point { reduced, factor, point_in_base, by_radius } => {
                let state = State { flange_from_sensor: *flange_from_sensor, ball_in_base: *point_in_base };
                let sums = reduced.sums_with(&state, |_| true);
                let (reach, follows) =
                    eliminated::<NUM_UNKNOWNS, 3>(&(sums.hessian / *factor), &(sums.gradient / *factor))?;
                Ok((softened(&reach, by_radius), follows))
            }
            Self::Plate { reduced, base_from_plate } => {
                let state = PlateState { flange_from_sensor: *flange_from_sensor, base_from_plate: *base_from_plate };
                let sums = sums_of(&reduced.points, &state, |_| 1.0);
                eliminated::<NUM_PLATE_UNKNOWNS, 6>(&sums.hessian, &sums.gradient)
            }
        }
    }

    fn moved(self, follows: &Follows, step: &Vector6<f64>) -> Self {
        let own_step = follows.own + follows.by_sensor * step;
        match self {
            Self::Point { reduced, factor, point_in_base, by_radius } => {
                let point_in_base = point_in_base + own_step.fixed_rows::<3>(0);
                Self::Point { reduced, factor, point_in_base, by_radius }
            }
            Self::Plate { reduced, base_from_plate } => {
                Self::Plate { reduced, base_from_plate: base_from_plate * se3::exp(&own_step) }
            }
        }
    }

    fn target_in_base(&self) -> Vec3 {
        match self {
            Self::Point { point_in_base, .. } => *point_in_base,
            Self::Plate { base_from_plate, .. } => base_from_plate.translation.vector,
        }
    }

    fn scatter(&self, flange_from_sensor: &Rigid) -> RmsMax {
        let distances: Vec<f64> = match self {
            Self::Point { reduced, point_in_base, .. } => {
                let state = State { flange_from_sensor: *flange_from_sensor, ball_in_base: *point_in_base };
                (0..reduced.num_stations)
                    .map(|idx| (reduced.station_ball(idx, &state) - point_in_base).norm())
                    .collect()
            }
            Self::Plate { reduced, base_from_plate } => {
                let state = PlateState { flange_from_sensor: *flange_from_sensor, base_from_plate: *base_from_plate };
                reduced.points.iter().map(|point| state.off_edge(point).norm()).collect()
            }
        };
        RmsMax { rms_mm: stats::rms(distances.iter().copied()), max_mm: stats::max(distances) }
    }
}

/// With a ball's radius known no better than by one standard deviation, which moves the sensor by `by_radius`: its
/// information is that of (H⁻¹ + d dᵀ)⁻¹.
fn softened(reach: &Reach, by_radius: &Vector6<f64>) -> Reach {
    let pulled = reach.information * by_radius;
    let damp = 1.0 / (1.0 + by_radius.dot(&pulled));
    Reach {
        information: reach.information - pulled * pulled.transpose() * damp,
        pull: reach.pull - pulled * (by_radius.dot(&reach.pull) * damp),
    }
}

/// Calibrates from several targets of one sensor.
///
/// # Errors
/// That of the first target which cannot be solved by itself, [`SolveError::MixedMounts`] if they are not of one sensor, and
/// [`SolveError::Undetermined`] if all together leave the sensor open.
pub fn solve_joint(problems: &[Problem]) -> Result<JointSolution, SolveError> {
    let alone = problems.iter().map(solved_alone).collect::<Result<Vec<Solution>, _>>()?;
    let first = alone.first().ok_or(SolveError::TooFewStations { found: 0, needed: 1, refusal: None })?;
    let mount = first.mount;
    if alone.iter().any(|solution| solution.mount != mount) {
        return Err(SolveError::MixedMounts);
    }
    let point_std = |solution: &&Solution| {
        solution.uncertainty.as_ref().map_or(f64::INFINITY, |known| known.workspace_point_std_mm)
    };
    let best = alone.iter().min_by(|a, b| point_std(a).total_cmp(&point_std(b))).unwrap_or(first);
    let mut flange_from_sensor = *best.flange_from_sensor.rigid();
    let mut blocks = problems
        .iter()
        .zip(&alone)
        .map(|(problem, solution)| Block::of(solution, radius_std_mm(problem, solution)))
        .collect::<Result<Vec<_>, _>>()?;
    let (mut num_iterations, mut size) = (0, f64::INFINITY);
    while num_iterations < MAX_ITERATIONS && size > SETTLED {
        let reaches = blocks.iter().map(|block| block.reach(&flange_from_sensor)).collect::<Result<Vec<_>, _>>()?;
        let information: Matrix6<f64> = reaches.iter().map(|(reach, _)| reach.information).sum();
        let pull: Vector6<f64> = reaches.iter().map(|(reach, _)| reach.pull).sum();
        let step = inverse_of(&information)? * pull;
        size = tangent_size(&step);
        if !size.is_finite() {
            return Err(SolveError::Diverged);
        }
        blocks = blocks.iter().zip(&reaches).map(|(block, (_, follows))| block.moved(follows, &step)).collect();
        flange_from_sensor *= se3::exp(&step);
        num_iterations += 1;
    }
    let reaches = blocks
        .iter()
        .map(|block| Ok(block.reach(&flange_from_sensor)?.0))
        .collect::<Result<Vec<Reach>, SolveError>>()?;
    let covariance = inverse_of(&reaches.iter().map(|reach| reach.information).sum::<Matrix6<f64>>())?;
    let degrees_of_freedom = degrees_of_freedom(&covariance, &reaches, &alone);
    let reference_point =
        best.uncertainty.as_ref().map_or_else(Vec3::zeros, |known| known.reference_point_in_sensor_mm);
    let uncertainty = of_sensor(
        &(covariance * doubt_in_the_noise(degrees_of_freedom)),
        degrees_of_freedom,
        &flange_from_sensor,
        reference_point,
    );
    let joint = Transform::from_rigid(flange_from_sensor);
    let by_sensor = point_by_sensor(reference_point);
    let targets = alone
        .iter()
        .zip(&blocks)
        .zip(&reaches)
        .map(|((alone, block), reach)| {
            let shift = alone.flange_from_sensor.map_point(reference_point) - joint.map_point(reference_point);
            let in_sensor = flange_from_sensor.rotation.inverse() * shift;
            JointTarget {
                target_in_base_mm: block.target_in_base(),
                base_from_plate: match block {
                    Block::Plate { base_from_plate, .. } => Some(*base_from_plate),
                    Block::Point { .. } => None,
                },
                scatter: block.scatter(&flange_from_sensor),
                moved_mm: shift.norm(),
                p_value: inverse_of(&reach.information)
                    .map_or(1.0, |own| agreement(&in_sensor, &by_sensor, alone, &(own - covariance))),
                alone: alone.clone(),
            }
        })
        .collect();
    let converged = size < CONVERGED;
    Ok(JointSolution { mount, flange_from_sensor: joint, uncertainty, targets, num_iterations, converged })
}

fn solved_alone(problem: &Problem) -> Result<Solution, SolveError> {
    let mut reason = None;
    let mut results = Vec::new();
    for method in problem.methods() {
        let outcome = problem.solve(*method);
        if let Err(error) = &outcome {
            reason.get_or_insert(error.clone());
        }
        results.push(super::MethodResult { method: *method, outcome });
    }
    best_available(&results).cloned().ok_or_else(|| reason.unwrap_or(SolveError::Diverged))
}

fn radius_std_mm(problem: &Problem, solution: &Solution) -> f64 {
    let given = problem.as_ball().and_then(|ball| ball.radius_std_mm);
    solution.radius.map(|radius| radius.std_mm).or(given).unwrap_or(0.0)
}

/// Degrees of freedom (Satterthwaite's): each target's as its part of the information counts.
fn degrees_of_freedom(covariance: &Matrix6<f64>, reaches: &[Reach], alone: &[Solution]) -> f64 {
    let doubt: f64 = reaches
        .iter()
        .zip(alone)
        .map(|(reach, solution)| {
            let part = (covariance * reach.information).trace() / 6.0;
            solution.uncertainty.as_ref().map_or(0.0, |known| part * part / known.degrees_of_freedom)
        })
        .sum();
    if doubt > 0.0 { doubt.recip() } else { f64::INFINITY }
}

/// Probability of so large a shift of the workspace point between a target's own calibration and the joint one by chance.
///
/// The covariance of the difference between a part and the whole is the difference of their covariances.
fn agreement(
    shift_in_sensor: &Vec3,
    by_sensor: &SMatrix<f64, 3, 6>,
    alone: &Solution,
    difference: &Matrix6<f64>,
) -> f64 {
    /// Directions in which the other targets add less than this part of the variance say nothing of agreement.
    const LEAST_PART: f64 = 1e-2;
    let eigen = (by_sensor * difference * by_sensor.transpose()).symmetric_eigen();
    let least = LEAST_PART * eigen.eigenvalues.max();
    let seen = || (0..3).filter(|idx| eigen.eigenvalues[*idx] > least);
    let chi_square: f64 =
        seen().map(|idx| eigen.eigenvectors.column(idx).dot(shift_in_sensor).powi(2) / eigen.eigenvalues[idx]).sum();
    let freedom = seen().fold(0.0, |count, _| count + 1.0);
    let degrees = alone.uncertainty.as_ref().map_or(f64::INFINITY, |known| known.degrees_of_freedom);
    stats::chi_squared_p_value(chi_square / doubt_in_the_noise(degrees), freedom)
}
