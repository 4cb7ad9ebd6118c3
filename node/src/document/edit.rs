//! Sets entries of a mapping in a text; the rest of the text stays unchanged: comments, order, line ends.
//!
//! Law      an existing value is replaced in its place. A missing entry is inserted after its neighbour: on a separate
//!          line with the indentation and the line end of the neighbour, or after a comma if the mapping is in braces.
//!          A key `a.b` is the entry `b` of mapping `a` if there is one, otherwise an entry of that name
//! Reads    a YAML text
//! Writes   a text
//! Refuses  a value that an anchor repeats in several places, and values over several lines ([`Fixed`])
//!
//! The caller must read the new text to check its meaning.

use super::problem::quote;
use saphyr_parser::{Event, Parser, ScalarStyle, Span};
use std::collections::BTreeSet;

/// Reason why an entry cannot be set.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("line {line}: {reason}")]
pub struct Fixed {
    /// Line, from 1.
    pub line: usize,
    /// Reason.
    pub reason: String,
}

/// A text with the location of each value.
#[derive(Clone, Debug)]
pub struct Source<'t> {
    text: &'t str,
    root: Node,
    /// Anchors that are referred to.
    repeated: BTreeSet<usize>,
}

#[derive(Clone, Debug)]
struct Node {
    /// Byte offset in the text.
    start: usize,
    end: usize,
    line: usize,
    /// Number of the anchor; 0 for none.
    anchor: usize,
    kind: Kind,
}

#[derive(Clone, Debug)]
enum Kind {
    /// `is_block`: a block scalar after `|` or `>`.
    Scalar {
        text: String,
        is_block: bool,
    },
    Alias,
    List,
    Map {
        entries: Vec<(Node, Node)>,
    },
}

/// A replacement of these bytes of the text.
struct Change {
    at: std::ops::Range<usize>,
    to: String,
}

impl<'t> Source<'t> {
    /// Finds the locations of the values of a text.
    ///
    /// # Errors
    /// Returns an error with its line if the text is no YAML.
    pub fn parse(text: &'t str) -> Result<Self, Fixed> {
        let (root, repeated) = tree(text)?;
        Ok(Self { text, root, repeated })
    }

    /// Returns the line, from 1, of an entry of the mapping at these keys.
    pub fn line_of(&self, path: &[&str], key: &str) -> Option<usize> {
        let map = path.iter().try_fold(&self.root, |node, key| node.entry(key).map(|(_, value)| value))?;
        let (key, _) = map.entry(key).or_else(|| {
            let (section, key) = key.split_once('.')?;
            map.entry(section)?.1.entry(key)
        })?;
        Some(key.line)
    }

    /// Returns the text with new entries of the mapping at these keys; each is a key and a value as written. Missing
    /// ones are inserted after the last of the `neighbours` that exists, otherwise after the last plain value.
    ///
    /// # Errors
    /// Returns the reason if an entry cannot be set; then none is set.
    pub fn set(&self, path: &[&str], entries: &[(&str, &str)], neighbours: &[&str]) -> Result<String, Fixed> {
        let mut map = self.own(&self.root)?;
        for key in path {
            let Some((_, value)) = map.entry(key) else {
                return Err(map.fixed(format!("there is no entry {}", quote(key))));
            };
            map = self.own(value)?;
        }
        let mut changes = Vec::new();
        for (key, value) in entries {
            changes.push(self.change(map, key, value, neighbours)?);
        }
        // From the end, so that offsets stay valid; insertions at one offset keep their order.
        changes.reverse();
        changes.sort_by_key(|change| std::cmp::Reverse(change.at.start));
        let mut text = self.text.to_owned();
        for Change { at, to } in changes {
            text.replace_range(at, &to);
        }
        Ok(text)
    }

