//! The convention doctor: solves with the poses read in every way that people get wrong, and ranks the ways by residual.
//!
//! The measured sections need no orientation of the robot, so they are the same for all readings; what is left of each
//! reading is a small problem of one point a station.
//!
//! # Limits
//! A rotation has two triples of numbers. Where only a quaternion is known and neither order keeps its middle angle within a
//! quarter turn, the triples are chosen station by station with the solution; that may fail, and then nothing is said.
//! Turning all poses round always leaves the ball nearly still in the sensor, so the second best reading is never worse
//! than the ball's spread there.

mod candidates;
mod reading;
mod sections;
mod trial;

pub use reading::{AngleReading, AngleUnit, Inversion, LengthUnit, PoseReading, QuaternionOrder, RotationReading};

use crate::calibrate::ball::MIN_STATIONS;
use crate::calibrate::{BallProblem, Mount};
use crate::geometry::{AngleOrder, Rigid};
use crate::session::Session;
use crate::watch::{Cancelled, Watch};

use self::candidates::candidates;
use self::reading::{apart, numbers};
use self::sections::Section;
use self::trial::{Fit, Trials};
use super::Case;
use super::finding::{Evidence, Fault, Finding, Plot, Severity};
use super::remedy::Remedy;

/// Residuals below this are those of a good cell, whatever the ball, mm; below that part of the radius, those of a big one.
const GOOD_MM: f64 = 0.1;
const GOOD_PART_OF_RADIUS: f64 = 0.01;
/// Another reading must fit this many times better at least.
const MIN_RATIO: f64 = 4.0;
/// The chance that one of the wrong readings fits as well as the best one by accident is to be below this.
const MAX_CHANCE: f64 = 1e-3;
/// So many of the ways, the best at first look, get a second one.
const NUM_LOOKED_AT: usize = 80;
/// So many of them are fitted then.
const NUM_FITTED: usize = 12;
/// So many of these are examined with all care, if their residual is within this ratio of the best one.
const NUM_EXAMINED: usize = 4;
const EXAMINED_RATIO: f64 = 4.0;
/// Ways in the plot.
const NUM_PLOTTED: usize = 8;
/// Below this (mm) residuals are rounding.
const ROUNDING_MM: f64 = 1e-3;

/// How well the data fit with the poses read in one way.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadingFit {
    /// The way.
    pub reading: PoseReading,
    /// Other ways, as simple, that give the same poses or, for the best one, fit as well within the noise.
    pub ties: Vec<PoseReading>,
    /// RMS residual, mm: of one section a station, without the station that fits worst where there are enough; infinite
    /// where the poses, read in this way, leave the calibration open.
    pub rms_mm: f64,
    /// Whether it is the session as it is.
    pub is_as_given: bool,
}

/// The finding, if another way fits far better, and the ranking, if the poses as given do not fit.
///
/// # Errors
/// [`Cancelled`] if `watch` says so.
pub fn examine(case: Case<'_>, watch: &mut dyn Watch) -> Result<(Option<Finding>, Vec<ReadingFit>), Cancelled> {
    let doctor = Doctor::new(case.session, case.problem);
    let good_mm = GOOD_MM.max(GOOD_PART_OF_RADIUS * case.problem.radius_mm);
    if doctor.trials.sections.len() < MIN_STATIONS || doctor.rms_as_given() < good_mm {
        return Ok((None, Vec::new()));
    }
    let ranking = doctor.rank(watch)?;
    let finding = doctor.finding(&ranking);
    Ok((finding, ranking))
}

/// All ways to read the poses, the best one first.
///
/// # Errors
/// [`Cancelled`] if `watch` says so.
pub fn rank(session: &Session, problem: &BallProblem, watch: &mut dyn Watch) -> Result<Vec<ReadingFit>, Cancelled> {
    Doctor::new(session, problem).rank(watch)
}

