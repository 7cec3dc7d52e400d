//! What the poses scatter by: the robot's noise and the target's, carried to the errors of each pose.
//!
//! Three components: translations (a shift of the robot's pose and one of the target's act alike), the robot's orientation,
//! which acts with the lever from the flange, and the target's orientation, which does not. What is stated is taken as it is;
//! the rest begins in the proportions of a usual robot and camera and is found from the data as far as they tell it.

use nalgebra::Matrix6;

use crate::calibrate::components::{Components, Found, PointModel};
use crate::calibrate::{AboveStated, MotionProblem, Mount, NoiseModel, SolveError, TargetNoise};
use crate::geometry::so3::hat;
use crate::geometry::{Mat3, Vec3, stats};

use super::measured::Measured;
use super::pose::{Errors, Information, MotionState, NUM_UNKNOWNS, PosePair, lever_of_turns};

/// A usual robot, where nothing is stated: position (mm), orientation (rad).
const USUAL_ROBOT: [f64; 2] = [0.05, 3e-4];
/// A usual camera that looks at a usual board: place (mm), orientation (rad).
const USUAL_TARGET: [f64; 2] = [0.3, 2e-3];
/// No robot and no camera is better than this: it keeps exact data weighable, mm and rad.
const LEAST_STD: [f64; 2] = [1e-4, 1e-7];
/// From so many poses the noise is found; of more, as many that are spread over all.
const MOST_FOR_NOISE: usize = 100;

/// A variance that is stated, or one of usual machines that is to be found.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Variance {
    value: f64,
    is_open: bool,
}

impl Variance {
    fn new(stated: Option<f64>, usual: f64) -> Self {
        let std = stated.unwrap_or(usual);
        Self { value: std * std, is_open: stated.is_none() }
    }

    const fn known(self) -> f64 {
        if self.is_open { 0.0 } else { self.value }
    }

    const fn open(self) -> f64 {
        if self.is_open { self.value } else { 0.0 }
    }
}

/// The noise that the weights stand for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct MotionNoise {
    robot_position: Variance,
    robot_orientation: Variance,
    target_translation: Variance,
    target_rotation: Variance,
    /// What was found of what is open: translations, the robot's orientation, the target's.
    found: Found,
    mount: Mount,
    /// The scatter against what is stated.
    pub above_stated: Option<AboveStated>,
}

/// The four variances at one pose.
struct AtPose {
    translation: f64,
    robot_orientation: f64,
    target_rotation: f64,
}

impl MotionNoise {
    /// What the problem says of it; the rest as of usual machines.
    pub fn of(problem: &MotionProblem) -> Self {
        let TargetNoise { translation_std_mm, rotation_std_rad } = problem.target_noise;
        Self {
            robot_position: Variance::new(problem.noise.position_std_mm, USUAL_ROBOT[0]),
            robot_orientation: Variance::new(problem.noise.orientation_std_rad, USUAL_ROBOT[1]),
            target_translation: Variance::new(translation_std_mm, USUAL_TARGET[0]),
            target_rotation: Variance::new(rotation_std_rad, USUAL_TARGET[1]),
            found: Found::nothing(),
            mount: problem.mount,
            above_stated: None,
        }
    }

    /// The same with all of it to be found, in the proportions that were stated.
    pub fn reopened(&self) -> Self {
        let open = |variance: Variance| Variance { is_open: true, ..variance };
        Self {
            robot_position: open(self.robot_position),
            robot_orientation: open(self.robot_orientation),
            target_translation: open(self.target_translation),
            target_rotation: open(self.target_rotation),
            ..*self
        }
    }

    /// Whether any of it is found from the residuals.
    pub const fn is_any_open(&self) -> bool {
        self.robot_position.is_open
            || self.robot_orientation.is_open
            || self.target_translation.is_open
            || self.target_rotation.is_open
    }

    /// The poses with the information that this noise leaves about each.
    pub fn weighed(&self, measured: &[Measured], state: &MotionState) -> Vec<PosePair> {
        let factors = self.found.log_factors.map(f64::exp);
        measured
            .iter()
            .map(|measured| {
                let errors = state.errors(&measured.pose);
                let lever = lever_of_turns(&errors, &measured.pose.base_from_flange, self.mount);
                let (known, open) = self.at_pose(measured);
                let information = information(
                    LEAST_STD[0] * LEAST_STD[0] + known.translation + open.translation * factors[0],
                    known.robot_orientation + open.robot_orientation * factors[1],
                    LEAST_STD[1] * LEAST_STD[1] + known.target_rotation + open.target_rotation * factors[2],
                    lever,
                );
                PosePair { information, ..measured.pose }
            })
            .collect()
    }

    /// The variances at a pose: those that are known, and those that are open where their factor is one.
    ///
    /// Readings at one reported pose share its error. With that error's variance times their number each, they weigh together
    /// as their mean does.
    fn at_pose(&self, measured: &Measured) -> (AtPose, AtPose) {
        let (shared, averaged) = (measured.num_at_pose, measured.num_readings.recip());
        let of = |part: fn(Variance) -> f64| AtPose {
            translation: part(self.robot_position) * shared + part(self.target_translation) * averaged,
            robot_orientation: part(self.robot_orientation) * shared,
            target_rotation: part(self.target_rotation) * averaged,
        };
        (of(Variance::known), of(Variance::open))
    }

