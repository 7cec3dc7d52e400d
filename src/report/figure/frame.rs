//! Gives everything in a plot its place on the page.

use super::ink::{Align, Area, Fill, Label, Place, Stroke};
use super::page::{HEADING_SIZE, Page, TEXT_SIZE, TICK_SIZE, label, on_middle, shortened};
use super::palette::{self, Marker, Rgb};
use super::plot::{Dash, Mark, Note, NoteSide, Plot};
use super::scale::{Extent, multiples, round_step, tick_label};
use super::typeface::{self, Weight};

/// Height of a heading with the gap below it, points.
const HEADING_HEIGHT: f64 = 14.0;
/// Gap between a legend and its plot, points.
const LEGEND_GAP: f64 = 3.0;
/// Room above a plot for the half of its uppermost label, points.
const TOP_ROOM: f64 = 4.0;
/// Room at the right of a plot for the half of its last label, points.
const RIGHT_ROOM: f64 = 9.0;
/// From an axis to the labels of its marks, points.
const TICK_GAP: f64 = 3.5;
/// Height of the labels of the x axis with the gap above them, points.
const TICK_HEIGHT: f64 = 11.0;
/// Height of a title of an axis, points.
pub(super) const TITLE_HEIGHT: f64 = 11.0;
/// A note farther off than this, points, is led to its mark by a line.
const LEADER_FROM: f64 = 11.0;
/// Marks of the y axis stand at least this far apart, points; in a low plot closer, so that it has more than one.
const Y_SPACING: [f64; 3] = [20.0, 14.0, 9.5];
/// Labels of the x axis have at least this gap between them, points.
const X_GAP: f64 = 12.0;
/// A plot is never smaller than this, points.
const LEAST_SIDE: f64 = 12.0;

/// A plot with the place that it got.
pub(super) struct Frame<'a> {
    plot: &'a Plot,
    area: Area,
    view: Extent,
}

/// Room that a plot needs at the left of its area for its y axis, points. Plots above each other take the largest.
pub(super) fn left_room(plot: &Plot, area: &Area) -> f64 {
    // What the labels are hardly depends on the room that they take.
    let area = inner(plot, area, 34.0);
    let frame = Frame { plot, area, view: view_of(plot, &area) };
    let title = if plot.y.title.is_empty() { 0.0 } else { TITLE_HEIGHT };
    let marks = frame.y_marks();
    let widest = marks.iter().map(|(_, text)| typeface::width(text, TICK_SIZE, Weight::Regular));
    title + widest.fold(0.0, f64::max) + TICK_GAP + 1.0
}

/// What a plot shows in an area with so much room at its left.
pub(super) fn view_in(plot: &Plot, area: &Area, left: f64) -> Extent {
    let mut rest = *area;
    if !plot.legend.is_empty() {
        rest.min[1] += Page::default().legend(&plot.legend, &legend_area(plot, &rest, left)) + LEGEND_GAP;
    }
    view_of(plot, &inner(plot, &rest, left))
}

/// Draws a plot into an area, with so much room at its left.
pub(super) fn draw(plot: &Plot, area: &Area, left: f64, page: &mut Page) {
    let mut rest = *area;
    if let Some(heading) = &plot.heading {
        let text = shortened(heading, HEADING_SIZE, Weight::Strong, area.width() - left);
        let mut label = label(&text, [area.min[0] + left, area.min[1] + 0.78 * HEADING_SIZE + 1.0], palette::TEXT);
        (label.size, label.weight) = (HEADING_SIZE, Weight::Strong);
        page.write(label);
        rest.min[1] += HEADING_HEIGHT;
    }
    if !plot.legend.is_empty() {
        rest.min[1] += page.legend(&plot.legend, &legend_area(plot, &rest, left)) + LEGEND_GAP;
    }
    let area = inner_below(plot, &rest, left);
    let frame = Frame { plot, area, view: view_of(plot, &area) };
    frame.axes(area.min[0] - left, page);
    for mark in &plot.marks {
        frame.mark(mark, page);
    }
    frame.border(page);
    frame.notes(page);
}

/// Where a legend stands: below a heading it begins where that does.
fn legend_area(plot: &Plot, area: &Area, left: f64) -> Area {
    let inset = if plot.heading.is_some() { left - 2.0 } else { 0.0 };
    Area::new([area.min[0] + inset, area.min[1]], area.max)
}

