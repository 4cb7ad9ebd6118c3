//! Sections of a cell, and the names in them.

use crate::document::{Map, Place, Value};
use lineshaft_core::unit::excerpt;
use std::collections::BTreeMap;

/// Section whose keys are names of objects.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Section {
    Backends,
    Io,
    Memory,
    Encoders,
    Axes,
    Tables,
    Programs,
    Functions,
    Masters,
    Groups,
}

impl Section {
    const ALL: [Self; 10] = [
        Self::Backends,
        Self::Io,
        Self::Memory,
        Self::Encoders,
        Self::Axes,
        Self::Tables,
        Self::Programs,
        Self::Functions,
        Self::Masters,
        Self::Groups,
    ];

    fn key(self) -> &'static str {
        match self {
            Self::Backends => "backends",
            Self::Io => "io",
            Self::Memory => "memory",
            Self::Encoders => "encoders",
            Self::Axes => "axes",
            Self::Tables => "tables",
            Self::Programs => "programs",
            Self::Functions => "functions",
            Self::Masters => "masters",
            Self::Groups => "groups",
        }
    }

    /// Returns the noun for an object of the section.
    fn noun(self) -> &'static str {
        match self {
            Self::Backends => "backend",
            Self::Io => "input or output",
            Self::Memory => "memory cell",
            Self::Encoders => "encoder",
            Self::Axes => "axis",
            Self::Tables => "table",
            Self::Programs => "program",
            Self::Functions => "function",
            Self::Masters => "master",
            Self::Groups => "group",
        }
    }

    fn article(self) -> &'static str {
        if self.noun().starts_with(['a', 'e', 'i']) { "an" } else { "a" }
    }
}

/// A name and its value.
#[derive(Debug)]
pub(super) struct Entry<'d> {
    pub key: Value<'d>,
    pub value: Value<'d>,
}

impl<'d> Entry<'d> {
    /// Returns the name as written, which may be empty.
    pub(super) fn name(&self) -> &'d str {
        self.key.peek().unwrap_or_default()
    }

    /// Returns the name in quotes for a message.
    pub(super) fn quoted(&self) -> String {
        quote(self.name())
    }
}

/// Entries of all sections, in the order of the file.
#[derive(Debug, Default)]
pub(super) struct Names<'d> {
    sections: [Vec<Entry<'d>>; Section::ALL.len()],
    /// Section and index of each occurrence of a name.
    places: BTreeMap<&'d str, Vec<(Section, usize)>>,
}

impl<'d> Names<'d> {
    /// Reads the keys of all sections: each must be a valid name and occur once in the cell.
    pub(super) fn read(cell: &mut Map<'d>) -> Self {
        let mut names = Self::default();
        for section in Section::ALL {
            let entries = cell.optional(section.key()).and_then(|value| value.entries()).unwrap_or_default();
            names.sections[section as usize] = entries.into_iter().map(|(key, value)| Entry { key, value }).collect();
        }
        names.index();
        names
    }

    fn index(&mut self) {
        let mut all: Vec<_> = Section::ALL
            .into_iter()
            .flat_map(|section| self.sections[section as usize].iter().enumerate().map(move |(i, e)| (section, i, e)))
            .collect();
        all.sort_by_key(|(_, _, entry)| entry.key.place());
        let mut first: BTreeMap<&str, (Section, Place)> = BTreeMap::new();
        for (section, index, entry) in all {
            // An invalid name can still be referred to, so that it causes only one problem.
            self.places.entry(entry.name()).or_default().push((section, index));
            let Some(name) = entry.key.name() else { continue };
            if let Some((other, Place { line, col })) = first.get(name) {
                let what = format!("{} {}", other.article(), other.noun());
                let sentence = format!("`{name}` is {what} already, at {line}:{col}; a name stands once");
                entry.key.refuse(sentence, None);
            } else {
                first.insert(name, (section, entry.key.place()));
            }
        }
    }

