//! `lineshaft validate`.

use super::command_output::{Output, watch};
use super::junit::{self, Case, Outcome, Suite};
use super::{Exit, outputs};
use crate::recording::run::{Run, RunError};
use crate::recording::validate::{Align, Line, Report, Tolerance, validate as compare};
use clap::{Args, ValueEnum};
use serde_json::{Value as Json, json};
use std::path::{Path, PathBuf};
use std::time::Instant;

pub(super) const HELP: &str = "\
Both runs are bags of any recorder: an .mcap file, a folder, or a metadata.yaml. The trajectories of joint_states and \
axis_states are compared in time, read on straight lines between their samples. Numbers that change in steps (states, bits, \
error codes) must have the same values in the same order; where both runs have samples at the same times, at the same times.

SIGNAL is a name or a pattern, such as x.actual.position (also x.position), x.command.velocity, x.following_error, '*.position', \
or time, which loosens where the signals begin and end (by itself two samples of what is expected) and how long a run may \
have no sample (by itself five of its samples). VALUE is a number in SI (m, m/s, m/s^2, rad, \
rad/s, rad/s^2, N, Nm, s) or has a unit: 10 um, 0.1 deg, 5 mm/s, 50 ms. A value with a unit holds for those matched \
signals that have it: of linear or of rotary axes, as the cell.yaml attached to one of the runs tells. Without it a length \
and an angle for one signal are refused, unless the last of them names it alone. What has no tolerance must be equal. Of several the last one holds.

Examples:
  lineshaft validate run.mcap --against expected.mcap --tolerance '*.position=10 um' --tolerance '*.velocity=5 mm/s'
  lineshaft validate run/ --against expected/ --align motion --tolerance '*=1 mm' --tolerance 'time=50 ms'

Exit codes: 0 all signals agree, 1 one deviates, is missing, has a gap or is NaN, 2 bad usage or a bad file.";

#[derive(Debug, Args)]
pub(super) struct ValidateArgs {
    /// The run: an .mcap file, a folder, or a metadata.yaml
    run: PathBuf,
    /// The run that is expected, likewise
    #[arg(long, value_name = "EXPECTED")]
    against: PathBuf,
    /// How far a signal may be from what is expected
    #[arg(long, value_name = "SIGNAL=VALUE")]
    tolerance: Vec<Tolerance>,
    /// From where the times of both count
    #[arg(long, value_enum, default_value_t)]
    align: AlignArg,
    /// Write a JUnit report, one test case for each signal; a file that exists is replaced
    #[arg(long, value_name = "FILE", value_parser = outputs::report())]
    junit: Option<PathBuf>,
    /// Print one JSON object (docs/json.md) instead of the report
    #[arg(long)]
    json: bool,
}

#[derive(Clone, Copy, Debug, Default, ValueEnum)]
enum AlignArg {
    /// The first sample of each run
    #[default]
    Start,
    /// The first sample at which a position is further from where it was than its tolerance
    Motion,
}

impl From<AlignArg> for Align {
    fn from(align: AlignArg) -> Self {
        match align {
            AlignArg::Start => Self::Start,
            AlignArg::Motion => Self::Motion,
        }
    }
}

pub(super) fn validate(args: &ValidateArgs) -> Exit {
    let started = Instant::now();
    let mut output = Output::new("validate", args.json);
    for (field, value) in [("run", &args.run), ("expected", &args.against)] {
        output.set(field, json!(value.display().to_string()));
    }
    output.set("passed", json!(false));
    output.set("times_from", Json::Null);
    output.set("signals", json!([]));
    let (exit, cases) = match judge(args, &mut output) {
        Ok(report) => {
            show(&report, &mut output);
            (if report.passed() { Exit::Good } else { Exit::Failed }, report.lines.iter().map(case).collect())
        }
        Err(sentence) => {
            output.complain(&sentence);
            (Exit::Usage, vec![Case { name: "compare".to_owned(), source: None, outcome: Outcome::Error(sentence) }])
        }
    };
    let (run, expected) = (args.run.display(), args.against.display());
    let suite = Suite {
        name: format!("{run} against {expected}"),
        properties: vec![("run", run.to_string()), ("expected", expected.to_string())],
        seconds: started.elapsed().as_secs_f64(),
        class: "validate".to_owned(),
        cases,
    };
    let exit = junit::write(args.junit.as_deref(), "lineshaft validate", &[suite], exit, &mut output);
    output.finish(exit)
}

