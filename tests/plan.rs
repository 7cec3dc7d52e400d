//! Planned stations against what they bring when they are measured: simulated from the truth, added, and solved.
#![expect(clippy::expect_used, reason = "a test that finds nothing to check must fail")]

use std::sync::Arc;

use handeye::calibrate::{Method, Mount, SideChoice, Solution, Warning, solve};
use handeye::geometry::{Profile, Rigid, Transform, Vec3, so3};
use handeye::plan::{Limits, Plan, PlanRefusal, PlannedStation, RoughCell, from_nothing, next_stations};
use handeye::session::model::UnknownFields;
use handeye::session::{Capture, Reading, Session, Station, Target, ball_problem, measure};
use handeye::simulate::{SimulationOptions, simulate};
use handeye::watch::Unwatched;

const MOUNTS: [Mount; 2] = [Mount::OnFlange, Mount::Fixed];
const STEP_MM: f64 = 0.75;

/// A seeded source of normally distributed numbers (splitmix64, sums of twelve).
struct Noise(u64);

impl Noise {
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut bits = self.0;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        f64::from(u32::try_from((bits ^ (bits >> 31)) >> 32).expect("32 bits")) / f64::from(u32::MAX)
    }

    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.unit()).sum::<f64>() - 6.0
    }

    fn normal3(&mut self) -> Vec3 {
        Vec3::new(self.normal(), self.normal(), self.normal())
    }
}

fn options(seed: u64, mount: Mount) -> SimulationOptions {
    SimulationOptions { seed, mount, num_points: 120, num_stations: 8, ..SimulationOptions::default() }
}

fn solved(session: &Session) -> Solution {
    let measured = measure(session, None, &mut Unwatched).expect("not cancelled");
    let problem = ball_problem(session, &measured).expect("a ball");
    solve(&problem, Method::BallBundle).expect("solvable")
}

fn std_mm(solution: &Solution) -> f64 {
    solution.uncertainty.as_ref().expect("redundant").workspace_point_std_mm
}

fn carrier_pose(session: &Session, base_from_flange: &Rigid) -> Rigid {
    match session.mount {
        Mount::OnFlange => *base_from_flange,
        Mount::Fixed => base_from_flange.inverse(),
    }
}

/// The ball in the sensor frame at a pose, by the truth.
fn true_ball_in_sensor(session: &Session, base_from_flange: &Rigid) -> Vec3 {
    let truth = session.truth.as_ref().expect("simulated");
    let world_from_sensor = carrier_pose(session, base_from_flange) * truth.flange_from_sensor.rigid();
    world_from_sensor.inverse_transform_point(&truth.target_in_base_mm.into()).coords
}

/// Measures a sweep that begins at a pose, with the session's truth, radius and noise.
fn add_station(session: &mut Session, base_from_flange: &Rigid, num_captures: i32, noise: &mut Noise) {
    let truth = session.truth.clone().expect("simulated");
    let mounting = *truth.flange_from_sensor.rigid();
    let position_std_mm = session.robot.position_std_mm.expect("simulated");
    let orientation_std = session.robot.orientation_std_deg.expect("simulated").to_radians();
    let first = carrier_pose(session, base_from_flange) * mounting;
    let step_mm = STEP_MM * true_ball_in_sensor(session, base_from_flange).y.signum();
    let captures = (0..num_captures)
        .map(|idx| {
            let world_from_sensor = first * Rigid::translation(0.0, step_mm * f64::from(idx), 0.0);
            let ball = world_from_sensor.inverse_transform_point(&truth.target_in_base_mm.into()).coords;
            let pose = carrier_pose(session, &(world_from_sensor * mounting.inverse()));
            let position = pose.translation.vector + noise.normal3() * position_std_mm;
            let rotation = pose.rotation * so3::exp(noise.normal3() * orientation_std);
            Capture {
                base_from_flange: Transform::from_parts(position, rotation),
                written_angles: None,
                reading: Reading::Profile(Arc::new(profile(session, ball, noise))),
                step_mm: (idx > 0).then_some(step_mm),
                unknown: UnknownFields::new(),
            }
        })
        .collect();
    session.stations.push(Station {
        label: (session.stations.len() + 1).to_string(),
        enabled: true,
        side: SideChoice::Auto,
        edge: None,
        captures,
        unknown: UnknownFields::new(),
    });
}

