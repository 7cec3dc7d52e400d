//! Nothing is lost: killed programs, full disks, files that are read-only or changed by others.
//!
//! A child process of this test edits and saves without end, and is killed in the middle of it. How often, and with what
//! time between two recovery copies, can be set:
//! `HANDEYE_KILLS=200 HANDEYE_RECOVERY_MS=3000 cargo test --test safety killed -- --nocapture`.
#![expect(clippy::expect_used, reason = "a test that finds nothing to check must fail")]

use std::fs;
use std::io::{BufRead, BufReader, Write as _};
use std::path::{Path, PathBuf};
use std::process::{Child, Command as Process, Stdio};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, sync_channel};
use std::time::{Duration, Instant, SystemTime};

use handeye::app::recovery::INTERVAL;
use handeye::app::{Command, NoticeKind, OnDisk, Recoverable, RecoverySettings, Workbench};
use handeye::calibrate::SideChoice;
use handeye::geometry::{Profile, Transform};
use handeye::session::{self, Capture, Edit, Reading, Session, SessionError, SetupField, Station, Target};
use rand_core::{RngCore, SeedableRng};
use rand_pcg::Pcg64Mcg;

struct Bench {
    workbench: Workbench,
    woken: Receiver<()>,
}

impl Bench {
    fn new() -> Self {
        let (sender, woken) = sync_channel(1024);
        let wake = move || {
            sender.try_send(()).ok();
        };
        Self { workbench: Workbench::new(Arc::new(wake)), woken }
    }

    /// One that keeps copies in this folder, each edit at once.
    fn with_recovery(folder: &Path) -> Self {
        let mut bench = Self::new();
        bench.workbench.keep_copies(RecoverySettings { folder: folder.to_owned(), interval: Duration::ZERO });
        bench
    }

    fn until(&mut self, what: &str, is_done: impl Fn(&Workbench) -> bool) {
        let start = Instant::now();
        while !is_done(&self.workbench) {
            // Long beyond any machine's slowness: a test that waits for ever says nothing.
            assert!(start.elapsed() < Duration::from_mins(1), "waited in vain for {what}");
            self.woken.recv_timeout(Duration::from_mins(1)).expect("the bench is woken");
            self.workbench.poll();
        }
    }

    fn apply(&mut self, command: Command) {
        self.workbench.apply(command);
        self.until("the work to be done", |workbench| !workbench.is_busy());
    }

    fn set_notes(&mut self, notes: &str) {
        self.apply(Command::Edit { edit: Edit::Setup(SetupField::Notes(notes.to_owned())), gesture: None });
    }

    fn session(&self) -> &Session {
        &self.workbench.document().expect("open").session
    }

    fn is_unsaved(&self) -> bool {
        self.workbench.document().is_some_and(handeye::app::Document::is_unsaved)
    }

    fn last_error(&self) -> &str {
        let mut errors = self.workbench.notices().iter().filter(|notice| notice.kind == NoticeKind::Error);
        &errors.next_back().expect("an error is told").message
    }
}

/// A session of a usual size: a few hundred kilobytes.
fn measured_session() -> Session {
    let x_mm: Vec<f64> = (0..200).map(|idx| f64::from(idx) * 0.05).collect();
    let z_mm: Vec<Option<f64>> = x_mm.iter().map(|x| Some((x * 0.7).sin())).collect();
    let profile = Arc::new(Profile::new(x_mm, &z_mm).expect("within limits"));
    let capture = Capture {
        base_from_flange: Transform::identity(),
        written_angles: None,
        reading: Reading::Profile(profile),
        step_mm: None,
        unknown: serde_json::Map::new(),
    };
    let station = |idx: usize| Station {
        label: (idx + 1).to_string(),
        // Not solved: the child is to spend its time on editing and saving.
        enabled: false,
        side: SideChoice::Auto,
        edge: None,
        captures: vec![capture.clone()],
        unknown: serde_json::Map::new(),
    };
    Session { stations: (0..60).map(station).collect(), ..Session::new(Target::ball(15.0)) }
}

