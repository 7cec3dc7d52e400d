//! A scanned part: its cloud, regions, planes, teeth and diameters.

mod colors;
mod planes;
mod shapes;

use std::cell::Cell;

use egui::{Align, ComboBox, Layout, ProgressBar, Ui};

use crate::app::Command;
use crate::app::workbench::scans::{ExaminedScan, RegionChoice, ScanCalibration, ScanCommand};
use crate::calibrate::best_available;
use crate::report::calibration_file::NamedCalibration;
use crate::session::{Session, Target};
use crate::text::verify::calibration_name;
use crate::text::workpiece::{self as words, ScanChoice};
use crate::ui::actions::Action;
use crate::ui::cloud::{CloudScene, CloudView, Tool};
use crate::ui::save_picture::saveable;
use crate::ui::{PanelContext, theme, widgets};
use crate::verify::Origin;

use colors::{ColorBy, Colors};

/// Least and greatest height of the picture of the points.
const PICTURE_HEIGHTS: [f32; 2] = [300.0, 620.0];
/// Height of the planes and their distances.
const PLANES_HEIGHT: f32 = 264.0;
/// Height of the teeth and the diameter.
const SHAPES_HEIGHT: f32 = 216.0;

/// What the tools of the picture take of its header.
const TOOLS_WIDTH: f32 = 580.0;
/// Width from which all controls have room in one row.
const ONE_ROW_FROM: f32 = 720.0;

/// What the section remembers between frames.
#[derive(Debug, Default)]
pub(super) struct WorkpieceState {
    view: CloudView,
    tool: Tool,
    color_by: ColorBy,
    colors: Option<Colors>,
    /// The revision and the names of its scans, so that no frame goes through all captures.
    scans: Option<(u64, Vec<String>)>,
    planes: planes::PlanesState,
}

/// Shows the section.
pub(super) fn show(ui: &mut Ui, context: &mut PanelContext<'_>, state: &mut WorkpieceState) {
    let Some(document) = context.workbench.document() else { return };
    if state.scans.as_ref().is_none_or(|(revision, _)| *revision != document.revision) {
        let names = document.session.scans().iter().map(words::scan_name).collect();
        state.scans = Some((document.revision, names));
    }
    let names = state.scans.as_ref().map(|(_, names)| names.clone()).unwrap_or_default();
    let scans = context.workbench.scans();
    if names.is_empty() && scans.examined().is_none() {
        empty(ui, context);
        return;
    }
    keep_up(context, &names);
    let height = ui.available_height();
    controls(ui, context, &names);
    if let Some(failure) = scans.failure() {
        ui.add_space(4.0);
        ui.horizontal(|ui| {
            ui.label(theme::strong("✖").color(theme::palette(ui).bad));
            if ui.button(words::EXAMINE_AGAIN).clicked() {
                let (scan_idx, calibration) =
                    scans.chosen().cloned().unwrap_or_else(|| (0, default_calibration(context)));
                ask(context, ScanCommand::Examine { scan_idx, calibration });
            }
            ui.add(egui::Label::new(&failure.reason).wrap());
        });
    }
    let Some(scan) = scans.examined() else {
        if scans.is_working() {
            widgets::nothing(ui, words::EXAMINING);
        }
        return;
    };
    let has_shapes = scan.shapes.teeth.is_some() || scan.shapes.round.is_some();
    let below = PLANES_HEIGHT + theme::GAP + if has_shapes { SHAPES_HEIGHT + theme::GAP } else { 0.0 };
    let picture_height = (height - below - 48.0).clamp(PICTURE_HEIGHTS[0], PICTURE_HEIGHTS[1]);
    picture(ui, context, scan, picture_height, state);
    planes::show(ui, context, scan, PLANES_HEIGHT, &mut state.planes);
    if has_shapes {
        shapes::show(ui, scan, SHAPES_HEIGHT);
    }
}

fn ask(context: &mut PanelContext<'_>, command: ScanCommand) {
    context.commands.push(Command::Scan(Box::new(command)));
}

/// What leads here.
fn empty(ui: &mut Ui, context: &mut PanelContext<'_>) {
    ui.vertical_centered(|ui| {
        ui.add_space((ui.available_height() * 0.3).min(180.0));
        ui.label(theme::heading(words::NO_SCAN_TITLE));
        ui.add_space(8.0);
        ui.label(theme::dim(ui, words::NO_SCAN_HINT));
        ui.add_space(4.0);
        ui.label(theme::dim(ui, words::NO_SCAN_COMMANDS).monospace());
        ui.add_space(16.0);
        if context.workbench.scans().is_working() {
            ui.label(theme::dim(ui, words::EXAMINING));
        } else if ui.button(words::OPEN_POINTS).on_hover_text(words::OPEN_POINTS_HINT).clicked() {
            context.actions.push(Action::OpenPoints);
        }
    });
}

