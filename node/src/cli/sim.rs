//! `lineshaft sim`.

use super::{Exit, SimArgs, say};
use crate::cell::Cell;
use crate::scenario::{Options, Scenario, SimulateError, simulate};

pub(super) fn sim(args: &SimArgs) -> Exit {
    let scenario = Cell::load(&args.cell).and_then(|cell| Ok((Scenario::load(&args.scenario, &cell)?, cell)));
    let (scenario, cell) = match scenario {
        Ok(read) => read,
        Err(problems) => {
            eprint!("{problems}");
            return Exit::Usage;
        }
    };
    let options = Options { csv: args.csv.clone(), record: args.record.options(), progress: true };
    match simulate(&cell, &scenario, &options) {
        Ok(report) => {
            say(&report);
            if report.passed() { Exit::Good } else { Exit::Failed }
        }
        Err(error) => {
            eprintln!("error: {error}");
            match error {
                // Neither the files nor the usage were bad: the disk was.
                SimulateError::Record(_) => Exit::Failed,
                _ => Exit::Usage,
            }
        }
    }
}
