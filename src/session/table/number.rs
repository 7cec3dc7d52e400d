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

/// A unit that may stand behind a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// Millimetres.
    Millimetres,
    /// Metres.
    Metres,
    /// Degrees.
    Degrees,
    /// Radians.
    Radians,
}

impl Unit {
    /// The unit that a text names.
    #[must_use]
    pub fn parse(text: &str) -> Option<Self> {
        match text {
            "mm" => Some(Self::Millimetres),
            "m" => Some(Self::Metres),
            "°" | "deg" => Some(Self::Degrees),
            "rad" => Some(Self::Radians),
            _ => None,
        }
    }

    /// What a number of this unit is multiplied with to be one of the other; `None` between a length and an angle.
    #[must_use]
    pub const fn factor_to(self, other: Self) -> Option<f64> {
        match (self, other) {
            (Self::Millimetres, Self::Millimetres)
            | (Self::Metres, Self::Metres)
            | (Self::Degrees, Self::Degrees)
            | (Self::Radians, Self::Radians) => Some(1.0),
            (Self::Metres, Self::Millimetres) => Some(1e3),
            (Self::Millimetres, Self::Metres) => Some(1e-3),
            (Self::Radians, Self::Degrees) => Some(180.0 / std::f64::consts::PI),
            (Self::Degrees, Self::Radians) => Some(std::f64::consts::PI / 180.0),
            _ => None,
        }
    }
}

/// Reads a number and the unit behind it, if there is one.
///
/// # Errors
/// [`NotANumber`].
pub fn parse_quantity(text: &str) -> Result<(f64, Option<Unit>), NotANumber> {
    let trimmed = text.trim();
    let (number, unit) =
        trimmed.split_at(trimmed.trim_end_matches(|letter: char| letter.is_alphabetic() || letter == '°').len());
    match Unit::parse(unit) {
        Some(unit) if !number.is_empty() => {
            let refused = |_| NotANumber::Text { found: shortened(trimmed) };
            parse_number(number).map(|number| (number, Some(unit))).map_err(refused)
        }
        _ => parse_number(text).map(|number| (number, None)),
    }
}

fn shortened(text: &str) -> String {
    text.chars().take(40).collect()
}

/// Reads a number without a unit; `12,5` is twelve and a half, `1.234,5`, `1,234.5` and `1 234,5` have thousands
/// separators, a true minus and a plus are understood. NaN and infinity are not numbers.
///
/// A single comma or point is always the decimal one.
///
/// # Errors
/// [`NotANumber`].
pub fn parse_number(text: &str) -> Result<f64, NotANumber> {
    let trimmed = text.trim();
    if trimmed.is_empty() {
        return Err(NotANumber::Empty);
    }
    let refused = || NotANumber::Text { found: shortened(trimmed) };
    let (negative, magnitude) = match trimmed.strip_prefix(['-', '−', '–']) {
        Some(rest) => (true, rest),
        None => (false, trimmed.strip_prefix('+').unwrap_or(trimmed)),
    };
    let (mantissa, exponent) = match magnitude.find(['e', 'E']) {
        Some(at) => (&magnitude[..at], exponent(&magnitude[at + 1..]).ok_or_else(refused)?),
        None => (magnitude, 0),
    };
    let digits = plain_digits(mantissa.trim_start()).ok_or_else(refused)?;
    let number: f64 = format!("{digits}e{exponent}").parse().map_err(|_| refused())?;
    if number.is_finite() { Ok(if negative { -number } else { number }) } else { Err(refused()) }
}

fn exponent(text: &str) -> Option<i32> {
    text.replace('−', "-").parse().ok()
}

