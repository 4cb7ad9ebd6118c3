//! Assignment of device objects to PDOs.
//!
//! Law      process data of every cycle is sent with each SYNC, values that seldom change are sent on change. Objects of a drive are packed
//!          in the order of their importance, as many in each PDO as fit, from PDO 1; those of modules and encoders are at the places that
//!          their profiles define
//! Reads    the dictionary of the drive, if there is one: an object can be mapped if its PDOMapping is 1, or if a PDO of the file carries
//!          it; the mode of operation (6060h, 6061h) only if its PDOMapping is 1, otherwise it is exchanged by SDO
//! Refuses  a drive that cannot map an object that its interface, or the cell, needs
//! Source   CiA 301 (objects 1400h to 1BFFh), CiA 401-1, CiA 402-2, CiA 406; MACS-CAN-18

use super::mode::DriveMode;
use super::objects;
use super::probe::{self, Probes, Slot};
use crate::config::{AnalogTerminal, Terminals};
use crate::eds::{Dictionary, Direction, Entry};
use crate::sdo::Object;
use crate::{Id, NodeId};
use lineshaft_core::drive::{Interface, Terminal};

/// Number of PDOs of each direction that have an identifier by default.
pub const MOST_PDOS: u8 = 4;
/// Bits of a PDO.
const ROOM: u32 = 64;

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
    const fn told(word: ReportedValue, object: Object, bits: u32) -> Self {
        Self { word, object, bits }
    }

    /// Returns true if an object of the dictionary has the type and the access of this field: a readable integer of its length.
    pub(crate) fn matches_entry(&self, entry: &Entry) -> bool {
        entry.data_type.may_be_integer(self.bits) && entry.access.is_readable()
    }
}

/// Objects that a drive sends on change if it can, although no cell needs them.
pub(crate) const OPTIONAL: [Field<ReportedValue>; 2] = [
    Field::told(ReportedValue::Inputs, objects::DIGITAL_INPUTS, 32),
    Field::told(ReportedValue::Fault, objects::ERROR_CODE, 16),
];

impl Field<CommandedValue> {
    const fn asked(word: CommandedValue, object: Object, bits: u32) -> Self {
        Self { word, object, bits }
    }
}

/// Transmission of a PDO.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Transmission {
    /// With each SYNC (type 1).
    EachSync,
    /// On change (type 255).
    OnChange,
}

impl Transmission {
    /// Returns the transmission type.
    pub fn number(self) -> u8 {
        match self {
            Self::EachSync => 1,
            Self::OnChange => 255,
        }
    }
}

/// PDO with its mapping.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pdo<W> {
    /// PDO number, from 1.
    pub number: u8,
    /// Identifier.
    pub id: Id,
    /// Transmission.
    pub transmission: Transmission,
    /// Whether the master writes the mapping; otherwise the user has to map the PDO in the device.
    pub is_mapped: bool,
    /// Mapped values, from bit 0.
    pub fields: Vec<Field<W>>,
}

impl<W> Pdo<W> {
    /// Returns the length in bits.
    pub fn bits(&self) -> u32 {
        self.fields.iter().map(|field| field.bits).sum()
    }

    /// Returns the length in bytes.
    pub fn bytes(&self) -> u8 {
        // A PDO has at most 64 bits.
        self.bits().div_ceil(8) as u8
    }
}

/// PDOs of a device.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Layout {
    /// PDOs that the device receives.
    pub asked: Vec<Pdo<CommandedValue>>,
    /// PDOs that the device sends.
    pub told: Vec<Pdo<ReportedValue>>,
    /// Objects of the mode of operation that are exchanged by SDO instead.
    pub mode_by_sdo: ModeBySdo,
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
    fn of(dictionary: Option<&Dictionary>, direction: Direction, object: Object) -> Option<Self> {
        let known = dictionary?;
        match known.entry(object) {
            None => Some(Self::Missing),
            Some(entry) if entry.is_mappable || known.find_pdo_with(direction, object).is_some() => None,
            Some(_) => Some(Self::NotMappable),
        }
    }
}

/// Reason why a layout is not possible.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum LayoutError {
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
    /// The objects do not fit in the PDOs.
    #[error("what is mapped needs more than {MOST_PDOS} PDOs")]
    TooMany,
}

impl Layout {
    /// Returns all objects that the PDOs carry, and 6060h if it is written by SDO: the objects that are commanded or read cyclically.
    pub fn mapped(&self) -> impl Iterator<Item = Object> {
        let asked = self.asked.iter().flat_map(|pdo| &pdo.fields).map(|field| field.object);
        let mode = self.mode_by_sdo.writes.then_some(objects::MODE);
        asked.chain(self.told.iter().flat_map(|pdo| &pdo.fields).map(|field| field.object)).chain(mode)
    }

