//! Rigid transforms that carry their frames in the type.

use std::marker::PhantomData;
use std::ops::Mul;

use nalgebra::{Matrix4, Translation3, UnitQuaternion};

use super::{Frame, Rigid, Vec3};

/// A rigid motion that maps coordinates in `Src` to coordinates in `Dst`; translation in mm.
///
/// ```
/// use handeye::geometry::{Base, Flange, Sensor, Transform};
/// let base_from_flange = Transform::<Base, Flange>::identity();
/// let flange_from_sensor = Transform::<Flange, Sensor>::identity();
/// let _base_from_sensor: Transform<Base, Sensor> = base_from_flange * flange_from_sensor;
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transform<Dst: Frame, Src: Frame> {
    rigid: Rigid,
    frames: PhantomData<(Dst, Src)>,
}

impl<Dst: Frame, Src: Frame> Transform<Dst, Src> {
    /// Declares that `rigid` maps `Src` to `Dst`: the one door from untyped motions.
    #[must_use]
    pub const fn from_rigid(rigid: Rigid) -> Self {
        Self { rigid, frames: PhantomData }
    }

    /// From a translation in mm and a rotation.
    #[must_use]
    pub fn from_parts(translation_mm: Vec3, rotation: UnitQuaternion<f64>) -> Self {
        Self::from_rigid(Rigid::from_parts(Translation3::from(translation_mm), rotation))
    }

    /// Both frames coincide.
    #[must_use]
    pub fn identity() -> Self {
        Self::from_rigid(Rigid::identity())
    }

    /// The motion without its frames, for solver loops.
    #[must_use]
    pub const fn rigid(&self) -> &Rigid {
        &self.rigid
    }

    /// Where the origin of `Src` lies in `Dst`, mm.
    #[must_use]
    pub fn translation_mm(&self) -> Vec3 {
        self.rigid.translation.vector
    }

    /// The rotation part.
    #[must_use]
    pub const fn rotation(&self) -> UnitQuaternion<f64> {
        self.rigid.rotation
    }

    /// Quaternion as (w, x, y, z) with `w ≥ 0`, the form in which files hold it.
    #[must_use]
    pub fn quaternion_wxyz(&self) -> [f64; 4] {
        let q = self.rigid.rotation.quaternion();
        let sign = if q.w < 0.0 { -1.0 } else { 1.0 };
        [q.w, q.i, q.j, q.k].map(|v| v * sign + 0.0)
    }

    /// The homogeneous 4 × 4 matrix.
    #[must_use]
    pub fn matrix(&self) -> Matrix4<f64> {
        self.rigid.to_homogeneous()
    }

    /// The transform from `Dst` to `Src`.
    #[must_use]
    pub fn inverse(&self) -> Transform<Src, Dst> {
        Transform::from_rigid(self.rigid.inverse())
    }

    /// Maps a point given in `Src` to `Dst`, mm.
    #[must_use]
    pub fn map_point(&self, point_in_src: Vec3) -> Vec3 {
        self.rigid.rotation * point_in_src + self.rigid.translation.vector
    }
}

impl<Dst: Frame, Mid: Frame, Src: Frame> Mul<Transform<Mid, Src>> for Transform<Dst, Mid> {
    type Output = Transform<Dst, Src>;

    fn mul(self, mid_from_src: Transform<Mid, Src>) -> Self::Output {
        Transform::from_rigid(self.rigid * mid_from_src.rigid)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Base, Flange};

    #[test]
    fn inverse_undoes_the_map() {
        let base_from_flange = Transform::<Base, Flange>::from_parts(
            Vec3::new(1.0, -2.0, 3.0),
            UnitQuaternion::from_euler_angles(0.3, -1.2, 2.9),
        );
        let point_in_flange = Vec3::new(10.0, 20.0, -30.0);
        let there_and_back = base_from_flange.inverse().map_point(base_from_flange.map_point(point_in_flange));
        assert!((there_and_back - point_in_flange).norm() < 1e-12);
    }

    #[test]
    fn quaternion_has_positive_w_and_no_negative_zero() {
        let half_turn = UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(-0.5, 0.5, -0.5, 0.5));
        let wxyz = Transform::<Base, Flange>::from_parts(Vec3::zeros(), half_turn).quaternion_wxyz();
        for (found, expected) in wxyz.into_iter().zip([0.5, -0.5, 0.5, -0.5]) {
            assert!((found - expected).abs() < 1e-15, "{wxyz:?}");
        }
        let identity = Transform::<Base, Flange>::identity().quaternion_wxyz();
        assert!(identity.iter().all(|v| v.is_sign_positive()));
    }
}
