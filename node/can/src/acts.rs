//! Objects of a device configuration (DCF) that are not written, because they trigger an action or are setpoints.
//!
//! Law      an object acts if the write itself triggers something: it stores, restores, clears, presets, starts or enables. A setpoint is a
//!          value that the device follows, at once or as soon as it is enabled. Every other object stores a value and is written.
//!          Manufacturer objects (2000h to 5FFFh) are written, as no standard describes their effect
//! Reads    objects, and the profile of the logical device that has them (1000h; 67FFh for the second logical device and 800h higher for
//!          each further one)
//! Source   CiA 301, CiA 302-2, CiA 302-3, CiA 401, CiA 402-2, CiA 406

use crate::eds::Dictionary;
use lineshaft_cia402::object::Object;
use lineshaft_cia402::objects::DEVICE_TYPE;
use std::fmt;

use LeftOutReason::{Acts, Setpoint};

/// First index of the profile area of the first logical device.
const FIRST_OF_PROFILES: u16 = 0x6000;
const LAST_OF_PROFILES: u16 = 0x9FFF;
const LOGICAL_DEVICE: u16 = 0x800;
/// Device type of the first logical device, if a device has it here in addition to 1000h.
const LOGICAL_DEVICE_TYPE: u16 = 0x67FF;

/// Reason why a configuration does not write an object.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LeftOutReason {
    /// The write itself triggers an action.
    Acts,
    /// The device follows the value.
    Setpoint,
}

/// First and last index, subindex (`None`: all subindices), and the reason why they are left out.
type Row = (u16, u16, Option<u8>, LeftOutReason);

/// Rows that apply to all profiles.
const COMMON: [Row; 7] = [
    // Pre-defined error field: 0 clears the history.
    (0x1003, 0x1003, Some(0), Acts),
    // Store parameters, restore default parameters.
    (0x1010, 0x1011, None, Acts),
    // High resolution time stamp: the time of the file has passed.
    (0x1013, 0x1013, None, Setpoint),
    // OS command, its mode, debugger interface, OS prompt.
    (0x1023, 0x1026, None, Acts),
    // Configuration request, with which a manager configures its nodes.
    (0x1F25, 0x1F25, None, Acts),
    // Program data (the flash memory), program control (stop, start, reset, clear).
    (0x1F50, 0x1F51, None, Acts),
    // Request NMT, request node guarding, with which a master commands its nodes.
    (0x1F82, 0x1F83, None, Acts),
];

/// I/O modules (CiA 401): all rows are outputs.
const MODULE: [Row; 5] = [
    // Digital outputs of 8 bits; single bits 1 to 1024; 16 bits; 32 bits.
    (0x6200, 0x6200, None, Setpoint),
    (0x6220, 0x6227, None, Setpoint),
    (0x6300, 0x6300, None, Setpoint),
    (0x6320, 0x6320, None, Setpoint),
    // Analog outputs of 8, 16 and 32 bits, as REAL32, and manufacturer-specific.
    (0x6410, 0x6414, None, Setpoint),
];

/// Drives (CiA 402). 60FEh:02 is the mask of the outputs, which is configuration and is not listed.
const DRIVE: [Row; 8] = [
    // Control word.
    (0x6040, 0x6040, None, Acts),
    // Target velocity of mode vl, target torque, target position.
    (0x6042, 0x6042, None, Setpoint),
    (0x6071, 0x6071, None, Setpoint),
    (0x607A, 0x607A, None, Setpoint),
    // Position, velocity and torque offset, which are added to the targets.
    (0x60B0, 0x60B2, None, Setpoint),
    // Interpolation data record.
    (0x60C1, 0x60C1, None, Setpoint),
    // Digital outputs.
    (0x60FE, 0x60FE, Some(1), Setpoint),
    // Target velocity.
    (0x60FF, 0x60FF, None, Setpoint),
];

/// Encoders (CiA 406): presets. A write sets the position to the preset value.
const ENCODER: [Row; 3] = [
    (0x6003, 0x6003, None, Acts),
    // 64-bit preset; presets of several channels.
    (0x6009, 0x6009, None, Acts),
    (0x6010, 0x6010, None, Acts),
];

