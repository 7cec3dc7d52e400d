//! Profiles: rows of x and z, one profile a file or one a column.

use crate::geometry::Profile;
use crate::geometry::notation::LengthUnit;
use crate::watch::Cancelled;

use super::gather::Gathered;
use super::header::column_in_mm;
use super::read::Progress;
use super::table::{Layout, is_comment};
use super::text::{is_missing, number, records, split};
use super::{ImportOptions, Source};

/// A profile and how its source names it.
#[derive(Clone, Debug)]
pub(super) struct NamedProfile {
    /// Name of the file, or head of the column.
    pub name: String,
    /// The points.
    pub profile: Profile,
}

/// Columns of a table of profiles.
const MAX_PROFILE_COLUMNS: usize = 4096;
/// Rows between two looks at whether anybody still waits.
const ROWS_BETWEEN_REPORTS: usize = 1024;

/// The column that the header names so: `x`, `X [mm]`, `x_mm`.
pub(super) fn named(layout: &Layout, name: &str) -> Option<usize> {
    layout.header.as_ref()?.iter().position(|cell| {
        let cell = cell.trim().to_lowercase();
        cell.strip_prefix(name).is_some_and(|rest| !rest.starts_with(char::is_alphanumeric))
    })
}

/// Where x and z stand in a table of one profile.
fn x_and_z(layout: &Layout) -> (usize, usize) {
    match (named(layout, "x"), named(layout, "z")) {
        (Some(x), Some(z)) => (x, z),
        _ if layout.num_columns >= 3 => {
            // A number of the point in front, or y = 0 in the middle.
            let is_y = layout.sample.iter().all(|row| row.get(1) == Some(&0.0));
            if is_y { (0, 2) } else { (1, 2) }
        }
        _ => (0, 1),
    }
}

/// A value of z; `None` where the profiler saw nothing: an empty cell, or the code of an invalid point.
fn z_of(text: &str, has_decimal_comma: bool) -> Result<Option<f64>, ()> {
    if is_missing(text) {
        return Ok(None);
    }
    match number(text, has_decimal_comma) {
        Some(value) if is_invalid_code(text, value) => Ok(None),
        Some(value) => Ok(Some(value)),
        None if text.trim_start_matches(['+', '-']).eq_ignore_ascii_case("inf") => Ok(None),
        None => Err(()),
    }
}

/// Profilers write −32768, −999.999 or 99999 where there is no valid point.
fn is_invalid_code(text: &str, value: f64) -> bool {
    let digits = || text.bytes().filter(u8::is_ascii_digit);
    let is_all_nines = digits().count() >= 4 && digits().all(|digit| digit == b'9') && value.abs() >= 999.0;
    is_all_nines || [-32_768.0, -32_767.0, -2_147_483_648.0].contains(&value)
}

/// Millimetres in the units of x and z: as the options say, else as the header does, else one.
///
/// # Errors
/// A unit that is not known.
fn units_in_mm(layout: &Layout, x: usize, z: usize, options: &ImportOptions) -> Result<[f64; 2], String> {
    if let Some(unit) = options.profile_length_unit {
        return Ok([unit.in_mm(); 2]);
    }
    let of = |column: usize| match layout.header.as_ref().and_then(|header| header.get(column)) {
        Some(cell) => column_in_mm(cell),
        None => Ok(None),
    };
    let (x, z) = (of(x)?, of(z)?);
    // One that says nothing is in the unit of the other.
    Ok([x.or(z).unwrap_or(1.0), z.or(x).unwrap_or(1.0)])
}

/// Where x and the first z stand.
fn first_columns(layout: &Layout, has_profile_columns: bool) -> (usize, usize) {
    if has_profile_columns { (0, layout.num_columns.saturating_sub(1)) } else { x_and_z(layout) }
}

/// The length unit of profiles, for the options: `None` where the header says another than these.
pub(super) fn length_unit(layout: &Layout, has_profile_columns: bool, options: &ImportOptions) -> Option<LengthUnit> {
    let (x, z) = first_columns(layout, has_profile_columns);
    let units = units_in_mm(layout, x, z, options).ok()?;
    [LengthUnit::Millimetres, LengthUnit::Metres]
        .into_iter()
        .find(|unit| units.iter().all(|in_mm| (in_mm - unit.in_mm()).abs() < f64::EPSILON))
}

