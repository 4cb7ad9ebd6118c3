//! Reads a single verb, the format in which a recording stores a command: its IDs are the sequence numbers of commands.

use super::{Act, Effect, Ids, Reader};
use crate::document::Value;
use crate::scenario::names::{Names, meant_parameter};
use lineshaft_core::command::Action;
use lineshaft_core::config::MachineConfig;
use lineshaft_core::parameter::Change;
use lineshaft_core::request::RequestError;
use lineshaft_core::signal::Directory;
use lineshaft_core::unit::excerpt;

/// Reads a parameter change from the name of a parameter and a value. Reports a problem if it returns `None`; `key` is
/// the location of the name.
pub(crate) fn parameter_change(
    name: &str,
    key: &Value<'_>,
    value: &Value<'_>,
    config: &MachineConfig,
    directory: &Directory,
) -> Option<Change> {
    let mut ids = Ids::default();
    let change = Reader {
        names: &Names { config, joints: None, backends: &[], directory, groups: &[], folder: None },
        ids: &mut ids,
        refused: None,
        recorded: true,
    }
    .change(Some(name), value)?;
    let noted = change.map_err(|error| match &error {
        RequestError::UnknownParameter { .. } => key.refuse(error.to_string(), meant_parameter(name, config)),
        RequestError::UnknownAxis { .. } | RequestError::NotApplicable { .. } => key.refuse(error.to_string(), None),
        _ => value.refuse(error.to_string(), None),
    });
    noted.ok()
}

/// Reads the command of one verb. Reports a problem if it returns `None`.
pub(crate) fn recorded_command(value: &Value<'_>, config: &MachineConfig, directory: &Directory) -> Option<Action> {
    let (mut ids, mut acts) = (Ids::default(), Vec::new());
    Reader {
        names: &Names { config, joints: None, backends: &[], directory, groups: &[], folder: None },
        ids: &mut ids,
        refused: None,
        recorded: true,
    }
    .read_one(value, &mut acts);
    let Act { deed, id, .. } = acts.pop()?;
    let number = |id: usize| {
        let text = ids.names.get(id)?;
        let number = text.parse::<u64>().ok();
        if number.is_none() {
            let sentence = format!("id is `{}`; the sequence number of a command is expected", excerpt(text));
            value.refuse(sentence, None);
        }
        number
    };
    match deed {
        Effect::Command(action) => match id {
            Some(id) => number(id).map(|_| action),
            None => Some(action),
        },
        Effect::Cancel(goal) => number(goal).map(|goal| Action::Cancel { goal }),
        Effect::Inject(_) => {
            value.refuse("inject is no command of the machine", None);
            None
        }
        Effect::Stream(_) => {
            value.refuse("setpoints are no command of the machine", None);
            None
        }
        // Without an expectation a refused request is a problem, which has been reported.
        Effect::Refused(_) => None,
    }
}
