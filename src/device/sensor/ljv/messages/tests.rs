//! Golden messages both ways, and what is refused.

use super::*;
use crate::device::sensor::ljv::packing::{DEAD_ZONE, INVALID, JUDGEMENT_WAIT, NO_PEAK, pack};

fn bytes(hex: &str) -> Vec<u8> {
    let digits: Vec<u32> = hex.chars().filter_map(|c| c.to_digit(16)).collect();
    digits.chunks_exact(2).map(|pair| u8::try_from(16 * pair[0] + pair[1]).expect("two digits")).collect()
}

#[track_caller]
fn check_request(request: &Request, golden: &str) {
    assert_eq!(request.encode(), bytes(golden));
    assert_eq!(Request::parse(&bytes(golden)).as_ref(), Ok(request));
    assert_eq!(Request::len_in(&bytes(golden)), Ok(Some(bytes(golden).len())));
}

#[test]
fn golden_requests() {
    check_request(
        &Request::new(command::GET_PROFILE, ProfileRequest::NEWEST.encode()),
        "20000000 0100f000 00000000 14000000 42000000 00000000 00000000 01000000 01010000",
    );
    check_request(
        &Request::new(command::GET_PROFILE, ProfileRequest::NONE.encode()),
        "20000000 0100f000 00000000 14000000 42000000 00000000 00000000 01000000 00000000",
    );
    check_request(
        &Request::new(command::CHANGE_PROGRAM, vec![7, 0, 0, 0]),
        "14000000 0100f000 00000000 08000000 39000000 07000000",
    );
    check_request(&Request::new(command::CLEAR_MEMORY, Vec::new()), "10000000 0100f000 00000000 04000000 27000000");
    check_request(&Request::new(command::SOFTWARE_TRIGGER, Vec::new()), "10000000 0100f000 00000000 04000000 21000000");
}

#[test]
fn requests_for_settings_are_read_back() {
    let request = SettingRequest::trigger_mode(5);
    check_request(
        &Request::new(command::GET_SETTING, request.encode()),
        "20000000 0100f000 00000000 14000000 31000000 00000000 01000000 15000100 00000000",
    );
    assert_eq!(SettingRequest::parse(&request.encode()), Some(request));
    assert_eq!(SettingRequest::parse(&[0; 17]), None);
}

#[test]
fn requests_for_profiles_are_read_back() {
    for request in [
        ProfileRequest::NEWEST,
        ProfileRequest::NONE,
        ProfileRequest { bank: 1, position: 2, profile_no: 0x0102_0304, count: 255, erases: false },
    ] {
        assert_eq!(ProfileRequest::parse(&request.encode()), Some(request));
    }
    assert_eq!(ProfileRequest::parse(&[0; 15]), None);
    assert_eq!(ProfileRequest::parse(&[0; 17]), None);
}

#[test]
fn golden_replies() {
    let golden = bytes("18000000 010000f0 00000000 0c000000 39000000 00000000 07000000");
    let reply = Reply::new(command::CHANGE_PROGRAM, 7, Vec::new());
    assert_eq!(reply.encode(), golden);
    assert_eq!(Reply::parse(&golden, command::CHANGE_PROGRAM), Ok(reply));
    let refusal = Reply::refusal(command::GET_PROFILE, 3, code::STATUS);
    assert_eq!(refusal.encode(), bytes("18000000 010000f0 00000000 0c000000 42410000 00000000 03000000"));
}

fn sample(num_points: u16, num_profiles: u32) -> ProfileReply {
    let codes = [NO_PEAK, INVALID, DEAD_ZONE, JUDGEMENT_WAIT];
    let range =
        |idx: usize| if idx < codes.len() { codes[idx] } else { 37 * i32::try_from(idx).expect("small") - 9000 };
    ProfileReply {
        current_no: 41,
        oldest_no: 40,
        first_no: 41,
        num_points,
        range_unit: 50,
        first_x: -2_000_000,
        x_pitch: 5000,
        profiles: (0..num_profiles)
            .map(|idx| RawProfile {
                flags: 0x80,
                trigger_count: 1_000_000 + idx,
                encoder_count: -5,
                ranges: (0..usize::from(num_points)).map(range).collect(),
            })
            .collect(),
    }
}

