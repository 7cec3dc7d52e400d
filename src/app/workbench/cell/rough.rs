//! What the next station is chosen by before there is a solution: the mounting as it was said, and what was seen through it.

use std::sync::Arc;

use crate::calibrate::{Mount, Noise, Reading as MeasuredReading};
use crate::device::{LinkState, LiveProfile};
use crate::fit::{ArcFit, Found, Sought};
use crate::geometry::{Base, Flange, Profile, Rigid, Transform, Vec3};
use crate::plan::{MeasuredStation, PlanRefusal, PlannedStation, RoughCell, RoughPlate, SeenEdge, View};
use crate::session::{Capture, Edge, Reading, Session, Station, Target};
use crate::text::cell as words;

use super::super::Workbench;
use super::choose::Basis;
use super::proposals::{FoundPeak, rigid};

/// The ball's centre stays so far inside the ends of the line that its arc does too, radii ...
const ARC_HALF_WIDTH_RADII: f64 = 0.6;
/// ... but may always be this far from the middle, radii.
const LEAST_HALF_WIDTH_RADII: f64 = 0.25;
/// How far the ball may be nearer or further than where it was seen, radii: heads see at least that.
const HALF_RANGE_RADII: f64 = 0.4;

/// How far from the middle of the line a plate's edge or a tip may be, and nearer or further than where it was seen, as a
/// part of half the line: on either side a flank has to be seen.
const EDGE_HALF_WIDTH_PART: f64 = 0.35;
const EDGE_HALF_RANGE_PART: f64 = 0.3;
/// The second station of an edge is shifted by so much of half the line across it, either way: the crossing moves as far along
/// the line, or less.
const SHIFT_PARTS: [f64; 4] = [0.4, -0.4, 0.2, -0.2];
/// The edges are taken to go on for so much of half the line beyond where they were crossed ...
const BEYOND_PART: f64 = 0.7;
/// ... but nearer to the corner than this part the line would meet the other edge.
const CORNER_PART: f64 = 1.1;
/// How far beside the laser plane a tip may be for the search to meet it, mm.
const TIP_REACH_MM: f64 = 4.0;
/// How well the pose is known at which the line lies on a tip, mm.
const TIP_STD_MM: f64 = 0.1;

impl Workbench {
    /// The basis without a solution.
    pub(super) fn rough_basis(&self) -> Result<Basis, String> {
        let (Some(document), Some(sought)) = (&self.document, self.sought()) else {
            return Err(words::NO_SESSION.to_owned());
        };
        let session = &document.session;
        let mounting = self.cell.view.settings.mounting.ok_or_else(|| words::NO_MOUNTING.to_owned())?;
        let flange_from_sensor = rigid(&mounting);
        match (&session.target, sought) {
            (Target::RightAnglePlate, _) => self.rough_plate(session, flange_from_sensor),
            (_, Sought::Arc(ball)) => self.rough_ball(session, flange_from_sensor, ball.ball_radius_mm),
            (_, Sought::Edge(_)) => self.rough_tip(session, flange_from_sensor),
        }
    }

    fn rough_ball(&self, session: &Session, flange_from_sensor: Rigid, radius_mm: f64) -> Result<Basis, String> {
        let seen = self.largest_sections();
        let first = seen.first().ok_or_else(|| words::NO_BALL_SEEN.to_owned())?;
        let stations: Vec<MeasuredStation> = seen
            .iter()
            .map(|seen| {
                let circle = seen.arc.circle;
                let centre_mm = [circle.x_mm, circle.z_mm];
                match seen.peak {
                    Some(peak) => MeasuredStation::at_peak(peak.base_from_flange, centre_mm, peak.std_mm),
                    None => MeasuredStation::of_section(seen.base_from_flange, centre_mm, circle.radius_mm, radius_mm),
                }
            })
            .collect();
        let half_width_mm = half_line_mm(first.profile) - ARC_HALF_WIDTH_RADII * radius_mm;
        let view = View {
            half_width_mm: half_width_mm.max(LEAST_HALF_WIDTH_RADII * radius_mm),
            half_range_mm: HALF_RANGE_RADII * radius_mm,
            middle_range_mm: middle_range_mm(stations.iter().map(|station| station.target_in_sensor_mm.z)),
        };
        let looks_along_in_base = first.base_from_flange.rotation() * flange_from_sensor.rotation * Vec3::z();
        let cell = rough_cell(session, flange_from_sensor, radius_mm, looks_along_in_base);
        Ok(Basis::Rough { cell, stations, view })
    }

