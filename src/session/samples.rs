//! The sample sessions, carried in the program so that the start page has them wherever it runs.

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

/// All samples, in the order of the start page. The recorded sequence is none of them: its images are many, and
/// `handeye simulate` makes them anew on any machine.
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
