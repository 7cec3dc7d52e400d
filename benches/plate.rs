//! How near each method for the plate comes to the truth: `cargo bench --bench plate`.
//!
//! Prints the tables of `docs/plate.md`. Seeds are fixed, so anyone gets the same figures.
#![allow(clippy::expect_used, reason = "a benchmark that cannot run must stop")]

#[path = "../tests/plate_cell/mod.rs"]
mod plate_cell;

use std::time::Instant;

use handeye::calibrate::plate::{nine_elements, solve};
use handeye::calibrate::{Method, Problem};
use handeye::geometry::stats;
use handeye::scene::random::Random;
use plate_cell::{Cell, bound_mm2, error, simulated, simulated_tip};

const NUM_SEEDS: u64 = 1000;

fn main() {
    // `cargo test --benches` and `cargo bench` pass flags of their harness; only the latter asks for the tables.
    if !std::env::args().any(|argument| argument == "--bench") {
        return;
    }
    let cell = Cell::default();
    let robot = Cell { position_std_mm: 0.02, orientation_std_deg: 0.005, ..cell };
    let in_base = Cell { point_std_mm: 0.0, position_std_mm: 0.03, ..cell };
    println!("{NUM_SEEDS} seeds, N = 9 an edge, orientations within ±20°, start 10° and 20 mm off\n");
    println!(
        "| cell | method | translation, median / mm | RMS / mm | largest / mm | rotation, median / ° | error over σ | within the 95 % |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- | --- |");
    for (name, cell) in [
        ("sensor 0.03 mm, line square to the edge", cell),
        ("position 0.03 mm, square", in_base),
        ("sensor 0.03 mm, robot 0.02 mm / 0.005°, square", robot),
        ("the same, line at 45° to the edge", Cell { line_to_edge_deg: 45.0, ..robot }),
        ("sensor 0.03 mm, line at 45°", Cell { line_to_edge_deg: 45.0, ..cell }),
        ("position 0.03 mm, line at 45°", Cell { line_to_edge_deg: 45.0, ..in_base }),
        (
            "sensor 0.01 mm, robot 0.005 mm / 0.02°, line at 45°",
            Cell {
                point_std_mm: 0.01,
                position_std_mm: 0.005,
                orientation_std_deg: 0.02,
                line_to_edge_deg: 45.0,
                ..cell
            },
        ),
        ("the third with 20 an edge", Cell { num_points: [20, 20], ..robot }),
    ] {
        let medians_mm = Method::PLATE.map(|method| print_method(name, &cell, method));
        let bound_mm = print_bound(name, &cell);
        let [ours, bound] = [medians_mm[1], bound_mm].map(|median_mm| median_mm / medians_mm[0]);
        println!("|  | *ours, and the bound, over published* | {ours:.3}, {bound:.3} | | | | | |");
    }
    print_tip(&robot);
    print_nine_elements(&cell);
    print_starts(&Cell { rough_off: None, ..robot });
}

fn print_method(name: &str, cell: &Cell, method: Method) -> f64 {
    let (mut errors_mm, mut errors_deg, mut squares, mut num_within) = (Vec::new(), Vec::new(), [0.0; 2], 0.0);
    for seed in 1..=NUM_SEEDS {
        let simulated = simulated(cell, seed);
        let solution = solve(&simulated.problem, method).expect("a solution");
        let (error_mm, error_deg) = error(&solution.flange_from_sensor, &simulated.flange_from_sensor);
        errors_mm.push(error_mm);
        errors_deg.push(error_deg);
        let known = solution.uncertainty.expect("something is left over");
        let point = known.reference_point_in_sensor_mm;
        let truth = simulated.flange_from_sensor.transform_point(&point.into()).coords;
        let off_mm = (solution.flange_from_sensor.map_point(point) - truth).norm();
        num_within += if off_mm < known.workspace_point_95_mm { 1.0 } else { 0.0 };
        squares[0] += off_mm.powi(2);
        squares[1] += known.workspace_point_std_mm.powi(2);
    }
    let rms_mm = stats::rms(errors_mm.iter().copied());
    let median_mm = stats::median(&mut errors_mm);
    #[expect(clippy::cast_precision_loss, reason = "a small count")]
    let percent = 100.0 * num_within / NUM_SEEDS as f64;
    println!(
        "| {name} | {} | {median_mm:.3} | {rms_mm:.3} | {:.2} | {:.4} | {:.2} | {percent:.1} % |",
        method.id(),
        stats::max(errors_mm.iter().copied()),
        stats::median(&mut errors_deg),
        (squares[0] / squares[1]).sqrt()
    );
    median_mm
}

