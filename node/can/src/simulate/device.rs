//! CANopen device of one simulated drive, without its mechanics.
//!
//! Law      a device boots to pre-operational; PDOs are exchanged only while it is operational. NMT reset node sets all objects to their
//!          power-on values, reset communication those below 2000h. A device that loses its master sends EMCY 8130h and changes its state
//!          according to 1029h. Its drive then reacts according to 6007h if it is not off; so does a drive that is stopped, or whose
//!          communication is reset, by NMT
//! Source   CiA 301 (NMT, EMCY, 1029h), CiA 402-2 (6007h, 6040h, 6041h)

use super::CONNECTION_LOST;
use super::pdo::Pdo;
use super::server::Server;
use super::supervision::Supervision;
use super::table::objects_of;
use crate::config::DeviceConfig;
use crate::{Frame, Id, NmtState, NodeId, can_objects};
use lineshaft_cia402::dictionary::Direction;
use lineshaft_cia402::simulate::objects as simulated;
use lineshaft_cia402::simulate::{ObjectTable, SimulatedDrive};
use lineshaft_core::drive::{Emergency, Inputs, Outputs};
use std::ops::RangeInclusive;
use std::time::Duration;

/// Bit 0 of the error register: generic error.
const GENERIC_ERROR: u8 = 0x01;
/// Bit 4 of the error register: communication error.
const COMMUNICATION_ERROR: u8 = 0x10;
/// Indices of the communication profile (CiA 301).
const COMMUNICATION: RangeInclusive<u16> = 0x1000..=0x1FFF;

/// Returns the error register (1001h) of an error code; code 0: no error.
fn error_register(code: u16) -> u8 {
    match code {
        0 => 0,
        0x8100..=0x81FF => GENERIC_ERROR | COMMUNICATION_ERROR,
        _ => GENERIC_ERROR,
    }
}

/// Returns the NMT state as the byte of a heartbeat.
fn number(state: NmtState) -> u8 {
    match state {
        NmtState::BootUp => 0x00,
        NmtState::Stopped => 0x04,
        NmtState::Operational => 0x05,
        NmtState::PreOperational => 0x7F,
    }
}

/// Simulated drive as a CANopen device.
#[derive(Clone, Debug)]
pub(super) struct Device {
    node: NodeId,
    drive: SimulatedDrive,
    /// Objects after power-on.
    initial: ObjectTable,
    state: NmtState,
    received: Vec<Pdo>,
    sent: Vec<Pdo>,
    server: Server,
    supervision: Supervision,
    /// Whether the loss of the master was reported.
    misses_master: bool,
}

impl Device {
    /// Creates a drive that is switched off and has not booted; `cycle` is the cycle time of its mechanics. `None` if the device is not a
    /// drive.
    pub(super) fn new(config: &DeviceConfig, cycle: Duration) -> Option<Self> {
        let drive = config.drive()?;
        let initial = objects_of(config, drive);
        let terminals = [&config.terminals.digital_inputs, &config.terminals.digital_outputs];
        Some(Self {
            node: config.node,
            drive: SimulatedDrive::new(drive, terminals.map(Vec::as_slice), initial.clone(), cycle),
            initial,
            state: NmtState::BootUp,
            received: Vec::new(),
            sent: Vec::new(),
            server: Server::default(),
            supervision: Supervision::default(),
            misses_master: false,
        })
    }

    /// Returns the place among the drives of the machine.
    pub(super) fn place(&self) -> usize {
        self.drive.place()
    }

    /// Returns the SYNC period (1006h); `None` if it is unknown.
    pub(super) fn sync_period(&self) -> Option<Duration> {
        let us = self.drive.table.get(can_objects::CYCLE_PERIOD);
        (us > 0).then_some(Duration::from_micros(us.into()))
    }

    /// Returns true once when the drive has to report a fault because it has lost its master.
    pub(super) fn take_master_loss(&mut self) -> bool {
        self.drive.take_connection_loss()
    }

    /// Boots: sends the boot-up message and changes to pre-operational.
    pub(super) fn boot(&mut self, out: &mut Vec<Frame>) {
        self.state = NmtState::BootUp;
        self.send_state(0, out);
        self.state = NmtState::PreOperational;
    }

    /// Sets the objects of these indices to their power-on values, and boots.
    fn reset(&mut self, indices: &RangeInclusive<u16>, out: &mut Vec<Frame>) {
        self.drive.table.restore(&self.initial, indices);
        self.received.clear();
        self.sent.clear();
        (self.server, self.supervision) = (Server::default(), Supervision::default());
        if std::mem::take(&mut self.misses_master) && self.drive.fault() == 0 {
            self.drive.table.set(simulated::ERROR_REGISTER, 0);
        }
        self.boot(out);
    }

    /// Sends the state in one byte, with the toggle bit of node guarding.
    fn send_state(&self, toggle: u8, out: &mut Vec<Frame>) {
        out.extend(Frame::data(self.node.heartbeat(), &[number(self.state) | toggle]));
    }

