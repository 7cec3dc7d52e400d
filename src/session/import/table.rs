//! Tables of numbers: what separates their cells, where the header ends, and what the columns mean.

use std::borrow::Cow;

use crate::calibrate::{Edge, Side, SideChoice};
use crate::geometry::notation::{AngleUnit, LengthUnit, OrientationForm, QUATERNION_NORM_TOLERANCE};
use crate::geometry::{PoseNotation, Vec3};
use crate::sheet::layout::{Layout, MAX_COLUMNS, is_comment, is_rule};
use crate::sheet::text::{Cell, excerpt, is_missing, number, records, split};
use crate::watch::Cancelled;

use super::gather::{Gathered, RawPose};
use super::header::{self, Said};
use super::read::Progress;
use super::{ImportOptions, Preview, Role, Source};

/// Rows of the preview.
const MAX_PREVIEW_ROWS: usize = 50;
/// Rows between two looks at whether anybody still waits.
const ROWS_BETWEEN_REPORTS: usize = 256;

/// What the columns of a table of poses mean.
#[derive(Clone, Debug)]
pub(super) struct Columns {
    pub roles: Vec<Role>,
    pub said: Said,
    pub has_header: bool,
    /// What the first row says of how the poses are written.
    pub written: Option<Written>,
}

/// How poses are written, as a cell of the table says it.
#[derive(Clone, Debug)]
pub(super) struct Written {
    /// Line and column of the cell, and its text.
    at: (usize, usize),
    text: String,
    /// `None` if the text is not one of ours.
    notation: Option<PoseNotation>,
}

/// What the columns mean: as the options say, as the header names them, or by number and values.
pub(super) fn columns(text: &str, layout: &Layout, options: &ImportOptions, notation: &PoseNotation) -> Columns {
    let mut written = None;
    let mut said = Said::default();
    let mut named: Vec<Option<Role>> = vec![None; layout.num_columns];
    let mut has_header = false;
    if let Some(header) = &layout.header {
        let cells: Vec<&str> = header.iter().map(String::as_str).collect();
        let (mut found, mut found_said) = header::roles(&cells, notation.convention, None);
        if let Some(column) = found.iter().position(|role| *role == Some(Role::Notation)) {
            written = written_in(text, layout, column);
            let angles = written.as_ref().and_then(|written| written.notation);
            if let Some(angles) = angles.filter(|known| known.orientation == OrientationForm::Angles) {
                (found, found_said) = header::roles(&cells, notation.convention, Some(angles.convention));
            }
        }
        has_header = options.has_header == Some(true) || found.iter().any(Option::is_some);
        if has_header {
            named = found;
            said = found_said;
            named.resize(layout.num_columns.max(named.len()), None);
            if let Some(units) = &layout.units {
                let cells: Vec<&str> = units.iter().map(String::as_str).collect();
                header::units(&cells, &named, &mut said);
            }
        }
    }
    let roles = if let Some(roles) = &options.roles {
        let mut roles = roles.clone();
        roles.resize(named.len().max(roles.len()), Role::Ignore);
        roles
    } else {
        if !is_complete(&named) {
            fill_by_values(&mut named, layout, &mut said);
        }
        named.iter().map(|role| role.unwrap_or(Role::Ignore)).collect()
    };
    if said.orientation.is_none() && roles.contains(&Role::Orientation(3)) {
        said.orientation = Some(OrientationForm::QuaternionWxyz);
    }
    Columns { roles, said, has_header, written }
}

fn is_complete(roles: &[Option<Role>]) -> bool {
    (0..3).all(|idx| roles.contains(&Some(Role::Position(idx))) && roles.contains(&Some(Role::Orientation(idx))))
}

/// Whether four columns are a unit quaternion in every row.
fn is_quaternion(sample: &[Vec<f64>], columns: &[usize]) -> bool {
    let norm = |row: &Vec<f64>| {
        columns.iter().map(|column| row.get(*column).map_or(f64::NAN, |part| part * part)).sum::<f64>().sqrt()
    };
    columns.len() == 4 && sample.iter().all(|row| (norm(row) - 1.0).abs() <= 2.0 * QUATERNION_NORM_TOLERANCE)
}

