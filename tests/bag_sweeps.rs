//! Bags of a robot that stepped over a ball and stood still at each step, and of one whose poses were not sent for a while.
//! They are written here, message by message, from a simulated session.
#![expect(clippy::expect_used, reason = "a test that finds nothing to check must fail")]

use std::collections::BTreeMap;
use std::fs::File;
use std::io::BufWriter;
use std::path::{Path, PathBuf};

use handeye::calibrate::{Solution, best_available};
use handeye::geometry::{Base, Flange, PoseNotation, Profile, Transform};
use handeye::session::import::{BagOptions, BagReport, ImportError, ImportOptions, Imported, Note, read, read_paths};
use handeye::session::{self, Reading, Session, Target};
use handeye::simulate::{SimulationOptions, SimulationTarget, simulate};
use handeye::watch::Unwatched;
use mcap::Writer;
use mcap::records::MessageHeader;

const START_NS: u64 = 1_700_000_000_000_000_000;
const MS: u64 = 1_000_000;

/// A message as ROS writes it: little-endian, each number at a multiple of its size.
struct Cdr(Vec<u8>);

impl Cdr {
    fn new() -> Self {
        Self(vec![0, 1, 0, 0])
    }

    fn number<const N: usize>(&mut self, bytes: [u8; N]) -> &mut Self {
        while !(self.0.len() - 4).is_multiple_of(N) {
            self.0.push(0);
        }
        self.0.extend(bytes);
        self
    }

    fn u32(&mut self, value: usize) -> &mut Self {
        self.number(u32::try_from(value).expect("small").to_le_bytes())
    }

    fn f64(&mut self, value: f64) -> &mut Self {
        self.number(value.to_le_bytes())
    }

    fn text(&mut self, text: &str) -> &mut Self {
        self.u32(text.len() + 1);
        self.0.extend(text.as_bytes());
        self.0.push(0);
        self
    }

    fn header(&mut self, time_ns: u64, frame: &str) -> &mut Self {
        self.u32(usize::try_from(time_ns / 1_000_000_000).expect("seconds"));
        self.u32(usize::try_from(time_ns % 1_000_000_000).expect("nanoseconds")).text(frame)
    }
}

fn pose_message(time_ns: u64, pose: &Transform<Base, Flange>) -> Vec<u8> {
    let mut cdr = Cdr::new();
    cdr.header(time_ns, "base_link");
    for value in pose.translation_mm().iter() {
        cdr.f64(value / 1e3);
    }
    let [w, x, y, z] = pose.quaternion_wxyz();
    for value in [x, y, z, w] {
        cdr.f64(value);
    }
    cdr.0
}

/// A line as a cloud of doubles in the plane y = 0.
fn cloud_message(time_ns: u64, profile: &Profile) -> Vec<u8> {
    let mut cdr = Cdr::new();
    cdr.header(time_ns, "profiler").u32(1).u32(profile.len()).u32(3);
    for (idx, name) in ["x", "y", "z"].into_iter().enumerate() {
        cdr.text(name).u32(8 * idx).number([8]).u32(1);
    }
    cdr.number([0]).u32(24).u32(24 * profile.len()).u32(24 * profile.len());
    for (x, z) in profile.x_mm().iter().zip(profile.z_mm()) {
        for value in [x / 1e3, 0.0, z / 1e3] {
            cdr.0.extend(value.to_le_bytes());
        }
    }
    cdr.number([0]);
    cdr.0
}

/// A bag as it is being recorded.
struct Recorder {
    writer: Writer<BufWriter<File>>,
    poses: u16,
    profiles: u16,
    time_ns: u64,
}

