//! Everything that can be changed in a session by hand, as values: one edit is one step of undo.
//!
//! An edit is applied to a copy; what could not be saved and opened again is refused, so the document is always valid.

mod further;
mod labels;

use std::path::Path;

use nalgebra::UnitQuaternion;
use thiserror::Error;

use crate::calibrate::{Mount, SideChoice};
use crate::geometry::{Base, Flange, Frame, PoseNotation, Sensor, Transform, Vec3};

use super::limits::{self, Quantity};
use super::model::{Capture, Edge, FurtherTarget, Known, Published, Reading, Session, Station, Target, WrittenAngles};

pub use labels::free_label;
use labels::{Labels, repeated};

/// A capture's place in a session.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Place {
    /// Index of the station.
    pub station_idx: usize,
    /// Index of the capture in it.
    pub capture_idx: usize,
}

/// A row of the pose table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Row {
    /// A station with all its captures; its pose is that of the first.
    Station(usize),
    /// One capture of a station that is unfolded.
    Capture(Place),
}

impl Row {
    /// The capture whose pose stands in this row.
    #[must_use]
    pub const fn place(self) -> Place {
        match self {
            Self::Station(station_idx) => Place { station_idx, capture_idx: 0 },
            Self::Capture(place) => place,
        }
    }
}

/// A new value for a cell, or for several that belong together.
#[derive(Clone, Debug, PartialEq)]
pub enum CellValue {
    /// Whether the station takes part.
    Used(bool),
    /// The station's name.
    Label(String),
    /// The side of the ball's centre at this station.
    Side(SideChoice),
    /// The edge that this station saw.
    Edge(Edge),
    /// The capture's pose, with the angles as they were typed where they are the flange's.
    Pose(Transform<Base, Flange>, Option<WrittenAngles>),
    /// The commanded move from the capture before, mm.
    Step(Option<f64>),
    /// The capture's reading.
    Reading(Reading),
}

/// A field of the session as a whole.
#[derive(Clone, Debug, PartialEq)]
pub enum SetupField {
    /// The session's name.
    Name(String),
    /// The user's notes.
    Notes(String),
    /// Make and type of the robot.
    RobotModel(String),
    /// Standard deviation of a reported coordinate, mm.
    PositionStdMm(Option<f64>),
    /// Standard deviation of a reported orientation, degrees.
    OrientationStdDeg(Option<f64>),
    /// Make and type of the profiler.
    SensorModel(String),
    /// Standard deviation of a point along the range axis, mm.
    ProfileStdMm(Option<f64>),
    /// The distance for which accuracy is stated, mm.
    ReferenceDistanceMm(Option<f64>),
    /// What was measured.
    Target(Target),
    /// Where the sensor is.
    Mount(Mount),
}

/// A change of the session.
#[derive(Clone, Debug, PartialEq)]
pub enum Edit {
    /// New values for cells.
    SetCells(Vec<(Place, CellValue)>),
    /// Stations put before the one at `at`, or at the end; a label that is taken gets a number behind it.
    InsertStations {
        /// Index that the first of them will have.
        at: usize,
        /// The stations.
        stations: Vec<Station>,
    },
    /// A further capture of a station, behind those that it has.
    AppendCapture {
        /// Index of the station.
        station_idx: usize,
        /// The capture.
        capture: Box<Capture>,
    },
    /// A copy behind each of these rows.
    Duplicate(Vec<Row>),
    /// These rows taken out; a station without captures goes as well.
    Remove(Vec<Row>),
    /// The stations in another order: the station at place `n` will be that which is at `order[n]` now.
    Reorder(Vec<usize>),
    /// A field of the session as a whole.
    Setup(SetupField),
    /// The same poses, shown in other numbers.
    SwitchNotation(PoseNotation),
    /// The same numbers, read in another way: other poses.
    Reinterpret(PoseNotation),
    /// What is known of the session's own target from elsewhere.
    SetKnown(Known),
    /// Roughly how the sensor is mounted.
    SetRoughMounting(Option<Transform<Flange, Sensor>>),
    /// A further target behind those that there are; a name that is taken gets a number behind it.
    AddFurther(Box<FurtherTarget>),
    /// The further target of this index taken out.
    RemoveFurther(usize),
    /// Another name for the further target of this index.
    RenameFurther(usize, String),
    /// What is known of the further target of this index from elsewhere.
    SetFurtherKnown(usize, Known),
    /// Whether stations of a further target take part.
    UseFurtherStations {
        /// Index of the further target.
        further_idx: usize,
        /// Indices of its stations.
        station_idxs: Vec<usize>,
        /// Whether they take part.
        used: bool,
    },
    /// Several changes in this order, as one: all of them or none.
    Several(Vec<Edit>),
}

