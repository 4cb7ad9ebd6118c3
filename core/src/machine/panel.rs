//! Inputs and outputs with a function: what goes between the terminals and the axes.
//!
//! Law      a virtual input has the level that its output had at the end of the cycle before; a filtered one has its new level
//!          once that stood for its time; analog input 1 is
//!          filt += (reading - filt) / AINFTIME every ms. An input function acts with its edge, +n rising, -n falling. An
//!          output stays as it was set last, by its function or by set_output; the brake of MACS is only closed here
//! Reads    the digital and analog inputs, what the axes tell
//! Writes   all outputs but those that an axis switches by itself
//! Refuses  a value that an output cannot have; an output that an axis switches by itself
//! Source   MACS-IO-01, MACS-IO-03 to -10, MACS-IO-14, MACS-ERR-04, MACS-ERR-09, A-47, A-49

use super::signals::Signals;
use crate::axis::{Axis, Edges, assigned_input};
use crate::code::Code;
use crate::command::OutputValue;
use crate::config::{IoKind, MachineConfig};
use crate::drive::{Inputs, Outputs, bit, set_bit};
use crate::event::{Number, Refusal};
use crate::object::Object;
use crate::parameter::MachineParameters;
use crate::signal::Board;
use serde::{Deserialize, Serialize};

/// Analog input 1 is read that often (ns).
const READING_NS: u64 = 1_000_000;

/// A digital input on its way to another level.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Settling {
    level: bool,
    /// Cycle since which it has had the other level.
    since: Option<u64>,
}

/// What an output function shows, and where.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Shown {
    number: i64,
    active: bool,
}

/// Terminals of the machine and their state.
#[derive(Debug, Default, Serialize, Deserialize)]
pub(super) struct Panel {
    /// In force.
    pub parameters: MachineParameters,
    /// Layer User.
    pub user: MachineParameters,
    /// Outputs as they were set last.
    outputs: Vec<u64>,
    /// (V)
    analog: Vec<f64>,
    /// Digital inputs of the cycle before; empty before the first one.
    before: Vec<u64>,
    has_read: bool,
    settling: Vec<Settling>,
    /// Analog input 1, smoothed (V).
    smoothed: Option<f64>,
    /// Time since its last reading (ns).
    unread_ns: u64,
    error: Shown,
    brakes: Vec<Shown>,
    moves: Vec<Shown>,
    /// An abort of this cycle: what ESCCOND says, and to how many digital outputs.
    aborts: Option<(i64, usize)>,
}

impl Panel {
    pub(super) fn new(config: &MachineConfig) -> Self {
        let words = |kind| config.count_io(kind).div_ceil(64);
        Self {
            parameters: config.global.power_on(),
            user: config.global.power_on(),
            outputs: vec![0; words(IoKind::DigitalOutput)],
            analog: vec![0.0; config.count_io(IoKind::AnalogOutput)],
            before: vec![0; words(IoKind::DigitalInput)],
            has_read: false,
            settling: vec![Settling::default(); config.global.filters.len()],
            smoothed: None,
            unread_ns: 0,
            error: Shown::default(),
            brakes: vec![Shown::default(); config.axes.len()],
            moves: vec![Shown::default(); config.axes.len()],
            aborts: None,
        }
    }

    /// Is it one of that machine, in a state that a cycle leaves?
    pub(super) fn fits(&self, fresh: &Self) -> bool {
        let shape = |panel: &Self| {
            let lists = [panel.outputs.len(), panel.analog.len(), panel.before.len(), panel.settling.len()];
            (lists, panel.brakes.len(), panel.moves.len())
        };
        shape(self) == shape(fresh)
            && self.parameters.is_sound()
            && self.user.is_sound()
            && self.smoothed.is_none_or(f64::is_finite)
            && self.unread_ns < READING_NS
            && self.analog.iter().all(|volts| volts.is_finite())
    }

    /// As after the power came back: outputs are off, layer User is in force.
    pub(super) fn power_up_from(&mut self, first: &Self) {
        let user = self.user;
        self.clone_from(first);
        (self.parameters, self.user) = (user, user);
    }

