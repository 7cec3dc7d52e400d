//! What the cell answers, one file a protocol. The messages are those of the drivers.

pub mod ljv;
pub mod mappdk;
