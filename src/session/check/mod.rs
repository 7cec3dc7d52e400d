//! What is odd about a session that is otherwise as the format has it: things to look at before solving.

mod finding;
#[cfg(test)]
mod tests;

use std::collections::HashMap;

use crate::calibrate::ball::MIN_STATIONS;
use crate::geometry::stats::median;
use crate::geometry::{Rigid, Vec3};

pub use finding::Finding;

use super::{Capture, Edge, FurtherTarget, Reading, Session, Station, Target};

/// Poses nearer than this in position and ...
pub const TWIN_DISTANCE_MM: f64 = 0.5;
/// ... this in orientation say the same thing twice.
pub const TWIN_ANGLE_DEG: f64 = 0.5;
/// A point further than this from the laser plane, mm, was not rounded there.
pub const OUTSIDE_PLANE_MM: f64 = 1e-3;
/// No arm reaches further; beyond it the unit was hardly millimetres.
pub const REACH_MM: f64 = 10_000.0;
/// A pose is far from the others if it is further from their middle than most by this factor ...
pub const FAR_FROM_OTHERS_RATIO: f64 = 8.0;
/// ... and by this distance at least. Stations lie within a few hundred millimetres; a slipped digit is beyond.
pub const FAR_FROM_OTHERS_MM: f64 = 400.0;
/// Points on an edge of a plate that the paper asks for.
pub const STATIONS_AN_EDGE: usize = 6;
/// Fewer stations have no middle that one of them could be far from.
const MIN_STATIONS_FOR_MIDDLE: usize = 4;
/// Commanded step and moved distance may differ by this much and a tenth of the step.
pub const STEP_TOLERANCE_MM: f64 = 0.1;
/// The tenth.
pub const STEP_TOLERANCE_RATIO: f64 = 0.1;

/// What is odd about a session: first the session as a whole, then its stations in order, then its further targets.
#[must_use]
pub fn findings(session: &Session) -> Vec<Finding> {
    if matches!(session.target, Target::Rgbd { .. }) {
        return Vec::new();
    }
    let mut findings = missing_stations(&session.target, &session.stations);
    findings.extend(noise_not_given(session));
    findings.extend(of_stations(&session.target, &session.stations));
    for FurtherTarget { name, target, stations, .. } in &session.further {
        let missing = missing_stations(target, stations);
        findings.extend(
            missing
                .into_iter()
                .chain(of_stations(target, stations))
                .map(|finding| Finding::InFurther { name: name.clone(), finding: Box::new(finding) }),
        );
    }
    findings
}

/// Whether there are the stations that the methods for this target need.
fn missing_stations(target: &Target, stations: &[Station]) -> Vec<Finding> {
    if stations.is_empty() {
        return vec![Finding::NoStations];
    }
    let num_enabled =
        |is_counted: &dyn Fn(&Station) -> bool| stations.iter().filter(|s| s.enabled && is_counted(s)).count();
    match target {
        Target::Ball { .. } | Target::Point | Target::Pose { .. } => {
            let num_enabled = num_enabled(&|_| true);
            let is_few = num_enabled < MIN_STATIONS;
            is_few.then_some(Finding::FewStations { num_enabled, needed: MIN_STATIONS }).into_iter().collect()
        }
        Target::RightAnglePlate => [Edge::P, Edge::Q]
            .into_iter()
            .filter_map(|edge| match num_enabled(&|station| station.edge == Some(edge)) {
                0 => Some(Finding::EdgeWithoutStations { edge }),
                num_enabled if num_enabled < STATIONS_AN_EDGE => {
                    Some(Finding::FewOnEdge { edge, num_enabled, needed: STATIONS_AN_EDGE })
                }
                _ => None,
            })
            .collect(),
        // One scan is a workpiece measured.
        Target::Workpiece | Target::Rgbd { .. } => Vec::new(),
    }
}

