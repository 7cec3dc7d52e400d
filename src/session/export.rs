//! Poses and profiles as CSV, so that other programs, and the import, can read them.

use std::fs;
use std::io::{self, Write};
use std::path::Path;

use thiserror::Error;

use crate::calibrate::SideChoice;
use crate::geometry::notation::OrientationForm;
use crate::geometry::{PoseNotation, Profile};

use super::edit::{Place, shown_numbers};
use super::import::Separator;
use super::table::edge_text;
use super::{Reading, Session, Target};

/// How the cells are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TableStyle {
    /// Between the cells; [`Separator::Blanks`] is written as a tabulator.
    pub separator: Separator,
    /// Whether one and a half is `1,5`.
    pub has_decimal_comma: bool,
}

impl Default for TableStyle {
    fn default() -> Self {
        Self { separator: Separator::Comma, has_decimal_comma: false }
    }
}

impl TableStyle {
    fn number(self, value: f64) -> String {
        let text = value.to_string();
        if self.has_decimal_comma { text.replace('.', ",") } else { text }
    }

    const fn delimiter(self) -> u8 {
        match self.separator {
            Separator::Comma => b',',
            Separator::Semicolon => b';',
            Separator::Tab | Separator::Blanks => b'\t',
        }
    }

    /// Text is quoted, so that no label is taken for a number, a comment or several cells.
    fn csv(self, rows: impl Iterator<Item = Vec<String>>) -> String {
        let mut writer = csv::WriterBuilder::new()
            .delimiter(self.delimiter())
            .quote_style(csv::QuoteStyle::NonNumeric)
            .from_writer(Vec::new());
        for row in rows {
            // Writing to memory cannot fail, and every row has as many cells.
            let _ = writer.write_record(&row);
        }
        let bytes = writer.into_inner().unwrap_or_default();
        String::from_utf8(bytes).unwrap_or_default()
    }
}

/// The file of a capture's profile, without its folder.
#[must_use]
pub fn profile_file_name(place: Place) -> String {
    format!("profile_{}_{}.csv", place.station_idx + 1, place.capture_idx + 1)
}

/// The captures, one a row, with their poses in the numbers of `notation`.
#[must_use]
pub fn poses_csv(session: &Session, notation: &PoseNotation, style: TableStyle) -> String {
    let unit = notation.length_unit.symbol();
    let position = ["x", "y", "z"].map(|axis| format!("{axis}_{unit}"));
    let angle_unit = match (notation.orientation, notation.angle_unit.symbol()) {
        (OrientationForm::Angles, "rad") => "_rad",
        (OrientationForm::Angles, _) => "_deg",
        _ => "",
    };
    let orientation = notation.orientation_names().iter().map(|name| format!("{name}{angle_unit}"));
    let has_edges = session.target == Target::RightAnglePlate;
    let is_pose = session.target.is_pose();
    let head: Vec<String> = ["label", "capture", "side"]
        .into_iter()
        .chain(has_edges.then_some("edge"))
        .chain(["enabled", "step_mm"])
        .map(str::to_owned)
        .chain(position)
        .chain(orientation)
        .chain(["point_x_mm", "point_y_mm", "point_z_mm", "profile", "notation"].map(str::to_owned))
        .chain(TARGET_POSE.into_iter().filter(|_| is_pose).map(str::to_owned))
        .collect();
    // In every row, as people sort and cut tables.
    let notation_text = notation.text();
    let rows = session.stations.iter().enumerate().flat_map(|(station_idx, station)| {
        let notation_text = &notation_text;
        station.captures.iter().enumerate().map(move |(capture_idx, capture)| {
            let side = match station.side {
                SideChoice::Auto => "auto",
                SideChoice::Given(side) => side.symbol(),
            };
            let mut row = vec![station.label.clone(), (capture_idx + 1).to_string(), side.to_owned()];
            row.extend(has_edges.then(|| station.edge.map_or("", edge_text).to_owned()));
            row.extend([
                if station.enabled { "yes" } else { "no" }.to_owned(),
                capture.step_mm.map_or_else(String::new, |step_mm| style.number(step_mm)),
            ]);
            row.extend(shown_numbers(capture, notation).iter().map(|number| style.number(*number)));
            match &capture.reading {
                Reading::Pose(_) => row.extend(["", "", "", ""].map(str::to_owned)),
                Reading::Point(point_in_sensor) => {
                    row.extend(point_in_sensor.iter().map(|coordinate| style.number(*coordinate)));
                    row.push(String::new());
                }
                Reading::Profile(profile) => {
                    row.extend(["", "", ""].map(str::to_owned));
                    let place = Place { station_idx, capture_idx };
                    row.push(if profile.is_empty() { String::new() } else { profile_file_name(place) });
                }
            }
            row.push(notation_text.clone());
            if is_pose {
                row.extend(target_pose_cells(&capture.reading, style));
            }
            row
        })
    });
    style.csv(std::iter::once(head).chain(rows))
}

