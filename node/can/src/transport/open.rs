//! Opens the transport of an address.
//!
//! Law      may take a few seconds, for the answer of an adapter, or for name resolution and connection of a host
//! Refuses  a device that is missing, is in use, or does not support the bit rate; each with a message that says what to do
//! Source   errno(3), packages of Debian 12

use super::line::{SlcanError, SlcanLine};
use super::slcan;
use super::socket_can::SocketCan;
use super::tty::Tty;
use super::udp::UdpBus;
use super::{Address, Transport};
use socket2::SockRef;
use std::fmt;
use std::io::{self, ErrorKind, Read, Write};
use std::net::{TcpStream, ToSocketAddrs};
use std::time::Duration;

/// Time for a host to answer, and later to confirm sent data.
const TIMEOUT: Duration = Duration::from_secs(3);
/// Size of the send buffer of the system for a host, in bytes: a few hundred frames.
const SEND_BUFFER: usize = 16 * 1024;
/// Default baud rate of a serial line, in bit/s.
const BAUD: u32 = 115_200;
/// Baud rates of a serial line, in bit/s: those of termios from 9600.
pub const BAUD_RATES: [u32; 17] = [
    9_600, 19_200, 38_400, 57_600, 115_200, 230_400, 460_800, 500_000, 576_000, 921_600, 1_000_000, 1_152_000,
    1_500_000, 2_000_000, 2_500_000, 3_000_000, 4_000_000,
];

/// Settings of a transport in addition to its address.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Options {
    /// Bit rate of the bus, in bit/s. It is sent to slcan adapters; a Linux interface has it already, and datagrams have none.
    pub bit_rate: u32,
    /// Baud rate of a serial line, in bit/s, one of [`BAUD_RATES`]; `None`: 115200. USB adapters ignore it.
    pub baud: Option<u32>,
}

/// Error when opening a transport.
#[derive(Debug, thiserror::Error)]
#[error("{address} cannot be opened: {failure}")]
pub struct OpenError {
    /// Address that could not be opened.
    pub address: Address,
    /// Reason.
    pub failure: OpenFailure,
}

/// Reason why a transport could not be opened, with a message that says what to do.
#[derive(Debug, thiserror::Error)]
pub enum OpenFailure {
    /// slcan adapters have no digit, or different ones, for the bit rate (bit/s).
    #[error("adapters do not know the bit rate {0} bit/s; they know {rates} bit/s", rates = BitRates)]
    BitRate(u32),
    /// The path is missing.
    #[error("there is no such device; plug the adapter in, and look for its name in /dev/serial/by-id")]
    NoDevice,
    /// The user has no permission for the line.
    #[error(
        "permission denied; add the user to the group of the device (sudo usermod -aG dialout $USER) and log in anew"
    )]
    Denied,
    /// The line is in use.
    #[error("another program uses it; end that one first (fuser -v shows it)")]
    Busy,
    /// The path is a file.
    #[error("it is no serial line")]
    NoLine,
    /// The line does not support the baud rate (bit/s).
    #[error("the serial line cannot run at {0} bit/s; 115200 suits most adapters")]
    Baud(u32),
    /// The adapter refuses a command, or does not answer.
    #[error(transparent)]
    Adapter(#[from] SlcanError),
    /// The host name cannot be resolved.
    #[error("the host cannot be looked up: {0}")]
    Name(io::Error),
    /// The host refuses the connection, or does not answer.
    #[error("the adapter cannot be reached: {0}")]
    Unreachable(io::Error),
    /// The host does not answer.
    #[error("the adapter has not answered for {} s", TIMEOUT.as_secs())]
    Silent,
    /// The kernel does not support CAN.
    #[error("the kernel has no CAN; load its modules (sudo modprobe can-raw), or use an adapter by slcan")]
    NoCan,
    /// The interface is missing.
    #[error("there is no CAN interface {0}; 'ip -details link show type can' shows those that there are")]
    NoInterface(String),
    /// The interface is down.
    #[error("the interface is down; bring it up (sudo ip link set {0} up type can bitrate 1000000)")]
    InterfaceDown(String),
    /// Another error of the system.
    #[error("{0}")]
    System(io::Error),
}

/// Bit rates that adapters support, as text.
struct BitRates;

impl fmt::Display for BitRates {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (number, kbit_per_s) in slcan::bit_rates().enumerate() {
            write!(f, "{}{}", if number == 0 { "" } else { ", " }, 1000 * kbit_per_s)?;
        }
        Ok(())
    }
}

/// Opens a transport.
///
/// # Errors
/// The transport cannot be opened.
pub fn open(address: &Address, options: Options) -> Result<Box<dyn Transport>, OpenError> {
    let opened: Result<Box<dyn Transport>, OpenFailure> = match address {
        Address::Slcan(path) => {
            adapter(options.bit_rate, || Tty::open(path, options.baud.unwrap_or(BAUD))).map(|line| Box::new(line) as _)
        }
        Address::SlcanTcp(host) => adapter(options.bit_rate, || connect(host)).map(|line| Box::new(line) as _),
        Address::SocketCan(interface) => SocketCan::open(interface).map(|socket| Box::new(socket) as _),
        Address::Udp { group, port } => {
            UdpBus::open(*group, *port).map(|bus| Box::new(bus) as _).map_err(OpenFailure::System)
        }
    };
    opened.map_err(|obstacle| OpenError { address: address.clone(), failure: obstacle })
}

