//! A YAML document as a tree in which lists of numbers are small. Aliases are refused, so that a short text stays short.

use saphyr_parser::{Event, Parser, ScalarStyle};

use crate::session::import::text::{excerpt, is_missing, number};

/// Deeper structures hold no poses.
const MAX_DEPTH: usize = 16;

/// A value with its place.
#[derive(Debug)]
pub(super) struct Item {
    line: u32,
    column: u32,
    pub node: Node,
}

impl Item {
    /// Line and column, from 1.
    pub const fn at(&self) -> (usize, usize) {
        (self.line as usize, self.column as usize)
    }
}

#[derive(Debug)]
pub(super) enum Node {
    /// NaN where the file says that there is no value.
    Number(f64),
    Text(Box<str>),
    Numbers(Vec<f64>),
    List(Vec<Item>),
    Map(Vec<(Box<str>, Item)>),
}

/// Why a document was not read to its end.
#[derive(Debug)]
pub(super) struct Problem {
    pub at: (usize, usize),
    pub found: String,
    pub expected: &'static str,
}

/// A list or map that is not closed yet.
enum Open {
    List { at: (u32, u32), numbers: Vec<f64>, items: Vec<Item> },
    Map { at: (u32, u32), key: Option<Box<str>>, entries: Vec<(Box<str>, Item)> },
}

/// The documents of a text, and what stopped the reading of the last.
pub(super) fn parse(text: &str) -> (Vec<Item>, Option<Problem>) {
    let mut parser = Parser::new_from_str(text);
    let mut roots = Vec::new();
    let mut open: Vec<Open> = Vec::new();
    while let Some(event) = parser.next_event() {
        let (event, span) = match event {
            Ok(event) => event,
            Err(error) => {
                let at = (error.marker().line(), error.marker().col() + 1);
                return (roots, Some(Problem { at, found: excerpt(error.info()).into(), expected: "YAML or JSON" }));
            }
        };
        let (line, column) = (span.start.line(), span.start.col() + 1);
        let at = (u32::try_from(line).unwrap_or(u32::MAX), u32::try_from(column).unwrap_or(u32::MAX));
        let problem = |found: &str, expected| Some(Problem { at: (line, column), found: found.to_owned(), expected });
        match event {
            Event::Alias(_) => return (roots, problem("an alias", "values that are written out")),
            Event::SequenceStart(..) | Event::MappingStart(..) if open.len() >= MAX_DEPTH => {
                return (roots, problem("lists in lists", "at most 16 of them in each other"));
            }
            Event::SequenceStart(..) => open.push(Open::List { at, numbers: Vec::new(), items: Vec::new() }),
            Event::MappingStart(..) => open.push(Open::Map { at, key: None, entries: Vec::new() }),
            Event::Scalar(value, style, ..) => {
                let is_plain = style == ScalarStyle::Plain;
                let is_null = is_missing(&value) || matches!(&*value, "~" | ".nan" | ".NaN" | ".NAN");
                let node = match number(&value, false) {
                    Some(value) if is_plain => Node::Number(value),
                    _ if is_plain && is_null => Node::Number(f64::NAN),
                    _ => Node::Text(value.into()),
                };
                add(&mut open, &mut roots, at, node);
            }
            Event::SequenceEnd | Event::MappingEnd => match open.pop() {
                Some(Open::List { at, numbers, items }) => {
                    let node = if items.is_empty() { Node::Numbers(numbers) } else { Node::List(items) };
                    add(&mut open, &mut roots, at, node);
                }
                Some(Open::Map { at, entries, .. }) => add(&mut open, &mut roots, at, Node::Map(entries)),
                None => {}
            },
            Event::Nothing | Event::StreamStart | Event::StreamEnd | Event::DocumentStart(_) | Event::DocumentEnd => {}
        }
    }
    (roots, None)
}

/// Puts a value where it belongs: into the list or map that is open.
fn add(open: &mut [Open], roots: &mut Vec<Item>, (line, column): (u32, u32), node: Node) {
    match open.last_mut() {
        None => roots.push(Item { line, column, node }),
        Some(Open::List { at, numbers, items }) => match node {
            Node::Number(value) if items.is_empty() => numbers.push(value),
            node => {
                // No list of numbers after all.
                let (line_of_list, column_of_list) = *at;
                items.extend(numbers.drain(..).map(|value| Item {
                    line: line_of_list,
                    column: column_of_list,
                    node: Node::Number(value),
                }));
                items.push(Item { line, column, node });
            }
        },
        Some(Open::Map { key, entries, .. }) => match key.take() {
            Some(key) => entries.push((key, Item { line, column, node })),
            None => {
                *key = Some(match node {
                    Node::Text(text) => text,
                    Node::Number(number) => number.to_string().into(),
                    // A structure as a key names nothing.
                    Node::Numbers(_) | Node::List(_) | Node::Map(_) => "".into(),
                });
            }
        },
    }
}
