//! How well the measured sections fit with the poses read in one way.

use nalgebra::UnitQuaternion;

use crate::calibrate::Side;
use crate::calibrate::observation::{CentreObservation, State};
use crate::calibrate::rotation_start::{PoseGeometry, ReducedProblem, RotationMinimum, octahedral_rotations};
use crate::calibrate::solver::minimise;
use crate::geometry::{Mat3, Rigid, Vec3};

use super::sections::Section;

/// For a look the sensor's orientation is sought from so many of the 24 orientations of a cube, the best ones.
const NUM_STARTS: usize = 4;
/// So many of the minima that are found are followed then.
const NUM_MINIMA: usize = 2;
/// Rounds of choosing sides and solving again in a look.
const QUICK_ROUNDS: usize = 3;
/// So many minima are followed when it comes to a fit.
const NUM_FOLLOWED: usize = 4;
/// So many of the solutions are improved side by side.
const NUM_IMPROVED: usize = 2;
/// Rotations nearer than this are the same minimum.
const SAME_MINIMUM_RAD: f64 = 1e-2;
/// Weight of y where the side is open and the solution is still to tell it.
const WEIGHT_OF_OPEN_Y: f64 = 1e-4;
/// Rounds of choosing sides and solving again; two or three settle it.
const MAX_ROUNDS: usize = 6;
/// Mean squared rotation (rad²) about an axis that counts as none: radians taken for degrees still turn by more than this.
const NO_ROTATION: f64 = 1e-9;
/// From so many stations on, the one that fits worst is left out, so that one wrong pose does not hide the convention.
const LEAVES_ONE_OUT_FROM: usize = 8;

/// The sections and the starts, the same for all readings.
#[derive(Clone, Debug)]
pub(super) struct Trials {
    pub sections: Vec<Section>,
    starts: Vec<UnitQuaternion<f64>>,
}

/// How well one reading fits.
#[derive(Clone, Debug)]
pub(super) struct Fit {
    /// RMS distance between measured and predicted ball centres in the sensor frame, mm; without the worst station where
    /// there are enough.
    pub rms_mm: f64,
    /// Whether each section takes the second of its poses.
    pub takes_second: Vec<bool>,
}

/// Which of its two poses and which of its two centres a section takes.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Choice {
    pose: Rigid,
    is_second: bool,
    centre: Vec3,
}

/// A solution with what its sections chose.
#[derive(Clone, Debug)]
struct Settled {
    choices: Vec<Choice>,
    state: State,
    /// The section that was left out.
    left_out: Option<usize>,
    /// Sum of the weighted squares, mm².
    cost: f64,
}

impl Trials {
    pub fn new(sections: Vec<Section>) -> Self {
        Self { sections, starts: octahedral_rotations() }
    }

    /// Measurements beyond the unknowns, y counted as far as it is known.
    pub fn degrees_of_freedom(&self) -> f64 {
        let kept = self.sections.len() - usize::from(self.sections.len() >= LEAVES_ONE_OUT_FROM);
        self.sections.iter().take(kept).map(|section| 2.0 + section.weight_of_y).sum::<f64>() - 9.0
    }

    /// How far the balls lie from their mean in the sensor frame, RMS, mm; y left out, as its sign may be open.
    pub fn spread_mm(&self) -> f64 {
        let scale = 1.0 / self.count();
        let seen = || self.sections.iter().map(|section| Vec3::new(section.x_mm, 0.0, section.z_mm));
        let mean = seen().sum::<Vec3>() * scale;
        (seen().map(|centre| (centre - mean).norm_squared()).sum::<f64>() * scale).sqrt()
    }

    /// A first look: the residual with y = 0 where the side is open, mm; `None` where the poses leave the calibration open.
    /// It is at most what the open y leave, where the poses are right, and far more for most that are not.
    pub fn first_look(&self, poses: &[Rigid]) -> Option<f64> {
        let geometry = PoseGeometry::with_least_movement(poses, NO_ROTATION).ok()?;
        let least = self.minima(&geometry.reduced(&self.flat()), NUM_STARTS).first()?.cost;
        Some((least / self.count()).sqrt()).filter(|rms_mm| rms_mm.is_finite())
    }

