//! What a capture says about the ball's centre: the common form in which all ball methods meet.

use nalgebra::SMatrix;

use crate::geometry::{Mat3, Rigid, Vec3};

/// The nine unknowns: sensor on the flange (rotation, translation; right perturbation), ball in the base.
pub const NUM_UNKNOWNS: usize = 9;

/// A quadratic in the ball's centre `s` in the sensor frame:
/// `(s − c)ᵀ W (s − c) − 2 gᵀ (s − c) + k` with the linearisation point `c`, the information `W`, the pull `g` and the cost
/// `k` that it has there.
///
/// A measured centre has `c` at the measurement and no pull. A profile far from its own optimum, or one that is blind in
/// a direction, needs no inverse of `W` in this form.
#[derive(Clone, Debug, PartialEq)]
pub struct CentreObservation {
    /// Index of the station in the list that a method uses.
    pub station: usize,
    /// The pose, without its frames.
    pub base_from_flange: Rigid,
    /// The point about which the quadratic is given, mm.
    pub centre_in_sensor: Vec3,
    /// Information about the centre, 1/mm².
    pub information: Mat3,
    /// Half the negative gradient at the linearisation point, 1/mm.
    pub pull: Vec3,
    /// The cost at the linearisation point.
    pub constant: f64,
}

impl CentreObservation {
    /// A centre that was measured, with unit weight.
    #[must_use]
    pub fn point(station: usize, base_from_flange: Rigid, centre_in_sensor: Vec3) -> Self {
        Self {
            station,
            base_from_flange,
            centre_in_sensor,
            information: Mat3::identity(),
            pull: Vec3::zeros(),
            constant: 0.0,
        }
    }

    /// Half the negative gradient at a state: what the data still pull with, 1/mm.
    #[must_use]
    pub fn pull_at(&self, state: &State) -> Vec3 {
        self.pull - self.information * (state.ball_in_sensor(&self.base_from_flange) - self.centre_in_sensor)
    }

    /// A pull along the directions that the observation knows about, each over its σ: of unit variance if the data are as
    /// their weights say.
    pub fn whitened(&self, pull: Vec3) -> impl Iterator<Item = f64> {
        /// Directions with less than this part of the largest information are blind ones: the rest of the data fits them.
        const BLIND_PART: f64 = 1e-6;
        let eigen = self.information.symmetric_eigen();
        let least = BLIND_PART * eigen.eigenvalues.max();
        [0, 1, 2]
            .into_iter()
            .filter(move |idx| eigen.eigenvalues[*idx] > least)
            .map(move |idx| eigen.eigenvectors.column(idx).dot(&pull) / eigen.eigenvalues[idx].sqrt())
    }

    /// One measured centre a station, with unit weight.
    #[must_use]
    pub fn points(base_from_flange: &[Rigid], centres_in_sensor: &[Vec3]) -> Vec<Self> {
        base_from_flange
            .iter()
            .zip(centres_in_sensor)
            .enumerate()
            .map(|(station, (pose, centre))| Self::point(station, *pose, *centre))
            .collect()
    }
}

/// The unknowns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State {
    /// The sensor on the flange.
    pub flange_from_sensor: Rigid,
    /// The ball's centre in the base, mm.
    pub ball_in_base: Vec3,
}

impl State {
    /// The ball's centre in the sensor frame at a pose.
    #[must_use]
    pub fn ball_in_sensor(&self, base_from_flange: &Rigid) -> Vec3 {
        let ball_in_flange =
            base_from_flange.rotation.inverse() * (self.ball_in_base - base_from_flange.translation.vector);
        self.flange_from_sensor.rotation.inverse() * (ball_in_flange - self.flange_from_sensor.translation.vector)
    }

    /// The ball's centre in the sensor frame at a pose, and the rotation from base to sensor.
    ///
    /// With `s = X⁻¹ T⁻¹ b` and `X ← X exp(ω, v)`: ds = s × ω − v + C db, C this rotation.
    #[must_use]
    pub fn ball_in_sensor_and_rotation(&self, base_from_flange: &Rigid) -> (Vec3, Mat3) {
        let sensor_from_base = (base_from_flange.rotation * self.flange_from_sensor.rotation)
            .to_rotation_matrix()
            .into_inner()
            .transpose();
        // R_Xᵀ (Tᵀ (b − t) − t_X), with both rotations in one.
        let shift = self.flange_from_sensor.rotation.inverse() * self.flange_from_sensor.translation.vector;
        let centre = sensor_from_base * (self.ball_in_base - base_from_flange.translation.vector) - shift;
        (centre, sensor_from_base)
    }

    /// The state after a step in the tangent.
    #[must_use]
    pub fn stepped(&self, step: &SMatrix<f64, NUM_UNKNOWNS, 1>) -> Self {
        let tangent = step.fixed_rows::<6>(0).into_owned();
        Self {
            flange_from_sensor: self.flange_from_sensor * crate::geometry::se3::exp(&tangent),
            ball_in_base: self.ball_in_base + step.fixed_rows::<3>(6),
        }
    }
}
