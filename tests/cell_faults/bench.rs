//! A workbench at a simulated cell whose truth can be looked at, and what has to be true of it after any fault.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, sync_channel};
use std::time::{Duration, Instant};

use handeye::app::cell::{Activity, CellCommand, CellSettings, CellView, RoughMounting};
use handeye::app::{Command, Workbench};
use handeye::device::sim::{Head, SimCell, SimOptions};
use handeye::device::{Deadlines, LinkState, RoutineEnd, SearchEnd, SearchReport};
use handeye::geometry::{Rigid, Vec3};
use handeye::session::{Session, Target};

/// All deadlines of one routine together, on a machine that does other things as well. A routine that takes longer hangs.
pub const PATIENCE: Duration = Duration::from_mins(1);
/// A way so long that many polls, and a lost device, fit into it, mm.
const LONG_WAY_MM: f64 = 100.0;

/// With the head that sees the ball from furthest away another view of it is a long way off. It sees large balls.
pub fn far_view(options: SimOptions) -> SimOptions {
    SimOptions { head: Head::by_id("lj-v7300").expect("there is one"), radius_mm: 30.0, ..options }
}

pub struct Cell {
    pub workbench: Workbench,
    woken: Receiver<()>,
    pub sim: SimCell,
    /// The last report of each station's search, by the number of stations at that time.
    searches: BTreeMap<usize, Arc<SearchReport>>,
    /// Whether the robot was seen on the way to a station.
    pub has_set_out: bool,
}

impl Cell {
    /// Connected, in a fresh session, with the mounting known: where the robot is sent it sees the ball.
    pub fn start(options: &SimOptions, deadlines: Deadlines) -> Self {
        let sim = SimCell::start(options).expect("ports are free");
        let (workbench, woken) = workbench(deadlines);
        let mut cell = Self { workbench, woken, sim, searches: BTreeMap::new(), has_set_out: false };
        let truth = cell.sim.truth;
        let mut session = Session::new(Target::ball(truth.radius_mm));
        session.sensor.profile_std_mm = Some(truth.profile_std_mm);
        cell.workbench.open_session(session, None);
        cell.tell(CellCommand::ConnectRobot(cell.sim.robot_setup.clone()));
        cell.tell(CellCommand::ConnectSensor(cell.sim.sensor_setup.clone()));
        cell.change_settings(|settings| settings.settle.settle_ms = 10);
        cell.set_mounting(&truth.flange_from_sensor);
        cell
    }

    pub fn tell(&mut self, command: CellCommand) {
        self.workbench.apply(Command::Cell(Box::new(command)));
    }

    pub fn change_settings(&mut self, change: impl FnOnce(&mut CellSettings)) {
        let mut settings = self.view().settings;
        change(&mut settings);
        self.tell(CellCommand::SetSettings(Box::new(settings)));
    }

    pub fn set_mounting(&mut self, flange_from_sensor: &Rigid) {
        let q = flange_from_sensor.rotation;
        let mounting = RoughMounting {
            translation_mm: flange_from_sensor.translation.vector.into(),
            quaternion_wxyz: [q.w, q.i, q.j, q.k],
        };
        self.change_settings(|settings| settings.mounting = Some(mounting));
    }

    pub fn view(&self) -> &CellView {
        self.workbench.cell()
    }

    fn session(&self) -> &Session {
        &self.workbench.document().expect("open").session
    }

    pub fn poll(&mut self) {
        self.woken.recv_timeout(Duration::from_millis(2)).ok();
        self.workbench.poll();
        // During a search there is a report of it.
        self.has_set_out |= self.view().activity == Activity::Moving && self.view().search.is_none();
        if let Some(report) = self.view().search.clone().filter(|report| !report.points.is_empty()) {
            self.searches.insert(self.session().stations.len(), report);
        }
    }

    /// Polls until it is so; `false` if it does not become so in time.
    pub fn becomes(&mut self, is_so: impl Fn(&Self) -> bool) -> bool {
        let deadline = Instant::now() + PATIENCE;
        while !is_so(self) {
            if Instant::now() >= deadline {
                return false;
            }
            self.poll();
        }
        true
    }

