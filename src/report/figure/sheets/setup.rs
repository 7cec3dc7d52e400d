//! The set-up in space: base, flange poses, laser planes or lines of sight, and the target; and the way of the flange.

use crate::calibrate::{MotionFound, Mount, PlateFound, Solution};
use crate::geometry::{Rigid, Sensor as SensorFrame, Target as TargetFrame, Transform, Vec3};
use crate::report::evidence::{Evidence, TargetEvidence};
use crate::report::figure::ink::Stroke;
use crate::report::figure::model::ball_radius_mm;
use crate::report::figure::palette::{self, Marker, Rgb, method_color};
use crate::report::figure::plot::{Axis, Dash, Entry, Filling, Mark, Note, NoteSide, Plot, Sign};
use crate::report::figure::{Extent, Figure};
use crate::session::{Reading, Session};
use crate::text::figures as words;

use super::sheet::{HALF_PAGE, Sheet};
use super::space::{RAY_COLOR, Scene, Triad};

/// More stations than this are not all named.
const MOST_NAMED: usize = 24;
/// More laser planes or lines of sight than this hide each other.
const MOST_RAYS: usize = 40;
/// Half the side of a board in the sketch, as a part of its distance: how large it is, nobody says.
const BOARD_PART: f64 = 0.1;

/// The figures of the set-up.
pub(super) fn figures(evidence: &Evidence) -> Vec<Figure> {
    sketch(evidence).into_iter().chain(trajectory(&evidence.session)).collect()
}

/// The first pose of each enabled station.
fn first_poses(session: &Session) -> impl Iterator<Item = (usize, &str, &Rigid)> {
    session.stations.iter().enumerate().filter(|(_, station)| station.enabled).filter_map(|(idx, station)| {
        Some((idx, station.label.as_str(), station.captures.first()?.base_from_flange.rigid()))
    })
}

fn sketch(evidence: &Evidence) -> Option<Figure> {
    let (target, solution) = evidence.answer()?;
    let session = &target.session;
    let poses: Vec<(usize, &str, &Rigid)> = first_poses(session).collect();
    if poses.is_empty() {
        return None;
    }
    let mut scene = Scene::default();
    let sensor = solution.flange_from_sensor.rigid();
    let in_base = |pose: &Rigid, point: Vec3| (pose * nalgebra::Point3::from(point)).coords;
    let is_fixed = solution.mount == Mount::Fixed;
    scene.triad(&Rigid::identity(), Triad { name: Some(words::BASE), is_strong: true });
    for (place, (idx, label, pose)) in poses.iter().enumerate() {
        let name = (poses.len() <= MOST_NAMED).then_some(*label);
        scene.triad(pose, Triad { name, is_strong: false });
        let base_from_sensor = if is_fixed { *sensor } else { **pose * *sensor };
        if !is_fixed {
            scene.holder(pose.translation.vector, base_from_sensor.translation.vector);
        }
        if let Some(seen) = board_seen(target, *idx).filter(|_| place < MOST_RAYS) {
            let sensor_in_base = base_from_sensor.translation.vector;
            scene.line_of_sight(sensor_in_base, in_base(&base_from_sensor, seen.translation_mm()));
        }
        let has_plane = place < MOST_RAYS && (place == 0 || !is_fixed);
        if let Some(line) = laser_line(target, *idx).filter(|_| has_plane) {
            let ends = line.map(|end| in_base(&base_from_sensor, end));
            scene.laser_plane(base_from_sensor.translation.vector, ends);
        }
        if is_fixed {
            mark_target(&mut scene, target, solution, Some(pose));
        }
    }
    if !is_fixed {
        mark_target(&mut scene, target, solution, None);
    }
    let is_point = solution.plate.is_none() && !target.uses_radius();
    let name = words::target(&session.target, is_point);
    let is_board = solution.motion.is_some();
    let sign = if is_point && !is_board { Sign::Solid(Marker::Diamond) } else { Sign::Line(Dash::Solid) };
    let rays = if is_board {
        Entry::new(Sign::Line(Dash::Solid), RAY_COLOR, words::LINE_OF_SIGHT)
    } else {
        Entry::new(Sign::Bar(Filling::Faint), palette::OUTLIER, words::LASER_PLANE)
    };
    let mut sheet = Sheet::new(HALF_PAGE);
    let legend = [
        Entry::new(Sign::Line(Dash::Solid), palette::AXES[0], "x"),
        Entry::new(Sign::Line(Dash::Solid), palette::AXES[1], "y"),
        Entry::new(Sign::Line(Dash::Solid), palette::AXES[2], "z"),
        Entry::new(Sign::Solid(Marker::Circle), palette::TEXT, words::FLANGE),
        rays,
        Entry::new(sign, method_color(solution.method), name),
    ];
    let area = sheet.legend(&legend);
    scene.draw(&area, sheet.page());
    let title = words::setup_title(name, poses.len(), is_fixed, is_board);
    Some(sheet.figure("setup", title.clone(), title))
}

