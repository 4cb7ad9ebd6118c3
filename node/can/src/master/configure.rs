//! Configures a device from any state to operational, a drive with its axis off.
//!
//! Law      identity and state of a device are read before anything is written. An enabled drive is stopped on its quick stop ramp, then
//!          its voltage is disabled. Objects that already have their values are not written. If the verification objects (1020h) of a
//!          device match, its values are not compared either
//! Refuses  a node with another identity or profile, one that does not support its mode, one that refuses a value; the message gives the
//!          object and both values
//! Source   CiA 301 (boot-up, NMT, objects 1000h to 1A00h), CiA 302-2, CiA 402-2, MACS-CAN-04, MACS-CAN-08

mod mapping;

use super::bus::Order;
use super::port::Port;
use crate::config::{BusConfig, DeviceConfig, HEARTBEATS_MISSED, Role};
use crate::layout::Pdo;
use crate::{Monitoring, NmtCommand, NodeId, can_objects};
use lineshaft_cia402::config::Write;
use lineshaft_cia402::mapping::{Field, ReportedValue};
use lineshaft_cia402::object::Object;
use lineshaft_cia402::sdo::SdoError;
use lineshaft_cia402::startup::{self, ObjectAccess, StartError};
use lineshaft_cia402::{objects, texts};
use std::time::{Duration, Instant};

/// Number of pairs of requests that distinguish two devices with one node ID from one late answer.
const TWIN_REQUESTS: u32 = 3;
/// Time between the start of a drive and the begin of the cycles, for the reception of data that it sends on change.
const SETTLING_TIME: Duration = Duration::from_millis(5);

/// Reason why a device is not configured.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub(crate) enum Refusal {
    /// The device does not answer.
    #[error("it is not there: {0}")]
    Absent(SdoError),
    /// The device answers, but sends no sign of life that could be monitored.
    #[error("it answers, but shows no sign of life")]
    NoLife,
    /// The device differs from the cell, or refuses a value.
    #[error("{0}")]
    Wrong(String),
}

impl From<SdoError> for Refusal {
    fn from(error: SdoError) -> Self {
        match error {
            SdoError::Silent(..) => Self::Absent(error),
            other => Self::Wrong(other.to_string()),
        }
    }
}

impl From<StartError> for Refusal {
    fn from(error: StartError) -> Self {
        match error {
            StartError::Sdo(error) => error.into(),
            StartError::Wrong(message) => Self::Wrong(message),
        }
    }
}

/// Result of a configuration.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Configured {
    /// Number of objects that were written.
    pub(crate) written: usize,
    /// Error code of the device.
    pub(crate) fault: u16,
}

/// Configuration of a device in progress.
struct Session<'a> {
    port: &'a mut Port,
    bus: &'a BusConfig,
    device: &'a DeviceConfig,
    written: usize,
}

/// Configures a device and starts it.
pub(crate) fn configure(
    port: &mut Port,
    place: usize,
    bus: &BusConfig,
    device: &DeviceConfig,
) -> Result<Configured, Refusal> {
    port.order(Order::Prepare { device: place });
    let mut session = Session { port, bus, device, written: 0 };
    session.check_answers()?;
    // The device may have reported a boot-up since the first order. Nothing was written to it before.
    session.port.order(Order::Prepare { device: place });
    session.identify()?;
    session.check_single_node()?;
    if let Some(drive) = device.drive() {
        startup::check_factors(&mut session.access(), drive)?;
        stop_and_disable(session.port, device.node)?;
    }
    session.port.nmt(NmtCommand::EnterPreOperational, device.node);
    session.write_all()?;
    // The device may send data on change only once if nothing changes, and not every device sends it at its start.
    let inputs = session.inputs()?;
    session.port.order(Order::Listen { device: place, inputs });
    session.port.nmt(NmtCommand::Start, device.node);
    let fault = match device.role {
        Role::Drive(_) => session.number(objects::ERROR_CODE)?.unwrap_or_default(),
        Role::Module | Role::Encoder => 0,
    };
    session.port.wait(SETTLING_TIME);
    session.wait_for_sign_of_life(place)?;
    Ok(Configured { written: session.written, fault: fault as u16 })
}

