//! The ball session as a model with room for one thing more: what every section says, against the nine unknowns and an
//! extension of them.
//!
//! The noise has two parts that are both found from the data: one of every section, and one common to a station. So a
//! sweep of many steps does not count as many stations, and a figure that the session states wrongly misleads nobody.

use std::sync::Arc;

use nalgebra::{SMatrix, SVector};

use crate::calibrate::ball::{MIN_STATIONS, section_residual};
use crate::calibrate::observation::{NUM_UNKNOWNS, State};
use crate::calibrate::{BallProblem, Mount, Reading};
use crate::fit::ArcFit;
use crate::geometry::so3::hat;
use crate::geometry::{Mat3, Rigid, Vec3, se3, stats};

/// The most that an extension adds: a second frame.
const MAX_EXTRA: usize = 6;
const MAX_UNKNOWNS: usize = NUM_UNKNOWNS + MAX_EXTRA;

type Jacobian = SMatrix<f64, 3, MAX_UNKNOWNS>;
type Mat3N = SMatrix<f64, MAX_UNKNOWNS, 3>;
type Square = SMatrix<f64, MAX_UNKNOWNS, MAX_UNKNOWNS>;
type Column = SVector<f64, MAX_UNKNOWNS>;

/// Rounds of minimising and finding the noise anew; it settles at each round to its square root.
const NOISE_ROUNDS: usize = 14;
/// A noise that changes by less than this part between rounds is settled.
const NOISE_SETTLED: f64 = 0.02;
/// Steps of a descent: from a bent start a dozen, near the minimum two.
const MAX_STEPS: usize = 25;
/// A step that lowers the cost by less than this part is the last.
const COST_SETTLED: f64 = 1e-7;
/// No robot and no profiler is better than this, mm: it keeps exact data weighable.
const LEAST_STD_MM: f64 = 1e-6;

/// A residual above this part of the radius is nothing near the truth, whatever else fits worse: 0.3 mm on a ball of 15 mm.
pub(super) const FAR_OFF_PART: f64 = 0.02;

/// What may be different from what the session says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Extension {
    /// Nothing.
    Plain,
    /// The ball's radius.
    Radius,
    /// The scale of the profiles.
    Scale,
    /// Both of them.
    RadiusAndScale,
    /// The ball moves steadily from the first station to the last.
    Drift,
    /// From this station on the sensor is elsewhere on the flange; for [`Mount::Fixed`], where a switched TOOL shows as
    /// another place of the ball on the flange only, the ball is elsewhere.
    SecondFrame {
        /// The first station (in the problem) concerned.
        from: usize,
    },
}

/// All unknowns, those of an extension at rest where it is not tried.
#[derive(Clone, Copy, Debug)]
pub(super) struct Unknowns {
    /// The nine.
    pub state: State,
    /// The ball's radius, mm.
    pub radius_mm: f64,
    /// Logarithm of the factor that the profiles need.
    pub log_scale: f64,
    /// Shift of the ball from the first station to the last, mm.
    pub drift_mm: Vec3,
    /// The other frame in the first one, for a sensor on the flange; the shift of the ball otherwise.
    pub first_from_second: Rigid,
}

impl Unknowns {
    /// The factor that the profiles need.
    pub fn scale(&self) -> f64 {
        self.log_scale.exp()
    }
}

/// Standard deviations, mm.
#[derive(Clone, Copy, Debug)]
struct NoiseParts {
    of_section: f64,
    of_station: f64,
}

#[derive(Clone, Debug)]
enum Measured {
    Arc(Arc<ArcFit>),
    Point(Vec3),
}

#[derive(Clone, Debug)]
struct Section {
    base_from_flange: Rigid,
    measured: Measured,
}

/// A section as the unknowns have it.
struct Seen {
    /// What is left of it.
    residual: Vec3,
    /// The ball's centre in its sensor frame.
    centre: Vec3,
    /// Derivatives of the residual.
    by_centre: Mat3,
    by_ball: Mat3,
    by_radius: Vec3,
    by_log_scale: Vec3,
}

