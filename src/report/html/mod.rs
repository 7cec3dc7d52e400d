//! A report as one HTML file that needs no other: it is read on a screen, and prints on A4.

use std::fmt::Write as _;

use crate::calibrate;
use crate::diagnose::Severity;
use crate::text::diagnosis::{severity_mark, severity_name};
use crate::text::report as words;

use super::document::{Block, Cell, Column, Document, Fact, Finding, Table, Verdict};
use super::figure::{Figure, FigureError};

/// The style sheet, within the file.
const STYLE: &str = include_str!("report.css");
/// Tables with so many columns are set smaller, and those with still more as small as print is read.
const COMPACT_FROM: usize = 8;
const DENSE_FROM: usize = 11;
/// Tables with fewer rows stay on one page.
const KEPT_TOGETHER_BELOW: usize = 16;
/// So do texts with fewer lines.
const CODE_KEPT_TOGETHER_BELOW: usize = 40;
/// Small tables with so few columns stand beside each other.
const BESIDE_UP_TO: usize = 4;
/// So short a label stays on one line, however narrow its column.
const SHORT_LABEL: usize = 12;

/// The whole report. Writing to a string does not fail, hence the `ok()`s.
///
/// # Errors
/// [`FigureError`] if a figure cannot be drawn.
pub fn html(document: &Document) -> Result<String, FigureError> {
    let title = escaped(&document.title);
    let mut out = format!(
        "<!DOCTYPE html>\n<html lang=\"{}\">\n<head>\n<meta charset=\"utf-8\"/>\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n<title>{title} – {}</title>\n\
         <style>\n{STYLE}@page {{ @bottom-left {{ content: \"{}\"; }} }}\n</style>\n</head>\n<body>\n\
         <header>\n<p class=\"kind\">{}</p>\n<h1>{title}</h1>\n</header>\n",
        words::LANGUAGE,
        escaped(&document.subtitle),
        in_css(&document.title),
        escaped(&document.subtitle),
    );
    contents(&mut out, document);
    out.push_str("<main>\n");
    for section in &document.sections {
        let id = section.id.id();
        writeln!(out, "<section id=\"{id}\" aria-labelledby=\"{id}-title\">").ok();
        writeln!(out, "<h2 id=\"{id}-title\">{}</h2>", escaped(&section.title)).ok();
        for (idx, block) in section.blocks.iter().enumerate() {
            match (block, section.blocks.get(idx + 1)) {
                // What leads to something stays with it on a page.
                (Block::Paragraph(text), Some(next)) if !matches!(next, Block::Paragraph(_)) => {
                    writeln!(out, "<p class=\"lead\">{}</p>", escaped(text)).ok();
                }
                _ => write_block(&mut out, block)?,
            }
        }
        out.push_str("</section>\n");
    }
    out.push_str("</main>\n</body>\n</html>\n");
    Ok(out)
}

/// Links to the sections, for the screen.
fn contents(out: &mut String, document: &Document) {
    writeln!(out, "<nav aria-label=\"{}\">", words::CONTENTS).ok();
    for section in &document.sections {
        writeln!(out, "<a href=\"#{}\">{}</a>", section.id.id(), escaped(&section.title)).ok();
    }
    out.push_str("</nav>\n");
}

fn write_block(out: &mut String, block: &Block) -> Result<(), FigureError> {
    match block {
        Block::Heading(title) => {
            writeln!(out, "<h3>{}</h3>", escaped(title)).ok();
        }
        Block::Paragraph(text) => {
            writeln!(out, "<p>{}</p>", escaped(text)).ok();
        }
        Block::Verdict(verdict) => write_verdict(out, verdict),
        Block::Facts(facts) => write_facts(out, facts),
        Block::Table(table) => write_table(out, table),
        Block::Figure(figure) => write_figure(out, figure)?,
        Block::Code { caption, text } => write_code(out, caption, text),
        Block::Findings(findings) => write_findings(out, findings),
        Block::Signature(lines) => write_signature(out, lines),
    }
    Ok(())
}

/// The drawing itself stands in the page; its text says what it is.
fn write_figure(out: &mut String, figure: &Figure) -> Result<(), FigureError> {
    let svg = figure.svg()?;
    // In a page there is no declaration before it.
    let svg = svg.find("<svg").map_or(svg.as_str(), |start| &svg[start..]).trim();
    // It is drawn in points of print, of which a browser makes pixels unless it is told.
    let [width, _] = figure.size_points();
    let title = escaped(&figure.title);
    writeln!(out, "<figure class=\"figure\" style=\"width: {width}pt\"><figcaption>{title}</figcaption>{svg}</figure>")
        .ok();
    Ok(())
}

