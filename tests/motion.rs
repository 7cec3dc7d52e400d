//! The hand-eye calibration from motions: how near to the truth, how near to the bound, and what is wrong with bad data.
#![expect(clippy::expect_used, reason = "a test that cannot solve its problem must fail")]

mod motion_cell;

use handeye::calibrate::Mount;
use handeye::calibrate::motion::refined;
use handeye::geometry::{Rigid, se3};
use motion_cell::{Cell, Simulated};
use nalgebra::{Matrix6, Vector6};

/// The error of a calibration: rotation about the sensor's axes, translation along them.
fn error(simulated: &Simulated, found: &Rigid) -> Vector6<f64> {
    se3::log(&(simulated.truth.flange_from_sensor.inverse() * found))
}

fn square(covariance: &Matrix6<f64>, error: &Vector6<f64>) -> f64 {
    error.dot(&(covariance.try_inverse().expect("a covariance") * error))
}

#[test]
fn a_thousand_trials_reach_the_bound_without_a_gross_failure() {
    const NUM_TRIALS: u64 = 1000;
    let (mut squares, mut count) = (0.0, 0_u32);
    let mut worst = 0.0_f64;
    for seed in 0..NUM_TRIALS {
        let num_poses = [10, 20, 50, 100][usize::try_from(seed % 4).expect("small")];
        let mount = if seed % 8 < 4 { Mount::OnFlange } else { Mount::Fixed };
        let simulated = Cell { num_poses, mount, ..Cell::default() }.simulate(seed);
        let found = refined(&simulated.problem).expect("solved");
        let square = square(&simulated.bound, &error(&simulated, &found)) / 6.0;
        worst = worst.max(square);
        squares += square;
        count += 1;
    }
    let efficiency = (squares / f64::from(count)).sqrt();
    // Six thousand squares of unit variance scatter by 1 % in their root mean.
    assert!(efficiency < 1.03, "{efficiency}");
    assert!(worst.sqrt() < 3.5, "{worst}");
}
