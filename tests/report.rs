//! Reports as files: every sample gives one, well-formed, self-contained, the same bytes each time.
#![expect(clippy::expect_used, reason = "a test that cannot begin must fail")]

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use handeye::report::document::{Block, Document, InputFile, Options, SectionId, document};
use handeye::report::evidence::Evidence;
use handeye::report::files::{ReportFile, report_files};
use handeye::report::html::html;
use handeye::report::markdown::markdown;
use handeye::session::{self, Session, samples};
use handeye::watch::Unwatched;
use serde_json::Value;

fn evidence(session: &Session) -> Evidence {
    Evidence::gather(
        session,
        &session::measure(session, None, &mut Unwatched).expect("not cancelled"),
        &[],
        &mut Unwatched,
    )
    .expect("nobody cancels")
}

fn sample(file_name: &str) -> Session {
    let sample = samples::ALL.iter().find(|sample| sample.file_name == file_name).expect("a sample of this name");
    session::parse(sample.json.as_bytes(), file_name).expect("samples are sessions")
}

fn report(session: &Session, options: &Options) -> (Evidence, Document) {
    let evidence = evidence(session);
    let document = document(&evidence, &[InputFile::new("a.json".to_owned(), b"{}")], options);
    (evidence, document)
}

fn without_figures() -> Options {
    let mut options = Options::default();
    options.sections.remove(&SectionId::Figures);
    options
}

fn text_of<'a>(files: &'a [ReportFile], path: &str) -> &'a str {
    let file = files.iter().find(|file| file.path == path).expect("a file of this name");
    std::str::from_utf8(&file.bytes).expect("text")
}

/// Tags open and close as in XML, so that every reader sees the same page.
#[track_caller]
fn check_well_formed(html: &str) {
    let body = html.strip_prefix("<!DOCTYPE html>").expect("a page begins so");
    let mut open: Vec<&str> = Vec::new();
    let mut rest = body;
    while let Some(start) = rest.find('<') {
        assert!(!rest[..start].contains('>') || open.last() == Some(&"style"), "a stray > in {:.60}", &rest[..start]);
        rest = &rest[start..];
        if let Some(comment) = rest.strip_prefix("<!--") {
            rest = &comment[comment.find("-->").expect("a comment ends") + 3..];
            continue;
        }
        let end = rest.find('>').expect("a tag ends");
        let tag = &rest[1..end];
        let name = tag.trim_matches('/').split_whitespace().next().unwrap_or("");
        if let Some(closed) = tag.strip_prefix('/') {
            assert_eq!(open.pop(), Some(closed.trim()), "</{closed}> closes another tag");
        } else if !tag.ends_with('/') {
            open.push(name);
        }
        assert_eq!(tag.matches('"').count() % 2, 0, "quotes of <{tag}>");
        rest = &rest[end + 1..];
    }
    assert!(open.is_empty(), "{open:?} stay open");
    // Ids are there once each.
    let ids: Vec<&str> = html.split(" id=\"").skip(1).filter_map(|rest| rest.split('"').next()).collect();
    let unique: BTreeSet<&str> = ids.iter().copied().collect();
    assert_eq!(ids.len(), unique.len(), "ids are unique");
}

/// The page needs nothing but itself.
#[track_caller]
fn check_self_contained(html: &str) {
    for outward in ["src=", "<link", "<script", "@import", "url(http", "href=\"http", "href=\"//"] {
        assert!(!html.contains(outward), "the page refers outside with {outward}");
    }
    let links = html.split("href=\"").skip(1);
    assert!(links.into_iter().all(|link| link.starts_with('#')), "links stay in the page");
    // What names a place in the net names a format, it is not fetched.
    let places = html.match_indices("http").map(|(at, _)| &html[at..]);
    let formats = ["http://www.w3.org/2000/svg", "http://www.w3.org/1999/xlink"];
    for place in places {
        assert!(formats.iter().any(|format| place.starts_with(format)), "{place:.60}");
    }
}

