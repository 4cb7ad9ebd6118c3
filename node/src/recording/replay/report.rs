//! What a replay found.

use super::compare::{Counts, Difference};
use crate::recording::run::{Run, grouped};
use std::collections::BTreeMap;
use std::fmt;

/// How it ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Nothing differs.
    Same,
    /// Something does.
    Differs(Difference),
    /// Cycles are missing: what comes after them cannot be replayed.
    Gap {
        /// The first one that is missing.
        first: u64,
        /// The one that comes next in the recording.
        next: u64,
    },
}

/// What a replay found.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Report {
    /// How it ended.
    pub verdict: Verdict,
    /// First cycle.
    pub first: u64,
    /// Cycles that were replayed.
    pub cycles: u64,
    /// Values of signals that were compared.
    pub values: u64,
    /// Messages that were compared, beside those of the signals.
    pub messages: u64,
    /// What the recording itself lacks, in sentences.
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
