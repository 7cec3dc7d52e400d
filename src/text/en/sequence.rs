//! The words of an RGB-D sequence: its images, its motion, and how it is played.

use crate::odometry::Estimator;
use crate::text::typeset::{fixed, signed};

/// The rail's step for a sequence.
pub const STEP: &str = "Sequence";
/// What it is.
pub const STEP_HINT: &str = "Every frame with what the motion was found from, and the way of the camera";
/// Title of the axis of time.
pub const TIME_AXIS: &str = "time (s)";
/// Title of the axis of a plan that points to the right.
pub const RIGHT_AXIS: &str = "right (m)";
/// Title of the axis of a plan that points forward.
pub const FORWARD_AXIS: &str = "forward (m)";
/// Title of the axis of the way travelled.
pub const DISTANCE_AXIS: &str = "distance (m)";
/// Title of the axis of the heading.
pub const HEADING_AXIS: &str = "heading (°)";
/// Title of the axis of features.
pub const FEATURES_AXIS: &str = "features";
/// Title of the axis of computing time.
pub const DURATION_AXIS: &str = "ms a frame";

/// Menu entry and button.
pub const OPEN_FOLDER: &str = "Open an RGB-D sequence folder…";
/// What it does.
pub const OPEN_FOLDER_HINT: &str = "The images of an RGB-D camera in the TUM format, with a camera.json: finds the camera's motion, and with the robot's poses beside them (flange.txt) its mounting";
/// Heading where the path is typed.
pub const OPEN_FOLDER_TITLE: &str = "Open the folder of an RGB-D sequence";

/// A folder that is no sequence.
#[must_use]
pub fn no_sequence(folder: &str) -> String {
    format!(
        "{folder}: found no camera.json, needed the folder of a sequence in the TUM format and, beside its lists, a camera.json with width, height, fx, fy, cx, cy of its cameras"
    )
}

/// In place of a value.
pub const NO_VALUE: &str = "–";
/// The way from the images.
pub const TRACKED_WAY: &str = "from the images";
/// The true way.
pub const TRUE_WAY: &str = "ground truth";
/// What a screen reader calls the way in space.
pub const SPACE_NAME: &str = "The camera's way in space";
/// How the way in space is turned.
pub const SPACE_HINT: &str = "drag to turn · scroll to zoom · click a frame";

/// A tab of the picture.
pub const COLOR: &str = "Colour";
/// A tab of the picture.
pub const DEPTH: &str = "Depth";
/// A tab of the picture.
pub const ALIGNED: &str = "Aligned";
/// A tab of the picture.
pub const FEATURES: &str = "Features";
/// A tab of the picture.
pub const MATCHES: &str = "Matches";
/// What a tab shows.
pub const COLOR_HINT: &str = "The colour image";
/// What a tab shows.
pub const DEPTH_HINT: &str =
    "The depth image as the depth camera saw it: near is red, far is blue, black was not measured";
/// What a tab shows.
pub const ALIGNED_HINT: &str =
    "Depth carried over to the pixels of the colour image: edges of both must lie on each other";
/// What a tab shows.
pub const FEATURES_HINT: &str = "Where the motion is looked for";
/// What a tab shows.
pub const MATCHES_HINT: &str =
    "From where in the frame before each feature came; green: the motion explains it, red: it does not";

/// The values of the frame under the pointer.
#[must_use]
pub fn readout(time_s: &str, values: &str) -> String {
    format!("{time_s} s: {values}")
}

/// Where the camera was.
#[must_use]
pub fn place_readout(frame_number: usize, right_m: &str, forward_m: &str) -> String {
    format!("frame {frame_number}: {right_m} m right, {forward_m} m forward")
}

/// How large the meshes of the floor are.
#[must_use]
pub fn mesh_of(side_m: &str) -> String {
    format!("meshes of {side_m} m")
}

/// A length in metres.
#[must_use]
pub fn metres(value_m: &str) -> String {
    format!("{value_m} m")
}

/// What a screen reader calls the picture.
#[must_use]
pub fn picture_name(shown: &str) -> String {
    format!("Frame: {shown}")
}

/// The pixel under the pointer; with its distance where one is shown, which may not have been measured.
#[must_use]
pub fn pixel_readout(column: usize, row: usize, distance_m: Option<Option<&str>>) -> String {
    match distance_m {
        None => format!("({column}, {row})"),
        Some(Some(distance_m)) => format!("({column}, {row}): {distance_m} m"),
        Some(None) => format!("({column}, {row}): no distance"),
    }
}