impl Section {
    fn seen(&self, unknowns: &Unknowns, state: &State) -> Seen {
        let (centre, sensor_from_base) = state.ball_in_sensor_and_rotation(&self.base_from_flange);
        // As the file has it: everything is smaller by the factor that the profiles lack.
        let shrink = 1.0 / unknowns.scale();
        let (in_file, radius_in_file_mm) = (centre * shrink, unknowns.radius_mm * shrink);
        let ((residual, by_in_file), by_radius_in_file) = match &self.measured {
            Measured::Arc(arc) => (
                section_residual(arc, radius_in_file_mm, in_file),
                Vec3::new(0.0, 0.0, -radius_in_file_mm / arc.circle.radius_mm),
            ),
            Measured::Point(point) => ((point - in_file, -Mat3::identity()), Vec3::zeros()),
        };
        let by_centre = by_in_file * shrink;
        Seen {
            residual,
            centre,
            by_centre,
            by_ball: by_centre * sensor_from_base,
            by_radius: by_radius_in_file * shrink,
            by_log_scale: -(by_in_file * in_file + by_radius_in_file * radius_in_file_mm),
        }
    }

    fn weight(&self, noise: NoiseParts) -> Option<Mat3> {
        let own = match &self.measured {
            Measured::Arc(arc) => arc.covariance,
            Measured::Point(_) => Mat3::zeros(),
        };
        (own + Mat3::identity() * (noise.of_section * noise.of_section)).try_inverse()
    }
}

/// The data.
#[derive(Clone, Debug)]
pub(super) struct Model {
    /// By station of the problem; stations without a section are empty.
    stations: Vec<Vec<Section>>,
    mount: Mount,
    radius_mm: f64,
}

/// A minimum.
#[derive(Clone, Debug)]
pub(super) struct Fit {
    extension: Extension,
    /// Where it is.
    pub unknowns: Unknowns,
    /// Weighted sum of squares.
    chi_square: f64,
    noise: NoiseParts,
    /// The inverse of the normal equations.
    covariance: Square,
    /// Degrees of freedom left over when every section counts.
    freedom: f64,
    /// RMS over the sections of what is left of (x, z, l), mm.
    pub rms_mm: f64,
}

/// Sums over the sections.
struct Sums {
    normal: Square,
    gradient: Column,
    cost: f64,
    /// By how much the squares of the two noises differ from what was assumed.
    noise_ratios: [f64; 2],
}

impl Extension {
    /// How many unknowns it adds.
    pub const fn num_extra(self, mount: Mount) -> usize {
        match (self, mount) {
            (Self::Plain, _) => 0,
            (Self::Radius | Self::Scale, _) => 1,
            (Self::RadiusAndScale, _) => 2,
            (Self::Drift, _) | (Self::SecondFrame { .. }, Mount::Fixed) => 3,
            (Self::SecondFrame { .. }, Mount::OnFlange) => 6,
        }
    }

    /// Whether steps within a station tell, so that each of them counts as a measurement of its own.
    const fn shows_within_station(self) -> bool {
        matches!(self, Self::Radius | Self::Scale | Self::RadiusAndScale)
    }
}

impl Fit {
    /// The standard deviation of an extra unknown, by its place in the extension.
    pub fn extra_std(&self, idx: usize) -> f64 {
        (self.extra_variance(idx) * self.variance_factor()).max(0.0).sqrt()
    }

    /// The standard deviation of the extra unknowns along a direction.
    pub fn extra_std_along(&self, direction: Vec3) -> f64 {
        let block = self.covariance.fixed_view::<3, 3>(NUM_UNKNOWNS, NUM_UNKNOWNS);
        (direction.dot(&(block * direction)) * self.variance_factor()).max(0.0).sqrt()
    }

    /// Whether this fit, of fewer data by the same noise, leaves no more over a degree of freedom than the other.
    pub fn fits_no_worse_than(&self, other: &Self) -> bool {
        self.variance_factor() <= other.variance_factor()
    }

