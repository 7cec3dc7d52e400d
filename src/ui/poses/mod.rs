//! Step Poses: the stations in the robot's own convention, edited as in a spreadsheet.

mod ask;
mod cells;
mod checks;
mod clipboard;
pub mod convention;
mod cursor;
mod editor;
mod grid;
mod keys;
pub mod model;
pub mod panel;
mod pending;
mod sheet;
mod toolbar;
mod view;
