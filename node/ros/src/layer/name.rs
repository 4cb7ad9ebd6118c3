//! ROS names: nodes, namespaces, topics and services.

use std::fmt;

/// Maximum length of a node name, and of any other full name, as in `rmw`.
const MAX_NODE_NAME: usize = 255;
const MAX_FULL_NAME: usize = 247;

/// Name that ROS does not allow.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{kind} {given:?}: {problem}")]
pub struct NameError {
    kind: &'static str,
    given: String,
    problem: String,
}

impl NameError {
    fn new(kind: &'static str, given: &str, problem: impl Into<String>) -> Self {
        Self { kind, given: given.to_owned(), problem: problem.into() }
    }
}

/// Checks one token between slashes.
fn word(kind: &'static str, given: &str, word: &str) -> Result<(), NameError> {
    let refuse = |problem: String| Err(NameError::new(kind, given, problem));
    match word.chars().next() {
        None => return refuse("a word between two slashes is empty, at least one letter is needed".to_owned()),
        Some(first) if first.is_ascii_digit() => {
            return refuse(format!("{word:?} begins with {first}, only letters and _ are allowed at the beginning"));
        }
        Some(_) => {}
    }
    match word.chars().find(|c| !c.is_ascii_alphanumeric() && *c != '_') {
        Some(bad) => refuse(format!("{bad:?} is not allowed, only letters a-z, A-Z, digits and _ are")),
        None => Ok(()),
    }
}

/// Checks a name that starts with a slash.
fn rooted(kind: &'static str, given: &str, full: &str) -> Result<(), NameError> {
    let Some(rest) = full.strip_prefix('/') else {
        return Err(NameError::new(kind, given, "it does not begin with /"));
    };
    if full.len() > MAX_FULL_NAME {
        let length = full.len();
        let problem = format!("{full} has {length} characters, at most {MAX_FULL_NAME} are allowed");
        return Err(NameError::new(kind, given, problem));
    }
    rest.split('/').try_for_each(|part| word(kind, given, part))
}

/// Name and namespace of a node.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NodeName {
    namespace: String,
    name: String,
}

impl NodeName {
    /// Creates a node name in a namespace, `/` or `/a/b`; a missing leading `/` is added, as in ROS.
    pub fn new(namespace: &str, name: &str) -> Result<Self, NameError> {
        if name.is_empty() {
            return Err(NameError::new("node name", name, "it is empty, at least one letter is needed"));
        }
        if name.len() > MAX_NODE_NAME {
            let problem = format!("it has {} characters, at most {MAX_NODE_NAME} are allowed", name.len());
            return Err(NameError::new("node name", name, problem));
        }
        word("node name", name, name)?;
        let full = if namespace.starts_with('/') { namespace.to_owned() } else { format!("/{namespace}") };
        if full != "/" {
            rooted("namespace", namespace, &full)?;
        }
        Ok(Self { namespace: full, name: name.to_owned() })
    }

    /// Returns the name without namespace.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns the namespace, which starts with `/`.
    pub fn namespace(&self) -> &str {
        &self.namespace
    }

    /// Returns the name of the node's logger, with dots instead of slashes.
    pub fn logger(&self) -> String {
        self.to_string().trim_start_matches('/').replace('/', ".")
    }

    /// Returns the full name of a relative name: `/a` stays, `a` is in the namespace of the node, `~/a` is below the node.
    pub fn expand(&self, name: &str) -> Result<FullName, NameError> {
        let root = self.namespace.trim_end_matches('/');
        let full = match name.strip_prefix('~') {
            Some("") => self.to_string(),
            Some(rest) if rest.starts_with('/') => format!("{self}{rest}"),
            Some(_) => return Err(NameError::new("name", name, "~ must be followed by /")),
            None if name.is_empty() => return Err(NameError::new("name", name, "it is empty")),
            None if name.starts_with('/') => name.to_owned(),
            None => format!("{root}/{name}"),
        };
        rooted("name", name, &full)?;
        Ok(FullName(full))
    }
}

/// Writes `/namespace/name`.
impl fmt::Display for NodeName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.namespace.trim_end_matches('/'), self.name)
    }
}

/// Full name of a topic, service or action, which starts with `/`.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct FullName(String);

impl FullName {
    /// Returns the name of a topic or service of an action.
    pub(super) fn action_part(&self, part: &str) -> Self {
        Self(format!("{self}/_action/{part}"))
    }
}

impl fmt::Display for FullName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn full(namespace: &str, node: &str, name: &str) -> String {
        NodeName::new(namespace, node).unwrap().expand(name).unwrap().to_string()
    }

    #[test]
    fn names_expand_against_namespace_and_node() {
        assert_eq!(full("/", "lineshaft", "joint_states"), "/joint_states");
        assert_eq!(full("/cell/a", "lineshaft", "joint_states"), "/cell/a/joint_states");
        assert_eq!(full("/cell", "lineshaft", "/joint_states"), "/joint_states");
        assert_eq!(full("/", "lineshaft", "~/enable"), "/lineshaft/enable");
        assert_eq!(full("/cell", "lineshaft", "~/arm/move"), "/cell/lineshaft/arm/move");
        assert_eq!(full("/cell", "lineshaft", "~"), "/cell/lineshaft");
        assert_eq!(full("cell", "lineshaft", "a"), "/cell/a");
        assert_eq!(full("", "lineshaft", "a"), "/a");
    }

    #[test]
    fn names_of_action_parts_and_loggers() {
        let name = NodeName::new("/a", "n").unwrap().expand("~/b").unwrap();
        assert_eq!(name.action_part("send_goal").to_string(), "/a/n/b/_action/send_goal");
        assert_eq!(NodeName::new("/a/b", "n").unwrap().logger(), "a.b.n");
    }

    #[test]
    fn bad_names_are_refused_with_what_is_allowed() {
        let node = |namespace, name| NodeName::new(namespace, name).unwrap_err().to_string();
        assert_eq!(node("/", ""), r#"node name "": it is empty, at least one letter is needed"#);
        assert_eq!(node("/", "a-b"), r#"node name "a-b": '-' is not allowed, only letters a-z, A-Z, digits and _ are"#);
        assert_eq!(
            node("/", "2axes"),
            r#"node name "2axes": "2axes" begins with 2, only letters and _ are allowed at the beginning"#
        );
        assert!(node("/a/", "n").contains("a word between two slashes is empty"));
        assert!(node("/a//b", "n").contains("a word between two slashes is empty"));
        assert!(node("/", &"a".repeat(256)).contains("256 characters, at most 255"));
        assert!(NodeName::new("/", &"a".repeat(255)).is_ok());

        let name = |name: &str| NodeName::new("/", "n").unwrap().expand(name).unwrap_err().to_string();
        assert_eq!(name("~x"), r#"name "~x": ~ must be followed by /"#);
        assert_eq!(name(""), r#"name "": it is empty"#);
        assert!(name("a/{node}").contains("'{' is not allowed"));
        assert!(name(&"a".repeat(247)).contains("248 characters, at most 247"));
    }
}
