//! Calibrations to be compared: from result files, matrices and sessions, one by one or a whole folder in the order of time.

mod dates;
pub mod file;

use std::fs;
use std::path::{Path, PathBuf};

use crate::calibrate::Mount;
use crate::geometry::Vec3;
use crate::session;
use crate::sheet::natural_key;
use crate::text::compare_results as words;
use crate::verify::difference::{PointShift, Stated, point_shift};
use crate::verify::drift::{Drift, Epoch, drift};
use crate::watch::Watch;

use self::dates::{date_text, days_in};
use super::best_solution;
use super::calibration_file::{StatedInFile, read_calibration};

/// Files of a folder that are looked at.
const MAX_FILES: usize = 2_000;
/// No sensor is mounted further from its flange.
const MAX_TRANSLATION_MM: f64 = 1e6;

/// A calibration with what is known of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Compared {
    /// The file's name, and the method in it.
    pub name: String,
    /// When it was made: days since 1970, by the file's `date`, else by a date in its name.
    pub days: Option<f64>,
    /// Where the sensor is mounted.
    pub mount: Mount,
    /// The calibration, and how sure it says it is.
    pub stated: Stated,
    /// Whether it is the nearest to a matrix that is no rotation.
    pub is_nearest: bool,
    /// The point that its headline speaks of, mm.
    pub reference_point_in_sensor_mm: Option<Vec3>,
    /// Where the target was seen while measuring, mm.
    pub points_in_sensor_mm: Vec<Vec3>,
}

impl Compared {
    /// Its date as people write it.
    #[must_use]
    pub fn date(&self) -> Option<String> {
        self.days.map(date_text)
    }
}

/// Why a file gives no calibration.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum NotCompared {
    /// The file is wrong.
    Wrong(String),
    /// Nothing could be computed of its session.
    NothingComputed(String),
}

impl NotCompared {
    /// The sentence.
    #[must_use]
    pub fn reason(&self) -> &str {
        match self {
            Self::Wrong(reason) | Self::NothingComputed(reason) => reason,
        }
    }
}

/// Reads a calibration from a result file, a verification file or a matrix, or computes that of a session: the answer.
///
/// # Errors
/// [`NotCompared`].
pub fn read_compared(path: &Path, watch: &mut dyn Watch) -> Result<Compared, NotCompared> {
    let file_name = path.file_name().map_or_else(|| path.display().to_string(), |name| name.to_string_lossy().into());
    let not_a_calibration = match read_calibration(path) {
        Ok(read) => {
            let StatedInFile { covariance, reference_point_in_sensor_mm, points_in_sensor_mm, date } = read.stated;
            let days = date.as_deref().and_then(days_in).or_else(|| days_in(&file_name));
            let compared = Compared {
                name: read.name,
                days,
                mount: read.mount.unwrap_or(Mount::OnFlange),
                stated: Stated { flange_from_sensor: read.flange_from_sensor, covariance },
                is_nearest: !read.check.is_rotation(),
                reference_point_in_sensor_mm,
                points_in_sensor_mm,
            };
            return checked(path, compared);
        }
        Err(error) => error,
    };
    let session = session::load(path).map_err(|error| {
        // Of what is no session either, what was wrong with the calibration says more.
        let is_session = fs::read_to_string(path).is_ok_and(|text| text.contains("\"handeye-session\""));
        NotCompared::Wrong(if is_session { error.to_string() } else { not_a_calibration.to_string() })
    })?;
    let computed = |reason: String| NotCompared::NothingComputed(format!("{file_name}: {reason}"));
    let best =
        best_solution(&session, watch).map_err(|cancelled| computed(cancelled.to_string()))?.map_err(computed)?;
    let date = session.unknown.get("date").and_then(serde_json::Value::as_str);
    let compared = Compared {
        name: format!("{file_name}: {}", best.method.id()),
        days: date.and_then(days_in).or_else(|| days_in(&file_name)),
        mount: session.mount,
        stated: Stated {
            flange_from_sensor: best.flange_from_sensor,
            covariance: best.uncertainty.as_ref().map(|known| known.covariance),
        },
        is_nearest: false,
        reference_point_in_sensor_mm: best.uncertainty.as_ref().map(|known| known.reference_point_in_sensor_mm),
        points_in_sensor_mm: best.stations.iter().map(|station| station.target_in_sensor_mm).collect(),
    };
    checked(path, compared)
}

/// Refuses numbers that are no place of a sensor.
fn checked(path: &Path, compared: Compared) -> Result<Compared, NotCompared> {
    let translation_mm = compared.stated.flange_from_sensor.translation_mm();
    let is_place = translation_mm.iter().all(|value| value.abs() <= MAX_TRANSLATION_MM);
    if is_place { Ok(compared) } else { Err(NotCompared::Wrong(words::no_place(&path.display().to_string()))) }
}

