//! How tables were read before: what a user has set for one is applied to the next that looks alike.
//!
//! What is stored are plain texts and numbers, so that a name that this version does not know costs no more than that entry.

use serde::{Deserialize, Serialize};

use crate::geometry::notation::{AngleUnit, LengthUnit, OrientationForm};
use crate::geometry::{Flange, PoseConvention, PoseNotation, Tcp, Transform, Vec3};
use crate::session::import::bag::{Clock, Taking};
use crate::session::import::{BagOptions, ImportError, ImportOptions, Imported, Kind, Role, Separator, Source};

/// Forms of tables that are remembered.
const MAX_FORMS: usize = 32;

/// By what tables are told to be alike: as they look before anything is set.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct Form {
    kind: String,
    header: Vec<String>,
}

impl Form {
    /// The form of what was read by recognition alone.
    #[must_use]
    pub fn of(outcome: &Result<impl std::borrow::Borrow<Imported>, ImportError>, sources: &[Source]) -> Self {
        if let Ok(imported) = outcome {
            let imported: &Imported = imported.borrow();
            let kind = imported.options.kind.or_else(|| imported.parts.first().map(|part| part.kind));
            let kind = kind.map(|kind| name_of(&KINDS, kind)).unwrap_or_default();
            return Self { kind: kind.to_owned(), header: imported.preview.header.clone() };
        }
        // Of what is not recognised nothing but the kind of file is known.
        let extension = sources.first().and_then(|source| source.name.rsplit_once('.')).map(|(_, after)| after);
        Self { kind: "unrecognised".to_owned(), header: extension.map(str::to_lowercase).into_iter().collect() }
    }
}

/// What was set for tables of a form.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
struct Remembered {
    form: Form,
    settings: Settings,
}

/// What is remembered of imports.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct ImportMemory {
    forms: Vec<Remembered>,
    /// The radius of the last ball, mm.
    pub ball_radius_mm: Option<f64>,
}

impl ImportMemory {
    /// What was set for tables of this form.
    #[must_use]
    pub fn recall(&self, form: &Form) -> Option<ImportOptions> {
        self.forms.iter().find(|known| known.form == *form).map(|known| known.settings.options())
    }

    /// Keeps what was set; nothing set is nothing to keep.
    pub fn remember(&mut self, form: &Form, options: &ImportOptions) {
        self.forget(form);
        let options = &without_frames(form, options);
        if *options == ImportOptions::default() {
            return;
        }
        self.forms.insert(0, Remembered { form: form.clone(), settings: Settings::of(options) });
        self.forms.truncate(MAX_FORMS);
    }

    /// Does away with it.
    pub fn forget(&mut self, form: &Form) {
        self.forms.retain(|known| known.form != *form);
    }
}

/// Programs of a maker look all alike, but each is for its own tool and frame: those are not remembered.
fn without_frames(form: &Form, options: &ImportOptions) -> ImportOptions {
    const PROGRAMS: [Kind; 4] = [Kind::FanucProgram, Kind::AbbModule, Kind::KukaProgram, Kind::UrScript];
    if !PROGRAMS.iter().any(|kind| name_of(&KINDS, *kind) == form.kind) {
        return options.clone();
    }
    // A notation with no tool in it would take away the one that the next program defines.
    ImportOptions { notation: None, base_from_user_frame: None, ..options.clone() }
}

/// [`ImportOptions`] in plain texts and numbers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
struct Settings {
    kind: Option<String>,
    separator: Option<String>,
    decimal_comma: Option<bool>,
    has_header: Option<bool>,
    roles: Option<Vec<String>>,
    notation: Option<Notation>,
    base_from_user_frame: Option<[f64; 6]>,
    profiles_in_metres: Option<bool>,
    is_z_mirrored: bool,
    bag: Option<BagSettings>,
}

/// [`BagOptions`] in plain texts and numbers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
struct BagSettings {
    pose_topic: Option<String>,
    profile_topic: Option<String>,
    base_frame: Option<String>,
    flange_frame: Option<String>,
    axes: Option<String>,
    is_recording_time: bool,
    taking: Option<String>,
    pair_within_ms: Option<f64>,
    still_for_s: Option<f64>,
    still_within_mm: Option<f64>,
    still_within_deg: Option<f64>,
    has_separate_stays: bool,
}

