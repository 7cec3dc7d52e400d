//! The start without a guess: fixed-point equations reduced to the rotation alone, solved on SO(3).
//!
//! For measured centres sᵢ the sum of squares is linear in the sensor's place and in the ball's, so both are eliminated
//! exactly; what remains depends on the rotation R through its nine entries only, and its size does not grow with the
//! number of poses. Twenty-four starts over all orientations then cost less than one pass over the stations.

use nalgebra::{SMatrix, SVector, SymmetricEigen, UnitQuaternion};

use crate::geometry::so3::{self, hat, nearest_rotation};
use crate::geometry::{Mat3, Rigid, Vec3};

use super::SolveError;
use super::observation::State;

type Vec9 = SVector<f64, 9>;
type Mat39 = SMatrix<f64, 3, 9>;

/// Mean squared rotation (rad²) about an axis below which it counts as none: 0.2°, above what a robot's display rounds.
const NO_ROTATION: f64 = 1.2e-5;

/// What the poses alone say: independent of the measured centres, so shared by all assignments of sides.
#[derive(Clone, Debug)]
pub struct PoseGeometry {
    rotations_inverse: Vec<Mat3>,
    /// Where the base's origin lies in each flange, with the sign turned: Aᵢᵀ aᵢ.
    offsets: Vec<Vec3>,
    mean_rotation_inverse: Mat3,
    mean_offset: Vec3,
    /// Inverse of Σ `ÃᵀÃ`.
    ball_covariance: Mat3,
    /// Eigenvalues of Σ `ÃᵀÃ` / n, rising: mean squared rotation about the three axes, rad².
    pub axis_movements: [f64; 3],
    /// The axis that the rotations move least, in the (mean) flange frame: the one they are about.
    pub common_axis_in_flange: Vec3,
}

impl PoseGeometry {
    /// From the poses of the stations.
    ///
    /// # Errors
    /// [`SolveError::NoRotation`] and [`SolveError::RotationsAboutOneAxis`] if no solution is unique.
    pub fn new(poses: &[Rigid]) -> Result<Self, SolveError> {
        Self::with_least_movement(poses, NO_ROTATION)
    }

    /// The same with another limit on the mean squared rotation (rad²) about an axis.
    ///
    /// # Errors
    /// As [`PoseGeometry::new`].
    pub fn with_least_movement(poses: &[Rigid], least: f64) -> Result<Self, SolveError> {
        #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^52 poses")]
        let scale = 1.0 / poses.len() as f64;
        let rotations_inverse: Vec<Mat3> =
            poses.iter().map(|pose| pose.rotation.to_rotation_matrix().matrix().transpose()).collect();
        let offsets: Vec<Vec3> =
            poses.iter().zip(&rotations_inverse).map(|(pose, inverse)| inverse * pose.translation.vector).collect();
        let mean_rotation_inverse = rotations_inverse.iter().sum::<Mat3>() * scale;
        let mean_offset = offsets.iter().sum::<Vec3>() * scale;
        let spread = rotations_inverse
            .iter()
            .map(|inverse| {
                let centred = inverse - mean_rotation_inverse;
                centred.transpose() * centred
            })
            .sum::<Mat3>();
        let eigen = SymmetricEigen::new(spread);
        let mut order = [0, 1, 2];
        order.sort_by(|a, b| eigen.eigenvalues[*a].total_cmp(&eigen.eigenvalues[*b]));
        let axis_movements = order.map(|idx| eigen.eigenvalues[idx] * scale);
        let common_axis_in_flange = (mean_rotation_inverse * eigen.eigenvectors.column(order[0]))
            .try_normalize(1e-9)
            .unwrap_or_else(Vec3::zeros);
        if axis_movements[2] < least {
            return Err(SolveError::NoRotation { span_deg: rotation_span(poses).to_degrees() });
        }
        if axis_movements[0] < least {
            return Err(SolveError::RotationsAboutOneAxis {
                axis_x: common_axis_in_flange.x,
                axis_y: common_axis_in_flange.y,
                axis_z: common_axis_in_flange.z,
            });
        }
        let ball_covariance = spread.try_inverse().ok_or(SolveError::Diverged)?;
        Ok(Self {
            rotations_inverse,
            offsets,
            mean_rotation_inverse,
            mean_offset,
            ball_covariance,
            axis_movements,
            common_axis_in_flange,
        })
    }

