//! Stations that contradict the rest: wrong poses, stale poses, a mixed-up order.

use crate::calibrate::SideChoice;
use crate::geometry::Rigid;

use super::Case;
use super::consensus::{Consensus, MIN_CLEAN_STATIONS, Stations, needed_stations};
use super::finding::{Evidence, Fault, Finding, Plot, Severity, StationBar};
use super::remedy::Remedy;
use super::station_reading::poses_of;

/// Below this nobody need look, mm: the resolution of a good arm.
const WORTH_NAMING_MM: f64 = 0.05;
/// A contradiction is also far beyond what the others show.
const WORTH_NAMING_RATIO: f64 = 3.0;
/// Every station is tried against all others; beyond this many that takes longer than anybody waits.
const MAX_STATIONS: usize = 400;
/// Poses that differ by less were not measured anew: far below the noise of any arm (mm, rad).
const SAME_POSE: f64 = 1e-5;

/// What there is to find.
#[must_use]
pub fn examine(case: Case<'_>) -> Vec<Finding> {
    let num_stations = case.problem.stations.len();
    if num_stations > MAX_STATIONS {
        return Vec::new();
    }
    let Some((stations, consensus)) = Stations::new(case.problem).consensus() else {
        return Vec::new();
    };
    let accused = accused(&stations, &consensus);
    let agreeing = stations.readings.len() - accused.len();
    if consensus.is_credible() && agreeing >= needed_stations(stations.readings.len()) {
        let mut found = findings(&stations, &consensus, &accused);
        found.extend(noise_above_stated(case, &stations, &consensus));
        return found;
    }
    shifted_order(case).or_else(|| too_few(&stations, num_stations)).into_iter().collect()
}

/// The readings that contradict the consensus, whichever side their ball is on: a wrong side is another fault.
fn accused(stations: &Stations<'_>, consensus: &Consensus) -> Vec<usize> {
    let least_mm = WORTH_NAMING_MM.max(WORTH_NAMING_RATIO * consensus.typical_mm());
    (0..stations.readings.len())
        .filter(|idx| !consensus.agrees[*idx] && consensus.misfit_mm[*idx] > least_mm)
        .filter(|idx| {
            let reading = &stations.readings[*idx];
            let side_is_given = matches!(reading.station.side, SideChoice::Given(_));
            !(side_is_given && Stations::fits(reading, consensus))
        })
        .collect()
}

fn findings(stations: &Stations<'_>, consensus: &Consensus, accused: &[usize]) -> Vec<Finding> {
    let poses_from = exchanged(stations, consensus, accused);
    let is_exchanged = |idx: usize| poses_from.iter().any(|(to, _)| *to == idx);
    let session_idx = |idx: usize| stations.readings[idx].station.idx;
    let mut findings = Vec::new();
    if !poses_from.is_empty() {
        let concerned: Vec<usize> = poses_from.iter().map(|(to, _)| *to).collect();
        let poses_from: Vec<(usize, usize)> =
            poses_from.iter().map(|(to, from)| (session_idx(*to), session_idx(*from))).collect();
        findings.push(finding(
            Fault::MixedOrder { poses_from: poses_from.clone() },
            bars(stations, consensus, &concerned),
            Some(Remedy::TakePosesFrom(poses_from)),
        ));
    }
    for idx in accused.iter().copied().filter(|idx| !is_exchanged(*idx)) {
        let off_mm = consensus.misfit_mm[idx];
        let station_idx = session_idx(idx);
        let fault = match stale_from(stations, idx) {
            Some(pose_of_idx) => Fault::StalePose { station_idx, pose_of_idx, off_mm },
            None => Fault::WrongPose { station_idx, off_mm, typical_mm: consensus.typical_mm() },
        };
        findings.push(finding(fault, bars(stations, consensus, &[idx]), Some(Remedy::LeaveOut(vec![station_idx]))));
    }
    findings
}

/// Whether those that agree scatter by far more than the session says that they should.
fn noise_above_stated(case: Case<'_>, stations: &Stations<'_>, consensus: &Consensus) -> Option<Finding> {
    /// Biased flanks make stations scatter twice as much as their noise; that is not the robot's fault.
    const NOTEWORTHY_RATIO: f64 = 3.0;
    /// Once in ten million sessions by chance.
    const AT_STDS: f64 = 5.0;
    let noise = &case.problem.noise;
    let (Some(_), Some(_)) = (noise.position_std_mm, noise.orientation_std_rad) else {
        return None;
    };
    let [ratio, score] = consensus.noise_ratio_and_score;
    (ratio > NOTEWORTHY_RATIO && score > AT_STDS).then(|| Finding {
        severity: Severity::Doubtful,
        ..finding(Fault::NoiseAboveStated { ratio, p_value: upper_tail(score) }, bars(stations, consensus, &[]), None)
    })
}

/// The probability of a standard normal value above a large one, by the first term of its asymptotic series.
fn upper_tail(score: f64) -> f64 {
    (-0.5 * score * score).exp() / (score * (2.0 * std::f64::consts::PI).sqrt())
}

