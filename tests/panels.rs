//! The arcs, the comparison and the diagnosis panel alone, driven by the names that screen readers see.
#![expect(clippy::expect_used, reason = "helpers of tests may fail as tests do")]

use std::sync::Arc;
use std::sync::mpsc::{Receiver, sync_channel};

use egui::Key;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use handeye::app::{Command, Progress, Workbench};
use handeye::calibrate::validation::{Bootstrap, Influence, Normality, SplitHalf, Validation};
use handeye::calibrate::{self, Method};
use handeye::diagnose::{
    CurveAxis, Diagnosis, Evidence, Fault, Finding, Plot, PoseReading, ReadingFit, Remedy, Severity, StationBar,
};
use handeye::geometry::{Profile, Transform, Vec3};
use handeye::plan::{Plan, PlanRefusal, PlannedStation};
use handeye::scene::PartKind;
use handeye::session::{self, Reading, Session, Target, samples};
use handeye::simulate::{SimulationOptions, SimulationTarget, simulate};
use handeye::text::{
    arcs as arcs_words, compare as compare_words, diagnosis as fault_words, diagnosis_panel as panel_words,
    method_name, method_short_name,
};
use handeye::ui::actions::Action;
use handeye::ui::arcs::ArcsState;
use handeye::ui::compare::CompareState;
use handeye::ui::diagnosis::{DiagnosisState, Seen, View};
use handeye::ui::{self, PanelContext, Selection, Step};

#[derive(Clone, Copy)]
enum Shown {
    Arcs,
    Compare,
    Diagnosis,
}

struct Bench {
    workbench: Workbench,
    woken: Receiver<()>,
    shown: Shown,
    selection: Selection,
    commands: Vec<Command>,
    actions: Vec<Action>,
    arcs: ArcsState,
    compare: CompareState,
    diagnosis: DiagnosisState,
    /// Stands in the diagnosis panel for what was really found.
    made_up: Option<MadeUp>,
}

/// A diagnosis made by hand, as the panel would see it.
struct MadeUp {
    diagnosis: Diagnosis,
    is_current: bool,
    bootstrap: Option<Bootstrap>,
    bootstrap_progress: Option<Progress>,
    plan: Result<Plan, PlanRefusal>,
}

impl Bench {
    fn empty(shown: Shown) -> Self {
        let (sender, woken) = sync_channel(8);
        Self {
            workbench: Workbench::new(Arc::new(move || {
                // A full channel already holds the news that there is news.
                sender.try_send(()).ok();
            })),
            woken,
            shown,
            selection: Selection::default(),
            commands: Vec::new(),
            actions: Vec::new(),
            arcs: ArcsState::default(),
            compare: CompareState::default(),
            diagnosis: DiagnosisState::default(),
            made_up: None,
        }
    }

    fn with(shown: Shown, session: Session) -> Self {
        let mut bench = Self::empty(shown);
        bench.workbench.open_session(session, None);
        bench.settle();
        bench
    }

    fn settle(&mut self) {
        while self.workbench.is_busy() {
            self.woken.recv().expect("the worker wakes us");
            self.workbench.poll();
        }
    }

    fn ui(ui: &mut egui::Ui, bench: &mut Self) {
        let mut context = PanelContext {
            workbench: &bench.workbench,
            selection: &mut bench.selection,
            commands: &mut bench.commands,
            actions: &mut bench.actions,
        };
        match bench.shown {
            Shown::Arcs => ui::arcs::show(ui, &mut context, &mut bench.arcs),
            Shown::Compare => ui::compare::show(ui, &mut context, &mut bench.compare),
            Shown::Diagnosis => match (&bench.made_up, View::of(&bench.workbench)) {
                (Some(made_up), Some(mut view)) => {
                    let revision = Some(u64::from(made_up.is_current));
                    let is_current = made_up.is_current;
                    view.diagnosis = Seen { value: Some(&made_up.diagnosis), revision, is_current, progress: None };
                    view.plan = Seen { value: Some(&made_up.plan), revision, is_current, progress: None };
                    let (value, progress) = (made_up.bootstrap.as_ref(), made_up.bootstrap_progress);
                    view.bootstrap = Seen { value, revision, is_current, progress };
                    ui::diagnosis::show_view(ui, &view, &mut context, &mut bench.diagnosis);
                }
                _ => ui::diagnosis::show(ui, &mut context, &mut bench.diagnosis),
            },
        }
    }

