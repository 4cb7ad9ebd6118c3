//! Commands as text: one scenario verb as JSON, and back bit for bit (contract sections 6 and 7).
//!
//! Law      from_json(to_json(command)) is the command's action, for every action that a door can make: f64 by their bits
//! Writes   the verb's arguments by their ROS names, in a fixed order; what stands at its default is left out. Positions and
//!          rates are in increments, times in ns, so that no scale takes part; the id of a goal is the sequence number of
//!          its command. JSON is YAML: the text does the same as the `do` of a scenario's step, where the ids that it
//!          cancels are carried
//! Reads    the same, by the scenario's own reader, and two verbs that no scenario has: `refuse`, a request that never became
//!          a command, and `note`, a notice from the recorder or a backend
//! Refuses  everything else, with one sentence. Actions that no door makes (of an axis that does not exist, NaN) are written
//!          so that they are refused here
//!
//! A position is given by ten decimals: multiples of 2^-32 lie 2.3e-10 apart, and none but the meant one is as near.

mod saia;
mod trajectory;
mod wf;
mod write;

use crate::document::{Document, Value};
use lineshaft_core::code::Code;
use lineshaft_core::command::{Action, Command, Setpoints, Source};
use lineshaft_core::config::MachineConfig;
use lineshaft_core::signal::Directory;

/// The command as one verb. `config` is that of the machine that it is for.
pub fn to_json(command: &Command, config: &MachineConfig) -> String {
    write::verb(command, config)
}

/// Setpoints as one verb.
pub fn setpoints_to_json(set: &Setpoints, config: &MachineConfig) -> String {
    write::setpoints(set, config)
}

/// What a verb stands for.
#[derive(Clone, Debug, PartialEq)]
#[allow(clippy::large_enum_variant, reason = "nearly all are commands, and each is used at once")]
pub enum Applied {
    /// A command.
    Command(Action),
    /// Streamed setpoints.
    Stream(Setpoints),
}

/// The action of a verb that [`to_json`] wrote, or that a scenario could give as one command. `directory` is that of a machine
/// of `config`.
///
/// # Errors
/// What is wrong with it, in one sentence.
pub fn from_json(json: &str, config: &MachineConfig, directory: &Directory) -> Result<Action, String> {
    match applied_from_json(json, Source::Scenario, config, directory)? {
        Applied::Command(action) => Ok(action),
        Applied::Stream(_) => Err("setpoints are no command".to_owned()),
    }
}

/// As [`from_json`], of what `source` gave, setpoints among it.
///
/// # Errors
/// What is wrong with it, in one sentence.
pub fn applied_from_json(
    json: &str,
    source: Source,
    config: &MachineConfig,
    directory: &Directory,
) -> Result<Applied, String> {
    let document = Document::parse_recorded("command", json);
    let action = document.root("the command").and_then(|root| read(&root, source, config, directory));
    match (document.problems().sorted().first(), action) {
        (None, Some(action)) => Ok(action),
        (Some(problem), _) => {
            let hint = problem.hint.as_ref().map_or_else(String::new, |hint| format!(", {hint}"));
            Err(format!("{}{hint}", problem.sentence))
        }
        (None, None) => Err("the command is no verb".to_owned()),
    }
}

fn read(root: &Value<'_>, source: Source, config: &MachineConfig, directory: &Directory) -> Option<Applied> {
    let entries = root.entries()?;
    let [(verb, arguments)] = entries.as_slice() else {
        root.refuse(format!("the command has {} verbs; one is expected", entries.len()), None);
        return None;
    };
    match verb.peek() {
        Some("refuse") => refuse(arguments).map(Applied::Command),
        Some("note") => note(arguments).map(Applied::Command),
        Some("setpoints") => {
            crate::scenario::recorded_setpoints(arguments, source, config, directory).map(Applied::Stream)
        }
        _ => crate::scenario::recorded_command(root, config, directory).map(Applied::Command),
    }
}

fn refuse(arguments: &Value<'_>) -> Option<Action> {
    let mut map = arguments.map("refuse")?;
    let text = map.required("text").and_then(|text| text.text());
    map.finish();
    Some(Action::Refuse(text?.into()))
}

fn note(arguments: &Value<'_>) -> Option<Action> {
    let mut map = arguments.map("note")?;
    let code = map.required("code").and_then(|code| {
        let known = code.integer(0..=u32::MAX).map(Code)?;
        let is_note = Code::NOTES.contains(&known);
        if !is_note {
            let notes = Code::NOTES.map(|code| code.0.to_string()).join(", ");
            let sentence = format!("code is {}; notes are {notes}", known.0);
            code.refuse(sentence, None);
        }
        is_note.then_some(known)
    });
    let number = map.required("number").and_then(|number| number.integer(i64::MIN..=i64::MAX));
    map.finish();
    Some(Action::Note { code: code?, number: number? })
}

#[cfg(test)]
mod tests;
