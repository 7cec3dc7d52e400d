//! A simulated ball before a sensor on a robot, with everything that may be wrong with it, and a search through it.

use handeye::device::search::{
    DirectionFrame, Search, SearchNext, SearchPhase, SearchReport, SearchSettings, StepSeen, StopRule,
};
use handeye::fit::{ArcOptions, extract_arc};
use handeye::geometry::{Profile, Rigid, Vec3, so3};
use handeye::scene::{Dirt, Random, Scene};

/// What happens to a cell while it is searched.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fault {
    /// Nobody put a ball there.
    NoBall,
    /// The ball is pushed along the travel before this capture, by so many radii.
    BallMoved { before_capture: usize, radii: f64 },
    /// The robot stands still from this capture on.
    RobotStuck { from_capture: usize },
    /// The ball's radius is stated wrong by this part.
    WrongRadius { part: f64 },
}

/// A ball before a sensor on a robot, and where the search begins.
#[derive(Clone, Debug)]
pub struct Cell {
    pub scene: Scene,
    pub stated_radius_mm: f64,
    /// Half of what the sensor sees across the line.
    pub half_width_mm: f64,
    base_from_first_flange: Rigid,
    flange_from_sensor: Rigid,
    pub position_std_mm: f64,
    pub orientation_std_deg: f64,
    pub dropout_part: f64,
    pub fault: Option<Fault>,
    noise: Random,
    dirt: Random,
}

/// A search that is over.
pub struct Searched {
    pub report: SearchReport,
    /// Where the peak is on the travel from the first reported pose, mm.
    pub true_peak_mm: f64,
}

impl Cell {
    /// Searches, and checks on the way what must hold of every search.
    pub fn search(&mut self, settings: &SearchSettings) -> Searched {
        let mut search = Search::new(settings, self.stated_radius_mm);
        let mut first_reported: Option<Rigid> = None;
        let mut stands_at_mm = 0.0;
        while let SearchNext::CaptureAt { commanded_mm } = search.next() {
            let capture_idx = search.report().points.len();
            assert!(capture_idx < usize::from(settings.max_captures), "too many captures");
            assert!(commanded_mm.abs() <= settings.max_travel_mm, "sent to {commanded_mm} mm: {settings:?}");
            match self.fault {
                Some(Fault::RobotStuck { from_capture }) if capture_idx >= from_capture => {}
                _ => stands_at_mm = commanded_mm,
            }
            let base_from_flange = self.shaken(&settings.pose_at(&self.base_from_first_flange, stands_at_mm));
            let reported = self.base_from_reported(&settings.pose_at(&self.base_from_first_flange, stands_at_mm));
            let first = *first_reported.get_or_insert(reported);
            search.take(StepSeen {
                travelled_mm: settings.travelled_mm(&first, &reported),
                radius_and_std_mm: self.seen_from(&base_from_flange, capture_idx, settings),
            });
        }
        assert_eq!(search.report().phase, SearchPhase::Ended);
        let first_reported = first_reported.expect("at least one capture");
        Searched { report: search.report().clone(), true_peak_mm: self.true_peak_mm(settings, &first_reported) }
    }

    /// Where the ball's middle crosses the laser plane.
    fn true_peak_mm(&self, settings: &SearchSettings, first_reported: &Rigid) -> f64 {
        let ball_y_mm = |travel_mm: f64| {
            let base_from_sensor = settings.pose_at(&self.base_from_first_flange, travel_mm) * self.flange_from_sensor;
            base_from_sensor.inverse_transform_point(&self.scene.ball_in_world.into()).y
        };
        let by_step = ball_y_mm(1.0) - ball_y_mm(0.0);
        let from_true_first_mm = -ball_y_mm(0.0) / by_step;
        from_true_first_mm - settings.travelled_mm(&self.base_from_first_flange, first_reported)
    }

    /// The pose that the robot takes when it is told to take one, and ...
    fn shaken(&mut self, base_from_flange: &Rigid) -> Rigid {
        let turn = so3::exp(self.noise.normal3() * self.orientation_std_deg.to_radians());
        Rigid::from_parts(base_from_flange.translation, base_from_flange.rotation * turn)
    }

    /// ... the one that it reports.
    fn base_from_reported(&mut self, base_from_flange: &Rigid) -> Rigid {
        let shift = self.noise.normal3() * self.position_std_mm;
        Rigid::from_parts((base_from_flange.translation.vector + shift).into(), base_from_flange.rotation)
    }

    fn seen_from(
        &mut self,
        base_from_flange: &Rigid,
        capture_idx: usize,
        settings: &SearchSettings,
    ) -> Result<[f64; 2], String> {
        if self.dirt.unit() < self.dropout_part {
            return Err("nothing but background".to_owned());
        }
        let mut scene = self.scene.clone();
        match self.fault {
            Some(Fault::NoBall) => return Err("nothing but background".to_owned()),
            Some(Fault::BallMoved { before_capture, radii }) if capture_idx >= before_capture => {
                let travel = settings.pose_at(&self.base_from_first_flange, 1.0).translation.vector
                    - self.base_from_first_flange.translation.vector;
                scene = scene.with_ball_shifted_by(travel * (radii * scene.radius_mm));
            }
            _ => {}
        }
        let profile = scene.profile(&(base_from_flange * self.flange_from_sensor), &mut self.noise, &mut self.dirt);
        let z_mm = profile.x_mm().iter().zip(profile.z_mm());
        let z_mm: Vec<_> = z_mm.map(|(x, z)| (x.abs() <= self.half_width_mm && !z.is_nan()).then_some(*z)).collect();
        let profile = Profile::new(profile.x_mm().to_vec(), &z_mm).expect("part of a profile");
        let options = ArcOptions { ball_radius_mm: self.stated_radius_mm, profile_std_mm: None };
        let arc = extract_arc(&profile, &options).map_err(|refusal| refusal.to_string())?;
        Ok([arc.circle.radius_mm, arc.std_mm()[2]])
    }
}

