//! A matrix in pasted text: from a paper, a controller, a spreadsheet, Python or MATLAB.

use thiserror::Error;

use crate::geometry::{Mat3, Vec3};

use super::GivenMatrix;

/// Why a text is no matrix of a calibration.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum MatrixRefusal {
    /// Nothing to read.
    #[error("found no numbers; paste the 12 numbers of a 3 × 4 matrix or the 16 of a 4 × 4 one, row by row")]
    Empty,
    /// A word among the numbers.
    #[error("found \"{found}\" as number {place}, needed a number with a decimal point, such as -0.331")]
    NotANumber {
        /// What stands there.
        found: String,
        /// Its place, from 1.
        place: usize,
    },
    /// Decimal commas.
    #[error(
        "found \"{found}\" with a comma within the number, needed a decimal point, such as 0.998: replace the commas"
    )]
    DecimalComma {
        /// The first of them.
        found: String,
    },
    /// Neither shape.
    #[error("found {found} numbers, needed 12 (3 rows of 4) or 16 (4 rows of 4), row by row")]
    WrongCount {
        /// How many were found.
        found: usize,
    },
    /// A matrix that maps something else.
    #[error("found the last row {}, needed 0 0 0 1{}", joined(found), if *is_transposed { "; the matrix is transposed: swap its rows and columns" } else { "" })]
    LastRow {
        /// The row.
        found: [f64; 4],
        /// Whether the fourth column is what the row should be.
        is_transposed: bool,
    },
}

fn joined(row: &[f64; 4]) -> String {
    row.map(|value| value.to_string()).join(" ")
}

/// Longest text that is looked at: sixteen numbers with a hundred characters each are none any more.
const MOST_CHARS: usize = 10_000;
/// A last row of 0 0 0 1 as rounded numbers have it.
const LAST_ROW_WITHIN: f64 = 1e-6;

/// Reads a matrix: numbers row by row between brackets, commas, semicolons, bars and blanks of any kind. A comma separates
/// numbers; it is no decimal point.
///
/// # Errors
/// [`MatrixRefusal`], with what was found.
pub fn parse_matrix(text: &str) -> Result<GivenMatrix, MatrixRefusal> {
    numbers_of(text).map_err(|refusal| match decimal_comma(text) {
        Some(found) => MatrixRefusal::DecimalComma { found: shortened(found) },
        None => refusal,
    })
}

/// The first number with a decimal comma, in a text where nothing has a decimal point.
fn decimal_comma(text: &str) -> Option<&str> {
    let is_decimal = |word: &&str| {
        let is_number = |part: &str| !part.is_empty() && part.bytes().all(|byte| byte.is_ascii_digit());
        let unsigned = word.trim_start_matches(['-', '+', '\u{2212}']);
        unsigned.split_once(',').is_some_and(|(whole, behind)| is_number(whole) && is_number(behind))
    };
    let words = text.split(|c: char| c.is_whitespace() || "[](){};|".contains(c));
    if text.contains('.') { None } else { words.into_iter().find(is_decimal) }
}

fn numbers_of(text: &str) -> Result<GivenMatrix, MatrixRefusal> {
    let is_between = |c: char| c.is_whitespace() || "[](){}<>|,;\"'".contains(c);
    let text: &str = text.char_indices().nth(MOST_CHARS).map_or(text, |(end, _)| &text[..end]);
    let tokens: Vec<&str> = text.split(is_between).filter(|token| !token.is_empty()).collect();
    if tokens.is_empty() {
        return Err(MatrixRefusal::Empty);
    }
    let mut values = Vec::with_capacity(16);
    let mut decimals = Vec::with_capacity(16);
    for (idx, token) in tokens.iter().enumerate() {
        // Papers and office programs have their own minus.
        let plain = token.replace(['\u{2212}', '\u{2013}', '\u{ff0d}'], "-");
        match plain.parse::<f64>() {
            Ok(value) if value.is_finite() => values.push(value),
            _ => return Err(MatrixRefusal::NotANumber { found: shortened(token), place: idx + 1 }),
        }
        decimals.push(decimals_of(&plain));
    }
    if values.len() != 12 && values.len() != 16 {
        return Err(MatrixRefusal::WrongCount { found: values.len() });
    }
    if let Some(&[a, b, c, d]) = values.get(12..16) {
        let is_off =
            |values: [f64; 4]| values.iter().zip([0.0, 0.0, 0.0, 1.0]).any(|(a, b)| (a - b).abs() > LAST_ROW_WITHIN);
        if is_off([a, b, c, d]) {
            let is_transposed = !is_off([values[3], values[7], values[11], values[15]]);
            return Err(MatrixRefusal::LastRow { found: [a, b, c, d], is_transposed });
        }
    }
    let of_rotation = |row: usize, column: usize| row * 4 + column;
    let places = (0..3).flat_map(|row| (0..3).map(move |column| of_rotation(row, column)));
    Ok(GivenMatrix {
        rotation: Mat3::from_fn(|row, column| values[of_rotation(row, column)]),
        translation_mm: Vec3::new(values[3], values[7], values[11]),
        // Trailing zeros are often left out, so the longest number tells.
        decimals: places.map(|place| decimals[place]).max().unwrap_or(0),
    })
}

fn shortened(token: &str) -> String {
    const MOST: usize = 24;
    let mut short: String = token.chars().take(MOST).collect();
    if token.chars().nth(MOST).is_some() {
        short.push('…');
    }
    short
}

/// Digits behind the point, as many as the number's exponent leaves there.
fn decimals_of(number: &str) -> usize {
    let (mantissa, exponent) = number.split_once(['e', 'E']).unwrap_or((number, "0"));
    let written = mantissa.split_once('.').map_or(0, |(_, behind)| behind.len());
    let exponent: i64 = exponent.parse().unwrap_or(0);
    let decimals = i64::try_from(written).unwrap_or(0).saturating_sub(exponent);
    usize::try_from(decimals.clamp(0, 15)).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimals_follow_the_exponent() {
        for (number, decimals) in [("1", 0), ("0.944", 3), ("9.44e-1", 3), ("1e-3", 3), ("1.5E2", 0), ("-.5", 1)] {
            assert_eq!(decimals_of(number), decimals, "{number}");
        }
    }
}
