//! Functions of digital outputs: the owner of each output.
//!
//! Law      each output has one function: a brake that another function can open is not safe. Several axes may share an
//!          output through the same parameter with the same sign; outputs for the sign of the reference of a drive
//!          belong to one drive
//! Source   MACS-IO-04, MACS-IO-06, MACS-IO-07, MACS-DIR-08, MACS-DIR-09

use super::{ConfigError, IoKind, MachineConfig};
use crate::object::Object;
use crate::parameter::{AxisParameters, MACHINE, Polarity};

/// Upper bound of the output numbers in parameters: O_* up to 8, REVERS up to 10.
const OUTPUTS: usize = 16;
/// Maximum functions of outputs per axis.
const FUNCTIONS: usize = 4;

/// Key of a parameter that names an output, and the number of the output; 0: none.
pub type Function = (&'static str, i64);

/// Owner of an output.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OutputOwner {
    /// A parameter of that axis, or of [`MACHINE`].
    Parameter(u16, Function),
    /// The axis directly: its brake, or an output of `wf`.
    Axis(u16),
    /// A function slot, by its index.
    Slot(u16),
}

/// An output that would have two functions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OutputShared {
    /// Index of the axis, or [`MACHINE`].
    pub axis: u16,
    /// Parameter that names the output, and its value.
    pub function: Function,
    /// Present owner of the output.
    pub other: OutputOwner,
}

impl AxisParameters {
    /// Returns the functions that the parameters give to digital outputs.
    pub fn output_functions(&self) -> [Function; FUNCTIONS] {
        let (first, second) = match self.reversing().polarity {
            Polarity::Bipolar => (0, 0),
            Polarity::Direction(output) => (i64::from(output), 0),
            Polarity::Enables(output) => (i64::from(output), i64::from(output) + 1),
        };
        [("o_brake", self.outputs.brake), ("o_axmove", self.outputs.axmove), ("revers", first), ("revers", second)]
    }
}

impl MachineConfig {
    /// Checks that each output has one function, for these parameters of the axes (by index) and this O_ERROR. Axes
    /// with new parameters, and a new [`MACHINE`], are checked last, so that the error names them instead of the
    /// present owner of the output.
    ///
    /// # Errors
    /// The first output that would have two functions.
    pub fn check_functions(
        &self,
        o_error: i64,
        functions: impl Fn(usize) -> [Function; FUNCTIONS],
        is_new: impl Fn(usize) -> bool,
    ) -> Result<(), OutputShared> {
        let mut switchers = [None; OUTPUTS];
        for (index, axis) in self.axes.iter().enumerate() {
            for entry in axis.own_outputs().into_iter().flatten().map(usize::from) {
                if self.io.get(entry).is_some_and(|io| io.kind == IoKind::DigitalOutput)
                    && let Some(switcher) = switchers.get_mut(self.io_place(entry) + 1)
                {
                    *switcher = Some(OutputOwner::Axis(index as u16));
                }
            }
        }
        for (place, slot) in self.slots.iter().enumerate() {
            for line in slot.outputs.iter().flatten() {
                if let Object::Io(entry) = line.object
                    && let Some(switcher) = switchers.get_mut(self.io_place(entry.into()) + 1)
                {
                    *switcher = Some(OutputOwner::Slot(place as u16));
                }
            }
        }
        let is_new = &is_new;
        let of = |index: usize| functions(index).map(|function| (index as u16, function));
        let of_axes = |new: bool| (0..self.axes.len()).filter(move |index| is_new(*index) == new).flat_map(of);
        let of_machine = |new: bool| (is_new(MACHINE.into()) == new).then_some((MACHINE, ("o_error", o_error)));
        let in_turn = of_axes(false).chain(of_machine(false)).chain(of_axes(true)).chain(of_machine(true));
        for (axis, function) in in_turn {
            let place = usize::try_from(function.1.unsigned_abs()).unwrap_or(OUTPUTS);
            let Some(switcher) = switchers.get_mut(place).filter(|_| place != 0) else { continue };
            match *switcher {
                None => *switcher = Some(OutputOwner::Parameter(axis, function)),
                Some(OutputOwner::Parameter(_, other)) if other == function && function.0 != "revers" => {}
                Some(other) => return Err(OutputShared { axis, function, other }),
            }
        }
        Ok(())
    }

    /// Checks that its outputs have one function each, with the parameters of the cell and with the saved ones.
    pub(super) fn check_outputs_once(&self) -> Result<(), ConfigError> {
        let now = self.check_functions(
            self.global.parameters.o_error,
            |index| self.axes.get(index).map_or([("", 0); FUNCTIONS], |axis| axis.parameters.output_functions()),
            |_| false,
        );
        let saved = self.check_functions(
            self.global.power_on().o_error,
            |index| self.axes.get(index).map_or([("", 0); FUNCTIONS], |axis| axis.power_on().output_functions()),
            |_| false,
        );
        now.and(saved).map_err(|shared| {
            let axis = self.axes.get(usize::from(shared.axis)).map(|axis| axis.name.clone());
            ConfigError::OutputShared { axis, key: shared.function.0, number: shared.function.1.saturating_abs() }
        })
    }
}
