//! Messages of events, generated outside the cycle from their numbers.
//!
//! Every message names the object, the requested or found value, and the allowed one, in the units of the axis.

use crate::axis::{INDEX, STREAM};
use crate::code::Code;
use crate::config::MachineConfig;
use crate::event::{Event, Kind, Number};
use crate::object::Object;
use crate::parameter::{ROWS, Row, Value};
use crate::state::AXIS_STATES;
use crate::unit::{Scale, number_to_text};

mod function;
mod parameter;
mod reason;
mod set;
mod trajectory;

pub use parameter::{allowed_text, expected_text, outside_text, pair_text, range_text, refused_text, value_text};
pub use trajectory::pair_in_si;

use reason::reason;

/// Returns the message of an event.
pub fn message(event: &Event, config: &MachineConfig) -> String {
    let name = config.name(event.source);
    let text = match event.kind {
        Kind::Accepted => "accepted".to_owned(),
        Kind::State if matches!(event.source, Object::Function(_)) => function::state(event, config),
        Kind::State => format!("now {}", state_name(event.asked)),
        Kind::Parameter => changed(event, config),
        Kind::Latch => latched(event, config),
        Kind::Mark => marked(event, config),
        Kind::Overrun => format!("{} cycles missed", plain(event.asked)),
        Kind::Homed => {
            format!("zero found at {} of the coordinate before", number_text(event.asked, event.source, config))
        }
        Kind::Reset => format!("reset after: {}", reason(event, config)),
        Kind::Done if event.code.is_none() => "done".to_owned(),
        Kind::Done if function::is_axis_error(event) => function::axis_error(event),
        Kind::Warning if row(event).is_some_and(|row| row.key == STREAM) => {
            format!("streamed setpoints are not followed: {}", reason(event, config))
        }
        _ => reason(event, config),
    };
    format!("{name}: {text}")
}

/// Returns a message for the log: with the code of its event and the remedy,
/// `x: .. (10205). Check the supply of the drive.` A remedy with which the message already ends is not repeated.
pub fn with_remedy(sentence: &str, code: Code) -> String {
    let ends_with = |remedy: &str| sentence.to_lowercase().ends_with(&remedy.trim_end_matches('.').to_lowercase());
    match code.row() {
        _ if code.is_none() => sentence.to_owned(),
        Some(row) if !ends_with(row.remedy) => format!("{sentence} ({}). {}", code.0, row.remedy),
        _ => format!("{sentence} ({})", code.0),
    }
}

fn state_name(number: Number) -> &'static str {
    match number {
        Number::Count(state) => AXIS_STATES.get(state.unsigned_abs() as usize).copied().unwrap_or("?"),
        _ => "?",
    }
}

fn row(event: &Event) -> Option<&'static Row> {
    // For a function it is a field.
    if matches!(event.source, Object::Function(_)) {
        return None;
    }
    ROWS.get(usize::from(event.parameter?))
}

fn changed(event: &Event, config: &MachineConfig) -> String {
    if let Some(found) = function::found(event, config) {
        return found;
    }
    let Some(row) = row(event) else { return "parameter changed".to_owned() };
    let value = parameter_value(row, event.asked, event.source, config);
    format!("{} is {value}, effective {}", row.key, row.effect.text())
}

fn parameter_value(row: &Row, number: Number, source: Object, config: &MachineConfig) -> String {
    value_text(row, value_of(number), &scale_of(source, config))
}

/// Converts the number of an event to a parameter value.
fn value_of(number: Number) -> Value {
    match number {
        Number::None => Value::Unset,
        Number::Position(value) | Number::Count(value) | Number::Time(value) => Value::Int(value),
        Number::Velocity(value) | Number::Acceleration(value) | Number::Jerk(value) | Number::Real(value) => {
            Value::Real(value)
        }
    }
}

/// Returns the scale in which the parameters of an object are written.
fn scale_of(source: Object, config: &MachineConfig) -> Scale {
    let axis = match source {
        Object::Axis(index) => config.axes.get(usize::from(index)),
        _ => None,
    };
    axis.map_or(Scale::increments(), |axis| axis.scale)
}

fn latched(event: &Event, config: &MachineConfig) -> String {
    let edge = if event.asked == Number::Count(1) { "rising" } else { "falling" };
    // A touch probe names its latch.
    if let Number::Count(source) = event.limit {
        let name = Object::from_number(source).map_or("its trigger", |source| config.name(source));
        let position = number_text(Number::Position(event.position.floor()), event.source, config);
        let what = if event.asked == Number::Count(INDEX) { "index pulse".to_owned() } else { format!("{edge} edge") };
        return format!("touch probe: {what} of {name} at {position}, {} us before the cycle", event.age_ns / 1000);
    }
    match event.source {
        Object::Axis(_) | Object::Encoder(_) => {
            let position = number_text(Number::Position(event.position.floor()), event.source, config);
            format!("{edge} edge at {position}, {} us before the cycle", event.age_ns / 1000)
        }
        _ => format!("{edge} edge, {} us before the cycle", event.age_ns / 1000),
    }
}

