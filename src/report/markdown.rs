//! A report as Markdown: for a wiki, a ticket, or a diff of two reports.

use std::fmt::Write as _;

use crate::text::diagnosis::{severity_mark, severity_name};

use super::document::{Block, Cell, Document, Fact, Finding, Table, Verdict};
use super::files::figure_path;

/// The whole report. Writing to a string does not fail, hence the `ok()`s.
#[must_use]
pub fn markdown(document: &Document) -> String {
    let mut out = format!("# {}\n\n{}\n", escaped(&document.title), escaped(&document.subtitle));
    for section in &document.sections {
        write!(out, "\n## {}\n", escaped(&section.title)).ok();
        for block in &section.blocks {
            out.push('\n');
            write_block(&mut out, block);
        }
    }
    out
}

fn write_block(out: &mut String, block: &Block) {
    match block {
        Block::Heading(title) => writeln!(out, "### {}", escaped(title)).ok(),
        Block::Paragraph(text) => writeln!(out, "{}", escaped(text)).ok(),
        Block::Verdict(verdict) => Some(write_verdict(out, verdict)),
        Block::Facts(facts) => Some(write_facts(out, facts)),
        Block::Table(table) => Some(write_table(out, table)),
        Block::Figure(figure) => writeln!(
            out,
            "**{}**\n\n![{}]({})",
            escaped(&figure.title),
            escaped(&figure.alt),
            figure_path(figure, "svg")
        )
        .ok(),
        Block::Code { caption, text } => Some(write_code(out, caption, text)),
        Block::Findings(findings) => Some(findings.iter().for_each(|finding| write_finding(out, finding))),
        Block::Signature(lines) => Some(write_facts(out, lines)),
    };
}

fn write_verdict(out: &mut String, verdict: &Verdict) {
    write!(out, "**{} {}**", verdict.mark, escaped(&verdict.name)).ok();
    if let Some(headline) = &verdict.headline {
        write!(out, " · **{}**", escaped(headline)).ok();
    }
    out.push('\n');
    if let Some(note) = &verdict.headline_note {
        writeln!(out, "{}", escaped(note)).ok();
    }
    writeln!(out, "\n{}", escaped(&verdict.reason)).ok();
}

fn write_facts(out: &mut String, facts: &[Fact]) {
    for fact in facts {
        let value = if fact.value.is_empty() { "____________" } else { &escaped(&fact.value) };
        writeln!(out, "- {}: {value}", escaped(&fact.name)).ok();
    }
}

fn write_finding(out: &mut String, finding: &Finding) {
    let (mark, name) = (severity_mark(finding.severity), severity_name(finding.severity));
    let text = format!("{} {}", finding.message, finding.remedy);
    writeln!(out, "- {mark} **{name}** ({}): {}", escaped(&finding.code), escaped(text.trim_end())).ok();
}

fn write_code(out: &mut String, caption: &str, text: &str) {
    // A fence longer than any in the text.
    let longest = text.lines().map(|line| line.chars().take_while(|c| *c == '`').count()).max().unwrap_or(0);
    let fence = "`".repeat((longest + 1).max(3));
    let end = if text.ends_with('\n') { "" } else { "\n" };
    writeln!(out, "{}\n\n{fence}text\n{text}{end}{fence}", escaped(caption)).ok();
}

fn write_table(out: &mut String, table: &Table) {
    writeln!(out, "**{}**\n", escaped(&table.title)).ok();
    let titles = table.columns.iter().map(|column| {
        let group = column.group.as_ref().map_or_else(String::new, |group| format!("{group}: "));
        let unit = column.unit.map_or_else(String::new, |unit| format!(" / {unit}"));
        escaped(&format!("{group}{}{unit}", column.title))
    });
    writeln!(out, "| {} |", titles.collect::<Vec<_>>().join(" | ")).ok();
    let rules = table.columns.iter().map(|column| if column.is_number { "---:" } else { "---" });
    writeln!(out, "| {} |", rules.collect::<Vec<_>>().join(" | ")).ok();
    for row in &table.rows {
        writeln!(out, "| {} |", row.iter().map(cell).collect::<Vec<_>>().join(" | ")).ok();
    }
    if let Some(note) = &table.note {
        writeln!(out, "\n{}", escaped(note)).ok();
    }
}

fn cell(cell: &Cell) -> String {
    let text = escaped(cell.text.trim());
    if cell.is_strong { format!("**{text}**") } else { text }
}

/// Text that Markdown and the HTML in it take as it is.
fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '&' => out.push_str("&amp;"),
            // A line of its own would end a table's row or a list's entry.
            c if c.is_whitespace() && c != '\u{2007}' => out.push(' '),
            '\\' | '`' | '*' | '_' | '[' | ']' | '|' | '#' | '~' | '$' => {
                out.push('\\');
                out.push(c);
            }
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_of_any_kind_stays_text() {
        assert_eq!(escaped("<script>&|\n*a_b*"), "&lt;script&gt;&amp;\\| \\*a\\_b\\*");
        let mut out = String::new();
        write_code(&mut out, "c", "a\n```\nb");
        assert_eq!(out, "c\n\n````text\na\n```\nb\n````\n");
    }
}