    /// The inputs as the machine sees them, where that differs from how they are.
    pub(super) fn condition<'i>(
        &mut self,
        inputs: &'i Inputs,
        config: &MachineConfig,
        virtual_inputs: impl ExactSizeIterator<Item = (usize, bool)>,
        cycle: u64,
        seen: &'i mut Inputs,
    ) -> &'i Inputs {
        let smooths = self.parameters.ainftime > 0;
        if !smooths {
            (self.smoothed, self.unread_ns) = (None, 0);
        }
        if !smooths && config.global.filters.is_empty() && virtual_inputs.len() == 0 {
            return inputs;
        }
        seen.copy_from(inputs);
        virtual_inputs.for_each(|(place, level)| seen.set_digital(place, level));
        for (filter, settling) in config.global.filters.iter().zip(&mut self.settling) {
            let level = seen.digital(filter.input);
            let accepted = !self.has_read || level == settling.level || {
                let since = *settling.since.get_or_insert(cycle);
                cycle.saturating_sub(since).saturating_mul(config.cycle_ns) >= filter.time_ns
            };
            if accepted {
                *settling = Settling { level, since: None };
            }
            seen.set_digital(filter.input, settling.level);
        }
        if let Some(reading) = seen.analog.first_mut().filter(|_| smooths) {
            *reading = self.smooth(*reading, config.cycle_ns);
        }
        seen
    }

    fn smooth(&mut self, reading: f64, cycle_ns: u64) -> f64 {
        let Some(mut smoothed) = self.smoothed else {
            // There is nothing before the first reading that it could be drawn to.
            self.smoothed = Some(reading).filter(|reading| reading.is_finite());
            return reading;
        };
        self.unread_ns = self.unread_ns.saturating_add(cycle_ns);
        while self.unread_ns >= READING_NS {
            self.unread_ns -= READING_NS;
            let next = smoothed + (reading - smoothed) / self.parameters.ainftime as f64;
            smoothed = if next.is_finite() { next } else { smoothed };
        }
        self.smoothed = Some(smoothed);
        smoothed
    }

    /// Returns the level at the terminal of a digital input, which its latch sees: the filter may not have passed it on yet.
    pub(super) fn terminal(&self, config: &MachineConfig, place: usize, seen: &Inputs) -> bool {
        let mut filters = config.global.filters.iter().zip(&self.settling);
        let differs = filters.any(|(filter, settling)| filter.input == place && settling.since.is_some());
        seen.digital(place) != differs
    }

    /// Were these the digital inputs of the cycle before?
    pub(super) fn has_read(&self, digital: &[u64]) -> bool {
        self.has_read && self.before == digital
    }

    /// The edges of this cycle.
    pub(super) fn edges(&mut self, inputs: &Inputs) -> Edges {
        let before = &self.before;
        let rises = |number: i64| {
            let was = assigned_input(|place| bit(before, place), number);
            self.has_read && number != 0 && assigned_input(|place| inputs.digital(place), number) && !was
        };
        let p = &self.parameters;
        let edges = Edges { clears: rises(p.i_errclr), interrupts: rises(p.i_break), resumes: rises(p.i_continue) };
        // A machine never changes its shape.
        self.before.iter_mut().zip(&inputs.digital).for_each(|(before, now)| *before = *now);
        self.has_read = true;
        edges
    }

    /// Sets outputs for good (OUT, OUTB, OUTAN): all of them, or none.
    pub(super) fn set(&mut self, config: &MachineConfig, values: &[OutputValue]) -> Result<(), Refusal> {
        values.iter().try_for_each(|value| check(config, *value))?;
        for &OutputValue { index, value } in values {
            let place = config.io_place(usize::from(index));
            if config.io.get(usize::from(index)).is_some_and(|io| io.kind == IoKind::DigitalOutput) {
                set_bit(&mut self.outputs, place, value == 1.0);
            } else if let Some(volts) = self.analog.get_mut(place) {
                *volts = value;
            }
        }
        Ok(())
    }

    /// An output of a function, by its place among the digital ones.
    pub(super) fn set_digital(&mut self, place: usize, on: bool) {
        set_bit(&mut self.outputs, place, on);
    }

    /// An output of a function, by its place among the analog ones (V).
    pub(super) fn set_analog(&mut self, place: usize, volts: f64) {
        if let Some(output) = self.analog.get_mut(place) {
            *output = volts;
        }
    }

    /// All axes abort in this cycle. Outputs are of the machine, ESCCOND of an axis: the largest one holds.
    pub(super) fn abort(&mut self, axes: &[Axis], outputs: usize) {
        let esccond = axes.iter().map(|axis| axis.parameters.supervision.esccond).max();
        self.aborts = esccond.map(|esccond| (esccond, outputs));
    }

    /// Sets the outputs as an abort asks, but for those of brakes, which are closed where the axis has nothing to hold it, and
    /// those that tell a drive the sign of its reference (MACS-ERR-09).
    fn set_for_abort(&mut self, axes: &[Axis], esccond: i64, outputs: usize) {
        if matches!(esccond, 1 | 2) {
            for place in 0..outputs {
                let works_brake = |axis: &Axis| axis.parameters.outputs.brake.unsigned_abs() == place as u64 + 1;
                if !axes.iter().any(works_brake) {
                    set_bit(&mut self.outputs, place, esccond == 2);
                }
            }
        }
        if esccond == 1 {
            self.analog.fill(0.0);
        }
        for axis in axes {
            if axis.asks_for_brake() {
                put(&mut self.outputs, axis.parameters.outputs.brake, true);
            }
            for (output, on) in axis.sign_outputs().into_iter().flatten() {
                put(&mut self.outputs, output.into(), on);
            }
        }
    }

    /// Lets the functions of outputs follow the axes. Those that share a number show that one of them is active.
    pub(super) fn follow(&mut self, axes: &[Axis]) {
        let outputs = &mut self.outputs;
        let (mut failing, mut moving) = (false, Moving::default());
        for axis in axes {
            failing |= !axis.error().is_none();
            moving.add(axis.parameters.outputs.axmove, axis.is_commanded());
        }
        // First all of those that are not assigned any more: another function may be new there.
        release(outputs, self.error, self.parameters.o_error, false);
        for (axis, moves) in axes.iter().zip(&self.moves) {
            let number = axis.parameters.outputs.axmove;
            if moves.number != number {
                release(outputs, *moves, number, moving.has(moves.number));
            }
        }
        let is_new = failing && !self.error.active;
        show(outputs, &mut self.error, self.parameters.o_error, failing);
        for (axis, (brake, moves)) in axes.iter().zip(self.brakes.iter_mut().zip(&mut self.moves)) {
            let assigned = axis.parameters.outputs;
            show(outputs, moves, assigned.axmove, moving.has(assigned.axmove));
            if axis.tells_sign() {
                for (output, on) in axis.sign_outputs().into_iter().flatten() {
                    put(outputs, output.into(), on);
                }
            }
            let now = Shown { number: assigned.brake, active: axis.asks_for_brake() };
            let before = std::mem::replace(brake, now);
            // Nothing but set_output opens it (MACS-IO-05).
            if now.active && (now != before || axis.asks_anew()) {
                put(outputs, now.number, true);
            }
        }
        if let Some((esccond, outputs)) = self.aborts.take() {
            self.set_for_abort(axes, esccond, outputs);
            // An error of the same cycle shows all the same (MACS-IO-07).
            if is_new {
                put(&mut self.outputs, self.parameters.o_error, true);
            }
        }
    }

    /// Is the brake of an axis that O_BRAKE names closed; none without one?
    pub(super) fn brake_of(&self, axis: &Axis) -> Option<bool> {
        let number = axis.parameters.outputs.brake;
        (number != 0).then(|| assigned_input(|place| bit(&self.outputs, place), number))
    }

    /// Puts the outputs to the terminals.
    pub(super) fn write(&self, signals: &Signals, board: &mut Board, outputs: &mut Outputs) {
        for (word, set) in outputs.digital.iter_mut().zip(&self.outputs) {
            *word = *set;
        }
        for (volts, set) in outputs.analog.iter_mut().zip(&self.analog) {
            *volts = *set;
        }
        signals.publish_outputs(board, outputs);
    }
}

