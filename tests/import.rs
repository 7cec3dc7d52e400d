//! Imports through the library: every format to stations, mistakes with their place.
#![expect(clippy::expect_used, reason = "a test that finds nothing to check must fail")]

use std::path::{Path, PathBuf};

use handeye::geometry::{PoseNotation, Transform};
use handeye::session::import::{ImportError, ImportOptions, Imported, Kind, Note, Source, read, read_paths};
use handeye::session::{Edge, Reading, Session, Target, load};
use handeye::watch::Unwatched;

fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/import").join(name)
}

#[track_caller]
fn import_text(text: &str) -> Imported {
    try_text(text, &ImportOptions::default()).expect("an import")
}

fn try_text(text: &str, options: &ImportOptions) -> Result<Imported, ImportError> {
    let sources = [Source::from_text("pasted", text)];
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
        let session = imported.into_session("table".to_owned(), Target::ball(30.0)).expect("a session");
        let expected = sample(expected);
        assert_same_stations(&session, &expected);
        let (found, printed) = (session.published.expect("printed"), expected.published.expect("printed"));
        assert_eq!(found.target_in_base_mm, printed.target_in_base_mm);
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
    let text = "1 q0=0.07921 t1=306.433 xs=\u{2212}26.25 xb=324.442\nq1=\u{2212}0.1606 t2=\u{2212}54.903 ys=4.0246\n\
        q\u{2082} = - 0. 979 t3\u{ff1d}59\u{ff0e}2488 zs=78.46\nq3=-0.0914\n";
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

/// The examples of the documentation: name, poses, readings, text.
fn examples() -> Vec<(String, usize, usize, String)> {
    let doc = include_str!("../docs/import.md").split("<!-- example: ").skip(1);
    doc.map(|part| {
        let (head, rest) = part.split_once(" -->\n```\n").expect("a fence behind its comment");
        let (text, _) = rest.split_once("```\n").expect("the fence is closed");
        let words: Vec<&str> = head.split(' ').collect();
        let count = |name: &str| {
            let word = words.iter().find_map(|word| word.strip_prefix(name)).expect("a count");
            word.parse().expect("a number")
        };
        (words[0].to_owned(), count("poses="), count("readings="), text.to_owned())
    })
    .collect()
}

#[test]
fn the_examples_of_the_documentation_are_read() {
    let examples = examples();
    assert!(examples.len() > 10);
    for (name, num_poses, num_readings, text) in examples {
        let sources = [Source::from_text(name.clone(), text)];
        let imported = read(&sources, &ImportOptions::default(), &PoseNotation::default(), &mut Unwatched);
        let imported = imported.expect(&name);
        assert!(imported.problems.is_empty(), "{name}: {:?}", imported.problems);
        let part = &imported.parts[0];
        assert_eq!((part.num_poses, part.num_readings), (num_poses, num_readings), "{name}: {part:?}");
    }
}

#[track_caller]
fn example(name: &str) -> Imported {
    let (name, _, _, text) = examples().into_iter().find(|example| example.0 == name).expect("an example");
    let sources = [Source::from_text(name, text)];
    read(&sources, &ImportOptions::default(), &PoseNotation::default(), &mut Unwatched).expect("an import")
}

/// The first pose as numbers in the notation that it was read in, its tool point aside.
#[track_caller]
fn check_first(imported: &Imported, label: &str, expected: &[f64]) {
    let station = &imported.stations[0];
    assert_eq!(station.label, label);
    let notation = imported.options.notation.expect("known");
    let numbers = notation.numbers(&station.captures[0].base_from_flange);
    for (found, expected) in numbers.iter().zip(expected) {
        // Rounding, and quaternions rounded in the file.
        assert!((found - expected).abs() < 2e-5, "{numbers:?}");
    }
}

#[test]
fn programs_give_their_poses_in_their_makers_numbers() {
    let fanuc = example("scan.ls");
    check_first(&fanuc, "1", &[562.415, -110.245, -139.394, -178.2, 0.5, 90.25]);
    assert_eq!(fanuc.stations[1].label, "edge");
    assert!(fanuc.notes.contains(&Note::ToolTakenAsFlange { tool: "UTOOL 1".to_owned(), num_poses: 2 }));
    let abb = example("Scan.mod");
    check_first(&abb, "p10", &[562.42, -110.25, 139.39, 0.18734, -0.90291, -0.36069, -0.13984]);
    assert_eq!(abb.stations[2].label, "aRow{2}");
    let tool = abb.options.notation.and_then(|notation| notation.flange_from_tcp).expect("the module's tool");
    assert!((tool.translation_mm().z - 120.0).abs() < 1e-12);
    let kuka = example("scan.dat");
    check_first(&kuka, "P1", &[562.415, -110.245, 139.394, 90.25, 0.5, -178.2]);
    assert!(kuka.notes.contains(&Note::JointPoses { num_poses: 1 }));
    assert!(kuka.notes.contains(&Note::ToolTakenAsFlange { tool: "TOOL_DATA[1]".to_owned(), num_poses: 1 }));
    let ur = example("scan.script");
    assert_eq!(ur.stations[0].label, "Waypoint_1_p");
    let tool = ur.options.notation.and_then(|notation| notation.flange_from_tcp).expect("the script's tool");
    assert!((tool.translation_mm().z - 120.0).abs() < 1e-12);
    check_first(&ur, "Waypoint_1_p", &[0.5624, -0.1102, 0.1394]);
}

/// Labels and heights of the stations, mm.
fn heights(imported: &Imported) -> Vec<(&str, f64)> {
    let height = |station: &handeye::session::Station| station.captures[0].base_from_flange.translation_mm().z.round();
    imported.stations.iter().map(|station| (station.label.as_str(), height(station))).collect()
}

#[test]
fn every_target_of_an_abb_module_is_in_the_frames_of_its_own_move() {
    let data = "PERS tooldata tScan:=[TRUE,[[0,0,150],[1,0,0,0]],[1,[0,0,1],[1,0,0,0],0,0,0]];\n\
        PERS wobjdata wA:=[FALSE,TRUE,\"\",[[0,0,1000],[1,0,0,0]],[[0,0,0],[1,0,0,0]]];\n";
    let target =
        |name: &str| format!("CONST robtarget {name}:=[[500,0,300],[0,0,1,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];\n");
    let (p10, p20) = (target("p10"), target("p20"));
    // The tool points down, so its flange is 150 mm above.
    for (moves, expected) in [
        ("MoveL p10,v100,fine,tool0;", [("p10", 300.0), ("p20", 300.0)]),
        ("MoveL p10,v100,fine,tool0; MoveL p20,v100,fine,tScan;", [("p10", 300.0), ("p20", 450.0)]),
        (
            "MoveL p10,v100,fine,tScan; MoveJ P20,v100,fine,! to the cell\n  tScan\\WObj:=wA;",
            [("p10", 450.0), ("p20", 1450.0)],
        ),
        ("MoveC p10,p20,v100,z10,\n tScan \\WObj:=wobj0;", [("p10", 450.0), ("p20", 450.0)]),
    ] {
        let text = format!("MODULE m\n{data}{p10}{p20}PROC MoveHome()\n{moves}\nENDPROC\nENDMODULE\n");
        let imported = import_text(&text);
        assert_eq!(heights(&imported), expected, "{moves}");
        assert!(!imported.notes.iter().any(|note| matches!(note, Note::ToolTakenAsFlange { .. })), "{moves}");
    }
    let pose = "[[500,0,300],[0,0,1,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]]";
    let inline = format!("{data}robtarget x;\nMoveL\\Conc,{pose},v100,fine,tool0;\nMoveC {pose},{pose},v1,z1,tScan;\n");
    assert_eq!(heights(&import_text(&inline)), [("1", 300.0), ("2", 450.0), ("3", 450.0)]);
}

#[test]
fn the_work_object_of_a_module_is_in_its_own_units() {
    let text = include_str!("data/import/work-object.mod");
    let radians = PoseNotation {
        angle_unit: handeye::geometry::notation::AngleUnit::Radians,
        ..import_text(text).options.notation.expect("known")
    };
    let options = ImportOptions { notation: Some(radians), ..ImportOptions::default() };
    let (found, expected) = (try_text(text, &options).expect("an import"), import_text(text));
    for (found, expected) in found.stations.iter().zip(&expected.stations) {
        assert_same_pose(&found.captures[0].base_from_flange, &expected.captures[0].base_from_flange);
    }
}

fn import_files(files: &[(&str, &str)]) -> Imported {
    let sources: Vec<Source> = files.iter().map(|(name, text)| Source::from_text(*name, *text)).collect();
    read(&sources, &ImportOptions::default(), &PoseNotation::default(), &mut Unwatched).expect("an import")
}

const TWO_POSES: &str = "no,x,y,z,w,p,r\n1,500,0,300,10,20,170\n2,510,5,300,20,20,170\n";

#[test]
fn no_pose_takes_two_profiles_and_folders_keep_theirs() {
    let profile = |z: i32| format!("x,z\n-1,{z}\n0,{z}\n1,{z}\n");
    let profiles: Vec<String> = (1..=4).map(profile).collect();
    let first_z = |imported: &Imported| -> Vec<f64> {
        let z = |station: &handeye::session::Station| match &station.captures[0].reading {
            Reading::Profile(profile) if !profile.is_empty() => profile.z_mm()[0],
            _ => 0.0,
        };
        imported.stations.iter().map(z).collect()
    };
    let folders = import_files(&[
        ("d1/poses.csv", TWO_POSES),
        ("d1/p1.csv", &profiles[0]),
        ("d1/p2.csv", &profiles[1]),
        ("d2/poses.csv", TWO_POSES),
        ("d2/p1.csv", &profiles[2]),
        ("d2/p2.csv", &profiles[3]),
    ]);
    assert_eq!(first_z(&folders), [1.0, 2.0, 3.0, 4.0]);
    let twice = import_files(&[
        ("poses.csv", TWO_POSES),
        ("left/1.csv", &profiles[0]),
        ("right/1.csv", &profiles[1]),
        ("left/2.csv", &profiles[2]),
    ]);
    assert_eq!(first_z(&twice), [1.0, 3.0]);
    assert!(twice.notes.contains(&Note::ProfilesWithoutPose { names: vec!["right/1.csv".to_owned()] }));
}

#[test]
fn sweeps_end_with_their_source_and_keep_together_under_another_label() {
    let rows = |labels: &[&str]| {
        let row = |(idx, label): (usize, &&str)| format!("{label},{},0,300,10,20,170\n", 500 + idx);
        format!("label,x,y,z,w,p,r\n{}", labels.iter().enumerate().map(row).collect::<String>())
    };
    for (files, expected) in [
        (vec![rows(&["1", "1", "1", "2", "2"]); 2], vec![3, 2, 3, 2]),
        (vec![rows(&["A", "A", "B", "A", "A"])], vec![2, 1, 2]),
        (vec![rows(&["P"]); 3], vec![1, 1, 1]),
    ] {
        let names: Vec<String> = (0..files.len()).map(|idx| format!("f{idx}.csv")).collect();
        let files: Vec<(&str, &str)> = names.iter().map(String::as_str).zip(files.iter().map(String::as_str)).collect();
        let imported = import_files(&files);
        let found: Vec<usize> = imported.stations.iter().map(|station| station.captures.len()).collect();
        assert_eq!(found, expected);
    }
}

#[test]
fn a_session_gets_the_stations_of_the_other_sources() {
    let session = include_str!("../sample_sessions/lin-mu-2019-table-1.json");
    let imported = import_files(&[("a.json", session), ("b.csv", TWO_POSES)]);
    let session = imported.into_session("other".to_owned(), Target::Point).expect("a session");
    assert_eq!((session.stations.len(), session.target), (7, Target::ball(30.0)));
}

#[test]
fn what_is_imported_can_be_saved_and_loaded() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("out.json");
    let table = include_str!("data/import/printed-markdown.md");
    for (files, target, num_stations) in [
        (vec![("b.csv", TWO_POSES)], Target::RightAnglePlate, 2),
        (vec![("table.md", table), ("b.csv", TWO_POSES)], Target::ball(30.0), 7),
    ] {
        let session = import_files(&files).into_session("s".to_owned(), target).expect("a session");
        handeye::session::save(&session, &path).expect("saved");
        assert_eq!(load(&path).expect("loaded").stations.len(), num_stations);
    }
}

