//! Tables of a report as CSV, with all digits, the units in the heads.

use super::document::{Cell, Column, Table};

/// A table as CSV: one head, then a row a row. A figure that is missing is an empty cell.
#[must_use]
pub fn csv_table(table: &Table) -> String {
    let mut writer = csv::Writer::from_writer(Vec::new());
    let heads =
        table.columns.iter().flat_map(|column| std::iter::once(&column.csv_name).chain(&column.further_csv_names));
    // Writing to memory cannot fail, and every row has as many cells.
    let _ = writer.write_record(heads);
    for row in &table.rows {
        let _ = writer.write_record(table.columns.iter().zip(row).flat_map(|(column, cell)| fields(column, cell)));
    }
    String::from_utf8(writer.into_inner().unwrap_or_default()).unwrap_or_default()
}

/// What a cell becomes: its first figure or its words, and its further figures.
fn fields(column: &Column, cell: &Cell) -> impl Iterator<Item = String> {
    let has_figures = column.is_number || !column.further_csv_names.is_empty();
    let first = match cell.value {
        Some(value) => value.to_string(),
        None if has_figures => String::new(),
        None => disarmed(&cell.text),
    };
    let further =
        (0..column.further_csv_names.len()).map(|idx| cell.further.get(idx).map_or_else(String::new, f64::to_string));
    std::iter::once(first).chain(further)
}

/// Words that a spreadsheet does not take for a formula, whatever a station or target is called: an apostrophe stands before
/// them, which says just that there. A number is none, nor is a sign alone.
fn disarmed(words: &str) -> String {
    let is_formula =
        words.starts_with(['=', '+', '-', '@', '\t', '\r']) && words.len() > 1 && words.parse::<f64>().is_err();
    if is_formula { format!("'{words}") } else { words.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_have_all_digits_and_separators_are_quoted() {
        let table = Table {
            id: "t".to_owned(),
            title: "T".to_owned(),
            columns: vec![Column::words("station", "station"), Column::number("error", Some("mm"), "error_mm")],
            rows: vec![
                vec![Cell::words("a, \"b\""), Cell::number(0.123_456_789, 3)],
                vec![Cell::words("2"), Cell::missing()],
            ],
            note: None,
        };
        assert_eq!(csv_table(&table), "station,error_mm\n\"a, \"\"b\"\"\",0.123456789\n2,\n");
    }

    #[test]
    fn words_for_several_figures_are_as_many_columns() {
        let table = Table {
            id: "t".to_owned(),
            title: "T".to_owned(),
            columns: vec![Column::words("planes", "planes"), Column::figures("angle", "angle_deg", &["angle_std_deg"])],
            rows: vec![
                vec![Cell::words("A, B"), Cell::figures("90.00° ± 0.02°", 90.001, vec![0.0213])],
                vec![Cell::words("A, C"), Cell::missing()],
            ],
            note: None,
        };
        assert_eq!(csv_table(&table), "planes,angle_deg,angle_std_deg\n\"A, B\",90.001,0.0213\n\"A, C\",,\n");
    }

    #[test]
    fn no_name_is_a_formula() {
        for (words, expected) in [
            ("=HYPERLINK(\"x\")", "'=HYPERLINK(\"x\")"),
            ("@sum", "'@sum"),
            ("-1+1", "'-1+1"),
            ("+cmd", "'+cmd"),
            ("-12.5", "-12.5"),
            ("p1 = 3", "p1 = 3"),
            ("+", "+"),
            ("", ""),
        ] {
            assert_eq!(disarmed(words), expected, "{words}");
        }
    }
}
