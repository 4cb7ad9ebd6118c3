//! Object dictionary of a simulated drive: numbers of 1 to 4 bytes, texts, and bytes that the cell writes at the start.
//!
//! Refuses  access that CiA 301 refuses: missing or read-only objects, other lengths, modes that the drive does not support; values that the
//!          bus refuses for its own objects
//! Source   CiA 301 (objects 1000h to 1018h, abort codes), CiA 402-2

use super::objects as simulated;
use crate::config::{DriveConfig, Identity, Write};
use crate::mode::DriveMode;
use crate::object::Object;
use crate::objects;
use crate::sdo::Abort;
use lineshaft_core::drive::MODE_HOMING;
use std::collections::BTreeMap;
use std::ops::RangeInclusive;

const READ_ONLY: Abort = Abort(0x0601_0002);
const NO_OBJECT: Abort = Abort(0x0602_0000);
const NO_SUBINDEX: Abort = Abort(0x0609_0011);
const RANGE: Abort = Abort(0x0609_0030);

/// Access type of an object.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TableAccess {
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
    access: TableAccess,
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
#[derive(Clone, Debug)]
pub struct ObjectTable {
    numbers: BTreeMap<Object, Entry>,
    long: BTreeMap<Object, Long>,
    /// Whether 2000h contains the levels of the touch probe inputs.
    has_levels: bool,
    rules: BusRules,
}

/// Checks a value of the correct length for an object of the bus; any other object is accepted.
pub type BusRules = fn(&ObjectTable, Object, u32) -> Result<(), Abort>;

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
const OBJECTS: [(Object, u8, TableAccess, u32); 42] = [
    // Servo drive of profile 402.
    (objects::DEVICE_TYPE, 4, TableAccess::Read, 0x0002_0192),
    (simulated::ERROR_REGISTER, 1, TableAccess::Transmit, 0),
    (at(0x1018, 0), 1, TableAccess::Read, 4),
    // Reaction: fault.
    (simulated::ABORT_CONNECTION, 2, TableAccess::Write, 1),
    (objects::ERROR_CODE, 2, TableAccess::Transmit, 0),
    (objects::CONTROL_WORD, 2, TableAccess::Receive, 0),
    (objects::STATUS_WORD, 2, TableAccess::Transmit, 0),
    (objects::VL_TARGET_VELOCITY, 2, TableAccess::Receive, 0),
    (simulated::VL_DEMAND, 2, TableAccess::Transmit, 0),
    (simulated::VL_ACTUAL, 2, TableAccess::Transmit, 0),
    (at(0x6048, 0), 1, TableAccess::Read, 2),
    (simulated::VL_ACCELERATION[0], 4, TableAccess::Write, 0),
    (simulated::VL_ACCELERATION[1], 2, TableAccess::Write, 0),
    (at(0x6049, 0), 1, TableAccess::Read, 2),
    (simulated::VL_DECELERATION[0], 4, TableAccess::Write, 0),
    (simulated::VL_DECELERATION[1], 2, TableAccess::Write, 0),
    (objects::MODE, 1, TableAccess::Receive, 0),
    (objects::MODE_DISPLAY, 1, TableAccess::Transmit, 0),
    (objects::POSITION, 4, TableAccess::Transmit, 0),
    (objects::VELOCITY, 4, TableAccess::Transmit, 0),
    (objects::TARGET_TORQUE, 2, TableAccess::Receive, 0),
    (objects::TORQUE, 2, TableAccess::Transmit, 0),
    (objects::TARGET_POSITION, 4, TableAccess::Receive, 0),
    // Rated torque within 10 ms.
    (simulated::TORQUE_SLOPE, 4, TableAccess::Receive, 100_000),
    (objects::INTERPOLATION_POSITION, 4, TableAccess::Receive, 0),
    (objects::HOMING_METHOD, 1, TableAccess::Write, 0),
    (objects::HOMING_SEARCH, 4, TableAccess::Write, 0),
    (objects::HOMING_ZERO, 4, TableAccess::Write, 0),
    (objects::HOMING_ACCELERATION, 4, TableAccess::Write, 0),
    (objects::TOUCH_PROBE_FUNCTION, 2, TableAccess::Receive, 0),
    (simulated::TOUCH_PROBE_STATUS, 2, TableAccess::Transmit, 0),
    (at(0x60BA, 0), 4, TableAccess::Transmit, 0),
    (at(0x60BB, 0), 4, TableAccess::Transmit, 0),
    (at(0x60BC, 0), 4, TableAccess::Transmit, 0),
    (at(0x60BD, 0), 4, TableAccess::Transmit, 0),
    (at(0x60D5, 0), 2, TableAccess::Transmit, 0),
    (at(0x60D6, 0), 2, TableAccess::Transmit, 0),
    (at(0x60D7, 0), 2, TableAccess::Transmit, 0),
    (at(0x60D8, 0), 2, TableAccess::Transmit, 0),
    (objects::DIGITAL_INPUTS, 4, TableAccess::Transmit, 0),
    (objects::DIGITAL_OUTPUTS, 4, TableAccess::Receive, 0),
    (objects::TARGET_VELOCITY, 4, TableAccess::Receive, 0),
];

