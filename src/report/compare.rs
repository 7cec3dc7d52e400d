//! Calibrations side by side: how they differ, which is better by how much, and what a paper printed.

use crate::calibrate::{Method, MethodResult, Solution, solution_of};
use crate::geometry::Vec3;
use crate::session::{Published, Truth};

/// Printed errors are rounded to three decimals, and so are the two centres they follow from; what differs from the
/// recomputed error by more than that, mm, is a misprint.
pub const MISPRINT_ABOVE_MM: f64 = 0.0006;

/// The difference between two calibrations of the same sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Difference {
    /// Second minus first translation, along the flange's axes, mm.
    pub translation_mm: Vec3,
    /// Angle between the two orientations, rad.
    pub rotation_rad: f64,
    /// How far apart the two put the workspace point, mm.
    pub workspace_point_mm: f64,
    /// That distance over its standard deviation, taking the two as independent; `None` without both uncertainties.
    pub in_stds: Option<f64>,
}

/// How `second` differs from `first`.
#[must_use]
pub fn difference(first: &Solution, second: &Solution) -> Difference {
    let (first_transform, second_transform) = (&first.flange_from_sensor, &second.flange_from_sensor);
    let reference_point = second
        .uncertainty
        .as_ref()
        .or(first.uncertainty.as_ref())
        .map_or_else(Vec3::zeros, |uncertainty| uncertainty.reference_point_in_sensor_mm);
    let workspace_point_mm =
        (second_transform.map_point(reference_point) - first_transform.map_point(reference_point)).norm();
    let in_stds = first.uncertainty.as_ref().zip(second.uncertainty.as_ref()).map(|(a, b)| {
        workspace_point_mm / a.workspace_point_std_mm.hypot(b.workspace_point_std_mm).max(f64::MIN_POSITIVE)
    });
    Difference {
        translation_mm: second_transform.translation_mm() - first_transform.translation_mm(),
        rotation_rad: first_transform.rotation().angle_to(&second_transform.rotation()),
        workspace_point_mm,
        in_stds,
    }
}

/// The paper's "maximum error": the largest coordinate of any station's ball relative to the first station's, mm; of a plate
/// the largest distance of a point from its edge; of a camera's way what the steps of its worst stretch are off by.
#[must_use]
pub fn maximum_error_mm(solution: &Solution) -> f64 {
    let is_tracked = solution.motion.as_ref().is_some_and(|motion| motion.tracked.is_some());
    if solution.plate.is_some() || is_tracked {
        return solution.scatter.max_mm;
    }
    solution.stations.iter().map(|station| station.error_from_first_mm.amax()).fold(0.0, f64::max)
}

/// Maximum errors that differ by no more than this, percent, are alike: chance of the stations decides.
pub const ALIKE_WITHIN_PERCENT: f64 = 5.0;

/// By how much one method's maximum error is below another's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Improvement {
    /// The method held against the baseline.
    pub method: Method,
    /// Its maximum error, mm; of a plate the left-out one.
    pub error_mm: f64,
    /// The baseline.
    pub baseline: Method,
    /// The baseline's, mm.
    pub baseline_error_mm: f64,
}

impl Improvement {
    /// Change against the baseline in percent, negative where the method is better; `None` for an exact baseline.
    #[must_use]
    pub fn percent(&self) -> Option<f64> {
        (self.baseline_error_mm > 0.0).then(|| (self.error_mm / self.baseline_error_mm - 1.0) * 100.0)
    }

    /// Whether the two errors are too near to each other for either method to be called better.
    #[must_use]
    pub fn is_alike(&self) -> bool {
        self.percent().is_some_and(|percent| percent.abs() <= ALIKE_WITHIN_PERCENT)
    }
}

