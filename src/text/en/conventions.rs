//! Wording of pose notations: their names, the bar above the pose table, and its dialogs.

use nalgebra::UnitQuaternion;

use crate::geometry::notation::{AngleUnit, LengthUnit, OrientationForm};
use crate::geometry::{AngleOrder, Mat3, PoseConvention, PoseNotation};
use crate::text::digits;

use super::plural;

/// Near gimbal lock two of the angles may be anything together: which ones, and how well the orientation as a whole is
/// known, where the σ of the angles would say too little of it.
#[must_use]
pub fn not_known_apart(
    convention: &PoseConvention,
    rotation: &UnitQuaternion<f64>,
    rotation_covariance: &Mat3,
) -> Option<String> {
    /// An angle this much less known than the orientation owes it to the lock: it is within 15° then.
    const RATIO: f64 = 4.0;
    let whole_deg = rotation_covariance.symmetric_eigenvalues().max().max(0.0).sqrt().to_degrees();
    let angles_std = convention.angles_std_deg(rotation, rotation_covariance);
    let poorly_known: Vec<&str> = convention
        .angle_names
        .into_iter()
        .zip(angles_std)
        .filter(|(_, std_deg)| *std_deg > RATIO * whole_deg)
        .map(|(name, _)| name)
        .collect();
    (poorly_known.len() > 1).then(|| {
        format!(
            "near gimbal lock: {} are not known apart; the orientation as a whole is, to ± {}° about its weakest axis",
            poorly_known.join(" and "),
            digits::value(whole_deg, Some(whole_deg))
        )
    })
}

/// Before the choice of a notation.
pub const SHOWN_AS: &str = "Shown as";
/// What that choice does.
pub const SHOWN_AS_HINT: &str = "The same poses in other numbers: nothing but the figures changes";
/// Button: units, frame and the rest.
pub const MORE: &str = "Units and frame…";
/// Button.
pub const REINTERPRET: &str = "Reinterpret…";
/// What it does.
pub const REINTERPRET_HINT: &str =
    "For numbers that were read in the wrong way: they stay as they are, their meaning and with it the poses change";
/// Toggle.
pub const PICTURE: &str = "Picture";
/// What it shows.
pub const PICTURE_HINT: &str = "The first poses as frames, so that a wrong convention is seen";
/// Field over the list of conventions.
pub const SEARCH: &str = "Search for a maker, a name or an order";
/// The search finds nothing.
pub const NOTHING_FOUND: &str = "No convention has that in its name. Clear the search to see all.";
/// Group of the list.
pub const MAKERS: &str = "Robot makers";
/// Group of the list.
pub const DISPUTED: &str = "As some sources have it";
/// Group of the list.
pub const QUATERNIONS: &str = "Quaternions";
/// Group of the list.
pub const CUSTOM: &str = "Custom: any order of axes";

/// Who writes a quaternion so.
pub const ROBTARGET_DETAIL: &str = "as in ABB robtargets: q1 q2 q3 q4";
/// Who writes a quaternion so.
pub const ROS_DETAIL: &str = "as in ROS messages, in metres";

/// Title of the dialog.
pub const SHOW_TITLE: &str = "How poses are shown";
/// What it does.
pub const SHOW_HINT: &str = "The poses stay the same. Only the numbers in which they are shown and typed change.";
/// Button.
pub const SHOW: &str = "Show";
/// Button.
pub const CANCEL: &str = "Cancel";

/// Title of the dialog.
pub const REINTERPRET_TITLE: &str = "Read the same numbers differently";
/// What it does.
pub const REINTERPRET_WARNING: &str =
    "This changes every pose. The numbers in the table stay as they are; only what they mean becomes another.";
/// What to use instead.
pub const REINTERPRET_INSTEAD: &str =
    "To see the poses as they are in the numbers of another robot, cancel and use \"Shown as\".";
/// Before the choices.
pub const NUMBERS_REALLY_ARE: &str = "What the numbers really are";
/// Nothing has been chosen yet.
pub const NO_CHANGE: &str = "This is how the numbers are read now. Choose what they really are.";
/// Title of a picture.
pub const NOW: &str = "As read now";
/// Title of a picture.
pub const THEN: &str = "Reinterpreted";
/// How a picture is turned.
pub const ORBIT_HINT: &str = "Drag to look from elsewhere, double-click to look as before";
/// Title of the card.
pub const PICTURE_TITLE: &str = "Poses as frames";
/// Name of the base in the picture.
pub const BASE: &str = "base";
/// Name of the base in the corner of the picture.
pub const BASE_DIRECTIONS: &str = "base (its directions only)";

