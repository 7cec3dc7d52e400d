//! The two links and the arm switch.

use std::time::Instant;

use crate::app::cell::LinkView;
use crate::device::safety::check_readiness;
use crate::device::{
    Arming, Deadlines, LinkState, RobotSetup, RobotWorker, SensorKind, SensorSetup, SensorWorker, robot, sensor,
};
use crate::fit::Sought;
use crate::geometry::{Base, Flange, Transform};
use crate::session::sought;
use crate::text::cell as words;

use super::super::{NoticeKind, Workbench};

/// For how many times its deadline a profile of a watched folder is waited for: there a person has to save it.
const FOLDER_PATIENCE: u32 = 20;

/// Motion is allowed, at a pose and over a connection.
#[derive(Clone, Copy, Debug)]
pub(super) struct Armed {
    pub base_from_flange: Transform<Base, Flange>,
    pub connection: u64,
}

impl Workbench {
    pub(super) fn connect_robot(&mut self, setup: RobotSetup) {
        self.disconnect_robot();
        self.cell.view.robot = LinkView { setup: Some(setup.clone()), state: LinkState::Connecting, latest: None };
        // How a routine ended with another robot says nothing of this one.
        self.cell.view.last_end = None;
        let connect = Box::new(move |deadline| robot::connect(&setup, deadline));
        self.cell.robot = Some(RobotWorker::start(connect, self.cell.deadlines, self.wake.clone()));
    }

    pub(super) fn connect_sensor(&mut self, setup: SensorSetup) {
        self.disconnect_sensor();
        let is_folder = setup.kind == SensorKind::Folder;
        self.cell.view.sensor = LinkView { setup: Some(setup.clone()), state: LinkState::Connecting, latest: None };
        self.cell.view.watched_folder = is_folder.then(|| setup.folder.clone());
        let deadlines = self.cell.deadlines;
        let profile = if is_folder { deadlines.profile * FOLDER_PATIENCE } else { deadlines.profile };
        let connect = Box::new(move |deadline| sensor::connect(&setup, deadline));
        let worker = SensorWorker::start(connect, Deadlines { profile, ..deadlines }, self.wake.clone());
        worker.client().look_for(self.sought());
        self.cell.sensor = Some(worker);
    }

    pub(super) fn disconnect_robot(&mut self) {
        if self.cell.robot.is_none() {
            return;
        }
        self.disarm();
        self.stop_cell();
        self.cell.robot = None;
        self.cell.view.robot.state = LinkState::Off;
        self.cell.view.robot.latest = None;
    }

    pub(super) fn disconnect_sensor(&mut self) {
        if self.cell.sensor.is_none() {
            return;
        }
        if self.cell.measuring.is_some() || self.cell.run.is_some() {
            self.stop_cell();
        }
        self.cell.sensor = None;
        self.cell.view.sensor.state = LinkState::Off;
        self.cell.view.sensor.latest = None;
        self.cell.view.live = None;
        self.cell.view.watched_folder = None;
    }

    /// What the live profiles and the search look for.
    pub(super) fn sought(&self) -> Option<Sought> {
        let session = &self.document.as_ref()?.session;
        sought(&session.target, session.sensor.profile_std_mm)
    }

    pub(super) fn poll_links(&mut self, now: Instant) -> bool {
        let mut changed = false;
        let is_replaying = self.cell.replay.is_some();
        if let Some(robot) = &self.cell.robot {
            let (client, view) = (robot.client(), &mut self.cell.view.robot);
            view.state = client.link_state(now);
            changed |= client.take_news();
            // Also without news: when it was told last is known by it.
            if !is_replaying {
                view.latest = client.latest();
            }
        }
        let sought = self.sought();
        if let Some(sensor) = &self.cell.sensor {
            let client = sensor.client();
            client.look_for(sought);
            self.cell.view.sensor.state = client.link_state(now);
            if client.take_news() {
                changed = true;
                let live = client.live();
                if !is_replaying {
                    self.cell.view.sensor.latest = live.as_ref().map(|live| live.reading.clone());
                    self.cell.view.live = live;
                }
            }
        }
        changed |= self.disarm_if_lost();
        self.check_proposal();
        changed
    }

    /// A connection that was made anew is another one: nobody has armed that.
    fn disarm_if_lost(&mut self) -> bool {
        let Some(armed) = self.cell.armed else { return false };
        let is_same = self.cell.robot.as_ref().is_some_and(|robot| robot.client().has_connection(armed.connection));
        if is_same {
            return false;
        }
        self.cell.armed = None;
        self.cell.view.is_armed = false;
        self.notify_of_cell(NoticeKind::Error, words::DISARMED.to_owned());
        match &self.cell.measuring {
            // It is bound to the connection that is gone, and ends by that, in its name; a pause must not keep it from that.
            Some(measuring) => measuring.routine.control().pause(false),
            None => self.end_run(Some(words::LINK_LOST.to_owned())),
        }
        true
    }

    pub(super) fn arm(&mut self) {
        let report = self.cell.robot.as_ref().and_then(|robot| {
            let client = robot.client();
            let is_ready = client.link_state(Instant::now()) == LinkState::Ready;
            client.latest().filter(|_| is_ready).map(|report| (report, client.num_connections()))
        });
        let Some((report, connection)) = report else {
            self.notify_of_cell(NoticeKind::Error, words::NO_POSE_TO_ARM_AT.to_owned());
            return;
        };
        if let Err(refusal) = check_readiness(&report.readiness) {
            self.notify_of_cell(NoticeKind::Error, refusal.to_string());
            return;
        }
        self.cell.armed = Some(Armed { base_from_flange: report.base_from_flange, connection });
        self.cell.view.is_armed = true;
        self.check_proposal();
    }

    /// Forbids motion; what moves is stopped.
    pub(super) fn disarm(&mut self) {
        if self.cell.armed.take().is_some() {
            self.stop_cell();
        }
        self.cell.view.is_armed = false;
        self.check_proposal();
    }

    /// The permission to move within the limits as they are set now.
    pub(super) fn arming(&self) -> Option<Arming> {
        let limits = self.cell.view.settings.limits;
        self.cell.armed.map(|armed| Arming { base_from_flange: armed.base_from_flange, limits })
    }
}
