//! The next station's pose, before anything moves: from the plan where there is a solution, otherwise roughly.

use std::sync::Arc;

use crate::app::cell::{Proposal, RoughMounting};
use crate::app::jobs::{JobOutcome, Slot};
use crate::device::{MotionRefusal, SearchSettings};
use crate::geometry::{Base, Flange, Profile, Rigid, Transform, Vec3};
use crate::plan::{Limits, PlannedStation};
use crate::session::Edge;
use crate::text::cell as words;

use super::super::{NoticeKind, Workbench};
use super::choose::{Basis, Chooser, Chosen, check_station};

/// Further than this the sensor is not tilted about a tip, degrees.
const MOST_TILT_AT_TIP_DEG: f64 = 12.0;

/// A solution whose σ is above this (mm) may be further off than the edges of the view: what was said of the mounting is
/// still worth more.
const LOOSE_MM: f64 = 0.5;

/// The way to a proposal.
#[derive(Default)]
pub(super) struct Proposing {
    /// It is wanted, and waits for the plan that follows the last capture.
    is_waiting: bool,
    choosing: Slot<Result<Chosen, String>>,
    /// Poses that were not wanted, or where nothing could be measured.
    avoided: Vec<Transform<Base, Flange>>,
    /// How many of them in a row the robot would not go to.
    num_refused: u32,
    /// Where the searches of this document found their peaks.
    peaks: Vec<FoundPeak>,
}

/// The peak of a search.
pub(super) struct FoundPeak {
    /// The first profile of the search, which tells its station.
    pub first_profile: Arc<Profile>,
    /// The pose at the peak.
    pub base_from_flange: Transform<Base, Flange>,
    /// σ of the peak along the travel, mm.
    pub std_mm: f64,
}

impl Proposing {
    pub const fn is_wanted(&self) -> bool {
        self.is_waiting || self.choosing.is_running()
    }

    /// Nothing was measured at this pose: it is not proposed again as long as there are others.
    pub fn avoid(&mut self, pose: Transform<Base, Flange>) {
        self.avoided.push(pose);
    }

    /// The robot would not go to this pose. Answers how many in a row that were.
    pub fn note_refused(&mut self, pose: Transform<Base, Flange>) -> u32 {
        self.avoid(pose);
        self.num_refused += 1;
        self.num_refused
    }

    /// A station was measured: where the robot can go is known again.
    pub const fn note_measured(&mut self) {
        self.num_refused = 0;
    }

    /// What the searches found.
    pub fn peaks(&self) -> &[FoundPeak] {
        &self.peaks
    }

    /// A search found its peak: the next stations are planned by that.
    pub fn note_peak(&mut self, peak: FoundPeak) {
        self.peaks.push(peak);
    }
}

impl Workbench {
    pub(super) fn want_proposal(&mut self) {
        if self.cell.measuring.is_some() {
            self.notify_of_cell(NoticeKind::Error, words::BUSY.to_owned());
            return;
        }
        self.cell.view.proposal = None;
        self.cell.proposing.is_waiting = true;
        self.poll_proposal();
    }

    /// Another one than that which is proposed.
    pub(super) fn skip_proposal(&mut self) {
        if let Some(proposal) = self.cell.view.proposal.take() {
            self.cell.proposing.avoid(proposal.station.base_from_flange);
        }
        self.want_proposal();
    }

    pub(super) fn forget_proposal(&mut self) {
        self.cell.view.proposal = None;
        self.cell.proposing.is_waiting = false;
        self.cell.proposing.choosing.cancel();
    }

    /// Works out a proposal that is wanted, once the plan that follows the last capture is there.
    pub(super) fn poll_proposal(&mut self) -> bool {
        if let Some(outcome) = self.cell.proposing.choosing.poll() {
            match outcome {
                JobOutcome::Done(Ok((station, reason))) => {
                    self.cell.view.proposal = Some(self.proposal_of(station, reason));
                }
                JobOutcome::Done(Err(reason)) => {
                    // Once round: all are offered again.
                    self.cell.proposing.avoided.clear();
                    self.take_no_proposal(reason);
                }
                broken => {
                    self.notify_broken("planning", &broken);
                    self.end_run(Some(words::NO_PROPOSAL.to_owned()));
                }
            }
            return true;
        }
        if !self.cell.proposing.is_waiting || self.solving.is_running() || self.plan.is_running() {
            return false;
        }
        self.cell.proposing.is_waiting = false;
        match self.basis() {
            Ok(basis) => {
                let mut chooser = Chooser {
                    basis,
                    avoided: self.cell.proposing.avoided.clone(),
                    limits: self.limits_of_target(),
                    arming: self.arming(),
                    report: self.cell.view.robot.latest.clone(),
                    search: self.search_at_stations(),
                };
                // Nearer to the middle of what was measured there is less to go wrong.
                let num_narrower = self.cell.proposing.num_refused + self.num_given_up_in_a_row();
                (0..num_narrower).for_each(|_| chooser.narrow());
                self.cell.proposing.choosing.start("propose", &self.wake, move |_| chooser.choose());
            }
            Err(reason) => self.take_no_proposal(reason),
        }
        true
    }

