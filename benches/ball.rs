//! Circle fits and ball methods, with the same generators and seeds each time: `cargo bench --bench ball`.
#![allow(missing_docs, reason = "criterion's macros write undocumented functions")]
#![allow(clippy::expect_used, reason = "a benchmark that cannot run must stop")]

use std::hint::black_box;
use std::time::Duration;

use criterion::{Criterion, criterion_group, criterion_main};
use handeye::calibrate::ball::bundle::refine;
use handeye::calibrate::observation::{CentreObservation, State};
use handeye::calibrate::rotation_start::PoseGeometry;
use handeye::calibrate::solver::minimise;
use handeye::calibrate::validation::bootstrap;
use handeye::calibrate::{Method, best_available, solve, solve_all};
use handeye::diagnose::{Case, diagnose};
use handeye::fit::{ArcOptions, CircleMethod, extract_arc};
use handeye::geometry::{Profile, Rigid, Vec3};
use handeye::plan::{Limits, next_stations};
use handeye::session::{Reading, Session, ball_problem, measure, parse, to_json};
use handeye::simulate::{Dirt, SimulationOptions, simulate};
use handeye::watch::Unwatched;

fn session(num_stations: usize, num_steps: usize, dirt: Dirt) -> Session {
    simulate(&SimulationOptions { num_stations, num_steps, num_points: 800, dirt, ..SimulationOptions::default() })
}

fn first_profile(session: &Session) -> &Profile {
    match &session.stations[0].captures[0].reading {
        Reading::Profile(profile) => profile,
        Reading::Point(_) | Reading::Pose(_) => unreachable!("simulated sessions hold profiles"),
    }
}

/// 800 points on an arc of the ball with 0.01 mm of noise; with `outliers` one point in fifty is off by 2 mm.
fn arc_points(outliers: bool) -> (Vec<f64>, Vec<f64>) {
    let session = session(1, 1, Dirt::default());
    let valid: Vec<(f64, f64)> = first_profile(&session).valid_points().map(|(_, x, z)| (x, z)).collect();
    (0..800)
        .map(|idx| {
            let (x, z) = valid[idx % valid.len()];
            (x, if outliers && idx % 50 == 7 { z - 2.0 } else { z })
        })
        .unzip()
}

fn circles(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("circle, 800 points");
    let (x, z) = arc_points(false);
    for method in [CircleMethod::Taubin, CircleMethod::Hyper, CircleMethod::Geometric] {
        group.bench_function(format!("{method:?}"), |bencher| {
            bencher.iter(|| method.fit(black_box(&x), black_box(&z)));
        });
    }
    let (x, z) = arc_points(true);
    group.bench_function("Robust, 2 % outliers", |bencher| {
        bencher.iter(|| CircleMethod::Robust.fit(black_box(&x), black_box(&z)));
    });
    for (name, dirt) in [("extract, clean", Dirt::default()), ("extract, dirty", Dirt::all())] {
        let session = session(1, 1, dirt);
        let profile = first_profile(&session);
        let options = ArcOptions { ball_radius_mm: 15.0, profile_std_mm: None };
        group.bench_function(name, |bencher| bencher.iter(|| extract_arc(black_box(profile), &options)));
    }
    group.finish();
}

