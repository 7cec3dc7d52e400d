//! A routine at work, and the way of its captures into the document: one station, one step of undo.

use std::collections::HashSet;
use std::sync::Arc;
use std::time::Instant;

use crate::app::cell::{Activity, CellView, StationRoutine};
use crate::calibrate::SideChoice;
use crate::device::{
    DeviceError, LinkState, Measurement, RobotKind, Routine, RoutineEnd, RoutineEvent, SearchEnd, SearchReport,
    SearchSettings, StepCapture, Task,
};
use crate::fit::Sought;
use crate::geometry::{Base, Flange, Profile, Transform};
use crate::session::edit::{CellValue, free_label};
use crate::session::model::UnknownFields;
use crate::session::{Capture, Edge, Edit, Place, Reading, Session, SetupField, Station, Target, new_gesture};
use crate::text::cell as words;
use crate::text::edits::capture_label;

use super::super::{NoticeKind, Workbench};
use super::proposals::{FoundPeak, rigid};
use super::run::RefusedPose;

/// A routine with the station that it measures.
pub(super) struct Measuring {
    pub routine: Routine,
    /// The document that its captures belong to; `None` once that has left the bench.
    document_id: Option<u64>,
    /// Whether that has left the bench.
    has_left: bool,
    /// All captures of the station are one step of undo.
    gesture: u64,
    label: String,
    /// The edge that is seen, of a plate.
    edge: Option<Edge>,
    go_to: Option<Transform<Base, Flange>>,
    /// Where the robot stood when it began.
    stood_at: Option<Transform<Base, Flange>>,
    /// Whether a search has told of itself.
    has_searched: bool,
    /// The pose of the first capture.
    first_pose: Option<Transform<Base, Flange>>,
    /// What was captured: it tells the station from others, whatever it is called and wherever it is moved.
    profiles: Vec<Arc<Profile>>,
}

impl Measuring {
    /// Nothing more is taken from it.
    pub fn give_up(&mut self) {
        self.document_id = None;
    }

    /// The document leaves the bench, and how this ends says nothing of the next one.
    pub fn leave_document(&mut self) {
        self.give_up();
        self.has_left = true;
    }

    /// The station with the most of what was captured.
    fn station_idx(&self, session: &Session) -> Option<usize> {
        let counted = session.stations.iter().map(|station| self.num_captures_in(station)).enumerate();
        counted.filter(|(_, count)| *count > 0).max_by_key(|(_, count)| *count).map(|(idx, _)| idx)
    }

    fn num_captures_in(&self, station: &Station) -> usize {
        let is_ours = |capture: &&Capture| {
            let Reading::Profile(profile) = &capture.reading else { return false };
            self.profiles.iter().any(|ours| Arc::ptr_eq(ours, profile))
        };
        station.captures.iter().filter(is_ours).count()
    }

    /// Whether any of what was captured is not in the session any more.
    fn is_taken_back(&self, session: &Session) -> bool {
        session.stations.iter().map(|station| self.num_captures_in(station)).sum::<usize>() < self.profiles.len()
    }
}

impl Workbench {
    pub(super) fn capture_here(&mut self) {
        self.measure_by_hand(StationRoutine::FixedPoint);
    }

    /// That of a ball's largest arc, or of a tip.
    pub(super) fn search_here(&mut self) {
        self.measure_by_hand(StationRoutine::LargestArc);
    }

    fn measure_by_hand(&mut self, routine: StationRoutine) {
        if self.cell.run.is_some() {
            self.notify_of_cell(NoticeKind::Error, words::BUSY.to_owned());
        } else if let Err(reason) = self.measure_station(None, routine) {
            self.notify_of_cell(NoticeKind::Error, reason);
        } else if self.search_of(routine).is_some() {
            self.remark_oblique_travel();
        }
    }

    /// The search that a routine makes of what is measured here; none on a plate, where one profile is enough.
    pub(super) fn search_of(&self, routine: StationRoutine) -> Option<SearchSettings> {
        let is_searched = self.sought().is_some_and(|sought| sought.ball().is_some() || sought.is_tip());
        (is_searched && routine == StationRoutine::LargestArc).then_some(self.cell.view.settings.search)
    }

    /// A search from here that is longer than it has to be.
    pub(super) fn remark_oblique_travel(&mut self) {
        let Some(at) = self.cell.view.robot.latest.as_ref().map(|report| report.base_from_flange) else { return };
        if let Ok(Some(angle_deg)) = self.check_travel(&at, &self.cell.view.settings.search) {
            self.notify_of_cell(NoticeKind::Done, words::travel_is_oblique(angle_deg));
        }
    }

