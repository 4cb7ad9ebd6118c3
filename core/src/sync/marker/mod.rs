//! Matches marks of master and slave (SYNCM).
//!
//! Law      error of a pair = ratio * (travel of the master since its mark + offset) - travel of the slave since its
//!          mark. Corrections that are commanded but not moved yet are not commanded again (MACS-MARK-13, A-39, A-40).
//!          Pairs are the groups that are nearest to each other with respect to the remaining error; SYNCMSTART defines
//!          the first pair, and the part of its error that is corrected
//! Reads    both sides, active corrections, parameters
//! Writes   the correction of each pair; the accuracy of the pairs
//! Refuses  nothing
//! Source   MACS-MARK-01, -02, -12 to -14, -20, -21, A-33, A-39, A-40, A-42

mod law;
mod side;

pub use law::{Law, LawInputs};
pub use side::{Found, Group, Judged, Side};

use crate::parameter::Marks;
use crate::position::Position;
use serde::{Deserialize, Serialize};

/// SYNCMSTART of cams that begin at their first mark. With any value the first pair of a cam is the nearest one.
pub const FROM_MARK: i64 = 2_000;

/// Side of a mark.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum MarkSide {
    /// Side of the leader.
    Master,
    /// Side of the follower.
    Slave,
}

/// Selection of the first pair (SYNCMSTART without its thousands).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Start {
    /// The first mark of the slave after the first one of the master.
    MasterFirst,
    /// The first mark of the master after the first one of the slave.
    SlaveFirst,
    /// The first marks, at once or once the slave has the velocity of its master.
    First {
        waits: bool,
    },
    /// The next mark of the slave, and the mark of the master ahead, behind, or nearest.
    Forward,
    Backward,
    Nearest,
    /// None: the curve has already matched the marks.
    Smooth,
    /// The marks nearest to each other, at once (cams).
    Cam,
}

impl Start {
    fn of(number: i64) -> Self {
        if number == FROM_MARK {
            return Self::Cam;
        }
        match number % 1_000 {
            0 => Self::MasterFirst,
            1 => Self::SlaveFirst,
            2 => Self::First { waits: true },
            3 => Self::Forward,
            4 => Self::Backward,
            6 => Self::First { waits: false },
            7 => Self::Smooth,
            _ => Self::Nearest,
        }
    }

    /// Whether it waits for the velocity of the master.
    fn waits(self) -> bool {
        !matches!(self, Self::MasterFirst | Self::SlaveFirst | Self::First { waits: false } | Self::Cam)
    }

    /// Whether the mark of the master is selected by distance.
    fn selects_by_distance(self) -> bool {
        matches!(self, Self::Forward | Self::Backward | Self::Nearest)
    }

    /// Returns the part of an error that is corrected, for marks every `period` (inc of the slave), 0: unknown; `sense`
    /// is 1 or -1.
    fn reduce(self, error: f64, period: f64, sense: f64) -> f64 {
        if period <= 0.0 {
            return error;
        }
        // In the direction of motion of the slave.
        sense * self.reduce_forward(sense * error, period)
    }

    fn reduce_forward(self, error: f64, period: f64) -> f64 {
        let forward = error - libm::floor(error / period) * period;
        match self {
            Self::Forward => forward,
            Self::Backward if forward > 0.0 => forward - period,
            Self::Nearest if forward > period / 2.0 => forward - period,
            Self::Backward | Self::Nearest => forward,
            _ => error,
        }
    }
}

/// Result of a pair.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair {
    /// Distance between the marks (inc of the slave); positive: the slave is behind.
    pub error: f64,
    /// Correction for it (inc of the slave).
    pub correction: f64,
}

/// Inputs for matching marks.
#[derive(Clone, Copy, Debug)]
pub struct Situation<'p> {
    /// Inputs of the law.
    pub asked: LawInputs<'p>,
    /// Active offset (inc of the master).
    pub offset: f64,
    /// Commanded correction that is not moved yet (inc of the slave).
    pub under_way: f64,
    /// Whether the slave has the velocity of its master.
    pub runs: bool,
    /// 1 if the slave counts up with its master, -1 if it counts down.
    pub sense: f64,
}

