//! Tables as papers print them: named values (`q0 = 0.07921`, `t1 = 306.433`, `xs = -26.25`, `xb = 324.442`), a station over
//! several lines, as text or Markdown, with whatever prose stands around.

use std::borrow::Cow;

use crate::geometry::notation::{LengthUnit, OrientationForm};
use crate::geometry::{PoseNotation, Vec3};
use crate::session::Published;
use crate::sheet::text::{excerpt, half_width, lines, number};

use super::gather::{Gathered, RawPose};
use super::{Note, Preview, Role, Source};

/// Without a value for so many lines, what follows is another table.
const MAX_GAP_LINES: usize = 3;
/// A caption stands at most so many lines above its table.
const MAX_CAPTION_LINES: usize = 10;
/// A caption is not longer.
const MAX_CAPTION_CHARS: usize = 200;
const MAX_PREVIEW_ROWS: usize = 50;

/// The named values of a station: quaternion, position, point in the sensor, centre in the base, printed error.
const NUM_SLOTS: usize = 16;
const POSITION: usize = 4;
const POINT: usize = 7;
const CENTRE: usize = 10;
const ERROR: usize = 13;
/// As many make a pose.
const NUM_POSE_SLOTS: usize = 7;

/// How the values of each slot are named in the preview.
const NAMES: [&str; NUM_SLOTS] =
    ["q0", "q1", "q2", "q3", "t1", "t2", "t3", "xs", "ys", "zs", "xb", "yb", "zb", "Δx", "Δy", "Δz"];

#[derive(Clone, Debug)]
struct Row {
    /// Line and column of its first value.
    at: (usize, usize),
    number: Option<u32>,
    values: [f64; NUM_SLOTS],
    /// A value that is no number: where, and what stands there.
    bad: Option<((usize, usize), Box<str>)>,
}

impl Table {
    /// Begins a station; the one before is set aside if it is no pose, so that a text of many beginnings stays small.
    fn begin(&mut self, row: Row) {
        self.set_aside_incomplete();
        self.rows.push(row);
    }

    fn set_aside_incomplete(&mut self) {
        if let Some(last) = self.rows.pop_if(|row| !row.is_pose())
            && self.incomplete.len() < super::MAX_PROBLEMS
        {
            let missing = last.values.iter().position(|value| value.is_nan()).unwrap_or_default();
            self.incomplete.push((last.at, missing));
        }
    }
}

impl Row {
    fn is_pose(&self) -> bool {
        self.values[..NUM_POSE_SLOTS].iter().all(|value| !value.is_nan())
    }

    /// The three values from a slot on, if all are there.
    fn triple(&self, slot: usize) -> Option<Vec3> {
        let values = &self.values[slot..slot + 3];
        values.iter().all(|value| !value.is_nan()).then(|| Vec3::new(values[0], values[1], values[2]))
    }
}

/// A table found in a text.
#[derive(Clone, Debug, Default)]
pub(super) struct Table {
    rows: Vec<Row>,
    /// Stations without a whole pose: where, and what is missing.
    incomplete: Vec<((usize, usize), usize)>,
    caption: String,
}

/// The tables of a text: the first, and how many more there are.
#[derive(Clone, Debug)]
pub(super) struct Tables {
    pub first: Table,
    pub num_more: usize,
}

/// The tables with at least one whole pose.
pub(super) fn find(text: &str) -> Option<Tables> {
    let mut tables = None;
    let mut table = Table::default();
    let mut caption: Option<(usize, &str)> = None;
    let mut last_line = 0;
    for (line_number, line) in lines(text) {
        if is_caption(line) {
            close(&mut table, &mut tables);
            caption = Some((line_number, line.trim()));
        }
        let (mut counted, mut column) = (0, 1);
        for (byte, slot, value_text) in assignments(line) {
            if line_number > last_line + MAX_GAP_LINES + 1 {
                close(&mut table, &mut tables);
            }
            last_line = line_number;
            if table.rows.is_empty()
                && table.caption.is_empty()
                && let Some((at, text)) = caption
                && at + MAX_CAPTION_LINES >= line_number
            {
                table.caption = text.chars().take(MAX_CAPTION_CHARS).collect();
            }
            column += line[counted..byte].chars().count();
            counted = byte;
            let at = (line_number, column);
            let free = table.rows.last().and_then(|row| free_slot(row, slot));
            if free.is_none() {
                let number = leading_number(line);
                table.begin(Row { at, number, values: [f64::NAN; NUM_SLOTS], bad: None });
            }
            let slot = free.unwrap_or(slot);
            if let Some(row) = table.rows.last_mut() {
                row.values[slot] = number(value_text, false).unwrap_or(f64::INFINITY);
                if row.values[slot].is_infinite() && row.bad.is_none() {
                    row.bad = Some((at, excerpt(value_text).into()));
                }
            }
        }
    }
    close(&mut table, &mut tables);
    tables
}