    /// Returns a value that is used in this place only.
    fn own<'n>(&self, node: &'n Node) -> Result<&'n Node, Fixed> {
        match node.kind {
            Kind::Alias => Err(node.fixed("an alias stands here; what it repeats belongs to other places, too")),
            _ if self.repeated.contains(&node.anchor) => {
                Err(node.fixed("what stands here has an anchor and is repeated elsewhere, where it would change, too"))
            }
            _ => Ok(node),
        }
    }

    fn change(&self, map: &Node, key: &str, value: &str, neighbours: &[&str]) -> Result<Change, Fixed> {
        if let Some(entry) = map.entry(key) {
            return self.replace(entry, value);
        }
        if let Some((section, inner)) = key.split_once('.')
            && let Some((_, found)) = map.entry(section)
            && !found.is_empty()
        {
            let found = self.own(found)?;
            return match found.entry(inner) {
                Some(entry) => self.replace(entry, value),
                None => self.insert(found, inner, value, &[]),
            };
        }
        self.insert(map, key, value, neighbours)
    }

    fn replace(&self, (key, old): &(Node, Node), value: &str) -> Result<Change, Fixed> {
        match &self.own(old)?.kind {
            Kind::Scalar { is_block: false, .. } if !old.is_empty() => {
                Ok(Change { at: old.start..old.end, to: value.to_owned() })
            }
            Kind::Scalar { .. } => Err(key.fixed("the value does not stand on its line")),
            _ => Err(key.fixed("a list or a mapping stands here, where a value is to be set")),
        }
    }

    /// Returns the insertion of an entry after the last of its `neighbours` that exists.
    fn insert(&self, map: &Node, key: &str, value: &str, neighbours: &[&str]) -> Result<Change, Fixed> {
        let Kind::Map { entries } = &map.kind else {
            return Err(map.fixed("a mapping is expected here"));
        };
        if let Some(brace) = self.bracket(map) {
            let (at, comma) = match entries.last() {
                None => (brace + 1, ""),
                Some((_, last)) if !last.is_empty() => (last.end, ", "),
                Some((_, last)) => return Err(last.fixed("the last entry in these braces has no value")),
            };
            return Ok(Change { at: at..at, to: format!("{comma}{key}: {value}") });
        }
        let ends_on_its_line = |node: &Node| match &node.kind {
            Kind::Scalar { is_block, .. } => !is_block && !node.is_empty(),
            Kind::Alias => true,
            Kind::List | Kind::Map { .. } => self.bracket(node).is_some(),
        };
        let is_near = |entry: &&(Node, Node)| neighbours.iter().any(|key| entry.0.is(key));
        let is_scalar = |entry: &&(Node, Node)| matches!(entry.1.kind, Kind::Scalar { .. });
        let simple = || entries.iter().rev().filter(|(_, value)| ends_on_its_line(value));
        let found = simple().find(is_near).or_else(|| simple().find(is_scalar)).or_else(|| simple().next());
        let Some((near, last)) = found else {
            return Err(map.fixed("no entry of this mapping ends on its line, so that another one could go behind it"));
        };
        let from = self.text.get(..near.start).unwrap_or_default().rfind(['\n', '\r']).map_or(0, |at| at + 1);
        let indentation = self.text.get(from..near.start).unwrap_or_default().trim_start_matches('\u{feff}');
        if indentation.contains(|c| c != ' ') {
            return Err(near.fixed("the entry does not begin its line"));
        }
        let rest = self.text.get(last.end..).unwrap_or_default();
        let Some(length) = rest.find(['\n', '\r']) else {
            let end = self.line_end();
            let at = self.text.len();
            return Ok(Change { at: at..at, to: format!("{end}{indentation}{key}: {value}") });
        };
        let line_end = rest.get(length..).filter(|rest| rest.starts_with("\r\n")).map_or(1, |_| 2);
        let at = last.end + length + line_end;
        let end = self.text.get(last.end + length..at).unwrap_or("\n");
        Ok(Change { at: at..at, to: format!("{indentation}{key}: {value}{end}") })
    }

    /// Returns the offset of the opening bracket or brace of a list or mapping that has one.
    fn bracket(&self, node: &Node) -> Option<usize> {
        let start = behind_anchor(self.text, node.start);
        self.text.get(start..)?.starts_with(['{', '[']).then_some(start)
    }

    /// Returns the line end of the text.
    fn line_end(&self) -> &'static str {
        match self.text.find(['\n', '\r']).and_then(|at| self.text.get(at..)) {
            Some(rest) if rest.starts_with("\r\n") => "\r\n",
            Some(rest) if rest.starts_with('\r') => "\r",
            _ => "\n",
        }
    }
}

impl Node {
    fn is(&self, key: &str) -> bool {
        matches!(&self.kind, Kind::Scalar { text, .. } if text == key)
    }

    fn entry(&self, key: &str) -> Option<&(Node, Node)> {
        match &self.kind {
            Kind::Map { entries } => entries.iter().find(|(known, _)| known.is(key)),
            _ => None,
        }
    }