fn saved_in(folder: &Path) -> PathBuf {
    let path = folder.join("cell-3.json");
    session::save(&measured_session(), &path).expect("saved");
    path
}

fn temporaries(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).expect("readable").map(|entry| entry.expect("readable").path());
    entries.filter(|path| path.extension().is_some_and(|extension| extension == "tmp")).collect()
}

// Killed.

/// Says to this test's own program that it is the child.
const CHILD_FOLDER: &str = "HANDEYE_TEST_CHILD_FOLDER";
const RECOVERY_MS: &str = "HANDEYE_RECOVERY_MS";
const KILLS: &str = "HANDEYE_KILLS";

fn from_environment(name: &str, usual: u64) -> u64 {
    std::env::var(name).map_or(usual, |text| text.parse().expect("a number"))
}

fn unix_us() -> u128 {
    SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).expect("after 1970").as_micros()
}

/// Edits without end, and saves now and then; each edit is told on standard output, with its time, once it is made.
#[test]
fn child_that_edits_until_it_is_killed() {
    let Some(folder) = std::env::var_os(CHILD_FOLDER).map(PathBuf::from) else { return };
    let mut bench = Bench::new();
    bench.workbench.keep_copies(RecoverySettings {
        folder: folder.join("recovery"),
        interval: Duration::from_millis(from_environment(RECOVERY_MS, 0)),
    });
    bench.apply(Command::Open(folder.join("cell-3.json")));
    let save_every = from_environment("HANDEYE_TEST_SAVE_EVERY", 1);
    let mut out = std::io::stdout();
    for edit in 1_u64.. {
        let notes = Edit::Setup(SetupField::Notes(edit.to_string()));
        bench.workbench.apply(Command::Edit { edit: notes, gesture: None });
        writeln!(out, "edit {edit} {}", unix_us()).and_then(|()| out.flush()).expect("the parent listens");
        if edit % save_every == 0 {
            // Not waited for: the next edits come while it is on its way.
            bench.workbench.apply(Command::Save);
        }
        // A person takes longer; so the machine is not only busy with us.
        std::thread::sleep(Duration::from_millis(2));
        bench.workbench.poll();
    }
}

fn start_child(folder: &Path, interval: Duration, save_every: u64) -> Child {
    Process::new(std::env::current_exe().expect("this program"))
        .args(["--exact", "child_that_edits_until_it_is_killed", "--nocapture", "--test-threads=1"])
        .env(CHILD_FOLDER, folder)
        .env(RECOVERY_MS, interval.as_millis().to_string())
        .env("HANDEYE_TEST_SAVE_EVERY", save_every.to_string())
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .expect("started")
}

fn edit_of(line: &str) -> Option<(u64, u128)> {
    let mut words = line.split("edit ").nth(1)?.split_whitespace();
    Some((words.next()?.parse().ok()?, words.next()?.parse().ok()?))
}

/// What of a killed child's work is there afterwards.
struct Survived {
    num_edits: u64,
    lost: Duration,
    was_offered: bool,
}

