//! JSON as a tree that is cheap for lists of numbers: what the session reader walks, with paths for its messages.

use std::collections::HashSet;
use std::fmt;

use serde::de::{self, Deserialize, Deserializer, MapAccess, SeqAccess, Visitor};
use serde_json::{Map, Number, Value};

use crate::session::error::on_one_line;

/// Integers up to this size are exact as `f64`, so they may stand in a compact list.
const EXACT_INTEGER: u64 = 1 << 53;
/// Objects with fewer fields than this are searched one by one.
const FEW_FIELDS: usize = 16;
/// Longer text is cut in messages.
const QUOTED_CHARS: usize = 60;

/// A JSON value.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Node {
    Null,
    Bool(bool),
    Number(Number),
    Text(String),
    /// A list of numbers and nulls only, the nulls as NaN: almost all of a session's bytes are such lists.
    Numbers(Vec<f64>),
    /// Any other list.
    List(Vec<Node>),
    Object(Vec<(String, Node)>),
}

impl Node {
    /// What a message says was found.
    pub(super) fn described(&self) -> String {
        match self {
            Self::Null => "null".to_owned(),
            Self::Bool(value) => value.to_string(),
            Self::Number(number) => number.to_string(),
            Self::Text(text) => quoted(text),
            Self::Numbers(numbers) => list_of(numbers.len()),
            Self::List(nodes) => list_of(nodes.len()),
            Self::Object(_) => "an object".to_owned(),
        }
    }

    /// The same as serde's type, for fields that we do not know.
    pub(super) fn to_value(&self) -> Value {
        match self {
            Self::Null => Value::Null,
            Self::Bool(value) => Value::Bool(*value),
            Self::Number(number) => Value::Number(number.clone()),
            Self::Text(text) => Value::String(text.clone()),
            Self::Numbers(numbers) => Value::Array(numbers.iter().map(|number| number_value(*number)).collect()),
            Self::List(nodes) => Value::Array(nodes.iter().map(Self::to_value).collect()),
            Self::Object(fields) => {
                Value::Object(fields.iter().map(|(key, node)| (key.clone(), node.to_value())).collect::<Map<_, _>>())
            }
        }
    }

    /// As an entry of a compact list, where that loses nothing.
    fn compact(&self) -> Option<f64> {
        match self {
            Self::Null => Some(f64::NAN),
            Self::Number(number) if number.is_f64() => number.as_f64(),
            Self::Number(number) => {
                let size = number.as_u64().or_else(|| number.as_i64().map(i64::unsigned_abs))?;
                (size <= EXACT_INTEGER).then(|| number.as_f64()).flatten()
            }
            _ => None,
        }
    }
}

fn list_of(len: usize) -> String {
    match len {
        0 => "an empty list".to_owned(),
        1 => "a list of 1".to_owned(),
        _ => format!("a list of {len}"),
    }
}

/// Text as a message quotes it: on one line, cut where it is long.
pub(super) fn quoted(text: &str) -> String {
    let mut short: String = text.chars().take(QUOTED_CHARS).collect();
    if short.len() < text.len() {
        short.push('…');
    }
    format!("\"{}\"", on_one_line(&short.replace('"', "\\\"")))
}

/// A number of a compact list as serde's type: whole ones as integers, as people write them.
#[expect(clippy::cast_possible_truncation, reason = "whole numbers below 2^53 convert exactly")]
fn number_value(number: f64) -> Value {
    const EXACT: f64 = 9_007_199_254_740_992.0;
    let is_negative_zero = number == 0.0 && number.is_sign_negative();
    if number.fract() == 0.0 && number.abs() <= EXACT && !is_negative_zero {
        Value::from(number as i64)
    } else {
        // NaN stands for null, and becomes it.
        Value::from(number)
    }
}

/// A list under construction: compact for as long as that loses nothing.
enum Elements {
    Compact(Vec<f64>),
    General(Vec<Node>),
}

impl Elements {
    fn push(&mut self, node: Node) {
        match (&mut *self, node.compact()) {
            (Self::Compact(numbers), Some(number)) => numbers.push(number),
            (Self::Compact(numbers), None) => {
                let mut nodes: Vec<Node> = numbers.iter().map(|number| node_of(*number)).collect();
                nodes.push(node);
                *self = Self::General(nodes);
            }
            (Self::General(nodes), _) => nodes.push(node),
        }
    }

