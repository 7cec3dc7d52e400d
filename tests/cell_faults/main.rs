//! Everything that can go wrong in a cell, at each phase of the search and at random: each ends in its time and in a named
//! end, the robot stands, and nothing that was captured is lost.
//!
//! `HANDEYE_FAULTS=1000 cargo test --test cell_faults -- --nocapture` runs as many random schedules and tells how they ended.
#![expect(clippy::expect_used, reason = "a test that finds nothing to check must fail")]

mod bench;
mod table;

use std::collections::BTreeMap;
use std::time::{Duration, Instant};

use handeye::app::cell::{Activity, CellCommand};
use handeye::device::sim::{Fault, FaultSpec, FaultStart, SimDevice, SimOptions};
use handeye::device::{Deadlines, RobotKind, RoutineEnd, SearchPhase, SensorKind};
use handeye::geometry::Vec3;
use handeye::scene::Random;
use handeye::session::{Session, Target};

use bench::{Cell, in_parallel};
use table::{Case, Moment};

const TIME_SCALE: f64 = 20.0;
/// Shorter than the simulated cell's late answers take: whatever is late is too late.
const SHORT: Duration = Duration::from_millis(250);
/// Longer than they take.
const LONG: Duration = Duration::from_millis(1500);
/// So slow, by the cell's clock, that a long way takes seconds, mm/s.
const CRAWL_MM_S: f64 = 1.0;
/// How much of a long way is left, at least, where it was broken off, mm.
const LEFT_MM: f64 = 20.0;

fn deadlines(request: Duration) -> Deadlines {
    Deadlines {
        connect: Duration::from_secs(3),
        request,
        stop: Duration::from_secs(2),
        profile: Duration::from_millis(500),
        beyond_move: Duration::from_secs(3),
    }
}

/// What to call an end in a list.
fn name_of(end: &RoutineEnd) -> String {
    let first_word = |text: String| text.split([' ', '{', '(']).next().unwrap_or_default().to_owned();
    match end {
        RoutineEnd::Failed { error, .. } => format!("failed: {}", first_word(format!("{error:?}"))),
        RoutineEnd::Searched(end) => format!("searched: {}", first_word(format!("{end:?}"))),
        RoutineEnd::NotAllowed(refusal) => format!("not allowed: {}", first_word(format!("{refusal:?}"))),
        end => first_word(format!("{end:?}")),
    }
}

fn tell_counts(ends: &[String], start: Instant) {
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    for end in ends {
        *counts.entry(end).or_default() += 1;
    }
    println!("{} cases in {:.1} s: {counts:?}", ends.len(), start.elapsed().as_secs_f64());
}

/// Brings a cell to the moment; `None` if the search was over before it came.
fn come_to(case: &Case, direction: f64) -> Option<(Cell, Option<Vec3>)> {
    let what = format!("{case:?}");
    let options = SimOptions {
        seed: 11,
        robot: case.robot,
        sensor: case.sensor,
        time_scale: TIME_SCALE,
        ..SimOptions::default()
    };
    let options = if case.moment == Moment::Moving { bench::far_view(options) } else { options };
    let is_too_late = case.spec.fault == Fault::Slow && case.spec.num_requests.is_none();
    let mut cell = Cell::start(&options, deadlines(if is_too_late { SHORT } else { LONG }));
    cell.arm();
    cell.change_settings(|settings| {
        settings.search.direction = [0.0, direction, 0.0];
        settings.limits.transit_speed_mm_s = CRAWL_MM_S;
    });
    if case.moment == Moment::Moving {
        let target_mm = cell.set_out(&what);
        return Some((cell, Some(target_mm)));
    }
    cell.tell(CellCommand::FindLargestArc);
    let is_there = |cell: &Cell| {
        let search = cell.view().search.as_ref();
        match case.moment {
            Moment::Phase(SearchPhase::First) => true,
            Moment::Phase(phase) => search.is_some_and(|report| report.phase == phase),
            Moment::Settling => search.is_some() && cell.view().activity == Activity::Settling,
            Moment::Moving => false,
        }
    };
    assert!(cell.becomes(|cell| is_there(cell) || cell.is_over()), "{what}: comes to the moment");
    (!cell.is_over()).then_some((cell, None))
}