/// The plot's own rectangle in an area, were there no legend.
fn inner(plot: &Plot, area: &Area, left: f64) -> Area {
    let heading = if plot.heading.is_some() { HEADING_HEIGHT } else { 0.0 };
    inner_below(plot, &Area::new([area.min[0], area.min[1] + heading], area.max), left)
}

fn inner_below(plot: &Plot, area: &Area, left: f64) -> Area {
    let labels = if plot.x.is_labelled { TICK_HEIGHT } else { 2.0 };
    let title = if plot.x.title.is_empty() { 0.0 } else { TITLE_HEIGHT };
    let min = [area.min[0] + left, area.min[1] + TOP_ROOM];
    let max = [area.max[0] - RIGHT_ROOM, area.max[1] - labels - title];
    Area::new(min, [max[0].max(min[0] + LEAST_SIDE), max[1].max(min[1] + LEAST_SIDE)])
}

fn view_of(plot: &Plot, area: &Area) -> Extent {
    let view = if plot.is_view_final { plot.view } else { plot.view.with_margin() };
    if plot.has_equal_scales { view.with_equal_scales(area.width(), area.height()) } else { view }
}

impl Frame<'_> {
    fn at(&self, [x, y]: [f64; 2]) -> Place {
        let part = |value: f64, [low, high]: [f64; 2]| (value - low) / (high - low);
        let down = if self.plot.inverts_y { part(y, self.view.y) } else { 1.0 - part(y, self.view.y) };
        [self.area.min[0] + part(x, self.view.x) * self.area.width(), self.area.min[1] + down * self.area.height()]
    }

    /// Marks of the y axis: where, and what they say.
    fn y_marks(&self) -> Vec<(f64, String)> {
        if let Some(names) = &self.plot.y.names {
            return names.iter().enumerate().map(|(idx, name)| (whole(idx), name.clone())).collect();
        }
        let range = self.view.y;
        let mut marks = Vec::new();
        for spacing in Y_SPACING {
            let least = (range[1] - range[0]) * spacing / self.area.height();
            let least = if self.plot.y.is_whole { least.max(1.0) } else { least };
            let Some(step) = round_step(least) else { break };
            marks = multiples(range, step).into_iter().map(|value| (value, tick_label(value, step))).collect();
            if marks.len() > 2 {
                break;
            }
        }
        marks
    }

    /// Marks of the x axis: so many that their labels stand clear of each other.
    fn x_marks(&self) -> Vec<(f64, String)> {
        let range = self.view.x;
        let points_per_unit = self.area.width() / (range[1] - range[0]);
        let widest = |marks: &[(f64, String)]| {
            marks.iter().map(|(_, text)| typeface::width(text, TICK_SIZE, Weight::Regular)).fold(0.0, f64::max)
        };
        if let Some(names) = &self.plot.x.names {
            let room = X_GAP.max(6.0 * points_per_unit);
            let all: Vec<(f64, String)> = names
                .iter()
                .enumerate()
                .map(|(idx, name)| (whole(idx), shortened(name, TICK_SIZE, Weight::Regular, room.max(60.0))))
                .collect();
            // Every name, or every n-th where they are too wide to stand side by side.
            let every = ((widest(&all) + 5.0) / points_per_unit).ceil().max(1.0);
            let last = whole(all.len().saturating_sub(1));
            let is_kept = |at: f64| at + 0.5 > last || (at % every < 0.5 && at + every < last + 0.5);
            return all.into_iter().filter(|(at, _)| is_kept(*at)).collect();
        }
        if self.plot.x.is_logarithmic {
            return decades(range, points_per_unit);
        }
        let mut least = (range[1] - range[0]) * 24.0 / self.area.width();
        if self.plot.x.is_whole {
            least = least.max(1.0);
        }
        // Wider labels need wider steps, and these seldom need wider labels.
        for _ in 0..6 {
            let Some(step) = round_step(least) else { break };
            let marks: Vec<_> =
                multiples(range, step).into_iter().map(|value| (value, tick_label(value, step))).collect();
            if widest(&marks) + X_GAP <= step * points_per_unit {
                return marks;
            }
            least = step * 1.01;
        }
        Vec::new()
    }

    fn axes(&self, left: f64, page: &mut Page) {
        let grid = Stroke::new(0.5, palette::HAIRLINE);
        let area = &self.area;
        for (value, text) in self.x_marks() {
            let [x, _] = self.at([value, self.view.y[0]]);
            if !(area.min[0] - 0.1..=area.max[0] + 0.1).contains(&x) {
                continue;
            }
            if self.plot.x.names.is_none() {
                page.line(vec![[x, area.min[1]], [x, area.max[1]]], grid, Dash::Solid);
            }
            if self.plot.x.is_labelled {
                let at = [x, area.max[1] + TICK_GAP + typeface::CAP_HEIGHT * TICK_SIZE];
                page.write(tick(text, at, Align::Middle));
            }
        }
        for (value, text) in self.y_marks() {
            let [_, y] = self.at([self.view.x[0], value]);
            if !(area.min[1] - 0.1..=area.max[1] + 0.1).contains(&y) {
                continue;
            }
            if self.plot.y.names.is_none() {
                page.line(vec![[area.min[0], y], [area.max[0], y]], grid, Dash::Solid);
            }
            if self.plot.y.is_labelled {
                page.write(tick(text, [area.min[0] - TICK_GAP, on_middle(y, TICK_SIZE)], Align::End));
            }
        }
        let title = |text: &str, at: Place, room: f64, is_upright: bool| Label {
            text: shortened(text, TEXT_SIZE, Weight::Regular, room),
            at,
            align: Align::Middle,
            size: TEXT_SIZE,
            weight: Weight::Regular,
            color: palette::TEXT_DIM,
            is_upright,
        };
        let [x, y] = area.centre();
        if !self.plot.x.title.is_empty() {
            let labels = if self.plot.x.is_labelled { TICK_HEIGHT } else { 2.0 };
            let baseline = area.max[1] + labels + 0.78 * TEXT_SIZE + 1.0;
            page.write(title(&self.plot.x.title, [x, baseline], area.width() + left.min(20.0), false));
        }
        if !self.plot.y.title.is_empty() {
            page.write(title(&self.plot.y.title, [left + 0.8 * TEXT_SIZE, y], area.height() + 8.0, true));
        }
    }

    fn border(&self, page: &mut Page) {
        page.outline(&self.area.outline(), Stroke::new(0.5, palette::UNUSED));
    }

    fn mark(&self, mark: &Mark, page: &mut Page) {
        match mark {
            Mark::Dots { points, radius, color, is_hollow } => self.dots(points, *radius, *color, *is_hollow, page),
            Mark::Markers { points, shape, radius, fill, stroke } => {
                for at in points.iter().map(|point| self.at(*point)).filter(|at| self.area.holds(*at)) {
                    page.marker(*shape, at, *radius, fill.map(Fill::solid), Some(*stroke));
                }
            }
            Mark::Cross { at, reach, stroke } => {
                let [x, y] = self.at(*at);
                for arm in [[[x - reach, y], [x + reach, y]], [[x, y - reach], [x, y + reach]]] {
                    for run in clipped_line(&arm, &self.area) {
                        page.line(run, *stroke, Dash::Solid);
                    }
                }
            }
            Mark::Line { points, stroke, dash } => {
                let places: Vec<Place> = points.iter().map(|point| self.at(*point)).collect();
                for run in clipped_line(&places, &self.area) {
                    page.line(run, *stroke, *dash);
                }
            }
            Mark::Across { at, is_upright, stroke, dash } => {
                let ends = if *is_upright {
                    self.view.y.map(|y| self.at([*at, y]))
                } else {
                    self.view.x.map(|x| self.at([x, *at]))
                };
                for run in clipped_line(&ends, &self.area) {
                    page.line(run, *stroke, *dash);
                }
            }
            Mark::Band { x, fill } => {
                let [left, right] = x.map(|x| self.at([x, self.view.y[0]])[0]);
                // However narrow, a band stays visible.
                let (middle, half) = (f64::midpoint(left, right), ((right - left) / 2.0).abs().max(0.75));
                let band = Area::new([middle - half, self.area.min[1]], [middle + half, self.area.max[1]]);
                page.area(clipped_area(&band.outline(), &self.area), *fill);
            }
            Mark::Bar { x, y, color, filling } => {
                let [from, to] = [self.at([x[0], 0.0]), self.at([x[1], *y])];
                // A value of nothing still shows that there is one.
                let (low, high) = (from[1].min(to[1]), from[1].max(to[1]));
                let (low, high) = if high - low < 0.9 { (from[1] - 0.9, from[1]) } else { (low, high) };
                let clip = |value: f64, axis: usize| value.clamp(self.area.min[axis], self.area.max[axis]);
                let bar = Area::new([clip(from[0], 0), clip(low, 1)], [clip(to[0], 0), clip(high, 1)]);
                if bar.width() > 0.0 && bar.height() > 0.0 {
                    page.bar(bar, *color, *filling);
                }
            }
            Mark::ErrorBar { at: [x, y], std, stroke } => {
                const CAP: f64 = 2.0;
                let ends = [y - std, y + std].map(|end| self.at([*x, end]));
                for run in clipped_line(&ends, &self.area) {
                    page.line(run, *stroke, Dash::Solid);
                }
                for end in ends.into_iter().filter(|end| self.area.holds(*end)) {
                    let cap = [[end[0] - CAP, end[1]], [end[0] + CAP, end[1]]];
                    for run in clipped_line(&cap, &self.area) {
                        page.line(run, *stroke, Dash::Solid);
                    }
                }
            }
            Mark::Area { corners, fill } => {
                let places: Vec<Place> = corners.iter().map(|point| self.at(*point)).collect();
                page.area(clipped_area(&places, &self.area), *fill);
            }
        }
    }

    fn dots(&self, points: &[[f64; 2]], radius: f64, color: Rgb, is_hollow: bool, page: &mut Page) {
        let places = points.iter().map(|point| self.at(*point)).filter(|at| self.area.holds(*at));
        for at in thinned(places, &self.area, 0.45 * radius) {
            let (fill, stroke) = if is_hollow {
                (Some(Fill::solid(Rgb::WHITE)), Some(Stroke::new(0.7, color)))
            } else {
                (Some(Fill::solid(color)), None)
            };
            page.marker(Marker::Circle, at, radius, fill, stroke);
        }
    }

    /// Writes the notes where they cover the least, one after the other.
    fn notes(&self, page: &mut Page) {
        if self.plot.notes.is_empty() {
            return;
        }
        let crowd = self.crowd();
        for note in &self.plot.notes {
            let at = self.at(note.at);
            if !at.iter().all(|value| value.is_finite()) {
                continue;
            }
            if let Some(label) = self.placed(note, at, &crowd, page) {
                let area = label.area();
                let near = [0, 1].map(|axis| at[axis].clamp(area.min[axis], area.max[axis]));
                // So far off that it could belong to another mark.
                if (near[0] - at[0]).hypot(near[1] - at[1]) > LEADER_FROM {
                    page.line(vec![at, near], Stroke::new(0.5, palette::TEXT_DIM), Dash::Solid);
                }
                let ground = area.grown(1.0).outline().to_vec();
                page.area(ground, Fill::veil(Rgb::WHITE, 0.75));
                page.write(label);
            }
        }
    }

    /// Places that a note should not cover: a sample of all that is marked.
    fn crowd(&self) -> Vec<Place> {
        const EVERY: f64 = 4.0;
        let mut crowd = Vec::new();
        let mut along = |places: &[Place]| {
            for pair in places.windows(2) {
                let length = (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]);
                if !length.is_finite() {
                    continue;
                }
                #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a length on a page")]
                let steps = (length / EVERY).ceil().min(400.0) as u32;
                for step in 0..=steps {
                    let part = f64::from(step) / f64::from(steps.max(1));
                    crowd.push([0, 1].map(|axis| pair[0][axis] + (pair[1][axis] - pair[0][axis]) * part));
                }
            }
        };
        let mut points_too = Vec::new();
        for mark in &self.plot.marks {
            match mark {
                Mark::Dots { points, .. } | Mark::Markers { points, .. } => {
                    points_too.extend(points.iter().map(|point| self.at(*point)));
                }
                // Words may stand on dots.
                Mark::Line { points, dash, .. } if *dash != Dash::Dotted => {
                    let places: Vec<Place> = points.iter().map(|point| self.at(*point)).collect();
                    for run in clipped_line(&places, &self.area) {
                        along(&run);
                    }
                }
                Mark::Across { at, is_upright, .. } => along(&if *is_upright {
                    self.view.y.map(|y| self.at([*at, y]))
                } else {
                    self.view.x.map(|x| self.at([x, *at]))
                }),
                Mark::ErrorBar { at: [x, y], std, .. } => along(&[y - std, y + std].map(|end| self.at([*x, end]))),
                Mark::Bar { x, y, .. } => {
                    let middle = f64::midpoint(x[0], x[1]);
                    along(&[self.at([middle, 0.0]), self.at([middle, *y])]);
                }
                Mark::Cross { at, .. } => points_too.push(self.at(*at)),
                Mark::Line { .. } | Mark::Band { .. } | Mark::Area { .. } => {}
            }
        }
        crowd.extend(points_too.into_iter().filter(|place| self.area.holds(*place)));
        crowd
    }

    /// The best free place for a note: near what it is about, at the side where it belongs, on nothing. `None` where there are
    /// words wherever it could stand.
    fn placed(&self, note: &Note, at: Place, crowd: &[Place], page: &Page) -> Option<Label> {
        let room = self.area.grown(-2.5);
        let text = shortened(&note.text, TEXT_SIZE, Weight::Regular, room.width());
        let width = typeface::width(&text, TEXT_SIZE, Weight::Regular);
        let mut best: Option<(f64, Label)> = None;
        for (penalty, side) in sides(note.side) {
            for distance in [5.0, 9.0, 14.0, 20.0, 28.0, 38.0, 50.0, 64.0] {
                for slide in [0.0, -0.3, 0.3, -0.5, 0.5] {
                    let across = slide * width;
                    let (x, middle) = match side {
                        NoteSide::Right => (at[0] + distance, at[1] + slide * 30.0),
                        NoteSide::Left => (at[0] - distance - width, at[1] + slide * 30.0),
                        NoteSide::Above => (at[0] - width / 2.0 + across, at[1] - distance - 4.0),
                        NoteSide::Below => (at[0] - width / 2.0 + across, at[1] + distance + 4.0),
                    };
                    let x = x.clamp(room.min[0], (room.max[0] - width).max(room.min[0]));
                    let label = label(&text, [x, on_middle(middle, TEXT_SIZE)], note.color);
                    let area = label.area();
                    if !room.holds_all(&area) || !page.is_free(&area.grown(1.0)) {
                        continue;
                    }
                    let covered = crowd.iter().filter(|place| area.grown(1.5).holds(**place)).count();
                    let cost = penalty + distance + 10.0 * slide.abs() + 14.0 * whole(covered.min(60));
                    if best.as_ref().is_none_or(|(least, _)| cost < *least) {
                        best = Some((cost, label));
                    }
                }
            }
        }
        best.map(|(_, label)| label)
    }
}

