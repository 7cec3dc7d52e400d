//! Files that appear, grow, are renamed, written over, deleted and broken. The clock is told, so nothing waits.

use tempfile::TempDir;

use super::*;
use crate::device::setup::{Endpoint, SensorKind};

const NO_HURRY: Duration = Duration::from_mins(1);

struct Bench {
    folder: TempDir,
    driver: FolderDriver,
    now: Instant,
}

impl Bench {
    fn new(before: &[(&str, &str)]) -> Self {
        let folder = TempDir::new().expect("a folder");
        for (name, text) in before {
            fs::write(folder.path().join(name), text).expect("written");
        }
        let setup = SensorSetup {
            kind: SensorKind::Folder,
            endpoint: Endpoint { host: String::new(), port: 0 },
            folder: folder.path().to_owned(),
            is_z_inverted: false,
        };
        let now = Instant::now();
        let driver = FolderDriver::connect(&setup, now + NO_HURRY).expect("connected");
        // The driver begins by the real clock.
        Self { folder, driver, now: Instant::now() }
    }

    fn write(&self, name: &str, text: &str) {
        fs::write(self.folder.path().join(name), text).expect("written");
    }

    fn poll(&mut self) -> Result<Option<ProfileReading>, DeviceError> {
        self.driver.newest_at(self.now, Instant::now() + NO_HURRY)
    }

    fn forget(&mut self) {
        self.driver.forget_at(self.now, Instant::now() + NO_HURRY).expect("forgotten");
    }

    /// What is there once nothing has changed for long enough.
    fn settled(&mut self) -> Result<Option<ProfileReading>, DeviceError> {
        self.poll()?;
        self.now += QUIET;
        self.poll()
    }

    #[track_caller]
    fn check_newest(&mut self, first_z: f64, count: u32) {
        let reading = self.settled().expect("no error").expect("a profile");
        assert_eq!((reading.profile.z_mm()[0], reading.trigger_count), (first_z, count));
    }
}

fn sheet(first_z: f64) -> String {
    format!("x,z\n0,{first_z}\n0.1,5\n0.2,\n")
}

#[test]
fn files_count_from_the_connection_on() {
    let mut bench = Bench::new(&[("p1.csv", &sheet(1.0)), ("p2.csv", &sheet(2.0))]);
    assert_eq!(bench.settled(), Ok(None));
    bench.write("p3.csv", &sheet(3.0));
    bench.check_newest(3.0, 1);
    // Nothing new: the same profile with the same count.
    bench.check_newest(3.0, 1);
    bench.write("p4.csv", &sheet(4.0));
    bench.check_newest(4.0, 2);
}

#[test]
fn of_several_the_last_by_number_is_the_newest_and_each_counts() {
    let mut bench = Bench::new(&[]);
    let time = SystemTime::now();
    for idx in [9, 10, 2] {
        let name = format!("scan_{idx}.csv");
        bench.write(&name, &sheet(f64::from(idx)));
        let file = File::options().write(true).open(bench.folder.path().join(name)).expect("open");
        file.set_modified(time).expect("set");
    }
    bench.check_newest(10.0, 3);
}

#[test]
fn a_file_under_way_is_left_alone_until_it_stands_still() {
    let mut bench = Bench::new(&[]);
    let whole = sheet(7.0);
    for len in (4..whole.len()).step_by(5) {
        bench.write("p.csv", &whole[..len]);
        assert_eq!(bench.poll(), Ok(None));
        bench.now += QUIET / 2;
        assert_eq!(bench.poll(), Ok(None));
    }
    bench.write("p.csv", &whole);
    bench.check_newest(7.0, 1);
}

#[test]
fn a_file_that_is_renamed_when_it_is_whole_appears_then() {
    let mut bench = Bench::new(&[]);
    for name in [".p.csv", "p.csv.tmp", "~p.csv", "picture.png", "notes"] {
        bench.write(name, &sheet(1.0));
    }
    fs::create_dir(bench.folder.path().join("folder.csv")).expect("made");
    assert_eq!(bench.settled(), Ok(None));
    fs::rename(bench.folder.path().join("p.csv.tmp"), bench.folder.path().join("p.csv")).expect("renamed");
    bench.check_newest(1.0, 1);
}

#[test]
fn one_file_written_over_and_over_is_a_new_profile_each_time() {
    let mut bench = Bench::new(&[("latest.csv", &sheet(0.5))]);
    bench.now += QUIET;
    assert_eq!(bench.settled(), Ok(None));
    for (idx, first_z) in [(1, 10.0), (2, 200.0), (3, 3000.0)] {
        bench.write("latest.csv", &sheet(first_z));
        bench.check_newest(first_z, idx);
    }
}