fn check_case(case: &Case) -> String {
    /// On a busy machine a phase that lasts one capture may be missed.
    const NUM_ATTEMPTS: usize = 6;
    let what = format!("{case:?}");
    // One of the two directions leads away from the peak, and so through the reversal.
    let mut directions = [1.0, -1.0].into_iter().cycle().take(NUM_ATTEMPTS);
    let (mut cell, target_mm) =
        directions.find_map(|direction| come_to(case, direction)).unwrap_or_else(|| panic!("{what}: never comes"));
    cell.sim.inject(case.spec);
    // What happened before is told by now.
    cell.poll();
    let phase = cell.view().search.as_ref().map(|report| report.phase);
    let may_be_known = matches!(phase, Some(SearchPhase::Pass | SearchPhase::Ended));
    let end = cell.end(&what);
    let is_found = matches!(end, RoutineEnd::Searched(ref end) if end.is_found());
    assert!(case.admits(&end) || is_found && may_be_known, "{what}: {end:?}");
    if let RoutineEnd::Failed { robot_stopped, .. } = end
        && case.robot_takes_stop()
    {
        assert_eq!(robot_stopped, Some(true), "{what}: {end:?}");
    }
    if let Some(target_mm) = target_mm
        && case.breaks_off_way()
    {
        let left_mm = (cell.position_mm() - target_mm).norm();
        assert!(left_mm > LEFT_MM, "{what}: {left_mm} mm before the target");
    }
    assert!(end.is_success() || !cell.workbench.notices().is_empty(), "{what}: says nothing");
    cell.check_word_about_robot(&what, &end);
    cell.check_nothing_is_lost(&what);
    cell.check_what_was_found(&what);
    cell.check_recovers(&what);
    name_of(&end)
}

#[test]
fn each_fault_at_each_phase_ends_in_its_time_and_in_its_name() {
    let cases = table::all_cases();
    let start = Instant::now();
    let ends = in_parallel(cases.len(), |idx| check_case(&cases[idx]));
    tell_counts(&ends, start);
}

/// What breaks off a long way.
#[derive(Clone, Copy, Debug)]
enum Breach {
    Stop,
    Disarm,
    Lost(Fault),
    ProgramEnds,
}

#[test]
fn a_robot_on_a_long_way_stands_far_from_its_target_once_it_is_stopped() {
    /// In real time this leaves ten seconds and more for what takes one.
    const SPEED_MM_S: f64 = 10.0;
    const LEFT_MM: f64 = 40.0;
    /// Longer than the pieces of MAPPDK's way, of half a second.
    const WATCHED: Duration = Duration::from_millis(1200);
    let breaches = [
        Breach::Stop,
        Breach::Disarm,
        Breach::Lost(Fault::Disconnect),
        Breach::Lost(Fault::Silent),
        Breach::ProgramEnds,
    ];
    let robots = [RobotKind::FanucMappdk, RobotKind::UniversalRobots, RobotKind::Bridge];
    let cases: Vec<_> = robots.into_iter().flat_map(|robot| breaches.map(|breach| (robot, breach))).collect();
    in_parallel(cases.len(), |idx| {
        let (robot, breach) = cases[idx];
        let what = format!("{robot:?}, {breach:?}");
        let options = bench::far_view(SimOptions { seed: 12, robot, ..SimOptions::default() });
        let mut cell = Cell::start(&options, deadlines(LONG));
        cell.arm();
        cell.change_settings(|settings| settings.limits.transit_speed_mm_s = SPEED_MM_S);
        let target_mm = cell.set_out(&what);
        match breach {
            Breach::Stop => cell.tell(CellCommand::Stop),
            Breach::Disarm => cell.tell(CellCommand::Arm(false)),
            Breach::Lost(fault) => cell.sim.inject(FaultSpec::now(fault).on(SimDevice::Sensor)),
            Breach::ProgramEnds => {
                cell.begin_anew(deadlines(LONG));
                cell.workbench.open_session(Session::new(Target::ball(15.0)), None);
            }
        }
        match breach {
            Breach::ProgramEnds => {}
            Breach::Stop | Breach::Disarm => {
                assert_eq!(cell.end(&what), RoutineEnd::Stopped { robot_stopped: Some(true) }, "{what}");
            }
            Breach::Lost(_) => {
                let end = cell.end(&what);
                let RoutineEnd::Failed { error, robot_stopped: Some(true) } = &end else { panic!("{what}: {end:?}") };
                assert!(table::is_of(SimDevice::Sensor, error), "{what}: {error}");
            }
        }
        assert_eq!(cell.view().is_armed, matches!(breach, Breach::Stop | Breach::Lost(_)), "{what}");
        let moved_mm = cell.moves_within_mm(WATCHED);
        assert!(moved_mm < 1e-6, "{what}: moves by {moved_mm} mm");
        let left_mm = (cell.position_mm() - target_mm).norm();
        assert!(left_mm > LEFT_MM, "{what}: {left_mm} mm before the target");
    });
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
                if below(2) == 0 { FaultStart::AfterMoves(below(50)) } else { FaultStart::AfterRequests(below(600)) };
            let num_requests = (below(3) > 0).then(|| 1 + below(30));
            FaultSpec { fault, device, start, num_requests }
        })
        .collect()
}

