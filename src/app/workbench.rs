//! Document, results, jobs and notices, changed only by commands and finished jobs.

use std::collections::VecDeque;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use crate::calibrate::validation::{Bootstrap, bootstrap};
use crate::calibrate::{BallProblem, Method, MethodResult, best_available, solve_all};
use crate::diagnose::{self, Case, Diagnosis, ReadingFit, Remedy};
use crate::plan::{Limits, Plan, PlanRefusal, next_stations};
use crate::session::{self, History, Measured, Session, SessionError, ball_problem, measure};
use crate::text::diagnosis::remedy_undo_label;
use crate::watch::Cancelled;

use super::Command;
use super::jobs::{JobOutcome, Slot, Wake};
use super::study::Study;

/// Stations that are planned ahead: about as many as one adds before looking again.
const NUM_PLANNED: usize = 4;
/// The same session gives the same bootstrap.
const BOOTSTRAP_SEED: u64 = 1;

/// The open session.
#[derive(Clone, Debug)]
pub struct Document {
    /// Tells this document from those opened before.
    id: u64,
    /// The session as it is now.
    pub session: Arc<Session>,
    /// Its file; `None` for a sample or a new session.
    pub path: Option<PathBuf>,
    /// Counts the edits; results know the revision they belong to.
    pub revision: u64,
    /// What can be undone.
    pub history: History,
    saved: Arc<Session>,
}

impl Document {
    fn new(session: Session, path: Option<PathBuf>, revision: u64) -> Self {
        let session = Arc::new(session);
        // Revisions are never used twice, so the first is as good a name as any.
        Self { id: revision, saved: Arc::clone(&session), session, path, revision, history: History::default() }
    }

    /// Whether there are edits that no file holds.
    #[must_use]
    pub fn is_unsaved(&self) -> bool {
        !Arc::ptr_eq(&self.session, &self.saved) && self.session != self.saved
    }

    /// The file's name, or the session's.
    #[must_use]
    pub fn title(&self) -> String {
        self.path
            .as_deref()
            .and_then(Path::file_name)
            .map_or_else(|| self.session.name.clone(), |name| name.to_string_lossy().into_owned())
    }
}

/// What the methods made of a revision of the document.
#[derive(Clone, Debug)]
pub struct Results {
    /// The revision they belong to.
    pub revision: u64,
    /// The arcs of all captures.
    pub measured: Arc<Measured>,
    /// What the methods were given; `None` if the session is none for the ball.
    pub problem: Option<Arc<BallProblem>>,
    /// One entry a method, in the order of [`Method::ALL`]; empty if the session is none for the ball.
    pub methods: Vec<MethodResult>,
    /// Why there are no methods, in words.
    pub refusal: Option<String>,
    /// How long it took.
    pub elapsed: Duration,
}

impl Results {
    /// The result of one method.
    #[must_use]
    pub fn method(&self, method: Method) -> Option<&MethodResult> {
        self.methods.iter().find(|result| result.method == method)
    }
}

/// How serious a notice is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoticeKind {
    /// Something was done.
    Done,
    /// Something could not be done.
    Error,
}

/// Something to tell the user, shown until dismissed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Notice {
    /// For [`Command::DismissNotice`].
    pub id: u64,
    /// How serious.
    pub kind: NoticeKind,
    /// Whether it is about opening a file, and so belongs where the file was chosen.
    pub is_of_opening: bool,
    /// The sentence.
    pub message: String,
}

/// Progress of a job.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    /// Parts done.
    pub done: usize,
    /// Parts in all; 0 while unknown.
    pub total: usize,
}

impl Progress {
    /// The part that is done, from 0 to 1.
    #[must_use]
    #[expect(clippy::cast_precision_loss, reason = "to be seen as a bar of a few hundred points")]
    pub fn fraction(self) -> f32 {
        if self.total == 0 { 0.0 } else { self.done as f32 / self.total as f32 }
    }
}

/// A session on its way to a file: taken when it was asked for, whatever happens on the bench meanwhile.
#[derive(Clone, Debug)]
struct Save {
    document_id: u64,
    session: Arc<Session>,
    path: PathBuf,
}

#[derive(Debug)]
struct Loaded {
    path: Option<PathBuf>,
    session: Result<Session, SessionError>,
}

