//! Service half of the master: opens the transport, configures devices, and recovers lost ones.
//!
//! Law      a device that is missing at the start, or is lost, is configured as soon as it answers; a drive stays off until it is enabled
//!          again. The same applies to all devices after a lost bus connection
//! Refuses  to start if the transport cannot be opened, or if a device is present that differs from the cell
//! Source   CiA 301, CiA 302-2; MACS-CAN-04, MACS-CAN-06

use super::asked::{SdoRequestQueue, SdoRequestReceiver, line};
use super::backend::CanBackend;
use super::bus::{Bus, Losses, Report};
use super::capture::RecordedFrames;
use super::configure::{self, Configured, Refusal};
use super::notes::{ForeignEmergencies, Notes};
use super::port::Port;
use super::tally::{BusCounters, BusLoadMeter};
use crate::commission::words::nmt_state;
use crate::config::{BusConfig, DeviceConfig, Role};
use crate::load::Load;
use crate::transport::{self, Options};
use crate::{DeviceEvent, NmtState, NodeId};
use lineshaft_core::code::Code;
use lineshaft_core::drive::{Emergency, ForeignEmergency, Health, NodeChange, NodeNotice, Service, ServiceError};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Time between two attempts to reach a missing device.
const RETRY: Duration = Duration::from_secs(1);
/// First and longest time between two attempts to open a lost bus connection.
const BACK_OFF: (Duration, Duration) = (Duration::from_millis(250), Duration::from_secs(5));

/// Time for which a bus that refused a frame is reported as full.
const FULL: Duration = Duration::from_secs(5);

/// State of a device in the service.
#[derive(Clone, Debug)]
struct DeviceState {
    /// Reason why the device takes no part in the cycles.
    problem: Option<String>,
    /// Time of the next attempt.
    due: Instant,
    is_configured: bool,
}

/// Opens, closes and supervises a bus.
pub struct CanService {
    config: BusConfig,
    port: Port,
    devices: Vec<DeviceState>,
    /// Reason why the bus connection is lost, time of the next attempt, and time between two attempts.
    lost: Option<(String, Instant, Duration)>,
    /// Time when the connection was last opened again, and the time between attempts before that.
    reopened: Option<(Instant, Duration)>,
    foreign: ForeignEmergencies,
    notes: Notes,
    losses: Arc<Losses>,
    tally: Arc<BusCounters>,
    meter: BusLoadMeter,
    /// Maximum load of each cycle according to the cell.
    load: Option<Load>,
    /// Queue for SDO requests of other clients, with its receiving end.
    asked: (SdoRequestQueue, SdoRequestReceiver),
    /// Number of refused frames at the last check, and the time when it last increased.
    refused: (u64, Option<Instant>),
}

/// Creates the two halves of a bus.
pub fn bus(config: BusConfig) -> (CanBackend, CanService) {
    let port = Port::new(|(orders, reports)| Bus::new(&config, orders, reports));
    let backend = CanBackend::new(&config, port.bus());
    let losses = port.lock().losses();
    let tally = port.lock().tally();
    let (meter, load) = (BusLoadMeter::new(), Load::of(&config));
    let known = DeviceState { problem: None, due: Instant::now(), is_configured: false };
    let devices = vec![known; config.devices.len()];
    let service = CanService {
        config,
        port,
        devices,
        lost: None,
        reopened: None,
        foreign: ForeignEmergencies::default(),
        notes: Notes::default(),
        losses,
        tally,
        meter,
        load,
        asked: line(),
        refused: (0, None),
    };
    (backend, service)
}

impl CanService {
    /// Returns the queue for SDO requests to the nodes while cycles run.
    pub fn objects(&self) -> SdoRequestQueue {
        self.asked.0.clone()
    }

    /// Starts to record the frames of the bus; must be called before the start.
    pub fn frames(&mut self) -> RecordedFrames {
        self.port.lock().frames()
    }

    fn serve_requests(&mut self) {
        let lost = self.lost.as_ref().map(|(why, ..)| why.as_str());
        self.asked.1.serve(&mut self.port, lost);
    }

    fn error(&self, problem: impl Into<String>) -> ServiceError {
        ServiceError { backend: self.config.name.clone(), problem: problem.into() }
    }

    fn open(&self) -> Result<Box<dyn transport::Transport>, String> {
        let BusConfig { bit_rate, serial_baudrate: baud, .. } = self.config;
        let options = Options { bit_rate: bit_rate.unwrap_or_default(), baud };
        transport::open(&self.config.transport, options).map_err(|error| error.to_string())
    }

    /// Returns a device as text.
    fn device_name(&self, place: usize) -> String {
        self.config.devices.get(place).map_or_else(String::new, DeviceConfig::to_string)
    }

