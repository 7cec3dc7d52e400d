//! A camera that tracks its own motion drifts: what it measures are steps, not places.
//!
//! A step B from one pose to the next goes with the flange's step A by A X = X B. Left over is E = X⁻¹ A⁻¹ X B, about the later
//! pose's axes. Both ends of the flange's step have the robot's noise, and neighbouring steps share an end, so their errors are
//! tied: the covariance is tridiagonal in blocks of six, and a block Cholesky factor whitens it at a cost that grows with the
//! steps only.

use nalgebra::{Matrix6, SMatrix, SVector, Vector6};

use crate::calibrate::components::product;
use crate::calibrate::plate::descent::{Descent, Sums, Unknowns, descend_from};
use crate::calibrate::plate::points::tangent_size;
use crate::calibrate::{Mount, SolveError};
use crate::geometry::so3::hat;
use crate::geometry::{Mat3, Rigid, Vec3, se3, so3};

/// The variance, rad² or mm², of a step about which nothing is known, as over a gap; and what a step that is not to be believed
/// has more. It breaks the chain.
pub const UNKNOWN_STEP: f64 = 1e9;

/// Whether anything is known of a step with this covariance.
pub(super) fn is_known(covariance: &Matrix6<f64>) -> bool {
    covariance[(0, 0)] < 0.5 * UNKNOWN_STEP
}

/// A pose of the track: of the flange (inverted for a fixed sensor) and of the camera, and what the step that leads here may be
/// off by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackPose {
    /// When, by the camera's clock, s.
    pub time_s: f64,
    /// A; inverted for a fixed sensor.
    pub base_from_flange: Rigid,
    /// Where the camera says that it is.
    pub world_from_sensor: Rigid,
    /// Of (rotation, translation) along the axes of the camera here, rad² and mm², as stated.
    pub covariance: Matrix6<f64>,
    /// Whether the camera kept its way on the step that leads here.
    pub is_believed: bool,
}

/// The sensor on the flange.
#[derive(Clone, Copy, Debug)]
pub(super) struct SensorState(pub Rigid);

impl Unknowns<6> for SensorState {
    fn stepped(&self, step: &SVector<f64, 6>) -> Self {
        Self(self.0 * se3::exp(step))
    }

    fn size(step: &SVector<f64, 6>) -> f64 {
        tangent_size(step)
    }
}

/// What the steps are weighed by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackNoise {
    /// Variance of each coordinate of the robot's position, of every pose by itself, mm².
    pub position: f64,
    /// The same of its orientation about each axis, rad².
    pub orientation: f64,
    /// By how much larger than stated the variances of the steps' rotations are.
    pub rotation_factor: f64,
    /// The same of their translations.
    pub translation_factor: f64,
}

/// A step's error and what it follows.
pub(super) struct Step {
    pub error: Vector6<f64>,
    by_sensor: Matrix6<f64>,
    /// How the error follows one of the pose before, in the sensor's axes there.
    by_before: Matrix6<f64>,
    /// The step's own noise.
    pub own: Matrix6<f64>,
    /// The robot's, of the pose before and of the one here.
    robot: [Matrix6<f64>; 2],
}

impl Step {
    pub fn of(before: &TrackPose, here: &TrackPose, sensor: &Rigid, noise: &TrackNoise, mount: Mount) -> Self {
        let of_sensor = before.world_from_sensor.inverse() * here.world_from_sensor;
        let of_flange = here.base_from_flange.inverse() * before.base_from_flange;
        let left = sensor.inverse() * of_flange * sensor * of_sensor;
        let by_before = se3::adjoint(&of_sensor.inverse());
        let error = se3::join(so3::log(&left.rotation), left.translation.vector);
        let mut by_sensor = by_before - Matrix6::identity();
        let turned = by_sensor.fixed_view::<3, 3>(3, 0) + hat(left.translation.vector);
        by_sensor.fixed_view_mut::<3, 3>(3, 0).copy_from(&turned);
        Self {
            error,
            by_sensor,
            by_before,
            own: noise.of_step(here),
            robot: [before, here].map(|pose| noise.of_robot(pose, sensor, mount)),
        }
    }

