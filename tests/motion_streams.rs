//! The hand-eye calibration from two streams of poses: whether clocks are matched without bias, whether the stated σ are those
//! of the errors, and what stretches of a tracked motion tell.
#![expect(clippy::expect_used, reason = "a test that cannot solve its problem must fail")]

use handeye::calibrate::motion::{CameraPose, StreamProblem, TrackReduced, Weighing, solve_streams};
use handeye::calibrate::validation::{bootstrap, validate};
use handeye::calibrate::{MotionData, Mount, Noise, Solution, SolveError};
use handeye::geometry::so3::exp;
use handeye::geometry::stats::{median, rms};
use handeye::geometry::{Rigid, Transform, Vec3, se3};
use handeye::scene::random::Random;
use handeye::watch::Unwatched;
use nalgebra::{Matrix6, Vector6};

/// What the flange's poses are off by.
#[derive(Clone, Copy, Debug, PartialEq)]
enum FlangeNoise {
    None,
    /// Of every sample by itself.
    White,
    /// That of neighbours is nearly the same; it changes within a tenth of a second.
    Correlated,
}

/// A robot that moves smoothly, and its camera with a clock of its own.
#[derive(Clone, Copy, Debug)]
struct Streams {
    weighing: Weighing,
    mount: Mount,
    camera_hz: f64,
    flange_hz: f64,
    flange_noise: FlangeNoise,
    /// Noise of a step of the camera, or of a pose: rad and mm.
    camera_std: [f64; 2],
    /// Whether the camera says so.
    is_stated: bool,
    seconds: f64,
    lag_s: f64,
}

/// A robot's noise: 0.02° and 0.05 mm.
const ROBOT_STD: [f64; 2] = [3.5e-4, 0.05];

impl Default for Streams {
    fn default() -> Self {
        Self {
            weighing: Weighing::Drifting,
            mount: Mount::OnFlange,
            camera_hz: 10.0,
            flange_hz: 60.0,
            flange_noise: FlangeNoise::White,
            camera_std: [1.5e-4, 0.08],
            is_stated: true,
            seconds: 12.0,
            lag_s: 0.1,
        }
    }
}

fn noise(std: [f64; 2], random: &mut Random) -> Vector6<f64> {
    se3::join(random.normal3() * std[0], random.normal3() * std[1])
}

impl Streams {
    fn simulate(&self, seed: u64) -> (StreamProblem, Rigid) {
        let mut random = Random::new(seed, 3);
        let [sensor, base_from_world] = [Vec3::new(45.0, -30.0, 80.0), Vec3::new(520.0, -80.0, 30.0)]
            .map(|place| Rigid::from_parts(place.into(), exp(random.normal3())));
        let phases: [f64; 7] = std::array::from_fn(|_| 6.3 * random.unit());
        let path = |time_s: f64| {
            let turn = Vec3::new(
                0.5 * (0.9 * time_s + phases[0]).sin(),
                0.45 * (0.7 * time_s + phases[1]).sin() + 0.1 * (2.3 * time_s + phases[2]).cos(),
                0.6 * (0.5 * time_s + phases[3]).sin(),
            );
            let place = Vec3::new(
                500.0 + 80.0 * (0.6 * time_s + phases[4]).sin(),
                60.0 * (0.8 * time_s + phases[5]).cos(),
                400.0 + 40.0 * (time_s + phases[6]).sin(),
            );
            Rigid::from_parts(place.into(), exp(turn) * exp(Vec3::x() * 3.0))
        };
        let kept = if self.flange_noise == FlangeNoise::Correlated { (-10.0 / self.flange_hz).exp() } else { 0.0 };
        let robot_std = if self.flange_noise == FlangeNoise::None { [0.0; 2] } else { ROBOT_STD };
        let mut off = noise(robot_std, &mut random);
        let first_s = random.unit() / self.flange_hz;
        let flange = (0..100_000)
            .map(|idx| first_s + f64::from(idx) / self.flange_hz)
            .take_while(|time_s| *time_s < self.seconds + 2.0)
            .map(|time_s| {
                off = off * kept + noise(robot_std, &mut random) * (1.0 - kept * kept).sqrt();
                (time_s, Transform::from_rigid(path(time_s) * se3::exp(&off)))
            })
            .collect();
        // For a fixed camera the "world" is on the flange, and what moves is the flange in the camera.
        let world_from_sensor = |time_s: f64| match self.mount {
            Mount::OnFlange => base_from_world.inverse() * path(time_s) * sensor,
            Mount::Fixed => base_from_world.inverse() * path(time_s).inverse() * sensor,
        };
        let mut before = world_from_sensor(1.0 + self.lag_s);
        let mut drifted = before;
        let std = self.camera_std;
        let covariance =
            Matrix6::from_diagonal(&se3::join(Vec3::repeat(std[0] * std[0]), Vec3::repeat(std[1] * std[1])));
        let camera = (0..100_000)
            .map(|idx| 1.0 + f64::from(idx) / self.camera_hz)
            .take_while(|time_s| *time_s < self.seconds + 1.0)
            .map(|time_s| {
                let here = world_from_sensor(time_s + self.lag_s);
                let step = before.inverse() * here;
                before = here;
                let off = se3::exp(&noise(std, &mut random));
                drifted = drifted * step * off;
                let pose = if self.weighing == Weighing::Drifting { drifted } else { here * off };
                CameraPose {
                    time_s,
                    world_from_sensor: Transform::from_rigid(pose),
                    step_covariance: self.is_stated.then_some(covariance),
                }
            })
            .collect();
        let problem = StreamProblem {
            mount: self.mount,
            noise: Noise { position_std_mm: Some(ROBOT_STD[1]), orientation_std_rad: Some(ROBOT_STD[0]) },
            reference_distance_mm: Some(500.0),
            flange,
            camera,
            weighing: self.weighing,
            find_offset: true,
        };
        (problem, sensor)
    }
}

