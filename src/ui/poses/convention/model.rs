//! Data of the bar and its dialogs, built without egui.

use crate::geometry::notation::{AngleUnit, LengthUnit, NotAPose, OrientationForm};
use crate::geometry::{Base, Flange, PoseConvention, PoseNotation, Transform, Vec3, so3};
use crate::report::figure::Orbit;
use crate::session::{Edit, EditRefusal, Session};
use crate::text::conventions as words;

/// So many poses are drawn and listed; more would hide each other.
pub const MAX_FRAMES: usize = 8;

/// One entry of the list of notations.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    /// The name people know it by.
    pub label: &'static str,
    /// The formula.
    pub detail: String,
    convention: Option<&'static PoseConvention>,
    orientation: OrientationForm,
}

impl Choice {
    fn of(convention: &'static PoseConvention) -> Self {
        Self {
            label: convention.label,
            detail: words::convention_detail(convention),
            convention: Some(convention),
            orientation: OrientationForm::Angles,
        }
    }

    fn quaternion(orientation: OrientationForm) -> Self {
        let notation = PoseNotation { orientation, ..PoseNotation::default() };
        let detail = match orientation {
            OrientationForm::QuaternionXyzw => words::ROS_DETAIL,
            OrientationForm::Angles | OrientationForm::QuaternionWxyz => words::ROBTARGET_DETAIL,
        };
        Self { label: words::notation_name(&notation), detail: detail.to_owned(), convention: None, orientation }
    }

    /// The notation after this choice: with the usual units, of the same frame as before.
    #[must_use]
    pub fn applied_to(&self, notation: &PoseNotation) -> PoseNotation {
        let PoseNotation { flange_from_tcp, is_inverse, .. } = *notation;
        if let Some(convention) = self.convention {
            return PoseNotation { flange_from_tcp, is_inverse, ..PoseNotation::usual(convention) };
        }
        let length_unit = match self.orientation {
            OrientationForm::QuaternionXyzw => LengthUnit::Metres,
            OrientationForm::Angles | OrientationForm::QuaternionWxyz => LengthUnit::Millimetres,
        };
        PoseNotation { orientation: self.orientation, length_unit, ..*notation }
    }

    /// Whether this is what the notation writes.
    #[must_use]
    pub fn is_that_of(&self, notation: &PoseNotation) -> bool {
        self.orientation == notation.orientation
            && self.convention.is_none_or(|convention| convention.id == notation.convention.id)
    }

    /// Whether each word searched for begins a word here.
    fn is_found(&self, search: &str) -> bool {
        let words = plain_words(&format!("{} {}", self.label, self.detail));
        plain_words(search).iter().all(|searched| words.iter().any(|word| word.starts_with(searched)))
    }
}

/// Small letters without marks, as people type them.
fn plain_words(text: &str) -> Vec<String> {
    let text = text.to_lowercase().replace('ä', "a");
    text.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty()).map(str::to_owned).collect()
}

/// The list in its groups, as far as a search leaves it; the makers first, custom orders last.
#[must_use]
pub fn choices(search: &str, with_quaternions: bool) -> Vec<(&'static str, Vec<Choice>)> {
    let conventions = |list: &'static [PoseConvention]| list.iter().map(Choice::of).collect::<Vec<_>>();
    let quaternions = [OrientationForm::QuaternionWxyz, OrientationForm::QuaternionXyzw].map(Choice::quaternion);
    let mut groups = vec![
        (words::MAKERS, conventions(PoseConvention::MAKERS)),
        (words::DISPUTED, conventions(PoseConvention::DISPUTED)),
        (words::QUATERNIONS, if with_quaternions { quaternions.to_vec() } else { Vec::new() }),
        (words::CUSTOM, conventions(PoseConvention::NEUTRAL)),
    ];
    for (_, choices) in &mut groups {
        choices.retain(|choice| choice.is_found(search));
    }
    groups.retain(|(_, choices)| !choices.is_empty());
    groups
}

