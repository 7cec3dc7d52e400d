//! What was measured on a scan, as `scan --json` prints it. Other programs rely on its names.

use serde_json::{Map, Value, json};

use crate::scan::{
    Cloud, Deviation, Measured, PlaneFit, Region, Round, RoundKind, ScanError, Shapes, Teeth, angle_between,
};
use crate::session::Known;
use crate::verify::Figures;

use super::diagnosis_entry::vector;

/// The format's name.
pub const FORMAT: &str = "handeye-scan";
/// Its version.
pub const VERSION: u32 = 1;

/// What was measured on a cloud. `calibration` is none for points from elsewhere.
#[must_use]
pub fn scan_file(
    name: &str,
    calibration: Option<&str>,
    cloud: &Cloud,
    regions: &[Region],
    shapes: &Shapes,
    known: &Known,
) -> Value {
    let mut file = Map::new();
    file.insert("format".to_owned(), json!(FORMAT));
    file.insert("version".to_owned(), json!(VERSION));
    file.insert("scan".to_owned(), json!(name));
    file.insert("calibration".to_owned(), json!(calibration));
    file.insert("points".to_owned(), json!(cloud.len()));
    file.insert("planes".to_owned(), regions.iter().map(plane).collect());
    file.insert("angles".to_owned(), angles(regions, known));
    if let Some(found) = &shapes.teeth {
        file.insert("teeth".to_owned(), entry(found.as_ref().map(|found| teeth(found, known))));
    }
    if let Some(found) = &shapes.round {
        file.insert("round".to_owned(), entry(found.as_ref().map(|found| round(found, known))));
    }
    Value::Object(file)
}

/// A result, or why there is none.
fn entry(found: Result<Value, &ScanError>) -> Value {
    found.unwrap_or_else(|error| json!({ "status": "failed", "reason": error.to_string() }))
}

fn plane(region: &Region) -> Value {
    let mut found = entry(region.plane.as_ref().map(plane_entry));
    found["name"] = json!(region.name);
    if !region.distances_mm.is_empty() {
        let sizes: Vec<f64> = region.distances_mm.iter().map(|distance| distance.abs()).collect();
        let figures = Figures::of(&sizes);
        found["distances_mm"] = json!({
            "drawn": figures.count,
            "mean": figures.mean_mm,
            "std": figures.std_mm,
            "max": figures.max_mm,
            "rms": figures.rms_mm,
        });
    }
    found
}

fn plane_entry(fit: &PlaneFit) -> Value {
    let equation = fit.equation();
    json!({
        "status": "ok",
        "equation": { "coefficients": equation.coefficients, "offset_mm": equation.offset_mm },
        "equation_std": { "coefficients": equation.coefficient_stds, "offset_mm": equation.offset_std_mm },
        "normal": vector(fit.plane.normal),
        "normal_std_deg": fit.normal_std_rad().to_degrees(),
        "centroid_mm": vector(fit.centroid_mm),
        "height_std_mm": fit.height_std_mm(),
        "rms_mm": fit.rms_mm,
        "points": fit.num_points,
        "used": fit.num_used,
        "profiles": fit.num_profiles,
        "is_std_from_profiles": fit.is_known_from_profiles(),
    })
}

fn angles(regions: &[Region], known: &Known) -> Value {
    let fits: Vec<(&str, &PlaneFit)> =
        regions.iter().filter_map(|region| Some((region.name.as_str(), region.plane.as_ref().ok()?))).collect();
    let mut angles = Vec::new();
    for (idx, (first_name, first)) in fits.iter().enumerate() {
        for (second_name, second) in &fits[idx + 1..] {
            let angle = angle_between(first, second);
            angles.push(json!({
                "planes": [first_name, second_name],
                "angle_deg": angle.angle_rad.to_degrees(),
                "std_deg": angle.std_rad.to_degrees(),
                "nominal_deg": known.angle_deg,
            }));
        }
    }
    Value::Array(angles)
}

fn teeth(found: &Teeth, known: &Known) -> Value {
    let value = |measured: Option<Measured>| {
        measured.map(|measured| json!({ "value": measured.value_mm, "std": measured.std_mm }))
    };
    let deviation = |values: Vec<Measured>, nominal_mm: Option<f64>| {
        let deviation = Deviation::of(values.into_iter(), nominal_mm?)?;
        Some(json!({
            "nominal": nominal_mm,
            "mean": deviation.mean_value_mm,
            "mean_error": deviation.mean_error_mm,
            "max_error": deviation.max_error_mm,
        }))
    };
    json!({
        "status": "ok",
        "along": vector(found.along),
        "up": vector(found.up),
        "teeth": found.teeth.iter().map(|tooth| json!({
            "place_mm": tooth.place_mm,
            "pitch_mm": value(tooth.pitch),
            "height_mm": value(tooth.height),
            "is_sharp": tooth.is_sharp,
        })).collect::<Vec<_>>(),
        "pitch_mm": deviation(found.pitches().collect(), known.pitch_mm),
        "height_mm": deviation(found.heights().collect(), known.height_mm),
    })
}

fn round(found: &Round, known: &Known) -> Value {
    json!({
        "status": "ok",
        "kind": match found.kind {
            RoundKind::Ball => "ball",
            RoundKind::Cylinder => "cylinder",
        },
        "diameter_mm": found.diameter_mm,
        "diameter_std_mm": found.diameter_std_mm,
        "nominal_mm": known.diameter_mm,
        "centre_mm": vector(found.centre_mm),
        "axis": found.axis.map(vector),
        "rms_mm": found.rms_mm,
        "used": found.num_used,
    })
}
