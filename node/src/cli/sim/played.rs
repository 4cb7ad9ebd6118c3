//! Result of a scenario: as text, as JSON object, and as test cases.

use crate::cli::Exit;
use crate::cli::command_output::{Output, failures_json, omitted, problems_json};
use crate::cli::junit::{Case, Outcome, Source, Suite, class_of};
use crate::document::{Place, Problems};
use crate::interrupt::EndSignal;
use crate::scenario::{ExpectationResult, Report, SimulateError};
use crate::store::StoreError;
use serde_json::{Value as Json, json};
use std::path::{Path, PathBuf};

/// Verdicts, as in docs/json.md.
pub(super) const PASSED: &str = "passed";
pub(super) const FAILED: &str = "failed";
pub(super) const ERROR: &str = "error";

/// A scenario and its result.
#[derive(Debug)]
pub(super) struct Played {
    scenario: PathBuf,
    cell: Option<PathBuf>,
    note: Option<String>,
    result: Result<Report, Trouble>,
}

/// Reason why a scenario was not played to its end.
#[derive(Debug)]
pub(super) enum Trouble {
    /// Files with errors.
    Problems(Problems),
    /// The store cannot be used.
    Store(StoreError),
    /// The simulation could not be run.
    Simulate(SimulateError),
}

impl From<Problems> for Trouble {
    fn from(problems: Problems) -> Self {
        Self::Problems(problems)
    }
}

impl Trouble {
    fn exit(&self) -> Exit {
        match self {
            // The disk failed, not the files or the usage.
            Self::Simulate(SimulateError::Record(_) | SimulateError::Store(_)) => Exit::Failed,
            Self::Simulate(SimulateError::Interrupted { signal, .. }) => Exit::Signal(*signal),
            _ => Exit::Usage,
        }
    }

    /// Returns the problems of files, if there are any.
    fn problems(&self) -> Option<&Problems> {
        match self {
            Self::Problems(problems) | Self::Store(StoreError::Unfit { problems, .. }) => Some(problems),
            _ => None,
        }
    }

    /// Returns the errors other than the problems of files.
    fn errors(&self) -> Vec<String> {
        match self {
            Self::Problems(problems) => omitted(problems).into_iter().collect(),
            Self::Store(error) => vec![self.after_problems(&error.to_string())],
            Self::Simulate(error) => vec![error.to_string()],
        }
    }

    /// Returns the rest of a text that begins with the problems.
    fn after_problems(&self, text: &str) -> String {
        let problems = self.problems().map_or_else(String::new, Problems::to_string);
        text.strip_prefix(&problems).unwrap_or(text).to_owned()
    }

    /// Returns the location of the first problem.
    fn source(&self) -> Option<Source> {
        let first = self.problems()?.sorted().into_iter().next()?;
        Some(Source { file: first.file.to_string(), line: Some(first.place.line) })
    }

    /// Returns all errors as one text.
    fn text(&self) -> String {
        match self {
            Self::Problems(problems) => problems.to_string().trim_end().to_owned(),
            Self::Store(error) => error.to_string(),
            Self::Simulate(error) => error.to_string(),
        }
    }

    fn show(&self, output: &mut Output) {
        if let Some(problems) = self.problems() {
            output.problems(problems);
        }
        match self {
            Self::Problems(_) => {}
            // Its problems are lines before the error.
            Self::Store(StoreError::Unfit { .. }) if !output.is_json() => {
                self.errors().iter().for_each(|error| eprintln!("{error}"));
            }
            Self::Store(_) | Self::Simulate(_) => self.errors().iter().for_each(|error| output.complain(error)),
        }
    }
}

impl Played {
    /// Plays a scenario on its cell, if there is one.
    pub(super) fn new(
        scenario: &Path,
        cell: Result<PathBuf, Problems>,
        note: Option<String>,
        play: impl FnOnce(&Path) -> Result<Report, Trouble>,
    ) -> Self {
        let (cell, result) = match cell {
            Ok(cell) => {
                let result = play(&cell);
                (Some(cell), result)
            }
            Err(problems) => (None, Err(problems.into())),
        };
        Self { scenario: scenario.to_owned(), cell, note, result }
    }

    /// Returns the exit code of the command if there is no other scenario.
    pub(super) fn exit(&self) -> Exit {
        match &self.result {
            Ok(report) if report.passed() => Exit::Good,
            Ok(_) => Exit::Failed,
            Err(trouble) => trouble.exit(),
        }
    }

    /// Returns the signal that ended it, if one did.
    pub(super) fn ended_by(&self) -> Option<EndSignal> {
        match &self.result {
            Err(Trouble::Simulate(SimulateError::Interrupted { signal, .. })) => Some(*signal),
            _ => None,
        }
    }

