//! Sheets of numbers, as people and programs write them: text of any origin to records, cells and numbers, where the numbers
//! begin, what unit a column has, and the profile in a sheet.
//!
//! It knows neither files nor documents: the imports of a session and the watched folder of a profiler read by it alike.

pub mod layout;
pub mod profile;
pub mod text;
pub mod unit;

/// What separates the cells of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Separator {
    /// `,`
    Comma,
    /// `;`
    Semicolon,
    /// A tabulator.
    Tab,
    /// Any number of blanks.
    Blanks,
}

/// Sorts `p2` before `p10`: text and numbers in turn.
pub fn natural_key(name: &str) -> Vec<(String, Option<u64>)> {
    let mut key = Vec::new();
    let mut rest = name;
    while !rest.is_empty() {
        let digits_at = rest.find(|c: char| c.is_ascii_digit()).unwrap_or(rest.len());
        let (text, after) = rest.split_at(digits_at);
        let digits_end = after.find(|c: char| !c.is_ascii_digit()).unwrap_or(after.len());
        let (digits, after) = after.split_at(digits_end);
        key.push((text.to_lowercase(), digits.parse().ok()));
        rest = after;
    }
    key
}
