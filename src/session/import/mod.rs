//! Poses and profiles from elsewhere: spreadsheets, robot programs, papers, other tools and whole folders.
//!
//! Text is recognised, read with options that can be changed while looking at a preview, and ends as stations. Nothing is
//! dropped silently: what could not be read is listed with file, line and column.

mod abb;
pub mod bag;
mod fanuc;
mod folder;
mod gather;
mod header;
mod kuka;
mod matching;
mod pose_pairs;
mod printed;
mod profiles;
mod program;
mod read;
mod recognise;
mod scan;
mod table;
mod ur;
mod yaml;

use std::path::PathBuf;
use std::sync::Arc;

use thiserror::Error;

use crate::geometry::PoseNotation;
use crate::session::{Edit, EditRefusal, Published, Reading, Session, Station, Target};
use crate::sheet::layout::Given;
use crate::sheet::text::decode;
use crate::watch::{Cancelled, Watch};

pub use crate::sheet::Separator;
pub use bag::{Bag, BagOptions, BagReport};
pub use folder::{MAX_FILE_BYTES, MAX_FILES, MAX_TOTAL_BYTES};
pub use gather::MAX_POSES;

/// A file, a pasted text, or a bag.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Source {
    /// As messages name it.
    pub name: String,
    /// What is read.
    pub content: Content,
}

/// What a source holds.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Content {
    /// A text in memory.
    Text(String),
    /// Recorded messages, which stay in their files until they are read.
    Bag(Arc<Bag>),
}

impl Source {
    /// From the bytes of a file, in whatever encoding they are.
    #[must_use]
    pub fn from_bytes(name: String, bytes: Vec<u8>) -> Self {
        Self::from_text(name, decode(bytes))
    }

    /// From a text.
    #[must_use]
    pub fn from_text(name: impl Into<String>, text: impl Into<String>) -> Self {
        Self { name: name.into(), content: Content::Text(text.into()) }
    }

    /// Its text; a bag has none.
    #[must_use]
    pub fn text(&self) -> &str {
        match &self.content {
            Content::Text(text) => text,
            Content::Bag(_) => "",
        }
    }

    /// The bag, if it is one.
    #[must_use]
    pub fn bag(&self) -> Option<&Bag> {
        match &self.content {
            Content::Text(_) => None,
            Content::Bag(bag) => Some(bag),
        }
    }
}

/// What a source was taken for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A session file of ours.
    Session,
    /// Rows of poses: CSV, TSV, or columns of blanks.
    PoseTable,
    /// A table of poses and reduced points as printed in a paper, with named values.
    PrintedTable,
    /// A FANUC program, `.ls`.
    FanucProgram,
    /// An ABB module, `.mod`.
    AbbModule,
    /// A KUKA program or data list, `.src` or `.dat`.
    KukaProgram,
    /// A list or script of Universal Robots with `p[…]`.
    UrScript,
    /// A profile: rows of x and z.
    Profile,
    /// Several profiles: x in the first column, z of one profile in each other.
    ProfileColumns,
    /// YAML with lists of points, and perhaps poses.
    Yaml,
    /// A JSON list of pairs of matrices: of the flange in the base, and of the target in the camera.
    PosePairs,
    /// Messages that ROS 2 has recorded.
    RosBag,
}

/// What a column of a table means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// Nothing of ours.
    Ignore,
    /// Name of the station; equal names in successive rows make a sweep of one station.
    Label,
    /// Coordinate of the position, 0 to 2.
    Position(usize),
    /// Number of the orientation, 0 to 3.
    Orientation(usize),
    /// Coordinate of the reduced point in the sensor, 0 to 2.
    Point(usize),
    /// Number of the target's pose in the sensor: 0 to 2 its position, from 3 on its orientation, written as the pose's or as
    /// a quaternion.
    Target(usize),
    /// Side of the ball's centre.
    Side,
    /// Edge of the plate that the station saw.
    Edge,
    /// Whether the station takes part.
    Used,
    /// Commanded step, mm.
    Step,
    /// Name or number of the profile that belongs to the pose.
    Profile,
    /// How the poses are written, as [`PoseNotation::text`] has it; the first row's counts for all.
    Notation,
}

/// What can be set in the preview; `None` is left to recognition.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ImportOptions {
    /// What the first source with poses is.
    pub kind: Option<Kind>,
    /// Between the cells of a table.
    pub separator: Option<Separator>,
    /// Whether `1,5` is one and a half.
    pub decimal_comma: Option<bool>,
    /// Whether the first row has names.
    pub has_header: Option<bool>,
    /// What the columns mean.
    pub roles: Option<Vec<Role>>,
    /// How the poses are written. Robot programs say most of it themselves; the tool point is the user's to know.
    pub notation: Option<PoseNotation>,
    /// The user frame or work object that positions of a robot program are in, as numbers in `notation`.
    pub base_from_user_frame: Option<[f64; 6]>,
    /// Unit of profiles.
    pub profile_length_unit: Option<crate::geometry::notation::LengthUnit>,
    /// Whether z of the profiles points the other way.
    pub is_z_mirrored: bool,
    /// How messages of a bag become captures.
    pub bag: BagOptions,
}

