//! Is the stated uncertainty that of the errors, and could any estimator do better? `cargo bench --bench uncertainty`.
//!
//! Prints the tables of `docs/uncertainty.md`. Seeds are fixed, so anyone gets the same figures.
#![allow(clippy::expect_used, reason = "a benchmark that cannot run must stop")]

use handeye::calibrate::observation::{NUM_UNKNOWNS, State};
use handeye::calibrate::solver::{Hessian, covariance_for_unit_noise};
use handeye::calibrate::{Method, solve};
use handeye::geometry::so3::hat;
use handeye::geometry::{Mat3, Vec3, stats};
use handeye::session::{Reading, Session, ball_problem, measure};
use handeye::simulate::{SimulationOptions, simulate};
use handeye::watch::Unwatched;
use nalgebra::SMatrix;

const NUM_SEEDS: u64 = 400;

fn main() {
    // `cargo test --benches` and `cargo bench` pass flags of their harness; only the latter asks for the tables.
    if !std::env::args().any(|argument| argument == "--bench") {
        return;
    }
    println!("### Bundle, {NUM_SEEDS} seeds each, 800 points a profile, sensor 0.01 mm\n");
    println!(
        "| stations × captures | robot | its noise is | error, RMS / mm | over the bound | over stated σ | 95 % ellipsoid | 95 % ball |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- | --- |");
    for (num_stations, num_steps) in [(20, 1), (20, 21), (10, 21), (8, 1)] {
        for (position_std_mm, orientation_std_deg) in [(0.02, 0.005), (0.05, 0.02)] {
            for is_stated in [true, false] {
                print_row(
                    &SimulationOptions {
                        num_stations,
                        num_steps,
                        position_std_mm,
                        orientation_std_deg,
                        ..SimulationOptions::default()
                    },
                    is_stated,
                );
            }
        }
    }
}

fn print_row(options: &SimulationOptions, is_stated: bool) {
    let (mut errors, mut bounds, mut stated) = (Vec::new(), Vec::new(), Vec::new());
    let (mut in_ellipsoid, mut in_ball) = (0_u32, 0_u32);
    for seed in 1..=NUM_SEEDS {
        let mut session = simulate(&SimulationOptions { seed, ..options.clone() });
        if !is_stated {
            session.robot.position_std_mm = None;
            session.robot.orientation_std_deg = None;
        }
        let measured = measure(&session, None, &mut Unwatched).expect("not cancelled");
        let problem = ball_problem(&session, &measured).expect("a ball");
        let solution = solve(&problem, Method::BallBundle).expect("solved");
        let known = solution.uncertainty.as_ref().expect("redundant");
        let truth = session.truth.as_ref().expect("simulated");
        let point = known.reference_point_in_sensor_mm;
        let error = solution.flange_from_sensor.map_point(point) - truth.flange_from_sensor.map_point(point);
        let inverse = known.workspace_point_covariance.try_inverse().expect("regular");
        let limit = 3.0 * stats::f_quantile(0.95, 3.0, known.degrees_of_freedom);
        in_ellipsoid += u32::from(error.dot(&(inverse * error)) <= limit);
        in_ball += u32::from(error.norm() <= known.workspace_point_95_mm);
        errors.push(error.norm());
        stated.push(known.workspace_point_std_mm);
        bounds.push(bound_mm(&session, options, point));
    }
    let error_mm = stats::rms(errors.iter().copied());
    let percent = |count: u32| 100.0 * f64::from(count) / f64::from(u32::try_from(NUM_SEEDS).expect("few"));
    println!(
        "| {} × {} | {} mm, {}° | {} | {error_mm:.4} | {:.3} | {:.3} | {:.1} % | {:.1} % |",
        options.num_stations,
        options.num_steps,
        options.position_std_mm,
        options.orientation_std_deg,
        if is_stated { "stated" } else { "estimated" },
        error_mm / stats::rms(bounds),
        error_mm / stats::rms(stated),
        percent(in_ellipsoid),
        percent(in_ball),
    );
}

/// The Cramér–Rao bound of the workspace point, from the truth and the noise that was simulated: no unbiased estimator has
/// a smaller RMS error. Computed from how z of every point follows the ball's centre, not from the program's own sums.
fn bound_mm(session: &Session, options: &SimulationOptions, point_in_sensor: Vec3) -> f64 {
    let truth = session.truth.as_ref().expect("simulated");
    let state = State { flange_from_sensor: *truth.flange_from_sensor.rigid(), ball_in_base: truth.target_in_base_mm };
    let sensor_from_flange = state.flange_from_sensor.rotation.to_rotation_matrix().into_inner().transpose();
    let mut information = Hessian::zeros();
    for capture in session.stations.iter().flat_map(|station| &station.captures) {
        let base_from_flange = capture.base_from_flange.rigid();
        let (centre, sensor_from_base) = state.ball_in_sensor_and_rotation(base_from_flange);
        let Reading::Profile(profile) = &capture.reading else { continue };
        let mut of_points = Mat3::zeros();
        for (_, x, _) in profile.valid_points() {
            let dx = x - centre.x;
            let height = (options.radius_mm.powi(2) - centre.y * centre.y - dx * dx).max(1e-6).sqrt();
            let slope = Vec3::new(-dx / height, centre.y / height, 1.0);
            of_points += slope * slope.transpose() / options.profile_std_mm.powi(2);
        }
        let lever =
            sensor_from_flange * hat(base_from_flange.inverse_transform_point(&state.ball_in_base.into()).coords);
        let of_pose = Mat3::identity() * options.position_std_mm.powi(2)
            + lever * lever.transpose() * options.orientation_std_deg.to_radians().powi(2);
        let weight = (Mat3::identity() + of_points * of_pose).try_inverse().expect("regular") * of_points;
        let mut jacobian = SMatrix::<f64, 3, NUM_UNKNOWNS>::zeros();
        jacobian.fixed_view_mut::<3, 3>(0, 0).copy_from(&hat(centre));
        jacobian.fixed_view_mut::<3, 3>(0, 3).copy_from(&-Mat3::identity());
        jacobian.fixed_view_mut::<3, 3>(0, 6).copy_from(&sensor_from_base);
        information += jacobian.transpose() * weight * jacobian;
    }
    let covariance = covariance_for_unit_noise(&information).expect("determined");
    let mut by_unknowns = SMatrix::<f64, 3, NUM_UNKNOWNS>::zeros();
    by_unknowns.fixed_view_mut::<3, 3>(0, 0).copy_from(&-hat(point_in_sensor));
    by_unknowns.fixed_view_mut::<3, 3>(0, 3).copy_from(&Mat3::identity());
    (by_unknowns * covariance * by_unknowns.transpose()).trace().sqrt()
}
