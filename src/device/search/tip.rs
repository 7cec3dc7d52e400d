//! The search for a tip as a pure state machine: the line is led across what sticks out, and how far that sticks out is measured
//! on either side. Where the two flanks of these heights meet, the line is on the tip.
//!
//! A cone's section is as much lower as it is beside the tip, on either side and however the sensor is tilted: its flanks are
//! straight, so a few heights on each are enough. They are taken near the tip: further down the shaft begins, and falls
//! differently. What is seen beside a tip is no tip, so only the last profile is kept.
//!
//! Tilted, the flank that turns away from the camera is seen for a fraction of a millimetre or not at all: then the tip is where
//! the section vanishes.

use thiserror::Error;

use crate::fit::{EdgeFit, PointClass};
use crate::geometry::Profile;
use crate::geometry::stats::median;

use super::settings::{SearchSettings, SettingsRefusal};

/// Heights on each flank, and the fewest on the one that is seen well.
const NUM_ON_FLANK: u8 = 4;
const FEWEST_ON_FLANK: usize = 2;
/// They are this part of a step apart.
const APART_STEPS: f64 = 0.5;
/// Heights nearer to each other than this tell nothing beside the noise of the robot, mm.
const FINEST_MM: f64 = 0.1;
/// By that noise another place than the nearest to the tip may seem the highest: the tip is this near to its neighbours, mm.
const BESIDE_HIGHEST_MM: f64 = 0.3;
/// The points of a section that are nearest to the sensor, whose mean is its height.
const NUM_ON_TOP: usize = 3;
/// What is nearer than the background by this, mm, stands out of it, if it has so many points and no more than one in so many.
const STANDS_OUT_MM: f64 = 2.0;
const FEWEST_STANDING_OUT: usize = 5;
const WIDEST_ONE_IN: usize = 4;

/// What to do next.
#[derive(Clone, Debug, PartialEq)]
pub enum TipNext {
    /// To look how high the section is there, along the travel, mm.
    LookAt(f64),
    /// To capture the tip there, mm.
    KeepAt(f64),
    /// There is nothing more to do.
    Over(TipEnd),
}

/// Why the tip was not found.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum TipEnd {
    /// It never began.
    #[error(transparent)]
    NotBegun(#[from] SettingsRefusal),
    /// Nothing sticks out anywhere.
    #[error(
        "no tip within {max_travel_mm:.1} mm of the first profile; bring the line nearer to it, or allow more travel"
    )]
    NotMet {
        /// How far the search may go, mm.
        max_travel_mm: f64,
    },
    /// It is too narrow along the travel, or its height does not change.
    #[error(
        "the tip's height has no peak around {at_mm:.2} mm; the search has to go across the laser line, and needs a tip that tapers"
    )]
    NoPeak {
        /// The highest place, mm.
        at_mm: f64,
    },
    /// That was enough.
    #[error("the tip was not found in {max_captures} profiles; bring the line nearer to it, or allow more")]
    CapturesExhausted {
        /// The limit.
        max_captures: u16,
    },
}

/// A place that was looked at.
#[derive(Clone, Copy, Debug)]
struct Look {
    commanded_mm: f64,
    /// How far it sticks out; `None` where nothing does.
    height_mm: Option<f64>,
}

/// A search under way.
#[derive(Clone, Debug)]
pub struct TipSearch {
    settings: SearchSettings,
    looks: Vec<Look>,
}

impl TipSearch {
    /// One that has seen nothing yet.
    #[must_use]
    pub const fn new(settings: &SearchSettings) -> Self {
        Self { settings: *settings, looks: Vec::new() }
    }

    /// Takes what was seen at a place that the robot was sent to: how far something sticks out there, or nothing.
    pub fn take(&mut self, commanded_mm: f64, height_mm: Option<f64>) {
        self.looks.push(Look { commanded_mm, height_mm });
    }

    /// What to do next.
    #[must_use]
    pub fn next(&self) -> TipNext {
        if let Err(refusal) = self.settings.check() {
            return TipNext::Over(refusal.into());
        }
        let SearchSettings { max_travel_mm, max_captures, .. } = self.settings;
        if self.looks.len() >= usize::from(max_captures) {
            return TipNext::Over(TipEnd::CapturesExhausted { max_captures });
        }
        let Some(highest) = self.highest() else { return self.look_around() };
        let wanted = [1.0, -1.0].map(|side| self.wanted_on(side, &highest));
        // As long as it goes on somewhere, the highest place may not have been seen yet.
        let beyond = wanted.iter().find_map(|wanted| match wanted {
            Wanted::Beyond(place_mm) if place_mm.abs() <= max_travel_mm => Some(*place_mm),
            _ => None,
        });
        let between = wanted.iter().find_map(|wanted| match wanted {
            Wanted::Between(place_mm) => Some(*place_mm),
            _ => None,
        });
        if let Some(place_mm) = beyond.or(between) {
            return TipNext::LookAt(place_mm);
        }
        let no_peak = TipNext::Over(TipEnd::NoPeak { at_mm: highest.commanded_mm });
        self.meeting_mm(&highest).map_or(no_peak, TipNext::KeepAt)
    }

