//! Profiles as the command port sends them in the high-speed mode.

use crate::device::error::DeviceError;
use crate::device::sensor::ljv::packing::{pack, packed_len, range_of, unpack};
use crate::geometry::Profile;

use super::{CHECK_PORT, command, u16_at, u32_at, unexpected};

/// The data of a request for profiles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ProfileRequest {
    /// 0: the memory that is written now; 1: the other.
    pub bank: u8,
    /// From where: 0 the newest, 1 the oldest, 2 [`Self::profile_no`].
    pub position: u8,
    /// Used by position 2.
    pub profile_no: u32,
    /// How many.
    pub count: u8,
    /// Whether the controller forgets what was read.
    pub erases: bool,
}

impl ProfileRequest {
    /// The newest one; it is not given a second time. Position 0 has no use for the number: it is the one that the drivers
    /// send which were used with real controllers.
    pub const NEWEST: Self = Self { bank: 0, position: 0, profile_no: 1, count: 1, erases: true };
    /// None, only what is said of all: a question whether profiles can be had.
    pub const NONE: Self = Self { count: 0, erases: false, ..Self::NEWEST };

    const LEN: usize = 16;

    /// Its bytes.
    #[must_use]
    pub fn encode(&self) -> Vec<u8> {
        let mut data = Vec::with_capacity(Self::LEN);
        data.extend([0, 0, 0, 0, self.bank, self.position, 0, 0]);
        data.extend(self.profile_no.to_le_bytes());
        data.extend([self.count, u8::from(self.erases), 0, 0]);
        data
    }

    /// Reads the data of a request; `None` if it has another length.
    #[must_use]
    pub fn parse(data: &[u8]) -> Option<Self> {
        let data: &[u8; Self::LEN] = data.try_into().ok()?;
        Some(Self {
            bank: data[4],
            position: data[5],
            profile_no: u32_at(data, 8)?,
            count: data[12],
            erases: data[13] != 0,
        })
    }
}

/// A profile as the wire has it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RawProfile {
    /// Bit 7: the encoder's Z phase.
    pub flags: u8,
    /// Counts triggers.
    pub trigger_count: u32,
    /// Counts the encoder's pulses.
    pub encoder_count: i32,
    /// Ranges and codes; see [`crate::device::sensor::ljv::packing`].
    pub ranges: Vec<i32>,
}

/// The data of a reply with profiles.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ProfileReply {
    /// Number of the newest profile.
    pub current_no: u32,
    /// Number of the oldest profile that is held.
    pub oldest_no: u32,
    /// Number of the oldest profile in this reply.
    pub first_no: u32,
    /// Points of a profile.
    pub num_points: u16,
    /// What 1 of a range is, in 0.01 µm.
    pub range_unit: u16,
    /// x of the first point, 0.01 µm.
    pub first_x: i32,
    /// From point to point, 0.01 µm.
    pub x_pitch: i32,
    /// The profiles; there may be none.
    pub profiles: Vec<RawProfile>,
}

/// Millimetres in the 0.01 µm of the wire.
pub const WIRE_UNIT_MM: f64 = 1e-5;
/// Bytes before the first profile.
const INFO_LEN: usize = 36;
/// What a second head adds to that.
const SECOND_HEAD_INFO_LEN: usize = 12;
/// Bytes of a profile before and behind its ranges.
const PROFILE_HEADER_LEN: usize = 24;
const PROFILE_FOOTER_LEN: usize = 4;

const fn profile_len(num_points: usize) -> usize {
    PROFILE_HEADER_LEN + packed_len(num_points) + PROFILE_FOOTER_LEN
}

impl ProfileReply {
    /// Its bytes. Each profile ends with the sum of its words, as later controllers have it.
    #[must_use]
    pub fn encode(&self) -> Vec<u8> {
        let len = profile_len(usize::from(self.num_points));
        let mut data = Vec::with_capacity(INFO_LEN + self.profiles.len() * len);
        for word in [self.current_no, self.oldest_no, self.first_no] {
            data.extend(word.to_le_bytes());
        }
        data.extend([u8::try_from(self.profiles.len()).unwrap_or(u8::MAX), 0, 0, 0, 0, 0, 0, 0]);
        // One head, no luminance.
        data.extend([1, 0, 0, 0]);
        data.extend(self.num_points.to_le_bytes());
        data.extend(self.range_unit.to_le_bytes());
        data.extend(self.first_x.to_le_bytes());
        data.extend(self.x_pitch.to_le_bytes());
        for profile in self.profiles.iter().take(usize::from(u8::MAX)) {
            let start = data.len();
            data.extend([profile.flags, 0, 0, 0]);
            data.extend(profile.trigger_count.to_le_bytes());
            data.extend(profile.encoder_count.to_le_bytes());
            data.extend([0; 12]);
            let mut packed = pack(&profile.ranges);
            packed.resize(packed_len(usize::from(self.num_points)), 0);
            data.extend(packed);
            let words = data[start..].chunks_exact(4).filter_map(|word| u32_at(word, 0));
            let sum = words.fold(0, u32::wrapping_add);
            data.extend(sum.to_le_bytes());
        }
        data
    }

