//! What the arcs panel draws, made without egui from the session and what was measured in it.

use crate::app::Results;
use crate::calibrate::{self, Edge, Method, Sweep, SweepPoint, solution_of};
use crate::fit::line::Line;
use crate::fit::{ArcFit, Circle, CircleMethod, EdgeFit, Feature, Flank, PointClass};
use crate::geometry::Profile;
use crate::session::{Reading, ScanLine, Session, Target};
use crate::text::arcs as text;

/// A capture in the list.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CaptureRow {
    /// Section radius of a ball, mm.
    pub section_radius_mm: Option<f64>,
    /// Fit RMS of a ball's arc, mm.
    pub rms_mm: Option<f64>,
    /// Point of an edge or tip in the laser plane, (x, z), mm.
    pub point_mm: Option<[f64; 2]>,
    /// What was found there.
    pub feature: Option<Feature>,
    /// What a profile of a scan holds.
    pub scan: Option<ScanLine>,
    /// What is wrong with it, in words.
    pub problem: Option<String>,
}

/// A station in the list.
#[derive(Clone, Debug, PartialEq)]
pub struct StationRow {
    /// The user's name for it.
    pub label: String,
    /// Whether it takes part.
    pub is_enabled: bool,
    /// The plate's edge that it saw.
    pub edge: Option<Edge>,
    /// Its captures.
    pub captures: Vec<CaptureRow>,
    /// Section radius of its first usable capture, mm: the one that the fixed-point method takes.
    pub section_radius_mm: Option<f64>,
    /// Fit RMS over its usable captures, mm.
    pub rms_mm: Option<f64>,
    /// What is wrong with it, in words.
    pub problem: Option<String>,
}

/// The list of stations.
#[must_use]
pub fn station_rows(session: &Session, results: Option<&Results>) -> Vec<StationRow> {
    session
        .stations
        .iter()
        .enumerate()
        .map(|(station_idx, station)| {
            let captures: Vec<CaptureRow> = (0..station.captures.len())
                .map(|capture_idx| {
                    let measured = results.map(|results| &*results.measured);
                    match measured.and_then(|measured| measured.scan_line(station_idx, capture_idx)) {
                        Some(line) => scan_row(line),
                        None => capture_row(measured.and_then(|measured| measured.reading(station_idx, capture_idx))),
                    }
                })
                .collect();
            let sweep = results.and_then(|results| sweep_of(results, station_idx));
            StationRow {
                label: station.label.clone(),
                is_enabled: station.enabled,
                edge: station.edge,
                section_radius_mm: captures.iter().find_map(|capture| capture.section_radius_mm),
                rms_mm: pooled_rms(&captures),
                problem: station_problem(&captures, sweep.map(|(_, sweep)| sweep)),
                captures,
            }
        })
        .collect()
}

fn capture_row(reading: Option<&calibrate::Reading>) -> CaptureRow {
    let mut row = CaptureRow::default();
    match reading {
        Some(calibrate::Reading::Arc(arc)) => {
            row.section_radius_mm = Some(arc.circle.radius_mm);
            row.rms_mm = Some(arc.rms_mm);
        }
        Some(calibrate::Reading::Refused(refusal)) => row.problem = Some(refusal.to_string()),
        Some(calibrate::Reading::Edge(edge)) => {
            row.point_mm = Some(edge.point_mm);
            row.feature = Some(edge.feature);
        }
        Some(calibrate::Reading::Point(point)) => row.point_mm = Some([point.x, point.z]),
        None => {}
    }
    row
}

/// Every point of a scan counts; that there is none is said.
fn scan_row(line: &ScanLine) -> CaptureRow {
    let problem = line.range_mm.is_none().then(|| text::EMPTY_PROFILE.to_owned());
    CaptureRow { scan: Some(*line), problem, ..CaptureRow::default() }
}

fn pooled_rms(captures: &[CaptureRow]) -> Option<f64> {
    let values: Vec<f64> = captures.iter().filter_map(|capture| capture.rms_mm).collect();
    (!values.is_empty()).then(|| crate::geometry::stats::rms(values))
}

fn station_problem(captures: &[CaptureRow], sweep: Option<&Sweep>) -> Option<String> {
    let num_refused = captures.iter().filter(|capture| capture.problem.is_some()).count();
    if num_refused > 0 {
        // The reason itself where there is only one.
        return Some(match captures {
            [CaptureRow { problem: Some(reason), .. }] => reason.clone(),
            _ => text::refused_captures(num_refused, captures.len()),
        });
    }
    sweep.filter(|sweep| !sweep.covers_peak).map(|_| text::PEAK_NOT_COVERED.to_owned())
}

