//! A device in the cycles.
//!
//! Law      a device is online while it is configured, operational, monitored, and its data is received; only then it receives process data
//! Reads    its PDOs, emergency messages, signs of life
//! Writes   its part of the inputs; its command PDOs
//! Source   CiA 301, contract section 8

use crate::config::DeviceConfig;
use crate::layout::Transmission;
use crate::pdo_image::PdoImage;
use crate::{Frame, Id, Monitor, NodeId};
use lineshaft_cia402::adapter::DriveAdapter;
use lineshaft_cia402::mapping::{CommandedValue, ReportedValue};
use lineshaft_cia402::terminals::TerminalAdapter;
use lineshaft_core::drive::{BusState, Inputs, Outputs};

/// PDO that the device sends.
#[derive(Clone, Debug)]
struct Received {
    image: PdoImage<ReportedValue>,
    is_each_sync: bool,
}

/// Device on a bus.
#[derive(Debug)]
pub(crate) struct Device {
    pub(super) node: NodeId,
    asked: Vec<PdoImage<CommandedValue>>,
    told: Vec<Received>,
    /// Whether the device is configured and started.
    is_ready: bool,
    /// Whether the device is configured and about to be started, so that its data already counts.
    listens: bool,
    /// Whether the device has booted since its configuration began.
    has_booted: bool,
    /// Whether the counts belong to the same coordinate system as the last received ones.
    counts_on: bool,
    pub(super) watch: Monitor,
    /// State of the drive, if the device is one.
    pub(super) drive: Option<DriveAdapter>,
    terminals: TerminalAdapter,
}

impl Device {
    pub(super) fn new(config: &DeviceConfig, cycle_ns: u64) -> Self {
        let told: Vec<_> = config
            .layout
            .told
            .iter()
            .map(|pdo| Received { image: PdoImage::of(pdo), is_each_sync: pdo.transmission == Transmission::EachSync })
            .collect();
        Self {
            node: config.node,
            asked: config.layout.asked.iter().map(PdoImage::of).collect(),
            told,
            is_ready: false,
            listens: false,
            has_booted: false,
            counts_on: false,
            watch: Monitor::new(config.node, config.watching),
            drive: config.drive().map(|drive| DriveAdapter::new(drive, &config.layout.drive_mapping(), cycle_ns)),
            terminals: TerminalAdapter::new(&config.terminals, config.layout.told.len()),
        }
    }

    /// Returns the identifiers of the PDOs that the device sends.
    pub(super) fn tpdo_ids(&self) -> impl Iterator<Item = Id> {
        self.told.iter().map(|pdo| pdo.image.id())
    }

    pub(super) fn is_ready(&self) -> bool {
        self.is_ready
    }

    /// Marks the beginning of the configuration, which is valid unless the device boots.
    pub(super) fn prepare(&mut self) {
        (self.is_ready, self.listens, self.has_booted) = (false, false, false);
    }

    /// Starts reception before the device is started, because it may send data on change only once, at its start. `inputs`: digital inputs
    /// of a drive until then.
    pub(super) fn start_reception(&mut self, inputs: u32) {
        let counts_on = std::mem::replace(&mut self.counts_on, true);
        if let Some(drive) = &mut self.drive {
            drive.listen(inputs, counts_on);
        }
        self.terminals.listen(counts_on);
        self.listens = true;
    }

    /// Adds the configured and started device to the cycles. `fault` is its error code. Returns false if it has booted since it was
    /// [prepared](Self::prepare).
    pub(super) fn begin(&mut self, fault: u16) -> bool {
        if self.has_booted {
            return false;
        }
        if !self.listens {
            self.start_reception(0);
        }
        self.listens = false;
        if let Some(drive) = &mut self.drive {
            drive.begin(fault);
        }
        self.is_ready = true;
        true
    }

    /// Removes the device from the cycles. It continues to count meanwhile.
    pub(super) fn end(&mut self) {
        (self.is_ready, self.listens) = (false, false);
    }

    /// Removes the device, and discards its coordinate system, because a boot-up would not be noticed from now on.
    pub(super) fn remove_and_discard_epoch(&mut self) {
        self.end();
        self.counts_on = false;
    }

    /// Handles a boot-up: the device has lost its configuration, and its counts may begin again.
    pub(super) fn handle_boot_up(&mut self) {
        self.remove_and_discard_epoch();
        self.has_booted = true;
    }

    /// Handles the PDO at a place.
    pub(super) fn take_pdo(&mut self, place: usize, frame: &Frame) {
        let counts = self.is_ready || self.listens;
        let Some(Received { image, is_each_sync }) = self.told.get_mut(place).filter(|_| counts) else { return };
        if !image.update(frame) {
            return;
        }
        if let Some(drive) = &mut self.drive {
            drive.take(image.values(), *is_each_sync);
        }
        self.terminals.take(place, image.values());
    }

    /// Writes the inputs of this cycle.
    pub(super) fn read(&mut self, inputs: &mut Inputs, bus: BusState) {
        let is_there = self.is_ready && bus != BusState::Off;
        if let Some(drive) = &mut self.drive {
            drive.read(inputs, is_there, bus);
        }
        self.terminals.read(inputs, is_there, self.drive.as_ref());
    }

    /// Returns the command PDOs of a cycle; none while the device is not ready.
    pub(super) fn frames(&mut self, outputs: &Outputs) -> impl Iterator<Item = Frame> {
        let output = self.drive.as_ref().and_then(|drive| outputs.drive.get(drive.place()));
        if let (Some(drive), Some(output)) = (&mut self.drive, output) {
            drive.ask(output);
        }
        let Self { asked, drive, terminals, is_ready, .. } = &*self;
        let value = move |word| match (word, drive, output) {
            (CommandedValue::Outputs | CommandedValue::Digital(_) | CommandedValue::Analog(_), ..) => {
                terminals.value(word, outputs)
            }
            (_, Some(drive), Some(output)) => drive.value(word, output),
            _ => 0,
        };
        asked.iter().filter(move |_| *is_ready).map(move |image| image.frame(value))
    }
}
