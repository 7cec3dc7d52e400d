//! What calibrations are worth on other data: distances to lines and plane, a known point, other targets.

use crate::calibrate::Problem;
use crate::geometry::Vec3;
use crate::report::figure::frame::whole;
use crate::report::figure::ink::Stroke;
use crate::report::figure::palette::{self, CalibrationLook, Marker, Rgb, calibration_look};
use crate::report::figure::plot::{Axis, Dash, Entry, Mark, Plot, Sign};
use crate::report::figure::{Extent, Figure};
use crate::text::figures as words;
use crate::text::verify as shared;
use crate::verify::{Distances, EdgePoint, Measurement, TargetEvidence, Verification};

use super::bars::{self, entry_of, filling_of, histogram};
use super::sheet::Sheet;

/// A calibration whose distances are so many times those of the best would squeeze all others into one bar.
const FAR_OFF: f64 = 8.0;
/// More calibrations than this in one plot cannot be told apart.
const MOST_SHOWN: usize = 4;
/// More measurements than this have no room for a marker each.
const MOST_MEASUREMENTS: usize = 120;

/// The figures of verification.
pub(super) fn figures(verification: &Verification) -> Vec<Figure> {
    let looks: Vec<Look> = verification
        .calibrations
        .iter()
        .map(|calibration| Look {
            look: calibration_look(&calibration.origin),
            name: shared::calibration_name(&calibration.origin, verification),
        })
        .collect();
    let mut figures = Vec::new();
    for (target, number) in verification.targets.iter().zip(1..) {
        let suffix = if verification.targets.len() > 1 { format!("-{number}") } else { String::new() };
        let found = match target.problem {
            Problem::Plate(_) => distances(target, &looks, &suffix),
            Problem::Ball(_) | Problem::Point(_) | Problem::Motion(_) | Problem::Streams(_) => {
                stability(target, &looks, &suffix)
            }
        };
        figures.extend(found);
    }
    figures.extend(cross_target(verification, &looks));
    figures
}

/// How a calibration is shown.
struct Look {
    look: CalibrationLook,
    name: String,
}

impl Look {
    fn entry(&self) -> Entry {
        entry_of(&self.look, self.name.clone())
    }

    fn markers(&self, points: Vec<[f64; 2]>) -> Mark {
        let (fill, stroke) = match self.look.further {
            None => (Some(self.look.color), Stroke::new(0.5, Rgb::WHITE)),
            Some(_) => (Some(Rgb::WHITE), Stroke::new(0.9, self.look.color)),
        };
        Mark::Markers { points, shape: self.look.marker, radius: 2.6, fill, stroke }
    }
}

/// The items whose size is not far above the least, the best few of them in their order; and those that are left out.
fn near<T>(items: Vec<(f64, T)>) -> (Vec<T>, Vec<T>) {
    let least = items.iter().map(|(size, _)| *size).filter(|size| size.is_finite()).fold(f64::INFINITY, f64::min);
    let mut sizes: Vec<f64> = items.iter().map(|(size, _)| *size).filter(|size| *size <= least * FAR_OFF).collect();
    sizes.sort_by(f64::total_cmp);
    let limit = sizes.get(MOST_SHOWN - 1).or(sizes.last()).copied().unwrap_or(f64::INFINITY);
    let (mut kept, mut left_out) = (Vec::new(), Vec::new());
    for (size, item) in items {
        if size <= limit && kept.len() < MOST_SHOWN { &mut kept } else { &mut left_out }.push(item);
    }
    (kept, left_out)
}

