//! Numbers as people type them and as spreadsheets of any country copy them.

use thiserror::Error;

/// Why a text is not a number.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum NotANumber {
    /// Nothing there.
    #[error("found nothing, needed a number")]
    Empty,
    /// Something else.
    #[error("found \"{found}\", needed a number such as 12.5 or 12,5")]
    Text {
        /// The text.
        found: String,
    },
}

/// Reads a number; `12,5` is twelve and a half, `1.234,5` and `1,234.5` have a thousands separator, and a true minus and a
/// plus are understood. NaN and infinity are not numbers.
///
/// # Errors
/// [`NotANumber`].
pub fn parse_number(text: &str) -> Result<f64, NotANumber> {
    let trimmed = text.trim();
    if trimmed.is_empty() {
        return Err(NotANumber::Empty);
    }
    let refused = || NotANumber::Text { found: trimmed.chars().take(40).collect() };
    let plain: String =
        trimmed.chars().filter(|c| !c.is_whitespace()).map(|c| if c == '−' { '-' } else { c }).collect();
    let normalised = match (plain.rfind(','), plain.rfind('.')) {
        (Some(_), None) if plain.matches(',').count() == 1 => plain.replace(',', "."),
        (Some(comma), Some(point)) if comma > point => plain.replace('.', "").replace(',', "."),
        (Some(_), Some(_)) => plain.replace(',', ""),
        _ => plain,
    };
    let has_digit_first =
        normalised.trim_start_matches(['+', '-']).starts_with(|c: char| c.is_ascii_digit() || c == '.');
    let number: f64 = normalised.parse().map_err(|_| refused())?;
    if has_digit_first && number.is_finite() { Ok(number) } else { Err(refused()) }
}
