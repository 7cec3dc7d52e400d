//! From the points of a scan or cloud to a profile: which axes are its x and z, and which points are missing.

use std::fmt;
use std::str::FromStr;

use crate::geometry::{Profile, stats};

use super::cdr::BadMessage;
use super::messages::Points;

/// An axis of a message's frame, in its own or the opposite direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SignedAxis {
    /// 0 for x, 1 for y, 2 for z.
    pub idx: usize,
    /// Whether it points the other way.
    pub is_reversed: bool,
}

/// Which axes of a message's frame are the x (along the laser line) and z (away from or towards the sensor) of a profile;
/// the third is across the laser plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ProfileAxes {
    /// Along the line.
    pub x: SignedAxis,
    /// Along the range.
    pub z: SignedAxis,
}

impl ProfileAxes {
    /// The usual ones where the points lie in the plane across an axis: of a scan in x and y, x is ahead.
    #[must_use]
    pub const fn across(axis: usize) -> Self {
        const fn plain(idx: usize) -> SignedAxis {
            SignedAxis { idx, is_reversed: false }
        }
        match axis {
            0 => Self { x: plain(1), z: plain(2) },
            1 => Self { x: plain(0), z: plain(2) },
            _ => Self { x: plain(1), z: plain(0) },
        }
    }

    /// Every choice without a sign.
    #[must_use]
    pub fn all() -> [Self; 6] {
        let plain = |idx| SignedAxis { idx, is_reversed: false };
        [(0, 2), (1, 0), (1, 2), (0, 1), (2, 0), (2, 1)].map(|(x, z)| Self { x: plain(x), z: plain(z) })
    }
}

impl fmt::Display for SignedAxis {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let sign = if self.is_reversed { "-" } else { "" };
        write!(formatter, "{sign}{}", ["x", "y", "z"].get(self.idx).copied().unwrap_or("?"))
    }
}

impl fmt::Display for ProfileAxes {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{},{}", self.x, self.z)
    }
}

impl FromStr for ProfileAxes {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let axis = |word: &str| {
            let word = word.trim();
            let (is_reversed, name) = word.strip_prefix('-').map_or((false, word), |name| (true, name));
            let idx = ["x", "y", "z"].iter().position(|axis| axis.eq_ignore_ascii_case(name))?;
            Some(SignedAxis { idx, is_reversed })
        };
        let axes = text.split_once(',').and_then(|(x, z)| Some(Self { x: axis(x)?, z: axis(z)? }));
        axes.filter(|axes| axes.x.idx != axes.z.idx)
            .ok_or_else(|| format!("found {text}, expected two different axes such as y,x or x,-z"))
    }
}

/// Points that lie so near to a plane, as a part of how far they spread, lie in it.
const FLAT: f64 = 1e-6;

/// How far a reading's points spread along x, y and z; `None` where they are too few, or all the same.
pub(super) fn spreads(points: &Points) -> Option<[f64; 3]> {
    const MIN_POINTS: usize = 3;
    let valid = || points.points.iter().filter(|point| point.iter().all(|value| value.is_finite()));
    let spreads = [0, 1, 2].map(|axis| {
        let (min, max) = valid()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(min, max), point| (min.min(point[axis]), max.max(point[axis])));
        max - min
    });
    (valid().count() >= MIN_POINTS && spreads.iter().any(|spread| *spread > 0.0)).then_some(spreads)
}

/// The axes of a reading by the plane that its points lie in.
///
/// # Errors
/// Points that lie in no plane of two axes.
pub(super) fn detect(spreads: [f64; 3]) -> Result<ProfileAxes, BadMessage> {
    let (flat, spread) =
        (0..3).map(|axis| (axis, spreads[axis])).min_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((2, 0.0));
    let widest = spreads.iter().copied().fold(0.0, f64::max);
    if spread > widest * FLAT {
        let found = format!("points that spread over {spreads:.4?} along x, y and z");
        return Err(BadMessage::Value {
            found,
            needed: "one line in the plane of two axes; or name them with the axes",
        });
    }
    Ok(ProfileAxes::across(flat))
}

/// The largest coordinate, which tells metres from millimetres.
pub(super) fn largest(points: &Points) -> f64 {
    points.points.iter().flatten().filter(|value| value.is_finite()).fold(0.0, |max, value| value.abs().max(max))
}

