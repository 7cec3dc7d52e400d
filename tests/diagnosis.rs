//! Every fault that `handeye simulate --fault` makes is diagnosed by its name first, and a clean session is left alone.
#![expect(clippy::expect_used, reason = "a test that cannot run must fail")]

use handeye::calibrate::{Edge, Method, MethodResult, Mount, best_available, solve_all};
use handeye::diagnose::{Case, Diagnosis, Fault as Found, Remedy, Severity, diagnose, diagnose_any, remedy};
use handeye::geometry::{Rigid, Transform, Vec3, stats};
use handeye::report::compare::distance_from_truth;
use handeye::session::{Session, ball_problem, measure, parse, problem, samples};
use handeye::simulate::{Dirt, Fault, SimulationOptions, simulate};
use handeye::watch::Unwatched;

const MOUNTS: [Mount; 2] = [Mount::OnFlange, Mount::Fixed];

/// The default session with fewer steps and points, so that the tests are quick: the noise is that of the robot anyway.
fn sweeps(mount: Mount, seed: u64) -> SimulationOptions {
    SimulationOptions { seed, mount, num_steps: 8, step_mm: 2.0, num_points: 160, ..SimulationOptions::default() }
}

fn sections(mount: Mount, seed: u64) -> SimulationOptions {
    SimulationOptions { num_stations: 20, num_steps: 1, ..sweeps(mount, seed) }
}

fn solved(session: &Session) -> (Diagnosis, Vec<MethodResult>) {
    let measured = measure(session, None, &mut Unwatched).expect("not cancelled");
    let problem = ball_problem(session, &measured).expect("a ball");
    let results = solve_all(&problem, &Method::BALL, &mut Unwatched).expect("not cancelled");
    let case = Case { session, problem: &problem, results: &results };
    (diagnose(case, &mut Unwatched).expect("not cancelled"), results)
}

fn codes(session: &Session) -> Vec<&'static str> {
    solved(session).0.findings.iter().map(|finding| finding.fault.code()).collect()
}

fn assert_first(fault: Fault, options: &SimulationOptions) {
    let session = simulate(&SimulationOptions { fault: Some(fault), ..options.clone() });
    let codes = codes(&session);
    assert_eq!(codes.first(), Some(&fault.id()), "{codes:?} in {options:?}");
}

#[test]
fn every_fault_of_a_session_of_sweeps_comes_first() {
    for fault in Fault::ALL {
        // The benchmark takes twenty seeds each.
        for (mount, seed) in MOUNTS.into_iter().zip(1..) {
            assert_first(fault, &sweeps(mount, seed));
        }
    }
}

#[test]
fn faults_of_a_session_of_single_sections_come_first() {
    // Without steps there is no travel to speak of.
    let needs_sweeps = |fault: &Fault| matches!(fault, Fault::TravelOffNormal | Fault::StepDiffersFromPose);
    let faults = Fault::ALL.into_iter().filter(|fault| !needs_sweeps(fault));
    for (fault, mount) in faults.zip(MOUNTS.into_iter().cycle()) {
        assert_first(fault, &sections(mount, 5));
    }
}

#[test]
fn clean_sessions_have_no_findings() {
    // Long sweeps show every trace of biased flanks.
    let long = SimulationOptions { num_steps: 21, num_points: 400, dirt: Dirt::all(), ..SimulationOptions::default() };
    assert_eq!(codes(&simulate(&long)), [""; 0]);
    for seed in 1..=10 {
        for mount in MOUNTS {
            let dirty = SimulationOptions { dirt: Dirt::all(), num_points: 400, ..sweeps(mount, seed) };
            for options in [sweeps(mount, seed), sections(mount, seed), dirty] {
                assert_eq!(codes(&simulate(&options)), [""; 0], "{options:?}");
            }
        }
    }
}

#[test]
fn one_wrong_pose_is_named_wherever_it_is_and_leaving_it_out_mends_the_answer() {
    let (mut mended_mm, mut clean_mm) = (Vec::new(), Vec::new());
    let error_mm = |session: &Session| {
        let (_, results) = solved(session);
        let solution = best_available(&results).expect("a solution");
        distance_from_truth(solution, session.truth.as_ref().expect("simulated")).workspace_point_mm
    };
    for (bad, seed) in (0..10).zip(20..) {
        for options in MOUNTS.map(|mount| sweeps(mount, seed)) {
            let session = simulate(&SimulationOptions { bad_pose_station: Some(bad), ..options.clone() });
            let (diagnosis, _) = solved(&session);
            let [finding] = diagnosis.findings.as_slice() else { panic!("{:?} at {bad}", diagnosis.findings) };
            assert!(matches!(finding.fault, Found::WrongPose { station_idx, .. } if station_idx == bad));
            assert_eq!(finding.remedy, Some(Remedy::LeaveOut(vec![bad])));
            mended_mm.push(error_mm(&remedy::apply(&session, &Remedy::LeaveOut(vec![bad]))));
            clean_mm.push(error_mm(&simulate(&options)));
        }
    }
    // Nine stations in place of ten: 5 % by their number, more where the one left out had a say in some direction.
    let (mended_mm, clean_mm) = (stats::rms(mended_mm), stats::rms(clean_mm));
    assert!(mended_mm < 1.2 * clean_mm, "{mended_mm} mm, {clean_mm} mm with all stations");
}

