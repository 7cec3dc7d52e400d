//! Calibrations to be compared: from result files, matrices and sessions, one by one or a whole folder in the order of time.

mod dates;
pub mod file;
pub mod said;
pub mod series;

use std::fs;
use std::path::{Path, PathBuf};

use crate::calibrate::Mount;
use crate::geometry::Vec3;
use crate::session::{self, Measured, Session, measure_in};
use crate::sheet::natural_key;
use crate::text::compare_results as words;
use crate::verify::difference::{Difference, Known, PointShift, Stated, difference, point_shift};
use crate::verify::drift::{Drift, Epoch, Trend, drift};
use crate::watch::{Cancelled, Watch};

use self::dates::{date_text, days_in};
use super::best_solution;
use super::calibration_file::{StatedInFile, read_calibration};
use super::checksum::sha256;

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
    /// The SHA-256 of its file, if it is from one.
    pub checksum: Option<String>,
}

/// What two calibrations have in common, so that their difference is no evidence.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shared {
    /// Nothing, as far as can be told.
    Nothing,
    /// They stand in one file, or in copies of it.
    File,
    /// They were computed from the same measurements.
    Data,
}

impl Shared {
    /// By the checksums of both, and by the points that they were computed from.
    #[must_use]
    pub fn between(first: &Compared, second: &Compared) -> Self {
        /// Fewer places that are equal to the last bit but a few can be chance, or typed.
        const LEAST_POINTS: usize = 3;
        /// Far less than any sensor's noise; a file may hold fewer digits than a computation.
        const SAME_MM: f64 = 1e-6;
        if first.checksum.is_some() && first.checksum == second.checksum {
            return Self::File;
        }
        let (a, b) = (&first.points_in_sensor_mm, &second.points_in_sensor_mm);
        let is_same =
            a.len() >= LEAST_POINTS && a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).amax() <= SAME_MM);
        if is_same { Self::Data } else { Self::Nothing }
    }
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
                checksum: checksum(path),
            };
            return checked(compared, &path.display().to_string());
        }
        Err(error) => error,
    };
    let session = session::load(path).map_err(|error| {
        // Of what is no session either, what was wrong with the calibration says more.
        let is_session = fs::read_to_string(path).is_ok_and(|text| text.contains("\"handeye-session\""));
        NotCompared::Wrong(if is_session { error.to_string() } else { not_a_calibration.to_string() })
    })?;
    let measured = measure_in(path.parent().unwrap_or(Path::new("")), &session, watch)
        .map_err(|cancelled| NotCompared::NothingComputed(format!("{file_name}: {cancelled}")))?;
    let compared = compared_session(&session, &measured, &file_name, watch)?;
    Ok(Compared { checksum: checksum(path), ..compared })
}

/// The checksum of a file that was read a moment ago.
fn checksum(path: &Path) -> Option<String> {
    fs::read(path).ok().map(|bytes| sha256(&bytes))
}

/// Computes the calibration of a session: the answer.
///
/// # Errors
/// [`NotCompared`].
pub fn compared_session(
    session: &Session,
    measured: &Measured,
    name: &str,
    watch: &mut dyn Watch,
) -> Result<Compared, NotCompared> {
    let computed = |reason: String| NotCompared::NothingComputed(format!("{name}: {reason}"));
    let best = best_solution(session, measured, watch)
        .map_err(|cancelled| computed(cancelled.to_string()))?
        .map_err(computed)?;
    let date = session.unknown.get("date").and_then(serde_json::Value::as_str);
    let compared = Compared {
        name: format!("{name}: {}", best.method.id()),
        days: date.and_then(days_in).or_else(|| days_in(name)),
        mount: session.mount,
        stated: Stated {
            flange_from_sensor: best.flange_from_sensor,
            covariance: best.uncertainty.as_ref().map(|known| known.covariance),
        },
        is_nearest: false,
        reference_point_in_sensor_mm: best.uncertainty.as_ref().map(|known| known.reference_point_in_sensor_mm),
        points_in_sensor_mm: best.stations.iter().map(|station| station.target_in_sensor_mm).collect(),
        checksum: None,
    };
    checked(compared, name)
}

/// Refuses numbers that are no place of a sensor.
fn checked(compared: Compared, name: &str) -> Result<Compared, NotCompared> {
    let translation_mm = compared.stated.flange_from_sensor.translation_mm();
    let is_place = translation_mm.iter().all(|value| value.abs() <= MAX_TRANSLATION_MM);
    if is_place { Ok(compared) } else { Err(NotCompared::Wrong(words::no_place(name))) }
}

/// A point of the sensor frame as a person types it: three numbers in mm with commas between them.
#[must_use]
pub fn point_in(text: &str) -> Option<Vec3> {
    let number =
        |text: &str| text.trim().replace('\u{2212}', "-").parse::<f64>().ok().filter(|number| number.is_finite());
    let numbers: Vec<f64> = text.split(',').map(number).collect::<Option<_>>()?;
    (numbers.len() == 3).then(|| Vec3::from_column_slice(&numbers))
}

/// Two calibrations held against each other.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// The one that is compared with.
    pub from: Compared,
    /// The one that is compared.
    pub to: Compared,
    /// What they have in common.
    pub shared: Shared,
    /// The second less the first.
    pub difference: Difference,
    /// At points.
    pub points: ComparedPoints,
}