/// Mean squares of errors over the stated σ, and the mean of the offset's errors over it.
#[derive(Clone, Copy, Debug, Default)]
struct Honesty {
    offset: f64,
    offset_bias: f64,
    /// Of the workspace point.
    point: f64,
    /// Of all six numbers of the calibration in their covariance.
    sensor: f64,
    count: f64,
}

impl Honesty {
    fn add(&mut self, solution: &Solution, truth: &Rigid, lag_s: f64) {
        let known = solution.uncertainty.as_ref().expect("redundant");
        let offset = solution.motion.as_ref().expect("a motion").time_offset.expect("sought");
        let off = (offset.offset_s - lag_s) / offset.std_s.expect("found");
        self.offset += off * off;
        self.offset_bias += off;
        let point = known.reference_point_in_sensor_mm;
        let off_mm = solution.flange_from_sensor.map_point(point) - (truth * nalgebra::Point3::from(point)).coords;
        self.point += (off_mm.norm() / known.workspace_point_std_mm).powi(2);
        let right = se3::log(&(truth.inverse() * solution.flange_from_sensor.rigid()));
        let (turn, shift) = se3::split(&right);
        let off = se3::join(turn, truth.rotation * shift);
        self.sensor += off.dot(&(known.covariance.try_inverse().expect("a covariance") * off)) / 6.0;
        self.count += 1.0;
    }

    /// Simulates and solves.
    fn try_out(&mut self, streams: Streams, seeds: std::ops::Range<u32>) {
        for seed in seeds {
            let lag_s = 0.01 * f64::from(seed % 31) - 0.15;
            let (problem, truth) = Streams { lag_s, ..streams }.simulate(u64::from(seed));
            let solution = solve_streams(&problem).unwrap_or_else(|error| panic!("{streams:?} {seed}: {error}"));
            self.add(&solution, &truth, lag_s);
        }
    }

    fn assert(&self, name: &str) {
        let [offset, point, sensor] = [self.offset, self.point, self.sensor].map(|sum| sum / self.count);
        // Mean squares of one, about two and six numbers a trial, by chance or by a σ that is a fifth off; four of their σ.
        let by_chance = |numbers: f64| 4.0 * (2.0 / (numbers * self.count)).sqrt();
        let is_honest =
            |square: f64, numbers: f64| square < 1.4 + by_chance(numbers) && square > 0.7 - 0.5 * by_chance(numbers);
        assert!(is_honest(offset, 1.0), "{name}: offset {offset}");
        assert!(is_honest(point, 2.0), "{name}: point {point}");
        assert!(is_honest(sensor, 6.0), "{name}: sensor {sensor}");
        let bias = self.offset_bias / self.count.sqrt();
        assert!(bias.abs() < 3.5, "{name}: the offset is biased by {bias} of the mean's σ");
    }
}

