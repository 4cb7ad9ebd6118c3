mod devices;
mod modes;

use super::super::fixtures::as_drive;
use super::*;
use crate::config::{DeviceConfig, Role};
use crate::layout::Layout;
use crate::master::tally::BusLoadMeter;
use crate::transport::Loss;
use crate::{Id, Monitoring};
use assert_no_alloc::{assert_no_alloc, violation_count};
use lineshaft_cia402::config::{AnalogTerminal, Encoder, MissingDataBehaviour, Terminals};
use lineshaft_cia402::mapping::Extras;
use lineshaft_cia402::mode::DriveMode;
use lineshaft_cia402::objects;
use lineshaft_cia402::probe::Probe;
use lineshaft_core::drive::{
    DriveInput, DriveOutput, Edge, EncoderInput, HomingOrder, Latch, MODE_CSP, MODE_HOMING, Mode, Terminal, control,
};
use lineshaft_core::object::Object as CoreObject;
use rtrb::RingBuffer;
use std::collections::VecDeque;
use std::sync::Mutex;
use std::time::Duration;

/// Maximum number of frames on the simulated wire.
const ROOM: usize = 4096;

/// Remote end of a bus.
#[derive(Debug)]
struct Wire {
    sent: VecDeque<Frame>,
    comes: VecDeque<Frame>,
    is_lost: bool,
    is_full: bool,
}

/// Transport to the remote end.
#[derive(Clone, Debug)]
struct Way(Arc<Mutex<Wire>>);

impl Transport for Way {
    fn send(&mut self, frame: &Frame) -> Result<(), TransportError> {
        let mut wire = self.0.lock().expect("one thread");
        if wire.is_full {
            return Err(TransportError::Full(256));
        }
        assert!(wire.sent.len() < ROOM, "nobody looks at what is sent");
        wire.sent.push_back(*frame);
        Ok(())
    }

    fn flush(&mut self) -> Result<(), TransportError> {
        Ok(())
    }

    fn receive(&mut self) -> Result<Option<Frame>, TransportError> {
        let mut wire = self.0.lock().expect("one thread");
        if wire.is_lost { Err(TransportError::Lost(Loss::Ended)) } else { Ok(wire.comes.pop_front()) }
    }
}

fn node(number: u8) -> NodeId {
    NodeId::new(number).expect("1 to 127")
}

fn drive(place: usize, number: u8, watching: Monitoring) -> DeviceConfig {
    DeviceConfig::plain_drive(place, node(number), watching)
}

/// A bus with two drives, nodes 3 and 5, and its remote end.
struct Rig {
    bus: Bus,
    wire: Arc<Mutex<Wire>>,
    orders: Producer<Order>,
    reports: Consumer<Report>,
    inputs: Inputs,
    outputs: Outputs,
    cycle: u64,
}

const SDO_TIMEOUT_NS: u64 = 20_000_000;

impl Rig {
    fn new(watching: Monitoring) -> Self {
        let (orders, taken) = RingBuffer::new(64);
        let (told, reports) = RingBuffer::new(64);
        let config = BusConfig {
            name: "bus0".to_owned(),
            transport: "socketcan:can0".parse().expect("it is an address"),
            bit_rate: None,
            serial_baudrate: None,
            cycle_ns: 1_000_000,
            sync_overflow: None,
            sdo_timeout_ns: SDO_TIMEOUT_NS,
            time_ns: None,
            master: None,
            devices: vec![drive(0, 3, watching), drive(1, 5, watching)],
        };
        let mut bus = Bus::new(&config, taken, told);
        let (sent, comes) = (VecDeque::with_capacity(ROOM), VecDeque::with_capacity(ROOM));
        let wire = Arc::new(Mutex::new(Wire { sent, comes, is_lost: false, is_full: false }));
        bus.open(Box::new(Way(Arc::clone(&wire))));
        let inputs = Inputs { drive: vec![DriveInput::default(); 2], ..Inputs::default() };
        let outputs = Outputs { drive: vec![DriveOutput::default(); 2], ..Outputs::default() };
        Self { bus, wire, orders, reports, inputs, outputs, cycle: 0 }
    }

