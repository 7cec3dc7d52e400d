//! A cell in which nothing is measured yet: sweeps as they are usual, with a sensor and a robot of usual noise.

use nalgebra::{Matrix6, UnitQuaternion};

use crate::calibrate::Mount;
use crate::calibrate::observation::{CentreObservation, State};
use crate::calibrate::solver::{Gradient, Hessian, Normal};
use crate::geometry::{Mat3, Rigid, Vec3, so3};

use super::ball::{Ball, Room, StationModel, about_sensor};
use super::orientation::Orientations;
use super::{Limits, PlanRefusal, RoughCell};

/// Noise of a point along the range axis, mm: that of common profilers.
const PROFILE_STD_MM: f64 = 0.01;
/// Noise of each coordinate of a reported position, mm, and ...
pub(super) const POSITION_STD_MM: f64 = 0.02;
/// ... of a reported orientation about each axis, degrees: a good arm of middle size.
pub(super) const ORIENTATION_STD_DEG: f64 = 0.005;
/// Distance of the ball's centre along the range axis where the limits do not say, mm.
const STANDOFF_MM: f64 = 100.0;
/// How far the ball may be from the middle of the profile, and nearer or further than the stand-off, where the limits do
/// not say, radii.
const VIEW_RADII: f64 = 0.5;
/// A sweep: distance of the first section from the ball's centre and the step, radii, and its captures.
const FIRST_SECTION_RADII: f64 = 0.6;
const STEP_RADII: f64 = 0.05;
const NUM_CAPTURES: u32 = 21;
/// Points on an arc, and the angle either side of its top that they cover, degrees.
const NUM_POINTS: u32 = 200;
const HALF_ANGLE_DEG: f64 = 60.0;
/// A tip is seen once: how well along either axis of the laser plane and, by the aim, across it, mm ...
const TIP_STD_MM: f64 = 0.03;
/// ... and how far from the middle of the profile and from the stand-off it may be, mm.
const TIP_VIEW_MM: f64 = 10.0;
/// How well the mounting and the ball are known by guess: degrees and mm.
const GUESS_STD_DEG: f64 = 10.0;
const GUESS_STD_MM: f64 = 20.0;

/// The cell, ready to be searched.
#[derive(Clone, Debug)]
pub(super) struct Nominal {
    pub ball: Ball,
    pub reference_point_in_sensor: Vec3,
}

impl Nominal {
    /// # Errors
    /// [`PlanRefusal::NothingWithinLimits`] if the ball does not stay in view or nothing may be turned,
    /// [`PlanRefusal::Undetermined`] if the cell's numbers are none.
    pub fn new(rough: &RoughCell, limits: &Limits) -> Result<Self, PlanRefusal> {
        let looks_along = checked(rough)?;
        let mounting = rough.flange_from_sensor;
        let [least, most] = limits.standoff_mm.unwrap_or([STANDOFF_MM; 2]);
        let standoff_mm = f64::midpoint(least, most);
        let is_tip = rough.radius_mm == 0.0;
        let slack = Vec3::new(1.0, 0.0, 1.0) * if is_tip { TIP_VIEW_MM } else { VIEW_RADII * rough.radius_mm };
        let middle = Vec3::new(0.0, 0.0, standoff_mm);
        let room = Room::new(limits, [middle - slack, middle + slack].into_iter());
        let (balls, about_sensor) = usual_sweep(rough, standoff_mm);
        let model = StationModel::new(&balls, &about_sensor, &room).ok_or(PlanRefusal::NothingWithinLimits)?;
        Ok(Self {
            ball: Ball {
                state: State { flange_from_sensor: mounting, ball_in_base: rough.target_in_base_mm },
                models: vec![model],
                orientations: Orientations::new(reference(looks_along, &mounting.rotation), limits)?,
                sight: None,
            },
            reference_point_in_sensor: middle,
        })
    }
}

/// The direction along which the sensor looks.
///
/// # Errors
/// [`PlanRefusal::Undetermined`] if the cell's numbers are none.
pub(super) fn checked(rough: &RoughCell) -> Result<Vec3, PlanRefusal> {
    let looks_along = rough.looks_along_in_base.try_normalize(0.0).ok_or(PlanRefusal::Undetermined)?;
    let mounting = rough.flange_from_sensor.to_homogeneous();
    let mut figures = mounting.iter().chain(rough.target_in_base_mm.iter()).chain(looks_along.iter());
    let is_sound = figures.all(|v| v.is_finite()) && rough.radius_mm >= 0.0;
    if is_sound { Ok(looks_along) } else { Err(PlanRefusal::Undetermined) }
}

