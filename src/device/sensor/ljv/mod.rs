//! Keyence LJ-V7000 controllers by their command port: framing and messages, the 20-bit packing, and the driver.

pub mod driver;
pub mod messages;
pub mod packing;