/// Compares two calibrations, at the points given too.
///
/// # Errors
/// [`NotCompared`] of sensors that are mounted otherwise.
pub fn compared(from: Compared, to: Compared, given: &[Vec3]) -> Result<Comparison, NotCompared> {
    if from.mount != to.mount {
        return Err(NotCompared::Wrong(words::mounts_differ(&from.name, &to.name)));
    }
    let shared = Shared::between(&from, &to);
    let mut stated = [from.stated.clone(), to.stated.clone()];
    if shared != Shared::Nothing {
        // Added as if they were independent, the covariances would call anything chance.
        stated = stated.map(|stated| Stated { covariance: None, ..stated });
    }
    let [first, second] = &stated;
    let mut difference = difference(first, second);
    if shared != Shared::Nothing {
        difference.known = Known::SameData;
    }
    let at = |point: Vec3| point_shift(first, second, point);
    let reference = from.reference_point_in_sensor_mm.or(to.reference_point_in_sensor_mm);
    let points = ComparedPoints {
        reference: reference.map(at),
        given: given.iter().copied().map(at).collect(),
        measured: from.points_in_sensor_mm.iter().chain(&to.points_in_sensor_mm).copied().map(at).collect(),
    };
    Ok(Comparison { from, to, shared, difference, points })
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

impl ComparedPoints {
    /// The mean and the largest way of the points at which either was measured, mm.
    #[must_use]
    pub fn measured_mm(&self) -> Option<(f64, f64)> {
        let sizes = || self.measured.iter().map(|shift| shift.shift_mm.norm());
        #[expect(clippy::cast_precision_loss, reason = "stations of two sessions")]
        let count = self.measured.len() as f64;
        (!self.measured.is_empty()).then(|| (sizes().sum::<f64>() / count, sizes().fold(0.0, f64::max)))
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
    /// Days from the first to each, or their numbers from 0 where the order is that of the names.
    pub times: Vec<f64>,
    /// The point at which they are compared, mm: that of the first which names one.
    pub reference_point_in_sensor_mm: Vec3,
    /// What became of them.
    pub drift: Drift,
    /// Files that were left out, and why.
    pub left_out: Vec<String>,
}

/// What a history comes to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Course {
    /// Neither a drift nor a jump.
    Steady,
    /// A drift or a jump.
    Moved,
    /// Too few calibrations to tell.
    Unknown,
}

impl History {
    /// What it comes to.
    #[must_use]
    pub fn course(&self) -> Course {
        let Drift { jumps, point_trends, trends, .. } = &self.drift;
        let mut verdicts = point_trends.iter().chain(trends).map(|trend| trend.is_significant);
        if !jumps.is_empty() || verdicts.clone().any(|verdict| verdict == Some(true)) {
            return Course::Moved;
        }
        let is_known = !trends.is_empty() && verdicts.all(|verdict| verdict.is_some());
        if is_known { Course::Steady } else { Course::Unknown }
    }

    /// The trends of the point, then those of the six axes, in the units of [`words::TREND_AXES`].
    pub fn shown_trends(&self) -> impl Iterator<Item = Trend> {
        let in_degrees = |(axis, trend): (usize, &Trend)| {
            let in_unit = |value: f64| if axis < 3 { value } else { value.to_degrees() };
            Trend { slope: in_unit(trend.slope), std: in_unit(trend.std), at_first: in_unit(trend.at_first), ..*trend }
        };
        self.drift.point_trends.iter().copied().chain(self.drift.trends.iter().enumerate().map(in_degrees))
    }
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
        match read_compared(path, &mut WithinFile { watch: &mut *watch, done: idx, total: paths.len() }) {
            Ok(compared) if calibrations.first().is_some_and(|first| first.mount != compared.mount) => {
                left_out.push(words::other_mount(&compared.name));
            }
            // Counted twice, a measurement would make the scatter smaller than it is.
            Ok(compared) => {
                match calibrations.iter().find(|known| Shared::between(known, &compared) != Shared::Nothing) {
                    Some(known) => left_out.push(words::same_data(&compared.name, &known.name)),
                    None => calibrations.push(compared),
                }
            }
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
    let times: Vec<f64> = calibrations
        .iter()
        .zip(0_u32..)
        .map(|(calibration, number)| {
            calibration.days.filter(|_| has_dates).map_or(f64::from(number), |days| days - first)
        })
        .collect();
    let stated = calibrations.iter().map(|calibration| calibration.stated.clone());
    let epochs: Vec<Epoch> = times.iter().zip(stated).map(|(at, calibration)| Epoch { at: *at, calibration }).collect();
    let drift = drift(&epochs, reference_point_in_sensor_mm);
    History { calibrations, order, times, reference_point_in_sensor_mm, drift, left_out }
}

/// Goes on counting files while one of them is computed, which would count its own parts.
struct WithinFile<'w> {
    watch: &'w mut dyn Watch,
    done: usize,
    total: usize,
}

impl Watch for WithinFile<'_> {
    fn report(&mut self, _done: usize, _total: usize) -> Result<(), Cancelled> {
        self.watch.report(self.done, self.total)
    }
}
