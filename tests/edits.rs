//! Edits of any kind on any session: all or nothing, undone and redone exactly, and always fit to be saved.
#![expect(clippy::expect_used, reason = "a test that finds nothing to check must fail")]
#![expect(clippy::cast_precision_loss, reason = "a handful of stations")]

use std::collections::HashSet;
use std::sync::Arc;

use handeye::calibrate::{Mount, Side, SideChoice};
use handeye::geometry::notation::{AngleUnit, LengthUnit, OrientationForm};
use handeye::geometry::{Base, Flange, PoseConvention, PoseNotation, Profile, Transform, Vec3, so3};
use handeye::session::edit::CellValue;
use handeye::session::{
    Capture, Edge, Edit, FurtherTarget, History, Known, Place, Published, Reading, Row, Session, SetupField, Station,
    Target, WrittenAngles, new_gesture, parse, to_json,
};
use proptest::prelude::*;
use proptest::sample::select;

fn pose() -> impl Strategy<Value = Transform<Base, Flange>> {
    // Some beyond the limit, which is 1 km.
    let coordinate = prop_oneof![80 => -2e3..2e3, 1 => Just(2e6)];
    (prop::array::uniform3(coordinate), prop::array::uniform3(-3.0..3.0)).prop_map(
        |(translation_mm, rotation_vector)| {
            Transform::from_parts(Vec3::from(translation_mm), so3::exp(Vec3::from(rotation_vector)))
        },
    )
}

fn number() -> impl Strategy<Value = f64> {
    prop_oneof![80 => -50.0..50.0, 1 => Just(0.0), 1 => Just(f64::NAN), 1 => Just(f64::INFINITY), 1 => Just(1e9)]
}

fn reading() -> impl Strategy<Value = Reading> {
    let point = prop::array::uniform3(number()).prop_map(|point| Reading::Point(Vec3::from(point)));
    let profile = prop::collection::vec((-50.0..50.0, prop::option::of(-50.0..50.0)), 0..6).prop_map(|points| {
        let (x_mm, z_mm): (Vec<f64>, Vec<Option<f64>>) = points.into_iter().unzip();
        Reading::Profile(Arc::new(Profile::new(x_mm, &z_mm).expect("within limits")))
    });
    prop_oneof![point, profile]
}

fn convention() -> impl Strategy<Value = &'static PoseConvention> {
    let all: Vec<_> = PoseConvention::all().collect();
    (0..all.len()).prop_map(move |idx| all[idx])
}

fn written() -> impl Strategy<Value = Option<WrittenAngles>> {
    prop::option::of(
        (prop::array::uniform3(number()), convention())
            .prop_map(|(angles_deg, convention)| WrittenAngles { angles_deg, convention }),
    )
}

fn label() -> impl Strategy<Value = String> {
    prop_oneof![6 => "[1-5]", 3 => "[a-c]{1,2}", 1 => Just(String::new()), 1 => Just("two\nlines".to_owned())]
}

fn capture() -> impl Strategy<Value = Capture> {
    (pose(), written(), reading(), prop::option::of(number())).prop_map(
        |(base_from_flange, written_angles, reading, step_mm)| Capture {
            base_from_flange,
            written_angles,
            reading,
            step_mm,
            unknown: serde_json::Map::new(),
        },
    )
}

fn side() -> impl Strategy<Value = SideChoice> {
    select(vec![SideChoice::Auto, SideChoice::Given(Side::Plus), SideChoice::Given(Side::Minus)])
}

fn edge() -> impl Strategy<Value = Edge> {
    select(vec![Edge::P, Edge::Q])
}

fn station() -> impl Strategy<Value = Station> {
    (label(), any::<bool>(), side(), prop::option::of(edge()), prop::collection::vec(capture(), 0..4)).prop_map(
        |(label, enabled, side, edge, captures)| Station {
            label,
            enabled,
            side,
            edge,
            captures,
            unknown: serde_json::Map::new(),
        },
    )
}

