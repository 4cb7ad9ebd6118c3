//! Why something was refused, ended or failed: the sentence of each code, by its row or, where the event has to be looked at, here.

use super::set::{contradict, given_twice, key, not_built, not_disabled, out_of_range, read_only, reverse_forbidden};
use super::{function, number_text, plain, row, scale_of, trajectory};
use crate::axis::homing_methods::SWITCHES;
use crate::axis::{COORDINATE_USES, Fallback, fallback};
use crate::code::{Code, Row, not_built_here};
use crate::config::{MachineConfig, missing_io_text};
use crate::drive::{DriveState, ForeignEmergency, NodeNotice, NotEnabled, error_text, register_texts};
use crate::event::{Event, Kind, Number};
use crate::object::Object;
use crate::parameter::VirtualMasterProblem;
use crate::state::AxisState;
use crate::sync::gear::Ratio;
use crate::vocabulary::saia::Register;

fn virtual_master(event: &Event) -> String {
    let count = |number| if let Number::Count(count) = number { count } else { 0 };
    let (value, limit) = (count(event.asked), count(event.limit));
    VirtualMasterProblem { key: key(event), value, code: event.code, limit }.to_string()
}

/// A ratio that is none, with the part that makes it so: of the parameters, or of the request.
fn bad_ratio(event: &Event) -> Option<String> {
    let (Number::Count(slave), Number::Count(master)) = (event.asked, event.limit) else { return None };
    let names = if event.parameter.is_some() { ["syncfacts", "syncfactm"] } else { ["numerator", "denominator"] };
    let mut parts = names.into_iter().zip([slave, master]);
    let (name, value) = parts.find(|(_, part)| Ratio::new(*part, 1).is_none())?;
    let rule = "both parts must not be 0 and stay below 2^62";
    Some(format!("ratio {slave} : {master} is none, as {name} is {value}; {rule}"))
}

/// What is wrong with a refused value, by the row of its code.
fn refused_value(event: &Event) -> String {
    format!("{} {} {}", key(event), plain(event.asked), not_built_here(event.code))
}

