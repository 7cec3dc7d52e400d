//! What a method says about each station, as a table: of a ball, of a tip, of the points on a plate's edges.

use std::fmt::Write as _;

use crate::calibrate::{Method, MotionFound, Mount, PlateFound, Solution, StationSolution};
use crate::geometry::Vec3;
use crate::report::digits::{decimals_for, fixed, signed};
use crate::text::closed_form_name;

/// The table. Writing to a string does not fail, hence the `ok()`s.
pub fn stations(out: &mut String, solution: &Solution) {
    let frame = target_frame(solution.mount);
    match &solution.plate {
        Some(plate) => {
            let std_mm = solution.uncertainty.as_ref().map(|known| known.workspace_point_std_mm);
            points(out, plate, frame, decimals_for(std_mm));
        }
        None if solution.method == Method::FixedPoint => places_of(out, ["station", "tip"], &solution.stations, frame),
        None if solution.motion.as_ref().is_some_and(|motion| motion.tracked.is_some()) => {
            places_of(out, ["stretch", "scene"], &solution.stations, frame);
        }
        None if solution.method == Method::Motion => places_of(out, ["station", "target"], &solution.stations, frame),
        None => balls(out, &solution.stations, frame),
    }
    if let Some(motion) = &solution.motion {
        closed_forms(out, motion);
    }
}

/// The frame in which the target stands still.
pub const fn target_frame(mount: Mount) -> &'static str {
    match mount {
        Mount::OnFlange => "base",
        Mount::Fixed => "flange",
    }
}

fn balls(out: &mut String, stations: &[StationSolution], frame: &str) {
    writeln!(
        out,
        "  station  side      ball in sensor / mm        {:^29}   error from first / mm    left out",
        format!("ball in {frame} / mm")
    )
    .ok();
    for station in stations {
        writeln!(out, "  {:<8} {:>3} {}", station.label, station.side.symbol(), places(station)).ok();
    }
}

/// Of targets that have no side; the words are what the rows are of, and what is seen.
fn places_of(out: &mut String, [row, target]: [&str; 2], stations: &[StationSolution], frame: &str) {
    let width = stations.iter().map(|station| station.label.chars().count()).fold(8, usize::max);
    writeln!(
        out,
        "  {row:<width$} {:^29}  {:^29}    error from first / mm    left out",
        format!("{target} in sensor / mm"),
        format!("{target} in {frame} / mm")
    )
    .ok();
    for station in stations {
        writeln!(out, "  {:<width$} {}", station.label, places(station)).ok();
    }
}

fn places(station: &StationSolution) -> String {
    let error = station.error_from_first_mm;
    format!(
        "{}  {}  {:>7} {:>7} {:>7}  {:>8}",
        place(station.target_in_sensor_mm),
        place(station.target_in_base_mm),
        signed(error.x, 3),
        signed(error.y, 3),
        signed(error.z, 3),
        left_out(station.leave_one_out_mm),
    )
}

/// What the published closed forms make of the same data.
fn closed_forms(out: &mut String, motion: &MotionFound) {
    writeln!(out, "  closed forms beside it        off by / mm       / °    residual / mm       / °").ok();
    for closed_form in &motion.closed_forms {
        let name = closed_form_name(closed_form.form);
        match &closed_form.answer {
            Some(answer) => writeln!(
                out,
                "  {name:<28} {:>12} {:>9} {:>16} {:>9}",
                fixed(answer.off_mm, 3),
                fixed(answer.off_rad.to_degrees(), 4),
                fixed(answer.residual_mm, 3),
                fixed(answer.residual_rad.to_degrees(), 4),
            ),
            None => writeln!(out, "  {name:<28} {:>12}", "–"),
        }
        .ok();
    }
}

fn points(out: &mut String, plate: &PlateFound, frame: &str, decimals: usize) {
    let corner = plate.base_from_plate.translation.vector;
    let starts = plate.starts;
    writeln!(
        out,
        "  corner of the plate in {frame}: {}, {}, {} mm · {} of {} starts led here",
        fixed(corner.x, decimals),
        fixed(corner.y, decimals),
        fixed(corner.z, decimals),
        starts.num_agreed,
        starts.num_tried
    )
    .ok();
    writeln!(
        out,
        "  station  edge     point in sensor / mm        {:^29}    off the edge / mm        left out",
        format!("point in {frame} / mm")
    )
    .ok();
    for point in &plate.points {
        let off = point.off_edge_mm;
        writeln!(
            out,
            "  {:<8} {:>3}  {}  {}  {:>7} {:>7} {:>7}  {:>8}",
            point.label,
            point.edge.symbol(),
            place(point.point_in_sensor_mm),
            place(point.point_in_base_mm),
            signed(off.x, 3),
            signed(off.y, 3),
            signed(off.z, 3),
            left_out(point.leave_one_out_mm),
        )
        .ok();
    }
}

fn place(place: Vec3) -> String {
    format!("{:>9} {:>9} {:>9}", fixed(place.x, 3), fixed(place.y, 3), fixed(place.z, 3))
}

fn left_out(error_mm: Option<f64>) -> String {
    error_mm.map_or_else(|| "–".to_owned(), |error_mm| fixed(error_mm, 3))
}
