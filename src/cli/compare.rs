//! `handeye compare`: how far two calibrations are apart, and whether chance explains it.

use std::path::PathBuf;
use std::process::ExitCode;

use crate::geometry::Vec3;
use crate::report::result_history::file::comparison_file;
use crate::report::result_history::{ComparedPoints, NotCompared, compared_points, read_compared};
use crate::text::compare_results as words;
use crate::verify::difference::difference;
use crate::watch::Unwatched;

use super::{EXIT_NOTHING_COMPUTED, EXIT_WRONG_INPUT, fail};

/// Arguments of `handeye compare`.
#[derive(Clone, Debug, clap::Args)]
pub struct CompareArgs {
    /// The calibration to compare with: a result file, a matrix, or a session, which is solved
    #[arg(value_name = "A")]
    pub first: PathBuf,
    /// The calibration that is compared
    #[arg(value_name = "B")]
    pub second: PathBuf,
    /// Compare at this point too, in the sensor frame, mm; may be given several times
    #[arg(long = "at", value_name = "x,y,z", value_parser = point, allow_hyphen_values = true)]
    pub points: Vec<Vec3>,
    /// Print the comparison (JSON) instead of sentences
    #[arg(long)]
    pub json: bool,
}

fn point(text: &str) -> Result<Vec3, String> {
    let numbers: Option<Vec<f64>> = text.split(',').map(|number| number.trim().parse().ok()).collect();
    let numbers = numbers.filter(|numbers| numbers.len() == 3 && numbers.iter().all(|number| number.is_finite()));
    numbers.map(|numbers| Vec3::from_column_slice(&numbers)).ok_or_else(|| words::not_a_point(text))
}

/// Runs the command.
#[must_use]
pub fn run(args: &CompareArgs) -> ExitCode {
    match compared(args) {
        Ok(text) => super::print(&text).map_or_else(|exit_code| exit_code, |()| ExitCode::SUCCESS),
        Err(refusal) => refuse(&refusal),
    }
}

/// Ends with the status that goes with a refusal.
pub(super) fn refuse(refusal: &NotCompared) -> ExitCode {
    let status = match refusal {
        NotCompared::Wrong(_) => EXIT_WRONG_INPUT,
        NotCompared::NothingComputed(_) => EXIT_NOTHING_COMPUTED,
    };
    fail(status, &refusal.reason())
}

fn compared(args: &CompareArgs) -> Result<String, NotCompared> {
    let first = read_compared(&args.first, &mut Unwatched)?;
    let second = read_compared(&args.second, &mut Unwatched)?;
    if first.mount != second.mount {
        return Err(NotCompared::Wrong(words::mounts_differ(&first.name, &second.name)));
    }
    let found = difference(&first.stated, &second.stated);
    let points = compared_points(&first, &second, &args.points);
    if args.json {
        return Ok(format!("{:#}\n", comparison_file(&first, &second, &found, &points)));
    }
    let mut said = words::compare_head(&first.name, &second.name);
    for calibration in [&first, &second].into_iter().filter(|calibration| calibration.is_nearest) {
        said.push_str(&words::nearest_line(&calibration.name));
    }
    said.push('\n');
    said.push_str(&words::difference_lines(&found));
    let ComparedPoints { reference, given, measured } = &points;
    if let Some(shift) = reference {
        said.push_str(&words::point_line(words::REFERENCE_POINT, shift, found.known));
    }
    for shift in given {
        said.push_str(&words::point_line(words::GIVEN_POINT, shift, found.known));
    }
    if !measured.is_empty() {
        let sizes: Vec<f64> = measured.iter().map(|shift| shift.shift_mm.norm()).collect();
        #[expect(clippy::cast_precision_loss, reason = "stations of two sessions")]
        let mean = sizes.iter().sum::<f64>() / sizes.len() as f64;
        said.push_str(&words::measured_line(sizes.len(), mean, sizes.iter().copied().fold(0.0, f64::max)));
    }
    Ok(said)
}
