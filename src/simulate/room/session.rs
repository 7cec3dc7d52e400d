//! The session of a recording: it names the folder of images and holds the truth.

use serde_json::json;

use crate::session::{Robot, Session, Target, Truth, UnknownFields};

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
            let base_from_world = *written(&arm.world_from_base.inverse()).rigid();
            session.truth = Some(Truth {
                flange_from_sensor: arm.flange_from_sensor,
                target_in_base_mm: base_from_world.translation.vector,
                base_from_plate: None,
                base_from_target: Some(base_from_world),
                unknown: UnknownFields::from_iter([(
                    "robot_clock_ahead_s".to_owned(),
                    json!(options.robot_clock_ahead_s),
                )]),
            });
        }
        session
    }
}
