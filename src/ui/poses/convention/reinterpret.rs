//! The dialog that reads the numbers differently, with what it would do to the first poses.

use egui::{Align, Context, Frame, Id, Layout, Modal, RichText, Ui, UiBuilder, vec2};
use egui_extras::Column;

use crate::app::Document;
use crate::geometry::{PoseNotation, Vec3};
use crate::report::figure::Orbit;
use crate::session::edit::shown_numbers;
use crate::session::{EditRefusal, Session};
use crate::text::conventions as words;
use crate::ui::theme;
use crate::ui::widgets::tables::{self, head, number_cell, number_column, number_head};
use crate::ui::widgets::{fixed, primary_button};

use super::model::{self, Draft, Preview};
use super::picker::Search;
use super::{editor, paint};

/// Width of the dialog, points.
const WIDTH: f32 = 968.0;
/// Width of the form at the left, points.
const FORM_WIDTH: f32 = 452.0;
/// Height of the form and of the pictures, points.
const FORM_HEIGHT: f32 = 308.0;
/// Rows of the preview's table; the pictures have a few more.
const MAX_ROWS: usize = 5;

/// What came of the dialog.
pub enum Answer {
    /// Read the numbers so.
    Apply(PoseNotation),
    /// Leave everything as it is.
    Cancel,
}

/// The open dialog.
#[derive(Clone, Debug)]
pub struct Reinterpretation {
    draft: Draft,
    search: Search,
    camera: Orbit,
    previewed: Option<Previewed>,
}

/// What was worked out last, and from what.
#[derive(Clone, Debug)]
struct Previewed {
    revision: u64,
    notation: PoseNotation,
    preview: Result<Preview, EditRefusal>,
}

impl Reinterpretation {
    /// Begins with how the numbers are read now.
    #[must_use]
    pub fn of(session: &Session) -> Self {
        Self {
            draft: Draft::of(&session.robot.notation),
            search: Search::default(),
            camera: Orbit::default(),
            previewed: None,
        }
    }

    /// Draws the dialog.
    pub fn show(&mut self, ctx: &Context, document: &Document) -> Option<Answer> {
        let mut answer = None;
        let frame = Frame::window(&ctx.global_style()).inner_margin(20);
        let response = Modal::new(Id::unique("reinterpret poses")).frame(frame).show(ctx, |ui| {
            ui.set_width(WIDTH.min(ui.ctx().content_rect().width() - 80.0));
            answer = self.contents(ui, document);
        });
        if response.should_close() {
            answer = answer.or(Some(Answer::Cancel));
        }
        answer
    }

    fn contents(&mut self, ui: &mut Ui, document: &Document) -> Option<Answer> {
        let session = &*document.session;
        let shown = session.robot.notation;
        ui.label(theme::heading(words::REINTERPRET_TITLE));
        ui.add_space(4.0);
        ui.label(RichText::new(words::REINTERPRET_WARNING).color(theme::palette(ui).warn));
        ui.label(theme::dim(ui, words::REINTERPRET_INSTEAD));
        ui.add_space(12.0);
        let (area, _) = ui.allocate_exact_size(vec2(ui.available_width(), FORM_HEIGHT), egui::Sense::hover());
        let (left, right) = area.split_left_right_at_x(area.left() + FORM_WIDTH);
        let mut form = ui.new_child(UiBuilder::new().max_rect(left).layout(Layout::top_down(Align::Min)));
        form.label(theme::strong(words::NUMBERS_REALLY_ARE));
        form.add_space(4.0);
        editor::show(&mut form, &mut self.draft, Some(shown.num_numbers()), &mut self.search);

        let notation = self.draft.notation();
        if let Ok(notation) = notation {
            self.work_out(document, notation);
        }
        self.pictures(ui, right.with_min_x(right.left() + theme::GAP), session);
        ui.add_space(12.0);
        let is_changed = notation.as_ref().is_ok_and(|notation| *notation != shown);
        let refusal = match (&notation, &self.previewed) {
            (Err(problem), _) => Some(problem.to_string()),
            (Ok(_), Some(Previewed { preview: Err(refusal), .. })) => Some(refusal.to_string()),
            _ => None,
        };
        if let Some(Previewed { preview: Ok(preview), .. }) = &self.previewed {
            table(ui, session, preview);
        }
        ui.add_space(12.0);
        let mut answer = None;
        ui.horizontal(|ui| {
            let is_possible = is_changed && refusal.is_none();
            ui.add_enabled_ui(is_possible, |ui| {
                if primary_button(ui, &words::reinterpret_poses(session.num_captures())).clicked() {
                    answer = notation.ok().map(Answer::Apply);
                }
            });
            if ui.button(words::CANCEL).clicked() {
                answer = Some(Answer::Cancel);
            }
            if let Some(refusal) = refusal {
                ui.label(RichText::new(format!("! {refusal}")).color(theme::palette(ui).bad));
            } else if !is_changed {
                ui.label(theme::dim(ui, words::NO_CHANGE));
            }
        });
        answer
    }