    /// Returns a rig with both drives configured and started.
    fn running(watching: Monitoring) -> Self {
        let mut rig = Self::new(watching);
        (0..2).for_each(|drive| rig.order(Order::Begin { device: drive, fault: 0 }));
        rig
    }

    /// Replaces the first device by another one, configured and started.
    fn replace_first(&mut self, config: &DeviceConfig) {
        self.replace(0, config);
    }

    /// Replaces the device at a place by another one, configured and started.
    fn replace(&mut self, place: usize, config: &DeviceConfig) {
        self.bus.devices[place] = Device::new(config, 1_000_000);
        self.bus.routes = routes(&self.bus.devices);
        self.bus.devices[place].begin(0);
    }

    fn order(&mut self, order: Order) {
        assert!(self.orders.push(order).is_ok(), "there is room");
    }

    fn comes(&self, id: u16, bytes: &[u8]) {
        let frame = Frame::data(Id::new(id).expect("11 bits"), bytes).expect("8 bytes");
        self.wire.lock().expect("one thread").comes.push_back(frame);
    }

    /// Sends PDO 1 of both drives with these values.
    fn answer(&self, status: u16, position: i32, mode: i8) {
        let mut bytes = [status.to_le_bytes().to_vec(), position.to_le_bytes().to_vec()].concat();
        bytes.push(mode.cast_unsigned());
        self.comes(0x183, &bytes);
        self.comes(0x185, &bytes);
    }

    fn cycle(&mut self) {
        self.inputs.begin(self.cycle, 0);
        self.bus.read(&mut self.inputs);
        self.bus.write(&self.outputs);
        self.cycle += 1;
    }

    fn sent(&self) -> Vec<Frame> {
        self.wire.lock().expect("one thread").sent.drain(..).collect()
    }

    fn is_online(&self) -> [bool; 2] {
        [0, 1].map(|drive| self.inputs.drive[drive].online)
    }
}

fn hex(frame: &Frame) -> String {
    let bytes: Vec<_> = frame.bytes().iter().map(|byte| format!("{byte:02X}")).collect();
    format!("{:03X}#{}", frame.id().get(), bytes.concat())
}

/// 6040h, 607Ah and 6060h to each drive, then SYNC: setpoints of a cycle take effect at its SYNC.
#[test]
fn setpoints_are_sent_before_sync() {
    let mut rig = Rig::running(Monitoring::None);
    rig.outputs.drive[0] =
        DriveOutput { position: 0x1_2345_6789, control: control::ENABLE, mode: Mode::Position, ..Default::default() };
    rig.outputs.drive[1] = DriveOutput { position: -2, control: control::SHUTDOWN, ..Default::default() };
    rig.cycle();
    let sent: Vec<_> = rig.sent().iter().map(hex).collect();
    assert_eq!(sent, ["203#0F008967452308", "205#0600FEFFFFFF00", "080#"]);
}

/// A device receives no process data before it is configured, and after a boot-up.
#[test]
fn unconfigured_drive_receives_no_process_data() {
    let mut rig = Rig::new(Monitoring::None);
    rig.cycle();
    assert_eq!(rig.sent().iter().map(hex).collect::<Vec<_>>(), ["080#"]);
    rig.order(Order::Prepare { device: 0 });
    rig.order(Order::Begin { device: 0, fault: 0 });
    rig.cycle();
    assert_eq!(rig.sent().iter().map(hex).collect::<Vec<_>>(), ["203#00000000000000", "080#"]);
    rig.comes(0x703, &[0]);
    rig.cycle();
    assert_eq!(rig.sent().iter().map(hex).collect::<Vec<_>>(), ["080#"]);
    let Ok(Report::Happened { device: 0, what: DeviceEvent::BootedUp, took_part: true }) = rig.reports.pop() else {
        panic!("it is reported");
    };
}

