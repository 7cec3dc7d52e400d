//! Session files under random sessions and random damage.
#![expect(clippy::expect_used, reason = "a test that finds nothing to check must fail")]

use std::sync::Arc;

use handeye::calibrate::{Mount, Side, SideChoice};
use handeye::geometry::notation::{AngleUnit, LengthUnit, OrientationForm};
use handeye::geometry::{Base, Flange, PoseConvention, PoseNotation, Profile, Transform, Vec3, so3};
use handeye::session::{
    Capture, Known, Published, Reading, Robot, Sensor, Session, Station, Target, Truth, WrittenAngles, parse, to_json,
};
use proptest::prelude::*;

/// A small session with every kind of field.
const VALID: &str = include_str!("data/every_field.json");

fn pose() -> impl Strategy<Value = Transform<Base, Flange>> {
    (prop::array::uniform3(-1e6..1e6), prop::array::uniform3(-3.0..3.0)).prop_map(|(translation, rotation_vector)| {
        let rotation = so3::exp(Vec3::from(rotation_vector));
        let sign = if rotation.w < 0.0 { -1.0 } else { 1.0 };
        Transform::from_parts(
            Vec3::from(translation),
            nalgebra::UnitQuaternion::new_unchecked(rotation.into_inner() * sign),
        )
    })
}

fn convention() -> impl Strategy<Value = &'static PoseConvention> {
    prop::sample::select(PoseConvention::all().collect::<Vec<_>>())
}

fn notation() -> impl Strategy<Value = PoseNotation> {
    let orientations = [OrientationForm::Angles, OrientationForm::QuaternionWxyz, OrientationForm::QuaternionXyzw];
    let tool_point = prop::option::of(pose().prop_map(|pose| Transform::from_rigid(*pose.rigid())));
    (convention(), prop::sample::select(orientations.to_vec()), any::<[bool; 3]>(), tool_point).prop_map(
        |(convention, orientation, [in_radians, in_metres, is_inverse], flange_from_tcp)| PoseNotation {
            convention,
            orientation,
            angle_unit: if in_radians { AngleUnit::Radians } else { AngleUnit::Degrees },
            length_unit: if in_metres { LengthUnit::Metres } else { LengthUnit::Millimetres },
            flange_from_tcp,
            is_inverse,
        },
    )
}

fn reading() -> impl Strategy<Value = Reading> {
    let point = prop::array::uniform3(-1e5..1e5).prop_map(|point| Reading::Point(Vec3::from(point)));
    let coordinate = prop_oneof![-1e5..1e5, Just(0.0), Just(-1e-300), Just(1e-9), Just(0.1)];
    let profile = prop::collection::vec((coordinate.clone(), prop::option::of(coordinate)), 0..12).prop_map(|points| {
        let (x_mm, z_mm): (Vec<f64>, Vec<Option<f64>>) = points.into_iter().unzip();
        Reading::Profile(Arc::new(Profile::new(x_mm, &z_mm).expect("within limits")))
    });
    prop_oneof![point, profile]
}

fn station() -> impl Strategy<Value = Station> {
    let written = (prop::array::uniform3(-36_000.0..36_000.0), convention())
        .prop_map(|(angles_deg, convention)| WrittenAngles { angles_deg, convention });
    let capture = (pose(), prop::option::of(written), reading(), prop::option::of(-1e3..1e3)).prop_map(
        |(base_from_flange, written_angles, reading, step_mm)| Capture {
            base_from_flange,
            written_angles,
            reading,
            step_mm,
            unknown: serde_json::Map::new(),
        },
    );
    let side =
        prop_oneof![Just(SideChoice::Auto), Just(SideChoice::Given(Side::Plus)), Just(SideChoice::Given(Side::Minus))];
    (any::<bool>(), side, prop::collection::vec(capture, 1..4)).prop_map(|(enabled, side, captures)| Station {
        label: String::new(),
        enabled,
        side,
        edge: None,
        captures,
        unknown: serde_json::Map::new(),
    })
}