/// Whether a column counts the rows, or the stations.
fn is_numbering(sample: &[Vec<f64>], column: usize) -> bool {
    let values: Vec<f64> = sample.iter().map(|row| row.get(column).copied().unwrap_or(f64::NAN)).collect();
    values.iter().all(|value| value.fract() == 0.0 && *value >= 0.0)
        && values.windows(2).all(|pair| (0.0..=1.0).contains(&(pair[1] - pair[0])))
}

/// Gives the columns without a name their meaning by how many they are and what stands in them.
fn fill_by_values(roles: &mut [Option<Role>], layout: &Layout, said: &mut Said) {
    let sample = &layout.sample;
    if roles.iter().any(|role| matches!(role, Some(Role::Position(_) | Role::Orientation(_)))) {
        // A header that names half of a pose is not to be guessed over.
        return;
    }
    let mut free: Vec<usize> = (0..layout.num_columns).filter(|column| roles[*column].is_none()).collect();
    let has_label = roles.contains(&Some(Role::Label));
    let is_number = |column: usize| {
        sample.iter().filter(|row| row.get(column).is_some_and(|v| !v.is_nan())).count() * 2 > sample.len()
    };
    let first_is_label = |free: &[usize]| {
        !has_label && free.first().is_some_and(|first| !is_number(*first) || is_numbering(sample, *first))
    };
    let quaternion_at =
        |free: &[usize], at: usize| free.get(at..at + 4).is_some_and(|four| is_quaternion(sample, four));
    // Two poses a row, each with a quaternion: the robot's and the target's.
    let pairs_at = |at: usize| free.len() == at + 14 && quaternion_at(&free, at + 3) && quaternion_at(&free, at + 10);
    if let Some(at) = [0, 1].into_iter().find(|at| pairs_at(*at)) {
        if at == 1 && !has_label {
            roles[free[0]] = Some(if first_is_label(&free) { Role::Label } else { Role::Ignore });
        }
        said.orientation = Some(OrientationForm::QuaternionWxyz);
        for (place, column) in free[at..].iter().enumerate() {
            roles[*column] = Some(match place {
                0..3 => Role::Position(place),
                3..7 => Role::Orientation(place - 3),
                _ => Role::Target(place - 7),
            });
        }
        return;
    }
    // A row of a pose and its point: 6 or 7 numbers, and 0, 2 or 3 more; with a name or a time in front of it one more.
    let lead = match free.len() {
        6 => 0,
        7 | 10 => usize::from(!quaternion_at(&free, 3)),
        8 => usize::from(quaternion_at(&free, 4) || first_is_label(&free)),
        9 => usize::from(!quaternion_at(&free, 3) && first_is_label(&free) && quaternion_at(&free, 4)),
        11 => 1,
        _ => return,
    };
    if lead == 1 {
        let first = free.remove(0);
        // Whole numbers are names; others in front of a pose are times.
        let is_whole = sample.iter().all(|row| row.get(first).is_some_and(|value| value.fract() == 0.0));
        let is_label = !has_label && (!is_number(first) || is_whole);
        roles[first] = Some(if is_label { Role::Label } else { Role::Ignore });
    }
    free.retain(|column| is_number(*column));
    let num_orientation = if quaternion_at(&free, 3) { 4 } else { 3 };
    said.orientation =
        Some(if num_orientation == 4 { OrientationForm::QuaternionWxyz } else { OrientationForm::Angles });
    for (place, column) in free.iter().enumerate() {
        let rest = free.len().saturating_sub(3 + num_orientation);
        roles[*column] = match place {
            0..3 => Some(Role::Position(place)),
            _ if place < 3 + num_orientation => Some(Role::Orientation(place - 3)),
            _ => match (rest, place - 3 - num_orientation) {
                (3, idx) => Some(Role::Point(idx)),
                // A point of the laser plane.
                (2, 0) => Some(Role::Point(0)),
                (2, 1) => Some(Role::Point(2)),
                _ => None,
            },
        };
    }
}

/// The notation in a column's first cell.
fn written_in(text: &str, layout: &Layout, column: usize) -> Option<Written> {
    let record = records(text).find(|record| record.line >= layout.first_row_line)?;
    let mut cells = Vec::new();
    split(record.text, layout.separator, &mut cells);
    let cell = cells.get(column).filter(|cell| !is_missing(cell.text))?;
    let at = (record.line, cell.column(record.text));
    Some(Written { at, text: cell.text.to_owned(), notation: PoseNotation::from_text(cell.text) })
}

