//! What the cameras saw at a frame: colour, depth, both on top of each other, and what the motion was found from.

use std::sync::Arc;

use egui::{
    Align2, Color32, ColorImage, CursorIcon, Pos2, Rect, Role, Sense, Stroke, TextureHandle, TextureOptions, Ui,
    WidgetInfo, pos2, vec2,
};

use crate::text::sequence as words;
use crate::ui::{save_picture, theme, widgets};

/// A point of the image, px from the centre of the first pixel.
pub(super) type Pixel = [f32; 2];

/// What is shown of a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub(super) enum Shown {
    /// The colour image.
    Color,
    /// The depth image as its camera saw it.
    Depth,
    /// Depth at the colour image's pixels, on top of it.
    Aligned,
    /// Where the motion was looked for.
    Features,
    /// From where in the frame before each feature came.
    #[default]
    Matches,
}

impl Shown {
    /// All of them, in the order in which they are offered.
    pub const ALL: [Self; 5] = [Self::Color, Self::Depth, Self::Aligned, Self::Features, Self::Matches];

    /// Its name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Color => words::COLOR,
            Self::Depth => words::DEPTH,
            Self::Aligned => words::ALIGNED,
            Self::Features => words::FEATURES,
            Self::Matches => words::MATCHES,
        }
    }

    /// What it is, in a sentence.
    pub const fn hint(self) -> &'static str {
        match self {
            Self::Color => words::COLOR_HINT,
            Self::Depth => words::DEPTH_HINT,
            Self::Aligned => words::ALIGNED_HINT,
            Self::Features => words::FEATURES_HINT,
            Self::Matches => words::MATCHES_HINT,
        }
    }

    const fn has_depth(self) -> bool {
        matches!(self, Self::Depth | Self::Aligned)
    }
}

/// A feature's way from the frame before.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Way {
    /// Where it was.
    pub from: Pixel,
    /// Where it is.
    pub to: Pixel,
    /// Whether the motion explains it.
    pub is_inlier: bool,
}

/// Distances of an image, mm; 0 where nothing was measured.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Distances {
    /// Pixels across.
    width: usize,
    /// Row by row.
    z_mm: Vec<f32>,
    /// Those between which nearly all are: what colours stand for.
    range_mm: Option<[f32; 2]>,
}

impl Distances {
    /// From rows of so many pixels.
    pub fn new(width: usize, z_mm: Vec<f32>) -> Self {
        let mut valid: Vec<f32> = z_mm.iter().copied().filter(|z_mm| *z_mm > 0.0).collect();
        valid.sort_unstable_by(f32::total_cmp);
        let at = |percent: usize| valid.get(valid.len().saturating_sub(1) * percent / 100).copied();
        let range_mm = at(1).zip(at(99)).map(|(near_mm, far_mm)| [near_mm, far_mm]);
        Self { width, z_mm, range_mm }
    }
}

/// Near to far, as even to the eye as the well-known turbo, without its extremes.
const DISTANCES: [Color32; 7] = [
    Color32::from_rgb(0xb4, 0x2a, 0x0a),
    Color32::from_rgb(0xf0, 0x7a, 0x1c),
    Color32::from_rgb(0xf2, 0xc7, 0x3a),
    Color32::from_rgb(0x8f, 0xdc, 0x5a),
    Color32::from_rgb(0x2c, 0xb8, 0xa6),
    Color32::from_rgb(0x38, 0x7c, 0xd6),
    Color32::from_rgb(0x30, 0x28, 0x78),
];
/// Nothing was measured.
const NO_DISTANCE: Color32 = Color32::from_gray(24);
/// How much of the colour image is left below distances.
const COLOR_BELOW: f32 = 0.45;

/// The colour of a distance between two ends.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    clippy::cast_sign_loss,
    reason = "a place among a few colours"
)]
fn distance_color(z_mm: f32, [near_mm, far_mm]: [f32; 2]) -> Color32 {
    let part = ((z_mm - near_mm) / (far_mm - near_mm).max(1.0)).clamp(0.0, 1.0);
    let last = DISTANCES.len() - 1;
    let place = part * last as f32;
    let below = (place as usize).min(last - 1);
    DISTANCES[below].lerp_to_gamma(DISTANCES[below + 1], place - below as f32)
}

