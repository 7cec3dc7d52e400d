//! Ink to SVG or to pixels, both with plotters.

use std::convert::Infallible;
use std::fmt::Write as _;

use image::RgbImage;
use image::imageops::FilterType;
use plotters::prelude::{BitMapBackend, SVGBackend};
use plotters_backend::text_anchor::{HPos, Pos, VPos};
use plotters_backend::{
    BackendColor, BackendCoord, BackendStyle, BackendTextStyle, DrawingBackend, FontFamily, FontStyle, FontTransform,
};

use super::FigureError;
use super::ink::{Align, Fill, Ink, Label, Place, Stroke};
use super::palette::Rgb;
use super::typeface::{self, FAMILY, HALF_X_HEIGHT, Weight};

/// plotters counts in whole units; so many to a point are finer than a printer's dots.
const UNITS_PER_POINT: f64 = 20.0;
/// plotters divides a font size by this before it writes it into an SVG.
const SVG_FONT_DIVISOR: f64 = 1.24;
/// Pixels are drawn so many times as fine and averaged: plotters does not smooth the borders of thick lines.
const SUPERSAMPLING: u32 = 3;
/// More pixels than that, supersampled, are refused rather than allocated.
const MOST_PIXELS: u64 = 400_000_000;

/// Draws into an SVG with vector text.
pub(super) fn svg(size: [f64; 2], ink: &[Ink], alt: &str) -> Result<String, FigureError> {
    let units = whole(size, UNITS_PER_POINT);
    let mut body = String::new();
    {
        let mut backend = SVGBackend::with_string(&mut body, units);
        draw(&mut backend, UNITS_PER_POINT, size, ink)?;
        backend.present().map_err(failed)?;
    }
    // The page in points, whatever the units inside are, and a name for readers that do not see it.
    let Some(rest) = body.find('>').map(|end| &body[end + 1..]) else {
        return Err(FigureError::NotDrawn { reason: "no document was begun".to_owned() });
    };
    let mut svg = String::with_capacity(rest.len() + 256);
    write!(
        svg,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{}\" height=\"{}\" viewBox=\"0 0 {} {}\" role=\"img\" \
         aria-label=\"{}\">",
        size[0],
        size[1],
        units.0,
        units.1,
        escaped(alt)
    )
    .ok();
    push_with_lengths(&mut svg, rest, ink);
    Ok(svg)
}

/// Appends a drawing in which every text says how long it is: where the typeface is missing, another one, which may be wider,
/// is set into the same length.
fn push_with_lengths(svg: &mut String, drawing: &str, ink: &[Ink]) {
    const TEXT: &str = "<text ";
    let mut parts = drawing.split(TEXT);
    svg.push_str(parts.next().unwrap_or_default());
    // Texts stand in the order of their labels.
    let mut labels = ink.iter().filter_map(written_label);
    for part in parts {
        svg.push_str(TEXT);
        if let Some(label) = labels.next() {
            let length = typeface::width(&label.text, label.size, label.weight) * UNITS_PER_POINT;
            write!(svg, "textLength=\"{length:.0}\" lengthAdjust=\"spacingAndGlyphs\" ").ok();
        }
        svg.push_str(part);
    }
}

/// The label that is written of this, if one is.
fn written_label(ink: &Ink) -> Option<&Label> {
    match ink {
        Ink::Label(label) if !label.text.is_empty() && label.at.iter().all(|value| value.is_finite()) => Some(label),
        _ => None,
    }
}

