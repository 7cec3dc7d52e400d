//! The next station's pose, before anything moves: from the plan where there is a solution, otherwise roughly.

use crate::app::cell::{Proposal, RoughMounting};
use crate::app::jobs::{JobOutcome, Slot};
use crate::calibrate::{Noise, Reading as MeasuredReading};
use crate::device::{Arming, LinkState, MotionRefusal, RobotReport};
use crate::fit::ArcFit;
use crate::geometry::{Base, Flange, Profile, Rigid, Transform, Vec3};
use crate::plan::{Limits, MeasuredStation, PlannedStation, RoughCell, View, next_rough};
use crate::session::Reading;
use crate::text::cell as words;

use super::super::{NoticeKind, Workbench};

/// Rough poses that are tried before it is said that none can be gone to.
const MOST_ROUGH_TRIES: usize = 8;
/// A pose is that of an avoided one if it is turned against it by less than this, degrees.
const SAME_POSE_DEG: f64 = 3.0;
/// The ball's centre stays so far inside the ends of the line that its arc does too, radii ...
const ARC_HALF_WIDTH_RADII: f64 = 0.6;
/// ... but may always be this far from the middle, radii.
const LEAST_HALF_WIDTH_RADII: f64 = 0.25;
/// How far the ball may be nearer or further than where it was seen, radii: heads see at least that.
const HALF_RANGE_RADII: f64 = 0.4;

/// The way to a proposal.
#[derive(Default)]
pub(super) struct Proposing {
    /// It is wanted, and waits for the plan that follows the last capture.
    is_waiting: bool,
    rough: Slot<Result<PlannedStation, String>>,
    /// Poses that were not wanted, or where nothing could be measured.
    avoided: Vec<Transform<Base, Flange>>,
}

impl Proposing {
    pub const fn is_wanted(&self) -> bool {
        self.is_waiting || self.rough.is_running()
    }
}

/// Why a pose cannot be gone to, apart from the arm switch.
fn obstacle(
    arming: Option<&Arming>,
    report: Option<&RobotReport>,
    to: &Transform<Base, Flange>,
) -> Option<MotionRefusal> {
    let (arming, report) = (arming?, report?);
    arming.check(&report.readiness, &report.base_from_flange, to, arming.limits.transit_speed_mm_s).err()
}

/// Everything that a rough plan needs.
struct RoughPlan {
    cell: RoughCell,
    stations: Vec<MeasuredStation>,
    avoided: Vec<Transform<Base, Flange>>,
    view: View,
    limits: Limits,
    arming: Option<Arming>,
    report: Option<RobotReport>,
}

impl RoughPlan {
    /// The first pose that can be gone to; if there is none, the first of all.
    fn next(mut self) -> Result<PlannedStation, String> {
        let mut first = None;
        for _ in 0..MOST_ROUGH_TRIES {
            let next = next_rough(&self.cell, &self.stations, &self.avoided, &self.view, &self.limits);
            let station = match next {
                Ok((station, _)) => station,
                Err(refusal) if first.is_none() => return Err(refusal.to_string()),
                Err(_) => break,
            };
            let to = station.base_from_flange;
            if obstacle(self.arming.as_ref(), self.report.as_ref(), &to).is_none() {
                return Ok(station);
            }
            self.avoided.push(to);
            first.get_or_insert(station);
        }
        first.ok_or_else(|| words::NO_BALL_SEEN.to_owned())
    }
}

impl Workbench {
    pub(super) fn want_proposal(&mut self) {
        if self.cell.measuring.is_some() {
            self.notify(NoticeKind::Error, words::BUSY.to_owned());
            return;
        }
        self.cell.view.proposal = None;
        self.cell.proposing.is_waiting = true;
        self.poll_proposal();
    }

    /// Another one than that which is proposed.
    pub(super) fn skip_proposal(&mut self) {
        if let Some(proposal) = self.cell.view.proposal.take() {
            self.avoid(proposal.station.base_from_flange);
        }
        self.want_proposal();
    }

    /// Does not propose this pose again as long as there are others.
    pub(super) fn avoid(&mut self, pose: Transform<Base, Flange>) {
        self.cell.proposing.avoided.push(pose);
    }

    pub(super) fn forget_proposal(&mut self) {
        self.cell.view.proposal = None;
        self.cell.proposing.is_waiting = false;
        self.cell.proposing.rough.cancel();
    }

