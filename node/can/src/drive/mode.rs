//! Modes of operation of a drive behind the interfaces of an axis.
//!
//! Law      an axis knows its drive in cyclic modes alone (csp, csv, cst, vl); a drive that offers others is commanded through them: what the axis
//!          asks for and sees is the number of the cyclic one
//! Reads    control words and setpoints of a cycle, the status word
//! Writes   the control word with the bits that the mode needs
//! Source   CiA 402-2 (modes pp, vl, pv, tq, ip, csp, csv, cst)

use super::layout::{Asked, Field};
use super::objects;
use lineshaft_core::drive::{DriveState, Interface, control};

/// Status word bit 12 in mode pp: the setpoint is acknowledged.
const STATUS_ACKNOWLEDGED: u16 = 0x1000;
/// Control word bit 4: a new setpoint (pp), interpolation (ip).
const BIT_4: u16 = 0x10;
/// Control word bit 5 in mode pp: a new setpoint replaces the one before at once.
const AT_ONCE: u16 = 0x20;
/// Control word bits 4 to 6 in mode vl: the ramp runs, with its input.
const RAMP: u16 = 0x70;

/// A mode of operation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DriveMode {
    /// Profile position: each setpoint is handed over, and reached by the drive's own profile.
    Pp,
    /// Velocity of frequency converters.
    Vl,
    /// Profile velocity: the drive has ramps of its own.
    Pv,
    /// Profile torque: the drive has a slope of its own.
    Tq,
    /// Interpolated position.
    Ip,
    /// Cyclic synchronous position.
    Csp,
    /// Cyclic synchronous velocity.
    Csv,
    /// Cyclic synchronous torque.
    Cst,
}

impl DriveMode {
    /// All, with the name of each.
    pub const NAMES: [(&'static str, Self); 8] = [
        ("pp", Self::Pp),
        ("vl", Self::Vl),
        ("pv", Self::Pv),
        ("tq", Self::Tq),
        ("ip", Self::Ip),
        ("csp", Self::Csp),
        ("csv", Self::Csv),
        ("cst", Self::Cst),
    ];

    /// The mode of an interface where nothing else is said; none where CAN has none.
    pub fn usual(interface: Interface) -> Option<Self> {
        match interface {
            Interface::Position => Some(Self::Csp),
            Interface::Velocity => Some(Self::Csv),
            Interface::OpenLoop => Some(Self::Vl),
            Interface::Torque => Some(Self::Cst),
            Interface::Voltage => None,
        }
    }

    /// The interface of the axis that it serves.
    pub fn interface(self) -> Interface {
        match self {
            Self::Pp | Self::Ip | Self::Csp => Interface::Position,
            Self::Pv | Self::Csv => Interface::Velocity,
            Self::Tq | Self::Cst => Interface::Torque,
            Self::Vl => Interface::OpenLoop,
        }
    }

    /// Its number (6060h).
    pub fn number(self) -> i8 {
        match self {
            Self::Pp => 1,
            Self::Vl => 2,
            Self::Pv => 3,
            Self::Tq => 4,
            Self::Ip => 7,
            Self::Csp => 8,
            Self::Csv => 9,
            Self::Cst => 10,
        }
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        Self::NAMES.iter().find(|(_, mode)| *mode == self).map_or("", |(name, _)| name)
    }

    /// The other number of the same mode: that of the axis for that of the drive, and the other way round.
    pub fn across(self, number: i8) -> i8 {
        let (own, cyclic) = (self.number(), self.interface().mode().number());
        match number {
            _ if number == own => cyclic,
            _ if number == cyclic => own,
            other => other,
        }
    }

    /// What it is asked for.
    pub(super) fn target(self) -> Field<Asked> {
        let (word, object, bits) = match self {
            Self::Pp | Self::Csp => (Asked::Position, objects::TARGET_POSITION, 32),
            Self::Ip => (Asked::Position, objects::INTERPOLATION_POSITION, 32),
            Self::Pv | Self::Csv => (Asked::Velocity, objects::TARGET_VELOCITY, 32),
            Self::Tq | Self::Cst => (Asked::Torque, objects::TARGET_TORQUE, 16),
            Self::Vl => (Asked::Velocity, objects::VL_TARGET_VELOCITY, 16),
        };
        Field { word, object, bits }
    }
}

/// What a mode makes of the setpoints of the cycles.
#[derive(Clone, Copy, Debug)]
pub struct Commander {
    mode: DriveMode,
    /// In mode pp: the setpoint that stands, which is given.
    setpoint: i64,
    is_given: bool,
    /// Some setpoint was given since the operation was enabled.
    has_begun: bool,
}

impl Commander {
    /// Before the first cycle.
    pub fn new(mode: DriveMode) -> Self {
        Self { mode, setpoint: 0, is_given: false, has_begun: false }
    }

    /// Its mode.
    pub fn mode(&self) -> DriveMode {
        self.mode
    }

    /// Control word and position for what a cycle asks for; `is_in_mode`: it asks for this mode, and the drive shows it.
    pub fn command(&mut self, asked: u16, position: i64, status: u16, is_in_mode: bool) -> (u16, i64) {
        let is_enabled = is_in_mode && asked == control::ENABLE;
        let runs = is_enabled && DriveState::from_status(status) == DriveState::Enabled;
        match self.mode {
            DriveMode::Csp | DriveMode::Csv | DriveMode::Cst | DriveMode::Pv | DriveMode::Tq => (asked, position),
            DriveMode::Ip => (if runs { asked | BIT_4 } else { asked }, position),
            DriveMode::Vl => (if is_enabled { asked | RAMP } else { asked }, position),
            DriveMode::Pp => {
                self.hand_over(position, status & STATUS_ACKNOWLEDGED != 0, runs);
                let bits = if self.is_given { BIT_4 | AT_ONCE } else { AT_ONCE };
                (if runs { asked | bits } else { asked }, self.setpoint)
            }
        }
    }

