//! What the comparison draws, made without egui from the session and the results.

use nalgebra::Matrix4;

use crate::app::compare::{self, Difference, Improvement, PublishedRow, ScatterEllipse, TruthDistance};
use crate::calibrate::{Method, MethodResult, Mount, Solution, StationSolution, solution_of};
use crate::geometry::Vec3;
use crate::session::Session;

/// The methods from left to right: the paper's two first, then the answer to use; the published stop by choice.
pub const COLUMN_ORDER: [Method; 4] =
    [Method::BallFixedPoint, Method::BallMaxArc, Method::BallBundle, Method::BallMaxArcStep];

/// What errors are relative to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ErrorReference {
    /// The first station used, as in the paper.
    #[default]
    FirstStation,
    /// The mean of the stations used.
    Mean,
}

/// What a method says about a station.
#[expect(clippy::struct_field_names, reason = "every name carries its unit")]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UsedStation {
    /// Ball in the sensor frame of the first capture, mm.
    pub target_in_sensor_mm: Vec3,
    /// Ball in the base, mm.
    pub target_in_base_mm: Vec3,
    /// Relative to the first station, mm.
    pub error_from_first_mm: Vec3,
    /// Relative to the mean, mm.
    pub error_from_mean_mm: Vec3,
    /// Left-out error, mm.
    pub leave_one_out_mm: Option<f64>,
}

impl UsedStation {
    /// The error relative to `reference`, mm.
    #[must_use]
    pub const fn error_mm(&self, reference: ErrorReference) -> Vec3 {
        match reference {
            ErrorReference::FirstStation => self.error_from_first_mm,
            ErrorReference::Mean => self.error_from_mean_mm,
        }
    }
}

impl From<&StationSolution> for UsedStation {
    fn from(station: &StationSolution) -> Self {
        Self {
            target_in_sensor_mm: station.target_in_sensor_mm,
            target_in_base_mm: station.target_in_base_mm,
            error_from_first_mm: station.error_from_first_mm,
            error_from_mean_mm: station.error_from_mean_mm,
            leave_one_out_mm: station.leave_one_out_mm,
        }
    }
}

/// A station's row in a method's table.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// The user's name for it.
    pub label: String,
    /// Whether it takes part now.
    pub is_enabled: bool,
    /// The first capture's flange position, mm.
    pub translation_mm: Vec3,
    /// The first capture's orientation, w first.
    pub quaternion_wxyz: [f64; 4],
    /// What the method says about it; `None` if it did not use it.
    pub used: Option<UsedStation>,
}

/// A method's table; the row's place is the station's index.
#[derive(Clone, Debug, PartialEq)]
pub struct MethodTable {
    /// One row a station of the session.
    pub rows: Vec<Row>,
    /// RMS of the left-out errors, mm.
    pub leave_one_out_rms_mm: Option<f64>,
    /// Standard deviation of a workspace point, mm.
    pub workspace_std_mm: Option<f64>,
    /// Distance from the truth of a simulated session.
    pub truth: Option<TruthDistance>,
    /// The calibration as a homogeneous matrix.
    pub matrix: Matrix4<f64>,
    /// Where the sensor is.
    pub mount: Mount,
}

impl MethodTable {
    /// Largest coordinate of the errors shown, mm.
    #[must_use]
    pub fn max_error_mm(&self, reference: ErrorReference) -> f64 {
        self.used().map(|(_, used)| used.error_mm(reference).amax()).fold(0.0, f64::max)
    }

    /// The stations used, with their rows' places.
    pub fn used(&self) -> impl Iterator<Item = (usize, &UsedStation)> {
        self.rows.iter().enumerate().filter_map(|(row_idx, row)| row.used.as_ref().map(|used| (row_idx, used)))
    }

    /// The 1σ ellipse of the ball centres about their mean, in base coordinates `axes`.
    #[must_use]
    pub fn ellipse(&self, axes: [usize; 2]) -> Option<ScatterEllipse> {
        let points: Vec<[f64; 2]> =
            self.used().map(|(_, used)| axes.map(|axis| used.error_from_mean_mm[axis])).collect();
        compare::scatter_ellipse(&points)
    }
}

/// A method's column.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// The method.
    pub method: Method,
    /// Its table, or why there is none.
    pub outcome: Result<MethodTable, String>,
}

