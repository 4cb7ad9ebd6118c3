//! Object dictionary of a simulated drive: numbers of 1 to 4 bytes, texts, and bytes that the cell writes at the start.
//!
//! Refuses  access that CiA 301 refuses: missing or read-only objects, other lengths, modes that the drive does not support, mappings of an
//!          enabled PDO, of objects that cannot be mapped, or of more than 8 bytes
//! Source   CiA 301 (objects 1000h to 1BFFh, abort codes), CiA 402-2

use super::objects as simulated;
use crate::can_objects;
use crate::config::DeviceConfig;
use crate::eds::CobId;
use crate::layout::MOST_PDOS;
use lineshaft_cia402::config::DriveConfig;
use lineshaft_cia402::dictionary::Direction;
use lineshaft_cia402::mode::DriveMode;
use lineshaft_cia402::object::Object;
use lineshaft_cia402::objects;
use lineshaft_cia402::sdo::Abort;
use lineshaft_core::drive::MODE_HOMING;
use std::collections::BTreeMap;
use std::ops::RangeInclusive;

/// Maximum number of objects of a PDO.
pub(super) const MOST_MAPPED: u8 = 8;

const READ_ONLY: Abort = Abort(0x0601_0002);
const NO_OBJECT: Abort = Abort(0x0602_0000);
const NOT_MAPPABLE: Abort = Abort(0x0604_0041);
const PDO_LENGTH: Abort = Abort(0x0604_0042);
const NO_SUBINDEX: Abort = Abort(0x0609_0011);
const RANGE: Abort = Abort(0x0609_0030);
const STATE: Abort = Abort(0x0800_0022);

/// Access type of an object.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Access {
    /// Readable by SDO.
    Read,
    /// Readable and writable by SDO.
    Write,
    /// In addition writable by PDO.
    Receive,
    /// Readable by SDO and PDO.
    Transmit,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Entry {
    bytes: u8,
    access: Access,
    value: u32,
}

impl Entry {
    fn mask(self) -> u32 {
        u32::MAX >> (32 - 8 * u32::from(self.bytes.clamp(1, 4)))
    }
}

/// Object that is not a number: a text, or bytes of a fixed length.
#[derive(Clone, Debug)]
struct Long {
    data: Vec<u8>,
    is_writable: bool,
}

/// Objects of a drive.
#[derive(Clone, Debug, Default)]
pub(super) struct ObjectTable {
    numbers: BTreeMap<Object, Entry>,
    long: BTreeMap<Object, Long>,
    /// Whether 2000h contains the levels of the touch probe inputs.
    has_levels: bool,
}

const fn at(index: u16, sub: u8) -> Object {
    Object { index, sub }
}

/// Profile velocity after power-on, in counts/s.
const PROFILE_VELOCITY: f64 = 100_000.0;
/// Profile acceleration and deceleration after power-on, in counts/s^2.
const PROFILE_ACCELERATION: f64 = 500_000.0;

/// Texts of every drive: device name, hardware version, software version (CiA 301).
const TEXTS: [(u16, &str); 3] =
    [(0x1008, "Lineshaft simulated drive"), (0x1009, "simulation"), (0x100A, env!("CARGO_PKG_VERSION"))];

/// Objects that must be greater than 0.
const RAMPS: [Object; 3] = [simulated::PROFILE_ACCELERATION, simulated::PROFILE_DECELERATION, simulated::TORQUE_SLOPE];

