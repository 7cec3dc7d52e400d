//! A workbench at a simulated cell, polled until something is so.

use std::path::Path;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
use std::time::{Duration, Instant};

use handeye::app::cell::{CellCommand, CellSettings, RoughMounting};
use handeye::app::{Command, NoticeKind, RecoverySettings, Workbench};
use handeye::calibrate::{Method, Solution};
use handeye::device::sim::{SimCell, SimOptions};
use handeye::device::{LinkState, RoutineEnd};
use handeye::geometry::Vec3;
use handeye::session::{Session, Target};

/// Long past anything that is waited for here, on a slow machine as well.
pub const PATIENCE: Duration = Duration::from_mins(2);
/// Fast enough for whole runs.
pub const FAST: f64 = 50.0;
/// Slow enough for something to happen during a move.
pub const SLOW: f64 = 2.0;
/// How far the result may be from the truth, in its stated σ. If all the uncertainty lies along one direction, a fair result
/// is further off once in 16 000 runs.
pub const FAIR_STDS: f64 = 4.0;

/// A workbench with the wake-ups that it gave.
pub struct Bench {
    pub workbench: Workbench,
    woken: Receiver<()>,
}

impl Bench {
    pub fn new() -> Self {
        let (sender, woken) = sync_channel(64);
        let wake = move || {
            sender.try_send(()).ok();
        };
        Self { workbench: Workbench::new(Arc::new(wake)), woken }
    }

    /// A bench with a simulated cell, connected.
    pub fn practising(seed: u64, time_scale: f64) -> Self {
        Self::new().practise(seed, time_scale)
    }

    pub fn practise(self, seed: u64, time_scale: f64) -> Self {
        self.practise_with(&SimOptions { seed, time_scale, ..SimOptions::default() })
    }

    pub fn practise_with(mut self, options: &SimOptions) -> Self {
        self.workbench.practise_with(options);
        self.wait("the links", |workbench| {
            let cell = workbench.cell();
            cell.robot.state == LinkState::Ready && cell.robot.latest.is_some() && cell.live.is_some()
        });
        self.change_settings(|settings| settings.settle.settle_ms = 5);
        self
    }

    /// A session of its own, with a cell that is not for practice.
    pub fn connected_to(sim: &SimCell) -> Self {
        let mut bench = Self::new();
        bench.workbench.apply(Command::NewSession(Target::ball(sim.truth.radius_mm)));
        bench.cell(CellCommand::ConnectRobot(sim.robot_setup.clone()));
        bench.cell(CellCommand::ConnectSensor(sim.sensor_setup.clone()));
        bench.wait("the links", |workbench| {
            let cell = workbench.cell();
            cell.robot.state == LinkState::Ready && cell.robot.latest.is_some() && cell.live.is_some()
        });
        let mounted = sim.truth.rough_flange_from_sensor;
        let q = mounted.rotation;
        bench.change_settings(|settings| {
            settings.settle.settle_ms = 5;
            let translation_mm = mounted.translation.vector.into();
            settings.mounting = Some(RoughMounting { translation_mm, quaternion_wxyz: [q.w, q.i, q.j, q.k] });
        });
        bench
    }

    pub fn armed(mut self) -> Self {
        self.cell(CellCommand::Arm(true));
        assert!(self.workbench.cell().is_armed, "{:?}", self.workbench.notices());
        self
    }

    pub fn change_settings(&mut self, change: impl FnOnce(&mut CellSettings)) {
        let mut settings = self.workbench.cell().settings;
        change(&mut settings);
        self.cell(CellCommand::SetSettings(Box::new(settings)));
    }

    pub fn cell(&mut self, command: CellCommand) {
        self.workbench.apply(Command::Cell(Box::new(command)));
    }

    /// Polls until it is so.
    #[track_caller]
    pub fn wait(&mut self, what: &str, is_so: impl Fn(&Workbench) -> bool) {
        let deadline = Instant::now() + PATIENCE;
        while !is_so(&self.workbench) {
            assert!(Instant::now() < deadline, "waited in vain for {what}: {:?}", self.workbench.notices());
            match self.woken.recv_timeout(Duration::from_millis(20)) {
                Ok(()) | Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => panic!("the workbench is gone"),
            }
            self.workbench.poll();
        }
    }

    pub fn wait_for_rest(&mut self) {
        self.wait("rest", |workbench| !workbench.cell().is_busy() && !workbench.is_busy());
    }

    pub fn session(&self) -> &Session {
        &self.workbench.document().expect("open").session
    }

    pub fn num_undo_steps(&self) -> usize {
        self.workbench.document().expect("open").history.undo_labels().len()
    }

    pub fn solution(&self) -> &Solution {
        let results = self.workbench.results().expect("solved");
        results.method(Method::BallBundle).expect("run").outcome.as_ref().expect("solved")
    }

    pub fn num_errors(&self) -> usize {
        self.workbench.notices().iter().filter(|notice| notice.kind == NoticeKind::Error).count()
    }

    pub fn last_end(&self) -> &RoutineEnd {
        self.workbench.cell().last_end.as_ref().expect("a routine has ended")
    }

    pub fn last_notice(&self) -> &str {
        &self.workbench.notices().last().expect("a notice").message
    }

    /// The robot stands: what it reports from now on differs by no more than its noise.
    pub fn check_robot_stands(&mut self) {
        let mut positions = Vec::new();
        for _ in 0..3 {
            let since = Instant::now();
            let latest = |workbench: &Workbench| workbench.cell().robot.latest.clone();
            self.wait("another report", |workbench| latest(workbench).is_some_and(|latest| latest.received_at > since));
            positions.push(latest(&self.workbench).expect("reports").base_from_flange.translation_mm());
        }
        let moved_mm = (positions[2] - positions[0]).norm();
        // The stated noise is about 0.02 mm; a robot under way makes 50 mm/s and more.
        assert!(moved_mm < 0.5, "{moved_mm} mm");
    }
}

/// Where the robot says that it is, mm.
pub fn position_mm(workbench: &Workbench) -> Vec3 {
    workbench.cell().robot.latest.as_ref().expect("reports").base_from_flange.translation_mm()
}

/// A bench that keeps a recovery file.
pub fn recoverable_in(folder: &Path) -> Bench {
    let mut bench = Bench::new();
    bench.workbench.keep_copies(RecoverySettings { folder: folder.to_owned(), interval: Duration::ZERO });
    bench
}