/// Switches the outputs of a module off.
pub(crate) fn switch_off_outputs(port: &mut Port, device: &DeviceConfig) -> Result<(), Refusal> {
    let fields = device.layout.asked.iter().flat_map(|pdo| &pdo.fields);
    let mut refused = Ok(());
    for Field { object, bits, .. } in fields {
        let zero = [0; 4];
        let bytes = (bits / 8) as usize;
        let written = port.write(device.node, *object, zero.get(..bytes).unwrap_or(&zero));
        // If the device refuses one object, the other outputs are still switched off.
        refused = refused.and(written.map(drop).map_err(Refusal::from));
    }
    refused
}

/// Stops and disables a drive.
pub(crate) fn stop_and_disable(port: &mut Port, node: NodeId) -> Result<(), Refusal> {
    Ok(startup::stop_and_disable(&mut NodeAccess { port, node })?)
}

/// SDO access to a node.
struct NodeAccess<'a> {
    port: &'a mut Port,
    node: NodeId,
}

impl ObjectAccess for NodeAccess<'_> {
    fn read(&mut self, object: Object) -> Result<Vec<u8>, SdoError> {
        self.port.read(self.node, object)
    }

    fn write(&mut self, object: Object, data: &[u8]) -> Result<(), SdoError> {
        self.port.write(self.node, object, data)
    }

    fn wait(&mut self, time: Duration) {
        self.port.wait(time);
    }
}