/// Why something was refused, ended or failed.
pub(super) fn reason(event: &Event, config: &MachineConfig) -> String {
    let asked = || number_text(event.asked, event.source, config);
    let limit = || number_text(event.limit, event.source, config);
    let fixed = |text: &str| text.to_owned();
    let by_row = || {
        let says = event.code.row().map_or_else(String::new, |row| filled(row.says, event, config));
        function::of_field(event, config, says)
    };
    if let Some(text) = function::reason(event, config) {
        return text;
    }
    if let Some(text) = event.place.and_then(|place| trajectory::reason(event, &place, config)) {
        return text;
    }
    match event.code {
        Code::LIMIT_VIOLATION if event.limit == Number::None && event.kind == Kind::Refused => {
            let is = |code: Code| event.asked == Number::Count(code.0.into());
            match () {
                () if is(Code::BOTH_LIMIT_SWITCHES) => fixed("both limit switches are actuated; neither way is open"),
                () if is(Code::HARDWARE_LIMIT_NEGATIVE) => {
                    fixed("the negative limit switch is actuated; only the way back is open")
                }
                () => fixed("the positive limit switch is actuated; only the way back is open"),
            }
        }
        Code::LIMIT_VIOLATION if event.limit == Number::None => fixed("motion towards an actuated limit switch"),
        Code::STOPPED_WITH_OTHER => match event.asked {
            Number::Count(axis) if matches!(event.kind, Kind::Error | Kind::Reset) => {
                let other = u16::try_from(axis).map_or("another axis", |axis| config.name(Object::Axis(axis)));
                format!("stopped, because {other} has a following error")
            }
            _ => by_row(),
        },
        Code::WF_BAD_SPEED => format!(
            "{} {} is not allowed; above 0 up to {} is, in open loop as a whole number",
            row(event).map_or("speed value", |row| row.key),
            asked(),
            limit()
        ),
        Code::SAIA_REGISTER_OUT_OF_RANGE => match Register::ALL.iter().find(|(_, name)| *name == key(event)) {
            Some((register, name)) => {
                let (low, high) = register.permitted().unwrap_or_default();
                format!("{name} is {}; {low} to {high} is allowed", plain(event.asked))
            }
            None => by_row(),
        },
        Code::SAIA_BAD_STOP_BITS => {
            let Number::Count(bits) = event.asked else {
                return by_row();
            };
            format!(
                "saia.mcw has {bits:03b} in bits 10 to 8; fstop needs exactly one of them (001 off, 010 hard, 100 ramp)"
            )
        }
        Code::SAIA_BAD_REACTION => {
            let Number::Count(byte) = event.asked else {
                return by_row();
            };
            format!("saia.mcw has {byte:02X}H in bits 0 to 7; 1BH (flag) or 1AH (flag and regulator off) is allowed")
        }
        Code::SAIA_ACCELERATION_ABOVE_VELOCITY if event.limit == Number::Count(0) => {
            fixed("the velocity register is 0; fldva has to load one first")
        }
        Code::POSITION_OUT_OF_RANGE if event.limit != Number::None => {
            format!("at position {} a software limit would be {}, which is outside +-2^62 increments", asked(), limit())
        }
        Code::MARK_NO_INPUT => format!(
            "{} names digital input {}, which the cell does not have, or which has not latch: true",
            mark_key(event.limit),
            asked()
        ),
        Code::MARK_NO_INDEX => format!(
            "{} {} asks for an index pulse that there is not: type 0 is that of an incremental encoder with key index, or of the drive of the axis \
             with sim: {{index: ..}}, on CAN with probe_1 or probe_2: index, and its place is one; 2 and 3 are edges of an input",
            mark_key(event.limit),
            asked()
        ),
        Code::BAD_RATIO => bad_ratio(event).unwrap_or_else(by_row),
        Code::MARK_MISSED => format!("a mark of the {} has stayed away", mark_side(event.asked)),
        Code::MARK_EXTRA => format!("a mark of the {} came outside its window", mark_side(event.asked)),
        Code::SMOOTH_START_FALLBACK => smooth_start_fallback(event),
        Code::VIRTUAL_MASTER_SOURCE | Code::VIRTUAL_MASTER_NO_RAMP => virtual_master(event),
        Code::LEADER_LOOP if key(event) == "vmenctyp" => format!(
            "vmenctyp {} names an axis that follows the virtual master itself; one that does not is allowed",
            plain(event.asked)
        ),
        Code::LEADER_LOOP | Code::NO_MASTER | Code::ANALOG_COASTS if event.parameter.is_some() => refused_value(event),
        Code::NOT_BUILT => not_built(event, config),
        Code::READ_ONLY => read_only(event, config),
        Code::NOT_DISABLED => not_disabled(event, config),
        Code::REVERSE_FORBIDDEN => reverse_forbidden(event, config),
        // What is missing has no value.
        Code::EFFORT_MISSING | Code::CURRENT_LOOP => format!("{} {}", key(event), not_built_here(event.code)),
        Code::NO_SUCH_INPUT | Code::NO_SUCH_OUTPUT => {
            missing_io_text(key(event), &plain(event.asked), event.code == Code::NO_SUCH_OUTPUT, &plain(event.limit))
        }
        Code::OUTPUT_TAKEN => {
            let owner = match event.limit {
                Number::Count(axis) => u16::try_from(axis).ok().map(|axis| config.name(Object::Axis(axis))),
                _ => None,
            };
            let (owner, asked) = (owner.unwrap_or("an axis"), plain(event.asked));
            format!("{asked} may not be set, nor any value: {owner} switches this output by itself")
        }
        Code::PARAMETER_OUT_OF_RANGE => out_of_range(event, config),
        Code::PARAMETERS_CONTRADICT => contradict(event, config),
        Code::GIVEN_TWICE => given_twice(event, config),
        Code::TOO_MANY_WAITING if event.kind == Kind::Done => {
            fixed("it is being done, but too many wait already to be told its end")
        }
        Code::COORDINATE_IN_USE => {
            let place = if let Number::Count(place) = event.asked { usize::try_from(place).ok() } else { None };
            match place.and_then(|place| COORDINATE_USES.get(place)) {
                Some(what) => {
                    format!("{what} refers to the present coordinate of the axis; wait for its end, or end it first")
                }
                None => by_row(),
            }
        }
        Code::NOT_AT_STANDSTILL => not_at_standstill(event.asked),
        Code::HOMING_UNKNOWN_METHOD if event.limit == Number::None => {
            format!("scheme cia402 has no homing method {}; 1 to 14, 17 to 30, 33, 34, 35 and 37 are allowed", asked())
        }
        Code::HOMING_NO_SWITCH if event.limit != Number::None => unread_switch(event),
        Code::HOMING_NO_SWITCH => format!(
            "i_refswitch is 0, and {} needs a reference switch; n or -n, the n-th digital input, is allowed",
            method(event.asked)
        ),
        Code::GANTRY_HOMING if event.parameter.is_none() => {
            let allowed = "3 to 14, 19 to 30, 35, 37 and home_type 0 to 3 are allowed";
            format!("{} does not square an axis with two drives; {allowed}", method(event.asked))
        }
        Code::NOT_SQUARE if event.asked == Number::None => fixed(
            "the reference switch of one drive did not come with that of the other, so that nothing shows what is square",
        ),
        Code::HOMING_NEEDS_DRIVE => match event.asked {
            Number::None => by_row(),
            asked => {
                format!("the axis is virtual, without switches and index for {}; 35 and 37 are allowed", method(asked))
            }
        },
        Code::HOMING_NOT_IN_DRIVE => format!(
            "homing.in_drive is true, and the drive has no {}; methods of CiA 402 are allowed",
            method(event.asked)
        ),
        Code::PROBE_INPUT_ACTIVE => match (event.asked, event.limit) {
            (Number::Count(input), Number::Count(level)) => {
                let name = u16::try_from(input).map_or("the input", |input| config.name(Object::Io(input)));
                let edge = if level == 0 { "falling" } else { "rising" };
                let remedy = "move the axis off it, or set probe_active_input to allow";
                format!(
                    "probe input is already active: {name} is {level}, allowed {} before a {edge} edge; {remedy}",
                    1 - level.clamp(0, 1)
                )
            }
            _ => by_row(),
        },
        Code::TOUCH_PROBE_NOT_ARMED | Code::TOUCH_PROBE_NO_POSITION => match event.asked {
            Number::Count(source) => {
                let name = Object::from_number(source).map_or("that trigger", |source| config.name(source));
                if event.code == Code::TOUCH_PROBE_NOT_ARMED {
                    format!("no touch probe is armed for {name}; arm one with touch_probe")
                } else {
                    format!("the position of the axis is not known: the latch of {name} is not recorded")
                }
            }
            _ => by_row(),
        },
        Code::LATCH_NOT_OFFERED => match event.asked {
            Number::Count(axis) => {
                let name = u16::try_from(axis).map_or("another axis", |axis| config.name(Object::Axis(axis)));
                format!("the drive of {name} latches nothing; an input with `latch: true` or an encoder is allowed")
            }
            _ => by_row(),
        },
        Code::ENGAGE_TOO_SHORT if event.limit == Number::None => format!(
            "no start distance is enough for what the slave may do at the present speed of its leader; {} was asked for",
            plain(event.asked)
        ),
        Code::ENABLE_TIMEOUT => match told(event).and_then(NotEnabled::from_number) {
            Some(shown) => not_enabled(shown, event, config),
            None => by_row(),
        },
        Code::EMERGENCY => emergency(event),
        Code::NODE_CHANGED => match told(event).and_then(NodeNotice::from_number) {
            Some(NodeNotice { node, change, .. }) => format!("node {node}: {}", change.text()),
            None => by_row(),
        },
        Code::FOREIGN_EMERGENCY => match told(event).and_then(ForeignEmergency::from_number) {
            Some(ForeignEmergency { node, code, register }) => {
                format!("node {node}, no drive of the cell, sends emergency {}, {}", error(code), errors(register))
            }
            None => by_row(),
        },
        Code::CLOCK_STEPPED => told(event).map_or_else(by_row, clock_step),
        Code::SOFTWARE_LIMIT_POSITIVE => format!("stopped at max_position {}", limit_of(event, config)),
        Code::SOFTWARE_LIMIT_NEGATIVE => format!("stopped at min_position {}", limit_of(event, config)),
        Code::ENCODER_JUMP if event.limit == Number::None => format!("the leader jumped by {} in one cycle", asked()),
        Code::ENCODER_NOT_SHARED => match event.asked {
            Number::Count(axis) => {
                let other = u16::try_from(axis).map_or("another axis", |axis| config.name(Object::Axis(axis)));
                format!("{other}, which reads the same encoder, began to move, so that only this axis has its new zero")
            }
            _ => by_row(),
        },
        Code::RECORD_LOST => {
            let missing = match event.asked {
                Number::Count(1) => "1 cycle is missing".to_owned(),
                count => format!("{} cycles are missing", plain(count)),
            };
            format!("recording: {missing}, the recorder or the disk did not keep up; no replay goes beyond them")
        }
        Code::RECORD_FAILED => format!("recording stopped: {}", system_error(event.asked)),
        Code::FLIGHT_FAILED => format!("the flight recorder saved no bag: {}", system_error(event.asked)),
        code if code.row().is_some_and(Row::refuses_a_value) => refused_value(event),
        Code(number) if number >= Code::DRIVE_FAULT => format!("drive fault {:04X}h", number - Code::DRIVE_FAULT),
        Code(number) => Some(by_row()).filter(|says| !says.is_empty()).unwrap_or_else(|| format!("code {number}")),
    }
}

