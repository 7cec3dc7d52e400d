//! Version 1 of the session format: from a JSON tree to a checked session.

use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

use nalgebra::{Quaternion, UnitQuaternion};

use crate::calibrate::{Mount, Side, SideChoice};
use crate::geometry::profile::ProfileError;
use crate::geometry::{Base, Flange, Frame, PoseConvention, PoseNotation, Profile, Transform, Vec3};
use crate::session::check::Finding;
use crate::session::limits::{self, Quantity};
use crate::session::model::{
    Capture, Edge, FurtherTarget, Known, Published, Reading, Robot, Sensor, Session, Station, Target, Truth,
    UnknownFields, WrittenAngles,
};

use super::cursor::{Cursor, Object, Refusal, listed};
use super::names::{self, ByMount};

/// What reading takes along besides the session: what it had to mend.
#[derive(Debug, Default)]
pub(super) struct Mended {
    num_poses: usize,
    worst: Option<(String, f64)>,
}

impl Mended {
    fn note(&mut self, path: &str, norm: f64) {
        self.num_poses += 1;
        let worst_off = self.worst.as_ref().map_or(0.0, |(_, worst)| (worst - 1.0).abs());
        if (norm - 1.0).abs() > worst_off {
            self.worst = Some((path.to_owned(), norm));
        }
    }

    /// As findings, for `handeye check`.
    pub fn into_findings(self) -> Vec<Finding> {
        let num_poses = self.num_poses;
        self.worst
            .map(|(worst_path, worst_norm)| Finding::QuaternionsNormalised { num_poses, worst_path, worst_norm })
            .into_iter()
            .collect()
    }
}

const KINDS: &[(&str, Kind)] = &[
    (names::BALL, Kind::Ball),
    (names::RIGHT_ANGLE_PLATE, Kind::RightAnglePlate),
    (names::POINT, Kind::Point),
    (names::POSE_TARGET, Kind::Pose),
    (names::WORKPIECE, Kind::Workpiece),
    (names::RGBD, Kind::Rgbd),
];
/// A sequence is a session's own target only.
const KINDS_WITH_STATIONS: &[(&str, Kind)] = KINDS.split_at(5).0;

#[derive(Clone, Copy)]
enum Kind {
    Ball,
    RightAnglePlate,
    Point,
    Pose,
    Workpiece,
    Rgbd,
}

/// The session that the tree's top level describes.
pub(super) fn session(root: &Object<'_>, mended: &mut Mended) -> Result<Session, Refusal> {
    let mut of_target = UnknownFields::new();
    let (target, known) = target(root, KINDS, &mut of_target)?;
    let stations = stations(root, &target, mended)?;
    let truth = match root.optional("truth") {
        Some(cursor) if is_truth_ours(&cursor, &target) => Some(truth(&cursor, &target, mended)?),
        _ => None,
    };
    let mut unknown = root.unknown(&names::session(&target, truth.is_some()));
    unknown.extend(of_target);
    Ok(Session {
        name: root.text_or_empty("name")?,
        notes: root.text_or_empty("notes")?,
        robot: root.optional("robot").map_or_else(|| Ok(Robot::default()), |cursor| robot(&cursor, mended))?,
        sensor: root.optional("sensor").map_or_else(|| Ok(Sensor::default()), |cursor| sensor(&cursor, mended))?,
        mount: root.optional("mount").map_or(Ok(Mount::default()), |cursor| {
            cursor.one_of(&[(names::ON_FLANGE, Mount::OnFlange), (names::FIXED, Mount::Fixed)])
        })?,
        published: root.optional("published").map(|cursor| published(&cursor, stations.len())).transpose()?,
        target,
        known,
        stations,
        further: root.optional("further").map_or_else(|| Ok(Vec::new()), |cursor| further(&cursor, mended))?,
        truth,
        unknown,
    })
}

fn robot(cursor: &Cursor<'_>, mended: &mut Mended) -> Result<Robot, Refusal> {
    let object = cursor.object("an object that describes the robot")?;
    let mut unknown = object.unknown(names::ROBOT);
    Ok(Robot {
        model: object.text_or_empty("model")?,
        notation: notation(&object, &mut unknown, mended)?,
        position_std_mm: object.optional_number("position_std_mm", &limits::LENGTH_STD_MM)?,
        orientation_std_deg: object.optional_number("orientation_std_deg", &limits::ORIENTATION_STD_DEG)?,
        unknown,
    })
}

