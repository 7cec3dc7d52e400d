//! Wording of the Verify step and of `handeye verify`.

use crate::calibrate::Edge;
use crate::session::Target;
use crate::verify::{MatrixCheck, Origin, Suspect, Verification};

use super::methods::{method_name, method_short_name};

/// Where no session is open.
pub const NO_SESSION: &str = "Open a session to see what its calibration is worth on other data.";
/// Heading of a section.
pub const DISTANCES: &str = "Distances to lines and plane";
/// Heading of a section.
pub const STABILITY: &str = "Stability at a known point";
/// Heading of a section.
pub const CROSS_TARGET: &str = "On other targets";
/// Heading of a section.
pub const WORKPIECE: &str = "Workpiece";
/// While the first verification is under way.
pub const VERIFYING: &str = "Trying every calibration on every target …";
/// Where the verification was cancelled.
pub const NOT_VERIFIED: &str = "Nothing was verified yet. Change or solve the session to start.";
/// Where figures belong to an earlier state of the session.
pub const OUT_OF_DATE: &str = "out of date";
/// Where there is no calibration.
pub const NO_CALIBRATION: &str =
    "No method gave a calibration yet. Add stations, see what Diagnosis says, or paste a matrix under \"Stability\".";

/// Menu entry and button.
pub const ADD_TARGET: &str = "Add data of another target…";
/// Heading of the question for its path.
pub const ADD_TARGET_TITLE: &str = "Session with another target of the same sensor";
/// The button below it.
pub const ADD_TARGET_BUTTON: &str = "Add target";
/// Hint of the button.
pub const ADD_TARGET_HINT: &str =
    "Reads a session measured with the same sensor on the same robot; its target is kept in this session";

/// Names of a session's own target.
#[must_use]
pub const fn own_target_name(target: &Target) -> &'static str {
    match target {
        Target::Ball { .. } => "ball",
        Target::RightAnglePlate => "plate",
        Target::Point => "tip",
        Target::Workpiece => "workpiece",
        Target::Rgbd { .. } => "sequence",
    }
}

/// A target from a session without a name is called as its file.
#[must_use]
pub fn target_name_from_file(file_name: &str) -> String {
    if file_name.trim().is_empty() { "target".to_owned() } else { file_name.to_owned() }
}

/// Why a session cannot be a further target.
#[must_use]
pub fn other_mount(file: &str) -> String {
    format!(
        "{file} was not added: its sensor is mounted otherwise (on the flange, or beside the robot), so it is another calibration. \
         Choose a session of the same sensor"
    )
}

/// The name of a calibration: what it was computed from and how.
#[must_use]
pub fn calibration_name(origin: &Origin, verification: &Verification) -> String {
    match origin {
        Origin::Solved { target_idx: 0, method } => method_name(*method).to_owned(),
        Origin::Solved { target_idx, method } => match verification.targets.get(*target_idx) {
            Some(target) => format!("{}, {}", target.name, method_short_name(*method)),
            None => method_name(*method).to_owned(),
        },
        Origin::Joint { .. } => "All targets together".to_owned(),
        Origin::Given { name } => name.clone(),
    }
}

/// The letter of an edge.
#[must_use]
pub const fn edge_letter(edge: Edge) -> &'static str {
    match edge {
        Edge::P => "p",
        Edge::Q => "q",
    }
}

/// Whether a matrix is a rotation, in one sentence.
#[must_use]
pub fn matrix_verdict(check: &MatrixCheck) -> String {
    if check.is_rotation() {
        return "A rotation, as far as its digits tell".to_owned();
    }
    if check.nearest.is_none() {
        return "Not a rotation, and none is near it".to_owned();
    }
    if check.determinant < 0.0 && check.suspect.is_none() {
        return "Not a rotation but a mirror image: one axis points the other way".to_owned();
    }
    "Not a rotation".to_owned()
}

/// What is probably misprinted.
#[must_use]
pub fn suspect_sentence(suspect: &Suspect) -> String {
    format!(
        "Row {}, column {} is {}; with {} there the defect falls to {:.3}",
        suspect.row + 1,
        suspect.column + 1,
        suspect.found,
        suspect.likely,
        suspect.defect_then
    )
}
