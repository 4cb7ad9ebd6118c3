//! Report of a comparison.

use super::compare::{Judged, Worst, number, text};
use crate::recording::clean::clean;
use lineshaft_core::signal::Type;
use std::collections::HashSet;
use std::fmt;

/// Maximum number of names in a note.
const MAX_LISTED: usize = 10;

/// One signal of one topic.
#[derive(Clone, Debug)]
pub struct Line {
    /// Name of the signal.
    pub name: String,
    /// Topic of the expected signal.
    pub topic: String,
    /// Type of the values.
    pub(super) kind: Type,
    /// Tolerance, in SI.
    pub(super) tolerance: f64,
    pub(super) judged: Judged,
}

impl Line {
    /// Returns true if the signal is as expected.
    pub fn passed(&self) -> bool {
        self.judged.failures.is_empty()
    }

    /// Returns the error messages.
    pub fn failures(&self) -> &[String] {
        &self.judged.failures
    }

    /// Returns the largest deviation, in SI, if the signal has one.
    pub fn deviation(&self) -> Option<f64> {
        self.judged.worst.and_then(|worst| worst.deviation)
    }

    /// Returns the tolerance, in SI; `None` for signals that change in steps.
    pub fn tolerance(&self) -> Option<f64> {
        (self.kind == Type::Real).then_some(self.tolerance)
    }

    /// Returns the values with the largest difference; `None` if all are equal.
    pub fn worst(&self) -> Option<WorstValues> {
        let worst = self.shown()?;
        Some(WorstValues { at_seconds: worst.at as f64 / 1e9, run: worst.run, expected: worst.expected })
    }

    /// Returns the error messages with numbers; only the name if there are none.
    pub fn sentence(&self) -> String {
        let said = format!("{}: {}", self.name, self.judged.failures.join("; "));
        let Some(worst) = self.shown() else { return said };
        let deviation = worst.deviation.map_or_else(String::new, |far| format!("worst {} ", number(far)));
        let tolerance = self.tolerance().map_or_else(String::new, |most| format!(", tolerance {}", number(most)));
        let [run, expected] = [worst.run, worst.expected].map(|value| text(value, self.kind));
        format!("{said}: {deviation}at {} s: {run}, expected {expected}{tolerance}", worst.at as f64 / 1e9)
    }

    fn shown(&self) -> Option<Worst> {
        self.judged.worst.filter(|worst| worst.deviation != Some(0.0))
    }

    fn cells(&self) -> [String; 8] {
        let none = || "-".to_owned();
        let shown = self.shown();
        let tolerance = self.tolerance().map_or_else(none, number);
        [
            clean(&self.name).into_owned(),
            clean(&self.topic).into_owned(),
            self.deviation().map_or_else(none, number),
            shown.map_or_else(none, |worst| format!("{} s", worst.at as f64 / 1e9)),
            shown.map_or_else(none, |worst| text(worst.run, self.kind)),
            shown.map_or_else(none, |worst| text(worst.expected, self.kind)),
            tolerance,
            if self.passed() { "ok".to_owned() } else { format!("FAIL: {}", self.judged.failures.join("; ")) },
        ]
    }
}

/// Values of a signal with the largest difference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorstValues {
    /// Time relative to zero, in s.
    pub at_seconds: f64,
    /// Value of the run, in SI.
    pub run: f64,
    /// Expected value, in SI.
    pub expected: f64,
}

/// Result of a comparison. The text is for people; [`Report::passed`] is for programs.
#[derive(Clone, Debug)]
pub struct Report {
    /// Name of the run.
    pub run: String,
    /// Name of the expected run.
    pub expected: String,
    /// Description of time zero.
    pub(super) zero: &'static str,
    /// A line for each expected signal.
    pub lines: Vec<Line>,
    /// Notes for the user.
    pub notes: Vec<String>,
}

impl Report {
    /// Returns the description of time zero.
    pub fn zero(&self) -> &'static str {
        self.zero
    }

    /// Returns true if all signals are as expected.
    pub fn passed(&self) -> bool {
        self.lines.iter().all(Line::passed)
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [run, expected] = [&self.run, &self.expected].map(|name| clean(name));
        writeln!(f, "{run} against {expected}; values in SI, times from {}", self.zero)?;
        // Failed signals are printed last, where they are visible on a terminal.
        let (good, bad): (Vec<&Line>, Vec<&Line>) = self.lines.iter().partition(|line| line.passed());
        let head = ["signal", "topic", "worst", "at", "run", "expected", "tolerance", ""].map(str::to_owned);
        let rows: Vec<[String; 8]> =
            std::iter::once(head).chain(good.iter().chain(&bad).map(|line| line.cells())).collect();
        let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
        let widths: [usize; 8] = std::array::from_fn(width);
        for row in &rows {
            let [name, topic, numbers @ .., verdict] = row;
            write!(f, "{name:0$}  {topic:1$}", widths[0], widths[1])?;
            for (cell, width) in numbers.iter().zip(&widths[2..]) {
                write!(f, "  {cell:>width$}")?;
            }
            writeln!(f, "{}", format_args!("  {verdict}").to_string().trim_end_matches(' '))?;
        }
        for note in &self.notes {
            writeln!(f, "note: {}", clean(note))?;
        }
        let all = self.lines.len();
        match bad.len() {
            0 => write!(
                f,
                "PASSED: {}",
                if all == 1 { "the signal agrees".to_owned() } else { format!("all {all} signals agree") }
            ),
            failed => {
                // Several topics may have the same signal.
                let mut seen = HashSet::new();
                let names: Vec<&str> =
                    bad.iter().map(|line| line.name.as_str()).filter(|name| seen.insert(*name)).collect();
                let are = if failed == 1 { "is" } else { "are" };
                write!(f, "FAILED: {failed} of {all} signals {are} not as expected: {}", clean(&some(&names)))
            }
        }
    }
}

/// Lists some names, and the number of the others.
pub(super) fn some(names: &[&str]) -> String {
    let list = names.iter().take(MAX_LISTED).copied().collect::<Vec<_>>().join(", ");
    match names.len().saturating_sub(MAX_LISTED) {
        0 => list,
        more => format!("{list} and {more} more"),
    }
}
