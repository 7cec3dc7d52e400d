//! The directions of a part with teeth: along the row, up, and along its ridges.

use nalgebra::{Vector2, Vector3};

use crate::geometry::{Mat3, Scatter, Vec3};
use crate::scan::ScanError;
use crate::scan::linear::{Row, solve};
use crate::scan::neighbourhood::{Sample, common_direction};

use super::curve::Features;
use super::tips::Tip;

const NUM_PATCHES: usize = 400;
/// Above this the surfaces are not those of a part that stays the same in one direction, rad.
const MOST_MISFIT: f64 = 0.2;
/// No slope along the ridge is known better, rad: that much surfaces are off.
const LEAST_SLOPE_STD: f64 = 1e-5;

/// The directions of the part.
#[derive(Clone, Copy, Debug)]
pub(super) struct Axes {
    pub(super) along: Vec3,
    pub(super) up: Vec3,
    pub(super) ridge: Vec3,
}

impl Axes {
    /// The ridges from the patches of the surface, the row of teeth from where the points reach farthest across the ridges.
    pub(super) fn start(sample: &Sample, toward_sensor: Vec3) -> Result<Self, ScanError> {
        let normals: Vec<Vec3> = sample.patches(NUM_PATCHES).iter().map(|patch| patch.plane.normal).collect();
        let ridge = if let Some(normal) = level_normal(&normals) {
            steady_direction(&sample.points, normal)
        } else {
            let (ridge, misfit) = common_direction(&normals).ok_or(ScanError::TooFewTeeth { found: 0 })?;
            if misfit > MOST_MISFIT {
                return Err(ScanError::NotPrismatic { misfit_deg: misfit.to_degrees() });
            }
            ridge
        };
        let across = |point: &Vec3| point - ridge * ridge.dot(point);
        let along = Scatter::of(sample.points.iter().map(across)).map_or_else(Vec3::x, |scatter| scatter.widest);
        let up = ridge.cross(&along);
        let up = if up.dot(&toward_sensor) < 0.0 { -up } else { up };
        Ok(Self { along: up.cross(&ridge), up, ridge })
    }

    /// The points of those strips across the ridges that reach up to the crests: beside the part there is only ground.
    pub(super) fn on_part(&self, points: Vec<(Vec3, u32)>) -> Vec<(Vec3, u32)> {
        const NUM_STRIPS: usize = 50;
        const END_STRIPS: usize = 2;
        let ends = |values: &mut dyn Iterator<Item = f64>| {
            values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| [low.min(value), high.max(value)])
        };
        let [first, last] = ends(&mut points.iter().map(|(point, _)| self.ridge.dot(point)));
        #[expect(
            clippy::cast_precision_loss,
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "one of a few strips"
        )]
        let strip_of = |point: &Vec3| {
            let part = (self.ridge.dot(point) - first) / (last - first).max(f64::MIN_POSITIVE);
            ((part * NUM_STRIPS as f64) as usize).min(NUM_STRIPS - 1)
        };
        let mut strips: Vec<Vec<f64>> = vec![Vec::new(); NUM_STRIPS];
        for (point, _) in &points {
            strips[strip_of(point)].push(self.up.dot(point));
        }
        // Nine tenths up, so that a few wild points make no part; crests take more than that of the room.
        let tops: Vec<f64> = strips
            .iter_mut()
            .map(|heights| {
                let place = heights.len() * 9 / 10;
                if heights.is_empty() {
                    f64::NEG_INFINITY
                } else {
                    *heights.select_nth_unstable_by(place, f64::total_cmp).1
                }
            })
            .collect();
        let highest = tops.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let [lowest, _] = ends(&mut points.iter().map(|(point, _)| self.up.dot(point)));
        let is_high: Vec<bool> = tops.iter().map(|top| *top > lowest + 0.75 * (highest - lowest)).collect();
        // Strips at the part's ends hold some of the ground as well.
        let is_part = |strip: usize| {
            is_high[strip.saturating_sub(END_STRIPS)..(strip + END_STRIPS + 1).min(NUM_STRIPS)]
                .iter()
                .all(|is_high| *is_high)
        };
        points.into_iter().filter(|(point, _)| is_part(strip_of(point))).collect()
    }

    /// Turns the axes so that crests and roots lie level and flanks run along the ridges; by how much, rad.
    pub(super) fn refine(&mut self, found: &Features) -> f64 {
        // Height of the tips over their place, with a level of their own for crests and roots.
        let rows: Vec<Row<3>> = found
            .tips
            .iter()
            .map(|tip| {
                let [crest, root] = if tip.is_crest { [1.0, 0.0] } else { [0.0, 1.0] };
                Row { terms: Vector3::new(crest, root, tip.place), value: tip.level.value_mm, profile: 0 }
            })
            .collect();
        let slope = solve(&rows).map_or_else(|| level_slope(&found.tips), |fit| fit.solution.z);
        // A flank is place = a + b height + c ridge: if the true ridge is off by (α along, β up), then c = α − b β, and what
        // is level along the ridge rises by β. Each is believed as far as it is known.
        let believed = |terms: [f64; 2], value: f64, variance: f64| {
            let std = variance.max(0.0).sqrt().max(LEAST_SLOPE_STD);
            Row { terms: Vector2::from(terms) / std, value: value / std, profile: 0 }
        };
        let fits = found.flanks.iter().filter_map(|flank| flank.fit.as_ref());
        let of_flanks = fits.map(|fit| believed([1.0, -fit.solution.y], fit.solution.z, fit.covariance[(2, 2)]));
        let rises = found.tips.iter().filter_map(|tip| tip.rise);
        let of_tips = rises.map(|rise| believed([0.0, 1.0], rise.value_mm, rise.std_mm * rise.std_mm));
        // Where no flank was seen nothing tells α, and the ridge stays.
        let rows: Vec<Row<2>> = of_flanks.chain(of_tips).chain([believed([1.0, 0.0], 0.0, 1.0)]).collect();
        let turn = solve(&rows).map(|fit| fit.solution).unwrap_or_default();
        let ridge = (self.ridge + self.along * turn.x + self.up * turn.y).normalize();
        let along = self.along + self.up * slope;
        self.ridge = ridge;
        self.along = (along - ridge * ridge.dot(&along)).normalize();
        let up = ridge.cross(&self.along);
        self.up = if up.dot(&self.up) < 0.0 { -up } else { up };
        slope.abs() + turn.amax()
    }
}

