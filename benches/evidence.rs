//! The evidence of Chen et al. 2023 on their cell, simulated: `cargo bench --bench evidence`.
//!
//! Prints the tables of `docs/verify.md`. Seeds are fixed, so anyone gets the same figures.
#![allow(clippy::expect_used, reason = "a benchmark that cannot run must stop")]
#![allow(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a few hundred figures"
)]

use handeye::calibrate::{Method, Problem};
use handeye::geometry::{Flange, Sensor, Transform};
use handeye::text::method_name;
use handeye::verify::{MatrixDifference, evaluate};

use paper_cell::PaperCell;

#[path = "../tests/verify/paper_cell.rs"]
mod paper_cell;

const NUM_SEEDS: u64 = 200;
/// Poses at the tip: as many as points on the plate.
const TIP_POSES: usize = 18;
/// Rows of their Table 3.
const ROWS: usize = 5;
/// Seeds of the data that nothing is computed from.
const HELD_OUT: u64 = 10_000;

/// Figures of one seed, mm.
struct Evidence {
    own_line_mean: Option<f64>,
    line_mean: f64,
    line_max: f64,
    plane_mean: f64,
    plane_max: f64,
    three_delta: f64,
    workspace_point: f64,
}

fn main() {
    // `cargo test --benches` and `cargo bench` pass flags of their harness; only the latter asks for the tables.
    if !std::env::args().any(|argument| argument == "--bench") {
        return;
    }
    println!("### {NUM_SEEDS} seeds: 9 points an edge, {TIP_POSES} poses at the tip, {ROWS} at the touched point\n");
    for (name, tilt_deg, spin_deg) in
        [("tilted by up to 25° and turned by up to ±55°", 25.0, 55.0), ("by up to 15° and ±20°", 15.0, 20.0)]
    {
        table(name, tilt_deg, spin_deg);
    }
}

fn table(name: &str, tilt_deg: f64, spin_deg: f64) {
    println!(
        "Robot 0.02 mm and 0.005°, sensor 0.03 mm (standard deviations); {name}. Medians, in brackets the 95th percentile, mm:\n"
    );
    println!(
        "| calibration | line mean, own data | line mean | line max | plane mean | plane max | 3δ, worst axis | off the truth at 172 mm |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- | --- |");
    for method in [Method::FixedPoint, Method::PlateOrthogonal, Method::PlateBundle] {
        let found: Vec<Evidence> = (1..=NUM_SEEDS)
            .filter_map(|seed| evidence(&PaperCell { tilt_deg, spin_deg, ..PaperCell::noisy(seed) }, method))
            .collect();
        let figure = |value: &dyn Fn(&Evidence) -> Option<f64>| {
            let mut values: Vec<f64> = found.iter().filter_map(value).collect();
            values.sort_by(f64::total_cmp);
            if values.is_empty() {
                return "–".to_owned();
            }
            let at = |part: f64| values[((values.len() - 1) as f64 * part).round() as usize];
            format!("{:.3} ({:.3})", at(0.5), at(0.95))
        };
        println!(
            "| {} | {} | {} | {} | {} | {} | {} | {} |",
            method_name(method),
            figure(&|one| one.own_line_mean),
            figure(&|one| Some(one.line_mean)),
            figure(&|one| Some(one.line_max)),
            figure(&|one| Some(one.plane_mean)),
            figure(&|one| Some(one.plane_max)),
            figure(&|one| Some(one.three_delta)),
            figure(&|one| Some(one.workspace_point)),
        );
        if found.len() < NUM_SEEDS as usize {
            println!("| | not solved: {} | | | | | | |", NUM_SEEDS as usize - found.len());
        }
    }
    println!("| paper, fixed point | | | | | | 0.728 | |");
    println!("| paper, theirs | 0.117 | | 0.25 | 0.128 | 0.3 | 0.421 | |\n");
}

fn evidence(cell: &PaperCell, method: Method) -> Option<Evidence> {
    let own = if method == Method::FixedPoint { cell.tip_target(TIP_POSES) } else { cell.plate_target() };
    let solution = own.solve(method).ok()?;
    let calibration = &solution.flange_from_sensor;
    let other = PaperCell { seed: cell.seed + HELD_OUT, ..*cell };
    let mean = |problem: &Problem| line_mean(problem, calibration);
    let plate = evaluate(&other.plate_target(), calibration, None).expect("nine points an edge");
    let distances = plate.distances().expect("a plate");
    let tip = evaluate(&other.tip_target(ROWS), calibration, Some(PaperCell::tip_in_base_mm())).expect("five poses");
    let (_, stability) = tip.stability().expect("a tip");
    let middle = nalgebra::Vector3::new(0.0, 0.0, 172.0);
    Some(Evidence {
        own_line_mean: (method != Method::FixedPoint).then(|| mean(&own)),
        line_mean: distances.to_line.mean_mm,
        line_max: distances.to_line.max_mm,
        plane_mean: distances.to_plane.mean_mm,
        plane_max: distances.to_plane.max_mm,
        three_delta: stability.three_std_mm().max(),
        workspace_point: MatrixDifference::between(&PaperCell::flange_from_sensor(), calibration, middle).at_point_mm,
    })
}

fn line_mean(problem: &Problem, calibration: &Transform<Flange, Sensor>) -> f64 {
    evaluate(problem, calibration, None).expect("nine points an edge").figures.mean_mm
}
