//! How to search, what makes no search, and where a step leads.

use nalgebra::{Translation3, Unit};
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::geometry::{Rigid, Vec3};

/// Fewer captures than this cannot show both flanks of a curve.
pub const MIN_CAPTURES: u16 = 5;

/// The frame in which a direction is given.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum DirectionFrame {
    /// The flange (or the tool that is active in the controller) at the first profile.
    #[default]
    Tool,
    /// The robot's base.
    Base,
}

/// When a search has found what it looked for.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum StopRule {
    /// As published: the first section whose radius is that of the ball; with noise, once the radius has fallen again.
    Published,
    /// Ours: the fitted curve has passed its peak, and says where it is to within this σ, mm.
    PeakKnown {
        /// The wanted σ of the peak along the travel, mm.
        peak_std_mm: f64,
    },
}

/// How to search.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct SearchSettings {
    /// The frame of [`Self::direction`].
    pub frame: DirectionFrame,
    /// Along what to step; any length but 0.
    pub direction: [f64; 3],
    /// A step, mm.
    pub step_mm: f64,
    /// Steps while far from the peak, mm; as [`Self::step_mm`] if not greater.
    pub coarse_step_mm: f64,
    /// How far from the first profile the robot may go, either way, mm.
    pub max_travel_mm: f64,
    /// Most captures of one search.
    pub max_captures: u16,
    /// Noise of the reported poses along the travel, mm: that of a good arm unless it is known better.
    pub travel_std_mm: f64,
    /// When it is over.
    pub stop: StopRule,
}

impl Default for SearchSettings {
    fn default() -> Self {
        Self {
            frame: DirectionFrame::Tool,
            direction: [0.0, 1.0, 0.0],
            step_mm: 0.75,
            coarse_step_mm: 1.5,
            max_travel_mm: 25.0,
            max_captures: 60,
            travel_std_mm: 0.02,
            stop: StopRule::PeakKnown { peak_std_mm: 0.02 },
        }
    }
}

/// Why settings make no search.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum SettingsRefusal {
    /// Nowhere to go.
    #[error("the search's direction has no length; give it one, as 0, 1, 0")]
    NoDirection,
    /// A length that has to be above zero.
    #[error("found {found_mm} mm for {what}, needed a length above 0 mm")]
    NotPositive {
        /// What it is for.
        what: &'static str,
        /// What it is, mm.
        found_mm: f64,
    },
    /// Not even one step.
    #[error("found a travel of {max_travel_mm} mm, needed at least one step of {step_mm} mm; allow more, or step less")]
    TravelBelowStep {
        /// How far it may go, mm.
        max_travel_mm: f64,
        /// The step, mm.
        step_mm: f64,
    },
    /// Too few captures for a curve.
    #[error("found a limit of {found} captures, needed at least {needed}; allow more")]
    TooFewCaptures {
        /// The limit.
        found: u16,
        /// The least that will do.
        needed: u16,
    },
}

