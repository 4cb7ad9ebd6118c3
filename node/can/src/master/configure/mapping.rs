//! Configures the PDOs of a device.
//!
//! Law      a PDO is mapped in the order that all devices accept: disable, transmission type, no entries, entries, number of entries,
//!          enable. A PDO that is already correct is not written. A PDO that cannot be disabled is mapped while it is enabled if it has the
//!          planned identifier. PDOs that are not needed are disabled. If that fails, they stay enabled, provided that their identifier is
//!          not used for other process data on the bus. Optional data on change is left out if the device refuses its PDO. The last two
//!          cases are logged as one line each
//! Refuses  a device that lacks a required PDO, or refuses its entries; a PDO that the user had to map but did not; a PDO that stays
//!          enabled with an identifier of other process data, or with its planned identifier and other entries
//! Source   CiA 301 (objects 1400h to 1BFFh)

use super::{Refusal, Session};
use crate::config::Role;
use crate::eds::CobId;
use crate::layout::{MOST_PDOS, Pdo, Transmission};
use lineshaft_cia402::dictionary::Direction;
use lineshaft_cia402::mapping::{Field, ReportedValue};
use lineshaft_cia402::object::Object;
use lineshaft_cia402::objects;
use lineshaft_cia402::sdo::SdoError;
use std::fmt;

/// Bit 31 of a COB-ID: the PDO does not exist.
const INVALID: u32 = 0x8000_0000;
/// Bit 30 of a COB-ID: remote frames are not answered.
const NO_REMOTE: u32 = 0x4000_0000;
/// Transmission types that are tried, in this order, if a device refuses 255: event-driven as the manufacturer defines it, then with each
/// SYNC.
const OTHER_TYPES: [u8; 2] = [254, 1];

