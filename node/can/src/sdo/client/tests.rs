use super::*;
use proptest::prelude::*;

const REQUEST: Id = Id::of_function(0x600, 1);
const RESPONSE: Id = Id::of_function(0x580, 1);
const OBJECT: Object = Object { index: 0x1008, sub: 0 };
const TIMEOUT_NS: u64 = 500_000_000;

fn client() -> Client {
    Client::new(REQUEST, RESPONSE, TIMEOUT_NS)
}

fn answer(bytes: [u8; 8]) -> Frame {
    Frame::of(RESPONSE, bytes)
}

/// Returns all frames to be sent.
fn sent(client: &mut Client) -> Vec<Vec<u8>> {
    std::iter::from_fn(|| client.next_frame()).map(|frame| frame.bytes().to_vec()).collect()
}

/// Bytes of CiA 301 for an expedited transfer.
#[test]
fn up_to_four_bytes_go_in_one_frame() {
    let cases: [(&[u8], [u8; 8]); 4] = [
        (&[8], [0x2F, 0x60, 0x60, 0, 8, 0, 0, 0]),
        (&[6, 0], [0x2B, 0x60, 0x60, 0, 6, 0, 0, 0]),
        (&[1, 2, 3], [0x27, 0x60, 0x60, 0, 1, 2, 3, 0]),
        (&[1, 2, 3, 4], [0x23, 0x60, 0x60, 0, 1, 2, 3, 4]),
    ];
    let object = Object { index: 0x6060, sub: 0 };
    for (data, frame) in cases {
        let mut client = client();
        client.download(object, data.to_vec(), true, 0).unwrap();
        assert_eq!(sent(&mut client), [frame]);
        let done = client.receive(&answer([0x60, 0x60, 0x60, 0, 0, 0, 0, 0]), 1).unwrap();
        assert_eq!((done.data.as_slice(), done.result), (data, Ok(())));
        assert!(client.is_idle() && sent(&mut client).is_empty());

        client.upload(object, Vec::with_capacity(4), false, 0).unwrap();
        assert_eq!(sent(&mut client), [[0x40, 0x60, 0x60, 0, 0, 0, 0, 0]]);
        let mut bytes = [0x43 | ((4 - data.len()) as u8) << 2, 0x60, 0x60, 0, 0, 0, 0, 0];
        bytes[4..4 + data.len()].copy_from_slice(data);
        assert_eq!(client.receive(&answer(bytes), 1).unwrap().data, data);
    }
}

/// A name of 10 bytes is read in two segments; the toggle bit starts at 0.
#[test]
fn longer_values_go_in_segments() {
    let mut client = client();
    client.upload(OBJECT, Vec::with_capacity(10), false, 0).unwrap();
    sent(&mut client);
    assert_eq!(client.receive(&answer([0x41, 0x08, 0x10, 0, 10, 0, 0, 0]), 1), None);
    assert_eq!(sent(&mut client), [[0x60, 0, 0, 0, 0, 0, 0, 0]]);
    assert_eq!(client.receive(&answer(*b"\x00Linesha"), 2), None);
    assert_eq!(sent(&mut client), [[0x70, 0, 0, 0, 0, 0, 0, 0]]);
    let done = client.receive(&answer(*b"\x19ft1\0\0\0\0"), 3).unwrap();
    assert_eq!((done.data.as_slice(), done.result), (&b"Lineshaft1"[..], Ok(())));

    client.download(OBJECT, b"Lineshaft1".to_vec(), false, 4).unwrap();
    assert_eq!(sent(&mut client), [[0x21, 0x08, 0x10, 0, 10, 0, 0, 0]]);
    client.receive(&answer([0x60, 0x08, 0x10, 0, 0, 0, 0, 0]), 5);
    assert_eq!(sent(&mut client), [*b"\x00Linesha"]);
    client.receive(&answer([0x20, 0, 0, 0, 0, 0, 0, 0]), 6);
    assert_eq!(sent(&mut client), [*b"\x19ft1\0\0\0\0"]);
    assert_eq!(client.receive(&answer([0x30, 0, 0, 0, 0, 0, 0, 0]), 7).unwrap().result, Ok(()));
}

