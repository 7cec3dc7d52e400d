//! `ball-fixed-point`: one section a station, the ball's centre ±√(R² − l²) beside the laser plane.
//!
//! # Source
//! Lin & Mu 2019, section 1, eq. 1–2 (their baseline, after Wang & Dai 2015). The paper counts seven unknowns; with the
//! ball's centre there are nine, so four stations are the bare minimum, and rotations about one axis never suffice.

use crate::calibrate::observation::{CentreObservation, State};
use crate::calibrate::rotation_start::PoseGeometry;
use crate::calibrate::shared_warnings::{first_refusal, refused_captures};
use crate::calibrate::solver::{Normal, minimise};
use crate::calibrate::uncertainty::Spread;
use crate::calibrate::{BallProblem, Method, Reading, Side, SideChoice, Solution, SolveError, Station, Warning};
use crate::fit::ArcFit;
use crate::geometry::{Rigid, Vec3, stats};

use super::MIN_STATIONS;
use super::assemble::{Found, StationFacts, first_pose};
use super::passes::change_by_radius;
use super::side::{SideCandidate, resolve_sides};

/// Below this cost ratio the data hardly tell the sides apart.
const SIDE_RATIO: f64 = 2.0;
/// y counts as blind when its σ is this many times that of x and z.
const BLIND_RATIO: f64 = 10.0;
/// A section above the ball's radius by more than this many σ is not noise.
const LARGER_AT_STDS: f64 = 3.0;

struct Section<'a> {
    station: &'a Station,
    candidate: SideCandidate,
    std_mm: Option<Vec3>,
}

impl Section<'_> {
    /// The candidates if the ball had another radius; a reduced point stays where it is.
    fn at_radius(&self, radius_mm: f64) -> SideCandidate {
        let size_y_mm = match self.station.captures.first().map(|capture| &capture.reading) {
            Some(Reading::Arc(arc)) => distance_from_plane(arc, radius_mm).0,
            _ => self.candidate.size_y_mm,
        };
        SideCandidate { size_y_mm, ..self.candidate }
    }

    /// Whether the ball's centre is clearly off the laser plane; if not, the side does not matter and blindness is the
    /// finding.
    fn y_is_seen(&self) -> bool {
        self.std_mm.is_none_or(|std| self.candidate.size_y_mm > 2.0 * std.y)
    }
}

/// Solves by one section a station.
///
/// # Errors
/// [`SolveError`] with fewer than four usable stations, or if they leave a direction free.
pub fn solve(problem: &BallProblem) -> Result<Solution, SolveError> {
    find(problem)?.into_solution()
}

/// The minimum alone, for other methods to start from.
pub(super) fn state(problem: &BallProblem) -> Result<State, SolveError> {
    Ok(find(problem)?.minimum.state)
}

/// The minimum with all that is known about it.
pub(super) fn find(problem: &BallProblem) -> Result<Found<'_>, SolveError> {
    let mut warnings = Vec::new();
    let sections: Vec<Section<'_>> =
        problem.stations.iter().filter_map(|station| section(problem, station, &mut warnings)).collect();
    if sections.len() < MIN_STATIONS {
        return Err(SolveError::TooFewStations {
            found: sections.len(),
            needed: MIN_STATIONS,
            refusal: first_refusal(&problem.stations),
        });
    }
    warnings.extend(refused_captures(&problem.stations));
    let base_from_flange: Vec<Rigid> = sections.iter().map(|section| *first_pose(section.station)).collect();
    let candidates: Vec<SideCandidate> = sections.iter().map(|section| section.candidate).collect();
    let poses = PoseGeometry::new(&base_from_flange)?;
    let resolved = resolve_sides(&poses, &base_from_flange, &candidates);
    let centres: Vec<Vec3> =
        candidates.iter().zip(&resolved.sides).map(|(candidate, side)| candidate.centre(*side)).collect();
    let start = poses.reduced(&centres).state(resolved.minimum.flange_from_sensor);
    let observations = without_copies(CentreObservation::points(&base_from_flange, &centres));
    let minimum = minimise(&observations.iter(), start)?;
    // With a larger ball every section is further from its centre.
    let by_radius = change_by_radius(problem.radius_mm, &minimum.hessian, |radius_mm| {
        let at_radius = sections.iter().map(|section| section.at_radius(radius_mm));
        let centres: Vec<Vec3> =
            at_radius.zip(&resolved.sides).map(|(candidate, side)| candidate.centre(*side)).collect();
        let moved = observations
            .iter()
            .zip(centres)
            .map(|(observation, centre)| CentreObservation { centre_in_sensor: centre, ..observation.clone() });
        Ok(Normal::of(moved.collect::<Vec<_>>().iter(), &minimum.state).gradient)
    })?;
    add_side_warning(&sections, &resolved.cost_ratios, &mut warnings);
    add_blind_warning(&sections, &mut warnings);
    let spread = scaled_spread(&observations, &minimum.state);
    let stations = sections
        .iter()
        .zip(resolved.cost_ratios)
        .map(|(section, side_cost_ratio)| StationFacts {
            station: section.station,
            side_cost_ratio: side_cost_ratio.filter(|_| section.std_mm.is_some()),
            target_in_sensor_std_mm: section.std_mm,
            sweep: None,
        })
        .collect();
    Ok(Found {
        method: Method::BallFixedPoint,
        problem,
        stations,
        observations,
        common_covariance: Vec::new(),
        minimum,
        spread,
        noise: None,
        radius: None,
        by_radius,
        prior_information: 0.0,
        poses,
        warnings,
    })
}

