//! Where the numbers of a sheet begin, what separates them, and the names above them.

use super::Separator;
use super::text::{Cell, Record, excerpt, is_missing, number, records, split};
use super::unit::is_unit;

/// Rows that recognition looks at.
const MAX_SAMPLE_ROWS: usize = 100;
/// Records that recognition looks at in search of rows of numbers.
const MAX_SAMPLE_RECORDS: usize = 1000;
/// Columns of the preview, and of a table of poses.
pub const MAX_COLUMNS: usize = 64;
/// What is known of a sheet beforehand; `None` is left to recognition.
#[derive(Clone, Copy, Debug, Default)]
pub struct Given {
    /// Between the cells.
    pub separator: Option<Separator>,
    /// Whether `1,5` is one and a half.
    pub has_decimal_comma: Option<bool>,
    /// Whether the first row has names.
    pub has_header: Option<bool>,
}

/// How a table stands in its text.
#[derive(Clone, Debug)]
pub struct Layout {
    pub separator: Separator,
    pub has_decimal_comma: bool,
    /// Line of the first row of numbers, from 1.
    pub first_row_line: usize,
    /// Cells of the row above the numbers that names the columns.
    pub header: Option<Vec<String>>,
    /// Cells of a second row of the header, with units.
    pub units: Option<Vec<String>>,
    /// The first rows, NaN where there is no number.
    pub sample: Vec<Vec<f64>>,
    pub num_columns: usize,
}

/// A line that says nothing to a program.
pub fn is_comment(record: &str, separator: Separator) -> bool {
    let text = record.trim_start();
    text.starts_with(['#', '%'])
        || text.starts_with("//")
        || (text.starts_with(';') && separator != Separator::Semicolon)
}