/// The state behind the window.
pub struct Workbench {
    wake: Wake,
    document: Option<Document>,
    results: Option<Arc<Results>>,
    notices: Vec<Notice>,
    plan_limits: Limits,
    last_revision: u64,
    last_notice_id: u64,
    loading: Slot<Loaded>,
    /// The revision on the bench when loading began.
    revision_before_loading: Option<u64>,
    saving: Slot<(Save, Result<(), SessionError>)>,
    save_queue: VecDeque<Save>,
    solving: Slot<Result<Results, Cancelled>>,
    diagnosis: Study<Diagnosis>,
    plan: Study<Result<Plan, PlanRefusal>>,
    readings: Study<Vec<ReadingFit>>,
    bootstrap: Study<Bootstrap>,
}

impl Workbench {
    /// An empty workbench; `wake` is called from worker threads when there is news for [`Self::poll`].
    #[must_use]
    pub fn new(wake: Wake) -> Self {
        Self {
            wake,
            document: None,
            results: None,
            notices: Vec::new(),
            plan_limits: Limits::default(),
            last_revision: 0,
            last_notice_id: 0,
            loading: Slot::default(),
            saving: Slot::default(),
            revision_before_loading: None,
            save_queue: VecDeque::new(),
            solving: Slot::default(),
            diagnosis: Study::default(),
            plan: Study::default(),
            readings: Study::default(),
            bootstrap: Study::default(),
        }
    }

    /// The open session.
    #[must_use]
    pub const fn document(&self) -> Option<&Document> {
        self.document.as_ref()
    }

    /// The last results; see [`Self::results_are_current`].
    #[must_use]
    pub fn results(&self) -> Option<&Results> {
        self.results.as_deref()
    }

    /// Whether the results belong to the document as it is now.
    #[must_use]
    pub fn results_are_current(&self) -> bool {
        self.results.as_ref().is_some_and(|results| self.is_current(results.revision))
    }

    /// Whether a revision is that of the document as it is now.
    #[must_use]
    pub fn is_current(&self, revision: u64) -> bool {
        self.document.as_ref().is_some_and(|document| document.revision == revision)
    }

    /// What is wrong with the session. It follows the results by itself.
    #[must_use]
    pub const fn diagnosis(&self) -> &Study<Diagnosis> {
        &self.diagnosis
    }

    /// The diagnosis of the document as it is now, once it is there.
    #[must_use]
    pub fn current_diagnosis(&self) -> Option<&Diagnosis> {
        self.diagnosis.last().filter(|found| self.is_current(found.revision)).map(|found| &found.value)
    }

    /// The plan for the document as it is now, once it is there.
    #[must_use]
    pub fn current_plan(&self) -> Option<&Plan> {
        self.plan.last().filter(|found| self.is_current(found.revision)).and_then(|found| found.value.as_ref().ok())
    }

    /// Where to measure next, for the best available solution. It follows the results by itself.
    #[must_use]
    pub const fn plan(&self) -> &Study<Result<Plan, PlanRefusal>> {
        &self.plan
    }

    /// Within what limits the next stations are planned.
    #[must_use]
    pub const fn plan_limits(&self) -> &Limits {
        &self.plan_limits
    }

    /// The ways to read the poses, where they were asked for.
    #[must_use]
    pub const fn readings(&self) -> &Study<Vec<ReadingFit>> {
        &self.readings
    }

    /// The spread over stations drawn with replacement, where it was asked for.
    #[must_use]
    pub const fn bootstrap(&self) -> &Study<Bootstrap> {
        &self.bootstrap
    }

    /// Notices not yet dismissed, oldest first.
    #[must_use]
    pub fn notices(&self) -> &[Notice] {
        &self.notices
    }

    /// Progress of the solver while it runs.
    #[must_use]
    pub fn solve_progress(&self) -> Option<Progress> {
        self.solving.progress().map(|(done, total)| Progress { done, total })
    }

    /// Whether a file is being read.
    #[must_use]
    pub const fn is_loading(&self) -> bool {
        self.loading.is_running()
    }

    /// Whether a session is on its way to its file.
    #[must_use]
    pub fn is_saving(&self) -> bool {
        self.saving.is_running() || !self.save_queue.is_empty()
    }