/// Lets a child work for `life` after its first edit, kills it, and looks at what is left.
fn kill_once(folder: &Path, interval: Duration, save_every: u64, life: Duration) -> Survived {
    let path = saved_in(folder);
    let mut child = start_child(folder, interval, save_every);
    let mut lines = BufReader::new(child.stdout.take().expect("a pipe")).lines();
    let mut edits: Vec<(u64, u128)> = Vec::new();
    while edits.is_empty() {
        let line = lines.next().expect("the child works").expect("readable");
        edits.extend(edit_of(&line));
    }
    // Waiting for the child is the subject here.
    std::thread::sleep(life);
    child.kill().expect("killed");
    let killed_us = unix_us();
    edits.extend(lines.map_while(Result::ok).filter_map(|line| edit_of(&line)));
    child.wait().expect("ended");

    // The file is whole, whatever it was doing.
    let in_file = session::load(&path).expect("the file loads after a kill");
    assert_eq!(in_file.stations, measured_session().stations);
    let mut next = Bench::with_recovery(&folder.join("recovery"));
    let expects_offer = fs::read_dir(folder.join("recovery")).is_ok_and(|entries| {
        entries.flatten().any(|entry| entry.path().extension().is_some_and(|extension| extension == "json"))
    });
    if expects_offer {
        next.until("the offer", |workbench| !workbench.recoverable().is_empty());
        assert!(next.workbench.recoverable()[0].origin.is_ok(), "{:?}", next.workbench.recoverable());
        next.workbench.apply(Command::Recover(0));
        next.until("the session", |workbench| workbench.document().is_some());
        assert_eq!(next.workbench.document().and_then(|document| document.path.clone()), Some(path));
    }
    let number = |notes: &str| notes.parse::<u64>().unwrap_or(0);
    let newest = number(&in_file.notes).max(if expects_offer { number(&next.session().notes) } else { 0 });
    let lost = edits.iter().find(|(edit, _)| *edit > newest).map_or(Duration::ZERO, |(_, made_us)| {
        Duration::from_micros(u64::try_from(killed_us.saturating_sub(*made_us)).expect("a short time"))
    });
    Survived { num_edits: edits.last().map_or(0, |(edit, _)| *edit), lost, was_offered: expects_offer }
}

/// With the usual interval of 3 s at most 10 s may be lost. For a quick test the interval is 30 ms; what is added to it,
/// the time of writing a copy, does not shrink with it. So the limit is the interval and the 7 s that are left for a
/// copy on a slow disk; what is really lost is told, and is about the interval.
#[test]
fn killed_at_any_moment_it_leaves_a_whole_file_and_the_newest_work() {
    let num_kills = from_environment(KILLS, 4);
    let interval = Duration::from_millis(from_environment(RECOVERY_MS, 30));
    let limit = interval + Duration::from_secs(10).saturating_sub(INTERVAL);
    let mut random = Pcg64Mcg::seed_from_u64(4);
    let (mut longest, mut total, mut num_offers, mut num_edits) = (Duration::ZERO, Duration::ZERO, 0, 0);
    for kill in 0..num_kills {
        let folder = tempfile::tempdir().expect("a folder");
        // Half of the children save all the time, the others hardly ever.
        let save_every = if kill % 2 == 0 { 3 } else { 1_000_000 };
        let most_ms = u32::try_from(interval.as_millis()).expect("short") * 3 + 200;
        let life = Duration::from_millis(u64::from(random.next_u32() % most_ms));
        let survived = kill_once(folder.path(), interval, save_every, life);
        assert!(survived.lost <= limit, "kill {kill}: {:?} lost after {life:?}", survived.lost);
        longest = longest.max(survived.lost);
        total += survived.lost;
        num_offers += u64::from(survived.was_offered);
        num_edits += survived.num_edits;
    }
    println!(
        "{num_kills} kills, copies every {interval:?}: every file whole, {num_edits} edits made, {num_offers} copies \
         recovered, longest loss {longest:?}, mean {:?}",
        total / u32::try_from(num_kills.max(1)).expect("few")
    );
}

// Recovery.

fn leave_behind(folder: &Path, edit: impl FnOnce(&mut Bench)) {
    let mut bench = Bench::with_recovery(folder);
    edit(&mut bench);
    // The end of the workbench without the user's wish, as a panic ends it.
    drop(bench);
}

fn offers(bench: &mut Bench) -> Vec<Recoverable> {
    bench.until("offers", |workbench| !workbench.recoverable().is_empty());
    bench.workbench.recoverable().to_vec()
}

fn names_in(folder: &Path) -> Vec<PathBuf> {
    fs::read_dir(folder).map_or_else(|_| Vec::new(), |entries| entries.flatten().map(|entry| entry.path()).collect())
}

