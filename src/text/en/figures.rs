//! The figures of a report: their captions, and what stands in them where the window says nothing of the kind.

use crate::calibrate::Method;
use crate::session::Target;

use super::method_name;

/// What stands before a station's name at the head of a small plot.
#[must_use]
pub fn station(label: &str) -> String {
    format!("Station {label}")
}

/// The same with the number of the capture, where there are several.
#[must_use]
pub fn station_step(label: &str, step: usize) -> String {
    format!("Station {label}, step {step}")
}

/// Caption of a station's profile with its arc.
#[must_use]
pub fn arc_title(label: &str, step: usize) -> String {
    format!("Profile of station {label}, step {step}, with the arc found in it and its residuals")
}

/// The same for a plate or a tip.
#[must_use]
pub fn edge_title(label: &str, feature: &str) -> String {
    format!("Profile of station {label} with the {feature} found in it and the residuals of its flanks")
}

/// Caption of the profiles of all stations.
#[must_use]
pub fn profiles_title(page: usize, num_pages: usize) -> String {
    format!("First usable profile of each station with its residuals{}", page_of(page, num_pages))
}

/// Caption of a station's curve.
#[must_use]
pub fn curve_title(label: &str) -> String {
    format!(
        "Section radius against the travel at station {label}: the whole curve, its peak ± σ, and the published stop"
    )
}

/// Caption of the curves of all stations.
#[must_use]
pub fn curves_title(page: usize, num_pages: usize) -> String {
    format!("Section radius against the travel at each station{}", page_of(page, num_pages))
}

fn page_of(page: usize, num_pages: usize) -> String {
    if num_pages > 1 { format!(" ({page} of {num_pages})") } else { String::new() }
}

/// The centre of a section beside its cross, or the point of an edge.
#[must_use]
pub fn centre(x_mm: &str, z_mm: &str) -> String {
    format!("x {x_mm}, z {z_mm}")
}

/// What a plot of an arc tells a reader who does not see it.
#[must_use]
pub fn arc_alt(title: &str, num_inliers: usize, num_outliers: usize, num_unused: usize, rms_um: &str) -> String {
    format!(
        "{title}: {num_inliers} inliers, {num_outliers} outliers, {num_unused} unused points, RMS residual {rms_um} µm."
    )
}

/// Legend of the points on what was found, without their number.
pub const INLIERS: &str = "inlier";
/// Legend of the points off it.
pub const OUTLIERS: &str = "outlier";
/// Legend of the points elsewhere.
pub const UNUSED: &str = "unused";
/// Legend of the fitted circle.
pub const SECTION: &str = "section";
/// Legend of the ball's outline.
pub const BALL: &str = "ball";
/// Legend of fitted lines.
pub const FLANKS: &str = "flanks";
/// Legend of the peak of a curve.
pub const PEAK: &str = "peak ± σ";
/// Legend of the published stop.
pub const PUBLISHED_STOP: &str = "published stop";

/// A caption of one of several targets.
#[must_use]
pub fn of_target(title: &str, target: &str) -> String {
    format!("{title} ({target})")
}

/// Heading of errors that the other stations see.
#[must_use]
pub const fn left_out(target: &Target) -> &'static str {
    match target {
        Target::RightAnglePlate => "Left out: distance from the edge found without the station",
        Target::Rgbd { .. } => "Left out: what the steps of a stretch are off by with the calibration made without it",
        _ => "Left out: distance (3D) from what the calibration made without the station predicts",
    }
}

/// Heading of errors as in the tables.
#[must_use]
pub const fn in_sample(target: &Target) -> &'static str {
    match target {
        Target::RightAnglePlate => "In sample: distance from the edge",
        Target::Rgbd { .. } => "In sample: distance (3D) of where a stretch puts the scene from the mean",
        _ => "In sample: distance (3D) from the mean of all stations",
    }
}

/// Caption of the errors of all stations.
#[must_use]
pub const fn errors_title(target: &Target) -> &'static str {
    match target {
        Target::RightAnglePlate => "Errors of all points by all methods",
        Target::Rgbd { .. } => "Errors of all stretches of the way",
        _ => "Errors of all stations by all methods",
    }
}

/// What the bars tell a reader who does not see them.
#[must_use]
pub fn errors_alt(target: &Target, title: &str, worst_mm: impl Iterator<Item = (Method, f64)>) -> String {
    let worst: Vec<String> = worst_mm.map(|(method, mm)| format!("{} {mm:.3} mm", method_name(method))).collect();
    format!("{title}. {}, the largest: {}.", in_sample(target), worst.join(", "))
}

