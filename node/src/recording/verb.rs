//! Converts commands to text, one scenario verb as JSON, and back without loss (contract sections 6 and 7).
//!
//! Law      from_json(to_json(command)) is the action of the command, bit by bit, for every action that an interface
//!          can create
//! Writes   the arguments of the verb by their ROS names, in a fixed order; default values are left out. Positions and
//!          rates are in increments, times in ns, so that no scale is involved; the ID of a goal is the sequence number
//!          of its command. JSON is YAML: a `do` of a scenario step with this text has the same effect, if the IDs that
//!          it cancels are kept
//! Reads    the same, with the reader of scenarios, and two verbs that scenarios do not have: `refuse`, a request that
//!          was refused before it became a command, and `note`, a message from the recorder or a backend
//! Refuses  everything else, with one error message. Actions that no interface creates (an axis that does not exist,
//!          NaN) are written in a form that is refused here
//!
//! A position has ten decimals: multiples of 2^-32 are 2.3e-10 apart, so the nearest one is unique.

mod saia;
mod trajectory;
mod wf;
mod write;

use crate::document::{Document, Value};
use lineshaft_core::code::Code;
use lineshaft_core::command::{Action, Command, Setpoints, Source};
use lineshaft_core::config::MachineConfig;
use lineshaft_core::signal::Directory;

/// Returns the command as one verb. `config` is that of its machine.
pub fn to_json(command: &Command, config: &MachineConfig) -> String {
    write::verb(command, config)
}

/// Returns setpoints as one verb.
pub fn setpoints_to_json(set: &Setpoints, config: &MachineConfig) -> String {
    write::setpoints(set, config)
}

/// Meaning of a verb.
#[derive(Clone, Debug, PartialEq)]
#[allow(clippy::large_enum_variant, reason = "nearly all are commands, and each is used at once")]
pub enum Applied {
    /// A command.
    Command(Action),
    /// Streamed setpoints.
    Stream(Setpoints),
}

/// Returns the action of a verb that [`to_json`] wrote, or that a scenario could give as one command. `directory` is
/// that of a machine of `config`.
///
/// # Errors
/// Returns an error message of one sentence.
pub fn from_json(json: &str, config: &MachineConfig, directory: &Directory) -> Result<Action, String> {
    match applied_from_json(json, Source::Scenario, config, directory)? {
        Applied::Command(action) => Ok(action),
        Applied::Stream(_) => Err("setpoints are no command".to_owned()),
    }
}

/// Does the same as [`from_json`] for a verb of `source`, including setpoints.
///
/// # Errors
/// Returns an error message of one sentence.
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