/// Marks of an axis whose values are powers of ten: 1, 2 and 5 times each power where there is room, else the powers.
fn decades([low, high]: [f64; 2], points_per_unit: f64) -> Vec<(f64, String)> {
    const LEAST_ROOM: f64 = 120.0;
    let factors: &[f64] = if points_per_unit > LEAST_ROOM { &[1.0, 2.0, 5.0] } else { &[1.0] };
    let powers = multiples([low - 1.0, high], 1.0).into_iter();
    let marks = powers.flat_map(|power| {
        factors.iter().map(move |factor| {
            let value = factor * 10.0_f64.powf(power);
            (value.log10(), tick_label(value, 10.0_f64.powf(power)))
        })
    });
    marks.filter(|(at, _)| (low..=high).contains(at)).collect()
}

fn tick(text: String, at: Place, align: Align) -> Label {
    Label { text, at, align, size: TICK_SIZE, weight: Weight::Regular, color: palette::TEXT_DIM, is_upright: false }
}

/// The sides in the order of what they cost.
const fn sides(best: NoteSide) -> [(f64, NoteSide); 4] {
    use NoteSide::{Above, Below, Left, Right};
    let others = match best {
        Right => [Left, Above, Below],
        Left => [Right, Above, Below],
        Above => [Below, Right, Left],
        Below => [Above, Right, Left],
    };
    [(0.0, best), (8.0, others[0]), (12.0, others[1]), (12.0, others[2])]
}