fn target() -> impl Strategy<Value = Target> {
    prop_oneof![
        (number(), prop::option::of(number()))
            .prop_map(|(radius_mm, radius_std_mm)| Target::Ball { radius_mm, radius_std_mm }),
        Just(Target::RightAnglePlate),
        Just(Target::Point),
        Just(Target::Workpiece),
        Just(Target::Rgbd { sequence: "folder".to_owned() }),
    ]
}

fn known() -> impl Strategy<Value = Known> {
    let point = prop::option::of(prop::array::uniform3(number()).prop_map(Vec3::from));
    let size = || prop_oneof![2 => Just(None), 1 => number().prop_map(Some)];
    (point, size(), size(), size(), size()).prop_map(
        |(point_in_base_mm, angle_deg, pitch_mm, height_mm, diameter_mm)| Known {
            point_in_base_mm,
            angle_deg,
            pitch_mm,
            height_mm,
            diameter_mm,
        },
    )
}

fn further() -> impl Strategy<Value = FurtherTarget> {
    let known = prop_oneof![Just(Known::default()), known()];
    (label(), target(), known, prop::collection::vec(station(), 0..3)).prop_map(|(name, target, known, stations)| {
        FurtherTarget { name, target, known, profile_std_mm: None, stations, unknown: serde_json::Map::new() }
    })
}

fn place() -> impl Strategy<Value = Place> {
    (0..5_usize, prop_oneof![3 => Just(0), 2 => 0..4_usize])
        .prop_map(|(station_idx, capture_idx)| Place { station_idx, capture_idx })
}

fn row() -> impl Strategy<Value = Row> {
    prop_oneof![(0..5_usize).prop_map(Row::Station), place().prop_map(Row::Capture)]
}

fn value() -> impl Strategy<Value = CellValue> {
    prop_oneof![
        any::<bool>().prop_map(CellValue::Used),
        label().prop_map(CellValue::Label),
        side().prop_map(CellValue::Side),
        edge().prop_map(CellValue::Edge),
        (pose(), written()).prop_map(|(pose, written)| CellValue::Pose(pose, written)),
        prop::option::of(number()).prop_map(CellValue::Step),
        reading().prop_map(CellValue::Reading),
    ]
}

fn field() -> impl Strategy<Value = SetupField> {
    let optional = || prop::option::of(number());
    prop_oneof![
        any::<String>().prop_map(SetupField::Name),
        any::<String>().prop_map(SetupField::Notes),
        any::<String>().prop_map(SetupField::RobotModel),
        optional().prop_map(SetupField::PositionStdMm),
        optional().prop_map(SetupField::OrientationStdDeg),
        any::<String>().prop_map(SetupField::SensorModel),
        optional().prop_map(SetupField::ProfileStdMm),
        optional().prop_map(SetupField::ReferenceDistanceMm),
        target().prop_map(SetupField::Target),
        select(vec![Mount::OnFlange, Mount::Fixed]).prop_map(SetupField::Mount),
    ]
}

fn notation() -> impl Strategy<Value = PoseNotation> {
    let orientation =
        select(vec![OrientationForm::Angles, OrientationForm::QuaternionWxyz, OrientationForm::QuaternionXyzw]);
    let angle_unit = select(vec![AngleUnit::Degrees, AngleUnit::Radians]);
    let length_unit = select(vec![LengthUnit::Millimetres, LengthUnit::Metres]);
    let flange_from_tcp = prop::option::of(pose().prop_map(|pose| Transform::from_rigid(*pose.rigid())));
    (convention(), orientation, angle_unit, length_unit, flange_from_tcp, any::<bool>()).prop_map(
        |(convention, orientation, angle_unit, length_unit, flange_from_tcp, is_inverse)| PoseNotation {
            convention,
            orientation,
            angle_unit,
            length_unit,
            flange_from_tcp,
            is_inverse,
        },
    )
}

