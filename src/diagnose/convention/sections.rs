//! What each station has measured, without any use of the robot's orientations: one section of the ball a station.

use crate::calibrate::ball::fixed_point::distance_from_plane;
use crate::calibrate::{BallProblem, Reading, Side, SideChoice, Station};
use crate::fit::ArcFit;
use crate::geometry::{Mat3, Vec3};
use crate::session::Session;

/// What no robot holds better than, mm: measurements finer than this all weigh the same.
const FINE_MM: f64 = 0.05;
/// Sections on either side of the largest that a curve needs at least.
const MIN_BESIDE_PEAK: usize = 1;
/// Fewer sections make no curve.
const MIN_CURVE: usize = 4;

/// Where a station saw the ball's centre: (x, ±|y|, z) in the sensor frame at one of its captures.
#[derive(Clone, Copy, Debug)]
pub(super) struct Section {
    /// Index in the session.
    pub station_idx: usize,
    /// The capture.
    pub capture_idx: usize,
    pub x_mm: f64,
    pub size_y_mm: f64,
    pub z_mm: f64,
    /// Weight of y beside x and z.
    pub weight_of_y: f64,
    /// The side, where it is known.
    pub side: Option<Side>,
}

impl Section {
    /// Of a station's first capture, for its pose alone.
    pub const fn of_pose(station_idx: usize) -> Self {
        Self { station_idx, capture_idx: 0, x_mm: 0.0, size_y_mm: 0.0, z_mm: 0.0, weight_of_y: 1.0, side: None }
    }

    pub fn centre(&self, side: Side) -> Vec3 {
        Vec3::new(self.x_mm, side.sign() * self.size_y_mm, self.z_mm)
    }
}

/// One section a station that has any.
pub(super) fn sections(session: &Session, problem: &BallProblem) -> Vec<Section> {
    problem
        .stations
        .iter()
        .filter(|station| session.stations.get(station.idx).is_some_and(|s| s.captures.len() == station.captures.len()))
        .filter_map(|station| reduced_point(station).or_else(|| section(session, station, problem.radius_mm)))
        .collect()
}

fn reduced_point(station: &Station) -> Option<Section> {
    let Reading::Point(point) = station.captures.first()?.reading else { return None };
    Some(Section {
        station_idx: station.idx,
        capture_idx: 0,
        x_mm: point.x,
        size_y_mm: point.y.abs(),
        z_mm: point.z,
        weight_of_y: 1.0,
        side: Some(if point.y < 0.0 { Side::Minus } else { Side::Plus }),
    })
}

/// The largest section: with the ball's centre so near the laser plane its side hardly matters.
fn section(session: &Session, station: &Station, ball_radius_mm: f64) -> Option<Section> {
    let arcs: Vec<(usize, &ArcFit)> = station
        .captures
        .iter()
        .enumerate()
        .filter_map(|(idx, capture)| match &capture.reading {
            Reading::Arc(arc) => Some((idx, &**arc)),
            Reading::Edge(_) | Reading::Refused(_) | Reading::Point(_) | Reading::Pose(_) => None,
        })
        .collect();
    let positions: Vec<Vec3> = session.stations[station.idx]
        .captures
        .iter()
        .map(|capture| capture.base_from_flange.translation_mm())
        .collect();
    let largest = (0..arcs.len()).max_by(|a, b| arcs[*a].1.circle.radius_mm.total_cmp(&arcs[*b].1.circle.radius_mm))?;
    let (capture_idx, arc) = arcs[largest];
    let by_curve = distance_by_curve(&arcs, &positions, largest);
    let (size_y_mm, std_y_mm) = by_curve.unwrap_or_else(|| distance_from_plane(arc, ball_radius_mm));
    // The user's word is about the first capture; along a sweep the side changes.
    let side = match station.side {
        SideChoice::Given(side) if capture_idx == 0 => Some(side),
        SideChoice::Given(_) | SideChoice::Auto => None,
    };
    Some(Section {
        station_idx: station.idx,
        capture_idx,
        x_mm: arc.circle.x_mm,
        size_y_mm,
        z_mm: arc.circle.z_mm,
        weight_of_y: (FINE_MM / std_y_mm.max(FINE_MM)).powi(2),
        side,
    })
}

/// |y| at one section and its standard deviation, from the sweep alone: l² falls with the square of the distance from the
/// largest arc, whatever the ball's radius, the unit of the positions and the orientation are.
fn distance_by_curve(arcs: &[(usize, &ArcFit)], positions: &[Vec3], at: usize) -> Option<(f64, f64)> {
    let reaches_both_sides = at >= MIN_BESIDE_PEAK && at + MIN_BESIDE_PEAK < arcs.len() && arcs.len() >= MIN_CURVE;
    if !reaches_both_sides {
        return None;
    }
    let origin = positions[arcs[at].0];
    let along = positions[arcs[arcs.len() - 1].0] - positions[arcs[0].0];
    let length = along.norm();
    let (mut normal, mut right) = (Mat3::zeros(), Vec3::zeros());
    let rows: Vec<(Vec3, f64)> = arcs
        .iter()
        .map(|(idx, arc)| {
            let part = along.dot(&(positions[*idx] - origin)) / (length * length);
            (Vec3::new(1.0, part, part * part), arc.circle.radius_mm.powi(2))
        })
        .collect();
    for (row, squared) in &rows {
        normal += row * row.transpose();
        right += row * *squared;
    }
    let fit = normal.cholesky()?.solve(&right);
    let (slope, bend) = (fit[1], fit[2]);
    if bend >= 0.0 {
        return None;
    }
    let size_mm = 0.5 * slope.abs() / (-bend).sqrt();
    #[expect(clippy::cast_precision_loss, reason = "a sweep has few steps")]
    let count = rows.len() as f64;
    let scatter = (rows.iter().map(|(row, squared)| (row.dot(&fit) - squared).powi(2)).sum::<f64>() / count).sqrt();
    // Of the slope alone, from a spread of parts of about a third of the length.
    let std_mm = 0.5 * 3.0 * scatter / count.sqrt() / (-bend).sqrt();
    (size_mm.is_finite() && std_mm.is_finite()).then_some((size_mm, std_mm))
}