    /// Only where something has changed: a session may have thousands of poses.
    fn work_out(&mut self, document: &Document, notation: PoseNotation) {
        let is_current = self
            .previewed
            .as_ref()
            .is_some_and(|previewed| previewed.revision == document.revision && previewed.notation == notation);
        if !is_current {
            let preview = Preview::of(&document.session, &notation);
            self.previewed = Some(Previewed { revision: document.revision, notation, preview });
        }
    }

    fn pictures(&mut self, ui: &mut Ui, area: egui::Rect, session: &Session) {
        let now = model::frames(session);
        let then = match &self.previewed {
            Some(Previewed { preview: Ok(preview), .. }) => preview.then.as_slice(),
            _ => &[],
        };
        let (left, right) = area.split_left_right_at_fraction(0.5);
        let halves = [
            (words::NOW, now.as_slice(), left.with_max_x(left.right() - 4.0)),
            (words::THEN, then, right.with_min_x(right.left() + 4.0)),
        ];
        for (title, frames, half) in halves {
            let (head, picture) = half.split_top_bottom_at_y(half.top() + theme::ROW_HEIGHT);
            let palette = theme::palette(ui);
            ui.painter().text(head.left_top(), egui::Align2::LEFT_TOP, title, theme::strong_font(), palette.text);
            ui.painter().rect(
                picture,
                f32::from(theme::RADIUS),
                palette.canvas,
                egui::Stroke::new(1.0, palette.hairline),
                egui::StrokeKind::Inside,
            );
            paint::show(ui, picture.shrink(1.0), title, frames, &mut self.camera);
        }
    }
}

/// The first poses: their numbers, which stay, and what becomes of them.
fn table(ui: &mut Ui, session: &Session, preview: &Preview) {
    let notation = &session.robot.notation;
    ui.label(theme::dim(ui, words::numbers_stay(notation)));
    ui.add_space(4.0);
    let captures = session.stations.iter().filter_map(|station| Some((station, station.captures.first()?)));
    let rows: Vec<_> = captures.zip(&preview.changes).take(MAX_ROWS).collect();
    #[expect(clippy::cast_precision_loss, reason = "a few rows")]
    let height = (rows.len() + 1) as f32 * theme::ROW_HEIGHT;
    let (area, _) = ui.allocate_exact_size(vec2(ui.available_width(), height), egui::Sense::hover());
    let mut inside = ui.new_child(UiBuilder::new().max_rect(area).layout(Layout::top_down(Align::Min)));
    inside.spacing_mut().item_spacing.x = 0.0;
    tables::table(&mut inside, "reinterpreted poses")
        .column(Column::exact(56.0).clip(true))
        .columns(number_column(56.0), notation.num_numbers())
        .column(Column::exact(76.0))
        .column(Column::exact(80.0))
        .columns(Column::exact(140.0), 2)
        .header(theme::ROW_HEIGHT, |mut header| {
            head(&mut header, words::STATION);
            for name in ["x", "y", "z"].iter().chain(notation.orientation_names()) {
                number_head(&mut header, name);
            }
            for name in [words::TURNS, words::MOVES, words::Z_NOW, words::Z_THEN] {
                number_head(&mut header, name);
            }
        })
        .body(|mut body| {
            for ((station, capture), change) in rows {
                body.row(theme::ROW_HEIGHT, |mut row| {
                    row.set_overline(true);
                    row.col(|ui| {
                        ui.add_space(4.0);
                        ui.label(&station.label);
                    });
                    for (idx, number) in shown_numbers(capture, notation).into_iter().enumerate() {
                        number_cell(&mut row, fixed(number, model::decimals(notation, idx)));
                    }
                    number_cell(&mut row, format!("{}°", fixed(change.turns_deg, 2)));
                    number_cell(&mut row, format!("{} mm", fixed(change.moves_mm, 1)));
                    number_cell(&mut row, direction_text(change.z_now));
                    number_cell(&mut row, direction_text(change.z_then));
                });
            }
        });
    let num_more = session.stations.len().saturating_sub(MAX_ROWS);
    if num_more > 0 {
        ui.label(theme::dim(ui, words::more_stations(num_more)));
    }
    self_check(ui, preview);
}

/// From the first station to the second, for those who jogged the robot about one axis of its tool between them.
fn self_check(ui: &mut Ui, preview: &Preview) {
    let [first, second, ..] = preview.now.as_slice() else { return };
    let (Some(now), Some(then)) = (model::jog(&preview.now), model::jog(&preview.then)) else { return };
    let [now, then] = [now, then].map(|jog| words::turn(&fixed(jog.angle_deg, 2), &direction_text(jog.axis_in_flange)));
    let sentence = words::self_check(&first.label, &second.label, &now, &then);
    ui.label(theme::dim(ui, sentence)).on_hover_text(words::SELF_CHECK_HINT);
}

/// The numbers of a pose, on one line.
pub fn numbers_text(numbers: &[f64], notation: &PoseNotation) -> String {
    let texts = numbers.iter().enumerate().map(|(idx, number)| fixed(*number, model::decimals(notation, idx)));
    texts.collect::<Vec<_>>().join("   ")
}

fn direction_text(direction: Vec3) -> String {
    [direction.x, direction.y, direction.z].map(|part| fixed(part, 2)).join("   ")
}
