//! The Verify step, driven by the names that screen readers see, in the whole window.

mod step_window;

use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use handeye::app::Command;
use handeye::scene::PartKind;
use handeye::session::{self, Session};
use handeye::simulate::{SimulationOptions, SimulationTarget, simulate};
use handeye::text::verify as words;
use handeye::ui::Window;
use handeye::verify::Origin;
use step_window::{apply, click, window_on, workbench};

fn simulated(target: SimulationTarget, further: Vec<SimulationTarget>, seed: u64) -> Session {
    simulate(&SimulationOptions { seed, has_points: true, further, ..SimulationOptions::of(target) })
}

const PLATE: SimulationTarget = SimulationTarget::Part(PartKind::Plate);
const TIP: SimulationTarget = SimulationTarget::Part(PartKind::Pin);

fn type_into(harness: &mut Harness<'static, Window>, name: &str, text: &str) {
    let field = harness.get_by_label(name);
    field.focus();
    field.type_text(text);
    harness.run_steps(2);
}

#[test]
fn a_plate_shows_its_distances_at_once() {
    let mut harness = window_on(simulated(PLATE, Vec::new(), 1));
    // Both methods, one of them in the picture.
    assert!(harness.query_by_label(&words::show_calibration("Orthogonal edges, published")).is_some());
    assert!(harness.query_by_label(&words::space_name("Bundle of both edges")).is_some());
    click(&mut harness, &words::show_calibration("Orthogonal edges, published"));
    assert!(harness.query_by_label(&words::space_name("Orthogonal edges, published")).is_some());
    // What is shown is what was computed.
    let found = workbench(&harness).verification().last().expect("verified").value.clone();
    let mean_mm = found.targets[0].rows[0].as_ref().expect("a plate").figures.mean_mm;
    assert!(harness.query_all_by_label(&format!("{mean_mm:.3}")).next().is_some());
}

#[test]
fn a_calibration_is_hidden_in_charts_and_shown_again() {
    let mut harness = window_on(simulated(PLATE, vec![TIP], 1));
    click(&mut harness, words::CROSS_TARGET);
    let names: Vec<String> = {
        let found = &workbench(&harness).verification().last().expect("verified").value;
        found.calibrations.iter().map(|known| words::calibration_name(&known.origin, found)).collect()
    };
    let [first, others @ ..] = names.as_slice() else { panic!("calibrations") };
    for name in others {
        click(&mut harness, &words::show_in_charts(name));
    }
    assert!(harness.query_by_label(words::ALL_HIDDEN).is_none());
    click(&mut harness, &words::show_in_charts(first));
    assert!(harness.query_by_label(words::ALL_HIDDEN).is_some());
    click(&mut harness, &words::show_in_charts(first));
    assert!(harness.query_by_label(words::ALL_HIDDEN).is_none());
}

#[test]
fn without_a_plate_the_section_says_what_to_do() {
    let mut harness = window_on(simulated(TIP, Vec::new(), 1));
    click(&mut harness, words::DISTANCES);
    assert!(harness.query_by_label(words::NO_PLATE).is_some());
    assert!(harness.query_by_label(words::ADD_TARGET).is_some());
}

#[test]
fn another_target_is_added_renamed_and_removed_and_all_can_be_undone() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("tip.json");
    session::save(&simulated(TIP, Vec::new(), 2), &path).expect("written");
    let mut harness = window_on(simulated(PLATE, Vec::new(), 1));
    click(&mut harness, words::CROSS_TARGET);
    assert!(harness.query_by_label(words::ONLY_OWN).is_some());
    apply(&mut harness, Command::AddFurther(path));
    let further = |harness: &Harness<'static, Window>| {
        let session = &workbench(harness).document().expect("open").session;
        session.further.iter().map(|further| further.name.clone()).collect::<Vec<_>>()
    };
    let [name] = further(&harness).try_into().expect("one further target");
    assert!(harness.query_by_label(words::ONLY_OWN).is_none());
    assert!(harness.query_by_label(&words::show_target(&name)).is_some());
    assert!(harness.query_by_label(&words::show_calibration("All targets together")).is_some());
    click(&mut harness, &words::show_target(&name));
    click(&mut harness, words::REMOVE);
    assert!(further(&harness).is_empty());
    apply(&mut harness, Command::Undo);
    assert_eq!(further(&harness), [name]);
    apply(&mut harness, Command::Undo);
    assert!(further(&harness).is_empty());
}

#[test]
fn the_touched_point_is_typed_and_kept_in_the_session() {
    let mut session = simulated(TIP, Vec::new(), 3);
    session.known.point_in_base_mm = None;
    let mut harness = window_on(session);
    assert!(harness.query_by_label(words::FROM_MEAN).is_some());
    for (axis, text) in [("x", "410.5"), ("y", "-20"), ("z", "95.25")] {
        type_into(&mut harness, &words::touched_axis(axis), text);
    }
    click(&mut harness, words::SET_TOUCHED);
    let known = |harness: &Harness<'static, Window>| workbench(harness).document().expect("open").session.known;
    let point = known(&harness).point_in_base_mm.expect("typed");
    assert!((point - nalgebra::Vector3::new(410.5, -20.0, 95.25)).norm() < 1e-12, "{point}");
    assert!(harness.query_by_label(words::FROM_TOUCHED).is_some());
    click(&mut harness, words::CLEAR_TOUCHED);
    assert_eq!(known(&harness).point_in_base_mm, None);
}

#[test]
fn a_pasted_matrix_is_checked_and_judged_along() {
    let mut harness = window_on(simulated(PLATE, vec![TIP], 4));
    click(&mut harness, words::STABILITY);
    // Below what fits into the window: the field is found by its name all the same.
    type_into(
        &mut harness,
        words::PASTED_FIELD,
        "0.998 -0.021 -0.056 -7.806 0.001 -9.441 -0.331 123.89 0.006 0.331 0.942 -79.4",
    );
    assert!(harness.query_by_label("Not a rotation").is_some());
    type_into(&mut harness, words::GIVEN_NAME_FIELD, "Chen");
    click(&mut harness, words::GIVE);
    let is_chen = |origin: &Origin| matches!(origin, Origin::Given { name, is_nearest: true } if name == "Chen");
    let found = &workbench(&harness).verification().last().expect("verified").value;
    assert!(found.calibrations.iter().any(|calibration| is_chen(&calibration.origin)));
    assert!(harness.query_all_by_label_contains("Chen (nearest rotation)").next().is_some());
    click(&mut harness, &words::withdraw("Chen"));
    let found = &workbench(&harness).verification().last().expect("verified").value;
    assert!(!found.calibrations.iter().any(|calibration| is_chen(&calibration.origin)));
}

#[test]
fn every_section_fits_every_size() {
    for size in [[1024.0, 700.0], [1440.0, 900.0], [1900.0, 1100.0]] {
        let mut harness = window_on(simulated(PLATE, vec![TIP], 5));
        harness.set_size(size.into());
        for section in [words::DISTANCES, words::STABILITY, words::CROSS_TARGET, words::WORKPIECE] {
            click(&mut harness, section);
            let tab = harness.get_all_by_label(words::WORKPIECE).next().expect("a tab").rect();
            assert!(tab.max.x <= size[0], "{section} at {size:?}: {tab:?}");
        }
    }
}
