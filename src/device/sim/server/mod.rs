//! What the cell answers, one file a protocol. The messages are those of the drivers.

pub mod bridge;
pub mod curpos;
pub mod ljv;
pub mod mappdk;
pub mod ur_dashboard;
pub mod ur_rtde;
pub mod ur_script;
