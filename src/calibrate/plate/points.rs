//! Points on the two edges, and how well each is known across its edge.

use nalgebra::{Matrix2, Matrix2x3, Matrix6, SMatrix, SVector, Vector2, Vector6};

use crate::calibrate::Edge;
use crate::geometry::so3::hat;
use crate::geometry::{Mat3, Rigid, Vec3, se3};

use super::descent::{LEVER_MM, Sums, Unknowns};

/// Sensor on the flange and plate in the base: rotation and translation each, right perturbations.
pub const NUM_UNKNOWNS: usize = 12;

/// A point on an edge as the bundle sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EdgePoint {
    /// Its station's place in the list of those used.
    pub station: usize,
    /// The edge that it is on.
    pub edge: Edge,
    /// The pose, without its frames.
    pub base_from_flange: Rigid,
    /// In the sensor frame, mm.
    pub point_in_sensor: Vec3,
    /// Information about its place across the edge, along the two axes of the plate that [`across`] names, 1/mm².
    pub information: Matrix2<f64>,
}

/// The axes of the plate across an edge.
#[must_use]
pub const fn across(edge: Edge) -> [usize; 2] {
    match edge {
        Edge::P => [1, 2],
        Edge::Q => [0, 2],
    }
}

impl EdgePoint {
    /// Through a calibration, in the base, mm.
    #[must_use]
    pub fn in_base(&self, flange_from_sensor: &Rigid) -> Vec3 {
        let in_flange = flange_from_sensor.transform_point(&self.point_in_sensor.into());
        self.base_from_flange.transform_point(&in_flange).coords
    }

    /// The rotation from the sensor to the base.
    #[must_use]
    pub fn base_from_sensor(&self, flange_from_sensor: &Rigid) -> Mat3 {
        (self.base_from_flange.rotation * flange_from_sensor.rotation).to_rotation_matrix().into_inner()
    }

    /// How its place in the base follows (rotation, translation) of the sensor.
    #[must_use]
    pub fn in_base_by_sensor(&self, flange_from_sensor: &Rigid) -> SMatrix<f64, 3, 6> {
        let rotation = self.base_from_sensor(flange_from_sensor);
        let mut derivative = SMatrix::<f64, 3, 6>::zeros();
        derivative.fixed_view_mut::<3, 3>(0, 0).copy_from(&(rotation * -hat(self.point_in_sensor)));
        derivative.fixed_view_mut::<3, 3>(0, 3).copy_from(&rotation);
        derivative
    }
}

/// The unknowns of the bundle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlateState {
    /// The sensor on the flange.
    pub flange_from_sensor: Rigid,
    /// The plate in the base: the origin in its corner, x along edge p, y along edge q.
    pub base_from_plate: Rigid,
}

impl Unknowns<NUM_UNKNOWNS> for PlateState {
    fn stepped(&self, step: &SVector<f64, NUM_UNKNOWNS>) -> Self {
        Self {
            flange_from_sensor: self.flange_from_sensor * se3::exp(&step.fixed_rows::<6>(0).into_owned()),
            base_from_plate: self.base_from_plate * se3::exp(&step.fixed_rows::<6>(6).into_owned()),
        }
    }

    fn size(step: &SVector<f64, NUM_UNKNOWNS>) -> f64 {
        tangent_size(&step.fixed_rows::<6>(0).into_owned()) + tangent_size(&step.fixed_rows::<6>(6).into_owned())
    }
}

/// Rad, and mm over [`LEVER_MM`].
pub(in crate::calibrate) fn tangent_size(tangent: &Vector6<f64>) -> f64 {
    let (rotation, translation) = se3::split(tangent);
    rotation.norm() + translation.norm() / LEVER_MM
}

impl PlateState {
    /// A point in the plate's frame, mm.
    #[must_use]
    pub fn in_plate(&self, point: &EdgePoint) -> Vec3 {
        let in_base = point.in_base(&self.flange_from_sensor);
        self.base_from_plate.inverse_transform_point(&in_base.into()).coords
    }

    /// A point's distances from its edge, along the two axes of the plate across it, mm.
    #[must_use]
    pub fn off_edge(&self, point: &EdgePoint) -> Vector2<f64> {
        let in_plate = self.in_plate(point);
        let [first, second] = across(point.edge);
        Vector2::new(in_plate[first], in_plate[second])
    }