/// The columns of `sensor_from_target`.
const TARGET_POSE: [&str; 7] =
    ["target_x_mm", "target_y_mm", "target_z_mm", "target_qw", "target_qx", "target_qy", "target_qz"];

fn target_pose_cells(reading: &Reading, style: TableStyle) -> [String; 7] {
    let Reading::Pose(sensor_from_target) = reading else { return Default::default() };
    let [x, y, z]: [f64; 3] = sensor_from_target.translation_mm().into();
    let [qw, qx, qy, qz] = sensor_from_target.quaternion_wxyz();
    [x, y, z, qw, qx, qy, qz].map(|number| style.number(number))
}

/// A profile: x and z in millimetres, the cell of a missing z empty.
#[must_use]
pub fn profile_csv(profile: &Profile, style: TableStyle) -> String {
    let points = profile.x_mm().iter().zip(profile.z_mm()).map(|(x, z)| {
        let z = if z.is_nan() { String::new() } else { style.number(*z) };
        vec![style.number(*x), z]
    });
    style.csv(std::iter::once(vec!["x_mm".to_owned(), "z_mm".to_owned()]).chain(points))
}

/// Why nothing, or not everything, was exported.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum ExportError {
    /// Nothing is overwritten unasked.
    #[error("{file}: found a file of this name, expected a new one; choose another name or say to overwrite it")]
    Exists {
        /// The file.
        file: String,
    },
    /// The operating system did not let us write it.
    #[error("cannot write {file}: {problem}")]
    Unwritable {
        /// The file or folder.
        file: String,
        /// The operating system's words.
        problem: String,
    },
}

/// Writes a text to a file of its own.
///
/// # Errors
/// [`ExportError::Exists`] unless `overwrite`, [`ExportError::Unwritable`].
pub fn write_text(path: &Path, text: &str, overwrite: bool) -> Result<(), ExportError> {
    write_bytes(path, text.as_bytes(), overwrite)
}

/// Writes bytes to a file of their own.
///
/// # Errors
/// As for [`write_text`].
pub fn write_bytes(path: &Path, bytes: &[u8], overwrite: bool) -> Result<(), ExportError> {
    let file = || path.display().to_string();
    let mut options = fs::OpenOptions::new();
    options.write(true);
    if overwrite {
        options.create(true).truncate(true)
    } else {
        options.create_new(true)
    };
    let written = options.open(path).and_then(|mut opened| opened.write_all(bytes));
    written.map_err(|error| match error.kind() {
        io::ErrorKind::AlreadyExists => ExportError::Exists { file: file() },
        _ => ExportError::Unwritable { file: file(), problem: error.to_string() },
    })
}

/// Writes every profile with points into a folder, which is made if it is missing; gives their number.
///
/// # Errors
/// As for [`write_text`].
pub fn write_profiles(
    session: &Session,
    folder: &Path,
    style: TableStyle,
    overwrite: bool,
) -> Result<usize, ExportError> {
    fs::create_dir_all(folder)
        .map_err(|error| ExportError::Unwritable { file: folder.display().to_string(), problem: error.to_string() })?;
    let mut num_profiles = 0;
    for (station_idx, station) in session.stations.iter().enumerate() {
        for (capture_idx, capture) in station.captures.iter().enumerate() {
            if let Reading::Profile(profile) = &capture.reading
                && !profile.is_empty()
            {
                let name = profile_file_name(Place { station_idx, capture_idx });
                write_text(&folder.join(name), &profile_csv(profile, style), overwrite)?;
                num_profiles += 1;
            }
        }
    }
    Ok(num_profiles)
}
