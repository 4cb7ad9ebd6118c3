//! Parser of .msg, .srv and .action files.
//!
//! Stricter than ROS 2: every constant and field must have a comment, because it becomes documentation. Features that
//! the files of this package do not use (default values, wide strings, constants that are no integers) are rejected.

use crate::interface::{Constant, Element, Field, Interface, Kind, Primitive, Section, Shape};

/// A rejected line, with the reason.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Refusal {
    /// Line number, from 1.
    pub(crate) line: usize,
    pub(crate) reason: String,
}

/// Maximum length of arrays in serde.
const LONGEST_ARRAY: usize = 32;

/// Parses the text of one file.
pub(crate) fn parse(package: &str, kind: Kind, name: &str, text: &str) -> Result<Interface, Refusal> {
    if !is_type_name(name) {
        return Err(Refusal { line: 1, reason: format!("type name {name}: letters and digits, a capital first") });
    }
    let mut sections = vec![Reader::default()];
    for (index, line) in text.lines().enumerate() {
        if line.trim_end() == "---" {
            sections.push(Reader::default());
            continue;
        }
        if let Some(reader) = sections.last_mut() {
            reader.line(package, line).map_err(|reason| Refusal { line: index + 1, reason })?;
        }
    }
    let expected = kind.sections().len();
    if sections.len() != expected {
        let reason = format!("{} sections, a .{} file has {expected}", sections.len(), kind.name());
        return Err(Refusal { line: text.lines().count(), reason });
    }
    let sections = sections.into_iter().map(Reader::finish).collect();
    Ok(Interface { package: package.to_owned(), kind, name: name.to_owned(), sections })
}

/// Parser of the lines of one section.
#[derive(Default)]
struct Reader {
    section: Section,
    /// Comment lines that do not belong to a field yet.
    comment: Vec<String>,
}

impl Reader {
    fn line(&mut self, package: &str, line: &str) -> Result<(), String> {
        self.section.text.push_str(line);
        self.section.text.push('\n');
        let (declaration, comment) = match line.split_once('#') {
            Some((declaration, comment)) => (declaration.trim(), Some(comment.trim())),
            None => (line.trim(), None),
        };
        if declaration.is_empty() {
            match comment {
                Some(comment) => self.comment.push(comment.to_owned()),
                None => self.blank(),
            }
            return Ok(());
        }
        let mut doc = std::mem::take(&mut self.comment);
        doc.extend(comment.map(str::to_owned));
        if doc.is_empty() {
            return Err(format!("{declaration} has no comment above it or behind it"));
        }
        self.declaration(package, declaration, doc)
    }

    /// A comment block before a blank line belongs to the section if it is the first item in it.
    fn blank(&mut self) {
        let comment = std::mem::take(&mut self.comment);
        let section = &mut self.section;
        if section.doc.is_empty() && section.fields.is_empty() && section.constants.is_empty() {
            section.doc = comment;
        }
    }

    fn declaration(&mut self, package: &str, declaration: &str, doc: Vec<String>) -> Result<(), String> {
        let (type_text, rest) =
            declaration.split_once(char::is_whitespace).ok_or_else(|| format!("{declaration} is no TYPE NAME"))?;
        let (element, shape) = parse_type(package, type_text)?;
        if let Some((name, value)) = rest.split_once('=') {
            let (name, value) = (name.trim(), value.trim());
            let constant = constant(element, shape, name, value, doc)?;
            self.unique(&constant.name)?;
            self.section.constants.push(constant);
            return Ok(());
        }
        let name = rest.trim();
        if name.contains(char::is_whitespace) {
            return Err(format!("{declaration}: one name to a line, and no default value"));
        }
        if !is_field_name(name) {
            return Err(format!("field {name}: small letters, digits and single _, a letter first and no _ last"));
        }
        self.unique(name)?;
        let (type_text, name) = (type_text.to_owned(), name.to_owned());
        self.section.fields.push(Field { doc, type_text, element, shape, name });
        Ok(())
    }

