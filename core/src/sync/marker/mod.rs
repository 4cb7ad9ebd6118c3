//! Marks of master and slave, brought together (SYNCM).
//!
//! Law      error of a pair = ratio * (way of the master since its mark + offset) - way of the slave since its mark; what was ordered before and is
//!          not done yet is not ordered again (MACS-MARK-13, A-39, A-40). Pairs are the groups that are nearest to each other by what is not
//!          corrected yet; which is the first one, and what of its error is corrected, says SYNCMSTART
//! Reads    both sides, what is under way, parameters
//! Writes   the correction that each pair asks for; how good the pairs are
//! Refuses  nothing
//! Source   MACS-MARK-01, -02, -12 to -14, -20, -21, A-33, A-39, A-40, A-42

mod law;
mod side;

pub use law::{Asked, Law};
pub use side::{Found, Group, Judged, Side};

use crate::parameter::Marks;
use crate::position::Position;
use serde::{Deserialize, Serialize};

/// SYNCMSTART of cams: one begins at its first mark. Whatever it is, their first pair is the nearest one.
pub const FROM_MARK: i64 = 2_000;

/// Whose marks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Of {
    /// Of what leads.
    Master,
    /// Of what follows.
    Slave,
}

/// How the first pair is found (SYNCMSTART without its thousands).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Start {
    /// The first mark of the slave behind the first one of the master.
    MasterFirst,
    /// The first mark of the master behind the first one of the slave.
    SlaveFirst,
    /// The first ones, at once or once the slave has its master's velocity.
    First {
        waits: bool,
    },
    /// The next one of the slave, and the one of the master that is in front, behind, or nearest.
    Forward,
    Backward,
    Nearest,
    /// None: the curve has brought them together.
    Smooth,
    /// Those that are nearest to each other, at once (cams).
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

    /// Does it wait for the velocity of the master?
    fn waits(self) -> bool {
        !matches!(self, Self::MasterFirst | Self::SlaveFirst | Self::First { waits: false } | Self::Cam)
    }

    /// Does nearness choose the mark of the master?
    fn goes_by_nearness(self) -> bool {
        matches!(self, Self::Forward | Self::Backward | Self::Nearest)
    }

    /// What of an error is corrected where marks come every `period` (inc of the slave), 0: nobody knows; `sense` is 1 or -1.
    fn reduce(self, error: f64, period: f64, sense: f64) -> f64 {
        if period <= 0.0 {
            return error;
        }
        // In the sense in which the slave runs.
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

/// What a pair was like.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair {
    /// How far the marks were from each other (inc of the slave); positive: the slave is behind.
    pub error: f64,
    /// What is corrected for it (inc of the slave).
    pub correction: f64,
}

/// What marks are brought together with.
#[derive(Clone, Copy, Debug)]
pub struct Situation<'p> {
    /// Of the law.
    pub asked: Asked<'p>,
    /// The offset that is in force (inc of the master).
    pub offset: f64,
    /// What was ordered and is not done yet (inc of the slave).
    pub under_way: f64,
    /// The slave has its master's velocity.
    pub runs: bool,
    /// 1 where the slave counts up with its master, -1 where it counts down.
    pub sense: f64,
}

/// A coupling by marks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Marker {
    master: Side,
    slave: Side,
    law: Law,
    /// The first pair was found.
    has_begun: bool,
    /// Pairs in a row that were accurate, and that were not.
    good: i64,
    bad: i64,
    last: Option<(f64, f64)>,
    /// The error that the next pair will have, if nothing new happens (inc of the slave).
    expected: f64,
}

impl Marker {
    /// Could it have come about?
    pub fn is_sound(&self) -> bool {
        let last = self.last.is_none_or(|(error, correction)| error.is_finite() && correction.is_finite());
        self.master.is_sound() && self.slave.is_sound() && self.law.is_sound() && last && self.expected.is_finite()
    }

    /// One side.
    pub fn side(&self, of: Of) -> &Side {
        match of {
            Of::Master => &self.master,
            Of::Slave => &self.slave,
        }
    }

    fn side_mut(&mut self, of: Of) -> &mut Side {
        match of {
            Of::Master => &mut self.master,
            Of::Slave => &mut self.slave,
        }
    }

    /// Its filters.
    pub fn law(&self) -> &Law {
        &self.law
    }

    /// Was the first pair found?
    pub fn has_begun(&self) -> bool {
        self.has_begun
    }

