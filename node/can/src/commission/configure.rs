//! Writes a configuration (DCF) to a device.
//!
//! Law      every object is read first and written only if its value differs. A PDO that differs is disabled, mapped and enabled again, so
//!          that no partly written mapping is ever used on the bus. An object that can only change while another one is disabled is written
//!          in that order
//! Reads    the values that a DCF writes ([`Dictionary::configured_values`](crate::eds::Dictionary::configured_values)), except objects that act or are
//!          setpoints ([`acts`])
//! Refuses  a drive that is enabled; the first object that the device refuses ends the configuration
//! Source   CiA 301 (1400h to 1BFFh, 1006h and 1019h, 1014h), CiA 306-1

use super::session::{CommissionError, Session};
use crate::NodeId;
use crate::acts::{self, LeftOut, LeftOutReason};
use crate::can_objects;
use lineshaft_cia402::object::Object;
use lineshaft_cia402::objects;
use lineshaft_cia402::texts::{drive_state, number};
use lineshaft_core::drive::DriveState;
use std::collections::BTreeMap;
use std::time::Duration;

/// Bit 31 of a COB-ID: the object is disabled.
const INVALID: u32 = 0x8000_0000;
/// Signature that 1010h requires before the device stores its parameters.
const SAVE: &[u8; 4] = b"save";
/// Time that a device may take to store its parameters.
const STORE: Duration = Duration::from_secs(10);

/// Result of a configuration.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Configured {
    /// Number of objects that were compared.
    pub compared: usize,
    /// Objects that differed and were written.
    pub written: Vec<Object>,
    /// Objects that were left out, because they act or are setpoints.
    pub left_out: LeftOut,
}

/// Communication and mapping objects of one PDO.
#[derive(Default)]
struct Pdo<'a> {
    communication: BTreeMap<u8, &'a [u8]>,
    mapping: BTreeMap<u8, &'a [u8]>,
}

/// Returns the communication and mapping indices of the PDO to which an index belongs, and whether the index is the mapping.
fn pdo_of(index: u16) -> Option<((u16, u16), bool)> {
    match index {
        0x1400..=0x15FF | 0x1800..=0x19FF => Some(((index, index + 0x200), false)),
        0x1600..=0x17FF | 0x1A00..=0x1BFF => Some(((index - 0x200, index), true)),
        _ => None,
    }
}

impl Session {
    /// Writes the objects that differ. Calls `progress` with the number of finished objects and the total number.
    ///
    /// # Errors
    /// The drive is enabled; the device refuses an object or does not answer; the bus connection is lost.
    pub fn configure(
        &mut self,
        node: NodeId,
        values: &[(Object, Vec<u8>)],
        progress: &mut dyn FnMut(usize, usize),
    ) -> Result<Configured, CommissionError> {
        self.check_not_enabled(node)?;
        let mut done = Configured::default();
        let mut pdos: BTreeMap<(u16, u16), Pdo<'_>> = BTreeMap::new();
        let mut profiles = BTreeMap::new();
        for (object, data) in values {
            if let Some(reason) = self.left_out(node, *object, &mut profiles)? {
                done.left_out.0.push((*object, reason));
            } else if let Some((place, is_mapping)) = pdo_of(object.index) {
                let pdo = pdos.entry(place).or_default();
                let part = if is_mapping { &mut pdo.mapping } else { &mut pdo.communication };
                part.insert(object.sub, data);
            } else {
                done.compared += 1;
                if self.differs(node, *object, data)? {
                    self.write_object(node, *object, data)?;
                    done.written.push(*object);
                }
                progress(done.compared, values.len());
            }
        }
        for (place, pdo) in pdos {
            self.write_pdo(node, place, &pdo, &mut done)?;
            progress(done.compared, values.len());
        }
        Ok(done)
    }

    /// Returns the reason why an object is left out, if it is. If the reason depends on profiles, each profile is read from the device
    /// once.
    fn left_out(
        &mut self,
        node: NodeId,
        object: Object,
        profiles: &mut BTreeMap<Object, Option<u16>>,
    ) -> Result<Option<LeftOutReason>, CommissionError> {
        let in_any = acts::reason(object, None);
        let (Some(_), Some(device_type)) = (in_any, acts::device_type(object.index)) else { return Ok(in_any) };
        let profile = match profiles.get(&device_type) {
            Some(known) => *known,
            None => {
                let found = self.profile(node, device_type)?;
                profiles.insert(device_type, found);
                found
            }
        };
        Ok(acts::reason(object, profile))
    }

    /// Returns the profile in a device type object. If a further logical device has none, the profile of the first one applies.
    fn profile(&mut self, node: NodeId, device_type: Object) -> Result<Option<u16>, CommissionError> {
        let own = self.number(node, device_type.index, device_type.sub)?.and_then(acts::profile_number);
        if own.is_some() || device_type == objects::DEVICE_TYPE {
            return Ok(own);
        }
        self.profile(node, objects::DEVICE_TYPE)
    }

    /// Stores the parameters of a device permanently ("save" to 1010h:01).
    ///
    /// # Errors
    /// The device refuses or does not answer.
    pub fn store(&mut self, node: NodeId) -> Result<(), CommissionError> {
        self.write_within(node, Object { index: 0x1010, sub: 1 }, SAVE, STORE)
    }

