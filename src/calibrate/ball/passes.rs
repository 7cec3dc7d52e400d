//! Passes over the data until nothing moves: linearise, weigh by the noise of the poses, minimise, and again.

use crate::calibrate::observation::{CentreObservation, NUM_UNKNOWNS, State};
use crate::calibrate::reduced::sums_at;
use crate::calibrate::solver::{Gradient, Hessian, Minimum, covariance_for_unit_noise, minimise_sums};
use crate::calibrate::{AboveStated, BallProblem, EstimatedRadius, SolveError};
use crate::geometry::{Mat3, Vec3, stats};

use super::pose_noise::{PoseNoise, marginalised};
use super::variance_components::VarianceSpread;

/// The start is near, so a few passes settle it.
const MAX_PASSES: usize = 30;
/// Movements below this (mm, or mm at 100 mm of lever) between passes are the end.
const SETTLED_MM: f64 = 1e-9;
/// Movements below this at the last pass still are a solution.
const CONVERGED_MM: f64 = 1e-6;
/// So are movements below this part of the robot's noise: the result is known far less well.
const CONVERGED_PART: f64 = 0.01;
/// The first pass sees the offsets of the start, so the noise is estimated from the second on, and kept from this one so
/// that the passes can settle.
const LAST_NOISE_ESTIMATE: usize = 4;
/// A scatter so many times that of a stated or usual noise is none: a TOOL was switched, or poses are misread.
const MAX_NOISE_RATIO: f64 = 30.0;
/// Steps of the search for the radius; its cost is a parabola nearly.
const RADIUS_ITERATIONS: usize = 6;
/// Differences by the radius are taken over this part of it: far above rounding, far below any curvature.
const RADIUS_STEP_PART: f64 = 1e-4;

/// Where the passes ended.
#[derive(Clone, Debug)]
pub(super) struct Settled {
    /// The observations at the minimum, the noise of each pose integrated out, by station.
    pub observations: Vec<CentreObservation>,
    /// Covariance of what is common to each station, in the sensor frame, mm².
    pub common_covariance: Vec<Mat3>,
    pub minimum: Minimum,
    /// The pose noise that the weights stand for.
    pub pose_noise: PoseNoise,
    /// How well that noise is known.
    pub spread: VarianceSpread,
    /// The scatter against what is stated of that noise.
    pub above_stated: Option<AboveStated>,
    /// The radius, where it was to be estimated.
    pub radius: Option<EstimatedRadius>,
    /// Change of the unknowns with the radius, a mm.
    pub by_radius: Gradient,
}

/// What the data say about the ball at a state if it has some radius (mm): by the points alone, ordered by station.
pub(super) trait Linearise: Fn(&State, f64) -> Vec<CentreObservation> {}
impl<F: Fn(&State, f64) -> Vec<CentreObservation>> Linearise for F {}

/// Minimises what `linearised` makes of the data, from a start; the radius as well where the problem leaves it open.
///
/// # Errors
/// [`SolveError::Undetermined`] or [`SolveError::Diverged`], as the solver finds.
pub(super) fn settle(linearised: impl Linearise, problem: &BallProblem, start: State) -> Result<Settled, SolveError> {
    let observations = merged(linearised(&start, problem.radius_mm));
    let num_stations = observations.chunk_by(|a, b| a.station == b.station).count();
    let noise = PoseNoise::of(problem, observations.len());
    let mut radius_mm = problem.radius_mm;
    let mut start = start;
    let prior_std_mm = problem.radius_std_mm.filter(|std| *std > 0.0);
    if let Some(prior_std_mm) = prior_std_mm {
        // With a noise found at a wrong radius, that radius would pass for noise; so it is sought with a usual one first.
        let settled = settle_at(&linearised, radius_mm, start, noise.nominal())?;
        start = settled.minimum.state;
        radius_mm = estimated_radius(&linearised, problem.radius_mm, prior_std_mm, &settled)?.radius_mm;
    }
    let mut settled = settle_with_noise(&linearised, radius_mm, start, noise, num_stations)?;
    if let Some(prior_std_mm) = prior_std_mm {
        let found = estimated_radius(&linearised, problem.radius_mm, prior_std_mm, &settled)?;
        radius_mm = found.radius_mm;
        settled = settle_with_noise(&linearised, radius_mm, settled.minimum.state, noise, num_stations)?;
        settled.radius = Some(found);
    }
    settled.by_radius = change_by_radius(radius_mm, &settled.minimum.hessian, |radius_mm| {
        let state = &settled.minimum.state;
        let by_points = merged(linearised(state, radius_mm));
        let (observations, common) = weighted(&by_points, state, &settled.pose_noise)?;
        Ok(sums_at(&observations, &common, state).gradient)
    })?;
    Ok(settled)
}

