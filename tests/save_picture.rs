//! Pictures of plots, taken from the whole window as a user takes them.
#![expect(clippy::expect_used, reason = "helpers of tests may fail as tests do")]

mod step_window;

use egui::accesskit::Role;
use egui::{Event, Key, Modifiers, PointerButton, Pos2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use handeye::scene::PartKind;
use handeye::session::{self, Session, samples};
use handeye::simulate::{SimulationOptions, SimulationTarget, simulate};
use handeye::text::{compare as compare_words, report_panel as words, shell as shell_words, verify as verify_words};
use handeye::ui::{Step, Window};
use step_window::{click, settle, window_at};

const SIZE: [f32; 2] = [1440.0, 900.0];

fn sample(name: &str) -> Session {
    let sample = samples::ALL.iter().find(|sample| sample.file_name == name).expect("a sample");
    session::parse(sample.json.as_bytes(), name).expect("a session")
}

/// Takes the picture of a plot by the File menu, into a file.
fn save(harness: &mut Harness<'static, Window>, plot: &str, entry: &str, path: &std::path::Path) {
    for name in [shell_words::FILE, words::PICTURES, plot, entry] {
        harness.get_by_role_and_label(Role::Button, name).click();
        harness.run_steps(3);
    }
    settle(harness);
    harness.get_by_label(shell_words::FILE_PATH).focus();
    harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
    harness.get_by_label(shell_words::FILE_PATH).type_text(&path.display().to_string());
    harness.run_steps(2);
    harness.key_press(Key::Enter);
    settle(harness);
}

fn choose_theme(harness: &mut Harness<'static, Window>, name: &str) {
    harness.get_by_label(shell_words::VIEW).click();
    harness.run_steps(3);
    harness.get_by_label(name).click();
    harness.run_steps(3);
    harness.key_press(Key::Escape);
    settle(harness);
}

/// The names of elements in order, if every one is closed where it belongs.
fn elements(svg: &str) -> Result<Vec<String>, String> {
    let mut open = Vec::new();
    let mut all = Vec::new();
    for piece in svg.split('<').skip(1) {
        let (tag, text) = piece.split_once('>').ok_or_else(|| format!("unfinished tag {piece}"))?;
        if tag.matches('"').count() % 2 == 1 {
            return Err(format!("unfinished attribute in {tag}"));
        }
        for entity in text.split('&').skip(1).chain(tag.split('&').skip(1)) {
            if !["amp;", "lt;", "gt;", "quot;"].iter().any(|known| entity.starts_with(known)) {
                return Err(format!("a bare & before {entity}"));
            }
        }
        let name = tag.split([' ', '/']).find(|part| !part.is_empty()).unwrap_or_default().to_owned();
        if tag.starts_with('?') {
            continue;
        }
        if tag.starts_with('/') {
            let expected = open.pop();
            if expected.as_ref() != Some(&name) {
                return Err(format!("found the end of {name}, expected that of {expected:?}"));
            }
        } else {
            all.push(name.clone());
            if !tag.ends_with('/') {
                open.push(name);
            }
        }
    }
    if open.is_empty() { Ok(all) } else { Err(format!("never closed: {open:?}")) }
}

fn target() -> session::Target {
    sample("clean-sweeps.json").target
}

#[test]
fn a_plot_becomes_lines_and_letters() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("bars.svg");
    let mut harness = window_at(Step::Compare, sample("clean-sweeps.json"), SIZE);
    save(&mut harness, compare_words::error_per_station(&target()), words::SAVE_SVG, &path);
    let svg = std::fs::read_to_string(&path).expect("written");
    let elements = elements(&svg).expect("well-formed");
    assert!(elements.iter().filter(|name| *name == "rect").count() > 16, "a bar a station and method");
    for text in [compare_words::STATION_AXIS, compare_words::ERROR_AXIS, compare_words::error_per_station(&target())] {
        assert!(svg.contains(&format!(">{text}</text>")), "{text}");
    }
    assert!(harness.query_by_label(&words::wrote(&path.display().to_string())).is_some());
}

