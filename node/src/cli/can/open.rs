//! Opens the bus that a command names, and collects the descriptions of its devices.

use super::Failure;
use super::args::BusArgs;
use crate::cell::{Cell, device_file, passed_over};
use crate::cli::warn;
use crate::recording::clean::clean;
use lineshaft_can::NodeId;
use lineshaft_can::commission::{self, ObjectError, Session};
use lineshaft_can::config::BusConfig;
use lineshaft_can::eds::{Dictionary, FindError};
use lineshaft_can::transport::{Address, OpenFailure, Options, open};
use lineshaft_cia402::object::Object;
use std::collections::BTreeMap;
use std::path::Path;
use std::time::Duration;

/// Default bit rate, in bit/s.
pub(super) const BIT_RATE: u32 = 1_000_000;
/// Default timeout if no cell is given either.
const TIMEOUT: Duration = Duration::from_millis(500);
/// Minimum similarity of a name that is suggested.
const LIKE: f64 = 0.85;

/// A bus that is known but not open yet.
#[derive(Debug)]
pub(super) struct Known {
    address: Address,
    /// Bit rate, in bit/s.
    pub(super) bit_rate: u32,
    /// Baud rate of the serial line, in bit/s.
    baud: Option<u32>,
    timeout: Duration,
    /// Configuration of the bus, if a cell was given.
    pub(super) config: Option<BusConfig>,
    dictionaries: BTreeMap<NodeId, Dictionary>,
}

impl Known {
    /// Creates the bus from the arguments; reads the files and prints their warnings.
    pub(super) fn of(args: &BusArgs) -> Result<Self, Failure> {
        let Some(path) = &args.cell else {
            // The parser of arguments requires one of them.
            let address = args.bus.clone().ok_or_else(|| Failure::Usage("give --bus or --cell".to_owned()))?;
            if args.serial_baudrate.is_some() && !matches!(address, Address::Slcan(_)) {
                let sentence = format!("--serial-baudrate is for a serial line, --bus slcan:PATH, not for {address}");
                return Err(Failure::Usage(sentence));
            }
            return Ok(Self {
                address,
                bit_rate: args.bitrate.unwrap_or(BIT_RATE),
                baud: args.serial_baudrate,
                timeout: args.timeout.unwrap_or(TIMEOUT),
                config: None,
                dictionaries: BTreeMap::new(),
            });
        };
        let cell = Cell::load(path).map_err(Failure::Problems)?;
        let (buses, warnings) = cell.on_can().buses_and_warnings(Some(path)).map_err(Failure::Problems)?;
        warn(warnings);
        let config = chosen(buses, args.backend.as_deref(), path)?;
        let dictionaries = cell.on_can().dictionaries(&config.name, path).map_err(Failure::Usage)?;
        Ok(Self {
            address: config.transport.clone(),
            bit_rate: config.bit_rate.unwrap_or(BIT_RATE),
            baud: config.serial_baudrate,
            timeout: args.timeout.unwrap_or(Duration::from_nanos(config.sdo_timeout_ns)),
            config: Some(config),
            dictionaries,
        })
    }

    /// Adds the object dictionary of a node from the file given for it.
    pub(super) fn with_eds(mut self, node: NodeId, eds: Option<&Path>) -> Result<Self, Failure> {
        if let Some(path) = eds {
            let dictionary = device_file("--eds", path, node).map_err(Failure::Usage)?;
            warn(passed_over("--eds", path, &dictionary, &[]));
            self.dictionaries.insert(node, dictionary);
        }
        Ok(self)
    }

    /// Returns the object dictionary of a node.
    pub(super) fn dictionary(&self, node: NodeId) -> Option<&Dictionary> {
        self.dictionaries.get(&node)
    }

    /// Returns all object dictionaries.
    pub(super) fn dictionaries(&self) -> impl Iterator<Item = (NodeId, &Dictionary)> {
        self.dictionaries.iter().map(|(node, dictionary)| (*node, dictionary))
    }

    /// Returns the object that a text names.
    pub(super) fn object(&self, node: NodeId, text: &str) -> Result<Object, Failure> {
        let dictionary = self.dictionary(node);
        commission::object(text, dictionary).map_err(|error| {
            let like = match (&error, dictionary) {
                (ObjectError::Find(FindError::None(name)), Some(dictionary)) => like(name, dictionary),
                _ => None,
            };
            let hint = like.map_or_else(String::new, |name| format!("; {name:?} is like it"));
            Failure::Usage(format!("{error}{hint}"))
        })
    }

    /// Opens the bus.
    pub(super) fn open(&self) -> Result<Session, Failure> {
        let options = Options { bit_rate: self.bit_rate, baud: self.baud };
        match open(&self.address, options) {
            Ok(transport) => Ok(Session::new(transport, self.timeout)),
            Err(error) if matches!(error.failure, OpenFailure::BitRate(_)) => Err(Failure::Usage(error.to_string())),
            Err(error) => Err(Failure::Bus(error.to_string())),
        }
    }
}

pub(super) fn chosen(mut buses: Vec<BusConfig>, name: Option<&str>, path: &Path) -> Result<BusConfig, Failure> {
    let names = buses.iter().map(|bus| bus.name.as_str()).collect::<Vec<_>>().join(", ");
    let file = clean(&path.display().to_string()).into_owned();
    let place = match name {
        _ if buses.is_empty() => return Err(Failure::Usage(format!("{file} has no backend on CAN"))),
        Some(name) => buses.iter().position(|bus| bus.name == name).ok_or_else(|| {
            Failure::Usage(format!("--backend: {file} has no backend {name:?} on CAN; {names} is allowed"))
        })?,
        None if buses.len() > 1 => {
            return Err(Failure::Usage(format!("{file} has several backends on CAN; name one by --backend: {names}")));
        }
        None => 0,
    };
    Ok(buses.swap_remove(place))
}

/// Returns the most similar object name.
fn like(name: &str, dictionary: &Dictionary) -> Option<String> {
    let wanted = name.to_lowercase();
    let names = dictionary.entries().filter_map(|(object, _)| dictionary.name(object));
    let rated = names.map(|name| (strsim::jaro_winkler(&wanted, &name.to_lowercase()), name));
    let best = rated.max_by(|(one, _), (other, _)| one.total_cmp(other))?;
    (best.0 >= LIKE).then_some(best.1)
}
