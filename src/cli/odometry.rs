//! `handeye odometry`: the motion of an RGB-D camera from a recorded sequence.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;

use crate::calibrate::motion::solve_streams;
use crate::calibrate::{Method, MethodResult};
use crate::odometry::{Estimator, OdometryOptions, Tracking};
use crate::report::odometry_file::{OdometryResult, frames_csv, odometry_file};
use crate::session::sequence::{FrameRecord, Sequence, TrackedSequence, trajectory, trajectory_text};
use crate::session::{self, Session, Target};
use crate::text::{odometry as words, warning_message};

use super::progress::watched;
use super::solve::six_numbers;
use super::{EXIT_NOTHING_COMPUTED, EXIT_WRONG_INPUT, fail};

/// Arguments of `handeye odometry`.
#[derive(Clone, Debug, clap::Args)]
pub struct OdometryArgs {
    /// Folder of a sequence (TUM RGB-D format with camera.json), or a session file that names one
    #[arg(value_name = "FOLDER|SESSION.json")]
    pub sequence: PathBuf,
    /// Write trajectory.txt (TUM format), frames.csv and odometry.json into a folder
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Print JSON instead of text
    #[arg(long)]
    pub json: bool,
    /// Estimate the motion as published instead of by our method
    #[arg(long)]
    pub published: bool,
    /// Use only a frame every so many seconds
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    pub every: Option<f64>,
}

fn seconds(text: &str) -> Result<f64, String> {
    let value = text.parse().ok().filter(|value| (1e-6..=1e6).contains(value));
    value.ok_or_else(|| "expected a number of seconds above 0".to_owned())
}

/// Runs the command.
#[must_use]
pub fn run(args: &OdometryArgs) -> ExitCode {
    match tracked(args) {
        Ok(text) => super::print(&text).map_or_else(|exit_code| exit_code, |()| ExitCode::SUCCESS),
        Err((status, reason)) => fail(status, &reason),
    }
}

type Refusal = (u8, String);

fn tracked(args: &OdometryArgs) -> Result<String, Refusal> {
    let (folder, session) = opened(&args.sequence)?;
    let sequence = Sequence::open(&folder).map_err(|error| (EXIT_WRONG_INPUT, error.to_string()))?;
    let name = name_of(&sequence.folder);
    let estimator = if args.published { Estimator::Published } else { Estimator::Ours };
    let options = OdometryOptions { estimator, period_s: args.every, ..OdometryOptions::default() };
    let tracked = watched("tracking frames", |watch| TrackedSequence::track(Arc::new(sequence), options, watch))
        .map_err(|reason| (EXIT_NOTHING_COMPUTED, reason))?;
    let trajectory = trajectory(&tracked.records);
    let hand_eye = tracked
        .streams(&session)
        .map(|streams| MethodResult { method: Method::Motion, outcome: solve_streams(&streams) });
    let result =
        OdometryResult { name: &name, estimator, tracked: &tracked, session: &session, hand_eye: hand_eye.as_ref() };
    if trajectory.is_empty() {
        let reason = result.troubles().next().map_or_else(String::new, |(_, _, reason)| reason);
        return Err((EXIT_NOTHING_COMPUTED, words::nothing_tracked(&name, &reason)));
    }
    let file = format!("{:#}\n", odometry_file(&result));
    if let Some(folder) = &args.out {
        let poses = trajectory.iter().map(|pose| (pose.time_s, pose.world_from_sensor));
        write_files(
            folder,
            &[
                ("trajectory.txt", &trajectory_text(poses)),
                ("frames.csv", &frames_csv(&tracked.records)),
                ("odometry.json", &file),
            ],
        )?;
    }
    if args.json {
        return Ok(file);
    }
    let mut text = report(&result);
    if let Some(folder) = &args.out {
        text.push_str(&words::wrote_odometry(&folder.display().to_string()));
    }
    Ok(text)
}

/// The folder itself, or that of a session, and what the session says of the robot.
fn opened(path: &Path) -> Result<(PathBuf, Session), Refusal> {
    if path.is_dir() || !path.exists() {
        return Ok((path.to_owned(), Session::new(Target::Rgbd { sequence: String::new() })));
    }
    let session = session::load(path).map_err(|error| (EXIT_WRONG_INPUT, error.to_string()))?;
    let Target::Rgbd { sequence } = &session.target else {
        return Err((EXIT_WRONG_INPUT, words::not_a_sequence_session(&path.display().to_string())));
    };
    Ok((path.parent().unwrap_or(Path::new(".")).join(sequence), session))
}

fn name_of(folder: &Path) -> String {
    let whole = folder.canonicalize().unwrap_or_else(|_| folder.to_owned());
    whole.file_name().map_or_else(|| folder.display().to_string(), |name| name.to_string_lossy().into_owned())
}

