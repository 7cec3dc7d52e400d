//! The workbench behind the window: document, history, results, jobs and notices. It knows no widgets, so that tests,
//! the command line and the window drive the same thing.

pub mod cell;
pub mod command;
pub mod document;
pub mod jobs;
pub mod recovery;
pub mod study;
pub mod workbench;

pub use cell::{CellCommand, CellSettings, CellView};
pub use command::{Command, ImportInto};
pub use document::{Document, OnDisk};
pub use recovery::{Recoverable, RecoverySettings};
pub use study::{Found, Study};
pub use workbench::{ImportDraft, Notice, NoticeKind, Progress, Results, Workbench};
