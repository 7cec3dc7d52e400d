//! Lists and maps in brackets, which JSON is made of. They are read here and only stand as placeholders in the text that
//! the YAML parser gets: it keeps all tokens of such a list in memory, a hundred times its text.

use std::borrow::Cow;

use super::tree::{Item, Node, Open, Problem, Tree};
use crate::session::import::scan::Scanner;

/// Begins the placeholder of a list; no file has this character of private use.
const MARK: char = '\u{e000}';

/// Shorter lists are left to the YAML parser.
const MIN_BYTES: usize = 256;

/// A text in which lists and maps in brackets are placeholders, and what they stand for.
pub(super) struct Replaced<'t> {
    pub text: Cow<'t, str>,
    pub values: Vec<Option<Item>>,
    /// What stopped the reading; the text ends there.
    pub problem: Option<Problem>,
}

/// Which value a scalar is the placeholder of.
pub(super) fn placeholder(scalar: &str) -> Option<usize> {
    scalar.strip_prefix(MARK)?.trim_end().parse().ok()
}

/// Takes the lists and maps in brackets out of a text.
pub(super) fn replace(text: &str) -> Replaced<'_> {
    let mut replaced = String::new();
    let mut values = Vec::new();
    let mut problem = None;
    let mut scanner = Scanner::new(text, "");
    let mut copied = 0;
    // The last character of the line that is not blank, and the one just before.
    let (mut last, mut previous) = ('\n', '\n');
    while let Some(c) = scanner.peek() {
        let start = scanner.at();
        let begins_value = matches!(last, '\n' | ':' | '-' | '?');
        match c {
            '#' if previous.is_whitespace() => skip_line(&mut scanner),
            '"' | '\'' if begins_value => {
                quoted(&mut scanner);
                last = c;
            }
            '[' | '{' if begins_value => {
                match value(&mut scanner) {
                    // A short list is no burden.
                    Ok(_) if scanner.at() - start < MIN_BYTES => {}
                    Ok(item) => {
                        replaced.push_str(&text[copied..start]);
                        replaced.push(MARK);
                        replaced.push_str(&values.len().to_string());
                        // Its line ends stay, so that the lines below keep their numbers.
                        let inside = text[start..scanner.at()].chars();
                        replaced.extend(inside.filter(|c| matches!(c, '\n' | '\r')));
                        values.push(Some(item));
                        copied = scanner.at();
                    }
                    Err(found) => {
                        problem = Some(found);
                        replaced.push_str(&text[copied..start]);
                        return Replaced { text: Cow::Owned(replaced), values, problem };
                    }
                }
                last = ']';
            }
            _ => {
                scanner.bump();
                if matches!(c, '\n' | '\r') {
                    last = '\n';
                } else if !c.is_whitespace() {
                    last = c;
                }
            }
        }
        previous = c;
    }
    if values.is_empty() {
        return Replaced { text: Cow::Borrowed(text), values, problem };
    }
    replaced.push_str(&text[copied..]);
    Replaced { text: Cow::Owned(replaced), values, problem }
}

fn skip_line(scanner: &mut Scanner<'_>) {
    let rest = scanner.rest();
    scanner.jump(scanner.at() + rest.find(['\n', '\r']).unwrap_or(rest.len()));
}

/// Passes over a quoted text and gives what is between the quotation marks.
fn quoted<'t>(scanner: &mut Scanner<'t>) -> &'t str {
    let quote = scanner.bump();
    let rest = scanner.rest();
    let start = scanner.at();
    while let Some(c) = scanner.bump() {
        if Some(c) == quote {
            return &rest[..scanner.at() - start - c.len_utf8()];
        }
        if c == '\\' && quote == Some('"') {
            scanner.bump();
        }
    }
    rest
}

/// Reads the list or map in brackets that is next.
fn value(scanner: &mut Scanner<'_>) -> Result<Item, Problem> {
    let mut tree = Tree::default();
    loop {
        scanner.skip_blanks();
        let start = scanner.at();
        let at = scanner.place(start);
        let problem = |found: &str, expected| Problem { at, found: found.to_owned(), expected };
        match scanner.peek() {
            None => return Err(problem("the end", "a closing bracket")),
            Some('[') => tree.open(at, Open::list(at))?,
            Some('{') => tree.open(at, Open::map(at))?,
            Some(c @ (']' | '}')) => {
                if !tree.close(c == ']') {
                    return Err(problem(if c == ']' { "]" } else { "}" }, "the bracket that was opened"));
                }
            }
            Some(',') => tree.end_entry(at),
            Some(':') => {}
            Some('*' | '&') => return Err(problem("an alias", "values that are written out")),
            Some('#') => {
                skip_line(scanner);
                continue;
            }
            Some('"' | '\'') => {
                let text = quoted(scanner);
                tree.add(at, Node::Text(text.into()));
                continue;
            }
            Some(_) => {
                let rest = scanner.rest();
                let is_end = |(byte, c): (usize, char)| {
                    matches!(c, ',' | '[' | ']' | '{' | '}' | '\n' | '\r')
                        || (c == ':' && rest[byte + 1..].starts_with([' ', '\n', '\r', '[', '{', '"']))
                };
                let end = rest.char_indices().find(|place| is_end(*place)).map_or(rest.len(), |(byte, _)| byte);
                tree.add(at, Node::plain(rest[..end].trim()));
                scanner.jump(start + end.max(1));
                continue;
            }
        }
        scanner.bump();
        if let Some(item) = tree.take_root() {
            return Ok(item);
        }
    }
}