#[test]
fn several_wrong_poses_are_all_named() {
    for (num_stations, bad) in [(10, [2, 7].as_slice()), (12, &[0, 5, 11]), (20, &[1, 4, 9, 13, 16, 19])] {
        for steps in [8, 1] {
            for seed in 1..=2 {
                let options = SimulationOptions { num_stations, num_steps: steps, ..sweeps(Mount::OnFlange, seed) };
                let mut session = simulate(&options);
                for station in bad {
                    let wrong = simulate(&SimulationOptions { bad_pose_station: Some(*station), ..options.clone() });
                    session.stations[*station] = wrong.stations[*station].clone();
                }
                let named: Vec<usize> = solved(&session)
                    .0
                    .findings
                    .iter()
                    .filter_map(|finding| match finding.fault {
                        Found::WrongPose { station_idx, .. } => Some(station_idx),
                        _ => None,
                    })
                    .collect();
                let mut sorted = named.clone();
                sorted.sort_unstable();
                assert_eq!(sorted, bad, "{num_stations} stations, {steps} steps, seed {seed}");
            }
        }
    }
}

#[test]
fn a_list_of_poses_that_slipped_by_one_is_found() {
    for options in [sweeps(Mount::OnFlange, 3), sections(Mount::Fixed, 3)] {
        let clean = simulate(&options);
        let num = clean.stations.len();
        let slipped: Vec<(usize, usize)> = (0..num).map(|idx| (idx, (idx + 1) % num)).collect();
        let (diagnosis, _) = solved(&remedy::apply(&clean, &Remedy::TakePosesFrom(slipped)));
        let first = diagnosis.findings.first().expect("a finding");
        let back: Vec<(usize, usize)> = (0..num).map(|idx| (idx, (idx + num - 1) % num)).collect();
        assert_eq!(first.remedy, Some(Remedy::TakePosesFrom(back)), "{:?}", first.fault);
    }
}

#[test]
fn where_most_stations_contradict_each_other_that_is_said() {
    let options = sweeps(Mount::OnFlange, 1);
    let mut session = simulate(&options);
    for (station, shift_mm) in session.stations.iter_mut().zip([3.0, -4.0, 5.0, -6.0, 8.0]) {
        for capture in &mut station.captures {
            let translation_mm = capture.base_from_flange.translation_mm() + Vec3::new(shift_mm, 1.0, -0.5 * shift_mm);
            capture.base_from_flange = Transform::from_parts(translation_mm, capture.base_from_flange.rotation());
        }
    }
    let codes = codes(&session);
    assert_eq!(codes.first(), Some(&"too-few-clean-stations"), "{codes:?}");
}

/// Every sample teaches one thing, and the diagnosis says what.
#[test]
fn the_samples_are_diagnosed_as_what_they_teach() {
    let expected: [(&str, &[&str]); 7] = [
        ("lin-mu-2019-table-1.json", &["few-stations"]),
        // The printed poses and sensor points are not consistent with each other.
        ("lin-mu-2019-table-2.json", &["does-not-fit", "few-stations", "not-converged"]),
        ("clean-sweeps.json", &[]),
        ("dirty-profiles.json", &[]),
        ("near-largest-arc.json", &["blind-in-y"]),
        ("few-rotations.json", &["little-rotation"]),
        ("one-bad-pose.json", &["wrong-pose"]),
    ];
    let of_ball = samples::ALL[..expected.len()].iter();
    for sample in of_ball {
        let session = parse(sample.json.as_bytes(), sample.file_name).expect("a sample");
        let (_, wanted) = expected.iter().find(|(name, _)| *name == sample.file_name).expect("a known sample");
        assert_eq!(codes(&session), *wanted, "{}", sample.file_name);
    }
}

/// Findings and remedies speak of stations by their place in the session, whatever takes part.
#[test]
fn stations_that_take_no_part_do_not_shift_the_blame() {
    let mut session = simulate(&SimulationOptions { bad_pose_station: Some(6), ..sweeps(Mount::OnFlange, 2) });
    session.stations[1].enabled = false;
    session.stations[4].enabled = false;
    let (diagnosis, _) = solved(&session);
    let first = diagnosis.findings.first().expect("a finding");
    assert!(matches!(first.fault, Found::WrongPose { station_idx: 6, .. }), "{:?}", first.fault);
    assert_eq!(first.remedy, Some(Remedy::LeaveOut(vec![6])));
    let mended = remedy::apply(&session, &Remedy::LeaveOut(vec![6]));
    let taking_part: Vec<bool> = mended.stations.iter().map(|station| station.enabled).collect();
    assert_eq!(taking_part, [true, false, true, true, false, true, false, true, true, true]);
    assert!(codes(&mended).is_empty(), "{:?}", codes(&mended));
}

