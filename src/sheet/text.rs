//! Text of any origin: bytes to text, records and cells with their columns, and numbers as people and programs write them.

use std::borrow::Cow;

use super::Separator;

/// Half-width twins of full-width characters begin this far below them.
const FULL_WIDTH_OFFSET: u32 = 0xfee0;
/// A quoted cell may run over so many line ends; a quotation mark that is closed later is one by mistake.
const MAX_QUOTED_LINE_ENDS: usize = 4;

/// Decodes the bytes of a file: UTF-8, UTF-16 with its byte order mark, and for older programs one byte a character.
///
/// Numbers and separators are ASCII in every encoding of the last kind (Latin-1, GBK, …), so poses are read from it all the
/// same; other characters become `�`.
pub fn decode(bytes: Vec<u8>) -> String {
    match bytes.as_slice() {
        [0xff, 0xfe, rest @ ..] => utf_16(rest, u16::from_le_bytes),
        [0xfe, 0xff, rest @ ..] => utf_16(rest, u16::from_be_bytes),
        [0xef, 0xbb, 0xbf, rest @ ..] => String::from_utf8_lossy(rest).into_owned(),
        _ => String::from_utf8(bytes).unwrap_or_else(|error| String::from_utf8_lossy(error.as_bytes()).into_owned()),
    }
}

fn utf_16(bytes: &[u8], unit: fn([u8; 2]) -> u16) -> String {
    let units = bytes.chunks_exact(2).map(|pair| unit([pair[0], pair[1]]));
    char::decode_utf16(units).map(|decoded| decoded.unwrap_or(char::REPLACEMENT_CHARACTER)).collect()
}

/// Text without a byte order mark.
pub fn without_mark(text: &str) -> &str {
    text.strip_prefix('\u{feff}').unwrap_or(text)
}

/// The lines of a text with their numbers from 1, whatever ends them: LF, CR LF or CR.
pub fn lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let mut rest = Some(text);
    let mut number = 0;
    std::iter::from_fn(move || {
        let text = rest.filter(|text| !text.is_empty())?;
        number += 1;
        let (line, after) = split_line(text);
        rest = Some(after);
        Some((number, line))
    })
}

fn split_line(text: &str) -> (&str, &str) {
    match text.find(['\n', '\r']) {
        Some(end) => {
            let after = &text[end..];
            let after = after.strip_prefix("\r\n").unwrap_or_else(|| &after[1..]);
            (&text[..end], after)
        }
        None => (text, ""),
    }
}

/// A row of a table: a line, or several where a quoted cell runs over its end.
#[derive(Clone, Copy, Debug)]
pub struct Record<'t> {
    /// Line of its beginning, from 1.
    pub line: usize,
    /// Its text.
    pub text: &'t str,
}

/// The records of a text, without blank lines.
pub fn records(text: &str) -> impl Iterator<Item = Record<'_>> {
    let mut rest = text;
    let mut next_line = 1;
    std::iter::from_fn(move || {
        loop {
            if rest.is_empty() {
                return None;
            }
            let (text, after, num_lines) = split_record(rest);
            let record = Record { line: next_line, text };
            rest = after;
            next_line += num_lines;
            if !text.trim().is_empty() {
                return Some(record);
            }
        }
    })
}

fn split_record(text: &str) -> (&str, &str, usize) {
    let (first, after_first) = split_line(text);
    let is_open = |text: &str| text.bytes().filter(|byte| *byte == b'"').count() % 2 == 1;
    if is_open(first) {
        let mut after = after_first;
        for num_lines in 2..=MAX_QUOTED_LINE_ENDS + 1 {
            if after.is_empty() {
                break;
            }
            let (_, next) = split_line(after);
            after = next;
            let whole = &text[..text.len() - after.len()];
            if !is_open(whole) {
                return (whole.trim_end_matches(['\n', '\r']), after, num_lines);
            }
        }
    }
    (first, after_first, 1)
}

/// A cell of a record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cell<'t> {
    /// Its text, without quotation marks and blanks around it.
    pub text: &'t str,
    /// Where it begins, in bytes of the record.
    start: usize,
}

impl Cell<'_> {
    /// Column of its first character in the record, from 1.
    pub fn column(&self, record: &str) -> usize {
        record[..self.start].chars().count() + 1
    }
}

