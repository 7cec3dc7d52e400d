//! How near each method comes to the truth, over many simulated sessions: `cargo bench --bench accuracy`.
//!
//! Prints the tables of `docs/accuracy.md`. Seeds are fixed, so anyone gets the same figures.
#![allow(clippy::expect_used, reason = "a benchmark that cannot run must stop")]

use handeye::calibrate::{Method, Side, Solution, solve};
use handeye::geometry::stats;
use handeye::report::compare::distance_from_truth;
use handeye::session::{Session, ball_problem, measure};
use handeye::simulate::{Dirt, SimulationOptions, simulate};
use handeye::text;
use handeye::watch::Unwatched;

/// A named kind of session.
struct Scene {
    name: &'static str,
    options: SimulationOptions,
    num_seeds: u64,
}

fn main() {
    // `cargo test --benches` and `cargo bench` pass flags of their harness; only the latter asks for the tables.
    if !std::env::args().any(|argument| argument == "--bench") {
        return;
    }
    for scene in scenes() {
        print_scene(&scene);
    }
    print_sides();
}

fn scenes() -> Vec<Scene> {
    let typical = SimulationOptions::default();
    let scene = |name, options| Scene { name, options, num_seeds: 50 };
    vec![
        scene("10 stations x 21 steps x 800 points, robot 0.02 mm / 0.005°, sensor 0.01 mm", typical.clone()),
        scene(
            "the first with a robot of 0.05 mm / 0.02°",
            SimulationOptions { position_std_mm: 0.05, orientation_std_deg: 0.02, ..typical.clone() },
        ),
        scene(
            "the first with table, spikes, holes and flank bias",
            SimulationOptions { dirt: Dirt::all(), ..typical.clone() },
        ),
        scene(
            "the first with travel 3° off the laser's normal",
            SimulationOptions { travel_off_normal_deg: 3.0, ..typical.clone() },
        ),
        scene("20 stations, one section each", SimulationOptions { num_stations: 20, num_steps: 1, ..typical }),
    ]
}

fn solved(session: &Session, method: Method) -> Option<Solution> {
    let measured = measure(session, None, &mut Unwatched).expect("not cancelled");
    solve(&ball_problem(session, &measured).expect("a ball"), method).ok()
}

fn print_scene(scene: &Scene) {
    println!("\n### {} ({} seeds)\n", scene.name, scene.num_seeds);
    println!(
        "| method | error of a workspace point, RMS / mm | largest / mm | orientation, RMS / ° | error over stated σ |"
    );
    println!("| --- | --- | --- | --- | --- |");
    for method in Method::BALL {
        let (mut errors_mm, mut angles_deg, mut stated_mm) = (Vec::new(), Vec::new(), Vec::new());
        for seed in 1..=scene.num_seeds {
            let session = simulate(&SimulationOptions { seed, ..scene.options.clone() });
            let Some(solution) = solved(&session, method) else { continue };
            let error = distance_from_truth(&solution, session.truth.as_ref().expect("simulated"));
            errors_mm.push(error.workspace_point_mm);
            angles_deg.push(error.rotation_rad.to_degrees());
            stated_mm.extend(solution.uncertainty.map(|known| known.workspace_point_std_mm));
        }
        if errors_mm.is_empty() {
            continue;
        }
        let rms_mm = stats::rms(errors_mm.iter().copied());
        println!(
            "| {} | {:.4} | {:.4} | {:.4} | {:.2} |",
            text::method_name(method),
            rms_mm,
            stats::max(errors_mm),
            stats::rms(angles_deg),
            rms_mm / stats::rms(stated_mm)
        );
    }
}

/// How often the sides of single sections are found.
fn print_sides() {
    const NUM_SEEDS: u64 = 200;
    println!("\n### Sides of single sections, all to be found ({NUM_SEEDS} seeds)\n");
    println!("| stations | sessions with all sides right |\n| --- | --- |");
    for num_stations in [4, 5, 6, 8, 10, 15, 20] {
        let right = (1..=NUM_SEEDS)
            .filter(|seed| {
                let session = simulate(&SimulationOptions {
                    seed: *seed,
                    num_stations,
                    num_steps: 1,
                    num_points: 160,
                    ..SimulationOptions::default()
                });
                let truth = session.truth.as_ref().expect("simulated");
                let Some(solution) = solved(&session, Method::BallFixedPoint) else { return false };
                solution.stations.iter().all(|station| {
                    let base_from_flange = session.stations[station.station_idx].captures[0].base_from_flange;
                    let base_from_sensor = base_from_flange * truth.flange_from_sensor;
                    let y = base_from_sensor.inverse().map_point(truth.target_in_base_mm).y;
                    let side = if y < 0.0 { Side::Minus } else { Side::Plus };
                    side == station.side
                })
            })
            .count();
        println!("| {num_stations} | {right} of {NUM_SEEDS} |");
    }
}