/// A device that boots during its configuration has lost it.
#[test]
fn drive_that_boots_during_configuration_does_not_start() {
    let mut rig = Rig::new(Monitoring::None);
    rig.order(Order::Prepare { device: 1 });
    rig.cycle();
    rig.comes(0x705, &[0]);
    rig.cycle();
    rig.order(Order::Begin { device: 1, fault: 0 });
    rig.cycle();
    assert!(rig.sent().iter().all(|frame| frame.id() == Id::SYNC));
    let took_part =
        |report| matches!(report, Report::Happened { device: 1, what: DeviceEvent::BootedUp, took_part: true });
    assert!(std::iter::from_fn(|| rig.reports.pop().ok()).any(took_part));
}

/// Process data is fresh in the cycle after the SYNC that it answers; otherwise the last values stay.
#[test]
fn process_data_is_fresh_in_cycle_of_reception() {
    let mut rig = Rig::running(Monitoring::None);
    rig.cycle();
    assert_eq!(rig.is_online(), [false; 2], "nobody has answered yet");
    rig.answer(0x1237, -5, MODE_CSP);
    rig.cycle();
    let DriveInput { count, status, mode, online, fresh, velocity, .. } = rig.inputs.drive[0];
    assert_eq!((count, status, mode, online, fresh, velocity), (-5, 0x1237, MODE_CSP, true, true, 0.0));
    rig.cycle();
    let DriveInput { count, online, fresh, .. } = rig.inputs.drive[0];
    assert_eq!((count, online, fresh), (-5, true, false));
    // 10 counts in 2 cycles of 1 ms.
    rig.answer(0x1237, 5, MODE_CSP);
    rig.cycle();
    assert_eq!((rig.inputs.drive[1].count, rig.inputs.drive[1].velocity), (5, 5000.0));
}

/// MACS-CAN-06 for a heartbeat: the drive is silent for longer than the monitoring time.
#[test]
fn only_silent_drive_goes_offline() {
    let mut rig = Rig::running(Monitoring::Heartbeat { time_ns: 30_000_000 });
    rig.comes(0x703, &[0x05]);
    rig.answer(0x0250, 0, 0);
    rig.cycle();
    assert_eq!(rig.is_online(), [true; 2]);
    std::thread::sleep(std::time::Duration::from_millis(40));
    rig.cycle();
    assert_eq!(rig.is_online(), [false, true], "node 5 has never sent a heartbeat, and is not watched yet");
    let reports = std::iter::from_fn(|| rig.reports.pop().ok());
    let unwatched = |report: &Report| {
        matches!(report, Report::Happened { device: 1, what: DeviceEvent::NeverHeard, took_part: false })
    };
    assert_eq!(reports.filter(unwatched).count(), 1, "which is reported");
    rig.cycle();
    assert!(!std::iter::from_fn(|| rig.reports.pop().ok()).any(|report| unwatched(&report)), "once");
    // The drive sends again, but it has to be configured before it takes part.
    rig.comes(0x703, &[0x05]);
    rig.cycle();
    assert_eq!(rig.is_online(), [false, true]);
}

/// Heartbeats that repeatedly report a state other than operational.
#[test]
fn drive_that_leaves_operational_is_removed_from_cycles() {
    let mut rig = Rig::new(Monitoring::Heartbeat { time_ns: 10_000_000_000 });
    rig.comes(0x703, &[0x7F]);
    rig.cycle();
    rig.order(Order::Begin { device: 0, fault: 0 });
    rig.comes(0x703, &[0x7F]);
    rig.answer(0x0250, 0, 0);
    rig.cycle();
    assert_eq!(rig.is_online(), [false; 2]);
    let took_part = |report| matches!(report, Report::Happened { device: 0, took_part: true, .. });
    assert!(std::iter::from_fn(|| rig.reports.pop().ok()).any(took_part));
}

