//! The system's file dialog, on a thread of its own: it blocks until the user is done.

use std::path::PathBuf;
use std::sync::mpsc::{Receiver, TryRecvError, sync_channel};
use std::thread;
use std::time::{Duration, Instant};

use crate::app::jobs::Wake;
use crate::text::shell as words;

/// Nobody cancels a dialog faster than this; so quick a "nothing chosen" means that no dialog came up.
const FASTEST_CANCEL: Duration = Duration::from_millis(500);

/// What the dialog is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// Choosing a file to read.
    Open,
    /// Choosing a file to write.
    Save,
}

/// What came of a dialog.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Answer {
    /// A file was chosen.
    Chosen(Purpose, PathBuf),
    /// The user thought better of it.
    Cancelled,
    /// The system has no dialog to offer.
    Unavailable(Purpose),
}

/// At most one dialog at a time.
#[derive(Debug, Default)]
pub struct FileDialog {
    waiting: Option<(Purpose, Receiver<Answer>)>,
}

impl FileDialog {
    /// Shows a dialog unless one is up; `suggested_name` is for saving.
    pub fn start(&mut self, purpose: Purpose, suggested_name: String, wake: Wake) {
        if self.waiting.is_some() {
            return;
        }
        let (sender, receiver) = sync_channel(1);
        self.waiting = Some((purpose, receiver));
        if !is_available() {
            // Room for one answer, and the receiver is at hand.
            sender.send(Answer::Unavailable(purpose)).ok();
            wake();
            return;
        }
        // If no thread is to be had, the sender is dropped, which `poll` reads as no dialog.
        thread::Builder::new()
            .name("file dialog".to_owned())
            .spawn(move || {
                // The window may have been closed meanwhile; then nobody wants the answer.
                sender.send(ask(purpose, &suggested_name)).ok();
                wake();
            })
            .ok();
    }

    /// The answer, once.
    pub fn poll(&mut self) -> Option<Answer> {
        let (purpose, receiver) = self.waiting.as_ref()?;
        let answer = match receiver.try_recv() {
            Ok(answer) => answer,
            Err(TryRecvError::Empty) => return None,
            Err(TryRecvError::Disconnected) => Answer::Unavailable(*purpose),
        };
        self.waiting = None;
        Some(answer)
    }

    /// Whether a dialog is up.
    #[must_use]
    pub const fn is_open(&self) -> bool {
        self.waiting.is_some()
    }
}

fn ask(purpose: Purpose, suggested_name: &str) -> Answer {
    let start = Instant::now();
    let dialog = rfd::FileDialog::new().add_filter(words::FILE_FILTER, &["json"]);
    let chosen = match purpose {
        Purpose::Open => dialog.pick_file(),
        Purpose::Save => dialog.set_file_name(suggested_name).save_file(),
    };
    match chosen {
        Some(path) => Answer::Chosen(purpose, path),
        None if start.elapsed() < FASTEST_CANCEL => Answer::Unavailable(purpose),
        None => Answer::Cancelled,
    }
}

/// Whether a dialog can be expected to come up: a message bus for the portal, or the program `zenity`.
#[cfg(target_os = "linux")]
fn is_available() -> bool {
    let has_bus = std::env::var_os("DBUS_SESSION_BUS_ADDRESS").is_some_and(|address| !address.is_empty())
        || std::env::var_os("XDG_RUNTIME_DIR").is_some_and(|dir| PathBuf::from(dir).join("bus").exists());
    let has_zenity = || {
        std::env::var_os("PATH").is_some_and(|path| std::env::split_paths(&path).any(|dir| dir.join("zenity").exists()))
    };
    has_bus || has_zenity()
}

#[cfg(not(target_os = "linux"))]
const fn is_available() -> bool {
    true
}