fn adapter<S: Read + Write>(
    bit_rate: u32,
    stream: impl FnOnce() -> Result<S, OpenFailure>,
) -> Result<SlcanLine<S>, OpenFailure> {
    let is_whole = bit_rate.is_multiple_of(1000);
    let command = slcan::bit_rate(bit_rate / 1000).filter(|_| is_whole).ok_or(OpenFailure::BitRate(bit_rate))?;
    let mut line = SlcanLine::new(stream()?);
    line.open(command)?;
    Ok(line)
}

/// Tries all addresses of a host.
fn connect(host: &str) -> Result<TcpStream, OpenFailure> {
    let mut last = OpenFailure::Name(ErrorKind::NotFound.into());
    for address in host.to_socket_addrs().map_err(OpenFailure::Name)? {
        match TcpStream::connect_timeout(&address, TIMEOUT).and_then(prepared) {
            Ok(stream) => return Ok(stream),
            Err(error) if error.kind() == ErrorKind::TimedOut => last = OpenFailure::Silent,
            Err(error) => last = OpenFailure::Unreachable(error),
        }
    }
    Err(last)
}

fn prepared(stream: TcpStream) -> io::Result<TcpStream> {
    stream.set_nodelay(true)?;
    stream.set_nonblocking(true)?;
    let socket = SockRef::from(&stream);
    // If a host disappears silently, sent data is not confirmed, and the transport is lost.
    socket.set_tcp_user_timeout(Some(TIMEOUT))?;
    // By default the system buffers megabytes, and the adapter would send outdated frames.
    socket.set_send_buffer_size(SEND_BUFFER)?;
    Ok(stream)
}

#[cfg(test)]
mod tests {
    use super::*;
    use socket2::{Domain, Socket, Type};
    use std::net::{SocketAddr, TcpListener};
    use std::time::Instant;

    fn refused(address: &str, bit_rate: u32) -> String {
        let opened = open(&address.parse().unwrap(), Options { bit_rate, baud: None });
        opened.err().expect("it cannot be opened").to_string()
    }

    #[test]
    fn open_failure_contains_remedy() {
        assert_eq!(
            refused("slcan:/dev/ttyACM99", 750_000),
            "slcan:/dev/ttyACM99 cannot be opened: adapters do not know the bit rate 750000 bit/s; they know 10000, 20000, 50000, \
             100000, 125000, 250000, 500000, 800000, 1000000 bit/s"
        );
        assert!(refused("slcan:/dev/ttyACM99", 500_001).contains("do not know the bit rate 500001 bit/s"));
        assert_eq!(
            refused("slcan:/dev/ttyACM99", 500_000),
            "slcan:/dev/ttyACM99 cannot be opened: there is no such device; plug the adapter in, and look for its name in \
             /dev/serial/by-id"
        );
        assert_eq!(refused("slcan:/dev/null", 500_000), "slcan:/dev/null cannot be opened: it is no serial line");
        assert_eq!(refused("slcan:/dev", 500_000), "slcan:/dev cannot be opened: it is no serial line");
    }

    #[test]
    fn missing_adapter_is_reported() {
        let port = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
        let sentence = refused(&format!("slcan-tcp:127.0.0.1:{port}"), 500_000);
        assert!(
            sentence.ends_with(" cannot be opened: the adapter cannot be reached: Connection refused (os error 111)")
        );
        let sentence = refused("slcan-tcp:no..name:1", 500_000);
        assert!(sentence.contains("cannot be opened: the host cannot be looked up: "), "{sentence}");
    }

    /// A listener that accepts no connection: its queue is full, and the next connection waits.
    #[test]
    fn silent_host_is_reported_within_timeout() {
        let listener = Socket::new(Domain::IPV4, Type::STREAM, None).unwrap();
        listener.bind(&SocketAddr::from(([127, 0, 0, 1], 0)).into()).unwrap();
        listener.listen(0).unwrap();
        let host = listener.local_addr().unwrap().as_socket().unwrap();
        let _waits = TcpStream::connect(host).unwrap();
        let began = Instant::now();
        let sentence = refused(&format!("slcan-tcp:{host}"), 500_000);
        assert_eq!(sentence, format!("slcan-tcp:{host} cannot be opened: the adapter has not answered for 3 s"));
        assert!(began.elapsed() < Duration::from_secs(10));
    }

    /// The interface is missing, or the kernel has no CAN at all.
    #[test]
    fn missing_interface_is_reported() {
        let sentence = refused("socketcan:no-such-can", 500_000);
        let (no_can, none) = ("the kernel has no CAN; load its modules", "there is no CAN interface no-such-can; ");
        assert!(sentence.contains(no_can) || sentence.contains(none), "{sentence}");
    }
}
