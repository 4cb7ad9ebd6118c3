//! Checks that no other module names a vocabulary, except in the files that register it.
//!
//! A name is an identifier with a part `amc`, `saia` or `wf`, in upper or lower case, except codes, which are rows of
//! one table for all; or a text that begins like the key of one of their parameters. docs/ARCHITECTURE.md has the list
//! of files that register them. Messages, comments and tests may name them.
//!
//! Also checks that above the crate of CAN only the files in [`CAN_FILES`] use it, so that another fieldbus needs files of
//! its own and no comparisons elsewhere.

mod program;
mod tree;

use program::{end_of_item, is_test_only, tokens};
use std::collections::BTreeSet;
use tree::{files, read};

const PAGE: &str = "docs/ARCHITECTURE.md";
/// Start of the line with the list in the page.
const LIST: &str = "Registered:";
const NAMES: [&str; 3] = ["amc", "saia", "wf"];

/// Files of the program that use the crate of CAN; a folder ends with a slash and includes all its files.
const CAN_FILES: [&str; 6] = [
    "node/src/cell/buses.rs",
    "node/src/cell/buses/",
    "node/src/cell/can.rs",
    "node/src/cli/can/",
    "node/src/run/can.rs",
    "node/src/run/can/",
];
/// File that alone distinguishes the kinds of backends.
const KINDS_FILE: &str = "node/src/cell/backends.rs";

/// Names in a file with their lines, and the modules of the file that are built only for tests.
type Named = (Vec<(usize, String)>, Vec<String>);

/// Whether the text is a key, or the beginning of one.
fn is_key(text: &str) -> bool {
    let is_plain =
        |key: &str| key.chars().all(|sign| sign.is_ascii_lowercase() || sign.is_ascii_digit() || "._".contains(sign));
    let key = text.trim_matches('"');
    NAMES.iter().any(|name| key.strip_prefix(name).is_some_and(|rest| rest.starts_with('.'))) && is_plain(key)
}

/// Whether an identifier has one of the names as a part: `Amc`, `run_saia`, `WfSignal`.
fn names_one(word: &str) -> bool {
    // Codes, and other constants.
    if word.chars().all(|sign| !sign.is_lowercase()) {
        return false;
    }
    let mut parts = String::new();
    for sign in word.chars() {
        if sign.is_uppercase() {
            parts.push('_');
        }
        parts.extend(sign.to_lowercase());
    }
    parts.split('_').any(|part| NAMES.contains(&part))
}

/// Returns the lines of a program that name a vocabulary, each with its name.
fn named(text: &str) -> Named {
    words(text, is_key, |word| word.starts_with('"') || names_one(word))
}

/// Returns the lines of a program that name the crate of CAN.
fn names_can(text: &str) -> Named {
    words(text, |_| false, |word| word == "lineshaft_can")
}

/// Returns the lines of a program with a wanted word, which may be a text that is `kept`.
fn words(text: &str, kept: impl Fn(&str) -> bool, is_wanted: impl Fn(&str) -> bool) -> Named {
    let tokens = tokens(text, kept);
    let (mut found, mut tests, mut at) = (Vec::new(), Vec::new(), 0);
    while let Some((line, word)) = tokens.get(at) {
        if is_test_only(&tokens, at) {
            let end = end_of_item(&tokens, at + 7);
            let module = (at..end).find(|at| tokens[*at].1 == "mod").and_then(|at| tokens.get(at + 1));
            tests.extend(module.map(|(_, name)| name.clone()));
            at = end;
            continue;
        }
        if is_wanted(word) {
            found.push((*line, word.clone()));
        }
        at += 1;
    }
    (found, tests)
}

/// Returns the files of a folder that are built without tests, with the names that they use.
fn production(within: &str, named: fn(&str) -> Named) -> Vec<(String, Vec<(usize, String)>)> {
    let of_folder = |file: &String| file.starts_with(within);
    let texts: Vec<_> = files(&[".rs"]).into_iter().filter(of_folder).map(|file| (named(&read(&file)), file)).collect();
    let folder = |file: &str| {
        let stem = file.strip_suffix(".rs").expect("a program").to_owned();
        let is_door = stem.ends_with("/mod") || stem.ends_with("/lib");
        if is_door { stem[..stem.len() - 4].to_owned() } else { stem }
    };
    let tests: Vec<String> = texts
        .iter()
        .flat_map(|((_, tests), file)| tests.iter().map(move |test| format!("{}/{test}", folder(file))))
        .collect();
    let is_test =
        |file: &str| tests.iter().any(|test| file == format!("{test}.rs") || file.starts_with(&format!("{test}/")));
    texts.into_iter().filter(|(_, file)| !is_test(file)).map(|((found, _), file)| (file, found)).collect()
}

