//! The comparison panel.

use crate::calibrate::{Method, Solution, VerdictReason};
use crate::session::Target;
use crate::text::digits;

use super::{methods, warnings};

/// In place of the panel without a session.
pub const NO_SESSION: &str = "Open a session, or one of the samples, to compare the methods on it.";
/// In place of the panel before the first results.
pub const CANCELLED: &str = "Solving was cancelled. \"Solve\" at the bottom right starts it again.";
/// While the first result is on its way.
pub const SOLVING: &str = "Solving: the methods appear here as soon as the first result is there.";
/// Shown on results of an earlier revision.
pub const OUT_OF_DATE: &str = "out of date";
/// Toggles the reasons of the verdict.
pub const WHY: &str = "Why?";
/// No method gave a result.
pub const NO_METHOD: &str = "No method could compute a calibration; the reasons stand below.";
/// Errors relative to the first station, as in the paper.
pub const FROM_FIRST: &str = "from first";
/// The same, on hover.
pub const FROM_FIRST_HINT: &str = "Errors relative to the first station, as in the paper";
/// Errors about the mean.
pub const ABOUT_MEAN: &str = "about mean";
/// The same, on hover.
pub const ABOUT_MEAN_HINT: &str = "Errors about the mean of the stations used: no station is singled out";
/// Toggles the layout of the paper's tables.
pub const PAPER_LAYOUT: &str = "paper layout";
/// Toggles the matrices.
pub const MATRICES: &str = "matrices";
/// Head of the first column.
pub const STATION: &str = "station";
/// Head of a column: a part of a camera's way.
pub const STRETCH: &str = "stretch";
/// Head of columns: where a stretch puts the scene.
pub const SCENE_IN_BASE: &str = "scene in base / mm";
/// Head over the coordinates of a method's target in the base.
#[must_use]
pub const fn in_base(method: Method) -> &'static str {
    match method {
        Method::PlateOrthogonal | Method::PlateBundle => "point in base / mm",
        Method::FixedPoint => "tip in base / mm",
        Method::Motion => "target in base / mm",
        Method::BallFixedPoint | Method::BallMaxArcStep | Method::BallMaxArc | Method::BallBundle => {
            "ball in base / mm"
        }
    }
}

/// Head over distances from an edge.
pub const OFF_EDGE: &str = "off edge / mm";
/// Head over the errors from the first station used.
#[must_use]
pub fn error_from_first(label: &str, is_station: bool) -> String {
    let what = if is_station { "station " } else { "" };
    format!("error from {what}{label} / mm")
}

/// Head over the errors about the mean.
pub const ERROR_FROM_MEAN: &str = "error about the mean / mm";
/// Head of the error's size.
pub const ERROR_SIZE: &str = "|e|";
/// Paper layout: number.
pub const NUMBER: &str = "no.";
/// Paper layout: translation.
pub const TRANSLATION: &str = "translation / mm";
/// Paper layout: rotation.
pub const QUATERNION: &str = "quaternion";
/// Paper layout: the target in the sensor frame.
#[must_use]
pub const fn in_sensor(method: Method) -> &'static str {
    match method {
        Method::PlateOrthogonal | Method::PlateBundle => "point in sensor / mm",
        Method::FixedPoint => "tip in sensor / mm",
        Method::Motion => "target in sensor / mm",
        Method::BallFixedPoint | Method::BallMaxArcStep | Method::BallMaxArc | Method::BallBundle => {
            "ball in sensor / mm"
        }
    }
}

/// Paper layout: error.
pub const ERROR: &str = "error / mm";
/// Legend of the tints.
pub const TINT_LEGEND: &str = "error ≥";
/// Unit of the tints' legend.
pub const TINT_UNIT: &str = "mm";
/// A station that takes no part.
pub const LEFT_OUT: &str = "left out";
/// A station that takes part, but which this method could not use.
pub const NOT_USED: &str = "not used by this method";
/// Title of the bars.
#[must_use]
pub const fn error_per_station(target: &Target) -> &'static str {
    match target {
        Target::RightAnglePlate => "Off edge per point",
        Target::Rgbd { .. } => "Error per stretch of the way",
        _ => "Error per station",
    }
}

/// Bars show left-out errors.
pub const BARS_LEFT_OUT: &str = "left out";
/// What left-out errors are.
pub const BARS_LEFT_OUT_HINT: &str =
    "Each station against the calibration made without it: what a new station would see";
/// Bars show in-sample errors.
pub const BARS_IN_SAMPLE: &str = "in sample";
/// What in-sample errors are.
pub const BARS_IN_SAMPLE_HINT: &str = "As in the tables above";
/// Axis title.
pub const STATION_AXIS: &str = "station";
/// Axis title.
pub const ERROR_AXIS: &str = "error / mm";
/// Title of the scatter plots.
#[must_use]
pub const fn scatter_title(target: &Target) -> &'static str {
    match target {
        Target::RightAnglePlate => "Points about their edges, 1σ",
        Target::Point => "Tips, 1σ",
        Target::Pose { .. } => "Origins of the target, 1σ",
        Target::Rgbd { .. } => "Where each stretch puts the scene, 1σ",
        _ => "Ball centres, 1σ",
    }
}

