//! The session as a spreadsheet: columns, the text of cells, typed text back to values, and blocks of cells.

pub mod block;
pub mod fill;
pub mod number;
pub mod order;
pub mod paste;
pub mod read;

use crate::calibrate::{Side, SideChoice};
use crate::geometry::notation::{LengthUnit, OrientationForm};
use crate::geometry::{PoseNotation, Vec3};

use super::edit::shown_numbers;
use super::model::{Capture, Edge, Reading, Session, Station, Target};
use super::{Place, Row};

pub use number::{NotANumber, parse_number};
pub use read::{CellProblem, ReadCells, RefusedCell, TypedCell, read_cells};

/// A column of the pose table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Column {
    /// Whether the station takes part.
    Used,
    /// The station's name.
    Label,
    /// The side of the ball's centre.
    Side,
    /// The edge seen, for the right-angle plate.
    Edge,
    /// A number of the pose, by its index in [`PoseNotation::numbers`].
    Number(usize),
    /// The commanded move from the capture before, mm.
    Step,
    /// A coordinate of a point that was already reduced, or of a target's origin, 0 to 2, mm.
    Point(usize),
}

impl Column {
    /// Whether it says something about the whole station and not about single captures.
    #[must_use]
    pub const fn is_of_station(self) -> bool {
        matches!(self, Self::Used | Self::Label | Self::Side | Self::Edge)
    }

    /// Whether an empty cell of it means something.
    #[must_use]
    pub const fn can_be_empty(self) -> bool {
        matches!(self, Self::Step | Self::Point(_))
    }

    /// Whether its cells hold numbers.
    #[must_use]
    pub const fn is_number(self) -> bool {
        matches!(self, Self::Number(_) | Self::Step | Self::Point(_))
    }
}

/// The columns that a session needs, from left to right.
#[must_use]
pub fn columns(session: &Session) -> Vec<Column> {
    let captures = || session.stations.iter().flat_map(|station| &station.captures);
    let mut columns = vec![Column::Used, Column::Label];
    match session.target {
        Target::Ball { .. } => columns.push(Column::Side),
        Target::RightAnglePlate => columns.push(Column::Edge),
        Target::Point | Target::Pose { .. } | Target::Workpiece | Target::Rgbd { .. } => {}
    }
    columns.extend((0..session.robot.notation.num_numbers()).map(Column::Number));
    let has_steps = session.stations.iter().any(|station| station.captures.len() > 1)
        || captures().any(|capture| capture.step_mm.is_some());
    if has_steps {
        columns.push(Column::Step);
    }
    if captures().any(|capture| !has_profile(&capture.reading)) {
        columns.extend((0..3).map(Column::Point));
    }
    columns
}

/// The rows of a session, where `is_unfolded` says which sweeps show their captures.
#[must_use]
pub fn rows(session: &Session, is_unfolded: impl Fn(&Station) -> bool) -> Vec<Row> {
    let mut rows = Vec::with_capacity(session.stations.len());
    for (station_idx, station) in session.stations.iter().enumerate() {
        rows.push(Row::Station(station_idx));
        if station.captures.len() > 1 && is_unfolded(station) {
            let places = (0..station.captures.len()).map(|capture_idx| Place { station_idx, capture_idx });
            rows.extend(places.map(Row::Capture));
        }
    }
    rows
}

/// Whether a row has a value of its own in a column. A sweep's poses stand in the rows of its captures, and what is said
/// of the station in its own.
#[must_use]
pub fn has_cell(session: &Session, row: Row, column: Column) -> bool {
    match row {
        Row::Station(station_idx) => {
            let is_sweep = session.stations.get(station_idx).is_some_and(|station| station.captures.len() > 1);
            column.is_of_station() || !is_sweep
        }
        Row::Capture(_) => !column.is_of_station(),
    }
}

/// A reading with points, valid or not; a pose without a reading holds an empty profile.
fn has_profile(reading: &Reading) -> bool {
    matches!(reading, Reading::Profile(profile) if !profile.is_empty())
}

/// The capture at a place.
#[must_use]
pub fn capture_at(session: &Session, place: Place) -> Option<&Capture> {
    session.stations.get(place.station_idx)?.captures.get(place.capture_idx)
}

