//! Reads identity and state of a device.
//!
//! Law      an object that the device lacks or refuses is `None`; a missing answer is an error
//! Reads    1000h to 1018h; of a drive also its modes, state, position and factors
//! Source   CiA 301, CiA 402-2

use super::session::{CommissionError, Session};
use crate::can_objects;
use crate::{NmtState, NodeId};
use lineshaft_cia402::object::Object;
use lineshaft_cia402::objects;
use lineshaft_cia402::texts::{number, text};
use std::time::Duration;

/// Profile number of drives, in the lower half of the device type.
const PROFILE: u32 = 402;
/// Longest heartbeat time that is waited for.
const PATIENCE: Duration = Duration::from_secs(3);
/// Number of entries of the error history that are read.
const HISTORY: u32 = 8;

/// Factors of a drive: index, first and last subindex, name.
const FACTORS: [(u16, u8, u8, &str); 6] = [
    (0x608F, 1, 2, "position encoder resolution"),
    (0x6091, 1, 2, "gear ratio"),
    (0x6092, 1, 2, "feed constant"),
    (0x6096, 1, 2, "velocity factor"),
    (0x60A8, 0, 0, "SI unit position"),
    (0x60A9, 0, 0, "SI unit velocity"),
];

/// Identity of a device.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Device {
    /// Device type (1000h).
    pub device_type: Option<u32>,
    /// Vendor, product code, revision number, serial number (1018h).
    pub identity: [Option<u32>; 4],
    /// Name, hardware version, software version (1008h to 100Ah).
    pub texts: [Option<String>; 3],
    /// Error register (1001h).
    pub register: Option<u32>,
    /// Error codes, the newest first (1003h); `None` if the device has no history.
    pub history: Option<Vec<u32>>,
    /// Heartbeat time, in milliseconds (1017h).
    pub heartbeat_ms: Option<u32>,
}

impl Device {
    /// Returns true if the device is a drive.
    pub fn is_drive(&self) -> bool {
        self.device_type.is_some_and(|device_type| device_type & 0xFFFF == PROFILE)
    }
}

/// State of a CiA 402 drive.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Drive {
    /// Supported modes (6502h).
    pub modes: Option<u32>,
    /// Modes of operation display (6061h).
    pub mode: Option<i8>,
    /// Status word (6041h).
    pub status: Option<u16>,
    /// Error code (603Fh).
    pub error: Option<u16>,
    /// Position actual value (6064h).
    pub position: Option<i32>,
    /// Digital inputs (60FDh).
    pub inputs: Option<u32>,
    /// Factors that the drive has: index, name, values of the subindices.
    pub factors: Vec<(u16, &'static str, Vec<u32>)>,
}

/// NMT state of a device, as its heartbeat reports it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReportedState {
    /// Reported state.
    State(NmtState),
    /// The device has no heartbeat.
    None,
    /// The device should send a heartbeat, but none was received.
    Silent,
}

impl Session {
    /// Reads an object that the device may lack.
    pub(super) fn read_optional(&mut self, node: NodeId, object: Object) -> Result<Option<Vec<u8>>, CommissionError> {
        match self.read(node, object) {
            Ok(data) => Ok(Some(data)),
            Err(error) if error.is_refusal() => Ok(None),
            Err(error) => Err(error),
        }
    }

    /// Reads a number of up to 4 bytes that the device may lack.
    pub(super) fn number(&mut self, node: NodeId, index: u16, sub: u8) -> Result<Option<u32>, CommissionError> {
        Ok(self.read_optional(node, Object { index, sub })?.and_then(|data| number(&data)))
    }

    /// Reads the identity of a device.
    ///
    /// # Errors
    /// The device does not answer; the bus connection is lost.
    pub fn device(&mut self, node: NodeId) -> Result<Device, CommissionError> {
        let device_type = self.number(node, 0x1000, 0)?;
        let mut device = Device { device_type, ..Device::default() };
        for (sub, place) in (1..).zip(&mut device.identity) {
            *place = self.number(node, 0x1018, sub)?;
        }
        for (index, place) in (0x1008..).zip(&mut device.texts) {
            *place = self.read_optional(node, Object { index, sub: 0 })?.map(|data| text(&data));
        }
        device.register = self.number(node, 0x1001, 0)?;
        device.heartbeat_ms = self.number(node, can_objects::PRODUCER_HEARTBEAT.index, 0)?;
        if let Some(count) = self.number(node, 0x1003, 0)? {
            let mut history = Vec::new();
            for sub in 1..=count.min(HISTORY) as u8 {
                history.extend(self.number(node, 0x1003, sub)?);
            }
            device.history = Some(history);
        }
        Ok(device)
    }

    /// Reads the state of a drive.
    ///
    /// # Errors
    /// The device does not answer; the bus connection is lost.
    pub fn drive(&mut self, node: NodeId) -> Result<Drive, CommissionError> {
        let mut of = |object: Object| self.number(node, object.index, object.sub);
        let mut drive = Drive {
            modes: of(objects::SUPPORTED_MODES)?,
            mode: of(objects::MODE_DISPLAY)?.map(|mode| (mode as u8).cast_signed()),
            status: of(objects::STATUS_WORD)?.map(|status| status as u16),
            error: of(objects::ERROR_CODE)?.map(|error| error as u16),
            position: of(objects::POSITION)?.map(u32::cast_signed),
            inputs: of(objects::DIGITAL_INPUTS)?,
            factors: Vec::new(),
        };
        for (index, first, last, what) in FACTORS {
            let mut values = Vec::new();
            for sub in first..=last {
                values.extend(self.number(node, index, sub)?);
            }
            if !values.is_empty() {
                drive.factors.push((index, what, values));
            }
        }
        Ok(drive)
    }

    /// Returns the NMT state of a device: the last one that was received, otherwise that of the next heartbeat, which is waited for.
    ///
    /// # Errors
    /// The bus connection is lost.
    pub fn nmt_state(&mut self, node: NodeId, heartbeat_ms: Option<u32>) -> Result<ReportedState, CommissionError> {
        if let Some(state) = self.state(node) {
            return Ok(ReportedState::State(state));
        }
        let Some(time) = heartbeat_ms.filter(|time| *time > 0) else { return Ok(ReportedState::None) };
        let time = (Duration::from_millis(time.into()) * 2).min(PATIENCE);
        Ok(self.wait_for_state(node, time, |_| true)?.map_or(ReportedState::Silent, ReportedState::State))
    }
}
