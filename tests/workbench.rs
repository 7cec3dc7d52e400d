//! The workbench without a window: from a file to results, edits, undo, and back to a file.
#![expect(clippy::expect_used, reason = "a test that finds nothing to check must fail")]

use std::path::Path;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, sync_channel};

use handeye::app::{Command, NoticeKind, Workbench};
use handeye::calibrate::{Method, Solution, Verdict, verdict::judge};
use handeye::diagnose::{Diagnosis, Evidence, Fault, Finding, Reason, Remedy, Severity, verdict_with};
use handeye::plan::Limits;
use handeye::session::{self, Edit, SetupField};

struct Bench {
    workbench: Workbench,
    woken: Receiver<()>,
}

impl Bench {
    fn new() -> Self {
        let (sender, woken) = sync_channel(64);
        let wake = move || {
            sender.try_send(()).ok();
        };
        Self { workbench: Workbench::new(Arc::new(wake)), woken }
    }

    /// Applies a command and waits until all work it caused is done.
    fn apply(&mut self, command: Command) {
        self.workbench.apply(command);
        while self.workbench.is_busy() {
            self.woken.recv().expect("workers wake the bench");
            self.workbench.poll();
        }
    }

    fn solution(&self) -> &Solution {
        let results = self.workbench.results().expect("solved");
        results.method(Method::BallBundle).expect("run").outcome.as_ref().expect("solved")
    }

    fn translation(&self) -> [f64; 3] {
        self.solution().flange_from_sensor.translation_mm().into()
    }
}

fn sample(name: &str) -> usize {
    session::samples::ALL.iter().position(|sample| sample.file_name == name).expect("a sample")
}

#[test]
fn leaving_a_station_out_solves_again_and_undo_brings_the_old_result_back() {
    let mut bench = Bench::new();
    bench.apply(Command::OpenSample(sample("one-bad-pose.json")));
    let before = bench.translation();
    let verdict = |bench: &Bench| judge(bench.solution()).0;
    assert_eq!(verdict(&bench), Verdict::NotUsable);
    bench.apply(Command::SetStationEnabled { station_idx: 6, enabled: false });
    assert!(bench.workbench.results_are_current());
    assert_eq!(verdict(&bench), Verdict::Good);
    let document = bench.workbench.document().expect("open");
    assert!(document.is_unsaved());
    assert_eq!(document.history.undo_label(), Some("leave out station 7"));
    bench.apply(Command::Undo);
    // Solved again from the same data: the same bits.
    assert_eq!(bench.translation().map(f64::to_bits), before.map(f64::to_bits));
    assert!(!bench.workbench.document().expect("open").is_unsaved());
    bench.apply(Command::Redo);
    assert_eq!(verdict(&bench), Verdict::Good);
}

#[test]
fn an_edit_that_changes_nothing_is_no_edit() {
    let mut bench = Bench::new();
    bench.apply(Command::OpenSample(sample("clean-sweeps.json")));
    let revision = bench.workbench.document().expect("open").revision;
    bench.apply(Command::SetStationEnabled { station_idx: 0, enabled: true });
    let document = bench.workbench.document().expect("open");
    assert_eq!((document.revision, document.history.undo_label()), (revision, None));
}

#[test]
fn saving_under_another_name_makes_that_the_documents_file() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("saved.json");
    let mut bench = Bench::new();
    bench.apply(Command::OpenSample(sample("lin-mu-2019-table-1.json")));
    bench.apply(Command::Save);
    let notice = bench.workbench.notices().last().expect("told");
    assert_eq!(notice.kind, NoticeKind::Error);
    bench.apply(Command::SetStationEnabled { station_idx: 1, enabled: false });
    bench.apply(Command::SaveAs(path.clone()));
    let document = bench.workbench.document().expect("open");
    assert_eq!(document.path.as_deref(), Some(path.as_path()));
    assert!(!document.is_unsaved());
    assert_eq!(session::load(&path).as_ref(), Ok(&*document.session));
}

#[test]
fn a_file_that_cannot_be_opened_leaves_the_session_on_the_bench() {
    let mut bench = Bench::new();
    bench.apply(Command::OpenSample(sample("clean-sweeps.json")));
    bench.apply(Command::Open(Path::new("no-such-folder/no-such-file.json").to_owned()));
    let notice = bench.workbench.notices().last().expect("told");
    assert_eq!(notice.kind, NoticeKind::Error);
    // The window shows the sentence that the command prints.
    let error = session::load(Path::new("no-such-folder/no-such-file.json")).expect_err("missing");
    assert_eq!(notice.message, error.to_string());
    assert!(bench.workbench.document().is_some());
}