/// A sentence of a row with what the event carries in its places.
fn filled(says: &str, event: &Event, config: &MachineConfig) -> String {
    let mut text = String::new();
    let mut rest = says;
    let (asked, limit) = told_apart(event, config);
    while let Some((before, place)) = rest.split_once('{') {
        let (name, after) = place.split_once('}').unwrap_or((place, ""));
        text += before;
        match name {
            "asked" => text += &asked,
            "limit" => text += &limit,
            "plain" => text += &plain(event.asked),
            "bound" => text += &plain(event.limit),
            "what" => text += measured(event.asked),
            "key" => text += key(event),
            // Braces of its own.
            other => text += &format!("{{{other}}}"),
        }
        rest = after;
    }
    text + rest
}

/// The requested and the permitted value, with as many digits as it takes to tell them apart.
fn told_apart(event: &Event, config: &MachineConfig) -> (String, String) {
    if trajectory::is_in_si(event.code) {
        return trajectory::pair_in_si(event.asked, event.limit, &scale_of(event.source, config));
    }
    let text = |number| number_text(number, event.source, config);
    let usual = (text(event.asked), text(event.limit));
    if usual.0 != usual.1 || event.asked == event.limit {
        return usual;
    }
    let scale = scale_of(event.source, config);
    let precise = |number| match number {
        Number::Velocity(rate) => scale.format_rate_precisely(rate, 1),
        Number::Acceleration(rate) => scale.format_rate_precisely(rate, 2),
        Number::Jerk(rate) => scale.format_rate_precisely(rate, 3),
        number => text(number),
    };
    (precise(event.asked), precise(event.limit))
}

