//! FANUC by its web page `CURPOS.DG`: reads only.

mod driver;
pub mod http;
pub mod page;

pub use driver::CurposRobot;
