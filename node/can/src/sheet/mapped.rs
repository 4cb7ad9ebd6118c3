//! Compares mapped objects of a device with its file.

use super::Comparison;
use crate::eds::Access;
use crate::layout::Transmission;
use lineshaft_cia402::dictionary::Direction;
use lineshaft_cia402::mapping::{CommandedValue, Field, MappableObjects, OPTIONAL, ReportedValue};
use lineshaft_cia402::object::Object;
use lineshaft_core::drive::Interface;

impl Comparison<'_> {
    /// Compares type, length and access of the objects in PDOs that the master maps.
    pub(super) fn mapped(&mut self) {
        let device = self.device;
        for pdo in device.layout.asked.iter().filter(|pdo| pdo.is_mapped) {
            for field in &pdo.fields {
                if let Some(key) = key_of_asked(field.word) {
                    self.field(Direction::Receive, field.object, field.bits, key);
                }
            }
        }
        let is_for_torque = device.drive().is_some_and(|drive| drive.mode.interface() == Interface::Torque);
        for pdo in device.layout.told.iter().filter(|pdo| pdo.is_mapped) {
            for field in &pdo.fields {
                if let Some(key) = key_of_told(field.word, pdo.transmission, is_for_torque) {
                    self.field(Direction::Transmit, field.object, field.bits, key);
                }
            }
        }
        self.left_out();
    }

    /// Adds warnings about optional objects that are not mapped because the file gives them another type or access.
    fn left_out(&mut self) {
        let (device, known) = (self.device, self.known);
        if device.drive().is_none_or(|drive| drive.drive_type.is_some()) {
            return;
        }
        for field in OPTIONAL {
            let Field { word, object, bits } = field;
            let (Some(entry), Some(found)) = (known.entry(object), known.mappable_object(object)) else { continue };
            if !entry.is_mappable || field.matches_entry(found) {
                continue;
            }
            if device.layout.told.iter().flat_map(|pdo| &pdo.fields).any(|carried| carried.object == object) {
                continue;
            }
            let why = match entry.data_type {
                data_type if data_type.may_be_integer(bits) => {
                    format!("has access {} by the file", entry.access.name())
                }
                data_type => format!("is {data_type} by the file, not an integer of {bits} bits"),
            };
            let lost = if word == ReportedValue::Inputs { "; the switches of the drive are not read" } else { "" };
            self.warning(&format!("{object} {why}: it is not mapped to a PDO{lost}"));
        }
    }

    fn field(&mut self, direction: Direction, object: Object, bits: u32, key: &str) {
        let known = self.known;
        let Some(entry) = known.entry(object) else { return self.missing(object, key) };
        let (data_type, access) = (entry.data_type, entry.access);
        if !data_type.may_be_integer(bits) {
            self.error(&format!(
                "{object} is {data_type} by the file; an integer of {bits} bits is mapped to a PDO (key {key})"
            ));
        }
        let (is_wrong, is_odd, way) = match direction {
            Direction::Receive => (!access.is_writable(), access == Access::Rwr, "receives"),
            Direction::Transmit => (!access.is_readable(), access == Access::Rww, "sends"),
        };
        let name = access.name();
        let sentence = format!("{object} has access {name} by the file; the device {way} it in a PDO (key {key})");
        if is_wrong {
            self.error(&sentence);
        } else if is_odd {
            self.warning(&sentence);
        }
        if !entry.is_mappable {
            let sentence =
                format!("{object} cannot be mapped to a PDO by the file: its PDOMapping is not 1 (key {key})");
            match known.find_pdo_with(direction, object) {
                Some(number) => self.warning(&format!("{sentence}; PDO {number} of the file carries it all the same")),
                None => self.error(&sentence),
            }
        }
    }
}

/// Returns the key of the cell that requires a commanded value; `None` for unused bits.
fn key_of_asked(word: CommandedValue) -> Option<&'static str> {
    match word {
        CommandedValue::Control
        | CommandedValue::Position
        | CommandedValue::Velocity
        | CommandedValue::Torque
        | CommandedValue::Mode => Some("interface"),
        CommandedValue::Outputs | CommandedValue::Digital(_) | CommandedValue::Analog(_) => Some("io"),
        CommandedValue::Nothing => None,
    }
}

/// Returns the key of the cell that requires a reported value. Inputs and error code of a drive are mapped because the file contains them.
fn key_of_told(word: ReportedValue, transmission: Transmission, is_for_torque: bool) -> Option<&'static str> {
    match word {
        ReportedValue::Status | ReportedValue::Position | ReportedValue::Mode => Some("interface"),
        ReportedValue::Torque => Some(if is_for_torque { "interface" } else { "rated_effort" }),
        ReportedValue::Inputs if transmission == Transmission::EachSync => Some("io"),
        ReportedValue::Inputs | ReportedValue::Fault => Some("eds"),
        ReportedValue::Captured(slot) | ReportedValue::Captures(slot) => {
            Some(if slot < 2 { "probe_1" } else { "probe_2" })
        }
        ReportedValue::Digital(_) | ReportedValue::Analog(_) => Some("io"),
        ReportedValue::Encoder => Some("encoders"),
        ReportedValue::Nothing => None,
    }
}
