//! Sentences and remedies of the warnings.

use crate::calibrate::{PoseFault, Warning};

/// What is the matter, in one sentence.
#[must_use]
pub fn warning_message(warning: &Warning) -> String {
    match warning {
        Warning::FewStations { num_stations, recommended } => format!(
            "Only {num_stations} stations: the figures rest on very little, {recommended} or more make them trustworthy."
        ),
        Warning::FewEdgePoints { num_p, num_q, recommended } => format!(
            "Only {num_p} points on edge p and {num_q} on edge q: the figures rest on very little, {recommended} or more on each make them trustworthy."
        ),
        Warning::OtherMinimum { ratio, distance_mm } => format!(
            "Another mounting, {distance_mm:.0} mm from this one, fits the points about as well: its residual is {ratio:.1} times as large."
        ),
        Warning::LittleRotation { span_deg, recommended_deg } => format!(
            "The orientations differ by {span_deg:.1}° at most; below {recommended_deg:.0}° a small residual says little about the accuracy."
        ),
        Warning::NearlyOneAxis { ratio, axis_in_flange: [x, y, z] } => format!(
            "The rotations are almost all about one axis, ({x:.2}, {y:.2}, {z:.2}) in the flange: about others they are {ratio:.0} times smaller, so the sensor's place along it is poorly known."
        ),
        Warning::SideAmbiguous { labels, ratio } => format!(
            "Station{} {}: the side of the ball is uncertain, the other side costs only {ratio:.1} times as much.",
            if labels.len() == 1 { "" } else { "s" },
            labels.join(", ")
        ),
        Warning::BlindInY { labels, std_y_mm, std_xz_mm } => format!(
            "Station{} {}: the section is so near the largest that y is known to ±{std_y_mm:.3} mm only, against ±{std_xz_mm:.3} mm in x and z.",
            if labels.len() == 1 { "" } else { "s" },
            labels.join(", ")
        ),
        Warning::ArcLargerThanBall { label, capture_idx, section_radius_mm, ball_radius_mm } => format!(
            "Station {label}, profile {}: the section radius {section_radius_mm:.3} mm is above the ball's {ball_radius_mm:.3} mm.",
            capture_idx + 1
        ),
        Warning::CaptureRefused { label, capture_idx, reason, num_others } => {
            let others = match num_others {
                0 => String::new(),
                1 => " One more is left out.".to_owned(),
                _ => format!(" {num_others} more are left out."),
            };
            format!("Station {label}, profile {} is left out: {reason}.{others}", capture_idx + 1)
        }
        Warning::RadiusDisagrees { found_mm, std_mm, ball_radius_mm } => format!(
            "The sweeps fit a ball of radius {found_mm:.3} ± {std_mm:.3} mm, the session says {ball_radius_mm:.3} mm."
        ),
        Warning::StationSkipped { label, found, needed } => format!(
            "Station {label} is left out: it has {found} usable profile{}, this method needs {needed}.",
            if *found == 1 { "" } else { "s" }
        ),
        Warning::TravelOffNormal { label, angle_deg } => format!(
            "The robot travels {angle_deg:.1}° off the laser's normal at station {label}; the published method takes the travel for the normal."
        ),
        Warning::PeakNotCovered { label, beyond_mm } => {
            format!("The sweep at station {label} ends {beyond_mm:.2} mm before the largest arc.")
        }
        Warning::StepDiffersFromPose { label, difference_mm } => format!(
            "At station {label} the recorded poses and the commanded steps differ by up to {difference_mm:.3} mm."
        ),
        Warning::StationStandsOut { label, error_mm, typical_mm } => format!(
            "Station {label} disagrees with the others: left out, it is missed by {error_mm:.2} mm, the others by {typical_mm:.2} mm."
        ),
        Warning::PoseRejected { label, capture_idx, off_mm, off_deg, fault } => format!(
            "Station {label}, capture {}: the target's pose contradicts all others by {off_mm:.1} mm and {off_deg:.1}° and is left out: {}.",
            capture_idx + 1,
            match fault {
                PoseFault::Inverted => "it fits once inverted, as target_from_sensor",
                PoseFault::Flipped => "it fits once the target is flipped, as flat markers are read from afar",
                PoseFault::Orientation => "its place fits, its orientation does not",
                PoseFault::Place => "its orientation fits, its place does not",
                PoseFault::Both => "neither its place nor its orientation fits",
            }
        ),
        Warning::StreamInverted { ratio } => format!(
            "With the robot's poses or the target's inverted the residual is {ratio:.0} times smaller: the sensor is mounted the other way than the session says, or one of the two lists is given the wrong way round."
        ),
        Warning::TargetScale { factor, std } => format!(
            "The target's distances fit better by a factor of {factor:.4} ± {std:.4}: its size is another than was told to whatever found it, or its unit is."
        ),
        Warning::TimeOffsetUnknown => {
            "The motions do not tell by how much the clocks of robot and camera differ: they turn too little or too evenly.".to_owned()
        }
        Warning::NotConverged { num_iterations } => {
            format!("The solver had not settled after {num_iterations} iterations.")
        }
    }
}

