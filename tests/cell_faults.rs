//! Everything that can go wrong in a cell, at each phase of the search and at random: each ends in its time and in a named
//! end, and nothing that was captured is lost.
//!
//! `HANDEYE_FAULTS=1000 cargo test --test cell_faults -- --nocapture` runs as many random schedules and tells how they ended.
#![expect(clippy::expect_used, reason = "a test that finds nothing to check must fail")]

use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, sync_channel};
use std::time::{Duration, Instant};

use handeye::app::cell::{Activity, CellCommand, CellView};
use handeye::app::{Command, Workbench};
use handeye::device::sim::{Fault, FaultSpec, FaultStart, SimCell, SimDevice, SimOptions};
use handeye::device::{
    Deadlines, DeviceError, LinkState, MotionRefusal, RobotKind, RoutineEnd, SearchEnd, SearchPhase, SensorKind,
};
use handeye::scene::Random;
use handeye::session::{Session, Target};

/// All deadlines of one routine together, on a machine that does other things as well. A routine that takes longer hangs.
const PATIENCE: Duration = Duration::from_mins(1);
const TIME_SCALE: f64 = 20.0;
/// Longer than the simulated cell's late answers take.
const REQUEST: Duration = Duration::from_millis(600);

struct Cell {
    workbench: Workbench,
    woken: Receiver<()>,
    sim: SimCell,
}

impl Cell {
    fn start(options: &SimOptions, direction: f64, request: Duration) -> Self {
        let options = SimOptions { time_scale: TIME_SCALE, ..options.clone() };
        let sim = SimCell::start(&options).expect("ports are free");
        let (mut workbench, woken) = workbench_with_short_deadlines(request);
        let mut session = Session::new(Target::ball(sim.truth.radius_mm));
        session.sensor.profile_std_mm = Some(sim.truth.profile_std_mm);
        workbench.open_session(session, None);
        let mut cell = Self { workbench, woken, sim };
        cell.tell(CellCommand::ConnectRobot(cell.sim.robot_setup.clone()));
        cell.tell(CellCommand::ConnectSensor(cell.sim.sensor_setup.clone()));
        let mut settings = cell.view().settings;
        settings.settle.settle_ms = 10;
        settings.search.direction = [0.0, direction, 0.0];
        cell.tell(CellCommand::SetSettings(Box::new(settings)));
        cell
    }

    fn tell(&mut self, command: CellCommand) {
        self.workbench.apply(Command::Cell(Box::new(command)));
    }

    fn view(&self) -> &CellView {
        self.workbench.cell()
    }

    fn session(&self) -> &Session {
        &self.workbench.document().expect("open").session
    }

    /// Polls until it is so; `false` if it does not become so in time.
    fn becomes(&mut self, patience: Duration, is_so: impl Fn(&Self) -> bool) -> bool {
        let deadline = Instant::now() + patience;
        while !is_so(self) {
            if Instant::now() >= deadline {
                return false;
            }
            self.woken.recv_timeout(Duration::from_millis(2)).ok();
            self.workbench.poll();
        }
        true
    }

    #[track_caller]
    fn arm(&mut self) {
        let is_ready = |cell: &Self| {
            let view = cell.view();
            view.robot.state == LinkState::Ready && view.robot.latest.is_some() && view.live.is_some()
        };
        assert!(self.becomes(PATIENCE, is_ready), "connects: {:?}", self.view());
        self.tell(CellCommand::Arm(true));
        assert!(self.view().is_armed);
    }

    /// What the search saw last is in the document, capture by capture.
    #[track_caller]
    fn check_nothing_is_lost(&self, what: &str) {
        let num_points = self.view().search.as_ref().map_or(0, |report| report.points.len());
        let last = self.session().stations.last();
        let num_captures = last.map_or(0, |station| station.captures.len());
        assert!(num_captures >= num_points, "{what}: {num_captures} captures of {num_points}");
    }

