//! The parts that a laser line is drawn across, each on its table: plate, pin, and the workpieces of the verification.

use nalgebra::Point3;

use crate::geometry::{Rigid, Vec3};

use super::MAX_INCIDENCE_DEG;
use super::solid::{Bound, Hit, Ray, Solid};

/// Length of the plate's edges, mm.
pub const PLATE_EDGE_MM: f64 = 200.0;
/// Thickness of the plate: the height of the jump to the table, mm.
pub const PLATE_THICKNESS_MM: f64 = 10.0;
/// From tooth to tooth of the toothed part, mm.
pub const PITCH_MM: f64 = 15.0;
/// Height of the teeth, mm.
pub const TOOTH_HEIGHT_MM: f64 = 10.0;
/// Diameter of the cylinder, mm.
pub const CYLINDER_DIAMETER_MM: f64 = 40.0;
/// Radius of the pin, and how far it stands out of the table, mm.
const PIN_MM: [f64; 2] = [2.0, 25.0];
/// The tangent of the angle between the pin's axis and the flank of its tip, of 40°: blunt enough that both sides are seen
/// from a sensor that tilts by 20°.
const TIP_SLOPE: f64 = 0.839_099_631_177_28;
/// Width of the square block's faces, and its length along the edge, mm.
const BLOCK_MM: [f64; 2] = [30.0, 60.0];
/// Width of the teeth across, and of a tooth's top and flank along the row, mm.
const TOOTH_MM: [f64; 3] = [30.0, 4.0, 4.0];
const NUM_TEETH: u8 = 5;
/// Length of the cylinder, mm.
const CYLINDER_LENGTH_MM: f64 = 60.0;

/// What a part is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PartKind {
    /// A right-angle plate: origin in its corner, x along edge p, y along edge q, z up; it lies on the table.
    Plate,
    /// A pin that ends in a point: origin in the point, z up.
    Pin,
    /// A square block on one of its edges, so that the faces beside the opposite edge are both seen: origin in the middle
    /// of that edge, y along it, z up.
    Square,
    /// A row of teeth along y: origin in the middle of the row on the height of the teeth's tops, z up.
    Teeth,
    /// A cylinder that lies along y: origin in the middle of its uppermost line, z up.
    Cylinder,
}

impl PartKind {
    /// How far it reaches along its y from its origin, both ways, mm.
    #[must_use]
    pub fn half_length_mm(self) -> f64 {
        match self {
            Self::Plate => PLATE_EDGE_MM,
            Self::Pin => PIN_MM[0],
            Self::Square => BLOCK_MM[1] / 2.0,
            Self::Teeth => f64::from(NUM_TEETH) * PITCH_MM / 2.0,
            Self::Cylinder => CYLINDER_LENGTH_MM / 2.0,
        }
    }

    /// The height of the table, in the part's frame, mm.
    fn table_z_mm(self) -> f64 {
        match self {
            Self::Plate => -PLATE_THICKNESS_MM,
            Self::Pin => -PIN_MM[1],
            // On its edge it stands as high as its diagonal.
            Self::Square => -BLOCK_MM[0] * std::f64::consts::SQRT_2,
            Self::Teeth => -2.0 * TOOTH_HEIGHT_MM,
            Self::Cylinder => -CYLINDER_DIAMETER_MM,
        }
    }

