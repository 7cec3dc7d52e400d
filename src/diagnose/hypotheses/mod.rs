//! Suspicions with a number: radius, profile scale, drift, a switched tool, mirrored axes, wrong sides.
//!
//! Each is the model of the session with one thing more to be found. It becomes a finding if it explains the data
//! decisively better, and if it is large enough to matter.

mod motion;
mod sides;
mod size;

use crate::calibrate::best_available;

use super::Case;
use super::finding::Finding;
use super::model::{Extension, FAR_OFF_PART, Fit, Model};

/// How decisive the evidence (minus twice the logarithm of the likelihood ratio) has to be: by chance it is reached once in
/// some ten thousand sessions, and stations are never quite the independent samples that this supposes.
fn is_decisive(evidence: f64, num_extra: usize) -> bool {
    #[expect(clippy::cast_precision_loss, reason = "at most six")]
    let extra = num_extra as f64;
    evidence > 16.0 + 3.0 * extra
}

/// A session with its model solved as given.
struct Solved<'a> {
    case: Case<'a>,
    model: Model,
    plain: Fit,
}

/// A model with one thing more, solved.
struct Tried {
    extension: Extension,
    fit: Fit,
    evidence: f64,
}

impl<'a> Solved<'a> {
    fn new(case: Case<'a>) -> Option<Self> {
        let model = Model::new(case.problem)?;
        let start = best_available(case.results)?.reduced.as_ref()?.state;
        let as_given = model.fit(Extension::Plain, model.as_given(start));
        let plain = match (as_given, sides::found_anew(case, &model)) {
            // Given sides may have led to a minimum far off.
            (Some(as_given), Some(anew)) if anew.rms_mm < 0.5 * as_given.rms_mm => anew,
            (Some(as_given), _) => as_given,
            (None, anew) => anew?,
        };
        Some(Self { case, model, plain })
    }

    /// The extension solved, if it explains the data decisively better.
    fn tried(&self, extension: Extension) -> Option<Tried> {
        let fit = self.model.fit(extension, self.plain.unknowns)?;
        self.judged(extension, fit)
    }

    fn judged(&self, extension: Extension, fit: Fit) -> Option<Tried> {
        if self.is_far_off(&fit) {
            return None;
        }
        let evidence = self.model.evidence(&fit, &self.plain)?;
        is_decisive(evidence, extension.num_extra(self.model.mount())).then_some(Tried { extension, fit, evidence })
    }

    fn is_far_off(&self, fit: &Fit) -> bool {
        fit.rms_mm > FAR_OFF_PART * self.plain.unknowns.radius_mm
    }

    /// RMS residual as given and with the extension.
    fn residual_mm(&self, tried: &Tried) -> [f64; 2] {
        [self.plain.rms_mm, tried.fit.rms_mm]
    }

    /// The index in the session of a station of the problem.
    fn session_idx(&self, station: usize) -> usize {
        self.case.problem.stations[station].idx
    }
}

/// How many times the residual falls.
fn falls_by([given, mended]: [f64; 2]) -> f64 {
    given / mended.max(1e-9)
}

/// What there is to find.
#[must_use]
pub fn examine(case: Case<'_>) -> Vec<Finding> {
    let mut findings: Vec<Finding> = sides::sensor_is_tool(case).into_iter().collect();
    let Some(solved) = Solved::new(case) else {
        findings.extend(sides::bulges_away(case));
        return findings;
    };
    findings.extend(sides::examine(&solved));
    // One thing at a time: what is wrong with the ball's size may look like a motion, and the other way round. A size that
    // turns nonsense into a fit needs no rival.
    let size = size::examine(&solved);
    let is_settled = size.is_some() && solved.is_far_off(&solved.plain);
    let motion = if is_settled { None } else { motion::examine(&solved) };
    findings.extend([size, motion].into_iter().flatten().max_by(|a, b| a.explains.total_cmp(&b.explains)));
    findings
}

/// The ball's radius that the data show, and its standard deviation, mm; `None` where they show none.
#[must_use]
pub fn radius(case: Case<'_>) -> Option<(f64, f64)> {
    let solved = Solved::new(case)?;
    if !solved.model.has_arcs() {
        return None;
    }
    let fit = solved.model.fit(Extension::Radius, solved.plain.unknowns)?;
    Some((fit.unknowns.radius_mm, fit.extra_std(0)))
}

#[cfg(test)]
mod tests;
