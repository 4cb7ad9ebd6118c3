//! The PDOs of a device under configuration.
//!
//! Law      a PDO is mapped by the sequence that all devices take: off, type, no objects, the objects, their number, on; one that is as it
//!          should be is left alone. One that has its identifier and that the device keeps on is mapped while it is on. PDOs that are not
//!          needed are switched off. One that the device keeps on is left so if nothing else on the bus has its identifier. Data on change
//!          that is optional is left out if the device refuses its PDO. Both are one line of the log
//! Refuses  a device without a PDO that is needed, or that does not take its objects; one that somebody else was to map, and did not; one
//!          whose PDO stays on with an identifier of other process data, or with its own and other objects
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
        match self.try_switch_off(direction, number)? {
            None => Ok(()),
            Some((refused, cob_id)) => self.keep_on(&refused, cob_id),
        }
    }

    /// Switches off a PDO. If the device refuses that, it stays on: returns why, and its COB-ID.
    fn try_switch_off(&mut self, direction: Direction, number: u8) -> Result<Option<(SdoError, CobId)>, Refusal> {
        let object = Object { index: direction.communication(number), sub: 1 };
        let Some(present) = self.number(object)? else { return Ok(None) };
        if !CobId(present).is_valid() {
            return Ok(None);
        }
        let written = self.try_write(object, &(present | INVALID).to_le_bytes())?;
        Ok(written.err().map(|refused| (refused, CobId(present))))
    }

    /// Accepts that a PDO that is not needed stays on, unless its identifier is that of other process data.
    fn keep_on(&self, refused: &SdoError, cob_id: CobId) -> Result<(), Refusal> {
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
                match self.try_switch_off(Direction::Transmit, pdo.number)? {
                    // It stays on, and its data would be treated as the objects of the plan.
                    Some((_, cob_id)) if has_planned_id(cob_id, pdo) => return Err(Refusal::Wrong(why)),
                    Some((refused, cob_id)) => self.keep_on(&refused, cob_id)?,
                    None => {}
                }
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

    /// Maps a PDO by the sequence that all devices take: off, type, no objects, the objects, their number, on. A PDO that has its identifier and
    /// cannot be switched off is mapped while it is on: the device sends and receives no PDOs before it is operational.
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
        let named = |refusal: Refusal| if is_off { refusal } else { is_kept_on(refusal, cob_id, pdo.number) };
        if is_off || !has_type {
            self.write_transmission(at(communication, 2), pdo.transmission).map_err(named)?;
        }
        if !is_mapped {
            self.write_entries(mapping, &pdo.fields, &entries).map_err(named)?;
        }
        if is_off { self.write(cob_id, &id.to_le_bytes()) } else { Ok(()) }
    }

    /// Writes the objects of a PDO: none, each of them, their number.
    fn write_entries<W>(&mut self, mapping: u16, fields: &[Field<W>], entries: &[u32]) -> Result<(), Refusal> {
        let at = |sub| Object { index: mapping, sub };
        self.write(at(0), &[0])?;
        for ((sub, entry), field) in (1..).zip(entries).zip(fields) {
            let written = self.write(at(sub), &entry.to_le_bytes());
            written.map_err(|refusal| not_mapped(refusal, field.object))?;
        }
        self.write(at(0), &[entries.len() as u8])
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

/// Whether a COB-ID has the identifier that a PDO is planned with.
fn has_planned_id<W>(cob_id: CobId, pdo: &Pdo<W>) -> bool {
    !cob_id.is_extended() && cob_id.id() == u32::from(pdo.id.get())
}

/// Names the COB-ID that keeps a PDO on, and with it its objects.
fn is_kept_on(refusal: Refusal, cob_id: Object, number: u8) -> Refusal {
    match refusal {
        Refusal::Wrong(why) => Refusal::Wrong(format!("PDO {number} cannot be mapped: {cob_id} is read-only; {why}")),
        other => other,
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
