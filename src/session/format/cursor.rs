//! A walk through a JSON tree that knows where it is, so that every refusal names its path.

use std::borrow::Cow;

use crate::geometry::Vec3;
use crate::session::limits::Quantity;
use crate::session::model::UnknownFields;

use super::tree::{Node, node_of, quoted};

/// What is wrong, and where; the file's name is added by whoever knows it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Refusal {
    pub path: String,
    pub found: String,
    pub expected: String,
}

/// A value with its place in the file.
#[derive(Clone, Debug)]
pub(super) struct Cursor<'a> {
    node: Cow<'a, Node>,
    path: String,
}

impl<'a> Cursor<'a> {
    pub fn root(node: &'a Node) -> Self {
        Self { node: Cow::Borrowed(node), path: String::new() }
    }

    pub fn path(&self) -> &str {
        &self.path
    }

    /// A refusal of this value as a whole.
    pub fn refuse(&self, expected: impl Into<String>) -> Refusal {
        self.refuse_as(self.node.described(), expected)
    }

    /// A refusal of this value for a reason that its own text does not show.
    pub fn refuse_as(&self, found: impl Into<String>, expected: impl Into<String>) -> Refusal {
        Refusal {
            path: if self.path.is_empty() { "top level".to_owned() } else { self.path.clone() },
            found: found.into(),
            expected: expected.into(),
        }
    }

    /// A refusal of one element of this list.
    pub fn refuse_element(&self, index: usize, found: impl Into<String>, expected: impl Into<String>) -> Refusal {
        Refusal { path: format!("{}[{index}]", self.path), found: found.into(), expected: expected.into() }
    }

    pub fn object(&self, expected: &str) -> Result<Object<'_>, Refusal> {
        match &*self.node {
            Node::Object(fields) => Ok(Object { fields, path: self.path.clone() }),
            _ => Err(self.refuse(expected)),
        }
    }

    pub fn elements(&self, expected: &str) -> Result<Vec<Cursor<'_>>, Refusal> {
        let element = |(index, node)| Cursor { node, path: format!("{}[{index}]", self.path) };
        match &*self.node {
            Node::List(nodes) => Ok(nodes.iter().map(Cow::Borrowed).enumerate().map(element).collect()),
            Node::Numbers(numbers) => {
                Ok(numbers.iter().map(|number| Cow::Owned(node_of(*number))).enumerate().map(element).collect())
            }
            _ => Err(self.refuse(expected)),
        }
    }

    pub fn text(&self, expected: &str) -> Result<&str, Refusal> {
        match &*self.node {
            Node::Text(text) => Ok(text),
            _ => Err(self.refuse(expected)),
        }
    }

    pub fn boolean(&self) -> Result<bool, Refusal> {
        match &*self.node {
            Node::Bool(value) => Ok(*value),
            _ => Err(self.refuse("true or false")),
        }
    }

    /// A whole number that is not negative.
    pub fn count(&self) -> Option<u64> {
        match &*self.node {
            Node::Number(number) => number.as_u64(),
            _ => None,
        }
    }

    pub fn number(&self, quantity: &Quantity) -> Result<f64, Refusal> {
        match &*self.node {
            Node::Number(number) => {
                number.as_f64().filter(|value| quantity.admits(*value)).ok_or_else(|| self.refuse(quantity.to_string()))
            }
            _ => Err(self.refuse(quantity.to_string())),
        }
    }

    /// The numbers of a list, NaN where it has null.
    pub fn numbers_or_null(&self, expected: &str) -> Result<&[f64], Refusal> {
        match &*self.node {
            Node::Numbers(numbers) => Ok(numbers),
            Node::List(nodes) => {
                let is_stranger = |node: &Node| !matches!(node, Node::Number(number) if number.is_f64());
                let index = nodes
                    .iter()
                    .position(|node| is_stranger(node) && !matches!(node, Node::Null | Node::Number(_)))
                    .or_else(|| nodes.iter().position(is_stranger))
                    .unwrap_or(0);
                Err(self.refuse_element(index, nodes.get(index).map_or_else(String::new, Node::described), expected))
            }
            _ => Err(self.refuse(expected)),
        }
    }

    /// Exactly `N` numbers, each as `quantity` says.
    pub fn array<const N: usize>(&self, quantity: &Quantity) -> Result<[f64; N], Refusal> {
        let expected = || format!("a list of {N} numbers, each {quantity}");
        let numbers = self.numbers_or_null(&expected())?;
        let array: [f64; N] = numbers.try_into().map_err(|_| self.refuse(expected()))?;
        match array.iter().position(|value| !quantity.admits(*value)) {
            Some(index) => Err(self.refuse_element(index, node_of(array[index]).described(), quantity.to_string())),
            None => Ok(array),
        }
    }

    pub fn vec3(&self, quantity: &Quantity) -> Result<Vec3, Refusal> {
        self.array::<3>(quantity).map(Vec3::from)
    }

    /// One of a few words, each with its meaning.
    pub fn one_of<T: Copy>(&self, choices: &[(&str, T)]) -> Result<T, Refusal> {
        let Node::Text(text) = &*self.node else {
            return Err(self.refuse(listed(choices.iter().map(|(word, _)| *word))));
        };
        choices
            .iter()
            .find(|(word, _)| word == text)
            .map(|(_, meaning)| *meaning)
            .ok_or_else(|| self.refuse(listed(choices.iter().map(|(word, _)| *word))))
    }
}

