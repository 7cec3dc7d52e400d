//! Draws the window into an image without a display or a graphics driver: for the manual's pictures and for tests.
//!
//! It fills the triangles that egui tessellates, with premultiplied colours blended in gamma space as the window's
//! renderer does. Paint callbacks are skipped; the window uses none.

use std::collections::{HashMap, HashSet};

use egui::epaint::{ClippedPrimitive, ImageDelta, Primitive, Vertex};
use egui::{Color32, ImageData, Rect, TextureFilter, TextureId, TexturesDelta};
use image::RgbaImage;

#[derive(Default)]
struct Texture {
    width: usize,
    height: usize,
    pixels: Vec<Color32>,
    is_nearest: bool,
}

impl Texture {
    fn update(&mut self, delta: &ImageDelta) {
        let ImageData::Color(patch) = &delta.image;
        let [patch_width, patch_height] = patch.size;
        self.is_nearest = delta.options.magnification == TextureFilter::Nearest;
        let Some([x, y]) = delta.pos else {
            (self.width, self.height) = (patch_width, patch_height);
            self.pixels.clone_from(&patch.pixels);
            return;
        };
        for (row_idx, row) in patch.pixels.chunks_exact(patch_width.max(1)).enumerate().take(patch_height) {
            let start = (y + row_idx) * self.width + x;
            if let Some(target) = self.pixels.get_mut(start..start + patch_width) {
                target.copy_from_slice(row);
            }
        }
    }

    fn texel(&self, x: isize, y: isize) -> [f32; 4] {
        let x = x.clamp(0, self.width.cast_signed() - 1).cast_unsigned();
        let y = y.clamp(0, self.height.cast_signed() - 1).cast_unsigned();
        self.pixels.get(y * self.width + x).map_or([0.0; 4], |color| color.to_array().map(f32::from))
    }

    fn sample(&self, u: f32, v: f32) -> [f32; 4] {
        let (x, y) = (u * size(self.width), v * size(self.height));
        if self.is_nearest {
            return self.texel(floor(x), floor(y));
        }
        let (x, y) = (x - 0.5, y - 0.5);
        let (fraction_x, fraction_y) = (x - x.floor(), y - y.floor());
        let (left, top) = (floor(x), floor(y));
        let upper = mix(self.texel(left, top), self.texel(left + 1, top), fraction_x);
        let lower = mix(self.texel(left, top + 1), self.texel(left + 1, top + 1), fraction_x);
        mix(upper, lower, fraction_y)
    }
}

/// Holds the textures between frames, as a graphics card would.
#[derive(Default)]
pub struct SoftwareRenderer {
    textures: HashMap<TextureId, Texture>,
    to_free: HashSet<TextureId>,
}

impl SoftwareRenderer {
    /// Takes over new and changed textures, and forgets those that the frame before still needed.
    pub fn update_textures(&mut self, delta: &mut TexturesDelta) {
        for id in self.to_free.drain() {
            self.textures.remove(&id);
        }
        for (id, changes) in delta.set.drain() {
            let texture = self.textures.entry(id).or_default();
            for change in &changes {
                texture.update(change);
            }
        }
        self.to_free.extend(delta.free.drain());
    }

    /// Paints tessellated shapes over a transparent ground of `size_px` pixels.
    #[must_use]
    pub fn paint(&self, primitives: &[ClippedPrimitive], pixels_per_point: f32, size_px: [u32; 2]) -> RgbaImage {
        let [width, height] = size_px.map(|side| usize::try_from(side).unwrap_or(0));
        let mut canvas = Canvas { width, height, pixels: vec![[0.0; 4]; width * height] };
        for ClippedPrimitive { clip_rect, primitive } in primitives {
            let Primitive::Mesh(mesh) = primitive else { continue };
            let Some(texture) = self.textures.get(&mesh.texture_id) else { continue };
            let clip = canvas.clip(*clip_rect, pixels_per_point);
            for corners in mesh.indices.chunks_exact(3) {
                let corner = |idx: usize| {
                    let vertex = usize::try_from(corners[idx]).ok().and_then(|idx| mesh.vertices.get(idx));
                    vertex.map(|vertex| Corner::new(vertex, pixels_per_point))
                };
                if let (Some(a), Some(b), Some(c)) = (corner(0), corner(1), corner(2)) {
                    canvas.fill([a, b, c], &clip, texture);
                }
            }
        }
        canvas.into_image(size_px)
    }
}

#[derive(Clone, Copy)]
struct Corner {
    x: f32,
    y: f32,
    u: f32,
    v: f32,
    color: [f32; 4],
}

impl Corner {
    fn new(vertex: &Vertex, pixels_per_point: f32) -> Self {
        Self {
            x: vertex.pos.x * pixels_per_point,
            y: vertex.pos.y * pixels_per_point,
            u: vertex.uv.x,
            v: vertex.uv.y,
            color: vertex.color.to_array().map(f32::from),
        }
    }
}

impl Corner {
    /// Whether colour and texture are exactly the same, so that nothing varies between the two.
    fn looks_as(&self, other: &Self) -> bool {
        let bits = |corner: &Self| (corner.color.map(f32::to_bits), corner.u.to_bits(), corner.v.to_bits());
        bits(self) == bits(other)
    }
}