/// A row of the difference table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DifferenceRow {
    /// The first method.
    pub first: Method,
    /// The second method.
    pub second: Method,
    /// Second minus first.
    pub difference: Difference,
}

/// What a paper printed.
#[derive(Clone, Debug, PartialEq)]
pub struct PublishedTable {
    /// Title and source.
    pub caption: String,
    /// Names of the stations, as far as the session has them.
    pub labels: Vec<String>,
    /// The rows.
    pub rows: Vec<PublishedRow>,
}

impl PublishedTable {
    /// Number of misprinted coordinates.
    #[must_use]
    pub fn num_misprints(&self) -> usize {
        self.rows.iter().flat_map(|row| row.is_misprint).filter(|is_misprint| *is_misprint).count()
    }
}

/// All that the panel draws.
#[derive(Clone, Debug, PartialEq)]
pub struct CompareModel {
    /// One column a method, in [`COLUMN_ORDER`].
    pub columns: Vec<Column>,
    /// The paper's comparison.
    pub improvement: Option<Improvement>,
    /// Differences of the methods with results.
    pub differences: Vec<DifferenceRow>,
    /// What a paper printed.
    pub published: Option<PublishedTable>,
}

impl CompareModel {
    /// From a session and what the methods made of it.
    #[must_use]
    pub fn new(session: &Session, results: &[MethodResult]) -> Self {
        let columns = COLUMN_ORDER
            .into_iter()
            .filter_map(|method| results.iter().find(|result| result.method == method))
            .map(|result| Column {
                method: result.method,
                outcome: match &result.outcome {
                    Ok(solution) => Ok(method_table(session, solution)),
                    Err(error) => Err(error.to_string()),
                },
            })
            .collect();
        Self {
            columns,
            improvement: compare::improvement(results),
            differences: differences(results),
            published: session.published.as_ref().filter(|published| !published.target_in_base_mm.is_empty()).map(
                |published| PublishedTable {
                    caption: published.caption.clone(),
                    labels: session.stations.iter().map(|station| station.label.clone()).collect(),
                    rows: compare::published_rows(published),
                },
            ),
        }
    }
}

fn method_table(session: &Session, solution: &Solution) -> MethodTable {
    let rows = session
        .stations
        .iter()
        .enumerate()
        .map(|(station_idx, station)| {
            let pose = station.captures.first().map(|capture| &capture.base_from_flange);
            Row {
                label: station.label.clone(),
                is_enabled: station.enabled,
                translation_mm: pose.map_or_else(Vec3::zeros, crate::geometry::Transform::translation_mm),
                quaternion_wxyz: pose.map_or([1.0, 0.0, 0.0, 0.0], crate::geometry::Transform::quaternion_wxyz),
                used: solution.stations.iter().find(|used| used.station_idx == station_idx).map(UsedStation::from),
            }
        })
        .collect();
    MethodTable {
        rows,
        leave_one_out_rms_mm: solution.leave_one_out.map(|left_out| left_out.rms_mm),
        workspace_std_mm: solution.uncertainty.as_ref().map(|uncertainty| uncertainty.workspace_point_std_mm),
        truth: session.truth.as_ref().map(|truth| compare::distance_from_truth(solution, truth)),
        matrix: solution.flange_from_sensor.matrix(),
        mount: solution.mount,
    }
}

/// Pairs worth a row: from each step of the paper's story to the next.
fn differences(results: &[MethodResult]) -> Vec<DifferenceRow> {
    let with_result = |methods: &[Method]| -> Vec<Method> {
        methods.iter().copied().filter(|method| solution_of(results, *method).is_some()).collect()
    };
    let mut pairs: Vec<(Method, Method)> =
        with_result(&COLUMN_ORDER[..3]).windows(2).map(|pair| (pair[0], pair[1])).collect();
    if let [stop, curve] = with_result(&[Method::BallMaxArcStep, Method::BallMaxArc])[..] {
        pairs.push((stop, curve));
    }
    pairs
        .into_iter()
        .filter_map(|(first, second)| {
            Some(DifferenceRow {
                first,
                second,
                difference: compare::difference(solution_of(results, first)?, solution_of(results, second)?),
            })
        })
        .collect()
}

#[cfg(test)]
#[path = "model_tests.rs"]
mod tests;
