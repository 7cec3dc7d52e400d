//! Points into a picture: each covers a few pixels, the nearest wins, and edges of depth are shaded so that shapes show.

use egui::{Color32, ColorImage};

use super::{Camera, Thinned};

/// Room for a picture, kept from frame to frame.
#[derive(Debug, Default)]
pub struct Canvas {
    depth: Vec<f32>,
    /// Index of the point in front, from 1; 0 where there is none.
    front: Vec<u32>,
}

/// How dark a step in depth of a pixel's width is.
const EDGE_DARKNESS: f32 = 0.10;
/// Nothing becomes darker.
const DARKEST: f32 = 0.45;

/// Draws points into a picture of so many pixels; transparent where there are none.
///
/// `pixels_per_point` is the screen's; the camera measures in points.
#[must_use]
pub fn draw(
    thinned: &Thinned,
    camera: &Camera,
    [width, height]: [usize; 2],
    pixels_per_point: f32,
    canvas: &mut Canvas,
) -> ColorImage {
    canvas.depth.clear();
    canvas.depth.resize(width * height, f32::INFINITY);
    canvas.front.clear();
    canvas.front.resize(width * height, 0);
    let scale = camera.scale() * pixels_per_point;
    let [right, down, into] = camera.axes();
    let (right, down) = (right * scale, down * scale);
    let centre = camera.centre();
    let shift = [to_f32(width) / 2.0 - right.dot(&centre), to_f32(height) / 2.0 - down.dot(&centre)];
    let splat = splat_of(thinned, camera, [width, height], pixels_per_point);
    let half = to_f32(splat) / 2.0;
    let (last_column, last_row) = (to_f32(width.saturating_sub(splat)), to_f32(height.saturating_sub(splat)));
    for (number, [x, y, z]) in (1..).zip(&thinned.points) {
        let column = right.x * x + right.y * y + right.z * z + shift[0] - half;
        let row = down.x * x + down.y * y + down.z * z + shift[1] - half;
        // Points that lie half outside are left out: nobody misses them.
        if !(column >= 0.0 && row >= 0.0 && column <= last_column && row <= last_row) {
            continue;
        }
        let depth = into.x * x + into.y * y + into.z * z;
        let start = to_usize(row) * width + to_usize(column);
        for line in 0..splat {
            let pixels = start + line * width..start + line * width + splat;
            let Some(depths) = canvas.depth.get_mut(pixels.clone()) else { continue };
            for (known, front) in depths.iter_mut().zip(&mut canvas.front[pixels]) {
                if depth < *known {
                    *known = depth;
                    *front = number;
                }
            }
        }
    }
    ColorImage::new([width, height], shaded(thinned, canvas, width, scale))
}

/// The colours of the points in front, darker where something nearer stands beside.
fn shaded(thinned: &Thinned, canvas: &Canvas, width: usize, scale: f32) -> Vec<Color32> {
    let depth = &canvas.depth;
    let mut pixels = vec![Color32::TRANSPARENT; depth.len()];
    for (place, (pixel, front)) in pixels.iter_mut().zip(&canvas.front).enumerate() {
        let Some(color) = (*front as usize).checked_sub(1).and_then(|idx| thinned.colors.get(idx)) else { continue };
        let here = depth[place];
        let beside = [place.wrapping_sub(2), place + 2, place.wrapping_sub(2 * width), place + 2 * width];
        let step: f32 = beside
            .iter()
            .filter_map(|beside| depth.get(*beside))
            .map(|there| if there.is_finite() { (here - there).max(0.0) } else { 0.0 })
            .sum();
        let light = (1.0 - EDGE_DARKNESS * step * scale / 2.0).max(DARKEST);
        *pixel = darkened(*color, light);
    }
    pixels
}

fn darkened(color: Color32, light: f32) -> Color32 {
    let part = |value: u8| to_u8(f32::from(value) * light);
    Color32::from_rgb(part(color.r()), part(color.g()), part(color.b()))
}

/// Pixels that a point covers each way, so that a surface has no holes: more where there are few points for the room.
fn splat_of(thinned: &Thinned, camera: &Camera, [width, height]: [usize; 2], pixels_per_point: f32) -> usize {
    /// More looks like bricks.
    const MOST: f32 = 5.0;
    /// Of the points on the screen every so-many-th is looked at.
    const EVERY: usize = 64;
    let [right, down, _] = camera.axes();
    let scale = camera.scale() * pixels_per_point;
    let centre = camera.centre();
    let (mut low, mut high, mut count) = ([f32::INFINITY; 2], [f32::NEG_INFINITY; 2], 0_usize);
    let half = [to_f32(width) / 2.0, to_f32(height) / 2.0];
    for point in thinned.points.iter().step_by(EVERY) {
        let from_centre = nalgebra::Vector3::from(*point) - centre;
        let place = [right.dot(&from_centre) * scale, down.dot(&from_centre) * scale];
        if (0..2).all(|axis| place[axis].abs() <= half[axis]) {
            count += EVERY;
            for axis in 0..2 {
                low[axis] = low[axis].min(place[axis]);
                high[axis] = high[axis].max(place[axis]);
            }
        }
    }
    let area = (high[0] - low[0]).max(0.0) * (high[1] - low[1]).max(0.0);
    to_usize((1.6 * (area / to_f32(count.max(1))).sqrt()).ceil().clamp(1.0, MOST))
}

#[expect(clippy::cast_precision_loss, reason = "sides of pictures and counts of drawn points")]
const fn to_f32(value: usize) -> f32 {
    value as f32
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "not negative, and of the size of a screen"
)]
const fn to_usize(value: f32) -> usize {
    value as usize
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "the conversion saturates")]
const fn to_u8(value: f32) -> u8 {
    value as u8
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;

    #[test]
    fn the_nearest_point_is_seen() {
        let mut camera = Camera::default();
        camera.look_along(2);
        camera.fit([Vector3::repeat(-1.0), Vector3::repeat(1.0)], egui::vec2(20.0, 20.0));
        let thinned = Thinned {
            idx: vec![0, 1, 2],
            points: vec![[0.0, 0.0, 0.5], [0.0, 0.0, 1.0], [0.0, 0.0, 0.0]],
            colors: vec![Color32::RED, Color32::GREEN, Color32::BLUE],
        };
        let picture = draw(&thinned, &camera, [20, 20], 1.0, &mut Canvas::default());
        // Seen from above, the highest one hides the others.
        // A point of one pixel half a pixel before the middle of an even number of them.
        assert_eq!(picture.pixels[9 * 20 + 9], Color32::from_rgb(0, 255, 0));
        assert_eq!(picture.pixels[0], Color32::TRANSPARENT);
    }

    #[test]
    fn what_is_outside_or_nothing_is_drawn_without_harm() {
        let camera = Camera::default();
        let thinned = Thinned {
            idx: vec![0, 1],
            points: vec![[1e9, 0.0, 0.0], [f32::NAN, 0.0, 0.0]],
            colors: vec![Color32::RED; 2],
        };
        for size in [[0, 0], [1, 1], [3, 2]] {
            let picture = draw(&thinned, &camera, size, 2.0, &mut Canvas::default());
            assert!(picture.pixels.iter().all(|pixel| *pixel == Color32::TRANSPARENT));
        }
    }
}
