//! The one place for colours, type sizes and distances, so that every panel looks like part of the same instrument.
//!
//! Neutral surfaces, one accent for the next action, colour otherwise only for data. Distances lie on a 4 px grid.
//! Call [`install`] once for a context before anything is drawn: the text helpers use font families it registers.

use std::sync::Arc;

use egui::{
    Color32, CornerRadius, FontData, FontDefinitions, FontFamily, FontId, Margin, RichText, Stroke, TextStyle, Theme,
    vec2,
};
use egui_plot::MarkerShape;

use crate::calibrate::{Method, Verdict};
use crate::report::figure::palette::{self as data, Marker, Rgb};
use crate::report::figure::typeface;

pub use crate::report::figure::palette::method_symbol;

/// Height of every row of a table or list, points.
pub const ROW_HEIGHT: f32 = 24.0;
/// Corner radius of cards, buttons and fields, points.
pub const RADIUS: u8 = 4;
/// Distance between cards, and from a card's border to its contents, points.
pub const GAP: f32 = 12.0;
/// How strongly that is drawn which was, but is not any more.
pub const PAST_OPACITY: f32 = 0.5;
/// Size of small text, points.
pub const SMALL_SIZE: f32 = 11.5;
/// Size of ordinary text, points.
pub const BODY_SIZE: f32 = 13.0;
/// Size of headings, points.
pub const HEADING_SIZE: f32 = 18.0;

/// Points on the arc: drawn solid.
pub const INLIER: Color32 = color_of(data::INLIER);
/// Points off the arc: drawn hollow.
pub const OUTLIER: Color32 = color_of(data::OUTLIER);
/// Points elsewhere: drawn faint.
pub const UNUSED: Color32 = color_of(data::UNUSED);

/// A colour of data, on the screen.
#[must_use]
pub const fn color_of(Rgb(red, green, blue): Rgb) -> Color32 {
    Color32::from_rgb(red, green, blue)
}

/// A marker of data, on the screen.
#[must_use]
pub const fn marker_shape(marker: Marker) -> MarkerShape {
    match marker {
        Marker::Circle => MarkerShape::Circle,
        Marker::Down => MarkerShape::Down,
        Marker::Up => MarkerShape::Up,
        Marker::Square => MarkerShape::Square,
        Marker::Diamond => MarkerShape::Diamond,
    }
}

/// The colours of the axes x, y and z of a frame; letters stand beside them.
#[must_use]
pub fn axis_colors(ui: &egui::Ui) -> [Color32; 3] {
    if ui.visuals().dark_mode {
        [Color32::from_rgb(0xf2, 0x7a, 0x6d), Color32::from_rgb(0x4f, 0xc4, 0x8a), Color32::from_rgb(0x6f, 0xa3, 0xff)]
    } else {
        data::AXES.map(color_of)
    }
}

/// The colours of one theme.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Palette {
    /// The next action, and what is selected.
    pub accent: Color32,
    /// Text on the accent.
    pub on_accent: Color32,
    /// Ground of a selected row or rail step.
    pub selected: Color32,
    /// Ground of what the pointer is over.
    pub hovered: Color32,
    /// Cards and bars.
    pub surface: Color32,
    /// The ground behind the cards.
    pub canvas: Color32,
    /// Borders and rules.
    pub hairline: Color32,
    /// Text.
    pub text: Color32,
    /// Units, labels, hints.
    pub text_dim: Color32,
    /// Good.
    pub good: Color32,
    /// To be looked at.
    pub warn: Color32,
    /// Bad.
    pub bad: Color32,
}

const LIGHT: Palette = Palette {
    accent: Color32::from_rgb(0x2f, 0x6f, 0xed),
    on_accent: Color32::WHITE,
    selected: Color32::from_rgb(0xe8, 0xf0, 0xfd),
    hovered: Color32::from_rgb(0xf2, 0xf4, 0xf7),
    surface: Color32::WHITE,
    canvas: Color32::from_rgb(0xf4, 0xf6, 0xf8),
    hairline: Color32::from_rgb(0xe1, 0xe5, 0xea),
    text: Color32::from_rgb(0x1b, 0x22, 0x2c),
    text_dim: Color32::from_rgb(0x5f, 0x6b, 0x7a),
    good: Color32::from_rgb(0x11, 0x7a, 0x48),
    warn: Color32::from_rgb(0xb3, 0x5c, 0x00),
    bad: Color32::from_rgb(0xc2, 0x2f, 0x22),
};

