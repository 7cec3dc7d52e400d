//! What a diagnosis found, as result files hold it, and planned stations.

use serde_json::{Map, Value, json};

use crate::calibrate::validation::{Bootstrap, Validation};
use crate::diagnose::{Axis, Diagnosis, Fault, Finding, ReadingFit};
use crate::geometry::Vec3;
use crate::plan::{Plan, PlannedStation};
use crate::session::Session;
use crate::text::diagnosis as words;

/// Everything that is known of a session beside its results.
#[derive(Clone, Copy, Debug)]
pub struct Examination<'a> {
    /// What is wrong with it.
    pub diagnosis: &'a Diagnosis,
    /// Where to measure next; `None` without a solution.
    pub plan: Option<&'a Plan>,
    /// The spread of the result over stations drawn with replacement, where it was asked for.
    pub bootstrap: Option<&'a Bootstrap>,
}

/// The entry of an examination.
pub(super) fn diagnosis_entry(session: &Session, examination: &Examination<'_>) -> Value {
    let Examination { diagnosis, plan, bootstrap } = examination;
    let mut validation = diagnosis.validation.as_ref().map_or_else(Map::new, validation_entry);
    if let Some(bootstrap) = bootstrap {
        validation.insert("bootstrap".to_owned(), bootstrap_entry(bootstrap));
    }
    json!({
        "findings": diagnosis.findings.iter().map(|finding| finding_entry(session, finding)).collect::<Vec<_>>(),
        "readings": diagnosis.readings.iter().map(reading_entry).collect::<Vec<_>>(),
        "validation": if validation.is_empty() { Value::Null } else { Value::Object(validation) },
        "next_poses": plan.map_or_else(Vec::new, |plan| planned_stations(session, plan)),
    })
}

/// The stations of a plan, with their poses as sessions hold them.
pub(super) fn planned_stations(session: &Session, plan: &Plan) -> Vec<Value> {
    plan.stations.iter().map(|station| planned_station(session, station)).collect()
}

fn planned_station(session: &Session, station: &PlannedStation) -> Value {
    let convention = session.robot.notation.convention;
    let pose = &station.base_from_flange;
    let mut entry = json!({
        "base_from_flange": {
            "translation_mm": vector(pose.translation_mm()),
            "euler_deg": convention.angles_deg_from_rotation(&pose.rotation()),
            "convention": convention.id,
        },
        "tilt_deg": station.tilt_deg,
        "azimuth_deg": station.azimuth_deg,
        "spin_deg": station.spin_deg,
        "workspace_point_std_mm": station.workspace_point_std_mm,
    });
    if let Some(edge) = station.edge {
        entry["edge"] = json!(edge.symbol());
    }
    entry
}

fn finding_entry(session: &Session, finding: &Finding) -> Value {
    let Finding { fault, severity, explains, evidence, remedy } = finding;
    let labels: Vec<&str> = stations_of(fault)
        .into_iter()
        .filter_map(|idx| session.stations.get(idx))
        .map(|station| station.label.as_str())
        .collect();
    let mut entry = Map::new();
    let mut insert = |name: &str, value: Value| entry.insert(name.to_owned(), value);
    insert("code", json!(fault.code()));
    insert("severity", json!(words::severity_id(*severity)));
    insert("message", json!(words::fault_message(fault, session)));
    insert("remedy", json!(words::fault_remedy(fault, session)));
    insert("one_click", json!(remedy.is_some()));
    insert("stations", json!(labels));
    insert(
        "residual_mm",
        evidence
            .residual_mm
            .map_or(Value::Null, |[as_given, mended]| json!({ "as_given": as_given, "mended": mended })),
    );
    insert("explains", json!(explains));
    entry.extend(numbers(fault));
    Value::Object(entry)
}

/// The stations that a fault is about, by their index in the session.
fn stations_of(fault: &Fault) -> Vec<usize> {
    match fault {
        Fault::WrongSides { station_idxs } => station_idxs.clone(),
        Fault::TwinPoses { station_idxs, .. } => station_idxs.to_vec(),
        Fault::TravelOffNormal { station_idx, .. }
        | Fault::StepDiffersFromPose { station_idx, .. }
        | Fault::WrongPose { station_idx, .. }
        | Fault::WrongStation { station_idx, .. }
        | Fault::WrongEdge { station_idx, .. } => vec![*station_idx],
        Fault::StalePose { station_idx, pose_of_idx, .. } => vec![*station_idx, *pose_of_idx],
        Fault::ToolFrame { from_station_idx, .. } => vec![*from_station_idx],
        Fault::MixedOrder { poses_from } => poses_from.iter().map(|(to, _)| *to).collect(),
        _ => Vec::new(),
    }
}

