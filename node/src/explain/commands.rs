//! Explains commands of the program to a running node: `move`, `jog`. Scenarios and ROS have other names for some of
//! them.

use super::{section, verbs};

/// A command, the interface of the node that it uses, and the equivalent verb of scenarios.
const COMMANDS: [(&str, &str, &str); 10] = [
    ("state", "~/axis_states", ""),
    ("enable", "~/enable", "enable"),
    ("disable", "~/disable", "disable"),
    ("move", "~/move_axis", "move_axis"),
    ("jog", "~/setpoints", "setpoints"),
    ("home", "~/home_axis", "home_axis"),
    ("halt", "~/halt", "halt"),
    // Another name of halt.
    ("stop", "~/halt", "halt"),
    ("reset", "~/reset_errors", "reset_errors"),
    ("activate", "~/change_state", "activate"),
];

pub(super) fn sections(name: &str, width: usize) -> Vec<String> {
    let found = COMMANDS.iter().find(|(command, ..)| command.eq_ignore_ascii_case(name));
    let Some(&(command, in_ros, verb)) = found else { return Vec::new() };
    let what = format!("lineshaft {command} ..; all of it: lineshaft {command} --help");
    let facts: [(&str, &str); 4] =
        [("what", what.as_str()), ("in ROS", in_ros), ("verb", verb), ("documented", "docs/without-ros.md")];
    let mut sections = vec![section(&format!("{command}: a command to a node that runs"), &facts, width)];
    // A verb of the same name is found as a verb.
    if verb != command {
        sections.extend(verbs::sections(verb, width));
    }
    sections
}

/// Returns the verbs for the commands of that name.
pub(super) fn equivalents(is_called: impl Fn(&str) -> bool) -> impl Iterator<Item = &'static str> {
    let verbs = COMMANDS.into_iter().map(|(command, _, verb)| (command, verb));
    verbs.filter(move |(command, verb)| is_called(command) && !verb.is_empty()).map(|(_, verb)| verb)
}

pub(super) fn names() -> Vec<String> {
    COMMANDS.iter().map(|(command, ..)| (*command).to_owned()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::VERBS;
    use lineshaft_ros::surface::table::ROWS;

    #[test]
    fn each_command_names_an_interface_and_a_verb_that_exist() {
        for (command, in_ros, verb) in COMMANDS {
            assert!(ROWS.iter().any(|row| row.name == in_ros), "{command}: {in_ros}");
            assert!(verb.is_empty() || VERBS.contains(&verb), "{command}: {verb}");
        }
    }
}
