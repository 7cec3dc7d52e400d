//! A pose of the robot with the target's pose there, the unknowns of A X B = Z, and the sums of their least squares.
//!
//! A = `base_from_flange`, X = `flange_from_sensor`, B = `sensor_from_target`, Z = `base_from_target`. The errors are taken
//! along the sensor's axes, where the noise of most cameras and the levers are simple: r, the turn left over, and e, how far
//! the target's origin is off its place.

use nalgebra::{Matrix6, SMatrix, SVector, UnitQuaternion, Vector6};

use crate::calibrate::Mount;
use crate::calibrate::plate::descent::{LEVER_MM, Sums, Unknowns};
use crate::geometry::so3::{self, hat};
use crate::geometry::{Mat3, Rigid, Vec3, se3};

/// Sensor on the flange (rotation, translation), then target in the base (rotation, translation).
pub const NUM_UNKNOWNS: usize = 12;
/// A 12 × 12 matrix.
pub type Hessian = SMatrix<f64, NUM_UNKNOWNS, NUM_UNKNOWNS>;

/// A pose of the robot with the target's pose there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PosePair {
    /// Its station's place in the list of those used.
    pub station: usize,
    /// A; inverted for a fixed sensor.
    pub base_from_flange: Rigid,
    /// B.
    pub sensor_from_target: Rigid,
    /// The information about (r, e).
    pub information: Information,
}

impl PosePair {
    /// Whether both poses are the same.
    #[must_use]
    pub fn is_copy_of(&self, other: &Self) -> bool {
        self.base_from_flange == other.base_from_flange && self.sensor_from_target == other.sensor_from_target
    }
}

/// What a pose's errors are weighed by, in blocks of three; it is symmetric.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Information {
    /// Of the rotation, 1/rad².
    pub rotation: Mat3,
    /// Between translation (rows) and rotation, 1/(mm rad).
    pub mixed: Mat3,
    /// Of the translation, 1/mm².
    pub translation: Mat3,
}

impl Information {
    /// Rotations in rad and translations in mm over a lever weigh the same.
    #[must_use]
    pub fn by_lever(lever_mm: f64) -> Self {
        Self { rotation: Mat3::identity() * (lever_mm * lever_mm), mixed: Mat3::zeros(), translation: Mat3::identity() }
    }

    /// From a covariance; `None` if it is singular.
    #[must_use]
    pub fn of_covariance(covariance: &Matrix6<f64>) -> Option<Self> {
        let inverse = covariance.cholesky()?.inverse();
        Some(Self {
            rotation: inverse.fixed_view::<3, 3>(0, 0).into_owned(),
            mixed: inverse.fixed_view::<3, 3>(3, 0).into_owned(),
            translation: inverse.fixed_view::<3, 3>(3, 3).into_owned(),
        })
    }

    /// As one matrix.
    #[must_use]
    pub fn matrix(&self) -> Matrix6<f64> {
        let mut matrix = Matrix6::zeros();
        matrix.fixed_view_mut::<3, 3>(0, 0).copy_from(&self.rotation);
        matrix.fixed_view_mut::<3, 3>(3, 0).copy_from(&self.mixed);
        matrix.fixed_view_mut::<3, 3>(0, 3).copy_from(&self.mixed.transpose());
        matrix.fixed_view_mut::<3, 3>(3, 3).copy_from(&self.translation);
        matrix
    }

    /// The square of errors in this metric.
    #[must_use]
    pub fn square(&self, errors: &Errors) -> f64 {
        let Errors { rotation, translation, .. } = errors;
        rotation.dot(&(self.rotation * rotation))
            + 2.0 * translation.dot(&(self.mixed * rotation))
            + translation.dot(&(self.translation * translation))
    }
}

/// The unknowns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionState {
    /// X.
    pub flange_from_sensor: Rigid,
    /// Z.
    pub base_from_target: Rigid,
}

/// What is left over at a pose, along the sensor's axes.
#[derive(Clone, Copy, Debug)]
pub struct Errors {
    /// r, rad.
    pub rotation: Vec3,
    /// e, mm.
    pub translation: Vec3,
    /// The rotation from base to sensor.
    pub sensor_from_base: Mat3,
    /// Where the target's origin is by this pose, in the base, mm.
    pub target_in_base: Vec3,
}

