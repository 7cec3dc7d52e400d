//! Wording of the pose table.

use crate::calibrate::{Side, SideChoice};

/// Column.
pub const STATION: &str = "station";
/// Column.
pub const USED: &str = "use";
/// Column.
pub const SIDE: &str = "side";
/// Column.
pub const CAPTURES: &str = "captures";
/// Column.
pub const CHECK: &str = "check";
/// Nothing is the matter.
pub const FINE: &str = "Nothing to remark";
/// The station takes no part.
pub const LEFT_OUT: &str = "Left out by you";
/// Button.
pub const UNFOLD_ALL: &str = "Unfold all";
/// Button.
pub const FOLD_ALL: &str = "Fold all";
/// A session without stations.
pub const NO_STATIONS: &str = "This session has no stations.";

/// Title's right side.
#[must_use]
pub fn usage(num_enabled: usize, num_stations: usize) -> String {
    format!("{num_enabled} of {num_stations} stations take part")
}

/// Name of a row's checkbox.
#[must_use]
pub fn use_station(label: &str) -> String {
    format!("Use station {label}")
}

/// Name of a row's fold button.
#[must_use]
pub fn unfold_station(label: &str) -> String {
    format!("Show the captures of station {label}")
}

/// Name of a row's fold button.
#[must_use]
pub fn fold_station(label: &str) -> String {
    format!("Hide the captures of station {label}")
}

/// A capture's name in the table, from 1.
#[must_use]
pub fn capture_name(station_label: &str, capture_number: usize) -> String {
    format!("{station_label}.{capture_number}")
}

/// The side as the session has it.
#[must_use]
pub const fn side(side: SideChoice) -> &'static str {
    match side {
        SideChoice::Auto => "auto",
        SideChoice::Given(Side::Plus) => "+",
        SideChoice::Given(Side::Minus) => "−",
    }
}

/// A capture's profile was refused.
#[must_use]
pub fn refused(capture_number: usize, reason: &str) -> String {
    format!("Profile {capture_number}: {reason}")
}

/// Several profiles were refused.
#[must_use]
pub fn more_refused(number: usize) -> String {
    format!("and {number} more without a usable arc")
}