    /// Error and correction of the last pair (inc of the slave).
    pub fn last(&self) -> (f64, f64) {
        self.last.unwrap_or_default()
    }

    /// READY: so many accurate pairs have come in a row (MACS-MARK-20).
    pub fn is_ready(&self, marks: &Marks) -> bool {
        self.good > 0 && self.good >= marks.ready
    }

    /// FAULT: more inaccurate ones in a row than are tolerated (MACS-MARK-21).
    pub fn is_faulty(&self, marks: &Marks) -> bool {
        self.bad > marks.fault
    }

    /// Both sides move on.
    pub fn advance(&mut self, master: Position, slave: Position) {
        self.master.advance(master);
        self.slave.advance(slave);
    }

    /// A side has passed its last mark so far (inc of it).
    pub fn know(&mut self, of: Of, since: Position) {
        self.side_mut(of).know(since);
    }

    /// A mark of a side, so far (inc of it) before where it is now, and when it came.
    pub fn take(&mut self, of: Of, (before, instant_ns): (Position, u64), asked: &Asked<'_>) -> Found {
        let found = self.side_mut(of).take(before, instant_ns, &judged(of, asked));
        if let Found::Mark { distance: Some(distance) } = found {
            match of {
                Of::Master => self.law.take_master(distance, asked),
                Of::Slave => self.law.take_slave(distance, asked),
            }
        }
        found
    }

    /// So many marks of a side are extra.
    pub fn lose(&mut self, of: Of, count: u32) {
        self.side_mut(of).lose(count);
    }

    /// Looks whether a mark of a side has stayed away in this cycle; true where one has.
    pub fn look(&mut self, of: Of, asked: &Asked<'_>) -> bool {
        self.side_mut(of).look(&judged(of, asked))
    }

    /// How far a pair is apart (inc of the slave).
    fn error(&self, master: Position, slave: Position, situation: &Situation<'_>) -> f64 {
        let of_master = (self.master.way() - master).to_f64() + situation.offset;
        of_master * situation.asked.ratio - (self.slave.way() - slave).to_f64() - situation.under_way
    }

    /// From mark to mark of the groups of the master (inc of the slave); 0: nobody knows.
    fn period(&self, asked: &Asked<'_>) -> f64 {
        self.law.distance(asked) * asked.marks.per_master.max(1) as f64 * asked.ratio.abs()
    }

    /// The next pair that has come together, if one has, with an accuracy (inc of the slave) that it is held against.
    pub fn pair(&mut self, situation: &Situation<'_>, accuracy: i64) -> Option<Pair> {
        let error = if self.has_begun { self.next_error(situation) } else { self.first_error(situation) }?;
        let correction = self.law.correct(error, &situation.asked);
        self.expected = error - correction;
        // How far the marks are apart, whatever was ordered already.
        let error = error + situation.under_way;
        if error.abs() <= accuracy.unsigned_abs() as f64 {
            (self.good, self.bad) = (self.good.saturating_add(1), 0);
        } else {
            (self.good, self.bad) = (0, self.bad.saturating_add(1));
        }
        self.last = Some((error, correction));
        Some(Pair { error, correction })
    }

    /// The error of the first pair that SYNCMSTART takes, and that is corrected from there on.
    fn first_error(&mut self, situation: &Situation<'_>) -> Option<f64> {
        let start = Start::of(situation.asked.marks.start);
        if start.waits() && !situation.runs {
            // What came before says nothing.
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
            if start.goes_by_nearness() { self.master.groups().last() } else { self.master.groups().first() };
        let (master, slave) = (*of_master?, *self.slave.groups().first()?);
        // Which one has to come first; the other one's earlier marks are no partners.
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

    /// The error of the groups that are nearest to each other, if these are partners.
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
        // Beyond half of a period the partner of one of them has still to come; where both wait twice, it has slipped so far.
        let waits = self.slave.groups().len() < 2 || self.master.groups().len() < 2;
        if waits && period > 0.0 && (error - expected).abs() > period / 2.0 {
            return None;
        }
        self.master.forget(master);
        self.slave.forget(slave);
        Some(error)
    }
}

/// What marks of a side are judged by.
fn judged(of: Of, asked: &Asked<'_>) -> Judged {
    let Asked { sync, marks, .. } = *asked;
    match of {
        Of::Master => Judged { distance: sync.mark_distance, window: marks.master_window, group: marks.per_master },
        Of::Slave => Judged { distance: marks.slave_distance, window: marks.slave_window, group: marks.per_slave },
    }
}

#[cfg(test)]
mod tests;