    /// Whether any work is under way in the background.
    #[must_use]
    pub const fn is_busy(&self) -> bool {
        self.loading.is_running()
            || self.saving.is_running()
            || self.solving.is_running()
            || self.diagnosis.is_running()
            || self.plan.is_running()
            || self.readings.is_running()
            || self.bootstrap.is_running()
    }

    /// Carries out one command.
    pub fn apply(&mut self, command: Command) {
        match command {
            Command::Open(path) => self.start_loading(path),
            Command::OpenSample(sample_idx) => self.open_sample(sample_idx),
            Command::CloseDocument => self.close_document(),
            Command::Save => self.save(),
            Command::SaveAs(path) => self.start_saving(path),
            Command::SetStationEnabled { station_idx, enabled } => {
                self.edit_station(station_idx, if enabled { "use station" } else { "leave out station" }, |station| {
                    station.enabled = enabled;
                });
            }
            Command::SetStationSide { station_idx, side } => {
                self.edit_station(station_idx, "set side of station", |station| station.side = side);
            }
            Command::ApplyRemedy(remedy) => self.apply_remedy(&remedy),
            Command::Undo => self.step_history(History::undo),
            Command::Redo => self.step_history(History::redo),
            Command::Solve => self.start_solving(),
            Command::CancelSolve => self.solving.cancel(),
            Command::Diagnose => self.diagnose_again(),
            Command::CancelDiagnosis => self.diagnosis.cancel(),
            Command::RankReadings => self.start_ranking(),
            Command::CancelReadings => self.readings.cancel(),
            Command::StartBootstrap { num_draws } => self.start_bootstrap(num_draws),
            Command::CancelBootstrap => self.bootstrap.cancel(),
            Command::SetPlanLimits(limits) => {
                self.plan_limits = limits;
                self.plan.clear();
                self.start_planning();
            }
            Command::DismissNotice(id) => self.notices.retain(|notice| notice.id != id),
        }
    }

    /// Takes in the results of finished jobs. Answers whether anything changed.
    pub fn poll(&mut self) -> bool {
        let mut changed = false;
        // Saves first: a file that arrives in the same turn takes the saved document off the bench.
        if let Some(outcome) = self.saving.poll() {
            changed = true;
            match outcome {
                JobOutcome::Done((save, Ok(()))) => self.note_saved(save),
                JobOutcome::Done((_, Err(error))) => self.notify(NoticeKind::Error, error.to_string()),
                broken => self.notify_broken("saving", &broken),
            }
            if let Some(next) = self.save_queue.pop_front() {
                self.run_save(next);
            }
        }
        if let Some(outcome) = self.loading.poll() {
            changed = true;
            match outcome {
                JobOutcome::Done(Loaded { path, session: Ok(session) }) => self.take_loaded(session, path),
                JobOutcome::Done(Loaded { session: Err(error), .. }) => self.notify_of_opening(error.to_string()),
                broken => {
                    self.notify_broken("reading the file", &broken);
                    self.mark_newest_as_of_opening();
                }
            }
        }
        if let Some(outcome) = self.solving.poll() {
            changed = true;
            match outcome {
                JobOutcome::Done(Ok(results)) => self.take_results(results),
                JobOutcome::Done(Err(Cancelled)) => {}
                broken => self.notify_broken("solving", &broken),
            }
        }
        for (what, ended) in [
            ("the diagnosis", self.diagnosis.poll()),
            ("planning", self.plan.poll()),
            ("trying other conventions", self.readings.poll()),
            ("the bootstrap", self.bootstrap.poll()),
        ] {
            let Some(ended) = ended else { continue };
            changed = true;
            if !matches!(ended, JobOutcome::Done(())) {
                self.notify_broken(what, &ended);
            }
        }
        changed
    }

    /// Puts a session on the bench and solves it.
    pub fn open_session(&mut self, session: Session, path: Option<PathBuf>) {
        self.forget_errors();
        self.last_revision += 1;
        self.document = Some(Document::new(session, path, self.last_revision));
        self.forget_results();
        self.start_solving();
    }

    fn forget_results(&mut self) {
        self.results = None;
        self.diagnosis.clear();
        self.plan.clear();
        self.readings.clear();
        self.bootstrap.clear();
        self.plan_limits = Limits::default();
    }

    /// The results are shown at once; what is to be said about them follows.
    fn take_results(&mut self, results: Results) {
        self.results = Some(Arc::new(results));
        self.start_diagnosing();
        self.start_planning();
    }

