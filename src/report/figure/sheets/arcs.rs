//! Profiles with what was found in them, and the radius against the step.

use crate::calibrate::{Method, Sweep};
use crate::fit::{CircleMethod, PointClass};
use crate::report::evidence::TargetEvidence;
use crate::report::figure::Extent;
use crate::report::figure::Figure;
use crate::report::figure::ink::{Fill, Stroke};
use crate::report::figure::model::{
    Curve, EdgeModel, Found, Peak, ProfileModel, ball_radius_mm, curve_extent, curve_points, extent, inliers,
    profile_model, residual_extent, residual_range, sweep_of,
};
use crate::report::figure::palette::{self, Marker, Rgb};
use crate::report::figure::plot::{Axis, Dash, Entry, Mark, Note, NoteSide, Plot, Sign, ellipse};
use crate::session::Reading;
use crate::text::arcs as shared;
use crate::text::edges::feature_name;
use crate::text::figures as words;
use crate::text::typeset::{decimals_of_std, fixed, signed, std_text, with_std};

use super::sheet::{HALF_PAGE, Multiples, Sheet, Small};

/// Parts of the height that a profile and a curve take; the residuals below get the rest.
const PROFILE_PART: f64 = 0.66;
/// Radius of a point of a profile, points on the page.
const DOT: f64 = 0.9;
/// Radius of the mark of a step, points on the page.
const STEP: f64 = 2.0;

/// A station's profile.
struct Seen {
    label: String,
    /// Its capture, and whether there are others.
    capture_idx: usize,
    has_others: bool,
    model: ProfileModel,
}

impl Seen {
    fn heading(&self) -> String {
        if self.has_others {
            words::station_step(&self.label, self.capture_idx + 1)
        } else {
            words::station(&self.label)
        }
    }

    fn rms_um(&self) -> f64 {
        crate::geometry::stats::rms(inliers(&self.model).map(|point| point.residual_um))
    }
}

/// The first usable profile of each enabled station, or its first one where none is.
fn seen(target: &TargetEvidence) -> Vec<Seen> {
    let session = &target.session;
    let radius_mm = ball_radius_mm(session);
    let of_station = |station_idx: usize| {
        let station = &session.stations[station_idx];
        let profiles =
            station.captures.iter().enumerate().filter_map(|(capture_idx, capture)| match &capture.reading {
                Reading::Profile(profile) => Some((capture_idx, profile)),
                Reading::Point(_) | Reading::Pose(_) => None,
            });
        let models = profiles.map(|(capture_idx, profile)| {
            let reading = target.measured.reading(station_idx, capture_idx);
            (capture_idx, profile_model(profile, reading, radius_mm, CircleMethod::Robust))
        });
        let mut first = None;
        for (capture_idx, model) in models {
            let is_usable = model.found.is_ok();
            if is_usable || first.is_none() {
                first = Some((capture_idx, model));
            }
            if is_usable {
                break;
            }
        }
        let (capture_idx, model) = first?;
        let has_others = station.captures.len() > 1;
        Some(Seen { label: station.label.clone(), capture_idx, has_others, model })
    };
    let is_shown = |station_idx: &usize| session.stations[*station_idx].enabled;
    (0..session.stations.len()).filter(is_shown).filter_map(of_station).collect()
}

/// The figures of profiles and curves.
pub(super) fn figures(target: &TargetEvidence) -> Vec<Figure> {
    let mut figures = profiles(&seen(target));
    figures.extend(curves(target));
    figures
}

fn profiles(seen: &[Seen]) -> Vec<Figure> {
    let Some(first) = seen.iter().find(|seen| seen.model.found.is_ok()) else { return Vec::new() };
    let mut figures = vec![one_profile(first)];
    if seen.len() > 1 {
        let small = |shown: &Seen| {
            let mut upper = profile_plot(&shown.model, false);
            upper.heading = Some(shown.heading());
            upper.x = Axis::default();
            shared::Z_AXIS_SHORT.clone_into(&mut upper.y.title);
            Small { upper, lower: Some(residual_plot(&shown.model, words::SMALL_RESIDUAL_AXIS)) }
        };
        let multiples =
            Multiples { height: 132.0, upper_part: 0.64, legend: shared_legend(seen), x_title: shared::X_AXIS };
        figures.extend(multiples.figures(seen.iter().map(small).collect(), "profiles", words::profiles_title));
    }
    figures
}

