//! FANUC by the MAPPDK server: text commands on 18735, the same on 18736 for looking on while a move is under way.

mod driver;
mod line;
pub mod messages;
pub mod route;

pub use driver::MappdkRobot;