const DARK: Palette = Palette {
    accent: Color32::from_rgb(0x5b, 0x92, 0xf7),
    on_accent: Color32::from_rgb(0x0d, 0x13, 0x1c),
    selected: Color32::from_rgb(0x22, 0x33, 0x50),
    hovered: Color32::from_rgb(0x2a, 0x31, 0x3b),
    surface: Color32::from_rgb(0x20, 0x26, 0x2e),
    canvas: Color32::from_rgb(0x16, 0x1b, 0x21),
    hairline: Color32::from_rgb(0x38, 0x40, 0x4b),
    text: Color32::from_rgb(0xe6, 0xea, 0xef),
    text_dim: Color32::from_rgb(0x9a, 0xa6, 0xb5),
    good: Color32::from_rgb(0x4f, 0xc4, 0x8a),
    warn: Color32::from_rgb(0xf0, 0xa0, 0x4b),
    bad: Color32::from_rgb(0xf2, 0x7a, 0x6d),
};

/// The colours that suit the visuals in use.
#[must_use]
pub const fn palette_of(visuals: &egui::Visuals) -> &'static Palette {
    if visuals.dark_mode { &DARK } else { &LIGHT }
}

/// The colours that suit the theme in use.
#[must_use]
pub fn palette(ui: &egui::Ui) -> &'static Palette {
    palette_of(ui.visuals())
}

/// The colour that a method has everywhere.
#[must_use]
pub const fn method_color(method: Method) -> Color32 {
    color_of(data::method_color(method))
}

/// A shade of the method's colour with enough contrast for text: darker on a light ground, lighter on a dark one.
#[must_use]
pub fn method_text_color(ui: &egui::Ui, method: Method) -> Color32 {
    if ui.visuals().dark_mode {
        return method_color(method).lerp_to_gamma(Color32::WHITE, 0.4);
    }
    match method {
        Method::BallFixedPoint | Method::FixedPoint | Method::Motion => method_color(method),
        Method::BallMaxArcStep => Color32::from_rgb(0x66, 0x66, 0x66),
        Method::BallMaxArc => Color32::from_rgb(0xb3, 0x62, 0x00),
        Method::BallBundle | Method::PlateBundle => Color32::from_rgb(0x00, 0x7a, 0x59),
        Method::PlateOrthogonal => Color32::from_rgb(0x9c, 0x4a, 0x78),
    }
}

/// The marker that a method has in every plot.
#[must_use]
pub const fn method_marker(method: Method) -> MarkerShape {
    marker_shape(data::method_marker(method))
}

/// The colour of a verdict in a palette; the shape from [`crate::text::verdict_mark`] stands beside it.
#[must_use]
pub const fn verdict_color_in(palette: &Palette, verdict: Verdict) -> Color32 {
    match verdict {
        Verdict::Good => palette.good,
        Verdict::Usable => palette.warn,
        Verdict::NotUsable => palette.bad,
    }
}

fn strong_family() -> FontFamily {
    FontFamily::Name("strong".into())
}

fn number_family() -> FontFamily {
    FontFamily::Name("number".into())
}

/// Text in the second weight, for titles of cards and the figures that matter.
pub fn strong(text: impl Into<String>) -> RichText {
    RichText::new(text).family(strong_family()).strong()
}

/// The font of [`strong`], for painters.
#[must_use]
pub fn strong_font() -> FontId {
    FontId::new(BODY_SIZE, strong_family())
}

/// Text in the third size and second weight, for the title of a page or a verdict.
pub fn heading(text: impl Into<String>) -> RichText {
    strong(text).size(HEADING_SIZE)
}

/// Text in the dimmer tone, for labels, units and hints.
pub fn dim(ui: &egui::Ui, text: impl Into<String>) -> RichText {
    RichText::new(text).color(palette(ui).text_dim)
}

/// The font of numbers: all figures are equally wide, so columns line up on the decimal point.
#[must_use]
pub fn number_font() -> FontId {
    FontId::new(NUMBER_SIZE, number_family())
}

/// A little smaller than ordinary text: figures have no descenders and so look larger than letters.
const NUMBER_SIZE: f32 = 12.5;

