//! A narrow thing that stands out of a profile: where two flanks meet at its top, else its rounded top, else its middle.

use nalgebra::{Matrix2, Matrix2x3, Vector2};

use crate::fit::line::LineFit;
use crate::fit::{EdgeRefusal, PointClass, algebraic, line, robust};
use crate::geometry::stats::median;

use super::pieces::{self, Piece};
use super::points::Points;
use super::sighting::is_narrow;
use super::{EdgeFit, EdgeOptions, Feature, Flank, Sighting, corner};

/// A thing wider than this part of the profile is no tip.
const WIDEST_PART: f64 = 0.25;
/// Fewer points than this are strays.
pub(super) const MIN_TIP_POINTS: usize = 3;
/// Strays that hang together by chance have less than one in so many of the points of the thing itself.
const STRAYS_ONE_IN: usize = 4;
/// The part of the points between its ends that a thing shows at least.
const LEAST_DENSITY: f64 = 0.6;
/// Points of one thing are no further apart along the profile than this.
const MAX_GAP: usize = 8;
/// A steep side falls by so many pitches from one point to the next.
const MAX_FALL_PITCHES: f64 = 6.0;
/// Fewer points than this have no top that a circle could find.
const MIN_TOP_POINTS: usize = 8;
/// Change of z with x up to which a flat top may be seen aslant; steeper ones are sides.
const STEEPEST_TOP: f64 = 0.6;
/// A circle or line whose residuals are so many times the noise does not fit.
const POOR_FIT: f64 = 3.0;
/// A top that bulges by less than so many standard deviations may as well be flat.
const CERTAIN_AT_STDS: f64 = 6.0;
/// All but one in so many of the points have to be on the top that is found.
const MOST_OF: usize = 5;
/// A middle that is uncertain by more pitches than this is none.
const LOOSEST_MIDDLE_PITCHES: f64 = 4.0;
/// A flank of a coarsely sampled tip has at least so many points: two hold a line, and two say whether it is one.
const MIN_ROOF_POINTS: usize = 4;
/// Noise that is known beforehand counts as much as so many residuals: a few points do not tell their own.
const KNOWN_NOISE_WEIGHT: f64 = 10.0;