impl ImportOptions {
    /// What they say of a sheet.
    const fn given(&self) -> Given {
        Given { separator: self.separator, has_decimal_comma: self.decimal_comma, has_header: self.has_header }
    }
}

/// One source and what it gave.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// The source's name.
    pub name: String,
    /// What it was taken for.
    pub kind: Kind,
    /// Poses read from it.
    pub num_poses: usize,
    /// Profiles or points read from it.
    pub num_readings: usize,
    /// How its poses were read; `None` if it has none, or says so itself for each.
    pub notation: Option<PoseNotation>,
}

/// The first rows of the table, as they were read.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Preview {
    /// Names of the columns: the file's own, or what a program's values are.
    pub header: Vec<String>,
    /// What the columns were taken for.
    pub roles: Vec<Role>,
    /// Line in its source, from 1, and cells.
    pub rows: Vec<(usize, Vec<String>)>,
    /// Rows in all.
    pub num_rows: usize,
}

/// Something that could not be read and was left out.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("{file}, line {line}, column {column}: found {found}, expected {expected}")]
pub struct Problem {
    /// The source.
    pub file: String,
    /// Line, from 1.
    pub line: usize,
    /// Column of characters, from 1.
    pub column: usize,
    /// What stands there.
    pub found: String,
    /// What should.
    pub expected: String,
}

/// Something to know about what was read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Note {
    /// Poses in a user frame or work object that is not known: they were taken as those in the base.
    UserFrameTakenAsBase {
        /// Its name or number.
        frame: String,
        /// How many poses.
        num_poses: usize,
    },
    /// Poses of a tool point that is not known: they were taken as those of the flange.
    ToolTakenAsFlange {
        /// Its name or number.
        tool: String,
        /// How many poses.
        num_poses: usize,
    },
    /// Poses without a profile or point.
    PosesWithoutReading {
        /// How many.
        num_poses: usize,
    },
    /// Profiles without a pose, left out.
    ProfilesWithoutPose {
        /// Their sources.
        names: Vec<String>,
    },
    /// Quaternions rounded so much that they had to be normalised.
    QuaternionsNormalised {
        /// How many.
        num_poses: usize,
    },
    /// A text with several printed tables: the first was read.
    OtherTablesLeftOut {
        /// Caption of the one that was read; may be empty.
        caption: String,
        /// How many were left out.
        num_tables: usize,
    },
    /// Sources in which nothing was recognised, left out beside those that were.
    SourcesLeftOut {
        /// Their names.
        names: Vec<String>,
    },
    /// Positions for several groups of axes: the first group was read.
    OtherGroups {
        /// How many.
        num_poses: usize,
    },
    /// Poses given as joint angles only, left out.
    JointPoses {
        /// How many.
        num_poses: usize,
    },
    /// What became of the messages of a bag.
    Bag(Box<BagReport>),
}

/// What was read.
#[derive(Clone, Debug, PartialEq)]
pub struct Imported {
    /// The options with everything that was recognised filled in.
    pub options: ImportOptions,
    /// One entry a source.
    pub parts: Vec<Part>,
    /// The first rows of the poses.
    pub preview: Preview,
    /// The stations, labelled.
    pub stations: Vec<Station>,
    /// What was left out, at most [`MAX_PROBLEMS`].
    pub problems: Vec<Problem>,
    /// How many things were left out.
    pub num_problems: usize,
    /// What else to know.
    pub notes: Vec<Note>,
    /// What a printed table says of the ball.
    pub published: Option<Published>,
    /// The whole session, where the source is one.
    pub session: Option<Box<Session>>,
}

/// Problems that are listed; more are only counted.
pub const MAX_PROBLEMS: usize = 100;