#[test]
fn a_number_that_overflows_in_other_units_is_listed() {
    let imported = import_text("p[0.1,0.2,0.3,1e308,0,0]\np[0.1,0.2,0.3,1,0,0]\n");
    assert_eq!((imported.stations.len(), imported.problems[0].line), (1, 1));
}

#[test]
fn units_that_a_header_names_are_those_of_the_numbers() {
    let points = import_text("x,y,z,w,p,r,px [m],py [m],pz [m]\n500,0,300,10,20,170,0.01,0,0.08\n");
    let Reading::Point(point) = &points.stations[0].captures[0].reading else { panic!("a point") };
    assert!((point.x - 10.0).abs() < 1e-12 && (point.z - 80.0).abs() < 1e-12, "{point}");
    let with_profile = |head: &str| {
        import_files(&[
            ("p.csv", &format!("{head}\n-1000,58000,7\n0,57000,8\n1000,58000,9\n")),
            ("poses.csv", "no,x,y,z,w,p,r\n1,500,0,300,10,20,170\n"),
        ])
    };
    let micrometres = with_profile("x [um],z [um],intensity");
    let Reading::Profile(profile) = &micrometres.stations[0].captures[0].reading else { panic!("a profile") };
    assert_eq!(profile.x_mm(), [-1.0, 0.0, 1.0]);
    assert_eq!(with_profile("x [px],z [px],intensity").problems[0].found, "px");
    // W, P and R are FANUC's, who has degrees, however small they are.
    let small = import_text("label,x,y,z,W,P,R\nA,500,0,300,2,0,0\nB,510,0,300,-3,5,0\n,,,,,,\n");
    assert!(small.problems.is_empty(), "{:?}", small.problems);
    let notation = small.options.notation.expect("known");
    assert_eq!(notation.angle_unit, handeye::geometry::notation::AngleUnit::Degrees);
}

