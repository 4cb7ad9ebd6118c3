//! Reads a mapping key by key.

#[cfg(test)]
use super::observer::Note;
use super::problem::quote;
use super::syntax::without_equals_sign;
use super::value::suggest;
use super::{Node, Place, Problems, Value};
use lineshaft_core::unit::excerpt;

/// Maximum number of known keys in a message if none is similar.
const MAX_LISTED: usize = 10;

/// A mapping that is being read. [`Map::finish`] reports the keys that were not read.
#[derive(Debug)]
pub struct Map<'d> {
    what: String,
    node: &'d Node,
    entries: &'d [(Node, Node)],
    problems: &'d Problems,
    asked: Vec<String>,
    /// Keys in the order in which messages list them.
    order: Vec<String>,
    missing: Vec<String>,
    explain: Option<fn(&str) -> Option<String>>,
}

impl<'d> Map<'d> {
    pub(super) fn new(what: String, node: &'d Node, entries: &'d [(Node, Node)], problems: &'d Problems) -> Self {
        // It may contain the name of an object, which is text from outside.
        let what = excerpt(&what);
        Self { what, node, entries, problems, asked: vec![], order: vec![], missing: vec![], explain: None }
    }

    /// Returns the value of an optional key.
    pub fn optional(&mut self, key: &str) -> Option<Value<'d>> {
        self.value_of(key, false)
    }

    fn value_of(&mut self, key: &str, is_required: bool) -> Option<Value<'d>> {
        if !self.is_asked(key) {
            self.asked.push(key.to_owned());
        }
        self.note_key(key, is_required);
        let (_, node) = self.entries.iter().find(|(name, _)| name.text() == key)?;
        Some(Value::new(node, key.to_owned(), self.problems))
    }

    /// Returns the value of a required key; a missing one is reported at the end of this mapping.
    pub fn required(&mut self, key: &str) -> Option<Value<'d>> {
        let value = self.value_of(key, true);
        if value.is_none() {
            self.missing.push(key.to_owned());
        }
        value
    }

    /// Sets the order in which messages list these keys, before all others.
    pub fn list_in_order(&mut self, keys: &[&str]) {
        self.order.extend(keys.iter().map(|&key| key.to_owned()));
    }

    /// Permits keys that were not read; they are also suggested for similar keys.
    pub fn allow(&mut self, keys: &[&str]) {
        self.asked.extend(keys.iter().map(|&key| key.to_owned()));
        keys.iter().for_each(|key| self.note_key(key, false));
    }

    /// Records for a test that a key was requested.
    #[cfg(test)]
    fn note_key(&self, key: &str, is_required: bool) {
        if let Some(observer) = &self.problems.observer {
            observer.note(self.node, Note::Key { key: key.to_owned(), is_required });
        }
    }

    #[cfg(not(test))]
    fn note_key(&self, _: &str, _: bool) {}

    /// Returns the keys and values that were not read yet, in the order of the file, and marks them as read.
    pub fn rest(&mut self) -> Vec<(Value<'d>, Value<'d>)> {
        let rest: Vec<_> = self.entries.iter().filter(|(key, _)| !self.is_asked(key.text())).collect();
        self.asked.extend(rest.iter().map(|(key, _)| key.text().to_owned()));
        rest.into_iter().map(|(key, value)| Value::entry(key, value, self.problems)).collect()
    }

    /// Whether the key exists, with or without a value.
    pub fn has(&self, key: &str) -> bool {
        self.entries.iter().any(|(name, _)| name.text() == key)
    }

    /// Sets a function that explains unknown keys; it has priority over similar keys.
    pub fn explain_by(&mut self, explain: fn(&str) -> Option<String>) {
        self.explain = Some(explain);
    }

    /// Returns the location of the mapping.
    pub fn place(&self) -> Place {
        self.node.place
    }

    /// Reports a problem of the mapping as a whole.
    pub fn refuse(&self, sentence: impl Into<String>, hint: Option<String>) {
        self.problems.push(self.node.place, sentence, hint);
    }

    /// Ends the mapping: every key that was not read is a problem. A missing key is not reported if an unknown one
    /// seems to be its misspelling.
    pub fn finish(mut self) {
        #[cfg(test)]
        if let Some(observer) = &self.problems.observer {
            observer.note(self.node, Note::Finished);
        }
        for (key, _) in self.entries {
            if self.is_asked(key.text()) {
                continue;
            }
            let meant = if self.problems.is_full() { None } else { self.meant(key.text()) };
            let before_blank = before_blank(key.text());
            self.missing.retain(|missing| meant.as_ref() != Some(missing) && before_blank != Some(missing.as_str()));
            let sentence = format!("unknown key {} in {}", quote(key.text()), self.what);
            self.problems.push(key.place, sentence, self.hint(key.text(), meant.as_deref()));
        }
    }

    fn is_asked(&self, key: &str) -> bool {
        self.asked.iter().any(|asked| asked == key)
    }

    /// Returns the known key that is most similar to an unknown one and is not in the mapping yet.
    fn meant(&self, key: &str) -> Option<String> {
        suggest(key, self.asked.iter().map(String::as_str).filter(|known| !self.has(known))).map(str::to_owned)
    }

    /// Returns a hint for a key without colon: `{at 0}` in braces is a key without a value.
    fn without_colon(&self, key: &str) -> Option<String> {
        let name = before_blank(key)?;
        let value = without_equals_sign(key.get(name.len() + 1..).unwrap_or_default());
        self.is_asked(name).then(|| format!("write `{}: {}`", excerpt(name), excerpt(value)))
    }

    fn in_order(&self) -> Vec<String> {
        let mut known = self.asked.clone();
        let place = |key: &String| self.order.iter().position(|other| other == key).unwrap_or(usize::MAX);
        known.sort_by_key(place);
        known
    }

    fn hint(&self, key: &str, meant: Option<&str>) -> Option<String> {
        if key == "<<" {
            return Some("merge keys are not read; write the keys out".to_owned());
        }
        let explained = self.explain.and_then(|explain| explain(key)).or_else(|| self.without_colon(key));
        match meant {
            _ if explained.is_some() => explained,
            Some(meant) => Some(format!("did you mean `{meant}`?")),
            None if self.asked.is_empty() || self.asked.len() > MAX_LISTED => None,
            None => Some(format!("known are {}", self.in_order().join(", "))),
        }
    }
}

/// Returns the part of a key before its first space, colon or `=`.
fn before_blank(key: &str) -> Option<&str> {
    key.split_once([' ', ':', '=']).map(|(name, _)| name)
}

/// Reports missing keys, also if a reader returned before [`Map::finish`].
impl Drop for Map<'_> {
    fn drop(&mut self) {
        for key in &self.missing {
            self.problems.push(self.node.place, format!("missing key `{key}` in {}", self.what), None);
        }
    }
}