impl Session<'_> {
    fn access(&mut self) -> NodeAccess<'_> {
        NodeAccess { port: self.port, node: self.device.node }
    }

    /// Returns a number; `None` if the drive lacks the object.
    fn number(&mut self, object: Object) -> Result<Option<u32>, Refusal> {
        Ok(startup::number(&mut self.access(), object)?)
    }

    /// Checks that the device answers. A stopped device (NMT) does not answer SDO, and a first request may get lost.
    fn check_answers(&mut self) -> Result<(), Refusal> {
        match self.port.read(self.device.node, objects::DEVICE_TYPE) {
            Err(error @ SdoError::Silent(..)) => {
                self.port.nmt(NmtCommand::EnterPreOperational, self.device.node);
                // During cycles the next attempt follows soon, and other devices are waiting.
                if self.port.is_in_cycles() {
                    return Err(error.into());
                }
                Ok(self.port.read(self.device.node, objects::DEVICE_TYPE).map(drop)?)
            }
            done => Ok(done.map(drop)?),
        }
    }

    /// Returns the digital inputs of a drive whose PDO reports them later.
    fn inputs(&mut self) -> Result<u32, Refusal> {
        let tells = |pdo: &Pdo<ReportedValue>| pdo.fields.iter().any(|field| field.word == ReportedValue::Inputs);
        match self.device.layout.told.iter().any(tells) {
            true => Ok(self.number(objects::DIGITAL_INPUTS)?.unwrap_or_default()),
            false => Ok(0),
        }
    }

    /// Waits for a sign of life, because a silent device is not monitored before its first one.
    fn wait_for_sign_of_life(&mut self, place: usize) -> Result<(), Refusal> {
        let most = match self.device.watching {
            Monitoring::Heartbeat { time_ns } => time_ns,
            Monitoring::Guarding { guard_ns, life_factor } => guard_ns.saturating_mul(life_factor.into()),
            Monitoring::None => return Ok(()),
        };
        let begin = Instant::now();
        while self.port.is_silent(place) {
            if begin.elapsed() > Duration::from_nanos(most) {
                return Err(Refusal::NoLife);
            }
            self.port.wait(SETTLING_TIME);
        }
        Ok(())
    }

    fn identify(&mut self) -> Result<(), Refusal> {
        let device = startup::number_of(&self.port.read(self.device.node, objects::DEVICE_TYPE)?);
        let (profile, what) = self.device.role.profile();
        if device & 0xFFFF != profile {
            let found = texts::profile(device & 0xFFFF);
            return Err(Refusal::Wrong(format!(
                "its device type (1000h) is {device:08X}h, profile {found}; profile {profile} ({what}) is expected"
            )));
        }
        let identity = self.device.identity;
        let expected = [
            ("vendor", objects::VENDOR, identity.vendor),
            ("product code", objects::PRODUCT, identity.product),
            ("revision number", objects::REVISION, identity.revision),
            ("serial number", objects::SERIAL, identity.serial),
        ];
        for (what, object, expected) in expected {
            let Some(expected) = expected else { continue };
            let found = self.number(object)?;
            if found != Some(expected) {
                let found = found.map_or("missing".to_owned(), |found| format!("{found:08X}h"));
                return Err(Refusal::Wrong(format!("its {what} ({object}) is {found}; {expected:08X}h is expected")));
            }
        }
        let Some(drive) = self.device.drive() else { return Ok(()) };
        Ok(startup::check_modes(&mut self.access(), drive)?)
    }

    /// Detects two devices with one node ID: they answer each request twice, and each second answer is unexpected.
    fn check_single_node(&mut self) -> Result<(), Refusal> {
        let node = self.device.node;
        for _ in 0..TWIN_REQUESTS {
            let before = self.port.strays();
            self.port.read(node, objects::DEVICE_TYPE)?;
            // Another object, so that the second answer to the first request does not match this one.
            self.number(objects::VENDOR)?;
            if self.port.strays() == before {
                return Ok(());
            }
        }
        let number = node.get();
        Err(Refusal::Wrong(format!("each request has two answers: another device has the node id {number} as well")))
    }

    fn write_all(&mut self) -> Result<(), Refusal> {
        let writes = self.writes();
        let digest = digest(&writes, self.bus, self.device);
        if let (Some(date), Some(time)) =
            (self.number(can_objects::CONFIGURATION_DATE)?, self.number(can_objects::CONFIGURATION_TIME)?)
        {
            if (date, time) == digest {
                return Ok(());
            }
            self.write_differing(&writes)?;
            self.write_pdos()?;
            self.write(can_objects::CONFIGURATION_DATE, &digest.0.to_le_bytes())?;
            return self.write(can_objects::CONFIGURATION_TIME, &digest.1.to_le_bytes());
        }
        self.write_differing(&writes)?;
        self.write_pdos()
    }

    /// Returns the values for the drive except its PDOs. The flag marks objects that a drive may lack.
    fn writes(&self) -> Vec<(Write, bool)> {
        let mut writes: Vec<_> = self.device.startup.iter().map(|write| (write.clone(), false)).collect();
        let mut add = |object: Object, data: &[u8], is_optional| {
            writes.push((Write { object, data: data.to_vec() }, is_optional));
        };
        let ms = |ns: u64| u16::try_from(ns / 1_000_000).unwrap_or(u16::MAX);
        match self.device.watching {
            Monitoring::Heartbeat { time_ns } => {
                add(can_objects::PRODUCER_HEARTBEAT, &ms(time_ns / HEARTBEATS_MISSED).to_le_bytes(), false);
            }
            Monitoring::Guarding { guard_ns, life_factor } => {
                add(can_objects::PRODUCER_HEARTBEAT, &0_u16.to_le_bytes(), true);
                add(can_objects::GUARD_TIME, &ms(guard_ns).to_le_bytes(), false);
                add(can_objects::LIFE_TIME_FACTOR, &[life_factor], false);
            }
            Monitoring::None => add(can_objects::PRODUCER_HEARTBEAT, &0_u16.to_le_bytes(), true),
        }
        if let Some(master) = self.bus.master {
            let time = ms(master.heartbeat_ns.saturating_mul(HEARTBEATS_MISSED));
            add(can_objects::CONSUMER_HEARTBEAT, &consumer_heartbeat_value(master.node, time), true);
        }
        add(can_objects::SYNC_COB_ID, &0x80_u32.to_le_bytes(), true);
        let Some(drive) = self.device.drive() else { return writes };
        let layout = &self.device.layout;
        let mut told = layout.told.iter().flat_map(|pdo| &pdo.fields);
        let has_mode = layout.mode_by_sdo.reads || told.any(|field| field.word == ReportedValue::Mode);
        writes.extend(startup::values(drive, self.bus.cycle_ns, has_mode, &self.device.terminals.digital_outputs));
        writes
    }

    /// Writes the values that differ from those of the drive.
    fn write_differing(&mut self, writes: &[(Write, bool)]) -> Result<(), Refusal> {
        for (Write { object, data }, is_optional) in writes {
            let present = match self.port.read(self.device.node, *object) {
                Ok(present) => Some(present),
                Err(error) if startup::is_absent(&error) && *is_optional => continue,
                Err(error @ SdoError::Silent(..)) => return Err(error.into()),
                // The object is write-only.
                Err(_) => None,
            };
            if present.as_ref() != Some(data) {
                self.write(*object, data)?;
            }
        }
        self.write_sync()
    }

    /// Writes counter overflow value and period of SYNC. The first can be changed only while the second is 0.
    fn write_sync(&mut self) -> Result<(), Refusal> {
        let overflow = self.bus.sync_overflow.unwrap_or_default();
        let present = self.number(can_objects::SYNC_OVERFLOW)?;
        let mut period = self.number(can_objects::CYCLE_PERIOD)?;
        if present.unwrap_or_default() != u32::from(overflow) {
            if period.is_some_and(|period| period != 0) {
                self.write(can_objects::CYCLE_PERIOD, &0_u32.to_le_bytes())?;
                period = Some(0);
            }
            self.write(can_objects::SYNC_OVERFLOW, &[overflow])?;
        }
        let wanted = period_us(self.bus);
        // A drive without the object uses the period of 60C2h.
        if period.is_some_and(|period| period != wanted) {
            self.write(can_objects::CYCLE_PERIOD, &wanted.to_le_bytes())?;
        }
        Ok(())
    }

    fn write(&mut self, object: Object, data: &[u8]) -> Result<(), Refusal> {
        self.port.write(self.device.node, object, data)?;
        self.written += 1;
        Ok(())
    }
}

