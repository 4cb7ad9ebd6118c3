//! Converts the events of the parser to a tree.
//!
//! The loader of the parser is not used: it recurses per level of nesting, ends at the first duplicate key, and
//! interprets scalars before their meaning is known.

use super::problem::quote;
use super::syntax::{Syntax, plain};
use super::{Kind, MAX_DEPTH, Node, Place, Problems};
use saphyr_parser::{Event, Marker, Parser, ScalarStyle};
use std::collections::HashMap;

/// Maximum size of repetitions by aliases, in bytes; nested aliases could otherwise expand a small file without limit.
const MAX_REPEATED: usize = 16 << 20;

/// Returns the tree of the first document in `text`; `None` after a problem without a tree. An empty text is a null.
pub(super) fn tree(text: &str, problems: &Problems, most_values: usize) -> Option<Node> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut parser = Parser::new_from_str(text);
    let mut builder = Builder {
        problems,
        open: Vec::new(),
        anchors: HashMap::new(),
        root: None,
        values: 0,
        most_values,
        repeated: 0,
    };
    let (mut documents, mut start) = (0, Place::START);
    while let Some(event) = parser.next_event() {
        let (event, place) = match event {
            Ok((event, span)) => (event, place(span.start)),
            Err(error) => {
                // The parser has its own depth limit and may reach it first, because it scans ahead.
                let at = place(*error.marker());
                let Syntax { place, sentence, hint } = match error.info() {
                    "recursion limit exceeded" => Syntax { place: at, sentence: too_deep(), hint: None },
                    info => plain(text, info, at),
                };
                problems.push(place, sentence, brackets_hint(text, error.marker().index()).or(hint));
                return None;
            }
        };
        if matches!(event, Event::DocumentStart(_)) {
            documents += 1;
            start = place;
        }
        if documents > 1 {
            // `ros2 topic echo` ends each message with the start of a new document, which is ignored if it is empty.
            if is_node(&event) {
                problems.push(start, "a second document starts here; a file holds one", None);
                break;
            }
            continue;
        }
        if let Err(sentence) = builder.event(event, place) {
            problems.push(place, sentence, None);
            return None;
        }
    }
    Some(
        builder.root.unwrap_or(Node { place: Place::START, kind: Kind::Scalar { text: String::new(), quoted: false } }),
    )
}

/// Whether it is part of a value that is not empty.
fn is_node(event: &Event<'_>) -> bool {
    match event {
        Event::Scalar(text, style, ..) => !text.is_empty() || *style != ScalarStyle::Plain,
        Event::SequenceStart(..) | Event::MappingStart(..) | Event::Alias(..) => true,
        _ => false,
    }
}

/// Returns a hint for `{mode[1]: 16}`, where the error is at the bracket: in braces a bracket ends an unquoted key.
/// `index` counts characters.
fn brackets_hint(text: &str, index: usize) -> Option<String> {
    let (at, _) = text.char_indices().nth(index)?;
    let is_of_key = |c: char| c.is_alphanumeric() || c == '_' || c == '.';
    let name = text.get(..at)?.rsplit(|c| !is_of_key(c)).next()?;
    let (place, rest) = text.get(at..)?.strip_prefix('[')?.split_once(']')?;
    let is_place = !place.is_empty() && place.bytes().all(|byte| byte.is_ascii_digit());
    let is_key = !name.is_empty() && is_place && rest.trim_start().starts_with(':');
    is_key.then(|| format!("quote a key with brackets: `\"{name}[{place}]\"`"))
}

fn too_deep() -> String {
    format!("lists and mappings are nested deeper than {MAX_DEPTH} levels")
}

fn place(marker: Marker) -> Place {
    Place { line: marker.line().max(1), col: marker.col() + 1 }
}

struct Builder<'p> {
    problems: &'p Problems,
    open: Vec<Open>,
    anchors: HashMap<usize, Finished>,
    root: Option<Node>,
    values: usize,
    most_values: usize,
    repeated: usize,
}

/// A list or mapping that is not closed yet.
struct Open {
    place: Place,
    anchor: usize,
    bytes: usize,
    items: Items,
}

enum Items {
    List(Vec<Node>),
    Map { entries: Vec<(Node, Node)>, key: Option<Node> },
}

