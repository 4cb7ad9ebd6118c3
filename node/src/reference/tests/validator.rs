//! Validates a value with the parts of JSON Schema, draft-07, that the schemas of this program use.

use crate::reference::schema::{NUMBER, QUANTITY, WHOLE};
use serde_json::Value;

/// Returns each mismatch with its location.
pub(super) fn problems(value: &Value, schema: &Value) -> Vec<String> {
    let mut problems = Vec::new();
    check(value, schema, schema, "", &mut problems);
    problems
}

fn check(value: &Value, schema: &Value, root: &Value, at: &str, problems: &mut Vec<String>) {
    let Some(schema) = schema.as_object() else {
        if schema == &Value::Bool(false) {
            problems.push(format!("{at}: nothing may be here"));
        }
        return;
    };
    for (key, asked) in schema {
        let is_good = match key.as_str() {
            "$schema" | "title" | "description" | "definitions" => true,
            "$ref" => {
                let pointer =
                    asked.as_str().and_then(|text| text.strip_prefix('#')).expect("a reference in the schema");
                check(value, root.pointer(pointer).expect("a definition"), root, at, problems);
                true
            }
            "type" => match asked {
                Value::Array(kinds) => kinds.iter().any(|kind| is_of(value, kind)),
                kind => is_of(value, kind),
            },
            "enum" => asked.as_array().expect("a list").contains(value),
            "anyOf" => asked.as_array().expect("a list").iter().any(|one| {
                let mut problems = Vec::new();
                check(value, one, root, at, &mut problems);
                problems.is_empty()
            }),
            "minimum" => is_ordered(asked, value),
            "maximum" => is_ordered(value, asked),
            "pattern" => value.as_str().is_none_or(|text| fits(text, asked.as_str().unwrap_or_default())),
            "required" => {
                let keys = asked.as_array().expect("a list").iter().filter_map(Value::as_str);
                let missing: Vec<&str> = keys.filter(|key| value.is_object() && value.get(key).is_none()).collect();
                problems.extend(missing.into_iter().map(|key| format!("{at}: {key} is missing")));
                true
            }
            "minProperties" => value.as_object().is_none_or(|map| Some(map.len() as u64) >= asked.as_u64()),
            "maxProperties" => value.as_object().is_none_or(|map| Some(map.len() as u64) <= asked.as_u64()),
            "items" => {
                for (index, item) in value.as_array().into_iter().flatten().enumerate() {
                    check(item, asked, root, &format!("{at}[{index}]"), problems);
                }
                true
            }
            "properties" => {
                for (key, value) in value.as_object().into_iter().flatten() {
                    if let Some(schema) = asked.get(key) {
                        check(value, schema, root, &format!("{at}.{key}"), problems);
                    }
                }
                true
            }
            "additionalProperties" => {
                let known = schema.get("properties");
                for (key, value) in value.as_object().into_iter().flatten() {
                    if known.is_none_or(|known| known.get(key).is_none()) {
                        check(value, asked, root, &format!("{at}.{key}"), problems);
                    }
                }
                true
            }
            other => panic!("the schema has {other}, which this validator does not know"),
        };
        if !is_good {
            problems.push(format!("{at}: {value} does not fit {key} {asked}"));
        }
    }
}

fn is_of(value: &Value, kind: &Value) -> bool {
    match kind.as_str().expect("the name of a type") {
        "null" => value.is_null(),
        "boolean" => value.is_boolean(),
        "integer" => value.as_f64().is_some_and(|number| number.fract() == 0.0),
        "number" => value.is_number(),
        "string" => value.is_string(),
        "array" => value.is_array(),
        "object" => value.is_object(),
        other => panic!("there is no type {other}"),
    }
}

/// Returns true also if a value is no number.
fn is_ordered(low: &Value, high: &Value) -> bool {
    low.as_f64().zip(high.as_f64()).is_none_or(|(low, high)| low <= high)
}

/// Matches the patterns in use, without a general regex engine.
fn fits(text: &str, pattern: &str) -> bool {
    let number = |text: &str| {
        let rest = text.strip_prefix(['-', '+']).unwrap_or(text);
        rest.strip_prefix('.').unwrap_or(rest).starts_with(|c: char| c.is_ascii_digit())
    };
    match pattern {
        WHOLE => text
            .strip_prefix("0x")
            .or(text.strip_prefix("0o"))
            .is_some_and(|digits| !digits.is_empty() && digits.bytes().all(|byte| byte.is_ascii_hexdigit())),
        NUMBER => number(text) && text.bytes().all(|byte| byte.is_ascii_digit() || b"-+.eE/".contains(&byte)),
        QUANTITY => number(text.trim_start()),
        other => panic!("there is no pattern {other}"),
    }
}
