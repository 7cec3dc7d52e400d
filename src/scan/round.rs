//! Diameters of balls and cylinders.

use nalgebra::{Matrix4, SVector, Vector2, Vector4, Vector5};

use crate::geometry::stats::SplitMix;
use crate::geometry::{Mat3, Vec3};

use super::linear::{Linear, Row, solve};
use super::neighbourhood::{Sample, common_direction};
use super::{Cloud, PointSet, ScanError, suitable_tolerance_mm};

/// Points that are fitted: with more the noise of the robot is all that is left, and that does not fall with them.
const NUM_FITTED: usize = 200_000;
/// Points that starts are judged by.
const NUM_SAMPLED: usize = 4_000;
/// Starts through a few points each.
const NUM_STARTS: usize = 400;
/// Points within this many tolerances of the start are fitted.
const REACH: f64 = 4.0;
/// Steps of the fit; it settles within ten.
const MAX_STEPS: usize = 50;
/// Points needed at least.
const NEEDED: usize = 20;
/// The same points, the same start.
const SEED: u64 = 0xba11;

/// What is round.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RoundKind {
    /// A ball.
    Ball,
    /// A cylinder.
    Cylinder,
}

impl RoundKind {
    const fn name(self) -> &'static str {
        match self {
            Self::Ball => "ball",
            Self::Cylinder => "cylinder",
        }
    }
}

/// A ball or cylinder.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Round {
    /// Which of them.
    pub kind: RoundKind,
    /// Its centre, or a point of its axis in the midst of the points, mm.
    pub centre_mm: Vec3,
    /// The direction of its axis, for a cylinder.
    pub axis: Option<Vec3>,
    /// Its diameter, mm.
    pub diameter_mm: f64,
    /// Standard deviation of that, from how the profiles scatter, mm.
    pub diameter_std_mm: f64,
    /// Distances of the points used from the surface, mm: root mean square.
    pub rms_mm: f64,
    /// Points that were fitted and not trimmed; of a large region as many, evenly spread, as are of use.
    pub num_used: usize,
}

impl Round {
    /// How far a point is outside of the surface, mm; negative inside.
    #[must_use]
    pub fn distance_mm(&self, point_mm: Vec3) -> f64 {
        let away = point_mm - self.centre_mm;
        let across = self.axis.map_or(away, |axis| away - axis * axis.dot(&away));
        across.norm() - self.diameter_mm / 2.0
    }
}

/// Fits a ball or cylinder by least squares, trimmed, to the points of a region that are of it.
///
/// # Errors
/// [`ScanError::TooFewPoints`] or [`ScanError::NotRound`].
pub fn fit_round(cloud: &Cloud, set: &PointSet, kind: RoundKind) -> Result<Round, ScanError> {
    if set.len() < NEEDED {
        return Err(ScanError::TooFewPoints { what: kind.name(), found: set.len(), needed: NEEDED });
    }
    let not_round = |why| ScanError::NotRound { what: kind.name(), why };
    let sample = Sample::of(cloud, set, NUM_SAMPLED);
    let tolerance_mm = suitable_tolerance_mm(cloud, set);
    // What is larger than the region is as good as flat there.
    let most_radius_mm = cloud.bounds_of_mm(set).map_or(0.0, |[low, high]| (high - low).norm());
    let search = Search { sample: &sample, tolerance_mm, most_radius_mm };
    let (mut shape, axes) = match kind {
        RoundKind::Ball => (search.ball().ok_or(not_round("they lie in a plane"))?, None),
        RoundKind::Cylinder => {
            let normals: Vec<Vec3> = sample.patches(NUM_STARTS).iter().map(|patch| patch.plane.normal).collect();
            let (axis, _) = common_direction(&normals).ok_or(not_round("they are too few to tell its direction"))?;
            (search.cylinder(axis).ok_or(not_round("they lie in a plane"))?, Some(axis))
        }
    };
    let limit_mm = REACH * tolerance_mm;
    let near = set.filter(cloud, |point| shape.distance_mm(point).abs() <= limit_mm);
    let points: Vec<(Vec3, u32)> =
        near.thinned(NUM_FITTED).into_iter().map(|idx| (cloud.offset_mm(idx), cloud.profile_idx()[idx])).collect();
    let flat = not_round("they show too little of its curve");
    let (radius_std_mm, rms_mm, num_used) = match axes {
        None => shape.settle_ball(&points).ok_or(flat)?,
        Some(_) => shape.settle_cylinder(&points).ok_or(flat)?,
    };
    // The midst of the points seen, on the axis.
    if let Some(axis) = shape.axis {
        #[expect(clippy::cast_precision_loss, reason = "a count of points")]
        let middle =
            points.iter().map(|(point, _)| (point - shape.centre).dot(&axis)).sum::<f64>() / points.len() as f64;
        shape.centre += axis * middle;
    }
    if shape.radius_mm > most_radius_mm || radius_std_mm > shape.radius_mm {
        return Err(not_round("they show too little of its curve"));
    }
    Ok(Round {
        kind,
        centre_mm: shape.centre + cloud.origin_mm(),
        axis: shape.axis,
        diameter_mm: 2.0 * shape.radius_mm,
        diameter_std_mm: 2.0 * radius_std_mm,
        rms_mm,
        num_used,
    })
}

/// A ball, or a cylinder where there is an axis; about the cloud's origin.
#[derive(Clone, Copy, Debug)]
struct Shape {
    centre: Vec3,
    axis: Option<Vec3>,
    radius_mm: f64,
}