/// A value as a number, if the cell holds one: what is shown with fixed decimals, and what columns are ordered by.
#[must_use]
pub fn number(session: &Session, place: Place, column: Column) -> Option<f64> {
    let capture = capture_at(session, place)?;
    match column {
        Column::Number(idx) => shown_numbers(capture, &session.robot.notation).get(idx).copied(),
        Column::Step => capture.step_mm,
        Column::Point(axis) => point_of(capture)?.get(axis).copied(),
        Column::Used | Column::Label | Column::Side | Column::Edge => None,
    }
}

fn point_of(capture: &Capture) -> Option<Vec3> {
    match &capture.reading {
        Reading::Point(point_in_sensor) => Some(*point_in_sensor),
        Reading::Pose(sensor_from_target) => Some(sensor_from_target.translation_mm()),
        Reading::Profile(_) => None,
    }
}

/// The text of a cell as it is edited and copied: short, and with all digits that matter. Empty where there is no value.
#[must_use]
pub fn text(session: &Session, place: Place, column: Column) -> String {
    let Some(station) = session.stations.get(place.station_idx) else { return String::new() };
    match column {
        Column::Used => if station.enabled { "yes" } else { "no" }.to_owned(),
        Column::Label => station.label.clone(),
        Column::Side => side_text(station.side).to_owned(),
        Column::Edge => station.edge.map_or("", edge_text).to_owned(),
        Column::Number(_) | Column::Step | Column::Point(_) => number(session, place, column)
            .map_or_else(String::new, |value| number_text(value, decimals_kept(&session.robot.notation, column))),
    }
}

/// Decimals after which nothing is left that was ever measured or typed: 1e-9 mm and 1e-9°.
fn decimals_kept(notation: &PoseNotation, column: Column) -> usize {
    match column {
        Column::Number(0..3) if notation.length_unit == LengthUnit::Metres => 12,
        Column::Number(3..) if notation.orientation != OrientationForm::Angles => 12,
        Column::Number(3..) if notation.angle_unit == crate::geometry::notation::AngleUnit::Radians => 11,
        _ => 9,
    }
}

fn number_text(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

/// The column's name without its unit, as it stands in the first line of a copied table.
#[must_use]
pub fn column_name(notation: &PoseNotation, column: Column) -> &'static str {
    match column {
        Column::Used => "use",
        Column::Label => "station",
        Column::Side => "side",
        Column::Edge => "edge",
        Column::Number(0) => "x",
        Column::Number(1) => "y",
        Column::Number(2) => "z",
        Column::Number(idx) => notation.orientation_names().get(idx - 3).copied().unwrap_or_default(),
        Column::Step => "step",
        Column::Point(0) => "point x",
        Column::Point(1) => "point y",
        Column::Point(_) => "point z",
    }
}

/// The unit of a column's numbers; empty where there is none.
#[must_use]
pub fn column_unit(notation: &PoseNotation, column: Column) -> &'static str {
    match column {
        Column::Number(0..3) => notation.length_unit.symbol(),
        Column::Number(_) if notation.orientation == OrientationForm::Angles => notation.angle_unit.symbol(),
        Column::Step | Column::Point(_) => "mm",
        Column::Used | Column::Label | Column::Side | Column::Edge | Column::Number(_) => "",
    }
}

/// The side as it is typed.
#[must_use]
pub const fn side_text(side: SideChoice) -> &'static str {
    match side {
        SideChoice::Auto => "auto",
        SideChoice::Given(Side::Plus) => "+",
        SideChoice::Given(Side::Minus) => "-",
    }
}

/// The edge as it is typed.
#[must_use]
pub const fn edge_text(edge: Edge) -> &'static str {
    match edge {
        Edge::P => "p",
        Edge::Q => "q",
    }
}

/// What can be chosen in a cell of the column, as it is typed; nothing where any text may stand.
#[must_use]
pub const fn choices(column: Column) -> &'static [&'static str] {
    match column {
        Column::Side => &["auto", "+", "-"],
        Column::Edge => &["p", "q"],
        Column::Used | Column::Label | Column::Number(_) | Column::Step | Column::Point(_) => &[],
    }
}

#[cfg(test)]
mod tests;
