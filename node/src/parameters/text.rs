//! Formats the parameters in force as text, for bags and exports.

use lineshaft_core::config::MachineConfig;
use lineshaft_core::object::AxisSet;
use lineshaft_core::parameter::{AxisParameters, MachineParameters, Measure, ParameterImage, ROWS, Row, Value};
use lineshaft_ros::surface::host::ParameterSelection;
use std::fmt::Write;

/// Returns every parameter of the machine and of every axis in increments, exactly, one line
/// `x.max_velocity: 125829120 inc/s` for each. An unset value is `~`, with its meaning.
pub fn parameters_text(config: &MachineConfig, machine: &MachineParameters, axes: &[AxisParameters]) -> String {
    machine_lines(machine, |_| true) + &lines(config, axes, |_, _| true)
}

/// Returns the parameters in force of some axes, in the format of [`read_changes`](super::read_changes); without those
/// that move the virtual master.
pub fn export_text(config: &MachineConfig, image: &ParameterImage, axes: AxisSet, what: ParameterSelection) -> String {
    let defaults = AxisParameters::new(0.0, 0.0);
    // Reading the text begins with the direction of rotation.
    let before = |index: usize, row: &Row, other: &AxisParameters| match image.effective.get(index) {
        Some(now) if row.key != "posdrct" => row.value(&other.with_direction_of(now)),
        _ => row.value(other),
    };
    let text = lines(config, &image.effective, |index, row| {
        let now = image.effective.get(index).map(|parameters| row.value(parameters));
        let other = match what {
            ParameterSelection::All => None,
            // Required parameters of a cell have no default.
            ParameterSelection::NotDefault => Some(row.value(&defaults)).filter(|_| !row.required),
            ParameterSelection::NotCell => config.axes.get(index).map(|axis| before(index, row, &axis.parameters)),
            ParameterSelection::NotSaved => image.user.get(index).map(|user| before(index, row, user)),
        };
        axes.contains(index as u16) && (other.is_none() || now != other)
    });
    if axes != AxisSet::first(config.axes.len()) {
        return text;
    }
    let [now, user] = &image.machine;
    let other = match what {
        ParameterSelection::All => None,
        ParameterSelection::NotDefault => Some(MachineParameters::default()),
        ParameterSelection::NotCell => Some(config.global.parameters),
        ParameterSelection::NotSaved => Some(*user),
    };
    let differs = |row: &Row| other.is_none_or(|other| row.machine_value(&other) != row.machine_value(now));
    // Reading the text would start the virtual master.
    machine_lines(now, |row| differs(row) && !row.moves_virtual_master()) + &text
}

/// Returns a line for each parameter of the machine that `takes` selects.
fn machine_lines(now: &MachineParameters, takes: impl Fn(&Row) -> bool) -> String {
    let mut text = String::new();
    for row in ROWS.iter().filter(|row| row.is_kept_by_machine() && takes(row)) {
        if let Value::Int(number) = row.machine_value(now) {
            let _ = writeln!(text, "machine.{}: {number}", row.key);
        }
    }
    text
}

/// Returns a line for each parameter that was set by its row, and that `takes` selects.
fn lines(config: &MachineConfig, parameters: &[AxisParameters], takes: impl Fn(usize, &Row) -> bool) -> String {
    let mut text = String::new();
    for (index, (axis, parameters)) in config.axes.iter().zip(parameters).enumerate() {
        for row in ROWS.iter().filter(|row| row.applies.to(axis) && parameters.is_given_by(row) && takes(index, row)) {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "{}.{}: {}", axis.name, row.key, exact_text(row, parameters));
        }
    }
    text
}

