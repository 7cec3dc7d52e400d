//! The table as plain code: cells, blocks, orders and fills of a small session.

use std::sync::Arc;

use super::block::{MAX_CELLS, TooManyCells, block_text, is_for_import};
use super::fill::{fill_down, next_label};
use super::order::{natural, order_by};
use super::paste::{Spot, paste};
use super::*;
use crate::geometry::{PoseConvention, Profile, Transform, so3};
use crate::session::edit::CellValue;
use crate::session::{Edit, parse, samples};

/// Five stations with one pose and one reduced point each, labels 1 to 5, FANUC angles.
fn printed() -> Session {
    let sample = samples::ALL.iter().find(|sample| sample.file_name == "lin-mu-2019-table-1.json").expect("a sample");
    parse(sample.json.as_bytes(), sample.file_name).expect("a session")
}

fn parse_block(text: &str) -> Vec<Vec<String>> {
    super::block::parse_block(text).expect("few cells")
}

/// What a session becomes if a text is pasted into its folded table.
fn pasted_into(session: &Session, row_idx: usize, column: Column, text: &str) -> (Session, super::paste::Pasted) {
    let (rows, columns) = (rows(session, |_| false), columns(session));
    let column_idx = columns.iter().position(|there| *there == column).expect("a column");
    let pasted = paste(session, &Spot { rows: &rows, columns: &columns, row_idx, column_idx }, &parse_block(text));
    let changed = pasted.edit.as_ref().map_or_else(|| session.clone(), |edit| edit.apply(session).expect("an edit"));
    (changed, pasted)
}

fn place(station_idx: usize) -> Place {
    Place { station_idx, capture_idx: 0 }
}

fn typed(station_idx: usize, column: Column, text: &str) -> TypedCell {
    TypedCell { place: place(station_idx), column, text: text.to_owned() }
}

fn read(session: &Session, cells: &[(usize, Column, &str)]) -> ReadCells {
    let cells: Vec<TypedCell> = cells.iter().map(|(idx, column, text)| typed(*idx, *column, text)).collect();
    read_cells(session, &cells)
}

#[test]
fn the_text_of_a_cell_read_again_changes_nothing() {
    for notation in notations() {
        let mut session = printed();
        session.robot.notation = notation;
        let columns = columns(&session);
        let mut cells = Vec::new();
        for station_idx in 0..session.stations.len() {
            for column in &columns {
                cells.push(typed(station_idx, *column, &text(&session, place(station_idx), *column)));
            }
        }
        let read = read_cells(&session, &cells);
        assert_eq!(read.refused, [], "{notation:?}");
        let again = Edit::SetCells(read.values).apply(&session).expect("it is what was there");
        for (before, after) in session.stations.iter().zip(&again.stations) {
            let (before, after) = (&before.captures[0].base_from_flange, &after.captures[0].base_from_flange);
            // Half of the last digit kept: 1e-11 rad, and that at an arm's length where the pose is written inverted.
            assert!((before.translation_mm() - after.translation_mm()).norm() < 1e-8, "{notation:?}");
            let half_angle_rad = (before.rotation().inverse() * after.rotation()).imag().norm();
            assert!(half_angle_rad < 2e-11, "{notation:?}: {half_angle_rad}");
        }
    }
}

fn notations() -> Vec<PoseNotation> {
    use crate::geometry::notation::AngleUnit;
    let plain = PoseNotation::of(PoseConvention::default_convention());
    let tool = Transform::from_parts(Vec3::new(1.0, -2.0, 150.0), so3::exp(Vec3::new(0.1, 0.2, -0.3)));
    vec![
        plain,
        PoseNotation { orientation: OrientationForm::QuaternionWxyz, ..plain },
        PoseNotation { orientation: OrientationForm::QuaternionXyzw, length_unit: LengthUnit::Metres, ..plain },
        PoseNotation { angle_unit: AngleUnit::Radians, length_unit: LengthUnit::Metres, ..plain },
        PoseNotation { flange_from_tcp: Some(tool), ..plain },
        PoseNotation { is_inverse: true, ..plain },
    ]
}

