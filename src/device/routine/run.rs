//! The thread of a routine.

use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::Sender;
use std::time::Duration;

use crate::device::driver::{LinearMove, RobotReport};
use crate::device::error::DeviceError;
use crate::device::robot::arrival::check_arrival;
use crate::device::safety::MotionRefusal;
use crate::device::search::tip::height_mm;
use crate::device::search::{Search, SearchNext, SearchSettings, StepSeen, TipNext, TipSearch};
use crate::device::worker::{RobotClient, SensorClient};
use crate::fit::{ArcOptions, EdgeOptions, Sought, extract_arc, extract_edge};
use crate::geometry::{Base, Flange, Transform};
use crate::watch::Wake;

use super::control::{Control, StopWanted};
use super::{Measurement, RoutineEnd, RoutineEvent, Task};

/// A move may take so many times as long as by its speed: the override on the pendant may be a tenth. A robot that does not
/// answer is noticed long before.
const SLOWEST_OVERRIDE: u32 = 10;

pub(super) struct Runner {
    pub task: Task,
    pub robot: RobotClient,
    pub sensor: SensorClient,
    pub control: Control,
    /// Whether the robot was sent anywhere.
    pub has_moved: Cell<bool>,
    pub events: Sender<RoutineEvent>,
    pub wake: Wake,
}

/// Why a routine does not go on.
#[derive(Debug)]
pub(super) enum Break {
    Stop,
    NotAllowed(MotionRefusal),
    NeverStill { moved_mm: Option<f64> },
    StaleProfiles { trigger_count: u32 },
    Device(DeviceError),
}

impl From<StopWanted> for Break {
    fn from(_: StopWanted) -> Self {
        Self::Stop
    }
}

impl From<MotionRefusal> for Break {
    fn from(refusal: MotionRefusal) -> Self {
        Self::NotAllowed(refusal)
    }
}

impl From<DeviceError> for Break {
    fn from(error: DeviceError) -> Self {
        if matches!(error, DeviceError::Stopped { .. }) { Self::Stop } else { Self::Device(error) }
    }
}

/// A bug of ours.
pub(super) fn broken_down(robot_stopped: Option<bool>) -> RoutineEnd {
    let error = DeviceError::System {
        device: "Cell",
        what: "the routine".to_owned(),
        reason: "it broke down; this is a bug in Handeye".to_owned(),
    };
    RoutineEnd::Failed { error, robot_stopped }
}

impl Runner {
    pub fn run(self) {
        let outcome = catch_unwind(AssertUnwindSafe(|| self.do_task()));
        let end = match outcome {
            Ok(Ok(end)) => end,
            Ok(Err(Break::NotAllowed(refusal))) => RoutineEnd::NotAllowed(refusal),
            // The robot stands in these two, but where a thing is not as it should be it is better told.
            Ok(Err(Break::NeverStill { moved_mm })) => {
                self.stop_robot();
                RoutineEnd::NeverStill { moved_mm }
            }
            Ok(Err(Break::StaleProfiles { trigger_count })) => {
                self.stop_robot();
                RoutineEnd::StaleProfiles { trigger_count }
            }
            Ok(Err(Break::Device(error))) => RoutineEnd::Failed { error, robot_stopped: self.stop_robot() },
            Ok(Err(Break::Stop)) => RoutineEnd::Stopped { robot_stopped: self.stop_robot() },
            Err(_) => broken_down(self.stop_robot()),
        };
        self.tell(RoutineEvent::Ended(end));
    }

    fn do_task(&self) -> Result<RoutineEnd, Break> {
        if let Some(target) = &self.task.go_to {
            self.go_to(target)?;
        }
        match &self.task.measurement {
            None => Ok(RoutineEnd::Done),
            Some(Measurement::Profile(sought)) => self.keep_profile(sought.as_ref()),
            Some(Measurement::Tip(settings, options)) => self.find_tip(settings, options),
            Some(Measurement::LargestArc(settings, ball)) => self.search(settings, ball),
        }
    }

    fn go_to(&self, target: &Transform<Base, Flange>) -> Result<(), Break> {
        let speed_mm_s = self.task.arming.map_or(0.0, |arming| arming.limits.transit_speed_mm_s);
        self.move_to(target, speed_mm_s)?;
        let arrived = self.robot.report()?;
        Ok(check_arrival("Robot", target, &arrived.base_from_flange)?)
    }