/// A notation being chosen. The tool point is kept as the numbers typed, as near gimbal lock others mean the same.
#[derive(Clone, Debug, PartialEq)]
pub struct Draft {
    /// All but the tool point.
    notation: PoseNotation,
    /// Whether the numbers are those of a tool point.
    pub has_tool_point: bool,
    /// Its frame in the flange, in the units and angles of the notation.
    pub tool_numbers: [f64; 6],
}

impl Draft {
    /// Begins with a notation.
    #[must_use]
    pub fn of(notation: &PoseNotation) -> Self {
        let mut draft = Self {
            notation: PoseNotation { flange_from_tcp: None, ..*notation },
            has_tool_point: notation.flange_from_tcp.is_some(),
            tool_numbers: [0.0; 6],
        };
        if let Some(flange_from_tcp) = notation.flange_from_tcp {
            draft.tool_numbers = draft.numbers_of(&Transform::from_rigid(*flange_from_tcp.rigid()));
        }
        draft
    }

    /// All but the tool point.
    #[must_use]
    pub const fn without_tool(&self) -> &PoseNotation {
        &self.notation
    }

    /// Another notation with the same tool point.
    pub fn set(&mut self, notation: PoseNotation) {
        let tool = self.tool();
        self.notation = PoseNotation { flange_from_tcp: None, ..notation };
        if let Ok(tool) = tool {
            self.tool_numbers = self.numbers_of(&tool);
        }
    }

    /// The notation as a whole.
    ///
    /// # Errors
    /// [`NotAPose`] if a number of the tool point is not finite.
    pub fn notation(&self) -> Result<PoseNotation, NotAPose> {
        let flange_from_tcp =
            if self.has_tool_point { Some(Transform::from_rigid(*self.tool()?.rigid())) } else { None };
        Ok(PoseNotation { flange_from_tcp, ..self.notation })
    }

    /// How six numbers stand for the tool's frame: as those of a pose, in plain angles.
    fn plain(&self) -> PoseNotation {
        PoseNotation { orientation: OrientationForm::Angles, is_inverse: false, ..self.notation }
    }

    fn tool(&self) -> Result<Transform<Base, Flange>, NotAPose> {
        self.plain().base_from_flange(&self.tool_numbers)
    }

    fn numbers_of(&self, tool: &Transform<Base, Flange>) -> [f64; 6] {
        self.plain().numbers(tool).try_into().unwrap_or([0.0; 6])
    }
}

/// A pose to be drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedFrame {
    /// The station's label.
    pub label: String,
    /// Its first capture's pose.
    pub base_from_flange: Transform<Base, Flange>,
}

/// The poses of the first stations.
#[must_use]
pub fn frames(session: &Session) -> Vec<NamedFrame> {
    let named = |station: &crate::session::Station| {
        let capture = station.captures.first()?;
        Some(NamedFrame { label: station.label.clone(), base_from_flange: capture.base_from_flange })
    };
    session.stations.iter().filter_map(named).take(MAX_FRAMES).collect()
}

/// Decimals of the number at a place of a pose, so that every unit shows about a micrometre or a thousandth of a degree.
#[must_use]
pub const fn decimals(notation: &PoseNotation, number_idx: usize) -> usize {
    match (number_idx, notation.length_unit, notation.orientation, notation.angle_unit) {
        (0..3, LengthUnit::Millimetres, ..) | (3.., _, OrientationForm::Angles, AngleUnit::Degrees) => 3,
        (0..3, LengthUnit::Metres, ..) | (3.., _, OrientationForm::Angles, AngleUnit::Radians) => 6,
        (3.., _, OrientationForm::QuaternionWxyz | OrientationForm::QuaternionXyzw, _) => 5,
    }
}

/// What becomes of one pose when its numbers are read differently.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Change {
    /// How far it turns, degrees.
    pub turns_deg: f64,
    /// How far its origin moves, mm.
    pub moves_mm: f64,
    /// The direction of its z axis in the base before.
    pub z_now: Vec3,
    /// And after.
    pub z_then: Vec3,
}

