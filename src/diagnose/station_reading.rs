//! What one station says about the ball, by itself: the centre by its sweep or its one section, whatever the others say.

use crate::calibrate::observation::State;
use crate::calibrate::{BallProblem, Capture, Mount, Reading, SideChoice, Station};
use crate::geometry::{Mat3, Rigid, Vec3};

/// Sections before the curve of the squares of their radii tells on which side the ball is.
pub(super) const MIN_STEPS: usize = 3;
/// A sweep that travels less than this part of the ball's radius is one section.
const MIN_TRAVEL_PART: f64 = 0.1;

/// What one station says about the ball, by itself.
#[derive(Clone, Debug)]
pub(super) struct StationReading<'a> {
    /// The station.
    pub station: &'a Station,
    /// The capture that `centre` belongs to, with its pose.
    pub capture: &'a Capture,
    /// That pose.
    pub base_from_flange: Rigid,
    /// The ball's centre in the sensor frame, mm; the sign of y is a guess where the side is open.
    pub centre: Vec3,
    /// Whether nothing tells the sign of y.
    pub side_is_open: bool,
    /// By the noise of the profile, mm².
    pub covariance: Mat3,
}

impl<'a> StationReading<'a> {
    /// With these poses in place of its own; `direction` is that in the flange in which a positive step travels.
    pub fn of(problem: &BallProblem, direction: Vec3, station: &'a Station, poses: &[Rigid]) -> Option<Self> {
        let (capture, base_from_flange) =
            station.captures.iter().zip(poses).find(|(capture, _)| !matches!(capture.reading, Reading::Refused(_)))?;
        let of_centre = |centre: Vec3, side_is_open: bool, covariance: Mat3| Self {
            station,
            capture,
            base_from_flange: *base_from_flange,
            centre,
            side_is_open,
            covariance,
        };
        match &capture.reading {
            Reading::Edge(_) | Reading::Refused(_) | Reading::Pose(_) => None,
            Reading::Point(point) => Some(of_centre(*point, false, Mat3::zeros())),
            Reading::Arc(arc) => {
                let [std_x, std_z, std_l] = arc.std_mm();
                let l = arc.circle.radius_mm;
                let (y, std_y, side_is_open) = y_of_sweep(problem, direction, station, poses, base_from_flange)
                    .map_or_else(
                        || {
                            let radius_mm = problem.radius_mm;
                            let size = ((radius_mm - l).max(0.0) * (radius_mm + l)).sqrt();
                            // At the largest arc the linear formula diverges; |y| stays below what an error of l makes.
                            let std = (l * std_l / size.max(f64::MIN_POSITIVE)).min((2.0 * radius_mm * std_l).sqrt());
                            match station.side {
                                SideChoice::Given(side) => (side.sign() * size, std, false),
                                SideChoice::Auto => (size, std, true),
                            }
                        },
                        |(y, std)| (y, std, false),
                    );
                let std = Vec3::new(std_x, std_y, std_z);
                Some(of_centre(
                    Vec3::new(arc.circle.x_mm, y, arc.circle.z_mm),
                    side_is_open,
                    Mat3::from_diagonal(&std.component_mul(&std)),
                ))
            }
        }
    }

    /// The centre as measured, on the side where it is predicted if that is open.
    pub fn centre_near(&self, predicted: Vec3) -> Vec3 {
        if self.side_is_open { self.mirrored_to(predicted.y) } else { self.centre }
    }

    /// The centre on the side of a y.
    pub fn mirrored_to(&self, y: f64) -> Vec3 {
        Vec3::new(self.centre.x, self.centre.y.abs() * if y < 0.0 { -1.0 } else { 1.0 }, self.centre.z)
    }

    /// How far the prediction of a state is from what was measured, in the sensor frame, mm.
    pub fn misfit(&self, state: &State) -> Vec3 {
        let predicted = state.ball_in_sensor(&self.base_from_flange);
        predicted - self.centre_near(predicted)
    }

    /// The same with the ball on either side, whatever is said about it.
    pub fn misfit_on_either_side_mm(&self, state: &State) -> f64 {
        let predicted = state.ball_in_sensor(&self.base_from_flange);
        (predicted - self.mirrored_to(predicted.y)).norm()
    }
}

