//! The frame that all plots share: axes with units, few grid lines, one way to fit, pan and zoom, and the painting of
//! data on top. `egui_plot` keeps axes and view; the data is painted here, so that every mark looks the same everywhere
//! and 10⁵ points cost no more than the pixels they cover.

mod legend;
mod marks;

use egui::{Id, Painter, Pos2, Rangef, Rect, Response, Sense, Ui, UiBuilder, pos2, vec2};
use egui_plot::{AxisHints, GridInput, GridMark, Plot, PlotPoint, PlotTransform};

use crate::report::figure::{multiples, round_step, tick_label};
use crate::ui::theme;

pub use crate::report::figure::Extent;

pub use legend::{LegendEntry, LegendGlyph, legend};
pub use marks::{arrow, dashed_circle, dashed_line, dotted_line, ellipse, error_bar, marker, thinned};

/// Grid lines of the y axis stand at least this far apart, points.
const GRID_SPACING: f32 = 28.0;
/// Those of the x axis so many times as far, because their labels stand side by side.
const X_SPACING_FACTOR: f64 = 1.7;
/// Room for the tick labels and the title of a y axis, points; fixed, so that plots above each other line up.
const Y_AXIS_WIDTH: f32 = 58.0;
/// Room between a card's border and the title of the y axis, points.
const LEFT_MARGIN: f32 = 6.0;
/// Room for the half of the last tick label that stands beyond the axis, points.
const RIGHT_MARGIN: f32 = 14.0;

/// A plot to be shown.
pub struct Chart<'a> {
    /// Unique name in the window.
    pub id: Id,
    /// Title of the x axis with its unit.
    pub x_title: &'a str,
    /// Title of the y axis with its unit.
    pub y_title: &'a str,
    /// Height over all, points.
    pub height: f32,
    /// What to show when fitted.
    pub extent: Extent,
    /// Whether y grows downwards.
    pub invert_y: bool,
    /// Whether a millimetre is equally long both ways.
    pub has_equal_scales: bool,
    /// Plots of the same group share their x range; the first one shown leads.
    pub x_group: Option<Id>,
    /// Whether this plot takes its x range from the group.
    pub follows_x: bool,
    /// Names for the marks of the x axis in place of numbers; mark `n` stands at x = n.
    pub x_names: Option<&'a [String]>,
}

impl<'a> Chart<'a> {
    /// A plain plot; set the other fields as needed.
    #[must_use]
    pub fn new(id: Id, x_title: &'a str, y_title: &'a str, height: f32, extent: Extent) -> Self {
        Self {
            id,
            x_title,
            y_title,
            height,
            extent,
            invert_y: false,
            has_equal_scales: false,
            x_group: None,
            follows_x: false,
            x_names: None,
        }
    }

