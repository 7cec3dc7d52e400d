//! The evidence behind what is wrong with a session, as the window plots it.

use crate::diagnose::{CurveAxis, Plot as Proof, StationBar};
use crate::report::evidence::TargetEvidence;
use crate::report::figure::ink::{Fill, Stroke};
use crate::report::figure::palette::{self, Marker};
use crate::report::figure::plot::{Axis, Dash, Entry, Filling, Mark, Plot, Sign};
use crate::report::figure::{Extent, Figure};
use crate::text::diagnosis as fault_words;
use crate::text::diagnosis_panel as shared;
use crate::text::typeset::{fixed, with_std};

use super::bars::with_accused;
use super::sheet::Sheet;

/// The most serious findings come first; more plots than this are no longer evidence but a list.
const MOST_FINDINGS: usize = 3;

/// The figures of findings.
pub(super) fn figures(target: &TargetEvidence) -> Vec<Figure> {
    let Some(diagnosis) = target.diagnosis() else { return Vec::new() };
    let proofs = diagnosis.findings.iter().filter_map(|finding| finding.evidence.plot.as_ref());
    let plots = proofs.filter_map(|proof| Some((proof, plot(proof)?))).take(MOST_FINDINGS).zip(1..);
    plots
        .map(|((proof, plot), number)| {
            let mut sheet = Sheet::new(190.0);
            let area = sheet.area();
            sheet.plot(&plot, &area);
            let title = fault_words::plot_title(proof, &target.session.target);
            sheet.figure(format!("finding-{number}"), title.clone(), title)
        })
        .collect()
}

/// Directions and ways to read the poses are told in words.
fn plot(proof: &Proof) -> Option<Plot> {
    let [x_title, y_title] = fault_words::plot_axes(proof);
    match proof {
        Proof::Stations(stations) => Some(stations_plot(stations, x_title, y_title)),
        Proof::Curve { axis, points, given, found, std } => Some(curve(
            Plot::new(Axis::new(x_title), Axis::new(y_title), Extent::NOTHING),
            *axis,
            points,
            [*given, *found, *std],
        )),
        Proof::Trend { points, line } => {
            let x = Axis { is_whole: true, ..Axis::new(x_title) };
            Some(trend(Plot::new(x, Axis::new(y_title), Extent::NOTHING), points, *line))
        }
        Proof::Steps(steps) => Some(travels(Plot::new(Axis::new(x_title), Axis::new(y_title), Extent::NOTHING), steps)),
        Proof::Readings(_) | Proof::Direction { .. } => None,
    }
}

fn stations_plot(stations: &[StationBar], x_title: &str, y_title: &str) -> Plot {
    let names = stations.iter().map(|station| station.label.clone()).collect();
    let bars: Vec<(f64, bool)> = stations.iter().map(|station| (station.error_mm, station.is_accused)).collect();
    let mut plot = with_accused(names, x_title, y_title, &bars);
    if stations.iter().any(|station| station.is_accused) {
        plot.legend = vec![
            Entry::new(Sign::Bar(Filling::Solid), palette::INLIER, shared::OTHERS),
            Entry::new(Sign::Bar(Filling::Hatched), palette::BAD, shared::ACCUSED),
        ];
    }
    plot
}

fn curve(mut plot: Plot, axis: CurveAxis, points: &[[f64; 2]], [given, found, std]: [f64; 3]) -> Plot {
    let unit = match axis {
        CurveAxis::RadiusMm => " mm",
        CurveAxis::ProfileScale => "",
    };
    plot.legend = vec![
        Entry::new(Sign::Line(Dash::Dashed), palette::TEXT_DIM, shared::given_value(&(fixed(given, 3) + unit))),
        Entry::new(Sign::Line(Dash::Solid), palette::FIT, shared::found_value(&(with_std(found, std) + unit))),
    ];
    for [value, rms_mm] in points {
        plot.view.include(*value, *rms_mm);
        plot.view.include(*value, 0.0);
    }
    for value in [given, found] {
        plot.view.include(value, 0.0);
    }
    plot.mark(Mark::Band { x: [found - std, found + std], fill: Fill::veil(palette::FIT, 0.25) });
    let upright = |at: f64, color, dash| Mark::Across { at, is_upright: true, stroke: Stroke::new(0.9, color), dash };
    plot.mark(upright(found, palette::FIT, Dash::Solid));
    plot.mark(upright(given, palette::TEXT_DIM, Dash::Dashed));
    plot.mark(Mark::Line { points: points.to_vec(), stroke: Stroke::new(1.1, palette::INLIER), dash: Dash::Solid });
    plot.mark(dots(points.to_vec()));
    plot
}

fn trend(mut plot: Plot, points: &[[f64; 2]], line: [f64; 2]) -> Plot {
    plot.legend = vec![
        Entry::new(Sign::Solid(Marker::Circle), palette::INLIER, shared::STATION_AXIS),
        Entry::new(Sign::Line(Dash::Solid), palette::BAD, shared::TREND_LINE),
    ];
    for [number, shift_mm] in points {
        plot.view.include(*number, *shift_mm);
    }
    let [first, last] = plot.view.x;
    plot.view.include(first, line[0]);
    plot.view.include(last, line[1]);
    let ends = vec![[first, line[0]], [last, line[1]]];
    plot.mark(Mark::Line { points: ends, stroke: Stroke::new(1.1, palette::BAD), dash: Dash::Solid });
    plot.mark(dots(points.to_vec()));
    plot
}

fn travels(mut plot: Plot, steps: &[[f64; 2]]) -> Plot {
    plot.legend = vec![
        Entry::new(Sign::Hollow(Marker::Circle), palette::INLIER, shared::STEP),
        Entry::new(Sign::Line(Dash::Dashed), palette::TEXT_DIM, shared::ONE_TO_ONE),
    ];
    for [commanded_mm, moved_mm] in steps {
        plot.view.include(*commanded_mm, *moved_mm);
        plot.view.include(*commanded_mm, *commanded_mm);
    }
    plot.has_equal_scales = true;
    let ends = plot.view.x.map(|end| [end, end]).to_vec();
    plot.mark(Mark::Line { points: ends, stroke: Stroke::new(0.9, palette::TEXT_DIM), dash: Dash::Dashed });
    plot.mark(Mark::Dots { points: steps.to_vec(), radius: 1.8, color: palette::INLIER, is_hollow: true });
    plot
}

const fn dots(points: Vec<[f64; 2]>) -> Mark {
    Mark::Dots { points, radius: 1.8, color: palette::INLIER, is_hollow: false }
}