    /// A second look, with sides. Where `others` holds poses, each section may take its own of these instead.
    pub fn second_look(&self, poses: &[Rigid], others: Option<&[Rigid]>) -> Option<Fit> {
        let geometry = PoseGeometry::with_least_movement(poses, NO_ROTATION).ok()?;
        let reduced = geometry.reduced(&self.flat());
        let found = self.minima(&reduced, NUM_STARTS).into_iter().take(NUM_MINIMA).flat_map(|minimum| {
            let predicted = self.choices(poses, others, &reduced.state(minimum.flange_from_sensor));
            [predicted, self.on(Side::Plus, poses), self.on(Side::Minus, poses)]
                .map(|choices| self.settled_quickly(poses, others, choices, minimum))
        });
        let (cost, choices) = found.flatten().min_by(|a, b| a.0.total_cmp(&b.0))?;
        let takes_second = choices.iter().map(|choice| choice.is_second).collect();
        Some(Fit { rms_mm: (cost / self.count()).sqrt(), takes_second }).filter(|fit| fit.rms_mm.is_finite())
    }

    /// The least sum of squares, all weights one, and the choices behind it.
    fn settled_quickly(
        &self,
        poses: &[Rigid],
        others: Option<&[Rigid]>,
        mut choices: Vec<Choice>,
        start: RotationMinimum,
    ) -> Option<(f64, Vec<Choice>)> {
        let mut rotation = start.flange_from_sensor;
        let mut best: Option<(f64, Vec<Choice>)> = None;
        for _ in 0..QUICK_ROUNDS {
            let chosen: Vec<Rigid> = choices.iter().map(|choice| choice.pose).collect();
            let centres: Vec<Vec3> = choices.iter().map(|choice| choice.centre).collect();
            let geometry = PoseGeometry::with_least_movement(&chosen, NO_ROTATION).ok()?;
            let reduced = geometry.reduced(&centres);
            let minimum = reduced.descend(rotation);
            rotation = minimum.flange_from_sensor;
            let again = self.choices(poses, others, &reduced.state(rotation));
            let is_settled = again == choices;
            if best.as_ref().is_none_or(|(cost, _)| minimum.cost < *cost) {
                best = Some((minimum.cost, choices));
            }
            if is_settled {
                break;
            }
            choices = again;
        }
        best
    }

    #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^52 stations")]
    fn count(&self) -> f64 {
        self.sections.len() as f64
    }

    /// The best fit with these poses, `others` as for [`Trials::second_look`], from all starts.
    pub fn fit(&self, poses: &[Rigid], others: Option<&[Rigid]>) -> Option<Fit> {
        let geometry = PoseGeometry::with_least_movement(poses, NO_ROTATION).ok()?;
        let reduced = geometry.reduced(&self.flat());
        let minima = self.minima(&reduced, self.starts.len()).into_iter().take(NUM_FOLLOWED);
        let settled = minima.flat_map(|minimum| {
            let start = reduced.state(minimum.flange_from_sensor);
            let on_one_side =
                [Side::Plus, Side::Minus].map(|side| self.settled(poses, others, self.on(side, poses), start));
            on_one_side.into_iter().chain([self.settled_without_y(poses, others, start)]).flatten()
        });
        best(settled)?.fit()
    }

    /// The same with all that is known against wrong sides: one minimum is the mirror image of the other, and a single
    /// wrong side leaves a minimum of its own.
    pub fn fit_carefully(&self, poses: &[Rigid], others: Option<&[Rigid]>) -> Option<Fit> {
        let geometry = PoseGeometry::with_least_movement(poses, NO_ROTATION).ok()?;
        let mut found: Vec<Settled> = Vec::new();
        let mut keep_new = |settled: Settled| {
            if !found.iter().any(|known| known.choices == settled.choices) {
                found.push(settled);
            }
        };
        let flat = geometry.reduced(&self.flat());
        for minimum in self.minima(&flat, self.starts.len()) {
            let start = flat.state(minimum.flange_from_sensor);
            self.settled_without_y(poses, others, start).into_iter().for_each(&mut keep_new);
        }
        for side in [Side::Plus, Side::Minus] {
            self.settled_from(&geometry, &self.on(side, poses), poses, others).into_iter().for_each(&mut keep_new);
        }
        found.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        found.truncate(NUM_IMPROVED);
        let improved: Vec<Settled> = found.into_iter().map(|settled| self.improved(poses, others, settled)).collect();
        let mirrored = best(improved.iter().flat_map(|settled| self.mirrored(poses, others, settled)));
        let mirrored = mirrored.map(|settled| self.improved(poses, others, settled));
        best(improved.into_iter().chain(mirrored))?.fit()
    }

