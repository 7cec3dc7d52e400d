//! What is wrong with a session, in words: titles, sentences, remedies, buttons, and the headings of the plots.

use crate::calibrate::validation::{Bootstrap, Influence, Normality, SplitHalf};
use crate::calibrate::{Mount, SideChoice, Solution, SolveError, Uncertainty, Warning};
use crate::diagnose::convention::{AngleUnit, Inversion, LengthUnit, QuaternionOrder, RotationReading};
use crate::diagnose::{Axis, CurveAxis, Fault, Plot, PoseReading, Remedy, Severity};
use crate::geometry::{AngleOrder, Vec3};
use crate::session::Session;
use crate::text::digits::{decimals_for, fixed};

use super::{plural, warning_message, warning_remedy};

/// Title of what was found.
pub const HEADING: &str = "Diagnosis";
/// Nothing was found.
pub const NOTHING_FOUND: &str = "Nothing to object to.";

/// How much a finding weighs.
#[must_use]
pub const fn severity_name(severity: Severity) -> &'static str {
    match severity {
        Severity::Wrong => "Wrong",
        Severity::Doubtful => "Doubtful",
        Severity::Note => "Note",
    }
}

/// The same in result files.
#[must_use]
pub const fn severity_id(severity: Severity) -> &'static str {
    match severity {
        Severity::Wrong => "wrong",
        Severity::Doubtful => "doubtful",
        Severity::Note => "note",
    }
}

/// Its shape, so that colour is never alone.
#[must_use]
pub const fn severity_mark(severity: Severity) -> &'static str {
    match severity {
        Severity::Wrong => "✖",
        Severity::Doubtful => "!",
        Severity::Note => "i",
    }
}

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
        Fault::MirroredAxis { axis } => format!(
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
                "The ball moved steadily during the recording: by {} mm from the first station to the last, {}.",
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
            "The pose of station {} is wrong: its ball is {} mm from where the others have it, against {} mm typically.",
            label(station_idx),
            size(*off_mm),
            size(*typical_mm)
        ),
        Fault::StalePose { station_idx, pose_of_idx, off_mm } => format!(
            "Station {} still has the pose of station {}: its ball is {} mm from where the others have it.",
            label(station_idx),
            label(pose_of_idx),
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
            "The stations contradict each other: the ball scatters by {} mm. No single cause that was tried explains it.",
            size(*scatter_mm)
        ),
        Fault::NotSolved(error) => unsolved_message(error, mount),
        Fault::Method(warning) => warning_message(warning),
    }
}

