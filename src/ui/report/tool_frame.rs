//! The calibration as text: formats at the left, the text of the chosen one at the right with its convention, what came
//! back when it was read, and the ways to take it along.

use egui::{
    Align, Align2, ComboBox, DragValue, FontFamily, FontId, Frame, Label, Layout, Rect, RichText, Role, ScrollArea,
    Sense, Stroke, TextEdit, TextStyle, Ui, UiBuilder, WidgetInfo, vec2,
};

use crate::app::{Command, NoticeKind};
use crate::calibrate::{Method, Solution};
use crate::geometry::PoseConvention;
use crate::report::tool_frame::{Format, Group, Name, NotThisFormat, Parent, RoundTrip, ToolFrame, formats};
use crate::text::methods::method_name;
use crate::text::report_panel as panel_words;
use crate::text::tool_frame as words;
use crate::text::typeset::std_text;
use crate::ui::file_dialog::Purpose;
use crate::ui::save_file::{self, SaveFile};
use crate::ui::widgets::{self, FromTop, fixed, name_field};
use crate::ui::{PanelContext, theme};

/// Part of the width that the list of formats takes, and its limits, points.
const LIST_PART: f32 = 0.32;
const LIST_WIDTHS: [f32; 2] = [236.0, 320.0];
/// Longest name that every format takes.
const LONGEST_NAME: usize = 16;
/// Room for the line below the text, points.
const ROUND_TRIP_HEIGHT: f32 = 32.0;
/// Width from which all that is chosen has room in one row, points.
const ONE_ROW_FROM: f32 = 800.0;
/// Size of the text that is taken along, points.
const TEXT_SIZE: f32 = 12.0;

/// What is chosen; stays while the step is out of sight.
#[derive(Debug)]
pub(super) struct ToolFrameState {
    /// Until one is chosen, the first for the session's robot.
    format_id: Option<&'static str>,
    filter: String,
    name: String,
    number: u8,
    list: FromTop,
}

impl Default for ToolFrameState {
    fn default() -> Self {
        Self {
            format_id: None,
            filter: String::new(),
            name: words::DEFAULT_NAME.to_owned(),
            number: 1,
            list: FromTop::default(),
        }
    }
}

/// What is shown and may be taken along.
struct Shown<'a> {
    solution: &'a Solution,
    frame: ToolFrame,
    format: Format,
    text: String,
    trip: Result<RoundTrip, NotThisFormat>,
}

impl<'a> Shown<'a> {
    fn new(state: &ToolFrameState, solution: &'a Solution, own: &PoseConvention) -> Option<Self> {
        let frame = ToolFrame::of_solution(solution, Name::from_words(&state.name), state.number);
        let suits = |format: &Format| format.suits(frame.parent);
        let chosen = state.format_id.and_then(Format::by_id).filter(suits);
        let of_robot = || formats().filter(suits).find(|format| format.is_for_robots_of(own));
        let format = chosen.or_else(of_robot).or_else(|| formats().find(suits))?;
        Some(Self { solution, text: format.write(&frame), trip: format.check(&frame), format, frame })
    }
}

/// Shows the section.
pub(super) fn show(ui: &mut Ui, context: &mut PanelContext<'_>, state: &mut ToolFrameState) {
    let workbench = context.workbench;
    let (Some(document), Some(results)) = (workbench.document(), workbench.results()) else { return };
    let solved: Vec<Method> =
        results.methods.iter().filter(|result| result.outcome.is_ok()).map(|result| result.method).collect();
    let own = document.session.robot.notation.convention;
    let shown_method = solved.iter().find(|method| **method == context.selection.method).or_else(|| solved.first());
    let solution = shown_method.and_then(|method| results.method(*method)?.outcome.as_ref().ok());
    let Some(shown) = solution.and_then(|solution| Shown::new(state, solution, own)) else {
        widgets::nothing(ui, words::NO_CALIBRATION);
        return;
    };
    let area = ui.available_rect_before_wrap();
    let list_width = (area.width() * LIST_PART).clamp(LIST_WIDTHS[0], LIST_WIDTHS[1]);
    let (left, right) = area.split_left_right_at_x(area.left() + list_width);
    format_list(&mut child(ui, left), state, &shown, own);
    text_card(&mut child(ui, right.with_min_x(right.left() + theme::GAP)), context, state, &shown, &solved);
    ui.advance_cursor_after_rect(area);
}

fn child(ui: &mut Ui, rect: Rect) -> Ui {
    ui.new_child(UiBuilder::new().max_rect(rect).layout(Layout::top_down(Align::Min)))
}

