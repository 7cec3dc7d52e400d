//! The preview's left side: what was read, and how.

use egui::{Label, ScrollArea, Ui};

use crate::app::ImportDraft;
use crate::geometry::notation::{AngleUnit, LengthUnit, OrientationForm};
use crate::geometry::{PoseConvention, PoseNotation};
use crate::session::import::{ImportError, ImportOptions, Imported, Kind, Separator, Source};
use crate::text::import as words;
use crate::ui::theme;

use super::fields::{self, SixNumbers};
use super::{bag, model};

/// Sources that are listed before the list scrolls.
const MAX_SOURCES_HEIGHT: f32 = 132.0;

const LENGTH_UNITS: [LengthUnit; 2] = [LengthUnit::Millimetres, LengthUnit::Metres];

/// Numbers being typed.
#[derive(Debug, Default)]
pub struct Typed {
    tool_point: SixNumbers,
    user_frame: SixNumbers,
    bag: bag::Typed,
}

/// Draws the settings; answers the options with what the user has changed.
pub fn show(ui: &mut Ui, draft: &ImportDraft, typed: &mut Typed) -> Option<ImportOptions> {
    let imported = draft.outcome.as_ref().and_then(|outcome| outcome.as_deref().ok());
    let mut changed = None;
    ui.label(theme::strong(words::SOURCES));
    sources(ui, draft, imported);
    if imported.is_some_and(|imported| imported.session.is_some()) {
        return None;
    }
    // What was recognised where nothing is set.
    let current = imported.map_or(&draft.options, |imported| &imported.options);
    let mut set = |change: &dyn Fn(&mut ImportOptions)| {
        let mut options = draft.options.clone();
        change(&mut options);
        changed = Some(options);
    };
    let shown = draft.sources.iter().find_map(Source::bag);
    match shown {
        Some(bag) => bag::show(ui, bag, imported, current, &mut typed.bag, &mut set),
        None => text(ui, imported, current, &mut set),
    }
    let is_unknown = matches!(draft.outcome, Some(Err(ImportError::NotRecognised { .. })));
    if is_unknown && draft.options.kind.is_none() {
        return changed;
    }
    if imported.is_none_or(model::may_have_poses) {
        poses(ui, current, typed, &mut set);
    }
    if imported.is_none_or(model::has_profiles) {
        profiles(ui, current, &mut set);
    }
    changed
}

pub(super) type Set<'a> = &'a mut dyn FnMut(&dyn Fn(&mut ImportOptions));

fn sources(ui: &mut Ui, draft: &ImportDraft, imported: Option<&Imported>) {
    ScrollArea::vertical().id_salt("import sources").max_height(MAX_SOURCES_HEIGHT).show(ui, |ui| {
        ui.set_width(ui.available_width());
        let row = |ui: &mut Ui, name: &str, gave: &str| {
            ui.spacing_mut().item_spacing.y = 0.0;
            ui.add(Label::new(name).truncate()).on_hover_text(name);
            ui.add(Label::new(theme::dim(ui, gave).small()).truncate());
            ui.add_space(4.0);
        };
        match imported {
            Some(imported) => imported.parts.iter().for_each(|part| row(ui, &part.name, &words::part(part))),
            None => draft.sources.iter().for_each(|source| row(ui, &source.name, "")),
        }
    });
}