    /// Works out a proposal that is wanted, once the plan that follows the last capture is there.
    pub(super) fn poll_proposal(&mut self) -> bool {
        if let Some(outcome) = self.cell.proposing.rough.poll() {
            match outcome {
                JobOutcome::Done(Ok(station)) => {
                    let reason = words::reason_of_rough(&station);
                    self.cell.view.proposal = Some(self.proposal_of(station, reason));
                }
                JobOutcome::Done(Err(reason)) => self.take_no_proposal(reason),
                broken => self.notify_broken("planning", &broken),
            }
            return true;
        }
        if !self.cell.proposing.is_waiting || self.solving.is_running() || self.plan.is_running() {
            return false;
        }
        self.cell.proposing.is_waiting = false;
        if let Some((station, reason)) = self.planned() {
            self.cell.view.proposal = Some(self.proposal_of(station, reason));
            return true;
        }
        match self.rough_plan() {
            Ok(plan) => self.cell.proposing.rough.start("propose", &self.wake, move |_| plan.next()),
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

    /// Of the plan for the solution: the best station that is not avoided and can be gone to.
    fn planned(&mut self) -> Option<(PlannedStation, String)> {
        let stations = &self.current_plan()?.stations;
        let avoided = &self.cell.proposing.avoided;
        let is_avoided = |station: &&PlannedStation| {
            let pose = station.base_from_flange.rotation();
            avoided.iter().any(|avoided| avoided.rotation().angle_to(&pose).to_degrees() < SAME_POSE_DEG)
        };
        let (arming, report) = (self.arming(), self.cell.view.robot.latest.as_ref());
        let is_free =
            |station: &&PlannedStation| obstacle(arming.as_ref(), report, &station.base_from_flange).is_none();
        let others = || stations.iter().filter(|station| !is_avoided(station));
        let are_all_avoided = others().next().is_none();
        let chosen = others().find(is_free).or_else(|| others().next()).or_else(|| stations.first())?.clone();
        if are_all_avoided {
            // Once round: they are all offered again.
            self.cell.proposing.avoided.clear();
        }
        let now_mm = self.current_plan().and_then(|plan| plan.workspace_point_std_mm);
        let reason = words::reason_of_planned(&chosen, now_mm);
        Some((chosen, reason))
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
            Some(arming) => arming.check(&report.readiness, from, to, arming.limits.transit_speed_mm_s).err(),
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

    /// What the rough plan goes by: the mounting as it was said, and where the ball was seen.
    fn rough_plan(&self) -> Result<RoughPlan, String> {
        let (Some(document), Some(ball)) = (&self.document, self.ball()) else {
            return Err(words::NO_SESSION.to_owned());
        };
        let session = &document.session;
        let mounting = self.cell.view.settings.mounting.ok_or_else(|| words::NO_MOUNTING.to_owned())?;
        let flange_from_sensor = rigid(&mounting);
        let radius_mm = ball.ball_radius_mm;
        let seen = self.largest_sections();
        let first = seen.first().ok_or_else(|| words::NO_BALL_SEEN.to_owned())?;
        let stations: Vec<MeasuredStation> = seen
            .iter()
            .map(|seen| {
                let circle = seen.arc.circle;
                let centre_mm = [circle.x_mm, circle.z_mm];
                MeasuredStation::of_section(seen.base_from_flange, centre_mm, circle.radius_mm, radius_mm)
            })
            .collect();
        let [least_z, most_z] = stations
            .iter()
            .map(|station| station.ball_in_sensor_mm.z)
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], z| [least.min(z), most.max(z)]);
        let half_line_mm = first.profile.x_mm().iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        let view = View {
            half_width_mm: (half_line_mm - ARC_HALF_WIDTH_RADII * radius_mm).max(LEAST_HALF_WIDTH_RADII * radius_mm),
            half_range_mm: HALF_RANGE_RADII * radius_mm,
            middle_range_mm: f64::midpoint(least_z, most_z),
        };
        let looks_along_in_base = first.base_from_flange.rotation() * flange_from_sensor.rotation * Vec3::z();
        let noise = Noise {
            position_std_mm: session.robot.position_std_mm,
            orientation_std_rad: session.robot.orientation_std_deg.map(f64::to_radians),
        };
        let cell = RoughCell {
            mount: session.mount,
            flange_from_sensor,
            ball_in_base_mm: Vec3::zeros(),
            radius_mm,
            noise,
            looks_along_in_base,
        };
        Ok(RoughPlan {
            cell,
            stations,
            avoided: self.cell.proposing.avoided.clone(),
            view,
            limits: self.plan_limits,
            arming: self.arming(),
            report: self.cell.view.robot.latest.clone(),
        })
    }

    /// The largest section of each station; without stations that which is seen now.
    fn largest_sections(&self) -> Vec<Seen<'_>> {
        let mut found = Vec::new();
        if let (Some(document), Some(results)) = (&self.document, &self.results) {
            for (station_idx, station) in document.session.stations.iter().enumerate() {
                let sections = station.captures.iter().enumerate().filter_map(|(capture_idx, capture)| {
                    match (&capture.reading, results.measured.reading(station_idx, capture_idx)) {
                        (Reading::Profile(profile), Some(MeasuredReading::Arc(arc))) => {
                            Some(Seen { base_from_flange: capture.base_from_flange, arc, profile })
                        }
                        _ => None,
                    }
                });
                let radius_mm = |seen: &Seen<'_>| seen.arc.circle.radius_mm;
                found.extend(sections.filter(|_| station.enabled).max_by(|a, b| radius_mm(a).total_cmp(&radius_mm(b))));
            }
        }
        let view = &self.cell.view;
        if found.is_empty()
            && let (Some(live), Some(report)) = (&view.live, &view.robot.latest)
            && view.robot.state == LinkState::Ready
            && let Ok(arc) = &live.arc
        {
            found.push(Seen { base_from_flange: report.base_from_flange, arc, profile: &live.reading.profile });
        }
        found
    }
}

/// A section of the ball with where it was seen from.
struct Seen<'a> {
    base_from_flange: Transform<Base, Flange>,
    arc: &'a ArcFit,
    profile: &'a Profile,
}

fn rigid(mounting: &RoughMounting) -> Rigid {
    let [w, i, j, k] = mounting.quaternion_wxyz;
    let rotation = nalgebra::UnitQuaternion::new_normalize(nalgebra::Quaternion::new(w, i, j, k));
    Rigid::from_parts(Vec3::from(mounting.translation_mm).into(), rotation)
}
