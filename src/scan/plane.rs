//! Planes: total least squares, robust against what is not of the plane, with what is known of them.

use crate::geometry::stats::{STD_OVER_MAD, SplitMix, median};
use crate::geometry::{Mat3, Scatter, Vec3};

use super::lanes::{for_pieces, sum_over};
use super::{Cloud, PointSet, ScanError};

/// Points that decide the start and the scale: enough for a median, few enough for no time.
const NUM_SAMPLED: usize = 4096;
/// Planes through three points that are tried as a start.
const NUM_STARTS: usize = 60;
/// Points farther off than this many σ are of something else.
const TRIM_AT_STD: f64 = 3.5;
/// Passes of trimming; they mostly settle after three.
const MAX_PASSES: usize = 10;
/// Where trimming comes and goes with so small a part of the points, it has settled.
const SETTLED: f64 = 1e-4;
/// A plane narrower than this part of its length may as well be a line.
const MIN_WIDTH: f64 = 1e-3;
/// Fewer profiles do not tell how they scatter among each other.
pub const MIN_PROFILES: usize = 6;
/// The same fit, the same plane.
const SEED: u64 = 0x51a7e;

/// A plane: `normal · point = offset_mm`, in the base.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    /// Its unit normal; the greatest coordinate is positive.
    pub normal: Vec3,
    /// Distance of the base's origin along the normal, mm.
    pub offset_mm: f64,
}

impl Plane {
    /// Through a point, mm.
    #[must_use]
    pub fn through(point_mm: Vec3, normal: Vec3) -> Self {
        let leading = normal[normal.iamax()];
        let normal = if leading < 0.0 { -normal } else { normal };
        Self { normal, offset_mm: normal.dot(&point_mm) }
    }

    /// Signed distance of a point from the plane, mm.
    #[must_use]
    pub fn distance_mm(&self, point_mm: Vec3) -> f64 {
        self.normal.dot(&point_mm) - self.offset_mm
    }

    /// The same plane for offsets from a cloud's origin.
    pub(super) fn about(&self, origin_mm: Vec3) -> Self {
        Self { normal: self.normal, offset_mm: self.offset_mm - self.normal.dot(&origin_mm) }
    }
}

/// A plane's equation as papers print it: the greatest coefficient is 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaneEquation {
    /// Those of x, y and z.
    pub coefficients: [f64; 3],
    /// Standard deviations; 0 for the one that is 1.
    pub coefficient_stds: [f64; 3],
    /// Which of them is 1.
    pub leading: usize,
    /// The right side, mm.
    pub offset_mm: f64,
    /// Its standard deviation, mm.
    pub offset_std_mm: f64,
}

/// A plane fitted to a region.
#[derive(Clone, Debug, PartialEq)]
pub struct PlaneFit {
    /// The plane.
    pub plane: Plane,
    /// The midst of its points, mm.
    pub centroid_mm: Vec3,
    /// Its directions of greatest and least extent.
    pub axes: [Vec3; 2],
    /// Covariance of (height of the plane at the centroid in mm, slope along each axis).
    pub covariance: Mat3,
    /// Distances of the points used, mm: root mean square.
    pub rms_mm: f64,
    /// Points of the region.
    pub num_points: usize,
    /// Those that were not trimmed.
    pub num_used: usize,
    /// Profiles that hold them.
    pub num_profiles: usize,
    /// What each profile does to (height, slope, slope), from which the covariance is: two planes of the same scan share
    /// profiles, and with them errors. Empty where the profiles are too few for that.
    influences: Vec<(u32, Vec3)>,
}

