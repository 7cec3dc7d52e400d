//! Reading along a message as ROS 2 writes it: CDR in either byte order, every length checked against what is there.

use thiserror::Error;

/// Why bytes are not the message that the topic says.
#[derive(Clone, Debug, Error, PartialEq)]
pub(super) enum BadMessage {
    /// Cut off, or a length in it is wrong.
    #[error("found {found} bytes, needed {needed} or more")]
    Short {
        /// How many there are.
        found: usize,
        /// How far the reader had to go.
        needed: u64,
    },
    /// The first bytes are not those of plain CDR.
    #[error("found {found:02x?} at its beginning, needed 00 00 or 00 01 of plain CDR; {remedy}")]
    Encapsulation {
        /// The first two bytes.
        found: [u8; 2],
        /// What may help.
        remedy: &'static str,
    },
    /// A value that no such message has.
    #[error("found {found}, needed {needed}")]
    Value {
        /// What stands there.
        found: String,
        /// What should.
        needed: &'static str,
    },
}

/// A message that is read from its beginning.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cdr<'b> {
    /// Behind the four bytes that say how it is written; numbers are aligned from there.
    bytes: &'b [u8],
    at: usize,
    is_little_endian: bool,
}

impl<'b> Cdr<'b> {
    /// # Errors
    /// [`BadMessage`] if it does not begin as plain CDR.
    pub fn new(message: &'b [u8]) -> Result<Self, BadMessage> {
        const ZSTD: [u8; 2] = [0x28, 0xb5];
        let Some(([first, second, _, _], bytes)) = message.split_first_chunk::<4>() else {
            return Err(BadMessage::Short { found: message.len(), needed: 4 });
        };
        match [*first, *second] {
            [0, kind @ (0 | 1)] => Ok(Self { bytes, at: 0, is_little_endian: kind == 1 }),
            found => {
                let remedy = if found == ZSTD {
                    "each message is compressed: write the bag anew with `ros2 bag convert`, uncompressed"
                } else {
                    "write the bag anew with `ros2 bag convert`"
                };
                Err(BadMessage::Encapsulation { found, remedy })
            }
        }
    }

    /// So many bytes from here.
    pub fn bytes(&mut self, count: usize) -> Result<&'b [u8], BadMessage> {
        let end = self.at.checked_add(count).filter(|end| *end <= self.bytes.len());
        let Some(end) = end else {
            return Err(BadMessage::Short { found: self.bytes.len(), needed: self.at as u64 + count as u64 });
        };
        let found = &self.bytes[self.at..end];
        self.at = end;
        Ok(found)
    }

    /// A number of `N` bytes, which stands at a multiple of `N`.
    fn number<const N: usize>(&mut self) -> Result<[u8; N], BadMessage> {
        self.at = self.at.next_multiple_of(N);
        let mut number = [0; N];
        number.copy_from_slice(self.bytes(N)?);
        if !self.is_little_endian {
            number.reverse();
        }
        Ok(number)
    }

    pub fn u8(&mut self) -> Result<u8, BadMessage> {
        Ok(self.bytes(1)?[0])
    }

    pub fn u32(&mut self) -> Result<u32, BadMessage> {
        self.number().map(u32::from_le_bytes)
    }

    pub fn i32(&mut self) -> Result<i32, BadMessage> {
        self.number().map(i32::from_le_bytes)
    }

    pub fn f32(&mut self) -> Result<f32, BadMessage> {
        self.number().map(f32::from_le_bytes)
    }

    pub fn f64(&mut self) -> Result<f64, BadMessage> {
        self.number().map(f64::from_le_bytes)
    }

    /// How many elements follow; there must be room for as many of at least `min_bytes` each.
    pub fn count(&mut self, min_bytes: usize) -> Result<usize, BadMessage> {
        let count = u64::from(self.u32()?);
        let needed = count * min_bytes as u64;
        let left = self.bytes.len().saturating_sub(self.at);
        match usize::try_from(count) {
            Ok(count) if needed <= left as u64 => Ok(count),
            _ => Err(BadMessage::Short { found: self.bytes.len(), needed: self.at as u64 + needed }),
        }
    }

    /// A text; what is no UTF-8 in it is replaced.
    pub fn string(&mut self) -> Result<String, BadMessage> {
        let count = self.count(1)?;
        let bytes = self.bytes(count)?;
        let text = bytes.strip_suffix(&[0]).unwrap_or(bytes);
        Ok(String::from_utf8_lossy(text).into_owned())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_stand_at_multiples_of_their_size_behind_the_first_four_bytes_in_either_order() {
        let little = [0, 1, 0, 0, 7, 0, 0, 0, 2, 0, 0, 0, b'a', 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xf0, 0x3f];
        let big = [0, 0, 0, 0, 7, 0, 0, 0, 0, 0, 0, 2, b'a', 0, 0, 0, 0x3f, 0xf0, 0, 0, 0, 0, 0, 0];
        // Behind u8, u32 and two bytes of text, ten in all, the next f64 stands at 16; both messages end there.
        for message in [&little[..], &big[..]] {
            let mut cdr = Cdr::new(message).expect("CDR");
            assert_eq!(cdr.u8(), Ok(7));
            assert_eq!(cdr.string().as_deref(), Ok("a"));
            assert_eq!(cdr.f64(), Err(BadMessage::Short { found: 20, needed: 24 }));
        }
        let mut whole = little.to_vec();
        whole.splice(16..16, [0; 4]);
        let mut cdr = Cdr::new(&whole).expect("CDR");
        assert_eq!((cdr.u8(), cdr.string().as_deref(), cdr.f64()), (Ok(7), Ok("a"), Ok(1.0)));
    }

    #[test]
    fn a_length_beyond_the_message_is_refused_before_anything_is_kept() {
        let mut cdr = Cdr::new(&[0, 1, 0, 0, 0xff, 0xff, 0xff, 0xff]).expect("CDR");
        assert_eq!(cdr.count(8), Err(BadMessage::Short { found: 4, needed: 4 + 8 * 0xffff_ffff }));
        assert!(matches!(Cdr::new(&[0, 1]), Err(BadMessage::Short { .. })));
        assert!(matches!(Cdr::new(&[0x28, 0xb5, 0x2f, 0xfd, 0]), Err(BadMessage::Encapsulation { .. })));
    }
}