    pub fn covariance(&self) -> Matrix6<f64> {
        self.own + self.of_robot()
    }

    /// What the robot's noise at both ends adds.
    pub fn of_robot(&self) -> Matrix6<f64> {
        product(&product(&self.by_before, &self.robot[0]), &self.by_before.transpose()) + self.robot[1]
    }
}

impl TrackNoise {
    fn of_step(&self, pose: &TrackPose) -> Matrix6<f64> {
        let (rotation, translation) = (self.rotation_factor.sqrt(), self.translation_factor.sqrt());
        let scale = se3::join(Vec3::repeat(rotation), Vec3::repeat(translation));
        let own = pose.covariance.component_mul(&(scale * scale.transpose()));
        if pose.is_believed { own } else { own + Matrix6::identity() * UNKNOWN_STEP }
    }

    /// Of the robot's pose, carried to the sensor's axes: the same in all directions, it only gains the lever.
    fn of_robot(&self, pose: &TrackPose, sensor: &Rigid, mount: Mount) -> Matrix6<f64> {
        let lever = hat(match mount {
            Mount::OnFlange => sensor.inverse_transform_vector(&-sensor.translation.vector),
            // The poses are inverted: an error about the flange's axes is one about the outer axes here.
            Mount::Fixed => (pose.base_from_flange * sensor).inverse().translation.vector,
        });
        let turned = lever * self.orientation;
        let mut covariance = Matrix6::identity() * self.orientation;
        covariance.fixed_view_mut::<3, 3>(3, 0).copy_from(&turned);
        covariance.fixed_view_mut::<3, 3>(0, 3).copy_from(&turned.transpose());
        let shifted = turned * lever.transpose() + Mat3::identity() * self.position;
        covariance.fixed_view_mut::<3, 3>(3, 3).copy_from(&shifted);
        covariance
    }
}

/// The track with what it is weighed by.
#[derive(Clone, Copy)]
pub(super) struct Track<'a> {
    pub poses: &'a [TrackPose],
    pub noise: TrackNoise,
    pub mount: Mount,
}

impl Track<'_> {
    fn steps<'s>(&'s self, sensor: &'s Rigid) -> impl Iterator<Item = Step> + 's {
        self.poses.windows(2).map(|pair| Step::of(&pair[0], &pair[1], sensor, &self.noise, self.mount))
    }

    /// For each step, whitened: how its error follows the sensor (six columns), and the error; `None` if a covariance is none.
    ///
    /// A step is judged given the one before, so that the rows of any steps may be taken apart; those of all are the whole.
    pub fn rows(&self, sensor: &Rigid) -> Option<Vec<SMatrix<f64, 6, 7>>> {
        let mut all: Vec<SMatrix<f64, 6, 7>> = Vec::with_capacity(self.poses.len());
        let mut previous: Option<(Matrix6<f64>, Matrix6<f64>)> = None;
        for step in self.steps(sensor) {
            let mut rows = SMatrix::<f64, 6, 7>::zeros();
            rows.fixed_view_mut::<6, 6>(0, 0).copy_from(&step.by_sensor);
            rows.set_column(6, &step.error);
            let mut covariance = step.covariance();
            if let (Some((robot, factor)), Some(whitened)) = (previous, all.last()) {
                // What this step shares with the one before: the pose between them.
                let shared = product(&-step.by_before, &robot);
                let tied = factor.solve_lower_triangular(&shared.transpose())?;
                covariance -= product(&tied.transpose(), &tied);
                rows -= product(&tied.transpose(), whitened);
            }
            let factor = covariance.cholesky()?.l();
            all.push(factor.solve_lower_triangular(&rows)?);
            previous = Some((step.robot[1], factor));
        }
        Some(all)
    }

    /// The sums, those of each step as often as `times` says of it.
    pub fn sums(&self, sensor: &Rigid, times: impl Fn(usize) -> f64) -> Sums<6> {
        let Some(rows) = self.rows(sensor) else { return Sums { cost: f64::NAN, ..Sums::zero() } };
        sums_of_rows(rows.iter().enumerate().map(|(step, rows)| (rows, times(step))))
    }

    /// # Errors
    /// [`SolveError::Diverged`] if numbers run away.
    pub fn minimise(
        &self,
        start: Rigid,
        times: impl Fn(usize) -> f64 + Copy,
    ) -> Result<Descent<6, SensorState>, SolveError> {
        descend_from(|state: &SensorState| self.sums(&state.0, times), SensorState(start), 1e-9, 1e-10)
    }

    /// The square of each step's error over its covariance, and the error.
    pub fn squares(&self, sensor: &Rigid) -> Vec<(f64, Vector6<f64>)> {
        self.steps(sensor)
            .map(|step| {
                let square =
                    step.covariance().cholesky().map_or(0.0, |factor| step.error.dot(&factor.solve(&step.error)));
                (square, step.error)
            })
            .collect()
    }
}