/// Why nothing could be imported.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum ImportError {
    /// The operating system did not let us read it.
    #[error("cannot read {file}: {problem}")]
    Unreadable {
        /// The file or folder.
        file: String,
        /// The operating system's words.
        problem: String,
    },
    /// No file of poses is as large.
    #[error("{file}: found {found_bytes} bytes, expected at most {limit_bytes} bytes")]
    TooLarge {
        /// The file.
        file: String,
        /// Its size.
        found_bytes: u64,
        /// The largest size that is read.
        limit_bytes: u64,
    },
    /// Nothing in it looks like poses or profiles.
    #[error("{file}: found {found}, expected poses or profiles in one of the forms that the import knows")]
    NotRecognised {
        /// The source or the folder.
        file: String,
        /// What stands there.
        found: String,
    },
    /// Every row had a problem; this is the first.
    #[error("{0}")]
    NothingLeft(Problem),
    /// A bag that cannot be read.
    #[error(transparent)]
    Bag(#[from] bag::BagError),
    /// A session file that cannot be opened.
    #[error(transparent)]
    Session(#[from] crate::session::SessionError),
    /// The stations of a session do not go with those of another.
    #[error("{file}: {problem}")]
    NotAdded {
        /// The session file.
        file: String,
        /// Why.
        problem: String,
    },
    /// One notation was asked for, and the sources are written in several.
    #[error(
        "{first} and {other}: found poses written in two ways, expected one for which to say how they are read; import them one after the other"
    )]
    SeveralNotations {
        /// A source.
        first: String,
        /// Another.
        other: String,
    },
    /// The user thought better of it.
    #[error("the import was cancelled")]
    Cancelled,
}

impl From<Cancelled> for ImportError {
    fn from(_: Cancelled) -> Self {
        Self::Cancelled
    }
}

/// Reads files, and the files of folders, into memory: at most [`MAX_FILE_BYTES`] a file.
///
/// Files of a folder are named by their path in it. Hidden files and those that are certainly something else (pictures,
/// archives) are passed over. Of ROS 2 bags, which may be of any size, only the topics are listed; the files of one recording
/// are one source.
///
/// # Errors
/// [`ImportError::Unreadable`], [`ImportError::TooLarge`], [`ImportError::Bag`].
pub fn read_paths(paths: &[PathBuf]) -> Result<Vec<Source>, ImportError> {
    folder::read_paths(paths)
}

/// Reads sources as the options say, and by recognition where they leave it open; `notation` is taken for poses that
/// nothing is known of.
///
/// A table whose columns are not all known gives no stations, but its preview and a problem that says what is missing.
///
/// # Errors
/// [`ImportError`] if not a single pose or profile could be read.
pub fn read(
    sources: &[Source],
    options: &ImportOptions,
    notation: &PoseNotation,
    watch: &mut dyn Watch,
) -> Result<Imported, ImportError> {
    read::read(sources, options, notation, watch)
}

/// Whether these stations can be added to a session about this target: only a plate has edges that a station can have seen.
///
/// # Errors
/// [`EditRefusal::EdgesWithoutPlate`].
pub fn check_edges(stations: &[Station], target: &Target) -> Result<(), EditRefusal> {
    match stations.iter().filter(|station| station.edge.is_some()).count() {
        num_stations @ 1.. if *target != Target::RightAnglePlate => {
            Err(EditRefusal::EdgesWithoutPlate { num_stations })
        }
        _ => Ok(()),
    }
}

impl Imported {
    /// Whether the sources are about a plate: a station of them saw an edge.
    #[must_use]
    pub fn has_edges(&self) -> bool {
        self.session.is_none() && check_edges(&self.stations, &Target::Point).is_err()
    }

    /// Whether the sources are about a target whose whole pose was seen.
    #[must_use]
    pub fn has_target_poses(&self) -> bool {
        let mut captures = self.stations.iter().flat_map(|station| &station.captures);
        self.session.is_none() && captures.any(|capture| matches!(capture.reading, Reading::Pose(_)))
    }

    /// A new session with what was read, in the notation that it was read in; a session among the sources keeps its name
    /// and target and gets the stations of the others.
    ///
    /// # Errors
    /// [`EditRefusal`] if the stations cannot be in such a session.
    pub fn into_session(mut self, name: String, target: Target) -> Result<Session, EditRefusal> {
        if let Some(session) = self.session {
            let stations = self.stations.split_off(session.stations.len().min(self.stations.len()));
            return if stations.is_empty() { Ok(*session) } else { with_stations(&session, stations) };
        }
        let robot = crate::session::Robot {
            notation: self.options.notation.unwrap_or_default(),
            ..crate::session::Robot::default()
        };
        let empty = Session {
            name,
            notes: String::new(),
            robot,
            sensor: crate::session::Sensor::default(),
            target,
            known: crate::session::Known::default(),
            mount: crate::calibrate::Mount::default(),
            further: Vec::new(),
            stations: Vec::new(),
            published: None,
            truth: None,
            unknown: serde_json::Map::new(),
        };
        // Stations of a plate need an edge each; adding them sees to it.
        Ok(Session { published: self.published, ..with_stations(&empty, self.stations)? })
    }
}

/// The session with imported stations behind its own.
///
/// # Errors
/// [`EditRefusal`] if they cannot be in this session.
pub fn with_stations(session: &Session, stations: Vec<Station>) -> Result<Session, EditRefusal> {
    check_edges(&stations, &session.target)?;
    Edit::InsertStations { at: usize::MAX, stations }.apply(session)
}