#[test]
fn what_a_crash_leaves_behind_is_offered_once_and_kept_until_it_is_saved() {
    let folder = tempfile::tempdir().expect("a folder");
    let recovery = folder.path().join("recovery");
    let path = saved_in(folder.path());
    leave_behind(&recovery, |bench| {
        bench.apply(Command::Open(path.clone()));
        bench.set_notes("a");
        bench.set_notes("not saved");
    });
    assert_eq!(session::load(&path).expect("loads").notes, "");

    let mut bench = Bench::with_recovery(&recovery);
    let found = offers(&mut bench);
    let origin = found[0].origin.as_ref().expect("readable");
    assert_eq!((found.len(), origin.title.as_str(), origin.num_edits), (1, "cell-3.json", 2));
    assert_eq!((origin.path.as_ref(), origin.last_edit.as_deref()), (Some(&path), Some("change the notes")));
    // The copy is a session file that any program of ours opens.
    assert_eq!(session::load(&found[0].file).expect("loads").notes, "not saved");

    // Another program at the same time is not offered what this one is about to decide on, and leaves it alone.
    let other = Bench::with_recovery(&recovery);
    drop(other);
    assert!(found[0].file.exists());

    bench.workbench.apply(Command::Recover(0));
    bench.until("the session", |workbench| workbench.document().is_some() && workbench.recoverable().is_empty());
    assert_eq!(bench.session().notes, "not saved");
    assert!(bench.is_unsaved());
    assert!(!found[0].file.exists(), "this run keeps a copy of its own");
    assert_eq!(names_in(&recovery).len(), 2, "that copy and its lock");

    bench.apply(Command::Save);
    assert!(!bench.is_unsaved());
    assert_eq!(session::load(&path).expect("loads"), *bench.session());
    drop(bench);
    assert_eq!(names_in(&recovery), Vec::<PathBuf>::new(), "nothing is left once it is saved");
}

#[test]
fn a_recovered_session_does_not_replace_what_was_written_meanwhile() {
    let folder = tempfile::tempdir().expect("a folder");
    let recovery = folder.path().join("recovery");
    let path = saved_in(folder.path());
    leave_behind(&recovery, |bench| {
        bench.apply(Command::Open(path.clone()));
        bench.set_notes("mine");
    });
    session::save(&Session::new(Target::Point), &path).expect("saved by another");
    let mut bench = Bench::with_recovery(&recovery);
    offers(&mut bench);
    bench.workbench.apply(Command::Recover(0));
    bench.until("the session", |workbench| workbench.document().is_some());
    bench.apply(Command::Save);
    assert_eq!(bench.workbench.conflict(), Some(&*path));
    assert_eq!(session::load(&path).expect("loads").target, Target::Point);
}

#[test]
fn unreadable_copies_are_named_and_only_the_user_discards_them() {
    let folder = tempfile::tempdir().expect("a folder");
    let broken = folder.path().join("1-1-0.json");
    fs::write(&broken, "{ half a ses").expect("written");
    let mut bench = Bench::with_recovery(folder.path());
    let found = offers(&mut bench);
    let sentence = found[0].origin.as_ref().expect_err("broken").to_string();
    assert!(sentence.contains("1-1-0.json"), "{sentence}");
    bench.workbench.apply(Command::Recover(0));
    bench.until("the refusal", |workbench| !workbench.notices().is_empty());
    assert!(broken.exists());
    bench.workbench.apply(Command::DiscardRecoverable(0));
    bench.until("the end of the offer", |workbench| workbench.recoverable().is_empty());
    drop(bench);
    assert_eq!(names_in(folder.path()), Vec::<PathBuf>::new());
}