    fn harness(self) -> Harness<'static, Self> {
        self.harness_of_size([1000.0, 800.0])
    }

    fn harness_of_size(self, size: [f32; 2]) -> Harness<'static, Self> {
        let mut harness =
            Harness::builder().with_size(size).with_context_setup(ui::theme::install).build_ui_state(Self::ui, self);
        harness.run_steps(4);
        harness
    }
}

fn sample(file_name: &str) -> Session {
    let sample = samples::ALL.iter().find(|sample| sample.file_name == file_name).expect("a sample");
    session::parse(sample.json.as_bytes(), sample.file_name).expect("the sample is a session")
}

/// The samples that these panels are about, by their names.
fn ball_samples() -> impl Iterator<Item = (&'static str, Session)> {
    samples::ALL
        .iter()
        .map(|sample| (sample.file_name, self::sample(sample.file_name)))
        .filter(|(_, session)| matches!(session.target, Target::Ball { .. }))
}

fn selected(harness: &Harness<'static, Bench>) -> (usize, usize) {
    let selection = &harness.state().selection;
    (selection.station_idx, selection.capture_idx)
}

fn press(harness: &mut Harness<'static, Bench>, key: Key) {
    harness.key_press(key);
    harness.run_steps(3);
}

#[test]
fn a_click_on_a_stations_box_yields_exactly_that_command() {
    let mut harness = Bench::with(Shown::Compare, sample("clean-sweeps.json")).harness();
    let name = compare_words::use_station("2", method_name(Method::BallMaxArc));
    harness.get_by_label(&name).click();
    harness.run_steps(3);
    let expected = Command::SetStationEnabled { station_idx: 1, enabled: false };
    assert_eq!(harness.state().commands, [expected]);
}

#[test]
fn a_station_left_out_stays_listed_and_can_be_ticked_again() {
    let mut bench = Bench::with(Shown::Compare, sample("clean-sweeps.json"));
    bench.workbench.apply(Command::SetStationEnabled { station_idx: 2, enabled: false });
    bench.settle();
    let mut harness = bench.harness();
    let name = compare_words::use_station("3", method_name(Method::BallFixedPoint));
    harness.get_by_label(&name).click();
    harness.run_steps(3);
    let expected = Command::SetStationEnabled { station_idx: 2, enabled: true };
    assert_eq!(harness.state().commands, [expected]);
}

#[test]
fn a_method_without_a_result_says_why_in_the_errors_own_words() {
    let bench = Bench::with(Shown::Compare, sample("near-largest-arc.json"));
    let results = bench.workbench.results().expect("solved");
    let result = results.method(Method::BallMaxArc).expect("every method is tried");
    let sentence = result.outcome.as_ref().expect_err("there are no sweeps").to_string();
    bench.harness().get_by_label(&sentence);
}

#[test]
fn the_toggles_choose_the_cards() {
    let mut harness = Bench::with(Shown::Compare, sample("clean-sweeps.json")).harness();
    let card = compare_words::select_method(method_name(Method::BallBundle));
    assert!(harness.query_by_label(&card).is_none(), "two tables fit side by side here");
    harness.get_by_label(&compare_words::show_method(method_short_name(Method::BallBundle))).click();
    harness.run_steps(3);
    harness.get_by_label(&card).click();
    harness.run_steps(3);
    assert_eq!(harness.state().selection.method, Method::BallBundle);
    assert!(harness.state().commands.is_empty());
}

#[test]
fn every_view_of_the_comparison_draws_every_sample() {
    for (file_name, session) in ball_samples() {
        for width in [560.0, 1000.0, 1600.0] {
            let mut harness = Bench::with(Shown::Compare, session.clone()).harness_of_size([width, 800.0]);
            for toggle in [
                compare_words::WHY,
                compare_words::ABOUT_MEAN,
                compare_words::PAPER_LAYOUT,
                compare_words::MATRICES,
                compare_words::BARS_IN_SAMPLE,
            ] {
                if let Some(button) = harness.query_by_label(toggle) {
                    button.click();
                }
                harness.run_steps(2);
            }
            assert!(harness.state().commands.is_empty(), "{file_name}");
        }
    }
}

