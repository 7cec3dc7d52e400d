//! Whether a given matrix is a calibration at all, and how two calibrations differ (Chen et al. 2023, Table 2).

use nalgebra::UnitQuaternion;

use crate::geometry::{Flange, Mat3, Sensor, Transform, Vec3, so3};

/// A matrix as somebody gave it: 3 × 4, or 4 × 4 with its last row checked.
#[derive(Clone, Debug, PartialEq)]
pub struct GivenMatrix {
    /// The left three columns.
    pub rotation: Mat3,
    /// The fourth column, mm.
    pub translation_mm: Vec3,
    /// Decimals of the rotation as it was written: what rounding alone may have spoilt.
    pub decimals: usize,
}

/// What is wrong with the columns of a matrix that is no rotation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ColumnFault {
    /// A column that is not of length 1.
    Length {
        /// Which, from 0.
        column: usize,
        /// How long it is.
        length: f64,
    },
    /// Two columns that are not perpendicular.
    Angle {
        /// Which, from 0.
        columns: [usize; 2],
        /// The angle between them, rad.
        angle_rad: f64,
    },
}

/// An element that may be misprinted: with another sign or decimal point the matrix is far nearer to a rotation.
#[derive(Clone, Debug, PartialEq)]
pub struct Suspect {
    /// Its row, from 0.
    pub row: usize,
    /// Its column, from 0.
    pub column: usize,
    /// What stands there.
    pub found: f64,
    /// What would fit, to as many digits as the matrix was printed with.
    pub likely: f64,
    /// The defect with that.
    pub defect_then: f64,
    /// What is wrong all the same.
    pub faults_then: Vec<ColumnFault>,
}

/// How far a matrix is from a rotation.
#[derive(Clone, Debug, PartialEq)]
pub struct MatrixCheck {
    /// Lengths of the columns; 1 in a rotation.
    pub column_norms: [f64; 3],
    /// Dot products of columns 1·2, 1·3 and 2·3; 0 in a rotation.
    pub dot_products: [f64; 3],
    /// The determinant; 1 in a rotation.
    pub determinant: f64,
    /// The largest element of `RᵀR − 1`, by size: 0 for a rotation.
    pub defect: f64,
    /// How large that may be by rounding alone.
    pub rounding: f64,
    /// The nearest rotation; `None` of a matrix that has lost a dimension.
    pub nearest: Option<UnitQuaternion<f64>>,
    /// The largest angle between a column and the same column of the nearest rotation, rad.
    pub angle_rad: Option<f64>,
    /// Decimals of the rotation as it was written.
    pub decimals: usize,
    /// What is wrong with its columns, beyond rounding.
    pub faults: Vec<ColumnFault>,
    /// The elements of which one is most likely misprinted, the likeliest first; none where none stands out.
    pub suspects: Vec<Suspect>,
}

/// Files hold some sixteen digits; sums of nine products of them are good to this.
const LEAST_ROUNDING: f64 = 1e-9;
/// A misprint is named if mending it makes the defect this many times smaller.
const STANDS_OUT: f64 = 4.0;
/// Misprints that leave no more than so many times the least defect are as likely as the one that leaves it.
const AS_LIKELY: f64 = 1.5;

impl GivenMatrix {
    /// A calibration as a matrix with all its digits.
    #[must_use]
    pub fn from_transform(flange_from_sensor: &Transform<Flange, Sensor>) -> Self {
        Self {
            rotation: flange_from_sensor.rotation().to_rotation_matrix().into_inner(),
            translation_mm: flange_from_sensor.translation_mm(),
            decimals: 15,
        }
    }

    /// Looks whether the left part is a rotation.
    #[must_use]
    pub fn check(&self) -> MatrixCheck {
        let m = &self.rotation;
        let gram = m.transpose() * m;
        let (defect, rounding) = (defect(m), self.rounding());
        let nearest = so3::nearest_rotation(m);
        MatrixCheck {
            column_norms: [0, 1, 2].map(|column| m.column(column).norm()),
            dot_products: [gram[(0, 1)], gram[(0, 2)], gram[(1, 2)]],
            determinant: m.determinant(),
            defect,
            rounding,
            nearest,
            angle_rad: nearest.map(|nearest| largest_angle(m, &nearest)),
            decimals: self.decimals,
            faults: column_faults(m, rounding),
            suspects: if defect > rounding { self.suspects(defect) } else { Vec::new() },
        }
    }

