//! A history as series to be drawn: values over time with what each calibration states, and the lines of the trend.

use crate::geometry::stats;
use crate::verify::drift::{axis_stds, point_stds};

use super::History;

/// What is drawn over time; each has three axes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Quantity {
    /// The way of the workspace point, mm.
    #[default]
    Point,
    /// That of the sensor's origin, mm.
    Translation,
    /// The rotation, degrees.
    Rotation,
}

impl Quantity {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Point, Self::Translation, Self::Rotation];
}

/// The values of one axis over time, against the first.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// Time and value, one a calibration.
    pub values: Vec<[f64; 2]>,
    /// What each calibration states of itself.
    pub stds: Vec<Option<f64>>,
    /// The trend between the jumps, each from its first to its last calibration.
    pub lines: Vec<[[f64; 2]; 2]>,
    /// Whether it is more than chance.
    pub is_drift: Option<bool>,
}

/// The three axes of a quantity.
#[must_use]
pub fn series(history: &History, quantity: Quantity) -> [Series; 3] {
    let trends: Vec<_> = history.shown_trends().collect();
    std::array::from_fn(|axis| {
        let value = |idx: usize| {
            let change = &history.drift.from_first[idx];
            match quantity {
                Quantity::Point => change.shift.shift_mm[axis],
                Quantity::Translation => change.difference.translation_mm[axis],
                Quantity::Rotation => change.difference.rotation_rad[axis].to_degrees(),
            }
        };
        let values: Vec<[f64; 2]> = history.times.iter().enumerate().map(|(idx, at)| [*at, value(idx)]).collect();
        let stds = history
            .calibrations
            .iter()
            .map(|calibration| match quantity {
                Quantity::Point => {
                    point_stds(&calibration.stated, history.reference_point_in_sensor_mm).map(|stds| stds[axis])
                }
                Quantity::Translation => axis_stds(&calibration.stated).map(|stds| stds[axis]),
                Quantity::Rotation => axis_stds(&calibration.stated).map(|stds| stds[axis + 3].to_degrees()),
            })
            .collect();
        let at = match quantity {
            Quantity::Point => axis,
            Quantity::Translation => history.drift.point_trends.len() + axis,
            Quantity::Rotation => history.drift.point_trends.len() + 3 + axis,
        };
        let trend = trends.get(at);
        let lines = trend.map_or_else(Vec::new, |trend| lines(&values, &history.drift.jumps, trend.slope));
        Series { values, stds, lines, is_drift: trend.and_then(|trend| trend.is_significant) }
    })
}

/// A line of one slope through each stretch between jumps, at the level of its median.
fn lines(values: &[[f64; 2]], jumps: &[usize], slope: f64) -> Vec<[[f64; 2]; 2]> {
    let starts = std::iter::once(0).chain(jumps.iter().copied());
    let ends = jumps.iter().copied().chain([values.len()]);
    starts
        .zip(ends)
        .filter_map(|(start, end)| {
            let stretch = values.get(start..end)?;
            let (first, last) = (stretch.first()?, stretch.last()?);
            let level = stats::median(&mut stretch.iter().map(|[t, y]| y - slope * t).collect::<Vec<f64>>());
            (last[0] > first[0]).then(|| [first[0], last[0]].map(|t| [t, slope.mul_add(t, level)]))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::lines;

    #[test]
    fn a_line_goes_through_each_stretch_between_jumps() {
        let values = [[0.0, 0.0], [1.0, 1.0], [2.0, 2.0], [3.0, 13.0], [4.0, 14.0], [5.0, 0.0]];
        let found = lines(&values, &[3, 5], 1.0);
        // A stretch of one calibration has no line.
        assert_eq!(found, [[[0.0, 0.0], [2.0, 2.0]], [[3.0, 13.0], [4.0, 14.0]]]);
    }
}
