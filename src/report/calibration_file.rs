//! A calibration from a file: a result file of ours, or a matrix in text.

use std::fs::File;
use std::io::Read as _;
use std::path::{Path, PathBuf};

use nalgebra::Matrix6;
use serde_json::Value;
use thiserror::Error;

use crate::calibrate::{Mount, Solution};
use crate::geometry::{Flange, Mat3, Sensor, Transform, Vec3};
use crate::text::verify::nearest_of;
use crate::verify::{GivenMatrix, MatrixCheck, MatrixRefusal, parse_matrix};

use super::document::InputFile;
use super::{result_file, verification_file};

/// No result file is larger.
const LIMIT_BYTES: u64 = 256 << 20;

/// Why a file holds no calibration.
#[derive(Debug, Error)]
pub enum CalibrationFileError {
    /// The operating system did not let us read it.
    #[error("cannot read {}: {problem}", file.display())]
    Unreadable {
        /// The file.
        file: PathBuf,
        /// The operating system's words.
        problem: std::io::Error,
    },
    /// Neither text nor JSON.
    #[error("{}: found {found}, expected a result file (`handeye solve --json`) or a matrix of 12 or 16 numbers", file.display())]
    Neither {
        /// The file.
        file: PathBuf,
        /// What it is.
        found: String,
    },
    /// A field that is not as the format has it.
    #[error("{}: {path}: found {found}, expected {expected}", file.display())]
    Invalid {
        /// The file.
        file: PathBuf,
        /// Where.
        path: String,
        /// What is there.
        found: String,
        /// What should be.
        expected: &'static str,
    },
    /// Numbers that are no matrix.
    #[error("{}: {refusal}", file.display())]
    NoMatrix {
        /// The file.
        file: PathBuf,
        /// Why.
        refusal: MatrixRefusal,
    },
    /// That of a sensor which is mounted otherwise.
    #[error(
        "{}: found the calibration of a sensor {found}, expected that of one {needed}, as in the session; give one of the same sensor",
        file.display()
    )]
    OtherMount {
        /// The file.
        file: PathBuf,
        /// Where the file's sensor is.
        found: &'static str,
        /// Where the session's is.
        needed: &'static str,
    },
    /// A matrix that has lost a dimension.
    #[error(
        "{}: found a matrix to which no rotation is nearest (its determinant is {determinant:.3}), expected perpendicular columns of \
         length 1; mend the misprint, or give the calibration as a result file",
        file.display()
    )]
    NoRotation {
        /// The file.
        file: PathBuf,
        /// The determinant.
        determinant: f64,
    },
}

/// A calibration and what it is called.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedCalibration {
    /// The file's name, and the method in it; or the method alone.
    pub name: String,
    /// The calibration; `base_from_sensor` for a sensor beside the robot.
    pub flange_from_sensor: Transform<Flange, Sensor>,
}

impl NamedCalibration {
    /// That of a solution, called after its method.
    #[must_use]
    pub fn of(solution: &Solution) -> Self {
        Self { name: solution.method.id().to_owned(), flange_from_sensor: solution.flange_from_sensor }
    }
}

/// A calibration from a file, and whether what stood there is one.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadCalibration {
    /// The file that was read.
    pub file: InputFile,
    /// The file's name, and the method in it.
    pub name: String,
    /// Where the sensor is mounted; a matrix does not say.
    pub mount: Option<Mount>,
    /// What was found when the matrix was looked at.
    pub check: MatrixCheck,
    /// It, or the nearest to a matrix that is no rotation.
    pub flange_from_sensor: Transform<Flange, Sensor>,
    /// What else a result file says of it.
    pub stated: StatedInFile,
}

/// What a result file says of a calibration beside itself; a matrix says nothing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StatedInFile {
    /// Covariance of (rotation about the sensor's axes in rad, translation along the flange's axes in mm).
    pub covariance: Option<Matrix6<f64>>,
    /// The point that its headline speaks of, mm.
    pub reference_point_in_sensor_mm: Option<Vec3>,
    /// Where the stations' targets were seen, mm.
    pub points_in_sensor_mm: Vec<Vec3>,
    /// `date` of the file, as it stands there.
    pub date: Option<String>,
}