fn write_files(folder: &Path, files: &[(&str, &str)]) -> Result<(), Refusal> {
    let refused = |path: &Path, error: &std::io::Error| {
        (EXIT_WRONG_INPUT, format!("--out: cannot write {}: {error}", path.display()))
    };
    std::fs::create_dir_all(folder).map_err(|error| refused(folder, &error))?;
    files.iter().try_for_each(|(name, text)| {
        let path = folder.join(name);
        std::fs::write(&path, text).map_err(|error| refused(&path, &error))
    })
}

/// Writing to a string does not fail, hence the `ok()`s.
fn report(result: &OdometryResult<'_>) -> String {
    const MOST_TROUBLES: usize = 10;
    let TrackedSequence { sequence, records, evaluation } = result.tracked;
    let color = &sequence.camera.color;
    let mut out = words::odometry_head(result.name, records.len(), [color.width, color.height], result.estimator);
    for note in &sequence.notes {
        writeln!(out, "note: {note}").ok();
    }
    let counts = result.tracked.counts();
    writeln!(out, "{}", words::tracked_line(counts.tracked, counts.lost, counts.left_out, counts.unreadable)).ok();
    writeln!(out, "{}", words::travel_line(&result.tracked.travel())).ok();
    let [motion_ms, decode_ms] = result.medians_ms();
    writeln!(out, "{}", words::speed_line(motion_ms, decode_ms)).ok();
    if let Some(evaluation) = evaluation {
        writeln!(out, "against the ground truth, {}", words::evaluation_line(evaluation)).ok();
    }
    hand_eye(&mut out, result);
    out.push('\n');
    frames_table(&mut out, records);
    let troubles: Vec<_> = result.troubles().collect();
    if !troubles.is_empty() {
        writeln!(out, "\n{}", words::trouble_head(troubles.len())).ok();
        for (number, _, reason) in troubles.iter().take(MOST_TROUBLES) {
            writeln!(out, "  {number} ({:.3} s): {reason}", records[*number].time_s).ok();
        }
        if troubles.len() > MOST_TROUBLES {
            writeln!(out, "  {}", words::trouble_more(troubles.len() - MOST_TROUBLES)).ok();
        }
    }
    out
}

/// Where the camera sits on the robot.
fn hand_eye(out: &mut String, result: &OdometryResult<'_>) {
    let Some(found) = result.hand_eye else { return };
    match &found.outcome {
        Err(error) => writeln!(out, "\n{}", words::no_hand_eye(&error.to_string())).ok(),
        Ok(solution) => {
            writeln!(out, "\n{}", words::HAND_EYE_HEAD).ok();
            six_numbers(out, result.session, &solution.flange_from_sensor, solution.uncertainty.as_ref());
            if let Some(offset) = solution.motion.as_ref().and_then(|found| found.time_offset) {
                writeln!(out, "  {}", words::time_offset(offset.offset_s, offset.std_s)).ok();
            }
            solution.warnings.iter().try_for_each(|warning| writeln!(out, "  {}", warning_message(warning))).ok()
        }
    };
}

/// Some frames, evenly over the sequence.
fn frames_table(out: &mut String, records: &[FrameRecord]) {
    const MOST_ROWS: usize = 20;
    const WIDTHS: [usize; 9] = [18, 9, 9, 9, 9, 11, 9, 8, 0];
    let line = |cells: [String; 9]| {
        let mut text = String::new();
        for (cell, width) in cells.iter().zip(WIDTHS).take(8) {
            write!(text, "{cell:>width$}").ok();
        }
        format!("{text}  {}", cells[8]).trim_end().to_owned()
    };
    writeln!(out, "{}", line(words::FRAME_COLUMNS.map(str::to_owned))).ok();
    let shown: Vec<&FrameRecord> = records
        .iter()
        .filter(|record| record.outcome.as_ref().is_ok_and(|summary| summary.tracking != Tracking::LeftOut))
        .collect();
    let last = shown.len().saturating_sub(1);
    let rows = MOST_ROWS.min(shown.len());
    for row in 0..rows {
        let record = shown[if rows > 1 { row * last / (rows - 1) } else { 0 }];
        let Ok(summary) = &record.outcome else { continue };
        let position = summary.world_from_sensor.map(|pose| pose.translation_mm() / 1000.0);
        let axis = |idx: usize| position.map_or_else(|| "-".to_owned(), |position| format!("{:.4}", position[idx]));
        let inliers = match &summary.tracking {
            Tracking::Tracked(motion) => motion.num_inliers.to_string(),
            _ => "-".to_owned(),
        };
        let cells = [
            format!("{:.4}", record.time_s),
            axis(0),
            axis(1),
            axis(2),
            format!("{:.3}", summary.travel.distance_mm / 1000.0),
            format!("{:+.2}", summary.travel.heading_rad.to_degrees()),
            inliers,
            format!("{:.1}", record.motion_ms),
            match &summary.tracking {
                Tracking::Tracked(motion) if !motion.is_recognised => String::new(),
                other => words::tracking_word(other).to_owned(),
            },
        ];
        writeln!(out, "{}", line(cells)).ok();
    }
    writeln!(out, "{}", words::FRAME_FOOT).ok();
}