    /// What settles from these choices, with the rotation sought anew.
    fn settled_from(
        &self,
        geometry: &PoseGeometry,
        choices: &[Choice],
        poses: &[Rigid],
        others: Option<&[Rigid]>,
    ) -> Vec<Settled> {
        let centres: Vec<Vec3> = choices.iter().map(|choice| choice.centre).collect();
        let reduced = geometry.reduced(&centres);
        self.minima(&reduced, self.starts.len())
            .into_iter()
            .take(NUM_FOLLOWED)
            .filter_map(|minimum| {
                self.settled(poses, others, choices.to_vec(), reduced.state(minimum.flange_from_sensor))
            })
            .collect()
    }

    /// What settles from a solution with all open sides exchanged.
    fn mirrored(&self, poses: &[Rigid], others: Option<&[Rigid]>, settled: &Settled) -> Vec<Settled> {
        let chosen: Vec<Rigid> = settled.choices.iter().map(|choice| choice.pose).collect();
        let Ok(geometry) = PoseGeometry::with_least_movement(&chosen, NO_ROTATION) else { return Vec::new() };
        let mirrored: Vec<Choice> = self
            .sections
            .iter()
            .zip(&settled.choices)
            .map(|(section, choice)| match section.side {
                Some(_) => *choice,
                None => Choice { centre: Vec3::new(choice.centre.x, -choice.centre.y, choice.centre.z), ..*choice },
            })
            .collect();
        self.settled_from(&geometry, &mirrored, poses, others)
    }

    /// All sections with their first pose, those with an open side on this one.
    fn on(&self, side: Side, poses: &[Rigid]) -> Vec<Choice> {
        let choice = |(section, pose): (&Section, &Rigid)| Choice {
            pose: *pose,
            is_second: false,
            centre: section.centre(section.side.unwrap_or(side)),
        };
        self.sections.iter().zip(poses).map(choice).collect()
    }

    /// The centres with y = 0 where the side is open.
    fn flat(&self) -> Vec<Vec3> {
        let flat = |section: &Section| Vec3::new(section.x_mm, 0.0, section.z_mm);
        self.sections.iter().map(|section| section.side.map_or(flat(section), |side| section.centre(side))).collect()
    }

    /// The minima over the rotations from so many starts, the best ones first.
    fn minima(&self, reduced: &ReducedProblem<'_>, num_starts: usize) -> Vec<RotationMinimum> {
        let mut starts: Vec<(f64, &UnitQuaternion<f64>)> =
            self.starts.iter().map(|start| (reduced.cost(start), start)).collect();
        starts.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut minima: Vec<RotationMinimum> = Vec::new();
        for (_, start) in starts.into_iter().take(num_starts) {
            let minimum = reduced.descend(*start);
            let is_known = |known: &RotationMinimum| {
                known.flange_from_sensor.angle_to(&minimum.flange_from_sensor) < SAME_MINIMUM_RAD
            };
            if !minima.iter().any(is_known) {
                minima.push(minimum);
            }
        }
        minima.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        minima
    }

    /// What settles from a solution that hardly looks at y where its sign is open.
    fn settled_without_y(&self, poses: &[Rigid], others: Option<&[Rigid]>, start: State) -> Option<Settled> {
        let open: Vec<CentreObservation> = self
            .sections
            .iter()
            .zip(poses)
            .map(|(section, pose)| {
                let (centre, weight) = section.side.map_or_else(
                    || (Vec3::new(section.x_mm, 0.0, section.z_mm), WEIGHT_OF_OPEN_Y),
                    |side| (section.centre(side), section.weight_of_y),
                );
                observation(*pose, centre, weight)
            })
            .collect();
        let predicting = minimise(&open.iter(), start).ok()?.state;
        self.settled(poses, others, self.choices(poses, others, &predicting), predicting)
    }

    /// Solves with some choices, chooses sides and poses by what that predicts and solves again, until nothing changes.
    fn settled(
        &self,
        poses: &[Rigid],
        others: Option<&[Rigid]>,
        choices: Vec<Choice>,
        start: State,
    ) -> Option<Settled> {
        let mut settled = self.solved(choices, start, None)?;
        for _ in 0..MAX_ROUNDS {
            let choices = self.choices(poses, others, &settled.state);
            let left_out = self.worst(&choices, &settled.state);
            if choices == settled.choices && left_out == settled.left_out {
                break;
            }
            settled = self.solved(choices, settled.state, left_out)?;
        }
        Some(settled)
    }

