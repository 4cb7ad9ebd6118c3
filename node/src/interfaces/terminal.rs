//! Formats the output of `lineshaft interfaces`.

use super::{kind_text, qos_text, short};
use crate::parameters::wrap;
use crate::scenario::nearest;
use lineshaft_msgs::INTERFACES;
use lineshaft_msgs::about::{Interface, Section};
use lineshaft_ros::surface::table::{Kind, ROWS, Row};
use std::fmt::Write;

/// Indentation of a description.
const INDENT: usize = 8;
/// Maximum width of names in the column before their types; a longer name has its type on the next line.
const COLUMN: usize = 32;
/// Minimum width, even if the terminal is narrower.
const NARROWEST: usize = 30;

/// Returns every topic, service and action, `width` columns wide.
pub fn listing(width: usize) -> String {
    let name = ROWS.iter().map(|row| row.name.len()).filter(|name| *name <= COLUMN).max().unwrap_or(0);
    ROWS.iter().map(|row| endpoint(row, name, width)).collect()
}

fn endpoint(row: &Row, name: usize, width: usize) -> String {
    let (head, interface) = (format!("{:INDENT$}{:name$}", kind_text(row.kind), row.name), short(row.interface));
    let is_too_long = head.len() + 2 + interface.len() > width;
    let between = if is_too_long { format!("\n{:INDENT$}", "") } else { "  ".to_owned() };
    let mut text = format!("{head}{between}{interface}\n");
    if row.kind == Kind::Publisher || row.kind == Kind::Subscription {
        lines(&mut text, &qos_text(row.qos), INDENT, width);
    }
    lines(&mut text, &row.text.replace('`', ""), INDENT, width);
    text
}

/// Returns a type of lineshaft_msgs with the whole content of its file, or the type of a topic, a service or an action;
/// `None` if there is none of that name.
pub fn details(name: &str, width: usize) -> Option<String> {
    let row = ROWS.iter().find(|row| is_called(row, name));
    let wanted = row.map_or(name, |row| row.interface);
    let last = wanted.rsplit('/').next().unwrap_or(wanted);
    let named = |interface: &&Interface| {
        let own = interface.name.rsplit('/').next().unwrap_or(interface.name);
        interface.name == wanted
            || short(interface.name) == wanted
            || !wanted.contains('/') && own.eq_ignore_ascii_case(last)
    };
    let found = INTERFACES.iter().find(named);
    if row.is_none() && found.is_none() {
        return None;
    }
    let mut text = row.map_or(String::new(), |row| endpoint(row, row.name.len(), width) + "\n");
    match found {
        Some(found) => {
            let _ = writeln!(text, "{}", found.name);
            found.sections.iter().for_each(|part| section(&mut text, part, width));
        }
        // A type of another package is described in its own documentation.
        None => {
            let _ = writeln!(text, "{wanted} belongs to another package: `ros2 interface show {wanted}`");
        }
    }
    Some(text)
}

/// Returns the topic, service, action or type that is most similar to an unknown name.
pub fn meant(name: &str) -> Option<&'static str> {
    let own = |name: &'static str| name.rsplit('/').next().unwrap_or(name);
    let all = ROWS.iter().map(|row| row.name).chain(INTERFACES.iter().map(|interface| interface.name));
    nearest(name, all.map(own))
}

/// Whether it is the name of the row: with `~/`, without, or as in the graph.
fn is_called(row: &Row, name: &str) -> bool {
    let own = row.name.trim_start_matches("~/").trim_start_matches('/');
    let before = name.strip_suffix(own);
    // For the controller manager, the last part of the name is sufficient.
    own.rsplit('/').next() == Some(name)
        || before.is_some_and(|before| {
            before.is_empty() || before == "~/" || before.starts_with('/') && before.ends_with('/')
        })
}

fn section(text: &mut String, section: &Section, width: usize) {
    if !section.name.is_empty() {
        let _ = writeln!(text, "\n{}", section.name);
    }
    for paragraph in section.doc.split("\n\n").filter(|paragraph| !paragraph.is_empty()) {
        lines(text, paragraph, 2, width);
    }
    for constant in section.constants {
        let _ = writeln!(text, "  {} {}={}", constant.kind, constant.name, constant.value);
        lines(text, constant.doc, INDENT, width);
    }
    for field in section.fields {
        let _ = writeln!(text, "  {} {}", field.kind, field.name);
        lines(text, field.doc, INDENT, width);
    }
}

fn lines(text: &mut String, what: &str, indent: usize, width: usize) {
    for line in wrap(what, width.saturating_sub(indent).max(NARROWEST)) {
        let _ = writeln!(text, "{:indent$}{line}", "");
    }
}