/// The evaluated sweep of a station: that of the whole curve, else that of the published stop.
#[must_use]
pub fn sweep_of(results: &Results, station_idx: usize) -> Option<(Method, &Sweep)> {
    [Method::BallMaxArc, Method::BallMaxArcStep].into_iter().find_map(|method| {
        let stations = &solution_of(&results.methods, method)?.stations;
        let station = stations.iter().find(|station| station.station_idx == station_idx)?;
        station.sweep.as_ref().map(|sweep| (method, sweep))
    })
}

/// A point of a profile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProfilePoint {
    /// Across the line, mm.
    pub x_mm: f64,
    /// Along the range axis, mm.
    pub z_mm: f64,
    /// What it was taken for.
    pub class: PointClass,
    /// Distance from the shown circle, µm, positive outside; or from the nearest flank. NaN where there is neither.
    pub residual_um: f64,
}

/// The section found in a profile, as one of the circle fits sees it.
#[derive(Clone, Debug, PartialEq)]
pub struct SectionModel {
    /// The circle of the chosen fit.
    pub circle: Circle,
    /// Standard deviations of centre x, centre z and radius, mm, from the robust fit.
    pub std_mm: [f64; 3],
    /// RMS distance of the inliers from the shown circle, µm.
    pub rms_um: f64,
    /// Angle of the arc, degrees.
    pub angle_deg: f64,
    /// Shown minus robust circle, µm: centre x, centre z, radius.
    pub shift_um: [f64; 3],
}

/// The edge point found in a profile, with what it was found from.
#[derive(Clone, Debug, PartialEq)]
pub struct EdgeModel {
    /// What was found.
    pub feature: Feature,
    /// Where, (x, z), mm.
    pub point_mm: [f64; 2],
    /// Standard deviations of these, mm.
    pub std_mm: [f64; 2],
    /// The flanks.
    pub flanks: Vec<Flank>,
}

/// What was found in a profile.
#[derive(Clone, Debug, PartialEq)]
pub enum Found {
    /// A ball's section.
    Section(SectionModel),
    /// An edge, corner, step or tip.
    Edge(EdgeModel),
    /// A line over a workpiece, of which every point counts.
    Scan(ScanLine),
}

/// A profile with what was found in it.
#[derive(Clone, Debug, PartialEq)]
pub struct ProfileModel {
    /// The valid points.
    pub points: Vec<ProfilePoint>,
    /// What was found; the sentence says why there is nothing.
    pub found: Result<Found, String>,
    /// Whether z grows away from the sensor: the ball shows its near side, so its centre lies further away.
    pub z_grows_away: bool,
    /// The ball's radius, mm.
    pub ball_radius_mm: Option<f64>,
}

impl ProfileModel {
    /// The section, where one was found.
    #[must_use]
    pub const fn section(&self) -> Option<&SectionModel> {
        match &self.found {
            Ok(Found::Section(section)) => Some(section),
            _ => None,
        }
    }

    /// The edge point, where one was found.
    #[must_use]
    pub const fn edge(&self) -> Option<&EdgeModel> {
        match &self.found {
            Ok(Found::Edge(edge)) => Some(edge),
            _ => None,
        }
    }

    /// Whether the points have residuals: distances from a circle or from flanks.
    #[must_use]
    pub fn has_residuals(&self) -> bool {
        self.section().is_some() || self.edge().is_some_and(|edge| !edge.flanks.is_empty())
    }

    /// Number of points of a class.
    #[must_use]
    pub fn count(&self, class: PointClass) -> usize {
        self.points.iter().filter(|point| point.class == class).count()
    }
}

/// The profile of a capture for drawing, with the circle of `method` through the inliers.
#[must_use]
pub fn profile_model(
    profile: &Profile,
    reading: Option<&calibrate::Reading>,
    ball_radius_mm: Option<f64>,
    method: CircleMethod,
) -> ProfileModel {
    let (found, classes) = match reading {
        Some(calibrate::Reading::Arc(arc)) => (section_model(arc, method).map(Found::Section), arc.classes.as_slice()),
        Some(calibrate::Reading::Edge(edge)) => (Ok(Found::Edge(edge_model(edge))), edge.classes.as_slice()),
        Some(calibrate::Reading::Refused(refusal)) => (Err(refusal.to_string()), [].as_slice()),
        Some(calibrate::Reading::Point(_)) | None => (Err(text::NOT_MEASURED.to_owned()), [].as_slice()),
    };
    let class_of = |point_idx: usize| classes.get(point_idx).copied().unwrap_or(PointClass::Unused);
    drawn(profile, found, class_of, ball_radius_mm)
}

