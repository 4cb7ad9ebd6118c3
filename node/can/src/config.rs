//! Configuration of a bus and its devices.

use crate::acts::LeftOut;
use crate::layout::Layout;
use crate::transport::Address;
use crate::{Monitoring, NodeId};
use lineshaft_cia402::config::{DriveConfig, Identity, Terminals, Write};
use lineshaft_cia402::mapping::Extras;
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
        let drive = DriveConfig::plain(place);
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
