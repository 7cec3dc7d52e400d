//! Profiles without a usable arc: named once for all of them, and as the reason where too little is left.

use crate::calibrate::{Reading, Station, Warning};
use crate::fit::Refusal;

fn refusals(stations: &[Station]) -> impl Iterator<Item = (&Station, usize, &Refusal)> {
    stations.iter().flat_map(|station| {
        station.captures.iter().enumerate().filter_map(move |(capture_idx, capture)| match &capture.reading {
            Reading::Refused(reason) => Some((station, capture_idx, reason)),
            Reading::Arc(_) | Reading::Edge(_) | Reading::Point(_) => None,
        })
    })
}

/// One warning for all refused profiles, with the first as the example.
pub(super) fn refused_captures(stations: &[Station]) -> Option<Warning> {
    let mut refusals = refusals(stations);
    let (station, capture_idx, reason) = refusals.next()?;
    Some(Warning::CaptureRefused {
        label: station.label.clone(),
        capture_idx,
        reason: reason.clone(),
        num_others: refusals.count(),
    })
}

/// Why the first of them was refused.
pub(super) fn first_refusal(stations: &[Station]) -> Option<Refusal> {
    refusals(stations).next().map(|(_, _, reason)| reason.clone())
}
