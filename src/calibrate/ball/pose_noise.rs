//! The robot's noise moves all points of a profile together: it is common to them and must be weighed as such.
//!
//! Per profile, with the information W from its points and the covariance S of the ball's centre by the pose, the centre
//! is known with (W⁻¹ + S)⁻¹ = W (I + S W)⁻¹. In this form a profile that is blind in a direction needs no inverse.

use crate::calibrate::observation::{CentreObservation, State};
use crate::calibrate::{Mount, Noise, SolveError};
use crate::geometry::so3::hat;
use crate::geometry::{Mat3, Vec3};

/// Standard deviations of position (mm) and orientation (rad) about each axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PoseNoise {
    pub position_std_mm: f64,
    pub orientation_std_rad: f64,
    /// Where the robot moves, which is what its orientation turns about.
    pub mount: Mount,
}

impl PoseNoise {
    /// A perfect robot.
    pub const NONE: Self = Self { position_std_mm: 0.0, orientation_std_rad: 0.0, mount: Mount::OnFlange };

    /// The noise that the user states, if all of it is stated; half of it would stand for a robot perfect in the other.
    pub fn stated(noise: &Noise, mount: Mount) -> Option<Self> {
        Some(Self { position_std_mm: noise.position_std_mm?, orientation_std_rad: noise.orientation_std_rad?, mount })
    }

    /// The noise, as a position noise, for which the profiles' centres scatter as much as they are expected to: the
    /// variance component by the method of moments.
    pub fn estimated(observations: &[CentreObservation], state: &State) -> Self {
        /// Arms do not repeat better than this, mm; below it the search may stop.
        const LEAST_MM: f64 = 1e-6;
        /// Worse than this is no noise, mm.
        const MOST_MM: f64 = 30.0;
        let noise = |position_std_mm: f64| Self { position_std_mm, ..Self::NONE };
        // With S = τ² I every direction of a profile stands alone: eᵀ (W⁻¹ + S)⁻¹ e is Σ (vᵀ g)² / (λ + τ² λ²) over the
        // eigenvectors v of W, with e = W⁻¹ g.
        let directions: Vec<(f64, f64)> = observations
            .iter()
            .flat_map(|observation| {
                let eigen = observation.information.symmetric_eigen();
                let along = eigen.eigenvectors.transpose() * residual_pull(observation, state);
                [0, 1, 2].map(|idx| (eigen.eigenvalues[idx], along[idx] * along[idx]))
            })
            .filter(|(eigenvalue, _)| *eigenvalue > 0.0)
            .collect();
        #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^52 profiles")]
        let freedom = directions.len() as f64 - 9.0;
        let excess = |std_mm: f64| {
            let variance = std_mm * std_mm;
            let chi_square: f64 = directions
                .iter()
                .map(|(eigenvalue, squared)| squared / (eigenvalue + variance * eigenvalue * eigenvalue))
                .sum();
            chi_square - freedom
        };
        if freedom <= 0.0 || excess(LEAST_MM) <= 0.0 {
            return noise(0.0);
        }
        let (mut low, mut high) = (LEAST_MM.ln(), MOST_MM.ln());
        // The sum falls with the noise: halve the interval until the figure is good to a per mille.
        while high - low > 1e-3 {
            let middle = 0.5 * (low + high);
            if excess(middle.exp()) > 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        noise((0.5 * (low + high)).exp())
    }

    /// Covariance of the ball's centre in the sensor frame by this noise at one pose, mm².
    ///
    /// The orientation acts with the lever from the flange to the ball.
    fn centre_covariance(&self, observation: &CentreObservation, state: &State) -> Mat3 {
        let position = Mat3::identity() * (self.position_std_mm * self.position_std_mm);
        let lever = match self.mount {
            // exp(ω) at the flange turns what the sensor sees about the flange.
            Mount::OnFlange => {
                let ball_in_flange =
                    observation.base_from_flange.inverse_transform_point(&state.ball_in_base.into()).coords;
                let rotation = state.flange_from_sensor.rotation.to_rotation_matrix();
                rotation.matrix().transpose() * hat(ball_in_flange)
            }
            // The poses are inverted: the ball is on the flange, at `ball_in_base`, and turns about its origin.
            Mount::Fixed => {
                let (_, sensor_from_base) = state.ball_in_sensor_and_rotation(&observation.base_from_flange);
                sensor_from_base * hat(state.ball_in_base)
            }
        };
        position + lever * lever.transpose() * (self.orientation_std_rad * self.orientation_std_rad)
    }
}

/// The same observation with the pose noise integrated out.
///
/// # Errors
/// [`SolveError::Diverged`] if the numbers are not finite.
pub(super) fn marginalised(
    observation: &CentreObservation,
    state: &State,
    noise: &PoseNoise,
) -> Result<CentreObservation, SolveError> {
    let covariance = noise.centre_covariance(observation, state);
    let damp = (Mat3::identity() + observation.information * covariance).try_inverse().ok_or(SolveError::Diverged)?;
    let information = damp * observation.information;
    Ok(CentreObservation {
        information: (information + information.transpose()) * 0.5,
        pull: damp * observation.pull,
        ..observation.clone()
    })
}

/// Half the negative gradient of an observation at the state.
fn residual_pull(observation: &CentreObservation, state: &State) -> Vec3 {
    let offset = state.ball_in_sensor(&observation.base_from_flange) - observation.centre_in_sensor;
    observation.pull - observation.information * offset
}

/// By how much the stations scatter more than their weights explain, at least 1; `None` with nothing left over.
///
/// Errors common to a sweep show between stations only, so whole stations are the sample.
pub(super) fn station_variance_factor(
    observations: &[CentreObservation],
    state: &State,
    num_stations: usize,
) -> Option<f64> {
    let mut chi_square = 0.0;
    for station in 0..num_stations {
        let (mut information, mut pull) = (Mat3::zeros(), Vec3::zeros());
        for observation in observations.iter().filter(|observation| observation.station == station) {
            let rotation =
                (observation.base_from_flange.rotation * state.flange_from_sensor.rotation).to_rotation_matrix();
            information += rotation.matrix() * observation.information * rotation.matrix().transpose();
            pull += rotation * residual_pull(observation, state);
        }
        let ridge = Mat3::identity() * (1e-12 * information.trace());
        if let Some(factor) = (information + ridge).cholesky() {
            chi_square += pull.dot(&factor.solve(&pull));
        }
    }
    let freedom = (3 * num_stations).checked_sub(9).filter(|freedom| *freedom > 0)?;
    #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^52 stations")]
    Some((chi_square / freedom as f64).max(1.0))
}