    /// Nothing was met yet: further and further away, on both sides.
    fn look_around(&self) -> TipNext {
        let step_mm = self.settings.step_mm.max(self.settings.coarse_step_mm);
        let max_travel_mm = self.settings.max_travel_mm;
        let count = u32::try_from(self.looks.len()).unwrap_or(u32::MAX);
        let side = if count % 2 == 1 { 1.0 } else { -1.0 };
        let place_mm = side * step_mm * f64::from(count.div_ceil(2));
        if place_mm.abs() > max_travel_mm {
            return TipNext::Over(TipEnd::NotMet { max_travel_mm });
        }
        TipNext::LookAt(place_mm)
    }

    fn seen(&self) -> impl Iterator<Item = (Look, f64)> {
        self.looks.iter().filter_map(|look| Some((*look, look.height_mm?)))
    }

    fn highest(&self) -> Option<Look> {
        self.seen().max_by(|(_, a), (_, b)| a.total_cmp(b)).map(|(look, _)| look)
    }

    /// What is seen on a side of the highest place and near to it, the nearest first: distance and height, mm.
    fn flank(&self, side: f64, highest: &Look) -> Vec<[f64; 2]> {
        let reach_mm = f64::from(NUM_ON_FLANK) * self.apart_mm() + FINEST_MM;
        let mut flank: Vec<[f64; 2]> = self
            .seen()
            .map(|(look, height_mm)| [side * (look.commanded_mm - highest.commanded_mm), height_mm])
            .filter(|[distance_mm, _]| *distance_mm > 0.0 && *distance_mm < reach_mm)
            .collect();
        flank.sort_by(|a, b| a[0].total_cmp(&b[0]));
        flank
    }

    fn apart_mm(&self) -> f64 {
        APART_STEPS * self.settings.step_mm
    }

    fn wanted_on(&self, side: f64, highest: &Look) -> Wanted {
        let place_mm = |distance_mm: f64| highest.commanded_mm + side * distance_mm;
        let distance = |look: &Look| side * (look.commanded_mm - highest.commanded_mm);
        if self.looks.iter().all(|look| distance(look) <= 0.0) {
            return Wanted::Beyond(place_mm(self.settings.step_mm));
        }
        let flank = self.flank(side, highest);
        if flank.len() >= usize::from(NUM_ON_FLANK) {
            return Wanted::Nothing;
        }
        let furthest_mm = flank.last().map_or(0.0, |[distance_mm, _]| *distance_mm);
        let lost = self.looks.iter().filter(|look| look.height_mm.is_none()).map(distance);
        let lost_mm = lost.filter(|distance_mm| *distance_mm > furthest_mm).fold(f64::INFINITY, f64::min);
        // Nothing may have been seen nearer than where something is.
        let is_open = |distance_mm: &f64| {
            *distance_mm < lost_mm - FINEST_MM
                && self.looks.iter().all(|look| (distance(look) - distance_mm).abs() > FINEST_MM)
        };
        let mut usual = (1..=NUM_ON_FLANK).map(|idx| f64::from(idx) * self.apart_mm());
        if let Some(next_mm) = usual.find(is_open) {
            return Wanted::Beyond(place_mm(next_mm));
        }
        // The widest gap, that to where it was lost included.
        let ends = std::iter::once(0.0).chain(flank.iter().map(|[distance_mm, _]| *distance_mm)).chain([lost_mm]);
        let ends: Vec<f64> = ends.filter(|end| end.is_finite()).collect();
        let widest = ends.windows(2).max_by(|a, b| (a[1] - a[0]).total_cmp(&(b[1] - b[0])));
        match widest {
            Some(gap) if gap[1] - gap[0] >= 2.0 * FINEST_MM => Wanted::Between(place_mm(f64::midpoint(gap[0], gap[1]))),
            _ => Wanted::Nothing,
        }
    }

