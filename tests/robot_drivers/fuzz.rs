//! No bytes from a wire make a parser panic, and none makes it ask for more memory than the bytes have.

use handeye::device::bridge::messages as bridge;
use handeye::device::robot::curpos::http::{self, Response};
use handeye::device::robot::curpos::page::CurposPage;
use handeye::device::robot::mappdk::messages::{self as mappdk, Command, Reply};
use handeye::device::robot::ur::dashboard::{self, Question};
use handeye::device::robot::ur::rtde::{self, ClientPacket, ServerPacket};
use handeye::device::robot::ur::script::Program;
use proptest::prelude::*;

/// Whole messages, to be damaged: random bytes alone seldom get past the first check.
const SEEDS: [&[u8]; 15] = [
    b"curpos\n",
    b"movep:0020:0100:000:1:6:+000560.000000:-000109.750000:-000140.500000:+000179.900000:-000000.060000:+000030.500000\n",
    b"setdout:00042:true\n",
    b"0:x= 560.000,y= -110.250,z= -140.500,w= 179.900,p=    -.060,r=  30.500",
    b"0:j=1.0,j=2.0,j=3.0,j=4.0,j=5.0,j=6.0,j=none,j=none,j=none",
    b"1:position-is-not-reachable",
    b"HTTP/1.1 200 OK\r\nContent-Length: 20\r\n\r\nGroup #:  1\r\nTool #: ",
    b"HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\n5\r\nGroup\r\n0\r\n\r\n",
    b"Group #:  1\nTool #:  7\nCURRENT JOINT POSITION:\nJoint 1: 2\nCURRENT WORLD POSITION:\nX: 1\nY: 2\nZ: 3\nW: 4\nP: 5\nR: 6\n",
    b"\x00\x10O\x01VECTOR6D,INT",
    b"\x00\x0aM\x02ab\x01c\x01",
    b"def f():\n  movel(p[0.1, 0.2, 0.3, 0, 3.14, 0], a=0.3, v=0.05, t=1)\n  write_output_integer_register(24, 7)\nend\n",
    b"{\"bridge\":1,\"id\":3,\"request\":\"move\",\"pose\":{\"position_mm\":[1,2,3],\"quaternion_wxyz\":[1,0,0,0]},\"speed_mm_s\":1,\"rotation_speed_deg_s\":1}\n",
    b"{\"bridge\":1,\"id\":3,\"reply\":\"state\",\"pose\":{\"position_mm\":[1,2,3],\"angles_deg\":[1,0,0]},\"is_moving\":false}\n",
    b"{\"bridge\":1,\"id\":3,\"reply\":\"profile\",\"trigger_count\":7,\"x_mm\":[0.0,0.1],\"z_mm\":[1.5,null]}\n",
];

fn parse_all(bytes: &[u8]) {
    let text = String::from_utf8_lossy(bytes);
    for command in [Command::CurPos, Command::CurJPos, Command::InsPwr, Command::Exit] {
        let _ = mappdk::completeness(&command, bytes);
    }
    if let Ok(reply) = Reply::parse(bytes) {
        let _ = mappdk::parse_position(&reply.message);
        let _ = mappdk::parse_joints(&reply.message);
    }
    if let Ok(command) = Command::parse(&text) {
        let _ = command.encode();
    }
    let _ = http::parse_get(bytes);
    for is_closed in [false, true] {
        if let Ok(Some(response)) = Response::parse(bytes, is_closed) {
            assert!(response.body.len() <= bytes.len());
        }
    }
    let _ = CurposPage::parse(&text);
    let _ = rtde::packet_len(bytes);
    let _ = ClientPacket::parse(bytes);
    if let Ok(ServerPacket::OutputTypes { types, .. }) = ServerPacket::parse(bytes) {
        let _ = rtde::parse_values(&types, bytes);
    }
    let _ = dashboard::line_len(bytes);
    let _ = Question::parse(&text);
    let _ = Program::len_of_first(bytes);
    if let Ok(program) = Program::parse(&text) {
        let _ = program.encode();
    }
    let _ = bridge::line_len(bytes);
    let _ = bridge::parse_request(bytes);
    if let Ok(bridge::Reply { answer: bridge::Answer::Profile(profile), .. }) = bridge::parse_reply(bytes) {
        let _ = profile.profile();
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn random_bytes_do_no_harm(bytes in prop::collection::vec(any::<u8>(), 0..600)) {
        parse_all(&bytes);
    }

    #[test]
    fn damaged_messages_do_no_harm(
        seed in prop::sample::select(&SEEDS[..]),
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>(), 0..4_u8), 0..6),
        cut in prop::option::of(any::<prop::sample::Index>()),
    ) {
        let mut bytes = seed.to_vec();
        for (at, byte, kind) in changes {
            if bytes.is_empty() {
                break;
            }
            let at = at.index(bytes.len());
            match kind {
                0 => bytes[at] = byte,
                1 => bytes[at] ^= 1 << (byte % 8),
                2 => bytes.insert(at, byte),
                _ => {
                    bytes.remove(at);
                }
            }
        }
        if let Some(cut) = cut {
            bytes.truncate(cut.index(bytes.len() + 1));
        }
        parse_all(&bytes);
        // A frame cut off whole is parsed whole.
        if bytes.len() >= 2 {
            let size = u16::try_from(bytes.len()).expect("short").to_be_bytes();
            bytes[..2].copy_from_slice(&size);
            parse_all(&bytes);
        }
    }
}
