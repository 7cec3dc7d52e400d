//! What the captures of a search say, whoever decided on them: the curve through them, where either rule stops, and what
//! does not fit. It knows places along the travel, and nothing of the order of the steps or of a direction.

use super::curve::{Curve, Known, MIN_SECTIONS, RADIUS_STD_PART, Section};
use super::end::SearchEnd;
use super::report::{SearchPoint, SearchReport, StepSeen};
use super::settings::{SearchSettings, StopRule};

/// Radii that differ by less than this many standard deviations are the same.
const DIFFER_AT_STDS: f64 = 3.0;
/// A section or a radius that is off by this part of the ball's radius ...
const OFF_PART: f64 = 0.01;
/// ... and by this many standard deviations is no noise.
const OFF_AT_STDS: f64 = 5.0;
/// One section that is off may be dirt in the profile; so many are not.
const MANY_OFF: usize = 2;
/// Sections on either side of the peak, at least, before it counts as passed well enough to stop.
const NUM_BESIDE: usize = 3;
/// A peak that is known no better than this part of the radius is not known.
const WORST_STD_PART: f64 = 0.02;
/// Sections outside these parts of the ball's radius are none of a ball.
const RADIUS_PARTS: [f64; 2] = [0.01, 10.0];

/// The captures so far.
#[derive(Clone, Debug)]
pub(super) struct Trace {
    known: Known,
    points: Vec<SearchPoint>,
    sections: Vec<Section>,
    /// Index of each section's point.
    point_idx: Vec<usize>,
    curve: Option<Curve>,
    published_stop_idx: Option<usize>,
}

impl Trace {
    pub fn new(settings: &SearchSettings, ball_radius_mm: f64) -> Self {
        Self {
            known: Known { ball_radius_mm, travel_std_mm: settings.travel_std_mm },
            points: Vec::new(),
            sections: Vec::new(),
            point_idx: Vec::new(),
            curve: None,
            published_stop_idx: None,
        }
    }

    /// Takes in a capture; the reason why it holds no arc, if it does not.
    pub fn push(&mut self, commanded_mm: f64, seen: StepSeen) -> Option<String> {
        let StepSeen { travelled_mm, radius_and_std_mm } = seen;
        let usable = radius_and_std_mm.and_then(|[radius_mm, std_mm]| {
            let [least, most] = RADIUS_PARTS.map(|part| part * self.known.ball_radius_mm);
            let is_usable = (least..=most).contains(&radius_mm) && (0.0..=most).contains(&std_mm);
            is_usable
                .then_some([radius_mm, std_mm])
                .ok_or_else(|| format!("a section of {radius_mm} mm ± {std_mm} mm is none of this ball"))
        });
        let point_idx = self.points.len();
        let radius_and_std_mm = usable.as_ref().ok().copied();
        self.points.push(SearchPoint { commanded_mm, travelled_mm, radius_and_std_mm });
        if let Some([radius_mm, std_mm]) = radius_and_std_mm
            && travelled_mm.is_finite()
        {
            self.sections.push(Section { travelled_mm, radius_mm, std_mm });
            self.point_idx.push(point_idx);
            self.curve = Curve::fit(&self.sections, &self.known);
            self.published_stop_idx = self.published_stop_idx.or_else(|| self.published_stop());
        }
        usable.err()
    }

    pub fn num_captures(&self) -> usize {
        self.points.len()
    }

    /// Distance of the newest section from the ball's middle by its radius, mm.
    pub fn beside_mm(&self) -> Option<f64> {
        let last = self.sections.last()?;
        Some((self.known.ball_radius_mm.powi(2) - last.radius_mm.powi(2)).max(0.0).sqrt())
    }

    /// Whether the radius grows with the travel; `None` while noise leaves that open.
    pub fn grows(&self) -> Option<bool> {
        let weighed = || {
            self.sections.iter().map(|section| {
                let weight = section.sound_std_mm(self.known.ball_radius_mm).powi(-2);
                (section.travelled_mm, section.radius_mm, weight)
            })
        };
        let total: f64 = weighed().map(|(_, _, weight)| weight).sum();
        let mean = weighed().map(|(travelled, _, weight)| travelled * weight).sum::<f64>() / total;
        let spread: f64 = weighed().map(|(travelled, _, weight)| (travelled - mean).powi(2) * weight).sum();
        let cross: f64 = weighed().map(|(travelled, radius, weight)| (travelled - mean) * radius * weight).sum();
        // The slope is cross / spread, its σ 1 / √spread.
        (cross.abs() > DIFFER_AT_STDS * spread.sqrt()).then_some(cross > 0.0)
    }

    /// How far beyond the peak the sections go in a direction, mm; `None` while that is not certain.
    pub fn beyond_peak_mm(&self, sign: f64) -> Option<f64> {
        let curve = self.curve?;
        let beyond = self
            .sections
            .iter()
            .map(|section| sign * (section.travelled_mm - curve.peak_mm))
            .fold(f64::NEG_INFINITY, f64::max);
        (beyond > 2.0 * curve.peak_std_mm).then_some(beyond)
    }

    /// Whether enough sections lie beyond the peak in a direction, ...
    pub fn is_covered(&self, sign: f64) -> bool {
        self.num_beyond(sign) >= NUM_BESIDE
    }

