//! Reads the present PDO configuration of a device.
//!
//! Law      the first eight PDOs of each direction are read one by one, further ones up to the first that is missing
//! Reads    1400h, 1600h, 1800h, 1A00h and the following indices
//! Source   CiA 301

use super::session::{CommissionError, Session};
use crate::NodeId;
use crate::eds::CobId;
use lineshaft_cia402::dictionary::{Direction, Mapped};
use lineshaft_cia402::object::Object;

/// Number of PDOs of which a device may leave out some.
const LIKELY: u16 = 8;
/// Maximum number of PDOs of each direction.
const MOST: u16 = 512;
/// Maximum number of objects of a PDO.
const MOST_MAPPED: u32 = 64;

/// PDO configuration of a device.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PdoConfiguration {
    /// Direction, from the view of the device.
    pub direction: Direction,
    /// PDO number, from 1.
    pub number: u16,
    /// COB-ID.
    pub cob_id: CobId,
    /// Transmission type.
    pub transmission: Option<u8>,
    /// Inhibit time, the minimum time between two PDOs, in units of 100 us.
    pub inhibit: Option<u32>,
    /// Event timer, in ms: maximum time between two PDOs; for a received PDO, the time after which the device reports it as missing.
    pub event_timer: Option<u32>,
    /// Mapped objects.
    pub mapped: Vec<Mapped>,
}

impl Session {
    /// Reads all PDOs, first those that the device receives.
    ///
    /// # Errors
    /// The device does not answer; the bus connection is lost.
    pub fn pdos(&mut self, node: NodeId) -> Result<Vec<PdoConfiguration>, CommissionError> {
        let mut pdos = Vec::new();
        for (direction, communication, mapping) in
            [(Direction::Receive, 0x1400, 0x1600), (Direction::Transmit, 0x1800, 0x1A00_u16)]
        {
            for offset in 0..MOST {
                match self.pdo(node, direction, offset, (communication + offset, mapping + offset))? {
                    Some(pdo) => pdos.push(pdo),
                    None if offset < LIKELY => {}
                    None => break,
                }
            }
        }
        Ok(pdos)
    }

    fn pdo(
        &mut self,
        node: NodeId,
        direction: Direction,
        offset: u16,
        (communication, mapping): (u16, u16),
    ) -> Result<Option<PdoConfiguration>, CommissionError> {
        let Some(cob_id) = self.number(node, communication, 1)? else { return Ok(None) };
        let transmission = self.number(node, communication, 2)?.map(|kind| kind as u8);
        let (inhibit, event_timer) = (self.number(node, communication, 3)?, self.number(node, communication, 5)?);
        let count = self.number(node, mapping, 0)?.filter(|count| *count <= MOST_MAPPED).unwrap_or(0);
        let mut mapped = Vec::new();
        for sub in 1..=count as u8 {
            let Some(entry) = self.number(node, mapping, sub)? else { continue };
            let [bits, of, low, high] = entry.to_le_bytes();
            mapped.push(Mapped { object: Object { index: u16::from_le_bytes([low, high]), sub: of }, bits });
        }
        let cob_id = CobId(cob_id);
        Ok(Some(PdoConfiguration { direction, number: offset + 1, cob_id, transmission, inhibit, event_timer, mapped }))
    }
}
