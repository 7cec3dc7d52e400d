//! A JSON list of pairs of 4 × 4 matrices, as `moveit_calibration` saves its samples: the flange (or effector) in the base, and
//! the object in the camera; metres or millimetres.

use crate::geometry::notation::{LengthUnit, OrientationForm};
use crate::geometry::so3::nearest_rotation;
use crate::geometry::{Mat3, PoseNotation};

use super::gather::{Gathered, RawPose};
use super::{Preview, Source};

type Matrix = [[f64; 4]; 4];

/// The pairs of a text.
#[derive(Debug)]
pub(super) struct Pairs(Vec<[Matrix; 2]>);

/// Robots reach and cameras see further than this in millimetres, and not as far in metres.
const LARGEST_METRES: f64 = 5.0;
/// Rounded columns are of unit length and perpendicular within this.
const ROUNDED: f64 = 0.01;

/// The pairs of matrices that a text is; `None` if it is anything else.
pub(super) fn pairs(text: &str) -> Option<Pairs> {
    /// Most texts are no such list, and need not be read to the end.
    const BEGINNING: &str = "[[[[";
    let text = text.trim();
    let opening: String = text.chars().filter(|character| !character.is_whitespace()).take(BEGINNING.len()).collect();
    if opening != BEGINNING {
        return None;
    }
    serde_json::from_str(text).ok().map(Pairs)
}

impl Pairs {
    /// Quaternions in the unit that the numbers show.
    pub fn notation(&self, notation: &PoseNotation) -> PoseNotation {
        let shifts = self.0.iter().flatten().flat_map(|matrix| [matrix[0][3], matrix[1][3], matrix[2][3]]);
        let largest = shifts.fold(0.0_f64, |most, value| most.max(value.abs()));
        PoseNotation {
            orientation: OrientationForm::QuaternionWxyz,
            length_unit: if largest > LARGEST_METRES { LengthUnit::Millimetres } else { LengthUnit::Metres },
            flange_from_tcp: None,
            is_inverse: false,
            ..*notation
        }
    }

    /// Reads all of them; a matrix that is no pose is listed.
    pub fn read(&self, source: &Source, gathered: &mut Gathered, preview: &mut Preview) {
        let notation = *gathered.notation();
        preview.header = ["x", "y", "z", "qw", "qx", "qy", "qz"].map(str::to_owned).to_vec();
        for (idx, [of_flange, of_target]) in self.0.iter().enumerate() {
            let at = (idx + 1, 1);
            preview.num_rows += 1;
            match (numbers(of_flange), numbers(of_target)) {
                (Some(of_flange), Some(of_target)) => {
                    gathered.take(
                        &source.name,
                        &RawPose {
                            at,
                            numbers: &of_flange,
                            target: Some((notation, &of_target)),
                            ..RawPose::default()
                        },
                    );
                }
                _ => gathered.problem(
                    &source.name,
                    at,
                    "a matrix",
                    "4 × 4 numbers that are a rotation and a translation",
                ),
            }
        }
    }
}

/// Position and quaternion; `None` of what is no rigid motion.
fn numbers(matrix: &Matrix) -> Option<[f64; 7]> {
    let rows = Mat3::from_fn(|row, column| matrix[row][column]);
    let is_rotation = (rows.transpose() * rows - Mat3::identity()).amax() < ROUNDED && rows.determinant() > 0.0;
    let is_rigid = matrix[3].iter().zip([0.0, 0.0, 0.0, 1.0]).all(|(found, needed)| (found - needed).abs() < 1e-6);
    if !is_rotation || !is_rigid {
        return None;
    }
    let quaternion = nearest_rotation(&rows)?;
    let [x, y, z] = [0, 1, 2].map(|row| matrix[row][3]);
    Some([x, y, z, quaternion.w, quaternion.i, quaternion.j, quaternion.k])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_lists_of_pairs_of_matrices_are_taken() {
        let matrix = "[[1, 0, 0, 0.5], [0, -1, 0, 0.1], [0, 0, -1, 2], [0, 0, 0, 1]]";
        let found = pairs(&format!("[[{matrix}, {matrix}],\n [{matrix}, {matrix}]]")).expect("pairs");
        assert_eq!(found.0.len(), 2);
        assert_eq!(numbers(&found.0[0][0]), Some([0.5, 0.1, 2.0, 0.0, 1.0, 0.0, 0.0]));
        for other in ["", "[1, 2]", "[[[[1, 2]]]]", "[[[[", "{}"] {
            assert!(pairs(other).is_none(), "{other}");
        }
        let mut sheared = found.0[0][0];
        sheared[0][1] = 0.3;
        assert_eq!(numbers(&sheared), None);
    }
}
