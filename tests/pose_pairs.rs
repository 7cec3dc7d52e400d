//! Pairs of poses from other programs: made from a simulated truth, imported, solved, and equal to the truth again.
#![expect(clippy::expect_used, reason = "a test that finds nothing to check must fail")]

use std::fmt::Write as _;
use std::path::Path;
use std::process::Command;

use handeye::calibrate::{Method, Mount, Solution};
use handeye::geometry::{Frame, PoseConvention, Transform};
use handeye::session::export::{TableStyle, poses_csv};
use handeye::session::{self, Reading, Session, measure, problem};
use handeye::simulate::poses::{PoseOptions, simulate_poses};
use handeye::watch::Unwatched;

/// What is left of exact poses that were written with twelve decimals and solved.
const ROUNDING_MM: f64 = 1e-6;
/// The same of an angle.
const ROUNDING_RAD: f64 = 1e-9;

/// Exact poses, of which nothing is stated.
fn truth(mount: Mount) -> Session {
    simulate_poses(&PoseOptions {
        seed: 11,
        num_stations: 12,
        position_std_mm: 0.0,
        orientation_std_deg: 0.0,
        target_std_mm: 0.0,
        target_std_deg: 0.0,
        mount,
        ..PoseOptions::default()
    })
}

/// Translation in mm and the quaternion, real part first: of the flange, and of the target.
type Numbers = [[f64; 7]; 2];

fn pairs(session: &Session) -> Vec<Numbers> {
    let captures = session.stations.iter().flat_map(|station| &station.captures);
    let pair = |capture: &session::Capture| {
        let Reading::Pose(sensor_from_target) = &capture.reading else { panic!("a board") };
        [numbers(&capture.base_from_flange), numbers(sensor_from_target)]
    };
    captures.map(pair).collect()
}

fn numbers<Dst: Frame, Src: Frame>(pose: &Transform<Dst, Src>) -> [f64; 7] {
    let at = pose.translation_mm();
    let [w, x, y, z] = pose.quaternion_wxyz();
    [at.x, at.y, at.z, w, x, y, z]
}

fn joined(cells: &[f64]) -> String {
    cells.iter().map(|cell| format!("{cell:.12}")).collect::<Vec<_>>().join(",")
}

/// Columns that say what they are, in millimetres.
fn named(session: &Session) -> String {
    let head = "x_mm,y_mm,z_mm,qw,qx,qy,qz,target_x_mm,target_y_mm,target_z_mm,target_qw,target_qx,target_qy,target_qz";
    let rows = pairs(session).into_iter().map(|pair| joined(&pair.concat()));
    std::iter::once(head.to_owned()).chain(rows).collect::<Vec<_>>().join("\n")
}

/// What a robot's display says beside what a marker library says: angles in degrees, metres, the real part last.
fn mixed(session: &Session) -> String {
    let convention = PoseConvention::by_id("fanuc-wpr").expect("known");
    let mut text = "no,X [mm],Y [mm],Z [mm],W [deg],P [deg],R [deg],\
        marker_x [m],marker_y,marker_z,marker_qx,marker_qy,marker_qz,marker_qw\n"
        .to_owned();
    for (station, pair) in session.stations.iter().zip(pairs(session)) {
        let angles = convention.angles_deg_from_rotation(&station.captures[0].base_from_flange.rotation());
        let [[x, y, z, ..], [u, v, w, qw, qx, qy, qz]] = pair;
        let cells = [&[x, y, z], &angles, &[u, v, w].map(|mm| mm / 1000.0), &[qx, qy, qz, qw][..]].concat();
        writeln!(text, "{},{}", station.label, joined(&cells)).expect("to a string");
    }
    text
}

/// Fourteen numbers a row, in metres, and nothing else.
fn bare(session: &Session) -> String {
    let in_metres = |[x, y, z, rest @ ..]: [f64; 7]| [&[x, y, z].map(|mm| mm / 1000.0)[..], &rest].concat();
    let rows = pairs(session).into_iter().map(|pair| joined(&pair.map(in_metres).concat()));
    rows.collect::<Vec<_>>().join("\n")
}