#[test]
fn kuka_positions_are_read_in_small_letters() {
    let imported = import_text("decl pos p1={x 500,y 1,z 300,a 10,b 0,c 180}\n");
    assert_eq!(heights(&imported), [("p1", 300.0)]);
}

#[test]
fn a_number_sign_in_a_name_begins_no_comment() {
    let imported =
        import_text("Waypoint #1 = p[0.1,0.2,0.3,1,0,0]\n# p[9,9,9,1,0,0]\nb=p[0.1,0.2,0.4,1,0,0] # p[1,1,1,1,1,1]\n");
    assert_eq!(imported.stations.len(), 2);
}

#[test]
fn a_user_frame_that_is_given_moves_the_poses() {
    let (name, _, _, text) = examples().into_iter().find(|example| example.0 == "scan.ls").expect("an example");
    let sources = [Source::from_text(name, text.replace("UF : 0", "UF : 2"))];
    let plain = read(&sources, &ImportOptions::default(), &PoseNotation::default(), &mut Unwatched).expect("an import");
    assert!(plain.notes.contains(&Note::UserFrameTakenAsBase { frame: "UFRAME 2".to_owned(), num_poses: 2 }));
    let options =
        ImportOptions { base_from_user_frame: Some([100.0, 0.0, 50.0, 0.0, 0.0, 90.0]), ..ImportOptions::default() };
    let moved = read(&sources, &options, &PoseNotation::default(), &mut Unwatched).expect("an import");
    assert!(!moved.notes.iter().any(|note| matches!(note, Note::UserFrameTakenAsBase { .. })));
    let found = moved.stations[0].captures[0].base_from_flange.translation_mm();
    // A quarter turn about z, then the shift.
    let expected = [100.0 + 110.245, 562.415, 50.0 - 139.394];
    assert!(found.iter().zip(expected).all(|(found, expected)| (found - expected).abs() < 1e-9), "{found}");
}

