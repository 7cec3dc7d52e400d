//! The commands as a shell sees them: output, error line, exit status.
#![expect(clippy::expect_used, reason = "a test that finds nothing to check must fail")]

use std::process::{Command, Output};

use serde_json::Value;

fn handeye(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_handeye"))
        .args(args)
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .env_remove("DISPLAY")
        .env_remove("WAYLAND_DISPLAY")
        .env_remove("WAYLAND_SOCKET")
        .output()
        .expect("the binary starts")
}

fn stdout(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).expect("UTF-8")
}

/// Exit status 2 or 3 with exactly one line on standard error that holds all the fragments.
#[track_caller]
fn check_refusal(args: &[&str], status: i32, fragments: &[&str]) {
    let output = handeye(args);
    let line = String::from_utf8(output.stderr.clone()).expect("UTF-8");
    assert_eq!(output.status.code(), Some(status), "{args:?}: {line}");
    assert_eq!(line.trim_end().lines().count(), 1, "{line}");
    for fragment in fragments {
        assert!(line.contains(fragment), "{fragment:?} is not in {line:?}");
    }
}

#[test]
fn the_result_file_has_the_names_that_programs_rely_on() {
    let output = handeye(&["solve", "sample_sessions/clean-sweeps.json", "--json"]);
    assert_eq!(output.status.code(), Some(0));
    let result: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!(result["format"], "handeye-result");
    assert_eq!(result["version"], 1);
    let methods = result["methods"].as_array().expect("a list");
    let ids: Vec<&str> = methods.iter().filter_map(|method| method["method"].as_str()).collect();
    assert_eq!(ids, ["ball-fixed-point", "ball-max-arc-step", "ball-max-arc", "ball-bundle"]);
    for method in methods {
        assert_eq!(method["status"], "ok");
        assert_eq!(method["flange_from_sensor"]["matrix"].as_array().map(Vec::len), Some(4));
        assert_eq!(method["uncertainty"]["covariance"].as_array().map(Vec::len), Some(6));
        for name in ["scatter_mm", "leave_one_out_mm"] {
            assert!(method[name]["rms"].as_f64().is_some_and(|rms| rms > 0.0), "{name}");
        }
        let station = &method["stations"][1];
        assert_eq!(station["used"], true);
        for name in ["target_in_sensor_mm", "target_in_base_mm", "error_from_first_mm", "error_from_mean_mm"] {
            assert_eq!(station[name].as_array().map(Vec::len), Some(3), "{name}");
        }
    }
}

fn json(args: &[&str]) -> Value {
    let output = handeye(args);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("JSON")
}

#[test]
fn the_result_file_says_how_far_to_rely_on_it() {
    let args = ["solve", "sample_sessions/clean-sweeps.json", "--json", "--method", "ball-bundle"];
    let result = json(&[&args[..], &["--bootstrap", "20"]].concat());
    let uncertainty = &result["methods"][0]["uncertainty"];
    let std_mm = uncertainty["workspace_point_std_mm"].as_f64().expect("a number");
    assert!(uncertainty["workspace_point_95_mm"].as_f64().expect("a number") > std_mm);
    assert!(uncertainty["weakest_direction"]["std_mm"].as_f64().expect("a number") < std_mm);
    assert_eq!(uncertainty["by_radius"]["workspace_point_mm_per_mm"].as_array().map(Vec::len), Some(3));
    assert!(uncertainty.as_object().expect("an object").contains_key("degrees_of_freedom"));
    let diagnosis = &result["diagnosis"];
    assert_eq!(diagnosis["findings"].as_array().map(Vec::len), Some(0), "{}", diagnosis["findings"]);
    assert!(diagnosis["readings"].is_array());
    assert_eq!(diagnosis["validation"]["bootstrap"]["draws"], 20);
    let next = &diagnosis["next_poses"][0];
    assert!(next["workspace_point_std_mm"].as_f64().expect("a number") < std_mm);
    assert_eq!(next["base_from_flange"]["convention"], "fanuc-wpr");
    assert!(json(&[&args[..], &["--no-diagnosis"]].concat()).get("diagnosis").is_none());
}

