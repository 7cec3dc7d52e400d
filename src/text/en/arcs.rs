//! The arcs panel.

use crate::fit::CircleMethod;
use crate::session::Target;

/// Title of the list.
pub const STATIONS: &str = "Stations";
/// Head of the column of steps.
pub const STEPS: &str = "steps";
/// Head of the column of section radii.
pub const SECTION_RADIUS: &str = "l / mm";
/// Head of the column of residuals.
pub const RMS: &str = "µm";
/// What the section radius column says, on hover.
pub const SECTION_RADIUS_HINT: &str = "section radius l of the station's first usable profile";
/// What the residual column says, on hover.
pub const RMS_HINT: &str = "root mean square distance of the inliers from the circle, over all profiles of the station";
/// Before the fit chooser.
pub const FIT: &str = "Fit";
/// Before the step buttons.
pub const STEP: &str = "step";
/// The same where the profiles of a station are no steps.
pub const PROFILE: &str = "profile";
/// Name of the button to the step before.
pub const PREVIOUS_STEP: &str = "Previous step";
/// Name of the button to the next step.
pub const NEXT_STEP: &str = "Next step";
/// On the right of the profile's card.
pub const TRUE_SCALE: &str = "true scale";
/// Toggle: the view holds all points of the profile.
pub const WHOLE_PROFILE: &str = "whole profile";
/// The same, on hover.
#[must_use]
pub const fn whole_profile_hint(target: &Target) -> &'static str {
    match target {
        Target::Ball { .. } => "Show all points, also those that are not of the ball",
        _ => "Show all points of the profile",
    }
}

/// Of the toggle that shows an edge, a corner, a step or a tip.
pub const EDGE_ONLY_HINT: &str = "Show the point that was found and what is around it";
/// Toggle: the view holds the arc.
pub const ARC_ONLY: &str = "arc";
/// The same, on hover.
pub const ARC_ONLY_HINT: &str = "Show the arc and the ball around it";
/// Title of the curve's card.
pub const RADIUS_AGAINST_STEP: &str = "Radius against step";
/// Axis title.
pub const X_AXIS: &str = "x / mm";
/// Axis title of the range axis; the sensor is at the top of the plot.
pub const Z_AXIS: &str = "z / mm   (away from sensor ↓)";
/// The same in a low plot.
pub const Z_AXIS_SHORT: &str = "z / mm ↓";
/// Axis title.
pub const RESIDUAL_AXIS: &str = "residual / µm";
/// Axis title.
pub const TRAVEL_AXIS: &str = "travel along y / mm";
/// Axis title.
pub const RADIUS_AXIS: &str = "section radius l / mm";
/// Axis title.
pub const CURVE_RESIDUAL_AXIS: &str = "l − curve / µm";
/// Label of the line at the ball's radius.
pub const BALL_RADIUS_LINE: &str = "l = R";
/// Legend of the measured radii.
pub const MEASURED: &str = "measured";
/// Legend of the fitted curve.
pub const FITTED: &str = "√(R² − (y − y₀)²)";
/// The same where the steps go across the laser plane at a slant.
#[must_use]
pub fn fitted_at_slant(curvature: f64) -> String {
    format!("√(R² − c (y − y₀)²), c = {curvature:.3}")
}
/// Title of the strip at the bottom.
pub const RULE_AND_CURVE: &str = "Published rule and whole curve";
/// A sweep that does not reach the largest arc.
pub const PEAK_NOT_COVERED: &str = "The sweep ends before the largest arc.";
/// Nothing was measured in a profile yet.
pub const NOT_MEASURED: &str = "Not measured yet: the profiles are being looked through.";
/// In place of the curve for a station with one profile.
pub const NO_SWEEP: &str = "One profile here: record a sweep to see the radius against the step.";
/// In place of the curve where there are several profiles but no method evaluated them.
pub const SWEEP_NOT_EVALUATED: &str = "No largest-arc method evaluated this station's steps.";
/// In place of the curve of a station that does not take part.
pub const STATION_LEFT_OUT: &str = "This station is left out: tick it in Compare or Poses to see its curve.";
/// In place of the profile where there is none.
#[must_use]
pub const fn point_reading(target: &Target) -> &'static str {
    match target {
        Target::RightAnglePlate => {
            "This station holds a point on an edge that was already reduced elsewhere; there is no profile to look at."
        }
        Target::Point => "This station holds a tip that was already reduced elsewhere; there is no profile to look at.",
        _ => "This station holds a ball centre that was already reduced elsewhere; there is no profile to look at.",
    }
}