/// Objects of every drive: number of bytes, access, power-on value.
const OBJECTS: [(Object, u8, Access, u32); 52] = [
    // Servo drive of profile 402.
    (objects::DEVICE_TYPE, 4, Access::Read, 0x0002_0192),
    (simulated::ERROR_REGISTER, 1, Access::Transmit, 0),
    (can_objects::SYNC_COB_ID, 4, Access::Write, 0x80),
    (can_objects::CYCLE_PERIOD, 4, Access::Write, 0),
    (can_objects::GUARD_TIME, 2, Access::Write, 0),
    (can_objects::LIFE_TIME_FACTOR, 1, Access::Write, 0),
    (at(0x1016, 0), 1, Access::Read, 1),
    (can_objects::CONSUMER_HEARTBEAT, 4, Access::Write, 0),
    (can_objects::PRODUCER_HEARTBEAT, 2, Access::Write, 0),
    (at(0x1018, 0), 1, Access::Read, 4),
    (can_objects::SYNC_OVERFLOW, 1, Access::Write, 0),
    (at(0x1029, 0), 1, Access::Read, 1),
    (simulated::ERROR_BEHAVIOUR, 1, Access::Write, 0),
    // Reaction: fault.
    (simulated::ABORT_CONNECTION, 2, Access::Write, 1),
    (objects::ERROR_CODE, 2, Access::Transmit, 0),
    (objects::CONTROL_WORD, 2, Access::Receive, 0),
    (objects::STATUS_WORD, 2, Access::Transmit, 0),
    (objects::VL_TARGET_VELOCITY, 2, Access::Receive, 0),
    (simulated::VL_DEMAND, 2, Access::Transmit, 0),
    (simulated::VL_ACTUAL, 2, Access::Transmit, 0),
    (at(0x6048, 0), 1, Access::Read, 2),
    (simulated::VL_ACCELERATION[0], 4, Access::Write, 0),
    (simulated::VL_ACCELERATION[1], 2, Access::Write, 0),
    (at(0x6049, 0), 1, Access::Read, 2),
    (simulated::VL_DECELERATION[0], 4, Access::Write, 0),
    (simulated::VL_DECELERATION[1], 2, Access::Write, 0),
    (objects::MODE, 1, Access::Receive, 0),
    (objects::MODE_DISPLAY, 1, Access::Transmit, 0),
    (objects::POSITION, 4, Access::Transmit, 0),
    (objects::VELOCITY, 4, Access::Transmit, 0),
    (objects::TARGET_TORQUE, 2, Access::Receive, 0),
    (objects::TORQUE, 2, Access::Transmit, 0),
    (objects::TARGET_POSITION, 4, Access::Receive, 0),
    // Rated torque within 10 ms.
    (simulated::TORQUE_SLOPE, 4, Access::Receive, 100_000),
    (objects::INTERPOLATION_POSITION, 4, Access::Receive, 0),
    (objects::HOMING_METHOD, 1, Access::Write, 0),
    (objects::HOMING_SEARCH, 4, Access::Write, 0),
    (objects::HOMING_ZERO, 4, Access::Write, 0),
    (objects::HOMING_ACCELERATION, 4, Access::Write, 0),
    (objects::TOUCH_PROBE_FUNCTION, 2, Access::Receive, 0),
    (simulated::TOUCH_PROBE_STATUS, 2, Access::Transmit, 0),
    (at(0x60BA, 0), 4, Access::Transmit, 0),
    (at(0x60BB, 0), 4, Access::Transmit, 0),
    (at(0x60BC, 0), 4, Access::Transmit, 0),
    (at(0x60BD, 0), 4, Access::Transmit, 0),
    (at(0x60D5, 0), 2, Access::Transmit, 0),
    (at(0x60D6, 0), 2, Access::Transmit, 0),
    (at(0x60D7, 0), 2, Access::Transmit, 0),
    (at(0x60D8, 0), 2, Access::Transmit, 0),
    (objects::DIGITAL_INPUTS, 4, Access::Transmit, 0),
    (objects::DIGITAL_OUTPUTS, 4, Access::Receive, 0),
    (objects::TARGET_VELOCITY, 4, Access::Receive, 0),
];

