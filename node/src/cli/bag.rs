//! `lineshaft bag`.

use super::command_output::Output;
use super::{BagCommand, Exit};
use crate::recording::info::Info;
use crate::recording::run::Run;
use serde_json::json;
use std::path::Path;

pub(super) fn bag(command: &BagCommand) -> Exit {
    match command {
        BagCommand::Info { run, json } => {
            let mut output = Output::new("bag info", *json);
            output.set("run", json!(run.display().to_string()));
            let exit = info(run, &mut output);
            output.finish(exit)
        }
    }
}

fn info(path: &Path, output: &mut Output) -> Exit {
    let mut run = match Run::open_any(path) {
        Ok(run) => run,
        Err(error) => {
            output.complain(&error);
            return Exit::Usage;
        }
    };
    output.watch(&mut run);
    let info = Info::of(&mut run);
    run.end_progress();
    output.say(&info.to_string().trim_end());
    info.fields().into_iter().for_each(|(name, value)| output.set(name, value));
    let flaws: Vec<_> = run.flaws().collect();
    for flaw in &flaws {
        output.complain(flaw);
    }
    match info.error() {
        Some(error) => {
            output.complain(error);
            Exit::Usage
        }
        None if flaws.is_empty() => Exit::Good,
        None => Exit::Usage,
    }
}
