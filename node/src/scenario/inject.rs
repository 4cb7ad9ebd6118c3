//! Verb `inject`: what happens to the simulated plant.

use super::moment;
use super::names::Names;
use super::ruler::Ruler;
use crate::document::Value;
use lineshaft_core::config::IoKind;
use lineshaft_core::drive::{Edge, Latch};
use lineshaft_core::object::Object;
use lineshaft_core::signal::Value as Number;
use lineshaft_core::sim::Plant;

/// Something that happens to the plant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Injection {
    Latch(Latch),
    Digital { place: usize, on: bool },
    Analog { place: usize, volts: f64 },
    Fault { drive: usize, code: u16 },
    DriveLost { drive: usize },
    DriveJump { drive: usize, by: i64 },
    EncoderJump { encoder: usize, by: i64 },
}

impl Injection {
    /// Does it to the plant; false where the plant has no such drive, or no room for a further latch in this cycle.
    pub(super) fn apply(self, plant: &mut Plant) -> bool {
        match self {
            Self::Latch(latch) => return plant.add_latch(latch),
            Self::Digital { place, on } => plant.set_digital(place, on),
            Self::Analog { place, volts } => plant.set_analog(place, volts),
            Self::EncoderJump { encoder, by } => plant.jump_encoder(encoder, by),
            Self::Fault { drive, .. } | Self::DriveLost { drive } | Self::DriveJump { drive, .. } => {
                let Some(drive) = plant.drive(drive) else { return false };
                match self {
                    Self::Fault { code, .. } => drive.inject_fault(code),
                    Self::DriveJump { by, .. } => drive.jump(by),
                    _ => drive.lose(),
                }
            }
        }
        true
    }
}

/// Reads what to inject.
pub(super) fn read(value: &Value<'_>, names: &Names<'_>) -> Option<Injection> {
    const KINDS: &str = "latch, input, fault, drive_lost, encoder_jump, power_cycle";
    let entries = value.entries()?;
    let [(kind, arguments)] = entries.as_slice() else {
        value.refuse(format!("inject does one thing: one of {KINDS}"), None);
        return None;
    };
    match kind.text()? {
        "latch" => latch(arguments, names),
        "input" => input(arguments, names),
        "fault" => fault(arguments, names),
        "drive_lost" => {
            let mut map = arguments.map("drive_lost")?;
            let axis = map.required("axis");
            map.finish();
            drive(&axis?, names).map(|(drive, _)| Injection::DriveLost { drive })
        }
        "encoder_jump" => encoder_jump(arguments, names),
        "index_lost" => {
            kind.refuse("inject index_lost does not exist yet", None);
            None
        }
        _ => {
            kind.refuse(format!("`{}` cannot be injected; {KINDS} can", kind.peek().unwrap_or_default()), None);
            None
        }
    }
}

fn latch(value: &Value<'_>, names: &Names<'_>) -> Option<Injection> {
    let mut map = value.map("latch")?;
    let object = map.required("input").and_then(|input| latching(&input, names));
    let age = map.optional("age").map_or(Some(0), |age| self::age(&age, names.config.cycle_ns));
    let edges = [("rising", Edge::Rising), ("falling", Edge::Falling)];
    let edge = map.optional("edge").map_or(Some(Edge::Rising), |edge| edge.choice(&edges));
    map.finish();
    Some(Injection::Latch(Latch { object: object?, edge: edge?, age_ns: Some(age?), position: None }))
}

/// An input that latches, an encoder, or an axis with a drive.
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
        Object::Machine | Object::Memory(_) => format!("{name} cannot latch"),
    };
    value.refuse(format!("{sentence}; an input with `latch: true`, an encoder or an axis with a drive latches"), None);
    None
}

/// A latch lies in (t_k-1, t_k].
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
        Some((IoKind::DigitalInput, place)) => {
            level.integer(0..=1_u8).map(|level| Injection::Digital { place, on: level == 1 })
        }
        Some((IoKind::AnalogInput, place)) => {
            let signal = names.signal(key)?;
            Ruler::of(names, signal).read(level).map(|volts| Injection::Analog { place, volts: volts.to_f64() })
        }
        _ => {
            key.refuse(format!("{} is no input", key.peek().unwrap_or_default()), None);
            None
        }
    }
}

fn fault(value: &Value<'_>, names: &Names<'_>) -> Option<Injection> {
    let mut map = value.map("fault")?;
    let axis = map.required("axis").and_then(|axis| drive(&axis, names));
    let code = map.required("code").and_then(|code| code.integer(1..=u16::MAX));
    map.finish();
    Some(Injection::Fault { drive: axis?.0, code: code? })
}

fn encoder_jump(value: &Value<'_>, names: &Names<'_>) -> Option<Injection> {
    let mut map = value.map("encoder_jump")?;
    let axis = map.required("axis");
    let by = map.required("by");
    map.finish();
    let (axis, by) = (axis?, by?);
    if let Some(encoder) = names.config.encoders.iter().position(|entry| Some(entry.name.as_str()) == axis.peek()) {
        let by = whole(&by, Ruler::of_positions(names.config.encoders[encoder].scale))?;
        return Some(Injection::EncoderJump { encoder, by });
    }
    let (drive, index) = drive(&axis, names)?;
    let by = whole(&by, Ruler::of_positions(names.config.axes[index].scale))?;
    Some(Injection::DriveJump { drive, by })
}

fn whole(value: &Value<'_>, ruler: Ruler) -> Option<i64> {
    match ruler.read(value)? {
        Number::Int(number) => Some(number),
        Number::Real(_) => None,
    }
}

/// The drive of an axis, and the axis.
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
