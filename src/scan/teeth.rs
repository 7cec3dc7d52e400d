//! Pitch and height of a part with teeth (Chen et al. 2023, Fig. 8).
//!
//! The part stays the same along its ridges, so its points are looked at along these, as a curve: height over place. Each
//! flank of that curve is fitted by itself, over its whole length; a tooth stands between a flank that rises and one that
//! falls. Its crest is where the two meet, or, where points near there show that the tooth is cut off or round, what these
//! points say. Roots are the same upside down.

use nalgebra::Vector3;

use crate::geometry::Vec3;
use crate::geometry::stats::median;

use super::linear::{Linear, Row, solve};
use super::neighbourhood::{Sample, common_direction};
use super::{Cloud, PointSet, ScanError};

/// Points that are looked at: enough for micrometres.
const NUM_FITTED: usize = 300_000;
/// Points that tell the direction of the ridges.
const NUM_SAMPLED: usize = 12_000;
const NUM_PATCHES: usize = 400;
/// Places along the part, at each of which there is one height.
const NUM_BINS: usize = 600;
/// Part of the height, either way of the middle, over which flanks are fitted: crests and roots may be round.
const FLANK_PART: f64 = 0.3;
/// Part of the height, either way of the middle, that a curve must pass to have gone up or down.
const HYSTERESIS: f64 = 0.2;
/// Times that the directions are refined; they settle within three.
const NUM_PASSES: usize = 6;
/// Points near a crest that tell whether it is sharp.
const NUM_AT_TIP: usize = 15;
/// A tip is cut off or round if points near it are missing this many σ of height, and this part of the height.
const CUT_AT_STD: f64 = 4.0;
const CUT_AT_PART: f64 = 0.004;
/// Waves lower than this many times the roughness of the surface are its noise.
const LEAST_HEIGHT: f64 = 10.0;
/// Above this the surfaces are not those of a part that stays the same in one direction, rad.
const MOST_MISFIT: f64 = 0.2;

/// A value and its standard deviation, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// The value, mm.
    pub value_mm: f64,
    /// Its standard deviation, mm.
    pub std_mm: f64,
}

/// One tooth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tooth {
    /// Where it is along the part, from the first one, mm.
    pub place_mm: f64,
    /// From this tooth to the next; `None` for the last.
    pub pitch: Option<Measured>,
    /// From the roots beside it to its crest; `None` where neither root was seen.
    pub height: Option<Measured>,
    /// Whether the flanks meet in its crest; otherwise it is cut off or round.
    pub is_sharp: bool,
}

/// The teeth of a part.
#[derive(Clone, Debug, PartialEq)]
pub struct Teeth {
    /// From tooth to tooth.
    pub along: Vec3,
    /// From the roots to the crests.
    pub up: Vec3,
    /// Along the ridges.
    pub ridge: Vec3,
    /// In order along the part.
    pub teeth: Vec<Tooth>,
}

/// How measured values compare with the nominal one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deviation {
    /// Mean of the values, mm.
    pub mean_value_mm: f64,
    /// Mean size of the errors, mm.
    pub mean_error_mm: f64,
    /// The greatest size of an error, mm.
    pub max_error_mm: f64,
}

impl Teeth {
    /// All pitches.
    pub fn pitches(&self) -> impl Iterator<Item = Measured> + '_ {
        self.teeth.iter().filter_map(|tooth| tooth.pitch)
    }

    /// All heights.
    pub fn heights(&self) -> impl Iterator<Item = Measured> + '_ {
        self.teeth.iter().filter_map(|tooth| tooth.height)
    }
}

impl Deviation {
    /// Compares values with a nominal one, mm; `None` without values.
    #[must_use]
    #[expect(clippy::cast_precision_loss, reason = "a count of teeth")]
    pub fn of(values: impl Iterator<Item = Measured>, nominal_mm: f64) -> Option<Self> {
        let values: Vec<f64> = values.map(|measured| measured.value_mm).collect();
        let mean = |sum: f64| sum / values.len() as f64;
        let errors = || values.iter().map(|value| (value - nominal_mm).abs());
        (!values.is_empty()).then(|| Self {
            mean_value_mm: mean(values.iter().sum()),
            mean_error_mm: mean(errors().sum()),
            max_error_mm: errors().fold(0.0, f64::max),
        })
    }
}