impl Session<'_> {
    pub(super) fn write_pdos(&mut self) -> Result<(), Refusal> {
        for number in 1..=MOST_PDOS {
            let layout = &self.device.layout;
            match layout.asked.iter().find(|pdo| pdo.number == number) {
                Some(pdo) => self.write_pdo(Direction::Receive, pdo)?,
                None => self.switch_off(Direction::Receive, number)?,
            }
            match layout.told.iter().find(|pdo| pdo.number == number) {
                Some(pdo) => self.write_told(pdo)?,
                None => self.switch_off(Direction::Transmit, number)?,
            }
        }
        Ok(())
    }

    /// Disables a PDO that is not needed and would only load the bus. The device may keep it enabled, unless its frames would be mistaken
    /// for other process data.
    fn switch_off(&mut self, direction: Direction, number: u8) -> Result<(), Refusal> {
        match self.try_switch_off(direction, number)? {
            None => Ok(()),
            Some((refused, cob_id)) => self.accept_enabled(&refused, cob_id),
        }
    }

    /// Disables a PDO. If the device refuses that, returns the error and the COB-ID.
    fn try_switch_off(&mut self, direction: Direction, number: u8) -> Result<Option<(SdoError, CobId)>, Refusal> {
        let object = Object { index: direction.communication(number), sub: 1 };
        let Some(present) = self.number(object)? else { return Ok(None) };
        if !CobId(present).is_valid() {
            return Ok(None);
        }
        let written = self.try_write(object, &(present | INVALID).to_le_bytes())?;
        Ok(written.err().map(|refused| (refused, CobId(present))))
    }

    /// Accepts that a PDO that is not needed stays enabled, unless its identifier is that of other process data.
    fn accept_enabled(&self, refused: &SdoError, cob_id: CobId) -> Result<(), Refusal> {
        let id = cob_id.id();
        if !cob_id.is_extended() && self.is_used(id) {
            let sentence = format!(
                "{refused}; this PDO is not needed and cannot be switched off, and its identifier {id:03X}h is that of other process data"
            );
            return Err(Refusal::Wrong(sentence));
        }
        self.warn(format_args!("{refused}; this PDO is not needed and stays on, with identifier {id:03X}h"));
        Ok(())
    }

    /// Returns true if a PDO of any device of the bus has this identifier.
    fn is_used(&self, id: u32) -> bool {
        let mut layouts = self.bus.devices.iter().map(|device| &device.layout);
        layouts.any(|layout| {
            let asked = layout.asked.iter().map(|pdo| pdo.id);
            asked.chain(layout.told.iter().map(|pdo| pdo.id)).any(|used| u32::from(used.get()) == id)
        })
    }

    /// Maps a PDO that the device sends. A PDO on change is left out if the device refuses it, unless it carries digital inputs, from which
    /// the limit switches of the drive are read.
    fn write_told(&mut self, pdo: &Pdo<ReportedValue>) -> Result<(), Refusal> {
        let has_inputs = pdo.fields.iter().any(|field| field.word == ReportedValue::Inputs);
        let is_optional = pdo.transmission == Transmission::OnChange && !has_inputs;
        match self.write_pdo(Direction::Transmit, pdo) {
            Err(Refusal::Wrong(why)) if is_optional => {
                match self.try_switch_off(Direction::Transmit, pdo.number)? {
                    // The PDO stays enabled, and its data would be interpreted as the planned objects.
                    Some((_, cob_id)) if has_planned_id(cob_id, pdo) => return Err(Refusal::Wrong(why)),
                    Some((refused, cob_id)) => self.accept_enabled(&refused, cob_id)?,
                    None => {}
                }
                let objects: Vec<_> = pdo.fields.iter().map(|field| field.object.to_string()).collect();
                self.warn(format_args!("{why}; PDO {} is left out: {}", pdo.number, objects.join(", ")));
                Ok(())
            }
            done => done,
        }
    }

    /// Writes a transmission type. Other types are tried if a device refuses 255.
    fn write_transmission(&mut self, object: Object, transmission: Transmission) -> Result<(), Refusal> {
        let wanted = transmission.number();
        let Err(refused) = self.try_write(object, &[wanted])? else { return Ok(()) };
        if transmission == Transmission::OnChange {
            for other in OTHER_TYPES {
                if self.try_write(object, &[other])?.is_ok() {
                    self.warn(format_args!("{refused}; transmission type {other} is used instead of {wanted}"));
                    return Ok(());
                }
            }
        }
        Err(refused.into())
    }

    /// Writes an object. The inner error is a refusal of the device.
    fn try_write(&mut self, object: Object, data: &[u8]) -> Result<Result<(), SdoError>, Refusal> {
        match self.port.write(self.device.node, object, data) {
            Err(error @ SdoError::Refused(..)) => return Ok(Err(error)),
            done => done?,
        }
        self.written += 1;
        Ok(Ok(()))
    }

    fn warn(&self, what: fmt::Arguments<'_>) {
        tracing::warn!("{}: {}: {what}", self.bus.name, self.device);
    }

    /// Maps a PDO in the order that all devices accept: disable, transmission type, no entries, entries, number of entries, enable. A PDO
    /// that has the planned identifier and cannot be disabled is mapped while it is enabled: the device sends and receives no PDOs before
    /// it is operational.
    fn write_pdo<W: Copy>(&mut self, direction: Direction, pdo: &Pdo<W>) -> Result<(), Refusal> {
        let (communication, mapping) = (direction.communication(pdo.number), direction.mapping(pdo.number));
        let at = |index, sub| Object { index, sub };
        let entry =
            |field: &Field<W>| u32::from(field.object.index) << 16 | u32::from(field.object.sub) << 8 | field.bits;
        let entries: Vec<u32> = pdo.fields.iter().map(entry).collect();
        let kind = pdo.transmission.number();
        let found = self.number(at(communication, 1))?.ok_or_else(|| missing(at(communication, 1), pdo.number))?;
        // The bit for remote frames stays, as they are not used.
        let id = u32::from(pdo.id.get()) | found & NO_REMOTE;
        let is_mapped = match pdo.is_mapped {
            true => self.has_entries(direction, pdo.number, &entries)?,
            false => self.check_lengths(mapping, &entries).map(|()| true)?,
        };
        let has_id = CobId(found).is_valid() && has_planned_id(CobId(found), pdo);
        let has_type = has_id && self.number(at(communication, 2))? == Some(kind.into());
        if has_type && is_mapped {
            return Ok(());
        }
        let is_off = match self.try_write(at(communication, 1), &(id | INVALID).to_le_bytes())? {
            Ok(()) => true,
            Err(_) if has_id => false,
            Err(refused) => return Err(refused.into()),
        };
        let cob_id = at(communication, 1);
        let named = |refusal: Refusal| if is_off { refusal } else { with_cob_id(refusal, cob_id, pdo.number) };
        if is_off || !has_type {
            self.write_transmission(at(communication, 2), pdo.transmission).map_err(named)?;
        }
        if !is_mapped {
            self.write_entries(mapping, &pdo.fields, &entries).map_err(named)?;
        }
        if is_off { self.write(cob_id, &id.to_le_bytes()) } else { Ok(()) }
    }

    /// Writes the entries of a PDO: first none, then each entry, then their number.
    fn write_entries<W>(&mut self, mapping: u16, fields: &[Field<W>], entries: &[u32]) -> Result<(), Refusal> {
        let at = |sub| Object { index: mapping, sub };
        self.write(at(0), &[0])?;
        for ((sub, entry), field) in (1..).zip(entries).zip(fields) {
            let written = self.write(at(sub), &entry.to_le_bytes());
            written.map_err(|refusal| with_object(refusal, field.object))?;
        }
        self.write(at(0), &[entries.len() as u8])
    }

    /// Returns an error if the user has mapped objects of other lengths to a PDO, because its data would be misinterpreted.
    fn check_lengths(&mut self, mapping: u16, entries: &[u32]) -> Result<(), Refusal> {
        let count = self.number(Object { index: mapping, sub: 0 })?.unwrap_or_default();
        let mut found = Vec::new();
        for sub in 1..=count.min(64) as u8 {
            found.push(self.number(Object { index: mapping, sub })?.unwrap_or_default());
        }
        let (has, needs) = (lengths(&found), lengths(entries));
        let sentence = format!("{mapping:04X}h maps {has}; {needs} are expected, mapped before the drive is used here");
        if has == needs { Ok(()) } else { Err(Refusal::Wrong(sentence)) }
    }

    /// Returns true if a PDO carries these entries. Further entries that a module sends are ignored, as its mapping may be fixed.
    fn has_entries(&mut self, direction: Direction, number: u8, entries: &[u32]) -> Result<bool, Refusal> {
        let mapping = direction.mapping(number);
        let count = self.number(Object { index: mapping, sub: 0 })?.unwrap_or_default() as usize;
        let more = match (direction, &self.device.role) {
            (Direction::Transmit, Role::Module) => 8,
            _ => 0,
        };
        if !(entries.len()..=entries.len() + more).contains(&count) {
            return Ok(false);
        }
        for (sub, entry) in (1..).zip(entries) {
            if self.number(Object { index: mapping, sub })? != Some(*entry) {
                return Ok(false);
            }
        }
        Ok(true)
    }
}

