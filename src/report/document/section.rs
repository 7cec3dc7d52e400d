//! The sections of a report, and which of them are asked for.

use std::collections::BTreeSet;

use crate::text::report as words;

/// A section; the order here is that in the report.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum SectionId {
    /// Good, usable, or not usable, and why.
    Verdict,
    /// Where the sensor is, in every notation.
    Calibration,
    /// Robot, sensor, target, noise.
    Setup,
    /// The methods side by side, and the paper's tables.
    Methods,
    /// The figures.
    Figures,
    /// What is wrong, and what to do about it.
    Diagnosis,
    /// Left-out errors, halves, the truth where it is known.
    Validation,
    /// What the calibration is worth on other data.
    Verification,
    /// Every station.
    Stations,
    /// Files, checksums, the program's version.
    Inputs,
    /// For the controller.
    ToolFrames,
    /// Where the methods are described.
    References,
    /// The place to sign.
    Signature,
}

impl SectionId {
    /// All of them, in order.
    pub const ALL: [Self; 13] = [
        Self::Verdict,
        Self::Calibration,
        Self::Setup,
        Self::Methods,
        Self::Figures,
        Self::Diagnosis,
        Self::Validation,
        Self::Verification,
        Self::Stations,
        Self::Inputs,
        Self::ToolFrames,
        Self::References,
        Self::Signature,
    ];

    /// Its name on the command line, and its anchor in the HTML file.
    #[must_use]
    pub const fn id(self) -> &'static str {
        match self {
            Self::Verdict => "verdict",
            Self::Calibration => "calibration",
            Self::Setup => "setup",
            Self::Methods => "methods",
            Self::Figures => "figures",
            Self::Diagnosis => "diagnosis",
            Self::Validation => "validation",
            Self::Verification => "verification",
            Self::Stations => "stations",
            Self::ToolFrames => "tool-frames",
            Self::Inputs => "inputs",
            Self::References => "references",
            Self::Signature => "signature",
        }
    }

    /// The section of this name.
    #[must_use]
    pub fn by_id(id: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|section| section.id() == id)
    }

    /// Its heading.
    #[must_use]
    pub const fn title(self) -> &'static str {
        match self {
            Self::Verdict => words::VERDICT,
            Self::Calibration => words::CALIBRATION,
            Self::Setup => words::SETUP,
            Self::Methods => words::METHODS,
            Self::Figures => words::FIGURES,
            Self::Diagnosis => words::DIAGNOSIS,
            Self::Validation => words::VALIDATION,
            Self::Verification => words::VERIFICATION,
            Self::Stations => words::STATIONS,
            Self::ToolFrames => words::TOOL_FRAMES,
            Self::Inputs => words::INPUTS,
            Self::References => words::REFERENCES,
            Self::Signature => words::SIGNATURE,
        }
    }
}

/// What a report is to hold beside what was computed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Options {
    /// The sections asked for.
    pub sections: BTreeSet<SectionId>,
    /// Who answers for it.
    pub operator: String,
    /// Where it was made.
    pub place: String,
    /// When, in the operator's words: a report holds no clock, so that the same session gives the same bytes.
    pub date: String,
    /// What the operator adds.
    pub notes: String,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            sections: SectionId::ALL.into_iter().collect(),
            operator: String::new(),
            place: String::new(),
            date: String::new(),
            notes: String::new(),
        }
    }
}
