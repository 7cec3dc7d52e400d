//! Every step of the window says of a plate, a tip and a workpiece what is theirs: nothing of balls, radii or arcs.

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
    let card = start_words::open_sample(start_words::sample_lesson(file_name).0);
    harness.get_by_label(&card).scroll_to_me();
    settle(&mut harness);
    harness.get_by_label(&card).click();
    settle(&mut harness);
    assert!(harness.state().shell().workbench().document().is_some(), "{file_name} is open");
    harness
}

/// All that is to be read without pointing at anything.
fn words_seen(harness: &Harness<'static, Window>) -> BTreeSet<String> {
    harness
        .root()
        .children_recursive()
        .flat_map(|node| {
            let node = node.accesskit_node();
            [node.label(), node.value()].into_iter().flatten()
        })
        .collect()
}

/// Whether a text speaks of a ball's things.
fn speaks_of_balls(text: &str) -> bool {
    let mut words = text.split(|letter: char| !letter.is_alphanumeric()).filter(|word| *word != Step::Arcs.name());
    let of_balls = ["ball", "balls", "radius", "radii", "arc", "arcs", "sweep", "sweeps"];
    words.any(|word| of_balls.contains(&word.to_lowercase().as_str()))
}

/// What is offered whatever the session's target is: the samples, other targets, new sessions.
fn is_an_offer(text: &str) -> bool {
    let lessons = samples::ALL.iter().map(|sample| start_words::sample_lesson(sample.file_name));
    let of_samples = lessons.flat_map(|(name, lesson)| {
        [name.to_owned(), lesson.to_owned(), start_words::open_sample(name), format!("{name}\n{lesson}")]
    });
    let offers = [
        start_words::LEAD.to_owned(),
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
        // What Capture offers depends on its routine, which may be that of another target.
        for step in Step::ALL.into_iter().filter(|step| *step != Step::Capture) {
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