/// State of a coupling by marks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Marker {
    master: Side,
    slave: Side,
    law: Law,
    /// Whether the first pair was found.
    has_begun: bool,
    /// Number of successive accurate pairs, and of inaccurate ones.
    good: i64,
    bad: i64,
    last: Option<(f64, f64)>,
    /// Expected error of the next pair without new disturbances (inc of the slave).
    expected: f64,
}

impl Marker {
    /// Whether the state is possible.
    pub fn is_sound(&self) -> bool {
        let last = self.last.is_none_or(|(error, correction)| error.is_finite() && correction.is_finite());
        self.master.is_sound() && self.slave.is_sound() && self.law.is_sound() && last && self.expected.is_finite()
    }

    /// Returns one side.
    pub fn side(&self, of: MarkSide) -> &Side {
        match of {
            MarkSide::Master => &self.master,
            MarkSide::Slave => &self.slave,
        }
    }

    fn side_mut(&mut self, of: MarkSide) -> &mut Side {
        match of {
            MarkSide::Master => &mut self.master,
            MarkSide::Slave => &mut self.slave,
        }
    }

    /// Returns the state of its filters.
    pub fn law(&self) -> &Law {
        &self.law
    }

    /// Whether the first pair was found.
    pub fn has_begun(&self) -> bool {
        self.has_begun
    }

    /// Returns error and correction of the last pair (inc of the slave).
    pub fn last(&self) -> (f64, f64) {
        self.last.unwrap_or_default()
    }

    /// Whether enough successive pairs were accurate: READY (MACS-MARK-20).
    pub fn is_ready(&self, marks: &Marks) -> bool {
        self.good > 0 && self.good >= marks.ready
    }

    /// Whether more successive pairs were inaccurate than tolerated: FAULT (MACS-MARK-21).
    pub fn is_faulty(&self, marks: &Marks) -> bool {
        self.bad > marks.fault
    }

    /// Advances both sides.
    pub fn advance(&mut self, master: Position, slave: Position) {
        self.master.advance(master);
        self.slave.advance(slave);
    }

    /// Sets the travel of a side since its last mark (inc of the side).
    pub fn set_travel(&mut self, of: MarkSide, since: Position) {
        self.side_mut(of).set_travel(since);
    }

    /// Adds a mark of a side, with its distance to the present position (inc of the side) and its time.
    pub fn take(&mut self, of: MarkSide, (before, instant_ns): (Position, u64), asked: &LawInputs<'_>) -> Found {
        let found = self.side_mut(of).take(before, instant_ns, &check_parameters(of, asked));
        if let Found::Mark { distance: Some(distance) } = found {
            match of {
                MarkSide::Master => self.law.take_master(distance, asked),
                MarkSide::Slave => self.law.take_slave(distance, asked),
            }
        }
        found
    }

    /// Counts extra marks of a side.
    pub fn count_extra(&mut self, of: MarkSide, count: u32) {
        self.side_mut(of).count_extra(count);
    }

    /// Checks whether a mark of a side was missed in this cycle; returns true if so.
    pub fn check_missed(&mut self, of: MarkSide, asked: &LawInputs<'_>) -> bool {
        self.side_mut(of).check_missed(&check_parameters(of, asked))
    }

    /// Returns the error of a pair (inc of the slave).
    fn error(&self, master: Position, slave: Position, situation: &Situation<'_>) -> f64 {
        let of_master = (self.master.travel() - master).to_f64() + situation.offset;
        of_master * situation.asked.ratio - (self.slave.travel() - slave).to_f64() - situation.under_way
    }

    /// Returns the distance between marks of groups of the master (inc of the slave); 0: unknown.
    fn period(&self, asked: &LawInputs<'_>) -> f64 {
        self.law.distance(asked) * asked.marks.per_master.max(1) as f64 * asked.ratio.abs()
    }

