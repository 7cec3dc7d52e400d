//! A camera that tracks its own motion drifts: what it measures are steps, not places.
//!
//! A step B from one pose to the next goes with the flange's step A by A X = X B. Left over is E = X⁻¹ A⁻¹ X B, about the later
//! pose's axes. Both ends of the flange's step have the robot's noise, and neighbouring steps share an end, so their errors are
//! tied: the covariance is tridiagonal in blocks of six, and a block Cholesky factor whitens it at a cost that grows with the
//! steps only.

use nalgebra::{Matrix6, SMatrix, SVector, Vector6};

use crate::calibrate::plate::descent::{Descent, Sums, Unknowns, descend_from};
use crate::calibrate::plate::points::tangent_size;
use crate::calibrate::{Mount, SolveError};
use crate::geometry::so3::hat;
use crate::geometry::{Rigid, Vec3, se3, so3};

/// A step that is not to be believed has this variance more, rad² or mm²: it breaks the chain.
const UNKNOWN: f64 = 1e9;

/// A pose of the track: of the flange (inverted for a fixed sensor) and of the camera, and what the step that leads here may be
/// off by.
#[derive(Clone, Copy, Debug)]
pub(super) struct TrackPose {
    pub base_from_flange: Rigid,
    pub world_from_sensor: Rigid,
    /// Of (rotation, translation) along the axes of the camera here, rad² and mm².
    pub covariance: Matrix6<f64>,
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

/// The noise of the robot (mm², rad²), and by how much larger than stated the steps' variances are.
#[derive(Clone, Copy, Debug)]
pub(super) struct TrackNoise {
    pub position: f64,
    pub orientation: f64,
    pub rotation_factor: f64,
    pub translation_factor: f64,
}

/// A step's error and what it follows.
struct Step {
    error: Vector6<f64>,
    by_sensor: Matrix6<f64>,
    /// How the error follows one of the pose before, in the sensor's axes there.
    by_before: Matrix6<f64>,
    /// The step's own noise.
    own: Matrix6<f64>,
    /// The robot's, of the pose before and of the one here.
    robot: [Matrix6<f64>; 2],
}

impl Step {
    fn of(before: &TrackPose, here: &TrackPose, sensor: &Rigid, noise: &TrackNoise, mount: Mount) -> Self {
        let of_sensor = before.world_from_sensor.inverse() * here.world_from_sensor;
        let of_flange = here.base_from_flange.inverse() * before.base_from_flange;
        let left = sensor.inverse() * of_flange * sensor * of_sensor;
        let by_before = adjoint(&of_sensor.inverse());
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

    fn covariance(&self) -> Matrix6<f64> {
        self.own + self.by_before * self.robot[0] * self.by_before.transpose() + self.robot[1]
    }
}

impl TrackNoise {
    fn of_step(&self, pose: &TrackPose) -> Matrix6<f64> {
        let (rotation, translation) = (self.rotation_factor.sqrt(), self.translation_factor.sqrt());
        let scale = Matrix6::from_diagonal(&se3::join(Vec3::repeat(rotation), Vec3::repeat(translation)));
        let own = scale * pose.covariance * scale;
        if pose.is_believed { own } else { own + Matrix6::identity() * UNKNOWN }
    }