    #[track_caller]
    fn check_robot_stands(&mut self, what: &str) {
        self.sim.clear_faults();
        let reports_anew = |since: Instant| {
            move |cell: &Self| {
                let latest = cell.view().robot.latest.as_ref();
                cell.view().robot.state == LinkState::Ready && latest.is_some_and(|latest| latest.received_at > since)
            }
        };
        let position =
            |cell: &Self| cell.view().robot.latest.as_ref().expect("reports").base_from_flange.translation_mm();
        assert!(self.becomes(PATIENCE, reports_anew(Instant::now())), "{what}: connects again");
        let first = position(self);
        assert!(self.becomes(PATIENCE, reports_anew(Instant::now())), "{what}: reports again");
        let moved_mm = (position(self) - first).norm();
        // Noise is 0.02 mm or so. A robot under way makes 10 mm/s, times the scale of time.
        assert!(moved_mm < 0.5, "{what}: moved by {moved_mm} mm");
    }
}

fn workbench_with_short_deadlines(request: Duration) -> (Workbench, Receiver<()>) {
    let (sender, woken) = sync_channel(64);
    let wake = move || {
        sender.try_send(()).ok();
    };
    let mut workbench = Workbench::new(Arc::new(wake));
    workbench.set_cell_deadlines(Deadlines {
        connect: Duration::from_secs(2),
        request,
        stop: Duration::from_millis(500),
        profile: Duration::from_millis(500),
        beyond_move: Duration::from_secs(1),
    });
    (workbench, woken)
}

/// What to call an end in a list.
fn name_of(end: Option<&RoutineEnd>) -> String {
    match end {
        None => "no routine".to_owned(),
        Some(RoutineEnd::Failed { error, .. }) => {
            let text = format!("{error:?}");
            format!("failed: {}", text.split([' ', '{', '(']).next().unwrap_or_default())
        }
        Some(RoutineEnd::Searched(end)) => {
            let text = format!("{end:?}");
            format!("searched: {}", text.split([' ', '{', '(']).next().unwrap_or_default())
        }
        Some(end) => {
            let text = format!("{end:?}");
            text.split([' ', '{', '(']).next().unwrap_or_default().to_owned()
        }
    }
}

/// When a fault is to set in.
#[derive(Clone, Copy, Debug)]
enum Moment {
    Phase(SearchPhase),
    Activity(Activity),
}

/// The ways in which a fault for good may end a search.
fn is_expected(fault: Fault, end: &RoutineEnd) -> bool {
    let is_error =
        |expected: fn(&DeviceError) -> bool| matches!(end, RoutineEnd::Failed { error, .. } if expected(error));
    match fault {
        // Slower, but right.
        Fault::SplitFrames => matches!(end, RoutineEnd::Searched(SearchEnd::Found { .. })),
        // Within the deadlines or beyond, as it happens.
        Fault::Slow => {
            matches!(end, RoutineEnd::Searched(_)) || is_error(|error| !matches!(error, DeviceError::Refused { .. }))
        }
        Fault::Silent | Fault::Garbage | Fault::Disconnect => {
            is_error(|error| !matches!(error, DeviceError::Refused { .. }))
        }
        Fault::RobotRefuses => is_error(|error| matches!(error, DeviceError::Refused { .. })),
        // From a moment on at which the peak was known already it makes no difference.
        Fault::BallMoved => matches!(end, RoutineEnd::Searched(_)),
        Fault::StaleProfile => matches!(end, RoutineEnd::StaleProfiles { .. }),
        Fault::NotRemote => {
            matches!(end, RoutineEnd::NotAllowed(MotionRefusal::NotReady { .. }))
                // Between the look and the script: the script is ignored, and the move never ends.
                || is_error(|error| matches!(error, DeviceError::NotReady { .. } | DeviceError::Timeout { .. }))
        }
    }
}