/// The ways with at most one change from what is given, for data that are none of a ball: told by the first captures of some
/// stations.
pub(super) fn of_one_change(session: &Session, station_idxs: &[usize]) -> Vec<PoseReading> {
    let sections: Vec<Section> = station_idxs.iter().map(|station_idx| Section::of_pose(*station_idx)).collect();
    let mut readings = candidates(session, &sections);
    readings.retain(|reading| reading.num_changes() <= 1);
    readings
}

struct Doctor<'a> {
    session: &'a Session,
    trials: Trials,
}

/// A reading, the poses that it gives and its fit.
struct Tried {
    fit: ReadingFit,
    poses: Vec<Rigid>,
}

impl<'a> Doctor<'a> {
    fn new(session: &'a Session, problem: &BallProblem) -> Self {
        Self { session, trials: Trials::new(sections::sections(session, problem)) }
    }

    fn rms_as_given(&self) -> f64 {
        let poses = self.poses(&PoseReading::default());
        self.trials.fit_carefully(&poses, None).map_or(f64::INFINITY, |fit| fit.rms_mm)
    }

    fn rank(&self, watch: &mut dyn Watch) -> Result<Vec<ReadingFit>, Cancelled> {
        if self.trials.sections.len() < MIN_STATIONS {
            return Ok(Vec::new());
        }
        let candidates = candidates(self.session, &self.trials.sections);
        let total = candidates.len() + 2;
        let mut tried: Vec<Tried> = Vec::with_capacity(candidates.len());
        for (done, reading) in candidates.into_iter().enumerate() {
            watch.report(done, total)?;
            let is_as_given = reading.is_as_given();
            let poses = self.poses(&reading);
            if let Some(twin) = tried.iter_mut().find(|other| are_same(&other.poses, &poses)) {
                twin.fit.ties.push(reading);
                continue;
            }
            let (reading, rms_mm) = self.by_best_triples(reading);
            if rms_mm.is_some() || is_as_given {
                let rms_mm = rms_mm.unwrap_or(f64::INFINITY);
                tried.push(Tried { fit: ReadingFit { reading, ties: Vec::new(), rms_mm, is_as_given }, poses });
            }
        }
        let mut ranking: Vec<ReadingFit> = tried.into_iter().map(|tried| tried.fit).collect();
        let by_residual = |a: &ReadingFit, b: &ReadingFit| a.rms_mm.total_cmp(&b.rms_mm);
        ranking.sort_by(by_residual);
        let trials = &self.trials;
        self.look_into(&mut ranking, NUM_LOOKED_AT, |poses, others| trials.second_look(poses, others));
        ranking.sort_by(by_residual);
        watch.report(total - 2, total)?;
        self.look_into(&mut ranking, NUM_FITTED, |poses, others| trials.fit(poses, others));
        ranking.sort_by(by_residual);
        watch.report(total - 1, total)?;
        let limit_mm = EXAMINED_RATIO * ranking.first().map_or(0.0, |fit| fit.rms_mm);
        let num_examined = ranking.partition_point(|fit| fit.rms_mm <= limit_mm);
        let examined = &mut ranking[..num_examined];
        self.look_into(examined, NUM_EXAMINED, |poses, others| trials.fit_carefully(poses, others));
        ranking.sort_by(by_residual);
        self.join_ties_of_the_best(&mut ranking);
        for ReadingFit { reading, ties, .. } in &mut ranking {
            ties.retain(|tie| tie.num_changes() <= reading.num_changes());
        }
        Ok(ranking)
    }

