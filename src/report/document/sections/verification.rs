//! What the calibration is worth on other data: distances to lines and plane, stability, other targets, scanned parts.

use crate::calibrate::Problem;
use crate::report::document::{Block, Cell, Column, Table};
use crate::report::evidence::Evidence;
use crate::text::digits::decimals_for;
use crate::text::report as words;
use crate::text::verify::{CONTRADICTED_BELOW, calibration_name};
use crate::verify::{Distances, Evaluation, Measurement, Stability, TargetEvidence, Verification};

use super::parts;

/// Micrometres.
const DECIMALS: usize = 3;

pub(in crate::report::document) fn blocks(evidence: &Evidence) -> Vec<Block> {
    let of_others = evidence.verification.iter().flat_map(on_other_data);
    of_others.chain(evidence.parts.iter().enumerate().flat_map(|(idx, part)| parts::blocks(part, idx))).collect()
}

fn on_other_data(verification: &Verification) -> Vec<Block> {
    let mut blocks: Vec<Block> = verification
        .is_borne_out()
        .map(|is_borne_out| Block::Paragraph(words::borne_out(is_borne_out).to_owned()))
        .into_iter()
        .collect();
    let has_other_data = (0..verification.targets.len())
        .any(|target_idx| (0..verification.calibrations.len()).any(|idx| !verification.has_seen(idx, target_idx)));
    if has_other_data {
        blocks.push(Block::Table(cross_table(verification)));
    }
    blocks.extend(joint(verification));
    for (target_idx, target) in verification.targets.iter().enumerate() {
        let first_refused = target.refused().next();
        if let Some(first) = first_refused {
            let reason = first.refusal.to_string();
            let num_refused = target.refused().count();
            blocks.push(Block::Paragraph(words::refused(&target.name, num_refused, target.num_captures(), &reason)));
        }
        let of_target = OfTarget { verification, target_idx, target };
        blocks.extend(of_target.distances().map(Block::Table));
        blocks.extend(of_target.stability().map(Block::Table));
        blocks.extend(of_target.measurements().map(Block::Table));
    }
    blocks
}

/// What all calibrations make of one target.
#[derive(Clone, Copy)]
struct OfTarget<'a> {
    verification: &'a Verification,
    target_idx: usize,
    target: &'a TargetEvidence,
}

impl<'a> OfTarget<'a> {
    fn id(self, name: &str) -> String {
        let suffix = if self.target_idx == 0 { String::new() } else { format!("-target-{}", self.target_idx + 1) };
        format!("{name}{suffix}")
    }

    fn title(self, title: &str) -> String {
        if self.verification.targets.len() > 1 { words::of_target(title, &self.target.name) } else { title.to_owned() }
    }

    /// The calibrations that could be judged, by their place.
    fn evaluations(self) -> impl Iterator<Item = (usize, &'a Evaluation)> {
        self.target.rows.iter().enumerate().filter_map(|(idx, row)| Some((idx, row.as_ref().ok()?)))
    }

    /// The calibration's name, and whether it was computed from these data.
    fn name(self, calibration_idx: usize) -> [Cell; 2] {
        let is_own = self.verification.has_seen(calibration_idx, self.target_idx);
        [Cell::words(name_of(self.verification, calibration_idx)), Cell::words(words::data(is_own))]
    }

    /// The heads of these.
    fn name_columns() -> [Column; 2] {
        [Column::words(words::CALIBRATION_COLUMN, "calibration"), Column::words(words::DATA, "data")]
    }

