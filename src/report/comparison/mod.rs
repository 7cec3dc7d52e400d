//! The methods side by side: what the window and a report show of a session and its results.

use nalgebra::Matrix4;

use crate::calibrate::{
    Edge, Method, MethodResult, Mount, PlateFound, PlatePoint, Solution, StationSolution, solution_of,
};
use crate::geometry::Vec3;
use crate::report::compare::{self, Difference, Improvement, PublishedRow, ScatterEllipse, TruthDistance};
use crate::session::{Capture, Session, Station, Target};
use crate::text::edges::edge_name;

/// The methods from left to right: the paper's first, then the answer to use; the published stop by choice.
pub const COLUMN_ORDER: [Method; 8] = [
    Method::BallFixedPoint,
    Method::BallMaxArc,
    Method::BallBundle,
    Method::BallMaxArcStep,
    Method::PlateOrthogonal,
    Method::PlateBundle,
    Method::FixedPoint,
    Method::Motion,
];

/// What errors are relative to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ErrorReference {
    /// The first station used, as in the paper.
    #[default]
    FirstStation,
    /// The mean of the stations used.
    Mean,
}

/// What a method says about a station, or about a point on a plate's edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UsedStation {
    /// Ball, tip or edge point in the sensor frame of the capture, mm.
    pub target_in_sensor_mm: Vec3,
    /// The same in the base, mm.
    pub target_in_base_mm: Vec3,
    /// Relative to the first station, mm; from its edge, for a point of a plate.
    pub error_from_first_mm: Vec3,
    /// Relative to the mean, mm; from its edge, for a point of a plate.
    pub error_from_mean_mm: Vec3,
    /// Where it stands in each of the two scatter plots, mm; an edge point in that of its edge only.
    pub scatter_mm: [Option<[f64; 2]>; 2],
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
            scatter_mm: [[0, 1], [0, 2]].map(|axes| Some(axes.map(|axis| station.error_from_mean_mm[axis]))),
            leave_one_out_mm: station.leave_one_out_mm,
        }
    }
}

impl UsedStation {
    /// A point of a plate; it scatters in the plate's plane and off it, across its edge.
    fn on_plate(plate: &PlateFound, point: &PlatePoint) -> Self {
        let off_in_plate = plate.base_from_plate.rotation.inverse() * point.off_edge_mm;
        Self {
            target_in_sensor_mm: point.point_in_sensor_mm,
            target_in_base_mm: point.point_in_base_mm,
            error_from_first_mm: point.off_edge_mm,
            error_from_mean_mm: point.off_edge_mm,
            // Edge p runs along x, edge q along y.
            scatter_mm: match point.edge {
                Edge::P => [Some([off_in_plate.y, off_in_plate.z]), None],
                Edge::Q => [None, Some([off_in_plate.x, off_in_plate.z])],
            },
            leave_one_out_mm: point.leave_one_out_mm,
        }
    }
}

/// A row in a method's table: a station, or a point on a plate's edge.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// The station's index in the session.
    pub station_idx: usize,
    /// The user's name for it, with the edge where it has one.
    pub label: String,
    /// Whether it takes part now.
    pub is_enabled: bool,
    /// The flange's position at the capture, of a station the first, mm; none of a stretch of a way.
    pub translation_mm: Option<Vec3>,
    /// Its orientation there, w first.
    pub quaternion_wxyz: Option<[f64; 4]>,
    /// What the method says about it; `None` if it did not use it.
    pub used: Option<UsedStation>,
}

impl Row {
    /// Whether it is one of the session's stations, which can be left out; a stretch of a way is none.
    #[must_use]
    pub const fn is_station(&self) -> bool {
        self.translation_mm.is_some()
    }
}

/// A method's table.
#[derive(Clone, Debug, PartialEq)]
pub struct MethodTable {
    /// One row a station of the session, or, for a plate, one a capture.
    pub rows: Vec<Row>,
    /// Whether the rows are points on a plate's edges, and their errors distances from these.
    pub is_of_plate: bool,
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
    /// Largest coordinate of the errors shown, or largest distance from an edge, mm.
    #[must_use]
    pub fn max_error_mm(&self, reference: ErrorReference) -> f64 {
        let size = |error: Vec3| if self.is_of_plate { error.norm() } else { error.amax() };
        self.used().map(|(_, used)| size(used.error_mm(reference))).fold(0.0, f64::max)
    }

    /// What was used, with its row's place.
    pub fn used(&self) -> impl Iterator<Item = (usize, &UsedStation)> {
        self.rows.iter().enumerate().filter_map(|(row_idx, row)| row.used.as_ref().map(|used| (row_idx, used)))
    }

