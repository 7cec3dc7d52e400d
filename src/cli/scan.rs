//! `handeye scan`: planes, teeth and diameters of a scanned part, seen through a calibration.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use serde_json::Value;

use crate::geometry::{Flange, Sensor, Transform, Vec3};
use crate::report::best_solution;
use crate::report::calibration_file::{NamedCalibration, read_calibration_for};
use crate::report::scan_file::scan_file;
use crate::scan::files::{CloudFormat, read_cloud, write_cloud};
use crate::scan::{Cloud, PointSet, Region, RoundKind, SegmentOptions, Wanted, plane_regions, region_name, shapes};
use crate::session::{self, Known, SessionScan, measure_in};
use crate::text::verify::matrix_lines;
use crate::text::workpiece as words;
use crate::watch::Unwatched;

use super::{EXIT_NOTHING_COMPUTED, EXIT_WRONG_INPUT, fail, folder_of};

/// Arguments of `handeye scan`.
#[derive(Clone, Debug, clap::Args)]
#[command(allow_negative_numbers = true)]
#[expect(clippy::struct_excessive_bools, reason = "each is a switch of the command line")]
pub struct ScanArgs {
    /// Session file with a scan (target or further target `workpiece`), or a file of points (.ply, .csv, .xyz)
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// Result file (`handeye solve --json`) or text file with a matrix; the session's own best result if not given
    #[arg(long, value_name = "RESULT.json|MATRIX")]
    pub calibration: Option<PathBuf>,
    /// Only this scan, by its name as printed; may be given several times
    #[arg(long = "scan", value_name = "NAME")]
    pub scans: Vec<String>,
    /// Write the points in the base to a PLY or CSV file
    #[arg(long, value_name = "CLOUD.ply|CLOUD.csv")]
    pub out: Option<PathBuf>,
    /// Write PLY as text
    #[arg(long, requires = "out")]
    pub ascii: bool,
    /// Fit a plane to the points in a box (two corners, mm); may be given several times. Without it planes are looked for
    #[arg(long, num_args = 6, value_names = ["X0", "Y0", "Z0", "X1", "Y1", "Z1"], value_parser = finite)]
    pub plane: Vec<f64>,
    /// Greatest distance of a plane's points when planes are looked for, mm
    #[arg(long, value_name = "MM", value_parser = positive)]
    pub tolerance: Option<f64>,
    /// Measure pitch and height of teeth (by itself where the session knows their nominal values)
    #[arg(long)]
    pub teeth: bool,
    /// Measure the diameter of a cylinder
    #[arg(long, conflicts_with = "ball")]
    pub cylinder: bool,
    /// Measure the diameter of a ball
    #[arg(long)]
    pub ball: bool,
    /// Print JSON instead of text
    #[arg(long)]
    pub json: bool,
}

/// One cloud to measure on.
struct Case {
    name: String,
    num_profiles: Option<usize>,
    calibration: Option<String>,
    known: Known,
    cloud: Cloud,
}

/// Runs the command.
#[must_use]
pub fn run(args: &ScanArgs) -> ExitCode {
    match scanned(args) {
        Ok(text) => match super::print(&text) {
            Ok(()) => ExitCode::SUCCESS,
            Err(exit_code) => exit_code,
        },
        Err((status, reason)) => fail(status, &reason),
    }
}

type Refusal = (u8, String);

fn scanned(args: &ScanArgs) -> Result<String, Refusal> {
    let wrong = |error: &dyn std::fmt::Display| (EXIT_WRONG_INPUT, error.to_string());
    let format = args.out.as_deref().map(CloudFormat::of).transpose().map_err(|error| wrong(&error))?;
    let format =
        format.map(|format| if args.ascii && format == CloudFormat::Ply { CloudFormat::PlyText } else { format });
    let (mut text, cases) = if is_cloud(&args.file) {
        let read = read_cloud(&args.file, &mut Unwatched).map_err(|error| wrong(&error))?;
        let name = args.file.display().to_string();
        let known = Known::default();
        (String::new(), vec![Case { name, num_profiles: None, calibration: None, known, cloud: read.cloud }])
    } else {
        from_session(args)?
    };
    let mut files = Vec::new();
    for case in &cases {
        let (head, file) = measured(args, case)?;
        text.push_str(&head);
        files.push(file);
    }
    if let Some((path, format)) = args.out.as_ref().zip(format) {
        // All scans together where there are several.
        write_cloud(&cases[0].cloud, path, format, &mut Unwatched).map_err(|error| wrong(&error))?;
        if !args.json {
            text.push_str(&words::wrote_cloud(&path.display().to_string(), cases[0].cloud.len()));
        }
    }
    if args.json {
        return Ok(match files.as_slice() {
            [only] => format!("{only:#}\n"),
            _ => format!("{:#}\n", Value::Array(files)),
        });
    }
    Ok(text)
}

fn is_cloud(path: &Path) -> bool {
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase()).unwrap_or_default();
    matches!(ending.as_str(), "ply" | "csv" | "xyz" | "txt" | "asc" | "pts")
}

