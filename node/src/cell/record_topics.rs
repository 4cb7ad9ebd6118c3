//! Key `ros.record_topics`: which topics of the node a bag of `run` holds, apart from those of its cycles.

use super::names::quote;
use crate::document::Value;
use lineshaft_ros::surface::table::{Kind, ROWS, Row};

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
        let is_known = |row: &&Row| row.kind == Kind::Publisher && row.name == text;
        if ROWS.iter().any(|row| is_known(&row)) {
            names.push(text.to_owned());
        } else {
            let known = ROWS.iter().filter(|row| row.kind == Kind::Publisher).map(|row| row.name);
            let known = known.collect::<Vec<_>>().join(", ");
            value.refuse(format!("{} is {}; one of {known} is allowed", value.label(), quote(text)), None);
        }
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

    #[test]
    fn no_two_published_topics_end_alike() {
        let published = || ROWS.iter().filter(|row| row.kind == Kind::Publisher).map(|row| last_part(row.name));
        let different: std::collections::BTreeSet<_> = published().collect();
        assert_eq!(different.len(), published().count());
    }
}
