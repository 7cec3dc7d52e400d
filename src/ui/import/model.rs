//! What the import's preview shows, computed without egui.

use std::collections::{BTreeMap, BTreeSet};

use crate::geometry::{Base, Flange, PoseConvention, PoseNotation, Tcp, Transform};
use crate::session::import::{Imported, Kind, Preview, Role, Source};

/// Lines of a text that are shown where nothing could be read of it.
const MAX_LINES: usize = 40;
/// Characters of such a line.
const MAX_LINE_CHARS: usize = 240;

/// What a column may mean, in the order of the list over it.
#[must_use]
pub fn role_choices(notation: &PoseNotation) -> Vec<Role> {
    let mut choices = vec![Role::Ignore, Role::Label];
    choices.extend((0..3).map(Role::Position));
    choices.extend((0..notation.orientation_names().len()).map(Role::Orientation));
    choices.extend((0..3).map(Role::Point));
    choices.extend((0..3 + notation.orientation_names().len()).map(Role::Target));
    choices.extend([Role::Profile, Role::Step, Role::Side, Role::Edge, Role::Used, Role::Notation]);
    choices
}

/// The roles with another one for a column; the column that had it takes the old one instead, so that none stands twice.
#[must_use]
pub fn with_role(roles: &[Role], column: usize, role: Role) -> Vec<Role> {
    let mut changed = roles.to_vec();
    let Some(old) = changed.get(column).copied() else { return changed };
    if role != Role::Ignore
        && let Some(other) = changed.iter().position(|known| *known == role)
    {
        changed[other] = old;
    }
    changed[column] = role;
    changed
}

/// Whether cells of a text like this stand in columns whose separator and header can be chosen.
#[must_use]
pub const fn has_columns(kind: Kind) -> bool {
    matches!(kind, Kind::PoseTable | Kind::Profile | Kind::ProfileColumns)
}

/// Whether the meaning of the columns is the user's to say.
#[must_use]
pub fn has_free_roles(imported: &Imported) -> bool {
    imported.options.kind.is_none_or(|kind| kind == Kind::PoseTable)
}

/// Whether how poses are written is a question: also where none could be read the way it is set now.
#[must_use]
pub fn may_have_poses(imported: &Imported) -> bool {
    imported.parts.iter().any(|part| !matches!(part.kind, Kind::Profile | Kind::ProfileColumns))
}

/// Whether profiles were read.
#[must_use]
pub fn has_profiles(imported: &Imported) -> bool {
    let of_profiles = |kind| matches!(kind, Kind::Profile | Kind::ProfileColumns | Kind::Yaml | Kind::RosBag);
    imported.parts.iter().any(|part| part.num_readings > 0 && of_profiles(part.kind))
}

/// Rows of the preview with a problem, each with the columns of the cells in question.
#[must_use]
pub fn marked_cells(imported: &Imported, sources: &[Source]) -> BTreeMap<usize, BTreeSet<usize>> {
    let mut marked: BTreeMap<usize, BTreeSet<usize>> = BTreeMap::new();
    let is_table = imported.options.kind.is_some_and(has_columns);
    let Some(shown) = shown_source(imported) else { return marked };
    for problem in imported.problems.iter().filter(|problem| problem.file == shown) {
        let rows = &imported.preview.rows;
        let Some(row_idx) = rows.iter().position(|(line, _)| *line == problem.line) else { continue };
        let marks = marked.entry(row_idx).or_default();
        let source = sources.iter().find(|source| source.name == problem.file);
        let line = source.and_then(|source| source.text().lines().nth(problem.line.saturating_sub(1)));
        // Elsewhere the cells of the preview do not stand in one line of the text.
        if let Some(line) = line.filter(|_| is_table) {
            marks.extend(cell_at(line, &rows[row_idx].1, problem.column));
        }
    }
    marked
}

/// The source whose rows the preview shows: the first with poses.
fn shown_source(imported: &Imported) -> Option<&str> {
    let part = imported.parts.iter().find(|part| part.num_poses > 0).or_else(|| imported.parts.first())?;
    Some(&part.name)
}

/// The cell in which a column of characters, from 1, lies: cells stand in the line one after the other.
fn cell_at(line: &str, cells: &[String], column: usize) -> Option<usize> {
    let offset = line.char_indices().nth(column.saturating_sub(1)).map_or(line.len(), |(offset, _)| offset);
    let mut from = 0;
    let mut last = None;
    for (idx, cell) in cells.iter().enumerate() {
        let Some(at) = line.get(from..).and_then(|rest| rest.find(cell.as_str())) else { continue };
        if from + at > offset {
            break;
        }
        from += at + cell.len();
        last = Some(idx);
    }
    last
}