#[test]
fn yaml_gives_poses_with_their_points() {
    let imported = example("stations.yaml");
    check_first(&imported, "A", &[0.5624, -0.1102, 0.1394, 0.0, 0.0, 1.0, 0.0]);
    let Reading::Profile(profile) = &imported.stations[1].captures[0].reading else { panic!("a profile") };
    assert_eq!((profile.x_mm(), profile.z_mm()), ([-1.0, 0.0].as_slice(), [57.2, 57.0].as_slice()));
    let aliases = "a: &a [1, 2]\nb: [*a, *a]\n";
    let sources = [Source::from_text("bomb.yaml", aliases)];
    let refusal = read(&sources, &ImportOptions::default(), &PoseNotation::default(), &mut Unwatched);
    assert_eq!(
        refusal.expect_err("refused").to_string(),
        "bomb.yaml, line 2, column 5: found an alias, expected values that are written out"
    );
}

#[test]
fn a_folder_is_matched_by_the_numbers_in_the_names() {
    let folder = tempfile::tempdir().expect("a folder");
    let put = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::create_dir_all(path.parent().expect("a folder")).expect("made");
        std::fs::write(path, text).expect("written");
    };
    put("poses.csv", "no,x,y,z,w,p,r\n1,500,0,300,10,20,170\n2,510,5,300,20,20,170\n10,520,9,300,30,20,170\n");
    for number in [1, 2, 10] {
        put(&format!("scans/2026-profile{number}.csv"), &format!("x,z\n-1,{number}\n0,\n1,{number}.5\n"));
    }
    put("notes.txt", "Nothing of interest.\n");
    let sources = read_paths(&[folder.path().to_path_buf()]).expect("readable");
    let imported =
        read(&sources, &ImportOptions::default(), &PoseNotation::default(), &mut Unwatched).expect("an import");
    for (station, first_z) in imported.stations.iter().zip([1.0, 2.0, 10.0]) {
        let Reading::Profile(profile) = &station.captures[0].reading else { panic!("a profile") };
        assert_eq!(profile.len(), 3, "station {}", station.label);
        assert!((profile.z_mm()[0] - first_z).abs() < 1e-12 && profile.z_mm()[1].is_nan());
    }
    assert_eq!(imported.notes, [Note::SourcesLeftOut { names: vec!["notes.txt".to_owned()] }]);
}