    /// Whether nothing is under way any more.
    pub fn is_over(&self) -> bool {
        !self.view().is_busy() && !self.workbench.is_busy()
    }

    /// Waits for the end of the routine or the run.
    #[track_caller]
    pub fn end(&mut self, what: &str) -> RoutineEnd {
        assert!(self.becomes(Self::is_over), "{what}: hangs; {:?}", self.view());
        self.view().last_end.clone().expect("a routine has ended")
    }

    #[track_caller]
    pub fn arm(&mut self) {
        let is_ready = |cell: &Self| {
            let view = cell.view();
            view.robot.state == LinkState::Ready && view.robot.latest.is_some() && view.live.is_some()
        };
        assert!(self.becomes(is_ready), "connects: {:?}", self.view());
        self.tell(CellCommand::Arm(true));
        assert!(self.view().is_armed);
    }

    /// Sets out on a long way to a station; answers where to, mm. Comes back while the robot is on the move.
    #[track_caller]
    pub fn set_out(&mut self, what: &str) -> Vec3 {
        const NUM_PROPOSALS: usize = 12;
        self.tell(CellCommand::ProposeStation);
        for _ in 0..NUM_PROPOSALS {
            let is_answered = |cell: &Self| cell.view().proposal.is_some() || !cell.workbench.notices().is_empty();
            assert!(self.becomes(is_answered), "{what}: no proposal");
            assert!(self.view().proposal.is_some(), "{what}: {:?}", self.workbench.notices());
            let proposal = self.view().proposal.clone().expect("proposed");
            if proposal.refusal.is_none() && proposal.distance_mm >= LONG_WAY_MM {
                let from_mm = self.position_mm();
                self.tell(CellCommand::AcceptProposal);
                let is_under_way = |cell: &Self| (cell.position_mm() - from_mm).norm() > 3.0 || cell.is_over();
                assert!(self.becomes(is_under_way) && !self.is_over(), "{what}: {:?}", self.workbench.notices());
                return proposal.station.base_from_flange.translation_mm();
            }
            self.tell(CellCommand::SkipProposal);
        }
        panic!("{what}: none of the proposed poses is far enough");
    }

    /// Where the flange truly is, mm.
    pub fn position_mm(&self) -> Vec3 {
        self.sim.base_from_flange().translation.vector
    }

    /// How far the robot goes within a while, mm.
    pub fn moves_within_mm(&mut self, wait: Duration) -> f64 {
        let from_mm = self.position_mm();
        let end = Instant::now() + wait;
        while Instant::now() < end {
            self.poll();
        }
        (self.position_mm() - from_mm).norm()
    }

    /// Everything that any search saw is in the document, capture by capture.
    #[track_caller]
    pub fn check_nothing_is_lost(&self, what: &str) {
        let session = self.session();
        assert!(self.searches.len() <= session.stations.len(), "{what}: a station is lost");
        let search = self.view().settings.search;
        for (num_stations, report) in &self.searches {
            let station = num_stations.checked_sub(1).and_then(|idx| session.stations.get(idx));
            let captures = &station.unwrap_or_else(|| panic!("{what}: station {num_stations} is lost")).captures;
            let (num_captures, num_points) = (captures.len(), report.points.len());
            assert!(num_captures >= num_points, "{what}: {num_captures} captures of {num_points}");
            let first = captures[0].base_from_flange;
            for (capture, point) in captures.iter().zip(&report.points) {
                let travelled_mm = search.travelled_mm(first.rigid(), capture.base_from_flange.rigid());
                let expected_mm = point.travelled_mm - report.points[0].travelled_mm;
                // The same numbers, but for the rounding.
                assert!((travelled_mm - expected_mm).abs() < 1e-3, "{what}: {travelled_mm} mm, not {expected_mm} mm");
            }
        }
    }

