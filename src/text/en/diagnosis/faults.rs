//! Each fault: a title, a sentence, and what to do about it.

use crate::calibrate::{Mount, SolveError, Warning};
use crate::diagnose::convention::{Inversion, RotationReading};
use crate::diagnose::{Axis, Fault, PoseReading};
use crate::geometry::Vec3;
use crate::session::{Session, Target};
use crate::text::digits::{decimals_for, fixed};
use crate::text::edges::edge_name;
use crate::text::en::plural;
use crate::text::{warning_message, warning_remedy};

use super::readings::{pose_reading, pose_reading_in_full};
use super::words::{
    along, along_axis_of, axis_in_words, axis_name, capitalised, chance, exchanged_poses, reading_word, seen_word,
    size, station_label, stations, target_frame, target_word, with_std,
};

/// A few words for lists.
#[must_use]
pub fn fault_title(fault: &Fault) -> &'static str {
    match fault {
        Fault::PosesMisread { reading } => misread_title(reading),
        Fault::WrongSides { .. } => "Wrong side of the ball",
        Fault::MirroredAxis { axis: Axis::X } => "Mirrored x axis",
        Fault::MirroredAxis { axis: Axis::Z } => "Mirrored z axis",
        Fault::NoRotation { .. } => "No rotation",
        Fault::LittleRotation { .. } => "Little rotation",
        Fault::OneAxis { .. } => "Rotation about one axis",
        Fault::TwinPoses { .. } => "Twin poses",
        Fault::WrongRadius { .. } => "Wrong ball radius",
        Fault::ProfileScale { .. } => "Wrong profile scale",
        Fault::TravelOffNormal { .. } => "Travel off the laser's normal",
        Fault::StepDiffersFromPose { .. } => "Steps differ from poses",
        Fault::Drift { .. } => "Drift",
        Fault::ToolFrame { .. } => "TOOL was switched",
        Fault::SensorIsTool { .. } => "Poses of the sensor, not of the flange",
        Fault::WrongPose { .. } => "Wrong pose",
        Fault::WrongStation { .. } => "Wrong pose or profile",
        Fault::WrongEdge { .. } => "Wrong edge",
        Fault::StalePose { .. } => "Old pose",
        Fault::MixedOrder { .. } => "Mixed-up order",
        Fault::TooFewCleanStations { .. } => "Too few good stations",
        Fault::NoiseAboveStated { .. } => "More noise than stated",
        Fault::HalvesDisagree { .. } => "Halves disagree",
        Fault::ResidualsNotNormal { .. } => "Errors that are not noise",
        Fault::DoesNotFit { .. } => "The stations contradict each other",
        Fault::NotSolved(_) => "No result",
        Fault::Method(warning) => warning_title(warning),
    }
}

fn misread_title(reading: &PoseReading) -> &'static str {
    match &reading.rotation {
        RotationReading::Angles(angles) if angles.to != angles.from => "Angles in another convention",
        RotationReading::Quaternion(_) => "Quaternions in another order",
        RotationReading::Angles(_) => "Angles in another unit",
        RotationReading::AsGiven if reading.inversion != Inversion::AsGiven => "Inverse poses",
        RotationReading::AsGiven => "Positions in another unit",
    }
}

const fn warning_title(warning: &Warning) -> &'static str {
    match warning {
        Warning::FewStations { .. } => "Few stations",
        Warning::FewEdgePoints { .. } => "Few points on an edge",
        Warning::OtherMinimum { .. } => "Another mounting fits as well",
        Warning::LittleRotation { .. } => "Little rotation",
        Warning::NearlyOneAxis { .. } => "Rotation about one axis",
        Warning::SideAmbiguous { .. } => "Uncertain side of the ball",
        Warning::BlindInY { .. } => "Sections too near the largest",
        Warning::ArcLargerThanBall { .. } => "Section larger than the ball",
        Warning::CaptureRefused { .. } => "Profiles left out",
        Warning::StationSkipped { .. } => "Station left out",
        Warning::TravelOffNormal { .. } => "Travel off the laser's normal",
        Warning::PeakNotCovered { .. } => "Sweep ends too early",
        Warning::RadiusDisagrees { .. } => "Wrong ball radius",
        Warning::StepDiffersFromPose { .. } => "Steps differ from poses",
        Warning::StationStandsOut { .. } => "Station stands out",
        Warning::PoseRejected { .. } => "Pose left out",
        Warning::StreamInverted { .. } => "Inverted poses",
        Warning::TargetScale { .. } => "Wrong size of the target",
        Warning::TimeOffsetUnknown => "Clocks not matched",
        Warning::NotConverged { .. } => "Solver did not settle",
    }
}

