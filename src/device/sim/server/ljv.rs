//! An LJ-V7000 controller's command port in the high-speed mode.

use crate::device::sensor::ljv::messages::{
    ProfileReply, ProfileRequest, RawProfile, Reply, Request, SettingRequest, WIRE_UNIT_MM, code, command,
};
use crate::device::sensor::ljv::packing::{DEAD_ZONE, MAX_RANGE, MIN_RANGE, NO_PEAK};
use crate::device::sim::head::{Head, Height};
use crate::device::sim::net::Connection;
use crate::device::sim::world::World;

/// Profiles that the memory holds.
const MEMORY: u32 = 1000;
/// Most profiles of one reply, so that it stays short.
const MAX_PROFILES: u8 = 16;
/// Nothing is wrong, nothing is busy, and settings are 0: continuous trigger, batch off, and so on.
const ALL_ZERO: [u8; 4] = [0; 4];

/// Talks to one client.
pub fn serve(world: &World, connection: &mut Connection) {
    let mut program = 0;
    loop {
        // What cannot be a request is not answered: there is no telling where the next one begins.
        let bytes = connection.receive(|bytes| Request::len_in(bytes).unwrap_or(Some(0)));
        let Some(request) = bytes.and_then(|bytes| Request::parse(&bytes).ok()) else { return };
        let reply = Reply { version: request.version, ..answer(world, &request, &mut program) };
        if !connection.send(&reply.encode()) {
            return;
        }
    }
}

fn answer(world: &World, request: &Request, program: &mut u8) -> Reply {
    let number = request.command;
    let data = request.data.as_slice();
    let done = |program: u8, data: Vec<u8>| Reply::new(number, program, data);
    match (number, data) {
        (command::SOFTWARE_TRIGGER, []) => done(*program, Vec::new()),
        (command::CLEAR_MEMORY, []) => {
            world.forget_profiles(world.trigger_counts().0);
            done(*program, Vec::new())
        }
        (command::CHANGE_PROGRAM, [wanted @ 0..=15, _, _, _]) => {
            *program = *wanted;
            done(*program, Vec::new())
        }
        (command::CHANGE_PROGRAM, [_, _, _, _]) => Reply::refusal(number, *program, code::PARAMETER),
        (command::GET_SETTING, _) if SettingRequest::parse(data).is_some() => done(*program, ALL_ZERO.to_vec()),
        (command::SET_SETTING | command::REFLECT_SETTING, [_, ..]) | (command::GET_ERROR | CHECK_MEMORY_ACCESS, []) => {
            done(*program, ALL_ZERO.to_vec())
        }
        (command::GET_PROFILE, _) => match ProfileRequest::parse(data) {
            Some(wanted) => profiles(world, wanted).map_or_else(
                || Reply::refusal(number, *program, code::PARAMETER),
                |reply| done(*program, reply.encode()),
            ),
            None => Reply::refusal(number, *program, code::COMMAND_LENGTH),
        },
        _ if KNOWN.contains(&number) => Reply::refusal(number, *program, code::COMMAND_LENGTH),
        _ => Reply::refusal(number, *program, code::UNDEFINED_COMMAND),
    }
}

/// Asks whether the memory is being written to.
const CHECK_MEMORY_ACCESS: u8 = 0x34;
/// What is answered above where its length is right.
const KNOWN: [u8; 8] = [
    command::GET_ERROR,
    command::SOFTWARE_TRIGGER,
    command::CLEAR_MEMORY,
    command::CHANGE_PROGRAM,
    command::GET_SETTING,
    command::SET_SETTING,
    command::REFLECT_SETTING,
    CHECK_MEMORY_ACCESS,
];

/// `None` where the request's values are none of the controller's.
fn profiles(world: &World, wanted: ProfileRequest) -> Option<ProfileReply> {
    let head = world.head();
    let (newest, first_held) = world.trigger_counts();
    // The first profile of all has the count 1 and the number 0.
    let oldest = first_held.max(newest.saturating_sub(MEMORY - 1)).max(1);
    let num_held = (newest + 1).saturating_sub(oldest);
    let count = u32::from(wanted.count.min(MAX_PROFILES));
    let first = match (wanted.bank, wanted.position) {
        (0, 0) => (newest + 1).saturating_sub(count).max(oldest),
        (0, 1) => oldest,
        (0, 2) => wanted.profile_no.saturating_add(1).max(oldest),
        // The other bank is empty while batch measurement is off.
        (1, 0..=2) => newest + 1,
        _ => return None,
    };
    let num = count.min((newest + 1).saturating_sub(first));
    let profiles: Vec<RawProfile> =
        (first..first + num).map(|trigger_count| raw_profile(world, trigger_count)).collect();
    if wanted.erases && num > 0 {
        world.forget_profiles(first + num - 1);
    }
    let number_of = |count: u32| count.saturating_sub(1);
    Some(ProfileReply {
        current_no: number_of(newest),
        oldest_no: number_of(if num_held > 0 { oldest } else { newest }),
        first_no: number_of(if num > 0 { first } else { newest }),
        num_points: Head::NUM_POINTS,
        range_unit: head.height_unit,
        first_x: wire(head.x_mm(0)),
        x_pitch: wire(head.pitch_mm),
        profiles,
    })
}

fn raw_profile(world: &World, trigger_count: u32) -> RawProfile {
    let unit_mm = f64::from(world.head().height_unit) * WIRE_UNIT_MM;
    let range = |height: &Height| match height {
        // The wire counts towards the head.
        Height::Measured { z_mm } => whole(-z_mm / unit_mm).clamp(MIN_RANGE, MAX_RANGE),
        Height::NoPeak => NO_PEAK,
        Height::DeadZone => DEAD_ZONE,
    };
    let ranges = world.profile(trigger_count).iter().map(range).collect();
    RawProfile { flags: 0, trigger_count, encoder_count: 0, ranges }
}

fn wire(length_mm: f64) -> i32 {
    whole(length_mm / WIRE_UNIT_MM)
}

#[expect(clippy::cast_possible_truncation, reason = "a cast of a float saturates")]
fn whole(value: f64) -> i32 {
    value.round() as i32
}
