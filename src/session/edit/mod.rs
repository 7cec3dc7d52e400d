//! Everything that can be changed in a session by hand, as values: one edit is one step of undo.
//!
//! An edit is applied to a copy; what could not be saved and opened again is refused, so the document is always valid.

mod further;
mod labels;
mod notation;
mod refusal;
mod rows;
mod setup;
mod valid;

use crate::calibrate::{Mount, SideChoice};
use crate::geometry::{Base, Flange, PoseNotation, Sensor, Transform};

use super::model::{Capture, Edge, FurtherTarget, Known, Reading, Session, Station, Target, WrittenAngles};

pub use labels::free_label;
pub use notation::{shown_numbers, written_angles};
pub use refusal::EditRefusal;

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
            Self::SetCells(cells) => rows::set_cells(session, cells),
            Self::InsertStations { at, stations } => rows::insert(session, *at, stations),
            Self::AppendCapture { station_idx, capture } => rows::append(session, *station_idx, capture),
            Self::Duplicate(rows) => rows::duplicate(session, rows),
            Self::Remove(rows) => rows::remove(session, rows),
            Self::Reorder(order) => rows::reorder(session, order),
            Self::Setup(field) => setup::set_field(session, field),
            Self::SwitchNotation(notation) => notation::set_notation(session, notation),
            Self::Reinterpret(notation) => notation::reinterpret(session, notation),
            Self::SetKnown(known) => setup::set_known(session, known),
            Self::SetRoughMounting(rough) => setup::set_rough_mounting(session, rough.as_ref()),
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
