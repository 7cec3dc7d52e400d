//! What a source is: by its content first, by the ending of its name where that leaves it open.

use crate::geometry::PoseNotation;
use crate::sheet::layout::{Layout, layout};
use crate::sheet::profile::named;

use super::table::{self, Columns};
use super::{ImportOptions, Kind, Role, abb, fanuc, kuka, pose_pairs, printed, ur, yaml};

/// What was found on the way and is needed for reading.
pub(super) enum Recognised {
    /// A session file of ours.
    Session,
    /// Poses or profiles in rows and columns.
    Table(Kind, Box<Layout>, Columns),
    /// Named values.
    Printed(Box<printed::Tables>),
    /// A robot's program.
    Program(Kind),
    /// Pairs of matrices.
    PosePairs(pose_pairs::Pairs),
    /// YAML or JSON.
    Yaml(Box<yaml::Document>),
}

impl Recognised {
    pub const fn kind(&self) -> Kind {
        match self {
            Self::Session => Kind::Session,
            Self::Table(kind, ..) | Self::Program(kind) => *kind,
            Self::Printed(_) => Kind::PrintedTable,
            Self::PosePairs(_) => Kind::PosePairs,
            Self::Yaml(_) => Kind::Yaml,
        }
    }

    /// Whether it gives poses.
    pub const fn has_poses(&self) -> bool {
        match self {
            Self::Yaml(document) => document.has_poses(),
            _ => !matches!(self.kind(), Kind::Profile | Kind::ProfileColumns),
        }
    }
}

/// What a text is taken for; `kind` is what the user says.
pub(super) fn recognise(
    name: &str,
    text: &str,
    kind: Option<Kind>,
    options: &ImportOptions,
    notation: &PoseNotation,
) -> Option<Recognised> {
    match kind {
        Some(Kind::Session) => return Some(Recognised::Session),
        Some(Kind::PrintedTable) => return printed::find(text).map(|tables| Recognised::Printed(Box::new(tables))),
        Some(kind @ (Kind::PoseTable | Kind::Profile | Kind::ProfileColumns)) => {
            let layout = layout(text, options.given())?;
            let columns = table::columns(text, &layout, options, notation);
            return Some(Recognised::Table(kind, Box::new(layout), columns));
        }
        Some(Kind::PosePairs) => return pose_pairs::pairs(text).map(Recognised::PosePairs),
        Some(Kind::Yaml) => return yaml::document(text).map(|document| Recognised::Yaml(Box::new(document))),
        Some(kind @ (Kind::FanucProgram | Kind::AbbModule | Kind::KukaProgram | Kind::UrScript)) => {
            return Some(Recognised::Program(kind));
        }
        _ => {}
    }
    if text.trim_start().starts_with('{') && text.contains("\"handeye-session\"") {
        return Some(Recognised::Session);
    }
    if let Some(pairs) = pose_pairs::pairs(text) {
        return Some(Recognised::PosePairs(pairs));
    }
    if let Some(tables) = printed::find(text) {
        return Some(Recognised::Printed(Box::new(tables)));
    }
    if let Some(kind) = program_kind(text) {
        return Some(Recognised::Program(kind));
    }
    let document = yaml::is_yaml(name, text).then(|| yaml::document(text)).flatten();
    let layout = match &document {
        Some(document) if !document.is_empty() => None,
        // What is no YAML after all may still be a table.
        _ => layout(text, options.given()),
    };
    if let Some(layout) = layout {
        let columns = table::columns(text, &layout, options, notation);
        let kind = table_kind(&layout, &columns);
        return Some(Recognised::Table(kind, Box::new(layout), columns));
    }
    document.map(|document| Recognised::Yaml(Box::new(document)))
}

fn program_kind(text: &str) -> Option<Kind> {
    if fanuc::is_program(text) {
        Some(Kind::FanucProgram)
    } else if abb::is_program(text) {
        Some(Kind::AbbModule)
    } else if kuka::is_program(text) {
        Some(Kind::KukaProgram)
    } else {
        ur::is_script(text).then_some(Kind::UrScript)
    }
}

/// Whether rows and columns are poses or profiles.
fn table_kind(layout: &Layout, columns: &Columns) -> Kind {
    let is_pose = (0..3)
        .all(|idx| columns.roles.contains(&Role::Position(idx)) && columns.roles.contains(&Role::Orientation(idx)));
    let names_a_pose = columns.said.orientation.is_some() && columns.has_header;
    if is_pose && (names_a_pose || !is_along_a_line(layout)) {
        return Kind::PoseTable;
    }
    // A header that names x and z says that they are one profile, whatever stands beside them.
    if named(layout, "x").is_some() && named(layout, "z").is_some() && !is_pose {
        let names_an_orientation = columns.roles.iter().any(|role| matches!(role, Role::Orientation(_)));
        if !names_an_orientation && is_along_a_line(layout) {
            return Kind::Profile;
        }
    }
    match layout.num_columns {
        ..=2 => Kind::Profile,
        _ if named(layout, "x") == Some(0) && named(layout, "z").is_none() && !is_pose => Kind::ProfileColumns,
        3 if !is_along_a_line(layout) || is_numbered_or_flat(layout) => Kind::Profile,
        3 => Kind::ProfileColumns,
        _ if is_along_a_line(layout) => Kind::ProfileColumns,
        _ => Kind::PoseTable,
    }
}

/// Whether the first column is a profile's x: many values with steady steps, and not the numbers of rows.
fn is_along_a_line(layout: &Layout) -> bool {
    const MIN_ROWS: usize = 10;
    let x: Vec<f64> = layout.sample.iter().filter_map(|row| row.first().copied()).collect();
    let steps: Vec<f64> = x.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let Some(first) = steps.first() else { return false };
    let is_numbering = steps.iter().all(|step| (*step - 1.0).abs() < f64::EPSILON) && x[0].fract() == 0.0;
    x.len() >= MIN_ROWS && !is_numbering && steps.iter().all(|step| (step / first - 1.0).abs() < 0.5)
}

/// Three columns of one profile: a number in front, or y = 0 in the middle.
fn is_numbered_or_flat(layout: &Layout) -> bool {
    layout.sample.iter().all(|row| row.get(1) == Some(&0.0))
}
