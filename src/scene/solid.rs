//! Convex solids and where a ray enters them: what parts are made of.

use nalgebra::Point3;

use crate::geometry::{Rigid, Vec3};

/// A ray; points of it are `origin + distance · direction`.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    /// Where it begins, mm.
    pub origin: Vec3,
    /// Where it goes, of unit length.
    pub direction: Vec3,
}

impl Ray {
    /// The same ray in another frame.
    #[must_use]
    pub fn seen_from(&self, src_from_dst: &Rigid) -> Self {
        Self {
            origin: src_from_dst.inverse_transform_point(&Point3::from(self.origin)).coords,
            direction: src_from_dst.rotation.inverse() * self.direction,
        }
    }

    fn at(&self, distance: f64) -> Vec3 {
        self.origin + self.direction * distance
    }
}

/// Where a ray enters a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// How far along the ray, mm; it may lie behind its origin.
    pub distance_mm: f64,
    /// The surface's normal, outwards, of unit length.
    pub normal: Vec3,
}

/// Nearer than this to its apex a cone has no flank, mm.
const APEX_MM: f64 = 1e-6;

/// A convex set of points; solids are made of several that overlap.
#[derive(Clone, Copy, Debug)]
pub enum Bound {
    /// What lies behind a plane: `normal · point ≤ offset`.
    HalfSpace {
        /// Outwards, of unit length.
        normal: Vec3,
        /// mm.
        offset_mm: f64,
    },
    /// An endless cylinder.
    Cylinder {
        /// A point of its axis, mm.
        middle: Vec3,
        /// Of unit length.
        axis: Vec3,
        /// mm.
        radius_mm: f64,
    },
    /// A cone that stands with its apex up in the origin.
    Cone {
        /// The tangent of the angle between its axis and its flank.
        slope: f64,
    },
}

impl Bound {
    /// Between which distances a ray is inside, and the normal where it enters.
    fn inside(&self, ray: &Ray) -> Option<(Hit, f64)> {
        match *self {
            Self::HalfSpace { normal, offset_mm } => {
                let height_mm = normal.dot(&ray.origin) - offset_mm;
                let climb = normal.dot(&ray.direction);
                let distance_mm = -height_mm / climb;
                if climb < 0.0 {
                    Some((Hit { distance_mm, normal }, f64::INFINITY))
                } else if climb > 0.0 {
                    Some((Hit { distance_mm: f64::NEG_INFINITY, normal }, distance_mm))
                } else {
                    (height_mm <= 0.0).then_some((Hit { distance_mm: f64::NEG_INFINITY, normal }, f64::INFINITY))
                }
            }
            Self::Cylinder { middle, axis, radius_mm } => {
                let across = |vector: Vec3| vector - axis * axis.dot(&vector);
                let (from, way) = (across(ray.origin - middle), across(ray.direction));
                let (enter, leave) =
                    roots(way.norm_squared(), from.dot(&way), from.norm_squared() - radius_mm * radius_mm)?;
                Some((Hit { distance_mm: enter, normal: (from + way * enter) / radius_mm }, leave))
            }
            Self::Cone { slope } => {
                // x² + y² = slope² z², of which the lower half is the cone.
                let squash = Vec3::new(1.0, 1.0, -slope * slope);
                let form = |a: Vec3, b: Vec3| a.component_mul(&squash).dot(&b);
                let (from, way) = (ray.origin, ray.direction);
                let (first, second) = roots(form(way, way), form(from, way), form(from, from))?;
                let entered = |distance_mm: f64| {
                    let outwards = ray.at(distance_mm).component_mul(&squash).try_normalize(APEX_MM);
                    Hit { distance_mm, normal: outwards.unwrap_or_else(Vec3::z) }
                };
                if form(way, way) > 0.0 {
                    // Flatter than the flank a ray meets one half only.
                    (ray.at(first).z <= 0.0).then(|| (entered(first), second))
                } else if way.z < 0.0 {
                    // Steeper it meets both: the upper half first, then the lower, which it never leaves.
                    Some((entered(second), f64::INFINITY))
                } else {
                    Some((Hit { distance_mm: f64::NEG_INFINITY, normal: -way }, first))
                }
            }
        }
    }
}

