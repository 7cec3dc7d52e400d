//! When a capture counts: the move has ended, the robot stands still, and the profile is later than that.

use serde::{Deserialize, Serialize};

/// What a settled capture asks for.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct SettleSettings {
    /// Wait after the move, ms.
    pub settle_ms: u32,
    /// How far the pose before the profile and that after it may be apart, mm.
    pub still_mm: f64,
    /// The same for the orientation, degrees.
    pub still_deg: f64,
    /// Profiles that are averaged to one.
    pub num_profiles: u16,
    /// How often a capture that did not stand still is tried again.
    pub num_retries: u8,
}

impl Default for SettleSettings {
    fn default() -> Self {
        Self { settle_ms: 200, still_mm: 0.05, still_deg: 0.02, num_profiles: 1, num_retries: 3 }
    }
}
