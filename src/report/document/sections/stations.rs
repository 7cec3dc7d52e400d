//! Every station, as the result to use has it.

use crate::calibrate::validation::Influence;
use crate::calibrate::{Method, PlateFound, PlatePoint, Solution, StationSolution, Sweep, solution_of};
use crate::report::comparison::capture_label;
use crate::report::document::{Block, Cell, Column, Table, typeset};
use crate::report::evidence::{Evidence, TargetEvidence};
use crate::session::{Station, Target};
use crate::text::report as words;

use super::of_each_target;

/// Micrometres.
const DECIMALS: usize = 3;

pub(in crate::report::document) fn blocks(evidence: &Evidence) -> Vec<Block> {
    of_each_target(evidence, of_target)
}

fn of_target(target: &TargetEvidence, suffix: &str) -> Vec<Block> {
    let Some(solution) = target.best() else { return Vec::new() };
    let (columns, rows, note) = match &solution.plate {
        Some(plate) => points(target, plate),
        None if matches!(target.session.target, Target::Rgbd { .. }) => stretches(target, solution),
        None => stations(target, solution),
    };
    vec![Block::Table(Table {
        id: format!("stations{suffix}"),
        title: words::stations_title(solution.method),
        columns,
        rows,
        note: Some(note.to_owned()),
    })]
}

type Parts = (Vec<Column>, Vec<Vec<Cell>>, &'static str);

/// A ball's or a tip's.
fn stations(target: &TargetEvidence, solution: &Solution) -> Parts {
    let has_sides = solution.method.has_sides();
    // The sweeps are those of the method that looks at them.
    let curves = solution_of(target.results(), Method::BallMaxArc);
    let mut columns = vec![Column::words(words::NUMBER, "station")];
    columns.extend(has_sides.then(|| Column::words(words::SIDE, "side")));
    columns.extend([
        Column::number(words::CAPTURES_COLUMN, None, "captures"),
        Column::number(words::ERROR_SIZE, Some("mm"), "error_from_mean_mm"),
        Column::number(words::LEFT_OUT_COLUMN, Some("mm"), "leave_one_out_mm"),
        Column::number(words::STUDENTISED, None, "studentised_residual"),
        Column::number(words::MOVES_POINT, Some("mm"), "moves_workspace_point_mm"),
    ]);
    if curves.is_some() {
        columns.extend([
            Column::number(words::PEAK, Some("mm"), "peak_mm").under(words::SWEEP),
            Column::number(words::STD, Some("mm"), "peak_std_mm").under(words::SWEEP),
            Column::number(words::OFF_NORMAL, Some("°"), "travel_off_normal_deg").under(words::SWEEP),
        ]);
    }
    let influence = influence_of(target);
    let row = |(idx, station): (usize, &Station)| {
        let of = |solution: &&Solution| solution.stations.iter().find(|used| used.station_idx == idx).cloned();
        let used = of(&solution);
        let sweep = curves.as_ref().and_then(of).and_then(|used| used.sweep);
        let influence = influence.iter().find(|influence| influence.station_idx == idx);
        let mut row = vec![Cell::words(&station.label)];
        row.extend(has_sides.then(|| match &used {
            Some(used) => Cell::words(typeset(used.side.symbol())),
            None => Cell::words(words::STATION_LEFT_OUT),
        }));
        row.push(Cell::count(station.captures.len()));
        row.extend(figures(used.as_ref(), influence));
        row.extend(curves.is_some().then(|| peak(sweep.as_ref())).into_iter().flatten());
        row
    };
    let rows = target.session.stations.iter().enumerate().map(row).collect();
    (columns, rows, words::STATIONS_NOTE)
}

fn influence_of(target: &TargetEvidence) -> &[Influence] {
    let validation = target.diagnosis().and_then(|diagnosis| diagnosis.validation.as_ref());
    validation.map_or(&[][..], |validation| &validation.influence)
}

/// Of a camera's way.
fn stretches(target: &TargetEvidence, solution: &Solution) -> Parts {
    let columns = vec![
        Column::words(words::STRETCH, "stretch"),
        Column::number(words::POSES_COLUMN, None, "poses"),
        Column::number(words::ERROR_SIZE, Some("mm"), "error_from_mean_mm"),
        Column::number(words::LEFT_OUT_COLUMN, Some("mm"), "leave_one_out_mm"),
        Column::number(words::STUDENTISED, None, "studentised_residual"),
        Column::number(words::MOVES_POINT, Some("mm"), "moves_workspace_point_mm"),
    ];
    let influence = influence_of(target);
    let poses = solution.motion.as_ref().map_or(&[][..], |motion| &motion.poses);
    let row = |stretch: &StationSolution| {
        let is_of_stretch = |idx: usize| idx == stretch.station_idx;
        let influence = influence.iter().find(|influence| is_of_stretch(influence.station_idx));
        let num_poses = poses.iter().filter(|pose| is_of_stretch(pose.station_idx)).count();
        [Cell::words(&stretch.label), Cell::count(num_poses)]
            .into_iter()
            .chain(figures(Some(stretch), influence))
            .collect()
    };
    (columns, solution.stations.iter().map(row).collect(), words::STRETCHES_NOTE)
}

fn figures(used: Option<&StationSolution>, influence: Option<&Influence>) -> [Cell; 4] {
    [
        Cell::maybe(used.map(|used| used.error_from_mean_mm.norm()), DECIMALS),
        Cell::maybe(used.and_then(|used| used.leave_one_out_mm), DECIMALS),
        Cell::maybe(influence.map(|influence| influence.studentised_residual), 1),
        Cell::maybe(influence.map(|influence| influence.moves_workspace_point_mm), DECIMALS),
    ]
}

fn peak(sweep: Option<&Sweep>) -> [Cell; 3] {
    [
        Cell::maybe(sweep.map(|sweep| sweep.peak_mm), DECIMALS),
        Cell::maybe(sweep.map(|sweep| sweep.peak_std_mm), DECIMALS),
        Cell::maybe(sweep.map(|sweep| sweep.travel_off_normal_rad.to_degrees()), 2),
    ]
}

/// The points on a plate's edges.
fn points(target: &TargetEvidence, plate: &PlateFound) -> Parts {
    let columns = vec![
        Column::words(words::NUMBER, "station"),
        Column::words(words::EDGE, "edge"),
        Column::number(words::ERROR_SIZE, Some("mm"), "off_edge_mm"),
        Column::number(words::LEFT_OUT_COLUMN, Some("mm"), "leave_one_out_mm"),
    ];
    let cells = |label: String, point: Option<&PlatePoint>| {
        vec![
            Cell::words(&label),
            point.map_or_else(|| Cell::words(words::STATION_LEFT_OUT), |point| Cell::words(point.edge.symbol())),
            Cell::maybe(point.map(|point| point.off_edge_mm.norm()), DECIMALS),
            Cell::maybe(point.and_then(|point| point.leave_one_out_mm), DECIMALS),
        ]
    };
    let rows = |(idx, station): (usize, &Station)| -> Vec<Vec<Cell>> {
        let of_capture = |capture_idx: usize| {
            let label = capture_label(station, capture_idx);
            cells(label, plate.points.iter().find(|point| (point.station_idx, point.capture_idx) == (idx, capture_idx)))
        };
        (0..station.captures.len()).map(of_capture).collect()
    };
    (columns, target.session.stations.iter().enumerate().flat_map(rows).collect(), words::EDGE_POINTS_NOTE)
}
