//! Any plot of the window as a picture: as PNG or SVG file, or on the clipboard.
//!
//! A plot is drawn inside [`saveable`], which notes what was painted. When a picture is wanted, the plot is drawn once more,
//! in the colours of print and whole even where it is half scrolled out of sight, and what the window shows in that frame is
//! put back: nothing blinks. The shapes are then turned into a file in the background.

mod picture;
mod raster;
mod svg;

use std::sync::Arc;

use egui::epaint::ClippedShape;
use egui::layers::ShapeIdx;
use egui::{
    Align, ColorImage, Context, Id, LayerId, Layout, Popup, PopupAnchor, PopupKind, Rect, SetOpenCommand, Shape,
    TextureId, Theme, Ui,
};

use crate::text::report_panel as words;

use super::file_dialog::Purpose;
use super::save_file::SaveFile;

pub use picture::Picture;

/// What becomes of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PictureUse {
    /// A file of dots, for documents.
    Png,
    /// A file of lines and text, for print.
    Svg,
    /// The clipboard.
    Copy,
}

impl PictureUse {
    /// All of them, in the order of menus.
    pub const ALL: [Self; 3] = [Self::Png, Self::Svg, Self::Copy];

    const fn label(self) -> &'static str {
        match self {
            Self::Png => words::SAVE_PNG,
            Self::Svg => words::SAVE_SVG,
            Self::Copy => words::COPY_PICTURE,
        }
    }
}

/// A picture that is ready to leave the window.
#[derive(Clone, Debug)]
pub enum Drawn {
    /// As a file.
    File(SaveFile),
    /// On the clipboard.
    Image(ColorImage),
}

/// Draws a picture for its use; it takes a while.
#[must_use]
pub fn draw(picture: &Picture, becomes: PictureUse) -> Drawn {
    let file = |ending: &str, contents: Vec<u8>| {
        let name = format!("{}.{ending}", picture.file_stem());
        Drawn::File(SaveFile { purpose: Purpose::Picture, name, contents: contents.into() })
    };
    match becomes {
        PictureUse::Png => file("png", raster::png(&raster::image(picture))),
        PictureUse::Svg => file("svg", svg::text(picture).into_bytes()),
        PictureUse::Copy => {
            let image = raster::image(picture);
            let size = [image.width(), image.height()].map(|side| usize::try_from(side).unwrap_or(0));
            Drawn::Image(ColorImage::from_rgba_unmultiplied(size, image.as_raw()))
        }
    }
}

/// What is known of the plots in sight.
#[derive(Clone, Default)]
struct Plots {
    /// Those of this frame so far.
    seen: Vec<(Id, String)>,
    /// Those of the frame before.
    before: Vec<(Id, String)>,
    wanted: Option<Wanted>,
    ready: Option<(Picture, PictureUse)>,
}

#[derive(Clone)]
struct Wanted {
    id: Id,
    becomes: PictureUse,
    /// What the window showed, once that is known.
    on_screen: Option<Vec<ClippedShape>>,
    /// Textures that the plot uses.
    images: Vec<(TextureId, Arc<ColorImage>)>,
    /// Frames until the plot counts as gone.
    patience: u8,
}

/// A plot is drawn again in the next frame, unless it is not there any more.
const PATIENCE: u8 = 4;

fn with<R>(ctx: &Context, change: impl FnOnce(&mut Plots) -> R) -> R {
    ctx.data_mut(|data| change(data.get_temp_mut_or_default(Id::unique("plots in sight"))))
}

/// To be called once a frame, before anything is drawn.
pub fn begin_frame(ctx: &Context) {
    let is_waiting = with(ctx, |plots| {
        plots.before = std::mem::take(&mut plots.seen);
        plots.wanted = plots.wanted.take().and_then(|wanted| {
            let patience = wanted.patience.checked_sub(1)?;
            Some(Wanted { patience, ..wanted })
        });
        plots.wanted.is_some()
    });
    if is_waiting {
        ctx.request_repaint();
    }
}

/// The picture that was taken in this frame, once.
#[must_use]
pub fn take(ctx: &Context) -> Option<(Picture, PictureUse)> {
    with(ctx, |plots| plots.ready.take())
}

/// Lists the plots in sight in a menu, each with what can become of it: the way for those who use no pointer.
pub fn menu(ui: &mut Ui) {
    let plots = with(ui.ctx(), |plots| plots.before.clone());
    ui.add_enabled_ui(!plots.is_empty(), |ui| {
        ui.menu_button(words::PICTURES, |ui| {
            for (id, title) in plots {
                ui.menu_button(title, |ui| entries(ui, id, None));
            }
        })
        .response
        .on_disabled_hover_text(words::NO_PICTURES);
    });
}