/// Where the ball is at each capture of a usual sweep, or a tip at its only one, and what that says about (rotation, translation).
pub(super) fn usual_sweep(rough: &RoughCell, standoff_mm: f64) -> (Vec<Vec3>, Matrix6<f64>) {
    let sweep = sweep(rough, standoff_mm);
    // With the sensor at the base's origin the ball is where a capture sees it.
    let at_origin = State { flange_from_sensor: Rigid::identity(), ball_in_base: Vec3::zeros() };
    let about_sensor = about_sensor(&Normal::of(sweep.iter(), &at_origin));
    (sweep.iter().map(|capture| capture.centre_in_sensor).collect(), about_sensor)
}

/// The captures of a sweep, as a sensor at the base's origin would see the ball pass: what the profiles say about its
/// centre.
fn sweep(rough: &RoughCell, standoff_mm: f64) -> Vec<CentreObservation> {
    // An error of the orientation acts with the lever from the flange to the ball; across the lever in every direction that
    // a station may have.
    let ball_in_flange = match rough.mount {
        Mount::OnFlange => rough.flange_from_sensor * nalgebra::Point3::new(0.0, 0.0, standoff_mm),
        Mount::Fixed => rough.target_in_base_mm.into(),
    };
    let orientation_std_rad = rough.noise.orientation_std_rad.unwrap_or_else(|| ORIENTATION_STD_DEG.to_radians());
    let position_std_mm = rough.noise.position_std_mm.unwrap_or(POSITION_STD_MM);
    let turned_mm = orientation_std_rad * ball_in_flange.coords.norm();
    let pose_covariance = Mat3::identity() * (position_std_mm.powi(2) + turned_mm.powi(2) * 2.0 / 3.0);
    let is_tip = rough.radius_mm == 0.0;
    (0..if is_tip { 1 } else { NUM_CAPTURES })
        .map(|idx| {
            let y_mm = rough.radius_mm * (FIRST_SECTION_RADII - STEP_RADII * f64::from(idx));
            let by_points = if is_tip {
                Mat3::identity() * TIP_STD_MM.powi(-2)
            } else {
                section_information(y_mm / rough.radius_mm)
            };
            let damp = Mat3::identity() + by_points * pose_covariance;
            let information = damp.try_inverse().map_or(by_points, |damp| damp * by_points);
            let pose = Rigid::translation(0.0, -y_mm, -standoff_mm);
            CentreObservation { information, ..CentreObservation::point(0, pose, Vec3::new(0.0, y_mm, standoff_mm)) }
        })
        .collect()
}

/// What the points of a section at `y` (in radii) say about the ball's centre: Σ u uᵀ over its points, u from the centre to
/// the point, weighed as in the bundle.
fn section_information(y: f64) -> Mat3 {
    let section = (1.0 - y * y).sqrt();
    let sum: Mat3 = (0..NUM_POINTS)
        .map(|idx| {
            let part = 2.0 * f64::from(idx) / f64::from(NUM_POINTS - 1) - 1.0;
            let (sin, cos) = (HALF_ANGLE_DEG.to_radians() * part).sin_cos();
            let direction = Vec3::new(section * sin, -y, -section * cos);
            direction * direction.transpose()
        })
        .sum();
    sum / (section * PROFILE_STD_MM).powi(2)
}

/// The sensor looking along a direction, turned so that the flange's x is as near to the base's as may be.
pub(super) fn reference(looks_along: Vec3, mounting: &UnitQuaternion<f64>) -> UnitQuaternion<f64> {
    let half_turn = so3::exp(Vec3::x() * std::f64::consts::PI);
    let looking = UnitQuaternion::rotation_between(&Vec3::z(), &looks_along).unwrap_or(half_turn);
    let flange_x = looking * (mounting.inverse() * Vec3::x());
    // The turn that brings the part of one across the axis onto that of the other.
    let sin = Vec3::x().dot(&looks_along.cross(&flange_x));
    let cos = flange_x.x - looks_along.x * looks_along.dot(&flange_x);
    so3::exp(looks_along * sin.atan2(cos)) * looking
}

/// What a guess says about the unknowns.
pub(super) fn prior() -> Hessian {
    let by_turn = GUESS_STD_DEG.to_radians().powi(-2);
    let by_length = GUESS_STD_MM.powi(-2);
    Hessian::from_diagonal(&Gradient::from_fn(|idx, _| if idx < 3 { by_turn } else { by_length }))
}
