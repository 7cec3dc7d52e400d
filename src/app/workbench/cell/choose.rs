//! The choice of the next station among those that can be gone to.

use std::sync::Arc;

use crate::calibrate::best_available;
use crate::device::{Arming, MotionRefusal, RobotReport, SearchSettings};
use crate::geometry::{Base, Flange, Transform};
use crate::plan::{
    Limits, MeasuredStation, Plan, PlanRefusal, PlannedStation, RoughCell, RoughPlate, SeenEdge, View, next_rough,
    next_rough_edge, next_stations,
};
use crate::text::cell as words;

use super::super::Results;

/// How often other poses are looked for before it is said that none can be gone to, each time within limits that are
/// narrower by this factor.
const MOST_TRIES: usize = 10;
const NARROWER: f64 = 0.8;
/// Poses that are worked out at once where there is a solution.
const NUM_AT_ONCE: usize = 4;
/// A pose is as good as an avoided one if it is turned against it by less than this, degrees: what was out of reach is so
/// a little beside it as well.
const SAME_POSE_DEG: f64 = 10.0;
/// The same of places that differ by less than this, mm.
const SAME_PLACE_MM: f64 = 1.0;

/// A station with the reason for it.
pub(super) type Chosen = (PlannedStation, String);

/// What stations are chosen by.
pub(super) enum Basis {
    /// A solution, and the plan that was made for it.
    Solved { results: Arc<Results>, planned: Plan },
    /// The mounting as it was said, and where the ball was seen.
    Rough { cell: RoughCell, stations: Vec<MeasuredStation>, view: View },
    /// The same of a plate.
    RoughPlate { cell: RoughPlate, seen: Vec<SeenEdge>, view: View },
    /// An edge was seen at one place only: places beside it, the best first.
    Beside(Vec<PlannedStation>),
}

/// Chooses a station that can be gone to.
pub(super) struct Chooser {
    pub basis: Basis,
    pub avoided: Vec<Transform<Base, Flange>>,
    pub limits: Limits,
    pub arming: Option<Arming>,
    pub report: Option<RobotReport>,
    /// What is to be done there.
    pub search: Option<SearchSettings>,
}

impl Chooser {
    /// The first pose that can be gone to; if there is none, the first of all, with what is in its way.
    pub fn choose(mut self) -> Result<Chosen, String> {
        let mut first = None;
        for _ in 0..MOST_TRIES {
            let candidates = match self.candidates() {
                Ok(candidates) => candidates,
                // Where nothing will do on the wanted edge, something may on the other.
                Err(_) if self.limits.only_edge.is_some() => {
                    self.limits.only_edge = None;
                    continue;
                }
                Err(reason) if first.is_none() => return Err(reason),
                Err(_) => break,
            };
            for chosen in candidates {
                let to = chosen.0.base_from_flange;
                if self.is_free(&to) {
                    return Ok(chosen);
                }
                self.avoided.push(to);
                first.get_or_insert(chosen);
            }
            if self.limits.only_edge.take().is_none() {
                self.narrow();
            }
        }
        first.ok_or_else(|| PlanRefusal::NothingWithinLimits.to_string())
    }

    /// Nearer to the middle of all stations the ways are shorter, and the arm is further from its limits.
    pub fn narrow(&mut self) {
        self.limits.max_tilt_deg *= NARROWER;
        self.limits.max_spin_deg *= NARROWER;
        if let Basis::Solved { planned, .. } = &mut self.basis {
            planned.stations.clear();
        }
    }

    /// The best stations that are not avoided.
    fn candidates(&mut self) -> Result<Vec<Chosen>, String> {
        match &mut self.basis {
            Basis::Solved { results, planned } => {
                let now_mm = planned.workspace_point_std_mm;
                let is_avoided = |station: &PlannedStation| {
                    let rotation = station.base_from_flange.rotation();
                    self.avoided.iter().any(|pose| pose.rotation().angle_to(&rotation).to_degrees() < SAME_POSE_DEG)
                };
                let mut stations = std::mem::take(&mut planned.stations);
                if stations.is_empty() {
                    let solution =
                        best_available(&results.methods).ok_or_else(|| PlanRefusal::Undetermined.to_string())?;
                    let plan = next_stations(solution, &self.limits, NUM_AT_ONCE);
                    stations = plan.map_err(|refusal| refusal.to_string())?.stations;
                }
                stations.retain(|station| !is_avoided(station));
                let with_reason = |station| {
                    let reason = words::reason_of_planned(&station, now_mm);
                    (station, reason)
                };
                Ok(stations.into_iter().map(with_reason).collect())
            }
            Basis::Rough { cell, stations, view } => {
                let (station, _) = next_rough(cell, stations, &self.avoided, view, &self.limits)
                    .map_err(|refusal| refusal.to_string())?;
                let reason = words::reason_of_rough(&station);
                Ok(vec![(station, reason)])
            }
            Basis::RoughPlate { cell, seen, view } => {
                let (station, _) = next_rough_edge(cell, seen, &self.avoided, view, &self.limits)
                    .map_err(|refusal| refusal.to_string())?;
                let reason = words::reason_of_rough(&station);
                Ok(vec![(station, reason)])
            }
            Basis::Beside(stations) => {
                let is_avoided = |station: &PlannedStation| {
                    let place = station.base_from_flange.translation_mm();
                    self.avoided.iter().any(|pose| (pose.translation_mm() - place).norm() < SAME_PLACE_MM)
                };
                let free = stations.drain(..).filter(|station| !is_avoided(station));
                Ok(free.map(|station| (station, words::REASON_OF_BESIDE.to_owned())).collect())
            }
        }
    }

    /// Whether nothing but the arm switch is in the way.
    fn is_free(&self, to: &Transform<Base, Flange>) -> bool {
        let (Some(arming), Some(report)) = (&self.arming, &self.report) else { return true };
        check_station(arming, report, to, self.search.as_ref()).is_ok()
    }
}

/// Whether the robot may go to a station from where it is, and make the whole travel of the search there.
pub(super) fn check_station(
    arming: &Arming,
    report: &RobotReport,
    to: &Transform<Base, Flange>,
    search: Option<&SearchSettings>,
) -> Result<(), MotionRefusal> {
    arming.check(&report.readiness, &report.base_from_flange, to, arming.limits.transit_speed_mm_s)?;
    search.map_or(Ok(()), |search| arming.check_search(&report.readiness, to, search))
}
