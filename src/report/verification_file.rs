//! The verification file, as `verify --json` prints it. Other programs rely on its names.

use serde_json::{Value, json};

use crate::calibrate::{Mount, Problem};
use crate::geometry::Vec3;
use crate::session::Session;
use crate::text::verify::{calibration_name, edge_letter};
use crate::verify::{
    Calibration, Distances, Evaluation, Figures, Histogram, Joint, MatrixCheck, Measurement, NotEvaluated, Origin,
    Seen, Stability, Suspect, TargetEvidence, Verification,
};

use super::diagnosis_entry::vector;
use super::result_file::transform;

/// The format's name.
pub const FORMAT: &str = "handeye-verification";
/// Its version.
pub const VERSION: u32 = 1;

/// How the targets stand to the calibration from all of them.
fn joint_entry(joint: &Joint, verification: &Verification) -> Value {
    let name = |idx: &usize| verification.targets.get(*idx).map(|target| target.name.as_str());
    match &joint.outcome {
        Err(error) => json!({ "status": "failed", "reason": error.to_string() }),
        Ok(solution) => json!({
            "status": "ok",
            "workspace_point_std_mm": solution.uncertainty.workspace_point_std_mm,
            "targets": joint
                .target_idxs
                .iter()
                .zip(&solution.targets)
                .map(|(idx, target)| json!({
                    "name": name(idx),
                    "alone_workspace_point_std_mm":
                        target.alone.uncertainty.as_ref().map(|known| known.workspace_point_std_mm),
                    "moved_mm": target.moved_mm,
                    "p_value": target.p_value,
                }))
                .collect::<Vec<_>>(),
        }),
    }
}

/// A matrix that was given, and what the check found.
pub type Checked = (String, MatrixCheck);

/// All evidence as a JSON document; `checked` are the given matrices.
#[must_use]
pub fn verification_file(session: &Session, verification: &Verification, checked: &[Checked]) -> Value {
    let mut file = json!({
        "format": FORMAT,
        "version": VERSION,
        "session": session.name,
        "calibrations": verification
            .calibrations
            .iter()
            .map(|calibration| calibration_entry(calibration, session.mount, verification, checked))
            .collect::<Vec<_>>(),
        "targets": verification.targets.iter().enumerate().map(|(idx, target)| target_entry(idx, target, verification)).collect::<Vec<_>>(),
    });
    file["joint"] = verification.joint.as_ref().map_or(Value::Null, |joint| joint_entry(joint, verification));
    file
}

fn calibration_entry(
    calibration: &Calibration,
    mount: Mount,
    verification: &Verification,
    checked: &[Checked],
) -> Value {
    let sensor = match mount {
        Mount::OnFlange => "flange_from_sensor",
        Mount::Fixed => "base_from_sensor",
    };
    let target = |idx: &usize| verification.targets.get(*idx).map(|target| target.name.as_str());
    let name = calibration_name(&calibration.origin, verification);
    let origin = match &calibration.origin {
        Origin::Solved { target_idx, method } => {
            json!({ "kind": "solved", "target": target(target_idx), "method": method.id() })
        }
        Origin::Joint { target_idxs } => {
            json!({ "kind": "joint", "targets": target_idxs.iter().map(target).collect::<Vec<_>>() })
        }
        Origin::Given { is_nearest, .. } => json!({ "kind": "given", "is_nearest_rotation": is_nearest }),
    };
    let mut entry = json!({ "name": name, "origin": origin });
    entry[sensor] = transform(&calibration.flange_from_sensor);
    entry["workspace_point_std_mm"] = json!(calibration.workspace_point_std_mm);
    if let Origin::Given { name, .. } = &calibration.origin
        && let Some((_, check)) = checked.iter().find(|(of, _)| of == name)
    {
        entry["matrix_check"] = check_entry(check);
    }
    entry
}

fn check_entry(check: &MatrixCheck) -> Value {
    let suspects: Vec<Value> = check.suspects.iter().map(suspect_entry).collect();
    json!({
        "is_rotation": check.is_rotation(),
        "defect": check.defect,
        "rounding": check.rounding,
        "column_norms": check.column_norms,
        "dot_products": check.dot_products,
        "determinant": check.determinant,
        "to_nearest_deg": check.angle_rad.map(f64::to_degrees),
        "suspect": suspects.first(),
        "suspects": suspects,
    })
}

fn suspect_entry(suspect: &Suspect) -> Value {
    json!({
        "row": suspect.row + 1,
        "column": suspect.column + 1,
        "found": suspect.found,
        "likely": suspect.likely,
        "defect_then": suspect.defect_then,
    })
}