/// Why an edit cannot be made; the session stays as it was.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum EditRefusal {
    /// There is no such station or capture (any more).
    #[error("found no capture {} of station {}; it may have been removed", place.capture_idx + 1, place.station_idx + 1)]
    NoSuchPlace {
        /// Where it was looked for.
        place: Place,
    },
    /// A label that another station has.
    #[error("found the label \"{label}\" twice; each station needs one of its own")]
    LabelTaken {
        /// The label.
        label: String,
    },
    /// A label that cannot be shown.
    #[error("found a label that is empty or runs over a line's end; type some text on one line")]
    LabelUnusable,
    /// A number outside its limits.
    #[error("found {found}, needed {expected}")]
    OutOfRange {
        /// The number.
        found: f64,
        /// What it may be.
        expected: String,
    },
    /// An order that is none.
    #[error("found an order of {found} stations, needed each of the {needed} once")]
    NotAnOrder {
        /// How many it lists.
        found: usize,
        /// How many there are.
        needed: usize,
    },
    /// The numbers of a pose cannot be read in the other way.
    #[error("station {label}: {problem}")]
    NotAPose {
        /// The station.
        label: String,
        /// Why.
        problem: crate::geometry::notation::NotAPose,
    },
    /// A station without a pose and a reading.
    #[error("found station \"{label}\" without captures, needed a pose with what was measured there")]
    NoCaptures {
        /// The station.
        label: String,
    },
    /// A camera's sequence that is no folder beside the session.
    #[error("found the folder \"{found}\", needed that of a sequence, relative to the session's file")]
    NotASequence {
        /// The folder.
        found: String,
    },
    /// An RGB-D session has a sequence in place of stations.
    #[error("found a session of an RGB-D camera, which has no stations")]
    NoStationsHere,
    /// There is no such further target (any more).
    #[error("found no further target {}; it may have been removed", further_idx + 1)]
    NoSuchFurther {
        /// Where it was looked for.
        further_idx: usize,
    },
    /// There is no such station of a further target (any more).
    #[error("found no station {} of the further target {name}; it may have been removed", station_idx + 1)]
    NoSuchFurtherStation {
        /// The further target.
        name: String,
        /// Where the station was looked for.
        station_idx: usize,
    },
    /// A name that another further target has.
    #[error("found the name \"{name}\" twice; each further target needs one of its own")]
    NameTaken {
        /// The name.
        name: String,
    },
    /// Imported stations say which edge of a plate they saw, and the session is about something else.
    #[error(
        "found {num_stations} stations with an edge of a plate, needed a session of a right-angle plate; choose the plate as the target, or ignore the column edge"
    )]
    EdgesWithoutPlate {
        /// How many.
        num_stations: usize,
    },
    /// A sequence cannot stand beside other targets.
    #[error("found a sequence of an RGB-D camera as a further target, needed a target with stations")]
    NoSequenceAsFurther,
    /// Something known that a target of this kind does not have.
    #[error("found {field}, which a target of this kind does not have; needed {needed}")]
    NotKnownOfThis {
        /// The field, as the file names it.
        field: &'static str,
        /// What such a target has.
        needed: &'static str,
    },
}

impl Edit {
    /// The session with the edit made.
    ///
    /// # Errors
    /// [`EditRefusal`] if it cannot be made as a whole; nothing of it is made then.
    pub fn apply(&self, session: &Session) -> Result<Session, EditRefusal> {
        let mut changed = session.clone();
        self.change(&mut changed)?;
        Ok(changed)
    }

