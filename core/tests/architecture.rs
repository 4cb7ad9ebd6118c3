//! Checks docs/ARCHITECTURE.md: its picture has the crates of the workspace, its entry points have files and symbols.
//!
//! `tests/drawing/crates.py` draws the picture. The tables of section "Entry points" have the columns step, file and
//! symbol. Section "Own code instead of a library" gives two sentences of reason for each, with the versions of
//! Cargo.toml. docs/realtime.md lists the functions with the instructions of a moving axis.

mod tree;

use std::collections::{BTreeMap, BTreeSet};
use tree::{files, read};

const PAGE: &str = "docs/ARCHITECTURE.md";
const PICTURE: &str = "docs/images/crates.svg";
const SECTION: &str = "\n## Entry points\n";

/// Own code for which a library exists, by a part of its cell in the page.
const OWN_CODE: [&str; 6] =
    ["WebAssembly interpreter", "reader of MCAP", "YAML reading", "CDR reader", "ROS 2 layer", "CANopen master"];

/// Headings of the entry points.
const GOALS: [&str; 8] = [
    "Add a parameter",
    "Add a command",
    "Add a slot type",
    "Add a backend",
    "Add a ROS interface",
    "Add a scenario verb",
    "Add a signal",
    "Add an error code",
];

/// Contents of the picture: folders by crate, and dependencies as crate, crate, kind.
#[derive(Debug, Default, PartialEq)]
struct Crates {
    folders: BTreeMap<String, String>,
    dependencies: BTreeSet<[String; 3]>,
}

/// Returns the parts of a line between quotation marks.
fn quoted(line: &str) -> impl Iterator<Item = &str> {
    line.split('"').skip(1).step_by(2)
}

/// Returns the value of `key = "value"`.
fn value<'t>(line: &'t str, key: &str) -> Option<&'t str> {
    let rest = line.strip_prefix(key)?.trim_start().strip_prefix('=')?;
    quoted(rest).next()
}

/// Returns the name of a crate, and the keys of its sections of dependencies, each with its kind.
fn manifest(text: &str) -> (String, Vec<(String, &'static str)>) {
    let (mut name, mut keys, mut section) = (String::new(), Vec::new(), "");
    for line in text.lines().map(str::trim).filter(|line| !line.is_empty()) {
        if line.starts_with('[') {
            section = line;
            continue;
        }
        let kind = match section {
            "[package]" => {
                name = value(line, "name").map_or(name, str::to_owned);
                continue;
            }
            "[dependencies]" | "[build-dependencies]" => "normal",
            "[dev-dependencies]" => "dev",
            _ => continue,
        };
        let key = line.split([' ', '.', '=']).next().unwrap_or_default();
        keys.push((key.to_owned(), kind));
    }
    (name, keys)
}

/// Reads the Cargo.toml files of the workspace.
fn workspace() -> Crates {
    let text = read("Cargo.toml");
    let members = text.lines().find(|line| line.starts_with("members")).expect("the workspace has members");
    let mut found = Crates::default();
    let mut all = Vec::new();
    for folder in quoted(members) {
        let (name, keys) = manifest(&read(&format!("{folder}/Cargo.toml")));
        found.folders.insert(name.clone(), folder.to_owned());
        all.push((name, keys));
    }
    for (name, keys) in &all {
        // A crate that is needed anyway has no second arrow for the tests.
        let is_normal = |key: &String| keys.iter().any(|(other, kind)| other == key && *kind == "normal");
        for (key, kind) in keys {
            let is_shown = *kind == "normal" || !is_normal(key);
            if found.folders.contains_key(key) && is_shown {
                found.dependencies.insert([name.clone(), key.clone(), (*kind).to_owned()]);
            }
        }
    }
    found
}

/// Returns the value of an attribute of the element in a line.
fn attribute<'t>(line: &'t str, name: &str) -> Option<&'t str> {
    let (_, rest) = line.split_once(&format!(" {name}=\""))?;
    rest.split('"').next()
}

/// Reads crates and dependencies from the picture. An arrow and its line are in one line of the file, the name of a box
/// follows it.
fn drawn(picture: &str) -> Crates {
    let mut found = Crates::default();
    for line in picture.lines() {
        if let (Some(name), Some(folder)) = (attribute(line, "data-crate"), attribute(line, "data-folder"))
            && picture.contains(&format!(">{name}</text>"))
            && picture.contains(&format!(">{folder}/</text>"))
        {
            found.folders.insert(name.to_owned(), folder.to_owned());
        }
        let ends = (attribute(line, "data-from"), attribute(line, "data-to"), attribute(line, "data-kind"));
        if let (Some(from), Some(to), Some(kind)) = ends
            && line.contains("<path d=\"M")
        {
            found.dependencies.insert([from, to, kind].map(str::to_owned));
        }
    }
    found
}

