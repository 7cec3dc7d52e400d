//! The colours and markers of data, the same in the window and on paper. Safe for colour-blind eyes (Okabe–Ito), and never
//! the only sign: each colour comes with a marker, a dash or a word.

use crate::calibrate::Method;
use crate::verify::Origin;

/// A colour: red, green, blue.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rgb(pub u8, pub u8, pub u8);

impl Rgb {
    /// White.
    pub const WHITE: Self = Self(0xff, 0xff, 0xff);
}

/// Points on the arc: drawn solid.
pub const INLIER: Rgb = Rgb(0x00, 0x72, 0xb2);
/// Points off the arc: drawn hollow.
pub const OUTLIER: Rgb = Rgb(0xd0, 0x39, 0x2b);
/// Points elsewhere: drawn faint.
pub const UNUSED: Rgb = Rgb(0xb4, 0xbb, 0xc5);
/// A calibration from all targets together.
pub const JOINT: Rgb = Rgb(0xd5, 0x5e, 0x00);
/// A calibration from elsewhere.
pub const GIVEN: Rgb = Rgb(0x56, 0xb4, 0xe9);

/// On paper: text and the marks of what was measured.
pub const TEXT: Rgb = Rgb(0x1b, 0x22, 0x2c);
/// On paper: titles of axes, labels of ticks, lines to read against.
pub const TEXT_DIM: Rgb = Rgb(0x5f, 0x6b, 0x7a);
/// On paper: grid lines and frames.
pub const HAIRLINE: Rgb = Rgb(0xe1, 0xe5, 0xea);
/// On paper: to be looked at.
pub const WARN: Rgb = Rgb(0xb3, 0x5c, 0x00);
/// On paper: bad.
pub const BAD: Rgb = Rgb(0xc2, 0x2f, 0x22);
/// The axes x, y and z of a frame on a light ground; letters stand beside them.
pub const AXES: [Rgb; 3] = [Rgb(0xc2, 0x2f, 0x22), Rgb(0x0f, 0x86, 0x4e), Rgb(0x1f, 0x5f, 0xe0)];

/// The colour that a method has everywhere.
#[must_use]
pub const fn method_color(method: Method) -> Rgb {
    match method {
        Method::BallFixedPoint | Method::FixedPoint => Rgb(0x00, 0x72, 0xb2),
        Method::BallMaxArcStep => Rgb(0x7f, 0x7f, 0x7f),
        Method::BallMaxArc => Rgb(0xd9, 0x7a, 0x00),
        Method::BallBundle | Method::PlateBundle => Rgb(0x00, 0x9e, 0x73),
        Method::PlateOrthogonal => Rgb(0xcc, 0x79, 0xa7),
        Method::Motion => Rgb(0x56, 0x5f, 0xc4),
    }
}

/// What is fitted to points has one colour.
pub const FIT: Rgb = method_color(Method::BallMaxArc);

/// A marker.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Marker {
    /// ●
    Circle,
    /// ▽
    Down,
    /// ▲
    Up,
    /// ■
    Square,
    /// ◆
    Diamond,
}

/// The marker that a method has in every plot.
#[must_use]
pub const fn method_marker(method: Method) -> Marker {
    match method {
        Method::BallFixedPoint | Method::FixedPoint => Marker::Circle,
        Method::BallMaxArcStep => Marker::Down,
        Method::BallMaxArc => Marker::Up,
        Method::BallBundle | Method::PlateBundle => Marker::Square,
        Method::PlateOrthogonal | Method::Motion => Marker::Diamond,
    }
}

/// The same marker as a character, for table heads.
#[must_use]
pub const fn method_symbol(method: Method) -> &'static str {
    match method {
        Method::BallFixedPoint | Method::FixedPoint => "●",
        Method::BallMaxArcStep => "▽",
        Method::BallMaxArc => "▲",
        Method::BallBundle | Method::PlateBundle => "■",
        Method::PlateOrthogonal | Method::Motion => "◆",
    }
}

/// How a calibration that is judged on other data is marked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CalibrationLook {
    /// Its colour.
    pub color: Rgb,
    /// Its marker.
    pub marker: Marker,
    /// Which of the targets it was computed from, if not the first: the same method on another target looks hollow.
    pub further: Option<usize>,
}

/// The look of a calibration, by where it comes from.
#[must_use]
pub fn calibration_look(origin: &Origin) -> CalibrationLook {
    let further = match origin {
        Origin::Solved { target_idx, .. } => Some(*target_idx).filter(|idx| *idx > 0),
        _ => None,
    };
    let (color, marker) = match (origin, origin.method()) {
        (_, Some(method)) => (method_color(method), method_marker(method)),
        (Origin::Joint { .. }, _) => (JOINT, Marker::Diamond),
        _ => (GIVEN, Marker::Down),
    };
    CalibrationLook { color, marker, further }
}

/// Colours of regions of a scanned part, in the order of their use.
const REGIONS: [Rgb; 7] = [
    Rgb(0x00, 0x72, 0xb2),
    Rgb(0xd9, 0x7a, 0x00),
    Rgb(0x00, 0x9e, 0x73),
    Rgb(0xcc, 0x79, 0xa7),
    Rgb(0x56, 0xb4, 0xe9),
    Rgb(0xd5, 0x5e, 0x00),
    Rgb(0xc9, 0xb8, 0x2e),
];

/// The colour of the so-many-th region.
#[must_use]
pub const fn region_color(idx: usize) -> Rgb {
    REGIONS[idx % REGIONS.len()]
}