#[test]
fn every_sample_gives_a_page_that_is_whole_and_needs_no_other() {
    for sample in samples::ALL {
        let session = session::parse(sample.json.as_bytes(), sample.file_name).expect("samples are sessions");
        let (evidence, document) = report(&session, &Options::default());
        let files = report_files(&document, &evidence).expect("figures are drawn");
        let page = text_of(&files, "report.html");
        check_well_formed(page);
        check_self_contained(page);
        let paths: BTreeSet<&str> = files.iter().map(|file| file.path.as_str()).collect();
        assert_eq!(paths.len(), files.len(), "{}: every file has a name of its own", sample.file_name);
        let markdown = text_of(&files, "report.md");
        for link in markdown.split("](").skip(1).filter_map(|rest| rest.split(')').next()) {
            assert!(paths.contains(link), "{}: {link} is linked and written", sample.file_name);
        }
        for section in &document.sections {
            assert!(!section.blocks.is_empty(), "{}: {} is empty", sample.file_name, section.title);
        }
        for table in document.tables() {
            assert!(
                table.rows.iter().all(|row| row.len() == table.columns.len()),
                "{}: {}",
                sample.file_name,
                table.id
            );
        }
        // The same session, the same bytes.
        let again = report(&session, &Options::default());
        let again = report_files(&again.1, &again.0).expect("figures are drawn");
        assert!(files == again, "{}: the bytes differ", sample.file_name);
    }
}

#[test]
fn tables_hold_what_the_result_file_holds() {
    let (evidence, document) = report(&sample("clean-sweeps.json"), &without_figures());
    let files = report_files(&document, &evidence).expect("figures are drawn");
    let result: Value = serde_json::from_str(text_of(&files, "result.json")).expect("JSON");
    let methods = result["methods"].as_array().expect("methods");
    let of = |id: &str| methods.iter().find(|method| method["method"] == id).expect("a method of this name");
    let rows = |path: &str| -> Vec<Vec<String>> {
        let text = text_of(&files, path);
        let mut reader = csv::ReaderBuilder::new().has_headers(false).from_reader(text.as_bytes());
        reader.records().map(|row| row.expect("CSV").iter().map(str::to_owned).collect()).collect()
    };
    let number = |text: &str| text.parse::<f64>().expect("a number");

    let table = rows("tables/methods.csv");
    let column = |name: &str| table[0].iter().position(|head| head == name).expect("a column of this name");
    assert_eq!(table.len(), methods.len() + 1);
    for (row, method) in table[1..].iter().zip(methods) {
        for (name, value) in [
            ("scatter_rms_mm", &method["scatter_mm"]["rms"]),
            ("leave_one_out_rms_mm", &method["leave_one_out_mm"]["rms"]),
            ("workspace_point_std_mm", &method["uncertainty"]["workspace_point_std_mm"]),
        ] {
            assert_eq!(Some(number(&row[column(name)])), value.as_f64(), "{name}");
        }
    }
    let table = rows("tables/ball-bundle.csv");
    let column = |name: &str| table[0].iter().position(|head| head == name).expect("a column of this name");
    let stations = of("ball-bundle")["stations"].as_array().expect("stations");
    for (row, station) in table[1..].iter().zip(stations) {
        for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
            for (head, key) in [("target_in_sensor", "target_in_sensor_mm"), ("target_in_base", "target_in_base_mm")] {
                let found = number(&row[column(&format!("{head}_{name}_mm"))]);
                assert_eq!(Some(found), station[key][axis].as_f64(), "{head} {name}");
            }
            let error = number(&row[column(&format!("error_{name}_mm"))]);
            assert_eq!(Some(error), station["error_from_first_mm"][axis].as_f64());
        }
    }
    let matrix = rows("tables/matrix.csv");
    for (line, row) in matrix[1..].iter().enumerate() {
        for (column, text) in row.iter().enumerate() {
            assert_eq!(Some(number(text)), of("ball-bundle")["flange_from_sensor"]["matrix"][line][column].as_f64());
        }
    }
}

