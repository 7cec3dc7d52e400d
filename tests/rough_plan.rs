//! Stations of a cell whose mounting is only guessed: whether the ball stays in view, and what the stations are worth.
#![expect(clippy::expect_used, reason = "a test that finds nothing to check must fail")]

use std::sync::Arc;

use handeye::calibrate::{Method, Mount, Noise, SideChoice, solve};
use handeye::device::SearchEnd;
use handeye::device::search::{DirectionFrame, Search, SearchNext, SearchSettings, StepSeen};
use handeye::fit::{ArcOptions, extract_arc};
use handeye::geometry::{Rigid, Transform, Vec3, so3};
use handeye::plan::{Limits, MeasuredStation, PlanRefusal, RoughCell, View, next_rough, refined};
use handeye::scene::{Dirt, Random, Scene};
use handeye::session::model::UnknownFields;
use handeye::session::{Capture, Reading, Session, Station, Target, ball_problem, measure};
use handeye::watch::Unwatched;

const NUM_STATIONS: usize = 8;
const VIEW: View = View { half_width_mm: 10.0, half_range_mm: 10.0, middle_range_mm: 80.0 };
const RADIUS_MM: f64 = 12.0;
/// Noise of each coordinate of a reported position, mm.
const POSITION_STD_MM: f64 = 0.02;
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
                target_in_base_mm: Vec3::zeros(),
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

    /// Searches the largest arc from a pose, through profiles, with all captures kept.
    fn search(&mut self, start: &Rigid) -> (Station, MeasuredStation) {
        let settings = self.search_settings();
        let scene = Scene {
            ball_in_world: self.ball_in_base,
            radius_mm: RADIUS_MM,
            num_points: 300,
            range_sign: 1.0,
            profile_std_mm: 0.01,
            dirt: Dirt { has_table: true, ..Dirt::default() },
            decimals: None,
        };
        let options = ArcOptions { ball_radius_mm: RADIUS_MM, profile_std_mm: None };
        let mut search = Search::new(&settings, RADIUS_MM);
        let mut captures: Vec<Capture> = Vec::new();
        let mut centres: Vec<(f64, [f64; 2])> = Vec::new();
        let mut previous_mm = None;
        while let SearchNext::CaptureAt { commanded_mm } = search.next() {
            let pose = settings.pose_at(start, commanded_mm);
            let world_from_sensor = self.carrier(&pose) * self.flange_from_sensor;
            let profile = scene.profile(&world_from_sensor, &mut self.noise, &mut Random::new(0, 2));
            let shift = self.noise.normal3() * POSITION_STD_MM;
            let reported = Rigid::from_parts((pose.translation.vector + shift).into(), pose.rotation);
            let travelled_mm = settings.travelled_mm(start, &reported);
            let arc = extract_arc(&profile, &options);
            if let Ok(arc) = &arc {
                centres.push((travelled_mm, [arc.circle.x_mm, arc.circle.z_mm]));
            }
            captures.push(Capture {
                base_from_flange: Transform::from_rigid(reported),
                written_angles: None,
                reading: Reading::Profile(Arc::new(profile)),
                step_mm: previous_mm.map(|previous_mm: f64| commanded_mm - previous_mm),
                unknown: UnknownFields::new(),
            });
            previous_mm = Some(commanded_mm);
            search.take(StepSeen {
                travelled_mm,
                radius_and_std_mm: arc
                    .map(|arc| [arc.circle.radius_mm, arc.std_mm()[2]])
                    .map_err(|refusal| refusal.to_string()),
            });
        }
        let end = search.report().end.as_ref().expect("over");
        let SearchEnd::Found { peak_mm, peak_std_mm } = *end else { panic!("{end}") };
        let off = |travelled_mm: f64| (travelled_mm - peak_mm).abs();
        centres.sort_by(|(a, _), (b, _)| off(*a).total_cmp(&off(*b)));
        let at_peak = Transform::from_rigid(settings.pose_at(start, peak_mm));
        let station = Station {
            label: String::new(),
            enabled: true,
            side: SideChoice::Auto,
            edge: None,
            captures,
            unknown: UnknownFields::new(),
        };
        (station, MeasuredStation::at_peak(at_peak, centres[0].1, peak_std_mm))
    }

    /// Along the laser's normal as the guess has it.
    fn search_settings(&self) -> SearchSettings {
        let direction = self.rough.flange_from_sensor.rotation * Vec3::y();
        let frame = match self.rough.mount {
            Mount::OnFlange => DirectionFrame::Tool,
            Mount::Fixed => DirectionFrame::Base,
        };
        SearchSettings { frame, direction: direction.into(), ..SearchSettings::default() }
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

/// How far the stations with a number are turned, degrees: from the first one, and by tilt and spin within the limits.
fn tell_turns(turns_deg: &[Vec<[f64; 3]>]) {
    let median = |station: &[[f64; 3]], column: usize| {
        let mut values: Vec<f64> = station.iter().map(|turns_deg| turns_deg[column]).collect();
        values.sort_by(f64::total_cmp);
        values[values.len() / 2]
    };
    println!("| station | turned from the first / ° | tilt / ° | spin / ° |\n| --- | --- | --- | --- |");
    for (idx, station) in turns_deg.iter().enumerate() {
        let [turned, tilt, spin] = [0, 1, 2].map(|column| median(station, column));
        println!("| {} | {turned:.0} | {tilt:.0} | {spin:.0} |", idx + 2);
    }
}

#[test]
fn eight_stations_keep_the_ball_in_view_and_spread_over_the_limits() {
    let limits = Limits { max_spin_deg: 60.0, ..Limits::default() };
    for (mount, num_cells) in [(Mount::OnFlange, 200), (Mount::Fixed, 20)] {
        let (mut num_lost, mut num_planned) = (0, 0);
        let mut turns_deg = vec![Vec::new(); NUM_STATIONS - 1];
        let (mut worst, mut least_turn_deg) = ([0.0_f64; 2], f64::INFINITY);
        for seed in 0..num_cells {
            let mut cell = Cell::new(seed, mount);
            let first = cell.first_pose();
            let mut stations = vec![cell.measure(&first).expect("the operator sees it")];
            let mut avoided = Vec::new();
            for turns_deg in &mut turns_deg {
                let (planned, _) = next_rough(&cell.rough, &stations, &avoided, &VIEW, &limits).expect("a station");
                num_planned += 1;
                let turned = planned.base_from_flange.rotation().angle_to(&first.rotation);
                turns_deg.push([turned.to_degrees(), planned.tilt_deg.abs(), planned.spin_deg.abs()]);
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
            worst = [worst[0].max(off_mm), worst[1].max(off_deg)];
            least_turn_deg = least_turn_deg.min(turn_deg);
        }
        let [worst_mm, worst_deg] = worst;
        println!("{mount:?}: off by {worst_mm:.3} mm and {worst_deg:.3}° at most; {least_turn_deg:.0}° apart at least");
        tell_turns(&turns_deg);
        println!("{mount:?}: the ball was out of view at {num_lost} of {num_planned} planned stations");
        // Two σ along three axes would be one in ten if all were on the edge.
        assert!(100 * num_lost < num_planned, "{mount:?}: {num_lost} of {num_planned}");
    }
}

/// The whole way of a live cell, without its devices.
#[test]
fn a_run_from_a_guess_ends_in_a_calibration_with_a_true_uncertainty() {
    let limits = Limits { max_spin_deg: 60.0, ..Limits::default() };
    for (mount, seed) in [(Mount::OnFlange, 0), (Mount::OnFlange, 1), (Mount::OnFlange, 2), (Mount::Fixed, 3)] {
        let mut cell = Cell::new(seed, mount);
        let mut pose = cell.first_pose();
        let mut session = Session { mount, ..Session::new(Target::ball(RADIUS_MM)) };
        session.robot.position_std_mm = Some(POSITION_STD_MM);
        let mut stations = Vec::new();
        while session.stations.len() < NUM_STATIONS {
            let (station, measured) = cell.search(&pose);
            session.stations.push(Station { label: session.stations.len().to_string(), ..station });
            stations.push(measured);
            let (planned, _) = next_rough(&cell.rough, &stations, &[], &VIEW, &limits).expect("a station");
            pose = *planned.base_from_flange.rigid();
        }
        let measured = measure(&session, None, &mut Unwatched).expect("not cancelled");
        let problem = ball_problem(&session, &measured).expect("a ball");
        let solution = solve(&problem, Method::BallBundle).expect("solvable");
        let known = solution.uncertainty.as_ref().expect("redundant");
        let point = known.reference_point_in_sensor_mm;
        let true_point = cell.flange_from_sensor * nalgebra::Point3::from(point);
        let error_mm = (solution.flange_from_sensor.map_point(point) - true_point.coords).norm();
        println!("{mount:?} {seed}: off by {error_mm:.4} mm, σ {:.4} mm", known.workspace_point_std_mm);
        assert!(error_mm < 3.0 * known.workspace_point_std_mm, "{mount:?} {seed}: {error_mm}");
        assert!(known.workspace_point_std_mm < 0.05, "{mount:?} {seed}: {}", known.workspace_point_std_mm);
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
        let ball = pose * now.flange_from_sensor * nalgebra::Point3::from(station.target_in_sensor_mm);
        assert!((ball.coords - now.target_in_base_mm).norm() < 1e-6);
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