fn single_edit() -> impl Strategy<Value = Edit> {
    let order = prop_oneof![
        Just((0..4).collect::<Vec<usize>>()).prop_shuffle(),
        Just((0..3).collect::<Vec<usize>>()).prop_shuffle(),
        prop::collection::vec(0..5_usize, 0..5),
    ];
    prop_oneof![
        prop::collection::vec((place(), value()), 0..3).prop_map(Edit::SetCells),
        (0..6_usize, prop::collection::vec(station(), 0..3))
            .prop_map(|(at, stations)| Edit::InsertStations { at, stations }),
        (0..6_usize, capture())
            .prop_map(|(station_idx, capture)| Edit::AppendCapture { station_idx, capture: Box::new(capture) }),
        prop::collection::vec(row(), 0..4).prop_map(Edit::Duplicate),
        prop::collection::vec(row(), 0..4).prop_map(Edit::Remove),
        order.prop_map(Edit::Reorder),
        field().prop_map(Edit::Setup),
        notation().prop_map(Edit::SwitchNotation),
        notation().prop_map(Edit::Reinterpret),
        known().prop_map(Edit::SetKnown),
        prop::option::of(pose().prop_map(|pose| Transform::from_rigid(*pose.rigid()))).prop_map(Edit::SetRoughMounting),
        further().prop_map(|further| Edit::AddFurther(Box::new(further))),
        (0..3_usize).prop_map(Edit::RemoveFurther),
        (0..3_usize, label()).prop_map(|(idx, name)| Edit::RenameFurther(idx, name)),
        (0..3_usize, known()).prop_map(|(idx, known)| Edit::SetFurtherKnown(idx, known)),
        (0..3_usize, prop::collection::vec(0..3_usize, 0..3), any::<bool>())
            .prop_map(|(further_idx, station_idxs, used)| Edit::UseFurtherStations { further_idx, station_idxs, used }),
    ]
}

fn edit() -> impl Strategy<Value = Edit> {
    prop_oneof![
        6 => single_edit(),
        1 => prop::collection::vec(single_edit(), 0..3).prop_map(Edit::Several),
    ]
}

/// A session such as one has while working: stations with different labels, some printed rows.
fn start() -> impl Strategy<Value = Session> {
    (prop::collection::vec(station(), 0..5), any::<bool>(), any::<bool>()).prop_map(
        |(stations, is_published, has_errors)| {
            let empty = Session::new(Target::ball(15.0));
            // Those that cannot stand in a session are left out, one by one.
            let mut session = stations.into_iter().fold(empty, |session, station| {
                let edit = Edit::InsertStations { at: usize::MAX, stations: vec![station] };
                edit.apply(&session).unwrap_or(session)
            });
            if is_published {
                let rows: Vec<Vec3> = (0..session.stations.len()).map(|idx| Vec3::repeat(idx as f64)).collect();
                session.published = Some(Published {
                    error_from_first_mm: if has_errors { rows.clone() } else { Vec::new() },
                    target_in_base_mm: rows,
                    ..Published::default()
                });
            }
            session
        },
    )
}