/// The ends of what the laser line lights at a station's first capture, in the sensor frame, mm.
fn laser_line(target: &TargetEvidence, station_idx: usize) -> Option<[Vec3; 2]> {
    match &target.session.stations.get(station_idx)?.captures.first()?.reading {
        Reading::Point(point) => Some(about(*point)),
        Reading::Pose(_) => None,
        Reading::Profile(profile) => {
            let (mut range, mut sum, mut count) = ([f64::INFINITY, f64::NEG_INFINITY], 0.0, 0.0);
            for (_, x, z) in profile.valid_points() {
                range = [range[0].min(x), range[1].max(x)];
                sum += z;
                count += 1.0;
            }
            let z = sum / count;
            (count > 1.0 && z.is_finite()).then(|| range.map(|x| Vec3::new(x, 0.0, z)))
        }
    }
}

/// The board or marker as the camera has it at a station's first capture.
fn board_seen(target: &TargetEvidence, station_idx: usize) -> Option<&Transform<SensorFrame, TargetFrame>> {
    match &target.session.stations.get(station_idx)?.captures.first()?.reading {
        Reading::Pose(sensor_from_target) => Some(sensor_from_target),
        Reading::Profile(_) | Reading::Point(_) => None,
    }
}

/// A short line about a point that was reduced elsewhere.
fn about(point_in_sensor: Vec3) -> [Vec3; 2] {
    let half = Vec3::new(0.12 * point_in_sensor.norm().max(1.0), 0.0, 0.0);
    [point_in_sensor - half, point_in_sensor + half]
}

/// The target where the calibration has it; on a flange that carries it, at a pose.
fn mark_target(scene: &mut Scene, target: &TargetEvidence, solution: &Solution, pose: Option<&Rigid>) {
    let color = method_color(solution.method);
    let place = |point: Vec3| pose.map_or(point, |pose| (pose * nalgebra::Point3::from(point)).coords);
    match (&solution.plate, &solution.motion) {
        (Some(plate), _) => scene.plate(plate_corners(plate).map(place), color),
        (None, Some(motion)) => scene.board(board_corners(target, motion).map(place), color),
        (None, None) if target.uses_radius() => {
            scene.ball(place(solution.target_in_base_mm), ball_radius_mm(&target.session).unwrap_or(0.0), color);
        }
        (None, None) => scene.point(place(solution.target_in_base_mm), color),
    }
}

/// The corners of a board, in the base.
fn board_corners(target: &TargetEvidence, motion: &MotionFound) -> [Vec3; 4] {
    let num_stations = target.session.stations.len();
    let distance_mm =
        (0..num_stations).find_map(|idx| board_seen(target, idx)).map(|seen| seen.translation_mm().norm());
    let half_mm = BOARD_PART * distance_mm.unwrap_or(1.0);
    let base_from_target = motion.base_from_target.rigid();
    [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]
        .map(|[x, y]| (base_from_target * nalgebra::Point3::new(x * half_mm, y * half_mm, 0.0)).coords)
}