    /// Finds what is not known from the residuals, and compares them with what is stated otherwise. `state` is near a
    /// minimum.
    ///
    /// # Errors
    /// [`SolveError::Undetermined`] if the poses leave an unknown free.
    pub fn estimate(&mut self, measured: &[Measured], state: &MotionState) -> Result<(), SolveError> {
        let Some(freedom) = (6 * measured.len()).checked_sub(NUM_UNKNOWNS).filter(|freedom| *freedom > 0) else {
            return Ok(());
        };
        if self.is_any_open() {
            // Six hundred errors tell a noise to a few per cent; more poses would cost more than the calibration itself.
            let every = measured.len().div_ceil(MOST_FOR_NOISE);
            let models = measured.iter().step_by(every).map(|measured| self.model_of(measured, state)).collect();
            self.found = Components::new(models).fit(self.found.log_factors)?;
        } else {
            #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^52 poses")]
            let freedom = freedom as f64;
            let squares =
                self.weighed(measured, state).iter().map(|pose| pose.information.square(&state.errors(pose))).sum();
            let p_value = stats::chi_squared_p_value(squares, freedom);
            self.above_stated = Some(AboveStated { ratio: (squares / freedom).sqrt(), p_value });
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

    /// The robot's, for the reader.
    pub fn model(&self) -> NoiseModel {
        NoiseModel {
            position_std_mm: self.std(self.robot_position, 0),
            orientation_std_rad: self.std(self.robot_orientation, 1),
            station_position_std_mm: 0.0,
            station_orientation_std_rad: 0.0,
            is_stated: !self.robot_position.is_open && !self.robot_orientation.is_open,
            above_stated: self.above_stated,
        }
    }

    /// The target's: of its place (mm) and of its orientation (rad).
    pub fn of_target(&self) -> [f64; 2] {
        [self.std(self.target_translation, 0), self.std(self.target_rotation, 2)]
    }

    fn std(&self, variance: Variance, component: usize) -> f64 {
        let factor = if variance.is_open { self.found.log_factors[component].exp() } else { 1.0 };
        (variance.value * factor).sqrt()
    }

    fn model_of(&self, measured: &Measured, state: &MotionState) -> PointModel<6, NUM_UNKNOWNS> {
        let errors: Errors = state.errors(&measured.pose);
        let lever = hat(lever_of_turns(&errors, &measured.pose.base_from_flange, self.mount));
        let mut of_shift = Matrix6::zeros();
        of_shift.fixed_view_mut::<3, 3>(3, 3).copy_from(&Mat3::identity());
        let mut of_turn = Matrix6::zeros();
        of_turn.fixed_view_mut::<3, 3>(0, 0).copy_from(&Mat3::identity());
        let mut of_robot = of_turn;
        of_robot.fixed_view_mut::<3, 3>(0, 3).copy_from(&lever);
        of_robot.fixed_view_mut::<3, 3>(3, 0).copy_from(&-lever);
        of_robot.fixed_view_mut::<3, 3>(3, 3).copy_from(&(-lever * lever));
        let (known, open) = self.at_pose(measured);
        PointModel {
            residual: errors.vector(),
            by_unknowns: MotionState::by_unknowns(&measured.pose, &errors),
            known: of_shift * (LEAST_STD[0] * LEAST_STD[0] + known.translation)
                + of_robot * known.robot_orientation
                + of_turn * (LEAST_STD[1] * LEAST_STD[1] + known.target_rotation),
            open: [of_shift * open.translation, of_robot * open.robot_orientation, of_turn * open.target_rotation],
        }
    }
}

/// The inverse of the covariance ((τ + ρ) 1, ρ \[l\]; −ρ \[l\], σ 1 + ρ \[l\]\[l\]ᵀ) of (r, e), with ρ of the robot's orientation and τ
/// of the target's.
///
/// e + k \[l\] r with k = ρ / (τ + ρ) is free of r; what remains of it has the variance σ along the lever, and more across it.
fn information(translation: f64, robot_orientation: f64, target_rotation: f64, lever: Vec3) -> Information {
    let turn = robot_orientation + target_rotation;
    let share = robot_orientation / turn;
    let remaining = robot_orientation * (1.0 - share);
    let across = translation + remaining * lever.norm_squared();
    let weight = (Mat3::identity() + lever * lever.transpose() * (remaining / translation)) / across;
    let shared_lever = hat(lever) * share;
    let mixed = weight * shared_lever;
    Information { rotation: Mat3::identity() / turn + shared_lever.transpose() * mixed, mixed, translation: weight }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_closed_form_of_the_information_is_the_inverse_of_the_covariance() {
        let (translation, robot, target) = (0.04, 4e-6, 9e-6);
        let lever = Vec3::new(60.0, -25.0, 240.0);
        let skew = hat(lever);
        let mut covariance = Matrix6::zeros();
        covariance.fixed_view_mut::<3, 3>(0, 0).copy_from(&(Mat3::identity() * (robot + target)));
        covariance.fixed_view_mut::<3, 3>(0, 3).copy_from(&(skew * robot));
        covariance.fixed_view_mut::<3, 3>(3, 0).copy_from(&(-skew * robot));
        covariance.fixed_view_mut::<3, 3>(3, 3).copy_from(&(Mat3::identity() * translation - skew * skew * robot));
        let product = covariance * information(translation, robot, target, lever).matrix();
        // Entries of 1e5 rad⁻² times variances of 1e-5: rounding at 1e-11.
        assert!((product - Matrix6::identity()).amax() < 1e-9, "{product}");
    }
}
