//! A live cell before the first solution from a plate: what the points so far say about a mounting that was only guessed,
//! and where to measure next without losing the edge.
//!
//! As with a ball ([`super::rough`]) the first stations turn little, and the more the estimate improves the further the next
//! ones go. Three points tell where the plate lies: two on one edge, one on the other.

use nalgebra::Matrix2;

use crate::calibrate::plate::descent::{Sums, descend, inverse_of};
use crate::calibrate::plate::points::{NUM_UNKNOWNS, sums_of};
use crate::calibrate::plate::{EdgePoint, PlateState};
use crate::calibrate::{Edge, Mount, Noise};
use crate::geometry::{Base, Flange, Mat3, Rigid, Transform, Vec3, so3};

use super::ball::{Room, extent};
use super::information::Information;
use super::orientation::Orientations;
use super::plate::{EdgeModel, Plate, PlateInformation, along, least_apart_mm, pose_variances};
use super::rough::{GUESS_STD_DEG, GUESS_STD_MM, Guess, LEAST_STD_MM};
use super::search::{Search, Taken};
use super::{Limits, PlanRefusal, PlannedStation, View};

/// σ of where a plate lies by a rough mounting, about and along each axis.
const PLATE_STD_DEG: f64 = 10.0;
const PLATE_STD_MM: f64 = 30.0;
/// Noise of a point in the laser plane along either axis, mm: that of common profilers.
const POINT_STD_MM: f64 = 0.03;
/// Points an edge from which a calibration can be made.
const MIN_POINTS: usize = 3;

/// A point of an edge with where it was seen from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeenEdge {
    /// The pose, as the controller reports it.
    pub base_from_flange: Transform<Base, Flange>,
    /// The edge that the line crossed.
    pub edge: Edge,
    /// The point in the sensor frame, mm.
    pub point_in_sensor_mm: Vec3,
}

impl SeenEdge {
    fn point(&self, station: usize, mount: Mount) -> EdgePoint {
        let pose = self.base_from_flange.rigid();
        EdgePoint {
            station,
            edge: self.edge,
            base_from_flange: if mount == Mount::Fixed { pose.inverse() } else { *pose },
            point_in_sensor: self.point_in_sensor_mm,
            information: Matrix2::identity() * LEAST_STD_MM.powi(-2),
        }
    }
}

/// A cell with a plate before anything is calibrated, roughly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoughPlate {
    /// Where the sensor is mounted.
    pub mount: Mount,
    /// The sensor on the flange within 10° and 20 mm or so; in the base for [`Mount::Fixed`].
    pub flange_from_sensor: Rigid,
    /// The plate in the base within 20° and 60 mm or so: the origin in its corner, x along edge p, y along edge q. In the
    /// flange for [`Mount::Fixed`].
    pub base_from_plate: Rigid,
    /// Where its edges may be crossed: least and greatest distance from the corner, mm.
    pub along_mm: [f64; 2],
    /// The robot's noise as far as it is stated; that of a good arm otherwise.
    pub noise: Noise,
}

impl RoughPlate {
    /// The plate as the points show it through a rough mounting. Its edges are crossed where one of them was so far.
    ///
    /// # Errors
    /// [`PlanRefusal::PlateUnseen`] without two points on one edge, apart from each other, and one on the other.
    pub fn through(
        mount: Mount,
        flange_from_sensor: Rigid,
        noise: Noise,
        seen: &[SeenEdge],
    ) -> Result<Self, PlanRefusal> {
        let places = |edge: Edge| -> Vec<Vec3> {
            let of_edge = seen.iter().filter(|seen| seen.edge == edge);
            of_edge.map(|seen| seen.point(0, mount).in_base(&flange_from_sensor)).collect()
        };
        let [on_p, on_q] = [Edge::P, Edge::Q].map(places);
        // What is off in the mounting turns a direction the less, the further apart its two points are.
        let of_pairs =
            [(Edge::P, &on_p, &on_q), (Edge::Q, &on_q, &on_p)].into_iter().filter_map(|(edge, on, others)| {
                let pair = furthest_apart(on)?;
                Some((edge, pair, *others.first()?))
            });
        let apart_mm = |[one, other]: [Vec3; 2]| (other - one).norm();
        let base_from_plate = of_pairs
            .max_by(|(_, a, _), (_, b, _)| apart_mm(*a).total_cmp(&apart_mm(*b)))
            .and_then(|(edge, [one, other], third)| plate_at(one, other, third, edge))
            .ok_or(PlanRefusal::PlateUnseen)?;
        let of_edge = |places: &[Vec3], edge: Edge| -> Vec<f64> {
            let in_plate = |place: &Vec3| base_from_plate.inverse_transform_point(&(*place).into()).coords;
            places.iter().map(|place| in_plate(place)[along(edge)]).collect()
        };
        let along_mm = extent(of_edge(&on_p, Edge::P).into_iter().chain(of_edge(&on_q, Edge::Q)));
        Ok(Self { mount, flange_from_sensor, base_from_plate, along_mm, noise })
    }

