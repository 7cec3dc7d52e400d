//! Imports through the library: every format to stations, mistakes with their place.
#![expect(clippy::expect_used, reason = "a test that finds nothing to check must fail")]

use std::path::{Path, PathBuf};

use handeye::geometry::{PoseNotation, Transform};
use handeye::session::import::{ImportError, ImportOptions, Imported, Kind, Note, Source, read, read_paths};
use handeye::session::{Reading, Session, Target, load};
use handeye::watch::Unwatched;

fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/import").join(name)
}

#[track_caller]
fn import_text(text: &str) -> Imported {
    try_text(text, &ImportOptions::default()).expect("an import")
}

fn try_text(text: &str, options: &ImportOptions) -> Result<Imported, ImportError> {
    let sources = [Source { name: "pasted".to_owned(), text: text.to_owned() }];
    read(&sources, options, &PoseNotation::default(), &mut Unwatched)
}

#[track_caller]
fn import_file(name: &str) -> Imported {
    let sources = read_paths(&[data(name)]).expect("readable");
    read(&sources, &ImportOptions::default(), &PoseNotation::default(), &mut Unwatched).expect("an import")
}

#[track_caller]
fn assert_same_pose<D: handeye::geometry::Frame, S: handeye::geometry::Frame>(
    found: &Transform<D, S>,
    expected: &Transform<D, S>,
) {
    let apart_mm = (found.translation_mm() - expected.translation_mm()).norm();
    let apart_rad = found.rotation().angle_to(&expected.rotation());
    // Rounding of a few operations on metres.
    assert!(apart_mm < 1e-9 && apart_rad < 1e-12, "{found:?} is not {expected:?}");
}

#[track_caller]
fn assert_same_stations(found: &Session, expected: &Session) {
    assert_eq!(found.stations.len(), expected.stations.len());
    for (found, expected) in found.stations.iter().zip(&expected.stations) {
        assert_eq!((&found.label, found.side), (&expected.label, expected.side));
        assert_eq!(found.captures.len(), expected.captures.len());
        for (found, expected) in found.captures.iter().zip(&expected.captures) {
            assert_same_pose(&found.base_from_flange, &expected.base_from_flange);
            assert_eq!(found.reading, expected.reading);
        }
    }
}

fn sample(name: &str) -> Session {
    load(&Path::new(env!("CARGO_MANIFEST_DIR")).join("sample_sessions").join(name)).expect("a session")
}

#[test]
fn the_tables_of_the_paper_are_read_from_its_text() {
    for (file, expected) in
        [("printed-markdown.md", "lin-mu-2019-table-1.json"), ("printed-largest-arc.md", "lin-mu-2019-table-2.json")]
    {
        let imported = import_file(file);
        assert_eq!(imported.parts[0].kind, Kind::PrintedTable);
        assert!(imported.problems.is_empty(), "{:?}", imported.problems);
        let session = imported.into_session("table".to_owned(), Target::ball(30.0));
        let expected = sample(expected);
        assert_same_stations(&session, &expected);
        let (found, printed) = (session.published.expect("printed"), expected.published.expect("printed"));
        assert_eq!(found.ball_in_base_mm, printed.ball_in_base_mm);
        assert_eq!(found.error_from_first_mm, printed.error_from_first_mm);
    }
}

#[test]
fn of_a_text_with_several_tables_the_first_is_taken_and_that_is_said() {
    let both = format!(
        "In the text q0=1 stands too, and $x_s=x_1$.\n\n{}\n\nFrom Table 1 follows that much.\n\n{}",
        include_str!("data/import/printed-markdown.md"),
        include_str!("data/import/printed-largest-arc.md")
    );
    let imported = import_text(&both);
    assert_eq!(imported.stations.len(), 5);
    assert!(imported.notes.iter().any(|note| matches!(note, Note::OtherTablesLeftOut { num_tables: 1, .. })));
}

#[test]
fn a_table_copied_as_plain_text_is_the_same() {
    let text = "1 q0=0.07921 t1=306.433 xs=−26.25 xb=324.442\nq1=−0.1606 t2=−54.903 ys=4.0246\n\
        q₂ = - 0. 979 t3=59.2488 zs=78.46\nq3=-0.0914\n";
    let imported = import_text(text);
    let expected = sample("lin-mu-2019-table-1.json");
    let capture = &imported.stations[0].captures[0];
    assert_same_pose(&capture.base_from_flange, &expected.stations[0].captures[0].base_from_flange);
    assert_eq!(capture.reading, expected.stations[0].captures[0].reading);
}

#[test]
fn a_table_with_a_header_says_what_it_is() {
    let text = "No.;X [mm];Y [mm];Z [mm];W [deg];P [deg];R [deg]\n\
        A;562,415;-110,245;-139,394;-178,2;0,5;90\nB;555,775;-129,153;154,864;179;1;45,25\n";
    let imported = import_text(text);
    assert_eq!(imported.options.decimal_comma, Some(true));
    let labels: Vec<&str> = imported.stations.iter().map(|station| station.label.as_str()).collect();
    assert_eq!(labels, ["A", "B"]);
    let expected = PoseNotation::default().base_from_flange(&[562.415, -110.245, -139.394, -178.2, 0.5, 90.0]);
    assert_same_pose(&imported.stations[0].captures[0].base_from_flange, &expected.expect("a pose"));
    assert!(matches!(imported.stations[0].captures[0].reading, Reading::Profile(_)));
    assert_eq!(imported.notes, [Note::PosesWithoutReading { num_poses: 2 }]);
}

#[test]
fn mistakes_are_listed_with_their_place() {
    let text = "x,y,z,w,p,r\n1,2,300,4,5,60\n1,2,x7,4,5,6\n7,8,9\n10,20,300,40,50,60\n";
    let imported = import_text(text);
    let problems: Vec<String> = imported.problems.iter().map(ToString::to_string).collect();
    assert_eq!(
        problems,
        [
            "pasted, line 3, column 5: found x7, expected a number",
            "pasted, line 4, column 6: found nothing, expected a number"
        ]
    );
    assert_eq!(imported.stations.len(), 2);
}
