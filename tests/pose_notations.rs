//! Every convention and every way to write a pose: there and back, and against formulas and programs of others.
#![expect(clippy::expect_used, reason = "a test that finds nothing to check must fail")]

use std::f64::consts::PI;

use handeye::geometry::notation::{AngleUnit, LengthUnit, OrientationForm};
use handeye::geometry::{AngleOrder, Axis, Base, Flange, PoseConvention, PoseNotation, Tcp, Transform, Vec3, so3};
use handeye::session::{self, Edit, EditRefusal, samples};
use nalgebra::{Quaternion, UnitQuaternion};
use proptest::prelude::*;
use serde_json::Value;

/// What the project promises for a rotation that becomes numbers and a rotation again.
const ROUND_TRIP_DEG: f64 = 1e-9;
/// The files of the other programs' numbers are rounded to 13 digits behind the point.
const OTHERS_DEG: f64 = 1e-10;

const OTHER_PROGRAMS: &str = include_str!("data/orientations_by_other_programs.json");
const DOCS: &str = include_str!("../docs/conventions.md");

fn about(axis: Axis, angle: f64) -> UnitQuaternion<f64> {
    let axis = match axis {
        Axis::X => Vec3::x_axis(),
        Axis::Y => Vec3::y_axis(),
        Axis::Z => Vec3::z_axis(),
    };
    UnitQuaternion::from_axis_angle(&axis, angle)
}

/// In degrees; of the angle between two near quaternions the arc cosine would lose half of the digits.
fn apart_deg(first: &UnitQuaternion<f64>, second: &UnitQuaternion<f64>) -> f64 {
    so3::log(&(first.inverse() * second)).norm().to_degrees()
}

#[track_caller]
fn check_round_trip(convention: &PoseConvention, rotation: &UnitQuaternion<f64>) {
    let angles = convention.angles_deg_from_rotation(rotation);
    let back = convention.rotation_from_angles_deg(angles);
    let apart = apart_deg(rotation, &back);
    assert!(apart < ROUND_TRIP_DEG, "{}: {rotation} became {angles:?}, which is {apart}° off", convention.id);
}

fn rotation() -> impl Strategy<Value = UnitQuaternion<f64>> {
    prop::array::uniform4(-1.0..1.0_f64)
        .prop_filter("a direction", |parts| parts.iter().map(|part| part * part).sum::<f64>() > 1e-6)
        .prop_map(|[w, x, y, z]| UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z)))
}

fn convention() -> impl Strategy<Value = &'static PoseConvention> {
    prop::sample::select(PoseConvention::all().collect::<Vec<_>>())
}

prop_compose! {
    fn notation()(
        convention in convention(),
        orientation in prop::sample::select(
            vec![OrientationForm::Angles, OrientationForm::QuaternionWxyz, OrientationForm::QuaternionXyzw]
        ),
        angle_unit in prop::sample::select(vec![AngleUnit::Degrees, AngleUnit::Radians]),
        length_unit in prop::sample::select(vec![LengthUnit::Millimetres, LengthUnit::Metres]),
        tool_point in prop::option::of((prop::array::uniform3(-500.0..500.0), rotation())),
        is_inverse in any::<bool>(),
    ) -> PoseNotation {
        let flange_from_tcp = tool_point
            .map(|(offset_mm, rotation)| Transform::<Flange, Tcp>::from_parts(Vec3::from(offset_mm), rotation));
        PoseNotation { convention, orientation, angle_unit, length_unit, flange_from_tcp, is_inverse }
    }
}

proptest! {
    #[test]
    fn any_rotation_comes_back_in_every_convention(rotation in rotation()) {
        for convention in PoseConvention::all() {
            check_round_trip(convention, &rotation);
        }
    }

    #[test]
    fn any_pose_comes_back_in_every_notation(
        position_mm in prop::array::uniform3(-4000.0..4000.0),
        rotation in rotation(),
        notation in notation(),
    ) {
        let base_from_flange = Transform::<Base, Flange>::from_parts(Vec3::from(position_mm), rotation);
        let numbers = notation.numbers(&base_from_flange);
        let again = notation.base_from_flange(&numbers).expect("its own numbers");
        let apart_mm = (again.translation_mm() - base_from_flange.translation_mm()).norm();
        prop_assert!(apart_mm < 1e-9, "{apart_mm} mm");
        prop_assert!(apart_deg(&again.rotation(), &rotation) < ROUND_TRIP_DEG);
        prop_assert!(again.rotation().w >= 0.0, "the quaternion that files hold, so that saving changes nothing");
    }
}