/// Distances as colours; on top of an image where one of the same size is given.
pub(super) fn distances_image(distances: &Distances, below: Option<&ColorImage>) -> ColorImage {
    let range_mm = distances.range_mm.unwrap_or([0.0, 1.0]);
    let height = distances.z_mm.len() / distances.width.max(1);
    let pixels = distances.z_mm.iter().enumerate().map(|(idx, z_mm)| {
        let under = below.and_then(|image| image.pixels.get(idx).copied());
        match (*z_mm > 0.0, under) {
            (true, None) => distance_color(*z_mm, range_mm),
            (true, Some(under)) => distance_color(*z_mm, range_mm).lerp_to_gamma(under, COLOR_BELOW),
            (false, None) => NO_DISTANCE,
            (false, Some(under)) => under,
        }
    });
    ColorImage::new([distances.width, height], pixels.collect())
}

/// What is to be painted.
pub(super) struct Scene<'a> {
    /// What of it.
    pub shown: Shown,
    /// Another number, another frame.
    pub frame_key: u64,
    /// The dots, made where they are not on the screen yet.
    pub image: &'a dyn Fn() -> ColorImage,
    /// Distances at the pixels shown, for the readout and the scale.
    pub distances: Option<&'a Distances>,
    /// The features of the frame.
    pub features: &'a [Pixel],
    /// Their ways.
    pub ways: &'a [Way],
}

/// What the card remembers between frames.
#[derive(Default)]
pub(super) struct Picture {
    on_screen: Option<((Shown, u64), TextureHandle, Arc<ColorImage>)>,
}

impl std::fmt::Debug for Picture {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.debug_struct("Picture").field("key", &self.on_screen.as_ref().map(|(key, ..)| key)).finish()
    }
}

/// Radius of a feature, points.
const FEATURE_RADIUS: f32 = 2.0;
/// Room below the image for the scale of distances, points.
const SCALE_HEIGHT: f32 = 30.0;

impl Picture {
    /// Shows the frame in the space available, as large as it fits.
    pub fn show(&mut self, ui: &mut Ui, scene: &Scene<'_>) {
        let key = (scene.shown, scene.frame_key);
        if self.on_screen.as_ref().is_none_or(|(shown, ..)| *shown != key) {
            let image = Arc::new((scene.image)());
            let texture = match self.on_screen.take() {
                Some((_, mut texture, _)) => {
                    texture.set(Arc::clone(&image), TextureOptions::LINEAR);
                    texture
                }
                None => ui.ctx().load_texture("frame of a sequence", Arc::clone(&image), TextureOptions::LINEAR),
            };
            self.on_screen = Some((key, texture, image));
        }
        let Some((_, texture, image)) = &self.on_screen else { return };
        let (place, response) = ui.allocate_exact_size(ui.available_size(), Sense::hover());
        response.widget_info(|| WidgetInfo::labeled(Role::Image, true, words::picture_name(scene.shown.name())));
        let scale = scene.distances.filter(|_| scene.shown.has_depth()).and_then(|distances| distances.range_mm);
        let room = place.with_max_y(place.bottom() - if scale.is_some() { SCALE_HEIGHT } else { 0.0 }).shrink(6.0);
        let [width, height] = image.size.map(pixels);
        let zoom = (room.width() / width).min(room.height() / height).max(0.01);
        let rect = Rect::from_center_size(room.center(), vec2(width, height) * zoom);
        let painter = ui.painter().with_clip_rect(place.intersect(ui.clip_rect()));
        save_picture::keep_image(ui.ctx(), texture.id(), || Arc::clone(image));
        painter.image(texture.id(), rect, Rect::from_min_max(Pos2::ZERO, pos2(1.0, 1.0)), Color32::WHITE);
        // The centre of the first pixel has the coordinates 0, 0.
        let at = |[u, v]: Pixel| rect.min + vec2(u + 0.5, v + 0.5) * zoom;
        match scene.shown {
            Shown::Features => {
                for feature in scene.features {
                    painter.circle_stroke(
                        at(*feature),
                        FEATURE_RADIUS + 1.0,
                        Stroke::new(2.5, Color32::from_black_alpha(120)),
                    );
                    painter.circle_stroke(at(*feature), FEATURE_RADIUS + 1.0, Stroke::new(1.2, FEATURE));
                }
            }
            Shown::Matches => {
                // Inliers last, so that the way of the camera is not covered.
                for is_inlier in [false, true] {
                    for way in scene.ways.iter().filter(|way| way.is_inlier == is_inlier) {
                        let color = if is_inlier { MATCHED } else { MISMATCHED };
                        painter.line_segment([at(way.from), at(way.to)], Stroke::new(1.4, color));
                        painter.circle_filled(at(way.to), FEATURE_RADIUS, color);
                    }
                }
            }
            Shown::Color | Shown::Depth | Shown::Aligned => {}
        }
        if let Some(range_mm) = scale {
            paint_scale(ui, &painter, place, range_mm);
        }
        let Some(pointer) = response.hover_pos().filter(|pointer| rect.contains(*pointer)) else { return };
        ui.ctx().set_cursor_icon(CursorIcon::Crosshair);
        let [column, row] = [(pointer.x - rect.left()) / zoom, (pointer.y - rect.top()) / zoom].map(whole);
        let z_mm = scene
            .distances
            .filter(|distances| distances.width == image.width())
            .map(|distances| distances.z_mm.get(row * distances.width + column).copied().filter(|z_mm| *z_mm > 0.0));
        let distance = z_mm.map(|z_mm| z_mm.map(|z_mm| widgets::fixed(f64::from(z_mm) / 1000.0, 3)));
        let note = words::pixel_readout(column, row, distance.as_ref().map(Option::as_deref));
        let font = egui::FontId::proportional(theme::SMALL_SIZE);
        let galley = painter.layout_no_wrap(note, font, theme::palette(ui).text);
        let ground = Align2::LEFT_TOP.anchor_size(rect.left_top() + vec2(8.0, 8.0), galley.size());
        painter.rect_filled(ground.expand2(vec2(4.0, 2.0)), 2.0, theme::palette(ui).surface.gamma_multiply(0.9));
        painter.galley(ground.min, galley, theme::palette(ui).text);
    }
}

