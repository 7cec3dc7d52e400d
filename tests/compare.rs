//! `handeye compare` and `handeye history`, held against a simulated truth and against folders as people leave them.
#![expect(clippy::expect_used, reason = "a test that finds nothing to check must fail")]

use std::fs;
use std::path::Path;
use std::process::Command;

use handeye::geometry::so3;
use handeye::geometry::{Vec3, stats::SplitMix};
use serde_json::{Value, json};

const STD_MM: f64 = 0.01;
const STD_RAD: f64 = 5e-5;

fn run(args: &[&str]) -> (i32, String, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_handeye"))
        .args(args)
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .expect("it runs");
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (output.status.code().expect("no signal"), text(&output.stdout), text(&output.stderr))
}

#[track_caller]
fn json_of(args: &[&str]) -> Value {
    let (status, out, error) = run(args);
    assert_eq!(status, 0, "{error}");
    serde_json::from_str(&out).expect("JSON")
}

fn vector(value: &Value) -> Vec3 {
    let numbers: Vec<f64> = value.as_array().expect("a list").iter().map(|v| v.as_f64().expect("a number")).collect();
    Vec3::from_column_slice(&numbers)
}

/// A result file as `solve --json` writes it, as far as comparisons read it.
fn result(translation_mm: Vec3, rotation: Vec3, std: Option<[f64; 2]>) -> Value {
    let turn = so3::exp(rotation).to_rotation_matrix();
    let row = |idx: usize| json!([turn[(idx, 0)], turn[(idx, 1)], turn[(idx, 2)], translation_mm[idx]]);
    let uncertainty = std.map(|[rad, mm]| {
        let variance = |idx: usize| if idx < 3 { rad * rad } else { mm * mm };
        let covariance: Vec<Vec<f64>> =
            (0..6).map(|row| (0..6).map(|column| if row == column { variance(row) } else { 0.0 }).collect()).collect();
        json!({ "covariance": covariance, "reference_point_in_sensor_mm": [0.0, 0.0, 60.0] })
    });
    json!({
        "format": "handeye-result", "version": 1, "session": "simulated", "answer": "ball-bundle",
        "methods": [{
            "method": "ball-bundle", "status": "ok",
            "flange_from_sensor": { "matrix": [row(0), row(1), row(2), [0.0, 0.0, 0.0, 1.0]] },
            "uncertainty": uncertainty,
            "stations": [{ "label": "1", "target_in_sensor_mm": [1.0, 2.0, 58.0] }, { "label": "2", "used": false }],
        }],
    })
}

fn write(folder: &Path, name: &str, text: &str) -> String {
    let path = folder.join(name);
    fs::write(&path, text).expect("written");
    path.to_string_lossy().into_owned()
}

const AT: Vec3 = Vec3::new(10.0, 20.0, 130.0);
const TURN: Vec3 = Vec3::new(0.0, 0.0, 1.5);

#[test]
fn a_known_difference_is_found_in_the_flange_and_at_points() {
    let folder = tempfile::tempdir().expect("a folder");
    let stds = Some([STD_RAD, STD_MM]);
    let a = write(folder.path(), "a.json", &result(AT, TURN, stds).to_string());
    let moved = Vec3::new(0.3, 0.0, -0.1);
    let b = write(folder.path(), "b.json", &result(AT + moved, TURN, stds).to_string());
    let found = json_of(&["compare", &a, &b, "--json", "--at", "0,0,80", "--at", "-5,0,60"]);
    // Doubles in a file and back.
    assert!((vector(&found["difference"]["translation_mm"]) - moved).norm() < 1e-9);
    assert!(found["difference"]["angle_deg"].as_f64().expect("an angle") < 1e-6);
    assert_eq!(found["difference"]["is_significant"], true);
    assert_eq!(found["difference"]["std_of"], "both");
    for shift in [&found["points"][0], &found["points"][1], &found["reference_point"], &found["measured_points"][0]] {
        assert!((vector(&shift["shift_mm"]) - moved).norm() < 1e-6, "{shift}");
    }
    assert_eq!(found["measured_points"].as_array().map(Vec::len), Some(2));
    let (status, said, _) = run(&["compare", &a, &b]);
    assert!(status == 0 && said.contains("a real difference") && said.contains("+0.300 ± 0.014"), "{said}");
    // A measurement that differs by a tenth of a σ.
    let near = write(folder.path(), "near.json", &result(AT + moved * 0.003, TURN, stds).to_string());
    let (_, said, _) = run(&["compare", &a, &near]);
    assert!(said.contains("within what chance explains"), "{said}");
}

