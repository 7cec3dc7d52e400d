//! Whether a robot is where it was sent: pure.

use crate::device::error::DeviceError;
use crate::geometry::{Base, Flange, Transform};

/// Controllers call a move ended within some hundredths of a millimetre; what is further off was stopped on the way.
const ARRIVED_MM: f64 = 0.5;
/// The same for the orientation.
const ARRIVED_DEG: f64 = 0.5;

/// Checks where a move ended.
///
/// # Errors
/// [`DeviceError::NotArrived`].
pub fn check_arrival(
    device: &'static str,
    target: &Transform<Base, Flange>,
    found: &Transform<Base, Flange>,
) -> Result<(), DeviceError> {
    let distance_mm = (found.translation_mm() - target.translation_mm()).norm();
    let turn_deg = found.rotation().angle_to(&target.rotation()).to_degrees();
    if distance_mm <= ARRIVED_MM && turn_deg <= ARRIVED_DEG {
        return Ok(());
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "not negative; a cast saturates")]
    let thousandths = |value: f64| (value * 1000.0).round() as u32;
    Err(DeviceError::NotArrived { device, distance_um: thousandths(distance_mm), turn_mdeg: thousandths(turn_deg) })
}