    /// Shows axes and grid. `is_fitted` becomes false when the user pans or zooms, and true on a double click.
    pub fn show(self, ui: &mut Ui, is_fitted: &mut bool) -> Canvas {
        let palette = theme::palette(ui);
        let tick_font = egui::FontId::proportional(theme::SMALL_SIZE);
        let title = |text: &str| theme::dim(ui, text).size(theme::SMALL_SIZE);
        let names = self.x_names.map(<[String]>::to_vec);
        let name_width = self.x_names.map_or(0.0, |names| widest(ui, names, &tick_font));
        let x_axis = AxisHints::new_x()
            .label(title(self.x_title))
            .tick_label_font(tick_font.clone())
            .tick_label_color(palette.text_dim)
            .label_spacing(Rangef::new(8.0, 9.0))
            .formatter(move |mark, _| match &names {
                Some(names) => name_at(names, mark.value),
                None => tick(mark),
            });
        let y_axis = AxisHints::new_y()
            .label(title(self.y_title))
            .tick_label_font(tick_font)
            .tick_label_color(palette.text_dim)
            .label_spacing(Rangef::new(8.0, 9.0))
            .min_thickness(Y_AXIS_WIDTH)
            .formatter(|mark, _| tick(mark));
        let has_names = self.x_names.is_some();
        let mut plot = Plot::new(self.id)
            .id(self.id)
            .height(self.height)
            .show_background(false)
            .allow_scroll(false)
            .allow_axis_zoom_drag(false)
            .allow_drag(!has_names)
            .allow_zoom(!has_names)
            .allow_boxed_zoom(!has_names)
            .show_x(false)
            .show_y(false)
            .invert_y(self.invert_y)
            .grid_color(palette.hairline)
            .grid_fade(0.0)
            .grid_spacing(Rangef::new(GRID_SPACING, GRID_SPACING + 1.0))
            .x_grid_spacer(
                move |input| if has_names { whole_marks(&input, name_width) } else { marks(&input, X_SPACING_FACTOR) },
            )
            .y_grid_spacer(|input| marks(&input, 1.0))
            .custom_x_axes(vec![x_axis])
            .custom_y_axes(vec![y_axis]);
        if self.has_equal_scales {
            plot = plot.data_aspect(1.0);
        }
        if let Some(group) = self.x_group {
            plot = plot.link_axis(group, [true, false]);
        }
        if has_names {
            // One mark a name, however close; those without room for their label are left out by the axis.
            plot = plot.show_grid([false, true]);
        }
        let mut fitted = *is_fitted;
        let extent = self.extent.with_margin();
        let (outer, _) = ui.allocate_exact_size(vec2(ui.available_width(), self.height), Sense::hover());
        let inner = Rect::from_min_max(outer.min + vec2(LEFT_MARGIN, 0.0), outer.max - vec2(RIGHT_MARGIN, 0.0));
        let mut inside = ui.new_child(UiBuilder::new().max_rect(inner));
        let shown = plot.show(&mut inside, |plot_ui| {
            let response = plot_ui.response();
            if response.dragged()
                || (response.hovered() && plot_ui.ctx().input(|input| input.zoom_delta() - 1.0).abs() > 0.0)
            {
                fitted = has_names;
            }
            if response.double_clicked() {
                fitted = true;
            }
            if fitted {
                let size = response.rect.size();
                let view = if self.has_equal_scales {
                    extent.with_equal_scales(f64::from(size.x.max(1.0)), f64::from(size.y.max(1.0)))
                } else {
                    extent
                };
                if !self.follows_x {
                    plot_ui.set_plot_bounds_x(view.x[0]..=view.x[1]);
                }
                plot_ui.set_plot_bounds_y(view.y[0]..=view.y[1]);
            }
            fitted
        });
        *is_fitted = shown.inner;
        Canvas {
            painter: ui.painter().with_clip_rect(shown.response.rect.intersect(ui.clip_rect())),
            transform: shown.transform,
            response: shown.response,
        }
    }
}

/// Where data is painted.
pub struct Canvas {
    /// Clipped to the plot.
    pub painter: Painter,
    /// From data to points on the screen.
    pub transform: PlotTransform,
    /// The pointer's doings.
    pub response: Response,
}

impl Canvas {
    /// Where a value stands on the screen.
    #[must_use]
    pub fn at(&self, x: f64, y: f64) -> Pos2 {
        self.transform.position_from_point(&PlotPoint::new(x, y))
    }

    /// Length of a data unit along x, points.
    #[must_use]
    #[expect(clippy::cast_possible_truncation, reason = "screen coordinates")]
    pub fn scale(&self) -> f32 {
        self.transform.dpos_dvalue_x().abs() as f32
    }

    /// The plot's rectangle.
    #[must_use]
    pub const fn rect(&self) -> Rect {
        self.response.rect
    }

    /// The item nearest to the pointer, within a finger's width.
    pub fn hovered<T>(&self, items: impl IntoIterator<Item = (T, [f64; 2])>) -> Option<T> {
        const REACH: f32 = 10.0;
        let pointer = self.response.hover_pos()?;
        items
            .into_iter()
            .map(|(item, [x, y])| (item, self.at(x, y).distance_sq(pointer)))
            .filter(|(_, distance_sq)| *distance_sq <= REACH * REACH)
            .min_by(|(_, a), (_, b)| a.total_cmp(b))
            .map(|(item, _)| item)
    }

