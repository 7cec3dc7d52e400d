//! Simulated sessions against their own truth.

use nalgebra::UnitQuaternion;

use super::*;
use crate::calibrate::{Edge, Mount};
use crate::scene::PartKind;
use crate::session::format::{parse, to_json};
use crate::session::{self, measure};
use crate::watch::Unwatched;

/// What f64 holds at 800 mm, with a chain of four transforms.
const EXACT_MM: f64 = 1e-9;

fn small(mount: Mount, z_towards_sensor: bool) -> SimulationOptions {
    SimulationOptions {
        num_stations: 6,
        num_steps: 5,
        num_points: 120,
        step_mm: 3.0,
        travel_off_normal_deg: 4.0,
        mount,
        z_towards_sensor,
        ..SimulationOptions::noise_free()
    }
}

/// Calls `check` with every valid point of the session as it lies from the ball's centre, in the ball's world.
fn for_each_offset(session: &Session, mut check: impl FnMut(Vec3)) {
    let truth = session.truth.as_ref().expect("simulated");
    for capture in session.stations.iter().flat_map(|station| &station.captures) {
        let world_from_carrier = match session.mount {
            Mount::OnFlange => *capture.base_from_flange.rigid(),
            Mount::Fixed => capture.base_from_flange.rigid().inverse(),
        };
        let world_from_sensor = world_from_carrier * truth.flange_from_sensor.rigid();
        let Reading::Profile(profile) = &capture.reading else { panic!("a profile") };
        for (_, x, z) in profile.valid_points() {
            check((world_from_sensor * nalgebra::Point3::new(x, 0.0, z)).coords - truth.target_in_base_mm);
        }
    }
}

#[test]
fn without_noise_every_point_lies_on_the_ball_on_the_side_of_the_sensor() {
    for mount in [Mount::OnFlange, Mount::Fixed] {
        for z_towards_sensor in [false, true] {
            let session = simulate(&small(mount, z_towards_sensor));
            let mut num_points = 0;
            for_each_offset(&session, |offset| {
                num_points += 1;
                assert!((offset.norm() - 15.0).abs() < EXACT_MM, "{mount:?}: {}", offset.norm());
                assert!(offset.z > -2.0, "{mount:?}: the sensor looks from above, not at {offset}");
            });
            assert!(num_points > 30 * 40, "{mount:?}: only {num_points} points");
        }
    }
}

#[test]
fn the_default_sweep_starts_on_one_side_of_the_ball_and_ends_on_the_other() {
    for mount in [Mount::OnFlange, Mount::Fixed] {
        let options = SimulationOptions { mount, ..SimulationOptions::noise_free() };
        let setup = Setup::new(&options);
        let mut random = Random::new(options.seed, stream::PATH);
        for station_idx in 0..options.num_stations {
            let path = StationPath::new(&options, &setup, station_idx, &mut random);
            let ball_y_mm =
                |num_steps| path.world_from_sensor(num_steps).inverse_transform_point(&setup.target_in_world.into()).y;
            let (first, last) = (ball_y_mm(0), ball_y_mm(options.num_steps - 1));
            assert!(first * last < 0.0, "station {station_idx} sweeps from {first} to {last}");
            // l > 0.5 R means |y| < 0.866 R.
            assert!(first.abs().max(last.abs()) < 0.866 * options.radius_mm);
            assert!(path.step_mm * first > 0.0, "positive steps bring a ball at positive y nearer");
        }
    }
}

#[test]
fn the_steps_are_those_between_the_true_poses() {
    let session = simulate(&small(Mount::OnFlange, false));
    for station in &session.stations {
        assert_eq!(station.captures[0].step_mm, None);
        for pair in station.captures.windows(2) {
            let moved = pair[1].base_from_flange.translation_mm() - pair[0].base_from_flange.translation_mm();
            let step_mm = pair[1].step_mm.expect("a step");
            assert!((moved.norm() - step_mm.abs()).abs() < EXACT_MM);
        }
    }
}

#[test]
fn the_first_station_points_straight_down_by_an_exact_half_turn() {
    let session = simulate(&small(Mount::OnFlange, false));
    let down = session.stations[0].captures[0].base_from_flange.rotation();
    let half_turn = UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(0.0, 1.0, 0.0, 0.0));
    assert!(down.angle_to(&half_turn) < 1e-12);
}

#[test]
fn the_same_seed_gives_the_same_session_and_another_seed_another() {
    let options =
        SimulationOptions { num_stations: 3, num_steps: 3, dirt: Dirt::all(), ..SimulationOptions::default() };
    assert_eq!(simulate(&options), simulate(&options));
    assert_ne!(simulate(&options), simulate(&SimulationOptions { seed: 2, ..options.clone() }));
}

