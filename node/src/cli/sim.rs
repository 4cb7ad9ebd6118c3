//! `lineshaft sim`.

use super::{Exit, SimArgs, complain, say, store};
use crate::cell::Cell;
use crate::interrupt::Interrupt;
use crate::scenario::{Options, Scenario, SimulateError, simulate_with};

pub(super) fn sim(args: &SimArgs) -> Exit {
    let scenario = Cell::load(&args.cell).and_then(|cell| Ok((Scenario::load(&args.scenario, &cell)?, cell)));
    let (scenario, mut cell) = match scenario {
        Ok(read) => read,
        Err(problems) => {
            eprint!("{problems}");
            return Exit::Usage;
        }
    };
    let Ok(store) = store::open(&args.store, &mut cell) else { return Exit::Usage };
    let (csv, record) = (args.csv.clone(), args.record.options());
    let interrupt = match Interrupt::listen() {
        Ok(interrupt) => interrupt,
        Err(error) => {
            complain(&format_args!("signals of the system cannot be received: {error}"));
            return Exit::Failed;
        }
    };
    let options = Options { csv, record, events: args.events, progress: true, interrupt };
    match simulate_with(&cell, &scenario, &options, store) {
        Ok(report) => {
            say(&report);
            if report.passed() { Exit::Good } else { Exit::Failed }
        }
        Err(error) => {
            eprintln!("error: {error}");
            match error {
                // Neither the files nor the usage were bad: the disk was.
                SimulateError::Record(_) | SimulateError::Store(_) => Exit::Failed,
                SimulateError::Interrupted { signal, .. } => Exit::Signal(signal),
                _ => Exit::Usage,
            }
        }
    }
}