/// The scans chosen, and what is to be said of the calibration.
fn from_session(args: &ScanArgs) -> Result<(String, Vec<Case>), Refusal> {
    let mut notes = String::new();
    let wrong = |reason: String| (EXIT_WRONG_INPUT, reason);
    let session = session::load(&args.file).map_err(|error| wrong(error.to_string()))?;
    let scans = session.scans();
    let names: Vec<String> = scans.iter().map(words::scan_name).collect();
    let chosen: Vec<&SessionScan> = if args.scans.is_empty() {
        first_of_each_part(&scans)
    } else {
        let find = |wanted: &String| {
            let place = names.iter().position(|name| name == wanted);
            place.map(|place| &scans[place]).ok_or_else(|| wrong(words::no_such_scan(wanted, &names)))
        };
        args.scans.iter().map(find).collect::<Result<_, _>>()?
    };
    if chosen.is_empty() {
        return Err(wrong(words::NO_SCAN.to_owned()));
    }
    let calibration = match &args.calibration {
        Some(path) => {
            let read = read_calibration_for(path, session.mount).map_err(|error| wrong(error.to_string()))?;
            // What was no rotation is told, once, before everything that was measured through the nearest.
            notes.push_str(&if read.check.is_rotation() {
                String::new()
            } else {
                matrix_lines(&read.name, &read.check)
            });
            read.named()
        }
        None => measure_in(folder_of(&args.file), &session, &mut Unwatched)
            .and_then(|measured| best_solution(&session, &measured, &mut Unwatched))
            .unwrap_or_else(|cancelled| Err(cancelled.to_string()))
            .map(|solution| NamedCalibration::of(&solution))
            .map_err(|reason| (EXIT_NOTHING_COMPUTED, words::no_calibration(&reason)))?,
    };
    let case = |scan| case_of(scan, &calibration.name, &calibration.flange_from_sensor);
    Ok((notes, chosen.into_iter().map(case).collect::<Result<_, _>>()?))
}

/// A part's scans together, and each by itself only where it is the only one.
fn first_of_each_part(scans: &[SessionScan]) -> Vec<&SessionScan> {
    scans.chunk_by(|a, b| a.target_name == b.target_name).filter_map(<[_]>::first).collect()
}

fn case_of(
    scan: &SessionScan,
    calibration: &str,
    flange_from_sensor: &Transform<Flange, Sensor>,
) -> Result<Case, Refusal> {
    let name = words::scan_name(scan);
    let cloud = Cloud::from_scan(&scan.captures, flange_from_sensor)
        .map_err(|error| (EXIT_NOTHING_COMPUTED, format!("{name}: {error}")))?;
    let num_profiles = Some(scan.captures.len());
    Ok(Case { name, num_profiles, calibration: Some(calibration.to_owned()), known: scan.known, cloud })
}

/// What was measured, as text and as JSON.
fn measured(args: &ScanArgs, case: &Case) -> Result<(String, Value), Refusal> {
    let Case { cloud, known, .. } = case;
    let of_known = known.wanted();
    let wanted = Wanted {
        teeth: args.teeth || of_known.teeth,
        diameter: of_known.diameter,
        round: args.cylinder.then_some(RoundKind::Cylinder).or_else(|| args.ball.then_some(RoundKind::Ball)),
    };
    let shapes = shapes(cloud, &PointSet::all(cloud), wanted);
    let regions = if args.plane.is_empty() {
        let options = SegmentOptions { tolerance_mm: args.tolerance, ..SegmentOptions::default() };
        // It is never cancelled.
        plane_regions(cloud, &options, &shapes, &mut Unwatched).unwrap_or_default()
    } else {
        let region = |(idx, corners): (usize, &[f64])| {
            let [a, b] = [&corners[..3], &corners[3..]].map(Vec3::from_column_slice);
            let set = PointSet::in_box(cloud, a.inf(&b), a.sup(&b));
            if set.is_empty() {
                let empty = words::empty_box(&case.name, corners, cloud.bounds_mm());
                return Err((EXIT_NOTHING_COMPUTED, empty));
            }
            Ok(Region::new(cloud, region_name(idx), set))
        };
        args.plane.chunks_exact(6).enumerate().map(region).collect::<Result<_, _>>()?
    };
    let head = words::scan_head(&case.name, cloud.len(), case.num_profiles, case.calibration.as_deref());
    let planes = words::planes_table(&regions, known);
    let others = words::shapes_table(&shapes, known);
    // The diameter of a round part is what it was scanned for.
    let text = head + &if matches!(shapes.round, Some(Ok(_))) { others + &planes } else { planes + &others };
    let file = scan_file(&case.name, case.calibration.as_deref(), cloud, &regions, &shapes, known);
    Ok((text, file))
}

fn finite(text: &str) -> Result<f64, String> {
    text.parse().ok().filter(|value: &f64| value.is_finite()).ok_or_else(|| "expected a number".to_owned())
}

fn positive(text: &str) -> Result<f64, String> {
    finite(text).ok().filter(|value| *value > 0.0).ok_or_else(|| "expected a number above 0".to_owned())
}
