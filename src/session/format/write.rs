//! Writing sessions: stable order, one line a list of numbers, and every number in its shortest exact form.

use std::fmt::Write;

use serde_json::Value;

use crate::calibrate::{Mount, SideChoice};
use crate::geometry::{Base, Flange, Frame, PoseNotation, Profile, Rigid, Transform, Vec3};
use crate::session::model::{
    Capture, Edge, FurtherTarget, Known, Published, Reading, Robot, Sensor, Session, Station, Target, Truth,
    UnknownFields, WrittenAngles,
};

use super::VERSION;
use super::names::{self, ByMount};

/// The session as the text of its file. Equal sessions give equal text.
#[must_use]
pub fn to_json(session: &Session) -> String {
    let mut out = Writer::default();
    out.open(Layout::Lines);
    out.field("format").text(names::FORMAT);
    out.field("version").raw(&VERSION.to_string());
    out.field("name").text(&session.name);
    out.field("notes").text(&session.notes);
    if session.robot != Robot::default() {
        out.field("robot");
        robot(&mut out, &session.robot);
    }
    if session.sensor != Sensor::default() {
        out.field("sensor");
        sensor(&mut out, &session.sensor);
    }
    out.field("target");
    target(&mut out, &session.target, &session.known, nested(&session.unknown, "target"));
    if session.mount == Mount::Fixed {
        out.field("mount").text(names::FIXED);
    }
    if let Target::Rgbd { sequence } = &session.target {
        out.field("sequence").text(sequence);
    } else {
        out.field("stations");
        out.list(Layout::Lines, &session.stations, station);
    }
    if !session.further.is_empty() {
        out.field("further");
        out.list(Layout::Lines, &session.further, further);
    }
    if let Some(printed) = &session.published {
        out.field("published");
        published(&mut out, printed);
    }
    if let Some(true_values) = &session.truth {
        out.field("truth");
        truth(&mut out, true_values, &session.target, session.mount);
    }
    out.unknown(&session.unknown, &names::session(&session.target, session.truth.is_some()));
    out.close();
    out.text.push('\n');
    out.text
}

fn robot(out: &mut Writer, robot: &Robot) {
    out.open(Layout::Line);
    out.field("model").text(&robot.model);
    out.field("pose_convention").text(robot.notation.convention.id);
    let unknown = nested(&robot.unknown, "pose_notation");
    if unknown.is_some() || robot.notation != PoseNotation::of(robot.notation.convention) {
        out.field("pose_notation");
        notation(out, &robot.notation, unknown);
    }
    out.optional_number("position_std_mm", robot.position_std_mm);
    out.optional_number("orientation_std_deg", robot.orientation_std_deg);
    out.unknown(&robot.unknown, names::ROBOT);
    out.close();
}

/// What differs from millimetres and degrees of the flange in the base.
fn notation(out: &mut Writer, notation: &PoseNotation, unknown: Option<&UnknownFields>) {
    let usual = PoseNotation::of(notation.convention);
    out.open(Layout::Line);
    if notation.orientation != usual.orientation {
        out.field("orientation").text(names::word_of(names::ORIENTATIONS, notation.orientation));
    }
    if notation.angle_unit != usual.angle_unit {
        out.field("angle_unit").text(names::word_of(names::ANGLE_UNITS, notation.angle_unit));
    }
    if notation.length_unit != usual.length_unit {
        out.field("length_unit").text(names::word_of(names::LENGTH_UNITS, notation.length_unit));
    }
    if let Some(flange_from_tcp) = &notation.flange_from_tcp {
        out.field("flange_from_tcp");
        pose(out, flange_from_tcp, None, unknown.and_then(|unknown| nested(unknown, "flange_from_tcp")));
    }
    if notation.is_inverse != usual.is_inverse {
        out.field("inverse").raw("true");
    }
    out.nested_unknown(unknown, names::NOTATION);
    out.close();
}