/// What an axis does that has to stand first, by the number of its state.
fn not_at_standstill(state: Number) -> String {
    use AxisState::{ContinuousMotion, DiscreteMotion, Homing, SynchronizedMotion};
    let is = |known: AxisState| state == Number::Count(known as i64);
    if is(Homing) {
        return "the axis is homing; wait for its end, or halt it first".to_owned();
    }
    if is(ContinuousMotion) {
        return "the axis runs at a velocity (CONTINUOUS_MOTION); halt it first".to_owned();
    }
    if is(SynchronizedMotion) {
        return "the axis is coupled (SYNCHRONIZED_MOTION); halt it first".to_owned();
    }
    if is(DiscreteMotion) {
        return "the axis moves (DISCRETE_MOTION); wait for its end, or halt it first".to_owned();
    }
    "the axis is not at rest; wait until it stands".to_owned()
}

/// A method of homing, by the numbers of parameter `homing.method`.
fn method(number: Number) -> String {
    match number {
        Number::Count(macs) if macs < 0 => format!("home_type {}", -1 - macs),
        number => format!("homing method {}", plain(number)),
    }
}

/// A homing method whose switch is read nowhere.
fn unread_switch(event: &Event) -> String {
    let place = if let Number::Count(place) = event.limit { usize::try_from(place).ok() } else { None };
    let (name, key) = place.and_then(|place| SWITCHES.get(place)).copied().unwrap_or_default();
    format!(
        "{} needs the {name}, and the digital inputs of the drive (60FDh) are not read; give the drive `eds` or an entry of io, or assign an \
         input with {key}",
        method(event.asked)
    )
}

/// An error of the system by its number (errno of Linux).
fn system_error(number: Number) -> String {
    let name = match number {
        Number::Count(0) | Number::None => return "the system does not say why".to_owned(),
        Number::Count(2) => "no such file or folder",
        Number::Count(5) => "input/output error",
        Number::Count(13) => "permission denied",
        Number::Count(27) => "the file is too large",
        Number::Count(28) => "no space left on device",
        Number::Count(30) => "the file system is read-only",
        Number::Count(122) => "disk quota exceeded",
        _ => return format!("system error {}", plain(number)),
    };
    format!("{name} (system error {})", plain(number))
}