    /// What was edited while the file was being read is not thrown away.
    fn take_loaded(&mut self, session: Session, path: Option<PathBuf>) {
        let revision = self.document.as_ref().map(|document| document.revision);
        let is_edited = self.document.as_ref().is_some_and(Document::is_unsaved);
        if is_edited && revision != self.revision_before_loading {
            self.notify_of_opening(format!(
                    "\"{}\" was not opened: the session on the bench was edited while it was read. Save it, then open again",
                    session.name
            ));
        } else {
            self.open_session(session, path);
        }
    }

    fn start_loading(&mut self, path: PathBuf) {
        self.revision_before_loading = self.document.as_ref().map(|document| document.revision);
        self.loading.start("load session", &self.wake, move |_| {
            let session = session::load(&path);
            Loaded { path: Some(path), session }
        });
    }

    fn open_sample(&mut self, sample_idx: usize) {
        let Some(sample) = session::samples::ALL.get(sample_idx) else {
            self.notify_of_opening(format!("there is no sample session number {sample_idx}"));
            return;
        };
        self.revision_before_loading = self.document.as_ref().map(|document| document.revision);
        self.loading.start("load sample", &self.wake, move |_| Loaded {
            path: None,
            session: session::parse(sample.json.as_bytes(), sample.file_name),
        });
    }

    fn close_document(&mut self) {
        self.loading.cancel();
        self.solving.cancel();
        self.document = None;
        self.forget_results();
    }

    fn save(&mut self) {
        match self.document.as_ref().map(|document| document.path.clone()) {
            Some(Some(path)) => self.start_saving(path),
            Some(None) => {
                self.notify(NoticeKind::Error, "this session has no file yet: choose one with \"Save as…\"".to_owned());
            }
            None => self.notify(NoticeKind::Error, "there is no open session to save".to_owned()),
        }
    }

    fn start_saving(&mut self, path: PathBuf) {
        let Some(document) = &self.document else {
            self.notify(NoticeKind::Error, "there is no open session to save".to_owned());
            return;
        };
        let save = Save { document_id: document.id, session: Arc::clone(&document.session), path };
        if self.saving.is_running() {
            // A save is never dropped; the next one starts when this one has ended.
            self.save_queue.push_back(save);
        } else {
            self.run_save(save);
        }
    }

    fn run_save(&mut self, save: Save) {
        self.saving.start("save session", &self.wake, move |_| {
            let outcome = session::save(&save.session, &save.path);
            (save, outcome)
        });
    }

    fn note_saved(&mut self, save: Save) {
        self.forget_errors();
        self.notify(NoticeKind::Done, format!("saved to {}", save.path.display()));
        // Another document may be on the bench by now; its file is another.
        if let Some(document) = self.document.as_mut().filter(|document| document.id == save.document_id) {
            document.saved = save.session;
            document.path = Some(save.path);
        }
    }

    fn edit_station(&mut self, station_idx: usize, label: &str, edit: impl FnOnce(&mut session::Station)) {
        let Some(document) = &self.document else { return };
        let mut changed = Session::clone(&document.session);
        let Some(station) = changed.stations.get_mut(station_idx) else { return };
        edit(station);
        let label = format!("{label} {}", changed.stations[station_idx].label);
        self.replace_session(changed, label);
    }

    fn apply_remedy(&mut self, remedy: &Remedy) {
        let Some(document) = &self.document else { return };
        let label = remedy_undo_label(remedy, &document.session);
        self.replace_session(diagnose::remedy::apply(&document.session, remedy), label);
    }

    /// One edit that can be undone; one that changes nothing is none.
    fn replace_session(&mut self, changed: Session, label: String) {
        let Some(document) = &mut self.document else { return };
        if changed == *document.session {
            return;
        }
        let before = std::mem::replace(&mut document.session, Arc::new(changed));
        document.history.record(label, before);
        self.touch();
    }

    fn step_history(&mut self, step: impl FnOnce(&mut History, Arc<Session>) -> Option<Arc<Session>>) {
        let Some(document) = &mut self.document else { return };
        if let Some(session) = step(&mut document.history, Arc::clone(&document.session)) {
            document.session = session;
            self.touch();
        }
    }

    /// The document has changed: a new revision, to be solved.
    fn touch(&mut self) {
        self.last_revision += 1;
        if let Some(document) = &mut self.document {
            document.revision = self.last_revision;
        }
        self.start_solving();
    }

