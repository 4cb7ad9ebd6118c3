//! Tests with virtual interfaces, which need kernel support: tests/socketcan.sh runs them with such a kernel.

use super::*;
use crate::Id;
use std::process::Command;
use std::thread;
use std::time::{Duration, Instant};

/// Virtual interface that is removed when dropped.
struct Interface(&'static str);

impl Interface {
    fn up(name: &'static str) -> Self {
        run("ip", &format!("link add {name} type vcan"));
        run("ip", &format!("link set {name} up"));
        Self(name)
    }

    fn set(&self, state: &str) {
        run("ip", &format!("link set {} {state}", self.0));
    }

    fn open(&self) -> SocketCan {
        SocketCan::open(self.0).unwrap()
    }
}

impl Drop for Interface {
    fn drop(&mut self) {
        // The test may have removed it already.
        let _ = Command::new("ip").args(["link", "del", self.0]).output();
    }
}

fn run(program: &str, arguments: &str) {
    let status = Command::new(program).args(arguments.split(' ')).status();
    assert!(status.is_ok_and(|status| status.success()), "{program} {arguments}");
}

fn frame(id: u16, data: &[u8]) -> Frame {
    Frame::data(Id::new(id).unwrap(), data).unwrap()
}

/// Polls until the condition is true, because the kernel delivers frames with a delay.
fn until(what: &str, mut is_so: impl FnMut() -> bool) {
    let began = Instant::now();
    while !is_so() {
        assert!(began.elapsed() < Duration::from_secs(60), "{what}");
        thread::sleep(Duration::from_millis(1));
    }
}

/// Returns this number of received frames.
fn received(bus: &mut SocketCan, number: usize) -> Vec<Frame> {
    let mut all = Vec::new();
    until("frames come", || {
        all.extend(std::iter::from_fn(|| bus.receive().expect("the interface is up")));
        all.len() >= number
    });
    all
}

#[test]
#[ignore = "needs a kernel with vcan: tests/socketcan.sh"]
fn frame_is_received_and_extended_frames_are_filtered() {
    let interface = Interface::up("vcan1");
    let (mut first, mut second) = (interface.open(), interface.open());
    let remote = Frame::remote(Id::new(0x705).unwrap(), 1).unwrap();
    first.send(&frame(0x201, &[1, 2, 3])).unwrap();
    first.socket.write_all(&raw(0x8000_0201, [0; 8])).unwrap();
    first.send(&remote).unwrap();
    assert_eq!(received(&mut second, 2), [frame(0x201, &[1, 2, 3]), remote]);
    assert_eq!((first.receive().unwrap(), second.state(), second.faults()), (None, BusState::Active, 0));
}

/// Returns the bytes of a frame of the kernel.
fn raw(word: u32, data: [u8; 8]) -> [u8; SIZE] {
    let mut bytes = [0; SIZE];
    bytes[..4].copy_from_slice(&word.to_ne_bytes());
    bytes[4] = 8;
    bytes[8..].copy_from_slice(&data);
    bytes
}

/// Error frames as a controller sends them: any socket may send them on a virtual interface.
#[test]
#[ignore = "needs a kernel with vcan: tests/socketcan.sh"]
fn the_controller_tells_how_the_bus_does() {
    const ERROR: u32 = 1 << 29;
    let interface = Interface::up("vcan2");
    let (mut controller, mut bus) = (interface.open(), interface.open());
    let states = [
        (ERROR | 0x04, 0x10, BusState::Degraded),
        (ERROR | 0x40, 0, BusState::Off),
        (ERROR | 0x100, 0, BusState::Active),
    ];
    for (word, detail, state) in states {
        controller.socket.write_all(&raw(word, [0, detail, 0, 0, 0, 0, 0, 0])).unwrap();
        until("the state comes", || bus.receive().unwrap().is_none() && bus.state() == state);
    }
    controller.socket.write_all(&raw(ERROR | 0x04, [0, 0x01, 0, 0, 0, 0, 0, 0])).unwrap();
    until("the overrun is counted", || bus.receive().unwrap().is_none() && bus.faults() == 1);
    assert_eq!(bus.state(), BusState::Active);
}

#[test]
#[ignore = "needs a kernel with vcan: tests/socketcan.sh"]
fn interface_down_or_removed_is_lost_and_refused_when_opened() {
    let interface = Interface::up("vcan3");
    let mut bus = interface.open();
    interface.set("down");
    let error = bus.receive().unwrap_err().to_string();
    assert_eq!(error, "the way to the bus is lost: Network is down (os error 100)");
    let down = SocketCan::open(interface.0).unwrap_err().to_string();
    assert!(down.starts_with("the interface is down; bring it up (sudo ip link set vcan3 up"), "{down}");
    interface.set("up");
    assert_eq!(bus.send(&frame(0, &[])).unwrap_err().to_string(), error, "it stays lost");

    let (mut sends, mut hears) = (interface.open(), interface.open());
    interface.set("down");
    let error = sends.send(&frame(0, &[])).unwrap_err().to_string();
    assert_eq!(
        (error.as_str(), sends.state()),
        ("the way to the bus is lost: Network is down (os error 100)", BusState::Off)
    );
    interface.set("up");
    // The pending error is not lost.
    assert!(hears.receive().is_err());

    let mut bus = interface.open();
    run("ip", "link del vcan3");
    let error = bus.receive().unwrap_err().to_string();
    assert_eq!(error, "the way to the bus is lost: No such device (os error 19)");
    let gone = SocketCan::open("vcan3").unwrap_err().to_string();
    assert!(gone.starts_with("there is no CAN interface vcan3; "), "{gone}");
    let other = SocketCan::open("lo").unwrap_err().to_string();
    assert!(other.starts_with("there is no CAN interface lo; "), "{other}");
}

/// The queue of the interface has room for 4 frames, each delayed by 2 ms: further frames are sent later in their order.
#[test]
#[ignore = "needs a kernel with vcan and sch_netem: tests/socketcan.sh"]
fn full_interface_queues_frames() {
    let interface = Interface::up("vcan4");
    run("tc", "qdisc add dev vcan4 root netem limit 4 delay 2ms");
    let (mut sends, mut hears) = (interface.open(), interface.open());
    let all: Vec<_> = (0..100).map(|id| frame(id, &[])).collect();
    for frame in &all {
        sends.send(frame).unwrap();
    }
    assert!(sends.waiting.first().is_some(), "the interface has taken everything");
    let mut heard = Vec::new();
    until("all of them come", || {
        sends.flush().unwrap();
        heard.extend(std::iter::from_fn(|| hears.receive().unwrap()));
        heard.len() >= all.len()
    });
    assert_eq!(heard, all);
    // Frames beyond the queue are refused.
    run("tc", "qdisc replace dev vcan4 root netem limit 4 delay 60s");
    let refused = (0..1000).find_map(|id| sends.send(&frame(id, &[])).err()).unwrap();
    assert_eq!(refused.to_string(), "the bus takes no more frames: 256 of them wait");
    sends.controller_tells(Some(BusState::Off), false);
    assert_eq!(sends.waiting.first(), None, "an old command must not come late");
}
