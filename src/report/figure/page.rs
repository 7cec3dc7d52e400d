//! A page: the ink on it, and where its words stand, so that no word comes to stand on another.

use super::ink::{Align, Area, Fill, Ink, Label, Place, Stroke, dashed};
use super::palette::{self, Marker, Rgb};
use super::plot::{Dash, Entry, Filling, Sign};
use super::typeface::{self, Weight};

/// Size of headings, points.
pub(super) const HEADING_SIZE: f64 = 8.5;
/// Size of legends, axis titles and notes, points.
pub(super) const TEXT_SIZE: f64 = 7.5;
/// Size of the labels of marks, points.
pub(super) const TICK_SIZE: f64 = 7.0;
/// Height of a row of a legend, points.
const LEGEND_ROW: f64 = 12.0;
/// Room for a sign of a legend, points.
const SIGN_WIDTH: f64 = 12.0;

/// What is on a page so far.
#[derive(Clone, Debug, Default)]
pub(super) struct Page {
    /// The ink, from below to above.
    pub ink: Vec<Ink>,
    /// The room that words take.
    words: Vec<Area>,
}

impl Page {
    /// A line.
    pub fn line(&mut self, places: Vec<Place>, stroke: Stroke, dash: Dash) {
        match dash {
            Dash::Solid => self.ink.push(Ink::Line { places, stroke }),
            Dash::Dashed => self.dashes(&places, stroke, 3.2, 2.4),
            Dash::Dotted => self.dashes(&places, stroke, stroke.width, 2.4),
        }
    }

    fn dashes(&mut self, places: &[Place], stroke: Stroke, dash: f64, gap: f64) {
        self.ink.extend(dashed(places, dash, gap).into_iter().map(|places| Ink::Line { places, stroke }));
    }

    /// An area.
    pub fn area(&mut self, corners: Vec<Place>, fill: Fill) {
        self.ink.push(Ink::Area { corners, fill });
    }

    /// The border of an area.
    pub fn outline(&mut self, corners: &[Place], stroke: Stroke) {
        let mut places = corners.to_vec();
        places.extend(corners.first().copied());
        self.ink.push(Ink::Line { places, stroke });
    }

    /// A marker of a radius.
    pub fn marker(&mut self, shape: Marker, at: Place, radius: f64, fill: Option<Fill>, stroke: Option<Stroke>) {
        let turn = std::f64::consts::TAU;
        let corners: Vec<Place> = match shape {
            Marker::Circle => {
                self.ink.push(Ink::Circle { centre: at, radius, fill, stroke });
                return;
            }
            Marker::Square => Area::new(at, at).grown(radius * 0.9).outline().to_vec(),
            Marker::Up => around(at, radius * 1.25, [-turn / 4.0, turn / 12.0, turn * 5.0 / 12.0]),
            Marker::Down => around(at, radius * 1.25, [turn / 4.0, -turn / 12.0, -turn * 5.0 / 12.0]),
            Marker::Diamond => around(at, radius * 1.2, [0.0, turn / 4.0, turn / 2.0, -turn / 4.0]),
        };
        if let Some(fill) = fill {
            self.area(corners.clone(), fill);
        }
        if let Some(stroke) = stroke {
            self.outline(&corners, stroke);
        }
    }

    /// A bar.
    pub fn bar(&mut self, bar: Area, color: Rgb, filling: Filling) {
        const HATCH_SPACING: f64 = 3.4;
        let corners = bar.outline().to_vec();
        let stroke = Stroke::new(0.8, color);
        match filling {
            Filling::Solid => {
                self.area(corners, Fill::solid(color));
                return;
            }
            Filling::Faint => self.area(corners.clone(), Fill::veil(color, 0.28)),
            Filling::Hollow => {}
            Filling::Hatched => {
                self.area(corners.clone(), Fill::veil(color, 0.12));
                let (width, height) = (bar.width(), bar.height());
                let mut offset = HATCH_SPACING - height;
                while offset < width {
                    // From the lower or left border up to the upper or right one.
                    let from = [offset.max(0.0), offset.max(0.0) - offset];
                    let to = [(offset + height).min(width), (offset + height).min(width) - offset];
                    let place = |[x, y]: [f64; 2]| [bar.min[0] + x, bar.max[1] - y];
                    self.line(vec![place(from), place(to)], stroke, Dash::Solid);
                    offset += HATCH_SPACING;
                }
            }
        }
        self.outline(&corners, stroke);
    }

