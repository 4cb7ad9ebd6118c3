//! Objects of CANopen drives that somebody else has written: read and written over slcan, as a user's adapter does it.

mod support;

use lineshaft_can::sdo::{Client, Object, Transfer};
use lineshaft_can::transport::{SlcanLine, Transport, slcan};
use lineshaft_can::{Life, NmtCommand, NmtState, NodeId};
use std::net::TcpStream;
use std::thread;
use std::time::{Duration, Instant};
use support::can::CanDrives;

const TIMEOUT_NS: u64 = 500_000_000;
const NAME: Object = Object { index: 0x1008, sub: 0 };
const ECHO: Object = Object { index: 0x2001, sub: 0 };

/// A bus with one drive of which objects are asked.
struct Bus {
    line: SlcanLine<TcpStream>,
    client: Client,
    began: Instant,
}

impl Bus {
    fn open(drives: &CanDrives, node: u8) -> Self {
        let node = NodeId::new(node).expect("1 to 127");
        let mut line = SlcanLine::new(drives.connect());
        line.open(slcan::bit_rate(1000).expect("adapters know it")).expect("the adapter listens");
        Self { line, client: Client::new(node.sdo_request(), node.sdo_response(), TIMEOUT_NS), began: Instant::now() }
    }

    fn now_ns(&self) -> u64 {
        self.began.elapsed().as_nanos() as u64
    }

    /// Runs the transfer that has begun to its end.
    fn finish(&mut self) -> Transfer {
        loop {
            self.send_all();
            let heard = self.line.receive().expect("the adapter is there");
            let now_ns = self.now_ns();
            let done = heard.and_then(|frame| self.client.receive(&frame, now_ns));
            if let Some(done) = done.or_else(|| self.client.tick(now_ns)) {
                // What ends a transfer on the bus, too.
                self.send_all();
                return done;
            }
            if heard.is_none() {
                thread::sleep(Duration::from_micros(200));
            }
        }
    }

    fn send_all(&mut self) {
        while let Some(frame) = self.client.next_frame() {
            self.line.send(&frame).expect("the adapter is there");
        }
        self.line.flush().expect("the adapter is there");
    }

    fn read(&mut self, object: Object, in_blocks: bool) -> Result<Vec<u8>, String> {
        self.client.upload(object, Vec::with_capacity(4096), in_blocks, self.now_ns()).expect("one at a time");
        let done = self.finish();
        done.result.map(|()| done.data).map_err(|error| error.to_string())
    }

    fn write(&mut self, object: Object, data: &[u8], in_blocks: bool) -> Result<(), String> {
        self.client.download(object, data.to_vec(), in_blocks, self.now_ns()).expect("one at a time");
        self.finish().result.map_err(|error| error.to_string())
    }
}

/// Numbers in one frame, texts in segments and in blocks, both ways; a device that knows no blocks; segments that get lost.
#[test]
fn objects_are_read_and_written() {
    let mut drives = CanDrives::boot("1-2");
    let mut bus = Bus::open(&drives, 1);
    for in_blocks in [false, true] {
        assert_eq!(bus.read(NAME, in_blocks), Ok(b"cia402-sim".to_vec()));
        assert_eq!(bus.read(Object { index: 0x1018, sub: 2 }, in_blocks), Ok(0x4020_0001_u32.to_le_bytes().to_vec()));
    }
    assert_eq!(bus.write(Object { index: 0x1017, sub: 0 }, &100_u16.to_le_bytes(), true), Ok(()));
    assert_eq!(bus.read(Object { index: 0x1017, sub: 0 }, false), Ok(vec![100, 0]));
    // Lengths about one segment, one block, and several.
    for length in [5, 7, 8, 32, 49, 889, 890, 2000] {
        let text: Vec<u8> = (b'a'..=b'z').cycle().take(length).collect();
        for (in_blocks, knows_blocks, lost) in [(false, 1, 0), (true, 1, 0), (true, 0, 0), (true, 1, 3)] {
            drives.tell(&format!("sdo_block 1 {knows_blocks}"));
            drives.tell(&format!("sdo_block_drop 1 {lost}"));
            bus.write(ECHO, b"something else", false).unwrap();
            let case = format!("{length} bytes, blocks {in_blocks}, known {knows_blocks}, lost {lost}");
            assert_eq!(bus.write(ECHO, &text, in_blocks), Ok(()), "{case}");
            drives.tell("sdo_block_drop 1 0");
            assert_eq!(bus.read(ECHO, in_blocks), Ok(text.clone()), "{case}");
        }
    }
}

/// What a drive refuses, in words, and one that is silent: the next transfer works.
#[test]
fn a_drive_refuses_or_is_silent_and_the_next_transfer_works() {
    let mut drives = CanDrives::boot("3");
    let mut bus = Bus::open(&drives, 3);
    let refused = "5FFFh:00: the device refuses: the object does not exist (06020000h)";
    assert_eq!(bus.read(Object { index: 0x5FFF, sub: 0 }, false), Err(refused.to_owned()));
    let refused = "1008h:00: the device refuses: the object can only be read (06010002h)";
    assert_eq!(bus.write(NAME, b"another name", false), Err(refused.to_owned()));
    drives.tell("sdo_abort 3 0x1008 0 0x08000022");
    let refused = "the data cannot be stored in the present state of the device (08000022h)";
    assert!(bus.read(NAME, false).unwrap_err().ends_with(refused));
    drives.tell("sdo_abort 3 0x1008 0 0");
    drives.tell("sdo_mute 3 1");
    assert_eq!(bus.read(NAME, false), Err("1008h:00: the device has not answered for 500 ms".to_owned()));
    drives.tell("sdo_mute 3 0");
    assert_eq!(bus.read(NAME, true), Ok(b"cia402-sim".to_vec()));
}

/// A drive that is reset boots, tells it, and is pre-operational; started, it is operational.
#[test]
fn a_drive_that_is_reset_boots() {
    let drives = CanDrives::boot("5");
    let mut bus = Bus::open(&drives, 5);
    let node = NodeId::new(5).unwrap();
    let next = |bus: &mut Bus| loop {
        match bus.line.receive().unwrap() {
            Some(frame) if frame.id() == node.heartbeat() => return Life::of(&frame).unwrap().state,
            Some(_) => {}
            None => thread::sleep(Duration::from_micros(200)),
        }
        assert!(bus.began.elapsed() < Duration::from_secs(60), "no sign of life");
    };
    bus.line.send(&NmtCommand::ResetNode.frame(Some(node))).unwrap();
    assert_eq!(next(&mut bus), NmtState::BootUp);
    bus.write(Object { index: 0x1017, sub: 0 }, &20_u16.to_le_bytes(), false).unwrap();
    assert_eq!(next(&mut bus), NmtState::PreOperational);
    bus.line.send(&NmtCommand::Start.frame(None)).unwrap();
    while next(&mut bus) != NmtState::Operational {}
}
