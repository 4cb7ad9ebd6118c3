//! Transports allocate no memory after their creation: when sending, when receiving, when the queue is full, and when they are lost.

use assert_no_alloc::{AllocDisabler, assert_no_alloc, violation_count};
use lineshaft_can::transport::{Address, Options, Transport, TransportError, open};
use lineshaft_can::{Frame, Id};
use std::io::{Read, Write};
use std::net::{TcpListener, UdpSocket};
use std::process::Command;
use std::thread;
use std::time::{Duration, Instant};

#[global_allocator]
static ALLOCATOR: AllocDisabler = AllocDisabler;

const FRAME: Frame = Frame::of(Id::SYNC, [0xA5; 8]);

fn opened(address: &str) -> Box<dyn Transport> {
    let address: Address = address.parse().expect("it is an address");
    open(&address, Options { bit_rate: 1_000_000, baud: None }).unwrap_or_else(|error| panic!("{error}"))
}

/// Polls until the condition is true, without memory allocation.
fn until(what: &str, mut is_so: impl FnMut() -> bool) {
    let (began, before) = (Instant::now(), violation_count());
    while !assert_no_alloc(&mut is_so) {
        assert!(began.elapsed() < Duration::from_secs(60), "{what}");
        thread::sleep(Duration::from_millis(1));
    }
    assert_eq!(violation_count(), before, "{what}: memory was taken");
}

fn send(way: &mut dyn Transport, count: usize) {
    let mut sent = 0;
    until("frames go", || {
        // Flushing the queue makes room.
        sent += usize::from(way.send(&FRAME).is_ok());
        sent == count && way.flush().is_ok()
    });
}

fn receive(way: &mut dyn Transport, count: usize) {
    let mut heard = 0;
    until("frames come", || {
        while way.receive().is_ok_and(|frame| frame == Some(FRAME)) {
            heard += 1;
        }
        heard == count
    });
}

fn is_lost(result: Result<(), TransportError>) -> bool {
    matches!(result, Err(TransportError::Lost(_)))
}

#[test]
fn an_adapter_takes_no_memory() {
    let listener = TcpListener::bind("127.0.0.1:0").expect("loopback has ports");
    let address = format!("slcan-tcp:{}", listener.local_addr().expect("it is bound"));
    let adapter = thread::spawn(move || {
        let (mut stream, _) = listener.accept()?;
        stream.write_all(b"t0808A5A5A5A5A5A5A5A5\r".repeat(100).as_slice())?;
        let mut byte = [0];
        // Input before the open command is skipped.
        while byte != *b"O" {
            stream.read_exact(&mut byte)?;
        }
        stream.write_all(b"\rt0808A5A5A5A5A5A5A5A5\rz\r\x07".repeat(100).as_slice())?;
        stream.read_exact(&mut [0; 22 * 1000])?;
        Ok::<_, std::io::Error>(stream)
    });
    let mut way = opened(&address);
    receive(&mut *way, 100);
    send(&mut *way, 1000);
    let mut stream = Some(adapter.join().expect("it does not panic").expect("the other end is there"));
    // The remote end does not read: the system buffers a lot, then the queue is full.
    until("there is no room", || (0..1000).any(|_| matches!(way.send(&FRAME), Err(TransportError::Full(256)))));
    drop(stream.take());
    until("the way is lost", || is_lost(way.flush()) || way.receive().is_err());
    until("it stays lost", || is_lost(way.send(&FRAME)) && is_lost(way.flush()) && way.receive().is_err());
}

#[test]
fn datagrams_take_no_memory() {
    let port =
        UdpSocket::bind("127.0.0.1:0").and_then(|socket| socket.local_addr()).expect("loopback has ports").port();
    let address = format!("udp:239.74.163.78:{port}");
    let mut ways = [opened(&address), opened(&address)];
    let [first, second] = &mut ways;
    for _ in 0..20 {
        send(&mut **first, 20);
        receive(&mut **second, 20);
    }
}

#[test]
#[ignore = "needs a kernel with vcan and sch_netem: tests/socketcan.sh"]
fn vcan_interface_takes_no_memory() {
    let run = |program: &str, arguments: &str| {
        let status = Command::new(program).args(arguments.split(' ')).status();
        assert!(status.is_ok_and(|status| status.success()), "{program} {arguments}");
    };
    run("ip", "link add vcan5 type vcan");
    run("ip", "link set vcan5 up");
    let mut ways = [opened("socketcan:vcan5"), opened("socketcan:vcan5")];
    let [first, second] = &mut ways;
    for _ in 0..20 {
        send(&mut **first, 20);
        receive(&mut **second, 20);
    }
    run("tc", "qdisc add dev vcan5 root netem limit 4 delay 60s");
    until("there is no room", || matches!(first.send(&FRAME), Err(TransportError::Full(256))));
    run("ip", "link del vcan5");
    until("the way is lost", || is_lost(first.send(&FRAME)) && is_lost(first.flush()) && first.receive().is_err());
}