/// How the tool turned from one station to the next: after a jog about one of its axes, about that axis, if the poses are
/// read as the robot means them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jog {
    /// How far, degrees.
    pub angle_deg: f64,
    /// About this axis, a unit vector in the flange; zero if it did not turn.
    pub axis_in_flange: Vec3,
}

/// How the tool turned from the first station to the second.
#[must_use]
pub fn jog(frames: &[NamedFrame]) -> Option<Jog> {
    /// Less is no turn but noise, rad.
    const LEAST_TURN: f64 = 1e-6;
    let [first, second, ..] = frames else { return None };
    let turn = so3::log(&(first.base_from_flange.rotation().inverse() * second.base_from_flange.rotation()));
    let axis_in_flange = turn.try_normalize(LEAST_TURN).unwrap_or_else(Vec3::zeros);
    Some(Jog { angle_deg: turn.norm().to_degrees(), axis_in_flange })
}

/// What reading the numbers differently would do.
#[derive(Clone, Debug, PartialEq)]
pub struct Preview {
    /// The first poses as they are.
    pub now: Vec<NamedFrame>,
    /// As they would be.
    pub then: Vec<NamedFrame>,
    /// The difference of each.
    pub changes: Vec<Change>,
}

impl Preview {
    /// Reads the numbers of a session in another way.
    ///
    /// # Errors
    /// [`EditRefusal`] if they have no meaning in that way.
    pub fn of(session: &Session, notation: &PoseNotation) -> Result<Self, EditRefusal> {
        let changed = Edit::Reinterpret(*notation).apply(session)?;
        let (now, then) = (frames(session), frames(&changed));
        let changes = now.iter().zip(&then).map(|(now, then)| change(now, then)).collect();
        Ok(Self { now, then, changes })
    }
}

fn change(now: &NamedFrame, then: &NamedFrame) -> Change {
    let (now, then) = (&now.base_from_flange, &then.base_from_flange);
    Change {
        turns_deg: so3::log(&(now.rotation().inverse() * then.rotation())).norm().to_degrees(),
        moves_mm: (then.translation_mm() - now.translation_mm()).norm(),
        z_now: now.rotation() * Vec3::z(),
        z_then: then.rotation() * Vec3::z(),
    }
}

/// What part of the base's space is in the picture, as the camera sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extent {
    /// Its middle: to the right and up, mm.
    pub middle: [f64; 2],
    /// Its size: to the right and up, mm.
    pub size_mm: [f64; 2],
    /// Whether the base's origin is in it.
    pub has_base: bool,
}

impl Extent {
    /// Around the frames, and around the base as well unless that would leave too little room for them.
    #[must_use]
    pub fn of(frames: &[NamedFrame], camera: &Orbit) -> Self {
        /// The frames take up at least this part of the picture.
        const LEAST_PART: f64 = 0.6;
        /// Seen along a row of frames they would fill the picture: so much of their real extent counts in any case.
        const LEAST_SEEN: f64 = 0.4;
        let mut points: Vec<Vec3> = frames.iter().map(|frame| frame.base_from_flange.translation_mm()).collect();
        let extent_mm = |points: &[Vec3]| {
            let [least, most] = bounds(points);
            (most - least).norm()
        };
        let alone_mm = extent_mm(&points);
        points.push(Vec3::zeros());
        let has_base = frames.is_empty() || alone_mm >= LEAST_PART * extent_mm(&points);
        if !has_base {
            points.pop();
        }
        let least_mm = (LEAST_SEEN * extent_mm(&points)).max(1.0);
        let seen: Vec<Vec3> = points.iter().map(|point| camera.seen(*point)).collect();
        let [least, most] = bounds(&seen);
        let (middle, size) = (0.5 * (least + most), most - least);
        Self { middle: [middle.x, middle.y], size_mm: [size.x.max(least_mm), size.y.max(least_mm)], has_base }
    }
}

fn bounds(points: &[Vec3]) -> [Vec3; 2] {
    let least = points.iter().fold(Vec3::repeat(f64::INFINITY), |least, point| least.inf(point));
    let most = points.iter().fold(Vec3::repeat(f64::NEG_INFINITY), |most, point| most.sup(point));
    [least, most]
}
