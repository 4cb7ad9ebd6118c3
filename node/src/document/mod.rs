//! YAML documents that report all their errors at once, each with file, line and column.
//!
//! [`Document`] holds the tree of a file with the place of every value and every scalar as it was written, so that the
//! reader of a key decides what `1 ms`, `1e3` or `yes` means there. [`Value`] and [`Map`] read it: a reader that cannot
//! return what is asked for notes a [`Problem`] and returns `None`, so that the reading goes on with the next key.
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
//! No other room knows the YAML parser.

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
pub(crate) use observer::{Asked, Observer, Seen};
pub use problem::{Place, Problem, Problems};
pub(crate) use value::unit_of_bare;
pub use value::{Allowed, Value};

use lineshaft_ros::layer::open_file;
use std::io::Read;
use std::path::Path;

/// Longest document (bytes).
pub const MAX_BYTES: usize = 4 << 20;
/// Deepest nesting of lists and mappings.
pub const MAX_DEPTH: usize = 64;
/// Most values in a document.
pub const MAX_VALUES: usize = 250_000;
/// What a file of people may hold.
const USUAL: Most = Most { bytes: MAX_BYTES, values: MAX_VALUES };
/// The same of a command in a recording, and of a planned trajectory: the longest trajectory and the longest table have a place in it.
const LONG: Most = Most { bytes: 32 << 20, values: 4_000_000 };

/// How much a document may hold.
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
    /// Reads a file. What is wrong with it is in [`Document::problems`].
    pub fn read(path: &Path) -> Self {
        Self::read_within(path, USUAL)
    }

    /// As [`Document::read`], for a planned trajectory, which may be longer.
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

    /// Parses a text; `name` stands for the file in problems.
    pub fn parse(name: &str, text: impl Into<String>) -> Self {
        Self::parse_within(name, text.into(), USUAL)
    }

    /// As [`Document::parse`], for a command in a recording, which may be longer.
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

    /// Puts an entry into the mapping that the document is, as if it stood there: what was given beside the text. A key that
    /// stands there has to say the same.
    pub fn put(&mut self, key: &str, text: &str) {
        let Some(entries) = self.entries() else { return };
        let scalar = |text: &str| Node::text_at(Place::START, text);
        let Some((_, value)) = entries.iter().find(|(known, _)| known.text() == key) else {
            return entries.push((scalar(key), scalar(text)));
        };
        // What is no text is refused by who reads it.
        if !value.text().is_empty() && value.text() != text {
            let (place, given) = (value.place, problem::quote(value.text()));
            let sentence = format!("{key} is {given}; {} was given beside", problem::quote(text));
            self.problems.push(place, sentence, Some("leave it out".to_owned()));
        }
    }

    /// Puts `prefix` before each key of the mapping that the document is.
    pub fn put_before_keys(&mut self, prefix: &str) {
        for (key, _) in self.entries().into_iter().flatten() {
            *key = Node::text_at(key.place, &format!("{prefix}{}", key.text()));
        }
    }

    /// The entries of the mapping that the document is; an empty document becomes one.
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

    /// The value of the whole document, called `label` in problems; `None` when it could not be read.
    pub fn root(&self, label: &str) -> Option<Value<'_>> {
        self.root.as_ref().map(|node| Value::new(node, label.to_owned(), &self.problems))
    }

    /// The document as an editor sees it: numbers, `true` and `null` by the core schema of YAML 1.2.
    #[cfg(test)]
    pub(crate) fn json(&self) -> serde_json::Value {
        self.root.as_ref().map_or(serde_json::Value::Null, observer::json)
    }

    /// The text as it was read.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// What is wrong, so far.
    pub fn problems(&self) -> &Problems {
        &self.problems
    }

    /// What is wrong, when the reading is over.
    pub fn into_problems(self) -> Problems {
        self.problems
    }
}

fn too_long(most: usize) -> String {
    format!("the file is longer than {most} bytes")
}

/// A value of the tree and where it starts.
#[derive(Clone, Debug)]
struct Node {
    place: Place,
    kind: Kind,
}

#[derive(Clone, Debug)]
enum Kind {
    /// As written; `quoted` also for block scalars.
    Scalar {
        text: String,
        quoted: bool,
    },
    List(Vec<Node>),
    /// In file order; every key is a scalar and stands once.
    Map(Vec<(Node, Node)>),
}

impl Node {
    /// A text that is no number, wherever one is asked for.
    fn text_at(place: Place, text: &str) -> Self {
        Self { place, kind: Kind::Scalar { text: text.to_owned(), quoted: true } }
    }

    /// True for an empty value, `~` and `null`.
    fn is_null(&self) -> bool {
        matches!(&self.kind, Kind::Scalar { text, quoted: false } if matches!(text.as_str(), "" | "~" | "null" | "Null" | "NULL"))
    }

    /// Text of a scalar, else empty.
    fn text(&self) -> &str {
        match &self.kind {
            Kind::Scalar { text, .. } => text,
            Kind::List(_) | Kind::Map(_) => "",
        }
    }
}

#[cfg(test)]
mod tests;