/// A line over a workpiece, for drawing.
#[must_use]
pub fn scan_model(profile: &Profile, line: &ScanLine) -> ProfileModel {
    let found = line.range_mm.map_or_else(|| Err(text::EMPTY_PROFILE.to_owned()), |_| Ok(Found::Scan(*line)));
    drawn(profile, found, |_| PointClass::Inlier, None)
}

fn drawn(
    profile: &Profile,
    found: Result<Found, String>,
    class_of: impl Fn(usize) -> PointClass,
    ball_radius_mm: Option<f64>,
) -> ProfileModel {
    let distance_mm: Box<dyn Fn(f64, f64) -> f64> = match &found {
        Ok(Found::Section(section)) => {
            let circle = section.circle;
            Box::new(move |x, z| circle.distance_mm(x, z))
        }
        Ok(Found::Edge(edge)) => {
            let lines: Vec<Line> =
                edge.flanks.iter().filter_map(|flank| Line::through(flank.ends_mm[0], flank.ends_mm[1])).collect();
            Box::new(move |x, z| nearest(lines.iter().map(|line| line.distance_mm([x, z]))))
        }
        Ok(Found::Scan(_)) | Err(_) => Box::new(|_, _| f64::NAN),
    };
    let points: Vec<ProfilePoint> = profile
        .valid_points()
        .map(|(point_idx, x_mm, z_mm)| ProfilePoint {
            x_mm,
            z_mm,
            class: class_of(point_idx),
            residual_um: distance_mm(x_mm, z_mm) * 1000.0,
        })
        .collect();
    let circle = match &found {
        Ok(Found::Section(section)) => Some(section.circle),
        _ => None,
    };
    ProfileModel { z_grows_away: z_grows_away(&points, circle.as_ref()), points, found, ball_radius_mm }
}

/// The distance of least size; NaN for none.
fn nearest(distances: impl Iterator<Item = f64>) -> f64 {
    distances.min_by(|a, b| a.abs().total_cmp(&b.abs())).unwrap_or(f64::NAN)
}

fn edge_model(edge: &EdgeFit) -> EdgeModel {
    EdgeModel { feature: edge.feature, point_mm: edge.point_mm, std_mm: edge.std_mm(), flanks: edge.flanks.clone() }
}

/// A station's point in the laser plane.
#[derive(Clone, Debug, PartialEq)]
pub struct SpreadPoint {
    /// The station.
    pub station_idx: usize,
    /// Its capture.
    pub capture_idx: usize,
    /// The station's name.
    pub label: String,
    /// Whether it takes part.
    pub is_enabled: bool,
    /// The edge that it is on.
    pub edge: Option<Edge>,
    /// Where, (x, z), mm.
    pub point_mm: [f64; 2],
}

/// Where in the laser plane all stations have their points: what the calibration knows of the sensor's plane comes from there.
#[must_use]
pub fn spread(rows: &[StationRow]) -> Vec<SpreadPoint> {
    let of_station = |(station_idx, row): (usize, &StationRow)| {
        let of_capture = |(capture_idx, capture): (usize, &CaptureRow)| {
            Some(SpreadPoint {
                station_idx,
                capture_idx,
                label: row.label.clone(),
                is_enabled: row.is_enabled,
                edge: row.edge,
                point_mm: capture.point_mm?,
            })
        };
        row.captures.iter().enumerate().filter_map(of_capture).collect::<Vec<_>>()
    };
    rows.iter().enumerate().flat_map(of_station).collect()
}

fn section_model(arc: &ArcFit, method: CircleMethod) -> Result<SectionModel, String> {
    let circle = match method {
        CircleMethod::Robust => arc.circle,
        other => other.fit(&arc.inlier_x_mm, &arc.inlier_z_mm).map_err(|error| error.to_string())?,
    };
    let distances = arc.inlier_x_mm.iter().zip(&arc.inlier_z_mm).map(|(x, z)| circle.distance_mm(*x, *z) * 1000.0);
    Ok(SectionModel {
        circle,
        std_mm: arc.std_mm(),
        rms_um: crate::geometry::stats::rms(distances),
        angle_deg: arc.angle_rad.to_degrees(),
        shift_um: [
            (circle.x_mm - arc.circle.x_mm) * 1000.0,
            (circle.z_mm - arc.circle.z_mm) * 1000.0,
            (circle.radius_mm - arc.circle.radius_mm) * 1000.0,
        ],
    })
}

