//! Checks that modules import only lower modules.
//!
//! A room is a module of core, of its axis, of the cells, or of the ROS layer; docs/ARCHITECTURE.md has the order of
//! the rooms, the lowest first. An import is every path that begins with `crate`, `super` or `self` and leads out of
//! the room: in a `use`, in an expression, through a re-export. Code that is built only for tests may import anything.
//! Inside a room files may import each other; docs/ARCHITECTURE.md limits the number of files in the largest import
//! cycle.

mod program;
mod tree;

use program::{Token, end_of_item, is_test_only};
use std::collections::{BTreeMap, BTreeSet};
use tree::{files, read};

const PAGE: &str = "docs/ARCHITECTURE.md";

/// Folders whose modules are rooms, with the path of the folder in its crate and its least number of imports.
const HOUSES: [(&str, &[&str], usize); 4] = [
    ("core/src", &[], 500),
    ("core/src/axis", &["axis"], 150),
    ("node/src/cell", &["cell"], 50),
    ("node/ros/src/layer", &["layer"], 50),
];

/// A path of modules, from the crate on.
type Module = Vec<String>;

/// A path that a file names.
#[derive(Clone, Debug, PartialEq)]
struct Import {
    line: usize,
    path: Module,
}

/// Imports of a file, and its modules that are built only for tests.
#[derive(Debug, Default)]
struct Named {
    imports: Vec<Import>,
    tests: Vec<Module>,
}

/// The production files of a folder, by their module.
struct Folders {
    folder: &'static str,
    /// Path of the folder's own module.
    own: Module,
    files: BTreeMap<Module, (String, Vec<Import>)>,
}

/// Entries of the page for a folder.
struct Order {
    rooms: Vec<String>,
    /// Room and size of the largest import cycle.
    circle: (String, usize),
}

/// Adds the paths of a tree of paths (`a::{b, c::d}`) that begins at `at`, after `base`, and returns the end of the
/// tree.
fn paths(tokens: &[Token], mut at: usize, mut base: Module, found: &mut Vec<Import>) -> usize {
    let is = |at: usize, sign: &str| tokens.get(at).is_some_and(|(_, word)| word == sign);
    while let Some((line, word)) = tokens.get(at) {
        if word == "{" {
            at += 1;
            while at < tokens.len() && !is(at, "}") {
                let end = paths(tokens, at, base.clone(), found);
                at = (end..tokens.len()).find(|end| is(*end, ",") || is(*end, "}")).unwrap_or(tokens.len());
                at += usize::from(is(at, ","));
            }
            return at + 1;
        }
        match word.as_str() {
            "super" => drop(base.pop()),
            "self" | "crate" => {}
            name if name.starts_with(|sign: char| sign.is_alphabetic() || sign == '_') => base.push(name.to_owned()),
            // A glob, or the types of a generic.
            _ => {
                found.push(Import { line: *line, path: base });
                return at;
            }
        }
        if !is(at + 1, "::") {
            found.push(Import { line: *line, path: base });
            return at + 1;
        }
        at += 2;
    }
    at
}

