//! Arguments of `lineshaft can`, with their permitted values and help texts.

use crate::cli::times::within;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Args, Subcommand, ValueEnum};
use lineshaft_can::transport::{Address, BAUD_RATES};
use lineshaft_can::{NmtCommand, NodeId, lss};
use lineshaft_cia402::dictionary::{DataType, type_name};
use std::path::PathBuf;
use std::time::Duration;

/// Permitted bit rates of CAN, in bit/s.
const BIT_RATES: (u32, u32) = (10_000, 1_000_000);

/// Commissioning of a CAN bus, command by command.
#[derive(Debug, Subcommand)]
pub(in crate::cli) enum CanCommand {
    /// Look who is on the bus: asks every node for 1000h and 1018h, and listens for heartbeats for a second
    #[command(after_help = "Example:\n  lineshaft can scan --bus slcan:/dev/ttyACM0 --bitrate 500000\n\n\
                            Exit codes: 0 at least one node is there, 1 none is, or the bus is not there, 2 bad usage or file.")]
    Scan(ScanArgs),
    /// Tell what a device is: identity, errors, state of the drive, factors, PDOs
    #[command(after_help = "Example:\n  lineshaft can info 3 --bus socketcan:can0 --eds drive.eds\n\n\
                            Exit codes: 0 good, 1 the device does not answer, or the bus is not there, 2 bad usage or file.")]
    Info(InfoArgs),
    /// List the PDOs of a device as it has them now
    #[command(after_help = "Example:\n  lineshaft can pdo 3 --cell cell.yaml\n\n\
                            Exit codes: 0 good, 1 the device does not answer, or the bus is not there, 2 bad usage or file.")]
    Pdo(NodeArgs),
    /// Read or write one object of a device
    #[command(subcommand)]
    Sdo(SdoCommand),
    /// Bring a device, or all of them, into another state; after a reset of one, wait up to 1 s for its boot-up
    #[command(
        after_help = "Drives that are started may exchange process data; `all` reaches every device on the bus.\n\n\
                            Example:\n  lineshaft can nmt 3 reset-node --bus slcan:/dev/ttyACM0\n\n\
                            Exit codes: 0 it was sent, and one that was reset has booted; 1 it has not, or the bus is not there; \
                            2 bad usage or file."
    )]
    Nmt(NmtArgs),
    /// Print the frames of the bus and what they say, until Ctrl-C; sends nothing
    #[command(
        after_help = "Columns: time since the begin (s), identifier (hexadecimal), bytes, what it is. Values of PDOs have names \
                            where --cell or --eds with --node say what is mapped.\n\n\
                            Example:\n  lineshaft can monitor --cell cell.yaml --node 3 --for '10 s'\n\n\
                            Exit codes: 0 ended by Ctrl-C, --for or a closed pipe, 1 the bus is lost or not there, 2 bad usage or file."
    )]
    Monitor(MonitorArgs),
    /// Print the frames that a bag holds, as `monitor` prints those of a bus
    #[command(
        after_help = "Bags of the flight recorder hold the frames of all buses on CAN, others where `lineshaft run --record-frames` has made \
                            them. Columns: time since the first cycle of the bag (s), bus, which way, identifier (hexadecimal), bytes, what it \
                            is. What PDOs carry is told by the cell that is attached to the bag, or by --cell where its EDS files stand \
                            beside that one.\n\n\
                            Example:\n  lineshaft can dump ~/.ros/lineshaft/lineshaft/flight_20261121_152804_000000048211 --cell cell.yaml\n\n\
                            Exit codes: 0 good, or a closed pipe; 2 bad usage or file, a bag without frames."
    )]
    Dump(DumpArgs),
    /// Give devices node ids and bit rates by their identity (CiA 305)
    #[command(subcommand)]
    Lss(LssWords),
    /// Bring the configuration of a DCF file into a device: writes what differs, a PDO only while it is off
    #[command(
        after_help = "A drive that is enabled is refused. Left out are objects that do something: 1010h, 1011h, 6040h.\n\n\
                            Example:\n  lineshaft can configure 3 --dcf drive.dcf --store --bus slcan:/dev/ttyACM0\n\n\
                            Exit codes: 0 the device has it all, 1 it refuses or does not answer, or the bus is not there, \
                            2 bad usage or file."
    )]
    Configure(ConfigureArgs),
    /// Simulate the drives of a cell as devices on a bus, until Ctrl-C
    #[command(after_help = super::simulate::HELP)]
    Simulate(super::simulate::SimulateArgs),
}