/// The same sign of every quaternion as files have; a rotation has two.
fn as_saved(session: &Session) -> Session {
    let json = to_json(session);
    let again = parse(json.as_bytes(), "edited.json").unwrap_or_else(|refusal| panic!("{refusal}\n{json}"));
    assert_eq!(to_json(&again), json);
    again
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    #[test]
    fn any_edits_undone_are_the_start_and_redone_the_end(
        start in start(),
        edits in prop::collection::vec((edit(), prop::option::of(0..2_u64)), 0..12),
    ) {
        let start = Arc::new(start);
        let mut history = History::default();
        let mut present = Arc::clone(&start);
        for (edit, gesture) in &edits {
            let before = (*present).clone();
            let outcome = edit.apply(&present);
            prop_assert_eq!(&*present, &before);
            match outcome {
                Ok(changed) if changed != *present => {
                    prop_assert_eq!(&as_saved(&changed), &changed, "after {:?}", edit);
                    let labels: HashSet<&str> = changed.stations.iter().map(|station| station.label.as_str()).collect();
                    prop_assert_eq!(labels.len(), changed.stations.len());
                    let changed = Arc::new(changed);
                    history.record("edit", *gesture, Arc::clone(&present), &changed);
                    present = changed;
                }
                Ok(_) => {}
                Err(refusal) => {
                    let sentence = refusal.to_string();
                    prop_assert!(!sentence.contains('\n') && sentence.contains("found"), "{}", sentence);
                }
            }
        }
        let end = Arc::clone(&present);
        let num_steps = history.undo_labels().len();
        while let Some(session) = history.undo(Arc::clone(&present)) {
            prop_assert!(*session != *present, "a step that changes nothing");
            present = session;
        }
        prop_assert_eq!(&present, &start);
        prop_assert_eq!(history.redo_labels().len(), num_steps);
        while let Some(session) = history.redo(Arc::clone(&present)) {
            present = session;
        }
        prop_assert_eq!(&present, &end);
    }

    #[test]
    fn several_edits_as_one_are_the_edits_one_by_one(start in start(), edits in prop::collection::vec(single_edit(), 0..4)) {
        let one_by_one = edits.iter().try_fold(start.clone(), |session, edit| edit.apply(&session));
        let at_once = Edit::Several(edits).apply(&start);
        prop_assert_eq!(at_once.is_ok(), one_by_one.is_ok());
        if let (Ok(at_once), Ok(one_by_one)) = (at_once, one_by_one) {
            prop_assert_eq!(at_once, one_by_one);
        }
    }
}

/// Stations `1`, `2`, … with so many captures each; a capture's place is in its reading.
fn session(num_captures: &[usize]) -> Session {
    let stations = num_captures.iter().enumerate().map(|(station_idx, num_captures)| Station {
        label: (station_idx + 1).to_string(),
        enabled: true,
        side: SideChoice::Auto,
        edge: None,
        captures: (0..*num_captures)
            .map(|capture_idx| Capture {
                base_from_flange: Transform::identity(),
                written_angles: None,
                reading: Reading::Point(Vec3::new(station_idx as f64, capture_idx as f64, 0.0)),
                step_mm: None,
                unknown: serde_json::Map::new(),
            })
            .collect(),
        unknown: serde_json::Map::new(),
    });
    let stations: Vec<Station> = stations.collect();
    let rows: Vec<Vec3> = (0..stations.len()).map(|idx| Vec3::repeat(idx as f64)).collect();
    let published = Published { target_in_base_mm: rows.clone(), error_from_first_mm: rows, ..Published::default() };
    Session { stations, published: Some(published), ..Session::new(Target::ball(15.0)) }
}

/// The session in short: each station's label, the places that its captures had, and the printed row behind `|`.
fn in_short(session: &Session) -> String {
    let printed = session.published.as_ref().map_or(&[][..], |published| &published.target_in_base_mm);
    let station = |(idx, station): (usize, &Station)| {
        let places = station.captures.iter().map(|capture| match capture.reading {
            Reading::Point(point) => format!("{}{}", point.x, point.y),
            Reading::Pose(seen) => format!("{}", seen.translation_mm()),
            Reading::Profile(_) => "profile".to_owned(),
        });
        let row = printed.get(idx).map_or_else(String::new, |row| format!("|{}", row.x));
        format!("{}:{}{row}", station.label, places.collect::<Vec<_>>().join(","))
    };
    session.stations.iter().enumerate().map(station).collect::<Vec<_>>().join(" ")
}

fn capture_row(station_idx: usize, capture_idx: usize) -> Row {
    Row::Capture(Place { station_idx, capture_idx })
}

#[track_caller]
fn check(num_captures: &[usize], edit: &Edit, expected: Result<&str, &str>) {
    let outcome = edit.apply(&session(num_captures));
    let outcome = outcome.as_ref().map(in_short).map_err(ToString::to_string);
    assert_eq!(outcome.as_deref().map_err(String::as_str), expected, "{edit:?}");
}

