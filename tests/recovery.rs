//! The methods on simulated sessions, against their truth.
#![expect(clippy::expect_used, reason = "a test that finds nothing to check must fail")]

use handeye::calibrate::verdict::judge;
use handeye::calibrate::{BallProblem, Method, Mount, SideChoice, Solution, SolveError, Verdict, Warning, solve};
use handeye::geometry::{Transform, Vec3, so3, stats};
use handeye::report::compare::distance_from_truth;
use handeye::session::{Session, ball_problem, measure};
use handeye::simulate::{Dirt, SimulationOptions, simulate};
use handeye::watch::Unwatched;

/// What the project promises for exact data.
const EXACT_MM: f64 = 1e-6;
/// The same for angles.
const EXACT_DEG: f64 = 1e-7;

fn problem(session: &Session) -> BallProblem {
    let measured = measure(session, None, &mut Unwatched).expect("nobody cancels");
    ball_problem(session, &measured).expect("a ball session")
}

#[track_caller]
fn check_exact(session: &Session, method: Method) -> Solution {
    let solution = solve(&problem(session), method).unwrap_or_else(|error| panic!("{}: {error}", method.id()));
    let truth = session.truth.as_ref().expect("simulated");
    let translation_mm =
        (solution.flange_from_sensor.translation_mm() - truth.flange_from_sensor.translation_mm()).norm();
    let angle_deg = solution.flange_from_sensor.rotation().angle_to(&truth.flange_from_sensor.rotation()).to_degrees();
    let ball_mm = (solution.target_in_base_mm - truth.target_in_base_mm).norm();
    assert!(
        translation_mm < EXACT_MM && angle_deg < EXACT_DEG && ball_mm < EXACT_MM,
        "{}: off by {translation_mm:e} mm, {angle_deg:e}°, ball {ball_mm:e} mm",
        method.id()
    );
    solution
}

const EXACT_METHODS: [Method; 3] = [Method::BallFixedPoint, Method::BallMaxArc, Method::BallBundle];

#[test]
fn exact_data_give_the_truth_for_both_mounts_and_both_signs_of_z() {
    for mount in [Mount::OnFlange, Mount::Fixed] {
        for z_towards_sensor in [false, true] {
            for seed in 1..=3 {
                let session = simulate(&SimulationOptions {
                    seed,
                    mount,
                    z_towards_sensor,
                    num_steps: 9,
                    step_mm: 1.5,
                    num_points: 200,
                    ..SimulationOptions::noise_free()
                });
                for method in EXACT_METHODS {
                    let solution = check_exact(&session, method);
                    assert_eq!(solution.mount, mount);
                }
            }
        }
    }
}

#[test]
fn exact_data_with_poses_turned_by_half_turns_give_the_truth() {
    let clean =
        simulate(&SimulationOptions { num_steps: 7, step_mm: 2.0, num_points: 200, ..SimulationOptions::noise_free() });
    // Turning base and flange by half turns makes some of the poses and the calibration themselves half turns.
    let half_turns = [Vec3::x(), Vec3::y(), Vec3::z(), Vec3::new(1.0, 1.0, 0.0).normalize()];
    for axis in half_turns {
        let turn = so3::exp(axis * std::f64::consts::PI);
        let mut session = clean.clone();
        // The first station's flange becomes the reference, so its pose is exactly the half turn.
        let flange_from_old = {
            let first = session.stations[0].captures[0].base_from_flange.rotation();
            Transform::from_parts(Vec3::zeros(), turn.inverse() * first)
        };
        for station in &mut session.stations {
            for capture in &mut station.captures {
                capture.base_from_flange =
                    Transform::from_rigid(capture.base_from_flange.rigid() * flange_from_old_inverse(&flange_from_old));
            }
        }
        if let Some(truth) = &mut session.truth {
            truth.flange_from_sensor =
                Transform::from_rigid(flange_from_old.rigid() * truth.flange_from_sensor.rigid());
        }
        let first = session.stations[0].captures[0].base_from_flange.rotation();
        assert!(first.angle_to(&turn) < 1e-12, "the pose is a half turn");
        for method in EXACT_METHODS {
            check_exact(&session, method);
        }
    }
}

fn flange_from_old_inverse(
    flange_from_old: &Transform<handeye::geometry::Flange, handeye::geometry::Flange>,
) -> handeye::geometry::Rigid {
    flange_from_old.rigid().inverse()
}

#[test]
fn the_bundle_is_three_times_nearer_to_the_truth_than_the_published_stop() {
    let mut errors = [Vec::new(), Vec::new()];
    for seed in 1..=10 {
        let session = simulate(&SimulationOptions { seed, ..SimulationOptions::default() });
        let problem = problem(&session);
        let truth = session.truth.as_ref().expect("simulated");
        for (errors, method) in errors.iter_mut().zip([Method::BallMaxArcStep, Method::BallBundle]) {
            let solution = solve(&problem, method).expect("a solution");
            errors.push(distance_from_truth(&solution, truth).workspace_point_mm);
        }
    }
    let [step, bundle] = errors.map(stats::rms);
    assert!(3.0 * bundle < step, "bundle {bundle} mm, published stop {step} mm");
}

