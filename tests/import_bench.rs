//! Imports and exports on the workbench, without a window.
#![expect(clippy::expect_used, reason = "a test that finds nothing to check must fail")]

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, sync_channel};

use handeye::app::{Command, ImportDraft, ImportInto, NoticeKind, Workbench};
use handeye::calibrate::Method;
use handeye::session::import::{ImportError, ImportOptions, Imported, Kind, Separator};
use handeye::session::{self, Reading, Session, Target};

struct Bench {
    workbench: Workbench,
    woken: Receiver<()>,
}

impl Bench {
    fn new() -> Self {
        let (sender, woken) = sync_channel(64);
        let wake = move || {
            // A full channel already holds the news that there is news.
            sender.try_send(()).ok();
        };
        Self { workbench: Workbench::new(Arc::new(wake)), woken }
    }

    fn settle(&mut self) {
        while self.workbench.is_busy() {
            self.woken.recv().expect("workers wake the bench");
            self.workbench.poll();
        }
    }

    fn apply(&mut self, command: Command) {
        self.workbench.apply(command);
        self.settle();
    }

    fn draft(&self) -> &ImportDraft {
        self.workbench.import().expect("a preview is open")
    }

    fn imported(&self) -> &Imported {
        self.draft().outcome.as_ref().expect("read").as_deref().expect("recognised")
    }

    fn session(&self) -> &Session {
        &self.workbench.document().expect("open").session
    }
}

/// Poses in FANUC's angles with points, near those of a real cell.
const TABLE: &str = "label;x;y;z;w;p;r;point x;point y;point z\n\
    a;562,4;-110,2;-139,4;170,5;10,2;-40,1;-8,5;18,7;-46,1\n\
    b;555,8;-129,2;154,9;160,0;-12,5;-35,3;17,2;29,1;-36,5\n\
    c;576,5;-98,9;-141,6;-175,1;5,0;-60,2;-20,1;21,4;-40,0\n\
    d;553,8;-90,0;-133,0;168,0;22,1;10,0;-12,5;-10,5;-48,5\n";

fn new_session(name: &str) -> Command {
    Command::FinishImport(ImportInto::NewSession { name: name.to_owned(), target: Target::ball(30.0) })
}

fn sample(file_name: &str) -> &'static session::samples::Sample {
    session::samples::ALL.iter().find(|sample| sample.file_name == file_name).expect("a sample")
}

fn write(folder: &Path, name: &str, text: &str) -> PathBuf {
    let path = folder.join(name);
    std::fs::write(&path, text).expect("written");
    path
}

#[test]
fn a_pasted_table_becomes_a_new_session_that_no_file_holds_and_is_solved() {
    let mut bench = Bench::new();
    bench.apply(Command::ImportText(TABLE.to_owned()));
    assert_eq!(bench.imported().stations.len(), 4);
    assert!(bench.workbench.document().is_none(), "nothing is made before the user says so");
    bench.apply(new_session("pasted"));
    assert!(bench.workbench.import().is_none());
    let document = bench.workbench.document().expect("open");
    assert!(document.is_unsaved() && document.path.is_none());
    assert_eq!(document.session.name, "pasted");
    assert_eq!(document.session.target, Target::ball(30.0));
    let labels: Vec<&str> = document.session.stations.iter().map(|station| station.label.as_str()).collect();
    assert_eq!(labels, ["a", "b", "c", "d"]);
    assert!(bench.workbench.results_are_current());
    let folder = tempfile::tempdir().expect("a folder");
    bench.apply(Command::SaveAs(folder.path().join("saved.json")));
    assert!(!bench.workbench.document().expect("open").is_unsaved());
}

#[test]
fn added_stations_are_one_step_of_undo_under_the_name_of_their_file() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = write(folder.path(), "poses.csv", TABLE);
    let mut bench = Bench::new();
    bench
        .workbench
        .open_session(session::parse(sample("few-rotations.json").json.as_bytes(), "s").expect("valid"), None);
    bench.settle();
    let before = bench.session().clone();
    bench.apply(Command::Import(vec![path]));
    bench.apply(Command::FinishImport(ImportInto::OpenSession));
    assert_eq!(bench.session().stations.len(), before.stations.len() + 4);
    assert!(bench.workbench.import().is_none());
    let history = &bench.workbench.document().expect("open").history;
    assert_eq!(history.undo_label(), Some("import 4 stations from poses.csv"));
    bench.apply(Command::Undo);
    assert_eq!(*bench.session(), before);
}

