//! What is odd about a session that is otherwise as the format has it: things to look at before solving.

use std::collections::HashMap;

use crate::calibrate::ball::MIN_STATIONS;
use crate::geometry::stats::median;
use crate::geometry::{Rigid, Vec3};

use super::{Capture, Edge, FurtherTarget, Reading, Session, Station, Target};

/// Poses nearer than this in position and ...
pub const TWIN_DISTANCE_MM: f64 = 0.5;
/// ... this in orientation say the same thing twice.
pub const TWIN_ANGLE_DEG: f64 = 0.5;
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

/// Something to look at in a session; the wording is on the floor above.
#[derive(Clone, Debug, PartialEq)]
pub enum Finding {
    /// Quaternions in the file were rounded so much that they had to be normalised.
    QuaternionsNormalised {
        /// How many.
        num_poses: usize,
        /// The one furthest off unit norm.
        worst_path: String,
        /// Its norm.
        worst_norm: f64,
    },
    /// There are no stations yet.
    NoStations,
    /// Too few stations are enabled.
    FewStations {
        /// How many are enabled.
        num_enabled: usize,
        /// How many are needed.
        needed: usize,
    },
    /// No station that takes part saw this edge of the plate.
    EdgeWithoutStations {
        /// The edge.
        edge: Edge,
    },
    /// Few stations that take part saw this edge of the plate.
    FewOnEdge {
        /// The edge.
        edge: Edge,
        /// How many are enabled.
        num_enabled: usize,
        /// How many are needed.
        needed: usize,
    },
    /// Something to look at in a further target.
    InFurther {
        /// Its name.
        name: String,
        /// What there is.
        finding: Box<Finding>,
    },
    /// Two stations measured from the same pose.
    TwinStations {
        /// The first.
        label: String,
        /// The second.
        twin_label: String,
        /// Distance of the two, mm.
        distance_mm: f64,
        /// Angle between the two, degrees.
        angle_deg: f64,
    },
    /// A pose at which nothing was measured.
    NoReading {
        /// Its station.
        label: String,
        /// Which capture, from 0.
        capture_idx: usize,
    },
    /// A profile without a single valid point.
    EmptyProfile {
        /// Its station.
        label: String,
        /// Which capture, from 0.
        capture_idx: usize,
    },
    /// The robot moved by another distance than was commanded.
    StepDiffersFromPose {
        /// The station.
        label: String,
        /// The capture that was stepped to, from 0: the one where they differ most.
        capture_idx: usize,
        /// The commanded step, mm.
        step_mm: f64,
        /// The distance between the recorded poses, mm.
        moved_mm: f64,
    },
    /// A pose further away than any arm reaches.
    FarPose {
        /// The station.
        label: String,
        /// Which capture, from 0: the farthest.
        capture_idx: usize,
        /// Its distance from the base, mm.
        distance_mm: f64,
    },
    /// A station far from all others: a slipped digit or sign, or another unit.
    FarFromOthers {
        /// The station.
        label: String,
        /// Its distance from the middle of the stations, mm.
        distance_mm: f64,
        /// The distance that half of them keep, mm.
        typical_mm: f64,
    },
    /// Noise figures are missing, so they will be estimated.
    NoiseNotGiven {
        /// The fields, as the file would name them.
        fields: Vec<&'static str>,
    },
}

