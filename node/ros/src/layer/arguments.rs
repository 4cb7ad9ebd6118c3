//! `--ros-args`, as `ros2 run` and launch files give them: what rcl takes from a command line.

mod overrides;
mod remap;
mod yaml;

pub use self::overrides::{Given, Overrides};
pub use self::remap::Names;

use self::overrides::Override;
use self::remap::{NodeRule, Rule};
use super::loggers::Level;
use super::name::{NameError, NodeName};

/// Arguments that cannot be followed.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ArgumentError {
    /// One that ROS knows and this program does not, or that nobody knows.
    #[error("ROS argument {given:?} is not known; -r, -p, --params-file, --log-level, -e and the switches of logs are")]
    Unknown {
        /// The argument.
        given: String,
    },
    /// One whose work nothing does here.
    #[error("ROS argument {given} is not supported: {instead}")]
    Unsupported {
        /// The argument.
        given: String,
        /// What does it.
        instead: &'static str,
    },
    /// What follows a flag is not of its form.
    #[error("{flag} is followed by {given:?}; {form} is needed{more}")]
    Form {
        /// The flag.
        flag: String,
        /// What follows it.
        given: String,
        /// How it should look.
        form: &'static str,
        /// What is wrong in it; empty, or begins with a colon.
        more: String,
    },
    /// A flag at the end.
    #[error("{flag} is not followed by anything, {form} is needed")]
    Missing {
        /// The flag.
        flag: String,
        /// What should follow.
        form: &'static str,
    },
    /// A file of parameters: where, and what is wrong.
    #[error("{0}")]
    File(String),
}

const RULE: &str = "[NODE:]FROM:=TO";
const PARAMETER: &str = "[NODE:]NAME:=VALUE";
const FILE: &str = "a file of parameters";
const LEVEL: &str = "[LOGGER:=]debug, info, warn, error or fatal";
const ENCLAVE: &str = "the name of an enclave";

/// What `--ros-args` said.
#[derive(Clone, Debug, PartialEq)]
pub struct RosArguments {
    node_rules: Vec<NodeRule>,
    rules: Vec<Rule>,
    overrides: Vec<Override>,
    /// Levels of loggers in their order; the empty name stands for all.
    pub levels: Vec<(String, Level)>,
    /// Whether log lines go to `/rosout`.
    pub rosout_logs: bool,
    /// Whether log lines go to the standard streams.
    pub stdout_logs: bool,
    /// The enclave, which nothing uses.
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
    /// Takes the ROS arguments out of a command line; the rest comes back in its order.
    ///
    /// They stand between `--ros-args` and `--` or the end, and may stand there several times. Files of parameters are read.
    ///
    /// # Errors
    /// An argument that cannot be followed.
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
            // The files that ROS writes by its external library do not exist here.
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

    /// Name and namespace of a node that would have these ones: of several rules the first one counts.
    ///
    /// # Errors
    /// ROS does not allow them.
    pub fn node_name(&self, name: &str, namespace: &str) -> Result<NodeName, NameError> {
        let first = |of_name: bool, node: &str| {
            let mut rules = self.node_rules.iter().filter(|rule| rule.of_name == of_name);
            rules.find(|rule| rule.node.as_deref().is_none_or(|only| only == node)).map(|rule| rule.to.as_str())
        };
        // As in rcl a rule for the namespace knows the node by its new name.
        let name = first(true, name).unwrap_or(name);
        NodeName::new(first(false, name).unwrap_or(namespace), name)
    }

    /// How that node calls its topics and services.
    ///
    /// # Errors
    /// A rule whose names ROS does not allow.
    pub fn names(&self, node: &NodeName) -> Result<Names, NameError> {
        Names::new(node.clone(), &self.rules)
    }

    /// The parameters that were given to that node; of several values the last one.
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