/// Where `a t² + 2 b t + c` is zero, the least first.
fn roots(a: f64, b: f64, c: f64) -> Option<(f64, f64)> {
    let square = b * b - a * c;
    // A ray through a cone's apex has one root twice, which rounding may hide.
    let root = if square < 0.0 && a < 0.0 { 0.0 } else { square.sqrt() };
    let (one, other) = ((-b - root) / a, (-b + root) / a);
    // NaN where there is no root.
    (one.is_finite() && other.is_finite()).then(|| (one.min(other), one.max(other)))
}

/// What several bounds have in common.
#[derive(Clone, Debug)]
pub struct Solid(pub Vec<Bound>);

impl Solid {
    /// A box between two corners.
    #[must_use]
    pub fn between(least: Vec3, greatest: Vec3) -> Self {
        let planes = [Vec3::x(), Vec3::y(), Vec3::z()].into_iter().flat_map(|axis| {
            let upper = Bound::HalfSpace { normal: axis, offset_mm: axis.dot(&greatest) };
            [upper, Bound::HalfSpace { normal: -axis, offset_mm: -axis.dot(&least) }]
        });
        Self(planes.collect())
    }

    /// What is common to this and other bounds.
    #[must_use]
    pub fn cut_by(mut self, bounds: impl IntoIterator<Item = Bound>) -> Self {
        self.0.extend(bounds);
        self
    }

    /// Where a ray enters it.
    #[must_use]
    pub fn entry(&self, ray: &Ray) -> Option<Hit> {
        let mut enter = Hit { distance_mm: f64::NEG_INFINITY, normal: -ray.direction };
        let mut leave = f64::INFINITY;
        for bound in &self.0 {
            let (hit, end) = bound.inside(ray)?;
            if hit.distance_mm > enter.distance_mm {
                enter = hit;
            }
            leave = leave.min(end);
        }
        (enter.distance_mm < leave).then_some(enter)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DOWN: Vec3 = Vec3::new(0.0, 0.0, -1.0);

    #[track_caller]
    fn check(solid: &Solid, x: f64, y: f64, expected: Option<(f64, Vec3)>) {
        let hit = solid.entry(&Ray { origin: Vec3::new(x, y, 50.0), direction: DOWN });
        match (hit, expected) {
            (Some(hit), Some((z, normal))) => {
                assert!((50.0 - hit.distance_mm - z).abs() < 1e-9, "{hit:?}, expected {z}");
                assert!((hit.normal - normal).norm() < 1e-9, "{hit:?}, expected {normal}");
            }
            (hit, expected) => assert!(hit.is_none() && expected.is_none(), "{hit:?}, expected {expected:?}"),
        }
    }

    #[test]
    fn a_box_is_met_at_its_top() {
        let solid = Solid::between(Vec3::new(0.0, 0.0, -5.0), Vec3::new(10.0, 20.0, 0.0));
        check(&solid, 3.0, 4.0, Some((0.0, Vec3::z())));
        check(&solid, -0.1, 4.0, None);
        check(&solid, 3.0, 20.1, None);
    }

    #[test]
    fn a_cylinder_and_a_cone_are_met_where_they_are() {
        let lying = Solid(vec![Bound::Cylinder { middle: Vec3::zeros(), axis: Vec3::y(), radius_mm: 5.0 }]);
        check(&lying, 3.0, 100.0, Some((4.0, Vec3::new(0.6, 0.0, 0.8))));
        check(&lying, 5.1, 0.0, None);
        let standing = Solid(vec![Bound::Cone { slope: 0.75 }, Bound::HalfSpace { normal: DOWN, offset_mm: 8.0 }]);
        check(&standing, 0.0, 0.0, Some((0.0, Vec3::z())));
        check(&standing, 3.0, 0.0, Some((-4.0, Vec3::new(0.8, 0.0, 0.6))));
        check(&standing, 6.1, 0.0, None);
        let aslant = Ray { origin: Vec3::new(30.0, 0.0, -4.0), direction: -Vec3::x() };
        let hit = standing.entry(&aslant).expect("met");
        assert!((hit.distance_mm - 27.0).abs() < 1e-9 && (hit.normal - Vec3::new(0.8, 0.0, 0.6)).norm() < 1e-9);
    }
}
