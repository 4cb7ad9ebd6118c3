//! Function interpolators: tables that are run through by the way of a master, or by time.
//!
//! Law      x runs through a table, y(x) is added to what the tables before gave, scaled by K / 2^n and rounded once: a master that goes back
//!          retraces exactly. Where a table ends the next one of the movement begins, with what x is beyond the end
//! Reads    the way of the source, or the time of the calls; E1 starts and stops; up to eight tables
//! Writes   the sink; A1 = 1 at rest, in modes that E1 starts
//! Source   AMK-FIPW, AMK-SYNC, AMK-FIPZ, AMK-XFIPW; A-21 to -31 of part A, A-04 to -23 of part C

mod check;
pub(super) mod fipw;
pub(super) mod fipz;
mod movement;
mod register;
mod setup;
pub(super) mod xfipw;

use super::program::{LINES, Outcome, Seen};
use super::sak::Sak;
use crate::cam::{Curve, Total};
use movement::Sets;
use register::{Marks, Register};
use serde::{Deserialize, Serialize};
use setup::{Movement, Setup};

/// Numbers of the modes of fipw, ascending; each of xfipw has one more, which `switches_sets`.
pub(super) fn modes(switches_sets: bool) -> Vec<i64> {
    let more = i64::from(switches_sets);
    let mut modes: Vec<i64> = fipw::MODES.iter().flat_map(|row| row.0..=row.0 + more).collect();
    modes.sort_unstable();
    modes
}

/// Where an interpolator is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
enum Stage {
    /// It waits for the zero pulse of its master.
    Sync,
    /// Clocked out: x runs on, the sink stands.
    #[default]
    Out,
    /// A movement runs.
    Run,
}

/// The movement of an interpolator.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct Interpolator {
    setup: Setup,
    stage: Stage,
    /// In the present table; below 0 before the first one of a movement.
    x: i64,
    /// The master's way at the last call.
    travel: i64,
    total: Total,
    /// What the sink has where the total is 0.
    origin: i64,
    /// In its set.
    table: u8,
    /// Passes of the working table in this movement.
    passes: i64,
    /// Where the last point was found.
    near: u32,
    /// Inputs of the last call.
    before: u8,
    /// E1 rose since START.
    knows_edge: bool,
    /// A start waits for its place.
    is_armed: bool,
    /// E1 rose in a movement, and counts at its end.
    is_stored: bool,
    sets: Sets,
    register: Register,
    sak: Sak,
}

impl Interpolator {
    /// The first call: the sink stands where it is.
    fn start(&mut self, setup: Setup, seen: &Seen<'_>) -> Outcome {
        *self = Self { setup, travel: seen.source.travel, origin: seen.sink, before: seen.inputs, ..Self::default() };
        self.sets.look(&self.setup, seen);
        if setup.movement == Movement::Cyclic {
            // At START a set counts that is selected there.
            self.sets.switch();
        }
        if setup.waits_for_zero {
            self.stage = Stage::Sync;
        } else {
            self.set_on(seen);
        }
        let sink = seen.sink;
        self.sak = Sak::new(setup.sak, sink);
        Outcome { sink, ..self.told() }
    }

    /// x becomes what the set says. A cycle that begins here does so without a step.
    fn set_on(&mut self, seen: &Seen<'_>) {
        let (stands, length) = (self.position(seen), self.curve(seen).length());
        self.x = self.setup.offset.rem_euclid(length);
        self.stage = Stage::Out;
        let starts = self.setup.movement == Movement::Cyclic;
        if starts && (self.setup.sets_on || self.x <= self.setup.start_angle) {
            self.begin();
        }
        if starts && self.setup.sets_on {
            self.origin = self.origin.wrapping_add(stands.wrapping_sub(self.position(seen)));
        }
    }

    /// Each further call.
    #[inline]
    fn step(&mut self, seen: &Seen<'_>) -> Outcome {
        let way = match self.setup.step {
            Some(step) => step,
            None => seen.source.travel.wrapping_sub(self.travel),
        };
        self.travel = seen.source.travel;
        self.sets.look(&self.setup, seen);
        let e1 = self.setup.is_started_by_e1() && seen.inputs & 1 == 1;
        let rises = e1 && self.before & 1 == 0;
        self.before = seen.inputs;
        self.knows_edge |= rises;
        match self.stage {
            Stage::Sync => self.look_for_zero((e1, rises), seen),
            Stage::Out => {
                self.run_out(way, (e1, rises), seen);
                self.find_mark_behind(seen);
            }
            Stage::Run => {
                self.is_stored |= rises && self.setup.retriggers;
                self.x = self.x.saturating_add(way);
                let is_done = self.find_mark(seen);
                self.pass_ends(e1, seen);
                self.pass_back(seen);
                if !is_done {
                    self.find_mark_behind(seen);
                }
                self.clock_out(way, e1, seen);
            }
        }
        let (y, correction) = (self.position(seen), self.correction(seen));
        let before = if self.setup.marks.before_sak { correction } else { 0 };
        let share = self.sak.share(y.wrapping_add(before));
        let sink = y.wrapping_add(share).wrapping_add(correction);
        Outcome { sink, sak_share: share, correction, deviation: self.register.deviation(), ..self.told() }
    }