/// Devices by their identity.
#[derive(Debug, Subcommand)]
pub(in crate::cli) enum LssWords {
    /// Look for one device that has no node id yet, by fastscan (0.1 s for each bit that is 1: up to 13 s)
    #[command(
        after_help = "Of several devices the one with the lowest numbers is found; give it a node id, and search again.\n\n\
                            Example:\n  lineshaft can lss scan --bus slcan:/dev/ttyACM0 --bitrate 500000\n\n\
                            Exit codes: 0 one is found, 1 none is, or the bus is not there, 2 bad usage or file."
    )]
    Scan {
        #[command(flatten)]
        bus: BusArgs,
    },
    /// Give a device a node id
    #[command(after_help = "The id is lost when the device starts anew, unless `lss store` keeps it.\n\n\
                            Example:\n  lineshaft can lss set-id 5 --vendor 0xFB --product 0x60500000 --revision 0x1690000 --serial 4711 \
                            --bus socketcan:can0\n\n\
                            Exit codes: 0 the device has taken it, 1 it refuses or does not answer, or the bus is not there, 2 bad \
                            usage or file.")]
    SetId {
        /// The node id (1 to 127)
        #[arg(value_parser = node)]
        node: NodeId,
        #[command(flatten)]
        device: IdentityArgs,
        #[command(flatten)]
        bus: BusArgs,
    },
    /// Give a device a bit rate, which holds from its next start on, once `lss store` has kept it
    #[command(
        after_help = "Example:\n  lineshaft can lss bit-rate 500000 --vendor 0xFB --product 0x60500000 --revision 0x1690000 --serial \
                            4711 --bus socketcan:can0\n\n\
                            Exit codes: 0 the device has taken it, 1 it refuses or does not answer, or the bus is not there, 2 bad \
                            usage or file."
    )]
    BitRate {
        /// The bit rate (bit/s): 1000000, 800000, 500000, 250000, 125000, 50000, 20000 or 10000
        #[arg(value_name = "BIT/S", value_parser = lss_bit_rate)]
        rate: u8,
        #[command(flatten)]
        device: IdentityArgs,
        #[command(flatten)]
        bus: BusArgs,
    },
    /// Tell a device to keep its node id and bit rate
    #[command(
        after_help = "Example:\n  lineshaft can lss store --vendor 0xFB --product 0x60500000 --revision 0x1690000 --serial 4711 \
                            --bus socketcan:can0\n\n\
                            Exit codes: 0 the device has stored them, 1 it refuses or does not answer, or the bus is not there, 2 bad \
                            usage or file."
    )]
    Store {
        #[command(flatten)]
        device: IdentityArgs,
        #[command(flatten)]
        bus: BusArgs,
    },
}

/// Which device; all four numbers, as `can scan` shows them (1018h).
#[derive(Clone, Copy, Debug, Args)]
pub(in crate::cli) struct IdentityArgs {
    /// Vendor: decimal, 0xFB or FBh
    #[arg(long, value_name = "NUMBER", value_parser = number)]
    pub(super) vendor: u32,
    /// Product code
    #[arg(long, value_name = "NUMBER", value_parser = number)]
    pub(super) product: u32,
    /// Revision number
    #[arg(long, value_name = "NUMBER", value_parser = number)]
    pub(super) revision: u32,
    /// Serial number
    #[arg(long, value_name = "NUMBER", value_parser = number)]
    pub(super) serial: u32,
}