/// Returns the section of entry points of a page.
fn section(page: &str) -> &str {
    let (_, rest) = page.split_once(SECTION).unwrap_or_else(|| panic!("{PAGE} has no section{SECTION}"));
    rest.split_once("\n## ").map_or(rest, |(section, _)| section)
}

/// Returns the parts of a text between backticks.
fn code(text: &str) -> impl Iterator<Item = &str> {
    text.split('`').skip(1).step_by(2)
}

/// Whether a text has a word that is not part of a longer one.
fn has_word(text: &str, word: &str) -> bool {
    let is_part = |sign: Option<char>| sign.is_some_and(|sign| sign.is_alphanumeric() || sign == '_');
    text.match_indices(word).any(|(at, _)| {
        let (before, after) = (&text[..at], &text[at + word.len()..]);
        !is_part(before.chars().next_back()) && !is_part(after.chars().next())
    })
}

/// A row of a table of entry points.
#[derive(Debug, PartialEq)]
struct Entry<'p> {
    heading: &'p str,
    file: &'p str,
    symbols: Vec<&'p str>,
}

/// Returns the rows of the tables of a section; an error names a row that lacks its file or its symbols.
fn entries(section: &str) -> Result<Vec<Entry<'_>>, String> {
    let (mut found, mut heading) = (Vec::new(), "");
    for line in section.lines() {
        heading = line.strip_prefix("### ").unwrap_or(heading);
        if !line.starts_with('|') || line.starts_with("| ---") || line.starts_with("| step |") {
            continue;
        }
        let cells: Vec<&str> = line.trim_matches('|').split('|').collect();
        let [_, file, symbols] = cells[..] else { return Err(format!("{line}: not step, file and symbol")) };
        let (file, symbols): (Vec<&str>, Vec<&str>) = (code(file).collect(), code(symbols).collect());
        match file[..] {
            [file] if !symbols.is_empty() => found.push(Entry { heading, file, symbols }),
            _ => return Err(format!("{line}: one file and at least one symbol in backticks")),
        }
    }
    Ok(found)
}

/// Returns what is wrong with an entry, given the text of its file if it exists.
fn faults(entry: &Entry<'_>, text: Option<&str>) -> Vec<String> {
    let Entry { heading, file, symbols } = entry;
    let Some(text) = text else { return vec![format!("{heading}: {file} does not exist")] };
    let missing = symbols.iter().filter(|symbol| !has_word(text, symbol));
    missing.map(|symbol| format!("{heading}: {file} has no {symbol}")).collect()
}

#[test]
fn picture_has_every_crate_and_every_dependency_of_the_workspace() {
    let (wanted, drawn) = (workspace(), drawn(&read(PICTURE)));
    assert!(wanted.folders.len() >= 8 && wanted.dependencies.len() >= 12, "{wanted:?}");
    let advice = "place new crates in tests/drawing/crates.py, then run it";
    let missing: Vec<_> = wanted.dependencies.difference(&drawn.dependencies).collect();
    let outdated: Vec<_> = drawn.dependencies.difference(&wanted.dependencies).collect();
    let is_same = missing.is_empty() && outdated.is_empty();
    assert!(is_same, "not in {PICTURE}: {missing:?}; only there: {outdated:?}; {advice}");
    assert_eq!(drawn.folders, wanted.folders, "crates of {PICTURE} and of the workspace; {advice}");
}

#[test]
fn page_starts_with_the_picture_and_then_the_entry_points() {
    let page = read(PAGE);
    let (before, _) = page.split_once("(images/crates.svg)").expect("the page shows the picture");
    assert!(!before.contains("\n## "), "the picture is before the first section");
    let first = page.lines().find(|line| line.starts_with("## "));
    assert_eq!(first, Some(SECTION.trim()));
}

#[test]
fn every_entry_point_names_a_file_that_has_its_symbols() {
    let page = read(PAGE);
    let entries = entries(section(&page)).unwrap_or_else(|error| panic!("{PAGE}: {error}"));
    for goal in GOALS {
        let rows = entries.iter().filter(|entry| entry.heading == goal).count();
        assert!(rows >= 4, "{PAGE}: {goal} has {rows} rows");
    }
    let there = files(&[".rs", ".md", ".srv", ".txt", ".yaml"]);
    let text = |file: &str| there.iter().any(|known| known == file).then(|| read(file));
    let wrong: Vec<String> = entries.iter().flat_map(|entry| faults(entry, text(entry.file).as_deref())).collect();
    assert!(wrong.is_empty(), "{PAGE}:\n{}\n", wrong.join("\n"));
}

