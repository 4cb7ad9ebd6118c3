//! Explains topics, services and actions, their types, and the ROS parameters of the node itself.

use super::{documented, section};
use crate::interfaces::{details, short};
use lineshaft_msgs::INTERFACES;
use lineshaft_ros::surface::table::{PARAMETERS, ParameterRow, ROWS};

const PAGE: &str = "docs/interfaces.md";

pub(super) fn sections(name: &str, width: usize) -> Vec<String> {
    let mut sections: Vec<String> = details(name, width).map(|text| text + &documented(PAGE)).into_iter().collect();
    sections.extend(type_text(name, width));
    sections.extend(PARAMETERS.iter().filter(|row| row.name == name).map(|row| parameter(row, width)));
    sections
}

pub(super) fn names() -> Vec<String> {
    let last = |name: &'static str| name.rsplit('/').next().unwrap_or(name).to_owned();
    let all = ROWS.iter().flat_map(|row| [row.name, row.interface]);
    let all = all.chain(INTERFACES.iter().map(|interface| interface.name)).map(last);
    all.chain(PARAMETERS.iter().map(|row| row.name.to_owned())).collect()
}

/// Returns the uses of a type; a type of another package is described in its own documentation.
fn type_text(name: &str, width: usize) -> Option<String> {
    let is_called = |interface: &str| {
        interface == name
            || short(interface) == name
            || interface.rsplit('/').next().is_some_and(|own| own.eq_ignore_ascii_case(name))
    };
    let found = ROWS.iter().find(|row| is_called(row.interface))?.interface;
    let users: Vec<_> = ROWS.iter().filter(|row| row.interface == found).map(|row| row.name).collect();
    let is_own = INTERFACES.iter().any(|interface| interface.name == found);
    let fields = if is_own { String::new() } else { format!("ros2 interface show {found}") };
    let facts = [("used by", users.join(", ")), ("fields", fields), ("documented", PAGE.to_owned())];
    let facts = facts.each_ref().map(|(label, said)| (*label, said.as_str()));
    Some(section(&format!("{found}: a type of ROS interfaces"), &facts, width))
}

fn parameter(row: &ParameterRow, width: usize) -> String {
    let kind = if row.read_only { format!("{}, read-only", row.kind) } else { row.kind.to_owned() };
    let facts: [(&str, &str); 4] =
        [("what", row.text), ("type", kind.as_str()), ("default", row.default), ("documented", PAGE)];
    section(&format!("{}: a ROS parameter of the node", row.name), &facts, width)
}