/// Objects one by one.
#[derive(Debug, Subcommand)]
pub(in crate::cli) enum SdoCommand {
    /// Read an object and print it, or write its bytes to a file
    #[command(
        after_help = "OBJECT is an index like 6064 or 0x6064, index and subindex like 6099:01 (both hexadecimal), or a name of the \
                            EDS, such as \"Position actual value\" or \"Homing speeds.Speed during search for switch\". Without a type the \
                            bytes are printed, and the number that 1, 2, 4 or 8 of them are.\n\n\
                            Example:\n  lineshaft can sdo read 3 6064 --type i32 --bus slcan:/dev/ttyACM0\n\n\
                            Exit codes: 0 good, 1 the device refuses or does not answer, or the bus is not there, 2 bad usage or file."
    )]
    Read(ReadArgs),
    /// Write an object
    #[command(
        after_help = "OBJECT as for `sdo read`. VALUE is decimal (-5, 1.5) or hexadecimal (0x1F); pairs of hexadecimal digits for \
                            bytes and domain. What the type, the access or the limits of the EDS do not allow is not sent.\n\n\
                            Example:\n  lineshaft can sdo write 3 \"Profile velocity\" 20000 --eds drive.eds --bus socketcan:can0\n\n\
                            Exit codes: 0 good, 1 the device refuses or does not answer, or the bus is not there, 2 bad usage or file, \
                            or a value that is not allowed."
    )]
    Write(WriteArgs),
}

/// Which bus, and how it is reached.
#[derive(Debug, Args)]
pub(in crate::cli) struct BusArgs {
    /// The way to the bus: slcan:/dev/ttyACM0, slcan-tcp:HOST:PORT, socketcan:can0 or udp:GROUP:PORT
    #[arg(long, value_name = "ADDRESS", required_unless_present = "cell", conflicts_with = "cell")]
    pub(super) bus: Option<Address>,
    /// Bit rate of the bus (bit/s, 10000 to 1000000; left out: 1000000); an interface of Linux has its own
    #[arg(long, value_name = "BIT/S", value_parser = bit_rate, conflicts_with = "cell")]
    pub(super) bitrate: Option<u32>,
    /// Baud rate of the serial line of an slcan adapter (bit/s; left out: 115200); adapters on USB ignore it
    #[arg(long, value_name = "BIT/S", value_parser = baudrate, conflicts_with = "cell")]
    pub(super) serial_baudrate: Option<u32>,
    /// Take the way, the bit rate, the nodes and their EDS files from this cell
    #[arg(long, value_name = "CELL")]
    pub(super) cell: Option<PathBuf>,
    /// Which of several backends on CAN of the cell
    #[arg(long, value_name = "NAME", conflicts_with = "bus")]
    pub(super) backend: Option<String>,
    /// How long a device may take for an answer, as '500 ms' (10 ms to 60 s; left out: 500 ms, or what the cell says)
    #[arg(long, value_name = "TIME", value_parser = timeout)]
    pub(super) timeout: Option<Duration>,
}

#[derive(Debug, Args)]
pub(in crate::cli) struct ScanArgs {
    /// First node that is asked (1 to 127)
    #[arg(long, value_name = "NODE", default_value = "1", value_parser = node)]
    pub(super) from: NodeId,
    /// Last node that is asked (1 to 127)
    #[arg(long, value_name = "NODE", default_value = "127", value_parser = node)]
    pub(super) to: NodeId,
    /// Print one JSON object (docs/json.md) instead of the table
    #[arg(long)]
    pub(super) json: bool,
    #[command(flatten)]
    pub(super) bus: BusArgs,
}

#[derive(Debug, Args)]
pub(in crate::cli) struct InfoArgs {
    #[command(flatten)]
    pub(super) node: NodeArgs,
    /// Print one JSON object (docs/json.md) instead of the table
    #[arg(long)]
    pub(super) json: bool,
}

