//! Writes a file of limits.

use super::{POSITIONS, RATES, joint_name, limit};
use crate::cell::Cell;
use lineshaft_core::config::AxisConfig;
use std::fmt::Write;

/// Words that a YAML 1.1 reader does not treat as names.
const WORDS: [&str; 9] = ["true", "false", "yes", "no", "on", "off", "null", "y", "n"];

const HEAD: &str = "\
# Limits of joints in SI units, for MoveIt: written by `lineshaft limits` from the cell. max_acceleration is the lower of max_acceleration and
# max_deceleration of the axis.

# What a plan uses of them where the request does not say; 0.1 is MoveIt's own default.
default_velocity_scaling_factor: 0.1
default_acceleration_scaling_factor: 0.1

joint_limits:
";

/// Returns `joint_limits.yaml` of the axes with these indices.
pub fn limits_text(cell: &Cell, places: &[usize]) -> String {
    let mut text = HEAD.to_owned();
    for (place, axis) in places.iter().filter_map(|place| Some((*place, cell.machine.axes.get(*place)?))) {
        joint(&mut text, joint_name(cell, place), axis);
    }
    text
}

fn joint(text: &mut String, name: &str, axis: &AxisConfig) {
    // Writing to a string cannot fail.
    let _ = writeln!(text, "  {}:", name_text(name));
    let positions = POSITIONS.map(|key| (key, limit(axis, key)));
    let has_positions = positions.iter().any(|(_, limit)| limit.is_some());
    let _ = writeln!(text, "    has_position_limits: {has_positions}");
    positions.into_iter().for_each(|(key, limit)| line(text, key, limit));
    for (has, key) in RATES {
        let limit = limit(axis, key);
        let _ = writeln!(text, "    {has}: {}", limit.is_some());
        line(text, key, limit);
    }
}

fn line(text: &mut String, key: &str, limit: Option<f64>) {
    if let Some(limit) = limit {
        let _ = writeln!(text, "    {key}: {}", number_text(limit));
    }
}

/// Formats a YAML key.
pub(super) fn name_text(name: &str) -> String {
    let is_plain = name.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_')
        && name.chars().all(|c| c.is_ascii_alphanumeric() || "_/-.".contains(c))
        && !WORDS.iter().any(|word| word.eq_ignore_ascii_case(name));
    // Joint names have no control characters.
    let quoted = || format!("\"{}\"", name.replace('\\', "\\\\").replace('"', "\\\""));
    if is_plain { name.to_owned() } else { quoted() }
}

/// Formats a number, always with a decimal point, because a ROS parameter without one is an integer, which MoveIt
/// refuses; and with a sign in the exponent, as YAML 1.1 requires.
pub(super) fn number_text(number: f64) -> String {
    let text = format!("{number:?}");
    let Some((mantissa, exponent)) = text.split_once('e') else { return text };
    let point = if mantissa.contains('.') { "" } else { ".0" };
    let sign = if exponent.starts_with('-') { "" } else { "+" };
    format!("{mantissa}{point}e{sign}{exponent}")
}
