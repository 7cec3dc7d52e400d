//! A run over several stations: measure where the robot stands, then propose, go, measure, and so on.

use crate::app::cell::{Activity, RunView};
use crate::device::{DeviceError, MotionRefusal, RoutineEnd};
use crate::text::cell as words;

use super::super::{NoticeKind, Workbench};

/// So many stations in a row that were given up end a run.
const MOST_FAILED_IN_A_ROW: u16 = 3;

/// So many poses in a row that the robot would not go to end it as well.
const MOST_REFUSED_IN_A_ROW: u32 = 10;

/// What a run waits for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    /// A proposal is to be asked for.
    Between,
    /// A proposal, on its way.
    Proposing,
    /// Somebody's consent to it.
    Asking,
    /// The end of a station's routine.
    Measuring,
}

/// A run under way.
#[derive(Clone, Copy, Debug)]
pub(super) struct Run {
    num_stations: u16,
    num_done: u16,
    num_failed: u16,
    num_failed_in_a_row: u16,
    is_paused: bool,
    stage: Stage,
}

impl Run {
    const fn view(&self) -> RunView {
        RunView {
            num_done: self.num_done,
            num_failed: self.num_failed,
            num_stations: self.num_stations,
            is_paused: self.is_paused,
            is_asking: matches!(self.stage, Stage::Asking),
        }
    }
}

impl Workbench {
    pub(super) fn start_run(&mut self, num_stations: u16) {
        if self.cell.run.is_some() || self.cell.measuring.is_some() {
            self.notify(NoticeKind::Error, words::BUSY.to_owned());
            return;
        }
        if self.cell.armed.is_none() {
            self.notify(NoticeKind::Error, MotionRefusal::NotArmed.to_string());
            return;
        }
        if num_stations == 0 {
            return;
        }
        let mut run = Run {
            num_stations,
            num_done: 0,
            num_failed: 0,
            num_failed_in_a_row: 0,
            is_paused: false,
            stage: Stage::Between,
        };
        // Where the robot stands there may be a ball in view already.
        if self.cell.view.live.as_ref().is_some_and(|live| live.arc.is_ok()) {
            if let Err(reason) = self.measure_station(None, self.cell.view.settings.routine) {
                self.notify(NoticeKind::Error, reason);
                return;
            }
            run.stage = Stage::Measuring;
        }
        self.cell.run = Some(run);
        self.show_run();
    }

    /// A station's routine has ended: the run counts it and goes on, unless nothing can go on.
    pub(super) fn go_on_after(&mut self, end: &RoutineEnd) {
        let Some(run) = &mut self.cell.run else { return };
        run.stage = Stage::Between;
        if end.is_success() {
            run.num_done += 1;
            run.num_failed_in_a_row = 0;
        } else {
            run.num_failed += 1;
            run.num_failed_in_a_row += 1;
        }
        let (num_done, num_failed, num_in_a_row) = (run.num_done, run.num_failed, run.num_failed_in_a_row);
        let is_complete = num_done >= run.num_stations;
        self.show_run();
        match end {
            // The arm came to its end during a search: elsewhere it may not.
            RoutineEnd::Failed { error: DeviceError::Refused { .. }, .. } if num_in_a_row < MOST_FAILED_IN_A_ROW => {}
            // What happened is in the notice before.
            RoutineEnd::Failed { .. } => self.end_run(Some(words::DEVICE_FAILED.to_owned())),
            RoutineEnd::Stopped { .. } => self.end_run(Some(words::STOPPED.to_owned())),
            RoutineEnd::NotAllowed(refusal) => self.end_run(Some(refusal.to_string())),
            _ if is_complete => {
                self.cell.run = None;
                self.notify(NoticeKind::Done, words::run_done(num_done, num_failed));
            }
            _ if num_in_a_row >= MOST_FAILED_IN_A_ROW => {
                self.end_run(Some(words::failed_in_a_row(num_in_a_row)));
            }
            _ => {}
        }
    }

    /// The robot would not go to a pose, once more: a run asks for another one, unless it was too many.
    pub(super) fn look_elsewhere(&mut self, num_refused: u32) -> bool {
        if self.cell.run.is_none() || num_refused >= MOST_REFUSED_IN_A_ROW {
            return false;
        }
        self.set_stage(Stage::Between);
        true
    }

    /// What a run does between two routines.
    pub(super) fn poll_run(&mut self) -> bool {
        let Some(run) = self.cell.run else { return false };
        if run.is_paused || run.stage == Stage::Measuring {
            return false;
        }
        let has_proposal = self.cell.view.proposal.is_some();
        match run.stage {
            Stage::Between => {
                self.set_stage(Stage::Proposing);
                self.cell.view.activity = Activity::Thinking;
                self.want_proposal();
            }
            Stage::Proposing if has_proposal && self.cell.view.settings.asks_before_motion => {
                self.cell.view.activity = Activity::Idle;
                self.set_stage(Stage::Asking);
            }
            Stage::Proposing if has_proposal => self.go_to_proposal(),
            // Another one was asked for.
            Stage::Asking if !has_proposal && self.cell.proposing.is_wanted() => self.set_stage(Stage::Proposing),
            Stage::Proposing | Stage::Asking | Stage::Measuring => return false,
        }
        true
    }

    /// Nobody is asked.
    fn go_to_proposal(&mut self) {
        let refusal = self.cell.view.proposal.as_ref().and_then(|proposal| proposal.refusal.clone());
        match refusal {
            // The one that is proposed is the first that can be gone to, if there is any.
            Some(refusal) => self.end_run(Some(words::nothing_allowed(&refusal))),
            None => self.accept_proposal(),
        }
    }

    /// A proposal was accepted, which ends a pause as well.
    pub(super) fn run_is_measuring(&mut self) {
        if let Some(run) = &mut self.cell.run {
            run.is_paused = false;
        }
        self.set_stage(Stage::Measuring);
    }

    pub(super) fn pause_run(&mut self, is_paused: bool) {
        let Some(run) = &mut self.cell.run else { return };
        run.is_paused = is_paused;
        // A proposal that was dropped meanwhile is asked for again.
        if !is_paused && run.stage != Stage::Measuring && self.cell.view.proposal.is_none() {
            run.stage = Stage::Between;
        }
        match &self.cell.measuring {
            Some(measuring) => measuring.routine.control().pause(is_paused),
            None => self.cell.view.activity = Activity::Idle,
        }
        self.show_run();
    }

    /// Ends the run before its time; without a reason somebody wanted it.
    pub(super) fn end_run(&mut self, reason: Option<String>) {
        let Some(run) = self.cell.run.take() else { return };
        self.forget_proposal();
        if self.cell.measuring.is_none() {
            self.cell.view.activity = Activity::Idle;
        }
        self.cell.view.run = Some(Run { is_paused: false, stage: Stage::Between, ..run }.view());
        let reason = reason.unwrap_or_else(|| words::STOPPED.to_owned());
        self.notify(NoticeKind::Error, words::run_ended(run.num_done, run.num_stations, &reason));
    }

    fn set_stage(&mut self, stage: Stage) {
        if let Some(run) = &mut self.cell.run {
            run.stage = stage;
        }
        self.show_run();
    }

    fn show_run(&mut self) {
        if let Some(run) = &self.cell.run {
            self.cell.view.run = Some(run.view());
        }
    }
}
