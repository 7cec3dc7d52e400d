//! Numbers as they are typeset in the window and in figures: the true minus sign, and as many digits as are true.

/// `value` with a fixed number of decimals and the true minus sign; a dash where there is no finite value.
#[must_use]
pub fn fixed(value: f64, decimals: usize) -> String {
    if !value.is_finite() {
        return "–".to_owned();
    }
    let text = format!("{value:.decimals$}");
    match text.strip_prefix('-') {
        // "-0.00" is nothing but rounding.
        Some(digits) if digits.bytes().all(|byte| matches!(byte, b'0' | b'.')) => digits.to_owned(),
        Some(digits) => format!("−{digits}"),
        None => text,
    }
}

/// As [`fixed`], with a plus sign before positive values, for differences.
#[must_use]
pub fn signed(value: f64, decimals: usize) -> String {
    let text = fixed(value, decimals);
    if text.starts_with(['−', '–']) { text } else { format!("+{text}") }
}

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

    #[test]
    fn numbers_carry_a_true_minus_and_no_negative_zero() {
        assert_eq!(fixed(-1.25, 1), "−1.2");
        assert_eq!(fixed(-0.0004, 3), "0.000");
        assert_eq!(fixed(f64::NAN, 3), "–");
        assert_eq!(signed(0.5, 2), "+0.50");
        assert_eq!(signed(-0.5, 2), "−0.50");
    }
}
