//! A known point measured many times: the paper's Table 3.

use crate::geometry::Vec3;

/// The point as one capture or station has it, through a calibration.
#[derive(Clone, Debug, PartialEq)]
pub struct Measurement {
    /// The caller's index of its station.
    pub station_idx: usize,
    /// The station's name.
    pub label: String,
    /// Which of the station's captures it is, where the station has several that each see the point by themselves.
    pub capture_idx: Option<usize>,
    /// Where the calibration puts the point in the base, mm.
    pub point_in_base_mm: Vec3,
}

impl Measurement {
    /// The station's name, with the number of the capture where there are several.
    #[must_use]
    pub fn name(&self) -> String {
        match self.capture_idx {
            Some(capture_idx) => format!("{}.{}", self.label, capture_idx + 1),
            None => self.label.clone(),
        }
    }
}

/// How far repeated measurements of a point are off it, and how far they scatter.
#[derive(Clone, Debug, PartialEq)]
pub struct Stability {
    /// What they are held against, in the base, mm.
    pub reference_mm: Vec3,
    /// Whether that is a point known from elsewhere; otherwise it is the mean of the measurements.
    pub is_touched: bool,
    /// Measured minus reference, one entry a measurement, mm.
    pub deviations_mm: Vec<Vec3>,
    /// Their mean: nothing by itself where the reference is the mean.
    pub mean_mm: Vec3,
    /// Their standard deviation about that mean, an axis, mm. Over `n`, not `n − 1`: so the paper's 3δ follow from its rows.
    pub std_mm: Vec3,
}

impl Stability {
    /// Holds measurements against a touched point, or else against their mean; `None` for fewer than two, which do not scatter.
    #[must_use]
    pub fn of(measurements: &[Measurement], touched_mm: Option<Vec3>) -> Option<Self> {
        if measurements.len() < 2 {
            return None;
        }
        #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^52 measurements")]
        let count = measurements.len() as f64;
        let centroid = measurements.iter().map(|measured| measured.point_in_base_mm).sum::<Vec3>() / count;
        let reference_mm = touched_mm.unwrap_or(centroid);
        let deviations_mm: Vec<Vec3> =
            measurements.iter().map(|measured| measured.point_in_base_mm - reference_mm).collect();
        let mean_mm = centroid - reference_mm;
        let squares = deviations_mm.iter().map(|deviation| (deviation - mean_mm).map(|value| value * value));
        let std_mm = (squares.sum::<Vec3>() / count).map(f64::sqrt);
        Some(Self { reference_mm, is_touched: touched_mm.is_some(), deviations_mm, mean_mm, std_mm })
    }

    /// The paper's 3δ an axis, mm.
    #[must_use]
    pub fn three_std_mm(&self) -> Vec3 {
        3.0 * self.std_mm
    }

    /// The same in three dimensions: root of the sum of the squares, mm.
    #[must_use]
    pub fn three_std_3d_mm(&self) -> f64 {
        3.0 * self.std_mm.norm()
    }
}