/// What is odd about stations, in their order.
fn of_stations(target: &Target, stations: &[Station]) -> Vec<Finding> {
    let mut findings = Vec::new();
    // Two scans may well begin at the same pose.
    let mut twins = if *target == Target::Workpiece { HashMap::new() } else { twins(stations) };
    let mut far = far_from_others(stations);
    for (station_idx, station) in stations.iter().enumerate() {
        findings.extend(empty_profiles(station));
        // A ball's point is its centre, which is beside the plane.
        if matches!(target, Target::RightAnglePlate | Target::Point) {
            findings.extend(outside_plane(station));
        }
        match far_pose(station) {
            Some(finding) => findings.push(finding),
            None => findings.extend(far.remove(&station_idx)),
        }
        findings.extend(differing_step(station));
        findings.extend(twins.remove(&station_idx).into_iter().flatten());
    }
    findings
}

/// Of a workpiece nothing is solved that would need it.
fn noise_not_given(session: &Session) -> Option<Finding> {
    if session.target == Target::Workpiece {
        return None;
    }
    let has_profiles = session
        .stations
        .iter()
        .flat_map(|station| &station.captures)
        .any(|capture| matches!(capture.reading, Reading::Profile(_)));
    let fields: Vec<&'static str> = [
        ("sensor.profile_std_mm", has_profiles && session.sensor.profile_std_mm.is_none()),
        ("robot.position_std_mm", session.robot.position_std_mm.is_none()),
        ("robot.orientation_std_deg", session.robot.orientation_std_deg.is_none()),
    ]
    .into_iter()
    .filter_map(|(field, is_missing)| is_missing.then_some(field))
    .collect();
    (!fields.is_empty() && !session.stations.is_empty()).then_some(Finding::NoiseNotGiven { fields })
}

fn empty_profiles(station: &Station) -> impl Iterator<Item = Finding> + '_ {
    station.captures.iter().enumerate().filter_map(|(capture_idx, capture)| match &capture.reading {
        Reading::Profile(profile) if profile.is_empty() => {
            Some(Finding::NoReading { label: station.label.clone(), capture_idx })
        }
        Reading::Profile(profile) if profile.valid_points().next().is_none() => {
            Some(Finding::EmptyProfile { label: station.label.clone(), capture_idx })
        }
        _ => None,
    })
}

fn outside_plane(station: &Station) -> Option<Finding> {
    let y_mm = |capture: &Capture| match &capture.reading {
        Reading::Point(point) => Some(point.y),
        Reading::Profile(_) | Reading::Pose(_) => None,
    };
    (station.captures.iter().enumerate())
        .filter_map(|(capture_idx, capture)| Some((capture_idx, y_mm(capture)?)))
        .filter(|(_, y_mm)| y_mm.abs() > OUTSIDE_PLANE_MM)
        .max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))
        .map(|(capture_idx, y_mm)| Finding::PointOutsidePlane { label: station.label.clone(), capture_idx, y_mm })
}

fn far_pose(station: &Station) -> Option<Finding> {
    let distance_mm = |capture: &Capture| capture.base_from_flange.translation_mm().norm();
    station
        .captures
        .iter()
        .enumerate()
        .map(|(capture_idx, capture)| (capture_idx, distance_mm(capture)))
        .filter(|(_, distance_mm)| *distance_mm > REACH_MM)
        .max_by(|a, b| a.1.total_cmp(&b.1))
        .map(|(capture_idx, distance_mm)| Finding::FarPose { label: station.label.clone(), capture_idx, distance_mm })
}

fn differing_step(station: &Station) -> Option<Finding> {
    station
        .captures
        .windows(2)
        .enumerate()
        .filter_map(|(idx, pair)| {
            let step_mm = pair[1].step_mm?;
            let moved = pair[1].base_from_flange.translation_mm() - pair[0].base_from_flange.translation_mm();
            Some((idx + 1, step_mm, moved.norm()))
        })
        .map(|(capture_idx, step_mm, moved_mm)| (capture_idx, step_mm, moved_mm, (step_mm.abs() - moved_mm).abs()))
        .filter(|(_, step_mm, _, difference)| *difference > STEP_TOLERANCE_MM + STEP_TOLERANCE_RATIO * step_mm.abs())
        .max_by(|a, b| a.3.total_cmp(&b.3))
        .map(|(capture_idx, step_mm, moved_mm, _)| Finding::StepDiffersFromPose {
            label: station.label.clone(),
            capture_idx,
            step_mm,
            moved_mm,
        })
}

