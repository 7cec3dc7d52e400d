//! The buttons that mend a fault.

use crate::calibrate::{Mount, SideChoice};
use crate::diagnose::Remedy;
use crate::session::Session;
use crate::text::digits::fixed;
use crate::text::edges::edge_name;
use crate::text::poses;

use super::readings::pose_reading;
use super::words::{axis_name, station_label, stations};

/// The button that applies a remedy.
#[must_use]
pub fn remedy_label(remedy: &Remedy, session: &Session) -> String {
    match remedy {
        Remedy::LeaveOut(station_idxs) => format!("Leave out {}", stations(session, station_idxs)),
        Remedy::ReadPosesAs(reading) => format!("Read poses as {}", pose_reading(reading)),
        Remedy::SetRadius(found_mm) => format!("Set radius to {} mm", fixed(*found_mm, RADIUS_DECIMALS)),
        Remedy::SetSides(sides) => sides_label(session, sides),
        Remedy::SetEdge { station_idx, edge } => {
            format!("Set edge of station {} to {}", station_label(session, *station_idx), edge_name(*edge))
        }
        Remedy::TakePosesFrom(pairs) => exchange_label(session, pairs),
        Remedy::ScaleProfiles(factor) => format!("Scale profiles by {}", fixed(*factor, FACTOR_DECIMALS)),
        Remedy::MirrorProfiles(axis) => format!("Turn {} axis of profiles", axis_name(*axis)),
        Remedy::ToOtherMount => match session.mount {
            Mount::OnFlange => "Set mounting to fixed beside the robot".to_owned(),
            Mount::Fixed => "Set mounting to on the flange".to_owned(),
        },
        Remedy::ScaleTargets(factor) => format!("Scale the target by {}", fixed(*factor, FACTOR_DECIMALS)),
        Remedy::RemoveTool { from_station_idx, .. } => {
            format!("Take TOOL out of poses from station {}", station_label(session, *from_station_idx))
        }
    }
}

fn sides_label(session: &Session, sides: &[(usize, SideChoice)]) -> String {
    if let [(station_idx, side)] = sides {
        return format!("Set side of station {} to {}", station_label(session, *station_idx), side_name(*side));
    }
    let station_idxs: Vec<usize> = sides.iter().map(|(station_idx, _)| *station_idx).collect();
    format!("Turn sides of {}", stations(session, &station_idxs))
}

fn exchange_label(session: &Session, poses_from: &[(usize, usize)]) -> String {
    if let [(to, from)] = poses_from {
        return format!(
            "Give station {} the pose of station {}",
            station_label(session, *to),
            station_label(session, *from)
        );
    }
    let station_idxs: Vec<usize> = poses_from.iter().map(|(station_idx, _)| *station_idx).collect();
    format!("Exchange poses of {}", stations(session, &station_idxs))
}

/// What undo takes back when a remedy was applied.
#[must_use]
pub fn remedy_undo_label(remedy: &Remedy, session: &Session) -> String {
    let label = remedy_label(remedy, session);
    let mut letters = label.chars();
    letters.next().map_or_else(String::new, |first| first.to_lowercase().chain(letters).collect())
}

/// No calliper reads more.
const RADIUS_DECIMALS: usize = 3;
/// A hundredth of a millimetre in 100 mm.
const FACTOR_DECIMALS: usize = 4;

const fn side_name(side: SideChoice) -> &'static str {
    poses::side(side)
}
