//! The start page, and the overview's column for opening another session.

use std::path::PathBuf;
use std::sync::Arc;

use egui::{
    Align, Align2, CornerRadius, FontSelection, Galley, Key, Layout, Rect, Role, ScrollArea, Sense, Stroke, TextEdit,
    TextStyle, TextWrapMode, Ui, Vec2, WidgetInfo, WidgetText, pos2, vec2,
};

use crate::app::Command;
use crate::app::jobs::{JobOutcome, Slot, Wake};
use crate::session::samples;
use crate::text::document as document_words;
use crate::text::shell as shell_words;
use crate::text::start as words;
use crate::ui::actions::Action;
use crate::ui::widgets::{FromTop, card, primary_button, symbol_button};
use crate::ui::{PanelContext, import, theme};

use super::form::FormState;
use super::model::{Drawn, SamplePreview, SamplePreviews, preview_samples};
use super::offers::{self, OffersState};
use super::{overview, paint};

/// Width that a sample's card is at least given, points.
const MIN_CARD_WIDTH: f32 = 216.0;
/// Height of a card's picture, points.
const PICTURE_HEIGHT: f32 = 96.0;
/// From a card's picture to its name, from the name to the lesson, and below the sizes, points.
const NAME_AT: f32 = 10.0;
const LESSON_AT: f32 = NAME_AT + 22.0;
const SIZES_UP: f32 = 10.0;
/// Least gap between the lesson and the sizes, points.
const LESSON_GAP: f32 = 6.0;
/// Width of the start page's contents at most, points.
const MAX_PAGE_WIDTH: f32 = 1160.0;

/// The path being typed, and what was read of the samples.
#[derive(Default)]
pub struct StartState {
    path: String,
    wants_focus: bool,
    hint: Option<&'static str>,
    reading: Slot<SamplePreviews>,
    previews: SamplePreviews,
    looking: Slot<Vec<bool>>,
    /// The recent files that were looked for last.
    looked_for: Vec<PathBuf>,
    /// Whether each of them is there; empty until that is known.
    are_there: Vec<bool>,
    form: FormState,
    offers: OffersState,
    from_top: FromTop,
}

impl StartState {
    /// Begins to read the samples.
    pub fn read_samples(&mut self, wake: &Wake) {
        self.reading.start("preview samples", wake, |_| preview_samples());
    }

    /// Takes in what was read.
    pub fn poll(&mut self) {
        if let Some(JobOutcome::Done(previews)) = self.reading.poll() {
            self.previews = previews;
        }
        if let Some(JobOutcome::Done(are_there)) = self.looking.poll() {
            self.are_there = are_there;
        }
    }

    /// Looks in the background which of the recent files are there: a folder on a network may take its time.
    pub fn look_for_files(&mut self, recent_files: &[PathBuf], wake: &Wake) {
        if self.looked_for != recent_files {
            self.looked_for = recent_files.to_vec();
            self.are_there.clear();
            let paths = recent_files.to_vec();
            self.looking.start("look for files", wake, move |_| paths.iter().map(|path| path.exists()).collect());
        }
    }

    /// Files may have come or gone.
    pub fn look_again(&mut self) {
        self.looked_for.clear();
    }

    /// Another document is on the bench, and another page in sight.
    pub fn forget_typing(&mut self) {
        self.form = FormState::default();
        self.from_top = FromTop::default();
    }

    /// Whether samples are still being read.
    #[must_use]
    pub const fn is_reading(&self) -> bool {
        self.reading.is_running()
    }

    /// Asks for a path in the field, and says why.
    pub const fn ask_for_path(&mut self, hint: &'static str) {
        self.hint = Some(hint);
        self.wants_focus = true;
    }
}

/// Draws the step: the start page, or the overview of the open session beside the ways to open another.
pub fn show(ui: &mut Ui, context: &mut PanelContext<'_>, state: &mut StartState, recent_files: &mut Vec<PathBuf>) {
    // Room for the scroll bar beside the cards, not over them.
    ui.spacing_mut().scroll.floating_allocated_width = 8.0;
    let area = ScrollArea::vertical().id_salt("start").auto_shrink(false);
    state.from_top.apply(area).show(ui, |ui| {
        if let Some(document) = context.workbench.document() {
            offers::recovery(ui, context, &mut state.offers);
            overview::show(ui, document, context, &mut state.form);
            ui.add_space(theme::GAP);
            open_card(ui, words::OPEN_ANOTHER, context, state, recent_files);
            ui.add_space(20.0);
            ui.label(theme::strong(words::SAMPLES));
            ui.add_space(4.0);
            samples_grid(ui, context, state);
        } else {
            let margin = ((ui.available_width() - MAX_PAGE_WIDTH) / 2.0).max(0.0);
            egui::Frame::new().inner_margin(egui::Margin::symmetric(round_points(margin), 16)).show(ui, |ui| {
                ui.label(theme::heading(words::TITLE));
                ui.add_space(4.0);
                ui.label(theme::dim(ui, words::LEAD));
                ui.add_space(16.0);
                offers::recovery(ui, context, &mut state.offers);
                offers::cell(ui, context);
                ui.add_space(theme::GAP);
                open_card(ui, words::OPEN_FILE, context, state, recent_files);
                ui.add_space(20.0);
                ui.label(theme::strong(words::SAMPLES));
                ui.add_space(8.0);
                samples_grid(ui, context, state);
            });
        }
    });
}

