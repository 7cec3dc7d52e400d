//! The band's painting: in one row where there is room, else the comparison below; the next step has a row of its own.

use egui::{Align, Button, Frame, Layout, Margin, RichText, Ui, vec2};

use crate::app::Command;
use crate::calibrate::verdict::{GOOD_UP_TO_MM, USABLE_UP_TO_MM};
use crate::report::compare::Improvement;
use crate::report::judgement::Judgement;
use crate::text::compare as text;
use crate::text::diagnosis_panel as next_words;
use crate::text::methods::{method_name, method_short_name, verdict_mark, verdict_name};
use crate::text::typeset::std_text;
use crate::ui::actions::Action;
use crate::ui::{PanelContext, Step, theme, widgets};

use super::model::NextStep;

/// Shows the band; `is_explained` toggles the reasons.
pub fn show(
    ui: &mut Ui,
    band: Option<&Judgement>,
    improvement: Option<&Improvement>,
    next: Option<&NextStep>,
    is_out_of_date: bool,
    is_explained: &mut bool,
    context: &mut PanelContext<'_>,
) {
    widgets::card(
        ui,
        "",
        |_| {},
        |ui| {
            Frame::new().inner_margin(Margin::symmetric(16, 10)).show(ui, |ui| {
                let Some(band) = band else {
                    ui.horizontal(|ui| {
                        ui.set_min_size(vec2(ui.available_width(), 28.0));
                        ui.label(theme::dim(ui, text::NO_METHOD));
                    });
                    return;
                };
                let words = Words::new(band, improvement);
                let rows = words.rows(ui, is_out_of_date);
                ui.horizontal(|ui| {
                    ui.set_min_height(30.0);
                    verdict_words(ui, band, &words);
                    if rows < 3 {
                        headline(ui, band, &words);
                    }
                    ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                        if ui.add(Button::new(text::WHY).selected(*is_explained)).clicked() {
                            *is_explained = !*is_explained;
                        }
                        if is_out_of_date {
                            ui.label(theme::strong(text::OUT_OF_DATE).color(theme::palette(ui).warn));
                        }
                        if rows == 1 {
                            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                                better_by(ui, band, &words, true);
                            });
                        }
                    });
                });
                if rows == 3 {
                    ui.horizontal_wrapped(|ui| headline(ui, band, &words));
                }
                if rows > 1 && !words.comparison.is_empty() {
                    ui.horizontal_wrapped(|ui| better_by(ui, band, &words, false));
                }
                if *is_explained {
                    reasons(ui, band);
                }
                if let Some(next) = next {
                    next_step(ui, next, context);
                }
            });
        },
    );
}

/// What to do next: a sentence, the remedy's button where there is one, and the way to the diagnosis.
fn next_step(ui: &mut Ui, next: &NextStep, context: &mut PanelContext<'_>) {
    ui.add_space(4.0);
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().interact_size.y = 26.0;
        ui.label(theme::dim(ui, next_words::NEXT_STEP));
        let see = match next {
            NextStep::Mend { title, remedy, label } => {
                ui.label(theme::strong(*title));
                if widgets::primary_button(ui, label).clicked() {
                    context.commands.push(Command::ApplyRemedy(remedy.clone()));
                }
                next_words::SEE_DIAGNOSIS
            }
            NextStep::Look { title } => {
                ui.label(theme::strong(*title));
                next_words::SEE_DIAGNOSIS
            }
            NextStep::Measure { gain } => {
                ui.label(gain);
                next_words::SEE_NEXT_POSES
            }
        };
        if ui.button(see).clicked() {
            context.actions.push(Action::GoTo(Step::Diagnosis));
        }
    });
}

/// What the band says, part by part.
struct Words {
    verdict: &'static str,
    method: String,
    /// Where the point is, and how well it is known.
    headline: Option<[String; 2]>,
    comparison: Vec<(String, Tone)>,
}

/// How a part of the comparison is set.
#[derive(Clone, Copy)]
enum Tone {
    Plain,
    Figure,
    Better,
    Worse,
}

impl Words {
    fn new(band: &Judgement, improvement: Option<&Improvement>) -> Self {
        let method = method_short_name(band.method);
        Self {
            verdict: verdict_name(band.verdict),
            method: text::judged_method(method, band.workspace_point.is_some()),
            headline: band.workspace_point.map(|point| {
                let place = if point.is_stated {
                    text::headline(&widgets::fixed(point.z_mm.abs(), 0))
                } else {
                    text::headline_amid_seen(band.method, &widgets::fixed(point.z_mm, 0))
                };
                [place, text::headline_figure(&std_text(point.std_mm))]
            }),
            comparison: improvement.map_or_else(Vec::new, comparison),
        }
    }