#[test]
fn the_offset_is_not_pulled_to_between_samples_and_every_sigma_is_that_of_the_errors() {
    for flange_noise in [FlangeNoise::None, FlangeNoise::White, FlangeNoise::Correlated] {
        let mut honesty = Honesty::default();
        // Where both streams tick in step, all poses lie at the same place between two samples.
        for (seed, (camera_hz, flange_hz)) in
            (0..).zip([(10.0, 30.0), (10.0, 60.0), (10.0, 125.0), (30.0, 30.0), (30.0, 60.0)])
        {
            let seconds = if camera_hz > 20.0 { 6.0 } else { 12.0 };
            let streams = Streams { camera_hz, flange_hz, flange_noise, seconds, ..Streams::default() };
            honesty.try_out(streams, 8 * seed..8 * (seed + 1));
        }
        honesty.assert(&format!("{flange_noise:?}"));
    }
}

#[test]
fn the_offset_of_poses_of_a_target_and_of_fixed_cameras_is_as_honest() {
    for (weighing, mount) in [
        (Weighing::Drifting, Mount::Fixed),
        (Weighing::Independent, Mount::OnFlange),
        (Weighing::Independent, Mount::Fixed),
    ] {
        let streams = Streams { weighing, mount, is_stated: false, ..Streams::default() };
        let mut honesty = Honesty::default();
        honesty.try_out(streams, 0..20);
        honesty.assert(&format!("{weighing:?} {mount:?}"));
    }
}

fn track(solution: &Solution) -> &TrackReduced {
    match &solution.motion.as_ref().expect("a motion").data {
        MotionData::Track(track) => track,
        MotionData::Poses(_) => panic!("the camera drifts"),
    }
}

/// Changes the camera's poses from one place to another by what is given for each step; those after it follow.
fn disturb(problem: &mut StreamProblem, steps: std::ops::Range<usize>, mut change: impl FnMut() -> Rigid) {
    let mut off = Rigid::identity();
    for (place, pose) in problem.camera.iter_mut().enumerate() {
        let world_from_sensor = off * pose.world_from_sensor.rigid();
        let after = if steps.contains(&place) { world_from_sensor * change() } else { world_from_sensor };
        off = after * pose.world_from_sensor.rigid().inverse();
        pose.world_from_sensor = Transform::from_rigid(after);
    }
}

#[test]
fn a_track_is_validated_by_its_stretches() {
    let (mut disagreement, mut drawn, mut studentised) = (Vec::new(), Vec::new(), Vec::new());
    for seed in 0..6 {
        let (problem, _) = Streams { seconds: 24.0, ..Streams::default() }.simulate(seed + 50);
        let solution = solve_streams(&problem).expect("solved");
        let track = track(&solution);
        let motion = solution.motion.as_ref().expect("a motion");
        assert_eq!(track.num_stretches(), 12);
        assert_eq!(solution.stations.len(), 12);
        assert_eq!(motion.poses.len(), problem.camera.len());
        assert!(motion.poses.iter().all(|pose| pose.label == solution.stations[pose.station].label));
        assert_eq!(solution.stations[0].label, "0.0–1.9 s");
        // Taken once each, the stretches are the whole.
        let again = track.solve_with_times(|_| 1.0).expect("solved");
        let off = se3::log(&(again.flange_from_sensor.inverse() * solution.flange_from_sensor.rigid()));
        assert!(off.norm() < 1e-4, "{off}");
        let left_out = solution.leave_one_out.expect("enough stretches");
        // A twelfth of the data predicted by the rest: hardly worse than in sample.
        assert!(
            (1.0..1.2).contains(&(left_out.rms_mm / solution.scatter.rms_mm)),
            "{left_out:?} {:?}",
            solution.scatter
        );
        let validation = validate(&solution).expect("validated");
        studentised.extend(validation.influence.iter().map(|influence| influence.studentised_residual));
        let halves = validation.split_half.expect("halves");
        disagreement.push(halves.median_mm / halves.expected_mm);
        assert!(validation.normality.expect("residuals").p_value > 1e-4);
        let std_mm = bootstrap(&solution, 100, 1, &mut Unwatched).expect("not cancelled").std_mm;
        drawn.push(std_mm / solution.uncertainty.as_ref().expect("redundant").workspace_point_std_mm);
    }
    // Six tracks: each ratio scatters by a third, and draws of twelve stretches see a little less than all there is.
    let (disagreement, drawn, studentised) = (median(&mut disagreement), median(&mut drawn), rms(studentised));
    assert!((0.6..1.6).contains(&disagreement), "{disagreement}");
    assert!((0.5..1.6).contains(&drawn), "{drawn}");
    assert!((0.8..1.2).contains(&studentised), "{studentised}");
}

