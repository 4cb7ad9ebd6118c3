//! The points of one signal.

use super::Refusal;
use super::gaps::Intervals;
use lineshaft_core::signal::Type;

/// Most points of all signals that are loaded together: 16 bytes each.
pub(super) const MAX_POINTS: u64 = 50_000_000;

/// How many points there may still be.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Budget(u64);

impl Default for Budget {
    fn default() -> Self {
        Self(MAX_POINTS)
    }
}

impl Budget {
    /// Takes some; none when there are not so many any more.
    pub(crate) fn spend(&mut self, points: u64) -> Option<()> {
        self.0 = self.0.checked_sub(points)?;
        Some(())
    }
}

/// One signal, as it is taken from messages.
#[derive(Clone, Debug)]
pub(crate) struct Track {
    pub name: String,
    pub unit: String,
    pub kind: Type,
    pub topic: String,
    /// Times (ns) and values: each change, the last sample before it, the first and the last sample.
    pub points: Vec<(u64, f64)>,
    /// Samples, also those that brought no point.
    pub samples: u64,
    /// Samples whose stamp lies before that of their forerunner; they are left out.
    pub late: u64,
    /// Two tracks with the same rhythm have samples at the same times after their first one.
    pub rhythm: u64,
    first: u64,
    last: u64,
    intervals: Intervals,
    /// From when to when (ns) nothing is known, where that is not told by the intervals.
    lost: Vec<(u64, u64)>,
}

impl Track {
    pub(crate) fn new(name: String, unit: String, kind: Type, topic: String) -> Self {
        Self {
            name,
            unit,
            kind,
            topic,
            points: Vec::new(),
            samples: 0,
            late: 0,
            rhythm: 0,
            first: 0,
            last: 0,
            intervals: Intervals::default(),
            lost: Vec::new(),
        }
    }

    /// Takes a sample.
    pub(crate) fn sample(&mut self, time: u64, value: f64, budget: &mut Budget) -> Result<(), Refusal> {
        if self.samples > 0 && time < self.last {
            self.late += 1;
            return Ok(());
        }
        if self.samples == 0 {
            self.first = time;
        } else {
            self.intervals.add(self.last, time);
        }
        let previous = self.last;
        self.samples += 1;
        self.last = time;
        // FNV-1a, a word at a time.
        self.rhythm = (self.rhythm ^ (time - self.first)).wrapping_mul(0x0100_0000_01b3);
        self.change(previous, time, value, budget)
    }

    /// Takes a value that may be new; `previous` is the time until which the old one held for certain.
    pub(super) fn change(&mut self, previous: u64, time: u64, value: f64, budget: &mut Budget) -> Result<(), Refusal> {
        if let Some(&(at, held)) = self.points.last() {
            if held.to_bits() == value.to_bits() {
                return Ok(());
            }
            if at < previous {
                self.push(previous, held, budget)?;
            }
        }
        self.push(time, value, budget)
    }

    /// Takes the first value behind a time from `from` on in which none is known.
    pub(super) fn resume(&mut self, from: u64, time: u64, value: f64, budget: &mut Budget) -> Result<(), Refusal> {
        self.lose(from, time, budget)?;
        self.push(time, value, budget)
    }

    /// From `from` to `to` no value is known; the last one held until then.
    pub(super) fn lose(&mut self, from: u64, to: u64, budget: &mut Budget) -> Result<(), Refusal> {
        budget.spend(1).ok_or(Refusal::TooMany)?;
        self.finish(from);
        self.lost.push((from, to));
        Ok(())
    }

    /// From when to when (ns) nothing is known, in order of time.
    pub(super) fn gaps(&self) -> Vec<(u64, u64)> {
        let mut gaps = self.intervals.gaps();
        gaps.extend(&self.lost);
        gaps.sort_unstable();
        gaps
    }

    /// The last value held until `time`.
    pub(super) fn finish(&mut self, time: u64) {
        if let Some(&(at, held)) = self.points.last()
            && at < time
        {
            self.points.push((time, held));
        }
    }

    /// The last value held until the last sample.
    pub(super) fn finish_samples(&mut self) {
        self.finish(self.last);
    }

    fn push(&mut self, time: u64, value: f64, budget: &mut Budget) -> Result<(), Refusal> {
        budget.spend(1).ok_or(Refusal::TooMany)?;
        self.points.push((time, value));
        Ok(())
    }
}
