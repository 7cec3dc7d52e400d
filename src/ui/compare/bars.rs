//! Error per station: grouped bars, one colour a method.

use egui::{Align2, Id, Rect, Ui, pos2, vec2};

use crate::calibrate::Method;
use crate::report::comparison::{ErrorReference, MethodTable};
use crate::text::compare as text;
use crate::text::methods::method_short_name;
use crate::ui::charts::{self, Chart, Extent, LegendEntry, LegendGlyph};
use crate::ui::{theme, widgets};

/// Which errors the bars show.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BarSource {
    /// With each station predicted by the others.
    #[default]
    LeftOut,
    /// As in the tables.
    InSample,
}

/// Part of a station's place that its bars take together.
const GROUP_WIDTH: f64 = 0.62;

/// The legend of some methods.
pub fn method_legend(ui: &mut Ui, methods: impl Iterator<Item = Method>) {
    let entries: Vec<LegendEntry> = methods
        .map(|method| LegendEntry {
            glyph: LegendGlyph::Solid(theme::method_marker(method)),
            color: theme::method_color(method),
            text: method_short_name(method).to_owned(),
        })
        .collect();
    charts::legend(ui, &entries);
}

/// Shows the bars in the space available.
pub fn show(ui: &mut Ui, tables: &[(Method, &MethodTable)], source: BarSource, reference: ErrorReference) {
    method_legend(ui, tables.iter().map(|(method, _)| *method));
    let Some((_, first)) = tables.first() else { return };
    let names: Vec<String> = first.rows.iter().map(|row| row.label.clone()).collect();
    let error_mm = |table: &MethodTable, row_idx: usize| {
        let used = table.rows.get(row_idx)?.used.as_ref()?;
        match source {
            BarSource::LeftOut => used.leave_one_out_mm,
            BarSource::InSample => Some(used.error_mm(reference).norm()),
        }
    };
    let place = |row_idx: usize| f64::from(u32::try_from(row_idx).unwrap_or(u32::MAX));
    let bar_width = GROUP_WIDTH / place(tables.len());
    let mut bars = Vec::new();
    let mut extent = Extent { x: [-0.6, place(names.len()) - 0.4], y: [0.0, 0.0] };
    for (table_idx, (method, table)) in tables.iter().enumerate() {
        for row_idx in 0..names.len() {
            let Some(error_mm) = error_mm(table, row_idx) else { continue };
            let left = place(row_idx) - GROUP_WIDTH / 2.0 + bar_width * place(table_idx);
            extent.y[1] = extent.y[1].max(error_mm);
            bars.push((*method, row_idx, left, error_mm));
        }
    }
    if extent.y[1] <= 0.0 {
        extent.y[1] = 0.01;
    }
    let mut is_fitted = true;
    let height = ui.available_height();
    let mut chart = Chart::new(Id::unique("compare bars"), text::STATION_AXIS, text::ERROR_AXIS, height, extent);
    chart.x_names = Some(&names);
    let canvas = chart.show(ui, &mut is_fitted);
    let baseline = canvas.at(0.0, 0.0).y;
    let mut hovered = None;
    for (method, row_idx, left, error_mm) in bars {
        let gap = bar_width * 0.08;
        let top_left = canvas.at(left + gap, error_mm);
        let right = canvas.at(left + bar_width - gap, 0.0).x;
        // An error of nothing still shows that there is a value.
        let bar = Rect::from_min_max(pos2(top_left.x, top_left.y.min(baseline - 1.5)), pos2(right, baseline));
        canvas.painter.rect_filled(bar, 1.0, theme::method_color(method));
        if canvas.response.hover_pos().is_some_and(|pointer| bar.expand2(vec2(1.0, 6.0)).contains(pointer)) {
            hovered = Some((method, row_idx, error_mm, bar));
        }
    }
    let zero = egui::Stroke::new(1.0, theme::palette(ui).text_dim.gamma_multiply(0.6));
    canvas.painter.hline(canvas.rect().x_range(), baseline, zero);
    if let Some((method, row_idx, error_mm, bar)) = hovered {
        let words = text::station_readout(&names[row_idx], method_short_name(method), &widgets::fixed(error_mm, 4));
        canvas.note(ui, bar.center_top() - vec2(0.0, 4.0), Align2::CENTER_BOTTOM, &words, theme::palette(ui).text);
    }
}