    /// A short text with its ground, kept inside the plot.
    pub fn note(&self, ui: &Ui, anchor: Pos2, align: egui::Align2, text: &str, color: egui::Color32) {
        let galley = ui.painter().layout_no_wrap(text.to_owned(), egui::FontId::proportional(theme::SMALL_SIZE), color);
        let rect = self.kept_inside(align.anchor_size(anchor, galley.size()));
        // A veil, so that the text is legible across lines and points.
        self.painter.rect_filled(rect.expand2(vec2(3.0, 1.0)), 2.0, theme::palette(ui).surface.gamma_multiply(0.8));
        self.painter.galley(rect.min, galley, color);
    }

    /// Where [`Self::note`] would put a text.
    #[must_use]
    pub fn note_rect(&self, ui: &Ui, anchor: Pos2, align: egui::Align2, text: &str) -> Rect {
        let font = egui::FontId::proportional(theme::SMALL_SIZE);
        let galley = ui.painter().layout_no_wrap(text.to_owned(), font, egui::Color32::PLACEHOLDER);
        self.kept_inside(align.anchor_size(anchor, galley.size()))
    }

    fn kept_inside(&self, wanted: Rect) -> Rect {
        let room = self.rect().shrink(4.0);
        let left = wanted.left().clamp(room.left(), (room.right() - wanted.width()).max(room.left()));
        let top = wanted.top().clamp(room.top(), (room.bottom() - wanted.height()).max(room.top()));
        Rect::from_min_size(pos2(left, top), wanted.size())
    }
}

fn tick(mark: GridMark) -> String {
    tick_label(mark.value, mark.step_size)
}

fn name_at(names: &[String], value: f64) -> String {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "saturates; out of range has no name")]
    names.get(value.max(-1.0).round() as usize).filter(|_| value > -0.5).cloned().unwrap_or_default()
}

/// Grid lines at 1, 2 or 5 times a power of ten.
fn marks(input: &GridInput, factor: f64) -> Vec<GridMark> {
    round_step(input.base_step_size * factor * 1.05).map_or_else(Vec::new, |step| spaced(input.bounds, step))
}

/// Every name, or every n-th where they are too wide to stand side by side.
fn whole_marks(input: &GridInput, name_width: f32) -> Vec<GridMark> {
    // The base step is what a grid line takes.
    let room = f64::from(GRID_SPACING) / input.base_step_size;
    let step = (f64::from(name_width) / room).ceil();
    spaced(input.bounds, if step.is_finite() { step.max(1.0) } else { 1.0 })
}

/// Width of the widest name with a gap beside it, points.
fn widest(ui: &Ui, names: &[String], font: &egui::FontId) -> f32 {
    const GAP: f32 = 10.0;
    let width =
        |name: &String| ui.painter().layout_no_wrap(name.clone(), font.clone(), egui::Color32::PLACEHOLDER).size().x;
    names.iter().map(width).fold(0.0, f32::max) + GAP
}

fn spaced((low, high): (f64, f64), step: f64) -> Vec<GridMark> {
    multiples([low, high], step).into_iter().map(|value| GridMark { value, step_size: step }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_without_room_are_thinned_evenly() {
        // Ten points a name, and names of 24.
        let input = GridInput { bounds: (-0.6, 19.6), base_step_size: f64::from(GRID_SPACING) / 10.0 };
        let values: Vec<f64> = whole_marks(&input, 24.0).iter().map(|mark| mark.value).collect();
        assert_eq!(values.len(), 7, "{values:?}");
        assert!(values.windows(2).all(|pair| (pair[1] - pair[0] - 3.0).abs() < 1e-9), "{values:?}");
    }
}
