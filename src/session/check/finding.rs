//! What can be odd about a session; the wording is on the floor above.

use crate::session::model::Edge;

/// Something to look at in a session; the wording is on the floor above.
#[derive(Clone, Debug, PartialEq)]
pub enum Finding {
    /// Quaternions in the file were rounded so much that they had to be normalised.
    QuaternionsNormalised {
        /// How many.
        num_poses: usize,
        /// The one furthest off unit norm.
        worst_path: String,
        /// Its norm.
        worst_norm: f64,
    },
    /// There are no stations yet.
    NoStations,
    /// Too few stations are enabled.
    FewStations {
        /// How many are enabled.
        num_enabled: usize,
        /// How many are needed.
        needed: usize,
    },
    /// No station that takes part saw this edge of the plate.
    EdgeWithoutStations {
        /// The edge.
        edge: Edge,
    },
    /// Few stations that take part saw this edge of the plate.
    FewOnEdge {
        /// The edge.
        edge: Edge,
        /// How many are enabled.
        num_enabled: usize,
        /// How many are needed.
        needed: usize,
    },
    /// Something to look at in a further target.
    InFurther {
        /// Its name.
        name: String,
        /// What there is.
        finding: Box<Finding>,
    },
    /// Two stations measured from the same pose.
    TwinStations {
        /// The first.
        label: String,
        /// The second.
        twin_label: String,
        /// Distance of the two, mm.
        distance_mm: f64,
        /// Angle between the two, degrees.
        angle_deg: f64,
    },
    /// A pose at which nothing was measured.
    NoReading {
        /// Its station.
        label: String,
        /// Which capture, from 0.
        capture_idx: usize,
    },
    /// A profile without a single valid point.
    EmptyProfile {
        /// Its station.
        label: String,
        /// Which capture, from 0.
        capture_idx: usize,
    },
    /// A reduced point that is not in the laser plane, where all that the sensor sees of an edge or a tip is.
    PointOutsidePlane {
        /// Its station.
        label: String,
        /// Which capture, from 0: the farthest.
        capture_idx: usize,
        /// Its distance from the plane, mm.
        y_mm: f64,
    },
    /// The robot moved by another distance than was commanded.
    StepDiffersFromPose {
        /// The station.
        label: String,
        /// The capture that was stepped to, from 0: the one where they differ most.
        capture_idx: usize,
        /// The commanded step, mm.
        step_mm: f64,
        /// The distance between the recorded poses, mm.
        moved_mm: f64,
    },
    /// A pose further away than any arm reaches.
    FarPose {
        /// The station.
        label: String,
        /// Which capture, from 0: the farthest.
        capture_idx: usize,
        /// Its distance from the base, mm.
        distance_mm: f64,
    },
    /// A station far from all others: a slipped digit or sign, or another unit.
    FarFromOthers {
        /// The station.
        label: String,
        /// Its distance from the middle of the stations, mm.
        distance_mm: f64,
        /// The distance that half of them keep, mm.
        typical_mm: f64,
    },
    /// Noise figures are missing, so they will be estimated.
    NoiseNotGiven {
        /// The fields, as the file would name them.
        fields: Vec<&'static str>,
    },
}

impl Finding {
    /// A stable name for other programs.
    #[must_use]
    pub const fn code(&self) -> &'static str {
        match self {
            Self::QuaternionsNormalised { .. } => "quaternions-normalised",
            Self::NoStations => "no-stations",
            Self::FewStations { .. } => "few-stations",
            Self::EdgeWithoutStations { .. } => "edge-without-stations",
            Self::FewOnEdge { .. } => "few-on-edge",
            Self::InFurther { finding, .. } => finding.code(),
            Self::TwinStations { .. } => "twin-stations",
            Self::NoReading { .. } => "no-reading",
            Self::EmptyProfile { .. } => "empty-profile",
            Self::PointOutsidePlane { .. } => "point-outside-plane",
            Self::StepDiffersFromPose { .. } => "step-differs-from-pose",
            Self::FarPose { .. } => "far-pose",
            Self::FarFromOthers { .. } => "far-from-others",
            Self::NoiseNotGiven { .. } => "noise-not-given",
        }
    }

    /// Whether it says that stations are missing without which nothing can be solved.
    #[must_use]
    pub const fn lacks_stations(&self) -> bool {
        matches!(self, Self::NoStations | Self::FewStations { .. } | Self::EdgeWithoutStations { .. })
    }

    /// The station of the session's own target that it is about, if it is about one.
    #[must_use]
    pub fn station_label(&self) -> Option<&str> {
        match self {
            Self::TwinStations { label, .. }
            | Self::NoReading { label, .. }
            | Self::EmptyProfile { label, .. }
            | Self::PointOutsidePlane { label, .. }
            | Self::StepDiffersFromPose { label, .. }
            | Self::FarPose { label, .. }
            | Self::FarFromOthers { label, .. } => Some(label),
            Self::QuaternionsNormalised { .. }
            | Self::NoStations
            | Self::FewStations { .. }
            | Self::EdgeWithoutStations { .. }
            | Self::FewOnEdge { .. }
            | Self::InFurther { .. }
            | Self::NoiseNotGiven { .. } => None,
        }
    }
}
