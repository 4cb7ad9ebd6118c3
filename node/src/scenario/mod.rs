//! Scenarios: timed actions, traces and expectations (contract section 5).
//!
//! A [`Scenario`] is read completely against a cell and all its errors are reported at once. [`simulate()`] runs it on
//! a simulated machine as fast as possible. Code that runs the cycle itself, such as `run --scenario`, uses a
//! [`Player`] and a [`Trace`]. The [`Report`] has the result.
//!
//! ```no_run
//! use lineshaft::{cell::Cell, scenario::{Options, Scenario, simulate}};
//! use std::path::Path;
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let cell = Cell::load(Path::new("cell.yaml"))?;
//! let scenario = Scenario::load(Path::new("first_move.yaml"), &cell)?;
//! let report = simulate(&cell, &scenario, &Options::default())?;
//! print!("{report}");
//! assert!(report.passed());
//! # Ok(())
//! # }
//! ```
//!
//! This module uses neither ROS nor CAN nor threads.

mod csv;
mod drive;
mod expect;
mod inject;
mod judge;
mod moment;
mod named_cell;
mod names;
mod outcome;
mod player;
mod predicate;
mod refusal;
mod report;
mod ruler;
mod simulate;
mod step;
mod trace;
mod verb;

pub use named_cell::{SUFFIX, cell_next_to, cell_of, other_cell};
pub(crate) use names::{did_you_mean, nearest};
pub use player::Player;
pub use report::{ExpectationResult, Failure, Report};
pub use simulate::{Options, SimulateError, simulate, simulate_with};
pub use trace::Trace;
pub(crate) use verb::{
    VERBS, WF_JOGS, WF_MODES, parameter_change, recorded_command, recorded_setpoints, vocabulary_command,
};

use crate::cell::Cell;
#[cfg(test)]
use crate::document::Observer;
use crate::document::{Document, Map, Place, Problems, Value};
use drive::Drive;
use expect::Expectation;
use globset::GlobBuilder;
use lineshaft_core::command::Action;
use lineshaft_core::config::MachineConfig;
use lineshaft_core::machine::Machine;
use lineshaft_core::signal::Signal;
use lineshaft_core::unit::excerpt;
use names::Names;
use std::path::Path;
use std::sync::Arc;
use step::Step;
use verb::{Act, Effect, Ids};

/// A scenario without errors, for the cell with which it was read. A clone is another handle to the same scenario.
#[derive(Clone, Debug)]
pub struct Scenario(Arc<Plan>);

#[derive(Debug)]
struct Plan {
    name: String,
    file: Arc<str>,
    place: Place,
    /// At least 1.
    cycles: u64,
    cycle_ns: u64,
    /// Signals in the order of the board.
    trace: Vec<Signal>,
    every: u64,
    /// Drives, sorted by their start.
    drives: Vec<Drive>,
    steps: Vec<Step>,
    /// Acts of all steps.
    acts: Vec<Act>,
    /// IDs by index.
    ids: Vec<String>,
    expectations: Vec<Expectation>,
    config: MachineConfig,
}

impl Scenario {
    /// Returns true if a step activates or deactivates the machine.
    pub fn switches_activity(&self) -> bool {
        let switches = |act: &Act| matches!(act.deed, Effect::Command(Action::Activate | Action::Deactivate));
        self.0.acts.iter().any(switches)
    }

    /// Reads a file. Files that it names are relative to its folder.
    ///
    /// # Errors
    /// Returns all errors of the file.
    pub fn load(path: &Path, cell: &Cell) -> Result<Self, Problems> {
        Self::read(Document::read(path), path, cell)
    }

    /// Reads a text; `name` is the path of its file for problems, and for files that it names.
    ///
    /// # Errors
    /// Returns all errors of the text.
    pub fn parse(name: &str, text: &str, cell: &Cell) -> Result<Self, Problems> {
        Self::read(Document::parse(name, text), Path::new(name), cell)
    }

    /// Does the same as [`Scenario::parse`]; also returns the values that were read.
    #[cfg(test)]
    pub(crate) fn parse_observed(path: &Path, text: &str, cell: &Cell) -> (Result<Self, Problems>, Arc<Observer>) {
        let mut document = Document::parse(&path.display().to_string(), text);
        let observer = document.observe();
        (Self::read(document, path, cell), observer)
    }

    fn read(document: Document, path: &Path, cell: &Cell) -> Result<Self, Problems> {
        let folder = path.parent().unwrap_or(Path::new(""));
        let plan = match Machine::new(cell.machine.clone()) {
            Ok(machine) => {
                let names = Names {
                    config: &cell.machine,
                    joints: Some(&cell.joint_names),
                    backends: &cell.backends,
                    directory: machine.directory(),
                    groups: &cell.groups,
                    folder: Some(folder),
                };
                document.root("the scenario").and_then(|root| read(&root, &names, folder, &document))
            }
            Err(error) => {
                document.problems().push(Place::START, format!("the cell makes no machine: {error}"), None);
                None
            }
        };
        match plan {
            Some(plan) if document.problems().is_empty() => {
                let file = path.display().to_string().into();
                Ok(Self(Arc::new(Plan { file, ..plan })))
            }
            _ => Err(document.into_problems()),
        }
    }

    /// Returns the name, for people.
    pub fn name(&self) -> &str {
        &self.0.name
    }

    /// Returns the length in cycles; at least 1.
    pub fn cycles(&self) -> u64 {
        self.0.cycles
    }

