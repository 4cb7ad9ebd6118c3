//! Explains verbs of scenarios.

use super::section;
use crate::scenario::VERBS;
use lineshaft_ros::surface::table::{Kind, ROWS, Row};

pub(super) fn sections(name: &str, width: usize) -> Vec<String> {
    VERBS.iter().filter(|verb| verb.eq_ignore_ascii_case(name)).map(|verb| text(verb, width)).collect()
}

pub(super) fn names() -> Vec<String> {
    VERBS.iter().map(|&verb| verb.to_owned()).collect()
}

fn text(verb: &str, width: usize) -> String {
    let in_ros = ROWS.iter().find(|row| row.name.strip_prefix("~/") == Some(verb)).map_or(String::new(), same);
    let facts = [
        ("what", format!("a command in do of a step: do: {{{verb}: {{..}}}}")),
        ("in ROS", in_ros),
        ("documented", "docs/contract.md, section 5".to_owned()),
    ];
    let facts = facts.each_ref().map(|(label, said)| (*label, said.as_str()));
    section(&format!("{verb}: a verb of scenarios"), &facts, width)
}

/// Returns the equivalent service, action or topic.
fn same(row: &Row) -> String {
    let kind = match row.kind {
        Kind::Service => "service",
        Kind::Action => "action",
        Kind::Publisher | Kind::Subscription => "topic",
    };
    format!("{kind} {}, type {}", row.name, row.interface)
}