/// Words as a message lists them: `"a", "b" or "c"`.
pub(super) fn listed<'w>(words: impl Iterator<Item = &'w str>) -> String {
    let quoted: Vec<String> = words.map(quoted).collect();
    match quoted.split_last() {
        Some((last, rest)) if !rest.is_empty() => format!("{} or {last}", rest.join(", ")),
        _ => quoted.concat(),
    }
}

/// An object with its place in the file. A null field counts as absent.
#[derive(Clone, Debug)]
pub(super) struct Object<'a> {
    fields: &'a [(String, Node)],
    path: String,
}

impl<'a> Object<'a> {
    pub fn path_of(&self, name: &str) -> String {
        if self.path.is_empty() { name.to_owned() } else { format!("{}.{name}", self.path) }
    }

    pub fn optional(&self, name: &str) -> Option<Cursor<'a>> {
        self.fields
            .iter()
            .find(|(key, node)| key == name && *node != Node::Null)
            .map(|(_, node)| Cursor { node: Cow::Borrowed(node), path: self.path_of(name) })
    }

    /// A field that must be there; `expected` says what it would hold.
    pub fn required(&self, name: &str, expected: &str) -> Result<Cursor<'a>, Refusal> {
        self.optional(name).ok_or_else(|| Refusal {
            path: self.path_of(name),
            found: "nothing".to_owned(),
            expected: expected.to_owned(),
        })
    }

    /// Text, empty where the field is absent.
    pub fn text_or_empty(&self, name: &str) -> Result<String, Refusal> {
        self.optional(name).map_or_else(|| Ok(String::new()), |cursor| cursor.text("text").map(str::to_owned))
    }

    /// A number, if the field is there.
    pub fn optional_number(&self, name: &str, quantity: &Quantity) -> Result<Option<f64>, Refusal> {
        self.optional(name).map(|cursor| cursor.number(quantity)).transpose()
    }

    /// The fields that are not among `known`.
    pub fn unknown(&self, known: &[&str]) -> UnknownFields {
        self.fields
            .iter()
            .filter(|(key, _)| !known.contains(&key.as_str()))
            .map(|(key, node)| (key.clone(), node.to_value()))
            .collect()
    }

    /// Puts the fields that are not among `known` into the parent's unknown fields, under this object's own name.
    pub fn keep_unknown_in(&self, parent: &mut UnknownFields, name: &str, known: &[&str]) {
        let unknown = self.unknown(known);
        if !unknown.is_empty() {
            parent.insert(name.to_owned(), unknown.into());
        }
    }
}
