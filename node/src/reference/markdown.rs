//! Generates docs/keys.md from the reference.

use super::{FIRST, File, Key, Shape};
use crate::parameters::{default_text, range_words, unit_text};
use lineshaft_core::function::TYPES;
use lineshaft_core::parameter::{Applies, ROWS, Row, Storage};
use std::collections::BTreeMap;
use std::fmt::Write;

const INTRODUCTION: &str = "\
# Keys

This page is generated: `LINESHAFT_RENEW=1 cargo test -p lineshaft --lib reference`. A test compares it with what the
program asks of its files.

Keys of cells, of scenarios, and of descriptions of tables (`lineshaft table make`). A key that names no version
exists since 0.1.0.

- `axes.*.drive.node` is key `node` in key `drive` of each axis. `*` is a name of your own, `[]` an entry of a list.
- A quantity is a number and a unit with a blank between, such as `10 mm`. A number without a unit has three meanings:
  - In a cell, and in `do` of a scenario, it is SI (m, rad, s): `position: 2` is 2 m. Key `units` of a verb
    chooses another unit. The tables of parameters name the unit of each.
  - As a time of a scenario (`at`, `for`, `after`, `every`), a whole number is cycles: `at: 2` is cycle 2.
  - As a value of a signal (`is`, `min`, `max`, `within`, `values`), it is in the unit of the signal, which is
    increments for a position: `is: 120` is 120 inc. As a value of a parameter, it is as in a cell.
- *required* in column default: each mapping that can have the key must have it. Other words say what applies without it.

For completion and checks in an editor, write the JSON Schema into a file and name it in the first line of a cell or
scenario:

```
lineshaft schema cell > cell.schema.json
lineshaft schema scenario > scenario.schema.json
```

```
# yaml-language-server: $schema=cell.schema.json
```

The schema knows keys, kinds of values and names with a fixed list. `lineshaft check` knows the rest: names of objects,
and what depends on other keys.
";

/// Returns the content of the page.
pub fn markdown() -> String {
    let mut page = INTRODUCTION.to_owned();
    for file in File::ALL {
        let name = file.name();
        let title = name.get(..1).unwrap_or_default().to_uppercase() + name.get(1..).unwrap_or_default();
        // Writing to a string cannot fail.
        let _ = writeln!(page, "\n## {title}");
        let mut sections: Vec<&str> = Vec::new();
        for key in file.keys() {
            if !sections.contains(&section(key)) {
                sections.push(section(key));
            }
        }
        for name in sections {
            let keys: Vec<_> = file.keys().filter(|key| section(key) == name).collect();
            let _ = writeln!(page, "\n### {}\n", heading(file, name));
            page.push_str("| key | type | range | default | meaning | example |\n|-|-|-|-|-|-|\n");
            keys.into_iter().for_each(|key| page.push_str(&line(key)));
        }
        if file == File::Cell {
            parameters(&mut page);
            fields(&mut page);
        }
    }
    page
}

/// Returns the first part of the path of a key.
fn section(key: &Key) -> &'static str {
    key.path.split(['.', '[']).next().unwrap_or(key.path)
}

fn heading(file: File, section: &str) -> String {
    match (file, section) {
        (File::Scenario, "condition") => "Entries of `all` and `any`".to_owned(),
        _ => format!("`{section}`"),
    }
}

fn line(key: &Key) -> String {
    let kinds: Vec<String> = key.shapes.iter().map(|shape| kind(*shape)).collect();
    let example = if key.example.is_empty() { String::new() } else { format!("`{}`", key.example) };
    let meaning = match key.since {
        FIRST => key.meaning.to_owned(),
        since => format!("{} Since {since}.", key.meaning),
    };
    cells(&[format!("`{}`", key.path), kinds.join(" or "), range(key), key.default.to_owned(), meaning, example])
}

fn kind(shape: Shape) -> String {
    match shape {
        Shape::Text => "text",
        Shape::Boolean => "true or false",
        Shape::Integer(..) => "whole number",
        Shape::Number => "number",
        Shape::Quantity(of) => return format!("quantity: {of}"),
        Shape::Multiple => "quantity",
        Shape::Choice(_) => "name",
        Shape::List => "list",
        Shape::Map => "mapping",
        Shape::Names => "mapping of names",
    }
    .to_owned()
}

/// Returns the permitted values: the text of the key, or that of its shapes.
pub(crate) fn range(key: &Key) -> String {
    if !key.range.is_empty() {
        return key.range.to_owned();
    }
    let of_shape = |shape: &Shape| match shape {
        Shape::Integer(low, high) => Some(format!("{low} to {high}")),
        Shape::Choice(names) => Some(names.join(", ")),
        _ => None,
    };
    key.shapes.iter().filter_map(of_shape).collect::<Vec<_>>().join("; ")
}

/// Appends the parameters, which have their own page.
fn parameters(page: &mut String) {
    page.push_str(
        "\n### Parameters of `axes.*` and `machine`\n\n[parameters.md](parameters.md) explains each of them. A name with a dot is also a key \
         in a section: `homing: {method: 35}`. Parameters of homing without a dot may be keys of `homing`.\n\n",
    );
    page.push_str("| key | unit of a bare number | range | default | meaning |\n|-|-|-|-|-|\n");
    for row in ROWS.iter().filter(|row| is_key(row)) {
        let section = if row.applies == Applies::Machine { "machine" } else { "axes.*" };
        let meaning =
            row.description.split_once(". ").map_or(row.description, |(first, _)| first).trim_end_matches('.');
        let texts = [
            format!("`{section}.{}`", row.key),
            unit_text(row),
            range_words(row),
            default_text(row),
            format!("{meaning}."),
        ];
        page.push_str(&cells(&texts));
    }
}

/// Whether a cell can set it.
pub(super) fn is_key(row: &Row) -> bool {
    !matches!(row.storage, Storage::Derived | Storage::Signal(_))
}

/// Appends the fields of function types, which have their own page.
fn fields(page: &mut String) {
    page.push_str("\n### Fields of `functions.*`\n\n[functions.md](functions.md) explains each of them.\n\n");
    page.push_str("| key | types and ranges |\n|-|-|\n");
    let mut names = BTreeMap::<&str, Vec<String>>::new();
    for kind in TYPES {
        for field in kind.fields {
            let range = format!("{} {} to {}", kind.name, field.min, field.max);
            let unit = if field.unit.is_empty() { String::new() } else { format!(" {}", field.unit) };
            let count = if field.count == 1 { String::new() } else { format!(", a list of at most {}", field.count) };
            names.entry(field.name).or_default().push(format!("{range}{unit}{count}"));
        }
        for word in kind.words {
            names.entry(word).or_default().push(format!("{} a signal", kind.name));
        }
    }
    for (name, ranges) in names {
        page.push_str(&cells(&[format!("`functions.*.{name}`"), ranges.join("; ")]));
    }
}

/// Returns a row of a table.
fn cells(texts: &[String]) -> String {
    let texts: Vec<String> = texts.iter().map(|text| text.replace('|', "\\|")).collect();
    format!("| {} |\n", texts.join(" | "))
}
