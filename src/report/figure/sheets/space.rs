//! Things in space, seen without perspective from the front, the right and above.

use crate::geometry::{Rigid, Vec3};
use crate::report::figure::Orbit;
use crate::report::figure::frame::whole;
use crate::report::figure::ink::{Align, Area, Fill, Label, Place, Stroke};
use crate::report::figure::page::{Page, TEXT_SIZE, label, on_middle};
use crate::report::figure::palette::{self, Marker, Rgb};
use crate::report::figure::plot::{Dash, ellipse};
use crate::report::figure::typeface::{self, Weight};

/// Axes of a frame are so long, as a part of the scene's size; those of the base longer.
const AXIS_PART: f64 = 0.055;
/// How much longer.
const STRONG: f64 = 2.2;

/// How a frame is drawn.
#[derive(Clone, Copy, Debug)]
pub(super) struct Triad<'a> {
    /// What stands beside it.
    pub name: Option<&'a str>,
    /// Whether it is the base, whose axes are named.
    pub is_strong: bool,
}

/// Something in the scene.
#[derive(Clone, Debug)]
enum Thing {
    Frame {
        pose: Rigid,
        name: Option<String>,
        is_strong: bool,
    },
    /// From the flange to its sensor.
    Holder([Vec3; 2]),
    LaserPlane([Vec3; 3]),
    /// From a camera to what it sees.
    LineOfSight([Vec3; 2]),
    Ball {
        centre: Vec3,
        radius_mm: f64,
        color: Rgb,
    },
    Plate {
        corners: [Vec3; 3],
        color: Rgb,
    },
    Board {
        corners: [Vec3; 4],
        color: Rgb,
    },
    Point {
        at: Vec3,
        color: Rgb,
    },
}

/// The edge of what light or sight goes through.
pub(super) const RAY_COLOR: Rgb = Rgb(0xe3, 0x9c, 0x95);

impl Thing {
    /// The points that have to be in sight.
    fn reach(&self) -> Vec<Vec3> {
        match self {
            Self::Frame { pose, .. } => vec![pose.translation.vector],
            Self::Holder(ends) | Self::LineOfSight(ends) => ends.to_vec(),
            Self::Board { corners, .. } => corners.to_vec(),
            Self::LaserPlane(corners) => corners.to_vec(),
            Self::Ball { centre, radius_mm, .. } => {
                [-*radius_mm, *radius_mm].map(|radius| centre + Vec3::repeat(radius * 0.58)).to_vec()
            }
            Self::Plate { corners: [p, corner, q], .. } => vec![*p, *corner, *q, p + q - corner],
            Self::Point { at, .. } => vec![*at],
        }
    }

    /// The ends of the axes of a frame.
    fn axis_ends(&self, axis_mm: f64) -> Vec<Vec3> {
        let Self::Frame { pose, is_strong, .. } = self else { return Vec::new() };
        let length = axis_mm * if *is_strong { STRONG } else { 1.0 };
        [Vec3::x(), Vec3::y(), Vec3::z()].map(|axis| pose.translation.vector + pose.rotation * (axis * length)).to_vec()
    }

    fn middle(&self) -> Vec3 {
        let reach = self.reach();
        #[expect(clippy::cast_precision_loss, reason = "a handful of points")]
        let count = reach.len() as f64;
        reach.iter().sum::<Vec3>() / count
    }
}

/// A scene.
#[derive(Clone, Debug, Default)]
pub(super) struct Scene {
    things: Vec<Thing>,
}

impl Scene {
    /// A frame.
    pub fn triad(&mut self, pose: &Rigid, triad: Triad<'_>) {
        self.things.push(Thing::Frame { pose: *pose, name: triad.name.map(str::to_owned), is_strong: triad.is_strong });
    }

    /// What holds the sensor to the flange.
    pub fn holder(&mut self, flange: Vec3, sensor: Vec3) {
        self.things.push(Thing::Holder([flange, sensor]));
    }

    /// The part of a laser plane between the sensor and what it lights.
    pub fn laser_plane(&mut self, sensor: Vec3, [from, to]: [Vec3; 2]) {
        self.things.push(Thing::LaserPlane([sensor, from, to]));
    }

    /// A camera's line of sight to what it sees.
    pub fn line_of_sight(&mut self, camera: Vec3, target: Vec3) {
        self.things.push(Thing::LineOfSight([camera, target]));
    }

    /// A board between its corners, in their order.
    pub fn board(&mut self, corners: [Vec3; 4], color: Rgb) {
        self.things.push(Thing::Board { corners, color });
    }

    /// A ball.
    pub fn ball(&mut self, centre: Vec3, radius_mm: f64, color: Rgb) {
        self.things.push(Thing::Ball { centre, radius_mm, color });
    }

    /// A plate between the ends of its edges and its corner.
    pub fn plate(&mut self, corners: [Vec3; 3], color: Rgb) {
        self.things.push(Thing::Plate { corners, color });
    }

    /// A point.
    pub fn point(&mut self, at: Vec3, color: Rgb) {
        self.things.push(Thing::Point { at, color });
    }

