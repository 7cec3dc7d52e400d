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
