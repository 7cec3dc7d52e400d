//! Stations one after the other: the best of a grid, then the best nearby.

use nalgebra::UnitQuaternion;

use crate::calibrate::Mount;
use crate::calibrate::observation::State;
use crate::calibrate::solver::Hessian;
use crate::geometry::{Mat3, Rigid, Transform, Vec3};

use super::PlannedStation;
use super::information::{Information, information_at};
use super::orientation::{Orientation, Orientations};
use super::sight::Sight;
use super::typical::StationModel;

/// Stations nearer to each other than this, rad (8°), share too much: what the model does not know of, as a bent axis of
/// the robot, would be seen once only. Smaller limits are shared out as well as they can be.
const APART: [f64; 3] = [0.14, 0.035, 0.0];
/// The refinement begins with this part of the grid's steps ...
const FIRST_REFINEMENT: f64 = 0.5;
/// ... and ends after so many halvings, below a degree.
const NUM_REFINEMENTS: u32 = 5;

/// What is measured with what, as far as it is known.
#[derive(Clone, Debug)]
pub(super) struct Cell {
    pub mount: Mount,
    pub state: State,
    /// The kinds of station to choose from; at least one.
    pub models: Vec<StationModel>,
}

/// A place for a station.
#[derive(Clone, Copy, Debug)]
struct Candidate {
    orientation: Orientation,
    model_idx: usize,
    /// How far the ball is shifted from where the model has it, across the line and along the range: parts of the way
    /// from the least to the greatest shift.
    place: [f64; 2],
}

/// Parts of the limits for which a grid is tried where the ball may leave the view.
const PARTS: [f64; 4] = [1.0, 0.5, 0.25, 0.1];

/// The places of the ball that the grid tries: in the middle, and in the corners of the view.
const PLACES: [[f64; 2]; 5] = [[0.5, 0.5], [0.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 1.0]];

/// The reference orientation, with the ball in the middle of the view.
const UPRIGHT: Candidate =
    Candidate { orientation: Orientation { tilt: 0.0, azimuth: 0.0, spin: 0.0 }, model_idx: 0, place: PLACES[0] };

/// The state of a plan.
#[derive(Clone, Debug)]
pub(super) struct Search {
    cell: Cell,
    orientations: Orientations,
    known: Information,
    /// Orientations planned so far.
    taken: Vec<UnitQuaternion<f64>>,
    /// Whether the ball is sure to be seen; `None` where there is no doubt.
    sight: Option<Sight>,
}

impl Search {
    /// `taken`: the orientations that were measured at already.
    pub fn new(cell: Cell, orientations: Orientations, known: &Information, taken: Vec<UnitQuaternion<f64>>) -> Self {
        Self { cell, orientations, known: *known, taken, sight: None }
    }

    /// Only stations at which the ball is sure to be seen.
    pub fn within_sight(self, sight: &Sight) -> Self {
        Self { sight: Some(*sight), ..self }
    }

    /// Plans the station that helps most; `None` if there is none. `point_std` says what σ to state for what is known then.
    pub fn next(&mut self, point_std: impl Fn(&Information) -> Option<f64>) -> Option<PlannedStation> {
        // What is sure to be seen may be so near to the reference that it falls between the points of the whole grid.
        let parts = if self.sight.is_some() { &PARTS[..] } else { &PARTS[..1] };
        let grids: Vec<Vec<Orientation>> = parts.iter().map(|part| self.orientations.grid(*part)).collect();
        let best = APART.iter().find_map(|apart| {
            let start = grids.iter().find_map(|grid| self.best_of_grid(grid, *apart))?;
            Some(self.refined(start, *apart))
        })?;
        Some(self.take(best, point_std))
    }

    /// Plans a station at the reference orientation.
    pub fn reference(&mut self, point_std: impl Fn(&Information) -> Option<f64>) -> PlannedStation {
        self.take(UPRIGHT, point_std)
    }

    fn best_of_grid(&self, grid: &[Orientation], apart: f64) -> Option<(Candidate, f64)> {
        let mut best: Option<(Candidate, f64)> = None;
        for orientation in grid.iter().filter(|orientation| self.is_apart(**orientation, apart)) {
            let sensor_from_base = self.sensor_from_base(*orientation);
            for model_idx in 0..self.cell.models.len() {
                for place in PLACES {
                    let candidate = Candidate { orientation: *orientation, model_idx, place };
                    if !self.is_seen(&candidate, &sensor_from_base) {
                        continue;
                    }
                    let variance = self.known.variance_with(&self.brings(&candidate, &sensor_from_base));
                    if best.is_none_or(|(_, least)| variance < least) {
                        best = Some((candidate, variance));
                    }
                }
            }
        }
        best
    }

