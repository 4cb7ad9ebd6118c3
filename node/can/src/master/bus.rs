//! CAN bus: dispatches received frames and sends those that are due.
//!
//! Law      the bus has one owner at a time: the service while no cycles run, the cycle thread while they run. A cycle first handles all
//!          received frames. Then it sends the process data of the devices, SYNC, and at last services such as SDO. It does not block, and
//!          allocates no memory after its creation
//! Reads    frames, the outputs of a cycle, orders of the service
//! Writes   frames, the inputs of a cycle, reports to the service
//! Refuses  nothing: if the transport fails, all devices are offline and the failure is reported
//! Source   CiA 301; contract sections 1 (delay 1) and 8

use super::capture::{FrameRecorder, RecordedFrames};
use super::device::Device;
use super::sync::SyncCounter;
use super::tally::BusCounters;
use super::time::TimeOfDay;
use crate::config::{BusConfig, Master};
use crate::sdo::Client;
use crate::transport::{Transport, TransportError};
use crate::{DeviceEvent, Frame, NmtCommand, NmtState, NodeId};
use lineshaft_cia402::adapter::SdoOutcome;
use lineshaft_cia402::object::Object;
use lineshaft_cia402::sdo::{SdoError, SdoRequest, Transfer};
use lineshaft_core::drive::{BusState, Emergency, Inputs, Outputs};
use rtrb::{Consumer, Producer};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Instant, SystemTime};

/// Maximum number of frames that are received in one cycle: far more than a bus carries in a cycle.
const MOST_FRAMES: usize = 1024;
/// SDO frames that are sent in a cycle, after all cyclic frames.
const SDO_FRAMES: usize = 4;
/// SDO frames that are sent at once while no cycle runs: a whole block.
const SDO_FRAMES_AT_REST: usize = 128;
/// Number of 11-bit identifiers.
const IDS: usize = 0x800;

/// Order of the service to the bus.
pub(crate) enum Order {
    /// The transport was opened, or opened again.
    Open(Box<dyn Transport>),
    /// Reads an object of a node into the buffer, or writes these bytes.
    Transfer { node: NodeId, object: Object, data: Vec<u8>, writes: bool },
    /// Sends an NMT command to a node, or to all.
    Nmt(NmtCommand, Option<NodeId>),
    /// Configuration of the device at this place of the bus begins.
    Prepare { device: usize },
    /// The device is configured and will be started next; with the digital inputs of a drive.
    Listen { device: usize, inputs: u32 },
    /// The device is configured and started; with the error code of a drive. Does not apply to a device that has booted meanwhile.
    Begin { device: usize, fault: u16 },
}

/// Report of the bus to the service.
pub(crate) enum Report {
    /// A transfer has ended; with the total number of unexpected answers of this node.
    Transfer(NodeId, Transfer, u32),
    /// Event of the device at this place of the bus. If it took part in the cycles, it no longer does.
    Happened { device: usize, what: DeviceEvent, took_part: bool },
    /// Emergency message of a node that is not a drive of the cell.
    Emergency(NodeId, Emergency),
    /// A drive refuses an object of the homing setup.
    HomingRefused(usize, SdoError),
    /// The mode of operation of a drive can be neither written nor read by SDO.
    ModeRefused(usize, SdoError),
    /// The bus connection is lost; the bus has given up its transport.
    Lost(Box<dyn Transport>, TransportError),
}

/// Destination of a received frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Route {
    Nobody,
    Pdo { device: u8, place: u8 },
    Emergency(NodeId),
    Sdo(NodeId),
    Life(NodeId),
}

/// Counters of losses, for the service to report.
#[derive(Debug, Default)]
pub(crate) struct Losses {
    /// Frames that the transport did not accept.
    pub(crate) refused: AtomicU64,
    /// Reports that did not reach the service.
    pub(crate) reports: AtomicU64,
    /// Faults that the transport has seen since it was opened.
    pub(crate) faults: AtomicU64,
}