#[test]
fn texts_are_short() {
    for (value, expected) in
        [(0.1 + 0.2, "0.3"), (-0.0, "0"), (-1e-12, "0"), (100.0, "100"), (1.0 / 3.0, "0.333333333")]
    {
        assert_eq!(number_text(value, 9), expected);
    }
}

#[test]
fn one_number_of_a_pose_leaves_the_others_as_they_are() {
    let session = printed();
    let before = &session.stations[1].captures[0];
    let read = read(&session, &[(1, Column::Number(0), "512,5"), (1, Column::Number(1), "abc")]);
    assert_eq!(read.refused.len(), 1);
    let [(at, CellValue::Pose(pose, written))] = &read.values[..] else { panic!("{:?}", read.values) };
    assert_eq!((*at, *written), (place(1), before.written_angles));
    assert_eq!(pose.rotation(), before.base_from_flange.rotation());
    let expected =
        Vec3::new(512.5, before.base_from_flange.translation_mm().y, before.base_from_flange.translation_mm().z);
    assert!((pose.translation_mm() - expected).norm() < 1e-12);
}

#[test]
fn angles_stay_as_they_were_typed_even_in_gimbal_lock() {
    let session = printed();
    let read =
        read(&session, &[(0, Column::Number(3), "10"), (0, Column::Number(4), "90"), (0, Column::Number(5), "30")]);
    let changed = Edit::SetCells(read.values).apply(&session).expect("a pose");
    assert_eq!([3, 4, 5].map(|idx| text(&changed, place(0), Column::Number(idx))), ["10", "90", "30"]);
}

#[test]
fn a_quaternion_is_taken_as_a_whole() {
    let mut session = printed();
    session.robot.notation.orientation = OrientationForm::QuaternionWxyz;
    let half = |text: &'static str| [3, 4, 5, 6].map(|idx| (0, Column::Number(idx), text));
    let one = read(&session, &[(0, Column::Number(0), "7"), (0, Column::Number(3), "0.5")]);
    assert!(matches!(one.refused[0].reason, CellProblem::NotARotation { .. }), "{:?}", one.refused);
    assert_eq!(one.values.len(), 1, "the position does not wait for it");
    assert_eq!(read(&session, &half("0.5")).refused, []);
    let mut broken = half("0.5");
    broken[2].2 = "half";
    let broken = read(&session, &broken);
    assert!(broken.values.is_empty());
    assert_eq!(broken.refused.len(), 4);
}

#[test]
fn points_are_all_or_nothing_and_never_replace_a_profile() {
    let mut session = printed();
    let clear = [0, 1, 2].map(|axis| (0, Column::Point(axis), ""));
    let [(_, CellValue::Reading(reading))] = &read(&session, &clear).values[..] else { panic!("cleared") };
    assert_eq!(*reading, Reading::Profile(Arc::new(Profile::default())));
    session.stations[0].captures[0].reading = reading.clone();
    let part = read(&session, &[(0, Column::Point(0), "1")]);
    assert_eq!(part.refused[0].reason, CellProblem::PointIncomplete);
    let whole = [0, 1, 2].map(|axis| (0, Column::Point(axis), "1,5"));
    assert_eq!(read(&session, &whole).values.len(), 1);
    let profile = Profile::new(vec![0.0], &[Some(80.0)]).expect("valid");
    session.stations[0].captures[0].reading = Reading::Profile(Arc::new(profile));
    let kept = read(&session, &whole);
    assert!(kept.values.is_empty());
    assert!(matches!(kept.refused[0].reason, CellProblem::HasProfile { num_points: 1 }));
    assert_eq!(read(&session, &clear), ReadCells::default(), "nothing to clear");
}

