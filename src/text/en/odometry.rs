//! The words of the odometry: of a frame, of why one was lost, of the command.

use crate::calibrate::motion::Tracked;
use crate::odometry::{Estimator, Evaluation, Failure, Tracking, Travel};

use super::plural;

/// Why the motion of a frame is not known, and what to do.
#[must_use]
pub fn failure_message(failure: &Failure) -> String {
    match failure {
        Failure::WrongSize { found, needed } => format!(
            "found a colour picture of {} × {} and depth of {} × {} pixels, needed {} × {} and {} × {} as the camera has them",
            found[0], found[1], found[2], found[3], needed[0], needed[1], needed[2], needed[3]
        ),
        Failure::TooDark { mean, needed } => format!(
            "too dark: found a mean grey value of {mean:.1} of 255, needed {needed:.0}; more light or a longer exposure helps"
        ),
        Failure::BlankDepth { found_percent, needed_percent } => format!(
            "blank depth: found a depth at {found_percent:.1} % of the pixels, needed {needed_percent:.0} %; the camera was too near, too far, or covered"
        ),
        Failure::TooFewFeatures { found, needed } => format!(
            "too few features: found {found} with a depth, needed {needed}; the camera looked at something bare"
        ),
        Failure::TooFast { found, needed } => format!(
            "too fast: found {found} points of the frame before again, needed {needed}; move slower, or record more frames a second"
        ),
        Failure::NoAgreement { found, needed } => format!(
            "no agreement: found {found} points that agree on one motion, needed {needed}; things moved, or look alike"
        ),
    }
}

/// What became of a frame, in a word or two.
#[must_use]
pub const fn tracking_word(tracking: &Tracking) -> &'static str {
    match tracking {
        Tracking::LeftOut => "left out",
        Tracking::Started { is_after_gap: false } => "first frame",
        Tracking::Started { is_after_gap: true } => "starts anew",
        Tracking::Tracked(motion) if motion.is_recognised => "recognised",
        Tracking::Tracked(_) => "tracked",
        Tracking::Lost(_) => "lost",
    }
}

/// The name of an estimator.
#[must_use]
pub const fn estimator_name(estimator: Estimator) -> &'static str {
    match estimator {
        Estimator::Published => "as published (CN102692236: pairs in space, best sample)",
        Estimator::Ours => "ours (tracking from keyframes, reprojection)",
    }
}

/// How far the camera has come.
#[must_use]
pub fn travel_line(travel: &Travel) -> String {
    format!(
        "{:.3} m travelled, heading {:+.2}°, turned {:+.2}° in all",
        travel.distance_mm / 1000.0,
        travel.heading_rad.to_degrees(),
        travel.turn_rad.to_degrees()
    )
}

/// Heads the command's output.
#[must_use]
pub fn odometry_head(name: &str, num_frames: usize, size: [u32; 2], estimator: Estimator) -> String {
    format!(
        "{name}: {num_frames} frame{} of {} × {} pixels\nmotion: {}\n",
        plural(num_frames),
        size[0],
        size[1],
        estimator_name(estimator)
    )
}

/// How many frames have a pose.
#[must_use]
pub fn tracked_line(tracked: usize, lost: usize, left_out: usize, unreadable: usize) -> String {
    let others = [(lost, "lost"), (left_out, "left out by the period"), (unreadable, "without pictures")];
    let others = others.iter().filter(|(count, _)| *count > 0).map(|(count, what)| format!(", {count} {what}"));
    format!("{tracked} frame{} with a pose", plural(tracked)) + &others.collect::<String>()
}

/// Columns of the table of frames.
pub const FRAME_COLUMNS: [&str; 9] = ["time s", "x m", "y m", "z m", "way m", "heading °", "inliers", "ms", ""];

/// What the columns mean.
pub const FRAME_FOOT: &str = "x, y, z: the camera in the world (the frame of the ground truth, else the camera at its first frame); heading: the optical axis about the vertical of the first frame, + to the right; ms: without reading and decoding the pictures";

/// Speed, with the decoding apart.
#[must_use]
pub fn speed_line(motion_ms: f64, decode_ms: f64) -> String {
    format!("{motion_ms:.1} ms a frame (median), and {decode_ms:.1} ms to read and decode its pictures")
}

/// Against the ground truth.
#[must_use]
pub fn evaluation_line(evaluation: &Evaluation) -> String {
    let Evaluation { num_poses, ate_rmse_mm: ate_mm, rpe_translation_rmse_mm: rpe_mm, .. } = *evaluation;
    let rpe_deg = evaluation.rpe_rotation_rmse_rad.to_degrees();
    let ate = if ate_mm.is_nan() { "not defined on a straight line".to_owned() } else { format!("{ate_mm:.2} mm") };
    format!("{num_poses} poses, RMS: ATE {ate}; RPE from frame to frame {rpe_mm:.3} mm, {rpe_deg:.4}°")
}

/// Heads the hand-eye calibration.
pub const HAND_EYE_HEAD: &str = "hand-eye by the camera's motion against the flange's:";

/// There is none.
#[must_use]
pub fn no_hand_eye(reason: &str) -> String {
    format!("no hand-eye calibration from the motion: {reason}")
}

/// By how much the clocks differ.
#[must_use]
pub fn time_offset(offset_s: f64, std_s: Option<f64>) -> String {
    let std = std_s.map_or_else(String::new, |std_s| format!(" ± {:.1}", 1000.0 * std_s));
    format!("the robot's times are those of the camera {:+.1}{std} ms", 1000.0 * offset_s)
}

/// How the steps of the camera and of the robot agree.
#[must_use]
pub fn steps_line(tracked: &Tracked) -> String {
    let lost = match tracked.num_lost {
        0 => String::new(),
        lost => format!(", {lost} in which the camera lost its way left out"),
    };
    format!(
        "{} step{} of the camera against the robot's: RMS {:.2} mm, {:.3}°{lost}",
        tracked.num_steps,
        plural(tracked.num_steps),
        tracked.step_mm.rms_mm,
        tracked.step_rms_rad.to_degrees()
    )
}

/// Heads the list of frames that were not tracked.
#[must_use]
pub fn trouble_head(count: usize) -> String {
    format!("{count} frame{} without a motion:", plural(count))
}

/// More of them than are listed.
#[must_use]
pub fn trouble_more(count: usize) -> String {
    format!("and {count} more")
}

/// Nothing could be tracked.
#[must_use]
pub fn nothing_tracked(name: &str, first_reason: &str) -> String {
    format!("{name}: found no frame with a pose: {first_reason}")
}

/// The session has no sequence.
#[must_use]
pub fn not_a_sequence_session(file: &str) -> String {
    format!(
        "{file}: found a session of another target, expected one of kind \"rgbd\" with its \"sequence\", or the folder of a sequence"
    )
}

/// Files were written.
#[must_use]
pub fn wrote_odometry(folder: &str) -> String {
    format!("wrote trajectory.txt, frames.csv and odometry.json to {folder}\n")
}
