//! A robot that looks at the two edges of a plate: problems with a known truth, for the tests and the bench of the plate's
//! methods; and the bound below which no unbiased method can err on them.

use std::f64::consts::{FRAC_PI_2, PI};

use handeye::calibrate::plate::points::{EdgePoint, NUM_UNKNOWNS, PlateState};
use handeye::calibrate::{
    BallProblem, Capture, Edge, Mount, Noise, PlateProblem, PlateStation, Reading, SideChoice, Station,
};
use handeye::geometry::so3::{exp, hat};
use handeye::geometry::{Flange, Mat3, Rigid, Sensor, Transform, Vec3};
use handeye::scene::random::Random;
use nalgebra::{Matrix2, UnitQuaternion};

/// Length of an edge, mm.
const EDGE_MM: f64 = 200.0;
/// From the sensor to what it sees, mm.
const RANGE_MM: f64 = 170.0;

/// What to simulate.
#[derive(Clone, Copy, Debug)]
pub struct Cell {
    /// Points on edge p and on edge q.
    pub num_points: [usize; 2],
    /// Tilt and turn of the sensor about each axis, uniform within ± this, degrees.
    pub spread_deg: f64,
    /// Angle between the laser line and an edge in the nominal view, degrees.
    pub line_to_edge_deg: f64,
    /// Noise of a point along x and z of the sensor, mm.
    pub point_std_mm: f64,
    /// Noise of each coordinate of a reported position, mm.
    pub position_std_mm: f64,
    /// Noise of a reported orientation about each axis, degrees.
    pub orientation_std_deg: f64,
    /// Whether the problem says so.
    pub is_stated: bool,
    /// How far off the operator's rough mounting is, degrees and mm; `None`: nothing is said.
    pub rough_off: Option<(f64, f64)>,
    pub mount: Mount,
}

impl Default for Cell {
    /// The paper's: nine points an edge, sensor ±0.03 mm.
    fn default() -> Self {
        Self {
            num_points: [9, 9],
            spread_deg: 20.0,
            line_to_edge_deg: 90.0,
            point_std_mm: 0.03,
            position_std_mm: 0.0,
            orientation_std_deg: 0.0,
            is_stated: false,
            rough_off: Some((10.0, 20.0)),
            mount: Mount::OnFlange,
        }
    }
}

/// A problem with its truth.
#[derive(Clone, Debug)]
pub struct Simulated {
    pub problem: PlateProblem,
    pub flange_from_sensor: Rigid,
    pub base_from_plate: Rigid,
}

/// Where the sensor is mounted in truth: it differs from seed to seed.
fn mounted(random: &mut Random) -> Rigid {
    let rotation = exp(Vec3::new(random.signed_unit(), random.signed_unit(), random.signed_unit()) * PI);
    Rigid::from_parts(
        Vec3::new(60.0 * random.signed_unit(), 60.0 * random.signed_unit(), 120.0 + 40.0 * random.signed_unit()).into(),
        rotation,
    )
}

/// The pose that puts `point_in_sensor` on `point_in_base`, looking down at about the nominal orientation.
fn view(
    cell: &Cell,
    yaw: f64,
    flange_from_sensor: &Rigid,
    point_in_base: Vec3,
    point_in_sensor: Vec3,
    random: &mut Random,
) -> Rigid {
    let spread = cell.spread_deg.to_radians();
    let tilt = Vec3::new(random.signed_unit(), random.signed_unit(), random.signed_unit()) * spread;
    // Looking down.
    let rotation = exp(tilt) * exp(Vec3::z() * yaw) * exp(Vec3::x() * PI);
    let base_from_sensor = Rigid::from_parts((point_in_base - rotation * point_in_sensor).into(), rotation);
    base_from_sensor * flange_from_sensor.inverse()
}

fn in_sensor(random: &mut Random) -> Vec3 {
    Vec3::new(20.0 * random.signed_unit(), 0.0, RANGE_MM + 15.0 * random.signed_unit())
}

/// What the robot reports and the sensor measures, each with its noise.
fn captured(cell: &Cell, pose: Rigid, point_in_sensor: Vec3, random: &mut Random) -> Capture {
    let turned = exp(random.normal3() * cell.orientation_std_deg.to_radians());
    let shifted = pose.translation.vector + random.normal3() * cell.position_std_mm;
    let reported = Rigid::from_parts(shifted.into(), pose.rotation * turned);
    let noise = random.normal3() * cell.point_std_mm;
    let posed = match cell.mount {
        Mount::OnFlange => reported,
        Mount::Fixed => reported.inverse(),
    };
    Capture {
        base_from_flange: Transform::from_rigid(posed),
        commanded_travel_mm: None,
        reading: Reading::Point(point_in_sensor + Vec3::new(noise.x, 0.0, noise.z)),
    }
}

fn rough(cell: &Cell, truth: &Rigid, random: &mut Random) -> Option<Transform<Flange, Sensor>> {
    let (angle_deg, distance_mm) = cell.rough_off?;
    let direction = |random: &mut Random| random.normal3().normalize();
    let turn: UnitQuaternion<f64> = exp(direction(random) * angle_deg.to_radians());
    let translation = truth.translation.vector + direction(random) * distance_mm;
    Some(Transform::from_parts(translation, truth.rotation * turn))
}

fn noise(cell: &Cell) -> Noise {
    Noise {
        position_std_mm: cell.is_stated.then_some(cell.position_std_mm),
        orientation_std_rad: cell.is_stated.then_some(cell.orientation_std_deg.to_radians()),
    }
}

/// A plate seen from many sides. The same seed gives the same problem.
#[must_use]
pub fn simulated(cell: &Cell, seed: u64) -> Simulated {
    simulated_with(cell, mounted(&mut Random::new(seed, 0)), seed)
}

