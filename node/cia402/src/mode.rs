//! Modes of operation of a drive, and their mapping to the interfaces of an axis.
//!
//! Law      an axis commands its drive in cyclic modes only (csp, csv, cst, vl). A drive with another mode is commanded through that mode,
//!          while the axis commands and sees the number of the cyclic one
//! Reads    control words and setpoints of a cycle, the status word
//! Writes   the control word with the bits of the mode
//! Source   CiA 402-2 (modes pp, vl, pv, tq, ip, csp, csv, cst)

use crate::mapping::{CommandedValue, Field};
use crate::objects;
use lineshaft_core::drive::{DriveState, Interface, control, level_cycles};

/// Status word bit 12 in mode pp: the setpoint is acknowledged.
const STATUS_ACKNOWLEDGED: u16 = 0x1000;
/// Control word bit 4: new setpoint (pp), enable interpolation (ip).
const BIT_4: u16 = 0x10;
/// Control word bit 5 in mode pp: change set immediately, a new setpoint replaces the previous one at once.
const AT_ONCE: u16 = 0x20;
/// Control word bits 4 to 6 in mode vl: the ramp runs and follows its input.
const RAMP: u16 = 0x70;

/// Mode of operation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DriveMode {
    /// Profile position: the drive moves to each setpoint with its own profile.
    Pp,
    /// Velocity mode of frequency converters.
    Vl,
    /// Profile velocity: the drive uses its own ramps.
    Pv,
    /// Profile torque: the drive uses its own slope.
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
    /// All modes with their names.
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

    /// Returns the default mode of an interface; `None` if no mode serves the interface.
    pub fn default_of(interface: Interface) -> Option<Self> {
        match interface {
            Interface::Position => Some(Self::Csp),
            Interface::Velocity => Some(Self::Csv),
            Interface::OpenLoop => Some(Self::Vl),
            Interface::Torque => Some(Self::Cst),
            Interface::Voltage => None,
        }
    }

    /// Returns the interface of the axis for which the mode is used.
    pub fn interface(self) -> Interface {
        match self {
            Self::Pp | Self::Ip | Self::Csp => Interface::Position,
            Self::Pv | Self::Csv => Interface::Velocity,
            Self::Tq | Self::Cst => Interface::Torque,
            Self::Vl => Interface::OpenLoop,
        }
    }

    /// Returns the mode number (6060h).
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

    /// Returns the name.
    pub fn name(self) -> &'static str {
        Self::NAMES.iter().find(|(_, mode)| *mode == self).map_or("", |(name, _)| name)
    }

    /// Converts between the mode number of the drive and that of the axis, in both directions.
    pub fn convert_number(self, number: i8) -> i8 {
        let (own, cyclic) = (self.number(), self.interface().mode().number());
        match number {
            _ if number == own => cyclic,
            _ if number == cyclic => own,
            other => other,
        }
    }

    /// Returns the target field of the process data.
    pub(super) fn target(self) -> Field<CommandedValue> {
        let (word, object, bits) = match self {
            Self::Pp | Self::Csp => (CommandedValue::Position, objects::TARGET_POSITION, 32),
            Self::Ip => (CommandedValue::Position, objects::INTERPOLATION_POSITION, 32),
            Self::Pv | Self::Csv => (CommandedValue::Velocity, objects::TARGET_VELOCITY, 32),
            Self::Tq | Self::Cst => (CommandedValue::Torque, objects::TARGET_TORQUE, 16),
            Self::Vl => (CommandedValue::Velocity, objects::VL_TARGET_VELOCITY, 16),
        };
        Field { word, object, bits }
    }
}

/// Converts the setpoints of the cycles to the commands of a mode.
#[derive(Clone, Copy, Debug)]
pub struct Commander {
    mode: DriveMode,
    handshake: Handshake,
}

impl Commander {
    /// Creates the state before the first cycle.
    pub fn new(mode: DriveMode, cycle_ns: u64) -> Self {
        Self { mode, handshake: Handshake::new(cycle_ns) }
    }

    /// Returns the mode.
    pub fn mode(&self) -> DriveMode {
        self.mode
    }