#[test]
fn results_of_an_earlier_revision_stay_and_are_marked() {
    let mut bench = Bench::with(Shown::Compare, sample("clean-sweeps.json"));
    bench.workbench.apply(Command::SetStationEnabled { station_idx: 0, enabled: false });
    let harness = bench.harness();
    harness.get_by_label(compare_words::OUT_OF_DATE);
    let row = compare_words::station_row("2", method_name(Method::BallMaxArc));
    harness.get_by_label(&row);
}

#[test]
fn arrow_keys_move_the_station_and_the_step() {
    let mut harness = Bench::with(Shown::Arcs, sample("clean-sweeps.json")).harness();
    press(&mut harness, Key::ArrowRight);
    press(&mut harness, Key::ArrowRight);
    press(&mut harness, Key::ArrowLeft);
    assert_eq!(selected(&harness), (0, 1));
    press(&mut harness, Key::ArrowDown);
    assert_eq!(selected(&harness), (1, 0), "another station begins at its first step");
    press(&mut harness, Key::ArrowUp);
    press(&mut harness, Key::ArrowUp);
    press(&mut harness, Key::ArrowLeft);
    assert_eq!(selected(&harness), (0, 0), "the ends hold");
}

#[test]
fn buttons_and_rows_select_stations_and_steps() {
    let mut harness = Bench::with(Shown::Arcs, sample("clean-sweeps.json")).harness();
    harness.get_by_label(arcs_words::NEXT_STEP).click();
    harness.run_steps(3);
    assert_eq!(selected(&harness), (0, 1));
    harness.get_by_label(&arcs_words::expand("3")).click();
    harness.run_steps(3);
    assert_eq!(selected(&harness), (0, 1), "looking at the steps selects nothing");
    harness.get_by_label(&arcs_words::step_name("3", 4)).click();
    harness.run_steps(3);
    assert_eq!(selected(&harness), (2, 3));
    harness.get_by_label(&arcs_words::profile_title("3", 4));
    assert!(harness.state().commands.is_empty());
}

#[test]
fn a_refused_profile_says_why_in_the_errors_own_words() {
    let mut session = sample("clean-sweeps.json");
    let profile = Profile::new(vec![0.0, 1.0, 2.0], &[Some(80.0), None, Some(80.5)]).expect("valid");
    session.stations[0].captures[0].reading = Reading::Profile(Arc::new(profile));
    let bench = Bench::with(Shown::Arcs, session);
    let results = bench.workbench.results().expect("solved");
    let Some(calibrate::Reading::Refused(refusal)) = results.measured.reading(0, 0) else {
        panic!("two points are no arc");
    };
    let sentence = refusal.to_string();
    bench.harness().get_by_label(&sentence);
}

#[test]
fn every_sample_has_its_arcs_or_says_what_to_do() {
    for (file_name, session) in ball_samples() {
        let is_reduced = matches!(session.stations[0].captures[0].reading, Reading::Point(_));
        let has_sweep = session.stations[0].captures.len() > 1;
        for width in [560.0, 1000.0] {
            let harness = Bench::with(Shown::Arcs, session.clone()).harness_of_size([width, 1200.0]);
            assert_eq!(
                harness.query_by_label(arcs_words::point_reading(&session.target)).is_some(),
                is_reduced,
                "{file_name}"
            );
            assert_eq!(harness.query_by_label(arcs_words::NO_SWEEP).is_some(), !has_sweep, "{file_name}");
        }
    }
}

#[test]
fn without_a_session_the_panels_say_what_to_do() {
    Bench::empty(Shown::Arcs).harness().get_by_label(arcs_words::NO_SESSION);
    Bench::empty(Shown::Compare).harness().get_by_label(compare_words::NO_SESSION);
    Bench::empty(Shown::Diagnosis).harness().get_by_label(panel_words::NO_SESSION);
}

#[test]
fn the_view_of_a_profile_is_toggled_and_changes_nothing_else() {
    let mut harness = Bench::with(Shown::Arcs, sample("dirty-profiles.json")).harness();
    for name in [arcs_words::WHOLE_PROFILE, arcs_words::ARC_ONLY] {
        harness.get_by_label(name).click();
        harness.run_steps(3);
        harness.get_by_label(name);
    }
    assert!(harness.state().commands.is_empty());
    assert_eq!(selected(&harness), (0, 0));
}