/// Returns the names in a file of that module.
fn named(text: &str, module: &Module) -> Named {
    let tokens = program::tokens(text, |_| false);
    let word = |at: usize| tokens.get(at).map_or("", |(_, word)| word.as_str());
    let is_test = |at: usize| is_test_only(&tokens, at);
    let (mut named, mut inner, mut depth, mut at) = (Named::default(), vec![(0, module.clone())], 0, 0);
    let mut macro_end = 0;
    while at < tokens.len() {
        let here = inner.last().map_or_else(Module::new, |(_, module)| module.clone());
        match word(at) {
            "#" if is_test(at) => {
                let names = (at..end_of_item(&tokens, at + 7)).find(|at| word(*at) == "mod").map(|at| word(at + 1));
                named.tests.extend(names.map(|name| [here, vec![name.to_owned()]].concat()));
                at = end_of_item(&tokens, at + 7);
                continue;
            }
            "mod" if word(at + 2) == "{" => inner.push((depth + 1, [here, vec![word(at + 1).to_owned()]].concat())),
            "{" => depth += 1,
            "}" => {
                inner.retain(|(at, _)| *at < depth || *at == 0);
                depth -= 1;
            }
            // A visibility is no import.
            "in" if word(at.wrapping_sub(1)) == "(" => {
                at = (at..tokens.len()).find(|at| word(*at) == ")").unwrap_or(tokens.len());
                continue;
            }
            "crate" if word(at + 1) == "::" => {
                at = paths(&tokens, at + 2, Module::new(), &mut named.imports);
                continue;
            }
            "macro_rules" => macro_end = end_of_item(&tokens, at),
            // The place of expansion of a macro decides the meaning of these.
            "super" | "self" | "use" if at < macro_end => {}
            "super" | "self" if word(at + 1) == "::" && word(at.wrapping_sub(1)) != "::" => {
                at = paths(&tokens, at, here, &mut named.imports);
                continue;
            }
            // A module of its own, unless it is a library's.
            "use" if !matches!(word(at + 1), "crate" | "super" | "self" | "::") => {
                at = paths(&tokens, at + 1, here, &mut named.imports);
                continue;
            }
            _ => {}
        }
        at += 1;
    }
    named
}

impl Folders {
    fn new(folder: &'static str, own: &[&str]) -> Self {
        let own: Module = own.iter().map(|name| (*name).to_owned()).collect();
        let below = files(&[".rs"]).into_iter().filter_map(|file| {
            let inside = file.strip_prefix(folder)?.strip_prefix('/')?.strip_suffix(".rs")?.to_owned();
            let parts = inside.split('/').map(str::to_owned).filter(|part| part != "mod" && part != "lib");
            Some((own.iter().cloned().chain(parts).collect(), file))
        });
        let texts: Vec<(Module, String, Named)> = below
            .map(|(module, file)| {
                let named = named(&read(&file), &module);
                (module, file, named)
            })
            .collect();
        let tests: Vec<Module> = texts.iter().flat_map(|(_, _, named)| named.tests.clone()).collect();
        let is_test = |module: &Module| tests.iter().any(|test| module.starts_with(test));
        let texts = texts.into_iter().filter(|(module, ..)| !is_test(module));
        let files = texts.map(|(module, file, named)| (module, (file, named.imports))).collect();
        Self { folder, own, files }
    }

