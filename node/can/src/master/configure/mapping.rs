//! The PDOs of a device under configuration.
//!
//! Law      a PDO is mapped by the sequence that all devices take: off, no objects, the objects, their number, type, on; one that is as it should be
//!          is left alone. PDOs that nobody needs are switched off
//! Refuses  a device without a PDO that is needed, or that does not take its objects; one that somebody else was to map, and did not
//! Source   CiA 301 (objects 1400h to 1BFFh)

use super::{Refusal, Session};
use crate::config::Role;
use crate::drive::layout::{Field, MOST_PDOS, Pdo};
use crate::eds::{CobId, Direction};
use crate::sdo::Object;

/// Bit 31 of a COB-ID: the PDO does not exist.
const INVALID: u32 = 0x8000_0000;
/// Bit 30 of a COB-ID: remote frames are not answered.
const NO_REMOTE: u32 = 0x4000_0000;

impl Session<'_> {
    pub(super) fn write_pdos(&mut self) -> Result<(), Refusal> {
        for number in 1..=MOST_PDOS {
            let layout = &self.device.layout;
            match layout.asked.iter().find(|pdo| pdo.number == number) {
                Some(pdo) => self.write_pdo(Direction::Receive, pdo)?,
                None => self.switch_off(Direction::Receive, number)?,
            }
            match layout.told.iter().find(|pdo| pdo.number == number) {
                Some(pdo) => self.write_pdo(Direction::Transmit, pdo)?,
                None => self.switch_off(Direction::Transmit, number)?,
            }
        }
        Ok(())
    }

    /// A PDO that nobody needs would only load the bus.
    fn switch_off(&mut self, direction: Direction, number: u8) -> Result<(), Refusal> {
        let cob_id = Object { index: direction.communication(number), sub: 1 };
        let Some(present) = self.number(cob_id)? else { return Ok(()) };
        if CobId(present).is_valid() { self.write(cob_id, &(present | INVALID).to_le_bytes()) } else { Ok(()) }
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
        self.write(at(communication, 2), &[kind])?;
        if !is_mapped {
            self.write(at(mapping, 0), &[0])?;
            for (sub, entry) in (1..).zip(&entries) {
                self.write(at(mapping, sub), &entry.to_le_bytes())?;
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

fn missing(object: Object, number: u8) -> Refusal {
    Refusal::Wrong(format!("{object} does not exist: the device has no PDO {number}"))
}
