//! The next station's pose, before anything moves: from the plan where there is a solution, otherwise roughly.

use crate::app::cell::{Proposal, RoughMounting};
use crate::calibrate::{Noise, Reading as MeasuredReading};
use crate::device::{LinkState, MotionRefusal};
use crate::fit::ArcFit;
use crate::geometry::{Base, Flange, Rigid, Transform, Vec3};
use crate::plan::{Limits, PlannedStation, RoughCell, from_nothing};
use crate::text::cell as words;

use super::super::{NoticeKind, Workbench};

/// Poses that are worked out at once before there is a solution.
const NUM_ROUGH: usize = 12;

impl Workbench {
    pub(super) fn want_proposal(&mut self, idx: usize) {
        if self.cell.measuring.is_some() {
            self.notify(NoticeKind::Error, words::BUSY.to_owned());
            return;
        }
        self.cell.view.proposal = None;
        self.cell.wanted_proposal = Some(idx);
        self.poll_proposal();
    }

    pub(super) fn forget_proposal(&mut self) {
        self.cell.view.proposal = None;
        self.cell.wanted_proposal = None;
    }

    /// Works out a proposal that is wanted, once the plan that follows the last capture is there.
    pub(super) fn poll_proposal(&mut self) -> bool {
        let Some(idx) = self.cell.wanted_proposal else { return false };
        if self.solving.is_running() || self.plan.is_running() {
            return false;
        }
        self.cell.wanted_proposal = None;
        match self.candidates() {
            Ok(candidates) if !candidates.is_empty() => self.propose(candidates, idx),
            Ok(_) => self.take_no_proposal(words::NO_BALL_SEEN.to_owned()),
            Err(reason) => self.take_no_proposal(reason),
        }
        true
    }

    fn take_no_proposal(&mut self, reason: String) {
        if self.cell.run.is_some() {
            self.end_run(Some(reason));
        } else {
            self.notify(NoticeKind::Error, reason);
        }
    }

    /// The wanted one of the candidates, or the next after it that can be gone to.
    fn propose(&mut self, candidates: Vec<(PlannedStation, String)>, idx: usize) {
        let num = candidates.len();
        let proposals: Vec<Proposal> =
            candidates.into_iter().map(|(station, reason)| self.proposal_of(station, reason)).collect();
        let from_wanted = |offset: usize| (idx + offset) % num;
        let chosen = (0..num)
            .map(from_wanted)
            .find(|idx| matches!(proposals[*idx].refusal, None | Some(MotionRefusal::NotArmed)))
            .unwrap_or(from_wanted(0));
        self.cell.proposed_idx = chosen;
        self.cell.view.proposal = proposals.into_iter().nth(chosen);
    }

