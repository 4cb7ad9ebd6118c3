//! Function interpolators: tables over the travel of a master, or over time.
//!
//! Law      x runs through a table; y(x) is added to the sum of the previous tables, scaled by K / 2^n and rounded
//!          once: a master that moves back retraces its path exactly. At the end of a table the next one of the
//!          movement begins, at the distance of x beyond the end
//! Reads    the travel of the source, or the time of the calls; E1 starts and stops; up to eight tables
//! Writes   the sink; A1 = 1 at rest, in modes that E1 starts
//! Source   AMK-FIPW, AMK-SYNC, AMK-FIPZ, AMK-XFIPW; A-21 to -31 of part A, A-04 to -23 of part C

mod check;
pub(super) mod fipw;
pub(super) mod fipz;
mod movement;
mod register;
mod setup;
pub(super) mod xfipw;

use crate::cam::{Curve, Total};
use crate::function::program::{CallInputs, LINES, Outcome};
use crate::function::sak::Sak;
use movement::Sets;
use register::{MarkControl, Marks};
use serde::{Deserialize, Serialize};
use setup::{Movement, Setup};

/// Returns the modes of fipw in ascending order; with `switches_sets` those of xfipw, which are one larger.
pub(super) fn modes(switches_sets: bool) -> Vec<i64> {
    let more = i64::from(switches_sets);
    let mut modes: Vec<i64> = fipw::MODES.iter().flat_map(|row| row.0..=row.0 + more).collect();
    modes.sort_unstable();
    modes
}

/// State of an interpolator.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
enum MovementState {
    /// Waiting for the zero pulse of its master.
    Sync,
    /// Clocked out: x continues, the sink rests.
    #[default]
    Out,
    /// A movement runs.
    Run,
}

/// State of an interpolator, without its parameter set.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct Interpolator {
    setup: Setup,
    stage: MovementState,
    /// Position in the present table; below 0 before the first table of a movement.
    x: i64,
    /// Travel of the master at the last call.
    travel: i64,
    total: Total,
    /// Value of the sink for a total of 0.
    origin: i64,
    /// Index of the table in its set.
    table: u8,
    /// Passes of the working table in this movement.
    passes: i64,
    /// Index at which the last point was found.
    last_point: u32,
    /// Inputs of the last call.
    last_inputs: u8,
    /// Whether E1 has risen since START.
    had_edge: bool,
    /// Whether a start waits for its position.
    is_armed: bool,
    /// Whether E1 rose in a movement, and takes effect at its end.
    is_stored: bool,
    sets: Sets,
    register: MarkControl,
    sak: Sak,
}

impl Interpolator {
    /// Executes the first call: the sink keeps its value.
    fn start(&mut self, setup: Setup, seen: &CallInputs<'_>) -> Outcome {
        *self =
            Self { setup, travel: seen.source.travel, origin: seen.sink, last_inputs: seen.inputs, ..Self::default() };
        self.sets.read_inputs(&self.setup, seen);
        if setup.movement == Movement::Cyclic {
            // The set that is selected at START is active at once.
            self.sets.switch();
        }
        if setup.waits_for_zero {
            self.stage = MovementState::Sync;
        } else {
            self.set_start_position(seen);
        }
        let sink = seen.sink;
        self.sak = Sak::new(setup.sak, sink);
        Outcome { sink, ..self.outputs_of() }
    }

    /// Sets x to the value of the parameter set. A cycle that begins here does so without a step of the sink.
    fn set_start_position(&mut self, seen: &CallInputs<'_>) {
        let (stands, length) = (self.position(seen), self.curve(seen).length());
        self.x = self.setup.offset.rem_euclid(length);
        self.stage = MovementState::Out;
        let starts = self.setup.movement == Movement::Cyclic;
        if starts && (self.setup.sets_on || self.x <= self.setup.start_angle) {
            self.begin();
        }
        if starts && self.setup.sets_on {
            self.origin = self.origin.wrapping_add(stands.wrapping_sub(self.position(seen)));
        }
    }

    /// Executes each further call.
    #[inline]
    fn step(&mut self, seen: &CallInputs<'_>) -> Outcome {
        let way = match self.setup.step {
            Some(step) => step,
            None => seen.source.travel.wrapping_sub(self.travel),
        };
        self.travel = seen.source.travel;
        self.sets.read_inputs(&self.setup, seen);
        let e1 = self.setup.is_started_by_e1() && seen.inputs & 1 == 1;
        let rises = e1 && self.last_inputs & 1 == 0;
        self.last_inputs = seen.inputs;
        self.had_edge |= rises;
        match self.stage {
            MovementState::Sync => self.look_for_zero((e1, rises), seen),
            MovementState::Out => {
                self.advance_at_rest(way, (e1, rises), seen);
                self.find_mark_of_new_pass(seen);
            }
            MovementState::Run => {
                self.is_stored |= rises && self.setup.retriggers;
                self.x = self.x.saturating_add(way);
                let is_done = self.find_mark(seen);
                self.pass_ends(e1, seen);
                self.return_to_previous(seen);
                if !is_done {
                    self.find_mark_of_new_pass(seen);
                }
                self.clock_out(way, e1, seen);
            }
        }
        let (y, correction) = (self.position(seen), self.correction(seen));
        let before = if self.setup.marks.before_sak { correction } else { 0 };
        let share = self.sak.share(y.wrapping_add(before));
        let sink = y.wrapping_add(share).wrapping_add(correction);
        Outcome { sink, sak_share: share, correction, deviation: self.register.deviation(), ..self.outputs_of() }
    }