/// From two tips of a kind, where there are too few for a fit.
fn level_slope(tips: &[Tip]) -> f64 {
    let of_kind = |is_crest: bool| tips.iter().filter(move |tip| tip.is_crest == is_crest);
    let slope = |is_crest: bool| {
        let (first, last) = (of_kind(is_crest).next()?, of_kind(is_crest).next_back()?);
        (last.place > first.place).then(|| (last.level.value_mm - first.level.value_mm) / (last.place - first.place))
    };
    slope(true).or_else(|| slope(false)).unwrap_or(0.0)
}

/// The normal that all patches share, where no flank was seen: nothing but crests and roots, which are parallel.
#[expect(clippy::cast_precision_loss, reason = "a count of patches")]
fn level_normal(normals: &[Vec3]) -> Option<Vec3> {
    /// Mean square of the sines by which patches are inclined; on teeth with flanks in sight it is ten times this.
    const MOST_INCLINED: f64 = 0.01;
    let scatter = normals.iter().fold(Mat3::zeros(), |sum, normal| sum + normal * normal.transpose());
    let eigen = scatter.symmetric_eigen();
    let most = eigen.eigenvalues.imax();
    let inclined = (scatter.trace() - eigen.eigenvalues[most]) / normals.len().max(1) as f64;
    (inclined < MOST_INCLINED).then(|| eigen.eigenvectors.column(most).into_owned())
}

/// The direction, perpendicular to `up`, along which the heights of points stay the same.
fn steady_direction(points: &[Vec3], up: Vec3) -> Vec3 {
    const NUM_DIRECTIONS: u32 = 90;
    const NUM_HALVINGS: usize = 8;
    let first = up.cross(&Vec3::ith(up.iamin(), 1.0)).normalize();
    let second = up.cross(&first);
    let direction = |angle: f64| first * angle.cos() + second * angle.sin();
    let unsteady = |angle: f64| scatter_across(points, up, up.cross(&direction(angle)));
    let mut step = std::f64::consts::PI / f64::from(NUM_DIRECTIONS);
    let (mut best, mut least) = (0..NUM_DIRECTIONS)
        .map(|number| f64::from(number) * step)
        .map(|angle| (angle, unsteady(angle)))
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .unwrap_or_default();
    for _ in 0..NUM_HALVINGS {
        step /= 2.0;
        for angle in [best - step, best + step] {
            let scatter = unsteady(angle);
            if scatter < least {
                (best, least) = (angle, scatter);
            }
        }
    }
    direction(best)
}

/// How much heights scatter among points that are alike along a direction: the sum of their squares about the mean of each
/// strip.
#[expect(clippy::cast_precision_loss, reason = "strips and counts of points")]
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "one of a few strips")]
fn scatter_across(points: &[Vec3], up: Vec3, along: Vec3) -> f64 {
    const NUM_STRIPS: usize = 300;
    let places = || points.iter().map(|point| along.dot(point));
    let [low, high] =
        places().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], place| [low.min(place), high.max(place)]);
    let mut strips = [[0.0; 3]; NUM_STRIPS];
    for (point, place) in points.iter().zip(places()) {
        let part = (place - low) / (high - low).max(f64::MIN_POSITIVE);
        let height = up.dot(point);
        let [count, sum, squares] = &mut strips[((part * NUM_STRIPS as f64) as usize).min(NUM_STRIPS - 1)];
        *count += 1.0;
        *sum += height;
        *squares += height * height;
    }
    strips.iter().filter(|strip| strip[0] > 0.0).map(|[count, sum, squares]| squares - sum * sum / count).sum()
}