/// What was found, in one sentence or two.
#[must_use]
#[expect(clippy::too_many_lines, reason = "one sentence a fault, and nothing else")]
pub fn fault_message(fault: &Fault, session: &Session) -> String {
    let mount = session.mount;
    let label = |station_idx: &usize| station_label(session, *station_idx);
    match fault {
        Fault::PosesMisread { reading } => {
            format!("The poses do not fit as they are read now. They fit as {}.", pose_reading_in_full(reading))
        }
        Fault::WrongSides { station_idxs } => {
            format!("{}: the given side of the ball is the wrong one.", capitalised(&stations(session, station_idxs)))
        }
        Fault::MirroredAxis { axis: Axis::Z } => {
            "The arcs bulge away from the sensor's origin: z runs towards the sensor, as a height does, or has the wrong sign.".to_owned()
        }
        Fault::MirroredAxis { axis: axis @ Axis::X } => format!(
            "The sensor's {0} axis runs the other way: the data fit when {0} changes its sign in all profiles.",
            axis_name(*axis)
        ),
        Fault::NoRotation { span_deg } => format!(
            "All stations have the same orientation (they differ by {span_deg:.2}° at most), so the place of the sensor cannot be found."
        ),
        Fault::LittleRotation { span_deg, recommended_deg, weakest } => {
            let weakest = weakest.map_or_else(String::new, |(direction, std_mm)| {
                format!(" The result is weakest {}: ± {} mm.", along(direction, mount), size(std_mm))
            });
            format!(
                "The orientations differ by {span_deg:.0}° at most; {recommended_deg:.0}° or more make the result trustworthy.{weakest}"
            )
        }
        Fault::OneAxis { axis_in_flange, ratio: None } => format!(
            "All rotations are about one axis, {}. The place of the sensor along it cannot be found.",
            axis_in_words(*axis_in_flange, mount)
        ),
        Fault::OneAxis { axis_in_flange, ratio: Some(ratio) } => format!(
            "The rotations are almost all about one axis, {}; about the others they are {ratio:.0} times smaller. The place of the sensor along it is poorly known.",
            axis_in_words(*axis_in_flange, mount)
        ),
        Fault::TwinPoses { station_idxs, distance_mm, angle_deg } => format!(
            "{} have the same pose (within {distance_mm:.2} mm and {angle_deg:.2}°), so they count as one.",
            capitalised(&stations(session, station_idxs))
        ),
        Fault::WrongRadius { found_mm, std_mm, given_mm } => {
            let decimals = decimals_for(Some(*std_mm)).min(4);
            format!(
                "The data fit a ball of radius {} ± {} mm; the session says {} mm.",
                fixed(*found_mm, decimals),
                size(*std_mm),
                fixed(*given_mm, decimals)
            )
        }
        Fault::ProfileScale { factor, std } => format!(
            "The profiles are too {}: they fit when all sizes are multiplied by {}.",
            if *factor > 1.0 { "small" } else { "large" },
            with_std(*factor, *std)
        ),
        Fault::TravelOffNormal { station_idx, angle_deg } => format!(
            "At station {} the robot travels {angle_deg:.1}° off the laser's normal. The published rule takes the travel for the normal.",
            label(station_idx)
        ),
        Fault::StepDiffersFromPose { station_idx, ratio, difference_mm } => format!(
            "The poses move {ratio:.3} times as far as the steps in the file say; at station {} they differ by up to {} mm.",
            label(station_idx),
            size(*difference_mm)
        ),
        Fault::Drift { total_in_base_mm, std_mm } => {
            let length_mm = total_in_base_mm.norm();
            format!(
                "The {} moved steadily during the recording: by {} mm from the first station to the last, {}.",
                target_word(&session.target),
                with_std(length_mm, *std_mm),
                along_axis_of(*total_in_base_mm, target_frame(mount))
            )
        }
        Fault::ToolFrame { from_station_idx, flange_from_tool } => format!(
            "From station {} on the controller reports another frame, {:.1} mm and {:.1}° away: a TOOL was switched.",
            label(from_station_idx),
            flange_from_tool.translation.vector.norm(),
            flange_from_tool.rotation.angle().to_degrees()
        ),
        Fault::SensorIsTool { distance_mm, angle_deg } => format!(
            "The result is nearly the identity ({distance_mm:.1} mm, {angle_deg:.2}°): the poses are those of the sensor's own TOOL, not of the flange."
        ),
        Fault::WrongPose { station_idx, off_mm, typical_mm } => format!(
            "The pose of station {} is wrong: its {} is {} mm from where the others have it, against {} mm typically.",
            label(station_idx),
            seen_word(&session.target),
            size(*off_mm),
            size(*typical_mm)
        ),
        Fault::WrongStation { station_idx, off_mm, typical_mm } => format!(
            "Station {} contradicts the others: its {} or its pose is wrong. It is {} mm off the edge as the others have it, against {} mm typically.",
            label(station_idx),
            reading_word(session, *station_idx),
            size(*off_mm),
            size(*typical_mm)
        ),
        Fault::WrongEdge { station_idx, edge } => format!(
            "Station {} fits the line of edge {}, not that of the edge that it is set to.",
            label(station_idx),
            edge_name(*edge)
        ),
        Fault::StalePose { station_idx, pose_of_idx, off_mm } => format!(
            "Station {} still has the pose of station {}: its {} is {} mm from where the others have it.",
            label(station_idx),
            label(pose_of_idx),
            seen_word(&session.target),
            size(*off_mm)
        ),
        Fault::MixedOrder { poses_from } => {
            format!("Profiles and poses are paired wrongly: {}.", exchanged_poses(session, poses_from))
        }
        Fault::TooFewCleanStations { clean, needed } => format!(
            "Only {clean} station{} agree with each other; {needed} are needed to tell good stations from bad ones.",
            plural(*clean)
        ),
        Fault::NoiseAboveStated { ratio, p_value } => format!(
            "The stations scatter {ratio:.1} times as much as the stated noise explains. By chance this happens {}.",
            chance(*p_value)
        ),
        Fault::HalvesDisagree { median_mm, expected_mm } => format!(
            "Calibrations from two halves of the stations are {} mm apart (median); {} mm is to be expected.",
            size(*median_mm),
            size(*expected_mm)
        ),
        Fault::ResidualsNotNormal { p_value } => format!(
            "The residuals do not look like noise: they are not normally distributed. By chance this happens {}.",
            chance(*p_value)
        ),
        Fault::DoesNotFit { scatter_mm } => format!(
            "The stations contradict each other: the {} by {} mm. No single cause that was tried explains it.",
            if matches!(session.target, Target::RightAnglePlate) {
                "points are off their edges".to_owned()
            } else {
                format!("{} scatters", target_word(&session.target))
            },
            size(*scatter_mm)
        ),
        Fault::NotSolved(error) => unsolved_message(error, mount),
        Fault::Method(warning) => warning_message(warning),
    }
}