#[test]
fn replies_with_profiles_are_as_long_as_those_of_real_controllers() {
    for (num_points, num_profiles, len) in [(800, 1, 2092), (800, 0, 64), (800, 3, 64 + 3 * 2028), (0, 0, 64)] {
        let reply = sample(num_points, num_profiles);
        let message = Reply::new(command::GET_PROFILE, 0, reply.encode()).encode();
        assert_eq!(message.len(), len);
        assert_eq!(u32_at(&message, 0), Some(wire_len(len - 4)));
        let read = Reply::parse(&message, command::GET_PROFILE).expect("a good reply");
        assert_eq!(ProfileReply::parse(&read.data), Ok(reply));
    }
}

#[test]
fn ranges_stand_where_the_specification_has_them() {
    let reply = sample(8, 1);
    let message = Reply::new(command::GET_PROFILE, 0, reply.encode()).encode();
    assert_eq!(message[28..32], 41_u32.to_le_bytes());
    assert_eq!(message[40], 1);
    assert_eq!(u16_at(&message, 52), Some(8));
    assert_eq!(u16_at(&message, 54), Some(50));
    assert_eq!(message[56..60], (-2_000_000_i32).to_le_bytes());
    assert_eq!(message[64], 0x80);
    assert_eq!(u32_at(&message, 68), Some(1_000_000));
    assert_eq!(message[88..108], pack(&reply.profiles[0].ranges));
    let sum = message[64..108].chunks_exact(4).filter_map(|word| u32_at(word, 0)).fold(0, u32::wrapping_add);
    assert_eq!(u32_at(&message, 108), Some(sum));
}

#[test]
fn codes_become_missing_points_before_they_are_scaled() {
    let reply = sample(8, 1);
    for (is_z_inverted, sign) in [(false, 1.0), (true, -1.0)] {
        let profile = reply.in_mm(&reply.profiles[0], is_z_inverted).expect("a profile");
        assert!(profile.z_mm()[..4].iter().all(|z| z.is_nan()));
        // 50 × 0.01 µm a unit, −20 mm and 50 µm along the line.
        let expected: Vec<f64> = (4..8).map(|idx| sign * f64::from(37 * idx - 9000) * 0.0005).collect();
        for (z, expected) in profile.z_mm()[4..].iter().zip(expected) {
            assert!((z - expected).abs() < 1e-12);
        }
        for (x, expected) in profile.x_mm().iter().zip([-20.0, -19.95, -19.9, -19.85]) {
            assert!((x - expected).abs() < 1e-12);
        }
    }
}

#[track_caller]
fn check_refusal<T: std::fmt::Debug>(result: Result<T, DeviceError>, words: &[&str]) {
    let message = result.expect_err("a refusal").to_string();
    for word in words {
        assert!(message.contains(word), "\"{message}\" does not say \"{word}\"");
    }
}

#[test]
fn scales_of_no_profiler_are_refused() {
    let raw = &sample(8, 1).profiles[0];
    for broken in [
        ProfileReply { range_unit: 0, ..sample(8, 1) },
        ProfileReply { x_pitch: 0, ..sample(8, 1) },
        ProfileReply { num_points: 0, ..sample(8, 1) },
    ] {
        check_refusal(broken.in_mm(raw, false), &["none of them 0"]);
    }
    let vast = ProfileReply { range_unit: u16::MAX, ..sample(8, 1) };
    let raw = RawProfile { ranges: vec![524_287; 8], ..RawProfile::default() };
    check_refusal(vast.in_mm(&raw, false), &["coordinates that a profiler measures"]);
}

