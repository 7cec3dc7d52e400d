//! What a method computes, and how good it is.

use nalgebra::{Matrix6, Vector6};

use crate::geometry::{Flange, Mat3, Rigid, Sensor, Transform, Vec3};

use super::{Edge, Method, MotionFound, Mount, PlateReduced, Reduced, Side, Warning};

/// Root mean square and maximum of some distances, mm.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RmsMax {
    /// Root mean square, mm.
    pub rms_mm: f64,
    /// Maximum, mm.
    pub max_mm: f64,
}

/// How well the result is known, one standard deviation.
#[derive(Clone, Debug, PartialEq)]
pub struct Uncertainty {
    /// Covariance of (rotation, translation): rotation in rad as a right perturbation (about the sensor's axes),
    /// translation in mm along the flange's axes.
    pub covariance: Matrix6<f64>,
    /// Of the translation along the flange's axes, mm.
    pub translation_std_mm: Vec3,
    /// Of the rotation about the sensor's axes, rad.
    pub rotation_std_rad: Vec3,
    /// Of a point at `reference_point_in_sensor_mm`, in three dimensions (root of the trace), mm: the headline.
    pub workspace_point_std_mm: f64,
    /// The point that the headline speaks of, mm.
    pub reference_point_in_sensor_mm: Vec3,
    /// Covariance of that point along the flange's axes, mm².
    pub workspace_point_covariance: Mat3,
    /// Degrees of freedom behind the covariance; infinite where the noise is stated, few where it was estimated from little.
    pub degrees_of_freedom: f64,
    /// The ball that holds the true workspace point with 95 %: its radius, mm.
    pub workspace_point_95_mm: f64,
}

impl Uncertainty {
    /// The direction (unit vector in the flange) in which the workspace point is known worst, and its σ there, mm.
    #[must_use]
    pub fn weakest_direction(&self) -> (Vec3, f64) {
        let eigen = self.workspace_point_covariance.symmetric_eigen();
        let worst = eigen.eigenvalues.imax();
        (eigen.eigenvectors.column(worst).into_owned(), eigen.eigenvalues[worst].max(0.0).sqrt())
    }

    /// Covariance of the rotation as a right perturbation, rad².
    #[must_use]
    pub fn rotation_covariance(&self) -> Mat3 {
        self.covariance.fixed_view::<3, 3>(0, 0).into_owned()
    }
}

/// The noise of the robot that the weights of a solution stand for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NoiseModel {
    /// Standard deviation of each coordinate of a reported position, of every pose by itself, mm.
    pub position_std_mm: f64,
    /// Standard deviation of a reported orientation about each axis, of every pose by itself, rad.
    pub orientation_std_rad: f64,
    /// The same for what all poses of a station have in common, on top of that, mm.
    pub station_position_std_mm: f64,
    /// The same for the orientation, rad.
    pub station_orientation_std_rad: f64,
    /// Whether the first two are the session's; otherwise they are estimated from the data.
    pub is_stated: bool,
    /// By how much the data scatter more than the stated noise; `None` where it is not stated, or nothing is left over.
    pub above_stated: Option<AboveStated>,
}

impl AboveStated {
    /// Whether the data refute the statement: far beyond chance, and by more than a careless figure.
    #[must_use]
    pub fn is_contradicted(&self) -> bool {
        self.p_value < 1e-6 && self.ratio > 2.0
    }
}

/// The scatter of the data against that by the noise that the session states.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AboveStated {
    /// Scatter over what is stated; about 1 where the statement is true.
    pub ratio: f64,
    /// Probability of so much by chance.
    pub p_value: f64,
}

/// The ball's radius where it was estimated along with the calibration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EstimatedRadius {
    /// The radius, mm.
    pub radius_mm: f64,
    /// Its standard deviation, mm.
    pub std_mm: f64,
}

/// One step of a sweep as the curve shows it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SweepPoint {
    /// Index of the capture in its station.
    pub capture_idx: usize,
    /// Travel from the first capture along the laser's normal, mm.
    pub travel_mm: f64,
    /// Radius of the section, mm.
    pub section_radius_mm: f64,
    /// Its standard deviation, mm.
    pub section_radius_std_mm: f64,
    /// Measured minus fitted radius, mm.
    pub residual_mm: f64,
}

/// The radius-vs-step curve of one station, evaluated both ways.
#[derive(Clone, Debug, PartialEq)]
pub struct Sweep {
    /// The steps with a usable arc, in order of capture.
    pub points: Vec<SweepPoint>,
    /// Travel at which the arc is largest: the peak of l² = R² − (travel − peak)², mm.
    pub peak_mm: f64,
    /// Its standard deviation, mm.
    pub peak_std_mm: f64,
    /// The travel where the published rule stops, mm.
    pub published_stop_mm: f64,
    /// The capture at which it stops.
    pub published_stop_idx: usize,
    /// How far the published rule may be off here: about √(2 R `σ_l`) and half a step, mm.
    pub published_stop_std_mm: f64,
    /// Angle between the travel and the laser's normal, rad.
    pub travel_off_normal_rad: f64,
    /// Whether the steps reach both sides of the peak.
    pub covers_peak: bool,
}

