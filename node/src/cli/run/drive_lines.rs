//! Lists real and simulated drives for the log at the start of a cell.

use crate::cell::{Cell, CellBackend};

/// Log lines about the drives of a cell.
#[derive(Debug, Default, PartialEq, Eq)]
pub(super) struct DriveLines {
    /// One line for each backend with real devices.
    pub(super) real: Vec<String>,
    /// Line about the simulated drives of a cell that also has real ones, or would have them without `--sim`.
    pub(super) simulated: Option<String>,
}

impl DriveLines {
    /// Returns the lines for a run of a cell; if `is_sim`, all drives are simulated.
    pub(super) fn of(cell: &Cell, is_sim: bool) -> Self {
        let not_simulated = cell.backends.iter().enumerate().filter(|(_, backend)| !backend.is_simulated());
        let not_simulated: Vec<_> = not_simulated.collect();
        if not_simulated.is_empty() {
            return Self::default();
        }
        if is_sim {
            let names: Vec<&str> = not_simulated.iter().map(|(_, backend)| backend.name.as_str()).collect();
            let all: Vec<usize> = (0..cell.backends.len()).collect();
            let axes = Driven::of(cell, &all).axes;
            let what =
                if axes.is_empty() { "no drives".to_owned() } else { format!("simulated drives: {}", axes.join(", ")) };
            let line = format!("{what}; nothing is sent on {} (--sim)", names.join(", "));
            return Self { real: Vec::new(), simulated: Some(line) };
        }
        let real = not_simulated.iter().map(|(place, backend)| real_line(backend, &Driven::of(cell, &[*place])));
        let others = (0..cell.backends.len()).filter(|place| not_simulated.iter().all(|(real, _)| real != place));
        let others = Driven::of(cell, &others.collect::<Vec<_>>()).axes;
        let simulated = (!others.is_empty()).then(|| format!("simulated drives: {}", others.join(", ")));
        Self { real: real.collect(), simulated }
    }
}

/// Axes and devices of the drives at some backends.
struct Driven<'a> {
    axes: Vec<&'a str>,
    devices: Vec<String>,
}

impl<'a> Driven<'a> {
    /// Returns those at the backends with these indices; an axis with two drives is listed once, and so is a device.
    fn of(cell: &'a Cell, backends: &[usize]) -> Self {
        let mut found = Self { axes: Vec::new(), devices: Vec::new() };
        for (at, (_, axis, _)) in cell.drives().zip(cell.machine.drives()) {
            if !backends.contains(&at.backend) {
                continue;
            }
            if !found.axes.contains(&axis.name.as_str()) {
                found.axes.push(&axis.name);
            }
            // The location of a drive with voltage reference is its analog output. Such drives may share a module.
            let device = at.address.device.to_string();
            if !found.devices.contains(&device) {
                found.devices.push(device);
            }
        }
        found
    }
}

