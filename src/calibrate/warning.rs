//! What a user should know about a result: facts here, wording in [`crate::text`].

use crate::fit::Refusal;

/// What would explain a pose that contradicts the others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PoseFault {
    /// The target's pose is inverted: it fits as `target_from_sensor`.
    Inverted,
    /// The target is seen turned by half about one of its axes, or mirrored by its tilt: a flat marker read the wrong way.
    Flipped,
    /// Its place fits, its orientation does not.
    Orientation,
    /// Its orientation fits, its place does not.
    Place,
    /// Neither fits.
    Both,
}

/// Something about a result that the user should know. Sentence and remedy come from [`crate::text`].
#[derive(Clone, Debug, PartialEq)]
pub enum Warning {
    /// Hardly more equations than unknowns.
    FewStations {
        /// Stations used.
        num_stations: usize,
        /// A number that makes the figures trustworthy.
        recommended: usize,
    },
    /// Hardly more points on the plate's edges than unknowns.
    FewEdgePoints {
        /// Points on edge p.
        num_p: usize,
        /// Points on edge q.
        num_q: usize,
        /// A number on each that makes the figures trustworthy.
        recommended: usize,
    },
    /// Another calibration fits the data about as well.
    OtherMinimum {
        /// Its residual over that of this one (RMS).
        ratio: f64,
        /// How far it puts the sensor from where this one has it, mm.
        distance_mm: f64,
    },
    /// The orientations are alike.
    LittleRotation {
        /// Largest rotation between two stations, degrees.
        span_deg: f64,
        /// A span that does, degrees.
        recommended_deg: f64,
    },
    /// The rotations are almost all about one axis.
    NearlyOneAxis {
        /// How much smaller the rotations about the other axes are.
        ratio: f64,
        /// The one axis, in the flange frame: along it sensor and ball are hardly told apart.
        axis_in_flange: [f64; 3],
    },
    /// The other side of the ball fits about as well.
    SideAmbiguous {
        /// Stations concerned.
        labels: Vec<String>,
        /// Least cost with the other side over cost with this.
        ratio: f64,
    },
    /// The sections are so near the largest that y is hardly measured.
    BlindInY {
        /// Stations concerned.
        labels: Vec<String>,
        /// Largest σ of y, mm.
        std_y_mm: f64,
        /// Median σ across and along the range, mm.
        std_xz_mm: f64,
    },
    /// A section larger than the ball.
    ArcLargerThanBall {
        /// Station.
        label: String,
        /// Capture, from 0.
        capture_idx: usize,
        /// Section radius, mm.
        section_radius_mm: f64,
        /// Ball radius, mm.
        ball_radius_mm: f64,
    },
    /// Profiles without a usable arc were left out.
    CaptureRefused {
        /// Station.
        label: String,
        /// Capture, from 0.
        capture_idx: usize,
        /// Why.
        reason: Refusal,
        /// How many more were refused.
        num_others: usize,
    },
    /// A whole station was left out.
    StationSkipped {
        /// Station.
        label: String,
        /// Usable captures found.
        found: usize,
        /// Usable captures needed.
        needed: usize,
    },
    /// The robot's travel is not along the laser's normal.
    TravelOffNormal {
        /// Station with the largest angle.
        label: String,
        /// The angle, degrees.
        angle_deg: f64,
    },
    /// The steps end before the largest arc.
    PeakNotCovered {
        /// Station.
        label: String,
        /// How far beyond the last step the peak lies, mm.
        beyond_mm: f64,
    },
    /// The sweeps fit another radius.
    RadiusDisagrees {
        /// Radius that the sweeps show, mm.
        found_mm: f64,
        /// Its standard deviation, mm.
        std_mm: f64,
        /// Radius in the session, mm.
        ball_radius_mm: f64,
    },
    /// The recorded poses did not move as commanded.
    StepDiffersFromPose {
        /// Station.
        label: String,
        /// Largest difference between commanded and real travel, mm.
        difference_mm: f64,
    },
    /// One station disagrees with all others.
    StationStandsOut {
        /// Station.
        label: String,
        /// Its left-out error, mm.
        error_mm: f64,
        /// The median of the others, mm.
        typical_mm: f64,
    },
    /// A target's pose that contradicts all others was left out.
    PoseRejected {
        /// Station.
        label: String,
        /// Capture, from 0.
        capture_idx: usize,
        /// How far it puts the target from where the others have it, mm.
        off_mm: f64,
        /// By how much it turns the target, degrees.
        off_deg: f64,
        /// What would explain it.
        fault: PoseFault,
    },
    /// All poses fit far better with one of the two lists inverted. Which one cannot be told: with both inverted they fit as
    /// well, and sensor and target change places.
    StreamInverted {
        /// Residual as given over residual with one inverted.
        ratio: f64,
    },
    /// The target's poses are too far or too near by one factor: a board or marker of another size than was stated.
    TargetScale {
        /// The factor that its translations need.
        factor: f64,
        /// Its standard deviation.
        std: f64,
    },
    /// The data do not tell by how much the clocks of robot and camera differ.
    TimeOffsetUnknown,
    /// The solver stopped before it settled.
    NotConverged {
        /// Iterations made.
        num_iterations: usize,
    },
}

impl Warning {
    /// The code that programs rely on.
    #[must_use]
    pub const fn code(&self) -> &'static str {
        match self {
            Self::FewStations { .. } => "few-stations",
            Self::FewEdgePoints { .. } => "few-edge-points",
            Self::OtherMinimum { .. } => "other-minimum",
            Self::LittleRotation { .. } => "little-rotation",
            Self::NearlyOneAxis { .. } => "nearly-one-axis",
            Self::SideAmbiguous { .. } => "side-ambiguous",
            Self::BlindInY { .. } => "blind-in-y",
            Self::ArcLargerThanBall { .. } => "arc-larger-than-ball",
            Self::CaptureRefused { .. } => "capture-refused",
            Self::StationSkipped { .. } => "station-skipped",
            Self::TravelOffNormal { .. } => "travel-off-normal",
            Self::PeakNotCovered { .. } => "peak-not-covered",
            Self::RadiusDisagrees { .. } => "radius-disagrees",
            Self::StepDiffersFromPose { .. } => "step-differs-from-pose",
            Self::StationStandsOut { .. } => "station-stands-out",
            Self::PoseRejected { .. } => "pose-rejected",
            Self::StreamInverted { .. } => "stream-inverted",
            Self::TargetScale { .. } => "target-scale",
            Self::TimeOffsetUnknown => "time-offset-unknown",
            Self::NotConverged { .. } => "not-converged",
        }
    }
}

impl Warning {
    /// Whether a result with this warning is never called good, however small its figures.
    #[must_use]
    pub const fn casts_doubt(&self) -> bool {
        matches!(
            self,
            Self::FewStations { .. }
                | Self::FewEdgePoints { .. }
                | Self::OtherMinimum { .. }
                | Self::LittleRotation { .. }
                | Self::NearlyOneAxis { .. }
                | Self::SideAmbiguous { .. }
                | Self::BlindInY { .. }
                | Self::RadiusDisagrees { .. }
                | Self::ArcLargerThanBall { .. }
                | Self::StationStandsOut { .. }
                | Self::StreamInverted { .. }
                | Self::TargetScale { .. }
                | Self::NotConverged { .. }
        )
    }
}