fn open_card(
    ui: &mut Ui,
    title: &str,
    context: &mut PanelContext<'_>,
    state: &mut StartState,
    recent_files: &mut Vec<PathBuf>,
) {
    card(
        ui,
        title,
        |_| {},
        |ui| {
            egui::Frame::new().inner_margin(12).show(ui, |ui| {
                path_row(ui, context, state);
                if let Some(hint) = state.hint {
                    ui.label(egui::RichText::new(hint).color(theme::palette(ui).warn));
                }
                errors(ui, context);
                ui.label(theme::dim(ui, words::DROP_HINT).small());
                import::entries(ui, context.actions);
                recent(ui, context, state, recent_files);
                offers::new_session(ui, context, &mut state.offers);
            });
        },
    );
}

fn path_row(ui: &mut Ui, context: &mut PanelContext<'_>, state: &mut StartState) {
    ui.horizontal(|ui| {
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let is_first = context.workbench.document().is_none() && context.workbench.recoverable().is_empty();
            let open = if is_first { primary_button(ui, words::CHOOSE_FILE) } else { ui.button(words::CHOOSE_FILE) };
            if open.clicked() {
                context.actions.push(Action::Open);
            }
            let path = state.path.trim();
            let go = ui.add_enabled(!path.is_empty(), egui::Button::new(words::OPEN_PATH));
            let mut wants_open = go.clicked();
            let field = TextEdit::singleline(&mut state.path)
                .hint_text(words::PATH_HINT)
                .margin(vec2(8.0, 5.0))
                .desired_width(f32::INFINITY);
            let field = ui.add(field);
            let text = state.path.clone();
            field.widget_info(|| {
                let mut info = WidgetInfo::text_edit(true, "", &text, words::PATH_HINT);
                info.label = Some(words::PATH.to_owned());
                info
            });
            if std::mem::take(&mut state.wants_focus) {
                field.request_focus();
            }
            wants_open |= field.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
            if wants_open && !state.path.trim().is_empty() {
                context.commands.push(Command::Open(PathBuf::from(state.path.trim())));
                state.hint = None;
            }
        });
    });
}

/// What went wrong with opening, right below the field where it was typed.
fn errors(ui: &mut Ui, context: &mut PanelContext<'_>) {
    for notice in context.workbench.notices().iter().filter(|notice| notice.is_of_opening) {
        ui.horizontal(|ui| {
            let color = theme::palette(ui).bad;
            ui.label(egui::RichText::new("✖").color(color));
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                if symbol_button(ui, "×", shell_words::DISMISS).clicked() {
                    context.commands.push(Command::DismissNotice(notice.id));
                }
                ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                    ui.add(egui::Label::new(egui::RichText::new(&notice.message).color(color)).wrap());
                });
            });
        });
    }
}

fn recent(ui: &mut Ui, context: &mut PanelContext<'_>, state: &StartState, recent_files: &mut Vec<PathBuf>) {
    if recent_files.is_empty() {
        return;
    }
    ui.add_space(8.0);
    ui.label(theme::dim(ui, words::RECENT));
    let mut removed = None;
    for (idx, path) in recent_files.iter().enumerate() {
        let name = path.display().to_string();
        let is_missing = state.looked_for.get(idx) == Some(path) && state.are_there.get(idx) == Some(&false);
        ui.horizontal(|ui| {
            if symbol_button(ui, "×", &document_words::remove_recent(&name)).clicked() {
                removed = Some(idx);
            }
            if is_missing {
                ui.label(theme::dim(ui, document_words::MISSING).small());
                ui.label(theme::dim(ui, name));
            } else if ui.link(name).clicked() {
                context.commands.push(Command::Open(path.clone()));
            }
        });
    }
    if let Some(idx) = removed {
        recent_files.remove(idx);
    }
}

/// A sample on its card.
struct SampleCard<'a> {
    name: &'static str,
    lesson: &'static str,
    preview: Option<&'a SamplePreview>,
    opens: Command,
}

impl StartState {
    fn cards(&self) -> impl Iterator<Item = SampleCard<'_>> {
        let carried = samples::ALL.iter().enumerate().map(|(sample_idx, sample)| {
            let (name, lesson) = words::sample_lesson(sample.file_name);
            let preview = self.previews.carried.get(sample_idx).and_then(Option::as_ref);
            SampleCard { name, lesson, preview, opens: Command::OpenSample(sample_idx) }
        });
        let sequence = self.previews.sequence.as_ref().map(|(file, preview)| {
            let (name, lesson) = words::SEQUENCE_LESSON;
            SampleCard { name, lesson, preview: Some(preview), opens: Command::Open(file.clone()) }
        });
        carried.chain(sequence)
    }
}