    /// A setpoint stands until it is acknowledged; the next one is given once the acknowledgement is withdrawn.
    fn hand_over(&mut self, position: i64, is_acknowledged: bool, runs: bool) {
        if !runs {
            (self.setpoint, self.is_given, self.has_begun) = (position, false, false);
            return;
        }
        match (self.is_given, is_acknowledged) {
            (false, false) if position != self.setpoint || !self.has_begun => {
                (self.setpoint, self.is_given, self.has_begun) = (position, true, true);
            }
            (true, true) => self.is_given = false,
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const ENABLED: u16 = 0x0237;

    /// Numbers of 6060h; the axis sees 8, 9, 10 and 2.
    #[test]
    fn each_mode_has_its_number_and_that_of_the_axis() {
        let numbers = DriveMode::NAMES.map(|(name, mode)| (name, mode.number(), mode.across(mode.number())));
        let expected = [
            ("pp", 1, 8),
            ("vl", 2, 2),
            ("pv", 3, 9),
            ("tq", 4, 10),
            ("ip", 7, 8),
            ("csp", 8, 8),
            ("csv", 9, 9),
            ("cst", 10, 10),
        ];
        assert_eq!(numbers, expected);
        // One that is in csp where pp is meant is not in its mode; homing is the same in all.
        assert_eq!([DriveMode::Pp.across(8), DriveMode::Pp.across(6), DriveMode::Pp.across(0)], [1, 6, 0]);
        for (name, mode) in DriveMode::NAMES {
            assert_eq!(
                (mode.name(), DriveMode::usual(mode.interface()).unwrap().interface()),
                (name, mode.interface())
            );
        }
    }

    #[test]
    fn control_words_have_the_bits_of_their_mode() {
        let word = |mode, asked, status, is_in_mode| Commander::new(mode).command(asked, 5, status, is_in_mode).0;
        for mode in [DriveMode::Csp, DriveMode::Csv, DriveMode::Cst, DriveMode::Pv, DriveMode::Tq] {
            assert_eq!(word(mode, control::ENABLE, ENABLED, true), 0x0F);
        }
        assert_eq!(word(DriveMode::Ip, control::ENABLE, ENABLED, true), 0x1F);
        assert_eq!(word(DriveMode::Ip, control::ENABLE, 0x0233, true), 0x0F, "not yet enabled");
        assert_eq!(word(DriveMode::Vl, control::ENABLE, ENABLED, true), 0x7F);
        for mode in [DriveMode::Ip, DriveMode::Vl, DriveMode::Pp] {
            for other in [control::QUICK_STOP, control::SHUTDOWN, control::DISABLE_VOLTAGE, control::FAULT_RESET] {
                assert_eq!(word(mode, other, ENABLED, true), other);
            }
            let homing = control::ENABLE | control::START_HOMING;
            assert_eq!(word(mode, homing, ENABLED, false), homing);
        }
    }

    /// Bit 4 with the setpoint, until bit 12 acknowledges it; away until the acknowledgement is; then the newest.
    #[test]
    fn setpoints_are_handed_over() {
        let mut pp = Commander::new(DriveMode::Pp);
        let acknowledged = ENABLED | 0x1000;
        assert_eq!(pp.command(control::SWITCH_ON, 10, 0x0233, true), (0x07, 10));
        assert_eq!(pp.command(control::ENABLE, 10, ENABLED, true), (0x3F, 10), "the first one");
        assert_eq!(pp.command(control::ENABLE, 11, ENABLED, true), (0x3F, 10), "not acknowledged");
        assert_eq!(pp.command(control::ENABLE, 12, acknowledged, true), (0x2F, 10));
        assert_eq!(pp.command(control::ENABLE, 13, acknowledged, true), (0x2F, 10), "not withdrawn");
        assert_eq!(pp.command(control::ENABLE, 14, ENABLED, true), (0x3F, 14));
        assert_eq!(pp.command(control::ENABLE, 14, acknowledged, true), (0x2F, 14));
        assert_eq!(pp.command(control::ENABLE, 14, ENABLED, true), (0x2F, 14), "nothing new");
        assert_eq!(pp.command(control::QUICK_STOP, 20, ENABLED, true), (0x02, 20));
    }

    proptest! {
        /// With any drive that acknowledges late, the last setpoint is given in the end, and each but when the drive takes it.
        #[test]
        fn the_last_setpoint_is_given(positions in prop::collection::vec(-9_i64..9, 1..30), late in 0_usize..4) {
            let mut pp = Commander::new(DriveMode::Pp);
            let (mut given, mut words, mut before) = (None, vec![0_u16; late + 1], 0);
            let last = *positions.last().unwrap();
            for position in positions.into_iter().chain([last; 40]) {
                let seen = words[words.len() - 1 - late];
                let status = if seen & 0x10 != 0 { ENABLED | 0x1000 } else { ENABLED };
                let (word, setpoint) = pp.command(control::ENABLE, position, status, true);
                if word & 0x10 != 0 && before & 0x10 == 0 {
                    prop_assert_eq!(status, ENABLED, "while the one before was acknowledged");
                    given = Some(setpoint);
                }
                before = word;
                words.push(word);
            }
            prop_assert_eq!(given, Some(last));
        }
    }
}