/// How the poses of a table are written: as it says itself, else as its header says, else by the size of its numbers, else as
/// `notation` has it.
pub(super) fn notation(layout: &Layout, columns: &Columns, notation: &PoseNotation) -> PoseNotation {
    /// Robots stand further than this from their base in millimetres, and not as far in metres.
    const LARGEST_METRES: f64 = 5.0;
    if let Some(written) = columns.written.as_ref().and_then(|written| written.notation) {
        return written;
    }
    let largest = |is_wanted: fn(Role) -> bool| {
        let values = layout.sample.iter().flat_map(|row| row.iter().zip(&columns.roles));
        values
            .filter(|(value, role)| is_wanted(**role) && !value.is_nan())
            .map(|(value, _)| value.abs())
            .fold(0.0, f64::max)
    };
    // A camera that looks at a target from afar may do so in millimetres while the robot is given in metres: each tells by itself.
    let largest_position = largest(|role| matches!(role, Role::Position(_)));
    let largest_angle = largest(|role| matches!(role, Role::Orientation(_)));
    let said = &columns.said;
    let length_unit = said.length_unit.unwrap_or(if largest_position > 0.0 && largest_position <= LARGEST_METRES {
        LengthUnit::Metres
    } else {
        LengthUnit::Millimetres
    });
    let orientation = said.orientation.unwrap_or_default();
    // Who names a maker's angles means them in that maker's unit; only else their size tells.
    let usual = said.convention.filter(|_| said.orientation == Some(OrientationForm::Angles));
    let is_of_a_maker = usual.is_some_and(|convention| {
        convention.angle_names == ["W", "P", "R"] || convention.angle_names == ["A", "B", "C"]
    });
    let is_rad = !is_of_a_maker && largest_angle > 0.0 && largest_angle <= std::f64::consts::TAU + 1e-3;
    let angle_unit = match orientation {
        OrientationForm::Angles => {
            said.angle_unit.unwrap_or(if is_rad { AngleUnit::Radians } else { AngleUnit::Degrees })
        }
        OrientationForm::QuaternionWxyz | OrientationForm::QuaternionXyzw => notation.angle_unit,
    };
    PoseNotation {
        convention: said.convention.unwrap_or(notation.convention),
        orientation,
        angle_unit,
        length_unit,
        flange_from_tcp: notation.flange_from_tcp,
        is_inverse: notation.is_inverse,
    }
}

/// The columns of each role, found once for all rows.
struct Places {
    numbers: Vec<usize>,
    point: [Option<usize>; 3],
    /// Columns of the target's pose; empty if there are none.
    target: Vec<usize>,
    label: Option<usize>,
    side: Option<usize>,
    edge: Option<usize>,
    used: Option<usize>,
    step: Option<usize>,
    profile: Option<usize>,
}

impl Places {
    /// # Errors
    /// The role that no column has.
    fn of(roles: &[Role], notation: &PoseNotation) -> Result<Self, Role> {
        let at = |wanted: Role| roles.iter().position(|role| *role == wanted);
        let num_orientation = notation.num_numbers() - 3;
        // The roles of a quaternion are its parts in the order in which they are written.
        let needed = (0..3).map(Role::Position).chain((0..num_orientation).map(Role::Orientation));
        Ok(Self {
            numbers: needed.map(|role| at(role).ok_or(role)).collect::<Result<_, _>>()?,
            point: [0, 1, 2].map(|idx| at(Role::Point(idx))),
            target: (0..7).map_while(|idx| at(Role::Target(idx))).collect(),
            label: at(Role::Label),
            side: at(Role::Side),
            edge: at(Role::Edge),
            used: at(Role::Used),
            step: at(Role::Step),
            profile: at(Role::Profile),
        })
    }
}

