//! Parameter overrides of a node at its start: `-p` and `--params-file`.

use std::collections::BTreeMap;
use std::io::Read;

use lineshaft_msgs::foreign::rcl_interfaces::msg::ParameterValue;

use super::yaml::{self, Yaml};
use crate::layer::file::open_file;
use crate::layer::name::NodeName;

/// Key under which a file contains the parameters of a node.
const PARAMETERS: &str = "ros__parameters";

/// Pattern of node names: tokens separated by slashes, `*` for any one token, `**` for any number of tokens.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Pattern(Vec<String>);

impl Pattern {
    /// Parses a name; without a leading slash it is in the root namespace, as in rclcpp.
    fn parse(text: &str) -> Result<Self, String> {
        let words: Vec<String> = text.trim_start_matches('/').split('/').map(str::to_owned).collect();
        let is_word = |word: &String| !word.is_empty() && word.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
        match words.iter().find(|word| !is_word(word) && !matches!(word.as_str(), "*" | "**")) {
            Some(word) => Err(format!("{text:?} is no name of a node: {word:?} is no word, * or **")),
            None => Ok(Self(words)),
        }
    }

    fn everything() -> Self {
        Self(vec!["**".to_owned()])
    }

    fn is_for_many(&self) -> bool {
        self.0.iter().any(|word| word.starts_with('*'))
    }

    fn fits(&self, node: &NodeName) -> bool {
        let full = node.to_string();
        let words: Vec<&str> = full.trim_start_matches('/').split('/').collect();
        fits(&self.0, &words)
    }
}

fn fits(pattern: &[String], words: &[&str]) -> bool {
    match pattern.split_first() {
        None => words.is_empty(),
        Some((any, rest)) if any == "**" => (0..=words.len()).any(|from| fits(rest, &words[from..])),
        Some((word, rest)) => {
            words.split_first().is_some_and(|(first, others)| (word == "*" || word == first) && fits(rest, others))
        }
    }
}

/// Parameter override for the nodes of a pattern.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Override {
    nodes: Pattern,
    name: String,
    given: OverrideValue,
}

/// Parameter override of a node.
#[derive(Clone, Debug, PartialEq)]
pub struct OverrideValue {
    /// Value; an empty list, whose type is unknown, is an empty byte array.
    pub value: ParameterValue,
    /// Place where it was given.
    pub place: String,
    /// Whether it was given in a file, which may be a dump of all parameters; otherwise it was given on the command line.
    pub is_of_file: bool,
    /// Whether it was given for this node only; otherwise for several nodes, of which another one may have this parameter.
    pub is_for_this_node_only: bool,
}

/// Parses `[NODE:]NAME:=VALUE`.
///
/// # Errors
/// Description of the error, as the end of a sentence.
pub(super) fn parse(flag: &str, given: &str) -> Result<Override, String> {
    let (name, value) = given.split_once(":=").ok_or("")?;
    let (nodes, name) = match name.split_once(':') {
        Some((node, name)) => (Pattern::parse(node).map_err(|error| format!(": {error}"))?, name),
        None => (Pattern::everything(), name),
    };
    if name.is_empty() || name.contains(|c: char| c.is_whitespace() || c == ':') {
        return Err(format!(": {name:?} is no name of a parameter"));
    }
    let value = yaml::parse(value).and_then(|yaml| yaml.value()).map_err(|error| format!(": {}", error.sentence))?;
    let place = format!("{flag} {name}");
    Ok(Override {
        nodes,
        name: name.to_owned(),
        given: OverrideValue { value, place, is_of_file: false, is_for_this_node_only: true },
    })
}

/// Reads a parameter file.
///
/// # Errors
/// Description of the error with its place.
pub(super) fn read_file(path: &str) -> Result<Vec<Override>, String> {
    let mut text = String::new();
    let opened = open_file(path.as_ref()).and_then(|file| file.take(yaml::LONGEST + 1).read_to_string(&mut text));
    match opened {
        Err(error) => Err(format!("--params-file {path}: {error}")),
        Ok(_) if text.len() as u64 > yaml::LONGEST => {
            Err(format!("{path}: the file is longer than {} bytes", yaml::LONGEST))
        }
        Ok(_) => read(path, &text),
    }
}

