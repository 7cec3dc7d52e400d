//! A robot with a camera that sees a board: problems with a known truth, for the tests and the bench of the hand-eye
//! calibration from motions; and the bound below which no unbiased method can err on them.

use handeye::calibrate::motion::pose::{Information, MotionState, PosePair, sums_of};
use handeye::calibrate::{Capture, MotionProblem, Mount, Noise, Reading, SideChoice, Station, TargetNoise};
use handeye::geometry::so3::{exp, hat};
use handeye::geometry::{Mat3, Rigid, Transform, Vec3};
use handeye::scene::random::Random;
use nalgebra::{Matrix6, UnitQuaternion};

/// What to simulate.
#[derive(Clone, Copy, Debug)]
pub struct Cell {
    pub num_poses: usize,
    /// Turn about each axis, uniform within ± this, degrees.
    pub spread_deg: f64,
    /// Noise of each coordinate of a reported position, mm.
    pub position_std_mm: f64,
    /// Noise of a reported orientation about each axis, degrees.
    pub orientation_std_deg: f64,
    /// Noise of each coordinate of the target's origin, mm.
    pub target_std_mm: f64,
    /// Noise of the target's orientation about each axis, degrees.
    pub target_std_deg: f64,
    /// Whether the problem says so.
    pub is_stated: bool,
    pub mount: Mount,
}

impl Default for Cell {
    /// A small robot and a board of a hand's size, half a metre away.
    fn default() -> Self {
        Self {
            num_poses: 30,
            spread_deg: 35.0,
            position_std_mm: 0.05,
            orientation_std_deg: 0.02,
            target_std_mm: 0.2,
            target_std_deg: 0.1,
            is_stated: true,
            mount: Mount::OnFlange,
        }
    }
}

/// A problem with its truth.
#[derive(Clone, Debug)]
pub struct Simulated {
    pub problem: MotionProblem,
    pub truth: MotionState,
    /// Root of the bound on the variance of (rotation in rad, translation in mm).
    pub bound: Matrix6<f64>,
}

fn signed(random: &mut Random) -> Vec3 {
    Vec3::new(random.signed_unit(), random.signed_unit(), random.signed_unit())
}

/// The truth that a mounting has.
pub fn truth(random: &mut Random) -> MotionState {
    let turn = |random: &mut Random, rad: f64| signed(random) * rad;
    MotionState {
        flange_from_sensor: Rigid::from_parts(Vec3::new(45.0, -30.0, 80.0).into(), exp(turn(random, 3.0))),
        base_from_target: Rigid::from_parts(Vec3::new(520.0, -80.0, 30.0).into(), exp(turn(random, 3.0))),
    }
}

impl Cell {
    pub fn simulate(&self, seed: u64) -> Simulated {
        let mut random = Random::new(seed, 7);
        let truth = truth(&mut random);
        // The camera looks at the board from half a metre, turned to all sides.
        let looks = (0..self.num_poses)
            .map(|_| {
                let spread = self.spread_deg.to_radians();
                let turn = signed(&mut random) * spread;
                let place = Vec3::new(
                    30.0 * random.signed_unit(),
                    30.0 * random.signed_unit(),
                    500.0 + 50.0 * random.signed_unit(),
                );
                Rigid::from_parts(place.into(), exp(turn) * exp(Vec3::x() * std::f64::consts::PI))
            })
            .collect::<Vec<_>>();
        self.simulate_looks(&truth, &looks, &mut random)
    }

    /// With given poses of the target in the sensor frame.
    pub fn simulate_looks(&self, truth: &MotionState, looks: &[Rigid], random: &mut Random) -> Simulated {
        let normal = |random: &mut Random, std: f64| random.normal3() * std;
        let (turn_std, target_turn_std) = (self.orientation_std_deg.to_radians(), self.target_std_deg.to_radians());
        let mut exact = Vec::new();
        let stations = looks
            .iter()
            .enumerate()
            .map(|(idx, look)| {
                let base_from_flange = truth.base_from_target * look.inverse() * truth.flange_from_sensor.inverse();
                exact.push(PosePair {
                    station: idx,
                    base_from_flange,
                    sensor_from_target: *look,
                    information: self.information(truth, &base_from_flange, look),
                });
                let noisy = |true_pose: Rigid, random: &mut Random| {
                    Rigid::from_parts(
                        (true_pose.translation.vector + normal(random, self.position_std_mm)).into(),
                        true_pose.rotation * exp(normal(random, turn_std)),
                    )
                };
                // The robot reports base_from_flange; for a fixed sensor the problem is posed with its inverse.
                let reported = match self.mount {
                    Mount::OnFlange => noisy(base_from_flange, random),
                    Mount::Fixed => noisy(base_from_flange.inverse(), random).inverse(),
                };
                let seen = Rigid::from_parts(
                    (look.translation.vector + normal(random, self.target_std_mm)).into(),
                    look.rotation * exp(normal(random, target_turn_std)),
                );
                Station {
                    idx,
                    label: (idx + 1).to_string(),
                    side: SideChoice::Auto,
                    captures: vec![Capture {
                        base_from_flange: Transform::from_rigid(reported),
                        commanded_travel_mm: None,
                        reading: Reading::Pose(Transform::from_rigid(seen)),
                    }],
                }
            })
            .collect();
        let problem = MotionProblem {
            mount: self.mount,
            noise: Noise {
                position_std_mm: self.is_stated.then_some(self.position_std_mm),
                orientation_std_rad: self.is_stated.then_some(turn_std),
            },
            target_noise: TargetNoise {
                translation_std_mm: self.is_stated.then_some(self.target_std_mm),
                rotation_std_rad: self.is_stated.then_some(target_turn_std),
            },
            reference_distance_mm: Some(500.0),
            stations,
        };
        let hessian = sums_of(&exact, truth, |_| 1.0).hessian;
        let bound = hessian.try_inverse().map_or_else(Matrix6::zeros, |all| all.fixed_view::<6, 6>(0, 0).into_owned());
        Simulated { problem, truth: *truth, bound }
    }

    fn information(&self, truth: &MotionState, base_from_flange: &Rigid, look: &Rigid) -> Information {
        let (turn, target_turn) =
            (self.orientation_std_deg.to_radians().powi(2), self.target_std_deg.to_radians().powi(2));
        let shift = self.position_std_mm.powi(2) + self.target_std_mm.powi(2);
        let sensor_from_flange: UnitQuaternion<f64> = truth.flange_from_sensor.rotation.inverse();
        let target_in_flange = (truth.flange_from_sensor * look).translation.vector;
        let lever = hat(match self.mount {
            Mount::OnFlange => sensor_from_flange * target_in_flange,
            Mount::Fixed => {
                let base_from_sensor = base_from_flange.rotation * truth.flange_from_sensor.rotation;
                base_from_sensor.inverse() * truth.base_from_target.translation.vector
            }
        });
        let mut covariance = Matrix6::zeros();
        covariance.fixed_view_mut::<3, 3>(0, 0).copy_from(&(Mat3::identity() * (turn + target_turn)));
        covariance.fixed_view_mut::<3, 3>(0, 3).copy_from(&(lever * turn));
        covariance.fixed_view_mut::<3, 3>(3, 0).copy_from(&(-lever * turn));
        covariance.fixed_view_mut::<3, 3>(3, 3).copy_from(&(Mat3::identity() * shift - lever * lever * turn));
        Information::of_covariance(&covariance).unwrap_or_else(|| Information::by_lever(1.0))
    }
}
