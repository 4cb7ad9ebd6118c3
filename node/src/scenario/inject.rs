//! Verb `inject`: faults and events of the simulated plant.

use super::moment;
use super::names::{Names, did_you_mean, nearest};
use super::ruler::ValueFormat;
use crate::document::{Map, Value};
use lineshaft_core::config::IoKind;
use lineshaft_core::drive::{Edge, Emergency, Latch, inputs};
use lineshaft_core::object::Object;
use lineshaft_core::signal::Value as Number;
use lineshaft_core::sim::Plant;
use lineshaft_core::unit::excerpt;

/// Fault or event of the plant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Injection {
    Latch(Latch),
    Digital {
        place: usize,
        on: bool,
    },
    Analog {
        place: usize,
        volts: f64,
    },
    Fault {
        drive: usize,
        code: u16,
    },
    DriveLost {
        drive: usize,
    },
    /// Index of the backend in the cell.
    BusLost {
        bus: usize,
    },
    Emergency {
        drive: usize,
        emergency: Emergency,
    },
    DriveJump {
        drive: usize,
        by: i64,
    },
    EncoderJump {
        encoder: usize,
        by: i64,
    },
    IndexLost {
        drive: usize,
    },
    /// The mechanics of a drive are blocked, or released.
    Jam {
        drive: usize,
        jammed: bool,
    },
    /// Bits of the digital inputs (60FDh) that are stuck, and their levels; the other bits are released.
    StuckSwitch {
        drive: usize,
        mask: u32,
        value: u32,
    },
    /// Bits of the next words are inverted.
    Bits {
        of: Encoder,
        bits: i64,
        words: u32,
    },
    /// The line of an encoder is cut.
    Cut {
        of: Encoder,
    },
    /// An encoder does not count any more.
    Dead {
        of: Encoder,
    },
    /// Number of additional pulses of an encoder.
    Slip {
        encoder: usize,
        by: i64,
    },
}

/// Source of encoder words.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Encoder {
    /// Encoder of a drive.
    Drive(usize),
    /// Entry of section `encoders`.
    Entry(usize),
}

impl Injection {
    /// Applies it to the plant; returns false if the plant has no such drive, or no room for another latch in this
    /// cycle.
    pub(super) fn apply(self, plant: &mut Plant) -> bool {
        match self {
            Self::Latch(latch) => return plant.add_latch(latch),
            Self::BusLost { bus } => return plant.switch_off_bus(bus),
            Self::Digital { place, on } => plant.set_digital(place, on),
            Self::Analog { place, volts } => plant.set_analog(place, volts),
            Self::EncoderJump { encoder, by } => plant.jump_encoder(encoder, by),
            Self::Slip { encoder, by } => plant.slip_encoder(encoder, by),
            Self::Bits { of: Encoder::Entry(encoder), bits, words } => plant.disturb_encoder(encoder, bits, words),
            Self::Cut { of: Encoder::Entry(encoder) } => plant.cut_encoder(encoder),
            Self::Dead { of: Encoder::Entry(encoder) } => plant.count_encoder_by(encoder, 0),
            Self::Dead { of: Encoder::Drive(drive) } => match plant.drive(drive) {
                Some(drive) => drive.set_count_factor(0),
                None => return false,
            },
            Self::Bits { of: Encoder::Drive(drive), bits, words } => match plant.drive(drive) {
                Some(drive) => drive.invert_bits(bits, words),
                None => return false,
            },
            Self::Cut { of: Encoder::Drive(drive) } => match plant.drive(drive) {
                Some(drive) => drive.cut_encoder(),
                None => return false,
            },
            Self::Fault { drive, .. }
            | Self::DriveLost { drive }
            | Self::Emergency { drive, .. }
            | Self::DriveJump { drive, .. }
            | Self::IndexLost { drive }
            | Self::Jam { drive, .. }
            | Self::StuckSwitch { drive, .. } => {
                let Some(drive) = plant.drive(drive) else { return false };
                match self {
                    Self::Fault { code, .. } => drive.inject_fault(code),
                    Self::DriveJump { by, .. } => drive.jump(by),
                    Self::Emergency { emergency, .. } => drive.send_emergency(emergency),
                    Self::IndexLost { .. } => drive.lose_index(),
                    Self::Jam { jammed, .. } => drive.jam(jammed),
                    Self::StuckSwitch { mask, value, .. } => drive.set_stuck_inputs(mask, value),
                    _ => drive.disconnect(),
                }
            }
        }
        true
    }
}

