//! Stations one after the other: the best of a grid, then the best nearby.

use nalgebra::{SMatrix, UnitQuaternion};

use crate::calibrate::{Edge, Mount};
use crate::geometry::{Rigid, Transform, Vec3};

use super::PlannedStation;
use super::information::Information;
use super::orientation::{Orientation, Orientations};

/// Stations nearer to each other than this, rad (8°), share too much: what the model does not know of, as a bent axis of
/// the robot, would be seen once only. Smaller limits are shared out as well as they can be.
const APART: [f64; 3] = [0.14, 0.035, 0.0];
/// The refinement begins with this part of the grid's steps ...
const FIRST_REFINEMENT: f64 = 0.5;
/// ... and ends after so many halvings, below a degree.
const NUM_REFINEMENTS: u32 = 5;
/// Parts of the limits for which a grid is tried where the target may leave the view.
const PARTS: [f64; 4] = [1.0, 0.5, 0.25, 0.1];
/// Coordinates of a [`Place`].
const NUM_PLACE: usize = 3;

/// Where a station has the target: across the line, along the range, and (on an edge) along that. Parts of the way from
/// the least to the greatest.
pub(super) type Place = [f64; NUM_PLACE];

/// In the middle of everything.
pub(super) const MIDDLE: Place = [0.5; NUM_PLACE];

/// What is between two limits.
pub(super) fn part_of([least, most]: [f64; 2], part: f64) -> f64 {
    least + part * (most - least)
}

/// A place for a station.
#[derive(Clone, Copy, Debug)]
pub(super) struct Candidate {
    pub orientation: Orientation,
    /// Which of the kinds of station.
    pub kind: usize,
    pub place: Place,
}

/// What a station is aimed at.
#[derive(Clone, Copy, Debug)]
pub(super) struct Aim {
    pub point_in_sensor: Vec3,
    pub point_in_base: Vec3,
    /// The edge that the point is on.
    pub edge: Option<Edge>,
}

/// What stations are planned at, with `N` unknowns.
pub(super) trait Subject<const N: usize> {
    /// How many kinds of station there are to choose from; at least one.
    fn num_kinds(&self) -> usize;

    /// The orientations that a kind may take.
    fn orientations(&self, kind: usize) -> &Orientations;

    /// The places that the grid tries.
    fn places(&self) -> &[Place];

    /// Whether there are orientations at which the target may be out of view.
    fn may_be_lost(&self) -> bool;

    /// What a station sees.
    fn aim(&self, candidate: &Candidate) -> Aim;

    /// What a station says about the unknowns; `None` if it is not sure to see anything.
    fn brings(&self, candidate: &Candidate, base_from_sensor: &UnitQuaternion<f64>) -> Option<SMatrix<f64, N, N>>;
}

/// The orientation of a station that is measured or planned already.
#[derive(Clone, Copy, Debug)]
pub(super) struct Taken {
    pub base_from_sensor: UnitQuaternion<f64>,
    /// On another edge the same orientation is no twin; none: it is one of all.
    pub edge: Option<Edge>,
}

/// The state of a plan.
#[derive(Clone, Debug)]
pub(super) struct Search<S, const N: usize> {
    mount: Mount,
    flange_from_sensor: Rigid,
    subject: S,
    known: Information<N>,
    taken: Vec<Taken>,
}

impl<S: Subject<N>, const N: usize> Search<S, N> {
    pub fn new(mount: Mount, flange_from_sensor: Rigid, subject: S, known: Information<N>, taken: Vec<Taken>) -> Self {
        Self { mount, flange_from_sensor, subject, known, taken }
    }

    /// Plans the station that helps most; `None` if there is none. `point_std` says what σ to state for what is known then.
    pub fn next(&mut self, point_std: impl Fn(&Information<N>) -> Option<f64>) -> Option<PlannedStation> {
        // What is sure to be seen may be so near to the reference that it falls between the points of the whole grid.
        let parts = if self.subject.may_be_lost() { &PARTS[..] } else { &PARTS[..1] };
        let best = APART.iter().find_map(|apart| {
            let start = parts.iter().find_map(|part| self.best_of_grid(*part, *apart))?;
            Some(self.refined(start, *apart))
        })?;
        self.take(&best, point_std)
    }

