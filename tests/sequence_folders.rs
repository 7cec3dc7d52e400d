//! Folders with a sequence: whole ones, and everything that can be wrong with them.
#![expect(clippy::expect_used, reason = "a test that cannot set itself up must fail")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::LazyLock;

use handeye::odometry::OdometryOptions;
use handeye::session::sequence::{Sequence, SequenceRun};
use handeye::simulate::room::{Carrier, RoomOptions, RoomRecording, kinect, write_folder};
use handeye::watch::Unwatched;
use serde_json::Value;
use tempfile::TempDir;

const NUM_FRAMES: usize = 5;

/// A short walk by hand, rendered once.
static WHOLE: LazyLock<TempDir> = LazyLock::new(|| {
    let folder = tempfile::tempdir().expect("a folder");
    let options = RoomOptions {
        num_frames: NUM_FRAMES,
        camera: kinect(160, 120),
        carrier: Carrier::Hand,
        ..RoomOptions::default()
    };
    write_folder(RoomRecording::new(options), &folder.path().join("walk"), &mut Unwatched).expect("written");
    folder
});

/// A copy to be damaged.
fn copy() -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().expect("a folder");
    let (from, to) = (WHOLE.path().join("walk"), folder.path().join("walk"));
    for part in ["", "rgb", "depth"] {
        fs::create_dir_all(to.join(part)).expect("made");
        for entry in fs::read_dir(from.join(part)).expect("readable").flatten() {
            if entry.path().is_file() {
                fs::copy(entry.path(), to.join(part).join(entry.file_name())).expect("copied");
            }
        }
    }
    (folder, to)
}

fn edit(path: &Path, change: impl Fn(String) -> String) {
    let text = fs::read_to_string(path).expect("readable");
    fs::write(path, change(text)).expect("written");
}

fn odometry(arguments: &[&Path]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_handeye")).arg("odometry").args(arguments).output().expect("run")
}

#[test]
fn the_command_prints_and_writes_what_it_found() {
    let (folder, walk) = copy();
    let out = folder.path().join("out");
    let run = odometry(&[&walk, Path::new("--json"), Path::new("--out"), &out]);
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let file: Value = serde_json::from_slice(&run.stdout).expect("JSON");
    assert_eq!((file["format"].as_str(), file["version"].as_u64()), (Some("handeye-odometry"), Some(1)));
    assert_eq!((file["frames"].as_u64(), file["tracked"].as_u64()), (Some(5), Some(5)));
    for field in ["distance_m", "heading_deg", "ate_rmse_m", "rpe_trans_rmse_m", "rpe_rot_rmse_deg", "ms_per_frame"] {
        assert!(file[field].is_f64(), "{field}: {}", file[field]);
    }
    // Pictures of 160 × 120 pixels; seen: 0.6 mm.
    assert!(file["rpe_trans_rmse_m"].as_f64().is_some_and(|error| error < 0.003), "{}", file["rpe_trans_rmse_m"]);
    let rows = file["trajectory"].as_array().expect("a list");
    assert!(rows.len() == 5 && rows.iter().all(|row| row.as_array().is_some_and(|row| row.len() == 8)));
    let lines = |name: &str| fs::read_to_string(out.join(name)).expect("written").lines().count();
    assert_eq!((lines("trajectory.txt"), lines("frames.csv")), (5, 6));
    assert_eq!(fs::read(out.join("odometry.json")).expect("written"), run.stdout);
    let published = odometry(&[&walk, Path::new("--published"), Path::new("--every"), Path::new("0.06")]);
    let text = String::from_utf8_lossy(&published.stdout);
    assert!(text.contains("as published") && text.contains("left out by the period"), "{text}");
}