/// With what is common to a station where the stations scatter more than their poses by themselves explain.
fn settle_with_noise(
    linearised: &impl Linearise,
    radius_mm: f64,
    start: State,
    noise: PoseNoise,
    num_stations: usize,
) -> Result<Settled, SolveError> {
    /// A variance cannot be found negative, so one that is always looked for makes every σ too large on average.
    const LOOK_BELOW_P: f64 = 0.2;
    let mut settled = settle_at(linearised, radius_mm, start, noise.nominal())?;
    if noise.is_open() {
        let ratio = scatter(&capture_residuals(&settled)).map_or(1.0, |scatter| scatter.ratio);
        settled = settle_or_scale(linearised, radius_mm, settled, noise, ratio);
    }
    let above_stated = noise.is_stated().then(|| above_stated(&settled)).flatten();
    if let Some(above) = above_stated.filter(AboveStated::is_contradicted) {
        // Weights by a noise that the data refute would take chance for knowledge.
        settled = settle_or_scale(linearised, radius_mm, settled, noise.reopened(), above.ratio);
    }
    let of_stations = scatter(&station_residuals(&settled)).filter(|scatter| scatter.p_value < LOOK_BELOW_P);
    let has_sweeps = settled.observations.len() > num_stations;
    if let Some(scatter) = of_stations
        && let Some(with_common) = settled.pose_noise.with_common(has_sweeps, num_stations)
    {
        settled = settle_or_scale(linearised, radius_mm, settled, with_common, scatter.ratio);
    }
    Ok(Settled { above_stated, ..settled })
}

/// Settles anew with a noise that is to be found. Stations that contradict each other wildly have none: then the minimum
/// stands, and its scatter sets the scale.
fn settle_or_scale(
    linearised: &impl Linearise,
    radius_mm: f64,
    before: Settled,
    noise: PoseNoise,
    ratio: f64,
) -> Settled {
    if ratio > MAX_NOISE_RATIO {
        return scaled(before, ratio);
    }
    match settle_at(linearised, radius_mm, before.minimum.state, noise) {
        Ok(found) if found.minimum.converged => found,
        _ => scaled(before, ratio.max(1.0)),
    }
}

/// The same minimum with all noise so many times as large.
fn scaled(settled: Settled, ratio: f64) -> Settled {
    let weight = ratio.powi(-2);
    let observations = settled
        .observations
        .into_iter()
        .map(|observation| CentreObservation {
            information: observation.information * weight,
            pull: observation.pull * weight,
            constant: observation.constant * weight,
            ..observation
        })
        .collect();
    let minimum =
        Minimum { hessian: settled.minimum.hessian * weight, cost: settled.minimum.cost * weight, ..settled.minimum };
    Settled { observations, minimum, pose_noise: settled.pose_noise.scaled(ratio), ..settled }
}

fn settle_at(
    linearised: &impl Linearise,
    radius_mm: f64,
    start: State,
    noise: PoseNoise,
) -> Result<Settled, SolveError> {
    let mut noise = noise;
    let mut state = start;
    let mut spread = VarianceSpread::known();
    let mut latest = None;
    for pass in 1..=MAX_PASSES {
        let by_points = merged(linearised(&state, radius_mm));
        if noise.is_open() && (2..=LAST_NOISE_ESTIMATE).contains(&pass) {
            spread = noise.estimate(&by_points, &state)?;
        }
        let (observations, common_covariance) = weighted(&by_points, &state, &noise)?;
        let mut minimum = minimise_sums(|state| sums_at(&observations, &common_covariance, state), state)?;
        let moved_mm = movement_mm(&state, &minimum.state);
        state = minimum.state;
        let settled = moved_mm < SETTLED_MM && (!noise.is_open() || pass > LAST_NOISE_ESTIMATE);
        minimum.converged &= moved_mm < CONVERGED_MM.max(CONVERGED_PART * noise.largest_std_mm());
        minimum.num_iterations = pass;
        latest = Some(Settled {
            observations,
            common_covariance,
            minimum,
            pose_noise: noise,
            spread: spread.clone(),
            above_stated: None,
            radius: None,
            by_radius: Gradient::zeros(),
        });
        if settled {
            break;
        }
    }
    latest.ok_or(SolveError::Diverged)
}

/// Captures at one and the same reported pose share its error, so they count as one.
fn merged(observations: Vec<CentreObservation>) -> Vec<CentreObservation> {
    let mut merged: Vec<CentreObservation> = Vec::with_capacity(observations.len());
    for observation in observations {
        match merged.last_mut() {
            Some(last)
                if last.station == observation.station && last.base_from_flange == observation.base_from_flange =>
            {
                last.information += observation.information;
                last.pull += observation.pull;
                last.constant += observation.constant;
            }
            _ => merged.push(observation),
        }
    }
    merged
}

type WeightedObservations = (Vec<CentreObservation>, Vec<Mat3>);

