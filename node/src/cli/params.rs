//! `lineshaft params`.

use super::{Exit, say_all};
use crate::cell::Cell;
use crate::document::Document;
use crate::output;
use crate::parameters::{Filter, check_import, details, differences, export_text, listing, markdown, meant, values};
use clap::{Args, ValueEnum};
use lineshaft_core::machine::Machine;
use lineshaft_core::object::AxisSet;
use lineshaft_core::parameter::System;
use lineshaft_ros::surface::host::ParameterSelection;
use std::path::{Path, PathBuf};

pub(super) const HELP: &str = "\
Without a cell: the catalogue, or everything about the one parameter that --name names. With a cell: the values that its axes \
begin with; * marks those that are not at their default.

Examples:
  lineshaft params --name 'sync*'
  lineshaft params --name max_velocity
  lineshaft params cell.yaml --changed
  lineshaft params cell.yaml --export > parameters.yaml
  lineshaft params cell.yaml --import parameters.yaml

Exit codes: 0 good, 2 bad usage, no such parameter, or a file with errors.";

/// Width of output that does not go to a terminal.
const WIDTH: usize = 120;
/// Minimum width; narrower terminals get lines of this width.
const NARROWEST: usize = 60;

#[derive(Debug, Args)]
pub(super) struct ParamsArgs {
    /// The cell; left out: the catalogue
    cell: Option<PathBuf>,
    /// Only parameters whose key, source's name or name with its axis matches, as `sync*`; capitals do not count
    #[arg(long, value_name = "GLOB")]
    name: Option<String>,
    /// Only parameters of one source
    #[arg(long, value_enum)]
    system: Option<SystemArg>,
    /// Only what is not at its default
    #[arg(long, requires = "cell")]
    changed: bool,
    /// Print the parameters, exactly, as --import and ~/import_parameters take them
    #[arg(long, requires = "cell", conflicts_with_all = ["name", "system"])]
    export: bool,
    /// Check a file of parameters against the cell and tell what it would change; changes nothing
    #[arg(long, value_name = "FILE", requires = "cell", conflicts_with_all = ["name", "system", "changed", "export"])]
    import: Option<PathBuf>,
    /// Print the catalogue as Markdown: docs/parameters.md
    #[arg(long, conflicts_with_all = ["cell", "name", "system", "changed", "export", "import"])]
    markdown: bool,
}

/// A source of parameters.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum SystemArg {
    /// Lineshaft itself
    Native,
    /// zub MACS
    Macs,
    /// Unidrive M advanced motion controller
    Amc,
    /// SAIA PCD4.H3
    Saia,
    /// Siemens WF 725 and 726
    Wf,
}

impl From<SystemArg> for System {
    fn from(system: SystemArg) -> Self {
        match system {
            SystemArg::Native => Self::Native,
            SystemArg::Macs => Self::Macs,
            SystemArg::Amc => Self::Amc,
            SystemArg::Saia => Self::Saia,
            SystemArg::Wf => Self::Wf,
        }
    }
}

pub(super) fn params(args: &ParamsArgs) -> Exit {
    if args.markdown {
        say_all(&markdown());
        return Exit::Good;
    }
    let filter = match Filter::new(args.name.as_deref(), args.system.map(Into::into)) {
        Ok(filter) => filter,
        Err(error) => return fail(&format!("--name: {error}")),
    };
    match &args.cell {
        None => catalogue(args, &filter),
        Some(path) => of_cell(path, args, &filter),
    }
}

fn catalogue(args: &ParamsArgs, filter: &Filter) -> Exit {
    let rows = filter.rows();
    match rows.as_slice() {
        [] => no_match(args),
        [row] => {
            say_all(&details(row, width()));
            Exit::Good
        }
        rows => {
            say_all(&listing(rows, width()));
            Exit::Good
        }
    }
}

fn of_cell(path: &Path, args: &ParamsArgs, filter: &Filter) -> Exit {
    let cell = match Cell::load(path) {
        Ok(cell) => cell,
        Err(problems) => {
            eprint!("{problems}");
            return Exit::Usage;
        }
    };
    let machine = match Machine::new(cell.machine.clone()) {
        Ok(machine) => machine,
        Err(error) => return fail(&error.to_string()),
    };
    if let Some(file) = &args.import {
        return match check_import(Document::read(file), &cell.machine, machine.directory()) {
            Ok(import) => {
                let changes = differences(&cell.machine, &import);
                say_all(if changes.is_empty() { "nothing would change\n" } else { &changes });
                Exit::Good
            }
            Err(problems) => {
                eprint!("{problems}");
                Exit::Usage
            }
        };
    }
    let image = machine.parameter_image();
    if args.export {
        let what = if args.changed { ParameterSelection::NotDefault } else { ParameterSelection::All };
        let axes = AxisSet::first(cell.machine.axes.len());
        say_all(&export_text(&cell.machine, &image, axes, what));
        return Exit::Good;
    }
    let text = values(&cell.machine, &image.effective, filter, args.changed);
    if text.is_empty() && args.name.is_some() && !args.changed {
        return no_match(args);
    }
    say_all(&text);
    Exit::Good
}

fn no_match(args: &ParamsArgs) -> Exit {
    let pattern = args.name.as_deref().unwrap_or_default();
    let hint = meant(pattern).map_or(String::new(), |near| format!(", did you mean `{near}`?"));
    fail(&format!("no parameter matches `{pattern}`{hint}"))
}

fn fail(sentence: &str) -> Exit {
    super::complain(&sentence);
    Exit::Usage
}

/// Returns the maximum length of a line.
pub(super) fn width() -> usize {
    output::columns().filter(|columns| *columns > 0).map_or(WIDTH, |columns| columns.max(NARROWEST))
}
