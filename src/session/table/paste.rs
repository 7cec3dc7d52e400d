//! Pasting a block of cells: what it changes, what it adds, and what of it cannot be read.

use std::collections::{HashMap, HashSet};
use std::sync::Arc;

use crate::calibrate::SideChoice;
use crate::geometry::notation::OrientationForm;
use crate::geometry::{Base, Flange, PoseNotation, Profile, Transform};
use crate::session::edit::{CellValue, free_label};
use crate::session::model::{Capture, Edge, Reading, Session, Station, Target, UnknownFields};
use crate::session::{Edit, Place, Row};

use super::number::{NotANumber, Unit, parse_number, parse_quantity};
use super::{CellProblem, Column, RefusedCell, TypedCell, column_name, column_unit, has_cell, read_cells};

/// Where a block goes.
#[derive(Clone, Copy, Debug)]
pub struct Spot<'a> {
    /// The rows of the table as they are shown.
    pub rows: &'a [Row],
    /// Its columns.
    pub columns: &'a [Column],
    /// Row of the block's first cell.
    pub row_idx: usize,
    /// Column of the block's first cell.
    pub column_idx: usize,
}

/// What pasting does.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Pasted {
    /// The change; nothing if no cell gets another value.
    pub edit: Option<Edit>,
    /// Texts that cannot be read, by the label that their station will have.
    pub refused: Vec<(String, RefusedCell)>,
    /// Cells of stations that are there already.
    pub overwritten: Vec<(Place, Column)>,
    /// Labels of stations that were added but take no part until they are complete.
    pub held_back: Vec<String>,
    /// Rows and columns of the block.
    pub size: [usize; 2],
    /// Texts that lie beyond the last column, or where no value can stand.
    pub num_left_out: usize,
}

/// Pastes a block of texts. Rows beyond the last add stations; a first row with names of columns says where the others
/// go and is not pasted.
#[must_use]
pub fn paste(session: &Session, spot: &Spot<'_>, block: &[Vec<String>]) -> Pasted {
    let (columns, block) = target_columns(session, spot, block);
    let mut pasted = Pasted { size: [block.len(), columns.len()], ..Pasted::default() };
    let num_stations = session.stations.len();
    let num_existing = spot.rows.len().saturating_sub(spot.row_idx);
    let num_added = block.len().saturating_sub(num_existing);
    let mut extended = session.clone();
    append_blank(&mut extended, num_added);
    let mut typed = Vec::new();
    for (idx, texts) in block.iter().enumerate() {
        let row = match idx.checked_sub(num_existing) {
            None => spot.rows[spot.row_idx + idx],
            Some(added_idx) => Row::Station(num_stations + added_idx),
        };
        let is_added = idx >= num_existing;
        pasted.num_left_out += texts.iter().skip(columns.len()).filter(|text| !text.is_empty()).count();
        for (text, target) in texts.iter().zip(&columns) {
            let Some(Goal { column, unit }) = target else {
                pasted.num_left_out += usize::from(!text.is_empty());
                continue;
            };
            let column = *column;
            if !has_cell(&extended, row, column) {
                pasted.num_left_out += usize::from(!text.is_empty());
            } else if column.can_be_empty() || !text.is_empty() {
                typed.push(TypedCell { place: row.place(), column, text: with_unit(text, unit.as_deref()) });
            }
        }
        if is_added {
            typed.extend(missing_numbers(&extended, row.place(), &columns, texts));
        }
    }
    let is_there = |cell: &&TypedCell| cell.place.station_idx < num_stations;
    pasted.overwritten = typed.iter().filter(is_there).map(|cell| (cell.place, cell.column)).collect();
    let read = read_cells(&extended, &typed);
    let incomplete: HashSet<usize> = read.refused.iter().map(|refused| refused.cell.place.station_idx).collect();
    let new_labels: HashMap<usize, String> = read
        .values
        .iter()
        .filter_map(|(place, value)| match value {
            CellValue::Label(label) => Some((place.station_idx, label.clone())),
            _ => None,
        })
        .collect();
    let label_of =
        |station_idx: usize| new_labels.get(&station_idx).unwrap_or(&extended.stations[station_idx].label).clone();
    pasted.refused =
        read.refused.into_iter().map(|refused| (label_of(refused.cell.place.station_idx), refused)).collect();
    if num_added == 0 {
        pasted.edit = (!read.values.is_empty()).then_some(Edit::SetCells(read.values));
        return pasted;
    }
    // The values were read against the extended session, all of them together, as labels may change places.
    let Ok(mut filled) = Edit::SetCells(read.values.clone()).apply(&extended) else {
        // The document says why it does not take them.
        pasted.edit = Some(Edit::SetCells(read.values));
        return pasted;
    };
    let mut edits = Vec::new();
    let mut values = read.values;
    values.retain(|(place, _)| place.station_idx < num_stations);
    if !values.is_empty() {
        edits.push(Edit::SetCells(values));
    }
    let mut added = filled.stations.split_off(num_stations);
    for (idx, station) in added.iter_mut().enumerate() {
        if incomplete.contains(&(num_stations + idx)) && station.enabled {
            station.enabled = false;
            pasted.held_back.push(station.label.clone());
        }
    }
    edits.push(Edit::InsertStations { at: num_stations, stations: added });
    pasted.edit = match edits.len() {
        0 | 1 => edits.pop(),
        _ => Some(Edit::Several(edits)),
    };
    pasted
}