#[test]
fn the_same_file_or_measurement_twice_is_no_evidence() {
    let folder = tempfile::tempdir().expect("a folder");
    let stds = Some([STD_RAD, STD_MM]);
    let mut file = result(AT, TURN, stds);
    file["methods"][0]["stations"] = (0..5).map(|idx| json!({ "target_in_sensor_mm": [idx, 2.5, 58.0] })).collect();
    let a = write(folder.path(), "a.json", &file.to_string());
    let copy = write(folder.path(), "copy.json", &file.to_string());
    // The same measurement, written another day.
    file["date"] = json!("2026-05-01");
    let again = write(folder.path(), "again.json", &file.to_string());
    for (other, shared, words) in
        [(&a, "file", "same file"), (&copy, "file", "same file"), (&again, "data", "same measurement")]
    {
        let found = json_of(&["compare", &a, other, "--json"]);
        assert_eq!((&found["shared"], &found["difference"]["std_of"]), (&json!(shared), &json!("same data")));
        assert_eq!(
            (&found["difference"]["p_value"], &found["difference"]["is_significant"]),
            (&Value::Null, &Value::Null)
        );
        let (_, said, _) = run(&["compare", &a, other]);
        assert!(said.contains(words) && !said.contains("by chance") && !said.contains(" ± "), "{said}");
    }
    // A history counts it once.
    let found = json_of(&["history", &folder.path().to_string_lossy(), "--json"]);
    assert_eq!(found["calibrations"].as_array().map(Vec::len), Some(1), "{found}");
    assert_eq!(found["left_out"].as_array().map(Vec::len), Some(2), "{found}");
    // A session and its own result.
    let sample = "sample_sessions/clean-sweeps.json";
    let (_, result, _) = run(&["solve", sample, "--json"]);
    let result = write(folder.path(), "result.json", &result);
    assert_eq!(json_of(&["compare", sample, &result, "--json"])["shared"], "data");
}

#[test]
fn a_matrix_states_no_uncertainty_and_one_that_is_no_rotation_is_named() {
    let folder = tempfile::tempdir().expect("a folder");
    let a = write(folder.path(), "a.json", &result(AT, Vec3::zeros(), None).to_string());
    let skew = write(folder.path(), "skew.txt", "1 0.02 0 10\n0 1 0 20\n0 0 1 130\n0 0 0 1\n");
    let found = json_of(&["compare", &a, &skew, "--json"]);
    assert_eq!(found["to"]["is_nearest_rotation"], true);
    assert_eq!((&found["difference"]["p_value"], &found["difference"]["std_of"]), (&Value::Null, &json!("none")));
    let (_, said, _) = run(&["compare", &a, &skew]);
    assert!(said.contains("no rotation") && said.contains("not known"), "{said}");
    for (name, text) in [
        ("flat.txt", "0 0 0 1\n0 0 0 1\n0 0 0 1\n0 0 0 1\n"),
        ("nan.txt", "1 0 0 nan\n0 1 0 20\n0 0 1 130\n0 0 0 1\n"),
        ("far.txt", "1 0 0 1e9\n0 1 0 20\n0 0 1 130\n0 0 0 1\n"),
        ("broken.json", "{\"format\": \"handeye-result\""),
        ("empty.json", ""),
        ("other.json", "{\"format\": \"of-tomorrow\"}"),
        ("failed.json", "{\"format\": \"handeye-result\", \"methods\": [{\"method\": \"x\", \"status\": \"failed\"}]}"),
    ] {
        let path = write(folder.path(), name, text);
        let (status, _, error) = run(&["compare", &a, &path]);
        assert!(status == 2 && error.lines().count() == 1 && error.contains(name), "{name}: {status} {error}");
    }
    let mut broken = result(AT, TURN, Some([STD_RAD, STD_MM]));
    broken["methods"][0]["uncertainty"]["covariance"][2][2] = json!(-1.0);
    let broken = write(folder.path(), "covariance.json", &broken.to_string());
    let (status, _, error) = run(&["compare", &a, &broken]);
    assert!(status == 2 && error.contains("covariance") && error.contains("6 × 6"), "{error}");
    let (status, _, error) = run(&["compare", &a, &a, "--at", "1,2"]);
    assert!(status == 2 && error.contains("three numbers"), "{error}");
    let mut fixed = result(AT, TURN, None);
    let calibration = fixed["methods"][0]["flange_from_sensor"].take();
    fixed["methods"][0].as_object_mut().expect("an object").remove("flange_from_sensor");
    fixed["methods"][0]["base_from_sensor"] = calibration;
    let fixed = write(folder.path(), "fixed.json", &fixed.to_string());
    let (status, _, error) = run(&["compare", &a, &fixed]);
    assert!(status == 2 && error.contains("mounted alike"), "{error}");
    // Nor is it judged on the data of a sensor on the flange.
    let out = folder.path().join("report").to_string_lossy().into_owned();
    for command in [
        &["verify", "sample_sessions/plate.json"][..],
        &["report", "sample_sessions/plate.json", "--out", &out],
        &["scan", "sample_sessions/workpiece.json"],
    ] {
        let (status, said, error) = run(&[command, &["--calibration", &fixed]].concat());
        let is_told = error.contains("fixed.json") && error.contains("beside the robot") && error.lines().count() == 1;
        assert!(status == 2 && is_told && said.is_empty(), "{command:?}: {status} {error}");
    }
    assert!(!Path::new(&out).exists());
}

