//! Every fault has its words, and they are short.

use super::*;
use crate::calibrate::{Edge, Mount, SideChoice, SolveError, Warning};
use crate::diagnose::convention::{AngleUnit, Inversion, LengthUnit, QuaternionOrder, RotationReading};
use crate::diagnose::{Axis, Fault, PoseReading, Remedy};
use crate::geometry::Vec3;
use crate::session::Session;

use crate::calibrate::Side;
use crate::diagnose::convention::AngleReading;
use crate::fit::ArcRefusal;
use crate::geometry::{PoseConvention, Rigid};
use crate::simulate::{SimulationOptions, simulate};

fn session(mount: Mount) -> Session {
    simulate(&SimulationOptions { num_stations: 9, num_steps: 1, num_points: 2, mount, ..Default::default() })
}

fn angles(from: &str, to: &str, unit: AngleUnit) -> PoseReading {
    let order = |id: &str| PoseConvention::by_id(id).expect("known").order;
    let rotation = RotationReading::Angles(AngleReading {
        from: order(from),
        to: order(to),
        unit,
        second_at_station_idxs: Vec::new(),
    });
    PoseReading { rotation, ..PoseReading::default() }
}

fn longest_reading() -> PoseReading {
    PoseReading {
        inversion: Inversion::WholePose,
        length_unit: LengthUnit::Micrometres,
        ..angles("kuka-abc", "fanuc-wpr", AngleUnit::Radians)
    }
}

#[test]
fn ways_to_read_poses_have_all_their_names() {
    let fanuc = angles("kuka-abc", "fanuc-wpr", AngleUnit::Degrees);
    assert_eq!(pose_reading(&fanuc), "FANUC W P R");
    assert_eq!(
        pose_reading_in_full(&fanuc),
        "FANUC W P R, also Yaskawa, Mitsubishi, … (extrinsic XYZ = intrinsic ZYX read backwards)"
    );
    let in_radians = angles("ur-rotvec", "ur-rotvec", AngleUnit::Radians);
    assert_eq!(pose_reading_in_full(&in_radians), "UR RX RY RZ in radians");
    assert_eq!(pose_reading(&PoseReading::default()), "given");
}

fn faults() -> Vec<Fault> {
    let tilted = Vec3::new(0.6, -0.8, 0.0);
    let label = || "station with a long label".to_owned();
    let unsolved = [
        SolveError::TooFewStations { found: 1, needed: 4, refusal: Some(ArcRefusal::NoBall.into()) },
        SolveError::TooFewProfileStations { found: 3, needed: 4, refusal: None },
        SolveError::TooFewSweeps { found: 0, needed: 4, steps: 3, refusal: None },
        SolveError::NoRotation { span_deg: 0.02 },
        SolveError::RotationsAboutOneAxis { axis_x: 0.0, axis_y: -1.0, axis_z: 0.01 },
        SolveError::Undetermined { condition: 1e15 },
        SolveError::Diverged,
    ];
    let warned = [
        Warning::FewStations { num_stations: 4, recommended: 8 },
        Warning::SideAmbiguous { labels: vec!["1".to_owned(), "2".to_owned()], ratio: 1.2 },
        Warning::BlindInY { labels: vec!["1".to_owned()], std_y_mm: 0.4, std_xz_mm: 0.01 },
        Warning::ArcLargerThanBall { label: label(), capture_idx: 3, section_radius_mm: 15.2, ball_radius_mm: 15.0 },
        Warning::StationSkipped { label: label(), found: 1, needed: 3 },
        Warning::PeakNotCovered { label: label(), beyond_mm: 2.0 },
        Warning::RadiusDisagrees { found_mm: 15.1, std_mm: 0.01, ball_radius_mm: 15.0 },
        Warning::StationStandsOut { label: label(), error_mm: 2.0, typical_mm: 0.04 },
        Warning::NotConverged { num_iterations: 60 },
    ];
    let mut faults = vec![
        Fault::PosesMisread { reading: longest_reading() },
        Fault::PosesMisread {
            reading: PoseReading {
                rotation: RotationReading::Quaternion(QuaternionOrder::Xyzw),
                ..PoseReading::default()
            },
        },
        Fault::PosesMisread { reading: PoseReading { length_unit: LengthUnit::Inches, ..PoseReading::default() } },
        Fault::WrongSides { station_idxs: vec![1] },
        Fault::WrongSides { station_idxs: (0..9).collect() },
        Fault::MirroredAxis { axis: Axis::X },
        Fault::MirroredAxis { axis: Axis::Z },
        Fault::NoRotation { span_deg: 0.02 },
        Fault::LittleRotation { span_deg: 12.3, recommended_deg: 40.0, weakest: None },
        Fault::LittleRotation { span_deg: 12.3, recommended_deg: 40.0, weakest: Some((tilted, 0.831)) },
        Fault::OneAxis { axis_in_flange: tilted, ratio: None },
        Fault::OneAxis { axis_in_flange: Vec3::z(), ratio: Some(17.0) },
        Fault::TwinPoses { station_idxs: [1, 4], distance_mm: 0.01, angle_deg: 0.0 },
        Fault::WrongRadius { found_mm: 15.304_2, std_mm: 0.003_1, given_mm: 15.0 },
        Fault::ProfileScale { factor: 1.012, std: 0.000_4 },
        Fault::ProfileScale { factor: 0.001, std: 1e-7 },
        Fault::TravelOffNormal { station_idx: 2, angle_deg: 4.2 },
        Fault::StepDiffersFromPose { station_idx: 2, ratio: 1.05, difference_mm: 0.4 },
        Fault::Drift { total_in_base_mm: tilted * 0.4, std_mm: 0.05 },
        Fault::ToolFrame { from_station_idx: 5, flange_from_tool: Rigid::translation(0.0, 0.0, 120.0) },
        Fault::SensorIsTool { distance_mm: 0.4, angle_deg: 0.02 },
        Fault::WrongPose { station_idx: 3, off_mm: 2.13, typical_mm: 0.031 },
        Fault::WrongStation { station_idx: 3, off_mm: 2.13, typical_mm: 0.031 },
        Fault::WrongEdge { station_idx: 3, edge: Edge::Q },
        Fault::StalePose { station_idx: 3, pose_of_idx: 2, off_mm: 32.0 },
        Fault::MixedOrder { poses_from: vec![(3, 4), (4, 3)] },
        Fault::MixedOrder { poses_from: (0..9).map(|idx| (idx, 8 - idx)).collect() },
        Fault::TooFewCleanStations { clean: 4, needed: 7 },
        Fault::NoiseAboveStated { ratio: 3.2, p_value: 1e-9 },
        Fault::HalvesDisagree { median_mm: 0.8, expected_mm: 0.12 },
        Fault::ResidualsNotNormal { p_value: 0.004 },
        Fault::DoesNotFit { scatter_mm: 97.2 },
    ];
    faults.extend(unsolved.map(Fault::NotSolved));
    faults.extend(warned.map(Fault::Method));
    faults
}

