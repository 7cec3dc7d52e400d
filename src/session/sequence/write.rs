//! Poses as the benchmark has them, for other programs.

use crate::geometry::{Frame, Transform};

/// A line a pose: time tx ty tz qx qy qz qw, metres, with all digits that matter.
#[must_use]
pub fn trajectory_text<Dst: Frame, Src: Frame>(poses: impl Iterator<Item = (f64, Transform<Dst, Src>)>) -> String {
    let line = |(time_s, pose): (f64, Transform<Dst, Src>)| {
        let t = pose.translation_mm() / 1000.0;
        let [w, x, y, z] = pose.quaternion_wxyz();
        format!("{time_s:.6} {:.9} {:.9} {:.9} {x:.12} {y:.12} {z:.12} {w:.12}\n", t.x, t.y, t.z)
    };
    poses.map(line).collect()
}
