//! The cell of Chen et al. 2023, simulated: a plate of 200 mm, nine points an edge, the sensor some 170 mm away, and a tip.
//! Shared by the tests and by the evidence table (`cargo bench --bench evidence`).

use handeye::calibrate::{
    BallProblem, Capture, Edge, Mount, Noise, PlateProblem, PlateStation, Problem, Reading, SideChoice, Station,
};
use handeye::geometry::{Base, Flange, Mat3, Rigid, Sensor, Transform, Vec3, so3};
use handeye::scene::Random;

/// Length of the plate's edges, mm.
const EDGE_MM: f64 = 200.0;
/// Distance of the sensor, mm, as in their Table 1.
const DISTANCE_MM: f64 = 172.0;

/// Noise of the cell, as standard deviations.
#[derive(Clone, Copy)]
pub struct PaperCell {
    pub seed: u64,
    /// Of each reported coordinate, mm.
    pub position_std_mm: f64,
    /// Of a reported orientation about each axis, degrees.
    pub orientation_std_deg: f64,
    /// Of a measured point along x and z, mm.
    pub sensor_std_mm: f64,
    /// The sensor is tilted by up to so much from looking straight at the plate, degrees.
    pub tilt_deg: f64,
    /// And turned by up to so much about its range axis, either way, degrees.
    pub spin_deg: f64,
}

impl PaperCell {
    pub const EXACT: Self = Self {
        seed: 1,
        position_std_mm: 0.0,
        orientation_std_deg: 0.0,
        sensor_std_mm: 0.0,
        tilt_deg: 25.0,
        spin_deg: 55.0,
    };

    /// Robot ±0.02 mm, sensor ±0.03 mm, both taken as standard deviations of every coordinate.
    pub fn noisy(seed: u64) -> Self {
        Self { seed, position_std_mm: 0.02, orientation_std_deg: 0.005, sensor_std_mm: 0.03, ..Self::EXACT }
    }

    /// The rotation nearest to their printed matrix with its misprint mended, and its translation.
    pub fn flange_from_sensor() -> Transform<Flange, Sensor> {
        let printed = Mat3::new(0.998, -0.021, -0.056, 0.001, 0.944, -0.331, 0.006, 0.331, 0.942);
        let rotation = so3::nearest_rotation(&printed).expect("nearly a rotation");
        Transform::from_parts(Vec3::new(-7.806, 123.890, -79.412), rotation)
    }

    /// The plate: origin in its corner, x along edge p, y along edge q, z towards the sensor.
    pub fn base_from_plate() -> Rigid {
        Rigid::from_parts(Vec3::new(620.0, -80.0, 150.0).into(), so3::exp(Vec3::new(0.02, -0.03, 0.35)))
    }

    /// The tip's place, mm.
    pub fn tip_in_base_mm() -> Vec3 {
        Vec3::new(650.0, 40.0, 210.0)
    }

    fn noise(&self) -> Noise {
        Noise {
            position_std_mm: Some(self.position_std_mm).filter(|std| *std > 0.0),
            orientation_std_rad: Some(self.orientation_std_deg.to_radians()).filter(|std| *std > 0.0),
        }
    }

    /// Points on both edges, the laser line across the edge.
    pub fn plate(&self, points_an_edge: usize) -> PlateProblem {
        let mut random = Random::new(self.seed, 101);
        let base_from_plate = Self::base_from_plate();
        let mut stations = Vec::new();
        for (edge, along, across) in [(Edge::P, Vec3::x(), Vec3::y()), (Edge::Q, Vec3::y(), Vec3::x())] {
            for number in 0..points_an_edge {
                let part = (number as f64 + 0.5) / points_an_edge as f64;
                let in_plate = along * (EDGE_MM * (0.06 + 0.88 * part));
                let point_in_base = (base_from_plate * nalgebra::Point3::from(in_plate)).coords;
                let look = base_from_plate.rotation * looking_down(across);
                stations.push(PlateStation {
                    edge,
                    station: self.station(stations.len(), look, point_in_base, &mut random),
                });
            }
        }
        PlateProblem {
            mount: Mount::OnFlange,
            noise: self.noise(),
            profile_std_mm: Some(self.sensor_std_mm).filter(|std| *std > 0.0),
            reference_distance_mm: Some(DISTANCE_MM),
            rough_flange_from_sensor: Some(rough(&Self::flange_from_sensor())),
            stations,
        }
    }

    /// A tip measured from many sides.
    pub fn tip(&self, num_stations: usize) -> BallProblem {
        let mut random = Random::new(self.seed, 202);
        let look = looking_down(Vec3::y());
        let stations =
            (0..num_stations).map(|idx| self.station(idx, look, Self::tip_in_base_mm(), &mut random)).collect();
        BallProblem {
            radius_mm: 0.0,
            radius_std_mm: None,
            mount: Mount::OnFlange,
            noise: self.noise(),
            reference_distance_mm: Some(DISTANCE_MM),
            stations,
        }
    }

    pub fn plate_target(&self) -> Problem {
        Problem::Plate(self.plate(9))
    }

    pub fn tip_target(&self, num_stations: usize) -> Problem {
        Problem::Point(self.tip(num_stations))
    }

    /// The sensor somewhere around `look`, with the point in its laser plane.
    fn station(
        &self,
        idx: usize,
        look: nalgebra::UnitQuaternion<f64>,
        point_in_base: Vec3,
        random: &mut Random,
    ) -> Station {
        let direction = std::f64::consts::PI * random.signed_unit();
        let tilt = self.tilt_deg.to_radians() * random.unit().sqrt();
        let spin = self.spin_deg.to_radians() * random.signed_unit();
        let tilted = so3::exp(Vec3::new(direction.cos(), direction.sin(), 0.0) * tilt);
        let rotation = look * tilted * so3::exp(Vec3::z() * spin);
        let true_point = Vec3::new(8.0 * random.signed_unit(), 0.0, DISTANCE_MM + 3.0 * random.signed_unit());
        let base_from_sensor = Transform::<Base, Sensor>::from_parts(point_in_base - rotation * true_point, rotation);
        let true_pose = base_from_sensor * Self::flange_from_sensor().inverse();
        let base_from_flange = Transform::from_parts(
            true_pose.translation_mm() + random.normal3() * self.position_std_mm,
            true_pose.rotation() * so3::exp(random.normal3() * self.orientation_std_deg.to_radians()),
        );
        let noise = random.normal3() * self.sensor_std_mm;
        let measured = true_point + Vec3::new(noise.x, 0.0, noise.z);
        Station {
            idx,
            label: (idx + 1).to_string(),
            side: SideChoice::Auto,
            captures: vec![Capture { base_from_flange, commanded_travel_mm: None, reading: Reading::Point(measured) }],
        }
    }
}

/// A sensor that looks along −z of its surroundings, with the laser line along `across`.
fn looking_down(across: Vec3) -> nalgebra::UnitQuaternion<f64> {
    let z = -Vec3::z();
    so3::nearest_rotation(&Mat3::from_columns(&[across, z.cross(&across), z])).expect("a rotation")
}

/// What an operator would enter: 6° and 12 mm off.
fn rough(flange_from_sensor: &Transform<Flange, Sensor>) -> Transform<Flange, Sensor> {
    Transform::from_parts(
        flange_from_sensor.translation_mm() + Vec3::new(8.0, -6.0, 7.0),
        flange_from_sensor.rotation() * so3::exp(Vec3::new(0.06, -0.05, 0.07)),
    )
}