fn marked(event: &Event, config: &MachineConfig) -> String {
    if let (Number::Real(error), Number::Real(correction)) = (event.asked, event.limit) {
        // Three decimals are as fine as any drive can position.
        return format!("marks {error:.3} inc apart, corrected by {correction:.3} inc");
    }
    let position = number_text(Number::Position(event.position.floor()), event.source, config);
    format!("mark at {position}, {} us before the cycle", event.age_ns / 1000)
}

/// Returns a number in the units of its object.
fn number_text(number: Number, source: Object, config: &MachineConfig) -> String {
    let scale = match source {
        Object::Axis(index) => config.axes.get(usize::from(index)).map(|axis| &axis.scale),
        Object::Encoder(index) => config.encoders.get(usize::from(index)).map(|encoder| &encoder.scale),
        _ => None,
    };
    match (number, scale) {
        (Number::Position(value), Some(scale)) => scale.format_increments(value),
        (Number::Velocity(value), Some(scale)) => scale.format_rate(value, 1),
        (Number::Acceleration(value), Some(scale)) => scale.format_rate(value, 2),
        (Number::Jerk(value), Some(scale)) => scale.format_rate(value, 3),
        (number, _) => plain(number),
    }
}

fn plain(number: Number) -> String {
    match number {
        Number::None => "nothing".to_owned(),
        Number::Position(value) => format!("{value} inc"),
        Number::Count(value) => value.to_string(),
        Number::Time(value) => format!("{} ms", value as f64 / 1e6),
        Number::Velocity(value) => format!("{} inc/s", number_to_text(value)),
        Number::Acceleration(value) => format!("{} inc/s^2", number_to_text(value)),
        Number::Jerk(value) => format!("{} inc/s^3", number_to_text(value)),
        Number::Real(value) => number_to_text(value),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::event::{Event, Severity};

    /// 100 mm/s and 1e-9 of it more: nine digits are the same.
    #[test]
    fn a_limit_and_what_exceeds_it_have_as_many_digits_as_tell_them_apart() {
        let config = crate::machine::rig::config(0);
        let event = Event::new(Severity::Warn, Kind::Refused, Object::Axis(1), Code::VELOCITY_TOO_HIGH);
        let of = |asked| message(&event.with(Number::Velocity(asked), Number::Velocity(100_000.0)), &config);
        assert_eq!(of(100_000.000_1), "x: velocity 100.0000001 mm/s exceeds max_velocity 100 mm/s");
        assert_eq!(of(120_000.0), "x: velocity 120 mm/s exceeds max_velocity 100 mm/s");
        assert_eq!(of(100_000.0), "x: velocity 100 mm/s exceeds max_velocity 100 mm/s");
        let event = Event::new(Severity::Warn, Kind::Refused, Object::Axis(1), Code::PARAMETERS_CONTRADICT);
        let event = Event { parameter: Some(Row::place("default_velocity")), ..event };
        let of = |asked| message(&event.with(Number::Velocity(asked), Number::Velocity(100_000.0)), &config);
        assert_eq!(of(100_000.000_1), "x: default_velocity 100.0000001 mm/s must not exceed max_velocity 100 mm/s");
    }

    #[test]
    fn line_of_the_log_has_code_and_remedy_and_is_one_line() {
        assert_eq!(with_remedy("machine: accepted", Code::NONE), "machine: accepted");
        assert_eq!(with_remedy("x: odd", Code(777)), "x: odd (777)");
        let off = "x: the axis is not enabled; enable it first";
        assert_eq!(with_remedy(off, Code::NOT_ENABLED), format!("{off} (10007)"));
        let drive = with_remedy("x: the drive reports 0x8611", Code::drive_fault(0x8611));
        assert!(drive.starts_with("x: the drive reports 0x8611 (99857). Look the code up in the manual"), "{drive}");
        for row in Code::rows().filter(|row| !row.code.is_none()) {
            let line = with_remedy("x: s", row.code);
            assert_eq!(line, format!("x: s ({}). {}", row.code.0, row.remedy), "{}", row.name);
            assert!(!line.contains('\n'), "{}", row.name);
        }
    }

    #[test]
    fn every_code_has_a_sentence_of_its_own() {
        let config = MachineConfig::default();
        let mut seen = std::collections::BTreeSet::new();
        for row in Code::rows().filter(|row| !row.code.is_none() && row.code != Code::OVERRUN) {
            let (name, event) = (row.name, Event::new(Severity::Warn, Kind::Refused, Object::Machine, row.code));
            let sentence = message(&event, &config);
            assert!(!sentence.contains("code "), "{name}: {sentence}");
            assert!(seen.insert(sentence.clone()), "{name} says the same as another: {sentence}");
        }
    }

    #[test]
    fn note_of_recorder_has_its_number() {
        let text = |code, number| {
            let event = Event::new(Severity::Warn, Kind::Warning, Object::Machine, code);
            message(&event.with(Number::Count(number), Number::None), &MachineConfig::default())
        };
        let missing = "missing, the recorder or the disk did not keep up; no replay goes beyond them";
        assert_eq!(text(Code::RECORD_LOST, 12), format!("machine: recording: 12 cycles are {missing}"));
        assert_eq!(text(Code::RECORD_LOST, 1), format!("machine: recording: 1 cycle is {missing}"));
        for (number, reason) in [
            (28, "no space left on device (system error 28)"),
            (5, "input/output error (system error 5)"),
            (30, "the file system is read-only (system error 30)"),
            (122, "disk quota exceeded (system error 122)"),
            (27, "the file is too large (system error 27)"),
            (13, "permission denied (system error 13)"),
            (71, "system error 71"),
            (0, "the system does not say why"),
        ] {
            assert_eq!(text(Code::RECORD_FAILED, number), format!("machine: recording stopped: {reason}"));
        }
        let sentence = "machine: the flight recorder saved no bag: no such file or folder (system error 2)";
        assert_eq!(text(Code::FLIGHT_FAILED, 2), sentence);
    }

    #[test]
    fn step_of_the_system_clock_is_reported_with_direction_and_size() {
        let text = |step_ns| {
            let event = Event::new(Severity::Warn, Kind::Warning, Object::Machine, Code::CLOCK_STEPPED);
            message(&event.with(Number::Count(step_ns), Number::None), &MachineConfig::default())
        };
        for (step_ns, size) in [
            (3_600_000_499_999, "forward by 3600.000 s"),
            (4_999_500_000, "forward by 5.000 s"),
            (-3_600_000_000_000, "back by 3600.000 s"),
            (-200_400_000, "back by 0.200 s"),
            (i64::MAX, "forward by 9223372036.855 s"),
            (i64::MIN, "back by 9223372036.855 s"),
        ] {
            assert_eq!(text(step_ns), format!("machine: the system clock was set {size}; stamps follow"));
        }
    }

    /// For a value that is set through another name, the message contains both the given and the resulting value.
    #[test]
    fn derived_value_is_reported_with_given_value() {
        let text = |code, key, asked, limit| {
            let event = Event::new(Severity::Warn, Kind::Refused, Object::Machine, code).with(asked, limit);
            let parameter = Row::find(key).map(|(row, _)| row);
            message(&Event { parameter, ..event }, &MachineConfig::default())
        };
        let (speed, ramp) = (Number::Velocity(2.0), Number::Acceleration(2e15));
        assert_eq!(
            text(Code::PARAMETERS_CONTRADICT, "rampmin", Number::Time(1_000_000), ramp),
            "machine: rampmin 1 ms makes max_acceleration 2000000000000000 inc/s^2; \
             more than 0 up to 1000000000000000 inc/s^2 is allowed"
        );
        assert_eq!(
            text(Code::PARAMETERS_CONTRADICT, "dfltvel", Number::Count(150), speed),
            "machine: dfltvel 150 must not exceed max_velocity 2 inc/s"
        );
        assert_eq!(
            text(Code::PARAMETER_OUT_OF_RANGE, "velmax", Number::Real(7.0), speed),
            "machine: velmax 7 makes max_velocity more than 2 inc/s, the most that a cycle can do"
        );
        assert_eq!(
            text(Code::PARAMETER_OUT_OF_RANGE, "max_velocity", Number::Velocity(3.0), speed),
            "machine: max_velocity is 3 inc/s; more than 0 up to 2 inc/s is allowed"
        );
        // The range is the same whether the row or the cycle time limits it.
        let config = MachineConfig { cycle_ns: 1_000_000, ..MachineConfig::default() };
        let event = Event::new(Severity::Warn, Kind::Refused, Object::Machine, Code::PARAMETER_OUT_OF_RANGE);
        let parameter = Row::find("max_velocity").map(|(row, _)| row);
        for limit in [Number::None, Number::Velocity(2_147_483_648_000.0)] {
            let event = Event { parameter, ..event.with(Number::Velocity(2e15), limit) };
            assert_eq!(
                message(&event, &config),
                "machine: max_velocity is 2000000000000000 inc/s; more than 0 up to 2147483648000 inc/s is allowed"
            );
        }
    }

    #[test]
    fn a_drive_fault_shows_its_603f_code() {
        let event = Event::new(Severity::Error, Kind::Error, Object::Machine, Code::drive_fault(0x8611));
        assert_eq!(message(&event, &MachineConfig::default()), "machine: drive fault 8611h");
    }
}