#[test]
fn the_verdict_names_its_method() {
    let harness = Bench::with(Shown::Compare, sample("clean-sweeps.json")).harness();
    harness.get_by_label(&compare_words::judged_method(method_short_name(Method::BallBundle), true));
    harness.get_by_label(&compare_words::headline("80"));
}

#[test]
fn without_a_stated_distance_the_verdict_says_where_its_point_is() {
    let session = sample("lin-mu-2019-table-1.json");
    assert!(session.sensor.reference_distance_mm.is_none());
    let harness = Bench::with(Shown::Compare, session).harness();
    harness.get_by_label_contains("a point amid the balls seen, z = ");
}

/// A simulated session of a plate or pin.
fn simulated(kind: PartKind) -> Session {
    simulate(&SimulationOptions { num_points: 240, ..SimulationOptions::of(SimulationTarget::Part(kind)) })
}

#[test]
fn sessions_of_plates_and_tips_say_nothing_of_balls() {
    for kind in [PartKind::Plate, PartKind::Pin] {
        for shown in [Shown::Arcs, Shown::Compare] {
            let harness = Bench::with(shown, simulated(kind)).harness();
            for word in ["ball", "Ball", "section", "sweep"] {
                assert_eq!(harness.query_all_by_label_contains(word).count(), 0, "{kind:?}: {word}");
            }
        }
    }
}

#[test]
fn arcs_shows_where_a_plates_edge_is_and_all_points_beside_it() {
    let mut harness = Bench::with(Shown::Arcs, simulated(PartKind::Plate)).harness();
    harness.get_by_label(arcs_words::IN_LASER_PLANE);
    harness.get_by_label_contains(" at x ");
    harness.get_by_label(&arcs_words::station_name("q4")).click();
    harness.run();
    assert_eq!(harness.state().selection.station_idx, 12);
    harness.get_by_label(&arcs_words::profile_title("q4", 1));
}

#[test]
fn compare_sets_the_plates_methods_against_each_other() {
    let harness = Bench::with(Shown::Compare, simulated(PartKind::Plate)).harness();
    harness.get_by_label(&compare_words::maximum_error(Method::PlateBundle));
    for method in Method::PLATE {
        harness.get_by_label(&compare_words::select_method(method_name(method)));
    }
    // Distances from the edges are relative to no station.
    assert_eq!(harness.query_all_by_label(compare_words::FROM_FIRST).count(), 0);
}

/// The window's own software renderer, so that pictures need no graphics driver and are the same on every machine.
#[derive(Default)]
struct Software(ui::software_renderer::SoftwareRenderer);

impl egui_kittest::TestRenderer for Software {
    fn handle_delta(&mut self, delta: &mut egui::TexturesDelta) {
        self.0.update_textures(delta);
    }

    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "the size of a small picture")]
    fn render(&mut self, ctx: &egui::Context, output: &egui::FullOutput) -> Result<image::RgbaImage, String> {
        let scale = output.pixels_per_point;
        let size = ctx.content_rect().size() * scale;
        let primitives = ctx.tessellate(output.shapes.clone(), scale);
        Ok(self.0.paint(&primitives, scale, [size.x.round() as u32, size.y.round() as u32]))
    }
}

fn pictured(shown: Shown, file_name: &str, size: [f32; 2]) -> Harness<'static, Bench> {
    let bench = Bench::with(shown, sample(file_name));
    let mut harness = Harness::builder()
        .with_size(size)
        .renderer(Software::default())
        .with_theme(egui::Theme::Light)
        .with_context_setup(ui::theme::install)
        .build_ui_state(Bench::ui, bench);
    harness.run_steps(6);
    harness
}

#[test]
fn the_whole_profile_looks_as_it_did() {
    let mut arcs = pictured(Shown::Arcs, "dirty-profiles.json", [800.0, 520.0]);
    arcs.get_by_label(arcs_words::WHOLE_PROFILE).click();
    for _ in 0..2 {
        arcs.key_press(Key::ArrowDown);
        arcs.run_steps(2);
    }
    arcs.run_steps(4);
    arcs.snapshot("arcs_whole_profile");
}

