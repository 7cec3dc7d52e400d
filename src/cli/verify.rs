//! `handeye verify`: what a session's calibrations, and others, are worth on other data than their own.

use std::fmt::Write as _;
use std::path::PathBuf;
use std::process::ExitCode;

use crate::calibrate::MethodResult;
use crate::report::calibration_file::read_calibration_for;
use crate::report::digits::{fixed, signed};
use crate::report::verification::{adding_targets_of, verification};
use crate::report::verification_file::{Checked, verification_file};
use crate::session::{self, Session, measure_in};
use crate::text::verify as words;
use crate::verify::{Calibration, Distances, Measurement, Origin, Stability, TargetEvidence, Verification};
use crate::watch::Unwatched;

use super::solve::six_numbers;
use super::{EXIT_NOTHING_COMPUTED, EXIT_WRONG_INPUT, fail, folder_of};

/// Arguments of `handeye verify`.
#[derive(Clone, Debug, clap::Args)]
pub struct VerifyArgs {
    /// Session file
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// Session file with another target of the same sensor; may be given several times
    #[arg(long = "with", value_name = "FILE")]
    pub with: Vec<PathBuf>,
    /// Result file (`handeye solve --json`) or text file with a matrix, to be judged along; may be given several times
    #[arg(long = "calibration", value_name = "RESULT.json|MATRIX")]
    pub calibrations: Vec<PathBuf>,
    /// Print the verification file (JSON) instead of tables
    #[arg(long)]
    pub json: bool,
}

/// Runs the command.
#[must_use]
pub fn run(args: &VerifyArgs) -> ExitCode {
    match verified(args) {
        Ok(text) => super::print(&text).map_or_else(|exit_code| exit_code, |()| ExitCode::SUCCESS),
        Err((exit_code, reason)) => fail(exit_code, &reason),
    }
}

type Refusal = (u8, String);

fn verified(args: &VerifyArgs) -> Result<String, Refusal> {
    let session = with_further(args)?;
    let (given, checked) = given(args, &session)?;
    let nothing = |reason: String| (EXIT_NOTHING_COMPUTED, reason);
    let measured = measure_in(folder_of(&args.file), &session, &mut Unwatched)
        .map_err(|cancelled| nothing(cancelled.to_string()))?;
    let own = match session::problem(&session, &measured) {
        Ok(problem) => {
            let results = problem.solve_all(problem.methods(), &mut Unwatched);
            let results = results.map_err(|cancelled| nothing(cancelled.to_string()))?;
            Some((problem, results))
        }
        Err(refusal) if session.further.is_empty() && given.is_empty() => {
            return Err(nothing(words::nothing_own(&refusal.to_string(), !session.scans().is_empty())));
        }
        Err(_) => None,
    };
    let solved = own.as_ref().map(|(problem, results)| (problem, results.as_slice()));
    let found = verification(&session, &measured, solved, &given, &[], &mut Unwatched)
        .map_err(|cancelled| nothing(cancelled.to_string()))?;
    if found.calibrations.is_empty() {
        let results = own.as_ref().map_or(&[][..], |(_, results)| results.as_slice());
        return Err(nothing(words::nothing_to_verify(&first_reason(results))));
    }
    if args.json {
        return Ok(format!("{:#}\n", verification_file(&session, &found, &checked)));
    }
    Ok(tables(args, &session, &found, &checked))
}

fn first_reason(results: &[MethodResult]) -> String {
    results.iter().find_map(|result| result.outcome.as_ref().err()).map_or_else(String::new, ToString::to_string)
}

/// The session with the targets of the others added.
fn with_further(args: &VerifyArgs) -> Result<Session, Refusal> {
    let wrong = |reason: String| (EXIT_WRONG_INPUT, reason);
    let load = |path: &PathBuf| session::load(path).map_err(|error| wrong(error.to_string()));
    let mut session = load(&args.file)?;
    for path in &args.with {
        let other = load(path)?;
        let shown = path.display().to_string();
        if other.mount != session.mount {
            return Err(wrong(words::other_mount(&shown)));
        }
        let name = path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
        let edit = adding_targets_of(other, &name);
        session = edit.apply(&session).map_err(|refusal| wrong(format!("{shown}: {refusal}")))?;
    }
    Ok(session)
}