/// What two calibrations make of points that the sensor sees.
#[derive(Clone, Debug, PartialEq)]
pub struct ComparedPoints {
    /// At the point of the headline, if one of them has one.
    pub reference: Option<PointShift>,
    /// At the points that were asked for.
    pub given: Vec<PointShift>,
    /// At the points at which either was measured.
    pub measured: Vec<PointShift>,
}

/// Compares two calibrations at points.
#[must_use]
pub fn compared_points(from: &Compared, to: &Compared, given: &[Vec3]) -> ComparedPoints {
    let at = |point: Vec3| point_shift(&from.stated, &to.stated, point);
    let reference = from.reference_point_in_sensor_mm.or(to.reference_point_in_sensor_mm);
    ComparedPoints {
        reference: reference.map(at),
        given: given.iter().copied().map(at).collect(),
        measured: from.points_in_sensor_mm.iter().chain(&to.points_in_sensor_mm).copied().map(at).collect(),
    }
}

/// By what a history is in its order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// By the dates of all.
    Dates,
    /// By the names of the files, numbers in their order, as not all have a date.
    Names,
}

/// The calibrations of a folder.
#[derive(Clone, Debug)]
pub struct History {
    /// In the order of time.
    pub calibrations: Vec<Compared>,
    /// How that is known.
    pub order: Order,
    /// The point at which they are compared, mm: that of the first which names one.
    pub reference_point_in_sensor_mm: Vec3,
    /// What became of them.
    pub drift: Drift,
    /// Files that were left out, and why.
    pub left_out: Vec<String>,
}

/// Reads all calibrations of a folder: files that end in `json` or `txt`, folders in it not. Files that hold none are listed.
///
/// # Errors
/// Why the folder cannot be read, or that there is no calibration in it.
pub fn read_history(folder: &Path, watch: &mut dyn Watch) -> Result<History, NotCompared> {
    let unreadable = |problem: std::io::Error| {
        NotCompared::Wrong(words::unreadable_folder(&folder.display().to_string(), &problem.to_string()))
    };
    let mut paths: Vec<PathBuf> = Vec::new();
    for entry in fs::read_dir(folder).map_err(unreadable)? {
        let path = entry.map_err(unreadable)?.path();
        let is_ours = path.extension().is_some_and(|ending| ending == "json" || ending == "txt") && path.is_file();
        if is_ours {
            paths.push(path);
        }
    }
    if paths.len() > MAX_FILES {
        let found = paths.len();
        return Err(NotCompared::Wrong(words::too_many_files(&folder.display().to_string(), found, MAX_FILES)));
    }
    paths.sort_by_cached_key(|path| natural_key(&path.to_string_lossy()));
    let mut calibrations: Vec<Compared> = Vec::new();
    let mut left_out = Vec::new();
    for (idx, path) in paths.iter().enumerate() {
        watch.report(idx, paths.len()).map_err(|cancelled| NotCompared::NothingComputed(cancelled.to_string()))?;
        match read_compared(path, watch) {
            Ok(compared) if calibrations.first().is_some_and(|first| first.mount != compared.mount) => {
                left_out.push(words::other_mount(&compared.name));
            }
            Ok(compared) => calibrations.push(compared),
            Err(refusal) => left_out.push(refusal.reason().to_owned()),
        }
    }
    if calibrations.is_empty() {
        return Err(NotCompared::Wrong(words::no_calibrations(&folder.display().to_string(), left_out.first())));
    }
    Ok(history(calibrations, left_out))
}

/// Brings calibrations, which are in the order of their names, into that of their dates if all have one, and looks at them.
#[must_use]
pub fn history(mut calibrations: Vec<Compared>, left_out: Vec<String>) -> History {
    let has_dates = calibrations.iter().all(|calibration| calibration.days.is_some());
    let order = if has_dates { Order::Dates } else { Order::Names };
    if has_dates {
        calibrations.sort_by(|a, b| a.days.unwrap_or_default().total_cmp(&b.days.unwrap_or_default()));
    }
    let reference = calibrations.iter().find_map(|calibration| calibration.reference_point_in_sensor_mm);
    let reference_point_in_sensor_mm = reference.unwrap_or_default();
    let first = calibrations.first().and_then(|first| first.days).unwrap_or_default();
    let epochs: Vec<Epoch> = calibrations
        .iter()
        .zip(0_u32..)
        .map(|(calibration, number)| Epoch {
            at: calibration.days.filter(|_| has_dates).map_or(f64::from(number), |days| days - first),
            calibration: calibration.stated.clone(),
        })
        .collect();
    let drift = drift(&epochs, reference_point_in_sensor_mm);
    History { calibrations, order, reference_point_in_sensor_mm, drift, left_out }
}