impl Recorder {
    fn new(path: &Path) -> Self {
        let file = BufWriter::new(File::create(path).expect("a file"));
        let mut writer = Writer::new(file).expect("begun");
        let mut channel = |topic: &str, kind: &str| {
            let schema = writer.add_schema(kind, "ros2msg", b"").expect("a schema");
            writer.add_channel(schema, topic, "cdr", &BTreeMap::new()).expect("a channel")
        };
        let poses = channel("/tcp_pose", "geometry_msgs/msg/PoseStamped");
        let profiles = channel("/points", "sensor_msgs/msg/PointCloud2");
        Self { writer, poses, profiles, time_ns: START_NS }
    }

    fn write(&mut self, channel_id: u16, time_ns: u64, data: &[u8]) {
        let header = MessageHeader { channel_id, sequence: 0, log_time: time_ns, publish_time: time_ns };
        self.writer.write_to_known_channel(&header, data).expect("written");
    }

    fn pose(&mut self, pose: &Transform<Base, Flange>) {
        self.write(self.poses, self.time_ns, &pose_message(self.time_ns, pose));
    }

    fn profile(&mut self, profile: &Profile) {
        self.write(self.profiles, self.time_ns, &cloud_message(self.time_ns, profile));
    }

    /// Stands still for 0.6 s, with a pose every 0.1 s, and measures in the middle.
    fn stay(&mut self, pose: &Transform<Base, Flange>, profile: &Profile) {
        for tick in 0..7 {
            self.pose(pose);
            self.time_ns += 50 * MS;
            if tick == 3 {
                self.profile(profile);
            }
            self.time_ns += 50 * MS;
        }
    }

    fn end(mut self) {
        self.writer.finish().expect("ended");
    }
}

fn ball_session() -> Session {
    let options =
        SimulationOptions { seed: 3, num_stations: 7, num_steps: 10, ..SimulationOptions::of(SimulationTarget::Ball) };
    // Ten steps over what takes twenty-one otherwise.
    simulate(&SimulationOptions { step_mm: options.step_mm * 2.0, ..options })
}

fn profile_of(reading: &Reading) -> &Profile {
    let Reading::Profile(profile) = reading else { panic!("a profile") };
    profile
}

fn record(session: &Session, path: &Path) {
    let mut recorder = Recorder::new(path);
    for capture in session.stations.iter().flat_map(|station| &station.captures) {
        recorder.stay(&capture.base_from_flange, profile_of(&capture.reading));
    }
    recorder.end();
}

fn import(path: PathBuf, bag: BagOptions) -> Result<Imported, ImportError> {
    let sources = read_paths(&[path])?;
    read(&sources, &ImportOptions { bag, ..ImportOptions::default() }, &PoseNotation::default(), &mut Unwatched)
}

fn report(imported: &Imported) -> &BagReport {
    let found = imported.notes.iter().find_map(|note| match note {
        Note::Bag(report) => Some(report),
        _ => None,
    });
    found.expect("what became of the bag")
}

fn best(imported: Imported, radius_mm: f64) -> Option<Solution> {
    let session = imported.into_session("bag".to_owned(), Target::ball(radius_mm)).expect("a session");
    let measured = session::measure(&session, None, &mut Unwatched).expect("not cancelled");
    let problem = session::problem(&session, &measured).ok()?;
    let results = problem.solve_all(problem.methods(), &mut Unwatched).expect("not cancelled");
    best_available(&results).cloned()
}

