//! The hand-eye calibration from motions: how near to the truth, how near to the bound, and what is wrong with bad data.
#![expect(clippy::expect_used, reason = "a test that cannot solve its problem must fail")]

mod motion_cell;

use handeye::calibrate::motion::{CameraPose, StreamProblem, Weighing, refined, solve_streams};
use handeye::calibrate::{Mount, Noise};
use handeye::geometry::so3::exp;
use handeye::geometry::{Rigid, Transform, Vec3, se3};
use handeye::scene::random::Random;
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

/// A robot that moves smoothly, its camera with a clock of its own; the camera's poses drift, or are those of a target.
fn streams(seed: u64, lag_s: f64, weighing: Weighing, mount: Mount) -> (StreamProblem, Rigid) {
    const STEP_STD: [f64; 2] = [5e-4, 0.3];
    let mut random = Random::new(seed, 3);
    let truth = motion_cell::truth(&mut random);
    let sensor = truth.flange_from_sensor;
    let path = |time_s: f64| {
        let turn = Vec3::new(
            0.5 * (0.9 * time_s).sin(),
            0.45 * (0.7 * time_s + 1.0).sin() + 0.1 * (2.3 * time_s).cos(),
            0.6 * (0.5 * time_s + 2.0).sin(),
        );
        let place =
            Vec3::new(500.0 + 80.0 * (0.6 * time_s).sin(), 60.0 * (0.8 * time_s).cos(), 400.0 + 40.0 * time_s.sin());
        Rigid::from_parts(place.into(), exp(turn) * exp(Vec3::x() * 3.0))
    };
    let noisy = |pose: Rigid, std: [f64; 2], random: &mut Random| {
        pose * Rigid::from_parts((random.normal3() * std[1]).into(), exp(random.normal3() * std[0]))
    };
    let flange = (0..2000)
        .map(|idx| {
            let time_s = f64::from(idx) * 0.016;
            (time_s, Transform::from_rigid(noisy(path(time_s), [1e-5, 0.005], &mut random)))
        })
        .collect();
    // For a fixed camera the "world" is on the flange, and what moves is the flange in the camera.
    let world_from_sensor = |time_s: f64| match mount {
        Mount::OnFlange => truth.base_from_target.inverse() * path(time_s) * sensor,
        Mount::Fixed => truth.base_from_target.inverse() * path(time_s).inverse() * sensor,
    };
    let mut drifted = world_from_sensor(1.0 + lag_s);
    let mut before = drifted;
    let camera = (0..290)
        .map(|idx| {
            let time_s = 1.0 + f64::from(idx) * 0.1;
            let here = world_from_sensor(time_s + lag_s);
            let step = before.inverse() * here;
            before = here;
            let pose = match weighing {
                Weighing::Drifting => {
                    drifted = noisy(drifted * step, STEP_STD, &mut random);
                    drifted
                }
                Weighing::Independent => noisy(here, STEP_STD, &mut random),
            };
            CameraPose { time_s, world_from_sensor: Transform::from_rigid(pose), step_covariance: None }
        })
        .collect();
    let problem = StreamProblem {
        mount,
        noise: Noise { position_std_mm: Some(0.005), orientation_std_rad: Some(1e-5) },
        reference_distance_mm: Some(500.0),
        flange,
        camera,
        weighing,
        find_offset: true,
    };
    (problem, sensor)
}

#[test]
fn streams_are_matched_in_time_and_the_stated_sigmas_are_those_of_the_errors() {
    for (weighing, mount) in [
        (Weighing::Drifting, Mount::OnFlange),
        (Weighing::Drifting, Mount::Fixed),
        (Weighing::Independent, Mount::OnFlange),
        (Weighing::Independent, Mount::Fixed),
    ] {
        let (mut of_sensor, mut of_time, mut count) = (0.0, 0.0, 0.0);
        for seed in 0..12_u32 {
            let lag_s = 0.05 * f64::from(seed) - 0.2;
            let (problem, truth) = streams(u64::from(seed), lag_s, weighing, mount);
            let solution = solve_streams(&problem).expect("solved");
            let known = solution.uncertainty.as_ref().expect("redundant");
            let motion = solution.motion.as_ref().expect("a motion");
            let offset = motion.time_offset.expect("sought");
            let std_s = offset.std_s.expect("found");
            let point = known.reference_point_in_sensor_mm;
            let off = solution.flange_from_sensor.map_point(point) - (truth * nalgebra::Point3::from(point)).coords;
            of_sensor += (off.norm() / known.workspace_point_std_mm).powi(2);
            of_time += ((offset.offset_s - lag_s) / std_s).powi(2);
            count += 1.0;
        }
        // Twelve trials of three coordinates, and of one: their mean squares scatter by a quarter and by two fifths.
        assert!((0.4..2.0).contains(&(of_sensor / count)), "{weighing:?} {mount:?}: {}", of_sensor / count);
        assert!((0.2..2.6).contains(&(of_time / count)), "{weighing:?} {mount:?}: {}", of_time / count);
    }
}