/// CAN bus with its devices.
pub(crate) struct Bus {
    transport: Option<Box<dyn Transport>>,
    began: Instant,
    devices: Vec<Device>,
    /// Destination by identifier.
    routes: Vec<Route>,
    /// SDO clients by node ID, from 1.
    clients: Vec<Client>,
    /// Nodes with a transfer in progress.
    busy: Vec<NodeId>,
    sync: SyncCounter,
    time: TimeOfDay,
    master: Option<Master>,
    /// Time of the last heartbeat of the master, in ns.
    beat_ns: Option<u64>,
    orders: Consumer<Order>,
    reports: Producer<Report>,
    losses: Arc<Losses>,
    tap: FrameRecorder,
    turns: Arc<AtomicU64>,
    silent: Arc<[AtomicBool]>,
}

impl Bus {
    pub(crate) fn new(config: &BusConfig, orders: Consumer<Order>, reports: Producer<Report>) -> Self {
        let devices: Vec<_> = config.devices.iter().map(|device| Device::new(device, config.cycle_ns)).collect();
        let nodes = || (1..=NodeId::MAX).filter_map(NodeId::new);
        let client = |node: NodeId| Client::new(node.sdo_request(), node.sdo_response(), config.sdo_timeout_ns);
        Self {
            transport: None,
            began: Instant::now(),
            routes: routes(&devices),
            silent: devices.iter().map(|_| AtomicBool::new(false)).collect(),
            tap: FrameRecorder::new(devices.len()),
            devices,
            clients: nodes().map(client).collect(),
            busy: Vec::with_capacity(usize::from(NodeId::MAX)),
            sync: SyncCounter::new(config.sync_overflow),
            time: TimeOfDay::new(config.time_ns),
            master: config.master,
            beat_ns: None,
            orders,
            reports,
            losses: Arc::default(),
            turns: Arc::default(),
        }
    }

    /// Returns the counter of how often the bus was run.
    pub(crate) fn turns(&self) -> Arc<AtomicU64> {
        Arc::clone(&self.turns)
    }

    /// Returns the counters of losses.
    pub(crate) fn losses(&self) -> Arc<Losses> {
        Arc::clone(&self.losses)
    }

    /// Returns the frame counters.
    pub(crate) fn tally(&self) -> Arc<BusCounters> {
        Arc::clone(self.tap.tally())
    }

    /// Starts to record frames, and returns their receiver; only before cycles run.
    pub(crate) fn frames(&mut self) -> RecordedFrames {
        self.tap.start_recording()
    }

    /// Returns the flags of devices that have stopped sending signs of life.
    pub(crate) fn silent(&self) -> Arc<[AtomicBool]> {
        Arc::clone(&self.silent)
    }

    /// Removes all devices from the cycles. Each takes part again after its next configuration.
    pub(crate) fn remove_devices(&mut self) {
        self.devices.iter_mut().for_each(Device::remove_and_discard_epoch);
    }

    /// Returns the time since the bus was created, in ns.
    pub(crate) fn now_ns(&self) -> u64 {
        u64::try_from(self.began.elapsed().as_nanos()).unwrap_or(u64::MAX)
    }

    /// Sets an open transport, while the service owns the bus.
    pub(crate) fn open(&mut self, transport: Box<dyn Transport>) {
        self.transport = Some(transport);
        self.remove_devices();
    }

    /// Closes the transport.
    pub(crate) fn close(&mut self) {
        self.remove_devices();
        if let Some(mut transport) = self.transport.take() {
            transport.close();
        }
    }

    /// Returns the state of the bus.
    pub(crate) fn state(&self) -> BusState {
        self.transport.as_ref().map_or(BusState::Off, |transport| transport.state())
    }

    /// Does all that is due while no cycle runs.
    pub(crate) fn exchange(&mut self) {
        let now_ns = self.now_ns();
        self.tap.set_time(now_ns);
        self.take(now_ns);
        self.send_services(now_ns, SDO_FRAMES_AT_REST);
    }