fn distances(target: &TargetEvidence, looks: &[Look], suffix: &str) -> Option<Figure> {
    let found: Vec<(f64, (&Look, &Distances))> = looks
        .iter()
        .zip(&target.rows)
        .filter_map(|(look, row)| {
            let distances = row.as_ref().ok()?.distances()?;
            Some((distances.to_line.rms_mm.max(distances.to_plane.rms_mm), (look, distances)))
        })
        .collect();
    let (shown, left_out) = near(found);
    if shown.is_empty() {
        return None;
    }
    let legend: Vec<Entry> = shown.iter().map(|(look, _)| look.entry()).collect();
    let mut sheet = Sheet::new(220.0);
    let areas = sheet.legend_over_columns(&legend);
    let to_line: fn(&EdgePoint) -> f64 = |point| point.to_line_mm;
    let to_plane: fn(&EdgePoint) -> f64 = |point| point.to_plane_mm;
    let kinds =
        [(shared::LINE_HISTOGRAM, shared::LINE_AXIS, to_line), (shared::PLANE_HISTOGRAM, shared::PLANE_AXIS, to_plane)];
    for ((heading, x_title, distance), area) in kinds.into_iter().zip(areas) {
        let all: Vec<bars::Distances> = shown
            .iter()
            .map(|(look, distances)| bars::Distances {
                color: look.look.color,
                filling: filling_of(&look.look),
                marker: Some(look.look.marker),
                mm: distances.points.iter().map(distance).collect(),
            })
            .collect();
        let mut plot = histogram(x_title, shared::POINTS_AXIS, &all);
        plot.heading = Some(heading.to_owned());
        sheet.plot(&plot, &area);
    }
    let left_out: Vec<&str> = left_out.iter().map(|(look, _)| look.name.as_str()).collect();
    let title = words::distances_title(&target.name, &left_out);
    Some(sheet.figure(format!("distances{suffix}"), title.clone(), title))
}

fn stability(target: &TargetEvidence, looks: &[Look], suffix: &str) -> Option<Figure> {
    let found: Vec<_> = looks
        .iter()
        .zip(&target.rows)
        .filter_map(|(look, row)| {
            let (measurements, stability) = row.as_ref().ok()?.stability()?;
            let reach = stability.deviations_mm.iter().map(Vec3::norm).fold(0.0, f64::max);
            Some((reach, (look, measurements, stability)))
        })
        .collect();
    let (shown, left_out) = near(found);
    let (_, measurements, first) = shown.first()?;
    if measurements.len() > MOST_MEASUREMENTS {
        return None;
    }
    let names: Vec<String> = measurements.iter().map(Measurement::name).collect();
    let mut reach_mm = 0.001_f64;
    for (_, _, stability) in &shown {
        let largest = stability.deviations_mm.iter().map(Vec3::amax);
        reach_mm = largest
            .chain([(stability.mean_mm.abs() + stability.three_std_mm()).amax()])
            .filter(|size| size.is_finite())
            .fold(reach_mm, f64::max);
    }
    let legend: Vec<Entry> = shown.iter().map(|(look, ..)| look.entry()).collect();
    // The limits stand at the right, in a place of their own.
    let limits = whole(names.len());
    let names: Vec<String> = names.into_iter().chain([words::THREE_DELTA.to_owned()]).collect();
    let plots: Vec<Plot> = ["Δx / mm", "Δy / mm", "Δz / mm"]
        .into_iter()
        .enumerate()
        .map(|(axis, y_title)| {
            let extent = Extent { x: [-0.6, whole(names.len()) - 0.4], y: [-reach_mm * 1.1, reach_mm * 1.1] };
            let x_title = if axis == 2 { words::MEASUREMENT_AXIS } else { "" };
            let mut plot = Plot::new(Axis::named(x_title, names.clone()), Axis::new(y_title), extent);
            plot.is_view_final = true;
            plot.x.is_labelled = axis == 2;
            plot.level(0.0, Stroke::new(0.6, palette::TEXT_DIM), Dash::Solid);
            let stroke = Stroke::new(0.5, palette::UNUSED);
            plot.mark(Mark::Across { at: limits - 0.5, is_upright: true, stroke, dash: Dash::Solid });
            for (place, (look, _, stability)) in shown.iter().enumerate() {
                // Side by side, so that none covers another.
                let aside = (whole(place) - whole(shown.len() - 1) / 2.0) * 0.5 / whole(shown.len());
                let points = stability.deviations_mm.iter().enumerate();
                plot.mark(look.markers(points.map(|(idx, deviation)| [whole(idx) + aside, deviation[axis]]).collect()));
                let (at, std) = ([limits + aside, stability.mean_mm[axis]], stability.three_std_mm()[axis]);
                plot.mark(Mark::ErrorBar { at, std, stroke: Stroke::new(1.0, look.look.color) });
                plot.mark(look.markers(vec![at]));
            }
            plot
        })
        .collect();
    let mut sheet = Sheet::new(310.0);
    let area = sheet.legend(&legend);
    sheet.stack(&[(1.0, &plots[0]), (1.0, &plots[1]), (1.18, &plots[2])], &area);
    let left_out: Vec<&str> = left_out.iter().map(|(look, ..)| look.name.as_str()).collect();
    let title = words::stability_title(&target.name, first.is_touched, &left_out);
    Some(sheet.figure(format!("stability{suffix}"), title.clone(), title))
}