#[test]
fn the_diagnosis_follows_the_tables() {
    let text = stdout(&handeye(&["solve", "sample_sessions/one-bad-pose.json"]));
    let (_, section) = text.split_once("\nDiagnosis\n").expect("a section");
    for fragment in ["✖ [wrong-pose] The pose of station 7", "next step: Leave out station 7", "per 0.01 mm"] {
        assert!(section.contains(fragment), "{fragment:?} is not in\n{section}");
    }
    assert!(!section.contains("next pose"), "nothing is planned from a wrong result");
    let (head, _) = text.split_once("errors in mm").expect("tables");
    assert!(head.contains("Answer: Bundle of all points (ball-bundle)\n  Not usable: The pose of station 7"), "{head}");
    check_refusal(&["plan", "sample_sessions/one-bad-pose.json"], 3, &["[wrong-pose]", "station 7"]);
    check_refusal(&["solve", "sample_sessions/one-bad-pose.json", "--without", "x"], 2, &["found x", "1, 2, 3"]);
    let text = stdout(&handeye(&["solve", "sample_sessions/one-bad-pose.json", "--without", "7"]));
    for fragment in ["  Good: ", "9 of 10 stations", "Nothing to object to.", "next pose: x "] {
        assert!(text.contains(fragment), "{fragment:?} is not in\n{text}");
    }
    let text = stdout(&handeye(&["solve", "sample_sessions/one-bad-pose.json", "--no-diagnosis"]));
    assert!(!text.contains("Diagnosis"), "{text}");
}

#[test]
fn next_poses_are_planned_in_the_robots_own_angles() {
    let output = handeye(&["plan", "sample_sessions/few-rotations.json", "--stations", "3"]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let text = stdout(&output);
    for fragment in ["3 stations to measure next", "W/°", "σ then/mm", "FANUC W P R"] {
        assert!(text.contains(fragment), "{fragment:?} is not in\n{text}");
    }
    let plan = json(&["plan", "sample_sessions/few-rotations.json", "--max-tilt-deg", "12", "--json"]);
    assert_eq!(plan["format"], "handeye-plan");
    let stations = plan["stations"].as_array().expect("a list");
    assert_eq!(stations.len(), 4);
    let mut before = plan["workspace_point_std_mm"].as_f64().expect("known");
    for station in stations {
        let after = station["workspace_point_std_mm"].as_f64().expect("known");
        assert!(after < before && station["tilt_deg"].as_f64().expect("a number") < 12.001, "{station}");
        before = after;
    }
}

#[test]
fn a_plan_from_nothing_needs_a_rough_cell() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("empty.json");
    let session = r#"{"format": "handeye-session", "version": 1, "target": {"kind": "ball", "radius_mm": 15},
        "robot": {"pose_convention": "kuka-abc"}, "stations": []}"#;
    std::fs::write(&file, session).expect("written");
    let path = file.to_str().expect("UTF-8");
    check_refusal(&["plan", path], 3, &["--sensor-at", "found 0"]);
    check_refusal(&["plan", path, "--ball-at", "1", "2", "3"], 2, &["--sensor-at"]);
    check_refusal(&["plan", path, "--stations", "0"], 2, &["--stations"]);
    check_refusal(&["plan", "no-such-file.json"], 2, &["no-such-file.json"]);
    let rough = ["--sensor-at", "10", "0", "120", "90", "0", "0", "--ball-at", "450", "-120", "100"];
    let plan = json(&[&["plan", path, "--json", "--stations", "6"], &rough[..]].concat());
    let stations = plan["stations"].as_array().expect("a list");
    assert_eq!(stations.len(), 6);
    assert!(stations[2]["workspace_point_std_mm"].is_null() && stations[5]["workspace_point_std_mm"].is_f64());
    assert_eq!(stations[0]["base_from_flange"]["convention"], "kuka-abc");
    let no_width = [&["plan", path, "--half-width-mm", "-1"], &rough[..]].concat();
    check_refusal(&no_width, 3, &["nothing lies within the limits"]);
}

#[test]
fn table_1_of_the_paper_is_reproduced_and_its_misprints_pointed_out() {
    let output = handeye(&["solve", "sample_sessions/lin-mu-2019-table-1.json", "--paper-tables"]);
    assert_eq!(output.status.code(), Some(0));
    let text = stdout(&output);
    for fragment in [
        "RMS 0.309 mm",
        "about (328.6, -48.2, 137.3)",
        "row 2, y: printed 0.211, but the printed centres give -0.211",
        "row 2, z: printed -0.090, but the printed centres give -0.010",
        "largest coordinate of the recomputed error: 0.2110 mm",
    ] {
        assert!(text.contains(fragment), "{fragment:?} is not in\n{text}");
    }
    assert_eq!(text.matches("but the printed centres give").count(), 2, "{text}");
}

#[test]
fn table_2_of_the_paper_has_its_printed_errors_and_no_misprint() {
    let output = handeye(&["solve", "sample_sessions/lin-mu-2019-table-2.json", "--paper-tables"]);
    let text = stdout(&output);
    assert!(text.contains("largest coordinate of the recomputed error: 0.0815 mm"), "{text}");
    assert!(!text.contains("misprint"), "{text}");
}

