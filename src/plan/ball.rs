//! A ball before the sensor: stations of the kind that a session has, where the ball passes in them, and what they say.

use nalgebra::{Matrix6, SMatrix, UnitQuaternion};

use crate::calibrate::observation::{CentreObservation, NUM_UNKNOWNS, State};
use crate::calibrate::solver::{Hessian, Normal};
use crate::calibrate::{Reduced, Solution};
use crate::geometry::so3::hat;
use crate::geometry::{Mat3, Vec3};

use super::orientation::Orientations;
use super::search::{Aim, Candidate, Place, Subject, Taken, part_of};
use super::sight::Sight;
use super::{Limits, PlanRefusal};

/// The places that the grid tries: in the middle, and in the corners of the view.
const PLACES: [Place; 5] = [[0.5, 0.5, 0.5], [0.0, 0.0, 0.5], [0.0, 1.0, 0.5], [1.0, 0.0, 0.5], [1.0, 1.0, 0.5]];

/// What is measured with what, as far as it is known.
#[derive(Clone, Debug)]
pub(super) struct Ball {
    pub state: State,
    /// The kinds of station to choose from; at least one.
    pub models: Vec<StationModel>,
    pub orientations: Orientations,
    /// Whether the ball is sure to be seen; `None` where there is no doubt.
    pub sight: Option<Sight>,
}

impl Ball {
    fn in_sensor(&self, candidate: &Candidate) -> Vec3 {
        let model = &self.models[candidate.kind];
        model.first_ball_in_sensor + model.shift(candidate.place)
    }
}

impl Subject<NUM_UNKNOWNS> for Ball {
    fn num_kinds(&self) -> usize {
        self.models.len()
    }

    fn orientations(&self, _: usize) -> &Orientations {
        &self.orientations
    }

    fn places(&self) -> &[Place] {
        &PLACES
    }

    fn may_be_lost(&self) -> bool {
        self.sight.is_some()
    }

    fn aim(&self, candidate: &Candidate) -> Aim {
        Aim { point_in_sensor: self.in_sensor(candidate), point_in_base: self.state.ball_in_base, edge: None }
    }

    fn brings(&self, candidate: &Candidate, base_from_sensor: &UnitQuaternion<f64>) -> Option<Hessian> {
        let sensor_from_base = base_from_sensor.inverse().to_rotation_matrix().into_inner();
        let is_seen = self.sight.as_ref().is_none_or(|sight| sight.sees(self.in_sensor(candidate), &sensor_from_base));
        let model = &self.models[candidate.kind];
        is_seen.then(|| information_at(&model.about_sensor, model.shift(candidate.place), &sensor_from_base))
    }
}

/// A kind of station to be measured.
#[derive(Clone, Debug)]
pub(super) struct StationModel {
    /// The ball's centre in the sensor frame at the first capture, mm.
    pub first_ball_in_sensor: Vec3,
    /// What its captures say about (rotation, translation), 1/rad² and 1/mm².
    pub about_sensor: Matrix6<f64>,
    /// By how much the ball may be shifted across the line and along the range, least and most, mm.
    pub shift_mm: [[f64; 2]; 2],
}

impl StationModel {
    /// From the ball's centre in the sensor frame at each capture; `None` if the ball cannot stay in view.
    pub fn new(balls_in_sensor: &[Vec3], about_sensor: &Matrix6<f64>, room: &Room) -> Option<Self> {
        let range = |axis: usize, [least, most]: [f64; 2]| {
            let [low, high] = extent(balls_in_sensor.iter().map(|ball| ball[axis]));
            let shift = [least - low, most - high];
            (shift[0] <= shift[1]).then_some(shift)
        };
        Some(Self {
            first_ball_in_sensor: *balls_in_sensor.first()?,
            about_sensor: *about_sensor,
            shift_mm: [range(0, room.across_mm)?, range(2, room.along_mm)?],
        })
    }

    fn shift(&self, [across, along, _]: Place) -> Vec3 {
        Vec3::new(part_of(self.shift_mm[0], across), 0.0, part_of(self.shift_mm[1], along))
    }

    /// How well it knows its ball by itself.
    fn ball_information(&self) -> f64 {
        self.about_sensor.fixed_view::<3, 3>(3, 3).into_owned().determinant()
    }
}

/// Where the ball's centre, or an edge, may be in the sensor frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Room {
    /// Least and greatest x, mm.
    pub across_mm: [f64; 2],
    /// Least and greatest z, mm.
    pub along_mm: [f64; 2],
}

impl Room {
    /// As the limits say, and where they do not, as targets were seen already.
    pub fn new(limits: &Limits, seen_in_sensor: impl Iterator<Item = Vec3> + Clone) -> Self {
        let seen_along = extent(seen_in_sensor.clone().map(|seen| seen.z));
        // With some makers z grows towards the sensor, so a stand-off is a negative z.
        let looks_back = seen_along[0] + seen_along[1] < 0.0;
        let along = |[least, most]: [f64; 2]| if looks_back { [-most, -least] } else { [least, most] };
        Self {
            across_mm: limits
                .half_width_mm
                .map_or_else(|| extent(seen_in_sensor.map(|seen| seen.x)), |half_width| [-half_width, half_width]),
            along_mm: limits.standoff_mm.map_or(seen_along, along),
        }
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        ![self.across_mm, self.along_mm].iter().all(|[least, most]| least <= most)
    }
}

/// Least and greatest.
pub(super) fn extent(values: impl Iterator<Item = f64>) -> [f64; 2] {
    values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| [low.min(value), high.max(value)])
}