fn check_fault(fault: Fault, device: SimDevice, moment: Moment) -> String {
    let what = format!("{fault:?} of {device:?} at {moment:?}");
    // One of the two directions leads away from the peak, and so through the reversal.
    // Only some controllers have a remote mode.
    let robot = if fault == Fault::NotRemote { RobotKind::UniversalRobots } else { RobotKind::FanucMappdk };
    let options = SimOptions { seed: 11, robot, ..SimOptions::default() };
    for direction in [1.0, -1.0] {
        // What is slow is to be too slow: otherwise each of these searches takes a minute.
        let request = if fault == Fault::Slow { REQUEST / 2 } else { REQUEST };
        let mut cell = Cell::start(&options, direction, request);
        cell.arm();
        cell.tell(CellCommand::FindLargestArc);
        let is_there = |cell: &Cell| match moment {
            Moment::Phase(SearchPhase::First) => true,
            Moment::Phase(phase) => cell.view().search.as_ref().is_some_and(|report| report.phase == phase),
            Moment::Activity(activity) => cell.view().search.is_some() && cell.view().activity == activity,
        };
        let is_over = |cell: &Cell| !cell.view().is_busy();
        assert!(cell.becomes(PATIENCE, |cell| is_there(cell) || is_over(cell)), "{what}: comes to the moment");
        if is_over(&cell) {
            continue;
        }
        cell.sim.inject(FaultSpec::now(fault).on(device));
        assert!(cell.becomes(PATIENCE, is_over), "{what}: hangs; {:?}", cell.view());
        let end = cell.view().last_end.clone().expect("ended");
        // The search may have been at its last capture already.
        let is_fine = is_expected(fault, &end) || matches!(end, RoutineEnd::Searched(SearchEnd::Found { .. }));
        assert!(is_fine, "{what}: {end:?}");
        if !end.is_success() {
            assert!(!cell.workbench.notices().is_empty(), "{what}: says nothing");
        }
        cell.check_nothing_is_lost(&what);
        cell.check_robot_stands(&what);
        return name_of(Some(&end));
    }
    panic!("{what}: the moment never came");
}

fn in_parallel<T: Send>(num: u64, run: impl Fn(u64) -> T + Sync) -> Vec<T> {
    /// They mostly wait.
    const NUM_THREADS: u64 = 6;
    let next = AtomicU64::new(0);
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
        let threads: Vec<_> = (0..NUM_THREADS).map(|_| scope.spawn(work)).collect();
        threads.into_iter().flat_map(|thread| thread.join().expect("every schedule ends as it should")).collect()
    })
}

#[test]
fn each_fault_at_each_phase_ends_in_its_time_and_in_its_name() {
    let moments = [
        Moment::Phase(SearchPhase::First),
        Moment::Phase(SearchPhase::Probe),
        Moment::Phase(SearchPhase::Reverse),
        Moment::Phase(SearchPhase::Climb),
        Moment::Phase(SearchPhase::Pass),
        Moment::Activity(Activity::Moving),
        Moment::Activity(Activity::Settling),
    ];
    let of_wire = [Fault::SplitFrames, Fault::Slow, Fault::Silent, Fault::Garbage, Fault::Disconnect];
    let of_both = of_wire.into_iter().flat_map(|fault| [(fault, SimDevice::Robot), (fault, SimDevice::Sensor)]);
    let of_one = [Fault::RobotRefuses, Fault::BallMoved, Fault::StaleProfile, Fault::NotRemote]
        .map(|fault| (fault, fault.usual_device()));
    let cases: Vec<_> = of_both
        .chain(of_one)
        .flat_map(|(fault, device)| moments.into_iter().map(move |moment| (fault, device, moment)))
        .collect();
    let start = Instant::now();
    let num_cases = u64::try_from(cases.len()).expect("few");
    let ends = in_parallel(num_cases, |idx| {
        let (fault, device, moment) = cases[usize::try_from(idx).expect("few")];
        check_fault(fault, device, moment)
    });
    report(&ends, start);
}