#[test]
fn methods_that_cannot_run_say_why_and_others_go_on() {
    let output = handeye(&["solve", "sample_sessions/near-largest-arc.json"]);
    assert_eq!(output.status.code(), Some(0));
    assert!(stdout(&output).contains("found 0 stations with a sweep"), "{}", stdout(&output));
    check_refusal(
        &["solve", "sample_sessions/near-largest-arc.json", "--method", "ball-max-arc"],
        3,
        &["nothing could be computed", "ball-max-arc", "found 0 stations with a sweep"],
    );
}

#[test]
fn wrong_input_is_refused_in_one_line() {
    check_refusal(&["solve", "no-such-file.json"], 2, &["no-such-file.json"]);
    check_refusal(&["check", "Cargo.toml"], 2, &["Cargo.toml", "line 1"]);
    check_refusal(&["solve", "src"], 2, &["src"]);
    check_refusal(&["simulate", "--out", "x.json", "--target", "cube"], 2, &["cube", "plate"]);
    check_refusal(&["solve"], 2, &["FILE"]);
    check_refusal(&["solve", "x.json", "--method", "best"], 2, &["best", "ball-bundle"]);
    check_refusal(&["report", "x.json", "--out", "x"], 2, &["x.json"]);
}

#[test]
fn without_a_display_the_window_says_what_works_without_one() {
    check_refusal(&[], 2, &["display", "solve", "report"]);
    check_refusal(&["sample_sessions/clean-sweeps.json"], 2, &["display"]);
}

#[test]
fn a_simulated_session_is_solved_close_to_its_truth() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("simulated.json");
    let path = file.to_str().expect("UTF-8");
    let output = handeye(&["simulate", "--out", path, "--seed", "5", "--stations", "6", "--points", "100"]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(handeye(&["check", path]).status.code(), Some(0));
    let result = handeye(&["solve", path, "--json", "--method", "ball-bundle"]);
    let result: Value = serde_json::from_slice(&result.stdout).expect("JSON");
    let session: Value = serde_json::from_slice(&std::fs::read(&file).expect("written")).expect("JSON");
    let found = &result["methods"][0]["flange_from_sensor"]["translation_mm"];
    let truth = &session["truth"]["flange_from_sensor"]["translation_mm"];
    for axis in 0..3 {
        let difference = found[axis].as_f64().expect("a number") - truth[axis].as_f64().expect("a number");
        // Six stations with the default noise know the translation to a tenth of a millimetre.
        assert!(difference.abs() < 0.5, "axis {axis}: {difference} mm");
    }
}

#[test]
fn what_is_printed_is_about_the_target_of_the_session() {
    let (plate, tip) = ("sample_sessions/plate.json", "sample_sessions/tip.json");
    for (args, held, missing) in [
        (
            &["solve", plate, "--paper-tables"][..],
            &["edge point in sensor", "\np1 ", "corner of the plate in base ("][..],
            "ball",
        ),
        (&["solve", tip, "--paper-tables"], &["tip in sensor", "scatter of the tip in base", "\n12 "], "ball"),
        (&["solve", plate, "--json"], &["plate-bundle"], "by_radius"),
        (&["solve", tip, "--json"], &["fixed-point"], "by_radius"),
        (&["solve", "sample_sessions/clean-sweeps.json", "--json", "--no-diagnosis"], &["by_radius"], "edge point"),
        (&["solve", plate, "--no-diagnosis"], &[" mm, 0.28°"], "0.2761"),
        (
            &["solve", "sample_sessions/three-targets.json", "--no-diagnosis"],
            &["not used here: the further targets plate, point; `handeye verify` judges this result on them"],
            "-0.000",
        ),
        (&["solve", plate, "--no-diagnosis"], &["corner of the plate in base"], "not used here"),
    ] {
        let output = handeye(args);
        assert_eq!(output.status.code(), Some(0), "{args:?}");
        let text = stdout(&output);
        for fragment in held {
            assert!(text.contains(fragment), "{args:?}: {fragment:?} is not in\n{text}");
        }
        assert!(!text.contains(missing), "{args:?}: {missing:?} is in\n{text}");
    }
    let wrong = handeye(&["solve", plate, "--method", "ball-bundle"]);
    let said = stdout(&wrong) + &String::from_utf8(wrong.stderr).expect("UTF-8");
    assert_eq!(said.matches("Take a method").count(), 1, "{said}");
    assert!(said.ends_with(
        "nothing could be computed: ball-bundle is not for this target; plate-orthogonal, plate-bundle are\n"
    ));
}