/// Returns the files that the page lists; a folder ends with a slash and includes all its files.
fn registered(page: &str) -> BTreeSet<String> {
    let list = page.split(LIST).nth(1).and_then(|rest| rest.split("\n\n").next());
    let list = list.unwrap_or_else(|| panic!("{PAGE} has no list `{LIST}`"));
    list.split('`').skip(1).step_by(2).map(|file| format!("core/src/{file}")).collect()
}

/// Returns the entry of the list for that file.
fn entry<'l>(list: &'l BTreeSet<String>, file: &str) -> Option<&'l String> {
    list.iter().find(|entry| *entry == file || entry.ends_with('/') && file.starts_with(entry.as_str()))
}

#[test]
fn no_file_names_a_vocabulary_but_those_that_register_it() {
    let list = registered(&read(PAGE));
    let (mut faults, mut used) = (Vec::new(), BTreeSet::new());
    let outside =
        production("core/src/", named).into_iter().filter(|(file, _)| !file.starts_with("core/src/vocabulary/"));
    for (file, found) in outside.filter(|(_, found)| !found.is_empty()) {
        match entry(&list, &file) {
            Some(entry) => drop(used.insert(entry.clone())),
            None => faults.extend(found.iter().map(|(line, word)| format!("{file}:{line}: {word} names a vocabulary"))),
        }
    }
    faults.extend(list.difference(&used).map(|entry| format!("{PAGE}: {entry} names no vocabulary")));
    assert!(faults.is_empty(), "\n{}\n", faults.join("\n"));
}

#[test]
fn only_the_files_of_can_use_its_crate() {
    let list = CAN_FILES.map(str::to_owned).into();
    let (mut faults, mut used) = (Vec::new(), BTreeSet::new());
    for (file, found) in production("node/src/", names_can).into_iter().filter(|(_, found)| !found.is_empty()) {
        match entry(&list, &file) {
            Some(entry) => drop(used.insert(entry.clone())),
            None => faults.extend(found.iter().map(|(line, word)| format!("{file}:{line}: {word}"))),
        }
    }
    faults.extend(list.difference(&used).map(|entry| format!("{entry} does not use the crate of CAN")));
    assert!(faults.is_empty(), "\n{}\n", faults.join("\n"));
}

#[test]
fn only_one_file_distinguishes_the_kinds_of_backends() {
    let kinds = ["Backend::Can", "Backend::Sim", "BackendKind::Can", "BackendKind::Simulation", "DriveKeys::Can"];
    let names_one = |file: &String| {
        let text = read(file);
        kinds.iter().any(|kind| text.contains(kind))
    };
    let of_node = files(&[".rs"]).into_iter().filter(|file| file.starts_with("node/src/"));
    assert_eq!(of_node.filter(names_one).collect::<Vec<_>>(), [KINDS_FILE]);
}

#[test]
fn a_name_is_found_wherever_it_is_a_part_of_a_word_of_the_program() {
    let text = "
        use crate::vocabulary::{wf, amc::Amc}; // saia
        fn run_saia() { self.x(\"wf.md4\"); self.y(\"with wf.md4, saia.kprop\") }
        #[cfg(test)] mod tests { use wf; }
        const A: Code = Code::WF_NO_PARITY; /* wf */ struct WfSignal; enum Effect { NextSaiaCommand }
        let swf = \"wf\"; amcx
        key.starts_with(\"wf.\")
    ";
    let (found, tests) = named(text);
    let found: Vec<_> = found.iter().map(|(line, word)| (*line, word.as_str())).collect();
    let expected = [
        (2, "wf"),
        (2, "amc"),
        (2, "Amc"),
        (3, "run_saia"),
        (3, "\"wf.md4\""),
        (5, "WfSignal"),
        (5, "NextSaiaCommand"),
        (7, "\"wf.\""),
    ];
    assert_eq!(found, expected);
    assert_eq!(tests, ["tests"]);
}

#[test]
fn a_folder_in_the_list_stands_for_its_files() {
    let list = registered("text\n\nRegistered: `a/b.rs` (why), `c/`.\n\n`d.rs`");
    assert_eq!(list.iter().collect::<Vec<_>>(), ["core/src/a/b.rs", "core/src/c/"]);
    assert!(entry(&list, "core/src/c/x.rs").is_some() && entry(&list, "core/src/a/bc.rs").is_none());
}