/// Reads an injection.
pub(super) fn read(value: &Value<'_>, names: &Names<'_>) -> Option<Injection> {
    const KINDS: &str = "latch, input, fault, emergency, drive_lost, bus_lost, encoder_jump, encoder_bits, encoder_cut, \
                         encoder_dead, encoder_slip, index_lost, jam, stuck_switch, power_cycle";
    let entries = value.entries()?;
    let [(kind, arguments)] = entries.as_slice() else {
        value.refuse(format!("inject does one thing: one of {KINDS}"), None);
        return None;
    };
    let injection = match kind.text()? {
        "latch" => latch(arguments, names),
        "input" => input(arguments, names),
        "fault" => fault(arguments, names),
        "drive_lost" => drive_alone("drive_lost", arguments, names).map(|drive| Injection::DriveLost { drive }),
        "bus_lost" => bus_lost(arguments, names),
        "emergency" => emergency(arguments, names),
        "encoder_jump" => encoder_jump(arguments, names),
        "index_lost" => drive_alone("index_lost", arguments, names).map(|drive| Injection::IndexLost { drive }),
        "jam" => jam(arguments, names),
        "stuck_switch" => stuck_switch(arguments, names),
        "encoder_bits" => encoder_bits(arguments, names),
        "encoder_cut" => encoder_alone("encoder_cut", arguments, names).map(|of| Injection::Cut { of }),
        "encoder_dead" => encoder_alone("encoder_dead", arguments, names).map(|of| Injection::Dead { of }),
        "encoder_slip" => encoder_slip(arguments, names),
        _ => {
            kind.refuse(format!("`{}` cannot be injected; {KINDS} can", kind.peek().unwrap_or_default()), None);
            None
        }
    }?;
    let axis = of_words(&injection).and_then(|drive| Some(names.config.drives().nth(drive)?.1));
    if let Some(axis) = axis.filter(|axis| axis.analog.is_some()) {
        let (said, axis) = (kind.peek().unwrap_or_default(), &axis.name);
        let sentence =
            format!("{said} is of what a drive tells, and that of {axis} is given a voltage and tells nothing");
        kind.refuse(sentence, Some("an entry of encoders has its own".to_owned()));
        return None;
    }
    Some(injection)
}

/// Returns the drive whose process data an injection changes.
fn of_words(injection: &Injection) -> Option<usize> {
    match injection {
        Injection::Emergency { drive, .. }
        | Injection::DriveJump { drive, .. }
        | Injection::IndexLost { drive }
        | Injection::Bits { of: Encoder::Drive(drive), .. }
        | Injection::Cut { of: Encoder::Drive(drive) }
        | Injection::Dead { of: Encoder::Drive(drive) } => Some(*drive),
        _ => None,
    }
}

/// Reads an injection whose only argument is the encoder.
fn encoder_alone(kind: &str, arguments: &Value<'_>, names: &Names<'_>) -> Option<Encoder> {
    let mut map = arguments.map(kind)?;
    let axis = map.required("axis");
    map.finish();
    encoder(&axis?, names)
}

/// Reads an edge within the last cycle, by its age, by the latched position, or by both; the machine interpolates the
/// missing one. Without either it is at t_k.
fn latch(value: &Value<'_>, names: &Names<'_>) -> Option<Injection> {
    let mut map = value.map("latch")?;
    let object = map.required("input").and_then(|input| latching(&input, names));
    let age = map.optional("age").map(|age| self::age(&age, names.config.cycle_ns));
    let position = map.optional("position");
    let edges = [("rising", Edge::Rising), ("falling", Edge::Falling)];
    let edge = map.optional("edge").map_or(Some(Edge::Rising), |edge| edge.choice(&edges));
    map.finish();
    let object = object?;
    let position = position.map(|position| latched(&position, object, names));
    let (age, position) = (given(age)?, given(position)?);
    let age_ns = age.or(if position.is_none() { Some(0) } else { None });
    Some(Injection::Latch(Latch { object, edge: edge?, age_ns, position }))
}