/// What the Cramér–Rao bound leaves: the median over draws from the distribution that it allows each seed.
fn print_bound(name: &str, cell: &Cell) -> f64 {
    const DRAWS: u64 = 20;
    let (mut errors_mm, mut variances_mm2) = (Vec::new(), 0.0);
    for seed in 1..=NUM_SEEDS {
        let covariance = bound_mm2(cell, &simulated(cell, seed));
        let factor = covariance.cholesky().expect("a covariance").l();
        let mut random = Random::new(seed, 3);
        errors_mm.extend((0..DRAWS).map(|_| (factor * random.normal3()).norm()));
        variances_mm2 += covariance.trace();
    }
    let median_mm = stats::median(&mut errors_mm);
    #[expect(clippy::cast_precision_loss, reason = "a small count")]
    let rms_mm = (variances_mm2 / NUM_SEEDS as f64).sqrt();
    println!("| {name} | *the bound* | {median_mm:.3} | {rms_mm:.3} | | | | |");
    median_mm
}

/// The paper's comparison: as many readings of one tip.
fn print_tip(cell: &Cell) {
    let cell = Cell { num_points: [18, 0], ..*cell };
    let (mut errors_mm, mut errors_deg) = (Vec::new(), Vec::new());
    for seed in 1..=NUM_SEEDS {
        let (tip, flange_from_sensor) = simulated_tip(&cell, seed);
        let solution = Problem::Point(tip).solve(Method::FixedPoint).expect("a solution");
        let (error_mm, error_deg) = error(&solution.flange_from_sensor, &flange_from_sensor);
        errors_mm.push(error_mm);
        errors_deg.push(error_deg);
    }
    let (largest_mm, median_mm) = (stats::max(errors_mm.iter().copied()), stats::median(&mut errors_mm));
    println!(
        "| the third, a tip seen from 18 poses | fixed-point | {median_mm:.3} | | {largest_mm:.2} | {:.4} | | |",
        stats::median(&mut errors_deg)
    );
}

/// The paper's nine elements with the constraint that it forgot and without it.
fn print_nine_elements(cell: &Cell) {
    const NUM_SEEDS: u64 = 100;
    println!(
        "\n| nine elements ({NUM_SEEDS} seeds) | settled | columns off 90°, median | translation, median / mm | largest / mm |"
    );
    println!("| --- | --- | --- | --- | --- |");
    for (name, with_right_angle) in [("with c1·c3 = 0", true), ("as printed, without", false)] {
        let (mut off_deg, mut errors_mm, mut settled) = (Vec::new(), Vec::new(), 0);
        for seed in 1..=NUM_SEEDS {
            let simulated = simulated(cell, seed);
            let Ok(found) = nine_elements::solve(&simulated.problem, with_right_angle) else { continue };
            settled += usize::from(found.converged);
            off_deg.push((found.between_columns_rad.to_degrees() - 90.0).abs());
            errors_mm.push(error(&found.flange_from_sensor, &simulated.flange_from_sensor).0);
        }
        let largest_mm = stats::max(errors_mm.iter().copied());
        println!(
            "| {name} | {settled} | {:.4}° | {:.3} | {largest_mm:.2} |",
            stats::median(&mut off_deg),
            stats::median(&mut errors_mm)
        );
    }
}

/// How many of the starts without a rough mounting lead to the solution, and how long a solve takes.
fn print_starts(cell: &Cell) {
    const NUM_SEEDS: u64 = 200;
    println!(
        "\n| without a rough mounting ({NUM_SEEDS} seeds) | starts that agree, mean | least | gross | ms a solve |"
    );
    println!("| --- | --- | --- | --- | --- |");
    for method in Method::PLATE {
        let (mut agreed, mut least, mut gross) = (0, usize::MAX, 0);
        let begin = Instant::now();
        for seed in 1..=NUM_SEEDS {
            let simulated = simulated(cell, seed);
            let solution = solve(&simulated.problem, method).expect("a solution");
            let plate = solution.plate.expect("a plate");
            agreed += plate.starts.num_agreed;
            least = least.min(plate.starts.num_agreed);
            let corner = plate.base_from_plate.translation.vector - simulated.base_from_plate.translation.vector;
            let (_, error_deg) = error(&solution.flange_from_sensor, &simulated.flange_from_sensor);
            gross += usize::from(error_deg > 5.0 || corner.norm() > 30.0);
        }
        #[expect(clippy::cast_precision_loss, reason = "small counts")]
        let (mean, ms) = (agreed as f64 / NUM_SEEDS as f64, begin.elapsed().as_secs_f64() * 1e3 / NUM_SEEDS as f64);
        println!("| {} | {mean:.1} of 24 | {least} | {gross} | {ms:.1} |", method.id());
    }
}