    /// Plans a station of the first kind at the reference orientation.
    pub fn reference(&mut self, point_std: impl Fn(&Information<N>) -> Option<f64>) -> Option<PlannedStation> {
        self.take(&Candidate { orientation: Orientation::default(), kind: 0, place: MIDDLE }, point_std)
    }

    fn best_of_grid(&self, part: f64, apart: f64) -> Option<(Candidate, f64)> {
        let mut best: Option<(Candidate, f64)> = None;
        for kind in 0..self.subject.num_kinds() {
            for orientation in self.subject.orientations(kind).grid(part) {
                let upright = Candidate { orientation, kind, place: MIDDLE };
                if !self.is_apart(&upright, apart) {
                    continue;
                }
                for place in self.subject.places() {
                    let candidate = Candidate { place: *place, ..upright };
                    let Some(variance) = self.variance_with(&candidate) else { continue };
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
        let orientations = self.subject.orientations(start.kind);
        let [tilt, azimuth, spin] = orientations.grid_steps();
        let mut part = FIRST_REFINEMENT;
        for _ in 0..NUM_REFINEMENTS {
            for direction in [1.0, -1.0].map(|sign| sign * part) {
                for coordinate in 0..3 + NUM_PLACE {
                    let mut trial = best;
                    match coordinate {
                        0 => trial.orientation.tilt += direction * tilt,
                        1 => trial.orientation.azimuth += direction * azimuth,
                        2 => trial.orientation.spin += direction * spin,
                        _ => trial.place[coordinate - 3] += direction,
                    }
                    trial.orientation = orientations.within_limits(trial.orientation);
                    trial.place = trial.place.map(|along| along.clamp(0.0, 1.0));
                    if !self.is_apart(&trial, apart) {
                        continue;
                    }
                    let Some(variance) = self.variance_with(&trial) else { continue };
                    if variance < least {
                        (best, least) = (trial, variance);
                    }
                }
            }
            part *= 0.5;
        }
        best
    }

    fn take(
        &mut self,
        candidate: &Candidate,
        point_std: impl Fn(&Information<N>) -> Option<f64>,
    ) -> Option<PlannedStation> {
        let base_from_sensor = self.base_from_sensor(candidate);
        self.known = self.known.with(&self.subject.brings(candidate, &base_from_sensor)?);
        let Aim { point_in_sensor, point_in_base, edge } = self.subject.aim(candidate);
        self.taken.push(Taken { base_from_sensor, edge });
        let origin = point_in_base - base_from_sensor * point_in_sensor;
        let base_from_flange = Rigid::from_parts(origin.into(), base_from_sensor) * self.flange_from_sensor.inverse();
        Some(PlannedStation {
            base_from_flange: Transform::from_rigid(match self.mount {
                Mount::OnFlange => base_from_flange,
                Mount::Fixed => base_from_flange.inverse(),
            }),
            edge,
            tilt_deg: candidate.orientation.tilt.to_degrees(),
            azimuth_deg: candidate.orientation.azimuth_deg(),
            spin_deg: candidate.orientation.spin.to_degrees(),
            workspace_point_std_mm: point_std(&self.known),
        })
    }

    fn variance_with(&self, candidate: &Candidate) -> Option<f64> {
        let brings = self.subject.brings(candidate, &self.base_from_sensor(candidate))?;
        Some(self.known.variance_with(&brings))
    }

    fn base_from_sensor(&self, candidate: &Candidate) -> UnitQuaternion<f64> {
        self.subject.orientations(candidate.kind).base_from_sensor(candidate.orientation)
    }

    fn is_apart(&self, candidate: &Candidate, apart: f64) -> bool {
        let base_from_sensor = self.base_from_sensor(candidate);
        let edge = self.subject.aim(candidate).edge;
        let mut alike = self.taken.iter().filter(|taken| taken.edge.is_none() || taken.edge == edge);
        alike.all(|taken| taken.base_from_sensor.angle_to(&base_from_sensor) >= apart)
    }
}