    /// Returns the room of a module; none for the root module of the folder, which is above all rooms.
    fn room<'m>(&self, module: &'m Module) -> Option<&'m str> {
        module.strip_prefix(self.own.as_slice())?.first().map(String::as_str)
    }

    fn rooms(&self) -> BTreeSet<&str> {
        self.files.keys().filter_map(|module| self.room(module)).collect()
    }

    /// Returns each import that leads out of its room but not out of the folder: place, room, imported path.
    fn imports_between_rooms(&self) -> Vec<(String, &str, &Module)> {
        let mut found = Vec::new();
        for (module, (file, imports)) in &self.files {
            // The root module may import anything.
            let Some(room) = self.room(module) else { continue };
            for Import { line, path } in imports {
                if path.starts_with(&self.own) && self.room(path) != Some(room) {
                    found.push((format!("{file}:{line}"), room, path));
                }
            }
        }
        found
    }

    /// Returns the errors of the rooms, a sentence each.
    fn faults(&self, order: &[String]) -> Vec<String> {
        let rooms = self.rooms();
        let place = |room: &str| order.iter().position(|known| known == room);
        let mut found = Vec::new();
        for room in &rooms {
            if place(room).is_none() {
                found.push(format!("{}/{room}: {PAGE} gives this room no place", self.folder));
            }
        }
        for (index, room) in order.iter().enumerate() {
            if !rooms.contains(room.as_str()) || place(room) != Some(index) {
                found.push(format!("{PAGE}: {}/{room} is no room, or stands twice", self.folder));
            }
        }
        for (line, room, path) in self.imports_between_rooms() {
            // Items that are in no room belong to the root module.
            let is_below = |other: &str| rooms.contains(other) && place(other) < place(room);
            if !self.room(path).is_some_and(is_below) {
                let what = if path.is_empty() { "the door".to_owned() } else { path.join("::") };
                found.push(format!("{line}: {room} imports {what}, which stands above it"));
            }
        }
        found
    }

    /// Returns the largest import cycle of files in one room, the room first: each file reaches each other one by
    /// imports.
    fn import_cycle(&self) -> (String, Vec<&str>) {
        let modules: Vec<&Module> = self.files.keys().collect();
        let file_of = |path: &Module| {
            (0..=path.len()).rev().find_map(|end| modules.iter().position(|module| **module == path[..end]))
        };
        let mut reaches = vec![vec![false; modules.len()]; modules.len()];
        for (from, (_, imports)) in self.files.values().enumerate() {
            for to in imports.iter().filter_map(|import| file_of(&import.path)) {
                reaches[from][to] = self.room(modules[from]) == self.room(modules[to]);
            }
        }
        for over in 0..modules.len() {
            for from in 0..modules.len() {
                for to in 0..modules.len() {
                    reaches[from][to] |= reaches[from][over] && reaches[over][to];
                }
            }
        }
        let circle =
            |from: usize| (0..modules.len()).filter(|to| reaches[from][*to] && reaches[*to][from]).collect::<Vec<_>>();
        let circles = (0..modules.len()).filter(|from| self.room(modules[*from]).is_some()).map(circle);
        let largest = circles.max_by_key(Vec::len).unwrap_or_default();
        let room = largest.first().and_then(|file| self.room(modules[*file])).unwrap_or("no room").to_owned();
        (room, largest.into_iter().filter_map(|file| Some(self.files.get(modules[file])?.0.as_str())).collect())
    }
}

/// Returns the row of a folder in the page: rooms in their order, and the largest import cycle.
fn order(page: &str, folder: &str) -> Order {
    let row = page.lines().find_map(|line| line.strip_prefix(&format!("| `{folder}` |")));
    let row = row.unwrap_or_else(|| panic!("{PAGE} has no row `{folder}`"));
    let (rooms, circle) = row.split_once('|').unwrap_or((row, ""));
    let words = |text: &str| text.split('`').skip(1).step_by(2).map(str::to_owned).collect::<Vec<_>>();
    let count = circle.split(|sign: char| !sign.is_ascii_digit()).find_map(|number| number.parse().ok());
    Order { rooms: words(rooms), circle: (words(circle).pop().unwrap_or_default(), count.unwrap_or_default()) }
}

#[test]
fn no_room_imports_a_higher_one() {
    let page = read(PAGE);
    let mut faults = Vec::new();
    for (folder, own, least) in HOUSES {
        let house = Folders::new(folder, own);
        let count = house.imports_between_rooms().len();
        assert!(count >= least, "{folder} has {count} imports between rooms");
        faults.extend(house.faults(&order(&page, folder).rooms));
    }
    assert!(faults.is_empty(), "\n{}\n", faults.join("\n"));
}

#[test]
fn no_circle_of_files_is_larger_than_the_page_says() {
    let page = read(PAGE);
    for (folder, own, _) in HOUSES {
        let house = Folders::new(folder, own);
        let ((room, files), (named, most)) = (house.import_cycle(), order(&page, folder).circle);
        println!("{folder}: {} files of {room} import each other", files.len());
        // A file alone is no circle.
        let fits = files.len() <= most && (room == named || files.len() < most) || files.len() == 1;
        let list = files.join("\n");
        assert!(fits, "{} files of {room} import each other; {PAGE} says {most} of {named}:\n{list}", files.len());
    }
}

