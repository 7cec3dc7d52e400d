//! The figures of a report: every sample's, and those of data that hold little or nothing.
#![expect(clippy::expect_used, reason = "a test that finds nothing to check must fail")]

use std::collections::BTreeSet;
use std::sync::LazyLock;

use handeye::geometry::{Transform, Vec3};
use handeye::report::evidence::Evidence;
use handeye::report::figure::ink::{Align, Area, Ink, Label};
use handeye::report::figure::palette::Rgb;
use handeye::report::figure::typeface::{Weight, has_all};
use handeye::report::figure::{Figure, figures_of};
use handeye::session::samples::ALL;
use handeye::session::{self, Reading, Session, Target};
use handeye::simulate::{SimulationOptions, simulate};
use handeye::watch::Unwatched;

fn figures(session: &Session) -> Vec<Figure> {
    figures_of(
        &Evidence::gather(
            session,
            &session::measure(session, None, &mut Unwatched).expect("not cancelled"),
            &[],
            &mut Unwatched,
        )
        .expect("not cancelled"),
    )
}

fn sample(file_name: &str) -> Session {
    let sample = ALL.iter().find(|sample| sample.file_name == file_name).expect("a sample");
    session::parse(sample.json.as_bytes(), sample.file_name).expect("a session")
}

/// A sample's file with its figures and their SVG documents.
type Drawn = (&'static str, Vec<(Figure, String)>);

/// Every sample, drawn once for all tests.
static SAMPLES: LazyLock<Vec<Drawn>> = LazyLock::new(|| {
    let of_sample = |file_name: &'static str| {
        let drawn = figures(&sample(file_name)).into_iter().map(|figure| {
            let svg = figure.svg().expect("drawn");
            (figure, svg)
        });
        (file_name, drawn.collect())
    };
    ALL.iter().map(|sample| of_sample(sample.file_name)).collect()
});

fn all() -> impl Iterator<Item = (String, &'static Figure, &'static str)> {
    SAMPLES.iter().flat_map(|(file_name, figures)| {
        figures.iter().map(move |(figure, svg)| (format!("{file_name}: {}", figure.id), figure, svg.as_str()))
    })
}

fn ids(session: &Session) -> Vec<String> {
    figures(session).into_iter().map(|figure| figure.id).collect()
}

/// An element of an SVG document: its name, its attributes, and the text in it.
#[derive(Debug)]
struct Element {
    name: String,
    attributes: Vec<(String, String)>,
    text: String,
}

impl Element {
    fn get(&self, name: &str) -> Option<&str> {
        self.attributes.iter().find(|(key, _)| key == name).map(|(_, value)| value.as_str())
    }

    fn number(&self, name: &str) -> f64 {
        self.get(name).and_then(|value| value.parse().ok()).unwrap_or_else(|| panic!("{name} of {self:?}"))
    }
}

fn unescaped(text: &str) -> String {
    let mut plain = text.to_owned();
    for (escaped, letter) in [("&lt;", "<"), ("&gt;", ">"), ("&quot;", "\""), ("&apos;", "'"), ("&amp;", "&")] {
        plain = plain.replace(escaped, letter);
    }
    plain
}

/// Reads a document as strictly as XML asks for: tags that match, attributes in quotes and but once, nothing bare.
fn elements(svg: &str) -> Vec<Element> {
    let is_bare = |text: &str| {
        let entities = ["&lt;", "&gt;", "&quot;", "&apos;", "&amp;"];
        let rest = entities.iter().fold(text.to_owned(), |text, entity| text.replace(entity, ""));
        rest.contains(['&', '<'])
    };
    let (mut found, mut open): (Vec<Element>, Vec<usize>) = (Vec::new(), Vec::new());
    let mut rest = svg;
    while let Some(start) = rest.find('<') {
        let text = &rest[..start];
        assert!(!is_bare(text) && !text.contains('>'), "bare letters in {text:?}");
        match open.last() {
            Some(idx) => found[*idx].text.push_str(&unescaped(text)),
            None => assert!(text.trim().is_empty(), "{text:?} outside of the document"),
        }
        let end = start + rest[start..].find('>').expect("a tag that ends");
        let tag = &rest[start + 1..end];
        rest = &rest[end + 1..];
        if let Some(name) = tag.strip_prefix('/') {
            let idx = open.pop().expect("an open element");
            assert_eq!(found[idx].name, name, "tags match");
            continue;
        }
        let is_closed = tag.ends_with('/');
        let mut parts = tag.trim_end_matches('/').trim();
        let name = parts.split_whitespace().next().expect("a name").to_owned();
        parts = parts[name.len()..].trim_start();
        let mut attributes: Vec<(String, String)> = Vec::new();
        while !parts.is_empty() {
            let (key, after) = parts.split_once("=\"").expect("an attribute in quotes");
            let (value, after) = after.split_once('"').expect("a quote that ends");
            assert!(!is_bare(value), "bare letters in {value:?}");
            assert!(attributes.iter().all(|(other, _)| other != key), "{key} stands twice");
            attributes.push((key.to_owned(), unescaped(value)));
            parts = after.trim_start();
        }
        found.push(Element { name, attributes, text: String::new() });
        if !is_closed {
            open.push(found.len() - 1);
        }
    }
    assert!(open.is_empty() && rest.trim().is_empty(), "the document ends with its last tag");
    found
}

