//! What a bus is made of, as a cell says it.

use crate::acts::LeftOut;
use crate::drive::layout::Extras;
use crate::drive::probe::Probes;
use crate::drive::{DriveMode, DriveType, Layout};
use crate::sdo::Object;
use crate::transport::Address;
use crate::{NodeId, Watching};
use lineshaft_core::axis::MISSED_CYCLES;
use lineshaft_core::drive::{Capabilities, Terminal};
use lineshaft_core::sync::gear::gcd;
use std::fmt;

/// Heartbeats that may be missed until who sends them is lost.
pub const HEARTBEATS_MISSED: u64 = 3;

/// A bus.
#[derive(Clone, Debug)]
pub struct BusConfig {
    /// Its name in the cell.
    pub name: String,
    /// The way to it.
    pub transport: Address,
    /// (bit/s); none where the way has none, or sets it by itself.
    pub bit_rate: Option<u32>,
    /// From one SYNC to the next (ns).
    pub cycle_ns: u64,
    /// SYNC counts from 1 to this, 2 to 240; none: SYNC has no counter.
    pub sync_overflow: Option<u8>,
    /// How long an SDO server may take for an answer (ns).
    pub sdo_timeout_ns: u64,
    /// From one TIME to the next (ns); none: there is none.
    pub time_ns: Option<u64>,
    /// The heartbeat of the master; none: the drives do not watch it.
    pub master: Option<Master>,
    /// Its devices.
    pub devices: Vec<DeviceConfig>,
}

/// How the master shows that it is there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Master {
    /// Its own node id.
    pub node: NodeId,
    /// From one heartbeat to the next (ns).
    pub heartbeat_ns: u64,
}

impl BusConfig {
    /// The value and the power of ten that say the cycle in seconds (60C2h); none where 8 bits do not say it.
    pub fn interpolation(&self) -> Option<(u8, i8)> {
        let (mut value, mut index) = (self.cycle_ns, -9_i8);
        while value != 0 && value.is_multiple_of(10) {
            (value, index) = (value / 10, index + 1);
        }
        // A power that drives know: 10^-3 rather than 10^-2.
        while index > -3 && value <= u64::from(u8::MAX) / 10 {
            (value, index) = (value * 10, index - 1);
        }
        u8::try_from(value).ok().filter(|value| *value > 0).map(|value| (value, index))
    }
}

/// A device: a drive, a module of inputs and outputs, or an encoder.
#[derive(Clone, Debug)]
pub struct DeviceConfig {
    /// Its node.
    pub node: NodeId,
    /// How it is watched.
    pub watching: Watching,
    /// What its PDOs carry.
    pub layout: Layout,
    /// What it must be.
    pub identity: Identity,
    /// What it is told before it starts, in this order.
    pub startup: Vec<Write>,
    /// Values of its file that it is not told, as they act or are setpoints.
    pub left_out: LeftOut,
    /// Inputs, outputs and encoders of the machine that are there.
    pub terminals: Terminals,
    /// What it is.
    pub role: Role,
}

impl DeviceConfig {
    /// A drive in csp of which nothing more is said, as benches and tests have it.
    pub fn plain_drive(place: usize, node: NodeId, watching: Watching) -> Self {
        let terminals = Terminals::default();
        let drive = DriveConfig {
            place,
            axis: format!("x{place}"),
            object: 0,
            probes: [None; 2],
            mode: DriveMode::Csp,
            drive_type: None,
            offers: Capabilities { delay: 1, position: true, homes: true, ..Capabilities::default() },
            per_revolution: None,
            velocity: VelocityFactor::default(),
            missed: Missed::default(),
            rated_effort: None,
        };
        Self {
            node,
            watching,
            layout: Layout::plan(node, drive.mode, Extras::default(), &terminals, None)
                .expect("without a dictionary nothing is missing"),
            identity: Identity::default(),
            startup: Vec::new(),
            left_out: LeftOut::default(),
            terminals,
            role: Role::Drive(drive),
        }
    }

    /// What it is as a drive, where it is one.
    pub fn drive(&self) -> Option<&DriveConfig> {
        match &self.role {
            Role::Drive(drive) => Some(drive),
            Role::Module | Role::Encoder => None,
        }
    }
}

/// Node and axis, or what else it is.
impl fmt::Display for DeviceConfig {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.drive() {
            Some(drive) => write!(to, "{} ({})", self.node, drive.axis),
            None => write!(to, "{} ({})", self.node, self.role.profile().1),
        }
    }
}

/// What a device is, by its profile.
#[derive(Clone, Debug)]
pub enum Role {
    /// A drive (CiA 402).
    Drive(DriveConfig),
    /// A module of inputs and outputs (CiA 401).
    Module,
    /// An encoder (CiA 406).
    Encoder,
}

impl Role {
    /// Number and name of its profile.
    pub fn profile(&self) -> (u32, &'static str) {
        match self {
            Self::Drive(_) => (402, "drive"),
            Self::Module => (401, "module"),
            Self::Encoder => (406, "encoder"),
        }
    }
}

/// What of a machine is at the terminals of a device.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Terminals {
    /// Digital inputs; addresses are bits, of 6000h:01 on, of 60FDh of a drive.
    pub digital_inputs: Vec<Terminal>,
    /// Digital outputs; addresses are bits, of 6200h:01 on, of 60FEh:01 of a drive.
    pub digital_outputs: Vec<Terminal>,
    /// Analog inputs (6401h).
    pub analog_inputs: Vec<Analog>,
    /// Analog outputs (6411h).
    pub analog_outputs: Vec<Analog>,
    /// Encoders of the machine that it is.
    pub encoders: Vec<Encoder>,
}

