//! Tests that the table agrees with the readers, and that the schemas accept what the readers accept.

mod extra;
mod validator;

use super::catalogue::steps;
use super::*;
use crate::cell::Cell;
use crate::document::{Document, ExpectedKind, Seen};
use crate::scenario::Scenario;
use crate::table::description::Description;
use lineshaft_core::function::TYPES;
use lineshaft_core::parameter::{Applies, ROWS};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Records of keys, by pattern.
type Patterns = BTreeMap<String, Seen>;

/// Returns the example files of a kind, with their texts.
fn examples(file: File) -> Vec<(PathBuf, String)> {
    let first_key = match file {
        File::Cell => "lineshaft:",
        File::Scenario => "scenario:",
        File::Table => "segments:",
    };
    let (mut folders, mut found) = (vec![Path::new(env!("CARGO_MANIFEST_DIR")).join("../launch-configs")], Vec::new());
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).expect("a folder of examples") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|extension| extension == "yaml") {
                let text = std::fs::read_to_string(&path).expect("a text");
                if text.lines().any(|line| line.starts_with(first_key)) {
                    found.push((path, text));
                }
            }
        }
    }
    found.sort();
    assert!(found.len() >= 5, "examples of a {}", file.name());
    found
}

fn merge(into: &mut Patterns, from: Patterns) {
    for (pattern, Seen { required, maps, kinds }) in from {
        let seen = into.entry(canonical(&pattern)).or_default();
        seen.required += required;
        seen.maps += maps;
        seen.kinds.extend(kinds);
    }
}

/// Returns the same pattern for conditions at any depth.
fn canonical(pattern: &str) -> String {
    let last = ["all[]", "any[]"].iter().filter_map(|list| pattern.rfind(*list).map(|at| at + list.len())).max();
    last.map_or_else(|| pattern.to_owned(), |end| format!("condition{}", &pattern[end..]))
}

/// Returns the example cells, which have no problems.
fn cells() -> Vec<(PathBuf, Cell)> {
    let read = |(path, text): (PathBuf, String)| {
        let cell = Cell::parse_observed(&path, &text).0.unwrap_or_else(|problems| panic!("{problems}"));
        (path, cell)
    };
    examples(File::Cell).into_iter().map(read).collect()
}

/// Returns the keys that the readers of a kind of file request.
fn asked(file: File) -> Patterns {
    let mut seen = Patterns::new();
    match file {
        File::Cell => {
            for (path, text) in examples(file) {
                merge(&mut seen, Cell::parse_observed(&path, &text).1.seen());
            }
            for text in extra::CELLS {
                merge(&mut seen, Cell::parse_observed(Path::new("extra.yaml"), text).1.seen());
            }
        }
        File::Scenario => {
            let cells = cells();
            for (path, text) in examples(file) {
                merge(&mut seen, observed_scenario(&path, &text, &cells));
            }
            let cell = Cell::parse("cell.yaml", extra::SCENARIO_CELL).unwrap_or_else(|problems| panic!("{problems}"));
            merge(&mut seen, Scenario::parse_observed(Path::new("extra.yaml"), extra::SCENARIO, &cell).1.seen());
        }
        File::Table => {
            for (path, _) in examples(file) {
                let mut document = Document::read(&path);
                let observer = document.observe();
                assert!(Description::read(&document).is_some(), "{}", path.display());
                merge(&mut seen, observer.seen());
            }
        }
    }
    seen
}

/// Reads a scenario with its cell: one with a similar name or in the same folder, or any other.
fn observed_scenario(path: &Path, text: &str, cells: &[(PathBuf, Cell)]) -> Patterns {
    let stem = |path: &Path| path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
    let own = stem(path).trim_end_matches(".scenario").to_owned();
    let folder = path.parent().map(stem).unwrap_or_default();
    let mut order: Vec<_> = cells.iter().collect();
    order.sort_by_key(|(cell, _)| {
        let is_beside = cell.parent() == path.parent() && stem(cell) == own;
        (!is_beside, stem(cell) != own, stem(cell) != folder, stem(cell) != "demo")
    });
    for (_, cell) in order {
        let (read, observer) = Scenario::parse_observed(path, text, cell);
        if read.is_ok() {
            return observer.seen();
        }
    }
    panic!("{} fits no cell", path.display());
}