/// Finds the teeth in a region and measures them.
///
/// # Errors
/// [`ScanError::TooFewPoints`], [`ScanError::NotPrismatic`] or [`ScanError::TooFewTeeth`].
pub fn measure_teeth(cloud: &Cloud, set: &PointSet) -> Result<Teeth, ScanError> {
    const NEEDED: usize = 200;
    if set.len() < NEEDED {
        return Err(ScanError::TooFewPoints { what: "teeth", found: set.len(), needed: NEEDED });
    }
    let sample = Sample::of(cloud, set, NUM_SAMPLED);
    let toward_sensor = cloud.toward_sensor().unwrap_or_else(Vec3::z);
    let mut frame = Axes::start(&sample, toward_sensor)?;
    let points: Vec<(Vec3, u32)> =
        set.thinned(NUM_FITTED).into_iter().map(|idx| (cloud.offset_mm(idx), cloud.profile_idx()[idx])).collect();
    let points = frame.on_part(points);
    let mut found = Curve::of(&points, &frame).features();
    for _ in 0..NUM_PASSES {
        if found.tips.len() < 2 {
            break;
        }
        let turn = frame.refine(&found);
        found = Curve::of(&points, &frame).features();
        if turn < 1e-7 {
            break;
        }
    }
    let teeth = found.teeth();
    let mut heights: Vec<f64> = teeth.iter().filter_map(|tooth| Some(tooth.height?.value_mm)).collect();
    if heights.is_empty() || median(&mut heights) < LEAST_HEIGHT * sample.roughness_mm() {
        return Err(ScanError::TooFewTeeth { found: 0 });
    }
    if teeth.len() < 2 {
        return Err(ScanError::TooFewTeeth { found: teeth.len() });
    }
    Ok(Teeth { along: frame.along, up: frame.up, ridge: frame.ridge, teeth })
}

/// The directions of the part.
#[derive(Clone, Copy, Debug)]
struct Axes {
    along: Vec3,
    up: Vec3,
    ridge: Vec3,
}

impl Axes {
    /// The ridges from the patches of the surface, the row of teeth from where the points reach farthest across the ridges.
    fn start(sample: &Sample, toward_sensor: Vec3) -> Result<Self, ScanError> {
        let normals: Vec<Vec3> = sample.patches(NUM_PATCHES).iter().map(|patch| patch.plane.normal).collect();
        let (ridge, misfit) = common_direction(&normals).ok_or(ScanError::TooFewTeeth { found: 0 })?;
        if misfit > MOST_MISFIT {
            return Err(ScanError::NotPrismatic { misfit_deg: misfit.to_degrees() });
        }
        let across = |point: &Vec3| point - ridge * ridge.dot(point);
        let flat: Vec<Vec3> = sample.points.iter().map(across).collect();
        #[expect(clippy::cast_precision_loss, reason = "a count of points")]
        let mean = flat.iter().sum::<Vec3>() / flat.len() as f64;
        let scatter = flat
            .iter()
            .fold(crate::geometry::Mat3::zeros(), |sum, point| sum + (point - mean) * (point - mean).transpose());
        let eigen = scatter.symmetric_eigen();
        let along = eigen.eigenvectors.column(eigen.eigenvalues.imax()).into_owned();
        let up = ridge.cross(&along);
        let up = if up.dot(&toward_sensor) < 0.0 { -up } else { up };
        Ok(Self { along: up.cross(&ridge), up, ridge })
    }

