//! Objects of CANopen communication in a simulated drive, in addition to those of the drive.
//!
//! Refuses  reserved transmission types; mappings of an enabled PDO, of objects that cannot be mapped, or of more than 8 bytes
//! Source   CiA 301 (objects 1000h to 1BFFh, abort codes)

use crate::can_objects;
use crate::config::DeviceConfig;
use crate::eds::CobId;
use crate::layout::MOST_PDOS;
use lineshaft_cia402::config::DriveConfig;
use lineshaft_cia402::dictionary::Direction;
use lineshaft_cia402::object::Object;
use lineshaft_cia402::sdo::Abort;
use lineshaft_cia402::simulate::{ObjectTable, TableAccess};

/// Maximum number of objects of a PDO.
pub(super) const MOST_MAPPED: u8 = 8;

const NOT_MAPPABLE: Abort = Abort(0x0604_0041);
const PDO_LENGTH: Abort = Abort(0x0604_0042);
const RANGE: Abort = Abort(0x0609_0030);
const STATE: Abort = Abort(0x0800_0022);

const fn at(index: u16, sub: u8) -> Object {
    Object { index, sub }
}

/// Objects of every device: number of bytes, access, power-on value.
const OBJECTS: [(Object, u8, TableAccess, u32); 10] = [
    (can_objects::SYNC_COB_ID, 4, TableAccess::Write, 0x80),
    (can_objects::CYCLE_PERIOD, 4, TableAccess::Write, 0),
    (can_objects::GUARD_TIME, 2, TableAccess::Write, 0),
    (can_objects::LIFE_TIME_FACTOR, 1, TableAccess::Write, 0),
    (at(0x1016, 0), 1, TableAccess::Read, 1),
    (can_objects::CONSUMER_HEARTBEAT, 4, TableAccess::Write, 0),
    (can_objects::PRODUCER_HEARTBEAT, 2, TableAccess::Write, 0),
    (can_objects::SYNC_OVERFLOW, 1, TableAccess::Write, 0),
    (at(0x1029, 0), 1, TableAccess::Read, 1),
    (can_objects::ERROR_BEHAVIOUR, 1, TableAccess::Write, 0),
];

/// Creates the objects of a drive of the cell after power-on, with disabled PDOs.
pub(super) fn objects_of(device: &DeviceConfig, drive: &DriveConfig) -> ObjectTable {
    let mut table = ObjectTable::new(drive, device.identity, &device.startup, check);
    for (object, bytes, access, value) in OBJECTS {
        table.add(object, bytes, access, value);
    }
    for number in 1..=MOST_PDOS {
        let ids = [(Direction::Receive, device.node.rpdo(number)), (Direction::Transmit, device.node.tpdo(number))];
        for (direction, id) in ids {
            add_pdo(&mut table, direction, number, id.map_or(0, |id| id.get().into()));
        }
    }
    table
}

/// Adds a disabled PDO without entries.
fn add_pdo(table: &mut ObjectTable, direction: Direction, number: u8, id: u32) {
    let (communication, mapping) = (direction.communication(number), direction.mapping(number));
    table.add(at(communication, 0), 1, TableAccess::Read, 2);
    table.add(at(communication, 1), 4, TableAccess::Write, 0x8000_0000 | id);
    table.add(at(communication, 2), 1, TableAccess::Write, 255);
    table.add(at(mapping, 0), 1, TableAccess::Write, 0);
    for sub in 1..=MOST_MAPPED {
        table.add(at(mapping, sub), 4, TableAccess::Write, 0);
    }
}

/// Checks a value of the correct length.
fn check(table: &ObjectTable, object: Object, value: u32) -> Result<(), Abort> {
    match (object.index, object.sub) {
        _ if object == can_objects::ERROR_BEHAVIOUR && value > 2 => Err(RANGE),
        // Reserved transmission types, and those for remote frames.
        (0x1400..=0x15FF | 0x1800..=0x19FF, 2) if (241..=253).contains(&value) => Err(RANGE),
        (0x1600..=0x17FF | 0x1A00..=0x1BFF, _) => check_mapping(table, object, value),
        _ => Ok(()),
    }
}

/// Checks the write of a mapping: the number of objects, or one of them.
fn check_mapping(table: &ObjectTable, object: Object, value: u32) -> Result<(), Abort> {
    if CobId(table.get(at(object.index - 0x200, 1))).is_valid() {
        return Err(STATE);
    }
    if object.sub == 0 {
        let subs = 1..=value.min(MOST_MAPPED.into()) as u8;
        let bits: u32 = subs.map(|sub| table.get(at(object.index, sub)) & 0xFF).sum();
        return if value <= u32::from(MOST_MAPPED) && bits <= 64 { Ok(()) } else { Err(PDO_LENGTH) };
    }
    if table.get(at(object.index, 0)) != 0 {
        return Err(STATE);
    }
    let access = if object.index < 0x1A00 { TableAccess::Receive } else { TableAccess::Transmit };
    let (mapped, _) = mapped(value);
    let is_mappable =
        table.access(mapped).is_some_and(|(found, bytes)| found == access && 8 * u32::from(bytes) == value & 0xFF);
    if is_mappable { Ok(()) } else { Err(NOT_MAPPABLE) }
}

/// Returns the object of a mapping entry, and its number of bytes.
pub(super) fn mapped(entry: u32) -> (Object, u8) {
    let [bits, sub, low, high] = entry.to_le_bytes();
    (at(u16::from_le_bytes([low, high]), sub), bits / 8)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Monitoring, NodeId};

    fn table() -> ObjectTable {
        let device = DeviceConfig::plain_drive(0, NodeId::new(3).unwrap(), Monitoring::None);
        objects_of(&device, device.drive().unwrap())
    }

    /// Order of CiA 301: disable, no entries, entries, number of entries, enable.
    #[test]
    fn a_pdo_is_mapped_only_while_it_is_off_and_empty() {
        let mut table = table();
        let (control, status, position) = (0x6040_0010, 0x6041_0010, 0x607A_0020);
        assert_eq!(table.write(at(0x1600, 1), control, Some(4)), Ok(()));
        assert_eq!(table.write(at(0x1600, 2), position, Some(4)), Ok(()));
        assert_eq!(table.write(at(0x1600, 3), status, Some(4)), Err(NOT_MAPPABLE), "it is sent, not received");
        assert_eq!(table.write(at(0x1600, 3), 0x6040_0008, Some(4)), Err(NOT_MAPPABLE), "it has 16 bits");
        assert_eq!(table.write(at(0x1600, 0), 2, Some(1)), Ok(()));
        assert_eq!(table.write(at(0x1600, 1), position, Some(4)), Err(STATE), "it has objects");
        assert_eq!(table.write(at(0x1600, 0), 0, Some(1)), Ok(()));
        assert_eq!(table.write(at(0x1400, 1), 0x203, Some(4)), Ok(()));
        assert_eq!(table.write(at(0x1600, 0), 2, Some(1)), Err(STATE), "it is on");
    }

    #[test]
    fn a_pdo_has_8_bytes_at_most() {
        let mut table = table();
        for sub in 1..=3 {
            assert_eq!(table.write(at(0x1A00, sub), 0x6064_0020, Some(4)), Ok(()));
        }
        assert_eq!(table.write(at(0x1A00, 0), 3, Some(1)), Err(PDO_LENGTH));
        assert_eq!(table.write(at(0x1A00, 0), 2, Some(1)), Ok(()));
        assert_eq!(table.write(at(0x1A00, 0), 9, Some(1)), Err(PDO_LENGTH));
    }
}