    /// In how many rows the band has room: all in one, the comparison below, or the headline below as well.
    fn rows(&self, ui: &Ui, is_out_of_date: bool) -> u8 {
        /// Mark, button and the gaps around them, points.
        const OTHERS: f32 = 110.0;
        /// Gap between two parts, points.
        const GAP: f32 = 8.0;
        let width = |text: &str, size: f32| {
            let font = egui::FontId::new(size, theme::strong_font().family);
            ui.painter().layout_no_wrap(text.to_owned(), font, egui::Color32::PLACEHOLDER).size().x + GAP
        };
        let body = |text: &str| width(text, theme::BODY_SIZE);
        let note = if is_out_of_date { body(text::OUT_OF_DATE) } else { 0.0 };
        let verdict = width(self.verdict, theme::HEADING_SIZE) + body(&self.method) + note + OTHERS;
        let headline: f32 = self.headline.iter().flatten().map(|part| body(part)).sum();
        let comparison: f32 = self.comparison.iter().map(|(part, _)| body(part)).sum();
        let room = ui.available_width();
        if verdict + headline + comparison <= room {
            1
        } else if verdict + headline <= room {
            2
        } else {
            3
        }
    }
}

fn comparison(improvement: &Improvement) -> Vec<(String, Tone)> {
    let mut words = vec![
        (text::maximum_error(improvement.method), Tone::Plain),
        (format!("{} mm,", widgets::fixed(improvement.error_mm, 3)), Tone::Figure),
    ];
    let baseline = method_short_name(improvement.baseline);
    let baseline_mm = widgets::fixed(improvement.baseline_error_mm, 3);
    if improvement.is_alike() {
        words.push((text::no_better_than(baseline, &baseline_mm), Tone::Plain));
        return words;
    }
    if let Some(percent) = improvement.percent() {
        let tone = if percent < 0.0 { Tone::Better } else { Tone::Worse };
        words.push((format!("{} %", widgets::signed(percent, 0)), tone));
    }
    words.push((text::against(baseline, &baseline_mm), Tone::Plain));
    words
}

fn verdict_words(ui: &mut Ui, band: &Judgement, words: &Words) {
    let color = theme::verdict_color_in(theme::palette(ui), band.verdict);
    ui.label(theme::heading(verdict_mark(band.verdict)).color(color));
    ui.label(theme::heading(words.verdict));
    ui.label(theme::strong(&words.method)).on_hover_text(text::verdict_of(method_name(band.method)));
}

fn headline(ui: &mut Ui, band: &Judgement, words: &Words) {
    let Some([place, figure]) = &words.headline else { return };
    let hover = text::verdict_of(method_name(band.method));
    ui.label(theme::dim(ui, place)).on_hover_text(&hover);
    ui.label(theme::strong(figure)).on_hover_text(&hover);
}

/// The comparison; `is_reversed` where the layout runs from the right.
fn better_by(ui: &mut Ui, band: &Judgement, words: &Words, is_reversed: bool) {
    let hint = text::maximum_error_hint(band.method);
    ui.spacing_mut().item_spacing.x = 5.0;
    let palette = theme::palette(ui);
    let mut parts: Vec<RichText> = words
        .comparison
        .iter()
        .map(|(part, tone)| match tone {
            Tone::Plain => RichText::new(part),
            Tone::Figure => theme::strong(part),
            Tone::Better => theme::strong(part).color(palette.good),
            Tone::Worse => theme::strong(part).color(palette.warn),
        })
        .collect();
    if is_reversed {
        parts.reverse();
    }
    for part in parts {
        ui.label(part).on_hover_text(hint);
    }
}

fn reasons(ui: &mut Ui, band: &Judgement) {
    let palette = theme::palette(ui);
    ui.add_space(6.0);
    ui.label(format!("{}: {}", text::verdict_of(method_name(band.method)), band.reason));
    ui.label(theme::dim(ui, text::verdict_scale(GOOD_UP_TO_MM, USABLE_UP_TO_MM)));
    for (sentence, remedy) in &band.warnings {
        ui.horizontal_wrapped(|ui| {
            ui.label(theme::strong("!").color(palette.warn));
            ui.label(sentence);
            ui.label(theme::dim(ui, *remedy));
        });
    }
}
