//! How near the camera's motion comes to the truth in simulated rooms: `cargo bench --bench odometry_accuracy`.
//!
//! Prints tables as in `docs/room.md`. Seeds are fixed, so anyone gets the same errors; times are this machine's.
#![allow(clippy::expect_used, reason = "a benchmark that cannot run must stop")]

use std::time::Instant;

use handeye::geometry::stats;
use handeye::odometry::{Estimator, Evaluation, Odometry, OdometryOptions, TimedPose, evaluate};
use handeye::simulate::room::{CameraNoise, Carrier, RoomOptions, RoomRecording};

const NUM_SEEDS: u64 = 5;

/// What an estimator made of one recording.
struct Outcome {
    evaluation: Option<Evaluation>,
    num_lost: usize,
    frame_ms: Vec<f64>,
}

fn main() {
    // `cargo test --benches` and `cargo bench` pass flags of their harness; only the latter asks for the tables.
    if !std::env::args().any(|argument| argument == "--bench") {
        return;
    }
    let usual = RoomOptions::default();
    let fast = RoomOptions { frames_per_s: 10.0, num_frames: 60, ..usual.clone() };
    let perfect = RoomOptions { noise: CameraNoise::NONE, ..usual.clone() };
    let smeared = RoomOptions { exposure_s: 0.01, ..usual.clone() };
    for (name, options) in [
        ("640 × 480 at 30 Hz, 120 frames, noise of a Kinect", usual),
        ("the same, a shutter of 10 ms", smeared),
        ("the same at 10 Hz, 60 frames", fast),
        ("the first with perfect cameras", perfect),
    ] {
        print_table(name, &options);
    }
}

fn print_table(name: &str, options: &RoomOptions) {
    println!("\n### {name} ({NUM_SEEDS} seeds)\n");
    println!("| camera | estimator | ATE, RMS / mm | RPE, RMS / mm | RPE, RMS / ° | frames lost | median / ms |");
    println!("| --- | --- | --- | --- | --- | --- | --- |");
    for (carrier, carried) in
        [(Carrier::Vehicle, "on a vehicle"), (Carrier::Hand, "in a hand"), (Carrier::Robot, "on a robot")]
    {
        for estimator in [Estimator::Published, Estimator::Ours] {
            let outcomes: Vec<Outcome> = (1..=NUM_SEEDS)
                .map(|seed| followed(RoomOptions { seed, carrier, ..options.clone() }, estimator))
                .collect();
            print_row(carried, estimator, &outcomes);
        }
    }
}

/// Follows a camera, with the clock running for the odometry alone.
fn followed(options: RoomOptions, estimator: Estimator) -> Outcome {
    let mut odometry = Odometry::new(options.camera, OdometryOptions { estimator, ..OdometryOptions::default() });
    let (mut truth, mut found, mut frame_ms) = (Vec::new(), Vec::new(), Vec::new());
    let mut num_lost = 0;
    for frame in RoomRecording::new(options) {
        let time_s = frame.images.time_s;
        truth.push(TimedPose { time_s, world_from_sensor: frame.world_from_sensor });
        let started = Instant::now();
        let outcome = odometry.push(&frame.images);
        frame_ms.push(1000.0 * started.elapsed().as_secs_f64());
        match outcome.world_from_sensor {
            Some(world_from_sensor) => found.push(TimedPose { time_s, world_from_sensor }),
            None => num_lost += 1,
        }
    }
    Outcome { evaluation: evaluate(&truth, &found), num_lost, frame_ms }
}

fn print_row(carried: &str, estimator: Estimator, outcomes: &[Outcome]) {
    let evaluations = || outcomes.iter().filter_map(|outcome| outcome.evaluation);
    let rms = |of: fn(Evaluation) -> f64| stats::rms(evaluations().map(of));
    let num_lost: usize = outcomes.iter().map(|outcome| outcome.num_lost).sum();
    let mut frame_ms: Vec<f64> = outcomes.iter().flat_map(|outcome| outcome.frame_ms.iter().copied()).collect();
    frame_ms.sort_by(f64::total_cmp);
    println!(
        "| {carried} | {} | {:.2} | {:.3} | {:.4} | {num_lost} | {:.1} |",
        estimator.id(),
        rms(|evaluation| evaluation.ate_rmse_mm),
        rms(|evaluation| evaluation.rpe_translation_rmse_mm),
        rms(|evaluation| evaluation.rpe_rotation_rmse_rad.to_degrees()),
        frame_ms[frame_ms.len() / 2],
    );
}
