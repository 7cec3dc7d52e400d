//! The hand-eye calibration from motions: how near every form and the refined answer come to the bound (the table of
//! `docs/motion.md`), and the time of each.
//!
//! Seeds are fixed, so anyone gets the same table.
#![expect(clippy::expect_used, reason = "a benchmark that cannot solve its problem must stop")]

#[path = "../tests/motion_cell/mod.rs"]
mod motion_cell;

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, criterion_group};
use handeye::calibrate::motion::pair::chosen;
use handeye::calibrate::motion::pose::{Information, PosePair};
use handeye::calibrate::motion::{refined, solve};
use handeye::calibrate::{ClosedForm, MotionProblem, Reading, Station};
use handeye::geometry::{Rigid, se3};
use motion_cell::{Cell, Simulated};

const SIZES: [usize; 2] = [30, 500];

fn problem(num_poses: usize, is_stated: bool) -> MotionProblem {
    Cell { num_poses, is_stated, ..Cell::default() }.simulate(1).problem
}

fn poses(problem: &MotionProblem) -> Vec<PosePair> {
    let pose = |station: &Station| {
        let capture = &station.captures[0];
        let Reading::Pose(seen) = &capture.reading else { panic!("a pose") };
        PosePair {
            station: station.idx,
            base_from_flange: *capture.base_from_flange.rigid(),
            sensor_from_target: *seen.rigid(),
            information: Information::by_lever(100.0),
        }
    };
    problem.stations.iter().map(pose).collect()
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
        let poses = poses(&problem(num_poses, true));
        for form in ClosedForm::ALL {
            group.bench_function(BenchmarkId::new(form.id(), num_poses), |bencher| {
                bencher.iter(|| form.solve(black_box(&poses), &chosen(&poses)).expect("solved"));
            });
        }
    }
    group.finish();
}

/// Root mean square of the errors over the bound, and the largest.
#[derive(Clone, Copy, Default)]
struct Efficiency {
    squares: f64,
    count: f64,
    largest: f64,
}

impl Efficiency {
    fn add(&mut self, simulated: &Simulated, found: &Rigid) {
        let error = se3::log(&(simulated.truth.flange_from_sensor.inverse() * found));
        let square = error.dot(&(simulated.bound.try_inverse().expect("a covariance") * error)) / 6.0;
        self.squares += square;
        self.count += 1.0;
        self.largest = self.largest.max(square.sqrt());
    }

    fn cells(&self) -> String {
        format!("{:.2} ({:.1})", (self.squares / self.count).sqrt(), self.largest)
    }
}

fn accuracy() {
    const NUM_TRIALS: u64 = 1000;
    const SIZES: [usize; 3] = [10, 30, 100];
    let mut of_forms = [[Efficiency::default(); 3]; 7];
    let mut of_refined = [[Efficiency::default(); 3]; 2];
    for (column, num_poses) in SIZES.into_iter().enumerate() {
        for seed in 0..NUM_TRIALS {
            let simulated = Cell { num_poses, ..Cell::default() }.simulate(seed);
            let poses = poses(&simulated.problem);
            let pairs = chosen(&poses);
            for (form, row) in ClosedForm::ALL.into_iter().zip(&mut of_forms) {
                if let Some(found) = form.solve(&poses, &pairs) {
                    row[column].add(&simulated, &found);
                }
            }
            let unstated = Cell { num_poses, is_stated: false, ..Cell::default() }.simulate(seed);
            for (simulated, row) in [&simulated, &unstated].into_iter().zip(&mut of_refined) {
                row[column].add(simulated, &refined(&simulated.problem).expect("solved"));
            }
        }
    }
    println!("{NUM_TRIALS} trials each: error over the bound, RMS (largest)\n");
    println!("| | N = 10 | N = 30 | N = 100 |\n| --- | --- | --- | --- |");
    let row = |name: &str, row: &[Efficiency; 3]| {
        println!("| {name} | {} |", row.each_ref().map(Efficiency::cells).join(" | "));
    };
    for (form, of_form) in ClosedForm::ALL.into_iter().zip(&of_forms) {
        row(form.id(), of_form);
    }
    row("**refined**, noise stated", &of_refined[0]);
    row("**refined**, noise found", &of_refined[1]);
}

criterion_group!(benches, refinement, closed_forms);

fn main() {
    // `cargo test --benches` passes other flags, and asks for no table.
    if std::env::args().any(|argument| argument == "--bench") {
        accuracy();
    }
    benches();
    Criterion::default().configure_from_args().final_summary();
}
