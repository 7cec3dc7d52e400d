//! Each format by an example worked out by hand, and all of them by random and singular poses.

use std::f64::consts::PI;

use proptest::prelude::*;

use super::*;
use crate::geometry::so3;

fn frame(translation_mm: [f64; 3], rotation_vector: [f64; 3]) -> ToolFrame {
    ToolFrame {
        flange_from_sensor: Transform::from_parts(translation_mm.into(), so3::exp(rotation_vector.into())),
        parent: Parent::Flange,
        name: Name::from_words("scan"),
        number: 2,
        is_camera: false,
        std_mm_deg: None,
    }
}

/// A quarter turn about z: sensor x along flange y.
fn quarter_turn() -> ToolFrame {
    frame([10.0, -20.5, 125.25], [0.0, 0.0, PI / 2.0])
}

#[test]
fn the_examples_worked_out_by_hand_are_met() {
    // A quarter turn about z: W P R = 0 0 90, A B C = 90 0 0, quaternion cos 45°, 0, 0, sin 45°.
    let examples = [
        ("fanuc-ls", "   5:  PR[81,2]=(-20.500) ;\n   6:  PR[81,3]=125.250 ;\n   7:  PR[81,4]=0.0000 ;\n"),
        ("fanuc-ls", "   9:  PR[81,6]=90.0000 ;\n  10:  UTOOL[2]=PR[81] ;\n"),
        (
            "fanuc-rmi",
            "\"ToolNumber\":2,\"Frame\":{\"X\":10.000,\"Y\":-20.500,\"Z\":125.250,\"W\":0.0000,\"P\":0.0000,\"R\":90.0000}}",
        ),
        (
            "abb-rapid",
            "PERS tooldata scan:=[TRUE,[[10.000,-20.500,125.250],[0.70710678,0.00000000,0.00000000,0.70710678]],",
        ),
        (
            "kuka-config",
            "TOOL_DATA[2]={X 10.000,Y -20.500,Z 125.250,A 90.0000,B 0.0000,C 0.0000}\nTOOL_NAME[2,]=\"scan\"\n",
        ),
        ("ur-script", "set_tcp(p[0.010000,-0.020500,0.125250,0.0000000,0.0000000,1.5707963])"),
        ("yaskawa-inform", "SETE P00100 (2) -20500\n"),
        ("yaskawa-inform", "SETE P00100 (6) 900000\nSETTOOL TL#(2) P00100\n"),
        ("yaskawa-dx100", "SETE P00100 (6) 9000\n"),
        (
            "staubli-val3",
            "x=\"10.000\" y=\"-20.500\" z=\"125.250\" rx=\"0.0000\" ry=\"0.0000\" rz=\"90.0000\" fatherId=\"flange[0]\"",
        ),
        (
            "ros2-command",
            "--x 0.010000 --y -0.020500 --z 0.125250 --qx 0.00000000 --qy 0.00000000 --qz 0.70710678 --qw 0.70710678 --frame-id tool0 --child-frame-id scan\n",
        ),
        ("urdf", "<origin xyz=\"0.010000 -0.020500 0.125250\" rpy=\"0.0000000 0.0000000 1.5707963\"/>"),
        ("matrix", "0.000000000 -1.000000000 0.000000000 10.000\n1.000000000 0.000000000 0.000000000 -20.500\n"),
        ("matrix-column-major", "0.000000000 1.000000000 0.000000000 0\n-1.000000000 0.000000000 0.000000000 0\n"),
        ("quaternion-xyzw", "0.00000000 0.00000000 0.70710678 0.70710678\n"),
        ("elite-rxryrz", "Rz = 1.5707963\n"),
        ("epson-uvw", "U = 90.0000\nV = 0.0000\nW = 0.0000\n"),
    ];
    for (id, expected) in examples {
        let text = Format::by_id(id).expect(id).write(&quarter_turn());
        assert!(text.contains(expected), "{id}: no “{expected}” in\n{text}");
    }
}

#[test]
fn every_text_says_its_convention_or_has_no_place_for_it() {
    for format in formats() {
        let text = format.write(&quarter_turn());
        if let Some(convention) = format.convention.filter(|_| format.has_comments()) {
            assert!(text.contains(convention.formula), "{}:\n{text}", format.id);
        }
        assert!(format.group != Group::Controller || text.replace("ä", "").is_ascii(), "{}:\n{text}", format.id);
        assert!(!text.contains("NaN"), "{}:\n{text}", format.id);
    }
}