#[test]
fn a_stretch_in_which_the_camera_slips_or_sees_badly_stands_out() {
    // Most of the sixth of twelve stretches.
    let bad = 102..118;
    let slip = Rigid::from_parts(Vec3::new(20.0 / 16.0, 0.0, 0.0).into(), exp(Vec3::zeros()));
    let mut random = Random::new(1, 1);
    // Twice the noise: too little for many steps to be given up.
    let mut noisy = || se3::exp(&noise([5e-4, 0.5], &mut random));
    for (name, is_slip) in [("slip", true), ("noise", false)] {
        let (mut problem, _) =
            Streams { seconds: 24.0, camera_std: [3e-4, 0.3], is_stated: false, ..Streams::default() }.simulate(70);
        disturb(&mut problem, bad.clone(), || if is_slip { slip } else { noisy() });
        let solution = solve_streams(&problem).expect("solved");
        let motion = solution.motion.as_ref().expect("a motion");
        let validation = validate(&solution).expect("validated");
        let worst = validation
            .influence
            .iter()
            .max_by(|a, b| a.studentised_residual.total_cmp(&b.studentised_residual))
            .expect("stretches");
        let lost = motion.tracked.expect("tracked").num_lost;
        assert_eq!(worst.station_idx, motion.poses[110].station, "{name} {lost} lost: {:?}", validation.influence);
        assert!(worst.p_value < 1e-3, "{name}: {worst:?}");
    }
}

#[test]
fn short_tracks_have_no_stretches_to_leave_out() {
    let (problem, _) = Streams { seconds: 1.2, ..Streams::default() }.simulate(3);
    let solution = solve_streams(&StreamProblem { find_offset: false, ..problem }).expect("solved");
    assert_eq!(solution.stations.len(), 3);
    assert_eq!(solution.leave_one_out, None);
    assert!(validate(&solution).is_none());
}

/// A flange that turns as given, with a camera on it, both without noise.
fn turning(turn: impl Fn(f64) -> Vec3) -> StreamProblem {
    let sensor = Rigid::from_parts(Vec3::new(45.0, -30.0, 80.0).into(), exp(Vec3::new(0.3, -1.2, 2.0)));
    let path = |time_s: f64| {
        Rigid::from_parts(Vec3::new(500.0 + 60.0 * time_s.sin(), 40.0 * time_s.cos(), 300.0).into(), exp(turn(time_s)))
    };
    let times = |hz: f64| (0..200).map(move |idx| f64::from(idx) / hz);
    StreamProblem {
        mount: Mount::OnFlange,
        noise: Noise::default(),
        reference_distance_mm: None,
        flange: times(20.0).map(|time_s| (time_s, Transform::from_rigid(path(time_s)))).collect(),
        camera: times(20.0)
            .map(|time_s| CameraPose {
                time_s,
                world_from_sensor: Transform::from_rigid(path(time_s) * sensor),
                step_covariance: None,
            })
            .collect(),
        weighing: Weighing::Drifting,
        find_offset: false,
    }
}

#[test]
fn streams_that_leave_something_open_say_so() {
    let axis = Vec3::new(0.6, 0.0, 0.8);
    for weighing in [Weighing::Drifting, Weighing::Independent] {
        let about_one = StreamProblem { weighing, ..turning(|time_s| axis * (0.5 * time_s).sin()) };
        match solve_streams(&about_one) {
            Err(SolveError::RotationsAboutOneAxis { axis_x, axis_y, axis_z }) => {
                let found = Vec3::new(axis_x, axis_y, axis_z);
                assert!(found.cross(&axis).norm() < 1e-6, "{found}");
            }
            other => panic!("{other:?}"),
        }
        let level = StreamProblem { weighing, ..turning(|_| axis) };
        assert!(matches!(solve_streams(&level), Err(SolveError::NoRotation { .. })));
        let free = |time_s: f64| Vec3::new((0.5 * time_s).sin(), (0.7 * time_s).cos(), 0.3 * time_s.sin());
        let mut inverted = StreamProblem { weighing, ..turning(free) };
        let is_named = |problem: &StreamProblem| {
            let solution = solve_streams(problem).expect("solved");
            solution.warnings.iter().any(|warning| warning.code() == "stream-inverted")
        };
        assert!(!is_named(&inverted), "{weighing:?}");
        for pose in &mut inverted.camera {
            pose.world_from_sensor = Transform::from_rigid(pose.world_from_sensor.rigid().inverse());
        }
        assert!(is_named(&inverted), "{weighing:?}");
        let backwards: Vec<CameraPose> = inverted.camera.iter().rev().copied().collect();
        let shuffled = StreamProblem { camera: backwards, ..inverted };
        assert!(matches!(solve_streams(&shuffled), Err(SolveError::TimesNotRising)));
    }
}
