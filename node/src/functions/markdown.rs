//! Generates the blocks of docs/functions.md from the tables.

use super::{default, facts, name, range, when};
use crate::interfaces::replaced;
use lineshaft_core::function::{Description, TYPES};
use std::fmt::Write;

/// Returns all blocks, one after the other.
pub fn markdown() -> String {
    let blocks = std::iter::once(types()).chain(TYPES.iter().map(block));
    blocks.collect::<Vec<_>>().join("\n")
}

/// Returns the page with regenerated blocks; the text around them is unchanged.
///
/// # Errors
/// Returns an error if the marks of a block are missing.
pub fn renewed(page: &str) -> Result<String, String> {
    let page = replaced(page, "types", &types())?;
    TYPES.iter().try_fold(page, |page, row| replaced(&page, row.name, &block(row)))
}

fn types() -> String {
    let mut text = "| type | what |\n|-|-|\n".to_owned();
    for row in TYPES {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "| [{0}](#{0}) | {1} |", row.name, row.help);
    }
    text
}

fn block(row: &Description) -> String {
    let mut text = "| | |\n|-|-|\n".to_owned();
    for (word, what) in facts(row) {
        let _ = writeln!(text, "| {word} | {what} |");
    }
    text += "\n| field | range | default | unit | counts | what | requirement |\n|-|-|-|-|-|-|-|\n";
    for field in row.fields {
        let (name, range, default, when) = (name(field), range(field), default(field), when(field));
        let help = field.help.replace('|', "\\|");
        let (unit, source) = (field.unit, field.source);
        let _ = writeln!(text, "| `{name}` | {range} | {default} | {unit} | {when} | {help} | {source} |");
    }
    text
}
