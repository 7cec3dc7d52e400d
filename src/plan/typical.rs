//! A station of the kind that a session has: how often it captures, where the ball passes, and what that says.

use nalgebra::{Matrix6, UnitQuaternion};

use crate::calibrate::{Reduced, Solution};
use crate::geometry::{Mat3, Vec3};

use super::information::station_information;
use super::{Limits, PlanRefusal};

/// A kind of station to be measured.
#[derive(Clone, Debug)]
pub(super) struct StationModel {
    /// The ball's centre in the sensor frame at the first capture, mm.
    pub first_ball_in_sensor: Vec3,
    /// What its captures say in the sensor frame, see [`station_information`].
    pub information: Matrix6<f64>,
    /// By how much the ball may be shifted across the line and along the range, least and most, mm.
    pub shift_mm: [[f64; 2]; 2],
}

impl StationModel {
    /// From the ball's centre and the information about it at each capture, `None` if the ball cannot stay in view.
    pub fn new(captures: &[(Vec3, Mat3)], view: &View) -> Option<Self> {
        let range = |axis: usize, [least, most]: [f64; 2]| {
            let [low, high] = extent(captures.iter().map(|(ball, _)| ball[axis]));
            let shift = [least - low, most - high];
            (shift[0] <= shift[1]).then_some(shift)
        };
        Some(Self {
            first_ball_in_sensor: captures.first()?.0,
            information: station_information(captures.iter().copied()),
            shift_mm: [range(0, view.across_mm)?, range(2, view.along_mm)?],
        })
    }
}

/// Where the ball's centre may be in the sensor frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct View {
    /// Least and greatest x, mm.
    pub across_mm: [f64; 2],
    /// Least and greatest z, mm.
    pub along_mm: [f64; 2],
}

impl View {
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
    let mut stations: Vec<Vec<(Vec3, Mat3)>> = (0..reduced.num_stations)
        .map(|station| {
            reduced
                .observations
                .iter()
                .filter(|observation| observation.station == station)
                .map(|observation| {
                    (reduced.state.ball_in_sensor(&observation.base_from_flange), observation.information)
                })
                .collect()
        })
        .collect();
    stations.retain(|captures| !captures.is_empty());
    let view = View::new(limits, stations.iter().flatten().map(|(ball, _)| *ball));
    let (plus, minus): (Vec<_>, Vec<_>) = stations.into_iter().partition(|captures| captures[0].0.y >= 0.0);
    let models: Vec<StationModel> = [plus, minus]
        .into_iter()
        .filter_map(median)
        .filter_map(|captures| StationModel::new(&captures, &view))
        .collect();
    if models.is_empty() { Err(PlanRefusal::NothingWithinLimits) } else { Ok(models) }
}

/// The station in the middle by what it says about its ball.
fn median(mut stations: Vec<Vec<(Vec3, Mat3)>>) -> Option<Vec<(Vec3, Mat3)>> {
    let says =
        |captures: &[(Vec3, Mat3)]| captures.iter().map(|(_, information)| information).sum::<Mat3>().determinant();
    stations.sort_by(|a, b| says(a).total_cmp(&says(b)));
    let middle = stations.len() / 2;
    stations.into_iter().nth(middle)
}

/// The sensor in the base at the stations that were measured.
pub(super) fn orientations(reduced: &Reduced) -> Vec<UnitQuaternion<f64>> {
    let mut station = None;
    let firsts = reduced
        .observations
        .iter()
        .filter(|observation| station.replace(observation.station) != Some(observation.station));
    firsts.map(|first| first.base_from_flange.rotation * reduced.state.flange_from_sensor.rotation).collect()
}

/// The middle of the balls that the stations saw at their first captures, in the sensor frame, mm.
pub(super) fn middle_of_balls(solution: &Solution) -> Vec3 {
    #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^52 stations")]
    let scale = 1.0 / solution.stations.len().max(1) as f64;
    solution.stations.iter().map(|station| station.ball_in_sensor_mm).sum::<Vec3>() * scale
}
