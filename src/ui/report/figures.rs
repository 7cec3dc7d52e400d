//! The figures on the page: drawn in the background when they first come in sight, one after the other.

use std::collections::HashMap;
use std::sync::Arc;

use egui::{Color32, ColorImage, Rect, Role, Sense, TextureHandle, TextureOptions, Ui, WidgetInfo, pos2, vec2};

use crate::app::jobs::{JobOutcome, Slot, Wake};
use crate::report::figure::Figure;
use crate::ui::theme;

/// A figure is not shown larger than this times its size in print.
const MOST_SCALE: f32 = 1.4;
/// Nor drawn finer than so many pixels a point of its own.
const MOST_PIXELS_A_POINT: f32 = 3.0;

/// What came of drawing a figure.
type Drawn = (String, Result<ColorImage, String>);

/// The figures of a report as textures.
#[derive(Default)]
pub(super) struct Figures {
    ready: HashMap<String, Result<TextureHandle, String>>,
    drawing: Slot<Drawn>,
    /// Which one is being drawn.
    in_work: Option<String>,
}

impl std::fmt::Debug for Figures {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.debug_struct("Figures").field("in_work", &self.in_work).finish_non_exhaustive()
    }
}

impl Figures {
    /// Whether one is being drawn.
    pub(super) const fn is_drawing(&self) -> bool {
        self.drawing.is_running()
    }

    /// Takes in what has been drawn.
    pub(super) fn poll(&mut self, ui: &Ui) {
        let Some(outcome) = self.drawing.poll() else { return };
        let broken = || crate::text::report_panel::NO_PICTURE.to_owned();
        let (id, image) = match outcome {
            JobOutcome::Done(drawn) => drawn,
            JobOutcome::Panicked | JobOutcome::NotStarted(_) => {
                (self.in_work.take().unwrap_or_default(), Err(broken()))
            }
        };
        self.in_work = None;
        let ready = image.map(|image| ui.ctx().load_texture(&id, image, TextureOptions::LINEAR));
        self.ready.insert(id, ready);
    }

    /// Shows a figure with its caption, or the room for it.
    pub(super) fn show(&mut self, ui: &mut Ui, figure: &Figure) {
        let [width, height] = figure.size_points().map(to_points);
        let scale = (ui.available_width() / width.max(1.0)).min(MOST_SCALE);
        let (rect, response) = ui.allocate_exact_size(vec2(width, height) * scale, Sense::hover());
        response.widget_info(|| WidgetInfo::labeled(Role::Image, true, &figure.alt));
        match self.ready.get(&figure.id) {
            Some(Ok(texture)) => {
                let whole = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
                ui.painter().image(texture.id(), rect, whole, Color32::WHITE);
            }
            Some(Err(reason)) => {
                let font = egui::FontId::proportional(theme::SMALL_SIZE);
                let color = theme::palette(ui).bad;
                ui.painter().text(rect.center(), egui::Align2::CENTER_CENTER, reason, font, color);
            }
            None if ui.is_rect_visible(rect) && !self.drawing.is_running() => {
                let pixels = (ui.ctx().pixels_per_point() * scale).min(MOST_PIXELS_A_POINT);
                self.draw(ui, figure.clone(), pixels);
            }
            None => {}
        }
        ui.add(egui::Label::new(theme::dim(ui, &figure.title)).wrap());
    }

    fn draw(&mut self, ui: &Ui, figure: Figure, pixels_per_point: f32) {
        let ctx = ui.ctx().clone();
        let wake: Wake = Arc::new(move || ctx.request_repaint());
        self.in_work = Some(figure.id.clone());
        self.drawing.start("draw figure", &wake, move |_| {
            let image = figure.png(f64::from(pixels_per_point)).map_err(|error| error.to_string());
            let image = image.map(|image| {
                let size = [image.width(), image.height()].map(|side| usize::try_from(side).unwrap_or(0));
                ColorImage::from_rgb(size, image.as_raw())
            });
            (figure.id, image)
        });
    }
}

#[expect(clippy::cast_precision_loss, reason = "sides of a page are far below 2^24")]
const fn to_points(side: u32) -> f32 {
    side as f32
}