prop_compose! {
    fn session()(
        name in any::<String>(),
        notes in any::<String>(),
        position_std_mm in prop::option::of(1e-3..1.0),
        notation in notation(),
        radius_mm in 1e-3..1e4,
        is_fixed in any::<bool>(),
        mut stations in prop::collection::vec(station(), 0..4),
        true_pose in prop::option::of(pose()),
        is_published in any::<bool>(),
        key in "[a-z]{3} \\PC{0,5}",
    ) -> Session {
        for (idx, station) in stations.iter_mut().enumerate() {
            station.label = format!("{idx}°");
        }
        let published = is_published.then(|| Published {
            target_in_base_mm: stations.iter().map(|_| Vec3::new(0.1, -0.2, 1e-17)).collect(),
            ..Published::default()
        });
        let mut unknown = serde_json::Map::new();
        unknown.insert(key, serde_json::json!({"deep": [1, null, "text", 0.1]}));
        Session {
            name,
            notes,
            robot: Robot { position_std_mm, notation, ..Robot::default() },
            sensor: Sensor::default(),
            target: Target::Ball { radius_mm, radius_std_mm: position_std_mm },
            known: Known::default(),
            further: Vec::new(),
            mount: if is_fixed { Mount::Fixed } else { Mount::OnFlange },
            stations,
            published,
            truth: true_pose.map(|pose| Truth {
                flange_from_sensor: Transform::from_rigid(*pose.rigid()),
                target_in_base_mm: Vec3::new(1.0, 2.0, 0.3),
                base_from_plate: None,
                unknown: serde_json::Map::new(),
            }),
            unknown,
        }
    }
}

/// Mostly text and digits: with any byte at all, nearly every file would be refused for not being UTF-8.
fn damage() -> impl Strategy<Value = u8> {
    prop_oneof![1 => any::<u8>(), 4 => b' '..=b'~', 4 => b'0'..=b'9']
}

proptest! {
    #[test]
    fn any_session_comes_back_as_it_was_saved(session in session()) {
        let json = to_json(&session);
        let again = parse(json.as_bytes(), "random.json");
        prop_assert_eq!(again.as_ref(), Ok(&session), "{}", json);
        prop_assert_eq!(to_json(&session), json);
    }

    #[test]
    fn no_change_of_a_few_bytes_makes_it_panic_or_break_the_line(
        changes in prop::collection::vec((any::<prop::sample::Index>(), damage(), 0..3_u8), 1..4),
    ) {
        let mut bytes = VALID.as_bytes().to_vec();
        for (index, byte, kind) in changes {
            let at = index.index(bytes.len());
            match kind {
                0 => bytes[at] = byte,
                1 => bytes.insert(at, byte),
                _ => { bytes.remove(at); }
            }
        }
        match parse(&bytes, "mutated.json") {
            Ok(session) => prop_assert_eq!(parse(to_json(&session).as_bytes(), "again.json"), Ok(session)),
            Err(refusal) => prop_assert!(!refusal.to_string().contains('\n')),
        }
    }

    #[test]
    fn no_swap_of_one_word_for_another_makes_it_panic(
        at in any::<prop::sample::Index>(),
        instead in prop::sample::select(vec!["null", "1e308", "-0.0", "{}", "[]", "\"\"", "[[[]]]", "1e-320", "99999999999999999999", "\"\\ud800\""]),
    ) {
        let words: Vec<&str> = VALID.split_inclusive([' ', ',', '[', ']', '{', '}']).collect();
        let at = at.index(words.len());
        let swapped: String = words.iter().enumerate().map(|(idx, word)| if idx == at { instead } else { word }).collect();
        if let Ok(session) = parse(swapped.as_bytes(), "swapped.json") {
            prop_assert_eq!(parse(to_json(&session).as_bytes(), "again.json"), Ok(session));
        }
    }
}