fn unsolved_message(error: &SolveError, mount: Mount) -> String {
    match error {
        SolveError::TooFewStations { found, needed, .. }
        | SolveError::TooFewProfileStations { found, needed, .. }
        | SolveError::TooFewSweeps { found, needed, .. } => {
            let what = match error {
                SolveError::TooFewSweeps { .. } => "with a sweep",
                SolveError::TooFewProfileStations { .. } => "with a usable profile",
                _ => "that can be used",
            };
            format!("There {} {found} station{} {what}; {needed} are needed.", are(*found), plural(*found))
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
        Fault::MirroredAxis { .. } => "Turn this axis round in all profiles, and check the sensor's settings.",
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
        Fault::Drift { .. } => "Fix the ball firmly, let the robot and the sensor warm up, and measure again.",
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
        Fault::StalePose { .. } => "Leave this station out, or enter its own pose.",
        Fault::MixedOrder { .. } => "Give each profile the pose that fits it, and check the order of the recording.",
        Fault::TooFewCleanStations { .. } => "Check the poses one by one, and measure more stations.",
        Fault::NoiseAboveStated { .. } => "Check the stated noise. Look for play: sensor bracket, ball, robot joints.",
        Fault::HalvesDisagree { .. } => {
            "Add stations with other orientations, and find out what changed during the recording."
        }
        Fault::ResidualsNotNormal { .. } => {
            "Look for bad profiles in Arcs, and at the stations with the largest error."
        }
        Fault::DoesNotFit { .. } => {
            "Check that each profile stands with its own pose, that the ball did not move, and that the poses are the flange's."
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
        SolveError::Undetermined { .. } => "Add stations with other tilts, and with the ball elsewhere in the profile.",
        SolveError::Diverged => "Check poses and units.",
    }
}

/// The button that applies a remedy.
#[must_use]
pub fn remedy_label(remedy: &Remedy, session: &Session) -> String {
    match remedy {
        Remedy::LeaveOut(station_idxs) => format!("Leave out {}", stations(session, station_idxs)),
        Remedy::ReadPosesAs(reading) => format!("Read poses as {}", pose_reading(reading)),
        Remedy::SetRadius(found_mm) => format!("Set radius to {} mm", fixed(*found_mm, RADIUS_DECIMALS)),
        Remedy::SetSides(sides) => sides_label(session, sides),
        Remedy::TakePosesFrom(pairs) => exchange_label(session, pairs),
        Remedy::ScaleProfiles(factor) => format!("Scale profiles by {}", fixed(*factor, FACTOR_DECIMALS)),
        Remedy::MirrorProfiles(axis) => format!("Turn {} axis of profiles", axis_name(*axis)),
        Remedy::RemoveTool { from_station_idx, .. } => {
            format!("Take TOOL out of poses from station {}", station_label(session, *from_station_idx))
        }
    }
}

fn sides_label(session: &Session, sides: &[(usize, SideChoice)]) -> String {
    if let [(station_idx, side)] = sides {
        return format!("Set side of station {} to {}", station_label(session, *station_idx), side_name(*side));
    }
    let station_idxs: Vec<usize> = sides.iter().map(|(station_idx, _)| *station_idx).collect();
    format!("Turn sides of {}", stations(session, &station_idxs))
}

fn exchange_label(session: &Session, poses_from: &[(usize, usize)]) -> String {
    if let [(to, from)] = poses_from {
        return format!(
            "Give station {} the pose of station {}",
            station_label(session, *to),
            station_label(session, *from)
        );
    }
    let station_idxs: Vec<usize> = poses_from.iter().map(|(station_idx, _)| *station_idx).collect();
    format!("Exchange poses of {}", stations(session, &station_idxs))
}

/// What undo takes back when a remedy was applied.
#[must_use]
pub fn remedy_undo_label(remedy: &Remedy, session: &Session) -> String {
    let label = remedy_label(remedy, session);
    let mut letters = label.chars();
    letters.next().map_or_else(String::new, |first| first.to_lowercase().chain(letters).collect())
}

/// No calliper reads more.
const RADIUS_DECIMALS: usize = 3;
/// A hundredth of a millimetre in 100 mm.
const FACTOR_DECIMALS: usize = 4;

const fn side_name(side: SideChoice) -> &'static str {
    super::poses::side(side)
}

/// A way to read poses, by name: "FANUC W P R", "inverse poses, positions in metres".
#[must_use]
pub fn pose_reading(reading: &PoseReading) -> String {
    let parts = [rotation_words(reading), inversion_words(reading.inversion), length_words(reading.length_unit)];
    let parts: Vec<String> = parts.into_iter().flatten().collect();
    if parts.is_empty() { AS_GIVEN.to_owned() } else { parts.join(", ") }
}

/// The same with all names of the order: other makers, and the two ways to spell it out.
#[must_use]
pub fn pose_reading_in_full(reading: &PoseReading) -> String {
    let name = pose_reading(reading);
    let Some(order) = reading.angle_order() else { return name };
    let others: Vec<&str> = reading.makers().iter().skip(1).filter_map(|maker| maker.label.split(' ').next()).collect();
    let also = if others.is_empty() { String::new() } else { format!(", also {}", others.join(", ")) };
    match order {
        AngleOrder::Intrinsic([i, j, k]) => {
            format!("{name}{also} ({order} = {} read backwards)", AngleOrder::Extrinsic([k, j, i]))
        }
        AngleOrder::Extrinsic([i, j, k]) => {
            format!("{name}{also} ({order} = {} read backwards)", AngleOrder::Intrinsic([k, j, i]))
        }
        AngleOrder::RotationVector => format!("{name}{also}"),
    }
}

/// The poses as the session has them.
const AS_GIVEN: &str = "given";

fn rotation_words(reading: &PoseReading) -> Option<String> {
    match &reading.rotation {
        RotationReading::AsGiven => None,
        RotationReading::Quaternion(QuaternionOrder::Xyzw) => Some("quaternion x y z w".to_owned()),
        RotationReading::Quaternion(QuaternionOrder::WxyzReordered) => Some("quaternion w x y z".to_owned()),
        RotationReading::Angles(angles) => {
            let name = reading
                .makers()
                .first()
                .map_or_else(|| format!("{} angles", angles.to), |maker| maker.label.to_owned());
            Some(match angles.unit {
                AngleUnit::Degrees => name,
                AngleUnit::Radians => format!("{name} in radians"),
                AngleUnit::DegreesConvertedTwice => format!("{name} without the second conversion to radians"),
            })
        }
    }
}

fn inversion_words(inversion: Inversion) -> Option<String> {
    match inversion {
        Inversion::AsGiven => None,
        Inversion::WholePose => Some("inverse poses (base in the flange)".to_owned()),
        Inversion::RotationAlone => Some("inverse rotations".to_owned()),
    }
}

fn length_words(unit: LengthUnit) -> Option<String> {
    let unit = match unit {
        LengthUnit::Millimetres => return None,
        LengthUnit::Metres => "metres",
        LengthUnit::Inches => "inches",
        LengthUnit::Micrometres => "micrometres",
    };
    Some(format!("positions in {unit}"))
}

/// Heading of a plot of the evidence.
#[must_use]
pub const fn plot_title(plot: &Plot) -> &'static str {
    match plot {
        Plot::Stations(_) => "How far each station's ball is from where the others have it",
        Plot::Readings(_) => "Residual of each way to read the poses",
        Plot::Curve { axis: CurveAxis::RadiusMm, .. } => "Residual over the ball's radius",
        Plot::Curve { axis: CurveAxis::ProfileScale, .. } => "Residual over the scale of the profiles",
        Plot::Trend { .. } => "Shift of the ball in the order of recording",
        Plot::Direction { .. } => "Rotation about the three axes of the flange",
        Plot::Steps(_) => "Travel by the poses over commanded travel",
    }
}