    /// Returns true if the drive has not acknowledged a setpoint in time; until the operation is enabled again.
    pub fn is_unacknowledged(&self) -> bool {
        self.handshake.is_late()
    }

    /// Returns control word and position for the commands of a cycle. `is_in_mode`: this mode is commanded, and the drive reports it.
    pub fn command(&mut self, asked: u16, position: i64, status: u16, is_in_mode: bool) -> (u16, i64) {
        let is_enabled = is_in_mode && asked == control::ENABLE;
        let runs = is_enabled && DriveState::from_status(status) == DriveState::Enabled;
        match self.mode {
            DriveMode::Csp | DriveMode::Csv | DriveMode::Cst | DriveMode::Pv | DriveMode::Tq => (asked, position),
            DriveMode::Ip => (if runs { asked | BIT_4 } else { asked }, position),
            DriveMode::Vl => (if is_enabled { asked | RAMP } else { asked }, position),
            DriveMode::Pp => {
                self.handshake.advance(position, status & STATUS_ACKNOWLEDGED != 0, runs);
                let bits = if self.handshake.is_given { BIT_4 | AT_ONCE } else { AT_ONCE };
                (if runs { asked | bits } else { asked }, self.handshake.setpoint)
            }
        }
    }
}

/// Minimum time for the acknowledgement of a setpoint, in ns, and minimum number of cycles.
const ACKNOWLEDGE_NS: u64 = 500_000_000;
const ACKNOWLEDGE_CYCLES: u64 = 25;

fn cycles_of(ns: u64, cycle_ns: u64, least: u64) -> u32 {
    u32::try_from(ns.div_ceil(cycle_ns.max(1)).max(least)).unwrap_or(u32::MAX)
}

/// Handshake of mode pp: bit 4 transfers a setpoint, bit 12 acknowledges it.
///
/// A setpoint is transferred once bit 12 is 0, and stays until bit 12 rises. If bit 12 is still 1 from before, it acknowledges nothing. Bit
/// 4 then rises after 50 ms with the newest setpoint, and toggles every 50 ms until bit 12 has been 0.
#[derive(Clone, Copy, Debug)]
struct Handshake {
    /// Cycles for which bit 4 keeps its level.
    level_cycles: u32,
    /// Cycles within which a setpoint must be acknowledged.
    most_cycles: u32,
    /// Last transferred setpoint.
    setpoint: i64,
    /// Whether bit 4 is set.
    is_given: bool,
    /// Whether the setpoint was transferred after the operation was enabled.
    has_begun: bool,
    /// Whether bit 12 was already 1 before bit 4 was set.
    is_old: bool,
    /// Cycles for which bit 4 has had its level while bit 12 was 1 from before.
    level: u32,
    /// Cycles for which the present setpoint has waited for its acknowledgement.
    waits: u32,
}

impl Handshake {
    fn new(cycle_ns: u64) -> Self {
        Self {
            level_cycles: u32::try_from(level_cycles(cycle_ns)).unwrap_or(u32::MAX),
            most_cycles: cycles_of(ACKNOWLEDGE_NS, cycle_ns, ACKNOWLEDGE_CYCLES),
            setpoint: 0,
            is_given: false,
            has_begun: false,
            is_old: false,
            level: 0,
            waits: 0,
        }
    }

    fn is_late(&self) -> bool {
        self.waits > self.most_cycles
    }

    /// Advances by one cycle with the newest setpoint and bit 12. `runs`: operation is enabled in this mode.
    fn advance(&mut self, position: i64, is_acknowledged: bool, runs: bool) {
        if !runs {
            (self.setpoint, self.is_given, self.has_begun) = (position, false, false);
            (self.is_old, self.level, self.waits) = (false, 0, 0);
            return;
        }
        if self.is_old && !is_acknowledged {
            // From here on the wait for the acknowledgement of the setpoint counts.
            (self.is_old, self.waits) = (false, 0);
        }
        let is_wanted = position != self.setpoint || !self.has_begun;
        match (self.is_given, is_acknowledged) {
            (true, true) if !self.is_old => (self.is_given, self.level, self.waits) = (false, 0, 0),
            (true, _) => {
                self.waits = self.waits.saturating_add(1);
                self.level = if self.is_old { self.level.saturating_add(1) } else { 0 };
                if self.level >= self.level_cycles {
                    // It is unknown whether the drive has accepted the setpoint, so it is transferred again.
                    (self.is_given, self.has_begun, self.level) = (false, false, 0);
                }
            }
            (false, true) if is_wanted => {
                self.waits = self.waits.saturating_add(1);
                self.level = self.level.saturating_add(1);
                if self.level >= self.level_cycles {
                    self.transfer(position, true);
                }
            }
            (false, false) if is_wanted => {
                self.waits = 0;
                self.transfer(position, false);
            }
            (false, _) => (self.level, self.waits) = (0, 0),
        }
    }

