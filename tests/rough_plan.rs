//! Stations of a cell whose mounting is only guessed: whether the ball stays in view, and what the stations are worth.

use handeye::calibrate::{Mount, Noise};
use handeye::geometry::{Rigid, Transform, Vec3, so3};
use handeye::plan::{Limits, MeasuredStation, PlanRefusal, RoughCell, View, next_rough, refined};
use handeye::scene::Random;

const NUM_STATIONS: usize = 8;
const VIEW: View = View { half_width_mm: 10.0, half_range_mm: 10.0, middle_range_mm: 80.0 };
const RADIUS_MM: f64 = 12.0;
/// Further beside the ball's middle than this part of its radius a profile has no arc to search from.
const SEEN_RADII: f64 = 0.95;

/// A cell with its truth.
struct Cell {
    rough: RoughCell,
    flange_from_sensor: Rigid,
    ball_in_base: Vec3,
    noise: Random,
}

impl Cell {
    /// The guess is off by up to 10° and 20 mm, in any direction.
    fn new(seed: u64, mount: Mount) -> Self {
        let mut random = Random::new(seed, 0);
        let mut within = |most: f64| random.normal3().normalize() * (most * random.unit());
        let off = Rigid::new(within(20.0), within(10.0_f64.to_radians()));
        let flange_from_sensor = Rigid::new(Vec3::new(12.0, -3.0, 118.0) + within(60.0), within(3.0));
        Self {
            rough: RoughCell {
                mount,
                flange_from_sensor: flange_from_sensor * off,
                // Nobody measures where the ball is before the first station.
                ball_in_base_mm: Vec3::zeros(),
                radius_mm: RADIUS_MM,
                noise: Noise::default(),
                looks_along_in_base: -Vec3::z(),
            },
            flange_from_sensor,
            ball_in_base: Vec3::new(450.0, -120.0, 90.0),
            noise: Random::new(seed, 1),
        }
    }

    fn carrier(&self, pose: &Rigid) -> Rigid {
        if self.rough.mount == Mount::Fixed { pose.inverse() } else { *pose }
    }

    /// Where the operator jogs the robot: the ball roughly in the middle of the view.
    fn first_pose(&mut self) -> Rigid {
        let down = so3::exp(Vec3::x() * std::f64::consts::PI);
        let rotation = so3::exp(self.noise.normal3() * 0.1) * down;
        let ball_in_sensor = Vec3::new(
            3.0 * self.noise.signed_unit(),
            0.5 * RADIUS_MM * self.noise.signed_unit(),
            VIEW.middle_range_mm + 3.0 * self.noise.signed_unit(),
        );
        let base_from_sensor = Rigid::from_parts((self.ball_in_base - rotation * ball_in_sensor).into(), rotation);
        self.carrier(&(base_from_sensor * self.flange_from_sensor.inverse()))
    }

    fn true_ball_in_sensor(&self, pose: &Rigid) -> Vec3 {
        let base_from_sensor = self.carrier(pose) * self.flange_from_sensor;
        base_from_sensor.inverse_transform_point(&self.ball_in_base.into()).coords
    }

    /// The station of a search that begins at a pose; `None` if it does not see the ball.
    fn measure(&mut self, pose: &Rigid) -> Option<MeasuredStation> {
        let ball = self.true_ball_in_sensor(pose);
        let is_seen = ball.x.abs() <= VIEW.half_width_mm
            && (ball.z - VIEW.middle_range_mm).abs() <= VIEW.half_range_mm
            && ball.y.abs() <= SEEN_RADII * RADIUS_MM;
        if !is_seen {
            return None;
        }
        let to_peak = Rigid::translation(0.0, ball.y, 0.0);
        let at_peak = self.carrier(pose) * self.flange_from_sensor * to_peak * self.flange_from_sensor.inverse();
        let noise = self.noise.normal3() * 0.02;
        Some(MeasuredStation::at_peak(
            Transform::from_rigid(self.carrier(&at_peak)),
            [ball.x + noise.x, ball.z + noise.z],
            0.02,
        ))
    }

    /// How far the mounting is off: of the sensor's origin, mm, and degrees.
    fn error(&self, cell: &RoughCell) -> [f64; 2] {
        let off = self.flange_from_sensor.inverse() * cell.flange_from_sensor;
        [off.translation.vector.norm(), off.rotation.angle().to_degrees()]
    }
}

