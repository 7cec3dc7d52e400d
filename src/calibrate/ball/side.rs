//! On which side of the laser plane is the ball? One section cannot tell; all stations together can.
//!
//! Across the line and along the range a section shows the ball's centre whatever the side, so a solution that ignores y
//! comes first and tells the sides; both global signs are tried as well. From each the sides and the rotation are
//! improved in turn, and single stations flipped while the cost falls. From one start alone this sticks.

use crate::calibrate::observation::CentreObservation;
use crate::calibrate::rotation_start::{PoseGeometry, RotationMinimum, octahedral_rotations};
use crate::calibrate::solver::minimise;
use crate::calibrate::{Side, SideChoice};
use crate::geometry::{Mat3, Rigid, Vec3};

/// A cost below this a station is rounding, mm².
const ROUNDING: f64 = 1e-16;
/// Beyond this many open stations pairs are left alone: with that many, single flips are enough.
const MAX_PAIR_FLIPS: usize = 12;
/// A residual of a hundredth of the sections' distance from the ball's centre: about 0.1 mm.
const FITS_PART_SQUARED: f64 = 1e-4;
/// Weight of y = 0 ± R/2 beside x and z, which are a hundred times better known.
const WEIGHT_OF_Y: f64 = 1e-4;
/// Rotations nearer than this are the same minimum.
const SAME_MINIMUM_RAD: f64 = 1e-3;
/// Beyond this many stations every single flip would take longer than a frame; turns of all stations do instead.
const MAX_SINGLE_FLIPS: usize = 64;

/// One station's two candidates, `(x1, ±|y|, z1)`, and what the user says.
#[derive(Clone, Copy, Debug)]
pub(super) struct SideCandidate {
    pub x_mm: f64,
    pub size_y_mm: f64,
    pub z_mm: f64,
    pub choice: SideChoice,
}

impl SideCandidate {
    pub fn centre(&self, side: Side) -> Vec3 {
        Vec3::new(self.x_mm, side.sign() * self.size_y_mm, self.z_mm)
    }

    /// The given side, or that of a predicted y.
    fn side_of(&self, predicted_y_mm: f64) -> Side {
        match self.choice {
            SideChoice::Given(side) => side,
            SideChoice::Auto if predicted_y_mm < 0.0 => Side::Minus,
            SideChoice::Auto => Side::Plus,
        }
    }

    const fn is_open(&self) -> bool {
        matches!(self.choice, SideChoice::Auto)
    }
}

/// The best assignment.
#[derive(Clone, Debug)]
pub(super) struct ResolvedSides {
    pub sides: Vec<Side>,
    /// Cost of the best assignment with this station on the other side, over the best cost; `None` where given.
    pub cost_ratios: Vec<Option<f64>>,
    pub minimum: RotationMinimum,
}

#[derive(Clone, Debug)]
struct Assignment {
    sides: Vec<Side>,
    minimum: RotationMinimum,
}

struct Resolver<'a> {
    poses: &'a PoseGeometry,
    base_from_flange: &'a [Rigid],
    candidates: &'a [SideCandidate],
}

