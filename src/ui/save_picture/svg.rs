//! Pictures as lines and text: every shape of the window's painter as the element of SVG that it is, letters as letters.

use std::fmt::Write as _;

use egui::epaint::{ColorMode, Galley, RectShape, TextShape};
use egui::{Color32, ColorImage, FontFamily, Mesh, Pos2, Rect, Shape, Stroke, StrokeKind, TextureId};

use super::Picture;

/// Fonts as wide as the window's, the first that the reader has.
const PROPORTIONAL: &str = "Inter, 'Helvetica Neue', Helvetica, Arial, sans-serif";
const MONOSPACE: &str = "Hack, 'DejaVu Sans Mono', monospace";

/// The file.
pub(super) fn text(picture: &Picture) -> String {
    let mut file = File { text: String::new(), picture, clips: Vec::new() };
    let mut body = String::new();
    let mut open_clip = None;
    for clipped in picture.shapes() {
        let clip = file.clip(clipped.clip_rect);
        if open_clip != Some(clip) {
            if open_clip.is_some() {
                body.push_str("</g>\n");
            }
            let _ = writeln!(body, "<g clip-path=\"url(#clip{clip})\">");
            open_clip = Some(clip);
        }
        file.shape(&mut body, &clipped.shape);
    }
    if open_clip.is_some() {
        body.push_str("</g>\n");
    }
    let [width, height] = [picture.size().x, picture.size().y].map(number);
    let title = escaped(picture.title());
    let _ = write!(
        file.text,
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}pt\" \
         height=\"{height}pt\" viewBox=\"0 0 {width} {height}\" role=\"img\">\n<title>{title}</title>\n<defs>\n"
    );
    for (idx, clip) in file.clips.iter().enumerate() {
        let _ = writeln!(file.text, "<clipPath id=\"clip{idx}\"><rect {}/></clipPath>", sides(*clip));
    }
    let _ =
        write!(file.text, "</defs>\n<rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>\n{body}</svg>\n");
    file.text
}

struct File<'a> {
    text: String,
    picture: &'a Picture,
    clips: Vec<Rect>,
}

