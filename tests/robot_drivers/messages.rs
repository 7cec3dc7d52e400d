//! Golden bytes, and messages that survive being written and read.

use handeye::device::robot::curpos::page::CurposPage;
use handeye::device::robot::mappdk::messages::Xyzwpr;
use handeye::device::robot::ur::dashboard::{Question, parse_remote_control};
use handeye::device::robot::ur::rtde::{
    ClientPacket, MAX_PACKET_BYTES, ServerPacket, TextMessage, Value, encode_values, packet_len, parse_values,
};
use handeye::device::robot::ur::script::{Program, Statement, UrPose};

#[test]
fn rtde_packets_have_their_golden_bytes() {
    assert_eq!(ClientPacket::RequestVersion(2).encode(), b"\x00\x05V\x00\x02");
    assert_eq!(ClientPacket::Start.encode(), b"\x00\x03S");
    assert_eq!(ServerPacket::VersionAccepted(true).encode(), b"\x00\x04V\x01");
    let version = ServerPacket::ControllerVersion([5, 12, 6, 0]);
    assert_eq!(version.encode(), b"\x00\x13v\x00\x00\x00\x05\x00\x00\x00\x0c\x00\x00\x00\x06\x00\x00\x00\x00");
    let setup = ClientPacket::SetupOutputs { frequency_hz: 125.0, names: vec!["a".to_owned(), "b".to_owned()] };
    assert_eq!(setup.encode(), b"\x00\x0eO\x40\x5f\x40\x00\x00\x00\x00\x00a,b");
    // Time stamp and pose: 3 + 1 + 8 + 48 bytes.
    let values = encode_values(&[Value::F64(1.5), Value::Vector6([0.1, 0.2, 0.3, 3.0, 0.0, -0.5])]);
    let data = ServerPacket::Data { recipe_id: 1, values }.encode();
    assert_eq!((data.len(), &data[..4]), (60, &b"\x00\x3cU\x01"[..]));
}

#[test]
fn rtde_packets_survive_the_wire() {
    let names = || vec!["actual_q".to_owned(), "timestamp".to_owned()];
    let text = TextMessage { text: "joint 3".to_owned(), source: "RTDE".to_owned(), level: 1 };
    for packet in [
        ClientPacket::RequestVersion(2),
        ClientPacket::ControllerVersion,
        ClientPacket::SetupOutputs { frequency_hz: 500.0, names: names() },
        ClientPacket::SetupInputs { names: names() },
        ClientPacket::Start,
        ClientPacket::Pause,
        ClientPacket::Data { recipe_id: 2, values: vec![1, 2, 3] },
        ClientPacket::Message(text.clone()),
    ] {
        assert_eq!(ClientPacket::parse(&packet.encode()), Ok(packet));
    }
    for packet in [
        ServerPacket::VersionAccepted(false),
        ServerPacket::ControllerVersion([5, 1, 2, 3]),
        ServerPacket::OutputTypes { recipe_id: 1, types: vec!["VECTOR6D".to_owned(), "NOT_FOUND".to_owned()] },
        ServerPacket::InputTypes { recipe_id: 1, types: vec!["IN_USE".to_owned()] },
        ServerPacket::Started(true),
        ServerPacket::Paused(true),
        ServerPacket::Data { recipe_id: 9, values: vec![0; 48] },
        ServerPacket::Message(text),
    ] {
        assert_eq!(ServerPacket::parse(&packet.encode()), Ok(packet));
    }
    // Some clients end the list of names with a comma.
    let trailing = b"\x00\x10Iactual_q, b,,";
    assert_eq!(
        ClientPacket::parse(trailing),
        Ok(ClientPacket::SetupInputs { names: vec!["actual_q".to_owned(), "b".to_owned()] })
    );
}

#[test]
fn rtde_sizes_are_checked_before_anything_is_waited_for() {
    assert_eq!(packet_len(b"\x00"), Ok(None));
    assert_eq!(packet_len(b"\x00\x04V"), Ok(None));
    assert_eq!(packet_len(b"\x00\x04V\x01more"), Ok(Some(4)));
    assert!(packet_len(b"\x00\x02").is_err() && packet_len(b"\xff\xff").is_err());
    // What is too long for the protocol is cut rather than sent with a size that lies.
    let long = ServerPacket::Data { recipe_id: 1, values: vec![0; 100_000] }.encode();
    assert_eq!(packet_len(&long), Ok(Some(MAX_PACKET_BYTES)));
}

#[test]
fn rtde_values_fill_their_packet() {
    let values = [
        ("BOOL", Value::U8(1)),
        ("UINT32", Value::U32(7)),
        ("UINT64", Value::U64(1 << 40)),
        ("INT32", Value::I32(-5)),
        ("DOUBLE", Value::F64(0.25)),
        ("VECTOR3D", Value::Vector3([1.0, 2.0, 3.0])),
        ("VECTOR6INT32", Value::Vector6I32([-1, 2, -3, 4, -5, 6])),
        ("VECTOR6UINT32", Value::Vector6U32([1, 2, 3, 4, 5, 6])),
    ];
    let types: Vec<String> = values.iter().map(|(name, _)| (*name).to_owned()).collect();
    let values = values.map(|(_, value)| value);
    let bytes = encode_values(&values);
    assert_eq!(parse_values(&types, &bytes).as_deref(), Ok(&values[..]));
    assert!(parse_values(&types, &bytes[..bytes.len() - 1]).is_err());
    assert!(parse_values(&types[1..], &bytes).is_err());
    assert!(parse_values(&["NOT_FOUND".to_owned()], b"").is_err());
}

