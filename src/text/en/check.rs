//! Sentences of the findings of `handeye check`.

use crate::calibrate::Method;
use crate::session::check::Finding;
use crate::session::table::edge_text;

use super::plural;
use crate::text::digits;

/// A touched point that a method has elsewhere.
#[must_use]
pub fn touched_point_off(distance_mm: f64, std_mm: f64, method: Method) -> String {
    format!(
        "The touched point lies {distance} mm from where the tip is found (± {std} mm, 1 σ): check its digits, signs and frame, and the tool that touched it. ({method})",
        distance = digits::fixed(distance_mm, if distance_mm < 10.0 { 2 } else { 0 }),
        std = digits::value(std_mm, Some(std_mm)),
        method = method.id()
    )
}

/// What was found, in one sentence.
#[must_use]
pub fn finding_message(finding: &Finding) -> String {
    match finding {
        Finding::QuaternionsNormalised { num_poses, worst_path, worst_norm } => format!(
            "{num_poses} quaternion{} normalised; the furthest off is {worst_path} with norm {worst_norm:.6}.",
            if *num_poses == 1 { " was" } else { "s were" }
        ),
        Finding::NoStations => "There are no stations yet.".to_owned(),
        Finding::FewStations { num_enabled, needed } => {
            format!("{num_enabled} enabled station{}: at least {needed} are needed to solve.", plural(*num_enabled))
        }
        Finding::EdgeWithoutStations { edge } => format!(
            "No enabled station saw edge {}: the plate is only known from both; set in Poses which edge each station saw.",
            edge_text(*edge)
        ),
        Finding::FewOnEdge { edge, num_enabled, needed } => format!(
            "{num_enabled} enabled station{} saw edge {}: at least {needed} are recommended on each.",
            plural(*num_enabled),
            edge_text(*edge)
        ),
        Finding::InFurther { name, finding } => format!("{name}: {}", finding_message(finding)),
        Finding::TwinStations { label, twin_label, distance_mm, angle_deg } => format!(
            "Stations {label} and {twin_label} have the same pose within {distance_mm:.2} mm and {angle_deg:.2}°: the second adds little."
        ),
        Finding::NoReading { label, capture_idx } => {
            format!("Station {label}, capture {}: nothing was measured at this pose.", capture_idx + 1)
        }
        Finding::EmptyProfile { label, capture_idx } => {
            format!("Station {label}, profile {}: no valid point.", capture_idx + 1)
        }
        Finding::PointOutsidePlane { label, capture_idx, y_mm } => format!(
            "Station {label}, capture {}: the point is {} mm outside the laser plane (y is 0 there): check its columns.",
            capture_idx + 1,
            digits::plain(*y_mm, 3)
        ),
        Finding::StepDiffersFromPose { label, capture_idx, step_mm, moved_mm } => format!(
            "Station {label}, profile {}: the step was {step_mm:.3} mm, but the recorded poses are {moved_mm:.3} mm apart.",
            capture_idx + 1
        ),
        Finding::FarPose { label, capture_idx, distance_mm } => format!(
            "Station {label}, profile {}: the pose is {:.1} m from the base; check that translations are in mm.",
            capture_idx + 1,
            distance_mm / 1000.0
        ),
        Finding::FarFromOthers { label, distance_mm, typical_mm } => format!(
            "Station {label} is {distance_mm:.0} mm from the middle of the stations, half of which are within {typical_mm:.0} mm: check digits, signs and units."
        ),
        Finding::NoiseNotGiven { fields } => {
            format!("Noise is not given and will be estimated: {}.", fields.join(", "))
        }
    }
}