/// A [`PoseNotation`] in plain texts and numbers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
struct Notation {
    convention: String,
    orientation: String,
    is_in_radians: bool,
    is_in_metres: bool,
    flange_from_tcp: Option<Frame>,
    is_inverse: bool,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
struct Frame {
    translation_mm: [f64; 3],
    quaternion_wxyz: [f64; 4],
}

const KINDS: [(Kind, &str); 12] = [
    (Kind::Session, "session"),
    (Kind::PoseTable, "pose-table"),
    (Kind::PrintedTable, "printed-table"),
    (Kind::FanucProgram, "fanuc"),
    (Kind::AbbModule, "abb"),
    (Kind::KukaProgram, "kuka"),
    (Kind::UrScript, "ur"),
    (Kind::Profile, "profile"),
    (Kind::ProfileColumns, "profile-columns"),
    (Kind::Yaml, "yaml"),
    (Kind::PosePairs, "pose-pairs"),
    (Kind::RosBag, "ros-bag"),
];

const SEPARATORS: [(Separator, &str); 4] = [
    (Separator::Comma, "comma"),
    (Separator::Semicolon, "semicolon"),
    (Separator::Tab, "tab"),
    (Separator::Blanks, "blanks"),
];

const FORMS: [(OrientationForm, &str); 3] = [
    (OrientationForm::Angles, "angles"),
    (OrientationForm::QuaternionWxyz, "quaternion-wxyz"),
    (OrientationForm::QuaternionXyzw, "quaternion-xyzw"),
];

const ROLES: [(Role, &str); 25] = [
    (Role::Ignore, "ignore"),
    (Role::Label, "label"),
    (Role::Position(0), "x"),
    (Role::Position(1), "y"),
    (Role::Position(2), "z"),
    (Role::Orientation(0), "orientation-1"),
    (Role::Orientation(1), "orientation-2"),
    (Role::Orientation(2), "orientation-3"),
    (Role::Orientation(3), "orientation-4"),
    (Role::Point(0), "point-x"),
    (Role::Point(1), "point-y"),
    (Role::Point(2), "point-z"),
    (Role::Target(0), "target-x"),
    (Role::Target(1), "target-y"),
    (Role::Target(2), "target-z"),
    (Role::Target(3), "target-orientation-1"),
    (Role::Target(4), "target-orientation-2"),
    (Role::Target(5), "target-orientation-3"),
    (Role::Target(6), "target-orientation-4"),
    (Role::Side, "side"),
    (Role::Edge, "edge"),
    (Role::Used, "used"),
    (Role::Step, "step"),
    (Role::Profile, "profile"),
    (Role::Notation, "notation"),
];

const TAKINGS: [(Taking, &str); 3] =
    [(Taking::SettledMedian, "stays"), (Taking::SettledFirst, "first-of-stays"), (Taking::EveryProfile, "every")];

fn name_of<T: Copy + PartialEq>(names: &[(T, &'static str)], value: T) -> &'static str {
    names.iter().find(|(known, _)| *known == value).map_or("", |(_, name)| name)
}

fn named<T: Copy>(names: &[(T, &'static str)], name: &str) -> Option<T> {
    names.iter().find(|(_, known)| *known == name).map(|(value, _)| *value)
}

impl Settings {
    fn of(options: &ImportOptions) -> Self {
        Self {
            kind: options.kind.map(|kind| name_of(&KINDS, kind).to_owned()),
            separator: options.separator.map(|separator| name_of(&SEPARATORS, separator).to_owned()),
            decimal_comma: options.decimal_comma,
            has_header: options.has_header,
            roles: (options.roles.as_ref())
                .map(|roles| roles.iter().map(|role| name_of(&ROLES, *role).to_owned()).collect()),
            notation: options.notation.as_ref().map(Notation::of),
            base_from_user_frame: options.base_from_user_frame,
            profiles_in_metres: options.profile_length_unit.map(|unit| unit == LengthUnit::Metres),
            is_z_mirrored: options.is_z_mirrored,
            bag: (options.bag != BagOptions::default()).then(|| BagSettings::of(&options.bag)),
        }
    }

    /// What this version does not know is left to recognition.
    fn options(&self) -> ImportOptions {
        ImportOptions {
            kind: self.kind.as_deref().and_then(|name| named(&KINDS, name)),
            separator: self.separator.as_deref().and_then(|name| named(&SEPARATORS, name)),
            decimal_comma: self.decimal_comma,
            has_header: self.has_header,
            roles: (self.roles.as_ref())
                .map(|names| names.iter().map(|name| named(&ROLES, name).unwrap_or(Role::Ignore)).collect()),
            notation: self.notation.as_ref().and_then(Notation::notation),
            base_from_user_frame: self.base_from_user_frame.filter(|numbers| numbers.iter().all(|v| v.is_finite())),
            profile_length_unit: self
                .profiles_in_metres
                .map(|in_metres| if in_metres { LengthUnit::Metres } else { LengthUnit::Millimetres }),
            is_z_mirrored: self.is_z_mirrored,
            bag: self.bag.as_ref().map(BagSettings::options).unwrap_or_default(),
        }
    }
}

impl BagSettings {
    fn of(bag: &BagOptions) -> Self {
        Self {
            pose_topic: bag.pose_topic.clone(),
            profile_topic: bag.profile_topic.clone(),
            base_frame: bag.base_frame.clone(),
            flange_frame: bag.flange_frame.clone(),
            axes: bag.axes.map(|axes| axes.to_string()),
            is_recording_time: bag.clock == Clock::Recording,
            taking: bag.taking.map(|taking| name_of(&TAKINGS, taking).to_owned()),
            pair_within_ms: Some(bag.pair_within_ms),
            still_for_s: Some(bag.still_for_s),
            still_within_mm: Some(bag.still_within_mm),
            still_within_deg: Some(bag.still_within_deg),
            has_separate_stays: !bag.joins_stays,
        }
    }

    fn options(&self) -> BagOptions {
        let usual = BagOptions::default();
        let number = |value: Option<f64>, usual: f64| value.filter(|v| v.is_finite() && *v >= 0.0).unwrap_or(usual);
        BagOptions {
            pose_topic: self.pose_topic.clone(),
            profile_topic: self.profile_topic.clone(),
            base_frame: self.base_frame.clone(),
            flange_frame: self.flange_frame.clone(),
            axes: self.axes.as_deref().and_then(|axes| axes.parse().ok()),
            clock: if self.is_recording_time { Clock::Recording } else { Clock::Header },
            taking: self.taking.as_deref().and_then(|name| named(&TAKINGS, name)),
            pair_within_ms: number(self.pair_within_ms, usual.pair_within_ms),
            still_for_s: number(self.still_for_s, usual.still_for_s),
            still_within_mm: number(self.still_within_mm, usual.still_within_mm),
            still_within_deg: number(self.still_within_deg, usual.still_within_deg),
            joins_stays: !self.has_separate_stays,
        }
    }
}

impl Notation {
    fn of(notation: &PoseNotation) -> Self {
        Self {
            convention: notation.convention.id.to_owned(),
            orientation: name_of(&FORMS, notation.orientation).to_owned(),
            is_in_radians: notation.angle_unit == AngleUnit::Radians,
            is_in_metres: notation.length_unit == LengthUnit::Metres,
            flange_from_tcp: notation.flange_from_tcp.as_ref().map(|flange_from_tcp| Frame {
                translation_mm: flange_from_tcp.translation_mm().into(),
                quaternion_wxyz: flange_from_tcp.quaternion_wxyz(),
            }),
            is_inverse: notation.is_inverse,
        }
    }

    fn notation(&self) -> Option<PoseNotation> {
        Some(PoseNotation {
            convention: PoseConvention::by_id(&self.convention)?,
            orientation: named(&FORMS, &self.orientation)?,
            angle_unit: if self.is_in_radians { AngleUnit::Radians } else { AngleUnit::Degrees },
            length_unit: if self.is_in_metres { LengthUnit::Metres } else { LengthUnit::Millimetres },
            flange_from_tcp: match &self.flange_from_tcp {
                Some(frame) => Some(frame.transform()?),
                None => None,
            },
            is_inverse: self.is_inverse,
        })
    }
}

impl Frame {
    fn transform(&self) -> Option<Transform<Flange, Tcp>> {
        let [w, x, y, z] = self.quaternion_wxyz;
        let quaternion = nalgebra::Quaternion::new(w, x, y, z);
        let is_usable = self.translation_mm.iter().all(|v| v.is_finite()) && (quaternion.norm() - 1.0).abs() < 1e-3;
        is_usable.then(|| {
            let rotation = nalgebra::UnitQuaternion::new_normalize(quaternion);
            Transform::from_parts(Vec3::from(self.translation_mm), rotation)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::so3;

    fn form(header: &[&str]) -> Form {
        Form { kind: "pose-table".to_owned(), header: header.iter().map(|&name| name.to_owned()).collect() }
    }

    fn all_set() -> ImportOptions {
        ImportOptions {
            kind: Some(Kind::PoseTable),
            separator: Some(Separator::Semicolon),
            decimal_comma: Some(true),
            has_header: Some(false),
            roles: Some(ROLES.iter().map(|(role, _)| *role).collect()),
            notation: Some(PoseNotation {
                convention: PoseConvention::by_id("kuka-abc").expect("known"),
                orientation: OrientationForm::QuaternionXyzw,
                angle_unit: AngleUnit::Radians,
                length_unit: LengthUnit::Metres,
                flange_from_tcp: Some(Transform::from_parts(
                    Vec3::new(1.5, -2.0, 150.25),
                    so3::exp(Vec3::new(0.1, -0.2, 3.0)),
                )),
                is_inverse: true,
            }),
            base_from_user_frame: Some([1.0, 2.0, 3.0, 4.0, 5.0, 6.0]),
            profile_length_unit: Some(LengthUnit::Metres),
            is_z_mirrored: true,
            bag: BagOptions {
                pose_topic: Some("/pose".to_owned()),
                profile_topic: Some("/scan".to_owned()),
                base_frame: Some("base".to_owned()),
                flange_frame: Some("flange".to_owned()),
                axes: "y,-x".parse().ok(),
                clock: Clock::Recording,
                pair_within_ms: 12.5,
                taking: Some(Taking::SettledFirst),
                still_for_s: 0.25,
                still_within_mm: 0.1,
                still_within_deg: 0.05,
                joins_stays: false,
            },
        }
    }

    #[test]
    fn what_was_set_comes_back_for_the_same_columns_only_and_from_storage_too() {
        let mut memory = ImportMemory::default();
        memory.remember(&form(&["x", "y"]), &all_set());
        let stored = serde_json::to_string(&memory).expect("plain values");
        let again: ImportMemory = serde_json::from_str(&stored).expect("as written");
        assert_eq!(again, memory);
        let recalled = again.recall(&form(&["x", "y"])).expect("remembered");
        let (was, is) = (all_set(), recalled);
        let tcp =
            |options: &ImportOptions| options.notation.and_then(|notation| notation.flange_from_tcp).expect("set");
        // A quaternion is normalised anew, which may cost the last bit.
        assert!((tcp(&was).translation_mm() - tcp(&is).translation_mm()).norm() < 1e-12);
        assert!(tcp(&was).rotation().angle_to(&tcp(&is).rotation()) < 1e-12);
        let without_tcp = |options: ImportOptions| ImportOptions {
            notation: options.notation.map(|notation| PoseNotation { flange_from_tcp: None, ..notation }),
            ..options
        };
        assert_eq!(without_tcp(was), without_tcp(is));
        assert_eq!(again.recall(&form(&["x", "z"])), None);
    }

    #[test]
    fn the_tool_and_frame_of_one_program_are_not_those_of_the_next() {
        let mut memory = ImportMemory::default();
        let form = Form { kind: "fanuc".to_owned(), header: Vec::new() };
        memory.remember(&form, &all_set());
        let recalled = memory.recall(&form).expect("remembered");
        assert_eq!((recalled.notation, recalled.base_from_user_frame), (None, None));
    }

    #[test]
    fn names_that_are_not_known_are_left_to_recognition() {
        let stored = r#"{"forms":[{"form":{"kind":"pose-table","header":[]},"settings":{"kind":"of-tomorrow",
            "roles":["x","of-tomorrow"],"notation":{"convention":"of-tomorrow"},"something":1}}],"something":2}"#;
        let memory: ImportMemory = serde_json::from_str(stored).expect("tolerant");
        let options = memory.recall(&form(&[])).expect("remembered");
        let expected = ImportOptions { roles: Some(vec![Role::Position(0), Role::Ignore]), ..ImportOptions::default() };
        assert_eq!(options, expected);
    }

    #[test]
    fn nothing_set_is_forgotten_and_old_forms_make_room() {
        let mut memory = ImportMemory::default();
        for idx in 0..=MAX_FORMS {
            memory.remember(&form(&[&idx.to_string()]), &all_set());
        }
        assert_eq!(memory.forms.len(), MAX_FORMS);
        assert_eq!(memory.recall(&form(&["0"])), None);
        memory.remember(&form(&["5"]), &ImportOptions::default());
        assert_eq!(memory.recall(&form(&["5"])), None);
    }
}
