//! The parameters in force as a text that stands in a bag.

use lineshaft_core::config::MachineConfig;
use lineshaft_core::parameter::{AxisParameters, Measure, ROWS, Row, Value};
use std::fmt::Write;

/// Every parameter of every axis in increments, exactly: a line `x.max_velocity: 125829120 inc/s` for each. What is left
/// out is `~`, with what that means.
pub fn parameters_text(config: &MachineConfig, parameters: &[AxisParameters]) -> String {
    let mut text = String::new();
    for (axis, parameters) in config.axes.iter().zip(parameters) {
        for row in ROWS {
            // Writing to a text cannot fail.
            let _ = writeln!(text, "{}.{}: {}", axis.name, row.key, value_text(row, parameters));
        }
    }
    text
}

fn value_text(row: &Row, parameters: &AxisParameters) -> String {
    let unit = match row.measure {
        Measure::Position | Measure::Distance => " inc",
        Measure::Velocity => " inc/s",
        Measure::Acceleration => " inc/s^2",
        Measure::Jerk => " inc/s^3",
        Measure::Time => " ns",
        Measure::Integer | Measure::Number | Measure::Choice(_) => "",
    };
    match ((row.get)(parameters), row.measure) {
        (Value::Unset, _) => format!("~ # {}", row.default_text),
        (Value::Int(value), Measure::Choice(names)) => usize::try_from(value)
            .ok()
            .and_then(|place| names.get(place))
            .map_or_else(|| value.to_string(), |name| (*name).to_owned()),
        (Value::Int(value), _) => format!("{value}{unit}"),
        // The shortest decimal that reads back as the same number.
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
        let text = parameters_text(&cell.machine, &defaults(&cell));
        assert_eq!(text.lines().count(), 4 * ROWS.len());
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

    /// What stands behind the colon is what `set_parameters` and a cell take, so nothing is lost in the text.
    #[test]
    fn the_text_gives_the_same_parameters_again() {
        use lineshaft_core::parameter::{ParameterInput, convert};
        use lineshaft_core::unit::Quantity;
        let cell = Cell::demo();
        let mut parameters = defaults(&cell);
        parameters[1].max_velocity = 0.1 + 0.2;
        parameters[1].max_jerk = Some(1e15);
        parameters[1].max_acceleration = 123_456_789.123_456_7;
        let text = parameters_text(&cell.machine, &parameters);
        let mut read = defaults(&cell);
        for line in text.lines() {
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
