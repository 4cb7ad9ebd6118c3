//! Simulated CiA 402 drives on a bus: CANopen devices with the mechanics of the simulation.
//!
//! Law      at each SYNC the drives first move by the period of 1006h, or by one cycle, with the commands applied at the previous SYNC.
//!          Then they send their PDOs and apply the PDOs received since. A setpoint sent between SYNC n - 1 and n is therefore reached at
//!          SYNC n + 1. Without SYNC the drives move by the clock
//! Reads    NMT, SYNC, SDO, receive PDOs, the heartbeat of 1016h, guarding
//! Writes   boot-up, heartbeat, SDO answers, transmit PDOs, EMCY
//! Refuses  modules, encoders, drives with DRIVETYPE: see [`unsupported`]
//! Source   CiA 301, CiA 402-2

mod device;
mod pdo;
mod server;
mod supervision;
mod table;

use self::device::Device;
use crate::config::{BusConfig, DeviceConfig};
use crate::transport::{Transport, TransportError};
use crate::{Frame, Id, NodeId};
use lineshaft_core::drive::{Backend, Inputs, Outputs};
use lineshaft_core::sim::Plant;
use std::thread;
use std::time::{Duration, Instant};

/// Error code of a device that has lost its master (CiA 301: life guard error or heartbeat error).
const CONNECTION_LOST: u16 = 0x8130;
/// Time without SYNC after which the drives move by the clock; at least two SYNC periods.
const SILENCE: Duration = Duration::from_millis(100);
/// Time between two polls of the bus.
const LOOK: Duration = Duration::from_micros(200);
/// Longest time for which motion is made up after the process was suspended, and longest motion of one SYNC.
const LONGEST_GAP: Duration = Duration::from_secs(1);
/// Time to listen for other devices before the drives boot: longer than most heartbeat times.
const LISTEN: Duration = Duration::from_millis(1_200);

/// Simulated drives on a bus.
pub struct SimulatedBus {
    transport: Box<dyn Transport>,
    plant: Plant,
    devices: Vec<Device>,
    inputs: Inputs,
    outputs: Outputs,
    cycle: Duration,
    /// Frames to be sent.
    frames: Vec<Frame>,
    last_sync: Option<Duration>,
    /// SYNC time for which the mechanics have not moved yet: less than a cycle.
    owed: Duration,
    next_step: Duration,
}

/// Returns the reason why a bus cannot be simulated; `None` if it can.
pub fn unsupported(config: &BusConfig) -> Option<String> {
    config.devices.iter().find_map(|device| {
        let what = unsupported_device(device)?;
        Some(format!("{}: {device}: {what}", config.name))
    })
}

fn unsupported_device(device: &DeviceConfig) -> Option<String> {
    let Some(drive) = device.drive() else {
        return Some("modules and encoders are not simulated on a bus".to_owned());
    };
    drive.drive_type.map(|_| "drives with drivetype are not simulated on a bus".to_owned())
}

/// Listens for other devices on the bus with the node IDs of these drives. Returns the first node that is occupied.
///
/// # Errors
/// The bus connection is lost.
pub fn occupied_node(transport: &mut dyn Transport, config: &BusConfig) -> Result<Option<NodeId>, TransportError> {
    let begin = Instant::now();
    for device in &config.devices {
        // Read request for 1000h, which a device without heartbeat answers.
        transport.send(&Frame::of(device.node.sdo_request(), [0x40, 0x00, 0x10, 0, 0, 0, 0, 0]))?;
    }
    while begin.elapsed() < LISTEN {
        transport.flush()?;
        while let Some(frame) = transport.receive()? {
            let is_of = |node: NodeId| [node.heartbeat(), node.sdo_response(), node.emergency()].contains(&frame.id());
            let found = config.devices.iter().map(|device| device.node).find(|node| is_of(*node));
            if found.is_some() && !frame.is_remote() {
                return Ok(found);
            }
        }
        thread::sleep(LOOK);
    }
    Ok(None)
}

impl SimulatedBus {
    /// Creates the drives of a bus, switched off. `plant` contains their mechanics; `inputs` and `outputs` have the shape of the machine.
    pub fn new(
        transport: Box<dyn Transport>,
        config: &BusConfig,
        mut plant: Plant,
        mut inputs: Inputs,
        outputs: Outputs,
    ) -> Self {
        let cycle = Duration::from_nanos(config.cycle_ns.max(1));
        let devices: Vec<_> = config.devices.iter().filter_map(|device| Device::new(device, cycle)).collect();
        // The plant simulates the delay of a bus, which is real here and is therefore skipped.
        let delay = devices.iter().filter_map(|device| plant.capabilities(device.place())).map(|offers| offers.delay);
        for _ in 0..=delay.max().unwrap_or_default() {
            plant.read(&mut inputs);
        }
        Self {
            transport,
            plant,
            devices,
            inputs,
            outputs,
            cycle,
            frames: Vec::new(),
            last_sync: None,
            owed: Duration::ZERO,
            next_step: Duration::ZERO,
        }
    }

