//! Figures of a list of distances, and their histogram.

use crate::geometry::stats;

/// Mean, spread and maximum of some distances, mm.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Figures {
    /// How many there are.
    pub count: usize,
    /// Their mean.
    pub mean_mm: f64,
    /// Their standard deviation about the mean, as of a sample; 0 for fewer than two.
    pub std_mm: f64,
    /// Their root mean square.
    pub rms_mm: f64,
    /// The largest.
    pub max_mm: f64,
}

impl Figures {
    /// The figures of distances, which have no sign.
    #[must_use]
    #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^52 distances")]
    pub fn of(distances_mm: &[f64]) -> Self {
        let count = distances_mm.len();
        if count == 0 {
            return Self::default();
        }
        let mean_mm = distances_mm.iter().sum::<f64>() / count as f64;
        let squares: f64 = distances_mm.iter().map(|distance| (distance - mean_mm).powi(2)).sum();
        Self {
            count,
            mean_mm,
            std_mm: if count > 1 { (squares / (count - 1) as f64).sqrt() } else { 0.0 },
            rms_mm: stats::rms(distances_mm.iter().copied()),
            max_mm: stats::max(distances_mm.iter().copied()),
        }
    }
}

/// How many distances fall into each of equally wide bins; the first begins at 0.
#[derive(Clone, Debug, PartialEq)]
pub struct Histogram {
    /// Width of a bin, mm.
    pub width_mm: f64,
    /// Distances a bin; the last one is not empty.
    pub counts: Vec<usize>,
}

/// More bins than this tell nothing more of some twenty to four hundred points.
const MOST_BINS: f64 = 14.0;

impl Histogram {
    /// A round width (1, 2 or 5 times a power of ten) for distances up to `max_mm`: about the square root of their number in
    /// bins, and between four and `MOST_BINS`.
    #[must_use]
    #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^52 distances")]
    pub fn round_width_mm(max_mm: f64, count: usize) -> f64 {
        let bins = (2.0 * (count as f64).sqrt()).clamp(4.0, MOST_BINS);
        let least = max_mm / bins;
        if !(least.is_finite() && least > f64::MIN_POSITIVE) {
            return 1.0;
        }
        let decade = 10.0_f64.powf(least.log10().floor());
        [1.0, 2.0, 5.0].into_iter().map(|step| step * decade).find(|width| *width >= least).unwrap_or(10.0 * decade)
    }

    /// Counts distances in bins of a width; one on a border belongs to the bin above it.
    #[must_use]
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "distances are not negative; saturates"
    )]
    pub fn of(distances_mm: &[f64], width_mm: f64) -> Self {
        let mut counts = Vec::new();
        for bin in distances_mm.iter().map(|distance| (distance / width_mm).floor().min(1e4) as usize) {
            if counts.len() <= bin {
                counts.resize(bin + 1, 0);
            }
            counts[bin] += 1;
        }
        Self { width_mm, counts }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_of_a_list_done_by_hand() {
        let figures = Figures::of(&[1.0, 2.0, 3.0, 6.0]);
        assert_eq!(figures.count, 4);
        assert!((figures.mean_mm - 3.0).abs() < 1e-15);
        assert!((figures.std_mm - (14.0_f64 / 3.0).sqrt()).abs() < 1e-15);
        assert!((figures.rms_mm - 12.5_f64.sqrt()).abs() < 1e-15);
        assert!((figures.max_mm - 6.0).abs() < 1e-15);
        assert_eq!(Figures::of(&[]), Figures::default());
    }

    #[test]
    fn widths_are_round_and_every_distance_is_counted() {
        for (max_mm, count, width_mm) in [(0.25, 18, 0.05), (0.3, 18, 0.05), (0.2, 400, 0.02), (1.0, 4, 0.5)] {
            let found = Histogram::round_width_mm(max_mm, count);
            assert!((found - width_mm).abs() < 1e-12, "{max_mm} of {count}: {found}");
        }
        let histogram = Histogram::of(&[0.0, 0.01, 0.05, 0.26], 0.05);
        assert_eq!(histogram.counts, [2, 1, 0, 0, 0, 1]);
        assert!(Histogram::round_width_mm(0.0, 18) > 0.0);
    }
}