    /// The nearest calibration; `None` of a matrix that has lost a dimension.
    #[must_use]
    pub fn nearest(&self) -> Option<Transform<Flange, Sensor>> {
        Some(Transform::from_parts(self.translation_mm, so3::nearest_rotation(&self.rotation)?))
    }

    /// The largest defect by rounding: each element is off by half a unit of its last digit at most, and the elements of a
    /// unit column have sizes that sum to √3 at most.
    fn rounding(&self) -> f64 {
        let half_unit = 0.5 * 10.0_f64.powi(-i32::try_from(self.decimals).unwrap_or(i32::MAX));
        (2.0 * 3.0_f64.sqrt() * half_unit).max(LEAST_ROUNDING)
    }

    /// Tries another sign, the decimal point one place to the left, and both, for each element.
    fn suspects(&self, defect_now: f64) -> Vec<Suspect> {
        let unit = 10.0_f64.powi(i32::try_from(self.decimals).unwrap_or(i32::MAX));
        let mut suspects = Vec::new();
        for (row, column) in (0..3).flat_map(|row| (0..3).map(move |column| (row, column))) {
            let found = self.rotation[(row, column)];
            for likely in [-found, found / 10.0, -found / 10.0] {
                let likely = (likely * unit).round() / unit;
                let mut mended = self.rotation;
                mended[(row, column)] = likely;
                let faults_then = column_faults(&mended, self.rounding());
                suspects.push(Suspect { row, column, found, likely, defect_then: defect(&mended), faults_then });
            }
        }
        suspects.sort_by(|a, b| a.defect_then.total_cmp(&b.defect_then));
        let least = suspects.first().map_or(0.0, |best| best.defect_then);
        let most = (AS_LIKELY * least.max(self.rounding())).min(defect_now / STANDS_OUT);
        suspects.retain(|suspect| suspect.defect_then <= most);
        suspects
    }
}

impl MatrixCheck {
    /// Whether it is a rotation as far as its digits tell.
    #[must_use]
    pub fn is_rotation(&self) -> bool {
        self.defect <= self.rounding && self.determinant > 0.0
    }
}

/// The largest element of `RᵀR − 1`; a mirrored matrix is off by the whole of its determinant.
fn defect(m: &Mat3) -> f64 {
    let off = (m.transpose() * m - Mat3::identity()).amax();
    if m.determinant() < 0.0 { off.max(2.0) } else { off }
}

fn largest_angle(m: &Mat3, nearest: &UnitQuaternion<f64>) -> f64 {
    let rotation = nearest.to_rotation_matrix();
    let angle = |column: usize| m.column(column).angle(&rotation.matrix().column(column));
    [0, 1, 2].map(angle).into_iter().fold(0.0, f64::max)
}

/// The columns that are not of length 1, or not perpendicular, by more than rounding explains; the worst first.
fn column_faults(m: &Mat3, rounding: f64) -> Vec<ColumnFault> {
    let gram = m.transpose() * m;
    let of_length = (0..3).map(|column| {
        let length = m.column(column).norm();
        ((gram[(column, column)] - 1.0).abs(), ColumnFault::Length { column, length })
    });
    let of_angle = [[0, 1], [0, 2], [1, 2]].into_iter().map(|columns| {
        let [a, b] = columns.map(|column| m.column(column));
        (a.dot(&b).abs(), ColumnFault::Angle { columns, angle_rad: a.angle(&b) })
    });
    let mut faults: Vec<(f64, ColumnFault)> = of_length.chain(of_angle).filter(|(off, _)| *off > rounding).collect();
    faults.sort_by(|a, b| b.0.total_cmp(&a.0));
    faults.into_iter().map(|(_, fault)| fault).collect()
}

/// How a second calibration of a sensor differs from a first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MatrixDifference {
    /// Second minus first translation, along the flange's axes, mm.
    pub translation_mm: Vec3,
    /// Angle between the two orientations, rad.
    pub rotation_rad: f64,
    /// How far apart the two put a point of the sensor frame, mm.
    pub at_point_mm: f64,
}

impl MatrixDifference {
    /// How `second` differs from `first`, and by how much at a point of the sensor frame, mm.
    #[must_use]
    pub fn between(
        first: &Transform<Flange, Sensor>,
        second: &Transform<Flange, Sensor>,
        point_in_sensor_mm: Vec3,
    ) -> Self {
        Self {
            translation_mm: second.translation_mm() - first.translation_mm(),
            rotation_rad: first.rotation().angle_to(&second.rotation()),
            at_point_mm: (second.map_point(point_in_sensor_mm) - first.map_point(point_in_sensor_mm)).norm(),
        }
    }
}
