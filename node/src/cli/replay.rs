//! `lineshaft replay`.

use super::{Exit, ReplayArgs, complain, say};
use crate::recording::replay::{ReplayError, Report, Verdict, replay};
use crate::recording::run::Run;
use crate::terminal;
use indicatif::ProgressBar;

/// Cycles between two looks at the progress.
const PROGRESS_CYCLES: u64 = 1024;

pub(super) fn run(args: &ReplayArgs) -> Exit {
    let report = match play(args) {
        Ok(report) => report,
        Err(error) => {
            match &error {
                // Names its file already.
                ReplayError::Run(error) => complain(error),
                error => complain(&format!("{}: {error}", args.run.display())),
            }
            return Exit::Usage;
        }
    };
    say(&report);
    match report.verdict {
        Verdict::Same => Exit::Good,
        Verdict::Differs(_) => Exit::Differs,
        // A file with errors: what comes after the gap is not known.
        Verdict::Gap { .. } => Exit::Usage,
    }
}

fn play(args: &ReplayArgs) -> Result<Report, ReplayError> {
    let mut run = Run::open(&args.run)?;
    let bar = match terminal::has_bars() {
        true => ProgressBar::new_spinner().with_message("cycles replayed"),
        false => ProgressBar::hidden(),
    };
    let report = replay(&mut run, |cycles| {
        if cycles.is_multiple_of(PROGRESS_CYCLES) {
            bar.set_position(cycles);
        }
    });
    bar.finish_and_clear();
    report
}
