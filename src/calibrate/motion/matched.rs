//! Two streams brought together in time, before anything is known of the calibration.

use crate::calibrate::{Capture, Mount, Reading, SideChoice, Station};
use crate::geometry::Transform;

use super::streams::StreamProblem;
use super::time_offset::{Timed, at, coarse, longest_gap_s};

impl StreamProblem {
    /// The camera's poses for which the flange's is known, each as a station that sees the world as its target: what any
    /// calibration can be held against. The clocks are set by the rotation speeds.
    #[must_use]
    pub fn stations(&self) -> Vec<Station> {
        let flange: Vec<Timed> = self.flange.iter().map(|(time_s, pose)| (*time_s, *pose.rigid())).collect();
        let camera: Vec<Timed> =
            self.camera.iter().map(|pose| (pose.time_s, *pose.world_from_sensor.rigid())).collect();
        let offset_s = if self.find_offset { coarse(&flange, &camera).unwrap_or(0.0) } else { 0.0 };
        let longest_gap_s = longest_gap_s(&flange);
        let seen = camera.iter().enumerate().filter_map(|(idx, (time_s, world_from_sensor))| {
            let base_from_flange = at(&flange, time_s + offset_s, longest_gap_s)?;
            let base_from_flange = Transform::from_rigid(match self.mount {
                Mount::OnFlange => base_from_flange,
                Mount::Fixed => base_from_flange.inverse(),
            });
            let reading = Reading::Pose(Transform::from_rigid(world_from_sensor.inverse()));
            let capture = Capture { base_from_flange, commanded_travel_mm: None, reading };
            Some(Station { idx, label: (idx + 1).to_string(), side: SideChoice::Auto, captures: vec![capture] })
        });
        seen.collect()
    }
}