/// Markers of targets, in the order of these.
const TARGET_MARKERS: [Marker; 5] = [Marker::Circle, Marker::Square, Marker::Up, Marker::Diamond, Marker::Down];
/// Their colours.
const TARGET_COLORS: [Rgb; 5] =
    [palette::INLIER, Rgb(0x00, 0x9e, 0x73), palette::FIT, Rgb(0xcc, 0x79, 0xa7), Rgb(0x7f, 0x7f, 0x7f)];

/// The error of every calibration on every target: a row a calibration, a marker a target.
fn cross_target(verification: &Verification, looks: &[Look]) -> Option<Figure> {
    if verification.targets.len() < 2 || looks.is_empty() {
        return None;
    }
    let rms_mm = |calibration: usize, target: usize| {
        let rms_mm = verification.cell(calibration, target)?.as_ref().ok()?.figures.rms_mm;
        (rms_mm.is_finite() && rms_mm > 0.0).then_some(rms_mm)
    };
    let mut extent = Extent { y: [-0.6, whole(looks.len()) - 0.4], ..Extent::NOTHING };
    for (calibration, target) in (0..looks.len())
        .flat_map(|calibration| (0..verification.targets.len()).map(move |target| (calibration, target)))
    {
        if let Some(rms_mm) = rms_mm(calibration, target) {
            extent.include(rms_mm.log10(), 0.0);
        }
    }
    if !(extent.x[0].is_finite() && extent.x[1].is_finite()) {
        return None;
    }
    // Half a decade at least, or there is no mark to read against.
    extent.x = [extent.x[0] - 0.12, extent.x[1].max(extent.x[0] + 0.6) + 0.12];
    let x = Axis { is_logarithmic: true, ..Axis::new(words::RMS_AXIS) };
    let names = looks.iter().map(|look| look.name.clone()).collect();
    let mut plot = Plot::new(x, Axis::named("", names), extent);
    plot.is_view_final = true;
    plot.inverts_y = true;
    for row in 0..looks.len() {
        plot.level(whole(row), Stroke::new(0.5, palette::HAIRLINE), Dash::Solid);
    }
    for (target, evidence) in verification.targets.iter().enumerate() {
        let (shape, color) = (TARGET_MARKERS[target % 5], TARGET_COLORS[target % 5]);
        for own in [false, true] {
            let rows = (0..looks.len()).filter(|row| verification.has_seen(*row, target) == own);
            let points: Vec<[f64; 2]> =
                rows.filter_map(|row| Some([rms_mm(row, target)?.log10(), whole(row)])).collect();
            let fill = Some(if own { Rgb::WHITE } else { color });
            plot.mark(Mark::Markers { points, shape, radius: 3.2, fill, stroke: Stroke::new(1.0, color) });
        }
        plot.legend.push(Entry::new(Sign::Solid(shape), color, words::on_target(&evidence.name)));
    }
    plot.legend.push(Entry::new(Sign::Hollow(Marker::Circle), palette::TEXT_DIM, words::OWN_DATA));
    let mut sheet = Sheet::new(whole(looks.len()).mul_add(17.0, 52.0));
    let area = sheet.area();
    sheet.plot(&plot, &area);
    Some(sheet.figure("cross-target", words::CROSS_TARGET_TITLE, words::CROSS_TARGET_TITLE))
}