    /// Starts a routine for a new station; or says why there is none.
    pub(super) fn measure_station(
        &mut self,
        go_to: Option<Transform<Base, Flange>>,
        routine: StationRoutine,
    ) -> Result<(), String> {
        if self.cell.measuring.is_some() {
            return Err(words::BUSY.to_owned());
        }
        let Some(document) = &self.document else { return Err(words::NO_SESSION.to_owned()) };
        let sought = self.sought().ok_or_else(|| words::NOTHING_TO_CAPTURE.to_owned())?;
        let robot = self.cell.robot.as_ref().ok_or_else(|| words::NO_ROBOT.to_owned())?;
        let sensor = self.cell.sensor.as_ref().ok_or_else(|| words::NO_SENSOR.to_owned())?;
        let now = Instant::now();
        need_ready(robot.client().link_state(now), words::NO_ROBOT)?;
        need_ready(sensor.client().link_state(now), words::NO_SENSOR)?;
        let settings = &self.cell.view.settings;
        let latest = self.cell.view.robot.latest.as_ref();
        if let (Some(search), Some(at)) =
            (self.search_of(routine), go_to.or(latest.map(|report| report.base_from_flange)))
        {
            self.check_travel(&at, &search).map_err(|refusal| refusal.to_string())?;
        }
        let measurement = match (routine, &sought) {
            (StationRoutine::LargestArc, Sought::Arc(ball)) => Measurement::LargestArc(settings.search, *ball),
            (StationRoutine::LargestArc, Sought::Edge(tip)) if sought.is_tip() => {
                Measurement::Tip(settings.search, *tip)
            }
            // Whoever captures by hand has seen what there is; a run has not.
            (StationRoutine::LargestArc | StationRoutine::FixedPoint, _) => {
                Measurement::Profile(go_to.is_some().then_some(sought))
            }
        };
        let task = Task { go_to, measurement: Some(measurement), settle: settings.settle, arming: self.arming() };
        let edge = (document.session.target == Target::RightAnglePlate).then_some(settings.edge);
        let label = next_label(&document.session, edge);
        // What was begun over one connection does not go on over the next.
        let (robot, sensor) = (robot.client().of_this_connection(), sensor.client().of_this_connection());
        self.cell.measuring = Some(Measuring {
            routine: Routine::start(task, robot, sensor, self.wake.clone()),
            document_id: Some(document.id),
            has_left: false,
            gesture: new_gesture(),
            label,
            edge,
            go_to,
            stood_at: self.cell.view.robot.latest.as_ref().map(|report| report.base_from_flange),
            has_searched: false,
            first_pose: None,
            profiles: Vec::new(),
        });
        self.end_replay();
        self.forget_proposal();
        if self.cell.run.is_none() {
            // One station by itself: the progress of an earlier run is not its own.
            self.cell.view.run = None;
        }
        self.cell.view.last_end = None;
        self.cell.view.activity = if go_to.is_some() { Activity::Moving } else { Activity::Settling };
        Ok(())
    }

    /// Takes in what the routine has told.
    pub(super) fn poll_routine(&mut self) -> bool {
        let mut changed = self.stop_if_taken_back();
        while let Some(event) = self.cell.measuring.as_mut().and_then(|measuring| measuring.routine.poll()) {
            changed = true;
            match event {
                RoutineEvent::Moving { .. } => self.show_activity(Activity::Moving),
                RoutineEvent::Settling => self.show_activity(Activity::Settling),
                RoutineEvent::Captured(capture) => {
                    self.show_activity(Activity::Thinking);
                    self.cell.view.repeat_std_mm = capture.repeat_std_mm;
                    self.keep_capture(capture);
                }
                RoutineEvent::Searched(report) => self.show_search(Arc::from(report)),
                RoutineEvent::Ended(end) => self.end_routine(&end),
            }
        }
        changed
    }

    fn show_search(&mut self, report: Arc<SearchReport>) {
        if let Some(measuring) = &mut self.cell.measuring {
            measuring.has_searched = true;
        }
        self.cell.view.search = Some(report);
    }

    /// A routine that was told to stop may still tell what it does.
    fn show_activity(&mut self, activity: Activity) {
        if self.cell.view.activity != Activity::Stopping {
            self.cell.view.activity = activity;
        }
    }

