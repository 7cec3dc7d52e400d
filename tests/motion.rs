//! The hand-eye calibration from motions: how near to the truth, how near to the bound, and what is wrong with bad data.
#![expect(clippy::expect_used, reason = "a test that cannot solve its problem must fail")]

mod motion_cell;

use handeye::calibrate::motion::{refined, solve};
use handeye::calibrate::validation::validate;
use handeye::calibrate::{ClosedForm, MotionProblem, Mount, PoseFault, Reading, SolveError, Warning};
use handeye::geometry::so3::exp;
use handeye::geometry::stats::rms;
use handeye::geometry::{Rigid, Transform, Vec3, se3};
use handeye::scene::random::Random;
use motion_cell::{Cell, Simulated};
use nalgebra::{Matrix6, Vector6};

/// The error of a calibration: rotation about the sensor's axes, translation along them.
fn error(simulated: &Simulated, found: &Rigid) -> Vector6<f64> {
    se3::log(&(simulated.truth.flange_from_sensor.inverse() * found))
}

fn square(covariance: &Matrix6<f64>, error: &Vector6<f64>) -> f64 {
    error.dot(&(covariance.try_inverse().expect("a covariance") * error))
}

#[test]
fn a_thousand_trials_reach_the_bound_without_a_gross_failure() {
    const NUM_TRIALS: u64 = 1000;
    let (mut squares, mut count) = (0.0, 0_u32);
    let mut worst = 0.0_f64;
    for seed in 0..NUM_TRIALS {
        let num_poses = [10, 20, 50, 100][usize::try_from(seed % 4).expect("small")];
        let mount = if seed % 8 < 4 { Mount::OnFlange } else { Mount::Fixed };
        let simulated = Cell { num_poses, mount, ..Cell::default() }.simulate(seed);
        let found = refined(&simulated.problem).expect("solved");
        let square = square(&simulated.bound, &error(&simulated, &found)) / 6.0;
        worst = worst.max(square);
        squares += square;
        count += 1;
    }
    let efficiency = (squares / f64::from(count)).sqrt();
    // Six thousand squares of unit variance scatter by 1 % in their root mean.
    assert!(efficiency < 1.03, "{efficiency}");
    assert!(worst.sqrt() < 3.5, "{worst}");
}

fn with_pose(problem: &mut MotionProblem, station: usize, change: impl Fn(&Rigid) -> Rigid) {
    let Reading::Pose(seen) = &mut problem.stations[station].captures[0].reading else { panic!("a pose") };
    *seen = Transform::from_rigid(change(seen.rigid()));
}

fn with_all_robot_poses(problem: &mut MotionProblem, change: impl Fn(&Rigid) -> Rigid) {
    for capture in problem.stations.iter_mut().flat_map(|station| &mut station.captures) {
        capture.base_from_flange = Transform::from_rigid(change(capture.base_from_flange.rigid()));
    }
}

#[test]
fn the_stated_sigma_is_that_of_the_errors_whether_the_noise_is_stated_or_found() {
    const NUM_TRIALS: u32 = 120;
    for (is_stated, mount) in [(true, Mount::OnFlange), (false, Mount::OnFlange), (false, Mount::Fixed)] {
        for num_poses in [8, 20] {
            let (mut squares, mut held) = (0.0, 0);
            for seed in 0..NUM_TRIALS {
                let cell = Cell { num_poses, is_stated, mount, ..Cell::default() };
                let simulated = cell.simulate(u64::from(seed) + 9000);
                let solution = solve(&simulated.problem).expect("solved");
                let known = solution.uncertainty.as_ref().expect("redundant");
                let point = known.reference_point_in_sensor_mm;
                let truth = (simulated.truth.flange_from_sensor * nalgebra::Point3::from(point)).coords;
                let off_mm = (solution.flange_from_sensor.map_point(point) - truth).norm();
                squares += (off_mm / known.workspace_point_std_mm).powi(2);
                held += u32::from(off_mm <= known.workspace_point_95_mm);
            }
            let mean = squares / f64::from(NUM_TRIALS);
            // 120 squares of three coordinates scatter by a tenth; 95 % of 120 by 2.4.
            assert!((0.75..1.3).contains(&mean), "{is_stated} {mount:?} {num_poses}: {mean}");
            assert!((106..=120).contains(&held), "{is_stated} {mount:?} {num_poses}: {held}");
        }
    }
}