    fn extra_variance(&self, idx: usize) -> f64 {
        self.covariance[(NUM_UNKNOWNS + idx, NUM_UNKNOWNS + idx)]
    }

    fn variance_factor(&self) -> f64 {
        self.chi_square / self.freedom
    }
}

impl Model {
    /// The sections of a problem; `None` if there are too few for the nine unknowns and anything else.
    pub fn new(problem: &BallProblem) -> Option<Self> {
        let stations: Vec<Vec<Section>> = problem
            .stations
            .iter()
            .map(|station| {
                station
                    .captures
                    .iter()
                    .filter_map(|capture| {
                        let measured = match &capture.reading {
                            Reading::Arc(arc) => Measured::Arc(Arc::clone(arc)),
                            Reading::Point(point) => Measured::Point(*point),
                            Reading::Edge(_) | Reading::Refused(_) | Reading::Pose(_) => return None,
                        };
                        Some(Section { base_from_flange: *capture.base_from_flange.rigid(), measured })
                    })
                    .collect()
            })
            .collect();
        let num_used = stations.iter().filter(|sections| !sections.is_empty()).count();
        (num_used >= MIN_STATIONS).then_some(Self { stations, mount: problem.mount, radius_mm: problem.radius_mm })
    }

    /// The same data without a station; `None` if too few are left.
    pub fn without(&self, station: usize) -> Option<Self> {
        let mut others = self.clone();
        others.stations.get_mut(station)?.clear();
        (others.used_stations().count() >= MIN_STATIONS).then_some(others)
    }

    /// Where the sensor is.
    pub const fn mount(&self) -> Mount {
        self.mount
    }

    /// The unknowns as the session has them, at a state.
    pub fn as_given(&self, state: State) -> Unknowns {
        Unknowns {
            state,
            radius_mm: self.radius_mm,
            log_scale: 0.0,
            drift_mm: Vec3::zeros(),
            first_from_second: Rigid::identity(),
        }
    }

    /// Whether all of it is reduced points, which say nothing about radius and sides.
    pub fn has_arcs(&self) -> bool {
        self.stations.iter().flatten().any(|section| matches!(section.measured, Measured::Arc(_)))
    }

