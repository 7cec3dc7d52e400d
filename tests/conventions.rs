//! The convention doctor on simulated sessions whose poses are declared wrongly in every way that people do.
#![expect(clippy::expect_used, reason = "a test that finds nothing to check must fail")]

use handeye::calibrate::{BallProblem, Mount};
use handeye::diagnose::convention::{
    AngleReading, AngleUnit, Inversion, LengthUnit, PoseReading, ReadingFit, RotationReading, examine, rank,
};
use handeye::diagnose::{Case, Fault, Finding, Plot, Severity, remedy};
use handeye::geometry::notation::{self, OrientationForm};
use handeye::geometry::{AngleOrder, PoseConvention, PoseNotation, Rigid, Transform};
use handeye::session::{Capture, Session, Target, WrittenAngles, ball_problem, measure, parse, to_json};
use handeye::simulate::{SimulationOptions, simulate};
use handeye::watch::Unwatched;
use nalgebra::{Quaternion, UnitQuaternion};

/// The best reading must fit this many times better than the next one. Turning all poses round leaves the ball standing
/// still in the sensor, so the next one is never worse than the ball's spread there.
const WIDE_MARGIN: f64 = 4.0;
/// Rounding of a rotation through three angles and back, rad.
const SAME_RAD: f64 = 1e-9;

/// Single sections or sweeps, either mount, by the number of the case.
fn session(case: usize) -> Session {
    let is_sweep = case.is_multiple_of(2);
    simulate(&SimulationOptions {
        seed: case as u64,
        num_stations: 9,
        num_steps: if is_sweep { 8 } else { 1 },
        num_points: 160,
        step_mm: 2.1,
        mount: if case % 4 < 2 { Mount::OnFlange } else { Mount::Fixed },
        ..SimulationOptions::default()
    })
}

fn problem(session: &Session) -> BallProblem {
    let measured = measure(session, None, &mut Unwatched).expect("not cancelled");
    ball_problem(session, &measured).expect("a ball")
}

fn examined(session: &Session) -> (Option<Finding>, Vec<ReadingFit>) {
    let problem = problem(session);
    examine(Case { session, problem: &problem, results: &[] }, &mut Unwatched).expect("not cancelled")
}

fn with_poses(session: &Session, change: impl Fn(&mut Capture)) -> Session {
    let mut changed = session.clone();
    changed.stations.iter_mut().flat_map(|station| &mut station.captures).for_each(change);
    changed
}

fn with_rotations(session: &Session, change: impl Fn(&UnitQuaternion<f64>) -> UnitQuaternion<f64>) -> Session {
    with_poses(session, |capture| {
        let pose = capture.base_from_flange;
        capture.base_from_flange = Transform::from_parts(pose.translation_mm(), change(&pose.rotation()));
    })
}

fn convention(id: &str) -> &'static PoseConvention {
    PoseConvention::by_id(id).expect("known")
}

/// The session with its angles, times `factor`, declared as those of another maker.
fn declared_as(session: &Session, really: &str, declared: &str, factor: f64, is_written: bool) -> Session {
    let (really, declared) = (convention(really), convention(declared));
    let mut session = with_poses(session, |capture| {
        let pose = capture.base_from_flange;
        let angles_deg = really.angles_deg_from_rotation(&pose.rotation()).map(|angle| angle * factor);
        let rotation = declared.rotation_from_angles_deg(angles_deg);
        capture.base_from_flange = Transform::from_parts(pose.translation_mm(), rotation);
        capture.written_angles = is_written.then_some(WrittenAngles { angles_deg, convention: declared });
    });
    session.robot.notation.convention = declared;
    session
}

/// That the doctor finds how the poses of `wrong` are to be read to be those of `truth`, by a wide margin.
#[track_caller]
fn check_found(truth: &Session, wrong: &Session, code: &str) -> Session {
    let (finding, ranking) = examined(wrong);
    let finding = finding.unwrap_or_else(|| panic!("{code}: nothing was found, {:?}", &ranking[..2]));
    assert_eq!((finding.fault.code(), finding.severity), (code, Severity::Wrong), "{:?}", finding.fault);
    let margin = ranking[1].rms_mm / ranking[0].rms_mm;
    assert!(margin > WIDE_MARGIN, "{code}: only {margin} times better than {:?}", ranking[1]);
    let [as_given_mm, mended_mm] = finding.evidence.residual_mm.expect("there are residuals");
    assert!(finding.explains > WIDE_MARGIN && as_given_mm > WIDE_MARGIN * mended_mm);
    let Some(Plot::Readings(plotted)) = &finding.evidence.plot else { panic!("there is a plot") };
    assert_eq!(plotted.iter().filter(|fit| fit.is_as_given).count(), 1);
    let mended = remedy::apply(wrong, finding.remedy.as_ref().expect("one click"));
    let captures = |session: &Session| -> Vec<Capture> {
        session.stations.iter().flat_map(|station| station.captures.clone()).collect()
    };
    for (mended, truth) in captures(&mended).iter().zip(&captures(truth)) {
        let (mended_pose, truth) = (mended.base_from_flange.rigid(), truth.base_from_flange.rigid());
        let angle = mended_pose.rotation.angle_to(&truth.rotation);
        assert!(angle < SAME_RAD, "{code}: {angle} rad from the truth by {:?}", finding.fault);
        assert!((mended_pose.translation.vector - truth.translation.vector).norm() < 1e-6, "{code}");
        if let Some(written) = mended.written_angles {
            let by_numbers = written.convention.rotation_from_angles_deg(written.angles_deg);
            assert!(by_numbers.angle_to(&truth.rotation) < SAME_RAD, "{code}: the numbers say the same");
        }
    }
    assert_eq!(parse(to_json(&mended).as_bytes(), "mended.json").expect("can be saved").stations.len(), 9);
    mended
}

