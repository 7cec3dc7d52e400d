//! ROS 2 bags that others wrote (`tests/clients/ros_bags.py --fixtures tests/data/bags`): the poses and profiles of the
//! places at which the robot stood, whatever they were recorded with, and under damage.
#![expect(clippy::expect_used, reason = "a test that finds nothing to check must fail")]

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use handeye::geometry::PoseNotation;
use handeye::session::import::bag::{Clock, MessageKind, Taking};
use handeye::session::import::{
    BagOptions, BagReport, ImportError, ImportOptions, Imported, Kind, Note, read, read_paths,
};
use handeye::session::{Reading, Station};
use handeye::watch::Unwatched;
use peak_alloc::PeakAlloc;
use rand_core::{RngCore, SeedableRng};
use rand_pcg::Pcg64Mcg;

#[global_allocator]
static PEAK: PeakAlloc = PeakAlloc;

fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/bags").join(name)
}

fn import(path: &Path, bag: BagOptions) -> Result<Imported, ImportError> {
    let sources = read_paths(&[path.to_owned()])?;
    let options = ImportOptions { bag, ..ImportOptions::default() };
    read(&sources, &options, &PoseNotation::default(), &mut Unwatched)
}

fn report(imported: &Imported) -> &BagReport {
    let reports = imported.notes.iter().find_map(|note| match note {
        Note::Bag(report) => Some(report),
        _ => None,
    });
    reports.expect("what became of the bag")
}

/// The bags, what their profiles are called in `expected.json`, and where they are.
const BAGS: [(&str, &str); 6] = [
    ("pose_scan_zstd.mcap", "scan"),
    ("tf_cloud_db3", "cloud"),
    ("pose_cloud_f64_lz4.mcap", "cloud"),
    ("tf_scan_unstamped_plain.mcap", "scan"),
    ("big_endian", "cloud"),
    ("cut_off.mcap", "scan"),
];

fn expected() -> serde_json::Value {
    serde_json::from_slice(&std::fs::read(data("expected.json")).expect("readable")).expect("JSON")
}

/// Single precision at 70 mm is 8 nm; a few products on top.
const PROFILE_MM: f64 = 1e-4;

fn assert_stations(name: &str, stations: &[Station], kind: &str) {
    let expected = expected();
    let expected = expected.as_array().expect("a list");
    assert_eq!(stations.len(), expected.len(), "{name}");
    for (station, expected) in stations.iter().zip(expected) {
        let numbers = |value: &serde_json::Value| -> Vec<f64> {
            value.as_array().expect("a list").iter().map(|v| v.as_f64().unwrap_or(f64::NAN)).collect()
        };
        let [capture] = station.captures.as_slice() else { panic!("{name}: one capture a stay") };
        let at = numbers(&expected["translation_mm"]);
        let apart_mm =
            (capture.base_from_flange.translation_mm() - handeye::geometry::Vec3::from_column_slice(&at)).norm();
        let turn = numbers(&expected["quaternion_xyzw"]);
        let rotation =
            nalgebra::UnitQuaternion::new_normalize(nalgebra::Quaternion::new(turn[3], turn[0], turn[1], turn[2]));
        let apart_rad = capture.base_from_flange.rotation().angle_to(&rotation);
        // Poses are doubles; medians and means of equal ones are they, but for rounding.
        assert!(apart_mm < 1e-9 && apart_rad < 1e-7, "{name}: {apart_mm} mm, {apart_rad} rad");
        let Reading::Profile(profile) = &capture.reading else { panic!("{name}: a profile") };
        let points = expected[kind].as_array().expect("points");
        assert_eq!(profile.len(), points.len(), "{name}");
        for (idx, point) in points.iter().enumerate() {
            let point = numbers(point);
            let (x, z) = (profile.x_mm()[idx], profile.z_mm()[idx]);
            assert_eq!(z.is_nan(), point[1].is_nan(), "{name}: point {idx}");
            assert!(
                z.is_nan() || ((x - point[0]).abs() < PROFILE_MM && (z - point[1]).abs() < PROFILE_MM),
                "{name} {idx}"
            );
        }
    }
}

#[test]
fn the_places_at_which_the_robot_stood_come_back_from_every_writer() {
    for (name, kind) in BAGS {
        let imported = import(&data(name), BagOptions::default()).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_stations(name, &imported.stations, kind);
        let report = report(&imported);
        assert_eq!(imported.options.kind, Some(Kind::RosBag));
        assert_eq!(report.num_stays, Some(3), "{name}");
        assert_eq!(report.num_paired + report.num_moving + report.num_without_pose, report.num_profiles, "{name}");
        assert!(report.num_moving > 0 && report.unreadable.is_empty(), "{name}: {report:?}");
        assert_eq!(report.cut_short.is_empty(), name != "cut_off.mcap", "{name}: {report:?}");
        let options = &imported.options.bag;
        assert_eq!(options.axes.expect("seen").to_string(), if kind == "scan" { "y,x" } else { "x,z" }, "{name}");
        assert_eq!(report.frames.is_some(), name.starts_with("tf"), "{name}");
    }
}

#[test]
fn a_folder_of_bags_is_one_source_a_recording_and_topics_are_listed() {
    let sources = read_paths(&[data("")]).expect("readable");
    let mut names: Vec<&str> =
        sources.iter().filter(|source| source.bag().is_some()).map(|s| s.name.as_str()).collect();
    names.sort_unstable();
    let mut wanted = BAGS.map(|(name, _)| name);
    wanted.sort_unstable();
    assert_eq!(names, wanted);
    let tf = read_paths(&[data("tf_cloud_db3")]).expect("readable");
    let topics = &tf[0].bag().expect("a bag").topics;
    let listed: Vec<(&str, Option<MessageKind>)> = topics.iter().map(|t| (t.name.as_str(), t.kind)).collect();
    assert_eq!(
        listed,
        [
            ("/points", Some(MessageKind::PointCloud)),
            ("/tf", Some(MessageKind::Transforms)),
            ("/tf_static", Some(MessageKind::Transforms))
        ]
    );
    assert!(topics.iter().all(|topic| topic.num_messages > 0), "{topics:?}");
}

