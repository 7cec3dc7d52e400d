//! A session with a sequence is one like any other: solved, diagnosed, verified and reported from the same data.
#![expect(clippy::expect_used, reason = "a test that cannot begin must fail")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use handeye::calibrate::{Problem, best_available};
use handeye::diagnose::diagnose_any;
use handeye::report::document::{Document, Options, document};
use handeye::report::evidence::Evidence;
use handeye::session::{self, Measured, NothingToSolve, Session, measure, measure_in};
use handeye::watch::Unwatched;
use serde_json::Value;

fn samples() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("sample_sessions")
}

fn tracked() -> (Session, Measured) {
    let session = session::load(&samples().join("room-on-robot.json")).expect("the sample");
    let measured = measure_in(&samples(), &session, &mut Unwatched).expect("not cancelled");
    (session, measured)
}

fn handeye(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_handeye")).args(args).current_dir(samples()).output().expect("it runs")
}

#[test]
fn it_is_solved_diagnosed_and_validated() {
    let (session, measured) = tracked();
    let problem = session::problem(&session, &measured).expect("the robot's poses are known");
    assert!(matches!(problem, Problem::Streams(_)));
    let results = problem.solve_all(problem.methods(), &mut Unwatched).expect("not cancelled");
    let best = best_available(&results).expect("a calibration");
    let truth = session.truth.as_ref().expect("it is simulated");
    let off_mm = (best.flange_from_sensor.translation_mm() - truth.flange_from_sensor.translation_mm()).norm();
    let std_mm = best.uncertainty.as_ref().expect("known").translation_std_mm.norm();
    // Three standard deviations of a distance in space.
    assert!(off_mm < 3.0 * std_mm && std_mm < 2.0, "off by {off_mm} mm at {std_mm} mm");
    let diagnosis = diagnose_any(&session, &problem, &results, &mut Unwatched).expect("not cancelled");
    let validation = diagnosis.validation.expect("stretches enough");
    assert_eq!(validation.influence.len(), best.stations.len());
    assert!(best.stations.iter().all(|stretch| stretch.leave_one_out_mm.is_some()));
}

#[test]
fn its_report_shows_the_way_and_the_closed_forms() {
    let (session, measured) = tracked();
    let evidence = Evidence::gather(&session, &measured, &[], &mut Unwatched).expect("not cancelled");
    let report: Document = document(&evidence, &[], &Options::default());
    let figures: Vec<&str> = report.figures().map(|figure| figure.id.as_str()).collect();
    assert!(figures.starts_with(&["camera-way", "camera-motion"]), "{figures:?}");
    let forms = report.tables().find(|table| table.id == "closed-forms").expect("listed");
    assert_eq!(forms.rows.len(), 7);
}

#[test]
fn every_command_takes_it() {
    let run = handeye(&["solve", "room-on-robot.json", "--json"]);
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let file: Value = serde_json::from_slice(&run.stdout).expect("JSON");
    assert_eq!((&file["methods"][0]["method"], &file["methods"][0]["status"]), (&"motion".into(), &"ok".into()));
    for (command, said) in [
        (vec!["check", "room-on-robot.json"], "an RGB-D sequence in room-on-robot-sequence"),
        (vec!["verify", "room-on-robot.json"], "1 calibration on 1 target"),
        (vec!["tool-frame", "room-on-robot.json", "--format", "ur-script"], "set_tcp"),
    ] {
        let run = handeye(&command);
        let out = String::from_utf8_lossy(&run.stdout);
        assert!(run.status.success() && out.contains(said), "{command:?}: {out}");
    }
    // There is nothing to plan: any turn shows all of a pose.
    let run = handeye(&["plan", "room-on-robot.json"]);
    let said = String::from_utf8_lossy(&run.stderr);
    assert!(run.status.code() == Some(3) && said.contains("turn the flange"), "{said}");
}

#[test]
fn what_is_missing_is_named() {
    let (session, _) = tracked();
    let unplaced = measure(&session, None, &mut Unwatched).expect("not cancelled");
    let refusal = session::problem(&session, &unplaced).expect_err("no folder is known");
    assert!(matches!(&refusal, NothingToSolve::SequenceWithoutPlace { folder } if folder == "room-on-robot-sequence"));
    let elsewhere = tempfile::tempdir().expect("a folder");
    let file = elsewhere.path().join("lost.json");
    fs::copy(samples().join("room-on-robot.json"), &file).expect("copied");
    for command in ["solve", "verify", "report", "tool-frame"] {
        let out = elsewhere.path().join("report");
        let mut args = vec![command, file.to_str().expect("UTF-8")];
        match command {
            "report" => args.extend(["--out", out.to_str().expect("UTF-8")]),
            "tool-frame" => args.extend(["--format", "ur-script"]),
            _ => {}
        }
        let run = handeye(&args);
        let said = String::from_utf8_lossy(&run.stderr);
        assert!(run.status.code() == Some(3) && said.contains("room-on-robot-sequence"), "{command}: {said}");
        assert_eq!(said.lines().count(), 1, "{command}: {said}");
    }
}
