//! `lineshaft can simulate`.

use super::Failure;
use super::open::{BIT_RATE, chosen};
use crate::cell::Cell;
use crate::cli::{say, warn};
use crate::interrupt::Interrupt;
use clap::Args;
use lineshaft_can::config::BusConfig;
use lineshaft_can::simulate::{SimulatedBus, occupied_node, unsupported};
use lineshaft_can::transport::{Address, OpenFailure, Options, Transport, TransportError, open, slcan_pty};
use lineshaft_core::machine::Machine;
use std::path::{Path, PathBuf};

pub(super) const HELP: &str = "\
The drives have the nodes, identities, modes and mechanics (key sim of an axis) of the cell. Nodes that answer on the bus already are refused.

A bus of datagrams (udp:GROUP:PORT) or an interface vcanN is used as the cell names it. Any other way to a bus may lead to real drives, so \
--transport must name it.

--pty PATH serves an adapter that speaks slcan on a pseudo terminal; a master opens slcan:PATH.

Examples:
  lineshaft can simulate cell.yaml --transport socketcan:vcan0
  lineshaft can simulate cell.yaml --pty /tmp/bus0

Exit codes: 0 ended by Ctrl-C, 1 the bus is lost or not there, or a node is there already, 2 bad usage or file.";

/// Drives of a cell on a bus.
#[derive(Debug, Args)]
pub(in crate::cli) struct SimulateArgs {
    /// The cell
    cell: PathBuf,
    /// Which of several backends on CAN of the cell
    #[arg(long, value_name = "NAME")]
    backend: Option<String>,
    /// The bus, as udp:GROUP:PORT, socketcan:vcan0, slcan:PATH or slcan-tcp:HOST:PORT; left out: that of the cell
    #[arg(long, value_name = "ADDRESS")]
    transport: Option<Address>,
    /// Serve a pseudo terminal as an slcan adapter; PATH becomes a link to it
    #[arg(long, value_name = "PATH", conflicts_with = "transport")]
    pty: Option<PathBuf>,
}

pub(super) fn simulate(args: &SimulateArgs) -> Result<(), Failure> {
    let problems = |problems: crate::document::Problems| Failure::Usage(problems.to_string().trim_end().to_owned());
    let cell = Cell::load(&args.cell).map_err(problems)?;
    let (buses, warnings) = cell.on_can().buses_and_warnings(Some(&args.cell)).map_err(problems)?;
    warn(warnings);
    let config = chosen(buses, args.backend.as_deref(), &args.cell)?;
    if let Some(sentence) = unsupported(&config) {
        return Err(Failure::Usage(sentence));
    }
    let interrupt = Interrupt::listen().map_err(|error| Failure::Bus(format!("Ctrl-C cannot be heard: {error}")))?;
    let (address, transport) = match &args.pty {
        Some(path) => {
            let transport = slcan_pty(path).map_err(|error| Failure::Bus(error.to_string()))?;
            (Address::Slcan(path.clone()), Box::new(transport) as Box<dyn Transport>)
        }
        None => shared(&config, address(&config, args.transport.as_ref())?)?,
    };
    let nodes: Vec<_> = config.devices.iter().map(ToString::to_string).collect();
    let mut bus = bus(&cell, &config, transport)?;
    say(&format!("{}: {address}: {} simulated; Ctrl-C ends", config.name, nodes.join(", ")));
    bus.run(|| interrupt.requested().is_some()).map_err(lost)
}

fn lost(error: TransportError) -> Failure {
    Failure::Bus(error.to_string())
}

/// Opens a bus that other nodes may use; refuses it if one of them has the node ID of a drive.
fn shared(config: &BusConfig, address: Address) -> Result<(Address, Box<dyn Transport>), Failure> {
    let mut transport = opened(config, &address)?;
    if let Some(node) = occupied_node(&mut *transport, config).map_err(lost)? {
        let sentence = format!("{address}: {node} is on the bus already; simulated drives need nodes of their own");
        return Err(Failure::Bus(sentence));
    }
    Ok((address, transport))
}