/// The convention, with what else differs from millimetres and degrees of the flange in the base.
fn notation(robot: &Object<'_>, unknown: &mut UnknownFields, mended: &mut Mended) -> Result<PoseNotation, Refusal> {
    let convention = robot
        .optional("pose_convention")
        .map_or_else(|| Ok(PoseConvention::default_convention()), |cursor| convention(&cursor))?;
    let usual = PoseNotation::of(convention);
    let Some(cursor) = robot.optional("pose_notation") else {
        return Ok(usual);
    };
    let object = cursor.object("an object that says in which numbers poses are shown")?;
    let mut unknown_here = object.unknown(names::NOTATION);
    let flange_from_tcp = match object.optional("flange_from_tcp") {
        // What the tool point was written in is of no use to anyone.
        Some(_) => Some(pose(&object, "flange_from_tcp", &mut unknown_here, mended)?.0),
        None => None,
    };
    if !unknown_here.is_empty() {
        unknown.insert("pose_notation".to_owned(), unknown_here.into());
    }
    Ok(PoseNotation {
        convention,
        orientation: object
            .optional("orientation")
            .map_or(Ok(usual.orientation), |cursor| cursor.one_of(names::ORIENTATIONS))?,
        angle_unit: object
            .optional("angle_unit")
            .map_or(Ok(usual.angle_unit), |cursor| cursor.one_of(names::ANGLE_UNITS))?,
        length_unit: object
            .optional("length_unit")
            .map_or(Ok(usual.length_unit), |cursor| cursor.one_of(names::LENGTH_UNITS))?,
        flange_from_tcp,
        is_inverse: object.optional("inverse").map_or(Ok(usual.is_inverse), |cursor| cursor.boolean())?,
    })
}

fn sensor(cursor: &Cursor<'_>, mended: &mut Mended) -> Result<Sensor, Refusal> {
    let object = cursor.object("an object that describes the sensor")?;
    let mut unknown = object.unknown(names::SENSOR);
    let rough_flange_from_sensor = match object.optional("rough_flange_from_sensor") {
        // What a rough mounting was written in is of no use to anyone.
        Some(_) => Some(pose(&object, "rough_flange_from_sensor", &mut unknown, mended)?.0),
        None => None,
    };
    Ok(Sensor {
        model: object.text_or_empty("model")?,
        profile_std_mm: object.optional_number("profile_std_mm", &limits::LENGTH_STD_MM)?,
        reference_distance_mm: object.optional_number("reference_distance_mm", &limits::REFERENCE_DISTANCE_MM)?,
        rough_flange_from_sensor,
        unknown,
    })
}