#[test]
fn labels_may_change_places_but_not_be_shared() {
    let session = printed();
    let swapped = read(&session, &[(0, Column::Label, "2"), (1, Column::Label, " 1 ")]);
    assert_eq!((swapped.values.len(), swapped.refused.len()), (2, 0));
    let shared = read(&session, &[(0, Column::Label, "3"), (1, Column::Label, "b")]);
    assert_eq!(shared.values, [(place(1), CellValue::Label("b".to_owned()))]);
    assert!(matches!(shared.refused[0].reason, CellProblem::Label(_)));
    // One that is refused keeps its own label, which the other then cannot have.
    let chain = read(&session, &[(0, Column::Label, "3"), (1, Column::Label, "1")]);
    assert_eq!((chain.values.len(), chain.refused.len()), (0, 2));
    assert_eq!(read(&session, &[(0, Column::Label, " ")]).refused.len(), 1);
}

#[test]
fn words_for_use_side_and_edge() {
    let session = printed();
    let value = |column, text| read(&session, &[(0, column, text)]);
    for text in ["no", "0", "FALSE", "nein", "falsch"] {
        assert_eq!(value(Column::Used, text).values, [(place(0), CellValue::Used(false))], "{text}");
    }
    for text in ["-", "−", "minus"] {
        assert_eq!(value(Column::Side, text).values.len(), 1, "{text}");
    }
    assert_eq!(value(Column::Edge, "Q").values, [(place(0), CellValue::Edge(Edge::Q))]);
    for (column, text) in
        [(Column::Used, "perhaps"), (Column::Side, "left"), (Column::Edge, "r"), (Column::Step, "1..2")]
    {
        assert_eq!(value(column, text).refused.len(), 1, "{text}");
    }
    let beyond = read(&session, &[(0, Column::Number(0), "1e9"), (0, Column::Number(9), "1"), (9, Column::Label, "x")]);
    assert_eq!((beyond.values.len(), beyond.refused.len()), (0, 3));
}

#[test]
fn blocks_of_any_spreadsheet() {
    let rows = |text: &str| parse_block(text);
    assert_eq!(rows("1\t2\r\n3\t\r\n"), [["1", "2"], ["3", ""]]);
    assert_eq!(rows("1,5\t2,5"), [["1,5", "2,5"]]);
    assert_eq!(rows("1,5;2,5\n"), [["1,5", "2,5"]]);
    assert_eq!(rows("1.5,2.5\n3.5,4.5"), [["1.5", "2.5"], ["3.5", "4.5"]]);
    assert_eq!(rows("12,5"), [["12,5"]]);
    assert_eq!(rows("\"a\tb\"\t\"c\"\"d\"\n"), [["a\tb", "c\"d"]]);
    assert_eq!(rows("a\rb"), [["a"], ["b"]]);
    for one in ["1,234.5", "1.234,5", "1,234.5 mm"] {
        assert_eq!(rows(one), [[one]]);
    }
    assert_eq!(rows("1,234.5\n2,345.6\n"), [["1,234.5"], ["2,345.6"]]);
    for separator in ["\t", "\n"] {
        assert_eq!(super::block::parse_block(&separator.repeat(MAX_CELLS)), Err(TooManyCells));
    }
    assert_eq!(rows(""), [[""]]);
    let block = vec![vec!["a\tb".to_owned(), "\"c".to_owned()], vec![String::new(), "d e".to_owned()]];
    assert_eq!(parse_block(&block_text(&block)), block);
    assert!(is_for_import("q_0=0.5") && is_for_import("p[1,2,3,0,0,0]") && !is_for_import("1\t2\t3"));
}

#[test]
fn a_pasted_block_overwrites_adds_and_names_what_it_cannot_read() {
    let session = printed();
    let (rows, columns) = (rows(&session, |_| false), columns(&session));
    let spot = Spot { rows: &rows, columns: &columns, row_idx: 4, column_idx: 3 };
    let block = parse_block("1\t2\t3\t10\t20\t30\n4\t5\t6\t1\t2\t3\n7\toops\t9");
    let pasted = paste(&session, &spot, &block);
    assert_eq!(pasted.held_back, ["7"]);
    let refused: Vec<(&str, Column)> =
        pasted.refused.iter().map(|(label, refused)| (label.as_str(), refused.cell.column)).collect();
    assert_eq!(refused, [1, 3, 4, 5].map(|idx| ("7", Column::Number(idx))));
    let changed = pasted.edit.expect("an edit").apply(&session).expect("it can be made");
    assert_eq!(changed.stations.len(), 7);
    assert_eq!(text(&changed, place(4), Column::Number(1)), "2");
    assert_eq!(text(&changed, place(5), Column::Number(5)), "3");
    assert_eq!(changed.stations.iter().filter(|station| station.enabled).count(), 6);
}