/// Reads one profile, or one a column; rows that cannot be read are listed.
///
/// # Errors
/// [`Cancelled`].
pub(super) fn read(
    source: &Source,
    text: &str,
    layout: &Layout,
    has_profile_columns: bool,
    options: &ImportOptions,
    gathered: &mut Gathered,
    progress: &mut Progress<'_>,
) -> Result<Vec<NamedProfile>, Cancelled> {
    let (x, z) = first_columns(layout, has_profile_columns);
    let [x_in_mm, z_in_mm] = match units_in_mm(layout, x, z, options) {
        Ok(units) => units,
        Err(unit) => {
            gathered.problem(&source.name, (1, 1), &unit, "mm, m, cm, um or in as the unit of x and z");
            return Ok(Vec::new());
        }
    };
    let z_sign = if options.is_z_mirrored { -1.0 } else { 1.0 };
    let (x_column, z_columns) = if has_profile_columns {
        (0, (1..layout.num_columns.min(MAX_PROFILE_COLUMNS)).collect())
    } else {
        (x, vec![z])
    };
    // Room for no more rows than the text could fill, were it all cells.
    let num_rows = records(text).count().min(text.len() / z_columns.len().max(1));
    let mut x_mm: Vec<f64> = Vec::with_capacity(num_rows);
    let mut z_mm: Vec<Vec<f64>> = z_columns.iter().map(|_| Vec::with_capacity(num_rows)).collect();
    let mut cells = Vec::new();
    let mut row = Vec::with_capacity(z_columns.len());
    for (idx, record) in records(text).skip_while(|record| record.line < layout.first_row_line).enumerate() {
        if idx % ROWS_BETWEEN_REPORTS == 0 {
            progress.tick()?;
        }
        if is_comment(record.text, layout.separator) {
            continue;
        }
        split(record.text, layout.separator, &mut cells);
        let mut problem = None;
        let mut fail = |column: usize| {
            let place = cells.get(column).map(|cell| (cell.column(record.text), cell.text));
            problem.get_or_insert(place.unwrap_or((record.text.chars().count() + 1, "")));
        };
        if cells.iter().all(|cell| cell.text.is_empty()) {
            continue;
        }
        let within = |value: f64, in_mm: f64| (value.abs() * in_mm <= Profile::LIMIT_MM).then_some(value * in_mm);
        let x = cells
            .get(x_column)
            .and_then(|cell| number(cell.text, layout.has_decimal_comma))
            .and_then(|x| within(x, x_in_mm));
        if x.is_none() {
            fail(x_column);
        }
        // A row that ends early has no more valid points; one of less than half its cells is another kind of row.
        if 2 * cells.len() < layout.num_columns {
            fail(cells.len());
        }
        row.clear();
        for column in &z_columns {
            let text = cells.get(*column).map_or("", |cell| cell.text);
            match z_of(text, layout.has_decimal_comma) {
                Ok(z) => row.push(z.and_then(|z| within(z, z_in_mm)).map_or(f64::NAN, |z| z * z_sign)),
                Err(()) => fail(*column),
            }
        }
        match (problem, x) {
            (None, Some(x)) => {
                x_mm.push(x);
                z_mm.iter_mut().zip(&row).for_each(|(list, z)| list.push(*z));
            }
            (Some((column, found)), _) => {
                gathered.problem(&source.name, (record.line, column), found, "a coordinate in a row of x and z");
            }
            (None, None) => {}
        }
    }
    let names = |place: usize, column: usize| {
        let head = layout.header.as_ref().and_then(|header| header.get(column)).filter(|head| !head.is_empty());
        head.cloned().unwrap_or_else(|| (place + 1).to_string())
    };
    let mut profiles = Vec::with_capacity(z_columns.len());
    for (place, (column, z_mm)) in z_columns.iter().zip(z_mm).enumerate() {
        let z_mm: Vec<Option<f64>> = z_mm.iter().map(|z| (!z.is_nan()).then_some(*z)).collect();
        let name = if has_profile_columns { names(place, *column) } else { source.name.clone() };
        // The lists are as long as each other and checked above.
        if let Ok(profile) = Profile::new(x_mm.clone(), &z_mm) {
            profiles.push(NamedProfile { name, profile });
        }
    }
    Ok(profiles)
}
