//! A live cell before its first solution: what the stations so far say about a mounting that was only guessed, and where to
//! measure next without losing the ball.
//!
//! With one station the ball's place is known as well as the guess allows, and turning the sensor much would lose the ball:
//! it moves in the view by the turn times what the mounting is off. So the first stations turn little about the ball, and
//! the more the estimate improves the further the next ones go. Among the stations that are sure to see the ball the one
//! is chosen that makes the result better known most, as everywhere in [`super`].

use nalgebra::{Matrix6, Vector6};

use crate::calibrate::Mount;
use crate::calibrate::ball::MIN_STATIONS;
use crate::calibrate::observation::{CentreObservation, NUM_UNKNOWNS, State};
use crate::calibrate::solver::{Gradient, Hessian, Normal, covariance_for_unit_noise, minimise_sums};
use crate::geometry::{Base, Flange, Mat3, Rigid, Transform, Vec3, se3};

use super::ball::{Ball, StationModel};
use super::information::Information;
use super::nominal;
use super::orientation::Orientations;
use super::search::{Search, Taken};
use super::sight::Sight;
use super::{Limits, PlanRefusal, PlannedStation, RoughCell};

/// σ of a guessed mounting about and along each axis: within 10° and 20 mm is two of them.
pub(super) const GUESS_STD_DEG: f64 = 5.0;
pub(super) const GUESS_STD_MM: f64 = 10.0;
/// No station is taken for better than this, mm: what is estimated here need not be a calibration.
pub(super) const LEAST_STD_MM: f64 = 0.05;
/// Where the ball's centre is beside the laser plane at the first capture, radii; the nearer to 0, the surer it is struck.
const FIRST_SECTION_RADII: [f64; 3] = [0.5, 0.25, 0.0];
/// Further beside than this, radii, a section is too small for an arc.
const STRUCK_RADII: f64 = 0.85;

/// A station of a live cell, reduced to where it saw the ball.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasuredStation {
    /// The pose at which the ball was seen there, as the controller reports it.
    pub base_from_flange: Transform<Base, Flange>,
    /// The ball's centre in the sensor frame, mm.
    pub target_in_sensor_mm: Vec3,
    /// Its σ along each axis, mm.
    pub std_mm: Vec3,
}

impl MeasuredStation {
    /// Of a search that found its peak: at the peak the ball's centre is in the laser plane, at the centre of the section.
    ///
    /// `base_from_flange` is the pose at the peak: that of the first capture, moved along the travel as far as the peak is.
    /// The centre is that of the section nearest to it.
    #[must_use]
    pub fn at_peak(base_from_flange: Transform<Base, Flange>, section_centre_mm: [f64; 2], peak_std_mm: f64) -> Self {
        let [x_mm, z_mm] = section_centre_mm;
        Self {
            base_from_flange,
            target_in_sensor_mm: Vec3::new(x_mm, 0.0, z_mm),
            std_mm: Vec3::new(0.0, peak_std_mm, 0.0),
        }
    }

    /// Of a single profile. The ball's centre is √(R² − l²) beside the laser plane, on the one side or the other: as good
    /// as in it with that for its σ.
    #[must_use]
    pub fn of_section(
        base_from_flange: Transform<Base, Flange>,
        section_centre_mm: [f64; 2],
        section_radius_mm: f64,
        ball_radius_mm: f64,
    ) -> Self {
        let beside_mm = (ball_radius_mm.powi(2) - section_radius_mm.powi(2)).max(0.0).sqrt();
        Self::at_peak(base_from_flange, section_centre_mm, beside_mm)
    }

    fn observation(&self, station: usize, mount: Mount) -> CentreObservation {
        let base_from_flange = match mount {
            Mount::OnFlange => *self.base_from_flange.rigid(),
            Mount::Fixed => self.base_from_flange.rigid().inverse(),
        };
        let information = self.std_mm.map(|std_mm| std_mm.hypot(LEAST_STD_MM).powi(-2));
        CentreObservation {
            information: Mat3::from_diagonal(&information),
            ..CentreObservation::point(station, base_from_flange, self.target_in_sensor_mm)
        }
    }
}