#[test]
fn a_save_belongs_to_the_document_it_was_asked_for() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("first.json");
    let mut bench = Bench::new();
    bench.apply(Command::OpenSample(sample("clean-sweeps.json")));
    // Two saves and another document, all before anything has ended.
    bench.workbench.apply(Command::SaveAs(path.clone()));
    bench.workbench.apply(Command::SaveAs(path.clone()));
    bench.apply(Command::OpenSample(sample("one-bad-pose.json")));
    let document = bench.workbench.document().expect("open");
    assert_eq!(document.path, None);
    assert_eq!(document.session.name, "One bad pose, simulated");
    assert_eq!(session::load(&path).expect("saved").name, "Clean sweeps, simulated");
}

#[test]
fn what_was_edited_while_a_file_was_read_is_not_thrown_away() {
    let mut bench = Bench::new();
    bench.apply(Command::OpenSample(sample("clean-sweeps.json")));
    bench.workbench.apply(Command::OpenSample(sample("one-bad-pose.json")));
    bench.apply(Command::SetStationEnabled { station_idx: 0, enabled: false });
    let document = bench.workbench.document().expect("open");
    assert_eq!(document.session.name, "Clean sweeps, simulated");
    assert!(bench.workbench.notices().iter().any(|notice| notice.message.contains("was not opened")));
}

#[test]
fn after_a_cancel_the_session_can_be_solved_again() {
    let mut bench = Bench::new();
    bench.workbench.apply(Command::OpenSample(sample("clean-sweeps.json")));
    while bench.workbench.is_loading() {
        bench.woken.recv().expect("workers wake the bench");
        bench.workbench.poll();
    }
    bench.apply(Command::CancelSolve);
    bench.apply(Command::Solve);
    assert!(bench.workbench.results_are_current());
}

#[test]
fn diagnosis_and_plan_follow_the_results_and_stay_while_newer_ones_are_made() {
    let mut bench = Bench::new();
    bench.apply(Command::OpenSample(sample("clean-sweeps.json")));
    let workbench = &bench.workbench;
    assert!(workbench.current_diagnosis().is_some() && workbench.current_plan().is_some());
    bench.workbench.apply(Command::SetStationEnabled { station_idx: 0, enabled: false });
    let workbench = &bench.workbench;
    assert!(workbench.is_busy());
    assert!(workbench.current_diagnosis().is_none() && workbench.current_plan().is_none());
    assert!(workbench.diagnosis().last().is_some() && workbench.plan().last().is_some(), "the last ones stay");
    bench.apply(Command::Solve);
    let workbench = &bench.workbench;
    assert!(workbench.current_diagnosis().is_some() && workbench.current_plan().is_some());
    bench.apply(Command::CloseDocument);
    assert!(bench.workbench.diagnosis().last().is_none() && bench.workbench.plan().last().is_none());
}

#[test]
fn after_a_cancel_the_session_can_be_diagnosed_again() {
    let mut bench = Bench::new();
    bench.apply(Command::OpenSample(sample("clean-sweeps.json")));
    let found = bench.workbench.current_diagnosis().cloned().expect("diagnosed");
    bench.workbench.apply(Command::SetStationEnabled { station_idx: 0, enabled: false });
    bench.workbench.apply(Command::Undo);
    while !bench.workbench.results_are_current() {
        bench.woken.recv().expect("workers wake the bench");
        bench.workbench.poll();
    }
    bench.apply(Command::CancelDiagnosis);
    assert!(bench.workbench.current_diagnosis().is_none());
    bench.apply(Command::Diagnose);
    assert_eq!(bench.workbench.current_diagnosis(), Some(&found), "the same session, the same findings");
}

#[test]
fn a_remedy_is_one_edit_that_can_be_undone() {
    let mut bench = Bench::new();
    bench.apply(Command::OpenSample(sample("one-bad-pose.json")));
    let before = bench.translation();
    bench.apply(Command::ApplyRemedy(Remedy::LeaveOut(vec![6])));
    let document = bench.workbench.document().expect("open");
    assert!(!document.session.stations[6].enabled);
    assert_eq!(document.history.undo_label(), Some("leave out station 7"));
    let revision = document.revision;
    bench.apply(Command::ApplyRemedy(Remedy::LeaveOut(vec![6])));
    assert_eq!(bench.workbench.document().expect("open").revision, revision, "nothing is left to be mended");
    bench.apply(Command::Undo);
    assert_eq!(bench.translation().map(f64::to_bits), before.map(f64::to_bits));
}

#[test]
fn a_bootstrap_runs_on_request_and_is_out_of_date_after_an_edit() {
    let mut bench = Bench::new();
    bench.apply(Command::OpenSample(sample("clean-sweeps.json")));
    assert!(bench.workbench.bootstrap().last().is_none(), "only on request");
    bench.workbench.apply(Command::StartBootstrap { num_draws: 1_000_000 });
    assert!(bench.workbench.is_busy() && bench.workbench.bootstrap().progress().is_some());
    bench.apply(Command::CancelBootstrap);
    assert!(bench.workbench.bootstrap().last().is_none());
    bench.apply(Command::StartBootstrap { num_draws: 8 });
    let revision = bench.workbench.bootstrap().last().expect("run").revision;
    assert!(bench.workbench.is_current(revision));
    bench.apply(Command::SetStationEnabled { station_idx: 0, enabled: false });
    assert!(!bench.workbench.is_current(bench.workbench.bootstrap().last().expect("it stays").revision));
}

