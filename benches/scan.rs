//! Five million points: through a calibration, into a plane, onto the screen. `cargo bench --bench scan`.
#![allow(missing_docs, reason = "criterion's macros write undocumented functions")]
#![allow(clippy::expect_used, reason = "a benchmark that cannot run must stop")]

use std::hint::black_box;
use std::sync::Arc;
use std::time::Duration;

use criterion::{Criterion, criterion_group, criterion_main};
use egui::{Color32, vec2};
use handeye::geometry::stats::SplitMix;
use handeye::geometry::{Base, Flange, Profile, Sensor, Transform, Vec3};
use handeye::scan::{Cloud, PointSet, ScanCapture, SegmentOptions, find_planes, fit_plane};
use handeye::ui::cloud::{AT_REST, Camera, Canvas, IN_MOTION, Thinned, draw};
use handeye::watch::Unwatched;
use nalgebra::UnitQuaternion;

const NUM_PROFILES: u16 = 2500;
const NUM_POINTS: u16 = 2000;

/// A roof: two planes at a right angle, 0.02 mm of noise, one point in a hundred off.
fn scan() -> Vec<ScanCapture> {
    let mut random = SplitMix::new(1);
    let mut noise = || {
        (0..4).map(|_| f64::from(u16::try_from(random.below(2001)).expect("small")) / 1000.0 - 1.0).sum::<f64>()
            * 0.0173
    };
    let rotation = UnitQuaternion::from_euler_angles(0.4, -0.2, 1.1);
    (0..NUM_PROFILES)
        .map(|number| {
            let x: Vec<f64> = (0..NUM_POINTS).map(|idx| f64::from(idx) * 0.05 - 50.0).collect();
            let z: Vec<Option<f64>> = (x.iter().enumerate())
                .map(|(idx, x)| Some(150.0 + x.abs() + noise() + if idx % 100 == 7 { 3.0 } else { 0.0 }))
                .collect();
            let at = Vec3::new(900.0, f64::from(number) * 0.1, 400.0);
            ScanCapture {
                base_from_flange: Transform::<Base, Flange>::from_parts(at, rotation),
                profile: Arc::new(Profile::new(x, &z).expect("valid")),
            }
        })
        .collect()
}

fn five_million_points(criterion: &mut Criterion) {
    let captures = scan();
    let flange_from_sensor = Transform::<Flange, Sensor>::from_parts(
        Vec3::new(-8.0, 124.0, -79.0),
        UnitQuaternion::from_euler_angles(0.1, 0.2, 0.3),
    );
    let cloud = Cloud::from_scan(&captures, &flange_from_sensor).expect("points");
    let all = PointSet::all(&cloud);
    let mut group = criterion.benchmark_group("5,000,000 points");
    group.sample_size(10).measurement_time(Duration::from_secs(4));
    group.bench_function("transform to the base", |bencher| {
        bencher.iter(|| Cloud::from_scan(black_box(&captures), &flange_from_sensor));
    });
    group.bench_function("plane fit, trimmed", |bencher| bencher.iter(|| fit_plane(&cloud, black_box(&all))));
    group.bench_function("all planes", |bencher| {
        bencher.iter(|| find_planes(&cloud, &all, &SegmentOptions::default(), &mut Unwatched));
    });
    let color_of = |idx: usize| Color32::from_gray(if idx.is_multiple_of(2) { 120 } else { 200 });
    for (name, most) in [("60,000", IN_MOTION), ("500,000", AT_REST)] {
        group.bench_function(format!("thin to {name}"), |bencher| {
            bencher.iter(|| Thinned::new(&cloud, black_box(most), color_of));
        });
        let thinned = Thinned::new(&cloud, most, color_of);
        let mut camera = Camera::default();
        let [low, high] = cloud.bounds_mm().expect("points").map(|end| (end - cloud.origin_mm()).cast::<f32>());
        let size = [930, 430];
        camera.fit([low, high], vec2(930.0, 430.0));
        let mut canvas = Canvas::default();
        group.bench_function(format!("a frame of {name} points, 930 × 430 pixels"), |bencher| {
            bencher.iter(|| {
                camera.turn(vec2(3.0, 0.0));
                draw(&thinned, &camera, size, 1.0, &mut canvas)
            });
        });
    }
}

criterion_group!(benches, five_million_points);
criterion_main!(benches);