fn samples_grid<'a>(ui: &mut Ui, context: &mut PanelContext<'_>, state: &'a StartState) {
    let width = ui.available_width();
    let num_columns = (2..=4).rev().find(|columns| fits(width, *columns)).unwrap_or(1);
    let card_width = (width - gaps(num_columns)) / count_points(num_columns);
    let with_lesson = |card: SampleCard<'a>| {
        let lesson = lesson_on(ui, card_width, card.lesson);
        (card, lesson)
    };
    let cards: Vec<_> = state.cards().map(with_lesson).collect();
    // As high as the longest lesson needs, all of them.
    let longest = cards.iter().map(|(_, lesson)| lesson.size().y).fold(0.0, f32::max);
    let sizes_height = ui.text_style_height(&TextStyle::Small) + SIZES_UP;
    let size = vec2(card_width, (PICTURE_HEIGHT + LESSON_AT + longest + LESSON_GAP + sizes_height).ceil());
    ui.spacing_mut().item_spacing = vec2(theme::GAP, theme::GAP);
    for row in cards.chunks(num_columns) {
        ui.horizontal(|ui| {
            for (card, lesson) in row {
                sample_card(ui, size, card, lesson, context, state.is_reading());
            }
        });
    }
    if state.previews.sequence.is_none() && !state.is_reading() {
        ui.add(egui::Label::new(theme::dim(ui, words::NO_SAMPLE_SEQUENCE).small()).wrap());
    }
}

fn fits(width: f32, num_columns: usize) -> bool {
    MIN_CARD_WIDTH * count_points(num_columns) + gaps(num_columns) <= width
}

fn gaps(num_columns: usize) -> f32 {
    theme::GAP * count_points(num_columns.saturating_sub(1))
}

#[expect(clippy::cast_precision_loss, reason = "a handful of columns")]
const fn count_points(count: usize) -> f32 {
    count as f32
}

#[expect(clippy::cast_possible_truncation, reason = "half of a window's width, and the cast saturates")]
fn round_points(value: f32) -> i8 {
    value.round() as i8
}

/// What a sample teaches, wrapped to its card.
fn lesson_on(ui: &Ui, card_width: f32, lesson: &str) -> Arc<Galley> {
    WidgetText::from(theme::dim(ui, lesson)).into_galley(
        ui,
        Some(TextWrapMode::Wrap),
        card_width - 2.0 * theme::GAP,
        FontSelection::Style(TextStyle::Body),
    )
}

fn sample_card(
    ui: &mut Ui,
    size: Vec2,
    card: &SampleCard<'_>,
    lesson: &Arc<Galley>,
    context: &mut PanelContext<'_>,
    is_reading: bool,
) {
    let (rect, response) = ui.allocate_exact_size(size, Sense::click());
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, words::open_sample(card.name)));
    if ui.is_rect_visible(rect) {
        let is_hot = response.hovered() || response.has_focus();
        let sizes = match card.preview {
            Some(preview) => sizes(preview),
            None if is_reading => words::READING.to_owned(),
            None => String::new(),
        };
        paint_card(ui, rect, is_hot, card.preview, lesson, [card.name, &sizes]);
    }
    if response.clicked() {
        context.commands.push(card.opens.clone());
    }
}

fn sizes(preview: &SamplePreview) -> String {
    match preview.drawn {
        Drawn::Profiles => words::sizes(preview.num_stations, preview.num_captures, false),
        Drawn::Points => words::sizes(preview.num_stations, preview.num_captures, true),
        Drawn::Boards => words::sizes_of_boards(preview.num_captures),
        Drawn::Way => words::sizes_of_sequence(preview.num_captures),
    }
}

fn paint_card(
    ui: &Ui,
    rect: Rect,
    is_hot: bool,
    preview: Option<&SamplePreview>,
    lesson: &Arc<Galley>,
    [name, sizes]: [&str; 2],
) {
    let palette = theme::palette(ui);
    let painter = ui.painter();
    let border = Stroke::new(1.0, if is_hot { palette.accent } else { palette.hairline });
    let radius = CornerRadius::same(theme::RADIUS);
    painter.rect(rect, radius, palette.surface, border, egui::StrokeKind::Inside);
    let picture = Rect::from_min_size(rect.min, vec2(rect.width(), PICTURE_HEIGHT)).shrink(1.0);
    paint::picture(painter, picture, palette, preview);
    painter.hline(rect.x_range(), picture.bottom(), Stroke::new(1.0, palette.hairline));
    let left = rect.left() + theme::GAP;
    let top = picture.bottom();
    painter.text(pos2(left, top + NAME_AT), Align2::LEFT_TOP, name, theme::strong_font(), palette.text);
    painter.galley(pos2(left, top + LESSON_AT), Arc::clone(lesson), palette.text_dim);
    let small = TextStyle::Small.resolve(ui.style());
    let bottom = rect.bottom() - SIZES_UP;
    painter.text(pos2(left, bottom), Align2::LEFT_BOTTOM, sizes, small, palette.text_dim);
}
