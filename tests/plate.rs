//! The methods for the plate and the tip against a known truth.
#![expect(clippy::expect_used, reason = "a test that cannot solve must fail")]

mod plate_cell;

use handeye::calibrate::Method;
use handeye::calibrate::plate::solve;
use plate_cell::{Cell, error, simulated, simulated_tip};

/// What double precision leaves of 600 mm after a solve.
const EXACT_MM: f64 = 1e-6;
const EXACT_DEG: f64 = 1e-7;

#[test]
fn noise_free_points_give_the_truth() {
    let exact = Cell { point_std_mm: 0.0, ..Cell::default() };
    for seed in 1..=20 {
        for method in Method::PLATE {
            let simulated = simulated(&exact, seed);
            let solution = solve(&simulated.problem, method).expect("a solution");
            let (error_mm, error_deg) = error(&solution.flange_from_sensor, &simulated.flange_from_sensor);
            assert!(error_mm < EXACT_MM && error_deg < EXACT_DEG, "{method:?} {seed}: {error_mm} mm, {error_deg}°");
            let corner = solution.target_in_base_mm - simulated.base_from_plate.translation.vector;
            assert!(corner.norm() < EXACT_MM, "{method:?} {seed}: corner {}", corner.norm());
        }
        let (tip, flange_from_sensor, _) = simulated_tip(&exact, seed);
        let solution = tip.solve(Method::FixedPoint).expect("a solution");
        let (error_mm, error_deg) = error(&solution.flange_from_sensor, &flange_from_sensor);
        assert!(error_mm < EXACT_MM && error_deg < EXACT_DEG, "tip {seed}: {error_mm} mm, {error_deg}°");
    }
}

#[test]
fn experiment() {
    for (name, cell) in [("rough", Cell::default()), ("none", Cell { rough_off: None, ..Cell::default() })] {
        for method in Method::PLATE {
            let (mut errors, mut gross, mut agreed, mut other, mut sigma) = (Vec::new(), 0, 0, 0, Vec::new());
            for seed in 1..=200 {
                let simulated = simulated(&cell, seed);
                let Ok(solution) = solve(&simulated.problem, method) else {
                    gross += 1;
                    continue;
                };
                let (error_mm, error_deg) = error(&solution.flange_from_sensor, &simulated.flange_from_sensor);
                if error_mm > 5.0 || error_deg > 2.0 {
                    gross += 1;
                }
                errors.push(error_mm);
                agreed += solution.plate.as_ref().expect("plate").starts.num_agreed;
                other += usize::from(solution.warnings.iter().any(|w| w.code() == "other-minimum"));
                if let Some(known) = &solution.uncertainty {
                    let r = known.reference_point_in_sensor_mm;
                    let e = (solution.flange_from_sensor.map_point(r)
                        - simulated.flange_from_sensor.transform_point(&r.into()).coords)
                        .norm();
                    sigma.push((e * e, known.workspace_point_std_mm.powi(2)));
                }
            }
            errors.sort_by(f64::total_cmp);
            let (a, b): (f64, f64) = sigma.iter().fold((0.0, 0.0), |s, x| (s.0 + x.0, s.1 + x.1));
            println!(
                "{name} {} median {:.4} max {:.3} gross {gross} agreed {:.2} other {other} err/sigma {:.3}",
                method.id(),
                errors[errors.len() / 2],
                errors[errors.len() - 1],
                agreed as f64 / 200.0,
                (a / b).sqrt()
            );
        }
    }
}