    fn finish(self) -> Node {
        match self {
            // A list of nulls only says nothing about numbers, but reads the same.
            Self::Compact(numbers) => Node::Numbers(numbers),
            Self::General(nodes) => Node::List(nodes),
        }
    }
}

/// An entry of a compact list as a node of its own.
pub(super) fn node_of(number: f64) -> Node {
    match number_value(number) {
        Value::Number(number) => Node::Number(number),
        _ => Node::Null,
    }
}

impl<'de> Deserialize<'de> for Node {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(NodeVisitor)
    }
}

struct NodeVisitor;

impl<'de> Visitor<'de> for NodeVisitor {
    type Value = Node;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("a JSON value")
    }

    fn visit_unit<E: de::Error>(self) -> Result<Node, E> {
        Ok(Node::Null)
    }

    fn visit_bool<E: de::Error>(self, value: bool) -> Result<Node, E> {
        Ok(Node::Bool(value))
    }

    fn visit_i64<E: de::Error>(self, value: i64) -> Result<Node, E> {
        Ok(Node::Number(value.into()))
    }

    fn visit_u64<E: de::Error>(self, value: u64) -> Result<Node, E> {
        Ok(Node::Number(value.into()))
    }

    fn visit_f64<E: de::Error>(self, value: f64) -> Result<Node, E> {
        Number::from_f64(value).map(Node::Number).ok_or_else(|| E::custom("number out of range"))
    }

    fn visit_str<E: de::Error>(self, value: &str) -> Result<Node, E> {
        Ok(Node::Text(value.to_owned()))
    }

    fn visit_string<E: de::Error>(self, value: String) -> Result<Node, E> {
        Ok(Node::Text(value))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut sequence: A) -> Result<Node, A::Error> {
        let mut elements = Elements::Compact(Vec::new());
        while let Some(node) = sequence.next_element()? {
            elements.push(node);
        }
        Ok(elements.finish())
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Node, A::Error> {
        let mut fields: Vec<(String, Node)> = Vec::new();
        // Large objects get an index, so that a hostile file cannot make this quadratic.
        let mut seen = HashSet::new();
        while let Some(key) = map.next_key::<String>()? {
            if fields.len() == FEW_FIELDS {
                seen.extend(fields.iter().map(|(known, _)| known.clone()));
            }
            let is_repeated = if fields.len() < FEW_FIELDS {
                fields.iter().any(|(known, _)| *known == key)
            } else {
                !seen.insert(key.clone())
            };
            if is_repeated {
                return Err(de::Error::custom(format!("the field {} stands twice in one object", quoted(&key))));
            }
            fields.push((key, map.next_value()?));
        }
        Ok(Node::Object(fields))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(json: &str) -> Result<Node, serde_json::Error> {
        serde_json::from_str(json)
    }

    #[test]
    fn lists_of_numbers_are_compact_and_come_back_as_they_were() {
        for (json, is_compact) in [
            ("[1,-2.5,null,0.1]", true),
            ("[]", true),
            ("[9007199254740993]", false),
            ("[1,\"two\",null,[3]]", false),
            ("{\"a\":[1,2],\"b\":{\"c\":[true,null]}}", false),
        ] {
            let node = parse(json).expect("valid");
            assert_eq!(matches!(node, Node::Numbers(_)), is_compact, "{json}");
            assert_eq!(node.to_value().to_string(), json);
        }
    }

    #[test]
    fn a_field_that_stands_twice_is_refused_in_small_and_large_objects() {
        assert!(parse("{\"a\":1,\"a\":2}").expect_err("twice").to_string().contains("\"a\" stands twice"));
        for repeated in [0, 20, 39] {
            let fields: Vec<String> = (0..40).chain([repeated]).map(|idx| format!("\"f{idx}\":0")).collect();
            let refusal = parse(&format!("{{{}}}", fields.join(","))).expect_err("twice");
            assert!(refusal.to_string().contains(&format!("\"f{repeated}\" stands twice")), "{refusal}");
        }
    }
}