    /// Puts a capture into the document at once.
    fn keep_capture(&mut self, captured: StepCapture) {
        let (Some(measuring), Some(document)) = (&mut self.cell.measuring, &self.document) else { return };
        if measuring.document_id != Some(document.id) {
            return;
        }
        let profile = Arc::clone(&captured.profile);
        let capture = Capture {
            base_from_flange: captured.base_from_flange,
            written_angles: None,
            reading: Reading::Profile(captured.profile),
            step_mm: captured.step_mm,
            unknown: UnknownFields::new(),
        };
        let edit = if measuring.profiles.is_empty() {
            let station = Station {
                label: measuring.label.clone(),
                enabled: true,
                side: SideChoice::Auto,
                edge: measuring.edge,
                captures: vec![capture],
                unknown: UnknownFields::new(),
            };
            let insert = Edit::InsertStations { at: document.session.stations.len(), stations: vec![station] };
            let mut edits = self.cell.view.what_is_connected(&document.session);
            edits.push(insert);
            Edit::Several(edits)
        } else {
            // A station that is gone was taken back: that is told elsewhere.
            let Some(station_idx) = measuring.station_idx(&document.session) else { return };
            Edit::AppendCapture { station_idx, capture: Box::new(capture) }
        };
        let (gesture, label) = (measuring.gesture, capture_label(&words::station(&measuring.label)));
        if self.edit_as(&edit, Some(gesture), label)
            && let Some(measuring) = &mut self.cell.measuring
        {
            measuring.first_pose.get_or_insert(captured.base_from_flange);
            measuring.profiles.push(profile);
        }
        self.remark_other_robot();
    }

    /// Stations of two robots make no calibration: that is said once a session.
    fn remark_other_robot(&mut self) {
        let (Some(document), Some(setup)) = (&self.document, &self.cell.view.robot.setup) else { return };
        let (recorded, connected) = (make_of(&document.session.robot.model), words::make_of_robot(setup.kind));
        if self.cell.practice.is_some() || self.cell.remarked_robot_of == Some(document.id) {
            return;
        }
        if let (Some(recorded), Some(connected)) = (recorded, connected)
            && recorded != connected
        {
            self.cell.remarked_robot_of = Some(document.id);
            self.notify_of_cell(NoticeKind::Error, words::other_robot(recorded, connected));
        }
    }

    /// Undo takes a station back, or a part of it, while it is being measured: there is no sense in going on.
    fn stop_if_taken_back(&mut self) -> bool {
        let (Some(measuring), Some(document)) = (&mut self.cell.measuring, &self.document) else { return false };
        let is_taken_back = measuring.document_id == Some(document.id) && measuring.is_taken_back(&document.session);
        if is_taken_back {
            measuring.give_up();
            self.stop_cell();
            self.notify_of_cell(NoticeKind::Error, words::STATION_TAKEN_BACK.to_owned());
        }
        is_taken_back
    }

    fn end_routine(&mut self, end: &RoutineEnd) {
        let Some(measuring) = self.cell.measuring.take() else { return };
        self.cell.view.activity = Activity::Idle;
        if !measuring.has_left || may_still_move(end) {
            self.cell.view.last_end = Some(end.clone());
        }
        if !measuring.has_searched {
            // That of the station before was shown on the way; it is not this one's.
            self.cell.view.search = None;
        }
        if let Some(refused) = refused_pose(&measuring, end)
            && self.look_elsewhere(refused)
        {
            return;
        }
        let num_captures = if measuring.document_id.is_some() { measuring.profiles.len() } else { 0 };
        if let RoutineEnd::Stopped { robot_stopped: Some(true) } = end {
            // The line of its run says so already.
            if self.cell.view.run.is_none() && !measuring.has_left {
                self.notify_of_stop(words::stopped(&words::station(&measuring.label), num_captures));
            }
        } else if let Some(message) = words::routine_ended(&words::station(&measuring.label), num_captures, end) {
            self.notify_of_cell(NoticeKind::Error, message);
        }
        if let RoutineEnd::Searched(SearchEnd::Found { peak_mm, peak_std_mm }) = end {
            self.note_peak(&measuring, *peak_mm, *peak_std_mm);
        }
        if let RoutineEnd::Searched(SearchEnd::NoArcAtStart { .. } | SearchEnd::ResidualGrew { .. })
        | RoutineEnd::NothingSeen { .. } = end
        {
            self.leave_out(&measuring);
        }
        match measuring.go_to {
            _ if end.is_success() => self.cell.proposing.note_measured(),
            Some(pose) => self.cell.proposing.avoid(pose),
            None => {}
        }
        self.go_on_after(end);
    }

