//! The list of findings: what is wrong, what it rests on, and what mends it.

use egui::{
    Align, Button, Color32, Frame, Label, Layout, Margin, ProgressBar, Rect, Role, ScrollArea, Sense, Ui, UiBuilder,
    WidgetInfo, vec2,
};

use crate::app::{Command, Progress};
use crate::diagnose::{Finding, Severity};
use crate::session::Target;
use crate::text::diagnosis as fault_words;
use crate::text::diagnosis_panel as words;
use crate::text::shell as shell_words;
use crate::ui::theme::Palette;
use crate::ui::{PanelContext, theme, widgets};

use super::model::{self, Shown, View};
use super::panel::DiagnosisState;

/// The colour of a severity; its shape stands beside it.
const fn color(palette: &Palette, severity: Severity) -> Color32 {
    match severity {
        Severity::Wrong => palette.bad,
        Severity::Doubtful => palette.warn,
        Severity::Note => palette.text_dim,
    }
}

/// Shows the card.
pub fn show(ui: &mut Ui, height: f32, view: &View<'_>, context: &mut PanelContext<'_>, state: &mut DiagnosisState) {
    let mut is_asked_for_readings = false;
    let shows_readings = state.shown == Shown::Readings;
    let right = |ui: &mut Ui| {
        ui.spacing_mut().interact_size.y = 22.0;
        ui.spacing_mut().button_padding = vec2(8.0, 2.0);
        // Whole poses of a target say by themselves what is inverted.
        if !matches!(view.session.target, Target::Pose { .. } | Target::Rgbd { .. }) {
            let button = Button::new(words::TRY_READINGS).selected(shows_readings);
            is_asked_for_readings = ui.add(button).on_hover_text(words::TRY_READINGS_HINT).clicked();
        }
        if view.is_out_of_date() {
            ui.label(theme::dim(ui, words::OUT_OF_DATE).color(theme::palette(ui).warn));
        }
    };
    widgets::card_with_height(ui, words::FINDINGS, height, right, |ui| {
        match (view.diagnosis.value, view.diagnosis.progress) {
            (Some(diagnosis), _) if diagnosis.findings.is_empty() => nothing_found(ui, &view.session.target),
            (Some(_), _) => list(ui, view, context, state),
            (None, Some(progress)) => examining(ui, progress, context),
            (None, None) => not_examined(ui, context),
        }
    });
    if is_asked_for_readings {
        state.select(Shown::Readings);
        if !view.readings.is_current && view.readings.progress.is_none() {
            context.commands.push(Command::RankReadings);
        }
    }
}

fn padded<R>(ui: &mut Ui, contents: impl FnOnce(&mut Ui) -> R) -> R {
    Frame::new().inner_margin(Margin::symmetric(16, 12)).show(ui, contents).inner
}

fn nothing_found(ui: &mut Ui, target: &Target) {
    padded(ui, |ui| {
        ui.horizontal(|ui| {
            ui.label(theme::heading("✔").color(theme::palette(ui).good));
            ui.label(theme::strong(fault_words::NOTHING_FOUND));
        });
        ui.add_space(8.0);
        ui.label(theme::dim(ui, words::CHECKED_TITLE));
        for line in words::checked(target) {
            ui.horizontal_top(|ui| {
                ui.label(theme::dim(ui, "✔"));
                ui.add(Label::new(*line).wrap());
            });
        }
    });
}

fn examining(ui: &mut Ui, progress: Progress, context: &mut PanelContext<'_>) {
    padded(ui, |ui| {
        ui.label(words::EXAMINING);
        ui.add_space(8.0);
        ui.add(ProgressBar::new(progress.fraction()).desired_height(6.0));
        ui.add_space(8.0);
        let button = ui.button(words::CANCEL);
        button.widget_info(|| WidgetInfo::labeled(Role::Button, true, words::CANCEL_DIAGNOSIS));
        if button.clicked() {
            context.commands.push(Command::CancelDiagnosis);
        }
    });
}

fn not_examined(ui: &mut Ui, context: &mut PanelContext<'_>) {
    padded(ui, |ui| {
        ui.label(words::NOT_EXAMINED);
        ui.add_space(8.0);
        if widgets::primary_button(ui, words::DIAGNOSE).clicked() {
            context.commands.push(Command::Diagnose);
        }
    });
}

