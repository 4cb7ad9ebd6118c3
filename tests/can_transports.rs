//! Tests each transport to a bus of independent CANopen drives: reached, disconnected, absent.

use crate::support::can::{Bus, BusConnection, CanDrives};
use crate::support::{namespace, setup};
use lineshaft_can::transport::{Options, Transport, TransportError, open};
use lineshaft_can::{NmtCommand, NmtState, NodeId};
use lineshaft_cia402::object::Object;
use lineshaft_core::drive::BusState;
use std::thread;
use std::time::{Duration, Instant};

const NAME: Object = Object { index: 0x1008, sub: 0 };
const ECHO: Object = Object { index: 0x2001, sub: 0 };
const OPTIONS: Options = Options { bit_rate: 500_000, baud: None };

/// Objects of one frame and of many, and a reset that the drive reports.
fn drives_are_reached(way: BusConnection) {
    let drives = CanDrives::boot_on(way, "1-2");
    let mut bus = Bus::open(&drives, 2);
    assert_eq!(bus.read(NAME, false), Ok(b"cia402-sim".to_vec()));
    let text: Vec<u8> = (b'a'..=b'z').cycle().take(2000).collect();
    for in_blocks in [false, true] {
        assert_eq!(bus.write(ECHO, &text, in_blocks), Ok(()));
        assert_eq!(bus.read(ECHO, in_blocks), Ok(text.clone()));
    }
    bus.send(&NmtCommand::ResetNode.frame(NodeId::new(2)));
    assert_eq!(bus.next_state(), NmtState::BootUp);
    assert_eq!((bus.way.state(), bus.way.faults()), (BusState::Active, 0));
    bus.way.close();
}

/// Receives until the transport is lost.
fn loss(way: &mut dyn Transport) -> TransportError {
    let began = Instant::now();
    loop {
        match way.receive() {
            Err(error) => return error,
            Ok(Some(_)) => {}
            Ok(None) => thread::sleep(Duration::from_millis(1)),
        }
        assert!(began.elapsed() < Duration::from_secs(60), "the way is not lost");
    }
}

/// A transport that is disconnected while the bus is open is lost permanently.
fn pulled_adapters_are_lost(way: BusConnection) -> CanDrives {
    let mut drives = CanDrives::boot_on(way, "1");
    let mut bus = Bus::open(&drives, 1);
    assert_eq!(bus.read(NAME, false), Ok(b"cia402-sim".to_vec()));
    drives.kill();
    let error = loss(&mut *bus.way);
    assert!(matches!(error, TransportError::Lost(_)), "{error}");
    assert_eq!(bus.way.state(), BusState::Off);
    let again = bus.way.send(&NmtCommand::Start.frame(None)).expect_err("it is lost");
    assert_eq!(again.to_string(), error.to_string());
    bus.way.close();
    drives
}

#[test]
fn drives_are_reached_over_slcan_behind_tcp() {
    drives_are_reached(BusConnection::SlcanTcp);
}

#[test]
fn drives_are_reached_over_slcan_on_a_terminal() {
    drives_are_reached(BusConnection::SlcanPty);
}

#[test]
fn drives_are_reached_by_datagrams() {
    if namespace::is_inside("can_transports::drives_are_reached_by_datagrams", &[setup::can_python]) {
        drives_are_reached(BusConnection::Udp);
    }
}

#[test]
#[ignore = "needs a CAN interface vcan0: tests/socketcan.sh"]
fn drives_are_reached_on_vcan() {
    drives_are_reached(BusConnection::SocketCan("vcan0"));
}

/// It is also absent when it is opened again.
#[test]
fn an_adapter_behind_tcp_is_pulled() {
    let drives = pulled_adapters_are_lost(BusConnection::SlcanTcp);
    let error = open(drives.address(), OPTIONS).err().expect("nobody is there").to_string();
    let refused = "cannot be opened: the adapter cannot be reached: Connection refused (os error 111)";
    assert_eq!(error, format!("{} {refused}", drives.address()));
}

/// Another terminal may get the same name immediately, so this one is not opened again.
#[test]
fn an_adapter_on_a_terminal_is_pulled() {
    pulled_adapters_are_lost(BusConnection::SlcanPty);
}

/// One program uses the adapter; a second one, even as root, gets an error, and can open it after the first has closed
/// it.
#[test]
fn two_programs_do_not_share_an_adapter() {
    let drives = CanDrives::boot_on(BusConnection::SlcanPty, "1");
    let first = Bus::open(&drives, 1);
    let error = open(drives.address(), OPTIONS).err().expect("it is taken").to_string();
    assert!(
        error.ends_with("cannot be opened: another program uses it; end that one first (fuser -v shows it)"),
        "{error}"
    );
    drop(first);
    let mut second = Bus::open(&drives, 1);
    assert_eq!(second.read(NAME, false), Ok(b"cia402-sim".to_vec()));
}

/// The channel of an adapter is open already, on a bus under load: it is closed first, and opened with the bit rate.
#[test]
fn adapter_with_open_channel_is_reused() {
    let drives = CanDrives::boot_on(BusConnection::SlcanPty, "1");
    let mut first = Bus::open(&drives, 1);
    assert_eq!(first.write(Object { index: 0x1017, sub: 0 }, &1_u16.to_le_bytes(), false), Ok(()));
    drop(first);
    let mut second = Bus::open(&drives, 1);
    assert_eq!(second.next_state(), NmtState::PreOperational);
    assert_eq!(second.read(NAME, false), Ok(b"cia402-sim".to_vec()));
    assert_eq!(second.way.faults(), 0);
}
