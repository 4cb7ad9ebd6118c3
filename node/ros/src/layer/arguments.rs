//! Parses `--ros-args` of a command line, as `ros2 run` and launch files give them, like rcl.

mod overrides;
mod remap;
mod yaml;

pub use self::overrides::{OverrideValue, Overrides};
pub use self::remap::Names;

use self::overrides::Override;
use self::remap::{NodeRule, Rule};
use super::loggers::Level;
use super::name::{NameError, NodeName};

/// Invalid ROS argument.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ArgumentError {
    /// Unknown argument.
    #[error("ROS argument {given:?} is not known; -r, -p, --params-file, --log-level, -e and the switches of logs are")]
    Unknown {
        /// Given argument.
        given: String,
    },
    /// Argument that ROS has, but this program does not support.
    #[error("ROS argument {given} is not supported: {instead}")]
    Unsupported {
        /// Given argument.
        given: String,
        /// Alternative.
        instead: &'static str,
    },
    /// The value of a flag has the wrong form.
    #[error("{flag} is followed by {given:?}; {form} is needed{more}")]
    Form {
        /// Flag.
        flag: String,
        /// Given value.
        given: String,
        /// Expected form.
        form: &'static str,
        /// Details; empty, or starts with a colon.
        more: String,
    },
    /// The value of the last flag is missing.
    #[error("{flag} is not followed by anything, {form} is needed")]
    Missing {
        /// Flag.
        flag: String,
        /// Expected form.
        form: &'static str,
    },
    /// Error in a parameter file, with its place.
    #[error("{0}")]
    File(String),
}

const RULE: &str = "[NODE:]FROM:=TO";
const PARAMETER: &str = "[NODE:]NAME:=VALUE";
const FILE: &str = "a file of parameters";
const LEVEL: &str = "[LOGGER:=]debug, info, warn, error or fatal";
const ENCLAVE: &str = "the name of an enclave";

/// Parsed ROS arguments.
#[derive(Clone, Debug, PartialEq)]
pub struct RosArguments {
    node_rules: Vec<NodeRule>,
    rules: Vec<Rule>,
    overrides: Vec<Override>,
    /// Levels of loggers in their order; the empty name means all loggers.
    pub levels: Vec<(String, Level)>,
    /// Whether log messages are published on `/rosout`.
    pub rosout_logs: bool,
    /// Whether log messages are written to the standard streams.
    pub stdout_logs: bool,
    /// Enclave, which is not used.
    pub enclave: Option<String>,
}

impl Default for RosArguments {
    fn default() -> Self {
        Self {
            node_rules: Vec::new(),
            rules: Vec::new(),
            overrides: Vec::new(),
            levels: Vec::new(),
            rosout_logs: true,
            stdout_logs: true,
            enclave: None,
        }
    }
}

impl RosArguments {
    /// Extracts the ROS arguments from a command line; the other arguments are returned in their order.
    ///
    /// They are between `--ros-args` and `--` or the end, possibly several times. Parameter files are read.
    ///
    /// # Errors
    /// An argument is invalid.
    pub fn take(arguments: impl IntoIterator<Item = String>) -> Result<(Self, Vec<String>), ArgumentError> {
        let (mut taken, mut rest, mut inside) = (Self::default(), Vec::new(), false);
        let mut arguments = arguments.into_iter();
        while let Some(argument) = arguments.next() {
            match (inside, argument.as_str()) {
                (_, "--ros-args") => inside = true,
                (true, "--") => inside = false,
                (true, flag) => taken.one(flag, &mut arguments)?,
                (false, _) => rest.push(argument),
            }
        }
        Ok((taken, rest))
    }

    fn one(&mut self, flag: &str, rest: &mut impl Iterator<Item = String>) -> Result<(), ArgumentError> {
        let mut next = |form| rest.next().ok_or_else(|| ArgumentError::Missing { flag: flag.to_owned(), form });
        match flag {
            "-r" | "--remap" => self.remap(flag, next(RULE)?)?,
            "-p" | "--param" => self.overrides.push(parameter(flag, &next(PARAMETER)?)?),
            "--params-file" => self.overrides.extend(overrides::read_file(&next(FILE)?).map_err(ArgumentError::File)?),
            "--log-level" => self.levels.push(level(flag, next(LEVEL)?)?),
            "-e" | "--enclave" => self.enclave = Some(next(ENCLAVE)?),
            "--enable-rosout-logs" => self.rosout_logs = true,
            "--disable-rosout-logs" => self.rosout_logs = false,
            "--enable-stdout-logs" => self.stdout_logs = true,
            "--disable-stdout-logs" => self.stdout_logs = false,
            // Log files by the external library of ROS do not exist here.
            "--enable-external-lib-logs" | "--disable-external-lib-logs" => {}
            "--log-config-file" => {
                let instead =
                    "the program's log has no such file; --log-level, ~/set_logger_levels and RUST_LOG choose lines";
                return Err(ArgumentError::Unsupported { given: flag.to_owned(), instead });
            }
            "--log-file-name" => {
                let instead = "the program writes no log file; it logs to standard error and to /rosout";
                return Err(ArgumentError::Unsupported { given: flag.to_owned(), instead });
            }
            _ => return Err(ArgumentError::Unknown { given: flag.to_owned() }),
        }
        Ok(())
    }

    fn remap(&mut self, flag: &str, given: String) -> Result<(), ArgumentError> {
        match remap::parse(&given) {
            Ok(remap::Parsed::Node(rule)) => self.node_rules.push(rule),
            Ok(remap::Parsed::Name(rule)) => self.rules.push(rule),
            Err(more) => return Err(form(flag, given, RULE, more)),
        }
        Ok(())
    }

    /// Returns name and namespace of a node after remapping; the first matching rule is used.
    ///
    /// # Errors
    /// ROS does not allow the resulting names.
    pub fn node_name(&self, name: &str, namespace: &str) -> Result<NodeName, NameError> {
        let first = |of_name: bool, node: &str| {
            let mut rules = self.node_rules.iter().filter(|rule| rule.of_name == of_name);
            rules.find(|rule| rule.node.as_deref().is_none_or(|only| only == node)).map(|rule| rule.to.as_str())
        };
        // As in rcl, a rule for the namespace matches the new name of the node.
        let name = first(true, name).unwrap_or(name);
        NodeName::new(first(false, name).unwrap_or(namespace), name)
    }

    /// Returns the names that the node uses for its topics and services.
    ///
    /// # Errors
    /// ROS does not allow the names of a rule.
    pub fn names(&self, node: &NodeName) -> Result<Names, NameError> {
        Names::new(node.clone(), &self.rules)
    }

    /// Returns the parameters that were given to the node; of several values the last one.
    pub fn overrides(&self, node: &NodeName) -> Overrides {
        Overrides::of(&self.overrides, node)
    }
}

fn form(flag: &str, given: String, form: &'static str, more: impl Into<String>) -> ArgumentError {
    ArgumentError::Form { flag: flag.to_owned(), given, form, more: more.into() }
}

fn parameter(flag: &str, given: &str) -> Result<Override, ArgumentError> {
    overrides::parse(flag, given).map_err(|more| form(flag, given.to_owned(), PARAMETER, more))
}

fn level(flag: &str, given: String) -> Result<(String, Level), ArgumentError> {
    let (logger, word) = given.split_once(":=").unwrap_or(("", &given));
    match Level::of_name(word) {
        Some(level) => Ok((logger.to_owned(), level)),
        None => Err(form(flag, given, LEVEL, "")),
    }
}

#[cfg(test)]
mod tests;
