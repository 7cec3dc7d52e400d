//! A plate's edges before the sensor: stations of the kind that a session has, and what they say about the sensor and the
//! plate.

use nalgebra::{Matrix2, Matrix3x2, SMatrix, UnitQuaternion};

use crate::calibrate::plate::points::NUM_UNKNOWNS;
use crate::calibrate::plate::{EdgePoint, PlateReduced, PlateState, of_pose};
use crate::calibrate::{Edge, Mount, Noise, Solution};
use crate::geometry::{Mat3, Rigid, Vec3};

use super::ball::{Room, extent};
use super::orientation::Orientations;
use super::search::{Aim, Candidate, Place, Subject, Taken, part_of};
use super::{Limits, PlanRefusal};

/// The sine of the least angle (30°) between an edge and the laser plane: along the line an edge is found badly.
const LEAST_CROSSING: f64 = 0.5;
/// The places that the grid tries: at both ends of the edge, in the middle of the view and in corners of it.
const PLACES: [Place; 6] =
    [[0.5, 0.5, 0.0], [0.5, 0.5, 1.0], [0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [1.0, 1.0, 0.0], [1.0, 1.0, 1.0]];
/// So many standard deviations of where the edge will be found have to lie within the view.
const SURE_AT_STDS: f64 = 2.0;

/// The information about (sensor on the flange; plate in the base).
pub(super) type PlateInformation = SMatrix<f64, NUM_UNKNOWNS, NUM_UNKNOWNS>;

/// What is measured with what, as far as it is known.
#[derive(Clone, Debug)]
pub(super) struct Plate {
    pub mount: Mount,
    pub state: PlateState,
    /// Variances of the robot's position (mm²) and orientation (rad²).
    pub pose_variances: [f64; 2],
    /// Where an edge may be in the sensor frame.
    pub room: Room,
    pub edges: Vec<EdgeModel>,
    /// The other edge stays at least so far from the point on the line, mm: a profile with both is read wrongly.
    pub least_apart_mm: f64,
    /// What is known of sensor and plate; `None` where there is no doubt that the edge is seen.
    pub doubt: Option<PlateInformation>,
}

/// Stations at one of the edges.
#[derive(Clone, Debug)]
pub(super) struct EdgeModel {
    pub edge: Edge,
    /// How well its points are known in the laser plane: covariance of (x, z), mm².
    pub in_plane: Matrix2<f64>,
    /// Where it may be crossed, from the corner, mm.
    pub along_mm: [f64; 2],
    pub orientations: Orientations,
}

impl Plate {
    /// As a solution has it, with points as they were seen on each edge.
    ///
    /// # Errors
    /// [`PlanRefusal`].
    pub fn of(reduced: &PlateReduced, solution: &Solution, limits: &Limits) -> Result<Self, PlanRefusal> {
        let noise = solution.noise.map_or([0.0; 2], |noise| [noise.position_std_mm, noise.orientation_std_rad]);
        let mut plate = Self {
            mount: solution.mount,
            state: reduced.state,
            pose_variances: noise.map(|std| std * std),
            room: Room::new(limits, reduced.points.iter().map(|point| point.point_in_sensor)),
            edges: Vec::new(),
            least_apart_mm: least_apart_mm(&reduced.state, &reduced.points),
            doubt: None,
        };
        if plate.room.is_empty() {
            return Err(PlanRefusal::NothingWithinLimits);
        }
        plate.edges = [Edge::P, Edge::Q]
            .into_iter()
            .filter(|edge| limits.allows(*edge))
            .map(|edge| {
                let points = || reduced.points.iter().filter(move |point| point.edge == edge);
                Ok(EdgeModel {
                    edge,
                    in_plane: plate.typical_in_plane(points(), &reduced.points).ok_or(PlanRefusal::Undetermined)?,
                    along_mm: beyond(
                        extent(points().map(|point| plate.state.in_plate(point)[along(edge)])),
                        limits.beyond_mm,
                    ),
                    orientations: Orientations::about_mean_of(
                        points().map(|point| base_from_sensor(&plate.state, point)),
                        limits,
                    )?,
                })
            })
            .collect::<Result<_, PlanRefusal>>()?;
        Ok(plate)
    }

    /// The covariance in the laser plane of the point in the middle by how well it is known: what is known across the edge,
    /// less the part of the pose, carried back along the edge.
    fn typical_in_plane<'a>(
        &self,
        points: impl Iterator<Item = &'a EdgePoint>,
        all: &[EdgePoint],
    ) -> Option<Matrix2<f64>> {
        let mut covariances: Vec<Matrix2<f64>> = points
            .filter_map(|point| {
                let across = self.state.across_in_base(point.edge);
                let num_at_pose = all.iter().filter(|other| other.base_from_flange == point.base_from_flange).count();
                #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^52 points")]
                let num_at_pose = num_at_pose as f64;
                let of_pose = self.of_pose(&point.in_base(&self.state.flange_from_sensor), &point.base_from_flange);
                let of_profile = point.information.try_inverse()? - across * of_pose * across.transpose() * num_at_pose;
                let back = (across * in_plane_axes(&base_from_sensor(&self.state, point))).try_inverse()?;
                // A station measures as often as those before it; its captures share their pose.
                Some(back * of_profile * back.transpose() / num_at_pose)
            })
            .collect();
        covariances.sort_by(|a, b| a.trace().total_cmp(&b.trace()));
        covariances.get(covariances.len() / 2).copied()
    }

    fn of_pose(&self, in_base: &Vec3, base_from_flange: &Rigid) -> Mat3 {
        let [position, orientation] = self.pose_variances;
        of_pose(position, orientation, *in_base, base_from_flange, self.mount)
    }

    fn aim_at(&self, candidate: &Candidate) -> Aim {
        let model = &self.edges[candidate.kind];
        let [across, range, part_along] = candidate.place;
        let mut in_plate = Vec3::zeros();
        in_plate[along(model.edge)] = part_of(model.along_mm, part_along);
        Aim {
            point_in_sensor: Vec3::new(part_of(self.room.across_mm, across), 0.0, part_of(self.room.along_mm, range)),
            point_in_base: self.state.base_from_plate.transform_point(&in_plate.into()).coords,
            edge: Some(model.edge),
        }
    }

    /// Whether the crossing is sure to be in view: by how much it may be off in the laser plane follows from by how much
    /// the point that is aimed at may be off the edge.
    fn is_sure(&self, point: &EdgePoint, off_edge: &Matrix2<f64>, base_from_sensor: &UnitQuaternion<f64>) -> bool {
        let across = self.state.across_in_base(point.edge);
        let Some(back) = (across * in_plane_axes(base_from_sensor)).try_inverse() else { return false };
        let variances = (back * off_edge * back.transpose()).diagonal();
        [(0, self.room.across_mm), (2, self.room.along_mm)].into_iter().zip(variances.iter()).all(
            |((axis, [least, most]), variance)| {
                let doubt_mm = SURE_AT_STDS * variance.max(0.0).sqrt();
                let place = point.point_in_sensor[axis];
                (least..=most).contains(&(place - doubt_mm)) && (least..=most).contains(&(place + doubt_mm))
            },
        )
    }
}

