//! Blocks of cells as spreadsheets exchange them: tab-separated lines, cells with breaks or quotes in quotes.

use thiserror::Error;

use super::number::parse_quantity;

/// Most cells that are taken from one paste; more is no table of poses.
pub const MAX_CELLS: usize = 1_000_000;

/// More cells than a table of poses has.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
#[error("found more than {MAX_CELLS} cells, needed at most so many; paste a part of them")]
pub struct TooManyCells;

/// The cells of a pasted text, row by row. Tabs separate; where there are none, semicolons do, and then commas between
/// things that are not digits on both sides, as `12,5` is one number.
///
/// # Errors
/// [`TooManyCells`]: nothing is taken then, as a part would pass for the whole.
pub fn parse_block(text: &str) -> Result<Vec<Vec<String>>, TooManyCells> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let separator = separator_of(text);
    let mut rows = vec![Vec::new()];
    let mut cell = String::new();
    let mut num_cells = 0;
    let mut letters = text.chars().peekable();
    let mut is_start = true;
    let mut end_cell = |rows: &mut Vec<Vec<String>>, cell: &mut String| {
        if let Some(row) = rows.last_mut() {
            row.push(std::mem::take(cell).trim().to_owned());
        }
        num_cells += 1;
        if num_cells <= MAX_CELLS { Ok(()) } else { Err(TooManyCells) }
    };
    while let Some(letter) = letters.next() {
        match letter {
            '"' if is_start => {
                while let Some(quoted) = letters.next() {
                    if quoted == '"' && letters.next_if_eq(&'"').is_none() {
                        break;
                    }
                    cell.push(quoted);
                }
                is_start = false;
                continue;
            }
            '\r' => {
                letters.next_if_eq(&'\n');
                end_cell(&mut rows, &mut cell)?;
                rows.push(Vec::new());
            }
            '\n' => {
                end_cell(&mut rows, &mut cell)?;
                rows.push(Vec::new());
            }
            _ if Some(letter) == separator => end_cell(&mut rows, &mut cell)?,
            _ => {
                cell.push(letter);
                is_start = false;
                continue;
            }
        }
        is_start = true;
    }
    end_cell(&mut rows, &mut cell)?;
    // A line's end at the end of the text begins no further row.
    while rows.len() > 1 && rows.last().is_some_and(|row| row.iter().all(String::is_empty)) {
        rows.pop();
    }
    Ok(rows)
}

fn separator_of(text: &str) -> Option<char> {
    if text.contains('\t') {
        return Some('\t');
    }
    if text.contains(';') {
        return Some(';');
    }
    // One number a line, with separators of thousands.
    if text.lines().all(|line| line.trim().is_empty() || parse_quantity(line).is_ok()) {
        return None;
    }
    // With decimal points about, or blanks behind them, commas separate.
    let has_points = text.bytes().any(|byte| byte == b'.');
    let is_list =
        |line: &str| line.matches(',').count() > 1 || line.contains(", ") || (has_points && line.contains(','));
    text.lines().any(is_list).then_some(',')
}

/// The text of a block, as spreadsheets take it.
#[must_use]
pub fn block_text(rows: &[Vec<String>]) -> String {
    let cell = |text: &String| {
        if text.contains(['\t', '\n', '\r']) || text.starts_with('"') {
            format!("\"{}\"", text.replace('"', "\"\""))
        } else {
            text.clone()
        }
    };
    let mut text = String::new();
    for row in rows {
        text.push_str(&row.iter().map(cell).collect::<Vec<_>>().join("\t"));
        text.push('\n');
    }
    text
}

/// Whether a text is rather a robot program, a printed table with named values or a file than cells of this table.
#[must_use]
pub fn is_for_import(text: &str) -> bool {
    let has_named_value = ["q_0", "q0=", "x=", "X=", "X ="].iter().any(|name| text.contains(name));
    let has_program =
        ["/PROG", "/POS", "P[", "MODULE", "robtarget", "DEFDAT", "E6POS", "p[", "LIN ", "PTP ", "movej", "movel"]
            .iter()
            .any(|word| text.contains(word));
    let is_structured = text.trim_start().starts_with(['{', '[']) || text.contains("points:");
    has_named_value || has_program || is_structured
}