/// The first capture of a station as candidates for the ball's centre; reduced points are taken as they are.
fn section<'a>(problem: &BallProblem, station: &'a Station, warnings: &mut Vec<Warning>) -> Option<Section<'a>> {
    match &station.captures.first()?.reading {
        Reading::Point(point) => Some(Section {
            station,
            candidate: SideCandidate {
                x_mm: point.x,
                size_y_mm: point.y.abs(),
                z_mm: point.z,
                choice: SideChoice::Given(if point.y < 0.0 { Side::Minus } else { Side::Plus }),
            },
            std_mm: None,
        }),
        Reading::Edge(_) | Reading::Refused(_) | Reading::Pose(_) => {
            warnings.push(Warning::StationSkipped { label: station.label.clone(), found: 0, needed: 1 });
            None
        }
        Reading::Arc(arc) => {
            let (size_y_mm, std_y_mm) = distance_from_plane(arc, problem.radius_mm);
            let [std_x_mm, std_z_mm, std_l_mm] = arc.std_mm();
            if arc.circle.radius_mm > problem.radius_mm + LARGER_AT_STDS * std_l_mm {
                warnings.push(Warning::ArcLargerThanBall {
                    label: station.label.clone(),
                    capture_idx: 0,
                    section_radius_mm: arc.circle.radius_mm,
                    ball_radius_mm: problem.radius_mm,
                });
            }
            Some(Section {
                station,
                candidate: SideCandidate {
                    x_mm: arc.circle.x_mm,
                    size_y_mm,
                    z_mm: arc.circle.z_mm,
                    choice: station.side,
                },
                std_mm: Some(Vec3::new(std_x_mm, std_y_mm, std_z_mm)),
            })
        }
    }
}

/// |y| = √(R² − l²) and its standard deviation (`l/|y|)·σ_l`; sections larger than the ball are taken for the largest.
///
/// At the largest arc the linear formula diverges; there |y| stays below what a radius error of one σ makes, √(2 R `σ_l`).
pub(crate) fn distance_from_plane(arc: &ArcFit, ball_radius_mm: f64) -> (f64, f64) {
    let section_radius_mm = arc.circle.radius_mm.min(ball_radius_mm);
    let size_y_mm = ((ball_radius_mm - section_radius_mm) * (ball_radius_mm + section_radius_mm)).sqrt();
    let std_l_mm = arc.std_mm()[2];
    let bound_mm = (2.0 * ball_radius_mm * std_l_mm).sqrt();
    let linear_mm = section_radius_mm * std_l_mm / size_y_mm;
    (size_y_mm, if linear_mm < bound_mm { linear_mm } else { bound_mm })
}

fn add_side_warning(sections: &[Section<'_>], cost_ratios: &[Option<f64>], warnings: &mut Vec<Warning>) {
    let doubtful: Vec<(&str, f64)> = sections
        .iter()
        .zip(cost_ratios)
        .filter_map(|(section, ratio)| {
            ratio.filter(|r| *r < SIDE_RATIO && section.y_is_seen()).map(|r| (section.station.label.as_str(), r))
        })
        .collect();
    if !doubtful.is_empty() {
        warnings.push(Warning::SideAmbiguous {
            labels: doubtful.iter().map(|(label, _)| (*label).to_owned()).collect(),
            ratio: doubtful.iter().map(|(_, ratio)| *ratio).fold(f64::INFINITY, f64::min),
        });
    }
}

fn add_blind_warning(sections: &[Section<'_>], warnings: &mut Vec<Warning>) {
    let blind: Vec<(&Section<'_>, Vec3)> = sections
        .iter()
        .filter_map(|section| section.std_mm.map(|std| (section, std)))
        .filter(|(_, std)| std.y > BLIND_RATIO * std.x.max(std.z))
        .collect();
    if !blind.is_empty() {
        let mut std_xz: Vec<f64> = blind.iter().map(|(_, std)| std.x.max(std.z)).collect();
        warnings.push(Warning::BlindInY {
            labels: blind.iter().map(|(section, _)| section.station.label.clone()).collect(),
            std_y_mm: stats::max(blind.iter().map(|(_, std)| std.y)),
            std_xz_mm: stats::median(&mut std_xz),
        });
    }
}

/// A station that was entered several times weighs as one: copies tell nothing new, and nothing of the scatter.
fn without_copies(observations: Vec<CentreObservation>) -> Vec<CentreObservation> {
    let is_copy = |one: &CentreObservation, other: &CentreObservation| {
        one.base_from_flange == other.base_from_flange && one.centre_in_sensor == other.centre_in_sensor
    };
    #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^52 stations")]
    let weight = |one: &CentreObservation| {
        // What is not a number is not even its own copy.
        1.0 / observations.iter().filter(|other| is_copy(one, other)).count().max(1) as f64
    };
    let weights: Vec<f64> = observations.iter().map(weight).collect();
    observations
        .into_iter()
        .zip(weights)
        .map(|(one, weight)| CentreObservation { information: one.information * weight, ..one })
        .collect()
}

/// The scale that unit-weight points set by their own scatter; `None` if nothing is left over.
pub(super) fn scaled_spread(observations: &[CentreObservation], state: &State) -> Option<Spread> {
    let cost: f64 = observations
        .iter()
        .map(|observation| {
            let off = state.ball_in_sensor(&observation.base_from_flange) - observation.centre_in_sensor;
            off.dot(&(observation.information * off))
        })
        .sum();
    // Each counts as three equations by its weight, copies as one together.
    let equations: f64 = observations.iter().map(|observation| observation.information.trace()).sum();
    let degrees_of_freedom = (equations - 9.0).round();
    (degrees_of_freedom > 0.0).then(|| Spread::Scaled { factor: cost / degrees_of_freedom, degrees_of_freedom })
}
