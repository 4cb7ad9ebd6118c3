//! Generates the blocks of docs/interfaces.md from the tables.

use super::{kind_text, qos_text, short};
use lineshaft_core::parameter::{Applies, ROWS as CATALOGUE, Storage, System};
use lineshaft_msgs::INTERFACES;
use lineshaft_msgs::about::{Interface, Section};
use lineshaft_ros::surface::table::{Kind, PARAMETERS, ROWS};
use std::fmt::Write;

/// A block of the page: its name in the marks around it, and the function that generates it.
type Block = (&'static str, fn() -> String);

/// Blocks in the order of the page.
const BLOCKS: [Block; 3] = [("endpoints", endpoints), ("parameters", parameters), ("types", types)];

/// Returns all blocks, one after the other.
pub fn markdown() -> String {
    BLOCKS.map(|(_, make)| make()).join("\n")
}

/// Returns the page with regenerated blocks; the text around them is unchanged.
///
/// # Errors
/// Returns an error if the marks of a block are missing.
pub fn renewed(page: &str) -> Result<String, String> {
    BLOCKS.into_iter().try_fold(page.to_owned(), |page, (name, make)| replaced(&page, name, &make()))
}

/// Returns a page with one replaced block, between `<!-- begin NAME .. -->` and `<!-- end NAME -->`.
///
/// # Errors
/// Returns an error if the marks of the block are missing.
pub(crate) fn replaced(page: &str, name: &str, made: &str) -> Result<String, String> {
    let (begin, end) = (format!("<!-- begin {name}"), format!("<!-- end {name} -->"));
    let missing = || format!("the page has no `{begin} .. -->` with `{end}` below it");
    let (before, rest) = page.split_once(&begin).ok_or_else(missing)?;
    let (mark, rest) = rest.split_once("-->\n").ok_or_else(missing)?;
    let (_, after) = rest.split_once(&end).ok_or_else(missing)?;
    Ok(format!("{before}{begin}{mark}-->\n\n{made}\n{end}{after}"))
}

fn endpoints() -> String {
    let mut text = "| kind | name | type | QoS | what |\n| --- | --- | --- | --- | --- |\n".to_owned();
    for row in ROWS {
        let qos = if row.kind == Kind::Action { "actions".to_owned() } else { qos_text(row.qos) };
        let cells = [kind_text(row.kind), &format!("`{}`", row.name), &short(row.interface), &qos, row.text];
        line(&mut text, &cells);
    }
    text += "\nQoS: reliability, durability, depth. `actions`: its services and its feedback are reliable, volatile, 10, its status is \
             reliable,\ntransient local, 1.\n";
    text
}

fn parameters() -> String {
    let mut text = "| names | parameters | of |\n| --- | --- | --- |\n".to_owned();
    for system in [System::Native, System::Macs, System::Amc, System::Saia, System::Wf] {
        for (of_machine, name) in [(false, "<axis>"), (true, "machine")] {
            // A row that is stored as a signal is no parameter.
            let rows =
                CATALOGUE.iter().filter(|row| row.system == system && !matches!(row.storage, Storage::Signal(_)));
            let count = rows.filter(|row| (row.applies == Applies::Machine) == of_machine).count();
            if count > 0 {
                line(&mut text, &[&format!("`{name}.<key>`"), &count.to_string(), system.name()]);
            }
        }
    }
    text += "\nEach of them with type, unit, range, default and moment of effect: [parameters.md](parameters.md). Those of the node \
             itself:\n\n| name | type | default | what |\n| --- | --- | --- | --- |\n";
    for row in PARAMETERS {
        let kind = if row.read_only { format!("{}, read-only", row.kind) } else { row.kind.to_owned() };
        line(&mut text, &[&format!("`{}`", row.name), &kind, row.default, row.text]);
    }
    text
}

fn types() -> String {
    INTERFACES.iter().map(interface).collect::<Vec<_>>().join("\n")
}

fn interface(interface: &Interface) -> String {
    let mut text = format!("### {}\n", interface.name);
    for one in interface.sections {
        section(&mut text, one);
    }
    text
}

fn section(text: &mut String, section: &Section) {
    let Section { name, doc, constants, fields } = section;
    if !name.is_empty() {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "\n**{name}**");
    }
    if !doc.is_empty() {
        let _ = writeln!(text, "\n{}", escaped(doc));
    }
    if !fields.is_empty() {
        *text += "\n| field | type | what |\n| --- | --- | --- |\n";
        for field in *fields {
            line(text, &[&format!("`{}`", field.name), &format!("`{}`", field.kind), &escaped(field.doc)]);
        }
    }
    if !constants.is_empty() {
        *text += "\n| constant | value | what |\n| --- | --- | --- |\n";
        for constant in *constants {
            line(text, &[&format!("`{}`", constant.name), &constant.value.to_string(), &escaped(constant.doc)]);
        }
    }
}

fn line(text: &mut String, cells: &[&str]) {
    let cells: Vec<String> = cells.iter().map(|cell| cell.replace('|', "\\|").replace("\n\n", " ")).collect();
    let _ = writeln!(text, "| {} |", cells.join(" | "));
}

/// Escapes a comment of a file for Markdown, except text in backquotes, which is code already.
fn escaped(comment: &str) -> String {
    let mut out = String::new();
    let mut code = false;
    for c in comment.chars() {
        code ^= c == '`';
        if !code && "[]<>*~_".contains(c) {
            out.push('\\');
        }
        out.push(c);
    }
    out
}
