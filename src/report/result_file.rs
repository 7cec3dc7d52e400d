//! The result file, as `solve --json` prints it. Other programs rely on its names.

use serde_json::{Map, Value, json};

use crate::calibrate::{
    Method, MethodResult, MotionFound, Mount, NoiseModel, PlatePoint, Solution, StationSolution, Uncertainty, Warning,
    best_available,
};
use crate::diagnose::{Diagnosis, verdict_with};
use crate::geometry::{Base, Frame, Rigid, Transform};
use crate::plan::Plan;
use crate::session::Session;
use crate::text;

use super::diagnosis_entry::{diagnosis_entry, direction_entry, planned_stations, vector};

pub use super::diagnosis_entry::Examination;

/// The format's name.
pub const FORMAT: &str = "handeye-result";
/// The format's name of a plan.
pub const PLAN_FORMAT: &str = "handeye-plan";
/// The version of both.
pub const VERSION: u32 = 1;

/// The results of a session as a JSON document, with what an examination found, if there was one. Stations that a method
/// left out are listed as not used.
#[must_use]
pub fn result_file(session: &Session, results: &[MethodResult], examination: Option<&Examination<'_>>) -> Value {
    let diagnosis = examination.map(|found| found.diagnosis);
    let mut file = json!({
        "format": FORMAT,
        "version": VERSION,
        "session": session.name,
        "answer": best_available(results).map(|solution| solution.method.id()),
        "methods": results.iter().map(|result| method_entry(session, result, diagnosis)).collect::<Vec<_>>(),
    });
    if let Some(examination) = examination {
        file["diagnosis"] = diagnosis_entry(session, examination);
    }
    file
}

/// A plan as a JSON document; `method` is the one whose solution it rests on, none for a plan from nothing.
#[must_use]
pub fn plan_file(session: &Session, plan: &Plan, method: Option<Method>) -> Value {
    json!({
        "format": PLAN_FORMAT,
        "version": VERSION,
        "session": session.name,
        "method": method.map(Method::id),
        "workspace_point_std_mm": plan.workspace_point_std_mm,
        "stations": planned_stations(session, plan),
    })
}

pub(super) fn method_entry(session: &Session, result: &MethodResult, diagnosis: Option<&Diagnosis>) -> Value {
    match &result.outcome {
        Ok(solution) => solution_entry(session, solution, diagnosis),
        Err(error) => json!({
            "method": result.method.id(),
            "status": "failed",
            "reason": error.to_string(),
        }),
    }
}

fn solution_entry(session: &Session, solution: &Solution, diagnosis: Option<&Diagnosis>) -> Value {
    let names = Names::of(solution.mount);
    let mut entry = Map::new();
    entry.insert("method".to_owned(), json!(solution.method.id()));
    entry.insert("status".to_owned(), json!("ok"));
    entry.insert(names.sensor.to_owned(), transform(&solution.flange_from_sensor));
    entry.insert(names.target.to_owned(), vector(solution.target_in_base_mm));
    entry.insert("scatter_mm".to_owned(), json!({ "rms": solution.scatter.rms_mm, "max": solution.scatter.max_mm }));
    entry.insert(
        "leave_one_out_mm".to_owned(),
        solution
            .leave_one_out
            .map_or(Value::Null, |left_out| json!({ "rms": left_out.rms_mm, "max": left_out.max_mm })),
    );
    entry.insert(
        "uncertainty".to_owned(),
        solution.uncertainty.as_ref().map_or(Value::Null, |known| uncertainty(known, solution)),
    );
    let (verdict, reason) = verdict_with(solution, diagnosis);
    entry.insert(
        "verdict".to_owned(),
        json!({
            "rating": text::verdict_id(verdict),
            "reason": text::verdict_line(verdict, reason, &solution.warnings, session),
        }),
    );
    entry.insert("noise".to_owned(), solution.noise.as_ref().map_or(Value::Null, noise));
    entry.insert(
        "estimated_radius".to_owned(),
        solution.radius.map_or(Value::Null, |radius| json!({ "radius_mm": radius.radius_mm, "std_mm": radius.std_mm })),
    );
    entry.insert("rotation_span_deg".to_owned(), json!(solution.rotation_span_rad.to_degrees()));
    if let Some(plate) = &solution.plate {
        entry.insert(
            "plate".to_owned(),
            json!({
                names.plate: rigid(&plate.base_from_plate),
                "starts": { "tried": plate.starts.num_tried, "agreed": plate.starts.num_agreed },
            }),
        );
    }
    if let Some(found) = &solution.motion {
        entry.insert("motion".to_owned(), motion(found, &names));
    }
    entry.insert(
        "stations".to_owned(),
        session
            .stations
            .iter()
            .enumerate()
            .map(|(idx, station)| {
                let used = solution.stations.iter().find(|used| used.station_idx == idx);
                let on_plate = solution.plate.iter().flat_map(|plate| &plate.points);
                used.map(|used| station_entry(used, &names, solution.method))
                    .or_else(|| Some(point_entry(on_plate.clone().find(|point| point.station_idx == idx)?, &names)))
                    .unwrap_or_else(|| json!({ "label": station.label, "used": false }))
            })
            .collect(),
    );
    entry.insert("warnings".to_owned(), solution.warnings.iter().map(warning).collect());
    Value::Object(entry)
}

