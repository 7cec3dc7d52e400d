//! Bars side by side: errors of stations, and histograms.

use crate::report::figure::Extent;
use crate::report::figure::frame::whole;
use crate::report::figure::ink::Stroke;
use crate::report::figure::palette::{self, CalibrationLook, Marker, Rgb};
use crate::report::figure::plot::{Axis, Dash, Entry, Filling, Mark, Plot, Sign};
use crate::verify::Histogram;

/// Part of a place that its bars take together.
const GROUP_WIDTH: f64 = 0.66;
/// Part of a bin that its bars take.
const BIN_PART: f64 = 0.84;
/// Bars narrower than this part of a place have no markers at their ends.
const LEAST_MARKED: f64 = 0.1;

/// A row of bars of one kind.
pub(super) struct Series {
    pub color: Rgb,
    pub filling: Filling,
    /// At the end of each bar, so that it can be told without colour.
    pub marker: Option<Marker>,
    /// One a place; a place without a value has no bar.
    pub values: Vec<Option<f64>>,
}

/// Bars over names: those of a place stand side by side.
pub(super) fn grouped(names: Vec<String>, x_title: &str, y_title: &str, series: &[Series]) -> Plot {
    let mut extent = Extent { x: [-0.6, whole(names.len()) - 0.4], y: [0.0, 0.0] };
    let values = || series.iter().flat_map(|series| series.values.iter().flatten().copied());
    for value in values().filter(|value| value.is_finite()) {
        extent.include(0.0, value);
    }
    if extent.y[1] <= extent.y[0] {
        extent.y[1] = 0.01;
    }
    let room = (extent.y[1] - extent.y[0]) * 0.08;
    extent.y = [if extent.y[0] < 0.0 { extent.y[0] - room } else { 0.0 }, extent.y[1] + room];
    let mut plot = Plot::new(Axis::named(x_title, names), Axis::new(y_title), extent);
    plot.is_view_final = true;
    let width = GROUP_WIDTH / whole(series.len().max(1));
    for (series_idx, series) in series.iter().enumerate() {
        let mut ends = Vec::new();
        for (place, value) in series.values.iter().enumerate() {
            let Some(y) = value.filter(|value| value.is_finite()) else { continue };
            let left = whole(place) - GROUP_WIDTH / 2.0 + whole(series_idx) * width;
            let x = [left + 0.04 * width, left + 0.96 * width];
            plot.mark(Mark::Bar { x, y, color: series.color, filling: series.filling });
            ends.push([left + width / 2.0, y]);
        }
        if let Some(shape) = series.marker.filter(|_| width >= LEAST_MARKED) {
            let stroke = Stroke::new(0.5, Rgb::WHITE);
            plot.mark(Mark::Markers { points: ends, shape, radius: 2.2, fill: Some(series.color), stroke });
        }
    }
    plot.level(0.0, Stroke::new(0.6, palette::TEXT_DIM), Dash::Solid);
    plot
}

/// Distances of one kind, for a histogram.
pub(super) struct Distances {
    pub color: Rgb,
    pub filling: Filling,
    pub distances_mm: Vec<f64>,
}

/// Distances of several kinds as one histogram, their bars side by side, with one width of bins for all.
pub(super) fn histogram(x_title: &str, y_title: &str, all: &[Distances]) -> Plot {
    let finite = |kind: &Distances| -> Vec<f64> {
        kind.distances_mm.iter().copied().filter(|distance| distance.is_finite()).collect()
    };
    let distances: Vec<Vec<f64>> = all.iter().map(finite).collect();
    let max_mm = distances.iter().flatten().copied().fold(0.0, f64::max);
    let most = distances.iter().map(Vec::len).max().unwrap_or_default();
    let width_mm = Histogram::round_width_mm(max_mm, most);
    let histograms: Vec<Histogram> = distances.iter().map(|kind| Histogram::of(kind, width_mm)).collect();
    let num_bins = histograms.iter().map(|histogram| histogram.counts.len()).max().unwrap_or(1).max(1);
    let highest = histograms.iter().flat_map(|histogram| histogram.counts.iter().copied()).max().unwrap_or(1);
    let extent = Extent { x: [0.0, whole(num_bins) * width_mm], y: [0.0, whole(highest.max(2)) * 1.06] };
    let mut plot = Plot::new(Axis::new(x_title), Axis { is_whole: true, ..Axis::new(y_title) }, extent);
    plot.is_view_final = true;
    let bar_mm = BIN_PART * width_mm / whole(all.len().max(1));
    for (kind_idx, (kind, histogram)) in all.iter().zip(&histograms).enumerate() {
        for (bin, count) in histogram.counts.iter().copied().enumerate().filter(|(_, count)| *count > 0) {
            let left = (whole(bin) + (1.0 - BIN_PART) / 2.0) * width_mm + whole(kind_idx) * bar_mm;
            let x = [left + 0.03 * bar_mm, left + 0.97 * bar_mm];
            plot.mark(Mark::Bar { x, y: whole(count), color: kind.color, filling: kind.filling });
        }
    }
    plot.level(0.0, Stroke::new(0.6, palette::TEXT_DIM), Dash::Solid);
    plot
}

/// How bars of a calibration are filled: solid on the first target, fainter with each further one.
pub(super) const fn filling_of(look: &CalibrationLook) -> Filling {
    match look.further {
        None => Filling::Solid,
        Some(1) => Filling::Faint,
        Some(_) => Filling::Hollow,
    }
}

/// A calibration in a legend.
pub(super) fn entry_of(look: &CalibrationLook, name: String) -> Entry {
    let sign = if look.further.is_some() { Sign::Hollow(look.marker) } else { Sign::Solid(look.marker) };
    Entry::new(sign, look.color, name)
}