/// Row of the form.
pub const ANGLES_OF: &str = "Angles as";
/// Row of the form.
pub const ORDER: &str = "Order of axes";
/// Row of the form.
pub const AXES: &str = "Axes";
/// Choice.
pub const FIXED_AXES: &str = "fixed (extrinsic)";
/// Choice.
pub const MOVING_AXES: &str = "moving (intrinsic)";
/// Row of the form.
pub const ORIENTATION: &str = "Orientation";
/// Row of the form.
pub const ANGLE_UNIT: &str = "Angles in";
/// Row of the form.
pub const LENGTH_UNIT: &str = "Positions in";
/// Row of the form.
pub const FRAME: &str = "Numbers of";
/// Choice.
pub const FLANGE: &str = "the flange";
/// Choice.
pub const TOOL_POINT: &str = "a tool point";
/// Before the six numbers.
pub const TOOL_IN_FLANGE: &str = "Tool point";
/// Row of the form.
pub const DIRECTION: &str = "Direction";
/// Choice.
pub const NOT_INVERSE: &str = "in the base";
/// Choice.
pub const INVERSE: &str = "inverse: of the base in it";
/// Why a form of the orientation cannot be chosen.
pub const OTHER_COUNT: &str = "The table has another count of numbers a pose";

/// Column of the preview.
pub const STATION: &str = "station";
/// Column of the preview.
pub const TURNS: &str = "turns by";
/// Column of the preview.
pub const MOVES: &str = "moves by";
/// Column of the preview.
pub const Z_NOW: &str = "z axis now";
/// Column of the preview.
pub const Z_THEN: &str = "z axis then";

/// The button that makes the change.
#[must_use]
pub fn reinterpret_poses(num_poses: usize) -> String {
    format!("Change {num_poses} pose{}", plural(num_poses))
}

/// Above the preview's table.
#[must_use]
pub fn numbers_stay(notation: &PoseNotation) -> String {
    let (name, units) = (notation_name(notation), notation_units(notation));
    format!("The numbers as the table shows them, {name} in {units}, and what becomes of their poses:")
}

/// What the line below the preview is for.
pub const SELF_CHECK_HINT: &str = "A check to make with any robot: jog it about one axis of its tool, say z, and take the poses \
                                   before and after as the first two stations. Read as the robot means them, they turn about \
                                   just that axis, here 0.00 0.00 1.00.";

/// A turn about an axis.
#[must_use]
pub fn turn(angle_deg: &str, axis: &str) -> String {
    format!("{angle_deg}° about {axis}")
}

/// How the tool turns from one station to another, in its own axes.
#[must_use]
pub fn self_check(first: &str, second: &str, now: &str, then: &str) -> String {
    format!("From station {first} to {second}, in the tool's own axes: now {now}; then {then}")
}

/// How the preview names what it leaves out.
#[must_use]
pub fn more_stations(number: usize) -> String {
    format!("and {number} more station{}", plural(number))
}

/// The pose of the first station, as it will be shown.
#[must_use]
pub fn example(label: &str) -> String {
    format!("Station {label}")
}

/// Name of a picture for a screen reader.
#[must_use]
pub fn picture_name(title: &str, num_frames: usize) -> String {
    format!("{title}: {num_frames} frame{}", plural(num_frames))
}

/// Name of the choice of a convention in a form.
#[must_use]
pub fn choice_name(row: &str, label: &str) -> String {
    format!("{row}: {label}")
}

/// Name of a field of the tool point.
#[must_use]
pub fn tool_number(name: &str) -> String {
    format!("{name} of the tool point")
}

/// The three axes one after the other, as in "Z Y X"; or the rotation vector.
#[must_use]
pub fn axes_name(order: AngleOrder) -> String {
    match order {
        AngleOrder::Intrinsic(axes) | AngleOrder::Extrinsic(axes) => axes.map(|axis| format!("{axis:?}")).join(" "),
        AngleOrder::RotationVector => "rotation vector".to_owned(),
    }
}

/// The orientation's form.
#[must_use]
pub const fn orientation_form(form: OrientationForm) -> &'static str {
    match form {
        OrientationForm::Angles => "angles",
        OrientationForm::QuaternionWxyz => "quaternion w x y z",
        OrientationForm::QuaternionXyzw => "quaternion x y z w",
    }
}

/// Name of a unit.
#[must_use]
pub const fn angle_unit(unit: AngleUnit) -> &'static str {
    match unit {
        AngleUnit::Degrees => "degrees",
        AngleUnit::Radians => "radians",
    }
}

/// Name of a unit.
#[must_use]
pub const fn length_unit(unit: LengthUnit) -> &'static str {
    match unit {
        LengthUnit::Millimetres => "millimetres",
        LengthUnit::Metres => "metres",
    }
}

/// What the orientation of a notation is called: a maker's angles, or a quaternion.
#[must_use]
pub const fn notation_name(notation: &PoseNotation) -> &'static str {
    match notation.orientation {
        OrientationForm::Angles => notation.convention.label,
        OrientationForm::QuaternionWxyz => "Quaternion w x y z",
        OrientationForm::QuaternionXyzw => "Quaternion x y z w",
    }
}