/// Whether it is a parameter or a field in a table of the core.
fn is_catalogued(pattern: &str) -> bool {
    if let Some(key) = pattern.strip_prefix("machine.") {
        return ROWS.iter().any(|row| row.applies == Applies::Machine && row.key == key);
    }
    if let Some(key) = pattern.strip_prefix("axes.*.") {
        return ROWS.iter().any(|row| row.key == key || key.strip_prefix("homing.") == Some(row.key));
    }
    let Some(key) = pattern.strip_prefix("functions.*.") else { return false };
    let key = key.trim_end_matches("[]");
    TYPES.iter().any(|kind| kind.words.contains(&key) || kind.fields.iter().any(|field| field.name == key))
}

/// Whether it is an argument of a verb, which the page of interfaces lists.
fn is_of_verb(pattern: &str) -> bool {
    pattern.starts_with("steps[].do.") || pattern.starts_with("steps[].do[")
}

#[test]
fn reference_has_every_key_that_a_reader_asks_for_and_no_other() {
    for file in File::ALL {
        let seen = asked(file);
        let keys: BTreeMap<&str, &Key> = file.keys().map(|key| (key.path, key)).collect();
        assert_eq!(keys.len(), file.keys().count(), "a key of a {} is there twice", file.name());
        let is_listed_elsewhere = |pattern: &String| match file {
            File::Cell => is_catalogued(pattern),
            File::Scenario => is_of_verb(pattern),
            File::Table => false,
        };
        let is_strange = |pattern: &&String| {
            let is_known = ["", "condition"].contains(&pattern.as_str()) || keys.contains_key(pattern.as_str());
            !is_known && !is_listed_elsewhere(pattern)
        };
        let strange: Vec<_> = seen.keys().filter(is_strange).collect();
        let unseen: Vec<_> = keys.keys().filter(|path| !seen.contains_key(**path)).collect();
        assert!(strange.is_empty(), "keys of a {} that the reference lacks: {strange:#?}", file.name());
        assert!(unseen.is_empty(), "keys of the reference that no reader of a {} asks for: {unseen:#?}", file.name());
    }
}

#[test]
fn kinds_and_ranges_of_the_reference_are_those_of_the_readers() {
    let mut problems = Vec::new();
    for file in File::ALL {
        let seen = asked(file);
        for key in file.keys() {
            let Some(Seen { required, maps, kinds }) = seen.get(key.path) else { continue };
            if kinds.is_empty() {
                problems.push(format!("{}: no file gives it a value", key.path));
            }
            for kind in kinds.iter().filter(|kind| !takes(key, kind)) {
                problems.push(format!("{}: it is read as {kind:?}, the reference says {:?}", key.path, key.shapes));
            }
            if key.required && (required != maps || *maps == 0) {
                problems.push(format!("{}: {required} of {maps} readers require it", key.path));
            }
        }
    }
    assert!(problems.is_empty(), "{problems:#?}");
}

/// Whether the reference permits the way in which a value is read. A range given as text is not compared.
fn takes(key: &Key, asked: &ExpectedKind) -> bool {
    let is_scalar = !matches!(asked, ExpectedKind::List | ExpectedKind::Map);
    key.shapes.iter().any(|shape| match (shape, asked) {
        (Shape::Text, _) => is_scalar,
        // It is compared with names, or read as a number afterwards.
        (Shape::Choice(_) | Shape::Integer(..), ExpectedKind::Text) => true,
        (Shape::Boolean, ExpectedKind::Boolean) => true,
        (Shape::Integer(low, high), ExpectedKind::Integer(least, most)) => {
            !key.range.is_empty() || (low, high) == (least, most)
        }
        (Shape::Number | Shape::Quantity(_), ExpectedKind::Number) => true,
        (Shape::Number, ExpectedKind::Integer(..)) => true,
        (Shape::Quantity(_), ExpectedKind::Quantity) => true,
        (Shape::Choice(names), ExpectedKind::Choice(asked)) => asked.iter().all(|name| names.contains(&name.as_str())),
        (Shape::List, ExpectedKind::List) => true,
        (Shape::Map | Shape::Names, ExpectedKind::Map) => true,
        _ => false,
    })
}