#[expect(clippy::cast_precision_loss, reason = "far fewer than 2^52")]
pub(super) const fn whole(count: usize) -> f64 {
    count as f64
}

/// The runs of a line that lie in an area.
pub(super) fn clipped_line(places: &[Place], area: &Area) -> Vec<Vec<Place>> {
    let mut runs: Vec<Vec<Place>> = Vec::new();
    for pair in places.windows(2) {
        let Some([from, to]) = clipped_segment(pair[0], pair[1], area) else { continue };
        match runs.last_mut().filter(|run| run.last() == Some(&from)) {
            Some(run) => run.push(to),
            None => runs.push(vec![from, to]),
        }
    }
    runs
}

/// The part of a segment that lies in an area, after Liang and Barsky.
fn clipped_segment(from: Place, to: Place, area: &Area) -> Option<[Place; 2]> {
    if !from.iter().chain(&to).all(|value| value.is_finite()) {
        return None;
    }
    let (mut first, mut last) = (0.0_f64, 1.0_f64);
    for axis in 0..2 {
        let along = to[axis] - from[axis];
        for (out, room) in [(-along, from[axis] - area.min[axis]), (along, area.max[axis] - from[axis])] {
            if out == 0.0 {
                if room < 0.0 {
                    return None;
                }
            } else if out < 0.0 {
                first = first.max(room / out);
            } else {
                last = last.min(room / out);
            }
        }
    }
    let point = |part: f64| [0, 1].map(|axis| from[axis] + (to[axis] - from[axis]) * part);
    // The ends themselves where nothing is cut, so that runs go on.
    let begin = if first > 0.0 { point(first) } else { from };
    let end = if last < 1.0 { point(last) } else { to };
    (first < last).then_some([begin, end])
}

