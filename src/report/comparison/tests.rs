//! The comparison's model against solutions made by hand.

use nalgebra::{Matrix6, UnitQuaternion, Vector6};

use super::*;
use crate::calibrate::observation::State;
use crate::calibrate::solver::Hessian;
use crate::calibrate::{Reduced, RmsMax, Side, SolveError, Uncertainty, Warning};
use crate::geometry::{Mat3, Rigid, Transform};
use crate::session::model::UnknownFields;
use crate::session::{Known, Robot, Sensor, Station, Target, Truth};

fn session() -> Session {
    let station = |label: &str| Station {
        label: label.to_owned(),
        enabled: true,
        side: crate::calibrate::SideChoice::Auto,
        edge: None,
        captures: Vec::new(),
        unknown: UnknownFields::new(),
    };
    Session {
        name: "hand-made".to_owned(),
        notes: String::new(),
        robot: Robot::default(),
        sensor: Sensor::default(),
        target: Target::ball(15.0),
        known: Known::default(),
        mount: Mount::OnFlange,
        further: Vec::new(),
        stations: ["a", "b", "c"].map(station).to_vec(),
        published: None,
        truth: Some(Truth {
            flange_from_sensor: Transform::identity(),
            target_in_base_mm: Vec3::zeros(),
            base_from_plate: None,
            base_from_target: None,
            unknown: UnknownFields::new(),
        }),
        unknown: UnknownFields::new(),
    }
}

fn solution(method: Method, shift_mm: f64, errors_mm: &[Vec3]) -> Solution {
    let mean: Vec3 = errors_mm.iter().sum::<Vec3>() / 3.0;
    Solution {
        method,
        mount: Mount::OnFlange,
        flange_from_sensor: Transform::from_parts(Vec3::new(shift_mm, 0.0, 0.0), UnitQuaternion::identity()),
        target_in_base_mm: Vec3::zeros(),
        scatter: RmsMax::default(),
        leave_one_out: Some(RmsMax { rms_mm: 0.05, max_mm: 0.08 }),
        uncertainty: Some(Uncertainty {
            covariance: Matrix6::identity(),
            translation_std_mm: Vec3::zeros(),
            rotation_std_rad: Vec3::zeros(),
            workspace_point_std_mm: 0.06,
            reference_point_in_sensor_mm: Vec3::new(0.0, 0.0, 60.0),
            workspace_point_covariance: Mat3::identity() * 0.0012,
            degrees_of_freedom: f64::INFINITY,
            workspace_point_95_mm: 0.1,
        }),
        // Station b is missing, as if it had been skipped.
        stations: [0, 2]
            .into_iter()
            .zip(errors_mm)
            .map(|(station_idx, error)| StationSolution {
                station_idx,
                label: String::new(),
                side: Side::Plus,
                side_cost_ratio: None,
                target_in_sensor_mm: Vec3::zeros(),
                target_in_sensor_std_mm: None,
                target_in_base_mm: *error,
                error_from_first_mm: *error,
                error_from_mean_mm: error - mean,
                leave_one_out_mm: None,
                sweep: None,
            })
            .collect(),
        rotation_span_rad: 1.0,
        warnings: vec![Warning::FewStations { num_stations: 2, recommended: 8 }],
        num_iterations: 3,
        noise: None,
        radius: None,
        reduced: Some(Reduced {
            observations: Vec::new(),
            common_covariance: Vec::new(),
            num_stations: 2,
            state: State { flange_from_sensor: Rigid::identity(), ball_in_base: Vec3::zeros() },
            hessian: Hessian::identity(),
            prior_information: 0.0,
            variance_factor: None,
        }),
        plate: None,
        motion: None,
        change_by_radius: Vector6::zeros(),
        workspace_point_by_radius: Vec3::zeros(),
    }
}

fn results() -> Vec<MethodResult> {
    let errors = |size: f64| [Vec3::zeros(), Vec3::new(size, -size / 2.0, 0.0)];
    let ok = |method, shift, size| MethodResult { method, outcome: Ok(solution(method, shift, &errors(size))) };
    vec![
        ok(Method::BallFixedPoint, 0.3, 0.2),
        MethodResult {
            method: Method::BallMaxArcStep,
            outcome: Err(SolveError::TooFewSweeps { found: 0, needed: 3, steps: 3, refusal: None }),
        },
        ok(Method::BallMaxArc, 0.1, 0.05),
    ]
}