fn hand_eye(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("hand-eye");
    for num_poses in [20, 1000] {
        let session = session(num_poses, 1, Dirt::default());
        let truth = session.truth.as_ref().expect("simulated");
        let poses: Vec<Rigid> = session.stations.iter().map(|s| *s.captures[0].base_from_flange.rigid()).collect();
        let sensor_from_flange = truth.flange_from_sensor.rigid().inverse();
        let centres: Vec<Vec3> = poses
            .iter()
            .map(|pose| (sensor_from_flange * pose.inverse() * nalgebra::Point3::from(truth.target_in_base_mm)).coords)
            .collect();
        group.bench_function(format!("from {num_poses} arc centres"), |bencher| {
            bencher.iter(|| {
                let geometry = PoseGeometry::new(black_box(&poses)).expect("rotations");
                let reduced = geometry.reduced(black_box(&centres));
                let start = reduced.state(reduced.best_minimum().flange_from_sensor);
                let observations = CentreObservation::points(&poses, &centres);
                minimise(&observations.iter(), start)
            });
        });
    }
    for num_poses in [20, 200] {
        let session = session(num_poses, 1, Dirt::default());
        let measured = measure(&session, None, &mut Unwatched).expect("not cancelled");
        let problem = ball_problem(&session, &measured).expect("a ball");
        // From the fixed-point answer, as a user would start the other solvers.
        let fixed_point = solve(&problem, Method::BallFixedPoint).expect("a solution");
        let start = State {
            flange_from_sensor: *fixed_point.flange_from_sensor.rigid(),
            ball_in_base: fixed_point.target_in_base_mm,
        };
        group.bench_function(format!("bundle, {num_poses} x 800 points"), |bencher| {
            bencher.iter(|| refine(black_box(&problem), start));
        });
        group.bench_function(format!("bundle, {num_poses} x 800 points, start and validation included"), |bencher| {
            bencher.iter(|| solve(black_box(&problem), Method::BallBundle));
        });
    }
    group.finish();
}

fn sessions(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("session");
    group.measurement_time(Duration::from_secs(5)).sample_size(20);
    let session_210 = session(10, 21, Dirt::default());
    group.bench_function("10 x 21 x 800, arcs and all methods", |bencher| {
        bencher.iter(|| {
            let measured = measure(black_box(&session_210), None, &mut Unwatched).expect("not cancelled");
            let problem = ball_problem(&session_210, &measured).expect("a ball");
            solve_all(&problem, &Method::BALL, &mut Unwatched)
        });
    });
    let session_20 = session(20, 21, Dirt::default());
    let measured = measure(&session_20, None, &mut Unwatched).expect("not cancelled");
    group.bench_function("20 x 21 x 800, a station un-ticked", |bencher| {
        bencher.iter(|| {
            let mut edited = session_20.clone();
            edited.stations[3].enabled = false;
            let measured = measure(&edited, Some(&measured), &mut Unwatched).expect("not cancelled");
            let problem = ball_problem(&edited, &measured).expect("a ball");
            solve_all(&problem, &Method::BALL, &mut Unwatched)
        });
    });
    let json =
        to_json(&simulate(&SimulationOptions { num_stations: 17, decimals: Some(4), ..SimulationOptions::default() }));
    let megabytes = json.len() / 1_000_000;
    group.bench_function(format!("open {megabytes} MB"), |bencher| {
        bencher.iter(|| parse(black_box(json.as_bytes()), "bench.json"));
    });
    group.finish();
}

/// What follows the methods in the background.
fn studies(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("studies");
    group.measurement_time(Duration::from_secs(5)).sample_size(10);
    let session = session(20, 21, Dirt::default());
    let measured = measure(&session, None, &mut Unwatched).expect("not cancelled");
    let problem = ball_problem(&session, &measured).expect("a ball");
    group.bench_function("20 x 21 x 800, arcs and all methods", |bencher| {
        bencher.iter(|| {
            let measured = measure(black_box(&session), None, &mut Unwatched).expect("not cancelled");
            let problem = ball_problem(&session, &measured).expect("a ball");
            solve_all(&problem, &Method::BALL, &mut Unwatched)
        });
    });
    let results = solve_all(&problem, &Method::BALL, &mut Unwatched).expect("not cancelled");
    let solution = best_available(&results).expect("solved");
    group.bench_function("20 x 21 x 800, diagnosis and validation", |bencher| {
        let case = Case { session: &session, problem: &problem, results: &results };
        bencher.iter(|| diagnose(black_box(case), &mut Unwatched));
    });
    group.bench_function("20 x 21 x 800, plan of 4 stations", |bencher| {
        bencher.iter(|| next_stations(black_box(solution), &Limits::default(), 4));
    });
    group.bench_function("20 x 21 x 800, bootstrap of 500", |bencher| {
        bencher.iter(|| bootstrap(black_box(solution), 500, 1, &mut Unwatched));
    });
    group.finish();
}

criterion_group!(benches, circles, hand_eye, sessions, studies);
criterion_main!(benches);