#[derive(Debug, Args)]
pub(in crate::cli) struct NodeArgs {
    /// The node (1 to 127)
    #[arg(value_parser = node)]
    pub(super) node: NodeId,
    /// Names and types of its objects; goes before the one of the cell
    #[arg(long, value_name = "FILE")]
    pub(super) eds: Option<PathBuf>,
    #[command(flatten)]
    pub(super) bus: BusArgs,
}

#[derive(Debug, Args)]
pub(in crate::cli) struct ReadArgs {
    #[command(flatten)]
    pub(super) node: NodeArgs,
    /// The object: 6064, 0x6064, 6099:01, or a name of the EDS
    pub(super) object: String,
    /// What its bytes are, where no EDS says it
    #[arg(long = "type", value_name = "TYPE", value_parser = data_type())]
    pub(super) kind: Option<DataType>,
    /// Write the bytes to this file; one that exists is replaced
    #[arg(long, value_name = "PATH", value_parser = crate::cli::outputs::bytes())]
    pub(super) file: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(in crate::cli) struct WriteArgs {
    #[command(flatten)]
    pub(super) node: NodeArgs,
    /// The object: 6064, 0x6064, 6099:01, or a name of the EDS
    pub(super) object: String,
    /// The value
    #[arg(allow_hyphen_values = true, required_unless_present = "file", conflicts_with = "file")]
    pub(super) value: Option<String>,
    /// What its bytes are, where no EDS says it
    #[arg(long = "type", value_name = "TYPE", value_parser = data_type())]
    pub(super) kind: Option<DataType>,
    /// Take the bytes from this file
    #[arg(long, value_name = "PATH")]
    pub(super) file: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(in crate::cli) struct NmtArgs {
    /// The node (1 to 127), or `all`
    #[arg(value_name = "NODE|all", value_parser = target)]
    pub(super) target: Target,
    /// What it is told
    #[arg(value_enum)]
    pub(super) command: NmtArg,
    #[command(flatten)]
    pub(super) bus: BusArgs,
}

#[derive(Debug, Args)]
pub(in crate::cli) struct MonitorArgs {
    /// Only frames of this node, and to it (1 to 127)
    #[arg(long, value_parser = node)]
    pub(super) node: Option<NodeId>,
    /// Names and types of the objects of --node; goes before the one of the cell
    #[arg(long, value_name = "FILE", requires = "node")]
    pub(super) eds: Option<PathBuf>,
    /// End after this time, as '10 s' (1 ms to 86400 s)
    #[arg(long = "for", value_name = "TIME", value_parser = for_time)]
    pub(super) time: Option<Duration>,
    #[command(flatten)]
    pub(super) bus: BusArgs,
}

#[derive(Debug, Args)]
pub(in crate::cli) struct DumpArgs {
    /// The bag: a folder, its metadata.yaml, or a file of it
    pub(super) bag: PathBuf,
    /// Only frames of this bus, by its name in the cell
    #[arg(long, value_name = "NAME")]
    pub(super) bus: Option<String>,
    /// Only frames of this node, and to it (1 to 127)
    #[arg(long, value_parser = node)]
    pub(super) node: Option<NodeId>,
    /// Names and types of the objects of --node; goes before the one of the cell
    #[arg(long, value_name = "FILE", requires = "node")]
    pub(super) eds: Option<PathBuf>,
    /// The cell, with its EDS files beside it; left out: the one that is attached, with its files in this folder
    #[arg(long, value_name = "CELL.yaml")]
    pub(super) cell: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(in crate::cli) struct ConfigureArgs {
    /// The node (1 to 127)
    #[arg(value_parser = node)]
    pub(super) node: NodeId,
    /// The configuration: the objects that have a ParameterValue, without those that act and setpoints
    #[arg(long, value_name = "FILE")]
    pub(super) dcf: PathBuf,
    /// Tell the device to keep it ("save" to 1010h:01)
    #[arg(long)]
    pub(super) store: bool,
    #[command(flatten)]
    pub(super) bus: BusArgs,
}

/// One device or all devices.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::cli) enum Target {
    One(NodeId),
    All,
}

/// Commands of network management.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(in crate::cli) enum NmtArg {
    /// To operational: process data may go
    Start,
    /// To stopped: only network management and heartbeat
    Stop,
    /// To pre-operational: no process data
    PreOperational,
    /// Boot the device anew
    ResetNode,
    /// Boot its communication anew
    ResetCommunication,
}

impl From<NmtArg> for NmtCommand {
    fn from(argument: NmtArg) -> Self {
        match argument {
            NmtArg::Start => Self::Start,
            NmtArg::Stop => Self::Stop,
            NmtArg::PreOperational => Self::EnterPreOperational,
            NmtArg::ResetNode => Self::ResetNode,
            NmtArg::ResetCommunication => Self::ResetCommunication,
        }
    }
}

/// Returns the parser of data types by name.
fn data_type() -> impl TypedValueParser<Value = DataType> {
    PossibleValuesParser::new(type_name::names()).try_map(|name| type_name::named(&name).ok_or("no type"))
}

fn node(text: &str) -> Result<NodeId, String> {
    let number = text.parse().ok().and_then(NodeId::new);
    number.ok_or_else(|| format!("{text:?} is no node; 1 to {} is allowed", NodeId::MAX))
}

fn target(text: &str) -> Result<Target, String> {
    match text {
        "all" => Ok(Target::All),
        number => node(number).map(Target::One).map_err(|sentence| format!("{sentence}, or all")),
    }
}

fn bit_rate(text: &str) -> Result<u32, String> {
    let (least, most) = BIT_RATES;
    let rate = text.parse().ok().filter(|rate| (least..=most).contains(rate));
    rate.ok_or_else(|| format!("{text:?} is no bit rate; {least} to {most} bit/s is allowed, without a unit"))
}

/// Parses the baud rate of a serial line.
fn baudrate(text: &str) -> Result<u32, String> {
    let rate = text.parse().ok().filter(|rate| BAUD_RATES.contains(rate));
    rate.ok_or_else(|| {
        let rates: Vec<_> = BAUD_RATES.iter().map(u32::to_string).collect();
        format!("{text:?} is no baud rate of a serial line; {} bit/s are allowed, without a unit", rates.join(", "))
    })
}

/// Parses a bit rate; returns its index.
fn lss_bit_rate(text: &str) -> Result<u8, String> {
    let rate = text.parse().ok().and_then(lss::bit_rate);
    rate.ok_or_else(|| {
        let rates: Vec<_> = lss::bit_rates().map(|rate| rate.to_string()).collect();
        format!("{text:?} is no bit rate of LSS; {} bit/s are allowed, without a unit", rates.join(", "))
    })
}

/// Parses a number of 32 bits: decimal, or hexadecimal such as 0xFB or FBh.
fn number(text: &str) -> Result<u32, String> {
    let lower = text.to_ascii_lowercase();
    let digits = lower.strip_prefix("0x").or_else(|| lower.strip_suffix('h'));
    let read = match digits {
        Some(digits) if !digits.starts_with('+') => u32::from_str_radix(digits, 16).ok(),
        Some(_) => None,
        None => lower.parse().ok(),
    };
    read.ok_or_else(|| format!("{text:?} is no number; 0 to 4294967295 is allowed, or 0x0 to 0xFFFFFFFF"))
}

fn timeout(text: &str) -> Result<Duration, String> {
    within(text, (0.01, 60.0), "10 ms to 60 s")
}

fn for_time(text: &str) -> Result<Duration, String> {
    within(text, (0.001, 86_400.0), "1 ms to 86400 s")
}

#[cfg(test)]
mod tests;