#[test]
fn what_is_forgotten_does_not_come_back_even_if_it_is_still_being_written() {
    let mut bench = Bench::new(&[]);
    bench.write("p1.csv", &sheet(1.0));
    bench.check_newest(1.0, 1);
    bench.write("p2.csv", "x,z\n0,2\n");
    assert_eq!(bench.poll().map(|reading| reading.map(|reading| reading.trigger_count)), Ok(Some(1)));
    bench.forget();
    assert_eq!(bench.poll(), Ok(None));
    bench.now += QUIET / 3;
    bench.write("p2.csv", &sheet(2.0));
    assert_eq!(bench.settled(), Ok(None));
    bench.write("p3.csv", &sheet(3.0));
    bench.check_newest(3.0, 2);
}

#[test]
fn a_name_can_be_used_again_after_its_file_is_gone() {
    let mut bench = Bench::new(&[("p1.csv", &sheet(1.0)), ("p2.csv", &sheet(2.0))]);
    fs::remove_file(bench.folder.path().join("p1.csv")).expect("removed");
    bench.write("p3.csv", &sheet(3.0));
    bench.check_newest(3.0, 1);
    bench.write("p1.csv", &sheet(1.5));
    bench.check_newest(1.5, 2);
}

#[test]
fn a_file_without_a_profile_gets_some_time_and_is_told_then() {
    for (text, found) in [
        ("", "nothing"),
        ("no numbers here\n", "no row of numbers"),
        ("1,2,3,4,5,6\n2,3,4,5,6,7\n", "6 columns"),
        ("x [parsec],z\n1,2\n", "parsec"),
    ] {
        let mut bench = Bench::new(&[]);
        bench.write("p.csv", text);
        assert_eq!(bench.settled(), Ok(None));
        bench.now += PATIENCE;
        let error = bench.poll().expect_err("no profile");
        // The connection stands, or nobody would see the message for longer than a reconnection takes.
        assert!(error.leaves_connection_usable(), "{error}");
        assert!(error.to_string().contains("p.csv") && error.to_string().contains(found), "{error}");
        assert_eq!(bench.poll(), Err(error));
        bench.now += TOLD_FOR;
        assert_eq!(bench.poll(), Ok(None));
        bench.write("q.csv", &sheet(1.0));
        bench.check_newest(1.0, 1);
    }
}

#[test]
fn a_file_that_is_too_large_is_refused_unread() {
    let mut bench = Bench::new(&[]);
    let file = File::create(bench.folder.path().join("p.csv")).expect("made");
    file.set_len(MAX_FILE_BYTES + 1).expect("grown");
    assert_eq!(bench.settled(), Ok(None));
    bench.now += PATIENCE;
    let error = bench.poll().expect_err("too large").to_string();
    assert!(error.contains("more than 16 MiB"), "{error}");
}

#[test]
fn a_folder_that_vanishes_is_told_with_a_remedy() {
    let mut bench = Bench::new(&[]);
    fs::remove_dir_all(bench.folder.path()).expect("removed");
    let error = bench.poll().expect_err("no folder");
    assert!(matches!(error, DeviceError::NotConnected { .. }));
    assert!(error.to_string().contains("check that the folder exists"), "{error}");
    let setup = SensorSetup {
        kind: SensorKind::Folder,
        endpoint: Endpoint { host: String::new(), port: 0 },
        folder: bench.folder.path().to_owned(),
        is_z_inverted: false,
    };
    assert!(matches!(FolderDriver::connect(&setup, bench.now + NO_HURRY), Err(DeviceError::NotConnected { .. })));
}

#[test]
fn old_files_are_not_looked_at_again() {
    let mut bench = Bench::new(&[]);
    for idx in 0..500 {
        bench.write(&format!("old{idx}.csv"), "x,z\n0,1\n");
    }
    bench.forget();
    assert_eq!(bench.driver.seen.len(), 500);
    bench.write("new.csv", &sheet(8.0));
    bench.check_newest(8.0, 1);
    assert_eq!(bench.driver.fresh.len(), 0);
}

#[test]
fn z_is_turned_about_where_it_is_asked_for() {
    let mut bench = Bench::new(&[]);
    bench.driver.z_sign = -1.0;
    bench.write("p.csv", &sheet(8.0));
    bench.check_newest(-8.0, 1);
}

#[test]
fn a_folder_that_stands_still_is_not_listed() {
    let mut bench = Bench::new(&[("p1.csv", &sheet(1.0))]);
    let listed_at = |bench: &Bench| bench.driver.time.as_ref().expect("a time").listed_at;
    bench.now += COARSEST_TIME;
    assert_eq!(bench.poll(), Ok(None));
    let listed = listed_at(&bench);
    assert_eq!(listed, bench.now);
    bench.now += LIST_EVERY / 2;
    assert_eq!(bench.poll(), Ok(None));
    assert_eq!(listed_at(&bench), listed);
    // A file that is written over changes nothing in the folder, and a new one does.
    bench.write("p1.csv", &sheet(20.0));
    bench.check_newest(20.0, 1);
    bench.write("p2.csv", &sheet(3.0));
    bench.check_newest(3.0, 2);
    bench.now += LIST_EVERY;
    let due = bench.now;
    bench.check_newest(3.0, 2);
    assert!(listed_at(&bench) >= due);
}