/// Returns the value of 1016h: monitored node and its heartbeat time, in ms; 0: not monitored.
fn consumer_heartbeat_value(node: NodeId, time: u16) -> [u8; 4] {
    (u32::from(node.get()) << 16 | u32::from(time)).to_le_bytes()
}

/// Returns the SYNC period, in us.
fn period_us(bus: &BusConfig) -> u32 {
    u32::try_from(bus.cycle_ns / 1000).unwrap_or(u32::MAX)
}

/// Returns a digest of the configuration: FNV-1a of all that is written, in two halves.
fn digest(writes: &[(Write, bool)], bus: &BusConfig, device: &DeviceConfig) -> (u32, u32) {
    let mut hash = 0xCBF2_9CE4_8422_2325_u64;
    let mut add = |bytes: &[u8]| {
        for byte in bytes {
            hash = (hash ^ u64::from(*byte)).wrapping_mul(0x0000_0100_0000_01B3);
        }
    };
    add(&period_us(bus).to_le_bytes());
    add(&[bus.sync_overflow.unwrap_or_default()]);
    for (Write { object, data }, _) in writes {
        add(&object.index.to_le_bytes());
        add(&[object.sub, data.len() as u8]);
        add(data);
    }
    let mut add_pdo = |number: u8, id: u16, kind: u8, objects: &mut dyn Iterator<Item = (Object, u32)>| {
        add(&[number, kind]);
        add(&id.to_le_bytes());
        for (object, bits) in objects {
            add(&object.index.to_le_bytes());
            add(&[object.sub, bits as u8]);
        }
    };
    for pdo in &device.layout.asked {
        let mut fields = pdo.fields.iter().map(|field| (field.object, field.bits));
        add_pdo(pdo.number, pdo.id.get(), pdo.transmission.number(), &mut fields);
    }
    for pdo in &device.layout.told {
        let mut fields = pdo.fields.iter().map(|field| (field.object, field.bits));
        add_pdo(pdo.number, pdo.id.get(), pdo.transmission.number(), &mut fields);
    }
    // 0 is the value of a device that was never configured.
    let (low, high) = (hash as u32, (hash >> 32) as u32);
    (low | 1, high)
}

/// Disables monitoring of the master in the devices, because the master is about to end.
pub(crate) fn release(port: &mut Port, bus: &BusConfig, device: &DeviceConfig) {
    let node = device.node;
    if let Monitoring::Guarding { .. } = device.watching {
        let _ = port.write(node, can_objects::LIFE_TIME_FACTOR, &[0]);
    }
    if let Some(master) = bus.master {
        // The error of a device that does not answer, or that lacks the object, is irrelevant.
        let _ = port.write(node, can_objects::CONSUMER_HEARTBEAT, &consumer_heartbeat_value(master.node, 0));
    }
    port.nmt(NmtCommand::EnterPreOperational, node);
}

/// Adds the device to the cycles.
pub(crate) fn begin(port: &mut Port, place: usize, configured: Configured) {
    port.order(Order::Begin { device: place, fault: configured.fault });
}

#[cfg(test)]
mod tests;
