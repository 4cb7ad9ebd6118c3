//! Remapping rules for topics, services, actions and the node.

use crate::layer::name::{FullName, NameError, NodeName};

/// Remapping rule for the name or the namespace of a node.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct NodeRule {
    /// Name of the node to which the rule is limited, if any.
    pub(super) node: Option<String>,
    /// Whether the rule is for the name; otherwise it is for the namespace.
    pub(super) of_name: bool,
    pub(super) to: String,
}

/// Remapping rule for topics and services.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Rule {
    node: Option<String>,
    topics: bool,
    services: bool,
    from: String,
    to: String,
}

pub(super) enum Parsed {
    Node(NodeRule),
    Name(Rule),
}

/// Parses `[NODE:]FROM:=TO`.
///
/// # Errors
/// Description of the error, as the end of a sentence.
pub(super) fn parse(given: &str) -> Result<Parsed, String> {
    let (from, to) = given.split_once(":=").ok_or("")?;
    let (topics, services) = ("rostopic://", "rosservice://");
    let (node, from) = match from.split_once(':') {
        Some(_) if from.starts_with(topics) || from.starts_with(services) => (None, from),
        Some((node, rest)) if rest.starts_with("//") => {
            return Err(format!(": {node}:// is neither {topics} nor {services}"));
        }
        Some((node, rest)) => (Some(node.to_owned()), rest),
        None => (None, from),
    };
    if node.as_deref() == Some("") || from.is_empty() || to.is_empty() {
        return Err(": a part of it is empty".to_owned());
    }
    let to = to.to_owned();
    Ok(match from {
        "__node" | "__name" => Parsed::Node(NodeRule { node, of_name: true, to }),
        "__ns" => Parsed::Node(NodeRule { node, of_name: false, to }),
        _ => {
            let (from_topic, from_service) = (from.strip_prefix(topics), from.strip_prefix(services));
            let bare = from_topic.or(from_service).unwrap_or(from).to_owned();
            Parsed::Name(Rule { node, topics: from_service.is_none(), services: from_topic.is_none(), from: bare, to })
        }
    })
}

/// Names that a node uses for its topics, services and actions: expanded with its own name, then remapped by the first rule that matches.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Names {
    node: NodeName,
    rules: Vec<Full>,
}

/// Rule with both names expanded.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Full {
    topics: bool,
    services: bool,
    from: FullName,
    to: FullName,
}

impl Names {
    /// Creates names without remapping rules.
    pub fn plain(node: NodeName) -> Self {
        Self { node, rules: Vec::new() }
    }

    pub(super) fn new(node: NodeName, rules: &[Rule]) -> Result<Self, NameError> {
        let is_for_us = |rule: &&Rule| rule.node.as_deref().is_none_or(|only| only == node.name());
        let full = |rule: &Rule| {
            let Rule { topics, services, .. } = *rule;
            Ok(Full { topics, services, from: substituted(&node, &rule.from)?, to: substituted(&node, &rule.to)? })
        };
        let rules = rules.iter().filter(is_for_us).map(full).collect::<Result<_, _>>()?;
        Ok(Self { node, rules })
    }

    /// Returns name and namespace of the node.
    pub fn node(&self) -> &NodeName {
        &self.node
    }

    /// Returns the full name of a topic.
    ///
    /// # Errors
    /// ROS does not allow the name.
    pub fn topic(&self, name: &str) -> Result<FullName, NameError> {
        Ok(self.remapped_topic(self.node.expand(name)?))
    }

    /// Returns the full name of a service.
    ///
    /// # Errors
    /// ROS does not allow the name.
    pub fn service(&self, name: &str) -> Result<FullName, NameError> {
        Ok(self.remapped_service(self.node.expand(name)?))
    }

    /// Returns the full name of an action, remapped by rules for topics. Its topics and services are then remapped as such.
    ///
    /// # Errors
    /// ROS does not allow the name.
    pub fn action(&self, name: &str) -> Result<FullName, NameError> {
        self.topic(name)
    }

    pub(in crate::layer) fn remapped_topic(&self, name: FullName) -> FullName {
        self.remapped(name, |rule| rule.topics)
    }

    pub(in crate::layer) fn remapped_service(&self, name: FullName) -> FullName {
        self.remapped(name, |rule| rule.services)
    }

