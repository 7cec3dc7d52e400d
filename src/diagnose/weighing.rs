//! Which of the suspicions is the cause, and which are merely its symptoms: the cause is what explains most, and a symptom
//! is gone once the cause is mended.

use crate::calibrate::validation::{Normality, Validation};
use crate::calibrate::{BallProblem, Method, MethodResult, Problem, Warning, best_available, solve, solve_all};
use crate::session::{self, Session, Target, measure};
use crate::watch::Unwatched;

use super::finding::{Fault, Finding, Severity};
use super::model::{Extension, Model};
use super::{Case, SIZE_FOR_A_TIP_MM, remedy, suspicions};

/// A remedy that lowers the residual by less has not shown that it mends anything.
const MENDS_FROM: f64 = 1.5;
/// Stations without which the residual falls by less do not stand out from the rest.
const STANDS_OUT_FROM: f64 = 1.15;
/// Halves of the stations that differ by so many times what they should, ...
const HALVES_RATIO: f64 = 3.0;
/// ... and by this, mm, are worth a finding: below it no application notices.
const HALVES_MM: f64 = 0.1;
/// A ball that scatters by more than this part of its radius is not that of one calibration, whatever the noise.
const FAR_OFF_PART: f64 = 0.1;
/// Nor is one by more than this, mm; below it a poor robot and a small ball may do it.
const FAR_OFF_MM: f64 = 1.0;
/// Residuals as odd as this by chance once in a hundred million sessions ...
const NOT_NORMAL_P: f64 = 1e-8;
/// ... and with more than this part beyond three σ, twenty times what is normal: with many sections the test sees every trace
/// of a biased flank, which does no harm.
const WILD_PART: f64 = 0.05;

/// The findings with their weight, the most serious first, without those that the first one accounts for.
pub(super) fn causes(case: Case<'_>, mut findings: Vec<Finding>) -> Causes {
    weigh_stations(case, &mut findings);
    findings.sort_by(Finding::more_serious_first);
    if findings.first().is_some_and(|first| first.severity == Severity::Wrong) {
        // Whatever is wrong makes the stations scatter.
        findings.retain(|finding| !matches!(finding.fault, Fault::NoiseAboveStated { .. }));
    }
    let Some(mended) = findings.first().and_then(|first| Mended::of(case, first, &findings)) else {
        return Causes { findings, remaining_warnings: None };
    };
    let remaining = suspicions(mended.case());
    let first_is_station = is_about_stations(&findings[0].fault);
    let mut is_first = true;
    findings.retain(|finding| {
        let is_of_first = is_first || (first_is_station && is_about_stations(&finding.fault));
        is_first = false;
        is_of_first || remaining.iter().any(|other| is_same(&finding.fault, &other.fault))
    });
    let remaining_warnings =
        best_available(&mended.results).map(|solution| solution.warnings.clone()).unwrap_or_default();
    Causes { findings, remaining_warnings: Some(remaining_warnings) }
}

/// What is left of the findings.
pub(super) struct Causes {
    findings: Vec<Finding>,
    /// What the best method still warns of once the first is mended; `None` where that was not tried.
    remaining_warnings: Option<Vec<Warning>>,
}

/// The findings, and after them what the methods and the validation say that is not said already.
pub(super) fn with_warnings(case: Case<'_>, causes: Causes, validation: Option<&Validation>) -> Vec<Finding> {
    let Causes { mut findings, remaining_warnings } = causes;
    let mut more: Vec<(Fault, Severity)> = Vec::new();
    if let Some(solution) = best_available(case.results) {
        let remains = |warning: &&Warning| {
            remaining_warnings.as_ref().is_none_or(|left| left.iter().any(|other| other.code() == warning.code()))
        };
        let is_named = findings.first().is_some_and(|first| first.severity == Severity::Wrong);
        let is_far_off = solution.scatter.rms_mm > (FAR_OFF_PART * case.problem.radius_mm).max(FAR_OFF_MM);
        if is_far_off && !is_named {
            more.push((Fault::DoesNotFit { scatter_mm: solution.scatter.rms_mm }, Severity::Wrong));
        }
        more.extend(solution.warnings.iter().filter(|warning| !has_a_fault(warning)).filter(remains).map(|warning| {
            let severity = if warning.casts_doubt() { Severity::Doubtful } else { Severity::Note };
            (Fault::Method(warning.clone()), severity)
        }));
    } else if findings.first().is_none_or(|first| first.severity != Severity::Wrong) {
        more.extend(reason(case.results).map(|error| (Fault::NotSolved(error), Severity::Wrong)));
    }
    // What is wrong shows in these as well; by themselves they name nothing.
    let is_named = findings.iter().any(|finding| finding.severity < Severity::Note);
    if let Some(validation) = validation.filter(|_| !is_named) {
        more.extend(from_validation(validation));
    }
    findings.extend(more.into_iter().map(|(fault, severity)| Finding {
        fault,
        severity,
        explains: 1.0,
        evidence: super::Evidence::default(),
        remedy: None,
    }));
    findings.sort_by(Finding::more_serious_first);
    findings
}

/// Whether a fault says the same, or says with a stricter measure that there is nothing.
const fn has_a_fault(warning: &Warning) -> bool {
    matches!(
        warning,
        Warning::LittleRotation { .. }
            | Warning::NearlyOneAxis { .. }
            | Warning::RadiusDisagrees { .. }
            | Warning::TravelOffNormal { .. }
            | Warning::StepDiffersFromPose { .. }
            | Warning::StationStandsOut { .. }
    )
}

