//! The methods side by side: the errors of all stations, and where each method finds the target.

use crate::calibrate::Method;
use crate::report::comparison::{Comparison, ErrorReference, MethodTable};
use crate::report::evidence::TargetEvidence;
use crate::report::figure::ink::{Fill, Stroke};
use crate::report::figure::palette::{self, Rgb, method_color, method_marker};
use crate::report::figure::plot::{Axis, Dash, Entry, Filling, Mark, Plot, Sign, ellipse};
use crate::report::figure::{Extent, Figure};
use crate::session::Target;
use crate::text::compare as shared;
use crate::text::figures as words;
use crate::text::method_name;

use super::bars::{Series, grouped};
use super::sheet::Sheet;

/// The figures of the comparison.
pub(super) fn figures(target: &TargetEvidence) -> Vec<Figure> {
    let model = Comparison::new(&target.session, target.results());
    let tables: Vec<(Method, &MethodTable)> = model
        .columns
        .iter()
        .filter_map(|column| Some((column.method, column.outcome.as_ref().ok()?)))
        .filter(|(_, table)| table.used().next().is_some())
        .collect();
    if tables.is_empty() {
        return Vec::new();
    }
    // As in the window, the published stop stands in the bars only: it would squeeze the others into one point.
    let others: Vec<(Method, &MethodTable)> =
        tables.iter().copied().filter(|(method, _)| *method != Method::BallMaxArcStep).collect();
    errors(&model.target, &tables).into_iter().chain(scatter(&model.target, &others)).collect()
}

fn legend(tables: &[(Method, &MethodTable)]) -> Vec<Entry> {
    let entry = |(method, _): &(Method, _)| {
        Entry::new(Sign::Solid(method_marker(*method)), method_color(*method), method_name(*method))
    };
    tables.iter().map(entry).collect()
}

/// The errors that the other stations see, where there are enough of these, above those in sample.
fn errors(target: &Target, tables: &[(Method, &MethodTable)]) -> Option<Figure> {
    let (_, first) = tables.first()?;
    let names: Vec<String> = first.rows.iter().map(|row| row.label.clone()).collect();
    let plot = |error_mm: &dyn Fn(&MethodTable, usize) -> Option<f64>, heading: &str| {
        let series: Vec<Series> = tables
            .iter()
            .map(|(method, table)| Series {
                color: method_color(*method),
                filling: Filling::Solid,
                marker: Some(method_marker(*method)),
                values: (0..names.len()).map(|row| error_mm(table, row)).collect(),
            })
            .collect();
        let has_values = series.iter().any(|series| series.values.iter().any(Option::is_some));
        let mut plot = grouped(names.clone(), "", shared::ERROR_AXIS, &series);
        plot.heading = Some(heading.to_owned());
        has_values.then_some(plot)
    };
    let left_out = plot(&|table, row| table.rows.get(row)?.used.as_ref()?.leave_one_out_mm, words::left_out(target));
    let in_sample = plot(
        &|table, row| Some(table.rows.get(row)?.used.as_ref()?.error_mm(ErrorReference::Mean).norm()),
        words::in_sample(target),
    );
    let mut plots: Vec<Plot> = left_out.into_iter().chain(in_sample).collect();
    shared::STATION_AXIS.clone_into(&mut plots.last_mut()?.x.title);
    let mut sheet = Sheet::new(if plots.len() > 1 { 290.0 } else { 170.0 });
    let area = sheet.legend(&legend(tables));
    let stacked: Vec<(f64, &Plot)> = plots.iter().map(|plot| (1.0, plot)).collect();
    sheet.stack(&stacked, &area);
    let title = words::errors_title(target);
    let largest = |table: &MethodTable| {
        table.used().map(|(_, used)| used.error_mm(ErrorReference::Mean).norm()).fold(0.0, f64::max)
    };
    let worst = tables.iter().map(|(method, table)| (*method, largest(table)));
    Some(sheet.figure("errors", title, words::errors_alt(target, title, worst)))
}

/// Where the stations find the target, from two sides, with 1σ ellipses.
fn scatter(target: &Target, tables: &[(Method, &MethodTable)]) -> Option<Figure> {
    // One reach for both views, so that a millimetre is equally long in both.
    let points = tables.iter().flat_map(|(_, table)| [0, 1].into_iter().flat_map(|plot| table.scatter(plot)));
    let reach = points.map(|(_, [across, up])| across.abs().max(up.abs())).filter(|reach| reach.is_finite());
    let reach_mm = reach.fold(0.005, f64::max) * 1.1;
    let extent = Extent { x: [-reach_mm, reach_mm], y: [-reach_mm, reach_mm] };
    let titles = if *target == Target::RightAnglePlate {
        [[shared::ACROSS_P_AXIS, shared::OFF_PLATE_AXIS], [shared::ACROSS_Q_AXIS, shared::OFF_PLATE_AXIS]]
    } else {
        [[shared::X_AXIS, shared::Y_AXIS], [shared::X_AXIS, shared::Z_AXIS]]
    };
    let mut sheet = Sheet::new(262.0);
    let areas = sheet.legend_over_columns(&legend(tables));
    let mut count = 0;
    for (view, ([x_title, y_title], area)) in titles.into_iter().zip(areas).enumerate() {
        let mut plot = Plot::new(Axis::new(x_title), Axis::new(y_title), extent);
        plot.has_equal_scales = true;
        for axis in [false, true] {
            let stroke = Stroke::new(0.5, palette::UNUSED);
            plot.mark(Mark::Across { at: 0.0, is_upright: axis, stroke, dash: Dash::Solid });
        }
        for (method, table) in tables {
            if let Some(found) = table.ellipse(view) {
                let corners = ellipse(found.centre, found.semi_axes, found.angle_rad);
                let color = method_color(*method);
                plot.mark(Mark::Area { corners: corners.clone(), fill: Fill::veil(color, 0.1) });
                plot.mark(Mark::Line { points: corners, stroke: Stroke::new(0.9, color), dash: Dash::Solid });
            }
        }
        for (method, table) in tables {
            let points: Vec<[f64; 2]> = table.scatter(view).map(|(_, point)| point).collect();
            count += points.len();
            let fill = Some(method_color(*method));
            let stroke = Stroke::new(0.6, Rgb::WHITE);
            plot.mark(Mark::Markers { points, shape: method_marker(*method), radius: 2.8, fill, stroke });
        }
        sheet.plot(&plot, &area);
    }
    let title = words::scatter_title(target);
    (count > 1).then(|| sheet.figure("scatter", title, title))
}
