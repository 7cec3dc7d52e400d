//! What a session's numbers may be. Beyond these limits it is a mistake of units or a broken file.

use std::fmt;

pub(super) use crate::geometry::notation::QUATERNION_NORM_TOLERANCE;

/// A number's meaning and the values it may have, ends included.
#[derive(Clone, Copy, Debug)]
pub(super) struct Quantity {
    pub what: &'static str,
    pub min: f64,
    pub max: f64,
}

impl Quantity {
    pub fn admits(&self, value: f64) -> bool {
        (self.min..=self.max).contains(&value)
    }
}

impl fmt::Display for Quantity {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{} from {} to {}", self.what, self.min, self.max)
    }
}

/// Off unit norm by more, a quaternion was rounded so much that it is worth a note.
pub(super) const QUATERNION_NORM_NOTED: f64 = 1e-6;
/// Off unit norm by less, a quaternion is kept to the bit, so that saving and loading change nothing.
pub(super) const QUATERNION_NORM_EXACT: f64 = 4.0 * f64::EPSILON;

pub(super) const BALL_RADIUS_MM: Quantity = Quantity { what: "a ball's radius in mm", min: 1e-3, max: 1e4 };
pub(super) const LENGTH_STD_MM: Quantity =
    Quantity { what: "a standard deviation in mm (left out where it is not known)", min: 1e-6, max: 100.0 };
pub(super) const ORIENTATION_STD_DEG: Quantity =
    Quantity { what: "a standard deviation in degrees (left out where it is not known)", min: 1e-6, max: 90.0 };
pub(super) const REFERENCE_DISTANCE_MM: Quantity = Quantity { what: "a distance in mm", min: 1e-3, max: 1e5 };
pub(super) const POSITION_MM: Quantity = Quantity { what: "a position in mm", min: -1e6, max: 1e6 };
pub(super) const POINT_MM: Quantity = Quantity { what: "a coordinate in mm", min: -1e5, max: 1e5 };
pub(super) const STEP_MM: Quantity = Quantity { what: "a move in mm", min: -1e5, max: 1e5 };
pub(super) const QUATERNION: Quantity = Quantity { what: "a component of a unit quaternion", min: -1.001, max: 1.001 };
pub(super) const ANGLE_DEG: Quantity = Quantity { what: "an angle in degrees", min: -36_000.0, max: 36_000.0 };
pub(super) const PLANE_ANGLE_DEG: Quantity =
    Quantity { what: "an angle between two planes in degrees", min: 0.0, max: 180.0 };
pub(super) const PART_SIZE_MM: Quantity = Quantity { what: "a part's size in mm", min: 1e-3, max: 1e4 };
