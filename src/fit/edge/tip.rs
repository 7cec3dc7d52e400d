//! A narrow thing that stands out of a profile: where two flanks meet at its top, else its rounded top, else its middle.

use nalgebra::{Matrix2, Matrix3, Vector2, Vector3};

use crate::fit::{EdgeRefusal, PointClass};
use crate::geometry::stats::{STD_OVER_MAD, median};

use super::pieces::{self, Piece};
use super::points::Points;
use super::sighting::{NARROW_PART, is_narrow};
use super::{EdgeFit, EdgeOptions, Feature, Sighting, corner};

/// Fewer points than this are strays.
pub(super) const MIN_TIP_POINTS: usize = 3;
/// Points of one thing are no further apart along the profile than this.
const MAX_GAP: usize = 4;
/// A steep side falls by so many pitches from one point to the next.
const MAX_FALL_PITCHES: f64 = 6.0;
/// Fewer points than this have no top that a parabola could find.
const MIN_TOP_POINTS: usize = 6;
/// A parabola whose residuals are so many times the noise does not fit: its outer points are given up.
const POOR_FIT: f64 = 1.5;
/// Points beyond so many standard deviations of a parabola are left out.
const TRIM_AT_STDS: f64 = 3.0;

/// Finds the one narrow thing.
pub(super) fn find(points: &Points, pieces: &[Piece], options: &EdgeOptions) -> Result<EdgeFit, EdgeRefusal> {
    let background: Vec<&Piece> = pieces.iter().filter(|piece| !is_narrow(points, piece)).collect();
    let mut standing_out: Vec<Vec<usize>> = clusters(points, &background)
        .into_iter()
        .filter(|cluster| is_inside(points, cluster) && is_in_front(points, cluster, &background))
        .collect();
    let (narrow, wide): (Vec<_>, Vec<_>) =
        standing_out.drain(..).partition(|cluster| width_part(points, cluster) < NARROW_PART);
    match (narrow.as_slice(), wide.as_slice()) {
        ([tip], _) => fit(points, pieces, tip, options)
            .ok_or(EdgeRefusal::NoFeature { feature: Some(Feature::Tip), num_points: points.len() }),
        ([], [wide, ..]) => Err(EdgeRefusal::TipTooWide {
            found_mm: width_mm(points, wide),
            limit_mm: NARROW_PART * points.pitch_mm * to_f64(points.num_grid),
        }),
        ([], []) => Err(EdgeRefusal::NoFeature { feature: Some(Feature::Tip), num_points: points.len() }),
        (several, _) => Err(EdgeRefusal::Ambiguous {
            seen: several
                .iter()
                .map(|cluster| Sighting { feature: Feature::Tip, x_mm: points.x_mm[cluster[cluster.len() / 2]] })
                .collect(),
        }),
    }
}

/// Points that hang together, apart from the background.
fn clusters(points: &Points, background: &[&Piece]) -> Vec<Vec<usize>> {
    let mut clusters: Vec<Vec<usize>> = Vec::new();
    for place in 0..points.len() {
        if background.iter().any(|piece| piece.holds(points, place)) {
            continue;
        }
        let hangs_on = |cluster: &Vec<usize>| {
            let Some(&last) = cluster.last() else { return false };
            let gap = points.grid[place] - points.grid[last];
            let fall_mm = MAX_FALL_PITCHES * points.pitch_mm * to_f64(gap) + 2.0 * points.tolerance_mm;
            gap <= MAX_GAP && (points.z_mm[place] - points.z_mm[last]).abs() <= fall_mm
        };
        match clusters.iter_mut().rev().take(MAX_GAP).find(|cluster| hangs_on(cluster)) {
            Some(cluster) => cluster.push(place),
            None => clusters.push(vec![place]),
        }
    }
    clusters.retain(|cluster| cluster.len() >= MIN_TIP_POINTS);
    clusters
}

fn width_part(points: &Points, cluster: &[usize]) -> f64 {
    let width = points.grid[cluster[cluster.len() - 1]] - points.grid[cluster[0]] + 1;
    to_f64(width) / to_f64(points.num_grid)
}

fn width_mm(points: &Points, cluster: &[usize]) -> f64 {
    (points.x_mm[cluster[cluster.len() - 1]] - points.x_mm[cluster[0]]).abs()
}

