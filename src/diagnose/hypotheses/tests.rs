//! Every suspicion on simulated sessions with that fault, for both mounts, with sweeps and with single sections.

use super::*;
use crate::calibrate::{BallProblem, Method, MethodResult, Mount, solve_all};
use crate::diagnose::finding::{Axis, Fault, Plot, Severity};
use crate::diagnose::remedy::{Remedy, apply};
use crate::geometry::Vec3;
use crate::session::{Session, ball_problem, measure};
use crate::simulate::{self, Dirt, SimulationOptions, simulate};
use crate::watch::Unwatched;

const MOUNTS: [Mount; 2] = [Mount::OnFlange, Mount::Fixed];

/// Sweeps as by default, coarser so that the tests are quick.
fn sweeps(mount: Mount, seed: u64) -> SimulationOptions {
    SimulationOptions { seed, mount, num_steps: 9, step_mm: 1.8, num_points: 200, ..SimulationOptions::default() }
}

fn sections(mount: Mount, seed: u64) -> SimulationOptions {
    SimulationOptions { num_stations: 16, num_steps: 1, ..sweeps(mount, seed) }
}

fn all_kinds() -> impl Iterator<Item = SimulationOptions> {
    MOUNTS.into_iter().flat_map(|mount| [sweeps(mount, 3), sections(mount, 4)])
}

fn with_fault(fault: simulate::Fault) -> impl Iterator<Item = (SimulationOptions, Session)> {
    all_kinds().map(move |options| {
        let session = simulate(&SimulationOptions { fault: Some(fault), ..options.clone() });
        (options, session)
    })
}

fn solved(session: &Session) -> (BallProblem, Vec<MethodResult>) {
    let measured = measure(session, None, &mut Unwatched).expect("not cancelled");
    let problem = ball_problem(session, &measured).expect("a ball");
    let results = solve_all(&problem, &Method::BALL, &mut Unwatched).expect("not cancelled");
    (problem, results)
}

fn found(session: &Session) -> Vec<Finding> {
    let (problem, results) = solved(session);
    examine(Case { session, problem: &problem, results: &results })
}

#[track_caller]
fn only_finding(session: &Session, options: &SimulationOptions) -> Finding {
    let mut findings = found(session);
    assert_eq!(findings.len(), 1, "{findings:#?} in {options:?}");
    findings.remove(0)
}

#[track_caller]
fn assert_mended(session: &Session, finding: &Finding) {
    let remedy = finding.remedy.as_ref().expect("a remedy");
    assert_eq!(found(&apply(session, remedy)), []);
}

#[test]
fn clean_sessions_are_silent() {
    for seed in 10..13 {
        for mount in MOUNTS {
            let (sweeps, sections) = (sweeps(mount, seed), sections(mount, seed));
            let noisy = |options: &SimulationOptions| SimulationOptions {
                position_std_mm: 0.05,
                orientation_std_deg: 0.02,
                ..options.clone()
            };
            let dirty = |options: &SimulationOptions| SimulationOptions {
                dirt: Dirt::all(),
                num_points: 400,
                ..options.clone()
            };
            for options in [
                SimulationOptions { num_stations: 8, ..sections.clone() },
                SimulationOptions { num_stations: 5, ..sections.clone() },
                SimulationOptions { z_towards_sensor: true, ..sweeps.clone() },
                noisy(&sections),
                noisy(&sweeps),
                dirty(&sections),
                dirty(&sweeps),
                sections,
                sweeps,
                SimulationOptions { seed, mount, num_steps: 1, num_points: 200, ..SimulationOptions::noise_free() },
            ] {
                assert_eq!(found(&simulate(&options)), [], "{options:?}");
            }
        }
    }
}

#[test]
fn a_wrong_pose_is_no_motion_and_no_size() {
    for options in all_kinds() {
        for station in [0, 4, options.num_stations - 1] {
            let options = SimulationOptions { bad_pose_station: Some(station), ..options.clone() };
            assert_eq!(found(&simulate(&options)), [], "{options:?}");
        }
    }
}

#[test]
fn a_wrong_radius_is_found_and_mended() {
    for (options, session) in with_fault(simulate::Fault::WrongRadius) {
        let finding = only_finding(&session, &options);
        let Fault::WrongRadius { found_mm, std_mm, given_mm } = finding.fault else { panic!("{finding:?}") };
        assert!((found_mm - options.radius_mm).abs() < 4.0 * std_mm, "{found_mm} ± {std_mm} in {options:?}");
        assert!((given_mm - options.radius_mm - 0.3).abs() < 1e-9);
        // 0.3 mm off with a noise of hundredths.
        assert!(finding.explains > 4.0 && finding.severity == Severity::Wrong);
        let Some(Plot::Curve { points, .. }) = &finding.evidence.plot else { panic!("{finding:?}") };
        let best = points.iter().min_by(|a, b| a[1].total_cmp(&b[1])).expect("points");
        assert!((best[0] - found_mm).abs() < 0.1, "the curve is lowest at {best:?}");
        assert_mended(&session, &finding);
    }
}