fn finding(fault: Fault, plot: Plot, remedy: Option<Remedy>) -> Finding {
    Finding {
        fault,
        severity: Severity::Wrong,
        explains: 1.0,
        evidence: Evidence { residual_mm: None, plot: Some(plot) },
        remedy,
    }
}

fn bars(stations: &Stations<'_>, consensus: &Consensus, accused: &[usize]) -> Plot {
    Plot::Stations(
        stations
            .readings
            .iter()
            .enumerate()
            .map(|(idx, reading)| StationBar {
                station_idx: reading.station.idx,
                label: reading.station.label.clone(),
                error_mm: consensus.misfit_mm[idx],
                is_accused: accused.contains(&idx),
            })
            .collect(),
    )
}

/// The station whose poses another one still has, capture by capture.
fn stale_from(stations: &Stations<'_>, accused: usize) -> Option<usize> {
    let own = poses_of(stations.readings[accused].station);
    stations
        .readings
        .iter()
        .enumerate()
        .filter(|(idx, _)| *idx != accused)
        .find(|(_, other)| {
            let others = poses_of(other.station);
            own.iter().zip(&others).all(|(a, b)| is_same(a, b))
        })
        .map(|(_, other)| other.station.idx)
}

fn is_same(a: &Rigid, b: &Rigid) -> bool {
    (a.translation.vector - b.translation.vector).norm() < SAME_POSE && a.rotation.angle_to(&b.rotation) < SAME_POSE
}

/// `(reading, reading whose poses belong to it)`: accused stations that fit once they exchange their poses among each
/// other.
fn exchanged(stations: &Stations<'_>, consensus: &Consensus, accused: &[usize]) -> Vec<(usize, usize)> {
    let mut pairs: Vec<(usize, usize)> = accused
        .iter()
        .filter_map(|to| {
            let station = stations.readings[*to].station;
            let fitting: Vec<usize> = accused
                .iter()
                .copied()
                .filter(|from| from != to)
                .filter(|from| stations.readings[*from].station.captures.len() == station.captures.len())
                .filter(|from| {
                    let poses = poses_of(stations.readings[*from].station);
                    stations.reading(station, &poses).is_some_and(|reading| Stations::fits(&reading, consensus))
                })
                .collect();
            // Two that fit would be twins; which of them is meant cannot be told.
            <[usize; 1]>::try_from(fitting).ok().map(|[from]| (*to, from))
        })
        .collect();
    // Whoever gives its poses away needs others, and whoever gets some has to have given its own.
    let is_loose = |pairs: &[(usize, usize)], (to, from): (usize, usize)| {
        !pairs.iter().any(|(_, other)| *other == to) || !pairs.iter().any(|(other, _)| *other == from)
    };
    while let Some(at) = pairs.iter().position(|pair| is_loose(&pairs, *pair)) {
        pairs.remove(at);
    }
    pairs
}

/// Whether the stations agree once every one takes the poses of the next, or of the one before.
fn shifted_order(case: Case<'_>) -> Option<Finding> {
    let stations = &case.problem.stations;
    let num = stations.len();
    let has_same_captures = stations.windows(2).all(|pair| pair[0].captures.len() == pair[1].captures.len());
    if !has_same_captures {
        return None;
    }
    [1, num.saturating_sub(1)].into_iter().find_map(|shift| {
        let mut problem = case.problem.clone();
        for (idx, station) in problem.stations.iter_mut().enumerate() {
            for (capture, other) in station.captures.iter_mut().zip(&stations[(idx + shift) % num].captures) {
                capture.base_from_flange = other.base_from_flange;
            }
        }
        let (shifted, consensus) = Stations::new(&problem).consensus()?;
        let agreeing = consensus.num_agreeing();
        // All but the one at the end of the list, which has nobody's poses.
        if !consensus.is_credible() || agreeing + 1 < shifted.readings.len() {
            return None;
        }
        let is_lost = |station_idx: usize| {
            let of_station = shifted.readings.iter().position(|reading| reading.station.idx == station_idx);
            of_station.is_some_and(|reading| !consensus.agrees[reading])
        };
        let poses_from: Vec<(usize, usize)> = (0..num)
            .map(|idx| (stations[idx].idx, stations[(idx + shift) % num].idx))
            .filter(|(to, _)| !is_lost(*to))
            .collect();
        Some(finding(
            Fault::MixedOrder { poses_from: poses_from.clone() },
            bars(&shifted, &consensus, &[]),
            Some(Remedy::TakePosesFrom(poses_from)),
        ))
    })
}

/// Where some agree but not enough of them.
fn too_few(stations: &Stations<'_>, num_stations: usize) -> Option<Finding> {
    let consensus = stations.agreement(MIN_CLEAN_STATIONS)?;
    let clean = consensus.num_agreeing();
    let needed = needed_stations(num_stations);
    if !consensus.is_credible() || clean < MIN_CLEAN_STATIONS || clean >= needed {
        return None;
    }
    let accused: Vec<usize> = (0..stations.readings.len()).filter(|idx| !consensus.agrees[*idx]).collect();
    Some(finding(Fault::TooFewCleanStations { clean, needed }, bars(stations, &consensus, &accused), None))
}