    /// Configures a device and adds it to the cycles.
    fn configure(&mut self, place: usize) -> Result<Configured, Refusal> {
        let Some(device) = self.config.devices.get(place) else { return Ok(Configured::default()) };
        let begin = Instant::now();
        let done = configure::configure(&mut self.port, place, &self.config, device);
        if let Ok(configured) = done {
            configure::begin(&mut self.port, place, configured);
            let (ms, name) = (begin.elapsed().as_millis(), self.device_name(place));
            tracing::info!("{}: {name}: ready after {ms} ms, {} objects written", self.config.name, configured.written);
            self.note(place, NodeChange::Ready);
        }
        // If the cycles have ended meanwhile, the state of the device is kept.
        let is_dead = self.port.is_dead();
        if let Some(known) = self.devices.get_mut(place).filter(|_| !is_dead) {
            known.problem = done.as_ref().err().map(Refusal::to_string);
            known.is_configured = done.is_ok();
            known.due = Instant::now() + RETRY;
        }
        done
    }

    /// Handles the reports of the bus.
    fn handle_reports(&mut self) {
        while let Some(report) = self.port.report() {
            match report {
                Report::Happened { device, what, took_part } => self.happened(device, what, took_part),
                Report::HomingRefused(place, error) => {
                    tracing::error!("{}: {}: homing is not set up: {error}", self.config.name, self.device_name(place));
                }
                Report::ModeRefused(place, error) => {
                    let name = self.device_name(place);
                    tracing::error!("{}: {name}: its mode of operation is not confirmed: {error}", self.config.name);
                }
                Report::Lost(transport, error) => {
                    // Closing may block, so it is not done in the cycle.
                    drop(transport);
                    // An intermittent connection must not be opened and reported several times a second.
                    let again = self.reopened.filter(|(since, _)| since.elapsed() < BACK_OFF.1);
                    let wait = again.map_or(BACK_OFF.0, |(_, wait)| (wait * 2).min(BACK_OFF.1));
                    self.lost = Some((error.to_string(), Instant::now() + wait, wait));
                    self.lose_all("the way to the bus is lost");
                }
                Report::Emergency(node, emergency) => self.report_emergency(node, emergency),
                // Result of a transfer that was abandoned.
                Report::Transfer(..) => {}
            }
        }
    }

    /// Handles an emergency message of a node that is not a drive of the cell.
    fn report_emergency(&mut self, node: NodeId, emergency: Emergency) {
        if self.foreign.is_reported(node.get(), emergency.code, Instant::now()) {
            let message = ForeignEmergency::new(node.get(), emergency);
            self.notes.add(Code::FOREIGN_EMERGENCY, message.to_number());
        }
    }

    /// Adds a note about a change of a node.
    fn note(&mut self, place: usize, change: NodeChange) {
        let Some(device) = self.config.devices.get(place) else { return };
        let axis = device.drive().map(|drive| drive.object);
        let notice = NodeNotice { axis, node: device.node.get(), change };
        self.notes.add(Code::NODE_CHANGED, notice.to_number());
    }

    fn lose_all(&mut self, why: &str) {
        for known in &mut self.devices {
            (known.problem, known.is_configured) = (Some(why.to_owned()), false);
        }
    }

    fn happened(&mut self, place: usize, what: DeviceEvent, took_part: bool) {
        let change = match what {
            DeviceEvent::BootedUp => NodeChange::Booted,
            DeviceEvent::Lost => NodeChange::Silent,
            DeviceEvent::NeverHeard => NodeChange::Unwatched,
            DeviceEvent::Back(_) | DeviceEvent::State(NmtState::Operational) => NodeChange::Back,
            DeviceEvent::State(NmtState::Stopped) => NodeChange::Stopped,
            DeviceEvent::State(_) => NodeChange::Left,
        };
        if took_part || matches!(what, DeviceEvent::BootedUp | DeviceEvent::NeverHeard) {
            self.note(place, change);
        }
        let Some(known) = self.devices.get_mut(place) else { return };
        if took_part {
            (known.problem, known.is_configured) = (Some(change.text().to_owned()), false);
        }
        // A device that sends a sign of life is configured at once.
        if !known.is_configured && !matches!(what, DeviceEvent::Lost | DeviceEvent::NeverHeard) {
            known.due = Instant::now();
        }
    }

    /// Tries to open a lost bus connection.
    fn reopen(&mut self) {
        let Some((_, due, wait)) = self.lost.clone() else { return };
        if Instant::now() < due {
            return;
        }
        match self.open() {
            Ok(transport) => {
                tracing::info!("{}: {} is open again", self.config.name, self.config.transport);
                self.lost = None;
                self.port.order(super::bus::Order::Open(transport));
                let now = Instant::now();
                self.reopened = Some((now, wait));
                self.devices.iter_mut().for_each(|known| known.due = now);
            }
            Err(error) => {
                let wait = (wait * 2).min(BACK_OFF.1);
                self.lost = Some((error, Instant::now() + wait, wait));
            }
        }
    }

