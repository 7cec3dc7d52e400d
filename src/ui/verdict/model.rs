//! What the band says is to be done next, made without egui.

use crate::diagnose::{Diagnosis, Remedy, Severity};
use crate::plan::Plan;
use crate::session::Session;
use crate::text;
use crate::text::typeset::std_text;
use crate::ui::widgets;

/// A station that makes the point better known by less than this part is not worth naming.
const WORTH_NAMING: f64 = 0.03;

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
