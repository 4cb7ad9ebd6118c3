//! Objects of a drive that are exchanged as process data.
//!
//! Law      values that an axis needs are exchanged in every cycle, values that seldom change may be sent on change; each list is in the
//!          order of importance. The crate of the bus packs the lists into its PDOs
//! Reads    the dictionary of the drive, if there is one: an object can be mapped if its PDOMapping is 1, or if a PDO of the file carries
//!          it; the mode of operation (6060h, 6061h) only if its PDOMapping is 1, otherwise it is exchanged by SDO
//! Refuses  a drive that cannot map an object that its interface, or the cell, needs
//! Source   CiA 301 (objects 1400h to 1BFFh), CiA 402-2

use crate::dictionary::{DataType, Direction};
use crate::mode::DriveMode;
use crate::object::Object;
use crate::objects;
use crate::probe::{self, Probes, Slot};
use lineshaft_core::drive::Interface;

/// Value that a device reports in a PDO.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReportedValue {
    /// Status word.
    Status,
    /// Position, in counts.
    Position,
    /// Modes of operation display.
    Mode,
    /// Digital inputs.
    Inputs,
    /// Error code (603Fh).
    Fault,
    /// Torque, in 0.1 % of rated torque.
    Torque,
    /// Position that a touch probe has captured, in counts.
    Captured(Slot),
    /// Number of captures of a touch probe.
    Captures(Slot),
    /// Eight digital inputs of a module, by number of the byte.
    Digital(u8),
    /// Analog input of a module, by channel.
    Analog(u8),
    /// Position of an encoder, in counts.
    Encoder,
    /// Unused bits.
    Nothing,
}

/// Value that is commanded in a PDO.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CommandedValue {
    /// Control word.
    Control,
    /// Target position, in counts.
    Position,
    /// Target velocity.
    Velocity,
    /// Target torque, in 0.1 % of rated torque.
    Torque,
    /// Modes of operation.
    Mode,
    /// Digital outputs of a drive.
    Outputs,
    /// Eight digital outputs of a module, by number of the byte.
    Digital(u8),
    /// Analog output of a module, by channel.
    Analog(u8),
    /// Unused bits, sent as 0.
    Nothing,
}

/// Value in a PDO.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Field<W> {
    /// Meaning of the value.
    pub word: W,
    /// Mapped object.
    pub object: Object,
    /// Length, in bits.
    pub bits: u32,
}

impl Field<ReportedValue> {
    /// Creates a field of a reported value.
    pub const fn reported(word: ReportedValue, object: Object, bits: u32) -> Self {
        Self { word, object, bits }
    }

    /// Returns true if an object of the dictionary has the type and the access of this field: a readable integer of its length.
    pub fn matches_entry(&self, entry: MappableObject) -> bool {
        entry.data_type.may_be_integer(self.bits) && entry.is_readable
    }
}

/// Objects that a drive sends on change if it can, although no cell needs them.
pub const OPTIONAL: [Field<ReportedValue>; 2] = [
    Field::reported(ReportedValue::Inputs, objects::DIGITAL_INPUTS, 32),
    Field::reported(ReportedValue::Fault, objects::ERROR_CODE, 16),
];

impl Field<CommandedValue> {
    /// Creates a field of a commanded value.
    pub const fn commanded(word: CommandedValue, object: Object, bits: u32) -> Self {
        Self { word, object, bits }
    }
}

/// Objects of the mode of operation that no PDO can carry, so that they are exchanged by SDO.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ModeBySdo {
    /// Whether 6060h is written by SDO.
    pub writes: bool,
    /// Whether 6061h is read by SDO.
    pub reads: bool,
}

impl ModeBySdo {
    /// Returns a message about the objects that are exchanged by SDO; `None` if PDOs carry both.
    pub fn sentence(self) -> Option<&'static str> {
        match (self.writes, self.reads) {
            (true, true) => Some("6060h and 6061h are in no PDO: the mode goes by SDO"),
            (true, false) => Some("6060h is in no PDO: the mode is written by SDO"),
            (false, true) => Some("6061h is in no PDO: the mode is read by SDO"),
            (false, false) => None,
        }
    }
}

/// Values that a drive reports in addition to those of its mode.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Extras {
    /// Captures of the touch probes.
    pub probes: Probes,
    /// Whether the torque is reported.
    pub torque: bool,
}