/// Characters of the longest text in each column, the head included.
#[must_use]
pub fn column_chars(preview: &Preview) -> Vec<usize> {
    let chars = |text: &String| text.chars().count();
    let num_columns = preview.rows.iter().map(|(_, cells)| cells.len()).max().unwrap_or(0).max(preview.roles.len());
    (0..num_columns)
        .map(|column| {
            let in_rows = preview.rows.iter().filter_map(|(_, cells)| cells.get(column)).map(chars).max();
            in_rows.unwrap_or(0).max(preview.header.get(column).map_or(0, chars))
        })
        .collect()
}

/// How the first source begins, line by line.
#[must_use]
pub fn beginning(sources: &[Source]) -> Vec<String> {
    let Some(source) = sources.first() else { return Vec::new() };
    let visible = |c: char| if c == '\t' { '→' } else { c };
    source.text().lines().take(MAX_LINES).map(|line| line.chars().take(MAX_LINE_CHARS).map(visible).collect()).collect()
}

/// A tool point from its place in the flange: mm, and degrees in the convention's angles.
#[must_use]
pub fn tool_point(numbers: &[f64; 6], convention: &'static PoseConvention) -> Option<Transform<Flange, Tcp>> {
    let frame = PoseNotation::of(convention).base_from_flange(numbers).ok()?;
    Some(Transform::from_rigid(*frame.rigid()))
}

/// The same, back in numbers.
#[must_use]
pub fn tool_point_numbers(flange_from_tcp: &Transform<Flange, Tcp>, convention: &'static PoseConvention) -> [f64; 6] {
    let frame: Transform<Base, Flange> = Transform::from_rigid(*flange_from_tcp.rigid());
    PoseNotation::of(convention).numbers(&frame).try_into().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::session::import::{ImportOptions, Part, Problem};

    #[test]
    fn a_role_that_another_column_has_changes_places_with_it() {
        let roles = [Role::Position(0), Role::Position(1), Role::Ignore];
        assert_eq!(with_role(&roles, 0, Role::Position(1)), [Role::Position(1), Role::Position(0), Role::Ignore]);
        assert_eq!(with_role(&roles, 2, Role::Position(0)), [Role::Ignore, Role::Position(1), Role::Position(0)]);
        assert_eq!(with_role(&roles, 0, Role::Ignore), [Role::Ignore, Role::Position(1), Role::Ignore]);
        assert_eq!(with_role(&roles, 0, Role::Side), [Role::Side, Role::Position(1), Role::Ignore]);
        assert_eq!(with_role(&roles, 9, Role::Side), roles);
    }

    #[test]
    fn every_role_can_be_chosen_and_a_quaternion_has_four_numbers() {
        let mut notation = PoseNotation::default();
        assert_eq!(role_choices(&notation).len(), 23);
        notation.orientation = crate::geometry::notation::OrientationForm::QuaternionWxyz;
        assert!(role_choices(&notation).contains(&Role::Orientation(3)));
    }

    #[test]
    fn a_problem_marks_the_cell_at_its_column() {
        let line = "1; 10,5 ;oops;10,5";
        let cells: Vec<String> = ["1", "10,5", "oops", "10,5"].map(str::to_owned).into();
        for (column, cell) in [(1, 0), (4, 1), (10, 2), (13, 2), (15, 3), (99, 3)] {
            assert_eq!(cell_at(line, &cells, column), Some(cell), "column {column}");
        }
        let source = Source::from_text("a.csv", format!("head\n{line}\n"));
        let problem = Problem {
            file: "a.csv".to_owned(),
            line: 2,
            column: 10,
            found: "\"oops\"".to_owned(),
            expected: "a number".to_owned(),
        };
        let imported = Imported {
            options: ImportOptions { kind: Some(Kind::PoseTable), ..ImportOptions::default() },
            parts: vec![Part {
                name: "a.csv".to_owned(),
                kind: Kind::PoseTable,
                num_poses: 0,
                num_readings: 0,
                notation: None,
            }],
            preview: Preview { rows: vec![(2, cells)], num_rows: 1, ..Preview::default() },
            stations: Vec::new(),
            problems: vec![problem],
            num_problems: 1,
            notes: Vec::new(),
            published: None,
            session: None,
        };
        let marked = marked_cells(&imported, &[source]);
        assert_eq!(marked.into_iter().collect::<Vec<_>>(), [(0, BTreeSet::from([2]))]);
    }

    #[test]
    fn a_tool_point_comes_back_as_it_was_typed() {
        for convention in [PoseConvention::default_convention(), PoseConvention::by_id("ur-rotvec").expect("known")] {
            let numbers = [1.0, -2.5, 150.0, 10.0, -20.0, 30.0];
            let again = tool_point_numbers(&tool_point(&numbers, convention).expect("a pose"), convention);
            // Rounding of a few products.
            assert!(numbers.iter().zip(again).all(|(was, is)| (was - is).abs() < 1e-9), "{again:?}");
        }
    }
}