#[test]
fn invalid_answer_is_aborted() {
    let begun = |first: [u8; 8]| {
        let mut client = client();
        client.upload(OBJECT, Vec::with_capacity(32), false, 0).unwrap();
        sent(&mut client);
        let done = client.receive(&answer(first), 1);
        (client, done)
    };
    // Wrong toggle bit, other command, more bytes than announced, fewer bytes than announced.
    let cases: [(&[[u8; 8]], Abort); 4] = [
        (&[[0x10, 1, 2, 3, 4, 5, 6, 7]], Abort::TOGGLE),
        (&[[0x60, 0x08, 0x10, 0, 0, 0, 0, 0]], Abort::COMMAND),
        (&[[0x01, 1, 2, 3, 4, 5, 6, 7]], Abort::LENGTH),
        (&[[0x00, 1, 2, 3, 4, 5, 6, 7], [0x1D, 1, 0, 0, 0, 0, 0, 0]], Abort::LENGTH),
    ];
    for (answers, abort) in cases {
        let (mut client, none) = begun([0x41, 0x08, 0x10, 0, 9, 0, 0, 0]);
        assert_eq!(none, None);
        let done = answers.iter().find_map(|bytes| {
            sent(&mut client);
            client.receive(&answer(*bytes), 2)
        });
        assert_eq!(done.unwrap().result, Err(SdoError::Wrong(OBJECT, abort)));
        let [a, b, c, d] = abort.0.to_le_bytes();
        assert_eq!(sent(&mut client), [[0x80, 0x08, 0x10, 0, a, b, c, d]]);
        assert!(client.is_idle());
    }
    let (_, done) = begun([0x41, 0x08, 0x10, 0, 33, 0, 0, 0]);
    assert_eq!(done.unwrap().result, Err(SdoError::Wrong(OBJECT, Abort::MEMORY)), "no room");
}

/// Wrong checksum, block without segments, more segments acknowledged than sent, announced size not kept.
#[test]
fn blocks_that_do_not_fit_are_aborted() {
    let upload = |told: u8, end: [u8; 8]| {
        let mut client = client();
        client.upload(OBJECT, Vec::with_capacity(32), true, 0).unwrap();
        sent(&mut client);
        client.receive(&answer([0xC6, 0x08, 0x10, 0, told, 0, 0, 0]), 1);
        assert_eq!(sent(&mut client), [[0xA3, 0, 0, 0, 0, 0, 0, 0]]);
        client.receive(&answer(*b"\x01Linesha"), 2);
        client.receive(&answer(*b"\x82ft1\0\0\0\0"), 3);
        assert_eq!(sent(&mut client), [[0xA2, 2, 127, 0, 0, 0, 0, 0]]);
        client.receive(&answer(end), 4).map(|done| done.result)
    };
    let [low, high] = crc(0, b"Lineshaft1").to_le_bytes();
    let wrong = |abort| Some(Err(SdoError::Wrong(OBJECT, abort)));
    assert_eq!(upload(10, [0xD1, low, high, 0, 0, 0, 0, 0]), Some(Ok(())));
    assert_eq!(upload(10, [0xD1, low ^ 1, high, 0, 0, 0, 0, 0]), wrong(Abort::CRC));
    assert_eq!(upload(11, [0xD1, low, high, 0, 0, 0, 0, 0]), wrong(Abort::LENGTH));

    let download = |answers: &[[u8; 8]]| {
        let mut client = client();
        client.download(OBJECT, vec![7; 100], true, 0).unwrap();
        answers.iter().find_map(|bytes| {
            sent(&mut client);
            client.receive(&answer(*bytes), 1).map(|done| done.result)
        })
    };
    let begun = |size| [0xA4, 0x08, 0x10, 0, size, 0, 0, 0];
    assert_eq!(download(&[begun(0)]), wrong(Abort::BLOCK_SIZE));
    assert_eq!(download(&[begun(128)]), wrong(Abort::BLOCK_SIZE));
    assert_eq!(download(&[begun(4), [0xA2, 5, 4, 0, 0, 0, 0, 0]]), wrong(Abort::SEQUENCE));
    assert_eq!(download(&[begun(4), [0xA2, 4, 0, 0, 0, 0, 0, 0]]), wrong(Abort::BLOCK_SIZE));
    // After repeated acknowledgements of nothing the transfer is aborted.
    let nothing = [[0xA2, 0, 4, 0, 0, 0, 0, 0]; 9];
    assert_eq!(download(&[&[begun(4)][..], &nothing].concat()), wrong(Abort::SEQUENCE));
    assert_eq!(download(&[&[begun(4)][..], &nothing[..8]].concat()), None);
}

