//! The window: egui panels over the [`Workbench`](crate::app::Workbench), the only code that names egui.
//!
//! Every panel is a function of the shared [`PanelContext`] and a state of its own; it queues commands and changes
//! nothing itself. A step of the rail is a folder with its panel, the model it draws, and the painting.

pub mod arcs;
pub mod charts;
pub mod compare;
pub mod figures;
pub mod theme;
pub mod widgets;

use crate::app::{Command, Workbench};
use crate::calibrate::Method;

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
        Self {
            station_idx: 0,
            capture_idx: 0,
            method: Method::BallMaxArc,
        }
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
}
