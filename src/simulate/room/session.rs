//! The session of a recording: it names the folder of images and holds the truth.

use serde_json::{Value, json};

use crate::geometry::{Frame, Transform};
use crate::session::{Robot, Session, Target};

use super::path::written;
use super::{Carrier, RoomRecording};

impl RoomRecording {
    /// The session of this recording, whose images are in the folder `sequence` beside the session file.
    #[must_use]
    pub fn session(&self, sequence: &str) -> Session {
        let options = self.options();
        let known = |std: f64| (std > 0.0).then_some(std);
        let carried = match options.carrier {
            Carrier::Vehicle => "on a vehicle",
            Carrier::Hand => "in a hand",
            Carrier::Robot => "on a robot",
        };
        let mut session = Session::new(Target::Rgbd { sequence: sequence.to_owned() });
        session.name = format!("Simulated room, camera {carried}");
        "simulated RGB-D camera".clone_into(&mut session.sensor.model);
        if let Some(arm) = self.arm() {
            session.robot = Robot {
                model: "simulated".to_owned(),
                position_std_mm: known(options.position_std_mm),
                orientation_std_deg: known(options.orientation_std_deg),
                ..Robot::default()
            };
            let truth = json!({
                "flange_from_sensor": pose(&arm.flange_from_sensor),
                "base_from_world": pose(&written(&arm.world_from_base.inverse())),
                "robot_clock_ahead_s": options.robot_clock_ahead_s,
            });
            session.unknown.insert("truth".to_owned(), truth);
        }
        session
    }
}

fn pose<Dst: Frame, Src: Frame>(pose: &Transform<Dst, Src>) -> Value {
    let translation_mm: [f64; 3] = pose.translation_mm().into();
    json!({ "translation_mm": translation_mm, "quaternion_wxyz": pose.quaternion_wxyz() })
}