/// Caption of the scatter of the target.
#[must_use]
pub const fn scatter_title(target: &Target) -> &'static str {
    match target {
        Target::RightAnglePlate => {
            "Points about their edges as seen along these, with 1σ ellipses, in the plate's frame"
        }
        Target::Pose { .. } => {
            "The target's origin as each station finds it, about the mean, with 1σ ellipses, in the base"
        }
        Target::Rgbd { .. } => {
            "The scene as each stretch of the way has it, about the mean, with 1σ ellipses, in the base"
        }
        Target::Point => "The tip as each station finds it, about the mean, with 1σ ellipses, in the base",
        _ => "The ball's centre as each station finds it, about the mean, with 1σ ellipses, in the base",
    }
}

/// Heading of left-out errors of the method to use.
pub const LEFT_OUT_BEST: &str = "Error when left out: off what the other stations say";
/// Heading of studentised residuals.
pub const STUDENTISED: &str = "Residual over what its noise lets one expect";
/// Legend of stations that stand out.
pub const HARDLY_CHANCE: &str = "hardly chance";
/// Heading of what leaving out a station moves.
pub const MOVES: &str = "How far the workspace point moves without the station";
/// Caption of the influence of stations.
pub const INFLUENCE_TITLE: &str = "What each station means for the result: left out, against its noise, and its pull";
/// Axis of residuals where there is little room: the title of the figure names them.
pub const SMALL_RESIDUAL_AXIS: &str = "res. / µm";
/// Legend of residuals.
pub const RESIDUALS: &str = "residuals";
/// Legend of the line that normal residuals lie on.
pub const NORMAL_LINE: &str = "normal distribution";

/// Heading of the plot of quantiles.
#[must_use]
pub fn normality_heading(p_value: f64) -> String {
    if p_value < 0.001 { "Normality, p < 0.001".to_owned() } else { format!("Normality, p = {p_value:.3}") }
}

/// Caption of the halves and the quantiles.
#[must_use]
pub const fn halves_title(has_halves: bool, has_quantiles: bool) -> &'static str {
    match (has_halves, has_quantiles) {
        (true, true) => {
            "How far apart two halves of the stations put the workspace point, and the residuals over their σ against normal quantiles"
        }
        (true, false) => "How far apart two halves of the stations put the workspace point",
        (false, _) => "Residuals over their σ against normal quantiles",
    }
}

/// What the halves tell a reader who does not see them.
#[must_use]
pub fn halves_alt(title: &str, median_mm: &str, expected_mm: &str) -> String {
    format!("{title}. Median {median_mm} mm apart, expected {expected_mm} mm.")
}

fn without(left_out: &[&str]) -> String {
    if left_out.is_empty() { String::new() } else { format!("; farther off and not shown: {}", left_out.join(" · ")) }
}

/// Caption of distances to lines and plane.
#[must_use]
pub fn distances_title(target: &str, left_out: &[&str]) -> String {
    format!("Distances of the points from their lines and from the plane: {target}{}", without(left_out))
}

/// Caption of the stability at a point.
#[must_use]
pub fn stability_title(target: &str, is_touched: bool, left_out: &[&str]) -> String {
    let from = if is_touched { "the touched point" } else { "the mean" };
    format!(
        "One point measured many times, against {from}, and at the right its mean ± 3δ: {target}{}",
        without(left_out)
    )
}

/// Name of the place where the limits at three standard deviations stand.
pub const THREE_DELTA: &str = "±3δ";
/// Axis title.
pub const MEASUREMENT_AXIS: &str = "measurement";
/// Axis title.
pub const RMS_AXIS: &str = "RMS distance (3D) / mm, logarithmic";
/// Legend of errors on own data.
pub const OWN_DATA: &str = "hollow: own data, in sample";
/// Caption of the cross-target figure.
pub const CROSS_TARGET_TITLE: &str = "Every calibration on the data of every target";

/// Legend of a target.
#[must_use]
pub fn on_target(target: &str) -> String {
    format!("on {target}")
}

/// Axis title.
pub const PLANE_DISTANCE_AXIS: &str = "distance from the plane / mm";
/// Axis title.
pub const PITCH_AXIS: &str = "pitch / mm";
/// Axis title.
pub const HEIGHT_AXIS: &str = "height / mm";
/// Axis title.
pub const TOOTH_AXIS: &str = "tooth";
/// Legend of nominal values.
pub const NOMINAL: &str = "nominal";