    /// ... or one more than that, as one at the peak itself may come to lie on either side.
    pub fn is_well_covered(&self, sign: f64) -> bool {
        self.num_beyond(sign) > NUM_BESIDE
    }

    fn num_beyond(&self, sign: f64) -> usize {
        let Some(curve) = self.curve else { return 0 };
        self.sections.iter().filter(|section| sign * (section.travelled_mm - curve.peak_mm) > 0.0).count()
    }

    /// Not before R₂: the first l ≥ R; or the largest, once the radius is smaller on either side of it by more than noise.
    fn published_stop(&self) -> Option<usize> {
        if self.sections.len() < 2 {
            return None;
        }
        if let Some(idx) = self.sections.iter().position(|section| section.radius_mm >= self.known.ball_radius_mm) {
            return Some(self.point_idx[idx]);
        }
        let (largest_idx, largest) =
            self.sections.iter().enumerate().max_by(|(_, a), (_, b)| a.radius_mm.total_cmp(&b.radius_mm))?;
        let std_mm = |section: &Section| section.sound_std_mm(self.known.ball_radius_mm);
        let has_fallen = |sign: f64| {
            self.sections.iter().any(|section| {
                sign * (section.travelled_mm - largest.travelled_mm) > 0.0
                    && largest.radius_mm - section.radius_mm > DIFFER_AT_STDS * std_mm(largest).hypot(std_mm(section))
            })
        };
        (has_fallen(1.0) && has_fallen(-1.0)).then(|| self.point_idx[largest_idx])
    }

    /// Whether the rule is satisfied.
    pub fn found(&self, settings: &SearchSettings) -> Option<SearchEnd> {
        match settings.stop {
            StopRule::Published => self.found_as_published(settings.step_mm),
            StopRule::PeakKnown { peak_std_mm } => {
                let is_passed = self.is_covered(1.0) && self.is_covered(-1.0);
                self.curve.filter(|curve| is_passed && curve.peak_std_mm <= peak_std_mm).map(|curve| found(&curve))
            }
        }
    }

    /// What can be said when no further capture is to be had: the peak, if it has been passed and is roughly known.
    pub fn found_after_all(&self, settings: &SearchSettings) -> Option<SearchEnd> {
        let worst_mm = WORST_STD_PART * self.known.ball_radius_mm;
        match settings.stop {
            StopRule::Published => self.found_as_published(settings.step_mm),
            StopRule::PeakKnown { peak_std_mm } => {
                let is_passed =
                    self.sections.len() > MIN_SECTIONS && self.num_beyond(1.0) > 0 && self.num_beyond(-1.0) > 0;
                self.curve
                    .filter(|curve| is_passed && curve.peak_std_mm <= peak_std_mm.max(worst_mm))
                    .map(|curve| found(&curve))
            }
        }
    }

    fn found_as_published(&self, step_mm: f64) -> Option<SearchEnd> {
        let point = self.points[self.published_stop_idx?];
        let [_, std_mm] = point.radius_and_std_mm?;
        // Flat at the top: l says where the peak is to √(2 R σ); and within a step any place is as likely, d/√12.
        let peak_std_mm = (2.0 * self.known.ball_radius_mm * std_mm).sqrt().hypot(step_mm / 12.0_f64.sqrt());
        Some(SearchEnd::Found { peak_mm: point.travelled_mm, peak_std_mm })
    }

    /// Whether what is measured is no ball of this radius that stands still.
    pub fn misfit(&self) -> Option<SearchEnd> {
        let (curve, newest) = (self.curve?, self.sections.last()?);
        if self.sections.len() <= MIN_SECTIONS {
            return None;
        }
        let radius_mm = self.known.ball_radius_mm;
        let allowed_mm = |std_mm: f64| (OFF_PART * radius_mm).max(OFF_AT_STDS * std_mm);
        let off_mm = |section: &Section| {
            let residual_mm = curve.residual_mm(section, &self.known);
            (residual_mm.abs() > allowed_mm(curve.residual_std_mm(section, &self.known))).then_some(residual_mm)
        };
        let num_off = self.sections.iter().filter(|section| off_mm(section).is_some()).count();
        let off = if num_off >= MANY_OFF {
            let largest = self.sections.iter().filter_map(off_mm).max_by(|a, b| a.abs().total_cmp(&b.abs()))?;
            Some((largest, curve.residual_std_mm(newest, &self.known)))
        } else {
            let is_passed = self.is_covered(1.0) && self.is_covered(-1.0);
            let excess_mm = curve.radius_excess_mm;
            (is_passed && excess_mm.abs() > allowed_mm(curve.radius_excess_std_mm))
                .then_some((excess_mm, RADIUS_STD_PART * radius_mm))
        };
        let (residual_mm, expected_mm) = off?;
        Some(SearchEnd::ResidualGrew { travelled_mm: newest.travelled_mm, residual_mm: residual_mm.abs(), expected_mm })
    }

    /// Brings a report up to date with the captures.
    pub fn tell(&self, report: &mut SearchReport) {
        report.points.extend_from_slice(&self.points[report.points.len()..]);
        report.curve = self.curve.map(|curve| curve.estimate());
        report.published_stop_idx = self.published_stop_idx;
    }
}

fn found(curve: &Curve) -> SearchEnd {
    SearchEnd::Found { peak_mm: curve.peak_mm, peak_std_mm: curve.peak_std_mm }
}