#[test]
fn sections_can_be_switched_off_one_by_one() {
    let evidence = evidence(&sample("three-targets.json"));
    let all = document(&evidence, &[], &without_figures());
    let ids = |document: &Document| document.sections.iter().map(|section| section.id).collect::<Vec<_>>();
    assert_eq!(ids(&all), SectionId::ALL.into_iter().filter(|id| *id != SectionId::Figures).collect::<Vec<_>>());
    for id in SectionId::ALL.into_iter().filter(|id| *id != SectionId::Figures) {
        let only = document(&evidence, &[], &Options { sections: [id].into(), ..Options::default() });
        assert_eq!(ids(&only), [id]);
        let page = html(&only).expect("nothing is to be drawn");
        check_well_formed(&page);
        assert!(page.contains(&format!("<section id=\"{}\"", id.id())));
        let mut options = without_figures();
        options.sections.remove(&id);
        assert!(!ids(&document(&evidence, &[], &options)).contains(&id));
    }
}

#[test]
fn every_target_is_reported() {
    let (_, document) = report(&sample("three-targets.json"), &without_figures());
    let tables: BTreeSet<&str> = document.tables().map(|table| table.id.as_str()).collect();
    for id in [
        "targets",
        "methods",
        "methods-target-2",
        "methods-target-3",
        "ball-bundle",
        "plate-bundle-target-2",
        "fixed-point-target-3",
        "stations",
        "stations-target-2",
        "stations-target-3",
        "cross-targets",
        "joint",
        "distances-target-2",
        "stability-target-3",
    ] {
        assert!(tables.contains(id), "{id} is missing from {tables:?}");
    }
}

#[test]
fn whatever_a_session_is_called_is_text() {
    let mut session = sample("tip.json");
    session.name = "<script>alert(\"1\")</script> & 'co' | *x*\u{1}".to_owned();
    session.notes = "first\n</dd><b>second".to_owned();
    session.stations[0].label = "</td><img src=x>".to_owned();
    let options = Options { operator: "<i>A & B".to_owned(), ..without_figures() };
    let (_, document) = report(&session, &options);
    let page = html(&document).expect("nothing is to be drawn");
    check_well_formed(&page);
    assert!(
        page.contains("<h1>&lt;script&gt;alert(&quot;1&quot;)&lt;/script&gt; &amp; &#39;co&#39; | *x*\u{fffd}</h1>")
    );
    assert!(page.contains("first<br/>&lt;/dd&gt;&lt;b&gt;second"));
    assert!(!page.contains("<script") && !page.contains("<img") && !page.contains("<i>"));
    let markdown = markdown(&document);
    assert!(markdown.starts_with("# &lt;script&gt;alert"));
    assert!(!markdown.contains("<script") && !markdown.contains("<img"));
}

#[test]
fn what_cannot_be_solved_is_reported_with_its_reason() {
    let mut session = sample("clean-sweeps.json");
    session.stations.truncate(2);
    let (evidence, document) = report(&session, &without_figures());
    let reason = evidence.refusal().expect("two stations are too few");
    let Some(Block::Verdict(verdict)) = document.blocks().next() else { panic!("a report begins with its verdict") };
    assert_eq!(verdict.name, "No calibration");
    assert!(verdict.reason.contains("at least"), "{}", verdict.reason);
    assert!(document.sections.iter().all(|section| section.id != SectionId::Calibration));
    assert!(document.tables().any(|table| table.id == "methods"), "each method with its reason");
    assert!(markdown(&document).contains("not computed"), "{reason}");
}

#[test]
fn a_poor_result_is_a_report_with_its_warnings() {
    let (_, document) = report(&sample("one-bad-pose.json"), &without_figures());
    let markdown = markdown(&document);
    assert!(markdown.contains("**✖ Not usable**"));
    assert!(markdown.contains("wrong-pose") && markdown.contains("Leave out station 7"));
}

