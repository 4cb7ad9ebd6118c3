//! `lineshaft limits`.

use super::{Exit, complain, say, say_all};
use crate::cell::Cell;
use crate::cell_file::{self, Edited};
use crate::document::Document;
use crate::limits::{joints, limits_text, read_limits};
use crate::parameters::{Import, differences};
use clap::Args;
use std::path::{Path, PathBuf};

pub(super) const HELP: &str = "\
Written are position, velocity, acceleration and jerk of each axis with a drive, in SI units, to standard output. max_acceleration is the \
lower of max_acceleration and max_deceleration of the axis.

--from changes the cell file: values only, comments and order stay. Each change is printed. has_..: false gives no limit, so the cell keeps its \
own. max_deceleration follows max_acceleration where the cell leaves it out or has a lower one. Values that a node has saved \
(docs/storage.md) hide those of the cell.

Examples:
  lineshaft limits cell.yaml > joint_limits.yaml
  lineshaft limits cell.yaml --group arm > joint_limits.yaml
  lineshaft limits cell.yaml --from joint_limits.yaml

Exit codes: 0 good, 2 bad usage, no such group, or a file with errors; the cell is what it was then.";

#[derive(Debug, Args)]
pub(super) struct LimitsArgs {
    /// The cell
    cell: PathBuf,
    /// Only the joints of one group; left out: all axes with a drive
    #[arg(long, value_name = "NAME")]
    group: Option<String>,
    /// Read this joint_limits.yaml into the cell, which is changed in its place
    #[arg(long, value_name = "FILE")]
    from: Option<PathBuf>,
}

pub(super) fn limits(args: &LimitsArgs) -> Exit {
    let cell = match Cell::load(&args.cell) {
        Ok(cell) => cell,
        Err(problems) => {
            eprint!("{problems}");
            return Exit::Usage;
        }
    };
    let places = match joints(&cell, args.group.as_deref()) {
        Ok(places) => places,
        Err(sentence) => return fail(&format!("--group: {sentence}")),
    };
    match &args.from {
        None => {
            say_all(&limits_text(&cell, &places));
            Exit::Good
        }
        Some(file) => read(args, file, &cell, &places),
    }
}

/// Writes the limits of a file into the cell.
fn read(args: &LimitsArgs, file: &Path, cell: &Cell, places: &[usize]) -> Exit {
    let settings = match read_limits(Document::read(file), cell, places) {
        Ok(settings) => settings,
        Err(problems) => {
            eprint!("{problems}");
            return Exit::Usage;
        }
    };
    match cell_file::apply(&args.cell, &cell.text, &settings) {
        Ok(Edited { written, .. }) if written.is_empty() => {
            say(&"nothing changes");
            Exit::Good
        }
        Ok(Edited { cell: new, written, .. }) => {
            let parameters = new.machine.axes.iter().map(|axis| axis.parameters).collect();
            let import = Import { changes: Box::default(), parameters, machine: cell.machine.global.power_on() };
            say_all(&differences(&cell.machine, &import));
            let s = if written.len() == 1 { "" } else { "s" };
            say(&format_args!("{}: {} value{s} written", args.cell.display(), written.len()));
            Exit::Good
        }
        Err(error) => fail(&error),
    }
}

fn fail(sentence: &dyn std::fmt::Display) -> Exit {
    complain(sentence);
    Exit::Usage
}
