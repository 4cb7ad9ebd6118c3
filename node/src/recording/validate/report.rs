//! What a comparison found, in words.

use super::compare::{Judged, number, text};
use crate::recording::clean::clean;
use lineshaft_core::signal::Type;
use std::collections::HashSet;
use std::fmt;

/// Names that a note lists.
const MAX_LISTED: usize = 10;

/// One signal of one topic.
#[derive(Clone, Debug)]
pub struct Line {
    /// The signal.
    pub name: String,
    /// Where it is expected.
    pub topic: String,
    /// How its values are read.
    pub(super) kind: Type,
    /// What is allowed (SI).
    pub(super) tolerance: f64,
    pub(super) judged: Judged,
}

impl Line {
    /// Is it as expected?
    pub fn passed(&self) -> bool {
        self.judged.failures.is_empty()
    }

    /// What is wrong.
    pub fn failures(&self) -> &[String] {
        &self.judged.failures
    }

    /// The largest distance (SI), where distances are measured.
    pub fn deviation(&self) -> Option<f64> {
        self.judged.worst.and_then(|worst| worst.deviation)
    }

    fn cells(&self) -> [String; 8] {
        let none = || "-".to_owned();
        let worst = self.judged.worst;
        let is_exact = worst.is_some_and(|worst| worst.deviation == Some(0.0));
        let shown = worst.filter(|_| !is_exact);
        let tolerance = if self.kind == Type::Real { number(self.tolerance) } else { none() };
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

/// What a comparison found. Its text is for people; [`Report::passed`] for programs.
#[derive(Clone, Debug)]
pub struct Report {
    /// The run.
    pub run: String,
    /// What is expected.
    pub expected: String,
    /// From where times count.
    pub(super) zero: &'static str,
    /// A line for each signal that is expected.
    pub lines: Vec<Line>,
    /// What is worth to know.
    pub notes: Vec<String>,
}

impl Report {
    /// Is everything as it is expected?
    pub fn passed(&self) -> bool {
        self.lines.iter().all(Line::passed)
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [run, expected] = [&self.run, &self.expected].map(|name| clean(name));
        writeln!(f, "{run} against {expected}; values in SI, times from {}", self.zero)?;
        // What is wrong stands where it is seen: at the end.
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
                // A signal may stand on several topics.
                let mut seen = HashSet::new();
                let names: Vec<&str> =
                    bad.iter().map(|line| line.name.as_str()).filter(|name| seen.insert(*name)).collect();
                let are = if failed == 1 { "is" } else { "are" };
                write!(f, "FAILED: {failed} of {all} signals {are} not as expected: {}", clean(&some(&names)))
            }
        }
    }
}

/// Some names, and how many more there are.
pub(super) fn some(names: &[&str]) -> String {
    let list = names.iter().take(MAX_LISTED).copied().collect::<Vec<_>>().join(", ");
    match names.len().saturating_sub(MAX_LISTED) {
        0 => list,
        more => format!("{list} and {more} more"),
    }
}