    /// Reads the data of a reply. The footers are not looked at: what stands in those of LJ-V controllers is not known.
    ///
    /// # Errors
    /// [`DeviceError::Unexpected`] where the lengths do not agree, as with two heads.
    pub fn parse(data: &[u8]) -> Result<Self, DeviceError> {
        let fail =
            |found: String, expected: String, remedy| Err(unexpected(command::GET_PROFILE, found, expected, remedy));
        let Some(info) = data.first_chunk::<INFO_LEN>() else {
            return fail(format!("{} bytes of data", data.len()), format!("at least {INFO_LEN}"), CHECK_PORT);
        };
        let word = |at| u32_at(info, at).unwrap_or_default();
        let half = |at| u16_at(info, at).unwrap_or_default();
        let num_profiles = usize::from(info[12]);
        let (num_points, range_unit) = (half(24), half(26));
        let each = profile_len(usize::from(num_points));
        let expected = INFO_LEN + num_profiles * each;
        if data.len() != expected {
            let with_two_heads = INFO_LEN + SECOND_HEAD_INFO_LEN + 2 * num_profiles * each;
            let of_one = format!("{expected} bytes, those of {num_profiles} profiles of one head");
            // The second head may have another number of points.
            return if data.len() == with_two_heads || data.len() > expected + SECOND_HEAD_INFO_LEN {
                let remedy = "unplug the second head, or let the controller join both heads to one wide profile";
                fail(format!("{} bytes of profiles, as two heads send them", data.len()), of_one, remedy)
            } else {
                fail(format!("{} bytes of profiles", data.len()), of_one, CHECK_PORT)
            };
        }
        let mut profiles = Vec::with_capacity(num_profiles);
        for bytes in data[INFO_LEN..].chunks_exact(each) {
            let packed = &bytes[PROFILE_HEADER_LEN..each - PROFILE_FOOTER_LEN];
            profiles.push(RawProfile {
                flags: bytes[0],
                trigger_count: u32_at(bytes, 4).unwrap_or_default(),
                encoder_count: u32_at(bytes, 8).unwrap_or_default().cast_signed(),
                ranges: unpack(packed, usize::from(num_points)),
            });
        }
        Ok(Self {
            current_no: word(0),
            oldest_no: word(4),
            first_no: word(8),
            num_points,
            range_unit,
            first_x: word(28).cast_signed(),
            x_pitch: word(32).cast_signed(),
            profiles,
        })
    }

    /// A profile of the reply in millimetres; codes become missing points before anything is scaled.
    ///
    /// # Errors
    /// [`DeviceError::Unexpected`] where its scales are of no profiler.
    pub fn in_mm(&self, raw: &RawProfile, is_z_inverted: bool) -> Result<Profile, DeviceError> {
        let remedy = "check that the head is plugged in, and restart the controller";
        if self.range_unit == 0 || self.x_pitch == 0 || self.num_points == 0 {
            let found = format!(
                "{} points with a pitch of {} and a unit of {} (0.01 µm)",
                self.num_points, self.x_pitch, self.range_unit
            );
            return Err(unexpected(command::GET_PROFILE, found, "none of them 0", remedy));
        }
        let sign = if is_z_inverted { -1.0 } else { 1.0 };
        let mm_per_unit = f64::from(self.range_unit) * WIRE_UNIT_MM;
        let x_mm = (0..raw.ranges.len()).map(|idx| self.x_mm(idx)).collect();
        let z_mm: Vec<Option<f64>> =
            raw.ranges.iter().map(|raw| range_of(*raw).map(|range| sign * f64::from(range) * mm_per_unit)).collect();
        Profile::new(x_mm, &z_mm).map_err(|error| {
            unexpected(command::GET_PROFILE, error.to_string(), "coordinates that a profiler measures", remedy)
        })
    }

    /// x of a point, mm.
    #[must_use]
    pub fn x_mm(&self, idx: usize) -> f64 {
        // 31 bits times 16 bits: exact in an f64, so the grid has no rounding that grows along the line.
        #[expect(clippy::cast_precision_loss, reason = "a profile has at most 65,535 points")]
        let steps = idx as f64;
        (f64::from(self.first_x) + steps * f64::from(self.x_pitch)) * WIRE_UNIT_MM
    }
}