impl Shape {
    /// From the centre or the nearest point of the axis to a point.
    fn away(&self, point: Vec3) -> Vec3 {
        let away = point - self.centre;
        self.axis.map_or(away, |axis| away - axis * axis.dot(&away))
    }

    fn distance_mm(&self, point: Vec3) -> f64 {
        self.away(point).norm() - self.radius_mm
    }

    /// Outwards at a point, and the distance of the point from the surface.
    fn outward(&self, point: Vec3) -> (Vec3, f64) {
        let away = self.away(point);
        let distance = away.norm();
        (away / distance.max(f64::MIN_POSITIVE), distance - self.radius_mm)
    }

    fn settle_ball(&mut self, points: &[(Vec3, u32)]) -> Option<(f64, f64, usize)> {
        settle(
            self,
            points,
            |shape, point| {
                let (outward, distance) = shape.outward(point);
                (Vector4::new(outward.x, outward.y, outward.z, 1.0), distance)
            },
            |shape, step| {
                shape.centre += step.xyz();
                shape.radius_mm += step.w;
            },
        )
    }

    fn settle_cylinder(&mut self, points: &[(Vec3, u32)]) -> Option<(f64, f64, usize)> {
        settle(
            self,
            points,
            |shape, point| {
                let axis = shape.axis.unwrap_or_else(Vec3::z);
                let (outward, distance) = shape.outward(point);
                let [s, t] = across(axis).map(|direction| direction.dot(&outward));
                let along = axis.dot(&(point - shape.centre));
                (Vector5::new(s, t, along * s, along * t, 1.0), distance)
            },
            |shape, step| {
                let axis = shape.axis.unwrap_or_else(Vec3::z);
                let [first, second] = across(axis);
                shape.centre += first * step[0] + second * step[1];
                shape.axis = Some((axis + first * step[2] + second * step[3]).normalize());
                shape.radius_mm += step[4];
            },
        )
    }
}

/// Steps until nothing changes; the last unknown is the radius. Its standard deviation, what is left over, and the number of
/// points used.
fn settle<const N: usize>(
    shape: &mut Shape,
    points: &[(Vec3, u32)],
    terms: impl Fn(&Shape, Vec3) -> (SVector<f64, N>, f64),
    apply: impl Fn(&mut Shape, &SVector<f64, N>),
) -> Option<(f64, f64, usize)> {
    let mut before = f64::INFINITY;
    for _ in 0..MAX_STEPS {
        let rows: Vec<Row<N>> = points
            .iter()
            .map(|(point, profile)| {
                let (terms, value) = terms(shape, *point);
                Row { terms, value, profile: *profile }
            })
            .collect();
        let Linear { solution, covariance, rms, num_used, .. } = solve(&rows)?;
        apply(shape, &solution);
        if !(shape.radius_mm.is_finite() && shape.radius_mm > 0.0) {
            return None;
        }
        let step = solution.amax();
        // Trimming may go to and fro between two points; then the steps are tiny but do not vanish.
        if step < 1e-9 * shape.radius_mm.max(1.0) || (step < 1e-6 && step >= before) {
            return Some((covariance[(N - 1, N - 1)].max(0.0).sqrt(), rms, num_used));
        }
        before = step;
    }
    None
}

/// Where shapes are looked for.
struct Search<'a> {
    sample: &'a Sample,
    tolerance_mm: f64,
    most_radius_mm: f64,
}

impl Search<'_> {
    /// The best of many shapes through a few points of the sample: most points are on it.
    fn best(&self, through: impl Fn(&mut dyn FnMut() -> Vec3) -> Option<Shape>) -> Option<Shape> {
        let points = &self.sample.points;
        let mut random = SplitMix::new(SEED);
        let mut draw = || points[random.below(points.len())];
        let count =
            |shape: &Shape| points.iter().filter(|point| shape.distance_mm(**point).abs() <= self.tolerance_mm).count();
        (0..NUM_STARTS)
            .filter_map(|_| through(&mut draw).filter(|shape| shape.radius_mm <= self.most_radius_mm))
            .max_by_key(count)
    }

    fn ball(&self) -> Option<Shape> {
        self.best(|draw| {
            let points: [Vec3; 4] = std::array::from_fn(|_| draw());
            let left = Matrix4::from_fn(|row, column| if column < 3 { points[row][column] } else { 1.0 });
            let right = Vector4::from_fn(|row, _| points[row].norm_squared());
            let solution = left.lu().solve(&right)?;
            let centre = solution.xyz() / 2.0;
            Some(Shape { centre, axis: None, radius_mm: (solution.w + centre.norm_squared()).sqrt() })
        })
    }

    fn cylinder(&self, axis: Vec3) -> Option<Shape> {
        let [first, second] = across(axis);
        self.best(|draw| {
            let points: [Vector2<f64>; 3] = std::array::from_fn(|_| {
                let point = draw();
                Vector2::new(first.dot(&point), second.dot(&point))
            });
            let left = Mat3::from_fn(|row, column| if column < 2 { points[row][column] } else { 1.0 });
            let right = Vec3::from_fn(|row, _| points[row].norm_squared());
            let solution = left.lu().solve(&right)?;
            let centre = solution.xy() / 2.0;
            let radius_mm = (solution.z + centre.norm_squared()).sqrt();
            Some(Shape { centre: first * centre.x + second * centre.y, axis: Some(axis), radius_mm })
        })
    }
}

/// Two directions across an axis.
fn across(axis: Vec3) -> [Vec3; 2] {
    let first = axis.cross(&Vec3::ith(axis.iamin(), 1.0)).normalize();
    [first, axis.cross(&first)]
}
