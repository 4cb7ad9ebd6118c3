//! Numbers with which MACS selects the source of a position: ENCODERTYPE and MENCODERTYPE.
//!
//! Law      bus: v = guard * (bus + device * 1000 + id), guard 1 with and -1 without node guarding; EtherCAT:
//!          200000 + 51 * 1000 + 100 pdo + offset, without a sign
//! Refuses  numbers that are not in the table
//! Source   MACS-ENC-04, -05, -06, -14, -15, A-10, A-13

use serde::{Deserialize, Serialize};

/// Device number of a CANopen encoder.
const CANOPEN_ENCODER: u8 = 50;

/// A position on a bus.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bus {
    /// A CAN node.
    Can {
        /// Whether node guarding is on.
        guarded: bool,
        /// Whether it is on the slave bus; otherwise it is on the master bus.
        slave: bool,
        /// Kind of device by the numbers of DRIVETYPE: 1 to 49; 50 is a CANopen encoder.
        device: u8,
        /// Node, 1 to 127.
        node: u8,
        /// PDO of the position: 2 or 3.
        pdo: u8,
    },
    /// An entry of the EtherCAT process data.
    EtherCat {
        /// Number of the PDO.
        pdo: u8,
        /// First word of 32 bits: the position, followed by that of the index.
        offset: u8,
    },
}

/// Source of the position of an axis (ENCODERTYPE).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Feedback {
    /// 0: the encoder of its drive.
    Incremental,
    /// 1 to 4: an absolute encoder.
    Absolute {
        /// Clock rate (Hz): 262 000 or 105 000.
        rate: u32,
        /// 3 and 4: without overflow, with correction of bad values.
        corrects: bool,
    },
    /// 5: sine and cosine, counted as an incremental one.
    SineCosine,
    /// 9: its command.
    Simulated,
    /// 10, 20, 30: encoder terminal 1, 2, 3.
    Terminal(u8),
    /// Above 1000.
    Bus(Bus),
}

/// Source of the position of the master of an axis (MENCODERTYPE).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Master {
    /// 0, 5: the incremental master encoder.
    Incremental,
    /// 1, 2: an absolute encoder, with its clock rate (Hz).
    Absolute(u32),
    /// 6: the master simulation.
    Simulation,
    /// 10, 20, 30: encoder terminal 1, 2, 3.
    Terminal(u8),
    /// -1 to -999: the command of that axis, from 1 on.
    Axis(u16),
    /// Above 1000.
    Bus(Bus),
}

impl Bus {
    fn decode(value: i64) -> Option<Self> {
        let (guarded, size) = (value > 0, value.unsigned_abs());
        let (bus, device, id) = (size / 100_000, size % 100_000 / 1000, size % 1000);
        if bus == 2 && device == 51 && guarded {
            return Some(Self::EtherCat { pdo: (id / 100) as u8, offset: (id % 100) as u8 });
        }
        let (node, pdo) = match id {
            1..=127 => (id, 2),
            257..=383 if device == 1 => (id - 256, 3),
            _ => return None,
        };
        let is_can = bus <= 1 && (1..=CANOPEN_ENCODER.into()).contains(&device);
        is_can.then_some(Self::Can { guarded, slave: bus == 1, device: device as u8, node: node as u8, pdo })
    }
}

impl Feedback {
    /// Decodes ENCODERTYPE; none for a number that does not exist.
    pub fn decode(value: i64) -> Option<Self> {
        Some(match value {
            0 => Self::Incremental,
            1..=4 => Self::Absolute { rate: rate(value), corrects: value > 2 },
            5 => Self::SineCosine,
            9 => Self::Simulated,
            10 | 20 | 30 => Self::Terminal((value / 10) as u8),
            _ => Self::Bus(Bus::decode(value)?),
        })
    }
}

impl Bus {
    /// Whether its values are those of an absolute encoder (MACS-ENC-07).
    fn is_absolute(self) -> bool {
        matches!(self, Self::Can { device: CANOPEN_ENCODER, .. })
    }
}

/// Which of the possible sources of an axis are absolute encoders, as configured in the cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct AbsoluteSources {
    /// Source with ENCODERTYPE 0 and 5.
    pub own: bool,
    /// Encoder terminals 1 to 3.
    pub terminals: [bool; 3],
}