    /// The stations of the problem that have a section.
    pub fn used_stations(&self) -> impl DoubleEndedIterator<Item = usize> + '_ {
        self.stations.iter().enumerate().filter(|(_, sections)| !sections.is_empty()).map(|(station, _)| station)
    }

    /// Minimises with an extension, the noise found along with it.
    pub fn fit(&self, extension: Extension, start: Unknowns) -> Option<Fit> {
        let rms_mm = self.rms_mm(extension, &start).max(LEAST_STD_MM);
        let mut noise = NoiseParts { of_section: rms_mm, of_station: rms_mm };
        let mut unknowns = start;
        let mut fit = None;
        for _ in 0..NOISE_ROUNDS {
            let (found, ratios) = self.descend(extension, unknowns, noise)?;
            unknowns = found.unknowns;
            fit = Some(found);
            let changed = |std: f64, ratio: f64| (std * ratio.powf(0.25)).max(LEAST_STD_MM);
            let next = NoiseParts {
                of_section: changed(noise.of_section, ratios[0]),
                of_station: changed(noise.of_station, ratios[1]),
            };
            let change = (next.of_section / noise.of_section - 1.0).abs().max(
                // Far below the noise of a section it does not matter.
                if next.of_station < 0.01 * next.of_section {
                    0.0
                } else {
                    (next.of_station / noise.of_station - 1.0).abs()
                },
            );
            noise = next;
            if change < NOISE_SETTLED {
                break;
            }
        }
        fit
    }

    /// How decisively an extension beats the plain model: minus twice the logarithm of the likelihood ratio, made smaller
    /// where few stations stand behind the noise. Without need for the extension it is about its number of unknowns.
    pub fn evidence(&self, extended: &Fit, plain: &Fit) -> Option<f64> {
        let (plain, _) = self.descend(Extension::Plain, plain.unknowns, extended.noise)?;
        #[expect(clippy::cast_precision_loss, reason = "small numbers")]
        let extra = extended.extension.num_extra(self.mount) as f64;
        let freedom = if extended.extension.shows_within_station() {
            extended.freedom
        } else {
            #[expect(clippy::cast_precision_loss, reason = "small numbers")]
            let of_stations = 3.0 * self.used_stations().count() as f64 - NUM_UNKNOWNS as f64 - extra;
            of_stations
        };
        if freedom < 1.0 {
            return None;
        }
        let gain = (plain.chi_square - extended.chi_square).max(0.0) / extended.variance_factor();
        Some((freedom + 0.5 * extra - 1.0) * (gain / freedom).ln_1p())
    }

    /// Minimises with the noise held; also by how much the noise differs from what was assumed.
    pub fn fit_as(&self, extension: Extension, start: Unknowns, noise_of: &Fit) -> Option<Fit> {
        self.descend(extension, start, noise_of.noise).map(|(fit, _)| fit)
    }

    fn descend(&self, extension: Extension, start: Unknowns, noise: NoiseParts) -> Option<(Fit, [f64; 2])> {
        let mut unknowns = start;
        let mut sums = self.sums(extension, &unknowns, noise)?;
        let mut damping = 0.0;
        for _ in 0..MAX_STEPS {
            let Some(step) = solve_scaled(&sums.normal, &sums.gradient, damping) else {
                damping = (damping * 10.0_f64).max(1e-6);
                continue;
            };
            let trial = self.stepped(extension, &unknowns, &step);
            match self.sums(extension, &trial, noise) {
                Some(trial_sums) if trial_sums.cost <= sums.cost * (1.0 + 1e-12) => {
                    let settled = sums.cost - trial_sums.cost <= COST_SETTLED * sums.cost;
                    (unknowns, sums) = (trial, trial_sums);
                    damping *= 0.1;
                    if damping < 1e-9 {
                        damping = 0.0;
                    }
                    if settled {
                        break;
                    }
                }
                _ => damping = (damping * 10.0).max(1e-6),
            }
        }
        let covariance = inverse_scaled(&sums.normal)?;
        #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^52 sections")]
        let freedom = 3.0 * self.stations.iter().flatten().count() as f64
            - (NUM_UNKNOWNS + extension.num_extra(self.mount)) as f64;
        let rms_mm = self.rms_mm(extension, &unknowns);
        (freedom >= 1.0 && rms_mm.is_finite()).then_some((
            Fit { extension, unknowns, chi_square: sums.cost, noise, covariance, freedom, rms_mm },
            sums.noise_ratios,
        ))
    }

    fn stepped(&self, extension: Extension, unknowns: &Unknowns, step: &Column) -> Unknowns {
        let mut next =
            Unknowns { state: unknowns.state.stepped(&step.fixed_rows::<NUM_UNKNOWNS>(0).into_owned()), ..*unknowns };
        let extra = step.fixed_rows::<MAX_EXTRA>(NUM_UNKNOWNS);
        match extension {
            Extension::Plain => {}
            Extension::Radius => next.radius_mm += extra[0],
            Extension::Scale => next.log_scale += extra[0],
            Extension::RadiusAndScale => {
                next.radius_mm += extra[0];
                next.log_scale += extra[1];
            }
            Extension::Drift => next.drift_mm += extra.fixed_rows::<3>(0),
            Extension::SecondFrame { .. } => match self.mount {
                Mount::OnFlange => next.first_from_second *= se3::exp(&extra.into_owned()),
                Mount::Fixed => next.first_from_second.translation.vector += extra.fixed_rows::<3>(0),
            },
        }
        next
    }

    /// Where a station stands between the first (−½) and the last (½).
    fn time(&self, station: usize) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^52 stations")]
        let part = station as f64 / (self.stations.len() - 1) as f64;
        part - 0.5
    }

    /// The nine unknowns as they are at a station.
    fn state_at(&self, extension: Extension, unknowns: &Unknowns, station: usize) -> State {
        let mut state = unknowns.state;
        match extension {
            Extension::Drift => state.ball_in_base += unknowns.drift_mm * self.time(station),
            Extension::SecondFrame { from } if station >= from => match self.mount {
                Mount::OnFlange => state.flange_from_sensor *= unknowns.first_from_second,
                Mount::Fixed => state.ball_in_base += unknowns.first_from_second.translation.vector,
            },
            _ => {}
        }
        state
    }

    fn jacobian(&self, extension: Extension, unknowns: &Unknowns, seen: &Seen, station: usize) -> Jacobian {
        let Seen { centre, by_centre, by_ball, .. } = seen;
        let mut jacobian = Jacobian::zeros();
        // ds = s × ω − v + C db, see `State`.
        jacobian.fixed_view_mut::<3, 3>(0, 0).copy_from(&(by_centre * hat(*centre)));
        jacobian.fixed_view_mut::<3, 3>(0, 3).copy_from(&-by_centre);
        jacobian.fixed_view_mut::<3, 3>(0, 6).copy_from(by_ball);
        match extension {
            Extension::Radius => jacobian.set_column(NUM_UNKNOWNS, &seen.by_radius),
            Extension::Scale => jacobian.set_column(NUM_UNKNOWNS, &seen.by_log_scale),
            Extension::RadiusAndScale => {
                jacobian.set_column(NUM_UNKNOWNS, &seen.by_radius);
                jacobian.set_column(NUM_UNKNOWNS + 1, &seen.by_log_scale);
            }
            Extension::Drift => {
                jacobian.fixed_view_mut::<3, 3>(0, NUM_UNKNOWNS).copy_from(&(by_ball * self.time(station)));
            }
            Extension::SecondFrame { from } if station >= from => match self.mount {
                Mount::Fixed => jacobian.fixed_view_mut::<3, 3>(0, NUM_UNKNOWNS).copy_from(by_ball),
                Mount::OnFlange => {
                    // X S exp(step): the second frame's step is the sensor's own, the first one's is seen through S.
                    jacobian.fixed_view_mut::<3, 3>(0, NUM_UNKNOWNS).copy_from(&(by_centre * hat(*centre)));
                    jacobian.fixed_view_mut::<3, 3>(0, NUM_UNKNOWNS + 3).copy_from(&-by_centre);
                    let first_from_second = unknowns.first_from_second;
                    let by_first = by_centre * first_from_second.rotation.to_rotation_matrix().matrix().transpose();
                    let in_first = first_from_second.transform_point(&(*centre).into()).coords;
                    jacobian.fixed_view_mut::<3, 3>(0, 0).copy_from(&(by_first * hat(in_first)));
                    jacobian.fixed_view_mut::<3, 3>(0, 3).copy_from(&-by_first);
                }
            },
            Extension::Plain | Extension::SecondFrame { .. } => {}
        }
        jacobian
    }

    fn sums(&self, extension: Extension, unknowns: &Unknowns, noise: NoiseParts) -> Option<Sums> {
        let station_variance = noise.of_station * noise.of_station;
        let mut sums = Sums { normal: Square::zeros(), gradient: Column::zeros(), cost: 0.0, noise_ratios: [1.0; 2] };
        // For each part of the noise: the squares that there are, and those that there should be.
        let (mut section_found, mut section_due, mut station_found, mut station_due) = (0.0, 0.0, 0.0, 0.0);
        for (station, sections) in self.stations.iter().enumerate() {
            let state = self.state_at(extension, unknowns, station);
            // A shift common to the station, in the base, is integrated out.
            let (mut information, mut by_shift, mut gradient) = (Mat3::zeros(), Mat3N::zeros(), Vec3::zeros());
            let mut squared_weights = Mat3::zeros();
            let mut seen_sections: Vec<(Seen, Mat3)> = Vec::with_capacity(sections.len());
            for section in sections {
                let seen = section.seen(unknowns, &state);
                let jacobian = self.jacobian(extension, unknowns, &seen, station);
                let weight = section.weight(noise)?;
                let weighted = jacobian.transpose() * weight;
                let by_ball_weighted = seen.by_ball.transpose() * weight;
                sums.normal += weighted * jacobian;
                sums.gradient -= weighted * seen.residual;
                sums.cost += seen.residual.dot(&(weight * seen.residual));
                information += by_ball_weighted * seen.by_ball;
                by_shift += weighted * seen.by_ball;
                gradient += by_ball_weighted * seen.residual;
                squared_weights += by_ball_weighted * by_ball_weighted.transpose();
                section_due += weight.trace();
                seen_sections.push((seen, weight));
            }
            let damp = (Mat3::identity() + information * station_variance).try_inverse()?;
            let shift_covariance = (damp + damp.transpose()) * (0.5 * station_variance);
            let shift = shift_covariance * gradient;
            sums.normal -= by_shift * shift_covariance * by_shift.transpose();
            sums.gradient += by_shift * shift;
            sums.cost -= gradient.dot(&shift);
            for (seen, weight) in &seen_sections {
                section_found += (weight * (seen.residual - seen.by_ball * shift)).norm_squared();
            }
            section_due -= (shift_covariance * squared_weights).trace();
            station_found += (damp * gradient).norm_squared();
            station_due += (damp * information).trace();
        }
        for idx in NUM_UNKNOWNS + extension.num_extra(self.mount)..MAX_UNKNOWNS {
            sums.normal[(idx, idx)] = 1.0;
        }
        if section_due > 0.0 && station_due > 0.0 {
            sums.noise_ratios = [section_found / section_due, station_found / station_due];
        }
        sums.cost.is_finite().then_some(sums)
    }

    fn rms_mm(&self, extension: Extension, unknowns: &Unknowns) -> f64 {
        stats::rms(self.stations.iter().enumerate().flat_map(|(station, sections)| {
            let state = self.state_at(extension, unknowns, station);
            sections.iter().map(move |section| section.seen(unknowns, &state).residual.norm())
        }))
    }

    /// How far each used station's sections put the ball from where the state has it, in the base, mm: `(station, shift)`.
    pub fn station_shifts(&self, fit: &Fit) -> Vec<(usize, Vec3)> {
        let unknowns = &fit.unknowns;
        self.used_stations()
            .filter_map(|station| {
                // A station blind along y still knows that the ball is not further off than its radius.
                let (mut information, mut pull) = (Mat3::identity() / self.radius_mm.powi(2), Vec3::zeros());
                for section in &self.stations[station] {
                    let seen = section.seen(unknowns, &unknowns.state);
                    let weighted = seen.by_ball.transpose() * section.weight(fit.noise)?;
                    information += weighted * seen.by_ball;
                    pull -= weighted * seen.residual;
                }
                Some((station, information.cholesky()?.solve(&pull)))
            })
            .collect()
    }

    /// The ball's centre in the sensor frame of a station's first section.
    pub fn first_centre(&self, station: usize, state: &State) -> Option<Vec3> {
        self.stations.get(station)?.first().map(|section| state.ball_in_sensor(&section.base_from_flange))
    }
}

fn scaling_of(normal: &Square) -> Column {
    normal.diagonal().map(|d| if d > 0.0 { 1.0 / d.sqrt() } else { 0.0 })
}

/// Solves with the diagonal scaled to one, so that mm and rad compare.
fn solve_scaled(normal: &Square, gradient: &Column, damping: f64) -> Option<Column> {
    let scaling = Square::from_diagonal(&scaling_of(normal));
    let factor = (scaling * normal * scaling + Square::identity() * damping).cholesky()?;
    Some(scaling * factor.solve(&(scaling * gradient)))
}

fn inverse_scaled(normal: &Square) -> Option<Square> {
    let scaling = Square::from_diagonal(&scaling_of(normal));
    Some(scaling * (scaling * normal * scaling).cholesky()?.inverse() * scaling)
}