fn convention(cursor: &Cursor<'_>) -> Result<&'static PoseConvention, Refusal> {
    let expected = known_conventions();
    PoseConvention::by_id(cursor.text(&expected)?).ok_or_else(|| cursor.refuse(expected))
}

fn known_conventions() -> String {
    listed(PoseConvention::all().map(|convention| convention.id))
}

/// The field `target` with what is known of it; its unknown fields go into `unknown`.
fn target(
    parent: &Object<'_>,
    kinds: &[(&str, Kind)],
    unknown: &mut UnknownFields,
) -> Result<(Target, Known), Refusal> {
    let expected = "an object like {\"kind\": \"ball\", \"radius_mm\": 15}";
    let cursor = parent.required("target", expected)?;
    let object = cursor.object(expected)?;
    let kind = object.required("kind", &listed(kinds.iter().map(|(word, _)| *word)))?.one_of(kinds)?;
    let mut known = Known::default();
    let target = match kind {
        Kind::Ball => {
            let radius = object.required("radius_mm", &limits::BALL_RADIUS_MM.to_string())?;
            Target::Ball {
                radius_mm: radius.number(&limits::BALL_RADIUS_MM)?,
                radius_std_mm: object.optional_number("radius_std_mm", &limits::LENGTH_STD_MM)?,
            }
        }
        Kind::RightAnglePlate => Target::RightAnglePlate,
        Kind::Point => {
            known.point_in_base_mm =
                object.optional("touched_in_base_mm").map(|cursor| cursor.vec3(&limits::POSITION_MM)).transpose()?;
            Target::Point
        }
        Kind::Pose => Target::Pose {
            translation_std_mm: object.optional_number("translation_std_mm", &limits::LENGTH_STD_MM)?,
            rotation_std_deg: object.optional_number("rotation_std_deg", &limits::ORIENTATION_STD_DEG)?,
        },
        Kind::Workpiece => {
            known.angle_deg = object.optional_number("angle_deg", &limits::PLANE_ANGLE_DEG)?;
            known.pitch_mm = object.optional_number("pitch_mm", &limits::PART_SIZE_MM)?;
            known.height_mm = object.optional_number("height_mm", &limits::PART_SIZE_MM)?;
            known.diameter_mm = object.optional_number("diameter_mm", &limits::PART_SIZE_MM)?;
            Target::Workpiece
        }
        Kind::Rgbd => Target::Rgbd { sequence: sequence(parent)? },
    };
    object.keep_unknown_in(unknown, "target", names::target(&target));
    Ok((target, known))
}

fn further(cursor: &Cursor<'_>, mended: &mut Mended) -> Result<Vec<FurtherTarget>, Refusal> {
    let elements = cursor.elements("a list of further targets")?;
    let mut idx_of_name: HashMap<String, usize> = HashMap::new();
    let mut all = Vec::with_capacity(elements.len());
    for (idx, element) in elements.iter().enumerate() {
        let one = further_target(element, mended)?;
        if let Some(first_idx) = idx_of_name.insert(one.name.clone(), idx) {
            return Err(taken_twice(element, "name", &one.name, cursor, first_idx, "further target"));
        }
        all.push(one);
    }
    Ok(all)
}

fn further_target(cursor: &Cursor<'_>, mended: &mut Mended) -> Result<FurtherTarget, Refusal> {
    let object = cursor.object("an object with name, target and stations")?;
    let mut unknown = object.unknown(names::FURTHER);
    let (target, known) = target(&object, KINDS_WITH_STATIONS, &mut unknown)?;
    let name = one_line(&object.required("name", ONE_LINE)?)?;
    let profile_std_mm = object.optional_number("profile_std_mm", &limits::LENGTH_STD_MM)?;
    Ok(FurtherTarget { name, stations: stations(&object, &target, mended)?, target, known, profile_std_mm, unknown })
}

/// A name or label of `element` that an earlier element of the list has as well.
fn taken_twice(
    element: &Cursor<'_>,
    field: &str,
    text: &str,
    list: &Cursor<'_>,
    first_idx: usize,
    of_what: &str,
) -> Refusal {
    Refusal {
        path: format!("{}.{field}", element.path()),
        found: format!("{}, which {}[{first_idx}] has too", super::tree::quoted(text), list.path()),
        expected: format!("a {field} of its own for each {of_what}"),
    }
}

fn sequence(root: &Object<'_>) -> Result<String, Refusal> {
    let expected = "the sequence's folder, relative to this file";
    let cursor = root.required("sequence", expected)?;
    let folder = cursor.text(expected)?;
    if folder.trim().is_empty() || Path::new(folder).is_absolute() {
        return Err(cursor.refuse(expected));
    }
    Ok(folder.to_owned())
}

fn stations(root: &Object<'_>, target: &Target, mended: &mut Mended) -> Result<Vec<Station>, Refusal> {
    let expected = "a list of stations";
    let has_sequence = matches!(target, Target::Rgbd { .. });
    let cursor = match root.optional("stations") {
        Some(cursor) => cursor,
        None if has_sequence => return Ok(Vec::new()),
        None => root.required("stations", expected)?,
    };
    let elements = cursor.elements(expected)?;
    if has_sequence && !elements.is_empty() {
        return Err(cursor.refuse("no stations: an RGB-D session has a sequence in their place"));
    }
    let mut station_of_label: HashMap<String, usize> = HashMap::new();
    let mut stations = Vec::with_capacity(elements.len());
    for (station_idx, element) in elements.iter().enumerate() {
        let station = station(element, station_idx, target, mended)?;
        if let Some(first_idx) = station_of_label.insert(station.label.clone(), station_idx) {
            return Err(taken_twice(element, "label", &station.label, &cursor, first_idx, "station"));
        }
        stations.push(station);
    }
    Ok(stations)
}

fn station(cursor: &Cursor<'_>, station_idx: usize, target: &Target, mended: &mut Mended) -> Result<Station, Refusal> {
    let object = cursor.object("an object with the captures of a station")?;
    let edges = [("p", Edge::P), ("q", Edge::Q)];
    let edge = match object.optional("edge") {
        Some(cursor) => Some(cursor.one_of(&edges)?),
        None if *target == Target::RightAnglePlate => Some(
            object.required("edge", "\"p\" or \"q\": the edge of the plate that this station saw")?.one_of(&edges)?,
        ),
        None => None,
    };
    let captures = object.required("captures", "a list of at least one capture")?;
    let elements = captures.elements("a list of at least one capture")?;
    if elements.is_empty() {
        return Err(captures.refuse("at least one capture"));
    }
    Ok(Station {
        label: label(&object, station_idx)?,
        enabled: object.optional("enabled").map_or(Ok(true), |cursor| cursor.boolean())?,
        side: object.optional("side").map_or(Ok(SideChoice::Auto), |cursor| {
            cursor.one_of(&[
                (names::AUTO, SideChoice::Auto),
                (Side::Plus.symbol(), SideChoice::Given(Side::Plus)),
                (Side::Minus.symbol(), SideChoice::Given(Side::Minus)),
            ])
        })?,
        edge,
        captures: elements.iter().map(|element| capture(element, mended)).collect::<Result<_, _>>()?,
        unknown: object.unknown(names::STATION),
    })
}

fn label(station: &Object<'_>, station_idx: usize) -> Result<String, Refusal> {
    station.optional("label").map_or_else(|| Ok((station_idx + 1).to_string()), |cursor| one_line(&cursor))
}

const ONE_LINE: &str = "text on one line that is not empty";

/// A name or label.
fn one_line(cursor: &Cursor<'_>) -> Result<String, Refusal> {
    let text = cursor.text(ONE_LINE)?;
    if text.trim().is_empty() || text.chars().any(char::is_control) {
        return Err(cursor.refuse(ONE_LINE));
    }
    Ok(text.to_owned())
}

fn capture(cursor: &Cursor<'_>, mended: &mut Mended) -> Result<Capture, Refusal> {
    let object = cursor.object("an object with base_from_flange, and profile, point_mm or sensor_from_target")?;
    let mut unknown = object.unknown(names::CAPTURE);
    let (base_from_flange, written_angles) = pose(&object, "base_from_flange", &mut unknown, mended)?;
    let one_of = "one of profile, point_mm and sensor_from_target";
    let readings = ["profile", "point_mm", "sensor_from_target"].map(|name| object.optional(name));
    let reading = match readings {
        [Some(cursor), None, None] => Reading::Profile(Arc::new(profile(&cursor, &mut unknown)?)),
        [None, Some(cursor), None] => Reading::Point(cursor.vec3(&limits::POINT_MM)?),
        // What a target's pose was written in is of no use to anyone.
        [None, None, Some(_)] => Reading::Pose(pose(&object, "sensor_from_target", &mut unknown, mended)?.0),
        [None, None, None] => {
            return Err(cursor.refuse_as("neither profile nor point_mm nor sensor_from_target", one_of));
        }
        [Some(_), Some(_), _] => return Err(cursor.refuse_as("both profile and point_mm", one_of)),
        [_, _, Some(_)] => return Err(cursor.refuse_as("sensor_from_target beside another reading", one_of)),
    };
    Ok(Capture {
        base_from_flange,
        written_angles,
        reading,
        step_mm: object.optional_number("step", &limits::STEP_MM)?,
        unknown,
    })
}

fn profile(cursor: &Cursor<'_>, unknown: &mut UnknownFields) -> Result<Profile, Refusal> {
    let object = cursor.object("an object with x_mm and z_mm")?;
    object.keep_unknown_in(unknown, "profile", names::PROFILE);
    let (x_expected, z_expected) = ("a list of numbers in mm", "a list of numbers in mm, null for a missing point");
    let (x_cursor, z_cursor) = (object.required("x_mm", x_expected)?, object.required("z_mm", z_expected)?);
    let x_mm = x_cursor.numbers_or_null(x_expected)?;
    if let Some(index) = x_mm.iter().position(|x| x.is_nan()) {
        return Err(x_cursor.refuse_element(index, "null", "a number in mm: only z may be missing"));
    }
    let z_mm: Vec<Option<f64>> =
        z_cursor.numbers_or_null(z_expected)?.iter().map(|z| (!z.is_nan()).then_some(*z)).collect();
    Profile::new(x_mm.to_vec(), &z_mm).map_err(|error| match error {
        ProfileError::LengthMismatch { num_x, .. } => {
            z_cursor.refuse(format!("a list of {num_x}, as many as x_mm has"))
        }
        ProfileError::OutOfRange { axis, index, value, .. } => {
            let list = if axis == 'x' { &x_cursor } else { &z_cursor };
            list.refuse_element(index, value.to_string(), limits::POINT_MM.to_string())
        }
    })
}

/// A pose, as a quaternion or as a maker's three angles; these as they are written, also where they stand beside the
/// quaternion that was made of them.
fn pose<Dst: Frame, Src: Frame>(
    parent: &Object<'_>,
    name: &str,
    unknown: &mut UnknownFields,
    mended: &mut Mended,
) -> Result<(Transform<Dst, Src>, Option<WrittenAngles>), Refusal> {
    let expected = "an object with translation_mm and quaternion_wxyz, or with euler_deg and convention";
    let cursor = parent.required(name, expected)?;
    let object = cursor.object(expected)?;
    let mut unknown_here = object.unknown(names::POSE);
    let translation_mm = object.required("translation_mm", "a list of 3 numbers in mm")?.vec3(&limits::POSITION_MM)?;
    let (rotation, written) = match (object.optional("quaternion_wxyz"), object.optional("euler_deg")) {
        (Some(cursor), None) => (quaternion(&cursor, mended)?, written_beside_quaternion(&object, &mut unknown_here)?),
        (None, Some(cursor)) => {
            if let Some(second) = object.optional("written") {
                return Err(second.refuse_as("both euler_deg and written", "written only beside quaternion_wxyz"));
            }
            let written = written_angles(&cursor, &object)?;
            (upper_half(written.convention.rotation_from_angles_deg(written.angles_deg)), Some(written))
        }
        (Some(_), Some(_)) => return Err(cursor.refuse_as("both quaternion_wxyz and euler_deg", "one of them")),
        (None, None) => {
            return Err(cursor.refuse_as("no orientation", "quaternion_wxyz, or euler_deg and convention"));
        }
    };
    if !unknown_here.is_empty() {
        unknown.insert(name.to_owned(), unknown_here.into());
    }
    Ok((Transform::from_parts(translation_mm, rotation), written))
}

/// The angles that a pose was written in before it was saved as a quaternion.
fn written_beside_quaternion(pose: &Object<'_>, unknown: &mut UnknownFields) -> Result<Option<WrittenAngles>, Refusal> {
    let expected = "an object with euler_deg and convention";
    let Some(cursor) = pose.optional("written") else {
        return Ok(None);
    };
    let object = cursor.object(expected)?;
    object.keep_unknown_in(unknown, "written", names::WRITTEN);
    let angles = object.required("euler_deg", "a list of 3 angles in degrees")?;
    written_angles(&angles, &object).map(Some)
}

fn written_angles(angles: &Cursor<'_>, object: &Object<'_>) -> Result<WrittenAngles, Refusal> {
    Ok(WrittenAngles {
        angles_deg: angles.array::<3>(&limits::ANGLE_DEG)?,
        convention: convention(&object.required("convention", &known_conventions())?)?,
    })
}

fn quaternion(cursor: &Cursor<'_>, mended: &mut Mended) -> Result<UnitQuaternion<f64>, Refusal> {
    let [w, x, y, z] = cursor.array::<4>(&limits::QUATERNION)?;
    let quaternion = Quaternion::new(w, x, y, z);
    let norm = quaternion.norm();
    let off = (norm - 1.0).abs();
    if off > limits::QUATERNION_NORM_TOLERANCE {
        return Err(cursor.refuse_as(
            format!("a quaternion of norm {norm:.6}"),
            format!("norm 1 within {}", limits::QUATERNION_NORM_TOLERANCE),
        ));
    }
    if off > limits::QUATERNION_NORM_NOTED {
        mended.note(cursor.path(), norm);
    }
    Ok(upper_half(if off > limits::QUATERNION_NORM_EXACT {
        UnitQuaternion::new_normalize(quaternion)
    } else {
        UnitQuaternion::new_unchecked(quaternion)
    }))
}

/// Of the two quaternions of a rotation the one with `w ≥ 0`, as it will be saved.
fn upper_half(rotation: UnitQuaternion<f64>) -> UnitQuaternion<f64> {
    if rotation.w < 0.0 { UnitQuaternion::new_unchecked(-rotation.into_inner()) } else { rotation }
}

fn published(cursor: &Cursor<'_>, num_stations: usize) -> Result<Published, Refusal> {
    let object = cursor.object("an object with what a paper printed")?;
    let rows = |name: &str, quantity: &Quantity| {
        let Some(cursor) = object.optional(name) else {
            return Ok(Vec::new());
        };
        let elements = cursor.elements("a list of points, one a station")?;
        if elements.len() != num_stations && !elements.is_empty() {
            return Err(cursor.refuse(format!("a list of {num_stations}, one a station")));
        }
        elements.iter().map(|element| element.vec3(quantity)).collect()
    };
    Ok(Published {
        target_in_base_mm: rows("ball_in_base_mm", &limits::POSITION_MM)?,
        error_from_first_mm: rows("error_from_first_mm", &limits::POSITION_MM)?,
        caption: object.text_or_empty("caption")?,
        unknown: object.unknown(names::PUBLISHED),
    })
}

/// The truth of a sequence is ours if it says where the sensor is; any other's is kept as it is.
fn is_truth_ours(cursor: &Cursor<'_>, target: &Target) -> bool {
    let says_where = |object: &Object<'_>| {
        [names::TRUE_SENSOR.on_flange, names::TRUE_SENSOR.fixed].iter().any(|name| object.optional(name).is_some())
    };
    !matches!(target, Target::Rgbd { .. })
        || cursor.object("an object with the true calibration").is_ok_and(|object| says_where(&object))
}