fn one_profile(shown: &Seen) -> Figure {
    let mut sheet = Sheet::new(HALF_PAGE);
    let mut upper = profile_plot(&shown.model, true);
    upper.legend = legend(&shown.model);
    let mut lower = residual_plot(&shown.model, shared::RESIDUAL_AXIS);
    upper.x = Axis { is_labelled: false, ..Axis::new("") };
    let area = sheet.area();
    sheet.stack_following(PROFILE_PART, &upper, &mut lower, &area);
    let title = match &shown.model.found {
        Ok(Found::Edge(edge)) => words::edge_title(&shown.label, feature_name(edge.feature)),
        _ => words::arc_title(&shown.label, shown.capture_idx + 1),
    };
    let [num_inliers, num_outliers, num_unused] =
        [PointClass::Inlier, PointClass::Outlier, PointClass::Unused].map(|class| shown.model.count(class));
    let alt = words::arc_alt(&title, num_inliers, num_outliers, num_unused, &fixed(shown.rms_um(), 1));
    sheet.figure("profile", title, alt)
}

fn legend(model: &ProfileModel) -> Vec<Entry> {
    let circle = Marker::Circle;
    let mut entries = Vec::new();
    if model.found.is_ok() {
        let count = model.count(PointClass::Inlier);
        entries.push(Entry::new(Sign::Solid(circle), palette::INLIER, shared::inliers(count)));
        let num_outliers = model.count(PointClass::Outlier);
        if num_outliers > 0 {
            entries.push(Entry::new(Sign::Hollow(circle), palette::OUTLIER, shared::outliers(num_outliers)));
        }
    }
    let num_unused = model.count(PointClass::Unused);
    if num_unused > 0 {
        entries.push(Entry::new(Sign::Dot, palette::UNUSED, shared::unused(num_unused)));
    }
    match &model.found {
        Ok(Found::Section(section)) => {
            // No ± stands beside it, so its last digit is the first that its standard deviation reaches.
            let decimals = decimals_of_std(section.std_mm[2]).saturating_sub(1);
            let radius = shared::section(&fixed(section.circle.radius_mm, decimals));
            entries.push(Entry::new(Sign::Line(Dash::Solid), palette::FIT, radius + " mm"));
            if let Some(radius_mm) = model.ball_radius_mm {
                let ball = shared::ball(&fixed(radius_mm, 3)) + " mm";
                entries.push(Entry::new(Sign::Line(Dash::Dashed), palette::TEXT_DIM, ball));
            }
        }
        Ok(Found::Edge(edge)) if !edge.flanks.is_empty() => {
            entries.push(Entry::new(Sign::Line(Dash::Solid), palette::FIT, shared::flanks(edge.flanks.len())));
        }
        _ => {}
    }
    entries
}

/// The signs of all profiles on a page, without numbers.
fn shared_legend(seen: &[Seen]) -> Vec<Entry> {
    let circle = Marker::Circle;
    let has = |class: PointClass| seen.iter().any(|seen| seen.model.count(class) > 0);
    let mut entries = vec![Entry::new(Sign::Solid(circle), palette::INLIER, words::INLIERS)];
    if has(PointClass::Outlier) {
        entries.push(Entry::new(Sign::Hollow(circle), palette::OUTLIER, words::OUTLIERS));
    }
    if has(PointClass::Unused) {
        entries.push(Entry::new(Sign::Dot, palette::UNUSED, words::UNUSED));
    }
    if seen.iter().any(|seen| seen.model.section().is_some()) {
        entries.push(Entry::new(Sign::Line(Dash::Solid), palette::FIT, words::SECTION));
        entries.push(Entry::new(Sign::Line(Dash::Dashed), palette::TEXT_DIM, words::BALL));
    }
    if seen.iter().any(|seen| seen.model.edge().is_some_and(|edge| !edge.flanks.is_empty())) {
        entries.push(Entry::new(Sign::Line(Dash::Solid), palette::FIT, words::FLANKS));
    }
    entries
}