const DISTINCT: [&str; 5] = ["fanuc-wpr", "kuka-abc", "staubli-rxryrz", "kawasaki-oat", "ur-rotvec"];

#[test]
fn written_angles_are_found_whatever_convention_they_were_declared_in() {
    for (case, really) in DISTINCT.into_iter().enumerate() {
        for (offset, declared) in DISTINCT.into_iter().enumerate().filter(|(_, declared)| *declared != really) {
            let truth = session(case + offset);
            let mended = check_found(&truth, &declared_as(&truth, really, declared, 1.0, true), "pose-convention");
            assert_eq!(mended.robot.notation.convention.order, convention(really).order);
            assert!(mended.stations[0].captures[0].written_angles.is_some(), "the numbers stay");
        }
    }
}

#[test]
fn angles_are_found_from_quaternions_that_were_made_of_them_in_the_wrong_order() {
    let pairs = [("kuka-abc", "fanuc-wpr"), ("staubli-rxryrz", "kuka-abc"), ("ur-rotvec", "fanuc-wpr")];
    for (case, (really, declared)) in pairs.into_iter().enumerate() {
        let truth = session(case);
        let mut wrong = declared_as(&truth, really, declared, 1.0, false);
        if case == 1 {
            // The robot's own convention need not have to do with it.
            wrong.robot.notation.convention = convention("comau-aer");
        }
        let mended = check_found(&truth, &wrong, "pose-convention");
        assert_eq!(mended.robot.notation.convention.order, convention(really).order);
        assert!(mended.stations[0].captures[0].written_angles.is_none(), "nobody wrote these numbers");
    }
}

#[test]
fn the_order_of_quaternions_is_found() {
    for case in 0..4 {
        let truth = session(case);
        let wrong = with_rotations(&truth, |q| {
            UnitQuaternion::new_unchecked(match case {
                0 | 3 => Quaternion::new(q.i, q.j, q.k, q.w),
                _ => Quaternion::new(q.k, q.w, q.i, q.j),
            })
        });
        check_found(&truth, &wrong, "quaternion-order");
    }
}

#[test]
fn poses_the_other_way_round_are_found() {
    for case in 0..4 {
        let truth = session(case);
        let wrong = if case < 3 {
            with_poses(&truth, |capture| {
                capture.base_from_flange = Transform::from_rigid(capture.base_from_flange.rigid().inverse());
            })
        } else {
            with_rotations(&truth, UnitQuaternion::inverse)
        };
        check_found(&truth, &wrong, "inverted-poses");
    }
}

#[test]
fn units_of_positions_are_found() {
    for (case, unit) in LengthUnit::ALL.into_iter().filter(|unit| *unit != LengthUnit::Millimetres).enumerate() {
        let truth = session(case);
        let wrong = with_poses(&truth, |capture| {
            let pose = capture.base_from_flange.rigid();
            let position = pose.translation.vector / unit.factor();
            capture.base_from_flange = Transform::from_rigid(Rigid::from_parts(position.into(), pose.rotation));
        });
        check_found(&truth, &wrong, "position-unit");
    }
}

#[test]
fn units_of_angles_are_found() {
    for (case, is_written) in [true, false, true].into_iter().enumerate() {
        let truth = session(case);
        let radians = declared_as(&truth, "fanuc-wpr", "fanuc-wpr", 1.0_f64.to_radians(), is_written);
        check_found(&truth, &radians, "angle-unit");
    }
    let truth = session(1);
    check_found(&truth, &declared_as(&truth, "kuka-abc", "kuka-abc", 1.0_f64.to_degrees(), true), "angle-unit");
}

