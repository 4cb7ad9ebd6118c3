//! `lineshaft sim`.
//!
//! Law      plays one scenario, or all of a folder in parallel. The output is the same for any number of jobs

mod all;
mod played;

use self::played::{Played, Trouble};
use super::command_output::Output;
use super::file_hint::is_scenario;
use super::record::RecordArgs;
use super::store::{self, StoreArgs};
use super::{Exit, junit, outputs};
use crate::cell::Cell;
use crate::interrupt::Interrupt;
use crate::scenario::{Options, SUFFIX, Scenario, SimulateError, cell_of, other_cell, simulate_with};
use clap::{Args, value_parser};
use serde_json::json;
use std::path::{Path, PathBuf};
use std::{fs, io};

pub(super) const HELP: &str = "\
Examples:
  lineshaft sim cell.yaml --scenario first_move.yaml --csv trace.csv
  lineshaft sim press.scenario.yaml
  lineshaft sim --all . --junit report.xml

A scenario without a cell, and each one of --all, runs on the cell that its key `cell: FILE` names, else on NAME.yaml next to \
NAME.scenario.yaml.

Exit codes: 0 all passed, 1 an expectation failed, or the disk did, 2 bad usage or a file with errors.";

/// Options that are valid for a single scenario only.
const NOT_WITH_ALL: [&str; 8] =
    ["cell", "scenario", "csv", "events", "record", "max_bag_size", "max_bag_duration", "store"];

#[derive(Debug, Args)]
pub(super) struct SimArgs {
    /// The cell; left out: the one that key `cell` of the scenario names, or NAME.yaml next to NAME.scenario.yaml. Without --scenario
    /// this is the scenario
    cell: Option<PathBuf>,
    /// The scenario
    #[arg(long, value_name = "FILE", required_unless_present_any = ["all", "cell"])]
    scenario: Option<PathBuf>,
    /// Play each NAME.scenario.yaml in this folder and in those below it
    #[arg(long, value_name = "DIR", conflicts_with_all = NOT_WITH_ALL)]
    all: Option<PathBuf>,
    /// How many scenarios are played at the same time (1 to 256); left out: one on each processor
    #[arg(long, value_name = "N", requires = "all", conflicts_with = "scenario", value_parser = value_parser!(u16).range(1..=256))]
    jobs: Option<u16>,
    /// Write a JUnit report, one test case for each expectation; a file that exists is replaced
    #[arg(long, value_name = "FILE", value_parser = outputs::report())]
    junit: Option<PathBuf>,
    /// Print one JSON object (docs/json.md) instead of the report
    #[arg(long, conflicts_with = "events")]
    json: bool,
    /// Write the traced signals to this file; one that exists is replaced
    #[arg(long, value_name = "FILE", value_parser = outputs::trace())]
    csv: Option<PathBuf>,
    /// Print every event as it comes: cycle, severity, kind, sentence and code
    #[arg(long)]
    events: bool,
    #[command(flatten)]
    record: RecordArgs,
    #[command(flatten)]
    store: StoreArgs,
}

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