/// A cell that is not what its column needs: its index, and what is expected.
type CellProblem = (usize, &'static str);

const A_NUMBER: &str = "a number";

/// Reads the rows of a table of poses.
///
/// # Errors
/// [`Cancelled`].
pub(super) fn read(
    source: &Source,
    text: &str,
    layout: &Layout,
    columns: &Columns,
    gathered: &mut Gathered,
    preview: &mut Preview,
    progress: &mut Progress<'_>,
) -> Result<(), Cancelled> {
    let notation = *gathered.notation();
    let places = Places::of(&columns.roles, &notation);
    if let Some(Written { at, text, notation: None }) = &columns.written {
        gathered.problem(&source.name, *at, text, "how poses are written, as our export says it");
    }
    if let Err(role) = &places {
        let found = format!("{} columns, none of them with {}", layout.num_columns, wanted(*role, &notation));
        gathered.problem(&source.name, (layout.first_row_line, 1), &found, "a column for each number of a pose");
    }
    preview.roles.clone_from(&columns.roles);
    preview.header = match &layout.header {
        Some(header) if columns.has_header => header.clone(),
        _ => (1..=columns.roles.len()).map(|column| column.to_string()).collect(),
    };
    gathered.reserve(records(text).count(), text.len());
    let target_notation = target_notation(layout, columns, &notation);
    let mut target_numbers = Vec::with_capacity(7);
    let point_in_mm = columns.said.point_unit.map_or(1.0, LengthUnit::in_mm);
    let mut cells = Vec::new();
    let mut numbers = Vec::with_capacity(notation.num_numbers());
    for (idx, record) in records(text).skip_while(|record| record.line < layout.first_row_line).enumerate() {
        if idx % ROWS_BETWEEN_REPORTS == 0 {
            progress.tick()?;
        }
        if is_comment(record.text, layout.separator) || is_rule(record.text) {
            continue;
        }
        split(record.text, layout.separator, &mut cells);
        preview.num_rows += 1;
        if preview.rows.len() < MAX_PREVIEW_ROWS {
            let shown = cells.iter().take(MAX_COLUMNS).map(|cell| excerpt(cell.text).into_owned()).collect();
            preview.rows.push((record.line, shown));
        }
        let Ok(places) = &places else { continue };
        if gathered.is_full() {
            gathered.take(&source.name, &RawPose { at: (record.line, 1), ..RawPose::default() });
            break;
        }
        // Spreadsheets leave rows of nothing but separators behind.
        if cells.iter().all(|cell| cell.text.is_empty()) {
            continue;
        }
        let in_target = target_row(&cells, places, layout.has_decimal_comma, &mut target_numbers);
        match in_target.and_then(|()| row(&cells, places, layout.has_decimal_comma, &mut numbers)) {
            Ok(mut raw) => {
                raw.target = (!target_numbers.is_empty()).then_some((target_notation, target_numbers.as_slice()));
                raw.point_in_sensor = raw.point_in_sensor.map(|point| point * point_in_mm);
                raw.at = (record.line, cells.get(places.numbers[0]).map_or(1, |cell| cell.column(record.text)));
                raw.numbers = &numbers;
                gathered.take(&source.name, &raw);
            }
            Err((cell_idx, expected)) => {
                let end = record.text.chars().count() + 1;
                let (column, found) =
                    cells.get(cell_idx).map_or((end, ""), |cell| (cell.column(record.text), cell.text));
                gathered.problem(&source.name, (record.line, column), found, expected);
            }
        }
    }
    Ok(())
}

fn wanted(role: Role, notation: &PoseNotation) -> String {
    match role {
        Role::Position(idx) => ["x", "y", "z"].get(idx).copied().unwrap_or_default().to_owned(),
        Role::Orientation(idx) => notation.orientation_names().get(idx).copied().unwrap_or_default().to_owned(),
        _ => String::new(),
    }
}

fn row<'t>(
    cells: &[Cell<'t>],
    places: &Places,
    has_decimal_comma: bool,
    numbers: &mut Vec<f64>,
) -> Result<RawPose<'t>, CellProblem> {
    let text = |column: Option<usize>| {
        column.and_then(|column| cells.get(column)).map(|cell| cell.text).filter(|text| !text.is_empty())
    };
    let number_at = |column: usize| {
        let value = cells.get(column).and_then(|cell| number(cell.text, has_decimal_comma));
        value.ok_or((column, A_NUMBER))
    };
    numbers.clear();
    for column in &places.numbers {
        numbers.push(number_at(*column)?);
    }
    let side = match text(places.side) {
        None => SideChoice::Auto,
        Some(side) => match side.to_lowercase().as_str() {
            "+" | "plus" | "1" | "+1" => SideChoice::Given(Side::Plus),
            "-" | "−" | "minus" | "-1" => SideChoice::Given(Side::Minus),
            "auto" | "?" | "0" => SideChoice::Auto,
            _ => return Err((places.side.unwrap_or_default(), "a side: auto, + or -")),
        },
    };
    let edge = match text(places.edge) {
        None => None,
        Some(edge) if is_missing(edge) => None,
        Some(edge) => match edge.to_lowercase().as_str() {
            "p" => Some(Edge::P),
            "q" => Some(Edge::Q),
            _ => return Err((places.edge.unwrap_or_default(), "an edge of the plate: p or q")),
        },
    };
    let is_disabled = match text(places.used) {
        None => false,
        Some(used) => match used.to_lowercase().as_str() {
            "1" | "true" | "yes" | "y" | "x" | "on" | "used" => false,
            "0" | "false" | "no" | "n" | "off" | "-" => true,
            _ => return Err((places.used.unwrap_or_default(), "yes or no")),
        },
    };
    let step_mm = match text(places.step) {
        Some(step) if !is_missing(step) => Some(number_at(places.step.unwrap_or_default())?),
        _ => None,
    };
    Ok(RawPose {
        label: text(places.label).map(unescaped),
        point_in_sensor: point(cells, places, number_at)?,
        side,
        edge,
        is_disabled,
        step_mm,
        profile: text(places.profile),
        may_continue: true,
        ..RawPose::default()
    })
}