    /// Changes the session in place; after a refusal it may be half changed.
    fn change(&self, session: &mut Session) -> Result<(), EditRefusal> {
        match self {
            Self::SetCells(cells) => set_cells(session, cells),
            Self::InsertStations { at, stations } => insert(session, *at, stations),
            Self::AppendCapture { station_idx, capture } => append(session, *station_idx, capture),
            Self::Duplicate(rows) => duplicate(session, rows),
            Self::Remove(rows) => remove(session, rows),
            Self::Reorder(order) => reorder(session, order),
            Self::Setup(field) => set_field(session, field),
            Self::SwitchNotation(notation) => set_notation(session, notation),
            Self::Reinterpret(notation) => reinterpret(session, notation),
            Self::SetKnown(known) => {
                check_known(known, &session.target)?;
                session.known = *known;
                Ok(())
            }
            Self::SetRoughMounting(rough) => set_rough_mounting(session, rough.as_ref()),
            Self::AddFurther(added) => further::add(session, added),
            Self::RemoveFurther(idx) => further::remove(session, *idx),
            Self::RenameFurther(idx, name) => further::rename(session, *idx, name),
            Self::SetFurtherKnown(idx, known) => further::set_known(session, *idx, known),
            Self::UseFurtherStations { further_idx, station_idxs, used } => {
                further::use_stations(session, *further_idx, station_idxs, *used)
            }
            Self::Several(edits) => edits.iter().try_for_each(|edit| edit.change(session)),
        }
    }
}

fn within(value: f64, quantity: &Quantity) -> Result<(), EditRefusal> {
    if quantity.admits(value) {
        Ok(())
    } else {
        Err(EditRefusal::OutOfRange { found: value, expected: quantity.to_string() })
    }
}

fn all_within(values: &Vec3, quantity: &Quantity) -> Result<(), EditRefusal> {
    values.iter().try_for_each(|value| within(*value, quantity))
}

fn station_at(session: &mut Session, place: Place) -> Result<&mut Station, EditRefusal> {
    session.stations.get_mut(place.station_idx).ok_or(EditRefusal::NoSuchPlace { place })
}

fn capture_at(session: &mut Session, place: Place) -> Result<&mut Capture, EditRefusal> {
    station_at(session, place)?.captures.get_mut(place.capture_idx).ok_or(EditRefusal::NoSuchPlace { place })
}

