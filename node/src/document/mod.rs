//! Reads YAML documents and reports all their errors at once, each with file, line and column.
//!
//! [`Document`] has the tree of a file with the location of every value and every scalar as written, so that the reader
//! of a key decides the meaning of `1 ms`, `1e3` or `yes`. [`Value`] and [`Map`] read it: a reader that finds a wrong
//! value reports a [`Problem`] and returns `None`, so that reading continues with the next key.
//!
//! ```
//! use lineshaft::document::{Allowed, Document};
//! use lineshaft_core::unit::Dimension;
//!
//! let document = Document::parse("cell.yaml", "cycle: 1 m\nbits: 70\nautostrat: true\n");
//! if let Some(mut cell) = document.root("the cell").and_then(|root| root.map("the cell")) {
//!     let cycle = cell.required("cycle").and_then(|v| v.quantity(&[Dimension::Time], &Allowed::Positive));
//!     let bits = cell.optional("bits").and_then(|v| v.integer(1..=64_u8));
//!     let autostart = cell.optional("autostart").and_then(|v| v.boolean());
//!     cell.finish();
//!     assert_eq!((cycle, bits, autostart), (None, None, None));
//! }
//! assert_eq!(
//!     document.problems().to_string(),
//!     "cell.yaml:1:8: cycle: `1 m` is a length; a time such as `1 s` is expected\n\
//!      cell.yaml:2:7: bits is 70; 1..64 is allowed\n\
//!      cell.yaml:3:1: unknown key `autostrat` in the cell, did you mean `autostart`?\n"
//! );
//! ```
//!
//! No other module uses the YAML parser.

mod bare;
mod brackets;
mod edit;
mod map;
#[cfg(test)]
mod observer;
mod parse;
mod problem;
mod syntax;
mod value;

pub use edit::{Fixed, Source};
pub use map::Map;
#[cfg(test)]
pub(crate) use observer::{ExpectedKind, Observer, Seen};
pub use problem::{Place, Problem, Problems};
pub(crate) use value::unit_of_bare;
pub use value::{Allowed, Value};

use lineshaft_ros::layer::open_file;
use std::io::Read;
use std::path::Path;

/// Maximum size of a document, in bytes.
pub const MAX_BYTES: usize = 4 << 20;
/// Maximum nesting of lists and mappings.
pub const MAX_DEPTH: usize = 64;
/// Maximum number of values in a document.
pub const MAX_VALUES: usize = 250_000;
/// Limits for files that users write.
const USUAL: Most = Most { bytes: MAX_BYTES, values: MAX_VALUES };
/// Limits for a command in a recording, and for a planned trajectory: the longest trajectory and the longest table fit.
const LONG: Most = Most { bytes: 32 << 20, values: 4_000_000 };

/// Limits of a document.
#[derive(Clone, Copy, Debug)]
struct Most {
    bytes: usize,
    values: usize,
}

/// A YAML file: its text, its tree if it has one, and the problems found so far.
#[derive(Debug)]
pub struct Document {
    text: String,
    root: Option<Node>,
    problems: Problems,
}

impl Document {
    /// Reads a file. Its problems are in [`Document::problems`].
    pub fn read(path: &Path) -> Self {
        Self::read_within(path, USUAL)
    }

    /// Does the same as [`Document::read`] for a planned trajectory, which may be longer.
    pub fn read_long(path: &Path) -> Self {
        Self::read_within(path, LONG)
    }

    fn read_within(path: &Path, most: Most) -> Self {
        let name = path.display().to_string();
        let mut bytes = Vec::new();
        let read = open_file(path).and_then(|file| file.take(most.bytes as u64 + 1).read_to_end(&mut bytes));
        let failed = |place, sentence: String| {
            let problems = Problems::new(&name);
            problems.push(place, sentence, None);
            Self { text: String::new(), root: None, problems }
        };
        if let Err(error) = read {
            return failed(Place::START, format!("cannot read the file: {error}"));
        }
        match String::from_utf8(bytes) {
            Ok(text) => Self::parse_within(&name, text, most),
            Err(error) if error.as_bytes().len() > most.bytes => failed(Place::START, too_long(most.bytes)),
            Err(error) => {
                let valid = &error.as_bytes()[..error.utf8_error().valid_up_to()];
                failed(Place::after(&String::from_utf8_lossy(valid)), "the file is not UTF-8 text".to_owned())
            }
        }
    }

