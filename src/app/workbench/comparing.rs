//! Calibrations held against each other, and those of a folder over time.

use std::path::PathBuf;

use crate::app::study::Study;
use crate::geometry::Vec3;
use crate::report::result_history::{
    Comparison, History, NotCompared, compared, compared_session, read_compared, read_history,
};
use crate::session::measure;
use crate::text::compare_results as words;
use crate::watch::Cancelled;

use super::Workbench;

/// Where a calibration comes from that is compared.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Side {
    /// The session on the bench: its answer.
    OpenSession,
    /// A result file, a matrix or a session.
    File(PathBuf),
}

/// What is to be compared.
#[derive(Clone, Debug, PartialEq)]
pub struct Sides {
    /// The one that is compared with.
    pub from: Side,
    /// The one that is compared.
    pub to: Side,
    /// Points of the sensor frame at which they are compared too, mm.
    pub points_in_sensor_mm: Vec<Vec3>,
}

impl Sides {
    /// Whether the session on the bench is one of them, so that edits put the comparison out of date.
    #[must_use]
    pub fn has_open_session(&self) -> bool {
        [&self.from, &self.to].contains(&&Side::OpenSession)
    }
}

/// What came of a comparison.
#[derive(Clone, Debug)]
pub struct Compared {
    /// What was asked for.
    pub sides: Sides,
    /// What was found.
    pub outcome: Result<Comparison, NotCompared>,
}

/// What came of a folder.
#[derive(Clone, Debug)]
pub struct FolderRead {
    /// The folder.
    pub folder: PathBuf,
    /// What was found in it.
    pub outcome: Result<History, NotCompared>,
}

impl Workbench {
    /// Two calibrations held against each other, where it was asked for.
    #[must_use]
    pub const fn comparison(&self) -> &Study<Compared> {
        &self.comparison
    }

    /// The calibrations of a folder over time, where it was asked for.
    #[must_use]
    pub const fn result_history(&self) -> &Study<FolderRead> {
        &self.result_history
    }

    pub(super) fn compare_calibrations(&mut self, sides: Sides) {
        let session = self.document.as_ref().map(|document| {
            let file = document.path.as_ref().and_then(|path| path.file_name());
            let name = file.map_or_else(|| document.session.name.clone(), |name| name.to_string_lossy().into_owned());
            (name, std::sync::Arc::clone(&document.session))
        });
        let known = self.known_readings();
        let revision = self.document.as_ref().map_or(0, |document| document.data_revision);
        self.comparison.start("compare", &self.wake, revision, move |watch| {
            let not_read = |cancelled: Cancelled| NotCompared::NothingComputed(cancelled.to_string());
            let mut read = |side: &Side| match (side, &session) {
                (Side::File(path), _) => read_compared(path, watch),
                (Side::OpenSession, Some((name, session))) => {
                    let measured = measure(session, known.as_deref(), watch).map_err(not_read)?;
                    compared_session(session, &measured, name, watch)
                }
                (Side::OpenSession, None) => Err(NotCompared::Wrong(words::NO_OPEN_SESSION.to_owned())),
            };
            let sides_read = read(&sides.from).and_then(|from| Ok((from, read(&sides.to)?)));
            let outcome = sides_read.and_then(|(from, to)| compared(from, to, &sides.points_in_sensor_mm));
            Ok(Compared { sides, outcome })
        });
    }

    pub(super) fn read_result_history(&mut self, folder: PathBuf) {
        self.result_history.start("read history", &self.wake, 0, move |watch| {
            let outcome = read_history(&folder, watch);
            Ok(FolderRead { folder, outcome })
        });
    }
}
