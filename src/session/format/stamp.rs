//! By what a file is known again, so that a change by another program is noticed.

use std::fs;
use std::io;
use std::path::Path;
use std::time::{Duration, SystemTime};

use serde_json::{Value, json};
use sha2::{Digest as _, Sha256};

/// A file as it was when it was read or written.
///
/// The time says quickly that nothing has happened; the contents decide, as copying and touching change the time only,
/// and a clock may be too coarse for two writes in a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stamp {
    modified: Option<SystemTime>,
    num_bytes: usize,
    sha256: [u8; 32],
}

impl Stamp {
    /// The stamp of a file with these contents.
    #[must_use]
    pub fn new(bytes: &[u8], modified: Option<SystemTime>) -> Self {
        Self { modified, num_bytes: bytes.len(), sha256: Sha256::digest(bytes).into() }
    }

    /// The size of the contents.
    #[must_use]
    pub const fn num_bytes(&self) -> usize {
        self.num_bytes
    }

    /// The SHA-256 of the contents.
    #[must_use]
    pub const fn sha256(&self) -> [u8; 32] {
        self.sha256
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
    pub fn has_contents_of(&self, other: &Self) -> bool {
        self.num_bytes == other.num_bytes && self.sha256 == other.sha256
    }

    /// Whether a file looks as if nobody had touched it since; reads no contents.
    #[must_use]
    pub fn looks_like(&self, metadata: &fs::Metadata) -> bool {
        self.num_bytes as u64 == metadata.len() && self.modified.is_some() && self.modified == metadata.modified().ok()
    }

    /// As JSON, for another run of the program.
    #[must_use]
    pub fn to_json(&self) -> Value {
        json!({ "bytes": self.num_bytes, "sha256": self.sha256 })
    }

    /// From JSON. Only the contents count between runs.
    #[must_use]
    pub fn from_json(value: &Value) -> Option<Self> {
        let num_bytes = usize::try_from(value.get("bytes")?.as_u64()?).ok()?;
        let bytes = value.get("sha256")?.as_array()?.iter();
        let bytes = bytes.map(|byte| u8::try_from(byte.as_u64()?).ok()).collect::<Option<Vec<u8>>>()?;
        Some(Self { modified: None, num_bytes, sha256: bytes.try_into().ok()? })
    }
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
    fn contents_are_known_again_in_another_run() {
        let stamp = Stamp::new(b"{}", Some(SystemTime::UNIX_EPOCH));
        let again = Stamp::from_json(&stamp.to_json()).expect("read");
        assert!(stamp.has_contents_of(&again));
        assert!(!stamp.has_contents_of(&Stamp::new(b"[]", None)));
        assert_eq!(Stamp::from_json(&json!({ "bytes": 2 })), None);
    }
}