/// Where a column of the block goes.
#[derive(Clone, Debug, PartialEq)]
struct Goal {
    column: Column,
    /// The unit that its name in the first line gives, if it is not the table's own.
    unit: Option<String>,
}

/// A number with the unit of its column, unless it has one of its own.
fn with_unit(text: &str, unit: Option<&str>) -> String {
    match unit {
        Some(unit) if parse_number(text).is_ok() => format!("{text} {unit}"),
        _ => text.to_owned(),
    }
}

/// The column of each column of the block, and the rows without the line of names.
fn target_columns<'b>(
    session: &Session,
    spot: &Spot<'_>,
    block: &'b [Vec<String>],
) -> (Vec<Option<Goal>>, &'b [Vec<String>]) {
    let notation = &session.robot.notation;
    let by_name = |text: &String| {
        let name = text.split([' ', '(', '/', '[']).next().unwrap_or_default().to_lowercase();
        let full = text.split(['(', '/', '[']).next().unwrap_or_default().trim().to_lowercase();
        let column = spot.columns.iter().copied().find(|column| {
            let known = column_name(notation, *column).to_lowercase();
            known == full || (known == name && !full.starts_with("point"))
        })?;
        let own = column_unit(notation, column);
        let unit = unit_of_name(text).filter(|unit| {
            column.is_number() && (Unit::parse(unit).is_none() || Unit::parse(unit) != Unit::parse(own))
        });
        Some(Goal { column, unit: unit.map(str::to_owned) })
    };
    if let Some((first, rest)) = block.split_first() {
        let names: Vec<Option<Goal>> = first.iter().map(by_name).collect();
        let num_names = names.iter().flatten().count();
        let has_number = first.iter().any(|text| parse_quantity(text).is_ok());
        // One word alone may as well be a value: a label, an edge.
        let has_unit = first.iter().any(|text| unit_of_name(text).is_some_and(|unit| Unit::parse(unit).is_some()));
        let names_own_column = match &names[..] {
            [Some(target)] => spot.columns.get(spot.column_idx) == Some(&target.column),
            _ => false,
        };
        let is_meant = num_names >= 2 || (num_names == 1 && (has_unit || names_own_column));
        if is_meant && !has_number && 2 * num_names >= first.len() && !rest.is_empty() {
            return (names, rest);
        }
    }
    let width = block.iter().map(Vec::len).max().unwrap_or(0);
    let target = |column: &Column| Goal { column: *column, unit: None };
    let columns = (0..width).map(|idx| spot.columns.get(spot.column_idx + idx).map(target)).collect();
    (columns, block)
}

/// What stands in brackets, or behind a slash, in the name of a column.
fn unit_of_name(text: &str) -> Option<&str> {
    let (_, unit) = text.split_once(['(', '[', '/'])?;
    Some(unit.trim().trim_end_matches([')', ']']).trim()).filter(|unit| !unit.is_empty())
}

/// The numbers of an added pose that the block does not have, as empty cells to be filled in.
fn missing_numbers<'a>(
    session: &'a Session,
    place: Place,
    columns: &'a [Option<Goal>],
    texts: &'a [String],
) -> impl Iterator<Item = TypedCell> + 'a {
    let has = move |column: Column| {
        let is_it = |target: &Option<Goal>| target.as_ref().is_some_and(|target| target.column == column);
        texts.iter().zip(columns).any(|(text, target)| is_it(target) && !text.is_empty())
    };
    (0..session.robot.notation.num_numbers())
        .map(Column::Number)
        .filter(move |column| !has(*column))
        .map(move |column| TypedCell { place, column, text: String::new() })
}

fn append_blank(session: &mut Session, number: usize) {
    let mut taken: HashSet<String> = session.stations.iter().map(|station| station.label.clone()).collect();
    for _ in 0..number {
        let label = free_label(&(session.stations.len() + 1).to_string(), &taken);
        taken.insert(label.clone());
        let edge = (session.target == Target::RightAnglePlate).then_some(Edge::P);
        session.stations.push(station_without_reading(label, zero_pose(&session.robot.notation), edge));
    }
}

/// A station that was not measured yet.
#[must_use]
pub fn station_without_reading(
    label: String,
    base_from_flange: Transform<Base, Flange>,
    edge: Option<Edge>,
) -> Station {
    let capture = Capture {
        base_from_flange,
        written_angles: None,
        reading: no_reading(),
        step_mm: None,
        unknown: UnknownFields::new(),
    };
    Station {
        label,
        enabled: true,
        side: SideChoice::Auto,
        edge,
        captures: vec![capture],
        unknown: UnknownFields::new(),
    }
}

/// What a pose that was not measured at holds.
#[must_use]
pub fn no_reading() -> Reading {
    Reading::Profile(Arc::new(Profile::default()))
}

/// The pose whose numbers are all zero, or no rotation.
fn zero_pose(notation: &PoseNotation) -> Transform<Base, Flange> {
    let mut numbers = vec![0.0; notation.num_numbers()];
    match notation.orientation {
        OrientationForm::Angles => {}
        OrientationForm::QuaternionWxyz => numbers[3] = 1.0,
        OrientationForm::QuaternionXyzw => numbers[6] = 1.0,
    }
    notation.base_from_flange(&numbers).unwrap_or_else(|_| Transform::identity())
}

/// Whether a text stands for an empty cell that has to be filled in.
#[must_use]
pub fn is_missing(reason: &CellProblem) -> bool {
    matches!(reason, CellProblem::NotANumber(NotANumber::Empty))
}