/// Whether a row is one of values: at least two numbers, and half of its cells; or x without a z.
fn is_row_of_numbers(cells: &[Cell<'_>], has_decimal_comma: bool) -> bool {
    let num_filled = cells.iter().filter(|cell| !is_missing(cell.text)).count();
    let num_numbers = cells.iter().filter(|cell| number(cell.text, has_decimal_comma).is_some()).count();
    (num_numbers >= 2 && 2 * num_numbers >= num_filled) || (num_numbers == 1 && num_filled == 1 && cells.len() > 1)
}

/// What separates the cells, and whether the numbers have a decimal comma.
fn separation(text: &str, given: Given) -> Option<(Separator, bool)> {
    /// In doubt the earlier: blanks are within cells more often than tabulators.
    const ORDER: [Separator; 4] = [Separator::Tab, Separator::Semicolon, Separator::Comma, Separator::Blanks];
    /// A later separator must explain the cells better by so much.
    const CLEARLY_BETTER: f64 = 0.15;
    let mut found: Vec<(Separator, bool, f64, usize)> = Vec::new();
    for separator in ORDER {
        if given.separator.is_some_and(|wanted| wanted != separator) {
            continue;
        }
        let mut cells = Vec::new();
        let (mut num_rows, mut num_cells, mut num_numbers, mut num_commas) = (0, 0, 0, 0);
        for record in records(text).take(MAX_SAMPLE_RECORDS) {
            if is_comment(record.text, separator) {
                continue;
            }
            split(record.text, separator, &mut cells);
            let filled = cells.iter().filter(|cell| !is_missing(cell.text));
            let numbers = filled.clone().filter(|cell| number(cell.text, true).is_some()).count();
            if numbers >= 2 {
                num_rows += 1;
                num_numbers += numbers;
                num_cells += filled.clone().count();
                num_commas += filled.filter(|cell| cell.text.contains(',') && !cell.text.contains('.')).count();
            }
            if num_rows >= MAX_SAMPLE_ROWS {
                break;
            }
        }
        if num_rows > 0 {
            #[expect(clippy::cast_precision_loss, reason = "at most a few thousand cells")]
            let quality = num_numbers as f64 / num_cells as f64;
            found.push((separator, given.has_decimal_comma.unwrap_or(num_commas > 0), quality, num_rows));
        }
    }
    let best = found.iter().map(|(_, _, quality, _)| *quality).fold(0.0, f64::max);
    let most_rows = found.iter().map(|(_, _, _, num_rows)| *num_rows).max()?;
    found
        .iter()
        .find(|(_, _, quality, num_rows)| *quality >= best - CLEARLY_BETTER && 2 * num_rows >= most_rows)
        .map(|(separator, has_decimal_comma, _, _)| (*separator, *has_decimal_comma))
}

/// The layout of a table; `None` if there are no rows of numbers.
pub fn layout(text: &str, given: Given) -> Option<Layout> {
    let (separator, has_decimal_comma) = separation(text, given)?;
    let mut layout = Layout {
        separator,
        has_decimal_comma,
        first_row_line: 0,
        header: None,
        units: None,
        sample: Vec::new(),
        num_columns: 0,
    };
    let mut cells = Vec::new();
    // The two records before the first row of numbers, comments among them: "# x y z" is a header too.
    let mut before: [Option<Record<'_>>; 2] = [None, None];
    let (mut first, mut second_line) = (None, 0);
    for record in records(text).take(MAX_SAMPLE_RECORDS) {
        split(record.text, separator, &mut cells);
        let is_comment = is_comment(record.text, separator);
        if !is_comment && is_row_of_numbers(&cells, has_decimal_comma) {
            if layout.sample.is_empty() {
                layout.first_row_line = record.line;
                first = cells.first().filter(|cell| cell.text.starts_with(['x', 'X'])).map(|_| record);
            } else if layout.sample.len() == 1 {
                second_line = record.line;
            }
            let row = cells.iter().take(MAX_COLUMNS);
            layout.sample.push(row.map(|cell| number(cell.text, has_decimal_comma).unwrap_or(f64::NAN)).collect());
            if layout.sample.len() >= MAX_SAMPLE_ROWS {
                break;
            }
        } else if layout.sample.is_empty() && !is_rule(record.text) {
            before = [before[1], Some(record)];
        }
    }
    if layout.sample.is_empty() {
        return None;
    }
    // Profiles may have numbers for names; then only the first cell tells, as in "x_mm, 1, 2".
    if let Some(record) = first
        && layout.sample.len() > 1
        && layout.sample[0][0].is_nan()
    {
        before = [before[1], Some(record)];
        layout.sample.remove(0);
        layout.first_row_line = second_line;
    }
    layout.num_columns = usual_num_columns(&layout.sample);
    let names = |record: Record<'_>| {
        let mut cells = Vec::new();
        let text = record.text.trim_start_matches(['#', '%', '/', ' ']);
        split(text, separator, &mut cells);
        cells.iter().take(MAX_COLUMNS).map(|cell| excerpt(cell.text).into_owned()).collect::<Vec<String>>()
    };
    if given.has_header != Some(false) {
        let nearest = before[1].map(names);
        let above = before[0].map(names);
        let is_units = |cells: &Vec<String>| cells.len() > 1 && cells.iter().all(|cell| is_unit(cell));
        (layout.header, layout.units) = match nearest {
            Some(nearest) if is_units(&nearest) => (above, Some(nearest)),
            other => (other, None),
        };
    }
    Some(layout)
}

/// The line below the header of a Markdown table, and other lines that are drawn.
pub fn is_rule(record: &str) -> bool {
    record.chars().all(|c| matches!(c, '|' | '-' | ':' | '+' | '=' | ' ' | '\t' | '_' | '*'))
}

fn usual_num_columns(sample: &[Vec<f64>]) -> usize {
    let count = |len: usize| sample.iter().filter(|row| row.len() == len).count();
    // Ties go to the longer row: cells are forgotten rather than added.
    sample.iter().map(Vec::len).max_by_key(|len| (count(*len), *len)).unwrap_or_default()
}
