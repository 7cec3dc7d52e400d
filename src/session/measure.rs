//! From a session's profiles to arcs, and from these to the problem that the methods solve.

use std::sync::Arc;

use thiserror::Error;

use crate::calibrate::{self, BallProblem, Mount, Noise};
use crate::fit::{ArcFit, ArcOptions, ArcRefusal, extract_arc};
use crate::geometry::{Profile, Transform};
use crate::watch::{Cancelled, Watch};

use super::{Reading, Session, Target};

/// Why a session is none for the ball methods.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
#[error(
    "the session's target is {kind}, not a ball; the ball methods need \"target\": {{\"kind\": \"ball\", \"radius_mm\": …}}"
)]
pub struct NotABallSession {
    /// What the target is.
    pub kind: &'static str,
}

#[derive(Clone, Debug)]
struct MeasuredCapture {
    profile: Option<Arc<Profile>>,
    reading: calibrate::Reading,
}

/// The readings of all captures of a session, enabled or not: the arcs extracted from its profiles.
#[derive(Clone, Debug)]
pub struct Measured {
    options: ArcOptions,
    stations: Vec<Vec<MeasuredCapture>>,
}

impl Measured {
    /// What was found in a capture.
    #[must_use]
    pub fn reading(&self, station_idx: usize, capture_idx: usize) -> Option<&calibrate::Reading> {
        self.stations.get(station_idx)?.get(capture_idx).map(|capture| &capture.reading)
    }
}

/// Extracts the arcs of all profiles; those that `previous` already holds are taken over.
///
/// # Errors
/// [`Cancelled`] if `watch` says so. [`NotABallSession`] is answered by [`ball_problem`], so here another target
/// merely gives no arcs.
pub fn measure(session: &Session, previous: Option<&Measured>, watch: &mut dyn Watch) -> Result<Measured, Cancelled> {
    let ball_radius_mm = match session.target {
        Target::Ball { radius_mm, .. } => radius_mm,
        _ => 0.0,
    };
    let options = ArcOptions { ball_radius_mm, profile_std_mm: session.sensor.profile_std_mm };
    let previous = previous.filter(|measured| measured.options == options);
    let total = session.num_captures();
    let mut done = 0;
    let mut stations = Vec::with_capacity(session.stations.len());
    for (station_idx, station) in session.stations.iter().enumerate() {
        let mut captures = Vec::with_capacity(station.captures.len());
        for (capture_idx, capture) in station.captures.iter().enumerate() {
            watch.report(done, total)?;
            done += 1;
            captures.push(match &capture.reading {
                Reading::Point(point_in_sensor) => {
                    MeasuredCapture { profile: None, reading: calibrate::Reading::Point(*point_in_sensor) }
                }
                Reading::Profile(profile) => previous
                    .and_then(|measured| measured.stations.get(station_idx)?.get(capture_idx))
                    .filter(|known| known.profile.as_ref().is_some_and(|known| Arc::ptr_eq(known, profile)))
                    .cloned()
                    .unwrap_or_else(|| MeasuredCapture {
                        profile: Some(Arc::clone(profile)),
                        reading: match found_arc(profile, &session.target, &options) {
                            Ok(arc) => calibrate::Reading::Arc(Arc::new(arc)),
                            Err(refusal) => calibrate::Reading::Refused(refusal),
                        },
                    }),
            });
        }
        stations.push(captures);
    }
    Ok(Measured { options, stations })
}

fn found_arc(profile: &Profile, target: &Target, options: &ArcOptions) -> Result<ArcFit, ArcRefusal> {
    match target {
        Target::Ball { .. } => extract_arc(profile, options),
        _ => Err(ArcRefusal::NoBall),
    }
}

/// The problem posed by the enabled stations. For a fixed sensor every pose is inverted, see [`calibrate`].
///
/// # Errors
/// [`NotABallSession`] for any other target.
pub fn ball_problem(session: &Session, measured: &Measured) -> Result<BallProblem, NotABallSession> {
    let (radius_mm, radius_std_mm) = match &session.target {
        Target::Ball { radius_mm, radius_std_mm } => (*radius_mm, *radius_std_mm),
        Target::RightAnglePlate => return Err(NotABallSession { kind: "a right-angle plate" }),
        Target::Point => return Err(NotABallSession { kind: "a point" }),
        Target::Rgbd { .. } => return Err(NotABallSession { kind: "an RGB-D sequence" }),
    };
    let stations = session
        .stations
        .iter()
        .zip(&measured.stations)
        .enumerate()
        .filter(|(_, (station, _))| station.enabled)
        .map(|(idx, (station, readings))| {
            let mut travel_mm = Some(0.0);
            let captures = station
                .captures
                .iter()
                .zip(readings)
                .enumerate()
                .map(|(capture_idx, (capture, measured_capture))| {
                    if capture_idx > 0 {
                        travel_mm = travel_mm.zip(capture.step_mm).map(|(travel, step)| travel + step);
                    }
                    calibrate::Capture {
                        base_from_flange: match session.mount {
                            Mount::OnFlange => capture.base_from_flange,
                            Mount::Fixed => Transform::from_rigid(capture.base_from_flange.rigid().inverse()),
                        },
                        commanded_travel_mm: travel_mm,
                        reading: measured_capture.reading.clone(),
                    }
                })
                .collect();
            calibrate::Station { idx, label: station.label.clone(), side: station.side, captures }
        })
        .collect();
    Ok(BallProblem {
        radius_mm,
        radius_std_mm,
        mount: session.mount,
        noise: Noise {
            position_std_mm: session.robot.position_std_mm,
            orientation_std_rad: session.robot.orientation_std_deg.map(f64::to_radians),
        },
        reference_distance_mm: session.sensor.reference_distance_mm,
        stations,
    })
}