    /// The points of those strips across the ridges that reach up to the crests: beside the part there is only ground.
    fn on_part(&self, points: Vec<(Vec3, u32)>) -> Vec<(Vec3, u32)> {
        const NUM_STRIPS: usize = 50;
        const END_STRIPS: usize = 2;
        let ends = |values: &mut dyn Iterator<Item = f64>| {
            values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| [low.min(value), high.max(value)])
        };
        let [first, last] = ends(&mut points.iter().map(|(point, _)| self.ridge.dot(point)));
        #[expect(
            clippy::cast_precision_loss,
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "one of a few strips"
        )]
        let strip_of = |point: &Vec3| {
            let part = (self.ridge.dot(point) - first) / (last - first).max(f64::MIN_POSITIVE);
            ((part * NUM_STRIPS as f64) as usize).min(NUM_STRIPS - 1)
        };
        let mut strips: Vec<Vec<f64>> = vec![Vec::new(); NUM_STRIPS];
        for (point, _) in &points {
            strips[strip_of(point)].push(self.up.dot(point));
        }
        // Nine tenths up, so that a few wild points make no part; crests take more than that of the room.
        let tops: Vec<f64> = strips
            .iter_mut()
            .map(|heights| {
                let place = heights.len() * 9 / 10;
                if heights.is_empty() {
                    f64::NEG_INFINITY
                } else {
                    *heights.select_nth_unstable_by(place, f64::total_cmp).1
                }
            })
            .collect();
        let highest = tops.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let [lowest, _] = ends(&mut points.iter().map(|(point, _)| self.up.dot(point)));
        let is_high: Vec<bool> = tops.iter().map(|top| *top > lowest + 0.75 * (highest - lowest)).collect();
        // Strips at the part's ends hold some of the ground as well.
        let is_part = |strip: usize| {
            is_high[strip.saturating_sub(END_STRIPS)..(strip + END_STRIPS + 1).min(NUM_STRIPS)]
                .iter()
                .all(|is_high| *is_high)
        };
        points.into_iter().filter(|(point, _)| is_part(strip_of(point))).collect()
    }

    /// Turns the axes so that crests and roots lie level and flanks run along the ridges; by how much, rad.
    fn refine(&mut self, found: &Features) -> f64 {
        // Height of the tips over their place, with a level of their own for crests and roots.
        let rows: Vec<Row<3>> = found
            .tips
            .iter()
            .map(|tip| {
                let [crest, root] = if tip.is_crest { [1.0, 0.0] } else { [0.0, 1.0] };
                Row { terms: Vector3::new(crest, root, tip.place), value: tip.level.value_mm, profile: 0 }
            })
            .collect();
        let slope = solve(&rows).map_or_else(|| level_slope(&found.tips), |fit| fit.solution.z);
        // A flank is place = a + b height + c ridge: if the true ridge is off by (α along, β up), then c = α − b β.
        let rows: Vec<Row<2>> = found
            .flanks
            .iter()
            .filter_map(|flank| flank.fit.as_ref())
            .map(|fit| Row { terms: [1.0, -fit.solution.y].into(), value: fit.solution.z, profile: 0 })
            .collect();
        let turn = solve(&rows).map(|fit| fit.solution).unwrap_or_default();
        let ridge = (self.ridge + self.along * turn.x + self.up * turn.y).normalize();
        let along = self.along + self.up * slope;
        self.ridge = ridge;
        self.along = (along - ridge * ridge.dot(&along)).normalize();
        let up = ridge.cross(&self.along);
        self.up = if up.dot(&self.up) < 0.0 { -up } else { up };
        slope.abs() + turn.amax()
    }
}

/// From two tips of a kind, where there are too few for a fit.
fn level_slope(tips: &[Tip]) -> f64 {
    let of_kind = |is_crest: bool| tips.iter().filter(move |tip| tip.is_crest == is_crest);
    let slope = |is_crest: bool| {
        let (first, last) = (of_kind(is_crest).next()?, of_kind(is_crest).next_back()?);
        (last.place > first.place).then(|| (last.level.value_mm - first.level.value_mm) / (last.place - first.place))
    };
    slope(true).or_else(|| slope(false)).unwrap_or(0.0)
}

/// The part as a curve.
struct Curve {
    /// (place along, height, place on the ridge) of each point, mm, with its profile.
    points: Vec<(Vector3<f64>, u32)>,
}

/// One side of a tooth.
struct Flank {
    is_rising: bool,
    /// Where it passes the middle height.
    place: f64,
    /// place = a + b (height − middle) + c ridge; none where a flank is too steep to be seen.
    fit: Option<Linear<3>>,
    /// Standard deviation of `place`.
    std_mm: f64,
}

impl Flank {
    /// Its place at a height above the middle.
    fn at(&self, height: f64) -> f64 {
        self.place + self.fit.as_ref().map_or(0.0, |fit| fit.solution.y) * height
    }

