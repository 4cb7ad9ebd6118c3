//! Phase shift of an axis against its leader in motion, on either side of its coupling (MC_PhasingRelative).
//!
//! Law      slave: a superimposed motion, which the coupling keeps. Master: the position of the leader is shifted, to
//!          2^-32 inc, and gear or cam treat this as any motion of the leader; the axis stays within its limits, and
//!          makes up for the rest later. A new shift replaces an active one, from its velocity on; the rest of the old
//!          one is dropped. A shift ends with its coupling
//! Reads    the coupling
//! Refuses  an axis that is not coupled by position; on a gear, a shift for which the axis has no velocity or
//!          acceleration left
//! Source   contract section 10, PLCopen (MC_PhasingRelative)

use crate::axis::state::alarm::NO_NUMBERS;
use crate::axis::state::goal::LEAST_RATE;
use crate::axis::state::{Axis, Context, Numbers, Phasing};
use crate::code::Code;
use crate::command::{BufferMode, Move, MoveMode, PhaseShift};
use crate::event::{Event, Number, Refusal};
use crate::modulo::Direction;
use crate::position::Position;
use crate::sync::follower::Follower;
use crate::sync::gear::Gear;
use crate::sync::{Shift, SyncMode, Transmission};

impl Axis {
    /// Accepts a shift of one side. That of the master is in increments of the leader; none if the unit cannot be
    /// converted.
    pub fn accept_phase(&mut self, cx: &mut Context<'_>, sequence: u64, of_slave: bool, asked: Option<PhaseShift>) {
        let unit = || self.refuse(Code::PHASE_UNIT);
        let result = self.shiftable().and_then(|_| asked.ok_or_else(unit)).and_then(|asked| {
            if of_slave { self.shift_slave(cx, sequence, &asked) } else { self.shift_master(cx, sequence, &asked) }
        });
        if let Err(refusal) = result {
            cx.events.push(Event { position: self.command.position(), ..refusal.event(sequence) });
        }
    }

    fn shift_slave(&mut self, cx: &mut Context<'_>, sequence: u64, asked: &PhaseShift) -> Result<(), Refusal> {
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
        // Its coupling keeps the fraction of an increment.
        let end = self.superimposed() + shift.exact();
        self.start_superimposed(cx, sequence, &request, end)
    }

    pub(in crate::axis) fn shift_master(
        &mut self,
        cx: &mut Context<'_>,
        sequence: u64,
        asked: &PhaseShift,
    ) -> Result<(), Refusal> {
        let follower = self.shiftable()?;
        let cycle_s = self.cycle_s();
        let (gear, most) = match follower.transmission() {
            Transmission::Gear(gear) => (Some(gear.ratio().to_f64()), Gear::MAX_CHANGE as f64),
            Transmission::Cam(cam) => (None, cam.largest_change(cx.tables)),
            Transmission::Approach(approach) => (Some(approach.ratio().to_f64()), Gear::MAX_CHANGE as f64),
        };
        let before = self.coupling.phasing().map(|phasing| phasing.shift);
        let (p, reserve) = (&self.parameters, self.reserve());
        // Velocity without the shift that it replaces.
        let own = before.map_or(0.0, |before| before.speed() / cycle_s * gear.unwrap_or_default());
        let left = p.max_velocity - (self.underlying().velocity - own).abs() - reserve.velocity;
        let velocity =
            self.rate_of_master(asked.velocity, gear, (p.default_goal_velocity(), left), Number::Velocity)?;
        let left = p.max_acceleration.min(p.deceleration_limit()) - reserve.acceleration;
        let usual = p.default_goal_acceleration().min(p.default_goal_deceleration());
        let acceleration = self.rate_of_master(asked.acceleration, gear, (usual, left), Number::Acceleration)?;
        let (change, whole) = (velocity * cycle_s, asked.shift.exact());
        if change > most {
            let numbers = (Number::Real(change), Number::Real(most));
            return Err(self.refuse(Code::PHASE_TOO_FAST).with(numbers.0, numbers.1));
        }
        if !whole.is_legal() {
            let number = Number::Position(whole.nearest());
            return Err(self.refuse(Code::POSITION_OUT_OF_RANGE).with(number, Number::None));
        }
        let shift = Shift::new(whole, velocity, acceleration, cycle_s, before.as_ref());
        self.end_phase(cx, Code::REPLACED, NO_NUMBERS);
        self.coupling.set_phasing(Some(Phasing { sequence, shift, ending: None }));
        self.accepted(cx, sequence);
        Ok(())
    }