/// Why the method that asks for least computed nothing.
fn reason(results: &[MethodResult]) -> Option<crate::calibrate::SolveError> {
    let of_method = |method| results.iter().find(|result| result.method == method);
    let result = of_method(Method::BallFixedPoint).or_else(|| results.first())?;
    result.outcome.as_ref().err().cloned()
}

pub(super) fn from_validation(validation: &Validation) -> impl Iterator<Item = (Fault, Severity)> {
    let halves = validation
        .split_half
        .as_ref()
        .filter(|halves| halves.median_mm > (HALVES_RATIO * halves.expected_mm).max(HALVES_MM))
        .map(|halves| {
            let fault = Fault::HalvesDisagree { median_mm: halves.median_mm, expected_mm: halves.expected_mm };
            (fault, Severity::Doubtful)
        });
    let normality = validation
        .normality
        .as_ref()
        .filter(|normality| normality.p_value < NOT_NORMAL_P && wild_part(normality) > WILD_PART)
        .map(|normality| (Fault::ResidualsNotNormal { p_value: normality.p_value }, Severity::Note));
    halves.into_iter().chain(normality)
}

/// The part of the residuals beyond three σ.
fn wild_part(normality: &Normality) -> f64 {
    let num_wild = normality.quantiles.iter().filter(|[_, residual]| residual.abs() > 3.0).count();
    #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^52 residuals")]
    let part = num_wild as f64 / normality.quantiles.len().max(1) as f64;
    part
}

const fn is_about_stations(fault: &Fault) -> bool {
    matches!(fault, Fault::WrongPose { .. } | Fault::StalePose { .. } | Fault::MixedOrder { .. })
}

/// The same fault, and of the same stations where it is about some.
fn is_same(a: &Fault, b: &Fault) -> bool {
    match (a, b) {
        (Fault::WrongPose { station_idx: a, .. }, Fault::WrongPose { station_idx: b, .. })
        | (Fault::StalePose { station_idx: a, .. }, Fault::StalePose { station_idx: b, .. }) => a == b,
        (Fault::TwinPoses { station_idxs: a, .. }, Fault::TwinPoses { station_idxs: b, .. }) => a == b,
        _ => a.code() == b.code(),
    }
}

/// Tries the remedies of all stations that contradict the rest: together, as one of two wrong ones hides what the other
/// one does.
fn weigh_stations(case: Case<'_>, findings: &mut Vec<Finding>) {
    let Some(first) = findings.iter().find(|finding| is_about_stations(&finding.fault)) else { return };
    let as_given =
        best_available(case.results).and_then(|best| residual_mm(case.problem, best.reduced.as_ref()?.state));
    let mended = mended_session(case.session, first, findings);
    let after = problem_of(&mended).and_then(|problem| {
        let solved = [Method::BallBundle, Method::BallFixedPoint].map(|method| solve(&problem, method).ok());
        residual_mm(&problem, solved.into_iter().flatten().next()?.reduced?.state)
    });
    let (Some(as_given), Some(after)) = (as_given, after) else { return };
    if as_given < STANDS_OUT_FROM * after {
        // Without them the rest fits no better, so they are no worse than the rest.
        findings.retain(|finding| !is_about_stations(&finding.fault));
        return;
    }
    for finding in findings.iter_mut().filter(|finding| is_about_stations(&finding.fault)) {
        finding.evidence.residual_mm = Some([as_given, after]);
        finding.explains = as_given / after.max(1e-9);
    }
}

/// RMS of what is left of the sections, by the measure that the suspicions with a number use, mm.
fn residual_mm(problem: &BallProblem, start: crate::calibrate::observation::State) -> Option<f64> {
    let model = Model::new(problem)?;
    Some(model.fit(Extension::Plain, model.as_given(start))?.rms_mm)
}

/// A session with the first finding mended, examined anew.
struct Mended {
    session: Session,
    problem: BallProblem,
    results: Vec<MethodResult>,
}

impl Mended {
    fn of(case: Case<'_>, first: &Finding, findings: &[Finding]) -> Option<Self> {
        first.remedy.as_ref().filter(|_| first.explains > MENDS_FROM)?;
        let session = mended_session(case.session, first, findings);
        let problem = problem_of(&session)?;
        let results = match session.target {
            Target::Point => Problem::Point(problem.clone()).solve_all(&Method::POINT, &mut Unwatched).ok()?,
            _ => solve_all(&problem, &Method::BALL, &mut Unwatched).ok()?,
        };
        Some(Self { session, problem, results })
    }

    fn case(&self) -> Case<'_> {
        Case { session: &self.session, problem: &self.problem, results: &self.results }
    }
}

/// The session with a finding mended; stations that contradict the rest all at once.
fn mended_session(session: &Session, first: &Finding, findings: &[Finding]) -> Session {
    let together = is_about_stations(&first.fault);
    findings
        .iter()
        .filter(|finding| *finding == first || (together && is_about_stations(&finding.fault)))
        .filter_map(|finding| finding.remedy.as_ref())
        .fold(session.clone(), |session, remedy| remedy::apply(&session, remedy))
}

fn problem_of(session: &Session) -> Option<BallProblem> {
    let measured = measure(session, None, &mut Unwatched).ok()?;
    match session::problem(session, &measured).ok()? {
        Problem::Ball(ball) => Some(ball),
        Problem::Point(tip) => Some(BallProblem { radius_mm: SIZE_FOR_A_TIP_MM, ..tip }),
        Problem::Plate(_) | Problem::Motion(_) | Problem::Streams(_) => None,
    }
}
