//! Numbers with as many digits as are true.

/// Decimals shown for a length (mm) or angle (°) whose uncertainty is unknown.
const DEFAULT_DECIMALS: usize = 3;
/// Beyond this many decimals nothing in the field means anything.
const MAX_DECIMALS: usize = 6;

/// Decimals at which an uncertainty shows two significant digits; three where it is unknown.
#[must_use]
pub fn decimals_for(std: Option<f64>) -> usize {
    let Some(std) = std.filter(|std| std.is_finite() && *std > 0.0) else {
        return DEFAULT_DECIMALS;
    };
    // Two digits: 0.012 → 3, 0.12 → 2, 1.2 → 1.
    let mut decimals = 0;
    let mut scaled = std;
    while scaled < 9.5 && decimals < MAX_DECIMALS {
        scaled *= 10.0;
        decimals += 1;
    }
    decimals
}

/// A value to the decimals that its uncertainty allows.
#[must_use]
pub fn value(value: f64, std: Option<f64>) -> String {
    fixed(value, decimals_for(std))
}

/// A value to so many decimals; what rounds to nothing has no sign.
#[must_use]
pub fn fixed(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    let is_zero = text.bytes().all(|byte| matches!(byte, b'-' | b'0' | b'.'));
    if is_zero { text.trim_start_matches('-').to_owned() } else { text }
}

/// A value to at most so many decimals, without zeros at its end.
#[must_use]
pub fn plain(value: f64, decimals: usize) -> String {
    let text = fixed(value, decimals);
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// The same with its sign always shown.
#[must_use]
pub fn signed(value: f64, decimals: usize) -> String {
    let text = fixed(value, decimals);
    if text.starts_with('-') || text.bytes().all(|byte| matches!(byte, b'0' | b'.')) {
        text
    } else {
        format!("+{text}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_follow_the_uncertainty() {
        for (std, expected) in [(0.012, 3), (0.12, 2), (1.2, 1), (12.0, 0), (0.096, 2), (1e-12, 6)] {
            assert_eq!(decimals_for(Some(std)), expected, "{std}");
        }
        assert_eq!(decimals_for(None), 3);
        assert_eq!(decimals_for(Some(f64::NAN)), 3);
        assert_eq!(value(12.345_67, Some(0.12)), "12.35");
    }

    #[test]
    fn zeros_at_the_end_say_nothing() {
        for (value, expected) in [(100.0, "100"), (0.25, "0.25"), (-0.000_01, "0"), (12.345_678, "12.3457")] {
            assert_eq!(plain(value, 4), expected);
        }
    }

    #[test]
    fn nothing_has_no_sign() {
        assert_eq!(fixed(-0.0001, 3), "0.000");
        assert_eq!(signed(0.0001, 3), "0.000");
        assert_eq!(signed(0.1, 1), "+0.1");
        assert_eq!(signed(-0.1, 1), "-0.1");
    }
}