    fn unique(&self, name: &str) -> Result<(), String> {
        let section = &self.section;
        let constants = section.constants.iter().map(|constant| &constant.name);
        let taken = constants.chain(section.fields.iter().map(|field| &field.name)).any(|other| other == name);
        if taken { Err(format!("{name} stands twice")) } else { Ok(()) }
    }

    fn finish(mut self) -> Section {
        // For a section that contains only a comment.
        self.blank();
        self.section
    }
}

fn constant(element: Element, shape: Shape, name: &str, value: &str, doc: Vec<String>) -> Result<Constant, String> {
    let (Element::Primitive(primitive), Shape::One) = (element, shape) else {
        return Err(format!("constant {name}: of an integer type only"));
    };
    let Some((low, high)) = primitive.range else {
        return Err(format!("constant {name}: of an integer type only, not {}", primitive.name));
    };
    if !is_constant_name(name) {
        return Err(format!("constant {name}: capital letters, digits and single _, a letter first and no _ last"));
    }
    let value: i128 = value.parse().map_err(|_| format!("constant {name}: {value} is no whole number"))?;
    if !(low..=high).contains(&value) {
        return Err(format!("constant {name}: {value} is not within {low}..{high} of {}", primitive.name));
    }
    Ok(Constant { doc, primitive, name: name.to_owned(), value })
}

/// `TYPE`, `TYPE[N]`, `TYPE[]` or `TYPE[<=N]`.
fn parse_type(package: &str, text: &str) -> Result<(Element, Shape), String> {
    let Some((element, shape)) = text.split_once('[') else {
        return Ok((parse_element(package, text)?, Shape::One));
    };
    let inner = shape.strip_suffix(']').ok_or_else(|| format!("type {text}: no ] at its end"))?;
    let shape = match (inner, inner.strip_prefix("<=")) {
        ("", _) => Shape::Sequence,
        (_, Some(bound)) => Shape::Bounded(parse_length(text, bound)?),
        (length, None) => match parse_length(text, length)? {
            length if length <= LONGEST_ARRAY => Shape::Array(length),
            length => return Err(format!("type {text}: {length} elements, at most {LONGEST_ARRAY} are supported")),
        },
    };
    Ok((parse_element(package, element)?, shape))
}

fn parse_element(package: &str, text: &str) -> Result<Element, String> {
    if let Some(primitive) = Primitive::named(text) {
        return Ok(Element::Primitive(primitive));
    }
    if text == "string" {
        return Ok(Element::Text(None));
    }
    if let Some(bound) = text.strip_prefix("string<=") {
        return Ok(Element::Text(Some(parse_length(text, bound)?)));
    }
    let (package, name) = text.split_once('/').unwrap_or((package, text));
    if is_field_name(package) && is_type_name(name) {
        return Ok(Element::Message { package: package.to_owned(), name: name.to_owned() });
    }
    Err(format!("type {text} is not known"))
}

fn parse_length(text: &str, length: &str) -> Result<usize, String> {
    match length.parse() {
        Ok(length) if length > 0 => Ok(length),
        _ => Err(format!("type {text}: {length} is no length from 1 on")),
    }
}

fn is_type_name(name: &str) -> bool {
    name.starts_with(|c: char| c.is_ascii_uppercase()) && name.chars().all(|c| c.is_ascii_alphanumeric())
}

fn is_field_name(name: &str) -> bool {
    is_snake(name, |c| c.is_ascii_lowercase())
}

fn is_constant_name(name: &str) -> bool {
    is_snake(name, |c| c.is_ascii_uppercase())
}