#[test]
fn what_is_exported_is_imported_the_same() {
    use handeye::session::export::{TableStyle, poses_csv, write_profiles, write_text};
    use handeye::session::import::Separator;
    for name in ["clean-sweeps.json", "lin-mu-2019-table-1.json", "dirty-profiles.json", "plate.json"] {
        for style in [TableStyle::default(), TableStyle { separator: Separator::Semicolon, has_decimal_comma: true }] {
            let mut session = sample(name);
            session.stations[0].label = "#1 \"left\", 1".to_owned();
            session.stations[1].enabled = false;
            let folder = tempfile::tempdir().expect("a folder");
            let table = poses_csv(&session, &session.robot.notation, style);
            write_text(&folder.path().join("poses.csv"), &table, false).expect("written");
            write_profiles(&session, &folder.path().join("profiles"), style, false).expect("written");
            let sources = read_paths(&[folder.path().to_path_buf()]).expect("readable");
            let imported = read(&sources, &ImportOptions::default(), &session.robot.notation, &mut Unwatched);
            let imported = imported.expect("an import");
            assert!(imported.problems.is_empty(), "{name}: {:?}", imported.problems);
            for (found, expected) in imported.stations.iter().zip(&session.stations) {
                assert_eq!(
                    (&found.label, found.enabled, found.side, found.edge),
                    (&expected.label, expected.enabled, expected.side, expected.edge)
                );
                for (found, expected) in found.captures.iter().zip(&expected.captures) {
                    let apart = found.base_from_flange.rotation().angle_to(&expected.base_from_flange.rotation());
                    // The project's promise for angles; numbers are written to the last bit.
                    assert!(apart.to_degrees() < 1e-9, "{apart}");
                    assert_eq!(found.step_mm, expected.step_mm);
                    assert_eq!(found.reading, expected.reading);
                }
            }
            assert_eq!(imported.stations.len(), session.stations.len());
        }
    }
}