/// The calibrations given, each with its check; of one that is no rotation the nearest is judged.
fn given(args: &VerifyArgs, session: &Session) -> Result<(Vec<Calibration>, Vec<Checked>), Refusal> {
    let (mut calibrations, mut checked) = (Vec::new(), Vec::new());
    for path in &args.calibrations {
        let read = read_calibration_for(path, session.mount).map_err(|error| (EXIT_WRONG_INPUT, error.to_string()))?;
        let origin = Origin::Given { name: read.name.clone(), is_nearest: !read.check.is_rotation() };
        let flange_from_sensor = read.flange_from_sensor;
        calibrations.push(Calibration { origin, flange_from_sensor, workspace_point_std_mm: None });
        checked.push((read.name, read.check));
    }
    Ok((calibrations, checked))
}

/// Everything for a terminal 100 columns wide, if names are short enough.
///
/// Writing to a string does not fail, hence the `ok()`s.
fn tables(args: &VerifyArgs, session: &Session, found: &Verification, checked: &[Checked]) -> String {
    let mut out = words::verify_head(&session.name, found.calibrations.len(), found.targets.len());
    for (name, check) in checked {
        out.push('\n');
        out.push_str(&words::matrix_lines(name, check));
    }
    for target in &found.targets {
        refused(&mut out, target);
    }
    let names: Vec<String> =
        found.calibrations.iter().map(|calibration| words::calibration_name(&calibration.origin, found)).collect();
    for (target_idx, target) in found.targets.iter().enumerate() {
        let own: Vec<bool> = (0..names.len()).map(|idx| found.has_seen(idx, target_idx)).collect();
        let labels = Labels { names: &names, own: &own };
        distances(&mut out, target, labels);
        stability(&mut out, target, labels);
    }
    if !found.targets.is_empty() {
        cross_table(&mut out, found, &names);
        joint(&mut out, session, found);
        out.push_str(words::OWN_DATA_FOOT);
    }
    if !session.scans().is_empty() {
        out.push_str(&words::scans_elsewhere(&args.file.display().to_string()));
    }
    out
}

/// Which profiles count for nothing, and why: the first of them.
fn refused(out: &mut String, target: &TargetEvidence) {
    const MOST: usize = 3;
    let refused: Vec<_> = target.refused().collect();
    if refused.is_empty() {
        return;
    }
    writeln!(out, "\n{}", words::refused(&target.name, refused.len(), target.num_captures())).ok();
    for capture in refused.iter().take(MOST) {
        writeln!(out, "  {}", words::refused_capture(capture.station, &capture.refusal.to_string())).ok();
    }
    if refused.len() > MOST {
        writeln!(out, "  {}", words::more_refused(refused.len() - MOST)).ok();
    }
}

/// Calibrations at the head of rows, and which of them were computed from the target at hand.
#[derive(Clone, Copy)]
struct Labels<'a> {
    names: &'a [String],
    own: &'a [bool],
}

impl Labels<'_> {
    /// The name, with a star if the data are its own; cut to a column.
    fn label(self, idx: usize, width: usize) -> String {
        let short: String = self.names[idx].chars().take(width - 3).collect();
        let star = if self.own[idx] { " *" } else { "" };
        format!("{:<width$}", short + star)
    }

    fn width(self) -> usize {
        label_width(self.names)
    }
}

/// Of the column of names: as wide as the longest of them, within reason.
fn label_width(names: &[String]) -> usize {
    names.iter().map(|name| name.chars().count() + 3).max().unwrap_or(0).clamp(32, 60)
}

fn distances(out: &mut String, target: &TargetEvidence, labels: Labels<'_>) {
    let rows: Vec<(usize, &Distances)> =
        target.rows.iter().enumerate().filter_map(|(idx, row)| Some((idx, row.as_ref().ok()?.distances()?))).collect();
    let Some((_, first)) = rows.first() else { return };
    out.push_str(&words::distances_head(&target.name, first.points.len(), labels.width()));
    for (idx, distances) in rows {
        let mut line = labels.label(idx, labels.width());
        for figures in [&distances.to_line, &distances.to_plane] {
            for value in [figures.mean_mm, figures.std_mm, figures.max_mm] {
                write!(line, "{:>8}", fixed(value, 3)).ok();
            }
            line.push_str("  ");
        }
        write!(line, "{:>9}{:>8}", fixed(distances.angle_rad.to_degrees(), 3), fixed(distances.gap_mm, 3)).ok();
        writeln!(out, "{}", line.trim_end()).ok();
    }
}

