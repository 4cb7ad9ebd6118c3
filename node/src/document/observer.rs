//! Records which keys the readers of a document request. Only tests use it.
//!
//! Law      a reader requests each of its keys by name: [`Map::optional`](super::Map::optional), `required` and `allow`
//!          record the key, whether the file has it or not, and each reader of a value records its kind and range. The
//!          readers themselves are the source, so the records cannot be outdated
//! Reads    the addresses of the values, from which patterns of the records are made: `axes.*.drive.node`,
//!          `groups.*[]`. A key is `*` if no reader requested it by name, because the user chose the name

use super::{Document, Kind, Node};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::sync::{Arc, Mutex};

/// Kind of value that a reader expects.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum ExpectedKind {
    Text,
    Boolean,
    /// Minimum and maximum.
    Integer(i128, i128),
    Number,
    Quantity,
    Choice(Vec<String>),
    List,
    Map,
}

/// Records of the keys of one pattern.
#[derive(Clone, Debug, Default)]
pub(crate) struct Seen {
    /// Number of mappings that were read to their end and required the key.
    pub required: usize,
    /// Number of mappings that were read to their end and could have the key.
    pub maps: usize,
    pub kinds: BTreeSet<ExpectedKind>,
}

#[derive(Clone, Debug)]
pub(super) enum Note {
    Key { key: String, is_required: bool },
    Value(ExpectedKind),
    Finished,
}

#[derive(Debug)]
enum Step {
    Item,
    Key(String),
}

/// The root, whose address changes with that of the document.
const ROOT: usize = 0;

/// Records of the readers of one document.
#[derive(Debug, Default)]
pub(crate) struct Observer {
    /// By the address of a value: address of its parent, and its step from the parent.
    steps: HashMap<usize, (usize, Step)>,
    /// Addresses of keys, for which nothing is recorded.
    keys: BTreeSet<usize>,
    notes: Mutex<Vec<(usize, Note)>>,
}

impl Document {
    /// Starts recording the requests of readers.
    pub(crate) fn observe(&mut self) -> Arc<Observer> {
        let mut observer = Observer::default();
        if let Some(root) = &self.root {
            observer.add(root, ROOT);
        }
        let observer = Arc::new(observer);
        self.problems.observer = Some(Arc::clone(&observer));
        observer
    }
}

fn address(node: &Node) -> usize {
    std::ptr::from_ref(node).addr()
}

impl Observer {
    fn add(&mut self, node: &Node, own: usize) {
        match &node.kind {
            Kind::Scalar { .. } => {}
            Kind::List(items) => {
                for item in items {
                    self.steps.insert(address(item), (own, Step::Item));
                    self.add(item, address(item));
                }
            }
            Kind::Map(entries) => {
                for (key, value) in entries {
                    self.keys.insert(address(key));
                    self.steps.insert(address(value), (own, Step::Key(key.text().to_owned())));
                    self.add(value, address(value));
                }
            }
        }
    }

    pub(super) fn note(&self, node: &Node, note: Note) {
        let at = address(node);
        if self.keys.contains(&at) {
            return;
        }
        let at = if self.steps.contains_key(&at) { at } else { ROOT };
        self.notes.lock().expect("no reader panics while it notes").push((at, note));
    }

    /// Returns all records so far, by pattern.
    pub(crate) fn seen(&self) -> BTreeMap<String, Seen> {
        let notes = self.notes.lock().expect("no reader panics while it notes");
        let (mut asked, mut finished) = (BTreeMap::<usize, BTreeMap<&str, bool>>::new(), BTreeSet::new());
        for (at, note) in notes.iter() {
            match note {
                Note::Key { key, is_required } => {
                    *asked.entry(*at).or_default().entry(key).or_default() |= is_required;
                }
                Note::Finished => {
                    finished.insert(*at);
                }
                Note::Value(_) => {}
            }
        }
        let mut maps = BTreeMap::<String, usize>::new();
        for at in &finished {
            *maps.entry(self.pattern(*at, &asked)).or_default() += 1;
        }
        let mut seen = BTreeMap::<String, Seen>::new();
        for (at, keys) in &asked {
            let parent = self.pattern(*at, &asked);
            for (key, is_required) in keys {
                let entry = seen.entry(join(&parent, key)).or_default();
                entry.required += usize::from(*is_required && finished.contains(at));
                entry.maps = maps.get(&parent).copied().unwrap_or_default();
            }
        }
        for (at, note) in notes.iter().filter(|(at, _)| *at != ROOT) {
            if let Note::Value(kind) = note {
                seen.entry(self.pattern(*at, &asked)).or_default().kinds.insert(kind.clone());
            }
        }
        seen
    }

    fn pattern(&self, at: usize, asked: &BTreeMap<usize, BTreeMap<&str, bool>>) -> String {
        let Some((parent, step)) = self.steps.get(&at) else { return String::new() };
        let path = self.pattern(*parent, asked);
        match step {
            Step::Item => path + "[]",
            Step::Key(key) => {
                let is_known = asked.get(parent).is_some_and(|keys| keys.contains_key(key.as_str()));
                join(&path, if is_known { key.as_str() } else { "*" })
            }
        }
    }
}

fn join(path: &str, key: &str) -> String {
    if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") }
}

/// Converts a value by the core schema of YAML 1.2.
pub(super) fn json(node: &Node) -> Value {
    match &node.kind {
        Kind::List(items) => Value::Array(items.iter().map(json).collect()),
        Kind::Map(entries) => {
            Value::Object(entries.iter().map(|(key, value)| (key.text().to_owned(), json(value))).collect())
        }
        _ if node.is_null() => Value::Null,
        Kind::Scalar { text, quoted: true } => Value::from(text.as_str()),
        Kind::Scalar { text, quoted: false } => plain(text),
    }
}

fn plain(text: &str) -> Value {
    let unsigned = |digits: &str, radix| u64::from_str_radix(digits, radix).ok().map(Value::from);
    let is_number = text.bytes().all(|byte| byte.is_ascii_digit() || b"+-.eE".contains(&byte))
        && text.bytes().any(|byte| byte.is_ascii_digit());
    match text {
        "true" | "True" | "TRUE" => Value::from(true),
        "false" | "False" | "FALSE" => Value::from(false),
        _ if text.starts_with("0x") => unsigned(&text[2..], 16).unwrap_or_else(|| Value::from(text)),
        _ if text.starts_with("0o") => unsigned(&text[2..], 8).unwrap_or_else(|| Value::from(text)),
        _ if is_number => {
            let whole = text.parse::<i64>().ok().map(Value::from).or_else(|| unsigned(text, 10));
            whole.or_else(|| text.parse::<f64>().ok().map(Value::from)).unwrap_or_else(|| Value::from(text))
        }
        _ => Value::from(text),
    }
}
