//! The target's poses that the stations hold.

use std::collections::HashMap;

use nalgebra::{Quaternion, UnitQuaternion, Vector4};

use crate::calibrate::rotation_start::PoseGeometry;
use crate::calibrate::shared_warnings::first_refusal;
use crate::calibrate::{MotionProblem, Reading, SolveError, Station};
use crate::geometry::{Rigid, Vec3};

use super::pose::{Information, PosePair};

/// Two motions about different axes.
pub const MIN_POSES: usize = 3;
/// The lever (mm) at which rotations and translations weigh the same before anything is known of the noise.
pub(super) const LEVER_MM: f64 = 100.0;

/// A pose with where it is from: the mean of what a station saw at one pose of the robot.
#[derive(Clone, Debug)]
pub(super) struct Measured<'a> {
    pub station: &'a Station,
    /// The first capture that it was seen in.
    pub capture_idx: usize,
    /// Its information is still by the lever alone.
    pub pose: PosePair,
    /// How many readings it is the mean of; copies are one.
    pub num_readings: f64,
    /// How many were taken at its pose of the robot.
    pub num_at_pose: f64,
}

/// All poses that can be used, and what the robot's poses say by themselves.
///
/// # Errors
/// [`SolveError::TooFewStations`], and those of [`PoseGeometry::new`].
pub(super) fn measured(problem: &MotionProblem) -> Result<(Vec<Measured<'_>>, PoseGeometry), SolveError> {
    let mut all: Vec<Measured<'_>> = Vec::new();
    let mut same_pose: HashMap<[u64; 7], Vec<usize>> = HashMap::new();
    let mut num_stations = 0;
    for station in &problem.stations {
        let mut seen: Vec<(usize, Rigid, Vec<Rigid>)> = Vec::new();
        for (capture_idx, capture) in station.captures.iter().enumerate() {
            let Reading::Pose(sensor_from_target) = &capture.reading else { continue };
            let (base_from_flange, target) = (*capture.base_from_flange.rigid(), *sensor_from_target.rigid());
            match seen.iter_mut().find(|(_, pose, _)| *pose == base_from_flange) {
                Some((_, _, targets)) if targets.contains(&target) => {}
                Some((_, _, targets)) => targets.push(target),
                None => seen.push((capture_idx, base_from_flange, vec![target])),
            }
        }
        let before = all.len();
        for (capture_idx, base_from_flange, targets) in seen {
            let pose = PosePair {
                station: num_stations,
                base_from_flange,
                sensor_from_target: mean(&targets),
                information: Information::by_lever(LEVER_MM),
            };
            // The same pair entered twice tells nothing new.
            let taken = same_pose.entry(bits(&base_from_flange)).or_default();
            if !taken.iter().any(|place| all[*place].pose.is_copy_of(&pose)) {
                taken.push(all.len());
                #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^52 captures")]
                let num_readings = targets.len() as f64;
                all.push(Measured { station, capture_idx, pose, num_readings, num_at_pose: 1.0 });
            }
        }
        num_stations += usize::from(all.len() > before);
    }
    for places in same_pose.into_values().filter(|places| places.len() > 1) {
        #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^52 poses")]
        let num_at_pose = places.len() as f64;
        for place in places {
            all[place].num_at_pose = num_at_pose;
        }
    }
    if all.len() < MIN_POSES {
        return Err(SolveError::TooFewStations {
            found: all.len(),
            needed: MIN_POSES,
            refusal: first_refusal(&problem.stations),
        });
    }
    let poses: Vec<Rigid> = all.iter().map(|measured| measured.pose.base_from_flange).collect();
    let geometry = PoseGeometry::new(&poses)?;
    Ok((all, geometry))
}

/// A pose as a key: what was reported twice is the same to the bit.
fn bits(pose: &Rigid) -> [u64; 7] {
    let (place, turn) = (pose.translation.vector, pose.rotation.coords);
    [place.x, place.y, place.z, turn.x, turn.y, turn.z, turn.w].map(f64::to_bits)
}

/// The mean of poses that differ by noise.
fn mean(poses: &[Rigid]) -> Rigid {
    if let [only] = poses {
        return *only;
    }
    let mut place = Vec3::zeros();
    let mut rotations = Vector4::zeros();
    for pose in poses {
        place += pose.translation.vector;
        let coords = pose.rotation.coords;
        rotations += if poses[0].rotation.coords.dot(&coords) < 0.0 { -coords } else { coords };
    }
    #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^52 poses")]
    let scale = 1.0 / poses.len() as f64;
    Rigid::from_parts((place * scale).into(), UnitQuaternion::new_normalize(Quaternion::from(rotations)))
}
