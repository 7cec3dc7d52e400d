//! The calibration in the syntax of the robot's maker, each text read back and compared.

use crate::calibrate::Verdict;
use crate::diagnose::Severity;
use crate::report::document::{Block, Finding};
use crate::report::evidence::Evidence;
use crate::report::judgement::Judgement;
use crate::report::tool_frame::{Format, Name, RoundTrip, ToolFrame, formats};
use crate::text::report as words;

/// The name and number of the tool, to be changed at the controller.
const TOOL_NAME: &str = "scanner";
const TOOL_NUMBER: u8 = 1;

/// A text for the controller.
#[derive(Clone, Debug, PartialEq)]
pub struct Export {
    /// Its format.
    pub format: Format,
    /// Its file, below the report's folder.
    pub path: String,
    /// The text.
    pub text: String,
    /// What came back when it was read.
    pub round_trip: RoundTrip,
}

/// The answer in every format for the robots whose poses the session holds.
#[must_use]
pub fn exports(evidence: &Evidence) -> Vec<Export> {
    let Some((target, solution)) = evidence.answer() else { return Vec::new() };
    let convention = target.session.robot.notation.convention;
    let frame = ToolFrame::of_solution(solution, Name::from_words(TOOL_NAME), TOOL_NUMBER);
    let suitable = formats().filter(|format| format.is_for_robots_of(convention) && format.suits(frame.parent));
    let export = |format: Format| {
        // What cannot be read back is not handed on.
        let round_trip = format.check(&frame).ok().filter(RoundTrip::is_good)?;
        let path = format!("tool-frames/{}.{}", format.id, format.extension);
        Some(Export { format, path, text: format.write(&frame), round_trip })
    };
    suitable.filter_map(export).collect()
}

pub(in crate::report::document) fn blocks(evidence: &Evidence) -> Vec<Block> {
    let Some((target, solution)) = evidence.answer() else { return Vec::new() };
    let exports = exports(evidence);
    if exports.is_empty() {
        return vec![Block::Paragraph(words::NO_TOOL_FRAME.to_owned())];
    }
    let code = |export: Export| Block::Code {
        caption: words::tool_frame_caption(
            export.format.label,
            export.format.units,
            &export.path,
            export.round_trip.translation_mm,
            export.round_trip.rotation_deg,
        ),
        text: export.text,
    };
    let judgement = Judgement::on(&target.session, solution, target.diagnosis());
    let warning = (judgement.verdict == Verdict::NotUsable).then(|| {
        Block::Findings(vec![Finding {
            severity: Severity::Wrong,
            code: words::NOT_FOR_USE_CODE.to_owned(),
            message: words::not_for_use(&judgement.reason),
            remedy: words::NOT_FOR_USE_REMEDY.to_owned(),
        }])
    });
    std::iter::once(Block::Paragraph(words::tool_frames_intro(solution.mount).to_owned()))
        .chain(warning)
        .chain(exports.into_iter().map(code))
        .collect()
}
