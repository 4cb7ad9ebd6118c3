//! `lineshaft bag`.

use super::Exit;
use super::command_output::Output;
use crate::recording::info::Info;
use crate::recording::run::Run;
use clap::Subcommand;
use serde_json::json;
use std::path::{Path, PathBuf};

#[derive(Debug, Subcommand)]
pub(super) enum BagCommand {
    /// Tell what a run holds, and whether it can be replayed
    #[command(
        after_help = "Exit codes: 0 the run was read to its end, also one that was cut off; 2 bad usage, or a file \
                            that is damaged or no bag."
    )]
    Info {
        /// The run: an .mcap file, a folder, or a metadata.yaml
        run: PathBuf,
        /// Print one JSON object (docs/json.md) instead of the lines
        #[arg(long)]
        json: bool,
    },
}

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