    /// Returns a message, with its location, about a part that needs a simulated plant, if any.
    pub fn needs_simulation(&self) -> Option<String> {
        let plan = &self.0;
        let drives = plan.drives.iter().map(|drive| (drive.place, "drive"));
        let injects =
            plan.acts.iter().filter(|act| matches!(act.deed, Effect::Inject(_) | Effect::Command(Action::PowerCycle)));
        let (place, what) = drives.chain(injects.map(|act| (act.place, "inject"))).min()?;
        let (file, Place { line, col }) = (&plan.file, place);
        Some(format!("{file}:{line}:{col}: {what} needs a simulated plant, run with --sim"))
    }
}

fn read(root: &Value<'_>, names: &Names<'_>, folder: &Path, document: &Document) -> Option<Plan> {
    let mut map = root.map("the scenario")?;
    if ["lineshaft", "axes"].iter().any(|key| map.has(key)) && !map.has("scenario") {
        let hint = "check it with `lineshaft check FILE`".to_owned();
        map.refuse("this looks like a cell; a scenario is expected", Some(hint));
        return None;
    }
    let cycle_ns = names.config.cycle_ns;
    let name = map.required("scenario").and_then(|value| value.text());
    // The cell was selected before this one was read.
    let cell = map.optional("cell").map_or(Some(()), |value| named_cell::read(&value, folder).map(drop));
    let length = length(&mut map, cycle_ns);
    // If the length is wrong, the rest is read without an end.
    let cycles = length.unwrap_or(moment::MAX_CYCLES);
    let trace = trace(&mut map, names);
    let every = map.optional("every").map_or(Some(1), |value| moment::positive_cycles(&value, cycle_ns));
    let [drives, steps, expectations] = ["drive", "steps", "expect"].map(|key| map.optional(key));
    let reader = drive::Reader { names, folder, problems: document.problems(), cycle_ns, cycles };
    let drives = drives.map_or_else(Vec::new, |section| reader.read(&section));
    let mut reader = step::Reader { names, cycle_ns, cycles, ids: Ids::default(), acts: Vec::new() };
    let steps = steps.map_or_else(Vec::new, |section| reader.read(&section));
    let (ids, acts) = (reader.ids, reader.acts);
    ids.missing().for_each(|(place, sentence)| document.problems().push(place, sentence, None));
    let reader = expect::Reader { names, steps: &steps, cycle_ns, cycles };
    let expectations = expectations.map_or_else(Vec::new, |section| reader.read(&section));
    let place = map.place();
    map.finish();
    cell?;
    Some(Plan {
        name: name?.to_owned(),
        file: "".into(),
        place,
        cycles: length?,
        cycle_ns,
        trace: trace?,
        every: every?,
        drives,
        steps,
        acts,
        ids: ids.into_names(),
        expectations,
        config: names.config.clone(),
    })
}

/// Reads keys `for` and `cycles`: returns the length in cycles.
fn length(map: &mut Map<'_>, cycle_ns: u64) -> Option<u64> {
    match (map.optional("for"), map.optional("cycles")) {
        (Some(time), None) => moment::positive_cycles(&time, cycle_ns),
        (None, Some(cycles)) => cycles.integer(1..=moment::MAX_CYCLES),
        (Some(_), Some(cycles)) => {
            cycles.refuse("for and cycles stand side by side; one of them is expected", None);
            None
        }
        (None, None) => {
            map.refuse("a scenario has no length; `for: 3 s` or `cycles: 3000` is expected", None);
            None
        }
    }
}

/// Reads signals by globs; returns them in the order of the board.
fn trace(map: &mut Map<'_>, names: &Names<'_>) -> Option<Vec<Signal>> {
    let Some(section) = map.optional("trace") else {
        return Some(names.directory.iter().map(|(signal, _)| signal).collect());
    };
    let mut traced = vec![false; names.directory.len()];
    let mut is_good = true;
    for item in section.list()? {
        is_good &= trace_glob(&item, names, &mut traced).is_some();
    }
    let signals = names.directory.iter().map(|(signal, _)| signal);
    is_good.then(|| signals.zip(traced).filter(|(_, traced)| *traced).map(|(signal, _)| signal).collect())
}

fn trace_glob(item: &Value<'_>, names: &Names<'_>, traced: &mut [bool]) -> Option<()> {
    let text = item.text()?;
    let glob = match GlobBuilder::new(text).build() {
        Ok(glob) => glob.compile_matcher(),
        Err(error) => {
            item.refuse(format!("{} is no pattern: {}", item.label(), error.kind()), None);
            return None;
        }
    };
    let mut matches = 0;
    for ((_, entry), traced) in names.directory.iter().zip(traced) {
        if glob.is_match(&entry.name) {
            *traced = true;
            matches += 1;
        }
    }
    if matches == 0 {
        let all = names.directory.iter().map(|(_, entry)| entry.name.as_str());
        let hint = names::nearest(text, all).map(names::did_you_mean);
        item.refuse(format!("no signal matches `{}`", excerpt(text)), hint);
        return None;
    }
    Some(())
}

/// Reports a problem if a cycle is after the end; returns true if it is not.
fn refuse_beyond_end(value: &Value<'_>, cycle: u64, cycles: u64, cycle_ns: u64) -> bool {
    if cycle >= cycles {
        let (given, end) = (moment::text(cycle, cycle_ns), moment::text(cycles - 1, cycle_ns));
        value.refuse(format!("{} is {given}; the scenario ends with {end}", value.label()), None);
    }
    cycle < cycles
}

#[cfg(test)]
mod tests;
