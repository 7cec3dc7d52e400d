//! An LJ-V7000 controller's command port in the high-speed mode.

use std::time::Duration;

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
/// Nothing is wrong, and nothing is busy.
const ALL_ZERO: [u8; 4] = [0; 4];

/// Talks to one client.
pub fn serve(world: &World, connection: &mut Connection) {
    loop {
        // What cannot be a request is not answered: there is no telling where the next one begins.
        let bytes = connection.receive(|bytes| Request::len_in(bytes).unwrap_or(Some(0)));
        let Some(request) = bytes.and_then(|bytes| Request::parse(&bytes).ok()) else { return };
        let reply = match answer(world, &request) {
            Ok(data) => Reply::new(request.command, world.program(), data),
            Err(refusal) => Reply::refusal(request.command, world.program(), refusal),
        };
        if !connection.send(&Reply { version: request.version, ..reply }.encode()) {
            return;
        }
    }
}

/// Pushes the profiles of streams that are started from now on. The client sends nothing; the stream ends with it.
pub fn serve_stream(world: &World, connection: &mut Connection) {
    let mut seen = world.stream().number;
    // The next profile, while a stream runs.
    let mut next = None;
    while connection.take_arrived(STREAM_LOOK).is_some() {
        let stream = world.stream();
        let is_another = stream.number != seen;
        if next.is_some() && (is_another || stream.from.is_none()) {
            next = None;
            if !connection.send(&STREAM_STOPPED) {
                break;
            }
        }
        if is_another {
            seen = stream.number;
            next = stream.from;
        }
        let Some(first) = next else { continue };
        let (newest, _) = world.trigger_counts();
        // What could not be sent in time is left out.
        let first = first.max(newest.saturating_sub(MAX_BEHIND));
        let is_sent = (first..=newest).all(|trigger_count| {
            let profiles = vec![raw_profile(world, trigger_count)];
            let whole = ProfileReply { profiles, ..scales(world) }.encode();
            connection.send(&whole[INFO_LEN..])
        });
        if !is_sent {
            break;
        }
        next = Some(first.max(newest.saturating_add(1)));
    }
    world.end_stream(seen);
}

/// The data of the reply, or the code of the refusal.
fn answer(world: &World, request: &Request) -> Result<Vec<u8>, u8> {
    match (request.command, request.data.as_slice()) {
        (command::SOFTWARE_TRIGGER, []) => Ok(Vec::new()),
        (command::CLEAR_MEMORY, []) => {
            world.forget_profiles(world.trigger_counts().0);
            Ok(Vec::new())
        }
        (command::CHANGE_PROGRAM, [program @ 0..=15, _, _, _]) => {
            world.change_program(*program);
            Ok(Vec::new())
        }
        (command::GET_SETTING, data) => SettingRequest::parse(data).map(setting).ok_or(code::COMMAND_LENGTH),
        // A setting that is taken and changes nothing would mislead; and there are no batches.
        (command::SET_SETTING | command::REFLECT_SETTING, [_, ..]) | (START_BATCH | STOP_BATCH, []) => {
            Err(code::STATUS)
        }
        (command::GET_ERROR | CHECK_MEMORY_ACCESS, []) => Ok(ALL_ZERO.to_vec()),
        (command::GET_PROFILE, data) => {
            let wanted = ProfileRequest::parse(data).ok_or(code::COMMAND_LENGTH)?;
            profiles(world, wanted).map(|reply| reply.encode()).ok_or(code::PARAMETER)
        }
        (PREPARE_STREAM, [position @ 0..=2, _, _, _]) => Ok(prepare_stream(world, *position)),
        (START_STREAM, [PREPARE_STREAM, _, _, _, start_code @ ..]) => {
            let start = start_code.try_into().map(u32::from_le_bytes).map_err(|_| code::COMMAND_LENGTH)?;
            world.start_stream(start);
            Ok(Vec::new())
        }
        (STOP_STREAM, _) => {
            world.end_stream(world.stream().number);
            Ok(Vec::new())
        }
        (command::CHANGE_PROGRAM | PREPARE_STREAM | START_STREAM, [_, _, _, _, ..]) => Err(code::PARAMETER),
        (number, _) if KNOWN.contains(&number) => Err(code::COMMAND_LENGTH),
        _ => Err(code::UNDEFINED_COMMAND),
    }
}

/// The settings do not change: 0 stands for a continuous trigger, batch off, and so on.
fn setting(wanted: SettingRequest) -> Vec<u8> {
    /// Category and item within a program; 6 is 1 kHz, as the world has it.
    const SAMPLING: [u8; 2] = [0, 2];
    const SAMPLING_1_KHZ: u8 = 6;
    let is_sampling = wanted.kind >= SettingRequest::FIRST_PROGRAM && [wanted.category, wanted.item] == SAMPLING;
    vec![if is_sampling { SAMPLING_1_KHZ } else { 0 }, 0, 0, 0]
}

/// Begin and end of a batch.
const START_BATCH: u8 = 0x22;
const STOP_BATCH: u8 = 0x23;
/// Asks whether the memory is being written to.
const CHECK_MEMORY_ACCESS: u8 = 0x34;
/// The high-speed stream.
const PREPARE_STREAM: u8 = 0x47;
const START_STREAM: u8 = 0xa0;
const STOP_STREAM: u8 = 0x48;
/// What is answered above where its length is right.
const KNOWN: [u8; 11] = [
    command::GET_ERROR,
    command::SOFTWARE_TRIGGER,
    START_BATCH,
    STOP_BATCH,
    command::CLEAR_MEMORY,
    command::CHANGE_PROGRAM,
    command::SET_SETTING,
    command::REFLECT_SETTING,
    CHECK_MEMORY_ACCESS,
    PREPARE_STREAM,
    START_STREAM,
];
/// Bytes of a reply's data before its first profile; in the last of them are the scales.
const INFO_LEN: usize = 36;
const SCALES_AT: usize = 24;
/// How often it is looked for new profiles, and how many may wait.
const STREAM_LOOK: Duration = Duration::from_millis(5);
const MAX_BEHIND: u32 = 50;
/// What is sent behind the last profile.
const STREAM_STOPPED: [u8; 8] = [0xff, 0xff, 0xff, 0xff, 1, 0, 0, 0];

/// The code to start the stream with is the count of its first profile.
fn prepare_stream(world: &World, position: u8) -> Vec<u8> {
    let (newest, first_held) = world.trigger_counts();
    let first = if position == 1 { first_held } else { newest.saturating_add(1) };
    let mut data = vec![0; 4];
    data.extend(first.to_le_bytes());
    // One head, no luminance.
    data.extend([0, 0, 0, 0, 1, 0, 0, 0]);
    data.extend(&scales(world).encode()[SCALES_AT..INFO_LEN]);
    data
}

/// No profiles, only how they are to be read.
fn scales(world: &World) -> ProfileReply {
    let head = world.head();
    ProfileReply {
        num_points: Head::NUM_POINTS,
        range_unit: head.height_unit,
        first_x: wire(head.x_mm(0)),
        x_pitch: wire(head.pitch_mm),
        ..ProfileReply::default()
    }
}

/// `None` where the request's values are none of the controller's.
fn profiles(world: &World, wanted: ProfileRequest) -> Option<ProfileReply> {
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
        profiles,
        ..scales(world)
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
