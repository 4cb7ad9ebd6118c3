//! Which objects of a drive go in which PDO.
//!
//! Law      what every cycle needs goes with each SYNC; what seldom changes goes when it changes. Objects stand in the order in which they
//!          are needed, as many in a PDO as have room, from PDO 1 on
//! Reads    the dictionary of the drive, where there is one: an object that it does not map has no place
//! Refuses  a drive that cannot map what its interface needs
//! Source   CiA 301 (objects 1400h to 1BFFh), CiA 402-2

use super::objects;
use super::probe::{self, Probes, Slot};
use crate::eds::Dictionary;
use crate::sdo::Object;
use crate::{Id, NodeId};
use lineshaft_core::drive::Interface;

/// PDOs of each direction that have an identifier by default.
pub const MOST_PDOS: u8 = 4;
/// Bits of a PDO.
const ROOM: u32 = 64;

/// What a drive tells in a PDO.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Told {
    /// Status word.
    Status,
    /// Position (counts).
    Position,
    /// Modes of operation display.
    Mode,
    /// Digital inputs.
    Inputs,
    /// Error code.
    Fault,
    /// Position that a touch probe has caught (counts).
    Captured(Slot),
    /// How many it has caught.
    Captures(Slot),
}

/// What a drive is asked for in a PDO.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Asked {
    /// Control word.
    Control,
    /// Target position (counts).
    Position,
    /// Target velocity.
    Velocity,
    /// Modes of operation.
    Mode,
}

/// A value in a PDO.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Field<W> {
    /// What it means.
    pub word: W,
    /// Its object.
    pub object: Object,
    /// Its length.
    pub bits: u32,
}

impl Field<Told> {
    const fn told(word: Told, object: Object, bits: u32) -> Self {
        Self { word, object, bits }
    }
}

impl Field<Asked> {
    const fn asked(word: Asked, object: Object, bits: u32) -> Self {
        Self { word, object, bits }
    }
}

/// When a PDO goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Transmission {
    /// With each SYNC (type 1).
    EachSync,
    /// When it changes (type 255).
    OnChange,
}

impl Transmission {
    /// Its transmission type.
    pub fn number(self) -> u8 {
        match self {
            Self::EachSync => 1,
            Self::OnChange => 255,
        }
    }
}

/// A PDO.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pdo<W> {
    /// Its number, from 1.
    pub number: u8,
    /// Its identifier.
    pub id: Id,
    /// When it goes.
    pub transmission: Transmission,
    /// What it carries, from bit 0 on.
    pub fields: Vec<Field<W>>,
}

impl<W> Pdo<W> {
    /// Its length in bits.
    pub fn bits(&self) -> u32 {
        self.fields.iter().map(|field| field.bits).sum()
    }

    /// Its length in bytes.
    pub fn bytes(&self) -> u8 {
        // At most 64 bits.
        self.bits().div_ceil(8) as u8
    }
}

/// The PDOs of a drive.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Layout {
    /// Those that the drive receives.
    pub asked: Vec<Pdo<Asked>>,
    /// Those that the drive sends.
    pub told: Vec<Pdo<Told>>,
}

/// Why a drive has no layout.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum LayoutError {
    /// An object that is needed.
    #[error("{0} cannot be mapped to a PDO, by the dictionary of the drive; interface {1} needs it in each cycle")]
    NotMappable(Object, &'static str),
    /// What touch probes need.
    #[error("probes need {0} in a PDO; the drive has no dictionary (key eds) that maps it")]
    NoProbe(Object),
    /// Too many objects.
    #[error("what is mapped needs more than {MOST_PDOS} PDOs")]
    TooMany,
}

impl Layout {
    /// The PDOs of a drive that is commanded so; without a dictionary those objects alone that the interface needs.
    ///
    /// # Errors
    /// What the drive cannot map.
    pub fn plan(
        node: NodeId,
        interface: Interface,
        probes: Probes,
        dictionary: Option<&Dictionary>,
    ) -> Result<Self, LayoutError> {
        let target = match interface {
            Interface::Velocity => Field::asked(Asked::Velocity, objects::TARGET_VELOCITY, 32),
            _ => Field::asked(Asked::Position, objects::TARGET_POSITION, 32),
        };
        let asked = [
            Field::asked(Asked::Control, objects::CONTROL_WORD, 16),
            target,
            Field::asked(Asked::Mode, objects::MODE, 8),
        ];
        let each_sync = [
            Field::told(Told::Status, objects::STATUS_WORD, 16),
            Field::told(Told::Position, objects::POSITION, 32),
            Field::told(Told::Mode, objects::MODE_DISPLAY, 8),
        ];
        let seldom =
            [Field::told(Told::Inputs, objects::DIGITAL_INPUTS, 32), Field::told(Told::Fault, objects::ERROR_CODE, 16)];
        let maps =
            |object: Object| dictionary.is_some_and(|known| known.entry(object).is_some_and(|entry| entry.is_mappable));
        let needed = asked.iter().map(|field| field.object).chain(each_sync.iter().map(|field| field.object));
        if dictionary.is_some()
            && let Some(object) = needed.into_iter().find(|object| !maps(*object))
        {
            return Err(LayoutError::NotMappable(object, interface.name()));
        }
        let seldom: Vec<_> = seldom.into_iter().filter(|field| maps(field.object)).collect();
        let mut each_sync = each_sync.to_vec();
        for slot in probe::slots(probes) {
            let objects @ [position, count] = probe::objects_of(slot);
            if let Some(missing) = objects.into_iter().find(|object| !maps(*object)) {
                return Err(LayoutError::NoProbe(missing));
            }
            // 6 bytes behind 7, and behind 6: both in one PDO, so of one moment.
            each_sync.push(Field::told(Told::Captured(slot), position, 32));
            each_sync.push(Field::told(Told::Captures(slot), count, 16));
        }
        let mut told = packed(&each_sync, Transmission::EachSync, 1, |number| node.tpdo(number))?;
        let next = told.len() as u8 + 1;
        told.extend(packed(&seldom, Transmission::OnChange, next, |number| node.tpdo(number))?);
        Ok(Self { asked: packed(&asked, Transmission::EachSync, 1, |number| node.rpdo(number))?, told })
    }
}