    /// Where a search says that it found the largest arc, the ball's middle lies in the laser's plane. Answers how many
    /// searches say so.
    #[track_caller]
    pub fn check_what_was_found(&self, what: &str) -> usize {
        /// Some ten times the wanted σ of a peak together with the noise of a pose. A ball that is pushed goes ten times as
        /// far again.
        const OFF_MM: f64 = 0.3;
        let (truth, search) = (&self.sim.truth, self.view().settings.search);
        let mut num_found = 0;
        for (num_stations, report) in &self.searches {
            let Some(SearchEnd::Found { peak_mm, .. }) = report.end else { continue };
            num_found += 1;
            let first = self.session().stations[num_stations - 1].captures[0].base_from_flange;
            let at_peak = search.pose_at(first.rigid(), peak_mm - report.points[0].travelled_mm);
            let sensor_from_base: Rigid = (at_peak * truth.flange_from_sensor).inverse();
            let off_mm = [truth.ball_in_base, truth.ball_in_base + truth.push_mm]
                .map(|ball| (sensor_from_base * nalgebra::Point3::from(ball)).y.abs());
            assert!(off_mm[0].min(off_mm[1]) < OFF_MM, "{what}: found at {peak_mm} mm, but off by {off_mm:?} mm");
        }
        num_found
    }

    /// A robot of which an end says that it stands does.
    #[track_caller]
    pub fn check_word_about_robot(&mut self, what: &str, end: &RoutineEnd) {
        let is_said_to_stand = match end {
            RoutineEnd::Failed { robot_stopped, .. } | RoutineEnd::Stopped { robot_stopped } => {
                *robot_stopped == Some(true)
            }
            RoutineEnd::NotAllowed(_) => false,
            _ => true,
        };
        if is_said_to_stand {
            let moved_mm = self.moves_within_mm(Duration::from_millis(50));
            assert!(moved_mm < 1e-6, "{what}: {end:?}, and moves by {moved_mm} mm");
        }
    }

    /// Once the faults are over the robot is connected again, and stands.
    #[track_caller]
    pub fn check_recovers(&mut self, what: &str) {
        self.sim.clear_faults();
        let since = Instant::now();
        let reports_anew = |cell: &Self| {
            let robot = &cell.view().robot;
            robot.state == LinkState::Ready && robot.latest.as_ref().is_some_and(|latest| latest.received_at > since)
        };
        assert!(self.becomes(reports_anew), "{what}: connects again; {:?}", self.view().robot);
        let moved_mm = self.moves_within_mm(Duration::from_millis(50));
        assert!(moved_mm < 1e-6, "{what}: moves by {moved_mm} mm after all");
    }

    /// The program ends in the middle of whatever it does, and another one begins.
    pub fn begin_anew(&mut self, deadlines: Deadlines) {
        let (next, woken) = workbench(deadlines);
        drop(std::mem::replace(&mut self.workbench, next));
        self.woken = woken;
    }
}

fn workbench(deadlines: Deadlines) -> (Workbench, Receiver<()>) {
    let (sender, woken) = sync_channel(64);
    let wake = move || {
        sender.try_send(()).ok();
    };
    let mut workbench = Workbench::new(Arc::new(wake));
    workbench.set_cell_deadlines(deadlines);
    (workbench, woken)
}

/// Runs them side by side; the outcomes come in the order of the threads.
pub fn in_parallel<T: Send>(num: usize, run: impl Fn(usize) -> T + Sync) -> Vec<T> {
    /// They mostly wait.
    const NUM_THREADS: usize = 32;
    let next = AtomicUsize::new(0);
    std::thread::scope(|scope| {
        let work = || {
            let mut outcomes = Vec::new();
            loop {
                let idx = next.fetch_add(1, Ordering::Relaxed);
                if idx >= num {
                    return outcomes;
                }
                outcomes.push(run(idx));
            }
        };
        let threads: Vec<_> = (0..NUM_THREADS.min(num)).map(|_| scope.spawn(work)).collect();
        threads.into_iter().flat_map(|thread| thread.join().expect("each case ends as it should")).collect()
    })
}
