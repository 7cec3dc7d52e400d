//! What the report was made from, what it rests on, and the place to sign.

use crate::report::document::{Block, Cell, Column, Fact, InputFile, Options, Table};
use crate::report::evidence::Evidence;
use crate::text::report as words;

pub(in crate::report::document) fn inputs(inputs: &[InputFile]) -> Vec<Block> {
    let remark = |input: &InputFile| input.remark.map(|remark| format!("{}: {remark}", input.name));
    let remarks: Vec<String> = inputs.iter().filter_map(remark).collect();
    let files = if inputs.is_empty() {
        Block::Paragraph(words::NO_FILE.to_owned())
    } else {
        Block::Table(Table {
            id: "inputs".to_owned(),
            title: words::FILES.to_owned(),
            columns: vec![
                Column::words(words::FILE, "file"),
                Column::number(words::BYTES, None, "bytes"),
                Column::words(words::SHA256, "sha256"),
            ],
            rows: inputs
                .iter()
                .map(|input| vec![Cell::words(&input.name), Cell::count(input.num_bytes), Cell::words(&input.sha256)])
                .collect(),
            note: (!remarks.is_empty()).then(|| remarks.join(" · ")),
        })
    };
    let program = vec![Fact::new(words::PROGRAM, words::program(env!("CARGO_PKG_VERSION")))];
    vec![files, Block::Facts(program)]
}

pub(in crate::report::document) fn references(evidence: &Evidence) -> Vec<Block> {
    let mut references: Vec<&str> = Vec::new();
    let further = evidence.session.further.iter().map(|further| &further.target);
    for reference in std::iter::once(&evidence.session.target).chain(further).flat_map(words::references) {
        if !references.contains(reference) {
            references.push(reference);
        }
    }
    references.into_iter().map(|reference| Block::Paragraph(reference.to_owned())).collect()
}

pub(in crate::report::document) fn signature(options: &Options) -> Vec<Block> {
    let lines = [
        (words::SIGNED_NAME, options.operator.as_str()),
        (words::SIGNED_PLACE, options.place.as_str()),
        (words::SIGNED_DATE, options.date.as_str()),
        (words::SIGNED, ""),
    ];
    vec![Block::Signature(lines.map(|(name, value)| Fact::new(name, value.trim())).to_vec())]
}