#[test]
fn stays_along_the_laser_s_normal_are_sweeps_and_calibrate_like_the_session_they_were() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("steps.mcap");
    let session = ball_session();
    record(&session, &path);
    let joined = import(path.clone(), BagOptions::default()).expect("an import");
    let said = report(&joined);
    assert_eq!((said.num_stays, said.num_sweeps, said.num_joined_stays), (Some(70), 7, 70), "{said:?}");
    assert_eq!(said.pose_frame.as_deref(), Some("base_link"));
    let captures: Vec<usize> = joined.stations.iter().map(|station| station.captures.len()).collect();
    assert_eq!(captures, [10; 7]);
    for (station, expected) in joined.stations.iter().zip(&session.stations) {
        for (capture, expected) in station.captures.iter().zip(&expected.captures) {
            let apart = capture.base_from_flange.translation_mm() - expected.base_from_flange.translation_mm();
            assert!(apart.norm() < 1e-9, "first contact first, each step at its place: {apart}");
        }
    }
    let separate = import(path, BagOptions { joins_stays: false, ..BagOptions::default() }).expect("an import");
    assert_eq!((separate.stations.len(), report(&separate).num_sweeps), (70, 0));
    let truth = session.truth.as_ref().expect("simulated").flange_from_sensor;
    let radius_mm = SimulationOptions::of(SimulationTarget::Ball).radius_mm;
    let off_mm = |solution: &Solution| (solution.flange_from_sensor.translation_mm() - truth.translation_mm()).norm();
    let swept = best(joined, radius_mm).expect("a calibration");
    // Some σ of what the cell gives with ten steps a sweep.
    assert!(off_mm(&swept) < 0.5, "{} mm", off_mm(&swept));
}

#[test]
fn profiles_in_a_time_without_poses_have_none_and_the_stay_ends() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("gap.mcap");
    let session = ball_session();
    let capture = &session.stations[0].captures[0];
    let (pose, profile) = (&capture.base_from_flange, profile_of(&capture.reading));
    let mut recorder = Recorder::new(&path);
    recorder.stay(pose, profile);
    // Nothing is heard of the robot for five seconds, in which it is measured on.
    for _ in 0..50 {
        recorder.time_ns += 100 * MS;
        recorder.profile(profile);
    }
    recorder.time_ns += 100 * MS;
    recorder.stay(pose, profile);
    recorder.end();
    let imported = import(path, BagOptions::default()).expect("an import");
    let said = report(&imported);
    assert_eq!((said.num_stays, said.num_paired, said.num_profiles), (Some(2), 2, 52), "{said:?}");
    assert_eq!(said.num_without_pose, 50, "{said:?}");
}

#[test]
fn topics_tell_when_they_were_recorded() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("steps.mcap");
    record(&ball_session(), &path);
    let sources = read_paths(&[path]).expect("readable");
    let bag = sources[0].bag().expect("a bag");
    let times: Vec<_> = bag.topics.iter().map(|topic| topic.recorded_ns.expect("known")).collect();
    let start_ns = i64::try_from(START_NS).expect("a time");
    // 70 stays of 0.7 s; the profile of each comes 0.35 s after its beginning, the last pose 0.1 s before its end.
    let seconds = |time_ns: i64| (time_ns - start_ns) / 1_000_000;
    let found: Vec<[i64; 2]> = times.iter().map(|times| times.map(seconds)).collect();
    assert_eq!(bag.topics.iter().map(|topic| topic.name.as_str()).collect::<Vec<_>>(), ["/points", "/tcp_pose"]);
    assert_eq!(found, [[350, 69 * 700 + 350], [0, 70 * 700 - 100]]);
    // Those of writers that others made tell it too.
    let fixtures = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/bags");
    for source in read_paths(&[fixtures]).expect("readable") {
        let Some(bag) = source.bag() else { continue };
        for topic in &bag.topics {
            let [first, last] = topic.recorded_ns.unwrap_or_else(|| panic!("{}: {}", source.name, topic.name));
            assert!(first <= last && first >= start_ns, "{}: {}", source.name, topic.name);
        }
    }
}

#[test]
fn a_description_without_its_recording_says_what_is_missing() {
    let folder = tempfile::tempdir().expect("a folder");
    let text = "rosbag2_bagfile_information:\n  version: 9\n  relative_file_paths:\n    - scan_0.mcap\n  duration:\n";
    std::fs::write(folder.path().join("metadata.yaml"), text).expect("written");
    let error = read_paths(&[folder.path().to_owned()]).expect_err("nothing to read").to_string();
    assert!(error.contains("scan_0.mcap") && error.contains("copy the whole folder"), "{error}");
    assert_eq!(error.lines().count(), 1);
}