    /// Runs the begin of a cycle: reads the inputs.
    pub(crate) fn read(&mut self, inputs: &mut Inputs) {
        let now_ns = self.now_ns();
        self.tap.set_time(now_ns);
        self.tap.begin(inputs.cycle);
        self.take(now_ns);
        let state = self.state();
        self.devices.iter_mut().for_each(|device| device.read(inputs, state));
    }

    /// Runs the end of a cycle: sends the outputs.
    pub(crate) fn write(&mut self, outputs: &Outputs) {
        let now_ns = self.now_ns();
        self.tap.set_time(now_ns);
        for device in &mut self.devices {
            for frame in device.frames(outputs) {
                // Not `self.send`, because the device is borrowed.
                send(&mut self.transport, &mut self.reports, (&self.losses, &mut self.tap), &frame);
            }
        }
        let sync = self.sync.next();
        self.send(&sync);
        self.ask_by_sdo(now_ns);
        self.send_services(now_ns, SDO_FRAMES);
    }

    fn send(&mut self, frame: &Frame) {
        send(&mut self.transport, &mut self.reports, (&self.losses, &mut self.tap), frame);
    }

    fn report(&mut self, report: Report) {
        push(&mut self.reports, &self.losses, report);
    }

    /// Handles orders and received frames.
    fn take(&mut self, now_ns: u64) {
        self.turns.fetch_add(1, Ordering::Relaxed);
        while let Ok(order) = self.orders.pop() {
            self.execute(order, now_ns);
        }
        for _ in 0..MOST_FRAMES {
            let Some(transport) = &mut self.transport else { break };
            match transport.receive() {
                Ok(Some(frame)) => {
                    self.tap.take(&frame, false);
                    self.dispatch(&frame, now_ns);
                }
                Ok(None) => break,
                Err(error) => {
                    lose(&mut self.transport, &mut self.reports, &self.losses, error);
                    break;
                }
            }
        }
        if let Some(transport) = &self.transport {
            self.losses.faults.store(transport.faults(), Ordering::Relaxed);
        } else {
            self.devices.iter_mut().for_each(Device::remove_and_discard_epoch);
        }
        self.tap
            .tally()
            .set_controller_state(self.state(), self.transport.as_ref().and_then(|transport| transport.errors()));
        self.tick(now_ns);
    }

    fn execute(&mut self, order: Order, now_ns: u64) {
        match order {
            Order::Open(transport) => self.open(transport),
            Order::Transfer { node, object, data, writes } => self.begin_transfer(node, object, data, writes, now_ns),
            Order::Nmt(command, node) => self.send(&command.frame(node)),
            Order::Prepare { device } => {
                if let Some(device) = self.devices.get_mut(device) {
                    device.prepare();
                }
            }
            Order::Listen { device, inputs } => {
                if let Some(device) = self.devices.get_mut(device) {
                    device.start_reception(inputs);
                }
            }
            Order::Begin { device: place, fault } => {
                let Some(device) = self.devices.get_mut(place) else { return };
                if device.begin(fault) {
                    device.watch.begin(now_ns);
                } else {
                    self.report(Report::Happened { device: place, what: DeviceEvent::BootedUp, took_part: true });
                }
            }
        }
    }

    fn begin_transfer(&mut self, node: NodeId, object: Object, data: Vec<u8>, writes: bool, now_ns: u64) {
        let Some(client) = self.clients.get_mut(usize::from(node.get()) - 1) else { return };
        let begun = match writes {
            true => client.download(object, data, true, now_ns),
            // Numbers need one frame in each direction, which every device supports.
            false => client.upload(object, data, false, now_ns),
        };
        match begun {
            Ok(()) => self.busy.push(node),
            // A node has one transfer at a time; the caller has to wait for the present one.
            Err(data) => {
                let result = Err(SdoError::Busy(object));
                self.report(Report::Transfer(node, Transfer { object, data, result }, 0));
            }
        }
    }