/// Creates the simulated drives of a bus of a cell, with their mechanics.
fn bus(cell: &Cell, config: &BusConfig, transport: Box<dyn Transport>) -> Result<SimulatedBus, Failure> {
    let machine = Machine::new(cell.machine.clone()).map_err(|error| Failure::Usage(error.to_string()))?;
    let plant = cell.plant_of(|backend| backend.name == config.name);
    Ok(SimulatedBus::new(transport, config, plant, machine.inputs(), machine.outputs()))
}

/// Returns the bus to use. A bus that may have real drives must be named explicitly.
fn address(config: &BusConfig, given: Option<&Address>) -> Result<Address, Failure> {
    if let Some(address) = given {
        return Ok(address.clone());
    }
    let is_virtual = match &config.transport {
        Address::Udp { .. } => true,
        // A physical interface has a device, whatever its name.
        Address::SocketCan(interface) => {
            interface.starts_with("vcan") && !Path::new("/sys/class/net").join(interface).join("device").exists()
        }
        Address::Slcan(_) | Address::SlcanTcp(_) => false,
    };
    if is_virtual {
        return Ok(config.transport.clone());
    }
    let (name, transport) = (&config.name, &config.transport);
    Err(Failure::Usage(format!(
        "backend {name}: {transport} may have real drives; name the bus of the simulated ones by --transport or --pty"
    )))
}