/// A node and its approximate memory.
#[derive(Clone)]
struct Finished {
    node: Node,
    bytes: usize,
}

impl Builder<'_> {
    /// Handles an event; an error ends reading.
    fn event(&mut self, event: Event<'_>, place: Place) -> Result<(), String> {
        match event {
            Event::Scalar(text, style, anchor, tag) => {
                self.refuse_tag(tag.as_deref(), place);
                let bytes = size_of::<Node>() + text.len();
                let kind = Kind::Scalar { text: text.into_owned(), quoted: style != ScalarStyle::Plain };
                self.finish(Finished { node: Node { place, kind }, bytes }, anchor)
            }
            Event::SequenceStart(anchor, tag) => {
                self.refuse_tag(tag.as_deref(), place);
                self.open(place, anchor, Items::List(Vec::new()))
            }
            Event::MappingStart(anchor, tag) => {
                self.refuse_tag(tag.as_deref(), place);
                self.open(place, anchor, Items::Map { entries: Vec::new(), key: None })
            }
            Event::SequenceEnd | Event::MappingEnd => self.close(),
            Event::Alias(anchor) => match self.anchors.get(&anchor).cloned() {
                Some(finished) => self.repeat(finished.bytes).and_then(|()| self.finish(finished, 0)),
                None => Err("this alias stands inside of the value that it repeats".to_owned()),
            },
            _ => Ok(()),
        }
    }

    fn open(&mut self, place: Place, anchor: usize, items: Items) -> Result<(), String> {
        if self.open.len() == MAX_DEPTH {
            return Err(too_deep());
        }
        self.open.push(Open { place, anchor, bytes: size_of::<Node>(), items });
        Ok(())
    }

    fn close(&mut self) -> Result<(), String> {
        let Some(Open { place, anchor, bytes, items }) = self.open.pop() else { return Ok(()) };
        let kind = match items {
            Items::List(items) => Kind::List(items),
            Items::Map { entries, .. } => Kind::Map(self.without_duplicates(entries)),
        };
        self.finish(Finished { node: Node { place, kind }, bytes }, anchor)
    }

    /// Adds a complete node to its parent.
    fn finish(&mut self, finished: Finished, anchor: usize) -> Result<(), String> {
        self.values += 1;
        if self.values > self.most_values {
            return Err(format!("the file has more than {} values", self.most_values));
        }
        if anchor > 0 {
            self.repeat(finished.bytes)?;
            self.anchors.insert(anchor, finished.clone());
        }
        let Finished { node, bytes } = finished;
        let Some(parent) = self.open.last_mut() else {
            self.root = Some(node);
            return Ok(());
        };
        parent.bytes += bytes;
        match &mut parent.items {
            Items::List(items) => items.push(node),
            Items::Map { entries, key } => match key.take() {
                None => *key = Some(node),
                Some(key) if matches!(key.kind, Kind::Scalar { .. }) && !key.is_null() => entries.push((key, node)),
                Some(key) => {
                    self.problems.push(key.place, "a key is a text; lists, mappings and nothing are not", None)
                }
            },
        }
        Ok(())
    }

    fn repeat(&mut self, bytes: usize) -> Result<(), String> {
        self.repeated += bytes;
        if self.repeated > MAX_REPEATED {
            return Err(format!("anchors and aliases repeat more than {MAX_REPEATED} bytes"));
        }
        Ok(())
    }

    fn without_duplicates(&self, entries: Vec<(Node, Node)>) -> Vec<(Node, Node)> {
        let mut first: HashMap<String, Place> = HashMap::new();
        let mut kept = Vec::with_capacity(entries.len());
        for (key, value) in entries {
            if let Some(Place { line, col }) = first.get(key.text()) {
                let sentence = format!("duplicate key {}; it is first at {line}:{col}", quote(key.text()));
                self.problems.push(key.place, sentence, None);
            } else {
                first.insert(key.text().to_owned(), key.place);
                kept.push((key, value));
            }
        }
        kept
    }

    fn refuse_tag(&self, tag: Option<&saphyr_parser::Tag>, place: Place) {
        if let Some(tag) = tag {
            let name = if tag.is_yaml_core_schema() { format!("!!{}", tag.suffix) } else { tag.to_string() };
            self.problems.push(place, format!("tag {} is not read", quote(&name)), Some("leave it out".to_owned()));
        }
    }
}