    /// Where the lines through both flanks meet, mm, or where the section vanishes; `None` if they do not fall away from
    /// there.
    fn meeting_mm(&self, highest: &Look) -> Option<f64> {
        let flanks = [-1.0, 1.0].map(|side| (side, self.flank(side, highest)));
        if flanks.iter().all(|(_, flank)| flank.len() < FEWEST_ON_FLANK) {
            return None;
        }
        let line = |(side, flank): &(f64, Vec<[f64; 2]>)| {
            // A single height beside the highest falls away from that.
            let from_highest = (flank.len() == 1).then_some([0.0, highest.height_mm?]);
            let places = flank.iter().copied().chain(from_highest);
            let places: Vec<[f64; 2]> =
                places.map(|[distance_mm, height_mm]| [side * distance_mm, height_mm]).collect();
            line_through(&places).filter(|[_, slope]| side * slope < 0.0)
        };
        if flanks.iter().any(|(_, flank)| flank.is_empty()) {
            // It still has to fall on the side where it is seen.
            return flanks.iter().find_map(line).map(|_| highest.commanded_mm);
        }
        let [rising, falling] = [line(&flanks[0])?, line(&flanks[1])?];
        let offset_mm = (falling[0] - rising[0]) / (rising[1] - falling[1]);
        let nearest_mm = |(_, flank): &(f64, Vec<[f64; 2]>)| {
            flank.first().map_or(0.0, |[distance_mm, _]| *distance_mm).max(BESIDE_HIGHEST_MM)
        };
        let allowed_mm = -nearest_mm(&flanks[0])..=nearest_mm(&flanks[1]);
        allowed_mm.contains(&offset_mm).then_some(highest.commanded_mm + offset_mm)
    }
}

/// What a flank lacks.
enum Wanted {
    Nothing,
    /// A height further out.
    Beyond(f64),
    /// A height between those that are there.
    Between(f64),
}

/// Height at 0 and slope of the line through some places.
fn line_through(places: &[[f64; 2]]) -> Option<[f64; 2]> {
    #[expect(clippy::cast_precision_loss, reason = "a handful of places")]
    let count = places.len() as f64;
    let mean = |idx: usize| places.iter().map(|place| place[idx]).sum::<f64>() / count;
    let [x, y] = [mean(0), mean(1)];
    let spread: f64 = places.iter().map(|place| (place[0] - x).powi(2)).sum();
    let both: f64 = places.iter().map(|place| (place[0] - x) * (place[1] - y)).sum();
    let slope = both / spread;
    slope.is_finite().then_some([y - slope * x, slope])
}

/// How far the thing in a profile sticks out towards the sensor, mm, from any zero; `None` if nothing does.
///
/// Beside its tip a cone's section is rounded, neither pointed nor a circle, and may be found to be no tip: there it is what
/// stands out of what is behind.
#[must_use]
pub fn height_mm(profile: &Profile, found: Option<&EdgeFit>) -> Option<f64> {
    let Some(found) = found else { return height_over_background_mm(profile) };
    let class = |point_idx: usize| found.classes.get(point_idx).copied().unwrap_or(PointClass::Unused);
    let (of_tip, behind): (Vec<_>, Vec<_>) =
        profile.valid_points().partition(|(point_idx, ..)| class(*point_idx) != PointClass::Unused);
    let mut behind: Vec<f64> = behind.into_iter().map(|(_, _, z)| z).collect();
    // z may run either way; where nothing is behind, it is taken to grow away from the sensor.
    let is_z_away = behind.is_empty() || median(&mut behind) >= found.point_mm[1];
    top_mm(of_tip.into_iter().map(|(_, _, z)| if is_z_away { -z } else { z }).collect())
}

/// The same of a narrow thing before a background that most points are on.
fn height_over_background_mm(profile: &Profile) -> Option<f64> {
    let ranges: Vec<f64> = profile.valid_points().map(|(_, _, z)| z).collect();
    if ranges.is_empty() {
        return None;
    }
    let background = median(&mut ranges.clone());
    // Strays stand out as well, but here and there.
    let standing_out = |sign: f64| -> Vec<f64> {
        let over: Vec<f64> = ranges.iter().map(|z| sign * (z - background)).collect();
        let runs = over.chunk_by(|one, next| (*one > STANDS_OUT_MM) == (*next > STANDS_OUT_MM));
        let of_thing = runs.filter(|run| run.iter().all(|over_mm| *over_mm > STANDS_OUT_MM));
        of_thing.max_by_key(|run| run.len()).map(<[f64]>::to_vec).unwrap_or_default()
    };
    // z may run either way.
    let [nearer, further] = [-1.0, 1.0].map(|sign| (sign, standing_out(sign)));
    let (sign, of_thing) = if nearer.1.len() >= further.1.len() { nearer } else { further };
    let is_narrow = of_thing.len() >= FEWEST_STANDING_OUT && WIDEST_ONE_IN * of_thing.len() < ranges.len();
    is_narrow.then(|| top_mm(of_thing)).flatten().map(|over_mm| over_mm + sign * background)
}

