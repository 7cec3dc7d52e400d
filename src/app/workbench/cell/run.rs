//! A run over several stations: measure where the robot stands, then propose, go, measure, and so on.

use std::time::Instant;

use crate::app::cell::{Activity, RunView};
use crate::calibrate::best_available;
use crate::device::{DeviceError, MotionRefusal, RoutineEnd, SearchEnd};
use crate::geometry::{Base, Flange, Transform};
use crate::text::cell as words;

use super::super::{NoticeKind, Workbench};

/// So many stations in a row that were given up end a run.
const MOST_FAILED_IN_A_ROW: u16 = 3;

/// So many poses in a row that the robot would not go to end it as well.
const MOST_REFUSED_IN_A_ROW: u32 = 10;

/// What a robot that stands still may seem to move between two reports: a few times the noise of coarse ones.
const STANDS_WITHIN_MM: f64 = 0.2;
const STANDS_WITHIN_DEG: f64 = 0.1;

/// Nearer than this to a capture the robot stands at its station.
const SAME_STATION_MM: f64 = 0.5;
const SAME_STATION_DEG: f64 = 0.5;

/// A pose that the robot would not go to.
#[derive(Clone, Debug)]
pub(super) struct RefusedPose {
    pub pose: Transform<Base, Flange>,
    /// Where the robot has to stand still, if it is the pose that was refused; `None` where the controller says so itself.
    pub stood_at: Option<Transform<Base, Flange>>,
    /// What the robot said.
    pub reason: String,
    /// When.
    pub at: Instant,
}

/// What a run waits for.
#[derive(Clone, Debug)]
enum Stage {
    /// A proposal is to be asked for.
    Between,
    /// A proposal, on its way.
    Proposing,
    /// Somebody's consent to it.
    Asking,
    /// The end of a station's routine.
    Measuring,
    /// A report of the robot, to see whether it was the pose that it would not go to.
    Refused(RefusedPose),
}

/// A run under way.
#[derive(Clone, Debug)]
pub(super) struct Run {
    num_stations: u16,
    num_done: u16,
    num_failed: u16,
    num_failed_in_a_row: u16,
    is_paused: bool,
    stage: Stage,
}