/// Legend of a plane.
#[must_use]
pub fn plane(name: &str) -> String {
    format!("plane {name}")
}

/// Caption of distances from planes.
#[must_use]
pub fn planes_title(part: &str, num_drawn: usize) -> String {
    format!("Distances of {num_drawn} points drawn at random from each plane: {part}")
}

/// Caption of teeth.
#[must_use]
pub fn teeth_title(part: &str) -> String {
    format!("Pitch and height of every tooth: {part}")
}

/// Heading of values with a nominal one.
#[must_use]
pub fn nominal(value_mm: &str) -> String {
    format!("nominal {value_mm} mm")
}

/// Name of the base in the sketch.
pub const BASE: &str = "base";
/// Legend of flange poses.
pub const FLANGE: &str = "flange at each station";
/// Legend of laser planes.
pub const LASER_PLANE: &str = "laser plane";

/// Legend of lines from the camera to the target.
pub const LINE_OF_SIGHT: &str = "line of sight";

/// Legend of the target; `is_point` where only one place of it is known.
#[must_use]
pub const fn target(target: &Target, is_point: bool) -> &'static str {
    match target {
        Target::Ball { .. } if is_point => "ball's centre",
        Target::Ball { .. } => "ball",
        Target::RightAnglePlate => "plate",
        Target::Point => "tip",
        Target::Pose { .. } => "target",
        Target::Workpiece => "workpiece",
        Target::Rgbd { .. } => "scene",
    }
}

/// Caption of the sketch; of a camera that sees a board or marker, or of a profiler.
#[must_use]
pub fn setup_title(target: &str, num_stations: usize, is_fixed: bool, is_camera: bool) -> String {
    let (sensor, rays) = if is_camera { ("camera", "lines of sight") } else { ("sensor", "laser planes") };
    if is_fixed {
        format!("The set-up: fixed {sensor}, {num_stations} poses of the flange with the {target}, without perspective")
    } else {
        format!("The set-up: base, {num_stations} stations with their {rays}, and the {target}, without perspective")
    }
}

/// Legend of a camera's way.
pub const FROM_IMAGES: &str = "from the images";
/// Legend of the way that is known.
pub const TRUE_WAY: &str = "truth";
/// Legend of where a way begins.
pub const FIRST_FRAME: &str = "first frame";
/// Legend of points.
pub const POINTS_MATCHED: &str = "points seen again";
/// Legend of points.
pub const POINTS_AGREEING: &str = "points that agree with the motion";
/// Axis title.
pub const RIGHT_AXIS: &str = "right / m";
/// Axis title.
pub const FORWARD_AXIS: &str = "forward / m";
/// Axis title.
pub const UP_AXIS: &str = "up / m";
/// Axis title.
pub const TIME_AXIS: &str = "time / s";
/// Axis title.
pub const DISTANCE_AXIS: &str = "way / m";
/// Axis title.
pub const HEADING_AXIS: &str = "turn / °";
/// Axis title.
pub const POINTS_AXIS: &str = "points";
/// Caption.
pub const CAMERA_WAY: &str =
    "The camera's way, as seen from its first frame: from above and from the side, equally long in all directions";

/// Caption; `has_gaps` where some frames have no motion.
#[must_use]
pub const fn motion_over_time(has_gaps: bool) -> &'static str {
    if has_gaps {
        "Way, turn to the right, and the points that the motion rests on; shaded where no motion was found"
    } else {
        "Way, turn to the right, and the points that the motion rests on"
    }
}

/// Legend of first captures.
pub const FIRST_CAPTURE: &str = "first capture of a station";
/// Legend of the way between stations.
pub const FROM_STATION_TO_STATION: &str = "from station to station";
/// Legend of the other captures of a station.
pub const FURTHER_CAPTURES: &str = "its further captures";
/// Axis title.
pub const FLANGE_X_AXIS: &str = "flange x / mm";
/// Axis title.
pub const FLANGE_Y_AXIS: &str = "flange y / mm";
/// Axis title.
pub const FLANGE_Z_AXIS: &str = "flange z / mm";

/// Caption of the trajectory.
#[must_use]
pub fn trajectory_title(num_stations: usize, num_captures: usize) -> String {
    format!(
        "Positions of the flange in the base: {num_captures} captures of {num_stations} stations, from above and from the side"
    )
}
