//! Judging a cycle: following error, arrival, and what an error does to the axis.

use super::power::Power;
use super::{Axis, AxisState, Context, Generator, MAX_DELAY};
use crate::code::Code;
use crate::event::Number;
use crate::position::Position;
use crate::profile::Motion;
use serde::{Deserialize, Serialize};

/// Longest ring of command positions.
const PAST: usize = MAX_DELAY as usize + 1;

/// What an axis remembers to judge itself.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Judge {
    /// Command positions of the last cycles, in a ring.
    #[serde(with = "past")]
    past: [i64; PAST],
    /// Length of the ring: one per cycle of the drive's delay and one more.
    length: usize,
    place: usize,
    /// Command that the actual position of this cycle answers, minus that actual position (inc).
    pub following_error: i64,
    exceeded_since: Option<u64>,
    inside_since: Option<u64>,
    /// At rest at the target, within the window for long enough.
    pub in_position: bool,
    /// Error reaction that waits for the end of a stop; below 0 for none.
    pub after_stop: i64,
    /// Where the last goal rested, before rounding to whole increments.
    pub rested_at: Option<Position>,
}

impl Judge {
    pub(super) fn new(delay: u32) -> Self {
        Self {
            past: [0; PAST],
            length: delay as usize + 1,
            place: 0,
            following_error: 0,
            exceeded_since: None,
            inside_since: None,
            in_position: false,
            after_stop: -1,
            rested_at: None,
        }
    }

    /// Is its ring as long as another one's?
    pub(super) fn has_ring_of(&self, other: &Self) -> bool {
        self.length == other.length
    }

    /// Forgets the past: the axis has been standing at `position`.
    pub(super) fn fill(&mut self, position: i64) {
        self.past.fill(position);
        self.exceeded_since = None;
        self.rested_at = None;
    }

    pub(super) fn forget(&mut self) {
        self.exceeded_since = None;
        self.after_stop = -1;
    }

    /// Keeps the command of this cycle and gives the one that the actual position answers.
    fn exchange(&mut self, command: i64) -> i64 {
        self.place = if self.place + 1 < self.length { self.place + 1 } else { 0 };
        self.past.get_mut(self.place).map_or(command, |past| std::mem::replace(past, command))
    }
}

impl Axis {
    pub(super) fn judge(&mut self, cx: &mut Context<'_>) {
        let answered = self.judge.exchange(self.asked());
        if !self.is_on() {
            self.judge.following_error = 0;
            self.judge.inside_since = None;
            self.judge.in_position = false;
            return;
        }
        if self.is_open_loop() {
            self.judge.following_error = 0;
        } else if !self.is_virtual() {
            self.judge_following(cx, answered);
        }
        if !self.is_on() {
            return;
        }
        if self.rests() {
            self.judge_rest(cx);
        } else {
            self.judge.inside_since = None;
            self.judge.in_position = false;
        }
    }

    fn judge_following(&mut self, cx: &mut Context<'_>, answered: i64) {
        let error = answered.saturating_sub(self.actual.position.floor());
        self.judge.following_error = error;
        if error.unsigned_abs() <= self.parameters.max_following_error.unsigned_abs() {
            self.judge.exceeded_since = None;
            return;
        }
        let since = *self.judge.exceeded_since.get_or_insert(cx.cycle);
        let time = cx.cycle.saturating_sub(since).saturating_mul(self.setup.cycle_ns);
        let tolerated = self.parameters.following_error_time.unsigned_abs();
        if (tolerated == 0 || time > tolerated) && self.error.is_none() {
            let allowed = Number::Position(self.parameters.max_following_error);
            self.react(cx, Code::FOLLOWING_ERROR, Number::Position(error), allowed);
        }
    }

