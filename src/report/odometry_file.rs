//! What the odometry found of a sequence, as `odometry --json` prints it, and its frames as CSV. Other programs rely on the
//! names.

use serde_json::{Value, json};

use crate::calibrate::MethodResult;
use crate::geometry::stats;
use crate::odometry::{Estimator, Motion, Tracking};
use crate::session::Session;
use crate::session::sequence::{FrameRecord, TrackedSequence};
use crate::text::odometry::{failure_message, tracking_word};

use super::result_file::method_entry;

/// The format's name.
pub const FORMAT: &str = "handeye-odometry";
/// Its version.
pub const VERSION: u32 = 1;

/// What is known of a sequence once all frames were looked at.
#[derive(Clone, Copy, Debug)]
pub struct OdometryResult<'a> {
    /// The sequence's name.
    pub name: &'a str,
    /// How the motion was estimated.
    pub estimator: Estimator,
    /// The sequence with every frame.
    pub tracked: &'a TrackedSequence,
    /// The session that names the sequence, or an empty one: where the camera is mounted, and on what.
    pub session: &'a Session,
    /// The hand-eye calibration, where the robot's poses are known.
    pub hand_eye: Option<&'a MethodResult>,
}

impl OdometryResult<'_> {
    /// Medians over the frames that were used: time for the motion, and for reading and decoding, ms; NaN of no frame.
    #[must_use]
    pub fn medians_ms(&self) -> [f64; 2] {
        let used = || {
            self.tracked
                .records
                .iter()
                .filter(|record| record.outcome.as_ref().is_ok_and(|summary| summary.tracking != Tracking::LeftOut))
        };
        let mut motion: Vec<f64> = used().map(|record| record.motion_ms).collect();
        let mut decode: Vec<f64> = used().map(|record| record.decode_ms).collect();
        [stats::median(&mut motion), stats::median(&mut decode)]
    }

    /// Frames without a motion that should have one: their numbers, a word for files, and why.
    pub fn troubles(&self) -> impl Iterator<Item = (usize, &'static str, String)> {
        self.tracked.records.iter().enumerate().filter_map(|(number, record)| match &record.outcome {
            Err(error) => Some((number, "no-picture", error.to_string())),
            Ok(summary) => match &summary.tracking {
                Tracking::Lost(failure) => Some((number, failure.code(), failure_message(failure))),
                _ => None,
            },
        })
    }

    /// The numbers of the frames with which the trajectory begins anew after a gap.
    fn gaps(&self) -> Vec<usize> {
        let is_gap = |record: &FrameRecord| {
            let tracking = record.outcome.as_ref().map(|summary| &summary.tracking);
            matches!(tracking, Ok(Tracking::Started { is_after_gap: true }))
        };
        self.tracked
            .records
            .iter()
            .enumerate()
            .filter_map(|(number, record)| is_gap(record).then_some(number))
            .collect()
    }
}

/// The file.
#[must_use]
pub fn odometry_file(result: &OdometryResult<'_>) -> Value {
    let counts = result.tracked.counts();
    let travel = result.tracked.travel();
    let [motion_ms, decode_ms] = result.medians_ms();
    let evaluation = result.tracked.evaluation;
    let trajectory: Vec<[f64; 8]> = result.tracked.records.iter().filter_map(trajectory_row).collect();
    let mut file = json!({
        "format": FORMAT,
        "version": VERSION,
        "sequence": result.name,
        "estimator": result.estimator.id(),
        "frames": result.tracked.records.len(),
        "tracked": counts.tracked,
        "lost": counts.lost,
        "left_out": counts.left_out,
        "without_pictures": counts.unreadable,
        "distance_m": travel.distance_mm / 1000.0,
        "heading_deg": travel.heading_rad.to_degrees(),
        "turn_deg": travel.turn_rad.to_degrees(),
        "compared_poses": evaluation.map(|evaluation| evaluation.num_poses),
        "ate_rmse_m": evaluation.map(|evaluation| evaluation.ate_rmse_mm / 1000.0),
        "rpe_trans_rmse_m": evaluation.map(|evaluation| evaluation.rpe_translation_rmse_mm / 1000.0),
        "rpe_rot_rmse_deg": evaluation.map(|evaluation| evaluation.rpe_rotation_rmse_rad.to_degrees()),
        "ms_per_frame": motion_ms,
        "decode_ms_per_frame": decode_ms,
        "gaps_before": result.gaps(),
        "problems": result.troubles().map(|(number, code, message)| json!({
            "frame": number,
            "time_s": result.tracked.records[number].time_s,
            "code": code,
            "message": message,
        })).collect::<Vec<_>>(),
        "notes": result.tracked.sequence.notes.iter().map(ToString::to_string).collect::<Vec<_>>(),
        "trajectory": trajectory,
    });
    if let Some(hand_eye) = result.hand_eye {
        file["hand_eye"] = method_entry(result.session, hand_eye, None);
    }
    file
}