impl File<'_> {
    /// The number of a clip rectangle.
    fn clip(&mut self, rect: Rect) -> usize {
        self.clips.iter().position(|known| *known == rect).unwrap_or_else(|| {
            self.clips.push(rect);
            self.clips.len() - 1
        })
    }

    fn shape(&self, body: &mut String, shape: &Shape) {
        match shape {
            Shape::Vec(shapes) => shapes.iter().for_each(|shape| self.shape(body, shape)),
            Shape::Circle(circle) => {
                let [x, y, radius] = [circle.center.x, circle.center.y, circle.radius].map(number);
                let look = fill(circle.fill) + &stroke(circle.stroke);
                let _ = writeln!(body, "<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\"{look}/>");
            }
            Shape::Ellipse(ellipse) => {
                let [x, y] = [ellipse.center.x, ellipse.center.y].map(number);
                let [across, along] = [ellipse.radius.x, ellipse.radius.y].map(number);
                let look = fill(ellipse.fill) + &stroke(ellipse.stroke) + &turned(ellipse.angle, ellipse.center);
                let _ = writeln!(body, "<ellipse cx=\"{x}\" cy=\"{y}\" rx=\"{across}\" ry=\"{along}\"{look}/>");
            }
            Shape::LineSegment { points: [from, to], stroke: line } => {
                let [x1, y1, x2, y2] = [from.x, from.y, to.x, to.y].map(number);
                let _ = writeln!(body, "<line x1=\"{x1}\" y1=\"{y1}\" x2=\"{x2}\" y2=\"{y2}\"{}/>", stroke(*line));
            }
            Shape::Path(path) => {
                let ColorMode::Solid(color) = path.stroke.color else { return };
                let look = fill(path.fill) + &stroke(Stroke::new(path.stroke.width, color));
                let close = if path.closed { "Z" } else { "" };
                let _ = writeln!(body, "<path d=\"{}{close}\"{look}/>", through(&path.points));
            }
            // No plot draws bands or calls back.
            Shape::Noop | Shape::Callback(_) | Shape::Band(_) => {}
            Shape::QuadraticBezier(curve) => {
                let [from, by, to] = curve.points.map(place);
                let ColorMode::Solid(color) = curve.stroke.color else { return };
                let look = fill(curve.fill) + &stroke(Stroke::new(curve.stroke.width, color));
                let _ = writeln!(body, "<path d=\"M{from}Q{by} {to}\"{look}/>");
            }
            Shape::CubicBezier(curve) => {
                let [from, by, and, to] = curve.points.map(place);
                let ColorMode::Solid(color) = curve.stroke.color else { return };
                let look = fill(curve.fill) + &stroke(Stroke::new(curve.stroke.width, color));
                let _ = writeln!(body, "<path d=\"M{from}C{by} {and} {to}\"{look}/>");
            }
            Shape::Rect(rect) => self.rect(body, rect),
            Shape::Text(text) => letters(body, text),
            Shape::Mesh(mesh) => self.mesh(body, mesh),
        }
    }

    fn rect(&self, body: &mut String, rect: &RectShape) {
        if let Some(brush) = &rect.brush {
            self.dots(body, brush.fill_texture_id, rect.rect);
            return;
        }
        // SVG strokes lie on the border.
        let outline = match rect.stroke_kind {
            StrokeKind::Inside => rect.rect.shrink(rect.stroke.width / 2.0),
            StrokeKind::Middle => rect.rect,
            StrokeKind::Outside => rect.rect.expand(rect.stroke.width / 2.0),
        };
        let radius = f32::from(rect.corner_radius.nw);
        let round = if radius > 0.0 { format!(" rx=\"{}\"", number(radius)) } else { String::new() };
        let look = fill(rect.fill) + &stroke(rect.stroke) + &turned(rect.angle, rect.rect.center());
        let _ = writeln!(body, "<rect {}{round}{look}/>", sides(outline));
    }

    /// Triangles, each in the mean of its corners' colours; or the image that they carry.
    fn mesh(&self, body: &mut String, mesh: &Mesh) {
        if mesh.texture_id != TextureId::default() {
            self.dots(body, mesh.texture_id, mesh.calc_bounds());
            return;
        }
        for corners in mesh.indices.chunks_exact(3) {
            let vertices: Vec<_> =
                corners.iter().filter_map(|idx| mesh.vertices.get(usize::try_from(*idx).ok()?)).collect();
            let [a, b, c] = vertices.as_slice() else { continue };
            let color = a.color.lerp_to_gamma(b.color, 0.5).lerp_to_gamma(c.color, 1.0 / 3.0);
            let points = [a.pos, b.pos, c.pos];
            let _ = writeln!(body, "<path d=\"{}Z\"{}/>", through(&points), fill(color));
        }
    }

    fn dots(&self, body: &mut String, texture: TextureId, rect: Rect) {
        if let Some((_, image)) = self.picture.images().iter().find(|(id, _)| *id == texture) {
            let data = base64(&png_of(image));
            let _ = writeln!(
                body,
                "<image {} preserveAspectRatio=\"none\" href=\"data:image/png;base64,{data}\"/>",
                sides(rect)
            );
        }
    }
}

/// Each run of one font and colour as a text element, as wide as in the window whatever font the reader has.
fn letters(body: &mut String, text: &TextShape) {
    let galley = &text.galley;
    let mut at_byte = 0;
    for row in &galley.rows {
        let mut glyphs = row.row.glyphs.as_slice();
        while let Some(first) = glyphs.first() {
            let look = (section_at(galley, at_byte), color_of(text, &row.row.visuals.mesh, first.first_vertex));
            let mut length = 0;
            let mut words = String::new();
            for glyph in glyphs {
                let its = (section_at(galley, at_byte), color_of(text, &row.row.visuals.mesh, glyph.first_vertex));
                if length > 0 && its != look {
                    break;
                }
                words.push(glyph.chr);
                at_byte += glyph.chr.len_utf8();
                length += 1;
            }
            let (run, rest) = glyphs.split_at(length);
            glyphs = rest;
            let Some(last) = run.last().filter(|_| !words.trim().is_empty()) else { continue };
            let at = text.pos + row.pos.to_vec2() + first.pos.to_vec2();
            let width = last.pos.x + last.advance_width - first.pos.x;
            let [x, y, width] = [at.x, at.y, width].map(number);
            let (section_idx, color) = look;
            let font = galley.job.sections.get(section_idx).map(|section| &section.format.font_id);
            let (family, weight) = match font.map(|font| &font.family) {
                Some(FontFamily::Monospace) => (MONOSPACE, ""),
                Some(FontFamily::Name(name)) if &**name == "strong" => (PROPORTIONAL, " font-weight=\"600\""),
                _ => (PROPORTIONAL, ""),
            };
            let size = number(font.map_or(12.0, |font| font.size));
            let look = fill(color) + &turned(text.angle, text.pos);
            let _ = writeln!(
                body,
                "<text x=\"{x}\" y=\"{y}\" font-family=\"{family}\" font-size=\"{size}\"{weight} textLength=\"{width}\" \
                 lengthAdjust=\"spacingAndGlyphs\" xml:space=\"preserve\"{look}>{}</text>",
                escaped(&words)
            );
        }
        at_byte += usize::from(row.ends_with_newline);
    }
}

