//! `plate-orthogonal`: every vector between two points of one edge is perpendicular to every one of the other.
//!
//! # Source
//! Chen et al. 2023, section 3, eq. 3–7: minimise `Σ_i Σ_j (v_pⁱ · v_qʲ)²` over the difference vectors of both edges.
//! The printed eq. 7 sums the products without their squares, which has no minimum; and unit vectors in place of
//! differences fail grossly, as short ones are all noise.
//!
//! # In O(N)
//! `Σ_i Σ_j (v_pⁱ · v_qʲ)² = tr(S_p S_q)` with `S = Σ v vᵀ`, and a sum over all pairs of differences of N things is N times
//! the sum over the things less their mean. So neither the cost nor its normal equations need pairs.
//!
//! The sensor's place acts on the differences as the flange turns between them, so it is found as well.

use nalgebra::{Matrix6, SMatrix, Vector6};

use crate::calibrate::Edge;
use crate::calibrate::SolveError;
use crate::geometry::{Mat3, Rigid, Vec3, se3};

use super::descent::{Descent, Sums, Unknowns, descend};
use super::points::{EdgePoint, tangent_size};

/// The unknowns of the published method.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SensorState(
    /// The sensor on the flange.
    pub Rigid,
);

impl Unknowns<6> for SensorState {
    fn stepped(&self, step: &Vector6<f64>) -> Self {
        Self(self.0 * se3::exp(step))
    }

    fn size(step: &Vector6<f64>) -> f64 {
        tangent_size(step)
    }
}

/// The points of one edge less their mean, and how these differences follow the unknowns.
struct Differences<const N: usize> {
    times: Vec<f64>,
    vectors: Vec<Vec3>,
    by_unknowns: Vec<SMatrix<f64, 3, N>>,
    /// Σ `v vᵀ`.
    scatter: Mat3,
    /// Σ `(∂v/∂u) vᵀ`, one a unknown.
    slopes: [Mat3; N],
}

impl<const N: usize> Differences<N> {
    fn new(points: &[(f64, Vec3, SMatrix<f64, 3, N>)]) -> Self {
        let total: f64 = points.iter().map(|(times, ..)| times).sum();
        let scale = if total > 0.0 { total.recip() } else { 0.0 };
        let mean: Vec3 = points.iter().map(|(times, place, _)| place * *times).sum::<Vec3>() * scale;
        let mean_by_unknowns: SMatrix<f64, 3, N> =
            points.iter().map(|(times, _, derivative)| derivative * *times).sum::<SMatrix<f64, 3, N>>() * scale;
        let vectors: Vec<Vec3> = points.iter().map(|(_, place, _)| place - mean).collect();
        let by_unknowns: Vec<SMatrix<f64, 3, N>> =
            points.iter().map(|(_, _, derivative)| derivative - mean_by_unknowns).collect();
        let times: Vec<f64> = points.iter().map(|(times, ..)| *times).collect();
        let mut scatter = Mat3::zeros();
        let mut slopes = [Mat3::zeros(); N];
        for ((vector, derivative), times) in vectors.iter().zip(&by_unknowns).zip(&times) {
            scatter += vector * vector.transpose() * *times;
            for (unknown, slope) in slopes.iter_mut().enumerate() {
                *slope += derivative.column(unknown) * vector.transpose() * *times;
            }
        }
        Self { times, vectors, by_unknowns, scatter, slopes }
    }
}

/// Cost and normal equations for any unknowns of which the places in the base are linear near the current ones; each point
/// with its edge, how often it counts, its place and how that follows the unknowns.
pub(super) fn orthogonality<const N: usize>(
    points: impl Iterator<Item = (Edge, f64, Vec3, SMatrix<f64, 3, N>)>,
) -> Sums<N> {
    let [p, q] = differences_of(points);
    let mut sums = Sums { cost: (p.scatter * q.scatter).trace(), ..Sums::zero() };
    for (own, other) in [(&p, &q), (&q, &p)] {
        for ((vector, derivative), times) in own.vectors.iter().zip(&own.by_unknowns).zip(&own.times) {
            let weighted = derivative.transpose() * other.scatter * *times;
            sums.hessian += weighted * derivative;
            sums.gradient -= weighted * vector;
        }
    }
    for row in 0..N {
        for column in 0..N {
            let crossed = (p.slopes[row] * q.slopes[column]).trace();
            sums.hessian[(row, column)] += crossed;
            sums.hessian[(column, row)] += crossed;
        }
    }
    sums
}

fn differences_of<const N: usize>(
    points: impl Iterator<Item = (Edge, f64, Vec3, SMatrix<f64, 3, N>)>,
) -> [Differences<N>; 2] {
    let mut of_edges = [Vec::new(), Vec::new()];
    for (edge, times, place, derivative) in points {
        of_edges[usize::from(edge == Edge::Q)].push((times, place, derivative));
    }
    of_edges.map(|points| Differences::new(&points))
}

fn placed<'a>(
    points: &'a [EdgePoint],
    flange_from_sensor: &'a Rigid,
    times: impl Fn(usize) -> f64 + 'a,
) -> impl Iterator<Item = (Edge, f64, Vec3, SMatrix<f64, 3, 6>)> + 'a {
    points.iter().map(move |point| {
        (
            point.edge,
            times(point.station),
            point.in_base(flange_from_sensor),
            point.in_base_by_sensor(flange_from_sensor),
        )
    })
}

/// Minimises from a start, each point as often as `times` says of its station.
///
/// # Errors
/// [`SolveError::Diverged`] if numbers run away.
pub fn minimise(
    points: &[EdgePoint],
    start: &Rigid,
    times: impl Fn(usize) -> f64 + Copy,
) -> Result<Descent<6, SensorState>, SolveError> {
    descend(|state: &SensorState| sums(points, &state.0, times), SensorState(*start))
}

/// Cost and normal equations at a sensor on the flange.
pub(super) fn sums(points: &[EdgePoint], flange_from_sensor: &Rigid, times: impl Fn(usize) -> f64) -> Sums<6> {
    orthogonality(placed(points, flange_from_sensor, times))
}

/// How the minimum follows the places of the points in the base: its change (rotation, translation) a mm of each, one
/// matrix a point. With the covariances of the places that gives the covariance of the result, which the plain inverse of
/// the normal equations does not: the products of differences are not independent.
#[must_use]
pub fn change_by_points(
    points: &[EdgePoint],
    flange_from_sensor: &Rigid,
    inverse: &Matrix6<f64>,
    times: impl Fn(usize) -> f64 + Copy,
) -> Vec<SMatrix<f64, 6, 3>> {
    let [p, q] = differences_of(placed(points, flange_from_sensor, times));
    let mut next = [0, 0];
    points
        .iter()
        .map(|point| {
            let is_q = usize::from(point.edge == Edge::Q);
            let (own, other) = if is_q == 1 { (&q, &p) } else { (&p, &q) };
            let place = next[is_q];
            next[is_q] += 1;
            // A shift of the mean changes no difference, so only the point's own row acts.
            let mut pull: SMatrix<f64, 6, 3> = own.by_unknowns[place].transpose() * other.scatter;
            for (unknown, slope) in other.slopes.iter().enumerate() {
                let crossed = slope.transpose() * own.vectors[place];
                pull.set_row(unknown, &(pull.row(unknown) + crossed.transpose()));
            }
            -inverse * pull * own.times[place]
        })
        .collect()
}