/// What fits two lines of a panel.
fn check_sentence(sentence: &str, fault: &Fault) {
    let length = sentence.chars().count();
    assert!((10..=220).contains(&length), "{fault:?}: {length} characters: {sentence}");
    assert!(sentence.ends_with('.'), "{fault:?}: {sentence}");
    assert!(sentence.starts_with(|first: char| first.is_uppercase()), "{fault:?}: {sentence}");
}

#[test]
fn every_fault_has_a_title_a_sentence_and_a_remedy() {
    for mount in [Mount::OnFlange, Mount::Fixed] {
        let session = session(mount);
        for fault in faults() {
            assert!((5..=40).contains(&fault_title(&fault).chars().count()), "{fault:?}");
            check_sentence(&fault_message(&fault, &session), &fault);
            check_sentence(&fault_remedy(&fault, &session), &fault);
        }
    }
}

#[test]
fn stations_out_of_range_are_no_panic() {
    let fault = Fault::StalePose { station_idx: 99, pose_of_idx: 98, off_mm: 1.0 };
    assert!(fault_message(&fault, &session(Mount::OnFlange)).contains('?'));
}

#[test]
fn buttons_say_what_they_do() {
    let session = session(Mount::OnFlange);
    for (remedy, label, undo) in [
        (Remedy::LeaveOut(vec![3]), "Leave out station 4", "leave out station 4"),
        (Remedy::LeaveOut(vec![3, 6]), "Leave out stations 4 and 7", "leave out stations 4 and 7"),
        (Remedy::SetRadius(15.304_2), "Set radius to 15.304 mm", "set radius to 15.304 mm"),
        (
            Remedy::SetSides(vec![(1, SideChoice::Given(Side::Minus))]),
            "Set side of station 2 to −",
            "set side of station 2 to −",
        ),
        (
            Remedy::SetSides(vec![(1, SideChoice::Auto), (2, SideChoice::Auto)]),
            "Turn sides of stations 2 and 3",
            "turn sides of stations 2 and 3",
        ),
        (
            Remedy::TakePosesFrom(vec![(3, 4), (4, 3)]),
            "Exchange poses of stations 4 and 5",
            "exchange poses of stations 4 and 5",
        ),
        (
            Remedy::TakePosesFrom(vec![(3, 4)]),
            "Give station 4 the pose of station 5",
            "give station 4 the pose of station 5",
        ),
        (Remedy::SetEdge { station_idx: 3, edge: Edge::Q }, "Set edge of station 4 to q", "set edge of station 4 to q"),
        (Remedy::ScaleProfiles(1.012), "Scale profiles by 1.0120", "scale profiles by 1.0120"),
        (Remedy::MirrorProfiles(Axis::Z), "Turn z axis of profiles", "turn z axis of profiles"),
        (
            Remedy::RemoveTool { from_station_idx: 5, flange_from_tool: Rigid::identity() },
            "Take TOOL out of poses from station 6",
            "take TOOL out of poses from station 6",
        ),
    ] {
        assert_eq!(remedy_label(&remedy, &session), label);
        assert_eq!(remedy_undo_label(&remedy, &session), undo);
    }
}

#[test]
fn directions_are_named_by_the_frame_that_the_sensor_is_mounted_on() {
    assert_eq!(along(Vec3::new(0.1, -0.02, -0.99), Mount::OnFlange), "along the flange's z");
    assert_eq!(along(Vec3::x(), Mount::Fixed), "along the base's x");
    assert_eq!(along(Vec3::new(-0.6, 0.8, 0.0), Mount::OnFlange), "along (-0.60, 0.80, 0.00) of the flange");
}