impl Run {
    fn view(&self) -> RunView {
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
            self.notify_of_cell(NoticeKind::Error, words::BUSY.to_owned());
            return;
        }
        if self.cell.armed.is_none() {
            self.notify_of_cell(NoticeKind::Error, MotionRefusal::NotArmed.to_string());
            return;
        }
        if num_stations == 0 {
            return;
        }
        if num_stations > 1 && !self.can_propose_after_one() {
            self.notify_of_cell(NoticeKind::Error, words::RUN_NEEDS_MOUNTING.to_owned());
            return;
        }
        self.forget_notices_of_cell();
        let mut run = Run {
            num_stations,
            num_done: 0,
            num_failed: 0,
            num_failed_in_a_row: 0,
            is_paused: false,
            stage: Stage::Between,
        };
        // Where the robot stands the target may be in view already.
        if self.cell.view.live.as_ref().is_some_and(|live| live.found.is_ok()) && !self.stands_at_a_station() {
            if let Err(reason) = self.measure_station(None, self.cell.view.settings.routine) {
                self.notify_of_cell(NoticeKind::Error, reason);
                return;
            }
            run.stage = Stage::Measuring;
            if self.search_of(self.cell.view.settings.routine).is_some() {
                self.remark_oblique_travel();
            }
        }
        if self.cell.measuring.is_none() {
            self.cell.view.activity = Activity::Thinking;
        }
        self.cell.run = Some(run);
        self.show_run();
    }

    /// Stations in a row that a run has given up by now.
    pub(super) fn num_given_up_in_a_row(&self) -> u32 {
        self.cell.run.as_ref().map_or(0, |run| run.num_failed_in_a_row.into())
    }

    /// Whether more than the station where the robot stands can be found.
    fn can_propose_after_one(&self) -> bool {
        let is_solved = self.results().is_some_and(|results| best_available(&results.methods).is_some());
        is_solved || self.cell.view.settings.mounting.is_some()
    }

    /// Whether the session has a station where the robot stands: another one there would tell next to nothing.
    fn stands_at_a_station(&self) -> bool {
        let (Some(document), Some(report)) = (&self.document, &self.cell.view.robot.latest) else { return false };
        let here = &report.base_from_flange;
        let mut captures = document.session.stations.iter().flat_map(|station| &station.captures);
        captures.any(|capture| {
            let there = &capture.base_from_flange;
            (there.translation_mm() - here.translation_mm()).norm() <= SAME_STATION_MM
                && there.rotation().angle_to(&here.rotation()).to_degrees() <= SAME_STATION_DEG
        })
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
            RoutineEnd::Stopped { .. } => self.end_run(None),
            RoutineEnd::NotAllowed(refusal) => self.end_run(Some(refusal.to_string())),
            // What happened is in the notice before.
            _ if !is_of_this_pose(end) => self.end_by_trouble(),
            _ if is_complete => {
                self.put_run_away();
                self.notify_of_cell(NoticeKind::Done, words::run_done(num_done, num_failed, self.cell.armed.is_some()));
            }
            _ if num_in_a_row >= MOST_FAILED_IN_A_ROW => {
                self.end_run(Some(words::failed_in_a_row(num_in_a_row)));
            }
            _ => {}
        }
    }

    /// Something is wrong with the cell: nothing moves any more until somebody has seen to it and arms anew.
    fn end_by_trouble(&mut self) {
        self.end_run(Some(words::DEVICE_FAILED.to_owned()));
        self.disarm();
    }

    /// The robot would not go to a pose: a run asks for another one, unless it was too many. Answers whether it does.
    pub(super) fn look_elsewhere(&mut self, refused: RefusedPose) -> bool {
        let num_refused = self.cell.proposing.note_refused(refused.pose);
        if self.cell.run.is_none() || num_refused >= MOST_REFUSED_IN_A_ROW {
            return false;
        }
        self.cell.view.activity = Activity::Thinking;
        self.set_stage(Stage::Refused(refused));
        true
    }

    /// Whether the robot still stands where it stood before a pose was refused, once it has told where it is.
    fn look_after_refusal(&mut self, refused: &RefusedPose) -> bool {
        let Some(stood_at) = &refused.stood_at else {
            self.set_stage(Stage::Between);
            return true;
        };
        let latest = self.cell.view.robot.latest.as_ref().filter(|report| report.received_at > refused.at);
        let Some(latest) = latest else { return false };
        let stands_at = &latest.base_from_flange;
        let moved_mm = (stands_at.translation_mm() - stood_at.translation_mm()).norm();
        let turned_deg = stands_at.rotation().angle_to(&stood_at.rotation()).to_degrees();
        if latest.is_moving != Some(true) && moved_mm <= STANDS_WITHIN_MM && turned_deg <= STANDS_WITHIN_DEG {
            self.set_stage(Stage::Between);
        } else {
            self.notify_of_cell(NoticeKind::Error, refused.reason.clone());
            self.end_by_trouble();
        }
        true
    }

    /// What a run does between two routines.
    pub(super) fn poll_run(&mut self) -> bool {
        let Some(run) = &self.cell.run else { return false };
        let has_proposal = self.cell.view.proposal.is_some();
        match run.stage.clone() {
            // Seen to during a pause as well: it is about where the robot stands now.
            Stage::Refused(refused) => return self.look_after_refusal(&refused),
            _ if run.is_paused => return false,
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

    /// The proposal that a run asked about is gone.
    pub(super) fn ask_no_more(&mut self) {
        if self.cell.run.as_ref().is_some_and(|run| matches!(run.stage, Stage::Asking)) {
            self.set_stage(Stage::Between);
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
        let is_between = !matches!(run.stage, Stage::Measuring | Stage::Refused(_));
        if !is_paused && is_between && self.cell.view.proposal.is_none() {
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
        let Some((num_done, num_stations)) = self.cell.run.as_ref().map(|run| (run.num_done, run.num_stations)) else {
            return;
        };
        self.forget_proposal();
        self.put_run_away();
        if let Some(reason) = reason {
            self.notify_of_cell(NoticeKind::Error, words::run_ended(num_done, num_stations, &reason));
        } else {
            let is_armed = self.cell.armed.is_some();
            self.notify_of_stop(words::run_stopped(num_done, num_stations, is_armed));
        }
    }

    /// What remains to be seen of a run waits for nothing.
    fn put_run_away(&mut self) {
        let Some(run) = self.cell.run.take() else { return };
        self.cell.view.run = Some(Run { is_paused: false, stage: Stage::Between, ..run }.view());
        if self.cell.measuring.is_none() {
            self.cell.view.activity = Activity::Idle;
        }
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

/// Whether another pose may do better: nothing is wrong with the cell, as far as this ending tells.
const fn is_of_this_pose(end: &RoutineEnd) -> bool {
    match end {
        RoutineEnd::Done | RoutineEnd::NothingSeen { .. } => true,
        RoutineEnd::Searched(end) => match end {
            SearchEnd::Found { .. }
            | SearchEnd::NoArcAtStart { .. }
            | SearchEnd::RadiusUnchanged { .. }
            | SearchEnd::ArcLost { .. }
            | SearchEnd::TravelExhausted { .. }
            | SearchEnd::CapturesExhausted { .. } => true,
            // The ball moved or the robot did not, and settings do not change by themselves.
            SearchEnd::ResidualGrew { .. } | SearchEnd::Stuck { .. } | SearchEnd::NotBegun(_) => false,
        },
        // The arm came to its end during a search.
        RoutineEnd::Failed { error: DeviceError::OutOfReach { .. }, robot_stopped } => {
            matches!(robot_stopped, Some(true))
        }
        RoutineEnd::Failed { .. }
        | RoutineEnd::Stopped { .. }
        | RoutineEnd::NotAllowed(_)
        | RoutineEnd::NeverStill { .. }
        | RoutineEnd::StaleProfiles { .. } => false,
    }
}

#[cfg(test)]
#[path = "run_tests.rs"]
mod tests;