impl Finding {
    /// A stable name for other programs.
    #[must_use]
    pub const fn code(&self) -> &'static str {
        match self {
            Self::QuaternionsNormalised { .. } => "quaternions-normalised",
            Self::NoStations => "no-stations",
            Self::FewStations { .. } => "few-stations",
            Self::EdgeWithoutStations { .. } => "edge-without-stations",
            Self::FewOnEdge { .. } => "few-on-edge",
            Self::InFurther { finding, .. } => finding.code(),
            Self::TwinStations { .. } => "twin-stations",
            Self::NoReading { .. } => "no-reading",
            Self::EmptyProfile { .. } => "empty-profile",
            Self::StepDiffersFromPose { .. } => "step-differs-from-pose",
            Self::FarPose { .. } => "far-pose",
            Self::FarFromOthers { .. } => "far-from-others",
            Self::NoiseNotGiven { .. } => "noise-not-given",
        }
    }

    /// Whether it says that stations are missing without which nothing can be solved.
    #[must_use]
    pub const fn lacks_stations(&self) -> bool {
        matches!(self, Self::NoStations | Self::FewStations { .. } | Self::EdgeWithoutStations { .. })
    }

    /// The station of the session's own target that it is about, if it is about one.
    #[must_use]
    pub fn station_label(&self) -> Option<&str> {
        match self {
            Self::TwinStations { label, .. }
            | Self::NoReading { label, .. }
            | Self::EmptyProfile { label, .. }
            | Self::StepDiffersFromPose { label, .. }
            | Self::FarPose { label, .. }
            | Self::FarFromOthers { label, .. } => Some(label),
            Self::QuaternionsNormalised { .. }
            | Self::NoStations
            | Self::FewStations { .. }
            | Self::EdgeWithoutStations { .. }
            | Self::FewOnEdge { .. }
            | Self::InFurther { .. }
            | Self::NoiseNotGiven { .. } => None,
        }
    }
}

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
        Target::Ball { .. } | Target::Point => {
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

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::geometry::{Profile, Transform, Vec3, so3};
    use crate::session::format::parse;
    use crate::session::model::UnknownFields;

    /// Four stations with nothing odd about them.
    fn session() -> Session {
        let json = r#"{"format": "handeye-session", "version": 1, "target": {"kind": "ball", "radius_mm": 15},
            "robot": {"position_std_mm": 0.02, "orientation_std_deg": 0.005}, "sensor": {"profile_std_mm": 0.01},
            "stations": []}"#;
        let mut session = parse(json.as_bytes(), "test").expect("valid");
        for idx in 0..4 {
            let capture = |y_mm: f64, step_mm| Capture {
                base_from_flange: Transform::from_parts(
                    Vec3::new(500.0, y_mm, 300.0),
                    so3::exp(Vec3::x() * f64::from(idx)),
                ),
                written_angles: None,
                reading: Reading::Profile(Arc::new(Profile::new(vec![0.0], &[Some(80.0)]).expect("valid"))),
                step_mm,
                unknown: UnknownFields::new(),
            };
            session.stations.push(Station {
                label: format!("s{idx}"),
                enabled: true,
                side: crate::calibrate::SideChoice::Auto,
                edge: None,
                captures: vec![capture(0.0, None), capture(-0.5, Some(-0.5)), capture(-1.02, Some(-0.5))],
                unknown: UnknownFields::new(),
            });
        }
        session
    }

    #[track_caller]
    fn check(change: impl FnOnce(&mut Session), expected: &[Finding]) {
        let mut session = session();
        change(&mut session);
        assert_eq!(findings(&session), expected);
    }

    #[test]
    fn a_session_in_order_has_no_findings() {
        check(|_| {}, &[]);
    }

    #[test]
    fn the_session_as_a_whole() {
        check(|session| session.stations.clear(), &[Finding::NoStations]);
        check(|session| session.stations[2].enabled = false, &[Finding::FewStations { num_enabled: 3, needed: 4 }]);
        check(
            |session| {
                session.robot.position_std_mm = None;
                session.sensor.profile_std_mm = None;
            },
            &[Finding::NoiseNotGiven { fields: vec!["sensor.profile_std_mm", "robot.position_std_mm"] }],
        );
    }

    #[test]
    fn twins_are_found_unless_one_is_left_out() {
        let make_twin = |session: &mut Session| session.stations[3].captures = session.stations[1].captures.clone();
        check(
            make_twin,
            &[Finding::TwinStations {
                label: "s1".to_owned(),
                twin_label: "s3".to_owned(),
                distance_mm: 0.0,
                angle_deg: 0.0,
            }],
        );
        check(
            |session| {
                make_twin(session);
                session.stations[3].enabled = false;
            },
            &[Finding::FewStations { num_enabled: 3, needed: 4 }],
        );
    }

    #[test]
    fn captures_that_are_empty_far_or_off_their_step() {
        let label = || "s1".to_owned();
        check(
            |session| {
                let empty = Profile::new(vec![0.0], &[None]).expect("valid");
                session.stations[1].captures[2].reading = Reading::Profile(Arc::new(empty));
            },
            &[Finding::EmptyProfile { label: label(), capture_idx: 2 }],
        );
        check(
            |session| session.stations[1].captures[1].step_mm = Some(-0.75),
            &[Finding::StepDiffersFromPose { label: label(), capture_idx: 1, step_mm: -0.75, moved_mm: 0.5 }],
        );
        check(
            |session| {
                session.stations[1].captures.truncate(1);
                let rotation = session.stations[1].captures[0].base_from_flange.rotation();
                session.stations[1].captures[0].base_from_flange =
                    Transform::from_parts(Vec3::new(0.0, 0.0, 20_000.0), rotation);
            },
            &[Finding::FarPose { label: label(), capture_idx: 0, distance_mm: 20_000.0 }],
        );
    }

    #[test]
    fn a_pose_with_a_slipped_digit_is_far_from_the_others() {
        check(
            |session| {
                let pose = &mut session.stations[1].captures;
                pose.truncate(1);
                pose[0].base_from_flange =
                    Transform::from_parts(Vec3::new(5000.0, 0.0, 300.0), pose[0].base_from_flange.rotation());
            },
            &[Finding::FarFromOthers { label: "s1".to_owned(), distance_mm: 4500.0, typical_mm: 0.0 }],
        );
    }

    #[test]
    fn a_pose_without_a_reading_says_so() {
        check(
            |session| session.stations[2].captures[0].reading = Reading::Profile(Arc::new(Profile::default())),
            &[Finding::NoReading { label: "s2".to_owned(), capture_idx: 0 }],
        );
    }

    #[test]
    fn a_plate_needs_stations_on_both_edges() {
        let on_edges = |session: &mut Session, edges: &str| {
            session.target = Target::RightAnglePlate;
            let given = session.stations[0].clone();
            let edge = |letter| if letter == 'p' { Edge::P } else { Edge::Q };
            let shift = |idx: usize| Vec3::new(0.0, 10.0 * f64::from(u32::try_from(idx).unwrap_or_default()), 0.0);
            session.stations = (edges.chars().enumerate())
                .map(|(idx, letter)| {
                    let mut station = Station { label: idx.to_string(), edge: Some(edge(letter)), ..given.clone() };
                    station.captures.truncate(1);
                    let pose = &mut station.captures[0].base_from_flange;
                    *pose = Transform::from_parts(pose.translation_mm() + shift(idx), pose.rotation());
                    station
                })
                .collect();
        };
        check(|session| on_edges(session, "ppppppqqqqqq"), &[]);
        check(|session| on_edges(session, "pppppp"), &[Finding::EdgeWithoutStations { edge: Edge::Q }]);
        check(
            |session| {
                on_edges(session, "ppppppqqqqqq");
                session.stations[7].enabled = false;
            },
            &[Finding::FewOnEdge { edge: Edge::Q, num_enabled: 5, needed: 6 }],
        );
    }

    #[test]
    fn further_targets_are_looked_at_as_well() {
        let in_tip = |finding| Finding::InFurther { name: "tip".to_owned(), finding: Box::new(finding) };
        let tip = |stations| FurtherTarget {
            name: "tip".to_owned(),
            target: Target::Point,
            known: super::super::Known::default(),
            stations,
            unknown: UnknownFields::new(),
        };
        check(|session| session.further.push(tip(Vec::new())), &[in_tip(Finding::NoStations)]);
        check(
            |session| session.further.push(tip(session.stations[..2].to_vec())),
            &[in_tip(Finding::FewStations { num_enabled: 2, needed: 4 })],
        );
        assert_eq!(in_tip(Finding::NoStations).code(), "no-stations");
        let far = Finding::FarPose { label: "1".to_owned(), capture_idx: 0, distance_mm: 20_000.0 };
        assert_eq!(in_tip(far).station_label(), None, "labels are those of the session's own stations");
    }

    #[test]
    fn a_workpiece_needs_one_scan_and_no_noise() {
        check(
            |session| {
                session.target = Target::Workpiece;
                session.robot.position_std_mm = None;
                session.stations.truncate(1);
            },
            &[],
        );
    }

    #[test]
    fn findings_name_their_station_and_a_code() {
        let finding = Finding::EmptyProfile { label: "7".to_owned(), capture_idx: 0 };
        assert_eq!((finding.code(), finding.station_label()), ("empty-profile", Some("7")));
    }
}