/// The paper's comparison: the largest arc (or, without sweeps, the bundle) against the fixed point; with a plate the bundle
/// against the published method.
#[must_use]
pub fn improvement(results: &[MethodResult]) -> Option<Improvement> {
    let solution = |method| solution_of(results, method);
    let baseline = solution(Method::BallFixedPoint).or_else(|| solution(Method::PlateOrthogonal))?;
    let candidates = [Method::BallMaxArc, Method::BallBundle, Method::PlateBundle];
    let better = candidates.into_iter().find_map(solution)?;
    Some(Improvement {
        method: better.method,
        error_mm: compared_error_mm(better),
        baseline: baseline.method,
        baseline_error_mm: compared_error_mm(baseline),
    })
}

/// The error that two methods are compared by, mm: the paper's for a ball. A plate's in-sample distances are what its bundle
/// trades against each other, so there it is what the other stations predict, RMS.
fn compared_error_mm(solution: &Solution) -> f64 {
    match (&solution.plate, solution.leave_one_out) {
        (Some(_), Some(left_out)) => left_out.rms_mm,
        _ => maximum_error_mm(solution),
    }
}

/// One row of a printed table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PublishedRow {
    /// Printed centre of the ball in the base, mm.
    pub target_in_base_mm: Vec3,
    /// Printed error, mm; `None` where none was printed.
    pub printed_error_mm: Option<Vec3>,
    /// The error that follows from the printed centres, mm.
    pub recomputed_error_mm: Vec3,
    /// Which of the printed coordinates cannot have come from the printed centres.
    pub is_misprint: [bool; 3],
}

/// Recomputes the printed errors from the printed centres.
#[must_use]
pub fn published_rows(published: &Published) -> Vec<PublishedRow> {
    let Some(first) = published.target_in_base_mm.first() else { return Vec::new() };
    published
        .target_in_base_mm
        .iter()
        .enumerate()
        .map(|(row_idx, centre)| {
            let printed_error_mm = published.error_from_first_mm.get(row_idx).copied();
            let recomputed_error_mm = centre - first;
            PublishedRow {
                target_in_base_mm: *centre,
                printed_error_mm,
                recomputed_error_mm,
                is_misprint: [0, 1, 2].map(|axis| {
                    printed_error_mm
                        .is_some_and(|printed| (printed[axis] - recomputed_error_mm[axis]).abs() > MISPRINT_ABOVE_MM)
                }),
            }
        })
        .collect()
}

/// How far a calibration is from the truth of a simulated session.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TruthDistance {
    /// Of the workspace point, mm.
    pub workspace_point_mm: f64,
    /// Of the orientation, rad.
    pub rotation_rad: f64,
}

/// How far `solution` is from `truth`, at the workspace point where there is one, else at the middle of what was seen.
#[must_use]
pub fn distance_from_truth(solution: &Solution, truth: &Truth) -> TruthDistance {
    let reference_point = solution.uncertainty.as_ref().map_or_else(
        || {
            let points = solution.plate.iter().flat_map(|plate| &plate.points);
            let seen = || {
                let of_stations = solution.stations.iter().map(|station| station.target_in_sensor_mm);
                of_stations.chain(points.clone().map(|point| point.point_in_sensor_mm))
            };
            let count = seen().count().max(1);
            let sum: Vec3 = seen().sum();
            #[expect(clippy::cast_precision_loss, reason = "a session has few stations")]
            let count = count as f64;
            sum / count
        },
        |uncertainty| uncertainty.reference_point_in_sensor_mm,
    );
    let (found, truth) = (&solution.flange_from_sensor, &truth.flange_from_sensor);
    TruthDistance {
        workspace_point_mm: (found.map_point(reference_point) - truth.map_point(reference_point)).norm(),
        rotation_rad: found.rotation().angle_to(&truth.rotation()),
    }
}

/// The 1σ ellipse of a cloud of points in a plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScatterEllipse {
    /// Middle of the points.
    pub centre: [f64; 2],
    /// Standard deviation along the long axis, then along the short one.
    pub semi_axes: [f64; 2],
    /// Direction of the long axis, from the first coordinate towards the second, rad.
    pub angle_rad: f64,
}

