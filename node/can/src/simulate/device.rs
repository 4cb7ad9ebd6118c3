//! One simulated drive as a device of CANopen; its mechanics are elsewhere.
//!
//! Law      a device boots into pre-operational; PDOs go only while it is operational. One that loses its master, by 1016h or by NMT stop, has
//!          a fault if it is not off
//! Source   CiA 301 (NMT, heartbeat, guarding, EMCY), CiA 402-2 (6040h, 6041h)

use super::modes::{Modes, units};
use super::objects as simulated;
use super::pdo::Pdo;
use super::server;
use super::table::Table;
use crate::config::{DeviceConfig, Terminals, VelocityFactor};
use crate::drive::objects;
use crate::eds::Direction;
use crate::sdo::Object;
use crate::{Frame, Id, NmtState, NodeId};
use lineshaft_core::drive::{DriveState, Emergency, Inputs, Outputs};
use std::time::Duration;

/// Status word bit 9: the drive takes what comes over the bus.
const STATUS_REMOTE: u16 = 0x0200;
/// Bit 0 of the error register: any error.
const GENERIC_ERROR: u8 = 0x01;

/// The state that a device shows, as one byte.
fn number(state: NmtState) -> u8 {
    match state {
        NmtState::BootUp => 0x00,
        NmtState::Stopped => 0x04,
        NmtState::Operational => 0x05,
        NmtState::PreOperational => 0x7F,
    }
}

/// A drive.
#[derive(Clone, Debug)]
pub(super) struct Device {
    node: NodeId,
    /// Its place among the drives of the machine.
    place: usize,
    velocity: VelocityFactor,
    terminals: Terminals,
    /// Time of a cycle of the mechanics (s).
    cycle_s: f64,
    modes: Modes,
    /// Its objects after power-on.
    initial: Table,
    table: Table,
    state: NmtState,
    received: Vec<Pdo>,
    sent: Vec<Pdo>,
    next_heartbeat: Option<Duration>,
    /// Until when the master must be heard again; none before it is heard.
    master_until: Option<Duration>,
    guard_toggle: bool,
    fault: u16,
    is_lost: bool,
}

impl Device {
    /// A drive that is switched off and waits to boot, with mechanics of that cycle; none if the device is no drive.
    pub(super) fn new(config: &DeviceConfig, cycle: Duration) -> Option<Self> {
        let drive = config.drive()?;
        let initial = Table::new(config, drive);
        Some(Self {
            node: config.node,
            place: drive.place,
            velocity: drive.velocity,
            terminals: config.terminals.clone(),
            cycle_s: cycle.as_secs_f64(),
            modes: Modes::default(),
            table: initial.clone(),
            initial,
            state: NmtState::BootUp,
            received: Vec::new(),
            sent: Vec::new(),
            next_heartbeat: None,
            master_until: None,
            guard_toggle: false,
            fault: 0,
            is_lost: false,
        })
    }

    /// Its place among the drives of the machine.
    pub(super) fn place(&self) -> usize {
        self.place
    }

    /// Returns true once after the drive has lost its master while it was not off.
    pub(super) fn take_loss(&mut self) -> bool {
        std::mem::take(&mut self.is_lost)
    }

    /// Boots: sends the boot-up message and is pre-operational.
    pub(super) fn boot(&mut self, out: &mut Vec<Frame>) {
        self.state = NmtState::BootUp;
        self.send_state(0, out);
        self.state = NmtState::PreOperational;
    }

    /// All objects that are set by the bus have their values after power-on again; those that show the drive stay.
    fn reset(&mut self, out: &mut Vec<Frame>) {
        let shown = [
            objects::STATUS_WORD,
            objects::MODE_DISPLAY,
            objects::POSITION,
            objects::VELOCITY,
            objects::TORQUE,
            objects::ERROR_CODE,
            objects::DIGITAL_INPUTS,
            simulated::ERROR_REGISTER,
        ];
        let before = std::mem::replace(&mut self.table, self.initial.clone());
        for object in shown {
            self.table.put(object, before.get(object));
        }
        self.received.clear();
        self.sent.clear();
        (self.next_heartbeat, self.master_until, self.guard_toggle) = (None, None, false);
        self.boot(out);
    }

