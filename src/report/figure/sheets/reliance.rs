//! How far the result can be relied on: what each station means for it, two halves, and the distribution of its residuals.

use crate::calibrate::validation::{Influence, Normality, SplitHalf};
use crate::diagnose::Plot as Evidence;
use crate::report::evidence::TargetEvidence;
use crate::report::figure::frame::whole;
use crate::report::figure::ink::Stroke;
use crate::report::figure::model::station_bars;
use crate::report::figure::palette::{self, Marker};
use crate::report::figure::plot::{Axis, Dash, Entry, Filling, Mark, Plot, Sign};
use crate::report::figure::{Extent, Figure};
use crate::text::diagnosis_panel as shared;
use crate::text::figures as words;
use crate::text::typeset::std_text;

use super::bars::{grouped, plain, with_accused};
use super::sheet::{HALF_PAGE, Sheet};

/// Residuals beyond these are rare, and hardly chance.
const RARE: [f64; 2] = [2.0, 3.0];

/// The figures of validation.
pub(super) fn figures(target: &TargetEvidence) -> Vec<Figure> {
    let Some(validation) = target.diagnosis().and_then(|diagnosis| diagnosis.validation.as_ref()) else {
        return Vec::new();
    };
    let left_out = target.best().and_then(|solution| station_bars(solution, None));
    let influence = influence(&validation.influence, left_out.as_ref());
    let halves = halves(validation.split_half.as_ref(), validation.normality.as_ref());
    influence.into_iter().chain(halves).collect()
}

/// What leaving out each station shows, and what it moves.
fn influence(stations: &[Influence], left_out: Option<&Evidence>) -> Option<Figure> {
    if stations.is_empty() {
        return None;
    }
    let names: Vec<String> = stations.iter().map(|station| station.label.clone()).collect();
    let mut plots = Vec::new();
    if let Some(Evidence::Stations(bars)) = left_out {
        let names = bars.iter().map(|bar| bar.label.clone()).collect();
        let values = bars.iter().map(|bar| Some(bar.error_mm)).collect();
        let mut plot = grouped(names, "", shared::OFF_AXIS, &[plain(values)]);
        plot.heading = Some(words::LEFT_OUT_BEST.to_owned());
        plots.push(plot);
    }
    let is_rare = |station: &&Influence| station.studentised_residual.abs() > RARE[1];
    let bars: Vec<(f64, bool)> =
        stations.iter().map(|station| (station.studentised_residual, is_rare(&station))).collect();
    let mut residuals = with_accused(names.clone(), "", shared::STUDENTISED_AXIS, &bars);
    for level in RARE {
        residuals.level(level, Stroke::new(0.8, palette::WARN), Dash::Dashed);
        residuals.view.y[1] = residuals.view.y[1].max(level * 1.12);
    }
    residuals.heading = Some(words::STUDENTISED.to_owned());
    if stations.iter().any(|station| is_rare(&station)) {
        let accused = Entry::new(Sign::Bar(Filling::Hatched), palette::BAD, words::HARDLY_CHANCE);
        residuals.legend.push(accused);
    }
    plots.push(residuals);
    let moves = stations.iter().map(|station| Some(station.moves_workspace_point_mm)).collect();
    let mut moves = grouped(names, shared::STATION_AXIS, shared::MOVES_AXIS, &[plain(moves)]);
    moves.heading = Some(words::MOVES.to_owned());
    plots.push(moves);
    let mut sheet = Sheet::new((whole(plots.len()) * 122.0 + 14.0).min(HALF_PAGE));
    let area = sheet.area();
    let stacked: Vec<(f64, &Plot)> = plots.iter().map(|plot| (1.0, plot)).collect();
    sheet.stack(&stacked, &area);
    Some(sheet.figure("influence", words::INFLUENCE_TITLE, words::INFLUENCE_TITLE))
}

/// Two halves of the stations beside the distribution of the residuals.
fn halves(split: Option<&SplitHalf>, normality: Option<&Normality>) -> Option<Figure> {
    let plots: Vec<Plot> = split.map(split_plot).into_iter().chain(normality.map(normality_plot)).collect();
    if plots.is_empty() {
        return None;
    }
    let mut sheet = Sheet::new(210.0);
    let areas = sheet.legend_over_columns(&[]);
    for (plot, area) in plots.iter().zip(areas) {
        sheet.plot(plot, &area);
    }
    let title = words::halves_title(split.is_some(), normality.is_some());
    let alt = match split {
        Some(split) => words::halves_alt(title, &std_text(split.median_mm), &std_text(split.expected_mm)),
        None => title.to_owned(),
    };
    Some(sheet.figure("halves", title, alt))
}

fn split_plot(split: &SplitHalf) -> Plot {
    let points: Vec<[f64; 2]> =
        split.disagreements_mm.iter().zip(1_u32..).map(|(mm, rank)| [f64::from(rank), *mm]).collect();
    let mut extent = Extent::NOTHING;
    extent.include(0.0, 0.0);
    extent.include(0.0, split.expected_mm);
    for [rank, apart_mm] in &points {
        extent.include(*rank, *apart_mm);
    }
    let mut plot = Plot::new(Axis::new(shared::SPLIT_AXIS), Axis::new(shared::APART_AXIS), extent);
    plot.heading = Some(shared::HALVES.to_owned());
    plot.legend = vec![
        Entry::new(Sign::Line(Dash::Solid), palette::TEXT, shared::median(&std_text(split.median_mm))),
        Entry::new(Sign::Line(Dash::Dashed), palette::WARN, shared::expected(&std_text(split.expected_mm))),
    ];
    plot.level(split.median_mm, Stroke::new(0.9, palette::TEXT), Dash::Solid);
    plot.level(split.expected_mm, Stroke::new(0.9, palette::WARN), Dash::Dashed);
    plot.mark(dots(points));
    plot
}

fn normality_plot(normality: &Normality) -> Plot {
    let mut extent = Extent::NOTHING;
    for [expected, found] in &normality.quantiles {
        extent.include(*expected, *found);
        extent.include(*expected, *expected);
    }
    let [low, high] = extent.x;
    let mut plot = Plot::new(Axis::new(shared::QUANTILE_AXIS), Axis::new(shared::RESIDUAL_AXIS), extent);
    plot.heading = Some(words::normality_heading(normality.p_value));
    plot.legend = vec![
        Entry::new(Sign::Solid(Marker::Circle), palette::INLIER, words::RESIDUALS),
        Entry::new(Sign::Line(Dash::Dashed), palette::TEXT_DIM, words::NORMAL_LINE),
    ];
    let points = vec![[low, low], [high, high]];
    plot.mark(Mark::Line { points, stroke: Stroke::new(0.9, palette::TEXT_DIM), dash: Dash::Dashed });
    plot.mark(dots(normality.quantiles.clone()));
    plot
}

const fn dots(points: Vec<[f64; 2]>) -> Mark {
    Mark::Dots { points, radius: 1.4, color: palette::INLIER, is_hollow: false }
}