/// The figures of a fault, by name.
fn numbers(fault: &Fault) -> Map<String, Value> {
    let numbers = match fault {
        Fault::PosesMisread { reading } => json!({ "reading": words::pose_reading(reading) }),
        Fault::MirroredAxis { axis } => json!({ "axis": match axis { Axis::X => "x", Axis::Z => "z" } }),
        Fault::NoRotation { span_deg } => json!({ "span_deg": span_deg }),
        Fault::LittleRotation { span_deg, recommended_deg, weakest } => json!({
            "span_deg": span_deg,
            "recommended_deg": recommended_deg,
            "weakest_direction": weakest.map(|(direction, std_mm)| direction_entry(direction, std_mm)),
        }),
        Fault::OneAxis { axis_in_flange, ratio } => json!({ "axis": vector(*axis_in_flange), "ratio": ratio }),
        Fault::TwinPoses { distance_mm, angle_deg, .. } => {
            json!({ "distance_mm": distance_mm, "angle_deg": angle_deg })
        }
        Fault::WrongRadius { found_mm, std_mm, given_mm } => {
            json!({ "found_mm": found_mm, "std_mm": std_mm, "given_mm": given_mm })
        }
        Fault::ProfileScale { factor, std } => json!({ "factor": factor, "std": std }),
        Fault::TravelOffNormal { angle_deg, .. } => json!({ "angle_deg": angle_deg }),
        Fault::StepDiffersFromPose { ratio, difference_mm, .. } => {
            json!({ "ratio": ratio, "difference_mm": difference_mm })
        }
        Fault::Drift { total_in_base_mm, std_mm } => json!({ "total_mm": vector(*total_in_base_mm), "std_mm": std_mm }),
        Fault::ToolFrame { flange_from_tool, .. } => json!({
            "distance_mm": flange_from_tool.translation.vector.norm(),
            "angle_deg": flange_from_tool.rotation.angle().to_degrees(),
        }),
        Fault::SensorIsTool { distance_mm, angle_deg } => json!({ "distance_mm": distance_mm, "angle_deg": angle_deg }),
        Fault::WrongEdge { edge, .. } => json!({ "edge": edge.symbol() }),
        Fault::WrongPose { off_mm, typical_mm, .. } | Fault::WrongStation { off_mm, typical_mm, .. } => {
            json!({ "off_mm": off_mm, "typical_mm": typical_mm })
        }
        Fault::StalePose { off_mm, .. } => json!({ "off_mm": off_mm }),
        Fault::TooFewCleanStations { clean, needed } => json!({ "clean": clean, "needed": needed }),
        Fault::NoiseAboveStated { ratio, p_value } => json!({ "ratio": ratio, "p_value": p_value }),
        Fault::HalvesDisagree { median_mm, expected_mm } => {
            json!({ "median_mm": median_mm, "expected_mm": expected_mm })
        }
        Fault::DoesNotFit { scatter_mm } => json!({ "scatter_mm": scatter_mm }),
        Fault::ResidualsNotNormal { p_value } => json!({ "p_value": p_value }),
        Fault::WrongSides { .. } | Fault::MixedOrder { .. } | Fault::NotSolved(_) | Fault::Method(_) => json!({}),
    };
    match numbers {
        Value::Object(numbers) => numbers,
        _ => Map::new(),
    }
}

/// A direction in the frame that the sensor is mounted on, and σ along it.
pub(super) fn direction_entry(direction: Vec3, std_mm: f64) -> Value {
    json!({ "direction": vector(direction), "std_mm": std_mm })
}

fn reading_entry(fit: &ReadingFit) -> Value {
    json!({
        "reading": words::pose_reading(&fit.reading),
        "same_as": fit.ties.iter().map(words::pose_reading).collect::<Vec<_>>(),
        "residual_mm": fit.rms_mm,
        "is_as_given": fit.is_as_given,
    })
}

fn validation_entry(validation: &Validation) -> Map<String, Value> {
    let influence: Vec<Value> = validation
        .influence
        .iter()
        .map(|influence| {
            json!({
                "label": influence.label,
                "studentised_residual": influence.studentised_residual,
                "p_value": influence.p_value,
                "moves_workspace_point_mm": influence.moves_workspace_point_mm,
            })
        })
        .collect();
    let split_half = validation.split_half.as_ref().map(
        |halves| json!({ "median_mm": halves.median_mm, "max_mm": halves.max_mm, "expected_mm": halves.expected_mm }),
    );
    let normality = validation.normality.as_ref().map(|normality| json!({ "p_value": normality.p_value }));
    let mut entry = Map::new();
    entry.insert("influence".to_owned(), json!(influence));
    entry.insert("split_half".to_owned(), json!(split_half));
    entry.insert("normality".to_owned(), json!(normality));
    entry
}

fn bootstrap_entry(bootstrap: &Bootstrap) -> Value {
    json!({
        "draws": bootstrap.distances_mm.len() + bootstrap.num_failed,
        "failed": bootstrap.num_failed,
        "workspace_point_std_mm": bootstrap.std_mm,
        "workspace_point_95_mm": bootstrap.within_95_mm,
    })
}

pub(super) fn vector(vector: Vec3) -> Value {
    json!([vector.x, vector.y, vector.z])
}
