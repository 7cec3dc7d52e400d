//! The order of stations by a column.

use std::cmp::Ordering;

use crate::calibrate::{Side, SideChoice};
use crate::session::model::{Edge, Session};
use crate::session::{Place, Station};

use super::{Column, number};

/// The order of the stations by a column, for [`crate::session::Edit::Reorder`]. Equal ones keep theirs, and those
/// without a value come last either way; a sweep goes by its first capture.
#[must_use]
pub fn order_by(session: &Session, column: Column, is_descending: bool) -> Vec<usize> {
    let stations = &session.stations;
    let mut order: Vec<usize> = (0..stations.len()).collect();
    if column.is_number() {
        let value = |station_idx| number(session, Place { station_idx, capture_idx: 0 }, column);
        let values: Vec<Option<f64>> = order.iter().map(|station_idx| value(*station_idx)).collect();
        order.sort_by(|a, b| match (values[*a], values[*b]) {
            (Some(a), Some(b)) => directed(a.total_cmp(&b), is_descending),
            (a, b) => b.is_some().cmp(&a.is_some()),
        });
    } else {
        order.sort_by(|a, b| directed(compare(&stations[*a], &stations[*b], column), is_descending));
    }
    order
}

const fn directed(ordering: Ordering, is_descending: bool) -> Ordering {
    if is_descending { ordering.reverse() } else { ordering }
}

fn compare(a: &Station, b: &Station, column: Column) -> Ordering {
    match column {
        // Those that take part first.
        Column::Used => b.enabled.cmp(&a.enabled),
        Column::Side => side_rank(a.side).cmp(&side_rank(b.side)),
        Column::Edge => edge_rank(a.edge).cmp(&edge_rank(b.edge)),
        Column::Label | Column::Number(_) | Column::Step | Column::Point(_) => natural(&a.label, &b.label),
    }
}

const fn side_rank(side: SideChoice) -> u8 {
    match side {
        SideChoice::Auto => 0,
        SideChoice::Given(Side::Plus) => 1,
        SideChoice::Given(Side::Minus) => 2,
    }
}

const fn edge_rank(edge: Option<Edge>) -> u8 {
    match edge {
        Some(Edge::P) => 0,
        Some(Edge::Q) => 1,
        None => 2,
    }
}

/// Numbers within names count as numbers: 2 comes before 10.
#[must_use]
pub fn natural(a: &str, b: &str) -> Ordering {
    let (mut left, mut right) = (a, b);
    loop {
        let (Some(first_left), Some(first_right)) = (left.chars().next(), right.chars().next()) else {
            return left.len().cmp(&right.len()).then_with(|| a.cmp(b));
        };
        if first_left.is_ascii_digit() && first_right.is_ascii_digit() {
            let ((digits_left, rest_left), (digits_right, rest_right)) = (digits(left), digits(right));
            let by_value = digits_left.len().cmp(&digits_right.len()).then_with(|| digits_left.cmp(digits_right));
            if by_value.is_ne() {
                return by_value;
            }
            (left, right) = (rest_left, rest_right);
        } else {
            let by_letter = first_left.to_lowercase().cmp(first_right.to_lowercase());
            if by_letter.is_ne() {
                return by_letter;
            }
            (left, right) = (&left[first_left.len_utf8()..], &right[first_right.len_utf8()..]);
        }
    }
}

/// The number at the beginning without its leading zeros, and what follows.
fn digits(text: &str) -> (&str, &str) {
    let end = text.find(|letter: char| !letter.is_ascii_digit()).unwrap_or(text.len());
    (text[..end].trim_start_matches('0'), &text[end..])
}