fn profile(session: &Session, ball: Vec3, noise: &mut Noise) -> Profile {
    let Target::Ball { radius_mm, .. } = session.target else { panic!("a ball") };
    let x_mm: Vec<f64> = (0..120).map(|idx| (f64::from(idx) / 119.0 - 0.5) * 3.0 * radius_mm).collect();
    let z_mm: Vec<Option<f64>> = x_mm
        .iter()
        .map(|x| {
            let height = (radius_mm.powi(2) - ball.y.powi(2) - (x - ball.x).powi(2)).max(0.0).sqrt();
            // No light comes back from flanks steeper than 75°.
            (height > radius_mm * 75_f64.to_radians().cos())
                .then(|| ball.z - height + noise.normal() * session.sensor.profile_std_mm.expect("simulated"))
        })
        .collect();
    Profile::new(x_mm, &z_mm).expect("finite")
}

fn planned(session: &Session, limits: &Limits, num: usize) -> (Plan, Solution) {
    let solution = solved(session);
    (next_stations(&solution, limits, num).expect("a plan"), solution)
}

fn pose(station: &PlannedStation) -> Rigid {
    *station.base_from_flange.rigid()
}

#[test]
fn a_planned_station_brings_what_was_said() {
    for mount in MOUNTS {
        let ratios: Vec<f64> = (1..=6)
            .map(|seed| {
                let mut session = simulate(&options(seed, mount));
                let (plan, _) = planned(&session, &Limits::default(), 2);
                let mut noise = Noise(seed);
                for station in &plan.stations {
                    add_station(&mut session, &pose(station), 21, &mut noise);
                }
                let solution = solved(&session);
                let predicted = plan.stations[1].workspace_point_std_mm.expect("determined");
                assert!(predicted < plan.stations[0].workspace_point_std_mm.expect("determined"));
                std_mm(&solution) / predicted
            })
            .collect();
        for ratio in &ratios {
            assert!((0.75..1.25).contains(ratio), "{mount:?}: {ratios:?}");
        }
    }
}

#[test]
fn the_first_planned_station_beats_random_ones() {
    for mount in MOUNTS {
        for seed in [3, 4] {
            let session = simulate(&SimulationOptions { num_stations: 6, ..options(seed, mount) });
            let (plan, _) = planned(&session, &Limits::default(), 1);
            let with = |base_from_flange: &Rigid, noise: &mut Noise| {
                let mut session = session.clone();
                add_station(&mut session, base_from_flange, 21, noise);
                std_mm(&solved(&session))
            };
            let mut noise = Noise(seed);
            let by_plan = with(&pose(&plan.stations[0]), &mut noise);
            let mut random: Vec<f64> = (0..8)
                .map(|_| {
                    let truth = session.truth.as_ref().expect("simulated");
                    let upright = carrier_pose(&session, session.stations[0].captures[0].base_from_flange.rigid())
                        * truth.flange_from_sensor.rigid();
                    let tilt = so3::exp(
                        Vec3::new(noise.unit() - 0.5, noise.unit() - 0.5, 0.0).normalize() * 0.52 * noise.unit(),
                    );
                    let spin = so3::exp(Vec3::z() * std::f64::consts::PI * (noise.unit() - 0.5));
                    let rotation = upright.rotation * tilt * spin;
                    let origin = truth.target_in_base_mm - rotation * Vec3::new(0.0, 9.0, 95.0);
                    let carrier =
                        Rigid::from_parts(origin.into(), rotation) * truth.flange_from_sensor.rigid().inverse();
                    with(&carrier_pose(&session, &carrier), &mut noise)
                })
                .collect();
            random.sort_by(f64::total_cmp);
            let mean = random.iter().sum::<f64>() / 8.0;
            assert!(by_plan < mean, "{mount:?}: {by_plan} against {random:?}");
        }
    }
}

