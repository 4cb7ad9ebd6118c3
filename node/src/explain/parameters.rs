//! Explains parameters of axes and of the machine by key, with or without an object, and the words of other
//! controllers.

use super::{documented, section};
use crate::parameters::details;
use lineshaft_core::parameter::{Equivalent, ROWS, Row, Word};

pub(super) fn sections(name: &str, width: usize) -> Vec<String> {
    if let Some(row) = row(name) {
        return vec![text(row, width)];
    }
    // `x.VELMAX` is a word with the name of an axis.
    let word = Word::find(name).or_else(|| Word::find(name.split_once('.')?.1));
    let Some(word) = word else { return Vec::new() };
    let (heading, here) = (format!("{}: a word of {}", word.name, word.system.name()), word.text(None));
    let mut sections = vec![section(&heading, &[("here", here.as_str())], width)];
    if let Equivalent::Parameter(key) = word.equivalent {
        sections.extend(Row::find(key).map(|(_, row)| text(row, width)));
    }
    sections
}

pub(super) fn names() -> Vec<String> {
    ROWS.iter().map(|row| row.key.to_owned()).collect()
}

/// Returns the row of a key, or of `x.max_velocity`.
fn row(name: &str) -> Option<&'static Row> {
    let small = name.to_lowercase();
    let of_object = small.split_once('.').map(|(_, key)| key);
    [Some(small.as_str()), of_object].into_iter().flatten().find_map(Row::find).map(|(_, row)| row)
}

fn text(row: &Row, width: usize) -> String {
    let details = details(row, width);
    let facts = details.split_once('\n').map_or("", |(_, facts)| facts);
    format!("{}: a parameter\n{facts}{}", row.key, documented("docs/parameters.md"))
}