#[test]
fn names_in_the_first_line_say_where_columns_go() {
    let session = printed();
    let (rows, columns) = (rows(&session, |_| false), columns(&session));
    let spot = Spot { rows: &rows, columns: &columns, row_idx: 0, column_idx: 5 };
    let pasted = paste(&session, &spot, &parse_block("z (mm)\tcomment\tstation\n7\tgood\tA\n8\tbad\tB\n"));
    assert_eq!((pasted.refused.len(), pasted.num_left_out), (0, 2));
    let changed = pasted.edit.expect("an edit").apply(&session).expect("it can be made");
    assert_eq!(changed.stations[1].label, "B");
    assert_eq!(text(&changed, place(0), Column::Number(2)), "7");
}

#[test]
fn labels_sort_as_people_count() {
    let mut labels = ["s10", "S2", "s1", "b", "10", "9", "s02"];
    labels.sort_by(|a, b| natural(a, b));
    assert_eq!(labels, ["9", "10", "b", "s1", "S2", "s02", "s10"]);
    let session = printed();
    let by_x = order_by(&session, Column::Number(0), false);
    let x = |idx: usize| number(&session, place(idx), Column::Number(0)).expect("a number");
    assert!(by_x.windows(2).all(|pair| x(pair[0]) <= x(pair[1])));
    assert_eq!(order_by(&session, Column::Number(0), true), by_x.into_iter().rev().collect::<Vec<_>>());
}

#[test]
fn those_without_a_value_come_last_either_way() {
    let mut session = printed();
    session.stations[2].captures[0].step_mm = Some(1.0);
    session.stations[4].captures[0].step_mm = Some(-1.0);
    assert_eq!(order_by(&session, Column::Step, false), [4, 2, 0, 1, 3]);
    assert_eq!(order_by(&session, Column::Step, true), [2, 4, 0, 1, 3]);
}

#[test]
fn filling_down_counts_labels_on() {
    let session = printed();
    let rows: Vec<Row> = [0, 1, 2].map(Row::Station).to_vec();
    let filled = fill_down(&session, &rows, &[Column::Label, Column::Number(2)]);
    let texts: Vec<&str> = filled.iter().map(|cell| cell.text.as_str()).collect();
    // 2 and 3 are their own, so they may have them; 4 and 5 belong to others.
    assert_eq!(&texts[..2], ["2", "3"]);
    assert_eq!(texts[2], text(&session, place(0), Column::Number(2)));
    for (label, next) in [("9", "10"), ("A09", "A10"), ("cell 3-7", "cell 3-8"), ("left", "left 2")] {
        assert_eq!(next_label(label), next);
    }
}

#[test]
fn sweeps_unfold_into_the_rows_of_their_captures() {
    let sample = samples::ALL.iter().find(|sample| sample.file_name == "few-rotations.json").expect("a sample");
    let session = parse(sample.json.as_bytes(), sample.file_name).expect("a session");
    assert_eq!(rows(&session, |_| false).len(), session.stations.len());
    let label = session.stations[1].label.clone();
    let unfolded = rows(&session, |station| station.label == label);
    let num_captures = session.stations[1].captures.len();
    assert_eq!(unfolded.len(), session.stations.len() + num_captures);
    assert_eq!(unfolded[1..3], [Row::Station(1), Row::Capture(Place { station_idx: 1, capture_idx: 0 })]);
    assert!(has_cell(&session, unfolded[1], Column::Side) && !has_cell(&session, unfolded[1], Column::Number(0)));
    assert!(!has_cell(&session, unfolded[2], Column::Side) && has_cell(&session, unfolded[2], Column::Number(0)));
    let pasted = paste(
        &session,
        &Spot { rows: &unfolded, columns: &columns(&session), row_idx: 1, column_idx: 3 },
        &parse_block("1\n2"),
    );
    assert_eq!(pasted.num_left_out, 1, "a sweep has no pose of its own");
}

