//! Inputs and outputs that parameters name by number: n-th digital input or output, in file order, from 1.

use super::{ConfigError, IoKind, MachineConfig};
use crate::parameter::{AxisParameters, MachineParameters};

/// Numbers of digital inputs and outputs, for parameters that name them by number from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct IoCounts {
    inputs: usize,
    outputs: usize,
}

/// Error: a number of an input or output that does not exist.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NoSuchIo {
    /// Parameter that names it.
    pub key: &'static str,
    /// Its value.
    pub number: i64,
    /// Whether it is an output.
    pub is_output: bool,
    /// Number of existing ones.
    pub count: usize,
}

/// Returns the error text of a number that names no input or output: `o_error is 8; the cell has 2 digital outputs`.
pub fn missing_io_text(key: &str, number: &str, outputs: bool, count: &str) -> String {
    // The number is in the tens digits of these values.
    let is = match key {
        "revers" => "needs output",
        "vmencmtyp" => "needs input",
        _ => "is",
    };
    format!("{key} {is} {number}; {}", io_count_text(outputs, count))
}

/// Returns the text about the number of digital inputs or outputs of the cell.
fn io_count_text(outputs: bool, count: &str) -> String {
    let what = if outputs { "output" } else { "input" };
    format!("the cell has {count} digital {what}{}", if count == "1" { "" } else { "s" })
}

impl NoSuchIo {
    pub(super) fn of(self, axis: Option<String>) -> ConfigError {
        let Self { key, number, is_output, count } = self;
        ConfigError::NoSuchIo { axis, key, number, is_output, count }
    }
}

impl IoCounts {
    /// Creates the counts.
    pub fn new(inputs: usize, outputs: usize) -> Self {
        Self { inputs, outputs }
    }

    /// Returns the counts of a machine.
    pub fn of(config: &MachineConfig) -> Self {
        Self { inputs: config.count_io(IoKind::DigitalInput), outputs: config.count_io(IoKind::DigitalOutput) }
    }

    fn check(self, named: &[(&'static str, i64, bool)]) -> Result<(), NoSuchIo> {
        named.iter().try_for_each(|&(key, number, is_output)| {
            let count = if is_output { self.outputs } else { self.inputs };
            let is_there = usize::try_from(number.unsigned_abs()).is_ok_and(|number| number <= count);
            if is_there { Ok(()) } else { Err(NoSuchIo { key, number, is_output, count }) }
        })
    }

    /// Checks that the inputs and outputs of an axis exist.
    ///
    /// # Errors
    /// The first one that does not exist.
    pub fn check_axis(self, parameters: &AxisParameters) -> Result<(), NoSuchIo> {
        let (inputs, outputs) = (parameters.assigned, parameters.outputs);
        self.check(&[
            ("i_refswitch", inputs.refswitch, false),
            ("i_poslimitsw", inputs.poslimitsw, false),
            ("i_neglimitsw", inputs.neglimitsw, false),
            ("i_refswitch_second", parameters.gantry.second_refswitch, false),
            ("o_brake", outputs.brake, true),
            ("o_axmove", outputs.axmove, true),
            ("revers", parameters.reversing().last_output(), true),
        ])
    }

    /// Checks that the inputs and outputs of the machine exist.
    ///
    /// # Errors
    /// The first one that does not exist.
    pub fn check_machine(self, parameters: &MachineParameters) -> Result<(), NoSuchIo> {
        self.check(&[
            ("i_break", parameters.i_break, false),
            ("i_continue", parameters.i_continue, false),
            ("i_errclr", parameters.i_errclr, false),
            ("o_error", parameters.o_error, true),
            ("vmencmtyp", parameters.vmencmtyp / 10, false),
        ])
    }
}
