//! Tables in the layout of Lin & Mu 2019, Tables 1 and 2, of a plate's edge points and of a tip in the same columns, and the
//! printed ones checked against themselves.

use std::fmt::Write as _;

use crate::calibrate::{Method, MethodResult, Solution};
use crate::geometry::Vec3;
use crate::report::compare::published_rows;
use crate::report::digits::fixed;
use crate::session::Session;
use crate::text;

use super::stations::target_frame;

const HEAD: &str = "No.       q0        q1        q2        q3 |       t1        t2        t3 |       xs        ys        zs | \
                          xb        yb        zb |   x err    y err    z err";

/// One table a method, then the published one, if the session holds it.
pub fn paper_tables(session: &Session, results: &[MethodResult]) -> String {
    let mut out = String::new();
    for result in results {
        match &result.outcome {
            Ok(solution) => method_table(&mut out, session, solution),
            Err(error) => {
                writeln!(out, "{}: not computed: {error}\n", text::method_name(result.method)).ok();
            }
        }
    }
    published_table(&mut out, session);
    out
}

/// A row: the station's label, its pose, the point in the sensor and where the target stands still, and its error.
type Row<'a> = (&'a str, usize, Vec3, Vec3, Vec3);

fn method_table(out: &mut String, session: &Session, solution: &Solution) {
    let frame = target_frame(solution.mount);
    let (target, error, rows): (_, _, Vec<Row<'_>>) = if let Some(plate) = &solution.plate {
        let rows = plate.points.iter().map(|point| {
            let (in_sensor_mm, in_base_mm) = (point.point_in_sensor_mm, point.point_in_base_mm);
            (point.label.as_str(), point.station_idx, in_sensor_mm, in_base_mm, point.off_edge_mm)
        });
        ("edge point", "off the edge", rows.collect())
    } else {
        let rows = solution.stations.iter().map(|station| {
            let (in_sensor_mm, in_base_mm) = (station.target_in_sensor_mm, station.target_in_base_mm);
            (station.label.as_str(), station.station_idx, in_sensor_mm, in_base_mm, station.error_from_first_mm)
        });
        (
            match solution.method {
                Method::FixedPoint => "tip",
                Method::Motion => "target",
                _ => "ball",
            },
            "error",
            rows.collect(),
        )
    };
    writeln!(
        out,
        "{} · flange in base (quaternion, translation/mm) · {target} in sensor/mm · {target} in {frame}/mm · {error}/mm",
        text::method_name(solution.method)
    )
    .ok();
    writeln!(out, "{HEAD}").ok();
    for (label, station_idx, in_sensor_mm, in_base_mm, error_mm) in rows {
        let Some(capture) = session.stations.get(station_idx).and_then(|recorded| recorded.captures.first()) else {
            continue;
        };
        let pose = capture.base_from_flange;
        let [q0, q1, q2, q3] = pose.quaternion_wxyz().map(|part| fixed(part, 5));
        write!(out, "{label:<4} {q0:>8}  {q1:>8}  {q2:>8}  {q3:>8} |").ok();
        for vector in [pose.translation_mm(), in_sensor_mm, in_base_mm] {
            triple(out, vector, 9);
        }
        writeln!(out, " {:>8} {:>8} {:>8}", fixed(error_mm.x, 3), fixed(error_mm.y, 3), fixed(error_mm.z, 3)).ok();
    }
    let place = match &solution.plate {
        Some(plate) => plate.base_from_plate.translation.vector,
        None => solution.target_in_base_mm,
    };
    let [x, y, z] = [place.x, place.y, place.z].map(|value| fixed(value, 1));
    let (rms, max) = (fixed(solution.scatter.rms_mm, 3), fixed(solution.scatter.max_mm, 3));
    if solution.plate.is_some() {
        writeln!(out, "distance of the points from their edges: RMS {rms} mm, maximum {max} mm; corner of the plate in {frame} ({x}, {y}, {z})\n").ok();
    } else {
        writeln!(
            out,
            "scatter of the {target} in {frame}: RMS {rms} mm, maximum {max} mm (3D) about ({x}, {y}, {z})\n"
        )
        .ok();
    }
}

fn triple(out: &mut String, vector: Vec3, width: usize) {
    for value in vector.iter() {
        write!(out, "{:>width$} ", fixed(*value, 3)).ok();
    }
    out.push('|');
}

fn published_table(out: &mut String, session: &Session) {
    let Some(published) = &session.published else { return };
    let rows = published_rows(published);
    if rows.is_empty() {
        return;
    }
    let caption = if published.caption.is_empty() { "As published" } else { &published.caption };
    writeln!(
        out,
        "{caption} · printed ball in base/mm · printed error/mm · error recomputed from the printed centres/mm"
    )
    .ok();
    writeln!(out, "No.         xb        yb        zb | printed x        y        z | recomp. x        y        z")
        .ok();
    let mut misprints = Vec::new();
    for (idx, row) in rows.iter().enumerate() {
        let label = session.stations.get(idx).map_or("", |station| station.label.as_str());
        write!(out, "{label:<4} ").ok();
        for value in row.target_in_base_mm.iter() {
            write!(out, "{:>9} ", fixed(*value, 3)).ok();
        }
        out.push('|');
        for axis in 0..3 {
            let printed = row.printed_error_mm.map_or_else(|| "–".to_owned(), |error| fixed(error[axis], 4));
            let mark = if row.is_misprint[axis] { "*" } else { " " };
            write!(out, " {printed:>7}{mark}").ok();
            if let (true, Some(error)) = (row.is_misprint[axis], row.printed_error_mm) {
                misprints.push(format!(
                    "row {label}, {}: printed {}, but the printed centres give {}",
                    ["x", "y", "z"][axis],
                    fixed(error[axis], 3),
                    fixed(row.recomputed_error_mm[axis], 3)
                ));
            }
        }
        out.push('|');
        for axis in 0..3 {
            write!(out, " {:>8}", fixed(row.recomputed_error_mm[axis], 4)).ok();
        }
        out.push('\n');
    }
    let largest = rows.iter().map(|row| row.recomputed_error_mm.amax()).fold(0.0, f64::max);
    writeln!(out, "largest coordinate of the recomputed error: {} mm", fixed(largest, 4)).ok();
    if !misprints.is_empty() {
        writeln!(out, "* misprint{}:", if misprints.len() == 1 { "" } else { "s" }).ok();
        for misprint in misprints {
            writeln!(out, "  {misprint}").ok();
        }
    }
}
