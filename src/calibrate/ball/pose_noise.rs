//! The robot's noise moves all points of a profile together, and its lack of accuracy all profiles of a station: it is
//! common to them and must be weighed as such.
//!
//! Per profile, with the information W from its points and the covariance S of the ball's centre by the pose, the centre
//! is known with (W⁻¹ + S)⁻¹ = W (I + S W)⁻¹. In this form a profile that is blind in a direction needs no inverse. What
//! is common to a station is integrated out of its sums, see
//! [`Normal::with_common_shift`](crate::calibrate::solver::Normal::with_common_shift).

use crate::calibrate::observation::{CentreObservation, NUM_UNKNOWNS, State};
use crate::calibrate::{AboveStated, BallProblem, Mount, NoiseModel, SolveError};
use crate::geometry::so3::hat;
use crate::geometry::{Mat3, Rigid};

use super::variance_components::{Components, NUM_COMPONENTS, VarianceSpread};

/// With fewer stations than this the error common to a station is taken as one of position alone.
const MIN_STATIONS_FOR_COMMON_ORIENTATION: usize = 8;
/// With fewer equations left over than this position and orientation are not told apart: one variance of position is
/// known better than two that share what little there is.
const MIN_FREEDOM_FOR_ORIENTATION: usize = 30;

/// Variances of position (mm²) and orientation (rad²) about each axis: of every pose by itself, and common to a station.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PoseNoise {
    variances: [f64; NUM_COMPONENTS],
    is_estimated: [bool; NUM_COMPONENTS],
    is_stated: bool,
    /// Where the robot moves, which is what its orientation turns about.
    pub mount: Mount,
}

impl PoseNoise {
    /// As far as the problem states it; the rest is to be estimated. Nothing is common to a station.
    pub fn of(problem: &BallProblem, num_poses: usize) -> Self {
        let (position, orientation) = (problem.noise.position_std_mm, problem.noise.orientation_std_rad);
        let can_tell = (3 * num_poses).saturating_sub(NUM_UNKNOWNS) >= MIN_FREEDOM_FOR_ORIENTATION;
        Self {
            variances: [position, orientation, None, None].map(|std| std.map_or(0.0, |std| std * std)),
            is_estimated: [position.is_none(), orientation.is_none() && can_tell, false, false],
            is_stated: position.is_some() && orientation.is_some(),
            mount: problem.mount,
        }
    }

    /// The same with errors common to a station, to be estimated on top: a robot's repeatability says nothing of its
    /// accuracy. `None` where they look the same as those of single poses.
    pub fn with_common(self, has_sweeps: bool, num_stations: usize) -> Option<Self> {
        let [position, orientation, ..] = self.is_estimated;
        let has_orientation = has_sweeps && num_stations >= MIN_STATIONS_FOR_COMMON_ORIENTATION;
        (has_sweeps || self.is_stated)
            .then_some(Self { is_estimated: [position, orientation, true, has_orientation], ..self })
    }

    /// Where noise is to be estimated, that of a good arm in its place: fixed, for data that are not settled yet and would
    /// take every misfit for noise.
    pub fn nominal(self) -> Self {
        const POSITION_STD_MM: f64 = 0.05;
        const ORIENTATION_STD_RAD: f64 = 3e-4;
        let mut variances = self.variances;
        for (idx, std) in [POSITION_STD_MM, ORIENTATION_STD_RAD].into_iter().enumerate() {
            if self.is_estimated[idx] {
                variances[idx] = std * std;
            }
        }
        Self { variances, ..self.fixed() }
    }

    /// The same with the noise of single poses to be estimated after all.
    pub const fn reopened(self) -> Self {
        Self { is_estimated: [true, true, false, false], ..self }
    }

    /// Known noise of a size so many times this one.
    pub fn scaled(self, ratio: f64) -> Self {
        Self { variances: self.variances.map(|variance| variance * ratio * ratio), ..self.fixed() }
    }

    /// The same with nothing left to estimate.
    pub const fn fixed(self) -> Self {
        Self { is_estimated: [false; NUM_COMPONENTS], ..self }
    }