/// What a number measures.
pub(super) fn measured(number: Number) -> &'static str {
    match number {
        Number::Velocity(_) => "velocity",
        Number::Acceleration(_) => "acceleration or deceleration",
        Number::Jerk(_) => "jerk",
        Number::Position(_) => "position",
        _ => "value",
    }
}

/// The limit's position, which limit events carry as theirs.
pub(super) fn limit_of(event: &Event, config: &MachineConfig) -> String {
    match event.limit {
        Number::None => number_text(Number::Position(event.position.floor()), event.source, config),
        limit => number_text(limit, event.source, config),
    }
}

/// What a drive lacks that was not enabled in time: its state, its mode, or both.
fn not_enabled(NotEnabled { state, mode }: NotEnabled, event: &Event, config: &MachineConfig) -> String {
    let axis = match event.source {
        Object::Axis(index) => config.axes.get(usize::from(index)),
        _ => None,
    };
    let cyclic = axis.map_or(mode, |axis| axis.interface.mode().number());
    let own = axis.and_then(|axis| axis.drive_mode).unwrap_or(cyclic);
    // The axis sees the cyclic mode in the place of that of its drive, and the other way round.
    let shown = match mode {
        _ if mode == own => cyclic,
        _ if mode == cyclic => own,
        _ => mode,
    };
    let time = plain(event.limit);
    let other_mode = format!("6061h shows mode {shown}, mode {own} is needed");
    match (state == DriveState::Enabled, mode == cyclic) {
        (true, false) => format!("the drive is in operation enabled, but in another mode after {time}: {other_mode}"),
        (false, true) => format!("the drive is not in operation enabled after {time}: 6041h shows {}", state.text()),
        (false, false) => {
            format!("the drive is not in operation enabled after {time}: 6041h shows {}; {other_mode}", state.text())
        }
        (true, true) => format!("both drives did not show operation enabled in one cycle within {time}"),
    }
}

/// What a drive has sent, in the order of its bytes.
fn emergency(event: &Event) -> String {
    let number = |number| if let Number::Count(count) = number { count } else { 0 };
    let (told, data) = (number(event.asked), number(event.limit));
    let bytes = data.to_le_bytes();
    let [a, b, c, d, e, ..] = bytes;
    let (code, register) = (told & 0xFFFF, told >> 16 & 0xFF);
    let (error, errors) = (error(code as u16), errors(register as u8));
    format!("the drive sends emergency {error}, {errors}, data {a:02X} {b:02X} {c:02X} {d:02X} {e:02X}")
}

/// The number of a note.
fn told(event: &Event) -> Option<i64> {
    if let Number::Count(number) = event.asked { Some(number) } else { None }
}

/// A step of the system clock (ns), in seconds rounded to milliseconds.
fn clock_step(step_ns: i64) -> String {
    let direction = if step_ns < 0 { "back" } else { "forward" };
    let ms = step_ns.unsigned_abs().saturating_add(500_000) / 1_000_000;
    format!("the system clock was set {direction} by {}.{:03} s; stamps follow", ms / 1000, ms % 1000)
}

/// An error code, and what the standards say of it.
fn error(code: u16) -> String {
    error_text(code).map_or_else(|| format!("{code:04X}h"), |text| format!("{code:04X}h ({text})"))
}

/// The error register.
fn errors(register: u8) -> String {
    let texts = register_texts(register.into()).collect::<Vec<_>>().join(", ");
    if texts.is_empty() { format!("register {register:02X}h") } else { format!("register {register:02X}h ({texts})") }
}
/// The side that a mark is of.
fn mark_side(number: Number) -> &'static str {
    if number == Number::Count(1) { "axis" } else { "master" }
}

/// Which start takes the place of a smooth one, and why.
fn smooth_start_fallback(event: &Event) -> String {
    let (Number::Count(why), Number::Count(start)) = (event.asked, event.limit) else {
        return "syncmstart 7 falls back to 5".to_owned();
    };
    format!("syncmstart {start} falls back to {}: {}", fallback(start), Fallback::sentence(why))
}

/// The key that says what gives the marks of a side.
fn mark_key(number: Number) -> &'static str {
    if number == Number::Count(1) { "syncmtyps" } else { "syncmtypm" }
}