impl Errors {
    /// Both as one vector.
    #[must_use]
    pub fn vector(&self) -> Vector6<f64> {
        se3::join(self.rotation, self.translation)
    }
}

impl Unknowns<NUM_UNKNOWNS> for MotionState {
    fn stepped(&self, step: &SVector<f64, NUM_UNKNOWNS>) -> Self {
        let (turn, shift) = (step.fixed_rows::<3>(6).into_owned(), step.fixed_rows::<3>(9).into_owned());
        Self {
            flange_from_sensor: self.flange_from_sensor * se3::exp(&step.fixed_rows::<6>(0).into_owned()),
            base_from_target: Rigid::from_parts(
                (self.base_from_target.translation.vector + shift).into(),
                so3::exp(turn) * self.base_from_target.rotation,
            ),
        }
    }

    fn size(step: &SVector<f64, NUM_UNKNOWNS>) -> f64 {
        let rotation = step.fixed_rows::<3>(0).norm() + step.fixed_rows::<3>(6).norm();
        rotation + (step.fixed_rows::<3>(3).norm() + step.fixed_rows::<3>(9).norm()) / LEVER_MM
    }
}

impl MotionState {
    /// What is left over at a pose.
    #[must_use]
    pub fn errors(&self, pose: &PosePair) -> Errors {
        let base_from_sensor: UnitQuaternion<f64> = pose.base_from_flange.rotation * self.flange_from_sensor.rotation;
        let sensor_from_base = base_from_sensor.to_rotation_matrix().into_inner().transpose();
        let target_in_flange =
            self.flange_from_sensor * nalgebra::Point3::from(pose.sensor_from_target.translation.vector);
        let target_in_base = (pose.base_from_flange * target_in_flange).coords;
        let turn = pose.sensor_from_target.rotation * self.base_from_target.rotation.inverse() * base_from_sensor;
        Errors {
            rotation: so3::log(&turn),
            translation: sensor_from_base * (target_in_base - self.base_from_target.translation.vector),
            sensor_from_base,
            target_in_base,
        }
    }

    /// How the errors of a pose follow the unknowns: the sensor as a right perturbation, the target's turn about the base's
    /// axes and its shift along them.
    ///
    /// With C the rotation from base to sensor and b the target's origin in the sensor: dr = ω − C ζ and
    /// de = (e − b) × ω + v − C ν.
    #[must_use]
    pub fn by_unknowns(pose: &PosePair, errors: &Errors) -> SMatrix<f64, 6, NUM_UNKNOWNS> {
        let mut derivative = SMatrix::<f64, 6, NUM_UNKNOWNS>::zeros();
        for (row, column, block) in [
            (0, 0, Mat3::identity()),
            (0, 6, -errors.sensor_from_base),
            (3, 0, hat(errors.translation - pose.sensor_from_target.translation.vector)),
            (3, 3, Mat3::identity()),
            (3, 9, -errors.sensor_from_base),
        ] {
            derivative.fixed_view_mut::<3, 3>(row, column).copy_from(&block);
        }
        derivative
    }

    /// The target in the base that fits a sensor on the flange: the means over the poses.
    #[must_use]
    pub fn with_mean_target(flange_from_sensor: Rigid, poses: &[PosePair]) -> Self {
        let mut place = Vec3::zeros();
        let mut rotations = nalgebra::Vector4::zeros();
        let mut first: Option<nalgebra::Vector4<f64>> = None;
        for pose in poses {
            let base_from_target = pose.base_from_flange * flange_from_sensor * pose.sensor_from_target;
            place += base_from_target.translation.vector;
            let coords = base_from_target.rotation.coords;
            let sign = if first.get_or_insert(coords).dot(&coords) < 0.0 { -1.0 } else { 1.0 };
            rotations += coords * sign;
        }
        #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^52 poses")]
        let scale = 1.0 / poses.len() as f64;
        let rotation = UnitQuaternion::new_normalize(nalgebra::Quaternion::from(rotations));
        Self { flange_from_sensor, base_from_target: Rigid::from_parts((place * scale).into(), rotation) }
    }
}

/// The sums of poses, each as often as `times` says of its station.
#[must_use]
pub fn sums_of(poses: &[PosePair], state: &MotionState, times: impl Fn(usize) -> f64) -> Sums<NUM_UNKNOWNS> {
    let mut blocks = Blocks::default();
    for pose in poses {
        let times = times(pose.station);
        if times > 0.0 {
            blocks.add(pose, &state.errors(pose), times);
        }
    }
    blocks.sums()
}