    /// Height above the middle at a place, where it is not upright.
    fn height_at(&self, place: f64) -> Option<f64> {
        let slope = self.fit.as_ref()?.solution.y;
        (slope.abs() > 1e-6).then(|| (place - self.place) / slope)
    }
}

/// A crest or root.
struct Tip {
    is_crest: bool,
    is_sharp: bool,
    place: f64,
    place_std_mm: f64,
    /// Height above the middle.
    level: Measured,
}

struct Features {
    flanks: Vec<Flank>,
    /// One between two flanks each.
    tips: Vec<Tip>,
}

impl Curve {
    fn of(points: &[(Vec3, u32)], axes: &Axes) -> Self {
        let place = |point: &Vec3| Vector3::new(axes.along.dot(point), axes.up.dot(point), axes.ridge.dot(point));
        let mut points: Vec<(Vector3<f64>, u32)> =
            points.iter().map(|(point, profile)| (place(point), *profile)).collect();
        points.sort_by(|a, b| a.0.x.total_cmp(&b.0.x));
        Self { points }
    }

    /// The points between two places.
    fn between(&self, from: f64, to: f64) -> &[(Vector3<f64>, u32)] {
        let start = self.points.partition_point(|(point, _)| point.x < from);
        let end = self.points.partition_point(|(point, _)| point.x < to);
        &self.points[start.min(end)..end]
    }

    /// Heights at evenly spread places: the median of the points there.
    #[expect(clippy::cast_precision_loss, reason = "a count of bins")]
    fn outline(&self) -> Vec<[f64; 2]> {
        let (Some(first), Some(last)) = (self.points.first(), self.points.last()) else { return Vec::new() };
        let width = (last.0.x - first.0.x) / NUM_BINS as f64;
        let mut outline = Vec::new();
        for bin in 0..NUM_BINS {
            let from = first.0.x + width * bin as f64;
            let mut heights: Vec<f64> = self.between(from, from + width).iter().map(|(point, _)| point.y).collect();
            if !heights.is_empty() {
                outline.push([from + width / 2.0, median(&mut heights)]);
            }
        }
        outline
    }

    fn features(&self) -> Features {
        let outline = self.outline();
        let Some((middle, range)) = levels(&outline) else {
            return Features { flanks: Vec::new(), tips: Vec::new() };
        };
        let crossings = crossings(&outline, middle, range);
        let flanks: Vec<Flank> = crossings
            .iter()
            .enumerate()
            .map(|(idx, crossing)| {
                let before = idx.checked_sub(1).map_or(f64::NEG_INFINITY, |idx| crossings[idx].place);
                let after = crossings.get(idx + 1).map_or(f64::INFINITY, |next| next.place);
                let from = f64::midpoint(before, crossing.place).max(crossing.place - 2.0 * range);
                let to = f64::midpoint(after, crossing.place).min(crossing.place + 2.0 * range);
                self.flank(crossing, self.between(from, to), middle, range)
            })
            .collect();
        let tips = flanks.windows(2).map(|pair| self.tip(&pair[0], &pair[1], middle, range)).collect();
        Features { flanks, tips }
    }

    #[expect(clippy::unused_self, reason = "reads as a part of the curve")]
    fn flank(&self, crossing: &Crossing, points: &[(Vector3<f64>, u32)], middle: f64, range: f64) -> Flank {
        let ridge = points.first().map_or(0.0, |(point, _)| point.z);
        let rows: Vec<Row<3>> = points
            .iter()
            .filter(|(point, _)| (point.y - middle).abs() <= FLANK_PART * range)
            .map(|(point, profile)| Row {
                terms: Vector3::new(1.0, point.y - middle, point.z - ridge),
                value: point.x,
                profile: *profile,
            })
            .collect();
        let fit = solve(&rows).filter(|fit| fit.num_used >= 10);
        match fit {
            Some(mut fit) => {
                // At the middle of the ridge, where it is known best.
                #[expect(clippy::cast_precision_loss, reason = "a count of points")]
                let ridge = rows.iter().map(|row| row.terms.z).sum::<f64>() / rows.len() as f64;
                let at = Vector3::new(1.0, 0.0, ridge);
                let std_mm = at.dot(&(fit.covariance * at)).max(0.0).sqrt();
                let place = at.dot(&fit.solution);
                fit.solution.x = place;
                Flank { is_rising: crossing.is_rising, place, fit: Some(fit), std_mm }
            }
            None => Flank {
                is_rising: crossing.is_rising,
                place: crossing.place,
                fit: None,
                // Anywhere in the gap.
                std_mm: crossing.gap / 12.0_f64.sqrt(),
            },
        }
    }