#[test]
fn rows_are_duplicated_removed_and_reordered_with_what_was_printed_for_them() {
    use Row::Station as S;
    let c = capture_row;
    for (rows, expected) in [
        (vec![S(0)], "1:00|0 3:00|0 2:10,11|1"),
        (vec![S(1), S(0), S(1)], "1:00|0 4:00|0 2:10,11|1 3:10,11|1"),
        (vec![c(1, 0)], "1:00|0 2:10,10,11|1"),
        (vec![c(1, 0), c(1, 1)], "1:00|0 2:10,10,11,11|1"),
        // A station with captures of its own selected: both are copies of what was there.
        (vec![S(1), c(1, 1)], "1:00|0 2:10,11,11|1 3:10,11|1"),
        (vec![], "1:00|0 2:10,11|1"),
    ] {
        check(&[1, 2], &Edit::Duplicate(rows), Ok(expected));
    }
    for (rows, expected) in [
        (vec![S(0)], "2:10,11|1 3:20|2"),
        (vec![S(2), S(0)], "2:10,11|1"),
        (vec![c(1, 0)], "1:00|0 2:11|1 3:20|2"),
        // Without captures a station goes as well, and its printed row with it.
        (vec![c(1, 1), c(1, 0)], "1:00|0 3:20|2"),
        (vec![c(0, 0), c(0, 0)], "2:10,11|1 3:20|2"),
        (vec![S(1), c(1, 0)], "1:00|0 3:20|2"),
        (vec![S(0), S(1), S(2)], ""),
    ] {
        check(&[1, 2, 1], &Edit::Remove(rows), Ok(expected));
    }
    check(&[1, 2], &Edit::Reorder(vec![1, 0]), Ok("2:10,11|1 1:00|0"));
}

#[test]
fn refusals_say_what_was_found() {
    let c = capture_row;
    let set = |station_idx, capture_idx, value| Edit::SetCells(vec![(Place { station_idx, capture_idx }, value)]);
    let gone = "found no capture 3 of station 2; it may have been removed";
    for edit in
        [Edit::Remove(vec![Row::Station(0), c(1, 2)]), Edit::Duplicate(vec![c(1, 2)]), set(1, 2, CellValue::Step(None))]
    {
        check(&[1, 2], &edit, Err(gone));
    }
    for (edit, expected) in [
        (set(0, 0, CellValue::Label("2".to_owned())), "found the label \"2\" twice; each station needs one of its own"),
        (
            set(0, 0, CellValue::Label(" ".to_owned())),
            "found a label that is empty or runs over a line's end; type some text on one line",
        ),
        (set(0, 0, CellValue::Step(Some(1e9))), "found 1000000000, needed a move in mm from -100000 to 100000"),
        (Edit::Reorder(vec![0, 0]), "found an order of 2 stations, needed each of the 2 once"),
    ] {
        check(&[1, 2], &edit, Err(expected));
    }
}

#[test]
fn a_capture_goes_behind_those_of_its_station() {
    let capture = session(&[1]).stations[0].captures[0].clone();
    let append = |station_idx| Edit::AppendCapture { station_idx, capture: Box::new(capture.clone()) };
    check(&[1, 2], &append(1), Ok("1:00|0 2:10,11,00|1"));
    check(&[1], &append(1), Err("found no capture 1 of station 2; it may have been removed"));
}

#[test]
fn labels_may_change_places_in_one_edit() {
    let relabel =
        |station_idx, label: &str| (Place { station_idx, capture_idx: 0 }, CellValue::Label(label.to_owned()));
    check(&[1, 1], &Edit::SetCells(vec![relabel(0, "2"), relabel(1, "1")]), Ok("2:00|0 1:10|1"));
}

#[test]
fn added_stations_get_free_labels_and_end_what_was_printed() {
    let added = session(&[1, 1]).stations;
    check(&[1], &Edit::InsertStations { at: 0, stations: added }, Ok("2:00 3:10 1:00"));
    check(&[1], &Edit::InsertStations { at: 9, stations: Vec::new() }, Ok("1:00|0"));
}