/// The truth; with a fixed sensor its fields are named after the frames that they are in, and either name is read.
fn truth(cursor: &Cursor<'_>, target: &Target, mended: &mut Mended) -> Result<Truth, Refusal> {
    let object = cursor.object("an object with the true calibration")?;
    let present = |names: ByMount| {
        if object.optional(names.fixed).is_some() { names.fixed } else { names.on_flange }
    };
    let mut unknown = object.unknown(&names::truth(target));
    // What the truth was written in is of no use to anyone.
    let (flange_from_sensor, _) = pose(&object, present(names::TRUE_SENSOR), &mut unknown, mended)?;
    let position = |names: ByMount, what: &str| {
        let cursor = object.required(present(names), &format!("{what}, a list of 3 numbers in mm"))?;
        cursor.vec3(&limits::POSITION_MM)
    };
    let mut whole = |names: ByMount| {
        let (base_from_part, _) = pose::<Base, Flange>(&object, present(names), &mut unknown, mended)?;
        Ok(*base_from_part.rigid())
    };
    let (target_in_base_mm, base_from_plate, base_from_target) = match target {
        Target::Ball { .. } => (position(names::TRUE_BALL, "the ball's true centre")?, None, None),
        Target::Point => (position(names::TRUE_POINT, "the true point")?, None, None),
        Target::RightAnglePlate => {
            let base_from_plate = whole(names::TRUE_PLATE)?;
            (base_from_plate.translation.vector, Some(base_from_plate), None)
        }
        Target::Pose { .. } => {
            let base_from_target = whole(names::TRUE_TARGET)?;
            (base_from_target.translation.vector, None, Some(base_from_target))
        }
        Target::Rgbd { .. } if object.optional(present(names::TRUE_WORLD)).is_some() => {
            let base_from_world = whole(names::TRUE_WORLD)?;
            (base_from_world.translation.vector, None, Some(base_from_world))
        }
        Target::Workpiece | Target::Rgbd { .. } => (Vec3::zeros(), None, None),
    };
    Ok(Truth { flange_from_sensor, target_in_base_mm, base_from_plate, base_from_target, unknown })
}
