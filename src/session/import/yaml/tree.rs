//! A YAML document as a tree in which lists of numbers are small. Aliases are refused, so that a short text stays short.

use saphyr_parser::{Event, Parser, ScalarStyle};

use crate::sheet::text::{excerpt, is_missing, number};

use super::flow;

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
    fn new((line, column): (usize, usize), node: Node) -> Self {
        let small = |number: usize| u32::try_from(number).unwrap_or(u32::MAX);
        Self { line: small(line), column: small(column), node }
    }

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

impl Node {
    /// A scalar without quotation marks.
    pub fn plain(text: &str) -> Self {
        let is_null = is_missing(text) || matches!(text, "~" | ".nan" | ".NaN" | ".NAN");
        match number(text, false) {
            Some(value) => Self::Number(value),
            None if is_null => Self::Number(f64::NAN),
            None => Self::Text(text.into()),
        }
    }
}

/// A list or map that is not closed yet.
pub(super) enum Open {
    List { at: (usize, usize), numbers: Vec<f64>, items: Vec<Item> },
    Map { at: (usize, usize), key: Option<Box<str>>, entries: Vec<(Box<str>, Item)> },
}

impl Open {
    pub const fn list(at: (usize, usize)) -> Self {
        Self::List { at, numbers: Vec::new(), items: Vec::new() }
    }

    pub const fn map(at: (usize, usize)) -> Self {
        Self::Map { at, key: None, entries: Vec::new() }
    }
}

/// A tree under construction.
#[derive(Default)]
pub(super) struct Tree {
    roots: Vec<Item>,
    open: Vec<Open>,
}

impl Tree {
    /// Begins a list or map.
    ///
    /// # Errors
    /// [`Problem`] if it lies too deep.
    pub fn open(&mut self, at: (usize, usize), open: Open) -> Result<(), Problem> {
        if self.open.len() >= MAX_DEPTH {
            let expected = "at most 16 of them in each other";
            return Err(Problem { at, found: "lists in lists".to_owned(), expected });
        }
        self.open.push(open);
        Ok(())
    }

    /// Ends the list, or the map, that was begun last; false if that is another.
    pub fn close(&mut self, is_list: bool) -> bool {
        match self.open.pop() {
            Some(Open::List { at, mut numbers, mut items }) if is_list => {
                numbers.shrink_to_fit();
                items.shrink_to_fit();
                let node = if items.is_empty() { Node::Numbers(numbers) } else { Node::List(items) };
                self.add(at, node);
                true
            }
            Some(Open::Map { at, key, mut entries }) if !is_list => {
                entries.extend(key.map(|key| (key, Item::new(at, Node::Number(f64::NAN)))));
                entries.shrink_to_fit();
                self.add(at, Node::Map(entries));
                true
            }
            _ => false,
        }
    }

    /// Ends an entry of a map; a key without a value has none.
    pub fn end_entry(&mut self, at: (usize, usize)) {
        if let Some(Open::Map { key: Some(_), .. }) = self.open.last() {
            self.add(at, Node::Number(f64::NAN));
        }
    }

    /// What is complete, if everything that was begun is ended.
    pub fn take_root(&mut self) -> Option<Item> {
        if self.open.is_empty() { self.roots.pop() } else { None }
    }

    /// Puts a value where it belongs: into the list or map that is open.
    pub fn add(&mut self, at: (usize, usize), node: Node) {
        self.add_item(Item::new(at, node));
    }

    fn add_item(&mut self, item: Item) {
        match self.open.last_mut() {
            None => self.roots.push(item),
            Some(Open::List { at, numbers, items }) => match item.node {
                Node::Number(value) if items.is_empty() => numbers.push(value),
                _ => {
                    // No list of numbers after all.
                    items.extend(numbers.drain(..).map(|value| Item::new(*at, Node::Number(value))));
                    items.push(item);
                }
            },
            Some(Open::Map { key, entries, .. }) => match key.take() {
                Some(key) => entries.push((key, item)),
                None => {
                    *key = Some(match item.node {
                        Node::Text(text) => text,
                        Node::Number(number) => number.to_string().into(),
                        // A structure as a key names nothing.
                        Node::Numbers(_) | Node::List(_) | Node::Map(_) => "".into(),
                    });
                }
            },
        }
    }
}

/// The documents of a text, and what stopped the reading of the last.
pub(super) fn parse(text: &str) -> (Vec<Item>, Option<Problem>) {
    let mut replaced = flow::replace(text);
    let mut tree = Tree::default();
    let problem = blocks(&replaced.text, &mut replaced.values, &mut tree).err();
    (tree.roots, replaced.problem.or(problem))
}

/// Reads what stands outside brackets.
fn blocks(text: &str, values: &mut [Option<Item>], tree: &mut Tree) -> Result<(), Problem> {
    let mut parser = Parser::new_from_str(text);
    while let Some(event) = parser.next_event() {
        let (event, span) = event.map_err(|error| Problem {
            at: (error.marker().line(), error.marker().col() + 1),
            found: excerpt(error.info()).into(),
            expected: "YAML or JSON",
        })?;
        let at = (span.start.line(), span.start.col() + 1);
        match event {
            Event::Alias(_) => {
                return Err(Problem { at, found: "an alias".to_owned(), expected: "values that are written out" });
            }
            Event::SequenceStart(..) => tree.open(at, Open::list(at))?,
            Event::MappingStart(..) => tree.open(at, Open::map(at))?,
            Event::Scalar(scalar, style, ..) => {
                let value = flow::placeholder(&scalar).and_then(|idx| values.get_mut(idx)?.take());
                match value {
                    Some(item) => tree.add_item(item),
                    None if style == ScalarStyle::Plain => tree.add(at, Node::plain(&scalar)),
                    None => tree.add(at, Node::Text(scalar.into())),
                }
            }
            Event::SequenceEnd | Event::MappingEnd => {
                tree.close(event == Event::SequenceEnd);
            }
            Event::Nothing | Event::StreamStart | Event::StreamEnd | Event::DocumentStart(_) | Event::DocumentEnd => {}
        }
    }
    Ok(())
}
