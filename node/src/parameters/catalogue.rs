//! Formats the catalogue for a terminal: a table of rows, or the full description of one row.

use super::words::{default_text, effect_text, range_words, source_text, storage_text, unit_text, views_of};
use crate::scenario::nearest;
use globset::{GlobBuilder, GlobMatcher};
use lineshaft_core::parameter::{ROWS, Row, System};
use lineshaft_core::unit::excerpt;
use std::fmt::Write;

/// Number of spaces between columns.
const GAP: usize = 2;
/// Minimum width of the description column; in a narrower table the description is below its row.
const NARROWEST: usize = 34;
/// Maximum widths of unit, range, default and effect; longer texts are wrapped.
const WIDEST: [usize; 4] = [13, 24, 16, 16];

/// Filter of rows.
#[derive(Clone, Debug, Default)]
pub struct Filter {
    name: Option<GlobMatcher>,
    system: Option<System>,
}

impl Filter {
    /// Creates a filter for names that match a pattern, ignoring case, and for one source; `None` selects all.
    ///
    /// # Errors
    /// Returns an error message for an invalid pattern.
    pub fn new(pattern: Option<&str>, system: Option<System>) -> Result<Self, String> {
        let glob = |pattern: &str| {
            let glob = GlobBuilder::new(pattern).case_insensitive(true).build();
            glob.map_err(|error| format!("`{}` is no pattern: {}", excerpt(pattern), error.kind()))
        };
        let name = pattern.map(glob).transpose()?;
        Ok(Self { name: name.map(|glob| glob.compile_matcher()), system })
    }

    /// Whether it selects a row by its key or by the original name of its source.
    pub fn takes(&self, row: &Row) -> bool {
        let is_named = |glob: &GlobMatcher| glob.is_match(row.key) || glob.is_match(row.mnemonic);
        self.system.is_none_or(|system| row.system == system) && self.name.as_ref().is_none_or(is_named)
    }

    /// Does the same, also by the name with an object: `x.max_velocity`.
    pub fn takes_of(&self, object: &str, row: &Row) -> bool {
        let is_system = self.system.is_none_or(|system| row.system == system);
        let is_named = |glob: &GlobMatcher| glob.is_match(format!("{object}.{}", row.key));
        self.takes(row) || is_system && self.name.as_ref().is_some_and(is_named)
    }

    /// Returns the selected rows, in the order of the catalogue.
    pub fn rows(&self) -> Vec<&'static Row> {
        ROWS.iter().filter(|row| self.takes(row)).collect()
    }
}

/// Returns a suggestion for a pattern without a match: a similar key, or a pattern for keys that contain it.
pub fn meant(pattern: &str) -> Option<String> {
    let small = pattern.to_lowercase();
    if !small.is_empty() && ROWS.iter().any(|row| row.key.contains(&small)) {
        return Some(format!("*{small}*"));
    }
    nearest(&small, ROWS.iter().map(|row| row.key)).map(str::to_owned)
}

/// Returns a table of rows, `width` columns wide.
pub fn listing(rows: &[&Row], width: usize) -> String {
    let head = ["name", "unit", "range", "default", "effective"].map(str::to_owned);
    let cells = rows.iter().map(|row| {
        [row.key.to_owned(), unit_text(row), range_words(row), default_text(row), effect_text(row.effect).to_owned()]
    });
    let cells: Vec<[String; 5]> = std::iter::once(head).chain(cells).collect();
    let descriptions = std::iter::once("description".to_owned()).chain(rows.iter().map(|row| first_sentence(row)));
    let mut widths = [0; 5];
    for (column, most) in widths.iter_mut().enumerate() {
        let longest = |parts: fn(&str) -> Vec<&str>| {
            let parts = cells.iter().flat_map(|line| parts(&line[column]));
            parts.map(|part| part.chars().count()).max().unwrap_or(0)
        };
        let (cell, word) = (longest(|cell| vec![cell]), longest(|cell| cell.split_whitespace().collect()));
        *most = if column == 0 { cell } else { cell.min(WIDEST[column - 1]).max(word) };
    }
    let before = widths.iter().sum::<usize>() + GAP * widths.len();
    let beside = width.checked_sub(before).filter(|left| *left >= NARROWEST);
    let mut text = String::new();
    for (line, description) in cells.iter().zip(descriptions) {
        let mut columns: Vec<(Vec<String>, usize)> =
            line.iter().zip(widths).map(|(cell, width)| (wrap(cell, width), width)).collect();
        if let Some(left) = beside {
            columns.push((wrap(&description, left), left));
        }
        lay(&mut text, &columns);
        if beside.is_none() {
            for part in wrap(&description, width.saturating_sub(4)) {
                let _ = writeln!(text, "    {part}");
            }
        }
    }
    text
}

/// Appends columns next to each other.
fn lay(text: &mut String, columns: &[(Vec<String>, usize)]) {
    let height = columns.iter().map(|(lines, _)| lines.len()).max().unwrap_or(0);
    for row in 0..height {
        let mut line = String::new();
        for (lines, width) in columns {
            let cell = lines.get(row).map_or("", String::as_str);
            let _ = write!(line, "{cell:width$}{:GAP$}", "");
        }
        let _ = writeln!(text, "{}", line.trim_end());
    }
}

/// Wraps a text at spaces into lines of at most `width`; a longer word has its own line.
pub(crate) fn wrap(text: &str, width: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + word.chars().count() <= width => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

/// Returns the purpose of a row, and whether it is implemented.
fn first_sentence(row: &Row) -> String {
    let first = row.description.split_once(". ").map_or(row.description, |(first, _)| first);
    let first = first.trim_end_matches('.');
    if row.missing.is_empty() { first.to_owned() } else { format!("{first} (not yet: {})", row.missing) }
}

/// Returns the full description of a row, `width` columns wide.
pub fn details(row: &Row, width: usize) -> String {
    const LABEL: usize = 14;
    let view = if row.is_view() { format!("another view of {}", row.view_of) } else { views_of(row).join(", ") };
    let lines = [
        ("for", row.description.to_owned()),
        ("source", source_text(row)),
        ("group", row.group.text().to_owned()),
        (if row.is_view() { "view" } else { "views" }, view),
        ("unit", unit_text(row)),
        ("range", range_words(row)),
        ("step", if row.step() == 0 { String::new() } else { row.step().to_string() }),
        ("default", default_text(row)),
        ("kept", storage_text(row.storage)),
        ("effective", row.effect.text().to_owned()),
        ("applies to", row.applies.text().to_owned()),
        ("missing", missing_text(row)),
        ("note", row.note.to_owned()),
        ("requirements", row.source.to_owned()),
    ];
    let mut text = format!("{}\n", row.key);
    for (label, value) in lines.iter().filter(|(_, value)| !value.is_empty()) {
        let value = wrap(value, width.saturating_sub(LABEL + 4).max(NARROWEST));
        lay(&mut text, &[(vec![format!("  {label}")], LABEL), (value, 0)]);
    }
    text
}

fn missing_text(row: &Row) -> String {
    if row.missing.is_empty() {
        return String::new();
    }
    format!("{}; only {} is taken", row.missing_text(), default_text(row))
}