/// Whose poses the table shows, as its title.
#[must_use]
pub const fn poses_title(notation: &PoseNotation) -> &'static str {
    match (notation.flange_from_tcp.is_some(), notation.is_inverse) {
        (false, false) => "Poses of the flange in the base",
        (true, false) => "Poses of a tool point in the base",
        (false, true) => "Poses of the base in the flange",
        (true, true) => "Poses of the base in a tool point",
    }
}

/// The units in which poses are shown; a quaternion has none.
#[must_use]
pub fn notation_units(notation: &PoseNotation) -> String {
    let length = notation.length_unit.symbol();
    match notation.orientation {
        OrientationForm::Angles => format!("{length} · {}", notation.angle_unit.symbol()),
        OrientationForm::QuaternionWxyz | OrientationForm::QuaternionXyzw => length.to_owned(),
    }
}

/// Whose pose is shown and which way round, where it is not simply the flange in the base.
#[must_use]
pub const fn notation_frame(notation: &PoseNotation) -> Option<&'static str> {
    match (notation.flange_from_tcp.is_some(), notation.is_inverse) {
        (false, false) => None,
        (true, false) => Some("tool point"),
        (false, true) => Some("inverse"),
        (true, true) => Some("tool point, inverse"),
    }
}

/// The same in a sentence.
#[must_use]
pub const fn notation_frame_hint(notation: &PoseNotation) -> &'static str {
    match (notation.flange_from_tcp.is_some(), notation.is_inverse) {
        (false, false) => "The poses shown are those of the flange in the base",
        (true, false) => "The poses shown are those of a tool point in the base, not of the flange",
        (false, true) => "The poses shown are those of the base in the flange",
        (true, true) => "The poses shown are those of the base in a tool point",
    }
}

/// What the chip of the units says on hover.
#[must_use]
pub fn notation_units_hint(notation: &PoseNotation) -> String {
    let length = length_unit(notation.length_unit);
    match notation.orientation {
        OrientationForm::Angles => {
            format!(
                "Poses are shown in {length} and {}; all else in millimetres and degrees",
                angle_unit(notation.angle_unit)
            )
        }
        OrientationForm::QuaternionWxyz | OrientationForm::QuaternionXyzw => {
            format!("Poses are shown in {length}; all else in millimetres and degrees")
        }
    }
}

/// What the chip of the convention says on hover.
#[must_use]
pub fn notation_hint(notation: &PoseNotation) -> String {
    match notation.orientation {
        OrientationForm::Angles => format!("How orientations are shown: {}", convention_detail(notation.convention)),
        OrientationForm::QuaternionWxyz => "Orientations are shown as unit quaternions, the real part first".to_owned(),
        OrientationForm::QuaternionXyzw => "Orientations are shown as unit quaternions, the real part last".to_owned(),
    }
}

/// All that a notation is, on one line.
#[must_use]
pub fn notation_in_full(notation: &PoseNotation) -> String {
    let name = notation_name(notation);
    let is_usual = notation.length_unit == LengthUnit::Millimetres && notation.angle_unit == AngleUnit::Degrees;
    let units = if is_usual { String::new() } else { format!(" ({})", notation_units(notation)) };
    let frame = notation_frame(notation).map_or_else(String::new, |frame| format!(", {frame}"));
    format!("{name}{units}{frame}")
}

/// A convention's formula, and the order that it is.
#[must_use]
pub fn convention_detail(convention: &PoseConvention) -> String {
    match convention.order {
        AngleOrder::RotationVector => "axis times angle".to_owned(),
        order => format!("{}, {order}", convention.formula),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn near_gimbal_lock_two_angles_are_said_not_to_be_known_apart() {
        // A tenth of a degree about every axis.
        let covariance = Mat3::identity() * 0.1_f64.to_radians().powi(2);
        for (id, angles_deg, expected) in [
            ("fanuc-wpr", [-146.1, -88.0, 147.9], Some("W and R")),
            ("fanuc-wpr", [1.8, -1.5, 91.2], None),
            ("fanuc-wpr", [10.0, 70.0, 20.0], None),
            ("kuka-abc", [20.0, 88.5, 10.0], Some("A and C")),
            ("ur-rotvec", [1.0, 2.0, 0.5], None),
        ] {
            let convention = PoseConvention::by_id(id).expect("known");
            let rotation = convention.rotation_from_angles_deg(angles_deg);
            let remark = not_known_apart(convention, &rotation, &covariance);
            let expected = expected.map(|angles| {
                format!(
                    "near gimbal lock: {angles} are not known apart; the orientation as a whole is, to ± 0.10° about its weakest axis"
                )
            });
            assert_eq!(remark, expected, "{id} {angles_deg:?}");
        }
    }
}