fn folders(texts: &[(&str, &str)]) -> Folders {
    let module = |path: &str| path.split('/').filter(|part| !part.is_empty()).map(str::to_owned).collect::<Module>();
    let files = texts.iter().map(|(path, text)| {
        let module = module(path);
        let imports = named(text, &module).imports;
        (module, (format!("{path}.rs"), imports))
    });
    Folders { folder: "src", own: Module::new(), files: files.collect() }
}

#[test]
fn upward_import_is_reported_with_its_position() {
    let house = folders(&[
        ("", "use b::B;"),
        ("a", "use crate::b::{B, c};\n\n/// [`b`](crate::b)\nfn f() { crate::e::g(\"crate::b\") }"),
        ("b", "use crate::a::A;\npub use super::a;\npub(in crate::e) fn f() {}"),
        ("b/c", "use super::super::{a::{A, B}, d::D};\nuse super::d;\nuse crate::{Door, *};"),
        ("d", ""),
    ]);
    let order = ["a", "b", "x", "d", "d"].map(str::to_owned);
    let expected = [
        "docs/ARCHITECTURE.md: src/x is no room, or stands twice",
        "docs/ARCHITECTURE.md: src/d is no room, or stands twice",
        "a.rs:1: a imports b::B, which stands above it",
        "a.rs:1: a imports b::c, which stands above it",
        "a.rs:4: a imports e::g, which stands above it",
        "b/c.rs:1: b imports d::D, which stands above it",
        "b/c.rs:3: b imports Door, which stands above it",
        "b/c.rs:3: b imports the door, which stands above it",
    ];
    assert_eq!(house.faults(&order), expected);
    assert_eq!(house.faults(&order[1..4])[0], "src/a: docs/ARCHITECTURE.md gives this room no place");
}

#[test]
fn imports_by_tests_alone_do_not_count() {
    let text = "
        #[cfg(test)] mod tests { use crate::b; fn f(a: u8, b: u8) { super::b() } }
        #[cfg(test)] use crate::{b, c::d};
        struct A { #[cfg(test)] b: crate::b::B, c: crate::c::C<'a, 'b> }
        mod inner { use super::super::d; fn f() { self::e() } }
        #[cfg(test)] mod fixtures;
        const X: &str = r#\"crate::\"b\"#; /* crate::b /* b */ crate::b */ const Y: char = '\\'';
        macro_rules! m { () => { $crate::f::<u8>::F; super::F } }
        fn f() -> Self { self.b; Self::b; x::super_b(crate::g) }
    ";
    let named = named(text, &vec!["a".to_owned()]);
    let paths: Vec<_> = named.imports.iter().map(|import| (import.line, import.path.join("::"))).collect();
    let expected = [(4, "c::C"), (5, "d"), (5, "a::inner::e"), (8, "f"), (9, "g")];
    assert_eq!(paths, expected.map(|(line, path)| (line, path.to_owned())));
    assert_eq!(named.tests, [["a", "tests"], ["a", "fixtures"]].map(|names| names.map(str::to_owned).to_vec()));
}

#[test]
fn indirect_mutual_imports_are_a_cycle() {
    let house = folders(&[
        ("a", "mod b; mod c; use b::B;"),
        ("a/b", "use crate::a::c::C;"),
        ("a/c", "use super::A;"),
        ("a/d", "use super::c;\nuse serde::Serialize;"),
        ("e", "use crate::f;"),
        ("f", "use crate::e;"),
    ]);
    assert_eq!(house.import_cycle(), ("a".to_owned(), vec!["a.rs", "a/b.rs", "a/c.rs"]));
}

#[test]
fn the_page_gives_the_order_and_the_largest_circle() {
    let order = order("| in | rooms | circle |\n| `core/src` | `a`, `b` | `b`: 12 files |\n", "core/src");
    assert_eq!((order.rooms, order.circle), (vec!["a".to_owned(), "b".to_owned()], ("b".to_owned(), 12)));
}
