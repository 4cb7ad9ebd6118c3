//! Cyclic half of the master, which the cycle thread runs.

use super::bus::{Bus, Order};
use crate::config::{BusConfig, DeviceConfig};
use crate::transport::Transport;
use lineshaft_core::drive::{Backend, Capabilities, Inputs, Outputs};
use rtrb::RingBuffer;
use std::sync::{Arc, Mutex};

/// Cyclic exchange with the devices of a bus.
pub struct CanBackend {
    bus: Arc<Mutex<Bus>>,
    /// Places of the drives, with their capabilities.
    drives: Vec<(usize, Capabilities)>,
}

impl CanBackend {
    /// Creates only the cyclic half, on an open transport, with all drives marked as configured and started. It is used to measure an
    /// exchange. Its reports are dropped.
    pub fn started(config: &BusConfig, transport: Box<dyn Transport>) -> Self {
        let (mut orders, taken) = RingBuffer::new(config.devices.len() + 1);
        let (told, _) = RingBuffer::new(1);
        let mut bus = Bus::new(config, taken, told);
        bus.open(transport);
        for device in 0..config.devices.len() {
            // The ring has room for each device.
            let _ = orders.push(Order::Begin { device, fault: 0 });
        }
        Self::new(config, Arc::new(Mutex::new(bus)))
    }

    pub(super) fn new(config: &BusConfig, bus: Arc<Mutex<Bus>>) -> Self {
        let drives = config.devices.iter().filter_map(DeviceConfig::drive);
        Self { bus, drives: drives.map(|drive| (drive.place, drive.offers)).collect() }
    }
}

impl Backend for CanBackend {
    fn capabilities(&self, drive: usize) -> Option<Capabilities> {
        self.drives.iter().find(|(place, _)| *place == drive).map(|(_, offers)| *offers)
    }

    fn read(&mut self, inputs: &mut Inputs) {
        // No other thread holds the lock during cycles. If one did, the devices would be missing for one cycle.
        if let Ok(mut bus) = self.bus.try_lock() {
            bus.read(inputs);
        }
    }

    fn write(&mut self, outputs: &Outputs) {
        if let Ok(mut bus) = self.bus.try_lock() {
            bus.write(outputs);
        }
    }
}