    fn search(&self, settings: &SearchSettings, ball: &ArcOptions) -> Result<RoutineEnd, Break> {
        let first = self.check_search(settings)?;
        let mut search = Search::new(settings, ball.ball_radius_mm);
        let mut previous_mm = None;
        loop {
            let commanded_mm = match search.next() {
                SearchNext::Over(end) => {
                    if previous_mm.is_none() {
                        self.tell(RoutineEvent::Searched(Box::new(search.report().clone())));
                    }
                    return Ok(RoutineEnd::Searched(end));
                }
                SearchNext::CaptureAt { commanded_mm } => commanded_mm,
            };
            let step_mm = previous_mm.map(|previous_mm| commanded_mm - previous_mm);
            // Where a capture is taken again the robot stays.
            if step_mm.is_some_and(|step_mm| step_mm != 0.0) {
                let target = Transform::from_rigid(settings.pose_at(first.rigid(), commanded_mm));
                let speed_mm_s = self.task.arming.map_or(0.0, |arming| arming.limits.search_speed_mm_s);
                self.move_to(&target, speed_mm_s)?;
            }
            previous_mm = Some(commanded_mm);
            self.tell(RoutineEvent::Settling);
            let capture = self.capture(step_mm)?;
            let radius_and_std_mm = extract_arc(&capture.profile, ball)
                .map(|arc| [arc.circle.radius_mm, arc.std_mm()[2]])
                .map_err(|refusal| refusal.to_string());
            let travelled_mm = settings.travelled_mm(first.rigid(), capture.base_from_flange.rigid());
            self.tell(RoutineEvent::Captured(capture));
            search.take(StepSeen { travelled_mm, radius_and_std_mm });
            self.tell(RoutineEvent::Searched(Box::new(search.report().clone())));
        }
    }

    fn keep_profile(&self, sought: Option<&Sought>) -> Result<RoutineEnd, Break> {
        self.tell(RoutineEvent::Settling);
        let capture = self.capture(None)?;
        let refusal = sought.and_then(|sought| sought.find(&capture.profile).err());
        self.tell(RoutineEvent::Captured(capture));
        Ok(refusal.map_or(RoutineEnd::Done, |refusal| RoutineEnd::NothingSeen { reason: refusal.to_string() }))
    }

    fn find_tip(&self, settings: &SearchSettings, options: &EdgeOptions) -> Result<RoutineEnd, Break> {
        let first = self.check_search(settings)?;
        let mut search = TipSearch::new(settings);
        let speed_mm_s = self.task.arming.map_or(0.0, |arming| arming.limits.search_speed_mm_s);
        let target = |commanded_mm| Transform::from_rigid(settings.pose_at(first.rigid(), commanded_mm));
        loop {
            match search.next() {
                TipNext::Over(end) => return Ok(RoutineEnd::NothingSeen { reason: end.to_string() }),
                TipNext::KeepAt(commanded_mm) => {
                    self.move_to(&target(commanded_mm), speed_mm_s)?;
                    return self.keep_profile(Some(&Sought::Edge(*options)));
                }
                TipNext::LookAt(commanded_mm) => {
                    // The first look is where the robot stands.
                    if commanded_mm != 0.0 {
                        self.move_to(&target(commanded_mm), speed_mm_s)?;
                    }
                    self.tell(RoutineEvent::Settling);
                    let seen = self.capture(None)?;
                    let found = extract_edge(&seen.profile, options).ok();
                    search.take(commanded_mm, height_mm(&seen.profile, found.as_ref()));
                }
            }
        }
    }

    /// Everything that the search may ask for is allowed before anything is captured; answers where it begins.
    fn check_search(&self, settings: &SearchSettings) -> Result<Transform<Base, Flange>, Break> {
        let report = self.robot.report()?;
        let arming = self.task.arming.ok_or(MotionRefusal::NotArmed)?;
        arming.check_search(&report.readiness, &report.base_from_flange, settings)?;
        Ok(report.base_from_flange)
    }

    /// Checks a move against the robot as it is now, sends it, and waits for its end.
    fn move_to(&self, target: &Transform<Base, Flange>, speed_mm_s: f64) -> Result<(), Break> {
        self.control.wait_while_paused()?;
        let RobotReport { base_from_flange, readiness, .. } = self.robot.report()?;
        // Somebody may have wanted a stop while the robot was asked.
        self.control.wait(Duration::ZERO)?;
        let arming = self.task.arming.ok_or(MotionRefusal::NotArmed)?;
        let motion = arming.check(&readiness, &base_from_flange, target, speed_mm_s)?;
        self.tell(RoutineEvent::Moving { base_from_flange: *target });
        let patience = SLOWEST_OVERRIDE * duration_of(&motion, &base_from_flange) + self.robot.deadlines().beyond_move;
        self.has_moved.set(true);
        // There is no sense in a long way to where nothing can be measured.
        Ok(self.robot.move_while(motion, patience, || self.sensor.check_connection())?)
    }

    /// A robot that was sent nowhere from here may be at somebody else's program, which is not ours to end.
    fn stop_robot(&self) -> Option<bool> {
        if self.has_moved.get() { self.robot.stop_and_wait() } else { Some(true) }
    }

    pub(super) fn tell(&self, event: RoutineEvent) {
        // Nobody listens to a routine that was given up; it ends by itself.
        self.events.send(event).ok();
        (self.wake)();
    }
}

/// How long a move takes by its speeds, at most an hour.
fn duration_of(motion: &LinearMove, from: &Transform<Base, Flange>) -> Duration {
    const LONGEST_S: f64 = 3600.0;
    let to = &motion.base_from_flange;
    let shift_s = (to.translation_mm() - from.translation_mm()).norm() / motion.speed_mm_s;
    let turn_s = from.rotation().angle_to(&to.rotation()).to_degrees() / motion.rotation_speed_deg_s;
    Duration::from_secs_f64(shift_s.max(turn_s).clamp(0.0, LONGEST_S))
}
