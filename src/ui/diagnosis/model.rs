//! What the panel draws, taken from the workbench without egui.

use crate::app::{Progress, Study, Workbench};
use crate::calibrate::validation::Bootstrap;
use crate::calibrate::{MethodResult, Solution, best_available};
use crate::diagnose::{Diagnosis, Finding, ReadingFit, Remedy};
use crate::geometry::PoseConvention;
use crate::plan::{Limits, Plan, PlanRefusal, PlannedStation};
use crate::session::Session;
use crate::text::diagnosis_panel as words;
use crate::text::edges::edge_name;
use crate::text::typeset::std_text;
use crate::ui::widgets::fixed;

/// A study as the panel sees it.
#[derive(Debug)]
pub struct Seen<'a, T> {
    /// Its last outcome.
    pub value: Option<&'a T>,
    /// The revision of that.
    pub revision: Option<u64>,
    /// Whether it belongs to the session as it is now.
    pub is_current: bool,
    /// How far it is, while it is under way.
    pub progress: Option<Progress>,
}

impl<T> Default for Seen<'_, T> {
    fn default() -> Self {
        Self { value: None, revision: None, is_current: false, progress: None }
    }
}

impl<'a, T: Send + 'static> Seen<'a, T> {
    fn of(workbench: &Workbench, study: &'a Study<T>) -> Self {
        let last = study.last();
        Self {
            value: last.map(|found| &found.value),
            revision: last.map(|found| found.revision),
            is_current: last.is_some_and(|found| workbench.is_current(found.revision)),
            progress: study.progress(),
        }
    }
}

/// All that the panel draws.
#[derive(Debug)]
pub struct View<'a> {
    /// The document.
    pub session: &'a Session,
    /// What the methods made of it.
    pub results: &'a [MethodResult],
    /// Whether they belong to the session as it is now.
    pub results_are_current: bool,
    /// What was found.
    pub diagnosis: Seen<'a, Diagnosis>,
    /// The ways to read the poses, where they were asked for.
    pub readings: Seen<'a, Vec<ReadingFit>>,
    /// Where to measure next.
    pub plan: Seen<'a, Result<Plan, PlanRefusal>>,
    /// The bootstrap, where it was asked for.
    pub bootstrap: Seen<'a, Bootstrap>,
    /// Within what limits the next stations are planned.
    pub limits: Limits,
}

impl<'a> View<'a> {
    /// Of a workbench with a session; `None` before its first results.
    #[must_use]
    pub fn of(workbench: &'a Workbench) -> Option<Self> {
        Some(Self {
            session: &workbench.document()?.session,
            results: &workbench.results()?.methods,
            results_are_current: workbench.results_are_current(),
            diagnosis: Seen::of(workbench, workbench.diagnosis()),
            readings: Seen::of(workbench, workbench.readings()),
            plan: Seen::of(workbench, workbench.plan()),
            bootstrap: Seen::of(workbench, workbench.bootstrap()),
            limits: *workbench.plan_limits(),
        })
    }

    /// The solution that all figures are about.
    #[must_use]
    pub fn solution(&self) -> Option<&'a Solution> {
        best_available(self.results)
    }

    /// What was found, the most serious first.
    #[must_use]
    pub fn findings(&self) -> &'a [Finding] {
        self.diagnosis.value.map_or(&[], |diagnosis| &diagnosis.findings)
    }

    /// What mends a finding now; nothing while the session has changed since it was found.
    #[must_use]
    pub fn remedy(&self, finding_idx: usize) -> Option<&'a Remedy> {
        self.findings().get(finding_idx).filter(|_| self.diagnosis.is_current)?.remedy.as_ref()
    }

    /// Whether what is found is about another state of the session than the present one.
    #[must_use]
    pub fn is_out_of_date(&self) -> bool {
        self.diagnosis.value.is_some() && !self.diagnosis.is_current
    }
}

