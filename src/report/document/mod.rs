//! A report as data: what it says, in which order, in sections that can be switched off.

mod model;
mod section;

pub use model::{Block, Cell, Column, Document, Fact, Finding, Section, Table, Verdict};
pub use section::{Options, SectionId};
