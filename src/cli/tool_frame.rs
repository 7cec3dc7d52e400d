//! `handeye tool-frame`: a calibration as text for a controller, ROS or a program, read back and compared.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use crate::calibrate::verdict::judge;
use crate::calibrate::{Mount, Verdict};
use crate::report::best_solution;
use crate::report::calibration_file::read_calibration;
use crate::report::tool_frame::{Format, Name, Parent, ToolFrame, formats};
use crate::session::export::write_text;
use crate::session::{self, measure_in};
use crate::text::tool_frame as words;
use crate::watch::Unwatched;

use super::{EXIT_NOTHING_COMPUTED, EXIT_WRONG_INPUT, fail, folder_of};

/// Arguments of `handeye tool-frame`.
#[derive(Clone, Debug, clap::Args)]
pub struct ToolFrameArgs {
    /// Session file (its best result is taken), result file (`handeye solve --json`), or text file with a matrix
    #[arg(value_name = "FILE", required_unless_present = "list")]
    pub file: Option<PathBuf>,
    /// Write this format; may be given several times
    #[arg(long = "format", value_name = "ID", value_parser = format_of, required_unless_present = "list")]
    pub formats: Vec<Format>,
    /// List the formats with their conventions
    #[arg(long)]
    pub list: bool,
    /// Name of the tool
    #[arg(long, default_value = "scanner")]
    pub name: String,
    /// Number of the tool in the controller
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u8).range(1..=99))]
    pub number: u8,
    /// Write each format into a file of this folder instead of printing it
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Overwrite files that are there
    #[arg(long, requires = "out")]
    pub force: bool,
}

fn format_of(id: &str) -> Result<Format, String> {
    Format::by_id(id).ok_or_else(|| words::no_such_format(id))
}

/// Runs the command.
#[must_use]
pub fn run(args: &ToolFrameArgs) -> ExitCode {
    let said = match &args.file {
        _ if args.list => Ok(formats().map(|format| words::list_line(format.id, format.label, format.units)).collect()),
        Some(file) => frame_of(file, args).and_then(|frame| written(args, &frame)),
        None => Err((EXIT_WRONG_INPUT, words::NO_FILE.to_owned())),
    };
    match said {
        Ok(text) => super::print(&text).map_or_else(|exit_code| exit_code, |()| ExitCode::SUCCESS),
        Err((status, reason)) => fail(status, &reason),
    }
}

type Refusal = (u8, String);

fn frame_of(file: &Path, args: &ToolFrameArgs) -> Result<ToolFrame, Refusal> {
    let name = Name::from_words(&args.name);
    if let Ok(calibration) = read_calibration(file) {
        if !calibration.check.is_rotation() {
            return Err((EXIT_WRONG_INPUT, words::no_rotation(&file.display().to_string(), calibration.check.defect)));
        }
        // A file says how sure it is in ways of its own, a matrix not at all: the heading leaves that out.
        return Ok(ToolFrame {
            flange_from_sensor: calibration.flange_from_sensor,
            parent: Parent::of(calibration.mount.unwrap_or(Mount::OnFlange)),
            name,
            number: args.number,
            is_camera: false,
            std_mm_deg: None,
        });
    }
    let session = session::load(file).map_err(|error| (EXIT_WRONG_INPUT, error.to_string()))?;
    let best = measure_in(folder_of(file), &session, &mut Unwatched)
        .and_then(|measured| best_solution(&session, &measured, &mut Unwatched))
        .unwrap_or_else(|cancelled| Err(cancelled.to_string()))
        .map_err(|reason| (EXIT_NOTHING_COMPUTED, reason))?;
    if judge(&best).0 == Verdict::NotUsable {
        super::remark(&words::NOT_USABLE);
    }
    Ok(ToolFrame::of_solution(&best, name, args.number))
}

fn written(args: &ToolFrameArgs, frame: &ToolFrame) -> Result<String, Refusal> {
    let wrong = |reason: String| (EXIT_WRONG_INPUT, reason);
    let mut said = String::new();
    for format in &args.formats {
        if !format.suits(frame.parent) {
            return Err(wrong(words::not_of_a_fixed_sensor(format.id)));
        }
        let trip = format.check(frame).map_err(|error| (EXIT_NOTHING_COMPUTED, error.to_string()))?;
        let text = format.write(frame);
        match &args.out {
            None => said.push_str(&text),
            Some(folder) => {
                let path = folder.join(format!("{}.{}", format.id, format.extension));
                std::fs::create_dir_all(folder)
                    .map_err(|error| wrong(words::no_folder(&folder.display().to_string(), &error.to_string())))?;
                write_text(&path, &text, args.force).map_err(|error| wrong(error.to_string()))?;
                said.push_str(&words::wrote(&path.display().to_string(), trip.translation_mm, trip.rotation_deg));
            }
        }
    }
    Ok(said)
}