/// The 1σ ellipse of `points`; `None` below three, which say nothing about a spread in two directions.
#[must_use]
pub fn scatter_ellipse(points: &[[f64; 2]]) -> Option<ScatterEllipse> {
    if points.len() < 3 {
        return None;
    }
    #[expect(clippy::cast_precision_loss, reason = "a session has few stations")]
    let count = points.len() as f64;
    let mean = |axis: usize| points.iter().map(|point| point[axis]).sum::<f64>() / count;
    let centre = [mean(0), mean(1)];
    let moment = |a: usize, b: usize| {
        points.iter().map(|point| (point[a] - centre[a]) * (point[b] - centre[b])).sum::<f64>() / (count - 1.0)
    };
    let (xx, yy, xy) = (moment(0, 0), moment(1, 1), moment(0, 1));
    // Eigenvalues of the symmetric 2 × 2 matrix, in closed form.
    let (middle, half_gap) = (f64::midpoint(xx, yy), ((xx - yy) / 2.0).hypot(xy));
    Some(ScatterEllipse {
        centre,
        semi_axes: [(middle + half_gap).sqrt(), (middle - half_gap).max(0.0).sqrt()],
        angle_rad: 0.5 * (2.0 * xy).atan2(xx - yy),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::session::model::UnknownFields;

    fn table_1() -> Published {
        Published {
            target_in_base_mm: vec![
                Vec3::new(324.442, -47.636, 140.087),
                Vec3::new(324.593, -47.847, 140.077),
                Vec3::new(324.298, -47.429, 140.021),
            ],
            error_from_first_mm: vec![Vec3::zeros(), Vec3::new(0.151, 0.211, -0.09), Vec3::new(-0.144, 0.207, -0.066)],
            caption: "Lin & Mu 2019, Table 1".to_owned(),
            unknown: UnknownFields::new(),
        }
    }

    #[test]
    fn misprints_of_the_papers_first_table_are_found() {
        let rows = published_rows(&table_1());
        assert_eq!(rows[0].is_misprint, [false; 3]);
        // The sign of y was lost, and −0.010 became −0.09.
        assert_eq!(rows[1].is_misprint, [false, true, true]);
        assert_eq!(rows[2].is_misprint, [false; 3]);
        // The centres are printed to three decimals.
        assert!((rows[1].recomputed_error_mm - Vec3::new(0.151, -0.211, -0.010)).norm() < 1e-9);
    }

    #[test]
    fn a_table_without_errors_has_no_misprints() {
        let published = Published { error_from_first_mm: Vec::new(), ..table_1() };
        assert!(
            published_rows(&published)
                .iter()
                .all(|row| row.printed_error_mm.is_none() && row.is_misprint == [false; 3])
        );
        assert!(published_rows(&Published::default()).is_empty());
    }

    #[test]
    fn the_ellipse_follows_the_cloud() {
        // Along the diagonal: ±1 and 0 at 45°.
        let ellipse = scatter_ellipse(&[[-1.0, -1.0], [0.0, 0.0], [1.0, 1.0]]).expect("three points");
        assert!((ellipse.semi_axes[0] - 2.0_f64.sqrt()).abs() < 1e-12);
        assert!(ellipse.semi_axes[1].abs() < 1e-7);
        assert!((ellipse.angle_rad - std::f64::consts::FRAC_PI_4).abs() < 1e-12);
        assert_eq!(scatter_ellipse(&[[0.0, 0.0], [1.0, 1.0]]), None);
    }

    #[test]
    fn improvement_is_relative_to_the_baseline() {
        let improvement = Improvement {
            method: Method::BallMaxArc,
            error_mm: 0.0815,
            baseline: Method::BallFixedPoint,
            baseline_error_mm: 0.211,
        };
        // The paper's own −61.4 %.
        assert!((improvement.percent().expect("a baseline") + 61.4).abs() < 0.05);
        assert!(!improvement.is_alike());
        assert!(Improvement { error_mm: 0.2131, ..improvement }.is_alike(), "+1 % is nothing");
        assert_eq!(Improvement { baseline_error_mm: 0.0, ..improvement }.percent(), None);
    }
}
