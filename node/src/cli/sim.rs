//! `lineshaft sim`.
//!
//! Law      plays one scenario, or all of a folder in parallel. The output is the same for any number of jobs

mod all;
mod played;

use self::played::{Played, Trouble};
use super::command_output::Output;
use super::file_hint::is_scenario;
use super::{Exit, SimArgs, junit, store};
use crate::cell::Cell;
use crate::interrupt::Interrupt;
use crate::scenario::{Options, SUFFIX, Scenario, SimulateError, cell_of, other_cell, simulate_with};
use serde_json::json;
use std::path::Path;
use std::{fs, io};

pub(super) const HELP: &str = "\
Examples:
  lineshaft sim cell.yaml --scenario first_move.yaml --csv trace.csv
  lineshaft sim press.scenario.yaml
  lineshaft sim --all . --junit report.xml

A scenario without a cell, and each one of --all, runs on the cell that its key `cell: FILE` names, else on NAME.yaml next to \
NAME.scenario.yaml.

Exit codes: 0 all passed, 1 an expectation failed, or the disk did, 2 bad usage or a file with errors.";

pub(super) fn sim(args: &SimArgs) -> Exit {
    let mut output = Output::new("sim", args.json);
    let interrupt = match Interrupt::listen() {
        Ok(interrupt) => interrupt,
        Err(error) => {
            output.complain(&format_args!("signals of the system cannot be received: {error}"));
            return output.finish(Exit::Failed);
        }
    };
    let (played, exit) = match &args.all {
        Some(folder) => all::play(folder, args.jobs, &interrupt, &mut output),
        None => match files(args) {
            Ok((cell, scenario)) => {
                let played = one(args, cell, scenario, interrupt);
                played.show(&mut output);
                let exit = played.exit();
                (vec![played], exit)
            }
            Err(sentence) => {
                output.complain(&sentence);
                (Vec::new(), Exit::Usage)
            }
        },
    };
    let mut suites: Vec<_> = played.iter().map(Played::suite).collect();
    if suites.is_empty() {
        // A reader of the report alone must not see it as success.
        suites.push(junit::Suite::not_run("no scenario was played"));
    }
    let exit = junit::write(args.junit.as_deref(), "lineshaft sim", &suites, exit, &mut output);
    let count = |verdict: &str| played.iter().filter(|played| played.verdict() == verdict).count();
    output.set("passed", json!(count(played::PASSED)));
    output.set("failed", json!(count(played::FAILED)));
    output.set("with_errors", json!(count(played::ERROR)));
    output.set("scenarios", played.iter().map(Played::json).collect());
    output.finish(exit)
}

/// Returns the cell, if one was given, and the scenario. A single file may be the scenario.
///
/// # Errors
/// Returns a message with the correct command if the single file is no scenario.
fn files(args: &SimArgs) -> Result<(Option<&Path>, &Path), String> {
    match (args.cell.as_deref(), args.scenario.as_deref()) {
        (cell, Some(scenario)) => Ok((cell, scenario)),
        (Some(file), None) if is_scenario(file) => Ok((None, file)),
        (Some(cell), None) => Err(without_scenario(cell)),
        // The parser of arguments requires one.
        (None, None) => Err("--scenario is missing".to_owned()),
    }
}

/// Returns the correct command for a cell without a scenario.
fn without_scenario(cell: &Path) -> String {
    let next_to = cell.with_extension(SUFFIX.trim_start_matches('.'));
    if !cell.exists() {
        return format!("there is no file {}", cell.display());
    }
    if cell.is_dir() {
        let folder = cell.display();
        return format!("{folder} is a folder; `lineshaft sim --all {folder}` plays its scenarios");
    }
    let cell = cell.display();
    if next_to.is_file() {
        let scenario = next_to.display();
        return format!("{cell} is no scenario; `lineshaft sim {scenario}` plays the one next to it");
    }
    format!(
        "{cell} is no scenario; `lineshaft sim {cell} --scenario FILE` plays one, `lineshaft new FILE` writes an example"
    )
}

/// Plays the requested scenario with the options of the command.
fn one(args: &SimArgs, given: Option<&Path>, scenario: &Path, interrupt: Interrupt) -> Played {
    let cell = given.map_or_else(|| cell_of(scenario), |cell| Ok(cell.to_owned()));
    let note = given.and_then(|cell| other_cell(scenario, Some(cell)));
    let (csv, record) = (args.csv.clone(), args.record.options());
    let options = Options { csv, record, events: args.events, progress: !args.json, interrupt };
    Played::new(scenario, cell, note, |cell| {
        let mut loaded = Cell::load(cell)?;
        let read = Scenario::load(scenario, &loaded)?;
        refuse_input(args.csv.as_deref(), cell, &loaded)?;
        let store = store::open_silently(&args.store, &mut loaded).map_err(Trouble::Store)?;
        simulate_with(&loaded, &read, &options, store).map_err(Trouble::Simulate)
    })
}

/// Refuses a trace that would replace a table of the cell.
fn refuse_input(csv: Option<&Path>, cell: &Path, loaded: &Cell) -> Result<(), Trouble> {
    let Some(csv) = csv else { return Ok(()) };
    let Ok(found) = fs::canonicalize(csv) else { return Ok(()) };
    let is_read = |name: &String| fs::canonicalize(cell.with_file_name(name)).is_ok_and(|path| path == found);
    if loaded.files.keys().any(is_read) {
        let error = io::Error::other(format!("{} reads it; name another file", cell.display()));
        return Err(Trouble::Simulate(SimulateError::Csv { path: csv.to_owned(), error }));
    }
    Ok(())
}
