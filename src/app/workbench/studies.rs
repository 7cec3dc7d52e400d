//! What is computed of the document: results, diagnosis, plan and other studies.

use std::sync::Arc;
use std::time::{Duration, Instant};

use crate::calibrate::validation::bootstrap;
use crate::calibrate::{BallProblem, Method, MethodResult, Problem, best_available};
use crate::diagnose;
use crate::plan::{Limits, PlanRefusal, next_stations};
use crate::session::{Measured, Session, Target, measure, problem};
use crate::watch::{Cancelled, Watch};

use super::Workbench;

/// Stations that are planned ahead: about as many as one adds before looking again.
const NUM_PLANNED: usize = 4;
/// The same session gives the same bootstrap.
const BOOTSTRAP_SEED: u64 = 1;

/// What the methods made of a revision of the document.
#[derive(Clone, Debug)]
pub struct Results {
    /// The revision they belong to.
    pub revision: u64,
    /// The arcs of all captures.
    pub measured: Arc<Measured>,
    /// What the methods were given; `None` if nothing is computed from the session's target.
    pub problem: Option<Arc<Problem>>,
    /// One entry a method, in the order of [`Problem::methods`]; empty if nothing is computed.
    pub methods: Vec<MethodResult>,
    /// Why there are no methods, in words.
    pub refusal: Option<String>,
    /// How long it took.
    pub elapsed: Duration,
}

impl Results {
    /// Runs the methods for a session's target on its readings; `start` is when these were begun.
    pub(super) fn of(
        session: &Session,
        measured: Arc<Measured>,
        revision: u64,
        start: Instant,
        watch: &mut dyn Watch,
    ) -> Result<Self, Cancelled> {
        let (problem, methods, refusal) = match problem(session, &measured) {
            Ok(problem) => {
                let methods = problem.solve_all(problem.methods(), watch)?;
                (Some(Arc::new(problem)), methods, None)
            }
            Err(refusal) => (None, Vec::new(), Some(refusal.to_string())),
        };
        Ok(Self { revision, measured, problem, methods, refusal, elapsed: start.elapsed() })
    }

    /// The result of one method.
    #[must_use]
    pub fn method(&self, method: Method) -> Option<&MethodResult> {
        self.methods.iter().find(|result| result.method == method)
    }
}

impl Workbench {
    pub(super) fn forget_results(&mut self) {
        self.forget_scans();
        self.forget_sequence();
        self.results = None;
        self.diagnosis.clear();
        self.plan.clear();
        self.readings.clear();
        self.bootstrap.clear();
        self.verification.clear();
        self.report.clear();
        self.written_report = None;
        self.given.clear();
        self.plan_limits = Limits::default();
    }

    /// The results are shown at once; what is to be said about them follows.
    pub(super) fn take_results(&mut self, results: Results) {
        self.results = Some(Arc::new(results));
        self.start_diagnosing();
        self.start_planning();
        self.start_verifying();
    }

    pub(super) fn start_solving(&mut self) {
        // They would speak of what is about to change; what they have found stays, marked as out of date.
        self.diagnosis.cancel();
        self.plan.cancel();
        self.readings.cancel();
        self.bootstrap.cancel();
        self.verification.cancel();
        self.report.cancel();
        let Some(document) = &self.document else { return };
        let session = Arc::clone(&document.session);
        let revision = document.revision;
        if let Target::Rgbd { sequence } = &session.target {
            let path = document.path.clone();
            self.start_tracking(&session, sequence, path.as_deref(), revision);
            return;
        }
        let previous = self.known_readings();
        self.solving.start("solve", &self.wake, move |watch| {
            let start = Instant::now();
            let measured = Arc::new(measure(&session, previous.as_deref(), watch)?);
            Results::of(&session, measured, revision, start, watch)
        });
    }

    /// The readings of the latest results, of whatever revision: what they hold need not be looked for again.
    pub(super) fn known_readings(&self) -> Option<Arc<Measured>> {
        self.results.as_ref().map(|results| Arc::clone(&results.measured))
    }

    /// Document, problem and results of the same revision, if there are any.
    pub(super) fn case(&self) -> Option<(Arc<Session>, Arc<Problem>, Arc<Results>)> {
        let document = self.document.as_ref()?;
        let results = self.results.as_ref().filter(|results| self.is_current(results.revision))?;
        let problem = results.problem.as_ref()?;
        Some((Arc::clone(&document.session), Arc::clone(problem), Arc::clone(results)))
    }

    /// The same for what only balls have.
    pub(super) fn ball_case(&self) -> Option<(Arc<Session>, Arc<BallProblem>, Arc<Results>)> {
        let (session, problem, results) = self.case()?;
        Some((session, Arc::new(problem.as_ball()?.clone()), results))
    }

    /// Results that are out of date are made anew first; the diagnosis follows them.
    pub(super) fn diagnose_again(&mut self) {
        if self.results_are_current() {
            self.start_diagnosing();
        } else {
            self.start_solving();
        }
    }

    pub(super) fn start_diagnosing(&mut self) {
        let Some((session, problem, results)) = self.case() else { return };
        self.diagnosis.start("diagnose", &self.wake, results.revision, move |watch| {
            diagnose::diagnose_any(&session, &problem, &results.methods, watch)
        });
    }

    pub(super) fn start_ranking(&mut self) {
        let Some((session, problem, results)) = self.ball_case() else { return };
        self.readings.start("try conventions", &self.wake, results.revision, move |watch| {
            diagnose::convention::rank(&session, &problem, watch)
        });
    }

    pub(super) fn start_planning(&mut self) {
        let Some((_, _, results)) = self.case() else { return };
        let limits = self.plan_limits;
        self.plan.start("plan", &self.wake, results.revision, move |_| {
            let solution = best_available(&results.methods).ok_or(PlanRefusal::Undetermined);
            Ok(solution.and_then(|solution| next_stations(solution, &limits, NUM_PLANNED)))
        });
    }

    pub(super) fn start_bootstrap(&mut self, num_draws: usize) {
        let Some((_, _, results)) = self.case() else { return };
        if best_available(&results.methods).is_none() {
            return;
        }
        self.bootstrap.start("bootstrap", &self.wake, results.revision, move |watch| {
            best_available(&results.methods)
                .map_or(Err(Cancelled), |solution| bootstrap(solution, num_draws, BOOTSTRAP_SEED, watch))
        });
    }
}