#[test]
fn rows_are_matched_by_the_stations_index() {
    let model = Comparison::new(&session(), &results());
    let table = model.columns[0].outcome.as_ref().expect("a table");
    let used: Vec<bool> = table.rows.iter().map(|row| row.used.is_some()).collect();
    assert_eq!(used, [true, false, true]);
    assert!((table.max_error_mm(ErrorReference::FirstStation) - 0.2).abs() < 1e-12);
    let truth = table.truth.expect("a simulated session");
    assert!((truth.workspace_point_mm - 0.3).abs() < 1e-12 && truth.rotation_rad.abs() < 1e-12);
}

#[test]
fn the_columns_keep_the_papers_order_and_say_why_one_is_empty() {
    let model = Comparison::new(&session(), &results());
    let methods: Vec<Method> = model.columns.iter().map(|column| column.method).collect();
    assert_eq!(methods, [Method::BallFixedPoint, Method::BallMaxArc, Method::BallMaxArcStep]);
    let reason = SolveError::TooFewSweeps { found: 0, needed: 3, steps: 3, refusal: None }.to_string();
    assert_eq!(model.columns[2].outcome.as_ref().expect_err("refused"), &reason);
}

#[test]
fn differences_go_from_each_method_to_the_next() {
    let differences = Comparison::new(&session(), &results()).differences;
    assert_eq!(differences.len(), 1);
    assert!((differences[0].difference.workspace_point_mm - 0.2).abs() < 1e-12);
    let in_stds = differences[0].difference.in_stds.expect("both have uncertainties");
    assert!((in_stds - 0.2 / (0.06 * 2.0_f64.sqrt())).abs() < 1e-9);
}

#[test]
fn without_results_there_is_nothing_to_show() {
    let model = Comparison::new(&session(), &[]);
    assert!(model.columns.is_empty() && model.differences.is_empty());
}

/// A simulated session of a target, with what its methods make of it.
fn solved(kind: crate::scene::PartKind) -> (Session, Vec<MethodResult>) {
    use crate::simulate::{SimulationOptions, SimulationTarget, simulate};
    let session =
        simulate(&SimulationOptions { num_points: 200, ..SimulationOptions::of(SimulationTarget::Part(kind)) });
    let measured = crate::session::measure(&session, None, &mut crate::watch::Unwatched).expect("not cancelled");
    let problem = crate::session::problem(&session, &measured).expect("a target of methods");
    let results = problem.solve_all(problem.methods(), &mut crate::watch::Unwatched).expect("not cancelled");
    (session, results)
}

#[test]
fn a_plates_rows_are_its_points_with_their_edges() {
    let (session, results) = solved(crate::scene::PartKind::Plate);
    let model = Comparison::new(&session, &results);
    let methods: Vec<Method> = model.columns.iter().map(|column| column.method).collect();
    assert_eq!(methods, Method::PLATE);
    for column in &model.columns {
        let table = column.outcome.as_ref().expect("a table");
        assert!(table.is_of_plate);
        assert_eq!(table.rows.len(), session.num_captures());
        assert!(table.rows[0].label.ends_with(" p") && table.rows[17].label.ends_with(" q"));
        // Every point stands in the plot of its own edge.
        assert_eq!([0, 1].map(|plot| table.scatter(plot).count()), [9, 9]);
        let largest = table.used().map(|(_, used)| used.error_from_mean_mm.norm()).fold(0.0, f64::max);
        assert!((table.max_error_mm(ErrorReference::Mean) - largest).abs() < 1e-12 && largest > 0.0);
        // Off an edge there are two directions, and the third is along it.
        for (_, used) in table.used() {
            let across = used.scatter_mm.into_iter().flatten().next().expect("a plot");
            assert!((across[0].hypot(across[1]) - used.error_from_mean_mm.norm()).abs() < 1e-6, "{used:?}");
        }
    }
    let improvement = model.improvement.expect("two methods");
    assert_eq!((improvement.method, improvement.baseline), (Method::PlateBundle, Method::PlateOrthogonal));
    assert_eq!(model.differences.len(), 1);
}

#[test]
fn a_tips_table_is_that_of_its_stations() {
    let (session, results) = solved(crate::scene::PartKind::Pin);
    let model = Comparison::new(&session, &results);
    assert_eq!(model.columns.len(), 1);
    let table = model.columns[0].outcome.as_ref().expect("a table");
    assert!(!table.is_of_plate && model.improvement.is_none() && model.differences.is_empty());
    assert_eq!(table.scatter(0).count(), table.used().count());
}