/// Rotations for which the first and the third axis of some order coincide, exactly and nearly, and half turns.
#[test]
fn gimbal_lock_half_turns_and_the_identity_come_back_in_every_convention() {
    let off = [0.0, 1e-3, 1e-6, 1e-9, 1e-12, 1e-15];
    let ends = [0.0, 0.7, -2.2, PI];
    for order in AngleOrder::ALL {
        let AngleOrder::Intrinsic([i, j, k]) = order else { continue };
        let locks = if order.is_proper_euler() { [0.0, PI] } else { [PI / 2.0, -PI / 2.0] };
        for lock in locks {
            for middle in off.into_iter().flat_map(|off| [lock + off, lock - off]) {
                for (a, c) in ends.into_iter().flat_map(|a| ends.map(|c| (a, c))) {
                    let rotation = about(i, a) * about(j, middle) * about(k, c);
                    for convention in PoseConvention::all() {
                        check_round_trip(convention, &rotation);
                    }
                }
            }
        }
    }
    for convention in PoseConvention::all() {
        check_round_trip(convention, &UnitQuaternion::identity());
        for axis in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.6, 0.8, 0.0], [-0.48, 0.6, 0.64]] {
            for angle in off.into_iter().flat_map(|off| [PI - off, PI + off, off]) {
                check_round_trip(convention, &so3::exp(Vec3::from(axis) * angle));
            }
        }
    }
}

/// The formula as people read it, multiplied out: `Rz(R) Ry(P) Rx(W)` with the names of the pendant.
#[test]
fn every_formula_says_what_its_convention_computes() {
    for convention in PoseConvention::all() {
        for angles_deg in [[10.0, 20.0, 30.0], [-130.0, 62.0, 175.0], [5.0, -80.0, -44.0]] {
            let by_formula = if convention.formula == "rotation vector" {
                UnitQuaternion::from_scaled_axis(Vec3::from(angles_deg.map(f64::to_radians)))
            } else {
                multiplied_out(convention, angles_deg)
            };
            let apart = apart_deg(&by_formula, &convention.rotation_from_angles_deg(angles_deg));
            // Rounding of three products.
            assert!(apart < 1e-12, "{}: {apart}°", convention.id);
        }
    }
}

fn multiplied_out(convention: &PoseConvention, angles_deg: [f64; 3]) -> UnitQuaternion<f64> {
    convention.formula.split(") ").fold(UnitQuaternion::identity(), |product, factor| {
        let (axis, name) = factor.trim_end_matches(')').split_once('(').expect("Rz(name)");
        let axis = match axis {
            "Rx" => Axis::X,
            "Ry" => Axis::Y,
            "Rz" => Axis::Z,
            _ => panic!("{}: {factor}", convention.id),
        };
        let place =
            convention.angle_names.iter().position(|angle_name| *angle_name == name).expect("a name of the pendant");
        product * about(axis, angles_deg[place].to_radians())
    })
}

#[test]
fn other_programs_write_the_same_numbers() {
    let file: Value = serde_json::from_str(OTHER_PROGRAMS).expect("JSON");
    let robodk = &file["robodk"];
    let rotations = quaternions(&robodk["quaternions_wxyz"]);
    for row in rows(&robodk["conventions"]) {
        let convention = convention_of(row);
        let angles = triples(&row["angles_deg"]);
        assert_eq!(angles.len(), rotations.len());
        for (rotation, theirs) in rotations.iter().zip(angles) {
            check_agreement(convention, rotation, theirs);
        }
    }
    let robtarget = PoseNotation { orientation: OrientationForm::QuaternionWxyz, ..PoseNotation::default() };
    for (rotation, theirs) in rotations.iter().zip(quaternions(&robodk["abb_robtarget_q1_to_q4"])) {
        let numbers = robtarget.numbers(&Transform::from_parts(Vec3::zeros(), *rotation));
        let [w, x, y, z] = [numbers[3], numbers[4], numbers[5], numbers[6]];
        let ours = UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z));
        assert!(apart_deg(&ours, &theirs) < OTHERS_DEG);
    }
    let mut of_scipy = Vec::new();
    for row in rows(&file["scipy"]["conventions"]) {
        let convention = convention_of(row);
        of_scipy.push(convention.id);
        for (theirs, rotation) in triples(&row["angles_deg"]).into_iter().zip(quaternions(&row["quaternions_wxyz"])) {
            check_agreement(convention, &rotation, theirs);
        }
    }
    for order in AngleOrder::ALL {
        assert!(of_scipy.contains(&PoseConvention::neutral(order).id), "{order} is not compared");
    }
}

