//! What all methods warn of in the same words: orientations too much alike, a station that stands out, refused profiles.

use crate::fit::Refusal;
use crate::geometry::stats;

use super::rotation_start::PoseGeometry;
use super::{Reading, Station, Warning};

/// Below this rotation span the residual says little: 62° gave 0.8 mm between halves of real data, 20° gave 4 mm.
pub(crate) const RECOMMENDED_SPAN_DEG: f64 = 40.0;
/// Rotations this many times smaller about one axis than about another leave that direction weak.
pub(crate) const ONE_AXIS_RATIO: f64 = 8.0;
/// A left-out error this many times the median of the others, and not small in itself, is one to look at.
const STANDS_OUT_RATIO: f64 = 4.0;
/// So is its residual, by this factor at least.
const RESIDUAL_RATIO: f64 = 2.5;
/// Left-out errors below this are noise whatever their ratio, mm: the resolution of a good arm.
const STANDS_OUT_MM: f64 = 0.05;

/// What the orientations leave weak.
pub(super) fn rotation_warnings(span_rad: f64, poses: &PoseGeometry) -> Vec<Warning> {
    let mut warnings = Vec::new();
    if span_rad.to_degrees() < RECOMMENDED_SPAN_DEG {
        warnings
            .push(Warning::LittleRotation { span_deg: span_rad.to_degrees(), recommended_deg: RECOMMENDED_SPAN_DEG });
    }
    let [least, _, most] = poses.axis_movements;
    let ratio = (most / least).sqrt();
    if ratio > ONE_AXIS_RATIO {
        warnings.push(Warning::NearlyOneAxis { ratio, axis_in_flange: poses.common_axis_in_flange.into() });
    }
    warnings
}

/// The station with the largest left-out error, if that is far above the others' and its residual is as well: a large
/// left-out error alone is that of a station which the result hangs on.
pub(super) fn stands_out(left_out: &[Option<f64>], in_sample: &[f64]) -> Option<(usize, f64, f64)> {
    let errors: Vec<f64> = left_out.iter().copied().collect::<Option<_>>()?;
    let (station, error_mm) = errors.iter().copied().enumerate().max_by(|a, b| a.1.total_cmp(&b.1))?;
    let typical_mm = median_of_others(&errors, station);
    let leads = in_sample[station] > RESIDUAL_RATIO * median_of_others(in_sample, station);
    (leads && error_mm > STANDS_OUT_MM && error_mm > STANDS_OUT_RATIO * typical_mm)
        .then_some((station, error_mm, typical_mm))
}

fn median_of_others(values: &[f64], left_out: usize) -> f64 {
    let mut others: Vec<f64> =
        values.iter().enumerate().filter(|(idx, _)| *idx != left_out).map(|(_, value)| *value).collect();
    stats::median(&mut others)
}

fn refusals<'a>(
    stations: impl IntoIterator<Item = &'a Station>,
) -> impl Iterator<Item = (&'a Station, usize, &'a Refusal)> {
    stations.into_iter().flat_map(|station| {
        station.captures.iter().enumerate().filter_map(move |(capture_idx, capture)| match &capture.reading {
            Reading::Refused(reason) => Some((station, capture_idx, reason)),
            Reading::Arc(_) | Reading::Edge(_) | Reading::Point(_) | Reading::Pose(_) => None,
        })
    })
}

/// One warning for all refused profiles, with the first as the example.
pub(super) fn refused_captures<'a>(stations: impl IntoIterator<Item = &'a Station>) -> Option<Warning> {
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
pub(super) fn first_refusal<'a>(stations: impl IntoIterator<Item = &'a Station>) -> Option<Refusal> {
    refusals(stations).next().map(|(_, _, reason)| reason.clone())
}
