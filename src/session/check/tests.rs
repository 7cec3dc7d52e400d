//! One session in order, and what each change makes of it.

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
        profile_std_mm: None,
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

#[test]
fn a_point_of_a_profiler_is_in_its_plane_but_a_balls_centre_is_not() {
    let with_point = |target: Target| {
        move |session: &mut Session| {
            session.target = target;
            for station in &mut session.stations {
                station.edge = Some(Edge::P);
            }
            session.stations[1].captures[2].reading = Reading::Point(Vec3::new(1.0, -5.0, 80.0));
            session.stations[2].captures[0].reading = Reading::Point(Vec3::new(1.0, 1e-12, 80.0));
        }
    };
    let outside = Finding::PointOutsidePlane { label: "s1".to_owned(), capture_idx: 2, y_mm: -5.0 };
    check(with_point(Target::Point), std::slice::from_ref(&outside));
    check(
        with_point(Target::RightAnglePlate),
        &[
            Finding::FewOnEdge { edge: Edge::P, num_enabled: 4, needed: STATIONS_AN_EDGE },
            Finding::EdgeWithoutStations { edge: Edge::Q },
            outside,
        ],
    );
    check(with_point(Target::Ball { radius_mm: 15.0, radius_std_mm: None }), &[]);
}