#[test]
fn many_labels_that_are_taken_are_numbered_on() {
    let mut present = session(&[1; 3]);
    for (station, label) in present.stations.iter_mut().zip(["4294967295", "a", "a (2)"]) {
        station.label = label.to_owned();
    }
    let rows: Vec<Row> = (0..3).map(Row::Station).collect();
    let copied = Edit::Duplicate(rows).apply(&present).expect("copied");
    let labels: Vec<&str> = copied.stations.iter().map(|station| station.label.as_str()).collect();
    assert_eq!(labels, ["4294967295", "4294967295 (2)", "a", "a (3)", "a (2)", "a (2) (2)"]);
}

#[test]
fn stations_of_a_plate_that_do_not_say_their_edge_take_no_part() {
    let plate = Edit::Setup(SetupField::Target(Target::RightAnglePlate)).apply(&session(&[1, 1])).expect("a plate");
    let added = session(&[1]).stations;
    let more = Edit::InsertStations { at: 9, stations: added }.apply(&plate).expect("added");
    assert_eq!(more.stations.len(), 3);
    assert!(more.stations.iter().all(|station| station.edge == Some(Edge::P) && !station.enabled));
    assert_eq!(parse(to_json(&more).as_bytes(), "plate").expect("can be saved"), more);
}

/// A tip of this name with so many stations, all of the same label.
fn tip(name: &str, num_stations: usize) -> Edit {
    let stations = session(&vec![1; num_stations]).stations;
    let stations = stations.into_iter().map(|station| Station { label: "a".to_owned(), ..station }).collect();
    Edit::AddFurther(Box::new(FurtherTarget {
        name: name.to_owned(),
        target: Target::Point,
        known: Known::default(),
        profile_std_mm: None,
        stations,
        unknown: serde_json::Map::new(),
    }))
}

#[test]
fn further_targets_are_added_named_used_and_removed() {
    let touched = Known { point_in_base_mm: Some(Vec3::new(1.0, 2.0, 3.0)), ..Known::default() };
    let use_second = |used| Edit::UseFurtherStations { further_idx: 1, station_idxs: vec![1], used };
    let edits = [tip("tip", 1), tip("tip", 2), Edit::RenameFurther(0, "old tip".to_owned()), use_second(false)];
    let edits = [&edits[..], &[Edit::SetFurtherKnown(1, touched)]].concat();
    let with_two = Edit::Several(edits).apply(&session(&[1])).expect("all fit");
    let names: Vec<&str> = with_two.further.iter().map(|further| further.name.as_str()).collect();
    assert_eq!(names, ["old tip", "tip (2)"]);
    let labels: Vec<&str> = with_two.further[1].stations.iter().map(|station| station.label.as_str()).collect();
    assert_eq!(labels, ["a", "a (2)"]);
    assert!(with_two.further[1].stations[0].enabled && !with_two.further[1].stations[1].enabled);
    assert_eq!(with_two.further[1].known, touched);
    let with_one = Edit::RemoveFurther(0).apply(&with_two).expect("there");
    assert_eq!(with_one.further, with_two.further[1..]);
    for (edit, expected) in [
        (Edit::RemoveFurther(2), "found no further target 3; it may have been removed"),
        (
            Edit::UseFurtherStations { further_idx: 0, station_idxs: vec![4], used: true },
            "found no station 5 of the further target old tip; it may have been removed",
        ),
        (
            Edit::RenameFurther(0, "tip (2)".to_owned()),
            "found the name \"tip (2)\" twice; each further target needs one of its own",
        ),
        (
            Edit::SetKnown(touched),
            "found touched_in_base_mm, which a target of this kind does not have; needed nothing",
        ),
        (
            Edit::SetFurtherKnown(0, Known { pitch_mm: Some(15.0), ..Known::default() }),
            "found pitch_mm, which a target of this kind does not have; needed touched_in_base_mm or nothing",
        ),
    ] {
        assert_eq!(edit.apply(&with_two).expect_err("refused").to_string(), expected);
    }
}