#[test]
fn noise_has_the_size_that_was_asked_for() {
    let options = SimulationOptions {
        profile_std_mm: 0.05,
        position_std_mm: 0.0,
        orientation_std_deg: 0.0,
        ..SimulationOptions::default()
    };
    let (mut sum, mut count) = (0.0, 0.0);
    for_each_offset(&simulate(&options), |offset| {
        // Near the top the range axis is the radius but for the tilt; there the noise shows as it is.
        if offset.norm() > 1.0 {
            sum += (offset.norm() - options.radius_mm).powi(2);
            count += 1.0;
        }
    });
    // Averaged over the visible half the radial part is smaller than the noise along z, but not by half.
    let radial_std_mm = f64::sqrt(sum / count);
    assert!((0.025..0.05).contains(&radial_std_mm), "{radial_std_mm}");
}

#[test]
fn dirt_adds_table_spikes_and_holes_but_leaves_most_of_the_arc() {
    let clean = SimulationOptions { num_stations: 4, num_steps: 2, num_points: 300, ..SimulationOptions::default() };
    let dirty = SimulationOptions { dirt: Dirt::all(), ..clean.clone() };
    let (mut on_ball, mut table, mut spikes) = (0, 0, 0);
    for_each_offset(&simulate(&dirty), |offset| match offset.norm() - clean.radius_mm {
        distance if distance.abs() < 0.2 => on_ball += 1,
        _ if (offset.z + 1.8 * clean.radius_mm).abs() < 0.2 => table += 1,
        _ => spikes += 1,
    });
    assert!(on_ball > 800 && table > 300 && (10..150).contains(&spikes), "{on_ball} {table} {spikes}");
}

#[test]
fn a_bad_pose_is_that_of_one_station_only() {
    let good = small(Mount::OnFlange, false);
    let bad = SimulationOptions { bad_pose_station: Some(3), ..good.clone() };
    for (idx, (a, b)) in simulate(&good).stations.iter().zip(&simulate(&bad).stations).enumerate() {
        let shift = a.captures[0].base_from_flange.translation_mm() - b.captures[0].base_from_flange.translation_mm();
        let expected = if idx == 3 { SimulationOptions::BAD_POSE_MM } else { 0.0 };
        assert!((shift.norm() - expected).abs() < EXACT_MM);
    }
}

#[test]
fn wild_options_give_a_session_that_can_be_saved_and_opened() {
    for wild in [f64::NAN, f64::INFINITY, -1e300, 0.0, 1e300] {
        for mount in [Mount::OnFlange, Mount::Fixed] {
            let session = simulate(&SimulationOptions {
                num_stations: 2,
                num_steps: 0,
                num_points: 0,
                radius_mm: wild,
                step_mm: wild,
                section_offset_mm: Some(wild),
                section_offset_spread: wild,
                profile_std_mm: wild,
                position_std_mm: wild,
                orientation_std_deg: wild,
                tilt_deg: wild,
                spin_deg: wild,
                travel_off_normal_deg: wild,
                dirt: Dirt::all(),
                bad_pose_station: Some(usize::MAX),
                decimals: Some(u8::MAX),
                mount,
                ..SimulationOptions::default()
            });
            let again = parse(to_json(&session).as_bytes(), "simulated");
            assert!(again.is_ok(), "{wild}: {again:?}");
        }
    }
}

#[test]
fn every_fault_changes_the_session_and_leaves_it_one_that_can_be_opened() {
    for mount in [Mount::OnFlange, Mount::Fixed] {
        let clean = SimulationOptions { num_steps: 3, num_points: 60, mount, ..SimulationOptions::default() };
        for fault in Fault::ALL {
            assert_eq!(Fault::by_id(fault.id()), Some(fault));
            let session = simulate(&SimulationOptions { fault: Some(fault), ..clean.clone() });
            assert_ne!(session, simulate(&clean), "{mount:?}, {}", fault.id());
            assert_eq!(session.truth, simulate(&clean).truth, "{mount:?}, {}", fault.id());
            let again = parse(to_json(&session).as_bytes(), "simulated");
            assert!(again.is_ok(), "{mount:?}, {}: {again:?}", fault.id());
        }
    }
}

#[test]
fn every_fault_bears_few_stations_and_missing_noise() {
    for num_stations in 0..3 {
        for fault in Fault::ALL {
            let options = SimulationOptions { num_stations, fault: Some(fault), ..SimulationOptions::noise_free() };
            assert_eq!(simulate(&options).stations.len(), num_stations, "{}", fault.id());
        }
    }
}

const PARTS: [PartKind; 5] = [PartKind::Plate, PartKind::Pin, PartKind::Square, PartKind::Teeth, PartKind::Cylinder];

