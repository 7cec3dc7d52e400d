//! `handeye scan` as a shell sees it: figures against what was simulated, and files that are wrong.
#![expect(clippy::expect_used, reason = "a test that finds nothing to check must fail")]

mod shell;

use std::fs;
use std::process::Output;

use handeye::scene::{CYLINDER_DIAMETER_MM, PITCH_MM, PartKind, TOOTH_HEIGHT_MM};
use handeye::session::Session;
use handeye::simulate::{SimulationOptions, SimulationTarget, simulate};
use serde_json::{Value, json};
use shell::{Files, assert_refused, handeye};

/// Estimates and truth differ by more than this many σ once in some ten thousand times.
const WITHIN_STD: f64 = 4.0;

fn scan(args: &[&str]) -> Output {
    handeye("scan", args)
}

fn simulated(kind: PartKind, seed: u64) -> Session {
    // Half as many profiles as usual: enough for σ, and quick.
    let step_mm = 0.66;
    let usual = SimulationOptions::of(SimulationTarget::Part(kind));
    let num_steps = SimulationOptions::steps_to_scan(kind, step_mm);
    simulate(&SimulationOptions { seed, num_points: 300, step_mm, num_steps, ..usual })
}

/// The truth of a session, as another program would write it: sixteen numbers.
fn truth(files: &Files, session: &Session) -> String {
    let matrix = session.truth.as_ref().expect("simulated").flange_from_sensor.matrix();
    let rows: Vec<String> =
        matrix.row_iter().map(|row| row.iter().map(f64::to_string).collect::<Vec<_>>().join(" ")).collect();
    files.text("truth.txt", &rows.join("\n"))
}

fn measured(args: &[&str]) -> Value {
    let output = scan(args);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("JSON")
}

#[track_caller]
fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("a number in place of {value}"))
}

#[track_caller]
fn is_within_std(found: f64, truth: f64, std: f64, most_std: f64) {
    assert!(std > 0.0 && std < most_std, "σ {std}");
    assert!((found - truth).abs() < WITHIN_STD * std, "{found} ± {std} for {truth}");
}

#[test]
fn the_faces_of_a_square_block_stand_at_a_right_angle() {
    let files = Files::new();
    for seed in 1..=3 {
        let session = simulated(PartKind::Square, seed);
        let file =
            measured(&[&files.session("part.json", &session), "--calibration", &truth(&files, &session), "--json"]);
        assert_eq!((&file["format"], &file["version"]), (&"handeye-scan".into(), &1.into()));
        assert_eq!((&file["scan"], &file["calibration"]), (&"all scans".into(), &"truth.txt".into()));
        let planes = file["planes"].as_array().expect("a list");
        assert!(planes.len() >= 2 && planes.iter().all(|plane| plane["status"] == "ok"), "{planes:#?}");
        for plane in &planes[..2] {
            assert_eq!(plane["distances_mm"]["drawn"], 400);
            let [mean, std, max, rms] = ["mean", "std", "max", "rms"].map(|name| number(&plane["distances_mm"][name]));
            assert!(0.0 < mean && mean < rms && std < rms && rms < max && max < 0.3, "{plane:#}");
            let coefficients = plane["equation"]["coefficients"].as_array().expect("three");
            let leading = coefficients.iter().map(number).fold(0.0, f64::max);
            assert!((leading - 1.0).abs() < 1e-12, "the paper's form: {coefficients:?}");
        }
        // The two faces are the largest planes.
        let angle = &file["angles"][0];
        assert_eq!((&angle["planes"], &angle["nominal_deg"]), (&json!(["A", "B"]), &json!(90.0)));
        is_within_std(number(&angle["angle_deg"]), 90.0, number(&angle["std_deg"]), 0.02);
    }
}

#[test]
fn pitch_height_and_diameter_are_those_of_the_simulated_parts() {
    let files = Files::new();
    for seed in 1..=3 {
        let session = simulated(PartKind::Teeth, seed);
        let file =
            measured(&[&files.session("part.json", &session), "--calibration", &truth(&files, &session), "--json"]);
        let teeth = &file["teeth"];
        assert_eq!(teeth["teeth"].as_array().map(Vec::len), Some(5), "{teeth:#}");
        for (name, nominal) in [("pitch_mm", PITCH_MM), ("height_mm", TOOTH_HEIGHT_MM)] {
            for tooth in teeth["teeth"].as_array().expect("a list").iter().filter(|tooth| !tooth[name].is_null()) {
                is_within_std(number(&tooth[name]["value"]), nominal, number(&tooth[name]["std"]), 0.1);
            }
            let summary = &teeth[name];
            assert_eq!(summary["nominal"], nominal);
            let [mean, max] = ["mean_error", "max_error"].map(|figure| number(&summary[figure]));
            assert!(mean <= max && max < 0.06, "{name}: {summary:#}");
        }
        let session = simulated(PartKind::Cylinder, seed);
        let file =
            measured(&[&files.session("part.json", &session), "--calibration", &truth(&files, &session), "--json"]);
        let round = &file["round"];
        assert_eq!((&round["kind"], &round["nominal_mm"]), (&"cylinder".into(), &CYLINDER_DIAMETER_MM.into()));
        is_within_std(number(&round["diameter_mm"]), CYLINDER_DIAMETER_MM, number(&round["diameter_std_mm"]), 0.05);
    }
}