fn close(table: &mut Table, tables: &mut Option<Tables>) {
    let mut table = std::mem::take(table);
    table.set_aside_incomplete();
    if table.rows.iter().any(|row| row.is_pose() && row.bad.is_none()) {
        match tables {
            Some(tables) => tables.num_more += 1,
            None => *tables = Some(Tables { first: table, num_more: 0 }),
        }
    }
}

/// Where a value of this name goes: the second `xb` is the error. `None`: the row has it already, so the next row begins.
fn free_slot(row: &Row, slot: usize) -> Option<usize> {
    let is_free = |slot: usize| row.values[slot].is_nan();
    let error_slot = slot + ERROR - CENTRE;
    if is_free(slot) {
        Some(slot)
    } else {
        ((CENTRE..ERROR).contains(&slot) && is_free(error_slot)).then_some(error_slot)
    }
}

fn is_caption(line: &str) -> bool {
    let line = line.trim_start_matches(['#', '*', ' ', '>']);
    let after_word = ["表", "Table ", "TABLE ", "Tab."].iter().find_map(|word| line.strip_prefix(word));
    after_word.is_some_and(|rest| rest.trim_start().starts_with(|c: char| c.is_ascii_digit()))
}

/// The number of a row in its first cell.
fn leading_number(line: &str) -> Option<u32> {
    /// The largest numbers that are read have ten digits.
    const MAX_DIGITS: usize = 10;
    let line = line.trim_start_matches(['|', ' ', '\t']);
    let end = line.bytes().take(MAX_DIGITS).take_while(u8::is_ascii_digit).count();
    let rest = line[end..].trim_start_matches(['.', ')', '、']);
    rest.starts_with(['|', ' ', '\t', ',', ':', ';']).then(|| line[..end].parse().ok()).flatten()
}

/// The named values of a line: byte of the name, slot, text of the value.
fn assignments(line: &str) -> impl Iterator<Item = (usize, usize, &str)> {
    let mut from = 0;
    std::iter::from_fn(move || {
        loop {
            let at = from + line.get(from..)?.find(['=', '\u{ff1d}'])?;
            let sign_len = line[at..].chars().next().map_or(1, char::len_utf8);
            let before = line[from..at].trim_end();
            let name_len: usize = before.chars().rev().take_while(|c| is_name_char(*c)).map(char::len_utf8).sum();
            let name = &before[before.len() - name_len..];
            let name_at = from + before.len() - name_len;
            from = at + sign_len;
            if let Some(slot) = slot_of(name) {
                let value = value_text(&line[from..]);
                // In prose and formulas a name equals another name; only beside a table that is a mistake.
                if value.starts_with(|c: char| matches!(half_width(c), '0'..='9' | '+' | '-' | '.')) {
                    from += line[from..].find(value).unwrap_or_default() + value.len();
                    return Some((name_at, slot, value));
                }
            }
        }
    })
}

fn is_name_char(c: char) -> bool {
    c.is_alphanumeric() || matches!(c, '_' | '{' | '}' | '\u{2080}'..='\u{209c}')
}