/// Motion of the drive while its data was not received counts as motion. After a boot-up or a lost bus connection, its coordinate system is
/// a new one.
#[test]
fn counts_continue_after_absence_unless_drive_has_booted() {
    let mut rig = Rig::running(Monitoring::Heartbeat { time_ns: 1_000_000_000 });
    let back = |rig: &mut Rig| {
        rig.order(Order::Prepare { device: 0 });
        rig.order(Order::Listen { device: 0, inputs: 0 });
        rig.order(Order::Begin { device: 0, fault: 0 });
        rig.answer(0x0250, 300, MODE_CSP);
        rig.cycle();
        let DriveInput { count, epoch, velocity, online, .. } = rig.inputs.drive[0];
        assert!(online);
        (count, epoch, velocity)
    };
    rig.answer(0x0250, 100, MODE_CSP);
    rig.comes(0x703, &[0x7F]);
    rig.cycle();
    assert!(!rig.is_online()[0], "it has left operation");
    assert_eq!(back(&mut rig), (300, 0, 0.0), "200 counts further in the same coordinate");
    rig.comes(0x703, &[0x00]);
    rig.cycle();
    assert_eq!(back(&mut rig), (300, 1, 0.0));
    let way = Way(Arc::clone(&rig.wire));
    rig.order(Order::Open(Box::new(way)));
    rig.cycle();
    assert_eq!(back(&mut rig), (300, 2, 0.0));
    // In mode homing the drive may have set its zero meanwhile.
    rig.answer(0x0237, 300, MODE_HOMING);
    rig.comes(0x703, &[0x7F]);
    rig.cycle();
    assert_eq!(back(&mut rig), (300, 3, 0.0));
}

#[test]
fn lost_transport_is_reported_once_and_all_drives_are_offline() {
    let mut rig = Rig::running(Monitoring::None);
    rig.answer(0x0250, 7, 0);
    rig.cycle();
    rig.wire.lock().unwrap().is_lost = true;
    (0..3).for_each(|_| rig.cycle());
    let drive = rig.inputs.drive[0];
    assert_eq!((drive.online, drive.bus, drive.count), (false, BusState::Off, 7));
    let reports: Vec<_> = std::iter::from_fn(|| rig.reports.pop().ok()).collect();
    assert_eq!(reports.len(), 1);
    let Some(Report::Lost(mut way, _)) = reports.into_iter().next() else { panic!("it is lost") };
    rig.wire.lock().unwrap().is_lost = false;
    rig.sent();
    // After the bus connection is open again, no device receives process data before it is configured again.
    way.close();
    rig.order(Order::Open(way));
    rig.answer(0x0250, 9, 0);
    rig.cycle();
    assert_eq!((rig.is_online(), rig.inputs.drive[0].bus), ([false; 2], BusState::Active));
    assert_eq!(rig.sent().iter().map(hex).collect::<Vec<_>>(), ["080#"]);
}

/// The error code of a fault comes from the emergency message. The message is reported in one cycle only.
#[test]
fn emergency_is_reported_in_one_cycle_and_sets_error_code() {
    let mut rig = Rig::running(Monitoring::None);
    rig.comes(0x083, &[0x11, 0x86, 0x21, 1, 2, 3, 4, 5]);
    rig.answer(0x0218, 0, MODE_CSP);
    rig.cycle();
    let told = Emergency { code: 0x8611, register: 0x21, data: [1, 2, 3, 4, 5] };
    assert_eq!((rig.inputs.drive[0].emergency, rig.inputs.drive[0].fault), (Some(told), 0x8611));
    assert_eq!((rig.inputs.drive[1].emergency, rig.inputs.drive[1].fault), (None, 0));
    rig.answer(0x0250, 0, MODE_CSP);
    rig.cycle();
    assert_eq!((rig.inputs.drive[0].emergency, rig.inputs.drive[0].fault), (None, 0), "out of its fault");
    // Node 9 is no drive of the cell.
    rig.comes(0x089, &[0x10, 0x23, 3, 0, 0, 0, 0, 0]);
    rig.cycle();
    assert!(matches!(rig.reports.pop(), Ok(Report::Emergency(of, _)) if of == node(9)));
}

