//! A report as data: what it says, in which order, in sections that can be switched off.

mod model;
mod section;
mod sections;

use crate::session::format::Stamp;
use crate::text::report as words;

use super::checksum;
use super::evidence::Evidence;
use super::figure::figures_of;

pub use model::{Block, Cell, Column, Document, Fact, Finding, Section, Table, Verdict, typeset, typeset_numbers};
pub use section::{Options, SectionId};
pub use sections::tool_frames::{Export, exports};

/// A file that a report was made from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InputFile {
    /// Its name, without its folder, which is another on every machine.
    pub name: String,
    /// Its size.
    pub num_bytes: usize,
    /// Its SHA-256, as `sha256sum` prints it.
    pub sha256: String,
    /// What a reader who looks for the file has to know: that it is another by now, or none.
    pub remark: Option<&'static str>,
}

impl InputFile {
    /// Of a file's bytes.
    #[must_use]
    pub fn new(name: String, bytes: &[u8]) -> Self {
        Self { name, num_bytes: bytes.len(), sha256: checksum::sha256(bytes), remark: None }
    }

    /// Of the file that a stamp is of, as it was then.
    #[must_use]
    pub fn stamped(name: String, stamp: &Stamp) -> Self {
        Self { name, num_bytes: stamp.num_bytes(), sha256: checksum::hexadecimal(&stamp.sha256()), remark: None }
    }

    /// The same with a remark.
    #[must_use]
    pub fn with_remark(self, remark: Option<&'static str>) -> Self {
        Self { remark, ..self }
    }
}

/// Writes a report on what was computed of a session that is in these files.
#[must_use]
pub fn document(evidence: &Evidence, inputs: &[InputFile], options: &Options) -> Document {
    let session = &evidence.session;
    let name = session.name.trim();
    let blocks = |id: SectionId| match id {
        SectionId::Verdict => sections::verdict::blocks(evidence),
        SectionId::Calibration => sections::calibration::blocks(evidence),
        SectionId::Setup => {
            let sequences = evidence.targets.iter().flat_map(sections::sequence::blocks);
            sections::setup::blocks(evidence, options).into_iter().chain(sequences).collect()
        }
        SectionId::Methods => sections::methods::blocks(evidence),
        SectionId::Figures => figures_of(evidence).into_iter().map(Block::Figure).collect(),
        SectionId::Diagnosis => sections::diagnosis::blocks(evidence),
        SectionId::Validation => sections::validation::blocks(evidence),
        SectionId::Verification => sections::verification::blocks(evidence),
        SectionId::Stations => sections::stations::blocks(evidence),
        SectionId::ToolFrames => sections::tool_frames::blocks(evidence),
        SectionId::Inputs => sections::closing::inputs(inputs),
        SectionId::References => sections::closing::references(evidence),
        SectionId::Signature => sections::closing::signature(options),
    };
    let sections = SectionId::ALL.into_iter().filter(|id| options.sections.contains(id));
    let sections = sections
        .map(|id| Section { id, title: id.title().to_owned(), blocks: blocks(id) })
        .filter(|section| !section.blocks.is_empty());
    Document {
        title: if name.is_empty() { words::UNNAMED.to_owned() } else { name.to_owned() },
        subtitle: words::SUBTITLE.to_owned(),
        sections: sections.collect(),
    }
}
