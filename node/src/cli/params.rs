//! `lineshaft params`.

use super::{Exit, ParamsArgs, say_all};
use crate::cell::Cell;
use crate::document::Document;
use crate::output;
use crate::parameters::{Filter, check_import, details, differences, export_text, listing, markdown, meant, values};
use lineshaft_core::machine::Machine;
use lineshaft_core::object::AxisSet;
use lineshaft_ros::surface::host::ParameterSelection;
use std::path::Path;

/// Width of output that does not go to a terminal.
const WIDTH: usize = 120;
/// Minimum width; narrower terminals get lines of this width.
const NARROWEST: usize = 60;

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