/// Rows by profile number.
const PROFILES: [(u16, &[Row]); 3] = [(401, &MODULE), (402, &DRIVE), (406, &ENCODER)];

fn find_reason(rows: &[Row], object: Object) -> Option<LeftOutReason> {
    let is_it = |row: &&Row| {
        let (first, last, sub, _) = **row;
        (first..=last).contains(&object.index) && sub.is_none_or(|sub| sub == object.sub)
    };
    rows.iter().find(is_it).map(|row| row.3)
}

/// Returns the number of the logical device that has an index, from 0; `None` for an index outside the profile area.
fn logical_device(index: u16) -> Option<u16> {
    let beyond = index.checked_sub(FIRST_OF_PROFILES)?;
    (index <= LAST_OF_PROFILES).then_some(beyond / LOGICAL_DEVICE)
}

/// Returns the reason why a configuration does not write an object; `None` if it is written. `profile` is the profile of the logical device
/// that has the object. If it is `None` or unknown here (not 401, 402 or 406), the objects that act in any of these profiles are left out.
pub fn reason(object: Object, profile: Option<u16>) -> Option<LeftOutReason> {
    let Some(device) = logical_device(object.index) else { return find_reason(&COMMON, object) };
    let object = Object { index: object.index - device * LOGICAL_DEVICE, ..object };
    match PROFILES.iter().find(|(number, _)| Some(*number) == profile) {
        Some((_, rows)) => find_reason(rows, object),
        None => PROFILES.iter().find_map(|(_, rows)| find_reason(rows, object)),
    }
}

/// Returns the object with the device type of the logical device that has an index; `None` for an index outside the profile area.
pub fn device_type(index: u16) -> Option<Object> {
    match logical_device(index)? {
        0 => Some(DEVICE_TYPE),
        device => Some(Object { index: LOGICAL_DEVICE_TYPE + device * LOGICAL_DEVICE, sub: 0 }),
    }
}

/// Returns the profile number in a device type; `None` for 0, which means a device without a profile.
pub fn profile_number(device_type: u32) -> Option<u16> {
    Some(device_type as u16).filter(|profile| *profile != 0)
}

/// Returns the profile of the logical device that has an index, according to a dictionary. `first` is the profile of the first logical
/// device. It also applies to a further logical device whose device type is missing in the dictionary.
pub fn profile_of(dictionary: &Dictionary, index: u16, first: Option<u16>) -> Option<u16> {
    let further = device_type(index).filter(|object| *object != DEVICE_TYPE);
    let said = further.and_then(|object| dictionary.value(object)?.number());
    said.and_then(|number| profile_number(u32::try_from(number).ok()?)).or(first)
}

/// Objects of a configuration that are not written, in the order of the objects.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LeftOut(pub Vec<(Object, LeftOutReason)>);

impl LeftOut {
    /// Returns true if all objects are written.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

/// Lists the objects with their reasons, to follow the words "left out": "as objects that act: 1010h:01 to 04; as setpoints: 607Ah:00".
impl fmt::Display for LeftOut {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut gap = "";
        for (wanted, name) in [(Acts, "objects that act"), (Setpoint, "setpoints")] {
            let objects = self.0.iter().filter(|(_, reason)| *reason == wanted).map(|(object, _)| *object);
            let listed = object_list(objects);
            if !listed.is_empty() {
                write!(f, "{gap}as {name}: {listed}")?;
                gap = "; ";
            }
        }
        Ok(())
    }
}

/// Returns objects as a list in which consecutive subindices are shown as a range.
fn object_list(objects: impl Iterator<Item = Object>) -> String {
    let mut runs: Vec<(Object, u8)> = Vec::new();
    for object in objects {
        match runs.last_mut() {
            Some((first, last)) if first.index == object.index && last.checked_add(1) == Some(object.sub) => {
                *last = object.sub;
            }
            _ => runs.push((object, object.sub)),
        }
    }
    let text = |(first, last): &(Object, u8)| {
        if *last == first.sub { first.to_string() } else { format!("{first} to {last:02X}") }
    };
    runs.iter().map(text).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests;
