//! A finding: what is wrong, how sure that is, the evidence, and what would mend it. Wording is in [`crate::text`].

use std::cmp::Ordering;

use crate::calibrate::{Edge, SolveError, Warning};
use crate::geometry::{Rigid, Vec3};

use super::convention::{PoseReading, ReadingFit};
use super::remedy::Remedy;

/// How much a finding weighs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// The result is not to be used until this is mended.
    Wrong,
    /// The result may be worse than its figures say.
    Doubtful,
    /// Worth knowing.
    Note,
}

/// An axis of the sensor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// Across the laser line.
    X,
    /// Along the range.
    Z,
}

/// What is wrong: facts only. Stations are given by their index in the session.
#[derive(Clone, Debug, PartialEq)]
pub enum Fault {
    /// The poses fit when they are read in another way: another convention, quaternion order, unit, or inverted.
    PosesMisread {
        /// The way that fits.
        reading: PoseReading,
    },
    /// The given sides of these stations are the other way round.
    WrongSides {
        /// The stations.
        station_idxs: Vec<usize>,
    },
    /// An axis of the sensor runs the other way than the session has it.
    MirroredAxis {
        /// Which one.
        axis: Axis,
    },
    /// All orientations are the same.
    NoRotation {
        /// Largest rotation between two stations, degrees.
        span_deg: f64,
    },
    /// The orientations are too much alike.
    LittleRotation {
        /// Largest rotation between two stations, degrees.
        span_deg: f64,
        /// A span that does, degrees.
        recommended_deg: f64,
        /// The direction in the flange along which the sensor's place is known worst, and its σ, mm.
        weakest: Option<(Vec3, f64)>,
    },
    /// The rotations are (nearly) all about one axis.
    OneAxis {
        /// The axis in the flange; along it sensor and ball shift together unseen.
        axis_in_flange: Vec3,
        /// How many times smaller the other rotations are; `None` where there are none.
        ratio: Option<f64>,
    },
    /// Two stations have the same pose, so they count as one.
    TwinPoses {
        /// The two.
        station_idxs: [usize; 2],
        /// Their distance, mm.
        distance_mm: f64,
        /// The angle between them, degrees.
        angle_deg: f64,
    },
    /// The ball has another radius than the session says.
    WrongRadius {
        /// The radius that fits, mm.
        found_mm: f64,
        /// Its σ, mm.
        std_mm: f64,
        /// The session's, mm.
        given_mm: f64,
    },
    /// The profiles are scaled: true size over size in the file.
    ProfileScale {
        /// By this factor the profiles have to be multiplied.
        factor: f64,
        /// Its σ.
        std: f64,
    },
    /// The robot does not travel along the laser's normal.
    TravelOffNormal {
        /// The station where it is worst.
        station_idx: usize,
        /// The angle there, degrees.
        angle_deg: f64,
    },
    /// The steps in the file are not those that the poses made.
    StepDiffersFromPose {
        /// The station where it is worst.
        station_idx: usize,
        /// Moved over commanded distance, over all stations.
        ratio: f64,
        /// Largest difference, mm.
        difference_mm: f64,
    },
    /// The ball (or the robot, or the sensor) moved steadily during the recording.
    Drift {
        /// From the first station to the last, in the base, mm.
        total_in_base_mm: Vec3,
        /// σ of its length, mm.
        std_mm: f64,
    },
    /// From some station on the controller reported another frame: a TOOL was switched.
    ToolFrame {
        /// The first station with the other frame.
        from_station_idx: usize,
        /// The other frame in the first one: `flange_from_tool`.
        flange_from_tool: Rigid,
    },
    /// The result is the identity, near enough: the reported frame is the sensor's own TOOL, not the flange.
    SensorIsTool {
        /// Length of the translation, mm.
        distance_mm: f64,
        /// Angle of the rotation, degrees.
        angle_deg: f64,
    },
    /// The pose of a station is wrong.
    WrongPose {
        /// The station.
        station_idx: usize,
        /// How far its ball is from where the others have it, mm.
        off_mm: f64,
        /// The same for the others, median, mm.
        typical_mm: f64,
    },
    /// A station at a plate contradicts the others: its pose or its profile is wrong.
    WrongStation {
        /// The station.
        station_idx: usize,
        /// How far its points are off the edge as the others have it, mm.
        off_mm: f64,
        /// The same for the others, median, mm.
        typical_mm: f64,
    },
    /// A station saw the other edge of the plate than the session says.
    WrongEdge {
        /// The station.
        station_idx: usize,
        /// The edge that it fits.
        edge: Edge,
    },
    /// A station still has the pose of another one.
    StalePose {
        /// The station.
        station_idx: usize,
        /// Whose pose it has.
        pose_of_idx: usize,
        /// How far its ball is from where the others have it, mm.
        off_mm: f64,
    },
    /// Profiles and poses are paired wrongly.
    MixedOrder {
        /// `(station, station whose pose belongs to it)`.
        poses_from: Vec<(usize, usize)>,
    },
    /// So many stations contradict each other that the rest decides nothing.
    TooFewCleanStations {
        /// Stations that agree.
        clean: usize,
        /// How many have to.
        needed: usize,
    },
    /// The stations scatter more than the stated noise explains.
    NoiseAboveStated {
        /// Scatter over what is stated.
        ratio: f64,
        /// Probability of so much by chance.
        p_value: f64,
    },
    /// The calibrations from two halves of the stations differ by more than their σ explains.
    HalvesDisagree {
        /// Median over the splits, at the workspace point, mm.
        median_mm: f64,
        /// What the σ lets one expect, mm.
        expected_mm: f64,
    },
    /// The residuals are not normally distributed.
    ResidualsNotNormal {
        /// Probability of such residuals by chance.
        p_value: f64,
    },
    /// The stations contradict each other, and nothing that was tried says why.
    DoesNotFit {
        /// RMS scatter of the ball, mm.
        scatter_mm: f64,
    },
    /// No method could compute anything, for a reason of its own.
    NotSolved(SolveError),
    /// What a method warns of, where nothing above says it better.
    Method(Warning),
}

