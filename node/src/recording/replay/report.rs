//! Result of a replay.

use super::compare::{Counts, Difference};
use crate::recording::run::{Run, grouped};
use std::collections::BTreeMap;
use std::fmt;

/// Verdict of a replay.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// There is no difference.
    Same,
    /// There is a difference.
    Differs(Difference),
    /// Cycles are missing; the cycles after them cannot be replayed.
    Gap {
        /// First missing cycle.
        first: u64,
        /// Next cycle in the recording.
        next: u64,
    },
}

/// Report of a replay.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Report {
    /// Verdict.
    pub verdict: Verdict,
    /// First cycle.
    pub first: u64,
    /// Number of replayed cycles.
    pub cycles: u64,
    /// Number of compared signal values.
    pub values: u64,
    /// Number of compared messages, without those of signals.
    pub messages: u64,
    /// Messages about defects of the recording.
    pub notes: Vec<String>,
}

impl Report {
    pub(super) fn new(run: &Run, verdict: Verdict, first: u64, cycles: u64, counts: Counts) -> Self {
        let mut notes: Vec<String> = run.cuts().map(ToString::to_string).collect();
        notes.extend(run.flaws().map(|flaw| flaw.to_string()));
        let ends = || run.files().iter().map(|file| file.metadata.iter().find(|(name, _)| name == "lineshaft_end"));
        let lost = |end: Option<&(_, BTreeMap<String, String>)>| end?.1.get("lost")?.parse::<u64>().ok();
        let lost: u64 = ends().filter_map(lost).sum();
        if lost > 0 {
            notes.push(format!("{lost} cycles were lost while it was recorded"));
        }
        match ends().next_back().flatten() {
            None if notes.is_empty() => notes.push("the recording has no end: its recorder was stopped".to_owned()),
            Some((_, end)) if end.get("continued").is_some_and(|continued| continued == "true") => {
                notes.push("the recording goes on in a further file, which was not read".to_owned());
            }
            _ => {}
        }
        if first > 0 {
            notes.push(format!("it begins with cycle {first}, from the attached state of the machine"));
        }
        if counts.values == 0 {
            notes.push("it holds no ~/signals: only messages were compared".to_owned());
        }
        Self { verdict, first, cycles, values: counts.values, messages: counts.messages, notes }
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.notes.iter().try_for_each(|note| writeln!(f, "note: {note}"))?;
        let last = (self.first + self.cycles).saturating_sub(1);
        let (values, messages) = (grouped(self.values), grouped(self.messages));
        match self.cycles {
            0 => writeln!(f, "replayed no cycle")?,
            count => writeln!(
                f,
                "replayed {count} cycles, {} to {last}: {values} values of signals and {messages} messages compared",
                self.first
            )?,
        }
        match &self.verdict {
            Verdict::Same => write!(f, "no difference"),
            Verdict::Differs(Difference { cycle, what, recorded, replayed }) => {
                write!(f, "first difference in cycle {cycle}: {what}: recorded {recorded}, replayed {replayed}")
            }
            Verdict::Gap { first, next } if *next <= first + 1 => {
                write!(f, "cycle {first} is missing in the recording: it cannot be replayed any further")
            }
            Verdict::Gap { first, next } => {
                let last = next - 1;
                write!(f, "cycles {first} to {last} are missing in the recording: it cannot be replayed any further")
            }
        }
    }
}
