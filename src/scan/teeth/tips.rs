//! Crests and roots.

use nalgebra::{Vector2, Vector3};

use crate::geometry::stats::median;
use crate::scan::linear::{Linear, Row, solve};

use super::Measured;
use super::curve::{Curve, Levels};
use super::flanks::Flank;

/// Points near a crest that tell whether it is sharp.
const NUM_AT_TIP: usize = 15;
/// A tip is cut off or round if points near it are missing this many σ of height, and this part of the height.
const CUT_AT_STD: f64 = 4.0;
const CUT_AT_PART: f64 = 0.004;
/// Part of the width of a flat tip, either way of its middle, that tells its level: its edges may be round.
const FLAT_PART: f64 = 0.35;
/// A flat tip whose points are spread by this part of the height along the ridge tells how that is inclined.
const SPREAD_PART: f64 = 0.1;

/// A crest or root.
pub(super) struct Tip {
    pub(super) is_crest: bool,
    pub(super) is_sharp: bool,
    pub(super) place: f64,
    /// Height above the middle.
    pub(super) level: Measured,
    /// How its level rises along the ridge, mm a mm: of flat ones whose points reach along it.
    pub(super) rise: Option<Measured>,
    /// What is left over of the heights of a flat tip, mm, with the profiles, where these are too few to tell how they scatter.
    pub(super) left_over: Vec<(u32, f64)>,
    num_profiles: usize,
}

/// The crests and roots, one between two flanks each.
pub(super) fn tips(curve: &Curve, flanks: &[Flank], levels: Levels) -> Vec<Tip> {
    flanks.windows(2).map(|pair| Tip::between(curve, &pair[0], &pair[1], levels)).collect()
}

/// A point near a tip.
#[derive(Clone, Copy)]
struct Near {
    place: f64,
    /// Above the middle.
    height: f64,
    ridge: f64,
    profile: u32,
}

impl Tip {
    fn between(curve: &Curve, before: &Flank, after: &Flank, levels: Levels) -> Self {
        let is_crest = before.is_rising;
        let sign = if is_crest { 1.0 } else { -1.0 };
        let place = f64::midpoint(before.place, after.place);
        let sharp =
            |level| Self { is_crest, is_sharp: true, place, level, rise: None, left_over: Vec::new(), num_profiles: 0 };
        let apex = apex(before, after).filter(|apex| sign * apex.level.value_mm > 0.0);
        // Where a flank was not seen, the tip begins beyond the gap that the flank is in.
        let [from, to] = [before.place + before.half_gap, after.place - after.half_gap];
        let centre = apex.as_ref().map_or_else(|| f64::midpoint(from, to), |apex| apex.place);
        // The points that stand nearest to where the flanks meet.
        let width = (to - from).abs();
        let mut near: Vec<Near> = curve
            .between(centre - width / 2.0, centre + width / 2.0)
            .iter()
            .map(|(point, profile)| Near {
                place: point.x,
                height: point.y - levels.middle,
                ridge: point.z,
                profile: *profile,
            })
            .collect();
        near.sort_by(|a, b| (a.place - centre).abs().total_cmp(&(b.place - centre).abs()));
        let at_tip = &near[..near.len().min(NUM_AT_TIP.max(near.len() / 60))];
        if at_tip.is_empty() {
            return sharp(apex.map_or(Measured { value_mm: f64::NAN, std_mm: f64::INFINITY }, |apex| apex.level));
        }
        if let Some(apex) = apex
            && !is_cut(at_tip, before, after, sign, levels)
        {
            return sharp(apex.level);
        }
        Self::flat(&near, at_tip, [before, after], levels)
    }
}

impl Tip {
    /// With the variance of how whole profiles are moved, mm², which few profiles on a tip do not tell.
    #[expect(clippy::cast_precision_loss, reason = "a count of profiles")]
    pub(super) fn believe(&mut self, profile_variance: f64) {
        if !self.left_over.is_empty() {
            let of_level = profile_variance / self.num_profiles.max(1) as f64;
            self.level.std_mm = self.level.std_mm.hypot(of_level.sqrt());
        }
    }
}

/// Whether points are missing where two flanks meet.
#[expect(clippy::cast_precision_loss, reason = "a count of profiles")]
fn is_cut(at_tip: &[Near], before: &Flank, after: &Flank, sign: f64, levels: Levels) -> bool {
    let roof = |place: f64| {
        let sides = [before, after].map(|flank| flank.height_at(place).unwrap_or(f64::INFINITY * sign));
        if sign > 0.0 { sides[0].min(sides[1]) } else { sides[0].max(sides[1]) }
    };
    let mut missing: Vec<f64> = at_tip.iter().map(|near| sign * (roof(near.place) - near.height)).collect();
    let height_std =
        [before, after].map(|flank| flank.fit.as_ref().map_or(0.0, |fit| fit.rms / fit.solution.y.abs().max(1e-3)));
    // Points of a profile share the robot's noise, so they count as one.
    let mut profiles: Vec<u32> = at_tip.iter().map(|near| near.profile).collect();
    profiles.sort_unstable();
    profiles.dedup();
    let std = height_std[0].max(height_std[1]);
    // Noise along the part moves points of a sharp tip from under one flank to under the other: they seem to be missing by
    // up to two σ.
    let cut_at = ((2.0 + CUT_AT_STD / (profiles.len() as f64).sqrt()) * std).max(CUT_AT_PART * levels.range);
    median(&mut missing) >= cut_at
}