impl ObjectTable {
    /// Creates the objects of a drive of the cell after power-on. Objects that the cell writes at the start exist as well.
    pub(super) fn new(device: &DeviceConfig, drive: &DriveConfig) -> Self {
        let mut table = Self::default();
        for write in &device.startup {
            match write.data.len() {
                bytes @ 1..=4 => table.add(write.object, bytes as u8, Access::Write, 0),
                bytes => {
                    table.long.insert(write.object, Long { data: vec![0; bytes], is_writable: true });
                }
            }
        }
        for (index, text) in TEXTS {
            table.numbers.remove(&at(index, 0));
            table.long.insert(at(index, 0), Long { data: text.as_bytes().to_vec(), is_writable: false });
        }
        for (object, bytes, access, value) in OBJECTS {
            table.add(object, bytes, access, value);
        }
        // Drives of other manufacturers have another object there.
        table.has_levels = device.startup.iter().all(|write| write.object.index != simulated::PROBE_INPUTS.index);
        if table.has_levels {
            table.add(simulated::PROBE_INPUTS, 1, Access::Write, 0);
        }
        let identity = device.identity;
        let numbers = [
            (objects::VENDOR, identity.vendor),
            (objects::PRODUCT, identity.product),
            (objects::REVISION, identity.revision),
            (objects::SERIAL, identity.serial),
        ];
        for (object, number) in numbers {
            table.add(object, 4, Access::Read, number.unwrap_or_default());
        }
        // 1 ms, until the master writes its cycle.
        table.add(objects::INTERPOLATION_VALUE, 1, Access::Write, 1);
        table.add(objects::INTERPOLATION_INDEX, 1, Access::Write, (-3_i32).cast_unsigned());
        table.add(objects::DIGITAL_OUTPUT_MASK, 4, Access::Write, u32::MAX);
        if let Some((counts, turns)) = drive.counts_per_shaft_revolution {
            for (object, number) in objects::FEED_CONSTANT.into_iter().zip([counts, turns]) {
                table.add(object, 4, Access::Read, u32::try_from(number).unwrap_or(u32::MAX));
            }
        }
        let units = |counts: f64| u32::try_from(drive.velocity.to_drive(counts)).unwrap_or(u32::MAX).max(1);
        table.add(simulated::PROFILE_VELOCITY, 4, Access::Receive, units(PROFILE_VELOCITY));
        for object in [simulated::PROFILE_ACCELERATION, simulated::PROFILE_DECELERATION] {
            table.add(object, 4, Access::Receive, units(PROFILE_ACCELERATION));
        }
        let modes = supported(drive).fold(0, |modes, mode| modes | 1_u32 << (mode - 1));
        table.add(objects::SUPPORTED_MODES, 4, Access::Read, modes);
        for number in 1..=MOST_PDOS {
            let ids = [(Direction::Receive, device.node.rpdo(number)), (Direction::Transmit, device.node.tpdo(number))];
            for (direction, id) in ids {
                table.add_pdo(direction, number, id.map_or(0, |id| id.get().into()));
            }
        }
        table
    }

    /// Adds a disabled PDO without entries.
    fn add_pdo(&mut self, direction: Direction, number: u8, id: u32) {
        let (communication, mapping) = (direction.communication(number), direction.mapping(number));
        self.add(at(communication, 0), 1, Access::Read, 2);
        self.add(at(communication, 1), 4, Access::Write, 0x8000_0000 | id);
        self.add(at(communication, 2), 1, Access::Write, 255);
        self.add(at(mapping, 0), 1, Access::Write, 0);
        for sub in 1..=MOST_MAPPED {
            self.add(at(mapping, sub), 4, Access::Write, 0);
        }
    }

    fn add(&mut self, object: Object, bytes: u8, access: Access, value: u32) {
        self.long.remove(&object);
        let entry = Entry { bytes, access, value };
        self.numbers.insert(object, Entry { value: value & entry.mask(), ..entry });
    }

    /// Returns the unsigned value of an object; 0 if it is missing.
    pub(super) fn get(&self, object: Object) -> u32 {
        self.numbers.get(&object).map_or(0, |entry| entry.value)
    }

    /// Returns the signed value of an object; 0 if it is missing.
    pub(super) fn signed(&self, object: Object) -> i32 {
        self.numbers.get(&object).map_or(0, |entry| {
            let unused = 32 - 8 * u32::from(entry.bytes.clamp(1, 4));
            (entry.value << unused).cast_signed() >> unused
        })
    }

