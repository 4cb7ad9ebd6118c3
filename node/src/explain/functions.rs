//! Explains types of function slots, and their fields: `varsync`, `varsync.m1`, `m1`.

use super::{documented, section};
use crate::functions::{default, details, range, when};
use lineshaft_core::function::{Description, Field, Kind, TYPES};

pub(super) fn sections(name: &str, width: usize) -> Vec<String> {
    let small = name.to_lowercase();
    if let Some(kind) = Kind::find(&small) {
        let row = kind.description();
        return vec![format!("function type {}{}", details(row, width), documented(&page(row)))];
    }
    // `x.m1` may be a field of a slot that the cell calls x.
    let (kind, end) = small.split_once('.').map_or((None, small.as_str()), |(of, end)| (Kind::find(of), end));
    // An item of a list, `mode[2]`.
    let end = end.split('[').next().unwrap_or(end);
    let mut sections = Vec::new();
    for row in TYPES.iter().filter(|row| kind.is_none_or(|kind| kind == row.kind)) {
        let fields = row.fields.iter().filter(|field| field.name.eq_ignore_ascii_case(end));
        sections.extend(fields.map(|field| field_text(row, field, width)));
        let words = row.words.iter().filter(|word| word.eq_ignore_ascii_case(end));
        sections.extend(words.map(|word| word_text(row, word, width)));
    }
    sections
}

pub(super) fn names() -> Vec<String> {
    let of_type = |row: &Description| {
        let fields = row.fields.iter().map(|field| field.name);
        fields.chain(row.words.iter().copied()).chain([row.name]).map(str::to_owned).collect::<Vec<_>>()
    };
    TYPES.iter().flat_map(of_type).collect()
}

fn page(row: &Description) -> String {
    format!("docs/functions.md#{}", row.name)
}

fn field_text(row: &Description, field: &Field, width: usize) -> String {
    let count = if field.count == 1 { String::new() } else { format!("{}, [0] to [{}]", field.count, field.count - 1) };
    let (range, default, page) = (range(field), default(field), page(row));
    let facts: [(&str, &str); 8] = [
        ("what", field.help),
        ("values", count.as_str()),
        ("range", range.as_str()),
        ("unit", field.unit),
        ("default", default.as_str()),
        ("effective", when(field)),
        ("requirement", field.source),
        ("documented", page.as_str()),
    ];
    section(&format!("{}: a field of function type {}", field.name, row.name), &facts, width)
}

fn word_text(row: &Description, word: &str, width: usize) -> String {
    let what = "names the signal that is read in each call in addition to the source";
    let page = page(row);
    let facts: [(&str, &str); 2] = [("what", what), ("documented", page.as_str())];
    section(&format!("{word}: a key of function type {}", row.name), &facts, width)
}