#[test]
fn a_session_that_names_the_folder_will_do() {
    let (folder, _) = copy();
    let session = folder.path().join("session.json");
    let text = r#"{"format": "handeye-session", "version": 1, "target": {"kind": "rgbd"}, "sequence": "walk"}"#;
    fs::write(&session, text).expect("written");
    let run = odometry(&[&session]);
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    fs::write(&session, text.replace("rgbd", "point").replace(r#", "sequence": "walk""#, r#", "stations": []"#))
        .expect("written");
    let run = odometry(&[&session]);
    let said = String::from_utf8_lossy(&run.stderr);
    assert!(run.status.code() == Some(2) && said.contains("rgbd"), "{said}");
}

/// What is done to a folder, and what is said of it.
type Damage = (&'static str, fn(&Path), &'static [&'static str]);

#[test]
fn folders_without_a_frame_are_refused_by_name() {
    const DAMAGES: [Damage; 9] = [
        ("no camera", |walk| fs::remove_file(walk.join("camera.json")).expect("removed"), &["camera.json", "focal"]),
        ("no JSON", |walk| fs::write(walk.join("camera.json"), "{").expect("written"), &["camera.json", "no JSON"]),
        (
            "huge",
            |walk| edit(&walk.join("camera.json"), |text| text.replacen("160", "4000000000", 1)),
            &["camera.json", "color.width", "4000000000"],
        ),
        (
            "large",
            |walk| edit(&walk.join("camera.json"), |text| text.replacen("160", "160000", 1)),
            &["camera.json: color", "160000 × 120 pixels", "8192"],
        ),
        (
            "no scale",
            |walk| edit(&walk.join("camera.json"), |text| text.replace("\"depth_scale\": 5000", "\"depth_scale\": -1")),
            &["camera.json", "depth_scale", "-1"],
        ),
        (
            "turned too much",
            |walk| {
                edit(&walk.join("camera.json"), |text| {
                    text.replace("\"quaternion_wxyz\": [", "\"quaternion_wxyz\": [1,")
                });
            },
            &["camera.json", "color_from_depth.quaternion_wxyz"],
        ),
        (
            "no lists",
            |walk| {
                for name in ["associations.txt", "rgb.txt"] {
                    fs::remove_file(walk.join(name)).expect("removed");
                }
            },
            &["rgb.txt", "colour pictures"],
        ),
        (
            "empty",
            |walk| fs::write(walk.join("associations.txt"), "# nothing\n").expect("written"),
            &["associations.txt", "needed at least one frame"],
        ),
        (
            "no numbers",
            |walk| {
                fs::write(walk.join("associations.txt"), "NaN rgb/0.000000.png NaN depth/0.000000.png\nx\n")
                    .expect("written");
            },
            &["associations.txt", "line 1", "NaN"],
        ),
    ];
    for (name, damage, said) in DAMAGES {
        let (_folder, walk) = copy();
        damage(&walk);
        let error = Sequence::open(&walk).expect_err(name).to_string();
        assert!(said.iter().all(|part| error.contains(part)) && !error.contains('\n'), "{name}: {error}");
    }
    assert!(Sequence::open(Path::new("nowhere")).is_err());
    let run = odometry(&[Path::new("nowhere")]);
    assert_eq!(run.status.code(), Some(2));
}

#[test]
fn a_frame_whose_pictures_are_broken_is_named_and_the_others_are_used() {
    const DAMAGES: [Damage; 7] = [
        (
            "missing",
            |walk| fs::remove_file(walk.join("rgb/0.066667.png")).expect("removed"),
            &["0.066667.png", "cannot read"],
        ),
        (
            "truncated",
            |walk| {
                let path = walk.join("depth/0.066667.png");
                let bytes = fs::read(&path).expect("readable");
                fs::write(&path, &bytes[..bytes.len() / 2]).expect("written");
            },
            &["0.066667.png", "cannot be decoded"],
        ),
        (
            "empty",
            |walk| fs::write(walk.join("rgb/0.066667.png"), "").expect("written"),
            &["0.066667.png", "cannot be decoded"],
        ),
        ("no picture", |walk| fs::write(walk.join("rgb/0.066667.png"), "hello").expect("written"), &["0.066667.png"]),
        (
            "depth as colour",
            |walk| {
                fs::copy(walk.join("rgb/0.066667.png"), walk.join("depth/0.066667.png")).expect("copied");
            },
            &["depth", "0.066667.png", "16 bits"],
        ),
        (
            "another size",
            |walk| image::RgbImage::new(80, 60).save(walk.join("rgb/0.066667.png")).expect("written"),
            &["0.066667.png", "80 × 60", "160 × 120"],
        ),
        (
            "a header that promises gigabytes",
            |walk| {
                let path = walk.join("rgb/0.066667.png");
                let mut bytes = fs::read(&path).expect("readable");
                // Width and height of the header, then its checksum.
                bytes[16..24].copy_from_slice(&[0, 1, 0, 0, 0, 1, 0, 0]);
                let checksum = crc32(&bytes[12..29]);
                bytes[29..33].copy_from_slice(&checksum.to_be_bytes());
                fs::write(&path, bytes).expect("written");
            },
            &["0.066667.png", "65536 × 65536"],
        ),
    ];
    for (name, damage, said) in DAMAGES {
        let (_folder, walk) = copy();
        damage(&walk);
        let sequence = Sequence::open(&walk).expect("a folder with frames");
        let mut run = SequenceRun::new(&sequence, OdometryOptions::default());
        while run.step(&sequence).is_some() {}
        let error = run.records()[2].outcome.as_ref().expect_err(name).to_string();
        assert!(said.iter().all(|part| error.contains(part)) && !error.contains('\n'), "{name}: {error}");
        assert_eq!(run.trajectory().len(), NUM_FRAMES - 1, "{name}");
    }
}

/// The checksum of a PNG's chunk.
fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(u32::MAX, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte), |crc, _| (crc >> 1) ^ (0xedb8_8320 & 0_u32.wrapping_sub(crc & 1)))
    })
}