fn unsolved_message(error: &SolveError, mount: Mount) -> String {
    match error {
        SolveError::TooFewStations { found, needed, refusal }
        | SolveError::TooFewProfileStations { found, needed, refusal }
        | SolveError::TooFewSweeps { found, needed, refusal, .. } => {
            let what = match error {
                SolveError::TooFewSweeps { .. } => "with a sweep",
                SolveError::TooFewProfileStations { .. } => "with a usable profile",
                _ => "that can be used",
            };
            let because = refusal.as_ref().map_or_else(String::new, |refusal| format!(" A profile: {refusal}."));
            format!("There {} {found} station{} {what}; {needed} are needed.{because}", are(*found), plural(*found))
        }
        SolveError::NoRotation { span_deg } => {
            format!("The orientations differ by {span_deg:.2}° at most, so the place of the sensor cannot be found.")
        }
        SolveError::RotationsAboutOneAxis { axis_x, axis_y, axis_z } => format!(
            "All rotations are about one axis, {}. The place of the sensor along it cannot be found.",
            axis_in_words(Vec3::new(*axis_x, *axis_y, *axis_z), mount)
        ),
        SolveError::Undetermined { .. } => {
            "The stations leave at least one direction free, so there is no single answer.".to_owned()
        }
        SolveError::OtherTarget { .. } => "This method is for another target.".to_owned(),
        SolveError::TooFewEdgePoints { found_p, found_q, needed, refusal } => {
            let because = refusal.as_ref().map_or_else(String::new, |refusal| format!(" A profile: {refusal}."));
            let alone = if (*found_p == 0) == (*found_q == 0) {
                ""
            } else {
                " From one straight edge alone the plate's turn about it and its corner along it cannot be found, and no right angle bears on the sensor."
            };
            format!(
                "There are {found_p} points on edge p and {found_q} on edge q; {needed} on each are needed.{alone}{because}"
            )
        }
        SolveError::MixedMounts => "Some targets are seen from the flange, others from beside the robot.".to_owned(),
        SolveError::TimesNotRising => "The times of a list of poses do not rise.".to_owned(),
        SolveError::Diverged => "The solver found no finite answer.".to_owned(),
    }
}

const fn are(count: usize) -> &'static str {
    if count == 1 { "is" } else { "are" }
}