fn target_entry(target_idx: usize, target: &TargetEvidence, verification: &Verification) -> Value {
    let kind = match target.problem {
        Problem::Ball(_) => "ball",
        Problem::Point(_) => "point",
        Problem::Plate(_) => "right-angle-plate",
        Problem::Motion(_) => "pose",
        Problem::Streams(_) => "rgbd",
    };
    let rows = target.rows.iter().zip(&verification.calibrations).enumerate();
    let results: Vec<Value> = rows
        .map(|(idx, (row, calibration))| {
            let mut entry = json!({
                "calibration": calibration_name(&calibration.origin, verification),
                "own_data": verification.has_seen(idx, target_idx),
            });
            outcome(&mut entry, row);
            entry
        })
        .collect();
    let refused = target.refused().map(|refused| {
        json!({ "station": refused.station, "capture": refused.capture_idx + 1, "reason": refused.refusal.to_string() })
    });
    json!({
        "name": target.name,
        "kind": kind,
        "is_further": target.further_idx.is_some(),
        "refused": refused.collect::<Vec<_>>(),
        "results": results,
    })
}

fn outcome(entry: &mut Value, row: &Result<Evaluation, NotEvaluated>) {
    let evaluation = match row {
        Ok(evaluation) => evaluation,
        Err(refusal) => {
            entry["status"] = json!("failed");
            entry["reason"] = json!(refusal.to_string());
            return;
        }
    };
    entry["status"] = json!("ok");
    entry["error_mm"] = figures(&evaluation.figures);
    let stations = evaluation.stations.iter();
    entry["stations"] =
        stations.map(|station| json!({ "label": station.label, "error_mm": station.error_mm })).collect();
    match &evaluation.seen {
        Seen::Plate(distances) => entry["distances"] = distances_entry(distances),
        Seen::Place { common_mm, measurements, stability } => {
            entry["point_in_base_mm"] = vector(*common_mm);
            entry["stability"] =
                stability.as_ref().map_or(Value::Null, |stability| stability_entry(measurements, stability));
        }
    }
}

fn figures(figures: &Figures) -> Value {
    json!({
        "count": figures.count,
        "mean": figures.mean_mm,
        "sd": figures.std_mm,
        "rms": figures.rms_mm,
        "max": figures.max_mm,
    })
}

fn distances_entry(distances: &Distances) -> Value {
    let histogram = |values: Vec<f64>, max_mm: f64| {
        let histogram = Histogram::of(&values, Histogram::round_width_mm(max_mm, values.len()));
        json!({ "bin_width_mm": histogram.width_mm, "counts": histogram.counts })
    };
    let points = || distances.points.iter();
    json!({
        "to_line_mm": figures(&distances.to_line),
        "to_plane_mm": figures(&distances.to_plane),
        "line_histogram": histogram(points().map(|point| point.to_line_mm).collect(), distances.to_line.max_mm),
        "plane_histogram": histogram(points().map(|point| point.to_plane_mm).collect(), distances.to_plane.max_mm),
        "angle_deg": distances.angle_rad.to_degrees(),
        "gap_mm": distances.gap_mm,
        "plane": { "normal": vector(distances.plane.normal), "point_mm": vector(distances.centroid_mm) },
        "lines": distances
            .lines
            .iter()
            .map(|line| json!({ "direction": vector(line.direction), "point_mm": vector(line.point_mm) }))
            .collect::<Vec<_>>(),
        "points": points()
            .map(|point| json!({
                "label": point.label,
                "capture": point.capture_idx + 1,
                "edge": edge_letter(point.edge),
                "point_in_base_mm": vector(point.point_in_base_mm),
                "to_line_mm": point.to_line_mm,
                "to_plane_mm": point.to_plane_mm,
            }))
            .collect::<Vec<_>>(),
    })
}

fn stability_entry(measurements: &[Measurement], stability: &Stability) -> Value {
    let rows = measurements.iter().zip(&stability.deviations_mm);
    let of = |value: Vec3| vector(value);
    json!({
        "reference_mm": of(stability.reference_mm),
        "reference": if stability.is_touched { "touched" } else { "mean" },
        "rows": rows
            .map(|(measured, deviation)| json!({ "label": measured.name(), "deviation_mm": of(*deviation) }))
            .collect::<Vec<_>>(),
        "mean_mm": of(stability.mean_mm),
        "three_delta_mm": of(stability.three_std_mm()),
        "three_delta_3d_mm": stability.three_std_3d_mm(),
    })
}