    /// The same as a vector in the base, mm.
    #[must_use]
    pub fn off_edge_in_base(&self, point: &EdgePoint) -> Vec3 {
        let mut off = self.in_plate(point);
        off[match point.edge {
            Edge::P => 0,
            Edge::Q => 1,
        }] = 0.0;
        self.base_from_plate.rotation * off
    }

    /// How the distances from the edge follow the unknowns.
    #[must_use]
    pub fn by_unknowns(&self, point: &EdgePoint) -> SMatrix<f64, 2, NUM_UNKNOWNS> {
        let across = self.across_in_base(point.edge);
        let in_plate = self.in_plate(point);
        let by_plate_rotation = hat(in_plate);
        let [first, second] = super::points::across(point.edge);
        let mut derivative = SMatrix::<f64, 2, NUM_UNKNOWNS>::zeros();
        derivative
            .fixed_view_mut::<2, 6>(0, 0)
            .copy_from(&(across * point.in_base_by_sensor(&self.flange_from_sensor)));
        for (row, axis) in [first, second].into_iter().enumerate() {
            for column in 0..3 {
                derivative[(row, 6 + column)] = by_plate_rotation[(axis, column)];
            }
            derivative[(row, 9 + axis)] = -1.0;
        }
        derivative
    }

    /// The two directions across an edge, in the base: one a row.
    #[must_use]
    pub fn across_in_base(&self, edge: Edge) -> Matrix2x3<f64> {
        let rotation = self.base_from_plate.rotation.to_rotation_matrix();
        let [first, second] = across(edge);
        Matrix2x3::from_rows(&[
            rotation.matrix().column(first).transpose(),
            rotation.matrix().column(second).transpose(),
        ])
    }

    /// The same unknowns with the plate's axes pointing from its corner to the points that were measured: a line has no
    /// sense, so four frames describe the same plate.
    #[must_use]
    pub fn towards(&self, points: &[EdgePoint]) -> Self {
        let sense = |edge: Edge, axis: usize| {
            let sum: f64 =
                points.iter().filter(|point| point.edge == edge).map(|point| self.in_plate(point)[axis]).sum();
            if sum < 0.0 { -1.0 } else { 1.0 }
        };
        let (x, y) = (sense(Edge::P, 0), sense(Edge::Q, 1));
        let half_turn = match (x < 0.0, y < 0.0) {
            (false, false) => return *self,
            (true, true) => Vec3::z(),
            (true, false) => Vec3::y(),
            (false, true) => Vec3::x(),
        };
        let turned = self.base_from_plate.rotation * crate::geometry::so3::exp(half_turn * std::f64::consts::PI);
        Self { base_from_plate: Rigid::from_parts(self.base_from_plate.translation, turned), ..*self }
    }
}

/// The sums of points, each as often as `times` says of its station.
#[must_use]
pub fn sums_of(points: &[EdgePoint], state: &PlateState, times: impl Fn(usize) -> f64) -> Sums<NUM_UNKNOWNS> {
    let mut sums = Sums::zero();
    for point in points {
        let times = times(point.station);
        if times > 0.0 {
            let off = state.off_edge(point);
            let weighted = point.information * times;
            let by_unknowns = state.by_unknowns(point);
            let pull = by_unknowns.transpose() * weighted;
            sums.hessian += pull * by_unknowns;
            sums.gradient -= pull * off;
            sums.cost += off.dot(&(weighted * off));
        }
    }
    sums
}

/// The part of a covariance of all unknowns that belongs to the sensor on the flange.
#[must_use]
pub fn sensor_block(covariance: &SMatrix<f64, NUM_UNKNOWNS, NUM_UNKNOWNS>) -> Matrix6<f64> {
    covariance.fixed_view::<6, 6>(0, 0).into_owned()
}

/// How far apart two states are: rad, and mm over [`LEVER_MM`].
pub(super) fn distance(before: &PlateState, after: &PlateState) -> f64 {
    let between = |a: &Rigid, b: &Rigid| {
        let change = a.inverse() * b;
        change.rotation.angle() + change.translation.vector.norm() / LEVER_MM
    };
    between(&before.flange_from_sensor, &after.flange_from_sensor)
        + between(&before.base_from_plate, &after.base_from_plate)
}
