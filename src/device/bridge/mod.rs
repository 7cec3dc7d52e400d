//! The text bridge: JSON, one message a line, over TCP, for robots and profilers that have no driver of their own.
//! `docs/bridge.md` describes it for whoever writes the other side.

mod connection;
pub mod messages;

pub use connection::BridgeConnection;