/// The names that depend on where the sensor is mounted.
struct Names {
    sensor: &'static str,
    target: &'static str,
    plate: &'static str,
    board: &'static str,
}

impl Names {
    const fn of(mount: Mount) -> Self {
        match mount {
            Mount::OnFlange => Self {
                sensor: "flange_from_sensor",
                target: "target_in_base_mm",
                plate: "base_from_plate",
                board: "base_from_target",
            },
            Mount::Fixed => Self {
                sensor: "base_from_sensor",
                target: "target_in_flange_mm",
                plate: "flange_from_plate",
                board: "flange_from_target",
            },
        }
    }
}

/// The target's pose, and what the published closed forms make of the same data.
fn motion(found: &MotionFound, names: &Names) -> Value {
    let closed_forms: Vec<Value> = found
        .closed_forms
        .iter()
        .map(|closed_form| {
            let mut entry = json!({ "form": closed_form.form.id(), "status": "failed" });
            if let Some(answer) = &closed_form.answer {
                entry["status"] = json!("ok");
                entry[names.sensor] = transform(&answer.flange_from_sensor);
                entry["off_mm"] = json!(answer.off_mm);
                entry["off_deg"] = json!(answer.off_rad.to_degrees());
                entry["residual_mm"] = json!(answer.residual_mm);
                entry["residual_deg"] = json!(answer.residual_rad.to_degrees());
            }
            entry
        })
        .collect();
    let rejected: Vec<Value> = found
        .rejected
        .iter()
        .map(|pose| {
            json!({
                "label": pose.label,
                "capture": pose.capture_idx + 1,
                "off_mm": pose.off_mm,
                "off_deg": pose.off_rad.to_degrees(),
                "fault": text::pose_fault_id(pose.fault),
            })
        })
        .collect();
    let mut entry = json!({
        names.board: transform(&found.base_from_target),
        "rotation_scatter_deg": found.rotation_scatter_rad.to_degrees(),
        "target_noise": {
            "translation_std_mm": found.target_translation_std_mm,
            "rotation_std_deg": found.target_rotation_std_rad.to_degrees(),
        },
        "closed_forms": closed_forms,
        "rejected": rejected,
    });
    if let Some(tracked) = &found.tracked {
        entry["steps"] = json!({
            "num": tracked.num_steps,
            "lost": tracked.num_lost,
            "rms_mm": tracked.step_mm.rms_mm,
            "max_mm": tracked.step_mm.max_mm,
            "rms_deg": tracked.step_rms_rad.to_degrees(),
            "rotation_std_factor": tracked.rotation_std_factor,
            "translation_std_factor": tracked.translation_std_factor,
        });
    }
    if let Some(offset) = &found.time_offset {
        entry["time_offset_s"] = json!({ "camera_to_robot": offset.offset_s, "std": offset.std_s });
    }
    entry
}

fn rigid(motion: &Rigid) -> Value {
    transform(&Transform::<Base, Base>::from_rigid(*motion))
}

pub(super) fn transform<Dst: Frame, Src: Frame>(transform: &Transform<Dst, Src>) -> Value {
    let matrix = transform.matrix();
    let rows: Vec<Vec<f64>> = (0..4).map(|row| (0..4).map(|column| matrix[(row, column)]).collect()).collect();
    json!({
        "translation_mm": vector(transform.translation_mm()),
        "quaternion_wxyz": transform.quaternion_wxyz(),
        "matrix": rows,
    })
}

