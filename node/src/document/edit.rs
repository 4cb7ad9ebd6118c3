//! Entries of a mapping set in a text, all else of which stays as it stands: comments, order, ends of lines.
//!
//! Law      a value that stands is replaced in its place. An entry that is missing goes behind its neighbour: on a line of its own with the
//!          indentation and the end of that one's line, or behind a comma where the mapping is in braces. A key `a.b` is the
//!          entry `b` of mapping `a` where there is one, else an entry of that name
//! Reads    a text that is YAML
//! Writes   a text
//! Refuses  what stands in more places than one, by an anchor, and values over several lines ([`Fixed`])
//!
//! Who edits reads the new text again: whether it says what it should is known there.

use super::problem::quote;
use saphyr_parser::{Event, Parser, ScalarStyle, Span};
use std::collections::BTreeSet;

/// Why an entry cannot be set.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("line {line}: {reason}")]
pub struct Fixed {
    /// Where, from 1.
    pub line: usize,
    /// What stands there.
    pub reason: String,
}

/// A text with the place of each value.
#[derive(Clone, Debug)]
pub struct Source<'t> {
    text: &'t str,
    root: Node,
    /// Anchors that are repeated somewhere.
    repeated: BTreeSet<usize>,
}

#[derive(Clone, Debug)]
struct Node {
    /// Bytes of the text.
    start: usize,
    end: usize,
    line: usize,
    /// 0 for none.
    anchor: usize,
    kind: Kind,
}

#[derive(Clone, Debug)]
enum Kind {
    /// `is_block`: over several lines behind `|` or `>`.
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

/// A change of the text: these bytes become that.
struct Change {
    at: std::ops::Range<usize>,
    to: String,
}

impl<'t> Source<'t> {
    /// Finds the places of a text.
    ///
    /// # Errors
    /// A text that is no YAML, and its line.
    pub fn parse(text: &'t str) -> Result<Self, Fixed> {
        let (root, repeated) = tree(text)?;
        Ok(Self { text, root, repeated })
    }

    /// The line of an entry of the mapping that is found by these keys, from 1.
    pub fn line_of(&self, path: &[&str], key: &str) -> Option<usize> {
        let map = path.iter().try_fold(&self.root, |node, key| node.entry(key).map(|(_, value)| value))?;
        let (key, _) = map.entry(key).or_else(|| {
            let (section, key) = key.split_once('.')?;
            map.entry(section)?.1.entry(key)
        })?;
        Some(key.line)
    }

    /// The text with entries of the mapping that is found by these keys set; each is a key and a value as it is written. Those that are
    /// missing go behind the last of the `neighbours` that stands there, else behind the last plain value.
    ///
    /// # Errors
    /// What stands in the way; nothing is set then.
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
        // From behind, so that places stay; what goes into one place stays in its order.
        changes.reverse();
        changes.sort_by_key(|change| std::cmp::Reverse(change.at.start));
        let mut text = self.text.to_owned();
        for Change { at, to } in changes {
            text.replace_range(at, &to);
        }
        Ok(text)
    }

    /// A value that stands in this place alone.
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

    /// An entry more; it goes behind the last of its `neighbours` that there is.
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

    /// Where a list or a mapping opens that stands in brackets or braces.
    fn bracket(&self, node: &Node) -> Option<usize> {
        let start = behind_anchor(self.text, node.start);
        self.text.get(start..)?.starts_with(['{', '[']).then_some(start)
    }

    /// How lines end.
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
        // Where nothing stands the parser names what comes next.
        matches!(&self.kind, Kind::Scalar { text, .. } if text.is_empty())
    }

    fn fixed(&self, reason: impl Into<String>) -> Fixed {
        Fixed { line: self.line, reason: reason.into() }
    }
}

/// A mapping or a list whose end has not come yet.
struct Open {
    node: Node,
    key: Option<Node>,
}

/// The tree of the first document, and the anchors that are repeated.
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
            // What stands behind the first document is no part of it.
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

/// Where a value begins: the parser counts the anchor to it.
fn behind_anchor(source: &str, start: usize) -> usize {
    match source.get(start..).filter(|rest| rest.starts_with('&')) {
        Some(rest) => source.len() - rest.trim_start_matches(|c: char| !c.is_whitespace()).trim_start().len(),
        None => start,
    }
}

/// Where a text in quotes ends: the parser counts what stands behind it to it.
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
