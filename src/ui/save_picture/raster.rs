//! Pictures as dots: twice as fine as the screen, so that print shows no steps.

use std::collections::HashMap;
use std::io::Cursor;
use std::sync::Arc;

use egui::{Context, ImageData, LayerId, Pos2, RawInput, Rect, Shape, TextureId, TextureOptions, Theme, ViewportId};
use image::RgbaImage;

use crate::ui::software_renderer::SoftwareRenderer;
use crate::ui::theme;

use super::Picture;

/// Dots a point.
const DOTS_A_POINT: f32 = 2.0;

/// Paints a picture on white.
pub(super) fn image(picture: &Picture) -> RgbaImage {
    // A context of its own: letters are laid out anew for the finer dots.
    let ctx = Context::default();
    theme::install(&ctx);
    ctx.set_theme(Theme::Light);
    let handles: HashMap<TextureId, _> = picture
        .images()
        .iter()
        .map(|(id, image)| {
            let handle = ctx.load_texture("of the plot", ImageData::Color(Arc::clone(image)), TextureOptions::LINEAR);
            (*id, handle)
        })
        .collect();
    let textures: HashMap<TextureId, TextureId> = handles.iter().map(|(id, handle)| (*id, handle.id())).collect();
    let sheet = Rect::from_min_size(Pos2::ZERO, picture.size());
    let mut input = RawInput { screen_rect: Some(sheet), ..RawInput::default() };
    input.viewports.entry(ViewportId::ROOT).or_default().native_pixels_per_point = Some(DOTS_A_POINT);
    let mut output = ctx.run_ui(input, |ui| {
        let ctx = ui.ctx();
        let painter = ctx.layer_painter(LayerId::background());
        painter.rect_filled(sheet, 0.0, egui::Color32::WHITE);
        for clipped in picture.shapes() {
            let mut shape = clipped.shape.clone();
            set_anew(ctx, &mut shape, &textures);
            painter.with_clip_rect(clipped.clip_rect).add(shape);
        }
    });
    let mut renderer = SoftwareRenderer::default();
    renderer.update_textures(&mut output.textures_delta);
    let primitives = ctx.tessellate(output.shapes, output.pixels_per_point);
    let dots = picture.size() * DOTS_A_POINT;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "sides of a part of the window")]
    renderer.paint(&primitives, output.pixels_per_point, [dots.x as u32, dots.y as u32])
}

/// Letters laid out for this context, and its own textures.
fn set_anew(ctx: &Context, shape: &mut Shape, textures: &HashMap<TextureId, TextureId>) {
    match shape {
        Shape::Vec(shapes) => shapes.iter_mut().for_each(|shape| set_anew(ctx, shape, textures)),
        Shape::Text(text) => {
            let job = (*text.galley.job).clone();
            text.galley = ctx.fonts_mut(|fonts| fonts.layout_job(job));
        }
        Shape::Mesh(mesh) => {
            if let Some(own) = textures.get(&mesh.texture_id) {
                Arc::make_mut(mesh).texture_id = *own;
            }
        }
        Shape::Rect(rect) => {
            if let Some(brush) = &mut rect.brush
                && let Some(own) = textures.get(&brush.fill_texture_id)
            {
                Arc::make_mut(brush).fill_texture_id = *own;
            }
        }
        _ => {}
    }
}

/// The file of an image.
pub(super) fn png(image: &RgbaImage) -> Vec<u8> {
    let mut file = Cursor::new(Vec::new());
    // Memory takes all that is written into it, and the size is that of the picture.
    image.write_to(&mut file, image::ImageFormat::Png).ok();
    file.into_inner()
}
