//! A plot as data: axes, what is marked in them, and the legend. `frame` gives everything its place on the page.

use super::ink::{Fill, Stroke};
use super::palette::{Marker, Rgb};
use super::scale::Extent;

/// An axis.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Axis {
    /// Its title with its unit; none where another plot next to it says it.
    pub title: String,
    /// Names for its marks in place of numbers; mark `n` stands at `n`.
    pub names: Option<Vec<String>>,
    /// Whether only whole numbers are marked.
    pub is_whole: bool,
    /// Whether its values are the powers of ten of what it is labelled with; of the axis below only.
    pub is_logarithmic: bool,
    /// Whether it has labels at its marks.
    pub is_labelled: bool,
}

impl Axis {
    /// With a title with its unit.
    pub fn new(title: impl Into<String>) -> Self {
        Self { title: title.into(), is_labelled: true, ..Self::default() }
    }

    /// With names in place of numbers.
    pub fn named(title: impl Into<String>, names: Vec<String>) -> Self {
        Self { names: Some(names), ..Self::new(title) }
    }
}

/// How a line goes on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Dash {
    /// Without gaps.
    #[default]
    Solid,
    /// In dashes.
    Dashed,
    /// In dots.
    Dotted,
}

/// How a bar is filled; each can be told from the others without colour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Filling {
    /// Of one colour.
    Solid,
    /// Faint, with a border.
    Faint,
    /// With a border alone.
    Hollow,
    /// Hatched, with a border.
    Hatched,
}

/// Something marked in a plot, in its data's units; what comes later lies on top.
#[derive(Clone, Debug, PartialEq)]
pub enum Mark {
    /// Points of a profile: so many that each counts for little. Those that would cover each other are drawn once.
    Dots {
        /// Where.
        points: Vec<[f64; 2]>,
        /// Radius, points on the page.
        radius: f64,
        /// Their colour.
        color: Rgb,
        /// Whether they are rings.
        is_hollow: bool,
    },
    /// Markers, each of which counts.
    Markers {
        /// Where.
        points: Vec<[f64; 2]>,
        /// Their shape.
        shape: Marker,
        /// Radius, points on the page.
        radius: f64,
        /// What they are filled with.
        fill: Option<Rgb>,
        /// Their border.
        stroke: Stroke,
    },
    /// A cross of lines.
    Cross {
        /// Where.
        at: [f64; 2],
        /// How far its arms reach, points on the page.
        reach: f64,
        /// How it is drawn.
        stroke: Stroke,
    },
    /// A line through points.
    Line {
        /// The points.
        points: Vec<[f64; 2]>,
        /// How it is drawn.
        stroke: Stroke,
        /// How it goes on.
        dash: Dash,
    },
    /// A line across the plot at a value of y, or of x.
    Across {
        /// The value.
        at: f64,
        /// Whether it is a value of x, and the line stands upright.
        is_upright: bool,
        /// How it is drawn.
        stroke: Stroke,
        /// How it goes on.
        dash: Dash,
    },
    /// A band from the bottom to the top of the plot.
    Band {
        /// From x to x; at least a hair wide on the page.
        x: [f64; 2],
        /// What it is filled with.
        fill: Fill,
    },
    /// A bar from the line y = 0 to a value.
    Bar {
        /// From x to x.
        x: [f64; 2],
        /// The value.
        y: f64,
        /// Its colour.
        color: Rgb,
        /// How it is filled.
        filling: Filling,
    },
    /// An error bar along y.
    ErrorBar {
        /// Its middle.
        at: [f64; 2],
        /// Its half.
        std: f64,
        /// How it is drawn.
        stroke: Stroke,
    },
    /// An area.
    Area {
        /// Its corners.
        corners: Vec<[f64; 2]>,
        /// What it is filled with.
        fill: Fill,
    },
}

/// A word beside something. It moves to where nothing is, and stays away where there is no such place.
#[derive(Clone, Debug, PartialEq)]
pub struct Note {
    /// What it stands beside, in the plot's units.
    pub at: [f64; 2],
    /// What it says.
    pub text: String,
    /// Its colour.
    pub color: Rgb,
    /// Where it stands best.
    pub side: NoteSide,
}

/// Where a note stands best, seen from what it is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoteSide {
    /// At its right.
    Right,
    /// At its left.
    Left,
    /// Above.
    Above,
    /// Below.
    Below,
}

/// The sign of an entry of a legend.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sign {
    /// A marker filled with the colour.
    Solid(Marker),
    /// A marker of which only the border has the colour.
    Hollow(Marker),
    /// A small dot.
    Dot,
    /// A line.
    Line(Dash),
    /// A bar.
    Bar(Filling),
}

/// An entry of a legend.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// Its sign.
    pub sign: Sign,
    /// The sign's colour.
    pub color: Rgb,
    /// What it stands for.
    pub text: String,
}

impl Entry {
    /// A sign with what it stands for.
    pub fn new(sign: Sign, color: Rgb, text: impl Into<String>) -> Self {
        Self { sign, color, text: text.into() }
    }
}

/// A plot.
#[derive(Clone, Debug, PartialEq)]
pub struct Plot {
    /// What stands above it; none where the figure's title says it.
    pub heading: Option<String>,
    /// The axis below.
    pub x: Axis,
    /// The axis at the left.
    pub y: Axis,
    /// What is shown.
    pub view: Extent,
    /// Whether `view` has its margins already.
    pub is_view_final: bool,
    /// Whether y grows downwards.
    pub inverts_y: bool,
    /// Whether a millimetre is equally long both ways.
    pub has_equal_scales: bool,
    /// What is marked.
    pub marks: Vec<Mark>,
    /// What the signs mean; a row above the plot, where it covers nothing.
    pub legend: Vec<Entry>,
    /// Words in the plot.
    pub notes: Vec<Note>,
}

impl Plot {
    /// An empty plot of an extent.
    #[must_use]
    pub const fn new(x: Axis, y: Axis, view: Extent) -> Self {
        Self {
            heading: None,
            x,
            y,
            view,
            is_view_final: false,
            inverts_y: false,
            has_equal_scales: false,
            marks: Vec::new(),
            legend: Vec::new(),
            notes: Vec::new(),
        }
    }

    /// Adds a mark.
    pub fn mark(&mut self, mark: Mark) {
        self.marks.push(mark);
    }

    /// Adds a line across at a value of y.
    pub fn level(&mut self, at: f64, stroke: Stroke, dash: Dash) {
        self.mark(Mark::Across { at, is_upright: false, stroke, dash });
    }
}

/// The outline of an ellipse; `angle_rad` is that of the first semi-axis, from x towards y.
#[must_use]
pub fn ellipse(centre: [f64; 2], semi_axes: [f64; 2], angle_rad: f64) -> Vec<[f64; 2]> {
    const NUM_CORNERS: u16 = 120;
    let (sin, cos) = angle_rad.sin_cos();
    (0..=NUM_CORNERS)
        .map(|corner| {
            let turn = std::f64::consts::TAU * f64::from(corner) / f64::from(NUM_CORNERS);
            let (along, across) = (semi_axes[0] * turn.cos(), semi_axes[1] * turn.sin());
            [centre[0] + along * cos - across * sin, centre[1] + along * sin + across * cos]
        })
        .collect()
}