    #[expect(clippy::cast_precision_loss, reason = "a count of profiles")]
    fn tip(&self, before: &Flank, after: &Flank, middle: f64, range: f64) -> Tip {
        let is_crest = before.is_rising;
        let sign = if is_crest { 1.0 } else { -1.0 };
        let place = f64::midpoint(before.place, after.place);
        let place_std_mm = before.std_mm.hypot(after.std_mm) / 2.0;
        let of = |level, is_sharp| Tip { is_crest, is_sharp, place, place_std_mm, level };
        let apex = apex(before, after).filter(|apex| sign * apex.level.value_mm > 0.0);
        let centre = apex.as_ref().map_or(place, |apex| apex.place);
        // The points that stand nearest to where the flanks meet, as heights above the middle.
        let width = (after.place - before.place).abs();
        let mut near: Vec<(f64, f64, u32)> = self
            .between(centre - width / 2.0, centre + width / 2.0)
            .iter()
            .map(|(point, profile)| (point.x, point.y - middle, *profile))
            .collect();
        near.sort_by(|a, b| (a.0 - centre).abs().total_cmp(&(b.0 - centre).abs()));
        let at_tip = &near[..near.len().min(NUM_AT_TIP.max(near.len() / 60))];
        if at_tip.is_empty() {
            return of(apex.map_or(Measured { value_mm: f64::NAN, std_mm: f64::INFINITY }, |apex| apex.level), true);
        }
        if let Some(apex) = &apex {
            let roof = |place: f64| {
                let sides = [before, after].map(|flank| flank.height_at(place).unwrap_or(f64::INFINITY * sign));
                if is_crest { sides[0].min(sides[1]) } else { sides[0].max(sides[1]) }
            };
            let mut missing: Vec<f64> =
                at_tip.iter().map(|(place, height, _)| sign * (roof(*place) - height)).collect();
            let height_std = [before, after]
                .map(|flank| flank.fit.as_ref().map_or(0.0, |fit| fit.rms / fit.solution.y.abs().max(1e-3)));
            // Points of a profile share the robot's noise, so they count as one.
            let mut profiles: Vec<u32> = at_tip.iter().map(|(.., profile)| *profile).collect();
            profiles.sort_unstable();
            profiles.dedup();
            let std = height_std[0].max(height_std[1]);
            // Noise along the part moves points of a sharp tip from under one flank to under the other: they seem to be
            // missing by up to two σ.
            let cut_at = ((2.0 + CUT_AT_STD / (profiles.len() as f64).sqrt()) * std).max(CUT_AT_PART * range);
            if median(&mut missing) < cut_at {
                return of(apex.level, true);
            }
        }
        of(flat_level(&near, at_tip, before, after, centre), false)
    }
}

