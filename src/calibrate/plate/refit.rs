//! What is left of a plate's data once a method has settled: enough to solve again without some stations.

use nalgebra::{Matrix6, SMatrix, Vector6};

use crate::calibrate::{Edge, Method, SolveError};
use crate::geometry::{Rigid, se3};

use super::descent::{Sums, Unknowns, descend, inverse_of};
use super::measured::MIN_POINTS;
use super::points::{EdgePoint, NUM_UNKNOWNS, PlateState, sums_of, tangent_size};
use super::{bundle, orthogonal};

/// The data at the minimum: each point with what it says across its edge.
#[derive(Clone, Debug, PartialEq)]
pub struct PlateReduced {
    /// The method, which solves again as it solved.
    pub method: Method,
    /// In the order of stations and poses.
    pub points: Vec<EdgePoint>,
    /// Number of stations that the points are of.
    pub num_stations: usize,
    /// The unknowns at the minimum; of the published method the plate is fitted afterwards.
    pub state: PlateState,
}

/// What solving again gave.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlateRefit {
    /// The unknowns.
    pub state: PlateState,
    /// Their covariance, as right perturbations along the axes of sensor and plate.
    pub covariance: SMatrix<f64, NUM_UNKNOWNS, NUM_UNKNOWNS>,
}

/// The plate alone.
#[derive(Clone, Copy)]
struct PlateOnly(Rigid);

impl Unknowns<6> for PlateOnly {
    fn stepped(&self, step: &Vector6<f64>) -> Self {
        Self(self.0 * se3::exp(step))
    }

    fn size(step: &Vector6<f64>) -> f64 {
        tangent_size(step)
    }
}

impl PlateReduced {
    /// Solves again with every station taken as often as `times` says, from this minimum.
    ///
    /// # Errors
    /// [`SolveError::TooFewEdgePoints`] or [`SolveError::Undetermined`] if what is left does not do.
    pub fn solve_with_times(&self, times: impl Fn(usize) -> f64 + Copy) -> Result<PlateRefit, SolveError> {
        let count =
            |edge: Edge| self.points.iter().filter(|point| point.edge == edge && times(point.station) > 0.0).count();
        let (found_p, found_q) = (count(Edge::P), count(Edge::Q));
        if found_p < MIN_POINTS || found_q < MIN_POINTS {
            return Err(SolveError::TooFewEdgePoints { found_p, found_q, needed: MIN_POINTS, refusal: None });
        }
        if self.method == Method::PlateOrthogonal {
            return published(&self.points, &self.state, times);
        }
        let found = bundle::minimise(&self.points, self.state, times)?;
        Ok(PlateRefit { state: found.unknowns, covariance: inverse_of(&found.sums.hessian)? })
    }

    /// Solves again with the stations that `is_used` names.
    ///
    /// # Errors
    /// As [`Self::solve_with_times`].
    pub fn solve_with(&self, is_used: impl Fn(usize) -> bool + Copy) -> Result<PlateRefit, SolveError> {
        self.solve_with_times(|station| if is_used(station) { 1.0 } else { 0.0 })
    }

    /// The solutions made without each station in turn; `None` where what is left does not do.
    #[must_use]
    pub fn without_each(&self) -> Vec<Option<PlateRefit>> {
        (0..self.num_stations).map(|left_out| self.solve_with(|station| station != left_out).ok()).collect()
    }
}

/// The published method from a start near its minimum, with the plate fitted to its points.
///
/// # Errors
/// [`SolveError::Undetermined`] if a combination of the unknowns is free.
pub(super) fn published(
    points: &[EdgePoint],
    start: &PlateState,
    times: impl Fn(usize) -> f64 + Copy,
) -> Result<PlateRefit, SolveError> {
    let found = orthogonal::minimise(points, &start.flange_from_sensor, times)?;
    let flange_from_sensor = found.unknowns.0;
    let on_plate = |plate: &PlateOnly| {
        let state = PlateState { flange_from_sensor, base_from_plate: plate.0 };
        let sums = sums_of(points, &state, times);
        Sums {
            hessian: sums.hessian.fixed_view::<6, 6>(6, 6).into_owned(),
            gradient: sums.gradient.fixed_rows::<6>(6).into_owned(),
            cost: sums.cost,
        }
    };
    let plate = descend(on_plate, PlateOnly(start.base_from_plate))?;
    let state = PlateState { flange_from_sensor, base_from_plate: plate.unknowns.0 };
    Ok(PlateRefit { state, covariance: covariance_of_published(points, &state, times)? })
}

/// The covariance of a method's minimum, by the information that the points have.
///
/// # Errors
/// [`SolveError::Undetermined`] if a combination of the unknowns is free.
pub(super) fn covariance_at(
    method: Method,
    points: &[EdgePoint],
    state: &PlateState,
) -> Result<SMatrix<f64, NUM_UNKNOWNS, NUM_UNKNOWNS>, SolveError> {
    if method == Method::PlateOrthogonal {
        return covariance_of_published(points, state, |_| 1.0);
    }
    inverse_of(&sums_of(points, state, |_| 1.0).hessian)
}

fn covariance_of_published(
    points: &[EdgePoint],
    state: &PlateState,
    times: impl Fn(usize) -> f64 + Copy,
) -> Result<SMatrix<f64, NUM_UNKNOWNS, NUM_UNKNOWNS>, SolveError> {
    let flange_from_sensor = &state.flange_from_sensor;
    let inverse = inverse_of(&orthogonal::sums(points, flange_from_sensor, times).hessian)?;
    let mut sensor_covariance = Matrix6::zeros();
    for (point, change) in points.iter().zip(orthogonal::change_by_points(points, flange_from_sensor, &inverse, times))
    {
        let across = change * state.across_in_base(point.edge).transpose();
        let covariance = point.information.try_inverse().ok_or(SolveError::Diverged)?;
        sensor_covariance += across * covariance * across.transpose();
    }
    // The plate follows the sensor, and has a covariance of its own besides.
    let hessian = sums_of(points, state, times).hessian;
    let coupling = hessian.fixed_view::<6, 6>(6, 0).into_owned();
    let of_plate = inverse_of(&hessian.fixed_view::<6, 6>(6, 6).into_owned())?;
    let follows = -of_plate * coupling;
    let mut covariance = SMatrix::<f64, NUM_UNKNOWNS, NUM_UNKNOWNS>::zeros();
    let by_plate = follows * sensor_covariance;
    for (row, column, block) in [
        (0, 0, sensor_covariance),
        (6, 0, by_plate),
        (0, 6, by_plate.transpose()),
        (6, 6, of_plate + by_plate * follows.transpose()),
    ] {
        covariance.fixed_view_mut::<6, 6>(row, column).copy_from(&block);
    }
    Ok(covariance)
}