/// A few stations of a part, exactly as its shape has it.
fn exact(kind: PartKind) -> SimulationOptions {
    let target = SimulationTarget::Part(kind);
    let num_steps = if target.is_workpiece() { 9 } else { 1 };
    SimulationOptions {
        num_stations: 3,
        num_steps,
        step_mm: 4.0,
        num_points: 200,
        ..SimulationOptions::of(target).without_noise()
    }
}

/// Calls `check` with every point of a station as it lies in the plate's frame, or in the world from the target for others.
fn for_each_point(session: &Session, mut check: impl FnMut(&Station, Vec3)) {
    let truth = session.truth.as_ref().expect("simulated");
    let world_from_target = truth
        .base_from_plate
        .unwrap_or_else(|| Rigid::from_parts(truth.target_in_base_mm.into(), so3::exp(Vec3::zeros())));
    for station in &session.stations {
        for capture in &station.captures {
            let world_from_carrier = match session.mount {
                Mount::OnFlange => *capture.base_from_flange.rigid(),
                Mount::Fixed => capture.base_from_flange.rigid().inverse(),
            };
            let target_from_sensor =
                world_from_target.inverse() * world_from_carrier * truth.flange_from_sensor.rigid();
            let points: Vec<Vec3> = match &capture.reading {
                Reading::Profile(profile) => profile.valid_points().map(|(_, x, z)| Vec3::new(x, 0.0, z)).collect(),
                Reading::Point(point) => vec![*point],
                Reading::Pose(_) => Vec::new(),
            };
            for point in points {
                check(station, (target_from_sensor * nalgebra::Point3::from(point)).coords);
            }
        }
    }
}

#[test]
fn reduced_points_lie_on_the_edges_and_on_the_point() {
    for (mount, z_towards_sensor) in [(Mount::OnFlange, false), (Mount::Fixed, false), (Mount::OnFlange, true)] {
        let points = |kind| SimulationOptions { has_points: true, mount, z_towards_sensor, ..exact(kind) };
        let mut places_mm = [Vec::new(), Vec::new()];
        for_each_point(&simulate(&points(PartKind::Plate)), |station, point| {
            let is_q = station.edge == Some(Edge::Q);
            let (along, off) = if is_q { (point.y, point.xz()) } else { (point.x, point.yz()) };
            assert!(off.norm() < EXACT_MM && (30.0..170.0).contains(&along), "{mount:?}, {}: {point}", station.label);
            places_mm[usize::from(is_q)].push(along);
        });
        assert!(places_mm.iter().all(|places| places.len() == 3 && (places[2] - places[0]).abs() > 60.0));
        for_each_point(&simulate(&points(PartKind::Pin)), |station, point| {
            assert!(point.norm() < EXACT_MM, "{mount:?}, {}: {point}", station.label);
        });
    }
}

#[test]
fn profiles_show_the_plate_and_the_table_below_it() {
    for mount in [Mount::OnFlange, Mount::Fixed] {
        let session = simulate(&SimulationOptions { mount, ..exact(PartKind::Plate) });
        let labels: Vec<&str> = session.stations.iter().map(|station| station.label.as_str()).collect();
        assert_eq!(labels, ["p1", "p2", "p3", "q1", "q2", "q3"]);
        let [mut num_top, mut num_table] = [0; 2];
        for_each_point(&session, |_, point| {
            let is_on_plate = point.x > -EXACT_MM && point.y > -EXACT_MM;
            num_top += usize::from(is_on_plate && point.z.abs() < EXACT_MM);
            num_table += usize::from(!is_on_plate && (point.z + 10.0).abs() < EXACT_MM);
            let is_on_side = is_on_plate && point.x.min(point.y) < EXACT_MM && (-10.0..0.0).contains(&point.z);
            assert!(is_on_side || point.z.abs() < EXACT_MM || (point.z + 10.0).abs() < EXACT_MM, "{point}");
        });
        assert!(num_top > 6 * 70 && num_table > 6 * 70, "{num_top} and {num_table}");
    }
}

#[test]
fn the_pins_profile_peaks_in_its_point() {
    let mut highest = Vec3::repeat(f64::NEG_INFINITY);
    for_each_point(&simulate(&exact(PartKind::Pin)), |_, point| {
        if point.z > highest.z {
            highest = point;
        }
    });
    // Half a pitch of 0.2 mm on a flank of 40°.
    assert!(highest.norm() < 0.25, "{highest}");
}

