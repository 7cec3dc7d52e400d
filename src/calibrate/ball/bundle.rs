//! `ball-bundle`: all inlier points of all profiles of all sweeps at once.
//!
//! Minimises Σ (|p − s| − R)² with s the ball's centre in the sensor frame of each profile. A pass over the points gives
//! nine sums a profile; between passes the quadratic they make is minimised exactly. The weight of a profile is that of
//! its points across the section, (R/l)²/σ², with the noise of its pose integrated out.
//!
//! # Source
//! Ours; the structure is that of a bundle adjustment with one three-parameter block a profile.

use crate::calibrate::observation::{CentreObservation, State};
use crate::calibrate::rotation_start::PoseGeometry;
use crate::calibrate::shared_warnings::{first_refusal, refused_captures};
use crate::calibrate::uncertainty::Spread;
use crate::calibrate::{BallProblem, Method, Reading, Solution, SolveError, Station, Warning};
use crate::fit::ArcFit;
use crate::geometry::{Rigid, stats};

use super::assemble::{Found, StationFacts, first_pose};
use super::passes::settle;
use super::profile_sums::profile_sums;
use super::{MIN_STATIONS, fixed_point, max_arc};

/// Noise below this (mm) is rounding; weights are taken as of this noise.
const LEAST_POINT_STD_MM: f64 = 1e-7;

/// A profile that takes part.
#[derive(Clone, Copy, Debug)]
struct UsedProfile<'a> {
    station: usize,
    base_from_flange: &'a Rigid,
    arc: &'a ArcFit,
    /// Weight of a squared residual, 1/mm².
    weight: f64,
}

/// Solves by all points.
///
/// # Errors
/// [`SolveError`] with fewer than four stations with a profile, or if they leave a direction free.
pub fn solve(problem: &BallProblem) -> Result<Solution, SolveError> {
    let mut warnings = Vec::new();
    let stations = stations_with_profiles(problem, &mut warnings)?;
    let poses_of_stations: Vec<Rigid> = stations.iter().map(|station| *first_pose(station)).collect();
    let poses = PoseGeometry::new(&poses_of_stations)?;
    let start = start(problem, &mut warnings)?;
    let profiles = used_profiles(&stations, problem);
    let settled = settle(|state, radius_mm| linearised(&profiles, state, radius_mm), problem, start)?;
    warnings.extend(max_arc::radius_warning_at(problem, &settled.minimum.state));
    let facts = stations
        .into_iter()
        .map(|station| StationFacts { station, side_cost_ratio: None, target_in_sensor_std_mm: None, sweep: None })
        .collect();
    Found {
        method: Method::BallBundle,
        problem,
        stations: facts,
        spread: Some(Spread::Modelled(Box::new(settled.spread))),
        noise: Some(settled.pose_noise.model(settled.above_stated)),
        radius: settled.radius,
        by_radius: settled.by_radius,
        observations: settled.observations,
        common_covariance: settled.common_covariance,
        minimum: settled.minimum,
        // A station blind along y still knows that the ball is not further off than its radius.
        prior_information: 1.0 / (problem.radius_mm * problem.radius_mm),
        poses,
        warnings,
    }
    .into_solution()
}

fn stations_with_profiles<'a>(
    problem: &'a BallProblem,
    warnings: &mut Vec<Warning>,
) -> Result<Vec<&'a Station>, SolveError> {
    let is_arc = |reading: &Reading| matches!(reading, Reading::Arc(_));
    let (used, skipped): (Vec<&Station>, Vec<&Station>) =
        problem.stations.iter().partition(|station| station.captures.iter().any(|capture| is_arc(&capture.reading)));
    if used.len() < MIN_STATIONS {
        return Err(SolveError::TooFewProfileStations {
            found: used.len(),
            needed: MIN_STATIONS,
            refusal: first_refusal(&problem.stations),
        });
    }
    warnings.extend(refused_captures(&problem.stations));
    warnings.extend(skipped.into_iter().map(|station| Warning::StationSkipped {
        label: station.label.clone(),
        found: 0,
        needed: 1,
    }));
    Ok(used)
}

/// The whole curves where there are sweeps, one section a station otherwise; doubts about the sides carry over.
fn start(problem: &BallProblem, warnings: &mut Vec<Warning>) -> Result<State, SolveError> {
    if let Ok(state) = max_arc::state(problem) {
        return Ok(state);
    }
    let found = fixed_point::find(problem)?;
    let doubts = |warning: &&Warning| matches!(warning, Warning::SideAmbiguous { .. } | Warning::BlindInY { .. });
    warnings.extend(found.warnings.iter().filter(doubts).cloned());
    Ok(found.minimum.state)
}

/// The unknowns that minimise over all points, from a start of one's own; without validation.
///
/// # Errors
/// [`SolveError`] with fewer than four stations with a profile, or if they leave a direction free.
pub fn refine(problem: &BallProblem, start: State) -> Result<State, SolveError> {
    let stations = stations_with_profiles(problem, &mut Vec::new())?;
    let profiles = used_profiles(&stations, problem);
    let settled = settle(|state, radius_mm| linearised(&profiles, state, radius_mm), problem, start)?;
    Ok(settled.minimum.state)
}

fn used_profiles<'a>(stations: &[&'a Station], problem: &BallProblem) -> Vec<UsedProfile<'a>> {
    let arcs = || {
        stations.iter().enumerate().flat_map(|(station_idx, station)| {
            station.captures.iter().filter_map(move |capture| match &capture.reading {
                Reading::Arc(arc) => Some((station_idx, capture.base_from_flange.rigid(), arc.as_ref())),
                Reading::Edge(_) | Reading::Refused(_) | Reading::Point(_) | Reading::Pose(_) => None,
            })
        })
    };
    // One noise for all: a sensor does not change from profile to profile, and a single short arc estimates it badly.
    let point_std_mm = stats::rms(arcs().map(|(_, _, arc)| arc.point_std_mm)).max(LEAST_POINT_STD_MM);
    arcs()
        .map(|(station, base_from_flange, arc)| {
            // Noise in the laser plane acts on |p − s| with the factor l/R.
            let section_part = (arc.circle.radius_mm / problem.radius_mm).min(1.0);
            UsedProfile { station, base_from_flange, arc, weight: (section_part * point_std_mm).powi(-2) }
        })
        .collect()
}

fn linearised(profiles: &[UsedProfile<'_>], state: &State, ball_radius_mm: f64) -> Vec<CentreObservation> {
    profiles
        .iter()
        .map(|profile| {
            let centre = state.ball_in_sensor(profile.base_from_flange);
            let sums = profile_sums(profile.arc, centre, ball_radius_mm);
            CentreObservation {
                station: profile.station,
                base_from_flange: *profile.base_from_flange,
                centre_in_sensor: centre,
                information: sums.information * profile.weight,
                pull: sums.pull * profile.weight,
                constant: sums.cost * profile.weight,
            }
        })
        .collect()
}