    /// Parses a text; `name` is the file name in problems.
    pub fn parse(name: &str, text: impl Into<String>) -> Self {
        Self::parse_within(name, text.into(), USUAL)
    }

    /// Does the same as [`Document::parse`] for a command in a recording, which may be longer.
    pub fn parse_recorded(name: &str, text: impl Into<String>) -> Self {
        Self::parse_within(name, text.into(), LONG)
    }

    fn parse_within(name: &str, text: String, most: Most) -> Self {
        let problems = Problems::new(name);
        let root = if text.len() > most.bytes {
            problems.push(Place::START, too_long(most.bytes), None);
            None
        } else {
            parse::tree(&text, &problems, most.values)
        };
        Self { text, root, problems }
    }

    /// Adds an entry to the top-level mapping, as if it were in the text; for values that are given separately. An
    /// existing key must have the same value.
    pub fn put(&mut self, key: &str, text: &str) {
        let Some(entries) = self.entries() else { return };
        let scalar = |text: &str| Node::text_at(Place::START, text);
        let Some((_, value)) = entries.iter().find(|(known, _)| known.text() == key) else {
            return entries.push((scalar(key), scalar(text)));
        };
        // A value that is no text is refused by its reader.
        if !value.text().is_empty() && value.text() != text {
            let (place, given) = (value.place, problem::quote(value.text()));
            let sentence = format!("{key} is {given}; {} was given beside", problem::quote(text));
            self.problems.push(place, sentence, Some("leave it out".to_owned()));
        }
    }

    /// Adds `prefix` to each key of the top-level mapping.
    pub fn put_before_keys(&mut self, prefix: &str) {
        for (key, _) in self.entries().into_iter().flatten() {
            *key = Node::text_at(key.place, &format!("{prefix}{}", key.text()));
        }
    }

    /// Returns the entries of the top-level mapping; an empty document becomes one.
    fn entries(&mut self) -> Option<&mut Vec<(Node, Node)>> {
        let root = self.root.as_mut()?;
        if root.is_null() {
            root.kind = Kind::Map(Vec::new());
        }
        match &mut root.kind {
            Kind::Map(entries) => Some(entries),
            _ => None,
        }
    }

    /// Returns the value of the whole document, called `label` in problems; `None` if it could not be read.
    pub fn root(&self, label: &str) -> Option<Value<'_>> {
        self.root.as_ref().map(|node| Value::new(node, label.to_owned(), &self.problems))
    }

    /// Returns the document as an editor interprets it: numbers, `true` and `null` by the core schema of YAML 1.2.
    #[cfg(test)]
    pub(crate) fn json(&self) -> serde_json::Value {
        self.root.as_ref().map_or(serde_json::Value::Null, observer::json)
    }

    /// Returns the text as it was read.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Returns the problems found so far.
    pub fn problems(&self) -> &Problems {
        &self.problems
    }

    /// Returns the problems after reading.
    pub fn into_problems(self) -> Problems {
        self.problems
    }
}

fn too_long(most: usize) -> String {
    format!("the file is longer than {most} bytes")
}

/// A value of the tree, and its location.
#[derive(Clone, Debug)]
struct Node {
    place: Place,
    kind: Kind,
}

#[derive(Clone, Debug)]
enum Kind {
    /// Text as written; `quoted` is true for block scalars, too.
    Scalar {
        text: String,
        quoted: bool,
    },
    List(Vec<Node>),
    /// Entries in the order of the file; every key is a scalar and occurs once.
    Map(Vec<(Node, Node)>),
}

impl Node {
    /// Returns a text that is no number, even if a number is expected.
    fn text_at(place: Place, text: &str) -> Self {
        Self { place, kind: Kind::Scalar { text: text.to_owned(), quoted: true } }
    }

    /// Returns true for an empty value, `~` and `null`.
    fn is_null(&self) -> bool {
        matches!(&self.kind, Kind::Scalar { text, quoted: false } if matches!(text.as_str(), "" | "~" | "null" | "Null" | "NULL"))
    }

    /// Returns the text of a scalar, otherwise an empty text.
    fn text(&self) -> &str {
        match &self.kind {
            Kind::Scalar { text, .. } => text,
            Kind::List(_) | Kind::Map(_) => "",
        }
    }
}

#[cfg(test)]
mod tests;