/// Titles of a plot's axes: across, upwards.
#[must_use]
pub const fn plot_axes(plot: &Plot) -> [&'static str; 2] {
    match plot {
        Plot::Stations(_) => ["station", "error / mm"],
        Plot::Readings(_) => ["residual / mm", ""],
        Plot::Curve { axis: CurveAxis::RadiusMm, .. } => ["radius / mm", "residual / mm"],
        Plot::Curve { axis: CurveAxis::ProfileScale, .. } => ["factor", "residual / mm"],
        Plot::Trend { .. } => ["station", "shift / mm"],
        Plot::Direction { .. } => ["axis", "rotation / °"],
        Plot::Steps(_) => ["commanded / mm", "by the poses / mm"],
    }
}

/// Calibrations from two halves of the stations.
#[must_use]
pub fn split_half_line(halves: &SplitHalf) -> String {
    format!(
        "two halves of the stations: {} mm apart (median), at most {} mm; {} mm is to be expected",
        size(halves.median_mm),
        size(halves.max_mm),
        size(halves.expected_mm)
    )
}

/// Whether the residuals look like noise.
#[must_use]
pub fn normality_line(normality: &Normality) -> String {
    if normality.p_value < 0.01 {
        return format!("residuals: not normally distributed; by chance this happens {}", chance(normality.p_value));
    }
    format!("residuals: normally distributed (p = {:.2})", normality.p_value)
}

/// The station that the result depends on most.
#[must_use]
pub fn influence_line(influence: &Influence) -> String {
    format!(
        "most influential: station {}; leaving it out moves the workspace point by {} mm (studentised residual {:.1})",
        influence.label,
        size(influence.moves_workspace_point_mm),
        influence.studentised_residual
    )
}

