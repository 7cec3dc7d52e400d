//! Why a method computed nothing.

use thiserror::Error;

use crate::fit::Refusal;

use super::Method;

/// Why a method computed nothing. Everything short of that is a [`super::Warning`] in the solution.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum SolveError {
    /// Nine unknowns need more than three points.
    #[error(
        "found {found} usable station{plural}; at least {needed} with different orientations are needed{because}",
        plural = plural(*found),
        because = because(refusal.as_ref())
    )]
    TooFewStations {
        /// Stations that the method can use.
        found: usize,
        /// The least number that will do.
        needed: usize,
        /// Why the first of the others cannot be used.
        refusal: Option<Refusal>,
    },
    /// The bundle needs the points, not reduced centres.
    #[error(
        "found {found} station{plural} with a usable profile; at least {needed} are needed, as this method works on the \
         points of profiles{because}",
        plural = plural(*found),
        because = because(refusal.as_ref())
    )]
    TooFewProfileStations {
        /// Stations with a usable profile.
        found: usize,
        /// The least number that will do.
        needed: usize,
        /// Why the first of the others cannot be used.
        refusal: Option<Refusal>,
    },
    /// A largest-arc method without steps to look at.
    #[error(
        "found {found} station{plural} with a sweep, and at least {needed} are needed: \
         record each station with steps along the laser's normal, {steps} profiles or more{because}",
        plural = plural(*found),
        because = because(refusal.as_ref())
    )]
    TooFewSweeps {
        /// Stations with a usable sweep.
        found: usize,
        /// The least number that will do.
        needed: usize,
        /// Profiles that make a sweep.
        steps: usize,
        /// Why the first of the others cannot be used.
        refusal: Option<Refusal>,
    },
    /// All orientations are the same, so a shift of the sensor cannot be told from a shift of the target.
    #[error(
        "the orientations differ by {span_deg:.2}° at most: with translations only, the sensor's place on the flange \
         cannot be found. Tilt and turn the tool between stations"
    )]
    NoRotation {
        /// Largest rotation between two stations, degrees.
        span_deg: f64,
    },
    /// All rotations share an axis; along it, sensor and ball shift together unseen.
    #[error(
        "all rotations are about one axis, ({axis_x:.2}, {axis_y:.2}, {axis_z:.2}) in the flange: the sensor's place along \
         it cannot be found. Add stations that are tilted about another axis"
    )]
    RotationsAboutOneAxis {
        /// The axis in the flange frame, x.
        axis_x: f64,
        /// y.
        axis_y: f64,
        /// z.
        axis_z: f64,
    },
    /// The readings leave a combination of the unknowns free.
    #[error(
        "the stations leave at least one direction free{}: add more stations, tilted differently and with the target \
         elsewhere in the profile",
        if condition.is_finite() { format!(" (condition number {condition:.1e})") } else { String::new() }
    )]
    Undetermined {
        /// Condition number of the scaled normal equations.
        condition: f64,
    },
    /// The method is for another target.
    #[error("{method} is not for this target; {available} {are}", method = method.id(), available = listed(available), are = if available.len() == 1 { "is" } else { "are" })]
    OtherTarget {
        /// The method.
        method: Method,
        /// Those for the target.
        available: &'static [Method],
    },
    /// Two lines in space and a sensor on the flange need more.
    #[error(
        "found {found_p} point{} on edge p and {found_q} on edge q; at least {needed} on each are needed, with different \
         orientations{alone}{because}",
        plural(*found_p),
        alone = one_edge_alone(*found_p, *found_q),
        because = because(refusal.as_ref())
    )]
    TooFewEdgePoints {
        /// Points on edge p.
        found_p: usize,
        /// Points on edge q.
        found_q: usize,
        /// The least number on each.
        needed: usize,
        /// Why the first of the others cannot be used.
        refusal: Option<Refusal>,
    },
    /// Targets of one sensor are seen from one place.
    #[error(
        "some targets are seen by a sensor on the flange, others by one beside the robot: they share no calibration"
    )]
    MixedMounts,
    /// Poses that cannot be matched by their times.
    #[error("the times of a list of poses do not rise; sort each list by time, with one pose a time")]
    TimesNotRising,
    /// No start led to a finite solution.
    #[error("the solver found no finite solution; check poses and units")]
    Diverged,
}

const fn plural(count: usize) -> &'static str {
    if count == 1 { "" } else { "s" }
}

/// What a single straight line leaves open.
const fn one_edge_alone(found_p: usize, found_q: usize) -> &'static str {
    match (found_p, found_q) {
        (0, 0) | (1.., 1..) => "",
        _ => {
            ". From one straight edge alone the plate's turn about that edge and the place of its corner along it cannot be \
             found, and no right angle bears on the sensor: let the laser line cross the other edge as well"
        }
    }
}

fn because(refusal: Option<&Refusal>) -> String {
    refusal.map_or_else(String::new, |refusal| format!(". A profile is left out because: {refusal}"))
}

fn listed(methods: &[Method]) -> String {
    methods.iter().map(|method| method.id()).collect::<Vec<_>>().join(", ")
}
