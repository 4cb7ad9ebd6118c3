//! The ledger of proofs: what tests name as proved exists in the specification and is not set aside.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// Each page of the specification, and what its short IDs begin with.
const PAGES: [(&str, &str); 7] = [
    ("macs.md", "MACS-"),
    ("amc.md", "AMC-"),
    ("saia-h3.md", "SAIA-"),
    ("wf725.md", "WF-"),
    ("amkasyn-a.md", "AMK-"),
    ("amkasyn-b.md", "AMK-"),
    ("amkasyn-c.md", "AMK-"),
];
const SOURCES: [&str; 5] = ["AMK-", "MACS-", "SAIA-", "WF-", "AMC-"];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the crate is in the workspace").to_owned()
}

/// Does a text have the shape of an ID, `MACS-HOME-03`?
fn is_id(text: &str) -> bool {
    let mut parts = text.split('-');
    let (Some(source), Some(group), Some(number), None) = (parts.next(), parts.next(), parts.next(), parts.next())
    else {
        return text.strip_prefix("MACS-O-").is_some_and(is_number);
    };
    let is_group = !group.is_empty() && group.chars().all(|c| c.is_ascii_uppercase() || c.is_ascii_digit());
    SOURCES.contains(&&*format!("{source}-")) && is_group && is_number(number.strip_prefix('O').unwrap_or(number))
}

fn is_number(text: &str) -> bool {
    (1..=3).contains(&text.len()) && text.chars().all(|c| c.is_ascii_digit())
}

/// The first word of a line of the specification, where it is one that can be an ID: in bold, in a list, in a table.
fn first_word(line: &str) -> &str {
    let text = line.trim_start().trim_start_matches(['-', '*', '|', '`', ' ']);
    let end = text.find(|c: char| !(c.is_ascii_uppercase() || c.is_ascii_digit() || c == '-')).unwrap_or(text.len());
    &text[..end]
}

/// Every ID of the specification.
fn specified() -> BTreeSet<String> {
    let mut ids = BTreeSet::new();
    for (page, prefix) in PAGES {
        let text = fs::read_to_string(root().join("docs/spec").join(page)).expect("a page of the specification");
        let body = text.lines().take_while(|line| !(line.starts_with("## ") && line.contains("Coverage")));
        for word in body.map(first_word).filter(|word| !word.is_empty()) {
            let has_source = SOURCES.iter().any(|source| word.starts_with(source));
            let id = if has_source { word.to_owned() } else { format!("{prefix}{word}") };
            if is_id(&id) {
                ids.insert(id);
            }
        }
    }
    ids
}

/// Every ID that docs/spec/not-applicable.md sets aside, with its reason.
fn set_aside() -> BTreeMap<String, String> {
    let text = fs::read_to_string(root().join("docs/spec/not-applicable.md")).expect("what is set aside");
    let lines = text.lines().filter_map(|line| line.strip_prefix("- ")?.split_once(": "));
    lines.map(|(id, reason)| (id.trim_matches('`').to_owned(), reason.to_owned())).collect()
}

/// All files of the project that may prove something.
fn files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("a folder of the project").map(|entry| entry.expect("an entry")) {
        let (path, name) = (entry.path(), entry.file_name());
        if entry.file_type().expect("a type").is_dir() {
            if !["target", ".git", "docs"].iter().any(|left_out| name == *left_out) {
                files(&path, found);
            }
        } else if path.extension().is_some_and(|end| ["rs", "py", "yaml", "yml"].iter().any(|known| end == *known)) {
            found.push(path);
        }
    }
}

/// The IDs of a range, `SAIA-REG-00..12`, or the one.
fn each(word: &str) -> Vec<String> {
    let range = word.split_once("..").and_then(|(first, last)| {
        let (group, number) = first.rsplit_once('-')?;
        Some((group, number.len(), number.parse::<u32>().ok()?, last.parse::<u32>().ok()?))
    });
    match range {
        Some((group, width, first, last)) => (first..=last).map(|n| format!("{group}-{n:0width$}")).collect(),
        None => vec![word.to_owned()],
    }
}

/// Every ID behind `Proves:`, with where it stands.
fn proved() -> Vec<(String, String)> {
    let (mut all, mut ids) = (Vec::new(), Vec::new());
    files(&root(), &mut all);
    for path in all {
        let Ok(text) = fs::read_to_string(&path) else { continue };
        let mut goes_on = false;
        for (number, line) in text.lines().enumerate() {
            let comment = line.trim_start().trim_start_matches(['/', '#', '!', '*']).trim_start();
            let behind = line.split_once("Proves: ");
            let rest = match behind {
                Some((before, behind)) if before.contains("//") || before.contains('#') => behind,
                None if goes_on && SOURCES.iter().any(|source| comment.starts_with(source)) => comment,
                _ => {
                    goes_on = false;
                    continue;
                }
            };
            goes_on = true;
            let place = format!("{}:{}", path.strip_prefix(root()).unwrap_or(&path).display(), number + 1);
            let words = rest.split([',', ' ']).map(|word| word.trim_end_matches('.'));
            ids.extend(words.filter(|word| !word.is_empty()).flat_map(each).map(|id| (id, place.clone())));
        }
    }
    ids
}

/// A name is no proof, but a wrong one is a lie.
#[test]
fn what_is_named_as_proved_exists_and_is_not_set_aside() {
    let (specified, aside, proved) = (specified(), set_aside(), proved());
    assert!(specified.len() > 1500 && proved.len() > 500, "{} specified, {} proved", specified.len(), proved.len());
    let wrong: Vec<String> = proved
        .iter()
        .filter_map(|(id, place)| match (specified.contains(id), aside.get(id)) {
            (true, None) => None,
            (true, Some(reason)) => Some(format!("{place}: {id} is set aside: {reason}")),
            (false, _) => Some(format!("{place}: {id} stands nowhere in docs/spec")),
        })
        .collect();
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
    let unknown: Vec<_> = aside.keys().filter(|id| !specified.contains(*id)).collect();
    assert!(unknown.is_empty(), "set aside, and nowhere in docs/spec: {unknown:?}");

    let named: BTreeSet<_> = proved.iter().map(|(id, _)| id).collect();
    let mut open: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    for id in specified.iter().filter(|id| !named.contains(id) && !aside.contains_key(*id)) {
        let (group, number) = id.rsplit_once('-').expect("an ID has a number");
        open.entry(group).or_default().push(number);
    }
    let (done, all) = (named.len(), specified.len());
    println!("{all} requirements: {done} proved, {} set aside; neither:", aside.len());
    open.iter().for_each(|(group, numbers)| println!("{group}-{}", numbers.join(", ")));
}