/// The sums of whitened rows, each as often as is said beside it.
pub(super) fn sums_of_rows<'a>(rows: impl Iterator<Item = (&'a SMatrix<f64, 6, 7>, f64)>) -> Sums<6> {
    let mut sums = Sums::<6>::zero();
    for (rows, times) in rows.filter(|(_, times)| *times > 0.0) {
        let by_sensor = rows.fixed_view::<6, 6>(0, 0).into_owned();
        let error = rows.column(6).into_owned();
        sums.hessian += product(&by_sensor.transpose(), &by_sensor) * times;
        sums.gradient -= by_sensor.transpose() * error * times;
        sums.cost += error.norm_squared() * times;
    }
    sums
}

/// The covariance of a step about which nothing is stated: a usual tracker on a table-top scene.
pub(super) fn usual_covariance() -> Matrix6<f64> {
    const ROTATION_STD: f64 = 1e-3;
    const TRANSLATION_STD_MM: f64 = 1.0;
    let variances = se3::join(Vec3::repeat(ROTATION_STD.powi(2)), Vec3::repeat(TRANSLATION_STD_MM.powi(2)));
    Matrix6::from_diagonal(&variances)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_errors_follow_the_sensor_as_they_say() {
        let pose =
            |shift: [f64; 3], turn: [f64; 3]| Rigid::from_parts(Vec3::from(shift).into(), so3::exp(Vec3::from(turn)));
        let sensor = pose([40.0, -20.0, 90.0], [0.2, -1.4, 2.0]);
        let track = |base_from_flange: Rigid| TrackPose {
            time_s: 0.0,
            base_from_flange,
            world_from_sensor: base_from_flange * sensor,
            covariance: usual_covariance(),
            is_believed: true,
        };
        let poses =
            [track(pose([500.0, 0.0, 300.0], [0.1, 3.0, 0.2])), track(pose([450.0, 30.0, 330.0], [0.5, 2.8, 0.1]))];
        let noise = TrackNoise { position: 0.01, orientation: 1e-7, rotation_factor: 1.0, translation_factor: 1.0 };
        let step = |sensor: &Rigid| Step::of(&poses[0], &poses[1], sensor, &noise, Mount::OnFlange);
        assert!(step(&sensor).error.norm() < 1e-9);
        for column in 0..6 {
            let mut delta = Vector6::zeros();
            delta[column] = 1e-6;
            let ahead = step(&(sensor * se3::exp(&delta))).error;
            let behind = step(&(sensor * se3::exp(&-delta))).error;
            let difference = (ahead - behind) / 2e-6 - step(&sensor).by_sensor.column(column);
            // Rounding of 500 mm over the step.
            assert!(difference.norm() < 1e-6, "column {column}: {difference}");
        }
    }
}
