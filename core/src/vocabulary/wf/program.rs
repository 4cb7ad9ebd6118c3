//! Blocks: loading them, START, and the calculation of their ends.

use super::request::{Blocks, FULL_SPEED, MOST_BCD, Mode, Speed};
use super::{RefusalReason, State, Wf, is_open, offsets};
use crate::code::Code;
use crate::event::Number;
use crate::modulo::Direction;
use crate::position::Position;
use crate::vocabulary::{Order, View};

/// Minimum velocity of a block (inc/s), so that it ends in reasonable time.
const LEAST_VELOCITY: f64 = 1e-6;

impl Wf {
    /// Loads a program; the next START begins with its first block.
    pub(super) fn load(&mut self, blocks: &Blocks, view: &View<'_>) -> Result<(), RefusalReason> {
        if blocks.count() == 0 {
            return Err(RefusalReason::new(Code::WF_NO_BLOCKS));
        }
        self.program = *blocks;
        self.next = 0;
        self.check_program(view)
    }

    /// Checks the blocks for this mode.
    fn check_program(&self, view: &View<'_>) -> Result<(), RefusalReason> {
        let count = self.program.count();
        if self.mode == Mode::Mdi && count > 1 {
            return Err(RefusalReason::new(Code::WF_ONE_BLOCK).with(Number::Count(count.into()), Number::Count(1)));
        }
        for block in self.program.as_slice() {
            if !block.position.is_legal() {
                let position = Number::Position(block.position.nearest());
                return Err(RefusalReason::new(Code::POSITION_OUT_OF_RANGE).with(position, Number::None));
            }
            check_speed(block.speed, view)?;
        }
        Ok(())
    }

    /// START: fixes the ends of all blocks that it runs, then begins the first one.
    pub(super) fn start(&mut self, view: &View<'_>) -> Result<Order, RefusalReason> {
        if matches!(self.mode, Mode::Jog | Mode::ActualValue | Mode::Reference) {
            return Err(RefusalReason::new(Code::WF_NOT_IN_THIS_MODE));
        }
        self.check_enable()?;
        if self.is_in_motion(view) {
            return Err(RefusalReason::new(Code::WF_IN_MOTION));
        }
        let count = self.program.count();
        if count == 0 {
            return Err(RefusalReason::new(Code::WF_NO_BLOCKS));
        }
        self.check_program(view)?;
        let mut from = self.distance_base(view);
        self.active = if self.next < count { self.next } else { 0 };
        self.end = if self.mode == Mode::Continuous { count } else { self.active + 1 };
        self.next = match self.mode {
            Mode::Automatic if self.active + 1 < count => self.active + 1,
            Mode::Automatic | Mode::Continuous => 0,
            _ => self.active,
        };
        for place in self.active..self.end {
            from = self.find_end(place, from, view)?;
            if let Some(end) = self.ends.get_mut(usize::from(place)) {
                *end = from;
            }
        }
        Ok(self.begin(view))
    }

    /// Begins the active block from rest.
    pub(super) fn begin(&mut self, view: &View<'_>) -> Order {
        self.started = view.cycle;
        self.speed_valid = false;
        self.considered = false;
        self.ending = false;
        if is_open(view) { self.begin_open(view) } else { self.begin_closed(view) }
    }

    /// Checks the conditions of the vocabulary for START, JOG+ and JOG- (WF-IF-04).
    pub(super) fn check_enable(&self) -> Result<(), RefusalReason> {
        if self.alarm != 0 {
            let number = Number::Count(self.alarm.into());
            return Err(RefusalReason::new(Code::WF_ALARM_WAITS).with(number, Number::None));
        }
        if self.request_withdrawn {
            return Err(RefusalReason::new(Code::WF_NO_REQUEST));
        }
        Ok(())
    }

    /// Returns the base of a distance (inc): the previous end if the axis is still there, otherwise its present
    /// position.
    pub(super) fn distance_base(&self, view: &View<'_>) -> Position {
        if is_open(view) {
            return if self.state == State::Done { self.set } else { view.actual.position };
        }
        let command = view.command.position;
        if Position::whole(self.set.nearest()) == command { self.set } else { command }
    }

    fn find_end(&self, place: u8, from: Position, view: &View<'_>) -> Result<Position, RefusalReason> {
        let block = self.program.get(place).copied().unwrap_or_default();
        // WK and NV apply to absolute blocks only (WF-CRD-02, W16).
        let end = if block.absolute { block.position + offsets(view) + self.preset } else { from + block.position };
        let end = match view.modulo {
            // WF-ROT-03: the JOG inputs select the direction of approach. Beyond 2^62 there is no turn to be counted.
            Some(modulo) if block.absolute && end.is_legal() => {
                let direction = match self.jog.direction() {
                    1 => Direction::Positive,
                    -1 => Direction::Negative,
                    _ => Direction::Shortest,
                };
                modulo.target(end, from, from, direction, 0.0)
            }
            _ => end,
        };
        let (whole, p) = (end.nearest(), view.parameters);
        let refuse = |code, limit| Err(RefusalReason::new(code).with(Number::Position(whole), limit));
        if !end.is_legal() {
            return refuse(Code::POSITION_OUT_OF_RANGE, Number::None);
        }
        if let Some(high) = p.max_position.filter(|high| whole > *high) {
            return refuse(Code::ABOVE_MAX_POSITION, Number::Position(high));
        }
        if let Some(low) = p.min_position.filter(|low| whole < *low) {
            return refuse(Code::BELOW_MIN_POSITION, Number::Position(low));
        }
        Ok(end)
    }

    /// Returns the speed value of a block: a whole number in open loop.
    pub(super) fn value_of(&self, place: u8, view: &View<'_>) -> f64 {
        let speed = self.program.get(place).map_or(Speed::default(), |block| block.speed);
        let value = speed.value(view.parameters.max_velocity);
        if is_open(view) { value.round().clamp(0.0, MOST_BCD) } else { value.clamp(0.0, FULL_SPEED) }
    }
}

/// Returns the speed value of a speed.
pub(super) fn check_speed(speed: Speed, view: &View<'_>) -> Result<f64, RefusalReason> {
    let max_velocity = view.parameters.max_velocity;
    let (value, velocity) = (speed.value(max_velocity), speed.velocity(max_velocity));
    // NaN fails each of the comparisons.
    if let (Speed::Velocity(asked), false) = (speed, velocity <= max_velocity) {
        let numbers = (Number::Velocity(asked), Number::Velocity(max_velocity));
        return Err(RefusalReason::new(Code::VELOCITY_TOO_HIGH).with(numbers.0, numbers.1));
    }
    let open = is_open(view);
    let most = if open { MOST_BCD } else { FULL_SPEED };
    let put_out = if open { value.round() } else { value };
    if !(put_out > 0.0 && put_out <= most) {
        return Err(RefusalReason::new(Code::WF_BAD_SPEED).with(Number::Real(value), Number::Real(most)));
    }
    if velocity < LEAST_VELOCITY {
        let numbers = (Number::Velocity(velocity), Number::Velocity(LEAST_VELOCITY));
        return Err(RefusalReason::new(Code::RATE_TOO_LOW).with(numbers.0, numbers.1));
    }
    Ok(put_out)
}