#[test]
fn another_session_gives_all_of_its_targets() {
    let other = Edit::Several(vec![tip("teeth", 1), tip("tip", 2)]).apply(&session(&[1, 1])).expect("fits");
    let here = tip("tip", 1).apply(&session(&[1])).expect("fits");
    let edit = handeye::report::verification::adding_targets_of(other.clone(), "part");
    assert_eq!(handeye::text::edits::edit_label(&edit, &here), "add 3 targets");
    let all = edit.apply(&here).expect("fits");
    let sizes: Vec<(&str, usize)> =
        all.further.iter().map(|further| (further.name.as_str(), further.stations.len())).collect();
    assert_eq!(sizes, [("tip", 1), ("part", 2), ("teeth", 1), ("tip (2)", 2)]);
    assert_eq!(all.further[2].known, other.further[0].known);
}

#[test]
fn what_is_known_of_a_target_goes_with_its_kind() {
    let known = Known { pitch_mm: Some(15.0), ..Known::default() };
    let to = |target| Edit::Setup(SetupField::Target(target));
    let piece = Edit::Several(vec![to(Target::Workpiece), Edit::SetKnown(known)]).apply(&session(&[])).expect("fits");
    assert_eq!(piece.known, known);
    assert_eq!(to(Target::Point).apply(&piece).expect("fits").known, Known::default());
}

/// A bench of one number, to look at the history alone.
struct Numbered {
    history: History,
    present: Arc<Session>,
}

impl Numbered {
    fn new() -> Self {
        Self { history: History::default(), present: Arc::new(Session::new(Target::ball(1.0))) }
    }

    fn set(&mut self, radius_mm: f64, gesture: Option<u64>) {
        let edit = Edit::Setup(SetupField::Target(Target::ball(radius_mm)));
        let changed = Arc::new(edit.apply(&self.present).expect("a radius"));
        self.history.record(format!("to {radius_mm}"), gesture, Arc::clone(&self.present), &changed);
        self.present = changed;
    }

    fn undo(&mut self) {
        self.present = self.history.undo(Arc::clone(&self.present)).expect("a step");
    }

    fn labels(&self) -> (Vec<&str>, Vec<&str>) {
        (self.history.undo_labels().collect(), self.history.redo_labels().collect())
    }
}

#[test]
fn strokes_of_one_gesture_are_one_step() {
    let (first, second) = (Some(new_gesture()), Some(new_gesture()));
    let mut bench = Numbered::new();
    for radius_mm in [2.0, 3.0, 4.0] {
        bench.set(radius_mm, first);
    }
    assert_eq!(bench.labels(), (vec!["to 2"], vec![]));
    bench.set(5.0, second);
    bench.set(6.0, None);
    bench.set(7.0, None);
    assert_eq!(bench.labels(), (vec!["to 2", "to 5", "to 6", "to 7"], vec![]));
    // Another edit came in between: the gesture begins a new step.
    bench.set(8.0, first);
    assert_eq!(bench.labels().0.len(), 5);
    bench.undo();
    bench.undo();
    assert_eq!(bench.labels(), (vec!["to 2", "to 5", "to 6"], vec!["to 7", "to 8"]));
    // After an undo as well, and what was undone is forgotten.
    bench.set(9.0, first);
    bench.set(10.0, first);
    assert_eq!(bench.labels(), (vec!["to 2", "to 5", "to 6", "to 9"], vec![]));
}

#[test]
fn a_gesture_that_ends_where_it_began_leaves_no_step() {
    let gesture = Some(new_gesture());
    let mut bench = Numbered::new();
    for radius_mm in [2.0, 3.0, 1.0] {
        bench.set(radius_mm, gesture);
    }
    assert_eq!(bench.labels(), (vec![], vec![]));
    bench.set(4.0, gesture);
    assert_eq!(bench.labels().0, ["to 4"]);
    bench.undo();
    assert_eq!(bench.present.target, Target::ball(1.0));
}

#[test]
fn the_oldest_steps_are_forgotten() {
    let mut bench = Numbered::new();
    for step in 0..250_u32 {
        bench.set(f64::from(step) + 2.0, None);
    }
    assert_eq!(bench.history.undo_labels().len(), 200);
    assert!(!bench.history.is_complete());
    assert_eq!(bench.history.undo_labels().next(), Some("to 52"));
}