#[test]
fn the_narrow_comparison_looks_as_it_did() {
    pictured(Shown::Compare, "lin-mu-2019-table-1.json", [532.0, 420.0]).snapshot("compare_narrow");
}

fn finding(fault: Fault, severity: Severity, plot: Option<Plot>, remedy: Option<Remedy>) -> Finding {
    let residual_mm = plot.as_ref().map(|_| [1.29, 0.018]);
    Finding { fault, severity, explains: 72.0, evidence: Evidence { residual_mm, plot }, remedy }
}

/// A finding for every kind of plot, the most serious first.
fn one_finding_a_plot() -> Vec<Finding> {
    let stations = (0..8_u8).map(|idx| StationBar {
        station_idx: usize::from(idx),
        label: (idx + 1).to_string(),
        error_mm: if idx == 3 { 1.29 } else { 0.02 + 0.004 * f64::from(idx) },
        is_accused: idx == 3,
    });
    let reading = |rms_mm: f64, num_ties: usize, is_as_given: bool| ReadingFit {
        reading: PoseReading::default(),
        ties: vec![PoseReading::default(); num_ties],
        rms_mm,
        is_as_given,
    };
    let radius = |idx: i16| {
        let radius_mm = 15.0 + 0.05 * f64::from(idx);
        [radius_mm, (0.018_f64).hypot((radius_mm - 15.3) * 1.4)]
    };
    let shift = |idx: i16| [f64::from(idx), 0.05 * f64::from(idx) + 0.02 * f64::from(idx * 7 % 5) - 0.2];
    let step = |idx: i16| [0.5 * f64::from(idx), 0.5 * 1.05 * f64::from(idx)];
    vec![
        finding(
            Fault::WrongPose { station_idx: 3, off_mm: 1.29, typical_mm: 0.018 },
            Severity::Wrong,
            Some(Plot::Stations(stations.collect())),
            Some(Remedy::LeaveOut(vec![3])),
        ),
        finding(
            Fault::PosesMisread { reading: PoseReading::default() },
            Severity::Wrong,
            Some(Plot::Readings(vec![
                reading(0.018, 2, false),
                reading(0.91, 0, false),
                reading(1.29, 1, true),
                reading(14.0, 0, false),
                reading(44.0, 3, false),
            ])),
            Some(Remedy::ReadPosesAs(PoseReading::default())),
        ),
        finding(
            Fault::OneAxis { axis_in_flange: Vec3::new(0.05, -0.1, 0.99).normalize(), ratio: Some(24.0) },
            Severity::Wrong,
            Some(Plot::Direction {
                in_flange: Vec3::new(0.05, -0.1, 0.99).normalize(),
                rotations_deg: [0.4, 0.9, 21.0],
            }),
            None,
        ),
        finding(
            Fault::WrongRadius { found_mm: 15.304_2, std_mm: 0.003_1, given_mm: 15.0 },
            Severity::Doubtful,
            Some(Plot::Curve {
                axis: CurveAxis::RadiusMm,
                points: (-2..14).map(radius).collect(),
                given: 15.0,
                found: 15.304_2,
                std: 0.003_1,
            }),
            Some(Remedy::SetRadius(15.304_2)),
        ),
        finding(
            Fault::Drift { total_in_base_mm: Vec3::new(0.0, 0.0, 0.4), std_mm: 0.05 },
            Severity::Doubtful,
            Some(Plot::Trend { points: (1..=8).map(shift).collect(), line: [-0.17, 0.21] }),
            None,
        ),
        finding(
            Fault::StepDiffersFromPose { station_idx: 2, ratio: 1.05, difference_mm: 0.4 },
            Severity::Note,
            Some(Plot::Steps((0..21).map(step).collect())),
            None,
        ),
        finding(Fault::ResidualsNotNormal { p_value: 0.004 }, Severity::Note, None, None),
    ]
}