    /// A mark in the pass of the working table that ran up to this call, or in the one before; true where it needs no further look.
    #[inline]
    fn find_mark(&mut self, seen: &Seen<'_>) -> bool {
        let (true, Some(mark)) = (self.setup.marks.is_on(), seen.source.mark) else { return true };
        if self.table != self.setup.working {
            return false;
        }
        let (x, curve) = (self.x.saturating_sub(self.travel.wrapping_sub(mark)), self.curve(seen));
        if x >= 0 || self.passes > 0 || self.setup.movement == Movement::Cyclic {
            self.register.mark(&self.setup.marks, &curve, x, self.setup.scale);
        }
        x < curve.length()
    }

    /// A mark in the pass that began in this call.
    #[inline]
    fn find_mark_behind(&mut self, seen: &Seen<'_>) {
        if self.setup.marks.is_on()
            && let Some(mark) = seen.source.mark
            && self.works()
        {
            let x = self.x.saturating_sub(self.travel.wrapping_sub(mark));
            if x >= 0 {
                self.register.mark(&self.setup.marks, &self.curve(seen), x, self.setup.scale);
            }
        }
    }

    /// What printing mark control adds.
    #[inline]
    fn correction(&mut self, seen: &Seen<'_>) -> i64 {
        if !self.setup.marks.is_on() || !self.works() {
            return self.register.done();
        }
        let length = self.curve(seen).length();
        self.register.at(&self.setup.marks, self.x, length)
    }

    /// Does the working table run?
    #[inline]
    fn works(&self) -> bool {
        self.stage == Stage::Run && self.table == self.setup.working && self.x >= 0
    }

    /// Other marks, taken while it runs.
    fn renew(&mut self, marks: Marks) {
        self.setup.marks = marks;
    }

    /// The zero pulse of the master makes x what the set says, at the place of the pulse: what may begin there does so there.
    fn look_for_zero(&mut self, (e1, rises): (bool, bool), seen: &Seen<'_>) {
        let Some(mark) = seen.source.mark else { return };
        self.set_on(seen);
        let since = self.travel.wrapping_sub(mark);
        if matches!(self.setup.movement, Movement::Sequence | Movement::Coupled) {
            self.clock_in((e1, rises), self.x <= self.setup.start_angle);
        }
        if self.stage == Stage::Run {
            self.x = self.x.saturating_add(since);
            self.pass_ends(e1, seen);
            self.pass_back(seen);
        } else {
            self.run_out(since, (e1, rises), seen);
        }
    }

    /// Is x behind its zero by `angle` at most, the master not on its way back?
    fn is_in(&self, way: i64, angle: i64) -> bool {
        way >= 0 && (0..=angle).contains(&self.x)
    }

    /// The table that runs, or that comes next.
    #[inline]
    fn curve<'a>(&self, seen: &Seen<'a>) -> Curve<'a> {
        let place = self.sets.first(&self.setup) + usize::from(self.table);
        Curve::new(seen.tables.get(place), self.setup.length, self.setup.parts)
    }

    /// Where its sink belongs, without compensation.
    #[inline]
    fn position(&mut self, seen: &Seen<'_>) -> i64 {
        let total = if self.stage == Stage::Run && self.x >= 0 {
            let curve = self.curve(seen);
            self.total.at(curve.at(self.x, &mut self.near), self.setup.scale)
        } else {
            self.total.at_end()
        };
        self.origin.wrapping_add(total)
    }

    /// Its outputs.
    fn told(&self) -> Outcome {
        let rests = self.setup.is_started_by_e1();
        let (at_rest, selected) = (u8::from(self.stage != Stage::Run), u8::from(self.sets.is_taken()));
        let marked = u8::from(self.register.was_marked());
        let second = match self.setup {
            Setup { switches_sets: true, .. } => Some(selected),
            Setup { tells_marks: true, .. } => Some(marked),
            _ => None,
        };
        let (outputs, writes) = match (rests, second) {
            (true, None) => (at_rest, 0b01),
            (true, Some(second)) => (at_rest | second << 1, 0b11),
            (false, Some(second)) => (second, 0b01),
            (false, None) => (0, 0),
        };
        Outcome { outputs, writes, ..Outcome::default() }
    }

    /// What its outputs are after RESET.
    pub(super) fn rests(&self) -> u8 {
        u8::from(self.setup.is_started_by_e1())
    }

    /// Does it run by that set?
    fn is_set(&self, setup: &Setup) -> bool {
        self.setup == *setup
    }

    pub(super) fn is_sound(&self) -> bool {
        self.total.is_sound() && usize::from(self.table) < LINES && self.sets.is_sound()
    }
}

/// The scaled value of one table at `x`, its rounds counted.
fn value_at(curve: &Curve<'_>, x: i64, setup: &Setup) -> i64 {
    let (rounds, rest) = (x.div_euclid(curve.length()), x.rem_euclid(curve.length()));
    let mut total = Total::default();
    total.pass(curve.end(), rounds, setup.scale);
    total.at(curve.at(rest, &mut 0), setup.scale)
}

#[cfg(test)]
mod tests;
