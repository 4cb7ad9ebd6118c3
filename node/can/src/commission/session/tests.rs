//! A simulated bus with devices that answer expedited transfers.

use super::*;
use crate::Id;
use crate::commission::Scan;
use crate::eds::CobId;
use crate::lss::LssCommand;
use lineshaft_cia402::dictionary::Direction;
use std::collections::VecDeque;
use std::sync::{Arc, Mutex};

/// Abort codes of reads and of writes, by object.
#[derive(Default)]
struct Device {
    objects: BTreeMap<(u16, u8), Vec<u8>>,
    refused: BTreeMap<(u16, u8), u32>,
}

#[derive(Default)]
struct State {
    devices: BTreeMap<u8, Device>,
    answers: VecDeque<Frame>,
    sent: Vec<Frame>,
}

/// Simulated bus that a test can inspect.
#[derive(Clone, Default)]
struct Bus(Arc<Mutex<State>>);

impl Bus {
    fn with(self, node: u8, objects: &[(u16, u8, u32, usize)]) -> Self {
        let all = objects.iter().map(|(index, sub, value, bytes)| {
            ((*index, *sub), value.to_le_bytes().iter().take(*bytes).copied().collect())
        });
        self.0.lock().unwrap().devices.entry(node).or_default().objects.extend(all);
        self
    }

    fn refuse(&self, node: u8, index: u16, sub: u8, code: u32) {
        self.0.lock().unwrap().devices.entry(node).or_default().refused.insert((index, sub), code);
    }

    fn says(&self, frame: Frame) {
        self.0.lock().unwrap().answers.push_back(frame);
    }

    fn session(&self) -> Session {
        Session::new(Box::new(self.clone()), Duration::from_millis(30))
    }

    /// Returns the written objects: index, subindex, value.
    fn written(&self) -> Vec<(u16, u8, u32)> {
        let written = |frame: &Frame| match *frame.bytes() {
            [0x20..=0x3F, low, high, sub, a, b, c, d] => {
                Some((u16::from_le_bytes([low, high]), sub, u32::from_le_bytes([a, b, c, d])))
            }
            _ => None,
        };
        self.0.lock().unwrap().sent.iter().filter_map(written).collect()
    }
}

impl Transport for Bus {
    fn send(&mut self, frame: &Frame) -> Result<(), TransportError> {
        let mut state = self.0.lock().unwrap();
        state.sent.push(*frame);
        let node = (frame.id().get() & 0x7F) as u8;
        if frame.id().get() & 0x780 != 0x600 {
            return Ok(());
        }
        let Some(device) = state.devices.get_mut(&node) else { return Ok(()) };
        let [command, low, high, sub, a, b, c, d] = <[u8; 8]>::try_from(frame.bytes()).unwrap();
        let key = (u16::from_le_bytes([low, high]), sub);
        let aborts = |code: u32| {
            let [a, b, c, d] = code.to_le_bytes();
            [0x80, low, high, sub, a, b, c, d]
        };
        let is_write = command >> 5 == 1;
        let answer = match (device.objects.get(&key).cloned(), device.refused.get(&key)) {
            (_, Some(code)) if is_write || *code == 0x0601_0001 => aborts(*code),
            (None, _) => aborts(0x0602_0000),
            (Some(_), _) if is_write => {
                let count = 4 - usize::from(command >> 2 & 3);
                device.objects.insert(key, [a, b, c, d][..count].to_vec());
                [0x60, low, high, sub, 0, 0, 0, 0]
            }
            (Some(data), _) => {
                let mut bytes = [0x43 | (4 - data.len() as u8) << 2, low, high, sub, 0, 0, 0, 0];
                bytes[4..4 + data.len()].copy_from_slice(&data);
                bytes
            }
        };
        state.answers.push_back(Frame::of(NodeId::new(node).unwrap().sdo_response(), answer));
        Ok(())
    }

    fn flush(&mut self) -> Result<(), TransportError> {
        Ok(())
    }

    fn receive(&mut self) -> Result<Option<Frame>, TransportError> {
        Ok(self.0.lock().unwrap().answers.pop_front())
    }
}

fn node(number: u8) -> NodeId {
    NodeId::new(number).unwrap()
}

fn of(index: u16, sub: u8) -> Object {
    Object { index, sub }
}

#[test]
fn read_returns_value_refusal_or_timeout_with_node() {
    let bus = Bus::default().with(3, &[(0x6064, 0, 7, 4)]);
    let mut session = bus.session();
    assert_eq!(session.read(node(3), of(0x6064, 0)).unwrap(), [7, 0, 0, 0]);
    let error = session.read(node(3), of(0x5000, 0)).unwrap_err();
    assert!(error.is_refusal());
    assert_eq!(error.to_string(), "node 3: 5000h:00: the device refuses: the object does not exist (06020000h)");
    let error = session.read(node(4), of(0x6064, 0)).unwrap_err();
    assert_eq!(error.to_string(), "node 4: 6064h:00: the device has not answered for 30 ms");
    session.write(node(3), of(0x6064, 0), &[1, 2]).unwrap();
    assert_eq!(bus.written(), [(0x6064, 0, 0x0201)]);
}