    /// Returns the levels of the touch probe inputs: bit 0 probe 1, bit 1 probe 2; 0 if the cell uses 2000h for another object.
    pub(super) fn probe_levels(&self) -> u32 {
        if self.has_levels { self.get(simulated::PROBE_INPUTS) } else { 0 }
    }

    /// Sets an object from inside the drive, truncated to its length. A missing object is not created.
    pub(super) fn set(&mut self, object: Object, value: u32) {
        if let Some(entry) = self.numbers.get_mut(&object) {
            entry.value = value & entry.mask();
        }
    }

    /// Sets the objects of some indices to their power-on values, except objects that report the state of the drive.
    pub(super) fn restore(&mut self, initial: &Self, indices: &RangeInclusive<u16>) {
        for (object, entry) in &initial.numbers {
            if indices.contains(&object.index) && entry.access != Access::Transmit {
                self.set(*object, entry.value);
            }
        }
        for (object, long) in initial.long.iter().filter(|(object, _)| indices.contains(&object.index)) {
            self.long.insert(*object, long.clone());
        }
    }

    /// Sets an object by PDO. A value that the drive refuses changes nothing.
    pub(super) fn receive(&mut self, object: Object, value: u32) {
        if self.check(object, value).is_ok() {
            self.set(object, value);
        }
    }

    /// Writes an object by SDO. `None` as length means the length of the object.
    pub(super) fn write(&mut self, object: Object, value: u32, bytes: Option<u8>) -> Result<(), Abort> {
        let room = self.writable_length(object)?;
        if bytes.is_some_and(|bytes| usize::from(bytes) != room) || self.long.contains_key(&object) {
            return Err(Abort::LENGTH);
        }
        let entry = self.entry(object)?;
        let value = value & entry.mask();
        self.check(object, value)?;
        self.set(object, value);
        Ok(())
    }

    /// Returns the length of an object that can be written by SDO.
    pub(super) fn writable_length(&self, object: Object) -> Result<usize, Abort> {
        let (room, is_writable) = match self.long.get(&object) {
            Some(long) => (long.data.len(), long.is_writable),
            None => {
                let Entry { bytes, access, .. } = self.entry(object)?;
                (bytes.into(), matches!(access, Access::Write | Access::Receive))
            }
        };
        if is_writable { Ok(room) } else { Err(READ_ONLY) }
    }

    /// Reads the bytes of an object by SDO.
    pub(super) fn read_bytes(&self, object: Object) -> Result<Vec<u8>, Abort> {
        if let Some(long) = self.long.get(&object) {
            return Ok(long.data.clone());
        }
        let Entry { value, bytes, .. } = self.entry(object)?;
        Ok(value.to_le_bytes().into_iter().take(bytes.into()).collect())
    }

    /// Writes the bytes of an object by SDO.
    pub(super) fn write_bytes(&mut self, object: Object, data: &[u8]) -> Result<(), Abort> {
        if data.len() != self.writable_length(object)? {
            return Err(Abort::LENGTH);
        }
        match self.long.get_mut(&object) {
            Some(long) => {
                long.data = data.to_vec();
                Ok(())
            }
            None => self.write(object, data.iter().rev().fold(0, |value, byte| value << 8 | u32::from(*byte)), None),
        }
    }

    fn entry(&self, object: Object) -> Result<Entry, Abort> {
        let subs = at(object.index, 0)..=at(object.index, u8::MAX);
        let has_index =
            || self.numbers.range(subs.clone()).next().is_some() || self.long.range(subs.clone()).next().is_some();
        self.numbers.get(&object).copied().ok_or_else(|| if has_index() { NO_SUBINDEX } else { NO_OBJECT })
    }

