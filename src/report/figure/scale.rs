//! What a plot shows, and the marks of its axes: shared by the window and the figures on paper.

use crate::text::typeset::fixed;

/// Free room around the data, as a part of its extent.
const MARGIN: f64 = 0.06;

/// What a plot shows when it is fitted to its data.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extent {
    /// Range of x.
    pub x: [f64; 2],
    /// Range of y.
    pub y: [f64; 2],
}

impl Extent {
    /// Nothing yet; grows with [`Self::include`].
    pub const NOTHING: Self = Self { x: [f64::INFINITY, f64::NEG_INFINITY], y: [f64::INFINITY, f64::NEG_INFINITY] };

    /// Grows to hold a point.
    pub fn include(&mut self, x: f64, y: f64) {
        self.x = [self.x[0].min(x), self.x[1].max(x)];
        self.y = [self.y[0].min(y), self.y[1].max(y)];
    }

    /// With a margin, and never empty.
    #[must_use]
    pub fn with_margin(self) -> Self {
        let widen = |[low, high]: [f64; 2]| {
            if !(low.is_finite() && high.is_finite()) {
                return [-1.0, 1.0];
            }
            let margin = if high > low { (high - low) * MARGIN } else { low.abs().max(1.0) * MARGIN };
            [low - margin, high + margin]
        };
        Self { x: widen(self.x), y: widen(self.y) }
    }

    /// Widened in one direction until both scales are equal in a plot of this size.
    #[must_use]
    pub fn with_equal_scales(self, width: f64, height: f64) -> Self {
        let scale = ((self.x[1] - self.x[0]) / width).max((self.y[1] - self.y[0]) / height);
        let around = |[low, high]: [f64; 2], size: f64| {
            let middle = f64::midpoint(low, high);
            [middle - scale * size / 2.0, middle + scale * size / 2.0]
        };
        Self { x: around(self.x, width), y: around(self.y, height) }
    }
}

/// The least step of 1, 2 or 5 times a power of ten that is not below `least`; `None` if there is none.
#[must_use]
pub fn round_step(least: f64) -> Option<f64> {
    if !(least.is_finite() && least > 0.0) {
        return None;
    }
    let decade = 10.0_f64.powf(least.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].map(|factor| factor * decade).into_iter().find(|step| *step >= least);
    Some(step.unwrap_or(least))
}

/// The multiples of a step within a range; none where they would be too many to tell apart.
#[must_use]
pub fn multiples([low, high]: [f64; 2], step: f64) -> Vec<f64> {
    const MOST: f64 = 500.0;
    let (first, last) = ((low / step).ceil(), (high / step).floor());
    let count = last - first;
    if count.is_nan() || count > MOST {
        return Vec::new();
    }
    let mut values = Vec::new();
    let mut multiple = first;
    while multiple <= last {
        values.push(multiple * step);
        multiple += 1.0;
    }
    values
}

/// The label of a mark, with as many decimals as the step between marks needs.
#[must_use]
pub fn tick_label(value: f64, step: f64) -> String {
    if value.abs() < step * 1e-6 {
        return "0".to_owned();
    }
    let decimals = (-step.log10()).ceil().clamp(0.0, 6.0);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to 0..=6")]
    fixed(value, decimals as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_fall_on_round_numbers() {
        let step = round_step(0.0735).expect("a step");
        let values = multiples([-0.31, 0.29], step);
        assert_eq!(values.len(), 6, "{values:?}");
        assert!(values.iter().all(|value| (value * 10.0 - (value * 10.0).round()).abs() < 1e-9), "{values:?}");
        assert_eq!(tick_label(-0.2, step), "−0.2");
        assert_eq!(round_step(0.0), None);
        assert_eq!(round_step(f64::NAN), None);
    }

    #[test]
    fn equal_scales_only_widen() {
        let extent = Extent { x: [0.0, 10.0], y: [0.0, 1.0] }.with_equal_scales(200.0, 100.0);
        assert_eq!(extent, Extent { x: [0.0, 10.0], y: [-2.0, 3.0] });
    }

    #[test]
    fn an_empty_extent_still_has_a_view() {
        let view = Extent::NOTHING.with_margin();
        assert!(view.x[1] > view.x[0] && view.y[1] > view.y[0]);
    }
}
