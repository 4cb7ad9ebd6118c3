//! What PDOs carry, by the dictionary.
//!
//! Law      PDO n is sent with the COB-ID of 1400h + n - 1 (received by the device) or 1800h + n - 1 (sent by it), and carries what 1600h or
//!          1A00h + n - 1 list: index, subindex and length in bits of each object
//! Reads    the value of the configuration, or else the default
//! Refuses  a PDO that the dictionary does not have, values that are missing, more than 64 objects or 64 bits
//! Source   CiA 301, objects 1400h to 1BFFh

use super::dictionary::Dictionary;
use crate::sdo::Object;

/// PDOs of each direction.
const MOST_PDOS: u16 = 512;
/// Objects of a PDO, and its bits.
const MOST: u32 = 64;

/// Which way a PDO goes, seen from the device.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// The device receives it.
    Receive,
    /// The device sends it.
    Transmit,
}

impl Direction {
    /// First index of the communication parameters and of the mapping.
    fn first(self) -> (u16, u16) {
        match self {
            Self::Receive => (0x1400, 0x1600),
            Self::Transmit => (0x1800, 0x1A00),
        }
    }

    /// Index of the communication parameters of a PDO, from 1.
    pub fn communication(self, number: u8) -> u16 {
        self.first().0 + u16::from(number.max(1)) - 1
    }

    /// Index of its mapping.
    pub fn mapping(self, number: u8) -> u16 {
        self.first().1 + u16::from(number.max(1)) - 1
    }
}

/// The identifier of a PDO and what stands beside it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CobId(pub u32);

impl CobId {
    /// Does the PDO exist? (Bit 31 is 0.)
    pub fn is_valid(self) -> bool {
        self.0 & 0x8000_0000 == 0
    }

    /// May it be asked for with a remote frame? (Bit 30 is 0.)
    pub fn allows_remote(self) -> bool {
        self.0 & 0x4000_0000 == 0
    }

    /// Has the identifier 29 bits? (Bit 29.)
    pub fn is_extended(self) -> bool {
        self.0 & 0x2000_0000 != 0
    }

    /// The identifier.
    pub fn id(self) -> u32 {
        self.0 & if self.is_extended() { 0x1FFF_FFFF } else { 0x7FF }
    }
}

/// An object in a PDO.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Mapped {
    /// Which one.
    pub object: Object,
    /// Its length.
    pub bits: u8,
}

/// A PDO.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PdoMapping {
    /// Its identifier.
    pub cob_id: CobId,
    /// When it goes; none where the file does not say.
    pub transmission_type: Option<u8>,
    /// What it carries, in order.
    pub mapped: Vec<Mapped>,
}

/// Why the dictionary does not say what a PDO is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PdoError {
    /// There is no such number.
    #[error("PDO {0} does not exist: PDOs have the numbers 1 to 512")]
    Number(u16),
    /// An object is missing.
    #[error("{0} does not exist in the dictionary")]
    Missing(Object),
    /// An object has no value there, or one that is not known without the node id.
    #[error("{0} has no value in the dictionary{because}", because = if *.1 { ", as the node id is not known" } else { "" })]
    NoValue(Object, bool),
    /// A value does not mean anything here.
    #[error("{0} is {1}, which is no value of this object")]
    Wrong(Object, i128),
    /// The objects are too long.
    #[error("the objects that {0} lists have {1} bits together; a PDO has 64")]
    Long(Object, u32),
}

impl Dictionary {
    /// What a PDO of the device is, `number` from 1.
    ///
    /// # Errors
    /// A PDO that the dictionary does not have or does not say enough of.
    pub fn pdo_mapping(&self, direction: Direction, number: u16) -> Result<PdoMapping, PdoError> {
        let offset = number.checked_sub(1).filter(|offset| *offset < MOST_PDOS).ok_or(PdoError::Number(number))?;
        let (communication, mapping) = direction.first();
        let (communication, mapping) = (communication.saturating_add(offset), mapping.saturating_add(offset));
        let cob_id = self.number_of(Object { index: communication, sub: 1 })?;
        let kind = Object { index: communication, sub: 2 };
        let transmission_type = match self.number_of(kind) {
            Ok(value) => Some(u8::try_from(value).map_err(|_| PdoError::Wrong(kind, i128::from(value)))?),
            Err(PdoError::Missing(_) | PdoError::NoValue(..)) => None,
            Err(error) => return Err(error),
        };
        Ok(PdoMapping { cob_id: CobId(cob_id), transmission_type, mapped: self.mapped(mapping)? })
    }

    /// Returns the number of the first PDO, from 1, whose mapping in the file lists an object.
    pub fn carrier(&self, direction: Direction, object: Object) -> Option<u16> {
        let (_, first) = direction.first();
        let carries = |number: &u16| {
            let mapped = self.mapped(first.saturating_add(number.saturating_sub(1)));
            mapped.is_ok_and(|mapped| mapped.iter().any(|mapped| mapped.object == object))
        };
        (1..=MOST_PDOS).find(carries)
    }

    /// Returns the objects that a mapping lists, by its index.
    fn mapped(&self, mapping: u16) -> Result<Vec<Mapped>, PdoError> {
        let count = Object { index: mapping, sub: 0 };
        let most = self.number_of(count)?;
        // 254 and 255 say that the PDO is multiplexed, which needs another form.
        let last = u8::try_from(most).ok().filter(|last| u32::from(*last) <= MOST);
        let last = last.ok_or(PdoError::Wrong(count, i128::from(most)))?;
        let (mut mapped, mut bits) = (Vec::new(), 0_u32);
        for sub in 1..=last {
            let [length, of, low, high] = self.number_of(Object { index: mapping, sub })?.to_le_bytes();
            mapped.push(Mapped { object: Object { index: u16::from_le_bytes([low, high]), sub: of }, bits: length });
            bits = bits.saturating_add(u32::from(length));
        }
        if bits > MOST {
            return Err(PdoError::Long(Object { index: mapping, sub: 0 }, bits));
        }
        Ok(mapped)
    }

    fn number_of(&self, object: Object) -> Result<u32, PdoError> {
        let entry = self.entry(object).ok_or(PdoError::Missing(object))?;
        let is_given = entry.parameter.is_some() || entry.default.is_some();
        let value = self.value(object).ok_or(PdoError::NoValue(object, is_given))?;
        let number = value.number().ok_or(PdoError::NoValue(object, false))?;
        u32::try_from(number).map_err(|_| PdoError::Wrong(object, number))
    }
}

#[cfg(test)]
mod tests;