    /// Fits the first ones anew, and those that differ in nothing but the order of a quaternion, a unit or the way round,
    /// as these are the most likely ones; each from the triples that are known so far.
    fn look_into(
        &self,
        ranking: &mut [ReadingFit],
        num_first: usize,
        fit: impl Fn(&[Rigid], Option<&[Rigid]>) -> Option<Fit>,
    ) {
        for (idx, found) in ranking.iter_mut().enumerate() {
            let keeps_angles = !matches!(found.reading.rotation, RotationReading::Angles(_));
            if idx >= num_first && !(keeps_angles && found.reading.num_changes() <= 1) {
                continue;
            }
            let RotationReading::Angles(angles) = &found.reading.rotation else {
                if let Some(fit) = fit(&self.poses(&found.reading), None) {
                    found.rms_mm = fit.rms_mm;
                }
                continue;
            };
            let is_second = |section: &Section| angles.second_at_station_idxs.contains(&section.station_idx);
            let seconds: Vec<bool> = self.trials.sections.iter().map(is_second).collect();
            let others = self.with_other_triples(&found.reading, angles, &seconds);
            if let Some(fit) = fit(&self.poses(&found.reading), others.as_deref()) {
                let flipped = seconds.iter().zip(&fit.takes_second).map(|(second, flips)| second ^ flips);
                let seconds: Vec<bool> = flipped.collect();
                found.reading = self.with_seconds(&found.reading, angles, &seconds);
                found.rms_mm = fit.rms_mm;
            }
        }
    }

    /// A reading from the triples with the least residual at first look, where these are not known.
    fn by_best_triples(&self, reading: PoseReading) -> (PoseReading, Option<f64>) {
        let residual = |reading: &PoseReading| self.trials.first_look(&self.poses(reading));
        let RotationReading::Angles(angles) = &reading.rotation else {
            let found = residual(&reading);
            return (reading, found);
        };
        // A controller's middle angle stays within a quarter turn, and so does that of the numbers found again.
        let is_cardan = |order: AngleOrder| order != AngleOrder::RotationVector && !order.is_proper_euler();
        let starts = self.starting_triples(angles, is_cardan(angles.from) && is_cardan(angles.to));
        let tried = starts.into_iter().map(|seconds| {
            let start = self.with_seconds(&reading, angles, &seconds);
            let found = residual(&start);
            (start, found)
        });
        let or_infinite = |found: Option<f64>| found.unwrap_or(f64::INFINITY);
        let best = tried.min_by(|a, b| or_infinite(a.1).total_cmp(&or_infinite(b.1)));
        best.unwrap_or((reading, None))
    }

    /// The poses by the other triple of each station; `None` where all numbers are as written.
    fn with_other_triples(&self, reading: &PoseReading, angles: &AngleReading, seconds: &[bool]) -> Option<Vec<Rigid>> {
        let flipped: Vec<bool> = seconds.iter().map(|second| !second).collect();
        let others = self.poses(&self.with_seconds(reading, angles, &flipped));
        (!are_same(&others, &self.poses(&self.with_seconds(reading, angles, seconds)))).then_some(others)
    }

    fn with_seconds(&self, reading: &PoseReading, angles: &AngleReading, seconds: &[bool]) -> PoseReading {
        let at = self.trials.sections.iter().zip(seconds).filter(|(_, second)| **second);
        let second_at_station_idxs = at.map(|(section, _)| section.station_idx).collect();
        PoseReading {
            rotation: RotationReading::Angles(AngleReading { second_at_station_idxs, ..angles.clone() }),
            ..reading.clone()
        }
    }

    /// From which triples to start, where they are not known: the usual ones, and those nearest to the first station's two,
    /// as the numbers of one session are near each other more often than not.
    fn starting_triples(&self, angles: &AngleReading, only_usual: bool) -> Vec<Vec<bool>> {
        let sections = &self.trials.sections;
        let mut starts = vec![vec![false; sections.len()]];
        if only_usual {
            return starts;
        }
        let triple = |idx: usize, second| {
            let section = &sections[idx];
            numbers(&self.session.stations[section.station_idx], section.capture_idx, angles.from, second)
        };
        for reference in [false, true].map(|second| triple(0, second)) {
            let from = |idx, second| apart(angles.from, reference, triple(idx, second));
            let nearest = (0..sections.len()).map(|idx| from(idx, true) < from(idx, false)).collect();
            if !starts.contains(&nearest) {
                starts.push(nearest);
            }
        }
        starts
    }