fn set_cells(session: &mut Session, cells: &[(Place, CellValue)]) -> Result<(), EditRefusal> {
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

fn check_label(label: &str) -> Result<(), EditRefusal> {
    let is_usable = !label.trim().is_empty() && !label.chars().any(char::is_control);
    is_usable.then_some(()).ok_or(EditRefusal::LabelUnusable)
}

/// A profile is within its limits by its type.
fn check_reading(reading: &Reading) -> Result<(), EditRefusal> {
    match reading {
        Reading::Point(point_in_sensor) => all_within(point_in_sensor, &limits::POINT_MM),
        Reading::Profile(_) => Ok(()),
    }
}

/// Gives a capture another pose, in the form that it would have after saving and loading.
fn set_pose(
    capture: &mut Capture,
    base_from_flange: Transform<Base, Flange>,
    written_angles: Option<WrittenAngles>,
) -> Result<(), EditRefusal> {
    all_within(&base_from_flange.translation_mm(), &limits::POSITION_MM)?;
    if let Some(written) = &written_angles {
        written.angles_deg.iter().try_for_each(|angle| within(*angle, &limits::ANGLE_DEG))?;
    }
    capture.base_from_flange = as_saved(&base_from_flange);
    capture.written_angles = written_angles;
    if written_angles.is_none()
        && let Some(serde_json::Value::Object(of_pose)) = capture.unknown.get_mut("base_from_flange")
    {
        // What else the file said of angles that are there no more.
        of_pose.shift_remove("written");
        if of_pose.is_empty() {
            capture.unknown.shift_remove("base_from_flange");
        }
    }
    Ok(())
}

/// Of the two quaternions of a rotation the one with `w ≥ 0`, of unit norm as exactly as loading demands.
fn as_saved<Dst: Frame, Src: Frame>(pose: &Transform<Dst, Src>) -> Transform<Dst, Src> {
    let quaternion = pose.rotation().into_inner();
    let upper = if quaternion.w < 0.0 { -quaternion } else { quaternion };
    let rotation = if (upper.norm() - 1.0).abs() > limits::QUATERNION_NORM_EXACT {
        UnitQuaternion::new_normalize(upper)
    } else {
        UnitQuaternion::new_unchecked(upper)
    };
    Transform::from_parts(pose.translation_mm(), rotation)
}

fn insert(session: &mut Session, at: usize, stations: &[Station]) -> Result<(), EditRefusal> {
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

/// Stations from elsewhere, such as an import, are looked at as a whole.
fn check_stations(stations: &mut [Station], target: &Target, labels: &mut Labels) -> Result<(), EditRefusal> {
    for station in stations {
        check_station(station)?;
        station.label = labels.claim(&station.label);
        if *target == Target::RightAnglePlate {
            need_edge(station);
        }
    }
    Ok(())
}

/// A station of a plate saw an edge. One that does not say which takes no part until somebody has looked.
fn need_edge(station: &mut Station) {
    if station.edge.is_none() {
        station.edge = Some(Edge::P);
        station.enabled = false;
    }
}

fn check_station(station: &mut Station) -> Result<(), EditRefusal> {
    check_label(&station.label)?;
    if station.captures.is_empty() {
        return Err(EditRefusal::NoCaptures { label: station.label.clone() });
    }
    station.captures.iter_mut().try_for_each(check_capture)
}

fn check_capture(capture: &mut Capture) -> Result<(), EditRefusal> {
    set_pose(capture, capture.base_from_flange, capture.written_angles)?;
    check_reading(&capture.reading)?;
    capture.step_mm.map_or(Ok(()), |step_mm| within(step_mm, &limits::STEP_MM))
}

fn append(session: &mut Session, station_idx: usize, capture: &Capture) -> Result<(), EditRefusal> {
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

fn duplicate(session: &mut Session, rows: &[Row]) -> Result<(), EditRefusal> {
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

fn remove(session: &mut Session, rows: &[Row]) -> Result<(), EditRefusal> {
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

fn reorder(session: &mut Session, order: &[usize]) -> Result<(), EditRefusal> {
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

fn set_field(session: &mut Session, field: &SetupField) -> Result<(), EditRefusal> {
    let optional = |value: &Option<f64>, quantity: &Quantity| {
        value.map_or(Ok(()), |value| within(value, quantity)).map(|()| *value)
    };
    match field {
        SetupField::Name(name) => session.name.clone_from(name),
        SetupField::Notes(notes) => session.notes.clone_from(notes),
        SetupField::RobotModel(model) => session.robot.model.clone_from(model),
        SetupField::PositionStdMm(std) => session.robot.position_std_mm = optional(std, &limits::LENGTH_STD_MM)?,
        SetupField::OrientationStdDeg(std) => {
            session.robot.orientation_std_deg = optional(std, &limits::ORIENTATION_STD_DEG)?;
        }
        SetupField::SensorModel(model) => session.sensor.model.clone_from(model),
        SetupField::ProfileStdMm(std) => session.sensor.profile_std_mm = optional(std, &limits::LENGTH_STD_MM)?,
        SetupField::ReferenceDistanceMm(distance) => {
            session.sensor.reference_distance_mm = optional(distance, &limits::REFERENCE_DISTANCE_MM)?;
        }
        SetupField::Target(target) => set_target(session, target)?,
        SetupField::Mount(mount) => session.mount = *mount,
    }
    Ok(())
}

fn set_target(session: &mut Session, target: &Target) -> Result<(), EditRefusal> {
    check_target(target)?;
    match target {
        Target::RightAnglePlate => session.stations.iter_mut().for_each(need_edge),
        Target::Rgbd { .. } if !session.stations.is_empty() => return Err(EditRefusal::NoStationsHere),
        Target::Ball { .. } | Target::Point | Target::Workpiece | Target::Rgbd { .. } => {}
    }
    if std::mem::discriminant(target) != std::mem::discriminant(&session.target) {
        // The truth and what is known were of the other kind, and so was what else the file said of it.
        session.truth = None;
        session.known = Known::default();
        for name in ["target", "truth", "sequence", "stations"] {
            session.unknown.shift_remove(name);
        }
    }
    session.target = target.clone();
    Ok(())
}

fn check_target(target: &Target) -> Result<(), EditRefusal> {
    match target {
        Target::Ball { radius_mm, radius_std_mm } => {
            within(*radius_mm, &limits::BALL_RADIUS_MM)?;
            radius_std_mm.map_or(Ok(()), |std| within(std, &limits::LENGTH_STD_MM))
        }
        Target::Rgbd { sequence } if sequence.trim().is_empty() || Path::new(sequence).is_absolute() => {
            Err(EditRefusal::NotASequence { found: sequence.clone() })
        }
        Target::RightAnglePlate | Target::Point | Target::Workpiece | Target::Rgbd { .. } => Ok(()),
    }
}

/// A point was touched somewhere, a workpiece has sizes; of other targets nothing is known beside what they are.
fn check_known(known: &Known, target: &Target) -> Result<(), EditRefusal> {
    let Known { point_in_base_mm, angle_deg, pitch_mm, height_mm, diameter_mm } = known;
    let is_point = *target == Target::Point;
    let is_workpiece = *target == Target::Workpiece;
    let needed = match target {
        Target::Point => "touched_in_base_mm or nothing",
        Target::Workpiece => "angle_deg, pitch_mm, height_mm, diameter_mm or nothing",
        Target::Ball { .. } | Target::RightAnglePlate | Target::Rgbd { .. } => "nothing",
    };
    let sizes = [
        ("angle_deg", angle_deg, &limits::PLANE_ANGLE_DEG),
        ("pitch_mm", pitch_mm, &limits::PART_SIZE_MM),
        ("height_mm", height_mm, &limits::PART_SIZE_MM),
        ("diameter_mm", diameter_mm, &limits::PART_SIZE_MM),
    ];
    let stray = [("touched_in_base_mm", point_in_base_mm.is_some() && !is_point)]
        .into_iter()
        .chain(sizes.map(|(field, value, _)| (field, value.is_some() && !is_workpiece)))
        .find(|(_, is_stray)| *is_stray);
    if let Some((field, _)) = stray {
        return Err(EditRefusal::NotKnownOfThis { field, needed });
    }
    point_in_base_mm.as_ref().map_or(Ok(()), |point| all_within(point, &limits::POSITION_MM))?;
    sizes.into_iter().try_for_each(|(_, value, quantity)| value.map_or(Ok(()), |value| within(value, quantity)))
}

fn set_rough_mounting(session: &mut Session, rough: Option<&Transform<Flange, Sensor>>) -> Result<(), EditRefusal> {
    rough.map_or(Ok(()), |rough| all_within(&rough.translation_mm(), &limits::POSITION_MM))?;
    session.sensor.rough_flange_from_sensor = rough.map(as_saved);
    // What else the file said of it was about the one before.
    session.sensor.unknown.shift_remove("rough_flange_from_sensor");
    Ok(())
}

fn set_notation(session: &mut Session, notation: &PoseNotation) -> Result<(), EditRefusal> {
    if let Some(flange_from_tcp) = &notation.flange_from_tcp {
        all_within(&flange_from_tcp.translation_mm(), &limits::POSITION_MM)?;
    }
    session.robot.notation = *notation;
    Ok(())
}

/// The numbers of each pose, as they are shown now, read in the other way.
fn reinterpret(session: &mut Session, notation: &PoseNotation) -> Result<(), EditRefusal> {
    let shown = session.robot.notation;
    let of_further = session.further.iter_mut().flat_map(|further| &mut further.stations);
    for station in session.stations.iter_mut().chain(of_further) {
        for capture in &mut station.captures {
            let numbers = shown_numbers(capture, &shown);
            let base_from_flange = notation
                .base_from_flange(&numbers)
                .map_err(|problem| EditRefusal::NotAPose { label: station.label.clone(), problem })?;
            set_pose(capture, base_from_flange, written_angles(&numbers, notation))?;
        }
    }
    set_notation(session, notation)
}

/// The numbers of a capture's pose: as they were typed where that is known, as near gimbal lock other angles mean the same.
#[must_use]
pub fn shown_numbers(capture: &Capture, notation: &PoseNotation) -> Vec<f64> {
    let mut numbers = notation.numbers(&capture.base_from_flange);
    let written = capture.written_angles.filter(|written| written.convention.id == notation.convention.id);
    if let Some(written) = written.filter(|_| notation.writes_angles_of_the_flange()) {
        numbers.truncate(3);
        numbers.extend(written.angles_deg.map(|angle| angle / notation.angle_unit.in_degrees()));
    }
    numbers
}

/// The angles among the numbers of a pose, where they are to be kept beside the rotation.
#[must_use]
pub fn written_angles(numbers: &[f64], notation: &PoseNotation) -> Option<WrittenAngles> {
    let angles: [f64; 3] = numbers.get(3..)?.try_into().ok()?;
    let angles_deg = angles.map(|angle| angle * notation.angle_unit.in_degrees());
    let is_kept =
        notation.writes_angles_of_the_flange() && angles_deg.iter().all(|angle| limits::ANGLE_DEG.admits(*angle));
    is_kept.then_some(WrittenAngles { angles_deg, convention: notation.convention })
}