fn judge(args: &ValidateArgs, output: &mut Output) -> Result<Report, String> {
    let open = |path: &Path| -> Result<Run, RunError> {
        let mut run = Run::open(path)?;
        if !args.json {
            watch(&mut run);
        }
        Ok(run)
    };
    let mut run = open(&args.run).map_err(|error| error.to_string())?;
    let mut expected = open(&args.against).map_err(|error| error.to_string())?;
    let compared = compare(&mut run, &mut expected, &args.tolerance, args.align.into());
    [&mut run, &mut expected].into_iter().for_each(Run::end_progress);
    compared.map_err(|error| {
        // The missing part may be the reason.
        for cut in run.cuts().chain(expected.cuts()) {
            output.note(cut);
        }
        error.to_string()
    })
}

fn show(report: &Report, output: &mut Output) {
    output.say(report);
    output.set("passed", json!(report.passed()));
    output.set("times_from", json!(report.zero()));
    output.set("signals", report.lines.iter().map(object).collect());
    if output.is_json() {
        report.notes.iter().for_each(|note| output.note(note));
    }
}

fn object(line: &Line) -> Json {
    let worst = line.worst();
    json!({
        "signal": line.name,
        "topic": line.topic,
        "passed": line.passed(),
        "deviation": line.deviation(),
        "at_seconds": worst.map(|worst| worst.at_seconds),
        "run_value": worst.map(|worst| worst.run),
        "expected_value": worst.map(|worst| worst.expected),
        "tolerance": line.tolerance(),
        "failures": line.failures(),
    })
}

fn case(line: &Line) -> Case {
    let outcome = if line.passed() { Outcome::Passed } else { Outcome::Failed(line.sentence()) };
    Case { name: format!("{} ({})", line.name, line.topic), source: None, outcome }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::test_bags::{TestBag, joints};

    /// x is 5 mm too far at 0.1 s, y agrees, z is missing.
    fn report() -> Report {
        let folder = tempfile::tempdir().unwrap();
        let bag = |name: &str, is_run: bool| {
            let mut bag = TestBag::new();
            for sample in 0..20_u64 {
                let stamp = sample * 10_000_000;
                let x = if is_run && sample == 10 { 0.505 } else { 0.5 };
                let all = [("x", x), ("y", 0.25), ("z", 1.0)];
                bag.message("/joint_states", stamp, &joints(stamp, if is_run { &all[..2] } else { &all }));
            }
            let path = folder.path().join(name);
            std::fs::write(&path, bag.finish()).unwrap();
            Run::open(&path).unwrap()
        };
        let tolerance = "x.position=1 mm".parse().unwrap();
        compare(&mut bag("run.mcap", true), &mut bag("expected.mcap", false), &[tolerance], Default::default()).unwrap()
    }

    #[test]
    fn object_of_a_signal_has_its_worst_deviation_in_si() {
        let report = report();
        let of = |name: &str| report.lines.iter().find(|line| line.name == name).map(object).unwrap();
        let x = of("x.actual.position");
        assert_eq!(
            (&x["passed"], &x["topic"], &x["tolerance"]),
            (&json!(false), &json!("/joint_states"), &json!(0.001))
        );
        assert!((x["deviation"].as_f64().unwrap() - 0.005).abs() < 1e-12, "{x}");
        assert_eq!(
            (&x["at_seconds"], &x["run_value"], &x["expected_value"]),
            (&json!(0.1), &json!(0.505), &json!(0.5))
        );
        assert_eq!(x["failures"], json!(["deviates"]));
        let y = of("y.actual.position");
        assert_eq!((&y["passed"], &y["deviation"], &y["tolerance"]), (&json!(true), &json!(0.0), &json!(0.0)));
        assert_eq!((&y["at_seconds"], &y["run_value"], &y["failures"]), (&Json::Null, &Json::Null, &json!([])));
        let z = of("z.actual.position");
        assert_eq!((&z["deviation"], &z["failures"]), (&Json::Null, &json!(["missing in the run"])));
    }

    #[test]
    fn test_case_of_a_signal_contains_its_deviation() {
        let cases: Vec<Case> = report().lines.iter().map(case).collect();
        let find = |name: &str| &cases.iter().find(|case| case.name == name).unwrap().outcome;
        let Outcome::Failed(text) = find("x.actual.position (/joint_states)") else { panic!("{cases:?}") };
        assert!(text.starts_with("x.actual.position: deviates: worst 0.005") && text.contains("at 0.1 s"), "{text}");
        assert_eq!(find("y.actual.position (/joint_states)"), &Outcome::Passed);
        let missing = Outcome::Failed("z.actual.position: missing in the run".to_owned());
        assert_eq!(find("z.actual.position (/joint_states)"), &missing);
    }
}