impl ObjectTable {
    /// Creates the objects of a drive of the cell after power-on. Objects that the cell writes at the start (`startup`) exist as well. The
    /// bus [adds](Self::add) its own objects, for which it has rules.
    pub fn new(drive: &DriveConfig, identity: Identity, startup: &[Write], rules: BusRules) -> Self {
        let mut table = Self { numbers: BTreeMap::new(), long: BTreeMap::new(), has_levels: false, rules };
        for write in startup {
            match write.data.len() {
                bytes @ 1..=4 => table.add(write.object, bytes as u8, TableAccess::Write, 0),
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
        table.has_levels = startup.iter().all(|write| write.object.index != simulated::PROBE_INPUTS.index);
        if table.has_levels {
            table.add(simulated::PROBE_INPUTS, 1, TableAccess::Write, 0);
        }
        let numbers = [
            (objects::VENDOR, identity.vendor),
            (objects::PRODUCT, identity.product),
            (objects::REVISION, identity.revision),
            (objects::SERIAL, identity.serial),
        ];
        for (object, number) in numbers {
            table.add(object, 4, TableAccess::Read, number.unwrap_or_default());
        }
        // 1 ms, until the master writes its cycle.
        table.add(objects::INTERPOLATION_VALUE, 1, TableAccess::Write, 1);
        table.add(objects::INTERPOLATION_INDEX, 1, TableAccess::Write, (-3_i32).cast_unsigned());
        table.add(objects::DIGITAL_OUTPUT_MASK, 4, TableAccess::Write, u32::MAX);
        if let Some((counts, turns)) = drive.counts_per_shaft_revolution {
            for (object, number) in objects::FEED_CONSTANT.into_iter().zip([counts, turns]) {
                table.add(object, 4, TableAccess::Read, u32::try_from(number).unwrap_or(u32::MAX));
            }
        }
        let units = |counts: f64| u32::try_from(drive.velocity.to_drive(counts)).unwrap_or(u32::MAX).max(1);
        table.add(simulated::PROFILE_VELOCITY, 4, TableAccess::Receive, units(PROFILE_VELOCITY));
        for object in [simulated::PROFILE_ACCELERATION, simulated::PROFILE_DECELERATION] {
            table.add(object, 4, TableAccess::Receive, units(PROFILE_ACCELERATION));
        }
        let modes = supported(drive).fold(0, |modes, mode| modes | 1_u32 << (mode - 1));
        table.add(objects::SUPPORTED_MODES, 4, TableAccess::Read, modes);
        table
    }

    /// Adds a number of 1 to 4 bytes with its power-on value. It replaces an object that is there.
    pub fn add(&mut self, object: Object, bytes: u8, access: TableAccess, value: u32) {
        self.long.remove(&object);
        let entry = Entry { bytes, access, value };
        self.numbers.insert(object, Entry { value: value & entry.mask(), ..entry });
    }

    /// Returns access and number of bytes of a number; `None` if it is missing.
    pub fn access(&self, object: Object) -> Option<(TableAccess, u8)> {
        self.numbers.get(&object).map(|entry| (entry.access, entry.bytes))
    }

    /// Returns the unsigned value of an object; 0 if it is missing.
    pub fn get(&self, object: Object) -> u32 {
        self.numbers.get(&object).map_or(0, |entry| entry.value)
    }

    /// Returns the signed value of an object; 0 if it is missing.
    pub fn signed(&self, object: Object) -> i32 {
        self.numbers.get(&object).map_or(0, |entry| {
            let unused = 32 - 8 * u32::from(entry.bytes.clamp(1, 4));
            (entry.value << unused).cast_signed() >> unused
        })
    }

    /// Returns the levels of the touch probe inputs: bit 0 probe 1, bit 1 probe 2; 0 if the cell uses 2000h for another object.
    pub fn probe_levels(&self) -> u32 {
        if self.has_levels { self.get(simulated::PROBE_INPUTS) } else { 0 }
    }

    /// Sets an object from inside the drive, truncated to its length. A missing object is not created.
    pub fn set(&mut self, object: Object, value: u32) {
        if let Some(entry) = self.numbers.get_mut(&object) {
            entry.value = value & entry.mask();
        }
    }

    /// Sets the objects of some indices to their power-on values, except objects that report the state of the drive.
    pub fn restore(&mut self, initial: &Self, indices: &RangeInclusive<u16>) {
        for (object, entry) in &initial.numbers {
            if indices.contains(&object.index) && entry.access != TableAccess::Transmit {
                self.set(*object, entry.value);
            }
        }
        for (object, long) in initial.long.iter().filter(|(object, _)| indices.contains(&object.index)) {
            self.long.insert(*object, long.clone());
        }
    }

    /// Sets an object by PDO. A value that the drive refuses changes nothing.
    pub fn receive(&mut self, object: Object, value: u32) {
        if self.check(object, value).is_ok() {
            self.set(object, value);
        }
    }

    /// Writes an object by SDO. `None` as length means the length of the object.
    ///
    /// # Errors
    /// The drive refuses the access or the value.
    pub fn write(&mut self, object: Object, value: u32, bytes: Option<u8>) -> Result<(), Abort> {
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
    ///
    /// # Errors
    /// The object is missing or cannot be written.
    pub fn writable_length(&self, object: Object) -> Result<usize, Abort> {
        let (room, is_writable) = match self.long.get(&object) {
            Some(long) => (long.data.len(), long.is_writable),
            None => {
                let Entry { bytes, access, .. } = self.entry(object)?;
                (bytes.into(), matches!(access, TableAccess::Write | TableAccess::Receive))
            }
        };
        if is_writable { Ok(room) } else { Err(READ_ONLY) }
    }

    /// Reads the bytes of an object by SDO.
    ///
    /// # Errors
    /// The object is missing.
    pub fn read_bytes(&self, object: Object) -> Result<Vec<u8>, Abort> {
        if let Some(long) = self.long.get(&object) {
            return Ok(long.data.clone());
        }
        let Entry { value, bytes, .. } = self.entry(object)?;
        Ok(value.to_le_bytes().into_iter().take(bytes.into()).collect())
    }

    /// Writes the bytes of an object by SDO.
    ///
    /// # Errors
    /// The drive refuses the access or the value.
    pub fn write_bytes(&mut self, object: Object, data: &[u8]) -> Result<(), Abort> {
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
        match object {
            objects::MODE => match value {
                0 => Ok(()),
                1..=32 if self.get(objects::SUPPORTED_MODES) >> (value - 1) & 1 == 1 => Ok(()),
                _ => Err(RANGE),
            },
            simulated::PROBE_INPUTS if self.has_levels && value > 3 => Err(RANGE),
            simulated::ABORT_CONNECTION if value > 3 => Err(RANGE),
            // Without a ramp the drive would not move.
            _ if RAMPS.contains(&object) && value == 0 => Err(RANGE),
            _ => (self.rules)(self, object, value),
        }
    }
}

/// Returns the numbers of the modes that a drive supports: those of the interface of its axis, and homing.
fn supported(drive: &DriveConfig) -> impl Iterator<Item = i8> {
    let offers = move |mode: &DriveMode| *mode == drive.mode || drive.offers.offers(mode.interface());
    let modes = DriveMode::NAMES.into_iter().map(|(_, mode)| mode).filter(offers).map(DriveMode::number);
    modes.chain(drive.offers.homes.then_some(MODE_HOMING))
}

#[cfg(test)]
mod tests {
    use super::*;

    impl ObjectTable {
        /// Returns the objects of a drive in csp with default settings.
        pub(crate) fn plain() -> Self {
            Self::with_startup(&[])
        }

        fn with_startup(startup: &[Write]) -> Self {
            Self::new(&DriveConfig::plain(0), Identity::default(), startup, |_, _, _| Ok(()))
        }

        /// Returns the value of a number, and its number of bytes.
        fn read(&self, object: Object) -> Result<(u32, u8), Abort> {
            self.entry(object).map(|entry| (entry.value, entry.bytes))
        }
    }

    #[test]
    fn a_mode_that_the_drive_lacks_is_out_of_range() {
        let mut table = ObjectTable::plain();
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
        let mut table = ObjectTable::plain();
        assert_eq!(table.read(simulated::PROFILE_ACCELERATION), Ok((500_000, 4)));
        assert_eq!(table.write(simulated::PROFILE_ACCELERATION, 0, Some(4)), Err(RANGE));
        assert_eq!(table.write(simulated::PROFILE_ACCELERATION, 1, Some(4)), Ok(()));
    }

    #[test]
    fn wrong_accesses_have_the_abort_codes_of_cia_301() {
        let mut table = ObjectTable::plain();
        assert_eq!(table.read(at(0x1007, 0)), Err(Abort(0x0602_0000)));
        assert_eq!(table.read_bytes(at(0x1008, 1)), Err(Abort(0x0609_0011)));
        assert_eq!(table.write(at(0x1008, 0), 0, Some(4)), Err(Abort(0x0601_0002)));
        assert_eq!(table.read(at(0x1018, 9)), Err(Abort(0x0609_0011)));
        assert_eq!(table.write(objects::STATUS_WORD, 0, Some(2)), Err(Abort(0x0601_0002)));
        assert_eq!(table.write(objects::CONTROL_WORD, 0, Some(4)), Err(Abort(0x0607_0010)));
        assert_eq!(table.write(objects::CONTROL_WORD, 0x1_000F, None), Ok(()));
        assert_eq!(table.read(objects::CONTROL_WORD), Ok((0x000F, 2)));
    }

    #[test]
    fn values_keep_their_sign() {
        let mut table = ObjectTable::plain();
        table.set(objects::TARGET_TORQUE, (-250_i32).cast_unsigned());
        assert_eq!((table.get(objects::TARGET_TORQUE), table.signed(objects::TARGET_TORQUE)), (0xFF06, -250));
        assert_eq!(table.signed(objects::INTERPOLATION_INDEX), -3);
    }

    /// If the cell writes 2000h, it is an object of its drive: 4 bytes, any value. Otherwise 2000h contains the levels of the touch probe
    /// inputs.
    #[test]
    fn object_2000h_of_cell_replaces_probe_inputs() {
        let object = at(0x2000, 0);
        let mut levels = ObjectTable::plain();
        assert_eq!([4, 3].map(|value| levels.write(object, value, Some(1))), [Err(RANGE), Ok(())]);
        assert_eq!(levels.probe_levels(), 3);
        let mut table = ObjectTable::with_startup(&[Write { object, data: vec![0; 4] }]);
        assert_eq!(table.write(object, 100_001, Some(4)), Ok(()));
        assert_eq!((table.read(object), table.probe_levels()), (Ok((100_001, 4)), 0));
    }

    /// Startup writes of lengths other than 1 to 4 bytes create objects of that length; power-on values are 0.
    #[test]
    fn objects_that_the_cell_writes_at_the_start_have_their_length() {
        let (long, short) = (at(0x2001, 0), at(0x2002, 0));
        let startup = [(long, 8), (short, 2)].map(|(object, bytes)| Write { object, data: vec![1; bytes] });
        let initial = ObjectTable::with_startup(&startup);
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