    /// The reduced problem for measured centres, one a pose.
    #[must_use]
    pub fn reduced(&self, centres_in_sensor: &[Vec3]) -> ReducedProblem<'_> {
        #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^52 poses")]
        let scale = 1.0 / centres_in_sensor.len() as f64;
        let mean_centre = centres_in_sensor.iter().sum::<Vec3>() * scale;
        let mut centre_spread = Mat3::zeros();
        let mut offset_by_centre = Mat3::zeros();
        let mut ball_by_rotation = Mat39::zeros();
        let mut ball_constant = Vec3::zeros();
        let mut constant = 0.0;
        for ((inverse, offset), centre) in self.rotations_inverse.iter().zip(&self.offsets).zip(centres_in_sensor) {
            let rotation = (inverse - self.mean_rotation_inverse).transpose();
            let offset = offset - self.mean_offset;
            let centre = centre - mean_centre;
            centre_spread += centre * centre.transpose();
            offset_by_centre += offset * centre.transpose();
            for column in 0..3 {
                let mut block = ball_by_rotation.fixed_view_mut::<3, 3>(0, 3 * column);
                block += rotation * centre[column];
            }
            ball_constant += rotation * offset;
            constant += centre.norm_squared() + offset.norm_squared();
        }
        ReducedProblem {
            poses: self,
            mean_centre,
            centre_spread,
            offset_by_centre,
            ball_by_rotation,
            ball_constant,
            constant,
        }
    }
}

/// Sum of squares as a function of the rotation alone.
#[derive(Clone, Debug)]
pub struct ReducedProblem<'a> {
    poses: &'a PoseGeometry,
    mean_centre: Vec3,
    centre_spread: Mat3,
    offset_by_centre: Mat3,
    ball_by_rotation: Mat39,
    ball_constant: Vec3,
    constant: f64,
}

/// A local minimum over the rotations.
#[derive(Clone, Copy, Debug)]
pub struct RotationMinimum {
    /// The rotation of the sensor on the flange.
    pub flange_from_sensor: UnitQuaternion<f64>,
    /// The sum of squares there, mm².
    pub cost: f64,
}