/// A cell of a usual kind: the search begins `start_mm` before the peak, the travel is off the laser's normal.
pub fn cell(seed: u64, radius_mm: f64, start_mm: f64, off_normal_deg: f64, settings: &SearchSettings) -> Cell {
    let mut random = Random::new(seed, 1);
    // The sensor looks down; the flange anyhow.
    let down = so3::exp(Vec3::x() * std::f64::consts::PI);
    let base_from_sensor_rotation = so3::exp(random.normal3() * 0.15) * down;
    // Along the travel in the sensor: its normal, but off to some side.
    let side = std::f64::consts::TAU * random.unit();
    let (sin, cos) = off_normal_deg.to_radians().sin_cos();
    let travel_in_sensor = Vec3::new(sin * side.cos(), cos, sin * side.sin());
    let direction = Vec3::from(settings.direction).normalize();
    let towards = |from: Vec3, to: Vec3| nalgebra::UnitQuaternion::rotation_between(&from, &to).expect("not opposite");
    let flange_from_sensor_rotation = match settings.frame {
        DirectionFrame::Tool => so3::exp(direction * random.normal()) * towards(travel_in_sensor, direction),
        DirectionFrame::Base => so3::exp(random.normal3()),
    };
    let base_from_sensor_rotation = match settings.frame {
        DirectionFrame::Tool => base_from_sensor_rotation,
        DirectionFrame::Base => so3::exp(direction * random.normal()) * towards(travel_in_sensor, direction),
    };
    let flange_from_sensor = Rigid::from_parts(Vec3::new(12.0, -3.0, 118.0).into(), flange_from_sensor_rotation);
    let ball_in_sensor = Vec3::new(0.2 * radius_mm * random.signed_unit(), start_mm * cos, 80.0 + radius_mm);
    let ball_in_world = Vec3::new(450.0, -120.0, 90.0);
    let base_from_sensor = Rigid::from_parts(
        (ball_in_world - base_from_sensor_rotation * ball_in_sensor).into(),
        base_from_sensor_rotation,
    );
    Cell {
        scene: Scene {
            ball_in_world,
            radius_mm,
            num_points: 400,
            range_sign: 1.0,
            profile_std_mm: 0.01,
            dirt: Dirt::default(),
            decimals: None,
        },
        stated_radius_mm: radius_mm,
        half_width_mm: f64::INFINITY,
        base_from_first_flange: base_from_sensor * flange_from_sensor.inverse(),
        flange_from_sensor,
        position_std_mm: 0.02,
        orientation_std_deg: 0.0,
        dropout_part: 0.0,
        fault: None,
        noise: Random::new(seed, 2),
        dirt: Random::new(seed, 3),
    }
}

/// One of 500.
pub fn random_station(seed: u64) -> (Cell, SearchSettings) {
    let mut random = Random::new(seed, 0);
    let mut between = |least: f64, most: f64| least + (most - least) * random.unit();
    let radius_mm = between(5.0, 40.0);
    let step_mm = radius_mm * between(0.02, 0.1);
    let stop = if between(0.0, 1.0) < 0.3 {
        StopRule::Published
    } else {
        StopRule::PeakKnown { peak_std_mm: between(0.01, 0.1) }
    };
    let frame = if between(0.0, 1.0) < 0.5 { DirectionFrame::Tool } else { DirectionFrame::Base };
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "8 to 80")]
    let max_captures = between(8.0, 80.0) as u16;
    let settings = SearchSettings {
        frame,
        direction: [between(-0.3, 0.3), between(0.5, 2.0), between(-0.3, 0.3)],
        step_mm,
        coarse_step_mm: step_mm * between(0.5, 4.0),
        max_travel_mm: radius_mm * between(0.3, 3.0),
        max_captures,
        travel_std_mm: 0.02,
        stop,
    };
    let start_mm = radius_mm * between(-1.2, 1.2);
    let mut cell = cell(seed, radius_mm, start_mm, between(0.0, 20.0), &settings);
    cell.scene.profile_std_mm = between(0.0, 0.05);
    cell.half_width_mm = radius_mm * between(0.6, 1.5);
    cell.position_std_mm = between(0.0, 0.03);
    cell.orientation_std_deg = between(0.0, 0.005);
    cell.dropout_part = (between(-0.1, 0.1)).max(0.0);
    if between(0.0, 1.0) < 0.3 {
        cell.scene.dirt = Dirt::all();
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "1 to 12")]
    let capture_idx = between(1.0, 12.0) as usize;
    let amount = between(-1.0, 1.0);
    cell.fault = match between(0.0, 1.0) {
        dice if dice < 0.7 => None,
        dice if dice < 0.75 => Some(Fault::NoBall),
        dice if dice < 0.85 => Some(Fault::BallMoved { before_capture: capture_idx, radii: 0.5 * amount }),
        dice if dice < 0.93 => Some(Fault::RobotStuck { from_capture: capture_idx }),
        _ => Some(Fault::WrongRadius { part: 0.1 * amount }),
    };
    if let Some(Fault::WrongRadius { part }) = cell.fault {
        cell.stated_radius_mm = radius_mm * (1.0 + part);
    }
    (cell, settings)
}