#[test]
fn every_target_can_be_saved_and_gives_the_same_bytes_again() {
    for kind in PARTS {
        let options = SimulationOptions {
            num_stations: 2,
            num_steps: 3,
            num_points: 50,
            dirt: Dirt::all(),
            decimals: Some(3),
            further: vec![SimulationTarget::Part(PartKind::Pin), SimulationTarget::Part(PartKind::Pin)],
            ..SimulationOptions::of(SimulationTarget::Part(kind))
        };
        let session = simulate(&options);
        let saved = to_json(&session);
        assert_eq!(to_json(&simulate(&options)), saved, "{kind:?}");
        let again = parse(saved.as_bytes(), "simulated").unwrap_or_else(|error| panic!("{kind:?}: {error}"));
        assert_eq!(again.known, session.known);
        assert_eq!(to_json(&again), saved, "{kind:?}");
        let names: Vec<&str> = again.further.iter().map(|further| further.name.as_str()).collect();
        assert_eq!(names, ["point", "point (2)"]);
        assert_ne!(again.further[0].stations, again.further[1].stations, "each has noise of its own");
    }
}

#[test]
fn wild_options_of_every_target_give_a_session_that_can_be_opened() {
    for kind in PARTS {
        for wild in [f64::NAN, f64::INFINITY, -1e300, 0.0, 1e300] {
            let session = simulate(&SimulationOptions {
                num_stations: 2,
                num_steps: 2,
                num_points: 0,
                step_mm: wild,
                profile_std_mm: wild,
                position_std_mm: wild,
                orientation_std_deg: wild,
                tilt_deg: wild,
                spin_deg: wild,
                aim_std_mm: wild,
                touch_std_mm: wild,
                rough_mounting: Some(RoughMounting { off_deg: wild, off_mm: wild }),
                bad_pose_station: Some(usize::MAX),
                fault: Some(Fault::Drift),
                ..SimulationOptions::of(SimulationTarget::Part(kind))
            });
            let again = parse(to_json(&session).as_bytes(), "simulated");
            assert!(again.is_ok(), "{kind:?}, {wild}: {again:?}");
        }
    }
}

#[test]
fn captures_at_one_place_have_one_pose_and_noise_of_their_own() {
    let plate = SimulationOptions::of(SimulationTarget::Part(PartKind::Plate));
    let session = simulate(&SimulationOptions { num_steps: 2, num_points: 60, ..plate });
    for station in &session.stations {
        let [first, second] = station.captures.as_slice() else { panic!("two captures") };
        assert_eq!((first.base_from_flange, second.step_mm), (second.base_from_flange, None));
        assert_ne!(first.reading, second.reading);
    }
}

#[test]
fn the_rough_mounting_is_off_as_far_as_was_asked_for() {
    let session = simulate(&SimulationOptions::of(SimulationTarget::Part(PartKind::Plate)));
    let rough = session.sensor.rough_flange_from_sensor.expect("given for a plate");
    let exact = session.truth.expect("simulated").flange_from_sensor;
    assert!(((rough.translation_mm() - exact.translation_mm()).norm() - 10.0).abs() < 1e-3);
    assert!((rough.rotation().angle_to(&exact.rotation()).to_degrees() - 5.0).abs() < 1e-3);
}

#[test]
fn scans_follow_the_part_at_their_step() {
    for kind in [PartKind::Square, PartKind::Teeth, PartKind::Cylinder] {
        let options = exact(kind);
        let session = simulate(&options);
        assert_eq!(session.target, Target::Workpiece);
        for pair in session.stations.iter().flat_map(|station| station.captures.windows(2)) {
            let moved = pair[1].base_from_flange.translation_mm() - pair[0].base_from_flange.translation_mm();
            assert!((moved.norm() - 4.0).abs() < EXACT_MM && pair[1].step_mm == Some(4.0));
        }
    }
    let usual = SimulationOptions::of(SimulationTarget::Part(PartKind::Square));
    assert_eq!(usual.num_steps, 181, "60 mm at 0.33 mm");
}

#[test]
fn exact_points_of_a_plate_and_of_a_pin_give_the_true_calibration() {
    for (kind, mount) in
        [PartKind::Plate, PartKind::Pin].into_iter().flat_map(|kind| [(kind, Mount::OnFlange), (kind, Mount::Fixed)])
    {
        let session = simulate(&SimulationOptions { num_stations: 9, has_points: true, mount, ..exact(kind) });
        let measured = measure(&session, None, &mut Unwatched).expect("not cancelled");
        let problem = session::problem(&session, &measured).expect("a target to calibrate from");
        let truth = session.truth.as_ref().expect("simulated").flange_from_sensor;
        for method in problem.methods() {
            let found = problem.solve(*method).unwrap_or_else(|error| panic!("{kind:?}, {method:?}: {error}"));
            let off_mm = (found.flange_from_sensor.translation_mm() - truth.translation_mm()).norm();
            let off_deg = found.flange_from_sensor.rotation().angle_to(&truth.rotation()).to_degrees();
            // What is asked of the methods on exact data.
            assert!(off_mm < 1e-6 && off_deg < 1e-7, "{kind:?}, {mount:?}, {method:?}: {off_mm} mm, {off_deg}°");
        }
    }
}