/// The section of a text that a byte belongs to; what stands for text that was cut has that of its end.
fn section_at(galley: &Galley, at_byte: usize) -> usize {
    let sections = &galley.job.sections;
    let found = sections.iter().position(|section| section.byte_range.end.0 > at_byte);
    found.unwrap_or_else(|| sections.len().saturating_sub(1))
}

fn color_of(text: &TextShape, mesh: &Mesh, first_vertex: u32) -> Color32 {
    let laid_out = usize::try_from(first_vertex).ok().and_then(|idx| mesh.vertices.get(idx));
    let color = text.override_text_color.or_else(|| laid_out.map(|vertex| vertex.color));
    let color = color.filter(|color| *color != Color32::PLACEHOLDER).unwrap_or(text.fallback_color);
    color.gamma_multiply(text.opacity_factor)
}

fn through(points: &[Pos2]) -> String {
    let mut path = String::new();
    for (idx, point) in points.iter().enumerate() {
        path.push(if idx == 0 { 'M' } else { 'L' });
        path.push_str(&place(*point));
    }
    path
}

fn place(point: Pos2) -> String {
    format!("{} {}", number(point.x), number(point.y))
}

fn sides(rect: Rect) -> String {
    let [x, y, width, height] = [rect.left(), rect.top(), rect.width(), rect.height()].map(number);
    format!("x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\"")
}

fn turned(angle: f32, about: Pos2) -> String {
    if angle == 0.0 {
        return String::new();
    }
    format!(" transform=\"rotate({} {})\"", number(angle.to_degrees()), place(about))
}

fn fill(color: Color32) -> String {
    if color.a() == 0 {
        return " fill=\"none\"".to_owned();
    }
    paint("fill", color)
}

fn stroke(stroke: Stroke) -> String {
    if stroke.is_empty() {
        return String::new();
    }
    format!("{} stroke-width=\"{}\"", paint("stroke", stroke.color), number(stroke.width))
}

fn paint(what: &str, color: Color32) -> String {
    let [red, green, blue, alpha] = color.to_srgba_unmultiplied();
    let mut text = format!(" {what}=\"#{red:02x}{green:02x}{blue:02x}\"");
    if alpha < u8::MAX {
        let _ = write!(text, " {what}-opacity=\"{}\"", number(f32::from(alpha) / 255.0));
    }
    text
}

/// Hundredths of a point are finer than any printer.
fn number(value: f32) -> String {
    let text = format!("{value:.2}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

fn escaped(text: &str) -> String {
    let mut safe = String::new();
    for c in text.chars() {
        match c {
            '&' => safe.push_str("&amp;"),
            '<' => safe.push_str("&lt;"),
            '>' => safe.push_str("&gt;"),
            '"' => safe.push_str("&quot;"),
            // XML has no other control characters.
            c if c.is_control() && c != '\t' => safe.push(' '),
            c => safe.push(c),
        }
    }
    safe
}

fn png_of(image: &ColorImage) -> Vec<u8> {
    let [width, height] = image.size.map(|side| u32::try_from(side).unwrap_or(0));
    let bytes = image.pixels.iter().flat_map(Color32::to_srgba_unmultiplied).collect();
    image::RgbaImage::from_raw(width, height, bytes).map_or_else(Vec::new, |image| super::raster::png(&image))
}

/// RFC 4648, section 4.
fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for three in bytes.chunks(3) {
        let bits = three.iter().fold(0_u32, |bits, byte| bits << 8 | u32::from(*byte)) << (8 * (3 - three.len()));
        for letter_idx in 0..4 {
            if letter_idx <= three.len() {
                let letter = LETTERS[(bits >> (18 - 6 * letter_idx) & 63) as usize];
                text.push(char::from(letter));
            } else {
                text.push('=');
            }
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_are_written_as_the_standard_has_it() {
        for (bytes, text) in [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foobar", "Zm9vYmFy")] {
            assert_eq!(base64(bytes.as_bytes()), text);
        }
    }

    #[test]
    fn numbers_are_short_and_have_no_negative_zero() {
        for (value, text) in [(1.0, "1"), (-0.001, "0"), (2.345_6, "2.35"), (-12.5, "-12.5"), (100.0, "100")] {
            assert_eq!(number(value), text);
        }
    }
}