/// Reads the raw count latched by an encoder or a drive, as in ENCODER.count or AXIS.actual.count.
fn latched(value: &Value<'_>, object: Object, names: &Names<'_>) -> Option<i64> {
    let scale = match object {
        Object::Encoder(place) => names.config.encoders.get(usize::from(place)).map(|encoder| encoder.scale),
        Object::Axis(axis) => names.config.axes.get(usize::from(axis)).map(|axis| axis.scale),
        _ => None,
    };
    let Some(scale) = scale else {
        let sentence = format!("position is {}; an input catches no position", value.peek().unwrap_or_default());
        value.refuse(sentence, Some("give `age`, or name the encoder or axis".to_owned()));
        return None;
    };
    whole(value, ValueFormat::of_positions(scale))
}

/// Converts an absent value to `Some(None)`, and a wrong one to `None`.
fn given<T>(value: Option<Option<T>>) -> Option<Option<T>> {
    value.map_or(Some(None), |value| value.map(Some))
}

/// Reads an object that can latch: an input with latch, an encoder, or an axis with a drive.
fn latching(value: &Value<'_>, names: &Names<'_>) -> Option<Object> {
    let object = names.object(value)?;
    let name = value.peek().unwrap_or_default();
    let sentence = match object {
        Object::Io(index) => match names.config.io.get(usize::from(index)) {
            Some(entry) if entry.kind == IoKind::DigitalInput && entry.latch => return Some(object),
            Some(entry) if entry.kind == IoKind::DigitalInput => {
                value.refuse(format!("{name} does not latch"), Some("give it `latch: true` in the cell".to_owned()));
                return None;
            }
            _ => format!("{name} is no digital input"),
        },
        Object::Encoder(_) => return Some(object),
        Object::Axis(axis) if names.drive_of(axis).is_some() => return Some(object),
        Object::Axis(_) => format!("{name} has no drive"),
        Object::Machine | Object::Memory(_) | Object::Function(_) | Object::Table(_) | Object::Program(_) => {
            format!("{name} cannot latch")
        }
    };
    value.refuse(format!("{sentence}; an input with `latch: true`, an encoder or an axis with a drive latches"), None);
    None
}

/// Reads the age of a latch, which is in (t_k-1, t_k].
fn age(value: &Value<'_>, cycle_ns: u64) -> Option<u32> {
    let ns = moment::nanoseconds(value)?;
    if ns < cycle_ns {
        return u32::try_from(ns).ok();
    }
    value.refuse(format!("age is {ns} ns; less than a cycle of {cycle_ns} ns is allowed"), None);
    None
}

fn input(value: &Value<'_>, names: &Names<'_>) -> Option<Injection> {
    let entries = value.entries()?;
    let [(key, level)] = entries.as_slice() else {
        value.refuse("one input and its value are expected", None);
        return None;
    };
    let io = match names.object(key)? {
        Object::Io(index) => names.io(index),
        _ => None,
    };
    match io {
        Some((IoKind::DigitalInput, place)) if names.config.is_virtual_input(place) => {
            let name = key.peek().unwrap_or_default();
            let sentence = format!("{name} reads an output of the machine; an input with a terminal is allowed");
            key.refuse(sentence, Some("set that output".to_owned()));
            None
        }
        Some((IoKind::DigitalInput, place)) => {
            level.integer(0..=1_u8).map(|level| Injection::Digital { place, on: level == 1 })
        }
        Some((IoKind::AnalogInput, place)) => {
            let signal = names.signal(key)?;
            ValueFormat::of(names, signal).read(level).map(|volts| Injection::Analog { place, volts: volts.to_f64() })
        }
        _ => {
            key.refuse(format!("{} is no input", key.peek().unwrap_or_default()), None);
            None
        }
    }
}

fn fault(value: &Value<'_>, names: &Names<'_>) -> Option<Injection> {
    let mut map = value.map("fault")?;
    let axis = drive_in(&mut map, names);
    let code = map.required("code").and_then(|code| code.integer(1..=u16::MAX));
    map.finish();
    Some(Injection::Fault { drive: axis?.0, code: code? })
}