/// An analog terminal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Analog {
    /// Its place in the machine, and its channel from 0.
    pub terminal: Terminal,
    /// What 7FFFh is (V).
    pub full_scale: f64,
}

/// An encoder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Encoder {
    /// Its place in the machine.
    pub place: usize,
    /// Its words still hold behind a power cycle.
    pub is_absolute: bool,
}

/// What a device is as a drive.
#[derive(Clone, Debug)]
pub struct DriveConfig {
    /// Its place among the drives of the machine.
    pub place: usize,
    /// The axis that it drives.
    pub axis: String,
    /// The number of that axis.
    pub object: u16,
    /// What its touch probes catch.
    pub probes: Probes,
    /// How it is commanded.
    pub mode: DriveMode,
    /// Its number in MACS, where the cell has chosen it by that.
    pub drive_type: Option<DriveType>,
    /// What it offers, by the cell.
    pub offers: Capabilities,
    /// Counts per revolution of its shaft by the cell, as a fraction; none: nobody knows.
    pub per_revolution: Option<(u64, u64)>,
    /// How fast it says it is.
    pub velocity: VelocityFactor,
    /// What is shown of it while its words are missing.
    pub missed: Missed,
    /// Effort of the axis at the rated torque of the drive (6076h), where the cell says it (N or Nm).
    pub rated_effort: Option<f64>,
}

/// What is shown of a drive whose words are missing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Missed {
    /// Cycles that are waited for.
    pub cycles: u32,
    /// Its position goes on at its last velocity meanwhile; else it stays.
    pub extrapolates: bool,
}

impl Default for Missed {
    fn default() -> Self {
        Self { cycles: MISSED_CYCLES, extrapolates: false }
    }
}

/// What a device must be (1018h); what is none is not looked at.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Identity {
    /// Vendor.
    pub vendor: Option<u32>,
    /// Product code.
    pub product: Option<u32>,
    /// Revision number.
    pub revision: Option<u32>,
    /// Serial number.
    pub serial: Option<u32>,
}

/// Units of velocity of a drive: `numerator / denominator` of them are one count per second (6096h, the other way round).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VelocityFactor {
    /// Drive's units.
    pub numerator: u32,
    /// Counts per second.
    pub denominator: u32,
}

impl Default for VelocityFactor {
    fn default() -> Self {
        Self { numerator: 1, denominator: 1 }
    }
}

impl VelocityFactor {
    /// 1/1000 rpm of a shaft with so many counts in so many revolutions (MACS-CAN-12); none where 32 bits do not say it.
    pub fn mrpm(counts: u64, turns: u64) -> Option<Self> {
        let (numerator, denominator) = (turns.checked_mul(60_000)?, counts);
        let divisor = gcd(numerator, denominator);
        let part = |of: u64| u32::try_from(of.checked_div(divisor)?).ok().filter(|part| *part != 0);
        Some(Self { numerator: part(numerator)?, denominator: part(denominator)? })
    }

    /// From counts/s to the drive's units; saturates.
    pub fn to_drive(self, counts_per_s: f64) -> i64 {
        (counts_per_s * f64::from(self.numerator) / f64::from(self.denominator)).round() as i64
    }
}

/// A value for an object.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Write {
    /// Which one.
    pub object: Object,
    /// Its bytes.
    pub data: Vec<u8>,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn interpolation(cycle_ns: u64) -> Option<(u8, i8)> {
        let transport = "slcan-tcp:127.0.0.1:1".parse().expect("it is one");
        let (name, sdo_timeout_ns) = (String::new(), 1);
        let bus = BusConfig {
            name,
            transport,
            bit_rate: None,
            cycle_ns,
            sync_overflow: None,
            sdo_timeout_ns,
            time_ns: None,
            master: None,
            devices: vec![],
        };
        bus.interpolation()
    }

    #[test]
    fn the_cycle_is_said_in_8_bits() {
        let us = 1_000;
        assert_eq!(interpolation(1_000 * us), Some((1, -3)));
        assert_eq!(interpolation(4_000 * us), Some((4, -3)));
        assert_eq!(interpolation(20_000 * us), Some((20, -3)));
        assert_eq!(interpolation(125 * us), Some((125, -6)));
        assert_eq!(interpolation(2_500 * us), Some((25, -4)));
        assert_eq!(interpolation(1_001 * us), None);
    }

    #[test]
    fn velocities_are_converted_and_saturate() {
        // Revolutions per minute of a motor with 10,000 counts per revolution.
        let factor = VelocityFactor { numerator: 60, denominator: 10_000 };
        assert_eq!(factor.to_drive(-25_000.0), -150);
        assert_eq!(factor.to_drive(f64::INFINITY), i64::MAX);
    }

    /// 3000 rpm of a motor with 4096 counts are 204,800 counts/s, and 3,000,000 of 1/1000 rpm.
    ///
    /// Proves: MACS-O-57
    #[test]
    fn velocities_of_an_akd_are_thousandths_of_rpm() {
        let factor = VelocityFactor::mrpm(4096, 1).unwrap();
        assert_eq!(factor, VelocityFactor { numerator: 1875, denominator: 128 });
        assert_eq!([factor.to_drive(204_800.0), factor.to_drive(-102_400.0)], [3_000_000, -1_500_000]);
        assert_eq!(VelocityFactor::mrpm(20_000, 3), Some(VelocityFactor { numerator: 9, denominator: 1 }));
        assert_eq!([VelocityFactor::mrpm(0, 1), VelocityFactor::mrpm(1, u64::MAX)], [None, None]);
        assert_eq!(VelocityFactor::mrpm((1 << 40) + 1, 1), None, "two numbers of 32 bits do not say it");
    }
}
