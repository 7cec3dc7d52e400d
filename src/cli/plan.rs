//! `handeye plan`: the stations to measure next, as poses that the controller takes.

use std::path::PathBuf;
use std::process::ExitCode;

use crate::calibrate::{BallProblem, Method, MethodResult, Problem, best_available};
use crate::diagnose::diagnose_any;
use crate::geometry::{PoseConvention, Rigid, Vec3};
use crate::plan::{Limits, Plan, RoughCell, from_nothing, next_stations};
use crate::report::digits::fixed;
use crate::report::result_file::plan_file;
use crate::session::{self, Session, measure_in, problem};
use crate::text::cli as words;
use crate::text::diagnosis::fault_message;
use crate::watch::Unwatched;

use super::{EXIT_NOTHING_COMPUTED, EXIT_WRONG_INPUT, fail, folder_of};

/// Beyond, the laser grazes what it lights.
const MAX_TILT_DEG: f64 = 80.0;

/// Arguments of `handeye plan`.
#[derive(Clone, Debug, clap::Args)]
#[command(allow_negative_numbers = true)]
pub struct PlanArgs {
    /// Session file
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// How many stations to plan
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = clap::value_parser!(u16).range(1..=100))]
    pub stations: u16,
    /// Most tilt of the range axis from the middle of the stations (of a plate: of those at the same edge), degrees
    #[arg(long, value_name = "DEG", default_value_t = Limits::default().max_tilt_deg, value_parser = tilt)]
    pub max_tilt_deg: f64,
    /// Most turn about the range axis, either way, degrees
    #[arg(long, value_name = "DEG", default_value_t = Limits::default().max_spin_deg, value_parser = spin)]
    pub max_spin_deg: f64,
    /// Least and greatest distance of the ball's centre, tip or edge along the range axis, mm; as in the session if not given
    #[arg(long, num_args = 2, value_names = ["MIN", "MAX"], value_parser = finite)]
    pub standoff_mm: Option<Vec<f64>>,
    /// How far the ball's centre, tip or edge may be from the middle of the profile, mm; as in the session if not given
    #[arg(long, value_name = "MM", value_parser = finite)]
    pub half_width_mm: Option<f64>,
    /// Where the sensor is on the flange (in the base if it stands beside the robot), roughly: mm and the robot's own angles.
    /// For a session with a ball or a tip that cannot be solved yet
    #[arg(
        long, num_args = 6, value_names = ["X", "Y", "Z", "A", "B", "C"], value_parser = finite, requires = "ball_at"
    )]
    pub sensor_at: Option<Vec<f64>>,
    /// Where the ball or tip is in the base (on the flange if the sensor stands beside the robot), roughly, mm
    #[arg(long, visible_alias = "tip-at", num_args = 3, value_names = ["X", "Y", "Z"], value_parser = finite, requires = "sensor_at")]
    pub ball_at: Option<Vec<f64>>,
    /// The direction in the base (of the flange if the sensor stands beside the robot) along which the sensor looks in the
    /// middle of all stations; with --sensor-at
    #[arg(
        long, num_args = 3, value_names = ["X", "Y", "Z"], value_parser = finite, default_values_t = [0.0, 0.0, -1.0],
        requires = "sensor_at"
    )]
    pub looks_along: Vec<f64>,
    /// Print JSON instead of a table
    #[arg(long)]
    pub json: bool,
}

/// Plans, and prints the plan.
#[must_use]
pub fn run(args: &PlanArgs) -> ExitCode {
    let session = match session::load(&args.file) {
        Ok(session) => session,
        Err(error) => return fail(EXIT_WRONG_INPUT, &error),
    };
    match planned(args, &session) {
        Ok((plan, method)) => {
            let text = if args.json {
                format!("{:#}\n", plan_file(&session, &plan, method))
            } else {
                table(&session, &plan, method)
            };
            super::print(&text).map_or_else(|exit_code| exit_code, |()| ExitCode::SUCCESS)
        }
        Err(reason) => fail(EXIT_NOTHING_COMPUTED, &reason),
    }
}

