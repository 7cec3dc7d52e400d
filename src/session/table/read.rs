//! Typed cells back to values of the session. Numbers that make one pose, or one point, are read together.

use std::collections::{BTreeMap, HashMap};

use thiserror::Error;

use crate::calibrate::{Side, SideChoice};
use crate::geometry::notation::{NotAPose, OrientationForm};
use crate::geometry::{PoseNotation, Transform, Vec3};
use crate::session::edit::{CellValue, shown_numbers, written_angles};
use crate::session::limits::{self, Quantity};
use crate::session::model::{Capture, Edge, Reading, Session};
use crate::session::{EditRefusal, Place};

use super::number::{NotANumber, Unit, parse_quantity};
use super::paste::no_reading;
use super::{Column, capture_at, column_unit, has_profile, point_of};

/// A text typed or pasted into a cell.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TypedCell {
    /// The row's capture.
    pub place: Place,
    /// The column.
    pub column: Column,
    /// The text.
    pub text: String,
}

/// Why a text cannot stand in its cell.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum CellProblem {
    /// Not a number.
    #[error(transparent)]
    NotANumber(#[from] NotANumber),
    /// A number outside its limits.
    #[error("found {found}, needed {expected}")]
    OutOfRange {
        /// The number.
        found: f64,
        /// What it may be.
        expected: String,
    },
    /// A number with a unit that the column cannot have.
    #[error("found \"{found}\", needed a number in {needed}")]
    UnitUnfit {
        /// The text.
        found: String,
        /// The column's unit.
        needed: &'static str,
    },
    /// Four numbers that are no rotation (yet).
    #[error(
        "not a rotation: found norm {norm:.4}, needed 1 within {tolerance}; type the other numbers of the quaternion"
    )]
    NotARotation {
        /// The norm.
        norm: f64,
        /// How far off it may be.
        tolerance: f64,
    },
    /// Another number of the same quaternion or point cannot be read.
    #[error("waits for the other numbers that belong to it")]
    OthersUnreadable,
    /// The numbers do not make a pose.
    #[error(transparent)]
    NotAPose(#[from] NotAPose),
    /// A label that the document does not take.
    #[error(transparent)]
    Label(EditRefusal),
    /// Neither yes nor no.
    #[error("found \"{0}\", needed yes or no")]
    NotYesOrNo(String),
    /// No side.
    #[error("found \"{0}\", needed auto, + or -")]
    NotASide(String),
    /// No edge.
    #[error("found \"{0}\", needed p or q")]
    NotAnEdge(String),
    /// A point in place of a profile that was measured.
    #[error("this capture has a profile of {num_points} points; a reduced point would replace it")]
    HasProfile {
        /// Points of the profile.
        num_points: usize,
    },
    /// A point needs three coordinates.
    #[error("found a part of a point, needed all three coordinates, or none")]
    PointIncomplete,
    /// The row or the column is not there, or the cell has no value of its own.
    #[error("found no such cell")]
    NoSuchCell,
}

/// A text that did not become a value.
#[derive(Clone, Debug, PartialEq)]
pub struct RefusedCell {
    /// The cell with its text.
    pub cell: TypedCell,
    /// Why.
    pub reason: CellProblem,
}

/// What became of typed cells.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReadCells {
    /// The new values; those that a cell has already are left out.
    pub values: Vec<(Place, CellValue)>,
    /// Texts without a value.
    pub refused: Vec<RefusedCell>,
}

impl ReadCells {
    fn refuse(&mut self, cell: &TypedCell, reason: CellProblem) {
        self.refused.push(RefusedCell { cell: cell.clone(), reason });
    }
}

