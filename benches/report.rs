//! All figures of a session of 20 stations × 21 captures × 800 points: `cargo bench --bench report`. A whole report has to be
//! done within 2 s, so the figures may take a part of that only.
#![allow(missing_docs, reason = "criterion's macros write undocumented functions")]
#![allow(clippy::expect_used, reason = "a benchmark that cannot run must stop")]

use std::hint::black_box;
use std::time::Duration;

use criterion::{Criterion, criterion_group, criterion_main};
use handeye::report::evidence::Evidence;
use handeye::report::figure::figures_of;
use handeye::session::measure;
use handeye::simulate::{Dirt, SimulationOptions, simulate};
use handeye::watch::Unwatched;

fn figures(criterion: &mut Criterion) {
    let options = SimulationOptions {
        num_stations: 20,
        num_steps: 21,
        num_points: 800,
        dirt: Dirt::all(),
        ..SimulationOptions::default()
    };
    let session = simulate(&options);
    let measured = measure(&session, None, &mut Unwatched).expect("not cancelled");
    let evidence = Evidence::gather(&session, &measured, &[], &mut Unwatched).expect("not cancelled");
    let mut group = criterion.benchmark_group("report, 20 stations × 21 × 800");
    group.sample_size(10).measurement_time(Duration::from_secs(5));
    group.bench_function("computed from the session", |bencher| {
        bencher.iter(|| Evidence::gather(black_box(&session), &measured, &[], &mut Unwatched));
    });
    group.bench_function("figures laid out", |bencher| bencher.iter(|| figures_of(black_box(&evidence))));
    let figures = figures_of(&evidence);
    group.bench_function("figures as SVG", |bencher| {
        bencher.iter(|| figures.iter().map(|figure| figure.svg().expect("drawn").len()).sum::<usize>());
    });
    group.bench_function("figures as PNG, 2 pixels a point", |bencher| {
        bencher.iter(|| figures.iter().map(|figure| figure.png(2.0).expect("drawn").len()).sum::<usize>());
    });
    group.finish();
}

criterion_group!(benches, figures);
criterion_main!(benches);