    fn is_sound(&self) -> bool {
        let frames = [self.flange_from_sensor, self.base_from_plate].map(|frame| frame.to_homogeneous());
        frames.iter().all(|frame| frame.iter().all(|v| v.is_finite()))
            && self.along_mm.iter().all(|v| v.is_finite())
            && self.along_mm[0] <= self.along_mm[1]
    }

    fn state(&self) -> PlateState {
        PlateState { flange_from_sensor: self.flange_from_sensor, base_from_plate: self.base_from_plate }
    }
}

/// The two places that are furthest from each other; `None` of a single one.
fn furthest_apart(places: &[Vec3]) -> Option<[Vec3; 2]> {
    let pairs = places.iter().enumerate().flat_map(|(idx, one)| places[idx + 1..].iter().map(|other| [*one, *other]));
    pairs.max_by(|[a, b], [c, d]| (a - b).norm().total_cmp(&(c - d).norm()))
}

/// The plate with two places on one edge and a third on the other; `None` if they are on one line. Its axes point to them.
fn plate_at(one: Vec3, other: Vec3, third: Vec3, edge: Edge) -> Option<Rigid> {
    let direction = (other - one).try_normalize(1e-6)?;
    let corner = one + direction * direction.dot(&(third - one));
    let across = (third - corner).try_normalize(1e-6)?;
    let middle = (one + other) * 0.5 - corner;
    let direction = if direction.dot(&middle) < 0.0 { -direction } else { direction };
    let (x, y) = if edge == Edge::P { (direction, across) } else { (across, direction) };
    let rotation = so3::nearest_rotation(&Mat3::from_columns(&[x, y, x.cross(&y)]))?;
    Some(Rigid::from_parts(corner.into(), rotation))
}

/// The cell with its mounting and plate as the guess and the points together have them.
///
/// `cell` is always the first guess, not an estimate that the same points went into.
#[must_use]
pub fn refined_plate(cell: &RoughPlate, seen: &[SeenEdge]) -> RoughPlate {
    estimate(cell, seen).map_or(*cell, |(state, _)| RoughPlate {
        flange_from_sensor: state.flange_from_sensor,
        base_from_plate: state.base_from_plate,
        ..*cell
    })
}