#[test]
fn every_profile_is_a_scan_with_its_own_pose() {
    let bag = BagOptions { taking: Some(Taking::EveryProfile), ..BagOptions::default() };
    let imported = import(&data("pose_scan_zstd.mcap"), bag).expect("an import");
    let report = report(&imported);
    let num_captures: usize = imported.stations.iter().map(|station| station.captures.len()).sum();
    assert_eq!((num_captures, report.num_stays), (report.num_paired, None));
    // The profiles of a stay have one orientation, those on the way turn: at least one station a stay.
    assert!(imported.stations.len() >= 3 && imported.stations.iter().any(|station| station.captures.len() >= 5));
}

#[test]
fn what_is_asked_for_and_not_there_is_named_with_what_is() {
    let path = data("tf_cloud_db3");
    let said = |bag: BagOptions| import(&path, bag).expect_err("refused").to_string();
    let topic = said(BagOptions { pose_topic: Some("/pose".to_owned()), ..BagOptions::default() });
    assert!(topic.contains("/pose") && topic.contains("/tf"), "{topic}");
    let frame = said(BagOptions { flange_frame: Some("hand".to_owned()), ..BagOptions::default() });
    assert!(frame.contains("hand") && frame.contains("tool0") && frame.contains("wrist"), "{frame}");
    let rigid = said(BagOptions { base_frame: Some("wrist".to_owned()), ..BagOptions::default() });
    assert!(rigid.contains("sent more than once"), "{rigid}");
    // Nothing is paired if only what comes at the same instant counts.
    let strict = BagOptions { pair_within_ms: 0.0, taking: Some(Taking::EveryProfile), ..BagOptions::default() };
    let nothing = import(&path, strict);
    let sentence = match &nothing {
        Ok(imported) => handeye::text::import_bag::report(report(imported)),
        Err(error) => error.to_string(),
    };
    assert!(sentence.contains("without a pose in reach") || sentence.contains("no pose"), "{sentence}");
}

#[test]
fn the_time_of_the_recording_can_count_instead() {
    let bag = BagOptions { clock: Clock::Recording, ..BagOptions::default() };
    // Poses and profiles were recorded equally late.
    let imported = import(&data("pose_scan_zstd.mcap"), bag).expect("an import");
    assert_stations("recording", &imported.stations, "scan");
}

/// Whatever the file: the buffers of a file that is read in pieces, unpacked chunks, pages of a database, the preview.
const BYTES_AT_ANY_RATE: usize = 6 << 20;
const LONGEST: Duration = Duration::from_secs(5);
const NUM_DAMAGED: usize = 1_500;

#[test]
fn damaged_bags_are_refused_or_read_as_far_as_they_go() {
    let folder = tempfile::tempdir().expect("a folder");
    let files = [
        "pose_scan_zstd.mcap",
        "pose_cloud_f64_lz4.mcap",
        "tf_scan_unstamped_plain.mcap",
        "big_endian/big_endian.mcap",
        "tf_cloud_db3/tf_cloud_db3.db3",
        "cut_off.mcap",
    ];
    let mut random = Pcg64Mcg::seed_from_u64(7);
    let mut below = |bound: usize| usize::try_from(random.next_u64() % bound.max(1) as u64).expect("below a usize");
    let (mut num_read, mut num_told) = (0, 0);
    for idx in 0..NUM_DAMAGED {
        let name = files[idx % files.len()];
        let mut bytes = std::fs::read(data(name)).expect("readable");
        for _ in 0..=below(4) {
            let at = below(bytes.len());
            let end = (at + 1 + below(40)).min(bytes.len());
            match below(6) {
                0 => bytes.truncate(at.max(20)),
                1 => drop(bytes.drain(at..end)),
                // Lengths and offsets that are far too large.
                2 => bytes[at..end].fill(0xff),
                3 => bytes[at..end].fill(0),
                4 => {
                    for byte in bytes.iter_mut().skip(at).take(8) {
                        *byte = u8::try_from(below(256)).expect("a byte");
                    }
                }
                _ => bytes[at] ^= 1 << below(8),
            }
        }
        let path = folder.path().join(format!("{idx}.{}", name.rsplit('.').next().expect("an ending")));
        std::fs::write(&path, &bytes).expect("written");
        let before = PEAK.current_usage();
        PEAK.reset_peak_usage();
        let started = Instant::now();
        let outcome = import(&path, BagOptions::default());
        let (taken, elapsed) = (PEAK.peak_usage().saturating_sub(before), started.elapsed());
        assert!(taken <= BYTES_AT_ANY_RATE + 10 * bytes.len(), "bag {idx} ({name}) took {taken} bytes");
        assert!(elapsed < LONGEST, "bag {idx} ({name}) took {elapsed:?}");
        match outcome {
            Ok(imported) => {
                num_read += 1;
                num_told += usize::from(!report(&imported).cut_short.is_empty());
            }
            Err(error) => {
                let sentence = error.to_string();
                assert_eq!(sentence.lines().count(), 1, "{sentence}");
                assert!(sentence.contains("found"), "{sentence}");
            }
        }
        std::fs::remove_file(&path).expect("removed");
    }
    println!("{num_read} of {NUM_DAMAGED} could be read, {num_told} of them as far as they go");
    assert!(num_read > NUM_DAMAGED / 10 && num_told > 0);
}