fn weighted(
    by_points: &[CentreObservation],
    state: &State,
    noise: &PoseNoise,
) -> Result<WeightedObservations, SolveError> {
    let observations =
        by_points.iter().map(|observation| marginalised(observation, state, noise)).collect::<Result<_, _>>()?;
    let num_stations = by_points.last().map_or(0, |last| last.station + 1);
    let mut common_covariance = vec![Mat3::zeros(); num_stations];
    for run in by_points.chunk_by(|a, b| a.station == b.station) {
        common_covariance[run[0].station] = noise.common_covariance(&run[0].base_from_flange, state);
    }
    Ok((observations, common_covariance))
}

/// The radius that fits best, by Newton's method on the least cost over all other unknowns, with what is known beforehand.
fn estimated_radius(
    linearised: &impl Linearise,
    given_mm: f64,
    prior_std_mm: f64,
    start: &Settled,
) -> Result<EstimatedRadius, SolveError> {
    let step_mm = RADIUS_STEP_PART * given_mm;
    let prior_information = prior_std_mm.powi(-2);
    let noise = start.pose_noise.fixed();
    let mut radius_mm = given_mm;
    let mut state = start.minimum.state;
    let mut std_mm = prior_std_mm;
    for _ in 0..RADIUS_ITERATIONS {
        let mut cost_at = |radius_mm: f64| -> Result<f64, SolveError> {
            let settled = settle_at(linearised, radius_mm, state, noise)?;
            state = settled.minimum.state;
            Ok(settled.minimum.cost)
        };
        let (behind, here, ahead) = (cost_at(radius_mm - step_mm)?, cost_at(radius_mm)?, cost_at(radius_mm + step_mm)?);
        let gradient = (ahead - behind) / (4.0 * step_mm) + (radius_mm - given_mm) * prior_information;
        let information = ((ahead - 2.0 * here + behind) / (2.0 * step_mm * step_mm)).max(0.0) + prior_information;
        std_mm = information.sqrt().recip();
        let change_mm = (-gradient / information).clamp(-0.2 * given_mm, 0.2 * given_mm);
        radius_mm += change_mm;
        if change_mm.abs() < 1e-3 * std_mm {
            break;
        }
    }
    Ok(EstimatedRadius { radius_mm, std_mm })
}

/// How a minimum with the normal equations `hessian` follows the radius: what the data pull with if the ball is a little
/// larger, against the information.
///
/// # Errors
/// [`SolveError::Undetermined`] if a combination of the unknowns is free, and those of `gradient_at`.
pub(super) fn change_by_radius(
    radius_mm: f64,
    hessian: &Hessian,
    gradient_at: impl Fn(f64) -> Result<Gradient, SolveError>,
) -> Result<Gradient, SolveError> {
    if radius_mm <= 0.0 {
        // A tip has no radius to follow.
        return Ok(Gradient::zeros());
    }
    let step_mm = RADIUS_STEP_PART * radius_mm;
    let slope = (gradient_at(radius_mm + step_mm)? - gradient_at(radius_mm - step_mm)?) / (2.0 * step_mm);
    Ok(covariance_for_unit_noise(hessian)? * slope)
}

/// The scatter against what is stated, of single captures or of whole stations: the less likely one.
fn above_stated(settled: &Settled) -> Option<AboveStated> {
    [scatter(&capture_residuals(settled)), scatter(&station_residuals(settled))]
        .into_iter()
        .flatten()
        .min_by(|a, b| a.p_value.total_cmp(&b.p_value))
}

/// Residuals of the captures over their σ.
fn capture_residuals(settled: &Settled) -> Vec<f64> {
    let state = &settled.minimum.state;
    settled.observations.iter().flat_map(|observation| observation.whitened(observation.pull_at(state))).collect()
}

/// Residuals of the stations as wholes over their σ. The sensor hardly turns within a station, so its captures' centres are
/// the same but for the travel.
fn station_residuals(settled: &Settled) -> Vec<f64> {
    let state = &settled.minimum.state;
    settled
        .observations
        .chunk_by(|a, b| a.station == b.station)
        .flat_map(|run| {
            let information = run.iter().map(|observation| observation.information).sum();
            let pull: Vec3 = run.iter().map(|observation| observation.pull_at(state)).sum();
            CentreObservation { information, ..run[0].clone() }.whitened(pull).collect::<Vec<f64>>()
        })
        .collect()
}

/// How much more than of unit variance residuals are; `None` with nothing left over.
fn scatter(residuals: &[f64]) -> Option<AboveStated> {
    let freedom = residuals.len().checked_sub(NUM_UNKNOWNS).filter(|freedom| *freedom > 0)?;
    #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^52 residuals")]
    let freedom = freedom as f64;
    let chi_square: f64 = residuals.iter().map(|residual| residual * residual).sum();
    Some(AboveStated { ratio: (chi_square / freedom).sqrt(), p_value: stats::chi_squared_p_value(chi_square, freedom) })
}

fn movement_mm(before: &State, after: &State) -> f64 {
    let change = before.flange_from_sensor.inverse() * after.flange_from_sensor;
    change.translation.vector.norm()
        + 100.0 * change.rotation.angle()
        + (before.ball_in_base - after.ball_in_base).norm()
}
