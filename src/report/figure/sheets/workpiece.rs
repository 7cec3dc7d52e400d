//! Scanned parts: distances of their points from their planes, and the pitch and height of their teeth.

use crate::report::evidence::PartEvidence;
use crate::report::figure::frame::whole;
use crate::report::figure::ink::Stroke;
use crate::report::figure::palette::{self, Marker, region_color};
use crate::report::figure::plot::{Axis, Dash, Entry, Filling, Mark, Plot, Sign};
use crate::report::figure::{Extent, Figure};
use crate::scan::{Measured, Teeth};
use crate::session::Known;
use crate::text::figures as words;
use crate::text::typeset::fixed;

use super::bars::{Distances, histogram};
use super::sheet::Sheet;

/// Planes whose distances are shown, the largest first.
const MOST_PLANES: usize = 4;
/// Each filled in another way, so that they can be told apart without colour.
const FILLINGS: [Filling; MOST_PLANES] = [Filling::Solid, Filling::Hatched, Filling::Faint, Filling::Hollow];

/// The figures of a scanned part.
pub(super) fn figures(part: &PartEvidence) -> Vec<Figure> {
    let Ok(measured) = &part.outcome else { return Vec::new() };
    let teeth = measured.shapes.teeth.as_ref().and_then(|teeth| teeth.as_ref().ok());
    planes(part).into_iter().chain(teeth.and_then(|teeth| teeth_figure(part, teeth))).collect()
}

fn planes(part: &PartEvidence) -> Option<Figure> {
    let regions = &part.outcome.as_ref().ok()?.regions;
    let shown: Vec<_> = regions.iter().enumerate().filter(|(_, region)| !region.distances_mm.is_empty()).collect();
    let shown = &shown[..shown.len().min(MOST_PLANES)];
    let most = shown.iter().map(|(_, region)| region.distances_mm.len()).max()?;
    let all: Vec<Distances> = shown
        .iter()
        .zip(FILLINGS)
        .map(|((idx, region), filling)| Distances {
            color: region_color(*idx),
            filling,
            distances_mm: region.distances_mm.iter().map(|distance| distance.abs()).collect(),
        })
        .collect();
    let mut plot = histogram(words::PLANE_DISTANCE_AXIS, crate::text::verify::POINTS_AXIS, &all);
    let signs = shown.iter().zip(FILLINGS);
    plot.legend = signs
        .map(|((idx, region), filling)| Entry::new(Sign::Bar(filling), region_color(*idx), words::plane(&region.name)))
        .collect();
    let mut sheet = Sheet::new(200.0);
    let area = sheet.area();
    sheet.plot(&plot, &area);
    let title = words::planes_title(&part.name, most);
    Some(sheet.figure("plane-distances", title.clone(), title))
}

fn teeth_figure(part: &PartEvidence, teeth: &Teeth) -> Option<Figure> {
    let values = |of: fn(&crate::scan::Tooth) -> Option<Measured>| -> Vec<(usize, Measured)> {
        teeth.teeth.iter().enumerate().filter_map(|(idx, tooth)| Some((idx, of(tooth)?))).collect()
    };
    let Known { pitch_mm, height_mm, .. } = part.known;
    let pitch = values_plot(&values(|tooth| tooth.pitch), pitch_mm, words::PITCH_AXIS);
    let height = values_plot(&values(|tooth| tooth.height), height_mm, words::HEIGHT_AXIS);
    let mut plots: Vec<Plot> = pitch.into_iter().chain(height).collect();
    plots.last_mut()?.x.title = words::TOOTH_AXIS.to_owned();
    let mut legend =
        vec![Entry::new(Sign::Solid(Marker::Circle), palette::INLIER, crate::text::arcs::MEASURED.to_owned() + " ± σ")];
    if pitch_mm.or(height_mm).is_some() {
        legend.push(Entry::new(Sign::Line(Dash::Dashed), palette::TEXT_DIM, words::NOMINAL));
    }
    let mut sheet = Sheet::new(if plots.len() > 1 { 250.0 } else { 150.0 });
    let area = sheet.legend(&legend);
    let stacked: Vec<(f64, &Plot)> = plots.iter().map(|plot| (1.0, plot)).collect();
    sheet.stack(&stacked, &area);
    let title = words::teeth_title(&part.name);
    Some(sheet.figure("teeth", title.clone(), title))
}

/// One value a tooth with its σ, and the nominal one.
fn values_plot(values: &[(usize, Measured)], nominal_mm: Option<f64>, y_title: &str) -> Option<Plot> {
    let (last, _) = values.last()?;
    let mut extent = Extent { x: [0.4, whole(*last) + 1.6], y: [f64::INFINITY, f64::NEG_INFINITY] };
    for (_, measured) in values {
        extent.include(1.0, measured.value_mm - measured.std_mm);
        extent.include(1.0, measured.value_mm + measured.std_mm);
    }
    if let Some(nominal_mm) = nominal_mm {
        extent.include(1.0, nominal_mm);
    }
    extent.y = extent.with_margin().y;
    let mut plot = Plot::new(Axis { is_whole: true, ..Axis::new("") }, Axis::new(y_title), extent);
    plot.is_view_final = true;
    if let Some(nominal_mm) = nominal_mm {
        plot.level(nominal_mm, Stroke::new(0.9, palette::TEXT_DIM), Dash::Dashed);
        plot.heading = Some(words::nominal(&fixed(nominal_mm, 3)));
    }
    let points: Vec<[f64; 2]> = values.iter().map(|(idx, measured)| [whole(*idx) + 1.0, measured.value_mm]).collect();
    for (point, (_, measured)) in points.iter().zip(values) {
        plot.mark(Mark::ErrorBar { at: *point, std: measured.std_mm, stroke: Stroke::new(0.7, palette::TEXT) });
    }
    let stroke = Stroke::new(0.4, palette::Rgb::WHITE);
    plot.mark(Mark::Markers { points, shape: Marker::Circle, radius: 2.2, fill: Some(palette::INLIER), stroke });
    Some(plot)
}
