//! Sums over many points on all processors: in pieces whose borders and order do not depend on how many there are, so that
//! the bits are always the same.

use std::ops::Range;
use std::panic::resume_unwind;
use std::thread;

use pulp::{Arch, WithSimd};

use super::{Cloud, PointSet};

/// Points of a piece: enough to be worth a turn, few enough for many pieces.
const PIECE: usize = 1 << 16;
/// Points summed side by side.
const LANES: usize = 4;

/// How many threads share a long loop.
pub(super) fn num_threads() -> usize {
    thread::available_parallelism().map_or(1, std::num::NonZero::get).min(8)
}

/// Does something for every piece of a set, and gives the outcomes in order.
pub(super) fn for_pieces<T: Send>(set: &PointSet, work: impl Fn(&[Range<usize>]) -> T + Sync) -> Vec<T> {
    let pieces = pieces(set);
    let threads = num_threads().min(pieces.len()).max(1);
    if threads == 1 {
        return pieces.iter().map(|piece| work(piece)).collect();
    }
    let share = pieces.len().div_ceil(threads);
    thread::scope(|scope| {
        let work = &work;
        let started: Vec<_> = pieces
            .chunks(share)
            .map(|part| scope.spawn(move || part.iter().map(|piece| work(piece)).collect::<Vec<T>>()))
            .collect();
        started.into_iter().flat_map(|part| part.join().unwrap_or_else(|panic| resume_unwind(panic))).collect()
    })
}

/// The runs of a set, cut and grouped into pieces of about the same number of points.
fn pieces(set: &PointSet) -> Vec<Vec<Range<usize>>> {
    let mut pieces = Vec::new();
    let (mut piece, mut room) = (Vec::new(), PIECE);
    for run in set.runs() {
        let mut run = run;
        while run.len() >= room {
            let cut = run.start + room;
            piece.push(run.start..cut);
            pieces.push(std::mem::take(&mut piece));
            run.start = cut;
            room = PIECE;
        }
        if !run.is_empty() {
            room -= run.len();
            piece.push(run);
        }
    }
    if !piece.is_empty() {
        pieces.push(piece);
    }
    pieces
}

/// Sums `N` terms over the points of a set; the terms get the offsets of a point, mm.
pub(super) fn sum_over<const N: usize>(
    cloud: &Cloud,
    set: &PointSet,
    terms: impl Fn([f64; 3]) -> [f64; N] + Sync,
) -> [f64; N] {
    let parts = for_pieces(set, |piece| {
        let mut sums = [0.0; N];
        for run in piece {
            let part = Arch::new().dispatch(Run { cloud, range: run.clone(), terms: &terms });
            for (sum, part) in sums.iter_mut().zip(part) {
                *sum += part;
            }
        }
        sums
    });
    parts.into_iter().fold([0.0; N], |mut sums, part| {
        for (sum, part) in sums.iter_mut().zip(part) {
            *sum += part;
        }
        sums
    })
}

struct Run<'a, F> {
    cloud: &'a Cloud,
    range: Range<usize>,
    terms: &'a F,
}

impl<const N: usize, F: Fn([f64; 3]) -> [f64; N]> WithSimd for Run<'_, F> {
    type Output = [f64; N];

    #[expect(clippy::inline_always, reason = "must be compiled inside the function for the wide registers")]
    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _simd: S) -> [f64; N] {
        let [x, y, z] = self.cloud.offsets_mm().map(|axis| &axis[self.range.clone()]);
        let (xs, x_rest) = x.as_chunks::<LANES>();
        let (ys, y_rest) = y.as_chunks::<LANES>();
        let (zs, z_rest) = z.as_chunks::<LANES>();
        let mut lanes = [[0.0; LANES]; N];
        for ((x, y), z) in xs.iter().zip(ys).zip(zs) {
            let mut values = [[0.0; LANES]; N];
            for lane in 0..LANES {
                let point = (self.terms)([f64::from(x[lane]), f64::from(y[lane]), f64::from(z[lane])]);
                for term in 0..N {
                    values[term][lane] = point[term];
                }
            }
            for (sums, values) in lanes.iter_mut().zip(&values) {
                for lane in 0..LANES {
                    sums[lane] += values[lane];
                }
            }
        }
        let mut sums = lanes.map(|l| (l[0] + l[1]) + (l[2] + l[3]));
        for ((x, y), z) in x_rest.iter().zip(y_rest).zip(z_rest) {
            let point = (self.terms)([f64::from(*x), f64::from(*y), f64::from(*z)]);
            for (sum, value) in sums.iter_mut().zip(point) {
                *sum += value;
            }
        }
        sums
    }
}