/// Whether both sides are in view.
fn is_inside(points: &Points, cluster: &[usize]) -> bool {
    points.grid[cluster[0]] > 0 && points.grid[cluster[cluster.len() - 1]] + 1 < points.num_grid
}

/// Whether its top is nearer to the sensor than every surface that is seen beside it.
fn is_in_front(points: &Points, cluster: &[usize], background: &[&Piece]) -> bool {
    let Some(top) = cluster.iter().map(|place| points.z_mm[*place] * points.away).reduce(f64::min) else {
        return false;
    };
    let x_mm = points.x_mm[cluster[cluster.len() / 2]];
    background
        .iter()
        .filter_map(|piece| piece.fit.line.at_x_mm(x_mm))
        .all(|[_, z_mm]| top < z_mm * points.away - 2.0 * points.tolerance_mm)
}

fn fit(points: &Points, pieces: &[Piece], cluster: &[usize], options: &EdgeOptions) -> Option<EdgeFit> {
    flanks_meet(points, pieces, cluster, options)
        .or_else(|| rounded_top(points, cluster, options))
        .or_else(|| middle(points, cluster, options))
}

/// A pointed tip: its two flanks are straight.
fn flanks_meet(points: &Points, pieces: &[Piece], cluster: &[usize], options: &EdgeOptions) -> Option<EdgeFit> {
    let (first, last) = (cluster[0], cluster[cluster.len() - 1]);
    let inside: Vec<&Piece> = pieces.iter().filter(|piece| first <= piece.first && piece.last <= last).collect();
    let [before, after] = inside.as_slice() else { return None };
    let explained = before.fit.num_points + after.fit.num_points;
    // Chords of a round thing leave many points out.
    if 10 * explained < 8 * cluster.len() {
        return None;
    }
    let found = corner::fit(points, before, after, options)?;
    let is_on_it = [before, after].iter().all(|piece| {
        let ends = [piece.first, piece.last].map(|place| points.x_mm[place]);
        let reach = (ends[1] - ends[0]).abs();
        ends.iter().any(|x| (found.point_mm[0] - x).abs() <= reach)
    });
    is_on_it.then_some(EdgeFit { feature: Feature::Tip, ..found })
}

/// z over x − `middle_x_mm` as a parabola.
struct Parabola {
    middle_x_mm: f64,
    factors: Vector3<f64>,
    /// For points of unit variance.
    covariance: Matrix3<f64>,
    std_mm: f64,
    kept: Vec<usize>,
}

fn parabola(points: &Points, cluster: &[usize], degree: usize) -> Option<Parabola> {
    let middle_x_mm = f64::midpoint(points.x_mm[cluster[0]], points.x_mm[cluster[cluster.len() - 1]]);
    let terms = |place: usize| {
        let u = points.x_mm[place] - middle_x_mm;
        Vector3::new(1.0, if degree > 0 { u } else { 0.0 }, if degree > 1 { u * u } else { 0.0 })
    };
    let mut kept = cluster.to_vec();
    for round in 0.. {
        if kept.len() <= degree {
            return None;
        }
        let (mut matrix, mut right) = (Matrix3::zeros(), Vector3::zeros());
        for place in &kept {
            let terms = terms(*place);
            matrix += terms * terms.transpose();
            right += terms * points.z_mm[*place];
        }
        for unused in degree + 1..3 {
            matrix[(unused, unused)] = 1.0;
        }
        let covariance = matrix.try_inverse()?;
        let factors = covariance * right;
        let residual = |place: usize| points.z_mm[place] - factors.dot(&terms(place));
        let freedom = kept.len().saturating_sub(degree + 1).max(1);
        let cost: f64 = kept.iter().map(|place| residual(*place).powi(2)).sum();
        let std_mm = (cost / to_f64(freedom)).sqrt();
        if round == 2 {
            return Some(Parabola { middle_x_mm, factors, covariance, std_mm, kept });
        }
        let mut sizes: Vec<f64> = kept.iter().map(|place| residual(*place).abs()).collect();
        let limit_mm = TRIM_AT_STDS * (STD_OVER_MAD * median(&mut sizes)).max(0.5 * std_mm).max(points.noise_mm);
        kept.retain(|place| residual(*place).abs() <= limit_mm);
    }
    None
}