/// The scan on the bench follows the document: examined when first seen, and again after edits.
fn keep_up(context: &mut PanelContext<'_>, names: &[String]) {
    let workbench = context.workbench;
    let scans = workbench.scans();
    let is_solving = workbench.solve_progress().is_some();
    if names.is_empty() || scans.is_working() || is_solving {
        return;
    }
    let is_known = scans.examined().is_some_and(|scan| scan.scan_idx.is_none() || workbench.is_current(scan.revision))
        || scans.failure().is_some_and(|failure| workbench.is_current(failure.revision));
    if is_known {
        return;
    }
    let (scan_idx, calibration) = scans.chosen().cloned().unwrap_or_else(|| (0, default_calibration(context)));
    ask(context, ScanCommand::Examine { scan_idx: scan_idx.min(names.len() - 1), calibration });
}

/// The best result where there is any; the truth only where nothing else is to be had.
fn default_calibration(context: &PanelContext<'_>) -> ScanCalibration {
    let has_best = context.workbench.results().is_some_and(|results| best_available(&results.methods).is_some());
    let session = context.workbench.document().map(|document| &document.session);
    match session {
        Some(session) if !has_best && session.truth.is_some() && !has_other_target(session) => ScanCalibration::Truth,
        _ => ScanCalibration::Best,
    }
}

/// Whether any target of the session is one that a calibration is computed from.
fn has_other_target(session: &Session) -> bool {
    let targets = std::iter::once(&session.target).chain(session.further.iter().map(|further| &further.target));
    targets.into_iter().any(|target| matches!(target, Target::Ball { .. } | Target::RightAnglePlate | Target::Point))
}

/// The row above the picture: which scan, through what, and what is done with the points.
fn controls(ui: &mut Ui, context: &mut PanelContext<'_>, names: &[String]) {
    let workbench = context.workbench;
    let scans = workbench.scans();
    let chosen = scans.chosen().cloned();
    let is_narrow = ui.available_width() < ONE_ROW_FROM;
    ui.horizontal(|ui| {
        if !names.is_empty() {
            let scan_idx = chosen.as_ref().map_or(0, |(scan_idx, _)| *scan_idx);
            let current = chosen.as_ref().map_or(ScanCalibration::Best, |(_, calibration)| calibration.clone());
            ui.label(theme::dim(ui, words::SCAN));
            let mut wanted = scan_idx;
            let shown = names.get(scan_idx).cloned().unwrap_or_default();
            let combo = ComboBox::from_id_salt("scan").width(150.0).selected_text(shown).show_ui(ui, |ui| {
                for (idx, name) in names.iter().enumerate() {
                    ui.selectable_value(&mut wanted, idx, name);
                }
            });
            combo.response.on_hover_text(words::SCAN_HINT);
            if wanted != scan_idx {
                ask(context, ScanCommand::Examine { scan_idx: wanted, calibration: current.clone() });
            }
            ui.add_space(8.0);
            ui.label(theme::dim(ui, words::CALIBRATION));
            let mut through = current.clone();
            let combo = ComboBox::from_id_salt("scan calibration").width(190.0);
            combo.selected_text(name_of(&current)).show_ui(ui, |ui| {
                for choice in calibrations(context) {
                    let name = name_of(&choice);
                    ui.selectable_value(&mut through, choice, name);
                }
                if ui.button(words::CHOOSE_CALIBRATION).clicked() {
                    context.actions.push(Action::ChooseCalibration);
                }
            });
            if through != current {
                ask(context, ScanCommand::Examine { scan_idx, calibration: through });
            }
        }
        if !is_narrow {
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| file_buttons(ui, context));
        }
    });
    if is_narrow {
        ui.horizontal(|ui| file_buttons(ui, context));
    }
}

/// What is done with points and files; from the right to the left where there is room.
fn file_buttons(ui: &mut Ui, context: &mut PanelContext<'_>) {
    let scans = context.workbench.scans();
    if let Some(progress) = scans.export_progress() {
        if ui.button(words::CANCEL).clicked() {
            ask(context, ScanCommand::Cancel);
        }
        ui.add(ProgressBar::new(progress.fraction()).desired_width(110.0).text(words::EXPORTING));
    } else {
        let export = ui.add_enabled(scans.examined().is_some(), egui::Button::new(words::EXPORT_POINTS));
        if export.on_hover_text(words::EXPORT_POINTS_HINT).clicked() {
            context.actions.push(Action::ExportPoints);
        }
    }
    if ui.button(words::OPEN_POINTS).on_hover_text(words::OPEN_POINTS_HINT).clicked() {
        context.actions.push(Action::OpenPoints);
    }
    if scans.is_working() {
        if ui.button(words::CANCEL).clicked() {
            ask(context, ScanCommand::Cancel);
        }
        ui.label(theme::dim(ui, words::EXAMINING));
    }
}

fn name_of(calibration: &ScanCalibration) -> String {
    let file_name;
    words::calibration_name(&match calibration {
        ScanCalibration::Best => ScanChoice::Best,
        ScanCalibration::Of(method) => ScanChoice::Of(*method),
        ScanCalibration::Truth => ScanChoice::Truth,
        ScanCalibration::Verified(named) => ScanChoice::File(&named.name),
        ScanCalibration::File(path) => {
            file_name = path.file_name().unwrap_or_default().to_string_lossy();
            ScanChoice::File(&file_name)
        }
    })
}

