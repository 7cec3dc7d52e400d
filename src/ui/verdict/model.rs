//! What the band says, made without egui.

use crate::calibrate::{Method, MethodResult, Solution, Verdict, best_available};
use crate::diagnose::{Diagnosis, Reason, Remedy, Severity, verdict_with};
use crate::plan::Plan;
use crate::session::Session;
use crate::text;
use crate::text::typeset::std_text;
use crate::ui::widgets;

/// A station that makes the point better known by less than this part is not worth naming.
const WORTH_NAMING: f64 = 0.03;

/// The point that the headline is about.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorkspacePoint {
    /// Where it is along the range axis, mm.
    pub z_mm: f64,
    /// Whether the session states that distance; otherwise the point is amid what was seen.
    pub is_stated: bool,
    /// Its standard deviation, mm.
    pub std_mm: f64,
}

/// What to do next.
#[derive(Clone, Debug, PartialEq)]
pub enum NextStep {
    /// Mend what was found first.
    Mend {
        /// What was found.
        title: &'static str,
        /// The remedy.
        remedy: Remedy,
        /// Its button.
        label: String,
    },
    /// Look at what was found first; it has no remedy of one click.
    Look {
        /// What was found.
        title: &'static str,
    },
    /// Measure one more station.
    Measure {
        /// What it would bring.
        gain: String,
    },
}

impl NextStep {
    /// The first finding's remedy, else the first planned station that is worth it.
    #[must_use]
    pub fn new(session: &Session, diagnosis: Option<&Diagnosis>, plan: Option<&Plan>) -> Option<Self> {
        let first = diagnosis.and_then(|diagnosis| diagnosis.findings.first());
        if let Some(finding) = first.filter(|finding| finding.severity != Severity::Note) {
            let title = text::diagnosis::fault_title(&finding.fault);
            return Some(match &finding.remedy {
                Some(remedy) => {
                    Self::Mend { title, label: text::diagnosis::remedy_label(remedy, session), remedy: remedy.clone() }
                }
                None => Self::Look { title },
            });
        }
        let plan = plan?;
        let station = plan.stations.first()?;
        let (before_mm, after_mm) = plan.workspace_point_std_mm.zip(station.workspace_point_std_mm)?;
        (after_mm < before_mm * (1.0 - WORTH_NAMING)).then(|| Self::Measure {
            gain: text::diagnosis_panel::gain(
                station.edge,
                &widgets::fixed(station.tilt_deg, 0),
                &std_text(before_mm),
                &std_text(after_mm),
            ),
        })
    }
}

/// The verdict's band.
#[derive(Clone, Debug, PartialEq)]
pub struct Band {
    /// The method that is judged.
    pub method: Method,
    /// The verdict.
    pub verdict: Verdict,
    /// Its reason in a sentence.
    pub reason: String,
    /// How well a point is known.
    pub workspace_point: Option<WorkspacePoint>,
    /// Sentence and remedy of each warning.
    pub warnings: Vec<(String, &'static str)>,
}

impl Band {
    /// On the best available solution; `None` without one.
    #[must_use]
    pub fn new(session: &Session, results: &[MethodResult], diagnosis: Option<&Diagnosis>) -> Option<Self> {
        best_available(results).map(|solution| Self::on(session, solution, diagnosis))
    }

    fn on(session: &Session, solution: &Solution, diagnosis: Option<&Diagnosis>) -> Self {
        let (verdict, reason) = verdict_with(solution, diagnosis);
        Self {
            method: solution.method,
            verdict,
            reason: match reason {
                Reason::Solution(reason) => text::compare::verdict_reason(solution, reason),
                Reason::Finding(finding) => text::diagnosis::fault_message(&finding.fault, session),
            },
            workspace_point: solution.uncertainty.as_ref().map(|uncertainty| WorkspacePoint {
                z_mm: uncertainty.reference_point_in_sensor_mm.z,
                is_stated: session.sensor.reference_distance_mm.is_some(),
                std_mm: uncertainty.workspace_point_std_mm,
            }),
            warnings: solution
                .warnings
                .iter()
                .map(|warning| (text::warnings::warning_message(warning), text::warnings::warning_remedy(warning)))
                .collect(),
        }
    }
}