    fn proposal_of(&self, station: PlannedStation, reason: String) -> Proposal {
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
                arming.check(&report.readiness, from, to, arming.limits.transit_speed_mm_s).err()
            }
        };
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
            self.notify(NoticeKind::Error, words::NO_PROPOSAL.to_owned());
            return;
        };
        let target = proposal.station.base_from_flange;
        if let Some(refusal) = &proposal.refusal {
            let reason = refusal.to_string();
            self.notify(NoticeKind::Error, reason);
            return;
        }
        let routine = self.cell.view.settings.routine;
        match self.measure_station(Some(target), routine) {
            Ok(()) => self.run_is_measuring(),
            Err(reason) => self.take_no_proposal(reason),
        }
    }

    pub(super) fn drop_proposal(&mut self) {
        self.forget_proposal();
        self.pause_run(true);
    }

    /// Poses that could be gone to next, the best first, each with its reason.
    fn candidates(&self) -> Result<Vec<(PlannedStation, String)>, String> {
        if let Some(plan) = self.current_plan() {
            let now_mm = plan.workspace_point_std_mm;
            let with_reason = |station: &PlannedStation| (station.clone(), words::reason_of_planned(station, now_mm));
            return Ok(plan.stations.iter().map(with_reason).collect());
        }
        let (cell, limits, num_measured) = self.rough_cell()?;
        let plan = from_nothing(&cell, &limits, num_measured + NUM_ROUGH).map_err(|refusal| refusal.to_string())?;
        let with_reason = |station: PlannedStation| {
            let reason = words::reason_of_rough(&station);
            (station, reason)
        };
        Ok(plan.stations.into_iter().skip(num_measured).map(with_reason).collect())
    }

    /// The cell from the rough mounting, and from where the ball was seen.
    fn rough_cell(&self) -> Result<(RoughCell, Limits, usize), String> {
        let (Some(document), Some(ball)) = (&self.document, self.ball()) else {
            return Err(words::NO_SESSION.to_owned());
        };
        let session = &document.session;
        let mounting = self.cell.view.settings.mounting.ok_or_else(|| words::NO_MOUNTING.to_owned())?;
        let flange_from_sensor = rigid(&mounting);
        let seen = self.largest_sections();
        let &(first, _) = seen.first().ok_or_else(|| words::NO_BALL_SEEN.to_owned())?;
        let base_from_sensor = |pose: &Transform<Base, Flange>| pose.rigid() * flange_from_sensor;
        #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^52 stations")]
        let scale = 1.0 / seen.len() as f64;
        let ball_in_base_mm =
            seen.iter().map(|(pose, centre)| (base_from_sensor(pose) * nalgebra::Point3::from(*centre)).coords).sum::<Vec3>()
                * scale;
        let standoff_mm = seen.iter().map(|(_, centre)| centre.z).sum::<f64>() * scale;
        let cell = RoughCell {
            mount: session.mount,
            flange_from_sensor,
            ball_in_base_mm,
            radius_mm: ball.ball_radius_mm,
            noise: Noise {
                position_std_mm: session.robot.position_std_mm,
                orientation_std_rad: session.robot.orientation_std_deg.map(f64::to_radians),
            },
            looks_along_in_base: base_from_sensor(&first).rotation * Vec3::z(),
        };
        // The ball's middle stays within the range that is known to be in view, give or take half a radius.
        let slack_mm = 0.5 * ball.ball_radius_mm;
        let limits = Limits {
            standoff_mm: Some([standoff_mm - slack_mm, standoff_mm + slack_mm]),
            half_width_mm: Some(slack_mm),
            ..self.plan_limits
        };
        Ok((cell, limits, session.stations.len()))
    }

    /// Where the ball's centre was in the sensor, roughly, with the pose: the largest section of each station; without
    /// stations the live one.
    fn largest_sections(&self) -> Vec<(Transform<Base, Flange>, Vec3)> {
        let centre = |arc: &ArcFit| Vec3::new(arc.circle.x_mm, 0.0, arc.circle.z_mm);
        let mut found = Vec::new();
        if let (Some(document), Some(results)) = (&self.document, &self.results) {
            for (station_idx, station) in document.session.stations.iter().enumerate().filter(|(_, station)| station.enabled)
            {
                let arcs = station.captures.iter().enumerate().filter_map(|(capture_idx, capture)| {
                    match results.measured.reading(station_idx, capture_idx) {
                        Some(MeasuredReading::Arc(arc)) => Some((capture, arc)),
                        _ => None,
                    }
                });
                let largest = arcs.max_by(|(_, a), (_, b)| a.circle.radius_mm.total_cmp(&b.circle.radius_mm));
                found.extend(largest.map(|(capture, arc)| (capture.base_from_flange, centre(arc))));
            }
        }
        let view = &self.cell.view;
        if found.is_empty()
            && let (Some(live), Some(report)) = (&view.live, &view.robot.latest)
            && view.robot.state == LinkState::Ready
            && let Ok(arc) = &live.arc
        {
            found.push((report.base_from_flange, centre(arc)));
        }
        found
    }
}

fn rigid(mounting: &RoughMounting) -> Rigid {
    let [w, i, j, k] = mounting.quaternion_wxyz;
    let rotation = nalgebra::UnitQuaternion::new_normalize(nalgebra::Quaternion::new(w, i, j, k));
    Rigid::from_parts(Vec3::from(mounting.translation_mm).into(), rotation)
}