/// Head of the column of edges.
pub const EDGE: &str = "edge";
/// What it says, on hover.
pub const EDGE_HINT: &str = "the plate's edge that the laser line crosses at this station";
/// Head of a coordinate of the point found.
pub const POINT_X: &str = "x / mm";
/// The other one.
pub const POINT_Z: &str = "z / mm";
/// What they say, on hover.
pub const POINT_HINT: &str = "where the laser line crosses the edge, in the laser plane; of the first usable profile";
/// The same for a tip.
pub const TIP_HINT: &str = "where the tip is in the laser plane; of the first usable profile";
/// Title of the card with all points.
pub const IN_LASER_PLANE: &str = "All points in the laser plane";
/// What the card is good for, on its right.
pub const SPREAD_HINT: &str = "the wider, the better";
/// The same, on hover.
pub const SPREAD_HINT_LONG: &str = "The calibration knows the sensor's plane from where the points lie in it: points near one place leave it unsure elsewhere";
/// In place of that card.
pub const NO_POINTS: &str = "No profile has given a point yet; the list says why.";

/// Head of the column of points of a scan.
pub const POINTS: &str = "points";
/// What it says, on hover.
pub const POINTS_HINT: &str = "points of the surface that the profiles hold";
/// Head of the column of depths.
pub const DEPTH: &str = "Δz / mm";
/// What it says, on hover.
pub const DEPTH_HINT: &str = "from the nearest to the farthest point, along the sensor's z";
/// A profile of a scan without points.
pub const EMPTY_PROFILE: &str = "No valid point in this profile: nothing was in the sensor's range.";
/// Title of the card with all profiles of a scan.
pub const RANGES: &str = "Range of every profile";
/// What leads on, on its right.
pub const RANGES_HINT: &str = "measured in Verify";
/// The same, on hover.
pub const RANGES_HINT_LONG: &str =
    "A scan needs no arcs: with a calibration its points become a surface, which Verify → Workpiece shows and measures";
/// In place of that card.
pub const NO_RANGES: &str = "No profile of this scan holds a valid point.";
/// Axis title.
pub const PROFILE_AXIS: &str = "profile of the scan";

/// Legend of the points of a scan's profile.
#[must_use]
pub fn points(num_valid: usize, num_points: usize) -> String {
    format!("point {num_valid} of {num_points}")
}

/// Legend of the bars of a scan.
#[must_use]
pub fn ranges(num_seen: usize, num_profiles: usize) -> String {
    format!("nearest to farthest point, {num_seen} of {num_profiles} profiles")
}

/// Readout of a profile of a scan.
#[must_use]
pub fn range_readout(number: usize, near_mm: &str, far_mm: &str) -> String {
    format!("profile {number}\nz {near_mm} … {far_mm} mm")
}

/// What a profile of a scan holds.
#[must_use]
pub fn scan_line(num_valid: usize, num_points: usize, x_mm: &[String; 2], z_mm: &[String; 2]) -> String {
    format!("{num_valid} of {num_points} points, x {} … {}, z {} … {} mm", x_mm[0], x_mm[1], z_mm[0], z_mm[1])
}

/// Legend of an edge's points.
#[must_use]
pub fn points_of_edge(edge: &str, count: usize) -> String {
    format!("edge {edge} {count}")
}

/// Legend of tips, or of boards.
#[must_use]
pub fn tips(target: &Target, count: usize) -> String {
    if matches!(target, Target::Pose { .. }) { format!("target's origin {count}") } else { format!("tip {count}") }
}

/// Title of the card with the points of all stations.
#[must_use]
pub const fn all_points(target: &Target) -> &'static str {
    if matches!(target, Target::Pose { .. }) { "All targets as seen from above" } else { IN_LASER_PLANE }
}

/// Why their spread matters.
#[must_use]
pub const fn spread_hint_long(target: &Target) -> &'static str {
    if matches!(target, Target::Pose { .. }) {
        "Where the target was in the sensor's x and z: seen in one place only, the calibration is unsure elsewhere"
    } else {
        SPREAD_HINT_LONG
    }
}

/// Readout of a point in the laser plane.
#[must_use]
pub fn spread_readout(label: &str, x_mm: &str, z_mm: &str) -> String {
    format!("station {label}\nx {x_mm}  z {z_mm} mm")
}

/// Legend of the fitted lines.
#[must_use]
pub const fn flanks(count: usize) -> &'static str {
    if count == 1 { "flank" } else { "flanks" }
}

/// What was found in a profile.
#[must_use]
pub fn edge_found(feature: &str, x_mm: &str, z_mm: &str) -> String {
    format!("{feature} at x {x_mm}, z {z_mm} mm")
}

