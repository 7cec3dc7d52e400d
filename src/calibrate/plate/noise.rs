//! What the points of a plate scatter by: the sensor's noise in its plane and the robot's, carried to each point.
//!
//! Three components: the position and the orientation of each pose, and the point in the laser plane. What is stated, or
//! said by an edge's own fit, is taken as it is; the rest begins in the proportions of usual machines and is found from the
//! data as far as they tell it.

use nalgebra::Matrix2;

use crate::calibrate::components::{Components, Found, NUM_COMPONENTS, PointModel};
use crate::calibrate::{AboveStated, Mount, NoiseModel, PlateProblem, SolveError};
use crate::geometry::so3::hat;
use crate::geometry::{Mat3, Rigid, Vec3, stats};

use super::measured::Measured;
use super::points::{EdgePoint, NUM_UNKNOWNS, PlateState};

/// A usual robot and a usual sensor, where nothing is stated: position, orientation (rad), point; mm.
const USUAL_STDS: [f64; NUM_COMPONENTS] = [0.03, 1e-4, 0.03];
/// No robot and no profiler is better than this, mm: it keeps exact data weighable.
const LEAST_STD_MM: f64 = 1e-4;

/// The noise that the weights stand for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PlateNoise {
    /// Variances of position, orientation and point as stated, else of usual machines, mm² and rad².
    variances: [f64; NUM_COMPONENTS],
    /// Which of them are to be found.
    is_open: [bool; NUM_COMPONENTS],
    /// Whether what the profiles say of their points is to be found as well: the data refute it.
    are_profiles_open: bool,
    /// What was found of what is open.
    found: Found,
    is_stated: bool,
    mount: Mount,
    /// The scatter against what is stated.
    pub above_stated: Option<AboveStated>,
}

impl PlateNoise {
    /// What the problem says of it; the rest as of usual machines.
    pub fn of(problem: &PlateProblem) -> Self {
        let stated = [problem.noise.position_std_mm, problem.noise.orientation_std_rad, problem.profile_std_mm];
        let std = |idx: usize| stated[idx].unwrap_or(USUAL_STDS[idx]);
        Self {
            variances: [0, 1, 2].map(|idx| std(idx) * std(idx)),
            is_open: stated.map(|std| std.is_none()),
            are_profiles_open: false,
            found: Found::nothing(),
            is_stated: stated[0].is_some() && stated[1].is_some(),
            mount: problem.mount,
            above_stated: None,
        }
    }

    /// The same with all of it to be found, in the proportions that were stated.
    pub fn reopened(&self) -> Self {
        let usual = USUAL_STDS.map(|std| std * std);
        Self {
            variances: [0, 1, 2].map(|idx| if self.variances[idx] > 0.0 { self.variances[idx] } else { usual[idx] }),
            is_open: [true; NUM_COMPONENTS],
            are_profiles_open: true,
            ..*self
        }
    }

    /// The points with the information that this noise leaves about each, across its edge.
    pub fn weighed(&self, measured: &[Measured], state: &PlateState) -> Vec<EdgePoint> {
        measured
            .iter()
            .map(|measured| {
                let covariance = self.model_of(measured, state).covariance(&self.found.log_factors);
                let information = covariance.try_inverse().unwrap_or_default();
                EdgePoint { information, ..measured.point }
            })
            .collect()
    }

    /// Finds what is not known from the residuals, and compares them with what is stated otherwise. `state` is near a
    /// minimum.
    ///
    /// # Errors
    /// [`SolveError::Undetermined`] if the points leave an unknown free.
    pub fn estimate(&mut self, measured: &[Measured], state: &PlateState) -> Result<(), SolveError> {
        let Some(freedom) = (2 * measured.len()).checked_sub(NUM_UNKNOWNS).filter(|freedom| *freedom > 0) else {
            return Ok(());
        };
        let components = Components::new(measured.iter().map(|measured| self.model_of(measured, state)).collect());
        if components.is_any_open() {
            self.found = components.fit(self.found.log_factors)?;
        } else {
            #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^52 points")]
            let freedom = freedom as f64;
            let chi_square = components.chi_square(&self.found.log_factors);
            let p_value = stats::chi_squared_p_value(chi_square, freedom);
            self.above_stated = Some(AboveStated { ratio: (chi_square / freedom).sqrt(), p_value });
        }
        Ok(())
    }

