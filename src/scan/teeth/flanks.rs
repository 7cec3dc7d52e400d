//! The sides of the teeth.

use nalgebra::{Matrix2, Matrix3, Vector2, Vector3};

use crate::scan::linear::{Linear, Row, solve};

use super::curve::{Curve, CurvePoint, Levels};
use super::outline::Crossing;

/// Part of the height, either way of the middle, over which flanks are fitted: crests and roots may be round.
const FLANK_PART: f64 = 0.4;
/// The points of a flank tell its slope if they are spread by this part of the height both up the flank and along the ridge,
/// and by so many times their noise: within a single profile the one goes with the other.
const SPREAD_PART: f64 = 0.02;
const SPREAD_AT_STD: f64 = 5.0;
/// Fewer points are no flank.
const LEAST_POINTS: usize = 10;

/// One side of a tooth.
pub(super) struct Flank {
    pub(super) is_rising: bool,
    /// Where it passes the middle height.
    pub(super) place: f64,
    /// place = a + b (height − middle) + c ridge; none where a flank is too steep to be seen.
    pub(super) fit: Option<Linear<3>>,
    /// Standard deviation of `place`.
    pub(super) std_mm: f64,
    /// Half of the gap within which a flank is that no points tell of, mm.
    pub(super) half_gap: f64,
    /// What is left over of the places of its profiles, as a move of the whole profile, mm; of a flank whose profiles are too
    /// few to tell how they scatter.
    pub(super) left_over: Vec<(u32, f64)>,
}

impl Flank {
    /// Its place at a height above the middle.
    pub(super) fn at(&self, height: f64) -> f64 {
        self.place + self.fit.as_ref().map_or(0.0, |fit| fit.solution.y) * height
    }

    /// Height above the middle at a place, where it is not upright.
    pub(super) fn height_at(&self, place: f64) -> Option<f64> {
        let slope = self.fit.as_ref()?.solution.y;
        (slope.abs() > 1e-6).then(|| (place - self.place) / slope)
    }

    /// With the variance of how whole profiles are moved, mm², which few profiles on a flank do not tell.
    #[expect(clippy::cast_precision_loss, reason = "a count of profiles")]
    pub(super) fn believe(&mut self, profile_variance: f64) {
        if let Some(fit) = self.fit.as_mut().filter(|fit| !fit.is_from_profiles) {
            let of_place = profile_variance * sideways(fit.solution.y).powi(2) / fit.num_profiles.max(1) as f64;
            fit.covariance[(0, 0)] += of_place;
            self.std_mm = self.std_mm.hypot(of_place.sqrt());
        }
    }

    /// Of a crossing where no points tell where the flank is: anywhere in the gap.
    fn unseen(crossing: &Crossing) -> Self {
        Self {
            is_rising: crossing.is_rising,
            place: crossing.place,
            fit: None,
            std_mm: crossing.gap / 12.0_f64.sqrt(),
            half_gap: crossing.gap / 2.0,
            left_over: Vec::new(),
        }
    }

    /// From a fit, at the middle of the ridge, where it is known best.
    fn seen(side: &Side<'_>, mut fit: Linear<3>) -> Self {
        let at = Vector3::new(1.0, 0.0, side.mean.z);
        let std_mm = at.dot(&(fit.covariance * at)).max(0.0).sqrt();
        let across = sideways(fit.solution.y);
        let left_over = |row: &Row<3>| (row.profile, (row.value - row.terms.dot(&fit.solution)) / across);
        let left_over = if fit.is_from_profiles { Vec::new() } else { side.rows.iter().map(left_over).collect() };
        let place = at.dot(&fit.solution);
        fit.solution.x = place;
        let is_rising = side.crossing.is_rising;
        Self { is_rising, place, fit: Some(fit), std_mm, half_gap: 0.0, left_over }
    }
}

/// By how much more than a profile its place on a flank moves, where it moves as far along the part as up.
fn sideways(slope: f64) -> f64 {
    slope.hypot(1.0)
}

/// The points of a flank: place = a + b (height − middle) + c (ridge − that of the first point).
struct Side<'a> {
    crossing: &'a Crossing,
    rows: Vec<Row<3>>,
    /// Mean of (1, height, ridge).
    mean: Vector3<f64>,
    mean_place: f64,
}

