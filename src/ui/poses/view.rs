//! Rows, columns and widths of the table, made anew when the document or the folding has changed.

use std::collections::BTreeSet;
use std::sync::Arc;

use crate::app::Document;
use crate::session::edit::shown_numbers;
use crate::session::table::{self, Column, order::order_by};
use crate::session::{Place, Row, Session};

use super::convention::model::decimals;
use super::pending::renamed;

/// Widest a column of numbers becomes, points.
const MAX_NUMBER_WIDTH: f32 = 112.0;
/// Width of a digit and of a point or sign in the font of numbers, points; all figures are equally wide.
const DIGIT_WIDTH: f32 = 7.7;
const POINT_WIDTH: f32 = 4.0;
/// Left and right of a number together, points.
const NUMBER_PADDING: f32 = 12.0;
/// Width of the checkbox's column, points.
const USED_WIDTH: f32 = 36.0;
const NARROW_USED_WIDTH: f32 = 30.0;
/// Widths of the label's column, points.
const LABEL_WIDTH: [f32; 2] = [52.0, 120.0];
/// Width of the columns with choices, points.
const CHOICE_WIDTH: f32 = 48.0;
const NARROW_CHOICE_WIDTH: f32 = 42.0;
/// Least and greatest width of the check column, points.
const CHECK_WIDTH: [f32; 2] = [44.0, 220.0];

/// What is shown, and in which order.
#[derive(Clone, Debug, Default)]
pub struct View {
    /// The session that it was made of.
    pub session: Option<Arc<Session>>,
    revision: Option<u64>,
    /// Rows from top to bottom.
    pub rows: Vec<Row>,
    /// Columns from left to right, without row heads and check.
    pub columns: Vec<Column>,
    /// The column that the stations are in the order of, as far as it was asked for, and whether from high to low.
    pub sorted: Option<(Column, bool)>,
    /// Digits before the decimal point and signs of the columns, for their widths.
    whole_digits: Vec<(usize, bool)>,
    /// Labels of the sweeps that show their captures.
    unfolded: BTreeSet<String>,
    num_sweeps: usize,
}

impl View {
    /// Follows the document. Answers the session before it, if it has changed.
    pub fn refresh(&mut self, document: &Document) -> Option<Arc<Session>> {
        if self.revision == Some(document.revision) {
            return None;
        }
        self.revision = Some(document.revision);
        let before = self.session.replace(Arc::clone(&document.session));
        if let Some(before) = &before {
            for (old, new) in renamed(before, &document.session) {
                if self.unfolded.remove(old) {
                    self.unfolded.insert(new.to_owned());
                }
            }
        }
        self.columns = table::columns(&document.session);
        self.measure(&document.session);
        self.sorted = self.sorted.filter(|(column, is_descending)| {
            self.columns.contains(column)
                && order_by(&document.session, *column, *is_descending)
                    .iter()
                    .copied()
                    .eq(0..document.session.stations.len())
        });
        self.num_sweeps = document.session.stations.iter().filter(|station| station.captures.len() > 1).count();
        self.lay_rows();
        before
    }

    fn lay_rows(&mut self) {
        if let Some(session) = &self.session {
            self.rows = table::rows(session, |station| self.unfolded.contains(&station.label));
        }
    }

    /// Number of stations with more than one capture.
    #[must_use]
    pub const fn num_sweeps(&self) -> usize {
        self.num_sweeps
    }

    /// Whether a sweep shows its captures.
    #[must_use]
    pub fn is_unfolded(&self, label: &str) -> bool {
        self.unfolded.contains(label)
    }

    /// Whether all sweeps do.
    #[must_use]
    pub fn is_all_unfolded(&self) -> bool {
        let num_stations = self.session.as_ref().map_or(0, |session| session.stations.len());
        self.num_sweeps > 0 && self.rows.len() > num_stations && self.unfolded_sweeps() == self.num_sweeps
    }

    fn unfolded_sweeps(&self) -> usize {
        let is_unfolded =
            |station: &&crate::session::Station| station.captures.len() > 1 && self.unfolded.contains(&station.label);
        self.session.as_ref().map_or(0, |session| session.stations.iter().filter(is_unfolded).count())
    }

    /// Shows the captures of a sweep, or hides them.
    pub fn toggle(&mut self, label: &str) {
        if !self.unfolded.remove(label) {
            self.unfolded.insert(label.to_owned());
        }
        self.lay_rows();
    }

    /// Shows or hides the captures of all sweeps.
    pub fn set_all_unfolded(&mut self, is_unfolded: bool) {
        let labels = |session: &Arc<Session>| session.stations.iter().map(|station| station.label.clone()).collect();
        self.unfolded = self.session.as_ref().filter(|_| is_unfolded).map(labels).unwrap_or_default();
        self.lay_rows();
    }

    /// The row that shows a capture: its own, or that of its station.
    #[must_use]
    pub fn row_of(&self, place: Place) -> Option<usize> {
        let station_row = self.rows.binary_search_by_key(&place.station_idx, |row| row.place().station_idx).ok()?;
        let first = (0..=station_row).rev().take_while(|row| self.rows[*row].place().station_idx == place.station_idx);
        let station_row = first.last()?;
        let own = station_row + 1 + place.capture_idx;
        let is_own = matches!(self.rows.get(own), Some(Row::Capture(there)) if *there == place);
        Some(if is_own { own } else { station_row })
    }