    fn solids(self) -> Vec<Solid> {
        let table_z_mm = self.table_z_mm();
        let table = Solid(vec![Bound::HalfSpace { normal: Vec3::z(), offset_mm: table_z_mm }]);
        let half_length_mm = self.half_length_mm();
        let ends = [Vec3::y(), -Vec3::y()].map(|normal| Bound::HalfSpace { normal, offset_mm: half_length_mm });
        let body = match self {
            Self::Plate => {
                vec![Solid::between(Vec3::z() * table_z_mm, Vec3::new(PLATE_EDGE_MM, PLATE_EDGE_MM, 0.0))]
            }
            Self::Pin => {
                let shaft = Bound::Cylinder { middle: Vec3::zeros(), axis: Vec3::z(), radius_mm: PIN_MM[0] };
                vec![Solid(vec![Bound::Cone { slope: TIP_SLOPE }, shaft])]
            }
            Self::Square => {
                let aslant = |x: f64, z: f64| Vec3::new(x, 0.0, z).normalize();
                let planes = [(1.0, 1.0, 0.0), (-1.0, 1.0, 0.0), (1.0, -1.0, BLOCK_MM[0]), (-1.0, -1.0, BLOCK_MM[0])];
                let faces = planes.map(|(x, z, offset_mm)| Bound::HalfSpace { normal: aslant(x, z), offset_mm });
                vec![Solid(faces.to_vec()).cut_by(ends)]
            }
            Self::Teeth => {
                let [width_mm, top_mm, flank_mm] = TOOTH_MM;
                let half_width = Vec3::x() * (width_mm / 2.0);
                let ground = Vec3::z() * TOOTH_HEIGHT_MM;
                let base = Solid::between(
                    -half_width - Vec3::y() * half_length_mm + Vec3::z() * table_z_mm,
                    half_width + Vec3::y() * half_length_mm - ground,
                );
                let tooth = |idx: u8| {
                    let middle_mm = (f64::from(idx) + 0.5) * PITCH_MM - half_length_mm;
                    let flanks = [1.0, -1.0].map(|side: f64| {
                        let normal = Vec3::new(0.0, side * TOOTH_HEIGHT_MM, flank_mm).normalize();
                        let at_top = Vec3::y() * (middle_mm + side * top_mm / 2.0);
                        Bound::HalfSpace { normal, offset_mm: normal.dot(&at_top) }
                    });
                    let along = Vec3::y() * half_length_mm;
                    Solid::between(-half_width - along - ground, half_width + along).cut_by(flanks)
                };
                std::iter::once(base).chain((0..NUM_TEETH).map(tooth)).collect()
            }
            Self::Cylinder => {
                let radius_mm = CYLINDER_DIAMETER_MM / 2.0;
                let round = Bound::Cylinder { middle: Vec3::z() * -radius_mm, axis: Vec3::y(), radius_mm };
                vec![Solid(vec![round]).cut_by(ends)]
            }
        };
        body.into_iter().chain([table]).collect()
    }
}

/// A part at its place in the world.
#[derive(Clone, Debug)]
pub struct Part {
    /// What it is.
    pub kind: PartKind,
    /// Where it stands.
    pub world_from_part: Rigid,
    solids: Vec<Solid>,
}

impl Part {
    /// A part at a place.
    #[must_use]
    pub fn new(kind: PartKind, world_from_part: Rigid) -> Self {
        Self { kind, world_from_part, solids: kind.solids() }
    }

    /// The same part pushed to another place.
    #[must_use]
    pub fn shifted_by(&self, shift_mm: Vec3) -> Self {
        let mut moved = self.clone();
        moved.world_from_part.translation.vector += shift_mm;
        moved
    }

    /// What a line along the range axis meets first; the normal is in the sensor.
    ///
    /// # Frame and units
    /// x across the line in the sensor; the hit's distance is z in it, mm. With `range_sign` −1 z grows towards the sensor.
    #[must_use]
    pub fn surface_at(&self, x_mm: f64, range_sign: f64, world_from_sensor: &Rigid) -> Option<Hit> {
        let part_from_sensor = self.world_from_part.inverse() * world_from_sensor;
        let ray = Ray {
            origin: (part_from_sensor * Point3::new(x_mm, 0.0, 0.0)).coords,
            direction: part_from_sensor.rotation * Vec3::z() * range_sign,
        };
        let entries = self.solids.iter().filter_map(|solid| solid.entry(&ray));
        let first =
            entries.filter(|hit| hit.distance_mm.is_finite()).min_by(|a, b| a.distance_mm.total_cmp(&b.distance_mm))?;
        let normal = part_from_sensor.rotation.inverse() * first.normal;
        Some(Hit { distance_mm: range_sign * first.distance_mm, normal })
    }