/// The plan, and the method whose solution it rests on; none for a plan from nothing.
fn planned(args: &PlanArgs, session: &Session) -> Result<(Plan, Option<Method>), String> {
    let measured =
        measure_in(folder_of(&args.file), session, &mut Unwatched).map_err(|cancelled| cancelled.to_string())?;
    let problem = problem(session, &measured).map_err(|refusal| refusal.to_string())?;
    let results = problem.solve_all(problem.methods(), &mut Unwatched).map_err(|cancelled| cancelled.to_string())?;
    let num = usize::from(args.stations);
    let limits = limits(args);
    if let Some(solution) = best_available(&results) {
        let diagnosis =
            diagnose_any(session, &problem, &results, &mut Unwatched).map_err(|cancelled| cancelled.to_string())?;
        if let Some(first) = diagnosis.findings.first().filter(|_| !diagnosis.allows_planning()) {
            return Err(words::mend_before_planning(first.fault.code(), &fault_message(&first.fault, session)));
        }
        let plan = next_stations(solution, &limits, num).map_err(|refusal| refusal.to_string())?;
        return Ok((plan, Some(solution.method)));
    }
    let nothing = || words::nothing_to_plan_from(&first_reason(&results), &session.target);
    let (Problem::Ball(problem) | Problem::Point(problem)) = &problem else { return Err(nothing()) };
    let cell = rough_cell(args, session, problem).ok_or_else(nothing)?;
    let limits = Limits { standoff_mm: limits.standoff_mm.or_else(|| standoff_about_reference(problem)), ..limits };
    let plan = from_nothing(&cell, &limits, num).map_err(|refusal| refusal.to_string())?;
    Ok((plan, None))
}

fn first_reason(results: &[MethodResult]) -> String {
    results.iter().rev().find_map(|result| result.outcome.as_ref().err()).map_or_else(String::new, ToString::to_string)
}

fn limits(args: &PlanArgs) -> Limits {
    Limits {
        max_tilt_deg: args.max_tilt_deg,
        max_spin_deg: args.max_spin_deg,
        standoff_mm: args.standoff_mm.as_deref().and_then(|range| range.try_into().ok()),
        half_width_mm: args.half_width_mm,
        ..Limits::default()
    }
}

/// A tenth of the sensor's reference distance either way.
fn standoff_about_reference(problem: &BallProblem) -> Option<[f64; 2]> {
    problem.reference_distance_mm.map(|distance| [0.9 * distance, 1.1 * distance])
}

fn rough_cell(args: &PlanArgs, session: &Session, problem: &BallProblem) -> Option<RoughCell> {
    let &[x, y, z, a, b, c] = args.sensor_at.as_deref()? else { return None };
    let rotation = session.robot.notation.convention.rotation_from_angles_deg([a, b, c]);
    Some(RoughCell {
        mount: session.mount,
        flange_from_sensor: Rigid::from_parts(Vec3::new(x, y, z).into(), rotation),
        target_in_base_mm: Vec3::from_column_slice(args.ball_at.as_deref()?),
        radius_mm: problem.radius_mm,
        noise: problem.noise,
        looks_along_in_base: Vec3::from_column_slice(&args.looks_along),
    })
}

/// The plan for people: poses in the robot's own angles.
fn table(session: &Session, plan: &Plan, method: Option<Method>) -> String {
    let convention: &PoseConvention = session.robot.notation.convention;
    let std = |std_mm: Option<f64>| std_mm.map_or_else(|| "–".to_owned(), |std_mm| fixed(std_mm, 3));
    let mut out = words::plan_head(session, plan.stations.len(), method, plan.workspace_point_std_mm);
    let has_edges = plan.stations.iter().any(|station| station.edge.is_some());
    out.push_str(&words::plan_columns(convention.angle_names, has_edges));
    for (idx, station) in plan.stations.iter().enumerate() {
        let position = station.base_from_flange.translation_mm();
        let [a, b, c] = convention.angles_deg_from_rotation(&station.base_from_flange.rotation());
        let pose = [position.x, position.y, position.z].map(|value| fixed(value, 2));
        let angles = [a, b, c].map(|value| fixed(value, 3));
        let turned = [station.tilt_deg, station.azimuth_deg, station.spin_deg].map(|value| fixed(value, 0));
        let std = std(station.workspace_point_std_mm);
        out.push_str(&words::plan_row(idx + 1, station.edge, &pose, &angles, &turned, &std));
    }
    out.push_str(&words::plan_foot(session));
    out
}

fn tilt(text: &str) -> Result<f64, String> {
    within(text, MAX_TILT_DEG)
}

fn spin(text: &str) -> Result<f64, String> {
    within(text, 180.0)
}

fn within(text: &str, most: f64) -> Result<f64, String> {
    let value = finite(text)?;
    if (0.0..=most).contains(&value) { Ok(value) } else { Err(format!("expected 0 to {most}")) }
}

fn finite(text: &str) -> Result<f64, String> {
    text.parse().ok().filter(|value: &f64| value.is_finite()).ok_or_else(|| "expected a number".to_owned())
}
