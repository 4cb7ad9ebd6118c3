//! Configuration of a bus and its devices.

use crate::acts::LeftOut;
use crate::drive::layout::Extras;
use crate::drive::probe::Probes;
use crate::drive::{DriveMode, DriveType, Layout};
use crate::sdo::Object;
use crate::transport::Address;
use crate::{Monitoring, NodeId};
use lineshaft_core::axis::MISSED_CYCLES;
use lineshaft_core::drive::{Capabilities, Terminal};
use lineshaft_core::sync::gear::gcd;
use std::fmt;

/// Number of heartbeat times without a heartbeat after which its producer counts as lost.
pub const HEARTBEATS_MISSED: u64 = 3;

/// Configuration of a bus.
#[derive(Clone, Debug)]
pub struct BusConfig {
    /// Name in the cell.
    pub name: String,
    /// Address of the transport.
    pub transport: Address,
    /// Bit rate, in bit/s; `None` if the transport has none, or sets it by itself.
    pub bit_rate: Option<u32>,
    /// Baud rate of the serial line of an adapter, in bit/s; `None`: 115200, or the transport has no serial line.
    pub serial_baudrate: Option<u32>,
    /// SYNC period, in ns.
    pub cycle_ns: u64,
    /// SYNC counter overflow, 2 to 240: SYNC counts from 1 to this value; `None`: SYNC has no counter.
    pub sync_overflow: Option<u8>,
    /// SDO timeout, in ns.
    pub sdo_timeout_ns: u64,
    /// Period of the TIME message, in ns; `None`: TIME is not sent.
    pub time_ns: Option<u64>,
    /// Heartbeat of the master; `None`: the drives do not monitor the master.
    pub master: Option<Master>,
    /// Devices on the bus.
    pub devices: Vec<DeviceConfig>,
}

/// Heartbeat producer of the master.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Master {
    /// Node ID of the master.
    pub node: NodeId,
    /// Heartbeat time, in ns.
    pub heartbeat_ns: u64,
}

impl BusConfig {
    /// Returns the interpolation time period (60C2h): value and power of ten, in seconds; `None` if 8 bits cannot represent the cycle.
    pub fn interpolation(&self) -> Option<(u8, i8)> {
        let (mut value, mut index) = (self.cycle_ns, -9_i8);
        while value != 0 && value.is_multiple_of(10) {
            (value, index) = (value / 10, index + 1);
        }
        // Drives support 10^-3 rather than 10^-2.
        while index > -3 && value <= u64::from(u8::MAX) / 10 {
            (value, index) = (value * 10, index - 1);
        }
        u8::try_from(value).ok().filter(|value| *value > 0).map(|value| (value, index))
    }
}

/// Configuration of a device: drive, I/O module or encoder.
#[derive(Clone, Debug)]
pub struct DeviceConfig {
    /// Node ID.
    pub node: NodeId,
    /// Monitoring of the device.
    pub watching: Monitoring,
    /// PDO layout.
    pub layout: Layout,
    /// Required identity.
    pub identity: Identity,
    /// Objects that are written before the device starts, in this order.
    pub startup: Vec<Write>,
    /// Values of the device file that are not written, as they act or are setpoints.
    pub left_out: LeftOut,
    /// Inputs, outputs and encoders of the machine at this device.
    pub terminals: Terminals,
    /// Role of the device.
    pub role: Role,
}

impl DeviceConfig {
    /// Returns a drive in csp with default settings, for benchmarks and tests.
    pub fn plain_drive(place: usize, node: NodeId, watching: Monitoring) -> Self {
        let terminals = Terminals::default();
        let drive = DriveConfig {
            place,
            axis: format!("x{place}"),
            object: 0,
            probes: [None; 2],
            mode: DriveMode::Csp,
            drive_type: None,
            offers: Capabilities { delay: 1, position: true, homes: true, ..Capabilities::default() },
            counts_per_shaft_revolution: None,
            velocity: VelocityFactor::default(),
            missed: MissingDataBehaviour::default(),
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

    /// Returns the drive configuration if the device is a drive.
    pub fn drive(&self) -> Option<&DriveConfig> {
        match &self.role {
            Role::Drive(drive) => Some(drive),
            Role::Module | Role::Encoder => None,
        }
    }
}

/// Writes the node, and the axis or the kind of device.
impl fmt::Display for DeviceConfig {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.drive() {
            Some(drive) => write!(to, "{} ({})", self.node, drive.axis),
            None => write!(to, "{} ({})", self.node, self.role.profile().1),
        }
    }
}

/// Role of a device, according to its profile.
#[derive(Clone, Debug)]
pub enum Role {
    /// A drive (CiA 402).
    Drive(DriveConfig),
    /// I/O module (CiA 401).
    Module,
    /// An encoder (CiA 406).
    Encoder,
}

impl Role {
    /// Returns number and name of the profile.
    pub fn profile(&self) -> (u32, &'static str) {
        match self {
            Self::Drive(_) => (402, "drive"),
            Self::Module => (401, "module"),
            Self::Encoder => (406, "encoder"),
        }
    }
}

/// Inputs, outputs and encoders of the machine at a device.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Terminals {
    /// Digital inputs. Addresses are bit numbers, counted from 6000h:01, or from bit 0 of 60FDh of a drive.
    pub digital_inputs: Vec<Terminal>,
    /// Digital outputs. Addresses are bit numbers, counted from 6200h:01, or from bit 0 of 60FEh:01 of a drive.
    pub digital_outputs: Vec<Terminal>,
    /// Analog inputs (6401h).
    pub analog_inputs: Vec<AnalogTerminal>,
    /// Analog outputs (6411h).
    pub analog_outputs: Vec<AnalogTerminal>,
    /// Encoders of the machine that this device implements.
    pub encoders: Vec<Encoder>,
}

