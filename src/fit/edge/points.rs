//! The valid points of a profile, with what is known of their grid.

use crate::geometry::Profile;
use crate::geometry::stats::median;

use super::EdgeOptions;

/// Differences looked at for the pitch.
const SAMPLE: usize = 240;
/// Points within this many standard deviations of a line may be on it.
const TOLERANCE_STDS: f64 = 4.0;
/// Points within this part of the pitch of a line may be on it, however small the noise.
const TOLERANCE_PITCHES: f64 = 0.2;

/// The valid points of a profile, in its order.
#[derive(Clone, Debug)]
pub(super) struct Points {
    /// Where each is in the profile.
    pub grid: Vec<usize>,
    /// Across the line, mm.
    pub x_mm: Vec<f64>,
    /// Along the range axis, mm.
    pub z_mm: Vec<f64>,
    /// Points of the profile, valid or not.
    pub num_grid: usize,
    /// Distance of neighbouring points across the line, mm.
    pub pitch_mm: f64,
    /// Noise of a point, mm, as far as known before anything is fitted.
    pub noise_mm: f64,
    /// What is nearer to a line than that may belong to it, mm.
    pub tolerance_mm: f64,
    /// +1 where z grows away from the sensor, −1 where it grows towards it.
    pub away: f64,
}

impl Points {
    pub(super) fn of(profile: &Profile, options: &EdgeOptions) -> Self {
        let num_grid = profile.len();
        let (mut grid, mut x_mm, mut z_mm) =
            (Vec::with_capacity(num_grid), Vec::with_capacity(num_grid), Vec::with_capacity(num_grid));
        for (idx, x, z) in profile.valid_points() {
            grid.push(idx);
            x_mm.push(x);
            z_mm.push(z);
        }
        let pitch_mm = pitch(profile.x_mm());
        let noise_mm = options.profile_std_mm.unwrap_or_else(|| local_noise(&z_mm));
        let tolerance_mm = (TOLERANCE_STDS * noise_mm).max(TOLERANCE_PITCHES * pitch_mm).max(f64::MIN_POSITIVE);
        let away = range_sign(&z_mm);
        Self { grid, x_mm, z_mm, num_grid, pitch_mm, noise_mm, tolerance_mm, away }
    }

    pub(super) fn len(&self) -> usize {
        self.grid.len()
    }

    pub(super) fn at(&self, place: usize) -> [f64; 2] {
        [self.x_mm[place], self.z_mm[place]]
    }

    /// +1 where x rises along the profile, −1 where it falls.
    pub(super) fn order(&self) -> f64 {
        match (self.x_mm.first(), self.x_mm.last()) {
            (Some(first), Some(last)) if last < first => -1.0,
            _ => 1.0,
        }
    }
}

/// Noise along the range axis from second differences, to which straight flanks add nothing.
///
/// A value below the median of their sizes, as a stray spoils three of them, and a tip has few.
fn local_noise(z_mm: &[f64]) -> f64 {
    /// Three eighths of standard normal values are below this size.
    const SIZE_OF_THREE_EIGHTHS: f64 = 0.488_776;
    let mut sizes: Vec<f64> = z_mm.windows(3).map(|z| (z[0] - 2.0 * z[1] + z[2]).abs()).collect();
    if sizes.is_empty() {
        return 0.0;
    }
    let place = sizes.len() * 3 / 8;
    *sizes.select_nth_unstable_by(place, f64::total_cmp).1 / (SIZE_OF_THREE_EIGHTHS * 6.0_f64.sqrt())
}

fn pitch(x_mm: &[f64]) -> f64 {
    let stride = x_mm.len().div_ceil(SAMPLE).max(1);
    let mut differences: Vec<f64> = x_mm.windows(2).step_by(stride).map(|x| (x[1] - x[0]).abs()).collect();
    if differences.is_empty() { 0.0 } else { median(&mut differences) }
}

/// Which way the range axis runs.
///
/// Where the sensor's origin is in its head, every range has the same sign and z grows away from zero. Ranges about zero are
/// those of a sensor whose origin lies in its measuring range; there z is taken to grow away from the head, as everywhere here.
fn range_sign(z_mm: &[f64]) -> f64 {
    let (least, most) =
        z_mm.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), z| (least.min(*z), most.max(*z)));
    if most < 0.0 && -most > most - least { -1.0 } else { 1.0 }
}