/// Names shared by several makers, a tool point, the inverse, other units: the exported table says it all by itself.
#[test]
fn an_exported_table_says_how_its_poses_are_written() {
    use handeye::geometry::notation::{AngleUnit, LengthUnit, OrientationForm};
    use handeye::geometry::{PoseConvention, Vec3, so3};
    use handeye::session::export::{TableStyle, poses_csv};
    use handeye::session::import::Separator;
    let session = sample("clean-sweeps.json");
    let tcp = Transform::from_parts(Vec3::new(0.1, -2.5, 150.25), so3::exp(Vec3::new(0.1, -0.2, 3.0)));
    let mut notations = Vec::new();
    for convention in PoseConvention::all() {
        for is_odd in [false, true] {
            notations.push(PoseNotation {
                angle_unit: if is_odd { AngleUnit::Radians } else { AngleUnit::Degrees },
                length_unit: if is_odd { LengthUnit::Metres } else { LengthUnit::Millimetres },
                flange_from_tcp: is_odd.then_some(tcp),
                is_inverse: is_odd,
                ..PoseNotation::of(convention)
            });
        }
    }
    for orientation in [OrientationForm::QuaternionWxyz, OrientationForm::QuaternionXyzw] {
        notations.push(PoseNotation { orientation, is_inverse: true, ..PoseNotation::default() });
    }
    let spreadsheet = TableStyle { separator: Separator::Semicolon, has_decimal_comma: true };
    for notation in notations {
        for style in [TableStyle::default(), spreadsheet] {
            let imported = import_text(&poses_csv(&session, &notation, style));
            assert_eq!(imported.options.notation, Some(notation));
            for (found, expected) in imported.stations.iter().zip(&session.stations) {
                for (found, expected) in found.captures.iter().zip(&expected.captures) {
                    let (found, expected) = (&found.base_from_flange, &expected.base_from_flange);
                    let apart_mm = (found.translation_mm() - expected.translation_mm()).norm();
                    let apart_rad = so3::log(&(found.rotation().inverse() * expected.rotation())).norm();
                    assert!(
                        apart_mm < 1e-8 && apart_rad < 1e-10,
                        "{}: {apart_mm}, {apart_rad}, {style:?} {found:?} {expected:?}",
                        notation.text()
                    );
                }
            }
            assert_eq!(imported.stations.len(), session.stations.len());
        }
    }
    let unknown = poses_csv(&session, &PoseNotation::default(), TableStyle::default());
    let unknown = import_text(&unknown.replace("fanuc-wpr/", "of-tomorrow/"));
    assert!(unknown.problems[0].found.contains("of-tomorrow"), "{:?}", unknown.problems);
}

#[test]
fn the_edges_of_a_plate_are_read_from_their_column() {
    let table = "label,edge,x,y,z,w,p,r,px,py,pz\na,p,1,2,3,10,20,30,1,0,80\nb,Q,4,5,6,40,50,60,2,0,81\nc,-,7,8,9,15,25,35,3,0,82\n";
    let imported = import_text(table);
    let edges: Vec<Option<Edge>> = imported.stations.iter().map(|station| station.edge).collect();
    assert_eq!(edges, [Some(Edge::P), Some(Edge::Q), None]);
    let plate = imported.into_session("plate".to_owned(), Target::RightAnglePlate).expect("a session");
    let enabled: Vec<bool> = plate.stations.iter().map(|station| station.enabled).collect();
    assert_eq!(enabled, [true, true, false], "of the last nobody knows what it saw");
    let wrong = import_text(&table.replace("b,Q", "b,r"));
    assert_eq!(wrong.problems[0].expected, "an edge of the plate: p or q");
}

#[test]
fn a_session_adds_its_stations_to_another() {
    let text = include_str!("../sample_sessions/lin-mu-2019-table-1.json");
    let sources = ["a.json", "b.json"].map(|name| Source::from_text(name, text));
    let imported =
        read(&sources, &ImportOptions::default(), &PoseNotation::default(), &mut Unwatched).expect("an import");
    assert_eq!((imported.parts[0].kind, imported.stations.len()), (Kind::Session, 10));
}

/// What a file of `tests/data/import` gives: poses, readings, kind, and the first position in millimetres.
#[track_caller]
fn check_file(name: &str, kind: Kind, counts: (usize, usize), num_problems: usize, first_mm: [f64; 3]) -> Imported {
    let imported = import_file(name);
    let part = &imported.parts[0];
    assert_eq!((part.kind, part.num_poses, part.num_readings), (kind, counts.0, counts.1), "{name}");
    assert_eq!(imported.problems.len(), num_problems, "{name}: {:?}", imported.problems);
    let found = imported.stations[0].captures[0].base_from_flange.translation_mm();
    assert!(found.iter().zip(first_mm).all(|(found, expected)| (found - expected).abs() < 1e-3), "{name}: {found}");
    imported
}