/// The level of a tip that is cut off or round: of its flat middle, between the flanks at that level.
fn flat_level(
    near: &[(f64, f64, u32)],
    at_tip: &[(f64, f64, u32)],
    before: &Flank,
    after: &Flank,
    centre: f64,
) -> Measured {
    let mut heights: Vec<f64> = at_tip.iter().map(|(_, height, _)| *height).collect();
    let rough = median(&mut heights);
    let reach = 0.3 * (after.at(rough) - before.at(rough)).abs();
    let row = |(_, height, profile): &(f64, f64, u32)| Row { terms: [1.0].into(), value: *height, profile: *profile };
    let middle: Vec<Row<1>> = near.iter().filter(|(place, ..)| (place - centre).abs() <= reach).map(row).collect();
    let rows = if middle.len() < at_tip.len() { at_tip.iter().map(row).collect() } else { middle };
    solve(&rows).map_or(Measured { value_mm: rough, std_mm: f64::INFINITY }, |fit| Measured {
        value_mm: fit.solution.x,
        std_mm: fit.covariance.x.max(0.0).sqrt(),
    })
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

/// The height between crests and roots that the outline passes most often, and how far apart these are. The ground beside
/// the part is lower than its roots, but is passed only at its ends.
fn levels(outline: &[[f64; 2]]) -> Option<(f64, f64)> {
    const NUM_LEVELS: u8 = 60;
    /// Part of the whole height that noise does not pass.
    const ABOVE_NOISE: f64 = 0.02;
    if outline.len() < NUM_BINS / 10 {
        return None;
    }
    let mut heights: Vec<f64> = outline.iter().map(|[_, height]| *height).collect();
    heights.sort_by(f64::total_cmp);
    // A spike or two beside the part are no teeth.
    let end = heights.len() / 50;
    let (low, high) = (heights[end], heights[heights.len() - 1 - end]);
    let level = |number: u8| low + (high - low) * (f64::from(number) + 0.5) / f64::from(NUM_LEVELS);
    let noise = ABOVE_NOISE * (high - low);
    let passed: Vec<usize> =
        (0..NUM_LEVELS).map(|number| crossings(outline, level(number), noise / HYSTERESIS).len()).collect();
    let most = passed.iter().copied().max()?;
    let is_between = |(_, passed): &(u8, &usize)| **passed == most;
    let first = (0..).zip(&passed).find(is_between)?.0;
    let last = (0..).zip(&passed).filter(is_between).last()?.0;
    let margin = (high - low) / f64::from(NUM_LEVELS);
    Some((f64::midpoint(level(first), level(last)), level(last) - level(first) + margin + 2.0 * noise))
}

struct Crossing {
    is_rising: bool,
    place: f64,
    /// Between the last place on one side and the first on the other.
    gap: f64,
}

/// Where the outline goes up or down for good.
fn crossings(outline: &[[f64; 2]], middle: f64, range: f64) -> Vec<Crossing> {
    let mut crossings = Vec::new();
    let mut is_high: Option<bool> = None;
    let mut last = [f64::NAN; 2];
    for [place, height] in outline {
        let off = (height - middle) / range;
        if off.abs() < HYSTERESIS {
            continue;
        }
        let now = off > 0.0;
        if is_high.is_some_and(|before| before != now) {
            // Where a straight line between the two passes the middle.
            let part = (middle - last[1]) / (height - last[1]);
            crossings.push(Crossing {
                is_rising: now,
                place: last[0] + part * (place - last[0]),
                gap: place - last[0],
            });
        }
        is_high = Some(now);
        last = [*place, *height];
    }
    crossings
}

impl Features {
    fn teeth(&self) -> Vec<Tooth> {
        let crests: Vec<usize> = (0..self.tips.len()).filter(|idx| self.tips[*idx].is_crest).collect();
        let Some(first) = crests.first() else { return Vec::new() };
        let start = self.tips[*first].place;
        crests
            .iter()
            .enumerate()
            .map(|(number, &idx)| {
                let crest = &self.tips[idx];
                let pitch = crests.get(number + 1).map(|next| {
                    let next = &self.tips[*next];
                    Measured { value_mm: next.place - crest.place, std_mm: next.place_std_mm.hypot(crest.place_std_mm) }
                });
                let before = idx.checked_sub(1).and_then(|idx| self.tips.get(idx));
                Tooth {
                    place_mm: crest.place - start,
                    pitch,
                    height: height(crest, before, self.tips.get(idx + 1)),
                    is_sharp: crest.is_sharp,
                }
            })
            .collect()
    }
}

/// From the roots beside a crest, between which the ground is a straight line, to the crest.
fn height(crest: &Tip, before: Option<&Tip>, after: Option<&Tip>) -> Option<Measured> {
    let ground = match (before, after) {
        (Some(before), Some(after)) => {
            let part = (crest.place - before.place) / (after.place - before.place);
            let (a, b) = (before.level, after.level);
            Measured {
                value_mm: a.value_mm + part * (b.value_mm - a.value_mm),
                std_mm: (a.std_mm * (1.0 - part)).hypot(b.std_mm * part),
            }
        }
        (Some(root), None) | (None, Some(root)) => root.level,
        (None, None) => return None,
    };
    let height =
        Measured { value_mm: crest.level.value_mm - ground.value_mm, std_mm: crest.level.std_mm.hypot(ground.std_mm) };
    height.value_mm.is_finite().then_some(height)
}