const HOME: HomingOrder =
    HomingOrder { method: 19, search_velocity: 50_000.0, zero_velocity: 5_000.0, acceleration: 500_000.0 };

/// Sends the SDO confirmation of the last write.
fn confirm(rig: &Rig, number: u16, sent: &[Frame]) {
    for frame in sent.iter().filter(|frame| frame.id().get() == 0x600 + number) {
        let &[_, low, high, sub, ..] = frame.bytes() else { continue };
        rig.comes(0x580 + number, &[0x60, low, high, sub, 0, 0, 0, 0]);
    }
}

/// 6098h, 6099h and 609Ah are written first, then mode 6 is commanded. A newly attained zero starts a new coordinate system.
#[test]
fn homing_objects_are_written_before_mode_6_and_zero_starts_new_epoch() {
    let mut rig = Rig::running(Monitoring::None);
    rig.outputs.drive[0] = DriveOutput { control: control::ENABLE, mode: Mode::Position, ..Default::default() };
    rig.answer(0x1637, 1000, MODE_CSP);
    rig.cycle();
    rig.sent();
    rig.outputs.drive[0].mode = Mode::Homing(HOME);
    let (mut written, mut modes) = (Vec::new(), Vec::new());
    for _ in 0..6 {
        rig.cycle();
        let sent = rig.sent();
        modes.extend(sent.iter().filter(|frame| frame.id().get() == 0x203).map(|frame| frame.bytes()[6]));
        written.extend(sent.iter().filter(|frame| frame.id().get() == 0x603).map(hex));
        confirm(&rig, 3, &sent);
    }
    let expected = ["603#2F98600013000000", "603#2399600150C30000", "603#2399600288130000", "603#239A600020A10700"];
    assert_eq!(written, expected);
    assert_eq!(modes, [8, 8, 8, 8, 6, 6], "asked for once the last one is confirmed");
    rig.answer(0x0237, 1000, MODE_HOMING);
    rig.cycle();
    rig.answer(0x1637, -3, MODE_HOMING);
    rig.cycle();
    let DriveInput { count, epoch, velocity, .. } = rig.inputs.drive[0];
    assert_eq!((count, epoch, velocity), (-3, 1, 0.0), "no motion");
}

/// Bit 12 is still 1 from the previous homing, as with methods 35 and 37 of some drives, or rises after the new zero. A step above 4 *
/// 50,000 counts/s in a cycle of 1 ms, plus 100 counts, is not motion; a smaller step is motion of the homing.
#[test]
fn zero_without_rising_bit_12_is_not_motion() {
    for before in [0x1637, 0x0237] {
        let mut rig = Rig::running(Monitoring::None);
        let control = control::ENABLE | control::START_HOMING;
        let home = DriveOutput { control, mode: Mode::Homing(HOME), ..Default::default() };
        rig.outputs.drive[0] = home;
        let mut shown = |status: u16, position: i32| {
            rig.answer(status, position, MODE_HOMING);
            rig.cycle();
            rig.sent();
            let DriveInput { count, epoch, velocity, .. } = rig.inputs.drive[0];
            (count, epoch, velocity)
        };
        shown(before, 9_940);
        shown(before, 9_950);
        assert_eq!(shown(before, 10_000), (10_000, 0, 50_000.0), "50 counts in 1 ms");
        assert_eq!(shown(before, 9_700), (9_700, 0, -300_000.0), "as many as may be");
        assert_eq!(shown(before, 0), (0, 1, 0.0), "its zero");
        // A drive that continues at that speed has no further zero: its travel counts as motion.
        assert_eq!(shown(before, 1_000), (1_000, 1, 1_000_000.0));
    }
}

