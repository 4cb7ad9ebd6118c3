//! `lineshaft signals`.

use super::Exit;
use crate::cell::Cell;
use crate::output;
use clap::Args;
use lineshaft_core::machine::Machine;
use lineshaft_core::signal::{Entry, Type};
use std::path::PathBuf;

#[derive(Debug, Args)]
pub(super) struct CellArgs {
    /// The cell
    cell: PathBuf,
}

pub(super) fn signals(args: &CellArgs) -> Exit {
    let cell = match Cell::load(&args.cell) {
        Ok(cell) => cell,
        Err(problems) => {
            eprint!("{problems}");
            return Exit::Usage;
        }
    };
    let machine = match Machine::new(cell.machine) {
        Ok(machine) => machine,
        Err(error) => {
            eprintln!("error: {error}");
            return Exit::Usage;
        }
    };
    let directory = machine.directory();
    let width = directory.iter().map(|(_, entry)| entry.name.len()).max().unwrap_or(0);
    for (_, entry) in directory.iter() {
        // Printing is no longer possible: the reader has closed the pipe, or the disk is full.
        if !output::print_line(&format_args!("{:width$}  {}", entry.name, describe(entry))) {
            break;
        }
    }
    Exit::Good
}

fn describe(entry: &Entry) -> String {
    let kind = match entry.kind {
        Type::Int => "i64",
        Type::Real => "f64",
        Type::Bit => "bit",
        Type::Enum(_) => "enum",
        Type::Word => "word",
    };
    let drivable = if entry.drivable { ", drivable" } else { "" };
    let names = match entry.kind {
        Type::Enum(names) => {
            let names = names.iter().enumerate().map(|(number, name)| format!("{number} {name}"));
            format!(": {}", names.collect::<Vec<_>>().join(", "))
        }
        _ => String::new(),
    };
    format!("{kind:4}  {:8}  {}{drivable}{names}", entry.measure.unit(), entry.help)
}