#[test]
fn what_the_user_gives_up_is_not_offered_again() {
    let folder = tempfile::tempdir().expect("a folder");
    leave_behind(folder.path(), |bench| {
        bench.workbench.open_unsaved_session(measured_session());
        bench.apply(Command::CloseDocument);
    });
    leave_behind(folder.path(), |bench| {
        bench.workbench.open_unsaved_session(measured_session());
        bench.workbench.end();
    });
    leave_behind(folder.path(), |bench| {
        // Undone up to what is in the file, nothing is unsaved.
        bench.apply(Command::OpenSample(0));
        bench.set_notes("x");
        bench.apply(Command::Undo);
    });
    assert_eq!(names_in(folder.path()), Vec::<PathBuf>::new());
    // A new session that is not empty is worth a copy at once.
    leave_behind(folder.path(), |bench| bench.workbench.open_unsaved_session(measured_session()));
    assert_eq!(names_in(folder.path()).len(), 2);
}

#[test]
fn a_copy_that_cannot_be_written_is_told_once() {
    let folder = tempfile::tempdir().expect("a folder");
    // A file where the folder should be: no rights are needed to make that fail.
    let no_folder = folder.path().join("file");
    fs::write(&no_folder, "").expect("written");
    let mut bench = Bench::with_recovery(&no_folder);
    bench.apply(Command::OpenSample(0));
    bench.set_notes("a");
    bench.until("the notice", |workbench| !workbench.notices().is_empty());
    for notes in ["b", "c", "d"] {
        bench.set_notes(notes);
    }
    assert_eq!(bench.workbench.notices().len(), 1);
    assert!(bench.last_error().contains("no recovery copy could be written"), "{}", bench.last_error());
}

// Files.

#[test]
fn a_file_that_another_program_changed_is_not_replaced_unasked() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = saved_in(folder.path());
    let others = Session { notes: "theirs".to_owned(), ..measured_session() };
    let on_disk = |bench: &Bench| bench.workbench.document().expect("open").on_disk;
    let mut bench = Bench::new();
    bench.apply(Command::Open(path.clone()));
    bench.set_notes("mine");
    session::save(&others, &path).expect("saved by another");
    bench.apply(Command::CheckFile);
    assert_eq!(on_disk(&bench), OnDisk::Changed);

    bench.apply(Command::Save);
    assert_eq!(bench.workbench.conflict(), Some(&*path));
    assert_eq!(session::load(&path).as_ref(), Ok(&others));
    bench.apply(Command::GiveUpSaving);
    assert!(bench.workbench.conflict().is_none() && bench.is_unsaved());

    bench.apply(Command::Reload);
    assert_eq!((bench.session(), on_disk(&bench), bench.is_unsaved()), (&others, OnDisk::Same, false));
    let label = bench.workbench.document().and_then(|document| document.history.undo_label());
    assert_eq!(label, Some("reload from disk"));
    bench.apply(Command::Undo);
    assert_eq!(bench.session().notes, "mine");
    assert!(bench.is_unsaved());

    session::save(&measured_session(), &path).expect("saved by another");
    bench.apply(Command::Save);
    bench.apply(Command::SaveAnyway);
    assert!(bench.workbench.conflict().is_none() && !bench.is_unsaved());
    assert_eq!(session::load(&path).expect("loads").notes, "mine");
    // Two saves of our own in a row are no change by another.
    bench.workbench.apply(Command::Save);
    bench.apply(Command::Save);
    assert!(bench.workbench.conflict().is_none());
}

#[test]
fn a_touched_file_is_the_same_and_a_deleted_one_is_written_again() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = saved_in(folder.path());
    let on_disk = |bench: &Bench| bench.workbench.document().expect("open").on_disk;
    let mut bench = Bench::new();
    bench.apply(Command::Open(path.clone()));
    let file = fs::OpenOptions::new().write(true).open(&path).expect("writable");
    file.set_modified(SystemTime::UNIX_EPOCH).expect("touched");
    bench.apply(Command::CheckFile);
    assert_eq!(on_disk(&bench), OnDisk::Same);
    fs::remove_file(&path).expect("removed");
    bench.apply(Command::CheckFile);
    assert_eq!(on_disk(&bench), OnDisk::Gone);
    bench.apply(Command::Save);
    let told = &bench.workbench.notices().last().expect("told").message;
    assert!(told.contains("it had been deleted or moved"), "{told}");
    assert_eq!(on_disk(&bench), OnDisk::Same);
    assert_eq!(session::load(&path).as_ref(), Ok(bench.session()));
}

