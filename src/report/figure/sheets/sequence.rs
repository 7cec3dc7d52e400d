//! A camera's way through a sequence, as its images have it: in space, and over time.

use crate::geometry::Vec3;
use crate::report::evidence::TargetEvidence;
use crate::report::figure::ink::{Fill, Stroke};
use crate::report::figure::model::{Journey, Values};
use crate::report::figure::palette::{self, Marker, Rgb};
use crate::report::figure::plot::{Axis, Dash, Entry, Mark, Plot, Sign};
use crate::report::figure::{Extent, Figure};
use crate::text::figures as words;

use super::sheet::{HALF_PAGE, Sheet};

/// The figures of a sequence; none of a target that is none.
pub(super) fn figures(target: &TargetEvidence) -> Vec<Figure> {
    let Some(tracked) = target.measured.sequence() else { return Vec::new() };
    let journey = Journey::of(&tracked.sequence, tracked.records.iter());
    if journey.ways.tracked.is_empty() {
        return Vec::new();
    }
    vec![way(&journey), over_time(&journey)]
}

fn legend(has_truth: bool) -> Vec<Entry> {
    let mut legend = vec![Entry::new(Sign::Line(Dash::Solid), palette::FIT, words::FROM_IMAGES)];
    if has_truth {
        legend.push(Entry::new(Sign::Line(Dash::Dashed), palette::TEXT, words::TRUE_WAY));
    }
    legend
}

/// Titles of the axes across and up, and where a point lies on them.
type View<'a> = (&'a str, &'a str, &'a dyn Fn(&Vec3) -> [f64; 2]);
/// Values over time, and how their line is drawn.
type Curve<'a> = (&'a Values, Rgb, Dash);

/// From above, and from the side: the first camera's right, forward and up.
fn way(journey: &Journey) -> Figure {
    let ways = &journey.ways;
    let mut legend = legend(!ways.truth.is_empty());
    legend.push(Entry::new(Sign::Solid(Marker::Circle), palette::INLIER, words::FIRST_FRAME));
    let mut sheet = Sheet::new(250.0);
    let areas = sheet.legend_over_columns(&legend);
    let from_above = |point: &Vec3| [point.x, point.z];
    let from_the_side = |point: &Vec3| [point.z, -point.y];
    let views: [View<'_>; 2] =
        [(words::RIGHT_AXIS, words::FORWARD_AXIS, &from_above), (words::FORWARD_AXIS, words::UP_AXIS, &from_the_side)];
    for ((x_title, y_title, at), area) in views.into_iter().zip(areas) {
        let mut extent = Extent::NOTHING;
        for [x, y] in ways.tracked.iter().flatten().chain(&ways.truth).map(at) {
            extent.include(x, y);
        }
        let mut plot = Plot::new(Axis::new(x_title), Axis::new(y_title), extent);
        plot.has_equal_scales = true;
        for stretch in &ways.tracked {
            plot.mark(line(stretch.iter().map(at).collect(), palette::FIT, Dash::Solid));
        }
        plot.mark(line(ways.truth.iter().map(at).collect(), palette::TEXT, Dash::Dashed));
        plot.mark(Mark::Markers {
            points: ways.tracked.first().and_then(|stretch| stretch.first()).map(at).into_iter().collect(),
            shape: Marker::Circle,
            radius: 3.2,
            fill: Some(palette::INLIER),
            stroke: Stroke::new(0.5, Rgb::WHITE),
        });
        sheet.plot(&plot, &area);
    }
    sheet.figure("camera-way", words::CAMERA_WAY, words::CAMERA_WAY)
}

/// Way, heading and the points that the motion rests on.
fn over_time(journey: &Journey) -> Figure {
    let has_truth = !journey.true_distance_m.is_empty();
    let mut legend = legend(has_truth);
    legend.push(Entry::new(Sign::Line(Dash::Dotted), palette::TEXT_DIM, words::POINTS_MATCHED));
    legend.push(Entry::new(Sign::Line(Dash::Solid), palette::INLIER, words::POINTS_AGREEING));
    let curves: [(&str, Vec<Curve<'_>>); 3] = [
        (
            words::DISTANCE_AXIS,
            vec![
                (&journey.distance_m, palette::FIT, Dash::Solid),
                (&journey.true_distance_m, palette::TEXT, Dash::Dashed),
            ],
        ),
        (
            words::HEADING_AXIS,
            vec![
                (&journey.heading_deg, palette::FIT, Dash::Solid),
                (&journey.true_heading_deg, palette::TEXT, Dash::Dashed),
            ],
        ),
        (
            words::POINTS_AXIS,
            vec![(&journey.matches, palette::TEXT_DIM, Dash::Dotted), (&journey.inliers, palette::INLIER, Dash::Solid)],
        ),
    ];
    let last = curves.len() - 1;
    let plots: Vec<Plot> = curves
        .iter()
        .enumerate()
        .map(|(place, (y_title, curves))| {
            let mut extent = Extent::NOTHING;
            for time_s in &journey.times_s {
                extent.include(*time_s, 0.0);
            }
            for (time_s, value) in curves.iter().flat_map(|(values, _, _)| values.iter()) {
                extent.include(*time_s, value.unwrap_or(0.0));
            }
            let mut x = Axis::new(if place == last { words::TIME_AXIS } else { "" });
            x.is_labelled = place == last;
            let mut plot = Plot::new(x, Axis::new(*y_title), extent);
            for stretch_s in &journey.lost_s {
                plot.mark(Mark::Band { x: *stretch_s, fill: Fill::veil(palette::BAD, 0.12) });
            }
            for (values, color, dash) in curves {
                for run in runs(values) {
                    plot.mark(line(run, *color, *dash));
                }
            }
            plot
        })
        .collect();
    let mut sheet = Sheet::new(HALF_PAGE);
    let area = sheet.legend(&legend);
    let stacked: Vec<(f64, &Plot)> = plots.iter().map(|plot| (1.0, plot)).collect();
    sheet.stack(&stacked, &area);
    let title = words::motion_over_time(!journey.lost_s.is_empty());
    sheet.figure("camera-motion", title, title)
}

/// The values between the gaps.
fn runs(values: &Values) -> Vec<Vec<[f64; 2]>> {
    let pieces = values.split(|(_, value)| value.is_none());
    let known = |piece: &[(f64, Option<f64>)]| {
        piece.iter().filter_map(|(time_s, value)| Some([*time_s, (*value)?])).collect::<Vec<_>>()
    };
    pieces.map(known).filter(|piece| !piece.is_empty()).collect()
}

fn line(points: Vec<[f64; 2]>, color: Rgb, dash: Dash) -> Mark {
    Mark::Line { points, stroke: Stroke::new(1.2, color), dash }
}