    fn dispatch(&mut self, frame: &Frame, now_ns: u64) {
        match self.routes.get(usize::from(frame.id().get())).copied().unwrap_or(Route::Nobody) {
            Route::Nobody => {}
            Route::Pdo { device, place } => {
                if let Some(device) = self.devices.get_mut(usize::from(device)) {
                    device.take_pdo(place.into(), frame);
                }
            }
            Route::Emergency(node) => {
                let Ok(bytes) = <[u8; 8]>::try_from(frame.bytes()) else { return };
                let emergency = Emergency::from_bytes(bytes);
                let device = self.devices.iter_mut().find(|device| device.node == node);
                match device.and_then(|device| device.drive.as_mut()) {
                    Some(drive) => drive.take_emergency(emergency),
                    None => self.report(Report::Emergency(node, emergency)),
                }
            }
            Route::Sdo(node) => {
                let client = self.clients.get_mut(usize::from(node.get()) - 1);
                if let Some(done) = client.and_then(|client| client.receive(frame, now_ns)) {
                    self.end_transfer(node, done, now_ns);
                }
            }
            Route::Life(node) => {
                // Signs of life of nodes outside the cell are ignored.
                let Some(place) = self.devices.iter().position(|device| device.node == node) else { return };
                let happened = self.devices.get_mut(place).and_then(|device| device.watch.handle_frame(frame, now_ns));
                self.happened(place, happened);
            }
        }
    }

    fn happened(&mut self, place: usize, happened: Option<DeviceEvent>) {
        let Some(device) = self.devices.get_mut(place) else { return };
        let takes_part = device.is_ready();
        // A device that takes part must be operational. Another state is reported, also if the device repeats a state from before.
        let astray = || device.watch.state().filter(|state| takes_part && *state != NmtState::Operational);
        let Some(what) = happened.or_else(|| astray().map(DeviceEvent::State)) else { return };
        let stays = matches!(what, DeviceEvent::State(NmtState::Operational) | DeviceEvent::NeverHeard);
        let took_part = takes_part && !stays;
        match what {
            DeviceEvent::BootedUp => device.handle_boot_up(),
            _ if took_part => device.end(),
            _ => {}
        }
        self.report(Report::Happened { device: place, what, took_part });
    }

    fn end_transfer(&mut self, node: NodeId, done: Transfer, now_ns: u64) {
        self.busy.retain(|busy| *busy != node);
        let place = self.devices.iter().position(|device| device.node == node);
        let drive = place.and_then(|place| self.devices.get_mut(place)?.drive.as_mut());
        let outcome = match drive {
            Some(drive) => drive.handle_transfer(done, now_ns),
            None => SdoOutcome::Other(done),
        };
        match (place, outcome) {
            (Some(place), SdoOutcome::HomingRefused(error)) => self.report(Report::HomingRefused(place, error)),
            (Some(place), SdoOutcome::ModeRefused(error)) => self.report(Report::ModeRefused(place, error)),
            (_, SdoOutcome::Other(done)) => {
                let client = self.clients.get(usize::from(node.get()) - 1);
                let strays = client.map_or(0, Client::strays);
                self.report(Report::Transfer(node, done, strays));
            }
            _ => {}
        }
    }

    /// Handles timeouts.
    fn tick(&mut self, now_ns: u64) {
        let mut at = 0;
        while let Some(node) = self.busy.get(at).copied() {
            let client = self.clients.get_mut(usize::from(node.get()) - 1);
            match client.and_then(|client| client.tick(now_ns).map(|done| (client.next_frame(), done))) {
                Some((abort, done)) => {
                    if let Some(frame) = abort {
                        self.send(&frame);
                    }
                    self.end_transfer(node, done, now_ns);
                }
                None => at += 1,
            }
        }
        for place in 0..self.devices.len() {
            let Some(device) = self.devices.get_mut(place) else { continue };
            let (happened, question) = device.watch.tick(now_ns);
            self.tap.tally().set_node_state(place, device.watch.state());
            if let Some(silent) = self.silent.get(place) {
                silent.store(device.watch.is_lost(), Ordering::Relaxed);
            }
            if let Some(question) = question {
                self.send(&question);
            }
            if happened.is_some() {
                self.happened(place, happened);
            }
        }
    }