    /// Handles any frame except SYNC.
    pub(super) fn take(&mut self, frame: &Frame, now: Duration, out: &mut Vec<Frame>) {
        let id = frame.id();
        if frame.is_remote() {
            if id == self.node.heartbeat()
                && let Some(toggle) = self.supervision.guard(&self.drive.table, now)
            {
                self.send_state(toggle, out);
                self.handle_master_return(out);
            }
        } else if id == Id::NMT {
            if let &[command, node, ..] = frame.bytes()
                && (node == 0 || node == self.node.get())
            {
                self.change_state(command, out);
            }
        } else if id == self.node.sdo_request() {
            self.serve(frame, now, out);
        } else if self.supervision.is_monitored_heartbeat(id, &self.drive.table, now) {
            self.handle_master_return(out);
        } else if self.state == NmtState::Operational
            && let Some(pdo) = self.received.iter_mut().find(|pdo| pdo.id == id)
        {
            pdo.receive(frame, &mut self.drive.table);
        }
    }

    fn change_state(&mut self, command: u8, out: &mut Vec<Frame>) {
        match command {
            0x01 => {
                self.state = NmtState::Operational;
                self.load_pdos();
                self.send_changes(out);
            }
            0x02 => {
                self.state = NmtState::Stopped;
                self.drive.abort_connection();
            }
            0x80 => self.state = NmtState::PreOperational,
            0x81 => self.reset(&(0..=u16::MAX), out),
            0x82 => {
                self.drive.abort_connection();
                self.reset(&COMMUNICATION, out);
            }
            _ => {}
        }
    }

    fn load_pdos(&mut self) {
        self.received = Pdo::all(&self.drive.table, Direction::Receive);
        self.sent = Pdo::all(&self.drive.table, Direction::Transmit);
    }

    fn serve(&mut self, request: &Frame, now: Duration, out: &mut Vec<Frame>) {
        if !matches!(self.state, NmtState::PreOperational | NmtState::Operational) {
            return;
        }
        let response = self.node.sdo_response();
        let Some((frame, written)) = self.server.answer(&mut self.drive.table, request, response) else { return };
        out.push(frame);
        if let Some(object) = written {
            self.supervision.update_deadlines(object, &self.drive.table, now);
            if (0x1400..=0x1BFF).contains(&object.index) && self.state == NmtState::Operational {
                self.load_pdos();
            }
        }
    }

    /// Sends heartbeats, checks timeouts, and sends changed PDOs.
    pub(super) fn tick(&mut self, now: Duration, out: &mut Vec<Frame>) {
        if self.supervision.is_due(&self.drive.table, now) {
            self.send_state(0, out);
        }
        if self.supervision.has_lost_master(now) {
            self.handle_master_loss(out);
        }
    }

    /// Handles the loss of the master.
    fn handle_master_loss(&mut self, out: &mut Vec<Frame>) {
        self.misses_master = true;
        self.drive.abort_connection();
        if self.drive.is_lost() {
            self.drive.set_fault(CONNECTION_LOST);
        }
        self.send_emergency(CONNECTION_LOST, out);
        match self.drive.table.get(can_objects::ERROR_BEHAVIOUR) {
            0 if self.state == NmtState::Operational => self.state = NmtState::PreOperational,
            2 => self.state = NmtState::Stopped,
            _ => {}
        }
    }

    /// Handles the return of the master.
    fn handle_master_return(&mut self, out: &mut Vec<Frame>) {
        if std::mem::take(&mut self.misses_master) && self.drive.fault() == 0 {
            self.send_emergency(0, out);
        }
    }

    /// Updates the objects from the state of the mechanics.
    pub(super) fn update_objects(&mut self, inputs: &Inputs, out: &mut Vec<Frame>) {
        let Some(has_other_fault) = self.drive.update_objects(inputs) else { return };
        if has_other_fault {
            self.send_emergency(self.drive.fault(), out);
        }
        self.send_changes(out);
    }

    /// Sets the error register and sends EMCY; code 0: the error has ended.
    fn send_emergency(&mut self, code: u16, out: &mut Vec<Frame>) {
        let register = error_register(code);
        self.drive.table.set(simulated::ERROR_REGISTER, register.into());
        if matches!(self.state, NmtState::PreOperational | NmtState::Operational) {
            let emergency = Emergency { code, register, data: [0; 5] };
            out.push(Frame::of(self.node.emergency(), emergency.to_bytes()));
        }
    }

    fn send_changes(&mut self, out: &mut Vec<Frame>) {
        if self.state == NmtState::Operational {
            out.extend(self.sent.iter_mut().filter_map(|pdo| pdo.on_change(&self.drive.table)));
        }
    }

    /// Handles SYNC after the mechanics have moved: sends PDOs, then applies the PDOs received before.
    pub(super) fn synchronize(&mut self, out: &mut Vec<Frame>) {
        if self.state == NmtState::Operational {
            out.extend(self.sent.iter_mut().filter_map(|pdo| pdo.with_sync(&self.drive.table)));
            for pdo in &mut self.received {
                pdo.apply_pending(&mut self.drive.table);
            }
        }
    }

    /// Runs one cycle of the mode of operation: writes the commands of the objects to the outputs of the machine.
    pub(super) fn run_mode(&mut self, inputs: &Inputs, outputs: &mut Outputs) {
        self.drive.run_mode(inputs, outputs);
    }
}

#[cfg(test)]
mod tests;
