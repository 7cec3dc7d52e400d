//! Lines of numbers: CSV with or without a header, XYZ, and their like.

use crate::geometry::Vec3;
use crate::watch::Watch;

use super::ply::profile_of;
use super::{CloudFileError, Gathered, REPORT_EVERY, Refused, Source, WITHIN_LIMIT, said};

/// Where the coordinates stand in a line.
#[derive(Clone, Copy)]
struct Columns {
    xyz: [usize; 3],
    profile: Option<usize>,
}

const FIRST_THREE: Columns = Columns { xyz: [0, 1, 2], profile: None };

/// Reads points, one a line: x, y and z by the names of a header, or the first three numbers. Lines that begin with `#` or
/// `//` are comments.
pub(super) fn read(source: &mut Source, gathered: &mut Gathered, watch: &mut dyn Watch) -> Result<(), CloudFileError> {
    const EXPECTED: &str = "at least three numbers: x, y and z in mm";
    let mut line = Vec::new();
    let mut columns = None;
    let mut num = 0;
    while source.next_line(&mut line)? {
        let wrong = |expected: &str| source.wrong_line(&said(&line), expected);
        let text = std::str::from_utf8(&line).map_err(|_| wrong("text (UTF-8)"))?;
        let text = text.trim_start_matches('\u{feff}').trim();
        if text.is_empty() || text.starts_with('#') || text.starts_with("//") {
            continue;
        }
        let known = match columns {
            Some(known) => known,
            None => match header(text) {
                Some(found) => {
                    columns = Some(found);
                    continue;
                }
                None => *columns.insert(FIRST_THREE),
            },
        };
        let (point, profile) = point(text, known).ok_or_else(|| wrong(EXPECTED))?;
        gathered.take(point, profile).map_err(|refused| match refused {
            Refused::TooFar(_) => wrong(WITHIN_LIMIT),
            Refused::TooMany(problem) => CloudFileError::TooLarge { file: source.path.clone(), problem },
        })?;
        num += 1;
        if num % REPORT_EVERY == 0 {
            source.report(watch)?;
        }
    }
    Ok(())
}

fn cells(line: &str) -> impl Iterator<Item = &str> {
    // With a comma between two numbers spaces beside it are nothing; without one they are what parts the numbers.
    let is_separator =
        if line.contains([',', ';', '\t']) { |c: char| matches!(c, ',' | ';' | '\t') } else { |c: char| c == ' ' };
    let parts_by_space = !line.contains([',', ';', '\t']);
    line.split(is_separator).map(str::trim).filter(move |cell| !(parts_by_space && cell.is_empty()))
}

/// The columns by their names, where a line holds names.
fn header(line: &str) -> Option<Columns> {
    let names: Vec<String> = cells(line).map(|cell| cell.trim_matches('"').to_ascii_lowercase()).collect();
    let place = |axis: &str| names.iter().position(|name| name == axis || name.strip_suffix("_mm") == Some(axis));
    Some(Columns {
        xyz: [place("x")?, place("y")?, place("z")?],
        profile: names.iter().position(|name| name == "profile"),
    })
}

fn point(line: &str, columns: Columns) -> Option<(Vec3, u32)> {
    let mut point = [None; 3];
    let mut profile = 0;
    for (place, cell) in cells(line).enumerate() {
        if let Some(axis) = columns.xyz.iter().position(|wanted| *wanted == place) {
            point[axis] = Some(cell.parse().ok()?);
        } else if columns.profile == Some(place) {
            profile = profile_of(cell.parse().ok()?);
        }
    }
    let [x, y, z] = point;
    Some((Vec3::new(x?, y?, z?), profile))
}
