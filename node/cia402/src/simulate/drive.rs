//! Simulated drive: its objects, between the bus and the mechanics.
//!
//! Law      in each cycle of the mechanics the objects become their commands, and their state becomes objects. A drive that loses its bus
//!          reacts according to 6007h if it is not off
//! Source   CiA 402-2 (6007h, 6040h, 6041h)

use super::modes::{Modes, units};
use super::objects as simulated;
use super::table::ObjectTable;
use super::touch_probe::TouchProbes;
use crate::config::{DriveConfig, VelocityFactor};
use crate::objects;
use lineshaft_core::drive::{DriveState, Inputs, Outputs, Terminal, control};
use std::time::Duration;

/// Status word bit 9: remote, the drive is controlled over the bus.
const STATUS_REMOTE: u16 = 0x0200;

/// Simulated drive without its bus and its mechanics.
#[derive(Clone, Debug)]
pub struct SimulatedDrive {
    /// Place among the drives of the machine.
    place: usize,
    velocity: VelocityFactor,
    digital_inputs: Vec<Terminal>,
    digital_outputs: Vec<Terminal>,
    /// Cycle time of the mechanics, in s.
    cycle_s: f64,
    modes: Modes,
    probes: TouchProbes,
    /// Objects.
    pub table: ObjectTable,
    fault: u16,
    is_lost: bool,
}

impl SimulatedDrive {
    /// Creates a drive that is switched off. `terminals` are the inputs and outputs of the machine at bits of 60FDh and 60FEh:01; `cycle` is
    /// the cycle time of the mechanics.
    pub fn new(
        config: &DriveConfig,
        [digital_inputs, digital_outputs]: [&[Terminal]; 2],
        table: ObjectTable,
        cycle: Duration,
    ) -> Self {
        Self {
            place: config.place,
            velocity: config.velocity,
            digital_inputs: digital_inputs.to_vec(),
            digital_outputs: digital_outputs.to_vec(),
            cycle_s: cycle.as_secs_f64(),
            modes: Modes::default(),
            probes: TouchProbes::default(),
            table,
            fault: 0,
            is_lost: false,
        }
    }

    /// Returns the place among the drives of the machine.
    pub fn place(&self) -> usize {
        self.place
    }

    /// Returns the error code; 0: no error.
    pub fn fault(&self) -> u16 {
        self.fault
    }

    /// Sets the error code (603Fh); 0: the error has ended.
    pub fn set_fault(&mut self, code: u16) {
        self.fault = code;
        self.table.set(objects::ERROR_CODE, code.into());
    }

    /// Returns true if the drive has to report a fault because it has lost its bus.
    pub fn is_lost(&self) -> bool {
        self.is_lost
    }

    /// Returns true once when the drive has to report a fault because it has lost its bus.
    pub fn take_connection_loss(&mut self) -> bool {
        std::mem::take(&mut self.is_lost)
    }

    /// Reacts according to 6007h if the drive is not off: no action, fault, disable voltage, or quick stop.
    pub fn abort_connection(&mut self) {
        let state = DriveState::from_status(self.table.get(objects::STATUS_WORD) as u16);
        let on = [DriveState::Ready, DriveState::SwitchedOn, DriveState::Enabled, DriveState::QuickStop];
        if !on.contains(&state) {
            return;
        }
        match self.table.get(simulated::ABORT_CONNECTION) {
            1 => self.is_lost = true,
            2 => self.table.set(objects::CONTROL_WORD, control::DISABLE_VOLTAGE.into()),
            3 => self.table.set(objects::CONTROL_WORD, control::QUICK_STOP.into()),
            _ => {}
        }
    }

    /// Updates the objects from the state of the mechanics. Returns whether the error code has changed; `None` if the inputs lack the drive.
    pub fn update_objects(&mut self, inputs: &Inputs) -> Option<bool> {
        let drive = inputs.drive.get(self.place)?;
        let terminals = self.digital_inputs.iter().filter(|terminal| inputs.digital(terminal.place));
        let terminals = terminals.fold(0, |bits, terminal| bits | 1_u32.unbounded_shl(terminal.address.into()));
        let velocity = self.velocity.to_drive(drive.velocity).clamp(i32::MIN.into(), i32::MAX.into());
        let table = &mut self.table;
        let status = drive.status | STATUS_REMOTE | self.modes.status(drive.status);
        table.set(objects::STATUS_WORD, status.into());
        table.set(objects::MODE_DISPLAY, self.modes.displayed_mode(drive.mode).cast_unsigned().into());
        // The conversion to 32 bits wraps.
        table.set(objects::POSITION, drive.count as u32);
        table.set(objects::VELOCITY, velocity as u32);
        table.set(simulated::VL_DEMAND, self.modes.vl_demand(self.velocity).cast_unsigned().into());
        table.set(simulated::VL_ACTUAL, units(self.velocity, drive.velocity).cast_unsigned().into());
        table.set(objects::TORQUE, (drive.effort.round() as i16).cast_unsigned().into());
        table.set(objects::DIGITAL_INPUTS, drive.inputs | terminals);
        self.probes.step(table, drive);
        let has_other_fault = drive.fault != self.fault;
        if has_other_fault {
            self.set_fault(drive.fault);
        }
        Some(has_other_fault)
    }

    /// Runs one cycle of the mode of operation: writes the commands of the objects to the outputs of the machine.
    pub fn run_mode(&mut self, inputs: &Inputs, outputs: &mut Outputs) {
        let drive = inputs.drive.get(self.place).copied().unwrap_or_default();
        let asked = self.modes.step(&self.table, self.velocity, &drive, self.cycle_s);
        if let Some(output) = outputs.drive.get_mut(self.place) {
            *output = asked;
        }
        let levels = self.table.get(objects::DIGITAL_OUTPUTS) & self.table.get(objects::DIGITAL_OUTPUT_MASK);
        for terminal in &self.digital_outputs {
            outputs.set_digital(terminal.place, levels.unbounded_shr(terminal.address.into()) & 1 == 1);
        }
    }
}