#[test]
fn a_read_only_file_stays_and_says_so() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = saved_in(folder.path());
    let mut permissions = fs::metadata(&path).expect("there").permissions();
    permissions.set_readonly(true);
    fs::set_permissions(&path, permissions).expect("set");
    let mut bench = Bench::new();
    bench.apply(Command::Open(path.clone()));
    assert!(bench.workbench.document().expect("open").is_read_only);
    bench.set_notes("mine");
    bench.apply(Command::Save);
    assert!(bench.last_error().contains("it is read-only; use \"Save as…\""), "{}", bench.last_error());
    assert_eq!(session::load(&path).as_ref(), Ok(&measured_session()));
    let other = folder.path().join("other.json");
    bench.apply(Command::SaveAs(other.clone()));
    let document = bench.workbench.document().expect("open");
    assert!(!document.is_read_only && document.path == Some(other));
}

#[test]
fn a_folder_that_is_not_there_is_named() {
    let folder = tempfile::tempdir().expect("a folder");
    let refusal = session::save(&measured_session(), &folder.path().join("no/cell.json")).expect_err("no folder");
    assert!(refusal.to_string().contains("this folder is not there. Save in another one"), "{refusal}");
}

/// Saves where the disk is full, which a limit on the size of files stands for.
#[test]
fn child_that_saves_to_a_full_disk() {
    let Some(path) = std::env::var_os("HANDEYE_TEST_FULL_DISK").map(PathBuf::from) else { return };
    let mut longer = measured_session();
    longer.notes = "longer".repeat(10_000);
    println!("refusal: {}", session::save(&longer, &path).expect_err("no room"));
}

#[cfg(unix)]
#[test]
fn on_a_full_disk_the_old_file_stays_whole_and_the_user_is_told() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = saved_in(folder.path());
    // No special rights are needed: beyond 64 blocks of 512 or 1024 bytes writing fails, and its signal is ignored.
    let child = Process::new("sh")
        .args(["-c", "trap '' XFSZ; ulimit -f 64; exec \"$0\" \"$@\""])
        .arg(std::env::current_exe().expect("this program"))
        .args(["--exact", "child_that_saves_to_a_full_disk", "--nocapture"])
        .env("HANDEYE_TEST_FULL_DISK", &path)
        .output()
        .expect("run");
    let told = String::from_utf8_lossy(&child.stdout);
    assert!(child.status.success(), "{told}{}", String::from_utf8_lossy(&child.stderr));
    for words in ["cannot save", "cell-3.json", "a file that was there is as it was. Free some space"] {
        assert!(told.contains(words), "{told}");
    }
    assert_eq!(session::load(&path), Ok(measured_session()));
    assert_eq!(temporaries(folder.path()), Vec::<PathBuf>::new());
}

#[cfg(unix)]
#[test]
fn a_folder_that_may_not_be_written_to_is_named() {
    use std::os::unix::fs::PermissionsExt as _;
    let folder = tempfile::tempdir().expect("a folder");
    let locked = folder.path().join("locked");
    fs::create_dir(&locked).expect("made");
    fs::set_permissions(&locked, fs::Permissions::from_mode(0o555)).expect("set");
    match session::save(&measured_session(), &locked.join("cell.json")) {
        Err(refusal @ SessionError::Unwritable { .. }) => {
            assert!(refusal.to_string().contains("you may not write in this folder"), "{refusal}");
        }
        // Permissions do not hold an administrator back, so there is nothing to be seen then.
        outcome => assert!(outcome.is_ok() && fs::write(locked.join("probe"), "").is_ok(), "{outcome:?}"),
    }
}
