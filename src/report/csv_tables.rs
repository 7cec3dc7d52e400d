//! Tables of a report as CSV, with all digits, the units in the heads.

use super::document::{Cell, Column, Table};

/// A table as CSV: one head, then a row a row. A figure that is missing is an empty cell.
#[must_use]
pub fn csv_table(table: &Table) -> String {
    let mut writer = csv::Writer::from_writer(Vec::new());
    let heads = table.columns.iter().map(|column| column.csv_name.as_str());
    // Writing to memory cannot fail, and every row has as many cells.
    let _ = writer.write_record(heads);
    for row in &table.rows {
        let _ = writer.write_record(table.columns.iter().zip(row).map(|(column, cell)| field(column, cell)));
    }
    String::from_utf8(writer.into_inner().unwrap_or_default()).unwrap_or_default()
}

fn field(column: &Column, cell: &Cell) -> String {
    match cell.value {
        Some(value) => value.to_string(),
        None if column.is_number => String::new(),
        None => cell.text.clone(),
    }
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
}