#[test]
fn wrong_poses_are_left_out_and_named() {
    let half_turn = |axis: Vec3| Rigid::from_parts(Vec3::zeros().into(), exp(axis * std::f64::consts::PI));
    for (is_stated, seed) in [(true, 1), (false, 2), (false, 3)] {
        let mut simulated = Cell { num_poses: 20, is_stated, ..Cell::default() }.simulate(seed);
        let problem = &mut simulated.problem;
        with_pose(problem, 2, Rigid::inverse);
        with_pose(problem, 5, |seen| seen * half_turn(Vec3::z()));
        with_pose(problem, 9, |seen| seen * Rigid::from_parts(Vec3::zeros().into(), exp(Vec3::new(0.05, 0.02, 0.0))));
        with_pose(problem, 13, |seen| Rigid::from_parts(Vec3::new(9.0, 0.0, -4.0).into(), exp(Vec3::zeros())) * seen);
        with_pose(problem, 17, |seen| {
            Rigid::from_parts(Vec3::new(-30.0, 8.0, 0.0).into(), exp(Vec3::new(0.1, 0.4, 0.0))) * seen
        });
        let solution = solve(problem).expect("solved");
        let rejected: Vec<(usize, PoseFault)> = solution
            .motion
            .as_ref()
            .expect("a motion")
            .rejected
            .iter()
            .map(|pose| (pose.station_idx, pose.fault))
            .collect();
        let expected = [
            (2, PoseFault::Inverted),
            (5, PoseFault::Flipped),
            (9, PoseFault::Orientation),
            (13, PoseFault::Place),
            (17, PoseFault::Both),
        ];
        assert_eq!(rejected, expected);
        let found = error(&simulated, solution.flange_from_sensor.rigid());
        assert!(square(&simulated.bound, &found) / 6.0 < 9.0, "{found}");
        assert_eq!(solution.stations.len(), 15);
        assert!(solution.warnings.iter().filter(|warning| warning.code() == "pose-rejected").count() == 5);
    }
}

#[test]
fn poses_without_faults_are_hardly_ever_left_out() {
    let mut num_rejected = 0;
    for seed in 0..100 {
        let cell = Cell { num_poses: 12, is_stated: seed % 2 == 0, ..Cell::default() };
        let solution = solve(&cell.simulate(seed + 400).problem).expect("solved");
        num_rejected += solution.motion.expect("a motion").rejected.len();
    }
    assert!(num_rejected <= 1, "{num_rejected} of 1200");
}

#[test]
fn a_list_that_is_inverted_is_named() {
    for (mount, seed) in [(Mount::OnFlange, 5), (Mount::Fixed, 6)] {
        let simulated = Cell { num_poses: 12, is_stated: false, mount, ..Cell::default() }.simulate(seed);
        let is_named = |change: &dyn Fn(&mut MotionProblem)| {
            let mut problem = simulated.problem.clone();
            change(&mut problem);
            let solution = solve(&problem).expect("solved");
            solution.warnings.iter().any(|warning| matches!(warning, Warning::StreamInverted { .. }))
        };
        let targets = |problem: &mut MotionProblem| {
            for station in 0..problem.stations.len() {
                with_pose(problem, station, Rigid::inverse);
            }
        };
        assert!(!is_named(&|_| {}));
        assert!(is_named(&|problem| with_all_robot_poses(problem, Rigid::inverse)));
        assert!(is_named(&targets));
    }
}

#[test]
fn a_board_of_another_size_is_found() {
    let scaled = |factor: f64| {
        let mut simulated = Cell { num_poses: 25, is_stated: false, ..Cell::default() }.simulate(8);
        for station in 0..simulated.problem.stations.len() {
            with_pose(&mut simulated.problem, station, |seen| {
                Rigid::from_parts((seen.translation.vector / factor).into(), seen.rotation)
            });
        }
        solve(&simulated.problem).expect("solved").warnings.iter().find_map(|warning| match warning {
            Warning::TargetScale { factor, std } => Some((*factor, *std)),
            _ => None,
        })
    };
    assert_eq!(scaled(1.0), None);
    let (found, std) = scaled(1.03).expect("another size");
    // A step from a fit to a board of the wrong size: a tenth of the excess is left beside the noise.
    assert!((found - 1.03).abs() < 0.003 + 3.0 * std, "{found} ± {std}");
}

/// A problem from looks at the target that are turned as given.
fn turned(turns: &[Vec3]) -> Simulated {
    let mut random = Random::new(4, 4);
    let truth = motion_cell::truth(&mut random);
    let looks: Vec<Rigid> = turns
        .iter()
        .zip([[0.0, 0.0], [20.0, -10.0], [-15.0, 25.0], [5.0, -30.0], [-25.0, -5.0], [12.0, 18.0]].iter().cycle())
        .map(|(turn, [x, y])| Rigid::from_parts(Vec3::new(*x, *y, 500.0 + x + 2.0 * y).into(), exp(*turn)))
        .collect();
    Cell { is_stated: false, target_std_deg: 0.01, target_std_mm: 0.02, orientation_std_deg: 0.002, ..Cell::default() }
        .simulate_looks(&truth, &looks, &mut random)
}