fn is_snake(name: &str, is_letter: fn(char) -> bool) -> bool {
    name.starts_with(is_letter)
        && name.chars().all(|c| is_letter(c) || c.is_ascii_digit() || c == '_')
        && !name.ends_with('_')
        && !name.contains("__")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(text: &str) -> Result<Interface, Refusal> {
        parse("pkg", Kind::Msg, "Thing", text)
    }

    #[test]
    fn comments_go_to_the_section_and_to_the_declaration_below_or_before_them() {
        let text = "# Head,\n# two lines.\n\n# The one.\nuint8 ONE=1 # really\n\n\
                    # First.\nfloat64 first\n# Lost.\n\nint8 x # X.\n";
        let thing = message(text).unwrap();
        let section = &thing.sections[0];
        assert_eq!(section.doc, ["Head,", "two lines."]);
        assert_eq!(section.constants[0].doc, ["The one.", "really"]);
        assert_eq!((section.constants[0].name.as_str(), section.constants[0].value), ("ONE", 1));
        assert_eq!(section.fields[0].doc, ["First."]);
        assert_eq!(section.fields[1].doc, ["X."]);
        assert_eq!(section.text, text);
    }

    #[test]
    fn every_form_of_type_is_read() {
        let types = ["bool", "uint8[16]", "string[]", "string<=256", "other/Time", "pkg/Own[<=1]"];
        let text: String = types.iter().enumerate().map(|(i, t)| format!("{t} field{i} # .\n")).collect();
        let thing = message(&text).unwrap();
        let read: Vec<String> = thing.sections[0].fields.iter().map(Field::type_text).collect();
        assert_eq!(read, types);
        let own = message("Own own # .\n").unwrap();
        assert_eq!(own.sections[0].fields[0].type_text(), "pkg/Own");
    }

    #[test]
    fn sections_are_counted() {
        let action = parse("pkg", Kind::Action, "Go", "# Goes.\n---\n---\n# How far.\n\nint64 way # [m]\n").unwrap();
        assert_eq!(action.sections[0].doc, ["Goes."]);
        assert!(action.sections[1].fields.is_empty());
        assert_eq!(action.sections[2].doc, ["How far."]);
        let refusal = parse("pkg", Kind::Srv, "Go", "# Goes.\n").unwrap_err();
        assert_eq!(refusal.reason, "1 sections, a .srv file has 2");
    }

    #[test]
    fn refusals_name_the_line_and_the_reason() {
        let cases = [
            ("int8 x\n", "int8 x has no comment above it or behind it"),
            ("int8 x y # .\n", "int8 x y: one name to a line, and no default value"),
            ("bool x false # .\n", "bool x false: one name to a line, and no default value"),
            ("int8 # .\n", "int8 is no TYPE NAME"),
            ("int8 Xy # .\n", "field Xy: small letters, digits and single _, a letter first and no _ last"),
            ("int8 x_ # .\n", "field x_: small letters, digits and single _, a letter first and no _ last"),
            ("int8 x # .\n", "x stands twice"),
            ("int9 z # .\n", "type int9 is not known"),
            ("uint8 z=3 # .\n", "constant z: capital letters, digits and single _, a letter first and no _ last"),
            ("uint8 BIG=256 # .\n", "constant BIG: 256 is not within 0..255 of uint8"),
            ("int8 LOW=-129 # .\n", "constant LOW: -129 is not within -128..127 of int8"),
            ("uint8 A=b # .\n", "constant A: b is no whole number"),
            ("float64 A=1 # .\n", "constant A: of an integer type only, not float64"),
            ("string A=b # .\n", "constant A: of an integer type only"),
            ("uint8[33] z # .\n", "type uint8[33]: 33 elements, at most 32 are supported"),
            ("uint8[0] z # .\n", "type uint8[0]: 0 is no length from 1 on"),
            ("uint8[<=] z # .\n", "type uint8[<=]:  is no length from 1 on"),
            ("uint8[3 z # .\n", "type uint8[3: no ] at its end"),
        ];
        for (line, reason) in cases {
            let refusal = message(&format!(
                "int8 first # .\nint8 {} # .\n{line}",
                if reason.starts_with("x ") { "x" } else { "q" }
            ))
            .unwrap_err();
            assert_eq!(refusal, Refusal { line: 3, reason: reason.to_owned() });
        }
        assert!(parse("pkg", Kind::Msg, "thing", "").is_err());
    }
}
