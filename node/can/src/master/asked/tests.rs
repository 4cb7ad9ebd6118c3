use super::super::bus::Bus;
use super::*;
use crate::Frame;
use crate::config::BusConfig;
use crate::transport::{Transport, TransportError};
use std::collections::{BTreeMap, VecDeque};
use std::sync::Mutex;

/// Simulated device with node ID 3 that records all writes.
#[derive(Debug, Default)]
struct Device {
    objects: BTreeMap<(u16, u8), Vec<u8>>,
    written: Vec<(u16, Vec<u8>)>,
    /// Remaining bytes of a segmented transfer.
    rest: VecDeque<u8>,
    answers: VecDeque<Frame>,
}

#[derive(Clone, Debug, Default)]
struct Way(Arc<Mutex<Device>>);

impl Transport for Way {
    fn send(&mut self, frame: &Frame) -> Result<(), TransportError> {
        let mut device = self.0.lock().expect("one thread");
        let Ok([command, low, high, sub, data @ ..]) = <[u8; 8]>::try_from(frame.bytes()) else { return Ok(()) };
        if frame.id().get() != 0x603 {
            return Ok(());
        }
        let index = u16::from_le_bytes([low, high]);
        let answer = match command >> 5 {
            2 => match device.objects.get(&(index, sub)).cloned() {
                Some(bytes) if bytes.len() <= 4 => {
                    let mut answer = [0x43 | ((4 - bytes.len()) as u8) << 2, low, high, sub, 0, 0, 0, 0];
                    answer[4..4 + bytes.len()].copy_from_slice(&bytes);
                    answer
                }
                Some(bytes) => {
                    let size = (bytes.len() as u32).to_le_bytes();
                    device.rest = bytes.into();
                    [0x41, low, high, sub, size[0], size[1], size[2], size[3]]
                }
                None => [0x80, low, high, sub, 0, 0, 2, 6],
            },
            3 => {
                let many = device.rest.len().min(7);
                let bytes: Vec<u8> = device.rest.drain(..many).collect();
                let is_last = device.rest.is_empty();
                let mut answer = [command & 0x10 | ((7 - many) as u8) << 1 | u8::from(is_last), 0, 0, 0, 0, 0, 0, 0];
                answer[1..=many].copy_from_slice(&bytes);
                answer
            }
            1 => {
                let many = 4 - usize::from(command >> 2 & 3);
                device.written.push((index, data[..many].to_vec()));
                [0x60, low, high, sub, 0, 0, 0, 0]
            }
            _ => return Ok(()),
        };
        let id = NodeId::new(3).expect("1 to 127").sdo_response();
        device.answers.push_back(Frame::data(id, &answer).expect("8 bytes"));
        Ok(())
    }

    fn flush(&mut self) -> Result<(), TransportError> {
        Ok(())
    }

    fn receive(&mut self) -> Result<Option<Frame>, TransportError> {
        Ok(self.0.lock().expect("one thread").answers.pop_front())
    }
}

type Answers = Arc<Mutex<Vec<Result<Vec<u8>, ObjectAccessError>>>>;

struct Rig {
    device: Arc<Mutex<Device>>,
    port: Port,
    objects: SdoRequestQueue,
    line: SdoRequestReceiver,
    answers: Answers,
}

impl Rig {
    fn new() -> Self {
        let config = BusConfig {
            name: "bus0".to_owned(),
            transport: "socketcan:can0".parse().expect("it is an address"),
            bit_rate: None,
            serial_baudrate: None,
            cycle_ns: 1_000_000,
            sync_overflow: None,
            sdo_timeout_ns: 20_000_000,
            time_ns: None,
            master: None,
            devices: Vec::new(),
        };
        let way = Way::default();
        let device = Arc::clone(&way.0);
        let mut port = Port::new(|(orders, reports)| Bus::new(&config, orders, reports));
        port.set_in_cycles(false);
        port.lock().open(Box::new(way));
        let (objects, line) = line();
        Self { device, port, objects, line, answers: Answers::default() }
    }

    fn has(&self, index: u16, bytes: &[u8]) {
        self.device.lock().expect("one thread").objects.insert((index, 0), bytes.to_vec());
    }

    fn ask(&self, node: u8, index: u16, access: Access) -> Result<RequestHandle, ObjectAccessError> {
        let answers = Arc::clone(&self.answers);
        let answer = move |answer| answers.lock().expect("one thread").push(answer);
        self.objects.submit(NodeId::new(node).expect("1 to 127"), Object { index, sub: 0 }, access, answer)
    }

    fn write(&self, index: u16, without_power: bool) {
        self.ask(3, index, Access::Write { data: vec![7, 0], without_power }).expect("there is room");
    }

    /// Returns the answers when there are this many of them.
    fn serve(&mut self, many: usize) -> Vec<Result<Vec<u8>, ObjectAccessError>> {
        // Each turn handles at least one request.
        (0..many).for_each(|_| self.line.serve(&mut self.port, None));
        self.answers.lock().expect("one thread").drain(..).collect()
    }