impl ReducedProblem<'_> {
    /// The best minimum: from the linear solution where it is at hand and fits, otherwise from all orientations.
    #[must_use]
    pub fn best_minimum(&self) -> RotationMinimum {
        if let Some(start) = self.linear_rotation() {
            let minimum = self.descend(start);
            // A residual of a twentieth of the spread of the data is no local minimum far off.
            if minimum.cost < 0.0025 * self.centre_spread.trace() {
                return minimum;
            }
        }
        let mut minima: Vec<RotationMinimum> =
            octahedral_rotations().into_iter().map(|start| self.descend(start)).collect();
        minima.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        minima[0]
    }

    /// The nine entries of the rotation as free unknowns, made a rotation afterwards.
    fn linear_rotation(&self) -> Option<UnitQuaternion<f64>> {
        let mut matrix = -self.ball_by_rotation.transpose() * self.poses.ball_covariance * self.ball_by_rotation;
        for row in 0..3 {
            for column in 0..3 {
                for axis in 0..3 {
                    matrix[(3 * row + axis, 3 * column + axis)] += self.centre_spread[(row, column)];
                }
            }
        }
        let right = self.ball_by_rotation.transpose() * self.poses.ball_covariance * self.ball_constant
            - Vec9::from_column_slice(self.offset_by_centre.as_slice());
        let entries = matrix.cholesky()?.solve(&right);
        nearest_rotation(&Mat3::from_column_slice(entries.as_slice()))
    }

    /// Descends to the nearest minimum by damped Gauss–Newton on SO(3).
    #[must_use]
    pub fn descend(&self, start: UnitQuaternion<f64>) -> RotationMinimum {
        let mut rotation = start;
        let mut cost = self.cost(&rotation);
        let mut damping = 1e-3;
        for _ in 0..60 {
            let matrix = rotation.to_rotation_matrix();
            let pull = self.pull(matrix.matrix());
            let mut gradient = Vec3::zeros();
            let mut ball_derivative = Mat3::zeros();
            for axis in 0..3 {
                let derivative = matrix.matrix() * hat(Vec3::ith(axis, 1.0));
                gradient[axis] = derivative.dot(&pull);
                ball_derivative
                    .set_column(axis, &(self.ball_by_rotation * Vec9::from_column_slice(derivative.as_slice())));
            }
            let hessian = Mat3::identity() * self.centre_spread.trace()
                - self.centre_spread
                - ball_derivative.transpose() * self.poses.ball_covariance * ball_derivative;
            let damped = hessian + Mat3::identity() * (damping * self.centre_spread.trace());
            let Some(step) = damped.cholesky().map(|factor| -factor.solve(&gradient)) else {
                damping *= 10.0;
                continue;
            };
            if step.norm() < 1e-14 {
                break;
            }
            let trial = rotation * so3::exp(step);
            let trial_cost = self.cost(&trial);
            if trial_cost < cost {
                rotation = trial;
                cost = trial_cost;
                damping *= 0.03;
            } else {
                damping = damping.max(1e-9) * 10.0;
                if damping > 1e3 {
                    break;
                }
            }
        }
        RotationMinimum { flange_from_sensor: rotation, cost }
    }

    fn ball(&self, rotation: &Mat3) -> Vec3 {
        let u = self.ball_by_rotation * Vec9::from_column_slice(rotation.as_slice()) + self.ball_constant;
        self.poses.ball_covariance * u
    }

    /// The sum of squares for a rotation, mm².
    #[must_use]
    pub fn cost(&self, rotation: &UnitQuaternion<f64>) -> f64 {
        let matrix = rotation.to_rotation_matrix();
        let u = self.ball_by_rotation * Vec9::from_column_slice(matrix.matrix().as_slice()) + self.ball_constant;
        self.constant + 2.0 * matrix.matrix().dot(&self.offset_by_centre) - u.dot(&(self.poses.ball_covariance * u))
    }

    /// Half the derivative of the cost by the entries of the rotation, the constant |R s|² left out.
    fn pull(&self, rotation: &Mat3) -> Mat3 {
        let by_ball = self.ball_by_rotation.transpose() * self.ball(rotation);
        self.offset_by_centre - Mat3::from_column_slice(by_ball.as_slice())
    }

    /// All unknowns for a rotation.
    #[must_use]
    pub fn state(&self, flange_from_sensor: UnitQuaternion<f64>) -> State {
        let matrix = flange_from_sensor.to_rotation_matrix();
        let ball_in_base = self.ball(matrix.matrix());
        let translation =
            self.poses.mean_rotation_inverse * ball_in_base - self.poses.mean_offset - matrix * self.mean_centre;
        State { flange_from_sensor: Rigid::from_parts(translation.into(), flange_from_sensor), ball_in_base }
    }
}

/// The angle of the largest rotation between two poses, rad.
#[must_use]
pub fn rotation_span(poses: &[Rigid]) -> f64 {
    let mut span = 0.0_f64;
    for (idx, pose) in poses.iter().enumerate() {
        for other in &poses[idx + 1..] {
            span = span.max(pose.rotation.angle_to(&other.rotation));
        }
    }
    span
}

/// The 24 rotations of a cube onto itself: no orientation is further than 63° from one of them.
#[must_use]
pub fn octahedral_rotations() -> Vec<UnitQuaternion<f64>> {
    let quarter = std::f64::consts::FRAC_PI_2;
    let faces = [
        Vec3::zeros(),
        Vec3::x() * quarter,
        Vec3::x() * (2.0 * quarter),
        Vec3::x() * (3.0 * quarter),
        Vec3::y() * quarter,
        Vec3::y() * (3.0 * quarter),
    ];
    faces
        .into_iter()
        .flat_map(|face| [0.0, 1.0, 2.0, 3.0].map(|turns| so3::exp(face) * so3::exp(Vec3::z() * (turns * quarter))))
        .collect()
}