#[test]
fn files_of_many_programs_and_countries_are_read() {
    let table = Kind::PoseTable;
    let spaced = check_file("utf16-decimal-comma.csv", table, (2, 0), 0, [562.415, -110.2, 139.4]);
    assert_eq!(spaced.stations[0].label, "P 1");
    assert_eq!(spaced.options.notation.expect("known").convention.id, "kuka-abc");
    check_file("old-mac.tsv", table, (2, 0), 0, [562.4, -110.2, 139.4]);
    check_file("latin-1.csv", table, (2, 0), 0, [562.4, -110.2, 139.4]);
    let sheet = check_file("spreadsheet.csv", table, (2, 0), 0, [562.4, -110.2, 139.4]);
    assert_eq!((sheet.stations[0].enabled, sheet.stations[1].enabled), (true, false));
    let sweep = check_file("sweep.csv", table, (3, 0), 0, [500.0, 0.0, 300.0]);
    assert_eq!(sweep.stations[0].captures.len(), 2);
    assert_eq!(sweep.stations[0].captures[1].step_mm, Some(0.5));
    check_file("units-below.csv", table, (2, 0), 0, [562.4, -110.2, 139.4]);
    // A row of dots says that rows are left out in the paper.
    let plate = check_file("plate-paper.txt", table, (3, 3), 0, [170.208, 4.1677, 102.357]);
    assert_eq!(plate.stations[2].label, "17");
    let groups = check_file("two-groups.ls", Kind::FanucProgram, (1, 0), 0, [100.0, -20.0, 30.0]);
    assert!(groups.notes.contains(&Note::OtherGroups { num_poses: 1 }));
    assert!(groups.notes.contains(&Note::JointPoses { num_poses: 1 }));
    // In the work object, a quarter turn about z.
    check_file("work-object.mod", Kind::AbbModule, (2, 0), 0, [100.0, 500.0, 350.0]);
    // A relative move is no position.
    check_file("inline.src", Kind::KukaProgram, (2, 0), 1, [500.1, -20.5, 300.0]);
    let named = check_file("waypoints.json", Kind::UrScript, (2, 0), 0, [500.0, 100.0, 300.0]);
    assert_eq!(named.stations[1].label, "B");
    check_file("matrices.json", Kind::Yaml, (2, 0), 0, [500.0, 100.0, 300.0]);
    check_file("flat.yaml", Kind::Yaml, (3, 0), 0, [500.0, 0.0, 300.0]);
}

mod command {
    //! The same on the command line.

    use std::path::Path;
    use std::process::{Command, Output};

    use super::data;

    fn handeye(args: &[&str]) -> Output {
        Command::new(env!("CARGO_BIN_EXE_handeye"))
            .args(args)
            .current_dir(env!("CARGO_MANIFEST_DIR"))
            .output()
            .expect("the binary starts")
    }

    #[track_caller]
    fn check(args: &[&str], status: i32, fragments: &[&str]) {
        let output = handeye(args);
        let said = [output.stdout, output.stderr].concat();
        let said = String::from_utf8(said).expect("UTF-8");
        assert_eq!(output.status.code(), Some(status), "{args:?}: {said}");
        if status != 0 {
            assert_eq!(said.trim_end().lines().count(), 1, "{said}");
        }
        for fragment in fragments {
            assert!(said.contains(fragment), "{fragment:?} is not in {said:?}");
        }
    }

    fn text(path: &Path) -> String {
        path.to_str().expect("UTF-8").to_owned()
    }

    #[test]
    fn a_table_of_the_paper_becomes_a_session_that_solves() {
        let folder = tempfile::tempdir().expect("a folder");
        let (table, out) = (text(&data("printed-markdown.md")), text(&folder.path().join("table.json")));
        let import = ["import", table.as_str(), "--out", out.as_str()];
        check(&import, 2, &["--radius-mm"]);
        let with_radius = [&import[..], &["--radius-mm", "30"]].concat();
        check(&with_radius, 0, &["printed table, 5 poses, 5 ", "quaternion w x y z", "5 stations, 5 captures"]);
        check(&with_radius, 2, &["--force"]);
        check(&["solve", &out, "--paper-tables"], 0, &["RMS 0.309 mm", "about (328.6, -48.2, 137.3)"]);
        check(&["import", &table, "--append-to", &out, "--out", &out], 0, &["10 stations"]);
    }

    #[test]
    fn what_cannot_be_read_is_refused_or_skipped_by_name() {
        let folder = tempfile::tempdir().expect("a folder");
        let (table, out) = (folder.path().join("bad.csv"), text(&folder.path().join("out.json")));
        std::fs::write(&table, "x,y,z,w,p,r\n1,2,300,4,5,60\n1,2,oops,4,5,6\n9,8,700,6,5,40\n").expect("written");
        let import = ["import", &text(&table), "--out", &out, "--target", "point"];
        check(&import, 2, &["line 3, column 5: found oops", "--skip-problems"]);
        let skipping = [&import[..], &["--skip-problems", "--notation", "kuka-abc"]].concat();
        check(&skipping, 0, &["left out: bad.csv, line 3", "KUKA A B C", "2 stations"]);
        check(&["import", "no-such.csv", "--out", "x.json"], 2, &["no-such.csv"]);
        check(&["import", "LICENSE-MIT", "--out", "x.json"], 2, &["LICENSE-MIT: found"]);
        check(&["import", "a", "--out", "b", "--columns", "x,y,what"], 2, &["found what"]);
    }