/// The step without a session.
pub const NO_SESSION: &str = "Open a session with an RGB-D sequence, or the folder of one.";
/// The lists are being read.
pub const OPENING: &str = "Reading the sequence …";
/// The pictures of a frame are being read.
pub const READING: &str = "Reading the frame …";
/// No frame has a pose yet.
pub const NO_WAY: &str = "No frame has been tracked yet.";
/// Title of a card.
pub const PICTURE: &str = "Frame";
/// Title of a card.
pub const WAY: &str = "Trajectory";
/// Title of a card.
pub const TRAVEL: &str = "Distance and heading";
/// Title of a card.
pub const EFFORT: &str = "Features and time";
/// A view of the way.
pub const IN_PLAN: &str = "Plan";
/// What it shows.
pub const IN_PLAN_HINT: &str = "From above, as the first frame has it: its x axis to the right, its optical axis up";
/// A view of the way.
pub const IN_SPACE: &str = "3D";

/// A curve.
pub const SEEN: &str = "seen";
/// A curve.
pub const MATCHED: &str = "matched";
/// A curve.
pub const AGREEING: &str = "agreeing with the motion";
/// A curve.
pub const MOTION_TIME: &str = "without reading and decoding";

/// A button of the player.
pub const FIRST_FRAME: &str = "First frame";
/// A button of the player.
pub const FRAME_BEFORE: &str = "Frame before";
/// A button of the player.
pub const PLAY: &str = "Play";
/// A button of the player.
pub const PAUSE: &str = "Pause";
/// A button of the player.
pub const FRAME_AFTER: &str = "Next frame";
/// A button of the player.
pub const LAST_FRAME: &str = "Last frame";
/// The slider of the player.
pub const FRAME_SLIDER: &str = "Frame";
/// The keys of the player.
pub const KEYS_HINT: &str = "Space plays, ← and → step, Home and End go to the ends";

/// How the motion is estimated.
pub const ESTIMATOR: &str = "Estimator";
/// Frames that are used.
pub const PERIOD: &str = "T";
/// What a period is.
pub const PERIOD_HINT: &str = "Only a frame every so many seconds is used (T of the patent); 0: every frame";
/// No period.
pub const EVERY_FRAME: &str = "every frame";
/// Tracks the sequence.
pub const TRACK: &str = "Track again";
/// Why it need not be tracked.
pub const TRACKED_ALREADY: &str = "It is tracked as chosen";
/// Stops tracking.
pub const STOP: &str = "Stop";
/// The heading where a path is typed for one of the files.
pub const SAVE_TITLE: &str = "Save the motion";
/// The files of a sequence.
pub const SAVE: &str = "Save";
/// A file.
pub const SAVE_TRAJECTORY: &str = "Trajectory (TUM) …";
/// A file.
pub const SAVE_FRAMES: &str = "Table of frames (CSV) …";

/// The name of an estimator.
#[must_use]
pub const fn estimator(estimator: Estimator) -> &'static str {
    match estimator {
        Estimator::Ours => "ours",
        Estimator::Published => "as published",
    }
}

/// What an estimator does.
#[must_use]
pub const fn estimator_hint(estimator: Estimator) -> &'static str {
    match estimator {
        Estimator::Ours => {
            "Points are tracked from keyframes, and the motion is that which puts them where they are seen"
        }
        Estimator::Published => {
            "CN102692236: points are matched by what they look like, and the motion is that of the best three pairs in space"
        }
    }
}

/// A period.
#[must_use]
pub fn seconds(value_s: &str) -> String {
    format!("{value_s} s")
}

/// Which frame is in sight.
#[must_use]
pub fn frame_head(number: usize, num_frames: usize, time_s: &str) -> String {
    format!("Frame {number} of {num_frames} · {time_s} s")
}

/// A frame whose motion is known.
#[must_use]
pub fn tracked(word: &str, num_inliers: usize, num_matches: usize, motion_ms: &str) -> String {
    format!("{word}, {num_inliers} of {num_matches} points agree · {motion_ms} ms")
}

/// How far tracking is.
#[must_use]
pub fn progress(done: usize, total: usize) -> String {
    format!("tracking {done} of {total}")
}

/// What came of a sequence: frames with a pose, distance (m) and turn (°), ATE and RPE (mm).
#[must_use]
pub fn summary(with_pose: usize, num_frames: usize, travel: Option<[f64; 2]>, errors_mm: Option<[f64; 2]>) -> String {
    let mut parts = vec![format!("{with_pose} of {num_frames} frames with a pose")];
    if let Some([distance_m, turn_deg]) = travel {
        parts.push(format!("{} m", fixed(distance_m, 3)));
        parts.push(format!("turned {}°", signed(turn_deg, 1)));
    }
    if let Some([ate_mm, rpe_mm]) = errors_mm {
        if ate_mm.is_finite() {
            parts.push(format!("ATE {} mm", fixed(ate_mm, 2)));
        }
        parts.push(format!("RPE {} mm", fixed(rpe_mm, 2)));
    }
    parts.join(" · ")
}

/// A folder that cannot be called by its name.
#[must_use]
pub fn no_name(folder: &str) -> String {
    format!("{folder}: found a folder without a name of its own, needed one beside which the session can be saved")
}
