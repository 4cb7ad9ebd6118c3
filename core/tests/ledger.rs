//! The ledger of proofs: requirements of docs/spec that a test proves, that are set aside, or that are open.
//!
//! A requirement is a line of a book that begins with its ID. A test, a scenario or a source names the requirements
//! that it proves, with commas between them; `MACS-STO-02..08` are seven of them. docs/spec/not-applicable.md sets some
//! aside, a line each, with the reason. All others are listed in docs/spec/open.md.

mod tree;

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use tree::{files, read, root};

/// Text before the IDs of a proof; in two parts, so that this line is none.
const PROVES: &str = concat!("Pro", "ves:");

/// The books, with the start of their IDs, which their own lines may omit.
const BOOKS: [(&str, &str); 7] = [
    ("macs.md", "MACS"),
    ("amc.md", "AMC"),
    ("saia-h3.md", "SAIA"),
    ("wf725.md", "WF"),
    ("amkasyn-a.md", "AMK"),
    ("amkasyn-b.md", "AMK"),
    ("amkasyn-c.md", "AMK"),
];

const ASIDE: &str = "docs/spec/not-applicable.md";
const OPEN: &str = "docs/spec/open.md";

const RENEW: &str = "LINESHAFT_RENEW=1 cargo test -p lineshaft-core --test ledger";

const HEAD: &str = "\
# Open

Requirements that no test proves and that are not [set aside](not-applicable.md), a line per group.
";

/// A word of a file with its place: `tests/motion.rs:12`.
#[derive(Debug, PartialEq)]
struct Named {
    place: String,
    word: String,
}

/// Whether it is an ID such as `AMK-FIPW-07`, `MACS-O-26` or `AMK-CAM-O3`: system, group, number.
fn is_id(word: &str) -> bool {
    let Some((stem, number)) = word.rsplit_once('-') else { return false };
    let Some((system, group)) = stem.split_once('-') else { return false };
    let digits = number.strip_prefix('O').unwrap_or(number);
    BOOKS.iter().any(|(_, known)| *known == system)
        && !group.is_empty()
        && group.bytes().all(|byte| byte.is_ascii_uppercase() || byte.is_ascii_digit())
        && (1..=3).contains(&digits.len())
        && digits.bytes().all(|byte| byte.is_ascii_digit())
}

/// Returns the ID at the start of a line of a book, after the sign of a list or the bar of a table.
fn requirement(line: &str, system: &str) -> Option<String> {
    let line = line.trim_start();
    let item = line.strip_prefix("- ").or_else(|| line.strip_prefix("* ")).or_else(|| line.strip_prefix('|'));
    let marks = ['`', '*'];
    let text = item.unwrap_or(line).trim_start().trim_start_matches(marks);
    let end = text.find(|sign: char| !sign.is_ascii_alphanumeric() && sign != '-').unwrap_or(text.len());
    let (word, rest) = text.split_at(end);
    let next = rest.trim_start_matches(marks).chars().next();
    if next.is_some_and(|sign| !sign.is_whitespace() && !"|:.,".contains(sign)) {
        return None;
    }
    [word.to_owned(), format!("{system}-{word}")].into_iter().find(|word| is_id(word))
}

/// Returns each requirement of the books with its place. After the heading of their coverage the books name IDs, but
/// have no requirements.
fn requirements() -> BTreeMap<String, String> {
    let mut found = BTreeMap::new();
    for (book, system) in BOOKS {
        let (file, mut count) = (format!("docs/spec/{book}"), 0);
        let text = read(&file);
        let lines = text.lines().take_while(|line| !(line.starts_with("## ") && line.contains("Coverage")));
        for (number, line) in (1..).zip(lines) {
            let Some(id) = requirement(line, system) else { continue };
            let place = format!("{file}:{number}");
            assert_eq!(found.insert(id.clone(), place.clone()), None, "{place}: {id} stands twice");
            count += 1;
        }
        assert!(count > 10, "{file} has {count} requirements");
    }
    found
}

/// Returns the words after each [`PROVES`] of a file. A list that ends in a comma continues in the next line.
fn named(file: &str, text: &str) -> Vec<Named> {
    let (mut found, mut goes_on) = (Vec::new(), false);
    for (number, line) in (1..).zip(text.lines()) {
        let words = match line.split_once(PROVES) {
            Some((_, words)) => words.trim(),
            None if goes_on => line.trim_start().trim_start_matches(['/', '!', '#']).trim(),
            None => continue,
        };
        goes_on = words.ends_with(',');
        let words = words.trim_end_matches(',').split(',');
        found.extend(words.map(|word| Named { place: format!("{file}:{number}"), word: word.trim().to_owned() }));
    }
    found
}