fn uncertainty(uncertainty: &Uncertainty, solution: &Solution) -> Value {
    let covariance: Vec<Vec<f64>> =
        uncertainty.covariance.row_iter().map(|row| row.iter().copied().collect()).collect();
    let (weakest, weakest_std_mm) = uncertainty.weakest_direction();
    let mut entry = json!({
        "translation_std_mm": vector(uncertainty.translation_std_mm),
        "rotation_std_deg": vector(uncertainty.rotation_std_rad.map(f64::to_degrees)),
        "workspace_point_std_mm": uncertainty.workspace_point_std_mm,
        "reference_point_in_sensor_mm": vector(uncertainty.reference_point_in_sensor_mm),
        "covariance": covariance,
        "workspace_point_95_mm": uncertainty.workspace_point_95_mm,
        "degrees_of_freedom": uncertainty.degrees_of_freedom.is_finite().then_some(uncertainty.degrees_of_freedom),
        "weakest_direction": direction_entry(weakest, weakest_std_mm),
    });
    // Plates and tips have no radius.
    if Method::BALL.contains(&solution.method) {
        let by_radius = solution.change_by_radius;
        entry["by_radius"] = json!({
            "workspace_point_mm_per_mm": vector(solution.workspace_point_by_radius),
            "translation_mm_per_mm": vector(by_radius.fixed_rows::<3>(3).into_owned()),
            "rotation_deg_per_mm": vector(by_radius.fixed_rows::<3>(0).map(f64::to_degrees)),
        });
    }
    entry
}

fn noise(noise: &NoiseModel) -> Value {
    json!({
        "position_std_mm": noise.position_std_mm,
        "orientation_std_deg": noise.orientation_std_rad.to_degrees(),
        "station_position_std_mm": noise.station_position_std_mm,
        "station_orientation_std_deg": noise.station_orientation_std_rad.to_degrees(),
        "is_stated": noise.is_stated,
        "above_stated": noise.above_stated.map(|above| json!({ "ratio": above.ratio, "p_value": above.p_value })),
    })
}

/// A station at a plate, by the point of its first capture that was used.
fn point_entry(point: &PlatePoint, names: &Names) -> Value {
    let mut entry = Map::new();
    entry.insert("label".to_owned(), json!(point.label));
    entry.insert("used".to_owned(), json!(true));
    entry.insert("edge".to_owned(), json!(point.edge.symbol()));
    entry.insert("target_in_sensor_mm".to_owned(), vector(point.point_in_sensor_mm));
    entry.insert(names.target.to_owned(), vector(point.point_in_base_mm));
    entry.insert("off_edge_mm".to_owned(), vector(point.off_edge_mm));
    entry.insert("leave_one_out_mm".to_owned(), json!(point.leave_one_out_mm));
    Value::Object(entry)
}

fn station_entry(station: &StationSolution, names: &Names, method: Method) -> Value {
    let mut entry = Map::new();
    entry.insert("label".to_owned(), json!(station.label));
    entry.insert("used".to_owned(), json!(true));
    if method.has_sides() {
        entry.insert("side".to_owned(), json!(station.side.symbol()));
        entry.insert("side_cost_ratio".to_owned(), json!(station.side_cost_ratio));
    }
    entry.insert("target_in_sensor_mm".to_owned(), vector(station.target_in_sensor_mm));
    entry.insert(names.target.to_owned(), vector(station.target_in_base_mm));
    entry.insert("error_from_first_mm".to_owned(), vector(station.error_from_first_mm));
    entry.insert("error_from_mean_mm".to_owned(), vector(station.error_from_mean_mm));
    entry.insert("leave_one_out_mm".to_owned(), json!(station.leave_one_out_mm));
    if let Some(sweep) = &station.sweep {
        entry.insert(
            "sweep".to_owned(),
            json!({
                "peak_mm": sweep.peak_mm,
                "peak_std_mm": sweep.peak_std_mm,
                "published_stop_mm": sweep.published_stop_mm,
                "published_stop_std_mm": sweep.published_stop_std_mm,
                "travel_off_normal_deg": sweep.travel_off_normal_rad.to_degrees(),
                "steps": sweep.points.len(),
            }),
        );
    }
    Value::Object(entry)
}

fn warning(warning: &Warning) -> Value {
    json!({
        "code": warning.code(),
        "message": text::warning_message(warning),
        "remedy": text::warning_remedy(warning),
    })
}
