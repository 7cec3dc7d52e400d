//! Practice on the simulated cell: a cell that needs no devices, with a session for what stands in it.

use crate::app::cell::{Activity, RoughMounting};
use crate::device::sim::{SimCell, SimOptions, SimTruth};
use crate::geometry::{Rigid, Transform};
use crate::scene::PartKind;
use crate::session::model::UnknownFields;
use crate::session::{Edge, Session, Target, Truth};
use crate::text::cell as words;

use super::super::{NoticeKind, Workbench};

/// The simulated cell, for as long as it runs.
pub(super) struct Practice {
    /// What was set for the cell that is not simulated.
    own_mounting: Option<RoughMounting>,
    cell: SimCell,
}

impl Workbench {
    pub(super) fn practise(&mut self, part: Option<PartKind>) {
        self.practise_with(&SimOptions { part, ..SimOptions::default() });
    }

    /// Starts a simulated cell, connects to it, and begins a session for what stands in it.
    pub fn practise_with(&mut self, options: &SimOptions) {
        self.end_practice();
        let cell = match SimCell::start(options) {
            Ok(cell) => cell,
            Err(error) => {
                self.notify_of_cell(NoticeKind::Error, error.to_string());
                return;
            }
        };
        self.open_session(session_for(&cell.truth, options), None);
        let own_mounting = self.cell.view.settings.mounting;
        self.cell.view.settings.mounting = Some(mounting(&cell.truth.rough_flange_from_sensor));
        self.connect_robot(cell.robot_setup.clone());
        self.connect_sensor(cell.sensor_setup.clone());
        self.cell.practice = Some(Practice { own_mounting, cell });
        self.cell.view.is_practice = true;
        // The line is on that edge at first.
        self.cell.view.settings.edge = Edge::P;
    }

    /// Somebody takes the pendant of the simulated robot.
    pub(super) fn jog_to_edge(&mut self, edge: Edge) {
        let Some(practice) = &self.cell.practice else { return };
        if self.cell.measuring.is_some() || self.cell.run.is_some() {
            self.notify_of_cell(NoticeKind::Error, words::BUSY.to_owned());
        } else if let Err(error) = practice.cell.jog_to_edge(edge) {
            self.notify_of_cell(NoticeKind::Error, error.to_string());
        } else {
            self.cell.view.settings.edge = edge;
            self.forget_proposal();
        }
    }

    /// Ends the simulated cell, if there is one; its session stays if that is on the bench. The robot is stopped first.
    pub(in crate::app::workbench) fn end_practice(&mut self) {
        let Some(practice) = self.cell.practice.take() else { return };
        self.poll_routine();
        self.disconnect_robot();
        self.disconnect_sensor();
        // Of a robot that is no more nobody needs to know whether it stands.
        self.cell.measuring = None;
        self.cell.view.activity = Activity::Idle;
        self.cell.view.last_end = None;
        self.cell.view.settings.mounting = practice.own_mounting;
        self.cell.view.is_practice = false;
    }
}

fn session_for(truth: &SimTruth, options: &SimOptions) -> Session {
    let part = options.part;
    let mut session = Session::new(match part {
        None => Target::ball(truth.radius_mm),
        Some(PartKind::Plate) => Target::RightAnglePlate,
        Some(PartKind::Pin) => Target::Point,
        Some(PartKind::Square | PartKind::Teeth | PartKind::Cylinder) => Target::Workpiece,
    });
    words::PRACTICE_NAME.clone_into(&mut session.name);
    words::PRACTICE_ROBOT.clone_into(&mut session.robot.model);
    session.sensor.model = words::practice_sensor(options.head.id);
    let [position_std_mm, orientation_std_deg] = truth.pose_std_mm_deg;
    // A noise of nothing is no noise to state.
    let stated = |std: f64| (std > 0.0).then_some(std);
    session.robot.position_std_mm = stated(position_std_mm);
    session.robot.orientation_std_deg = stated(orientation_std_deg);
    session.sensor.profile_std_mm = stated(truth.profile_std_mm);
    // The head counts its heights from the reference distance, not to it: the workspace is where the target was seen.
    session.sensor.rough_flange_from_sensor =
        (part == Some(PartKind::Plate)).then(|| Transform::from_rigid(truth.rough_flange_from_sensor));
    let part_in_base = truth.base_from_part;
    session.truth = Some(Truth {
        flange_from_sensor: Transform::from_rigid(truth.flange_from_sensor),
        target_in_base_mm: part_in_base.map_or(truth.ball_in_base, |part| part.translation.vector),
        base_from_plate: part_in_base.filter(|_| part == Some(PartKind::Plate)),
        base_from_target: None,
        unknown: UnknownFields::new(),
    });
    session
}

fn mounting(flange_from_sensor: &Rigid) -> RoughMounting {
    let q = flange_from_sensor.rotation;
    RoughMounting {
        translation_mm: flange_from_sensor.translation.vector.into(),
        quaternion_wxyz: [q.w, q.i, q.j, q.k],
    }
}