#[test]
fn options_are_read_at_once_and_what_was_set_is_kept() {
    let mut bench = Bench::new();
    bench.apply(Command::ImportText(TABLE.to_owned()));
    assert_eq!(bench.imported().options.separator, Some(Separator::Semicolon), "recognised");
    assert_eq!(bench.draft().options, ImportOptions::default());
    let id = bench.draft().id;
    let mut notation = bench.imported().options.notation.expect("recognised");
    notation.is_inverse = true;
    let options = ImportOptions { notation: Some(notation), ..ImportOptions::default() };
    let x_before = bench.imported().stations[0].captures[0].base_from_flange.translation_mm().x;
    bench.workbench.apply(Command::SetImportOptions(Box::new(options.clone())));
    assert!(bench.draft().outcome.is_some(), "the last preview stays until the new one is there");
    bench.settle();
    assert_eq!((bench.draft().id, &bench.draft().options), (id, &options));
    let x_after = bench.imported().stations[0].captures[0].base_from_flange.translation_mm().x;
    assert!((x_before - x_after).abs() > 1.0);
}

#[test]
fn what_is_not_recognised_stays_in_the_preview_and_a_form_said_by_hand_is_tried() {
    let mut bench = Bench::new();
    bench.apply(Command::ImportText("nothing of the kind".to_owned()));
    let refused = |bench: &Bench| matches!(bench.draft().outcome, Some(Err(ImportError::NotRecognised { .. })));
    assert!(refused(&bench));
    bench.apply(Command::FinishImport(ImportInto::OpenSession));
    bench.apply(new_session("none"));
    assert!(bench.workbench.document().is_none() && bench.workbench.import().is_some());
    let options = ImportOptions { kind: Some(Kind::PoseTable), ..ImportOptions::default() };
    bench.apply(Command::SetImportOptions(Box::new(options)));
    assert!(refused(&bench));
    bench.apply(Command::CancelImport);
    assert!(bench.workbench.import().is_none());
    assert!(bench.workbench.notices().is_empty());
}

#[test]
fn a_newer_import_replaces_the_one_being_read_and_cancelling_drops_it() {
    let mut bench = Bench::new();
    bench.workbench.apply(Command::ImportText(TABLE.repeat(2_000)));
    let first = bench.draft().id;
    bench.workbench.apply(Command::ImportText(TABLE.to_owned()));
    assert_ne!(bench.draft().id, first);
    bench.settle();
    assert_eq!(bench.imported().stations.len(), 4);
    bench.workbench.apply(Command::ImportText(TABLE.to_owned()));
    bench.workbench.apply(Command::CancelImport);
    assert!(!bench.workbench.is_reading_import() && bench.workbench.import().is_none());
    bench.settle();
    assert!(bench.workbench.import().is_none());
}

#[test]
fn files_that_cannot_be_read_are_told_where_they_were_chosen() {
    let mut bench = Bench::new();
    bench.apply(Command::Import(vec![PathBuf::from("/nowhere/poses.csv")]));
    assert!(bench.workbench.import().is_none());
    let notice = bench.workbench.notices().last().expect("told");
    assert!(notice.kind == NoticeKind::Error && notice.is_of_opening);
    assert!(notice.message.contains("/nowhere/poses.csv"), "{}", notice.message);
}

#[test]
fn poses_of_which_nothing_is_known_are_read_as_those_on_the_bench() {
    let mut session = session::parse(sample("few-rotations.json").json.as_bytes(), "s").expect("valid");
    let kuka = handeye::geometry::PoseConvention::by_id("kuka-abc").expect("known");
    session.robot.notation = handeye::geometry::PoseNotation::of(kuka);
    let mut bench = Bench::new();
    bench.workbench.open_session(session, None);
    bench.settle();
    let nameless: String =
        TABLE.lines().skip(1).map(|line| line.split(';').skip(1).collect::<Vec<_>>().join(";") + "\n").collect();
    bench.apply(Command::ImportText(nameless));
    let notation = bench.imported().options.notation.expect("some is taken");
    assert_eq!(notation.convention.id, "kuka-abc");
}