    /// One byte: the state, with the toggle bit of guarding.
    fn send_state(&self, toggle: u8, out: &mut Vec<Frame>) {
        out.extend(Frame::data(self.node.heartbeat(), &[number(self.state) | toggle]));
    }

    /// Receives anything but SYNC.
    pub(super) fn take(&mut self, frame: &Frame, now: Duration, out: &mut Vec<Frame>) {
        let id = frame.id();
        if frame.is_remote() {
            if id == self.node.heartbeat() && self.table.get(objects::PRODUCER_HEARTBEAT) == 0 {
                self.send_state(if self.guard_toggle { 0x80 } else { 0 }, out);
                self.guard_toggle = !self.guard_toggle;
            }
        } else if id == Id::NMT {
            if let &[command, node, ..] = frame.bytes()
                && (node == 0 || node == self.node.get())
            {
                self.change_state(command, out);
            }
        } else if id == self.node.sdo_request() {
            self.serve(frame, now, out);
        } else if let Some((master, limit)) = self.consumed()
            && id == master
        {
            self.master_until = Some(now + limit);
        } else if self.state == NmtState::Operational
            && let Some(pdo) = self.received.iter_mut().find(|pdo| pdo.id == id)
        {
            pdo.receive(frame, &mut self.table);
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
                self.lose_master();
            }
            0x80 => self.state = NmtState::PreOperational,
            0x81 | 0x82 => self.reset(out),
            _ => {}
        }
    }

    fn load_pdos(&mut self) {
        self.received = Pdo::all(&self.table, Direction::Receive);
        self.sent = Pdo::all(&self.table, Direction::Transmit);
    }

    fn serve(&mut self, request: &Frame, now: Duration, out: &mut Vec<Frame>) {
        if !matches!(self.state, NmtState::PreOperational | NmtState::Operational) {
            return;
        }
        let Some((frame, written)) = server::answer(&mut self.table, request, self.node.sdo_response()) else { return };
        out.push(frame);
        match written {
            Some(objects::PRODUCER_HEARTBEAT) => self.next_heartbeat = self.heartbeat().map(|time| now + time),
            Some(objects::CONSUMER_HEARTBEAT) => self.master_until = None,
            Some(Object { index: 0x1400..=0x1BFF, .. }) if self.state == NmtState::Operational => self.load_pdos(),
            _ => {}
        }
    }

    /// From one of its heartbeats to the next; none if it has none.
    fn heartbeat(&self) -> Option<Duration> {
        let ms = self.table.get(objects::PRODUCER_HEARTBEAT);
        (ms > 0).then_some(Duration::from_millis(ms.into()))
    }

    /// The identifier of the heartbeat that it watches, and within which time that must come (1016h); none if it watches none.
    fn consumed(&self) -> Option<(Id, Duration)> {
        let [low, high, node, _] = self.table.get(objects::CONSUMER_HEARTBEAT).to_le_bytes();
        let ms = u16::from_le_bytes([low, high]);
        let node = NodeId::new(node).filter(|_| ms > 0)?;
        Some((node.heartbeat(), Duration::from_millis(ms.into())))
    }

    /// Does what is due.
    pub(super) fn tick(&mut self, now: Duration, out: &mut Vec<Frame>) {
        if let (Some(due), Some(time)) = (self.next_heartbeat, self.heartbeat())
            && now >= due
        {
            self.send_state(0, out);
            // One that is late is not made up for.
            let next = due + time;
            self.next_heartbeat = Some(if next > now { next } else { now + time });
        }
        if self.master_until.is_some_and(|until| now >= until) {
            self.master_until = None;
            self.lose_master();
        }
    }

    fn lose_master(&mut self) {
        let state = DriveState::from_status(self.table.get(objects::STATUS_WORD) as u16);
        self.is_lost |=
            matches!(state, DriveState::Ready | DriveState::SwitchedOn | DriveState::Enabled | DriveState::QuickStop);
    }

    /// Shows what the mechanics have done.
    pub(super) fn show(&mut self, inputs: &Inputs, out: &mut Vec<Frame>) {
        let Some(drive) = inputs.drive.get(self.place) else { return };
        let terminals = self.terminals.digital_inputs.iter().filter(|terminal| inputs.digital(terminal.place));
        let terminals = terminals.fold(0, |bits, terminal| bits | 1_u32.unbounded_shl(terminal.address.into()));
        let velocity = self.velocity.to_drive(drive.velocity).clamp(i32::MIN.into(), i32::MAX.into());
        let table = &mut self.table;
        let status = drive.status | STATUS_REMOTE | self.modes.status(drive.status);
        table.put(objects::STATUS_WORD, status.into());
        table.put(objects::MODE_DISPLAY, self.modes.shown(drive.mode).cast_unsigned().into());
        // 32 bits, which wrap.
        table.put(objects::POSITION, drive.count as u32);
        table.put(objects::VELOCITY, velocity as u32);
        table.put(simulated::VL_DEMAND, self.modes.vl_demand(self.velocity).cast_unsigned().into());
        table.put(simulated::VL_ACTUAL, units(self.velocity, drive.velocity).cast_unsigned().into());
        table.put(objects::TORQUE, (drive.effort.round() as i16).cast_unsigned().into());
        table.put(objects::DIGITAL_INPUTS, drive.inputs | terminals);
        if drive.fault != self.fault {
            self.fault = drive.fault;
            self.send_fault(out);
        }
        self.send_changes(out);
    }

    /// Error code, error register and EMCY; code 0: no error any more.
    fn send_fault(&mut self, out: &mut Vec<Frame>) {
        let register = if self.fault == 0 { 0 } else { GENERIC_ERROR };
        self.table.put(objects::ERROR_CODE, self.fault.into());
        self.table.put(simulated::ERROR_REGISTER, register.into());
        if matches!(self.state, NmtState::PreOperational | NmtState::Operational) {
            let emergency = Emergency { code: self.fault, register, data: [0; 5] };
            out.push(Frame::of(self.node.emergency(), emergency.to_bytes()));
        }
    }

    fn send_changes(&mut self, out: &mut Vec<Frame>) {
        if self.state == NmtState::Operational {
            out.extend(self.sent.iter_mut().filter_map(|pdo| pdo.on_change(&self.table)));
        }
    }

    /// SYNC, after the mechanics have moved: sends its PDOs, then applies what it has received before.
    pub(super) fn synchronize(&mut self, out: &mut Vec<Frame>) {
        if self.state == NmtState::Operational {
            out.extend(self.sent.iter_mut().filter_map(|pdo| pdo.with_sync(&self.table)));
            for pdo in &mut self.received {
                pdo.apply_pending(&mut self.table);
            }
        }
    }

    /// One cycle of its mode: writes what its objects command to the outputs of the machine.
    pub(super) fn order(&mut self, inputs: &Inputs, outputs: &mut Outputs) {
        let drive = inputs.drive.get(self.place).copied().unwrap_or_default();
        let asked = self.modes.step(&self.table, self.velocity, &drive, self.cycle_s);
        if let Some(output) = outputs.drive.get_mut(self.place) {
            *output = asked;
        }
        let levels = self.table.get(objects::DIGITAL_OUTPUTS) & self.table.get(objects::DIGITAL_OUTPUT_MASK);
        for terminal in &self.terminals.digital_outputs {
            outputs.set_digital(terminal.place, levels.unbounded_shr(terminal.address.into()) & 1 == 1);
        }
    }
}

#[cfg(test)]
mod tests;