fn entries(ui: &mut Ui, id: Id, on_screen: Option<&[ClippedShape]>) {
    for becomes in PictureUse::ALL {
        if ui.button(becomes.label()).clicked() {
            let on_screen = on_screen.map(<[_]>::to_vec);
            let wanted = Wanted { id, becomes, on_screen, images: Vec::new(), patience: PATIENCE };
            with(ui.ctx(), |plots| plots.wanted = Some(wanted));
            ui.ctx().request_repaint();
            ui.close();
        }
    }
}

/// Hands over the dots of a texture that the plot uses, if a picture is being taken of it.
pub fn keep_image(ctx: &Context, texture: TextureId, image: impl FnOnce() -> Arc<ColorImage>) {
    let is_wanted = with(ctx, |plots| plots.wanted.as_ref().is_some_and(|wanted| wanted.on_screen.is_some()));
    if is_wanted {
        let image = image();
        with(ctx, |plots| {
            if let Some(wanted) = &mut plots.wanted {
                wanted.images.push((texture, image));
            }
        });
    }
}

/// Draws a plot that can be saved: a right click offers it, and so does the File menu.
pub fn saveable<R>(ui: &mut Ui, title: &str, contents: impl FnOnce(&mut Ui) -> R) -> R {
    let ctx = ui.ctx().clone();
    let layer = ui.layer_id();
    let id = ui.scope_id().with(("picture", title));
    let place = ui.available_rect_before_wrap();
    let is_taken = with(&ctx, |plots| {
        plots.seen.push((id, title.to_owned()));
        plots.wanted.as_ref().is_some_and(|wanted| wanted.id == id && wanted.on_screen.is_some())
    });
    let from = ctx.graphics_mut(|layers| layers.entry(layer).next_idx().0);
    let shown = ui.scope(|ui| {
        if is_taken {
            ui.visuals_mut().clone_from(&ctx.style_of(Theme::Light).visuals);
            ui.set_clip_rect(place);
        }
        contents(ui)
    });
    let painted = || -> Vec<ClippedShape> {
        ctx.graphics(|layers| {
            layers.get(layer).map_or_else(Vec::new, |list| list.all_entries().skip(from).cloned().collect())
        })
    };
    let is_wanted = with(&ctx, |plots| plots.wanted.as_ref().is_some_and(|wanted| wanted.id == id));
    if is_taken {
        if let Some(wanted) = with(&ctx, |plots| plots.wanted.take()) {
            let extent = shown.response.rect.intersect(place);
            let picture = Picture::new(ui, title, extent, painted(), wanted.images);
            put_back(&ctx, layer, from, wanted.on_screen.unwrap_or_default());
            with(&ctx, |plots| plots.ready = Some((picture, wanted.becomes)));
        }
    } else if is_wanted {
        let on_screen = painted();
        with(&ctx, |plots| {
            if let Some(wanted) = &mut plots.wanted {
                wanted.on_screen = Some(on_screen);
            }
        });
        ctx.request_repaint();
    }
    context_menu(ui, id, shown.response.rect.intersect(ui.clip_rect()), painted);
    shown.inner
}

/// Paints what was on the screen in place of what came after it in this frame.
fn put_back(ctx: &Context, layer: LayerId, from: usize, on_screen: Vec<ClippedShape>) {
    ctx.graphics_mut(|layers| {
        let list = layers.entry(layer);
        let end = list.next_idx().0;
        for idx in from..end {
            list.set(ShapeIdx(idx), Rect::NOTHING, Shape::Noop);
        }
        for (idx, ClippedShape { clip_rect, shape, .. }) in (from..).zip(on_screen) {
            if idx < end {
                list.set(ShapeIdx(idx), clip_rect, shape);
            } else {
                list.add(clip_rect, shape);
            }
        }
    });
}

/// The menu at the pointer after a right click: the plot itself keeps its other clicks.
fn context_menu(ui: &Ui, id: Id, rect: Rect, painted: impl FnOnce() -> Vec<ClippedShape>) {
    let ctx = ui.ctx();
    let clicked_at = ctx.input(|input| {
        let pointer = &input.pointer;
        pointer.interact_pos().filter(|at| pointer.secondary_clicked() && rect.contains(*at))
    });
    let is_asked = clicked_at.is_some_and(|at| ctx.layer_id_at(at) == Some(ui.layer_id()));
    let popup = Popup::new(id.with("menu"), ctx.clone(), PopupAnchor::PointerFixed, ui.layer_id())
        .kind(PopupKind::Menu)
        .layout(Layout::top_down_justified(Align::Min))
        .style(egui::containers::menu::menu_style)
        .open_memory(is_asked.then_some(SetOpenCommand::Bool(true)));
    if popup.is_open() || is_asked {
        let painted = painted();
        popup.show(|ui| entries(ui, id, Some(&painted)));
    }
}