/// May that output have that value from outside?
fn check(config: &MachineConfig, OutputValue { index, value }: OutputValue) -> Result<(), Refusal> {
    let refuse = |code| Refusal::new(code, Object::Io(index)).with(Number::Real(value), Number::None);
    if let Some(axis) = config.owner_of_output(index) {
        return Err(refuse(Code::OUTPUT_TAKEN).with(Number::Real(value), Number::Count(axis.into())));
    }
    if let Some(slot) = config.writer(Object::Io(index)) {
        return Err(refuse(Code::FUNCTION_WRITES).with(Number::Real(value), Number::Count(slot.into())));
    }
    let full = config.full_scale(index);
    match config.io.get(usize::from(index)).map(|io| io.kind) {
        Some(IoKind::DigitalOutput) if value == 0.0 || value == 1.0 => Ok(()),
        Some(IoKind::AnalogOutput) if value.abs() <= full => Ok(()),
        Some(IoKind::DigitalOutput | IoKind::AnalogOutput) => {
            Err(refuse(Code::OUTPUT_VALUE).with(Number::Real(value), Number::Real(full)))
        }
        _ => Err(refuse(Code::NO_OUTPUT)),
    }
}

/// Numbers of O_AXMOVE, which axes may share, where one of them has a motion command; they are within +-8, so each has a bit.
#[derive(Clone, Copy, Debug, Default)]
struct Moving(u64);

