//! The live cell behind the window: its links, its routine, its run, and what they bring into the document.

mod captures;
mod choose;
mod links;
mod practice;
mod proposals;
mod replay;
mod rough;
mod run;
mod travel;

use std::time::Instant;

use crate::app::cell::{Activity, CellCommand, CellSettings, CellView};
use crate::device::{Deadlines, RobotWorker, SensorWorker};
use crate::text::cell as words;

use self::captures::Measuring;
use self::links::Armed;
use self::practice::Practice;
use self::proposals::Proposing;
use self::replay::Replay;
use self::run::Run;
use super::{NoticeKind, Workbench};

/// Everything of the cell that is not the document's.
#[derive(Default)]
pub(super) struct LiveCell {
    view: CellView,
    deadlines: Deadlines,
    robot: Option<RobotWorker>,
    sensor: Option<SensorWorker>,
    armed: Option<Armed>,
    measuring: Option<Measuring>,
    proposing: Proposing,
    run: Option<Run>,
    practice: Option<Practice>,
    replay: Option<Replay>,
    /// What was told of the cell.
    notice_ids: Vec<u64>,
    /// The line of the last stop that was wanted.
    stop_notice_id: Option<u64>,
    /// The document of which it was said that its robot is another one.
    remarked_robot_of: Option<u64>,
}

impl LiveCell {
    /// Whether a routine is under way, whose captures come into the document one by one.
    pub(super) const fn is_measuring(&self) -> bool {
        self.measuring.is_some()
    }
}

impl Workbench {
    /// The live cell as it stands.
    #[must_use]
    pub const fn cell(&self) -> &CellView {
        &self.cell.view
    }

    /// How long devices are waited for, from the next connection on.
    pub const fn set_cell_deadlines(&mut self, deadlines: Deadlines) {
        self.cell.deadlines = deadlines;
    }

    pub(super) fn command_cell(&mut self, command: CellCommand) {
        match command {
            CellCommand::ConnectRobot(setup) => {
                self.end_practice();
                self.connect_robot(setup);
            }
            CellCommand::ConnectSensor(setup) => {
                self.end_practice();
                self.connect_sensor(setup);
            }
            CellCommand::DisconnectRobot => self.disconnect_robot(),
            CellCommand::DisconnectSensor => self.disconnect_sensor(),
            CellCommand::Practise(part) => self.practise(part),
            CellCommand::JogToEdge(edge) => self.jog_to_edge(edge),
            CellCommand::EndPractice => self.end_practice(),
            CellCommand::Arm(true) => self.arm(),
            CellCommand::Arm(false) => self.disarm(),
            CellCommand::SetSettings(settings) => self.set_cell_settings(&settings),
            CellCommand::CaptureStation => self.capture_here(),
            CellCommand::FindLargestArc | CellCommand::FindTip => self.search_here(),
            CellCommand::ProposeStation => self.want_proposal(),
            CellCommand::AcceptProposal => self.accept_proposal(),
            CellCommand::SkipProposal => self.skip_proposal(),
            CellCommand::DropProposal => self.drop_proposal(),
            CellCommand::StartRun { num_stations } => self.start_run(num_stations),
            CellCommand::PauseRun => self.pause_run(true),
            CellCommand::ResumeRun => self.pause_run(false),
            CellCommand::Stop => self.stop_cell(),
            CellCommand::StartReplay => self.start_replay(),
            CellCommand::EndReplay => self.end_replay(),
        }
    }

    /// A routine keeps what it was begun with: what concerns motion and captures changes only between two of them, so that
    /// what is shown is what holds. One that was told to stop moves no more.
    fn set_cell_settings(&mut self, settings: &CellSettings) {
        let mut settings = *settings;
        if self.cell.measuring.is_some() && self.cell.view.are_settings_in_use() {
            let in_use = self.cell.view.settings;
            let (limits, search, settle) = (in_use.limits, in_use.search, in_use.settle);
            if (settings.limits, settings.search, settings.settle) != (limits, search, settle) {
                self.notify_of_cell(NoticeKind::Error, words::SETTINGS_IN_USE.to_owned());
            }
            settings = CellSettings { limits, search, settle, ..settings };
        }
        self.cell.view.settings = settings;
    }

    /// Takes in what the devices and the routine have told. Answers whether anything changed.
    pub(super) fn poll_cell(&mut self) -> bool {
        let now = Instant::now();
        let links = self.poll_links(now);
        let routine = self.poll_routine();
        let proposal = self.poll_proposal();
        let run = self.poll_run();
        let replay = self.poll_replay(now);
        links || routine || proposal || run || replay
    }

    /// Stops the robot first, then everything that would move it again.
    fn stop_cell(&mut self) {
        if let Some(robot) = &self.cell.robot {
            robot.client().stop();
        }
        if let Some(measuring) = &self.cell.measuring {
            measuring.routine.control().stop();
            self.cell.view.activity = Activity::Stopping;
        }
        self.forget_proposal();
        self.end_run(None);
    }

    /// The document leaves the bench: what was captured is in it, nothing more comes.
    pub(super) fn let_go_of_document(&mut self) {
        self.poll_routine();
        if self.cell.measuring.is_some() || self.cell.run.is_some() {
            self.stop_cell();
            self.notify_of_stop(words::DOCUMENT_GONE.to_owned());
        }
        if let Some(measuring) = &mut self.cell.measuring {
            measuring.leave_document();
        }
        // How things went is told of the document that they went into.
        let view = &mut self.cell.view;
        (view.last_end, view.search, view.run, view.repeat_std_mm) = (None, None, None, None);
        self.forget_proposal();
        self.cell.proposing = Proposing::default();
        self.end_replay();
        // Whoever armed motion meant the session that was open.
        self.disarm();
    }

    fn notify_of_cell(&mut self, kind: NoticeKind, message: String) {
        self.notify(kind, message);
        self.cell.notice_ids.push(self.last_notice_id);
    }

    /// A stop that somebody wanted is no error, and of several the last one is enough.
    fn notify_of_stop(&mut self, message: String) {
        if let Some(id) = self.cell.stop_notice_id {
            self.notices.retain(|notice| notice.id != id);
        }
        self.notify_of_cell(NoticeKind::Done, message);
        self.cell.stop_notice_id = Some(self.last_notice_id);
    }

    /// Something begins anew: what was told of the cell before is history.
    fn forget_notices_of_cell(&mut self) {
        let ids = std::mem::take(&mut self.cell.notice_ids);
        self.notices.retain(|notice| !ids.contains(&notice.id));
    }
}
