//! The Verify step, driven by the names that screen readers see, in the whole window.
#![expect(clippy::expect_used, reason = "a test that finds nothing to check must fail")]

mod step_window;

use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use handeye::app::Command;
use handeye::report::result_history::{read_history, said};
use handeye::scene::PartKind;
use handeye::session::{self, Session};
use handeye::simulate::{SimulationOptions, SimulationTarget, simulate};
use handeye::text::{compare_results as result_words, verify as words};
use handeye::ui::Window;
use handeye::verify::Origin;
use handeye::watch::Unwatched;
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

/// A folder with the results of a sensor that drifts along x, week by week.
fn folder_of_results(num_weeks: u32) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    for week in 0..num_weeks {
        // A fixed pattern of noise, so that neighbouring weeks differ by more than the drift now and then.
        let noise = 0.004 * f64::from(week * 7 % 5) - 0.008;
        let x_mm = 12.0 + 0.01 * f64::from(week) + noise;
        let covariance: Vec<Vec<f64>> =
            (0..6).map(|row| (0..6).map(|column| if row == column { 1e-6 } else { 0.0 }).collect()).collect();
        let file = serde_json::json!({
            "format": "handeye-result", "version": 1, "answer": "ball-bundle",
            "methods": [{
                "method": "ball-bundle", "status": "ok",
                "flange_from_sensor": {
                    "matrix": [[1, 0, 0, x_mm], [0, 1, 0, noise], [0, 0, 1, 130.0 - noise], [0, 0, 0, 1]]
                },
                "uncertainty": { "covariance": covariance, "reference_point_in_sensor_mm": [0.0, 0.0, 60.0] },
            }],
        });
        let name = format!("cell_2026-{:02}-{:02}.json", 1 + week / 4, 1 + 7 * (week % 4));
        std::fs::write(folder.path().join(name), file.to_string()).expect("written");
    }
    std::fs::write(folder.path().join("broken.json"), "{").expect("written");
    folder
}

#[test]
fn a_folder_of_results_shows_its_drift_in_the_words_of_the_command() {
    let folder = folder_of_results(14);
    let mut harness = window_on(simulated(TIP, Vec::new(), 1));
    click(&mut harness, result_words::HISTORY);
    assert!(harness.query_by_label(result_words::NOTHING_READ).is_some());
    type_into(&mut harness, result_words::FOLDER_FIELD, &folder.path().to_string_lossy());
    click(&mut harness, result_words::READ_FOLDER);
    let history = read_history(folder.path(), &mut Unwatched).expect("results");
    assert!(harness.query_by_label(&said::verdict(&history)).is_some());
    // The table, and what is said of trends and of the file that is none.
    assert!(harness.query_all_by_label(&said::history_rows(&history)[3][1]).next().is_some());
    let sentences = said::history_sentences(&history);
    assert!(sentences.iter().any(|sentence| sentence.text.contains("broken.json")));
    for sentence in sentences {
        assert!(harness.query_by_label(&sentence.text).is_some(), "{}", sentence.text);
    }
    type_into(&mut harness, result_words::FOLDER_FIELD, "/missing");
    click(&mut harness, result_words::READ_FOLDER);
    assert!(harness.query_all_by_label_contains("/missing: ").next().is_some());
}

#[test]
fn two_results_and_the_open_session_against_one_are_compared() {
    let folder = folder_of_results(14);
    let file = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
    let mut harness = window_on(simulated(TIP, Vec::new(), 1));
    click(&mut harness, result_words::COMPARE);
    assert!(harness.query_by_label(result_words::NOTHING_COMPARED).is_some());
    // The later side is the open session unless a file is chosen.
    type_into(&mut harness, result_words::SIDE_FIELDS[0], &file("cell_2026-01-01.json"));
    click(&mut harness, result_words::COMPARE_BUTTON);
    let found = |harness: &Harness<'static, Window>| {
        let compared = workbench(harness).comparison().last().expect("compared").value.clone();
        compared.outcome.expect("both are calibrations")
    };
    assert!(found(&harness).to.name.ends_with("fixed-point"), "{}", found(&harness).to.name);
    click(&mut harness, result_words::SIDE_SESSIONS[1]);
    type_into(&mut harness, result_words::SIDE_FIELDS[1], &file("cell_2026-04-08.json"));
    type_into(&mut harness, result_words::POINTS_FIELD, "0,0,80");
    click(&mut harness, result_words::COMPARE_BUTTON);
    let comparison = found(&harness);
    assert!((comparison.difference.translation_mm.x - 0.13).abs() < 0.03, "{comparison:?}");
    assert_eq!(comparison.points.given.len(), 1);
    // In the words of the command.
    let known = comparison.difference.known;
    let whole = result_words::significance(comparison.difference.p_value, known);
    assert!(harness.query_by_label(&result_words::verdict_on(result_words::AS_A_WHOLE, &whole)).is_some(), "{whole}");
    apply(&mut harness, Command::CancelComparison);
}