/// Legible on any image.
pub(super) const FEATURE: Color32 = Color32::from_rgb(0xff, 0xe0, 0x4a);
/// What the motion explains.
pub(super) const MATCHED: Color32 = Color32::from_rgb(0x3d, 0xf0, 0x9b);
/// What it does not.
pub(super) const MISMATCHED: Color32 = Color32::from_rgb(0xff, 0x5c, 0x5c);

#[expect(clippy::cast_precision_loss, reason = "a side of an image")]
const fn pixels(side: usize) -> f32 {
    side as f32
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a pixel of an image")]
fn whole(position: f32) -> usize {
    position.max(0.0) as usize
}

/// The colours of distances with the ends in metres.
fn paint_scale(ui: &Ui, painter: &egui::Painter, place: Rect, range_mm: [f32; 2]) {
    const STEPS: u8 = 96;
    let bar = Rect::from_center_size(place.center_bottom() - vec2(0.0, 19.0), vec2(place.width().min(260.0), 8.0));
    let ends = range_mm.map(|z_mm| f64::from(z_mm) / 1000.0);
    for step in 0..STEPS {
        let part = |step: u8| f32::from(step) / f32::from(STEPS);
        let z_mm = range_mm[0] + part(step) * (range_mm[1] - range_mm[0]);
        let x = bar.left() + part(step) * bar.width()..=bar.left() + part(step + 1) * bar.width() + 0.5;
        painter.rect_filled(Rect::from_x_y_ranges(x, bar.y_range()), 0.0, distance_color(z_mm, range_mm));
    }
    let font = egui::FontId::proportional(theme::SMALL_SIZE);
    let color = theme::palette(ui).text_dim;
    let [near, far] = ends.map(|z_m| widgets::fixed(z_m, 2));
    painter.text(bar.left_center() - vec2(8.0, 0.0), Align2::RIGHT_CENTER, near, font.clone(), color);
    painter.text(bar.right_center() + vec2(8.0, 0.0), Align2::LEFT_CENTER, words::metres(&far), font, color);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_not_measured_is_dark_or_shows_what_is_below() {
        let distances = Distances::new(2, vec![0.0, 500.0, 1500.0, 0.0]);
        assert_eq!(distances.range_mm, Some([500.0, 500.0]));
        let plain = distances_image(&distances, None);
        assert_eq!(plain.size, [2, 2]);
        assert_eq!([plain.pixels[0], plain.pixels[3]], [NO_DISTANCE; 2]);
        assert_ne!(plain.pixels[1], plain.pixels[2]);
        let below = ColorImage::filled([2, 2], Color32::WHITE);
        let both = distances_image(&distances, Some(&below));
        assert_eq!([both.pixels[0], both.pixels[3]], [Color32::WHITE; 2]);
        assert!(distances_image(&Distances::new(1, vec![0.0]), None).pixels == [NO_DISTANCE]);
    }
}
