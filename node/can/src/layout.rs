//! Assignment of device objects to PDOs.
//!
//! Law      process data of every cycle is sent with each SYNC, values that seldom change are sent on change. Objects of a drive are packed
//!          in the order of their importance, as many in each PDO as fit, from PDO 1; those of modules and encoders are at the places that
//!          their profiles define
//! Refuses  objects that do not fit in the PDOs, and drives that cannot map an object that its interface, or the cell, needs
//! Source   CiA 301 (objects 1400h to 1BFFh), CiA 401-1, CiA 406; MACS-CAN-18

use crate::eds::Dictionary;
use crate::{Id, NodeId, can_objects};
use lineshaft_cia402::config::{AnalogTerminal, Terminals};
use lineshaft_cia402::dictionary::Direction;
use lineshaft_cia402::drive_type::DriveType;
use lineshaft_cia402::mapping::{
    CommandedValue, DriveMapping, Extras, Field, MappableObject, MappableObjects, MappingError, MappingRequirements,
    ModeBySdo, ReportedValue,
};
use lineshaft_cia402::mode::DriveMode;
use lineshaft_cia402::object::Object;
use lineshaft_cia402::objects;
use lineshaft_core::drive::Terminal;

/// Number of PDOs of each direction that have an identifier by default.
pub const MOST_PDOS: u8 = 4;
/// Number of analog channels of a module that fit in PDOs.
pub const ANALOG_CHANNELS: usize = 12;
/// Bits of a PDO.
const ROOM: u32 = 64;

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

/// Reason why a layout is not possible.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum LayoutError {
    /// The drive cannot map an object.
    #[error(transparent)]
    Mapping(#[from] MappingError),
    /// The objects do not fit in the PDOs.
    #[error("the mapped objects need more than {MOST_PDOS} PDOs")]
    TooMany,
}

impl MappableObjects for Dictionary {
    fn mappable_object(&self, object: Object) -> Option<MappableObject> {
        let entry = self.entry(object)?;
        let (data_type, is_mappable) = (entry.data_type, entry.is_mappable);
        Some(MappableObject { data_type, is_readable: entry.access.is_readable(), is_mappable })
    }

    fn is_in_pdo(&self, direction: Direction, object: Object) -> bool {
        self.find_pdo_with(direction, object).is_some()
    }
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
        let requirements = MappingRequirements {
            mode,
            extras,
            has_inputs: !terminals.digital_inputs.is_empty(),
            has_outputs: !terminals.digital_outputs.is_empty(),
        };
        let mapping = DriveMapping::plan(requirements, dictionary.map(|known| known as &dyn MappableObjects))?;
        let mut told = pack(&mapping.reported, Transmission::EachSync, 1, |number| node.tpdo(number))?;
        let next = told.len() as u8 + 1;
        told.extend(pack(&mapping.on_change, Transmission::OnChange, next, |number| node.tpdo(number))?);
        let asked = pack(&mapping.commanded, Transmission::EachSync, 1, |number| node.rpdo(number))?;
        Ok(Self { asked, told, mode_by_sdo: mapping.mode_by_sdo })
    }

    /// Returns the layout with PDO 1 of a drive type.
    ///
    /// # Errors
    /// Cannot fail: the fields fit in PDO 1.
    pub fn of_drive_type(node: NodeId, drive_type: DriveType) -> Result<Self, LayoutError> {
        let DriveMapping { commanded, reported, mode_by_sdo, .. } = drive_type.mapping();
        let (is_mapped, transmission) = (!drive_type.is_mapped_by_user(), Transmission::EachSync);
        let rpdo = node.rpdo(1).ok_or(LayoutError::TooMany)?;
        let tpdo = node.tpdo(1).ok_or(LayoutError::TooMany)?;
        Ok(Self {
            asked: vec![Pdo { number: 1, id: rpdo, transmission, is_mapped, fields: commanded }],
            told: vec![Pdo { number: 1, id: tpdo, transmission, is_mapped, fields: reported }],
            mode_by_sdo,
        })
    }

    /// Returns the objects of the PDOs of a drive.
    pub(crate) fn drive_mapping(&self) -> DriveMapping {
        let told = |transmission| {
            let pdos = self.told.iter().filter(move |pdo| pdo.transmission == transmission);
            pdos.flat_map(|pdo| pdo.fields.iter().copied()).collect()
        };
        DriveMapping {
            commanded: self.asked.iter().flat_map(|pdo| pdo.fields.iter().copied()).collect(),
            reported: told(Transmission::EachSync),
            on_change: told(Transmission::OnChange),
            mode_by_sdo: self.mode_by_sdo,
        }
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
            (fields(digital(digital_inputs), ReportedValue::Digital, can_objects::MODULE_INPUTS, 8), 1),
            (fields(analog(analog_inputs), ReportedValue::Analog, can_objects::MODULE_ANALOG_INPUTS, 16), 2),
        ];
        let asked = [
            (fields(digital(digital_outputs), CommandedValue::Digital, can_objects::MODULE_OUTPUTS, 8), 1),
            (fields(analog(analog_outputs), CommandedValue::Analog, can_objects::MODULE_ANALOG_OUTPUTS, 16), 2),
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
        let position = [Field::reported(ReportedValue::Encoder, can_objects::ENCODER_POSITION, 32)];
        let told = pack(&position, Transmission::EachSync, 2, |number| node.tpdo(number))?;
        Ok(Self { asked: Vec::new(), told, mode_by_sdo: ModeBySdo::default() })
    }
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