#[test]
fn scan_finds_nodes_that_answer_or_send_heartbeat() {
    let bus = Bus::default()
        .with(2, &[(0x1000, 0, 0x0002_0192, 4), (0x1018, 1, 0xAB, 4), (0x1008, 0, u32::from_le_bytes(*b"ABC\0"), 4)])
        .with(7, &[(0x1018, 4, 9, 4)]);
    bus.says(Frame::data(node(5).heartbeat(), &[4]).unwrap());
    let mut session = bus.session();
    let scan = Scan { from: node(1), to: node(127), gap: Duration::from_micros(100), least: Duration::from_millis(60) };
    let mut told = Vec::new();
    let found = session.scan(scan, &mut |done, of| told.push((done, of))).unwrap();
    let nodes: Vec<_> = found.iter().map(|found| (found.node.get(), found.answers, found.device_type)).collect();
    assert_eq!(nodes, [(2, true, Some(0x0002_0192)), (5, false, None), (7, true, None)]);
    assert_eq!(found[0].identity, [Some(0xAB), None, None, None]);
    assert_eq!(found[0].name.as_deref(), Some("ABC"));
    assert_eq!(found[1].state, Some(NmtState::Stopped));
    assert_eq!(found[2].identity[3], Some(9));
    assert_eq!(told.last(), Some(&(127, 127)));
    let bus = bus.0.lock().unwrap();
    let is_asked = |frame: &Frame| frame.id().get() & 0x780 == 0x600;
    assert!(bus.sent.iter().all(is_asked), "nothing but what was asked for");
}

#[test]
fn nmt_command_is_sent_once_and_boot_up_is_received() {
    let bus = Bus::default();
    let mut session = bus.session();
    session.nmt(NmtCommand::ResetNode, Some(node(3))).unwrap();
    bus.says(Frame::data(node(4).heartbeat(), &[0]).unwrap());
    bus.says(Frame::data(node(3).heartbeat(), &[5]).unwrap());
    bus.says(Frame::data(node(3).heartbeat(), &[0]).unwrap());
    let is_boot = |state| state == NmtState::BootUp;
    let heard = session.wait_for_state(node(3), Duration::from_secs(5), is_boot).unwrap();
    assert_eq!(heard, Some(NmtState::BootUp));
    assert_eq!(session.wait_for_state(node(3), Duration::from_millis(5), is_boot).unwrap(), None);
    assert_eq!(bus.0.lock().unwrap().sent, [Frame::data(Id::NMT, &[0x81, 3]).unwrap()]);
}

/// Returns a bus with a drive with TPDO 1 = 6041h, 6064h, transmission type 255.
fn drive() -> Bus {
    Bus::default().with(
        3,
        &[
            (0x6041, 0, 0x0250, 2),
            (0x6083, 0, 100, 4),
            (0x6040, 0, 0, 2),
            (0x1006, 0, 0, 4),
            (0x1019, 0, 0, 1),
            (0x1014, 0, 0x83, 4),
            (0x1018, 1, 0xFFFF, 4),
            (0x1800, 1, 0x4000_0183, 4),
            (0x1800, 2, 255, 1),
            (0x1800, 3, 0, 2),
            (0x1A00, 0, 2, 1),
            (0x1A00, 1, 0x6041_0010, 4),
            (0x1A00, 2, 0x6064_0020, 4),
            (0x1A00, 3, 0, 4),
        ],
    )
}

fn values(values: &[(u16, u8, u32, usize)]) -> Vec<(Object, Vec<u8>)> {
    let bytes = |value: u32, count| value.to_le_bytes().iter().take(count).copied().collect();
    values.iter().map(|(index, sub, value, count)| (of(*index, *sub), bytes(*value, *count))).collect()
}

#[test]
fn configure_writes_only_differing_objects_and_leaves_out_acting_ones() {
    let bus = drive();
    let given = values(&[
        (0x1003, 0, 0, 1),
        (0x1010, 1, 1, 4),
        (0x6040, 0, 15, 2),
        (0x6041, 0, 0x0250, 2),
        (0x607A, 0, 77, 4),
        (0x6083, 0, 200, 4),
        (0x60FF, 0, 9, 4),
    ]);
    let mut told = Vec::new();
    let done = bus.session().configure(node(3), &given, &mut |done, of| told.push((done, of))).unwrap();
    assert_eq!((done.compared, done.written), (2, vec![of(0x6083, 0)]));
    let left_out = "as objects that act: 1003h:00, 1010h:01, 6040h:00; as setpoints: 607Ah:00, 60FFh:00";
    assert_eq!(done.left_out.to_string(), left_out);
    assert_eq!(bus.written(), [(0x6083, 0, 200)]);
    assert!(!told.is_empty());
    // All objects have the given values now.
    let done = bus.session().configure(node(3), &given, &mut |_, _| {}).unwrap();
    assert_eq!((done.written.len(), bus.written().len()), (0, 1));
}

