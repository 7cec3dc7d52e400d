//! `handeye export`: the poses and profiles of a session as CSV.

use std::path::PathBuf;
use std::process::ExitCode;

use crate::geometry::PoseConvention;
use crate::geometry::notation::OrientationForm;
use crate::session::export::{TableStyle, poses_csv, write_profiles, write_text};
use crate::session::load;
use crate::text::import_cli as text;

use super::import::SeparatorArg;
use super::{EXIT_WRONG_INPUT, fail};

/// Arguments of `handeye export`.
#[derive(Clone, Debug, clap::Args)]
pub struct ExportArgs {
    /// The session file.
    pub file: PathBuf,
    /// The table of poses to write.
    #[arg(long, value_name = "CSV")]
    pub poses: PathBuf,
    /// The folder for the profiles, one file each.
    #[arg(long, value_name = "FOLDER")]
    pub profiles: Option<PathBuf>,
    /// Between the cells.
    #[arg(long, value_enum, default_value_t = SeparatorArg::Comma)]
    pub separator: SeparatorArg,
    /// One and a half is 1,5.
    #[arg(long)]
    pub decimal_comma: bool,
    /// Angles of this maker in place of the session's.
    #[arg(long, value_parser = convention, value_name = "ID")]
    pub convention: Option<&'static PoseConvention>,
    /// Overwrite files that are there.
    #[arg(long)]
    pub force: bool,
}

fn convention(id: &str) -> Result<&'static PoseConvention, String> {
    PoseConvention::by_id(id)
        .ok_or_else(|| format!("found {id}, expected the name of a convention such as fanuc-wpr or kuka-abc"))
}

/// Writes the files.
#[must_use]
pub fn run(args: &ExportArgs) -> ExitCode {
    match export(args) {
        Ok(said) => match super::print(&said) {
            Ok(()) => ExitCode::SUCCESS,
            Err(exit_code) => exit_code,
        },
        Err(message) => fail(EXIT_WRONG_INPUT, &message),
    }
}

fn export(args: &ExportArgs) -> Result<String, String> {
    let session = load(&args.file).map_err(|error| error.to_string())?;
    let style = TableStyle { separator: args.separator.into(), has_decimal_comma: args.decimal_comma };
    if style.has_decimal_comma && args.separator == SeparatorArg::Comma {
        return Err(text::COMMA_TWICE.to_owned());
    }
    let mut notation = session.robot.notation;
    if let Some(convention) = args.convention {
        notation.convention = convention;
        notation.orientation = OrientationForm::Angles;
    }
    let same = |path: &PathBuf| path.canonicalize().ok();
    if same(&args.poses).is_some_and(|poses| same(&args.file) == Some(poses)) || load(&args.poses).is_ok() {
        return Err(text::over_a_session(&args.poses.display().to_string()));
    }
    write_text(&args.poses, &poses_csv(&session, &notation, style), args.force).map_err(|error| error.to_string())?;
    let mut said = text::exported_line(&args.poses.display().to_string(), session.num_captures(), "pose");
    if let Some(folder) = &args.profiles {
        let num_profiles = write_profiles(&session, folder, style, args.force).map_err(|error| error.to_string())?;
        said.push_str(&text::exported_line(&folder.display().to_string(), num_profiles, "profile"));
    }
    Ok(said)
}
