//! Is the ball, or are the profiles, of another size than the session says?

use crate::diagnose::finding::{CurveAxis, Evidence, Fault, Finding, Plot, Severity};
use crate::diagnose::model::{Extension, Unknowns};
use crate::diagnose::remedy::Remedy;

use super::{Solved, Tried, falls_by};

/// Biased flanks of real profiles look like a radius that is off by hundredths of a millimetre (0.05 in simulation), and
/// cheap balls are off by as much: up to this, mm, ...
const LEAST_MM: f64 = 0.06;
/// ... and up to this part of the radius, nothing is said.
const LEAST_PART: f64 = 0.004;
/// Nor of a deviation below this many standard deviations.
const LEAST_STDS: f64 = 4.0;
/// The scale has to be so much more likely than the radius (minus twice the logarithm) for it to be named.
const TOLD_APART: f64 = 9.0;
/// Points of the plotted curve.
const NUM_CURVE_POINTS: u32 = 17;

pub(super) fn examine(solved: &Solved<'_>) -> Option<Finding> {
    if !solved.model.has_arcs() {
        return None;
    }
    let radius = solved.tried(Extension::Radius);
    let scale = solved.tried(Extension::Scale);
    match (radius, scale) {
        (radius, Some(scale)) if radius.as_ref().is_none_or(|radius| scale.evidence > radius.evidence + TOLD_APART) => {
            profile_scale(solved, &scale)
        }
        (Some(radius), scale) => wrong_radius(solved, &radius, scale.is_some()),
        (None, _) => None,
    }
}

/// Whether a deviation of the radius, or of what the scale makes of it, is worth a finding.
fn matters(difference_mm: f64, std_mm: f64, radius_mm: f64) -> bool {
    difference_mm.abs() > LEAST_MM.max(LEAST_PART * radius_mm) && difference_mm.abs() > LEAST_STDS * std_mm
}

fn wrong_radius(solved: &Solved<'_>, tried: &Tried, scale_explains_too: bool) -> Option<Finding> {
    let given_mm = solved.plain.unknowns.radius_mm;
    let found_mm = tried.fit.unknowns.radius_mm;
    let std_mm = if scale_explains_too {
        // With the scale unknown as well the radius is known less.
        solved.model.fit_as(Extension::RadiusAndScale, tried.fit.unknowns, &tried.fit)?.extra_std(0)
    } else {
        tried.fit.extra_std(0)
    };
    let difference_mm = (found_mm - given_mm).abs();
    // A radius that is not known well is estimated with the calibration; only far from what is known of it is it wrong.
    let prior_std_mm = solved.case.problem.radius_std_mm.unwrap_or(0.0);
    let is_wrong = matters(difference_mm, tried.fit.extra_std(0).hypot(prior_std_mm), given_mm);
    is_wrong.then(|| {
        finding(
            solved,
            tried,
            Fault::WrongRadius { found_mm, std_mm, given_mm },
            Remedy::SetRadius(found_mm),
            CurveAxis::RadiusMm,
            [given_mm, found_mm, std_mm],
        )
    })
}

fn profile_scale(solved: &Solved<'_>, tried: &Tried) -> Option<Finding> {
    let factor = tried.fit.unknowns.scale();
    let std = tried.fit.extra_std(0) * factor;
    let radius_mm = solved.plain.unknowns.radius_mm;
    matters((factor - 1.0) * radius_mm, std * radius_mm, radius_mm).then(|| {
        finding(
            solved,
            tried,
            Fault::ProfileScale { factor, std },
            Remedy::ScaleProfiles(factor),
            CurveAxis::ProfileScale,
            [1.0, factor, std],
        )
    })
}

fn finding(
    solved: &Solved<'_>,
    tried: &Tried,
    fault: Fault,
    remedy: Remedy,
    axis: CurveAxis,
    [given, found, std]: [f64; 3],
) -> Finding {
    let residual_mm = solved.residual_mm(tried);
    Finding {
        fault,
        severity: Severity::Wrong,
        explains: falls_by(residual_mm),
        evidence: Evidence {
            residual_mm: Some(residual_mm),
            plot: Some(Plot::Curve {
                axis,
                points: curve(solved, tried, axis, [given, found, std]),
                given,
                found,
                std,
            }),
        },
        remedy: Some(remedy),
    }
}

/// The residual against the quantity, from beyond the one value to beyond the other, each point solved from the last.
fn curve(solved: &Solved<'_>, tried: &Tried, axis: CurveAxis, [given, found, std]: [f64; 3]) -> Vec<[f64; 2]> {
    let beyond = (0.5 * (found - given).abs()).max(4.0 * std);
    let (from, to) = (given.min(found) - beyond, given.max(found) + beyond);
    let mut unknowns = tried.fit.unknowns;
    (0..NUM_CURVE_POINTS)
        .filter_map(|idx| {
            let value = from + (to - from) * f64::from(idx) / f64::from(NUM_CURVE_POINTS - 1);
            let start = match axis {
                CurveAxis::RadiusMm => Unknowns { radius_mm: value, ..unknowns },
                CurveAxis::ProfileScale => Unknowns { log_scale: value.ln(), ..unknowns },
            };
            let fit = solved.model.fit_as(Extension::Plain, start, &tried.fit)?;
            unknowns = fit.unknowns;
            Some([value, fit.rms_mm])
        })
        .collect()
}