#[test]
fn the_stated_uncertainty_is_that_of_the_errors() {
    let (mut errors, mut stated) = (Vec::new(), Vec::new());
    for seed in 1..=30 {
        let session = simulate(&SimulationOptions {
            seed,
            num_stations: 12,
            num_steps: 7,
            step_mm: 2.0,
            num_points: 200,
            ..SimulationOptions::default()
        });
        let truth = session.truth.as_ref().expect("simulated");
        let solution = solve(&problem(&session), Method::BallBundle).expect("a solution");
        errors.push(distance_from_truth(&solution, truth).workspace_point_mm);
        stated.push(solution.uncertainty.expect("redundant").workspace_point_std_mm);
    }
    let ratio = stats::rms(errors) / stats::rms(stated);
    // 30 sessions of 6 unknowns know a standard deviation to some 10 %; the factor that inflates it is at least 1.
    assert!((0.6..1.3).contains(&ratio), "errors over stated: {ratio}");
}

#[test]
fn noise_of_the_orientation_acts_at_the_right_lever_for_both_mounts() {
    for mount in [Mount::OnFlange, Mount::Fixed] {
        let (mut errors, mut stated) = (Vec::new(), Vec::new());
        for seed in 1..=20 {
            let session = simulate(&SimulationOptions {
                seed,
                mount,
                num_stations: 12,
                position_std_mm: 0.001,
                orientation_std_deg: 0.05,
                ..small()
            });
            let solution = solve(&problem(&session), Method::BallBundle).expect("a solution");
            let truth = session.truth.as_ref().expect("simulated");
            errors.push(distance_from_truth(&solution, truth).workspace_point_mm);
            stated.push(solution.uncertainty.expect("redundant").workspace_point_std_mm);
        }
        let ratio = stats::rms(errors) / stats::rms(stated);
        // 20 sessions know a standard deviation to some 15 %.
        assert!((0.55..1.45).contains(&ratio), "{mount:?}: errors over stated {ratio}");
    }
}

#[test]
fn a_wrong_radius_is_found_by_the_sweeps_and_never_called_good() {
    for (radius_mm, is_wrong) in [(14.9, true), (15.0, false), (15.1, true)] {
        let mut session = simulate(&SimulationOptions::default());
        session.target = handeye::session::Target::ball(radius_mm);
        for method in [Method::BallMaxArc, Method::BallBundle] {
            let solution = solve(&problem(&session), method).expect("a solution");
            let found = solution.warnings.iter().find_map(|warning| match warning {
                Warning::RadiusDisagrees { found_mm, .. } => Some(*found_mm),
                _ => None,
            });
            assert_eq!(found.is_some(), is_wrong, "R = {radius_mm}: {:?}", solution.warnings);
            // The steps say how large the ball is, to some hundredths of a millimetre.
            assert!(found.is_none_or(|found| (found - 15.0).abs() < 0.03), "{found:?}");
            assert_eq!(judge(&solution).0 == Verdict::Good, !is_wrong);
        }
    }
}

#[test]
fn rotations_nearly_about_one_axis_name_that_axis() {
    let session = simulate(&SimulationOptions { tilt_deg: 2.0, spin_deg: 90.0, ..small() });
    let solution = solve(&problem(&session), Method::BallBundle).expect("a solution");
    let axis = solution.warnings.iter().find_map(|warning| match warning {
        Warning::NearlyOneAxis { axis_in_flange, .. } => Some(*axis_in_flange),
        _ => None,
    });
    // The tool points down, so spinning it is about its own z.
    assert!(axis.is_some_and(|[_, _, z]| z.abs() > 0.9), "{axis:?}");
}

#[test]
fn dirt_does_not_reach_the_result() {
    for seed in 1..=3 {
        let session = simulate(&SimulationOptions {
            seed,
            dirt: Dirt::all(),
            num_steps: 9,
            step_mm: 1.5,
            num_points: 400,
            ..SimulationOptions::default()
        });
        let solution = solve(&problem(&session), Method::BallBundle).expect("a solution");
        let error = distance_from_truth(&solution, session.truth.as_ref().expect("simulated"));
        // Three times what clean sessions of this size show.
        assert!(error.workspace_point_mm < 0.15, "seed {seed}: {} mm", error.workspace_point_mm);
    }
}

