//! Checks every link to a file or a heading in the pages of the project, and every page that a text names.

mod tree;

use std::collections::BTreeSet;
use std::fs;
use std::path::{Component, Path, PathBuf};
use tree::{files, read, root};

/// Returns every page with its path from the root and its text.
fn pages() -> impl Iterator<Item = (PathBuf, String)> {
    files(&[".md"]).into_iter().map(|file| (file.clone().into(), read(&file)))
}

/// Returns a path from a folder, both from the root, without its dots; none if it leaves the root.
fn join(folder: &Path, path: &str) -> Option<PathBuf> {
    let mut joined = PathBuf::new();
    for part in folder.join(path).components() {
        match part {
            Component::Normal(name) => joined.push(name),
            Component::CurDir => {}
            Component::ParentDir if joined.pop() => {}
            _ => return None,
        }
    }
    Some(joined)
}

/// Returns the name of a heading in links: small letters, hyphens for spaces, no other signs.
fn anchor(heading: &str) -> String {
    let sign = |sign: char| match sign {
        ' ' => Some('-'),
        '-' | '_' => Some(sign),
        _ => sign.is_alphanumeric().then_some(sign),
    };
    heading.trim_start_matches('#').trim().to_lowercase().chars().filter_map(sign).collect()
}

fn anchors(text: &str) -> BTreeSet<String> {
    text.lines().filter(|line| line.starts_with('#')).map(anchor).collect()
}

/// Returns the targets of the links of a line, `[text](target)`, without addresses.
fn links(line: &str) -> impl Iterator<Item = &str> {
    let targets = line.split("](").skip(1).filter_map(|rest| rest.split([')', ' ']).next());
    targets.filter(|target| !target.contains("://") && !target.starts_with("mailto:"))
}

/// Returns names of pages in a line, links or not: `docs/io.md`, not `wf.md42` and not `x.wf.md`.
fn names(line: &str) -> impl Iterator<Item = &str> {
    let words = line.split(|sign: char| !(sign.is_ascii_alphanumeric() || "_-./".contains(sign)));
    words.map(|word| word.trim_end_matches('.')).filter(|word| {
        let file = word.rsplit('/').next().unwrap_or(word);
        file.strip_suffix(".md").is_some_and(|stem| !stem.is_empty() && !stem.contains('.'))
    })
}

#[test]
fn every_link_leads_to_a_file_and_to_a_heading_of_it() {
    let (mut broken, mut count) = (Vec::new(), 0);
    for (page, text) in pages() {
        let folder = page.parent().unwrap_or(Path::new(""));
        for (number, line) in (1..).zip(text.lines()) {
            for link in links(line) {
                count += 1;
                let (path, heading) =
                    link.split_once('#').map_or((link, None), |(path, heading)| (path, Some(heading)));
                let file = if path.is_empty() { Some(page.clone()) } else { join(folder, path) };
                let place = format!("{}:{number}", page.display());
                let Some(file) = file.map(|file| root().join(file)).filter(|file| file.exists()) else {
                    broken.push(format!("{place}: no file is called {path}"));
                    continue;
                };
                let has = |heading| fs::read_to_string(&file).is_ok_and(|text| anchors(&text).contains(heading));
                if heading.is_some_and(|heading| !has(heading)) {
                    broken.push(format!("{place}: {link} leads to no heading"));
                }
            }
        }
    }
    assert!(broken.is_empty(), "\n{}\n", broken.join("\n"));
    assert!(count > 50, "{count} links");
}

/// A page is named relative to its own folder, to the root, or to docs.
#[test]
fn every_page_that_a_page_names_is_there() {
    let (mut missing, mut count) = (Vec::new(), 0);
    for (page, text) in pages() {
        let folders =
            [page.parent().unwrap_or(Path::new("")), Path::new(""), Path::new("docs"), Path::new("docs/spec")];
        for (number, line) in (1..).zip(text.lines()) {
            for name in names(line) {
                count += 1;
                if !folders.iter().filter_map(|folder| join(folder, name)).any(|file| root().join(file).exists()) {
                    missing.push(format!("{}:{number}: no page is called {name}", page.display()));
                }
            }
        }
    }
    assert!(missing.is_empty(), "\n{}\n", missing.join("\n"));
    assert!(count > 100, "{count} names");
}

/// The contents of the book list every page of docs; mdBook shows no other page.
#[test]
fn summary_lists_every_page_of_docs_once() {
    let (summary, all) = (read("docs/SUMMARY.md"), files(&[".md"]));
    let listed: Vec<&str> = summary.lines().flat_map(links).collect();
    let pages = all.iter().filter_map(|file| file.strip_prefix("docs/"));
    let pages: Vec<&str> = pages.filter(|page| !page.contains('/') && *page != "SUMMARY.md").collect();
    let mut wrong = Vec::new();
    for page in &pages {
        let count = listed.iter().filter(|name| *name == page).count();
        if count != 1 {
            wrong.push(format!("docs/SUMMARY.md lists {page} {count} times"));
        }
    }
    for name in listed.iter().filter(|name| !pages.contains(name)) {
        wrong.push(format!("docs/SUMMARY.md lists {name}, which is no page of docs"));
    }
    assert!(wrong.is_empty(), "\n{}\n", wrong.join("\n"));
    assert!(pages.len() > 30, "{} pages", pages.len());
}

#[test]
fn links_names_and_headings_are_read_as_a_browser_does() {
    let line = "see [io](docs/io.md#a-b), ![x](../images/x.svg) and [it](https://a.b/c.md); `x.wf.md*`, wf.md42, spec/macs.md.";
    assert_eq!(links(line).collect::<Vec<_>>(), ["docs/io.md#a-b", "../images/x.svg"]);
    assert_eq!(
        names("docs/io.md, `x.wf.md*`, wf.md42, spec/macs.md.").collect::<Vec<_>>(),
        ["docs/io.md", "spec/macs.md"]
    );
    assert_eq!(anchor("## Where the words, of `x`, live"), "where-the-words-of-x-live");
    assert_eq!(join(Path::new("docs"), "../README.md"), Some("README.md".into()));
    assert_eq!(join(Path::new(""), "../README.md"), None);
}