    /// Draws it as large as an area allows.
    pub fn draw(mut self, area: &Area, page: &mut Page) {
        self.things.retain(|thing| thing.reach().iter().all(|point| point.iter().all(|value| value.is_finite())));
        let orbit = Orbit::default();
        let reach: Vec<Vec3> = self.things.iter().flat_map(Thing::reach).collect();
        let Some(first) = reach.first() else { return };
        let (low, high) = reach.iter().fold((*first, *first), |(low, high), point| (low.inf(point), high.sup(point)));
        let size_mm = (high - low).norm().max(1.0);
        let axis_mm = AXIS_PART * size_mm;
        let ends = self.things.iter().flat_map(|thing| thing.axis_ends(axis_mm));
        let (mut min, mut max) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for point in reach.iter().copied().chain(ends).map(|point| orbit.seen(point)) {
            min = [min[0].min(point.x), min[1].min(point.y)];
            max = [max[0].max(point.x), max[1].max(point.y)];
        }
        // Room for the names around it.
        let room = area.grown(-14.0);
        let scale = (room.width() / (max[0] - min[0]).max(1e-9)).min(room.height() / (max[1] - min[1]).max(1e-9));
        let centre = [f64::midpoint(min[0], max[0]), f64::midpoint(min[1], max[1])];
        let view = View { orbit, scale, centre, page_centre: room.centre(), axis_mm };
        // From far to near, so that what is in front covers what is behind it; frames last, as they are thin.
        let depth =
            |thing: &Thing| (matches!(thing, Thing::Frame { .. } | Thing::Holder(_)), orbit.seen(thing.middle()).z);
        self.things.sort_by(|a, b| {
            let (a, b) = (depth(a), depth(b));
            a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
        });
        for thing in &self.things {
            view.thing(thing, page);
        }
        let crowd = view.crowd(&self.things);
        for thing in &self.things {
            view.names(thing, &crowd, area, page);
        }
        view.scale_bar(area, page);
    }
}

/// From space to the page.
struct View {
    orbit: Orbit,
    /// Points a mm.
    scale: f64,
    centre: [f64; 2],
    page_centre: Place,
    axis_mm: f64,
}

impl View {
    fn at(&self, point: Vec3) -> Place {
        let seen = self.orbit.seen(point);
        [
            self.page_centre[0] + (seen.x - self.centre[0]) * self.scale,
            self.page_centre[1] - (seen.y - self.centre[1]) * self.scale,
        ]
    }

    /// The ends of the axes of a frame on the page.
    fn axes(&self, thing: &Thing) -> Vec<Place> {
        thing.axis_ends(self.axis_mm).into_iter().map(|end| self.at(end)).collect()
    }

    fn thing(&self, thing: &Thing, page: &mut Page) {
        match thing {
            Thing::Frame { pose, is_strong, .. } => {
                let origin = self.at(pose.translation.vector);
                let width = if *is_strong { 1.4 } else { 0.9 };
                for (end, color) in self.axes(thing).into_iter().zip(palette::AXES) {
                    page.line(vec![origin, end], Stroke::new(width, color), Dash::Solid);
                }
                let radius = if *is_strong { 2.4 } else { 1.6 };
                page.marker(Marker::Circle, origin, radius, Some(Fill::solid(palette::TEXT)), None);
            }
            Thing::Holder(ends) => {
                page.line(ends.map(|end| self.at(end)).to_vec(), Stroke::new(0.6, palette::UNUSED), Dash::Solid);
            }
            Thing::LaserPlane(corners) => {
                let corners = corners.map(|corner| self.at(corner));
                page.area(corners.to_vec(), Fill::veil(palette::OUTLIER, 0.1));
                page.outline(&corners, Stroke::new(0.4, RAY_COLOR));
            }
            Thing::LineOfSight(ends) => {
                page.line(ends.map(|end| self.at(end)).to_vec(), Stroke::new(0.5, RAY_COLOR), Dash::Solid);
            }
            Thing::Board { corners, color } => {
                let corners = corners.map(|corner| self.at(corner));
                page.area(corners.to_vec(), Fill::veil(*color, 0.15));
                page.outline(&corners, Stroke::new(1.1, *color));
            }
            Thing::Ball { centre, radius_mm, color } => {
                let at = self.at(*centre);
                let radius = (radius_mm * self.scale).max(1.5);
                let stroke = Some(Stroke::new(1.1, *color));
                page.marker(Marker::Circle, at, radius, Some(Fill::veil(*color, 0.25)), stroke);
                // The equator, so that it reads as a ball.
                let flat = radius * self.orbit.seen(Vec3::z()).z.abs();
                page.line(ellipse(at, [radius, flat], 0.0), Stroke::new(0.6, *color), Dash::Solid);
            }
            Thing::Plate { corners: [p, corner, q], color } => {
                let all = [*p, *corner, *q, p + q - corner].map(|point| self.at(point));
                page.area(all.to_vec(), Fill::veil(*color, 0.15));
                page.outline(&all, Stroke::new(0.5, *color));
                page.line(all[..3].to_vec(), Stroke::new(1.6, *color), Dash::Solid);
            }
            Thing::Point { at, color } => {
                page.marker(Marker::Diamond, self.at(*at), 3.2, Some(Fill::solid(*color)), None);
            }
        }
    }