/// A cell's text with quotation marks as they were before they were doubled.
fn unescaped(text: &str) -> Cow<'_, str> {
    if text.contains("\"\"") { text.replace("\"\"", "\"").into() } else { text.into() }
}

/// How the target's pose is written: as the header says, else as the robot's, but in the unit that its numbers show.
fn target_notation(layout: &Layout, columns: &Columns, notation: &PoseNotation) -> PoseNotation {
    /// Cameras see targets nearer than this in metres, and further off in millimetres.
    const LARGEST_METRES: f64 = 5.0;
    let places = columns.roles.iter().enumerate().filter(|(_, role)| matches!(role, Role::Target(0..3)));
    let values = places.flat_map(|(column, _)| layout.sample.iter().filter_map(move |row| row.get(column)));
    let largest = values.filter(|value| !value.is_nan()).fold(0.0_f64, |most, value| most.max(value.abs()));
    let by_size = if largest > LARGEST_METRES { LengthUnit::Millimetres } else { LengthUnit::Metres };
    let has_quaternion = columns.roles.contains(&Role::Target(6));
    PoseNotation {
        length_unit: columns.said.target.length_unit.unwrap_or(by_size),
        orientation: match columns.said.target.orientation {
            Some(form) => form,
            None if has_quaternion && notation.orientation == OrientationForm::Angles => {
                OrientationForm::QuaternionWxyz
            }
            None if has_quaternion => notation.orientation,
            None => OrientationForm::Angles,
        },
        flange_from_tcp: None,
        is_inverse: false,
        ..*notation
    }
}

/// The numbers of the target's pose; none where all their cells are empty.
fn target_row(
    cells: &[Cell<'_>],
    places: &Places,
    has_decimal_comma: bool,
    numbers: &mut Vec<f64>,
) -> Result<(), CellProblem> {
    numbers.clear();
    let is_filled = |column: &usize| cells.get(*column).is_some_and(|cell| !is_missing(cell.text));
    if places.target.iter().any(is_filled) {
        for column in &places.target {
            let value = cells.get(*column).and_then(|cell| number(cell.text, has_decimal_comma));
            numbers.push(value.ok_or((*column, A_NUMBER))?);
        }
    }
    Ok(())
}

/// The reduced point; none where all its cells are empty. A point of the laser plane has no column for y.
fn point(
    cells: &[Cell<'_>],
    places: &Places,
    number_at: impl Fn(usize) -> Result<f64, CellProblem>,
) -> Result<Option<Vec3>, CellProblem> {
    let is_filled = |column: usize| cells.get(column).is_some_and(|cell| !is_missing(cell.text));
    if !places.point.iter().flatten().any(|column| is_filled(*column)) {
        return Ok(None);
    }
    let mut point = Vec3::zeros();
    for (idx, column) in places.point.iter().enumerate() {
        if let Some(column) = column {
            point[idx] = number_at(*column)?;
        }
    }
    Ok(Some(point))
}
