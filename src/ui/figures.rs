//! As many digits as are true: values with their standard deviations.

use crate::ui::widgets::{fixed, signed};

/// Decimals that show two significant digits of a standard deviation; three (micrometres) where it is not known.
#[must_use]
pub fn decimals_of_std(std: f64) -> usize {
    if !(std.is_finite() && std > 0.0) {
        return 3;
    }
    let decimals = (1.0 - std.log10().floor()).clamp(0.0, 6.0);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to 0..=6")]
    let decimals = decimals as usize;
    decimals
}

/// A standard deviation with two significant digits.
#[must_use]
pub fn std_text(std: f64) -> String {
    fixed(std, decimals_of_std(std))
}

/// `value ± std`, both with the decimals that the standard deviation allows.
#[must_use]
pub fn with_std(value: f64, std: f64) -> String {
    format!("{} ± {}", fixed(value, decimals_of_std(std)), std_text(std))
}

/// All digits, for the hover.
#[must_use]
pub fn all_digits(value: f64) -> String {
    signed(value, 9)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_standard_deviation_sets_the_digits() {
        assert_eq!(with_std(13.481_94, 0.0042), "13.4819 ± 0.0042");
        assert_eq!(with_std(-5.614, 0.55), "−5.61 ± 0.55");
        assert_eq!(std_text(12.3), "12");
        assert_eq!(std_text(0.0), "0.000");
    }
}
