//! Functions of inputs and outputs: processing between the terminals and the axes.
//!
//! Law      a virtual input has the level that its output had at the end of the previous cycle; a filtered input takes
//!          its new level once this has been stable for the filter time; analog input 1 is
//!          filt += (reading - filt) / AINFTIME every ms. An input function is triggered by its edge, +n rising,
//!          -n falling. An output keeps its last value, set by its function or by set_output; this module only closes
//!          the brake of MACS
//! Reads    the digital and analog inputs, the states of the axes
//! Writes   all outputs except those that an axis switches itself
//! Refuses  a value that an output cannot have; an output that an axis switches itself
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

/// Sampling period of analog input 1 (ns).
const READING_NS: u64 = 1_000_000;

/// Filter state of a digital input.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct InputFilter {
    level: bool,
    /// Cycle since which the input has had the other level.
    since: Option<u64>,
}

/// Value of an output function, with the number of its output.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct OutputFunctionState {
    number: i64,
    active: bool,
}

/// State of the terminals of the machine.
#[derive(Debug, Default, Serialize, Deserialize)]
pub(super) struct Panel {
    /// Parameters in force.
    pub parameters: MachineParameters,
    /// Parameters of layer User.
    pub user: MachineParameters,
    /// Last set values of the digital outputs.
    outputs: Vec<u64>,
    /// Last set values of the analog outputs (V).
    analog: Vec<f64>,
    /// Digital inputs of the previous cycle; empty before the first cycle.
    before: Vec<u64>,
    has_read: bool,
    settling: Vec<InputFilter>,
    /// Smoothed analog input 1 (V).
    smoothed: Option<f64>,
    /// Time since the last sample of analog input 1 (ns).
    unread_ns: u64,
    error: OutputFunctionState,
    brakes: Vec<OutputFunctionState>,
    moves: Vec<OutputFunctionState>,
    /// Abort of this cycle: the value of ESCCOND and the number of digital outputs.
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
            settling: vec![InputFilter::default(); config.global.filters.len()],
            smoothed: None,
            unread_ns: 0,
            error: OutputFunctionState::default(),
            brakes: vec![OutputFunctionState::default(); config.axes.len()],
            moves: vec![OutputFunctionState::default(); config.axes.len()],
            aborts: None,
        }
    }

    /// Whether this is a valid panel state of the machine of `fresh`.
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

    /// Sets the state after power-on: outputs are off, layer User is in force.
    pub(super) fn power_up_from(&mut self, first: &Self) {
        let user = self.user;
        self.clone_from(first);
        (self.parameters, self.user) = (user, user);
    }

    /// Returns the conditioned inputs: virtual inputs, filtered digital inputs and the smoothed analog input 1. Returns
    /// the unmodified inputs if none of these is configured.
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
                *settling = InputFilter { level, since: None };
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
            // The first reading has no previous value for smoothing.
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

    /// Returns the level at the terminal of a digital input, which its latch sees; the filter may not have accepted
    /// this level yet.
    pub(super) fn terminal(&self, config: &MachineConfig, place: usize, seen: &Inputs) -> bool {
        let mut filters = config.global.filters.iter().zip(&self.settling);
        let differs = filters.any(|(filter, settling)| filter.input == place && settling.since.is_some());
        seen.digital(place) != differs
    }

    /// Returns true if these are the digital inputs of the previous cycle.
    pub(super) fn equals_previous(&self, digital: &[u64]) -> bool {
        self.has_read && self.before == digital
    }

    /// Returns the edges of this cycle.
    pub(super) fn edges(&mut self, inputs: &Inputs) -> Edges {
        let before = &self.before;
        let rises = |number: i64| {
            let was = assigned_input(|place| bit(before, place), number);
            self.has_read && number != 0 && assigned_input(|place| inputs.digital(place), number) && !was
        };
        let p = &self.parameters;
        let edges = Edges { clears: rises(p.i_errclr), interrupts: rises(p.i_break), resumes: rises(p.i_continue) };
        // The dimensions of a machine never change.
        self.before.iter_mut().zip(&inputs.digital).for_each(|(before, now)| *before = *now);
        self.has_read = true;
        edges
    }

    /// Sets outputs permanently (OUT, OUTB, OUTAN): all of them, or none.
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

    /// Sets an output of a function, by its index among the digital outputs.
    pub(super) fn set_digital(&mut self, place: usize, on: bool) {
        set_bit(&mut self.outputs, place, on);
    }

    /// Sets an output of a function, by its index among the analog outputs (V).
    pub(super) fn set_analog(&mut self, place: usize, volts: f64) {
        if let Some(output) = self.analog.get_mut(place) {
            *output = volts;
        }
    }

    /// Requests the abort of all axes in this cycle. Outputs belong to the machine and ESCCOND to an axis, so the
    /// largest ESCCOND applies.
    pub(super) fn abort(&mut self, axes: &[Axis], outputs: usize) {
        let esccond = axes.iter().map(|axis| axis.parameters.supervision.esccond).max();
        self.aborts = esccond.map(|esccond| (esccond, outputs));
    }

    /// Sets the outputs on an abort (MACS-ERR-09), except those of brakes, which are closed if nothing else holds the
    /// axis, and those that report the sign of the reference to a drive.
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
            if axis.is_brake_requested() {
                write_output(&mut self.outputs, axis.parameters.outputs.brake, true);
            }
            for (output, on) in axis.sign_outputs().into_iter().flatten() {
                write_output(&mut self.outputs, output.into(), on);
            }
        }
    }

    /// Updates the output functions from the axes. If functions share an output, it shows whether one of them is
    /// active.
    pub(super) fn update_output_functions(&mut self, axes: &[Axis]) {
        let outputs = &mut self.outputs;
        let (mut failing, mut moving) = (false, Moving::default());
        for axis in axes {
            failing |= !axis.error().is_none();
            moving.add(axis.parameters.outputs.axmove, axis.is_commanded());
        }
        // Outputs that are no longer assigned are released first: another function may be assigned to them now.
        release_output(outputs, self.error, self.parameters.o_error, false);
        for (axis, moves) in axes.iter().zip(&self.moves) {
            let number = axis.parameters.outputs.axmove;
            if moves.number != number {
                release_output(outputs, *moves, number, moving.has(moves.number));
            }
        }
        let is_new = failing && !self.error.active;
        update_output(outputs, &mut self.error, self.parameters.o_error, failing);
        for (axis, (brake, moves)) in axes.iter().zip(self.brakes.iter_mut().zip(&mut self.moves)) {
            let assigned = axis.parameters.outputs;
            update_output(outputs, moves, assigned.axmove, moving.has(assigned.axmove));
            if axis.outputs_sign() {
                for (output, on) in axis.sign_outputs().into_iter().flatten() {
                    write_output(outputs, output.into(), on);
                }
            }
            let now = OutputFunctionState { number: assigned.brake, active: axis.is_brake_requested() };
            let before = std::mem::replace(brake, now);
            // Only set_output opens the brake (MACS-IO-05).
            if now.active && (now != before || axis.is_brake_requested_now()) {
                write_output(outputs, now.number, true);
            }
        }
        if let Some((esccond, outputs)) = self.aborts.take() {
            self.set_for_abort(axes, esccond, outputs);
            // An error of the same cycle is still shown (MACS-IO-07).
            if is_new {
                write_output(&mut self.outputs, self.parameters.o_error, true);
            }
        }
    }

    /// Returns whether the brake of an axis that O_BRAKE names is closed; `None` without such a brake.
    pub(super) fn brake_of(&self, axis: &Axis) -> Option<bool> {
        let number = axis.parameters.outputs.brake;
        (number != 0).then(|| assigned_input(|place| bit(&self.outputs, place), number))
    }

    /// Writes the outputs to the terminals.
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

/// Checks that an output may be set to this value by a client.
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

/// Set of the O_AXMOVE numbers, which axes may share, that have an axis with a motion command. Numbers are within +-8,
/// so each has a bit.
#[derive(Clone, Copy, Debug, Default)]
struct Moving(u64);

impl Moving {
    fn mask(number: i64) -> u64 {
        // A number far below the range wraps to one far above it.
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

/// Sets an output that is no longer assigned to inactive, unless the same function of another axis is active on it.
fn release_output(outputs: &mut [u64], shown: OutputFunctionState, number: i64, elsewhere: bool) {
    if shown.number != number {
        write_output(outputs, shown.number, elsewhere);
    }
}

/// Writes an output if its function has changed.
fn update_output(outputs: &mut [u64], shown: &mut OutputFunctionState, number: i64, active: bool) {
    let now = OutputFunctionState { number, active };
    if std::mem::replace(shown, now) != now {
        write_output(outputs, number, now.active);
    }
}

/// Sets output n high while active, or -n low while active.
fn write_output(outputs: &mut [u64], number: i64, active: bool) {
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

    /// Allocates no memory if both panels belong to the same machine.
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
