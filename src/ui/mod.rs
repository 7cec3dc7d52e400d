//! The window: egui panels over the [`Workbench`], the only code that names egui.
//!
//! Every panel is a function of the shared [`PanelContext`] and a state of its own; it queues commands and changes
//! nothing itself. A step of the rail is a folder with its panel, the model it draws, and the painting.

pub mod actions;
pub mod arcs;
pub mod capture;
pub mod charts;
pub mod cloud;
pub mod compare;
pub mod diagnosis;
pub mod dialogs;
pub mod eye;
pub mod file_dialog;
pub mod history;
pub mod import;
pub mod inspector;
pub mod persisted;
pub mod poses;
pub mod rail;
pub mod report;
pub mod save_file;
pub mod save_picture;
pub mod screenshot;
pub mod sequence;
pub mod shell;
pub mod software_renderer;
pub mod start;
pub mod status;
pub mod theme;
pub mod top_bar;
pub mod verdict;
pub mod verify;
pub mod widgets;
pub mod window;

pub use rail::Step;
pub use screenshot::{ScreenshotError, screenshot};
pub use shell::Shell;
pub use window::{Start, Window, WindowError, run};

use crate::app::{Command, Workbench};
use crate::calibrate::Method;

use actions::Action;

/// What the user looks at; shared by all panels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Selection {
    /// Index of the station.
    pub station_idx: usize,
    /// Index of the capture in its station.
    pub capture_idx: usize,
    /// The method whose matrix the inspector shows.
    pub method: Method,
}

impl Default for Selection {
    fn default() -> Self {
        Self { station_idx: 0, capture_idx: 0, method: Method::BallMaxArc }
    }
}

/// What a panel gets to draw from, and where it puts what the user asks for.
pub struct PanelContext<'a> {
    /// Document, results, jobs and notices.
    pub workbench: &'a Workbench,
    /// What the user looks at.
    pub selection: &'a mut Selection,
    /// Commands, applied in order after the frame.
    pub commands: &'a mut Vec<Command>,
    /// What the window itself is to do, e.g. go to another step.
    pub actions: &'a mut Vec<Action>,
}
