//! What is drawn of a profile, made from what was found in it; the window and the figures share it.

use crate::calibrate;
use crate::fit::line::Line;
use crate::fit::{ArcFit, Circle, CircleMethod, EdgeFit, Feature, Flank, PointClass};
use crate::geometry::Profile;
use crate::report::figure::Extent;
use crate::session::{ScanLine, Session, Target};
use crate::text::arcs as text;

/// How far around an edge point the view reaches, as a part of the profile's width.
const SURROUNDINGS_PART: f64 = 0.3;

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
        Some(calibrate::Reading::Point(_) | calibrate::Reading::Pose(_)) | None => {
            (Err(text::NOT_MEASURED.to_owned()), [].as_slice())
        }
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

/// The ball's radius, mm, if the target is a ball.
#[must_use]
pub const fn ball_radius_mm(session: &Session) -> Option<f64> {
    match session.target {
        Target::Ball { radius_mm, .. } => Some(radius_mm),
        _ => None,
    }
}

/// The surroundings of an edge point; else the near half of the ball with some room towards the sensor; all points as well where `shows_whole`, and only them
/// without a section.
#[must_use]
pub fn extent(model: &ProfileModel, shows_whole: bool) -> Extent {
    let mut extent = Extent::NOTHING;
    if let Some(SectionModel { circle, .. }) = model.section() {
        let reach_mm = model.ball_radius_mm.unwrap_or(circle.radius_mm).max(circle.radius_mm);
        let towards_sensor = if model.z_grows_away { -1.0 } else { 1.0 };
        extent.include(circle.x_mm - reach_mm * 1.15, circle.z_mm + towards_sensor * reach_mm * 1.2);
        extent.include(circle.x_mm + reach_mm * 1.15, circle.z_mm - towards_sensor * reach_mm * 0.45);
        if !shows_whole {
            return extent;
        }
    }
    for point in &model.points {
        extent.include(point.x_mm, point.z_mm);
    }
    if let Some(edge) = model.edge().filter(|_| !shows_whole) {
        let reach_mm = (extent.x[1] - extent.x[0]) * SURROUNDINGS_PART;
        let [x_mm, z_mm] = edge.point_mm;
        return Extent { x: [x_mm - reach_mm, x_mm + reach_mm], y: [z_mm - reach_mm, z_mm + reach_mm] };
    }
    extent
}

/// Room for the residuals of the inliers, µm; of x nothing is said.
#[must_use]
pub fn residual_extent(model: &ProfileModel) -> Extent {
    let largest = inliers(model).map(|point| point.residual_um.abs()).fold(1.0, f64::max);
    Extent { x: [-1.0, 1.0], y: [-largest * 1.1, largest * 1.1] }
}

/// The points on what was found.
pub fn inliers(model: &ProfileModel) -> impl Iterator<Item = &ProfilePoint> {
    model.points.iter().filter(|point| point.class == PointClass::Inlier)
}

#[cfg(test)]
#[path = "profile_tests.rs"]
mod tests;