/// 6003h is a filter of a module (CiA 401) and the preset of an encoder (CiA 406). The second logical device has its own profile in 6FFFh.
#[test]
fn left_out_objects_depend_on_profile_of_device() {
    let given = values(&[(0x6003, 1, 1, 1), (0x6200, 1, 0xFF, 1), (0x6200, 2, 0xFF, 1), (0x6840, 0, 6, 2)]);
    let configured = |types: &[(u16, u8, u32, usize)]| {
        let bus = Bus::default().with(3, &[(0x6003, 1, 0, 1), (0x6200, 1, 0, 1), (0x6200, 2, 0, 1), (0x6840, 0, 0, 2)]);
        let bus = bus.with(3, types);
        let done = bus.session().configure(node(3), &given, &mut |_, _| {}).unwrap();
        let is_asked = |frame: &&Frame| frame.bytes().starts_with(&[0x40, 0x00, 0x10, 0]);
        let asked = bus.0.lock().unwrap().sent.iter().filter(is_asked).count();
        (bus.written(), done.left_out.to_string(), asked)
    };
    let outputs = "as setpoints: 6200h:01 to 02".to_owned();
    let two = configured(&[(0x1000, 0, 0x0003_0191, 4), (0x6FFF, 0, 0x0003_0191, 4)]);
    assert_eq!(two, (vec![(0x6003, 1, 1), (0x6840, 0, 6)], outputs.clone(), 1));
    let drive = configured(&[(0x1000, 0, 0x0003_0191, 4), (0x6FFF, 0, 0x0002_0192, 4)]);
    assert_eq!(drive.1, "as objects that act: 6840h:00; as setpoints: 6200h:01 to 02");
    // The second logical device has no device type: the profile of the first one applies.
    assert_eq!(configured(&[(0x1000, 0, 0x0003_0191, 4)]).1, outputs);
    // For a device without a profile, objects that act in any profile are left out.
    let unknown = configured(&[(0x1000, 0, 0, 4)]);
    assert_eq!(
        (unknown.0.len(), unknown.1.as_str()),
        (0, "as objects that act: 6003h:01, 6840h:00; as setpoints: 6200h:01 to 02")
    );
}

#[test]
fn pdo_is_mapped_while_disabled() {
    let bus = drive();
    let given = values(&[
        (0x1800, 1, 0x4000_0183, 4),
        (0x1800, 2, 1, 1),
        (0x1A00, 0, 1, 1),
        (0x1A00, 1, 0x6064_0020, 4),
        (0x1A00, 2, 0x6041_0010, 4),
    ]);
    let done = bus.session().configure(node(3), &given, &mut |_, _| {}).unwrap();
    let expected = [
        (0x1800, 1, 0xC000_0183),
        (0x1A00, 0, 0),
        (0x1A00, 1, 0x6064_0020),
        (0x1A00, 0, 1),
        (0x1800, 2, 1),
        (0x1800, 1, 0x4000_0183),
    ];
    assert_eq!(bus.written(), expected);
    // The second entry is above the number of entries.
    assert_eq!(done.written, [of(0x1800, 2), of(0x1A00, 0), of(0x1A00, 1)]);
    let pdos = bus.session().pdos(node(3)).unwrap();
    let [pdo] = pdos.as_slice() else { panic!("{pdos:?}") };
    assert_eq!((pdo.direction, pdo.number, pdo.cob_id), (Direction::Transmit, 1, CobId(0x4000_0183)));
    assert_eq!((pdo.transmission, pdo.inhibit, pdo.event_timer), (Some(1), Some(0), None));
    assert_eq!(pdo.mapped.len(), 1);
}

/// A PDO that the file disables stays disabled.
#[test]
fn pdo_is_disabled_with_one_write() {
    let bus = drive();
    let given = values(&[(0x1800, 1, 0xC000_0183, 4)]);
    bus.session().configure(node(3), &given, &mut |_, _| {}).unwrap();
    assert_eq!(bus.written(), [(0x1800, 1, 0xC000_0183)]);
}