fn slot_of(name: &str) -> Option<usize> {
    let plain: String = name
        .chars()
        .filter(|c| !matches!(c, '_' | '{' | '}'))
        .map(|c| match c {
            '\u{2080}'..='\u{2089}' => char::from_digit(c as u32 - 0x2080, 10).unwrap_or(c),
            '\u{209b}' => 's',
            c => half_width(c).to_ascii_lowercase(),
        })
        .take(8)
        .collect();
    let at = |names: &[&str]| names.iter().position(|known| *known == plain);
    at(&["q0", "q1", "q2", "q3"])
        .or_else(|| at(&["qw", "qx", "qy", "qz"]))
        .or_else(|| at(&["t1", "t2", "t3"]).map(|idx| POSITION + idx))
        .or_else(|| at(&["tx", "ty", "tz"]).map(|idx| POSITION + idx))
        .or_else(|| at(&["xs", "ys", "zs"]).map(|idx| POINT + idx))
        .or_else(|| at(&["xb", "yb", "zb"]).map(|idx| CENTRE + idx))
}

/// The value behind an equals sign, up to what cannot belong to a number.
fn value_text(text: &str) -> &str {
    let text = text.trim_start_matches([' ', '$', '\u{3000}']);
    let mut last = ' ';
    let mut end = 0;
    for (at, c) in text.char_indices() {
        let half = half_width(c);
        let is_blank_inside = c.is_whitespace() && matches!(last, '.' | '-' | '+');
        let belongs = half.is_ascii_digit() || matches!(half, '+' | '-' | '.' | 'e' | 'E') || is_blank_inside;
        if !belongs {
            break;
        }
        if !c.is_whitespace() {
            last = half;
            end = at + c.len_utf8();
        }
    }
    &text[..end]
}

/// Poses in these tables are quaternions, the real part first, and millimetres.
pub(super) fn notation(notation: &PoseNotation) -> PoseNotation {
    PoseNotation { orientation: OrientationForm::QuaternionWxyz, length_unit: LengthUnit::Millimetres, ..*notation }
}

/// Reads the first table; gives what it prints of the ball where it does so for every station.
pub(super) fn read(
    source: &Source,
    tables: &Tables,
    gathered: &mut Gathered,
    preview: &mut Preview,
) -> Option<Published> {
    let table = &tables.first;
    preview.header = NAMES.map(str::to_owned).to_vec();
    preview.roles = (0..NUM_SLOTS)
        .map(|slot| match slot {
            0..POSITION => Role::Orientation(slot),
            POSITION..POINT => Role::Position(slot - POSITION),
            POINT..CENTRE => Role::Point(slot - POINT),
            _ => Role::Ignore,
        })
        .collect();
    for (at, missing) in &table.incomplete {
        let found = format!("a station without {}", NAMES[*missing]);
        gathered.problem(&source.name, *at, &found, "q0 to q3 and t1 to t3");
    }
    let mut published = Published { caption: table.caption.clone(), ..Published::default() };
    for row in &table.rows {
        preview.num_rows += 1;
        if preview.rows.len() < MAX_PREVIEW_ROWS {
            let shown = row.values.iter().map(|v| if v.is_finite() { v.to_string() } else { String::new() });
            preview.rows.push((row.at.0, shown.collect()));
        }
        if let Some((at, found)) = &row.bad {
            gathered.problem(&source.name, *at, found, "a number");
            continue;
        }
        let [q0, q1, q2, q3, t1, t2, t3, ..] = row.values;
        let label = row.number.map(|number| number.to_string());
        let num_before = gathered.num_poses();
        gathered.take(
            &source.name,
            &RawPose {
                at: row.at,
                label: label.map(Cow::Owned),
                numbers: &[t1, t2, t3, q0, q1, q2, q3],
                point_in_sensor: row.triple(POINT),
                ..RawPose::default()
            },
        );
        if gathered.num_poses() > num_before {
            published.target_in_base_mm.extend(row.triple(CENTRE));
            published.error_from_first_mm.extend(row.triple(ERROR));
        }
    }
    if tables.num_more > 0 {
        gathered.notes.push(Note::OtherTablesLeftOut { caption: table.caption.clone(), num_tables: tables.num_more });
    }
    let num_stations = gathered.stations.len();
    for rows in [&mut published.target_in_base_mm, &mut published.error_from_first_mm] {
        if rows.len() != num_stations {
            rows.clear();
        }
    }
    (!published.target_in_base_mm.is_empty()).then_some(published)
}
