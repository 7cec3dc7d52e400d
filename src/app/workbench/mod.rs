//! Document, results, jobs and notices, changed only by commands and finished jobs.

mod cell;
pub mod comparing;
mod edits;
mod exports;
mod files;
mod imports;
mod keeping;
pub mod reporting;
pub mod scans;
pub mod sequence;
mod studies;
mod verifying;

use std::collections::VecDeque;
use std::path::PathBuf;
use std::sync::Arc;

use crate::calibrate::validation::Bootstrap;
use crate::diagnose::{Diagnosis, ReadingFit};
use crate::plan::{Limits, Plan, PlanRefusal};
use crate::report::open::NotOpened;
use crate::session::edit::CellValue;
use crate::verify::{Calibration, Verification};
use crate::watch::Cancelled;

use super::jobs::{JobOutcome, Slot, Wake};
use super::recovery::{Recoverable, Recovery};
use super::study::Study;
use super::{Command, Document};

use self::cell::LiveCell;
use self::comparing::{Compared, FolderRead};
use self::exports::Exported;
use self::files::{Loaded, Look, Save, SaveOutcome};
pub use self::imports::ImportDraft;
use self::imports::Imports;
use self::reporting::{Gathered, Reported};
use self::scans::Scans;
use self::sequence::SequenceBench;
pub use self::studies::Results;
use self::verifying::Added;

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
    saving: Slot<(Save, SaveOutcome)>,
    save_queue: VecDeque<Save>,
    /// The document and the file of the save that was asked for last.
    newest_save: Option<(u64, PathBuf)>,
    /// A save that met a file changed by another program; the user is to say what becomes of it.
    conflict: Option<PathBuf>,
    looking: Slot<Look>,
    /// Whether the file is to be looked at once more after that.
    looks_again: bool,
    recovery: Option<Recovery>,
    recoverable: Vec<Recoverable>,
    solving: Slot<Result<Results, Cancelled>>,
    diagnosis: Study<Diagnosis>,
    plan: Study<Result<Plan, PlanRefusal>>,
    readings: Study<Vec<ReadingFit>>,
    bootstrap: Study<Bootstrap>,
    verification: Study<Verification>,
    /// Whether results wait to be verified until the routine at the cell has ended.
    verifies_later: bool,
    /// Calibrations from elsewhere, judged along with the session's own.
    given: Vec<Calibration>,
    adding: Slot<Added>,
    comparison: Study<Compared>,
    result_history: Study<FolderRead>,
    imports: Imports,
    exporting: Slot<Exported>,
    scans: Scans,
    sequence: SequenceBench,
    report: Study<Arc<Gathered>>,
    reporting: Slot<(Option<u64>, Reported)>,
    opening: Slot<Result<(), NotOpened>>,
    written_report: Option<PathBuf>,
    cell: LiveCell,
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
            newest_save: None,
            conflict: None,
            looking: Slot::default(),
            looks_again: false,
            recovery: None,
            recoverable: Vec::new(),
            solving: Slot::default(),
            diagnosis: Study::default(),
            plan: Study::default(),
            readings: Study::default(),
            bootstrap: Study::default(),
            verification: Study::default(),
            verifies_later: false,
            given: Vec::new(),
            adding: Slot::default(),
            comparison: Study::default(),
            result_history: Study::default(),
            imports: Imports::default(),
            exporting: Slot::default(),
            scans: Scans::default(),
            sequence: SequenceBench::default(),
            report: Study::default(),
            reporting: Slot::default(),
            opening: Slot::default(),
            written_report: None,
            cell: LiveCell::default(),
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
        self.document.as_ref().is_some_and(|document| revision >= document.data_revision)
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

    /// What a report is made of, where it was asked for.
    #[must_use]
    pub const fn report(&self) -> &Study<Arc<Gathered>> {
        &self.report
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
            || self.looking.is_running()
            || self.solving.is_running()
            || self.diagnosis.is_running()
            || self.plan.is_running()
            || self.readings.is_running()
            || self.bootstrap.is_running()
            || self.verification.is_running()
            || self.adding.is_running()
            || self.comparison.is_running()
            || self.result_history.is_running()
            || self.imports.is_busy()
            || self.exporting.is_running()
            || self.scans.is_busy()
            || self.sequence.is_busy()
            || self.report.is_running()
            || self.reporting.is_running()
            || self.opening.is_running()
    }

    /// Carries out one command.
    pub fn apply(&mut self, command: Command) {
        match command {
            Command::Open(path) => self.open_file(path),
            Command::OpenSample(sample_idx) => self.open_sample(sample_idx),
            Command::NewSession(target) => self.begin_session(target),
            Command::CloseDocument => self.close_document(),
            Command::Save => self.save(),
            Command::SaveAs(path) => self.start_saving(path),
            Command::SaveAnyway => self.save_anyway(),
            Command::GiveUpSaving => self.conflict = None,
            Command::CheckFile => self.look_at_file(),
            Command::Reload => self.reload(),
            Command::Recover(idx) => self.recover(idx),
            Command::DiscardRecoverable(idx) => self.discard_recoverable(idx),
            Command::Edit { edit, gesture } => self.edit(&edit, gesture),
            Command::StepHistory(steps) => self.go_through_history(steps),
            Command::Import(paths) => self.start_import(paths),
            Command::ImportText(text) => self.start_import_of_text(text),
            Command::SetImportOptions(options) => self.set_import_options(*options),
            Command::FinishImport(into) => self.finish_import(into),
            Command::CancelImport => self.cancel_import(),
            Command::ExportPoses(path) => self.export_poses(path),
            Command::ExportProfiles(folder) => self.export_profiles(folder),
            Command::WriteFile { path, contents } => self.write_file(path, contents),
            Command::SetStationEnabled { station_idx, enabled } => {
                self.edit_station(station_idx, CellValue::Used(enabled));
            }
            Command::SetStationSide { station_idx, side } => self.edit_station(station_idx, CellValue::Side(side)),
            Command::ApplyRemedy(remedy) => self.apply_remedy(&remedy),
            Command::Undo => self.go_through_history(-1),
            Command::Redo => self.go_through_history(1),
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
            Command::AddFurther(path) => self.start_adding_further(path),
            Command::GiveCalibration(calibration) => self.give_calibration(*calibration),
            Command::WithdrawCalibration(name) => self.withdraw_calibration(&name),
            Command::Sequence(command) => self.command_sequence(command),
            Command::CompareCalibrations(sides) => self.compare_calibrations(*sides),
            Command::CancelComparison => self.comparison.cancel(),
            Command::ReadResultHistory(folder) => self.read_result_history(folder),
            Command::CancelResultHistory => self.result_history.cancel(),
            Command::Scan(command) => self.command_scans(*command),
            Command::Cell(command) => self.command_cell(*command),
            Command::GatherReport => self.gather_report(),
            Command::CancelReport => self.report.cancel(),
            Command::OpenReport => self.open_report(),
            Command::WriteReport { folder, options } => self.write_report(folder, *options),
            Command::Tell(kind, message) => self.notify(kind, message),
            Command::DismissNotice(id) => self.notices.retain(|notice| notice.id != id),
        }
    }

    /// Takes in the results of finished jobs. Answers whether anything changed.
    pub fn poll(&mut self) -> bool {
        let mut changed = false;
        // Saves first: a file that arrives in the same turn takes the saved document off the bench.
        if let Some(outcome) = self.saving.poll() {
            changed = true;
            self.take_saved(outcome);
        }
        if let Some(outcome) = self.loading.poll() {
            changed = true;
            self.take_loaded(outcome);
        }
        if let Some(outcome) = self.looking.poll() {
            changed = true;
            self.take_look(&outcome);
        }
        changed |= self.take_news_of_recovery();
        // Before what was solved of it.
        changed |= self.poll_sequence();
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
            ("verifying", self.verification.poll()),
            ("gathering the report", self.report.poll()),
            ("comparing", self.comparison.poll()),
            ("reading the history", self.result_history.poll()),
        ] {
            let Some(ended) = ended else { continue };
            changed = true;
            if !matches!(ended, JobOutcome::Done(())) {
                self.notify_broken(what, &ended);
            }
        }
        if let Some(outcome) = self.adding.poll() {
            changed = true;
            self.take_added(outcome);
        }
        let imported = self.poll_imports();
        let exported = self.poll_exports() | self.poll_scans() | self.poll_report() | self.poll_opening();
        // Last, as a run goes on once the results of its last station are there.
        let cell = self.poll_cell();
        self.verify_what_waited();
        changed || imported || exported || cell
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