fn real_line(backend: &CellBackend, here: &Driven<'_>) -> String {
    let hardware = backend.hardware().map_or_else(String::new, |hardware| format!(" ({hardware})"));
    let bus = format!("{}{hardware}", backend.name);
    if here.axes.is_empty() {
        return format!("REAL DEVICES on {bus}, no drives");
    }
    let (word, plural) = (backend.device_word(), if here.devices.len() == 1 { "" } else { "s" });
    format!("REAL DRIVES on {bus}: {} ({word}{plural} {})", here.axes.join(", "), here.devices.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEAD: &str = "lineshaft: 1\ncycle: 4 ms\nbackends:\n  bus0: {type: can, transport: 'socketcan:can0'}\n  \
                        bus1: {type: can, transport: 'slcan:/dev/ttyACM0', bitrate: 1000000}\n  plant: {type: sim}\n";

    fn axis(name: &str, drive: &str) -> String {
        format!(
            "  {name}: {{type: linear, scale: {{increments: 1000, per: 1 mm}}, {drive}, max_velocity: 1 m/s, max_acceleration: 1 m/s^2}}\n"
        )
    }

    fn lines(axes: &[String], is_sim: bool) -> DriveLines {
        let text = format!("{HEAD}axes:\n{}", axes.concat());
        DriveLines::of(&Cell::parse("c.yaml", text).unwrap_or_else(|problems| panic!("{problems}")), is_sim)
    }

    #[test]
    fn real_drives_are_named_with_their_bus_and_nodes() {
        let axes = [
            axis("x", "drive: {backend: bus0, node: 1}"),
            axis("y", "drive: {backend: bus0, node: 2}"),
            axis("z", "drive: {backend: plant, address: 0}"),
            axis("v", "drive: virtual"),
        ];
        let real = [
            "REAL DRIVES on bus0 (socketcan:can0): x, y (nodes 1, 2)",
            "REAL DEVICES on bus1 (slcan:/dev/ttyACM0), no drives",
        ];
        let expected =
            DriveLines { real: real.map(str::to_owned).to_vec(), simulated: Some("simulated drives: z".to_owned()) };
        assert_eq!(lines(&axes, false), expected);
        let one = lines(&axes[..1], false);
        assert_eq!((one.real[0].as_str(), one.simulated), ("REAL DRIVES on bus0 (socketcan:can0): x (node 1)", None));
    }

    #[test]
    fn drives_that_sim_simulates_are_named_as_such() {
        let axes = [axis("x", "drive: {backend: bus0, node: 1}"), axis("z", "drive: {backend: plant, address: 0}")];
        let simulated = Some("simulated drives: x, z; nothing is sent on bus0, bus1 (--sim)".to_owned());
        assert_eq!(lines(&axes, true), DriveLines { real: Vec::new(), simulated });
        let none = lines(&[axis("v", "drive: virtual")], true).simulated;
        assert_eq!(none.as_deref(), Some("no drives; nothing is sent on bus0, bus1 (--sim)"));
        let cell = Cell::demo();
        assert_eq!(
            [false, true].map(|is_sim| DriveLines::of(&cell, is_sim)),
            [DriveLines::default(), DriveLines::default()]
        );
    }

    /// Two drives at the analog outputs of one module, with their own encoders.
    #[test]
    fn node_of_several_drives_is_named_once() {
        let parts = "io:\n  c: {type: ao, backend: bus0, node: 10, address: 0}\n  d: {type: ao, backend: bus0, node: 10, address: 1}\n  \
                     ce: {type: do, backend: bus0, node: 10, address: 0}\n  de: {type: do, backend: bus0, node: 10, address: 1}\n  \
                     ci: {type: di, backend: bus0, node: 10, address: 0}\n  di: {type: di, backend: bus0, node: 10, address: 1}\nencoders:\n  \
                     m: {backend: bus0, node: 12, bits: 32, type: linear, scale: {increments: 1000, per: 1 mm}}\n  \
                     n: {backend: bus0, node: 13, bits: 32, type: linear, scale: {increments: 1000, per: 1 mm}}\n";
        let at = |name: &str, output: &str, encoder: &str| {
            let keys = format!(
                "reference: {output}, enable: {output}e, ready: {output}i, enable_time: 20 ms, interface: velocity, full_velocity: 2 m/s"
            );
            axis(name, &format!("drive: {{{keys}}}, feedback: {{encoder: {encoder}}}"))
        };
        let text = format!("{HEAD}{parts}axes:\n{}{}", at("x", "c", "m"), at("y", "d", "n"));
        let cell = Cell::parse("c.yaml", text).unwrap_or_else(|problems| panic!("{problems}"));
        assert_eq!(DriveLines::of(&cell, false).real[0], "REAL DRIVES on bus0 (socketcan:can0): x, y (node 10)");
    }

    #[test]
    fn axis_with_two_drives_is_named_once() {
        let both = "max_skew: 1 mm, drives: [{backend: bus0, node: 4}, {backend: bus0, node: 5}]";
        let found = lines(&[axis("portal", both)], false);
        assert_eq!(found.real[0], "REAL DRIVES on bus0 (socketcan:can0): portal (nodes 4, 5)");
    }
}