    /// Returns one of the three verdicts.
    pub(super) fn verdict(&self) -> &'static str {
        match &self.result {
            Ok(report) if report.passed() => PASSED,
            Ok(_) => FAILED,
            Err(_) => ERROR,
        }
    }

    /// Prints the report.
    pub(super) fn show(&self, output: &mut Output) {
        if let Some(note) = &self.note {
            output.note(note);
        }
        match &self.result {
            Ok(report) => output.say(report),
            Err(trouble) => trouble.show(output),
        }
    }

    /// Prints one line, and the report unless it passed. There are no times in it, so that the same files give the same
    /// text.
    pub(super) fn show_briefly(&self, output: &mut Output) {
        let verdict = self.verdict().to_uppercase();
        output.say(&format_args!("{verdict:6} {}", self.scenario.display()));
        if let Some(note) = &self.note {
            output.note(note);
        }
        match &self.result {
            Ok(report) if report.passed() => {}
            Ok(report) => {
                let report = Report { wall: None, ..report.clone() }.to_string();
                report.lines().for_each(|line| output.say(&format_args!("       {line}")));
            }
            Err(trouble) => trouble.show(output),
        }
    }

    fn file(&self) -> String {
        self.scenario.display().to_string()
    }

    fn seconds(&self) -> Option<f64> {
        self.result.as_ref().ok()?.wall.map(|wall| wall.as_secs_f64())
    }

    /// Returns its object in `scenarios`.
    pub(super) fn json(&self) -> Json {
        let file = self.file();
        let report = self.result.as_ref().ok();
        let trouble = self.result.as_ref().err();
        let problems = trouble.and_then(Trouble::problems).map_or_else(Vec::new, problems_json);
        let list = |of: Option<Vec<Json>>| of.unwrap_or_default();
        json!({
            "scenario_file": file,
            "cell_file": self.cell.as_ref().map(|cell| cell.display().to_string()),
            "verdict": self.verdict(),
            "name": report.map(|report| &report.name),
            "cycles": report.map(|report| report.cycles),
            "cycle_ns": report.map(|report| report.cycle_ns),
            "wall_seconds": self.seconds(),
            "steps": report.map(|report| report.steps),
            "steps_fired": report.map(|report| report.steps_fired),
            "expectations": list(report.map(|report| report.results.iter().map(|result| expectation(&file, result)).collect())),
            "failures": list(report.map(|report| failures_json(&file, &report.failures))),
            "refused": list(report.map(|report| failures_json(&file, &report.refused))),
            "not_fired": list(report.map(|report| failures_json(&file, &report.not_fired))),
            "problems": problems,
            "errors": trouble.map_or_else(Vec::new, Trouble::errors),
            "notes": self.note.iter().collect::<Vec<_>>(),
        })
    }

    /// Returns its test cases: one for each expectation, and one for all of its steps and commands.
    pub(super) fn suite(&self) -> Suite {
        let file = self.file();
        let cases = match &self.result {
            Ok(report) => cases(report, &file),
            Err(trouble) => {
                let source = trouble.source().unwrap_or_else(|| Source { file: file.clone(), line: None });
                let outcome = Outcome::Error(trouble.text());
                vec![Case { name: "load and play".to_owned(), source: Some(source), outcome }]
            }
        };
        let name = self.result.as_ref().ok().map(|report| ("scenario", report.name.clone()));
        let cell = self.cell.as_ref().map(|cell| ("cell", cell.display().to_string()));
        let properties = name.into_iter().chain(cell).collect();
        let (seconds, class) = (self.seconds().unwrap_or(0.0), class_of(&self.scenario));
        Suite { name: file, properties, seconds, class, cases }
    }
}

fn verdict_of(result: &ExpectationResult) -> &'static str {
    match &result.failure {
        Some(_) => FAILED,
        None if result.is_judged => PASSED,
        None => "not_judged",
    }
}

fn expectation(file: &str, result: &ExpectationResult) -> Json {
    json!({
        "file": file,
        "line": result.place.line,
        "column": result.place.col,
        "text": result.text,
        "verdict": verdict_of(result),
        "message": result.failure,
    })
}

fn cases(report: &Report, file: &str) -> Vec<Case> {
    let at = |place: Place, sentence: &str| format!("{file}:{}:{}: {sentence}", place.line, place.col);
    let source = |line| Some(Source { file: file.to_owned(), line });
    let first = report.other_failures().map(|failure| failure.place.line).next();
    let others: Vec<String> = report.other_failures().map(|failure| at(failure.place, &failure.sentence)).collect();
    let outcome = if others.is_empty() { Outcome::Passed } else { Outcome::Failed(others.join("\n")) };
    let steps = Case { name: "steps and commands".to_owned(), source: source(first), outcome };
    let expectations = report.results.iter().map(|result| {
        let outcome = match &result.failure {
            Some(sentence) => Outcome::Failed(at(result.place, sentence)),
            None if result.is_judged => Outcome::Passed,
            None => Outcome::Skipped(at(result.place, "the step that it counts from never fired")),
        };
        Case { name: result.text.clone(), source: source(Some(result.place.line)), outcome }
    });
    std::iter::once(steps).chain(expectations).collect()
}

#[cfg(test)]
mod tests;