#[test]
fn example_cells_have_a_unit_at_every_number_that_needs_one() {
    for (path, cell) in cells() {
        assert_eq!(cell.bare_numbers, [""; 0], "{}", path.display());
    }
}

#[test]
fn every_example_file_fits_its_schema() {
    for file in File::ALL {
        let schema = schema(file);
        for (path, text) in examples(file) {
            let value = Document::parse("example", text).json();
            let problems = validator::problems(&value, &schema);
            assert!(problems.is_empty(), "{}: {problems:#?}", path.display());
        }
    }
}

/// The parts that an editor uses, as defined by draft-07.
#[test]
fn schema_of_a_cell_has_required_keys_names_and_descriptions() {
    let schema = schema(File::Cell);
    assert_eq!(schema["$schema"], "http://json-schema.org/draft-07/schema#");
    assert_eq!(schema["required"], serde_json::json!(["cycle", "lineshaft"]));
    assert_eq!(schema["additionalProperties"], false);
    let backend = &schema["properties"]["backends"]["additionalProperties"];
    assert_eq!(backend["properties"]["type"]["enum"], serde_json::json!(["sim", "can"]));
    let node =
        &schema["properties"]["axes"]["additionalProperties"]["properties"]["drive"]["anyOf"][0]["properties"]["node"];
    assert_eq!(node["description"], "Node ID of the drive.");
    assert_eq!(node["anyOf"][0], serde_json::json!({"type": "integer", "minimum": 1, "maximum": 127}));
}

#[test]
fn files_with_rare_keys_fit_their_schemas() {
    let cells = extra::CELLS.iter().chain([&extra::SCENARIO_CELL]).map(|text| (File::Cell, *text));
    for (file, text) in cells.chain([(File::Scenario, extra::SCENARIO)]) {
        let problems = validator::problems(&Document::parse("extra", text).json(), &schema(file));
        assert!(problems.is_empty(), "{problems:#?}");
    }
}

/// A valid cell with one replaced part: the program refuses it, and so does the schema.
#[test]
fn typos_in_cells_do_not_fit_the_schema() {
    const GOOD: &str = "lineshaft: 1\ncycle: 1 ms\nbackends: {plant: {type: sim}}\nio: {start: {type: di, backend: plant, address: 0, latch: \
                        true}}\naxes:\n  x: {type: linear, scale: {increments: 1000, per: 1 mm}, drive: {backend: plant, address: 0}, \
                        max_velocity: 1 m/s, max_acceleration: 1 m/s^2, homing: {method: 35}, sim: {model: ideal}}\ngroups: {arm: [x]}\n";
    let schema = schema(File::Cell);
    let is_valid = |text: &str| validator::problems(&Document::parse("c", text).json(), &schema).is_empty();
    assert!(Cell::parse("c", GOOD).is_ok() && is_valid(GOOD));
    let typos = [
        ("cycle:", "cycel:"),
        ("lineshaft: 1", "lineshaft: 2"),
        ("cycle: 1 ms", "cycle: fast"),
        ("type: sim", "type: smi"),
        ("latch: true", "latch: yes"),
        ("address: 0, latch", "address: -1, latch"),
        ("increments: 1000", "increments: many"),
        ("drive: {backend", "drive: {backnd"),
        ("max_velocity", "max_velocty"),
        ("method: 35", "metod: 35"),
        ("model: ideal", "model: ideel"),
        ("axes:", "axis:"),
        ("type: linear, ", ""),
        ("arm: [x]", "arm: 5.5"),
    ];
    for (from, to) in typos {
        let text = GOOD.replacen(from, to, 1);
        assert_ne!(text, GOOD);
        assert!(Cell::parse("c", text.as_str()).is_err(), "the program takes {to}");
        assert!(!is_valid(&text), "the schema takes {to}");
    }
}