/// Fits a plane by total least squares to the points that are of it.
///
/// The start is the plane with the least median distance among several through three points, so that up to half of the points
/// may be of something else; then whatever is beyond 3.5 σ is trimmed until nothing changes. The covariance comes from how
/// the profiles scatter and not from the number of points: the noise of the robot is common to all points of a profile.
///
/// # Errors
/// [`ScanError::TooFewPoints`] below 3, [`ScanError::Line`] where the points are no wider than a line.
pub fn fit_plane(cloud: &Cloud, set: &PointSet) -> Result<PlaneFit, ScanError> {
    let sample: Vec<Vec3> = set.thinned(NUM_SAMPLED).into_iter().map(|idx| cloud.offset_mm(idx)).collect();
    if sample.len() < 3 {
        return Err(ScanError::TooFewPoints { what: "a plane", found: sample.len(), needed: 3 });
    }
    let mut fit = Moments::of(cloud, set, None).fit()?;
    if let Some(start) = least_median(&sample) {
        let limit_mm = TRIM_AT_STD * scale_mm(&start, &sample);
        fit = Moments::of(cloud, set, Some((&start, limit_mm))).fit().unwrap_or(fit);
    }
    let mut limit_mm = f64::INFINITY;
    for _ in 0..MAX_PASSES {
        limit_mm = TRIM_AT_STD * scale_mm(&fit.plane, &sample);
        let refined = Moments::of(cloud, set, Some((&fit.plane, limit_mm))).fit()?;
        let has_settled = (refined.count - fit.count).abs() <= SETTLED * fit.count;
        fit = refined;
        if has_settled {
            break;
        }
    }
    Ok(fit.finish(cloud, set, limit_mm))
}

/// The plane of a small number of points by plain total least squares, with the root mean square of their distances.
pub(super) fn plane_of(points: impl Iterator<Item = Vec3> + Clone) -> Option<(Plane, f64)> {
    points.clone().nth(2)?;
    let scatter = Scatter::of(points)?;
    Some((Plane::through(scatter.centroid_mm, scatter.narrowest), scatter.thickness_mm))
}

/// Sums over the points within a distance of a plane, about the cloud's origin.
struct Moments {
    count: f64,
    sum: Vec3,
    squares: Mat3,
}

impl Moments {
    fn of(cloud: &Cloud, set: &PointSet, near: Option<(&Plane, f64)>) -> Self {
        let (normal, offset, limit) =
            near.map_or((Vec3::zeros(), 0.0, f64::INFINITY), |(plane, limit)| (plane.normal, plane.offset_mm, limit));
        // About a point of the plane, so that nothing cancels.
        let about = normal * offset;
        let [count, x, y, z, xx, xy, xz, yy, yz, zz] = sum_over(cloud, set, |[x, y, z]| {
            let distance = normal.x * x + normal.y * y + normal.z * z - offset;
            let weight = if distance.abs() <= limit { 1.0 } else { 0.0 };
            let (x, y, z) = (x - about.x, y - about.y, z - about.z);
            let (wx, wy, wz) = (weight * x, weight * y, weight * z);
            [weight, wx, wy, wz, wx * x, wx * y, wx * z, wy * y, wy * z, wz * z]
        });
        let about_sum = Vec3::new(x, y, z);
        let mean = about_sum / count;
        let squares = Mat3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz) - mean * about_sum.transpose();
        Self { count, sum: about_sum + about * count, squares }
    }

    fn fit(&self) -> Result<Fitted, ScanError> {
        if self.count < 3.0 {
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0, 1 or 2")]
            let found = self.count as usize;
            return Err(ScanError::TooFewPoints { what: "a plane", found, needed: 3 });
        }
        let eigen = self.squares.symmetric_eigen();
        let mut order = [0, 1, 2];
        order.sort_by(|a, b| eigen.eigenvalues[*b].total_cmp(&eigen.eigenvalues[*a]));
        let squares = order.map(|axis| eigen.eigenvalues[axis].max(0.0));
        if squares[1] <= MIN_WIDTH * MIN_WIDTH * squares[0] {
            return Err(ScanError::Line { width_mm: (squares[1] / self.count).sqrt() });
        }
        let [along, across, normal] = order.map(|axis| eigen.eigenvectors.column(axis).into_owned());
        let centroid = self.sum / self.count;
        Ok(Fitted {
            plane: Plane::through(centroid, normal),
            centroid,
            axes: [along, across],
            squares,
            count: self.count,
        })
    }
}

/// A fit about the cloud's origin.
struct Fitted {
    plane: Plane,
    centroid: Vec3,
    axes: [Vec3; 2],
    /// Sums of squares along the axes and the normal, mm².
    squares: [f64; 3],
    count: f64,
}