/// Position and count of probe 1 in TPDO 2 become a latch of the axis, once; probe 2 captures the index.
#[test]
fn probe_capture_becomes_latch_of_axis() {
    let known = crate::eds::parse(include_bytes!("../../../../../launch-configs/can/cia402_sim.eds"), Some(3)).unwrap();
    let mut config = drive(0, 3, Monitoring::None);
    let probes = [Some(Probe::Rising), Some(Probe::Index)];
    (as_drive(&mut config).probes, as_drive(&mut config).object) = (probes, 4);
    config.layout =
        Layout::plan(node(3), DriveMode::Csp, Extras { probes, torque: false }, &config.terminals, Some(&known))
            .unwrap();
    let ids: Vec<_> = config.layout.told.iter().map(|pdo| (pdo.id.get(), pdo.bytes())).collect();
    assert_eq!(ids, [(0x183, 7), (0x283, 6), (0x383, 6), (0x483, 6)]);
    let mut rig = Rig::running(Monitoring::None);
    rig.replace_first(&config);
    let catch = |rig: &Rig, id: u16, position: i32, count: u16| {
        rig.comes(id, &[position.to_le_bytes().as_slice(), &count.to_le_bytes()].concat());
    };
    rig.inputs.latch.reserve(16);
    rig.answer(0x0237, 1000, MODE_CSP);
    catch(&rig, 0x283, 700, 7);
    catch(&rig, 0x383, 1234, 0);
    rig.cycle();
    assert_eq!((rig.inputs.latch.as_slice(), rig.inputs.drive[0].index), ([].as_slice(), None), "of before");
    rig.answer(0x0237, 1300, MODE_CSP);
    catch(&rig, 0x283, 1111, 9);
    catch(&rig, 0x383, 1234, 1);
    rig.cycle();
    let latch = Latch { object: CoreObject::Axis(4), edge: Edge::Rising, age_ns: None, position: Some(1111) };
    assert_eq!((rig.inputs.latch.as_slice(), rig.inputs.latches_lost), ([latch].as_slice(), 1));
    assert_eq!(rig.inputs.drive[0].index, Some(1234));
    rig.answer(0x0237, 1400, MODE_CSP);
    catch(&rig, 0x283, 1111, 9);
    rig.cycle();
    assert_eq!((rig.inputs.latch.len(), rig.inputs.drive[0].index), (0, None), "once");
}

/// A request during a homing setup is answered as busy.
#[test]
fn transfers_do_not_disturb_each_other() {
    let mut rig = Rig::running(Monitoring::None);
    rig.outputs.drive[0].mode = Mode::Homing(HOME);
    rig.cycle();
    let sent = rig.sent();
    let data = vec![0; 8];
    rig.order(Order::Transfer { node: node(3), object: objects::STATUS_WORD, data, writes: false });
    rig.cycle();
    let Ok(Report::Transfer(_, Transfer { result: Err(SdoError::Busy(object)), .. }, _)) = rig.reports.pop() else {
        panic!("another one is under way");
    };
    assert_eq!(object, objects::STATUS_WORD);
    confirm(&rig, 3, &sent);
    rig.cycle();
    assert!(rig.reports.pop().is_err(), "the answer is that of the homing");
}

/// Node 3 never answers.
#[test]
fn silent_sdo_server_ends_transfer_and_homing_setup() {
    let mut rig = Rig::running(Monitoring::None);
    rig.outputs.drive[0].mode = Mode::Homing(HOME);
    rig.cycle();
    std::thread::sleep(std::time::Duration::from_nanos(SDO_TIMEOUT_NS + 1_000_000));
    rig.cycle();
    assert!(matches!(rig.reports.pop(), Ok(Report::HomingRefused(0, SdoError::Silent(..)))));
    rig.sent();
    rig.cycle();
    let sent: Vec<_> = rig.sent().iter().map(hex).collect();
    assert_eq!(sent, ["203#00000000000000", "205#00000000000000", "080#"], "neither mode 6 nor another object");
}