/// Reads typed texts. Of several for one cell the last counts; numbers that are not among them stay as they are shown.
#[must_use]
pub fn read_cells(session: &Session, typed: &[TypedCell]) -> ReadCells {
    let mut by_place: BTreeMap<Place, BTreeMap<Column, &TypedCell>> = BTreeMap::new();
    for cell in typed {
        by_place.entry(cell.place).or_default().insert(cell.column, cell);
    }
    let mut read = ReadCells::default();
    let mut labels = Vec::new();
    for (place, cells) in by_place {
        let (Some(station), Some(capture)) = (session.stations.get(place.station_idx), capture_at(session, place))
        else {
            for cell in cells.values() {
                read.refuse(cell, CellProblem::NoSuchCell);
            }
            continue;
        };
        let mut take = |value: Result<Option<CellValue>, CellProblem>, cell: &TypedCell| match value {
            Ok(value) => read.values.extend(value.map(|value| (place, value))),
            Err(reason) => read.refuse(cell, reason),
        };
        for (column, cell) in &cells {
            match column {
                Column::Used => take(changed(yes_or_no(&cell.text), &station.enabled, CellValue::Used), cell),
                Column::Side => take(changed(side(&cell.text), &station.side, CellValue::Side), cell),
                Column::Edge => {
                    let edge = edge(&cell.text);
                    let is_new = !matches!(&edge, Ok(edge) if station.edge == Some(*edge));
                    take(edge.map(|edge| is_new.then_some(CellValue::Edge(edge))), cell);
                }
                Column::Step => take(changed(step(&cell.text), &capture.step_mm, CellValue::Step), cell),
                Column::Label => labels.push(*cell),
                Column::Number(_) | Column::Point(_) => {}
            }
        }
        read_pose(&mut read, &session.robot.notation, place, capture, &cells);
        read_point(&mut read, place, capture, &cells);
    }
    read_labels(&mut read, session, &labels);
    read
}

fn changed<T: PartialEq>(
    value: Result<T, CellProblem>,
    present: &T,
    into_value: fn(T) -> CellValue,
) -> Result<Option<CellValue>, CellProblem> {
    value.map(|value| (value != *present).then(|| into_value(value)))
}

fn found(text: &str) -> String {
    text.trim().chars().take(40).collect()
}

fn yes_or_no(text: &str) -> Result<bool, CellProblem> {
    match text.trim().to_lowercase().as_str() {
        "yes" | "y" | "true" | "1" | "on" | "x" | "✔" | "ja" | "wahr" | "oui" | "vrai" => Ok(true),
        "no" | "n" | "false" | "0" | "off" | "" | "nein" | "falsch" | "non" | "faux" => Ok(false),
        _ => Err(CellProblem::NotYesOrNo(found(text))),
    }
}

fn side(text: &str) -> Result<SideChoice, CellProblem> {
    match text.trim().to_lowercase().as_str() {
        "" | "auto" | "a" => Ok(SideChoice::Auto),
        "+" | "plus" | "1" | "+1" => Ok(SideChoice::Given(Side::Plus)),
        "-" | "−" | "–" | "minus" | "-1" | "−1" => Ok(SideChoice::Given(Side::Minus)),
        _ => Err(CellProblem::NotASide(found(text))),
    }
}

fn edge(text: &str) -> Result<Edge, CellProblem> {
    match text.trim().to_lowercase().as_str() {
        "p" => Ok(Edge::P),
        "q" => Ok(Edge::Q),
        _ => Err(CellProblem::NotAnEdge(found(text))),
    }
}

fn within(value: f64, quantity: &Quantity) -> Result<f64, CellProblem> {
    if quantity.admits(value) {
        Ok(value)
    } else {
        Err(CellProblem::OutOfRange { found: value, expected: quantity.to_string() })
    }
}

/// A number in the unit of its column, whichever it was written in.
fn number_in(text: &str, column_unit: &'static str) -> Result<f64, CellProblem> {
    let (value, unit) = parse_quantity(text)?;
    let Some(unit) = unit else { return Ok(value) };
    let factor = Unit::parse(column_unit).and_then(|own| unit.factor_to(own));
    let needed = if column_unit.is_empty() { "no unit" } else { column_unit };
    factor.map(|factor| value * factor).ok_or_else(|| CellProblem::UnitUnfit { found: found(text), needed })
}

fn step(text: &str) -> Result<Option<f64>, CellProblem> {
    if text.trim().is_empty() {
        return Ok(None);
    }
    within(number_in(text, "mm")?, &limits::STEP_MM).map(Some)
}