#[test]
fn silent_device_times_out_and_late_answer_is_ignored() {
    let mut client = client();
    client.upload(OBJECT, Vec::with_capacity(8), false, 0).unwrap();
    sent(&mut client);
    assert_eq!(client.tick(TIMEOUT_NS - 1), None);
    let done = client.tick(TIMEOUT_NS).unwrap();
    assert_eq!(done.result.unwrap_err().to_string(), "1008h:00: the device has not answered for 500 ms");
    assert_eq!(sent(&mut client), [[0x80, 0x08, 0x10, 0, 0, 0, 0x04, 0x05]]);
    let late = answer([0x4F, 0x08, 0x10, 0, 7, 0, 0, 0]);
    assert_eq!(client.receive(&late, TIMEOUT_NS + 1), None);
    let next = Object { index: 0x1018, sub: 1 };
    client.upload(next, Vec::with_capacity(8), false, TIMEOUT_NS + 2).unwrap();
    assert_eq!(client.receive(&late, TIMEOUT_NS + 3), None);
    let done = client.receive(&answer([0x43, 0x18, 0x10, 1, 1, 2, 3, 4]), TIMEOUT_NS + 4).unwrap();
    assert_eq!((done.object, done.data.as_slice()), (next, &[1, 2, 3, 4][..]));
}

#[test]
fn refusal_contains_abort_code() {
    let mut client = client();
    let object = Object { index: 0x6040, sub: 3 };
    client.download(object, vec![1], false, 0).unwrap();
    sent(&mut client);
    let done = client.receive(&answer([0x80, 0x40, 0x60, 3, 0x11, 0, 0x09, 0x06]), 1).unwrap();
    let said = done.result.unwrap_err().to_string();
    assert_eq!(said, "6040h:03: the device refuses: the subindex does not exist (06090011h)");
    assert_eq!(Abort(0x0F00_FFC0).to_string(), "abort code 0F00FFC0h of the device");
}

/// Simulated device with block transfer, segmented transfer, or both, on a bus that loses some segments.
struct Device {
    value: Vec<u8>,
    knows_blocks: bool,
    block: u8,
    /// Running numbers of the block segments that are lost.
    lost: Vec<usize>,
    count: usize,
    step: Step,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Step {
    Idle,
    Download { toggle: bool },
    Upload { at: usize, toggle: bool },
    Block { got: u8 },
    BlockEnd,
    Send { start: usize },
    SendEnd,
}

impl Device {
    fn new(value: &[u8], knows_blocks: bool, block: u8, lost: &[usize]) -> Self {
        Self { value: value.to_vec(), knows_blocks, block, lost: lost.to_vec(), count: 0, step: Step::Idle }
    }

    fn loses(&mut self) -> bool {
        self.count += 1;
        self.lost.contains(&self.count)
    }