#[test]
fn stations_of_another_session_are_added_behind_those_of_the_open_one() {
    let folder = tempfile::tempdir().expect("a folder");
    let other = sample("lin-mu-2019-table-2.json");
    let path = write(folder.path(), "other.json", other.json);
    let mut bench = Bench::new();
    bench
        .workbench
        .open_session(session::parse(sample("lin-mu-2019-table-1.json").json.as_bytes(), "s").expect("valid"), None);
    bench.settle();
    bench.apply(Command::Import(vec![path]));
    bench.apply(Command::FinishImport(ImportInto::OpenSession));
    let labels: Vec<&str> = bench.session().stations.iter().map(|station| station.label.as_str()).collect();
    assert_eq!(labels, ["1", "2", "3", "4", "5", "6", "7", "8", "9", "10"]);
    assert!(bench.workbench.document().is_some_and(handeye::app::Document::is_unsaved));
    // Five and five stations of the same ball would not be; of two balls the result says so itself.
    assert!(bench.workbench.results().is_some_and(|results| results.method(Method::BallFixedPoint).is_some()));
}

#[test]
fn sessions_are_opened_and_everything_else_is_previewed() {
    let folder = tempfile::tempdir().expect("a folder");
    let paths = |names: &[&str]| names.iter().map(PathBuf::from).collect::<Vec<_>>();
    for name in ["cell 3.json", "CELL.JSON", "no-ending"] {
        assert_eq!(Command::to_read(paths(&[name])), Command::Open(name.into()));
    }
    for names in [&["poses.csv"][..], &["TEST.LS"], &["a.json", "b.json"], &["poses.csv", "1.csv"]] {
        assert_eq!(Command::to_read(paths(names)), Command::Import(paths(names)));
    }
    let of_a_folder = vec![folder.path().to_owned()];
    assert_eq!(Command::to_read(of_a_folder.clone()), Command::Import(of_a_folder));
}

fn valid_points(reading: &Reading) -> Vec<(f64, f64)> {
    match reading {
        Reading::Profile(profile) => profile.valid_points().map(|(_, x, z)| (x, z)).collect(),
        Reading::Point(_) | Reading::Pose(_) => Vec::new(),
    }
}

#[test]
fn exported_poses_and_profiles_come_back_as_the_same_stations() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut bench = Bench::new();
    bench
        .workbench
        .open_session(session::parse(sample("near-largest-arc.json").json.as_bytes(), "s").expect("valid"), None);
    bench.settle();
    let before = bench.session().clone();
    bench.apply(Command::ExportPoses(folder.path().join("poses.csv")));
    bench.apply(Command::ExportProfiles(folder.path().join("profiles")));
    let done = bench.workbench.notices().iter().filter(|notice| notice.kind == NoticeKind::Done).count();
    assert_eq!((done, bench.workbench.notices().len()), (2, 2), "{:?}", bench.workbench.notices());
    bench.apply(Command::Import(vec![folder.path().to_owned()]));
    bench.apply(new_session("again"));
    for (was, is) in before.stations.iter().zip(&bench.session().stations) {
        assert_eq!((&was.label, was.side, was.enabled), (&is.label, is.side, is.enabled));
        let (was, is) = (&was.captures[0], &is.captures[0]);
        // Angles are written with all their digits; what is lost is the rounding of a turn there and back.
        assert!((was.base_from_flange.translation_mm() - is.base_from_flange.translation_mm()).norm() < 1e-9);
        assert!(was.base_from_flange.rotation().angle_to(&is.base_from_flange.rotation()) < 1e-12);
        assert_eq!(valid_points(&was.reading), valid_points(&is.reading));
    }
    assert_eq!(bench.session().stations.len(), before.stations.len());
}

#[test]
fn what_cannot_be_exported_is_told() {
    let mut bench = Bench::new();
    bench
        .workbench
        .open_session(session::parse(sample("near-largest-arc.json").json.as_bytes(), "s").expect("valid"), None);
    bench.settle();
    bench.apply(Command::ExportPoses(PathBuf::from("/nowhere/at-all/poses.csv")));
    let notice = bench.workbench.notices().last().expect("told");
    assert_eq!(notice.kind, NoticeKind::Error);
    assert!(notice.message.contains("/nowhere/at-all/poses.csv"), "{}", notice.message);
}
