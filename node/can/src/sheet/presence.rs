//! Checks that the file contains the objects that a device needs.
//!
//! Source   CiA 301, CiA 402-2 (6060h and 6061h, which a drive need not be able to map)

use super::Comparison;
use crate::Monitoring;
use crate::can_objects;
use crate::config::Role;
use lineshaft_cia402::config::Write;
use lineshaft_cia402::dictionary::Direction;
use lineshaft_cia402::object::Object;
use lineshaft_cia402::objects;

impl Comparison<'_> {
    /// Reports a mapped object that the file lacks, only the first one of each index. It is an error if the index has fewer subindices
    /// according to its subindex 0; otherwise a warning.
    pub(super) fn missing(&mut self, object: Object, key: &str) {
        if !self.reported_indices.insert(object.index) {
            return;
        }
        let Object { index, sub } = object;
        let is_of_bits = [can_objects::MODULE_INPUTS.index, can_objects::MODULE_OUTPUTS.index].contains(&index);
        let user = match self.device.role {
            Role::Module => {
                let address = u32::from(sub.saturating_sub(1)) * if is_of_bits { 8 } else { 1 };
                format!("entries of io from address {address} on need it")
            }
            Role::Drive(_) | Role::Encoder => format!("key {key} needs it"),
        };
        let count = if sub == 0 { None } else { self.number(Object { index, sub: 0 }) };
        match count.filter(|count| *count < u32::from(sub)) {
            Some(count) => {
                self.error(&format!("{object} does not exist by the file, whose {index:04X}h:00 is {count}; {user}"));
            }
            None => self.warning(&format!("{object} is missing in the file; {user}")),
        }
    }

    /// Reports other objects that the file lacks or does not allow to be written: PDO parameters, and objects that are written before the
    /// start or for homing.
    pub(super) fn present(&mut self, homes: bool) {
        self.pdos();
        for (object, key) in self.needed(homes) {
            self.written(object, key);
        }
        self.mode_by_sdo();
        let device = self.device;
        for Write { object, data } in &device.startup {
            self.written(*object, "startup");
            self.length(*object, data.len());
        }
        self.factors();
    }

    fn pdos(&mut self) {
        // PDO objects that CompactPDO describes have no sections.
        let (device, known) = (self.device, self.known);
        if known.device.compact_pdo.is_some_and(|bits| bits != 0) {
            return;
        }
        let received = device.layout.asked.iter().map(|pdo| (Direction::Receive, pdo.number, "RPDO"));
        let sent = device.layout.told.iter().map(|pdo| (Direction::Transmit, pdo.number, "TPDO"));
        for (direction, number, name) in received.chain(sent) {
            let indices = [direction.communication(number), direction.mapping(number)];
            if let Some(index) = indices.into_iter().find(|index| known.index_description(*index).is_none()) {
                self.warning(&format!(
                    "{index:04X}h is missing in the file; {name} {number}, which the cell needs, has it"
                ));
            }
        }
    }

    /// Returns the objects that must be writable, with the keys of the cell that need them.
    fn needed(&self, homes: bool) -> Vec<(Object, &'static str)> {
        let mut needed = Vec::new();
        match self.device.watching {
            Monitoring::Heartbeat { .. } => needed.push((can_objects::PRODUCER_HEARTBEAT, "heartbeat")),
            Monitoring::Guarding { .. } => {
                needed.extend([(can_objects::GUARD_TIME, "guarding"), (can_objects::LIFE_TIME_FACTOR, "guarding")]);
            }
            Monitoring::None => {}
        }
        let Some(drive) = self.device.drive() else { return needed };
        // One object configures both probes.
        let key = ["probe_1", "probe_2"].into_iter().zip(drive.probes).find(|(_, probe)| probe.is_some());
        needed.extend(key.map(|(key, _)| (objects::TOUCH_PROBE_FUNCTION, key)));
        // A drive with DRIVETYPE has no mode in its PDOs.
        needed.extend(drive.drive_type.map(|_| (objects::MODE, "drivetype")));
        if self.device.layout.mode_by_sdo.writes {
            needed.push((objects::MODE, "interface"));
        }
        if homes {
            let homing =
                [objects::HOMING_METHOD, objects::HOMING_SEARCH, objects::HOMING_ZERO, objects::HOMING_ACCELERATION];
            needed.extend(homing.map(|object| (object, "homing.in_drive")));
        }
        needed
    }

    fn written(&mut self, object: Object, key: &str) {
        let known = self.known;
        match known.entry(object).map(|entry| entry.access) {
            None => self.warning(&format!("{object} is missing in the file; key {key} needs it")),
            Some(access) if !access.is_writable() => {
                let name = access.name();
                self.error(&format!("{object} has access {name} by the file; it is written for key {key}"));
            }
            Some(_) => {}
        }
    }

    /// Checks the types of 6060h and 6061h, and that 6061h is readable, if they are exchanged by SDO.
    fn mode_by_sdo(&mut self) {
        let (known, by_sdo) = (self.known, self.device.layout.mode_by_sdo);
        let of_mode = [(by_sdo.writes, objects::MODE, "written"), (by_sdo.reads, objects::MODE_DISPLAY, "read")];
        for (_, object, verb) in of_mode.into_iter().filter(|(goes_by_sdo, ..)| *goes_by_sdo) {
            let Some(entry) = known.entry(object) else {
                // 6060h was already checked as an object that is written.
                if object == objects::MODE_DISPLAY {
                    self.warning(&format!("{object} is missing in the file; key interface needs it"));
                }
                continue;
            };
            let (data_type, access) = (entry.data_type, entry.access);
            if !data_type.may_be_integer(8) {
                self.error(&format!(
                    "{object} is {data_type} by the file; an integer of 8 bits is {verb} by SDO (key interface)"
                ));
            }
            if object == objects::MODE_DISPLAY && !access.is_readable() {
                let name = access.name();
                self.error(&format!("{object} has access {name} by the file; it is read for key interface"));
            }
        }
    }

    /// Compares the length of a value of `startup` with the type of its object.
    fn length(&mut self, object: Object, bytes: usize) {
        let Some(data_type) = self.known.entry(object).map(|entry| entry.data_type) else { return };
        let Some(length) = data_type.bits().map(|bits| bits.div_ceil(8)) else { return };
        if length as usize != bytes {
            self.error(&format!("{object} is {data_type} by the file, {length} bytes; key startup writes {bytes}"));
        }
    }

    /// Checks for the objects that are compared with key feed.
    fn factors(&mut self) {
        let has_feed = self.device.drive().is_some_and(|drive| drive.counts_per_shaft_revolution.is_some());
        let [feed, resolution] = [objects::FEED_CONSTANT, objects::ENCODER_RESOLUTION].map(|[first, _]| first);
        if has_feed && self.known.entry(feed).is_none() && self.known.entry(resolution).is_none() {
            let sentence =
                format!("{feed} and {resolution} are missing in the file; key feed is compared with one of them");
            self.warning(&sentence);
        }
    }
}
