//! How points lie about their centroid: the lines and planes of total least squares.

use super::{Mat3, Vec3};

/// Centroid of points, and the directions in which they reach least and most.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scatter {
    /// The mean of the points, mm.
    pub centroid_mm: Vec3,
    /// The direction of the plane's normal, of length 1.
    pub narrowest: Vec3,
    /// The direction of the line, of length 1.
    pub widest: Vec3,
    /// Root mean square distance from the plane, mm.
    pub thickness_mm: f64,
}

impl Scatter {
    /// Of some points; `None` of none.
    #[must_use]
    pub fn of(points: impl Iterator<Item = Vec3> + Clone) -> Option<Self> {
        let (sum, count) = points.clone().fold((Vec3::zeros(), 0.0), |(sum, count), point| (sum + point, count + 1.0));
        if count < 1.0 {
            return None;
        }
        let centroid_mm = sum / count;
        let squares =
            points.map(|point| point - centroid_mm).fold(Mat3::zeros(), |sum, off| sum + off * off.transpose());
        let eigen = squares.symmetric_eigen();
        let (least, most) = (eigen.eigenvalues.imin(), eigen.eigenvalues.imax());
        Some(Self {
            centroid_mm,
            narrowest: eigen.eigenvectors.column(least).into_owned(),
            widest: eigen.eigenvectors.column(most).into_owned(),
            thickness_mm: (eigen.eigenvalues[least].max(0.0) / count).sqrt(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sheet_of_points_has_its_normal_and_its_length() {
        let point = |idx: u8| {
            let (x, y) = (f64::from(idx % 10), 0.3 * f64::from(idx / 10));
            // A checkerboard leaves the plane level.
            Vec3::new(5.0 + x, -2.0 + y, if (idx / 10 + idx % 10).is_multiple_of(2) { 0.01 } else { -0.01 })
        };
        let scatter = Scatter::of((0..100).map(point)).expect("points");
        assert!(scatter.narrowest.z.abs() > 0.999 && scatter.widest.x.abs() > 0.999, "{scatter:?}");
        assert!((scatter.thickness_mm - 0.01).abs() < 1e-4, "{scatter:?}");
        assert!((scatter.centroid_mm - Vec3::new(9.5, -0.65, 0.0)).norm() < 1e-12);
        assert_eq!(Scatter::of(std::iter::empty()), None);
    }
}