    /// Returns the NMT states of the devices as text.
    fn nodes(&self) -> String {
        let of = |place: usize| {
            let state = match self.tally.node(place) {
                Some(state) => nmt_state(state),
                None if self.port.is_silent(place) => "silent",
                None => "not heard yet",
            };
            format!("{}: {state}", self.device_name(place))
        };
        (0..self.devices.len()).map(of).collect::<Vec<_>>().join(", ")
    }

    /// Returns the problems, the number and state of the devices that take part, the bus load, and the losses.
    fn health(&mut self) -> Health {
        let ready = self.devices.iter().filter(|known| known.is_configured).count();
        let of = |counter: &AtomicU64| counter.load(Ordering::Relaxed);
        let refused = of(&self.losses.refused);
        if refused != std::mem::replace(&mut self.refused.0, refused) {
            self.refused.1 = Some(Instant::now());
        }
        let [measured, computed, frames] =
            self.meter.look(&self.tally, Instant::now(), self.config.bit_rate, self.load);
        let values = vec![
            ("devices in operation", format!("{ready} of {}", self.devices.len())),
            ("NMT states", self.nodes()),
            ("controller", self.tally.controller()),
            measured,
            computed,
            frames,
            ("frames without room", refused.to_string()),
            ("faults of the way", of(&self.losses.faults).to_string()),
            ("reports without room", of(&self.losses.reports).to_string()),
            ("frames missing in recordings", self.tally.missed().to_string()),
        ];
        if let Some((problem, ..)) = &self.lost {
            return Health { problems: vec![problem.clone()], values, notes: self.notes.take() };
        }
        let of = |(place, known): (usize, &DeviceState)| {
            known.problem.as_ref().map(|problem| format!("{}: {problem}", self.device_name(place)))
        };
        let mut problems: Vec<_> = self.devices.iter().enumerate().filter_map(of).collect();
        // Reported for some time after the last refused frame, instead of a log line for each.
        if self.refused.1.is_some_and(|seen| seen.elapsed() < FULL) {
            problems.push("the bus, or what is before it, takes no more frames: some were not sent".to_owned());
        }
        Health { problems, values, notes: self.notes.take() }
    }
}

impl Service for CanService {
    fn start(&mut self) -> Result<(), ServiceError> {
        let transport = self.open().map_err(|error| self.error(error))?;
        self.lost = None;
        self.port.set_in_cycles(false);
        self.port.lock().open(transport);
        for place in 0..self.devices.len() {
            match self.configure(place) {
                Ok(_) => {}
                // The device is configured when it appears.
                Err(Refusal::Absent(_) | Refusal::NoLife) if self.lost.is_none() => {}
                Err(refusal) => {
                    let error = self.error(format!("{}: {refusal}", self.device_name(place)));
                    self.stop();
                    return Err(error);
                }
            }
        }
        self.port.step();
        self.handle_reports();
        self.meter.restart(&self.tally, Instant::now());
        Ok(())
    }

    fn name(&self) -> &str {
        &self.config.name
    }

    fn hardware(&self) -> String {
        self.config.transport.to_string()
    }

    fn poll_without_cycle(&mut self) {
        self.port.set_in_cycles(false);
        self.port.step();
    }

    fn health_check(&mut self) -> Health {
        self.port.set_in_cycles(true);
        self.handle_reports();
        self.reopen();
        self.serve_requests();
        if self.lost.is_none() {
            for place in 0..self.devices.len() {
                // The cycles have ended: stop() follows, and need not wait for the other devices. If the program was only suspended, the
                // next call continues.
                if self.port.take_have_cycles_ended() {
                    break;
                }
                let is_due = |known: &DeviceState| !known.is_configured && Instant::now() >= known.due;
                if self.devices.get(place).is_some_and(is_due) {
                    // The problem is stored with those of the other devices.
                    let _ = self.configure(place);
                    self.handle_reports();
                    self.serve_requests();
                }
            }
        }
        self.health()
    }

    fn stop(&mut self) {
        self.asked.1.reject_all();
        self.port.set_in_cycles(false);
        self.port.lock().remove_devices();
        for place in 0..self.devices.len() {
            let is_configured = self.devices.get(place).is_some_and(|known| known.is_configured);
            let Some(device) = self.config.devices.get(place).filter(|_| is_configured) else {
                continue;
            };
            let is_off = match device.role {
                Role::Drive(_) => configure::stop_and_disable(&mut self.port, device.node),
                Role::Module => configure::switch_off_outputs(&mut self.port, device),
                Role::Encoder => Ok(()),
            };
            if let Err(refusal) = is_off {
                let what = if device.drive().is_some() { "it may run" } else { "its outputs may be on" };
                tracing::warn!("{}: {device}: {what}: {refusal}", self.config.name);
            }
            configure::release(&mut self.port, &self.config, device);
        }
        self.port.step();
        self.port.lock().close();
        self.handle_reports();
        self.lost = None;
        self.devices.iter_mut().for_each(|known| known.is_configured = false);
    }
}