/// What the evidence is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shown {
    /// A finding, by its place in the list.
    Finding(usize),
    /// The ways to read the poses.
    Readings,
}

/// The figure behind a finding.
#[must_use]
pub fn figure(finding: &Finding) -> Option<String> {
    finding.evidence.residual_mm.map(|[given, mended]| words::residual_falls(&std_text(given), &std_text(mended)))
}

/// Heads of the table of poses: position, angles in the robot's own convention, tilt, azimuth, spin, σ.
#[must_use]
pub fn plan_heads(convention: &PoseConvention) -> [String; 10] {
    let [a, b, c] = convention.angle_names.map(|name| format!("{name} / °"));
    let [x, y, z] = ["x", "y", "z"].map(|name| format!("{name} / mm"));
    let [tilt, azimuth, spin, std] = [words::TILT, words::AZIMUTH, words::SPIN, words::STD_AFTER].map(str::to_owned);
    [x, y, z, a, b, c, tilt, azimuth, spin, std]
}

/// A row of that table; poses with as many decimals as asked for.
#[must_use]
pub fn plan_row(station: &PlannedStation, convention: &PoseConvention, decimals: usize) -> [String; 10] {
    let position = station.base_from_flange.translation_mm();
    let [x, y, z] = [position.x, position.y, position.z].map(|value| fixed(value, decimals));
    let angles = convention.angles_deg_from_rotation(&station.base_from_flange.rotation());
    let [a, b, c] = angles.map(|value| fixed(value, decimals));
    let [tilt, azimuth, spin] = [station.tilt_deg, station.azimuth_deg, station.spin_deg].map(|value| fixed(value, 0));
    let std = station.workspace_point_std_mm.map_or_else(|| "–".to_owned(), std_text);
    [x, y, z, a, b, c, tilt, azimuth, spin, std]
}

/// The edge of a plate that a station is at, as tables write it; nothing with other targets.
#[must_use]
pub fn edge_symbol(station: &PlannedStation) -> &'static str {
    station.edge.map_or("", edge_name)
}

/// The table as text for a spreadsheet: tab-separated, with its head, with plain minus signs; a plate's with the edges.
#[must_use]
pub fn plan_text(plan: &Plan, convention: &PoseConvention) -> String {
    /// What controllers take.
    const DECIMALS: usize = 3;
    let has_edges = plan.stations.iter().any(|station| station.edge.is_some());
    let line = |edge: &str, cells: [String; 10]| {
        let cells = cells.join("\t").replace('−', "-");
        if has_edges { format!("{edge}\t{cells}") } else { cells }
    };
    let mut lines = vec![line(words::EDGE, plan_heads(convention))];
    let row = |station: &PlannedStation| line(edge_symbol(station), plan_row(station, convention, DECIMALS));
    lines.extend(plan.stations.iter().map(row));
    lines.join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Transform, Vec3};

    #[test]
    fn the_copied_table_has_a_head_and_plain_numbers() {
        let convention = PoseConvention::by_id("kuka-abc").expect("known");
        let rotation = convention.rotation_from_angles_deg([10.0, -20.0, 30.0]);
        let station = PlannedStation {
            base_from_flange: Transform::from_parts(Vec3::new(1.0, -2.5, 300.0), rotation),
            edge: None,
            tilt_deg: 28.0,
            azimuth_deg: -90.0,
            spin_deg: 0.0,
            workspace_point_std_mm: Some(0.012),
        };
        let text = plan_text(&Plan { workspace_point_std_mm: None, stations: vec![station] }, convention);
        let rows: Vec<Vec<&str>> = text.lines().map(|line| line.split('\t').collect()).collect();
        assert_eq!(rows[0][3..6], ["A / °", "B / °", "C / °"]);
        assert_eq!(rows[1], ["1.000", "-2.500", "300.000", "10.000", "-20.000", "30.000", "28", "-90", "0", "0.012"]);
    }
}
