//! Session files under random sessions and random damage.
#![expect(clippy::expect_used, reason = "a test that finds nothing to check must fail")]

use std::sync::Arc;

use handeye::calibrate::{Mount, Side, SideChoice};
use handeye::geometry::notation::{AngleUnit, LengthUnit, OrientationForm};
use handeye::geometry::{Base, Flange, PoseConvention, PoseNotation, Profile, Transform, Vec3, so3};
use handeye::session::{
    Capture, Edge, FurtherTarget, Known, Published, Reading, Robot, Sensor, Session, Station, Target, Truth,
    WrittenAngles, parse, to_json,
};
use proptest::prelude::*;

/// Small sessions with every kind of field.
const VALID: [&str; 2] = [include_str!("data/every_field.json"), include_str!("data/every_target.json")];

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
    let seen = pose().prop_map(|pose| Reading::Pose(Transform::from_rigid(*pose.rigid())));
    prop_oneof![point, profile, seen]
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

fn size() -> impl Strategy<Value = Option<f64>> {
    prop::option::of(1e-3..1e4)
}

/// A target with stations, what is known of it, and whether its stations saw edges.
fn target() -> impl Strategy<Value = (Target, Known)> {
    let position = prop::array::uniform3(-1e6..1e6).prop_map(Vec3::from);
    let sizes = (prop::option::of(0.0..180.0), size(), size(), size());
    prop_oneof![
        (1e-3..1e4, prop::option::of(1e-6..100.0))
            .prop_map(|(radius_mm, radius_std_mm)| (Target::Ball { radius_mm, radius_std_mm }, Known::default())),
        Just((Target::RightAnglePlate, Known::default())),
        (prop::option::of(1e-6..100.0), prop::option::of(1e-6..90.0)).prop_map(
            |(translation_std_mm, rotation_std_deg)| {
                (Target::Pose { translation_std_mm, rotation_std_deg }, Known::default())
            }
        ),
        prop::option::of(position)
            .prop_map(|point_in_base_mm| (Target::Point, Known { point_in_base_mm, ..Known::default() })),
        sizes.prop_map(|(angle_deg, pitch_mm, height_mm, diameter_mm)| {
            let sizes = Known { angle_deg, pitch_mm, height_mm, diameter_mm, point_in_base_mm: None };
            (Target::Workpiece, sizes)
        }),
    ]
}

fn labelled(mut stations: Vec<Station>, target: &Target) -> Vec<Station> {
    for (idx, station) in stations.iter_mut().enumerate() {
        station.label = format!("{idx}°");
        station.edge = (*target == Target::RightAnglePlate).then_some(if idx % 2 == 0 { Edge::P } else { Edge::Q });
    }
    stations
}

fn further() -> impl Strategy<Value = FurtherTarget> {
    let std = prop::option::of(1e-3..1.0);
    (target(), std, prop::collection::vec(station(), 0..3)).prop_map(|((target, known), profile_std_mm, stations)| {
        FurtherTarget {
            name: String::new(),
            stations: labelled(stations, &target),
            target,
            known,
            profile_std_mm,
            unknown: serde_json::Map::from_iter([("their".to_owned(), serde_json::json!([1]))]),
        }
    })
}

prop_compose! {
    fn session()(
        name in any::<String>(),
        notes in any::<String>(),
        position_std_mm in prop::option::of(1e-3..1.0),
        notation in notation(),
        (target, known) in target(),
        rough in prop::option::of(pose()),
        mut further in prop::collection::vec(further(), 0..3),
        is_fixed in any::<bool>(),
        stations in prop::collection::vec(station(), 0..4),
        true_pose in prop::option::of(pose()),
        is_published in any::<bool>(),
        key in "[a-z]{3} \\PC{0,5}",
    ) -> Session {
        let stations = labelled(stations, &target);
        for (idx, further) in further.iter_mut().enumerate() {
            further.name = format!("target {idx}");
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
            sensor: Sensor {
                rough_flange_from_sensor: rough.map(|pose| Transform::from_rigid(*pose.rigid())),
                ..Sensor::default()
            },
            mount: if is_fixed { Mount::Fixed } else { Mount::OnFlange },
            stations,
            published,
            truth: true_pose.map(|pose| Truth {
                flange_from_sensor: Transform::from_rigid(*pose.rigid()),
                target_in_base_mm: match target {
                    Target::RightAnglePlate | Target::Pose { .. } => pose.translation_mm(),
                    Target::Workpiece => Vec3::zeros(),
                    _ => Vec3::new(1.0, 2.0, 0.3),
                },
                base_from_plate: (target == Target::RightAnglePlate).then(|| *pose.rigid()),
                base_from_target: target.is_pose().then(|| *pose.rigid()),
                unknown: serde_json::Map::new(),
            }),
            target,
            known,
            further,
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
        valid in prop::sample::select(&VALID[..]),
        changes in prop::collection::vec((any::<prop::sample::Index>(), damage(), 0..3_u8), 1..4),
    ) {
        let mut bytes = valid.as_bytes().to_vec();
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
        valid in prop::sample::select(&VALID[..]),
        at in any::<prop::sample::Index>(),
        instead in prop::sample::select(vec!["null", "1e308", "-0.0", "{}", "[]", "\"\"", "[[[]]]", "1e-320", "99999999999999999999", "\"\\ud800\""]),
    ) {
        let words: Vec<&str> = valid.split_inclusive([' ', ',', '[', ']', '{', '}']).collect();
        let at = at.index(words.len());
        let swapped: String = words.iter().enumerate().map(|(idx, word)| if idx == at { instead } else { word }).collect();
        if let Ok(session) = parse(swapped.as_bytes(), "swapped.json") {
            prop_assert_eq!(parse(to_json(&session).as_bytes(), "again.json"), Ok(session));
        }
    }
}
