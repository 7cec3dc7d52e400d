//! A station of the kind that a session has: how often it captures, where the ball passes, and what that says.

use nalgebra::{Matrix6, UnitQuaternion};

use crate::calibrate::observation::CentreObservation;
use crate::calibrate::{Reduced, Solution};
use crate::geometry::Vec3;

use super::information::about_sensor;
use super::{Limits, PlanRefusal};

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

    /// How well it knows its ball by itself.
    fn ball_information(&self) -> f64 {
        self.about_sensor.fixed_view::<3, 3>(3, 3).into_owned().determinant()
    }
}

/// Where the ball's centre may be in the sensor frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Room {
    /// Least and greatest x, mm.
    pub across_mm: [f64; 2],
    /// Least and greatest z, mm.
    pub along_mm: [f64; 2],
}

impl Room {
    /// As the limits say, and where they do not, as balls were seen already.
    pub fn new(limits: &Limits, balls_in_sensor: impl Iterator<Item = Vec3> + Clone) -> Self {
        let seen_along = extent(balls_in_sensor.clone().map(|ball| ball.z));
        // With some makers z grows towards the sensor, so a stand-off is a negative z.
        let looks_back = seen_along[0] + seen_along[1] < 0.0;
        let along = |[least, most]: [f64; 2]| if looks_back { [-most, -least] } else { [least, most] };
        Self {
            across_mm: limits
                .half_width_mm
                .map_or_else(|| extent(balls_in_sensor.map(|ball| ball.x)), |half_width| [-half_width, half_width]),
            along_mm: limits.standoff_mm.map_or(seen_along, along),
        }
    }
}

fn extent(values: impl Iterator<Item = f64>) -> [f64; 2] {
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

/// The sensor in the base at the stations that were measured.
pub(super) fn orientations(reduced: &Reduced) -> Vec<UnitQuaternion<f64>> {
    let mounting = reduced.state.flange_from_sensor.rotation;
    reduced.stations().map(|run| run[0].base_from_flange.rotation * mounting).collect()
}

/// The middle of the balls that the stations saw at their first captures, in the sensor frame, mm.
pub(super) fn middle_of_balls(solution: &Solution) -> Vec3 {
    #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^52 stations")]
    let scale = 1.0 / solution.stations.len().max(1) as f64;
    solution.stations.iter().map(|station| station.target_in_sensor_mm).sum::<Vec3>() * scale
}
