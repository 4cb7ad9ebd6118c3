//! `lineshaft sim`.

use super::{Exit, SimArgs, say};
use crate::cell::Cell;
use crate::scenario::{Options, Scenario, simulate};

pub(super) fn sim(args: &SimArgs) -> Exit {
    let scenario = Cell::load(&args.cell).and_then(|cell| Ok((Scenario::load(&args.scenario, &cell)?, cell)));
    let (scenario, cell) = match scenario {
        Ok(read) => read,
        Err(problems) => {
            eprint!("{problems}");
            return Exit::Usage;
        }
    };
    match simulate(&cell, &scenario, &Options { csv: args.csv.clone(), progress: true }) {
        Ok(report) => {
            say(&report);
            if report.passed() { Exit::Good } else { Exit::Failed }
        }
        Err(error) => {
            eprintln!("error: {error}");
            Exit::Usage
        }
    }
}