impl Tip {
    /// One that is cut off or round: its flat middle, between the flanks at that level, tells its level.
    fn flat(near: &[Near], at_tip: &[Near], sides: [&Flank; 2], levels: Levels) -> Self {
        let [before, after] = sides;
        let rough = if before.fit.is_some() && after.fit.is_some() {
            median(&mut at_tip.iter().map(|near| near.height).collect::<Vec<_>>())
        } else {
            // Between the gap and a flank the tip is not in the middle, but it is what reaches farthest.
            outermost(near, before.is_rising)
        };
        let [from, to] = [before.at(rough) + before.half_gap, after.at(rough) - after.half_gap];
        let (middle, reach) = (f64::midpoint(from, to), FLAT_PART * (to - from).abs());
        let inside = |reach: f64| -> Vec<Near> {
            near.iter().filter(|near| (near.place - middle).abs() <= reach).copied().collect()
        };
        let [inner, whole] = [inside(reach), inside((to - from) / 2.0)];
        let points = [&inner[..], &whole[..]].into_iter().find(|points| points.len() >= at_tip.len()).unwrap_or(at_tip);
        let mut tip = Self {
            is_crest: before.is_rising,
            is_sharp: false,
            place: f64::midpoint(before.place, after.place),
            level: Measured { value_mm: rough, std_mm: f64::INFINITY },
            rise: rise(points, levels),
            left_over: Vec::new(),
            num_profiles: 0,
        };
        let row = |near: &Near| Row { terms: [1.0].into(), value: near.height, profile: near.profile };
        if let Some(fit) = solve(&points.iter().map(row).collect::<Vec<_>>()) {
            tip.level = Measured { value_mm: fit.solution.x, std_mm: fit.covariance.x.max(0.0).sqrt() };
            tip.num_profiles = fit.num_profiles;
            if !fit.is_from_profiles {
                tip.left_over = points.iter().map(|near| (near.profile, near.height - fit.solution.x)).collect();
            }
        }
        tip
    }
}

/// The height that a quarter of the points reach.
fn outermost(near: &[Near], is_crest: bool) -> f64 {
    let mut heights: Vec<f64> = near.iter().map(|near| near.height).collect();
    heights.sort_by(f64::total_cmp);
    let place = if is_crest { 3 * heights.len() / 4 } else { heights.len() / 4 };
    heights.get(place.min(heights.len().saturating_sub(1))).copied().unwrap_or(f64::NAN)
}

/// How the level of a flat tip rises along the ridge, where its points reach along it.
#[expect(clippy::cast_precision_loss, reason = "a count of points")]
fn rise(points: &[Near], levels: Levels) -> Option<Measured> {
    let mean = points.iter().map(|near| near.ridge).sum::<f64>() / points.len().max(1) as f64;
    let spread = points.iter().map(|near| (near.ridge - mean).powi(2)).sum::<f64>() / points.len().max(1) as f64;
    if spread.sqrt() < SPREAD_PART * levels.range {
        return None;
    }
    let row =
        |near: &Near| Row { terms: Vector2::new(1.0, near.ridge - mean), value: near.height, profile: near.profile };
    let fit = solve(&points.iter().map(row).collect::<Vec<_>>())?;
    Some(Measured { value_mm: fit.solution.y, std_mm: fit.covariance[(1, 1)].max(0.0).sqrt() })
}

struct Apex {
    place: f64,
    level: Measured,
}

/// Where two flanks meet; `None` where they are upright or parallel.
fn apex(before: &Flank, after: &Flank) -> Option<Apex> {
    let (first, second) = (before.fit.as_ref()?, after.fit.as_ref()?);
    let (b1, b2) = (first.solution.y, second.solution.y);
    let difference = b1 - b2;
    if difference.abs() < 1e-3 {
        return None;
    }
    let level = (after.place - before.place) / difference;
    let variance = |fit: &Linear<3>| {
        let gradient = Vector3::new(1.0, level, 0.0) / difference;
        gradient.dot(&(fit.covariance * gradient))
    };
    let std_mm = (variance(first) + variance(second)).max(0.0).sqrt();
    Some(Apex { place: before.at(level), level: Measured { value_mm: level, std_mm } })
}