    /// Degrees of freedom (Satterthwaite's) of a variance that follows this noise.
    ///
    /// # Errors
    /// Those of `variance_by`.
    pub fn degrees_of_freedom(
        &self,
        variance_by: impl Fn(&Self) -> Result<f64, SolveError>,
    ) -> Result<f64, SolveError> {
        self.found.degrees_of_freedom(|found| variance_by(&Self { found: *found, ..*self }))
    }

    /// For the reader.
    pub fn model(&self) -> NoiseModel {
        let std = |idx: usize| {
            let factor = if self.is_open[idx] { self.found.log_factors[idx].exp() } else { 1.0 };
            (self.variances[idx] * factor).sqrt()
        };
        NoiseModel {
            position_std_mm: std(0),
            orientation_std_rad: std(1),
            station_position_std_mm: 0.0,
            station_orientation_std_rad: 0.0,
            is_stated: self.is_stated,
            above_stated: self.above_stated,
        }
    }

    /// What a point says and by what it may be off, across its edge.
    ///
    /// Points taken at one reported pose share its error. With that error's variance times their number each, they weigh
    /// together as their mean does.
    fn model_of(&self, measured: &Measured, state: &PlateState) -> PointModel<2, NUM_UNKNOWNS> {
        let point = &measured.point;
        let across = state.across_in_base(point.edge);
        let of_sensor = across * point.base_from_sensor(&state.flange_from_sensor);
        let in_base = point.in_base(&state.flange_from_sensor);
        let lever = across * lever(in_base, &point.base_from_flange, self.mount);
        let in_plane = measured
            .covariance_mm2
            .unwrap_or_else(|| Matrix2::identity() * (self.variances[2] / measured.num_readings));
        let in_sensor =
            Mat3::new(in_plane[(0, 0)], 0.0, in_plane[(0, 1)], 0.0, 0.0, 0.0, in_plane[(1, 0)], 0.0, in_plane[(1, 1)]);
        let parts = [
            Matrix2::identity() * (self.variances[0] * measured.num_at_pose),
            lever * lever.transpose() * (self.variances[1] * measured.num_at_pose),
            of_sensor * in_sensor * of_sensor.transpose(),
        ];
        let is_point_open = if measured.covariance_mm2.is_some() { self.are_profiles_open } else { self.is_open[2] };
        let is_open = [self.is_open[0], self.is_open[1], is_point_open];
        let mut known = Matrix2::identity() * (LEAST_STD_MM * LEAST_STD_MM);
        let mut open = [Matrix2::zeros(); NUM_COMPONENTS];
        for ((part, is_open), open) in parts.into_iter().zip(is_open).zip(&mut open) {
            *(if is_open { open } else { &mut known }) += part;
        }
        PointModel { residual: state.off_edge(point), by_unknowns: state.by_unknowns(point), known, open }
    }
}

/// How a point in the base follows a turn of the pose, up to the sign.
fn lever(in_base: Vec3, base_from_flange: &Rigid, mount: Mount) -> Mat3 {
    hat(match mount {
        // An error of the flange's orientation turns what the sensor sees about the flange.
        Mount::OnFlange => in_base - base_from_flange.translation.vector,
        // The poses are inverted: what is called base here is the flange, and turns about its own origin.
        Mount::Fixed => in_base,
    })
}

/// Covariance (mm²) of a point in the base by the noise of the robot's pose: variances of its position (mm²) and orientation
/// (rad²).
pub(crate) fn of_pose(position: f64, orientation: f64, in_base: Vec3, base_from_flange: &Rigid, mount: Mount) -> Mat3 {
    let lever = lever(in_base, base_from_flange, mount);
    Mat3::identity() * position + lever * lever.transpose() * orientation
}