#[test]
fn check_judges_by_the_method_that_gives_the_answer_and_names_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let sample = |name: &str| -> Value {
        serde_json::from_slice(&std::fs::read(format!("sample_sessions/{name}.json")).expect("a sample")).expect("JSON")
    };
    let checked = |session: &Value| {
        let path = folder.path().join("session.json");
        std::fs::write(&path, session.to_string()).expect("written");
        let path = path.to_str().expect("UTF-8");
        let solved = handeye(&["solve", path, "--no-diagnosis"]);
        (stdout(&handeye(&["check", path])), stdout(&solved))
    };
    let mut swapped = sample("plate");
    swapped["stations"][3]["edge"] = "q".into();
    let (said, solved) = checked(&swapped);
    let line = said.lines().find(|line| line.starts_with("station-stands-out: ")).expect("it stands out");
    let sentence = line.strip_prefix("station-stands-out: ").and_then(|line| line.strip_suffix(" (plate-bundle)"));
    let answer = solved.split("(plate-bundle)\n").last().expect("the answer's section");
    assert!(answer.contains(sentence.expect("the method is named")), "{said}\n{solved}");
    let mut far = sample("tip");
    for (touched_mm, is_far) in [([1.0, 2.0, 3.0], true), ([452.0, -118.0, 97.0], true), ([452.1, -118.1, 96.0], false)]
    {
        far["target"]["touched_in_base_mm"] = touched_mm.to_vec().into();
        let (said, _) = checked(&far);
        assert_eq!(said.contains("touched-point-off: The touched point lies "), is_far, "{said}");
        assert_eq!(said.contains("nothing odd found"), !is_far, "{said}");
    }
}

#[test]
fn a_calibration_is_written_for_a_controller_and_refused_where_it_would_be_wrong() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name).display().to_string();
    let fixed = path("fixed.json");
    let wrong = path("wrong.txt");
    let turned = path("turned.txt");
    std::fs::write(&turned, "0 -1 0 10\n1 0 0 -20.5\n0 0 1 125.25\n0 0 0 1\n").expect("written");
    std::fs::write(&wrong, "0 -1 0.3 10\n1 0 0 -20.5\n0 0 1 125.25\n0 0 0 1\n").expect("written");
    let result = r#"{"format": "handeye-result", "version": 1, "methods": [{"method": "ball-bundle", "status": "ok", "base_from_sensor":
        {"matrix": [[1, 0, 0, 1], [0, 1, 0, 2], [0, 0, 1, 3], [0, 0, 0, 1]]}}]}"#;
    std::fs::write(&fixed, result).expect("written");
    let sample = "sample_sessions/plate.json";
    for (args, status, held) in [
        (&["tool-frame", &turned, "--format", "fanuc-ls", "--number", "3"][..], 0, "PR[81,6]=90.0000 ;"),
        (&["tool-frame", &turned, "--format", "fanuc-ls", "--number", "3"], 0, "UTOOL[3]=PR[81] ;"),
        (&["tool-frame", sample, "--format", "urdf", "--format", "ur-script"], 0, "# standard deviation: 0.1"),
        (&["tool-frame", &fixed, "--format", "ros2-yaml"], 0, "frame_id: base_link"),
        (&["tool-frame", &fixed, "--format", "kuka-config"], 2, "stands beside the robot"),
        (&["tool-frame", &wrong, "--format", "matrix"], 2, "no rotation"),
        (&["tool-frame", &turned, "--format", "fanuc"], 2, "found fanuc, expected the name of a format"),
        (&["tool-frame", "sample_sessions/workpiece.json", "--format", "matrix"], 3, "no"),
        (&["tool-frame", "--list"], 0, "staubli-val3"),
        (&["tool-frame", &turned], 2, "--format"),
    ] {
        let output = handeye(args);
        let said = stdout(&output) + &String::from_utf8(output.stderr.clone()).expect("UTF-8");
        assert_eq!(output.status.code(), Some(status), "{args:?}: {said}");
        assert!(said.contains(held), "{args:?}: {held:?} is not in\n{said}");
    }
    let out = path("frames");
    let args = ["tool-frame", &turned, "--format", "abb-rapid", "--out", &out];
    assert_eq!(handeye(&args).status.code(), Some(0));
    assert!(folder.path().join("frames/abb-rapid.mod").exists());
    // What is there is not overwritten unasked.
    assert_eq!(handeye(&args).status.code(), Some(2));
}
