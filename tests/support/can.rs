//! Simulated CANopen drives of another make: a process of their own, behind an adapter that speaks slcan over TCP.

use super::child::Captured;
use super::domain::Domain;
use super::setup;
use serde_json::Value;
use std::io::{BufRead, BufReader, Write};
use std::net::TcpStream;
use std::process::{Command, Stdio};
use std::time::Duration;

/// How long the drives may take to boot.
const BOOT: Duration = Duration::from_secs(30);

/// The drives of one bus.
pub(crate) struct CanDrives {
    _process: Captured,
    bus: String,
    control: BufReader<TcpStream>,
}

impl CanDrives {
    /// Drives with these node ids (`1-2`), booted.
    pub(crate) fn boot(nodes: &str) -> Self {
        let mut command = Command::new(setup::can_python());
        command.arg(setup::sources().join("can/cia402_sim.py"));
        command.args([
            "--bus",
            "slcan-tcp:127.0.0.1:0",
            "--control",
            "127.0.0.1:0",
            "--exit-with-parent",
            "--nodes",
            nodes,
        ]);
        let mut process = Captured::start("can drives", command, &Domain::take(), Stdio::null());
        let line = process.line(BOOT);
        let ready: Value = serde_json::from_str(&line).unwrap_or_else(|error| panic!("{line}: {error}"));
        let at = |key: &str| ready[key].as_str().unwrap_or_else(|| panic!("{line}: no {key}")).to_owned();
        let control = TcpStream::connect(at("control")).expect("the drives listen");
        Self { _process: process, bus: at("bus"), control: BufReader::new(control) }
    }

    /// A connection to the adapter, which waits for nothing.
    pub(crate) fn connect(&self) -> TcpStream {
        let stream = TcpStream::connect(&self.bus).expect("the adapter listens");
        stream.set_nodelay(true).and_then(|()| stream.set_nonblocking(true)).expect("it is a socket");
        stream
    }

    /// Tells the simulation something beside the bus, such as `sdo_mute 1 1`.
    pub(crate) fn tell(&mut self, command: &str) -> Value {
        let mut answer = String::new();
        let asked = writeln!(self.control.get_mut(), "{command}").and_then(|()| self.control.read_line(&mut answer));
        asked.expect("the drives listen");
        let value: Value = serde_json::from_str(&answer).unwrap_or_else(|error| panic!("{command}: {answer}: {error}"));
        assert_eq!(value["ok"], true, "{command}: {answer}");
        value
    }
}