/// Finds the sides that fit best.
pub(super) fn resolve_sides(
    poses: &PoseGeometry,
    base_from_flange: &[Rigid],
    candidates: &[SideCandidate],
) -> ResolvedSides {
    let resolver = Resolver { poses, base_from_flange, candidates };
    let mut finals: Vec<Assignment> = Vec::new();
    for global in [Side::Plus, Side::Minus] {
        let sides: Vec<Side> = candidates
            .iter()
            .map(|candidate| match candidate.choice {
                SideChoice::Auto => global,
                SideChoice::Given(side) => side,
            })
            .collect();
        let minimum = poses.reduced(&resolver.centres(&sides)).best_minimum();
        resolver.keep_new(&mut finals, Assignment { sides, minimum });
    }
    let fits = finals.iter().any(|assignment| resolver.fits_well(assignment));
    if candidates.iter().any(SideCandidate::is_open) && !fits {
        for start in resolver.starts_without_y() {
            resolver.keep_new(&mut finals, start);
        }
    }
    if candidates.iter().any(SideCandidate::is_open) {
        // The mirror image of the truth is a minimum that no single flip leaves, and may fit nearly as well.
        for mirrored in finals.iter().map(|assignment| resolver.mirrored(assignment)).collect::<Vec<_>>() {
            resolver.keep_new(&mut finals, mirrored);
        }
    }
    let paired: Vec<Assignment> = finals.iter().map(|assignment| resolver.flip_pairs(assignment.clone())).collect();
    finals = paired;
    finals.sort_by(|a, b| a.minimum.cost.total_cmp(&b.minimum.cost));
    let others = finals.split_off(1);
    let best = finals.swap_remove(0);
    let cost_ratios = resolver.cost_ratios(&best, &others);
    ResolvedSides { sides: best.sides, cost_ratios, minimum: best.minimum }
}

