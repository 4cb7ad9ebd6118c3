//! Explains keys of cells, scenarios and descriptions of tables.

use super::section;
use crate::reference::{File, Key, range};

pub(super) fn sections(name: &str, width: usize) -> Vec<String> {
    let end = format!(".{name}");
    let is_it = |key: &&Key| key.path == name || key.name() == name || key.path.ends_with(&end);
    keys().filter(is_it).map(|key| text(key, width)).collect()
}

pub(super) fn names() -> Vec<String> {
    keys().map(|key| key.name().to_owned()).collect()
}

fn keys() -> impl Iterator<Item = &'static Key> {
    File::ALL.into_iter().flat_map(File::keys)
}

fn text(key: &Key, width: usize) -> String {
    let range = range(key);
    let facts: [(&str, &str); 6] = [
        ("what", key.meaning),
        ("range", range.as_str()),
        ("default", if key.required { "must be given" } else { key.default }),
        ("example", key.example),
        ("since", key.since),
        ("documented", "docs/keys.md"),
    ];
    section(&format!("{}: a key of a {}", key.path, key.file.name()), &facts, width)
}