    /// The generator has nothing more to do: the goal is reached, or what ended it is done.
    fn judge_rest(&mut self, cx: &mut Context<'_>) {
        self.finish_stop();
        self.judge.in_position = self.is_in_window(cx);
        let is_moving_state = matches!(self.state, AxisState::DiscreteMotion | AxisState::ContinuousMotion);
        // A trajectory ends for all of its axes at once.
        if !is_moving_state || self.power != Power::On || self.tracker().is_some() {
            return;
        }
        let missed = self.searches();
        let ending = if missed { Some(Code::PROBE_MISSED) } else { self.goal.and_then(|goal| goal.ending) };
        let reached = self.judge.in_position || self.goal.is_none() || (ending.is_some() && !missed);
        if reached {
            if ending.is_none() {
                self.judge.rested_at = self.goal.and_then(|goal| goal.target);
            }
            self.end_goal(cx, ending.unwrap_or(Code::NONE));
            if missed {
                self.buffer.end(cx.events, self.setup.index, Code::NOT_REACHED, self.command.position);
            }
            if self.buffer.is_empty() {
                self.set_state(cx, AxisState::Standstill);
            } else {
                let before = self.judge.rested_at;
                self.begin_next(cx, self.command, 0.0, before);
            }
        }
    }

    /// MACS-TGT-01: without a window the command is enough. MACS-TGT-04: with a time, longer than that within it.
    fn is_in_window(&mut self, cx: &Context<'_>) -> bool {
        let window = self.parameters.in_position_window;
        if window > 0 && !self.is_virtual() {
            let distance = self.asked().saturating_sub(self.actual.position.floor());
            if distance.unsigned_abs() > window.unsigned_abs() {
                self.judge.inside_since = None;
                return false;
            }
        }
        let since = *self.judge.inside_since.get_or_insert(cx.cycle);
        let time = self.parameters.in_position_time.unsigned_abs();
        window == 0 || time == 0 || cx.cycle.saturating_sub(since).saturating_mul(self.setup.cycle_ns) > time
    }

    /// The error reaction (ERRCOND, MACS-ERR-02) to an error that leaves the drive in operation.
    pub(super) fn react(&mut self, cx: &mut Context<'_>, code: Code, found: Number, allowed: Number) {
        let reaction = self.parameters.error_reaction;
        if reaction == 5 && !matches!(self.generator, Generator::Follow(_)) {
            // Only told: the motion goes on, supervised as before.
            return self.report(cx, code, found, allowed);
        }
        self.raise(cx, code, found, allowed);
        match reaction {
            0 | 1 if !self.is_virtual() => {
                self.power = Power::Off;
                self.brake = reaction == 1;
                self.stand_on_actual();
            }
            // While it is being switched off it only stops, and then is.
            4 if !self.is_virtual() && self.power == Power::On => {
                self.power = Power::DriveStops;
                self.stand_on_actual();
            }
            _ => {
                self.brake_to_rest(cx, &self.stop_limits());
                self.judge.after_stop = reaction;
            }
        }
        self.set_state(cx, AxisState::ErrorStop);
    }

    fn stand_on_actual(&mut self) {
        self.generator = Generator::Rest;
        self.command = Motion::at_rest(self.actual.position);
    }

    /// What an error reaction leaves to do once the axis stands.
    fn finish_stop(&mut self) {
        let reaction = std::mem::replace(&mut self.judge.after_stop, -1);
        let has_drive = !self.is_virtual();
        match reaction {
            0 | 1 if has_drive => {
                self.power = Power::Off;
                self.brake = reaction == 1;
            }
            3 => self.brake = true,
            4 if has_drive && self.power == Power::On => self.power = Power::DriveStops,
            _ => {}
        }
    }
}

/// A ring of any length as a list: the derived form ends at 32.
mod past {
    use super::PAST;
    use serde::de::Error;
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    pub(super) fn serialize<S: Serializer>(past: &[i64; PAST], serializer: S) -> Result<S::Ok, S::Error> {
        past.as_slice().serialize(serializer)
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<[i64; PAST], D::Error> {
        let past = Vec::deserialize(deserializer)?;
        <[i64; PAST]>::try_from(past).map_err(|past| D::Error::invalid_length(past.len(), &"a whole ring"))
    }
}