/// The profile of a reading. A missing point keeps its place: where it has no x of its own, it lies between its neighbours;
/// at the ends it is left away.
pub(super) fn profile(points: &Points, axes: ProfileAxes, unit_in_mm: f64, z_sign: f64) -> Result<Profile, BadMessage> {
    let value = |point: &[f64; 3], axis: SignedAxis| {
        let value = point.get(axis.idx).copied().unwrap_or(f64::NAN) * unit_in_mm;
        if axis.is_reversed { -value } else { value }
    };
    let mut x_mm: Vec<f64> = points.points.iter().map(|point| value(point, axes.x)).collect();
    let z_mm = points.points.iter().map(|point| z_sign * value(point, axes.z));
    let mut z_mm: Vec<Option<f64>> =
        z_mm.zip(&x_mm).map(|(z, x)| (z.is_finite() && x.is_finite()).then_some(z)).collect();
    let last = x_mm.iter().rposition(|x| x.is_finite()).map_or(0, |last| last + 1);
    let first = x_mm.iter().position(|x| x.is_finite()).unwrap_or(last);
    x_mm = x_mm[first..last].to_vec();
    z_mm = z_mm[first..last].to_vec();
    fill(&mut x_mm);
    Profile::new(x_mm, &z_mm)
        .map_err(|error| BadMessage::Value { found: error.to_string(), needed: "another unit, perhaps" })
}

/// Puts steady steps where values are missing between others.
fn fill(x_mm: &mut [f64]) {
    let mut known = 0;
    for idx in 0..x_mm.len() {
        if !x_mm[idx].is_finite() {
            continue;
        }
        #[expect(clippy::cast_precision_loss, reason = "points of a profile")]
        for missing in known + 1..idx {
            let part = (missing - known) as f64 / (idx - known) as f64;
            x_mm[missing] = part.mul_add(x_mm[idx] - x_mm[known], x_mm[known]);
        }
        known = idx;
    }
}

/// Point by point the median of several readings; of readings that are not point by point alike the one in the middle.
pub(super) fn median(profiles: Vec<Profile>) -> Profile {
    /// Less than a tenth of the finest profiler's step.
    const SAME_X_MM: f64 = 1e-3;
    let middle = profiles.len() / 2;
    let Some(first) = profiles.first() else { return Profile::default() };
    let is_alike = |other: &Profile| {
        other.len() == first.len() && other.x_mm().iter().zip(first.x_mm()).all(|(a, b)| (a - b).abs() <= SAME_X_MM)
    };
    if profiles.len() < 3 || !profiles.iter().all(is_alike) {
        return profiles.into_iter().nth(middle).unwrap_or_default();
    }
    let mut values = Vec::with_capacity(profiles.len());
    let z_mm: Vec<Option<f64>> = (0..first.len())
        .map(|idx| {
            values.clear();
            values.extend(profiles.iter().map(|profile| profile.z_mm()[idx]).filter(|z| !z.is_nan()));
            (values.len() * 2 > profiles.len()).then(|| stats::median(&mut values))
        })
        .collect();
    let x_mm = first.x_mm().to_vec();
    Profile::new(x_mm, &z_mm).unwrap_or_else(|_| profiles.into_iter().nth(middle).unwrap_or_default())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(points: &[[f64; 3]]) -> Points {
        Points { stamp_ns: None, points: points.to_vec() }
    }

    #[test]
    fn the_flat_axis_tells_x_and_z() {
        for (flat, expected) in [(0, "y,z"), (1, "x,z"), (2, "y,x")] {
            let mut line = [[0.0, 1.0, 2.0], [1.0, 3.0, 5.0], [2.5, 4.0, 4.0], [f64::NAN; 3]];
            for point in &mut line {
                point[flat] = 0.25;
            }
            let axes = detect(spreads(&points(&line)).expect("enough points")).expect("flat");
            assert_eq!(axes.to_string(), expected);
            assert_eq!(expected.parse(), Ok(axes));
        }
        assert!(detect([2.0, 2.0, 3.0]).is_err());
        assert_eq!(spreads(&points(&[[0.0; 3], [1.0; 3]])), None);
        assert_eq!(spreads(&points(&[[7.0; 3]; 20])), None);
        assert!("x,x".parse::<ProfileAxes>().is_err() && "x".parse::<ProfileAxes>().is_err());
        assert_eq!("x, -z".parse::<ProfileAxes>().map(|axes| axes.to_string()).as_deref(), Ok("x,-z"));
    }

    #[test]
    fn a_missing_point_keeps_its_place() {
        const NAN: f64 = f64::NAN;
        let line = points(&[[NAN; 3], [0.0, 0.0, 0.1], [NAN; 3], [0.002, 0.0, NAN], [0.003, 0.0, 0.2], [NAN; 3]]);
        let profile = profile(&line, ProfileAxes::across(1), 1000.0, 1.0).expect("a profile");
        assert_eq!(profile.x_mm(), [0.0, 1.0, 2.0, 3.0]);
        let valid: Vec<usize> = profile.valid_points().map(|(idx, _, _)| idx).collect();
        assert_eq!(valid, [0, 3]);
    }

    #[test]
    fn the_median_is_taken_point_by_point() {
        let one = |z: Option<f64>| Profile::new(vec![0.0, 1.0], &[z, Some(5.0)]).expect("a profile");
        let median = median(vec![one(Some(1.0)), one(Some(9.0)), one(Some(2.0))]);
        assert_eq!(median.z_mm(), [2.0, 5.0]);
        let mostly_missing = super::median(vec![one(Some(1.0)), one(None), one(None)]);
        assert!(mostly_missing.z_mm()[0].is_nan());
    }
}