    fn distances(self) -> Option<Table> {
        let rows: Vec<(usize, &Distances)> =
            self.evaluations().filter_map(|(idx, found)| Some((idx, found.distances()?))).collect();
        if rows.is_empty() {
            return None;
        }
        let figures = |group: &str, csv_name: &str| {
            [(words::MEAN, "mean"), (words::SPREAD, "sd"), (words::MAXIMUM, "max")]
                .map(|(title, figure)| Column::number(title, None, format!("{csv_name}_{figure}_mm")).under(group))
        };
        let row = |(idx, distances): &(usize, &Distances)| {
            let lengths = [&distances.to_line, &distances.to_plane].into_iter().flat_map(|figures| {
                [figures.mean_mm, figures.std_mm, figures.max_mm].map(|value| Cell::number(value, DECIMALS))
            });
            self.name(*idx)
                .into_iter()
                .chain(lengths)
                .chain([Cell::number(distances.angle_rad.to_degrees(), 3), Cell::number(distances.gap_mm, DECIMALS)])
                .collect()
        };
        Some(Table {
            id: self.id("distances"),
            title: self.title(words::DISTANCES),
            columns: Self::name_columns()
                .into_iter()
                .chain(figures(words::TO_LINES, "to_lines"))
                .chain(figures(words::TO_PLANE, "to_plane"))
                .chain([
                    Column::number(words::ANGLE, Some("°"), "angle_deg"),
                    Column::number(words::GAP, Some("mm"), "gap_mm"),
                ])
                .collect(),
            rows: rows.iter().map(row).collect(),
            note: Some(words::DATA_NOTE.to_owned()),
        })
    }

    fn seen(self) -> Vec<(usize, &'a [Measurement], &'a Stability)> {
        let seen = |(idx, found): (usize, &'a Evaluation)| {
            let (measurements, stability) = found.stability()?;
            Some((idx, measurements, stability))
        };
        self.evaluations().filter_map(seen).collect()
    }

    /// How far a point scatters that was measured many times.
    fn stability(self) -> Option<Table> {
        let seen = self.seen();
        let is_touched = seen.first()?.2.is_touched;
        let is_of_tip = matches!(self.target.problem, Problem::Point(_));
        let row = |(idx, _, stability): &(usize, &[Measurement], &Stability)| {
            self.name(*idx)
                .into_iter()
                .chain(
                    is_touched
                        .then(|| {
                            stability.mean_mm.iter().map(|value| Cell::signed(*value, DECIMALS)).collect::<Vec<_>>()
                        })
                        .into_iter()
                        .flatten(),
                )
                .chain(stability.three_std_mm().iter().map(|value| Cell::number(*value, DECIMALS)))
                .chain([Cell::number(stability.three_std_3d_mm(), DECIMALS)])
                .collect()
        };
        let mut columns = Self::name_columns().to_vec();
        if is_touched {
            columns.extend(Column::vector_mm(words::MEAN_DEVIATION, ["Δx", "Δy", "Δz"], "mean_deviation"));
        }
        columns.extend(Column::vector_mm(words::THREE_DELTA, ["x", "y", "z"], "three_delta"));
        columns.push(Column::number(words::THREE_DELTA_3D, None, "three_delta_3d_mm").under(words::THREE_DELTA));
        Some(Table {
            id: self.id("stability"),
            title: self.title(words::stability_title(is_touched)),
            columns,
            rows: seen.iter().map(row).collect(),
            note: Some(format!("{} · {}", words::stability_note(is_of_tip), words::DATA_NOTE)),
        })
    }

    /// Every measurement of a point that was touched, or of another target, through the answer: as in Chen's Table 3.
    fn measurements(self) -> Option<Table> {
        let answer_idx = self.verification.answer_idx().unwrap_or(0);
        let (idx, measurements, stability) = self.seen().into_iter().find(|(idx, ..)| *idx == answer_idx)?;
        if !stability.is_touched && self.verification.has_seen(idx, self.target_idx) {
            return None;
        }
        let row = |(measured, deviation): (&Measurement, &crate::geometry::Vec3)| {
            std::iter::once(Cell::words(measured.name()))
                .chain(deviation.iter().map(|value| Cell::signed(*value, DECIMALS)))
                .collect()
        };
        let name = name_of(self.verification, idx);
        Some(Table {
            id: self.id("measurements"),
            title: words::of_target(&self.title(words::stability_title(stability.is_touched)), &name),
            columns: std::iter::once(Column::words(words::NUMBER, "measurement"))
                .chain(Column::vector_mm(words::DEVIATION, ["Δx", "Δy", "Δz"], "deviation"))
                .collect(),
            rows: measurements.iter().zip(&stability.deviations_mm).map(row).collect(),
            note: None,
        })
    }
}