#[test]
fn the_operator_signs_with_what_was_given() {
    let options = Options {
        operator: "R. Keller".to_owned(),
        place: "Cell 3".to_owned(),
        date: "2026-11-22".to_owned(),
        notes: "after the crash of Tuesday".to_owned(),
        ..without_figures()
    };
    let (_, document) = report(&sample("tip.json"), &options);
    let markdown = markdown(&document);
    for said in ["- Name: R. Keller", "- Place: Cell 3", "- Date: 2026-11-22", "- Signature: ____", "crash of Tuesday"]
    {
        assert!(markdown.contains(said), "{said}");
    }
}

fn handeye(arguments: &[&str], folder: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_handeye"))
        .args(arguments)
        .current_dir(folder)
        .output()
        .expect("the program starts")
}

fn written(folder: &Path) -> BTreeSet<PathBuf> {
    let mut files = BTreeSet::new();
    let mut folders = vec![folder.to_path_buf()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                folders.push(path);
            } else {
                files.insert(path);
            }
        }
    }
    files
}

#[test]
fn the_command_writes_a_folder_replaces_its_own_files_and_leaves_others_alone() {
    let folder = tempfile::tempdir().expect("a folder");
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    fs::copy(root.join("sample_sessions/tip.json"), folder.path().join("tip.json")).expect("copied");
    let run = |more: &[&str]| {
        let output = handeye(&[&["report", "tip.json", "--out", "a/b"], more].concat(), folder.path());
        assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8(output.stdout).expect("text")
    };
    let said = run(&[]);
    let out = folder.path().join("a/b");
    let listed: BTreeSet<PathBuf> =
        said.lines().map(|line| folder.path().join(line.strip_prefix("wrote ").expect("one file a line"))).collect();
    assert_eq!(listed, written(&out), "what is listed is what is there");
    let page = fs::read(out.join("report.html")).expect("written");
    fs::write(out.join("report.html"), "an earlier report").expect("written");
    fs::write(out.join("mine.txt"), "mine").expect("written");
    run(&[]);
    assert_eq!(fs::read(out.join("report.html")).expect("written"), page);
    assert_eq!(fs::read_to_string(out.join("mine.txt")).expect("there"), "mine");
    // The checksum is that of the file's bytes.
    let sums = fs::read_to_string(out.join("tables/inputs.csv")).expect("written");
    let bytes = fs::read(folder.path().join("tip.json")).expect("readable");
    assert!(sums.contains(&handeye::report::checksum::sha256(&bytes)), "{sums}");
    // Solving gives the same result file.
    let solved = handeye(&["solve", "tip.json", "--json"], folder.path());
    assert_eq!(fs::read(out.join("result.json")).expect("written"), solved.stdout);

    let only = run(&["--section", "verdict", "--section", "signature", "--operator", "me"]);
    assert!(!only.contains("tables/"), "{only}");
}

#[test]
fn refusals_name_what_was_found_and_what_was_expected() {
    let folder = tempfile::tempdir().expect("a folder");
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let tip = root.join("sample_sessions/tip.json");
    let tip = tip.to_str().expect("a path in UTF-8");
    fs::write(folder.path().join("broken.json"), "{\"format\": ").expect("written");
    fs::write(folder.path().join("file"), "").expect("written");
    for (arguments, status, expected) in [
        (vec!["report", "none.json", "--out", "out"], 2, "none.json"),
        (vec!["report", "broken.json", "--out", "out"], 2, "broken.json"),
        (vec!["report", tip], 2, "--out"),
        (vec!["report", tip, "--out", "out", "--section", "prices"], 2, "expected one of: verdict"),
        (vec!["report", tip, "--out", "out", "--section", "verdict", "--without", "setup"], 2, "cannot be used with"),
        (vec!["report", tip, "--out", "file"], 2, "file is a file, and a report needs a folder"),
    ] {
        let output = handeye(&arguments, folder.path());
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(status), "{arguments:?}: {said}");
        assert!(said.contains(expected) && said.trim_end().lines().count() == 1, "{arguments:?}: {said}");
        assert!(!folder.path().join("out").exists(), "nothing is written: {arguments:?}");
    }
}

