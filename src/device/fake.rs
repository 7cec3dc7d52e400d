//! A robot and a profiler in memory, for tests: they share a ball, count what they are told, and fail on request.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use crate::geometry::{Base, Flange, Rigid, Transform, Vec3, so3};
use crate::scene::{Dirt, Random, Scene};
use crate::watch::Wake;

use super::driver::{LinearMove, MoveState, ProfileReading, Readiness, RobotDriver, RobotReport, SensorDriver};
use super::error::DeviceError;
use super::worker::{Deadlines, RobotWorker, SensorWorker};

pub(super) const RADIUS_MM: f64 = 15.0;
const STANDOFF_MM: f64 = 60.0;

/// What is wrong with the cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Fault {
    #[default]
    None,
    /// The robot's connection is closed.
    RobotClosed,
    /// The robot does not answer.
    RobotSilent,
    /// The robot refuses motion.
    MoveRefused,
    /// A move never ends.
    MoveHangs,
    /// The robot says that it has arrived but has not gone.
    RobotStuck,
    /// The robot drifts while it should stand.
    RobotDrifts,
    /// The robot's driver panics.
    RobotPanics,
    /// The profiler's connection is closed.
    SensorClosed,
    /// The profiler does not answer.
    SensorSilent,
    /// The profiler gives the same profile again and again.
    SensorStale,
    /// Both answer, and refuse to show anything.
    LooksRefused,
    /// Nobody answers at either address.
    NoConnection,
}

pub(super) struct World {
    pub pose: Transform<Base, Flange>,
    pub target: Option<Transform<Base, Flange>>,
    /// Questions for the state of a move before it has ended.
    pub polls_a_move: u32,
    polls_left: u32,
    pub trigger_count: u32,
    pub readiness: Readiness,
    pub fault: Fault,
    /// Moves before the fault sets in.
    pub num_moves_before_fault: u32,
    pub num_moves: u32,
    pub num_stops: u32,
    pub num_connections: u32,
    pub takes_stop: bool,
    /// The robot's driver only reads.
    pub is_read_only: bool,
    /// The robot says that it moves, wherever it stands.
    pub says_it_moves: bool,
    /// Happens once, while the robot is asked for its pose.
    pub during_report: Option<Box<dyn FnOnce() + Send>>,
    scene: Scene,
    noise: Random,
}

impl World {
    fn fault(&self) -> Fault {
        if self.num_moves >= self.num_moves_before_fault { self.fault } else { Fault::None }
    }
}

/// Shared by the two drivers and the test.
#[derive(Clone)]
pub(super) struct FakeCell(Arc<Mutex<World>>);

/// Looks straight down; the sensor sits on the flange as it is.
fn pose_above(y_mm: f64) -> Transform<Base, Flange> {
    Transform::from_parts(Vec3::new(400.0, y_mm, 200.0), so3::exp(Vec3::x() * std::f64::consts::PI))
}

impl FakeCell {
    /// The first section is so far from the ball's centre.
    pub fn new(off_centre_mm: f64) -> Self {
        let scene = Scene {
            ball_in_world: Vec3::new(400.0, 0.0, 200.0 - STANDOFF_MM),
            radius_mm: RADIUS_MM,
            num_points: 300,
            range_sign: 1.0,
            profile_std_mm: 0.005,
            dirt: Dirt::default(),
            decimals: None,
        };
        Self(Arc::new(Mutex::new(World {
            pose: pose_above(off_centre_mm),
            target: None,
            polls_a_move: 1,
            polls_left: 0,
            trigger_count: u32::MAX - 3,
            readiness: Readiness::Ready,
            fault: Fault::None,
            num_moves_before_fault: 0,
            num_moves: 0,
            num_stops: 0,
            num_connections: 0,
            takes_stop: true,
            is_read_only: false,
            says_it_moves: false,
            during_report: None,
            scene,
            noise: Random::new(7, 1),
        })))
    }

    pub fn world(&self) -> MutexGuard<'_, World> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Its two workers.
    pub fn start(&self, deadlines: Deadlines) -> (RobotWorker, SensorWorker) {
        let (robot, sensor) = (self.clone(), self.clone());
        let quiet: Wake = Arc::new(|| {});
        (
            RobotWorker::start(
                Box::new(move |_| robot.connect().map(|()| robot.boxed_robot())),
                deadlines,
                quiet.clone(),
            ),
            SensorWorker::start(Box::new(move |_| sensor.connect().map(|()| sensor.boxed_sensor())), deadlines, quiet),
        )
    }

    fn boxed_robot(&self) -> Box<dyn RobotDriver> {
        Box::new(FakeRobot(self.clone()))
    }

    fn boxed_sensor(&self) -> Box<dyn SensorDriver> {
        Box::new(FakeSensor(self.clone()))
    }

    fn connect(&self) -> Result<(), DeviceError> {
        let mut world = self.world();
        world.num_connections += 1;
        if world.fault == Fault::NoConnection {
            return Err(DeviceError::NotConnected {
                device: "Fake",
                address: "nowhere".to_owned(),
                reason: "refused".to_owned(),
                remedy: "end the test",
            });
        }
        Ok(())
    }
}