#[test]
fn other_ways_to_read_the_poses_are_ranked_on_request() {
    let mut bench = Bench::new();
    bench.apply(Command::OpenSample(sample("clean-sweeps.json")));
    assert!(bench.workbench.readings().last().is_none(), "the poses as given fit");
    bench.apply(Command::RankReadings);
    let readings = &bench.workbench.readings().last().expect("ranked").value;
    assert!(readings.first().is_some_and(|fit| fit.is_as_given), "{readings:?}");
    assert!(readings.windows(2).all(|pair| pair[0].rms_mm <= pair[1].rms_mm));
}

#[test]
fn other_limits_give_another_plan() {
    let mut bench = Bench::new();
    bench.apply(Command::OpenSample(sample("clean-sweeps.json")));
    let limits = Limits { max_tilt_deg: 6.0, max_spin_deg: 15.0, ..Limits::default() };
    bench.apply(Command::SetPlanLimits(limits));
    assert_eq!(bench.workbench.plan_limits(), &limits);
    let plan = bench.workbench.current_plan().expect("planned");
    // Rounding only.
    let is_within = |tilt_deg: f64, spin_deg: f64| tilt_deg <= 6.0 + 1e-6 && spin_deg.abs() <= 15.0 + 1e-6;
    assert!(plan.stations.iter().all(|station| is_within(station.tilt_deg, station.spin_deg)), "{plan:?}");
    bench.apply(Command::OpenSample(sample("one-bad-pose.json")));
    assert_eq!(bench.workbench.plan_limits(), &Limits::default(), "limits belong to their session");
}

#[test]
fn findings_only_make_the_verdict_worse() {
    let mut bench = Bench::new();
    bench.apply(Command::OpenSample(sample("clean-sweeps.json")));
    let solution = bench.solution();
    let (by_figures, _) = judge(solution);
    assert_eq!(by_figures, Verdict::Good);
    assert_eq!(verdict_with(solution, None).0, by_figures);
    for (severity, expected) in
        [(Severity::Note, Verdict::Good), (Severity::Doubtful, Verdict::Usable), (Severity::Wrong, Verdict::NotUsable)]
    {
        let finding = Finding {
            fault: Fault::HalvesDisagree { median_mm: 1.0, expected_mm: 0.1 },
            severity,
            explains: 1.0,
            evidence: Evidence::default(),
            remedy: None,
        };
        let diagnosis = Diagnosis { findings: vec![finding], readings: Vec::new(), validation: None };
        let (verdict, reason) = verdict_with(solution, Some(&diagnosis));
        assert_eq!(verdict, expected);
        assert_eq!(matches!(reason, Reason::Finding(_)), severity != Severity::Note);
    }
}

#[test]
fn another_name_leaves_the_results_as_they_are() {
    let mut bench = Bench::new();
    bench.apply(Command::OpenSample(sample("clean-sweeps.json")));
    let solved = bench.workbench.results().expect("solved").revision;
    let rename = Edit::Setup(SetupField::Name("cell 4".to_owned()));
    bench.workbench.apply(Command::Edit { edit: rename, gesture: None });
    assert!(!bench.workbench.is_busy(), "nothing is computed of a name");
    assert!(bench.workbench.results_are_current());
    assert_eq!(bench.workbench.results().expect("solved").revision, solved);
    assert!(bench.workbench.document().expect("open").is_unsaved());
    // What is computed with makes them old, also when it is undone together with the name.
    bench.apply(Command::SetStationEnabled { station_idx: 0, enabled: false });
    assert!(bench.workbench.results().expect("solved").revision > solved);
    bench.apply(Command::StepHistory(-2));
    assert!(bench.workbench.results_are_current());
    assert!(!bench.workbench.document().expect("open").is_unsaved());
}

#[test]
fn saving_right_after_save_as_goes_to_the_new_file() {
    let folder = tempfile::tempdir().expect("a folder");
    let [old, new] = ["old.json", "new.json"].map(|name| folder.path().join(name));
    let mut bench = Bench::new();
    bench.apply(Command::OpenSample(sample("clean-sweeps.json")));
    bench.apply(Command::SaveAs(old.clone()));
    let rename = |name: &str| Command::Edit { edit: Edit::Setup(SetupField::Name(name.to_owned())), gesture: None };
    bench.workbench.apply(rename("first"));
    bench.workbench.apply(Command::SaveAs(new.clone()));
    bench.workbench.apply(rename("second"));
    bench.apply(Command::Save);
    assert_eq!(session::load(&new).expect("saved").name, "second");
    assert_eq!(session::load(&old).expect("saved").name, "Clean sweeps, simulated");
    assert_eq!(bench.workbench.document().expect("open").path.as_deref(), Some(&*new));
}
