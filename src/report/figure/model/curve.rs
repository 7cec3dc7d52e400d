//! What is drawn of a radius against the step; the window and the figures share it.

use crate::calibrate::{Method, MethodResult, Sweep, SweepPoint, solution_of};
use crate::report::figure::Extent;

/// The least travel in view, mm.
const LEAST_STEPS_MM: f64 = 1.0;

/// Where a fitted curve has its peak: l² = R² − c (travel − peak)².
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Peak {
    /// The peak along the travel, mm.
    pub travel_mm: f64,
    /// Its σ, mm.
    pub std_mm: f64,
    /// The factor c: 1 for a travel along the laser's normal.
    pub curvature: f64,
}

impl Peak {
    /// The radius of the section at a place of the travel, mm; 0 beyond the ball.
    #[must_use]
    pub fn section_radius_mm(&self, travel_mm: f64, ball_radius_mm: f64) -> f64 {
        let offset_mm = travel_mm - self.travel_mm;
        (ball_radius_mm * ball_radius_mm - self.curvature * offset_mm * offset_mm).max(0.0).sqrt()
    }
}

/// The radius against the step as it is drawn, of an evaluated sweep or of a search under way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Curve<'a> {
    /// The steps with an arc.
    pub points: &'a [SweepPoint],
    /// The curve through them, once there is one.
    pub peak: Option<Peak>,
    /// Where the published rule stops.
    pub published_stop_mm: Option<f64>,
}

impl<'a> Curve<'a> {
    /// The curve of an evaluated sweep.
    #[must_use]
    pub fn of(sweep: &'a Sweep) -> Self {
        Self {
            points: &sweep.points,
            peak: Some(Peak { travel_mm: sweep.peak_mm, std_mm: sweep.peak_std_mm, curvature: 1.0 }),
            published_stop_mm: Some(sweep.published_stop_mm),
        }
    }
}

/// The fitted curve as points to draw; empty beyond the ball.
#[must_use]
pub fn curve_points(peak: &Peak, ball_radius_mm: f64, travel_mm: [f64; 2]) -> Vec<[f64; 2]> {
    const NUM_POINTS: u32 = 160;
    (0..=NUM_POINTS)
        .filter_map(|idx| {
            let travel = travel_mm[0] + (travel_mm[1] - travel_mm[0]) * f64::from(idx) / f64::from(NUM_POINTS);
            let radius = peak.section_radius_mm(travel, ball_radius_mm);
            (radius > 0.0).then_some([travel, radius])
        })
        .collect()
}

/// What a plot of a curve shows: its steps, the line l = R, and the peak unless that is far beyond the steps.
#[must_use]
pub fn curve_extent(shown: &Curve<'_>, ball_radius_mm: f64) -> Extent {
    let mut extent = Extent::NOTHING;
    for point in shown.points {
        extent.include(point.travel_mm, point.section_radius_mm);
    }
    let steps = extent.x[1] - extent.x[0];
    let near = extent.x[0] - steps..=extent.x[1] + steps;
    // A peak far beyond the steps would squeeze them into a corner.
    if let Some(peak) = shown.peak.filter(|peak| near.contains(&peak.travel_mm)) {
        extent.include(peak.travel_mm, ball_radius_mm);
    }
    if let Some(stop_mm) = shown.published_stop_mm {
        extent.include(stop_mm, ball_radius_mm);
    }
    // A search that has just begun: the line that it climbs to is in view, and a step has some width.
    extent.include(extent.x[0], ball_radius_mm);
    if steps < LEAST_STEPS_MM {
        extent.include(extent.x[0] + LEAST_STEPS_MM, ball_radius_mm);
    }
    // Room for the label above the line l = R, and for the published stop below the curve.
    let height = (extent.y[1] - extent.y[0]).max(ball_radius_mm * 1e-3);
    extent.include(extent.x[0], extent.y[1] + height * 0.08);
    extent
}

/// Room for what the curve leaves of the radii, µm.
#[must_use]
pub fn residual_range(points: &[SweepPoint]) -> [f64; 2] {
    let largest =
        points.iter().map(|point| (point.residual_mm.abs() + point.section_radius_std_mm) * 1000.0).fold(1.0, f64::max);
    [-largest * 1.1, largest * 1.1]
}

/// The evaluated sweep of a station: that of the whole curve, else that of the published stop.
#[must_use]
pub fn sweep_of(results: &[MethodResult], station_idx: usize) -> Option<(Method, &Sweep)> {
    [Method::BallMaxArc, Method::BallMaxArcStep].into_iter().find_map(|method| {
        let stations = &solution_of(results, method)?.stations;
        let station = stations.iter().find(|station| station.station_idx == station_idx)?;
        station.sweep.as_ref().map(|sweep| (method, sweep))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curve_ends_where_the_ball_does() {
        let peak = Peak { travel_mm: 5.0, std_mm: 0.01, curvature: 1.0 };
        let points = curve_points(&peak, 10.0, [-10.0, 20.0]);
        assert!(points.iter().all(|[travel, radius]| (travel - 5.0).abs() <= 10.0 && *radius <= 10.0));
        let top = points.iter().map(|[_, radius]| *radius).fold(0.0, f64::max);
        assert!(top > 9.99);
    }
}