/// Half the x height of Inter: what `0.5ex` is.
const HALF_X_HEIGHT: f64 = 0.273;

/// The texts of a document with the room that they take, in its own units.
fn texts(elements: &[Element]) -> Vec<(String, Area)> {
    let of = |element: &Element| {
        let (x, y, size) = (element.number("x"), element.number("y"), element.number("font-size"));
        assert_eq!(element.get("dy"), Some("-0.5ex"));
        let turn = element.get("transform");
        assert!(turn.is_none_or(|turn| turn == format!("rotate(270, {x}, {y})")), "{element:?}");
        let is_upright = turn.is_some();
        // Turned, what hangs above hangs at the left.
        let lift = HALF_X_HEIGHT * size;
        let at = if is_upright { [x - lift, y] } else { [x, y - lift] };
        let align = match element.get("text-anchor") {
            Some("start") => Align::Start,
            Some("middle") => Align::Middle,
            Some("end") => Align::End,
            other => panic!("{other:?}"),
        };
        let weight = if element.get("font-weight").is_some() { Weight::Strong } else { Weight::Regular };
        let text = element.text.trim().to_owned();
        let label = Label { text: text.clone(), at, align, size, weight, color: Rgb(0, 0, 0), is_upright };
        (text, label.area())
    };
    elements.iter().filter(|element| element.name == "text").map(of).collect()
}

#[test]
fn every_sample_has_the_figures_that_its_data_allow() {
    for (name, figures) in SAMPLES.iter() {
        let ids: Vec<&str> = figures.iter().map(|(figure, _)| figure.id.as_str()).collect();
        let unique: BTreeSet<&str> = ids.iter().copied().collect();
        assert_eq!(unique.len(), ids.len(), "{name}: {ids:?} are names of files");
        assert!(
            ids.iter().all(|id| id.chars().all(|letter| letter.is_ascii_alphanumeric() || letter == '-')),
            "{ids:?}"
        );
        // What does not fit on half a page goes on under the same name with a number.
        let has = |wanted: &[&str]| {
            for id in wanted {
                let is_there = ids.contains(id) || ids.contains(&format!("{id}-1").as_str());
                assert!(is_there, "{name}: no {id} in {ids:?}");
            }
        };
        match *name {
            "plate.json" => {
                has(&["setup", "trajectory", "profile", "errors", "scatter", "influence", "halves", "distances"]);
            }
            "tip.json" => {
                has(&["setup", "trajectory", "profile", "profiles-1", "profiles-2", "errors", "scatter", "stability"]);
            }
            "workpiece.json" => {
                has(&["trajectory", "part-1-plane-distances", "part-2-plane-distances", "part-2-teeth"]);
            }
            "three-targets.json" => has(&["setup", "target-2-errors", "stability-1", "distances-2", "cross-target"]),
            "lin-mu-2019-table-1.json" | "lin-mu-2019-table-2.json" => {
                has(&["setup", "errors", "scatter", "stability"]);
            }
            "poses.json" => has(&["setup", "trajectory", "errors", "scatter", "influence", "halves", "stability"]),
            "near-largest-arc.json" => has(&["profile", "profiles-1", "errors", "halves"]),
            _ => has(&[
                "setup",
                "trajectory",
                "profile",
                "profiles",
                "curve",
                "curves",
                "errors",
                "scatter",
                "influence",
            ]),
        }
    }
}