/// Time (s), position (m), quaternion with w last.
fn trajectory_row(record: &FrameRecord) -> Option<[f64; 8]> {
    let pose = record.outcome.as_ref().ok()?.world_from_sensor?;
    let position = pose.translation_mm() / 1000.0;
    let [w, x, y, z] = pose.quaternion_wxyz();
    Some([record.time_s, position.x, position.y, position.z, x, y, z, w])
}

/// A row a frame: what became of it, its motion with its standard deviations, its pose, the way so far, the time it took.
#[must_use]
pub fn frames_csv(records: &[FrameRecord]) -> String {
    const HEADS: [&str; 31] = [
        "frame",
        "time_s",
        "state",
        "reason",
        "features",
        "matches",
        "inliers",
        "residual_px",
        "previous_frame",
        "motion_rx_deg",
        "motion_ry_deg",
        "motion_rz_deg",
        "motion_x_mm",
        "motion_y_mm",
        "motion_z_mm",
        "std_rotation_deg",
        "std_translation_mm",
        "x_m",
        "y_m",
        "z_m",
        "qx",
        "qy",
        "qz",
        "qw",
        "step_mm",
        "distance_m",
        "heading_deg",
        "turn_deg",
        "recognised",
        "motion_ms",
        "decode_ms",
    ];
    let mut writer = csv::Writer::from_writer(Vec::new());
    // Writing to memory cannot fail, and every row has as many cells.
    let _ = writer.write_record(HEADS);
    for (number, record) in records.iter().enumerate() {
        let mut row = vec![number.to_string(), record.time_s.to_string()];
        match &record.outcome {
            Err(error) => {
                row.extend(["no picture".to_owned(), error.to_string()]);
                row.extend(std::iter::repeat_n(String::new(), 25));
            }
            Ok(summary) => {
                let reason = match &summary.tracking {
                    Tracking::Lost(failure) => failure_message(failure),
                    _ => String::new(),
                };
                row.extend([tracking_word(&summary.tracking).to_owned(), reason, summary.num_features.to_string()]);
                let motion = match &summary.tracking {
                    Tracking::Tracked(motion) => Some(motion.as_ref()),
                    _ => None,
                };
                row.extend(motion_cells(motion));
                let pose = trajectory_row(record);
                row.extend((1..8).map(|idx| pose.map_or_else(String::new, |pose| pose[idx].to_string())));
                let step = motion.map(|motion| motion.sensor_from_previous.translation.vector.norm());
                row.push(step.map_or_else(String::new, |step| step.to_string()));
                let travel = &summary.travel;
                row.extend(
                    [travel.distance_mm / 1000.0, travel.heading_rad.to_degrees(), travel.turn_rad.to_degrees()]
                        .map(|value| value.to_string()),
                );
                row.push(motion.map_or_else(String::new, |motion| motion.is_recognised.to_string()));
            }
        }
        row.extend([record.motion_ms.to_string(), record.decode_ms.to_string()]);
        let _ = writer.write_record(&row);
    }
    String::from_utf8(writer.into_inner().unwrap_or_default()).unwrap_or_default()
}

fn motion_cells(motion: Option<&Motion>) -> Vec<String> {
    let Some(motion) = motion else { return vec![String::new(); 12] };
    let rotation = crate::geometry::so3::log(&motion.sensor_from_previous.rotation).map(f64::to_degrees);
    let translation = motion.sensor_from_previous.translation.vector;
    let std = |from: usize| {
        let variance: f64 = (from..from + 3).map(|idx| motion.covariance[(idx, idx)]).sum();
        variance.sqrt()
    };
    let mut cells = vec![
        motion.num_matches.to_string(),
        motion.num_inliers.to_string(),
        motion.residual_px.to_string(),
        motion.previous.to_string(),
    ];
    cells.extend(rotation.iter().chain(translation.iter()).map(f64::to_string));
    cells.extend([std(0).to_degrees().to_string(), std(3).to_string()]);
    cells
}
