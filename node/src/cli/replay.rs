//! `lineshaft replay`.

use super::output::Output;
use super::{Exit, ReplayArgs};
use crate::recording::replay::{ReplayError, Report, Verdict, replay};
use crate::recording::run::Run;
use serde_json::{Value as Json, json};

pub(super) fn run(args: &ReplayArgs) -> Exit {
    let mut output = Output::new("replay", args.json);
    output.set("run", json!(args.run.display().to_string()));
    for field in ["verdict", "first_cycle", "cycles", "values", "messages", "difference", "gap"] {
        output.set(field, Json::Null);
    }
    let exit = match play(args, &output) {
        Ok(report) => {
            show(&report, &mut output);
            match report.verdict {
                Verdict::Same => Exit::Good,
                Verdict::Differs(_) => Exit::Differs,
                // A file with errors: what comes after the gap is not known.
                Verdict::Gap { .. } => Exit::Usage,
            }
        }
        Err(error) => {
            complain_of(&error, args, &mut output);
            Exit::Usage
        }
    };
    output.finish(exit)
}

fn play(args: &ReplayArgs, output: &Output) -> Result<Report, ReplayError> {
    let mut run = Run::open(&args.run)?;
    output.watch(&mut run);
    // The bar is gone with the run.
    replay(&mut run)
}

fn complain_of(error: &ReplayError, args: &ReplayArgs, output: &mut Output) {
    match error {
        // Names its file already.
        ReplayError::Run(error) => output.complain(error),
        ReplayError::Cell(problems) | ReplayError::Store(problems) if output.is_json() => {
            output.problems(problems);
            let what =
                if matches!(error, ReplayError::Cell(_)) { "cell has errors" } else { "store does not fit the cell" };
            output.complain(&format_args!("{}: the attached {what}", args.run.display()));
        }
        error => output.complain(&format_args!("{}: {error}", args.run.display())),
    }
}

fn show(report: &Report, output: &mut Output) {
    output.say(report);
    let (verdict, difference, gap) = match &report.verdict {
        Verdict::Same => ("same", Json::Null, Json::Null),
        Verdict::Differs(found) => {
            let difference = json!({
                "cycle": found.cycle, "what": found.what, "recorded": found.recorded, "replayed": found.replayed
            });
            ("differs", difference, Json::Null)
        }
        Verdict::Gap { first, next } => ("gap", Json::Null, json!({"first_missing_cycle": first, "next_cycle": next})),
    };
    let fields = [
        ("verdict", json!(verdict)),
        ("first_cycle", json!(report.first)),
        ("cycles", json!(report.cycles)),
        ("values", json!(report.values)),
        ("messages", json!(report.messages)),
        ("difference", difference),
        ("gap", gap),
    ];
    fields.into_iter().for_each(|(name, value)| output.set(name, value));
    if output.is_json() {
        report.notes.iter().for_each(|note| output.note(note));
    }
}