/// Objects of a device, as its description lists them.
pub trait MappableObjects {
    /// Returns an object; `None` if the description lacks it.
    fn mappable_object(&self, object: Object) -> Option<MappableObject>;

    /// Returns true if a PDO of the description carries the object.
    fn is_in_pdo(&self, direction: Direction, object: Object) -> bool;
}

/// Properties of an object that decide about its mapping.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MappableObject {
    /// Data type.
    pub data_type: DataType,
    /// Whether the object can be read.
    pub is_readable: bool,
    /// Whether the object can be mapped to a PDO.
    pub is_mappable: bool,
}

/// Reason why an object cannot be mapped to a PDO.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Unmapped {
    /// The file lacks the object.
    #[error("is missing in the eds")]
    Missing,
    /// Its PDOMapping is not 1, and no PDO of the file carries it.
    #[error("cannot be mapped to a PDO, by the dictionary of the drive")]
    NotMappable,
}

impl Unmapped {
    /// Returns the reason why a PDO cannot carry an object; `None` if it can, or if there is no dictionary.
    fn of(dictionary: Option<&dyn MappableObjects>, direction: Direction, object: Object) -> Option<Self> {
        let known = dictionary?;
        match known.mappable_object(object) {
            None => Some(Self::Missing),
            Some(entry) if entry.is_mappable || known.is_in_pdo(direction, object) => None,
            Some(_) => Some(Self::NotMappable),
        }
    }
}

/// Reason why the objects of a drive cannot be mapped.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum MappingError {
    /// An object that the interface needs cannot be mapped.
    #[error("{0} {1}; mode {2} needs it in each cycle")]
    NotMappable(Object, Unmapped, &'static str),
    /// An object that entries of `io` need cannot be mapped.
    #[error("{0} {1}; entries of io need it")]
    NoTerminal(Object, Unmapped),
    /// The torque that the effort of the axis needs cannot be mapped.
    #[error("{object} {0}; rated_effort needs it", object = objects::TORQUE)]
    NoTorque(Unmapped),
    /// Touch probes need an object, but there is no dictionary.
    #[error("probes need {0} in a PDO; the drive has no dictionary (key eds) that maps it")]
    NoProbe(Object),
    /// The dictionary lacks an object that a touch probe needs.
    #[error("the eds lacks {index:04X}h ({what}), which {key} needs")]
    ProbeLacks {
        /// Index of the object.
        index: u16,
        /// Name of the object.
        what: &'static str,
        /// Key that needs the object.
        key: &'static str,
    },
    /// No PDO can carry an object that a touch probe needs; with the key that needs it.
    #[error("{0} {why}; {1} needs it", why = Unmapped::NotMappable)]
    ProbeNotMappable(Object, &'static str),
}

/// Requirements of the cell on the process data of a drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MappingRequirements {
    /// Mode of operation.
    pub mode: DriveMode,
    /// Values that the drive reports in addition to those of its mode.
    pub extras: Extras,
    /// Whether the machine reads digital inputs of the drive.
    pub has_inputs: bool,
    /// Whether the machine writes digital outputs of the drive.
    pub has_outputs: bool,
}

/// Objects of a drive in its process data.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct DriveMapping {
    /// Values that are commanded in each cycle.
    pub commanded: Vec<Field<CommandedValue>>,
    /// Values that the drive reports in each cycle.
    pub reported: Vec<Field<ReportedValue>>,
    /// Values that the drive may report on change only.
    pub on_change: Vec<Field<ReportedValue>>,
    /// Objects of the mode of operation that are exchanged by SDO instead.
    pub mode_by_sdo: ModeBySdo,
}

