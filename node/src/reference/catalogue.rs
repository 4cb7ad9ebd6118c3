//! Lists all keys of a file with their paths: those of the reference, and those of tables in the core.

use super::markdown::is_key;
use super::{File, Shape};
use lineshaft_core::function::TYPES;
use lineshaft_core::parameter::{Applies, Group, Measure, ROWS, Row};

/// Sections of an axis whose keys may also be written with a prefix: `amc.master`.
const FLAT: [&str; 2] = ["axes.*.amc.", "axes.*.compensation."];

/// A key.
#[derive(Clone, Debug)]
pub(super) struct Entry {
    /// Path as a list of keys; `*` for a name chosen by the user, `[]` for an entry of a list.
    pub path: Vec<String>,
    pub shapes: Vec<Shape>,
    pub is_required: bool,
    pub meaning: String,
}

/// Returns the keys of a file.
pub(super) fn entries(file: File) -> Vec<Entry> {
    let mut entries = Vec::new();
    for key in file.keys() {
        let entry = Entry {
            path: steps(key.path),
            shapes: key.shapes.to_vec(),
            is_required: key.required,
            meaning: key.meaning.to_owned(),
        };
        if FLAT.iter().any(|section| key.path.starts_with(section)) {
            let flat = key.path.strip_prefix("axes.*.").unwrap_or_default().to_owned();
            let path = vec!["axes".to_owned(), "*".to_owned(), flat];
            entries.push(Entry { path, is_required: false, ..entry.clone() });
        }
        entries.push(entry);
    }
    if file == File::Cell {
        ROWS.iter().filter(|row| is_key(row)).for_each(|row| entries.extend(of_row(row)));
        entries.extend(of_functions());
    }
    entries
}

/// Splits a path such as `groups.*[]` into its steps.
pub(super) fn steps(path: &str) -> Vec<String> {
    let mut steps = Vec::new();
    for part in path.split('.') {
        let name = part.trim_end_matches("[]");
        if !name.is_empty() {
            steps.push(name.to_owned());
        }
        let lists = (part.len() - name.len()) / "[]".len();
        steps.extend(std::iter::repeat_n("[]".to_owned(), lists));
    }
    steps
}

/// Returns the entries of a parameter: by its full name, and in its section.
fn of_row(row: &'static Row) -> Vec<Entry> {
    let entry = |path: Vec<String>| Entry {
        path,
        shapes: shapes(row),
        is_required: false,
        meaning: row.description.to_owned(),
    };
    if row.applies == Applies::Machine {
        return vec![entry(vec!["machine".to_owned(), row.key.to_owned()])];
    }
    let axis = |rest: &[&str]| {
        let path = ["axes", "*"].iter().chain(rest).map(|step| (*step).to_owned()).collect();
        entry(path)
    };
    let mut entries = vec![axis(&[row.key])];
    match row.key.split_once('.') {
        Some((section, key)) => entries.push(axis(&[section, key])),
        None if row.group == Group::Homing => entries.push(axis(&["homing", row.key])),
        None => {}
    }
    entries
}

/// Returns the shapes of a parameter.
fn shapes(row: &Row) -> Vec<Shape> {
    const WHOLE: Shape = Shape::Integer(i64::MIN as i128, i64::MAX as i128);
    match row.measure {
        Measure::Integer => vec![WHOLE, Shape::Quantity("")],
        Measure::Number => vec![Shape::Number, Shape::Quantity("")],
        Measure::Choice(names) => vec![Shape::Choice(names), WHOLE],
        Measure::Position
        | Measure::Distance
        | Measure::Velocity
        | Measure::Acceleration
        | Measure::Jerk
        | Measure::Time => vec![Shape::Quantity("")],
    }
}

/// Returns fields and words of function types; several types have fields of the same name.
fn of_functions() -> Vec<Entry> {
    let mut entries = Vec::new();
    let path = |name: &str| vec!["functions".to_owned(), "*".to_owned(), name.to_owned()];
    for kind in TYPES {
        for field in kind.fields {
            let mut shapes = vec![Shape::Integer(field.min.into(), field.max.into())];
            shapes.extend(field.one().map(|_| Shape::Multiple));
            let meaning = format!("Of {}: {}", kind.name, field.help);
            let whole = Entry { path: path(field.name), shapes, is_required: false, meaning };
            if field.count == 1 {
                entries.push(whole);
                continue;
            }
            let items = [whole.path.clone(), vec!["[]".to_owned()]].concat();
            entries.push(Entry { path: items, meaning: String::new(), ..whole.clone() });
            entries.push(Entry { shapes: vec![Shape::List], ..whole });
        }
        for word in kind.words {
            let meaning = format!("Of {}: a signal that it reads.", kind.name);
            entries.push(Entry { path: path(word), shapes: vec![Shape::Text], is_required: false, meaning });
        }
    }
    entries
}
