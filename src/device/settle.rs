//! When a capture counts: the move has ended, the robot stands still, and the profile is later than that.

use serde::{Deserialize, Serialize};

use crate::geometry::{Base, Flange, Transform};

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

impl SettleSettings {
    /// How far the robot has moved between the pose before a profile and that after it, mm; `None` if it stood still.
    #[must_use]
    pub fn moved_mm(&self, before: &Transform<Base, Flange>, after: &Transform<Base, Flange>) -> Option<f64> {
        let moved_mm = (after.translation_mm() - before.translation_mm()).norm();
        let turned_deg = before.rotation().angle_to(&after.rotation()).to_degrees();
        // A number that is none is no standing still.
        let is_still = moved_mm <= self.still_mm && turned_deg <= self.still_deg;
        (!is_still).then_some(moved_mm)
    }
}

/// Whether the profile with a trigger count was taken later than the one with another: the counts wrap around.
#[must_use]
pub const fn is_later(trigger_count: u32, than: u32) -> bool {
    let ahead = trigger_count.wrapping_sub(than);
    ahead != 0 && ahead < 1 << 31
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Vec3, so3};

    #[test]
    fn counts_are_later_across_the_wrap() {
        for (count, than, expected) in [
            (1, 0, true),
            (0, 0, false),
            (0, 1, false),
            (0, u32::MAX, true),
            (5, u32::MAX - 5, true),
            (u32::MAX, 0, false),
            (1 << 31, 0, false),
            ((1 << 31) - 1, 0, true),
        ] {
            assert_eq!(is_later(count, than), expected, "{count} than {than}");
        }
    }

    #[test]
    fn a_shift_or_a_turn_is_no_standing_still() {
        let settings = SettleSettings::default();
        let at = |x: f64, turn_deg: f64| {
            Transform::from_parts(Vec3::new(x, 0.0, 0.0), so3::exp(Vec3::z() * turn_deg.to_radians()))
        };
        for (x, turn_deg, is_still) in
            [(0.0, 0.0, true), (0.04, 0.01, true), (0.06, 0.0, false), (0.0, 0.03, false), (f64::NAN, 0.0, false)]
        {
            assert_eq!(settings.moved_mm(&at(0.0, 0.0), &at(x, turn_deg)).is_none(), is_still, "{x} mm, {turn_deg}°");
        }
    }
}
