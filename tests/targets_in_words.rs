//! Every step of the window says of a plate, a tip and a workpiece what is theirs: nothing of balls, radii or arcs.
#![expect(clippy::expect_used, reason = "helpers of tests may fail as tests do")]

use std::collections::BTreeSet;

use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use handeye::session::samples;
use handeye::text::start as start_words;
use handeye::ui::{Start, Step, Window};

const SIZE: [f32; 2] = [1440.0, 900.0];

fn settle(harness: &mut Harness<'static, Window>) {
    loop {
        harness.step();
        if !harness.state().shell().is_busy() {
            break;
        }
        std::thread::yield_now();
    }
    harness.run_steps(3);
}

fn window_with(file_name: &str) -> Harness<'static, Window> {
    let mut harness = Harness::builder()
        .with_size(SIZE)
        .with_os(egui::os::OperatingSystem::Nix)
        .build_eframe(|creation| Window::new(creation, Start::default()));
    settle(&mut harness);
    harness.get_by_label(&start_words::open_sample(start_words::sample_lesson(file_name).0)).click();
    settle(&mut harness);
    harness
}

/// All that a screen reader would read out.
fn words_seen(harness: &Harness<'static, Window>) -> BTreeSet<String> {
    harness
        .root()
        .children_recursive()
        .flat_map(|node| {
            let node = node.accesskit_node();
            [node.label(), node.value(), node.description()].into_iter().flatten()
        })
        .collect()
}

/// Whether a text speaks of a ball's things.
fn speaks_of_balls(text: &str) -> bool {
    let lower_case = text.to_lowercase();
    let mut words = lower_case.split(|letter: char| !letter.is_alphanumeric());
    words.any(|word| matches!(word, "ball" | "balls" | "radius" | "radii" | "arc" | "arcs" | "sweep" | "sweeps"))
}

/// What is offered whatever the session's target is: the samples, other targets, new sessions, and the step's name.
fn is_an_offer(text: &str) -> bool {
    let lessons = samples::ALL.iter().map(|sample| start_words::sample_lesson(sample.file_name));
    let of_samples = lessons.flat_map(|(name, lesson)| {
        [name.to_owned(), lesson.to_owned(), start_words::open_sample(name), format!("{name}\n{lesson}")]
    });
    let offers = [
        Step::Arcs.name().to_owned(),
        start_words::BALL.to_owned(),
        start_words::OTHER_BALL.to_owned(),
        start_words::OTHER_BALL_NAME.to_owned(),
        start_words::preset(start_words::BALL, true, 15.0),
    ];
    of_samples.chain(offers).any(|offer| offer == text)
}

#[test]
fn nothing_speaks_of_a_ball_where_there_is_none() {
    let mut wrong = BTreeSet::new();
    for file_name in ["plate.json", "tip.json", "workpiece.json"] {
        let mut harness = window_with(file_name);
        for step in Step::ALL {
            harness.get_by_label(step.name()).click();
            settle(&mut harness);
            assert_eq!(harness.state().shell().step(), step);
            let seen = words_seen(&harness);
            let of_balls = seen.into_iter().filter(|text| speaks_of_balls(text) && !is_an_offer(text));
            wrong.extend(of_balls.map(|text| format!("{file_name}, {}: {text}", step.name())));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}