    /// Words, wherever they stand.
    pub fn write(&mut self, label: Label) {
        self.words.push(label.area());
        self.ink.push(Ink::Label(label));
    }

    /// Whether an area is free of words.
    pub fn is_free(&self, area: &Area) -> bool {
        self.words.iter().all(|words| !words.overlaps(area))
    }

    /// A legend in rows as wide as the area, from its top on; answers its height.
    pub fn legend(&mut self, entries: &[Entry], area: &Area) -> f64 {
        const GAP: f64 = 12.0;
        let (mut x, mut row) = (area.min[0], 0.0);
        for entry in entries {
            let room = area.width() - SIGN_WIDTH - 4.0;
            let text = shortened(&entry.text, TEXT_SIZE, Weight::Regular, room);
            let width = SIGN_WIDTH + 4.0 + typeface::width(&text, TEXT_SIZE, Weight::Regular);
            if x > area.min[0] && x + width > area.max[0] {
                x = area.min[0];
                row += 1.0;
            }
            let middle = area.min[1] + LEGEND_ROW * (row + 0.5);
            self.sign(entry, [x + SIGN_WIDTH / 2.0, middle]);
            self.write(label(&text, [x + SIGN_WIDTH + 4.0, on_middle(middle, TEXT_SIZE)], palette::TEXT_DIM));
            x += width + GAP;
        }
        if entries.is_empty() { 0.0 } else { LEGEND_ROW * (row + 1.0) }
    }

    fn sign(&mut self, entry: &Entry, [x, y]: Place) {
        let color = entry.color;
        match entry.sign {
            Sign::Solid(shape) => self.marker(shape, [x, y], 2.8, Some(Fill::solid(color)), None),
            Sign::Hollow(shape) => {
                let white = Some(Fill::solid(Rgb::WHITE));
                self.marker(shape, [x, y], 2.6, white, Some(Stroke::new(0.9, color)));
            }
            Sign::Dot => self.marker(Marker::Circle, [x, y], 1.4, Some(Fill::solid(color)), None),
            Sign::Line(dash) => {
                let ends = vec![[x - SIGN_WIDTH / 2.0, y], [x + SIGN_WIDTH / 2.0, y]];
                self.line(ends, Stroke::new(1.2, color), dash);
            }
            Sign::Bar(filling) => {
                let bar = Area::new([x - SIGN_WIDTH / 2.0 + 1.0, y - 3.0], [x + SIGN_WIDTH / 2.0 - 1.0, y + 3.0]);
                self.bar(bar, color, filling);
            }
        }
    }
}

fn around<const N: usize>([x, y]: Place, radius: f64, angles: [f64; N]) -> Vec<Place> {
    angles.iter().map(|angle| [x + radius * angle.cos(), y + radius * angle.sin()]).collect()
}

/// An ordinary text that begins at a place.
pub(super) fn label(text: &str, at: Place, color: Rgb) -> Label {
    Label {
        text: text.to_owned(),
        at,
        align: Align::Start,
        size: TEXT_SIZE,
        weight: Weight::Regular,
        color,
        is_upright: false,
    }
}

/// The baseline of a text whose capital letters have their middle at a height.
pub(super) const fn on_middle(y: f64, size: f64) -> f64 {
    y + typeface::CAP_HEIGHT * size / 2.0
}

/// A text that fits, cut with an ellipsis where it does not.
pub(super) fn shortened(text: &str, size: f64, weight: Weight, room: f64) -> String {
    if typeface::width(text, size, weight) <= room {
        return text.to_owned();
    }
    let mut kept: Vec<char> = text.chars().collect();
    loop {
        let cut: String = kept.iter().collect::<String>().trim_end().to_owned() + "…";
        if kept.is_empty() || typeface::width(&cut, size, weight) <= room {
            return if kept.is_empty() { String::new() } else { cut };
        }
        kept.pop();
    }
}
