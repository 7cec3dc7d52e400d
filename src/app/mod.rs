//! The workbench behind the window: document, history, results, jobs and notices. It knows no widgets, so that tests,
//! the command line and the window drive the same thing.

pub mod command;
pub mod compare;
pub mod jobs;
pub mod study;
pub mod workbench;

pub use command::Command;
pub use study::{Found, Study};
pub use workbench::{Document, Notice, NoticeKind, Progress, Results, Workbench};