/// Sets fonts, both themes' visuals and the spacing of a context.
pub fn install(ctx: &egui::Context) {
    ctx.set_fonts(fonts());
    ctx.all_styles_mut(set_style);
    for (theme, palette) in [(Theme::Light, &LIGHT), (Theme::Dark, &DARK)] {
        ctx.style_mut_of(theme, |style| set_visuals(&mut style.visuals, palette));
    }
}

fn fonts() -> FontDefinitions {
    let mut fonts = FontDefinitions::default();
    for (name, bytes) in [("Inter", typeface::REGULAR), ("Inter SemiBold", typeface::SEMIBOLD)] {
        fonts.font_data.insert(name.to_owned(), Arc::new(FontData::from_static(bytes)));
    }
    // Ticks, folding triangles and emoji stand in none of the first, so the others back it up.
    let family =
        |first: &str| [first, "Ubuntu-Light", "Hack", "NotoEmoji-Regular", "emoji-icon-font"].map(str::to_owned).into();
    fonts.families.insert(FontFamily::Proportional, family("Inter"));
    fonts.families.insert(number_family(), family("Inter"));
    fonts.families.insert(strong_family(), family("Inter SemiBold"));
    fonts.families.insert(FontFamily::Monospace, family("Hack"));
    fonts
}

fn set_style(style: &mut egui::Style) {
    style.text_styles = [
        (TextStyle::Small, FontId::new(SMALL_SIZE, FontFamily::Proportional)),
        (TextStyle::Body, FontId::new(BODY_SIZE, FontFamily::Proportional)),
        (TextStyle::Button, FontId::new(BODY_SIZE, FontFamily::Proportional)),
        (TextStyle::Heading, FontId::new(HEADING_SIZE, strong_family())),
        (TextStyle::Monospace, number_font()),
    ]
    .into();
    let spacing = &mut style.spacing;
    spacing.item_spacing = vec2(8.0, 4.0);
    spacing.button_padding = vec2(12.0, 4.0);
    spacing.interact_size = vec2(28.0, 28.0);
    spacing.menu_margin = Margin::same(4);
    spacing.window_margin = Margin::same(16);
    spacing.icon_width = 16.0;
    spacing.icon_spacing = 8.0;
    spacing.combo_width = 96.0;
    spacing.tooltip_width = 360.0;
    style.animation_time = 0.0;
    style.scroll_animation = egui::style::ScrollAnimation::none();
}

fn set_visuals(visuals: &mut egui::Visuals, palette: &Palette) {
    let hairline = Stroke::new(1.0, palette.hairline);
    visuals.panel_fill = palette.canvas;
    visuals.window_fill = palette.surface;
    visuals.window_stroke = hairline;
    visuals.window_corner_radius = CornerRadius::same(RADIUS);
    visuals.menu_corner_radius = CornerRadius::same(RADIUS);
    visuals.extreme_bg_color = palette.surface;
    visuals.faint_bg_color = palette.hovered;
    visuals.code_bg_color = palette.canvas;
    visuals.weak_text_color = Some(palette.text_dim);
    visuals.warn_fg_color = palette.warn;
    visuals.error_fg_color = palette.bad;
    visuals.hyperlink_color = palette.accent;
    visuals.selection.bg_fill = palette.selected;
    visuals.selection.stroke = Stroke::new(1.0, palette.accent);
    visuals.striped = false;
    visuals.slider_trailing_fill = true;
    let widgets = &mut visuals.widgets;
    for widget in [
        &mut widgets.noninteractive,
        &mut widgets.inactive,
        &mut widgets.hovered,
        &mut widgets.active,
        &mut widgets.open,
    ] {
        widget.corner_radius = CornerRadius::same(RADIUS);
        widget.expansion = 0.0;
        widget.bg_fill = palette.surface;
        widget.weak_bg_fill = palette.surface;
        widget.bg_stroke = hairline;
        widget.fg_stroke = Stroke::new(1.0, palette.text);
    }
    widgets.hovered.weak_bg_fill = palette.hovered;
    widgets.hovered.bg_fill = palette.hovered;
    widgets.hovered.bg_stroke = Stroke::new(1.0, palette.text_dim);
    widgets.active.weak_bg_fill = palette.selected;
    widgets.active.bg_fill = palette.selected;
    widgets.active.bg_stroke = Stroke::new(1.0, palette.accent);
    widgets.open.weak_bg_fill = palette.hovered;
}