fn z_grows_away(points: &[ProfilePoint], circle: Option<&Circle>) -> bool {
    let mean = |points: &mut dyn Iterator<Item = f64>| {
        let (sum, count) = points.fold((0.0, 0.0), |(sum, count), z| (sum + z, count + 1.0));
        if count > 0.0 { sum / count } else { 0.0 }
    };
    match circle {
        Some(circle) => {
            let mut on_arc = points.iter().filter(|point| point.class == PointClass::Inlier).map(|point| point.z_mm);
            mean(&mut on_arc) <= circle.z_mm
        }
        // Without an arc, most profilers count the range from themselves.
        None => mean(&mut points.iter().map(|point| point.z_mm)) >= 0.0,
    }
}

/// What the middle of the panel shows for a capture.
#[derive(Clone, Debug, PartialEq)]
pub enum CaptureView {
    /// A profile.
    Profile(ProfileModel),
    /// A point, already reduced elsewhere: its coordinates in the sensor frame, mm.
    Point([f64; 3]),
}

/// The view of a capture; `None` if the session has no such capture.
#[must_use]
pub fn capture_view(
    session: &Session,
    results: Option<&Results>,
    station_idx: usize,
    capture_idx: usize,
    method: CircleMethod,
) -> Option<CaptureView> {
    let capture = session.stations.get(station_idx)?.captures.get(capture_idx)?;
    Some(match &capture.reading {
        Reading::Point(point) => CaptureView::Point([point.x, point.y, point.z]),
        Reading::Profile(profile) => {
            let measured = results.map(|results| &*results.measured);
            let reading = measured.and_then(|measured| measured.reading(station_idx, capture_idx));
            let line = measured.and_then(|measured| measured.scan_line(station_idx, capture_idx));
            CaptureView::Profile(line.map_or_else(
                || profile_model(profile, reading, ball_radius_mm(session), method),
                |line| scan_model(profile, line),
            ))
        }
    })
}

/// The ball's radius, mm, if the target is a ball.
#[must_use]
pub const fn ball_radius_mm(session: &Session) -> Option<f64> {
    match session.target {
        Target::Ball { radius_mm, .. } => Some(radius_mm),
        _ => None,
    }
}

/// Where a fitted curve has its peak: l² = R² − c (travel − peak)².
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Peak {
    /// The peak along the travel, mm.
    pub travel_mm: f64,
    /// Its σ, mm.
    pub std_mm: f64,
    /// The factor c: 1 for a travel along the laser's normal.
    pub curvature: f64,
}

impl Peak {
    /// The radius of the section at a place of the travel, mm; 0 beyond the ball.
    #[must_use]
    pub fn section_radius_mm(&self, travel_mm: f64, ball_radius_mm: f64) -> f64 {
        let offset_mm = travel_mm - self.travel_mm;
        (ball_radius_mm * ball_radius_mm - self.curvature * offset_mm * offset_mm).max(0.0).sqrt()
    }
}

/// The radius against the step as it is drawn, of an evaluated sweep or of a search under way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Curve<'a> {
    /// The steps with an arc.
    pub points: &'a [SweepPoint],
    /// The curve through them, once there is one.
    pub peak: Option<Peak>,
    /// Where the published rule stops.
    pub published_stop_mm: Option<f64>,
}

impl<'a> Curve<'a> {
    /// The curve of an evaluated sweep.
    #[must_use]
    pub fn of(sweep: &'a Sweep) -> Self {
        Self {
            points: &sweep.points,
            peak: Some(Peak { travel_mm: sweep.peak_mm, std_mm: sweep.peak_std_mm, curvature: 1.0 }),
            published_stop_mm: Some(sweep.published_stop_mm),
        }
    }
}

/// The fitted curve as points to draw; empty beyond the ball.
#[must_use]
pub fn curve_points(peak: &Peak, ball_radius_mm: f64, travel_mm: [f64; 2]) -> Vec<[f64; 2]> {
    const NUM_POINTS: u32 = 160;
    (0..=NUM_POINTS)
        .filter_map(|idx| {
            let travel = travel_mm[0] + (travel_mm[1] - travel_mm[0]) * f64::from(idx) / f64::from(NUM_POINTS);
            let radius = peak.section_radius_mm(travel, ball_radius_mm);
            (radius > 0.0).then_some([travel, radius])
        })
        .collect()
}

#[cfg(test)]
#[path = "model_tests.rs"]
mod tests;