#[test]
fn documents_are_well_formed_and_need_nothing_from_outside() {
    for (name, figure, svg) in all() {
        let elements = elements(svg);
        let root = elements.first().expect("a root");
        assert_eq!(root.name, "svg", "{name}");
        assert_eq!(root.get("xmlns"), Some("http://www.w3.org/2000/svg"));
        assert_eq!(root.get("aria-label"), Some(figure.alt.as_str()), "{name}");
        let [width, height] = figure.size_points().map(f64::from);
        assert!((root.number("width") - width).abs() < 1e-9 && (root.number("height") - height).abs() < 1e-9, "{name}");
        let drawn = ["svg", "rect", "line", "polyline", "polygon", "circle", "text"];
        assert!(elements.iter().all(|element| drawn.contains(&element.name.as_str())), "{name}");
        // The namespace is a name, no address that anything is fetched from.
        let rest = svg.replacen("http://www.w3.org/2000/svg", "", 1);
        for outside in ["http", "href", "url(", "@import", "<image", "<style", "<script", "data:"] {
            assert!(!rest.contains(outside), "{name} refers to {outside}");
        }
        assert!(!svg.contains("NaN") && !svg.contains("inf\""), "{name}");
    }
}

#[test]
fn words_stay_on_the_page_and_off_each_other() {
    for (name, _, svg) in all() {
        let elements = elements(svg);
        let view: Vec<f64> = elements[0]
            .get("viewBox")
            .expect("a view box")
            .split(' ')
            .map(|number| number.parse().expect("a number"))
            .collect();
        let page = Area::new([view[0], view[1]], [view[2], view[3]]);
        let texts = texts(&elements);
        assert!(texts.len() > 4, "{name} has words");
        for (place, (text, area)) in texts.iter().enumerate() {
            assert!(!text.is_empty() && has_all(text), "{name}: {text:?} has letters that the typeface lacks");
            assert!(page.holds_all(area), "{name}: {text:?} at {area:?} is not on the page {page:?}");
            for (other, other_area) in &texts[place + 1..] {
                assert!(!area.overlaps(other_area), "{name}: {text:?} stands on {other:?}");
            }
        }
    }
}

#[test]
fn words_on_each_other_would_be_seen() {
    let label = |text: &str, x: f64| {
        let (align, weight, color) = (Align::Start, Weight::Regular, Rgb(0, 0, 0));
        Ink::Label(Label { text: text.to_owned(), at: [x, 20.0], align, size: 8.0, weight, color, is_upright: false })
    };
    let overlaps = |second_at: f64| {
        let figure = Figure::new("x", "x", "x", [200, 40], vec![label("Hamburg", 10.0), label("Bremen", second_at)]);
        let texts = texts(&elements(&figure.svg().expect("drawn")));
        texts[0].1.overlaps(&texts[1].1)
    };
    assert!(overlaps(10.0) && overlaps(40.0));
    assert!(!overlaps(60.0), "Hamburg is 35 points wide at this size");
}

#[test]
fn captions_are_sentences_without_an_end_and_say_the_same_to_everyone() {
    for (name, figure, _) in all() {
        assert!(figure.title.len() > 15 && !figure.title.ends_with('.'), "{name}: {:?}", figure.title);
        assert!(figure.alt.starts_with(&figure.title) || figure.alt.len() > 15, "{name}: {:?}", figure.alt);
        let [width, height] = figure.size_points();
        assert!(width == 500 && (60..=680).contains(&height), "{name}: {width} × {height} does not fit a page");
    }
}

#[test]
fn the_same_session_gives_the_same_bytes() {
    for file_name in ["clean-sweeps.json", "plate.json", "workpiece.json"] {
        let session = sample(file_name);
        let (_, before) = SAMPLES.iter().find(|(name, _)| *name == file_name).expect("a sample");
        let again = figures(&session);
        assert_eq!(again.len(), before.len());
        for (figure, (first, svg)) in again.iter().zip(before) {
            assert_eq!(figure, first);
            assert_eq!(&figure.svg().expect("drawn"), svg);
        }
        let figure = &again[0];
        assert_eq!(figure.png(1.0).expect("drawn"), figure.png(1.0).expect("drawn"));
    }
}

