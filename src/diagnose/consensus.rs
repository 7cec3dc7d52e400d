//! The largest set of stations that agree, found without trusting any solution: each station is reduced to the ball's
//! centre on its own, many small sets of stations are solved, and the best of them grows for as long as the next station
//! fits.

use nalgebra::{SMatrix, UnitQuaternion};

use crate::calibrate::observation::{CentreObservation, NUM_UNKNOWNS, State};
use crate::calibrate::rotation_start::{PoseGeometry, octahedral_rotations};
use crate::calibrate::solver::{Hessian, covariance_for_unit_noise, minimise};
use crate::calibrate::{BallProblem, Method, Mount, Station, solve};
use crate::geometry::so3::hat;
use crate::geometry::stats::{SplitMix, median};
use crate::geometry::{Mat3, Rigid, Vec3};

use super::station_reading::{MIN_STEPS, StationReading, poses_of, single_capture_station, travel_direction};

/// Stations that have to agree: four determine the unknowns and the sides, and a fifth that fits is no accident. Besides,
/// the agreeing ones have to be more than half: of two halves that contradict each other either may be the wrong one.
pub const MIN_CLEAN_STATIONS: usize = 5;
/// Small sets drawn. With eight of twenty wrong one in twenty is clean, so that 120 miss it once in 400 times; with fewer
/// wrong never.
const DRAWS: usize = 120;
/// Stations of a small set whose sides are open: more, as x and z alone have to tell the sides.
const OPEN_SET: usize = 8;
/// Weight of y = 0 ± R/2 beside x and z, which are a hundred times better known.
const WEIGHT_OF_Y: f64 = 1e-4;
/// Rotations nearer than this are the same minimum.
const SAME_MINIMUM_RAD: f64 = 1e-3;
/// While sets are compared, differences below this do not matter, mm: the noise of a poor arm.
const SEARCH_STD_MM: f64 = 0.05;
/// Stations that scatter by more than this do not agree, mm: no arm in working order is that bad.
const CREDIBLE_STD_MM: f64 = 1.0;
/// Improvements of a drawn set before it is compared, and of the best ones after that.
const FIRST_STEPS: usize = 2;
const LAST_STEPS: usize = 10;
/// Sets that are improved to the end.
const FINALISTS: usize = 4;
/// A misfit that would be this many standard deviations of a normal value is no noise: once in 300 000 stations.
const MISFIT_AT_STDS: f64 = 4.5;
type Jacobian = SMatrix<f64, 3, NUM_UNKNOWNS>;

/// The stations of a problem, each by itself.
#[derive(Clone, Debug)]
pub(super) struct Stations<'a> {
    problem: &'a BallProblem,
    /// The direction in the flange in which a positive step travels.
    direction: Vec3,
    /// Those that say anything.
    pub readings: Vec<StationReading<'a>>,
}

/// A state with what its stations say about it.
#[derive(Clone, Debug)]
struct Fit {
    state: State,
    covariance: Hessian,
    /// What the stations scatter beyond their own noise, mm².
    extra_variance: f64,
    freedom: f64,
}

/// Stations that agree.
#[derive(Clone, Debug)]
pub(super) struct Consensus {
    /// The unknowns by their word.
    pub state: State,
    /// How much they scatter beyond their own and the stated noise, mm.
    scatter_mm: f64,
    /// By reading: whether it is one of them.
    pub agrees: Vec<bool>,
    /// By reading: how far its ball is from where the (other) agreeing ones have it, mm.
    pub misfit_mm: Vec<f64>,
    /// A misfit below this is noise, mm: by the worst of those that agree.
    pub tolerance_mm: f64,
    /// Scatter of those that agree over what their own and the stated noise let one expect; how improbable that is, as a
    /// standard normal value.
    pub noise_ratio_and_score: [f64; 2],
}

impl Consensus {
    /// Whether they scatter by no more than an arm in working order.
    pub fn is_credible(&self) -> bool {
        self.scatter_mm < CREDIBLE_STD_MM
    }

    /// How many agree.
    pub fn num_agreeing(&self) -> usize {
        self.agrees.iter().filter(|agrees| **agrees).count()
    }

    /// Median misfit of those that agree, mm.
    pub fn typical_mm(&self) -> f64 {
        let mut misfits: Vec<f64> =
            self.misfit_mm.iter().zip(&self.agrees).filter(|(_, agrees)| **agrees).map(|(misfit, _)| *misfit).collect();
        median(&mut misfits)
    }
}