/// Where the ball's centre can be seen, in the sensor frame, mm. The range axis may point either way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// How far across the line it may be from x = 0.
    pub half_width_mm: f64,
    /// How far along the range axis it may be from the middle.
    pub half_range_mm: f64,
    /// The middle: z in the sensor frame.
    pub middle_range_mm: f64,
}

/// The estimate and what is known by it.
struct Refined {
    state: State,
    /// With the guess.
    information: Hessian,
    /// Of the guess alone.
    prior: Hessian,
}

/// The cell with its mounting and ball as the guess and the stations together have them: the most probable ones, a guess
/// being within 10° and 20 mm. One station moves the ball to where it was seen; without any the cell stays as it is.
///
/// `cell` is always the first guess, not an estimate that the same stations went into.
#[must_use]
pub fn refined(cell: &RoughCell, stations: &[MeasuredStation]) -> RoughCell {
    estimate(cell, stations).map_or(*cell, |refined| RoughCell {
        flange_from_sensor: refined.state.flange_from_sensor,
        target_in_base_mm: refined.state.ball_in_base,
        ..*cell
    })
}

/// The next station of a cell that has no solution yet, and the cell as it is known now, see [`refined`].
///
/// Orientations are relative to that of the first station, which the operator chose; before it the sensor looks along the
/// cell's direction. `avoided` are poses, asked for already, that could not be gone to or were not wanted: the next one is
/// turned away from them as from the measured ones. Of the limits only the angles matter, as the view says the rest.
///
/// # Errors
/// [`PlanRefusal::NothingWithinLimits`] if no orientation is sure to keep the ball in view,
/// [`PlanRefusal::Undetermined`] if the cell's numbers are none.
pub fn next_rough(
    cell: &RoughCell,
    stations: &[MeasuredStation],
    avoided: &[Transform<Base, Flange>],
    view: &View,
    limits: &Limits,
) -> Result<(PlannedStation, RoughCell), PlanRefusal> {
    let looks_along = nominal::checked(cell)?;
    let half = Vec3::new(view.half_width_mm, STRUCK_RADII * cell.radius_mm, view.half_range_mm);
    let middle = Vec3::new(0.0, 0.0, view.middle_range_mm);
    if !half.iter().all(|v| *v > 0.0) || !middle.z.is_finite() {
        return Err(PlanRefusal::NothingWithinLimits);
    }
    let now = refined(cell, stations);
    let base_from_sensor = |pose: &Transform<Base, Flange>| {
        let rotation = pose.rotation();
        let carrier = if cell.mount == Mount::Fixed { rotation.inverse() } else { rotation };
        carrier * now.flange_from_sensor.rotation
    };
    let reference = stations.first().map_or_else(
        || nominal::reference(looks_along, &now.flange_from_sensor.rotation),
        |first| base_from_sensor(&first.base_from_flange),
    );
    let (_, about_sensor) = nominal::usual_sweep(&now, view.middle_range_mm);
    let shift_mm = [0, 2].map(|axis| [-half[axis], half[axis]]);
    let model = |radii: f64| StationModel {
        first_ball_in_sensor: middle + Vec3::y() * (radii * cell.radius_mm),
        about_sensor,
        shift_mm,
    };
    let ball = Ball {
        state: State { flange_from_sensor: now.flange_from_sensor, ball_in_base: now.target_in_base_mm },
        models: FIRST_SECTION_RADII.map(model).to_vec(),
        orientations: Orientations::new(reference, limits)?,
        sight: None,
    };
    let Some(estimate) = estimate(cell, stations) else {
        let known = Information::new(&nominal::prior(), middle);
        let mut search = Search::new(cell.mount, now.flange_from_sensor, ball, known, Vec::new());
        let station = search.reference(|_| None).ok_or(PlanRefusal::NothingWithinLimits)?;
        return Ok((station, now));
    };
    let known = Information::new(&estimate.information, middle);
    let covariance = covariance_for_unit_noise(&estimate.information).map_err(|_| PlanRefusal::Undetermined)?;
    let ball = Ball { sight: Some(Sight { covariance, middle, half }), ..ball };
    let poses = stations.iter().map(|station| &station.base_from_flange).chain(avoided);
    let taken = poses.map(|pose| Taken { base_from_sensor: base_from_sensor(pose), edge: None }).collect();
    let mut search = Search::new(cell.mount, now.flange_from_sensor, ball, known, taken);
    let is_determined = stations.len() + 1 >= MIN_STATIONS;
    let point_std = |information: &Information<NUM_UNKNOWNS>| {
        // What is known of the mounting by guess is no measurement.
        is_determined.then(|| information.without(&estimate.prior).point_std()).flatten()
    };
    let station = search.next(point_std).ok_or(PlanRefusal::NothingWithinLimits)?;
    Ok((station, now))
}