/// Returns the IDs of a word: its own, or those of a range; none if it is neither.
fn ids(word: &str) -> Option<Vec<String>> {
    let Some((first, last)) = word.split_once("..") else { return is_id(word).then(|| vec![word.to_owned()]) };
    let (stem, number) = first.rsplit_once('-')?;
    let (from, to): (u16, u16) = (number.parse().ok()?, last.parse().ok()?);
    let width = number.len();
    (is_id(first) && last.len() == width && from < to)
        .then(|| (from..=to).map(|number| format!("{stem}-{number:0width$}")).collect())
}

/// Returns everything that the tree names as proved; its pages prove nothing.
fn proofs() -> Vec<Named> {
    let files = files(&[".rs", ".py", ".yaml", ".yml"]).into_iter().filter(|file| !file.starts_with("docs/"));
    files.flat_map(|file| named(&file, &fs::read_to_string(root().join(&file)).unwrap_or_default())).collect()
}

/// Returns the requirements that are set aside: `- ID: reason`, a line each.
fn aside() -> BTreeMap<String, String> {
    let mut found = BTreeMap::new();
    for (number, line) in (1..).zip(read(ASIDE).lines()) {
        let Some(item) = line.strip_prefix("- ") else { continue };
        let place = format!("{ASIDE}:{number}");
        let (id, reason) = item.split_once(": ").unwrap_or((item, ""));
        assert!(is_id(id) && !reason.trim().is_empty(), "{place}: `{line}` is not `- ID: reason`");
        assert_eq!(found.insert(id.to_owned(), place.clone()), None, "{place}: {id} is set aside twice");
    }
    found
}

/// Returns the errors of a proof, a sentence each.
fn faults(proof: &Named, known: &BTreeMap<String, String>, aside: &BTreeMap<String, String>) -> Vec<String> {
    let Named { place, word } = proof;
    let Some(ids) = ids(word) else { return vec![format!("{place}: `{word}` is no ID of a requirement")] };
    let fault = |id: &String| match aside.get(id) {
        _ if !known.contains_key(id) => Some(format!("{place}: {id} stands in no book of docs/spec")),
        Some(there) => Some(format!("{place}: {id} is proved here and set aside in {there}")),
        None => None,
    };
    ids.iter().filter_map(fault).collect()
}

/// Returns numbers of a group as `01..03, 05`; those of oracles, which may begin with O, after the others.
fn ranges(mut numbers: Vec<&str>) -> String {
    let value = |number: &str| number.trim_start_matches('O').parse::<u16>().unwrap_or_default();
    numbers.sort_by_key(|number| (number.starts_with('O'), value(number)));
    let mut runs: Vec<(&str, &str)> = Vec::new();
    for number in numbers {
        match runs.last_mut() {
            Some((_, last)) if last.len() == number.len() && value(last) + 1 == value(number) => *last = number,
            _ => runs.push((number, number)),
        }
    }
    let text =
        |(first, last): &(&str, &str)| if first == last { (*first).to_owned() } else { format!("{first}..{last}") };
    runs.iter().map(text).collect::<Vec<_>>().join(", ")
}

/// Returns docs/spec/open.md.
fn page(open: &BTreeSet<String>) -> String {
    let mut groups: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    for (group, number) in open.iter().filter_map(|id| id.rsplit_once('-')) {
        groups.entry(group).or_default().push(number);
    }
    let lines = groups.into_iter().map(|(group, numbers)| format!("- {group}: {}\n", ranges(numbers)));
    format!("{HEAD}This page is made by a test: `{RENEW}` writes it anew.\n\n{}", lines.collect::<String>())
}

#[test]
fn proofs_exist_and_are_not_ignored() {
    let (known, aside) = (requirements(), aside());
    let proofs = proofs();
    assert!(proofs.len() > 500, "{} proofs", proofs.len());
    let faults: Vec<_> = proofs.iter().flat_map(|proof| faults(proof, &known, &aside)).collect();
    assert!(faults.is_empty(), "\n{}\n", faults.join("\n"));
}