/// The mean of the highest few.
fn top_mm(mut heights: Vec<f64>) -> Option<f64> {
    heights.sort_by(|a, b| b.total_cmp(a));
    heights.truncate(NUM_ON_TOP);
    #[expect(clippy::cast_precision_loss, reason = "three")]
    let count = heights.len() as f64;
    (!heights.is_empty()).then(|| heights.iter().sum::<f64>() / count)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cone that is seen up to so far on the sides of its tip, and falls differently there.
    fn search(tip_mm: f64, reaches_mm: [f64; 2], slopes: [f64; 2], noise_mm: f64) -> (TipNext, usize) {
        let mut search = TipSearch::new(&SearchSettings::default());
        for count in 0..200_u32 {
            match search.next() {
                TipNext::LookAt(place_mm) => {
                    let off_mm = place_mm - tip_mm;
                    let side = usize::from(off_mm >= 0.0);
                    let (slope, reach_mm) = (slopes[side], reaches_mm[side]);
                    let noise_mm = noise_mm * f64::from(i16::try_from(count * 7 % 5).expect("small") - 2) / 2.0;
                    let height_mm = (off_mm.abs() < reach_mm).then(|| 10.0 - slope * off_mm.abs() + noise_mm);
                    search.take(place_mm, height_mm);
                }
                over => return (over, search.looks.len()),
            }
        }
        panic!("no end")
    }

    #[test]
    fn the_tip_is_where_both_flanks_meet() {
        for tip_mm in [0.0, 0.37, -1.6, 5.3, -14.2] {
            for reach_mm in [0.8, 2.0, 30.0] {
                for slopes in [[1.2, 1.2], [2.5, 0.6]] {
                    let (end, num_looks) = search(tip_mm, [reach_mm; 2], slopes, 0.005);
                    let TipNext::KeepAt(found_mm) = end else {
                        assert!(reach_mm < 1.0, "{tip_mm} {reach_mm}: {end:?}");
                        continue;
                    };
                    // The flanks are known to the noise, and less well the shorter they are.
                    assert!((found_mm - tip_mm).abs() < 0.05, "{tip_mm} {reach_mm} {slopes:?}: {found_mm}");
                    // From far off it climbs by whole steps.
                    assert!(num_looks <= 50, "{num_looks}");
                }
            }
        }
    }

    #[test]
    fn a_flank_that_is_hidden_leaves_the_tip_where_the_section_vanishes() {
        for tip_mm in [0.0, 0.11, -0.4, 2.3] {
            for reaches_mm in [[0.0, 3.0], [0.25, 3.0], [3.0, 0.15], [3.0, 0.0]] {
                let (end, _) = search(tip_mm, reaches_mm, [0.8; 2], 0.005);
                let TipNext::KeepAt(found_mm) = end else { panic!("{tip_mm} {reaches_mm:?}: {end:?}") };
                // Between what is seen and what is not it is looked at twice as closely as this at most.
                assert!((found_mm - tip_mm).abs() < 2.0 * FINEST_MM, "{tip_mm} {reaches_mm:?}: {found_mm}");
            }
        }
    }

    #[test]
    fn strays_are_nothing_that_sticks_out() {
        let at = |idx: u32| (0.1 * f64::from(idx), Some(if idx % 9 == 4 { 40.0 } else { 80.0 }));
        let (x_mm, mut z_mm): (Vec<f64>, Vec<Option<f64>>) = (0..100).map(at).unzip();
        let height = |z_mm: &[Option<f64>]| height_mm(&Profile::new(x_mm.clone(), z_mm).expect("as long"), None);
        assert_eq!(height(&z_mm), None);
        z_mm[51..57].fill(Some(70.0));
        assert_eq!(height(&z_mm), Some(-70.0));
    }

    #[test]
    fn what_is_no_tip_is_told() {
        let settings = SearchSettings::default();
        let far = search(60.0, [2.0; 2], [1.2; 2], 0.0).0;
        assert_eq!(far, TipNext::Over(TipEnd::NotMet { max_travel_mm: settings.max_travel_mm }));
        let level = search(0.0, [100.0; 2], [0.0; 2], 0.0).0;
        assert!(matches!(level, TipNext::Over(TipEnd::NoPeak { .. } | TipEnd::CapturesExhausted { .. })), "{level:?}");
        let nowhere = SearchSettings { direction: [0.0; 3], ..settings };
        assert!(matches!(TipSearch::new(&nowhere).next(), TipNext::Over(TipEnd::NotBegun(_))));
    }
}
