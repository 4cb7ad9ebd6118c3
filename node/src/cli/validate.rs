//! `lineshaft validate`.

use super::{Exit, ValidateArgs, complain, say};
use crate::recording::clean::clean;
use crate::recording::run::Run;
use crate::recording::validate::validate as compare;

pub(super) fn validate(args: &ValidateArgs) -> Exit {
    let runs = Run::open(&args.run).and_then(|run| Ok((run, Run::open(&args.against)?)));
    let (mut run, mut expected) = match runs {
        Ok(runs) => runs,
        Err(error) => {
            complain(&error);
            return Exit::Usage;
        }
    };
    match compare(&mut run, &mut expected, &args.tolerance, args.align.into()) {
        Ok(report) => {
            say(&report);
            if report.passed() { Exit::Good } else { Exit::Failed }
        }
        Err(error) => {
            // What is missing may be the reason.
            for cut in run.cuts().chain(expected.cuts()) {
                eprintln!("note: {}", clean(&cut.to_string()));
            }
            complain(&error);
            Exit::Usage
        }
    }
}
