//! Reads key `ros.record_topics`: topics of the node that a bag of `run` records, apart from those of its cycles.

use super::names::quote;
use crate::document::Value;
use lineshaft_ros::surface::table::{Kind, ROWS};

/// Topics that a bag records as the node publishes them.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum RecordTopics {
    /// All topics that the node publishes.
    #[default]
    All,
    /// Topics with these names, relative to the node: `~/errors`.
    Only(Vec<String>),
}

impl RecordTopics {
    /// Topics that every bag records in each cycle.
    pub const ALWAYS: [&'static str; 6] =
        ["~/commands", "~/inputs", "~/events", "~/signals", "~/axis_states", "joint_states"];

    /// Whether the topic of that name is recorded. Topics of groups are selected together: `~/arm/controller_state` by
    /// `~/controller_state`.
    pub fn holds(&self, name: &str) -> bool {
        let Self::Only(names) = self else { return true };
        names.iter().any(|chosen| last_part(chosen) == last_part(name))
    }
}

/// Returns the last part of a topic name; it differs between all topics of the node.
fn last_part(name: &str) -> &str {
    name.rsplit('/').next().unwrap_or(name)
}

/// Returns the topics that can be selected.
fn chosen() -> impl Iterator<Item = &'static str> {
    let published = ROWS.iter().filter(|row| row.kind == Kind::Publisher).map(|row| row.name);
    published.filter(|name| !RecordTopics::ALWAYS.contains(name))
}

/// Reads `all`, `none`, or a list of names.
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
        // A name without an effect is refused, because leaving it out would make no difference.
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

    /// `all` includes everything that `ros2 bag record -a` records of a node, including parameter events.
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