#[test]
fn the_answer_of_a_further_target_is_compared_and_stands_in_the_report_s_result_file() {
    let folder = tempfile::tempdir().expect("a folder");
    let sample = |name: &str| -> Value {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("sample_sessions").join(name);
        serde_json::from_str(&fs::read_to_string(path).expect("a sample")).expect("JSON")
    };
    // Scanned parts, of which no calibration is computed, and a plate.
    let mut session = sample("workpiece.json");
    session["further"] = json!([sample("three-targets.json")["further"][0]]);
    let session = &write(folder.path(), "session.json", &session.to_string());
    let (status, _, error) =
        run(&["report", session, "--out", &folder.path().to_string_lossy(), "--section", "verdict"]);
    assert_eq!(status, 0, "{error}");
    let in_report = folder.path().join("result.json").to_string_lossy().into_owned();
    let found = json_of(&["compare", session, &in_report, "--json"]);
    assert!(vector(&found["difference"]["translation_mm"]).norm() < 1e-9, "{found}");
    assert!(found["difference"]["angle_deg"].as_f64().expect("an angle") < 1e-6, "{found}");
}

#[test]
fn a_session_is_solved_and_compared_with_its_truth() {
    let sample = "sample_sessions/clean-sweeps.json";
    let session: Value = serde_json::from_slice(&fs::read(sample).expect("readable")).expect("JSON");
    let truth = &session["truth"]["flange_from_sensor"];
    let [w, x, y, z] = [0, 1, 2, 3].map(|idx| truth["quaternion_wxyz"][idx].as_f64().expect("a number"));
    let turn = nalgebra::UnitQuaternion::new_normalize(nalgebra::Quaternion::new(w, x, y, z));
    let folder = tempfile::tempdir().expect("a folder");
    let truth = result(vector(&truth["translation_mm"]), so3::log(&turn), None);
    let truth = write(folder.path(), "truth.json", &truth.to_string());
    let found = json_of(&["compare", &truth, sample, "--json"]);
    assert_eq!(
        (&found["difference"]["std_of"], &found["difference"]["is_significant"]),
        (&json!("one"), &json!(false))
    );
    assert!(found["reference_point"]["size_mm"].as_f64().expect("a size") < 0.05);
}

/// Calibrations a week apart that drift along x, and by `jump_mm` along z from the ninth on.
fn write_history(folder: &Path, name: impl Fn(u32) -> String, jump_mm: f64) {
    let mut random = SplitMix::new(3);
    // The sum of twelve uniform values is normal enough.
    #[expect(clippy::cast_precision_loss, reason = "below a thousand")]
    let mut noise = |std: f64| std * ((0..12).map(|_| random.below(1000) as f64 / 1000.0).sum::<f64>() - 6.0);
    for week in 0..14 {
        let drifted = Vec3::new(0.002 * f64::from(week) * 7.0, 0.0, if week >= 8 { jump_mm } else { 0.0 });
        let errors = Vec3::new(noise(STD_MM), noise(STD_MM), noise(STD_MM));
        let turn = TURN + Vec3::new(noise(STD_RAD), noise(STD_RAD), noise(STD_RAD));
        let file = result(AT + drifted + errors, turn, Some([STD_RAD, STD_MM]));
        write(folder, &name(week), &file.to_string());
    }
}