    /// What stands in one of the two scatter plots, with its row's place.
    pub fn scatter(&self, plot: usize) -> impl Iterator<Item = (usize, [f64; 2])> {
        self.used().filter_map(move |(row_idx, used)| Some((row_idx, used.scatter_mm[plot]?)))
    }

    /// Its 1σ ellipse.
    #[must_use]
    pub fn ellipse(&self, plot: usize) -> Option<ScatterEllipse> {
        let points: Vec<[f64; 2]> = self.scatter(plot).map(|(_, point)| point).collect();
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

/// All that is shown.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// What was measured; the wording depends on it.
    pub target: Target,
    /// One column a method, in [`COLUMN_ORDER`].
    pub columns: Vec<Column>,
    /// The paper's comparison.
    pub improvement: Option<Improvement>,
    /// Differences of the methods with results.
    pub differences: Vec<DifferenceRow>,
    /// What a paper printed.
    pub published: Option<PublishedTable>,
}

impl Comparison {
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
            target: session.target.clone(),
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
    let stations = session.stations.iter().enumerate();
    let rows = match &solution.plate {
        None if matches!(session.target, Target::Rgbd { .. }) => solution.stations.iter().map(stretch_row).collect(),
        None => stations
            .map(|(station_idx, station)| {
                let solved = solution.stations.iter().find(|used| used.station_idx == station_idx);
                row(
                    station_idx,
                    station,
                    station.label.clone(),
                    station.captures.first(),
                    solved.map(UsedStation::from),
                )
            })
            .collect(),
        Some(plate) => stations.flat_map(|(station_idx, station)| plate_rows(plate, station_idx, station)).collect(),
    };
    MethodTable {
        rows,
        is_of_plate: solution.plate.is_some(),
        leave_one_out_rms_mm: solution.leave_one_out.map(|left_out| left_out.rms_mm),
        workspace_std_mm: solution.uncertainty.as_ref().map(|uncertainty| uncertainty.workspace_point_std_mm),
        truth: session.truth.as_ref().map(|truth| compare::distance_from_truth(solution, truth)),
        matrix: solution.flange_from_sensor.matrix(),
        mount: solution.mount,
    }
}

/// The station's label, with the number of the capture where there are several.
#[must_use]
pub fn capture_label(station: &Station, capture_idx: usize) -> String {
    match station.captures.len() {
        1 => station.label.clone(),
        _ => format!("{}.{}", station.label, capture_idx + 1),
    }
}

/// One row a capture of a station at the plate.
fn plate_rows(plate: &PlateFound, station_idx: usize, station: &Station) -> Vec<Row> {
    let edge = station.edge.map_or_else(String::new, |edge| format!(" {}", edge_name(edge)));
    let of_capture = |(capture_idx, capture): (usize, &Capture)| {
        let found =
            plate.points.iter().find(|point| (point.station_idx, point.capture_idx) == (station_idx, capture_idx));
        let used = found.map(|point| UsedStation::on_plate(plate, point));
        row(station_idx, station, capture_label(station, capture_idx) + &edge, Some(capture), used)
    };
    station.captures.iter().enumerate().map(of_capture).collect()
}

fn row(
    station_idx: usize,
    station: &Station,
    label: String,
    capture: Option<&Capture>,
    used: Option<UsedStation>,
) -> Row {
    let pose = capture.map(|capture| &capture.base_from_flange);
    Row {
        station_idx,
        label,
        is_enabled: station.enabled,
        translation_mm: pose.map(crate::geometry::Transform::translation_mm),
        quaternion_wxyz: pose.map(crate::geometry::Transform::quaternion_wxyz),
        used,
    }
}

/// A stretch of a way stands for itself: the session lists none.
fn stretch_row(stretch: &StationSolution) -> Row {
    Row {
        station_idx: stretch.station_idx,
        label: stretch.label.clone(),
        is_enabled: true,
        translation_mm: None,
        quaternion_wxyz: None,
        used: Some(UsedStation::from(stretch)),
    }
}

/// Pairs worth a row: from each step of the paper's story to the next.
fn differences(results: &[MethodResult]) -> Vec<DifferenceRow> {
    let with_result = |methods: &[Method]| -> Vec<Method> {
        methods.iter().copied().filter(|method| solution_of(results, *method).is_some()).collect()
    };
    let story: Vec<Method> = COLUMN_ORDER.into_iter().filter(|method| *method != Method::BallMaxArcStep).collect();
    let mut pairs: Vec<(Method, Method)> = with_result(&story).windows(2).map(|pair| (pair[0], pair[1])).collect();
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
mod tests;