/// On the right of the scatter plots.
#[must_use]
pub const fn scatter_hint(target: &Target) -> &'static str {
    match target {
        Target::RightAnglePlate => "seen along the edges, plate frame",
        _ => "about their mean, base frame",
    }
}

/// Axis title: across edge p, in the plate's plane.
pub const ACROSS_P_AXIS: &str = "p: in the plate / mm";
/// Axis title: across edge q, in the plate's plane.
pub const ACROSS_Q_AXIS: &str = "q: in the plate / mm";
/// Axis title: along the plate's normal.
pub const OFF_PLATE_AXIS: &str = "off the plate / mm";
/// Axis title.
pub const X_AXIS: &str = "x / mm";
/// Axis title.
pub const Y_AXIS: &str = "y / mm";
/// Axis title.
pub const Z_AXIS: &str = "z / mm";
/// Title of the difference table.
pub const DIFFERENCE: &str = "Difference of the calibrations";
/// On the right of the difference table.
pub const DIFFERENCE_HINT: &str = "second relative to first";
/// Head of the column of angles.
pub const ROTATION: &str = "rotation";
/// Head of the column of distances.
pub const AT_WORKSPACE_POINT: &str = "at workspace point";
/// The same in two lines, where columns are narrow.
pub const AT_WORKSPACE_POINT_NARROW: &str = "at workspace\npoint";
/// Head of the column of significance.
pub const WITHIN: &str = "within 2 σ";
/// Instead of a significance.
pub const NO_STD: &str = "σ unknown";
/// In place of the difference table.
pub const NOTHING_TO_COMPARE: &str =
    "A second method with a result is needed to compare; the cards above say what each method lacks.";
/// Title of the published card.
pub const AS_PUBLISHED: &str = "As published";
/// In place of a caption that cannot be shown.
pub const CAPTION_IN_OTHER_LETTERS: &str = "its caption is in letters that this window does not have";
/// Published card: printed error.
pub const PRINTED_ERROR: &str = "printed error / mm";
/// Published card: recomputed error.
pub const RECOMPUTED_ERROR: &str = "error of the printed centres / mm";
/// Published card: no misprints.
pub const NO_MISPRINTS: &str = "the printed errors follow from the printed centres";
/// Row of the distance from the truth.
pub const FROM_TRUTH: &str = "distance from truth";
/// Title of a matrix.
pub const FLANGE_FROM_SENSOR: &str = "flange_from_sensor";
/// Title of a matrix for a sensor beside the robot.
pub const BASE_FROM_SENSOR: &str = "base_from_sensor";

/// The headline beside the verdict; the figure follows in the second weight.
#[must_use]
pub fn headline(distance_mm: &str) -> String {
    format!("a point at {distance_mm} mm:")
}

/// The same where the session states no distance.
#[must_use]
pub fn headline_amid_seen(method: Method, z_mm: &str) -> String {
    let seen = match method {
        Method::PlateOrthogonal | Method::PlateBundle => "the points",
        Method::FixedPoint => "the tips",
        Method::Motion => "what was",
        Method::BallFixedPoint | Method::BallMaxArcStep | Method::BallMaxArc | Method::BallBundle => "the balls",
    };
    format!("a point amid {seen} seen, z = {z_mm} mm:")
}

/// The method behind the verdict; `is_continued` by the headline.
#[must_use]
pub fn judged_method(method: &str, is_continued: bool) -> String {
    format!("· {method}{}", if is_continued { ":" } else { "" })
}

/// The headline's figure.
#[must_use]
pub fn headline_figure(std_mm: &str) -> String {
    format!("± {std_mm} mm")
}

/// Whose verdict it is.
#[must_use]
pub fn verdict_of(method: &str) -> String {
    format!("Verdict on “{method}”")
}

/// Beginning of the comparison.
#[must_use]
pub fn maximum_error(method: Method) -> String {
    let figure = if Method::PLATE.contains(&method) { "left-out error" } else { "max error" };
    format!("{}: {figure}", methods::method_short_name(method))
}

/// End of the comparison.
#[must_use]
pub fn against(baseline: &str, error_mm: &str) -> String {
    format!("against {baseline} ({error_mm} mm)")
}

/// End of the comparison where the two are alike.
#[must_use]
pub fn no_better_than(baseline: &str, error_mm: &str) -> String {
    format!("no better than {baseline} ({error_mm} mm)")
}

/// What the comparison's figure means.
#[must_use]
pub fn maximum_error_hint(method: Method) -> &'static str {
    if Method::PLATE.contains(&method) { LEFT_OUT_HINT } else { MAXIMUM_ERROR_HINT }
}

const LEFT_OUT_HINT: &str =
    "How far the points of a station are from the edges that the other stations show, RMS over all stations";

const MAXIMUM_ERROR_HINT: &str = "As in the paper: the largest coordinate of any station's ball relative to the first station's. A small value alone proves little; see the left-out error";