#[test]
fn names_are_told_apart() {
    let ids: Vec<_> = formats().map(|format| format.id).collect();
    let distinct: std::collections::HashSet<_> = ids.iter().collect();
    assert_eq!(distinct.len(), ids.len());
    assert!(formats().all(|format| Format::by_id(format.id).is_some_and(|found| found.label == format.label)));
}

#[test]
fn names_suit_every_language() {
    let cases =
        [("Ball 15 mm, cell 3", "Ball_15_mm_cell_"), ("", "scanner"), ("3D", "s_3D"), ("ä", "scanner"), ("a", "a")];
    for (words, expected) in cases {
        assert_eq!(Name::from_words(words).as_str(), expected);
    }
}

#[test]
fn another_text_is_refused_with_what_stands_there() {
    let format = Format::by_id("ur-script").expect("it is in the table");
    let cases = [
        ("set_tcp(q[0,0,0,0,0,0])", "found “q[0,0,0,0,0,0])”"),
        ("set_tcp(p[0,0,zero,0,0,0])", "found “zero,0,0,0])”"),
        ("set_tcp(p[0,0,inf,0,0,0])", "number"),
        ("set_tcp(p[0,0,0,0,0,0])\nset_tcp(p[0,0,0,0,0,0])", "the end"),
        ("", "found “”"),
    ];
    for (text, expected) in cases {
        let refusal = format.read(text).expect_err(text).to_string();
        assert!(refusal.contains(expected), "{refusal}");
    }
    let zero = "0 0 0 0 0 0 0\n";
    let quaternion = Format::by_id("quaternion-wxyz").expect("it is in the table");
    assert_eq!(quaternion.read(zero), Err(NotThisFormat::NoRotation));
}

#[test]
fn a_fixed_sensor_is_no_tool() {
    let of_base = formats().filter(|format| format.suits(Parent::Base));
    assert!(of_base.clone().all(|format| format.group != Group::Controller && !format.id.starts_with("easy")));
    let fixed = ToolFrame { parent: Parent::Base, ..quarter_turn() };
    for format in of_base.filter(Format::has_comments) {
        let text = format.write(&fixed);
        assert!(text.contains("base_from_sensor") && !text.contains("tool0"), "{text}");
    }
}

fn check_all(frame: &ToolFrame) {
    for format in formats() {
        let trip = format.check(frame).unwrap_or_else(|error| panic!("{}: {error}", format.id));
        assert!(trip.is_good(), "{}: {trip:?} of {frame:?}\n{}", format.id, format.write(frame));
    }
}

#[test]
fn half_turns_and_gimbal_lock_survive() {
    let quarter = PI / 2.0;
    // Products of quarter and half turns about the axes: every singular orientation of every order of angles is among them.
    for idx in 0..64 {
        let [i, j, k] = [idx / 16, idx / 4 % 4, idx % 4].map(|turns| quarter * f64::from(turns));
        let rotation = so3::exp(Vec3::x() * i) * so3::exp(Vec3::y() * j) * so3::exp(Vec3::z() * k);
        let pose = Transform::from_parts(Vec3::new(-1234.5678, 0.0004, 99.9996), rotation);
        check_all(&ToolFrame { flange_from_sensor: pose, ..quarter_turn() });
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(200) })]

    #[test]
    fn every_text_read_back_is_the_same_pose(
        translation in prop::array::uniform3(-3000.0..3000.0),
        axis in prop::array::uniform3(-1.0..1.0),
        angle in prop_oneof![0.0..PI, Just(PI), Just(0.0), PI - 1e-7..PI],
    ) {
        let axis = Vec3::from(axis);
        prop_assume!(axis.norm() > 1e-3);
        check_all(&frame(translation, (axis.normalize() * angle).into()));
    }

    #[test]
    fn near_gimbal_lock_too(
        turn in -180.0..180.0_f64,
        tilt in prop_oneof![89.9999..90.0001_f64, -1e-5..1e-5, 179.99999..180.0],
        spin in -180.0..180.0_f64,
    ) {
        for convention in PoseConvention::all() {
            let rotation = convention.rotation_from_angles_deg([turn, tilt, spin]);
            let pose = Transform::from_parts(Vec3::new(1.0, 2.0, 3.0), rotation);
            check_all(&ToolFrame { flange_from_sensor: pose, ..quarter_turn() });
        }
    }
}