    #[test]
    fn plates_and_tips_go_out_and_come_back_and_a_column_edge_is_never_lost() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = |name: &str| text(&folder.path().join(name));
        let (poses, profiles, out) = (path("poses.csv"), path("profiles"), path("again.json"));
        for (sample, as_what) in [
            ("sample_sessions/plate.json", &[][..]),
            ("sample_sessions/plate.json", &["--target", "plate"]),
            ("sample_sessions/tip.json", &["--target", "point"]),
        ] {
            check(&["export", sample, "--poses", &poses, "--profiles", &profiles, "--force"], 0, &["poses"]);
            let import = ["import", &poses, &profiles, "--out", &out, "--force"];
            check(&[&import[..], as_what].concat(), 0, &["stations"]);
            let load = |path: &str| handeye::session::load(Path::new(path)).expect("a session");
            let (found, expected) = (load(&out), load(sample));
            assert_eq!(found.target, expected.target, "{sample} {as_what:?}");
            for (found, expected) in found.stations.iter().zip(&expected.stations) {
                assert_eq!((found.edge, &found.label), (expected.edge, &expected.label));
                assert_eq!(found.captures[0].reading, expected.captures[0].reading);
            }
            assert_eq!(found.stations.len(), expected.stations.len());
        }
        check(&["export", "sample_sessions/plate.json", "--poses", &poses, "--force"], 0, &["18 poses"]);
        let import = ["import", &poses, "--out", &out, "--force"];
        let meant = "did you mean --target plate?";
        for wrong in [&["--radius-mm", "15"][..], &["--target", "point"], &["--target", "workpiece"]] {
            check(&[&import[..], wrong].concat(), 2, &["found a column edge", meant]);
        }
        check(
            &[&import[..], &["--target", "plate", "--radius-mm", "15"]].concat(),
            2,
            &["--radius-mm: found a radius"],
        );
        let tip = "sample_sessions/tip.json";
        check(&[&import[..], &["--append-to", tip]].concat(), 2, &["found 18 stations with an edge of a plate"]);
    }

    #[test]
    fn a_plate_without_edges_says_what_is_missing() {
        let folder = tempfile::tempdir().expect("a folder");
        let (poses, out) = (text(&folder.path().join("poses.csv")), text(&folder.path().join("plate.json")));
        std::fs::write(&poses, "x,y,z,w,p,r,px,py,pz\n1,2,3,10,20,30,1,0,80\n").expect("written");
        let missing = "edge: found 1 station without one, which take no part until it is set; add a column edge";
        check(&["import", &poses, "--out", &out, "--target", "plate"], 0, &[missing]);
    }

    #[test]
    fn a_session_goes_out_and_comes_back() {
        let folder = tempfile::tempdir().expect("a folder");
        let (poses, profiles) = (text(&folder.path().join("poses.csv")), text(&folder.path().join("profiles")));
        let sample = "sample_sessions/few-rotations.json";
        let semicolons = ["--separator", "semicolon", "--decimal-comma"];
        let export = [&["export", sample, "--poses", &poses, "--profiles", &profiles], &semicolons[..]].concat();
        check(&export, 0, &["poses", "profiles"]);
        check(&export, 2, &["poses.csv", "overwrite"]);
        let out = text(&folder.path().join("again.json"));
        std::fs::copy(sample, &out).expect("copied");
        check(&["export", &out, "--poses", &out, "--force"], 2, &["found a session file"]);
        std::fs::remove_file(&out).expect("removed");
        check(&["import", &poses, &profiles, "--out", &out, "--radius-mm", "15"], 0, &["decimal comma"]);
        let (found, expected) =
            [out.as_str(), sample].map(|file| handeye(&["solve", file, "--method", "ball-bundle"]).stdout).into();
        let answer = |text: Vec<u8>| {
            let text = String::from_utf8(text).expect("UTF-8");
            text.lines().find(|line| line.contains("scatter")).map(str::to_owned)
        };
        assert_eq!(answer(found), answer(expected));
    }
}