/// The spread over stations drawn with replacement.
#[must_use]
pub fn bootstrap_line(bootstrap: &Bootstrap) -> String {
    let num_solved = bootstrap.distances_mm.len();
    let failed = match bootstrap.num_failed {
        0 => String::new(),
        num_failed => format!("; {num_failed} gave no result"),
    };
    if num_solved == 0 {
        return format!("bootstrap: none of {} draws gave a result", bootstrap.num_failed);
    }
    format!(
        "bootstrap, {} draws: ± {} mm at the workspace point, 95 % within {} mm{failed}",
        num_solved + bootstrap.num_failed,
        size(bootstrap.std_mm),
        size(bootstrap.within_95_mm)
    )
}

/// How well the workspace point is known, and where worst.
#[must_use]
pub fn accuracy_line(uncertainty: &Uncertainty, mount: Mount) -> String {
    let (weakest, std_mm) = uncertainty.weakest_direction();
    format!(
        "workspace point: 95 % within {} mm; weakest {}, ± {} mm",
        size(uncertainty.workspace_point_95_mm),
        along(weakest, mount),
        size(std_mm)
    )
}

/// How the result follows the ball's radius.
#[must_use]
pub fn radius_line(solution: &Solution) -> String {
    /// A step that a calliper shows, mm.
    const STEP_MM: f64 = 0.01;
    let change = solution.change_by_radius * STEP_MM;
    format!(
        "per {STEP_MM} mm of radius the workspace point moves by {} mm, the translation by {} mm, the rotation by {}°",
        size(solution.workspace_point_by_radius.norm() * STEP_MM),
        size(change.fixed_rows::<3>(3).norm()),
        size(change.fixed_rows::<3>(0).norm().to_degrees())
    )
}

/// The station that would help most; position (mm) and angles (degrees) as the robot names them.
#[must_use]
pub fn next_pose_line(position: &str, angles: &str, before_mm: Option<f64>, after_mm: Option<f64>) -> String {
    let brings = before_mm.zip(after_mm).map_or_else(String::new, |(before_mm, after_mm)| {
        let decimals = decimals_for(Some(after_mm)).min(4);
        format!(": ± {} → {} mm at the workspace point", fixed(before_mm, decimals), fixed(after_mm, decimals))
    });
    format!("next pose: {position}, {angles}{brings}")
}

/// Heading of what to do first.
#[must_use]
pub fn next_step_line(remedy: &str) -> String {
    format!("next step: {remedy}")
}

/// The figure of a finding.
#[must_use]
pub fn residual_falls([as_given_mm, mended_mm]: [f64; 2]) -> String {
    format!("(residual {} → {} mm)", size(as_given_mm), size(mended_mm))
}

/// The end of the line that says why nothing was computed.
#[must_use]
pub fn first_finding(fault: &Fault, session: &Session) -> String {
    format!("found: [{}] {}", fault.code(), fault_message(fault, session))
}

/// A direction of the frame that the sensor is mounted on, as an adverb: "along the flange's z".
#[must_use]
pub fn along(direction: Vec3, mount: Mount) -> String {
    along_axis_of(direction, carrier_frame(mount))
}

fn along_axis_of(direction: Vec3, frame: &str) -> String {
    let words = direction_words(direction, frame);
    if words.starts_with('(') { format!("along {words} of the {frame}") } else { format!("along {words}") }
}

/// The same as a noun: "the flange's z".
fn axis_in_words(axis: Vec3, mount: Mount) -> String {
    let frame = carrier_frame(mount);
    let words = direction_words(axis, frame);
    if words.starts_with('(') { format!("{words} in the {frame}") } else { words }
}

/// The nearest axis where there is one within 15°, otherwise the components. A direction without its sense.
fn direction_words(direction: Vec3, frame: &str) -> String {
    /// The cosine of 15°.
    const NEAR: f64 = 0.966;
    let unit = direction.try_normalize(0.0).unwrap_or(direction);
    let largest = unit.iamax();
    if unit[largest].abs() >= NEAR {
        return format!("the {frame}'s {}", ["x", "y", "z"][largest]);
    }
    let unit = if unit[largest] < 0.0 { -unit } else { unit };
    format!("({}, {}, {})", fixed(unit.x, 2), fixed(unit.y, 2), fixed(unit.z, 2))
}

const fn carrier_frame(mount: Mount) -> &'static str {
    match mount {
        Mount::OnFlange => "flange",
        Mount::Fixed => "base",
    }
}

