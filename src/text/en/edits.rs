//! What the edits are called in the undo menu and the history.

use crate::session::edit::{CellValue, Edit, Row, SetupField};
use crate::session::{Place, Session};

use super::conventions::notation_in_full;
use super::plural;

/// The edit's name, as it follows "Undo: ".
#[must_use]
pub fn edit_label(edit: &Edit, session: &Session) -> String {
    match edit {
        Edit::SetCells(cells) => cells_label(cells, session),
        Edit::InsertStations { stations, .. } => format!("add {} station{}", stations.len(), plural(stations.len())),
        Edit::AppendCapture { station_idx, .. } => capture_label(&station_name(*station_idx, session)),
        Edit::Duplicate(rows) => format!("duplicate {}", rows_name(rows, session)),
        Edit::Remove(rows) => format!("delete {}", rows_name(rows, session)),
        Edit::Reorder(_) => "reorder stations".to_owned(),
        Edit::Setup(field) => format!("change {}", field_name(field)),
        Edit::SwitchNotation(notation) => format!("show poses as {}", notation_in_full(notation)),
        Edit::Reinterpret(notation) => format!("read the same numbers as {}", notation_in_full(notation)),
        Edit::SetKnown(_) => "change what is known of the target".to_owned(),
        Edit::SetRoughMounting(_) => "change the rough mounting".to_owned(),
        Edit::AddFurther(added) => format!("add {}", added.name),
        Edit::RemoveFurther(idx) => format!("remove {}", further_name(*idx, session)),
        Edit::RenameFurther(idx, _) => format!("rename {}", further_name(*idx, session)),
        Edit::SetFurtherKnown(idx, _) => format!("change what is known of {}", further_name(*idx, session)),
        Edit::UseFurtherStations { further_idx, station_idxs, used } => {
            let verb = if *used { "use" } else { "leave out" };
            format!("{verb} {}", further_stations(*further_idx, station_idxs, session))
        }
        Edit::Several(edits) => several_label(edits, session),
    }
}

/// Few are named one by one; of more than two, the first and how many others.
fn several_label(edits: &[Edit], session: &Session) -> String {
    match edits {
        [] => "change nothing".to_owned(),
        [only] => edit_label(only, session),
        _ if edits.iter().all(|edit| matches!(edit, Edit::AddFurther(_))) => {
            format!("add {} targets", edits.len())
        }
        [first, second] => format!("{} and {}", edit_label(first, session), edit_label(second, session)),
        [first, others @ ..] => format!("{} and {} other changes", edit_label(first, session), others.len()),
    }
}

/// Stations that came from elsewhere.
#[must_use]
pub fn import_label(num_stations: usize, source: &str) -> String {
    format!("import {num_stations} station{} from {source}", plural(num_stations))
}

/// What a cell captures for one station is one step.
#[must_use]
pub fn capture_label(station: &str) -> String {
    format!("capture {station}")
}

fn station_name(station_idx: usize, session: &Session) -> String {
    session.stations.get(station_idx).map_or_else(String::new, |station| format!("station {}", station.label))
}

fn further_name(further_idx: usize, session: &Session) -> &str {
    session.further.get(further_idx).map_or("", |further| further.name.as_str())
}

fn further_stations(further_idx: usize, station_idxs: &[usize], session: &Session) -> String {
    let name = further_name(further_idx, session);
    let only = match station_idxs {
        [idx] => session.further.get(further_idx).and_then(|further| further.stations.get(*idx)),
        _ => None,
    };
    match only {
        Some(station) => format!("station {} of {name}", station.label),
        None => format!("{} stations of {name}", station_idxs.len()),
    }
}

fn rows_name(rows: &[Row], session: &Session) -> String {
    match rows {
        [Row::Station(station_idx)] => station_name(*station_idx, session),
        [Row::Capture(place)] => {
            format!("capture {} of {}", place.capture_idx + 1, station_name(place.station_idx, session))
        }
        _ => format!("{} rows", rows.len()),
    }
}

fn cells_label(cells: &[(Place, CellValue)], session: &Session) -> String {
    let [(place, value)] = cells else { return format!("change {} cells", cells.len()) };
    let station = station_name(place.station_idx, session);
    match value {
        CellValue::Used(true) => format!("use {station}"),
        CellValue::Used(false) => format!("leave out {station}"),
        CellValue::Label(_) => format!("rename {station}"),
        CellValue::Side(_) => format!("set side of {station}"),
        CellValue::Edge(_) => format!("set edge of {station}"),
        CellValue::Pose(..) => format!("change pose of {station}"),
        CellValue::Step(_) => format!("change step of {station}"),
        CellValue::Reading(_) => format!("change reading of {station}"),
    }
}

const fn field_name(field: &SetupField) -> &'static str {
    match field {
        SetupField::Name(_) => "the session's name",
        SetupField::Notes(_) => "the notes",
        SetupField::RobotModel(_) => "the robot's name",
        SetupField::PositionStdMm(_) => "the noise of positions",
        SetupField::OrientationStdDeg(_) => "the noise of orientations",
        SetupField::SensorModel(_) => "the profiler's name",
        SetupField::ProfileStdMm(_) => "the noise of profiles",
        SetupField::ReferenceDistanceMm(_) => "the reference distance",
        SetupField::Target(_) => "the target",
        SetupField::Mount(_) => "where the sensor is",
    }
}