/// Digits with at most a decimal point; `None` if it is anything else or if separators stand where none belong.
fn plain_digits(mantissa: &str) -> Option<String> {
    let is_blank = |letter: char| matches!(letter, ' ' | '\u{a0}' | '\u{202f}' | '\u{2009}' | '\'' | '’');
    let last = mantissa.rfind(['.', ',']);
    let is_decimal = |at: usize| {
        let separator = &mantissa[at..=at];
        // Once at most, and the others before it.
        mantissa.matches(separator).count() == 1
    };
    let (whole, fraction) = match last {
        Some(at) if is_decimal(at) => (&mantissa[..at], Some(&mantissa[at + 1..])),
        _ => (mantissa, None),
    };
    let fraction = fraction.unwrap_or_default();
    let separators: Vec<char> = whole.chars().filter(|letter| !letter.is_ascii_digit()).collect();
    let is_separator = |letter: char| is_blank(letter) || letter == '.' || letter == ',';
    let grouped = separators.iter().all(|letter| is_separator(*letter) && *letter == separators[0]);
    let groups: Vec<&str> = whole.split(|letter: char| !letter.is_ascii_digit()).collect();
    let threes = groups.iter().skip(1).all(|group| group.len() == 3) && (groups.len() == 1 || !groups[0].is_empty());
    if !grouped || !threes || !fraction.bytes().all(|byte| byte.is_ascii_digit()) {
        return None;
    }
    let whole: String = groups.concat();
    (!whole.is_empty() || !fraction.is_empty()).then(|| format!("{whole}.{fraction}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn check(text: &str, expected: Option<f64>) {
        assert_eq!(parse_number(text).ok(), expected, "{text:?}");
    }

    #[test]
    fn numbers_of_any_country() {
        for (text, value) in [
            ("12", 12.0),
            (" 12.5 ", 12.5),
            ("12,5", 12.5),
            ("-0,25", -0.25),
            ("−3", -3.0),
            ("+7.", 7.0),
            (".5", 0.5),
            (",5", 0.5),
            ("1e-3", 1e-3),
            ("1.5E+02", 150.0),
            ("1,5e−2", 0.015),
            ("1.234,5", 1234.5),
            ("1,234.5", 1234.5),
            ("1.234.567", 1_234_567.0),
            ("1.234.567,25", 1_234_567.25),
            ("1 234,5", 1234.5),
            ("1\u{202f}234,5", 1234.5),
            ("1'234.5", 1234.5),
            // One separator is the decimal one, whatever follows it.
            ("1.234", 1.234),
            ("1,234", 1.234),
            ("0.1 + 0.2", f64::NAN),
        ] {
            check(text, (!value.is_nan()).then_some(value));
        }
    }

    #[test]
    fn what_is_no_number_is_refused() {
        for text in [
            "",
            " ",
            "-",
            ".",
            ",",
            "e5",
            "1e",
            "nan",
            "inf",
            "-inf",
            "infinity",
            "1.2.3",
            "1,2,3",
            "1.23.456",
            "1..2",
            "12 5",
            "1 2",
            "--3",
            "+-3",
            "1-2",
            "0x10",
            "abc",
            "1e999",
            "1.234,567,8",
            "1,234.567.8",
            "..5",
            "1.2e3.4",
            "mm",
            "5 kg",
            "12 mm",
            "0.5 m",
        ] {
            check(text, None);
        }
    }

    #[test]
    fn a_unit_is_told_from_its_number() {
        for (text, expected) in [
            ("12 mm", Some((12.0, Some(Unit::Millimetres)))),
            ("90°", Some((90.0, Some(Unit::Degrees)))),
            ("0,5 m", Some((0.5, Some(Unit::Metres)))),
            ("1.57rad", Some((1.57, Some(Unit::Radians)))),
            ("1e3", Some((1e3, None))),
            ("mm", None),
            ("5 kg", None),
        ] {
            assert_eq!(parse_quantity(text).ok(), expected, "{text}");
        }
        assert_eq!(Unit::Metres.factor_to(Unit::Millimetres), Some(1e3));
        assert_eq!(Unit::Metres.factor_to(Unit::Degrees), None);
    }

    #[test]
    fn the_refusal_shows_what_was_found() {
        assert_eq!(parse_number(" "), Err(NotANumber::Empty));
        assert_eq!(parse_number(" abc "), Err(NotANumber::Text { found: "abc".to_owned() }));
    }
}