const fn target_frame(mount: Mount) -> &'static str {
    match mount {
        Mount::OnFlange => "base",
        Mount::Fixed => "flange",
    }
}

const fn axis_name(axis: Axis) -> &'static str {
    match axis {
        Axis::X => "x",
        Axis::Z => "z",
    }
}

/// An error or a σ: two digits of it, and no more than a tenth of a micrometre.
fn size(value: f64) -> String {
    fixed(value, decimals_for(Some(value.abs())).min(4))
}

fn with_std(value: f64, std: f64) -> String {
    let decimals = decimals_for(Some(std)).min(5);
    format!("{} ± {}", fixed(value, decimals), fixed(std, decimals))
}

/// How often something happens by chance.
fn chance(p_value: f64) -> String {
    /// No test is right about rarer things.
    const RARE: f64 = 1e-3;
    if p_value < RARE { "less than once in 1000".to_owned() } else { format!("about once in {:.0}", 1.0 / p_value) }
}

fn station_label(session: &Session, station_idx: usize) -> &str {
    session.stations.get(station_idx).map_or("?", |station| station.label.as_str())
}

/// "station 4", "stations 2, 4 and 7", and of a long list the first ones.
fn stations(session: &Session, station_idxs: &[usize]) -> String {
    /// More than this no one reads.
    const MOST: usize = 6;
    let labels: Vec<&str> = station_idxs.iter().map(|station_idx| station_label(session, *station_idx)).collect();
    match labels.as_slice() {
        [] => "no station".to_owned(),
        [only] => format!("station {only}"),
        [before @ .., last] if labels.len() <= MOST => format!("stations {} and {last}", before.join(", ")),
        _ => format!("stations {} and {} more", labels[..MOST - 1].join(", "), labels.len() - MOST + 1),
    }
}

fn exchanged_poses(session: &Session, poses_from: &[(usize, usize)]) -> String {
    /// More than this no one reads.
    const MOST: usize = 4;
    let mut parts: Vec<String> = poses_from
        .iter()
        .take(MOST)
        .map(|(to, from)| {
            format!(
                "station {} fits the pose of station {}",
                station_label(session, *to),
                station_label(session, *from)
            )
        })
        .collect();
    if let Some(more @ 1..) = poses_from.len().checked_sub(MOST) {
        parts.push(format!("and {more} more"));
    }
    parts.join(", ")
}