/// The normal equations in blocks of three; general 6 × 12 products take five times as long.
#[derive(Default)]
struct Blocks {
    /// The lower triangle: (ω, ω), (v, ω), (v, v), then (ζ, ω), (ζ, v), (ν, ω), (ν, v), (ζ, ζ), (ν, ζ), (ν, ν).
    hessian: [Mat3; 10],
    gradient: [Vec3; 4],
    cost: f64,
}

impl Blocks {
    fn add(&mut self, pose: &PosePair, errors: &Errors, times: f64) {
        let Information { rotation, mixed, translation } = pose.information;
        let (rotation, mixed, translation) = (rotation * times, mixed * times, translation * times);
        let lever = hat(errors.translation - pose.sensor_from_target.translation.vector);
        let base_from_sensor = errors.sensor_from_base.transpose();
        // The information times the sensor's part of the Jacobian, ((1, 0), (lever, 1)).
        let rotation_by_turn = rotation + mixed.transpose() * lever;
        let translation_by_turn = mixed + translation * lever;
        let [
            turn_turn,
            shift_turn,
            shift_shift,
            target_turn,
            target_turn_shift,
            target_shift_turn,
            target_shift_shift,
            ..,
        ] = &mut self.hessian;
        *turn_turn += rotation_by_turn + lever.transpose() * translation_by_turn;
        *shift_turn += translation_by_turn;
        *shift_shift += translation;
        *target_turn -= base_from_sensor * rotation_by_turn;
        *target_turn_shift -= base_from_sensor * mixed.transpose();
        *target_shift_turn -= base_from_sensor * translation_by_turn;
        *target_shift_shift -= base_from_sensor * translation;
        self.hessian[7] += base_from_sensor * rotation * errors.sensor_from_base;
        self.hessian[8] += base_from_sensor * mixed * errors.sensor_from_base;
        self.hessian[9] += base_from_sensor * translation * errors.sensor_from_base;
        let by_rotation = rotation * errors.rotation + mixed.transpose() * errors.translation;
        let by_translation = mixed * errors.rotation + translation * errors.translation;
        self.gradient[0] -= by_rotation + lever.transpose() * by_translation;
        self.gradient[1] -= by_translation;
        self.gradient[2] += base_from_sensor * by_rotation;
        self.gradient[3] += base_from_sensor * by_translation;
        self.cost += errors.rotation.dot(&by_rotation) + errors.translation.dot(&by_translation);
    }

    fn sums(&self) -> Sums<NUM_UNKNOWNS> {
        const PLACES: [(usize, usize); 10] =
            [(0, 0), (3, 0), (3, 3), (6, 0), (6, 3), (9, 0), (9, 3), (6, 6), (9, 6), (9, 9)];
        let mut sums = Sums::<NUM_UNKNOWNS>::zero();
        for ((row, column), block) in PLACES.into_iter().zip(&self.hessian) {
            sums.hessian.fixed_view_mut::<3, 3>(row, column).copy_from(block);
            sums.hessian.fixed_view_mut::<3, 3>(column, row).copy_from(&block.transpose());
        }
        for (place, part) in self.gradient.iter().enumerate() {
            sums.gradient.fixed_rows_mut::<3>(3 * place).copy_from(part);
        }
        sums.cost = self.cost;
        sums
    }
}

/// The part of a covariance of all unknowns that belongs to the sensor on the flange.
#[must_use]
pub fn sensor_block(covariance: &Hessian) -> Matrix6<f64> {
    covariance.fixed_view::<6, 6>(0, 0).into_owned()
}

/// The axes along which poses are inverted: what a fixed sensor's problem was posed with.
#[must_use]
pub(super) fn lever_of_turns(errors: &Errors, base_from_flange: &Rigid, mount: Mount) -> Vec3 {
    errors.sensor_from_base
        * match mount {
            // An error of the flange's orientation turns what the sensor sees about the flange.
            Mount::OnFlange => errors.target_in_base - base_from_flange.translation.vector,
            // The poses are inverted: what is called base here is the flange, and turns about its own origin.
            Mount::Fixed => errors.target_in_base,
        }
}