    /// A tip is a ball without size; the reach of the search stands for that.
    fn rough_tip(&self, session: &Session, flange_from_sensor: Rigid) -> Result<Basis, String> {
        let seen = self.seen_points();
        let first = seen.first().ok_or_else(|| words::NO_TIP_SEEN.to_owned())?;
        let station = |seen: &SeenPoint| {
            let at = seen.point_in_sensor_mm;
            MeasuredStation::at_peak(seen.base_from_flange, [at.x, at.z], TIP_STD_MM)
        };
        let view = view_of_points(&seen);
        let looks_along_in_base = first.base_from_flange.rotation() * flange_from_sensor.rotation * Vec3::z();
        let cell = rough_cell(session, flange_from_sensor, TIP_REACH_MM, looks_along_in_base);
        Ok(Basis::Rough { cell, stations: seen.iter().map(station).collect(), view })
    }

    fn rough_plate(&self, session: &Session, flange_from_sensor: Rigid) -> Result<Basis, String> {
        let points = self.seen_points();
        let seen: Vec<SeenEdge> = points.iter().filter_map(SeenPoint::on_edge).collect();
        let missing = [Edge::P, Edge::Q].into_iter().find(|edge| seen.iter().all(|seen| seen.edge != *edge));
        if let Some(edge) = missing {
            return Err(words::edge_unseen(edge));
        }
        let view = view_of_points(&points);
        let half_line_mm = shortest_half_line_mm(&points);
        match RoughPlate::through(session.mount, flange_from_sensor, noise(session), &seen) {
            Ok(mut cell) => {
                let [nearest, furthest] = cell.along_mm;
                let beyond_mm = BEYOND_PART * half_line_mm;
                let least = (nearest - beyond_mm).max(CORNER_PART * half_line_mm).min(nearest);
                cell.along_mm = [least, furthest + beyond_mm];
                Ok(Basis::RoughPlate { cell, seen, view })
            }
            Err(PlanRefusal::PlateUnseen) => {
                // Where the robot stands, the way is shortest.
                let chosen = self.cell.view.settings.edge;
                let on_edge = |edge: Edge| seen.iter().rfind(|seen| seen.edge == edge);
                let from = on_edge(chosen).ok_or_else(|| words::edge_unseen(chosen))?;
                let shifts_mm = SHIFT_PARTS.map(|part| part * half_line_mm);
                let stations = shifts_mm.map(|shift_mm| beside(from, shift_mm, session.mount, &flange_from_sensor));
                Ok(Basis::Beside(stations.to_vec()))
            }
            Err(refusal) => Err(refusal.to_string()),
        }
    }

    /// How far a plate's edges are taken to go on beyond where they were crossed, mm; 0 of any other target.
    pub(super) fn edge_goes_on_for_mm(&self) -> f64 {
        let is_plate =
            self.document.as_ref().is_some_and(|document| document.session.target == Target::RightAnglePlate);
        let seen = if is_plate { self.seen_points() } else { Vec::new() };
        if seen.is_empty() { 0.0 } else { BEYOND_PART * shortest_half_line_mm(&seen) }
    }

    /// The largest section of each station; without stations that which is seen now.
    fn largest_sections(&self) -> Vec<Seen<'_>> {
        let mut found = Vec::new();
        if let (Some(document), Some(results)) = (&self.document, &self.results) {
            for (station_idx, station) in document.session.stations.iter().enumerate() {
                let peak = self.peak_of(station);
                let sections = station.captures.iter().enumerate().filter_map(|(capture_idx, capture)| {
                    match (&capture.reading, results.measured.reading(station_idx, capture_idx)) {
                        (Reading::Profile(profile), Some(MeasuredReading::Arc(arc))) => {
                            Some(Seen { base_from_flange: capture.base_from_flange, arc, profile, peak })
                        }
                        _ => None,
                    }
                });
                let radius_mm = |seen: &Seen<'_>| seen.arc.circle.radius_mm;
                found.extend(sections.filter(|_| station.enabled).max_by(|a, b| radius_mm(a).total_cmp(&radius_mm(b))));
            }
        }
        if found.is_empty()
            && let Some((base_from_flange, live)) = self.seen_now()
            && let Ok(Found::Arc(arc)) = &live.found
        {
            found.push(Seen { base_from_flange, arc, profile: &live.reading.profile, peak: None });
        }
        found
    }

    /// The edge points or tips of the stations; without stations the one that is seen now.
    fn seen_points(&self) -> Vec<SeenPoint> {
        let mut found = Vec::new();
        if let (Some(document), Some(results)) = (&self.document, &self.results) {
            for (station_idx, station) in document.session.stations.iter().enumerate().filter(|(_, one)| one.enabled) {
                for (capture_idx, capture) in station.captures.iter().enumerate() {
                    let point = results.measured.reading(station_idx, capture_idx);
                    if let (Some(point), Reading::Profile(profile)) =
                        (point.and_then(MeasuredReading::point_in_sensor_mm), &capture.reading)
                    {
                        found.push(SeenPoint::new(capture.base_from_flange, station.edge, point, profile));
                    }
                }
            }
        }
        if found.is_empty()
            && let Some((base_from_flange, live)) = self.seen_now()
            && let Ok(Found::Edge(edge)) = &live.found
        {
            let [x, z] = edge.point_mm;
            found.push(SeenPoint::new(base_from_flange, None, Vec3::new(x, 0.0, z), &live.reading.profile));
        }
        found
    }

    /// What is seen where the robot stands.
    fn seen_now(&self) -> Option<(Transform<Base, Flange>, &LiveProfile)> {
        let view = &self.cell.view;
        let (live, report) = (view.live.as_ref()?, view.robot.latest.as_ref()?);
        (view.robot.state == LinkState::Ready).then_some((report.base_from_flange, live))
    }

    fn peak_of(&self, station: &Station) -> Option<&FoundPeak> {
        let profile = |capture: &Capture| match &capture.reading {
            Reading::Profile(profile) => Some(Arc::clone(profile)),
            Reading::Point(_) | Reading::Pose(_) => None,
        };
        let profiles: Vec<_> = station.captures.iter().filter_map(profile).collect();
        let is_of_station = |peak: &&FoundPeak| profiles.iter().any(|one| Arc::ptr_eq(one, &peak.first_profile));
        self.cell.proposing.peaks().iter().find(is_of_station)
    }
}

