//! The published formulation in the nine elements that a point meets: first and third column of the rotation, and the
//! translation (Chen et al. 2023, eq. 3–7), under constraints.
//!
//! Eq. 4 asks for columns of unit length and forgets that they have to be perpendicular: what it leaves is no rotation.
//! [`solve`] takes that third constraint or leaves it out, so that the defect can be shown; the methods proper work on
//! SE(3), where nothing can be forgotten.
//!
//! All constraints are equations, so the interior-point method of the paper has no interior to keep to; they are imposed by
//! penalties with multipliers (Nocedal & Wright 2006, section 17.3).

use nalgebra::{SMatrix, SVector};

use crate::calibrate::{PlateProblem, SolveError};
use crate::geometry::so3::nearest_rotation;
use crate::geometry::{Flange, Mat3, Sensor, Transform, Vec3};

use super::descent::{LEVER_MM, Sums, Unknowns, descend};
use super::measured::measured;
use super::orthogonal::orthogonality;
use super::points::EdgePoint;
use super::start::starts;

/// The penalty as so many times the data's own curvature.
const PENALTY: f64 = 10.0;
/// Rounds of multipliers; each lowers what is left of the constraints about by the penalty.
const MAX_ROUNDS: usize = 40;
/// The constraints hold to this.
const HOLDS: f64 = 1e-12;

/// What the nine elements came out as.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NineElements {
    /// First column of the rotation.
    pub first_column: Vec3,
    /// Third column of the rotation.
    pub third_column: Vec3,
    /// The translation, mm.
    pub translation_mm: Vec3,
    /// The angle between the two columns, rad: a right angle in a rotation.
    pub between_columns_rad: f64,
    /// The nearest rotation with that translation.
    pub flange_from_sensor: Transform<Flange, Sensor>,
    /// The sum that is minimised, mm⁴.
    pub cost: f64,
    /// Whether the descent settled with the constraints fulfilled.
    pub converged: bool,
}

type Nine = SVector<f64, 9>;

#[derive(Clone, Copy)]
struct Elements(Nine);

impl Unknowns<9> for Elements {
    fn stepped(&self, step: &Nine) -> Self {
        Self(self.0 + step)
    }

    fn size(step: &Nine) -> f64 {
        step.fixed_rows::<6>(0).norm() + step.fixed_rows::<3>(6).norm() / LEVER_MM
    }
}

impl Elements {
    fn part(&self, first: usize) -> Vec3 {
        self.0.fixed_rows::<3>(first).into_owned()
    }

    /// What is left of the constraints, and how they follow the elements.
    fn constraints(&self) -> [(f64, Nine); 3] {
        let (first, third) = (self.part(0), self.part(3));
        let row = |by_first: Vec3, by_third: Vec3| {
            let mut row = Nine::zeros();
            row.fixed_rows_mut::<3>(0).copy_from(&by_first);
            row.fixed_rows_mut::<3>(3).copy_from(&by_third);
            row
        };
        [
            (first.norm_squared() - 1.0, row(first * 2.0, Vec3::zeros())),
            (third.norm_squared() - 1.0, row(Vec3::zeros(), third * 2.0)),
            (first.dot(&third), row(third, first)),
        ]
    }

    /// A point of a profile in the base, and how it follows the elements: linear, eq. 3.
    fn placed(&self, point: &EdgePoint) -> (Vec3, SMatrix<f64, 3, 9>) {
        let rotation = point.base_from_flange.rotation.to_rotation_matrix().into_inner();
        let mut derivative = SMatrix::<f64, 3, 9>::zeros();
        for (column, factor) in [(0, point.point_in_sensor.x), (3, point.point_in_sensor.z), (6, 1.0)] {
            derivative.fixed_view_mut::<3, 3>(0, column).copy_from(&(rotation * factor));
        }
        (derivative * self.0 + point.base_from_flange.translation.vector, derivative)
    }
}

/// Solves in the nine elements, with or without the constraint that the paper forgot.
///
/// # Errors
/// [`SolveError`] if nothing can be computed from this problem.
pub fn solve(problem: &PlateProblem, with_right_angle: bool) -> Result<NineElements, SolveError> {
    let (measured, _) = measured(problem)?;
    let points: Vec<EdgePoint> = measured.iter().map(|measured| measured.point).collect();
    let minima = starts(problem).into_iter().filter_map(|start| {
        let rotation = start.rotation.to_rotation_matrix();
        let mut elements = Nine::zeros();
        elements.fixed_rows_mut::<3>(0).copy_from(&rotation.matrix().column(0));
        elements.fixed_rows_mut::<3>(3).copy_from(&rotation.matrix().column(2));
        elements.fixed_rows_mut::<3>(6).copy_from(&start.translation.vector);
        minimise(&points, Elements(elements), with_right_angle).ok()
    });
    minima
        .filter(|found| found.cost.is_finite())
        .min_by(|a, b| (!a.converged).cmp(&!b.converged).then(a.cost.total_cmp(&b.cost)))
        .ok_or(SolveError::Diverged)
}

fn minimise(points: &[EdgePoint], start: Elements, with_right_angle: bool) -> Result<NineElements, SolveError> {
    let num_constraints = if with_right_angle { 3 } else { 2 };
    let data = |elements: &Elements| {
        orthogonality(points.iter().map(|point| {
            let (place, derivative) = elements.placed(point);
            (point.edge, 1.0, place, derivative)
        }))
    };
    let penalty = PENALTY * data(&start).hessian.fixed_view::<6, 6>(0, 0).trace();
    let mut elements = start;
    let mut shifts = [0.0; 3];
    let mut converged = false;
    for _ in 0..MAX_ROUNDS {
        let found = descend(
            |elements: &Elements| {
                let mut sums: Sums<9> = data(elements);
                for ((left, row), shift) in elements.constraints().iter().zip(shifts).take(num_constraints) {
                    sums.hessian += row * row.transpose() * penalty;
                    sums.gradient -= row * (penalty * (left + shift));
                    sums.cost += penalty * (left + shift).powi(2);
                }
                sums
            },
            elements,
        )?;
        elements = found.unknowns;
        let left = elements.constraints().map(|(left, _)| left);
        for (shift, left) in shifts.iter_mut().zip(left).take(num_constraints) {
            *shift += left;
        }
        converged = left[..num_constraints].iter().all(|left| left.abs() < HOLDS);
        if converged {
            break;
        }
    }
    let (first, third) = (elements.part(0), elements.part(3));
    let rotation =
        nearest_rotation(&Mat3::from_columns(&[first, third.cross(&first), third])).ok_or(SolveError::Diverged)?;
    Ok(NineElements {
        first_column: first,
        third_column: third,
        translation_mm: elements.part(6),
        between_columns_rad: first.angle(&third),
        flange_from_sensor: Transform::from_parts(elements.part(6), rotation),
        cost: data(&elements).cost,
        converged,
    })
}