fn made_up(findings: Vec<Finding>) -> MadeUp {
    let influence = |idx: u8| Influence {
        station_idx: usize::from(idx),
        label: (idx + 1).to_string(),
        studentised_residual: 0.5 + 0.4 * f64::from(idx * 5 % 7),
        p_value: 0.3,
        moves_workspace_point_mm: 0.002 * f64::from(idx * 3 % 8),
    };
    let quantile = |idx: i8| {
        let quantile = 2.4 * f64::from(idx) / 60.0;
        [quantile, quantile + 0.02 * quantile.powi(3)]
    };
    let validation = Validation {
        influence: (0..8).map(influence).collect(),
        split_half: Some(SplitHalf {
            disagreements_mm: (1..=70).map(|idx| 0.001 * f64::from(idx).powf(0.8)).collect(),
            median_mm: 0.017,
            max_mm: 0.03,
            expected_mm: 0.019,
        }),
        normality: Some(Normality { p_value: 0.42, quantiles: (-60..=60).map(quantile).collect() }),
    };
    let planned = |idx: u8| PlannedStation {
        base_from_flange: Transform::from_parts(
            Vec3::new(1012.3 + f64::from(idx), -204.5, 456.7),
            nalgebra::UnitQuaternion::from_euler_angles(3.1, 0.1 * f64::from(idx), -1.2),
        ),
        edge: None,
        tilt_deg: 28.0,
        azimuth_deg: 40.0 * f64::from(idx),
        spin_deg: -90.0,
        workspace_point_std_mm: Some(0.014 - 0.001 * f64::from(idx)),
    };
    MadeUp {
        diagnosis: Diagnosis { findings, readings: Vec::new(), validation: Some(validation) },
        is_current: true,
        bootstrap: None,
        bootstrap_progress: None,
        plan: Ok(Plan { workspace_point_std_mm: Some(0.015), stations: (1..=4).map(planned).collect() }),
    }
}

fn diagnosing(made_up: MadeUp) -> Bench {
    Bench { made_up: Some(made_up), ..Bench::with(Shown::Diagnosis, sample("clean-sweeps.json")) }
}

fn finding_name(idx: usize) -> String {
    panel_words::finding_name(idx + 1, fault_words::fault_title(&one_finding_a_plot()[idx].fault))
}

#[test]
fn a_finding_is_mended_by_its_button_and_by_enter() {
    let remedy = Command::ApplyRemedy(Remedy::LeaveOut(vec![3]));
    let mut harness = diagnosing(made_up(one_finding_a_plot())).harness();
    let session = sample("clean-sweeps.json");
    harness.get_by_label(&fault_words::remedy_label(&Remedy::LeaveOut(vec![3]), &session)).click();
    harness.run_steps(3);
    assert_eq!(harness.state().commands.as_slice(), std::slice::from_ref(&remedy));
    let mut harness = diagnosing(made_up(one_finding_a_plot())).harness();
    press(&mut harness, Key::Enter);
    assert_eq!(harness.state().commands, [remedy]);
}

#[test]
fn arrow_keys_go_through_the_findings_and_each_shows_its_evidence() {
    let ball = Target::ball(15.0);
    let findings = one_finding_a_plot();
    for size in [[520.0, 640.0], [948.0, 792.0]] {
        let mut harness = diagnosing(made_up(one_finding_a_plot())).harness_of_size(size);
        for (idx, finding) in findings.iter().enumerate() {
            harness.get_by_label(&finding_name(idx));
            match &finding.evidence.plot {
                Some(plot) => harness.get_by_label(&fault_words::plot_title(plot, &ball)),
                None => harness.get_by_label(panel_words::stations_agree(&ball)),
            };
            press(&mut harness, Key::ArrowDown);
        }
        harness.get_by_label(panel_words::stations_agree(&ball));
        assert!(harness.state().commands.is_empty());
    }
}

#[test]
fn the_next_step_stands_in_the_band_of_the_comparison() {
    let session = sample("one-bad-pose.json");
    let mut harness = Bench::with(Shown::Compare, session.clone()).harness();
    harness.get_by_label(&fault_words::remedy_label(&Remedy::LeaveOut(vec![6]), &session)).click();
    harness.run_steps(3);
    assert_eq!(harness.state().commands, [Command::ApplyRemedy(Remedy::LeaveOut(vec![6]))]);
    harness.get_by_label(panel_words::SEE_DIAGNOSIS).click();
    harness.run_steps(3);
    assert_eq!(harness.state().actions, [Action::GoTo(Step::Diagnosis)]);
    let mut harness = Bench::with(Shown::Compare, sample("clean-sweeps.json")).harness();
    harness.get_by_label(panel_words::SEE_NEXT_POSES).click();
    harness.run_steps(3);
    assert_eq!(harness.state().actions, [Action::GoTo(Step::Diagnosis)]);
}