/// An analog terminal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AnalogTerminal {
    /// Place in the machine, and channel from 0.
    pub terminal: Terminal,
    /// Voltage at 7FFFh, in V.
    pub volts_at_full_scale: f64,
}

/// An encoder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Encoder {
    /// Place among the encoders of the machine.
    pub place: usize,
    /// Whether the position remains valid after a power cycle.
    pub is_absolute: bool,
}

/// Configuration of a drive.
#[derive(Clone, Debug)]
pub struct DriveConfig {
    /// Place among the drives of the machine.
    pub place: usize,
    /// Name of the axis.
    pub axis: String,
    /// Object number of the axis.
    pub object: u16,
    /// Edges that the touch probes capture.
    pub probes: Probes,
    /// Mode of operation.
    pub mode: DriveMode,
    /// DRIVETYPE of MACS, if the cell selects the drive by it.
    pub drive_type: Option<DriveType>,
    /// Capabilities of the drive according to the cell.
    pub offers: Capabilities,
    /// Counts per shaft revolution according to the cell, as a fraction; `None`: unknown.
    pub counts_per_shaft_revolution: Option<(u64, u64)>,
    /// Velocity unit of the drive.
    pub velocity: VelocityFactor,
    /// Behaviour while process data of the drive is missing.
    pub missed: MissingDataBehaviour,
    /// Effort of the axis at the rated torque of the drive (6076h), in N or Nm; `None` if the cell does not give it.
    pub rated_effort: Option<f64>,
}

/// Behaviour while process data of a drive is missing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MissingDataBehaviour {
    /// Number of cycles without process data that are tolerated.
    pub cycles: u32,
    /// Whether the position is extrapolated with the last velocity meanwhile; otherwise it stays.
    pub extrapolates: bool,
}

impl Default for MissingDataBehaviour {
    fn default() -> Self {
        Self { cycles: MISSED_CYCLES, extrapolates: false }
    }
}

/// Required identity of a device (1018h); `None` is not checked.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Identity {
    /// Vendor ID.
    pub vendor: Option<u32>,
    /// Product code.
    pub product: Option<u32>,
    /// Revision number.
    pub revision: Option<u32>,
    /// Serial number.
    pub serial: Option<u32>,
}

/// Velocity unit of a drive: `numerator / denominator` units are one count per second (the inverse of 6096h).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VelocityFactor {
    /// Velocity units of the drive.
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
    /// Returns the factor for 1/1000 rpm of a shaft with `counts` counts in `turns` revolutions (MACS-CAN-12); `None` if it does not fit 32
    /// bits.
    pub fn for_millirpm(counts: u64, turns: u64) -> Option<Self> {
        let (numerator, denominator) = (turns.checked_mul(60_000)?, counts);
        let divisor = gcd(numerator, denominator);
        let part = |of: u64| u32::try_from(of.checked_div(divisor)?).ok().filter(|part| *part != 0);
        Some(Self { numerator: part(numerator)?, denominator: part(denominator)? })
    }

    /// Converts counts/s to the velocity unit of the drive; saturates.
    pub fn to_drive(self, counts_per_s: f64) -> i64 {
        (counts_per_s * f64::from(self.numerator) / f64::from(self.denominator)).round() as i64
    }
}

/// Write of an object.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Write {
    /// Object.
    pub object: Object,
    /// Bytes of the value.
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
            serial_baudrate: None,
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
    fn interpolation_time_period_fits_8_bits() {
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

    /// 3000 rpm of a motor with 4096 counts per revolution are 204,800 counts/s, which is 3,000,000 in units of 1/1000 rpm.
    ///
    /// Proves: MACS-O-57
    #[test]
    fn akd_velocity_unit_is_thousandth_rpm() {
        let factor = VelocityFactor::for_millirpm(4096, 1).unwrap();
        assert_eq!(factor, VelocityFactor { numerator: 1875, denominator: 128 });
        assert_eq!([factor.to_drive(204_800.0), factor.to_drive(-102_400.0)], [3_000_000, -1_500_000]);
        assert_eq!(VelocityFactor::for_millirpm(20_000, 3), Some(VelocityFactor { numerator: 9, denominator: 1 }));
        assert_eq!([VelocityFactor::for_millirpm(0, 1), VelocityFactor::for_millirpm(1, u64::MAX)], [None, None]);
        assert_eq!(VelocityFactor::for_millirpm((1 << 40) + 1, 1), None, "two numbers of 32 bits do not say it");
    }
}