#[test]
fn pasted_labels_may_change_places_with_those_of_new_stations() {
    let (changed, pasted) = pasted_into(&printed(), 0, Column::Label, "6\n5\n4\n3\n2\n1");
    let labels: Vec<&str> = changed.stations.iter().map(|station| station.label.as_str()).collect();
    assert_eq!(labels, ["6", "5", "4", "3", "2", "1"]);
    assert!(pasted.refused.iter().all(|(label, _)| label == "1"), "its pose is missing");
}

#[test]
fn units_are_converted_or_refused() {
    let session = printed();
    let x = Column::Number(0);
    for (text, expected) in [("0.5 m", "500"), ("12 mm", "12"), ("7", "7")] {
        assert_eq!(super::text(&pasted_into(&session, 1, x, text).0, place(1), x), expected, "{text}");
    }
    let angle = Column::Number(3);
    let (changed, _) = pasted_into(&session, 1, angle, "0.5 rad");
    let shown = number(&changed, place(1), angle).expect("an angle");
    assert!((shown - 0.5_f64.to_degrees()).abs() < 1e-9, "{shown}");
    for (column, text) in [(x, "5°"), (x, "5 rad"), (angle, "5 mm"), (x, "5 kg")] {
        assert_eq!(read(&session, &[(1, column, text)]).refused.len(), 1, "{text}");
    }
    let (changed, pasted) = pasted_into(&session, 0, Column::Label, "x (m)\ty (m)\n0.1\t0.2\n0.3\t400 mm");
    assert_eq!(pasted.refused, []);
    let shown =
        [(0, 0), (0, 1), (1, 0), (1, 1)].map(|(row, idx)| super::text(&changed, place(row), Column::Number(idx)));
    assert_eq!(shown, ["100", "200", "300", "400"]);
    let (_, pasted) = pasted_into(&session, 0, Column::Label, "x (in)\ty (rad)\n1\t2");
    assert_eq!(pasted.refused.len(), 2);
}

#[test]
fn one_word_alone_is_a_value_unless_it_names_its_column() {
    let session = printed();
    let labels = |text: &str| {
        let changed = pasted_into(&session, 0, Column::Label, text).0;
        changed.stations.into_iter().map(|station| station.label).take(3).collect::<Vec<_>>()
    };
    assert_eq!(labels("x\ny\nz"), ["x", "y", "z"]);
    assert_eq!(labels("station\ny\nz"), ["y", "z", "3"]);
    let (_, pasted) = pasted_into(&session, 0, Column::Point(2), "1\t2\t3");
    assert_eq!(pasted.num_left_out, 2, "each is counted once");
}

#[test]
fn the_rotation_of_an_inverse_pose_stays_where_only_its_position_is_typed() {
    let mut session = printed();
    session.robot.notation.is_inverse = true;
    let before = &session.stations[0].captures[0];
    let read = read(&session, &[(0, Column::Number(0), "12")]);
    let [(_, CellValue::Pose(pose, written))] = &read.values[..] else { panic!("{read:?}") };
    assert_eq!(pose.rotation(), before.base_from_flange.rotation());
    assert_eq!(*written, before.written_angles);
}

#[test]
fn a_refused_label_refuses_those_that_counted_on_it() {
    // 5 cannot become 1's old label's owner: 1 stays, so 2 cannot be 1, so 3 cannot be 2.
    let read = read(&printed(), &[(0, Column::Label, "5"), (1, Column::Label, "1"), (2, Column::Label, "2")]);
    assert_eq!((read.values.len(), read.refused.len()), (0, 3));
}

#[test]
fn the_greatest_number_is_not_counted_on() {
    let mut session = printed();
    session.stations[0].label = u64::MAX.to_string();
    let filled = fill_down(&session, &[Row::Station(0), Row::Station(1)], &[Column::Label]);
    assert_eq!(filled[0].text, format!("{} 2", u64::MAX));
}
