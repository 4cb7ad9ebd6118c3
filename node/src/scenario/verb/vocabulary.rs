//! Reads a verb of another controller whose axis is given separately from its arguments (`~/vocabulary`), as in a
//! scenario.

use super::{Effect, Ids, Reader};
use crate::document::Document;
use crate::scenario::names::{Names, did_you_mean, nearest};
use lineshaft_core::command::Action;
use lineshaft_core::config::MachineConfig;
use lineshaft_core::signal::Directory;
use lineshaft_core::unit::excerpt;

/// Maximum size of the arguments, in bytes; far more than all registers and blocks of a module need.
const MAX_BYTES: usize = 1 << 16;
/// Verbs that can be given in this form.
const VERBS: [&str; 3] = ["saia", "wf", "set_parameters"];

/// Returns the command of a verb; `arguments` are YAML without the axis.
///
/// # Errors
/// Returns an error message of one sentence, with line and column if the error is in the arguments.
pub(crate) fn vocabulary_command(
    axis: &str,
    verb: &str,
    arguments: &str,
    config: &MachineConfig,
    directory: &Directory,
) -> Result<Action, String> {
    // Of these verbs, the machine has only parameters.
    if (axis, verb) != ("machine", "set_parameters") {
        config.find_axis(axis).map_err(|error| error.to_string())?;
    }
    if !VERBS.contains(&verb) {
        let hint = nearest(verb, VERBS.into_iter()).map_or(String::new(), |near| format!(", {}", did_you_mean(near)));
        return Err(format!("verb is `{}`; {} are allowed{hint}", excerpt(verb), VERBS.join(", ")));
    }
    if arguments.len() > MAX_BYTES {
        return Err(format!("the arguments are {} bytes long; {MAX_BYTES} are allowed", arguments.len()));
    }
    let mut document = Document::parse("arguments", arguments);
    match verb {
        "set_parameters" => document.put_before_keys(&format!("{axis}.")),
        _ => document.put("axis", axis),
    }
    let mut ids = Ids::default();
    let reader = Reader {
        names: &Names { config, joints: None, backends: &[], directory, groups: &[], folder: None },
        ids: &mut ids,
        refused: None,
        recorded: false,
    };
    let deed = document.root(verb).and_then(|root| match verb {
        "saia" => reader.saia(&root),
        "wf" => reader.wf(&root),
        _ => reader.set_parameters(&root),
    });
    let problems = document.problems().sorted();
    match (problems.first(), deed) {
        (None, Some(Effect::Command(action))) => Ok(action),
        (Some(problem), _) => Err(match problems.len() - 1 {
            0 => problem.to_string(),
            1 => format!("{problem}; there is 1 more problem"),
            more => format!("{problem}; there are {more} more problems"),
        }),
        (None, _) => Err(format!("{verb} asks for nothing")),
    }
}