/// Where the ball is beside the laser plane at a pose, by the sections of the whole sweep, with its σ, mm.
///
/// l² + t² = R² − y² + 2 y t with the travel t is a straight line whatever the radius.
fn y_of_sweep(
    problem: &BallProblem,
    direction: Vec3,
    station: &Station,
    poses: &[Rigid],
    from: &Rigid,
) -> Option<(f64, f64)> {
    let steps: Vec<(f64, f64, f64)> = station
        .captures
        .iter()
        .zip(poses)
        .filter_map(|(capture, pose)| match &capture.reading {
            Reading::Arc(arc) => {
                let travel = direction.dot(&travel_in_flange(problem.mount, from, pose));
                Some((travel, arc.circle.radius_mm, arc.std_mm()[2]))
            }
            Reading::Edge(_) | Reading::Refused(_) | Reading::Point(_) | Reading::Pose(_) => None,
        })
        .collect();
    #[expect(clippy::cast_precision_loss, reason = "a sweep has few steps")]
    let scale = 1.0 / steps.len() as f64;
    let squares = |(travel, l, _): &(f64, f64, f64)| l * l + travel * travel;
    let mean_travel = steps.iter().map(|step| step.0).sum::<f64>() * scale;
    let mean_square = steps.iter().map(squares).sum::<f64>() * scale;
    let spread: f64 = steps.iter().map(|step| (step.0 - mean_travel).powi(2)).sum();
    if steps.len() < MIN_STEPS || (spread * scale).sqrt() < MIN_TRAVEL_PART * problem.radius_mm {
        return None;
    }
    let cross: f64 = steps.iter().map(|step| (step.0 - mean_travel) * (squares(step) - mean_square)).sum();
    let y = 0.5 * cross / spread;
    let travel_variance = problem.noise.position_std_mm.unwrap_or(0.0).powi(2);
    let variance = steps
        .iter()
        .map(|(travel, l, std_l)| {
            let of_square = 4.0 * (l * l * std_l * std_l + (travel - y).powi(2) * travel_variance);
            ((travel - mean_travel) / spread).powi(2) * of_square
        })
        .sum::<f64>();
    Some((y, 0.5 * variance.sqrt()))
}

/// The poses of a station's captures.
pub(super) fn poses_of(station: &Station) -> Vec<Rigid> {
    station.captures.iter().map(|capture| *capture.base_from_flange.rigid()).collect()
}

/// The station with nothing but what its reading stands for.
pub(super) fn single_capture_station(reading: &StationReading<'_>) -> Station {
    let reading_of_capture =
        if reading.side_is_open { reading.capture.reading.clone() } else { Reading::Point(reading.centre) };
    Station {
        captures: vec![Capture { reading: reading_of_capture, ..reading.capture.clone() }],
        ..reading.station.clone()
    }
}

/// The robot's travel between two poses of a sweep, in the flange frame.
fn travel_in_flange(mount: Mount, from: &Rigid, to: &Rigid) -> Vec3 {
    match mount {
        Mount::OnFlange => from.rotation.inverse() * (to.translation.vector - from.translation.vector),
        // The poses are inverted and the sensor stands still: the robot's own travel, turned round.
        Mount::Fixed => from.inverse().translation.vector - to.inverse().translation.vector,
    }
}

/// The direction in the flange in which a positive step travels; where no steps are recorded, or the other way round.
pub(super) fn travel_direction(problem: &BallProblem) -> Vec3 {
    let travels = || {
        problem.stations.iter().flat_map(|station| {
            let first = station.captures.first().map(|capture| *capture.base_from_flange.rigid());
            station.captures.iter().filter_map(move |capture| {
                let travel = travel_in_flange(problem.mount, &first?, capture.base_from_flange.rigid());
                Some((travel, capture.commanded_travel_mm.unwrap_or(0.0)))
            })
        })
    };
    let spread: Mat3 = travels().map(|(travel, _)| travel * travel.transpose()).sum();
    let eigen = spread.symmetric_eigen();
    let direction = eigen.eigenvectors.column(eigen.eigenvalues.imax()).into_owned();
    let agreement: f64 = travels().map(|(travel, commanded)| commanded * direction.dot(&travel)).sum();
    if agreement < 0.0 { -direction } else { direction }
}
