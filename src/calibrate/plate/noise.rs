//! What the points of a plate scatter by: the sensor's noise in its plane and the robot's, carried to each point.

use crate::calibrate::{AboveStated, Mount, NoiseModel, PlateProblem};
use crate::geometry::so3::hat;
use crate::geometry::{Mat3, Rigid, Vec3, stats};

use super::measured::Measured;
use super::points::{EdgePoint, NUM_UNKNOWNS, PlateState};

/// A usual robot and a usual sensor, where nothing is stated: their proportion matters, the scale is estimated.
const USUAL_POSITION_STD_MM: f64 = 0.03;
const USUAL_ORIENTATION_STD_RAD: f64 = 1e-4;
const USUAL_POINT_STD_MM: f64 = 0.03;
/// No robot and no profiler is better than this, mm: it keeps exact data weighable.
const LEAST_STD_MM: f64 = 1e-4;
/// The search for the scale ends within this factor of it, or where nothing is left of it.
const SCALE_WITHIN: f64 = 1e-9;
const NO_SCALE: f64 = 1e-12;

/// A noise of the robot and of the sensor: variances, mm² and rad².
#[derive(Clone, Copy, Debug, PartialEq)]
struct Variances {
    position: f64,
    orientation: f64,
    /// Of a point in the laser plane along either axis, where its profile does not say it.
    point: f64,
    /// Factor on what the profiles say of their points.
    of_profiles: f64,
}

/// The noise that the weights stand for: what is known of it, and what is not with its estimated scale.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PlateNoise {
    known: Variances,
    /// Times `scale`.
    open: Variances,
    /// Factor on the unknown part.
    scale: f64,
    is_stated: bool,
    mount: Mount,
    /// Equations left over that the scale was found from, infinite where nothing had to be found.
    pub degrees_of_freedom: f64,
    /// The scatter against what is stated.
    pub above_stated: Option<AboveStated>,
}

impl PlateNoise {
    /// What the problem says of it; the rest at the scale of usual machines.
    pub fn of(problem: &PlateProblem) -> Self {
        let (position, orientation) = (problem.noise.position_std_mm, problem.noise.orientation_std_rad);
        let point = problem.profile_std_mm;
        let squared = |std: Option<f64>| std.map_or(0.0, |std| std * std);
        let usual = |std: Option<f64>, usual: f64| if std.is_some() { 0.0 } else { usual * usual };
        Self {
            known: Variances {
                position: squared(position),
                orientation: squared(orientation),
                point: squared(point),
                of_profiles: 1.0,
            },
            open: Variances {
                position: usual(position, USUAL_POSITION_STD_MM),
                orientation: usual(orientation, USUAL_ORIENTATION_STD_RAD),
                point: usual(point, USUAL_POINT_STD_MM),
                of_profiles: 0.0,
            },
            scale: 1.0,
            is_stated: position.is_some() && orientation.is_some(),
            mount: problem.mount,
            degrees_of_freedom: f64::INFINITY,
            above_stated: None,
        }
    }

    /// The points with the information that this noise leaves about each, across its edge.
    pub fn weighed(&self, measured: &[Measured], state: &PlateState) -> Vec<EdgePoint> {
        measured
            .iter()
            .map(|point| {
                let across = state.across_in_base(point.point.edge);
                let covariance =
                    across * self.covariance_in_base(point, &state.flange_from_sensor) * across.transpose();
                let information = covariance.try_inverse().unwrap_or_default();
                EdgePoint { information, ..point.point }
            })
            .collect()
    }

    /// Covariance of a point in the base, mm².
    ///
    /// Points taken at one reported pose share its error. With that error's variance times their number each, they weigh
    /// together as their mean does.
    pub fn covariance_in_base(&self, point: &Measured, flange_from_sensor: &Rigid) -> Mat3 {
        let known = covariance(&self.known, point, flange_from_sensor, self.mount);
        let least = Mat3::identity() * (LEAST_STD_MM * LEAST_STD_MM);
        known + least + covariance(&self.open, point, flange_from_sensor, self.mount) * self.scale
    }