/// The next station before a plate that has no solution yet, and the cell as it is known now.
///
/// Orientations are relative to that of the edge's first station, which the operator chose, or of the first of all.
/// `avoided` are poses, asked for already, that could not be gone to or were not wanted. Of the limits only the angles
/// matter, as the view says the rest: where the edge may be in the sensor frame.
///
/// # Errors
/// [`PlanRefusal::PlateUnseen`] without a station to begin from, [`PlanRefusal::NothingWithinLimits`] if no orientation is
/// sure to keep an edge in view, [`PlanRefusal::Undetermined`] if the cell's numbers are none.
pub fn next_rough_edge(
    cell: &RoughPlate,
    seen: &[SeenEdge],
    avoided: &[Transform<Base, Flange>],
    view: &View,
    limits: &Limits,
) -> Result<(PlannedStation, RoughPlate), PlanRefusal> {
    let first = seen.first().ok_or(PlanRefusal::PlateUnseen)?;
    let room = Room {
        across_mm: [-view.half_width_mm, view.half_width_mm],
        along_mm: [view.middle_range_mm - view.half_range_mm, view.middle_range_mm + view.half_range_mm],
    };
    if room.is_empty() {
        return Err(PlanRefusal::NothingWithinLimits);
    }
    let (state, information) =
        cell.is_sound().then(|| estimate(cell, seen)).flatten().ok_or(PlanRefusal::Undetermined)?;
    let covariance = inverse_of(&information).map_err(|_| PlanRefusal::Undetermined)?;
    let base_from_sensor = |pose: &Transform<Base, Flange>| {
        let rotation = pose.rotation();
        let carrier = if cell.mount == Mount::Fixed { rotation.inverse() } else { rotation };
        carrier * state.flange_from_sensor.rotation
    };
    let edges = [Edge::P, Edge::Q]
        .into_iter()
        .filter(|edge| limits.allows(*edge))
        .map(|edge| {
            let first = seen.iter().find(|seen| seen.edge == edge).unwrap_or(first);
            Ok(EdgeModel {
                edge,
                in_plane: Matrix2::identity() * (POINT_STD_MM * POINT_STD_MM),
                along_mm: cell.along_mm,
                orientations: Orientations::new(base_from_sensor(&first.base_from_flange), limits)?,
            })
        })
        .collect::<Result<_, PlanRefusal>>()?;
    let pose_variances = pose_variances(&cell.noise);
    // By the first estimate of the plate the other edge is not known well enough to come nearer to it.
    let points: Vec<EdgePoint> = seen.iter().map(|seen| seen.point(0, cell.mount)).collect();
    let least_apart_mm = least_apart_mm(&state, &points);
    let plate =
        Plate { mount: cell.mount, state, pose_variances, room, edges, least_apart_mm, doubt: Some(covariance) };
    let of_seen =
        |seen: &SeenEdge| Taken { base_from_sensor: base_from_sensor(&seen.base_from_flange), edge: Some(seen.edge) };
    let of_avoided = |pose: &Transform<Base, Flange>| Taken { base_from_sensor: base_from_sensor(pose), edge: None };
    let taken = seen.iter().map(of_seen).chain(avoided.iter().map(of_avoided)).collect();
    let known = Information::new(&information, Vec3::new(0.0, 0.0, view.middle_range_mm));
    let mut search = Search::new(cell.mount, state.flange_from_sensor, plate, known, taken);
    let assumed = guessed(cell, &state).hessian;
    let count = |edge: Edge| seen.iter().filter(|seen| seen.edge == edge).count();
    let is_determined = count(Edge::P).min(count(Edge::Q)) >= MIN_POINTS;
    let station = search.next(|information| {
        // What is known of the mounting by guess is no measurement.
        is_determined.then(|| information.without(&assumed).point_std()).flatten()
    });
    let now =
        RoughPlate { flange_from_sensor: state.flange_from_sensor, base_from_plate: state.base_from_plate, ..*cell };
    Ok((station.ok_or(PlanRefusal::NothingWithinLimits)?, now))
}

/// The most probable mounting and plate with what is known of them; `None` if the numbers are none.
fn estimate(cell: &RoughPlate, seen: &[SeenEdge]) -> Option<(PlateState, PlateInformation)> {
    let points: Vec<EdgePoint> = seen.iter().enumerate().map(|(idx, seen)| seen.point(idx, cell.mount)).collect();
    let sums_at = |state: &PlateState| {
        let (sums, guess) = (sums_of(&points, state, |_| 1.0), guessed(cell, state));
        Sums {
            hessian: sums.hessian + guess.hessian,
            gradient: sums.gradient + guess.gradient,
            cost: sums.cost + guess.cost,
        }
    };
    let found = descend(sums_at, cell.state()).ok()?;
    Some((found.unknowns, found.sums.hessian))
}

/// What is assumed of sensor and plate.
fn guessed(cell: &RoughPlate, state: &PlateState) -> Sums<NUM_UNKNOWNS> {
    let of_sensor = Guess::at(&cell.flange_from_sensor, &state.flange_from_sensor, GUESS_STD_DEG, GUESS_STD_MM);
    let of_plate = Guess::at(&cell.base_from_plate, &state.base_from_plate, PLATE_STD_DEG, PLATE_STD_MM);
    let mut sums = Sums::<NUM_UNKNOWNS>::zero();
    for (at, guess) in [(0, &of_sensor), (6, &of_plate)] {
        sums.hessian.fixed_view_mut::<6, 6>(at, at).copy_from(&guess.hessian);
        sums.gradient.fixed_rows_mut::<6>(at).copy_from(&guess.gradient);
        sums.cost += guess.cost;
    }
    sums
}
