//! The page printed to PDF by a browser that is installed: it knows how to break pages better than we could.

use std::fs::File;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use thiserror::Error;

use crate::whole_file;

use super::files::PDF;

/// Browsers that print without a window, by their names on the path.
const BROWSERS: [&str; 8] = [
    "chromium",
    "chromium-browser",
    "google-chrome",
    "google-chrome-stable",
    "chrome",
    "microsoft-edge",
    "microsoft-edge-stable",
    "msedge",
];
/// A page is printed in a second or two; a browser that takes longer hangs.
const DEADLINE: Duration = Duration::from_mins(1);
/// Between looks at whether it is done.
const LOOK_AGAIN: Duration = Duration::from_millis(20);

/// Why there is no PDF.
#[derive(Debug, Error)]
pub enum PdfError {
    /// No browser is installed.
    #[error(
        "found no browser ({}), which prints the page; open report.html in any browser and print it from there",
        BROWSERS.join(", ")
    )]
    NoBrowser,
    /// The page has no place that a browser could be told.
    #[error("cannot tell a browser where {} is: {problem}", file.display())]
    NoPlace {
        /// The page.
        file: PathBuf,
        /// The operating system's words.
        problem: std::io::Error,
    },
    /// The browser printed nothing.
    #[error("{browser} did not print the page: {problem}; open report.html in any browser and print it from there")]
    NotPrinted {
        /// The browser.
        browser: &'static str,
        /// What it said, or how it ended.
        problem: String,
    },
}

/// Prints a page to a PDF file beside it.
///
/// # Errors
/// [`PdfError`].
pub fn print(page: &Path) -> Result<PathBuf, PdfError> {
    let page = page.canonicalize().map_err(|problem| PdfError::NoPlace { file: page.to_path_buf(), problem })?;
    let pdf = page.with_extension("pdf");
    let mut refusal = None;
    for printed in BROWSERS.into_iter().filter_map(|browser| print_with(browser, &page, &pdf)) {
        match printed {
            Ok(pdf) => return Ok(pdf),
            // Another one may do better.
            Err(error) => refusal = refusal.or(Some(error)),
        }
    }
    Err(refusal.unwrap_or(PdfError::NoBrowser))
}

/// `None` if there is no such browser.
fn print_with(browser: &'static str, page: &Path, pdf: &Path) -> Option<Result<PathBuf, PdfError>> {
    let not_printed = |problem: String| Err(PdfError::NotPrinted { browser, problem });
    // A profile of its own, so that a browser that is open does not take the work over. It goes with the folder.
    let profile = match tempfile::tempdir() {
        Ok(profile) => profile,
        Err(error) => return Some(not_printed(error.to_string())),
    };
    let fresh = profile.path().join(PDF);
    // What it says may be long, and a pipe that nobody empties would hold it up.
    let said = profile.path().join("said.txt");
    let stderr = match File::create(&said) {
        Ok(file) => file,
        Err(error) => return Some(not_printed(error.to_string())),
    };
    let mut command = Command::new(browser);
    command
        .args(["--headless", "--disable-gpu", "--no-first-run", "--no-pdf-header-footer"])
        .arg(format!("--user-data-dir={}", profile.path().display()))
        .arg(format!("--print-to-pdf={}", fresh.display()))
        .arg(page)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(stderr);
    let mut running = match command.spawn() {
        Ok(running) => running,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return None,
        Err(error) => return Some(not_printed(error.to_string())),
    };
    let begun = Instant::now();
    let status = loop {
        match running.try_wait() {
            Ok(Some(status)) => break status,
            Ok(None) if begun.elapsed() < DEADLINE => std::thread::sleep(LOOK_AGAIN),
            Ok(None) => {
                // What does not end by itself is ended; whether it had just ended makes no difference.
                let _ = running.kill();
                let _ = running.wait();
                return Some(not_printed(format!("it took more than {} s", DEADLINE.as_secs())));
            }
            Err(error) => return Some(not_printed(error.to_string())),
        }
    };
    let printed = std::fs::read(&fresh);
    Some(match printed.and_then(|bytes| whole_file::replace(pdf, |file| file.write_all(&bytes))) {
        Ok(_) if status.success() => Ok(pdf.to_path_buf()),
        Err(error) if status.success() => not_printed(error.to_string()),
        _ => not_printed(last_line(&said).unwrap_or_else(|| status.to_string())),
    })
}

/// The last thing that the browser said, without the time and place in its code that stand before it.
fn last_line(said: &Path) -> Option<String> {
    let said = std::fs::read(said).ok()?;
    let said = String::from_utf8_lossy(&said);
    let line = said.lines().rev().map(str::trim).find(|line| !line.is_empty())?;
    Some(line.rsplit_once("] ").map_or(line, |(_, message)| message).trim_end_matches('.').to_owned())
}