    /// Returns the PDOs of a drive. Without a dictionary they carry only the objects that interface and terminals need. 6060h and 6061h are
    /// left out if the drive cannot map them, which is optional in CiA 402. 60FDh and 603Fh, if the cell does not need them, are left out
    /// if the dictionary gives them another type or does not allow reading.
    ///
    /// # Errors
    /// The drive cannot map a required object.
    pub fn plan(
        node: NodeId,
        mode: DriveMode,
        extras: Extras,
        terminals: &Terminals,
        dictionary: Option<&Dictionary>,
    ) -> Result<Self, LayoutError> {
        let mut asked = vec![
            Field::asked(CommandedValue::Control, objects::CONTROL_WORD, 16),
            mode.target(),
            Field::asked(CommandedValue::Mode, objects::MODE, 8),
        ];
        let mut each_sync = vec![
            Field::told(ReportedValue::Status, objects::STATUS_WORD, 16),
            Field::told(ReportedValue::Position, objects::POSITION, 32),
            Field::told(ReportedValue::Mode, objects::MODE_DISPLAY, 8),
        ];
        let [inputs, fault] = OPTIONAL;
        let mut seldom = vec![inputs, fault];
        let goes_by_sdo =
            |object: Object| dictionary.is_some_and(|known| known.entry(object).is_none_or(|entry| !entry.is_mappable));
        let mode_by_sdo = ModeBySdo { writes: goes_by_sdo(objects::MODE), reads: goes_by_sdo(objects::MODE_DISPLAY) };
        let unmapped = |direction, object| Some((object, Unmapped::of(dictionary, direction, object)?));
        asked.retain(|field| field.word != CommandedValue::Mode || !mode_by_sdo.writes);
        each_sync.retain(|field| field.word != ReportedValue::Mode || !mode_by_sdo.reads);
        let received = asked.iter().map(|field| (Direction::Receive, field.object));
        let mut needed = received.chain(each_sync.iter().map(|field| (Direction::Transmit, field.object)));
        if let Some((object, why)) = needed.find_map(|(direction, object)| unmapped(direction, object)) {
            return Err(LayoutError::NotMappable(object, why, mode.name()));
        }
        let has_inputs = !terminals.digital_inputs.is_empty();
        if !terminals.digital_outputs.is_empty() {
            asked.push(Field::asked(CommandedValue::Outputs, objects::DIGITAL_OUTPUTS, 32));
        }
        let outputs = asked.iter().find(|field| field.word == CommandedValue::Outputs);
        let used = [
            outputs.map(|field| (Direction::Receive, field.object)),
            has_inputs.then_some((Direction::Transmit, inputs.object)),
        ];
        let lacking = used.into_iter().flatten().find_map(|(direction, object)| unmapped(direction, object));
        if let Some((object, why)) = lacking {
            return Err(LayoutError::NoTerminal(object, why));
        }
        let is_for_torque = mode.interface() == Interface::Torque;
        if extras.torque || is_for_torque {
            if let Some((object, why)) = unmapped(Direction::Transmit, objects::TORQUE) {
                let needed = LayoutError::NotMappable(object, why, mode.name());
                return Err(if is_for_torque { needed } else { LayoutError::NoTorque(why) });
            }
            each_sync.push(Field::told(ReportedValue::Torque, objects::TORQUE, 16));
        }
        if has_inputs {
            // Inputs of the machine are read in each cycle.
            seldom.retain(|field| *field != inputs);
        }
        // An optional object of another type or access is left out, and `check` reports a warning.
        let is_sent = |field: &Field<ReportedValue>| {
            let entry = dictionary.and_then(|known| known.entry(field.object));
            entry.is_some_and(|entry| entry.is_mappable && field.matches_entry(entry))
        };
        let seldom: Vec<_> = seldom.into_iter().filter(is_sent).collect();
        for slot in probe::slots(extras.probes) {
            let [position, count] = probe::objects_of(slot);
            check_probe(slot, dictionary)?;
            // 6 bytes after 2, 6, 7 or 8 bytes: both fields are in one PDO and belong to the same capture.
            each_sync.push(Field::told(ReportedValue::Captured(slot), position, 32));
            each_sync.push(Field::told(ReportedValue::Captures(slot), count, 16));
        }
        // Added last: after 4 bytes, a PDO would have room for a position but not for its count.
        if has_inputs {
            each_sync.push(inputs);
        }
        let mut told = pack(&each_sync, Transmission::EachSync, 1, |number| node.tpdo(number))?;
        let next = told.len() as u8 + 1;
        told.extend(pack(&seldom, Transmission::OnChange, next, |number| node.tpdo(number))?);
        let asked = pack(&asked, Transmission::EachSync, 1, |number| node.rpdo(number))?;
        Ok(Self { asked, told, mode_by_sdo })
    }

