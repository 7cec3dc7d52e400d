//! By what a file is known again, so that a change by another program is noticed.

use std::fs;
use std::io;
use std::path::Path;
use std::time::{Duration, SystemTime};

use serde_json::{Value, json};

/// A file as it was when it was read or written.
///
/// The time says quickly that nothing has happened; the contents decide, as copying and touching change the time only,
/// and a clock may be too coarse for two writes in a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stamp {
    modified: Option<SystemTime>,
    num_bytes: u64,
    hash: u64,
}

impl Stamp {
    /// The stamp of a file with these contents.
    #[must_use]
    pub fn new(bytes: &[u8], modified: Option<SystemTime>) -> Self {
        Self { modified, num_bytes: bytes.len() as u64, hash: fnv_1a(bytes) }
    }

    /// The stamp of a file as it is now.
    ///
    /// # Errors
    /// It cannot be read.
    pub fn of(path: &Path) -> io::Result<Self> {
        let modified = fs::metadata(path)?.modified().ok();
        Ok(Self::new(&fs::read(path)?, modified))
    }

    /// Whether the contents are the same.
    #[must_use]
    pub const fn has_contents_of(&self, other: &Self) -> bool {
        self.num_bytes == other.num_bytes && self.hash == other.hash
    }

    /// Whether a file looks as if nobody had touched it since; reads no contents.
    #[must_use]
    pub fn looks_like(&self, metadata: &fs::Metadata) -> bool {
        self.num_bytes == metadata.len() && self.modified.is_some() && self.modified == metadata.modified().ok()
    }

    /// As JSON, for another run of the program.
    #[must_use]
    pub fn to_json(&self) -> Value {
        json!({ "bytes": self.num_bytes, "fnv_1a": format!("{:016x}", self.hash) })
    }

    /// From JSON. Only the contents count between runs.
    #[must_use]
    pub fn from_json(value: &Value) -> Option<Self> {
        let num_bytes = value.get("bytes")?.as_u64()?;
        let hash = u64::from_str_radix(value.get("fnv_1a")?.as_str()?, 16).ok()?;
        Some(Self { modified: None, num_bytes, hash })
    }
}

/// Fowler, Noll and Vo's hash, 64 bits: short, quick, and the same in every version of this program.
fn fnv_1a(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3))
}

/// Milliseconds since 1970; 0 for a clock set before that.
#[must_use]
pub fn unix_ms(time: SystemTime) -> u64 {
    let since = time.duration_since(SystemTime::UNIX_EPOCH).unwrap_or(Duration::ZERO);
    u64::try_from(since.as_millis()).unwrap_or(u64::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hash_is_the_published_one() {
        // From the authors' test vectors.
        assert_eq!(fnv_1a(b""), 0xcbf2_9ce4_8422_2325);
        assert_eq!(fnv_1a(b"foobar"), 0x8594_4171_f739_67e8);
    }

    #[test]
    fn contents_are_known_again_in_another_run() {
        let stamp = Stamp::new(b"{}", Some(SystemTime::UNIX_EPOCH));
        let again = Stamp::from_json(&stamp.to_json()).expect("read");
        assert!(stamp.has_contents_of(&again));
        assert!(!stamp.has_contents_of(&Stamp::new(b"[]", None)));
        assert_eq!(Stamp::from_json(&json!({ "bytes": 2 })), None);
    }
}