impl DriveMapping {
    /// Returns the process data of a drive. Without a dictionary it has only the objects that interface and terminals need. 6060h and 6061h
    /// are left out if the drive cannot map them, which is optional in CiA 402. 60FDh and 603Fh, if the cell does not need them, are left
    /// out if the dictionary gives them another type or does not allow reading.
    ///
    /// # Errors
    /// The drive cannot map a required object.
    pub fn plan(
        MappingRequirements { mode, extras, has_inputs, has_outputs }: MappingRequirements,
        dictionary: Option<&dyn MappableObjects>,
    ) -> Result<Self, MappingError> {
        let mut asked = vec![
            Field::commanded(CommandedValue::Control, objects::CONTROL_WORD, 16),
            mode.target(),
            Field::commanded(CommandedValue::Mode, objects::MODE, 8),
        ];
        let mut each_cycle = vec![
            Field::reported(ReportedValue::Status, objects::STATUS_WORD, 16),
            Field::reported(ReportedValue::Position, objects::POSITION, 32),
            Field::reported(ReportedValue::Mode, objects::MODE_DISPLAY, 8),
        ];
        let [inputs, fault] = OPTIONAL;
        let mut seldom = vec![inputs, fault];
        let goes_by_sdo = |object: Object| {
            dictionary.is_some_and(|known| known.mappable_object(object).is_none_or(|entry| !entry.is_mappable))
        };
        let mode_by_sdo = ModeBySdo { writes: goes_by_sdo(objects::MODE), reads: goes_by_sdo(objects::MODE_DISPLAY) };
        let unmapped = |direction, object| Some((object, Unmapped::of(dictionary, direction, object)?));
        asked.retain(|field| field.word != CommandedValue::Mode || !mode_by_sdo.writes);
        each_cycle.retain(|field| field.word != ReportedValue::Mode || !mode_by_sdo.reads);
        let received = asked.iter().map(|field| (Direction::Receive, field.object));
        let mut needed = received.chain(each_cycle.iter().map(|field| (Direction::Transmit, field.object)));
        if let Some((object, why)) = needed.find_map(|(direction, object)| unmapped(direction, object)) {
            return Err(MappingError::NotMappable(object, why, mode.name()));
        }
        if has_outputs {
            asked.push(Field::commanded(CommandedValue::Outputs, objects::DIGITAL_OUTPUTS, 32));
        }
        let outputs = asked.iter().find(|field| field.word == CommandedValue::Outputs);
        let used = [
            outputs.map(|field| (Direction::Receive, field.object)),
            has_inputs.then_some((Direction::Transmit, inputs.object)),
        ];
        let lacking = used.into_iter().flatten().find_map(|(direction, object)| unmapped(direction, object));
        if let Some((object, why)) = lacking {
            return Err(MappingError::NoTerminal(object, why));
        }
        let is_for_torque = mode.interface() == Interface::Torque;
        if extras.torque || is_for_torque {
            if let Some((object, why)) = unmapped(Direction::Transmit, objects::TORQUE) {
                let needed = MappingError::NotMappable(object, why, mode.name());
                return Err(if is_for_torque { needed } else { MappingError::NoTorque(why) });
            }
            each_cycle.push(Field::reported(ReportedValue::Torque, objects::TORQUE, 16));
        }
        if has_inputs {
            // Inputs of the machine are read in each cycle.
            seldom.retain(|field| *field != inputs);
        }
        // An optional object of another type or access is left out, and `check` reports a warning.
        let is_sent = |field: &Field<ReportedValue>| {
            let entry = dictionary.and_then(|known| known.mappable_object(field.object));
            entry.is_some_and(|entry| entry.is_mappable && field.matches_entry(entry))
        };
        let seldom: Vec<_> = seldom.into_iter().filter(is_sent).collect();
        for slot in probe::slots(extras.probes) {
            let [position, count] = probe::objects_of(slot);
            check_probe(slot, dictionary)?;
            // 6 bytes after 2, 6, 7 or 8 bytes: both fields are in one PDO and belong to the same capture.
            each_cycle.push(Field::reported(ReportedValue::Captured(slot), position, 32));
            each_cycle.push(Field::reported(ReportedValue::Captures(slot), count, 16));
        }
        // Added last: after 4 bytes, a PDO would have room for a position but not for its count.
        if has_inputs {
            each_cycle.push(inputs);
        }
        Ok(Self { commanded: asked, reported: each_cycle, on_change: seldom, mode_by_sdo })
    }
}

/// Checks that a PDO can carry the objects of a touch probe.
fn check_probe(slot: Slot, dictionary: Option<&dyn MappableObjects>) -> Result<(), MappingError> {
    let [position, count] = probe::objects_of(slot);
    let key = if slot < 2 { "probe_1" } else { "probe_2" };
    for (object, what) in [(position, "position of an edge"), (count, "number of edges")] {
        if dictionary.is_none() {
            return Err(MappingError::NoProbe(object));
        }
        match Unmapped::of(dictionary, Direction::Transmit, object) {
            Some(Unmapped::Missing) => return Err(MappingError::ProbeLacks { index: object.index, what, key }),
            Some(Unmapped::NotMappable) => return Err(MappingError::ProbeNotMappable(object, key)),
            None => {}
        }
    }
    Ok(())
}
