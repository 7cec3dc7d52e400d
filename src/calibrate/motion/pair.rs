//! Relative motions: what the hand moved against what the eye moved, A X = X B, and which pairs of poses to take them from.

use crate::geometry::Rigid;

use super::pose::PosePair;

/// The motion of the flange and that of the sensor between the same two poses, each in its own frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair {
    /// A: the flange at one pose as seen from the flange at the other.
    pub flange: Rigid,
    /// B: the same of the sensor.
    pub sensor: Rigid,
}

/// Up to so many poses all pairs are taken: a few hundred.
const ALL_UP_TO: usize = 16;
/// With more, each pose looks at so many others that are spread over all, …
const NUM_LOOKED_AT: usize = 8;
/// … and keeps so many: the cost grows with the poses, not with their square.
const NUM_KEPT: usize = 3;
/// cos(θ/2) of the largest rotation (150°) whose axis still has a certain sign.
const LEAST_COS_HALF: f64 = 0.258_819;
/// cos(θ/2) of the least rotation (0.1°) that says anything of an axis.
const MOST_COS_HALF: f64 = 0.999_999_6;

impl Pair {
    /// Between two poses.
    #[must_use]
    pub fn between(from: &PosePair, to: &PosePair) -> Self {
        Self {
            flange: from.base_from_flange.inverse() * to.base_from_flange,
            sensor: from.sensor_from_target * to.sensor_from_target.inverse(),
        }
    }
}

/// Pairs with large rotations short of a half turn, in O(N): Tsai and Lenz advise large ones, and a half turn's axis has no
/// sign. Where no pair is better, half turns and small rotations are taken as well.
#[must_use]
pub fn chosen(poses: &[PosePair]) -> Vec<Pair> {
    let num = poses.len();
    let cos_half = |i: usize, j: usize| {
        poses[i].base_from_flange.rotation.coords.dot(&poses[j].base_from_flange.rotation.coords).abs()
    };
    let is_clear = |i: usize, j: usize| (LEAST_COS_HALF..MOST_COS_HALF).contains(&cos_half(i, j));
    let all_of = |is_wanted: &dyn Fn(usize, usize) -> bool| -> Vec<Pair> {
        let pairs = (0..num).flat_map(|i| (i + 1..num).map(move |j| (i, j)));
        pairs.filter(|(i, j)| is_wanted(*i, *j)).map(|(i, j)| Pair::between(&poses[i], &poses[j])).collect()
    };
    if num <= ALL_UP_TO {
        let clear = all_of(&is_clear);
        return if clear.len() + 1 >= num { clear } else { all_of(&|_, _| true) };
    }
    let mut pairs = Vec::with_capacity(NUM_KEPT * num);
    let mut looked_at = [(0.0, 0); NUM_LOOKED_AT];
    for i in 0..num {
        // Steps of the golden section reach everywhere without a pattern.
        for (step, entry) in (1..).zip(&mut looked_at) {
            let j = (i + 1 + (step * 610 * (num - 1) / 987) % (num - 1)) % num;
            let cos = if is_clear(i, j) { cos_half(i, j) } else { 1.0 };
            *entry = (cos, j);
        }
        looked_at.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        pairs.extend(looked_at.iter().take(NUM_KEPT).map(|(_, j)| Pair::between(&poses[i], &poses[*j])));
    }
    pairs
}
