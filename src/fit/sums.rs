//! Sums over the points of a profile: the innermost loops of the fits and of the bundle.

use pulp::{Arch, WithSimd};

/// Points summed side by side: two registers of the widest kind used, so that additions overlap.
const LANES: usize = 8;

/// Sums `N` terms over all points (x, z).
///
/// The loop is compiled for the wide registers of newer processors as well and the better version picked at run time. The
/// order of the additions is that of the lanes and not of the processor, so the bits are the same on all of them.
#[inline]
pub(crate) fn sum_over<const N: usize>(x_mm: &[f64], z_mm: &[f64], terms: impl Fn(f64, f64) -> [f64; N]) -> [f64; N] {
    Arch::new().dispatch(Sums { x_mm, z_mm, terms })
}

struct Sums<'a, F> {
    x_mm: &'a [f64],
    z_mm: &'a [f64],
    terms: F,
}

impl<const N: usize, F: Fn(f64, f64) -> [f64; N]> WithSimd for Sums<'_, F> {
    type Output = [f64; N];

    #[expect(clippy::inline_always, reason = "must be compiled inside the function for the wide registers")]
    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _simd: S) -> [f64; N] {
        let mut lanes = [[0.0; LANES]; N];
        let (x_chunks, x_rest) = self.x_mm.as_chunks::<LANES>();
        let (z_chunks, z_rest) = self.z_mm.as_chunks::<LANES>();
        for (x, z) in x_chunks.iter().zip(z_chunks) {
            let mut values = [[0.0; LANES]; N];
            for lane in 0..LANES {
                let point_terms = (self.terms)(x[lane], z[lane]);
                for term in 0..N {
                    values[term][lane] = point_terms[term];
                }
            }
            for (sums, values) in lanes.iter_mut().zip(&values) {
                for lane in 0..LANES {
                    sums[lane] += values[lane];
                }
            }
        }
        let mut sums = lanes.map(|l| ((l[0] + l[1]) + (l[2] + l[3])) + ((l[4] + l[5]) + (l[6] + l[7])));
        for (x, z) in x_rest.iter().zip(z_rest) {
            for (sum, value) in sums.iter_mut().zip((self.terms)(*x, *z)) {
                *sum += value;
            }
        }
        sums
    }
}