/// Pixels within a clip rectangle: columns and rows, the ends excluded.
struct Clip {
    columns: std::ops::Range<isize>,
    rows: std::ops::Range<isize>,
}

struct Canvas {
    width: usize,
    height: usize,
    pixels: Vec<[f32; 4]>,
}

impl Canvas {
    fn clip(&self, rect: Rect, pixels_per_point: f32) -> Clip {
        let bound = |value: f32, limit: usize| floor((value * pixels_per_point).round()).clamp(0, limit.cast_signed());
        Clip {
            columns: bound(rect.min.x, self.width)..bound(rect.max.x, self.width),
            rows: bound(rect.min.y, self.height)..bound(rect.max.y, self.height),
        }
    }

    /// Fills the pixels whose centres lie in a triangle; on an edge shared by two, only one of them has it.
    fn fill(&mut self, [a, mut b, mut c]: [Corner; 3], clip: &Clip, texture: &Texture) {
        let mut double_area = cross(&a, &b, c.x, c.y);
        if double_area == 0.0 || !double_area.is_finite() {
            return;
        }
        if double_area < 0.0 {
            std::mem::swap(&mut b, &mut c);
            double_area = -double_area;
        }
        let is_flat = a.looks_as(&b) && a.looks_as(&c);
        let flat_source = is_flat.then(|| modulate(texture.sample(a.u, a.v), a.color));
        let edges = [(&b, &c), (&c, &a), (&a, &b)].map(|(from, to)| Edge::new(from, to));
        let top = floor(a.y.min(b.y).min(c.y)).max(clip.rows.start);
        let bottom = floor(a.y.max(b.y).max(c.y) + 1.0).min(clip.rows.end);
        let left = floor(a.x.min(b.x).min(c.x)).max(clip.columns.start);
        let right = floor(a.x.max(b.x).max(c.x) + 1.0).min(clip.columns.end);
        for row in top..bottom {
            let y = center(row);
            for column in left..right {
                let x = center(column);
                let values = [edges[0].at(x, y), edges[1].at(x, y), edges[2].at(x, y)];
                if !edges.iter().zip(values).all(|(edge, value)| edge.contains(value)) {
                    continue;
                }
                let source = flat_source.unwrap_or_else(|| {
                    let [wa, wb, wc] = values.map(|value| value / double_area);
                    let blend = |a: f32, b: f32, c: f32| wa * a + wb * b + wc * c;
                    let color = [0, 1, 2, 3].map(|k| blend(a.color[k], b.color[k], c.color[k]));
                    modulate(texture.sample(blend(a.u, b.u, c.u), blend(a.v, b.v, c.v)), color)
                });
                self.blend(column.cast_unsigned(), row.cast_unsigned(), source);
            }
        }
    }

    fn blend(&mut self, column: usize, row: usize, source: [f32; 4]) {
        let Some(pixel) = self.pixels.get_mut(row * self.width + column) else { return };
        let kept = 1.0 - source[3] / 255.0;
        for (channel, value) in pixel.iter_mut().zip(source) {
            *channel = *channel * kept + value;
        }
    }

    fn into_image(self, [width, height]: [u32; 2]) -> RgbaImage {
        let mut image = RgbaImage::new(width, height);
        for (target, pixel) in image.pixels_mut().zip(&self.pixels) {
            target.0 = pixel.map(to_byte);
        }
        image
    }
}

/// One edge of a triangle: its function is positive on the inner side.
struct Edge {
    origin_x: f32,
    origin_y: f32,
    dx: f32,
    dy: f32,
    owns_border: bool,
}

impl Edge {
    fn new(from: &Corner, to: &Corner) -> Self {
        let (dx, dy) = (to.x - from.x, to.y - from.y);
        Self { origin_x: from.x, origin_y: from.y, dx, dy, owns_border: dy < 0.0 || (dy == 0.0 && dx > 0.0) }
    }

    fn at(&self, x: f32, y: f32) -> f32 {
        self.dx * (y - self.origin_y) - self.dy * (x - self.origin_x)
    }

    fn contains(&self, value: f32) -> bool {
        value > 0.0 || (value == 0.0 && self.owns_border)
    }
}

fn cross(a: &Corner, b: &Corner, x: f32, y: f32) -> f32 {
    (b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x)
}

fn mix(a: [f32; 4], b: [f32; 4], fraction: f32) -> [f32; 4] {
    [0, 1, 2, 3].map(|k| a[k] + (b[k] - a[k]) * fraction)
}

fn modulate(texel: [f32; 4], color: [f32; 4]) -> [f32; 4] {
    [0, 1, 2, 3].map(|k| texel[k] * color[k] / 255.0)
}

#[expect(clippy::cast_precision_loss, reason = "sizes of textures and windows are far below 2^24")]
const fn size(pixels: usize) -> f32 {
    pixels as f32
}

#[expect(clippy::cast_precision_loss, reason = "sizes of textures and windows are far below 2^24")]
const fn center(pixel: isize) -> f32 {
    pixel as f32 + 0.5
}

#[expect(clippy::cast_possible_truncation, reason = "the cast saturates, and callers clamp to the image")]
fn floor(value: f32) -> isize {
    value.floor() as isize
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to a byte just before")]
const fn to_byte(value: f32) -> u8 {
    (value + 0.5).clamp(0.0, 255.0) as u8
}