/// The part of an area that lies in another one, after Sutherland and Hodgman.
pub(super) fn clipped_area(corners: &[Place], area: &Area) -> Vec<Place> {
    let mut kept: Vec<Place> =
        corners.iter().copied().filter(|place| place.iter().all(|value| value.is_finite())).collect();
    for (axis, border, is_lower) in
        [(0, area.min[0], true), (0, area.max[0], false), (1, area.min[1], true), (1, area.max[1], false)]
    {
        let is_inside = |place: &Place| if is_lower { place[axis] >= border } else { place[axis] <= border };
        let all = std::mem::take(&mut kept);
        for (idx, place) in all.iter().enumerate() {
            let previous = &all[(idx + all.len() - 1) % all.len()];
            if is_inside(place) != is_inside(previous) {
                let part = (border - previous[axis]) / (place[axis] - previous[axis]);
                kept.push([0, 1].map(|axis| previous[axis] + (place[axis] - previous[axis]) * part));
            }
            if is_inside(place) {
                kept.push(*place);
            }
        }
    }
    kept
}

/// At most one place a cell: what lies under another mark costs nothing to leave out.
fn thinned(places: impl Iterator<Item = Place>, area: &Area, cell: f64) -> Vec<Place> {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "within a page")]
    let index = |offset: f64| (offset.max(0.0) / cell.max(0.1)) as usize;
    let columns = index(area.width()) + 1;
    let mut taken = vec![false; columns * (index(area.height()) + 1)];
    let mut kept = Vec::new();
    for place in places {
        let slot = index(place[1] - area.min[1]) * columns + index(place[0] - area.min[0]);
        if let Some(taken) = taken.get_mut(slot)
            && !std::mem::replace(taken, true)
        {
            kept.push(place);
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    const SQUARE: Area = Area::new([0.0, 0.0], [10.0, 10.0]);

    #[test]
    fn lines_are_cut_at_the_border_and_go_on_where_they_come_back() {
        let line = [[-5.0, 5.0], [5.0, 5.0], [5.0, 20.0], [7.0, 20.0], [7.0, 5.0]];
        let runs = clipped_line(&line, &SQUARE);
        assert_eq!(runs, [vec![[0.0, 5.0], [5.0, 5.0], [5.0, 10.0]], vec![[7.0, 10.0], [7.0, 5.0]]]);
        assert!(clipped_line(&[[f64::NAN, 1.0], [1.0, 1.0]], &SQUARE).is_empty());
    }

    #[test]
    fn areas_are_cut_at_the_border() {
        let cut = clipped_area(&[[-5.0, -5.0], [5.0, -5.0], [5.0, 5.0], [-5.0, 5.0]], &SQUARE);
        assert_eq!(cut.len(), 4, "{cut:?}");
        assert!(cut.iter().all(|place| SQUARE.holds(*place)), "{cut:?}");
        assert!(clipped_area(&[[20.0, 20.0], [30.0, 20.0], [30.0, 30.0]], &SQUARE).is_empty());
    }

    #[test]
    fn crowded_dots_are_thinned() {
        let crowd = (0..10_000).map(|idx| [f64::from(idx) * 0.001, 5.0]);
        assert!((19..=21).contains(&thinned(crowd, &SQUARE, 0.5).len()));
    }
}
