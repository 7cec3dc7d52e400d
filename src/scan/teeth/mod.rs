//! Pitch and height of a part with teeth (Chen et al. 2023, Fig. 8).
//!
//! The part stays the same along its ridges, so its points are looked at along these, as a curve: height over place. Each
//! flank of that curve is fitted over its whole length; a tooth stands between a flank that rises and one that falls. Its
//! crest is where the two meet, or, where points near there show that the tooth is cut off or round, what these points say.
//! Roots are the same upside down. A flank that too few profiles met to tell its slope is taken to be as steep as the others
//! of its side; one that no profile met, such as an upright wall, is somewhere in the gap between what was seen before and
//! after it.

mod axes;
mod curve;
mod flanks;
mod outline;
mod tips;

use crate::geometry::Vec3;
use crate::geometry::stats::median;

use super::neighbourhood::Sample;
use super::{Cloud, PointSet, ScanError};

use axes::Axes;
use curve::{Curve, Features};
use tips::Tip;

/// Points that are looked at: enough for micrometres.
const NUM_FITTED: usize = 300_000;
/// Points that tell the direction of the ridges.
const NUM_SAMPLED: usize = 12_000;
/// Times that the directions are refined; they settle within three.
const NUM_PASSES: usize = 6;
/// Waves lower than this many times the roughness of the surface are its noise.
const LEAST_HEIGHT: f64 = 10.0;

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
    /// From this tooth to the next; `None` for the last. From middle to middle; where only one side of the teeth was seen,
    /// from flank to flank.
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
                let before = idx.checked_sub(1).and_then(|idx| self.tips.get(idx));
                Tooth {
                    place_mm: crest.place - start,
                    pitch: crests.get(number + 1).map(|next| self.pitch(idx, *next)),
                    height: height(crest, before, self.tips.get(idx + 1)),
                    is_sharp: crest.is_sharp,
                }
            })
            .collect()
    }

    /// From the middle of a tooth to that of the next, or from flank to flank if the other side of either was not seen.
    fn pitch(&self, crest_idx: usize, next_idx: usize) -> Measured {
        // A tip stands between the flank of its own index and the next one.
        let step = |side: usize| {
            let (from, to) = (&self.flanks[crest_idx + side], &self.flanks[next_idx + side]);
            let was_seen = from.fit.is_some() && to.fit.is_some();
            (was_seen, Measured { value_mm: to.place - from.place, std_mm: to.std_mm.hypot(from.std_mm) })
        };
        match [step(0), step(1)] {
            [(true, of_rising), (false, _)] => of_rising,
            [(false, _), (true, of_falling)] => of_falling,
            [(_, of_rising), (_, of_falling)] => Measured {
                value_mm: f64::midpoint(of_rising.value_mm, of_falling.value_mm),
                std_mm: of_rising.std_mm.hypot(of_falling.std_mm) / 2.0,
            },
        }
    }
}

/// From the roots beside a crest, between which the ground is a straight line, to the crest.
fn height(crest: &Tip, before: Option<&Tip>, after: Option<&Tip>) -> Option<Measured> {
    let known = |tip: &&Tip| tip.level.std_mm.is_finite();
    let ground = match (before.filter(known), after.filter(known)) {
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
    (height.value_mm.is_finite() && height.std_mm.is_finite()).then_some(height)
}