#[test]
fn a_wrong_calibration_shows_and_a_result_file_serves() {
    let files = Files::new();
    let part = simulated(PartKind::Square, 4);
    let part_path = files.session("part.json", &part);
    let plate = simulate(&SimulationOptions {
        seed: 4,
        has_points: true,
        ..SimulationOptions::of(SimulationTarget::Part(PartKind::Plate))
    });
    let plate_path = files.session("plate.json", &plate);
    let solve = handeye("solve", &[&plate_path, "--json"]);
    let result = files.text("result.json", std::str::from_utf8(&solve.stdout).expect("UTF-8"));
    let file = measured(&[&part_path, "--calibration", &result, "--json"]);
    assert_eq!(file["calibration"], "result.json: plate-bundle");
    assert!((number(&file["angles"][0]["angle_deg"]) - 90.0).abs() < 0.1, "{file:#}");
    // The sensor 2° off: the two scans no longer lie on one another.
    let off = nalgebra::UnitQuaternion::from_euler_angles(0.035, 0.0, 0.0);
    let mut turned = part;
    if let Some(truth) = &mut turned.truth {
        let true_one = truth.flange_from_sensor;
        truth.flange_from_sensor =
            handeye::geometry::Transform::from_parts(true_one.translation_mm(), true_one.rotation() * off);
    }
    let off = measured(&[&part_path, "--calibration", &truth(&files, &turned), "--json"]);
    let rms = |file: &Value| number(&file["planes"][0]["distances_mm"]["rms"]);
    assert!(rms(&off) > 3.0 * rms(&file), "{} {}", rms(&off), rms(&file));
}

#[test]
fn exported_points_are_measured_like_the_session() {
    let files = Files::new();
    let session = simulated(PartKind::Square, 5);
    let (path, truth) = (files.session("part.json", &session), truth(&files, &session));
    for name in ["part.ply", "part.csv"] {
        let out = files.path(name);
        let from_session = measured(&[&path, "--calibration", &truth, "--out", &out, "--json"]);
        let from_points = measured(&[&out, "--json"]);
        assert_eq!(from_session["points"], from_points["points"]);
        let angle = |file: &Value| number(&file["angles"][0]["angle_deg"]);
        assert!((angle(&from_session) - angle(&from_points)).abs() < 1e-3);
        assert_eq!(from_points["calibration"], Value::Null);
    }
}

#[track_caller]
fn refused(args: &[&str], status: i32, fragments: &[&str]) {
    assert_refused(&scan(args), status, fragments);
}