fn text(ui: &mut Ui, imported: Option<&Imported>, current: &ImportOptions, set: Set<'_>) {
    fields::heading(ui, words::TEXT);
    let kinds: Vec<Option<Kind>> = words::FORMS.iter().map(|(kind, _)| Some(*kind)).collect();
    let kind = current.kind.or_else(|| imported.and_then(|imported| imported.parts.first().map(|part| part.kind)));
    let named = |kind: Option<Kind>| kind.map_or("not recognised", words::kind).to_owned();
    if let Some(kind) = fields::row_choice(ui, words::FORM, kind, &kinds, named) {
        // What was said of columns was said of another form.
        set(&|options| {
            *options = ImportOptions { kind, notation: options.notation, ..ImportOptions::default() };
        });
    }
    if !kind.is_some_and(model::has_columns) {
        return;
    }
    let separators = [Separator::Comma, Separator::Semicolon, Separator::Tab, Separator::Blanks].map(Some);
    let named = |separator: Option<Separator>| separator.map_or(String::new(), |s| words::separator(s).to_owned());
    let picked = fields::row_choice(ui, words::SEPARATOR, current.separator, &separators, named);
    if let Some(separator) = picked {
        set(&|options| (options.separator, options.roles) = (separator, None));
    }
    let named = |comma: bool| if comma { words::DECIMAL_COMMA } else { words::DECIMAL_POINT }.to_owned();
    let comma = current.decimal_comma.unwrap_or(false);
    let picked = fields::row_choice(ui, words::DECIMAL, comma, &[false, true], named);
    if let Some(comma) = picked {
        set(&|options| options.decimal_comma = Some(comma));
    }
    let named = |header: bool| if header { words::HEADER_NAMES } else { words::HEADER_POSE }.to_owned();
    let header = current.has_header.unwrap_or(false);
    let picked = fields::row_choice(ui, words::HEADER, header, &[true, false], named);
    if let Some(header) = picked {
        set(&|options| options.has_header = Some(header));
    }
}

fn poses(ui: &mut Ui, current: &ImportOptions, typed: &mut Typed, set: Set<'_>) {
    fields::heading(ui, words::POSES);
    let notation = current.notation.unwrap_or_default();
    let mut set_notation = |changed: PoseNotation| {
        set(&|options| {
            // Four numbers do not go where three were.
            if changed.num_numbers() != notation.num_numbers() {
                options.roles = None;
            }
            options.notation = Some(changed);
        });
    };
    let unit = |unit| words::length_unit(unit).to_owned();
    let picked = fields::row_choice(ui, words::POSITION_UNIT, notation.length_unit, &LENGTH_UNITS, unit);
    if let Some(length_unit) = picked {
        set_notation(PoseNotation { length_unit, ..notation });
    }
    if let Some(changed) = fields::row(ui, words::ORIENTATION, |ui| orientation(ui, &notation)) {
        set_notation(changed);
    }
    fields::remark(ui, &words::orientation_meaning(&notation));
    if notation.orientation == OrientationForm::Angles {
        let named = |unit| match unit {
            AngleUnit::Degrees => words::DEGREES.to_owned(),
            AngleUnit::Radians => words::RADIANS.to_owned(),
        };
        let units = [AngleUnit::Degrees, AngleUnit::Radians];
        let picked = fields::row_choice(ui, words::ANGLE_UNIT, notation.angle_unit, &units, named);
        if let Some(angle_unit) = picked {
            set_notation(PoseNotation { angle_unit, ..notation });
        }
    }
    if let Some(changed) = tool_point(ui, &notation, typed) {
        set_notation(changed);
    }
    let mut is_inverse = notation.is_inverse;
    user_frame(ui, current, &notation, typed, set);
    if ui.checkbox(&mut is_inverse, words::INVERSE).changed() {
        set(&|options| options.notation = Some(PoseNotation { is_inverse, ..notation }));
    }
}

fn orientation(ui: &mut Ui, notation: &PoseNotation) -> Option<PoseNotation> {
    let text = words::orientation_form(notation.orientation, notation.convention.label);
    let width = ui.available_width();
    fields::list(ui, &words::setting(words::ORIENTATION), text, width, |ui| {
        let mut picked = None;
        let mut entry = |ui: &mut Ui, choice: PoseNotation| {
            let is_current = choice == *notation;
            let text = words::orientation_form(choice.orientation, choice.convention.label);
            if ui.selectable_label(is_current, text).clicked() && !is_current {
                picked = Some(choice);
            }
        };
        ui.label(theme::dim(ui, words::QUATERNIONS).small());
        for orientation in [OrientationForm::QuaternionWxyz, OrientationForm::QuaternionXyzw] {
            entry(ui, PoseNotation { orientation, ..*notation });
        }
        ui.separator();
        ui.label(theme::dim(ui, words::MAKERS).small());
        for convention in PoseConvention::all() {
            entry(ui, PoseNotation { convention, orientation: OrientationForm::Angles, ..*notation });
        }
        picked
    })
}