    /// Finds the scale of what is not known so that the residuals are as large as they should be, and compares them with
    /// what is stated otherwise. `state` is a minimum.
    pub fn estimate(&mut self, measured: &[Measured], state: &PlateState) {
        let Some(freedom) = (2 * measured.len()).checked_sub(NUM_UNKNOWNS).filter(|freedom| *freedom > 0) else {
            return;
        };
        #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^52 points")]
        let freedom = freedom as f64;
        let chi_square = |noise: &Self| -> f64 {
            let points = noise.weighed(measured, state);
            points
                .iter()
                .map(|point| state.off_edge(point))
                .zip(&points)
                .map(|(off, point)| off.dot(&(point.information * off)))
                .sum()
        };
        if !self.has_open(measured) {
            let chi_square = chi_square(self);
            self.above_stated = Some(AboveStated {
                ratio: (chi_square / freedom).sqrt(),
                p_value: stats::chi_squared_p_value(chi_square, freedom),
            });
            return;
        }
        // χ² falls as the scale grows; it has to be what the equations left over let one expect.
        let at = |scale: f64| chi_square(&Self { scale, ..*self });
        let (mut low, mut high) = (0.0_f64, 1.0_f64);
        while at(high) > freedom && high < NO_SCALE.recip() {
            low = high;
            high *= 10.0;
        }
        if low < high * 0.01 {
            low = high;
            while at(low) < freedom && low > NO_SCALE {
                high = low;
                low *= 0.1;
            }
        }
        while high / low > 1.0 + SCALE_WITHIN {
            let middle = (low * high).sqrt();
            if at(middle) > freedom { low = middle } else { high = middle }
        }
        self.scale = high;
        let part = self.open_part(measured, &state.flange_from_sensor);
        self.degrees_of_freedom = freedom / (part * part).max(f64::MIN_POSITIVE);
    }

    /// All of it so many times as large.
    pub fn contradicted(&self, ratio: f64, num_points: usize) -> Self {
        let times = |variances: Variances, factor: f64| Variances {
            position: variances.position * factor,
            orientation: variances.orientation * factor,
            point: variances.point * factor,
            of_profiles: variances.of_profiles * factor,
        };
        #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^52 points")]
        let degrees_of_freedom = (2 * num_points).saturating_sub(NUM_UNKNOWNS) as f64;
        Self { known: times(self.known, ratio * ratio), degrees_of_freedom, ..*self }
    }

    /// For the reader.
    pub fn model(&self) -> NoiseModel {
        NoiseModel {
            position_std_mm: (self.known.position + self.open.position * self.scale).sqrt(),
            orientation_std_rad: (self.known.orientation + self.open.orientation * self.scale).sqrt(),
            station_position_std_mm: 0.0,
            station_orientation_std_rad: 0.0,
            is_stated: self.is_stated,
            above_stated: self.above_stated,
        }
    }

    fn has_open(&self, measured: &[Measured]) -> bool {
        let open = &self.open;
        open.position > 0.0
            || open.orientation > 0.0
            || (open.point > 0.0 && measured.iter().any(|point| point.covariance_mm2.is_none()))
    }

    /// The part of the points' variance that was estimated, in the mean.
    fn open_part(&self, measured: &[Measured], flange_from_sensor: &Rigid) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^52 points")]
        let scale = 1.0 / measured.len() as f64;
        measured
            .iter()
            .map(|point| {
                let open = covariance(&self.open, point, flange_from_sensor, self.mount).trace() * self.scale;
                let total = self.covariance_in_base(point, flange_from_sensor).trace();
                if total > 0.0 { open / total } else { 1.0 }
            })
            .sum::<f64>()
            * scale
    }
}

fn covariance(variances: &Variances, point: &Measured, flange_from_sensor: &Rigid, mount: Mount) -> Mat3 {
    let rotation = point.point.base_from_sensor(flange_from_sensor);
    let in_plane = point.covariance_mm2.map_or_else(
        || Mat3::from_diagonal(&[variances.point, 0.0, variances.point].into()),
        |found| {
            let mut covariance = Mat3::zeros();
            for (row, from_row) in [(0, 0), (2, 1)] {
                for (column, from_column) in [(0, 0), (2, 1)] {
                    covariance[(row, column)] = found[(from_row, from_column)] * variances.of_profiles;
                }
            }
            covariance
        },
    );
    let in_base = point.point.in_base(flange_from_sensor);
    let of_pose = of_pose(variances.position, variances.orientation, in_base, &point.point.base_from_flange, mount);
    rotation * in_plane * rotation.transpose() + of_pose * point.num_at_pose
}

/// Covariance (mm²) of a point in the base by the noise of the robot's pose: variances of its position (mm²) and orientation
/// (rad²).
pub(crate) fn of_pose(position: f64, orientation: f64, in_base: Vec3, base_from_flange: &Rigid, mount: Mount) -> Mat3 {
    let lever = hat(match mount {
        // An error of the flange's orientation turns what the sensor sees about the flange.
        Mount::OnFlange => in_base - base_from_flange.translation.vector,
        // The poses are inverted: what is called base here is the flange, and turns about its own origin.
        Mount::Fixed => in_base,
    });
    Mat3::identity() * position + lever * lever.transpose() * orientation
}
