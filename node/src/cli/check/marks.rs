//! Finds axes that are configured for marks that can never occur; mode MARKER is then refused when it is requested.

use lineshaft_core::axis::Source;
use lineshaft_core::config::{AxisConfig, IoConfig, IoKind, MachineConfig};
use lineshaft_core::object::Object;
use lineshaft_core::parameter::MarkSignal;

/// Returns a warning for each mark type without a source of marks.
pub(super) fn judge(machine: &MachineConfig) -> Vec<String> {
    let axes = (0_u16..).zip(&machine.axes);
    let set_up =
        axes.filter(|(_, axis)| axis.parameters.marks.master_type != 0 || axis.parameters.marks.slave_type != 0);
    set_up
        .flat_map(|(place, axis)| [master(axis, machine), slave(place, axis, machine)].into_iter().flatten())
        .collect()
}

/// The command selects the master, but an input that the type names is known before.
fn master(axis: &AxisConfig, machine: &MachineConfig) -> Option<String> {
    let number = axis.parameters.marks.master_type;
    let input = MarkSignal::decode(number).input.filter(|input| *input != 0)?;
    latches_not(input, machine).map(|why| told(axis, ("syncmtypm", number), &why, "CAM_MASTER_MARKER"))
}

fn slave(place: u16, axis: &AxisConfig, machine: &MachineConfig) -> Option<String> {
    let number = axis.parameters.marks.slave_type;
    let why = match MarkSignal::decode(number).input {
        // The default is the number of the axis.
        Some(input) => latches_not(if input == 0 { place + 1 } else { input }, machine)?,
        None => {
            let source = Source::of(axis.wired, machine.encoders.len(), &axis.parameters).ok()?;
            let object = match source {
                Source::Encoder(encoder) => Object::Encoder(encoder),
                Source::Drive(_) | Source::Simulated => Object::Axis(place),
            };
            if !machine.global.without_index.contains(&object) {
                return None;
            }
            format!("the index pulse of {}, which gives none", machine.name(object))
        }
    };
    Some(told(axis, ("syncmtyps", number), &why, "CAM_SLAVE_MARKER"))
}

/// Returns the reason why an input, given by its number, has no marks; `None` if it has.
fn latches_not(input: u16, machine: &MachineConfig) -> Option<String> {
    let is_digital = |io: &&IoConfig| io.kind == IoKind::DigitalInput;
    let found = machine.io.iter().filter(is_digital).nth(usize::from(input.checked_sub(1)?));
    match found {
        Some(io) if io.latch => None,
        Some(io) => Some(format!("digital input {input}, {}, which lacks latch: true", io.name)),
        None => Some(format!("digital input {input}, which the cell does not have")),
    }
}

fn told(axis: &AxisConfig, (key, number): (&str, i64), why: &str, mode: &str) -> String {
    format!("{}: {key} {number} asks for marks of {why}: modes MARKER and {mode} are refused", axis.name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cell::Cell;

    fn warned(keys: &str, sim: &str) -> Vec<String> {
        let text = format!(
            "lineshaft: 1
cycle: 1 ms
backends: {{plant: {{type: sim}}}}
io:
  product: {{type: di, backend: plant, address: 0, latch: true}}
  gate: {{type: di, backend: plant, address: 1}}
axes:
  x: {{type: linear, drive: {{backend: plant, address: 0, interface: position}}, scale: {{increments: 1000, per: 1 mm}},
      max_velocity: 1 m/s, max_acceleration: 1 m/s^2, sim: {{model: ideal{sim}}}, {keys}}}
"
        );
        judge(&Cell::parse("c.yaml", text).unwrap_or_else(|problems| panic!("{problems}")).machine)
    }

    #[test]
    fn encoders_and_drives_without_key_index_give_no_index_pulses() {
        let text = "lineshaft: 1
cycle: 1 ms
backends: {plant: {type: sim}}
encoders:
  belt: {backend: plant, address: 0, bits: 16, index: {every: 4000 inc, tolerance: 8 inc}, type: linear, scale: {increments: 40, per: 1 mm}}
  web: {backend: plant, address: 1, bits: 16, type: linear, scale: {increments: 40, per: 1 mm}}
axes:
  x: {type: linear, drive: {backend: plant, address: 0, interface: position}, scale: {increments: 1000, per: 1 mm},
      max_velocity: 1 m/s, max_acceleration: 1 m/s^2, sim: {model: ideal, index: {every: 10 mm, at: 3 mm}}}
  y: {type: linear, drive: {backend: plant, address: 1, interface: position}, scale: {increments: 1000, per: 1 mm},
      max_velocity: 1 m/s, max_acceleration: 1 m/s^2, sim: {model: ideal}}
";
        let cell = Cell::parse("c.yaml", text).unwrap_or_else(|problems| panic!("{problems}"));
        assert_eq!(cell.machine.global.without_index, [Object::Axis(1), Object::Encoder(1)]);
    }

    #[test]
    fn marks_that_never_come_are_a_warning() {
        let index = ", index: {every: 10 mm, at: 3 mm}";
        let none: [&str; 0] = [];
        assert_eq!(warned("syncmtypm: 12, syncmtyps: 0", index), none);
        assert_eq!(warned("syncmtypm: 12, syncmtyps: 12", ""), none);
        assert_eq!(warned("syncmpulsm: 700", ""), none, "not set up for marks");
        assert_eq!(
            warned("syncmtypm: 12, syncmtyps: 0", ""),
            [
                "x: syncmtyps 0 asks for marks of the index pulse of x, which gives none: modes MARKER and CAM_SLAVE_MARKER are refused"
            ]
        );
        assert_eq!(
            warned("syncmtypm: 22, syncmtyps: 33", ""),
            [
                "x: syncmtypm 22 asks for marks of digital input 2, gate, which lacks latch: true: modes MARKER and CAM_MASTER_MARKER are refused",
                "x: syncmtyps 33 asks for marks of digital input 3, which the cell does not have: modes MARKER and CAM_SLAVE_MARKER are refused",
            ]
        );
    }
}