fn name_of(verification: &Verification, calibration_idx: usize) -> String {
    let calibration = verification.calibrations.get(calibration_idx);
    calibration.map(|found| calibration_name(&found.origin, verification)).unwrap_or_default()
}

fn cross_table(verification: &Verification) -> Table {
    let mut columns = vec![Column::words(words::CALIBRATION_COLUMN, "calibration")];
    for (idx, target) in verification.targets.iter().enumerate() {
        for (title, figure) in [(words::RMS, "rms"), (words::MAXIMUM, "max")] {
            let csv_name = format!("target_{}_{figure}_mm", idx + 1);
            columns.push(Column::number(title, None, csv_name).under(&format!("{} / mm", target.name)));
        }
    }
    let row = |idx: usize| {
        let cells = (0..verification.targets.len()).flat_map(|target_idx| {
            let figures =
                verification.cell(idx, target_idx).and_then(|cell| cell.as_ref().ok()).map(|found| &found.figures);
            // The star's place stays empty where there is none, so that the figures stand under each other.
            let mark = if figures.is_some() && verification.has_seen(idx, target_idx) { "*" } else { "\u{2007}" };
            [figures.map(|figures| figures.rms_mm), figures.map(|figures| figures.max_mm)].map(|figure| {
                let cell = Cell::maybe(figure, DECIMALS);
                Cell { text: format!("{}{mark}", cell.text), ..cell }
            })
        });
        let name = calibration_name(&verification.calibrations[idx].origin, verification);
        std::iter::once(Cell::words(name)).chain(cells).collect()
    };
    Table {
        id: "cross-targets".to_owned(),
        title: words::CROSS_TARGETS.to_owned(),
        columns,
        rows: (0..verification.calibrations.len()).map(row).collect(),
        note: Some(words::CROSS_TARGETS_NOTE.to_owned()),
    }
}

/// The calibration from all targets, and what each of them says of it.
fn joint(verification: &Verification) -> Option<Block> {
    let joint = verification.joint.as_ref()?;
    let solution = match &joint.outcome {
        Ok(solution) => solution,
        Err(error) => return Some(Block::Paragraph(words::no_joint(&error.to_string()))),
    };
    let row = |(target_idx, target): (&usize, &crate::calibrate::JointTarget)| {
        let name = verification.targets.get(*target_idx).map_or("", |target| target.name.as_str());
        let alone = target.alone.uncertainty.as_ref().map(|known| known.workspace_point_std_mm);
        let together = solution.uncertainty.workspace_point_std_mm;
        let chance = Cell::number(target.p_value, 4);
        let contradicts = target.p_value < CONTRADICTED_BELOW;
        vec![
            Cell::words(name),
            Cell::maybe(alone, DECIMALS),
            Cell::number(together, decimals_for(Some(together)).min(4)),
            Cell::number(target.moved_mm, DECIMALS),
            if contradicts { Cell { text: format!("! {}", chance.text), ..chance }.strong() } else { chance },
        ]
    };
    Some(Block::Table(Table {
        id: "joint".to_owned(),
        title: words::JOINT.to_owned(),
        columns: vec![
            Column::words(words::TARGET, "target"),
            Column::number(words::STD_ALONE, Some("mm"), "alone_workspace_point_std_mm"),
            Column::number(words::STD_TOGETHER, Some("mm"), "together_workspace_point_std_mm"),
            Column::number(words::MOVED, Some("mm"), "moved_mm"),
            Column::number(words::BY_CHANCE, None, "p_value"),
        ],
        rows: joint.target_idxs.iter().zip(&solution.targets).map(row).collect(),
        note: Some(words::JOINT_NOTE.to_owned()),
    }))
}
