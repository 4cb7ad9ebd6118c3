//! Stores the points of one signal.

use super::Refusal;
use super::gaps::Intervals;
use lineshaft_core::signal::Type;

/// Maximum number of points of all signals that are loaded together; a point has 16 bytes.
pub(super) const MAX_POINTS: u64 = 50_000_000;

/// Number of points that may still be added.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Budget(u64);

impl Default for Budget {
    fn default() -> Self {
        Self(MAX_POINTS)
    }
}

impl Budget {
    /// Subtracts points; returns `None` if fewer are left.
    pub(crate) fn spend(&mut self, points: u64) -> Option<()> {
        self.0 = self.0.checked_sub(points)?;
        Some(())
    }
}

/// One signal, read from messages.
#[derive(Clone, Debug)]
pub(crate) struct Track {
    pub name: String,
    pub unit: String,
    pub kind: Type,
    pub topic: String,
    /// Times in ns, and values: each change, the last sample before it, the first and the last sample.
    pub points: Vec<(u64, f64)>,
    /// Number of samples, including those without a point.
    pub samples: u64,
    /// Number of samples whose stamp is before that of the previous sample; they are left out.
    pub late: u64,
    /// Hash of the sample times: two tracks with the same hash have samples at the same times after their first one.
    pub rhythm: u64,
    first: u64,
    last: u64,
    intervals: Intervals,
    /// Start and end, in ns, of times with unknown values that do not follow from the intervals.
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

    /// Adds a sample.
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
        // FNV-1a, word by word.
        self.rhythm = (self.rhythm ^ (time - self.first)).wrapping_mul(0x0100_0000_01b3);
        self.change(previous, time, value, budget)
    }

    /// Adds a value that may be new; `previous` is the time until which the old one was certainly valid.
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

    /// Adds the first value after a time of unknown values that began at `from`.
    pub(super) fn resume(&mut self, from: u64, time: u64, value: f64, budget: &mut Budget) -> Result<(), Refusal> {
        self.lose(from, time, budget)?;
        self.push(time, value, budget)
    }

    /// Records that the value is unknown from `from` to `to`; the last value was valid until `from`.
    pub(super) fn lose(&mut self, from: u64, to: u64, budget: &mut Budget) -> Result<(), Refusal> {
        budget.spend(1).ok_or(Refusal::TooMany)?;
        self.finish(from);
        self.lost.push((from, to));
        Ok(())
    }

    /// Returns start and end, in ns, of all times with unknown values, in order of time.
    pub(super) fn gaps(&self) -> Vec<(u64, u64)> {
        let mut gaps = self.intervals.gaps();
        gaps.extend(&self.lost);
        gaps.sort_unstable();
        gaps
    }

    /// Extends the last value to `time`.
    pub(super) fn finish(&mut self, time: u64) {
        if let Some(&(at, held)) = self.points.last()
            && at < time
        {
            self.points.push((time, held));
        }
    }

    /// Extends the last value to the last sample.
    pub(super) fn finish_samples(&mut self) {
        self.finish(self.last);
    }

    fn push(&mut self, time: u64, value: f64, budget: &mut Budget) -> Result<(), Refusal> {
        budget.spend(1).ok_or(Refusal::TooMany)?;
        self.points.push((time, value));
        Ok(())
    }
}