/// Returns true if a COB-ID has the identifier that is planned for a PDO.
fn has_planned_id<W>(cob_id: CobId, pdo: &Pdo<W>) -> bool {
    !cob_id.is_extended() && cob_id.id() == u32::from(pdo.id.get())
}

/// Adds the COB-ID that keeps a PDO enabled to the message about its objects.
fn with_cob_id(refusal: Refusal, cob_id: Object, number: u8) -> Refusal {
    match refusal {
        Refusal::Wrong(why) => Refusal::Wrong(format!("PDO {number} cannot be mapped: {cob_id} is read-only; {why}")),
        other => other,
    }
}

/// Returns the lengths of mapped objects as text, in bytes.
fn lengths(entries: &[u32]) -> String {
    let bytes: Vec<_> = entries.iter().map(|entry| ((entry & 0xFF) / 8).to_string()).collect();
    if bytes.is_empty() { "nothing".to_owned() } else { format!("{} bytes", bytes.join(", ")) }
}

/// Adds the object that a device does not map to the message.
fn with_object(refusal: Refusal, object: Object) -> Refusal {
    let is_mode = [objects::MODE, objects::MODE_DISPLAY].contains(&object);
    let cure =
        if is_mode { "; it goes by SDO if the EDS of the drive (key eds) says that it cannot be mapped" } else { "" };
    match refusal {
        Refusal::Wrong(why) => Refusal::Wrong(format!("{object} cannot be mapped to a PDO: {why}{cure}")),
        other => other,
    }
}

fn missing(object: Object, number: u8) -> Refusal {
    Refusal::Wrong(format!("{object} does not exist: the device has no PDO {number}"))
}