    fn written(&self) -> Vec<(u16, Vec<u8>)> {
        self.device.lock().expect("one thread").written.drain(..).collect()
    }
}

#[test]
fn objects_are_read_up_to_maximum_length_and_refusals_are_returned() {
    let mut rig = Rig::new();
    let long: Vec<u8> = (0..LONGEST).map(|at| at as u8).collect();
    rig.has(0x2000, &long);
    rig.has(0x2001, &[long.as_slice(), &[1]].concat());
    rig.has(0x2002, &[1, 2]);
    for index in [0x2000, 0x2001, 0x2002, 0x2003] {
        rig.ask(3, index, Access::Read).expect("there is room");
    }
    let answers = rig.serve(4);
    assert_eq!(answers[0].as_ref(), Ok(&long));
    assert_eq!(answers[1], Err(ObjectAccessError::Long(Object { index: 0x2001, sub: 0 })));
    assert_eq!(answers[2], Ok(vec![1, 2]));
    let refused = answers[3].as_ref().expect_err("there is no such object").to_string();
    assert_eq!(refused, "2003h:00: the device refuses: the object does not exist (06020000h)");
}

#[test]
fn silent_node_times_out_and_does_not_block_others() {
    let mut rig = Rig::new();
    rig.has(0x2002, &[1, 2]);
    rig.ask(9, 0x2002, Access::Read).expect("there is room");
    rig.ask(3, 0x2002, Access::Read).expect("there is room");
    let answers = rig.serve(2);
    let silent = answers[0].as_ref().expect_err("nobody is there").to_string();
    assert_eq!(silent, "2002h:00: the device has not answered for 20 ms");
    assert_eq!(answers[1], Ok(vec![1, 2]));
}

#[test]
fn write_is_refused_while_drive_is_under_power() {
    let mut rig = Rig::new();
    for (status, refused) in [
        (0x0637_u16, Some(DriveState::Enabled)),
        (0x0617, Some(DriveState::QuickStop)),
        (0x061F, Some(DriveState::FaultReaction)),
        (0x0633, None),
        (0x0650, None),
        (0x0618, None),
    ] {
        rig.has(0x6041, &status.to_le_bytes());
        rig.write(0x607A, true);
        rig.write(0x2000, false);
        let answers = rig.serve(2);
        let object = Object { index: 0x607A, sub: 0 };
        let expected = refused.map_or(Ok(Vec::new()), |state| Err(ObjectAccessError::Power(object, state)));
        assert_eq!(answers, [expected, Ok(Vec::new())], "{status:04X}");
        let (first, second) = ((0x607A, vec![7, 0]), (0x2000, vec![7, 0]));
        assert_eq!(rig.written(), if refused.is_some() { vec![second] } else { vec![first, second] }, "{status:04X}");
    }
    rig.has(0x6041, &[0x37]);
    rig.write(0x607A, true);
    assert!(matches!(rig.serve(1).as_slice(), [Err(ObjectAccessError::NoState(..))]), "half a word says nothing");
    assert_eq!(rig.written(), []);
}

#[test]
fn cancelled_request_is_never_started_and_started_one_cannot_be_cancelled() {
    let mut rig = Rig::new();
    rig.has(0x2002, &[1, 2]);
    let ticket = rig.ask(3, 0x2002, Access::Write { data: vec![1], without_power: false }).expect("there is room");
    assert!(ticket.cancel());
    let ticket = rig.ask(3, 0x2002, Access::Read).expect("there is room");
    assert_eq!(rig.serve(1), [Ok(vec![1, 2])], "only what was not taken back is answered");
    assert!(!ticket.cancel());
    assert_eq!(rig.written(), []);
}

#[test]
fn full_queue_lost_connection_and_closed_bus_answer_at_once() {
    let mut rig = Rig::new();
    for _ in 0..MOST_WAITING {
        rig.ask(3, 0x2002, Access::Read).expect("there is room");
    }
    assert_eq!(rig.ask(3, 0x2002, Access::Read).expect_err("it is full"), ObjectAccessError::Full);
    rig.line.serve(&mut rig.port, Some("the cable is out"));
    let answers: Vec<_> = rig.answers.lock().expect("one thread").drain(..).collect();
    assert_eq!(answers, vec![Err(ObjectAccessError::Lost("the cable is out".to_owned())); MOST_WAITING]);
    rig.ask(3, 0x2002, Access::Read).expect("there is room");
    rig.line.reject_all();
    assert_eq!(rig.answers.lock().expect("one thread").drain(..).collect::<Vec<_>>(), [Err(ObjectAccessError::Closed)]);
    let Rig { objects, line, .. } = rig;
    drop(line);
    let asked = objects.submit(NodeId::new(3).expect("1 to 127"), STATUS, Access::Read, |_| ());
    assert_eq!(asked.expect_err("nobody serves"), ObjectAccessError::Closed);
}
