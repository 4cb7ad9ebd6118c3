//! One simulated drive as a device of CANopen; its mechanics are elsewhere.
//!
//! Law      a device boots into pre-operational; PDOs go only while it is operational. One that loses its master, by 1016h or by NMT stop, has
//!          a fault if it is not off
//! Source   CiA 301 (NMT, heartbeat, guarding, EMCY), CiA 402-2 (6040h, 6041h, 6060h, modes csp, csv, cst, homing)

use super::pdo::Pdo;
use super::server;
use super::table::{ERROR_REGISTER, Table};
use crate::config::{DeviceConfig, Terminals, VelocityFactor};
use crate::drive::objects;
use crate::eds::Direction;
use crate::sdo::Object;
use crate::{Frame, Id, NmtState, NodeId};
use lineshaft_core::drive::{
    DriveInput, DriveOutput, DriveState, Emergency, HomingOrder, Inputs, MODE_CSP, MODE_CST, MODE_CSV, MODE_HOMING,
    Mode, Outputs,
};
use std::time::Duration;

/// Status word bit 9: the drive takes what comes over the bus.
const STATUS_REMOTE: u16 = 0x0200;
/// Status word bit 12 in cyclic modes: the drive follows its setpoint.
const STATUS_FOLLOWS: u16 = 0x1000;
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
    /// A drive that is switched off and waits to boot; none if the device is no drive.
    pub(super) fn new(config: &DeviceConfig) -> Option<Self> {
        let drive = config.drive()?;
        let initial = Table::new(config, drive);
        Some(Self {
            node: config.node,
            place: drive.place,
            velocity: drive.velocity,
            terminals: config.terminals.clone(),
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
            ERROR_REGISTER,
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
        table.put(objects::STATUS_WORD, status(drive).into());
        table.put(objects::MODE_DISPLAY, drive.mode.cast_unsigned().into());
        // 32 bits, which wrap.
        table.put(objects::POSITION, drive.count as u32);
        table.put(objects::VELOCITY, velocity as u32);
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
        self.table.put(ERROR_REGISTER, register.into());
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

    /// Writes what its objects command to the outputs of the machine.
    pub(super) fn order(&self, inputs: &Inputs, outputs: &mut Outputs) {
        let count = inputs.drive.get(self.place).map_or(0, |drive| drive.count);
        let mode = self.mode();
        // The target nearest to where it is: its 32 bits wrap.
        let distance = self.table.signed(objects::TARGET_POSITION).wrapping_sub(count as i32);
        let distance = if mode == Mode::None { 0 } else { distance };
        if let Some(output) = outputs.drive.get_mut(self.place) {
            *output = DriveOutput {
                position: count.wrapping_add(distance.into()),
                velocity: self.per_second(self.table.signed(objects::TARGET_VELOCITY).into()),
                acceleration: 0.0,
                effort: self.table.signed(objects::TARGET_TORQUE).into(),
                control: self.table.get(objects::CONTROL_WORD) as u16,
                mode,
            };
        }
        let levels = self.table.get(objects::DIGITAL_OUTPUTS) & self.table.get(objects::DIGITAL_OUTPUT_MASK);
        for terminal in &self.terminals.digital_outputs {
            outputs.set_digital(terminal.place, levels.unbounded_shr(terminal.address.into()) & 1 == 1);
        }
    }

    /// Its mode of operation (6060h); none for numbers that are no mode here.
    fn mode(&self) -> Mode {
        match self.table.signed(objects::MODE) as i8 {
            MODE_CSP => Mode::Position,
            MODE_CSV => Mode::Velocity,
            MODE_CST => Mode::Torque,
            MODE_HOMING => Mode::Homing(HomingOrder {
                method: self.table.signed(objects::HOMING_METHOD) as i8,
                search_velocity: self.per_second(self.table.get(objects::HOMING_SEARCH).into()),
                zero_velocity: self.per_second(self.table.get(objects::HOMING_ZERO).into()),
                acceleration: self.per_second(self.table.get(objects::HOMING_ACCELERATION).into()),
            }),
            _ => Mode::None,
        }
    }

    /// Counts per second of a velocity in units of the drive.
    fn per_second(&self, units: f64) -> f64 {
        units * f64::from(self.velocity.denominator) / f64::from(self.velocity.numerator)
    }
}

/// The status word, with the bits that a drive on a bus has.
fn status(drive: &DriveInput) -> u16 {
    let is_cyclic = [MODE_CSP, MODE_CSV, MODE_CST].contains(&drive.mode);
    let follows = is_cyclic && DriveState::from_status(drive.status) == DriveState::Enabled;
    drive.status | STATUS_REMOTE | if follows { STATUS_FOLLOWS } else { 0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{NmtCommand, Watching};

    const MASTER: NodeId = NodeId::new(127).expect("a node");

    fn node() -> NodeId {
        NodeId::new(3).unwrap()
    }

    /// A drive that has booted.
    fn device() -> Device {
        let mut device = Device::new(&DeviceConfig::plain_drive(0, node(), Watching::None)).unwrap();
        let mut out = Vec::new();
        device.boot(&mut out);
        assert_eq!(out, [Frame::data(node().heartbeat(), &[0]).unwrap()]);
        device
    }

    fn ms(number: u64) -> Duration {
        Duration::from_millis(number)
    }

    /// Writes an object of 1, 2 or 4 bytes.
    fn write(device: &mut Device, object: Object, data: &[u8], now: Duration) {
        let [low, high] = object.index.to_le_bytes();
        let mut request = [0x23 | (4 - data.len() as u8) << 2, low, high, object.sub, 0, 0, 0, 0];
        request[4..4 + data.len()].copy_from_slice(data);
        let mut out = Vec::new();
        device.take(&Frame::of(node().sdo_request(), request), now, &mut out);
        assert_eq!(out, [Frame::of(node().sdo_response(), [0x60, low, high, object.sub, 0, 0, 0, 0])]);
    }

    fn ticked(device: &mut Device, now: Duration) -> Vec<Vec<u8>> {
        let mut out = Vec::new();
        device.tick(now, &mut out);
        out.iter().map(|frame| frame.bytes().to_vec()).collect()
    }

    #[test]
    fn the_heartbeat_has_the_time_of_1017h_and_shows_the_state() {
        let mut device = device();
        assert_eq!(ticked(&mut device, ms(1_000)), [[0_u8; 0]; 0]);
        write(&mut device, objects::PRODUCER_HEARTBEAT, &100_u16.to_le_bytes(), ms(1_000));
        assert_eq!(ticked(&mut device, ms(1_099)), [[0_u8; 0]; 0]);
        assert_eq!(ticked(&mut device, ms(1_100)), [[0x7F]]);
        device.take(&NmtCommand::Start.frame(Some(node())), ms(1_150), &mut Vec::new());
        assert_eq!(ticked(&mut device, ms(1_200)), [[0x05]]);
        device.take(&NmtCommand::Stop.frame(None), ms(1_250), &mut Vec::new());
        assert_eq!(ticked(&mut device, ms(1_300)), [[0x04]]);
    }

    /// The toggle bit alternates from 0 on (CiA 301).
    #[test]
    fn guarding_is_answered_with_a_toggle_bit() {
        let mut device = device();
        let mut out = Vec::new();
        for _ in 0..3 {
            device.take(&Frame::remote(node().heartbeat(), 1).unwrap(), ms(0), &mut out);
        }
        let states: Vec<_> = out.iter().map(|frame| frame.bytes().to_vec()).collect();
        assert_eq!(states, [[0x7F], [0xFF], [0x7F]]);
    }

    #[test]
    fn another_node_is_not_reset_and_a_reset_boots() {
        let mut device = device();
        let mut out = Vec::new();
        device.take(&NmtCommand::ResetNode.frame(NodeId::new(4)), ms(0), &mut out);
        assert!(out.is_empty());
        write(&mut device, objects::CONTROL_WORD, &0x0F_u16.to_le_bytes(), ms(0));
        device.take(&NmtCommand::ResetNode.frame(Some(node())), ms(0), &mut out);
        assert_eq!(out, [Frame::data(node().heartbeat(), &[0]).unwrap()]);
        assert_eq!(device.table.get(objects::CONTROL_WORD), 0);
    }

    /// A drive that is switched on and off: 300 ms without the master's heartbeat.
    #[test]
    fn a_drive_that_is_not_off_notices_that_its_master_is_gone() {
        for (status, is_lost) in [(0x0037_u16, true), (0x0040, false)] {
            let mut device = device();
            device.table.put(objects::STATUS_WORD, status.into());
            write(&mut device, objects::CONSUMER_HEARTBEAT, &0x007F_012C_u32.to_le_bytes(), ms(0));
            device.tick(ms(500), &mut Vec::new());
            assert!(!device.take_loss(), "it is watched from its first heartbeat on");
            device.take(&Frame::data(MASTER.heartbeat(), &[0x05]).unwrap(), ms(1_000), &mut Vec::new());
            device.tick(ms(1_299), &mut Vec::new());
            assert!(!device.take_loss());
            device.tick(ms(1_300), &mut Vec::new());
            assert_eq!((device.take_loss(), device.take_loss()), (is_lost, false));
        }
    }

    /// 6041h and 6064h with each SYNC; 6040h and 607Ah apply with the SYNC after they came.
    #[test]
    fn pdos_go_with_sync_and_apply_with_sync() {
        let mut device = device();
        let (tpdo, rpdo) = (node().tpdo(1).unwrap(), node().rpdo(1).unwrap());
        let at = |index, sub| Object { index, sub };
        let pdos = [(0x1400, rpdo, [0x6040_0010_u32, 0x607A_0020]), (0x1800, tpdo, [0x6041_0010, 0x6064_0020])];
        for (communication, id, entries) in pdos {
            for (sub, entry) in (1..).zip(entries) {
                write(&mut device, at(communication + 0x200, sub), &entry.to_le_bytes(), ms(0));
            }
            write(&mut device, at(communication + 0x200, 0), &[2], ms(0));
            write(&mut device, at(communication, 2), &[1], ms(0));
            write(&mut device, at(communication, 1), &u32::from(id.get()).to_le_bytes(), ms(0));
        }
        let setpoint = Frame::data(rpdo, &[0x0F, 0x00, 0x18, 0xFC, 0xFF, 0xFF]).unwrap();
        device.take(&setpoint, ms(0), &mut Vec::new());
        device.take(&NmtCommand::Start.frame(Some(node())), ms(0), &mut Vec::new());
        let mut out = Vec::new();
        device.synchronize(&mut out);
        assert_eq!(device.table.get(objects::CONTROL_WORD), 0, "it was not operational");

        device.take(&setpoint, ms(0), &mut Vec::new());
        assert_eq!(device.table.get(objects::CONTROL_WORD), 0, "it waits for SYNC");
        let drive = DriveInput { count: -2, status: 0x0040, ..DriveInput::default() };
        let inputs = Inputs { drive: vec![drive], ..Inputs::default() };
        device.show(&inputs, &mut out);
        out.clear();
        device.synchronize(&mut out);
        // 0240h: switch on disabled, remote.
        assert_eq!(out, [Frame::data(tpdo, &[0x40, 0x02, 0xFE, 0xFF, 0xFF, 0xFF]).unwrap()]);
        assert_eq!(
            (device.table.get(objects::CONTROL_WORD), device.table.signed(objects::TARGET_POSITION)),
            (0x0F, -1_000)
        );
    }

    /// The target of 32 bits beyond a turn of the counter is the one nearest to where the drive is.
    #[test]
    fn targets_follow_counts_beyond_32_bits() {
        let mut device = device();
        let count = (1_i64 << 32) - 10;
        let inputs = Inputs { drive: vec![DriveInput { count, ..DriveInput::default() }], ..Inputs::default() };
        let mut outputs = Outputs { drive: vec![DriveOutput::default()], ..Outputs::default() };
        device.table.put(objects::MODE, 8);
        device.table.put(objects::TARGET_POSITION, 5);
        device.order(&inputs, &mut outputs);
        assert_eq!((outputs.drive[0].position, outputs.drive[0].mode), ((1 << 32) + 5, Mode::Position));
        device.table.put(objects::MODE, 0);
        device.order(&inputs, &mut outputs);
        assert_eq!((outputs.drive[0].position, outputs.drive[0].mode), (count, Mode::None));
    }

    #[test]
    fn a_fault_is_an_emergency_message_and_so_is_its_end() {
        let mut device = device();
        let show = |device: &mut Device, fault| {
            let drive = DriveInput { fault, ..DriveInput::default() };
            let mut out = Vec::new();
            device.show(&Inputs { drive: vec![drive], ..Inputs::default() }, &mut out);
            out.iter().map(|frame| (frame.id(), frame.bytes().to_vec())).collect::<Vec<_>>()
        };
        assert!(show(&mut device, 0).is_empty());
        assert_eq!(show(&mut device, 0x8611), [(node().emergency(), vec![0x11, 0x86, 0x01, 0, 0, 0, 0, 0])]);
        assert!(show(&mut device, 0x8611).is_empty());
        assert_eq!(device.table.get(objects::ERROR_CODE), 0x8611);
        assert_eq!(show(&mut device, 0), [(node().emergency(), vec![0; 8])]);
    }
}