    /// Goes along one coordinate at a time while that helps, in ever smaller steps.
    fn refined(&self, (start, start_variance): (Candidate, f64), apart: f64) -> Candidate {
        let (mut best, mut least) = (start, start_variance);
        let [tilt, azimuth, spin] = self.orientations.grid_steps();
        let mut part = FIRST_REFINEMENT;
        for _ in 0..NUM_REFINEMENTS {
            for direction in [1.0, -1.0].map(|sign| sign * part) {
                for coordinate in 0..5 {
                    let mut trial = best;
                    match coordinate {
                        0 => trial.orientation.tilt += direction * tilt,
                        1 => trial.orientation.azimuth += direction * azimuth,
                        2 => trial.orientation.spin += direction * spin,
                        3 => trial.place[0] += direction,
                        _ => trial.place[1] += direction,
                    }
                    trial.orientation = self.orientations.within_limits(trial.orientation);
                    trial.place = trial.place.map(|along| along.clamp(0.0, 1.0));
                    if !self.is_apart(trial.orientation, apart) {
                        continue;
                    }
                    let sensor_from_base = self.sensor_from_base(trial.orientation);
                    if !self.is_seen(&trial, &sensor_from_base) {
                        continue;
                    }
                    let variance = self.known.variance_with(&self.brings(&trial, &sensor_from_base));
                    if variance < least {
                        (best, least) = (trial, variance);
                    }
                }
            }
            part *= 0.5;
        }
        best
    }

    fn take(&mut self, candidate: Candidate, point_std: impl Fn(&Information) -> Option<f64>) -> PlannedStation {
        let base_from_sensor = self.orientations.base_from_sensor(candidate.orientation);
        let station = self.brings(&candidate, &self.sensor_from_base(candidate.orientation));
        self.known = self.known.with(&station);
        self.taken.push(base_from_sensor);
        let model = &self.cell.models[candidate.model_idx];
        let ball_in_sensor = model.first_ball_in_sensor + shift(model, candidate.place);
        let origin = self.cell.state.ball_in_base - base_from_sensor * ball_in_sensor;
        let base_from_flange =
            Rigid::from_parts(origin.into(), base_from_sensor) * self.cell.state.flange_from_sensor.inverse();
        PlannedStation {
            base_from_flange: Transform::from_rigid(match self.cell.mount {
                Mount::OnFlange => base_from_flange,
                Mount::Fixed => base_from_flange.inverse(),
            }),
            tilt_deg: candidate.orientation.tilt.to_degrees(),
            azimuth_deg: candidate.orientation.azimuth_deg(),
            spin_deg: candidate.orientation.spin.to_degrees(),
            workspace_point_std_mm: point_std(&self.known),
        }
    }

    fn brings(&self, candidate: &Candidate, sensor_from_base: &Mat3) -> Hessian {
        let model = &self.cell.models[candidate.model_idx];
        information_at(&model.about_sensor, shift(model, candidate.place), sensor_from_base)
    }

    fn sensor_from_base(&self, orientation: Orientation) -> Mat3 {
        self.orientations.base_from_sensor(orientation).inverse().to_rotation_matrix().into_inner()
    }

    fn is_seen(&self, candidate: &Candidate, sensor_from_base: &Mat3) -> bool {
        let model = &self.cell.models[candidate.model_idx];
        let ball_in_sensor = model.first_ball_in_sensor + shift(model, candidate.place);
        self.sight.as_ref().is_none_or(|sight| sight.sees(ball_in_sensor, sensor_from_base))
    }

    fn is_apart(&self, orientation: Orientation, apart: f64) -> bool {
        let base_from_sensor = self.orientations.base_from_sensor(orientation);
        self.taken.iter().all(|taken| taken.angle_to(&base_from_sensor) >= apart)
    }
}

fn shift(model: &StationModel, place: [f64; 2]) -> Vec3 {
    let [across, along] =
        [0, 1].map(|idx| model.shift_mm[idx][0] + place[idx] * (model.shift_mm[idx][1] - model.shift_mm[idx][0]));
    Vec3::new(across, 0.0, along)
}