#[test]
fn limits_and_view_are_respected() {
    for mount in MOUNTS {
        let session = simulate(&options(5, mount));
        let limits = Limits {
            max_tilt_deg: 20.0,
            max_spin_deg: 45.0,
            standoff_mm: Some([88.0, 102.0]),
            half_width_mm: Some(5.0),
            ..Limits::default()
        };
        let (plan, solution) = planned(&session, &limits, 6);
        assert_eq!(plan.stations.len(), 6);
        let mut before = plan.workspace_point_std_mm.expect("determined");
        assert!((before - std_mm(&solution)).abs() < 1e-12);
        let mut rotations: Vec<_> =
            session.stations.iter().map(|station| station.captures[0].base_from_flange.rotation()).collect();
        for station in &plan.stations {
            assert!((0.0..=20.0 + 1e-9).contains(&station.tilt_deg), "{station:?}");
            assert!(station.spin_deg.abs() <= 45.0 + 1e-9, "{station:?}");
            assert!((0.0..360.0).contains(&station.azimuth_deg), "{station:?}");
            let ball = true_ball_in_sensor(&session, &pose(station));
            // The calibration is a few hundredths of a millimetre off the truth.
            assert!(ball.x.abs() < 5.2 && (87.8..102.2).contains(&ball.z), "{mount:?}: {ball}");
            assert!(ball.y.abs() < 0.75 * 15.0, "the line strikes the ball: {ball}");
            let after = station.workspace_point_std_mm.expect("determined");
            assert!(after < before, "{after} {before}");
            before = after;
            let rotation = station.base_from_flange.rotation();
            for other in &rotations {
                assert!(rotation.angle_to(other).to_degrees() > 2.0, "a twin");
            }
            rotations.push(rotation);
        }
    }
}

#[test]
fn without_limits_of_the_view_the_ball_stays_where_it_was_seen() {
    let session = simulate(&SimulationOptions { z_towards_sensor: true, ..options(6, Mount::OnFlange) });
    let seen: Vec<Vec3> = session
        .stations
        .iter()
        .map(|station| true_ball_in_sensor(&session, station.captures[0].base_from_flange.rigid()))
        .collect();
    let range = |axis: usize| {
        let values = || seen.iter().map(|ball| ball[axis]);
        (values().fold(f64::INFINITY, f64::min) - 0.2)..=(values().fold(f64::NEG_INFINITY, f64::max) + 0.2)
    };
    for station in planned(&session, &Limits::default(), 4).0.stations {
        let ball = true_ball_in_sensor(&session, &pose(&station));
        assert!(range(0).contains(&ball.x) && range(2).contains(&ball.z), "{ball}");
    }
}

/// Turns about the vertical with hardly any tilt: the plan has to tilt.
#[test]
fn rotations_about_one_axis_are_made_up_for_by_tilt_across_it() {
    for mount in MOUNTS {
        let session = simulate(&SimulationOptions { tilt_deg: 1.5, spin_deg: 80.0, ..options(7, mount) });
        let (plan, solution) = planned(&session, &Limits::default(), 1);
        assert!(solution.warnings.iter().any(|warning| matches!(warning, Warning::NearlyOneAxis { .. })));
        let station = &plan.stations[0];
        assert!(station.tilt_deg > 25.0, "{station:?}");
        let gain = std_mm(&solution) / station.workspace_point_std_mm.expect("determined");
        assert!(gain > 2.0, "one station across the axis makes up for much: {gain}");
    }
}

#[test]
fn little_rotation_is_made_up_for_by_much() {
    let session = simulate(&SimulationOptions { tilt_deg: 5.0, spin_deg: 5.0, ..options(8, Mount::OnFlange) });
    let (plan, solution) = planned(&session, &Limits::default(), 2);
    let last = plan.stations[1].workspace_point_std_mm.expect("determined");
    assert!(last < 0.5 * std_mm(&solution), "{last} {}", std_mm(&solution));
    let mut grown = session.clone();
    let mut noise = Noise(8);
    for station in &plan.stations {
        add_station(&mut grown, &pose(station), 21, &mut noise);
    }
    let ratio = std_mm(&solved(&grown)) / last;
    assert!((0.7..1.4).contains(&ratio), "{ratio}");
}

#[test]
fn single_sections_are_planned_as_single_sections() {
    let options = SimulationOptions { num_steps: 1, num_stations: 12, ..options(9, Mount::OnFlange) };
    let mut session = simulate(&options);
    let (plan, _) = planned(&session, &Limits::default(), 2);
    let mut noise = Noise(9);
    for station in &plan.stations {
        add_station(&mut session, &pose(station), 1, &mut noise);
    }
    let predicted = plan.stations[1].workspace_point_std_mm.expect("determined");
    let ratio = std_mm(&solved(&session)) / predicted;
    // The scatter of twelve single sections says less about the noise than that of sweeps.
    assert!((0.6..1.5).contains(&ratio), "{ratio}");
}