    fn start_solving(&mut self) {
        // They would speak of what is about to change; what they have found stays, marked as out of date.
        self.diagnosis.cancel();
        self.plan.cancel();
        self.readings.cancel();
        self.bootstrap.cancel();
        let Some(document) = &self.document else { return };
        let session = Arc::clone(&document.session);
        let revision = document.revision;
        let previous = self.results.as_ref().map(|results| Arc::clone(&results.measured));
        self.solving.start("solve", &self.wake, move |watch| {
            let start = Instant::now();
            let measured = Arc::new(measure(&session, previous.as_deref(), watch)?);
            let (problem, methods, refusal) = match ball_problem(&session, &measured) {
                Ok(problem) => {
                    let methods = solve_all(&problem, &Method::ALL, watch)?;
                    (Some(Arc::new(problem)), methods, None)
                }
                Err(refusal) => (None, Vec::new(), Some(refusal.to_string())),
            };
            Ok(Results { revision, measured, problem, methods, refusal, elapsed: start.elapsed() })
        });
    }

    /// Document, problem and results of the same revision, if there are any.
    fn case(&self) -> Option<(Arc<Session>, Arc<BallProblem>, Arc<Results>)> {
        let document = self.document.as_ref()?;
        let results = self.results.as_ref().filter(|results| results.revision == document.revision)?;
        let problem = results.problem.as_ref()?;
        Some((Arc::clone(&document.session), Arc::clone(problem), Arc::clone(results)))
    }

    /// Results that are out of date are made anew first; the diagnosis follows them.
    fn diagnose_again(&mut self) {
        if self.results_are_current() {
            self.start_diagnosing();
        } else {
            self.start_solving();
        }
    }

    fn start_diagnosing(&mut self) {
        let Some((session, problem, results)) = self.case() else { return };
        self.diagnosis.start("diagnose", &self.wake, results.revision, move |watch| {
            diagnose::diagnose(Case { session: &session, problem: &problem, results: &results.methods }, watch)
        });
    }

    fn start_ranking(&mut self) {
        let Some((session, problem, results)) = self.case() else { return };
        self.readings.start("try conventions", &self.wake, results.revision, move |watch| {
            diagnose::convention::rank(&session, &problem, watch)
        });
    }

    fn start_planning(&mut self) {
        let Some((_, problem, results)) = self.case() else { return };
        let limits = self.plan_limits;
        self.plan.start("plan", &self.wake, results.revision, move |_| {
            let solution = best_available(&results.methods).ok_or(PlanRefusal::Undetermined);
            Ok(solution.and_then(|solution| next_stations(&problem, solution, &limits, NUM_PLANNED)))
        });
    }

    fn start_bootstrap(&mut self, num_draws: usize) {
        let Some((_, _, results)) = self.case() else { return };
        if best_available(&results.methods).is_none() {
            return;
        }
        self.bootstrap.start("bootstrap", &self.wake, results.revision, move |watch| {
            best_available(&results.methods)
                .map_or(Err(Cancelled), |solution| bootstrap(solution, num_draws, BOOTSTRAP_SEED, watch))
        });
    }

    fn notify(&mut self, kind: NoticeKind, message: String) {
        self.last_notice_id += 1;
        self.notices.push(Notice { id: self.last_notice_id, kind, is_of_opening: false, message });
    }

    fn notify_of_opening(&mut self, message: String) {
        self.notify(NoticeKind::Error, message);
        self.mark_newest_as_of_opening();
    }

    fn mark_newest_as_of_opening(&mut self) {
        if let Some(notice) = self.notices.last_mut() {
            notice.is_of_opening = true;
        }
    }

    /// Something worked: what went wrong before it is history.
    fn forget_errors(&mut self) {
        self.notices.retain(|notice| notice.kind != NoticeKind::Error);
    }

    fn notify_broken<T>(&mut self, what: &str, outcome: &JobOutcome<T>) {
        let message = match outcome {
            JobOutcome::NotStarted(error) => format!("{what} could not start: {error}"),
            JobOutcome::Done(_) | JobOutcome::Panicked => {
                format!("{what} broke down; this is a bug in Handeye. Your session is unchanged")
            }
        };
        self.notify(NoticeKind::Error, message);
    }
}
