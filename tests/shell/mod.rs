//! What tests of the command line share: files in a folder of their own, and what a refusal looks like.

use std::fs;
use std::process::{Command, Output};

use handeye::session::{self, Session};

/// Runs the program.
pub fn handeye(command: &str, args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_handeye")).arg(command).args(args).output().expect("the binary starts")
}

/// A folder that goes with the test.
pub struct Files {
    folder: tempfile::TempDir,
}

impl Files {
    pub fn new() -> Self {
        Self { folder: tempfile::tempdir().expect("a folder") }
    }

    pub fn path(&self, name: &str) -> String {
        self.folder.path().join(name).to_str().expect("UTF-8").to_owned()
    }

    pub fn session(&self, name: &str, session: &Session) -> String {
        let path = self.path(name);
        session::save(session, path.as_ref()).expect("written");
        path
    }

    pub fn text(&self, name: &str, text: &str) -> String {
        let path = self.path(name);
        fs::write(&path, text).expect("written");
        path
    }
}

/// Refused with a status and one line that holds these.
#[track_caller]
pub fn assert_refused(output: &Output, status: i32, fragments: &[&str]) {
    let line = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(status), "{line}");
    assert_eq!(line.trim_end().lines().count(), 1, "{line}");
    for fragment in fragments {
        assert!(line.contains(fragment), "{fragment:?} is not in {line:?}");
    }
}