fn sensor(out: &mut Writer, sensor: &Sensor) {
    out.open(Layout::Line);
    out.field("model").text(&sensor.model);
    out.optional_number("profile_std_mm", sensor.profile_std_mm);
    out.optional_number("reference_distance_mm", sensor.reference_distance_mm);
    if let Some(rough) = &sensor.rough_flange_from_sensor {
        out.field("rough_flange_from_sensor");
        pose(out, rough, None, nested(&sensor.unknown, "rough_flange_from_sensor"));
    }
    out.unknown(&sensor.unknown, names::SENSOR);
    out.close();
}

fn target(out: &mut Writer, target: &Target, known: &Known, unknown: Option<&UnknownFields>) {
    out.open(Layout::Line);
    out.field("kind").text(match target {
        Target::Ball { .. } => names::BALL,
        Target::RightAnglePlate => names::RIGHT_ANGLE_PLATE,
        Target::Point => names::POINT,
        Target::Pose { .. } => names::POSE_TARGET,
        Target::Workpiece => names::WORKPIECE,
        Target::Rgbd { .. } => names::RGBD,
    });
    match target {
        Target::Ball { radius_mm, radius_std_mm } => {
            out.optional_number("radius_mm", Some(*radius_mm));
            out.optional_number("radius_std_mm", *radius_std_mm);
        }
        Target::Point => {
            if let Some(touched) = &known.point_in_base_mm {
                out.field("touched_in_base_mm").vec3(touched);
            }
        }
        Target::Pose { translation_std_mm, rotation_std_deg } => {
            out.optional_number("translation_std_mm", *translation_std_mm);
            out.optional_number("rotation_std_deg", *rotation_std_deg);
        }
        Target::Workpiece => {
            out.optional_number("angle_deg", known.angle_deg);
            out.optional_number("pitch_mm", known.pitch_mm);
            out.optional_number("height_mm", known.height_mm);
            out.optional_number("diameter_mm", known.diameter_mm);
        }
        Target::RightAnglePlate | Target::Rgbd { .. } => {}
    }
    out.nested_unknown(unknown, names::target(target));
    out.close();
}

fn further(out: &mut Writer, further: &FurtherTarget) {
    out.open(Layout::Lines);
    out.field("name").text(&further.name);
    out.field("target");
    target(out, &further.target, &further.known, nested(&further.unknown, "target"));
    out.optional_number("profile_std_mm", further.profile_std_mm);
    out.field("stations");
    out.list(Layout::Lines, &further.stations, station);
    out.unknown(&further.unknown, names::FURTHER);
    out.close();
}

fn station(out: &mut Writer, station: &Station) {
    out.open(Layout::Line);
    out.field("label").text(&station.label);
    out.field("enabled").raw(if station.enabled { "true" } else { "false" });
    out.field("side").text(match station.side {
        SideChoice::Auto => names::AUTO,
        SideChoice::Given(side) => side.symbol(),
    });
    if let Some(edge) = station.edge {
        out.field("edge").text(match edge {
            Edge::P => "p",
            Edge::Q => "q",
        });
    }
    out.unknown(&station.unknown, names::STATION);
    out.field_on_new_line("captures");
    out.list(Layout::Lines, &station.captures, capture);
    out.close();
}

fn capture(out: &mut Writer, capture: &Capture) {
    out.open(Layout::Line);
    out.field("base_from_flange");
    let written = capture.written_angles.as_ref();
    pose(out, &capture.base_from_flange, written, nested(&capture.unknown, "base_from_flange"));
    out.optional_number("step", capture.step_mm);
    out.unknown(&capture.unknown, names::CAPTURE);
    match &capture.reading {
        Reading::Point(point_in_sensor) => {
            out.field("point_mm").vec3(point_in_sensor);
        }
        Reading::Pose(sensor_from_target) => {
            out.field("sensor_from_target");
            pose(out, sensor_from_target, None, nested(&capture.unknown, "sensor_from_target"));
        }
        Reading::Profile(points) => {
            out.field_on_new_line("profile");
            profile(out, points, nested(&capture.unknown, "profile"));
        }
    }
    out.close();
}