fn capitalised(words: &str) -> String {
    let mut letters = words.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calibrate::Side;
    use crate::diagnose::convention::AngleReading;
    use crate::fit::ArcRefusal;
    use crate::geometry::{PoseConvention, Rigid};
    use crate::simulate::{SimulationOptions, simulate};

    fn session(mount: Mount) -> Session {
        simulate(&SimulationOptions { num_stations: 9, num_steps: 1, num_points: 2, mount, ..Default::default() })
    }

    fn angles(from: &str, to: &str, unit: AngleUnit) -> PoseReading {
        let order = |id: &str| PoseConvention::by_id(id).expect("known").order;
        let rotation = RotationReading::Angles(AngleReading {
            from: order(from),
            to: order(to),
            unit,
            second_at_station_idxs: Vec::new(),
        });
        PoseReading { rotation, ..PoseReading::default() }
    }

    fn longest_reading() -> PoseReading {
        PoseReading {
            inversion: Inversion::WholePose,
            length_unit: LengthUnit::Micrometres,
            ..angles("kuka-abc", "fanuc-wpr", AngleUnit::Radians)
        }
    }

    #[test]
    fn ways_to_read_poses_have_all_their_names() {
        let fanuc = angles("kuka-abc", "fanuc-wpr", AngleUnit::Degrees);
        assert_eq!(pose_reading(&fanuc), "FANUC W P R");
        assert_eq!(
            pose_reading_in_full(&fanuc),
            "FANUC W P R, also Yaskawa, Mitsubishi, Denso (extrinsic XYZ = intrinsic ZYX read backwards)"
        );
        let in_radians = angles("ur-rotvec", "ur-rotvec", AngleUnit::Radians);
        assert_eq!(pose_reading_in_full(&in_radians), "UR RX RY RZ in radians");
        assert_eq!(pose_reading(&PoseReading::default()), "given");
    }

    fn faults() -> Vec<Fault> {
        let tilted = Vec3::new(0.6, -0.8, 0.0);
        let label = || "station with a long label".to_owned();
        let unsolved = [
            SolveError::TooFewStations { found: 1, needed: 4, refusal: Some(ArcRefusal::NoBall) },
            SolveError::TooFewProfileStations { found: 3, needed: 4, refusal: None },
            SolveError::TooFewSweeps { found: 0, needed: 4, steps: 3, refusal: None },
            SolveError::NoRotation { span_deg: 0.02 },
            SolveError::RotationsAboutOneAxis { axis_x: 0.0, axis_y: -1.0, axis_z: 0.01 },
            SolveError::Undetermined { condition: 1e15 },
            SolveError::Diverged,
        ];
        let warned = [
            Warning::FewStations { num_stations: 4, recommended: 8 },
            Warning::SideAmbiguous { labels: vec!["1".to_owned(), "2".to_owned()], ratio: 1.2 },
            Warning::BlindInY { labels: vec!["1".to_owned()], std_y_mm: 0.4, std_xz_mm: 0.01 },
            Warning::ArcLargerThanBall {
                label: label(),
                capture_idx: 3,
                section_radius_mm: 15.2,
                ball_radius_mm: 15.0,
            },
            Warning::StationSkipped { label: label(), found: 1, needed: 3 },
            Warning::PeakNotCovered { label: label(), beyond_mm: 2.0 },
            Warning::RadiusDisagrees { found_mm: 15.1, std_mm: 0.01, ball_radius_mm: 15.0 },
            Warning::StationStandsOut { label: label(), error_mm: 2.0, typical_mm: 0.04 },
            Warning::NotConverged { num_iterations: 60 },
        ];
        let mut faults = vec![
            Fault::PosesMisread { reading: longest_reading() },
            Fault::PosesMisread {
                reading: PoseReading {
                    rotation: RotationReading::Quaternion(QuaternionOrder::Xyzw),
                    ..PoseReading::default()
                },
            },
            Fault::PosesMisread { reading: PoseReading { length_unit: LengthUnit::Inches, ..PoseReading::default() } },
            Fault::WrongSides { station_idxs: vec![1] },
            Fault::WrongSides { station_idxs: (0..9).collect() },
            Fault::MirroredAxis { axis: Axis::X },
            Fault::MirroredAxis { axis: Axis::Z },
            Fault::NoRotation { span_deg: 0.02 },
            Fault::LittleRotation { span_deg: 12.3, recommended_deg: 40.0, weakest: None },
            Fault::LittleRotation { span_deg: 12.3, recommended_deg: 40.0, weakest: Some((tilted, 0.831)) },
            Fault::OneAxis { axis_in_flange: tilted, ratio: None },
            Fault::OneAxis { axis_in_flange: Vec3::z(), ratio: Some(17.0) },
            Fault::TwinPoses { station_idxs: [1, 4], distance_mm: 0.01, angle_deg: 0.0 },
            Fault::WrongRadius { found_mm: 15.304_2, std_mm: 0.003_1, given_mm: 15.0 },
            Fault::ProfileScale { factor: 1.012, std: 0.000_4 },
            Fault::ProfileScale { factor: 0.001, std: 1e-7 },
            Fault::TravelOffNormal { station_idx: 2, angle_deg: 4.2 },
            Fault::StepDiffersFromPose { station_idx: 2, ratio: 1.05, difference_mm: 0.4 },
            Fault::Drift { total_in_base_mm: tilted * 0.4, std_mm: 0.05 },
            Fault::ToolFrame { from_station_idx: 5, flange_from_tool: Rigid::translation(0.0, 0.0, 120.0) },
            Fault::SensorIsTool { distance_mm: 0.4, angle_deg: 0.02 },
            Fault::WrongPose { station_idx: 3, off_mm: 2.13, typical_mm: 0.031 },
            Fault::StalePose { station_idx: 3, pose_of_idx: 2, off_mm: 32.0 },
            Fault::MixedOrder { poses_from: vec![(3, 4), (4, 3)] },
            Fault::MixedOrder { poses_from: (0..9).map(|idx| (idx, 8 - idx)).collect() },
            Fault::TooFewCleanStations { clean: 4, needed: 7 },
            Fault::NoiseAboveStated { ratio: 3.2, p_value: 1e-9 },
            Fault::HalvesDisagree { median_mm: 0.8, expected_mm: 0.12 },
            Fault::ResidualsNotNormal { p_value: 0.004 },
            Fault::DoesNotFit { scatter_mm: 97.2 },
        ];
        faults.extend(unsolved.map(Fault::NotSolved));
        faults.extend(warned.map(Fault::Method));
        faults
    }

    /// What fits two lines of a panel.
    fn check_sentence(sentence: &str, fault: &Fault) {
        let length = sentence.chars().count();
        assert!((10..=220).contains(&length), "{fault:?}: {length} characters: {sentence}");
        assert!(sentence.ends_with('.'), "{fault:?}: {sentence}");
        assert!(sentence.starts_with(|first: char| first.is_uppercase()), "{fault:?}: {sentence}");
    }

    #[test]
    fn every_fault_has_a_title_a_sentence_and_a_remedy() {
        for mount in [Mount::OnFlange, Mount::Fixed] {
            let session = session(mount);
            for fault in faults() {
                assert!((5..=40).contains(&fault_title(&fault).chars().count()), "{fault:?}");
                check_sentence(&fault_message(&fault, &session), &fault);
                check_sentence(&fault_remedy(&fault, &session), &fault);
            }
        }
    }

    #[test]
    fn stations_out_of_range_are_no_panic() {
        let fault = Fault::StalePose { station_idx: 99, pose_of_idx: 98, off_mm: 1.0 };
        assert!(fault_message(&fault, &session(Mount::OnFlange)).contains('?'));
    }

    #[test]
    fn buttons_say_what_they_do() {
        let session = session(Mount::OnFlange);
        for (remedy, label, undo) in [
            (Remedy::LeaveOut(vec![3]), "Leave out station 4", "leave out station 4"),
            (Remedy::LeaveOut(vec![3, 6]), "Leave out stations 4 and 7", "leave out stations 4 and 7"),
            (Remedy::SetRadius(15.304_2), "Set radius to 15.304 mm", "set radius to 15.304 mm"),
            (
                Remedy::SetSides(vec![(1, SideChoice::Given(Side::Minus))]),
                "Set side of station 2 to −",
                "set side of station 2 to −",
            ),
            (
                Remedy::SetSides(vec![(1, SideChoice::Auto), (2, SideChoice::Auto)]),
                "Turn sides of stations 2 and 3",
                "turn sides of stations 2 and 3",
            ),
            (
                Remedy::TakePosesFrom(vec![(3, 4), (4, 3)]),
                "Exchange poses of stations 4 and 5",
                "exchange poses of stations 4 and 5",
            ),
            (
                Remedy::TakePosesFrom(vec![(3, 4)]),
                "Give station 4 the pose of station 5",
                "give station 4 the pose of station 5",
            ),
            (Remedy::ScaleProfiles(1.012), "Scale profiles by 1.0120", "scale profiles by 1.0120"),
            (Remedy::MirrorProfiles(Axis::Z), "Turn z axis of profiles", "turn z axis of profiles"),
            (
                Remedy::RemoveTool { from_station_idx: 5, flange_from_tool: Rigid::identity() },
                "Take TOOL out of poses from station 6",
                "take TOOL out of poses from station 6",
            ),
        ] {
            assert_eq!(remedy_label(&remedy, &session), label);
            assert_eq!(remedy_undo_label(&remedy, &session), undo);
        }
    }

    #[test]
    fn directions_are_named_by_the_frame_that_the_sensor_is_mounted_on() {
        assert_eq!(along(Vec3::new(0.1, -0.02, -0.99), Mount::OnFlange), "along the flange's z");
        assert_eq!(along(Vec3::x(), Mount::Fixed), "along the base's x");
        assert_eq!(along(Vec3::new(-0.6, 0.8, 0.0), Mount::OnFlange), "along (-0.60, 0.80, 0.00) of the flange");
    }
}