impl Subject<NUM_UNKNOWNS> for Plate {
    fn num_kinds(&self) -> usize {
        self.edges.len()
    }

    fn orientations(&self, kind: usize) -> &Orientations {
        &self.edges[kind].orientations
    }

    fn places(&self) -> &[Place] {
        &PLACES
    }

    fn may_be_lost(&self) -> bool {
        self.doubt.is_some()
    }

    fn aim(&self, candidate: &Candidate) -> Aim {
        self.aim_at(candidate)
    }

    fn brings(&self, candidate: &Candidate, base_from_sensor: &UnitQuaternion<f64>) -> Option<PlateInformation> {
        let model = &self.edges[candidate.kind];
        let Aim { point_in_sensor, point_in_base, .. } = self.aim_at(candidate);
        let edge_in_base = self.state.base_from_plate.rotation * unit_along(model.edge);
        let normal = base_from_sensor * Vec3::y();
        let is_useful = edge_in_base.dot(&normal).abs() >= LEAST_CROSSING
            && to_other_edge_mm(&self.state, model.edge, &point_in_base, &normal) >= self.least_apart_mm;
        if !is_useful {
            return None;
        }
        let origin = point_in_base - base_from_sensor * point_in_sensor;
        let base_from_flange =
            Rigid::from_parts(origin.into(), *base_from_sensor) * self.state.flange_from_sensor.inverse();
        let across = self.state.across_in_base(model.edge);
        let axes = in_plane_axes(base_from_sensor);
        let in_base = axes * model.in_plane * axes.transpose() + self.of_pose(&point_in_base, &base_from_flange);
        let information = (across * in_base * across.transpose()).try_inverse()?;
        let point = EdgePoint { station: 0, edge: model.edge, base_from_flange, point_in_sensor, information };
        let by_unknowns = self.state.by_unknowns(&point);
        if let Some(covariance) = &self.doubt {
            let off_edge = by_unknowns * covariance * by_unknowns.transpose();
            if !self.is_sure(&point, &off_edge, base_from_sensor) {
                return None;
            }
        }
        Some(by_unknowns.transpose() * information * by_unknowns)
    }
}

