//! Profiles in sheets: a row a point, x and one z or several.

use std::convert::Infallible;

use crate::geometry::Profile;

use super::layout::{Given, Layout, is_comment, layout};
use super::text::{excerpt, is_missing, number, records, split, without_mark};
use super::unit::column_in_mm;

/// Rows between two looks at whether anybody still waits.
const ROWS_BETWEEN_REPORTS: usize = 1024;

/// The column that the header names so: `x`, `X [mm]`, `x_mm`.
pub fn named(layout: &Layout, name: &str) -> Option<usize> {
    layout.header.as_ref()?.iter().position(|cell| {
        let cell = cell.trim().to_lowercase();
        cell.strip_prefix(name).is_some_and(|rest| !rest.starts_with(char::is_alphanumeric))
    })
}

/// Where x and z stand in a table of one profile.
pub fn x_and_z(layout: &Layout) -> (usize, usize) {
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

/// Millimetres in the units of x and z as the header has them, else one.
///
/// # Errors
/// A unit that is not known.
pub fn units_in_mm(layout: &Layout, x: usize, z: usize) -> Result<[f64; 2], String> {
    let of = |column: usize| match layout.header.as_ref().and_then(|header| header.get(column)) {
        Some(cell) => column_in_mm(cell),
        None => Ok(None),
    };
    let (x, z) = (of(x)?, of(z)?);
    // One that says nothing is in the unit of the other.
    Ok([x.or(z).unwrap_or(1.0), z.or(x).unwrap_or(1.0)])
}

/// Where the coordinates stand, and in which units.
#[derive(Clone, Debug)]
pub struct Columns {
    pub x: usize,
    pub z: Vec<usize>,
    pub x_in_mm: f64,
    /// Negative where z is turned about.
    pub z_in_mm: f64,
}

/// The rows that could be read: x, and a list for each column of z, NaN where there is no valid point. All are as long.
#[derive(Clone, Debug)]
pub struct Rows {
    pub x_mm: Vec<f64>,
    pub z_mm: Vec<Vec<f64>>,
}

/// A cell that is no coordinate.
#[derive(Clone, Copy, Debug)]
pub struct BadCell<'t> {
    /// Line and column, from 1.
    pub at: (usize, usize),
    pub found: &'t str,
}