    /// Returns an error if vendor or product code of a device differ from the given ones; 0 and `None` match any value.
    ///
    /// # Errors
    /// Vendor or product code differ, or the device does not answer.
    pub fn check_identity(
        &mut self,
        node: NodeId,
        vendor: Option<u32>,
        product: Option<u32>,
    ) -> Result<(), CommissionError> {
        for (sub, what, expected) in [(1, "vendor (1018h:01)", vendor), (2, "product code (1018h:02)", product)] {
            let Some(expected) = expected.filter(|expected| *expected != 0) else { continue };
            if let Some(found) = self.number(node, 0x1018, sub)?.filter(|found| *found != expected) {
                return Err(CommissionError::Other { node, what, found, expected });
            }
        }
        Ok(())
    }

    fn check_not_enabled(&mut self, node: NodeId) -> Result<(), CommissionError> {
        let Some(status) = self.number(node, objects::STATUS_WORD.index, 0)?.map(|status| status as u16) else {
            return Ok(());
        };
        let state = DriveState::from_status(status);
        match state {
            DriveState::Enabled | DriveState::QuickStop | DriveState::FaultReaction => {
                Err(CommissionError::Enabled { node, state: drive_state(state), status })
            }
            _ => Ok(()),
        }
    }

    /// Returns true if the object of the device has another value, or cannot be read.
    fn differs(&mut self, node: NodeId, object: Object, data: &[u8]) -> Result<bool, CommissionError> {
        Ok(self.read_optional(node, object)?.is_none_or(|present| present != data))
    }

    /// Writes an object that belongs to no PDO, and disables the object on which it depends meanwhile.
    fn write_object(&mut self, node: NodeId, object: Object, data: &[u8]) -> Result<(), CommissionError> {
        let period = can_objects::CYCLE_PERIOD;
        match object {
            // 1019h can change only while the period 1006h is 0.
            can_objects::SYNC_OVERFLOW => {
                let present = self.read_optional(node, period)?.filter(|present| present.iter().any(|byte| *byte != 0));
                let Some(present) = present else { return self.write(node, object, data) };
                self.write(node, period, &[0; 4])?;
                self.write(node, object, data)?;
                self.write(node, period, &present)
            }
            // 1014h can change only while emergency messages are disabled.
            Object { index: 0x1014, sub: 0 } => {
                if let Some(present) = self.number(node, 0x1014, 0)?.filter(|present| present & INVALID == 0) {
                    self.write(node, object, &(present | INVALID).to_le_bytes())?;
                }
                if number(data).is_some_and(|wanted| wanted & INVALID == 0) {
                    let off = number(data).unwrap_or_default() | INVALID;
                    self.write(node, object, &off.to_le_bytes())?;
                }
                self.write(node, object, data)
            }
            _ => self.write(node, object, data),
        }
    }

    /// Writes a PDO in the order that all devices accept: disable, set the number of entries to 0, entries, number of entries, other
    /// parameters, enable.
    fn write_pdo(
        &mut self,
        node: NodeId,
        (communication, mapping): (u16, u16),
        pdo: &Pdo<'_>,
        done: &mut Configured,
    ) -> Result<(), CommissionError> {
        let at = |index, sub| Object { index, sub };
        // A file lists more entries than are in use.
        let count = pdo.mapping.get(&0).and_then(|data| number(data));
        let is_used = |sub: u8| sub == 0 || count.is_none_or(|count| u32::from(sub) <= count);
        let mapped: Vec<(u8, &[u8])> =
            pdo.mapping.iter().filter(|(sub, _)| is_used(**sub)).map(|(sub, data)| (*sub, *data)).collect();
        let differing = |session: &mut Self, index: u16, given: &[(u8, &[u8])]| {
            let mut differing = Vec::new();
            for (sub, data) in given {
                if session.differs(node, at(index, *sub), data)? {
                    differing.push(at(index, *sub));
                }
            }
            Ok::<_, CommissionError>(differing)
        };
        let given: Vec<(u8, &[u8])> = pdo.communication.iter().map(|(sub, data)| (*sub, *data)).collect();
        let other = differing(self, communication, &given)?;
        let remapped = differing(self, mapping, &mapped)?;
        done.compared += pdo.communication.len() + pdo.mapping.len();
        if other.is_empty() && remapped.is_empty() {
            return Ok(());
        }
        let cob_id = at(communication, 1);
        let present = number(&self.read(node, cob_id)?).unwrap_or(INVALID);
        if present & INVALID == 0 {
            self.write(node, cob_id, &(present | INVALID).to_le_bytes())?;
        }
        if !remapped.is_empty() {
            let number_of = at(mapping, 0);
            // If only entries are written, the present number of entries stays.
            let count = match pdo.mapping.get(&0) {
                Some(count) => count.to_vec(),
                None => self.read(node, number_of)?,
            };
            self.write(node, number_of, &[0])?;
            for (sub, data) in mapped.iter().filter(|(sub, _)| *sub != 0) {
                self.write(node, at(mapping, *sub), data)?;
            }
            self.write(node, number_of, &count)?;
        }
        for object in other.iter().filter(|object| object.sub != 1) {
            if let Some(data) = pdo.communication.get(&object.sub) {
                self.write(node, *object, data)?;
            }
        }
        let wanted = pdo.communication.get(&1).and_then(|data| number(data)).unwrap_or(present);
        if wanted != present | INVALID {
            self.write(node, cob_id, &wanted.to_le_bytes())?;
        }
        done.written.extend(other.into_iter().chain(remapped));
        Ok(())
    }
}