impl Resolver<'_> {
    fn centres(&self, sides: &[Side]) -> Vec<Vec3> {
        self.candidates.iter().zip(sides).map(|(candidate, side)| candidate.centre(*side)).collect()
    }

    /// Assignments told by solutions that hardly look at y.
    fn starts_without_y(&self) -> Vec<Assignment> {
        let flat: Vec<Vec3> =
            self.candidates.iter().map(|candidate| Vec3::new(candidate.x_mm, 0.0, candidate.z_mm)).collect();
        let reduced = self.poses.reduced(&flat);
        let mut starts: Vec<RotationMinimum> = Vec::new();
        for rotation in octahedral_rotations() {
            let minimum = reduced.descend(rotation);
            let is_known = |known: &RotationMinimum| {
                known.flange_from_sensor.angle_to(&minimum.flange_from_sensor) < SAME_MINIMUM_RAD
            };
            if !starts.iter().any(is_known) {
                starts.push(minimum);
            }
        }
        let observations: Vec<CentreObservation> = self
            .base_from_flange
            .iter()
            .zip(&flat)
            .enumerate()
            .map(|(idx, (pose, centre))| CentreObservation {
                information: Mat3::from_diagonal(&Vec3::new(1.0, WEIGHT_OF_Y, 1.0)),
                ..CentreObservation::point(idx, *pose, *centre)
            })
            .collect();
        starts
            .iter()
            .filter_map(|start| minimise(&observations.iter(), reduced.state(start.flange_from_sensor)).ok())
            .map(|found| {
                let sides: Vec<Side> = self
                    .candidates
                    .iter()
                    .zip(self.base_from_flange)
                    .map(|(candidate, pose)| candidate.side_of(found.state.ball_in_sensor(pose).y))
                    .collect();
                let minimum =
                    self.poses.reduced(&self.centres(&sides)).descend(found.state.flange_from_sensor.rotation);
                Assignment { sides, minimum }
            })
            .collect()
    }

    /// Whether the residual is a small part of the sections' distance from the ball's centre: then no other assignment
    /// can come near.
    fn fits_well(&self, assignment: &Assignment) -> bool {
        let size: f64 = self.candidates.iter().map(|candidate| candidate.size_y_mm * candidate.size_y_mm).sum();
        assignment.minimum.cost < FITS_PART_SQUARED * size
    }

    fn keep_new(&self, finals: &mut Vec<Assignment>, start: Assignment) {
        let settled = self.flip_singly(self.turn_all(start));
        match finals.iter_mut().find(|known| known.sides == settled.sides) {
            Some(known) if known.minimum.cost <= settled.minimum.cost => {}
            Some(known) => *known = settled,
            None => finals.push(settled),
        }
    }

    fn solve_near(&self, sides: &[Side], near: &RotationMinimum) -> RotationMinimum {
        self.poses.reduced(&self.centres(sides)).descend(near.flange_from_sensor)
    }

    /// Gives every open station the side that lies nearer to the ball, and solves again, until nothing changes.
    fn turn_all(&self, mut assignment: Assignment) -> Assignment {
        for _ in 0..20 {
            let reduced = self.poses.reduced(&self.centres(&assignment.sides));
            let state = reduced.state(assignment.minimum.flange_from_sensor);
            let sides: Vec<Side> = self
                .candidates
                .iter()
                .zip(self.base_from_flange)
                .map(|(candidate, pose)| candidate.side_of(state.ball_in_sensor(pose).y))
                .collect();
            if sides == assignment.sides {
                break;
            }
            let minimum = self.solve_near(&sides, &assignment.minimum);
            if minimum.cost >= assignment.minimum.cost {
                break;
            }
            assignment = Assignment { sides, minimum };
        }
        assignment
    }

    /// Flips two stations at once while the cost falls: single flips may all lead uphill.
    fn flip_pairs(&self, mut assignment: Assignment) -> Assignment {
        let open: Vec<usize> = (0..self.candidates.len()).filter(|idx| self.candidates[*idx].is_open()).collect();
        if open.len() > MAX_PAIR_FLIPS || self.fits_well(&assignment) {
            return assignment;
        }
        loop {
            let pairs =
                open.iter().enumerate().flat_map(|(at, first)| open[at + 1..].iter().map(|second| (*first, *second)));
            let best = pairs
                .map(|(first, second)| self.flipped(&self.flipped(&assignment, first), second))
                .min_by(|a, b| a.minimum.cost.total_cmp(&b.minimum.cost));
            match best {
                Some(flipped) if flipped.minimum.cost < assignment.minimum.cost => {
                    assignment = self.flip_singly(flipped);
                }
                _ => return assignment,
            }
        }
    }

    /// Flips single stations while the cost falls.
    fn flip_singly(&self, mut assignment: Assignment) -> Assignment {
        if self.candidates.len() > MAX_SINGLE_FLIPS || self.fits_well(&assignment) {
            return assignment;
        }
        loop {
            let best = (0..self.candidates.len())
                .filter(|idx| self.candidates[*idx].is_open())
                .map(|idx| self.flipped(&assignment, idx))
                .min_by(|a, b| a.minimum.cost.total_cmp(&b.minimum.cost));
            match best {
                Some(flipped) if flipped.minimum.cost < assignment.minimum.cost => assignment = flipped,
                _ => return assignment,
            }
        }
    }

    /// All open stations on the other side, with the rotation sought anew.
    fn mirrored(&self, assignment: &Assignment) -> Assignment {
        let sides: Vec<Side> = self
            .candidates
            .iter()
            .zip(&assignment.sides)
            .map(|(candidate, side)| if candidate.is_open() { side.flipped() } else { *side })
            .collect();
        let minimum = self.poses.reduced(&self.centres(&sides)).best_minimum();
        Assignment { sides, minimum }
    }

    fn flipped(&self, assignment: &Assignment, idx: usize) -> Assignment {
        let mut sides = assignment.sides.clone();
        sides[idx] = sides[idx].flipped();
        let minimum = self.solve_near(&sides, &assignment.minimum);
        Assignment { sides, minimum }
    }

    fn cost_ratios(&self, best: &Assignment, others: &[Assignment]) -> Vec<Option<f64>> {
        #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^52 stations")]
        let floor = ROUNDING * self.candidates.len() as f64;
        self.candidates
            .iter()
            .enumerate()
            .map(|(idx, candidate)| {
                candidate.is_open().then(|| {
                    let by_others = others
                        .iter()
                        .filter(|other| other.sides[idx] != best.sides[idx])
                        .map(|other| other.minimum.cost);
                    let by_flip = self.flipped(best, idx).minimum.cost;
                    by_others.fold(by_flip, f64::min).max(floor) / best.minimum.cost.max(floor)
                })
            })
            .collect()
    }
}
