//! `lineshaft check`.

use super::{CheckArgs, Exit, say};
use crate::cell::Cell;
use crate::scenario::Scenario;

pub(super) fn check(args: &CheckArgs) -> Exit {
    let cell = match Cell::load(&args.cell) {
        Ok(cell) => cell,
        Err(problems) => {
            eprint!("{problems}");
            return Exit::Usage;
        }
    };
    say(&format_args!("{}: good: {}", args.cell.display(), summary(&cell)));
    for warning in warnings(&cell) {
        eprintln!("warning: {warning}");
    }
    let Some(path) = &args.scenario else { return Exit::Good };
    match Scenario::load(path, &cell) {
        Ok(scenario) => {
            say(&format_args!("{}: good: {}, {} cycles", path.display(), scenario.name(), scenario.cycles()));
            Exit::Good
        }
        Err(problems) => {
            eprint!("{problems}");
            Exit::Usage
        }
    }
}

/// What is no error and yet may not be what was meant.
pub(super) fn warnings(cell: &Cell) -> Vec<String> {
    cell.robot.as_ref().map_or(Vec::new(), |robot| robot.warnings(&cell.machine))
}

/// What a cell is made of, in a few words.
pub(super) fn summary(cell: &Cell) -> String {
    let machine = &cell.machine;
    let counts = [
        (machine.axes.len(), "axis", "axes"),
        (machine.encoders.len(), "encoder", "encoders"),
        (machine.io.len(), "input or output", "inputs and outputs"),
        (machine.memory.len(), "memory cell", "memory cells"),
    ];
    let counts = counts.iter().filter(|(count, ..)| *count > 0);
    let counts: Vec<String> =
        counts.map(|(count, one, many)| format!("{count} {}", if *count == 1 { one } else { many })).collect();
    let counts = if counts.is_empty() { vec!["no axes".to_owned()] } else { counts };
    format!("{}; cycle {} ms", counts.join(", "), machine.cycle_ns as f64 / 1e6)
}