    /// Of the robot's pose, carried to the sensor's axes.
    fn of_robot(&self, pose: &TrackPose, sensor: &Rigid, mount: Mount) -> Matrix6<f64> {
        let own = Matrix6::from_diagonal(&se3::join(Vec3::repeat(self.orientation), Vec3::repeat(self.position)));
        let to_sensor = adjoint(&match mount {
            Mount::OnFlange => sensor.inverse(),
            // The poses are inverted: an error about the flange's axes is one about the outer axes here.
            Mount::Fixed => (pose.base_from_flange * sensor).inverse(),
        });
        to_sensor * own * to_sensor.transpose()
    }
}

/// How a twist (rotation, translation) looks in other axes.
fn adjoint(motion: &Rigid) -> Matrix6<f64> {
    let rotation = motion.rotation.to_rotation_matrix().into_inner();
    let mut adjoint = Matrix6::zeros();
    adjoint.fixed_view_mut::<3, 3>(0, 0).copy_from(&rotation);
    adjoint.fixed_view_mut::<3, 3>(3, 3).copy_from(&rotation);
    adjoint.fixed_view_mut::<3, 3>(3, 0).copy_from(&(hat(motion.translation.vector) * rotation));
    adjoint
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

    /// The whitened sums.
    pub fn sums(&self, sensor: &Rigid) -> Sums<6> {
        let mut sums = Sums::<6>::zero();
        let mut previous: Option<(Matrix6<f64>, Matrix6<f64>, SMatrix<f64, 6, 7>)> = None;
        for step in self.steps(sensor) {
            let mut rows = SMatrix::<f64, 6, 7>::zeros();
            rows.fixed_view_mut::<6, 6>(0, 0).copy_from(&step.by_sensor);
            rows.set_column(6, &step.error);
            let mut covariance = step.covariance();
            if let Some((robot, factor, whitened)) = previous {
                // What this step shares with the one before: the pose between them.
                let shared = -step.by_before * robot;
                let Some(tied) = factor.solve_lower_triangular(&shared.transpose()) else { return nothing() };
                covariance -= tied.transpose() * tied;
                rows -= tied.transpose() * whitened;
            }
            let Some(factor) = covariance.cholesky().map(|factor| factor.l()) else { return nothing() };
            let Some(whitened) = factor.solve_lower_triangular(&rows) else { return nothing() };
            let by_sensor = whitened.fixed_view::<6, 6>(0, 0).into_owned();
            let error = whitened.column(6).into_owned();
            sums.hessian += by_sensor.transpose() * by_sensor;
            sums.gradient -= by_sensor.transpose() * error;
            sums.cost += error.norm_squared();
            previous = Some((step.robot[1], factor, whitened));
        }
        sums
    }

    /// # Errors
    /// [`SolveError::Diverged`] if numbers run away.
    pub fn minimise(&self, start: Rigid) -> Result<Descent<6, SensorState>, SolveError> {
        descend_from(|state: &SensorState| self.sums(&state.0), SensorState(start), 1e-9, 1e-10)
    }

    /// By how much larger the variances of rotation and translation of the steps are than stated: what the errors scatter by
    /// beyond the robot's noise. The median of the squares, so that a few lost steps do not count.
    pub fn factors(&self, sensor: &Rigid) -> [f64; 2] {
        /// A χ² with three degrees of freedom has this median.
        const MEDIAN: f64 = 2.366;
        /// Steps without noise keep a little, so that they can be weighed.
        const LEAST: f64 = 1e-8;
        let mut ratios = [Vec::new(), Vec::new()];
        let unscaled =
            Self { noise: TrackNoise { rotation_factor: 1.0, translation_factor: 1.0, ..self.noise }, ..*self };
        let mut robot_share = [0.0; 2];
        for (step, here) in unscaled.steps(sensor).zip(&self.poses[1..]) {
            if !here.is_believed {
                continue;
            }
            let robot = step.covariance() - step.own;
            for (part, ratios) in ratios.iter_mut().enumerate() {
                let trace = |covariance: &Matrix6<f64>| covariance.fixed_view::<3, 3>(3 * part, 3 * part).trace() / 3.0;
                let own = trace(&step.own);
                ratios.push(step.error.fixed_rows::<3>(3 * part).norm_squared() / own);
                robot_share[part] += trace(&robot) / own;
            }
        }
        #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^52 steps")]
        let count = ratios[0].len().max(1) as f64;
        [0, 1].map(|part| {
            let scatter = crate::geometry::stats::median(&mut ratios[part]) / MEDIAN;
            let left = scatter - robot_share[part] / count;
            // Less than a hundredth of what is seen cannot be told from the robot's noise.
            if left.is_finite() { left.max(0.01 * scatter).max(LEAST) } else { 1.0 }
        })
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

/// Sums that no step can be made from: a covariance that is none.
fn nothing() -> Sums<6> {
    Sums { cost: f64::NAN, ..Sums::zero() }
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