    /// Names of frames beside them, and of the base's axes at their ends, where there is room for them.
    fn names(&self, thing: &Thing, crowd: &[Place], room: &Area, page: &mut Page) {
        let Thing::Frame { pose, name, is_strong } = thing else { return };
        let origin = self.at(pose.translation.vector);
        if *is_strong {
            for (end, (letter, color)) in
                self.axes(thing).into_iter().zip(["x", "y", "z"].into_iter().zip(palette::AXES))
            {
                let along = [end[0] - origin[0], end[1] - origin[1]];
                let length = along[0].hypot(along[1]).max(1e-9);
                let at = [0, 1].map(|axis| end[axis] + along[axis] / length * 6.0);
                if let Some(label) = free_label(letter, at, color, room, page) {
                    page.write(label);
                }
            }
        }
        if let Some(label) = name.as_deref().and_then(|name| self.beside(thing, name, crowd, room, page)) {
            page.area(label.area().outline().to_vec(), Fill::veil(Rgb::WHITE, 0.6));
            page.write(label);
        }
    }

    /// The best free place for the name of a frame: near it, away from its axes, on no axis of others.
    fn beside(&self, thing: &Thing, name: &str, crowd: &[Place], room: &Area, page: &Page) -> Option<Label> {
        let Thing::Frame { pose, .. } = thing else { return None };
        let origin = self.at(pose.translation.vector);
        let middle = self.axes(thing).iter().fold([0.0; 2], |sum, end| [sum[0] + end[0], sum[1] + end[1]]);
        let away = [origin[0] - middle[0] / 3.0, origin[1] - middle[1] / 3.0];
        let length = away[0].hypot(away[1]).max(1e-9);
        let mut best: Option<(f64, Label)> = None;
        for distance in [8.0, 11.0, 15.0, 20.0] {
            for turn in [0.0_f64, 0.6, -0.6, 1.2, -1.2, 1.9, -1.9, 2.6, -2.6] {
                let (sin, cos) = turn.sin_cos();
                let along = [(away[0] * cos - away[1] * sin) / length, (away[0] * sin + away[1] * cos) / length];
                // A wide name stands farther off sideways.
                let aside = distance + (typeface::width(name, TEXT_SIZE, Weight::Regular) / 2.0 - 3.0).max(0.0);
                let at = [origin[0] + along[0] * aside, origin[1] + along[1] * distance];
                let Some(label) = free_label(name, at, palette::TEXT, room, page) else { continue };
                let area = label.area();
                let covered = crowd.iter().filter(|place| area.holds(**place)).count();
                let cost = distance + 2.0 * turn.abs() + 5.0 * whole(covered);
                if best.as_ref().is_none_or(|(least, _)| cost < *least) {
                    best = Some((cost, label));
                }
            }
        }
        best.map(|(_, label)| label)
    }

    /// Places that a name should not cover: a sample of the axes of all frames.
    fn crowd(&self, things: &[Thing]) -> Vec<Place> {
        const NUM_STEPS: u32 = 12;
        let of_frame = |thing: &Thing| -> Vec<Place> {
            let Thing::Frame { pose, .. } = thing else { return Vec::new() };
            let origin = self.at(pose.translation.vector);
            let along = |end: Place| {
                (0..=NUM_STEPS).map(move |step| {
                    let part = f64::from(step) / f64::from(NUM_STEPS);
                    [0, 1].map(|axis| origin[axis] + (end[axis] - origin[axis]) * part)
                })
            };
            self.axes(thing).into_iter().flat_map(along).collect()
        };
        things.iter().flat_map(of_frame).collect()
    }

    /// A length to compare with, at the lower right.
    fn scale_bar(&self, area: &Area, page: &mut Page) {
        const ABOUT: f64 = 70.0;
        let Some(step) = crate::report::figure::round_step(ABOUT / self.scale * 0.55) else { return };
        let length = step * self.scale;
        let (right, y) = (area.max[0] - 8.0, area.max[1] - 6.0);
        let stroke = Stroke::new(1.0, palette::TEXT_DIM);
        page.line(vec![[right - length, y], [right, y]], stroke, Dash::Solid);
        for x in [right - length, right] {
            page.line(vec![[x, y - 2.5], [x, y + 2.5]], stroke, Dash::Solid);
        }
        let text = crate::report::figure::tick_label(step, step) + " mm";
        let mut label = label(&text, [right - length / 2.0, y - 5.0], palette::TEXT_DIM);
        label.align = Align::Middle;
        page.write(label);
    }
}

/// A name about a place, if nothing else is written there.
fn free_label(text: &str, [x, y]: Place, color: Rgb, room: &Area, page: &Page) -> Option<Label> {
    let mut label = label(text, [x, on_middle(y, TEXT_SIZE)], color);
    label.align = Align::Middle;
    let area = label.area();
    (room.holds_all(&area) && page.is_free(&area.grown(0.5))).then_some(label)
}
