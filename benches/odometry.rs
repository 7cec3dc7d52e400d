//! Frames of 640 × 480 pixels of the simulated room, 30 a second: the steps by themselves, a frame as published and ours, and
//! how far both are off. `cargo bench --bench odometry`.
#![allow(missing_docs, reason = "criterion's macros write undocumented functions")]
#![allow(clippy::expect_used, reason = "a benchmark that cannot run must stop")]

use std::hint::black_box;
use std::time::Duration;

use criterion::{Criterion, SamplingMode, criterion_group, criterion_main};
use handeye::odometry::align::aligned;
use handeye::odometry::view::View;
use handeye::odometry::{Estimator, Odometry, OdometryOptions, RgbdFrame, TimedPose, Tracking, evaluate};
use handeye::simulate::room::{Carrier, RoomOptions, RoomRecording};

const NUM_FRAMES: usize = 60;
const CARRIERS: [Carrier; 3] = [Carrier::Vehicle, Carrier::Hand, Carrier::Robot];

fn recorded(carrier: Carrier) -> (RoomOptions, Vec<RgbdFrame>, Vec<TimedPose>) {
    let options = RoomOptions { num_frames: NUM_FRAMES, carrier, ..RoomOptions::default() };
    let (frames, truth) = RoomRecording::new(options.clone())
        .map(|frame| {
            let pose = TimedPose { time_s: frame.images.time_s, world_from_sensor: frame.world_from_sensor };
            (frame.images, pose)
        })
        .unzip();
    (options, frames, truth)
}

fn options(estimator: Estimator) -> OdometryOptions {
    OdometryOptions { estimator, ..OdometryOptions::default() }
}

/// Errors against the truth, for the documentation.
fn accuracy(recordings: &[(RoomOptions, Vec<RgbdFrame>, Vec<TimedPose>)]) {
    println!("| camera | estimator | ATE mm | RPE mm | RPE ° | tracked |");
    println!("| --- | --- | --- | --- | --- | --- |");
    for (room, frames, truth) in recordings {
        for estimator in [Estimator::Published, Estimator::Ours] {
            let mut odometry = Odometry::new(room.camera, options(estimator));
            let poses: Vec<TimedPose> = frames
                .iter()
                .filter_map(|frame| {
                    let outcome = odometry.push(frame);
                    let is_tracked = matches!(outcome.tracking, Tracking::Started { .. } | Tracking::Tracked(_));
                    is_tracked
                        .then_some(TimedPose { time_s: outcome.time_s, world_from_sensor: outcome.world_from_sensor? })
                })
                .collect();
            let Some(error) = evaluate(truth, &poses) else { continue };
            println!(
                "| {:?} | {} | {:.2} | {:.3} | {:.4} | {} of {} |",
                room.carrier,
                estimator.id(),
                error.ate_rmse_mm,
                error.rpe_translation_rmse_mm,
                error.rpe_rotation_rmse_rad.to_degrees(),
                poses.len(),
                frames.len()
            );
        }
    }
}

fn frames(criterion: &mut Criterion) {
    let recordings = CARRIERS.map(recorded);
    accuracy(&recordings);
    let (room, frames, _) = &recordings[1];
    let mut group = criterion.benchmark_group("640 x 480");
    // Samples of few runs each: where the machine is busy, the least of them still tells the time.
    group.sampling_mode(SamplingMode::Flat).sample_size(100).measurement_time(Duration::from_millis(300));
    group.bench_function("depth to colour", |bencher| {
        bencher.iter(|| aligned(black_box(&frames[0].depth), &room.camera));
    });
    group.bench_function("align, clean, smooth", |bencher| {
        let filter = OdometryOptions::default().depth;
        bencher.iter(|| View::of(black_box(&frames[0]), &room.camera, &filter));
    });
    for estimator in [Estimator::Published, Estimator::Ours] {
        // There and back again, so that every step is one of a thirtieth of a second.
        let mut odometry = Odometry::new(room.camera, options(estimator));
        let mut order = (0..NUM_FRAMES).chain((1..NUM_FRAMES - 1).rev()).cycle();
        let mut time_s = 0.0;
        group.bench_function(format!("a frame, {}", estimator.id()), |bencher| {
            bencher.iter_batched(
                || {
                    time_s += 1.0 / 30.0;
                    RgbdFrame { time_s, ..frames[order.next().unwrap_or_default()].clone() }
                },
                |frame| odometry.push(black_box(&frame)),
                criterion::BatchSize::SmallInput,
            );
        });
    }
    group.finish();
}

criterion_group!(benches, frames);
criterion_main!(benches);
