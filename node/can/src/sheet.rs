//! Compares the configuration of a device with its EDS or DCF file.
//!
//! Law      a conflict between file and cell is an error. Missing content of the file is a warning, because many files are incomplete and
//!          the device itself is checked when it starts. A default value that is missing or 0 gives no information
//! Reads    1000h (profile); 6502h (supported modes) and the mode of the drive; type, length and access of mapped objects; objects that
//!          keys of the cell need; Baudrate of a DCF, BaudRate_ of an EDS
//! Source   CiA 301, CiA 306-1, CiA 401-1, CiA 402-2, CiA 406

mod mapped;
mod presence;

use crate::config::{DeviceConfig, Role};
use crate::eds::Dictionary;
use lineshaft_cia402::mode::DriveMode;
use lineshaft_cia402::object::Object;
use lineshaft_cia402::objects;
use lineshaft_cia402::texts;
use std::collections::BTreeSet;

/// Mode of operation homing (6060h); bit 5 of 6502h.
const HOMING: i8 = 6;

/// Requirements of the cell in addition to the device configuration.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Requirements {
    /// Bit rate of the bus, in bit/s; `None` if the cell does not give it.
    pub bit_rate: Option<u32>,
    /// Whether homing is done in the drive (`homing.in_drive` of the axis).
    pub homes: bool,
}

/// Messages, each starting with the device.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Findings {
    /// Conflicts with the file.
    pub errors: Vec<String>,
    /// Content that the file lacks, and contradictions within the file.
    pub warnings: Vec<String>,
}

/// Compares a device with its file.
pub fn compare(device: &DeviceConfig, needs: Requirements, known: &Dictionary) -> Findings {
    let mut sheet = Comparison { device, known, reported_indices: BTreeSet::new(), found: Findings::default() };
    sheet.profile();
    sheet.modes(needs.homes);
    sheet.mapped();
    sheet.present(needs.homes);
    if let Some(bit_rate) = needs.bit_rate {
        sheet.bit_rate(bit_rate);
    }
    sheet.found
}

/// Comparison in progress.
struct Comparison<'a> {
    device: &'a DeviceConfig,
    known: &'a Dictionary,
    /// Indices with missing content that was already reported.
    reported_indices: BTreeSet<u16>,
    found: Findings,
}

impl Comparison<'_> {
    fn error(&mut self, sentence: &str) {
        self.found.errors.push(format!("{}: {sentence}", self.device));
    }

    fn warning(&mut self, sentence: &str) {
        self.found.warnings.push(format!("{}: {sentence}", self.device));
    }

    /// Returns a number of the file; `None` if it is missing or 0.
    fn number(&self, object: Object) -> Option<u32> {
        let number = self.known.value(object)?.number()?;
        u32::try_from(number).ok().filter(|number| *number != 0)
    }

    /// Compares the profile that the cell requires with that of the file.
    fn profile(&mut self) {
        let object = objects::DEVICE_TYPE;
        let Some(device_type) = self.number(object) else { return };
        let (found, (expected, what)) = (device_type & 0xFFFF, self.device.role.profile());
        // 0: the device has no standard profile.
        if found == expected || found == 0 {
            return;
        }
        let found = texts::profile(found);
        let section = match self.device.role {
            Role::Drive(_) => "axes",
            Role::Module => "io",
            Role::Encoder => "encoders",
        };
        let sentence = format!(
            "{object} is {device_type:08X}h by the file, profile {found}; entries of {section} need profile {expected} ({what})"
        );
        let exchanged = [objects::CONTROL_WORD, objects::STATUS_WORD];
        let is_drive = self.device.drive().is_some() && exchanged.iter().all(|word| self.known.entry(*word).is_some());
        if is_drive {
            self.warning(&format!("{sentence}; the file has 6040h and 6041h: the device is asked when it starts"));
        } else {
            self.error(&sentence);
        }
    }

    /// Compares the bit rate of the bus (bit/s) with those of the file (kbit/s): the configured one, and the supported ones.
    fn bit_rate(&mut self, bit_rate: u32) {
        let known = self.known;
        let here = format!("bitrate of the backend is {bit_rate} bit/s");
        let own = known.commissioning.as_ref().and_then(|own| own.baud_rate).filter(|own| *own != 0);
        if let Some(own) = own.filter(|own| *own != bit_rate / 1000) {
            let sentence = format!("Baudrate is {own} kbit/s in [DeviceComissioning] of the file; {here}");
            if known.device.denies(own) {
                self.warning(&format!("{sentence}; [DeviceInfo] denies that Baudrate"));
            } else {
                self.error(&sentence);
            }
        }
        let rates = &known.device.baud_rates;
        if !rates.is_empty() && !rates.iter().any(|rate| u32::from(*rate) == bit_rate / 1000) {
            let rates: Vec<_> = rates.iter().map(u16::to_string).collect();
            let rates = rates.join(", ");
            self.warning(&format!("[DeviceInfo] of the file has the bit rates {rates} kbit/s; {here}"));
        }
    }

    /// Compares the mode of the drive, and homing in the drive, with 6502h.
    fn modes(&mut self, homes: bool) {
        let object = objects::SUPPORTED_MODES;
        let device = self.device;
        let Some((drive, offered)) = device.drive().zip(self.number(object)) else { return };
        let offers = |mode: i8| offered >> (mode - 1) & 1 == 1;
        let said = format!("{object} is {offered:08X}h by the file ({})", texts::modes(offered));
        let (mode, name) = (drive.mode.number(), drive.mode.name());
        let is_configured = self.known.entry(object).is_some_and(|entry| entry.parameter.is_some());
        if !offers(mode) {
            let is_other = |other: DriveMode| other.interface() == drive.mode.interface() && offers(other.number());
            let others: Vec<_> = DriveMode::NAMES.iter().filter(|row| is_other(row.1)).map(|row| row.0).collect();
            let cure = match others.as_slice() {
                [] => "no other mode of its interface is offered".to_owned(),
                names => format!("offered are, with its interface, mode: {}", names.join(" or ")),
            };
            let key = if is_configured { "ParameterValue" } else { "DefaultValue" };
            self.error(&format!(
                "{said}: mode {mode} ({name}) is missing; {cure}; if the drive offers it all the same, delete the {key} of 6502h in the \
                 file: the drive is asked when it starts"
            ));
        }
        if homes && !offers(HOMING) {
            let sentence = format!("{said}: mode {HOMING} (hm) is missing, and homing.in_drive is true");
            let method = objects::HOMING_METHOD;
            // 6502h is wrong in many files. A ParameterValue was read from the drive itself.
            if !is_configured && self.known.entry(method).is_some_and(|entry| entry.access.is_writable()) {
                self.warning(&format!("{sentence}; {method} of the file can be written all the same"));
            } else {
                self.error(&sentence);
            }
        }
    }
}

#[cfg(test)]
mod tests;