/// The ends of edge p, the corner, and the end of edge q, as far as the points reach, in the base.
fn plate_corners(plate: &PlateFound) -> [Vec3; 3] {
    let base_from_plate = &plate.base_from_plate;
    let in_plate = plate
        .points
        .iter()
        .map(|point| base_from_plate.inverse_transform_point(&nalgebra::Point3::from(point.point_in_base_mm)).coords);
    let reach = in_plate.fold([1.0_f64; 2], |[x, y], point| [x.max(point.x), y.max(point.y)]);
    [Vec3::new(reach[0], 0.0, 0.0), Vec3::zeros(), Vec3::new(0.0, reach[1], 0.0)]
        .map(|corner| (base_from_plate * nalgebra::Point3::from(corner)).coords)
}

/// The positions of the flange from above and from the side, in the order of capture.
fn trajectory(session: &Session) -> Option<Figure> {
    let enabled = session.stations.iter().filter(|station| station.enabled);
    let paths: Vec<(&str, Vec<Vec3>)> = enabled
        .map(|station| {
            let positions = station.captures.iter().map(|capture| capture.base_from_flange.translation_mm());
            (
                station.label.as_str(),
                positions.filter(|position| position.iter().all(|value| value.is_finite())).collect(),
            )
        })
        .filter(|(_, path): &(_, Vec<Vec3>)| !path.is_empty())
        .collect();
    let num_captures: usize = paths.iter().map(|(_, path)| path.len()).sum();
    if num_captures < 2 {
        return None;
    }
    let has_sweeps = paths.iter().any(|(_, path)| path.len() > 1);
    let mut legend = vec![
        Entry::new(Sign::Solid(Marker::Circle), palette::INLIER, words::FIRST_CAPTURE),
        Entry::new(Sign::Line(Dash::Dotted), palette::TEXT_DIM, words::FROM_STATION_TO_STATION),
    ];
    if has_sweeps {
        legend.push(Entry::new(Sign::Line(Dash::Solid), palette::FIT, words::FURTHER_CAPTURES));
    }
    let mut sheet = Sheet::new(270.0);
    let areas = sheet.legend_over_columns(&legend);
    let mut views = Vec::new();
    for (axes, y_title) in [([0, 1], words::FLANGE_Y_AXIS), ([0, 2], words::FLANGE_Z_AXIS)] {
        let at = |position: &Vec3| axes.map(|axis: usize| position[axis]);
        let mut extent = Extent::NOTHING;
        for position in paths.iter().flat_map(|(_, path)| path) {
            extent.include(at(position)[0], at(position)[1]);
        }
        let mut plot = Plot::new(Axis::new(words::FLANGE_X_AXIS), Axis::new(y_title), extent);
        plot.has_equal_scales = true;
        let way: Vec<[f64; 2]> = paths.iter().map(|(_, path)| at(&path[0])).collect();
        let stroke = Stroke::new(0.7, palette::UNUSED);
        plot.mark(Mark::Line { points: way.clone(), stroke, dash: Dash::Dotted });
        for (_, path) in &paths {
            let points = path.iter().map(at).collect();
            plot.mark(Mark::Line { points, stroke: Stroke::new(1.2, palette::FIT), dash: Dash::Solid });
        }
        let stroke = Stroke::new(0.5, Rgb::WHITE);
        let fill = Some(palette::INLIER);
        plot.mark(Mark::Markers { points: way.clone(), shape: Marker::Circle, radius: 2.4, fill, stroke });
        if paths.len() <= MOST_NAMED {
            plot.notes = paths
                .iter()
                .zip(way)
                .map(|((label, _), at)| Note {
                    at,
                    text: (*label).to_owned(),
                    color: palette::TEXT,
                    side: NoteSide::Right,
                })
                .collect();
        }
        views.push(plot);
    }
    for (plot, area) in views.iter().zip(areas) {
        sheet.plot(plot, &area);
    }
    let title = words::trajectory_title(paths.len(), num_captures);
    Some(sheet.figure("trajectory", title.clone(), title))
}