#[test]
fn scripts_are_read_as_written_and_as_others_write_them() {
    let pose = UrPose([0.1, -0.2, 0.3, 0.0, 2.5, 0.0]);
    let step = Program {
        name: "step".to_owned(),
        statements: vec![
            Statement::MoveL { pose, acceleration_m_s2: 0.3, speed_m_s: 0.05, time_s: 0.0 },
            Statement::WriteOutputInteger { register: 24, value: 7 },
        ],
    };
    let text = "def step():\n  movel(p[0.100000000, -0.200000000, 0.300000000, 0.000000000, 2.500000000, 0.000000000], a=0.300000, v=0.050000)\n  write_output_integer_register(24, 7)\nend\n";
    assert_eq!(step.encode(), text);
    assert_eq!(Program::parse(text), Ok(step));
    for (line, expected) in [
        ("stopl(2.5)", Statement::StopL { deceleration_m_s2: 2.5 }),
        ("set_tcp(p[0.1,-0.2,0.3,0,2.5,0])", Statement::SetTcp { offset: pose }),
        ("sync()", Statement::Sync),
        ("stopj( 4 )", Statement::StopJ { deceleration_rad_s2: 4.0 }),
        (
            "movel(p[0.1,-0.2,0.3,0,2.5,0],0.5,0.1)",
            Statement::MoveL { pose, acceleration_m_s2: 0.5, speed_m_s: 0.1, time_s: 0.0 },
        ),
        (
            "movej([0,1,2,3,4,5], v=1, a=2)",
            Statement::MoveJ { joints_rad: [0.0, 1.0, 2.0, 3.0, 4.0, 5.0], acceleration_rad_s2: 2.0, speed_rad_s: 1.0 },
        ),
    ] {
        assert_eq!(Program::parse(line), Ok(Program::single(expected)), "{line}");
    }
    for line in [
        "movel(p[1,2,3],a=1)",
        "movel(p[0,0,0,0,0,nan])",
        // The controller would solve for the joints, or for the pose; metres are no angles.
        "movej(p[0.1,-0.2,0.3,0,2.5,0])",
        "movel([0,1,2,3,4,5])",
        "powerdown()",
        "movel",
        "def f(x):\nend\n",
    ] {
        assert!(Program::parse(line).is_err(), "{line}");
    }
    let two = b"\nstopl(1)\ndef f():\n  stopl(2)\nend\n";
    assert_eq!(Program::len_of_first(two), Ok(Some(10)));
    assert_eq!(Program::len_of_first(&two[10..]), Ok(Some(two.len() - 10)));
    assert_eq!(Program::len_of_first(&two[10..two.len() - 1]), Ok(None));
    assert!(Program::len_of_first(&b" ".repeat(100_000)).is_err());
    // The end of a block inside is not that of the program: what stands behind it would run by itself.
    let nested = b"def p():\n if x:\n  while(y):\n   movel(A)\n  end\n elif z:\n end\n movel(B)\nend # of p\n";
    assert_eq!(Program::len_of_first(nested), Ok(Some(nested.len())));
    for len in 0..nested.len() {
        assert_eq!(Program::len_of_first(&nested[..len]), Ok(None));
    }
    // Not the words themselves.
    assert_eq!(Program::len_of_first(b"iffy()\nend_of()\n"), Ok(Some(7)));
}

#[test]
fn dashboards_that_do_not_know_the_question_are_not_taken_for_a_no() {
    assert_eq!(Question::parse("Is In Remote Control\r\n"), Question::IsInRemoteControl);
    assert_eq!(Question::parse(&Question::RobotMode.encode()), Question::RobotMode);
    assert_eq!(parse_remote_control("true\n"), Some(true));
    assert_eq!(parse_remote_control("False"), Some(false));
    assert_eq!(parse_remote_control("could not understand: 'is in remote control'"), None);
}

#[test]
fn pages_are_written_with_two_decimals_and_no_leading_zero() {
    let page = CurposPage {
        tool: 7,
        frame: 3,
        joints_deg: vec![86.75, -0.5, 0.0, 90.0, -78.0, 0.25],
        in_user_frame: Xyzwpr([1.0, 2.0, 3.0, 4.0, 5.0, 6.0]),
        world: Xyzwpr([622.47, -0.06, -140.5, -179.99, 0.0, -87.46]),
    };
    let text = page.encode();
    for words in ["Tool #:  7", "Y:      -.06", "Z:   -140.50", "P:       .00", "Joint   2:      -.50"] {
        assert!(text.contains(words), "{words} in\n{text}");
    }
    assert_eq!(CurposPage::parse(&text), Ok(page));
}