fn write_code(out: &mut String, caption: &str, text: &str) {
    let class = if text.lines().count() < CODE_KEPT_TOGETHER_BELOW { "code together" } else { "code" };
    let (caption, text) = (escaped(caption), escaped(text));
    writeln!(out, "<figure class=\"{class}\"><figcaption>{caption}</figcaption><pre>{text}</pre></figure>").ok();
}

fn write_verdict(out: &mut String, verdict: &Verdict) {
    let class = match verdict.rating {
        Some(calibrate::Verdict::Good) => "good",
        Some(calibrate::Verdict::Usable) => "usable",
        Some(calibrate::Verdict::NotUsable) => "bad",
        None => "none",
    };
    writeln!(out, "<div class=\"verdict {class}\">").ok();
    writeln!(
        out,
        "<p class=\"rating\"><span class=\"mark\" aria-hidden=\"true\">{}</span> {}</p>",
        verdict.mark,
        escaped(&verdict.name)
    )
    .ok();
    if let Some(headline) = &verdict.headline {
        let note = verdict.headline_note.as_deref().unwrap_or_default();
        let (headline, note) = (escaped(headline), escaped(note));
        writeln!(out, "<p class=\"headline\"><strong>{headline}</strong> <span>{note}</span></p>").ok();
    }
    writeln!(out, "<p class=\"reason\">{}</p>\n</div>", escaped(&verdict.reason)).ok();
}

fn write_facts(out: &mut String, facts: &[Fact]) {
    if facts.is_empty() {
        return;
    }
    out.push_str("<dl>\n");
    for fact in facts {
        // Notes keep their lines.
        let value = escaped(&fact.value).replace('\n', "<br/>");
        writeln!(out, "<div><dt>{}</dt><dd>{value}</dd></div>", escaped(&fact.name)).ok();
    }
    out.push_str("</dl>\n");
}

fn write_findings(out: &mut String, findings: &[Finding]) {
    out.push_str("<ul class=\"findings\">\n");
    for finding in findings {
        let class = match finding.severity {
            Severity::Wrong => "bad",
            Severity::Doubtful => "usable",
            Severity::Note => "note",
        };
        let (mark, name) = (severity_mark(finding.severity), severity_name(finding.severity));
        let remedy = if finding.remedy.is_empty() {
            String::new()
        } else {
            format!(" <span class=\"remedy\">{}</span>", escaped(&finding.remedy))
        };
        writeln!(
            out,
            "<li class=\"{class}\"><span class=\"mark\" aria-hidden=\"true\">{mark}</span><p><strong>{name}</strong> \
             <code>{}</code> {}{remedy}</p></li>",
            escaped(&finding.code),
            escaped(&finding.message)
        )
        .ok();
    }
    out.push_str("</ul>\n");
}

fn write_signature(out: &mut String, lines: &[Fact]) {
    out.push_str("<dl class=\"signature\">\n");
    for line in lines {
        let value = if line.value.is_empty() { "&#160;".to_owned() } else { escaped(&line.value) };
        writeln!(out, "<div><dd>{value}</dd><dt>{}</dt></div>", escaped(&line.name)).ok();
    }
    out.push_str("</dl>\n");
}

fn write_table(out: &mut String, table: &Table) {
    let is_short = table.rows.len() < KEPT_TOGETHER_BELOW;
    let is_beside = is_short && table.columns.len() <= BESIDE_UP_TO;
    let classes = [
        Some("table"),
        match table.columns.len() {
            DENSE_FROM.. => Some("dense"),
            COMPACT_FROM.. => Some("compact"),
            _ => None,
        },
        is_short.then_some("together"),
        is_beside.then_some("beside"),
    ];
    let classes: Vec<&str> = classes.into_iter().flatten().collect();
    let (id, title) = (escaped(&table.id), escaped(&table.title));
    writeln!(out, "<div class=\"{}\">\n<p class=\"title\" id=\"table-{id}\">{title}</p>", classes.join(" ")).ok();
    writeln!(out, "<table aria-labelledby=\"table-{id}\">").ok();
    out.push_str("<thead>\n");
    write_groups(out, &table.columns);
    out.push_str("<tr>");
    for (idx, column) in table.columns.iter().enumerate() {
        let unit = column
            .unit
            .map_or_else(String::new, |unit| format!(" <span class=\"unit\">/&#160;{}</span>", escaped(unit)));
        write!(out, "<th scope=\"col\"{}>{}{unit}</th>", class(&table.columns, idx), escaped(&column.title)).ok();
    }
    out.push_str("</tr>\n</thead>\n<tbody>\n");
    let fractions: Vec<usize> = (0..table.columns.len()).map(|idx| longest_fraction(table, idx)).collect();
    for row in &table.rows {
        out.push_str("<tr>");
        for (idx, cell) in row.iter().enumerate() {
            write_cell(out, table, idx, cell, fractions[idx]);
        }
        out.push_str("</tr>\n");
    }
    out.push_str("</tbody>\n</table>\n");
    if let Some(note) = &table.note {
        writeln!(out, "<p class=\"note\">{}</p>", escaped(note)).ok();
    }
    out.push_str("</div>\n");
}