/// A list of poses that lost one and so slipped: the last station has nobody's pose and cannot be mended.
#[test]
fn a_slipped_list_that_lost_a_pose_leaves_the_last_station_out() {
    let clean = simulate(&sweeps(Mount::OnFlange, 4));
    let mut slipped = clean.clone();
    for idx in (1..slipped.stations.len()).rev() {
        for (capture, other) in slipped.stations[idx].captures.iter_mut().zip(&clean.stations[idx - 1].captures) {
            capture.base_from_flange = other.base_from_flange;
        }
    }
    // The first pose is doubled, the last one is lost.
    let (diagnosis, _) = solved(&slipped);
    let first = diagnosis.findings.first().expect("a finding");
    let mended = remedy::apply(&slipped, first.remedy.as_ref().expect("a remedy"));
    let (after, results) = solved(&mended);
    assert!(!mended.stations.last().expect("ten").enabled, "{:?}", first.fault);
    assert!(after.findings.is_empty(), "{:?}", after.findings);
    let error =
        distance_from_truth(best_available(&results).expect("solved"), clean.truth.as_ref().expect("simulated"));
    assert!(error.workspace_point_mm < 0.1, "{} mm", error.workspace_point_mm);
}

/// The same without a word about the robot's noise, which then has to be found in spite of the fault.
#[test]
fn faults_come_first_where_no_noise_is_stated() {
    for fault in
        [Fault::WrongRadius, Fault::ProfileScale, Fault::WrongPose, Fault::Drift, Fault::ToolFrame, Fault::MixedOrder]
    {
        for seed in 1..=2 {
            let options = SimulationOptions { fault: Some(fault), ..sweeps(Mount::OnFlange, seed) };
            let mut session = simulate(&options);
            session.robot.position_std_mm = None;
            session.robot.orientation_std_deg = None;
            let codes = codes(&session);
            assert_eq!(codes.first(), Some(&fault.id()), "seed {seed}: {codes:?}");
        }
    }
}

/// A plate's station that is set to the edge it did not see is told apart from one with a wrong pose, and one click mends it.
#[test]
fn each_station_of_a_plate_at_the_wrong_edge_is_named_with_its_edge() {
    let sample = samples::ALL.iter().find(|sample| sample.file_name == "plate.json").expect("a sample");
    let session = parse(sample.json.as_bytes(), sample.file_name).expect("a sample");
    // Some of its stations throw a shadow behind the edge, which is no hole over it.
    assert!(diagnosed(&session).findings.iter().all(|finding| finding.severity == Severity::Note));
    for station_idx in 0..session.stations.len() {
        let mut mislabelled = session.clone();
        let saw = session.stations[station_idx].edge.expect("an edge");
        mislabelled.stations[station_idx].edge = Some(if saw == Edge::P { Edge::Q } else { Edge::P });
        let diagnosis = diagnosed(&mislabelled);
        let first = diagnosis.findings.first().expect("a finding");
        assert_eq!(first.fault, Found::WrongEdge { station_idx, edge: saw });
        let remedy = first.remedy.as_ref().expect("a remedy");
        assert_eq!(remedy, &Remedy::SetEdge { station_idx, edge: saw });
        assert_eq!(remedy::apply(&mislabelled, remedy), session);
        let others = diagnosis.findings.iter().filter(|finding| finding.severity == Severity::Wrong).count();
        assert_eq!(others, 1, "station {station_idx}: {:?}", diagnosis.findings);
    }
}

/// From one station nobody can tell whether its pose is wrong or its profile.
#[test]
fn a_wrong_pose_at_a_plate_is_a_pose_or_a_profile() {
    let sample = samples::ALL.iter().find(|sample| sample.file_name == "plate.json").expect("a sample");
    let session = parse(sample.json.as_bytes(), sample.file_name).expect("a sample");
    for (station_idx, shift_mm) in [(0, 3.0), (7, 20.0), (12, 90.0)] {
        let mut bad = session.clone();
        for capture in &mut bad.stations[station_idx].captures {
            let pose = capture.base_from_flange.rigid();
            let shifted = Rigid::translation(shift_mm, -0.5 * shift_mm, 0.8 * shift_mm) * *pose;
            capture.base_from_flange = Transform::from_rigid(shifted);
        }
        let diagnosis = diagnosed(&bad);
        let first = diagnosis.findings.first().expect("a finding");
        assert!(
            matches!(first.fault, Found::WrongStation { station_idx: found, .. } if found == station_idx),
            "{:?}",
            first.fault
        );
        assert_eq!(first.remedy, Some(Remedy::LeaveOut(vec![station_idx])));
    }
}

fn diagnosed(session: &Session) -> Diagnosis {
    let measured = measure(session, None, &mut Unwatched).expect("not cancelled");
    let problem = problem(session, &measured).expect("a plate");
    let results = problem.solve_all(problem.methods(), &mut Unwatched).expect("not cancelled");
    diagnose_any(session, &problem, &results, &mut Unwatched).expect("not cancelled")
}
