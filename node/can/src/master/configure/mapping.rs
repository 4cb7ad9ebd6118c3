//! The PDOs of a device under configuration.
//!
//! Law      a PDO is mapped by the sequence that all devices take: off, no objects, the objects, their number, type, on; one that is as it should be
//!          is left alone. PDOs that are not needed are switched off. One that the device keeps on is left so if nothing else on the bus has
//!          its identifier. Data on change that is optional is left out if the device refuses its PDO. Both are one line of the log
//! Refuses  a device without a PDO that is needed, or that does not take its objects; one that somebody else was to map, and did not; one
//!          whose PDO stays on with an identifier of other process data
//! Source   CiA 301 (objects 1400h to 1BFFh)

use super::{Refusal, Session};
use crate::config::Role;
use crate::drive::layout::{Field, MOST_PDOS, Pdo, Told, Transmission};
use crate::drive::objects;
use crate::eds::{CobId, Direction};
use crate::sdo::{Object, SdoError};
use std::fmt;

/// Bit 31 of a COB-ID: the PDO does not exist.
const INVALID: u32 = 0x8000_0000;
/// Bit 30 of a COB-ID: remote frames are not answered.
const NO_REMOTE: u32 = 0x4000_0000;
/// Transmission types that are tried, in this order, if a device refuses 255: event-driven as its maker has it, then with each SYNC.
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

    /// Switches off a PDO that is not needed: it would only load the bus. The device may keep it on, unless its frames would be mistaken for
    /// other process data.
    fn switch_off(&mut self, direction: Direction, number: u8) -> Result<(), Refusal> {
        let cob_id = Object { index: direction.communication(number), sub: 1 };
        let Some(present) = self.number(cob_id)? else { return Ok(()) };
        if !CobId(present).is_valid() {
            return Ok(());
        }
        let Err(refused) = self.try_write(cob_id, &(present | INVALID).to_le_bytes())? else { return Ok(()) };
        let id = CobId(present).id();
        if !CobId(present).is_extended() && self.is_used(id) {
            let sentence = format!(
                "{refused}; this PDO is not needed and cannot be switched off, and its identifier {id:03X}h is that of other process data"
            );
            return Err(Refusal::Wrong(sentence));
        }
        self.warn(format_args!("{refused}; this PDO is not needed and stays on, with identifier {id:03X}h"));
        Ok(())
    }

    /// Whether a PDO of any device of the bus has this identifier.
    fn is_used(&self, id: u32) -> bool {
        let mut layouts = self.bus.devices.iter().map(|device| &device.layout);
        layouts.any(|layout| {
            let asked = layout.asked.iter().map(|pdo| pdo.id);
            asked.chain(layout.told.iter().map(|pdo| pdo.id)).any(|used| u32::from(used.get()) == id)
        })
    }

    /// Maps a PDO that the device sends. One on change is left out if the device refuses it, unless it carries digital inputs: limit switches of
    /// the drive are read from there.
    fn write_told(&mut self, pdo: &Pdo<Told>) -> Result<(), Refusal> {
        let has_inputs = pdo.fields.iter().any(|field| field.word == Told::Inputs);
        let is_optional = pdo.transmission == Transmission::OnChange && !has_inputs;
        match self.write_pdo(Direction::Transmit, pdo) {
            Err(Refusal::Wrong(why)) if is_optional => {
                self.switch_off(Direction::Transmit, pdo.number)?;
                let objects: Vec<_> = pdo.fields.iter().map(|field| field.object.to_string()).collect();
                self.warn(format_args!("{why}; PDO {} is left out: {}", pdo.number, objects.join(", ")));
                Ok(())
            }
            done => done,
        }
    }

    /// Writes a transmission type. Another one is tried if a device refuses 255.
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

    /// Writes an object; the inner error is that of a device that refuses it.
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

    /// Maps a PDO by the sequence that all devices take: off, no objects, the objects, their number, type, on.
    fn write_pdo<W: Copy>(&mut self, direction: Direction, pdo: &Pdo<W>) -> Result<(), Refusal> {
        let (communication, mapping) = (direction.communication(pdo.number), direction.mapping(pdo.number));
        let at = |index, sub| Object { index, sub };
        let entry =
            |field: &Field<W>| u32::from(field.object.index) << 16 | u32::from(field.object.sub) << 8 | field.bits;
        let entries: Vec<u32> = pdo.fields.iter().map(entry).collect();
        let kind = pdo.transmission.number();
        let found = self.number(at(communication, 1))?.ok_or_else(|| missing(at(communication, 1), pdo.number))?;
        // Remote frames that ask for a PDO were never of use.
        let id = u32::from(pdo.id.get()) | found & NO_REMOTE;
        let is_mapped = match pdo.is_mapped {
            true => self.has_entries(direction, pdo.number, &entries)?,
            false => self.check_lengths(mapping, &entries).map(|()| true)?,
        };
        let is_there = CobId(found).is_valid()
            && CobId(found).id() == CobId(id).id()
            && self.number(at(communication, 2))? == Some(kind.into());
        if is_there && is_mapped {
            return Ok(());
        }
        self.write(at(communication, 1), &(id | INVALID).to_le_bytes())?;
        self.write_transmission(at(communication, 2), pdo.transmission)?;
        if !is_mapped {
            self.write(at(mapping, 0), &[0])?;
            for ((sub, entry), field) in (1..).zip(&entries).zip(&pdo.fields) {
                let written = self.write(at(mapping, sub), &entry.to_le_bytes());
                written.map_err(|refusal| not_mapped(refusal, field.object))?;
            }
            self.write(at(mapping, 0), &[entries.len() as u8])?;
        }
        self.write(at(communication, 1), &id.to_le_bytes())
    }

    /// Refuses a PDO that somebody else has mapped to objects of other lengths: its words would be taken for others.
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

    /// Does a PDO carry these objects? What a module sends behind them is passed over: its mapping may be fixed.
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

/// Lengths of mapped objects in a sentence (bytes).
fn lengths(entries: &[u32]) -> String {
    let bytes: Vec<_> = entries.iter().map(|entry| ((entry & 0xFF) / 8).to_string()).collect();
    if bytes.is_empty() { "nothing".to_owned() } else { format!("{} bytes", bytes.join(", ")) }
}

/// Names the object that a device does not map.
fn not_mapped(refusal: Refusal, object: Object) -> Refusal {
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