#[test]
fn the_radius_is_estimated_where_sections_show_it() {
    for options in all_kinds() {
        let session = simulate(&options);
        let (problem, results) = solved(&session);
        let case = Case { session: &session, problem: &problem, results: &results };
        let (found_mm, std_mm) = radius(case).expect("sections");
        assert!((found_mm - options.radius_mm).abs() < 4.0 * std_mm && std_mm < 0.02, "{found_mm} ± {std_mm}");
        assert_eq!(radius(Case { results: &[], ..case }), None);
    }
}

#[test]
fn scaled_profiles_are_told_from_a_wrong_radius() {
    for (options, session) in with_fault(simulate::Fault::ProfileScale) {
        let finding = only_finding(&session, &options);
        let Fault::ProfileScale { factor, std } = finding.fault else { panic!("{finding:?}") };
        assert!((factor - 1.0 / 0.98).abs() < 4.0 * std, "{factor} ± {std} in {options:?}");
        assert_mended(&session, &finding);
    }
}

#[test]
fn a_drift_is_found_with_its_direction() {
    for (options, session) in with_fault(simulate::Fault::Drift) {
        let finding = only_finding(&session, &options);
        let Fault::Drift { total_in_base_mm, std_mm } = finding.fault else { panic!("{finding:?}") };
        // Three directions, the worst of which may be known less well than the one along the drift.
        let error_mm = (total_in_base_mm - Vec3::new(0.3, 0.0, 0.4)).norm();
        assert!(error_mm < 4.0 * 3.0_f64.sqrt() * std_mm, "{total_in_base_mm} ± {std_mm} in {options:?}");
        let Some(Plot::Trend { points, .. }) = &finding.evidence.plot else { panic!("{finding:?}") };
        assert_eq!(points.len(), options.num_stations);
        assert!(points[0][1] < -0.1 && points[points.len() - 1][1] > 0.1, "{points:?}");
    }
}

#[test]
fn a_switched_tool_is_found_and_taken_out() {
    for (options, session) in with_fault(simulate::Fault::ToolFrame) {
        let finding = only_finding(&session, &options);
        let Fault::ToolFrame { from_station_idx, flange_from_tool } = finding.fault else { panic!("{finding:?}") };
        assert_eq!(from_station_idx, options.num_stations / 2);
        let expected_mm = match options.mount {
            Mount::OnFlange => Vec3::new(5.0, -3.0, 60.0),
            // Where the ball shows to be; the orientation of the frame stays open.
            Mount::Fixed => {
                let ball = session.truth.as_ref().expect("simulated").target_in_base_mm;
                let turn = crate::geometry::so3::exp(Vec3::z() * 30.0_f64.to_radians());
                ball - turn.inverse() * (ball - Vec3::new(5.0, -3.0, 60.0))
            }
        };
        // Two calibrations from half of the stations: a few tenths each.
        let error_mm = (flange_from_tool.translation.vector - expected_mm).norm();
        assert!(error_mm < 1.5, "{flange_from_tool} in {options:?}");
        assert_mended(&session, &finding);
    }
}

#[test]
fn wrong_sides_are_named() {
    for mount in MOUNTS {
        let options = SimulationOptions { fault: Some(simulate::Fault::WrongSide), ..sections(mount, 5) };
        let session = simulate(&options);
        let finding = only_finding(&session, &options);
        let Fault::WrongSides { station_idxs } = &finding.fault else { panic!("{finding:?}") };
        assert_eq!(station_idxs.len(), 2);
        assert!(finding.explains > 10.0);
        assert_mended(&session, &finding);
    }
}

#[test]
fn mirrored_axes_are_named() {
    for mount in MOUNTS {
        for options in [sections(mount, 6), sweeps(mount, 6)] {
            let mirrored = |fault| simulate(&SimulationOptions { fault: Some(fault), ..options.clone() });
            let session = mirrored(simulate::Fault::MirroredX);
            let finding = only_finding(&session, &options);
            assert_eq!(finding.fault, Fault::MirroredAxis { axis: Axis::X });
            assert_mended(&session, &finding);
            let session = mirrored(simulate::Fault::MirroredZ);
            let finding = only_finding(&session, &options);
            assert_eq!((&finding.fault, finding.severity), (&Fault::MirroredAxis { axis: Axis::Z }, Severity::Note));
            assert_mended(&session, &finding);
        }
    }
}

#[test]
fn a_sensor_that_is_the_reported_frame_is_named() {
    let options = sweeps(Mount::OnFlange, 7);
    let session = simulate(&options);
    let sensor_in_flange = *session.truth.as_ref().expect("simulated").flange_from_sensor.rigid();
    let remedy = Remedy::RemoveTool { from_station_idx: 0, flange_from_tool: sensor_in_flange.inverse() };
    let finding = only_finding(&apply(&session, &remedy), &options);
    assert!(matches!(finding.fault, Fault::SensorIsTool { .. }), "{finding:?}");
}