fn opened(config: &BusConfig, address: &Address) -> Result<Box<dyn Transport>, Failure> {
    let options = Options { bit_rate: config.bit_rate.unwrap_or(BIT_RATE), baud: config.serial_baudrate };
    open(address, options).map_err(|error| match error.failure {
        OpenFailure::BitRate(_) => Failure::Usage(error.to_string()),
        _ => Failure::Bus(error.to_string()),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use lineshaft_can::{Frame, Id, NmtCommand, NodeId};
    use std::collections::VecDeque;
    use std::sync::{Arc, Mutex};
    use std::time::Duration;

    const CELL: &str = "lineshaft: 1\ncycle: 2 ms\nbackends:\n  bus0: {type: can, transport: 'udp:239.74.163.45:43145'}\naxes:\n  \
                        x: {type: linear, unit: mm, scale: {increments: 1000, per: 1 mm}, drive: {backend: bus0, node: 3}, \
                        max_velocity: 1 m/s, max_acceleration: 10 m/s^2}\n";

    /// Frames that were sent, and frames that are still to be received.
    #[derive(Clone, Default)]
    struct Wire(Arc<Mutex<(Vec<Frame>, VecDeque<Frame>)>>);

    impl Transport for Wire {
        fn send(&mut self, frame: &Frame) -> Result<(), TransportError> {
            self.0.lock().unwrap().0.push(*frame);
            Ok(())
        }

        fn flush(&mut self) -> Result<(), TransportError> {
            Ok(())
        }

        fn receive(&mut self) -> Result<Option<Frame>, TransportError> {
            Ok(self.0.lock().unwrap().1.pop_front())
        }
    }

    /// A bus with one drive, and the current time.
    struct Rig {
        wire: Wire,
        bus: SimulatedBus,
        now: Duration,
    }

    fn node() -> NodeId {
        NodeId::new(3).unwrap()
    }

    impl Rig {
        fn new() -> Self {
            let cell = Cell::parse("cell.yaml", CELL).unwrap_or_else(|problems| panic!("{problems}"));
            let config = cell.on_can().buses(None).unwrap_or_else(|problems| panic!("{problems}")).remove(0);
            assert_eq!(unsupported(&config), None);
            let wire = Wire::default();
            let Ok(mut bus) = bus(&cell, &config, Box::new(wire.clone())) else { panic!("no machine") };
            bus.boot().unwrap();
            let mut rig = Self { wire, bus, now: Duration::ZERO };
            assert_eq!(rig.sent(), [Frame::data(node().heartbeat(), &[0]).unwrap()]);
            rig
        }

        /// Returns the frames sent since the last call.
        fn sent(&mut self) -> Vec<Frame> {
            std::mem::take(&mut self.wire.0.lock().unwrap().0)
        }

        /// Sends a frame to the drive; returns its responses.
        fn tell(&mut self, frame: Frame) -> Vec<Frame> {
            self.wire.0.lock().unwrap().1.push_back(frame);
            self.bus.serve(self.now).unwrap();
            self.sent()
        }

        /// Writes an object of 1, 2 or 4 bytes.
        fn write(&mut self, index: u16, sub: u8, data: &[u8]) {
            let [low, high] = index.to_le_bytes();
            let mut request = [0x23 | (4 - data.len() as u8) << 2, low, high, sub, 0, 0, 0, 0];
            request[4..4 + data.len()].copy_from_slice(data);
            let answer = self.tell(Frame::of(node().sdo_request(), request));
            assert_eq!(answer, [Frame::of(node().sdo_response(), [0x60, low, high, sub, 0, 0, 0, 0])]);
        }

        /// Sends control word and target, then SYNC; returns status word and position of the response.
        fn cycle(&mut self, control: u16, target: i32) -> (u16, i32) {
            let [a, b] = control.to_le_bytes();
            let [c, d, e, f] = target.to_le_bytes();
            assert!(self.tell(Frame::data(node().rpdo(1).unwrap(), &[a, b, c, d, e, f]).unwrap()).is_empty());
            self.now += Duration::from_millis(2);
            let sent = self.tell(Frame::data(Id::SYNC, &[]).unwrap());
            let [frame] = sent.as_slice() else { panic!("{sent:?}") };
            let &[a, b, c, d, e, f] = frame.bytes() else { panic!("{frame:?}") };
            (u16::from_le_bytes([a, b]), i32::from_le_bytes([c, d, e, f]))
        }

        /// Maps 6040h and 607Ah, 6041h and 6064h, selects csp, and starts the drive.
        fn start(&mut self) {
            let pdos =
                [(0x1400, 0x203_u32, [0x6040_0010_u32, 0x607A_0020]), (0x1800, 0x183, [0x6041_0010, 0x6064_0020])];
            for (communication, id, entries) in pdos {
                for (sub, entry) in (1..).zip(entries) {
                    self.write(communication + 0x200, sub, &entry.to_le_bytes());
                }
                self.write(communication + 0x200, 0, &[2]);
                self.write(communication, 2, &[1]);
                self.write(communication, 1, &id.to_le_bytes());
            }
            self.write(0x6060, 0, &[8]);
            assert!(self.tell(NmtCommand::Start.frame(Some(node()))).is_empty());
        }
    }

    /// Switched on by 06h, 07h, 0Fh (CiA 402-2). A setpoint that is sent before SYNC n is applied at SYNC n and reached
    /// at SYNC n + 1, because the model is ideal.
    #[test]
    fn a_drive_is_enabled_and_reaches_each_setpoint_one_sync_later() {
        let mut rig = Rig::new();
        rig.start();
        let mask = |(status, position): (u16, i32)| (status & 0x6F, position);
        assert_eq!(mask(rig.cycle(0x06, 0)), (0x40, 0), "switch on disabled");
        assert_eq!(mask(rig.cycle(0x07, 0)), (0x21, 0), "ready to switch on");
        assert_eq!(mask(rig.cycle(0x0F, 0)), (0x23, 0), "switched on");
        assert_eq!(mask(rig.cycle(0x0F, 150)), (0x27, 0), "operation enabled");
        assert_eq!(mask(rig.cycle(0x0F, -50)), (0x27, 150));
        assert_eq!(mask(rig.cycle(0x0F, -50)), (0x27, -50));
        // Bits 9 and 12: remote, drive follows the command value.
        assert_eq!(rig.cycle(0x0F, -50).0 & 0x1200, 0x1200);
        assert_eq!(mask(rig.cycle(0x00, -50)), (0x27, -50));
        assert_eq!(mask(rig.cycle(0x00, 500)), (0x40, -50), "off, and where it was");
    }

    /// CiA 402-2: 8130h after a missing heartbeat of the master; the drive is then in state fault.
    #[test]
    fn an_enabled_drive_has_a_fault_when_its_master_is_silent() {
        let mut rig = Rig::new();
        rig.start();
        // Node 127, 100 ms.
        rig.write(0x1016, 1, &0x007F_0064_u32.to_le_bytes());
        let master = Frame::data(NodeId::new(127).unwrap().heartbeat(), &[5]).unwrap();
        for control in [0x06, 0x07, 0x0F, 0x0F, 0x0F] {
            rig.tell(master);
            rig.cycle(control, 0);
        }
        rig.now += Duration::from_millis(97);
        rig.bus.serve(rig.now).unwrap();
        assert!(rig.sent().is_empty());
        // Without SYNC the drive is simulated in real time.
        for _ in 0..20 {
            rig.now += Duration::from_millis(20);
            rig.bus.serve(rig.now).unwrap();
        }
        assert_eq!(rig.sent(), [Frame::of(node().emergency(), [0x30, 0x81, 0x11, 0, 0, 0, 0, 0])]);
        let status = rig.tell(Frame::of(node().sdo_request(), [0x40, 0x41, 0x60, 0, 0, 0, 0, 0]));
        let status: Vec<_> = status.iter().map(|frame| frame.bytes()[4] & 0x4F).collect();
        assert_eq!(status, [0x08], "fault");
    }

    /// SYNC every 8 ms, the mechanics every 2 ms: four steps of 100 counts, 50,000 counts/s. With an interpolation time
    /// of 16 ms the setpoint is reached after two SYNC.
    #[test]
    fn setpoints_are_interpolated_over_the_times_of_1006h_and_60c2h() {
        for (time, positions, velocity) in [(8, [400, 400], 50_000_i32), (16, [200, 400], 25_000)] {
            let mut rig = Rig::new();
            rig.start();
            rig.write(0x1006, 0, &8_000_u32.to_le_bytes());
            rig.write(0x60C2, 1, &[time]);
            for control in [0x06, 0x07, 0x0F, 0x0F] {
                rig.cycle(control, 0);
            }
            rig.cycle(0x0F, 400);
            assert_eq!(rig.cycle(0x0F, 400).1, positions[0], "{time} ms");
            let answer = rig.tell(Frame::of(node().sdo_request(), [0x40, 0x6C, 0x60, 0, 0, 0, 0, 0]));
            let shown: Vec<_> = answer.iter().map(|frame| frame.bytes()[4..].to_vec()).collect();
            assert_eq!(shown, [velocity.to_le_bytes()], "{time} ms");
            assert_eq!(rig.cycle(0x0F, 400).1, positions[1], "{time} ms");
        }
    }

    #[test]
    fn a_bus_that_may_have_real_drives_must_be_named() {
        let text = CELL.replace("udp:239.74.163.45:43145", "socketcan:can0");
        let cell = Cell::parse("cell.yaml", &text).unwrap_or_else(|problems| panic!("{problems}"));
        let mut config = cell.on_can().buses(None).unwrap_or_else(|problems| panic!("{problems}")).remove(0);
        let Err(Failure::Usage(sentence)) = address(&config, None) else { panic!("it is used unnamed") };
        assert!(
            sentence.contains("socketcan:can0 may have real drives") && sentence.contains("--transport"),
            "{sentence}"
        );
        let can0: Address = "socketcan:can0".parse().unwrap();
        assert!(matches!(address(&config, Some(&can0)), Ok(named) if named == can0));
        config.transport = "socketcan:vcan0".parse().unwrap();
        assert!(matches!(address(&config, None), Ok(named) if named == config.transport));
    }

    #[test]
    fn profile_modes_are_simulated() {
        for mode in ["pp", "ip", "csp"] {
            let text = CELL.replace("node: 3}", &format!("node: 3, mode: {mode}}}"));
            let cell = Cell::parse("cell.yaml", &text).unwrap_or_else(|problems| panic!("{problems}"));
            let config = cell.on_can().buses(None).unwrap_or_else(|problems| panic!("{problems}")).remove(0);
            assert_eq!(unsupported(&config), None, "{mode}");
        }
    }
}