#[test]
fn pixels_have_the_shape_of_the_page() {
    for (name, figure, _) in all().step_by(7) {
        let [width, height] = figure.size_points();
        for pixels_per_point in [0.5, 1.0] {
            let image = figure.png(pixels_per_point).expect("drawn");
            let near =
                |pixels: u32, points: u32| (f64::from(pixels) - f64::from(points) * pixels_per_point).abs() <= 0.5;
            assert!(near(image.width(), width) && near(image.height(), height), "{name}");
        }
    }
}

#[test]
fn sessions_with_little_in_them_have_fewer_figures_and_break_nothing() {
    assert_eq!(figures(&Session::new(Target::ball(15.0))), []);
    assert_eq!(figures(&Session::new(Target::RightAnglePlate)), []);
    assert_eq!(figures(&Session::new(Target::Workpiece)), []);
    let one = simulate(&SimulationOptions { num_stations: 1, num_steps: 1, ..SimulationOptions::default() });
    assert_eq!(ids(&one), ["profile"], "a profile, but no calibration and no way");
    let mut off = sample("clean-sweeps.json");
    off.stations.iter_mut().for_each(|station| station.enabled = false);
    assert_eq!(figures(&off), []);
    // All at one place, and one far away: extents of nothing, and scales that differ widely.
    let mut heap = sample("lin-mu-2019-table-1.json");
    for station in &mut heap.stations {
        station.captures[0].base_from_flange = Transform::identity();
    }
    draw_all(&heap);
    let rotation = heap.stations[0].captures[0].base_from_flange.rotation();
    heap.stations[1].captures[0].base_from_flange = Transform::from_parts(Vec3::new(1e6, -1e6, 1e6), rotation);
    draw_all(&heap);
}

fn draw_all(session: &Session) {
    for figure in figures(session) {
        elements(&figure.svg().expect("drawn"));
        figure.png(0.5).expect("drawn");
    }
}

#[test]
fn names_are_escaped_and_long_ones_cut() {
    let mut session = sample("clean-sweeps.json");
    "<b>&\"5'".clone_into(&mut session.stations[0].label);
    "a station with a name that no axis, heading or legend has room for, however wide the page"
        .clone_into(&mut session.stations[1].label);
    let drawn = figures(&session);
    let mut found = false;
    for figure in &drawn {
        let texts = texts(&elements(&figure.svg().expect("drawn")));
        found |= texts.iter().any(|(text, _)| text.contains("<b>&\"5'"));
        for (place, (text, area)) in texts.iter().enumerate() {
            assert!(texts[place + 1..].iter().all(|(_, other)| !area.overlaps(other)), "{}: {text:?}", figure.id);
        }
    }
    assert!(found, "the name stands in a figure as it is");
}

#[test]
fn twenty_stations_fill_pages_and_no_more() {
    let options = SimulationOptions { num_stations: 20, num_steps: 5, num_points: 200, ..SimulationOptions::default() };
    let session = simulate(&options);
    assert!(matches!(session.stations[0].captures[0].reading, Reading::Profile(_)));
    for figure in figures(&session) {
        let [_, height] = figure.size_points();
        assert!(height <= 680, "{} is {height} points high", figure.id);
        let texts = texts(&elements(&figure.svg().expect("drawn")));
        for (place, (text, area)) in texts.iter().enumerate() {
            assert!(texts[place + 1..].iter().all(|(_, other)| !area.overlaps(other)), "{}: {text:?}", figure.id);
        }
    }
}

/// A few pictures at a low size; those of the whole page are looked at by eye.
#[test]
fn figures_look_as_they_did() {
    for (file_name, id) in [
        ("clean-sweeps.json", "setup"),
        ("clean-sweeps.json", "curve"),
        ("dirty-profiles.json", "profile"),
        ("one-bad-pose.json", "errors"),
        ("plate.json", "scatter"),
        ("three-targets.json", "cross-target"),
    ] {
        let (_, figures) = SAMPLES.iter().find(|(name, _)| *name == file_name).expect("a sample");
        let (figure, _) = figures.iter().find(|(figure, _)| figure.id == id).expect("the figure");
        let image = figure.png(0.75).expect("drawn");
        let opaque = image::DynamicImage::ImageRgb8(image).to_rgba8();
        egui_kittest::image_snapshot(&opaque, format!("figure_{}", id.replace('-', "_")));
    }
}