#[test]
fn several_parts_at_once_are_found() {
    // What a Universal Robot says, metres and a rotation vector in radians, taken for a KUKA's.
    let truth = session(2);
    let angles = declared_as(&truth, "ur-rotvec", "kuka-abc", 1.0_f64.to_radians(), true);
    let wrong = with_poses(&angles, |capture| {
        let pose = capture.base_from_flange;
        capture.base_from_flange = Transform::from_parts(pose.translation_mm() / 1000.0, pose.rotation());
    });
    let mended = check_found(&truth, &wrong, "pose-convention");
    assert_eq!(mended.robot.notation.convention.id, "ur-rotvec");
}

#[test]
fn one_wrong_pose_does_not_hide_the_convention() {
    for case in 0..2 {
        let clean = session(case);
        let mut truth = clean.clone();
        for capture in &mut truth.stations[3].captures {
            let pose = capture.base_from_flange.rigid();
            let moved = pose.translation.vector + nalgebra::Vector3::new(10.0, -20.0, 5.0);
            capture.base_from_flange = Transform::from_rigid(Rigid::from_parts(moved.into(), pose.rotation));
        }
        check_found(&truth, &declared_as(&truth, "fanuc-wpr", "kuka-abc", 1.0, true), "pose-convention");
        let (finding, _) = examined(&truth);
        assert_eq!(finding, None, "a wrong pose is no convention");
    }
}

#[test]
fn sessions_in_order_and_those_with_other_faults_have_no_finding() {
    for case in 0..12 {
        let clean = session(case);
        assert_eq!(examined(&clean), (None, Vec::new()), "case {case}");
        let mut another_ball = clean.clone();
        another_ball.target = Target::Ball { radius_mm: 15.6, radius_std_mm: None };
        assert_eq!(examined(&another_ball).0, None, "case {case}: a wrong radius is no convention");
    }
    for case in 0..2 {
        let mut mixed_up = session(case);
        let poses: Vec<_> = mixed_up.stations.iter().map(|station| station.captures.clone()).collect();
        for (idx, station) in mixed_up.stations.iter_mut().enumerate() {
            for (capture, other) in station.captures.iter_mut().zip(&poses[(idx + 4) % 9]) {
                capture.base_from_flange = other.base_from_flange;
            }
        }
        assert_eq!(examined(&mixed_up).0, None, "case {case}: a mixed-up order is no convention");
    }
}

#[test]
fn a_remedy_changes_of_the_notation_only_what_it_found() {
    let mut misread = session(0);
    let notation = PoseNotation {
        orientation: OrientationForm::QuaternionXyzw,
        length_unit: notation::LengthUnit::Metres,
        is_inverse: true,
        ..PoseNotation::of(convention("kuka-abc"))
    };
    misread.robot.notation = notation;
    let angles = |to: AngleOrder| PoseReading {
        rotation: RotationReading::Angles(AngleReading {
            from: convention("kuka-abc").order,
            to,
            unit: AngleUnit::Degrees,
            second_at_station_idxs: Vec::new(),
        }),
        ..PoseReading::default()
    };
    let staubli = convention("staubli-rxryrz");
    let no_maker = convention("intrinsic-yxz");
    let inverse = PoseReading { inversion: Inversion::WholePose, ..PoseReading::default() };
    for (reading, expected) in [
        (angles(staubli.order), PoseNotation { convention: staubli, ..notation }),
        (angles(no_maker.order), PoseNotation { convention: no_maker, ..notation }),
        (inverse, PoseNotation { is_inverse: false, ..notation }),
    ] {
        let mut mended = misread.clone();
        reading.apply(&mut mended);
        assert_eq!(mended.robot.notation, expected);
    }
}

#[test]
fn makers_that_write_alike_are_named_as_ties() {
    let truth = session(0);
    let (finding, ranking) = examined(&declared_as(&truth, "fanuc-wpr", "kuka-abc", 1.0, true));
    let Some(Fault::PosesMisread { reading }) = finding.map(|finding| finding.fault) else { panic!("it is found") };
    assert_eq!(reading.angle_order().map(|order| order.to_string()).as_deref(), Some("extrinsic XYZ"));
    let makers: Vec<&str> = reading.makers().iter().map(|maker| maker.id).collect();
    assert_eq!(makers[..4], ["fanuc-wpr", "yaskawa-rxryrz", "mitsubishi-abc", "denso-rxryrz"]);
    assert_eq!(ranking[0].ties, [], "no other order gives these rotations");
}

#[test]
fn readings_that_these_poses_cannot_tell_apart_are_ties() {
    // With b = c = 0 the order of the angles makes no difference, so nothing is wrong whatever it is.
    let truth = session(0);
    let ranking = rank(&truth, &problem(&truth), &mut Unwatched).expect("not cancelled");
    assert!(ranking[0].is_as_given && ranking.len() > 100);
    let turned_alike = with_rotations(&truth, |_| convention("kuka-abc").rotation_from_angles_deg([30.0, 0.0, 0.0]));
    let alike = declared_as(&turned_alike, "kuka-abc", "kuka-abc", 1.0, true);
    assert_eq!(examined(&alike).0, None);
}