    /// Returns the PDOs of a module: digital channels in PDO 1, analog channels from PDO 2, from the first channel to the last one that is
    /// used, as the profile defines.
    ///
    /// # Errors
    /// The channels do not fit in the PDOs.
    pub fn module(node: NodeId, terminals: &Terminals) -> Result<Self, LayoutError> {
        let Terminals { digital_inputs, digital_outputs, analog_inputs, analog_outputs, .. } = terminals;
        let digital = |used: &[Terminal]| used.iter().map(|terminal| terminal.address / 8).max();
        let analog = |used: &[AnalogTerminal]| used.iter().map(|analog| analog.terminal.address).max();
        let told = [
            (fields(digital(digital_inputs), ReportedValue::Digital, objects::MODULE_INPUTS, 8), 1),
            (fields(analog(analog_inputs), ReportedValue::Analog, objects::MODULE_ANALOG_INPUTS, 16), 2),
        ];
        let asked = [
            (fields(digital(digital_outputs), CommandedValue::Digital, objects::MODULE_OUTPUTS, 8), 1),
            (fields(analog(analog_outputs), CommandedValue::Analog, objects::MODULE_ANALOG_OUTPUTS, 16), 2),
        ];
        let mut layout = Self { asked: Vec::new(), told: Vec::new(), mode_by_sdo: ModeBySdo::default() };
        for (fields, first) in told {
            layout.told.extend(pack(&fields, Transmission::EachSync, first, |number| node.tpdo(number))?);
        }
        for (fields, first) in asked {
            layout.asked.extend(pack(&fields, Transmission::EachSync, first, |number| node.rpdo(number))?);
        }
        Ok(layout)
    }

    /// Returns the PDO of an encoder: its position, in PDO 2.
    ///
    /// # Errors
    /// Cannot fail: the position fits.
    pub fn encoder(node: NodeId) -> Result<Self, LayoutError> {
        let position = [Field::told(ReportedValue::Encoder, objects::ENCODER_POSITION, 32)];
        let told = pack(&position, Transmission::EachSync, 2, |number| node.tpdo(number))?;
        Ok(Self { asked: Vec::new(), told, mode_by_sdo: ModeBySdo::default() })
    }
}

/// Checks that a PDO can carry the objects of a touch probe.
fn check_probe(slot: Slot, dictionary: Option<&Dictionary>) -> Result<(), LayoutError> {
    let [position, count] = probe::objects_of(slot);
    let key = if slot < 2 { "probe_1" } else { "probe_2" };
    for (object, what) in [(position, "position of an edge"), (count, "number of edges")] {
        if dictionary.is_none() {
            return Err(LayoutError::NoProbe(object));
        }
        match Unmapped::of(dictionary, Direction::Transmit, object) {
            Some(Unmapped::Missing) => return Err(LayoutError::ProbeLacks { index: object.index, what, key }),
            Some(Unmapped::NotMappable) => return Err(LayoutError::ProbeNotMappable(object, key)),
            None => {}
        }
    }
    Ok(())
}

/// Returns the fields of consecutive subindices, from the first object to the one at place `last`.
fn fields<W>(last: Option<u16>, word: fn(u8) -> W, first: Object, bits: u32) -> Vec<Field<W>> {
    let last = last.map(|last| u8::try_from(last).unwrap_or(u8::MAX));
    let of =
        |place: u8| Field { word: word(place), object: Object { sub: first.sub.saturating_add(place), ..first }, bits };
    last.into_iter().flat_map(|last| (0..=last).map(of)).collect()
}

/// Packs fields in their order, as many in each PDO as fit.
fn pack<W: Copy>(
    fields: &[Field<W>],
    transmission: Transmission,
    first: u8,
    id: impl Fn(u8) -> Option<Id>,
) -> Result<Vec<Pdo<W>>, LayoutError> {
    let mut pdos: Vec<Pdo<W>> = Vec::new();
    for field in fields {
        match pdos.last_mut().filter(|pdo| pdo.bits() + field.bits <= ROOM) {
            Some(pdo) => pdo.fields.push(*field),
            None => {
                let number = first.saturating_add(pdos.len() as u8);
                let id = id(number).ok_or(LayoutError::TooMany)?;
                pdos.push(Pdo { number, id, transmission, is_mapped: true, fields: vec![*field] });
            }
        }
    }
    Ok(pdos)
}

#[cfg(test)]
mod tests;