    /// Whether the part stands between a point of its surface and an eye, both in the sensor.
    #[must_use]
    pub fn hides(&self, point: Vec3, eye: Vec3, world_from_sensor: &Rigid) -> bool {
        /// So that a surface does not hide itself.
        const CLEAR_MM: f64 = 1e-6;
        let way = eye - point;
        let length_mm = way.norm();
        let in_sensor = Ray { origin: point, direction: way / length_mm };
        let ray = in_sensor.seen_from(&(world_from_sensor.inverse() * self.world_from_part));
        self.solids
            .iter()
            .filter_map(|solid| solid.entry(&ray))
            .any(|hit| (CLEAR_MM..length_mm).contains(&hit.distance_mm))
    }

    /// What parallel rays along the range axis measure of it: nothing where it is met too flatly.
    #[must_use]
    pub fn seen_z_mm(&self, x_mm: f64, range_sign: f64, world_from_sensor: &Rigid) -> Option<f64> {
        let hit = self.surface_at(x_mm, range_sign, world_from_sensor)?;
        let incidence_deg = hit.normal.angle(&(-Vec3::z() * range_sign)).to_degrees();
        (incidence_deg <= MAX_INCIDENCE_DEG).then_some(hit.distance_mm)
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    /// The heights in the part's frame that a sensor over a place of it, looking straight down, sees.
    fn heights(kind: PartKind, x_mm: f64, y_mm: f64, across_mm: &[f64]) -> Vec<Option<f64>> {
        let part = Part::new(kind, Rigid::translation(1.0, 2.0, 3.0));
        let down = Rigid::rotation(Vec3::x() * PI);
        let world_from_sensor = Rigid::translation(1.0 + x_mm, 2.0 + y_mm, 83.0) * down;
        across_mm.iter().map(|x| part.seen_z_mm(*x, 1.0, &world_from_sensor).map(|z_mm| 80.0 - z_mm)).collect()
    }

    #[track_caller]
    fn check(kind: PartKind, [x_mm, y_mm]: [f64; 2], across_mm: &[f64], expected: &[Option<f64>]) {
        let found = heights(kind, x_mm, y_mm, across_mm);
        for (found, expected) in found.iter().zip(expected) {
            let is_same = match (found, expected) {
                (Some(found), Some(expected)) => (found - expected).abs() < 1e-9,
                (found, expected) => found.is_none() && expected.is_none(),
            };
            assert!(is_same, "{kind:?}: {found:?}, expected {expected:?}");
        }
    }

    #[test]
    fn parts_have_their_sizes() {
        check(
            PartKind::Plate,
            [0.0, 50.0],
            &[-1.0, 1.0, 199.0, 201.0],
            &[Some(-10.0), Some(0.0), Some(0.0), Some(-10.0)],
        );
        check(PartKind::Pin, [0.0, 0.0], &[0.0, 1.0, 3.0], &[Some(0.0), Some(-1.0 / TIP_SLOPE), Some(-25.0)]);
        check(PartKind::Square, [0.0, 10.0], &[-4.0, 0.0, 4.0], &[Some(-4.0), Some(0.0), Some(-4.0)]);
        check(PartKind::Cylinder, [0.0, 10.0], &[0.0, 12.0, 19.9], &[Some(0.0), Some(-4.0), None]);
        for (y_mm, height_mm) in [(0.0, 0.0), (15.0, 0.0), (-30.0, 0.0), (7.5, -10.0), (4.0, -5.0)] {
            check(PartKind::Teeth, [0.0, y_mm], &[0.0], &[Some(height_mm)]);
        }
    }

    #[test]
    fn a_plate_hides_the_table_beside_it_from_an_eye_on_its_other_side() {
        let part = Part::new(PartKind::Plate, Rigid::identity());
        let beside = Vec3::new(50.0, -1.0, -PLATE_THICKNESS_MM);
        assert!(part.hides(beside, Vec3::new(50.0, 100.0, 50.0), &Rigid::identity()));
        assert!(!part.hides(beside, Vec3::new(50.0, -100.0, 50.0), &Rigid::identity()));
    }
}
