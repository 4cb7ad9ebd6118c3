//! PDO mappings of a dictionary.
//!
//! Law      PDO n has the COB-ID of 1400h + n - 1 (received by the device) or 1800h + n - 1 (sent by it), and carries the objects that
//!          1600h or 1A00h + n - 1 list: index, subindex and length in bits of each object
//! Reads    the configuration value, otherwise the default value
//! Refuses  a PDO that the dictionary lacks, missing values, more than 64 objects or 64 bits
//! Source   CiA 301, objects 1400h to 1BFFh

use super::dictionary::Dictionary;
use lineshaft_cia402::dictionary::{Direction, Mapped};
use lineshaft_cia402::object::Object;

/// Maximum number of PDOs of each direction.
const MOST_PDOS: u16 = 512;
/// Maximum number of objects, and of bits, of a PDO.
const MOST: u32 = 64;

/// COB-ID of a PDO: identifier and flags.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CobId(pub u32);

impl CobId {
    /// Returns true if the PDO exists (bit 31 is 0).
    pub fn is_valid(self) -> bool {
        self.0 & 0x8000_0000 == 0
    }

    /// Returns true if a remote frame may request the PDO (bit 30 is 0).
    pub fn allows_remote(self) -> bool {
        self.0 & 0x4000_0000 == 0
    }

    /// Returns true if the identifier has 29 bits (bit 29 is 1).
    pub fn is_extended(self) -> bool {
        self.0 & 0x2000_0000 != 0
    }

    /// Returns the identifier.
    pub fn id(self) -> u32 {
        self.0 & if self.is_extended() { 0x1FFF_FFFF } else { 0x7FF }
    }
}

/// PDO with its mapping.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PdoMapping {
    /// COB-ID.
    pub cob_id: CobId,
    /// Transmission type; `None` if the file does not give it.
    pub transmission_type: Option<u8>,
    /// Mapped objects, in their order.
    pub mapped: Vec<Mapped>,
}

/// Reason why the dictionary does not describe a PDO completely.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PdoError {
    /// The PDO number is out of range.
    #[error("PDO {0} does not exist: PDOs have the numbers 1 to 512")]
    Number(u16),
    /// An object is missing.
    #[error("{0} does not exist in the dictionary")]
    Missing(Object),
    /// An object has no value, or (flag) only one that depends on the unknown node ID.
    #[error("{0} has no value in the dictionary{because}", because = if *.1 { ", as the node id is not known" } else { "" })]
    NoValue(Object, bool),
    /// A value is invalid.
    #[error("{0} is {1}, which is no value of this object")]
    Wrong(Object, i128),
    /// The objects are longer than a PDO.
    #[error("the objects that {0} lists have {1} bits together; a PDO has 64")]
    Long(Object, u32),
}

impl Dictionary {
    /// Returns a PDO of the device, `number` from 1.
    ///
    /// # Errors
    /// The dictionary lacks the PDO, or describes it incompletely.
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
    pub fn find_pdo_with(&self, direction: Direction, object: Object) -> Option<u16> {
        let (_, first) = direction.first();
        let carries = |number: &u16| {
            let mapped = self.mapped(first.saturating_add(number.saturating_sub(1)));
            mapped.is_ok_and(|mapped| mapped.iter().any(|mapped| mapped.object == object))
        };
        (1..=MOST_PDOS).find(carries)
    }

    /// Returns the objects that the mapping with this index lists.
    fn mapped(&self, mapping: u16) -> Result<Vec<Mapped>, PdoError> {
        let count = Object { index: mapping, sub: 0 };
        let most = self.number_of(count)?;
        // 254 and 255 mean a multiplexed PDO, which is not supported.
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