    fn transfer(&mut self, position: i64, is_old: bool) {
        (self.setpoint, self.is_given, self.has_begun) = (position, true, true);
        (self.is_old, self.level) = (is_old, 0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const ENABLED: u16 = 0x0237;
    const ACKNOWLEDGED: u16 = ENABLED | 0x1000;
    const CYCLE_NS: u64 = 1_000_000;

    /// Numbers of 6060h; the axis uses 8, 9, 10 and 2.
    #[test]
    fn each_mode_has_its_number_and_that_of_the_axis() {
        let numbers = DriveMode::NAMES.map(|(name, mode)| (name, mode.number(), mode.convert_number(mode.number())));
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
        // A drive in csp instead of pp is not in its mode; homing has the same number in all.
        assert_eq!(
            [DriveMode::Pp.convert_number(8), DriveMode::Pp.convert_number(6), DriveMode::Pp.convert_number(0)],
            [1, 6, 0]
        );
        for (name, mode) in DriveMode::NAMES {
            assert_eq!(
                (mode.name(), DriveMode::default_of(mode.interface()).unwrap().interface()),
                (name, mode.interface())
            );
        }
    }

    #[test]
    fn control_words_have_the_bits_of_their_mode() {
        let word =
            |mode, asked, status, is_in_mode| Commander::new(mode, CYCLE_NS).command(asked, 5, status, is_in_mode).0;
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

    /// Bit 4 is set with the setpoint until bit 12 acknowledges it. It is reset until the acknowledgement is reset. Then the newest
    /// setpoint follows.
    #[test]
    fn setpoint_handshake_transfers_setpoints() {
        let mut pp = Commander::new(DriveMode::Pp, CYCLE_NS);
        assert_eq!(pp.command(control::SWITCH_ON, 10, 0x0233, true), (0x07, 10));
        assert_eq!(pp.command(control::ENABLE, 10, ENABLED, true), (0x3F, 10), "the first one");
        assert_eq!(pp.command(control::ENABLE, 11, ENABLED, true), (0x3F, 10), "not acknowledged");
        assert_eq!(pp.command(control::ENABLE, 12, ACKNOWLEDGED, true), (0x2F, 10));
        assert_eq!(pp.command(control::ENABLE, 13, ACKNOWLEDGED, true), (0x2F, 10), "not withdrawn");
        assert_eq!(pp.command(control::ENABLE, 14, ENABLED, true), (0x3F, 14));
        assert_eq!(pp.command(control::ENABLE, 14, ACKNOWLEDGED, true), (0x2F, 14));
        assert_eq!(pp.command(control::ENABLE, 14, ENABLED, true), (0x2F, 14), "nothing new");
        assert_eq!(pp.command(control::QUICK_STOP, 20, ENABLED, true), (0x02, 20));
    }

    /// Returns for each cycle with setpoint 7 bit 4, and whether the setpoint is late after the cycle. `drive` returns bit 12 from bit 4 of
    /// the previous cycle and from the cycle number.
    fn handed_over(cycles: usize, mut drive: impl FnMut(bool, usize) -> bool) -> Vec<(bool, bool)> {
        let mut pp = Commander::new(DriveMode::Pp, CYCLE_NS);
        pp.command(control::SWITCH_ON, 7, 0x0233, true);
        let (mut given, mut all) = (false, Vec::new());
        for cycle in 0..cycles {
            let status = if drive(given, cycle) { ACKNOWLEDGED } else { ENABLED };
            let (word, setpoint) = pp.command(control::ENABLE, 7, status, true);
            given = word & BIT_4 != 0;
            assert_eq!((word & !BIT_4, setpoint), (0x2F, 7));
            all.push((given, pp.is_unacknowledged()));
        }
        all
    }

    /// Bit 12 is 1 when the operation is enabled, and is reset at the next falling edge of bit 4. Bit 4 rises after 50 ms and falls after
    /// another 50 ms; then the normal handshake follows.
    #[test]
    fn first_setpoint_is_transferred_with_stale_acknowledge_bit() {
        let (mut bit_12, mut before) = (true, false);
        let all = handed_over(110, |bit_4, _| {
            bit_12 = match (before, bit_4) {
                (false, true) => true,
                (true, false) => false,
                _ => bit_12,
            };
            before = bit_4;
            bit_12
        });
        let given: Vec<_> = (0..).zip(&all).filter(|(_, (given, _))| *given).map(|(cycle, _)| cycle).collect();
        // Bit 4 is set in cycles 49 to 98; bit 12 falls in cycle 100 and is 1 in cycle 101.
        assert_eq!(given, (49..99).chain([100]).collect::<Vec<_>>());
        assert!(all.iter().all(|(_, late)| !late));
    }

    /// A drive that resets its old acknowledgement within 50 ms sees only one edge, with bit 12 at 0.
    #[test]
    fn handshake_waits_for_stale_acknowledge_to_reset() {
        let all = handed_over(40, |bit_4, cycle| cycle < 30 || bit_4);
        let given: Vec<_> = (0..).zip(&all).filter(|(_, (given, _))| *given).map(|(cycle, _)| cycle).collect();
        assert_eq!(given, [30], "it is acknowledged in cycle 31");
    }

    /// 500 cycles of 1 ms, for bit 12 always 0 and always 1.
    #[test]
    fn setpoint_that_is_not_acknowledged_is_late_after_500_ms() {
        let first_late = |all: Vec<(bool, bool)>| all.iter().position(|(_, late)| *late);
        // Transferred in cycle 0, followed by 500 cycles without an acknowledgement.
        assert_eq!(first_late(handed_over(600, |_, _| false)), Some(501));
        assert_eq!(first_late(handed_over(600, |_, _| true)), Some(500));
        // A setpoint that was acknowledged in time is not late, nor is a drive without a new setpoint.
        assert_eq!(first_late(handed_over(2_000, |_, cycle| cycle > 499)), None);
        // Bit 12 falls after 300 cycles; the setpoint that is transferred then is acknowledged 250 cycles later.
        assert_eq!(first_late(handed_over(900, |_, cycle| !(300..550).contains(&cycle))), None);
        let mut pp = Commander::new(DriveMode::Pp, CYCLE_NS);
        for _ in 0..600 {
            pp.command(control::ENABLE, 7, ENABLED, true);
        }
        assert!(pp.is_unacknowledged());
        pp.command(control::DISABLE_VOLTAGE, 7, ENABLED, true);
        assert!(!pp.is_unacknowledged(), "it is commanded no longer");
    }

    /// At least 5 and 25 cycles: 100 ms and 500 ms with cycles of 20 ms, 500 ms and 2.5 s with cycles of 100 ms.
    #[test]
    fn slow_cycles_have_minimum_cycle_counts() {
        for (cycle_ns, cycles) in [(125_000, (400, 4_000)), (20_000_000, (5, 25)), (100_000_000, (5, 25))] {
            let handshake = Handshake::new(cycle_ns);
            assert_eq!((handshake.level_cycles, handshake.most_cycles), cycles);
        }
    }

    proptest! {
        /// With any delay of the acknowledgement, the last setpoint is transferred in the end. Each setpoint is transferred only while bit
        /// 12 is 0.
        #[test]
        fn last_setpoint_is_transferred(positions in prop::collection::vec(-9_i64..9, 1..30), late in 0_usize..4) {
            let mut pp = Commander::new(DriveMode::Pp, CYCLE_NS);
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
