//! `lineshaft replay`.

use super::Exit;
use super::command_output::Output;
use crate::recording::replay::{ReplayError, Report, Verdict, replay};
use crate::recording::run::Run;
use clap::Args;
use serde_json::{Value as Json, json};
use std::path::PathBuf;

#[derive(Debug, Args)]
pub(super) struct ReplayArgs {
    /// The run: an .mcap file, a folder, or a metadata.yaml
    run: PathBuf,
    /// Print one JSON object (docs/json.md) instead of the report
    #[arg(long)]
    json: bool,
}

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
                // A file with errors: the cycles after the gap cannot be checked.
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
    // The progress bar ends with the run.
    replay(&mut run)
}

fn complain_of(error: &ReplayError, args: &ReplayArgs, output: &mut Output) {
    match error {
        // The message contains the file name already.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::replay::Difference;

    fn shown(verdict: Verdict) -> Json {
        let notes = vec!["the recording has no end".to_owned()];
        let report = Report { verdict, first: 10, cycles: 5, values: 7, messages: 3, notes };
        let mut output = Output::new("replay", true);
        show(&report, &mut output);
        output.object(Exit::Good).unwrap()
    }

    #[test]
    fn object_has_the_first_difference_or_the_gap() {
        let [what, recorded, replayed] = ["x.state", "1", "2"].map(str::to_owned);
        let found = Difference { cycle: 12, what, recorded, replayed };
        let object = shown(Verdict::Differs(found));
        assert_eq!((&object["verdict"], &object["gap"]), (&json!("differs"), &Json::Null));
        let difference = json!({"cycle": 12, "what": "x.state", "recorded": "1", "replayed": "2"});
        assert_eq!(
            (&object["difference"], &object["first_cycle"], &object["cycles"]),
            (&difference, &json!(10), &json!(5))
        );
        assert_eq!((&object["values"], &object["messages"]), (&json!(7), &json!(3)));
        assert_eq!(object["notes"], json!(["the recording has no end"]));
        let object = shown(Verdict::Gap { first: 15, next: 18 });
        assert_eq!((&object["verdict"], &object["difference"]), (&json!("gap"), &Json::Null));
        assert_eq!(object["gap"], json!({"first_missing_cycle": 15, "next_cycle": 18}));
    }
}