impl Moving {
    fn mask(number: i64) -> u64 {
        // A number far below wraps to one far above.
        let bit = number.wrapping_add(31).cast_unsigned();
        if bit < 64 { 1 << bit } else { 0 }
    }

    fn add(&mut self, number: i64, is_commanded: bool) {
        self.0 |= if is_commanded { Self::mask(number) } else { 0 };
    }

    fn has(self, number: i64) -> bool {
        self.0 & Self::mask(number) != 0
    }
}

/// An output that is not assigned any more goes back to inactive, unless the same function of another axis is active there.
fn release(outputs: &mut [u64], shown: Shown, number: i64, elsewhere: bool) {
    if shown.number != number {
        put(outputs, shown.number, elsewhere);
    }
}

/// Writes an output whose function has changed.
fn show(outputs: &mut [u64], shown: &mut Shown, number: i64, active: bool) {
    let now = Shown { number, active };
    if std::mem::replace(shown, now) != now {
        put(outputs, number, now.active);
    }
}

/// Output n high while active, -n low while active.
fn put(outputs: &mut [u64], number: i64, active: bool) {
    let place = number.unsigned_abs().checked_sub(1).and_then(|place| usize::try_from(place).ok());
    if let Some(place) = place {
        set_bit(outputs, place, active == (number > 0));
    }
}

impl Clone for Panel {
    fn clone(&self) -> Self {
        Self {
            outputs: self.outputs.clone(),
            analog: self.analog.clone(),
            before: self.before.clone(),
            settling: self.settling.clone(),
            brakes: self.brakes.clone(),
            moves: self.moves.clone(),
            ..*self
        }
    }

    /// Takes no memory where both are of one machine.
    fn clone_from(&mut self, other: &Self) {
        self.outputs.clone_from(&other.outputs);
        self.analog.clone_from(&other.analog);
        self.before.clone_from(&other.before);
        self.settling.clone_from(&other.settling);
        self.brakes.clone_from(&other.brakes);
        self.moves.clone_from(&other.moves);
        (self.parameters, self.user) = (other.parameters, other.user);
        (self.has_read, self.smoothed, self.unread_ns, self.error) =
            (other.has_read, other.smoothed, other.unread_ns, other.error);
        self.aborts = other.aborts;
    }
}