/// The row of headings that several columns share.
fn write_groups(out: &mut String, columns: &[Column]) {
    if columns.iter().all(|column| column.group.is_none()) {
        return;
    }
    out.push_str("<tr>");
    let mut idx = 0;
    for group in columns.chunk_by(|a, b| a.group.is_some() && a.group == b.group) {
        let class = class(columns, idx);
        match &group[0].group {
            Some(title) => {
                write!(out, "<th scope=\"colgroup\" colspan=\"{}\"{class}>{}</th>", group.len(), escaped(title)).ok()
            }
            None => write!(out, "<td{class}></td>").ok(),
        };
        idx += group.len();
    }
    out.push_str("</tr>\n");
}

/// Figures stand on the right; a group begins with some room before it.
fn class(columns: &[Column], idx: usize) -> String {
    let column = &columns[idx];
    let is_first = column.group.is_some() && (idx == 0 || columns[idx - 1].group != column.group);
    let classes = [column.is_number.then_some("number"), is_first.then_some("first")];
    let classes: Vec<&str> = classes.into_iter().flatten().collect();
    if classes.is_empty() { String::new() } else { format!(" class=\"{}\"", classes.join(" ")) }
}

fn write_cell(out: &mut String, table: &Table, idx: usize, cell: &Cell, longest_fraction: usize) {
    let column = &table.columns[idx];
    let mut text = escaped(&cell.text);
    if column.is_number && cell.value.is_some() {
        text.push_str(&padding(&cell.text, longest_fraction));
    }
    if cell.is_strong {
        text = format!("<strong>{text}</strong>");
    }
    let class = class(&table.columns, idx);
    // The first column says which row it is.
    if idx == 0 && !column.is_number {
        let class = if cell.text.chars().count() <= SHORT_LABEL { " class=\"short\"" } else { "" };
        write!(out, "<th scope=\"row\"{class}>{text}</th>").ok();
    } else {
        write!(out, "<td{class}>{text}</td>").ok();
    }
}

/// What stands after the decimal point, point included; nothing where there is none.
fn fraction(text: &str) -> usize {
    text.find('.').map_or(0, |point| text[point..].chars().count())
}

fn longest_fraction(table: &Table, idx: usize) -> usize {
    let cells = table.rows.iter().filter_map(|row| row.get(idx)).filter(|cell| cell.value.is_some());
    cells.map(|cell| fraction(&cell.text)).max().unwrap_or(0)
}

/// Blanks as wide as the missing digits and point, so that decimal points stand below each other.
fn padding(text: &str, longest: usize) -> String {
    let found = fraction(text);
    let point = if found == 0 && longest > 0 { "\u{2008}" } else { "" };
    let digits = if found == 0 { longest.saturating_sub(1) } else { longest - found };
    format!("{point}{}", "\u{2007}".repeat(digits))
}

/// Text that stays text, in elements and in attributes.
fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '&' => out.push_str("&amp;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            // Neither HTML nor XML has these.
            c if c.is_control() && !matches!(c, '\n' | '\t') => out.push('\u{fffd}'),
            c => out.push(c),
        }
    }
    out
}

/// Text in a string of a style sheet: everything but letters and digits by its number, blanks too, as one after a number
/// would be taken for its end.
fn in_css(text: &str) -> String {
    let mut out = String::new();
    for c in text.chars() {
        if c.is_ascii_alphanumeric() {
            out.push(c);
        } else {
            write!(out, "\\{:06x}", u32::from(c)).ok();
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimal_points_stand_below_each_other() {
        for (text, longest, expected) in
            [("1.25", 3, ""), ("1.2", 3, "\u{2007}"), ("12", 3, "\u{2008}\u{2007}\u{2007}"), ("12", 0, "")]
        {
            assert_eq!(padding(text, longest), expected, "{text}");
        }
    }

    #[test]
    fn text_of_any_kind_stays_text() {
        assert_eq!(escaped("<a b=\"c\">&'\u{1}"), "&lt;a b=&quot;c&quot;&gt;&amp;&#39;\u{fffd}");
        assert_eq!(in_css("a\"</style>"), "a\\000022\\00003c\\00002fstyle\\00003e");
    }
}