/// A section of the ball with where it was seen from.
struct Seen<'a> {
    base_from_flange: Transform<Base, Flange>,
    arc: &'a ArcFit,
    profile: &'a Profile,
    /// Where the ball's centre is in the laser plane, if a search has found that.
    peak: Option<&'a FoundPeak>,
}

/// A point of an edge, or a tip, with where it was seen from.
struct SeenPoint {
    base_from_flange: Transform<Base, Flange>,
    edge: Option<Edge>,
    point_in_sensor_mm: Vec3,
    half_line_mm: f64,
}

impl SeenPoint {
    fn new(
        base_from_flange: Transform<Base, Flange>,
        edge: Option<Edge>,
        point_in_sensor_mm: Vec3,
        profile: &Profile,
    ) -> Self {
        Self { base_from_flange, edge, point_in_sensor_mm, half_line_mm: half_line_mm(profile) }
    }

    fn on_edge(&self) -> Option<SeenEdge> {
        let (base_from_flange, point_in_sensor_mm) = (self.base_from_flange, self.point_in_sensor_mm);
        Some(SeenEdge { base_from_flange, edge: self.edge?, point_in_sensor_mm })
    }
}

fn view_of_points(seen: &[SeenPoint]) -> View {
    let half_line_mm = shortest_half_line_mm(seen);
    View {
        half_width_mm: EDGE_HALF_WIDTH_PART * half_line_mm,
        half_range_mm: EDGE_HALF_RANGE_PART * half_line_mm,
        middle_range_mm: middle_range_mm(seen.iter().map(|point| point.point_in_sensor_mm.z)),
    }
}

fn shortest_half_line_mm(seen: &[SeenPoint]) -> f64 {
    seen.iter().map(|point| point.half_line_mm).fold(f64::INFINITY, f64::min)
}

fn half_line_mm(profile: &Profile) -> f64 {
    profile.x_mm().iter().fold(0.0, |most: f64, x| most.max(x.abs()))
}

fn middle_range_mm(ranges_mm: impl Iterator<Item = f64>) -> f64 {
    let [least, most] =
        ranges_mm.fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], z| [least.min(z), most.max(z)]);
    f64::midpoint(least, most)
}

fn noise(session: &Session) -> Noise {
    Noise {
        position_std_mm: session.robot.position_std_mm,
        orientation_std_rad: session.robot.orientation_std_deg.map(f64::to_radians),
    }
}

fn rough_cell(session: &Session, flange_from_sensor: Rigid, radius_mm: f64, looks_along_in_base: Vec3) -> RoughCell {
    RoughCell {
        mount: session.mount,
        flange_from_sensor,
        target_in_base_mm: Vec3::zeros(),
        radius_mm,
        noise: noise(session),
        looks_along_in_base,
    }
}

/// The same orientation, shifted across the laser line: what is off in the mounting does not matter, and the edge's direction
/// is known from the two.
fn beside(from: &SeenEdge, shift_mm: f64, mount: Mount, flange_from_sensor: &Rigid) -> PlannedStation {
    let pose = from.base_from_flange;
    let across = flange_from_sensor.rotation * Vec3::y() * shift_mm;
    let shift = match mount {
        Mount::OnFlange => pose.rotation() * across,
        // The plate moves, and the sensor stands.
        Mount::Fixed => -across,
    };
    PlannedStation {
        base_from_flange: Transform::from_parts(pose.translation_mm() + shift, pose.rotation()),
        edge: Some(from.edge),
        tilt_deg: 0.0,
        azimuth_deg: 0.0,
        spin_deg: 0.0,
        workspace_point_std_mm: None,
    }
}