impl AbsoluteSources {
    /// Whether ENCODERTYPE selects an absolute one of them. Absolute values are used 1:1, others count four edges
    /// (MACS-ENC-01); a sine has four, too.
    pub fn chosen_by(self, encodertype: i64) -> bool {
        match Feedback::decode(encodertype) {
            Some(Feedback::Absolute { .. }) => true,
            Some(Feedback::Incremental | Feedback::SineCosine) => self.own,
            Some(Feedback::Terminal(number)) => {
                usize::from(number).checked_sub(1).and_then(|place| self.terminals.get(place)).is_some_and(|is| *is)
            }
            Some(Feedback::Bus(bus)) => bus.is_absolute(),
            Some(Feedback::Simulated) | None => false,
        }
    }
}

impl Master {
    /// Decodes MENCODERTYPE; none for a number that does not exist.
    pub fn decode(value: i64) -> Option<Self> {
        Some(match value {
            0 | 5 => Self::Incremental,
            1 | 2 => Self::Absolute(rate(value)),
            6 => Self::Simulation,
            10 | 20 | 30 => Self::Terminal((value / 10) as u8),
            -999..=-1 => Self::Axis(value.unsigned_abs() as u16),
            _ => Self::Bus(Bus::decode(value)?),
        })
    }
}

/// Returns the clock rate of an absolute encoder (Hz): odd types are fast.
fn rate(kind: i64) -> u32 {
    if kind % 2 == 1 { 262_000 } else { 105_000 }
}

#[cfg(test)]
mod tests {
    use super::*;

    const fn can(guarded: bool, slave: bool, device: u8, node: u8, pdo: u8) -> Bus {
        Bus::Can { guarded, slave, device, node, pdo }
    }

    /// The examples of the manual.
    ///
    /// Proves: MACS-O-53, MACS-ENC-05, MACS-ENC-06
    #[test]
    fn the_examples_decode() {
        for (value, expected) in [
            (102_005, can(true, true, 2, 5, 2)),
            (-102_005, can(false, true, 2, 5, 2)),
            (150_012, can(true, true, 50, 12, 2)),
            (101_263, can(true, true, 1, 7, 3)),
            (251_105, Bus::EtherCat { pdo: 1, offset: 5 }),
            (1_001, can(true, false, 1, 1, 2)),
            (49_127, can(true, false, 49, 127, 2)),
        ] {
            assert_eq!(Feedback::decode(value), Some(Feedback::Bus(expected)), "{value}");
            assert_eq!(Master::decode(value), Some(Master::Bus(expected)), "{value}");
        }
    }

    /// Numbers that are not in the tables: nodes and devices out of range, PDO 3 of other devices, EtherCAT with a sign
    ///
    #[test]
    fn other_numbers_are_none() {
        for value in [
            -1,
            6,
            7,
            8,
            11,
            40,
            999,
            1_000,
            1_128,
            1_256,
            1_384,
            2_257,
            51_001,
            91_001,
            92_005,
            151_001,
            202_005,
            -251_105,
            252_105,
            1_000_001,
            i64::MAX,
            i64::MIN,
        ] {
            assert_eq!(Feedback::decode(value), None, "{value}");
        }
        for value in [-1_000, 3, 4, 9, 7, -251_105, i64::MIN] {
            assert_eq!(Master::decode(value), None, "{value}");
        }
    }

    /// Proves: MACS-ENC-04
    #[test]
    fn the_local_types_decode() {
        let absolute = |rate, corrects| Some(Feedback::Absolute { rate, corrects });
        let expected = [
            (0, Some(Feedback::Incremental)),
            (1, absolute(262_000, false)),
            (2, absolute(105_000, false)),
            (3, absolute(262_000, true)),
            (4, absolute(105_000, true)),
            (5, Some(Feedback::SineCosine)),
            (9, Some(Feedback::Simulated)),
            (10, Some(Feedback::Terminal(1))),
            (20, Some(Feedback::Terminal(2))),
            (30, Some(Feedback::Terminal(3))),
        ];
        for (value, expected) in expected {
            assert_eq!(Feedback::decode(value), expected, "{value}");
        }
        for (value, expected) in [
            (0, Master::Incremental),
            (1, Master::Absolute(262_000)),
            (2, Master::Absolute(105_000)),
            (6, Master::Simulation),
            (30, Master::Terminal(3)),
            (-1, Master::Axis(1)),
            (-999, Master::Axis(999)),
        ] {
            assert_eq!(Master::decode(value), Some(expected), "{value}");
        }
    }
}
