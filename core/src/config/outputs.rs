//! Outputs that axes control directly: brakes, motors in open loop, drives without a bus.
//!
//! Law      each output has the required kind, and belongs to one axis
//! Source   contract section 3

use super::{AnalogProblem, AxisConfig, ConfigError, IoKind, MachineConfig};
use crate::drive::{AnalogWiring, FULL_VOLTS, Interface, LONGEST_ENABLE_NS, SpeedOutputs};

impl MachineConfig {
    /// Checks that the inputs and outputs of an axis have the required kind, and that its outputs belong to it alone.
    pub(super) fn check_outputs(&self, axis: &AxisConfig) -> Result<(), ConfigError> {
        let name = || axis.name.clone();
        let (input, digital) = ((IoKind::DigitalInput, "di"), (IoKind::DigitalOutput, "do"));
        let analog = (IoKind::AnalogOutput, "ao");
        let SpeedOutputs { forward, backward, output, dac } = axis.open_loop;
        let wiring = axis.analog;
        let entries = [
            ("brake", axis.brake.map(|brake| brake.output), digital),
            ("reference", wiring.map(|wiring| wiring.reference), analog),
            ("enable", wiring.map(|wiring| wiring.enable), digital),
            ("ready", wiring.and_then(|wiring| wiring.ready), input),
            ("forward", forward, digital),
            ("backward", backward, digital),
            ("output", output, digital),
            ("dac", dac, analog),
        ];
        let is_one = |key: &str| matches!(key, "brake" | "reference" | "enable");
        for (key, entry, (expected, kind)) in entries {
            let Some(entry) = entry else { continue };
            if self.io.get(usize::from(entry)).is_none_or(|io| io.kind != expected) {
                return Err(ConfigError::Output { axis: name(), key, entry, kind });
            }
            let same = |axis: &AxisConfig| axis.own_outputs().into_iter().filter(|own| *own == Some(entry)).count();
            if is_one(key) && self.axes.iter().map(same).sum::<usize>() > 1 {
                return Err(ConfigError::OutputTwice { axis: name(), key, entry });
            }
        }
        wiring.map_or(Ok(()), |wiring| self.check_analog(axis, &wiring))
    }

    fn check_analog(&self, axis: &AxisConfig, wiring: &AnalogWiring) -> Result<(), ConfigError> {
        let refuse = |problem| Err(ConfigError::Analog { axis: axis.name.clone(), problem });
        if axis.drive.is_none() || axis.second.is_some() {
            return refuse(AnalogProblem::Drives);
        }
        if !matches!(axis.interface, Interface::Velocity | Interface::Torque) {
            return refuse(AnalogProblem::Interface(axis.interface));
        }
        if !(wiring.full > 0.0 && wiring.full.is_finite()) {
            return refuse(AnalogProblem::Full);
        }
        if wiring.enable_ns > LONGEST_ENABLE_NS {
            return refuse(AnalogProblem::Time(wiring.enable_ns / 1_000_000));
        }
        let is_virtual = |entry: u16| self.is_virtual_input(self.io_place(entry.into()));
        if wiring.ready.is_some_and(is_virtual) {
            return refuse(AnalogProblem::Ready);
        }
        Ok(())
    }

    /// Returns the full scale of an analog input or output by its index in section `io` (V), in both directions.
    pub fn full_scale(&self, entry: u16) -> f64 {
        let given = self.global.full_scales.iter().find(|given| given.entry == entry);
        given.map_or(FULL_VOLTS, |given| given.volts)
    }

    /// Returns the axis that controls an output directly, and therefore exclusively; by the index in section `io`.
    pub fn owner_of_output(&self, entry: u16) -> Option<u16> {
        let owns = |axis: &AxisConfig| axis.own_outputs().contains(&Some(entry));
        self.axes.iter().position(owns).map(|index| index as u16)
    }
}