/// Labels may change places within one batch, so each is held against what the others become.
fn read_labels(read: &mut ReadCells, session: &Session, typed: &[&TypedCell]) {
    let mut pending: BTreeMap<usize, &TypedCell> = BTreeMap::new();
    for cell in typed {
        let label = cell.text.trim();
        if label.is_empty() || label.chars().any(char::is_control) {
            read.refuse(cell, CellProblem::Label(EditRefusal::LabelUnusable));
        } else {
            pending.insert(cell.place.station_idx, cell);
        }
    }
    if pending.is_empty() {
        return;
    }
    let own_label = |station_idx: usize| session.stations[station_idx].label.as_str();
    let mut count: HashMap<&str, usize> = HashMap::new();
    let mut wanting: HashMap<&str, Vec<usize>> = HashMap::new();
    for station_idx in 0..session.stations.len() {
        let label = pending.get(&station_idx).map_or_else(|| own_label(station_idx), |cell| cell.text.trim());
        *count.entry(label).or_default() += 1;
    }
    for (station_idx, cell) in &pending {
        wanting.entry(cell.text.trim()).or_default().push(*station_idx);
    }
    // Who is refused keeps the own label, which others may have wanted: these are looked at once more.
    let mut taken: Vec<&str> =
        pending.values().map(|cell| cell.text.trim()).filter(|label| count.get(label) > Some(&1)).collect();
    while let Some(label) = taken.pop() {
        for station_idx in wanting.remove(label).unwrap_or_default() {
            if let Some(cell) = pending.remove(&station_idx) {
                read.refuse(cell, CellProblem::Label(EditRefusal::LabelTaken { label: label.to_owned() }));
            }
            let own = own_label(station_idx);
            let num_own = count.entry(own).or_default();
            *num_own += 1;
            if *num_own > 1 {
                taken.push(own);
            }
        }
    }
    for (station_idx, cell) in pending {
        if session.stations[station_idx].label != cell.text.trim() {
            read.values.push((cell.place, CellValue::Label(cell.text.trim().to_owned())));
        }
    }
}

/// A coordinate or an angle that cannot be read does not keep the others from being taken; the numbers of a quaternion
/// are taken together or not at all.
fn read_pose(
    read: &mut ReadCells,
    notation: &PoseNotation,
    place: Place,
    capture: &Capture,
    cells: &BTreeMap<Column, &TypedCell>,
) {
    let mut numbers = shown_numbers(capture, notation);
    let shown = numbers.clone();
    let is_quaternion = notation.orientation != OrientationForm::Angles;
    let mut is_quaternion_readable = true;
    let mut taken: Vec<&TypedCell> = Vec::new();
    for (column, cell) in cells {
        let Column::Number(idx) = *column else { continue };
        let Some(number) = numbers.get_mut(idx) else {
            read.refuse(cell, CellProblem::NoSuchCell);
            continue;
        };
        match pose_number(&cell.text, idx, notation) {
            Ok(value) => {
                *number = value;
                taken.push(cell);
            }
            Err(reason) => {
                is_quaternion_readable &= idx < 3;
                read.refuse(cell, reason);
            }
        }
    }
    let is_of_orientation = |cell: &&TypedCell| matches!(cell.column, Column::Number(3..));
    if is_quaternion && taken.iter().any(is_of_orientation) {
        let norm = numbers[3..].iter().map(|number| number * number).sum::<f64>().sqrt();
        let tolerance = limits::QUATERNION_NORM_TOLERANCE;
        let reason = if is_quaternion_readable {
            ((norm - 1.0).abs() > tolerance).then_some(CellProblem::NotARotation { norm, tolerance })
        } else {
            Some(CellProblem::OthersUnreadable)
        };
        if let Some(reason) = reason {
            taken.iter().filter(|cell| is_of_orientation(cell)).for_each(|cell| read.refuse(cell, reason.clone()));
            taken.retain(|cell| !is_of_orientation(cell));
            numbers[3..].copy_from_slice(&shown[3..]);
        }
    }
    if taken.is_empty() || numbers == shown {
        return;
    }
    let has_new_orientation = taken.iter().any(is_of_orientation);
    match pose_value(notation, capture, &numbers, has_new_orientation) {
        Ok(value) => read.values.push((place, value)),
        Err(reason) => taken.into_iter().for_each(|cell| read.refuse(cell, reason.clone())),
    }
}