/// How many of so many stations have to agree.
#[must_use]
pub const fn needed_stations(num_stations: usize) -> usize {
    let majority = num_stations / 2 + 1;
    if majority > MIN_CLEAN_STATIONS { majority } else { MIN_CLEAN_STATIONS }
}

impl<'a> Stations<'a> {
    /// Reduces every station.
    pub fn new(problem: &'a BallProblem) -> Self {
        let direction = travel_direction(problem);
        let mut stations = Self { problem, direction, readings: Vec::new() };
        stations.readings =
            problem.stations.iter().filter_map(|station| stations.reading(station, &poses_of(station))).collect();
        stations
    }

    /// What a station says with these poses in place of its own.
    pub fn reading(&self, station: &'a Station, poses: &[Rigid]) -> Option<StationReading<'a>> {
        StationReading::of(self.problem, self.direction, station, poses)
    }

    /// The same with every sweep read the other way along: where steps are counted against the laser's normal.
    fn turned(&self) -> Self {
        let mut turned = Self { direction: -self.direction, ..self.clone() };
        turned.readings =
            self.readings.iter().filter_map(|known| turned.reading(known.station, &poses_of(known.station))).collect();
        turned
    }

    /// The largest set that agrees, if it is more than half of the stations; with `self` as it has to be read for that.
    pub fn consensus(self) -> Option<(Self, Consensus)> {
        let at_least = needed_stations(self.readings.len());
        if self.readings.len() < at_least {
            return None;
        }
        // Reduced points and single sections are the same either way.
        let is_swept = self.problem.stations.iter().any(|station| station.captures.len() >= MIN_STEPS);
        let found = self.agreement(at_least);
        if !is_swept || found.as_ref().is_some_and(|found| found.scatter_mm < SEARCH_STD_MM) {
            return found.map(|found| (self, found));
        }
        let turned = self.turned();
        match (found, turned.agreement(at_least)) {
            (Some(found), Some(other)) if other.scatter_mm < 0.5 * found.scatter_mm => Some((turned, other)),
            (None, Some(other)) => Some((turned, other)),
            (found, _) => found.map(|found| (self, found)),
        }
    }

    /// The set that agrees best when at least so many have to, grown for as long as the next one fits.
    pub fn agreement(&self, at_least: usize) -> Option<Consensus> {
        let all: Vec<usize> = (0..self.readings.len()).collect();
        if let Some(fit) = self.start_of_all().and_then(|state| self.fit(&all, state)) {
            let consensus = self.judged(&all, &fit);
            if fit.extra_variance.sqrt() < SEARCH_STD_MM && consensus.agrees.iter().all(|agrees| *agrees) {
                return Some(consensus);
            }
        }
        let (mut members, state) = self.best_set(at_least)?;
        let mut fit = self.fit(&members, state)?;
        loop {
            let outside = all.iter().filter(|idx| !members.contains(idx));
            let next = outside.map(|idx| (*idx, self.score(*idx, &fit))).min_by(|a, b| a.1.total_cmp(&b.1));
            let Some((next, _)) = next.filter(|(_, score)| *score < MISFIT_AT_STDS) else { break };
            members.push(next);
            fit = self.fit(&members, fit.state)?;
        }
        let mut consensus = self.judged(&members, &fit);
        // One that was drawn in early may turn out not to belong.
        let settled: Vec<usize> = all.iter().copied().filter(|idx| consensus.agrees[*idx]).collect();
        if settled.len() < members.len() && settled.len() >= at_least {
            consensus = self.judged(&settled, &self.fit(&settled, fit.state)?);
        }
        Some(consensus)
    }

    /// Every station against the members, these without itself.
    fn judged(&self, members: &[usize], fit: &Fit) -> Consensus {
        let (mut agrees, mut misfit_mm) = (Vec::new(), Vec::new());
        let mut tolerance_mm = 0.0_f64;
        for (idx, reading) in self.readings.iter().enumerate() {
            let is_member = members.contains(&idx);
            let without = is_member
                .then(|| {
                    let others: Vec<usize> = members.iter().copied().filter(|other| *other != idx).collect();
                    self.fit(&others, fit.state)
                })
                .flatten();
            let judge = without.as_ref().unwrap_or(fit);
            let misfit = reading.misfit(&judge.state).norm();
            let fits = is_member && self.score(idx, judge) < MISFIT_AT_STDS;
            if fits {
                tolerance_mm = tolerance_mm.max(misfit);
            }
            agrees.push(fits);
            misfit_mm.push(misfit);
        }
        let scatter_mm = fit.extra_variance.sqrt();
        let noise_ratio_and_score = self.noise_ratio_and_score(members, fit);
        Consensus { state: fit.state, scatter_mm, agrees, misfit_mm, tolerance_mm, noise_ratio_and_score }
    }

    /// Of so many stations those that agree best, by many small sets that are improved in turn.
    fn best_set(&self, num: usize) -> Option<(Vec<usize>, State)> {
        let all: Vec<usize> = (0..self.readings.len()).collect();
        let mut random = SplitMix::new(0x0005_7a71_0215);
        let has_open = self.readings.iter().any(|reading| reading.side_is_open);
        let set_size = if has_open { OPEN_SET } else { MIN_CLEAN_STATIONS }.min(all.len());
        let without_one = all.iter().map(|left| all.iter().copied().filter(|idx| idx != left).collect::<Vec<_>>());
        let drawn = (0..DRAWS).map(|_| {
            let mut set = all.clone();
            for place in 0..set_size {
                let other = place + random.below(set.len() - place);
                set.swap(place, other);
            }
            set.truncate(set_size);
            set
        });
        let mut improved: Vec<(f64, Vec<usize>, State)> = std::iter::once(all.clone())
            .chain(without_one)
            .chain(drawn)
            .flat_map(|set| self.starts(&set))
            .filter_map(|start| self.improved(start, num, FIRST_STEPS))
            .collect();
        improved.sort_by(|a, b| a.0.total_cmp(&b.0));
        improved.dedup_by(|a, b| a.1 == b.1);
        improved
            .into_iter()
            .take(FINALISTS)
            .filter_map(|(_, _, state)| self.improved(state, num, LAST_STEPS))
            .min_by(|a, b| a.0.total_cmp(&b.0))
            .map(|(_, set, state)| (set, state))
    }

    /// The stations that fit a state best, the state that fits these best, and so on.
    fn improved(&self, start: State, num: usize, num_steps: usize) -> Option<(f64, Vec<usize>, State)> {
        let mut state = start;
        let mut latest: Option<(f64, Vec<usize>)> = None;
        for _ in 0..num_steps {
            let mut sizes: Vec<(f64, usize)> =
                (0..self.readings.len()).map(|idx| (self.search_cost(idx, &state), idx)).collect();
            sizes.sort_by(|a, b| a.0.total_cmp(&b.0));
            let cost = sizes.iter().take(num).map(|(cost, _)| cost).sum();
            let mut set: Vec<usize> = sizes.into_iter().take(num).map(|(_, idx)| idx).collect();
            set.sort_unstable();
            let settled = latest.as_ref().is_some_and(|(_, known)| *known == set);
            state = self.settled(&set, state, SEARCH_STD_MM * SEARCH_STD_MM)?;
            latest = Some((cost, set));
            if settled {
                break;
            }
        }
        latest.map(|(cost, set)| (cost, set, state))
    }

    fn search_cost(&self, idx: usize, state: &State) -> f64 {
        let reading = &self.readings[idx];
        let misfit = reading.misfit(state);
        let covariance = self.covariance(reading, state) + Mat3::identity() * (SEARCH_STD_MM * SEARCH_STD_MM);
        covariance.cholesky().map_or(f64::INFINITY, |factor| misfit.dot(&factor.solve(&misfit)))
    }

    /// A state for all stations from nothing; where sides are open, from the method that knows best how to find them.
    fn start_of_all(&self) -> Option<State> {
        if self.readings.iter().any(|reading| reading.side_is_open) {
            let stations = self.readings.iter().map(single_capture_station).collect();
            let problem = BallProblem { stations, ..self.problem.clone() };
            return solve(&problem, Method::BallFixedPoint).ok().and_then(|solution| Some(solution.reduced?.state));
        }
        let all: Vec<usize> = (0..self.readings.len()).collect();
        self.starts(&all).pop()
    }

    /// States for these stations from nothing; several where sides are open, as x and z alone then have to tell them.
    fn starts(&self, set: &[usize]) -> Vec<State> {
        let readings = || set.iter().map(|idx| &self.readings[*idx]);
        let poses: Vec<Rigid> = readings().map(|reading| reading.base_from_flange).collect();
        let Ok(geometry) = PoseGeometry::new(&poses) else { return Vec::new() };
        if !readings().any(|reading| reading.side_is_open) {
            let centres: Vec<Vec3> = readings().map(|reading| reading.centre).collect();
            let reduced = geometry.reduced(&centres);
            return vec![reduced.state(reduced.best_minimum().flange_from_sensor)];
        }
        let flat: Vec<Vec3> = readings()
            .map(|reading| {
                if reading.side_is_open {
                    reading.centre.component_mul(&Vec3::new(1.0, 0.0, 1.0))
                } else {
                    reading.centre
                }
            })
            .collect();
        let reduced = geometry.reduced(&flat);
        let observations: Vec<CentreObservation> = readings()
            .zip(&flat)
            .enumerate()
            .map(|(place, (reading, centre))| {
                let y_weight = if reading.side_is_open { WEIGHT_OF_Y } else { 1.0 };
                CentreObservation {
                    information: Mat3::from_diagonal(&Vec3::new(1.0, y_weight, 1.0)),
                    ..CentreObservation::point(place, reading.base_from_flange, *centre)
                }
            })
            .collect();
        let mut minima: Vec<UnitQuaternion<f64>> = Vec::new();
        for rotation in octahedral_rotations() {
            let found = reduced.descend(rotation).flange_from_sensor;
            if !minima.iter().any(|known| known.angle_to(&found) < SAME_MINIMUM_RAD) {
                minima.push(found);
            }
        }
        minima
            .into_iter()
            .filter_map(|rotation| minimise(&observations.iter(), reduced.state(rotation)).ok())
            .map(|minimum| minimum.state)
            .collect()
    }

    /// Minimises over these stations, with their noise and a variance on top of it; open sides go where the ball is.
    fn settled(&self, set: &[usize], start: State, extra_variance: f64) -> Option<State> {
        Some(self.minimised(set, start, extra_variance)?.0)
    }

    fn minimised(&self, set: &[usize], start: State, extra_variance: f64) -> Option<(State, Hessian)> {
        let observations: Vec<CentreObservation> = set
            .iter()
            .enumerate()
            .map(|(place, idx)| {
                let reading = &self.readings[*idx];
                let predicted = start.ball_in_sensor(&reading.base_from_flange);
                let covariance = self.covariance(reading, &start) + Mat3::identity() * extra_variance;
                Some(CentreObservation {
                    information: covariance.try_inverse()?,
                    ..CentreObservation::point(place, reading.base_from_flange, reading.centre_near(predicted))
                })
            })
            .collect::<Option<_>>()?;
        let minimum = minimise(&observations.iter(), start).ok()?;
        Some((minimum.state, minimum.hessian))
    }

    /// Minimises over these stations and finds how much they scatter beyond their own noise.
    fn fit(&self, set: &[usize], start: State) -> Option<Fit> {
        /// The weights hardly matter to the scatter, so this settles at once.
        const ROUNDS: usize = 3;
        #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^52 stations")]
        let freedom = (3 * set.len()) as f64 - NUM_UNKNOWNS as f64;
        if freedom < 1.0 {
            return None;
        }
        let mut state = start;
        let mut extra_variance = SEARCH_STD_MM * SEARCH_STD_MM;
        let mut hessian = Hessian::zeros();
        for _ in 0..ROUNDS {
            (state, hessian) = self.minimised(set, state, extra_variance)?;
            extra_variance = self.extra_variance(set, &state, freedom).max(LEAST_VARIANCE);
        }
        Some(Fit { state, covariance: covariance_for_unit_noise(&hessian).ok()?, extra_variance, freedom })
    }

    fn noise_ratio_and_score(&self, members: &[usize], fit: &Fit) -> [f64; 2] {
        let chi_square: f64 = members
            .iter()
            .map(|idx| {
                let reading = &self.readings[*idx];
                let misfit = reading.misfit(&fit.state);
                let covariance = self.covariance(reading, &fit.state) + Mat3::identity() * LEAST_VARIANCE;
                covariance.cholesky().map_or(0.0, |factor| misfit.dot(&factor.solve(&misfit)))
            })
            .sum();
        let mean = chi_square / fit.freedom;
        // The known noise is as good as one estimated from very much.
        [mean.sqrt(), normal_score(mean, fit.freedom, 1e6)]
    }

    /// The variance for which the stations scatter as they are expected to, mm².
    fn extra_variance(&self, set: &[usize], state: &State, freedom: f64) -> f64 {
        let misfits: Vec<(Mat3, Vec3)> = set
            .iter()
            .map(|idx| {
                let reading = &self.readings[*idx];
                (self.covariance(reading, state), reading.misfit(state))
            })
            .collect();
        let is_too_much = |variance: f64| {
            let chi_square: f64 = misfits
                .iter()
                .map(|(covariance, misfit)| {
                    let total = covariance + Mat3::identity() * variance;
                    total.cholesky().map_or(0.0, |factor| misfit.dot(&factor.solve(misfit)))
                })
                .sum();
            chi_square > freedom
        };
        if !is_too_much(LEAST_VARIANCE) {
            return 0.0;
        }
        let (mut low, mut high) = (LEAST_VARIANCE.ln(), (self.problem.radius_mm.powi(2) * 1e6).ln());
        while high - low > 0.01 {
            let middle = 0.5 * (low + high);
            if is_too_much(middle.exp()) {
                low = middle;
            } else {
                high = middle;
            }
        }
        high.exp()
    }

    /// How improbable the misfit of a station is that the fit does not know, as a standard normal value.
    fn score(&self, idx: usize, fit: &Fit) -> f64 {
        let reading = &self.readings[idx];
        let (centre, sensor_from_base) = fit.state.ball_in_sensor_and_rotation(&reading.base_from_flange);
        let mut jacobian = Jacobian::zeros();
        jacobian.fixed_view_mut::<3, 3>(0, 0).copy_from(&hat(centre));
        jacobian.fixed_view_mut::<3, 3>(0, 3).copy_from(&-Mat3::identity());
        jacobian.fixed_view_mut::<3, 3>(0, 6).copy_from(&sensor_from_base);
        let covariance = self.covariance(reading, &fit.state)
            + Mat3::identity() * fit.extra_variance
            + jacobian * fit.covariance * jacobian.transpose();
        let misfit = reading.misfit(&fit.state);
        covariance
            .cholesky()
            .map_or(f64::INFINITY, |factor| normal_score(misfit.dot(&factor.solve(&misfit)) / 3.0, 3.0, fit.freedom))
    }

    /// Whether a reading fits what the consensus has, whatever is said about its side.
    pub fn fits(reading: &StationReading<'_>, consensus: &Consensus) -> bool {
        /// The worst of those that agree is not the worst that there could be.
        const SLACK: f64 = 2.0;
        reading.misfit_on_either_side_mm(&consensus.state) < SLACK * consensus.tolerance_mm.max(SEARCH_STD_MM)
    }

    /// Covariance of the centre by the profile and by the stated noise of the pose, mm².
    fn covariance(&self, reading: &StationReading<'_>, state: &State) -> Mat3 {
        let noise = &self.problem.noise;
        let position_std_mm = noise.position_std_mm.unwrap_or(0.0);
        let lever_mm = match self.problem.mount {
            Mount::OnFlange => {
                reading.base_from_flange.inverse_transform_point(&state.ball_in_base.into()).coords.norm()
            }
            Mount::Fixed => state.ball_in_base.norm(),
        };
        let turned_mm = lever_mm * noise.orientation_std_rad.unwrap_or(0.0);
        reading.covariance + Mat3::identity() * (position_std_mm * position_std_mm + turned_mm * turned_mm)
    }
}

/// No arm is better than this, mm²: it keeps exact data weighable.
const LEAST_VARIANCE: f64 = 1e-12;

/// A value of the F distribution as the standard normal value that is as improbable, after Wilson and Hilferty.
fn normal_score(f: f64, above: f64, below: f64) -> f64 {
    let root = f.cbrt();
    let (part_above, part_below) = (2.0 / (9.0 * above), 2.0 / (9.0 * below));
    ((1.0 - part_below) * root - (1.0 - part_above)) / (part_below * root * root + part_above).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scores_follow_the_tables_of_f() {
        // 95 % and 99.9 % quantiles: 1.645 and 3.090 standard deviations. The approximation is good to a few per cent.
        for (f, below, expected) in
            [(3.49, 12.0, 1.645), (10.80, 12.0, 3.090), (2.76, 60.0, 1.645), (6.17, 60.0, 3.090)]
        {
            let score = normal_score(f, 3.0, below);
            assert!((score - expected).abs() < 0.08, "F {f} with {below}: {score}");
        }
    }
}