    /// Checks a value of the correct length.
    fn check(&self, object: Object, value: u32) -> Result<(), Abort> {
        match (object.index, object.sub) {
            _ if object == objects::MODE => match value {
                0 => Ok(()),
                1..=32 if self.get(objects::SUPPORTED_MODES) >> (value - 1) & 1 == 1 => Ok(()),
                _ => Err(RANGE),
            },
            _ if object == simulated::ERROR_BEHAVIOUR && value > 2 => Err(RANGE),
            _ if object == simulated::PROBE_INPUTS && self.has_levels && value > 3 => Err(RANGE),
            _ if object == simulated::ABORT_CONNECTION && value > 3 => Err(RANGE),
            // Without a ramp the drive would not move.
            _ if RAMPS.contains(&object) && value == 0 => Err(RANGE),
            // Reserved transmission types, and those for remote frames.
            (0x1400..=0x15FF | 0x1800..=0x19FF, 2) if (241..=253).contains(&value) => Err(RANGE),
            (0x1600..=0x17FF | 0x1A00..=0x1BFF, _) => self.check_mapping(object, value),
            _ => Ok(()),
        }
    }

    /// Checks the write of a mapping: the number of objects, or one of them.
    fn check_mapping(&self, object: Object, value: u32) -> Result<(), Abort> {
        if CobId(self.get(at(object.index - 0x200, 1))).is_valid() {
            return Err(STATE);
        }
        if object.sub == 0 {
            let subs = 1..=value.min(MOST_MAPPED.into()) as u8;
            let bits: u32 = subs.map(|sub| self.get(at(object.index, sub)) & 0xFF).sum();
            return if value <= u32::from(MOST_MAPPED) && bits <= 64 { Ok(()) } else { Err(PDO_LENGTH) };
        }
        if self.get(at(object.index, 0)) != 0 {
            return Err(STATE);
        }
        let access = if object.index < 0x1A00 { Access::Receive } else { Access::Transmit };
        let fits = |entry: &Entry| entry.access == access && 8 * u32::from(entry.bytes) == value & 0xFF;
        let is_mappable = self.numbers.get(&mapped(value).0).is_some_and(fits);
        if is_mappable { Ok(()) } else { Err(NOT_MAPPABLE) }
    }
}