    /// Returns the next matched pair, if there is one; `accuracy`: limit of an accurate pair (inc of the slave).
    pub fn pair(&mut self, situation: &Situation<'_>, accuracy: i64) -> Option<Pair> {
        let error = if self.has_begun { self.next_error(situation) } else { self.first_error(situation) }?;
        let correction = self.law.correct(error, &situation.asked);
        self.expected = error - correction;
        // Distance between the marks, including corrections not moved yet.
        let error = error + situation.under_way;
        if error.abs() <= accuracy.unsigned_abs() as f64 {
            (self.good, self.bad) = (self.good.saturating_add(1), 0);
        } else {
            (self.good, self.bad) = (0, self.bad.saturating_add(1));
        }
        self.last = Some((error, correction));
        Some(Pair { error, correction })
    }

    /// Returns the error of the first pair selected by SYNCMSTART, from which on pairs are corrected.
    fn first_error(&mut self, situation: &Situation<'_>) -> Option<f64> {
        let start = Start::of(situation.asked.marks.start);
        if start.waits() && !situation.runs {
            // Earlier marks do not count.
            self.master.forget(side::MOST_GROUPS);
            self.slave.forget(side::MOST_GROUPS);
            return None;
        }
        if start == Start::Cam {
            let total = self.next_error(situation)?;
            self.has_begun = true;
            self.law.start(total, &situation.asked);
            return Some(total);
        }
        if start == Start::Smooth {
            self.master.forget(side::MOST_GROUPS);
            self.slave.forget(side::MOST_GROUPS);
            self.has_begun = true;
            return None;
        }
        let of_master =
            if start.selects_by_distance() { self.master.groups().last() } else { self.master.groups().first() };
        let (master, slave) = (*of_master?, *self.slave.groups().first()?);
        // SYNCMSTART may require one side first; earlier marks of the other side are no partners.
        match start {
            Start::MasterFirst if slave.instant_ns < master.instant_ns => {
                self.slave.forget(0);
                return self.first_error(situation);
            }
            Start::SlaveFirst if master.instant_ns < slave.instant_ns => {
                self.master.forget(0);
                return self.first_error(situation);
            }
            _ => {}
        }
        let error = self.error(master.place, slave.place, situation);
        let total = start.reduce(error, self.period(&situation.asked), situation.sense);
        self.master.forget(side::MOST_GROUPS);
        self.slave.forget(0);
        self.has_begun = true;
        self.law.start(total, &situation.asked);
        Some(total)
    }

    /// Returns the error of the groups nearest to each other, if they are partners.
    fn next_error(&mut self, situation: &Situation<'_>) -> Option<f64> {
        let mut nearest: Option<(f64, usize, usize)> = None;
        let expected = self.expected;
        for (slave_place, slave) in self.slave.groups().iter().enumerate() {
            for (master_place, master) in self.master.groups().iter().enumerate() {
                let error = self.error(master.place, slave.place, situation);
                if nearest.is_none_or(|(least, ..)| (error - expected).abs() < (least - expected).abs()) {
                    nearest = Some((error, master_place, slave_place));
                }
            }
        }
        let (error, master, slave) = nearest?;
        let period = self.period(&situation.asked);
        // If the distance exceeds half a period, the partner of one of them has not come yet; if both sides have two
        // groups, the marks have really slipped.
        let waits = self.slave.groups().len() < 2 || self.master.groups().len() < 2;
        if waits && period > 0.0 && (error - expected).abs() > period / 2.0 {
            return None;
        }
        self.master.forget(master);
        self.slave.forget(slave);
        Some(error)
    }
}

/// Returns the parameters for checking marks of a side.
fn check_parameters(of: MarkSide, asked: &LawInputs<'_>) -> Judged {
    let LawInputs { sync, marks, .. } = *asked;
    match of {
        MarkSide::Master => {
            Judged { distance: sync.mark_distance, window: marks.master_window, group: marks.per_master }
        }
        MarkSide::Slave => {
            Judged { distance: marks.slave_distance, window: marks.slave_window, group: marks.per_slave }
        }
    }
}

#[cfg(test)]
mod tests;
