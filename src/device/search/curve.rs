//! The fit of the radius over the travel: l² = R² − k² (m − m₀)², with k the cosine between the travel and the laser's
//! normal.
//!
//! Three unknowns: the peak m₀; k, of which it is known that the travel is roughly along the normal; and R, which is the
//! stated one within a ball's tolerance. Without the last, one flank alone would seem to know the peak far too well.

use crate::geometry::{Mat3, Vec3};

use super::report::CurveEstimate;

/// Fewer sections do not bend.
pub(super) const MIN_SECTIONS: usize = 3;
/// The cosine between travel and normal as far as it is known beforehand, and its σ: a few degrees off, at most about 20.
const COSINE: f64 = 0.97;
const COSINE_STD: f64 = 0.03;
/// Nearer to 0 the travel is along the line, and beyond 1 is only what noise makes of it.
const COSINES: [f64; 2] = [0.1, 1.05];
/// σ of the ball's radius, as a part of it: several times the tolerance of a cheap ball.
pub(super) const RADIUS_STD_PART: f64 = 0.002;
/// Points of a real profile err together, so a section's σ is never below this part of the radius.
const LEAST_STD_PART: f64 = 2e-4;
/// Sections off by this part of the radius weigh half of what they would.
const SOFT_PART: f64 = 0.01;
const NUM_ITERATIONS: usize = 30;

/// A section with its place on the travel.
#[derive(Clone, Copy, Debug)]
#[expect(clippy::struct_field_names, reason = "all of them are lengths")]
pub(super) struct Section {
    pub travelled_mm: f64,
    pub radius_mm: f64,
    pub std_mm: f64,
}

impl Section {
    /// σ of the radius, with what neighbouring points have in common.
    pub fn sound_std_mm(&self, ball_radius_mm: f64) -> f64 {
        self.std_mm.hypot(LEAST_STD_PART * ball_radius_mm)
    }
}

/// What is known beforehand.
#[derive(Clone, Copy, Debug)]
pub(super) struct Known {
    pub ball_radius_mm: f64,
    pub travel_std_mm: f64,
}

/// The curve through the sections.
#[derive(Clone, Copy, Debug)]
pub(super) struct Curve {
    pub peak_mm: f64,
    pub peak_std_mm: f64,
    pub cosine: f64,
    /// The ball's radius by the curve less the stated one, mm, and its σ.
    pub radius_excess_mm: f64,
    pub radius_excess_std_mm: f64,
}

impl Curve {
    /// Fits it; `None` with fewer than [`MIN_SECTIONS`], or if they have no extent.
    pub fn fit(sections: &[Section], known: &Known) -> Option<Self> {
        if sections.len() < MIN_SECTIONS {
            return None;
        }
        let mut curve = Self::start(sections)?;
        let radius_std_mm = RADIUS_STD_PART * known.ball_radius_mm;
        let mut covariance = Mat3::zeros();
        let mut chi_squared = 0.0;
        for _ in 0..NUM_ITERATIONS {
            let priors = Vec3::new(0.0, COSINE_STD.powi(-2), radius_std_mm.powi(-2));
            let off = Vec3::new(0.0, curve.cosine - COSINE, curve.radius_excess_mm);
            let mut information = Mat3::from_diagonal(&priors);
            let mut gradient = -priors.component_mul(&off);
            chi_squared = off.component_mul(&off).dot(&priors);
            for section in sections {
                let residual = curve.residual_mm(section, known);
                let derivative = curve.derivative(section, known);
                let weight = curve.weight(section, residual, known);
                information += derivative * derivative.transpose() * weight;
                gradient -= derivative * (residual * weight);
                chi_squared += residual * residual * weight;
            }
            let factor = information.cholesky()?;
            let change = factor.solve(&gradient);
            covariance = factor.inverse();
            // Nearly a parabola, but not quite: no step beyond what the ball is large.
            curve.peak_mm += change[0].clamp(-0.5 * known.ball_radius_mm, 0.5 * known.ball_radius_mm);
            curve.cosine = (curve.cosine + change[1]).clamp(COSINES[0], COSINES[1]);
            curve.radius_excess_mm += change[2];
            if change.amax() < 1e-9 * known.ball_radius_mm {
                break;
            }
        }
        // Three unknowns, of which two are held by a prior each.
        #[expect(clippy::cast_precision_loss, reason = "few sections")]
        let freedom = (sections.len() - 1) as f64;
        let scale = (chi_squared / freedom).max(1.0);
        curve.peak_std_mm = (covariance[(0, 0)] * scale).sqrt();
        curve.radius_excess_std_mm = (covariance[(2, 2)] * scale).sqrt();
        let figures = [curve.peak_mm, curve.peak_std_mm, curve.radius_excess_mm, curve.radius_excess_std_mm];
        figures.iter().all(|figure| figure.is_finite()).then_some(curve)
    }

    /// From the slope of l² over the travel, which is 2 k² (m₀ − m) in the middle of the sections.
    fn start(sections: &[Section]) -> Option<Self> {
        #[expect(clippy::cast_precision_loss, reason = "few sections")]
        let scale = 1.0 / sections.len() as f64;
        let mean = sections.iter().map(|section| section.travelled_mm).sum::<f64>() * scale;
        let (mut cross, mut spread) = (0.0, 0.0);
        for section in sections {
            let off = section.travelled_mm - mean;
            cross += off * section.radius_mm * section.radius_mm;
            spread += off * off;
        }
        (spread > 0.0).then(|| Self {
            peak_mm: mean + 0.5 * cross / (spread * COSINE * COSINE),
            peak_std_mm: f64::INFINITY,
            cosine: COSINE,
            radius_excess_mm: 0.0,
            radius_excess_std_mm: f64::INFINITY,
        })
    }

    /// The radius that a section has more than the curve: l minus it to first order, but finite beyond the ball as well.
    pub fn residual_mm(&self, section: &Section, known: &Known) -> f64 {
        let radius = known.ball_radius_mm + self.radius_excess_mm;
        let beside = self.cosine * (section.travelled_mm - self.peak_mm);
        (section.radius_mm.powi(2) - radius * radius + beside * beside) / (2.0 * section.radius_mm)
    }

    /// By the peak, the cosine, the radius.
    fn derivative(&self, section: &Section, known: &Known) -> Vec3 {
        let radius = known.ball_radius_mm + self.radius_excess_mm;
        let off = section.travelled_mm - self.peak_mm;
        Vec3::new(-self.cosine * self.cosine * off, self.cosine * off * off, -radius) / section.radius_mm
    }

    /// σ of a residual by the points of the profile and by the pose.
    pub fn residual_std_mm(&self, section: &Section, known: &Known) -> f64 {
        let by_travel = self.derivative(section, known)[0];
        section.sound_std_mm(known.ball_radius_mm).hypot(by_travel * known.travel_std_mm)
    }

    /// Cauchy's weight: a section that is off by far more than noise hardly counts.
    fn weight(&self, section: &Section, residual_mm: f64, known: &Known) -> f64 {
        let soft = residual_mm / (SOFT_PART * known.ball_radius_mm);
        self.residual_std_mm(section, known).powi(-2) / (1.0 + soft * soft)
    }

    pub fn estimate(&self) -> CurveEstimate {
        CurveEstimate { peak_mm: self.peak_mm, peak_std_mm: self.peak_std_mm, curvature: self.cosine * self.cosine }
    }
}