fn read(path: &str, text: &str) -> Result<Vec<Override>, String> {
    let mut found = Vec::new();
    let tree = yaml::parse(text);
    let read = tree.and_then(|tree| nodes(path, "", &tree, &mut found));
    read.map_err(|error| format!("{path}:{}:{}: {}", error.line, error.column, error.sentence))?;
    Ok(found)
}

/// Reads nodes, and namespaces with nodes in them.
fn nodes(path: &str, prefix: &str, tree: &Yaml, found: &mut Vec<Override>) -> Result<(), yaml::YamlError> {
    for (key, value) in tree.map("names of nodes with ros__parameters below them are")? {
        if key.text == PARAMETERS {
            let pattern = if prefix.is_empty() {
                Err(format!("{PARAMETERS} stands below no node; /**: would give it to all"))
            } else {
                Pattern::parse(prefix)
            };
            let pattern = pattern.map_err(|sentence| key.wrong(sentence))?;
            parameters(path, &pattern, "", value, found)?;
        } else {
            let name = format!("{prefix}/{}", key.text.trim_start_matches('/'));
            nodes(path, &name, value, found)?;
        }
    }
    Ok(())
}

/// Reads parameters and groups of parameters.
fn parameters(
    path: &str,
    nodes: &Pattern,
    prefix: &str,
    tree: &Yaml,
    found: &mut Vec<Override>,
) -> Result<(), yaml::YamlError> {
    for (key, value) in tree.map("parameters are")? {
        let name = if prefix.is_empty() { key.text.clone() } else { format!("{prefix}.{}", key.text) };
        if value.is_map() {
            parameters(path, nodes, &name, value, found)?;
            continue;
        }
        let place = format!("{path}:{}:{}", key.line, key.column);
        let given = OverrideValue {
            value: value.value()?,
            place,
            is_of_file: true,
            is_for_this_node_only: !nodes.is_for_many(),
        };
        found.push(Override { nodes: nodes.clone(), name, given });
    }
    Ok(())
}

/// Parameter overrides of one node, by name.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Overrides(BTreeMap<String, OverrideValue>);

impl Overrides {
    pub(super) fn of(all: &[Override], node: &NodeName) -> Self {
        let mut own: BTreeMap<String, OverrideValue> = BTreeMap::new();
        for one in all.iter().filter(|one| one.nodes.fits(node)) {
            // A value that was once given for this node only must match a parameter.
            let was_strict = own.get(&one.name).is_some_and(|before| before.is_for_this_node_only);
            let given = OverrideValue {
                is_for_this_node_only: one.given.is_for_this_node_only || was_strict,
                ..one.given.clone()
            };
            own.insert(one.name.clone(), given);
        }
        Self(own)
    }

    /// Removes and returns the value that was given for a parameter.
    pub fn take(&mut self, name: &str) -> Option<OverrideValue> {
        self.0.remove(name)
    }

    /// Removes and returns all values whose names match.
    pub fn take_matching(&mut self, fits: impl Fn(&str) -> bool) -> Self {
        let (taken, left) = std::mem::take(&mut self.0).into_iter().partition(|(name, _)| fits(name));
        self.0 = left;
        Self(taken)
    }

    /// Returns all values, ascending by name.
    pub fn iter(&self) -> impl Iterator<Item = (&String, &OverrideValue)> {
        self.0.iter()
    }

    /// Returns true if no value was given.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Returns warnings about values that match no parameter. To be called last.
    ///
    /// # Errors
    /// All values that were given for this node only, in one message.
    pub fn check_unused(&self) -> Result<Vec<String>, String> {
        let sentence =
            |(name, given): (&String, &OverrideValue)| format!("{}: no parameter is called `{name}`", given.place);
        let strict: Vec<String> =
            self.0.iter().filter(|(_, given)| given.is_for_this_node_only).map(sentence).collect();
        match strict.is_empty() {
            true => Ok(self.0.iter().map(sentence).collect()),
            false => Err(format!("{}; `ros2 param list` and `lineshaft params CELL` name all", strict.join("; "))),
        }
    }
}

#[cfg(test)]
mod tests;