impl ReadCalibration {
    /// With a name that says so where it is not what stood in the file.
    #[must_use]
    pub fn named(self) -> NamedCalibration {
        let name = if self.check.is_rotation() { self.name } else { nearest_of(&self.name) };
        NamedCalibration { name, flange_from_sensor: self.flange_from_sensor }
    }
}

/// Reads a calibration for data of a sensor that is mounted so. A matrix does not say where its sensor is, and is taken at
/// the session's word.
///
/// # Errors
/// [`CalibrationFileError`], also of a sensor that is mounted otherwise.
pub fn read_calibration_for(path: &Path, mount: Mount) -> Result<ReadCalibration, CalibrationFileError> {
    let place = |mount: Mount| match mount {
        Mount::OnFlange => "on the flange (`flange_from_sensor`)",
        Mount::Fixed => "beside the robot (`base_from_sensor`)",
    };
    let read = read_calibration(path)?;
    match read.mount.filter(|found| *found != mount) {
        None => Ok(read),
        Some(found) => {
            Err(CalibrationFileError::OtherMount { file: path.to_owned(), found: place(found), needed: place(mount) })
        }
    }
}

/// Reads a calibration. Of a result file the answer is taken, or the first method that has a result; of a verification file the
/// calibration from all targets, or the first; of a matrix that is no rotation the nearest.
///
/// # Errors
/// [`CalibrationFileError`].
pub fn read_calibration(path: &Path) -> Result<ReadCalibration, CalibrationFileError> {
    let bytes = read_bytes(path)?;
    let Written { name, mount, matrix, stated } = matrix_in(&bytes, path)?;
    let check = matrix.check();
    match matrix.nearest() {
        Some(flange_from_sensor) => {
            let file = InputFile::new(file_name(path), &bytes);
            Ok(ReadCalibration { file, name, mount, check, flange_from_sensor, stated })
        }
        None => Err(CalibrationFileError::NoRotation { file: path.to_owned(), determinant: check.determinant }),
    }
}

/// What stands in a file.
struct Written {
    name: String,
    mount: Option<Mount>,
    matrix: GivenMatrix,
    stated: StatedInFile,
}

fn read_bytes(path: &Path) -> Result<Vec<u8>, CalibrationFileError> {
    let unreadable = |problem| CalibrationFileError::Unreadable { file: path.to_owned(), problem };
    let mut bytes = Vec::new();
    File::open(path).map_err(unreadable)?.take(LIMIT_BYTES).read_to_end(&mut bytes).map_err(unreadable)?;
    Ok(bytes)
}

/// Without its folder, which is another on every machine.
fn file_name(path: &Path) -> String {
    path.file_name().map_or_else(|| path.display().to_string(), |name| name.to_string_lossy().into_owned())
}

fn matrix_in(bytes: &[u8], path: &Path) -> Result<Written, CalibrationFileError> {
    let file_name = file_name(path);
    let neither = |found: &str| CalibrationFileError::Neither { file: path.to_owned(), found: found.to_owned() };
    let text = std::str::from_utf8(bytes).map_err(|_| neither("bytes that are no text"))?;
    if text.trim().is_empty() {
        return Err(neither("nothing"));
    }
    if text.trim_start().starts_with('{') {
        let value: Value = serde_json::from_str(text).map_err(|error| neither(&format!("broken JSON ({error})")))?;
        let written = from_result(path, &value)?;
        return Ok(Written { name: format!("{file_name}: {}", written.name), ..written });
    }
    let matrix =
        parse_matrix(text).map_err(|refusal| CalibrationFileError::NoMatrix { file: path.to_owned(), refusal })?;
    Ok(Written { name: file_name, mount: None, matrix, stated: StatedInFile::default() })
}