/// The widest angle between the orientations of two stations, degrees.
fn widest_turn_deg(stations: &[MeasuredStation]) -> f64 {
    let rotations: Vec<_> = stations.iter().map(|station| station.base_from_flange.rotation()).collect();
    rotations.iter().flat_map(|a| rotations.iter().map(|b| a.angle_to(b).to_degrees())).fold(0.0, f64::max)
}

#[test]
fn eight_stations_keep_the_ball_in_view_and_spread_over_the_limits() {
    let limits = Limits { max_spin_deg: 60.0, ..Limits::default() };
    for (mount, num_cells) in [(Mount::OnFlange, 200), (Mount::Fixed, 20)] {
        let (mut num_lost, mut num_planned) = (0, 0);
        for seed in 0..num_cells {
            let mut cell = Cell::new(seed, mount);
            let first = cell.first_pose();
            let mut stations = vec![cell.measure(&first).expect("the operator sees it")];
            let mut avoided = Vec::new();
            for _ in 1..NUM_STATIONS {
                let (planned, _) = next_rough(&cell.rough, &stations, &avoided, &VIEW, &limits).expect("a station");
                num_planned += 1;
                if let Some(station) = cell.measure(planned.base_from_flange.rigid()) {
                    stations.push(station);
                } else {
                    num_lost += 1;
                    avoided.push(planned.base_from_flange);
                }
            }
            // Twice the tilt alone is 60°; with little more than 25° a calibration is poor.
            let turn_deg = widest_turn_deg(&stations);
            assert!(turn_deg > 50.0, "{mount:?} {seed}: {turn_deg}°");
            // Eight stations of 0.02 mm (weighed as 0.05 mm): what the guess was does not matter any more.
            let [off_mm, off_deg] = cell.error(&refined(&cell.rough, &stations));
            assert!(off_mm < 0.5 && off_deg < 0.5, "{mount:?} {seed}: {off_mm} mm, {off_deg}°");
        }
        println!("{mount:?}: the ball was out of view at {num_lost} of {num_planned} planned stations");
        // Two σ along three axes would be one in ten if all were on the edge.
        assert!(100 * num_lost < num_planned, "{mount:?}: {num_lost} of {num_planned}");
    }
}

#[test]
fn an_avoided_pose_is_turned_away_from() {
    let mut cell = Cell::new(3, Mount::OnFlange);
    let first = cell.first_pose();
    let station = cell.measure(&first).expect("seen");
    let next = |avoided: &[Transform<_, _>]| {
        let (planned, _) = next_rough(&cell.rough, &[station], avoided, &VIEW, &Limits::default()).expect("a station");
        planned.base_from_flange
    };
    let planned = next(&[]);
    let other = next(&[planned]);
    assert!(planned.rotation().angle_to(&other.rotation()).to_degrees() > 7.9);
}

#[test]
fn one_station_says_where_the_ball_is_and_leaves_the_mounting() {
    for mount in [Mount::OnFlange, Mount::Fixed] {
        let mut cell = Cell::new(1, mount);
        let first = cell.first_pose();
        let station = cell.measure(&first).expect("seen");
        let now = refined(&cell.rough, &[station]);
        let off = cell.rough.flange_from_sensor.inverse() * now.flange_from_sensor;
        assert!(off.translation.vector.norm() < 1e-6 && off.rotation.angle() < 1e-8, "{off}");
        let pose = cell.carrier(station.base_from_flange.rigid());
        let ball = pose * now.flange_from_sensor * nalgebra::Point3::from(station.ball_in_sensor_mm);
        assert!((ball.coords - now.ball_in_base_mm).norm() < 1e-6);
        assert_eq!(refined(&cell.rough, &[]), cell.rough);
    }
}

#[test]
fn views_and_cells_that_are_none_are_refused() {
    let mut cell = Cell::new(2, Mount::OnFlange);
    let first = cell.first_pose();
    let station = cell.measure(&first).expect("seen");
    let limits = Limits::default();
    for view in [
        View { half_width_mm: 0.0, ..VIEW },
        View { half_range_mm: f64::NAN, ..VIEW },
        View { middle_range_mm: f64::INFINITY, ..VIEW },
    ] {
        let refusal = next_rough(&cell.rough, &[station], &[], &view, &limits).expect_err("no view");
        assert_eq!(refusal, PlanRefusal::NothingWithinLimits);
    }
    let rough = RoughCell { radius_mm: f64::NAN, ..cell.rough };
    let refusal = next_rough(&rough, &[station], &[], &VIEW, &limits).expect_err("no ball");
    assert_eq!(refusal, PlanRefusal::Undetermined);
}