#[test]
fn a_program_that_ends_in_the_middle_of_a_move_stops_the_robot() {
    for robot in [RobotKind::FanucMappdk, RobotKind::UniversalRobots, RobotKind::Bridge] {
        let options = SimOptions { seed: 12, robot, ..SimOptions::default() };
        let mut cell = Cell::start(&options, 1.0, REQUEST);
        cell.arm();
        let mut settings = cell.view().settings;
        // So slow that the first step would take some seconds.
        settings.limits.search_speed_mm_s = 1.0 / TIME_SCALE;
        settings.search.step_mm = 3.0;
        settings.search.coarse_step_mm = 3.0;
        cell.tell(CellCommand::SetSettings(Box::new(settings)));
        cell.tell(CellCommand::FindLargestArc);
        let is_moving = |cell: &Cell| cell.view().search.is_some() && cell.view().activity == Activity::Moving;
        assert!(cell.becomes(PATIENCE, is_moving), "{robot:?}: {:?}", cell.view());
        let (workbench, woken) = workbench_with_short_deadlines(REQUEST);
        drop(std::mem::replace(&mut cell.workbench, workbench));
        cell.woken = woken;
        cell.workbench.open_session(Session::new(Target::ball(15.0)), None);
        cell.tell(CellCommand::ConnectRobot(cell.sim.robot_setup.clone()));
        cell.check_robot_stands(&format!("{robot:?}"));
    }
}

/// Faults of any kind at any time, one or two of them.
fn random_faults(seed: u64) -> Vec<FaultSpec> {
    let mut random = Random::new(seed, 5);
    let mut below = |limit: u32| -> u32 {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "below the limit")]
        let drawn = (random.unit() * f64::from(limit)) as u32;
        drawn
    };
    let num_faults = 1 + below(2);
    (0..num_faults)
        .map(|_| {
            let fault = Fault::ALL[below(9) as usize];
            let device = if below(2) == 0 { SimDevice::Robot } else { SimDevice::Sensor };
            let start =
                if below(2) == 0 { FaultStart::AfterMoves(below(25)) } else { FaultStart::AfterRequests(below(400)) };
            let num_requests = (below(3) > 0).then(|| 1 + below(30));
            FaultSpec { fault, device, start, num_requests }
        })
        .collect()
}

fn run_schedule(seed: u64) -> String {
    let faults = random_faults(seed);
    let what = format!("schedule {seed}: {faults:?}");
    let robot = [RobotKind::FanucMappdk, RobotKind::UniversalRobots, RobotKind::Bridge][(seed % 3) as usize];
    let sensor = if seed.is_multiple_of(2) { SensorKind::KeyenceLjv } else { SensorKind::Bridge };
    let mut cell = Cell::start(&SimOptions { seed, robot, sensor, ..SimOptions::default() }, 1.0, REQUEST);
    cell.arm();
    for fault in faults {
        cell.sim.inject(fault);
    }
    cell.tell(CellCommand::StartRun { num_stations: 2 });
    let is_over = |cell: &Cell| !cell.view().is_busy() && !cell.workbench.is_busy();
    assert!(cell.becomes(PATIENCE, is_over), "{what}: hangs; {:?}", cell.view());
    let end = cell.view().last_end.clone();
    let is_success = end.as_ref().is_some_and(RoutineEnd::is_success);
    assert!(is_success || !cell.workbench.notices().is_empty(), "{what}: says nothing");
    cell.check_nothing_is_lost(&what);
    name_of(end.as_ref())
}

fn report(ends: &[String], start: Instant) {
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    for end in ends {
        *counts.entry(end).or_default() += 1;
    }
    println!("{} cases in {:.1} s: {counts:?}", ends.len(), start.elapsed().as_secs_f64());
}

#[test]
fn random_faults_never_hang_it_and_lose_nothing() {
    let num = std::env::var("HANDEYE_FAULTS").ok().map_or(40, |num| num.parse().expect("a number of schedules"));
    let start = Instant::now();
    let ends = in_parallel(num, run_schedule);
    report(&ends, start);
}
