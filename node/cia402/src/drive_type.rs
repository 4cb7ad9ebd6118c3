//! Drive types of MACS (DRIVETYPE).
//!
//! Law      |v| is the type, or the type + 100 if the control word is not written; a positive number enables node guarding
//! Refuses  numbers that the table lacks; types whose process data the source does not describe
//! Source   MACS-CAN-01, -02, -08, -11, -12, -13, A-51, A-53

use crate::mapping::{CommandedValue, DriveMapping, Field, ReportedValue};
use crate::object::Object;
use crate::objects;

/// Dummy entry of 16 bits for unused process data (CiA 301, data type 0006h).
const DUMMY_U16: Object = Object { index: 0x0006, sub: 0 };

/// Kind of drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// 1: Lenze, 100 % is 5000h.
    Lenze,
    /// 2: CiA 402 servo drive (DS402).
    Ds402,
    /// 3: maxon EPOS.
    Epos,
    /// 4: zub DSA.
    Dsa,
    /// 5: Lenze, 100 % is 4000h.
    LenzeProfibus,
    /// 10: Danfoss.
    Danfoss,
    /// 11: Servostar.
    Servostar,
    /// 12: Lenze 8400.
    Lenze8400,
    /// 13: Kollmorgen AKD.
    Akd,
    /// 91 to 94: analog outputs 1 to 4 of a module.
    Analog(u8),
}

/// DRIVETYPE other than 0, which is no drive on a bus.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DriveType {
    /// Kind of drive.
    pub kind: Kind,
    /// Whether node guarding is enabled.
    pub guarded: bool,
    /// Whether the controller writes the control word.
    pub controlled: bool,
}

impl DriveType {
    /// Decodes DRIVETYPE; `None` for 0, and for a number that the table lacks.
    pub fn decode(value: i16) -> Option<Self> {
        let size = value.unsigned_abs();
        let (kind, controlled) = if size > 100 { (size - 100, false) } else { (size, true) };
        let kind = match kind {
            1 => Kind::Lenze,
            2 => Kind::Ds402,
            3 => Kind::Epos,
            4 => Kind::Dsa,
            5 => Kind::LenzeProfibus,
            10 => Kind::Danfoss,
            11 => Kind::Servostar,
            12 => Kind::Lenze8400,
            13 => Kind::Akd,
            91..=94 => Kind::Analog((kind - 90) as u8),
            _ => return None,
        };
        Some(Self { kind, guarded: value > 0, controlled })
    }

    /// Returns the reason why the drive type is not supported; `None` if it is supported.
    pub fn unsupported_reason(self) -> Option<&'static str> {
        if !self.controlled {
            return Some("nothing here writes a control word that the axis leaves alone");
        }
        match self.kind {
            Kind::Ds402 | Kind::Epos | Kind::Dsa | Kind::Servostar | Kind::Akd => None,
            Kind::Lenze | Kind::LenzeProfibus | Kind::Danfoss | Kind::Lenze8400 => {
                Some("its control and status words are not those of CiA 402, and no source tells them")
            }
            Kind::Analog(_) => Some("an axis has its speed at an ao of section io by interface open_loop (wf)"),
        }
    }

    /// Returns true if the user must map the PDOs in the drive: those of [`Kind::Servostar`] and [`Kind::Akd`].
    pub fn is_mapped_by_user(self) -> bool {
        matches!(self.kind, Kind::Servostar | Kind::Akd)
    }

    /// Returns the process data of this type: PDO 1 in each direction.
    pub fn mapping(self) -> DriveMapping {
        let asked = [
            Field { word: CommandedValue::Control, object: objects::CONTROL_WORD, bits: 16 },
            Field { word: CommandedValue::Velocity, object: objects::TARGET_VELOCITY, bits: 32 },
            // Latch control: the latch is not used.
            Field { word: CommandedValue::Nothing, object: DUMMY_U16, bits: 16 },
        ];
        let position = |bits| Field { word: ReportedValue::Position, object: objects::POSITION, bits };
        // Position and status of the latch.
        let unused = Field { word: ReportedValue::Nothing, object: DUMMY_U16, bits: 16 };
        let status = Field { word: ReportedValue::Status, object: objects::STATUS_WORD, bits: 16 };
        let (asked, told) = match self.kind {
            Kind::Akd => (asked.to_vec(), vec![status, position(16), unused, unused]),
            _ => (asked.into_iter().take(2).collect(), vec![status, position(32)]),
        };
        DriveMapping { commanded: asked, reported: told, ..DriveMapping::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const fn kind(kind: Kind, guarded: bool, controlled: bool) -> Option<DriveType> {
        Some(DriveType { kind, guarded, controlled })
    }

    /// -110 is a Danfoss without guarding and control word, 13 an AKD with guarding, -91 analog output 1 without guarding.
    ///
    /// Proves: MACS-O-55, MACS-CAN-01, MACS-CAN-02
    #[test]
    fn drivetype_numbers_are_decoded() {
        for (value, expected) in [
            (-110, kind(Kind::Danfoss, false, false)),
            (13, kind(Kind::Akd, true, true)),
            (-91, kind(Kind::Analog(1), false, true)),
            (1, kind(Kind::Lenze, true, true)),
            (-2, kind(Kind::Ds402, false, true)),
            (103, kind(Kind::Epos, true, false)),
            (4, kind(Kind::Dsa, true, true)),
            (5, kind(Kind::LenzeProfibus, true, true)),
            (11, kind(Kind::Servostar, true, true)),
            (-112, kind(Kind::Lenze8400, false, false)),
            (94, kind(Kind::Analog(4), true, true)),
            (194, kind(Kind::Analog(4), true, false)),
        ] {
            assert_eq!(DriveType::decode(value), expected, "{value}");
        }
        for value in [0, 6, 9, 14, 90, 95, 100, -100, 106, 190, 195, -195, 200, 1013, i16::MAX, i16::MIN] {
            assert_eq!(DriveType::decode(value), None, "{value}");
        }
    }

    /// Servostar: control word and reference of 4 bytes; status word and position of 4 bytes. AKD: fields of 2, 4, 2 bytes; 2, 2, 2, 2
    /// bytes.
    ///
    /// Proves: MACS-CAN-11, MACS-CAN-12
    #[test]
    fn process_data_has_fields_of_drive_type() {
        let lengths = |value| {
            let of_type = DriveType::decode(value).unwrap();
            let mapping = of_type.mapping();
            let asked: Vec<_> = mapping.commanded.iter().map(|field| field.bits / 8).collect();
            let told: Vec<_> = mapping.reported.iter().map(|field| field.bits / 8).collect();
            (asked, told, of_type.is_mapped_by_user())
        };
        assert_eq!(lengths(2), (vec![2, 4], vec![2, 4], false));
        assert_eq!(lengths(-4), lengths(3));
        assert_eq!(lengths(11), (vec![2, 4], vec![2, 4], true));
        assert_eq!(lengths(-13), (vec![2, 4, 2], vec![2, 2, 2, 2], true));
    }

    #[test]
    fn types_with_unknown_process_data_are_refused() {
        let is_refused = |value| DriveType::decode(value).unwrap().unsupported_reason().is_some();
        assert_eq!([2, -3, 4, 11, 13].map(is_refused), [false; 5]);
        assert_eq!([1, 5, 10, 12, 91, 102, -113].map(is_refused), [true; 7]);
    }
}