fn calibrations(context: &PanelContext<'_>) -> Vec<ScanCalibration> {
    let workbench = context.workbench;
    let mut choices = vec![ScanCalibration::Best];
    let results = workbench.results().map(|results| results.methods.as_slice()).unwrap_or_default();
    let solved = results.iter().filter(|result| result.outcome.is_ok());
    choices.extend(solved.map(|result| ScanCalibration::Of(result.method)));
    if let Some(found) = workbench.verification().last().map(|found| &found.value) {
        let others =
            found.calibrations.iter().filter(|known| !matches!(known.origin, Origin::Solved { target_idx: 0, .. }));
        choices.extend(others.map(|known| {
            let name = calibration_name(&known.origin, found);
            ScanCalibration::Verified(NamedCalibration { name, flange_from_sensor: known.flange_from_sensor })
        }));
    }
    if workbench.document().is_some_and(|document| document.session.truth.is_some()) {
        choices.push(ScanCalibration::Truth);
    }
    if let Some((_, file @ ScanCalibration::File(_))) = workbench.scans().chosen() {
        choices.push(file.clone());
    }
    choices
}

/// The card with the points.
fn picture(ui: &mut Ui, context: &mut PanelContext<'_>, scan: &ExaminedScan, height: f32, state: &mut WorkpieceState) {
    let WorkpieceState { view, tool, color_by, colors, .. } = state;
    // The header's buttons are drawn first, and the picture already follows them.
    let (look_along, by, with) = (Cell::new(None), Cell::new(*color_by), Cell::new(*tool));
    // In a narrow window the tools take the room of the title and of the words before them; the picture says how many points.
    // With no title at all there would be no row for the tools.
    let is_narrow = ui.available_width() < ONE_ROW_FROM;
    let room = ui.available_width() - TOOLS_WIDTH;
    let fits = |title: &String| {
        let galley = ui.painter().layout_no_wrap(title.clone(), theme::strong_font(), egui::Color32::WHITE);
        galley.size().x <= room
    };
    // The name is in the list of scans as well.
    let picture_name = words::picture_title(&scan.name, scan.cloud.len(), scan.num_profiles);
    let whole = picture_name.clone();
    let short = words::num_points(scan.cloud.len(), scan.num_profiles);
    let title = [whole, short].into_iter().find(|title| !is_narrow && fits(title)).unwrap_or_else(|| " ".to_owned());
    let answer = widgets::card_with_height(
        ui,
        &title,
        height,
        |ui| {
            for (axis, name) in [(0, "x"), (1, "y"), (2, "z")].into_iter().rev() {
                if widgets::symbol_button(ui, name, &words::look_along(name)).clicked() {
                    look_along.set(Some(axis));
                }
            }
            if !is_narrow {
                ui.label(theme::dim(ui, words::LOOK_ALONG));
            }
            ui.add_space(8.0);
            for (choice, name) in ColorBy::ALL.into_iter().rev() {
                if ui.selectable_label(by.get() == choice, name).clicked() {
                    by.set(choice);
                }
            }
            if !is_narrow {
                ui.label(theme::dim(ui, words::COLOR_BY));
            }
            ui.add_space(8.0);
            for (choice, name, hint) in [
                (Tool::Rectangle, words::TOOL_RECTANGLE, words::TOOL_RECTANGLE_HINT),
                (Tool::Point, words::TOOL_POINT, words::TOOL_POINT_HINT),
                (Tool::Turn, words::TOOL_TURN, words::TOOL_TURN_HINT),
            ] {
                if ui.selectable_label(with.get() == choice, name).on_hover_text(hint).clicked() {
                    with.set(choice);
                }
            }
        },
        |ui| {
            let colors = match colors {
                Some(known) if known.is_of(scan, by.get(), ui.visuals().dark_mode) => known,
                _ => colors.insert(Colors::new(scan, by.get(), ui.visuals().dark_mode)),
            };
            if let Some(axis) = look_along.get() {
                view.look_along(axis, ui.available_size());
            }
            let color_of = |idx: usize| colors.of(scan, idx);
            let scene = CloudScene {
                name: words::CLOUD,
                cloud_key: scan.id,
                color_key: colors.key(),
                cloud: &scan.cloud,
                color_of: &color_of,
                legend: Some(colors.legend(scan)),
                tool: with.get(),
            };
            saveable(ui, &picture_name, |ui| view.show(ui, &scene))
        },
    );
    *color_by = by.get();
    *tool = with.get();
    if let Some(seed_mm) = answer.picked_mm {
        ask(context, ScanCommand::AddRegion(RegionChoice::Plane(seed_mm)));
    }
    if let Some((right, down, corners)) = answer.rectangle {
        ask(context, ScanCommand::AddRegion(RegionChoice::Rectangle(right, down, corners)));
    }
}