fn bus_lost(value: &Value<'_>, names: &Names<'_>) -> Option<Injection> {
    let mut map = value.map("bus_lost")?;
    let backend = map.required("backend");
    map.finish();
    let backend = backend?;
    let name = backend.text()?;
    let place = names.backends.iter().position(|known| known.name == name);
    if place.is_none() {
        let hint = nearest(name, names.backends.iter().map(|known| known.name.as_str())).map(did_you_mean);
        backend.refuse(format!("no backend is called `{}` in the cell", excerpt(name)), hint);
    }
    Some(Injection::BusLost { bus: place? })
}

/// Reads an emergency message: `{axis: x, code: 0x8130, register: 0x11, data: [1, 2, 3, 4, 5]}`.
fn emergency(value: &Value<'_>, names: &Names<'_>) -> Option<Injection> {
    let mut map = value.map("emergency")?;
    let axis = drive_in(&mut map, names);
    let code = map.required("code").and_then(|code| code.integer(0..=u16::MAX));
    let register = map.optional("register").map_or(Some(0), |register| register.integer(0..=u8::MAX));
    let data = map.optional("data").map_or(Some([0; 5]), |data| bytes(&data));
    map.finish();
    Some(Injection::Emergency {
        drive: axis?.0,
        emergency: Emergency { code: code?, register: register?, data: data? },
    })
}

fn bytes(value: &Value<'_>) -> Option<[u8; 5]> {
    let items = value.list()?;
    let bytes: Vec<u8> = items.iter().map(|item| item.integer(0..=u8::MAX)).collect::<Option<_>>()?;
    let found = bytes.len();
    let bytes = bytes.try_into().ok();
    if bytes.is_none() {
        value.refuse(format!("data has {found} bytes; 5 are expected"), None);
    }
    bytes
}

fn encoder_jump(value: &Value<'_>, names: &Names<'_>) -> Option<Injection> {
    let mut map = value.map("encoder_jump")?;
    let axis = map.required("axis");
    let which = map.optional("drive");
    let by = map.required("by");
    map.finish();
    let (axis, by) = (axis?, by?);
    if let Some(encoder) = names.config.encoders.iter().position(|entry| Some(entry.name.as_str()) == axis.peek()) {
        let by = whole(&by, ValueFormat::of_positions(names.config.encoders[encoder].scale))?;
        if let Some(which) = which {
            which.refuse("drive is for an axis; this is an entry of encoders", Some("leave it out".to_owned()));
            return None;
        }
        return Some(Injection::EncoderJump { encoder, by });
    }
    let (drive, index) = which_drive(&axis, which.as_ref(), names)?;
    let by = whole(&by, ValueFormat::of_positions(names.config.axes[index].scale))?;
    Some(Injection::DriveJump { drive, by })
}

/// Reads switches that are stuck, and their levels: `{axis: x, home: 1}`. Switches that are not given are released.
fn stuck_switch(value: &Value<'_>, names: &Names<'_>) -> Option<Injection> {
    const SWITCHES: [(&str, u32); 3] =
        [("home", inputs::HOME), ("positive", inputs::POSITIVE_LIMIT), ("negative", inputs::NEGATIVE_LIMIT)];
    let mut map = value.map("stuck_switch")?;
    let axis = drive_in(&mut map, names);
    let stuck = SWITCHES.map(|(name, bit)| (bit, map.optional(name).map(|level| level.integer(0..=1_u32))));
    map.finish();
    let (drive, _) = axis?;
    let (mut mask, mut levels) = (0, 0);
    for (bit, level) in stuck {
        if let Some(level) = level {
            mask |= bit;
            levels |= bit * level?;
        }
    }
    Some(Injection::StuckSwitch { drive, mask, value: levels })
}

/// Reads the drive of `{axis: NAME}`, an injection without other arguments.
fn drive_alone(what: &str, value: &Value<'_>, names: &Names<'_>) -> Option<usize> {
    let mut map = value.map(what)?;
    let axis = drive_in(&mut map, names);
    map.finish();
    axis.map(|(drive, _)| drive)
}

