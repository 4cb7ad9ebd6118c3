//! Key `ros.record_topics`: which topics of the node a bag of `run` holds, apart from those of its cycles.

use super::names::quote;
use crate::document::Value;
use lineshaft_ros::surface::table::{Kind, ROWS};

/// Topics that a bag holds as the node publishes them.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum RecordTopics {
    /// All that the node publishes.
    #[default]
    All,
    /// Those of these names, as the node uses them: `~/errors`.
    Only(Vec<String>),
}

impl RecordTopics {
    /// Topics that every bag holds, by its cycles.
    pub const ALWAYS: [&'static str; 6] =
        ["~/commands", "~/inputs", "~/events", "~/signals", "~/axis_states", "joint_states"];

    /// Whether the topic of that name is recorded. Those of groups are chosen together: `~/arm/controller_state` by
    /// `~/controller_state`.
    pub fn holds(&self, name: &str) -> bool {
        let Self::Only(names) = self else { return true };
        names.iter().any(|chosen| last_part(chosen) == last_part(name))
    }
}

/// No two topics of the node end alike.
fn last_part(name: &str) -> &str {
    name.rsplit('/').next().unwrap_or(name)
}

/// The topics that can be chosen.
fn chosen() -> impl Iterator<Item = &'static str> {
    let published = ROWS.iter().filter(|row| row.kind == Kind::Publisher).map(|row| row.name);
    published.filter(|name| !RecordTopics::ALWAYS.contains(name))
}

/// `all`, `none`, or a list of names.
pub(super) fn read(value: &Value<'_>) -> Option<RecordTopics> {
    match value.peek() {
        Some("all") => return Some(RecordTopics::All),
        Some("none") => return Some(RecordTopics::Only(Vec::new())),
        _ => {}
    }
    let mut names = Vec::new();
    let values = value.list()?;
    for value in &values {
        let Some(text) = value.text() else { continue };
        if chosen().any(|name| name == text) {
            names.push(text.to_owned());
            continue;
        }
        // A name without an effect looks like a choice: leaving it out would change nothing.
        let why = if RecordTopics::ALWAYS.contains(&text) { ", which is always recorded" } else { "" };
        let allowed = chosen().collect::<Vec<_>>().join(", ");
        value.refuse(format!("{} is {}{why}; one of {allowed} is allowed", value.label(), quote(text)), None);
    }
    (names.len() == values.len()).then_some(RecordTopics::Only(names))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn topics_are_chosen_by_their_names_and_those_of_groups_together() {
        assert!(RecordTopics::default().holds("~/errors"));
        let some = RecordTopics::Only(vec!["~/controller_state".to_owned(), "/rosout".to_owned()]);
        assert!(some.holds("~/controller_state") && some.holds("~/arm/controller_state") && some.holds("/rosout"));
        assert!(!some.holds("~/errors"));
        assert!(!RecordTopics::Only(Vec::new()).holds("/rosout"));
    }

    /// What `ros2 bag record -a` records of a node, parameter events included, is in `all`.
    #[test]
    fn all_published_topics_are_chosen_or_always_recorded() {
        let chosen: Vec<_> = chosen().collect();
        assert_eq!(
            chosen,
            [
                "~/shaft",
                "~/functions",
                "~/errors",
                "/parameter_events",
                "/rosout",
                "robot_description",
                "~/transition_event",
                "/diagnostics",
                "~/cycle_statistics",
                "~/controller_state"
            ]
        );
        assert!(chosen.iter().all(|name| RecordTopics::All.holds(name)));
    }

    #[test]
    fn no_two_published_topics_end_alike() {
        let published = || ROWS.iter().filter(|row| row.kind == Kind::Publisher).map(|row| last_part(row.name));
        let different: std::collections::BTreeSet<_> = published().collect();
        assert_eq!(different.len(), published().count());
    }
}