    /// Returns the entries of a section.
    pub(super) fn section(&self, section: Section) -> &[Entry<'d>] {
        &self.sections[section as usize]
    }

    /// Finds the object `name`, which is part of `value`, in these sections: returns its section and index. Reports a
    /// problem if there is none.
    pub(super) fn find(&self, value: &Value<'d>, name: &str, sections: &[Section]) -> Option<(Section, usize)> {
        let places = self.places.get(name).map_or(&[][..], Vec::as_slice);
        if let Some(found) = places.iter().find(|(section, _)| sections.contains(section)) {
            return Some(*found);
        }
        let nouns: Vec<_> = sections.iter().map(|section| section.noun()).collect();
        let (nouns, label) = (nouns.join(", "), value.label());
        let (sentence, hint) = match places.first() {
            Some((other, _)) => {
                let what = format!("{} {}", other.article(), other.noun());
                (format!("{label} is {}, which is {what}; {nouns} is allowed", quote(name)), None)
            }
            None => {
                let known = sections.iter().flat_map(|section| self.section(*section)).map(Entry::name);
                (format!("{label} is {}; no {nouns} has that name", quote(name)), hint(name, known.collect()))
            }
        };
        value.refuse(sentence, hint);
        None
    }
}

/// Returns a hint: the most similar name, or a list of the known names.
pub(super) fn hint(name: &str, known: Vec<&str>) -> Option<String> {
    const MOST_LISTED: usize = 8;
    const MOST_COMPARED: usize = 1000;
    const LONGEST: usize = 64;
    let near = |known| {
        let far = strsim::damerau_levenshtein(&name.to_lowercase(), known);
        (far * 3 <= name.len().max(known.len())).then_some((far, known))
    };
    let compared = known.iter().copied().take(if name.len() > LONGEST { 0 } else { MOST_COMPARED });
    if let Some((_, meant)) = compared.filter_map(near).min() {
        return Some(format!("did you mean `{}`?", excerpt(meant)));
    }
    let all = || known.iter().map(|name| excerpt(name)).collect::<Vec<_>>().join(", ");
    match known.len() {
        0 => Some("there is none".to_owned()),
        1 => Some(format!("there is {}", all())),
        2..=MOST_LISTED => Some(format!("there are {}", all())),
        _ => None,
    }
}

/// Quotes a part of the file for a message.
pub(super) fn quote(text: &str) -> String {
    format!("`{}`", excerpt(text))
}

/// Objects that may be used only once, with the location of their use.
pub(super) struct UsedOnce<K>(BTreeMap<K, Place>);

impl<K: Ord> UsedOnce<K> {
    pub(super) fn new() -> Self {
        Self(BTreeMap::new())
    }

    /// Registers a use; reports a problem with the name `what` if there was one before.
    pub(super) fn take(&mut self, key: K, value: &Value<'_>, what: impl FnOnce() -> String) -> bool {
        let first = self.0.get(&key).copied();
        match first {
            Some(Place { line, col }) => value.refuse(format!("{} is taken already, at {line}:{col}", what()), None),
            None => {
                self.0.insert(key, value.place());
            }
        }
        first.is_none()
    }

    /// Returns the location of the use.
    pub(super) fn place(&self, key: &K) -> Option<Place> {
        self.0.get(key).copied()
    }
}

/// Refuses entries beyond the maximum number.
pub(super) fn limit(entries: &[Entry<'_>], most: usize) {
    if let Some(beyond) = entries.get(most) {
        let sentence = format!("{} entries exceed the maximum of this section, {most}", entries.len());
        beyond.key.refuse(sentence, None);
    }
}

/// Whether the axis has no drive, judging by its key `drive`.
pub(super) fn is_virtual(entry: &Entry<'_>) -> bool {
    let entries = if entry.value.is_map() { entry.value.entries() } else { None };
    entries.into_iter().flatten().any(|(key, value)| key.peek() == Some("drive") && value.peek() == Some("virtual"))
}