/// The same by a sensor that is mounted as given.
#[must_use]
pub fn simulated_with(cell: &Cell, flange_from_sensor: Rigid, seed: u64) -> Simulated {
    let mut random = Random::new(seed, 1);
    let lying = exp(Vec3::new(0.1 * random.signed_unit(), 0.1 * random.signed_unit(), 0.0));
    let base_from_plate = Rigid::from_parts(Vec3::new(600.0, -150.0, 40.0).into(), lying);
    let mut stations = Vec::new();
    for (edge, num_points, along) in
        [(Edge::P, cell.num_points[0], Vec3::x()), (Edge::Q, cell.num_points[1], Vec3::y())]
    {
        let from_p = cell.line_to_edge_deg.to_radians();
        let yaw = if edge == Edge::P { from_p } else { FRAC_PI_2 - from_p };
        for idx in 0..num_points {
            let in_plate = along * (EDGE_MM * (0.05 + 0.9 * random.unit()));
            let in_base = base_from_plate.transform_point(&in_plate.into()).coords;
            let point_in_sensor = in_sensor(&mut random);
            // A fixed sensor sees a plate that the flange holds: as if the robot held the sensor, poses inverted.
            let pose = view(cell, yaw, &flange_from_sensor, in_base, point_in_sensor, &mut random);
            let pose = match cell.mount {
                Mount::OnFlange => pose,
                Mount::Fixed => pose.inverse(),
            };
            stations.push(PlateStation {
                edge,
                station: Station {
                    idx: stations.len(),
                    label: format!("{}{}", if edge == Edge::P { "p" } else { "q" }, idx + 1),
                    side: SideChoice::Auto,
                    captures: vec![captured(cell, pose, point_in_sensor, &mut random)],
                },
            });
        }
    }
    let rough_flange_from_sensor = rough(cell, &flange_from_sensor, &mut random);
    let problem = PlateProblem {
        mount: cell.mount,
        noise: noise(cell),
        profile_std_mm: cell.is_stated.then_some(cell.point_std_mm),
        reference_distance_mm: Some(RANGE_MM),
        rough_flange_from_sensor,
        stations,
    };
    Simulated { problem, flange_from_sensor, base_from_plate }
}

/// A tip seen from many sides, with the truth of the sensor.
#[must_use]
pub fn simulated_tip(cell: &Cell, seed: u64) -> (BallProblem, Rigid) {
    let flange_from_sensor = mounted(&mut Random::new(seed, 0));
    (simulated_tip_with(cell, flange_from_sensor, seed), flange_from_sensor)
}

/// The same by a sensor that is mounted as given.
#[must_use]
pub fn simulated_tip_with(cell: &Cell, flange_from_sensor: Rigid, seed: u64) -> BallProblem {
    let mut random = Random::new(seed, 2);
    let tip_in_base = Vec3::new(520.0, 80.0, 60.0);
    let stations = (0..cell.num_points[0])
        .map(|idx| {
            let point_in_sensor = in_sensor(&mut random);
            let pose = view(cell, 0.0, &flange_from_sensor, tip_in_base, point_in_sensor, &mut random);
            Station {
                idx,
                label: format!("{}", idx + 1),
                side: SideChoice::Auto,
                captures: vec![captured(cell, pose, point_in_sensor, &mut random)],
            }
        })
        .collect();
    BallProblem {
        radius_mm: 0.0,
        radius_std_mm: None,
        mount: cell.mount,
        noise: noise(cell),
        reference_distance_mm: Some(RANGE_MM),
        stations,
    }
}

/// The least covariance (mm²) of the sensor's place that an unbiased method can have on a problem (Cramér–Rao): from the
/// noise as it is simulated, at the truth.
///
/// # Panics
/// If the points leave something open.
#[must_use]
pub fn bound_mm2(cell: &Cell, simulated: &Simulated) -> Mat3 {
    let state =
        PlateState { flange_from_sensor: simulated.flange_from_sensor, base_from_plate: simulated.base_from_plate };
    let mut information = nalgebra::SMatrix::<f64, NUM_UNKNOWNS, NUM_UNKNOWNS>::zeros();
    for station in &simulated.problem.stations {
        let capture = &station.station.captures[0];
        let point = EdgePoint {
            station: 0,
            edge: station.edge,
            base_from_flange: *capture.base_from_flange.rigid(),
            point_in_sensor: capture.reading.point_in_sensor_mm().expect("a point"),
            information: Matrix2::identity(),
        };
        let lever = hat(point.in_base(&state.flange_from_sensor) - point.base_from_flange.translation.vector);
        let rotation = point.base_from_sensor(&state.flange_from_sensor);
        let in_plane = Mat3::from_diagonal(&Vec3::new(1.0, 0.0, 1.0)) * cell.point_std_mm.powi(2);
        let covariance = rotation * in_plane * rotation.transpose()
            + Mat3::identity() * cell.position_std_mm.powi(2)
            + lever * lever.transpose() * cell.orientation_std_deg.to_radians().powi(2);
        let across = state.across_in_base(point.edge);
        let weight = (across * covariance * across.transpose()).try_inverse().expect("some noise");
        let by_unknowns = state.by_unknowns(&point);
        information += by_unknowns.transpose() * weight * by_unknowns;
    }
    information.try_inverse().expect("nothing open").fixed_view::<3, 3>(3, 3).into_owned()
}

/// How far a calibration is from the truth: of the translation, mm, and of the rotation, degrees.
#[must_use]
pub fn error(found: &Transform<Flange, Sensor>, truth: &Rigid) -> (f64, f64) {
    (
        (found.translation_mm() - truth.translation.vector).norm(),
        found.rotation().angle_to(&truth.rotation).to_degrees(),
    )
}