    /// The flanks of a tip are steep as it is: tilted as far as a ball allows, one of them is not seen any more. A plate's
    /// edges tell more the longer they are followed.
    fn limits_of_target(&self) -> Limits {
        let limits = self.plan_limits;
        let is_tip = self.sought().is_some_and(|sought| sought.is_tip());
        let most_tilt_deg = if is_tip { MOST_TILT_AT_TIP_DEG } else { limits.max_tilt_deg };
        // Where something could not be gone to or showed nothing, the edge may have ended.
        let beyond_mm = if self.cell.proposing.avoided.is_empty() { self.edge_goes_on_for_mm() } else { 0.0 };
        let only_edge = self.edge_behind();
        Limits { max_tilt_deg: limits.max_tilt_deg.min(most_tilt_deg), beyond_mm, only_edge, ..limits }
    }

    /// The edge of a plate that was asked for less often than the other by two: both have to be known well. What was given
    /// up counts as well, as an edge may not be in reach any further.
    fn edge_behind(&self) -> Option<Edge> {
        let stations = &self.document.as_ref()?.session.stations;
        let [num_p, num_q] =
            [Edge::P, Edge::Q].map(|edge| stations.iter().filter(|station| station.edge == Some(edge)).count());
        match () {
            () if num_p + 2 <= num_q => Some(Edge::P),
            () if num_q + 2 <= num_p => Some(Edge::Q),
            () => None,
        }
    }

    fn take_no_proposal(&mut self, reason: String) {
        if self.cell.run.is_some() {
            self.end_run(Some(reason));
        } else {
            self.notify_of_cell(NoticeKind::Error, reason);
        }
    }

    fn proposal_of(&self, station: PlannedStation, reason: String) -> Proposal {
        let search = self.search_at_stations();
        let oblique = search.and_then(|search| self.check_travel(&station.base_from_flange, &search).ok().flatten());
        let reason = match oblique {
            Some(angle_deg) => format!("{reason}. {}", words::travel_is_oblique(angle_deg)),
            None => reason,
        };
        let mut proposal = Proposal { station, reason, distance_mm: 0.0, turn_deg: 0.0, refusal: None };
        self.check_against_robot(&mut proposal);
        proposal
    }

    fn check_against_robot(&self, proposal: &mut Proposal) {
        let Some(report) = &self.cell.view.robot.latest else { return };
        let (from, to) = (&report.base_from_flange, &proposal.station.base_from_flange);
        proposal.distance_mm = (to.translation_mm() - from.translation_mm()).norm();
        proposal.turn_deg = from.rotation().angle_to(&to.rotation()).to_degrees();
        proposal.refusal = match self.arming() {
            None => Some(MotionRefusal::NotArmed),
            Some(arming) => {
                let search = self.search_at_stations();
                let across = search.as_ref().map_or(Ok(None), |search| self.check_travel(to, search));
                across.and_then(|_| check_station(&arming, report, to, search.as_ref())).err()
            }
        };
    }

    /// The search that a run makes at each station, if that is what it makes.
    fn search_at_stations(&self) -> Option<SearchSettings> {
        self.search_of(self.cell.view.settings.routine)
    }

    /// The robot, the switch or the limits may have changed since.
    pub(super) fn check_proposal(&mut self) {
        if let Some(mut proposal) = self.cell.view.proposal.take() {
            self.check_against_robot(&mut proposal);
            self.cell.view.proposal = Some(proposal);
        }
    }

    pub(super) fn accept_proposal(&mut self) {
        let Some(proposal) = &self.cell.view.proposal else {
            self.notify_of_cell(NoticeKind::Error, words::NO_PROPOSAL.to_owned());
            return;
        };
        let target = proposal.station.base_from_flange;
        if let Some(refusal) = &proposal.refusal {
            let reason = refusal.to_string();
            self.notify_of_cell(NoticeKind::Error, reason);
            return;
        }
        let settings = &mut self.cell.view.settings;
        let routine = settings.routine;
        // It stays chosen: the line is then on that edge.
        settings.edge = proposal.station.edge.unwrap_or(settings.edge);
        match self.measure_station(Some(target), routine) {
            Ok(()) => self.run_is_measuring(),
            Err(reason) => self.take_no_proposal(reason),
        }
    }

    pub(super) fn drop_proposal(&mut self) {
        self.forget_proposal();
        self.pause_run(true);
        self.ask_no_more();
    }

    /// What the next station is chosen by.
    fn basis(&self) -> Result<Basis, String> {
        let is_rough =
            self.current_plan().and_then(|plan| plan.workspace_point_std_mm).is_none_or(|std| std > LOOSE_MM);
        if is_rough && let Ok(basis) = self.rough_basis() {
            return Ok(basis);
        }
        match (self.current_plan(), self.case()) {
            (Some(plan), Some((_, _, results))) => {
                let mut planned = plan.clone();
                if self.limits_of_target() != self.plan_limits {
                    planned.stations.clear();
                }
                Ok(Basis::Solved { results, planned })
            }
            _ => self.rough_basis(),
        }
    }
}

pub(super) fn rigid(mounting: &RoughMounting) -> Rigid {
    let [w, i, j, k] = mounting.quaternion_wxyz;
    let rotation = nalgebra::UnitQuaternion::new_normalize(nalgebra::Quaternion::new(w, i, j, k));
    Rigid::from_parts(Vec3::from(mounting.translation_mm).into(), rotation)
}