#[test]
fn two_heads_are_told_by_the_length() {
    let one = sample(800, 1).encode();
    let mut two = one.clone();
    two.splice(36..36, one[24..36].to_vec());
    two.extend(&one[36..]);
    check_refusal(ProfileReply::parse(&two), &["as two heads send them", "unplug the second head"]);
    let mut none = sample(800, 0).encode();
    none.extend(&one[24..36]);
    check_refusal(ProfileReply::parse(&none), &["two heads"]);
    check_refusal(ProfileReply::parse(&one[..one.len() - 4]), &["found 2060 bytes of profiles", "2064 bytes"]);
    check_refusal(ProfileReply::parse(&one[..35]), &["35 bytes", "at least 36"]);
}

#[test]
fn refusals_say_what_they_mean_and_what_to_do() {
    let reply =
        |header_code, body_code| Reply { header_code, body_code, ..Reply::refusal(command::GET_PROFILE, 0, body_code) };
    for (reply, words) in [
        (reply(0, code::STATUS), ["advanced mode or batch mode is on", "high-speed"]),
        (reply(0, code::UNDEFINED_COMMAND), ["does not know", "LJ-V7000"]),
        (reply(0, code::COMMAND_LENGTH), ["another length", "firmware"]),
        (reply(0, code::PARAMETER), ["out of its range", "one head"]),
        (reply(0, 0x99), ["0x99", "0x8099"]),
        (reply(0x11, 0), ["too slowly", "network"]),
        (reply(0x21, 0), ["fixed field", "LJ-X8000"]),
        (reply(0x77, 0), ["0x77", "manual"]),
        (Reply { version: VERSION_LJX, ..reply(0, 0) }, ["LJ-X8000", "watched folder"]),
        (Reply { version: 9, ..reply(0, 0) }, ["version 9", "version 1"]),
        (Reply { status: 0xff, ..reply(0, 0) }, ["system error", "restart"]),
        (Reply { command: command::CLEAR_MEMORY, ..reply(0, 0) }, ["clear memory (0x27)", "get profile (0x42)"]),
    ] {
        check_refusal(Reply::parse(&reply.encode(), command::GET_PROFILE), &words);
    }
    let trigger = Reply::refusal(command::SOFTWARE_TRIGGER, 0, code::STATUS).encode();
    check_refusal(Reply::parse(&trigger, command::SOFTWARE_TRIGGER), &["trigger mode is not external"]);
}

#[test]
fn what_is_no_reply_is_told_at_once() {
    let good = Reply::new(command::CLEAR_MEMORY, 0, Vec::new()).encode();
    let with = |at: usize, patch: &[u8]| {
        let mut bytes = good.clone();
        bytes[at..at + patch.len()].copy_from_slice(patch);
        bytes
    };
    let len_in = |bytes: &[u8]| Reply::len_in(bytes, command::CLEAR_MEMORY);
    // A length beyond any message is refused by its first four bytes: nothing is waited for, nothing allocated.
    check_refusal(len_in(&with(0, &[0xff; 4])[..4]), &["4294967295 bytes"]);
    check_refusal(len_in(&with(0, &(MAX_PREFIX + 1).to_le_bytes())[..4]), &["4194305 bytes"]);
    check_refusal(len_in(&with(0, &[23, 0, 0, 0])[..4]), &["23 bytes", "24 to 4194304"]);
    check_refusal(len_in(b"HTTP/1.1 400"), &["a message of 1347703880 bytes", "24691"]);
    check_refusal(len_in(&with(6, &[0xf0, 0])[..8]), &["direction 0x00F0", "0xF000"]);
    check_refusal(len_in(&with(12, &[13])[..16]), &["a body of 13 bytes", "12 bytes"]);
    check_refusal(len_in(&with(12, &[0xff; 4])[..16]), &["a body of 4294967295"]);
    for len in 0..good.len() {
        assert_eq!(len_in(&good[..len]), Ok(None));
        check_refusal(Reply::parse(&good[..len], command::CLEAR_MEMORY), &["whole message"]);
    }
    let mut longer = good.clone();
    longer.push(0);
    assert_eq!(len_in(&longer), Ok(Some(28)));
    check_refusal(Reply::parse(&longer, command::CLEAR_MEMORY), &["29 bytes", "a message of 28"]);
}
