//! What a figure is made of once everything has its place: lines, areas, circles and texts, in points from the upper left
//! corner of the page. Both outputs draw the same.

use super::palette::Rgb;
use super::typeface::{self, Weight};

/// A place on the page: to the right and down, points.
pub type Place = [f64; 2];

/// How a line is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke {
    /// Its width, points.
    pub width: f64,
    /// Its colour.
    pub color: Rgb,
}

impl Stroke {
    /// A line of a width (points) and a colour.
    #[must_use]
    pub const fn new(width: f64, color: Rgb) -> Self {
        Self { width, color }
    }
}

/// What an area is filled with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fill {
    /// The colour.
    pub color: Rgb,
    /// From 0, nothing, to 1.
    pub opacity: f64,
}

impl Fill {
    /// A colour that covers what is below it.
    #[must_use]
    pub const fn solid(color: Rgb) -> Self {
        Self { color, opacity: 1.0 }
    }

    /// A colour through which what is below it shows.
    #[must_use]
    pub const fn veil(color: Rgb, opacity: f64) -> Self {
        Self { color, opacity }
    }
}

/// Which part of a text stands at its place.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Align {
    /// Its beginning.
    #[default]
    Start,
    /// Its middle.
    Middle,
    /// Its end.
    End,
}

/// A line of text.
#[derive(Clone, Debug, PartialEq)]
pub struct Label {
    /// What it says.
    pub text: String,
    /// Where its baseline has the part that `align` names.
    pub at: Place,
    /// Which part that is.
    pub align: Align,
    /// Size of the letters, points.
    pub size: f64,
    /// Their weight.
    pub weight: Weight,
    /// Their colour.
    pub color: Rgb,
    /// Whether it reads from below to above.
    pub is_upright: bool,
}

/// A rectangle on the page.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Area {
    /// Upper left corner.
    pub min: Place,
    /// Lower right corner.
    pub max: Place,
}

impl Area {
    /// By its corners.
    #[must_use]
    pub const fn new(min: Place, max: Place) -> Self {
        Self { min, max }
    }

    /// Its width, points.
    #[must_use]
    pub const fn width(&self) -> f64 {
        self.max[0] - self.min[0]
    }

    /// Its height, points.
    #[must_use]
    pub const fn height(&self) -> f64 {
        self.max[1] - self.min[1]
    }

    /// Its middle.
    #[must_use]
    pub const fn centre(&self) -> Place {
        [f64::midpoint(self.min[0], self.max[0]), f64::midpoint(self.min[1], self.max[1])]
    }

    /// Larger by so much on every side; smaller by less than nothing.
    #[must_use]
    pub const fn grown(&self, by: f64) -> Self {
        Self { min: [self.min[0] - by, self.min[1] - by], max: [self.max[0] + by, self.max[1] + by] }
    }

    /// Whether a place lies in it.
    #[must_use]
    pub fn holds(&self, [x, y]: Place) -> bool {
        (self.min[0]..=self.max[0]).contains(&x) && (self.min[1]..=self.max[1]).contains(&y)
    }

    /// Whether all of another one lies in it.
    #[must_use]
    pub fn holds_all(&self, other: &Self) -> bool {
        self.holds(other.min) && self.holds(other.max)
    }

    /// Whether the two share more than a border.
    #[must_use]
    pub fn overlaps(&self, other: &Self) -> bool {
        (0..2).all(|axis| self.min[axis] < other.max[axis] && other.min[axis] < self.max[axis])
    }

    /// Its corners, all the way round.
    #[must_use]
    pub const fn outline(&self) -> [Place; 4] {
        [self.min, [self.max[0], self.min[1]], self.max, [self.min[0], self.max[1]]]
    }
}

impl Label {
    /// The room that the text takes.
    #[must_use]
    pub fn area(&self) -> Area {
        let width = typeface::width(&self.text, self.size, self.weight);
        let before = match self.align {
            Align::Start => 0.0,
            Align::Middle => width / 2.0,
            Align::End => width,
        };
        let (up, down) = (typeface::ASCENT * self.size, typeface::DESCENT * self.size);
        let [x, y] = self.at;
        if self.is_upright {
            Area::new([x - up, y + before - width], [x + down, y + before])
        } else {
            Area::new([x - before, y - up], [x - before + width, y + down])
        }
    }
}

/// Something drawn; what comes later lies on top.
#[derive(Clone, Debug, PartialEq)]
pub enum Ink {
    /// A line through places.
    Line {
        /// Two or more.
        places: Vec<Place>,
        /// How it is drawn.
        stroke: Stroke,
    },
    /// An area.
    Area {
        /// Its corners, all the way round.
        corners: Vec<Place>,
        /// What it is filled with.
        fill: Fill,
    },
    /// A circle.
    Circle {
        /// Its middle.
        centre: Place,
        /// Its radius, points.
        radius: f64,
        /// What it is filled with.
        fill: Option<Fill>,
        /// Its border.
        stroke: Option<Stroke>,
    },
    /// A text.
    Label(Label),
}

/// A line of dashes and gaps of the given lengths, points.
#[must_use]
pub fn dashed(places: &[Place], dash: f64, gap: f64) -> Vec<Vec<Place>> {
    /// A line far longer than any page has no dashes that anyone could see.
    const MOST_DASHES: usize = 20_000;
    let mut dashes: Vec<Vec<Place>> = Vec::new();
    let (mut is_on, mut left) = (true, dash);
    let mut run: Vec<Place> = places.first().copied().into_iter().collect();
    for pair in places.windows(2) {
        let [from, to] = [pair[0], pair[1]];
        let length = (to[0] - from[0]).hypot(to[1] - from[1]);
        if !length.is_finite() {
            break;
        }
        let mut done = 0.0;
        while length - done > left && dashes.len() < MOST_DASHES {
            done += left;
            let part = done / length;
            let at = [from[0] + (to[0] - from[0]) * part, from[1] + (to[1] - from[1]) * part];
            if is_on {
                run.push(at);
                dashes.push(std::mem::take(&mut run));
            } else {
                run = vec![at];
            }
            is_on = !is_on;
            left = if is_on { dash } else { gap };
        }
        left -= length - done;
        if is_on {
            run.push(to);
        }
    }
    if is_on && run.len() > 1 {
        dashes.push(run);
    }
    dashes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dashes_go_on_round_corners() {
        let dashes = dashed(&[[0.0, 0.0], [5.0, 0.0], [5.0, 5.0]], 4.0, 2.0);
        assert_eq!(dashes, [vec![[0.0, 0.0], [4.0, 0.0]], vec![[5.0, 1.0], [5.0, 5.0]]]);
        assert!(dashed(&[], 4.0, 2.0).is_empty());
        assert!(dashed(&[[0.0, 0.0], [f64::NAN, 0.0]], 4.0, 2.0).is_empty());
    }

    #[test]
    fn a_text_takes_room_above_its_baseline_and_a_little_below() {
        let mut label = Label {
            text: "error / mm".to_owned(),
            at: [100.0, 50.0],
            align: Align::Middle,
            size: 10.0,
            weight: Weight::Regular,
            color: Rgb(0, 0, 0),
            is_upright: false,
        };
        let lying = label.area();
        assert!((lying.centre()[0] - 100.0).abs() < 1e-9 && lying.height() < 11.0);
        label.is_upright = true;
        let standing = label.area();
        assert!((standing.centre()[1] - 50.0).abs() < 1e-9);
        assert!((standing.height() - lying.width()).abs() < 1e-9);
    }
}