#[test]
fn broken_calibrations_are_refused_with_place_found_and_expected() {
    let files = Files::new();
    let part = files.session("part.json", &simulated(PartKind::Square, 6));
    let result = |methods: &str| format!(r#"{{"format": "handeye-result", "version": 1, "methods": {methods}}}"#);
    let ok = |calibration: &str| result(&format!(r#"[{{"method": "ball-bundle", "status": "ok", {calibration}}}]"#));
    let cases: [(&str, String, &[&str]); 8] = [
        ("other.json", r#"{"format": "handeye-session"}"#.to_owned(), &["format", "handeye-session", "solve --json"]),
        ("nothing.json", "{}".to_owned(), &["format", "found nothing"]),
        ("cut.json", r#"{"format": "handeye-res"#.to_owned(), &["broken JSON", "line 1"]),
        ("failed.json", result(r#"[{"method": "ball-bundle", "status": "failed"}]"#), &["methods", "with a result"]),
        ("none.json", ok(r#""rms_mm": 1"#), &["flange_from_sensor", "found nothing", "4 × 4 matrix"]),
        ("short.json", ok(r#""flange_from_sensor": {"matrix": [[1, 0, 0], [0, 1, 0]]}"#), &["flange_from_sensor"]),
        ("words.txt", "1 0 0 x".to_owned(), &["\"x\"", "number 4"]),
        ("flat.txt", "1 0 0 5  0 0 0 6  0 0 0 7".to_owned(), &["no rotation", "0.000", "mend the misprint"]),
    ];
    for (name, text, fragments) in cases {
        let path = files.text(name, &text);
        let mut wanted = vec![name];
        wanted.extend(fragments);
        refused(&[&part, "--calibration", &path], 2, &wanted);
    }
    refused(&[&part, "--calibration", &files.path("missing.json")], 2, &["cannot read", "missing.json"]);
    fs::write(files.path("bytes.txt"), [0xff, 0xfe, 0x00]).expect("written");
    refused(&[&part, "--calibration", &files.path("bytes.txt")], 2, &["bytes.txt", "no text", "result file"]);
}

#[test]
fn what_cannot_be_scanned_is_refused_with_a_way_out() {
    let files = Files::new();
    let session = simulated(PartKind::Square, 7);
    let part = files.session("part.json", &session);
    refused(&[&part], 3, &["no calibration", "--calibration RESULT.json"]);
    let truth = truth(&files, &session);
    refused(&[&part, "--calibration", &truth, "--scan", "lid"], 2, &["--scan", "lid", "all scans, scan 1, scan 2"]);
    refused(&[&part, "--calibration", &truth, "--out", &files.path("part.obj")], 2, &[".obj", "expected .ply or .csv"]);
    let ball = simulate(&SimulationOptions { num_stations: 4, num_steps: 1, ..SimulationOptions::default() });
    let ball = files.session("ball.json", &ball);
    refused(&[&ball], 2, &["holds no scan", "--target workpiece"]);
    refused(&[&files.text("cloud.csv", "x,y,z\n1,2,3\n1,2,many\n")], 2, &["cloud.csv", "line 3", "many"]);
    let header =
        "ply\nformat ascii 1.0\nelement vertex 9\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
    refused(&[&files.text("cloud.ply", &format!("{header}1 2 3\n"))], 2, &["cloud.ply", "line"]);
}

#[test]
fn of_a_matrix_that_is_no_rotation_the_nearest_is_taken_and_named_so() {
    let files = Files::new();
    let session = simulated(PartKind::Square, 8);
    let part = files.session("part.json", &session);
    let skewed = fs::read_to_string(truth(&files, &session)).expect("written");
    // The first element with three decimals fewer than the others.
    let (first, others) = skewed.split_once(' ').expect("sixteen numbers");
    let first: f64 = first.parse().expect("a number");
    let path = files.text("skewed.txt", &format!("{} {others}", first + 0.02));
    let text = String::from_utf8(scan(&[&part, "--calibration", &path]).stdout).expect("UTF-8");
    for fragment in ["skewed.txt: Not a rotation", "RᵀR", "calibration: skewed.txt (nearest rotation)"] {
        assert!(text.contains(fragment), "{fragment:?} is not in\n{text}");
    }
    let file = measured(&[&part, "--calibration", &path, "--json"]);
    assert_eq!(file["calibration"], "skewed.txt (nearest rotation)");
}

#[test]
fn a_box_without_points_is_refused_and_one_with_few_profiles_is_doubted() {
    let files = Files::new();
    let session = simulated(PartKind::Square, 9);
    let (part, truth) = (files.session("part.json", &session), truth(&files, &session));
    let plane = |numbers: [f64; 6]| {
        let mut args = vec![part.clone(), "--calibration".to_owned(), truth.clone(), "--plane".to_owned()];
        args.extend(numbers.map(|number| number.to_string()));
        args
    };
    let far = plane([9e3, 0.0, 0.0, 9.1e3, 1.0, 1.0]);
    refused(&far.iter().map(String::as_str).collect::<Vec<_>>(), 3, &["--plane", "9000", "points are between"]);
    // About the largest plane's midst, across the path no wider than a few profiles.
    let found = measured(&[&part, "--calibration", &truth, "--scan", "scan 1", "--json"]);
    let plane_of = |file: &Value| file["planes"][0].clone();
    assert!(number(&plane_of(&found)["profiles"]) > 6.0);
    assert_eq!(plane_of(&found)["is_std_from_profiles"], true);
    let middle: Vec<f64> = plane_of(&found)["centroid_mm"].as_array().expect("three").iter().map(number).collect();
    // A box that is narrow along each axis in turn: along the path few profiles are left in it.
    let is_doubted = (0..3).any(|narrow| {
        let half = |axis: usize| if axis == narrow { 0.9 } else { 30.0 };
        let corner = |sign: f64| std::array::from_fn::<f64, 3, _>(|axis| middle[axis] + sign * half(axis));
        let ([a, b, c], [d, e, f]) = (corner(-1.0), corner(1.0));
        let mut args = plane([a, b, c, d, e, f]);
        args.extend(["--scan".to_owned(), "scan 1".to_owned()]);
        let output = scan(&args.iter().map(String::as_str).collect::<Vec<_>>());
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        text.contains("σ is optimistic") && text.contains("known to ± > ")
    });
    assert!(is_doubted);
}

#[test]
fn no_planes_are_found_on_a_certified_cylinder() {
    let files = Files::new();
    for seed in 1..=3 {
        let session = simulated(PartKind::Cylinder, seed);
        let (part, truth) = (files.session("part.json", &session), truth(&files, &session));
        let file = measured(&[&part, "--calibration", &truth, "--json"]);
        assert_eq!(file["round"]["status"], "ok");
        // What it lies on is seen beside it, and is a plane; of the cylinder's own sides there is none.
        assert!(file["planes"].as_array().is_some_and(|planes| planes.len() <= 1), "{:#}", file["planes"]);
    }
}