/// What to do about it.
#[must_use]
pub const fn warning_remedy(warning: &Warning) -> &'static str {
    match warning {
        Warning::FewStations { .. } => "Add stations with other orientations.",
        Warning::FewEdgePoints { num_p, num_q, recommended } => match (*num_p < *recommended, *num_q < *recommended) {
            (true, false) => "Add points on edge p, at other places and with other orientations.",
            (false, true) => "Add points on edge q, at other places and with other orientations.",
            _ => "Add points on both edges, at other places and with other orientations.",
        },
        Warning::OtherMinimum { .. } => "Say roughly how the sensor is mounted, or add points with other orientations.",
        Warning::LittleRotation { .. } => "Add stations tilted by ±20° or more about two axes.",
        Warning::NearlyOneAxis { .. } => "Add stations tilted about an axis across it.",
        Warning::SideAmbiguous { .. } => {
            "Set the side of this station by hand, or move its line further from the ball's centre."
        }
        Warning::BlindInY { .. } => {
            "Record a sweep across the ball at each station, or place the line so that the section is about 0.8 of the radius."
        }
        Warning::ArcLargerThanBall { .. } => "Check the ball's radius and the profile's scale.",
        Warning::CaptureRefused { .. } => "Look at the profile in Arcs; capture it again with the target in view.",
        Warning::StationSkipped { needed: ..=1, .. } => {
            "Look at its profile in Arcs; capture it again with the target in view."
        }
        Warning::StationSkipped { .. } => "Record a sweep across the ball at this station.",
        Warning::TravelOffNormal { .. } => {
            "Let the robot step along the calibrated laser normal; the whole-curve method allows for the angle."
        }
        Warning::PeakNotCovered { .. } => "Let the sweep run on until the arc has shrunk again.",
        Warning::RadiusDisagrees { .. } => {
            "Check the ball's radius in the session, and the scale of profiles and steps."
        }
        Warning::StepDiffersFromPose { .. } => "Use the whole-curve method: it takes the real poses.",
        Warning::StationStandsOut { .. } => {
            "Check the pose and the profile of this station; un-tick it to see what changes."
        }
        Warning::PoseRejected { fault: PoseFault::Inverted, .. } => "Invert this pose, or measure the station again.",
        Warning::PoseRejected { fault: PoseFault::Flipped, .. } => {
            "Measure the station again with the target tilted or nearer; a board of several markers cannot flip."
        }
        Warning::PoseRejected { .. } => {
            "Measure the station again: with robot and target at rest, and both read at one time."
        }
        Warning::StreamInverted { .. } => {
            "If the sensor is mounted the other way, set the mounting to that; if not, invert the list that is given the wrong way round: poses are base_from_flange and sensor_from_target. Both would fit: only you know where the sensor is."
        }
        Warning::TargetScale { .. } => {
            "Measure the target with a caliper, and give its true size to the program that finds its pose."
        }
        Warning::TimeOffsetUnknown => "Let the robot turn to and fro at changing speed while both are recorded.",
        Warning::NotConverged { .. } => "Check poses and units.",
    }
}