    /// The section that fits worst, where there are enough to do without it.
    fn worst(&self, choices: &[Choice], state: &State) -> Option<usize> {
        let off = |idx: usize| self.off(idx, &choices[idx], state);
        (0..choices.len()).max_by(|a, b| off(*a).total_cmp(&off(*b))).filter(|_| choices.len() >= LEAVES_ONE_OUT_FROM)
    }

    fn solved(&self, choices: Vec<Choice>, start: State, left_out: Option<usize>) -> Option<Settled> {
        let used = |(idx, _): &(usize, &Choice)| Some(*idx) != left_out;
        let observations: Vec<CentreObservation> = choices
            .iter()
            .enumerate()
            .filter(used)
            .map(|(idx, choice)| observation(choice.pose, choice.centre, self.sections[idx].weight_of_y))
            .collect();
        let state = minimise(&observations.iter(), start).ok()?.state;
        let cost = choices.iter().enumerate().filter(used).map(|(idx, choice)| self.off(idx, choice, &state)).sum();
        Some(Settled { choices, state, left_out, cost })
    }

    /// Gives single sections another side or pose while the cost falls: what a solution predicts follows the errors that
    /// it was made with.
    fn improved(&self, poses: &[Rigid], others: Option<&[Rigid]>, mut settled: Settled) -> Settled {
        for _ in 0..self.sections.len() {
            let single_changes = settled.choices.iter().enumerate().flat_map(|(idx, current)| {
                let options = self.options(idx, poses, others);
                options.into_iter().filter(move |option| option != current).map(move |option| (idx, option))
            });
            let better = best(single_changes.filter_map(|(idx, option)| {
                let mut choices = settled.choices.clone();
                choices[idx] = option;
                self.solved(choices, settled.state, settled.left_out)
            }));
            match better {
                Some(better) if better.cost < settled.cost => settled = better,
                _ => break,
            }
        }
        settled
    }

    /// How far a choice is from a prediction: the weighted square, mm².
    fn off(&self, idx: usize, choice: &Choice, state: &State) -> f64 {
        let offset = state.ball_in_sensor(&choice.pose) - choice.centre;
        offset.x * offset.x + self.sections[idx].weight_of_y * offset.y * offset.y + offset.z * offset.z
    }

    /// What each section would choose by a prediction.
    fn choices(&self, poses: &[Rigid], others: Option<&[Rigid]>, state: &State) -> Vec<Choice> {
        let off = |idx: usize, choice: &Choice| self.off(idx, choice, state);
        (0..self.sections.len())
            .filter_map(|idx| {
                let options = self.options(idx, poses, others);
                options.into_iter().min_by(|a, b| off(idx, a).total_cmp(&off(idx, b)))
            })
            .collect()
    }

    /// What a section may choose from.
    fn options(&self, idx: usize, poses: &[Rigid], others: Option<&[Rigid]>) -> Vec<Choice> {
        let section = &self.sections[idx];
        let sides = section.side.map_or_else(|| vec![Side::Plus, Side::Minus], |side| vec![side]);
        let second = others.map(|others| (others[idx], true));
        std::iter::once((poses[idx], false))
            .chain(second)
            .flat_map(|(pose, is_second)| {
                let choice = move |side: &Side| Choice { pose, is_second, centre: section.centre(*side) };
                sides.iter().map(choice).collect::<Vec<Choice>>()
            })
            .collect()
    }
}

impl Settled {
    fn fit(self) -> Option<Fit> {
        #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^52 stations")]
        let count = (self.choices.len() - usize::from(self.left_out.is_some())) as f64;
        let rms_mm = (self.cost / count).sqrt();
        let takes_second = self.choices.iter().map(|choice| choice.is_second).collect();
        rms_mm.is_finite().then_some(Fit { rms_mm, takes_second })
    }
}

fn best(found: impl Iterator<Item = Settled>) -> Option<Settled> {
    found.min_by(|a, b| a.cost.total_cmp(&b.cost))
}

fn observation(pose: Rigid, centre: Vec3, weight_of_y: f64) -> CentreObservation {
    CentreObservation {
        information: Mat3::from_diagonal(&Vec3::new(1.0, weight_of_y, 1.0)),
        ..CentreObservation::point(0, pose, centre)
    }
}