/// The most probable mounting and ball; `None` without stations, or if the numbers are none.
fn estimate(cell: &RoughCell, stations: &[MeasuredStation]) -> Option<Refined> {
    let observations: Vec<CentreObservation> =
        stations.iter().enumerate().map(|(idx, station)| station.observation(idx, cell.mount)).collect();
    let first = observations.first()?;
    let ball_in_base =
        first.base_from_flange * cell.flange_from_sensor * nalgebra::Point3::from(first.centre_in_sensor);
    let start = State { flange_from_sensor: cell.flange_from_sensor, ball_in_base: ball_in_base.coords };
    let sums_at = |state: &State| with_guess(&Normal::of(observations.iter(), state), state, cell);
    let minimum = minimise_sums(sums_at, start).ok()?;
    let (state, information) = (minimum.state, minimum.hessian);
    let prior = with_guess(&Normal::zero(), &state, cell).hessian;
    Some(Refined { state, information, prior })
}

/// Adds what the guess says about the mounting.
fn with_guess(normal: &Normal, state: &State, cell: &RoughCell) -> Normal {
    let guess = Guess::at(&cell.flange_from_sensor, &state.flange_from_sensor, GUESS_STD_DEG, GUESS_STD_MM);
    let mut hessian = Hessian::zeros();
    hessian.fixed_view_mut::<6, 6>(0, 0).copy_from(&guess.hessian);
    let mut gradient = Gradient::zeros();
    gradient.fixed_rows_mut::<6>(0).copy_from(&guess.gradient);
    Normal { hessian: normal.hessian + hessian, gradient: normal.gradient + gradient, cost: normal.cost + guess.cost }
}

/// The sums of a guessed frame: e = log(guess⁻¹ X) is zero within its σ.
pub(super) struct Guess {
    pub hessian: Matrix6<f64>,
    pub gradient: Vector6<f64>,
    pub cost: f64,
}

impl Guess {
    /// At a frame that is stepped to its right.
    pub fn at(guessed: &Rigid, frame: &Rigid, std_deg: f64, std_mm: f64) -> Self {
        let off: Vector6<f64> = se3::log(&(guessed.inverse() * frame));
        let (by_turn, by_length) = (std_deg.to_radians().powi(-2), std_mm.powi(-2));
        let weights = Matrix6::from_diagonal(&Vector6::new(by_turn, by_turn, by_turn, by_length, by_length, by_length));
        // Such a step changes the logarithm by the inverse of the right Jacobian.
        let by_step = se3::right_jacobian(&off).try_inverse().unwrap_or_else(Matrix6::identity);
        Self {
            hessian: by_step.transpose() * weights * by_step,
            gradient: -(by_step.transpose() * weights * off),
            cost: off.dot(&(weights * off)),
        }
    }
}
