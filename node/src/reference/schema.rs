//! Generates JSON Schema (draft-07) of the files, for editors.
//!
//! Law      a file that the program accepts fits its schema. A file that does not fit has an unknown key, lacks a
//!          required one, or has a value of another kind. Only the program checks names of objects, and keys that
//!          depend on other keys
//! Writes   draft-07, which yaml-language-server reads. The program reads a value that YAML may treat as a number as
//!          written, so that the schema also accepts a text with a number

use super::catalogue::{Entry, entries};
use super::{File, Shape};
use crate::scenario::VERBS;
use lineshaft_core::function::TYPES;
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;

/// An integer that YAML does not read as one.
pub(super) const WHOLE: &str = "^0[xo][0-9A-Fa-f]+$";
/// A number or a fraction.
pub(super) const NUMBER: &str = "^[-+]?[.]?[0-9][-+0-9.eE/]*$";
/// A number with an optional unit.
pub(super) const QUANTITY: &str = "^\\s*[-+]?[.]?[0-9]";
/// A number, a space and a unit.
const MULTIPLE: &str = "^\\s*[-+]?[.]?[0-9]\\S*\\s+\\S";
/// An entry of a list `all` or `any`.
const CONDITION: &str = "condition";

/// A key with those of its value.
#[derive(Debug, Default)]
struct Node {
    shapes: Vec<Shape>,
    meaning: String,
    is_required: bool,
    children: BTreeMap<String, Node>,
}

/// Returns the schema of a file.
pub fn schema(file: File) -> Value {
    let mut root = Node { shapes: vec![Shape::Map], ..Node::default() };
    for Entry { path, shapes, is_required, meaning } in entries(file) {
        let node = path.into_iter().fold(&mut root, |node, step| node.children.entry(step).or_default());
        for shape in shapes {
            if !node.shapes.contains(&shape) {
                node.shapes.push(shape);
            }
        }
        node.is_required |= is_required;
        if node.meaning.is_empty() {
            node.meaning = meaning;
        }
    }
    let condition = root.children.remove(CONDITION);
    let mut schema = mapping(&root, "");
    schema.insert("type".to_owned(), json!("object"));
    schema.insert("$schema".to_owned(), json!("http://json-schema.org/draft-07/schema#"));
    schema
        .insert("title".to_owned(), json!(format!("Lineshaft {}, version {}", file.name(), env!("CARGO_PKG_VERSION"))));
    if let Some(condition) = condition {
        schema.insert("definitions".to_owned(), json!({ CONDITION: Value::Object(mapping(&condition, CONDITION)) }));
    }
    Value::Object(schema)
}

/// Returns the schema of a key.
fn of_node(node: &Node, path: &str) -> Value {
    let mut shapes: Vec<Value> = match path {
        "functions.*.type" => vec![json!({ "enum": TYPES.iter().map(|row| row.name).collect::<Vec<_>>() })],
        "steps[].do" => {
            let verb = verb();
            vec![verb.clone(), json!({ "type": "array", "items": verb })]
        }
        _ => node.shapes.iter().map(|shape| of_shape(*shape, node, path)).collect(),
    };
    let mut schema = match shapes.len() {
        1 => shapes.remove(0),
        _ => json!({ "anyOf": shapes }),
    };
    if let Some(schema) = schema.as_object_mut().filter(|_| !node.meaning.is_empty()) {
        schema.insert("description".to_owned(), json!(node.meaning));
    }
    schema
}

fn of_shape(shape: Shape, node: &Node, path: &str) -> Value {
    let text = |kind: Value, pattern: &str| json!({ "anyOf": [kind, { "type": "string", "pattern": pattern }] });
    match shape {
        Shape::Text => json!({ "type": ["string", "number", "boolean"] }),
        Shape::Boolean => json!({ "type": "boolean" }),
        Shape::Integer(low, high) => {
            let mut whole = Map::from_iter([("type".to_owned(), json!("integer"))]);
            let bounds = [("minimum", low), ("maximum", high)];
            whole.extend(bounds.into_iter().filter_map(|(key, bound)| Some((key.to_owned(), number(bound)?))));
            text(Value::Object(whole), WHOLE)
        }
        Shape::Number => text(json!({ "type": "number" }), NUMBER),
        Shape::Quantity(_) => text(json!({ "type": "number" }), QUANTITY),
        Shape::Multiple => json!({ "type": "string", "pattern": MULTIPLE }),
        Shape::Choice(names) => json!({ "enum": names.iter().flat_map(|name| spellings(name)).collect::<Vec<_>>() }),
        Shape::List => {
            let is_condition = path.ends_with(".all") || path.ends_with(".any");
            match node.children.get("[]") {
                Some(item) => json!({ "type": ["array", "null"], "items": of_node(item, &format!("{path}[]")) }),
                None if is_condition => {
                    json!({ "type": ["array", "null"], "items": { "$ref": format!("#/definitions/{CONDITION}") } })
                }
                None => json!({ "type": ["array", "null"] }),
            }
        }
        Shape::Map => Value::Object(mapping(node, path)),
        Shape::Names => {
            let each = node.children.get("*").map_or(json!(true), |each| of_node(each, &format!("{path}.*")));
            json!({ "type": ["object", "null"], "additionalProperties": each })
        }
    }
}

/// Returns the schema of a mapping with these keys and no others.
fn mapping(node: &Node, path: &str) -> Map<String, Value> {
    let keys = || node.children.iter().filter(|(key, _)| *key != "[]");
    let join = |key: &str| if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") };
    let properties: Map<String, Value> = keys().map(|(key, child)| (key.clone(), of_node(child, &join(key)))).collect();
    let required: Vec<&String> = keys().filter(|(_, child)| child.is_required).map(|(key, _)| key).collect();
    let mut mapping = Map::new();
    mapping.insert("type".to_owned(), json!(["object", "null"]));
    mapping.insert("properties".to_owned(), Value::Object(properties));
    if !required.is_empty() {
        mapping.insert("required".to_owned(), json!(required));
    }
    mapping.insert("additionalProperties".to_owned(), json!(false));
    mapping
}

/// Returns the schema of one verb with its arguments.
fn verb() -> Value {
    let verbs: Map<String, Value> = VERBS.iter().map(|verb| ((*verb).to_owned(), json!({}))).collect();
    json!({ "type": "object", "properties": verbs, "additionalProperties": false, "minProperties": 1, "maxProperties": 1 })
}

/// Returns the values as which YAML may read a name.
fn spellings(name: &str) -> Vec<Value> {
    let mut spellings = vec![json!(name)];
    spellings.extend(name.parse::<i64>().ok().map(Value::from));
    spellings.extend(name.parse::<bool>().ok().map(Value::from));
    spellings
}

/// Returns a bound as JSON number; `None` if there is no such number.
fn number(bound: i128) -> Option<Value> {
    i64::try_from(bound).map(Value::from).or_else(|_| u64::try_from(bound).map(Value::from)).ok()
}