#[test]
fn own_code_has_two_sentences_of_reason_with_versions_in_use() {
    let page = read(PAGE);
    for part in OWN_CODE {
        let row = page.lines().find(|line| line.starts_with("| ") && line.contains(part));
        let row = row.unwrap_or_else(|| panic!("{PAGE} has no row {part}"));
        let reason = row.trim_matches('|').rsplit('|').next().unwrap_or_default();
        assert!(reason.split(". ").count() >= 2, "{PAGE}: {part} has one sentence of reason:{reason}");
    }
    let (plain, manifest) = (page.replace('`', ""), read("Cargo.toml"));
    for library in ["mcap", "ros2-client", "rustdds"] {
        let line = manifest.lines().find(|line| line.starts_with(&format!("{library} =")));
        let version = line.and_then(|line| quoted(line).next()).expect("a version").trim_start_matches('=');
        assert!(plain.contains(&format!("{library} {version}")), "{PAGE} does not name {library} {version}");
    }
}

#[test]
fn instructions_of_a_moving_axis_add_up_to_the_figure_of_the_bench() {
    let page = read("docs/realtime.md");
    let (_, rest) = page.split_once("\n### Instructions of a moving axis\n").expect("the section");
    let section = rest.split_once("\n#").map_or(rest, |(section, _)| section);
    let sources: Vec<String> =
        files(&[".rs"]).iter().filter(|file| file.starts_with("core/src/")).map(|file| read(file)).collect();
    let (mut sum, mut count) = (0, 0);
    for row in section.lines().filter(|line| line.starts_with("| ") && line.contains('`')) {
        let function = code(row).next().expect("a function");
        let is_there = sources.iter().any(|text| text.contains(&format!("fn {function}(")));
        assert!(is_there, "docs/realtime.md: no function {function}");
        let figure = row.trim_matches('|').rsplit('|').next().unwrap_or_default().trim();
        sum += figure.parse::<u32>().unwrap_or_else(|error| panic!("docs/realtime.md: {row}: {error}"));
        count += 1;
    }
    assert!(
        (1..=10).contains(&count) && section.contains(&format!("{sum} instructions of an axis that moves")),
        "{sum}"
    );
    let stored = read("core/benches/instructions.txt");
    let measured = stored.lines().find_map(|line| {
        let figure = line.strip_prefix("moving ")?.trim_start().strip_prefix("64 ")?;
        figure.trim().parse::<u32>().ok()
    });
    let measured = measured.expect("the figure of 64 moving axes");
    let is_near = sum.abs_diff(measured) * 10 <= measured;
    assert!(is_near, "docs/realtime.md has {sum} instructions, the bench {measured}: profile it again");
}

#[test]
fn manifest_has_the_name_and_the_kinds_of_dependencies() {
    let text = "[package]\nname = \"a\"\nversion.workspace = true\n\n[dependencies]\nb.workspace = true\nc = { path = \"../c\" }\n\n\
                [dev-dependencies]\nd = \"1\"\n\n[features]\ne = []\n";
    let keys = [("b", "normal"), ("c", "normal"), ("d", "dev")].map(|(key, kind)| (key.to_owned(), kind));
    assert_eq!(manifest(text), ("a".to_owned(), keys.to_vec()));
}

#[test]
fn picture_without_a_box_or_an_arrow_is_found() {
    let picture = "<g data-crate=\"a\" data-folder=\"x/a\">\n<text>a</text>\n<text>x/a/</text>\n</g>\n\
                   <g data-crate=\"b\" data-folder=\"b\">\n<text>b/</text>\n</g>\n\
                   <g data-from=\"a\" data-to=\"b\" data-kind=\"dev\"><path d=\"M0 0V1\"/></g>\n\
                   <g data-from=\"b\" data-to=\"a\" data-kind=\"normal\"></g>\n";
    let found = drawn(picture);
    assert_eq!(found.folders.into_iter().collect::<Vec<_>>(), [("a".to_owned(), "x/a".to_owned())]);
    assert_eq!(found.dependencies.into_iter().collect::<Vec<_>>(), [["a", "b", "dev"].map(str::to_owned)]);
}

#[test]
fn entry_without_file_or_symbol_is_found() {
    let page = "\n## Entry points\n\n### Add x\n\n| step | file | symbol |\n| --- | --- | --- |\n\
                | first, `y` | `a.rs` | `b`, `c_d` |\n\n## Next\n\n| no | `b.rs` | `e` |\n";
    let found = entries(section(page)).expect("a table");
    assert_eq!(found, [Entry { heading: "Add x", file: "a.rs", symbols: vec!["b", "c_d"] }]);
    assert_eq!(faults(&found[0], None), ["Add x: a.rs does not exist"]);
    assert_eq!(faults(&found[0], Some("fn b() { c_d_e; bc }")), ["Add x: a.rs has no c_d"]);
    assert_eq!(faults(&found[0], Some("c_d::b")), [""; 0]);
    assert!(entries("| step | file | symbol |\n| a | `b.rs` | c |\n").is_err());
    assert!(entries("| a | `b.rs` |\n").is_err());
}