/// Draws into pixels, so many a point.
pub(super) fn png(size: [f64; 2], ink: &[Ink], pixels_per_point: f64) -> Result<RgbImage, FigureError> {
    let scale = pixels_per_point * f64::from(SUPERSAMPLING);
    let (width, height) = whole(size, pixels_per_point);
    let num_pixels = u64::from(width).saturating_mul(u64::from(height)).saturating_mul(u64::from(SUPERSAMPLING).pow(2));
    if !(pixels_per_point.is_finite() && pixels_per_point > 0.0) || num_pixels == 0 || num_pixels > MOST_PIXELS {
        return Err(FigureError::Resolution { pixels_per_point });
    }
    let fine = (width * SUPERSAMPLING, height * SUPERSAMPLING);
    let mut image = RgbImage::from_pixel(fine.0, fine.1, image::Rgb([0xff; 3]));
    {
        let mut backend = BitMapBackend::with_buffer(&mut image, fine);
        draw(&mut backend, scale, size, ink)?;
        backend.present().map_err(failed)?;
    }
    Ok(image::imageops::resize(&image, width, height, FilterType::Triangle))
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "saturates; what is too large is refused")]
fn whole(size: [f64; 2], scale: f64) -> (u32, u32) {
    let [width, height] = size.map(|length| (length * scale).round() as u32);
    (width, height)
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

fn failed(error: impl std::fmt::Display) -> FigureError {
    FigureError::NotDrawn { reason: error.to_string() }
}

/// A line or an area as plotters sees it.
struct Look {
    color: BackendColor,
    width: u32,
}

impl BackendStyle for Look {
    fn color(&self) -> BackendColor {
        self.color
    }

    fn stroke_width(&self) -> u32 {
        self.width
    }
}

const fn backend_color(Rgb(red, green, blue): Rgb, alpha: f64) -> BackendColor {
    BackendColor { alpha, rgb: (red, green, blue) }
}

fn draw<B: DrawingBackend>(backend: &mut B, scale: f64, size: [f64; 2], ink: &[Ink]) -> Result<(), FigureError> {
    let page = Look { color: backend_color(Rgb::WHITE, 1.0), width: 1 };
    backend.draw_rect((0, 0), unit_place(size, scale), &page, true).map_err(failed)?;
    for piece in ink {
        match piece {
            Ink::Line { places, stroke } => {
                let line = unit_places(places, scale);
                if line.len() > 1 {
                    backend.draw_path(line, &stroke_look(*stroke, scale)).map_err(failed)?;
                }
            }
            Ink::Area { corners, fill } => {
                let corners = unit_places(corners, scale);
                if corners.len() > 2 {
                    backend.fill_polygon(corners, &fill_look(*fill)).map_err(failed)?;
                }
            }
            Ink::Circle { centre, radius, fill, stroke } => {
                if !(centre.iter().all(|value| value.is_finite()) && radius.is_finite()) {
                    continue;
                }
                let (centre, radius) = (unit_place(*centre, scale), units(*radius, scale));
                if let Some(fill) = fill {
                    backend.draw_circle(centre, radius, &fill_look(*fill), true).map_err(failed)?;
                }
                if let Some(stroke) = stroke {
                    backend.draw_circle(centre, radius, &stroke_look(*stroke, scale), false).map_err(failed)?;
                }
            }
            Ink::Label(_) => {
                if let Some(label) = written_label(piece) {
                    write_label(backend, label, scale)?;
                }
            }
        }
    }
    Ok(())
}

fn stroke_look(stroke: Stroke, scale: f64) -> Look {
    Look { color: backend_color(stroke.color, 1.0), width: units(stroke.width, scale) }
}

const fn fill_look(fill: Fill) -> Look {
    Look { color: backend_color(fill.color, fill.opacity), width: 1 }
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a width on a page; saturates")]
fn units(length: f64, scale: f64) -> u32 {
    ((length * scale).round() as u32).max(1)
}

#[expect(clippy::cast_possible_truncation, reason = "a place on a page; saturates")]
fn unit_place(place: Place, scale: f64) -> BackendCoord {
    let [x, y] = place.map(|value| (value * scale).round() as i32);
    (x, y)
}

/// The finite places, each but once where several fall on one unit.
fn unit_places(places: &[Place], scale: f64) -> Vec<BackendCoord> {
    let finite = places.iter().filter(|place| place.iter().all(|value| value.is_finite()));
    let mut units: Vec<BackendCoord> = finite.map(|place| unit_place(*place, scale)).collect();
    units.dedup();
    units
}

fn write_label<B: DrawingBackend>(backend: &mut B, label: &Label, scale: f64) -> Result<(), FigureError> {
    // An SVG hangs the text half an x height above its place.
    let lift = HALF_X_HEIGHT * label.size;
    let [x, y] = label.at;
    let at = if label.is_upright { [x + lift, y] } else { [x, y + lift] };
    let lettering = Lettering { label, scale, lift: lift * scale };
    backend.draw_text(&label.text, &lettering, unit_place(at, scale)).map_err(failed)
}

/// A label as plotters sees it.
struct Lettering<'a> {
    label: &'a Label,
    scale: f64,
    /// From the place up to the baseline, in the backend's units.
    lift: f64,
}

impl BackendTextStyle for Lettering<'_> {
    type FontError = Infallible;

    fn color(&self) -> BackendColor {
        backend_color(self.label.color, 1.0)
    }

    fn size(&self) -> f64 {
        self.label.size * self.scale * SVG_FONT_DIVISOR
    }

    fn transform(&self) -> FontTransform {
        if self.label.is_upright { FontTransform::Rotate270 } else { FontTransform::None }
    }

    fn style(&self) -> FontStyle {
        match self.label.weight {
            Weight::Regular => FontStyle::Normal,
            Weight::Strong => FontStyle::Bold,
        }
    }

    fn anchor(&self) -> Pos {
        let across = match self.label.align {
            Align::Start => HPos::Left,
            Align::Middle => HPos::Center,
            Align::End => HPos::Right,
        };
        Pos::new(across, VPos::Bottom)
    }

    fn family(&self) -> FontFamily<'_> {
        FontFamily::Name(FAMILY)
    }

    /// A flat box on the baseline: only its width is of use, to align the text.
    fn layout_box(&self, text: &str) -> Result<((i32, i32), (i32, i32)), Infallible> {
        let width = typeface::width(text, self.label.size, self.label.weight);
        #[expect(clippy::cast_possible_truncation, reason = "a width on a page")]
        let width = (width * self.scale).round() as i32;
        Ok(((0, 0), (width, 0)))
    }

    fn draw<E, DrawFunc: FnMut(i32, i32, BackendColor) -> Result<(), E>>(
        &self,
        text: &str,
        (left, baseline): BackendCoord,
        mut draw: DrawFunc,
    ) -> Result<Result<(), E>, Infallible> {
        #[expect(clippy::cast_possible_truncation, reason = "a height of letters")]
        let lift = self.lift.round() as i32;
        Ok(typeface::rasterise(text, self.label.size * self.scale, self.label.weight, |x, y, part| {
            draw(left + x, baseline - lift + y, backend_color(self.label.color, f64::from(part)))
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::figure::ink::Area;

    fn label(text: &str, at: Place, align: Align, is_upright: bool) -> Label {
        Label { text: text.to_owned(), at, align, size: 20.0, weight: Weight::Regular, color: Rgb(0, 0, 0), is_upright }
    }

    /// The box of the dark pixels.
    fn dark(image: &RgbImage) -> Area {
        let mut area = Area::new([f64::MAX; 2], [f64::MIN; 2]);
        for (x, y, pixel) in image.enumerate_pixels().filter(|(_, _, pixel)| pixel.0[0] < 128) {
            assert!(pixel.0[0] < 128);
            let [x, y] = [f64::from(x), f64::from(y)];
            area = Area::new([area.min[0].min(x), area.min[1].min(y)], [area.max[0].max(x), area.max[1].max(y)]);
        }
        area
    }

    #[test]
    fn letters_fill_the_area_that_they_are_said_to() {
        for is_upright in [false, true] {
            for align in [Align::Start, Align::Middle, Align::End] {
                let label = label("Hamburg", [100.0, 100.0], align, is_upright);
                let claimed = label.area();
                let image = png([200.0, 200.0], &[Ink::Label(label)], 1.0).expect("drawn");
                let inked = dark(&image);
                assert!(claimed.grown(1.0).holds_all(&inked), "{align:?} {is_upright}: {inked:?} in {claimed:?}");
                // Not merely inside: side bearings and the room for descenders are a few pixels.
                assert!(inked.grown(5.0).holds_all(&claimed), "{align:?} {is_upright}: {claimed:?} in {inked:?}");
            }
        }
    }

    #[test]
    fn text_is_escaped_and_the_page_is_in_points() {
        let text =
            svg([120.0, 80.0], &[Ink::Label(label("a<b & \"c\"", [60.0, 40.0], Align::Middle, false))], "x < \"y\"")
                .expect("drawn");
        assert!(text.starts_with("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"120\" height=\"80\" "), "{text}");
        assert!(text.contains("a&lt;b &amp; &quot;c&quot;"), "{text}");
        assert!(text.contains("aria-label=\"x &lt; &quot;y&quot;\""), "{text}");
        assert!(text.contains("text-anchor=\"middle\""));
    }

    #[test]
    fn what_is_nowhere_is_not_drawn_and_no_resolution_breaks_anything() {
        let nowhere = [f64::NAN, 3.0];
        let stroke = Stroke::new(1.0, Rgb(0, 0, 0));
        let ink = [
            Ink::Line { places: vec![nowhere, [1.0, 1.0]], stroke },
            Ink::Area { corners: vec![nowhere; 3], fill: Fill::solid(Rgb(0, 0, 0)) },
            Ink::Circle { centre: nowhere, radius: 2.0, fill: None, stroke: Some(stroke) },
            Ink::Label(label("x", nowhere, Align::Start, false)),
        ];
        let image = png([10.0, 10.0], &ink, 1.0).expect("drawn");
        assert!(image.pixels().all(|pixel| pixel.0 == [0xff; 3]));
        for pixels_per_point in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e9] {
            assert!(png([10.0, 10.0], &ink, pixels_per_point).is_err(), "{pixels_per_point}");
        }
    }
}
