//! Report of a scenario.

use super::moment;
use crate::document::Place;
use std::fmt;
use std::sync::Arc;
use std::time::Duration;

/// Result of a scenario. The text is for people; [`Report::passed`] is for programs.
#[derive(Clone, Debug)]
pub struct Report {
    /// Name of the scenario.
    pub name: String,
    /// Path of its file, as given to the program.
    pub file: Arc<str>,
    /// Number of cycles that were run.
    pub cycles: u64,
    /// Cycle time, in ns.
    pub cycle_ns: u64,
    /// Duration of the run; `None` if it was not measured.
    pub wall: Option<Duration>,
    /// Number of expectations.
    pub expectations: usize,
    /// Number of expectations that were not judged because the optional step from which they count never fired.
    pub not_judged: usize,
    /// Number of steps.
    pub steps: usize,
    /// Number of steps that fired.
    pub steps_fired: usize,
    /// Optional steps that never fired, with the reason, sorted by location.
    pub not_fired: Vec<Failure>,
    /// Failures, sorted by location.
    pub failures: Vec<Failure>,
    /// Commands that were refused as expected, sorted by location.
    pub refused: Vec<Failure>,
    /// All expectations, in the order of the file.
    pub results: Vec<ExpectationResult>,
}

/// Result of an expectation.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ExpectationResult {
    /// Location in the file.
    pub place: Place,
    /// Expectation and its cycles, as text.
    pub text: String,
    /// Whether it was judged; not if the optional step from which it counts never fired.
    pub is_judged: bool,
    /// Actual value or events, if it failed.
    pub failure: Option<String>,
}

/// A message about a location in the scenario.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Failure {
    /// Location in the file.
    pub place: Place,
    /// Actual and expected result.
    pub sentence: String,
}

impl Report {
    /// Returns true if there are no failures.
    pub fn passed(&self) -> bool {
        self.failures.is_empty()
    }

    /// Returns the failures other than those of expectations, sorted by location: of commands, of steps, or of a run
    /// that ended early.
    pub fn other_failures(&self) -> impl Iterator<Item = &Failure> {
        let results = &self.results;
        self.failures.iter().filter(move |failure| {
            let mut results = results.iter();
            !results.any(|result| result.place == failure.place && result.failure.as_ref() == Some(&failure.sentence))
        })
    }

    fn pace(&self) -> String {
        let simulated = u128::from(self.cycles) * u128::from(self.cycle_ns);
        let Some(wall) = self.wall else { return String::new() };
        let seconds = wall.as_secs_f64();
        if wall.is_zero() {
            return String::new();
        }
        format!(" in {seconds:.3} s, {:.1} times real time", simulated as f64 / 1e9 / seconds)
    }

    fn expectations_text(&self) -> String {
        let not_judged = match self.not_judged {
            0 => String::new(),
            count => format!(" ({count} not judged)"),
        };
        format!(
            "{}{not_judged}, {} of {} fired",
            count(self.expectations, "expectation"),
            self.steps_fired,
            count(self.steps, "step")
        )
    }
}

fn count(number: usize, thing: &str) -> String {
    if number == 1 { format!("1 {thing}") } else { format!("{number} {thing}s") }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let verdict = if self.passed() { "PASSED" } else { "FAILED" };
        writeln!(f, "scenario `{}`: {verdict}", self.name)?;
        let seconds = moment::seconds(self.cycles, self.cycle_ns);
        writeln!(f, "  {}, {seconds} s{}", count(self.cycles as usize, "cycle"), self.pace())?;
        writeln!(f, "  {}", self.expectations_text())?;
        let lists = [
            ("refused as expected", &self.refused),
            ("optional and never fired", &self.not_fired),
            ("failures", &self.failures),
        ];
        for (title, list) in lists {
            if !list.is_empty() {
                writeln!(f, "  {title}:")?;
            }
            for Failure { place, sentence } in list {
                writeln!(f, "    {}:{}:{}: {sentence}", self.file, place.line, place.col)?;
            }
        }
        Ok(())
    }
}