    /// Returns a rate of the master. With a gear, limit and default follow from the rates of the axis; the slope of a
    /// cam is not constant.
    fn rate_of_master(
        &self,
        asked: f64,
        gear: Option<f64>,
        (usual, left): (f64, f64),
        number: fn(f64) -> Number,
    ) -> Result<f64, Refusal> {
        if !asked.is_finite() || asked < 0.0 {
            return Err(self.refuse(Code::BAD_NUMBER).with(Number::Real(asked), Number::None));
        }
        let Some(ratio) = gear.map(f64::abs) else {
            return if asked < LEAST_RATE { Err(self.refuse(Code::PHASE_RATE)) } else { Ok(asked) };
        };
        let left = left.max(0.0);
        let (of_axis, least) = if asked == 0.0 { (usual, left.min(usual)) } else { (asked * ratio, asked * ratio) };
        if least > left || left < LEAST_RATE {
            return Err(self.refuse(Code::SUPERIMPOSED_TOO_MUCH).with(number(of_axis), number(left)));
        }
        if least < LEAST_RATE {
            return Err(self.refuse(Code::RATE_TOO_LOW).with(number(least), number(LEAST_RATE)));
        }
        Ok(if asked == 0.0 { least / ratio } else { asked })
    }

    /// Returns the follower if its coupling by position may be shifted.
    fn shiftable(&self) -> Result<&Follower, Refusal> {
        self.check_closed_loop()?;
        self.check_free()?;
        let follower = self.coupling().map(|coupling| &coupling.follower);
        self.check_no_marks()?;
        let by_position = follower.filter(|follower| follower.mode() == SyncMode::Position);
        by_position.ok_or_else(|| self.refuse(Code::PHASE_NO_COUPLING))
    }

    /// Reports the end of a shift of the master.
    pub(super) fn report_phase(&self, cx: &mut Context<'_>, ended: Option<(u64, Code)>, position: Position) {
        if let Some((sequence, code)) = ended {
            cx.events.push(Event::done(self.object(), sequence, code, position));
        }
    }

    /// Returns the change that the shift adds to the master in this cycle, and the number of the command that ends with
    /// it.
    pub(super) fn phase_of_master(&mut self) -> (Position, Option<(u64, Code)>) {
        let Some(phasing) = self.coupling.phasing_mut() else { return (Position::ZERO, None) };
        let (change, has_ended) = phasing.shift.step();
        let ended = has_ended.then(|| (phasing.sequence, phasing.ending.unwrap_or(Code::NONE)));
        if has_ended {
            self.coupling.take_phasing();
        }
        (change, ended)
    }

    /// Ends the shift of the master now.
    pub(in crate::axis) fn end_phase(&mut self, cx: &mut Context<'_>, code: Code, numbers: Numbers) {
        if let Some(phasing) = self.coupling.take_phasing() {
            let code = phasing.ending.unwrap_or(code);
            let done = Event::done(self.object(), phasing.sequence, code, self.command.position());
            cx.events.push(done.with(numbers.0, numbers.1));
        }
    }

    /// Ends the shift when the coupling has ended in any way.
    pub(in crate::axis) fn settle_phase(&mut self, cx: &mut Context<'_>) {
        if self.coupling.phasing().is_some() && self.coupling().is_none() {
            self.end_phase(cx, Code::NOT_REACHED, NO_NUMBERS);
        }
    }

    /// Whether the command of that number shifts the master.
    pub(in crate::axis) fn is_phase(&self, sequence: u64) -> bool {
        self.coupling.phasing().is_some_and(|phasing| phasing.sequence == sequence)
    }

    /// Slows the shift of the master down; the shift reached then remains.
    pub(in crate::axis) fn cancel_phase(&mut self) {
        if let Some(phasing) = self.coupling.phasing_mut() {
            (phasing.shift, phasing.ending) = (phasing.shift.stopping(), Some(Code::CANCELLED));
        }
    }

    /// Returns the remaining shares of the shifts of slave and master.
    pub(in crate::axis) fn phase_left(&self) -> (f64, f64) {
        let slave = self.coupling.overlay().map_or(0.0, |overlay| overlay.share_left());
        (slave, self.coupling.phasing().map_or(0.0, |phasing| phasing.shift.share_left()))
    }
}