impl Fault {
    /// The code that programs rely on.
    #[must_use]
    pub fn code(&self) -> &'static str {
        match self {
            Self::PosesMisread { reading } => reading.code(),
            Self::WrongSides { .. } => "wrong-side",
            Self::MirroredAxis { axis: Axis::X } => "mirrored-x",
            Self::MirroredAxis { axis: Axis::Z } => "mirrored-z",
            Self::NoRotation { .. } => "no-rotation",
            Self::LittleRotation { .. } => "little-rotation",
            Self::OneAxis { .. } => "one-axis",
            Self::TwinPoses { .. } => "twin-poses",
            Self::WrongRadius { .. } => "wrong-radius",
            Self::ProfileScale { .. } => "profile-scale",
            Self::TravelOffNormal { .. } => "travel-off-normal",
            Self::StepDiffersFromPose { .. } => "step-differs-from-pose",
            Self::Drift { .. } => "drift",
            Self::ToolFrame { .. } | Self::SensorIsTool { .. } => "tool-frame",
            Self::WrongPose { .. } => "wrong-pose",
            Self::WrongStation { .. } => "wrong-station",
            Self::WrongEdge { .. } => "wrong-edge",
            Self::StalePose { .. } => "stale-pose",
            Self::MixedOrder { .. } => "mixed-order",
            Self::TooFewCleanStations { .. } => "too-few-clean-stations",
            Self::NoiseAboveStated { .. } => "noise-above-stated",
            Self::HalvesDisagree { .. } => "halves-disagree",
            Self::ResidualsNotNormal { .. } => "residuals-not-normal",
            Self::DoesNotFit { .. } => "does-not-fit",
            Self::NotSolved(_) => "not-solved",
            Self::Method(warning) => warning.code(),
        }
    }
}

/// What a plot of the evidence shows.
#[derive(Clone, Debug, PartialEq)]
pub enum Plot {
    /// How far each station's ball is from where the others have it.
    Stations(Vec<StationBar>),
    /// Residual of the ways to read the poses, best first.
    Readings(Vec<ReadingFit>),
    /// RMS residual (mm) against a quantity that the session gives.
    Curve {
        /// The quantity.
        axis: CurveAxis,
        /// `[quantity, RMS in mm]`, rising in the quantity.
        points: Vec<[f64; 2]>,
        /// The session's value.
        given: f64,
        /// The value that fits best.
        found: f64,
        /// Its σ.
        std: f64,
    },
    /// Shift of the stations' balls (mm) along the drift, in order of recording, with the straight line through them.
    Trend {
        /// `[number of the station from 1, shift in mm]`.
        points: Vec<[f64; 2]>,
        /// Shift at the first and at the last station, mm.
        line: [f64; 2],
    },
    /// A direction in the flange, with the mean rotation about each of the three principal axes.
    Direction {
        /// Unit vector in the flange.
        in_flange: Vec3,
        /// RMS rotation about the axes, least first, degrees.
        rotations_deg: [f64; 3],
    },
    /// `[commanded travel, travel by the poses]` of every step, mm.
    Steps(Vec<[f64; 2]>),
}

/// The quantity along a [`Plot::Curve`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CurveAxis {
    /// The ball's radius, mm.
    RadiusMm,
    /// The factor on the profiles.
    ProfileScale,
}

/// One bar of [`Plot::Stations`].
#[derive(Clone, Debug, PartialEq)]
pub struct StationBar {
    /// Index in the session.
    pub station_idx: usize,
    /// The user's name for it.
    pub label: String,
    /// Its error, mm.
    pub error_mm: f64,
    /// Whether the finding is about it.
    pub is_accused: bool,
}

/// The numbers and the plot that a finding rests on.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Evidence {
    /// RMS residual as given and mended, mm, both by the same measure.
    pub residual_mm: Option<[f64; 2]>,
    /// The plot.
    pub plot: Option<Plot>,
}

/// One thing that is wrong or doubtful.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// What.
    pub fault: Fault,
    /// How much it weighs.
    pub severity: Severity,
    /// How many times the residual (RMS) falls when it is mended; 1 where that is no measure.
    pub explains: f64,
    /// What it rests on.
    pub evidence: Evidence,
    /// What mends it with one click, where that is possible.
    pub remedy: Option<Remedy>,
}

impl Finding {
    /// By severity, then by how much of the residual it explains.
    #[must_use]
    pub fn more_serious_first(a: &Self, b: &Self) -> Ordering {
        a.severity.cmp(&b.severity).then(b.explains.total_cmp(&a.explains))
    }
}