fn from_result(path: &Path, value: &Value) -> Result<Written, CalibrationFileError> {
    let invalid = |at: &str, found: &Value, expected| CalibrationFileError::Invalid {
        file: path.to_owned(),
        path: at.to_owned(),
        found: short(found),
        expected,
    };
    let (list, entry, name) = match value["format"].as_str() {
        Some(result_file::FORMAT) => ("methods", answer_of(value), "method"),
        Some(verification_file::FORMAT) => ("calibrations", best_of(value), "name"),
        _ => {
            let expected = "\"handeye-result\" or \"handeye-verification\", as `handeye solve --json` and `handeye verify --json` write them";
            return Err(invalid("format", &value["format"], expected));
        }
    };
    let Some(entry) = entry else {
        return Err(invalid(list, &value[list], "at least one method with a result"));
    };
    let of_mount = |(name, mount)| entry.get(name).map(|calibration| (calibration, mount));
    let found =
        [("flange_from_sensor", Mount::OnFlange), ("base_from_sensor", Mount::Fixed)].into_iter().find_map(of_mount);
    let Some((mount, matrix)) =
        found.and_then(|(calibration, mount)| Some((mount, matrix_of(&calibration["matrix"])?)))
    else {
        let found = found.map_or(&Value::Null, |(calibration, _)| calibration);
        return Err(invalid(&format!("{list}[].flange_from_sensor"), found, "an object with a 4 × 4 matrix"));
    };
    let uncertainty = &entry["uncertainty"];
    let covariance = match &uncertainty["covariance"] {
        Value::Null => None,
        found => {
            let expected = "6 × 6 finite numbers with no negative variance";
            let at = format!("{list}[].uncertainty.covariance");
            Some(covariance_of(found).ok_or_else(|| invalid(&at, found, expected))?)
        }
    };
    let points = entry["stations"].as_array().map(Vec::as_slice).unwrap_or_default();
    let stated = StatedInFile {
        covariance,
        reference_point_in_sensor_mm: vector_of(&uncertainty["reference_point_in_sensor_mm"]),
        points_in_sensor_mm: points.iter().filter_map(|station| vector_of(&station["target_in_sensor_mm"])).collect(),
        date: value["date"].as_str().map(str::to_owned),
    };
    Ok(Written { name: entry[name].as_str().unwrap_or("?").to_owned(), mount: Some(mount), matrix, stated })
}

fn vector_of(value: &Value) -> Option<Vec3> {
    let numbers: Vec<f64> = value.as_array()?.iter().map(Value::as_f64).collect::<Option<_>>()?;
    (numbers.len() == 3).then(|| Vec3::from_column_slice(&numbers))
}

fn covariance_of(value: &Value) -> Option<Matrix6<f64>> {
    let rows = value.as_array().filter(|rows| rows.len() == 6)?;
    let mut numbers = Vec::with_capacity(36);
    for row in rows {
        let row = row.as_array().filter(|row| row.len() == 6)?;
        numbers.extend(row.iter().map(Value::as_f64).collect::<Option<Vec<f64>>>()?);
    }
    let covariance = Matrix6::from_row_slice(&numbers);
    let is_usable = numbers.iter().all(|v| v.is_finite()) && covariance.diagonal().iter().all(|v| *v >= 0.0);
    is_usable.then_some((covariance + covariance.transpose()) / 2.0)
}

fn list<'a>(value: &'a Value, name: &str) -> &'a [Value] {
    value[name].as_array().map(Vec::as_slice).unwrap_or_default()
}

/// The answer of a result file, or the first method that has a result.
fn answer_of(file: &Value) -> Option<&Value> {
    let is_ok = |entry: &&Value| entry["status"] == "ok";
    let answer = list(file, "methods").iter().filter(is_ok).find(|entry| entry["method"] == file["answer"]);
    answer.or_else(|| list(file, "methods").iter().find(is_ok))
}

/// The calibration from all targets of a verification file; without it the last of its first target, which is the one to use.
fn best_of(file: &Value) -> Option<&Value> {
    let calibrations = list(file, "calibrations");
    let joint = calibrations.iter().find(|calibration| calibration["origin"]["kind"] == "joint");
    let first = &calibrations.first()?["origin"]["target"];
    joint.or_else(|| calibrations.iter().rfind(|calibration| calibration["origin"]["target"] == *first))
}

fn matrix_of(value: &Value) -> Option<GivenMatrix> {
    let rows: Vec<Vec<f64>> = value
        .as_array()?
        .iter()
        .map(|row| row.as_array()?.iter().map(Value::as_f64).collect())
        .collect::<Option<_>>()?;
    (rows.len() >= 3 && rows.iter().all(|row| row.len() == 4)).then(|| GivenMatrix {
        rotation: Mat3::from_fn(|row, column| rows[row][column]),
        translation_mm: Vec3::from_fn(|row, _| rows[row][3]),
        decimals: 9,
    })
}

fn short(value: &Value) -> String {
    const MOST: usize = 40;
    let text = value.to_string();
    if value.is_null() { "nothing".to_owned() } else { text.chars().take(MOST).collect() }
}