fn format_list(ui: &mut Ui, state: &mut ToolFrameState, shown: &Shown<'_>, own: &PoseConvention) {
    let height = ui.available_height();
    widgets::card_with_height(
        ui,
        words::FORMATS,
        height,
        |_| {},
        |ui| {
            ui.spacing_mut().item_spacing.y = 0.0;
            ui.add_space(8.0);
            ui.horizontal(|ui| {
                ui.add_space(theme::GAP);
                let width = ui.available_width() - theme::GAP;
                let field =
                    ui.add(TextEdit::singleline(&mut state.filter).hint_text(words::FILTER).desired_width(width));
                name_field(&field, words::FILTER, &state.filter);
            });
            ui.add_space(4.0);
            let area = state.list.apply(ScrollArea::vertical().id_salt("formats").auto_shrink(false));
            let chosen = area.show(ui, |ui| format_rows(ui, &state.filter, shown, own)).inner;
            state.format_id = chosen.or(state.format_id);
        },
    );
}

/// The rows of the list by groups. Answers the one that was clicked.
fn format_rows(ui: &mut Ui, filter: &str, shown: &Shown<'_>, own: &PoseConvention) -> Option<&'static str> {
    let parent = shown.frame.parent;
    let wanted = filter.trim().to_lowercase();
    let is_wanted = |format: &Format| {
        format.suits(parent) && (format.label.to_lowercase().contains(&wanted) || format.id.contains(&wanted))
    };
    if parent == Parent::Base {
        ui.add_space(4.0);
        inset(ui, |ui| ui.add(Label::new(theme::dim(ui, words::NO_TOOL).size(theme::SMALL_SIZE)).wrap()));
    }
    let mut chosen = None;
    let mut is_empty = true;
    for (group, heading) in [
        (None, words::OWN_ROBOT),
        (Some(Group::Controller), words::CONTROLLERS),
        (Some(Group::Ros), words::ROS),
        (Some(Group::Program), words::PROGRAMS),
        (Some(Group::Pendant), words::PENDANTS),
    ] {
        let is_of_group = |format: &Format| {
            let is_own = format.is_for_robots_of(own);
            group.map_or(is_own, |group| !is_own && format.group == group)
        };
        let mut of_group = formats().filter(is_of_group).filter(is_wanted).peekable();
        if of_group.peek().is_none() {
            continue;
        }
        is_empty = false;
        ui.add_space(8.0);
        inset(ui, |ui| ui.label(theme::dim(ui, heading).size(theme::SMALL_SIZE)));
        ui.add_space(2.0);
        for format in of_group {
            if format_row(ui, &format, format.id == shown.format.id) {
                chosen = Some(format.id);
            }
        }
    }
    if is_empty {
        ui.add_space(theme::GAP);
        inset(ui, |ui| ui.label(theme::dim(ui, words::NONE_FOUND)));
    }
    ui.add_space(8.0);
    chosen
}

/// What stands on its own line, as far from the border as the rows' words.
fn inset<R>(ui: &mut Ui, contents: impl FnOnce(&mut Ui) -> R) {
    let margin = egui::Margin { left: 12, right: 12, top: 0, bottom: 0 };
    Frame::new().inner_margin(margin).show(ui, contents);
}

/// A row of the list. Answers whether it was clicked.
fn format_row(ui: &mut Ui, format: &Format, is_shown: bool) -> bool {
    let palette = theme::palette(ui);
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), theme::ROW_HEIGHT), Sense::click());
    response.widget_info(|| WidgetInfo::selected(Role::Button, true, is_shown, format.label));
    let response = response.on_hover_text(format.label);
    if !ui.is_rect_visible(rect) {
        return response.clicked();
    }
    if is_shown || response.hovered() || response.has_focus() {
        let fill = if is_shown { palette.selected } else { palette.hovered };
        ui.painter().rect_filled(rect.shrink2(vec2(4.0, 0.0)), theme::RADIUS, fill);
    }
    let color = if is_shown { palette.accent } else { palette.text };
    let font = TextStyle::Body.resolve(ui.style());
    let room = rect.width() - 2.0 * theme::GAP;
    let job = egui::text::LayoutJob {
        wrap: egui::text::TextWrapping::truncate_at_width(room),
        ..egui::text::LayoutJob::simple_singleline(format.label.to_owned(), font, color)
    };
    let galley = ui.painter().layout_job(job);
    let at = Align2::LEFT_CENTER.anchor_size(rect.left_center() + vec2(theme::GAP, 0.0), galley.size());
    ui.painter().galley(at.min, galley, color);
    response.clicked()
}