#[test]
fn typos_in_scenarios_do_not_fit_the_schema() {
    const GOOD: &str = "scenario: typos\nfor: 1 s\nsteps:\n  - {name: go, at: 0, do: {enable: {axes: [x]}}}\n  - {when: {all: [{signal: x.enabled, \
                        is: 1}]}, do: [{halt: {}}]}\nexpect:\n  - {signal: x.error, at: end, is: 0, mode: never}\n  - {event: {kind: latch}, count: \
                        0}\n";
    let cell = Cell::parse("cell.yaml", extra::SCENARIO_CELL).unwrap_or_else(|problems| panic!("{problems}"));
    let schema = schema(File::Scenario);
    let is_valid = |text: &str| validator::problems(&Document::parse("s", text).json(), &schema).is_empty();
    assert!(Scenario::parse("s", GOOD, &cell).is_ok() && is_valid(GOOD));
    let typos = [
        ("scenario:", "scenaro:"),
        ("for: 1 s", "for: ever"),
        ("steps:", "step:"),
        ("do: {enable", "do: {enabel"),
        ("do: [{halt", "do: [{hlat"),
        ("all: [{signal", "all: [{singal"),
        ("mode: never", "mode: neverr"),
        ("kind: latch", "kind: latsch"),
        ("count: 0", "count: none"),
        ("at: 0, do", "at: 0, doo"),
    ];
    for (from, to) in typos {
        let text = GOOD.replacen(from, to, 1);
        assert_ne!(text, GOOD);
        assert!(Scenario::parse("s", &text, &cell).is_err(), "the program takes {to}");
        assert!(!is_valid(&text), "the schema takes {to}");
    }
}

#[test]
fn keys_are_found_by_their_path_and_by_their_name() {
    let paths = |name: &str| find(name).map(|key| (key.file, key.path)).collect::<Vec<_>>();
    assert_eq!(paths("cycle"), [(File::Cell, "cycle")]);
    assert_eq!(paths("axes.*.joint"), [(File::Cell, "axes.*.joint")]);
    assert_eq!(paths("scenario"), [(File::Scenario, "scenario")]);
    let forms = [(File::Cell, "tables.*.form"), (File::Table, "form")];
    assert_eq!(paths("form"), forms);
    assert!(paths("no_such_key").is_empty());
}

#[test]
fn paths_are_split_into_their_steps() {
    assert_eq!(steps("axes.*.drive.node"), ["axes", "*", "drive", "node"]);
    assert_eq!(steps("groups.*[]"), ["groups", "*", "[]"]);
    assert_eq!(steps("tables.*.points[][]"), ["tables", "*", "points", "[]", "[]"]);
}

#[test]
fn every_key_has_a_description() {
    for key in keys() {
        let is_entry = key.path.ends_with(['*', ']']);
        assert!(key.meaning.ends_with('.') && !key.shapes.is_empty(), "{}", key.path);
        assert_eq!(key.example.is_empty(), is_entry, "{}", key.path);
        assert!(is_entry || key.example.starts_with(&format!("{}:", key.name())), "{}: {}", key.path, key.example);
        assert_eq!(key.required, key.default == "required", "{}", key.path);
    }
}

/// The three meanings of a number without a unit are in the reference and in the first tutorial.
#[test]
fn meanings_of_a_number_without_a_unit_are_documented() {
    let tutorial = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/tutorial-1-simulation.md");
    for page in [markdown(), std::fs::read_to_string(tutorial).expect("a page")] {
        for rule in ["`do`", "`at: 2` is cycle 2", "`is: 120` is 120 inc"] {
            assert!(page.contains(rule), "{rule} is missing in\n{page}");
        }
    }
}

#[test]
fn examples_of_the_reference_are_yaml() {
    for key in keys().filter(|key| !key.example.is_empty()) {
        let document = Document::parse("example", key.example);
        assert!(document.problems().is_empty(), "{}: {}", key.path, document.problems());
    }
}

#[test]
fn page_in_docs_is_the_one_that_the_program_makes() {
    crate::page::check("keys.md", "reference", |_| markdown());
}