/// Reads the rows of a sheet; those that cannot be read are told and left out.
///
/// # Errors
/// What `tick` says; it is asked every some rows whether to go on.
pub fn rows<E>(
    text: &str,
    layout: &Layout,
    columns: &Columns,
    mut on_bad_cell: impl FnMut(BadCell<'_>),
    mut tick: impl FnMut() -> Result<(), E>,
) -> Result<Rows, E> {
    // Room for no more rows than the text could fill, were it all cells.
    let num_rows = records(text).count().min(text.len() / columns.z.len().max(1));
    let mut x_mm: Vec<f64> = Vec::with_capacity(num_rows);
    let mut z_mm: Vec<Vec<f64>> = columns.z.iter().map(|_| Vec::with_capacity(num_rows)).collect();
    let mut cells = Vec::new();
    let mut row = Vec::with_capacity(columns.z.len());
    for (idx, record) in records(text).skip_while(|record| record.line < layout.first_row_line).enumerate() {
        if idx % ROWS_BETWEEN_REPORTS == 0 {
            tick()?;
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
        let within = |value: f64, in_mm: f64| (value.abs() * in_mm.abs() <= Profile::LIMIT_MM).then_some(value * in_mm);
        let x = cells
            .get(columns.x)
            .and_then(|cell| number(cell.text, layout.has_decimal_comma))
            .and_then(|x| within(x, columns.x_in_mm));
        if x.is_none() {
            fail(columns.x);
        }
        // A row that ends early has no more valid points; one of less than half its cells is another kind of row.
        if 2 * cells.len() < layout.num_columns {
            fail(cells.len());
        }
        row.clear();
        for column in &columns.z {
            let text = cells.get(*column).map_or("", |cell| cell.text);
            match z_of(text, layout.has_decimal_comma) {
                Ok(z) => row.push(z.and_then(|z| within(z, columns.z_in_mm)).unwrap_or(f64::NAN)),
                Err(()) => fail(*column),
            }
        }
        match (problem, x) {
            (None, Some(x)) => {
                x_mm.push(x);
                z_mm.iter_mut().zip(&row).for_each(|(list, z)| list.push(*z));
            }
            (Some((column, found)), _) => on_bad_cell(BadCell { at: (record.line, column), found }),
            (None, None) => {}
        }
    }
    Ok(Rows { x_mm, z_mm })
}

/// The one profile of a sheet; z times `z_sign`.
///
/// # Errors
/// What was found instead, in words.
pub fn of_sheet(text: &str, z_sign: f64) -> Result<Profile, String> {
    /// A number of the point, x, y and z.
    const MOST_COLUMNS_WITHOUT_NAMES: usize = 4;
    let text = without_mark(text);
    let Some(layout) = layout(text, Given::default()) else {
        let line = excerpt(text.trim().lines().next().unwrap_or_default());
        return Err(if line.is_empty() { "nothing".to_owned() } else { format!("\"{line}\" and no row of numbers") });
    };
    let is_named = named(&layout, "x").is_some() && named(&layout, "z").is_some();
    if !is_named && !(2..=MOST_COLUMNS_WITHOUT_NAMES).contains(&layout.num_columns) {
        return Err(format!("{} columns without the names x and z", layout.num_columns));
    }
    let (x, z) = x_and_z(&layout);
    let [x_in_mm, z_in_mm] = units_in_mm(&layout, x, z).map_err(|unit| format!("the unit \"{unit}\""))?;
    let columns = Columns { x, z: vec![z], x_in_mm, z_in_mm: z_in_mm * z_sign.signum() };
    let (mut num_bad, mut first_bad) = (0, None);
    let on_bad_cell = |cell: BadCell<'_>| {
        num_bad += 1;
        first_bad
            .get_or_insert_with(|| format!("\"{}\" in line {}, column {}", excerpt(cell.found), cell.at.0, cell.at.1));
    };
    let Rows { x_mm, z_mm } = match rows(text, &layout, &columns, on_bad_cell, || Ok::<(), Infallible>(())) {
        Ok(rows) => rows,
        Err(never) => match never {},
    };
    if let Some(found) = first_bad.filter(|_| num_bad >= x_mm.len()) {
        return Err(found);
    }
    let z_mm: Vec<Option<f64>> = z_mm.first().into_iter().flatten().map(|z| (!z.is_nan()).then_some(*z)).collect();
    Profile::new(x_mm, &z_mm).map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_core::{RngCore as _, SeedableRng as _};

    #[track_caller]
    fn check(text: &str, expected: &[(f64, Option<f64>)]) {
        let profile = of_sheet(text, 1.0).expect("a profile");
        let z: Vec<Option<f64>> = expected.iter().map(|(_, z)| *z).collect();
        assert_eq!(profile, Profile::new(expected.iter().map(|(x, _)| *x).collect(), &z).expect("finite"));
    }

    #[test]
    fn a_profile_is_read_however_it_is_written() {
        let expected = [(-0.5, Some(10.25)), (0.0, None), (0.5, Some(-3.0))];
        for text in [
            "x,z\n-0.5,10.25\n0,\n0.5,-3\n",
            "-0.5,10.25\n0,NaN\n0.5,-3\n",
            "\u{feff}X [mm];Z [mm]\r\n-0,5;10,25\r\n0,0;-9999\r\n0,5;-3,0\r\n",
            "x_um\tz_um\n-500\t10250\n0\t\n500\t-3000\n",
            "# saved by a program\n# x z\n-0.5 10.25\n0.0 -32768\n0.5 -3.0\n",
            "no,x,z\n1,-0.5,10.25\n2,0,inf\n3,0.5,-3\n",
            "x,y,z\n-0.5,0,10.25\n0,0,--\n0.5,0,-3\n",
            "Z (mm),X (mm)\n10.25,-0.5\n,0\n-3,0.5\n",
        ] {
            check(text, &expected);
        }
    }

    #[test]
    fn the_sign_of_z_can_be_turned_about() {
        let profile = of_sheet("x,z\n1,2\n2,-3\n", -1.0).expect("a profile");
        assert_eq!((profile.x_mm(), profile.z_mm()), ([1.0, 2.0].as_slice(), [-2.0, 3.0].as_slice()));
    }

    #[test]
    fn what_is_no_profile_is_said() {
        for (text, found) in [
            ("", "nothing"),
            ("hello\nworld\n", "\"hello\""),
            ("1,2,3,4,5\n1,2,3,4,5\n", "5 columns"),
            ("x [kg],z\n1,2\n", "\"kg\""),
        ] {
            let problem = of_sheet(text, 1.0).expect_err("no profile");
            assert!(problem.contains(found), "{problem}");
        }
    }

    #[test]
    fn damaged_sheets_never_panic() {
        let golden = "\u{feff}X [mm];Z [mm]\r\n-0,5;10,25\r\n0,0;-9999\r\n0,5;\"-3,0\"\r\n".as_bytes();
        let mut random = rand_pcg::Pcg64Mcg::seed_from_u64(5);
        let mut next = |below: usize| random.next_u32() as usize % below;
        for _ in 0..5000 {
            let mut bytes = golden.to_vec();
            for _ in 0..=next(8) {
                match next(3) {
                    0 => bytes.truncate(next(bytes.len() + 1)),
                    1 => bytes.insert(next(bytes.len() + 1), b";,.\"-e9\n\t|#"[next(11)]),
                    _ if !bytes.is_empty() => {
                        let at = next(bytes.len());
                        bytes[at] = u8::try_from(next(256)).expect("a byte");
                    }
                    _ => {}
                }
            }
            let _ = of_sheet(&crate::sheet::text::decode(bytes), 1.0);
        }
    }
}
