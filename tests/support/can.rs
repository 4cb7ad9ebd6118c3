//! Simulates CANopen drives with an independent implementation: a process on a bus, and a client that reads their
//! objects.

use super::child::Captured;
use super::domain::Domain;
use super::setup;
use lineshaft_can::sdo::Client;
use lineshaft_can::transport::{Address, Options, Transport, open};
use lineshaft_can::{Frame, NmtState, NodeId, SignOfLife};
use lineshaft_cia402::object::Object;
use lineshaft_cia402::sdo::Transfer;
use serde_json::Value;
use std::io::{BufRead, BufReader, Write};
use std::net::{Ipv4Addr, TcpStream};
use std::process::{Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

/// Timeout of the boot of the drives.
const BOOT: Duration = Duration::from_secs(30);
/// Timeout of an answer of a device (ns).
const TIMEOUT_NS: u64 = 500_000_000;
/// Timeout of everything else.
const PATIENCE: Duration = Duration::from_secs(60);

/// The default multicast group of python-can.
const GROUP: Ipv4Addr = Ipv4Addr::new(239, 74, 163, 2);
const PORT: u16 = 43113;

/// A connection to the bus of simulated drives.
#[derive(Clone, Copy, Debug)]
pub(crate) enum BusConnection {
    /// By an adapter that uses slcan over TCP.
    SlcanTcp,
    /// By an adapter that uses slcan on a pseudo terminal.
    SlcanPty,
    /// Datagrams; only in a network namespace of the test.
    Udp,
    /// A network interface, if the kernel supports CAN.
    SocketCan(&'static str),
}

/// Returns the behaviour (tests/peers/can/habits.py) that all drives have, if the tests are run with one (.ci/nightly).
pub(crate) fn behaviour() -> Option<String> {
    std::env::var("LINESHAFT_HABIT").ok()
}

/// The drives of one bus.
pub(crate) struct CanDrives {
    process: Captured,
    address: Address,
    /// Control connection beside the bus; a device of another implementation has none.
    control: Option<BufReader<TcpStream>>,
}

impl CanDrives {
    /// Starts and boots drives with these node ids (`1-2`) on an adapter over TCP.
    pub(crate) fn boot(nodes: &str) -> Self {
        Self::boot_on(BusConnection::SlcanTcp, nodes)
    }

    /// Starts and boots drives with these node ids.
    pub(crate) fn boot_on(way: BusConnection, nodes: &str) -> Self {
        Self::boot_with(way, nodes, &[])
    }

    /// Starts and boots drives with these node ids, and other devices (`["--modules", "10"]`).
    pub(crate) fn boot_with(way: BusConnection, nodes: &str, others: &[&str]) -> Self {
        Self::start("cia402_sim.py", way, nodes, &[&["--control", "127.0.0.1:0"], others].concat())
    }

    /// Starts and boots an independent device that is no drive, on an adapter over TCP.
    pub(crate) fn boot_device(node: u8) -> Self {
        Self::start("durand_node.py", BusConnection::SlcanTcp, &node.to_string(), &[])
    }

    fn start(script: &str, way: BusConnection, nodes: &str, others: &[&str]) -> Self {
        let bus = match way {
            BusConnection::SlcanTcp => "slcan-tcp:127.0.0.1:0".to_owned(),
            BusConnection::SlcanPty => "slcan-pty".to_owned(),
            BusConnection::Udp => format!("udp:{GROUP}:{PORT}"),
            BusConnection::SocketCan(interface) => format!("socketcan:{interface}"),
        };
        let mut command = Command::new(setup::can_python());
        command.arg(setup::sources().join("can").join(script));
        command.args(["--bus", &bus, "--exit-with-parent", "--nodes", nodes]);
        command.args(others);
        if let (Some(habit), "cia402_sim.py") = (behaviour(), script) {
            command.args(["--habit", &habit]);
        }
        let mut process = Captured::start("can drives", command, &Domain::take(), Stdio::null());
        process.prefer();
        let line = process.line(BOOT);
        let ready: Value = serde_json::from_str(&line).unwrap_or_else(|error| panic!("{line}: {error}"));
        let at = |key: &str| ready[key].as_str().unwrap_or_else(|| panic!("{line}: no {key}")).to_owned();
        let address = match way {
            BusConnection::SlcanTcp => Address::SlcanTcp(at("bus")),
            BusConnection::SlcanPty => Address::Slcan(at("bus").into()),
            BusConnection::Udp => Address::Udp { group: GROUP, port: PORT },
            BusConnection::SocketCan(interface) => Address::SocketCan(interface.to_owned()),
        };
        let control = ready["control"].as_str().map(|at| TcpStream::connect(at).expect("the drives listen"));
        Self { process, address, control: control.map(BufReader::new) }
    }

    /// Returns the address of their bus.
    pub(crate) fn address(&self) -> &Address {
        &self.address
    }

    /// Sends the simulation a command over the control connection, such as `sdo_mute 1 1`.
    pub(crate) fn tell(&mut self, command: &str) -> Value {
        let mut answer = String::new();
        let control = self.control.as_mut().expect("they take commands");
        let asked = writeln!(control.get_mut(), "{command}").and_then(|()| control.read_line(&mut answer));
        asked.expect("the drives listen");
        let value: Value = serde_json::from_str(&answer).unwrap_or_else(|error| panic!("{command}: {answer}: {error}"));
        assert_eq!(value["ok"], true, "{command}: {answer}");
        value
    }

    /// Kills the process: the drives and their adapter are gone.
    pub(crate) fn kill(&mut self) {
        self.process.signal(rustix::process::Signal::KILL);
        self.process.wait(PATIENCE);
    }
}

/// A bus with one drive whose objects are read and written.
pub(crate) struct Bus {
    pub(crate) way: Box<dyn Transport>,
    node: NodeId,
    client: Client,
    began: Instant,
}

impl Bus {
    /// Opens the bus of these drives.
    pub(crate) fn open(drives: &CanDrives, node: u8) -> Self {
        let way = open(drives.address(), Options { bit_rate: 1_000_000, baud: None });
        let node = NodeId::new(node).expect("1 to 127");
        let client = Client::new(node.sdo_request(), node.sdo_response(), TIMEOUT_NS);
        Self { way: way.unwrap_or_else(|error| panic!("{error}")), node, client, began: Instant::now() }
    }

    fn now_ns(&self) -> u64 {
        self.began.elapsed().as_nanos() as u64
    }

    /// Runs the transfer that has begun to its end.
    fn finish(&mut self) -> Transfer {
        loop {
            self.send_all();
            let heard = self.receive();
            let now_ns = self.now_ns();
            let done = heard.and_then(|frame| self.client.receive(&frame, now_ns));
            if let Some(done) = done.or_else(|| self.client.tick(now_ns)) {
                // Includes the frame that ends the transfer on the bus.
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
            self.send(&frame);
        }
        self.way.flush().expect("the bus is there");
    }

    pub(crate) fn send(&mut self, frame: &Frame) {
        self.way.send(frame).expect("the bus is there");
    }

    fn receive(&mut self) -> Option<Frame> {
        self.way.receive().expect("the bus is there")
    }

    pub(crate) fn read(&mut self, object: Object, in_blocks: bool) -> Result<Vec<u8>, String> {
        self.client.upload(object, Vec::with_capacity(4096), in_blocks, self.now_ns()).expect("one at a time");
        let done = self.finish();
        done.result.map(|()| done.data).map_err(|error| error.to_string())
    }

    pub(crate) fn write(&mut self, object: Object, data: &[u8], in_blocks: bool) -> Result<(), String> {
        self.client.download(object, data.to_vec(), in_blocks, self.now_ns()).expect("one at a time");
        self.finish().result.map_err(|error| error.to_string())
    }

    /// Returns the next state that the drive reports.
    pub(crate) fn next_state(&mut self) -> NmtState {
        let began = Instant::now();
        loop {
            match self.receive() {
                Some(frame) if frame.id() == self.node.heartbeat() => {
                    return SignOfLife::of(&frame).expect("a sign of life").state;
                }
                Some(_) => {}
                None => thread::sleep(Duration::from_micros(200)),
            }
            assert!(began.elapsed() < PATIENCE, "no sign of life");
        }
    }
}