    /// Starts SDO requests for homing setup, and for modes of drives that cannot map them to a PDO; one request per drive at a time.
    fn ask_by_sdo(&mut self, now_ns: u64) {
        for device in &mut self.devices {
            let Some(client) = self.clients.get_mut(usize::from(device.node.get()) - 1) else { continue };
            if !device.is_ready() || !client.is_idle() {
                continue;
            }
            let Some(drive) = &mut device.drive else { continue };
            let Some(SdoRequest { object, data, writes }) = drive.next_request(now_ns) else { continue };
            let begun = match writes {
                true => client.download(object, data, false, now_ns),
                false => client.upload(object, data, false, now_ns),
            };
            let begun = begun.map_err(|data| drive.return_buffer(object, data));
            if begun.is_ok() {
                self.busy.push(device.node);
            }
        }
    }

    /// Sends the heartbeat of the master, TIME, and up to this number of SDO frames.
    fn send_services(&mut self, now_ns: u64, most: usize) {
        if let Some(Master { node, heartbeat_ns }) = self.master
            && self.beat_ns.is_none_or(|beat| now_ns.saturating_sub(beat) >= heartbeat_ns)
        {
            self.beat_ns = Some(now_ns);
            if let Ok(frame) = Frame::data(node.heartbeat(), &[0x05]) {
                self.send(&frame);
            }
        }
        // Like the clock above, this needs no system call.
        if let Some(frame) = self.time.due(now_ns, || SystemTime::UNIX_EPOCH.elapsed().unwrap_or_default()) {
            self.send(&frame);
        }
        let mut left = most;
        for at in 0..self.busy.len() {
            while left > 0 {
                let client = self.busy.get(at).and_then(|node| self.clients.get_mut(usize::from(node.get()) - 1));
                let Some(frame) = client.and_then(Client::next_frame) else { break };
                self.send(&frame);
                left -= 1;
            }
        }
        // The next cycle starts with the node that had to wait.
        if left == 0 && !self.busy.is_empty() {
            self.busy.rotate_left(1);
        }
        if let Some(Err(error)) = self.transport.as_mut().map(|transport| transport.flush()) {
            lose(&mut self.transport, &mut self.reports, &self.losses, error);
        }
    }
}

/// Returns the destination of each identifier.
fn routes(devices: &[Device]) -> Vec<Route> {
    let mut routes = vec![Route::Nobody; IDS];
    let mut set = |id: crate::Id, route| {
        if let Some(place) = routes.get_mut(usize::from(id.get())) {
            *place = route;
        }
    };
    for node in (1..=NodeId::MAX).filter_map(NodeId::new) {
        set(node.emergency(), Route::Emergency(node));
        set(node.sdo_response(), Route::Sdo(node));
        set(node.heartbeat(), Route::Life(node));
    }
    for (device, of) in devices.iter().enumerate() {
        for (place, id) in of.tpdo_ids().enumerate() {
            // There are at most 127 devices with 4 PDOs.
            set(id, Route::Pdo { device: device as u8, place: place as u8 });
        }
    }
    routes
}

fn push(reports: &mut Producer<Report>, losses: &Losses, report: Report) {
    if reports.push(report).is_err() {
        losses.reports.fetch_add(1, Ordering::Relaxed);
    }
}

fn lose(
    transport: &mut Option<Box<dyn Transport>>,
    reports: &mut Producer<Report>,
    losses: &Losses,
    error: TransportError,
) {
    if let Some(transport) = transport.take() {
        push(reports, losses, Report::Lost(transport, error));
    }
}

fn send(
    transport: &mut Option<Box<dyn Transport>>,
    reports: &mut Producer<Report>,
    (losses, tap): (&Losses, &mut FrameRecorder),
    frame: &Frame,
) {
    match transport.as_mut().map(|transport| transport.send(frame)) {
        None => {}
        Some(Ok(())) => tap.take(frame, true),
        Some(Err(TransportError::Full(_))) => {
            losses.refused.fetch_add(1, Ordering::Relaxed);
        }
        Some(Err(error)) => lose(transport, reports, losses, error),
    }
}

#[cfg(test)]
mod tests;