impl SearchSettings {
    /// Whether a search can be made of them.
    ///
    /// # Errors
    /// [`SettingsRefusal`], the first reason found.
    pub fn check(&self) -> Result<(), SettingsRefusal> {
        self.unit_direction().ok_or(SettingsRefusal::NoDirection)?;
        let positive = |what: &'static str, found_mm: f64| {
            let is_length = found_mm.is_finite() && found_mm > 0.0;
            if is_length { Ok(()) } else { Err(SettingsRefusal::NotPositive { what, found_mm }) }
        };
        positive("the step", self.step_mm)?;
        positive("the coarse step", self.coarse_step_mm)?;
        positive("the longest travel", self.max_travel_mm)?;
        positive("the noise of the travel", self.travel_std_mm)?;
        if let StopRule::PeakKnown { peak_std_mm } = self.stop {
            positive("the wanted σ of the peak", peak_std_mm)?;
        }
        if self.max_travel_mm < self.step_mm {
            return Err(SettingsRefusal::TravelBelowStep { max_travel_mm: self.max_travel_mm, step_mm: self.step_mm });
        }
        if self.max_captures < MIN_CAPTURES {
            return Err(SettingsRefusal::TooFewCaptures { found: self.max_captures, needed: MIN_CAPTURES });
        }
        Ok(())
    }

    /// Where to go for a distance along the direction from the first profile, `first` being the pose there:
    /// `base_from_flange`. The orientation stays; without a direction the position does too.
    #[must_use]
    pub fn pose_at(&self, first: &Rigid, commanded_mm: f64) -> Rigid {
        let Some(direction) = self.direction_in_base(first) else { return *first };
        Translation3::from(direction.into_inner() * commanded_mm) * first
    }

    /// How far along the direction a reported pose is from the first one, mm; both `base_from_flange`.
    #[must_use]
    pub fn travelled_mm(&self, first: &Rigid, reported: &Rigid) -> f64 {
        self.direction_in_base(first)
            .map_or(0.0, |direction| direction.dot(&(reported.translation.vector - first.translation.vector)))
    }

    /// Where the travel goes from a pose `base_from_flange`, in the base; `None` without a direction.
    #[must_use]
    pub fn direction_in_base(&self, first: &Rigid) -> Option<Unit<Vec3>> {
        let direction = self.unit_direction()?;
        Some(match self.frame {
            DirectionFrame::Tool => first.rotation * direction,
            DirectionFrame::Base => direction,
        })
    }

    fn unit_direction(&self) -> Option<Unit<Vec3>> {
        let direction = Vec3::from(self.direction);
        // Scaled first, so that no length is lost to the square of a small or large number.
        let largest = direction.amax();
        (largest.is_finite() && largest > 0.0 && direction.iter().all(|v| v.is_finite()))
            .then(|| Unit::new_normalize(direction / largest))
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use crate::geometry::so3;

    fn down() -> Rigid {
        Rigid::from_parts(Translation3::new(450.0, -20.0, 300.0), so3::exp(Vec3::x() * PI))
    }

    #[test]
    fn a_step_goes_along_the_tool_or_the_base_and_is_read_back() {
        // A tool that points down: its Y is the base's −Y.
        for (frame, y_mm) in [(DirectionFrame::Tool, -22.0), (DirectionFrame::Base, -18.0)] {
            let settings = SearchSettings { frame, direction: [0.0, 3.0, 0.0], ..SearchSettings::default() };
            let pose = settings.pose_at(&down(), 2.0);
            assert!((pose.translation.vector - Vec3::new(450.0, y_mm, 300.0)).norm() < 1e-12, "{pose}");
            assert_eq!(pose.rotation, down().rotation);
            assert!((settings.travelled_mm(&down(), &pose) - 2.0).abs() < 1e-12);
        }
    }

    #[test]
    fn what_lies_across_the_direction_is_no_travel() {
        let settings = SearchSettings::default();
        let mut aside = settings.pose_at(&down(), -1.5);
        aside.translation.vector += Vec3::new(0.3, 0.0, -0.7);
        assert!((settings.travelled_mm(&down(), &aside) + 1.5).abs() < 1e-12);
    }

    #[test]
    fn settings_that_make_no_search_are_refused_by_name() {
        #[track_caller]
        fn check(change: impl Fn(&mut SearchSettings), needed: &str) {
            let mut settings = SearchSettings::default();
            change(&mut settings);
            let refusal = settings.check().expect_err("refused").to_string();
            assert!(refusal.contains(needed), "{refusal}");
        }
        assert_eq!(SearchSettings::default().check(), Ok(()));
        check(|settings| settings.direction = [0.0; 3], "direction");
        check(|settings| settings.direction = [0.0, f64::NAN, 1.0], "direction");
        check(|settings| settings.direction = [f64::INFINITY, 0.0, 0.0], "direction");
        check(|settings| settings.step_mm = 0.0, "the step");
        check(|settings| settings.step_mm = f64::NAN, "the step");
        check(|settings| settings.coarse_step_mm = -1.0, "the coarse step");
        check(|settings| settings.max_travel_mm = f64::INFINITY, "the longest travel");
        check(|settings| settings.max_travel_mm = 0.5, "at least one step");
        check(|settings| settings.max_captures = 4, "at least 5");
        check(|settings| settings.travel_std_mm = 0.0, "the noise of the travel");
        check(|settings| settings.stop = StopRule::PeakKnown { peak_std_mm: 0.0 }, "σ of the peak");
    }

    #[test]
    fn a_tiny_and_a_huge_direction_are_directions() {
        for length in [1e-200, 1e200] {
            let settings = SearchSettings { direction: [0.0, 0.0, length], ..SearchSettings::default() };
            assert_eq!(settings.check(), Ok(()));
            assert!((settings.pose_at(&Rigid::identity(), 2.0).translation.z - 2.0).abs() < 1e-12);
        }
    }
}