#[test]
fn frames_without_room_are_counted_and_not_sent_later() {
    let mut rig = Rig::running(Monitoring::None);
    rig.wire.lock().unwrap().is_full = true;
    rig.cycle();
    rig.wire.lock().unwrap().is_full = false;
    rig.cycle();
    assert_eq!((rig.bus.losses.refused.load(Ordering::Relaxed), rig.sent().len()), (3, 3));
}

/// Cycles with all kinds of received frames, and transfers in progress.
#[test]
fn cycle_allocates_no_memory() {
    let mut rig = Rig::running(Monitoring::Heartbeat { time_ns: 2_000_000 });
    // Frames are recorded as well, but not fetched.
    let _frames = rig.bus.frames();
    rig.bus.master = Some(Master { node: node(127), heartbeat_ns: 1 });
    let before = violation_count();
    for cycle in 0..200 {
        let homes = Mode::Homing(HomingOrder { method: cycle as i8, ..HOME });
        rig.outputs.drive[0].mode = if cycle % 50 < 40 { homes } else { Mode::Position };
        rig.comes(0x703, &[if cycle % 60 == 59 { 0 } else { 5 }]);
        rig.comes(0x085, &[0x10, 0x23, 3, 0, 0, 0, 0, 0]);
        rig.comes(0x589, &[0x43, 0, 0x10, 0, 1, 2, 3, 4]);
        rig.answer(0x0237, cycle, MODE_CSP);
        if cycle % 7 == 0 {
            let data = Vec::with_capacity(64);
            rig.order(Order::Transfer { node: node(9), object: objects::DEVICE_TYPE, data, writes: false });
        }
        if cycle % 60 == 20 {
            rig.order(Order::Prepare { device: 0 });
            rig.order(Order::Begin { device: 0, fault: 0 });
        }
        assert_no_alloc(|| rig.cycle());
        let sent = rig.sent();
        confirm(&rig, 3, &sent);
        // The service frees the memory of the reports.
        while rig.reports.pop().is_ok() {}
    }
    assert_eq!(violation_count(), before);
}

/// In mode pp (1), which the axis sees as csp (8), the setpoint is late after 500 cycles without bit 12 of the status word; in csp it is
/// not.
#[test]
fn unacknowledged_setpoint_is_reported_as_drive_error() {
    let mut rig = Rig::running(Monitoring::None);
    let mut pp = drive(0, 3, Monitoring::None);
    as_drive(&mut pp).mode = DriveMode::Pp;
    rig.replace(0, &pp);
    for output in &mut rig.outputs.drive {
        *output = DriveOutput { position: 9, control: control::ENABLE, mode: Mode::Position, ..Default::default() };
    }
    let mut shown = |cycles: usize| {
        for _ in 0..cycles {
            rig.answer(0x0237, 0, 1);
            rig.cycle();
            rig.sent();
        }
        (rig.inputs.drive[0].mode, [0, 1].map(|drive| rig.inputs.drive[drive].unacknowledged))
    };
    assert_eq!(shown(500), (MODE_CSP, [false; 2]));
    assert_eq!(shown(5), (MODE_CSP, [true, false]));
}

