//! Tables in the layout of Lin & Mu's Tables 1 and 2, and what the paper itself printed.

use crate::calibrate::{Method, Mount};
use crate::geometry::Vec3;
use crate::report::comparison::{ErrorReference, MethodTable, PublishedTable, Row};
use crate::report::document::{Cell, Column, Table};
use crate::text::report as words;

/// Micrometres, and as many digits of a quaternion, as in the paper.
const LENGTH_DECIMALS: usize = 3;
const QUATERNION_DECIMALS: usize = 5;
const AXES: [&str; 3] = ["x", "y", "z"];

/// One row a station, or, of a plate, a point on an edge.
pub(super) fn of_method(method: Method, table: &MethodTable, suffix: &str) -> Table {
    let quaternion = ["q0", "q1", "q2", "q3"].into_iter().zip(["w", "x", "y", "z"]).map(|(title, part)| {
        Column::number(title, None, format!("base_from_flange_q_{part}")).under(words::FLANGE_IN_BASE)
    });
    let errors = ["Δx", "Δy", "Δz"];
    let standing = match table.mount {
        Mount::OnFlange => "target_in_base",
        Mount::Fixed => "target_in_flange",
    };
    let columns = std::iter::once(Column::words(words::NUMBER, "station"))
        .chain(quaternion)
        .chain(Column::vector_mm(words::FLANGE_POSITION, AXES, "base_from_flange"))
        .chain(Column::vector_mm(&words::in_sensor(method), AXES, "target_in_sensor"))
        .chain(Column::vector_mm(&words::in_standing_frame(method, table.mount), AXES, standing))
        .chain(Column::vector_mm(words::error(method), errors, "error"));
    Table {
        id: format!("{}{suffix}", method.id()),
        title: words::paper_table_title(method),
        columns: columns.collect(),
        rows: table.rows.iter().map(row).collect(),
        note: table.rows.iter().any(|row| row.used.is_none()).then(|| words::UNUSED_NOTE.to_owned()),
    }
}

fn row(row: &Row) -> Vec<Cell> {
    let vector = |vector: Option<Vec3>| match vector {
        Some(vector) => [0, 1, 2].map(|axis| Cell::number(vector[axis], LENGTH_DECIMALS)),
        None => [0, 1, 2].map(|_| Cell::missing()),
    };
    let used = row.used.as_ref();
    let error = used.map(|used| used.error_mm(ErrorReference::FirstStation));
    let error = match error {
        Some(error) => [0, 1, 2].map(|axis| Cell::signed(error[axis], LENGTH_DECIMALS)),
        None => vector(None),
    };
    std::iter::once(Cell::words(&row.label))
        .chain((0..4).map(|part| Cell::maybe(row.quaternion_wxyz.map(|parts| parts[part]), QUATERNION_DECIMALS)))
        .chain(vector(row.translation_mm))
        .chain(vector(used.map(|used| used.target_in_sensor_mm)))
        .chain(vector(used.map(|used| used.target_in_base_mm)))
        .chain(error)
        .collect()
}

/// What a paper printed, with the errors that follow from its own centres.
pub(super) fn published(published: &PublishedTable) -> Table {
    let errors = ["Δx", "Δy", "Δz"];
    let columns = std::iter::once(Column::words(words::NUMBER, "station"))
        .chain(Column::vector_mm(words::PRINTED_BALL, AXES, "printed_ball_in_base"))
        .chain(Column::vector_mm(words::PRINTED_ERROR, errors, "printed_error"))
        .chain(Column::vector_mm(words::RECOMPUTED_ERROR, errors, "recomputed_error"));
    let rows = published.rows.iter().enumerate().map(|(idx, row)| {
        let label = published.labels.get(idx).cloned().unwrap_or_else(|| (idx + 1).to_string());
        let printed = |axis: usize| {
            let Some(error_mm) = row.printed_error_mm else { return Cell::missing() };
            let cell = Cell::signed(error_mm[axis], LENGTH_DECIMALS);
            if row.is_misprint[axis] { Cell { text: format!("≠ {}", cell.text), ..cell }.strong() } else { cell }
        };
        std::iter::once(Cell::words(label))
            .chain((0..3).map(|axis| Cell::number(row.target_in_base_mm[axis], LENGTH_DECIMALS)))
            .chain((0..3).map(printed))
            .chain((0..3).map(|axis| Cell::signed(row.recomputed_error_mm[axis], LENGTH_DECIMALS)))
            .collect()
    });
    let has_errors = published.rows.iter().any(|row| row.printed_error_mm.is_some());
    Table {
        id: "published".to_owned(),
        title: if published.caption.is_empty() { words::PUBLISHED.to_owned() } else { published.caption.clone() },
        columns: columns.collect(),
        rows: rows.collect(),
        note: has_errors.then(|| words::misprints_note(published.num_misprints())),
    }
}
