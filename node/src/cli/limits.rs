//! `lineshaft limits`.

use super::{Exit, LimitsArgs, complain, say, say_all};
use crate::cell::Cell;
use crate::cell_file::{self, Edited};
use crate::document::Document;
use crate::limits::{joints, limits_text, read_limits};
use crate::parameters::{Import, differences};
use std::path::Path;

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
