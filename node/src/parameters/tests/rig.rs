//! Interfaces by which a parameter is set.

use crate::cell::Cell;
use crate::parameters::read_changes;
use crate::scenario::{Options, Scenario, simulate, vocabulary_command};
use lineshaft_core::command::{Action, Command, Commands, Source};
use lineshaft_core::config::MachineConfig;
use lineshaft_core::event::Kind;
use lineshaft_core::machine::Machine;
use lineshaft_core::parameter::{AxisParameters, Change, Row};
use lineshaft_core::text::message;

/// Interface that reads text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Interface {
    Cell,
    Scenario,
    Import,
    Vocabulary,
}

/// Result of setting a value: the parameters of the axis afterwards, if the interface returns them, or the reason of a
/// refusal.
pub(super) type Outcome = Result<Option<AxisParameters>, String>;

/// Keys of axis `x` of the test cell, one of which can be replaced.
const KEYS: [(&str, &str); 4] = [
    ("unit", "mm"),
    ("scale", "{increments: 1000, per: 1 mm}"),
    ("max_velocity", "100 mm/s"),
    ("max_acceleration", "1000 mm/s^2"),
];

/// Returns a cell with an axis of every kind; one of them has another key instead of those with the same meaning.
fn cell_text(axis: &str, key: &str, value: &str) -> String {
    let mut text = "lineshaft: 1\ncycle: 1 ms\nbackends: {plant: {type: sim}}\naxes:\n".to_owned();
    for (place, (name, drive_kind)) in DRIVES.iter().enumerate() {
        let drive = match *drive_kind {
            "virtual" => "drive: virtual".to_owned(),
            GANTRY => "drives: [{backend: plant, address: 100}, {backend: plant, address: 101}]".to_owned(),
            interface => format!("drive: {{backend: plant, address: {place}, interface: {interface}}}"),
        };
        text += &format!("  {name}:\n    type: linear\n    {drive}\n");
        let is_here = *name == axis;
        if *name == "g" && !(is_here && key == "max_skew") {
            text += "    max_skew: 0.2 mm\n";
        }
        if *drive_kind == TORQUE {
            text += "    sim: {model: motor, inertia: 1e-4, rated_torque: 1 Nm, counts_per_turn: 4000}\n";
            for (usual, value) in [("max_effort", "1000"), ("torque_constant", "100"), ("ampencres", "4000")] {
                let line = format!("    {usual}: {value}\n");
                text += if is_here && key == usual { "" } else { &line };
            }
        }
        if *drive_kind == VOLTAGE {
            text += "    sim: {model: motor, inertia: 1e-4, voltage: 48 V, resistance: 1 Ohm, torque_constant: 0.4 Nm/A, counts_per_turn: 4000}\n";
            for (usual, value) in [("max_effort", "1000"), ("torque_constant", "20"), ("full_current", "10")] {
                let line = format!("    {usual}: {value}\n");
                text += if is_here && key == usual { "" } else { &line };
            }
        }
        let root = Row::find(key).map_or(key, |(_, row)| row.root());
        let root = if root.starts_with("pos") && root.contains("fact") { "scale" } else { root };
        let is_factor = matches!(key, "posfact_z" | "posfact_n" | "feedrev" | "feeddist" | "posencqc" | "posencrev");
        for (usual, written) in KEYS {
            let is_replaced = is_here && (usual == root || is_factor && usual == "scale");
            if !is_replaced {
                text += &format!("    {usual}: {written}\n");
            }
        }
        if is_here {
            text += &format!("    {key}: {value}\n");
        }
    }
    text
}

/// Axes of the test cell, and the interfaces of their drives.
pub(super) const DRIVES: [(&str, &str); 8] = [
    ("line", "virtual"),
    ("x", "position"),
    ("v", "velocity"),
    ("o", "open_loop"),
    ("p", "velocity, regulator: pid"),
    ("t", TORQUE),
    ("u", VOLTAGE),
    ("g", GANTRY),
];
/// The controller closes its loops down to the effort.
const TORQUE: &str = "torque, regulator: pid";
/// The controller closes its loops down to the voltage.
const VOLTAGE: &str = "voltage, regulator: pid";
/// The only axis with two drives.
const GANTRY: &str = "gantry";

pub(super) struct Rig {
    pub cell: Cell,
}

impl Rig {
    pub(super) fn new() -> Self {
        let cell = Cell::parse("cell", cell_text("", "", "")).unwrap_or_else(|problems| panic!("{problems}"));
        Self { cell }
    }

    pub(super) fn config(&self) -> &MachineConfig {
        &self.cell.machine
    }

    pub(super) fn machine(&self) -> Machine {
        Machine::new(self.cell.machine.clone()).expect("a good cell")
    }

    /// Sets a value as text with an interface that reads text. `object` is an axis or `machine`.
    pub(super) fn give_text(&self, door: Interface, object: &str, key: &str, value: &str) -> Outcome {
        let machine = self.machine();
        let line = format!("{object}.{key}: {value}");
        match door {
            Interface::Cell => {
                let cell =
                    Cell::parse("cell", cell_text(object, key, value)).map_err(|problems| problems.to_string())?;
                let axis = cell.machine.axes.iter().find(|axis| axis.name == object).expect("the axis");
                Ok(Some(axis.parameters))
            }
            Interface::Scenario => {
                let text = format!("scenario: s\ncycles: 1\nsteps: [{{at: 0, do: {{set_parameters: {{{line}}}}}}}]\n");
                let scenario = Scenario::parse("s", &text, &self.cell).map_err(|problems| problems.to_string())?;
                let report = simulate(&self.cell, &scenario, &Options::default()).expect("it runs");
                if report.passed() { Ok(None) } else { Err(report.to_string()) }
            }
            Interface::Import => {
                let changes = read_changes("import", &line, self.config(), machine.directory());
                self.give(object, Action::SetParameters(changes.map_err(|problems| problems.to_string())?))
            }
            Interface::Vocabulary => {
                let arguments = format!("{key}: {value}");
                let (config, directory) = (self.config(), machine.directory());
                let action = vocabulary_command(object, "set_parameters", &arguments, config, directory)?;
                self.give(object, action)
            }
        }
    }

    /// Sets a value in the machine directly.
    pub(super) fn give_change(&self, object: &str, change: Change) -> Outcome {
        self.give(object, Action::SetParameters([change].into()))
    }

    /// Sends a command to a machine that has just started. A refused one must change nothing.
    pub(super) fn give(&self, object: &str, action: Action) -> Outcome {
        let mut machine = self.machine();
        let before = machine.parameter_image();
        let (inputs, mut outputs) = (machine.inputs(), machine.outputs());
        let command = Command { sequence: 1, source: Source::Cli, action };
        machine.cycle(&inputs, Commands::queue(&[command]), &mut outputs);
        let refused = machine.events().iter().find(|event| event.kind == Kind::Refused);
        if let Some(event) = refused {
            assert_eq!(machine.parameter_image(), before, "a refusal changes nothing");
            return Err(message(event, self.config()));
        }
        let accepted = machine.events().iter().filter(|event| event.kind == Kind::Accepted);
        assert_eq!(accepted.count(), 1);
        let axis = self.config().axes.iter().position(|axis| axis.name == object);
        Ok(axis.and_then(|axis| machine.parameters(axis as u16).copied()))
    }
}
