//! The state of a connection. Pure: it is told what happened and when, and says what to do next.

use std::time::Duration;

use super::error::DeviceError;

/// How a connection is.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum LinkState {
    /// Not wanted.
    #[default]
    Off,
    /// Being made.
    Connecting,
    /// Made.
    Ready,
    /// Broken; made anew after a while.
    Failed {
        /// What happened, and what to do.
        error: DeviceError,
        /// How long until it is tried again; `None` where only a person can help.
        retry_in: Option<Duration>,
    },
}
