//! Reads the tables of docs/errors.md: the text of each code, and the reaction of an axis to it.

use crate::code::{Code, DRIVE_FAULT};
use std::collections::{BTreeMap, BTreeSet};

/// Content of docs/errors.md for the tests.
pub(super) struct Page {
    /// Text of the page for each code number.
    pub says: BTreeMap<u32, String>,
    /// Rows of the reactions: text, place, and a keyword for each value of error_reaction.
    pub rows: Vec<(String, String, Vec<String>)>,
    words: BTreeMap<String, ExpectedReaction>,
}

/// Meaning of a keyword of the page.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ExpectedReaction {
    pub at_once: BTreeSet<String>,
    pub at_rest: BTreeSet<String>,
    pub locks: bool,
}

/// Returns the cells of the table after a line that starts with `head`.
fn table<'p>(page: &'p str, head: &str) -> Vec<Vec<&'p str>> {
    let lines = page.lines().skip_while(|line| !line.starts_with(head)).skip(2);
    let lines = lines.take_while(|line| line.starts_with('|'));
    let cells = |line: &'p str| line.trim_matches('|').split('|').map(str::trim).collect();
    lines.map(cells).collect()
}

impl Page {
    pub(super) fn read() -> Self {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/errors.md");
        let text = std::fs::read_to_string(path).expect("docs/errors.md");
        let codes = text.lines().filter(|line| line.starts_with("| ")).filter_map(|line| {
            let cells: Vec<_> = line.trim_matches('|').split('|').map(str::trim).collect();
            let number = match cells[0] {
                "65536 + 603Fh" => 65_536,
                number => number.parse().ok()?,
            };
            // Error reactions are also numbers in a table, but with two columns.
            (cells.len() > 3).then(|| (number, cells[cells.len() - 1].to_owned()))
        });
        let says: BTreeMap<_, _> = codes.collect();
        let rows = table(&text, "| reaction | where |").into_iter();
        let rows = rows.map(|cells| {
            let words = cells[2..].iter().map(|word| (*word).to_owned()).collect();
            (cells[0].to_owned(), cells[1].to_owned(), words)
        });
        let set = |cell: &str| cell.split(", ").map(str::to_owned).collect();
        let words = table(&text, "| word |").into_iter().map(|cells| {
            let deed = ExpectedReaction { at_once: set(cells[1]), at_rest: set(cells[2]), locks: cells[3] == "yes" };
            (cells[0].to_owned(), deed)
        });
        Self { says, rows: rows.collect(), words: words.collect() }
    }

    /// Returns the rows whose text starts the page text of a code; of several the longest.
    pub(super) fn rows_of(&self, code: Code) -> Vec<&(String, String, Vec<String>)> {
        let says = &self.says[&code.0.min(DRIVE_FAULT.code.0)];
        let fits = |row: &&(String, String, Vec<String>)| says.starts_with(&row.0);
        let longest = self.rows.iter().filter(fits).map(|row| row.0.len()).max().unwrap_or_default();
        self.rows.iter().filter(fits).filter(|row| row.0.len() == longest).collect()
    }

    /// Returns the reaction of an axis to an error of a code.
    pub(super) fn expected_reaction(&self, code: Code, place: &str, errcond: i64, endswmod: i64) -> &ExpectedReaction {
        let rows = self.rows_of(code);
        let switch = format!("`endswmod` {endswmod}");
        let row = rows.iter().find(|row| [String::new(), switch.clone(), place.to_owned()].contains(&row.1));
        let (_, _, words) = row.unwrap_or_else(|| panic!("{} {place}: no row in {rows:?}", code.0));
        &self.words[&words[errcond as usize]]
    }
}