#[test]
fn objects_are_written_while_their_prerequisite_is_disabled() {
    let bus = drive().with(3, &[(0x1006, 0, 4000, 4)]);
    let given = values(&[(0x1014, 0, 0x93, 4), (0x1019, 0, 16, 1)]);
    bus.session().configure(node(3), &given, &mut |_, _| {}).unwrap();
    let expected = [
        (0x1014, 0, 0x8000_0083),
        (0x1014, 0, 0x8000_0093),
        (0x1014, 0, 0x93),
        (0x1006, 0, 0),
        (0x1019, 0, 16),
        (0x1006, 0, 4000),
    ];
    assert_eq!(bus.written(), expected);
}

#[test]
fn configure_fails_for_enabled_drive_other_device_and_refused_object() {
    let given = values(&[(0x6083, 0, 200, 4)]);
    let bus = drive().with(3, &[(0x6041, 0, 0x0237, 2)]);
    let error = bus.session().configure(node(3), &given, &mut |_, _| {}).unwrap_err().to_string();
    assert_eq!(error, "node 3 is operation enabled (6041h is 0237h); switch it off first");
    assert!(bus.written().is_empty());

    let bus = drive();
    let mut session = bus.session();
    session.check_identity(node(3), Some(0xFFFF), Some(0)).unwrap();
    let error = session.check_identity(node(3), Some(0x22), None).unwrap_err().to_string();
    assert_eq!(error, "node 3 is another device: its vendor (1018h:01) is 0000FFFFh, the file is for 00000022h");

    bus.refuse(3, 0x6083, 0, 0x0609_0031);
    let error = session.configure(node(3), &given, &mut |_, _| {}).unwrap_err().to_string();
    assert_eq!(error, "node 3: 6083h:00: the device refuses: the value is too high (06090031h)");
}

/// A write-only object is written each time.
#[test]
fn write_only_object_is_written() {
    let bus = drive().with(3, &[(0x2000, 0, 1, 4)]);
    bus.refuse(3, 0x2000, 0, 0x0601_0001);
    let error = bus.session().configure(node(3), &values(&[(0x2000, 0, 1, 4)]), &mut |_, _| {}).unwrap_err();
    assert!(error.to_string().contains("2000h:00: the device refuses"), "{error}");
    assert_eq!(bus.written(), [(0x2000, 0, 1)]);
}

#[test]
fn store_writes_save_signature() {
    let bus = drive().with(3, &[(0x1010, 1, 1, 4)]);
    bus.session().store(node(3)).unwrap();
    assert_eq!(bus.written(), [(0x1010, 1, u32::from_le_bytes(*b"save"))]);
    bus.refuse(3, 0x1010, 1, 0x0800_0020);
    let error = bus.session().store(node(3)).unwrap_err().to_string();
    assert_eq!(error, "node 3: 1010h:01: the device refuses: the data cannot be stored (08000020h)");
}

/// A device that answers LSS. It is selected by any identity with serial number 7 and refuses to store.
#[derive(Clone, Default)]
struct Layered(Bus);

impl Transport for Layered {
    fn send(&mut self, frame: &Frame) -> Result<(), TransportError> {
        let mut state = self.0.0.lock().unwrap();
        state.sent.push(*frame);
        let answer = match *frame.bytes() {
            [67, 7, ..] => Some(68),
            [command @ (17 | 19), ..] => Some(command),
            _ => None,
        };
        let refusal = (frame.bytes()[0] == 23).then_some([23, 1, 0, 0, 0, 0, 0, 0]);
        let answer = answer.map(|command| [command, 0, 0, 0, 0, 0, 0, 0]).or(refusal);
        state.answers.extend(answer.map(|bytes| Frame::of(Id::LSS_SLAVE, bytes)));
        Ok(())
    }

    fn flush(&mut self) -> Result<(), TransportError> {
        Ok(())
    }

    fn receive(&mut self) -> Result<Option<Frame>, TransportError> {
        self.0.receive()
    }
}

#[test]
fn lss_device_is_configured_by_identity_and_returned_to_waiting() {
    let device = Layered::default();
    let mut session = Session::new(Box::new(device.clone()), Duration::from_millis(30));
    let command = LssCommand::NodeId(node(9));
    session.send_lss_command([1, 2, 3, 7], command).unwrap();
    let sent = device.0.0.lock().unwrap().sent.clone();
    assert_eq!((sent.len(), sent[5], sent.last()), (7, command.frame(), Some(&LssCommand::SwitchToWaiting.frame())));
    let error = session.send_lss_command([1, 2, 3, 8], command).unwrap_err().to_string();
    let sentence = "no device answers to vendor 00000001h, product 00000002h, revision 00000003h, serial 00000008h";
    assert_eq!(error, sentence);
    let error = session.send_lss_command([1, 2, 3, 7], LssCommand::Store).unwrap_err().to_string();
    assert_eq!(error, "the device cannot store its node id and bit rate");
    assert_eq!(device.0.0.lock().unwrap().sent.last(), Some(&LssCommand::SwitchToWaiting.frame()));
    assert_eq!(session.search(&mut |_, _| {}).unwrap(), None);
}