#[test]
fn where_nothing_was_found_the_panel_says_what_was_looked_at() {
    let ball = Target::ball(15.0);
    let harness = diagnosing(made_up(Vec::new())).harness();
    harness.get_by_label(fault_words::NOTHING_FOUND);
    harness.get_by_label(panel_words::stations_agree(&ball));
    for line in panel_words::checked(&ball) {
        harness.get_by_label(line);
    }
}

#[test]
fn a_diagnosis_of_an_earlier_revision_stays_but_mends_nothing() {
    let out_of_date = MadeUp { is_current: false, ..made_up(one_finding_a_plot()) };
    let mut harness = diagnosing(out_of_date).harness();
    harness.get_by_label(&finding_name(0));
    assert!(harness.query_all_by_label(panel_words::OUT_OF_DATE).count() >= 1, "the findings are marked");
    harness.get_by_label(panel_words::NO_PLAN_YET);
    let label = fault_words::remedy_label(&Remedy::LeaveOut(vec![3]), &sample("clean-sweeps.json"));
    harness.get_by_label(&label).click();
    press(&mut harness, Key::Enter);
    assert!(harness.state().commands.is_empty());
}

#[test]
fn the_bootstrap_is_started_by_its_button_and_stopped_by_escape() {
    let mut harness = diagnosing(made_up(Vec::new())).harness();
    harness.get_by_label(&panel_words::bootstrap_button(500)).click();
    harness.run_steps(3);
    assert_eq!(harness.state().commands, [Command::StartBootstrap { num_draws: 500 }]);
    let progress = Some(Progress { done: 312, total: 500 });
    let mut harness = diagnosing(MadeUp { bootstrap_progress: progress, ..made_up(Vec::new()) }).harness();
    harness.get_by_label(&panel_words::bootstrap_progress(312, 500));
    press(&mut harness, Key::Escape);
    harness.get_by_label(panel_words::CANCEL_BOOTSTRAP).click();
    harness.run_steps(3);
    assert_eq!(harness.state().commands, [Command::CancelBootstrap, Command::CancelBootstrap]);
}

#[test]
fn other_conventions_are_tried_on_request() {
    let mut harness = diagnosing(made_up(Vec::new())).harness();
    harness.get_by_label(panel_words::TRY_READINGS).click();
    harness.run_steps(3);
    assert_eq!(harness.state().commands, [Command::RankReadings]);
    harness.get_by_label(panel_words::READINGS);
}

#[test]
fn the_limits_of_the_plan_are_edited_in_place() {
    let mut harness = diagnosing(made_up(Vec::new())).harness();
    harness.get_by_label(panel_words::STANDOFF).click();
    harness.run_steps(3);
    let Some(Command::SetPlanLimits(limits)) = harness.state().commands.first() else { panic!("a new limit") };
    let [low, high] = limits.standoff_mm.expect("ticked");
    // The sample's balls are about 80 mm away.
    assert!(40.0 < low && low < high && high < 120.0, "{low} {high}");
}

#[test]
fn every_sample_can_be_diagnosed_at_every_width() {
    for (file_name, session) in ball_samples() {
        for width in [532.0, 948.0, 1600.0] {
            let harness = Bench::with(Shown::Diagnosis, session.clone()).harness_of_size([width, 792.0]);
            harness.get_by_label(panel_words::FINDINGS);
            harness.get_by_label(panel_words::NEXT_POSES);
            assert!(harness.state().commands.is_empty(), "{file_name}");
        }
    }
}

#[test]
fn the_diagnosis_looks_as_it_did() {
    let mut harness = Harness::builder()
        .with_size([964.0, 808.0])
        .renderer(Software::default())
        .with_theme(egui::Theme::Light)
        .with_context_setup(ui::theme::install)
        .build_ui_state(Bench::ui, diagnosing(made_up(one_finding_a_plot()[..1].to_vec())));
    harness.run_steps(6);
    harness.snapshot("diagnosis_stations");
}