/// Returns the numbers of the modes that a drive supports: those of the interface of its axis, and homing.
fn supported(drive: &DriveConfig) -> impl Iterator<Item = i8> {
    let offers = move |mode: &DriveMode| *mode == drive.mode || drive.offers.offers(mode.interface());
    let modes = DriveMode::NAMES.into_iter().map(|(_, mode)| mode).filter(offers).map(DriveMode::number);
    modes.chain(drive.offers.homes.then_some(MODE_HOMING))
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
    use lineshaft_cia402::config::Write;

    impl ObjectTable {
        /// Returns the value of a number, and its number of bytes.
        fn read(&self, object: Object) -> Result<(u32, u8), Abort> {
            self.entry(object).map(|entry| (entry.value, entry.bytes))
        }
    }

    fn table() -> ObjectTable {
        let device = DeviceConfig::plain_drive(0, NodeId::new(3).unwrap(), Monitoring::None);
        ObjectTable::new(&device, device.drive().unwrap())
    }

    #[test]
    fn a_mode_that_the_drive_lacks_is_out_of_range() {
        let mut table = table();
        // pp is bit 0 of 6502h, homing bit 5, ip bit 6, csp bit 7.
        assert_eq!(table.read(objects::SUPPORTED_MODES), Ok((0xE1, 4)));
        let accepted = [1, 6, 7, 8, 0].map(|mode| (mode, Ok(())));
        let refused = [2, 3, 4, 5, 9, 10, 0xFF].map(|mode| (mode, Err(RANGE)));
        for (mode, result) in accepted.into_iter().chain(refused) {
            assert_eq!(table.write(objects::MODE, mode, Some(1)), result, "{mode}");
        }
        // The same values by PDO.
        table.receive(objects::MODE, 1);
        table.receive(objects::MODE, 9);
        assert_eq!(table.get(objects::MODE), 1);
    }

    #[test]
    fn ramp_of_0_is_out_of_range() {
        let mut table = table();
        assert_eq!(table.read(simulated::PROFILE_ACCELERATION), Ok((500_000, 4)));
        assert_eq!(table.write(simulated::PROFILE_ACCELERATION, 0, Some(4)), Err(RANGE));
        assert_eq!(table.write(simulated::PROFILE_ACCELERATION, 1, Some(4)), Ok(()));
    }

    #[test]
    fn wrong_accesses_have_the_abort_codes_of_cia_301() {
        let mut table = table();
        assert_eq!(table.read(at(0x1007, 0)), Err(Abort(0x0602_0000)));
        assert_eq!(table.read_bytes(at(0x1008, 1)), Err(Abort(0x0609_0011)));
        assert_eq!(table.write(at(0x1008, 0), 0, Some(4)), Err(Abort(0x0601_0002)));
        assert_eq!(table.read(at(0x1018, 9)), Err(Abort(0x0609_0011)));
        assert_eq!(table.write(objects::STATUS_WORD, 0, Some(2)), Err(Abort(0x0601_0002)));
        assert_eq!(table.write(objects::CONTROL_WORD, 0, Some(4)), Err(Abort(0x0607_0010)));
        assert_eq!(table.write(objects::CONTROL_WORD, 0x1_000F, None), Ok(()));
        assert_eq!(table.read(objects::CONTROL_WORD), Ok((0x000F, 2)));
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

    #[test]
    fn values_keep_their_sign() {
        let mut table = table();
        table.set(objects::TARGET_TORQUE, (-250_i32).cast_unsigned());
        assert_eq!((table.get(objects::TARGET_TORQUE), table.signed(objects::TARGET_TORQUE)), (0xFF06, -250));
        assert_eq!(table.signed(objects::INTERPOLATION_INDEX), -3);
    }

    /// If the cell writes 2000h, it is an object of its drive: 4 bytes, any value. Otherwise 2000h contains the levels of the touch probe
    /// inputs.
    #[test]
    fn object_2000h_of_cell_replaces_probe_inputs() {
        let object = at(0x2000, 0);
        let mut levels = table();
        assert_eq!([4, 3].map(|value| levels.write(object, value, Some(1))), [Err(RANGE), Ok(())]);
        assert_eq!(levels.probe_levels(), 3);
        let mut device = DeviceConfig::plain_drive(0, NodeId::new(3).unwrap(), Monitoring::None);
        device.startup.push(Write { object, data: vec![0; 4] });
        let mut table = ObjectTable::new(&device, device.drive().unwrap());
        assert_eq!(table.write(object, 100_001, Some(4)), Ok(()));
        assert_eq!((table.read(object), table.probe_levels()), (Ok((100_001, 4)), 0));
    }

    /// Startup writes of lengths other than 1 to 4 bytes create objects of that length; power-on values are 0.
    #[test]
    fn objects_that_the_cell_writes_at_the_start_have_their_length() {
        let mut device = DeviceConfig::plain_drive(0, NodeId::new(3).unwrap(), Monitoring::None);
        let (long, short) = (at(0x2001, 0), at(0x2002, 0));
        for (object, bytes) in [(long, 8), (short, 2)] {
            device.startup.push(Write { object, data: vec![1; bytes] });
        }
        let initial = ObjectTable::new(&device, device.drive().unwrap());
        let mut table = initial.clone();
        assert_eq!([table.read_bytes(long), table.read_bytes(short)], [Ok(vec![0; 8]), Ok(vec![0; 2])]);
        assert_eq!(table.write_bytes(long, &[5; 8]), Ok(()));
        assert_eq!(table.write_bytes(long, &[5; 7]), Err(Abort(0x0607_0010)));
        assert_eq!(table.write(long, 5, None), Err(Abort(0x0607_0010)), "4 bytes");
        assert_eq!(table.write_bytes(short, &[0x34, 0x12]), Ok(()));
        assert_eq!((table.read_bytes(long), table.get(short)), (Ok(vec![5; 8]), 0x1234));
        table.restore(&initial, &(0..=u16::MAX));
        assert_eq!((table.read_bytes(long), table.get(short)), (Ok(vec![0; 8]), 0));
    }
}