#[test]
fn lines_that_are_odd_are_noted_and_the_others_are_used() {
    let (_folder, walk) = copy();
    edit(&walk.join("associations.txt"), |text| {
        let mut lines: Vec<&str> = text.lines().collect();
        lines.reverse();
        let double = lines[0];
        lines.extend([
            double,
            "1.0 ../../etc/passwd 1.0 depth/0.033333.png",
            "1e300 rgb/0.033333.png 1e300 depth/0.033333.png",
            "\u{7} x",
        ]);
        lines.join("\r\n")
    });
    edit(&walk.join("groundtruth.txt"), |text| text + "9.0 0 0 0 0 0 0 2\n9.5 0 0 0 nan 0 0 1\n9.7 1 2 3\n");
    let sequence = Sequence::open(&walk).expect("a folder with frames");
    assert_eq!(sequence.frames.len(), NUM_FRAMES);
    assert!(sequence.frames.windows(2).all(|pair| pair[0].time_s < pair[1].time_s));
    assert_eq!(sequence.ground_truth.as_ref().map(Vec::len), Some(NUM_FRAMES));
    let notes: Vec<String> = sequence.notes.iter().map(ToString::to_string).collect();
    for part in ["sorted by time", "1 more lines of a time", "passwd", "1e300", "groundtruth.txt, line", "\u{fffd} x"] {
        assert!(notes.iter().any(|note| note.contains(part)), "{part}: {notes:?}");
    }
    assert_eq!(notes.len(), 8, "{notes:?}");
}

#[test]
fn colour_and_depth_are_paired_by_time_where_no_list_does() {
    let (_folder, walk) = copy();
    fs::remove_file(walk.join("associations.txt")).expect("removed");
    // Depth comes 5 ms late, and once not at all.
    let times: [f64; 4] = [0.0, 0.033_333, 0.066_667, 0.133_333];
    let line = |time: &f64| format!("{:.6} depth/{time:.6}.png\n", time + 0.005);
    fs::write(walk.join("depth.txt"), times.iter().map(line).collect::<String>()).expect("written");
    let sequence = Sequence::open(&walk).expect("a folder with frames");
    assert_eq!(sequence.frames.len(), 4);
    assert!(
        sequence.frames.iter().all(|frame| frame.color.file_name() == frame.depth.file_name()),
        "{:?}",
        sequence.frames
    );
    assert!(sequence.notes.iter().any(|note| note.to_string().contains("1 of 5 pictures")), "{:?}", sequence.notes);
}

#[test]
fn a_camera_on_a_robot_is_calibrated_by_its_own_motion() {
    let session = Path::new(env!("CARGO_MANIFEST_DIR")).join("sample_sessions/room-on-robot.json");
    let truth: Value = serde_json::from_slice(&fs::read(&session).expect("the sample")).expect("JSON");
    let run = odometry(&[&session, Path::new("--json")]);
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let file: Value = serde_json::from_slice(&run.stdout).expect("JSON");
    assert_eq!(file["tracked"], file["frames"]);
    let entry = &file["hand_eye"];
    assert_eq!((entry["method"].as_str(), entry["status"].as_str()), (Some("motion"), Some("ok")));
    for axis in 0..3 {
        let of = |pose: &Value| pose["flange_from_sensor"]["translation_mm"][axis].as_f64().expect("a number");
        let off = of(entry) - of(&truth["truth"]);
        // Half a metre of way, seen with 320 × 240 pixels; seen: 0.6 mm.
        assert!(off.abs() < 2.0, "axis {axis}: off by {off} mm");
    }
}
