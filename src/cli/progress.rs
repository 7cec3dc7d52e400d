//! Progress of a command, shown on a terminal.

use std::fmt::Display;
use std::io::IsTerminal as _;

use crate::watch::{Cancelled, Watch};

/// Shows progress on a terminal and nowhere else.
struct TerminalProgress {
    what: &'static str,
    is_terminal: bool,
    shown: bool,
}

impl TerminalProgress {
    fn new(what: &'static str) -> Self {
        Self { what, is_terminal: std::io::stderr().is_terminal(), shown: false }
    }

    fn clear(&mut self) {
        if self.shown {
            eprint!("\r\x1b[K");
            self.shown = false;
        }
    }
}

impl Watch for TerminalProgress {
    fn report(&mut self, done: usize, total: usize) -> Result<(), Cancelled> {
        if self.is_terminal {
            eprint!("\r{} {done}/{total}\x1b[K", self.what);
            self.shown = true;
        }
        Ok(())
    }
}

/// Does something with its progress shown on a terminal.
pub(super) fn watched<T, E: Display>(
    what: &'static str,
    job: impl FnOnce(&mut dyn Watch) -> Result<T, E>,
) -> Result<T, String> {
    let mut progress = TerminalProgress::new(what);
    let outcome = job(&mut progress);
    progress.clear();
    outcome.map_err(|error| error.to_string())
}