/// Splits a record into cells; a row of a Markdown table at its bars, whatever the separator.
pub fn split<'t>(record: &'t str, separator: Separator, cells: &mut Vec<Cell<'t>>) {
    cells.clear();
    let trimmed = record.trim();
    if trimmed.len() > 1 && trimmed.starts_with('|') {
        let start = record.len() - record.trim_start().len() + 1;
        let inner = trimmed[1..].strip_suffix('|').unwrap_or(&trimmed[1..]);
        return split_at(inner, start, |c| c == '|', cells);
    }
    match separator {
        Separator::Comma => split_at(record, 0, |c| matches!(c, ',' | '\u{ff0c}'), cells),
        Separator::Semicolon => split_at(record, 0, |c| c == ';', cells),
        Separator::Tab => split_at(record, 0, |c| c == '\t', cells),
        Separator::Blanks => {
            split_at(record, 0, char::is_whitespace, cells);
            cells.retain(|cell| !cell.text.is_empty());
        }
    }
}

fn split_at<'t>(text: &'t str, offset: usize, is_separator: impl Fn(char) -> bool, cells: &mut Vec<Cell<'t>>) {
    let mut start = 0;
    let mut is_quoted = false;
    let mut add = |start: usize, end: usize| {
        let raw = &text[start..end];
        let trimmed = raw.trim();
        let lead = raw.len() - raw.trim_start().len();
        let unquoted = trimmed.strip_prefix('"').and_then(|inner| inner.strip_suffix('"')).unwrap_or(trimmed);
        cells.push(Cell { text: unquoted.trim(), start: offset + start + lead });
    };
    for (at, c) in text.char_indices() {
        if c == '"' {
            is_quoted = !is_quoted;
        } else if !is_quoted && is_separator(c) {
            add(start, at);
            start = at + c.len_utf8();
        }
    }
    add(start, text.len());
}

/// Whether a cell says that there is no value.
pub fn is_missing(text: &str) -> bool {
    const WORDS: [&str; 9] = ["", "-", "--", "---", "nan", "null", "none", "n/a", "invalid"];
    WORDS.iter().any(|word| text.eq_ignore_ascii_case(word))
}

/// Reads a number. Full-width characters, a true minus, thin blanks, a unit behind it and a blank behind the point, as text
/// recognition leaves it, are understood; NaN and infinity are not numbers.
pub fn number(text: &str, has_decimal_comma: bool) -> Option<f64> {
    let starts_as_number =
        |text: &str| text.trim_start_matches(['+', '-']).starts_with(|c: char| c.is_ascii_digit() || c == '.');
    if let Ok(number) = text.parse::<f64>() {
        return (starts_as_number(text) && number.is_finite()).then_some(number);
    }
    let plain = plain(text)?;
    let number = match (plain.contains(','), has_decimal_comma) {
        (false, _) => plain.parse::<f64>(),
        (true, true) if plain.matches(',').count() == 1 => plain.replace('.', "").replace(',', ".").parse::<f64>(),
        (true, false) if has_thousands(&plain) => plain.replace(',', "").parse::<f64>(),
        _ => return None,
    };
    number.ok().filter(|number| starts_as_number(&plain) && number.is_finite())
}

/// Commas every three digits before the point.
fn has_thousands(plain: &str) -> bool {
    let whole = plain.split('.').next().unwrap_or_default();
    let mut groups = whole.trim_start_matches(['+', '-']).split(',');
    let is_digits = |group: &str| group.bytes().all(|byte| byte.is_ascii_digit());
    groups.next().is_some_and(|first| (1..=3).contains(&first.len()) && is_digits(first))
        && groups.all(|group| group.len() == 3 && is_digits(group))
}

/// The number's own characters; `None` if it is longer than any number.
fn plain(text: &str) -> Option<String> {
    const MAX_BYTES: usize = 64;
    if text.is_empty() || text.len() > MAX_BYTES {
        return None;
    }
    let half_width: String = text.chars().map(half_width).collect();
    let mut trimmed = half_width.trim().trim_matches('$').trim();
    for unit in ["mm", "deg", "°"] {
        trimmed = trimmed.strip_suffix(unit).unwrap_or(trimmed).trim_end();
    }
    let mut plain = String::with_capacity(trimmed.len());
    for c in trimmed.chars() {
        let is_thin = matches!(c, '\u{2009}' | '\u{200a}' | '\u{202f}');
        // "170. 208" and "- 5" are one number each, "2 3" are two.
        if c.is_whitespace() && (is_thin || plain.ends_with(['.', ',', '+', '-'])) {
            continue;
        }
        plain.push(c);
    }
    Some(plain)
}