/// The profile in true scale, as the window paints it.
fn profile_plot(model: &ProfileModel, is_large: bool) -> Plot {
    let mut plot = Plot::new(Axis::new(shared::X_AXIS), Axis::new(shared::Z_AXIS), extent(model, false));
    plot.inverts_y = model.z_grows_away;
    plot.has_equal_scales = true;
    if let Some(section) = model.section() {
        let circle = section.circle;
        let centre = [circle.x_mm, circle.z_mm];
        if let Some(radius_mm) = model.ball_radius_mm {
            let points = ellipse(centre, [radius_mm; 2], 0.0);
            plot.mark(Mark::Line { points, stroke: Stroke::new(0.7, palette::TEXT_DIM), dash: Dash::Dashed });
        }
        let points = ellipse(centre, [circle.radius_mm; 2], 0.0);
        plot.mark(Mark::Line { points, stroke: Stroke::new(1.1, palette::FIT), dash: Dash::Solid });
    }
    let dot = if is_large { DOT } else { 0.7 };
    for (class, color, is_hollow) in [
        (PointClass::Unused, palette::UNUSED, false),
        (PointClass::Inlier, palette::INLIER, false),
        (PointClass::Outlier, palette::OUTLIER, true),
    ] {
        let points = model.points.iter().filter(|point| point.class == class);
        let points: Vec<[f64; 2]> = points.map(|point| [point.x_mm, point.z_mm]).collect();
        let radius = if is_hollow { dot + 0.8 } else { dot };
        plot.mark(Mark::Dots { points, radius, color, is_hollow });
    }
    if let Some(edge) = model.edge() {
        mark_edge(&mut plot, edge, is_large);
    }
    if let Some(section) = model.section() {
        let at = [section.circle.x_mm, section.circle.z_mm];
        cross(&mut plot, at, palette::FIT);
        if is_large {
            let [x, z] = [0, 1].map(|axis| with_std(at[axis], section.std_mm[axis]));
            let text = words::centre(&x, &z);
            plot.notes.push(Note { at, text, color: palette::TEXT, side: NoteSide::Below });
        }
    }
    plot
}

/// The flanks, up to the point where they end or meet, and that point with its σ.
fn mark_edge(plot: &mut Plot, edge: &EdgeModel, is_large: bool) {
    let at = edge.point_mm;
    for flank in &edge.flanks {
        let points = vec![at, flank.ends_mm[1]];
        plot.mark(Mark::Line { points, stroke: Stroke::new(1.1, palette::FIT), dash: Dash::Solid });
    }
    cross(plot, at, palette::TEXT);
    let stroke = Stroke::new(0.9, palette::TEXT);
    plot.mark(Mark::Markers { points: vec![at], shape: Marker::Circle, radius: 5.0, fill: None, stroke });
    if is_large {
        let [x, z] = [0, 1].map(|axis| with_std(at[axis], edge.std_mm[axis]));
        let text = words::centre(&x, &z);
        // Towards the sensor there is nothing that the label could cover.
        plot.notes.push(Note { at, text, color: palette::TEXT, side: NoteSide::Above });
    }
}

fn cross(plot: &mut Plot, at: [f64; 2], color: Rgb) {
    plot.mark(Mark::Cross { at, reach: 3.5, stroke: Stroke::new(1.2, color) });
}

/// Distances of the inliers from what was found.
fn residual_plot(model: &ProfileModel, title: &'static str) -> Plot {
    let mut plot = Plot::new(Axis::new(shared::X_AXIS), Axis::new(title), residual_extent(model));
    plot.level(0.0, Stroke::new(0.6, palette::TEXT_DIM), Dash::Solid);
    let points = inliers(model).map(|point| [point.x_mm, point.residual_um]).collect();
    plot.mark(Mark::Dots { points, radius: 0.8, color: palette::INLIER, is_hollow: false });
    plot
}

fn curves(target: &TargetEvidence) -> Vec<Figure> {
    let Some(radius_mm) = ball_radius_mm(&target.session) else { return Vec::new() };
    let stations = target.session.stations.iter().enumerate();
    let sweeps: Vec<(&str, &Sweep)> = stations
        .filter_map(|(idx, station)| Some((station.label.as_str(), sweep_of(target.results(), idx)?.1)))
        .filter(|(_, sweep)| sweep.points.len() > 1)
        .collect();
    let Some((label, sweep)) = sweeps.first() else { return Vec::new() };
    let mut figures = vec![one_curve(label, sweep, radius_mm)];
    if sweeps.len() > 1 {
        let color = palette::method_color(Method::BallMaxArcStep);
        let mut legend = curve_legend();
        legend.push(Entry::new(Sign::Hollow(Marker::Down), color, words::PUBLISHED_STOP));
        let small = |(label, sweep): &(&str, &Sweep)| {
            let mut upper = curve_plot(&Curve::of(sweep), radius_mm, false);
            upper.heading = Some(words::station(label));
            Small { upper, lower: None }
        };
        let multiples = Multiples { height: 108.0, upper_part: 1.0, legend, x_title: shared::TRAVEL_AXIS };
        figures.extend(multiples.figures(sweeps.iter().map(small).collect(), "curves", words::curves_title));
    }
    figures
}