/// Deadlines for tests that mean to wait for them.
pub(super) fn short_deadlines() -> Deadlines {
    Deadlines {
        connect: Duration::from_millis(200),
        request: Duration::from_millis(100),
        stop: Duration::from_millis(100),
        profile: Duration::from_millis(200),
        beyond_move: Duration::from_millis(200),
    }
}

fn closed(device: &'static str) -> DeviceError {
    DeviceError::Closed { device, request: "a test".to_owned() }
}

fn refused(device: &'static str) -> DeviceError {
    DeviceError::Refused {
        device,
        request: "a test".to_owned(),
        found: "as the test wants it".to_owned(),
        remedy: "end the test".to_owned(),
    }
}

fn silent(device: &'static str, deadline: Instant) -> DeviceError {
    std::thread::sleep(deadline.saturating_duration_since(Instant::now()));
    DeviceError::Timeout { device, request: "a test".to_owned(), waited: Duration::from_millis(100) }
}

struct FakeRobot(FakeCell);

impl FakeRobot {
    fn meet_fault(&self, deadline: Instant) -> Result<(), DeviceError> {
        let fault = self.0.world().fault();
        match fault {
            Fault::RobotClosed => Err(closed("Robot")),
            Fault::RobotSilent => Err(silent("Robot", deadline)),
            Fault::RobotPanics => panic!("as the test wants it"),
            _ => Ok(()),
        }
    }
}

impl RobotDriver for FakeRobot {
    fn name(&self) -> &'static str {
        "Robot"
    }

    fn report(&mut self, deadline: Instant) -> Result<RobotReport, DeviceError> {
        self.meet_fault(deadline)?;
        let happens = self.0.world().during_report.take();
        if let Some(happens) = happens {
            happens();
        }
        let mut world = self.0.world();
        if world.fault() == Fault::LooksRefused {
            return Err(refused("Robot"));
        }
        if world.fault() == Fault::RobotDrifts {
            world.pose = Transform::from_rigid(Rigid::translation(0.1, 0.0, 0.0) * world.pose.rigid());
        }
        Ok(RobotReport {
            base_from_flange: world.pose,
            joints_deg: Vec::new(),
            is_moving: Some(world.says_it_moves || world.target.is_some()),
            readiness: world.readiness.clone(),
            tool: String::new(),
            resolution_mm: 0.001,
            received_at: Instant::now(),
        })
    }

    fn start_move(&mut self, motion: &LinearMove, deadline: Instant) -> Result<(), DeviceError> {
        self.0.world().num_moves += 1;
        self.meet_fault(deadline)?;
        let mut world = self.0.world();
        if world.fault() == Fault::MoveRefused {
            return Err(refused("Robot"));
        }
        world.target = Some(motion.base_from_flange);
        world.polls_left = world.polls_a_move;
        Ok(())
    }

    fn move_state(&mut self, deadline: Instant) -> Result<MoveState, DeviceError> {
        self.meet_fault(deadline)?;
        let mut world = self.0.world();
        if world.fault() == Fault::MoveHangs {
            return Ok(MoveState::Moving);
        }
        world.polls_left = world.polls_left.saturating_sub(1);
        if world.polls_left > 0 {
            return Ok(MoveState::Moving);
        }
        if let Some(target) = world.target.take()
            && world.fault() != Fault::RobotStuck
        {
            world.pose = target;
        }
        Ok(MoveState::Done)
    }

    fn stop(&mut self, deadline: Instant) -> Result<(), DeviceError> {
        self.meet_fault(deadline)?;
        let mut world = self.0.world();
        if world.is_read_only {
            return Err(DeviceError::CannotMove { device: "Robot" });
        }
        if !world.takes_stop {
            return Err(refused("Robot"));
        }
        world.num_stops += 1;
        world.target = None;
        Ok(())
    }
}

struct FakeSensor(FakeCell);

impl FakeSensor {
    fn meet_fault(&self, deadline: Instant) -> Result<(), DeviceError> {
        let fault = self.0.world().fault();
        match fault {
            Fault::SensorClosed => Err(closed("Profiler")),
            Fault::SensorSilent => Err(silent("Profiler", deadline)),
            _ => Ok(()),
        }
    }
}

impl SensorDriver for FakeSensor {
    fn name(&self) -> &'static str {
        "Profiler"
    }

    fn newest(&mut self, deadline: Instant) -> Result<Option<ProfileReading>, DeviceError> {
        self.meet_fault(deadline)?;
        let mut world = self.0.world();
        let world = &mut *world;
        if world.fault() == Fault::LooksRefused {
            return Err(refused("Profiler"));
        }
        if world.fault() != Fault::SensorStale {
            world.trigger_count = world.trigger_count.wrapping_add(1);
        }
        let profile = world.scene.profile(world.pose.rigid(), &mut world.noise, &mut Random::new(0, 2));
        Ok(Some(ProfileReading {
            profile: Arc::new(profile),
            trigger_count: world.trigger_count,
            received_at: Instant::now(),
        }))
    }

    fn forget(&mut self, deadline: Instant) -> Result<(), DeviceError> {
        self.meet_fault(deadline)
    }
}