    /// Looks for a mark in the pass of the working table that ran up to this call, or in the previous one. Returns true
    /// if the new pass need not be searched.
    #[inline]
    fn find_mark(&mut self, seen: &CallInputs<'_>) -> bool {
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

    /// Looks for a mark in the pass that began in this call.
    #[inline]
    fn find_mark_of_new_pass(&mut self, seen: &CallInputs<'_>) {
        if self.setup.marks.is_on()
            && let Some(mark) = seen.source.mark
            && self.runs_working_table()
        {
            let x = self.x.saturating_sub(self.travel.wrapping_sub(mark));
            if x >= 0 {
                self.register.mark(&self.setup.marks, &self.curve(seen), x, self.setup.scale);
            }
        }
    }

    /// Returns the correction of printing mark control.
    #[inline]
    fn correction(&mut self, seen: &CallInputs<'_>) -> i64 {
        if !self.setup.marks.is_on() || !self.runs_working_table() {
            return self.register.applied();
        }
        let length = self.curve(seen).length();
        self.register.at(&self.setup.marks, self.x, length)
    }

    /// Returns true if the working table runs.
    #[inline]
    fn runs_working_table(&self) -> bool {
        self.stage == MovementState::Run && self.table == self.setup.working && self.x >= 0
    }

    /// Changes the settings of printing mark control while it runs.
    fn renew(&mut self, marks: Marks) {
        self.setup.marks = marks;
    }

    /// Sets x at the position of the zero pulse of the master; a movement that may begin there does so.
    fn look_for_zero(&mut self, (e1, rises): (bool, bool), seen: &CallInputs<'_>) {
        let Some(mark) = seen.source.mark else { return };
        self.set_start_position(seen);
        let since = self.travel.wrapping_sub(mark);
        if matches!(self.setup.movement, Movement::Sequence | Movement::Coupled) {
            self.clock_in((e1, rises), self.x <= self.setup.start_angle);
        }
        if self.stage == MovementState::Run {
            self.x = self.x.saturating_add(since);
            self.pass_ends(e1, seen);
            self.return_to_previous(seen);
        } else {
            self.advance_at_rest(since, (e1, rises), seen);
        }
    }

    /// Returns true if x is at most `angle` after its zero and the master does not move back.
    fn is_in_window(&self, way: i64, angle: i64) -> bool {
        way >= 0 && (0..=angle).contains(&self.x)
    }

    /// Returns the table that runs, or the next one.
    #[inline]
    fn curve<'a>(&self, seen: &CallInputs<'a>) -> Curve<'a> {
        let place = self.sets.first(&self.setup) + usize::from(self.table);
        Curve::new(seen.tables.get(place), self.setup.length, self.setup.parts)
    }

    /// Returns the position of the sink, without compensation.
    #[inline]
    fn position(&mut self, seen: &CallInputs<'_>) -> i64 {
        let total = if self.stage == MovementState::Run && self.x >= 0 {
            let curve = self.curve(seen);
            self.total.at(curve.at(self.x, &mut self.last_point), self.setup.scale)
        } else {
            self.total.at_end()
        };
        self.origin.wrapping_add(total)
    }

    /// Returns the outputs.
    fn outputs_of(&self) -> Outcome {
        let rests = self.setup.is_started_by_e1();
        let (at_rest, selected) = (u8::from(self.stage != MovementState::Run), u8::from(self.sets.is_taken()));
        let marked = u8::from(self.register.was_marked());
        let second = match self.setup {
            Setup { switches_sets: true, .. } => Some(selected),
            Setup { shows_marks: true, .. } => Some(marked),
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

    /// Returns the outputs after RESET.
    pub(super) fn rests(&self) -> u8 {
        u8::from(self.setup.is_started_by_e1())
    }

    /// Returns true if the function runs with that set.
    fn is_set(&self, setup: &Setup) -> bool {
        self.setup == *setup
    }

    pub(super) fn is_sound(&self) -> bool {
        self.total.is_sound() && usize::from(self.table) < LINES && self.sets.is_sound()
    }
}

/// Returns the scaled value of one table at `x`, including whole passes.
fn value_at(curve: &Curve<'_>, x: i64, setup: &Setup) -> i64 {
    let (rounds, rest) = (x.div_euclid(curve.length()), x.rem_euclid(curve.length()));
    let mut total = Total::default();
    total.pass(curve.end(), rounds, setup.scale);
    total.at(curve.at(rest, &mut 0), setup.scale)
}

#[cfg(test)]
mod tests;
