//! Checks command lines without running them. The tests of the documentation check every command of every page with it.

use super::{Command, Line};
use clap::Parser;
use clap::error::{ContextKind, ContextValue, ErrorKind};
use lineshaft_ros::layer::{RosArguments, Side};

/// Reason why a command line is wrong.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UsageError {
    /// Whether only an argument, a value or a subcommand is missing, and everything that is given is correct.
    pub is_incomplete: bool,
    /// Message for the user.
    pub message: String,
}

/// Returns an error if the program would refuse this command line, the first argument being the name of the program.
/// Runs nothing; reads files of `--params-file`.
pub fn parses(arguments: impl IntoIterator<Item = String>) -> Result<(), UsageError> {
    let arguments: Vec<String> = arguments.into_iter().collect();
    if arguments.get(1).is_some_and(|command| command == Side::COMMAND) {
        return Ok(());
    }
    let wrong = |message: String| UsageError { is_incomplete: false, message };
    let (ros, rest) = RosArguments::take(arguments).map_err(|error| wrong(error.to_string()))?;
    match Line::try_parse_from(rest) {
        Ok(Line { command: None | Some(Command::Run(_)) }) => Ok(()),
        Ok(_) if ros == RosArguments::default() => Ok(()),
        Ok(_) => Err(wrong("--ros-args belong to `lineshaft run`".to_owned())),
        // --help and --version.
        Err(error) if !error.use_stderr() => Ok(()),
        Err(error) => Err(UsageError { is_incomplete: is_incomplete(&error), message: error.to_string() }),
    }
}

fn is_incomplete(error: &clap::Error) -> bool {
    match error.kind() {
        ErrorKind::MissingRequiredArgument
        | ErrorKind::MissingSubcommand
        | ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand => true,
        // An option at the end without its value.
        ErrorKind::InvalidValue => {
            matches!(error.get(ContextKind::InvalidValue), Some(ContextValue::String(value)) if value.is_empty())
        }
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::parses;

    fn parse(line: &str) -> Result<(), super::UsageError> {
        parses(line.split_whitespace().map(str::to_owned))
    }

    #[test]
    fn command_lines_are_right_wrong_or_incomplete() {
        for line in [
            "lineshaft",
            "lineshaft --help",
            "lineshaft sim cell.yaml --scenario s.yaml",
            "lineshaft sim cell.scenario.yaml",
            "lineshaft run cell.yaml --ros-args -r __ns:=/press",
            "lineshaft can info 1 --bus socketcan:can0",
        ] {
            assert_eq!(parse(line), Ok(()), "{line}");
        }
        for (line, is_incomplete) in [
            ("lineshaft sim", true),
            ("lineshaft can", true),
            ("lineshaft check --graph", true),
            ("lineshaft simulate cell.yaml", false),
            ("lineshaft sim cell.yaml --trace x.csv", false),
            ("lineshaft check cell.yaml --preset amk", false),
            ("lineshaft check cell.yaml --ros-args -r __ns:=/press", false),
            ("lineshaft run --ros-args --simulation", false),
        ] {
            let error = parse(line).expect_err(line);
            assert_eq!(error.is_incomplete, is_incomplete, "{line}: {}", error.message);
        }
    }
}