fn one_curve(label: &str, sweep: &Sweep, radius_mm: f64) -> Figure {
    let mut sheet = Sheet::new(280.0);
    let curve = Curve::of(sweep);
    let mut upper = curve_plot(&curve, radius_mm, true);
    upper.legend = curve_legend();
    upper.x = Axis { is_labelled: false, ..Axis::new("") };
    let view = Extent { x: upper.view.x, y: residual_range(curve.points) };
    let mut lower = Plot::new(Axis::new(shared::TRAVEL_AXIS), Axis::new(shared::CURVE_RESIDUAL_AXIS), view);
    lower.level(0.0, Stroke::new(0.6, palette::TEXT_DIM), Dash::Solid);
    mark_steps(
        &mut lower,
        curve
            .points
            .iter()
            .map(|step| [step.travel_mm, step.residual_mm * 1000.0, step.section_radius_std_mm * 1000.0]),
        STEP,
    );
    let area = sheet.area();
    sheet.stack_following(PROFILE_PART, &upper, &mut lower, &area);
    let title = words::curve_title(label);
    sheet.figure("curve", title.clone(), title)
}

fn curve_legend() -> Vec<Entry> {
    let fitted = palette::FIT;
    vec![
        Entry::new(Sign::Hollow(Marker::Circle), palette::TEXT, shared::MEASURED),
        Entry::new(Sign::Line(Dash::Solid), fitted, shared::FITTED),
        Entry::new(Sign::Line(Dash::Dotted), palette::TEXT_DIM, shared::BALL_RADIUS_LINE),
    ]
}

/// The radius against the step, as the window paints it.
fn curve_plot(curve: &Curve<'_>, radius_mm: f64, is_large: bool) -> Plot {
    let view = curve_extent(curve, radius_mm);
    let mut plot = Plot::new(Axis::new(shared::TRAVEL_AXIS), Axis::new(shared::RADIUS_AXIS), view);
    if let Some(peak) = &curve.peak {
        mark_peak(&mut plot, peak, radius_mm);
    }
    plot.level(radius_mm, Stroke::new(0.8, palette::TEXT_DIM), Dash::Dotted);
    let steps = curve.points.iter().map(|step| [step.travel_mm, step.section_radius_mm, step.section_radius_std_mm]);
    mark_steps(&mut plot, steps, if is_large { STEP } else { 1.3 });
    if let Some((stop_mm, peak)) = curve.published_stop_mm.zip(curve.peak) {
        let below = (view.y[1] - view.y[0]) * if is_large { 0.09 } else { 0.14 };
        let at = [stop_mm, peak.section_radius_mm(stop_mm, radius_mm) - below];
        let color = palette::method_color(Method::BallMaxArcStep);
        plot.mark(Mark::Markers {
            points: vec![at],
            shape: Marker::Down,
            radius: if is_large { 3.2 } else { 2.4 },
            fill: Some(Rgb::WHITE),
            stroke: Stroke::new(1.0, color),
        });
        if is_large {
            let text = shared::published_stop(&signed(stop_mm, 2)) + " mm";
            plot.notes.push(Note { at, text, color: palette::TEXT_DIM, side: NoteSide::Below });
        }
    }
    if let Some(peak) = curve.peak.filter(|_| is_large) {
        let text = shared::peak(&signed(peak.travel_mm, decimals_of_std(peak.std_mm)), &std_text(peak.std_mm)) + " mm";
        let at = [peak.travel_mm, view.y[0] + (view.y[1] - view.y[0]) * 0.2];
        plot.notes.push(Note { at, text, color: palette::TEXT, side: NoteSide::Right });
    }
    plot
}

/// The band of ±σ around the peak, and the curve.
fn mark_peak(plot: &mut Plot, peak: &Peak, radius_mm: f64) {
    let band = [peak.travel_mm - peak.std_mm, peak.travel_mm + peak.std_mm];
    plot.mark(Mark::Band { x: band, fill: Fill::veil(palette::FIT, 0.28) });
    let view = plot.view.with_margin();
    let points = curve_points(peak, radius_mm, view.x);
    plot.mark(Mark::Line { points, stroke: Stroke::new(1.1, palette::FIT), dash: Dash::Solid });
}

/// Steps with their error bars: place, value, σ.
fn mark_steps(plot: &mut Plot, steps: impl Iterator<Item = [f64; 3]>, radius: f64) {
    let stroke = Stroke::new(0.7, palette::TEXT);
    let mut points = Vec::new();
    for [x, y, std] in steps {
        plot.mark(Mark::ErrorBar { at: [x, y], std, stroke });
        points.push([x, y]);
    }
    let fill = Some(Rgb::WHITE);
    plot.mark(Mark::Markers { points, shape: Marker::Circle, radius, fill, stroke: Stroke::new(0.8, palette::TEXT) });
}
