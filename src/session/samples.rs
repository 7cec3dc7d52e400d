//! The sample sessions, carried in the program so that the start page has them wherever it runs; but for a recorded
//! sequence, which is too large and is looked for beside the program.

use std::path::{Path, PathBuf};

use super::sequence::CAMERA_FILE;

/// A sample session.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sample {
    /// File name under `sample_sessions/`.
    pub file_name: &'static str,
    /// The file's text.
    pub json: &'static str,
}

macro_rules! samples {
    ($($name:literal),* $(,)?) => {
        &[$(Sample {
            file_name: $name,
            json: include_str!(concat!("../../sample_sessions/", $name)),
        }),*]
    };
}

/// All samples that are carried, in the order of the start page. The recorded sequence is none of them: its images are many,
/// and `handeye simulate` makes them anew on any machine.
pub const ALL: &[Sample] = samples![
    "lin-mu-2019-table-1.json",
    "lin-mu-2019-table-2.json",
    "clean-sweeps.json",
    "dirty-profiles.json",
    "few-rotations.json",
    "near-largest-arc.json",
    "one-bad-pose.json",
    "plate.json",
    "tip.json",
    "poses.json",
    "workpiece.json",
    "three-targets.json",
];

/// The folder of the samples, and in it the session and the images of the recorded sequence.
const FOLDER: &str = "sample_sessions";
const SEQUENCE_SESSION: &str = "room-on-robot.json";
const SEQUENCE_FOLDER: &str = "room-on-robot-sequence";

/// The session of the recorded sequence in the first of some places that has it with its images.
#[must_use]
pub fn recorded_sequence<'a>(mut places: impl Iterator<Item = &'a Path>) -> Option<PathBuf> {
    places.find_map(|place| {
        let folder = place.join(FOLDER);
        let session = folder.join(SEQUENCE_SESSION);
        (session.is_file() && folder.join(SEQUENCE_FOLDER).join(CAMERA_FILE).is_file()).then_some(session)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_recorded_sequence_is_found_beside_the_source_and_nowhere_else() {
        let elsewhere = tempfile::tempdir().expect("a folder");
        let source = Path::new(env!("CARGO_MANIFEST_DIR"));
        let found = recorded_sequence([elsewhere.path(), source].into_iter());
        assert_eq!(found, Some(source.join(FOLDER).join(SEQUENCE_SESSION)));
        assert_eq!(recorded_sequence(elsewhere.path().ancestors().take(1)), None);
    }
}