/// As many fields in each PDO as have room, in their order.
fn packed<W: Copy>(
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
                pdos.push(Pdo { number, id, transmission, fields: vec![*field] });
            }
        }
    }
    Ok(pdos)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::eds;

    fn node() -> NodeId {
        NodeId::new(3).expect("1 to 127")
    }

    fn told(layout: &Layout) -> Vec<(u8, u16, u8, Vec<Told>)> {
        let of = |pdo: &Pdo<Told>| {
            let words = pdo.fields.iter().map(|field| field.word).collect();
            (pdo.number, pdo.id.get(), pdo.transmission.number(), words)
        };
        layout.told.iter().map(of).collect()
    }

    /// What each cycle needs is 7 bytes each way.
    #[test]
    fn without_a_dictionary_only_what_is_needed_is_mapped() {
        let layout = Layout::plan(node(), Interface::Position, [None; 2], None).unwrap();
        assert_eq!(told(&layout), [(1, 0x183, 1, vec![Told::Status, Told::Position, Told::Mode])]);
        let [asked] = layout.asked.as_slice() else { panic!("{:?}", layout.asked) };
        assert_eq!((asked.number, asked.id.get(), asked.bytes()), (1, 0x203, 7));
        let objects: Vec<_> = asked.fields.iter().map(|field| field.object.index).collect();
        assert_eq!(objects, [0x6040, 0x607A, 0x6060]);
        let velocity = Layout::plan(node(), Interface::Velocity, [None; 2], None).unwrap();
        assert_eq!(velocity.asked[0].fields[1].object.index, 0x60FF);
    }

    /// Digital inputs and error code go when they change, where the drive has them.
    #[test]
    fn what_the_dictionary_maps_has_a_place() {
        let text = include_bytes!("../../../../launch-configs/can/cia402_sim.eds");
        let known = eds::parse(text, Some(3)).unwrap();
        let layout = Layout::plan(node(), Interface::Position, [None; 2], Some(&known)).unwrap();
        let cyclic = (1, 0x183, 1, vec![Told::Status, Told::Position, Told::Mode]);
        assert_eq!(told(&layout), [cyclic, (2, 0x283, 255, vec![Told::Inputs, Told::Fault])]);
    }

    /// 64 bits are a PDO; one more bit is another one.
    #[test]
    fn a_pdo_is_filled_to_its_last_bit() {
        let lengths = |bits: &[u32]| {
            let field = |bits: &u32| Field::told(Told::Status, objects::STATUS_WORD, *bits);
            let fields: Vec<_> = bits.iter().map(field).collect();
            packed(&fields, Transmission::EachSync, 1, |number| node().tpdo(number))
                .map(|pdos| pdos.iter().map(Pdo::bits).collect::<Vec<_>>())
        };
        assert_eq!(lengths(&[32, 32, 8]), Ok(vec![64, 8]));
        assert_eq!(lengths(&[32, 33]), Ok(vec![32, 33]));
        assert_eq!(lengths(&[64; 4]), Ok(vec![64; 4]));
        assert_eq!(lengths(&[64; 5]), Err(LayoutError::TooMany));
    }

    #[test]
    fn a_drive_that_cannot_map_its_target_is_refused() {
        let text = String::from_utf8(include_bytes!("../../../../launch-configs/can/cia402_sim.eds").to_vec()).unwrap();
        let at = text.find("[607A]").unwrap();
        let text = format!("{}{}", &text[..at], text[at..].replacen("PDOMapping=0x1", "PDOMapping=0", 1));
        let known = eds::parse(text.as_bytes(), Some(3)).unwrap();
        let error = Layout::plan(node(), Interface::Position, [None; 2], Some(&known)).unwrap_err();
        let sentence = "607Ah:00 cannot be mapped to a PDO, by the dictionary of the drive; interface position needs it in each cycle";
        assert_eq!(error.to_string(), sentence);
        assert!(Layout::plan(node(), Interface::Velocity, [None; 2], Some(&known)).is_ok());
    }
}
