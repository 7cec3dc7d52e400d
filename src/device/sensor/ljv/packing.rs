//! Ranges as the wire packs them: 20-bit two's complement, one after the other, lowest bits first. Pure.

/// Bits of a value.
const BITS: usize = 20;
/// Nothing seen: no peak in the light, or an alarm.
pub const NO_PEAK: i32 = -(1 << 19);
/// Nothing said: masked.
pub const INVALID: i32 = NO_PEAK + 1;
/// Out of what the head can measure.
pub const DEAD_ZONE: i32 = NO_PEAK + 2;
/// The judgement is still to come.
pub const JUDGEMENT_WAIT: i32 = NO_PEAK + 3;
/// The largest value that is a range.
pub const MAX_RANGE: i32 = (1 << 19) - 1;
/// The least value that is a range; what is below are codes.
pub const MIN_RANGE: i32 = JUDGEMENT_WAIT + 1;

/// Bytes of so many packed values: whole words of 32 bits.
#[must_use]
pub const fn packed_len(num_values: usize) -> usize {
    (num_values * BITS).div_ceil(32) * 4
}

/// Packs values; of each the lowest 20 bits.
#[must_use]
pub fn pack(values: &[i32]) -> Vec<u8> {
    let mut bytes = vec![0; packed_len(values.len())];
    for (idx, value) in values.iter().enumerate() {
        let at = idx * BITS;
        // A value begins at a byte or in the middle of one, so it lies in three bytes.
        let [low, middle, high, _] = ((value.cast_unsigned() & 0xf_ffff) << (at % 8)).to_le_bytes();
        for (byte, part) in bytes[at / 8..].iter_mut().zip([low, middle, high]) {
            *byte |= part;
        }
    }
    bytes
}

/// Takes packed values apart, with their signs; as many as `bytes` hold if these are fewer.
#[must_use]
pub fn unpack(bytes: &[u8], num_values: usize) -> Vec<i32> {
    let value = |idx: usize| {
        let at = idx * BITS;
        let [low, middle, high] = *bytes.get(at / 8..)?.first_chunk::<3>()?;
        let bits = u32::from_le_bytes([low, middle, high, 0]) >> (at % 8);
        // Shifted to the top and back, the sign fills what is above.
        Some((bits << (32 - BITS)).cast_signed() >> (32 - BITS))
    };
    (0..num_values).map_while(value).collect()
}

/// The range that a value is; `None` for the codes, which look like the deepest ranges and are none.
#[must_use]
pub fn range_of(value: i32) -> Option<i32> {
    (value >= MIN_RANGE).then_some(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn check(values: &[i32], packed: u128, last: u32) {
        assert_eq!(pack(values), [packed.to_be_bytes().as_slice(), &last.to_be_bytes()].concat());
        assert_eq!(unpack(&pack(values), values.len()), values);
    }

    /// Vectors that three independent decoders read alike.
    #[test]
    fn golden_vectors() {
        check(&[0, 1, -1, 2, -2, 524_287, -524_288, 123_456], 0x0000_1000_00ff_ff2f_0000_feff_ffff_7f00, 0x0008_241e);
        check(
            &[NO_PEAK, INVALID, DEAD_ZONE, JUDGEMENT_WAIT, 7980, -7980, 100_000, -100_000],
            0x0000_1800_8002_0038_0080_2c1f_400d_fea0,
            0x8601_96e7,
        );
    }

    #[test]
    fn lengths_are_whole_words() {
        for (num_values, len) in [(0, 0), (1, 4), (2, 8), (3, 8), (4, 12), (8, 20), (800, 2000), (65_535, 163_840)] {
            assert_eq!(packed_len(num_values), len);
            assert_eq!(pack(&vec![-1; num_values]).len(), len);
            assert_eq!(unpack(&vec![0xff; len], num_values), vec![-1; num_values]);
        }
    }

    #[test]
    fn codes_are_no_ranges() {
        for code in [NO_PEAK, INVALID, DEAD_ZONE, JUDGEMENT_WAIT] {
            assert_eq!(range_of(code), None);
        }
        for range in [MIN_RANGE, -1, 0, MAX_RANGE] {
            assert_eq!(range_of(range), Some(range));
        }
        assert_eq!(MIN_RANGE, -524_284);
    }

    #[test]
    fn too_few_bytes_give_fewer_values() {
        assert_eq!(unpack(&[], 5), [] as [i32; 0]);
        assert_eq!(unpack(&[1, 0], 5), [] as [i32; 0]);
        assert_eq!(unpack(&pack(&[7, 8]), 100).len(), 3);
    }
}
