//! Shifting an axis against its leader in motion, by either side of its coupling (MC_PhasingRelative).
//!
//! Law      slave: a superimposed motion, which the coupling keeps. master: what leads is seen shifted, to 2^-32 inc, and gear or cam make of
//!          that what they make of any motion of it; the axis stays within its limits, and catches up what they hold back.
//!          A new shift takes the place of one that moves, from its velocity on, and what was left of that is left out. It ends
//!          with its coupling
//! Reads    the coupling
//! Refuses  an axis that is not coupled by position; of a gear what the axis has no velocity or acceleration left for
//! Source   contract section 10, PLCopen (MC_PhasingRelative)

use super::alarm::{NO_NUMBERS, Numbers};
use super::{Axis, Context};
use crate::code::Code;
use crate::command::{BufferMode, Move, MoveMode, PhaseShift};
use crate::event::{Event, Number, Refusal};
use crate::modulo::Direction;
use crate::position::Position;
use crate::sync::{Shift, SyncMode, Transmission};
use serde::{Deserialize, Serialize};

/// A shift of the master under way.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Phasing {
    /// Number of its command.
    pub sequence: u64,
    shift: Shift,
    ending: Option<Code>,
}

impl Phasing {
    pub(super) fn is_sound(&self) -> bool {
        self.shift.is_sound()
    }
}

impl Axis {
    /// Starts a shift of the side of the slave.
    ///
    /// # Errors
    /// Why not.
    pub fn shift_slave(&mut self, cx: &mut Context<'_>, sequence: u64, asked: &PhaseShift) -> Result<(), Refusal> {
        self.check_phase()?;
        let PhaseShift { shift, velocity, acceleration } = *asked;
        let request = Move {
            axis: self.setup.index,
            mode: MoveMode::Superimposed,
            target: shift,
            velocity,
            acceleration,
            deceleration: acceleration,
            jerk: 0.0,
            direction: Direction::Shortest,
            buffer_mode: BufferMode::Aborting,
        };
        // Its coupling keeps what is below an increment.
        self.start_superimposed(cx, sequence, &request, shift.exact())
    }

    /// Starts a shift of the side of the master.
    ///
    /// # Errors
    /// Why not.
    pub fn shift_master(&mut self, cx: &mut Context<'_>, sequence: u64, asked: &PhaseShift) -> Result<(), Refusal> {
        self.check_phase()?;
        let gear = self.coupling().and_then(|coupling| match coupling.follower.transmission() {
            Transmission::Gear(gear) => Some(gear.ratio().to_f64().abs()),
            Transmission::Cam(_) => None,
        });
        let p = &self.parameters;
        let most = (p.max_velocity - self.underlying().velocity.abs()).max(0.0);
        let velocity = self.rate_of_master(asked.velocity, gear, (p.usual_velocity(), most), Number::Velocity)?;
        let most = p.max_acceleration.min(p.deceleration_limit());
        let usual = p.usual_acceleration().min(p.usual_deceleration());
        let acceleration = self.rate_of_master(asked.acceleration, gear, (usual, most), Number::Acceleration)?;
        let whole = asked.shift.exact();
        if !whole.is_legal() {
            let number = Number::Position(whole.nearest());
            return Err(self.refuse(Code::POSITION_OUT_OF_RANGE).with(number, Number::None));
        }
        let before = self.phasing.map(|phasing| phasing.shift);
        let shift = Shift::new(whole, velocity, acceleration, self.cycle_s(), before.as_ref());
        self.end_phase(cx, Code::REPLACED, NO_NUMBERS);
        self.phasing = Some(Phasing { sequence, shift, ending: None });
        self.accepted(cx, sequence);
        Ok(())
    }

    /// A rate of the master. A gear says what the axis makes of it, and what its default is; the slope of a cam is another one everywhere.
    fn rate_of_master(
        &self,
        asked: f64,
        gear: Option<f64>,
        (usual, most): (f64, f64),
        number: fn(f64) -> Number,
    ) -> Result<f64, Refusal> {
        if !asked.is_finite() || asked < 0.0 {
            return Err(self.refuse(Code::BAD_NUMBER).with(number(asked), Number::None));
        }
        let Some(ratio) = gear else {
            let has_one = asked >= super::goal::LEAST_RATE;
            return has_one
                .then_some(asked)
                .ok_or_else(|| self.refuse(Code::PHASE_RATE).with(number(asked), Number::None));
        };
        let of_axis = if asked == 0.0 { usual.min(most) } else { asked * ratio };
        if of_axis > most || of_axis < super::goal::LEAST_RATE {
            return Err(self.refuse(Code::SUPERIMPOSED_TOO_MUCH).with(number(of_axis), number(most)));
        }
        Ok(if asked == 0.0 { of_axis / ratio } else { asked })
    }

    fn check_phase(&self) -> Result<(), Refusal> {
        self.check_closed_loop()?;
        self.check_free()?;
        let is_coupled = self.coupling().is_some_and(|coupling| coupling.follower.mode() == SyncMode::Position);
        is_coupled.then_some(()).ok_or_else(|| self.refuse(Code::PHASE_NO_COUPLING))
    }

    /// What the shift of the master adds to its change in this cycle, and the number of the command that ends with it.
    pub(super) fn phase_of_master(&mut self) -> (Position, Option<(u64, Code)>) {
        let Some(phasing) = &mut self.phasing else { return (Position::ZERO, None) };
        let (change, has_ended) = phasing.shift.step();
        let ended = has_ended.then(|| (phasing.sequence, phasing.ending.unwrap_or(Code::NONE)));
        if has_ended {
            self.phasing = None;
        }
        (change, ended)
    }

    /// Ends the shift of the master now.
    pub(super) fn end_phase(&mut self, cx: &mut Context<'_>, code: Code, numbers: Numbers) {
        if let Some(phasing) = self.phasing.take() {
            let code = phasing.ending.unwrap_or(code);
            let done = Event::done(self.object(), phasing.sequence, code, self.command.position);
            cx.events.push(done.with(numbers.0, numbers.1));
        }
    }

    /// Where its coupling is over, however that came, nothing is left to be shifted.
    pub(super) fn settle_phase(&mut self, cx: &mut Context<'_>) {
        if self.phasing.is_some() && self.coupling().is_none() {
            self.end_phase(cx, Code::NOT_REACHED, NO_NUMBERS);
        }
    }

    /// Is it the command of that number that shifts the master?
    pub(super) fn is_phase(&self, sequence: u64) -> bool {
        self.phasing.is_some_and(|phasing| phasing.sequence == sequence)
    }

    /// Slows the shift of the master down; where it is then it stays.
    pub(super) fn cancel_phase(&mut self) {
        if let Some(phasing) = &mut self.phasing {
            (phasing.shift, phasing.ending) = (phasing.shift.stopping(), Some(Code::CANCELLED));
        }
    }

    /// What is left of the shifts of slave and master, as shares of all of them.
    pub(super) fn phase_left(&self) -> (f64, f64) {
        let slave = self.overlay.map_or(0.0, |overlay| overlay.share_left());
        (slave, self.phasing.map_or(0.0, |phasing| phasing.shift.share_left()))
    }
}
