//! Drives without a bus: conversion between the inputs and outputs of the machine and the process data of a drive.

use super::Machine;
use crate::config::MachineConfig;
use crate::drive::{AnalogDrive, AnalogWiring, Inputs, Outputs};

/// Position of a drive without a bus in the configuration.
#[derive(Clone, Copy, Debug)]
pub(super) struct AnalogPlace {
    /// Index among the drives.
    drive: usize,
    wiring: AnalogWiring,
    /// Index among the digital inputs.
    ready: Option<usize>,
}

impl MachineConfig {
    /// Returns the drives without a bus, in file order of their axes.
    pub(super) fn analog_places(&self) -> impl Iterator<Item = AnalogPlace> {
        self.drives().enumerate().filter_map(|(drive, (_, axis, _))| {
            let wiring = axis.analog?;
            Some(AnalogPlace { drive, wiring, ready: wiring.ready.map(|entry| self.io_place(entry.into())) })
        })
    }
}

impl Machine {
    /// Writes the process data of drives without a bus to the places where drives on a bus report theirs.
    pub(super) fn write_analog_inputs(&mut self, inputs: &mut Inputs) {
        for (place, drive) in self.analog_places.iter().zip(&mut self.state.analogs) {
            let told = drive.read(place.ready.is_none_or(|input| inputs.digital(input)));
            if let Some(input) = inputs.drive.get_mut(place.drive) {
                *input = told;
            }
        }
    }

    /// Converts the commanded values of drives without a bus to reference voltages.
    pub(super) fn write_analog_references(&mut self, outputs: &mut Outputs) {
        for (place, drive) in self.analog_places.iter().zip(&mut self.state.analogs) {
            let asked = outputs.drive.get(place.drive).copied().unwrap_or_default();
            let reference = drive.write(&place.wiring, &asked, self.config.cycle_ns);
            self.signals.publish_reference(&mut self.state.board, &place.wiring, reference, outputs);
        }
    }
}

/// Returns one state per drive without a bus, before the first read.
pub(super) fn initial_states(config: &MachineConfig) -> Vec<AnalogDrive> {
    config.analog_places().map(|_| AnalogDrive::default()).collect()
}