    fn note_peak(&mut self, measuring: &Measuring, peak_mm: f64, std_mm: f64) {
        let (Some(first_profile), Some(first)) = (measuring.profiles.first(), measuring.first_pose) else { return };
        let at_peak = self.cell.view.settings.search.pose_at(first.rigid(), peak_mm);
        let base_from_flange = Transform::from_rigid(at_peak);
        self.cell.proposing.note_peak(FoundPeak { first_profile: Arc::clone(first_profile), base_from_flange, std_mm });
    }

    /// Captures that do not show the target, or one that moved, take no part until somebody has looked.
    fn leave_out(&mut self, measuring: &Measuring) {
        let Some(document) = self.document.as_ref().filter(|document| measuring.document_id == Some(document.id))
        else {
            return;
        };
        let Some(station_idx) = measuring.station_idx(&document.session) else { return };
        let edit = Edit::SetCells(vec![(Place { station_idx, capture_idx: 0 }, CellValue::Used(false))]);
        let label = capture_label(&words::station(&measuring.label));
        self.edit_as(&edit, Some(measuring.gesture), label);
    }
}

impl CellView {
    /// What a session does not say yet of the devices, as edits.
    fn what_is_connected(&self, session: &Session) -> Vec<Edit> {
        let is_open = |model: &str| model.trim().is_empty();
        let robot = self.robot.setup.as_ref().filter(|_| is_open(&session.robot.model));
        let robot = robot.and_then(|setup| words::make_of_robot(setup.kind));
        let sensor = self.sensor.setup.as_ref().filter(|_| is_open(&session.sensor.model));
        let sensor = sensor.and_then(|setup| words::model_of_sensor(setup.kind));
        let robot = robot.map(|make| SetupField::RobotModel(make.to_owned()));
        let sensor = sensor.map(|model| SetupField::SensorModel(model.to_owned()));
        let mut edits: Vec<Edit> = robot.into_iter().chain(sensor).map(Edit::Setup).collect();
        // The methods for a plate begin with it.
        let is_wanted = session.target == Target::RightAnglePlate && session.sensor.rough_flange_from_sensor.is_none();
        let mounting = self.settings.mounting.filter(|_| is_wanted);
        edits.extend(mounting.map(|mounting| Edit::SetRoughMounting(Some(Transform::from_rigid(rigid(&mounting))))));
        edits
    }
}

/// A number; on a plate counted by edge, with its letter before it.
fn next_label(session: &Session, edge: Option<Edge>) -> String {
    let taken: HashSet<String> = session.stations.iter().map(|station| station.label.clone()).collect();
    let number = session.stations.iter().filter(|station| station.edge == edge).count() + 1;
    let letter = edge.map_or("", Edge::symbol);
    free_label(&format!("{letter}{number}"), &taken)
}

/// The make that the name of a robot tells, among those that can be connected.
fn make_of(model: &str) -> Option<&'static str> {
    let model = model.to_lowercase();
    let is_ur =
        model.strip_prefix("ur").is_some_and(|rest| rest.trim_start().starts_with(|c: char| c.is_ascii_digit()));
    let kind = match () {
        () if model.contains("fanuc") => RobotKind::FanucMappdk,
        () if model.contains("universal robots") || is_ur => RobotKind::UniversalRobots,
        () => return None,
    };
    words::make_of_robot(kind)
}

/// Whether nobody knows that the robot stands.
fn may_still_move(end: &RoutineEnd) -> bool {
    matches!(
        end,
        RoutineEnd::Failed { robot_stopped, .. } | RoutineEnd::Stopped { robot_stopped } if *robot_stopped != Some(true)
    )
}

/// The pose that the robot would not go to. A refusal of something else than the target may have come when it was on the
/// way, or there: whether it still stands where it stood is to be seen.
fn refused_pose(measuring: &Measuring, end: &RoutineEnd) -> Option<RefusedPose> {
    let RoutineEnd::Failed { error, robot_stopped: Some(true) } = end else { return None };
    let stood_at = match error {
        DeviceError::OutOfReach { .. } => None,
        DeviceError::Refused { .. } => Some(measuring.stood_at?),
        _ => return None,
    };
    let pose = measuring.go_to.filter(|_| measuring.profiles.is_empty())?;
    Some(RefusedPose { pose, stood_at, reason: error.to_string(), at: Instant::now() })
}

/// The link's own reason, where it has one.
fn need_ready(state: LinkState, otherwise: &str) -> Result<(), String> {
    match state {
        LinkState::Ready => Ok(()),
        LinkState::Failed { error, .. } => Err(error.to_string()),
        LinkState::Off | LinkState::Connecting => Err(otherwise.to_owned()),
    }
}
