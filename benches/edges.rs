//! How long it takes to find an edge in a profile of 800 points: `cargo bench --bench edges`.
#![allow(missing_docs, reason = "criterion's macros write undocumented functions")]
#![allow(clippy::expect_used, reason = "a benchmark that cannot run must stop")]

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use handeye::fit::{EdgeOptions, Feature, extract_edge};
use handeye::geometry::Profile;
use handeye::scene::Random;

const NOISE_MM: f64 = 0.02;

/// A profile of a range at each place across the line, with noise.
fn profile(range_mm: impl Fn(f64) -> Option<f64>) -> Profile {
    let mut random = Random::new(3, 1);
    let x_mm: Vec<f64> = (0..800).map(|idx| -20.0 + 0.05 * f64::from(idx)).collect();
    let z_mm: Vec<Option<f64>> = x_mm.iter().map(|x| range_mm(*x).map(|z| z + NOISE_MM * random.normal())).collect();
    Profile::new(x_mm, &z_mm).expect("a profile")
}

fn edges(criterion: &mut Criterion) {
    let cone = |x: f64| Some(if x.abs() < 1.5 { 80.0 + 2.0 * x.abs() } else { 100.0 });
    let profiles = [
        ("corner", None, profile(|x| Some(80.0 + x.abs()))),
        ("edge", None, profile(|x| (x < 3.0).then_some(80.0))),
        ("step", None, profile(|x| Some(if x < 3.0 { 80.0 } else { 85.0 }))),
        ("tip", Some(Feature::Tip), profile(cone)),
    ];
    for (name, feature, profile) in &profiles {
        let options = EdgeOptions { feature: *feature, profile_std_mm: None };
        criterion.bench_function(&format!("{name}, 800 points"), |bencher| {
            bencher.iter(|| extract_edge(black_box(profile), &options));
        });
    }
}

criterion_group!(benches, edges);
criterion_main!(benches);