    fn remapped(&self, name: FullName, applies: impl Fn(&Full) -> bool) -> FullName {
        let rule = self.rules.iter().find(|rule| applies(rule) && rule.from == name);
        rule.map_or(name, |rule| rule.to.clone())
    }
}

/// Expands a name of a rule, with `{node}` and `{ns}` or `{namespace}` in it.
fn substituted(node: &NodeName, name: &str) -> Result<FullName, NameError> {
    // The slash of the root namespace is not duplicated.
    let namespace = node.namespace().trim_end_matches('/');
    let with = |name: &str, word: &str, value: &str| name.replace(word, value);
    let name = with(&with(&with(name, "{node}", node.name()), "{ns}", namespace), "{namespace}", namespace);
    node.expand(&name)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(namespace: &str, rules: &[&str]) -> Names {
        let rule = |text: &&str| match parse(text).unwrap() {
            Parsed::Name(rule) => rule,
            Parsed::Node(_) => panic!("a rule for the node"),
        };
        Names::new(NodeName::new(namespace, "shaft").unwrap(), &rules.iter().map(rule).collect::<Vec<_>>()).unwrap()
    }

    fn topic(namespace: &str, rules: &[&str], name: &str) -> String {
        names(namespace, rules).topic(name).unwrap().to_string()
    }

    #[test]
    fn both_sides_of_a_rule_are_expanded() {
        for (rule, expected) in [
            ("joint_states:=js", "/cell/js"),
            ("joint_states:=/js", "/js"),
            ("joint_states:=~/js", "/cell/shaft/js"),
            ("/cell/joint_states:=/js", "/js"),
            ("/joint_states:=/js", "/cell/joint_states"),
            ("~/joint_states:=/js", "/cell/joint_states"),
            ("shaft:joint_states:=/js", "/js"),
            ("other:joint_states:=/js", "/cell/joint_states"),
            ("rostopic://joint_states:=/js", "/js"),
            ("shaft:rostopic://joint_states:=/js", "/js"),
            ("rosservice://joint_states:=/js", "/cell/joint_states"),
            ("joint_states:={node}/js", "/cell/shaft/js"),
            ("joint_states:={ns}/js", "/cell/js"),
            ("joint_states:={namespace}/{node}_js", "/cell/shaft_js"),
        ] {
            assert_eq!(topic("/cell", &[rule], "joint_states"), expected, "{rule}");
        }
        assert_eq!(topic("/", &["a:={ns}/b"], "a"), "/b", "the root namespace");
    }

    #[test]
    fn the_first_rule_that_fits_is_the_only_one() {
        assert_eq!(topic("/", &["a:=b", "a:=c", "b:=d"], "a"), "/b");
        assert_eq!(topic("/", &["rosservice://a:=s", "a:=b"], "a"), "/b");
        let both = names("/", &["rosservice://a:=s", "rostopic://a:=t"]);
        assert_eq!(both.service("a").unwrap().to_string(), "/s");
        assert_eq!(both.topic("a").unwrap().to_string(), "/t");
    }

    #[test]
    fn a_rule_for_an_action_holds_for_its_parts_and_a_part_may_have_its_own() {
        let names = names("/", &["~/move_axis:=/mover", "/mover/_action/cancel_goal:=/stop"]);
        let action = names.action("~/move_axis").unwrap();
        assert_eq!(action.to_string(), "/mover");
        let part = |part: &str| names.remapped_service(action.action_part(part)).to_string();
        assert_eq!((part("send_goal"), part("cancel_goal")), ("/mover/_action/send_goal".into(), "/stop".into()));
    }

    #[test]
    fn what_is_no_rule_is_refused() {
        let refused = |text: &str| match parse(text) {
            Err(sentence) => sentence,
            Ok(_) => panic!("{text} was taken"),
        };
        assert_eq!(refused("a=b"), "");
        for empty in [":=b", "a:=", ":a:=b", "n::=b"] {
            assert_eq!(refused(empty), ": a part of it is empty", "{empty}");
        }
        assert_eq!(refused("rosaction://a:=b"), ": rosaction:// is neither rostopic:// nor rosservice://");
        let node = NodeName::new("/", "shaft").unwrap();
        for bad in ["a:=b*", "a:=/b/", "a*:=b", "a:={other}/b", "a:=//b", "a:=rostopic://b"] {
            let Ok(Parsed::Name(rule)) = parse(bad) else { panic!("{bad}") };
            assert!(Names::new(node.clone(), &[rule]).is_err(), "{bad}");
        }
    }
}
