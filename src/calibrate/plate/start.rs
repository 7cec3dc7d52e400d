//! Where to begin: the operator's rough mounting, or many orientations.

use nalgebra::{Matrix2, SymmetricEigen};

use crate::calibrate::rotation_start::octahedral_rotations;
use crate::calibrate::{Edge, PlateProblem};
use crate::geometry::so3::{self, nearest_rotation};
use crate::geometry::{Mat3, Rigid, Vec3};

use super::points::{EdgePoint, PlateState};

/// Turns of the operator's rough mounting to begin at as well, rad: about as far off as it may be.
const ROUGHLY: f64 = 0.26;

/// The places to begin at: sensors on the flange.
pub(super) fn starts(problem: &PlateProblem) -> Vec<Rigid> {
    match &problem.rough_flange_from_sensor {
        Some(rough) => {
            let axes = [Vec3::x(), Vec3::y(), Vec3::z()];
            let turns = axes.iter().flat_map(|axis| [axis * ROUGHLY, axis * -ROUGHLY]);
            std::iter::once(Vec3::zeros())
                .chain(turns)
                .map(|turn| Rigid::from_parts(rough.rigid().translation, rough.rotation() * so3::exp(turn)))
                .collect()
        }
        None => octahedral_rotations()
            .into_iter()
            .map(|rotation| Rigid::from_parts(nalgebra::Translation3::identity(), rotation))
            .collect(),
    }
}

/// The plate that the points show through a calibration: a line through each edge's points, made perpendicular.
///
/// `None` if the points of an edge coincide, or the lines are parallel.
pub(super) fn plate_through(points: &[EdgePoint], flange_from_sensor: &Rigid) -> Option<Rigid> {
    let [(place_p, along_p), (place_q, along_q)] =
        [Edge::P, Edge::Q].map(|edge| line_through(points, edge, flange_from_sensor));
    // Both directions give way alike.
    let normal = along_p.cross(&along_q).try_normalize(1e-9)?;
    let rotation = nearest_rotation(&Mat3::from_columns(&[along_p, along_q, normal]))?;
    let (x, y) = (rotation * Vec3::x(), rotation * Vec3::y());
    // The corner: where the lines come nearest to each other.
    let between = place_q - place_p;
    let skew = x.dot(&y);
    let travel =
        Matrix2::new(1.0, -skew, skew, -1.0).try_inverse()? * nalgebra::Vector2::new(x.dot(&between), y.dot(&between));
    let corner = (place_p + x * travel.x + place_q + y * travel.y) * 0.5;
    Some(Rigid::from_parts(corner.into(), rotation))
}

fn line_through(points: &[EdgePoint], edge: Edge, flange_from_sensor: &Rigid) -> (Vec3, Vec3) {
    let places: Vec<Vec3> =
        points.iter().filter(|point| point.edge == edge).map(|point| point.in_base(flange_from_sensor)).collect();
    #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^52 points")]
    let mean = places.iter().sum::<Vec3>() / places.len() as f64;
    let scatter: Mat3 = places.iter().map(|place| (place - mean) * (place - mean).transpose()).sum();
    let eigen = SymmetricEigen::new(scatter);
    (mean, eigen.eigenvectors.column(eigen.eigenvalues.imax()).into_owned())
}

/// The same as unknowns to begin with.
pub(super) fn state_at(points: &[EdgePoint], flange_from_sensor: &Rigid) -> Option<PlateState> {
    Some(PlateState {
        flange_from_sensor: *flange_from_sensor,
        base_from_plate: plate_through(points, flange_from_sensor)?,
    })
}
