//! Curves over the time of a sequence: one frame is marked in all of them, and a click goes to another.

use egui::{Align2, Color32, Id, Pos2, Rect, Shape, Stroke, Ui, pos2, vec2};

use crate::text::sequence as words;
use crate::ui::charts::{self, Canvas, Chart, Extent, LegendEntry, LegendGlyph, marker};
use crate::ui::{theme, widgets};

/// One value a frame.
#[derive(Clone, Debug)]
pub(super) struct Curve {
    /// What the legend calls it.
    pub name: &'static str,
    /// Its colour.
    pub color: Color32,
    /// Whether it is dashed, as truths are.
    pub is_dashed: bool,
    /// Time, s, and value of a frame; where there is none, the curve has a gap.
    pub values: Vec<(f64, Option<f64>)>,
}

/// Curves that share an axis.
#[derive(Clone, Debug)]
pub(super) struct OverTime<'a> {
    /// Unique name in the window.
    pub id: &'static str,
    /// Title of the y axis with its unit.
    pub y_title: &'a str,
    /// Digits behind the point of a readout.
    pub decimals: usize,
    /// The curves.
    pub curves: Vec<Curve>,
    /// Times between which the motion was not tracked, s.
    pub lost_s: &'a [[f64; 2]],
    /// The time of the frame in sight, s.
    pub current_s: Option<f64>,
    /// Whether the y axis reaches down to zero.
    pub is_from_zero: bool,
    /// Whether the curves are named; not where the plot above has named them, or there is one.
    pub has_legend: bool,
}

/// Room above a plot without a legend, points.
const ROOM_ABOVE: f32 = 8.0;
/// All of them share their x range.
const GROUP: &str = "sequence over time";

impl OverTime<'_> {
    /// Shows the curves in a height; answers the time that was clicked, s.
    pub fn show(&self, ui: &mut Ui, height: f32, is_first: bool, is_fitted: &mut bool) -> Option<f64> {
        let top = ui.cursor().top();
        if self.has_legend {
            let entries: Vec<LegendEntry> = self.curves.iter().map(Curve::entry).collect();
            charts::legend(ui, &entries);
        } else {
            ui.add_space(ROOM_ABOVE);
        }
        let taken = ui.cursor().top() - top;
        let mut chart =
            Chart::new(Id::unique(self.id), words::TIME_AXIS, self.y_title, (height - taken).max(1.0), self.extent());
        chart.x_group = Some(Id::unique(GROUP));
        chart.follows_x = !is_first;
        let canvas = chart.show(ui, is_fitted);
        self.paint(ui, &canvas);
        let pointer = canvas.response.hover_pos()?;
        let pointed_s = canvas.transform.value_from_position(pointer).x;
        self.readout(ui, &canvas, pointed_s);
        canvas.response.clicked().then_some(pointed_s)
    }

    fn extent(&self) -> Extent {
        let mut extent = Extent::NOTHING;
        for curve in &self.curves {
            for (time_s, value) in &curve.values {
                // The time axis is that of all frames, tracked or not.
                extent.include(*time_s, value.unwrap_or(if self.is_from_zero { 0.0 } else { f64::NAN }));
            }
        }
        if self.is_from_zero && extent.y[0] <= extent.y[1] {
            extent.y[0] = extent.y[0].min(0.0);
        }
        extent
    }

    fn paint(&self, ui: &Ui, canvas: &Canvas) {
        let palette = theme::palette(ui);
        let rect = canvas.rect();
        for [from_s, to_s] in self.lost_s {
            let [left, right] = [from_s, to_s].map(|time_s| canvas.at(*time_s, 0.0).x);
            let band = Rect::from_x_y_ranges(left..=right.max(left + 1.0), rect.y_range());
            canvas.painter.rect_filled(band, 0.0, palette.bad.gamma_multiply(0.10));
        }
        for curve in &self.curves {
            curve.paint(canvas);
        }
        if let Some(time_s) = self.current_s {
            let x = canvas.at(time_s, 0.0).x;
            canvas.painter.vline(x, rect.y_range(), Stroke::new(1.0, palette.accent));
            for curve in &self.curves {
                if let Some((at_s, Some(value))) = curve.nearest(time_s) {
                    let at = canvas.at(at_s, value);
                    marker(&canvas.painter, egui_plot::MarkerShape::Circle, at, 3.2, curve.color, Stroke::NONE);
                }
            }
        }
    }

    /// The values of the frame under the pointer.
    fn readout(&self, ui: &Ui, canvas: &Canvas, pointed_s: f64) {
        let mut lines = Vec::new();
        let mut at_s = None;
        for curve in &self.curves {
            let Some((time_s, value)) = curve.nearest(pointed_s) else { continue };
            at_s = at_s.or(Some(time_s));
            let text = value.map_or_else(|| words::NO_VALUE.to_owned(), |value| widgets::fixed(value, self.decimals));
            lines.push(format!("{} {text}", curve.name));
        }
        let Some(at_s) = at_s else { return };
        let text = words::readout(&widgets::fixed(at_s, 2), &lines.join(" · "));
        let x = canvas.at(at_s, 0.0).x;
        let palette = theme::palette(ui);
        canvas.painter.vline(x, canvas.rect().y_range(), Stroke::new(1.0, palette.text_dim.gamma_multiply(0.5)));
        canvas.note(ui, pos2(x, canvas.rect().top()) + vec2(8.0, 6.0), Align2::LEFT_TOP, &text, palette.text);
    }
}