/// Returns the exact value of a row in the format that is read back.
pub(crate) fn exact_text(row: &Row, parameters: &AxisParameters) -> String {
    let unit = match row.measure {
        Measure::Position | Measure::Distance => " inc",
        Measure::Velocity => " inc/s",
        Measure::Acceleration => " inc/s^2",
        Measure::Jerk => " inc/s^3",
        Measure::Time => " ns",
        Measure::Integer | Measure::Number | Measure::Choice(_) => "",
    };
    match (row.value(parameters), row.measure) {
        (Value::Unset, _) => format!("~ # {}", row.default_text),
        (Value::Int(value), Measure::Choice(names)) => usize::try_from(value)
            .ok()
            .and_then(|place| names.get(place))
            .map_or_else(|| value.to_string(), |name| (*name).to_owned()),
        (Value::Int(value), _) => format!("{value}{unit}"),
        // The shortest decimal that is read back as the same number.
        (Value::Real(value), _) => format!("{value}{unit}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cell::Cell;

    fn defaults(cell: &Cell) -> Vec<AxisParameters> {
        cell.machine.axes.iter().map(|axis| axis.parameters).collect()
    }

    #[test]
    fn every_parameter_of_every_axis_has_a_line() {
        let cell = Cell::demo();
        let text =
            parameters_text(&cell.machine, &MachineParameters { o_error: -2, ..Default::default() }, &defaults(&cell));
        let machine: Vec<_> = text.lines().filter(|line| line.starts_with("machine.")).collect();
        assert_eq!(
            machine,
            [
                "machine.pulsvel: 0",
                "machine.pulsacc: 0",
                "machine.setsys_15: 0",
                "machine.i_break: 0",
                "machine.i_continue: 0",
                "machine.i_errclr: 0",
                "machine.o_error: -2",
                "machine.ainftime: 0",
                "machine.vmenctyp: 0",
                "machine.vmencres: 500",
                "machine.vmencmtyp: 0"
            ]
        );
        for (axis, parameters) in cell.machine.axes.iter().zip(defaults(&cell)) {
            let rows = ROWS.iter().filter(|row| row.applies.to(axis) && row.is_stored());
            let lines = text.lines().filter(|line| line.starts_with(&format!("{}.", axis.name)));
            // A limit that is off also has its former value.
            let off = [parameters.min_position, parameters.max_position].iter().filter(|limit| limit.is_none()).count();
            assert_eq!(lines.count(), rows.count() + off);
        }
        for line in [
            "x.max_velocity: 125829120 inc/s",
            "x.min_position: -5242880 inc",
            "x.max_jerk: ~ # no limit",
            "x.profile: trapezoid",
            "x.following_error_time: 0 ns",
            "x.error_reaction: 2",
            "turret.max_acceleration: 36000 inc/s^2",
        ] {
            assert!(text.lines().any(|given| given == line), "{line} is not in\n{text}");
        }
    }

    /// `set_parameters` and a cell accept the text after the colon, so that nothing is lost.
    #[test]
    fn the_text_gives_the_same_parameters_again() {
        use lineshaft_core::parameter::{ParameterInput, convert};
        use lineshaft_core::unit::Quantity;
        let cell = Cell::demo();
        let mut parameters = defaults(&cell);
        parameters[1].max_velocity = 0.1 + 0.2;
        parameters[1].max_jerk = Some(1e15);
        parameters[1].max_acceleration = 123_456_789.123_456_7;
        let text = parameters_text(&cell.machine, &MachineParameters::default(), &parameters);
        let mut read = defaults(&cell);
        for line in text.lines().filter(|line| !line.starts_with("machine.")) {
            let (name, value) = line.split_once(": ").unwrap();
            let (axis, key) = name.split_once('.').unwrap();
            let axis = cell.machine.axes.iter().position(|entry| entry.name == axis).unwrap();
            let (_, row) = Row::find(key).unwrap();
            let value = match (value, row.measure) {
                (value, _) if value.starts_with('~') => Value::Unset,
                (name, Measure::Choice(_)) => {
                    convert(row, &cell.machine.axes[axis].scale, &ParameterInput::Text(name.to_owned())).unwrap()
                }
                (number, Measure::Integer) => Value::Int(number.parse().unwrap()),
                (number, Measure::Number) => Value::Real(number.parse().unwrap()),
                (quantity, measure) => {
                    let dimensions = measure.dimensions(&cell.machine.axes[axis].scale).unwrap();
                    let quantity = ParameterInput::Quantity(Quantity::parse(quantity, &dimensions).unwrap());
                    convert(row, &cell.machine.axes[axis].scale, &quantity).unwrap()
                }
            };
            row.assign(&mut read[axis], value).unwrap();
        }
        assert_eq!(read, parameters);
    }
}
