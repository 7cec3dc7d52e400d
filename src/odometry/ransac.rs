//! Step 7 of the patent: samples drawn at random, each with the motion that it gives, and the one that most pairs agree with.

use crate::geometry::Rigid;
use crate::geometry::stats::SplitMix;

/// Pairs that fix a rigid motion.
pub const SAMPLE: usize = 3;

/// The motion of the best sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Consensus {
    /// The motion.
    pub motion: Rigid,
    /// Its score, the greater the better.
    pub score: f64,
}

/// Draws samples of three pairs and keeps the motion with the greatest score. The same seed draws the same samples.
///
/// `start` is tried first, if there is one. `motion_of` gives the motion of a sample, and `score` says what it is worth,
/// where a score of `num_pairs` is that of a motion with which all agree: the more do, the fewer samples are drawn, until
/// one in a million searches would have missed a clean one.
pub fn consensus(
    num_pairs: usize,
    most_trials: usize,
    seed: u64,
    start: Option<Rigid>,
    mut motion_of: impl FnMut([usize; SAMPLE]) -> Option<Rigid>,
    mut score: impl FnMut(&Rigid) -> f64,
) -> Option<Consensus> {
    let mut best = start.map(|motion| Consensus { motion, score: score(&motion) });
    if num_pairs < SAMPLE {
        return best;
    }
    let mut random = SplitMix::new(seed);
    let mut trial = 0;
    while trial < trials_needed(best.map_or(0.0, |best| best.score), num_pairs).min(most_trials) {
        trial += 1;
        let sample = distinct(&mut random, num_pairs);
        let Some(motion) = motion_of(sample) else { continue };
        let found = Consensus { motion, score: score(&motion) };
        if best.is_none_or(|best| found.score > best.score) {
            best = Some(found);
        }
    }
    best
}

fn distinct(random: &mut SplitMix, num_pairs: usize) -> [usize; SAMPLE] {
    let first = random.below(num_pairs);
    // Steps that are not 0 and do not add up to one round.
    let second = (first + 1 + random.below(num_pairs - 1)) % num_pairs;
    loop {
        let third = random.below(num_pairs);
        if third != first && third != second {
            return [first, second, third];
        }
    }
}

/// How many samples make it certain that one was clean, if that part of the pairs is.
fn trials_needed(score: f64, num_pairs: usize) -> usize {
    /// Of a million searches one may fail.
    const LOG_MISSED: f64 = -13.8;
    #[expect(clippy::cast_precision_loss, reason = "a number of pairs")]
    let clean = (score / num_pairs as f64).clamp(0.0, 0.99).powi(3);
    let trials = LOG_MISSED / (1.0 - clean).ln();
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "above 0 and limited")]
    let whole = trials.clamp(1.0, 1e6).ceil() as usize;
    // Hardly clean ones need ever more.
    if clean < 1e-6 { 1_000_000 } else { whole }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_are_distinct_and_the_same_again() {
        let draw = || {
            let mut random = SplitMix::new(3);
            (0..200).map(|_| distinct(&mut random, 4)).collect::<Vec<_>>()
        };
        let samples = draw();
        assert!(samples.iter().all(|[a, b, c]| a != b && b != c && a != c && [a, b, c].iter().all(|idx| **idx < 4)));
        assert_eq!(samples, draw());
    }

    #[test]
    fn few_trials_do_where_all_agree() {
        let mut trials = 0;
        let found = consensus(
            100,
            1000,
            1,
            None,
            |_| {
                trials += 1;
                Some(Rigid::identity())
            },
            |_| 100.0,
        );
        assert_eq!(found.map(|found| found.motion), Some(Rigid::identity()));
        assert!(trials < 10, "{trials}");
        assert_eq!(consensus(2, 10, 1, None, |_| Some(Rigid::identity()), |_| 1.0), None);
    }
}