impl Fitted {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "counts of points")]
    fn finish(&self, cloud: &Cloud, set: &PointSet, limit_mm: f64) -> PlaneFit {
        let weights = Vec3::new(1.0 / self.count, 1.0 / self.squares[0], 1.0 / self.squares[1]);
        let variance = self.squares[2] / (self.count - 3.0).max(1.0);
        let mut influences = self.scores(cloud, set, limit_mm);
        for (_, influence) in &mut influences {
            influence.component_mul_assign(&weights);
        }
        let num_profiles = influences.len();
        if num_profiles < MIN_PROFILES {
            influences.clear();
        }
        let covariance = if influences.is_empty() {
            Mat3::from_diagonal(&(weights * variance))
        } else {
            for (_, influence) in &mut influences {
                *influence *= small_sample(num_profiles);
            }
            influences.iter().fold(Mat3::zeros(), |sum, (_, influence)| sum + influence * influence.transpose())
        };
        PlaneFit {
            plane: Plane::through(self.centroid + cloud.origin_mm(), self.plane.normal),
            centroid_mm: self.centroid + cloud.origin_mm(),
            axes: self.axes,
            covariance,
            rms_mm: (self.squares[2] / self.count).sqrt(),
            num_points: set.len(),
            num_used: self.count as usize,
            num_profiles,
            influences,
        }
    }

    /// Per profile, the sums of the distances and of their products with the places along the axes.
    fn scores(&self, cloud: &Cloud, set: &PointSet, limit_mm: f64) -> Vec<(u32, Vec3)> {
        let profiles = cloud.profile_idx();
        let parts = for_pieces(set, |piece| {
            let mut scores: Vec<(u32, Vec3)> = Vec::new();
            for idx in piece.iter().cloned().flatten() {
                let from_centroid = cloud.offset_mm(idx) - self.centroid;
                let distance = self.plane.normal.dot(&from_centroid);
                if distance.abs() > limit_mm {
                    continue;
                }
                let [s, t] = self.axes.map(|axis| axis.dot(&from_centroid));
                add_score(&mut scores, profiles[idx], Vec3::new(distance, distance * s, distance * t));
            }
            scores
        });
        let mut parts: Vec<(u32, Vec3)> = parts.into_iter().flatten().collect();
        // Already so, but for clouds from elsewhere.
        parts.sort_by_key(|(profile, _)| *profile);
        let mut scores = Vec::new();
        for (profile, score) in parts {
            add_score(&mut scores, profile, score);
        }
        scores
    }
}

fn add_score(scores: &mut Vec<(u32, Vec3)>, profile: u32, score: Vec3) {
    match scores.last_mut() {
        Some((last, sum)) if *last == profile => *sum += score,
        _ => scores.push((profile, score)),
    }
}

/// Residuals of a fit are smaller than the errors that they stand for: three unknowns were taken from the profiles.
#[expect(clippy::cast_precision_loss, reason = "a count of profiles")]
fn small_sample(num_profiles: usize) -> f64 {
    (num_profiles as f64 / (num_profiles as f64 - 3.0)).sqrt()
}

/// The plane through three points of a sample that has the least median distance to all of them.
fn least_median(sample: &[Vec3]) -> Option<Plane> {
    /// A median needs no more.
    const NUM_JUDGES: usize = 500;
    let mut random = SplitMix::new(SEED);
    let step = sample.len().div_ceil(NUM_JUDGES);
    let mut distances = Vec::new();
    let mut best: Option<(f64, Plane)> = None;
    for _ in 0..NUM_STARTS {
        let [a, b, c] = std::array::from_fn(|_| sample[random.below(sample.len())]);
        let Some(normal) = (b - a).cross(&(c - a)).try_normalize(1e-9) else { continue };
        let plane = Plane::through(a, normal);
        distances.clear();
        distances.extend(sample.iter().step_by(step).map(|point| plane.distance_mm(*point).abs()));
        let middle = median(&mut distances);
        if best.as_ref().is_none_or(|(least, _)| middle < *least) {
            best = Some((middle, plane));
        }
    }
    best.map(|(_, plane)| plane)
}

/// The robust standard deviation of a sample about a plane, mm; never less than what 32 bits hold.
fn scale_mm(plane: &Plane, sample: &[Vec3]) -> f64 {
    const RESOLUTION: f64 = 1e-6;
    let mut distances: Vec<f64> = sample.iter().map(|point| plane.distance_mm(*point).abs()).collect();
    let extent = sample.iter().map(Vec3::amax).fold(1.0, f64::max);
    (STD_OVER_MAD * median(&mut distances)).max(RESOLUTION * extent)
}