fn profile(out: &mut Writer, profile: &Profile, unknown: Option<&UnknownFields>) {
    out.open(Layout::Lines);
    out.field("x_mm").numbers(profile.x_mm());
    out.field("z_mm").numbers(profile.z_mm());
    out.nested_unknown(unknown, names::PROFILE);
    out.close();
}

fn pose<Dst: Frame, Src: Frame>(
    out: &mut Writer,
    pose: &Transform<Dst, Src>,
    written: Option<&WrittenAngles>,
    unknown: Option<&UnknownFields>,
) {
    out.open(Layout::Line);
    out.field("translation_mm").vec3(&pose.translation_mm());
    out.field("quaternion_wxyz").numbers(&pose.quaternion_wxyz());
    if let Some(written) = written {
        out.field("written").open(Layout::Line);
        out.field("euler_deg").numbers(&written.angles_deg);
        out.field("convention").text(written.convention.id);
        out.nested_unknown(unknown.and_then(|unknown| nested(unknown, "written")), names::WRITTEN);
        out.close();
    }
    out.nested_unknown(unknown, names::POSE);
    out.close();
}

fn published(out: &mut Writer, published: &Published) {
    out.open(Layout::Lines);
    if !published.caption.is_empty() {
        out.field("caption").text(&published.caption);
    }
    for (name, rows) in
        [("ball_in_base_mm", &published.target_in_base_mm), ("error_from_first_mm", &published.error_from_first_mm)]
    {
        if !rows.is_empty() {
            out.field(name);
            out.list(Layout::Line, rows, |out, row| {
                out.vec3(row);
            });
        }
    }
    out.unknown(&published.unknown, names::PUBLISHED);
    out.close();
}

fn truth(out: &mut Writer, truth: &Truth, target: &Target, mount: Mount) {
    let true_pose = |out: &mut Writer, names: ByMount, rigid: &Rigid| {
        let name = names.name(mount);
        out.field(name);
        pose(out, &Transform::<Base, Flange>::from_rigid(*rigid), None, nested(&truth.unknown, name));
    };
    out.open(Layout::Lines);
    true_pose(out, names::TRUE_SENSOR, truth.flange_from_sensor.rigid());
    match target {
        Target::Ball { .. } => {
            out.field(names::TRUE_BALL.name(mount)).vec3(&truth.target_in_base_mm);
        }
        Target::Point => {
            out.field(names::TRUE_POINT.name(mount)).vec3(&truth.target_in_base_mm);
        }
        Target::RightAnglePlate => {
            if let Some(base_from_plate) = &truth.base_from_plate {
                true_pose(out, names::TRUE_PLATE, base_from_plate);
            }
        }
        Target::Pose { .. } => {
            if let Some(base_from_target) = &truth.base_from_target {
                true_pose(out, names::TRUE_TARGET, base_from_target);
            }
        }
        Target::Rgbd { .. } => {
            if let Some(base_from_world) = &truth.base_from_target {
                true_pose(out, names::TRUE_WORLD, base_from_world);
            }
        }
        Target::Workpiece => {}
    }
    out.unknown(&truth.unknown, &names::truth(target));
    out.close();
}

/// The unknown fields of the object `name`, which its parent keeps.
fn nested<'u>(unknown: &'u UnknownFields, name: &str) -> Option<&'u UnknownFields> {
    unknown.get(name).and_then(Value::as_object)
}

/// Whether the members of an object or list stand on a line each.
#[derive(Clone, Copy, PartialEq)]
enum Layout {
    Line,
    Lines,
}

struct Level {
    layout: Layout,
    is_empty: bool,
    closing: char,
    /// Whether any member stands on a line of its own.
    is_broken: bool,
}

