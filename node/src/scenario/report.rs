//! What became of a scenario, in words.

use super::moment;
use crate::document::Place;
use std::fmt;
use std::sync::Arc;
use std::time::Duration;

/// What became of a scenario. Its text is for people; [`Report::passed`] for programs.
#[derive(Clone, Debug)]
pub struct Report {
    /// Name of the scenario.
    pub name: String,
    /// Its file, as it was named to the program.
    pub file: Arc<str>,
    /// Cycles that were run.
    pub cycles: u64,
    /// Length of a cycle (ns).
    pub cycle_ns: u64,
    /// How long that took; left out where nobody measured it.
    pub wall: Option<Duration>,
    /// How many expectations there are.
    pub expectations: usize,
    /// Of these, how many were not judged as the optional step that they count from never fired.
    pub not_judged: usize,
    /// How many steps there are.
    pub steps: usize,
    /// Of these, how many fired.
    pub steps_fired: usize,
    /// Optional steps that never fired, and why, by place.
    pub not_fired: Vec<Failure>,
    /// What is wrong, by place.
    pub failures: Vec<Failure>,
    /// Commands that were refused as expected, by place.
    pub refused: Vec<Failure>,
    /// All expectations, in the order of the file.
    pub results: Vec<ExpectationResult>,
}

/// What became of an expectation.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ExpectationResult {
    /// Where in the file.
    pub place: Place,
    /// What is expected, and in which cycles.
    pub text: String,
    /// Whether it was judged: the optional step that it counts from may never have fired.
    pub is_judged: bool,
    /// What was found instead, if it failed.
    pub failure: Option<String>,
}

/// A sentence about a place in the scenario.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Failure {
    /// Where in the file.
    pub place: Place,
    /// What happened there, and what was expected.
    pub sentence: String,
}

impl Report {
    /// Is everything as it was expected?
    pub fn passed(&self) -> bool {
        self.failures.is_empty()
    }

    /// What is wrong apart from the expectations, by place: commands and steps, or a run that ended early.
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