/// The first capture's pose stands for its station.
fn pose_of(station: &Station) -> Option<&Rigid> {
    station.captures.first().map(|capture| capture.base_from_flange.rigid())
}

/// The stations whose positions lie outside the crowd, by their indices.
fn far_from_others(stations: &[Station]) -> HashMap<usize, Finding> {
    let positions: Vec<(usize, Vec3)> = (stations.iter().enumerate())
        .filter(|(_, station)| station.enabled)
        .filter_map(|(station_idx, station)| Some((station_idx, pose_of(station)?.translation.vector)))
        .collect();
    if positions.len() < MIN_STATIONS_FOR_MIDDLE {
        return HashMap::new();
    }
    let median_of = |values: &dyn Fn(&Vec3) -> f64| {
        median(&mut positions.iter().map(|(_, position)| values(position)).collect::<Vec<f64>>())
    };
    let middle = Vec3::from_fn(|axis, _| median_of(&|position| position[axis]));
    let distance_mm = |position: &Vec3| (position - middle).norm();
    let typical_mm = median_of(&distance_mm);
    let limit_mm = (FAR_FROM_OTHERS_RATIO * typical_mm).max(FAR_FROM_OTHERS_MM);
    (positions.iter())
        .filter(|(_, position)| distance_mm(position) > limit_mm)
        .map(|(station_idx, position)| {
            let label = stations[*station_idx].label.clone();
            (*station_idx, Finding::FarFromOthers { label, distance_mm: distance_mm(position), typical_mm })
        })
        .collect()
}

/// Stations with the same pose as an earlier one, by the index of that one; each is named once. For the plate and the
/// point twins are as useless as for the ball.
///
/// Poses are sorted into cells of space as wide as twins may be apart, so only neighbours are compared.
fn twins(stations: &[Station]) -> HashMap<usize, Vec<Finding>> {
    #[expect(clippy::cast_possible_truncation, reason = "positions are within 1e6 mm")]
    let cell_of = |position: &Vec3| [0, 1, 2].map(|axis| (position[axis] / TWIN_DISTANCE_MM).floor() as i64);
    let mut earlier: HashMap<[i64; 3], Vec<usize>> = HashMap::new();
    let mut twins: HashMap<usize, Vec<Finding>> = HashMap::new();
    for (station_idx, station) in stations.iter().enumerate().filter(|(_, station)| station.enabled) {
        let Some(pose) = pose_of(station) else { continue };
        let [x, y, z] = cell_of(&pose.translation.vector);
        let neighbours = (0..27_i64).map(|n| [x + n % 3 - 1, y + n / 3 % 3 - 1, z + n / 9 - 1]);
        let twin = (neighbours.filter_map(|cell| earlier.get(&cell)).flatten())
            .filter_map(|other_idx| {
                let other = pose_of(&stations[*other_idx])?;
                let distance_mm = (pose.translation.vector - other.translation.vector).norm();
                let angle_deg = pose.rotation.angle_to(&other.rotation).to_degrees();
                let is_twin = distance_mm < TWIN_DISTANCE_MM && angle_deg < TWIN_ANGLE_DEG;
                is_twin.then_some((*other_idx, distance_mm, angle_deg))
            })
            .min_by_key(|(other_idx, ..)| *other_idx);
        if let Some((other_idx, distance_mm, angle_deg)) = twin {
            let label = stations[other_idx].label.clone();
            let twin_label = station.label.clone();
            let finding = Finding::TwinStations { label, twin_label, distance_mm, angle_deg };
            twins.entry(other_idx).or_default().push(finding);
        } else {
            // A twin adds nothing that its first does not say.
            earlier.entry([x, y, z]).or_default().push(station_idx);
        }
    }
    twins
}