fn text_card(
    ui: &mut Ui,
    context: &mut PanelContext<'_>,
    state: &mut ToolFrameState,
    shown: &Shown<'_>,
    solved: &[Method],
) {
    let height = ui.available_height();
    let mut is_copied = false;
    let buttons = |ui: &mut Ui| {
        if widgets::primary_button(ui, words::COPY).clicked() {
            ui.ctx().copy_text(shown.text.clone());
            is_copied = true;
        }
        if ui.button(words::SAVE).clicked() {
            let name = format!("{}.{}", shown.frame.name.as_str(), shown.format.extension);
            let contents = shown.text.as_bytes().into();
            save_file::ask(ui.ctx(), SaveFile { purpose: Purpose::ToolFrame, name, contents });
        }
    };
    widgets::card_with_height(ui, shown.format.label, height, buttons, |ui| {
        let inner = ui.available_rect_before_wrap().shrink2(vec2(theme::GAP, 8.0));
        let mut body = child(ui, inner);
        let ui = &mut body;
        if ui.available_width() >= ONE_ROW_FROM {
            ui.horizontal(|ui| {
                choose_calibration(ui, context, shown, solved);
                ui.add_space(theme::GAP);
                name_and_number(ui, state);
            });
        } else {
            ui.horizontal(|ui| choose_calibration(ui, context, shown, solved));
            ui.horizontal(|ui| name_and_number(ui, state));
        }
        ui.add_space(4.0);
        let formula = shown.format.convention.map(|convention| convention.formula);
        let meaning = words::meaning(shown.frame.parent == Parent::Flange, shown.format.units, formula);
        ui.add(Label::new(meaning).wrap());
        if let Some(remark) = shown.format.remark {
            let color = theme::palette(ui).warn;
            ui.add(Label::new(RichText::new(format!("! {remark}")).color(color)).wrap());
        }
        ui.add_space(4.0);
        text(ui, &shown.text);
        ui.add_space(4.0);
        round_trip(ui, shown);
    });
    if is_copied {
        context.commands.push(Command::Tell(NoticeKind::Done, panel_words::COPIED_TEXT.to_owned()));
    }
}

fn choose_calibration(ui: &mut Ui, context: &mut PanelContext<'_>, shown: &Shown<'_>, solved: &[Method]) {
    let current = shown.solution.method;
    let text = |ui: &Ui, method: Method| {
        RichText::new(format!("{} {}", theme::method_symbol(method), method_name(method)))
            .color(theme::method_text_color(ui, method))
    };
    let combo = ComboBox::from_id_salt("calibration of the tool frame")
        .selected_text(text(ui, current))
        .width(200.0)
        .show_ui(ui, |ui| {
            for method in solved {
                let text = text(ui, *method);
                ui.selectable_value(&mut context.selection.method, *method, text);
            }
        });
    combo.response.widget_info(|| WidgetInfo::labeled(Role::ComboBox, true, words::CALIBRATION));
    let std_mm = shown.solution.uncertainty.as_ref().map(|known| std_text(known.workspace_point_std_mm));
    ui.label(theme::dim(ui, words::known_to(std_mm.as_deref())));
}

fn name_and_number(ui: &mut Ui, state: &mut ToolFrameState) {
    ui.label(theme::dim(ui, words::NAME));
    let field = ui.add(TextEdit::singleline(&mut state.name).char_limit(LONGEST_NAME).desired_width(120.0));
    name_field(&field, words::NAME, &state.name);
    ui.label(theme::dim(ui, words::NUMBER));
    let number = ui.add(DragValue::new(&mut state.number).range(1..=99));
    number.widget_info(|| WidgetInfo::labeled(Role::SpinButton, true, words::NUMBER));
}

/// The text, to be read and selected, as far down as there is room.
fn text(ui: &mut Ui, text: &str) {
    let palette = theme::palette(ui);
    let height = ui.available_height() - ROUND_TRIP_HEIGHT;
    let frame = Frame::new()
        .fill(palette.canvas)
        .stroke(Stroke::new(1.0, palette.hairline))
        .corner_radius(theme::RADIUS)
        .inner_margin(8);
    frame.show(ui, |ui| {
        let area = ScrollArea::both().id_salt("text of the tool frame").max_height(height - 18.0).auto_shrink(false);
        area.show(ui, |ui| {
            let mut shown = text;
            let field = TextEdit::multiline(&mut shown)
                .font(FontId::new(TEXT_SIZE, FontFamily::Monospace))
                .frame(Frame::NONE)
                .desired_width(f32::INFINITY);
            let field = ui.add(field);
            name_field(&field, words::TEXT, text);
        });
    });
}

fn round_trip(ui: &mut Ui, shown: &Shown<'_>) {
    let palette = theme::palette(ui);
    let (mark, color, sentence) = match &shown.trip {
        Ok(trip) if trip.is_good() => {
            let off = [fixed(trip.translation_mm, 4), fixed(trip.rotation_deg, 5)];
            ("✔", palette.good, words::read_back(&off[0], &off[1]))
        }
        Ok(trip) => {
            let off = [fixed(trip.translation_mm, 3), fixed(trip.rotation_deg, 3)];
            ("✖", palette.bad, words::read_back_wrong(&off[0], &off[1]))
        }
        Err(error) => ("✖", palette.bad, error.to_string()),
    };
    ui.horizontal(|ui| {
        ui.label(RichText::new(mark).color(color));
        ui.add(Label::new(sentence).wrap());
    });
}