/// Where an edge may be crossed that goes on beyond where it was: no nearer to the corner than so far, unless it was there.
fn beyond([least, most]: [f64; 2], beyond_mm: f64) -> [f64; 2] {
    [(least - beyond_mm).max(least.min(beyond_mm)), most + beyond_mm]
}

/// How near the other edge came to the point on the line so far, mm.
pub(super) fn least_apart_mm(state: &PlateState, points: &[EdgePoint]) -> f64 {
    let apart_mm = |point: &EdgePoint| {
        let normal = base_from_sensor(state, point) * Vec3::y();
        to_other_edge_mm(state, point.edge, &point.in_base(&state.flange_from_sensor), &normal)
    };
    points.iter().map(apart_mm).fold(f64::INFINITY, f64::min)
}

/// From a point on an edge to where the laser plane meets the other one, mm; infinite if it does so off the plate.
fn to_other_edge_mm(state: &PlateState, edge: Edge, point_in_base: &Vec3, normal: &Vec3) -> f64 {
    let other = state.base_from_plate.rotation
        * match edge {
            Edge::P => Vec3::y(),
            Edge::Q => Vec3::x(),
        };
    let corner = state.base_from_plate.translation.vector;
    let along_mm = normal.dot(&(point_in_base - corner)) / normal.dot(&other);
    if along_mm.is_finite() && along_mm > 0.0 {
        (corner + other * along_mm - point_in_base).norm()
    } else {
        f64::INFINITY
    }
}

/// The information of the points that a solution used.
pub(super) fn information(reduced: &PlateReduced) -> PlateInformation {
    let of_point = |point: &EdgePoint| {
        let by_unknowns = reduced.state.by_unknowns(point);
        by_unknowns.transpose() * point.information * by_unknowns
    };
    reduced.points.iter().map(of_point).sum()
}

/// The stations that were measured.
pub(super) fn taken(reduced: &PlateReduced) -> Vec<Taken> {
    let of_point =
        |point: &EdgePoint| Taken { base_from_sensor: base_from_sensor(&reduced.state, point), edge: Some(point.edge) };
    reduced.points.iter().map(of_point).collect()
}

/// The middle of the points that were seen, in the sensor frame, mm.
pub(super) fn middle_of_points(reduced: &PlateReduced) -> Vec3 {
    #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^52 points")]
    let scale = 1.0 / reduced.points.len().max(1) as f64;
    reduced.points.iter().map(|point| point.point_in_sensor).sum::<Vec3>() * scale
}

/// The axis of the plate along an edge.
pub(super) const fn along(edge: Edge) -> usize {
    match edge {
        Edge::P => 0,
        Edge::Q => 1,
    }
}

fn unit_along(edge: Edge) -> Vec3 {
    match edge {
        Edge::P => Vec3::x(),
        Edge::Q => Vec3::y(),
    }
}

fn base_from_sensor(state: &PlateState, point: &EdgePoint) -> UnitQuaternion<f64> {
    point.base_from_flange.rotation * state.flange_from_sensor.rotation
}

/// The axes x and z of the sensor in the base.
fn in_plane_axes(base_from_sensor: &UnitQuaternion<f64>) -> Matrix3x2<f64> {
    Matrix3x2::from_columns(&[base_from_sensor * Vec3::x(), base_from_sensor * Vec3::z()])
}

/// Variances of a robot's position (mm²) and orientation (rad²) as far as they are stated; those of a good arm otherwise.
pub(super) fn pose_variances(noise: &Noise) -> [f64; 2] {
    let position = noise.position_std_mm.unwrap_or(super::nominal::POSITION_STD_MM);
    let orientation = noise.orientation_std_rad.unwrap_or_else(|| super::nominal::ORIENTATION_STD_DEG.to_radians());
    [position * position, orientation * orientation]
}