fn pose_number(text: &str, idx: usize, notation: &PoseNotation) -> Result<f64, CellProblem> {
    let value = number_in(text, column_unit(notation, Column::Number(idx)))?;
    match (idx, notation.orientation) {
        // In millimetres, so that the limit is that of the document.
        (0..3, _) => within(value * notation.length_unit.in_mm(), &limits::POSITION_MM)?,
        (_, OrientationForm::Angles) => within(value * notation.angle_unit.in_degrees(), &limits::ANGLE_DEG)?,
        _ => within(value, &limits::QUATERNION)?,
    };
    Ok(value)
}

fn pose_value(
    notation: &PoseNotation,
    capture: &Capture,
    numbers: &[f64],
    has_new_orientation: bool,
) -> Result<CellValue, CellProblem> {
    let read = notation.base_from_flange(numbers)?;
    for coordinate in &read.translation_mm() {
        within(*coordinate, &limits::POSITION_MM)?;
    }
    // Where only the position was typed, the rotation stays to the last bit.
    if !has_new_orientation {
        let base_from_flange = Transform::from_parts(read.translation_mm(), capture.base_from_flange.rotation());
        return Ok(CellValue::Pose(base_from_flange, capture.written_angles));
    }
    Ok(CellValue::Pose(read, written_angles(numbers, notation)))
}

fn read_point(read: &mut ReadCells, place: Place, capture: &Capture, cells: &BTreeMap<Column, &TypedCell>) {
    let typed: Vec<&TypedCell> =
        cells.iter().filter(|(column, _)| matches!(column, Column::Point(_))).map(|(_, cell)| *cell).collect();
    if typed.is_empty() {
        return;
    }
    let present = point_of(capture);
    let mut coordinates: [Option<f64>; 3] = std::array::from_fn(|axis| present.map(|point| point[axis]));
    let mut unreadable = Vec::new();
    for cell in &typed {
        let Column::Point(axis @ 0..3) = cell.column else { continue };
        coordinates[axis] = None;
        if cell.text.trim().is_empty() {
            continue;
        }
        let value = number_in(&cell.text, "mm").and_then(|value| within(value, &limits::POINT_MM));
        match value {
            Ok(value) => coordinates[axis] = Some(value),
            Err(reason) => {
                unreadable.push(cell.column);
                read.refuse(cell, reason);
            }
        }
    }
    let value = match (coordinates, &capture.reading) {
        _ if !unreadable.is_empty() => Err(CellProblem::OthersUnreadable),
        ([None, None, None], Reading::Profile(_)) => return,
        (_, Reading::Profile(profile)) if has_profile(&capture.reading) => {
            Err(CellProblem::HasProfile { num_points: profile.len() })
        }
        // The orientation of a target stays as it was.
        ([Some(x), Some(y), Some(z)], Reading::Pose(seen)) => {
            Ok(Reading::Pose(Transform::from_parts(Vec3::new(x, y, z), seen.rotation())))
        }
        (_, Reading::Pose(_)) => Err(CellProblem::PointIncomplete),
        ([Some(x), Some(y), Some(z)], _) => Ok(Reading::Point(Vec3::new(x, y, z))),
        ([None, None, None], _) => Ok(no_reading()),
        _ => Err(CellProblem::PointIncomplete),
    };
    match value {
        Ok(reading) if reading == capture.reading => {}
        Ok(reading) => read.values.push((place, CellValue::Reading(reading))),
        Err(reason) => {
            for cell in typed {
                if !unreadable.contains(&cell.column) {
                    read.refuse(cell, reason.clone());
                }
            }
        }
    }
}