    /// Boots the drives and serves the bus until `is_over` returns true.
    ///
    /// # Errors
    /// The bus connection is lost.
    pub fn run(&mut self, is_over: impl Fn() -> bool) -> Result<(), TransportError> {
        let begin = Instant::now();
        self.boot()?;
        while !is_over() {
            if !self.serve(begin.elapsed())? {
                thread::sleep(LOOK);
            }
        }
        self.transport.close();
        Ok(())
    }

    /// Sends the boot-up messages.
    ///
    /// # Errors
    /// The bus connection is lost.
    pub fn boot(&mut self) -> Result<(), TransportError> {
        for device in &mut self.devices {
            device.update_objects(&self.inputs, &mut self.frames);
            device.boot(&mut self.frames);
        }
        self.send()
    }

    /// Does what is due at `now`, the time since the start. Returns true if a frame was received.
    ///
    /// # Errors
    /// The bus connection is lost.
    pub fn serve(&mut self, now: Duration) -> Result<bool, TransportError> {
        let mut has_come = false;
        while let Some(frame) = self.transport.receive()? {
            has_come = true;
            self.take(&frame, now);
            self.send()?;
        }
        self.tick(now);
        self.send()?;
        Ok(has_come)
    }

    fn take(&mut self, frame: &Frame, now: Duration) {
        if frame.id() == Id::SYNC && !frame.is_remote() {
            self.last_sync = Some(now);
            let period = self.period();
            self.owed += period;
            while self.owed >= self.cycle {
                self.owed -= self.cycle;
                self.step();
            }
            for device in &mut self.devices {
                device.synchronize(&mut self.frames);
            }
            return;
        }
        for device in &mut self.devices {
            device.take(frame, now, &mut self.frames);
        }
        self.set_faults_of_lost_masters();
    }

    /// Returns the SYNC period of the first drive that has one, otherwise one cycle.
    fn period(&self) -> Duration {
        // 1006h is in whole microseconds.
        let is_other = |period: &Duration| period.abs_diff(self.cycle) >= Duration::from_micros(1);
        let period = self.devices.iter().find_map(Device::sync_period).filter(is_other);
        period.map_or(self.cycle, |period| period.min(LONGEST_GAP))
    }

    fn tick(&mut self, now: Duration) {
        for device in &mut self.devices {
            device.tick(now, &mut self.frames);
        }
        self.set_faults_of_lost_masters();
        let silence = SILENCE.max(self.period() * 2);
        let has_sync = self.last_sync.is_some_and(|last| now.saturating_sub(last) < silence);
        if has_sync || now.saturating_sub(self.next_step) > LONGEST_GAP {
            self.next_step = now + self.cycle;
        }
        while self.next_step <= now {
            self.step();
            self.next_step += self.cycle;
        }
    }

    /// Runs one cycle of the mechanics.
    fn step(&mut self) {
        for device in &mut self.devices {
            device.run_mode(&self.inputs, &mut self.outputs);
        }
        self.plant.write(&self.outputs);
        let cycle = self.inputs.cycle.wrapping_add(1);
        self.inputs.begin(cycle, 0);
        self.plant.read(&mut self.inputs);
        for device in &mut self.devices {
            device.update_objects(&self.inputs, &mut self.frames);
        }
    }

    /// Sets faults of drives that have lost their master.
    fn set_faults_of_lost_masters(&mut self) {
        for device in &mut self.devices {
            if device.take_master_loss()
                && let Some(drive) = self.plant.drive(device.place())
            {
                drive.inject_fault(CONNECTION_LOST);
            }
        }
    }

    fn send(&mut self) -> Result<(), TransportError> {
        for frame in self.frames.drain(..) {
            match self.transport.send(&frame) {
                // The frame is lost, as in a device whose controller has no room.
                Ok(()) | Err(TransportError::Full(_)) => {}
                Err(lost) => return Err(lost),
            }
        }
        self.transport.flush()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Monitoring;
    use crate::config::Role;
    use lineshaft_cia402::drive_type::DriveType;

    /// Returns a bus with one drive that `change` modifies.
    fn bus(change: impl Fn(&mut DeviceConfig)) -> BusConfig {
        let mut device = DeviceConfig::plain_drive(0, NodeId::new(3).unwrap(), Monitoring::None);
        change(&mut device);
        BusConfig {
            name: "bus0".to_owned(),
            transport: "udp:239.74.163.2:43113".parse().unwrap(),
            bit_rate: None,
            serial_baudrate: None,
            cycle_ns: 2_000_000,
            sync_overflow: None,
            sdo_timeout_ns: 1,
            time_ns: None,
            master: None,
            devices: vec![device],
        }
    }

    #[test]
    fn unsupported_devices_are_refused_by_name() {
        assert_eq!(unsupported(&bus(|_| {})), None);
        let sentence = unsupported(&bus(|device| device.role = Role::Module)).unwrap();
        assert_eq!(sentence, "bus0: node 3 (module): modules and encoders are not simulated on a bus");
        let by_type = unsupported(&bus(|device| {
            if let Role::Drive(drive) = &mut device.role {
                drive.drive_type = DriveType::decode(1);
                assert!(drive.drive_type.is_some());
            }
        }));
        assert!(by_type.unwrap().contains("drives with drivetype are not simulated on a bus"));
    }
}