impl Curve {
    fn entry(&self) -> LegendEntry {
        let glyph = if self.is_dashed { LegendGlyph::Dashed } else { LegendGlyph::Line };
        LegendEntry { glyph, color: self.color, text: self.name.to_owned() }
    }

    /// The frame nearest in time.
    fn nearest(&self, time_s: f64) -> Option<(f64, Option<f64>)> {
        let after = self.values.partition_point(|(at_s, _)| *at_s < time_s);
        let around = [after.checked_sub(1), Some(after)].into_iter().flatten();
        around
            .filter_map(|idx| self.values.get(idx).copied())
            .min_by(|(a, _), (b, _)| (a - time_s).abs().total_cmp(&(b - time_s).abs()))
    }

    fn paint(&self, canvas: &Canvas) {
        let stroke = Stroke::new(1.6, self.color);
        for run in runs(&self.values, |time_s, value| canvas.at(time_s, value)) {
            if self.is_dashed {
                charts::dashed_line(&canvas.painter, &run, stroke);
            } else if let [only] = run[..] {
                canvas.painter.circle_filled(only, 1.6, self.color);
            } else {
                canvas.painter.add(Shape::line(run, stroke));
            }
        }
    }
}

/// The stretches without a gap, on the screen.
fn runs(values: &[(f64, Option<f64>)], at: impl Fn(f64, f64) -> Pos2) -> Vec<Vec<Pos2>> {
    let mut runs = vec![Vec::new()];
    for (time_s, value) in values {
        match (value, runs.last_mut()) {
            (Some(value), Some(run)) => run.push(at(*time_s, *value)),
            (None, Some(run)) if !run.is_empty() => runs.push(Vec::new()),
            _ => {}
        }
    }
    runs.retain(|run| !run.is_empty());
    runs
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gap_ends_a_run() {
        let values = [(0.0, Some(1.0)), (1.0, Some(2.0)), (2.0, None), (3.0, None), (4.0, Some(3.0))];
        #[expect(clippy::cast_possible_truncation, reason = "small whole numbers")]
        let runs = runs(&values, |time_s, value| pos2(time_s as f32, value as f32));
        assert_eq!(runs, [vec![pos2(0.0, 1.0), pos2(1.0, 2.0)], vec![pos2(4.0, 3.0)]]);
    }

    #[test]
    fn the_nearest_frame_is_found_beyond_both_ends() {
        let values = vec![(1.0, Some(1.0)), (2.0, None), (4.0, Some(3.0))];
        let curve = Curve { name: "", color: Color32::BLACK, is_dashed: false, values };
        for (time_s, found) in [(-5.0, 1.0), (1.4, 1.0), (1.6, 2.0), (2.9, 2.0), (3.1, 4.0), (9.0, 4.0)] {
            assert_eq!(curve.nearest(time_s).map(|(at_s, _)| at_s), Some(found));
        }
    }
}