/// The end of a schedule in which the faults came later, or did no harm.
const COMPLETE: &str = "complete";

/// How a schedule ended, and whether the robot went to another station.
fn run_schedule(seed: u64) -> (String, bool) {
    /// A way of 100 mm takes half a second of real time.
    const SPEED_MM_S: f64 = 10.0;
    const NUM_STATIONS: u16 = 2;
    let faults = random_faults(seed);
    let what = format!("schedule {seed}: {faults:?}");
    let robot = [RobotKind::FanucMappdk, RobotKind::UniversalRobots, RobotKind::Bridge][(seed % 3) as usize];
    let sensor = if seed.is_multiple_of(2) { SensorKind::KeyenceLjv } else { SensorKind::Bridge };
    let options = SimOptions { seed, robot, sensor, time_scale: TIME_SCALE, ..SimOptions::default() };
    let mut cell = Cell::start(&options, deadlines(SHORT));
    cell.arm();
    cell.change_settings(|settings| settings.limits.transit_speed_mm_s = SPEED_MM_S);
    let drawing = cell.sim.truth.rough_flange_from_sensor;
    cell.set_mounting(&drawing);
    for fault in faults {
        cell.sim.inject(fault);
    }
    cell.tell(CellCommand::StartRun { num_stations: NUM_STATIONS });
    let end = cell.end(&what);
    cell.check_word_about_robot(&what, &end);
    cell.check_nothing_is_lost(&what);
    let num_found = cell.check_what_was_found(&what);
    let run = cell.view().run.expect("a run");
    assert!(usize::from(run.num_done) <= num_found, "{what}: {run:?}, but {num_found} found");
    let is_complete = run.num_done == NUM_STATIONS;
    assert!(is_complete || !cell.workbench.notices().is_empty(), "{what}: says nothing");
    (if is_complete { COMPLETE.to_owned() } else { name_of(&end) }, cell.has_set_out)
}

#[test]
fn random_faults_never_hang_it_and_lose_nothing() {
    let num = std::env::var("HANDEYE_FAULTS").ok().map_or(40, |num| num.parse().expect("a number of schedules"));
    let start = Instant::now();
    let (ends, has_set_out): (Vec<_>, Vec<_>) = in_parallel(num, |seed| run_schedule(seed as u64)).into_iter().unzip();
    tell_counts(&ends, start);
    let num_out = has_set_out.iter().filter(|has_set_out| **has_set_out).count();
    println!("{num_out} of them set out to another station");
    assert!(num_out * 3 > num, "{num_out} of {num} set out to another station");
    // A quarter of them, as a rule. Faults that harm nothing prove nothing.
    let num_harmed = ends.iter().filter(|end| *end != COMPLETE).count();
    assert!(num_harmed * 10 > num, "{num_harmed} of {num} were harmed");
}