#[test]
fn a_session_without_a_calibration_is_reported_and_the_status_says_so() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut session = sample("clean-sweeps.json");
    session.stations.truncate(2);
    fs::write(folder.path().join("two.json"), session::to_json(&session)).expect("written");
    let output = handeye(&["report", "two.json", "--out", "out"], folder.path());
    assert_eq!(output.status.code(), Some(3));
    assert!(String::from_utf8_lossy(&output.stderr).contains("the report says so"));
    let page = fs::read_to_string(folder.path().join("out/report.html")).expect("the report is there");
    assert!(page.contains("No calibration"));
}

#[test]
fn centres_have_no_radius_to_be_wrong() {
    let (evidence, document) = report(&sample("lin-mu-2019-table-1.json"), &Options::default());
    let said = markdown(&document);
    assert!(!said.contains("If the radius is wrong"), "{said}");
    assert!(said.contains("not used, as the readings are centres already"));
    // There is no section that tells what the data show of the noise.
    assert!(!said.contains("estimated from the data"));
    let setup = document.figures().find(|figure| figure.id == "setup").expect("a sketch");
    assert!(setup.title.contains("ball's centre") && !evidence.targets[0].uses_radius());
    let (_, with_radius) = report(&sample("clean-sweeps.json"), &without_figures());
    assert!(markdown(&with_radius).contains("If the radius is wrong"));
}

#[test]
fn a_lowered_verdict_names_what_lowered_it() {
    let (_, document) = report(&sample("near-largest-arc.json"), &without_figures());
    let verdict = document.blocks().find_map(|block| match block {
        Block::Verdict(verdict) => Some(verdict),
        _ => None,
    });
    let verdict = verdict.expect("a verdict");
    assert_eq!(verdict.name, "Usable");
    let expected = "By its figures alone it would be good; “blind-in-y” lowers it to usable.";
    assert!(verdict.reason.starts_with(expected), "{}", verdict.reason);
}

#[test]
fn what_needs_no_calibration_is_not_marked_as_a_failure() {
    let (_, document) = report(&sample("workpiece.json"), &without_figures());
    let page = html(&document).expect("drawn");
    assert!(page.contains("class=\"verdict none\"") && !page.contains(".verdict.none"), "neutral colours");
    // A plane's equation and an angle's uncertainty are figures in the tables.
    let csv = |id: &str| {
        let table = document.tables().find(|table| table.id == id).expect("a table of this name");
        handeye::report::csv_tables::csv_table(table)
    };
    assert!(csv("planes").starts_with("plane,normal_x,normal_y,normal_z,offset_mm,height_std_mm"), "{}", csv("planes"));
    assert!(csv("angles").starts_with("planes,angle_deg,angle_std_deg\n"), "{}", csv("angles"));
    let row: Vec<f64> =
        csv("planes").lines().nth(1).expect("a plane").split(',').skip(1).take(3).flat_map(str::parse).collect();
    assert!((row.iter().map(|part| part * part).sum::<f64>() - 1.0).abs() < 1e-12, "a unit vector: {row:?}");
}

#[test]
fn figures_name_the_calibrations_that_they_leave_out() {
    let (_, document) = report(&sample("three-targets.json"), &Options::default());
    let left_out: Vec<&str> = document
        .figures()
        .filter_map(|figure| figure.title.split_once("not shown: ").map(|(_, names)| names))
        .collect();
    assert!(left_out.iter().any(|names| names.contains("Largest arc, published stop")), "{left_out:?}");
}

#[test]
fn rotations_have_the_digits_that_their_uncertainty_allows() {
    let decimals = |sample_name: &str| {
        let (_, document) = report(&sample(sample_name), &without_figures());
        let table = document.tables().find(|table| table.id == "quaternion").expect("a quaternion");
        let cell = &table.rows[0][0];
        assert!(
            cell.value.is_some_and(|value| (value.abs() - value.abs().round()).abs() > 1e-9),
            "all digits are kept"
        );
        cell.text.split_once('.').map_or(0, |(_, decimals)| decimals.len())
    };
    // σ of 0.03°, and of half a degree.
    assert_eq!((decimals("clean-sweeps.json"), decimals("lin-mu-2019-table-1.json")), (6, 4));
}
