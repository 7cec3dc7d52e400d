//! Heads of laser profilers, of the sizes of the LJ-V7000 series, and what they see of a scene.

use crate::geometry::{Rigid, Vec3};
use crate::scene::Random;

use super::subject::{Eyes, Subject};

/// The part of single points that are lost for no reason.
const DROPOUT_PART: f64 = 0.004;

/// A head: how far and how wide it sees.
///
/// # Source
/// Reference distances, ranges and pitches as the maker states them; the widths near and far are approximate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Head {
    /// Its name on the command line.
    pub id: &'static str,
    /// From its front to the middle of its range, mm.
    pub reference_mm: f64,
    /// The range on the near side and on the far side of that, mm.
    pub range_mm: [f64; 2],
    /// Half of the line's width at the near end, the reference distance and the far end, mm.
    pub half_width_mm: [f64; 3],
    /// Distance of two points of a profile, mm.
    pub pitch_mm: f64,
    /// The least step of a height on the wire, in 0.01 µm.
    pub height_unit: u16,
    /// Angle at the reference distance between the laser's plane and the line of sight of the camera, degrees.
    pub triangulation_deg: f64,
}

impl Head {
    /// Points of a profile.
    pub const NUM_POINTS: u16 = 800;

    /// All that there are.
    pub const ALL: [Self; 4] = [
        Self {
            id: "lj-v7060",
            reference_mm: 60.0,
            range_mm: [8.0, 8.0],
            half_width_mm: [7.0, 7.5, 8.0],
            pitch_mm: 0.02,
            height_unit: 10,
            triangulation_deg: 36.0,
        },
        Self {
            id: "lj-v7080",
            reference_mm: 80.0,
            range_mm: [23.0, 23.0],
            half_width_mm: [12.5, 16.0, 19.5],
            pitch_mm: 0.05,
            height_unit: 20,
            triangulation_deg: 30.0,
        },
        Self {
            id: "lj-v7200",
            reference_mm: 200.0,
            range_mm: [48.0, 48.0],
            half_width_mm: [25.5, 31.0, 36.5],
            pitch_mm: 0.1,
            height_unit: 50,
            triangulation_deg: 22.0,
        },
        Self {
            id: "lj-v7300",
            reference_mm: 300.0,
            range_mm: [145.0, 155.0],
            half_width_mm: [55.0, 90.0, 120.0],
            pitch_mm: 0.3,
            height_unit: 100,
            triangulation_deg: 18.0,
        },
    ];

    /// The head of this name.
    #[must_use]
    pub fn by_id(id: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|head| head.id == id)
    }

    /// Position of a point across the line, mm.
    #[must_use]
    pub fn x_mm(&self, idx: u16) -> f64 {
        (f64::from(idx) - f64::from(Self::NUM_POINTS) / 2.0) * self.pitch_mm
    }

    /// Whether a point of the laser plane is within the measuring range.
    fn is_in_range(&self, x_mm: f64, z_mm: f64) -> bool {
        let [near, far] = self.range_mm;
        let [at_near, at_reference, at_far] = self.half_width_mm;
        let half_width_mm = if z_mm < 0.0 {
            at_reference + (at_near - at_reference) * (-z_mm / near)
        } else {
            at_reference + (at_far - at_reference) * (z_mm / far)
        };
        (-near..=far).contains(&z_mm) && x_mm.abs() <= half_width_mm
    }

    /// What it sees from where it stands: a height for each point of the grid.
    ///
    /// The laser fans out from a point at the head's front; the camera looks at its plane from the side of +y. A point is
    /// measured where both see it, and neither too flatly.
    ///
    /// # Frame and units
    /// x across the line, z away from the sensor, 0 at the reference distance; mm.
    #[must_use]
    pub fn see(&self, subject: &Subject, base_from_sensor: &Rigid, noise: &mut Random) -> Vec<Height> {
        let aside_mm = self.reference_mm * self.triangulation_deg.to_radians().tan();
        let laser = Vec3::new(0.0, 0.0, -self.reference_mm);
        let eyes = Eyes { laser, camera: laser + Vec3::y() * aside_mm };
        (0..Self::NUM_POINTS)
            .map(|idx| {
                // Drawn for every point, so that what one point hits does not shift the noise of the next.
                let error_mm = subject.profile_std_mm() * noise.normal();
                let is_lost = subject.loses_points() && noise.unit() < DROPOUT_PART;
                let x_mm = self.x_mm(idx);
                match subject.met_at(x_mm, base_from_sensor, &eyes) {
                    None => Height::NoPeak,
                    Some(met) if !self.is_in_range(x_mm, met.z_mm) => Height::DeadZone,
                    Some(met) if is_lost || !met.is_seen => Height::NoPeak,
                    Some(met) => Height::Measured { z_mm: met.z_mm + error_mm },
                }
            })
            .collect()
    }
}

