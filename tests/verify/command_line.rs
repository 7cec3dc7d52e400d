//! `handeye verify` as a shell sees it.

use std::process::Output;

use handeye::scene::PartKind;
use handeye::session::Session;
use handeye::simulate::{SimulationOptions, SimulationTarget, simulate};
use serde_json::Value;

use super::shell::{Files, assert_refused, handeye};

fn verify(args: &[&str]) -> Output {
    handeye("verify", args)
}

fn simulated(kind: PartKind, seed: u64) -> Session {
    let options = SimulationOptions::of(SimulationTarget::Part(kind));
    simulate(&SimulationOptions { seed, has_points: true, ..options })
}

#[track_caller]
fn refused(args: &[&str], status: i32, fragments: &[&str]) {
    assert_refused(&verify(args), status, fragments);
}

#[test]
fn the_verification_file_has_the_names_that_programs_rely_on() {
    let files = Files::new();
    let plate = files.session("plate.json", &simulated(PartKind::Plate, 1));
    let tip = files.session("tip.json", &simulated(PartKind::Pin, 2));
    let matrix =
        files.text("chen.txt", "0.998 -0.021 -0.056 -7.806\n0.001 -9.441 -0.331 123.89\n0.006 0.331 0.942 -79.412");
    let output = verify(&[&plate, "--with", &tip, "--calibration", &matrix, "--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let file: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!((&file["format"], &file["version"]), (&"handeye-verification".into(), &1.into()));
    let calibrations = file["calibrations"].as_array().expect("a list");
    let kinds: Vec<&str> =
        calibrations.iter().filter_map(|calibration| calibration["origin"]["kind"].as_str()).collect();
    assert_eq!(kinds, ["solved", "solved", "solved", "joint", "given"]);
    assert_eq!(calibrations[4]["matrix_check"]["is_rotation"], false);
    assert_eq!(calibrations[4]["matrix_check"]["suspect"]["row"], 2);
    assert_eq!(calibrations[4]["matrix_check"]["suspects"].as_array().map(Vec::len), Some(1));
    assert_eq!(calibrations[4]["name"], "chen.txt (nearest rotation)");
    let targets = file["targets"].as_array().expect("a list");
    assert_eq!(targets.len(), 2);
    let on_plate = &targets[0]["results"][1];
    assert_eq!((&on_plate["own_data"], &on_plate["status"]), (&true.into(), &"ok".into()));
    for name in ["to_line_mm", "to_plane_mm"] {
        for figure in ["mean", "sd", "rms", "max"] {
            assert!(on_plate["distances"][name][figure].as_f64().is_some_and(|value| value > 0.0), "{name} {figure}");
        }
    }
    assert_eq!(on_plate["distances"]["points"].as_array().map(Vec::len), Some(18));
    let on_tip = &targets[1]["results"][1];
    assert_eq!(on_tip["own_data"], false);
    assert_eq!(on_tip["stability"]["three_delta_mm"].as_array().map(Vec::len), Some(3));
    // Both see the sensor of the same simulated cell, to the noise of a few poses.
    assert!(on_tip["error_mm"]["rms"].as_f64().is_some_and(|rms| rms < 0.3), "{}", on_tip["error_mm"]);
    let text = String::from_utf8(verify(&[&plate, "--with", &tip]).stdout).expect("UTF-8");
    for fragment in ["Bundle of both edges *", "3δ", "every calibration on every target", "All targets together"] {
        assert!(text.contains(fragment), "{fragment:?} is not in\n{text}");
    }
}

#[test]
fn refusals_say_which_file_and_why() {
    let files = Files::new();
    let plate = simulated(PartKind::Plate, 1);
    let path = files.session("plate.json", &plate);
    refused(&[&files.path("missing.json")], 2, &["missing.json"]);
    let broken = files.text("broken.txt", "1 0 0 x");
    refused(&[&path, "--calibration", &broken], 2, &["broken.txt", "\"x\"", "number 4"]);
    let mut beside = simulated(PartKind::Pin, 2);
    beside.mount = handeye::calibrate::Mount::Fixed;
    let beside = files.session("beside.json", &beside);
    refused(&[&path, "--with", &beside], 2, &["beside.json", "mounted otherwise"]);
    let mut few = plate;
    few.stations.truncate(2);
    let few = files.session("few.json", &few);
    refused(&[&few], 3, &["no calibration was computed", "--calibration"]);
}

/// A file of verification from the arguments.
fn file_of(args: &[&str]) -> Value {
    let output = verify(&[args, &["--json"]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("JSON")
}

#[test]
fn profiles_of_another_session_are_read_with_the_noise_that_it_states() {
    let files = Files::new();
    let plate = |seed, profile_std_mm| {
        let options = SimulationOptions::of(SimulationTarget::Part(PartKind::Plate));
        simulate(&SimulationOptions { seed, profile_std_mm, num_points: 200, ..options })
    };
    let (clean, noisy) = (plate(1, 0.01), plate(2, 0.1));
    assert_eq!(noisy.sensor.profile_std_mm, Some(0.1));
    let alone = files.session("noisy.json", &noisy);
    let first = files.session("clean.json", &clean);
    let (alone, along) = (file_of(&[&alone]), file_of(&[&first, "--with", &alone]));
    let count = |file: &Value, target: usize| {
        file["targets"][target]["results"][0]["error_mm"]["count"].as_u64().expect("a count")
    };
    assert_eq!(count(&along, 1), count(&alone, 0), "as many profiles as by itself");
    assert_eq!(along["targets"][1]["refused"], alone["targets"][0]["refused"]);
    // Read with a tenth of their noise most of them show no edge, which is said.
    let mut mistaken = noisy;
    mistaken.sensor.profile_std_mm = Some(0.01);
    let mistaken = files.session("mistaken.json", &mistaken);
    let num_refused = file_of(&[&first, "--with", &mistaken])["targets"][1]["refused"].as_array().map_or(0, Vec::len);
    assert!(num_refused > 0);
    let text = String::from_utf8(verify(&[&first, "--with", &mistaken]).stdout).expect("UTF-8");
    assert!(text.contains(&format!("{num_refused} of 18 profiles were refused")), "{text}");
}

#[test]
fn the_calibration_from_all_targets_is_told_and_can_be_given_again() {
    let files = Files::new();
    let plate = files.session("plate.json", &simulated(PartKind::Plate, 1));
    let tip = files.session("tip.json", &simulated(PartKind::Pin, 2));
    let output = verify(&[&plate, "--with", &tip]);
    let text = String::from_utf8(output.stdout).expect("UTF-8");
    let (_, joint) = text.split_once("\nall targets together\n").expect("its section");
    for fragment in ["flange_from_sensor: x ", " ± ", "by chance", "moved: from where"] {
        assert!(joint.contains(fragment), "{fragment:?} is not in\n{joint}");
    }
    let found = file_of(&[&plate, "--with", &tip]);
    let file = files.text("all.json", &found.to_string());
    let again = file_of(&[&plate, "--with", &tip, "--calibration", &file]);
    let calibrations = again["calibrations"].as_array().expect("a list");
    let given = calibrations.last().expect("the one given");
    assert_eq!(given["name"], "all.json: All targets together");
    let of_joint = calibrations.iter().find(|calibration| calibration["origin"]["kind"] == "joint").expect("joint");
    assert_eq!(given["flange_from_sensor"]["translation_mm"], of_joint["flange_from_sensor"]["translation_mm"]);
    // It was computed from both, wherever it comes from now.
    let is_own = |target: usize| {
        let results = again["targets"][target]["results"].as_array().expect("a list");
        results.last().expect("the one given")["own_data"] == true
    };
    assert!(is_own(0) && is_own(1));
}

#[test]
fn a_scanned_part_is_shown_the_way_to_its_command() {
    let files = Files::new();
    let part = files.session("part.json", &simulated(PartKind::Square, 1));
    let matrix = files.text("sensor.txt", "1 0 0 5 0 1 0 6 0 0 1 7");
    let output = verify(&[&part, "--calibration", &matrix]);
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(text.contains("handeye scan") && text.contains("part.json"), "{text}");
    refused(&[&part], 3, &["workpiece", "handeye scan"]);
}