    fn is_empty(&self) -> bool {
        // For an absent value the parser gives the position of the next token.
        matches!(&self.kind, Kind::Scalar { text, .. } if text.is_empty())
    }

    fn fixed(&self, reason: impl Into<String>) -> Fixed {
        Fixed { line: self.line, reason: reason.into() }
    }
}

/// A mapping or list that is not closed yet.
struct Open {
    node: Node,
    key: Option<Node>,
}

/// Returns the tree of the first document, and the anchors that are referred to.
fn tree(source: &str) -> Result<(Node, BTreeSet<usize>), Fixed> {
    let marked = source.strip_prefix('\u{feff}').unwrap_or(source);
    let skipped = source.len() - marked.len();
    // The parser counts characters.
    let bytes: Vec<usize> = marked.char_indices().map(|(at, _)| at + skipped).chain([source.len()]).collect();
    let at = |index: usize| bytes.get(index).copied().unwrap_or(source.len());
    let node = |span: Span, anchor: usize, kind: Kind| Node {
        start: at(span.start.index()),
        end: at(span.end.index()),
        line: span.start.line().max(1),
        anchor,
        kind,
    };
    let mut repeated = BTreeSet::new();
    let (mut open, mut root): (Vec<Open>, Option<Node>) = (Vec::new(), None);
    let mut parser = Parser::new_from_str(marked);
    while let Some(event) = parser.next_event() {
        let (event, span) = event.map_err(|error| Fixed {
            line: error.marker().line().max(1),
            reason: format!("this is not YAML: {}", error.info()),
        })?;
        let done = match event {
            Event::Scalar(text, style, anchor, _) => {
                let is_block = matches!(style, ScalarStyle::Literal | ScalarStyle::Folded);
                let scalar = node(span, anchor, Kind::Scalar { text: text.into_owned(), is_block });
                let scalar = Node { start: behind_anchor(source, scalar.start), ..scalar };
                Node { end: quoted_end(source, &scalar).unwrap_or(scalar.end), ..scalar }
            }
            Event::Alias(anchor) => {
                repeated.insert(anchor);
                node(span, 0, Kind::Alias)
            }
            Event::SequenceStart(anchor, _) => {
                open.push(Open { node: node(span, anchor, Kind::List), key: None });
                continue;
            }
            Event::MappingStart(anchor, _) => {
                open.push(Open { node: node(span, anchor, Kind::Map { entries: Vec::new() }), key: None });
                continue;
            }
            Event::SequenceEnd | Event::MappingEnd => match open.pop() {
                Some(Open { node, .. }) => Node { end: at(span.end.index()), ..node },
                None => continue,
            },
            // Text after the first document is ignored.
            Event::DocumentEnd => break,
            _ => continue,
        };
        let Some(Open { node: parent, key }) = open.last_mut() else {
            root = Some(done);
            continue;
        };
        if let Kind::Map { entries } = &mut parent.kind {
            match key.take() {
                None => *key = Some(done),
                Some(key) => entries.push((key, done)),
            }
        }
    }
    let empty =
        Node { start: 0, end: 0, line: 1, anchor: 0, kind: Kind::Scalar { text: String::new(), is_block: false } };
    Ok((root.unwrap_or(empty), repeated))
}

/// Returns the start of a value without its anchor, which the parser includes.
fn behind_anchor(source: &str, start: usize) -> usize {
    match source.get(start..).filter(|rest| rest.starts_with('&')) {
        Some(rest) => source.len() - rest.trim_start_matches(|c: char| !c.is_whitespace()).trim_start().len(),
        None => start,
    }
}

/// Returns the end of a quoted text; the parser includes the text after it.
fn quoted_end(source: &str, node: &Node) -> Option<usize> {
    let text = source.get(node.start..node.end)?;
    let quote = text.chars().next().filter(|first| matches!(first, '"' | '\''))?;
    let mut letters = text.char_indices().skip(1).peekable();
    while let Some((at, letter)) = letters.next() {
        let doubled = quote == '\'' && letters.peek().is_some_and(|(_, next)| *next == quote);
        if (quote == '"' && letter == '\\') || (letter == quote && doubled) {
            letters.next();
        } else if letter == quote {
            return Some(node.start + at + 1);
        }
    }
    None
}

#[cfg(test)]
mod tests;