/// A rounded top: the vertex of the parabola through the points nearest to the sensor.
fn rounded_top(points: &Points, cluster: &[usize], options: &EdgeOptions) -> Option<EdgeFit> {
    let mut window = cluster.to_vec();
    loop {
        if window.len() < MIN_TOP_POINTS {
            return None;
        }
        let top = parabola(points, &window, 2)?;
        let expected_mm = options.profile_std_mm.unwrap_or(points.noise_mm).max(points.tolerance_mm / 8.0);
        let [_, b, c] = [top.factors[0], top.factors[1], top.factors[2]];
        // The side towards the sensor is the one where z · away is least.
        let is_top = c * points.away > 0.0;
        let vertex = -b / (2.0 * c);
        if top.std_mm > POOR_FIT * expected_mm {
            window = nearest_to(points, &window, if is_top { top.middle_x_mm + vertex } else { top.middle_x_mm });
            continue;
        }
        let half_width = (points.x_mm[window[window.len() - 1]] - points.x_mm[window[0]]).abs() / 2.0;
        let std_mm = top.std_mm.max(options.profile_std_mm.unwrap_or(0.0));
        let gradient = Vector3::new(0.0, -1.0 / (2.0 * c), b / (2.0 * c * c));
        let height = Vector3::new(1.0, vertex, vertex * vertex);
        let across = (gradient.transpose() * top.covariance * gradient)[0] * std_mm * std_mm;
        // At the vertex the slope is zero, so the height is as good as the line there.
        let along = (height.transpose() * top.covariance * height)[0] * std_mm * std_mm;
        let mixed = (gradient.transpose() * top.covariance * height)[0] * std_mm * std_mm;
        if !is_top || vertex.abs() > half_width || across.sqrt() > half_width / 3.0 {
            return None;
        }
        return Some(EdgeFit {
            feature: Feature::Tip,
            point_mm: [top.middle_x_mm + vertex, top.factors.dot(&height)],
            covariance: Matrix2::new(across, mixed, mixed, along),
            flanks: Vec::new(),
            point_std_mm: std_mm,
            classes: classes(points, cluster, &top.kept),
        });
    }
}

/// The three quarters of the points that are nearest to a place.
fn nearest_to(points: &Points, window: &[usize], x_mm: f64) -> Vec<usize> {
    let staying = window.len() * 3 / 4;
    let mut by_distance = window.to_vec();
    by_distance.sort_by(|a, b| (points.x_mm[*a] - x_mm).abs().total_cmp(&(points.x_mm[*b] - x_mm).abs()));
    by_distance.truncate(staying);
    by_distance.sort_unstable();
    by_distance
}

/// Too narrow or too flat for a top of its own: halfway between its ends, which the pitch leaves uncertain.
fn middle(points: &Points, cluster: &[usize], options: &EdgeOptions) -> Option<EdgeFit> {
    let straight = parabola(points, cluster, 1)?;
    let slope = straight.factors[1];
    let std_mm = straight.std_mm.max(options.profile_std_mm.unwrap_or(points.noise_mm));
    // Each end is uniform within a pitch; the middle is the mean of the two.
    let across = points.pitch_mm * points.pitch_mm / 24.0;
    let slide = Vector2::new(1.0, slope);
    let off = straight.covariance[(0, 0)] * std_mm * std_mm;
    let covariance = slide * slide.transpose() * across + Matrix2::new(0.0, 0.0, 0.0, off);
    Some(EdgeFit {
        feature: Feature::Tip,
        point_mm: [straight.middle_x_mm, straight.factors[0]],
        covariance,
        flanks: Vec::new(),
        point_std_mm: std_mm,
        classes: classes(points, cluster, &straight.kept),
    })
}

fn classes(points: &Points, cluster: &[usize], kept: &[usize]) -> Vec<PointClass> {
    let mut classes = pieces::classes(points, []);
    for place in cluster {
        classes[points.grid[*place]] = PointClass::Outlier;
    }
    for place in kept {
        classes[points.grid[*place]] = PointClass::Inlier;
    }
    classes
}

#[expect(clippy::cast_precision_loss, reason = "a profile has far fewer than 2^52 points")]
fn to_f64(count: usize) -> f64 {
    count as f64
}
