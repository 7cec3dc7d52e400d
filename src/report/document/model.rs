//! What a report is made of: sections of blocks, as data. Renderers turn them into HTML, Markdown and CSV; none of them
//! computes anything.

use crate::calibrate;
use crate::diagnose::Severity;

use super::SectionId;

/// A report.
#[derive(Clone, Debug, PartialEq)]
pub struct Document {
    /// What it is about.
    pub title: String,
    /// The line below.
    pub subtitle: String,
    /// The sections that were asked for and have something to say, in order.
    pub sections: Vec<Section>,
}

impl Document {
    /// Every table, in order.
    pub fn tables(&self) -> impl Iterator<Item = &Table> {
        self.blocks().filter_map(|block| match block {
            Block::Table(table) => Some(table),
            _ => None,
        })
    }

    /// Every block of every section.
    pub fn blocks(&self) -> impl Iterator<Item = &Block> {
        self.sections.iter().flat_map(|section| &section.blocks)
    }
}

/// A part of a report that can be switched off.
#[derive(Clone, Debug, PartialEq)]
pub struct Section {
    /// Which one.
    pub id: SectionId,
    /// Its heading.
    pub title: String,
    /// What it says.
    pub blocks: Vec<Block>,
}

/// A piece of a section.
#[derive(Clone, Debug, PartialEq)]
pub enum Block {
    /// A heading below the section's.
    Heading(String),
    /// Running text.
    Paragraph(String),
    /// The verdict with its headline figure.
    Verdict(Verdict),
    /// Names with their values.
    Facts(Vec<Fact>),
    /// Figures in rows and columns.
    Table(Table),
    /// Text to be copied as it stands.
    Code {
        /// What it is.
        caption: String,
        /// The text.
        text: String,
    },
    /// What is wrong, with its remedies.
    Findings(Vec<Finding>),
    /// Lines to sign on.
    Signature(Vec<Fact>),
}

/// Good, usable or not usable, and why.
#[derive(Clone, Debug, PartialEq)]
pub struct Verdict {
    /// The verdict; `None` where nothing could be computed.
    pub rating: Option<calibrate::Verdict>,
    /// It in words.
    pub name: String,
    /// Its shape, so that colour is never alone.
    pub mark: &'static str,
    /// Why.
    pub reason: String,
    /// The headline figure with its unit.
    pub headline: Option<String>,
    /// What the headline is about.
    pub headline_note: Option<String>,
}

/// A name with its value.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Fact {
    /// The name.
    pub name: String,
    /// The value with its unit; empty where it is to be filled in by hand.
    pub value: String,
}

/// Something that is wrong, or worth knowing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// How serious it is.
    pub severity: Severity,
    /// Its code, as in result files.
    pub code: String,
    /// What was found.
    pub message: String,
    /// What to do about it.
    pub remedy: String,
}

/// Figures in rows and columns.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// The name of its CSV file, without the ending; unique in the report.
    pub id: String,
    /// What it shows.
    pub title: String,
    /// The columns.
    pub columns: Vec<Column>,
    /// The rows, each with one cell a column.
    pub rows: Vec<Vec<Cell>>,
    /// What a reader has to know below it.
    pub note: Option<String>,
}

/// A column of a table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Column {
    /// Its heading.
    pub title: String,
    /// The heading that it shares with its neighbours of the same group.
    pub group: Option<String>,
    /// The unit of its figures.
    pub unit: Option<&'static str>,
    /// The name of the column in the CSV file, with its unit.
    pub csv_name: String,
    /// Whether it holds figures, which stand aligned on the right.
    pub is_number: bool,
}

/// A cell of a table.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cell {
    /// With as many digits as are true.
    pub text: String,
    /// With all digits, for the CSV file; text alone is written as it stands.
    pub value: Option<f64>,
    /// Whether it stands out.
    pub is_strong: bool,
}