#[test]
fn what_cannot_be_observed_is_said() {
    let about_z: Vec<Vec3> = (0..6).map(|idx| Vec3::z() * (0.3 * f64::from(idx))).collect();
    let simulated = turned(&about_z);
    match solve(&simulated.problem) {
        Err(SolveError::RotationsAboutOneAxis { axis_x, axis_y, axis_z }) => {
            let axis = simulated.truth.flange_from_sensor.rotation * Vec3::z();
            let found = Vec3::new(axis_x, axis_y, axis_z);
            assert!(found.cross(&axis).norm() < 1e-2, "{found} against {axis}");
        }
        other => panic!("{other:?}"),
    }
    let level = vec![Vec3::zeros(); 6];
    assert!(matches!(solve(&turned(&level).problem), Err(SolveError::NoRotation { .. })));
    let two = [Vec3::zeros(), Vec3::new(0.4, 0.0, 0.0)];
    assert!(matches!(solve(&turned(&two).problem), Err(SolveError::TooFewStations { found: 2, needed: 3, .. })));
    // The same two over and over are still two.
    let mut repeated = turned(&[Vec3::zeros(), Vec3::new(0.4, 0.0, 0.0), Vec3::new(0.0, 0.3, 0.0)]).problem;
    let copies: Vec<_> = (0..6).map(|idx| repeated.stations[idx % 2].clone()).collect();
    repeated.stations = copies;
    assert!(matches!(solve(&repeated), Err(SolveError::TooFewStations { found: 2, .. })));
    // Almost about one axis: a result, with the weak direction named.
    let nearly: Vec<Vec3> = (0..12_u8)
        .map(|idx| Vec3::new(0.03 * f64::from(idx % 3), 0.03 * f64::from(idx % 2), 0.2 * f64::from(idx)))
        .collect();
    let solution = solve(&turned(&nearly).problem).expect("solved");
    assert!(solution.warnings.iter().any(|warning| warning.code() == "nearly-one-axis"), "{:?}", solution.warnings);
}

#[test]
fn half_turns_are_solved_though_their_axes_have_no_sign() {
    let pi = std::f64::consts::PI;
    let turns = [Vec3::zeros(), Vec3::x() * pi, Vec3::y() * pi, Vec3::z() * pi];
    let simulated = turned(&turns);
    let solution = solve(&simulated.problem).expect("solved");
    let off = error(&simulated, solution.flange_from_sensor.rigid());
    let is_ambiguous = solution.warnings.iter().any(|warning| warning.code() == "other-minimum");
    assert!(off.norm() < 1.0 || is_ambiguous, "{off} {:?}", solution.warnings);
    // With one pose more that is not a half turn away, there is no doubt.
    let simulated = turned(&[turns.as_slice(), &[Vec3::new(0.5, 0.3, 0.1)]].concat());
    let solution = solve(&simulated.problem).expect("solved");
    let off = error(&simulated, solution.flange_from_sensor.rigid());
    assert!(off.fixed_rows::<3>(0).norm() < 2e-3 && off.fixed_rows::<3>(3).norm() < 1.0, "{off}");
}

#[test]
fn every_result_is_validated_and_every_closed_form_listed() {
    let simulated = Cell { num_poses: 20, ..Cell::default() }.simulate(11);
    let solution = solve(&simulated.problem).expect("solved");
    let motion = solution.motion.as_ref().expect("a motion");
    assert_eq!(motion.closed_forms.len(), ClosedForm::ALL.len());
    for closed_form in &motion.closed_forms {
        let answer = closed_form.answer.unwrap_or_else(|| panic!("{:?} has no answer", closed_form.form));
        // Li's keeps nothing apart from the translations' noise.
        let limit_mm = if closed_form.form == ClosedForm::Li { 20.0 } else { 3.0 };
        assert!(answer.off_mm < limit_mm && answer.off_rad < 0.02, "{closed_form:?}");
    }
    let left_out = solution.leave_one_out.expect("enough stations");
    assert!(left_out.rms_mm > solution.scatter.rms_mm && left_out.rms_mm < 1.5 * solution.scatter.rms_mm);
    let validation = validate(&solution).expect("validated");
    let studentised = rms(validation.influence.iter().map(|influence| influence.studentised_residual));
    assert!((0.7..1.3).contains(&studentised), "{studentised}");
    let split = validation.split_half.expect("halves");
    assert!((0.4..2.5).contains(&(split.median_mm / split.expected_mm)), "{split:?}");
    assert!(validation.normality.expect("residuals").p_value > 1e-3);
}

#[test]
fn hostile_numbers_end_in_an_error_or_a_result_but_never_a_panic() {
    let clean = Cell { num_poses: 8, ..Cell::default() }.simulate(12).problem;
    for hostile in [f64::NAN, f64::INFINITY, 1e300, -1e200, 1e-300] {
        for station in [0, 3] {
            let mut problem = clean.clone();
            with_pose(&mut problem, station, |seen| {
                Rigid::from_parts(Vec3::new(hostile, 1.0, 2.0).into(), seen.rotation)
            });
            let _ = solve(&problem);
            let mut problem = clean.clone();
            let capture = &mut problem.stations[station].captures[0];
            let place = Vec3::new(0.0, hostile, 0.0);
            capture.base_from_flange = Transform::from_parts(place, capture.base_from_flange.rotation());
            let _ = solve(&problem);
        }
    }
    let mut same = clean.clone();
    let first = same.stations[0].clone();
    same.stations.iter_mut().for_each(|station| station.captures.clone_from(&first.captures));
    assert!(solve(&same).is_err());
    same.stations.clear();
    assert!(solve(&same).is_err());
}
