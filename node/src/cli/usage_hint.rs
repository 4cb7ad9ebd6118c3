//! Returns hints for command lines that the parser refuses: what was probably meant.

use super::file_hint::{file_hint, is_scenario};
use super::new::quoted;
use crate::recording::clean::clean;
use crate::scenario::did_you_mean;
use clap::error::{ContextKind, ContextValue, ErrorKind};
use std::path::Path;

/// Arguments of ROS 2 nodes, which other nodes accept only after --ros-args, too.
const ROS_ARGUMENTS: [&str; 8] = [
    "-r",
    "--remap",
    "-p",
    "--param",
    "--params-file",
    "--log-level",
    "--disable-rosout-logs",
    "--disable-stdout-logs",
];

/// Commands that need names of axes or `--all`, and the effect of `--all`.
const WITH_ALL: [(&str, &str); 4] = [
    ("enable", "enables all axes of the cell"),
    ("disable", "stops and disables all axes of the cell"),
    ("reset", "resets the errors of all axes of the cell"),
    ("home", "homes all axes that have a homing method"),
];

/// Commands with a cell as argument and a scenario as option.
const WITH_SCENARIO: [&str; 3] = ["sim", "check", "run"];

/// Returns the hint for a command line; `words` are its arguments without the name of the program.
pub(super) fn hint(error: &clap::Error, words: &[String]) -> Option<String> {
    let command = words.first().map(String::as_str);
    file_hint(error, command).or_else(|| match error.kind() {
        ErrorKind::MissingRequiredArgument => {
            let (name, effect) = WITH_ALL.iter().find(|(name, _)| Some(*name) == command)?;
            Some(format!("`lineshaft {name} --all` {effect}"))
        }
        ErrorKind::UnknownArgument => {
            let Some(ContextValue::String(unknown)) = error.get(ContextKind::InvalidArg) else { return None };
            ros_argument(unknown, words).or_else(|| scenario(unknown, words)).or_else(|| velocity(words))
        }
        _ => None,
    })
}

/// Removes the tip to pass an unknown option as a value (`use '-- --speed'`): no value of a command begins like an
/// option.
pub(super) fn without_escape_tip(mut error: clap::Error) -> clap::Error {
    if error.kind() == ErrorKind::UnknownArgument
        && let Some(ContextValue::StyledStrs(mut tips)) = error.remove(ContextKind::Suggested)
    {
        tips.retain(|tip| !tip.to_string().contains("' as a value, use '"));
        if !tips.is_empty() {
            error.insert(ContextKind::Suggested, ContextValue::StyledStrs(tips));
        }
    }
    error
}

/// Returns the command line with its arguments of ROS after --ros-args, where each value is a separate word.
fn ros_argument(unknown: &str, words: &[String]) -> Option<String> {
    let is_rule = |word: &str| word.starts_with("__") && word.contains(":=");
    let is_of_ros = |word: &str| is_rule(word) || ROS_ARGUMENTS.contains(&flag_and_value(word).0);
    if !is_of_ros(unknown) {
        return None;
    }
    let words = match words.split_first()? {
        (command, rest) if command == "run" => rest,
        (first, _) if is_of_ros(first) => words,
        _ => return None,
    };
    let (mut own, mut ros) = (vec!["run"], Vec::new());
    let mut words = words.iter().map(String::as_str);
    while let Some(word) = words.next() {
        match flag_and_value(word) {
            _ if is_rule(word) => ros.extend(["-r", word]),
            (flag, value) if ROS_ARGUMENTS.contains(&flag) => {
                ros.push(flag);
                if !flag.starts_with("--disable-") {
                    ros.extend(value.or_else(|| words.next()));
                }
            }
            _ => own.push(word),
        }
    }
    Some(format!("ROS arguments follow --ros-args: `lineshaft {} --ros-args {}`", line(&own), line(&ros)))
}

/// Returns the parts of `--flag=value`.
fn flag_and_value(word: &str) -> (&str, Option<&str>) {
    // In `-r from:=to` the sign is part of the rule.
    match word.split_once('=') {
        Some((flag, value)) if !flag.ends_with(':') => (flag, Some(value)),
        _ => (word, None),
    }
}

/// Returns the option for a scenario that was given as an argument.
fn scenario(unknown: &str, words: &[String]) -> Option<String> {
    let command = words.first().filter(|command| WITH_SCENARIO.contains(&command.as_str()))?;
    let path = Path::new(unknown);
    let is_yaml = path.extension().is_some_and(|extension| extension == "yaml" || extension == "yml");
    if unknown.starts_with('-') || !is_yaml && !path.is_file() {
        return None;
    }
    // In any other place the word before may be the value of an option.
    let (cell, scenario) = match words {
        [_, first, second, ..] if second == unknown && !first.starts_with('-') => {
            let is_swapped = is_scenario(Path::new(first)) && !is_scenario(path);
            if is_swapped { (second, first) } else { (first, second) }
        }
        _ => return Some(format!("a scenario is given as `--scenario {}`", word(unknown))),
    };
    Some(format!(
        "a scenario is given as an option: `lineshaft {command} {} --scenario {}`",
        word(cell),
        word(scenario)
    ))
}