/// Pairs of matrices in metres, as `moveit_calibration` saves its samples.
fn matrices(session: &Session) -> String {
    fn rows<Dst: Frame, Src: Frame>(pose: &Transform<Dst, Src>) -> [[f64; 4]; 4] {
        let (rotation, at) = (pose.rotation().to_rotation_matrix(), pose.translation_mm() / 1000.0);
        let row = |row: usize| [rotation[(row, 0)], rotation[(row, 1)], rotation[(row, 2)], at[row]];
        [row(0), row(1), row(2), [0.0, 0.0, 0.0, 1.0]]
    }
    let captures = session.stations.iter().flat_map(|station| &station.captures);
    let pair = |capture: &session::Capture| {
        let Reading::Pose(sensor_from_target) = &capture.reading else { panic!("a board") };
        [rows(&capture.base_from_flange), rows(sensor_from_target)]
    };
    serde_json::to_string(&captures.map(pair).collect::<Vec<_>>()).expect("JSON")
}

/// What `handeye export` writes.
fn exported(session: &Session) -> String {
    poses_csv(session, &session.robot.notation, TableStyle::default())
}

#[track_caller]
fn import(text: &str, name: &str, mount: Mount) -> Session {
    let folder = tempfile::tempdir().expect("a folder");
    let (pairs, out) = (folder.path().join(name), folder.path().join("session.json"));
    std::fs::write(&pairs, text).expect("written");
    let mut command = Command::new(env!("CARGO_BIN_EXE_handeye"));
    command.arg("import").arg(&pairs).arg("--out").arg(&out);
    if mount == Mount::Fixed {
        command.arg("--fixed");
    }
    let output = command.output().expect("the binary starts");
    assert!(output.status.success(), "{name}: {}", String::from_utf8_lossy(&output.stderr));
    session::load(Path::new(&out)).expect("a session")
}

#[track_caller]
fn solved(session: &Session) -> Solution {
    let measured = measure(session, None, &mut Unwatched).expect("not cancelled");
    problem(session, &measured).expect("something to solve").solve(Method::Motion).expect("a calibration")
}

#[test]
fn pairs_in_every_form_give_the_truth_again() {
    for mount in [Mount::OnFlange, Mount::Fixed] {
        let expected = truth(mount);
        let known = expected.truth.as_ref().expect("simulated");
        let forms = [
            (named(&expected), "named.csv"),
            (mixed(&expected), "mixed.csv"),
            (bare(&expected), "bare.csv"),
            (matrices(&expected), "samples.json"),
            (matrices(&expected), "samples.yaml"),
            (exported(&expected), "exported.csv"),
        ];
        for (text, name) in forms {
            let session = import(&text, name, mount);
            assert!(session.target.is_pose(), "{name}: {:?}", session.target);
            assert_eq!((session.stations.len(), session.mount), (12, mount), "{name}");
            let found = solved(&session);
            let [found_in, known_in] = [&found.flange_from_sensor, &known.flange_from_sensor];
            let apart_mm = (found_in.translation_mm() - known_in.translation_mm()).norm();
            let apart_rad = found_in.rotation().angle_to(&known_in.rotation());
            assert!(apart_mm < ROUNDING_MM && apart_rad < ROUNDING_RAD, "{name} {mount:?}: {apart_mm} {apart_rad}");
            let target_mm = (found.target_in_base_mm - known.target_in_base_mm).norm();
            assert!(target_mm < ROUNDING_MM, "{name} {mount:?}: {target_mm}");
            assert!(found.warnings.is_empty(), "{name} {mount:?}: {:?}", found.warnings);
        }
    }
}

#[test]
fn a_row_that_is_no_pair_is_named_with_its_place() {
    let text = named(&truth(Mount::OnFlange));
    let mut lines: Vec<&str> = text.lines().collect();
    let short = lines[3].rsplit_once(',').expect("columns").0.to_owned() + ",nothing";
    lines[3] = &short;
    let folder = tempfile::tempdir().expect("a folder");
    let pairs = folder.path().join("pairs.csv");
    std::fs::write(&pairs, lines.join("\n")).expect("written");
    let output = Command::new(env!("CARGO_BIN_EXE_handeye"))
        .arg("import")
        .arg(&pairs)
        .arg("--out")
        .arg(folder.path().join("session.json"))
        .output()
        .expect("the binary starts");
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("line 4") && said.contains("found nothing"), "{said}");
}