/// Figures at the right of a method's head.
#[must_use]
pub fn method_figures(max_mm: &str, left_out_mm: Option<&str>, std_mm: Option<&str>) -> String {
    let left_out = left_out_mm.map_or_else(String::new, |left_out_mm| format!(" · left out {left_out_mm}"));
    let std = std_mm.map_or_else(String::new, |std_mm| format!(" · σ {std_mm}"));
    format!("max {max_mm}{left_out}{std} mm")
}

/// What the figures in a method's head mean.
#[must_use]
pub const fn method_figures_hint(is_of_plate: bool) -> &'static str {
    if is_of_plate { PLATE_FIGURES_HINT } else { METHOD_FIGURES_HINT }
}

const PLATE_FIGURES_HINT: &str = "max: largest distance of a point from its edge\nleft out: RMS distance, each station's points from the edges found without it\nσ: standard deviation of a point in the workspace";

const METHOD_FIGURES_HINT: &str = "max: largest coordinate of the errors shown\nleft out: RMS over stations, each predicted by the others\nσ: standard deviation of a point in the workspace";

/// Name of a station's tick box.
#[must_use]
pub fn use_station(label: &str, method: &str) -> String {
    format!("Use station {label} ({method})")
}

/// Name of a station's row.
#[must_use]
pub fn station_row(label: &str, method: &str) -> String {
    format!("Station {label}, {method}")
}

/// Name of a method's toggle.
#[must_use]
pub fn show_method(method: &str) -> String {
    format!("Show {method}")
}

/// Name of a method's head, a button that selects it.
#[must_use]
pub fn select_method(method: &str) -> String {
    format!("Select {method} for the inspector")
}

/// Distance from the truth.
#[must_use]
pub fn truth_figures(distance_mm: &str, rotation_deg: &str) -> String {
    format!("{distance_mm} mm at the workspace point, {rotation_deg}°")
}

/// A pair of methods.
#[must_use]
pub fn pair(first: &str, second: &str) -> String {
    format!("{first} → {second}")
}

/// A pair of methods in two lines, where columns are narrow.
#[must_use]
pub fn pair_in_two_lines(first: &str, second: &str) -> String {
    format!("{first}\n→ {second}")
}

/// Whether a difference is within its standard deviation.
#[must_use]
pub fn within(is_within: bool, in_stds: &str) -> String {
    format!("{}, {in_stds} σ", if is_within { "yes" } else { "no" })
}

/// Misprints in the published table.
#[must_use]
pub fn misprints(count: usize) -> String {
    if count == 1 { "1 misprint".to_owned() } else { format!("{count} misprints") }
}

/// A misprinted coordinate.
#[must_use]
pub fn misprint(printed: &str, recomputed: &str) -> String {
    format!("printed {printed}, but the printed centres give {recomputed}")
}

/// Readout of a bar or a centre.
#[must_use]
pub fn station_readout(label: &str, method: &str, figures: &str) -> String {
    format!("station {label}, {method}\n{figures} mm")
}

/// The verdict's reason in one sentence.
#[must_use]
pub fn verdict_reason(solution: &Solution, reason: VerdictReason) -> String {
    match reason {
        VerdictReason::WorkspacePoint(std_mm) => {
            format!("A point in the workspace is known to ± {} mm (1 σ).", digits::value(std_mm, Some(std_mm)))
        }
        VerdictReason::LeaveOneOut { left_out_mm, std_mm } => format!(
            "A point in the workspace is known to ± {} mm (1 σ). Stations that the others predict are missed by {} mm RMS, their own noise included; the larger figure decides.",
            digits::value(std_mm, Some(std_mm)),
            digits::value(left_out_mm, Some(left_out_mm))
        ),
        VerdictReason::Warning(warning_idx) => solution.warnings.get(warning_idx).map_or_else(String::new, |warning| {
            format!("The figures are small, but: {}", warnings::warning_message(warning))
        }),
        VerdictReason::NoRedundancy => {
            "There are only as many stations as unknowns need: nothing is left over to judge by. Add stations."
                .to_owned()
        }
    }
}

/// The scale of the verdict.
#[must_use]
pub fn verdict_scale(good_mm: f64, usable_mm: f64) -> String {
    format!(
        "{} up to {good_mm} mm, {} up to {usable_mm} mm.",
        methods::verdict_name(crate::calibrate::Verdict::Good),
        methods::verdict_name(crate::calibrate::Verdict::Usable).to_lowercase()
    )
}

/// Title of the card of closed forms.
pub const CLOSED_FORMS: &str = "Published closed forms";
/// What it is for.
pub const CLOSED_FORMS_HINT: &str = "on the same data; residual: RMS";
/// Its columns.
pub const CLOSED_FORM_COLUMNS: [&str; 4] = ["from refined / mm", "/ °", "residual / mm", "/ °"];
/// Where a closed form has no answer.
pub const CLOSED_FORM_SINGULAR: &str = "its equations are singular here";
