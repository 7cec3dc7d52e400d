//! The outline of a row of teeth: where it goes up and down.

use super::curve::Levels;

/// Places along the part, at each of which there is one height.
pub(super) const NUM_BINS: usize = 600;
/// Places with a height without which there is no outline: profiles along the ridges are few.
const LEAST_PLACES: usize = 12;
/// Part of the height, either way of the middle, that a curve must pass to have gone up or down.
const HYSTERESIS: f64 = 0.2;

/// The height between crests and roots that the outline passes most often, and how far apart these are. The ground beside
/// the part is lower than its roots, but is passed only at its ends.
pub(super) fn levels(outline: &[[f64; 2]]) -> Option<Levels> {
    const NUM_LEVELS: u8 = 60;
    /// Part of the whole height that noise does not pass.
    const ABOVE_NOISE: f64 = 0.02;
    if outline.len() < LEAST_PLACES {
        return None;
    }
    let mut heights: Vec<f64> = outline.iter().map(|[_, height]| *height).collect();
    heights.sort_by(f64::total_cmp);
    // A spike or two beside the part are no teeth.
    let end = heights.len() / 50;
    let (low, high) = (heights[end], heights[heights.len() - 1 - end]);
    let level = |number: u8| low + (high - low) * (f64::from(number) + 0.5) / f64::from(NUM_LEVELS);
    let noise = ABOVE_NOISE * (high - low);
    let passed: Vec<usize> = (0..NUM_LEVELS)
        .map(|number| crossings(outline, Levels { middle: level(number), range: noise / HYSTERESIS }).len())
        .collect();
    let most = passed.iter().copied().max()?;
    let is_between = |(_, passed): &(u8, &usize)| **passed == most;
    let first = (0..).zip(&passed).find(is_between)?.0;
    let last = (0..).zip(&passed).filter(is_between).last()?.0;
    let margin = (high - low) / f64::from(NUM_LEVELS);
    Some(Levels {
        middle: f64::midpoint(level(first), level(last)),
        range: level(last) - level(first) + margin + 2.0 * noise,
    })
}

/// A place where the outline goes up or down for good.
pub(super) struct Crossing {
    pub(super) is_rising: bool,
    pub(super) place: f64,
    /// Between the last place on one side and the first on the other.
    pub(super) gap: f64,
}

/// Where the outline goes up or down for good.
pub(super) fn crossings(outline: &[[f64; 2]], Levels { middle, range }: Levels) -> Vec<Crossing> {
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
