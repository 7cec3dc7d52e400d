//! Did the ball drift, or was a TOOL switched, while the session was recorded?

use nalgebra::Translation3;

use crate::calibrate::{BallProblem, Method, Mount, Station, solve};
use crate::diagnose::finding::{Evidence, Fault, Finding, Plot, Severity};
use crate::diagnose::model::{Extension, Unknowns};
use crate::diagnose::remedy::Remedy;
use crate::geometry::Rigid;

use super::{Solved, Tried, falls_by};

/// A drift below this, mm, is what warm robots do anyway.
const LEAST_DRIFT_MM: f64 = 0.1;
/// A frame nearer to the first than this (mm, or mm at a lever of 100 mm) is no other TOOL.
const LEAST_FRAME_MM: f64 = 0.3;
/// Nothing is said of a motion below this many standard deviations.
const LEAST_STDS: f64 = 4.0;
/// With fewer stations three more unknowns fit almost anything.
const MIN_STATIONS_FOR_DRIFT: usize = 8;
/// A frame of its own needs as many stations as a calibration.
const MIN_STATIONS_EACH: usize = crate::calibrate::ball::MIN_STATIONS;

pub(super) fn examine(solved: &Solved<'_>) -> Option<Finding> {
    let can_tell = solved.model.used_stations().count() >= MIN_STATIONS_FOR_DRIFT;
    let drift = can_tell.then(|| solved.tried(Extension::Drift)).flatten();
    let frame = second_frame(solved);
    let explained = |tried: &Option<Tried>| tried.as_ref().map_or(f64::INFINITY, |tried| tried.fit.rms_mm);
    if explained(&drift) <= explained(&frame) {
        drift.filter(|drift| !one_station_explains_it(solved, drift)).and_then(|drift| drift_finding(solved, &drift))
    } else {
        frame.filter(|frame| !one_station_explains_it(solved, frame)).and_then(|frame| frame_finding(solved, &frame))
    }
}

/// The station from which on another frame explains the data best.
fn second_frame(solved: &Solved<'_>) -> Option<Tried> {
    let used: Vec<usize> = solved.model.used_stations().collect();
    let last = used.len().checked_sub(MIN_STATIONS_EACH)?;
    let is_far_off = solved.is_far_off(&solved.plain);
    let scanned = used.get(MIN_STATIONS_EACH..=last)?.iter().flat_map(|from| {
        let starts = [Some(solved.plain.unknowns), is_far_off.then(|| from_two_parts(solved, *from)).flatten()];
        starts.into_iter().flatten().filter_map(move |start| {
            let extension = Extension::SecondFrame { from: *from };
            Some((extension, solved.model.fit_as(extension, start, &solved.plain)?))
        })
    });
    let (extension, coarse) = scanned.min_by(|a, b| a.1.rms_mm.total_cmp(&b.1.rms_mm))?;
    let fit = solved.model.fit(extension, coarse.unknowns)?;
    solved.judged(extension, fit)
}

/// A start for two frames that are far from each other: each part of the session calibrated by itself.
fn from_two_parts(solved: &Solved<'_>, from: usize) -> Option<Unknowns> {
    let state = |stations: &[Station]| {
        let part = BallProblem { stations: stations.to_vec(), ..solved.case.problem.clone() };
        // A start only, so the quick methods will do.
        let solution = solve(&part, Method::BallMaxArcStep).or_else(|_| solve(&part, Method::BallFixedPoint)).ok()?;
        Some(solution.reduced?.state)
    };
    let (before, after) = solved.case.problem.stations.split_at(from);
    let (first, second) = (state(before)?, state(after)?);
    let first_from_second = match solved.model.mount() {
        Mount::OnFlange => first.flange_from_sensor.inverse() * second.flange_from_sensor,
        Mount::Fixed => Translation3::from(second.ball_in_base - first.ball_in_base).into(),
    };
    Some(Unknowns { state: first, first_from_second, ..solved.plain.unknowns })
}

/// Whether the data fit as well without one of the stations: then that one is the matter, not a motion.
fn one_station_explains_it(solved: &Solved<'_>, tried: &Tried) -> bool {
    solved.model.used_stations().any(|station| {
        solved
            .model
            .without(station)
            .and_then(|others| others.fit_as(Extension::Plain, solved.plain.unknowns, &tried.fit))
            .is_some_and(|others| others.fits_no_worse_than(&tried.fit))
    })
}

fn drift_finding(solved: &Solved<'_>, tried: &Tried) -> Option<Finding> {
    let total_in_base_mm = tried.fit.unknowns.drift_mm;
    let length_mm = total_in_base_mm.norm();
    let direction = total_in_base_mm.try_normalize(1e-9)?;
    let std_mm = tried.fit.extra_std_along(direction);
    let matters = length_mm > LEAST_DRIFT_MM && length_mm > LEAST_STDS * std_mm;
    let points = solved
        .model
        .station_shifts(&tried.fit)
        .into_iter()
        .map(|(station, shift)| {
            #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^52 stations")]
            let number = (solved.session_idx(station) + 1) as f64;
            [number, shift.dot(&direction)]
        })
        .collect();
    let residual_mm = solved.residual_mm(tried);
    matters.then(|| Finding {
        fault: Fault::Drift { total_in_base_mm, std_mm },
        severity: Severity::Wrong,
        explains: falls_by(residual_mm),
        evidence: Evidence {
            residual_mm: Some(residual_mm),
            plot: Some(Plot::Trend { points, line: [-0.5 * length_mm, 0.5 * length_mm] }),
        },
        remedy: None,
    })
}

fn frame_finding(solved: &Solved<'_>, tried: &Tried) -> Option<Finding> {
    let Extension::SecondFrame { from } = tried.extension else { return None };
    let flange_from_tool = flange_from_tool(solved, tried);
    let size_mm = flange_from_tool.translation.vector.norm() + 100.0 * flange_from_tool.rotation.angle();
    let from_station_idx = solved.session_idx(from);
    let residual_mm = solved.residual_mm(tried);
    (size_mm > LEAST_FRAME_MM).then(|| Finding {
        fault: Fault::ToolFrame { from_station_idx, flange_from_tool },
        severity: Severity::Wrong,
        explains: falls_by(residual_mm),
        evidence: Evidence { residual_mm: Some(residual_mm), plot: None },
        remedy: Some(Remedy::RemoveTool { from_station_idx, flange_from_tool }),
    })
}

/// The frame that the controller reported instead of the flange.
///
/// For [`Mount::Fixed`] the ball shows where it is in that frame only, so the frame's orientation stays open and is taken
/// to be the flange's; the calibration is the same with any.
fn flange_from_tool(solved: &Solved<'_>, tried: &Tried) -> Rigid {
    let unknowns = tried.fit.unknowns;
    match solved.model.mount() {
        Mount::OnFlange => {
            let flange_from_sensor = unknowns.state.flange_from_sensor;
            // The sensor in the tool is X S = F⁻¹ X.
            flange_from_sensor * (flange_from_sensor * unknowns.first_from_second).inverse()
        }
        Mount::Fixed => Rigid::from_parts(
            Translation3::from(-unknowns.first_from_second.translation.vector),
            nalgebra::UnitQuaternion::identity(),
        ),
    }
}