fn stability(out: &mut String, target: &TargetEvidence, labels: Labels<'_>) {
    /// Three columns of figures.
    const PAIR_WIDTH: usize = 34;
    let seen: Vec<(usize, &[Measurement], &Stability)> = target
        .rows
        .iter()
        .enumerate()
        .filter_map(|(idx, row)| {
            let (measurements, stability) = row.as_ref().ok()?.stability()?;
            Some((idx, measurements, stability))
        })
        .collect();
    let Some((_, _, first)) = seen.first() else { return };
    out.push_str(&words::stability_head(&target.name, first.is_touched));
    // Two calibrations beside each other fill a terminal, as in the paper.
    for pair in seen.chunks(2) {
        let head: String = pair.iter().map(|(idx, ..)| labels.label(*idx, PAIR_WIDTH)).collect();
        writeln!(out, "\n{:<14}{}", "", head.trim_end()).ok();
        let axes = format!("{:>10}{:>10}{:>10}    ", "Δx", "Δy", "Δz");
        writeln!(out, "{:<10}{}", words::NUMBER, axes.repeat(pair.len()).trim_end()).ok();
        let mut row = |name: &str, value: &dyn Fn(&Stability) -> [String; 3]| {
            let columns = pair.iter().map(|(_, _, stability)| {
                let [x, y, z] = value(stability);
                format!("{x:>10}{y:>10}{z:>10}    ")
            });
            writeln!(out, "{name:<10}{}", columns.collect::<String>().trim_end()).ok();
        };
        for (idx, measured) in pair[0].1.iter().enumerate() {
            row(&measured.name(), &|stability| three(stability.deviations_mm[idx], signed));
        }
        row(words::MEAN, &|stability| three(stability.mean_mm, signed));
        row(words::THREE_DELTA, &|stability| three(stability.three_std_mm(), fixed));
    }
}

fn three(vector: crate::geometry::Vec3, text: fn(f64, usize) -> String) -> [String; 3] {
    [vector.x, vector.y, vector.z].map(|value| text(value, 3))
}

fn cross_table(out: &mut String, found: &Verification, names: &[String]) {
    out.push_str(words::CROSS_TABLE_HEAD);
    let width = label_width(names);
    let widths: Vec<usize> =
        found.targets.iter().map(|target| (target.name.chars().count() + 2).clamp(20, 40)).collect();
    let mut head = format!("{:<width$}", "");
    for (target, width) in found.targets.iter().zip(&widths) {
        write!(head, "{:>width$}", target.name.chars().take(width - 1).collect::<String>()).ok();
    }
    writeln!(out, "{head}").ok();
    for (idx, name) in names.iter().enumerate() {
        let mut line = format!("{:<width$}", name.chars().take(width - 1).collect::<String>());
        for (target, width) in widths.iter().enumerate() {
            let cell = match found.cell(idx, target) {
                Some(Ok(evaluation)) => {
                    let figures = &evaluation.figures;
                    let star = if found.has_seen(idx, target) { " *" } else { "  " };
                    format!("{} / {}{star}", fixed(figures.rms_mm, 3), fixed(figures.max_mm, 3))
                }
                _ => "–  ".to_owned(),
            };
            write!(line, "{cell:>width$}").ok();
        }
        writeln!(out, "{}", line.trim_end()).ok();
    }
    let refusals = found.targets.iter().filter_map(|target| {
        let refusal = target.rows.iter().find_map(|row| row.as_ref().err())?;
        Some(format!("{}: {refusal}\n", target.name))
    });
    out.push_str(&refusals.collect::<String>());
}

/// The calibration from all targets, and what each of them says of it.
fn joint(out: &mut String, session: &Session, found: &Verification) {
    let Some(joint) = &found.joint else { return };
    let solution = match &joint.outcome {
        Ok(solution) => solution,
        Err(error) => return out.push_str(&words::no_joint(&error.to_string())),
    };
    out.push_str(words::JOINT_HEAD);
    six_numbers(out, session, &solution.flange_from_sensor, Some(&solution.uncertainty));
    let names = || joint.target_idxs.iter().map(|idx| found.targets.get(*idx).map_or("", |target| &target.name));
    let width = names().map(|name| name.chars().count() + 4).max().unwrap_or(0).max(16);
    out.push_str(&words::joint_targets_head(width));
    for (name, target) in names().zip(&solution.targets) {
        let alone = target.alone.uncertainty.as_ref().map_or(f64::NAN, |known| known.workspace_point_std_mm);
        let together = solution.uncertainty.workspace_point_std_mm;
        let line = words::joint_target(name, width, [alone, together, target.moved_mm], target.p_value);
        writeln!(out, "{line}").ok();
    }
    writeln!(out, "{}", words::JOINT_HINT).ok();
}
