//! Edits of stations and captures: the rows of the pose table.

use crate::geometry::Vec3;
use crate::session::limits;
use crate::session::model::{Capture, Published, Session, Station, Target};

use super::labels::{Labels, repeated};
use super::valid::{check_capture, check_label, check_reading, check_stations, set_pose, within};
use super::{CellValue, EditRefusal, Place, Row};

fn station_at(session: &mut Session, place: Place) -> Result<&mut Station, EditRefusal> {
    session.stations.get_mut(place.station_idx).ok_or(EditRefusal::NoSuchPlace { place })
}

fn capture_at(session: &mut Session, place: Place) -> Result<&mut Capture, EditRefusal> {
    station_at(session, place)?.captures.get_mut(place.capture_idx).ok_or(EditRefusal::NoSuchPlace { place })
}

pub(super) fn set_cells(session: &mut Session, cells: &[(Place, CellValue)]) -> Result<(), EditRefusal> {
    for (place, value) in cells {
        match value {
            CellValue::Used(used) => station_at(session, *place)?.enabled = *used,
            CellValue::Label(label) => {
                check_label(label)?;
                station_at(session, *place)?.label.clone_from(label);
            }
            CellValue::Side(side) => station_at(session, *place)?.side = *side,
            CellValue::Edge(edge) => station_at(session, *place)?.edge = Some(*edge),
            CellValue::Pose(base_from_flange, written_angles) => {
                set_pose(capture_at(session, *place)?, *base_from_flange, *written_angles)?;
            }
            CellValue::Step(step_mm) => {
                step_mm.map_or(Ok(()), |step_mm| within(step_mm, &limits::STEP_MM))?;
                capture_at(session, *place)?.step_mm = *step_mm;
            }
            CellValue::Reading(reading) => {
                check_reading(reading)?;
                let capture = capture_at(session, *place)?;
                capture.reading = reading.clone();
                // What else the file said of the profile was about the one before.
                capture.unknown.shift_remove("profile");
            }
        }
    }
    // Labels may change places within one edit, so only the outcome counts.
    match repeated(session.stations.iter().map(|station| station.label.as_str())) {
        Some(label) => Err(EditRefusal::LabelTaken { label: label.to_owned() }),
        None => Ok(()),
    }
}

pub(super) fn insert(session: &mut Session, at: usize, stations: &[Station]) -> Result<(), EditRefusal> {
    if matches!(session.target, Target::Rgbd { .. }) {
        return Err(EditRefusal::NoStationsHere);
    }
    let at = at.min(session.stations.len());
    let mut added = stations.to_vec();
    check_stations(&mut added, &session.target, &mut Labels::of_stations(&session.stations))?;
    if !added.is_empty() {
        forget_printed_rows(session);
    }
    session.stations.splice(at..at, added);
    Ok(())
}

pub(super) fn append(session: &mut Session, station_idx: usize, capture: &Capture) -> Result<(), EditRefusal> {
    let station = station_at(session, Place { station_idx, capture_idx: 0 })?;
    let mut added = capture.clone();
    check_capture(&mut added)?;
    station.captures.push(added);
    Ok(())
}

/// What a paper printed is one row a station: with other stations it fits no more.
fn forget_printed_rows(session: &mut Session) {
    if let Some(published) = &mut session.published {
        published.target_in_base_mm.clear();
        published.error_from_first_mm.clear();
    }
}

/// Applies to every list of printed rows; they are empty or one a station.
fn for_printed_rows(session: &mut Session, mut change: impl FnMut(&mut Vec<Vec3>)) {
    if let Some(Published { target_in_base_mm, error_from_first_mm, .. }) = &mut session.published {
        for rows in [target_in_base_mm, error_from_first_mm] {
            if !rows.is_empty() {
                change(rows);
            }
        }
    }
}

fn check_rows(session: &Session, rows: &[Row]) -> Result<(), EditRefusal> {
    for place in rows.iter().map(|row| row.place()) {
        let exists =
            session.stations.get(place.station_idx).is_some_and(|station| place.capture_idx < station.captures.len());
        if !exists {
            return Err(EditRefusal::NoSuchPlace { place });
        }
    }
    Ok(())
}

/// From the last row to the first, each once, so that the places before it stay what they were.
fn from_the_end(rows: &[Row]) -> Vec<Row> {
    let mut rows = rows.to_vec();
    // A station's row comes after those of its captures here: it is dealt with last.
    rows.sort_by_key(|row| std::cmp::Reverse((row.place().station_idx, matches!(row, Row::Capture(_)), row.place())));
    rows.dedup();
    rows
}

pub(super) fn duplicate(session: &mut Session, rows: &[Row]) -> Result<(), EditRefusal> {
    check_rows(session, rows)?;
    // A station is copied as it was, also where some of its captures are copied as well.
    let before = session.stations.clone();
    let mut labels = Labels::of_stations(&session.stations);
    for row in from_the_end(rows) {
        let Place { station_idx, capture_idx } = row.place();
        match row {
            Row::Station(_) => {
                let mut copy = before[station_idx].clone();
                copy.label = labels.claim(&copy.label);
                session.stations.insert(station_idx + 1, copy);
                for_printed_rows(session, |printed| printed.insert(station_idx + 1, printed[station_idx]));
            }
            Row::Capture(_) => {
                let captures = &mut session.stations[station_idx].captures;
                captures.insert(capture_idx + 1, captures[capture_idx].clone());
            }
        }
    }
    Ok(())
}

pub(super) fn remove(session: &mut Session, rows: &[Row]) -> Result<(), EditRefusal> {
    check_rows(session, rows)?;
    let mut is_gone = vec![false; session.stations.len()];
    for row in from_the_end(rows) {
        let Place { station_idx, capture_idx } = row.place();
        match row {
            Row::Station(_) => is_gone[station_idx] = true,
            Row::Capture(_) => {
                let captures = &mut session.stations[station_idx].captures;
                captures.remove(capture_idx);
                is_gone[station_idx] = captures.is_empty();
            }
        }
    }
    let keep = |idx: usize| !is_gone[idx];
    for_printed_rows(session, |printed| {
        let mut idx = 0;
        printed.retain(|_| {
            idx += 1;
            keep(idx - 1)
        });
    });
    let mut idx = 0;
    session.stations.retain(|_| {
        idx += 1;
        keep(idx - 1)
    });
    Ok(())
}

pub(super) fn reorder(session: &mut Session, order: &[usize]) -> Result<(), EditRefusal> {
    let needed = session.stations.len();
    let mut once = order.to_vec();
    once.sort_unstable();
    if !once.iter().copied().eq(0..needed) {
        return Err(EditRefusal::NotAnOrder { found: order.len(), needed });
    }
    session.stations = order.iter().map(|idx| session.stations[*idx].clone()).collect();
    for_printed_rows(session, |printed| *printed = order.iter().map(|idx| printed[*idx]).collect());
    Ok(())
}
