//! Step 6 of the patent: to every feature the nearest one of the other frame, if it is near enough.

use super::descriptors::{Descriptor, distance};

/// Two features that look alike: their places in the two lists.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pair {
    /// In the first list.
    pub first: usize,
    /// In the second list.
    pub second: usize,
    /// In how many bits they differ.
    pub distance: u32,
}

/// To every feature of the first list the one of the second that differs least, if it differs in fewer bits than the
/// threshold. Several may get the same one, as the text has it.
#[must_use]
pub fn nearest(first: &[Descriptor], second: &[Descriptor], threshold: u32) -> Vec<Pair> {
    let pair_of = |(idx, one): (usize, &Descriptor)| {
        let (other, distance) = nearest_to(one, second)?;
        (distance < threshold).then_some(Pair { first: idx, second: other, distance })
    };
    first.iter().enumerate().filter_map(pair_of).collect()
}

/// Pairs of which each is the nearest to the other: of features that look alike only the best pair stays.
#[must_use]
pub fn mutual(first: &[Descriptor], second: &[Descriptor], threshold: u32) -> Vec<Pair> {
    let mut pairs = nearest(first, second, threshold);
    pairs.retain(|pair| nearest_to(&second[pair.second], first).is_some_and(|(back, _)| back == pair.first));
    pairs
}

fn nearest_to(one: &Descriptor, others: &[Descriptor]) -> Option<(usize, u32)> {
    others.iter().map(|other| distance(one, other)).enumerate().min_by_key(|(_, distance)| *distance)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_is_found_within_the_threshold() {
        let first = [[0, 0, 0, 0b111], [u64::MAX; 4], [0, 0, 0, 0b1111]];
        let second = [[0, 0, 0, 0b1111], [0, u64::MAX, 0, 0]];
        let pairs = nearest(&first, &second, 10);
        assert_eq!(
            pairs.iter().map(|pair| (pair.first, pair.second, pair.distance)).collect::<Vec<_>>(),
            [(0, 0, 1), (2, 0, 0)]
        );
        assert_eq!(mutual(&first, &second, 10), [Pair { first: 2, second: 0, distance: 0 }]);
        assert!(nearest(&first, &[], 10).is_empty());
    }
}