#[test]
fn a_folder_over_months_shows_its_drift_and_its_jump() {
    let folder = tempfile::tempdir().expect("a folder");
    write_history(folder.path(), |week| format!("cell_2026-{:02}-{:02}.json", 1 + week / 4, 1 + 7 * (week % 4)), 0.4);
    write(folder.path(), "broken.json", "{");
    write(folder.path(), "notes.md", "not looked at");
    let path = folder.path().to_string_lossy().into_owned();
    let found = json_of(&["history", &path, "--json"]);
    assert_eq!(found["order"], "dates");
    let calibrations = found["calibrations"].as_array().expect("a list");
    assert_eq!(calibrations.len(), 14);
    let jumps: Vec<usize> = (0..14).filter(|idx| calibrations[*idx]["is_jump"] == true).collect();
    assert_eq!(jumps, [8]);
    assert_eq!(calibrations[8]["date"], "2026-03-01");
    let trend = &found["trends"][0];
    let [slope, std] = ["slope", "std"].map(|name| trend[name].as_f64().expect("a number"));
    // The months are not all of 28 days, so that the slope is a little less than 2 µm a day.
    assert!(trend["is_significant"] == true && (slope - 0.002).abs() < 4.0 * std + 0.0003, "{trend}");
    assert!(
        found["trends"].as_array().expect("six")[1..].iter().all(|trend| trend["is_significant"] == false),
        "{found}"
    );
    // The point moves as the sensor does where nothing turns.
    let of_point = found["point_trends"].as_array().expect("three");
    let verdicts: Vec<&Value> = of_point.iter().map(|trend| &trend["is_significant"]).collect();
    assert_eq!((verdicts, &found["course"]), (vec![&json!(true), &json!(false), &json!(false)], &json!("moved")));
    assert_eq!(found["left_out"].as_array().map(Vec::len), Some(1));
    let (status, said, _) = run(&["history", &path]);
    assert!(status == 0 && said.contains("jump: cell_2026-03-01.json") && said.contains("drifts"), "{said}");
    assert!(said.contains("The calibration jumped once and drifts: point x +0.0"), "{said}");
    assert!(said.contains("left out:") && said.contains("broken.json"), "{said}");
    let (status, table, error) = run(&["history", &path, "--csv"]);
    assert!(error.contains("broken.json") && error.lines().count() == 1, "{error}");
    assert!(status == 0 && table.lines().count() == 15 && table.lines().all(|line| line.matches(',').count() == 11));
}

#[test]
fn without_dates_the_order_is_that_of_the_names_and_a_date_in_the_file_counts_before_that_in_its_name() {
    let folder = tempfile::tempdir().expect("a folder");
    write_history(folder.path(), |week| format!("run-{}.json", week + 1), 0.0);
    let path = folder.path().to_string_lossy().into_owned();
    let found = json_of(&["history", &path, "--json"]);
    assert_eq!(
        (&found["order"], &found["calibrations"][1]["name"]),
        (&json!("names"), &json!("run-2.json: ball-bundle"))
    );
    let (_, said, _) = run(&["history", &path]);
    assert!(said.contains("not all have a date") && said.contains("no jumps"), "{said}");
    let folder = tempfile::tempdir().expect("a folder");
    for (name, date) in [("a_2026-01-01.json", "2027-05-01"), ("b_2026-02-01.json", "2026-05-01T10:00:00Z")] {
        let mut file = result(AT, TURN, None);
        file["date"] = json!(date);
        write(folder.path(), name, &file.to_string());
    }
    let found = json_of(&["history", &folder.path().to_string_lossy(), "--json"]);
    assert_eq!(found["calibrations"][0]["date"], "2026-05-01");
}

#[test]
fn folders_with_one_none_or_no_calibration_are_told_apart() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().to_string_lossy().into_owned();
    let (status, _, error) = run(&["history", &path]);
    assert!(status == 2 && error.contains("found no calibration") && error.lines().count() == 1, "{error}");
    write(folder.path(), "broken.json", "[1, 2");
    let (status, _, error) = run(&["history", &path]);
    assert!(status == 2 && error.contains("broken.json") && error.lines().count() == 1, "{error}");
    let missing = format!("{path}/missing");
    let (status, _, error) = run(&["history", &missing]);
    assert!(status == 2 && error.contains("missing") && error.lines().count() == 1, "{error}");
    write(folder.path(), "one.json", &result(AT, TURN, None).to_string());
    let (status, said, _) = run(&["history", &path]);
    assert!(status == 0 && said.contains("1 calibration ") && said.contains("found 1, needed 4"), "{said}");
}
