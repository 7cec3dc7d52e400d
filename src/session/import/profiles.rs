//! Profiles: rows of x and z, one profile a file or one a column.

use crate::geometry::Profile;
use crate::geometry::notation::LengthUnit;
use crate::sheet::layout::Layout;
use crate::sheet::profile::{self, BadCell, Columns, Rows, x_and_z};
use crate::watch::Cancelled;

use super::gather::Gathered;
use super::read::Progress;
use super::{ImportOptions, Source};

/// A profile and how its source names it.
#[derive(Clone, Debug)]
pub(super) struct NamedProfile {
    /// Name of the file, or head of the column.
    pub name: String,
    /// The points.
    pub profile: Profile,
}

/// Columns of a table of profiles.
const MAX_PROFILE_COLUMNS: usize = 4096;
/// Millimetres in the units of x and z: as the options say, else as the header does, else one.
///
/// # Errors
/// A unit that is not known.
fn units_in_mm(layout: &Layout, x: usize, z: usize, options: &ImportOptions) -> Result<[f64; 2], String> {
    if let Some(unit) = options.profile_length_unit {
        return Ok([unit.in_mm(); 2]);
    }
    profile::units_in_mm(layout, x, z)
}

/// Where x and the first z stand.
fn first_columns(layout: &Layout, has_profile_columns: bool) -> (usize, usize) {
    if has_profile_columns { (0, layout.num_columns.saturating_sub(1)) } else { x_and_z(layout) }
}

/// The length unit of profiles, for the options: `None` where the header says another than these.
pub(super) fn length_unit(layout: &Layout, has_profile_columns: bool, options: &ImportOptions) -> Option<LengthUnit> {
    let (x, z) = first_columns(layout, has_profile_columns);
    let units = units_in_mm(layout, x, z, options).ok()?;
    [LengthUnit::Millimetres, LengthUnit::Metres]
        .into_iter()
        .find(|unit| units.iter().all(|in_mm| (in_mm - unit.in_mm()).abs() < f64::EPSILON))
}

/// Reads one profile, or one a column; rows that cannot be read are listed.
///
/// # Errors
/// [`Cancelled`].
pub(super) fn read(
    source: &Source,
    text: &str,
    layout: &Layout,
    has_profile_columns: bool,
    options: &ImportOptions,
    gathered: &mut Gathered,
    progress: &mut Progress<'_>,
) -> Result<Vec<NamedProfile>, Cancelled> {
    let (x, z) = first_columns(layout, has_profile_columns);
    let [x_in_mm, z_in_mm] = match units_in_mm(layout, x, z, options) {
        Ok(units) => units,
        Err(unit) => {
            gathered.problem(&source.name, (1, 1), &unit, "mm, m, cm, um or in as the unit of x and z");
            return Ok(Vec::new());
        }
    };
    let z_sign = if options.is_z_mirrored { -1.0 } else { 1.0 };
    let (x_column, z_columns) = if has_profile_columns {
        (0, (1..layout.num_columns.min(MAX_PROFILE_COLUMNS)).collect())
    } else {
        (x, vec![z])
    };
    let columns = Columns { x: x_column, z: z_columns, x_in_mm, z_in_mm: z_in_mm * z_sign };
    let on_bad_cell = |cell: BadCell<'_>| {
        gathered.problem(&source.name, cell.at, cell.found, "a coordinate in a row of x and z");
    };
    let Rows { x_mm, z_mm } = profile::rows(text, layout, &columns, on_bad_cell, || progress.tick())?;
    let names = |place: usize, column: usize| {
        let head = layout.header.as_ref().and_then(|header| header.get(column)).filter(|head| !head.is_empty());
        head.cloned().unwrap_or_else(|| (place + 1).to_string())
    };
    let mut profiles = Vec::with_capacity(columns.z.len());
    for (place, (column, z_mm)) in columns.z.iter().zip(z_mm).enumerate() {
        let z_mm: Vec<Option<f64>> = z_mm.iter().map(|z| (!z.is_nan()).then_some(*z)).collect();
        let name = if has_profile_columns { names(place, *column) } else { source.name.clone() };
        // The lists are as long as each other and checked above.
        if let Ok(profile) = Profile::new(x_mm.clone(), &z_mm) {
            profiles.push(NamedProfile { name, profile });
        }
    }
    Ok(profiles)
}
