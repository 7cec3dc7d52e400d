//! How far each station is off the others; the window and the figures share it.

use crate::calibrate::{PlateFound, Solution, StationSolution};
use crate::diagnose::{Fault, Plot, StationBar};

/// The plot where a finding has none of its own, or where there is none: how far each station is off the others.
/// `None` with too few stations for that.
#[must_use]
pub fn station_bars(solution: &Solution, fault: Option<&Fault>) -> Option<Plot> {
    let accused: &[usize] = match fault {
        Some(Fault::TwinPoses { station_idxs, .. }) => station_idxs,
        Some(Fault::WrongSides { station_idxs }) => station_idxs,
        _ => &[],
    };
    let bar = |station: &StationSolution| {
        station.leave_one_out_mm.map(|error_mm| StationBar {
            station_idx: station.station_idx,
            label: station.label.clone(),
            error_mm,
            is_accused: accused.contains(&station.station_idx),
        })
    };
    let bars: Vec<StationBar> = match &solution.plate {
        Some(plate) => of_points(plate, fault),
        None => solution.stations.iter().filter_map(bar).collect(),
    };
    (!bars.is_empty()).then_some(Plot::Stations(bars))
}

/// A plate's: how far each station's points are off the edge that was found without it, the furthest of them.
fn of_points(plate: &PlateFound, fault: Option<&Fault>) -> Vec<StationBar> {
    let mut bars: Vec<StationBar> = Vec::new();
    for point in &plate.points {
        let Some(error_mm) = point.leave_one_out_mm else { continue };
        match bars.last_mut().filter(|bar| bar.station_idx == point.station_idx) {
            Some(bar) => bar.error_mm = bar.error_mm.max(error_mm),
            None => bars.push(StationBar {
                station_idx: point.station_idx,
                label: point.label.clone(),
                error_mm,
                is_accused: match fault {
                    Some(Fault::TwinPoses { station_idxs, .. }) => station_idxs.contains(&point.station_idx),
                    Some(Fault::WrongEdge { station_idx, .. }) => *station_idx == point.station_idx,
                    _ => false,
                },
            }),
        }
    }
    bars
}