/// Reads a drive whose mechanics are blocked or released: `{axis: x, drive: 2, jammed: false}`.
fn jam(value: &Value<'_>, names: &Names<'_>) -> Option<Injection> {
    let mut map = value.map("jam")?;
    let axis = drive_in(&mut map, names);
    let jammed = map.optional("jammed").map_or(Some(true), |jammed| jammed.boolean());
    map.finish();
    Some(Injection::Jam { drive: axis?.0, jammed: jammed? })
}

/// Reads keys `axis` and, for an axis with two drives, `drive`; returns the drive and the axis.
fn drive_in(map: &mut Map<'_>, names: &Names<'_>) -> Option<(usize, usize)> {
    let axis = map.required("axis");
    let which = map.optional("drive");
    which_drive(&axis?, which.as_ref(), names)
}

/// Returns the drive of an axis, by default the first one, and the axis.
fn which_drive(axis: &Value<'_>, which: Option<&Value<'_>>, names: &Names<'_>) -> Option<(usize, usize)> {
    let (first, index) = drive(axis, names)?;
    let Some(which) = which else { return Some((first, index)) };
    if which.integer(1..=2_u8)? == 1 {
        return Some((first, index));
    }
    let second = names.config.second_drive(index as u16);
    if second.is_none() {
        which.refuse(
            format!("drive is 2; {} has one drive", names.config.axes[index].name),
            Some("leave it out".to_owned()),
        );
    }
    Some((second?, index))
}

/// Reads an entry of section `encoders`, or the encoder of the drive of an axis.
fn encoder(value: &Value<'_>, names: &Names<'_>) -> Option<Encoder> {
    let entry = names.config.encoders.iter().position(|entry| Some(entry.name.as_str()) == value.peek());
    entry.map(Encoder::Entry).or_else(|| drive(value, names).map(|(drive, _)| Encoder::Drive(drive)))
}

/// Reads `bits`, a mask of inverted bits, and the number of `words`, by default 1.
fn encoder_bits(value: &Value<'_>, names: &Names<'_>) -> Option<Injection> {
    let mut map = value.map("encoder_bits")?;
    let of = map.required("axis").and_then(|axis| encoder(&axis, names));
    let bits = map.required("bits").and_then(|bits| bits.integer(1..=i64::MAX));
    let words = map.optional("words").map_or(Some(1), |words| words.integer(1..=u32::MAX));
    map.finish();
    Some(Injection::Bits { of: of?, bits: bits?, words: words? })
}

/// Reads additional pulses of an entry of section `encoders`; for an axis `encoder_jump` does the same.
fn encoder_slip(value: &Value<'_>, names: &Names<'_>) -> Option<Injection> {
    let mut map = value.map("encoder_slip")?;
    let axis = map.required("axis");
    let by = map.required("by");
    map.finish();
    let (axis, by) = (axis?, by?);
    match encoder(&axis, names)? {
        Encoder::Entry(encoder) => {
            let by = whole(&by, ValueFormat::of_positions(names.config.encoders[encoder].scale))?;
            Some(Injection::Slip { encoder, by })
        }
        Encoder::Drive(drive) => {
            let index = names.config.find_axis(axis.text()?).ok()?.0;
            let by = whole(&by, ValueFormat::of_positions(names.config.axes[usize::from(index)].scale))?;
            Some(Injection::DriveJump { drive, by })
        }
    }
}

fn whole(value: &Value<'_>, ruler: ValueFormat) -> Option<i64> {
    match ruler.read(value)? {
        Number::Int(number) => Some(number),
        Number::Real(_) => None,
    }
}

/// Returns the drive of an axis, and the axis.
fn drive(value: &Value<'_>, names: &Names<'_>) -> Option<(usize, usize)> {
    let axis = match names.config.find_axis(value.text()?) {
        Ok((axis, _)) => axis,
        Err(error) => {
            value.refuse(error.to_string(), None);
            return None;
        }
    };
    let drive = names.drive_of(axis);
    if drive.is_none() {
        value.refuse(format!("{} is virtual: it has no drive", names.config.axes[usize::from(axis)].name), None);
    }
    drive.map(|drive| (drive, usize::from(axis)))
}
