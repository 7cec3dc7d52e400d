//! What a report is made of: sections of blocks, as data. Renderers turn them into HTML, Markdown and CSV; none of them
//! computes anything.

use crate::calibrate;
use crate::diagnose::Severity;
use crate::text::digits;

use crate::report::figure::Figure;

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

    /// Every figure, in order.
    pub fn figures(&self) -> impl Iterator<Item = &Figure> {
        self.blocks().filter_map(|block| match block {
            Block::Figure(figure) => Some(figure),
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
    /// A drawing.
    Figure(Figure),
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
    /// The verdict; `None` where there was nothing to be judged.
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
    /// The names of further columns in the CSV file, for what a cell says in words beside its first figure.
    pub further_csv_names: Vec<String>,
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
    /// The figures of the further columns of the CSV file.
    pub further: Vec<f64>,
    /// Whether it stands out.
    pub is_strong: bool,
}

impl Fact {
    /// A name with its value.
    #[must_use]
    pub fn new(name: impl Into<String>, value: impl Into<String>) -> Self {
        Self { name: name.into(), value: value.into() }
    }
}

impl Column {
    /// A column of words.
    #[must_use]
    pub fn words(title: impl Into<String>, csv_name: impl Into<String>) -> Self {
        Self {
            title: title.into(),
            group: None,
            unit: None,
            csv_name: csv_name.into(),
            further_csv_names: Vec::new(),
            is_number: false,
        }
    }

    /// A column of words that stand for several figures, of which the CSV file has a column each.
    #[must_use]
    pub fn figures(title: impl Into<String>, csv_name: &str, further: &[&str]) -> Self {
        let further_csv_names = further.iter().map(|name| (*name).to_owned()).collect();
        Self { further_csv_names, ..Self::words(title, csv_name) }
    }

    /// A column of figures.
    #[must_use]
    pub fn number(title: impl Into<String>, unit: Option<&'static str>, csv_name: impl Into<String>) -> Self {
        Self { unit, is_number: true, ..Self::words(title, csv_name) }
    }

    /// Three columns x, y, z in mm under one heading; `csv_name` is what stands before the axis.
    #[must_use]
    pub fn vector_mm(group: &str, titles: [&str; 3], csv_name: &str) -> [Self; 3] {
        [0, 1, 2].map(|axis| {
            let csv_name = format!("{csv_name}_{}_mm", ["x", "y", "z"][axis]);
            Self { group: Some(group.to_owned()), ..Self::number(titles[axis], None, csv_name) }
        })
    }

    /// The same column under a heading that it shares with its neighbours.
    #[must_use]
    pub fn under(self, group: &str) -> Self {
        Self { group: Some(group.to_owned()), ..self }
    }
}

impl Cell {
    /// Words.
    #[must_use]
    pub fn words(text: impl Into<String>) -> Self {
        Self { text: text.into(), ..Self::default() }
    }

    /// A figure to so many decimals; a dash where it is not finite.
    #[must_use]
    pub fn number(value: f64, decimals: usize) -> Self {
        if !value.is_finite() {
            return Self::missing();
        }
        Self { text: typeset(&digits::fixed(value, decimals)), value: Some(value), ..Self::default() }
    }

    /// A standard deviation or an error by itself: two digits of it, and no more than a tenth of a micrometre.
    #[must_use]
    pub fn size(value: f64) -> Self {
        Self::number(value, digits::decimals_for(Some(value.abs())).min(4))
    }

    /// Words that stand for several figures.
    #[must_use]
    pub fn figures(text: impl Into<String>, value: f64, further: Vec<f64>) -> Self {
        Self { text: text.into(), value: Some(value), further, is_strong: false }
    }

    /// A difference: with its sign.
    #[must_use]
    pub fn signed(value: f64, decimals: usize) -> Self {
        Self { text: typeset(&digits::signed(value, decimals)), ..Self::number(value, decimals) }
    }

    /// A whole number.
    #[must_use]
    pub fn count(count: usize) -> Self {
        #[expect(clippy::cast_precision_loss, reason = "counts of stations and points")]
        let value = count as f64;
        Self { text: count.to_string(), value: Some(value), ..Self::default() }
    }

    /// Nothing is known.
    #[must_use]
    pub fn missing() -> Self {
        Self::words("–")
    }

    /// A figure where there is one.
    #[must_use]
    pub fn maybe(value: Option<f64>, decimals: usize) -> Self {
        value.map_or_else(Self::missing, |value| Self::number(value, decimals))
    }

    /// The same, standing out.
    #[must_use]
    pub fn strong(self) -> Self {
        Self { is_strong: true, ..self }
    }
}

/// A sentence with true minus signs before its numbers; hyphens stay in words.
#[must_use]
pub fn typeset_numbers(sentence: &str) -> String {
    let begins_with_digit = |rest: &str| rest.starts_with(|c: char| c.is_ascii_digit());
    let words = sentence.split(' ').map(|word| {
        let is_number = word.trim_start_matches(['(', '+', '±']).strip_prefix('-').is_some_and(begins_with_digit);
        if is_number { typeset(word) } else { word.to_owned() }
    });
    words.collect::<Vec<String>>().join(" ")
}

/// With the true minus sign, as wide as the plus.
#[must_use]
pub fn typeset(number: &str) -> String {
    number.replace('-', "−")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn minus_signs_are_true_and_hyphens_stay_hyphens() {
        for (sentence, expected) in [
            ("off by -0.5 mm", "off by −0.5 mm"),
            ("weakest along (-0.2, -0.4, 0.9)", "weakest along (−0.2, −0.4, 0.9)"),
            ("left-out hand-eye 5-10", "left-out hand-eye 5-10"),
            ("2026-11-22 - -x", "2026-11-22 - -x"),
        ] {
            assert_eq!(typeset_numbers(sentence), expected);
        }
    }
}
