//! The ball's centre in the base from its sections, where the calibration is given.

use crate::calibrate::{Reading, Station};
use crate::geometry::{Flange, Mat3, Rigid, Sensor, Transform, Vec3};

/// A section's radius tells little of the centre where it is near the ball's: there a station's own centre is drawn towards
/// that of all, with this part of the weight of a measured coordinate a capture.
const BLIND_WEIGHT: f64 = 1e-3;
/// Sections below this part of the radius are none that a profile would show.
const LEAST_SECTION_PART: f64 = 0.1;
/// The sections are smooth in the centre; a handful of steps end at the resolution of `f64`.
const MOST_STEPS: usize = 50;
/// A step this small changes no digit that anyone reads, mm.
const SETTLED_MM: f64 = 1e-10;

/// What one capture says, with the sensor's place in the base.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sighting {
    sensor_from_base: Rigid,
    seen: Seen,
}

#[derive(Clone, Copy, Debug)]
enum Seen {
    /// Centre (x, z) and radius of the section, mm.
    Section { x_mm: f64, z_mm: f64, radius_mm: f64 },
    /// The centre itself, in the sensor frame, mm.
    Centre(Vec3),
}

/// The sightings of a station.
pub(super) fn sightings(station: &Station, flange_from_sensor: &Transform<Flange, Sensor>) -> Vec<Sighting> {
    let seen = station.captures.iter().filter_map(|capture| {
        let seen = match &capture.reading {
            Reading::Arc(arc) => {
                Seen::Section { x_mm: arc.circle.x_mm, z_mm: arc.circle.z_mm, radius_mm: arc.circle.radius_mm }
            }
            other => Seen::Centre(other.point_in_sensor_mm()?),
        };
        let base_from_sensor = capture.base_from_flange * *flange_from_sensor;
        Some(Sighting { sensor_from_base: base_from_sensor.rigid().inverse(), seen })
    });
    seen.collect()
}

impl Sighting {
    /// Expected minus measured (x, z, section radius; or x, y, z), mm, and its change with the centre in the sensor frame.
    fn residual(&self, centre_in_sensor: Vec3, ball_radius_mm: f64) -> (Vec3, Mat3) {
        match self.seen {
            Seen::Centre(measured) => (centre_in_sensor - measured, Mat3::identity()),
            Seen::Section { x_mm, z_mm, radius_mm } => {
                let least = LEAST_SECTION_PART * ball_radius_mm;
                let y = centre_in_sensor.y;
                let expected = (ball_radius_mm * ball_radius_mm - y * y).max(least * least).sqrt();
                let residual = Vec3::new(centre_in_sensor.x - x_mm, centre_in_sensor.z - z_mm, expected - radius_mm);
                (residual, Mat3::new(1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, -y / expected, 0.0))
            }
        }
    }

    /// Where the section alone puts the centre in the base, on either side of the laser plane.
    fn centres(&self, ball_radius_mm: f64) -> Vec<Vec3> {
        let in_sensor = match self.seen {
            Seen::Centre(measured) => vec![measured],
            Seen::Section { x_mm, z_mm, radius_mm } => {
                let off_plane = (ball_radius_mm * ball_radius_mm - radius_mm * radius_mm).max(0.0).sqrt();
                vec![Vec3::new(x_mm, off_plane, z_mm), Vec3::new(x_mm, -off_plane, z_mm)]
            }
        };
        let base_from_sensor = self.sensor_from_base.inverse();
        in_sensor.into_iter().map(|centre| (base_from_sensor * nalgebra::Point3::from(centre)).coords).collect()
    }
}

/// The centre that fits all sightings best; `None` without any. Both sides of the first section are tried.
pub(super) fn common_centre(sightings: &[Sighting], ball_radius_mm: f64) -> Option<Vec3> {
    let starts = sightings.first()?.centres(ball_radius_mm);
    let found = starts.into_iter().map(|start| settle(sightings, ball_radius_mm, start, None));
    found.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(centre, _)| centre)
}

/// The centre that fits a station's sightings best, near that of all stations.
pub(super) fn station_centre(sightings: &[Sighting], ball_radius_mm: f64, common: Vec3) -> Vec3 {
    settle(sightings, ball_radius_mm, common, Some(common)).0
}

/// Damped Gauss–Newton from a start; answers the centre and its cost. `towards` draws where the sightings are blind.
fn settle(sightings: &[Sighting], ball_radius_mm: f64, start: Vec3, towards: Option<Vec3>) -> (Vec3, f64) {
    #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^52 captures")]
    let pull = towards.map(|centre| (centre, BLIND_WEIGHT * sightings.len() as f64));
    let sums = |centre: Vec3| {
        let (mut cost, mut gradient, mut information) = (0.0, Vec3::zeros(), Mat3::zeros());
        for sighting in sightings {
            let in_sensor = (sighting.sensor_from_base * nalgebra::Point3::from(centre)).coords;
            let (residual, by_sensor) = sighting.residual(in_sensor, ball_radius_mm);
            let by_base = by_sensor * sighting.sensor_from_base.rotation.to_rotation_matrix().matrix();
            cost += residual.norm_squared();
            gradient += by_base.transpose() * residual;
            information += by_base.transpose() * by_base;
        }
        if let Some((towards, weight)) = pull {
            let off = centre - towards;
            cost += weight * off.norm_squared();
            gradient += off * weight;
            information += Mat3::identity() * weight;
        }
        (cost, gradient, information)
    };
    let mut centre = start;
    let (mut cost, mut gradient, mut information) = sums(centre);
    let mut damping = 1e-6;
    for _ in 0..MOST_STEPS {
        let damped = information + Mat3::identity() * (damping * (information.trace() + f64::MIN_POSITIVE));
        let Some(inverse) = damped.try_inverse() else { break };
        let step = -(inverse * gradient);
        let tried = centre + step;
        let sums_there = sums(tried);
        if sums_there.0 <= cost {
            centre = tried;
            (cost, gradient, information) = sums_there;
            damping *= 0.1;
        } else {
            damping *= 10.0;
        }
        if step.norm() < SETTLED_MM || !cost.is_finite() {
            break;
        }
    }
    (centre, cost)
}
