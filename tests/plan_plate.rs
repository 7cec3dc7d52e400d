//! Planned stations at a plate and a tip against what they bring when they are measured: profiles simulated from the truth,
//! added, and solved.
#![expect(clippy::expect_used, reason = "a test that finds nothing to check must fail")]

use std::f64::consts::PI;
use std::sync::Arc;

use handeye::calibrate::{Edge, Mount, Noise, Reading as Found, SideChoice, Solution, best_available};
use handeye::geometry::{Rigid, Transform, Vec3, so3, stats};
use handeye::plan::{
    Limits, Plan, PlanRefusal, PlannedStation, RoughPlate, SeenEdge, View, next_rough_edge, next_stations,
    refined_plate,
};
use handeye::scene::{Dirt, LINE_WIDTH_MM, Line, Part, PartKind, Random};
use handeye::session::model::UnknownFields;
use handeye::session::{Capture, Reading, Session, Station, measure, problem};
use handeye::simulate::{RoughMounting, SimulationOptions, SimulationTarget, simulate};
use handeye::watch::Unwatched;

const MOUNTS: [Mount; 2] = [Mount::OnFlange, Mount::Fixed];
const NUM_POINTS: usize = 400;

fn options(kind: PartKind, seed: u64, mount: Mount) -> SimulationOptions {
    SimulationOptions {
        seed,
        mount,
        target: SimulationTarget::Part(kind),
        num_points: NUM_POINTS,
        num_stations: 6,
        num_steps: 1,
        ..SimulationOptions::default()
    }
}

fn solved(session: &Session) -> Solution {
    let measured = measure(session, None, &mut Unwatched).expect("not cancelled");
    let problem = problem(session, &measured).expect("a target");
    let results = problem.solve_all(problem.methods(), &mut Unwatched).expect("not cancelled");
    best_available(&results).expect("solvable").clone()
}

fn std_mm(solution: &Solution) -> f64 {
    solution.uncertainty.as_ref().expect("redundant").workspace_point_std_mm
}

fn carrier(mount: Mount, base_from_flange: &Rigid) -> Rigid {
    match mount {
        Mount::OnFlange => *base_from_flange,
        Mount::Fixed => base_from_flange.inverse(),
    }
}

fn part(session: &Session) -> Part {
    let truth = session.truth.as_ref().expect("simulated");
    match truth.base_from_plate {
        Some(base_from_plate) => Part::new(PartKind::Plate, base_from_plate),
        None => Part::new(PartKind::Pin, Rigid::from_parts(truth.target_in_base_mm.into(), so3::exp(Vec3::zeros()))),
    }
}

/// What is measured with the true robot at a pose: the session's noise, one capture.
fn captured(session: &Session, base_from_flange: &Rigid, random: &mut Random) -> Capture {
    let truth = session.truth.as_ref().expect("simulated");
    let world_from_sensor = carrier(session.mount, base_from_flange) * truth.flange_from_sensor.rigid();
    let part = part(session);
    let line = Line {
        num_points: NUM_POINTS,
        width_mm: LINE_WIDTH_MM,
        profile_std_mm: session.sensor.profile_std_mm.expect("simulated"),
        dirt: Dirt::default(),
        decimals: None,
    };
    let profile = line.profile(random, &mut Random::new(0, 0), |x| part.seen_z_mm(x, 1.0, &world_from_sensor));
    let position_std_mm = session.robot.position_std_mm.expect("simulated");
    let orientation_std = session.robot.orientation_std_deg.expect("simulated").to_radians();
    let position = base_from_flange.translation.vector + random.normal3() * position_std_mm;
    Capture {
        base_from_flange: Transform::from_parts(
            position,
            base_from_flange.rotation * so3::exp(random.normal3() * orientation_std),
        ),
        written_angles: None,
        reading: Reading::Profile(Arc::new(profile)),
        step_mm: None,
        unknown: UnknownFields::new(),
    }
}

fn add_station(session: &mut Session, base_from_flange: &Rigid, edge: Option<Edge>, random: &mut Random) {
    let capture = captured(session, base_from_flange, random);
    session.stations.push(Station {
        label: (session.stations.len() + 1).to_string(),
        enabled: true,
        side: SideChoice::Auto,
        edge,
        captures: vec![capture],
        unknown: UnknownFields::new(),
    });
}

fn planned(session: &Session, limits: &Limits, num: usize) -> Plan {
    next_stations(&solved(session), limits, num).expect("a plan")
}

fn pose(station: &PlannedStation) -> Rigid {
    *station.base_from_flange.rigid()
}

#[test]
fn planned_stations_bring_what_was_said() {
    for kind in [PartKind::Plate, PartKind::Pin] {
        for mount in MOUNTS {
            let ratios: Vec<f64> = (1..=6)
                .map(|seed| {
                    let mut session = simulate(&options(kind, seed, mount));
                    let plan = planned(&session, &Limits::default(), 4);
                    let mut random = Random::new(seed, 1);
                    let mut before = plan.workspace_point_std_mm.expect("determined");
                    for station in &plan.stations {
                        assert_eq!(station.edge.is_some(), kind == PartKind::Plate);
                        add_station(&mut session, &pose(station), station.edge, &mut random);
                        let after = station.workspace_point_std_mm.expect("determined");
                        assert!(after < before, "{after} {before}");
                        before = after;
                    }
                    let solution = solved(&session);
                    let num_used = solution.plate.as_ref().map_or(solution.stations.len(), |plate| plate.points.len());
                    assert_eq!(num_used, session.stations.len(), "every planned station saw its edge or tip");
                    println!(
                        "{:.4} -> {before:.4}, got {:.4}",
                        plan.workspace_point_std_mm.expect("determined"),
                        std_mm(&solution)
                    );
                    std_mm(&solution) / before
                })
                .collect();
            println!("{kind:?} {mount:?}: obtained over predicted {ratios:.3?}");
            for ratio in &ratios {
                assert!((0.8..1.2).contains(ratio), "{kind:?} {mount:?}: {ratios:?}");
            }
        }
    }
}