#[test]
fn ignored_tests_exist() {
    let known = requirements();
    for (id, place) in aside() {
        assert!(known.contains_key(&id), "{place}: {id} stands in no book of docs/spec");
    }
}

#[test]
fn the_list_of_what_is_open_is_true() {
    let (known, aside) = (requirements(), aside());
    let proved: BTreeSet<_> = proofs().iter().filter_map(|proof| ids(&proof.word)).flatten().collect();
    let is_open = |id: &&String| !proved.contains(*id) && !aside.contains_key(*id);
    let open: BTreeSet<_> = known.keys().filter(is_open).cloned().collect();
    let made = page(&open);
    println!("{} requirements: {} set aside, {} open", known.len(), aside.len(), open.len());
    if std::env::var_os("LINESHAFT_RENEW").is_some() {
        fs::write(root().join(OPEN), made).unwrap();
        return;
    }
    let there = fs::read_to_string(root().join(OPEN)).unwrap_or_default();
    let lines = |text: &str| text.lines().map(str::to_owned).collect::<BTreeSet<_>>();
    let (old, new) = (lines(&there), lines(&made));
    let hint = format!("{OPEN} is not what the tree proves; write it anew: {RENEW}");
    let (gone, come): (Vec<_>, Vec<_>) = (old.difference(&new).collect(), new.difference(&old).collect());
    assert!(there == made, "{hint}\nin the page: {gone:#?}\nin the tree: {come:#?}");
}

/// The forms of requirements in the books.
#[test]
fn a_requirement_begins_its_line() {
    for (line, id) in [
        ("**MACS-ENC-04** ENCODERTYPE values", Some("MACS-ENC-04")),
        ("| O-26 | POSERR guide |", Some("MACS-O-26")),
        ("- MACS-CMD-08: x", Some("MACS-CMD-08")),
        ("| `CMD-08` | VEL |", Some("MACS-CMD-08")),
        ("as MACS-CMD-08 says", None),
        ("| POSERR (15) | ERR-06 |", None),
        ("MACS-CAN-01..21 are", Some("MACS-CAN-01")),
        ("MACS-CAN-01/21 are", None),
        ("AMK-FIPW-O12 an oracle", Some("AMK-FIPW-O12")),
    ] {
        assert_eq!(requirement(line, "MACS").as_deref(), id, "{line}");
    }
}

#[test]
fn a_proof_that_is_wrong_is_named_with_its_place() {
    let text = format!(
        "/// One line.\n///\n/// {PROVES} MACS-ENC-04, MACS-STO-02..04,\n/// SAIA-ENC-01, MACS-ENC-99\n#[test]\n\
         # {PROVES} MACS-ENC-04 and more\n// {PROVES} MACS-STO-04..02\n// {PROVES}\n"
    );
    let id = |id: &str, place: &str| (id.to_owned(), place.to_owned());
    let spec = ["MACS-ENC-04", "MACS-STO-02", "MACS-STO-04", "SAIA-ENC-01"].map(|known| id(known, "book:1"));
    let (known, aside) = (BTreeMap::from(spec), BTreeMap::from([id("SAIA-ENC-01", "aside:7")]));
    let found: Vec<_> = named("a.rs", &text).iter().flat_map(|proof| faults(proof, &known, &aside)).collect();
    let expected = [
        "a.rs:3: MACS-STO-03 stands in no book of docs/spec",
        "a.rs:4: SAIA-ENC-01 is proved here and set aside in aside:7",
        "a.rs:4: MACS-ENC-99 stands in no book of docs/spec",
        "a.rs:6: `MACS-ENC-04 and more` is no ID of a requirement",
        "a.rs:7: `MACS-STO-04..02` is no ID of a requirement",
        "a.rs:8: `` is no ID of a requirement",
    ];
    assert_eq!(found, expected);
}

#[test]
fn the_page_has_a_line_per_group() {
    let open = ["AMK-CAM-01", "AMK-CAM-02", "AMK-CAM-04", "AMK-CAM-O1", "AMK-CAM-O2", "WF-IF-09", "WF-IF-10"];
    let page = page(&open.map(str::to_owned).into());
    assert!(page.ends_with("anew.\n\n- AMK-CAM: 01..02, 04, O1..O2\n- WF-IF: 09..10\n"), "{page}");
}
