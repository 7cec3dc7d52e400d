//! The cell cursor and the cells that are selected with it. Knows rows and columns by their numbers only.

use std::collections::BTreeSet;
use std::ops::RangeInclusive;

/// The cursor, the rectangle that it spans with its anchor, and further rows picked one by one.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Cursor {
    /// Row of the cursor.
    pub row: usize,
    /// Column of the cursor.
    pub column: usize,
    anchor_row: usize,
    anchor_column: usize,
    /// Whether the rows as a whole are meant, as after a click on their heads.
    pub has_whole_rows: bool,
    more_rows: BTreeSet<usize>,
}

impl Cursor {
    /// One cell.
    #[must_use]
    pub fn at(row: usize, column: usize) -> Self {
        Self { row, column, anchor_row: row, anchor_column: column, ..Self::default() }
    }

    /// Whole rows; the cursor keeps its column.
    #[must_use]
    pub fn over_rows(rows: &RangeInclusive<usize>, column: usize) -> Self {
        let (row, anchor_row) = (*rows.start(), *rows.end());
        Self { row, column, anchor_row, anchor_column: column, has_whole_rows: true, more_rows: BTreeSet::new() }
    }

    /// Whole rows, not all of them neighbours; the cursor keeps its column.
    #[must_use]
    pub fn over_picked_rows(rows: BTreeSet<usize>, column: usize) -> Self {
        let first = rows.first().copied().unwrap_or(0);
        Self { more_rows: rows, ..Self::over_rows(&(first..=first), column) }
    }

    /// Everything, with the first cell as the cursor.
    pub fn select_all(&mut self, num_rows: usize, num_columns: usize) {
        *self = Self::at(num_rows.saturating_sub(1), num_columns.saturating_sub(1));
        self.go_to(0, 0, true);
    }

    /// Goes to a cell, with the rectangle up to there if `extends`.
    pub fn go_to(&mut self, row: usize, column: usize, extends: bool) {
        if extends {
            (self.row, self.column) = (row, column);
            self.more_rows.clear();
        } else {
            *self = Self::at(row, column);
        }
    }

    /// Picks a whole row in addition to those that are selected, or drops it.
    pub fn toggle_row(&mut self, row: usize) {
        let mut rows: BTreeSet<usize> = self.rows().into_iter().collect();
        if !rows.remove(&row) || rows.is_empty() {
            // The last one stays.
            rows.insert(row);
        }
        let row = if rows.contains(&row) { row } else { rows.first().copied().unwrap_or(row) };
        *self = Self { more_rows: rows, ..Self::over_rows(&(row..=row), self.column) };
    }

    /// Whole rows from the anchor to here.
    pub fn extend_rows_to(&mut self, row: usize) {
        self.has_whole_rows = true;
        self.more_rows.clear();
        self.row = row;
    }

    /// Within a table that has become smaller.
    pub fn clamp(&mut self, num_rows: usize, num_columns: usize) {
        let (last_row, last_column) = (num_rows.saturating_sub(1), num_columns.saturating_sub(1));
        self.row = self.row.min(last_row);
        self.anchor_row = self.anchor_row.min(last_row);
        self.column = self.column.min(last_column);
        self.anchor_column = self.anchor_column.min(last_column);
        self.more_rows.retain(|row| *row <= last_row);
    }

    fn span(&self) -> RangeInclusive<usize> {
        self.row.min(self.anchor_row)..=self.row.max(self.anchor_row)
    }

    /// The selected rows from top to bottom.
    #[must_use]
    pub fn rows(&self) -> Vec<usize> {
        if self.more_rows.is_empty() {
            return self.span().collect();
        }
        self.more_rows.iter().copied().collect()
    }

    /// The selected columns of a table with so many.
    #[must_use]
    pub fn columns(&self, num_columns: usize) -> RangeInclusive<usize> {
        if self.has_whole_rows {
            return 0..=num_columns.saturating_sub(1);
        }
        self.column.min(self.anchor_column)..=self.column.max(self.anchor_column)
    }

    /// Whether a row is selected, at least in part.
    #[must_use]
    pub fn has_row(&self, row: usize) -> bool {
        if self.more_rows.is_empty() { self.span().contains(&row) } else { self.more_rows.contains(&row) }
    }

    /// Whether it is but one cell.
    #[must_use]
    pub fn is_single(&self) -> bool {
        !self.has_whole_rows
            && self.more_rows.is_empty()
            && self.row == self.anchor_row
            && self.column == self.anchor_column
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rectangle_grows_from_its_anchor() {
        let mut cursor = Cursor::at(2, 3);
        assert!(cursor.is_single());
        cursor.go_to(4, 1, true);
        assert_eq!(cursor.rows(), [2, 3, 4]);
        assert_eq!(cursor.columns(8), 1..=3);
        assert!(cursor.has_row(3) && !cursor.has_row(1));
        cursor.go_to(0, 3, true);
        assert_eq!(cursor.rows(), [0, 1, 2]);
        cursor.go_to(1, 1, false);
        assert!(cursor.is_single());
    }

    #[test]
    fn rows_are_picked_one_by_one_and_in_ranges() {
        let mut cursor = Cursor::over_rows(&(1..=1), 2);
        assert_eq!(cursor.columns(8), 0..=7);
        cursor.toggle_row(4);
        cursor.toggle_row(6);
        assert_eq!(cursor.rows(), [1, 4, 6]);
        cursor.toggle_row(4);
        assert_eq!(cursor.rows(), [1, 6]);
        cursor.extend_rows_to(3);
        assert!(cursor.has_whole_rows);
        let mut single = Cursor::at(5, 2);
        single.toggle_row(7);
        assert_eq!(single.rows(), [5, 7], "the row of the cell is picked as well");
    }

    #[test]
    fn a_smaller_table_keeps_the_cursor_inside() {
        let mut cursor = Cursor::at(9, 9);
        cursor.clamp(3, 4);
        assert_eq!((cursor.row, cursor.column), (2, 3));
        cursor.clamp(0, 0);
        assert_eq!((cursor.row, cursor.column), (0, 0));
    }
}