/// What a method says about one station.
#[derive(Clone, Debug, PartialEq)]
pub struct StationSolution {
    /// The caller's index, as in [`super::Station::idx`].
    pub station_idx: usize,
    /// The user's name for it.
    pub label: String,
    /// Side of the ball's centre.
    pub side: Side,
    /// Cost of the best solution with the other side, over the cost of this one; `None` where the side was not in doubt.
    pub side_cost_ratio: Option<f64>,
    /// The ball's centre in the sensor frame of the first capture, mm.
    pub target_in_sensor_mm: Vec3,
    /// Standard deviation of its coordinates from the profile alone, mm.
    pub target_in_sensor_std_mm: Option<Vec3>,
    /// The same point through the calibration, in the base, mm.
    pub target_in_base_mm: Vec3,
    /// `target_in_base_mm` minus that of the first station used, mm.
    pub error_from_first_mm: Vec3,
    /// `target_in_base_mm` minus the mean over the stations used, mm.
    pub error_from_mean_mm: Vec3,
    /// Distance between this station's ball and the ball of the solution made without it, mm.
    pub leave_one_out_mm: Option<f64>,
    /// The evaluated sweep, for the largest-arc methods.
    pub sweep: Option<Sweep>,
}

/// A point on an edge of the plate, through the calibration.
#[derive(Clone, Debug, PartialEq)]
pub struct PlatePoint {
    /// Its station's place in the list of those used, as in [`PlateReduced`].
    pub station: usize,
    /// The caller's index of its station, as in [`super::Station::idx`].
    pub station_idx: usize,
    /// Its capture in that station.
    pub capture_idx: usize,
    /// The station's name.
    pub label: String,
    /// The edge that it is on.
    pub edge: Edge,
    /// In the sensor frame, mm.
    pub point_in_sensor_mm: Vec3,
    /// Through the calibration, in the base, mm.
    pub point_in_base_mm: Vec3,
    /// From the nearest point of its edge to the point, in the base, mm.
    pub off_edge_mm: Vec3,
    /// Its distance from the edge of the solution made without its station, mm.
    pub leave_one_out_mm: Option<f64>,
}

/// How the starts of a search fared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Starts {
    /// Starts tried.
    pub num_tried: usize,
    /// Those that ended in the solution.
    pub num_agreed: usize,
}

/// The plate in the base, and the points on it.
#[derive(Clone, Debug, PartialEq)]
pub struct PlateFound {
    /// Where the plate is: the origin in its corner, x along edge p, y along edge q, z normal to it; as the method has it,
    /// or fitted to its points where it has none.
    pub base_from_plate: Rigid,
    /// One entry a reading used, in the order of stations and captures. The readings of a station at one pose are one point of
    /// the data.
    pub points: Vec<PlatePoint>,
    /// How many starts there were, and how many led here.
    pub starts: Starts,
    /// The data at the minimum, for validation and diagnosis.
    pub reduced: PlateReduced,
}

/// A calibration.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution {
    /// The method that made it.
    pub method: Method,
    /// Where the sensor is. For [`Mount::Fixed`] read "base" for flange and "flange" for base in the names below.
    pub mount: Mount,
    /// The hand-eye calibration.
    pub flange_from_sensor: Transform<Flange, Sensor>,
    /// The target's point, mm: the ball's centre, the tip, the corner where the plate's edges meet, or the origin of a target
    /// whose whole pose is seen.
    pub target_in_base_mm: Vec3,
    /// Distances of the stations' balls or tips from `target_in_base_mm`, or of the points from their edges; in sample.
    pub scatter: RmsMax,
    /// Distances with each station predicted by the others; `None` where too few stations remain for that.
    pub leave_one_out: Option<RmsMax>,
    /// How well the result is known; `None` where nothing is left over to judge by.
    pub uncertainty: Option<Uncertainty>,
    /// One entry a station used, in order; none for a plate, whose points are in `plate`.
    pub stations: Vec<StationSolution>,
    /// The plate that was found, for its methods.
    pub plate: Option<PlateFound>,
    /// The target's whole pose and what belongs to it, for [`Method::Motion`].
    pub motion: Option<MotionFound>,
    /// Angle of the largest rotation between two poses, rad.
    pub rotation_span_rad: f64,
    /// What the user should know.
    pub warnings: Vec<Warning>,
    /// Iterations of the last solve.
    pub num_iterations: usize,
    /// The noise that the data were weighed by; `None` for methods that weigh all stations alike.
    pub noise: Option<NoiseModel>,
    /// The ball's radius where it was estimated as well.
    pub radius: Option<EstimatedRadius>,
    /// The data at the minimum, for validation, diagnosis and planning; `None` for a plate and for [`Method::Motion`].
    pub reduced: Option<Reduced>,
    /// How the result follows the ball's radius: change of (rotation about the sensor's axes in rad, translation along the
    /// flange's axes in mm) a mm of radius.
    pub change_by_radius: Vector6<f64>,
    /// The same for the workspace point, along the flange's axes, mm a mm.
    pub workspace_point_by_radius: Vec3,
}
