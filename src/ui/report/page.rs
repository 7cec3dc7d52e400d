//! A report on paper: white whatever the theme, as it will be read. Blocks out of sight take their room and nothing else.

use egui::{Frame, Label, Margin, Rect, RichText, Role, Sense, Stroke, Theme, Ui, UiBuilder, WidgetInfo, vec2};

use crate::diagnose::Severity;
use crate::report::document::{Block, Document, Fact, Finding, Section, Verdict};
use crate::text::diagnosis::{severity_mark, severity_name};
use crate::text::report_panel as words;
use crate::ui::theme;

use super::figures::Figures;
use super::table;

/// White around the text, points.
const PAPER_MARGIN: i8 = 32;
/// The same in a narrow window.
const NARROW_MARGIN: i8 = 16;
/// Width from which there is room for the wide margin, points.
const WIDE_FROM: f32 = 700.0;
/// Between blocks, points.
const BLOCK_GAP: f32 = 8.0;
/// Before a section, points.
const SECTION_GAP: f32 = 20.0;
/// Part of the width that the names of facts take.
const NAMES_PART: f32 = 0.34;
/// Until a block is seen for the first time it counts for this, points.
const UNSEEN_HEIGHT: f32 = 60.0;

/// What is remembered of a page: its figures, and the heights of its blocks at a width.
#[derive(Debug, Default)]
pub(super) struct Page {
    width: f32,
    figures: Figures,
    heights: Vec<Option<f32>>,
}

impl Page {
    /// Whether a figure is being drawn.
    pub(super) const fn is_drawing(&self) -> bool {
        self.figures.is_drawing()
    }

    /// Other sections, or other words in them: all is laid out anew.
    pub(super) fn forget_heights(&mut self) {
        self.heights.clear();
    }

    /// Shows sections in the width available.
    pub(super) fn show(&mut self, ui: &mut Ui, head: &Document, sections: &[&Section]) {
        self.figures.poll(ui);
        let print = ui.ctx().style_of(Theme::Light);
        ui.visuals_mut().clone_from(&print.visuals);
        let palette = theme::palette(ui);
        let margin = if ui.available_width() >= WIDE_FROM { PAPER_MARGIN } else { NARROW_MARGIN };
        let sheet = Frame::new()
            .fill(palette.surface)
            .stroke(Stroke::new(1.0, palette.hairline))
            .inner_margin(Margin::same(margin));
        let shown = sheet.show(ui, |ui| {
            ui.set_width(ui.available_width());
            ui.spacing_mut().item_spacing.y = 0.0;
            if (self.width - ui.available_width()).abs() > 0.5 {
                self.width = ui.available_width();
                self.heights.clear();
            }
            self.contents(ui, head, sections);
        });
        shown.response.widget_info(|| WidgetInfo::labeled(Role::Document, true, words::PREVIEW));
    }

    fn contents(&mut self, ui: &mut Ui, head: &Document, sections: &[&Section]) {
        let mut block_idx = 0;
        self.block(ui, &mut block_idx, |ui, _| {
            ui.label(theme::dim(ui, &head.subtitle));
            ui.add(Label::new(theme::heading(&head.title)).wrap());
        });
        for section in sections {
            ui.add_space(SECTION_GAP);
            self.block(ui, &mut block_idx, |ui, _| section_heading(ui, &section.title));
            for block in &section.blocks {
                ui.add_space(BLOCK_GAP);
                self.block(ui, &mut block_idx, |ui, figures| paint(ui, figures, block));
            }
        }
    }

    /// A block where it is in sight, its room where it is not.
    fn block(&mut self, ui: &mut Ui, block_idx: &mut usize, contents: impl FnOnce(&mut Ui, &mut Figures)) {
        let idx = std::mem::replace(block_idx, *block_idx + 1);
        if self.heights.len() <= idx {
            self.heights.resize(idx + 1, None);
        }
        let height = self.heights[idx].unwrap_or(UNSEEN_HEIGHT);
        let place = Rect::from_min_size(ui.cursor().min, vec2(ui.available_width(), height));
        // The first time all are laid out, so that the scroll bar does not jump.
        if self.heights[idx].is_some() && !ui.is_rect_visible(place) {
            ui.allocate_exact_size(place.size(), Sense::hover());
            return;
        }
        let figures = &mut self.figures;
        let shown = ui.scope_builder(UiBuilder::new().id_salt(idx), |ui| {
            ui.set_width(ui.available_width());
            contents(ui, figures);
        });
        self.heights[idx] = Some(shown.response.rect.height());
    }
}

fn section_heading(ui: &mut Ui, title: &str) {
    let palette = theme::palette(ui);
    ui.label(theme::strong(title).color(palette.accent));
    let (line, _) = ui.allocate_exact_size(vec2(ui.available_width(), 5.0), Sense::hover());
    ui.painter().hline(line.x_range(), line.center().y, Stroke::new(1.0, palette.hairline));
}