impl Default for Head {
    /// One that sees a ball of 15 mm radius whole, and leaves room to turn about it.
    fn default() -> Self {
        Self::ALL[2]
    }
}

/// What a point of a profile says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Height {
    /// Where the surface is along the range axis, away from the sensor, mm.
    Measured {
        /// 0 at the reference distance.
        z_mm: f64,
    },
    /// The camera saw no line there.
    NoPeak,
    /// What is there lies outside the measuring range.
    DeadZone,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::{ArcOptions, extract_arc};
    use crate::geometry::Profile;
    use crate::scene::{Dirt, Part, PartKind, Scene};

    const RADIUS_MM: f64 = 15.0;

    /// The heights of a quiet head over a ball at this place in it.
    fn heights(head: &Head, ball_in_sensor: Vec3) -> Vec<Height> {
        let ball = Subject::Ball(Scene {
            ball_in_world: Vec3::new(ball_in_sensor.x, -ball_in_sensor.y, -ball_in_sensor.z),
            radius_mm: RADIUS_MM,
            num_points: usize::from(Head::NUM_POINTS),
            range_sign: 1.0,
            profile_std_mm: 0.0,
            dirt: Dirt::default(),
            decimals: None,
        });
        // The sensor at the world's origin, looking down.
        let down = Rigid::rotation(Vec3::x() * std::f64::consts::PI);
        head.see(&ball, &down, &mut Random::new(1, 0))
    }

    fn measured(head: &Head, heights: &[Height]) -> Vec<(f64, f64)> {
        let points = heights.iter().zip(0..).filter_map(|(height, idx)| match height {
            Height::Measured { z_mm } => Some((head.x_mm(idx), *z_mm)),
            _ => None,
        });
        points.collect()
    }

    #[test]
    fn the_arc_is_that_of_the_ball_exactly() {
        for head in &Head::ALL[1..3] {
            for offset_mm in [-8.0, -3.0, 0.0, 3.0, 8.0] {
                let (x_mm, z_mm): (Vec<f64>, Vec<f64>) =
                    measured(head, &heights(head, Vec3::new(0.7, offset_mm, 13.0))).into_iter().unzip();
                let z_mm: Vec<Option<f64>> = z_mm.into_iter().map(Some).collect();
                let profile = Profile::new(x_mm, &z_mm).expect("finite");
                let options = ArcOptions { ball_radius_mm: RADIUS_MM, profile_std_mm: None };
                let arc = extract_arc(&profile, &options)
                    .unwrap_or_else(|error| panic!("{}, {offset_mm} mm: {error}", head.id));
                let section_mm = (RADIUS_MM * RADIUS_MM - offset_mm * offset_mm).sqrt();
                // No noise: the fit is exact to rounding.
                assert!((arc.circle.radius_mm - section_mm).abs() < 1e-6, "{} {offset_mm}", head.id);
            }
        }
    }

    #[test]
    fn the_camera_sees_less_of_the_side_that_is_turned_away_from_it() {
        let head = Head::default();
        let num_of_ball = |offset_mm: f64| {
            let seen = measured(&head, &heights(&head, Vec3::new(0.0, offset_mm, 13.0)));
            seen.iter().filter(|(_, z_mm)| *z_mm < 13.0).count()
        };
        // The ball's middle on the side of the camera turns the section away from it.
        assert!(num_of_ball(9.0) < num_of_ball(-9.0));
        assert_eq!(num_of_ball(RADIUS_MM + 0.1), 0);
    }

    #[test]
    fn beside_the_ball_lies_its_shadow_and_then_the_table() {
        let head = Head::default();
        let seen = heights(&head, Vec3::new(4.0, 0.0, 13.0));
        let table: Vec<f64> =
            measured(&head, &seen).into_iter().filter(|(_, z_mm)| *z_mm > 13.0).map(|(x_mm, _)| x_mm).collect();
        let nearest_right = table.iter().copied().filter(|x_mm| *x_mm > 4.0).fold(f64::INFINITY, f64::min);
        let nearest_left = table.iter().copied().filter(|x_mm| *x_mm < 4.0).fold(f64::NEG_INFINITY, f64::max);
        // The fan comes from x = 0, so the shadow is longer on the far side.
        assert!(nearest_right - 4.0 > RADIUS_MM && nearest_right - 4.0 > 4.0 - nearest_left);
        assert!(seen.first() == Some(&Height::DeadZone) && seen.last() == Some(&Height::DeadZone));
    }

    #[test]
    fn what_is_too_near_or_too_far_is_not_measured() {
        let head = Head::default();
        for z_mm in [-120.0, 80.0] {
            assert!(measured(&head, &heights(&head, Vec3::new(0.0, 0.0, z_mm))).is_empty(), "{z_mm}");
        }
    }

    /// What a quiet head measures of a part whose origin is there in it, looking straight down.
    fn of_part(kind: PartKind, turn: f64, origin_in_sensor: Vec3) -> Vec<(f64, f64)> {
        let head = Head::default();
        let down = Rigid::rotation(Vec3::x() * std::f64::consts::PI);
        let origin = down * nalgebra::Point3::from(origin_in_sensor);
        let place = Rigid::from_parts(origin.coords.into(), crate::geometry::so3::exp(Vec3::z() * turn));
        let subject = Subject::Part { part: Part::new(kind, place), profile_std_mm: 0.0, loses_points: false };
        measured(&head, &head.see(&subject, &down, &mut Random::new(1, 0)))
    }

    #[test]
    fn a_plate_ends_where_it_is_and_hides_the_table_from_the_fan() {
        // Its edge q across the line at x = 5 mm, the plate towards +x.
        let seen = of_part(PartKind::Plate, 0.0, Vec3::new(5.0, 40.0, 0.0));
        let of_plate: Vec<f64> = seen.iter().filter(|(_, z_mm)| z_mm.abs() < 1e-9).map(|(x_mm, _)| *x_mm).collect();
        let of_table: Vec<f64> =
            seen.iter().filter(|(_, z_mm)| (z_mm - 10.0).abs() < 1e-9).map(|(x_mm, _)| *x_mm).collect();
        assert_eq!(of_plate.len() + of_table.len(), seen.len());
        let first = of_plate.iter().copied().fold(f64::INFINITY, f64::min);
        assert!((5.0..5.0 + Head::default().pitch_mm).contains(&first), "{first}");
        let last = of_table.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        // The laser comes from x = 0, so it lights the table up to the plate.
        assert!(last < 5.0 && last > 4.0, "{last}");
    }

    #[test]
    fn a_pin_a_block_and_teeth_show_their_tops() {
        for kind in [PartKind::Pin, PartKind::Square, PartKind::Teeth, PartKind::Cylinder] {
            let seen = of_part(kind, 0.0, Vec3::zeros());
            let (_, top_mm) = seen.iter().copied().min_by(|a, b| a.1.total_cmp(&b.1)).expect("points");
            assert!(top_mm.abs() < 0.1 && seen.len() > 100, "{kind:?}: {top_mm}, {} points", seen.len());
        }
    }
}