/// JSON text under construction.
#[derive(Default)]
struct Writer {
    text: String,
    levels: Vec<Level>,
}

impl Writer {
    fn begin(&mut self, layout: Layout, opening: char, closing: char) {
        self.text.push(opening);
        self.levels.push(Level { layout, is_empty: true, closing, is_broken: false });
    }

    fn open(&mut self, layout: Layout) {
        self.begin(layout, '{', '}');
    }

    fn close(&mut self) {
        let Some(level) = self.levels.pop() else { return };
        if level.is_broken && level.layout == Layout::Lines {
            self.new_line();
        } else if !level.is_empty && level.closing == '}' {
            self.text.push(' ');
        }
        self.text.push(level.closing);
    }

    fn new_line(&mut self) {
        self.text.push('\n');
        self.text.extend(std::iter::repeat_n("  ", self.levels.len()));
    }

    fn member(&mut self, layout: Layout) {
        let Some(level) = self.levels.last_mut() else { return };
        let (is_first, is_object) = (level.is_empty, level.closing == '}');
        level.is_empty = false;
        level.is_broken |= layout == Layout::Lines;
        if !is_first {
            self.text.push(',');
        }
        if layout == Layout::Lines {
            self.new_line();
        } else if !is_first || is_object {
            self.text.push(' ');
        }
    }

    fn field(&mut self, name: &str) -> &mut Self {
        let layout = self.levels.last().map_or(Layout::Line, |level| level.layout);
        self.named_member(name, layout)
    }

    fn field_on_new_line(&mut self, name: &str) -> &mut Self {
        self.named_member(name, Layout::Lines)
    }

    fn named_member(&mut self, name: &str, layout: Layout) -> &mut Self {
        self.member(layout);
        self.text(name);
        self.raw(": ")
    }

    fn list<T>(&mut self, layout: Layout, items: &[T], mut write: impl FnMut(&mut Self, &T)) {
        self.begin(layout, '[', ']');
        for item in items {
            self.member(layout);
            write(self, item);
        }
        self.close();
    }

    fn raw(&mut self, json: &str) -> &mut Self {
        self.text.push_str(json);
        self
    }

    fn text(&mut self, text: &str) -> &mut Self {
        let json = Value::from(text).to_string();
        self.raw(&json)
    }

    fn number(&mut self, value: f64) {
        /// Outside of these the plain form would be a row of zeros.
        const PLAIN: std::ops::Range<f64> = 1e-5..1e16;
        // Writing to a string cannot fail; the shortest form that reads back as the same number is Rust's own.
        let _ = if value.is_nan() || value.is_infinite() {
            write!(self.text, "null")
        } else if value == 0.0 {
            write!(self.text, "0")
        } else if PLAIN.contains(&value.abs()) {
            write!(self.text, "{value}")
        } else {
            write!(self.text, "{value:e}")
        };
    }

    fn numbers(&mut self, values: &[f64]) -> &mut Self {
        self.text.push('[');
        for (idx, value) in values.iter().enumerate() {
            if idx > 0 {
                self.text.push_str(", ");
            }
            self.number(*value);
        }
        self.raw("]")
    }

    fn vec3(&mut self, vector: &Vec3) -> &mut Self {
        self.numbers(vector.as_slice())
    }

    fn optional_number(&mut self, name: &str, value: Option<f64>) {
        if let Some(value) = value {
            self.field(name).number(value);
        }
    }

    /// The fields of `unknown` that are not `known` ones: those hold what belongs to the objects below.
    fn unknown(&mut self, unknown: &UnknownFields, known: &[&str]) {
        for (name, value) in unknown.iter().filter(|(name, _)| !known.contains(&name.as_str())) {
            let json = value.to_string();
            self.field(name).raw(&json);
        }
    }

    fn nested_unknown(&mut self, unknown: Option<&UnknownFields>, known: &[&str]) {
        if let Some(unknown) = unknown {
            self.unknown(unknown, known);
        }
    }
}