/// Finds the one narrow thing.
pub(super) fn find(points: &Points, pieces: &[Piece], options: &EdgeOptions) -> Result<EdgeFit, EdgeRefusal> {
    let background: Vec<&Piece> = pieces.iter().filter(|piece| !is_narrow(points, piece)).collect();
    let mut standing_out: Vec<Vec<usize>> = clusters(points, &background)
        .into_iter()
        .filter(|cluster| is_inside(points, cluster) && is_in_front(points, cluster, &background))
        .collect();
    let (narrow, wide): (Vec<_>, Vec<_>) =
        standing_out.drain(..).partition(|cluster| width_part(points, cluster) < WIDEST_PART);
    match (narrow.as_slice(), wide.as_slice()) {
        ([tip], _) => fit(points, pieces, tip, options)
            .ok_or(EdgeRefusal::NoFeature { feature: Some(Feature::Tip), num_points: points.len() }),
        ([], [wide, ..]) => Err(EdgeRefusal::TipTooWide {
            found_mm: width_mm(points, wide),
            limit_mm: WIDEST_PART * points.pitch_mm * to_f64(points.num_grid),
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
        // The one with the most points: a stray may be in line as well.
        let candidates = clusters.iter_mut().filter(|cluster| hangs_on(cluster));
        match candidates.max_by_key(|cluster| cluster.len()) {
            Some(cluster) => cluster.push(place),
            None => clusters.push(vec![place]),
        }
    }
    let is_dense = |cluster: &[usize]| {
        let width = points.grid[cluster[cluster.len() - 1]] - points.grid[cluster[0]] + 1;
        to_f64(cluster.len()) >= LEAST_DENSITY * to_f64(width)
    };
    clusters.retain(|cluster| cluster.len() >= MIN_TIP_POINTS && is_dense(cluster));
    clusters.sort_by_key(|cluster| std::cmp::Reverse(cluster.len()));
    let most = clusters.first().map_or(0, Vec::len);
    clusters.retain(|cluster| STRAYS_ONE_IN * cluster.len() >= most);
    // Of what lies behind one another the thing itself has more points than the strays.
    let mut apart: Vec<Vec<usize>> = Vec::new();
    for cluster in clusters {
        let range = |cluster: &[usize]| (cluster[0], cluster[cluster.len() - 1]);
        let (first, last) = range(&cluster);
        if apart.iter().all(|other| range(other).1 < first || last < range(other).0) {
            apart.push(cluster);
        }
    }
    apart
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

/// Whether its top is nearer to the sensor than every surface that is seen beside it, where that comes nearest. A pin's own
/// shaft, seen aslant, is such a surface as well.
fn is_in_front(points: &Points, cluster: &[usize], background: &[&Piece]) -> bool {
    let Some(top) = cluster.iter().map(|place| points.z_mm[*place] * points.away).reduce(f64::min) else {
        return false;
    };
    let middle = cluster[cluster.len() / 2];
    background
        .iter()
        .filter_map(|piece| piece.fit.line.at_x_mm(points.x_mm[middle.clamp(piece.first, piece.last)]))
        .all(|[_, z_mm]| top < z_mm * points.away - 2.0 * points.tolerance_mm)
}

fn fit(points: &Points, pieces: &[Piece], cluster: &[usize], options: &EdgeOptions) -> Option<EdgeFit> {
    let round = rounded_top(points, cluster, cluster, options);
    let pointed = flanks_meet(points, pieces, cluster, options);
    // Chords of a round thing fit it worse than its circle does, and a circle fits a pointed one worse than its flanks do.
    let better = [round, pointed].into_iter().flatten().min_by(|a, b| a.misfit_mm.total_cmp(&b.misfit_mm));
    better
        .or_else(|| roof(points, cluster, options))
        .map(|found| found.edge)
        .or_else(|| top_alone(points, cluster, options))
        .or_else(|| middle(points, cluster, options))
}

/// A shape that was tried.
struct Shape {
    edge: EdgeFit,
    /// Median distance of the points from it, mm.
    misfit_mm: f64,
}

impl Shape {
    fn new(edge: EdgeFit, distances_mm: impl Iterator<Item = f64>) -> Self {
        Self { edge, misfit_mm: median(&mut distances_mm.map(f64::abs).collect::<Vec<f64>>()) }
    }
}

/// A pointed tip: its two flanks are straight.
fn flanks_meet(points: &Points, pieces: &[Piece], cluster: &[usize], options: &EdgeOptions) -> Option<Shape> {
    let (first, last) = (cluster[0], cluster[cluster.len() - 1]);
    let is_part = |piece: &&Piece| piece.first <= last && piece.last >= first && is_narrow(points, piece);
    let parts: Vec<&Piece> = pieces.iter().filter(is_part).collect();
    let explained: usize = parts.iter().map(|piece| piece.fit.num_points).sum();
    // Chords of a round thing leave points out, and fit those poorly that they take.
    if MOST_OF * explained < (MOST_OF - 1) * cluster.len() {
        return None;
    }
    let tops = parts.windows(2).filter_map(|pair| flanks_top(points, pair[0], pair[1], options));
    // A shaft below its cone makes a corner as well; the tip is the one nearest to the sensor.
    let range = |edge: &EdgeFit| edge.point_mm[1] * points.away;
    let found = tops.min_by(|a, b| range(a).total_cmp(&range(b)))?;
    if stands_above(points, cluster, found.point_mm) {
        return None;
    }
    let distance = |place: &usize| {
        let distances = parts.iter().map(|piece| piece.fit.line.distance_mm(points.at(*place)).abs());
        distances.fold(f64::INFINITY, f64::min)
    };
    Some(Shape::new(EdgeFit { feature: Feature::Tip, ..found }, cluster.iter().map(distance)))
}

/// Whether the thing reaches nearer to the sensor than a point: two neighbours do, as one may be a stray. What meets there is
/// then a shoulder of it, and not its top.
fn stands_above(points: &Points, cluster: &[usize], point_mm: [f64; 2]) -> bool {
    let is_above = |place: usize| (point_mm[1] - points.z_mm[place]) * points.away > points.tolerance_mm;
    cluster.windows(2).any(|pair| pair[1] == pair[0] + 1 && is_above(pair[0]) && is_above(pair[1]))
}

/// A pointed tip of a few points: the two lines that meet between two neighbours of them, each as long as it stays straight.
/// Where both are long enough to be found by themselves, this is none of its business.
fn roof(points: &Points, cluster: &[usize], options: &EdgeOptions) -> Option<Shape> {
    let flanks_at = |divide: usize| {
        let before = grown(points, cluster[..divide].iter().rev(), options)?;
        let after = grown(points, cluster[divide..].iter(), options)?;
        let [fewer, more] = [before.num_points.min(after.num_points), before.num_points.max(after.num_points)];
        let is_coarse = fewer < pieces::MIN_FLANK_POINTS && more < 2 * pieces::MIN_FLANK_POINTS;
        is_coarse.then_some((divide, [before, after]))
    };
    let roofs = (MIN_ROOF_POINTS..=cluster.len().saturating_sub(MIN_ROOF_POINTS)).filter_map(flanks_at);
    let found = roofs.filter_map(|(divide, flanks)| roof_of(points, cluster, divide, &flanks, options));
    let found = found.filter(|shape| !stands_above(points, cluster, shape.edge.point_mm));
    found.min_by(|a, b| a.misfit_mm.total_cmp(&b.misfit_mm))
}

/// The longest straight run from the first of some places on.
fn grown<'a>(points: &Points, places: impl Iterator<Item = &'a usize>, options: &EdgeOptions) -> Option<LineFit> {
    let (mut x_mm, mut z_mm) = (Vec::new(), Vec::new());
    let mut latest: Option<LineFit> = None;
    for place in places {
        let at = points.at(*place);
        if latest.is_some_and(|fit| fit.line.distance_mm(at).abs() > points.tolerance_mm) {
            break;
        }
        x_mm.push(at[0]);
        z_mm.push(at[1]);
        if x_mm.len() >= MIN_ROOF_POINTS {
            latest = Some(line::fit(&x_mm, &z_mm)?);
        }
    }
    latest.filter(|fit| fit.rms_mm <= POOR_FIT * expected_noise(points, options))
}

/// Two flanks that meet between the neighbours on either side of `divide`, and fall away from the sensor.
fn roof_of(
    points: &Points,
    cluster: &[usize],
    divide: usize,
    flanks: &[LineFit; 2],
    options: &EdgeOptions,
) -> Option<Shape> {
    let point_mm = flanks[0].line.crossing_mm(&flanks[1].line)?;
    let beside = [divide - 1, divide].map(|idx| points.x_mm[cluster[idx]]);
    let is_between = beside.iter().all(|x| (point_mm[0] - x).abs() <= (beside[1] - beside[0]).abs());
    let falls = |fit: &LineFit| (fit.line.centre_mm[1] - point_mm[1]) * points.away > 0.0;
    let known_mm = options.profile_std_mm.unwrap_or(points.noise_mm);
    let cost: f64 = flanks.iter().map(LineFit::cost_mm2).sum();
    let num_points = flanks[0].num_points + flanks[1].num_points;
    let freedom = to_f64(num_points - 4);
    let std_mm = ((KNOWN_NOISE_WEIGHT * known_mm * known_mm + cost) / (KNOWN_NOISE_WEIGHT + freedom)).sqrt();
    let certain_rad = flanks.iter().map(|fit| std_mm * std_mm / fit.spread_mm2).sum::<f64>().sqrt() * CERTAIN_AT_STDS;
    if !is_between || !flanks.iter().all(falls) || flanks[0].line.angle_to_rad(&flanks[1].line) < certain_rad {
        return None;
    }
    let range = divide - flanks[0].num_points..divide + flanks[1].num_points;
    let distance = |place: &usize| {
        let distances = flanks.iter().map(|fit| fit.line.distance_mm(points.at(*place)).abs());
        distances.fold(f64::INFINITY, f64::min)
    };
    let flank = |fit: &LineFit, near: usize, far: usize| Flank {
        ends_mm: [near, far].map(|idx| fit.line.foot_mm(points.at(cluster[idx]))),
        rms_mm: fit.rms_mm,
        num_points: fit.num_points,
    };
    let edge = EdgeFit {
        feature: Feature::Tip,
        point_mm,
        covariance: corner::covariance([&flanks[0], &flanks[1]], point_mm, [std_mm; 2])?,
        gap_mm: [0.0; 2],
        flanks: vec![flank(&flanks[0], divide - 1, range.start), flank(&flanks[1], divide, range.end - 1)],
        point_std_mm: std_mm,
        classes: classes(points, cluster, cluster[range.clone()].iter().copied()),
    };
    Some(Shape::new(edge, cluster[range].iter().map(distance)))
}

/// Where two neighbouring flanks meet; `None` where they fit poorly, are in one line within their noise, or meet far away.
fn flanks_top(points: &Points, before: &Piece, after: &Piece, options: &EdgeOptions) -> Option<EdgeFit> {
    let flanks = [before, after];
    if flanks.iter().any(|flank| flank.fit.rms_mm > POOR_FIT * expected_noise(points, options)) {
        return None;
    }
    let angle_rad = before.fit.line.angle_to_rad(&after.fit.line);
    let variance = |piece: &&Piece| piece.fit.rms_mm.max(points.noise_mm).powi(2) / piece.fit.spread_mm2;
    if angle_rad < CERTAIN_AT_STDS * flanks.iter().map(variance).sum::<f64>().sqrt() {
        return None;
    }
    let found = corner::fit(points, before, after, options)?;
    let is_near = |piece: &Piece| {
        let ends = [piece.first, piece.last].map(|place| points.x_mm[place]);
        let reach = (ends[1] - ends[0]).abs();
        ends.iter().any(|x| (found.point_mm[0] - x).abs() <= reach)
    };
    (is_near(before) && is_near(after)).then_some(found)
}

/// A rounded top: the point nearest to the sensor of the circle through the points.
fn rounded_top(points: &Points, window: &[usize], cluster: &[usize], options: &EdgeOptions) -> Option<Shape> {
    let (x_mm, z_mm): (Vec<f64>, Vec<f64>) =
        window.iter().map(|place| (points.x_mm[*place], points.z_mm[*place])).unzip();
    let (found, kept) = robust::fit_from(&x_mm, &z_mm, algebraic::hyper(&x_mm, &z_mm).ok()?).ok()?;
    let expected_mm = expected_noise(points, options);
    if found.rms_mm > POOR_FIT * expected_mm || MOST_OF * kept.x_mm.len() < (MOST_OF - 1) * window.len() {
        return None;
    }
    let circle = found.circle;
    let point_mm = [circle.x_mm, circle.z_mm - points.away * circle.radius_mm];
    let ends = [window[0], window[window.len() - 1]].map(|place| points.x_mm[place]);
    let half_width = (ends[1] - ends[0]).abs() / 2.0;
    let from_circle = Matrix2x3::new(1.0, 0.0, 0.0, 0.0, 1.0, -points.away);
    let covariance = from_circle * found.covariance * from_circle.transpose();
    let is_top = (circle.z_mm - z_mm.iter().sum::<f64>() / to_f64(z_mm.len())) * points.away > 0.0;
    let is_inside = (point_mm[0] - ends[0]) * (point_mm[0] - ends[1]) < 0.0;
    // How far the middle stands out over the ends, and its noise for points spread evenly.
    let sag_mm = half_width * half_width / (2.0 * circle.radius_mm);
    let sag_std_mm = 3.35 * found.rms_mm.max(expected_mm) / to_f64(window.len()).sqrt();
    let is_certain = sag_mm > CERTAIN_AT_STDS * sag_std_mm;
    let on_circle =
        |place: &usize| circle.distance_mm(points.x_mm[*place], points.z_mm[*place]).abs() <= 3.0 * found.rms_mm;
    let edge = EdgeFit {
        feature: Feature::Tip,
        point_mm,
        covariance,
        gap_mm: [0.0; 2],
        flanks: Vec::new(),
        point_std_mm: found.rms_mm,
        classes: classes(points, cluster, window.iter().copied().filter(on_circle)),
    };
    let distances = window.iter().map(|place| circle.distance_mm(points.x_mm[*place], points.z_mm[*place]));
    (is_top && is_inside && is_certain).then(|| Shape::new(edge, distances))
}

/// The same where the sides are no part of the round: only the points around the one nearest to the sensor.
fn top_alone(points: &Points, cluster: &[usize], options: &EdgeOptions) -> Option<EdgeFit> {
    let mut window = cluster.to_vec();
    while window.len() >= MIN_TOP_POINTS {
        let found = rounded_top(points, &window, cluster, options);
        if found.is_some() {
            return found.map(|found| found.edge);
        }
        let x_mm = top_x_mm(points, &window)?;
        window = nearest_to(points, &window, x_mm);
    }
    None
}

/// Where the points are nearest to the sensor: the middle of the nearest few, as one of them may be a stray.
fn top_x_mm(points: &Points, window: &[usize]) -> Option<f64> {
    let mut by_range = window.to_vec();
    by_range.sort_by(|a, b| (points.z_mm[*a] * points.away).total_cmp(&(points.z_mm[*b] * points.away)));
    let mut x_mm: Vec<f64> = by_range.iter().take(MIN_TOP_POINTS - 1).map(|place| points.x_mm[*place]).collect();
    (!x_mm.is_empty()).then(|| median(&mut x_mm))
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

/// Noise below which a fit cannot be blamed, mm.
fn expected_noise(points: &Points, options: &EdgeOptions) -> f64 {
    options.profile_std_mm.unwrap_or(points.noise_mm).max(points.tolerance_mm / 8.0)
}

/// Too narrow or too flat for a top of its own: halfway between its ends, which the pitch leaves uncertain.
fn middle(points: &Points, cluster: &[usize], options: &EdgeOptions) -> Option<EdgeFit> {
    let (x_mm, z_mm): (Vec<f64>, Vec<f64>) =
        cluster.iter().map(|place| (points.x_mm[*place], points.z_mm[*place])).unzip();
    let start = line::search(&x_mm, &z_mm, points.tolerance_mm)?;
    let straight = line::fit_trimmed(&x_mm, &z_mm, &start, 2.0 * points.tolerance_mm)?;
    let on_line = |place: &usize| straight.line.distance_mm(points.at(*place)).abs() <= straight.limit_mm;
    let seen: Vec<usize> = cluster.iter().copied().filter(on_line).collect();
    let slope = straight.line.slope()?;
    // One side of a pointed tip whose other side is missing has no middle.
    if slope.abs() > STEEPEST_TOP || to_f64(seen.len()) < LEAST_DENSITY * to_f64(cluster.len()) {
        return None;
    }
    let (first, last) = (*seen.first()?, *seen.last()?);
    let middle_x_mm = f64::midpoint(points.x_mm[first], points.x_mm[last]);
    let point_mm = straight.line.at_x_mm(middle_x_mm)?;
    let std_mm = straight.rms_mm.max(options.profile_std_mm.unwrap_or(points.noise_mm));
    // Each end is uniform within a pitch, or further out if its last points were missed, as others on it were; the middle is
    // the mean of the two.
    let seen_part = to_f64(seen.len()) / to_f64(points.grid[last] - points.grid[first] + 1);
    let of_end = 1.0 / 12.0 + (1.0 - seen_part) / (seen_part * seen_part);
    let of_pitch = points.pitch_mm * points.pitch_mm * of_end / 2.0;
    // Seen aslant it may as well be one side of a pointed tip, with its top at the upper end.
    let beyond_noise = (slope * slope - std_mm * std_mm / straight.spread_mm2).max(0.0).sqrt();
    let of_side = width_mm(points, &seen) / 2.0 * beyond_noise / STEEPEST_TOP;
    if of_side > LOOSEST_MIDDLE_PITCHES * points.pitch_mm {
        return None;
    }
    let across = of_pitch + of_side * of_side;
    let slide = Vector2::new(1.0, slope);
    let off = straight.variance_factor_at(point_mm) * std_mm * std_mm;
    Some(EdgeFit {
        feature: Feature::Tip,
        point_mm,
        covariance: slide * slide.transpose() * across + Matrix2::new(0.0, 0.0, 0.0, off),
        gap_mm: [0.0; 2],
        flanks: Vec::new(),
        point_std_mm: std_mm,
        classes: classes(points, cluster, cluster.iter().copied().filter(on_line)),
    })
}

fn classes(points: &Points, cluster: &[usize], kept: impl Iterator<Item = usize>) -> Vec<PointClass> {
    let mut classes = pieces::classes(points, []);
    for place in cluster {
        classes[points.grid[*place]] = PointClass::Outlier;
    }
    for place in kept {
        classes[points.grid[place]] = PointClass::Inlier;
    }
    classes
}

#[expect(clippy::cast_precision_loss, reason = "a profile has far fewer than 2^52 points")]
fn to_f64(count: usize) -> f64 {
    count as f64
}