/// A character without its full width, and a true minus as the hyphen that programs read.
pub const fn half_width(c: char) -> char {
    match c {
        '\u{ff01}'..='\u{ff5e}' => match char::from_u32(c as u32 - FULL_WIDTH_OFFSET) {
            Some(half) => half,
            None => c,
        },
        '\u{3000}' => ' ',
        '\u{2212}' | '\u{2010}' | '\u{2011}' | '\u{2012}' | '\u{2013}' => '-',
        _ => c,
    }
}

/// As much of a text as a message shows, on one line.
pub fn excerpt(text: &str) -> Cow<'_, str> {
    const MAX_CHARS: usize = 40;
    if text.len() <= MAX_CHARS && !text.chars().any(char::is_control) {
        return Cow::Borrowed(text);
    }
    let mut chars = text.chars().map(|c| if c.is_control() { ' ' } else { c });
    let mut excerpt: String = chars.by_ref().take(MAX_CHARS).collect();
    if chars.next().is_some() {
        excerpt.push('…');
    }
    Cow::Owned(excerpt)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_every_origin_are_read() {
        for (text, has_decimal_comma, expected) in [
            ("12.5", false, Some(12.5)),
            ("-1e-3", false, Some(-0.001)),
            ("−54.903", false, Some(-54.903)),
            ("\u{ff0d}5.5", false, Some(-5.5)),
            ("\u{ff11}\u{ff12}\u{ff0e}5", false, Some(12.5)),
            ("170. 208", false, Some(170.208)),
            ("- 106. 129", false, Some(-106.129)),
            ("2 3", false, None),
            ("1,5", true, Some(1.5)),
            ("1.234,5", true, Some(1234.5)),
            ("1.234", true, Some(1.234)),
            ("1,5", false, None),
            ("1,234.5", false, Some(1234.5)),
            ("12.5 mm", false, Some(12.5)),
            ("90°", false, Some(90.0)),
            ("$0.5$", false, Some(0.5)),
            ("1\u{2009}234.5", false, Some(1234.5)),
            ("nan", false, None),
            ("inf", false, None),
            ("1e999", false, None),
            ("", false, None),
            ("x", false, None),
        ] {
            assert_eq!(number(text, has_decimal_comma), expected, "{text:?}");
        }
    }

    #[test]
    fn cells_know_their_columns() {
        let mut cells = Vec::new();
        for (record, separator, expected) in [
            ("a, b,,c", Separator::Comma, vec![("a", 1), ("b", 4), ("", 6), ("c", 7)]),
            ("\"a;b\"; c", Separator::Semicolon, vec![("a;b", 1), ("c", 8)]),
            ("  a  \t b", Separator::Blanks, vec![("a", 3), ("b", 8)]),
            ("é\tb", Separator::Tab, vec![("é", 1), ("b", 3)]),
            ("| 1 | 2,5 |", Separator::Comma, vec![("1", 3), ("2,5", 7)]),
        ] {
            split(record, separator, &mut cells);
            let found: Vec<(&str, usize)> = cells.iter().map(|cell| (cell.text, cell.column(record))).collect();
            assert_eq!(found, expected, "{record:?}");
        }
    }

    #[test]
    fn lines_end_in_any_way_and_quoted_cells_run_over_them() {
        let found: Vec<(usize, &str)> = lines("a\r\nb\rc\n\nd").collect();
        assert_eq!(found, [(1, "a"), (2, "b"), (3, "c"), (4, ""), (5, "d")]);
        let found: Vec<(usize, &str)> = records("\"x\n[mm]\",y\n1,2\n\"3,4\n5\n6\n7\n8\n9")
            .map(|record| (record.line, record.text))
            .take(3)
            .collect();
        assert_eq!(found, [(1, "\"x\n[mm]\",y"), (3, "1,2"), (4, "\"3,4")]);
    }

    #[test]
    fn bytes_of_other_programs_become_text() {
        assert_eq!(decode(b"\xff\xfe1\0,\x002\0".to_vec()), "1,2");
        assert_eq!(decode(b"\xfe\xff\x001\0,".to_vec()), "1,");
        assert_eq!(decode(b"\xef\xbb\xbf1".to_vec()), "1");
        assert_eq!(decode(b"W/\xb0 1".to_vec()), "W/\u{fffd} 1");
    }
}