    /// The poses of the sections' captures as the methods take them.
    fn poses(&self, reading: &PoseReading) -> Vec<Rigid> {
        let pose = |section: &Section| {
            let station = &self.session.stations[section.station_idx];
            let base_from_flange = reading.pose(station, section.station_idx, section.capture_idx);
            match self.session.mount {
                Mount::OnFlange => base_from_flange,
                Mount::Fixed => base_from_flange.inverse(),
            }
        };
        self.trials.sections.iter().map(pose).collect()
    }

    /// Readings that fit as well as the best one within the noise are no finding against each other; among them the session
    /// as given stands for all, or else the simplest.
    fn join_ties_of_the_best(&self, ranking: &mut Vec<ReadingFit>) {
        let Some(least_mm) = ranking.first().map(|fit| fit.rms_mm) else { return };
        // Three standard deviations of the ratio of two mean squares.
        let scatter = 3.0 * (4.0 / self.trials.degrees_of_freedom().max(1.0)).sqrt();
        let limit_mm = (least_mm * (1.0 + scatter).sqrt()).max(ROUNDING_MM);
        let num_tied = ranking.partition_point(|fit| fit.rms_mm <= limit_mm).max(1);
        let mut tied: Vec<ReadingFit> = ranking.drain(..num_tied).collect();
        tied.sort_by_key(|fit| fit.reading.num_changes());
        let mut tied = tied.into_iter();
        let Some(mut best) = tied.next() else { return };
        for other in tied {
            best.ties.push(other.reading);
            best.ties.extend(other.ties);
        }
        ranking.insert(0, best);
    }

    fn finding(&self, ranking: &[ReadingFit]) -> Option<Finding> {
        let best = ranking.first().filter(|best| !best.is_as_given)?;
        let as_given = ranking.iter().find(|fit| fit.is_as_given)?;
        let ratio = as_given.rms_mm / best.rms_mm.max(ROUNDING_MM);
        #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^52 readings")]
        let num_readings = ranking.len() as f64;
        let freedom = self.trials.degrees_of_freedom();
        // A residual that is r times smaller by accident has a chance of about r to the power of minus the freedom.
        let needed = (num_readings / MAX_CHANCE).powf(1.0 / freedom);
        let is_clear = freedom > 0.0 && ratio > needed.max(MIN_RATIO) && best.rms_mm < self.least_explained_mm();
        is_clear.then(|| {
            let mut plotted: Vec<ReadingFit> = ranking.iter().take(NUM_PLOTTED).cloned().collect();
            if !plotted.iter().any(|fit| fit.is_as_given) {
                plotted.push(as_given.clone());
            }
            Finding {
                fault: Fault::PosesMisread { reading: best.reading.clone() },
                severity: Severity::Wrong,
                explains: ratio,
                evidence: Evidence {
                    residual_mm: Some([as_given.rms_mm, best.rms_mm]),
                    plot: Some(Plot::Readings(plotted)),
                },
                remedy: Some(Remedy::ReadPosesAs(best.reading.clone())),
            }
        })
    }

    /// Poses that shrink to a point make the ball stand still in the sensor; a reading must say far more than that.
    fn least_explained_mm(&self) -> f64 {
        self.trials.spread_mm() / MIN_RATIO
    }
}

fn are_same(first: &[Rigid], second: &[Rigid]) -> bool {
    /// Rounding of a few products.
    const ANGLE_RAD: f64 = 1e-9;
    const DISTANCE_MM: f64 = 1e-6;
    first.iter().zip(second).all(|(a, b)| {
        (a.translation.vector - b.translation.vector).norm() < DISTANCE_MM
            && a.rotation.coords.dot(&b.rotation.coords).abs() > 1.0 - 1e-12
            && a.rotation.angle_to(&b.rotation) < ANGLE_RAD
    })
}
