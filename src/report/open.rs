//! A page opened in the program that the user's desktop has for it.

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use thiserror::Error;

/// What tells the desktop to open a file, and what it is told before the file.
const OPENER: (&str, &[&str]) = if cfg!(target_os = "windows") {
    // The empty words are the title of a window, for which `start` would take a path in quotes.
    ("cmd", &["/C", "start", ""])
} else if cfg!(target_os = "macos") {
    ("open", &[])
} else {
    ("xdg-open", &[])
};
/// A refusal comes at once; some openers stay as long as the browser is open.
const REFUSES_WITHIN: Duration = Duration::from_secs(3);
/// Between looks at whether it has ended.
const LOOK_AGAIN: Duration = Duration::from_millis(20);

/// The page was not opened.
#[derive(Debug, Error, PartialEq, Eq)]
#[error("{opener} did not open {page}: {problem}; open it in a browser yourself")]
pub struct NotOpened {
    opener: &'static str,
    page: String,
    problem: String,
}

/// Opens a page.
///
/// # Errors
/// [`NotOpened`] if there is nothing that opens it.
pub fn open(page: &Path) -> Result<(), NotOpened> {
    open_with(OPENER, page)
}

fn open_with((opener, words): (&'static str, &[&str]), page: &Path) -> Result<(), NotOpened> {
    let refused = |problem: String| Err(NotOpened { opener, page: page.display().to_string(), problem });
    let mut command = Command::new(opener);
    command.args(words).arg(page).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    let mut running = match command.spawn() {
        Ok(running) => running,
        Err(error) => return refused(error.to_string()),
    };
    let begun = Instant::now();
    while begun.elapsed() < REFUSES_WITHIN {
        match running.try_wait() {
            Ok(Some(status)) if status.success() => return Ok(()),
            Ok(Some(status)) => return refused(status.to_string()),
            Ok(None) => std::thread::sleep(LOOK_AGAIN),
            Err(error) => return refused(error.to_string()),
        }
    }
    // It ends with the browser, and somebody has to take note of that.
    std::thread::spawn(move || running.wait());
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_does_not_open_says_so() {
        let refused = open_with(("no-such-opener", &[]), Path::new("report.html")).expect_err("there is none");
        let said = refused.to_string();
        assert!(said.starts_with("no-such-opener did not open report.html: "), "{said}");
        assert!(said.ends_with("open it in a browser yourself"), "{said}");
    }

    #[cfg(unix)]
    #[test]
    fn the_opener_is_given_the_page_and_its_answer_counts() {
        let page = tempfile::NamedTempFile::new().expect("a file");
        assert_eq!(open_with(("test", &["-f"]), page.path()), Ok(()));
        assert!(open_with(("test", &["-d"]), page.path()).is_err());
    }
}