/// What to do about it.
#[must_use]
pub fn fault_remedy(fault: &Fault, session: &Session) -> String {
    let label = |station_idx: &usize| station_label(session, *station_idx);
    let fixed_words = match fault {
        Fault::PosesMisread { reading } => {
            return format!("Read the poses as {}, and correct it where the file is made.", pose_reading(reading));
        }
        Fault::WrongSides { .. } => "Turn these sides round, or set them to auto.",
        Fault::MirroredAxis { axis: Axis::Z } => {
            "The result is right for profiles as they are. Turn the axis round if other programs take z as a distance."
        }
        Fault::MirroredAxis { axis: Axis::X } => {
            "If the given sides are right, turn this axis round in all profiles; if the axis is right, turn all sides round."
        }
        Fault::NoRotation { .. } => "Measure again: between stations tilt the tool by 20° about two axes, and turn it.",
        Fault::LittleRotation { .. } => "Add stations that are tilted by 20° or more about two axes, and turned.",
        Fault::OneAxis { .. } => "Add stations that are tilted by 20° or more about an axis across this one.",
        Fault::TwinPoses { .. } => "Measure one of them again at another orientation.",
        Fault::WrongRadius { .. } => "Check the ball's certificate or measure it with a calliper; then set the radius.",
        Fault::ProfileScale { .. } => "Check the unit and the scale of the sensor's data; then scale the profiles.",
        Fault::TravelOffNormal { .. } => {
            "Use the bundle or the whole curve: both allow for the angle. Or let the robot step along the laser's normal."
        }
        Fault::StepDiffersFromPose { .. } => {
            "Use the bundle or the whole curve: both take the real poses. Check the step and its unit in the robot's program."
        }
        Fault::Drift { .. } => {
            return format!(
                "Fix the {} firmly, let the robot and the sensor warm up, and measure again.",
                target_word(&session.target)
            );
        }
        Fault::ToolFrame { from_station_idx, .. } => {
            return format!(
                "Take the TOOL out of the poses from station {} on, or measure these stations again without it.",
                label(from_station_idx)
            );
        }
        Fault::SensorIsTool { .. } => {
            "To check a TOOL, read the result as its error. To calibrate, switch the TOOL off and record the flange's poses."
        }
        Fault::WrongPose { .. } => "Leave this station out, or measure it again.",
        Fault::WrongStation { .. } => "Look at it in Arcs and check its pose; then leave it out, or measure it again.",
        Fault::WrongEdge { edge, .. } => return format!("Change its edge to {}.", edge_name(*edge)),
        Fault::StalePose { .. } => "Leave this station out, or enter its own pose.",
        Fault::MixedOrder { .. } => "Give each profile the pose that fits it, and check the order of the recording.",
        Fault::TooFewCleanStations { .. } => "Check the poses one by one, and measure more stations.",
        Fault::NoiseAboveStated { .. } => {
            return format!(
                "Check the stated noise. Look for play (bracket, {}, joints) and biased flanks. With few stations one pose may be wrong: measure two more.",
                target_word(&session.target)
            );
        }
        Fault::HalvesDisagree { .. } => {
            "Add stations with other orientations, and find out what changed during the recording."
        }
        Fault::ResidualsNotNormal { .. } => {
            "Look for bad profiles in Arcs, and at the stations with the largest error."
        }
        Fault::DoesNotFit { .. } => {
            return format!(
                "Check that each profile stands with its own pose, that the {} did not move, and that the poses are the flange's.",
                target_word(&session.target)
            );
        }
        Fault::NotSolved(error) => unsolved_remedy(error),
        Fault::Method(warning) => warning_remedy(warning),
    };
    fixed_words.to_owned()
}

const fn unsolved_remedy(error: &SolveError) -> &'static str {
    match error {
        SolveError::TooFewStations { .. } => {
            "Add stations with other orientations, or look in Arcs why profiles are refused."
        }
        SolveError::OtherTarget { .. } => "Take a method for the session's target.",
        SolveError::TooFewEdgePoints { .. } => {
            "Add stations at the edge that lacks them, with other orientations, or look in Arcs why profiles are refused."
        }
        SolveError::TooFewProfileStations { .. } => {
            "Add stations with profiles, or look in Arcs why profiles are refused."
        }
        SolveError::TooFewSweeps { .. } => {
            "Record each station as a sweep: steps along the laser's normal, across the ball."
        }
        SolveError::NoRotation { .. } => "Between stations tilt the tool by 20° about two axes, and turn it.",
        SolveError::RotationsAboutOneAxis { .. } => {
            "Add stations that are tilted by 20° or more about an axis across this one."
        }
        SolveError::Undetermined { .. } => {
            "Add stations with other tilts, and with the target elsewhere in the profile."
        }
        SolveError::MixedMounts => "Solve the targets of each sensor by themselves.",
        SolveError::TimesNotRising => "Sort each list of poses by time.",
        SolveError::Diverged => "Check poses and units.",
    }
}

/// The end of the line that says why nothing was computed.
#[must_use]
pub fn first_finding(fault: &Fault, session: &Session) -> String {
    format!("found: [{}] {}", fault.code(), fault_message(fault, session))
}