    fn block_from(&mut self, start: usize) -> Vec<[u8; 8]> {
        self.step = Step::Send { start };
        let mut frames = Vec::new();
        for number in 1..=BLOCK {
            let at = start + usize::from(number - 1) * 7;
            let rest = &self.value[at..];
            let mut frame = [number | u8::from(rest.len() <= 7) << 7, 0, 0, 0, 0, 0, 0, 0];
            frame[1..1 + rest.len().min(7)].copy_from_slice(&rest[..rest.len().min(7)]);
            let is_last = rest.len() <= 7;
            // The segment that ends a block is never lost, because no side would request it again.
            if is_last || number == BLOCK || !self.loses() {
                frames.push(frame);
            }
            if is_last {
                break;
            }
        }
        frames
    }

    fn hear(&mut self, bytes: [u8; 8]) -> Vec<[u8; 8]> {
        let [command, low, high, sub, a, b, c, d] = bytes;
        let size = u32::from_le_bytes([a, b, c, d]).to_le_bytes();
        let length = (self.value.len() as u32).to_le_bytes();
        match (self.step, command) {
            (_, 0x80) => {
                self.step = Step::Idle;
                vec![]
            }
            (Step::Idle, 0xC6 | 0xA4) if !self.knows_blocks => vec![[0x80, low, high, sub, 1, 0, 0x04, 0x05]],
            (Step::Idle, 0x21) => {
                assert!(u32::from_le_bytes(size) < 1 << 20);
                self.value.clear();
                self.step = Step::Download { toggle: false };
                vec![[0x60, low, high, sub, 0, 0, 0, 0]]
            }
            (Step::Idle, 0x20..0x30) => {
                self.value = vec![a, b, c, d];
                self.value.truncate(4 - usize::from(command >> 2 & 3));
                vec![[0x60, low, high, sub, 0, 0, 0, 0]]
            }
            (Step::Download { toggle }, _) => {
                assert_eq!(command >> 4 & 1 == 1, toggle);
                let used = 7 - usize::from(command >> 1 & 7);
                self.value.extend_from_slice(&bytes[1..1 + used]);
                self.step = if command & 1 == 1 { Step::Idle } else { Step::Download { toggle: !toggle } };
                vec![[0x20 | u8::from(toggle) << 4, 0, 0, 0, 0, 0, 0, 0]]
            }
            (Step::Idle, 0x40) => {
                self.step = Step::Upload { at: 0, toggle: false };
                vec![[0x41, low, high, sub, length[0], length[1], length[2], length[3]]]
            }
            (Step::Upload { at, toggle }, _) => {
                assert_eq!(command, 0x60 | u8::from(toggle) << 4);
                let rest = &self.value[at..];
                let used = rest.len().min(7);
                let is_last = rest.len() <= 7;
                let lead = u8::from(toggle) << 4 | ((7 - used) as u8) << 1 | u8::from(is_last);
                let mut frame = [lead, 0, 0, 0, 0, 0, 0, 0];
                frame[1..1 + used].copy_from_slice(&rest[..used]);
                self.step = if is_last { Step::Idle } else { Step::Upload { at: at + 7, toggle: !toggle } };
                vec![frame]
            }
            (Step::Idle, 0xC6) => {
                self.value.clear();
                self.step = Step::Block { got: 0 };
                vec![[0xA4, low, high, sub, self.block, 0, 0, 0]]
            }
            (Step::Block { got }, _) => {
                let (number, is_last) = (command & 0x7F, command & 0x80 != 0);
                let mut got = got;
                let ends = is_last || number == self.block;
                if number == got + 1 && (ends || !self.loses()) {
                    self.value.extend_from_slice(&bytes[1..]);
                    got = number;
                }
                self.step = Step::Block { got };
                if !ends {
                    return vec![];
                }
                self.step = if is_last && got == number { Step::BlockEnd } else { Step::Block { got: 0 } };
                vec![[0xA2, got, self.block, 0, 0, 0, 0, 0]]
            }
            (Step::BlockEnd, _) => {
                assert_eq!(command & 0xE3, 0xC1);
                self.value.truncate(self.value.len() - usize::from(command >> 2 & 7));
                assert_eq!(u16::from_le_bytes([low, high]), crc(0, &self.value));
                self.step = Step::Idle;
                vec![[0xA1, 0, 0, 0, 0, 0, 0, 0]]
            }
            (Step::Idle, 0xA4) => {
                self.step = Step::Send { start: 0 };
                vec![[0xC6, low, high, sub, length[0], length[1], length[2], length[3]]]
            }
            (Step::Send { .. }, 0xA3) => self.block_from(0),
            (Step::Send { start }, 0xA2) => {
                let start = start + usize::from(low) * 7;
                if start < self.value.len() {
                    return self.block_from(start);
                }
                self.step = Step::SendEnd;
                let unused = (7 - self.value.len() % 7) % 7;
                let [c0, c1] = crc(0, &self.value).to_le_bytes();
                vec![[0xC1 | (unused as u8) << 2, c0, c1, 0, 0, 0, 0, 0]]
            }
            (Step::SendEnd, 0xA1) => {
                self.step = Step::Idle;
                vec![]
            }
            other => panic!("{other:?}"),
        }
    }
}

/// Runs a transfer to its end.
fn run(client: &mut Client, device: &mut Device) -> Transfer {
    for _ in 0..100_000 {
        let frame = client.next_frame().expect("something to send until the end");
        for heard in device.hear(frame.bytes().try_into().unwrap()) {
            if let Some(done) = client.receive(&answer(heard), 0) {
                for last in sent(client) {
                    device.hear(last.try_into().unwrap());
                }
                return done;
            }
        }
    }
    panic!("no end");
}

proptest! {
    /// Each byte arrives exactly once, with any length, block size and lost segments.
    #[test]
    fn each_byte_arrives_once(
        value in prop::collection::vec(any::<u8>(), 1..3000),
        knows_blocks: bool,
        in_blocks: bool,
        block in 1_u8..=127,
        lost in prop::collection::vec(1_usize..400, 0..20),
    ) {
        let mut client = client();
        let mut device = Device::new(&[], knows_blocks, block, &lost);
        client.download(OBJECT, value.clone(), in_blocks, 0).unwrap();
        let done = run(&mut client, &mut device);
        prop_assert_eq!(done.result, Ok(()));
        prop_assert_eq!((&device.value, device.step), (&value, Step::Idle));

        let mut device = Device::new(&value, knows_blocks, block, &lost);
        let room = Vec::with_capacity(value.len() + 7);
        let place = room.as_ptr();
        client.upload(OBJECT, room, in_blocks, 0).unwrap();
        let done = run(&mut client, &mut device);
        prop_assert_eq!((done.result, &done.data, device.step), (Ok(()), &value, Step::Idle));
        prop_assert_eq!(done.data.as_ptr(), place, "no memory was taken");
    }

    /// Any answers: no panic, the transfer ends, and it never has more bytes than its buffer.
    #[test]
    fn random_answers_cause_no_panic(
        answers in prop::collection::vec(any::<[u8; 8]>(), 0..300),
        leads in prop::collection::vec(prop::sample::select(vec![0x60, 0x41, 0xC6, 0xA4, 0xA2, 0x20, 0x30, 0x80, 0xC1]), 0..300),
        upload: bool,
        in_blocks: bool,
    ) {
        let mut client = client();
        if upload {
            client.upload(OBJECT, Vec::with_capacity(100), in_blocks, 0).unwrap();
        } else {
            client.download(OBJECT, vec![7; 100], in_blocks, 0).unwrap();
        }
        for (index, mut bytes) in answers.into_iter().enumerate() {
            sent(&mut client);
            if let Some(lead) = leads.get(index) {
                bytes[0] = *lead;
                bytes[1..4].copy_from_slice(&OBJECT.mux());
            }
            if let Some(done) = client.receive(&answer(bytes), 0) {
                prop_assert!(done.data.len() <= done.data.capacity() && client.is_idle());
                break;
            }
        }
        client.tick(u64::MAX);
        prop_assert!(client.is_idle());
    }
}