    /// Whether anything is to be estimated.
    pub fn is_open(&self) -> bool {
        self.is_estimated.contains(&true)
    }

    /// Whether all of the noise of single poses is stated.
    pub const fn is_stated(&self) -> bool {
        self.is_stated
    }

    /// Standard deviation of the position of each pose by itself, mm.
    pub fn position_std_mm(&self) -> f64 {
        self.variances[0].sqrt()
    }

    /// The largest standard deviation of a position, mm.
    pub fn largest_std_mm(&self) -> f64 {
        self.variances[0].max(self.variances[2]).sqrt()
    }

    /// For the reader.
    pub fn model(&self, above_stated: Option<AboveStated>) -> NoiseModel {
        let [position, orientation, station_position, station_orientation] = self.variances.map(f64::sqrt);
        NoiseModel {
            position_std_mm: position,
            orientation_std_rad: orientation,
            station_position_std_mm: station_position,
            station_orientation_std_rad: station_orientation,
            is_stated: self.is_stated,
            above_stated,
        }
    }

    /// Fits what is to be estimated to observations by points alone, linearised at `state` and ordered by station.
    ///
    /// # Errors
    /// [`SolveError::Undetermined`] if they leave an unknown free.
    pub fn estimate(
        &mut self,
        observations: &[CentreObservation],
        state: &State,
    ) -> Result<VarianceSpread, SolveError> {
        let components = Components::new(observations, state, self, &self.is_estimated);
        let (variances, spread) = components.fit(self.variances)?;
        self.variances = variances;
        Ok(spread)
    }

    /// Covariance of the ball's centre in the sensor frame by the noise of one pose, mm².
    fn own_covariance(&self, base_from_flange: &Rigid, state: &State) -> Mat3 {
        let [position, orientation, ..] = self.variances;
        Mat3::identity() * position + lever_covariance(base_from_flange, state, self.mount) * orientation
    }

    /// Covariance of the ball's centre in the sensor frame by what is common to a station, mm².
    pub fn common_covariance(&self, first_pose: &Rigid, state: &State) -> Mat3 {
        let [.., position, orientation] = self.variances;
        Mat3::identity() * position + lever_covariance(first_pose, state, self.mount) * orientation
    }
}

/// Covariance of the ball's centre in the sensor frame by a unit variance of the orientation, which acts with the lever from
/// the flange to the ball, mm².
pub(super) fn lever_covariance(base_from_flange: &Rigid, state: &State, mount: Mount) -> Mat3 {
    let lever = match mount {
        // exp(ω) at the flange turns what the sensor sees about the flange.
        Mount::OnFlange => {
            let ball_in_flange = base_from_flange.inverse_transform_point(&state.ball_in_base.into()).coords;
            let rotation = state.flange_from_sensor.rotation.to_rotation_matrix();
            rotation.matrix().transpose() * hat(ball_in_flange)
        }
        // The poses are inverted: the ball is on the flange, at `ball_in_base`, and turns about its origin.
        Mount::Fixed => {
            let (_, sensor_from_base) = state.ball_in_sensor_and_rotation(base_from_flange);
            sensor_from_base * hat(state.ball_in_base)
        }
    };
    lever * lever.transpose()
}

/// The same observation with the noise of its own pose integrated out.
///
/// # Errors
/// [`SolveError::Diverged`] if the numbers are not finite.
pub(super) fn marginalised(
    observation: &CentreObservation,
    state: &State,
    noise: &PoseNoise,
) -> Result<CentreObservation, SolveError> {
    let covariance = noise.own_covariance(&observation.base_from_flange, state);
    let damp = (Mat3::identity() + observation.information * covariance).try_inverse().ok_or(SolveError::Diverged)?;
    let information = damp * observation.information;
    let pull = damp * observation.pull;
    Ok(CentreObservation {
        information: (information + information.transpose()) * 0.5,
        pull,
        constant: observation.constant - pull.dot(&(covariance * observation.pull)),
        ..observation.clone()
    })
}