/// Random frames, and random changes of valid ones, for a running drive in mode pp and a module: no panic, and no command beyond the
/// outputs.
#[test]
fn random_frames_never_enable_a_drive() {
    let watching = Monitoring::Guarding { guard_ns: 1_000_000, life_factor: 3 };
    let mut rig = Rig::running(watching);
    let mut pp = drive(0, 3, watching);
    as_drive(&mut pp).mode = DriveMode::Pp;
    rig.replace(0, &pp);
    let terminal = |place, address| Terminal { place, address };
    let analog = |place, address| AnalogTerminal { terminal: terminal(place, address), volts_at_full_scale: 10.0 };
    let mut module = drive(1, 5, watching);
    module.role = Role::Module;
    module.terminals = Terminals {
        digital_inputs: (0..64).map(|at| terminal(usize::from(at), at)).collect(),
        digital_outputs: vec![terminal(0, 63)],
        analog_inputs: (0..12).map(|at| analog(usize::from(at), at)).collect(),
        ..Terminals::default()
    };
    module.layout = Layout::module(node(5), &module.terminals).unwrap();
    rig.replace(1, &module);
    (rig.inputs.digital, rig.inputs.analog) = (vec![0], vec![0.0; 12]);
    rig.outputs.digital = vec![0];
    let mut seed = 0x9E37_79B9_7F4A_7C15_u64;
    let mut random = move || {
        // xorshift64
        seed ^= seed << 13;
        seed ^= seed >> 7;
        seed ^= seed << 17;
        seed
    };
    let good = [0x183_u16, 0x185, 0x285, 0x385, 0x583, 0x703, 0x083, 0x000, 0x080, 0x603, 0x203];
    for round in 0..10_000 {
        for _ in 0..1000 {
            let [choice, bits, data] = [random(), random(), random()];
            let id =
                if choice % 4 == 0 { (choice >> 8) as u16 & 0x7FF } else { good[(choice >> 8) as usize % good.len()] };
            let id = Id::new(id).expect("11 bits");
            let length = (bits % 9) as u8;
            let frame = if bits & 0xF00 == 0 {
                Frame::remote(id, length)
            } else {
                Frame::data(id, &data.to_le_bytes()[..usize::from(length)])
            };
            rig.wire.lock().unwrap().comes.push_back(frame.expect("8 bytes at most"));
        }
        if round % 16 == 0 {
            (0..2).for_each(|device| rig.order(Order::Begin { device, fault: 0 }));
            let (data, writes) = (Vec::with_capacity(300), round % 32 == 0);
            rig.order(Order::Transfer { node: node(3), object: objects::DEVICE_TYPE, data, writes });
        }
        rig.outputs.drive[0].mode = if round % 9 == 0 { Mode::Homing(HOME) } else { Mode::Position };
        rig.cycle();
        for frame in rig.sent() {
            let id = frame.id().get();
            match id {
                0x203 => assert_eq!(frame.bytes()[..2], [0, 0], "control word"),
                0x205 => assert_eq!(frame.bytes(), [0; 8], "outputs"),
                0x603 => assert_ne!(frame.bytes()[1..3], [0x40, 0x60], "6040h by SDO"),
                _ => assert!(matches!(id, 0x080 | 0x703 | 0x705), "{}", hex(&frame)),
            }
        }
        while rig.reports.pop().is_ok() {}
    }
    assert!(rig.bus.busy.len() <= 127);
}

/// Sent and received frames are counted; frames without room are not.
#[test]
fn sent_and_received_frames_are_counted() {
    let mut rig = Rig::running(Monitoring::None);
    let mut meter = BusLoadMeter::new();
    let begin = Instant::now();
    meter.restart(&rig.bus.tally(), begin);
    rig.answer(0x0627, 0, 8);
    rig.comes(0x703, &[0x05]);
    rig.cycle();
    let went: Vec<Frame> = rig.sent();
    rig.wire.lock().expect("one thread").is_full = true;
    rig.cycle();
    let tally = rig.bus.tally();
    let second = begin + Duration::from_secs(1);
    let [_, _, (_, frames)] = meter.look(&tally, second, None, None);
    assert_eq!((went.len(), frames.as_str()), (3, "6 /s: 3 sent, 3 received"));
    assert_eq!((tally.node(0), tally.node(1)), (Some(NmtState::Operational), None));
    assert_eq!(tally.controller(), "active");
    rig.wire.lock().expect("one thread").is_lost = true;
    rig.cycle();
    assert_eq!(tally.controller(), "off");
}