/// In place of the panel without a session.
pub const NO_SESSION: &str = "Open a session, or one of the samples, to see its profiles.";
/// In place of the panel for a session without stations.
pub const NO_STATIONS: &str = "This session has no stations yet: record profiles, or import poses.";
/// Shown on results of an earlier revision.
pub const OUT_OF_DATE: &str = "out of date";

/// The fit's name in the chooser.
#[must_use]
pub const fn circle_method(method: CircleMethod) -> &'static str {
    match method {
        CircleMethod::Robust => "robust geometric",
        CircleMethod::Geometric => "geometric",
        CircleMethod::Hyper => "hyper",
        CircleMethod::Taubin => "Taubin",
        CircleMethod::Pratt => "Pratt",
        CircleMethod::Kasa => "Kåsa",
    }
}

/// What another fit makes of the same inliers.
#[must_use]
pub fn fit_shift(dx: &str, dz: &str, dl: &str) -> String {
    format!("against robust: Δx {dx}  Δz {dz}  Δl {dl} µm")
}

/// Position in the sweep.
#[must_use]
pub fn step_of(step: usize, num_steps: usize) -> String {
    format!("{step} of {num_steps}")
}

/// Angle between travel and normal.
#[must_use]
pub fn travel_off_normal(angle_deg: f64) -> String {
    format!("travel is {angle_deg:.1}° off the laser's normal")
}

/// Title of the profile's card.
#[must_use]
pub fn profile_title(label: &str, step: usize) -> String {
    format!("Profile {label}.{step}")
}

/// Legend of the points on the arc.
#[must_use]
pub fn inliers(count: usize) -> String {
    format!("inlier {count}")
}

/// Legend of the points off the arc.
#[must_use]
pub fn outliers(count: usize) -> String {
    format!("outlier {count}")
}

/// Legend of the points elsewhere.
#[must_use]
pub fn unused(count: usize) -> String {
    format!("unused {count}")
}

/// Legend of the fitted circle.
#[must_use]
pub fn section(radius_mm: &str) -> String {
    format!("section {radius_mm}")
}

/// Legend of the ball's outline.
#[must_use]
pub fn ball(radius_mm: &str) -> String {
    format!("ball {radius_mm}")
}

/// Label of the peak.
#[must_use]
pub fn peak(travel_mm: &str, std_mm: &str) -> String {
    format!("peak {travel_mm} ± {std_mm}")
}

/// Label of the published stop.
#[must_use]
pub fn published_stop(travel_mm: &str) -> String {
    format!("published stop {travel_mm}")
}

/// What the two evaluations of the sweep are good for.
#[must_use]
pub fn rule_and_curve(stop_std_mm: &str, num_steps: usize, peak_std_mm: &str) -> String {
    format!(
        "The arc hardly grows near its largest: stopping at the first l ≥ R is good to about ±{stop_std_mm} mm here; the fit over all {num_steps} steps to ±{peak_std_mm} mm."
    )
}

/// Refused profiles of a station.
#[must_use]
pub fn refused_captures(num_refused: usize, num_captures: usize) -> String {
    format!("{num_refused} of {num_captures} profiles hold nothing usable.")
}

/// Label of the section's centre, in two lines so that it has room inside the circle.
#[must_use]
pub fn centre(x_mm: &str, z_mm: &str) -> String {
    format!("({x_mm},\n {z_mm})")
}

/// Readout of a point of the profile.
#[must_use]
pub fn point_readout(x_mm: &str, z_mm: &str, residual_um: &str) -> String {
    format!("x {x_mm}  z {z_mm} mm\nresidual {residual_um} µm")
}

/// Readout of a step of the sweep.
#[must_use]
pub fn step_readout(step: usize, travel_mm: &str, radius_mm: &str, std_mm: &str, residual_um: &str) -> String {
    format!("step {step} at {travel_mm} mm\nl {radius_mm} ± {std_mm} mm\nl − curve {residual_um} µm")
}

/// Name of a station's row for a screen reader.
#[must_use]
pub fn station_name(label: &str) -> String {
    format!("Station {label}")
}

/// Name of a step's row for a screen reader.
#[must_use]
pub fn step_name(label: &str, step: usize) -> String {
    format!("Station {label}, step {step}")
}

/// Name of the button that shows a station's steps.
#[must_use]
pub fn expand(label: &str) -> String {
    format!("Steps of station {label}")
}

/// A reading that is already a point.
#[must_use]
pub fn point_coordinates(target: &Target, x: &str, y: &str, z: &str) -> String {
    let name = match target {
        Target::RightAnglePlate => "point",
        Target::Point => "tip",
        _ => "ball",
    };
    format!("{name} in sensor: ({x}, {y}, {z}) mm")
}
