//! The orientations that the sensor may take: tilt, direction of the tilt, and turn about the range axis.

use std::f64::consts::TAU;

use nalgebra::UnitQuaternion;

use crate::geometry::so3::{self, nearest_rotation};
use crate::geometry::{Mat3, Vec3};

use super::{Limits, PlanRefusal};

/// Beyond this the range axis would look back.
const MOST_TILT_DEG: f64 = 180.0;
/// A half turn either way is every turn.
const MOST_SPIN_DEG: f64 = 180.0;
/// The grid: rings of tilt beside the reference, directions on each ring, turns.
const NUM_RINGS: u32 = 3;
const NUM_AZIMUTHS: u32 = 16;
const NUM_SPINS: u32 = 9;

/// An orientation relative to the reference, rad.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Orientation {
    pub tilt: f64,
    pub azimuth: f64,
    pub spin: f64,
}

impl Orientation {
    /// `reference_from_sensor`: first the turn about the range axis, then the tilt.
    fn rotation(self) -> UnitQuaternion<f64> {
        let tilt_axis = Vec3::new(-self.azimuth.sin(), self.azimuth.cos(), 0.0);
        so3::exp(tilt_axis * self.tilt) * so3::exp(Vec3::z() * self.spin)
    }

    /// Direction of the tilt, 0° to 360°; 0° where there is none.
    pub fn azimuth_deg(self) -> f64 {
        if self.tilt > 0.0 { self.azimuth.rem_euclid(TAU).to_degrees() } else { 0.0 }
    }
}

/// What may be chosen from.
#[derive(Clone, Copy, Debug)]
pub(super) struct Orientations {
    base_from_reference: UnitQuaternion<f64>,
    max_tilt: f64,
    max_spin: f64,
}

impl Orientations {
    /// About a reference orientation of the sensor.
    ///
    /// # Errors
    /// [`PlanRefusal::NothingWithinLimits`] if it is the only one.
    pub fn new(base_from_reference: UnitQuaternion<f64>, limits: &Limits) -> Result<Self, PlanRefusal> {
        let within = |angle_deg: f64, most_deg: f64| {
            (angle_deg >= 0.0).then(|| angle_deg.min(most_deg).to_radians()).ok_or(PlanRefusal::NothingWithinLimits)
        };
        let max_tilt = within(limits.max_tilt_deg, MOST_TILT_DEG)?;
        let max_spin = within(limits.max_spin_deg, MOST_SPIN_DEG)?;
        if max_tilt + max_spin <= 0.0 {
            return Err(PlanRefusal::NothingWithinLimits);
        }
        Ok(Self { base_from_reference, max_tilt, max_spin })
    }

    /// About the mean of what the sensor took already.
    ///
    /// # Errors
    /// As [`Orientations::new`], and [`PlanRefusal::Undetermined`] if there is nothing.
    pub fn about_mean_of(
        base_from_sensor: impl Iterator<Item = UnitQuaternion<f64>>,
        limits: &Limits,
    ) -> Result<Self, PlanRefusal> {
        let mut rotations = base_from_sensor.map(|rotation| rotation.to_rotation_matrix().into_inner());
        let first = rotations.next().ok_or(PlanRefusal::Undetermined)?;
        let sum: Mat3 = rotations.fold(first, |sum, rotation| sum + rotation);
        // Orientations all around have no mean; then any of them is as good a reference as another.
        let mean = nearest_rotation(&sum).or_else(|| nearest_rotation(&first)).ok_or(PlanRefusal::Undetermined)?;
        Self::new(mean, limits)
    }

    /// The sensor in the base at an orientation.
    pub fn base_from_sensor(&self, orientation: Orientation) -> UnitQuaternion<f64> {
        self.base_from_reference * orientation.rotation()
    }

    /// The nearest orientation within the limits.
    pub fn within_limits(&self, orientation: Orientation) -> Orientation {
        Orientation {
            tilt: orientation.tilt.clamp(0.0, self.max_tilt),
            azimuth: orientation.azimuth,
            spin: orientation.spin.clamp(-self.max_spin, self.max_spin),
        }
    }

    /// Orientations all over the limits, or over a part of them about the reference.
    pub fn grid(&self, part: f64) -> Vec<Orientation> {
        let (max_tilt, max_spin) = (part * self.max_tilt, part * self.max_spin);
        let spins = (0..NUM_SPINS).map(|idx| max_spin * (2.0 * f64::from(idx) / f64::from(NUM_SPINS - 1) - 1.0));
        spins
            .flat_map(|spin| {
                let upright = std::iter::once(Orientation { tilt: 0.0, azimuth: 0.0, spin });
                let rings = (1..=NUM_RINGS).flat_map(move |ring| {
                    (0..NUM_AZIMUTHS).map(move |idx| Orientation {
                        tilt: max_tilt * f64::from(ring) / f64::from(NUM_RINGS),
                        azimuth: TAU * f64::from(idx) / f64::from(NUM_AZIMUTHS),
                        spin,
                    })
                });
                upright.chain(rings)
            })
            .collect()
    }

    /// Steps from one orientation of the grid to the next: tilt, direction, turn, rad.
    pub fn grid_steps(&self) -> [f64; 3] {
        [
            self.max_tilt / f64::from(NUM_RINGS),
            TAU / f64::from(NUM_AZIMUTHS),
            2.0 * self.max_spin / f64::from(NUM_SPINS - 1),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tilt_is_the_angle_of_the_range_axis_and_points_where_the_azimuth_says() {
        let orientation = Orientation { tilt: 0.4, azimuth: 1.1, spin: -2.0 };
        let axis = orientation.rotation() * Vec3::z();
        assert!((axis.angle(&Vec3::z()) - 0.4).abs() < 1e-12);
        assert!((axis.y.atan2(axis.x) - 1.1).abs() < 1e-12);
    }

    #[test]
    fn limits_that_leave_nothing_are_refused() {
        for (max_tilt_deg, max_spin_deg) in [(0.0, 0.0), (-1.0, 90.0), (f64::NAN, 90.0), (30.0, -5.0)] {
            let limits = Limits { max_tilt_deg, max_spin_deg, ..Limits::default() };
            let refusal = Orientations::new(UnitQuaternion::identity(), &limits).expect_err("nothing");
            assert_eq!(refusal, PlanRefusal::NothingWithinLimits);
        }
    }
}