#[test]
fn a_plot_becomes_dots_on_white_in_both_themes() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut files = Vec::new();
    for (theme, name) in [(shell_words::LIGHT, "light.png"), (shell_words::DARK, "dark.png")] {
        let path = folder.path().join(name);
        let mut harness = window_at(Step::Compare, sample("clean-sweeps.json"), SIZE);
        choose_theme(&mut harness, theme);
        save(&mut harness, compare_words::scatter_title(&target()), words::SAVE_PNG, &path);
        files.push(image::open(&path).expect("a picture").to_rgba8());
    }
    let [light, dark] = files.as_slice() else { panic!("two pictures") };
    assert_eq!(light.get_pixel(0, 0).0, [255; 4]);
    assert!(light.width() > 800 && light.height() > 400, "twice as fine as the screen");
    let num_inked = light.pixels().filter(|pixel| pixel.0 != [255; 4]).count();
    assert!(num_inked > 5000, "{num_inked}");
    // Print has no dark theme.
    assert!(light == dark, "the theme does not show");
}

#[test]
fn a_right_click_offers_a_picture_for_the_clipboard() {
    let mut harness = window_at(Step::Compare, sample("clean-sweeps.json"), SIZE);
    let card = harness.get_by_label(compare_words::scatter_title(&target())).rect();
    let at: Pos2 = card.left_bottom() + egui::vec2(160.0, 120.0);
    harness.event(Event::PointerMoved(at));
    harness.run_steps(2);
    for pressed in [true, false] {
        let button = PointerButton::Secondary;
        harness.event(Event::PointerButton { pos: at, button, pressed, modifiers: Modifiers::NONE });
    }
    harness.run_steps(3);
    harness.get_by_label(words::COPY_PICTURE).click();
    let mut image = None;
    let start = std::time::Instant::now();
    while image.is_none() {
        assert!(start.elapsed() < std::time::Duration::from_mins(2), "the picture is drawn");
        harness.step();
        image = harness.output().platform_output.commands.iter().find_map(|command| match command {
            egui::OutputCommand::CopyImage(image) => Some(image.clone()),
            _ => None,
        });
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
    let image = image.expect("found just now");
    assert!(image.pixels.iter().any(|pixel| *pixel != egui::Color32::WHITE));
    harness.run_steps(2);
    assert!(harness.query_by_label(words::COPIED_PICTURE).is_some());
}

#[test]
fn what_the_window_shows_does_not_change_while_a_picture_is_taken() {
    let mut harness = window_at(Step::Compare, sample("clean-sweeps.json"), SIZE);
    choose_theme(&mut harness, shell_words::DARK);
    for name in [shell_words::FILE, words::PICTURES, compare_words::scatter_title(&target())] {
        harness.get_by_role_and_label(Role::Button, name).click();
        harness.run_steps(3);
    }
    // Dark letters: those of the light theme, and the one on the accent that stands in the window anyway.
    let num_dark = |harness: &Harness<'static, Window>| {
        let is_dark = |shape: &egui::Shape| matches!(shape, egui::Shape::Text(text) if text.fallback_color.r() < 60);
        harness.output().shapes.iter().filter(|clipped| is_dark(&clipped.shape)).count()
    };
    let before = num_dark(&harness);
    harness.get_by_label(words::SAVE_SVG).click();
    for _ in 0..6 {
        harness.step();
        assert!(num_dark(&harness) <= before, "no letter of the light theme");
    }
}

#[test]
fn a_cloud_of_points_is_a_picture_too() {
    let folder = tempfile::tempdir().expect("a folder");
    let (svg, png) = (folder.path().join("cloud.svg"), folder.path().join("cloud.png"));
    let usual = SimulationOptions::of(SimulationTarget::Part(PartKind::Square));
    let num_steps = SimulationOptions::steps_to_scan(PartKind::Square, 2.0);
    let session = simulate(&SimulationOptions { num_steps, step_mm: 2.0, num_points: 160, ..usual });
    let mut harness = window_at(Step::Verify, session, SIZE);
    click(&mut harness, verify_words::WORKPIECE);
    let plot = {
        let scan = step_window::workbench(&harness).scans().examined().expect("examined");
        handeye::text::workpiece::picture_title(&scan.name, scan.cloud.len(), scan.num_profiles)
    };
    save(&mut harness, &plot, words::SAVE_SVG, &svg);
    let text = std::fs::read_to_string(&svg).expect("written");
    assert!(elements(&text).expect("well-formed").contains(&"image".to_owned()));
    save(&mut harness, &plot, words::SAVE_PNG, &png);
    let image = image::open(&png).expect("a picture").to_rgba8();
    let num_inked = image.pixels().filter(|pixel| pixel.0 != [255; 4]).count();
    assert!(num_inked > 20_000, "{num_inked}");
}
