//! Time of the hand-eye calibration from motions: the refined answer with the noise stated and found, the whole solution with
//! its tables, and every closed form.
#![expect(clippy::expect_used, missing_docs, reason = "a benchmark that cannot solve its problem must stop")]

#[path = "../tests/motion_cell/mod.rs"]
mod motion_cell;

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use handeye::calibrate::motion::pair::chosen;
use handeye::calibrate::motion::pose::{Information, PosePair};
use handeye::calibrate::motion::{refined, solve};
use handeye::calibrate::{ClosedForm, MotionProblem, Reading};
use motion_cell::Cell;

const SIZES: [usize; 2] = [30, 500];

fn problem(num_poses: usize, is_stated: bool) -> MotionProblem {
    Cell { num_poses, is_stated, ..Cell::default() }.simulate(1).problem
}

fn refinement(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("motion");
    for num_poses in SIZES {
        for (name, is_stated) in [("refined, noise stated", true), ("refined, noise found", false)] {
            let problem = problem(num_poses, is_stated);
            group.bench_function(BenchmarkId::new(name, num_poses), |bencher| {
                bencher.iter(|| refined(black_box(&problem)).expect("solved"));
            });
        }
        let problem = problem(num_poses, false);
        group.bench_function(BenchmarkId::new("whole solution", num_poses), |bencher| {
            bencher.iter(|| solve(black_box(&problem)).expect("solved"));
        });
    }
    group.finish();
}

fn closed_forms(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("closed form");
    for num_poses in SIZES {
        let poses: Vec<PosePair> = problem(num_poses, true)
            .stations
            .iter()
            .map(|station| {
                let capture = &station.captures[0];
                let Reading::Pose(seen) = &capture.reading else { panic!("a pose") };
                PosePair {
                    station: station.idx,
                    base_from_flange: *capture.base_from_flange.rigid(),
                    sensor_from_target: *seen.rigid(),
                    information: Information::by_lever(100.0),
                }
            })
            .collect();
        for form in ClosedForm::ALL {
            group.bench_function(BenchmarkId::new(form.id(), num_poses), |bencher| {
                bencher.iter(|| form.solve(black_box(&poses), &chosen(&poses)).expect("solved"));
            });
        }
    }
    group.finish();
}

criterion_group!(benches, refinement, closed_forms);
criterion_main!(benches);