/// What a user knows of the cell: the mounting within 8° and 15 mm, the ball within 15 mm.
fn rough(session: &Session, looks_along_in_base: Vec3) -> RoughCell {
    let truth = session.truth.as_ref().expect("simulated");
    let off = Rigid::new(Vec3::new(9.0, -9.0, 8.0), Vec3::new(0.08, -0.07, 0.09));
    RoughCell {
        mount: session.mount,
        flange_from_sensor: truth.flange_from_sensor.rigid() * off,
        target_in_base_mm: truth.target_in_base_mm + Vec3::new(-8.0, 9.0, 8.0),
        radius_mm: 15.0,
        noise: handeye::calibrate::Noise::default(),
        looks_along_in_base,
    }
}

#[test]
fn a_plan_from_nothing_makes_a_calibration() {
    for mount in MOUNTS {
        let mut session = simulate(&SimulationOptions { num_stations: 0, ..options(11, mount) });
        let limits = Limits { standoff_mm: Some([85.0, 105.0]), ..Limits::default() };
        let cell = rough(&session, -Vec3::z());
        let plan = from_nothing(&cell, &limits, 8).expect("a plan");
        assert_eq!(plan.workspace_point_std_mm, None);
        let stds: Vec<Option<f64>> = plan.stations.iter().map(|station| station.workspace_point_std_mm).collect();
        assert_eq!(stds.iter().take_while(|std| std.is_none()).count(), 3, "four stations are needed: {stds:?}");
        assert!(
            plan.stations[0].tilt_deg.abs() + plan.stations[0].spin_deg.abs() < 1e-12,
            "the first at the reference"
        );
        let mut noise = Noise(11);
        for station in &plan.stations {
            let mut at = pose(station);
            // By the rough mounting the ball is off; the operator brings it to where it was to be, the orientation stays.
            let meant = carrier_pose(&session, &at) * cell.flange_from_sensor;
            let meant = meant.inverse_transform_point(&cell.target_in_base_mm.into()).coords;
            let off = true_ball_in_sensor(&session, &at) - meant;
            let truth = session.truth.as_ref().expect("simulated");
            let mounting = *truth.flange_from_sensor.rigid();
            let moved = carrier_pose(&session, &at) * mounting * Rigid::new(off, Vec3::zeros()) * mounting.inverse();
            at = carrier_pose(&session, &moved);
            assert!(off.norm() < 60.0, "{mount:?}: the ball is off by {off}");
            add_station(&mut session, &at, 21, &mut noise);
        }
        let solution = solved(&session);
        let ratio = std_mm(&solution) / stds[7].expect("determined");
        assert!((0.6..1.6).contains(&ratio), "{mount:?}: {ratio}");
    }
}

#[test]
fn impossible_limits_and_cells_are_refused() {
    let session = simulate(&options(1, Mount::OnFlange));
    let solution = solved(&session);
    let refused = |limits: &Limits| next_stations(&solution, limits, 1).expect_err("impossible");
    for limits in [
        Limits { max_tilt_deg: 0.0, max_spin_deg: 0.0, ..Limits::default() },
        Limits { standoff_mm: Some([100.0, 90.0]), ..Limits::default() },
        Limits { half_width_mm: Some(-1.0), ..Limits::default() },
        Limits { half_width_mm: Some(f64::NAN), ..Limits::default() },
    ] {
        assert_eq!(refused(&limits), PlanRefusal::NothingWithinLimits, "{limits:?}");
    }
    let cell = rough(&session, -Vec3::z());
    for cell in [
        RoughCell { looks_along_in_base: Vec3::zeros(), ..cell },
        RoughCell { radius_mm: -1.0, ..cell },
        RoughCell { target_in_base_mm: Vec3::new(f64::NAN, 0.0, 0.0), ..cell },
    ] {
        assert_eq!(from_nothing(&cell, &Limits::default(), 3), Err(PlanRefusal::Undetermined), "{cell:?}");
    }
}