fn tool_point(ui: &mut Ui, notation: &PoseNotation, typed: &mut Typed) -> Option<PoseNotation> {
    let is_tcp = notation.flange_from_tcp.is_some();
    let named = |is_tcp: bool| if is_tcp { words::TOOL_POINT } else { words::FLANGE }.to_owned();
    let convention = notation.convention;
    let picked = fields::row_choice(ui, words::POSE_OF, is_tcp, &[false, true], named);
    let numbers = match (picked, &notation.flange_from_tcp) {
        (Some(false), _) => return Some(PoseNotation { flange_from_tcp: None, ..*notation }),
        (Some(true), _) => [0.0; 6],
        (None, None) => return None,
        (None, Some(flange_from_tcp)) => {
            let names = frame_names(&PoseNotation::of(convention));
            ui.label(theme::dim(ui, words::TOOL_POINT_IN_FLANGE).small());
            let values = model::tool_point_numbers(flange_from_tcp, convention);
            let frame = |number: &str| words::frame_number(words::TOOL_POINT_IN_FLANGE, number);
            typed.tool_point.show(ui, &names, frame, values)?
        }
    };
    Some(PoseNotation { flange_from_tcp: model::tool_point(&numbers, convention), ..*notation })
}

fn user_frame(ui: &mut Ui, current: &ImportOptions, notation: &PoseNotation, typed: &mut Typed, set: Set<'_>) {
    let named = |is_user: bool| if is_user { words::USER_FRAME } else { words::ROBOT_BASE }.to_owned();
    let is_user = current.base_from_user_frame.is_some();
    let picked = fields::row_choice(ui, words::POSE_IN, is_user, &[false, true], named);
    if let Some(is_user) = picked {
        set(&|options| options.base_from_user_frame = is_user.then_some([0.0; 6]));
    }
    let Some(values) = current.base_from_user_frame else { return };
    ui.label(theme::dim(ui, words::USER_FRAME_IN_BASE).small());
    let names = frame_names(&PoseNotation { orientation: OrientationForm::Angles, ..*notation });
    let frame = |number: &str| words::frame_number(words::USER_FRAME_IN_BASE, number);
    if let Some(numbers) = typed.user_frame.show(ui, &names, frame, values) {
        set(&|options| options.base_from_user_frame = Some(numbers));
    }
}

/// The names of a frame's six numbers, with units.
fn frame_names(notation: &PoseNotation) -> [String; 6] {
    std::array::from_fn(|idx| match idx {
        0..3 => format!("{} / {}", ["x", "y", "z"][idx], notation.length_unit.symbol()),
        _ => words::orientation_number(idx - 3, notation),
    })
}

fn profiles(ui: &mut Ui, current: &ImportOptions, set: Set<'_>) {
    fields::heading(ui, words::PROFILES);
    let unit = current.profile_length_unit.unwrap_or_default();
    let named = |unit| words::length_unit(unit).to_owned();
    let picked = fields::row_choice(ui, words::PROFILE_UNIT, unit, &LENGTH_UNITS, named);
    if let Some(unit) = picked {
        set(&|options| options.profile_length_unit = Some(unit));
    }
    let mut is_mirrored = current.is_z_mirrored;
    if ui.checkbox(&mut is_mirrored, words::MIRROR_Z).changed() {
        set(&|options| options.is_z_mirrored = is_mirrored);
    }
}
