//! Messages of refused parameter sets.

use super::{allowed_text, number_text, parameter_value, refused_text, row, scale_of, value_of};
use crate::config::{MachineConfig, max_of_row};
use crate::event::{Event, Number};
use crate::parameter::{Refused, Row, Value};

pub(super) fn key(event: &Event) -> &'static str {
    row(event).map_or("parameter", |row| row.key)
}

pub(super) fn not_built(event: &Event, config: &MachineConfig) -> String {
    match row(event) {
        Some(row) if !row.missing.is_empty() => refused(event, row, Refused::NotBuilt, config),
        Some(row) => {
            let value = parameter_value(row, event.asked, event.source, config);
            format!("{} {value} does not exist yet", row.key)
        }
        None => "this does not exist yet".to_owned(),
    }
}

pub(super) fn reverse_forbidden(event: &Event, config: &MachineConfig) -> String {
    let asked = || number_text(event.asked, event.source, config);
    match event.asked {
        Number::Position(_) => format!("the way to {} leads backwards, which revers forbids", asked()),
        Number::Velocity(_) => {
            format!("velocity {} leads backwards, which revers forbids; 0 or more is allowed", asked())
        }
        _ => "the motion leads backwards, which revers forbids; the axis waits".to_owned(),
    }
}

pub(super) fn read_only(event: &Event, config: &MachineConfig) -> String {
    row(event).map_or("the parameter is read-only".to_owned(), |row| refused(event, row, Refused::ReadOnly, config))
}

pub(super) fn refused(event: &Event, row: &Row, why: Refused, config: &MachineConfig) -> String {
    let highest = match event.limit {
        Number::Velocity(highest) => Some(highest),
        _ => max_of_row(row, config.cycle_ns),
    };
    refused_text(row, why, value_of(event.asked), &scale_of(event.source, config), highest)
}

pub(super) fn not_disabled(event: &Event, config: &MachineConfig) -> String {
    let axis = config.name(event.source);
    match row(event) {
        Some(row) => {
            let value = parameter_value(row, event.asked, event.source, config);
            format!("{} becomes {value} only while {axis} is disabled", row.key)
        }
        None => {
            format!("{axis} is not disabled; the power goes only where all axes are disabled and virtual ones stand")
        }
    }
}

pub(super) fn out_of_range(event: &Event, config: &MachineConfig) -> String {
    let Some(row) = row(event) else { return "a parameter is outside its range".to_owned() };
    let value = parameter_value(row, event.asked, event.source, config);
    match event.limit {
        Number::None => refused(event, row, Refused::OutOfRange, config),
        // The limit of the cycle time is below that of the row.
        limit => match (row.root(), limit) {
            ("max_velocity", _) if !row.is_view() => refused(event, row, Refused::OutOfRange, config),
            (_, Number::Velocity(highest)) => {
                let highest = scale_of(event.source, config).format_bound(highest, 1, true);
                format!("{} {value} makes max_velocity more than {highest}, the most that a cycle can do", row.key)
            }
            _ => format!("{} {value} makes max_velocity more than a cycle can do", row.key),
        },
    }
}

pub(super) fn given_twice(event: &Event, config: &MachineConfig) -> String {
    let Some(row) = row(event) else { return "a value stands twice in the set".to_owned() };
    let [value, other] = [event.asked, event.limit].map(|number| parameter_value(row, number, event.source, config));
    format!("{} {value} stands twice in the set: another line makes it {other}; give it once", row.key)
}

/// Returns the value of a parameter and the value it was compared with, with enough digits to differ.
fn distinct_values(event: &Event, row: &Row, config: &MachineConfig) -> (String, String) {
    let value = parameter_value(row, event.asked, event.source, config);
    let limit = number_text(event.limit, event.source, config);
    if value != limit || event.asked == event.limit {
        return (value, limit);
    }
    let scale = scale_of(event.source, config);
    let precise = |number, usual| match number {
        Number::Velocity(rate) => scale.format_rate_precisely(rate, 1),
        Number::Acceleration(rate) => scale.format_rate_precisely(rate, 2),
        Number::Jerk(rate) => scale.format_rate_precisely(rate, 3),
        _ => usual,
    };
    (precise(event.asked, value), precise(event.limit, limit))
}

/// Returns the message of two values that contradict each other, or of a value that moves another one out of its range.
pub(super) fn contradict(event: &Event, config: &MachineConfig) -> String {
    let Some(row) = row(event) else { return "the parameters contradict each other".to_owned() };
    let (value, limit) = distinct_values(event, row, config);
    let derived = match event.limit {
        Number::Velocity(value) => Some(("max_velocity", value)),
        Number::Acceleration(value) => Some(("max_acceleration", value)),
        Number::Jerk(value) => Some(("max_jerk", value)),
        _ => None,
    };
    if let Some((native, number)) = derived
        && let Some((_, native)) = Row::find(native)
        && native.check(Value::Real(number)).is_err()
    {
        let range = allowed_text(native, &scale_of(event.source, config), max_of_row(native, config.cycle_ns));
        return format!("{} {value} makes {} {limit}; {range} is allowed", row.key, native.key);
    }
    // A value that MACS gives as a fraction or a count is reported together with the value of MACS.
    let key = match (row.key, event.limit) {
        ("neglimit" | "poslimit" | "swneglimact" | "swposlimact", _) => row.key,
        ("dfltvel" | "dfltacc" | "home_vel" | "home_ramp", Number::Count(_)) => row.key,
        _ => row.root(),
    };
    let other = match key {
        "dfltvel" | "dfltacc" | "home_vel" | "home_ramp" => "must not exceed velres",
        "velres" => "must not be below dfltvel, dfltacc, home_vel or home_ramp",
        "homing.velocity" | "homing.index_velocity" | "compensation.velocity" => "must not exceed max_velocity",
        "neglimit" => "must be below poslimit",
        "poslimit" => "must be above neglimit",
        "swneglimact" => "puts neglimit in force, which must be below poslimit",
        "swposlimact" => "puts poslimit in force, which must be above neglimit",
        "min_position" => "must be below max_position",
        "max_position" => "must be above min_position",
        "default_velocity" => "must not exceed max_velocity",
        "max_velocity" => {
            "must not be below default_velocity, homing.velocity, homing.index_velocity or compensation.velocity:"
        }
        "default_acceleration" => "must not exceed max_acceleration",
        "max_acceleration" => "must not be below default_acceleration",
        "wf.md1" => "must not exceed max_acceleration",
        "wf.md2" => "must not exceed the largest deceleration",
        key if key.starts_with("wf.") => "breaks the falling order of the steps beside",
        _ => "contradicts the other parameters of the axis:",
    };
    format!("{} {value} {other} {limit}", row.key)
}