/// Returns the name of a velocity that was given by another name.
fn velocity(words: &[String]) -> Option<String> {
    let has = |option: &str| words.iter().any(|word| word.split('=').next() == Some(option));
    match words.first()?.as_str() {
        "move" | "tune" if has("--speed") => Some(did_you_mean("--velocity")),
        "jog" if has("--speed") || has("--velocity") => {
            Some("VELOCITY is no option: `lineshaft jog AXIS VELOCITY`".to_owned())
        }
        _ => None,
    }
}

/// Returns words as a shell accepts them.
fn line(words: &[&str]) -> String {
    words.iter().map(|text| word(text)).collect::<Vec<_>>().join(" ")
}

/// Returns a word as a shell accepts it.
fn word(text: &str) -> String {
    clean(&quoted(Path::new(text))).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::{Line, parses};
    use clap::Parser;

    fn error(words: &[&str]) -> clap::Error {
        Line::try_parse_from([&["lineshaft"], words].concat()).expect_err("it is refused")
    }

    fn hint_of(words: &[&str]) -> Option<String> {
        let given: Vec<String> = words.iter().map(|word| (*word).to_owned()).collect();
        hint(&error(words), &given)
    }

    #[test]
    fn ros_argument_without_ros_args_is_repeated_after_it() {
        for (words, expected) in [
            (
                &["run", "first.yaml", "-r", "__node:=second"][..],
                "lineshaft run first.yaml --ros-args -r __node:=second",
            ),
            (&["run", "first.yaml", "__ns:=/press"], "lineshaft run first.yaml --ros-args -r __ns:=/press"),
            (&["-p", "x.max_velocity:=0.5"], "lineshaft run --ros-args -p x.max_velocity:=0.5"),
            (&["run", "--log-level=debug"], "lineshaft run --ros-args --log-level debug"),
            (
                &["run", "-r", "__node:=b", "first.yaml", "--sim"],
                "lineshaft run first.yaml --sim --ros-args -r __node:=b",
            ),
            (&["run", "a.yaml", "__node:=x", "__ns:=/y"], "lineshaft run a.yaml --ros-args -r __node:=x -r __ns:=/y"),
        ] {
            let hint = format!("ROS arguments follow --ros-args: `{expected}`");
            assert_eq!(hint_of(words), Some(hint), "{words:?}");
            assert_eq!(parses(expected.split(' ').map(str::to_owned)), Ok(()), "{expected}");
        }
        assert_eq!(hint_of(&["state", "-r", "__node:=second"]), None, "it starts no node");
    }

    #[test]
    fn scenario_as_second_file_is_an_option() {
        for command in WITH_SCENARIO {
            let hint = format!(
                "a scenario is given as an option: `lineshaft {command} first.yaml --scenario first.scenario.yaml`"
            );
            assert_eq!(hint_of(&[command, "first.yaml", "first.scenario.yaml"]).as_ref(), Some(&hint));
            assert_eq!(hint_of(&[command, "first.scenario.yaml", "first.yaml"]).as_ref(), Some(&hint));
        }
        let hint = "a scenario is given as `--scenario 'a b.yaml'`";
        assert_eq!(hint_of(&["check", "--json", "first.yaml", "a b.yaml"]).as_deref(), Some(hint));
        assert_eq!(hint_of(&["check", "first.yaml", "strict"]), None);
        assert_eq!(hint_of(&["signals", "first.yaml", "b.yaml"]), None);
    }

    #[test]
    fn missing_axes_name_the_option_for_all() {
        for (command, effect) in WITH_ALL {
            assert_eq!(hint_of(&[command]), Some(format!("`lineshaft {command} --all` {effect}")));
            assert!(Line::try_parse_from(["lineshaft", command, "--all"]).is_ok(), "{command}");
        }
        assert_eq!(hint_of(&["move", "x"]), None);
    }

    #[test]
    fn velocity_by_another_name_is_named() {
        let meant = Some("did you mean `--velocity`?".to_owned());
        assert_eq!(hint_of(&["move", "x", "10 mm", "--speed", "5 mm/s"]), meant);
        assert_eq!(hint_of(&["move", "x", "10 mm", "--speed=5 mm/s"]), meant);
        assert_eq!(hint_of(&["tune", "cell.yaml", "x", "--speed", "5 mm/s"]), meant);
        let positional = Some("VELOCITY is no option: `lineshaft jog AXIS VELOCITY`".to_owned());
        assert_eq!(hint_of(&["jog", "x", "--velocity", "5 mm/s"]), positional);
    }

    #[test]
    fn unknown_option_is_not_suggested_as_a_value() {
        for words in [&["move", "x", "10 mm", "--speed", "5 mm/s"][..], &["run", "first.yaml", "-r", "__node:=b"]] {
            let told = error(words).to_string();
            assert!(told.contains("as a value, use '-- "), "the parser suggests it: {told}");
            let told = without_escape_tip(error(words)).to_string();
            assert!(!told.contains("as a value") && told.contains("Usage: "), "{told}");
        }
        // Other tips stay.
        let told = without_escape_tip(error(&["check", "cell.yaml", "--scenaro", "s.yaml"])).to_string();
        assert!(told.contains("a similar argument exists: '--scenario'"), "{told}");
    }
}