/// A typical station for each side of the ball that the session starts from.
///
/// # Errors
/// [`PlanRefusal::NothingWithinLimits`] if the ball does not stay in view.
pub(super) fn models(reduced: &Reduced, limits: &Limits) -> Result<Vec<StationModel>, PlanRefusal> {
    let balls: Vec<(usize, Vec<Vec3>)> = reduced
        .stations()
        .map(|run| {
            let ball = |observation: &CentreObservation| reduced.state.ball_in_sensor(&observation.base_from_flange);
            (run[0].station, run.iter().map(ball).collect())
        })
        .collect();
    let room = Room::new(limits, balls.iter().flat_map(|(_, balls)| balls).copied());
    let stations = balls.iter().filter_map(|(station, balls)| {
        StationModel::new(balls, &about_sensor(&reduced.sums_of_station(*station, &reduced.state)), &room)
    });
    let (plus, minus): (Vec<_>, Vec<_>) = stations.partition(|station| station.first_ball_in_sensor.y >= 0.0);
    let models: Vec<StationModel> = [plus, minus].into_iter().filter_map(median).collect();
    if models.is_empty() { Err(PlanRefusal::NothingWithinLimits) } else { Ok(models) }
}

/// The station in the middle by how well it knows its ball.
fn median(mut stations: Vec<StationModel>) -> Option<StationModel> {
    stations.sort_by(|a, b| a.ball_information().total_cmp(&b.ball_information()));
    let middle = stations.len() / 2;
    stations.into_iter().nth(middle)
}

/// The stations that were measured.
pub(super) fn taken(reduced: &Reduced) -> Vec<Taken> {
    let mounting = reduced.state.flange_from_sensor.rotation;
    let of_run = |run: &[CentreObservation]| run[0].base_from_flange.rotation * mounting;
    reduced.stations().map(|run| Taken { base_from_sensor: of_run(run), edge: None }).collect()
}

/// The middle of the balls that the stations saw at their first captures, in the sensor frame, mm.
pub(super) fn middle_of_balls(solution: &Solution) -> Vec3 {
    #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^52 stations")]
    let scale = 1.0 / solution.stations.len().max(1) as f64;
    solution.stations.iter().map(|station| station.target_in_sensor_mm).sum::<Vec3>() * scale
}

/// What a station's sums say about (rotation, translation).
pub(super) fn about_sensor(sums: &Normal) -> Matrix6<f64> {
    sums.hessian.fixed_view::<6, 6>(0, 0).into_owned()
}

/// What a station says about all unknowns, from what it says about (rotation, translation), at an orientation and with the
/// ball `shift` further off in the sensor frame.
///
/// From ds = s × ω − v + C db: a shifted ball is a shifted lever of the rotation, and the ball moves as the sensor does,
/// turned.
pub(super) fn information_at(about_sensor: &Matrix6<f64>, shift: Vec3, sensor_from_base: &Mat3) -> Hessian {
    let mut by_unknowns = SMatrix::<f64, 6, NUM_UNKNOWNS>::identity();
    by_unknowns.fixed_view_mut::<3, 3>(3, 0).copy_from(&-hat(shift));
    by_unknowns.fixed_view_mut::<3, 3>(3, 6).copy_from(&-sensor_from_base);
    by_unknowns.transpose() * about_sensor * by_unknowns
}

#[cfg(test)]
mod tests {
    use nalgebra::UnitQuaternion;

    use super::*;
    use crate::calibrate::observation::{CentreObservation, State};
    use crate::geometry::Rigid;

    #[test]
    fn a_station_brings_what_the_solver_would_sum_up() {
        let state = State {
            flange_from_sensor: Rigid::from_parts(
                Vec3::new(12.0, -3.0, 118.0).into(),
                UnitQuaternion::from_euler_angles(0.4, 0.1, -1.5),
            ),
            ball_in_base: Vec3::new(600.0, -40.0, 20.0),
        };
        let weights = [Mat3::new(2.0, 0.3, -0.2, 0.3, 1.0, 0.4, -0.2, 0.4, 3.0), Mat3::identity() * 7.0];
        let places = [Vec3::new(1.0, 9.0, 80.0), Vec3::new(1.5, -4.0, 81.0)];
        let shift = Vec3::new(3.0, 0.0, -6.0);
        let base_from_sensor = UnitQuaternion::from_euler_angles(3.0, 0.2, 0.7);
        let observations: Vec<CentreObservation> = places
            .iter()
            .zip(weights)
            .map(|(place, information)| {
                let origin = state.ball_in_base - base_from_sensor * (place + shift);
                let pose = Rigid::from_parts(origin.into(), base_from_sensor) * state.flange_from_sensor.inverse();
                CentreObservation { information, ..CentreObservation::point(0, pose, place + shift) }
            })
            .collect();
        let common = Mat3::identity() * 0.1;
        let summed = Normal::of(observations.iter(), &state).with_common_shift(&common).hessian;
        let still = observations.iter().zip(places).map(|(observation, place)| CentreObservation {
            base_from_flange: Rigid::translation(-place.x, -place.y, -place.z),
            ..observation.clone()
        });
        let at_origin = State { flange_from_sensor: Rigid::identity(), ball_in_base: Vec3::zeros() };
        let sums = Normal::of(still.collect::<Vec<_>>().iter(), &at_origin).with_common_shift(&common);
        let sensor_from_base = base_from_sensor.inverse().to_rotation_matrix().into_inner();
        let planned = information_at(&about_sensor(&sums), shift, &sensor_from_base);
        assert!((summed - planned).norm() < 1e-9 * summed.norm(), "{summed} {planned}");
    }
}