fn list(ui: &mut Ui, view: &View<'_>, context: &mut PanelContext<'_>, state: &mut DiagnosisState) {
    let area = ScrollArea::vertical().id_salt("findings").auto_shrink([false, false]);
    let area = state.list_from_top.apply(area);
    area.show(ui, |ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        for (idx, finding) in view.findings().iter().enumerate() {
            card(ui, view, idx, finding, context, state);
        }
    });
    state.reveals_shown = false;
}

fn card(
    ui: &mut Ui,
    view: &View<'_>,
    idx: usize,
    finding: &Finding,
    context: &mut PanelContext<'_>,
    state: &mut DiagnosisState,
) {
    let palette = theme::palette(ui);
    let color = color(palette, finding.severity);
    let title = fault_words::fault_title(&finding.fault);
    let is_shown = state.shown == Shown::Finding(idx);
    let sensed = UiBuilder::new().id_salt(("finding", idx)).sense(Sense::click());
    let response = ui
        .scope_builder(sensed, |ui| {
            let is_hovered = ui.response().hovered();
            let fill = match (is_shown, is_hovered) {
                (true, _) => palette.selected,
                (false, true) => palette.hovered,
                (false, false) => Color32::TRANSPARENT,
            };
            let margin = Margin { left: 16, right: 12, top: 10, bottom: 10 };
            Frame::new().fill(fill).inner_margin(margin).show(ui, |ui| {
                ui.set_width(ui.available_width());
                ui.spacing_mut().item_spacing.y = 4.0;
                head(ui, finding.severity, title, color);
                contents(ui, view, idx, finding, context, state);
            });
        })
        .response;
    let name = words::finding_name(idx + 1, title);
    response.widget_info(|| WidgetInfo::selected(Role::ListBoxOption, true, is_shown, &name));
    let edge = Rect::from_min_size(response.rect.min, vec2(3.0, response.rect.height()));
    ui.painter().rect_filled(edge, 0.0, color);
    ui.painter().hline(response.rect.x_range(), response.rect.bottom(), egui::Stroke::new(1.0, palette.hairline));
    if response.clicked() {
        state.select(Shown::Finding(idx));
    }
    if is_shown && state.reveals_shown {
        response.scroll_to_me(None);
    }
}

fn head(ui: &mut Ui, severity: Severity, title: &str, color: Color32) {
    ui.horizontal(|ui| {
        ui.spacing_mut().interact_size.y = 18.0;
        ui.add(Label::new(theme::strong(fault_words::severity_mark(severity)).color(color)).selectable(false));
        ui.add(Label::new(theme::strong(title)).selectable(false).truncate());
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let name = theme::dim(ui, fault_words::severity_name(severity)).small().color(color);
            ui.add(Label::new(name).selectable(false));
        });
    });
}

fn contents(
    ui: &mut Ui,
    view: &View<'_>,
    idx: usize,
    finding: &Finding,
    context: &mut PanelContext<'_>,
    state: &mut DiagnosisState,
) {
    let message = fault_words::fault_message(&finding.fault, view.session);
    ui.add(Label::new(message).selectable(false).wrap());
    if let Some(figure) = model::figure(finding) {
        ui.add(Label::new(theme::dim(ui, figure)).selectable(false).wrap());
    }
    let advice = theme::dim(ui, fault_words::fault_remedy(&finding.fault, view.session));
    ui.add(Label::new(advice).selectable(false).wrap());
    let is_shown = state.shown == Shown::Finding(idx);
    if finding.remedy.is_none() && is_shown {
        return;
    }
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().interact_size.y = 26.0;
        if let Some(remedy) = &finding.remedy {
            let label = fault_words::remedy_label(remedy, view.session);
            let is_possible = view.remedy(idx).is_some();
            let button = ui.add_enabled_ui(is_possible, |ui| {
                if idx == 0 { widgets::primary_button(ui, &label) } else { ui.button(&label) }
            });
            let button = button.inner.on_disabled_hover_text(shell_words::OUT_OF_DATE_HINT);
            if button.clicked() {
                context.commands.push(Command::ApplyRemedy(remedy.clone()));
            }
        }
        if !is_shown {
            let button = ui.button(words::SHOW);
            let name = words::show_finding(fault_words::fault_title(&finding.fault));
            button.widget_info(|| WidgetInfo::labeled(Role::Button, true, &name));
            if button.clicked() {
                state.select(Shown::Finding(idx));
            }
        }
    });
}
