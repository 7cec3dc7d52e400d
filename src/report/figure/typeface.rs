//! The typeface of the window and of all figures: Inter, subset and with tabular figures as its only figures; see
//! `assets/fonts/subset.py`. Widths are measured with it, so that no text stands where another one does.

use std::sync::LazyLock;

use ab_glyph::{Font as _, FontRef, ScaleFont as _};

/// The regular weight, a TrueType file.
pub const REGULAR: &[u8] = include_bytes!("../../../assets/fonts/Inter-Regular.ttf");
/// The second weight, for titles.
pub const SEMIBOLD: &[u8] = include_bytes!("../../../assets/fonts/Inter-SemiBold.ttf");

/// What a figure asks the reader's program for. The others are about as wide as Inter, where it is missing.
pub(super) const FAMILY: &str = "Inter, Helvetica, Arial, sans-serif";

/// Height of a capital letter, of the size of a text.
pub(super) const CAP_HEIGHT: f64 = 0.727;
/// How far letters reach above and below their baseline, of the size.
pub(super) const ASCENT: f64 = 0.77;
/// See [`ASCENT`].
pub(super) const DESCENT: f64 = 0.22;
/// Half of Inter's x height, of the size: so far below a baseline's mark does SVG put the text that hangs on it.
pub(super) const HALF_X_HEIGHT: f64 = 0.273;

/// How heavy letters are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Weight {
    /// Ordinary text.
    #[default]
    Regular,
    /// Titles.
    Strong,
}

static FONTS: LazyLock<[Option<FontRef<'static>>; 2]> =
    LazyLock::new(|| [REGULAR, SEMIBOLD].map(|bytes| FontRef::try_from_slice(bytes).ok()));

fn font(weight: Weight) -> Option<&'static FontRef<'static>> {
    FONTS[usize::from(weight == Weight::Strong)].as_ref()
}

/// Width of a text of a size, both in points.
#[must_use]
pub fn width(text: &str, size: f64, weight: Weight) -> f64 {
    let Some(font) = font(weight) else { return 0.0 };
    #[expect(clippy::cast_possible_truncation, reason = "a size of letters")]
    let scaled = font.as_scaled(pixel_height(font, size as f32));
    let mut width = 0.0;
    let mut previous = None;
    for glyph in text.chars().map(|letter| scaled.glyph_id(letter)) {
        width += previous.map_or(0.0, |previous| scaled.kern(previous, glyph)) + scaled.h_advance(glyph);
        previous = Some(glyph);
    }
    f64::from(width)
}

/// Covers pixels with letters of a size in pixels. The baseline begins at the origin; `cover` gets the pixel, y downwards, and
/// how much of it is covered.
pub(super) fn rasterise<E>(
    text: &str,
    size: f64,
    weight: Weight,
    mut cover: impl FnMut(i32, i32, f32) -> Result<(), E>,
) -> Result<(), E> {
    let Some(font) = font(weight) else { return Ok(()) };
    #[expect(clippy::cast_possible_truncation, reason = "a size of letters")]
    let scaled = font.as_scaled(pixel_height(font, size as f32));
    let mut x = 0.0;
    let mut previous = None;
    for letter in text.chars() {
        let id = scaled.glyph_id(letter);
        x += previous.map_or(0.0, |previous| scaled.kern(previous, id));
        previous = Some(id);
        let glyph = id.with_scale_and_position(scaled.scale(), ab_glyph::point(x, 0.0));
        x += scaled.h_advance(id);
        let Some(outline) = font.outline_glyph(glyph) else { continue };
        let corner = outline.px_bounds().min;
        let mut outcome = Ok(());
        outline.draw(|column, row, part| {
            #[expect(clippy::cast_possible_truncation, reason = "a place in a picture")]
            let [left, top] = [corner.x as i32, corner.y as i32];
            let [column, row] = [column, row].map(|offset| i32::try_from(offset).unwrap_or(i32::MAX));
            if outcome.is_ok() && part > 0.0 {
                outcome = cover(left.saturating_add(column), top.saturating_add(row), part.min(1.0));
            }
        });
        outcome?;
    }
    Ok(())
}

/// `ab_glyph` counts a size from the highest to the lowest point of a font, everyone else by the em.
fn pixel_height(font: &FontRef<'static>, size: f32) -> f32 {
    font.units_per_em().map_or(size, |em| size * font.height_unscaled() / em)
}

/// Whether the typeface has every letter of a text.
#[must_use]
pub fn has_all(text: &str) -> bool {
    let Some(font) = font(Weight::Regular) else { return false };
    text.chars().all(|letter| font.glyph_id(letter).0 != 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_are_equally_wide_and_widths_grow_with_the_size() {
        assert!((width("111", 9.0, Weight::Regular) - width("888", 9.0, Weight::Regular)).abs() < 1e-4);
        assert!((width("mm", 18.0, Weight::Regular) - 2.0 * width("mm", 9.0, Weight::Regular)).abs() < 1e-3);
        assert!(width("mm", 9.0, Weight::Strong) > width("mm", 9.0, Weight::Regular));
        assert!(width("", 9.0, Weight::Regular).abs() < f64::EPSILON);
    }

    #[test]
    fn the_signs_of_figures_are_in_the_typeface() {
        assert!(has_all("●▽▲■◆σ²−±µΔδ°√₀×…–≥"));
        assert!(!has_all("汉"));
    }

    #[test]
    fn letters_stand_on_their_baseline() {
        let (mut low, mut high) = (i32::MIN, i32::MAX);
        let drawn: Result<(), ()> = rasterise("H", 100.0, Weight::Regular, |_, y, _| {
            low = low.max(y);
            high = high.min(y);
            Ok(())
        });
        drawn.expect("nothing fails");
        // A capital letter of 100 px is 73 px high; rows begin above the baseline.
        assert!((-1..=0).contains(&low), "{low}");
        assert!((f64::from(high) + 100.0 * CAP_HEIGHT).abs() < 2.0, "{high}");
    }
}
