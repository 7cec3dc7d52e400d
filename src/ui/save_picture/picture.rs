//! What was painted of a plot, taken out of the window.

use std::sync::Arc;

use egui::emath::TSTransform;
use egui::epaint::{ClippedShape, TextShape};
use egui::{ColorImage, Rect, Shape, TextureId, Ui, Vec2, pos2, vec2};

use crate::ui::theme;

/// White around the plot, points.
const MARGIN: f32 = 16.0;
/// From the title's top to the plot's, points.
const TITLE_HEIGHT: f32 = 24.0;

/// A plot with its title above it, on a sheet whose corner is the origin.
#[derive(Clone)]
pub struct Picture {
    title: String,
    size: Vec2,
    shapes: Vec<ClippedShape>,
    images: Vec<(TextureId, Arc<ColorImage>)>,
}

impl Picture {
    /// A picture of what was painted within a rectangle of the window.
    pub(super) fn new(
        ui: &Ui,
        title: &str,
        extent: Rect,
        painted: Vec<ClippedShape>,
        images: Vec<(TextureId, Arc<ColorImage>)>,
    ) -> Self {
        let palette = theme::palette_of(&ui.ctx().style_of(egui::Theme::Light).visuals);
        let galley = ui.painter().layout_no_wrap(title.to_owned(), theme::strong_font(), palette.text);
        let width = extent.width().max(galley.size().x);
        let size = (vec2(width, extent.height() + TITLE_HEIGHT) + Vec2::splat(2.0 * MARGIN)).ceil();
        let sheet = Rect::from_min_size(pos2(0.0, 0.0), size);
        let heading = TextShape::new(pos2(MARGIN, MARGIN), galley, palette.text);
        let mut shapes = vec![ClippedShape::new(sheet, Shape::Text(heading))];
        let onto_sheet = TSTransform::from_translation(vec2(MARGIN, MARGIN + TITLE_HEIGHT) - extent.min.to_vec2());
        shapes.extend(painted.into_iter().map(|mut clipped| {
            // Strokes and letters at the border may reach a little over it.
            clipped.clip_rect = clipped.clip_rect.intersect(extent.expand(MARGIN / 2.0));
            clipped.transform(onto_sheet);
            clipped
        }));
        shapes.retain(|clipped| clipped.clip_rect.is_positive() && clipped.shape != Shape::Noop);
        Self { title: title.to_owned(), size, shapes, images }
    }

    /// What it shows.
    pub(super) fn title(&self) -> &str {
        &self.title
    }

    /// Size of the sheet, points.
    pub(super) const fn size(&self) -> Vec2 {
        self.size
    }

    /// What stands on it, the first lowest.
    pub(super) fn shapes(&self) -> &[ClippedShape] {
        &self.shapes
    }

    /// The dots of textures that it uses.
    pub(super) fn images(&self) -> &[(TextureId, Arc<ColorImage>)] {
        &self.images
    }

    /// A file name for it, without its ending.
    pub(super) fn file_stem(&self) -> String {
        let lower = self.title.to_lowercase();
        let words: Vec<&str> = lower.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty()).collect();
        if words.is_empty() { "picture".to_owned() } else { words.join("-") }
    }
}