fn paint(ui: &mut Ui, figures: &mut Figures, block: &Block) {
    match block {
        Block::Heading(title) => {
            ui.add_space(4.0);
            ui.label(theme::strong(title));
        }
        Block::Paragraph(text) => {
            ui.add(Label::new(text).wrap());
        }
        Block::Verdict(verdict) => paint_verdict(ui, verdict),
        Block::Facts(facts) => facts.iter().for_each(|fact| paint_fact(ui, fact)),
        Block::Table(table) => table::paint(ui, table),
        Block::Figure(figure) => figures.show(ui, figure),
        Block::Code { caption, text } => paint_code(ui, caption, text),
        Block::Findings(findings) => findings.iter().for_each(|finding| paint_finding(ui, finding)),
        Block::Signature(lines) => lines.iter().for_each(|line| paint_line_to_sign(ui, line)),
    }
}

fn paint_verdict(ui: &mut Ui, verdict: &Verdict) {
    let palette = theme::palette(ui);
    let color = verdict.rating.map_or(palette.text_dim, |rating| theme::verdict_color_in(palette, rating));
    let frame = Frame::new()
        .fill(color.gamma_multiply(0.07))
        .stroke(Stroke::new(1.0, color.gamma_multiply(0.5)))
        .corner_radius(theme::RADIUS)
        .inner_margin(Margin::same(12));
    frame.show(ui, |ui| {
        ui.set_width(ui.available_width());
        ui.horizontal(|ui| {
            ui.label(theme::heading(format!("{} {}", verdict.mark, verdict.name)).color(color));
            if let Some(headline) = &verdict.headline {
                ui.add_space(theme::GAP);
                ui.label(theme::heading(headline));
            }
        });
        if let Some(note) = &verdict.headline_note {
            ui.add(Label::new(theme::dim(ui, note)).wrap());
        }
        ui.add_space(4.0);
        ui.add(Label::new(&verdict.reason).wrap());
    });
}

fn paint_fact(ui: &mut Ui, fact: &Fact) {
    pair(ui, &fact.name, |ui| {
        ui.add(Label::new(&fact.value).wrap());
    });
}

/// A dim name at the left, and what belongs to it.
fn pair(ui: &mut Ui, name: &str, right: impl FnOnce(&mut Ui)) {
    let width = ui.available_width();
    let names = (width * NAMES_PART).round();
    ui.horizontal_top(|ui| {
        ui.spacing_mut().item_spacing.x = 0.0;
        ui.scope(|ui| {
            ui.set_width(names);
            ui.set_max_width(names - 8.0);
            ui.vertical(|ui| ui.add(Label::new(theme::dim(ui, name)).wrap()));
        });
        ui.vertical(|ui| {
            ui.set_width(width - names);
            right(ui);
        });
    });
    ui.add_space(3.0);
}

fn paint_line_to_sign(ui: &mut Ui, line: &Fact) {
    ui.add_space(10.0);
    pair(ui, &line.name, |ui| {
        ui.label(if line.value.is_empty() { " " } else { &line.value });
        let (rule, _) = ui.allocate_exact_size(vec2(ui.available_width() * 0.7, 3.0), Sense::hover());
        ui.painter().hline(rule.x_range(), rule.center().y, Stroke::new(1.0, theme::palette(ui).text_dim));
    });
}

fn paint_finding(ui: &mut Ui, finding: &Finding) {
    let palette = theme::palette(ui);
    let color = match finding.severity {
        Severity::Wrong => palette.bad,
        Severity::Doubtful => palette.warn,
        Severity::Note => palette.text_dim,
    };
    let name = format!("{} {}", severity_mark(finding.severity), severity_name(finding.severity));
    ui.label(RichText::new(name).color(color)).on_hover_text(&finding.code);
    ui.add(Label::new(&finding.message).wrap());
    if !finding.remedy.is_empty() {
        ui.add(Label::new(theme::dim(ui, &finding.remedy)).wrap());
    }
    ui.add_space(8.0);
}

fn paint_code(ui: &mut Ui, caption: &str, text: &str) {
    let palette = theme::palette(ui);
    ui.add(Label::new(theme::dim(ui, caption)).wrap());
    ui.add_space(4.0);
    Frame::new().fill(palette.canvas).corner_radius(theme::RADIUS).inner_margin(8).show(ui, |ui| {
        ui.set_width(ui.available_width());
        let font = egui::FontId::new(theme::SMALL_SIZE, egui::FontFamily::Monospace);
        ui.add(Label::new(RichText::new(text.trim_end()).font(font)).wrap());
    });
}