    /// How many digits stand before the point in each column of numbers, and whether a sign does.
    fn measure(&mut self, session: &Session) {
        let mut largest: Vec<(f64, bool)> = vec![(0.0, false); self.columns.len()];
        let notation = &session.robot.notation;
        for (station_idx, station) in session.stations.iter().enumerate() {
            for (capture_idx, capture) in station.captures.iter().enumerate() {
                let numbers = shown_numbers(capture, notation);
                for (column, (largest, is_signed)) in self.columns.iter().zip(&mut largest) {
                    let value = match column {
                        Column::Number(idx) => numbers.get(*idx).copied(),
                        _ => table::number(session, Place { station_idx, capture_idx }, *column),
                    };
                    let value = value.unwrap_or(0.0);
                    *largest = largest.max(value.abs());
                    *is_signed |= value < 0.0;
                }
            }
        }
        let digits = |value: f64| format!("{:.0}", value.trunc()).len();
        self.whole_digits = largest.into_iter().map(|(value, is_signed)| (digits(value), is_signed)).collect();
    }

    /// Decimals and widths of the columns within the width available, with the check column's as the last.
    #[must_use]
    pub fn layout(&self, available: f32) -> Layout {
        let notation = self.session.as_ref().map(|session| session.robot.notation).unwrap_or_default();
        let attempt = |is_narrow: bool| {
            let mut decimals = Vec::with_capacity(self.columns.len());
            let mut widths = Vec::with_capacity(self.columns.len() + 1);
            for (column, (whole, is_signed)) in self.columns.iter().zip(&self.whole_digits) {
                let kept = decimals_shown(&notation, *column).saturating_sub(usize::from(is_narrow));
                decimals.push(kept);
                widths.push(match column {
                    Column::Used => {
                        if is_narrow {
                            NARROW_USED_WIDTH
                        } else {
                            USED_WIDTH
                        }
                    }
                    Column::Label => LABEL_WIDTH[0],
                    Column::Side | Column::Edge => {
                        if is_narrow {
                            NARROW_CHOICE_WIDTH
                        } else {
                            CHOICE_WIDTH
                        }
                    }
                    Column::Number(_) | Column::Step | Column::Point(_) => {
                        #[expect(clippy::cast_precision_loss, reason = "a few digits")]
                        let digits = (whole + kept) as f32;
                        let signs = if *is_signed { DIGIT_WIDTH } else { 0.0 };
                        let head = head_width(&notation, *column);
                        (digits * DIGIT_WIDTH + POINT_WIDTH + signs + NUMBER_PADDING).max(head).ceil()
                    }
                });
            }
            widths.push(CHECK_WIDTH[0]);
            let used: f32 = widths.iter().sum();
            (Layout { decimals, widths, is_narrow }, available - used)
        };
        let (mut layout, mut free) = attempt(false);
        if free < 0.0 {
            (layout, free) = attempt(true);
        }
        self.share(&mut layout.widths, free);
        layout
    }

    /// Gives what is free to the columns that gain by it: half to the label and the check, the rest to the numbers.
    fn share(&self, widths: &mut [f32], free: f32) {
        let mut free = free.max(0.0);
        let num_columns = self.columns.len();
        let grow = |width: &mut f32, limit: f32, part: f32| {
            let more = part.min(limit - *width).max(0.0).floor();
            *width += more;
            more
        };
        let half = free / 4.0;
        if let Some(label) = self.columns.iter().position(|column| *column == Column::Label) {
            free -= grow(&mut widths[label], LABEL_WIDTH[1], half);
        }
        free -= grow(&mut widths[num_columns], CHECK_WIDTH[1] / 2.0, half);
        let numbers: Vec<usize> = (0..num_columns).filter(|idx| self.columns[*idx].is_number()).collect();
        #[expect(clippy::cast_precision_loss, reason = "a few columns")]
        let each = free / numbers.len().max(1) as f32;
        for idx in numbers {
            free -= grow(&mut widths[idx], MAX_NUMBER_WIDTH, each);
        }
        // The last column reaches the border.
        widths[num_columns] += free;
    }
}

/// Decimals and widths, points.
#[derive(Clone, Debug, PartialEq)]
pub struct Layout {
    /// Decimals shown, one a column.
    pub decimals: Vec<usize>,
    /// Widths, one a column and one for the check.
    pub widths: Vec<f32>,
    /// Whether a decimal was given up for want of room.
    pub is_narrow: bool,
}

/// What controllers report: a micrometre, and about as much at arm's length.
#[must_use]
pub fn decimals_shown(notation: &crate::geometry::PoseNotation, column: Column) -> usize {
    match column {
        Column::Number(idx) => decimals(notation, idx),
        Column::Step | Column::Point(_) => 3,
        Column::Used | Column::Label | Column::Side | Column::Edge => 0,
    }
}

/// Room for name and unit in the head, points.
fn head_width(notation: &crate::geometry::PoseNotation, column: Column) -> f32 {
    let letters = crate::text::poses::column_head(notation, column).chars().count();
    #[expect(clippy::cast_precision_loss, reason = "a few letters")]
    let width = letters as f32 * 5.6;
    width + NUMBER_PADDING
}