/// The flanks at the crossings.
pub(super) fn flanks(curve: &Curve, crossings: &[Crossing], levels: Levels) -> Vec<Flank> {
    let ridge = curve.between(f64::NEG_INFINITY, f64::INFINITY).first().map_or(0.0, |(point, _)| point.z);
    let sides: Vec<Side<'_>> = crossings
        .iter()
        .enumerate()
        .map(|(idx, crossing)| {
            let before = idx.checked_sub(1).map_or(f64::NEG_INFINITY, |idx| crossings[idx].place);
            let after = crossings.get(idx + 1).map_or(f64::INFINITY, |next| next.place);
            let from = f64::midpoint(before, crossing.place).max(crossing.place - 2.0 * levels.range);
            let to = f64::midpoint(after, crossing.place).min(crossing.place + 2.0 * levels.range);
            Side::of(crossing, curve.between(from, to), levels, ridge)
        })
        .collect();
    let shared = [false, true].map(|is_rising| {
        let of_kind: Vec<&Side<'_>> = sides.iter().filter(|side| side.crossing.is_rising == is_rising).collect();
        shared_slope(&of_kind, levels)
    });
    sides
        .iter()
        .map(|side| {
            let own = || side.own_fit(levels);
            let borrowed = || side.fit_with(shared[usize::from(side.crossing.is_rising)].as_ref()?);
            match own().or_else(borrowed) {
                Some(fit) => Flank::seen(side, fit),
                None => Flank::unseen(side.crossing),
            }
        })
        .collect()
}

impl<'a> Side<'a> {
    #[expect(clippy::cast_precision_loss, reason = "a count of points")]
    fn of(crossing: &'a Crossing, points: &[CurvePoint], levels: Levels, ridge: f64) -> Self {
        let rows: Vec<Row<3>> = points
            .iter()
            .filter(|(point, _)| (point.y - levels.middle).abs() <= FLANK_PART * levels.range)
            .map(|(point, profile)| Row {
                terms: Vector3::new(1.0, point.y - levels.middle, point.z - ridge),
                value: point.x,
                profile: *profile,
            })
            .collect();
        let count = rows.len().max(1) as f64;
        let mean = rows.iter().map(|row| row.terms).sum::<Vector3<f64>>() / count;
        let mean_place = rows.iter().map(|row| row.value).sum::<f64>() / count;
        Self { crossing, rows, mean, mean_place }
    }

    fn has_points(&self) -> bool {
        self.rows.len() >= LEAST_POINTS
    }

    /// What is left of the points about their mean.
    fn about_mean(&self) -> impl Iterator<Item = Row<2>> + '_ {
        self.rows.iter().map(|row| Row {
            terms: Vector2::new(row.terms.y - self.mean.y, row.terms.z - self.mean.z),
            value: row.value - self.mean_place,
            profile: row.profile,
        })
    }

    /// From its own points alone, where enough profiles met it to tell how they scatter.
    fn own_fit(&self, levels: Levels) -> Option<Linear<3>> {
        let fit = solve(&self.rows).filter(|fit| fit.is_from_profiles && fit.num_used >= LEAST_POINTS)?;
        let rows: Vec<Row<2>> = self.about_mean().collect();
        is_spread(&rows, fit.rms, levels).then_some(fit)
    }

    /// With a slope that is known from elsewhere: its points tell its place alone.
    fn fit_with(&self, slope: &Linear<2>) -> Option<Linear<3>> {
        if !self.has_points() {
            return None;
        }
        let [per_height, per_ridge] = slope.solution.into();
        let rows: Vec<Row<1>> = self
            .rows
            .iter()
            .map(|row| Row {
                terms: [1.0].into(),
                value: row.value - per_height * row.terms.y - per_ridge * row.terms.z,
                profile: row.profile,
            })
            .collect();
        let place = solve(&rows)?;
        // The slope's error turns the flank about the mean of its points.
        let mut covariance = Matrix3::zeros();
        covariance.fixed_view_mut::<2, 2>(1, 1).copy_from(&slope.covariance);
        covariance[(0, 0)] = place.covariance.x;
        let mut about_middle = Matrix3::identity();
        about_middle[(0, 1)] = -self.mean.y;
        about_middle[(0, 2)] = -self.mean.z;
        Some(Linear {
            solution: Vector3::new(place.solution.x, per_height, per_ridge),
            covariance: about_middle * covariance * about_middle.transpose(),
            rms: place.rms,
            num_used: place.num_used,
            num_profiles: place.num_profiles,
            is_from_profiles: false,
        })
    }
}

/// The slope that the flanks of one side have in common, (a height, along the ridge), from how the points of each go about
/// their mean; `None` where they do not tell.
fn shared_slope(sides: &[&Side<'_>], levels: Levels) -> Option<Linear<2>> {
    let rows: Vec<Row<2>> = sides.iter().filter(|side| side.has_points()).flat_map(|side| side.about_mean()).collect();
    solve(&rows).filter(|fit| is_spread(&rows, fit.rms, levels))
}

/// Whether points about their mean are spread both ways.
#[expect(clippy::cast_precision_loss, reason = "a count of points")]
fn is_spread(about_mean: &[Row<2>], noise_mm: f64, levels: Levels) -> bool {
    let scatter = about_mean.iter().fold(Matrix2::zeros(), |sum, row| sum + row.terms * row.terms.transpose());
    let least = scatter.symmetric_eigenvalues().min() / about_mean.len().max(1) as f64;
    least.max(0.0).sqrt() > (SPREAD_PART * levels.range).max(SPREAD_AT_STD * noise_mm)
}
