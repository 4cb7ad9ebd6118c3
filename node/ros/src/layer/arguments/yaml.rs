//! YAML like rcl: plain scalars have parameter types, lists have one type, aliases are refused.

use std::collections::HashSet;

use lineshaft_msgs::foreign::rcl_interfaces::msg::{ParameterType, ParameterValue};
use saphyr_parser::{Event, Marker, Parser, ScalarStyle};

/// Maximum size of a file, in bytes, and maximum nesting.
pub(super) const LONGEST: u64 = 4 << 20;
const DEEPEST: usize = 64;

/// Error with its place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct YamlError {
    pub(super) line: usize,
    pub(super) column: usize,
    pub(super) sentence: String,
}

/// Scalar as written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Scalar {
    pub(super) text: String,
    /// Whether it is in quotes, a block, or tagged as a string.
    is_string: bool,
    pub(super) line: usize,
    pub(super) column: usize,
}

impl Scalar {
    pub(super) fn wrong(&self, sentence: impl Into<String>) -> YamlError {
        YamlError { line: self.line, column: self.column, sentence: sentence.into() }
    }

    /// Returns the value with the type that rcl gives it.
    fn value(&self) -> Result<ParameterValue, YamlError> {
        let (text, value) = (self.text.as_str(), ParameterValue::default());
        if self.is_string {
            return Ok(ParameterValue {
                r#type: ParameterType::PARAMETER_STRING,
                string_value: self.text.clone(),
                ..value
            });
        }
        match text {
            "" => return Err(self.wrong("a parameter has no value here")),
            // `ros2 param dump` writes this for a parameter without a value.
            "~" | "null" | "Null" | "NULL" => return Ok(value),
            "y" | "Y" | "yes" | "Yes" | "YES" | "true" | "True" | "TRUE" | "on" | "On" | "ON" => {
                return Ok(ParameterValue { r#type: ParameterType::PARAMETER_BOOL, bool_value: true, ..value });
            }
            "n" | "N" | "no" | "No" | "NO" | "false" | "False" | "FALSE" | "off" | "Off" | "OFF" => {
                return Ok(ParameterValue { r#type: ParameterType::PARAMETER_BOOL, ..value });
            }
            _ => {}
        }
        if has_leading_zero(text) {
            return Err(
                self.wrong(format!("{text} begins with 0, which means base 8 to ROS; write it without, or in quotes"))
            );
        }
        if let Some(integer_value) = integer(text) {
            return Ok(ParameterValue { r#type: ParameterType::PARAMETER_INTEGER, integer_value, ..value });
        }
        if let Some(double_value) = double(text) {
            return Ok(ParameterValue { r#type: ParameterType::PARAMETER_DOUBLE, double_value, ..value });
        }
        Ok(ParameterValue { r#type: ParameterType::PARAMETER_STRING, string_value: self.text.clone(), ..value })
    }
}

fn has_leading_zero(text: &str) -> bool {
    let digits = text.trim_start_matches(['+', '-']);
    digits.len() > 1 && digits.starts_with('0') && digits.bytes().all(|byte| byte.is_ascii_digit())
}

fn integer(text: &str) -> Option<i64> {
    let (is_negative, digits) = match text.strip_prefix('-') {
        Some(digits) => (true, digits),
        None => (false, text.strip_prefix('+').unwrap_or(text)),
    };
    let size = match digits.strip_prefix("0x").or_else(|| digits.strip_prefix("0X")) {
        Some(hex) if hex.bytes().all(|byte| byte.is_ascii_hexdigit()) => i128::from_str_radix(hex, 16).ok()?,
        _ if digits.bytes().all(|byte| byte.is_ascii_digit()) => digits.parse().ok()?,
        _ => return None,
    };
    i64::try_from(if is_negative { -size } else { size }).ok()
}

fn double(text: &str) -> Option<f64> {
    match text {
        ".nan" | ".NaN" | ".NAN" => return Some(f64::NAN),
        ".inf" | ".Inf" | ".INF" | "+.inf" | "+.Inf" | "+.INF" => return Some(f64::INFINITY),
        "-.inf" | "-.Inf" | "-.INF" => return Some(f64::NEG_INFINITY),
        _ => {}
    }
    // Words such as `inf` or `nan` are not numbers.
    let is_number = text.bytes().all(|byte| byte.is_ascii_digit() || b"+-.eE".contains(&byte));
    if is_number { text.parse().ok() } else { None }
}

/// YAML value with its content.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Yaml {
    Scalar(Scalar),
    List(Scalar, Vec<Yaml>),
    /// Entries in file order, with unique keys.
    Map(Scalar, Vec<(Scalar, Yaml)>),
}

impl Yaml {
    /// Returns the place where the value begins.
    fn place(&self) -> &Scalar {
        match self {
            Self::Scalar(place) | Self::List(place, _) | Self::Map(place, _) => place,
        }
    }

    pub(super) fn is_map(&self) -> bool {
        matches!(self, Self::Map(..))
    }

    pub(super) fn map(&self, expected: &str) -> Result<&[(Scalar, Self)], YamlError> {
        match self {
            Self::Map(_, entries) => Ok(entries),
            _ => Err(self.place().wrong(format!("{expected} expected here"))),
        }
    }

    /// Returns the value as a parameter value.
    pub(super) fn value(&self) -> Result<ParameterValue, YamlError> {
        match self {
            Self::Scalar(scalar) => scalar.value(),
            Self::Map(place, _) => Err(place.wrong("a mapping is no value of a parameter")),
            Self::List(_, items) => list(items),
        }
    }
}

fn list(items: &[Yaml]) -> Result<ParameterValue, YamlError> {
    let mut array = ParameterValue { r#type: ParameterType::PARAMETER_BYTE_ARRAY, ..ParameterValue::default() };
    for item in items {
        let Yaml::Scalar(scalar) = item else {
            return Err(item.place().wrong("a list of a parameter has bools, numbers or strings in it"));
        };
        let value = scalar.value()?;
        if value.r#type == ParameterType::PARAMETER_NOT_SET {
            return Err(scalar.wrong(format!("{} is no value in a list; write it in quotes for a string", scalar.text)));
        }
        let kind = match value.r#type {
            ParameterType::PARAMETER_BOOL => ParameterType::PARAMETER_BOOL_ARRAY,
            ParameterType::PARAMETER_INTEGER => ParameterType::PARAMETER_INTEGER_ARRAY,
            ParameterType::PARAMETER_DOUBLE => ParameterType::PARAMETER_DOUBLE_ARRAY,
            _ => ParameterType::PARAMETER_STRING_ARRAY,
        };
        if array.r#type != ParameterType::PARAMETER_BYTE_ARRAY && array.r#type != kind {
            let sentence = format!("{} is of another type than what stands before it in the list", scalar.text);
            return Err(scalar.wrong(sentence + "; 1 is whole, 1.0 is not, and strings like y need quotes"));
        }
        array.r#type = kind;
        match kind {
            ParameterType::PARAMETER_BOOL_ARRAY => array.bool_array_value.push(value.bool_value),
            ParameterType::PARAMETER_INTEGER_ARRAY => array.integer_array_value.push(value.integer_value),
            ParameterType::PARAMETER_DOUBLE_ARRAY => array.double_array_value.push(value.double_value),
            _ => array.string_array_value.push(value.string_value),
        }
    }
    Ok(array)
}

/// Lists and mappings that are not closed yet.
enum OpenCollection {
    List(Scalar, Vec<Yaml>),
    Map(Scalar, Vec<(Scalar, Yaml)>, Option<Scalar>),
}

/// Parses one document; an empty document is an empty text.
pub(super) fn parse(text: &str) -> Result<Yaml, YamlError> {
    let mut parser = Parser::new_from_str(text.strip_prefix('\u{feff}').unwrap_or(text));
    let (mut open, mut root) = (Vec::new(), None);
    while let Some(event) = parser.next_event() {
        let (event, place) = match event {
            Ok((event, span)) => (event, place(span.start)),
            Err(error) => return Err(place(*error.marker()).wrong(format!("this is not YAML: {}", error.info()))),
        };
        let done = match event {
            Event::Scalar(text, style, _, tag) => {
                let is_tagged = tag.is_some_and(|tag| tag.is_yaml_core_schema() && tag.suffix == "str");
                let is_string = style != ScalarStyle::Plain || is_tagged;
                Yaml::Scalar(Scalar { text: text.into_owned(), is_string, ..place })
            }
            Event::SequenceStart(..) | Event::MappingStart(..) if open.len() >= DEEPEST => {
                return Err(place.wrong(format!("lists and mappings are nested deeper than {DEEPEST} levels")));
            }
            Event::SequenceStart(..) => {
                open.push(OpenCollection::List(place, Vec::new()));
                continue;
            }
            Event::MappingStart(..) => {
                open.push(OpenCollection::Map(place, Vec::new(), None));
                continue;
            }
            Event::SequenceEnd | Event::MappingEnd => match open.pop() {
                Some(OpenCollection::List(place, items)) => Yaml::List(place, items),
                Some(OpenCollection::Map(place, entries, _)) => Yaml::Map(place.clone(), each_once(entries)?),
                None => continue,
            },
            Event::Alias(_) => return Err(place.wrong("aliases are not read in parameters; write the value again")),
            Event::DocumentStart(_) if root.is_some() => return Err(place.wrong("a second document starts here")),
            _ => continue,
        };
        match open.last_mut() {
            None => root = Some(done),
            Some(OpenCollection::List(_, items)) => items.push(done),
            Some(OpenCollection::Map(_, entries, key)) => match (key.take(), done) {
                (None, Yaml::Scalar(scalar)) => *key = Some(scalar),
                (None, other) => return Err(other.place().wrong("a key is a text")),
                (Some(key), value) => entries.push((key, value)),
            },
        }
    }
    Ok(root.unwrap_or_else(|| Yaml::Scalar(Scalar { text: String::new(), is_string: false, line: 1, column: 1 })))
}

fn each_once(entries: Vec<(Scalar, Yaml)>) -> Result<Vec<(Scalar, Yaml)>, YamlError> {
    let mut seen = HashSet::new();
    match entries.iter().find(|(key, _)| !seen.insert(key.text.clone())) {
        Some((key, _)) => Err(key.wrong(format!("duplicate key `{}`", key.text))),
        None => Ok(entries),
    }
}

fn place(marker: Marker) -> Scalar {
    Scalar { text: String::new(), is_string: false, line: marker.line().max(1), column: marker.col() + 1 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(text: &str) -> ParameterValue {
        parse(text).and_then(|yaml| yaml.value()).unwrap_or_else(|wrong| panic!("{text}: {}", wrong.sentence))
    }

    fn refused(text: &str) -> String {
        parse(text).and_then(|yaml| yaml.value()).unwrap_err().sentence
    }

    #[test]
    fn scalars_have_the_types_of_rcl() {
        let bool = |text| Some(value(text)).filter(|v| v.r#type == 1).map(|v| v.bool_value);
        for word in ["y", "Yes", "true", "TRUE", "on"] {
            assert_eq!(bool(word), Some(true), "{word}");
        }
        for word in ["n", "No", "false", "False", "OFF"] {
            assert_eq!(bool(word), Some(false), "{word}");
        }
        let int = |text| Some(value(text)).filter(|v| v.r#type == 2).map(|v| v.integer_value);
        for (text, number) in [
            ("1", 1),
            ("-7", -7),
            ("+3", 3),
            ("0", 0),
            ("0x1F", 31),
            ("-0x10", -16),
            ("9223372036854775807", i64::MAX),
            ("-9223372036854775808", i64::MIN),
        ] {
            assert_eq!(int(text), Some(number), "{text}");
        }
        let double = |text| Some(value(text)).filter(|v| v.r#type == 3).map(|v| v.double_value);
        for (text, number) in [
            ("1.0", 1.0),
            ("-.5", -0.5),
            ("5.", 5.0),
            ("1e3", 1000.0),
            ("1E-3", 0.001),
            (".inf", f64::INFINITY),
            ("-.inf", f64::NEG_INFINITY),
            ("9223372036854775808", 9223372036854775808.0),
            ("0.50", 0.5),
        ] {
            assert_eq!(double(text), Some(number), "{text}");
        }
        assert!(double(".nan").unwrap().is_nan());
        let string = |text| Some(value(text)).filter(|v| v.r#type == 4).map(|v| v.string_value);
        for (text, inside) in [
            ("jerk", "jerk"),
            ("'1'", "1"),
            ("\"true\"", "true"),
            ("!!str 1", "1"),
            ("''", ""),
            ("nan", "nan"),
            ("1 m", "1 m"),
            ("0x", "0x"),
            ("1.2.3", "1.2.3"),
            ("e", "e"),
            ("-", "-"),
            ("/a/b", "/a/b"),
            ("1_000", "1_000"),
        ] {
            // A single dash begins a list.
            if text != "-" {
                assert_eq!(string(text).as_deref(), Some(inside), "{text}");
            }
        }
    }

    #[test]
    fn lists_are_of_one_type() {
        assert_eq!(value("[1, 2]").integer_array_value, [1, 2]);
        assert_eq!(value("[1.0, 2.5]").double_array_value, [1.0, 2.5]);
        assert_eq!(value("[true, no]").bool_array_value, [true, false]);
        assert_eq!(value("[x, 'y']").string_array_value, ["x", "y"]);
        assert_eq!((value("[]").r#type, value("[1]").r#type), (5, 7));
        for mixed in ["[1, 2.0]", "[x, y]", "[true, 1]"] {
            assert!(refused(mixed).contains("another type"), "{mixed}");
        }
        assert!(refused("[[1]]").contains("bools, numbers or strings"));
    }

    #[test]
    fn what_is_no_value_is_refused() {
        assert_eq!(refused(""), "a parameter has no value here");
        for nothing in ["~", "null", "Null", "NULL"] {
            assert_eq!(value(nothing), ParameterValue::default(), "{nothing}");
        }
        assert_eq!(refused("[null]"), "null is no value in a list; write it in quotes for a string");
        assert!(refused("010").starts_with("010 begins with 0"));
        assert!(refused("-01").starts_with("-01 begins with 0"));
        assert!(refused("{a: 1}").starts_with("a mapping"));
        assert!(refused("[1").starts_with("this is not YAML"));
        assert!(refused("&a [1, *a]").starts_with("aliases"));
        assert!(refused("{a: 1, a: 2}").contains("duplicate key"));
        let deep = "[".repeat(DEEPEST + 1);
        assert!(!refused(&deep).is_empty());
    }
}
