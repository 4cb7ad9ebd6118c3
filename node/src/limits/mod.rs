//! Converts limits of joints between a cell and MoveIt's `joint_limits.yaml`.
//!
//! Law      `min_position`, `max_position`, `max_velocity` and `max_jerk` are those of the axis in SI units;
//!          `max_acceleration` is the lower of its `max_acceleration` and `max_deceleration`, because MoveIt has one
//!          limit for both. Writing and reading a file changes nothing
//! Reads    a cell; a file of limits
//! Writes   a file of limits; parameters to be set in the cell ([`cell_file`](crate::cell_file))
//! Refuses  values that MoveIt would not read, or would read with another meaning, and values that the axis does not
//!          permit; all at once, with their lines
//! Source   moveit_ros `robot_model_loader.cpp`, which reads these keys below `robot_description_planning`

mod read;
mod text;

pub use read::read_limits;
pub use text::limits_text;

use crate::cell::Cell;
use lineshaft_core::config::AxisConfig;
use lineshaft_core::parameter::{ConvertError, ParameterInput, Row, Value, convert};

/// Rates of a joint that MoveIt may limit, with the keys of the axis. For positions MoveIt ignores the key `has_..`:
/// their limits apply if they are given.
const RATES: [(&str, &str); 3] = [
    ("has_velocity_limits", "max_velocity"),
    ("has_acceleration_limits", "max_acceleration"),
    ("has_jerk_limits", "max_jerk"),
];
const POSITIONS: [&str; 2] = ["min_position", "max_position"];

/// Returns the joints of a cell, or of one of its groups, as indices of axes. Virtual axes are no joints, because no
/// joint state message has them.
///
/// # Errors
/// Returns an error message if there is no such group.
pub fn joints(cell: &Cell, group: Option<&str>) -> Result<Vec<usize>, String> {
    let is_joint = |place: &usize| cell.machine.axes.get(*place).is_some_and(|axis| axis.drive.is_some());
    let Some(name) = group else { return Ok((0..cell.machine.axes.len()).filter(is_joint).collect()) };
    let Some(group) = cell.groups.iter().find(|group| group.name == name) else {
        let known: Vec<&str> = cell.groups.iter().map(|group| group.name.as_str()).collect();
        let known =
            if known.is_empty() { "the cell has none".to_owned() } else { format!("there are {}", known.join(", ")) };
        return Err(format!("no group is called `{}`; {known}", lineshaft_core::unit::excerpt(name)));
    };
    Ok(group.axes.iter().map(|place| usize::from(*place)).collect())
}

/// Returns the joint name of the axis with that index.
fn joint_name(cell: &Cell, place: usize) -> &str {
    u16::try_from(place).map_or("", |place| cell.joint_names.get(place))
}

/// Returns a limit of an axis in SI units for the file; `None` if the axis has none.
fn limit(axis: &AxisConfig, key: &str) -> Option<f64> {
    let parameters = &axis.parameters;
    let rate = |rate: f64, order: u8| {
        // The shortest number that is read back as this rate; in rad there may be none.
        let exact = axis.scale.rate_to_si(rate);
        let mut rounded = (0..=16).filter_map(|digits| format!("{exact:.digits$e}").parse().ok());
        rounded.find(|number| axis.scale.rate_from_si(*number, order) == Ok(rate)).unwrap_or(exact)
    };
    let position = |position: i64| axis.scale.position_to_si(position, 0.0);
    match key {
        "min_position" => parameters.min_position.map(position),
        "max_position" => parameters.max_position.map(position),
        "max_velocity" => Some(rate(parameters.max_velocity, 1)),
        "max_acceleration" => Some(rate(parameters.max_acceleration.min(parameters.deceleration_limit()), 2)),
        "max_jerk" => parameters.max_jerk.map(|jerk| rate(jerk, 3)),
        _ => None,
    }
}

/// Converts a limit in SI units to a parameter of an axis.
fn value_of(axis: &AxisConfig, key: &str, number: f64) -> Result<Value, ConvertError> {
    let (_, row) = Row::find(key).ok_or_else(|| ConvertError::Type(key.to_owned()))?;
    convert(row, &axis.scale, &ParameterInput::Number(number))
}

#[cfg(test)]
mod tests;