#[track_caller]
fn check_agreement(convention: &PoseConvention, rotation: &UnitQuaternion<f64>, theirs_deg: [f64; 3]) {
    let apart = apart_deg(rotation, &convention.rotation_from_angles_deg(theirs_deg));
    assert!(apart < OTHERS_DEG, "{}: their numbers {theirs_deg:?} are {apart}° off", convention.id);
    let ours_deg = convention.angles_deg_from_rotation(rotation);
    for (ours, theirs) in ours_deg.into_iter().zip(theirs_deg) {
        let difference = (ours - theirs + 540.0).rem_euclid(360.0) - 180.0;
        assert!(difference.abs() < OTHERS_DEG, "{}: {ours_deg:?} here, {theirs_deg:?} there", convention.id);
    }
}

fn rows(value: &Value) -> &[Value] {
    value.as_array().expect("a list")
}

fn convention_of(row: &Value) -> &'static PoseConvention {
    let id = row["id"].as_str().expect("an id");
    PoseConvention::by_id(id).unwrap_or_else(|| panic!("{id}"))
}

fn numbers_of<const N: usize>(value: &Value) -> Vec<[f64; N]> {
    let one = |row: &Value| {
        let numbers: Vec<f64> = rows(row).iter().map(|number| number.as_f64().expect("a number")).collect();
        numbers.try_into().expect("so many numbers")
    };
    rows(value).iter().map(one).collect()
}

fn triples(value: &Value) -> Vec<[f64; 3]> {
    numbers_of::<3>(value)
}

fn quaternions(value: &Value) -> Vec<UnitQuaternion<f64>> {
    let unit = |[w, x, y, z]: [f64; 4]| UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z));
    numbers_of::<4>(value).into_iter().map(unit).collect()
}

#[test]
fn a_tool_point_that_could_not_be_saved_is_refused() {
    let sample = &samples::ALL[0];
    let session = session::parse(sample.json.as_bytes(), sample.file_name).expect("a session");
    let flange_from_tcp = Some(Transform::from_parts(Vec3::new(0.0, 0.0, 1e7), UnitQuaternion::identity()));
    let notation = PoseNotation { flange_from_tcp, ..session.robot.notation };
    for edit in [Edit::SwitchNotation(notation), Edit::Reinterpret(notation)] {
        let refusal = edit.apply(&session).expect_err("ten kilometres");
        assert!(matches!(refusal, EditRefusal::OutOfRange { .. }), "{refusal}");
    }
}

#[test]
fn switching_keeps_every_pose_and_reinterpreting_back_and_forth_as_well() {
    let sample = samples::ALL.iter().find(|sample| sample.file_name == "few-rotations.json").expect("a sample");
    let session = session::parse(sample.json.as_bytes(), sample.file_name).expect("a session");
    for convention in PoseConvention::all() {
        let notation = PoseNotation { length_unit: LengthUnit::Metres, ..PoseNotation::usual(convention) };
        let switched = Edit::SwitchNotation(notation).apply(&session).expect("any notation");
        assert_eq!(switched.stations, session.stations, "{}", convention.id);
        let misread = PoseNotation::of(convention);
        let wrong = Edit::Reinterpret(misread).apply(&session).expect("angles");
        let again = Edit::Reinterpret(session.robot.notation).apply(&wrong).expect("angles");
        for (was, is) in session.stations.iter().zip(&again.stations) {
            for (was, is) in was.captures.iter().zip(&is.captures) {
                let (was, is) = (&was.base_from_flange, &is.base_from_flange);
                assert!(apart_deg(&was.rotation(), &is.rotation()) < ROUND_TRIP_DEG, "{}", convention.id);
                assert!((was.translation_mm() - is.translation_mm()).norm() < 1e-9, "{}", convention.id);
            }
        }
        let saved = session::to_json(&wrong);
        assert_eq!(session::parse(saved.as_bytes(), "again.json"), Ok(wrong), "{}", convention.id);
    }
}

#[test]
fn the_table_of_the_docs_lists_every_convention_as_it_is() {
    for convention in PoseConvention::all() {
        let row = DOCS
            .lines()
            .find(|line| line.starts_with(&format!("| `{}` |", convention.id)))
            .unwrap_or_else(|| panic!("docs/conventions.md has no row for {}", convention.id));
        let names = convention.angle_names.join(" ");
        for part in [names.as_str(), convention.formula] {
            assert!(row.contains(part), "{part:?} is not in the row {row}");
        }
    }
}