#[test]
fn one_to_three_stations_are_refused_by_name_and_four_carry_a_warning() {
    for num_stations in 0..=4 {
        let session = simulate(&SimulationOptions {
            num_stations,
            num_steps: 5,
            step_mm: 3.0,
            num_points: 100,
            ..SimulationOptions::default()
        });
        for method in Method::BALL {
            match solve(&problem(&session), method) {
                Ok(solution) => {
                    assert_eq!(num_stations, 4);
                    assert!(solution.warnings.iter().any(|warning| matches!(warning, Warning::FewStations { .. })));
                    assert_eq!(solution.leave_one_out, None);
                }
                Err(error) => {
                    assert!(num_stations < 4, "{}: {error}", method.id());
                    assert!(
                        matches!(
                            error,
                            SolveError::TooFewStations { found, needed: 4, .. }
                            | SolveError::TooFewSweeps { found, needed: 4, .. }
                            | SolveError::TooFewProfileStations { found, needed: 4, .. } if found == num_stations
                        ),
                        "{error}"
                    );
                }
            }
        }
    }
}

#[test]
fn without_rotation_or_about_one_axis_nothing_is_claimed() {
    let still = simulate(&SimulationOptions { tilt_deg: 0.0, spin_deg: 0.0, ..small() });
    let spun = simulate(&SimulationOptions { tilt_deg: 0.0, orientation_std_deg: 0.0, ..small() });
    for method in Method::BALL {
        let refusal = solve(&problem(&still), method).expect_err("no rotation");
        assert!(matches!(refusal, SolveError::NoRotation { .. }), "{}: {refusal}", method.id());
        let refusal = solve(&problem(&spun), method).expect_err("one axis");
        assert!(matches!(refusal, SolveError::RotationsAboutOneAxis { .. }), "{}: {refusal}", method.id());
    }
}

#[test]
fn sections_larger_than_the_ball_are_flagged_and_do_not_stop_anything() {
    let mut session = simulate(&SimulationOptions { section_offset_mm: Some(1.0), num_steps: 1, ..small() });
    // A radius 2 % too small: the sections near the largest are then larger than the ball.
    session.target = handeye::session::Target::ball(0.98 * 15.0);
    let solution = solve(&problem(&session), Method::BallFixedPoint).expect("a solution");
    assert!(solution.warnings.iter().any(|warning| matches!(warning, Warning::ArcLargerThanBall { .. })));
    // Much too small: every profile is refused, with the radius as the reason.
    session.target = handeye::session::Target::ball(10.0);
    let refusal = solve(&problem(&session), Method::BallFixedPoint).expect_err("no usable arc");
    assert!(matches!(refusal, SolveError::TooFewStations { found: 0, .. }), "{refusal}");
    assert!(refusal.to_string().contains("Check the ball's radius"), "{refusal}");
}

#[test]
fn a_given_side_is_kept_and_mixed_sides_are_found() {
    let session = simulate(&SimulationOptions { num_steps: 1, ..small() });
    let found = solve(&problem(&session), Method::BallFixedPoint).expect("a solution");
    let sides: Vec<_> = found.stations.iter().map(|station| station.side).collect();
    assert!(found.stations.iter().all(|station| station.side_cost_ratio.is_some_and(|ratio| ratio > 2.0)));
    let mut given = session.clone();
    for (station, side) in given.stations.iter_mut().zip(&sides) {
        station.side = SideChoice::Given(*side);
    }
    let kept = solve(&problem(&given), Method::BallFixedPoint).expect("a solution");
    assert!((kept.target_in_base_mm - found.target_in_base_mm).norm() < 1e-9);
    assert!(kept.stations.iter().all(|station| station.side_cost_ratio.is_none()));
}

#[test]
fn sides_are_found_in_many_sessions_of_single_sections() {
    for seed in 1..=40 {
        let session = simulate(&SimulationOptions { seed, num_steps: 1, ..small() });
        let truth = session.truth.as_ref().expect("simulated");
        let solution = solve(&problem(&session), Method::BallFixedPoint).expect("a solution");
        let error_mm = distance_from_truth(&solution, truth).workspace_point_mm;
        // A wrong side is off by some millimetres, noise by some hundredths.
        assert!(error_mm < 1.0, "seed {seed}: {error_mm} mm");
    }
}

#[test]
fn a_bad_pose_is_named_by_every_method_that_sees_it() {
    for bad in [0, 4, 9] {
        let session = simulate(&SimulationOptions { bad_pose_station: Some(bad), ..small() });
        let label = &session.stations[bad].label;
        let solution = solve(&problem(&session), Method::BallBundle).expect("a solution");
        let named = solution.warnings.iter().find_map(|warning| match warning {
            Warning::StationStandsOut { label, .. } => Some(label),
            _ => None,
        });
        assert_eq!(named, Some(label));
    }
}

#[test]
fn the_same_session_gives_the_same_bits() {
    let session = simulate(&small());
    for method in Method::BALL {
        assert_eq!(solve(&problem(&session), method), solve(&problem(&session), method));
    }
}

fn small() -> SimulationOptions {
    SimulationOptions { num_steps: 7, step_mm: 2.0, num_points: 160, ..SimulationOptions::default() }
}