impl PlaneFit {
    /// Standard deviation of the normal's direction, rad: about both axes together.
    #[must_use]
    pub fn normal_std_rad(&self) -> f64 {
        (self.covariance[(1, 1)] + self.covariance[(2, 2)]).max(0.0).sqrt()
    }

    /// Standard deviation of the plane's height at the midst of its points, mm.
    #[must_use]
    pub fn height_std_mm(&self) -> f64 {
        self.covariance[(0, 0)].max(0.0).sqrt()
    }

    /// Whether the standard deviations come from how profiles scatter; otherwise every point counts for itself, which is far
    /// too good if the robot's noise is in them.
    #[must_use]
    pub const fn is_known_from_profiles(&self) -> bool {
        !self.influences.is_empty()
    }

    /// Change of the unit normal by (height, slope, slope).
    fn normal_changes(&self) -> [Vec3; 3] {
        // The normal may have been turned round; the slopes are those of the height along it.
        [Vec3::zeros(), -self.axes[0], -self.axes[1]]
    }

    /// The equation with its standard deviations.
    #[must_use]
    pub fn equation(&self) -> PlaneEquation {
        let Plane { normal, offset_mm } = self.plane;
        let leading = normal.iamax();
        let scale = 1.0 / normal[leading];
        let mut gradients = [Vec3::zeros(); 4];
        for (parameter, change) in self.normal_changes().into_iter().enumerate() {
            for axis in 0..3 {
                gradients[axis][parameter] = scale * (change[axis] - scale * normal[axis] * change[leading]);
            }
            let height = if parameter == 0 { 1.0 } else { 0.0 };
            let offset_change = change.dot(&self.centroid_mm) + height;
            gradients[3][parameter] = scale * (offset_change - scale * offset_mm * change[leading]);
        }
        let [x, y, z, offset_std_mm] = gradients.map(|g| g.dot(&(self.covariance * g)).max(0.0).sqrt());
        PlaneEquation {
            coefficients: [normal.x * scale, normal.y * scale, normal.z * scale],
            coefficient_stds: [x, y, z],
            leading,
            offset_mm: offset_mm * scale,
            offset_std_mm,
        }
    }
}

/// The angle between two planes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaneAngle {
    /// 0 to 90°, in rad.
    pub angle_rad: f64,
    /// Its standard deviation, rad.
    pub std_rad: f64,
}

/// The angle between two planes of a scan. Errors of profiles that see both are counted as the same error.
#[must_use]
pub fn angle_between(first: &PlaneFit, second: &PlaneFit) -> PlaneAngle {
    let (a, b) = (first.plane.normal, second.plane.normal);
    let cosine = a.dot(&b);
    let sine = a.cross(&b).norm();
    let angle_rad = sine.atan2(cosine.abs());
    // Where the planes are parallel any tilt opens an angle.
    let gradient = |fit: &PlaneFit, other: &Vec3| {
        let [_, s, t] = fit.normal_changes();
        Vec3::new(0.0, s.dot(other), t.dot(other)) * (-cosine.signum() / sine.max(1e-6))
    };
    let (of_first, of_second) = (gradient(first, &b), gradient(second, &a));
    let variance = if sine < 1e-6 {
        first.normal_std_rad().powi(2) + second.normal_std_rad().powi(2)
    } else if first.influences.is_empty() || second.influences.is_empty() {
        of_first.dot(&(first.covariance * of_first)) + of_second.dot(&(second.covariance * of_second))
    } else {
        let mut changes: Vec<(u32, f64)> = Vec::new();
        changes.extend(first.influences.iter().map(|(profile, influence)| (*profile, of_first.dot(influence))));
        changes.extend(second.influences.iter().map(|(profile, influence)| (*profile, of_second.dot(influence))));
        changes.sort_by_key(|(profile, _)| *profile);
        let of_profile = |same: &[(u32, f64)]| same.iter().map(|(_, change)| change).sum::<f64>().powi(2);
        changes.chunk_by(|a, b| a.0 == b.0).map(of_profile).sum()
    };
    PlaneAngle { angle_rad, std_rad: variance.max(0.0).sqrt() }
}
