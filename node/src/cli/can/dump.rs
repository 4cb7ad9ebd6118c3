//! `lineshaft can dump`.
//!
//! Law      frames are printed in the order of the bag, each with its time since the first cycle of the bag
//! Reads    a bag; the given cell, otherwise the attached one
//! Refuses  bags without frames, and buses that the bag lacks; the error message lists its buses

use super::Failure;
use super::args::DumpArgs;
use super::monitor::{carry, told};
use crate::cell::{Cell, device_file, passed_over};
use crate::cli::warn;
use crate::output;
use crate::recording::clean::clean;
use crate::recording::run::{Message, Run, RunError};
use crate::recording::{FrameDirection, attached_files};
use lineshaft_can::commission::Decoder;
use lineshaft_can::{Frame, Id};
use lineshaft_core::unit::excerpt;
use lineshaft_msgs::Message as _;
use lineshaft_msgs::foreign::can_msgs::msg::Frame as Told;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// Maximum number of names in a message.
const MOST_NAMES: usize = 20;

impl From<RunError> for Failure {
    fn from(error: RunError) -> Self {
        Self::Usage(error.to_string())
    }
}

/// Bus and direction of a topic of frames.
struct Topic<'a> {
    bus: &'a str,
    way: FrameDirection,
}

impl<'a> Topic<'a> {
    /// Parses a topic name such as `/lineshaft/can/bus0/sent`.
    fn of(name: &'a str) -> Option<Self> {
        let (before, last) = name.rsplit_once('/')?;
        let way = FrameDirection::ALL.into_iter().find(|way| way.name() == last)?;
        let (before, bus) = before.rsplit_once('/')?;
        before.ends_with("/can").then_some(Self { bus, way })
    }
}

pub(super) fn dump(args: &DumpArgs) -> Result<(), Failure> {
    let mut run = Run::open(&args.bag)?;
    let (mut decoders, other) = decoders(args, &run)?;
    let (mut topics, mut buses, mut begin) = (BTreeSet::new(), BTreeSet::new(), None);
    while let Some(message) = run.next_message()? {
        let begin = *begin.get_or_insert(message.log_time);
        let topic = Topic::of(message.topic).filter(|_| message.kind == Told::NAME);
        if !topics.contains(message.topic) {
            topics.insert(message.topic.to_owned());
            buses.extend(topic.as_ref().map(|topic| topic.bus.to_owned()));
        }
        let Some(Topic { bus, way }) = topic.filter(|topic| args.bus.as_deref().is_none_or(|name| name == topic.bus))
        else {
            continue;
        };
        let (stamp_ns, frame) = frame(&message)?;
        let Some(frame) = frame else { continue };
        if !decoders.contains_key(bus) {
            decoders.insert(bus.to_owned(), other.clone());
        }
        let Some(decoder) = decoders.get_mut(bus) else { continue };
        // Frames of other nodes may belong to the same exchange even if they are not printed.
        let words = decoder.words(&frame);
        if args.node.is_some_and(|node| !decoder.is_of_node(&frame, node)) {
            continue;
        }
        let since_s = (i128::from(stamp_ns) - i128::from(begin)) as f64 * 1e-9;
        let (bus, way, told) = (clean(bus), way.name(), told(&frame, &words));
        if !output::print_line(&format_args!("{since_s:12.6}  {bus}  {way:8}  {told}")) {
            return Ok(());
        }
    }
    // A damaged file ends early.
    for cut in run.cuts() {
        eprintln!("note: {}", clean(&cut.to_string()));
    }
    let bag = args.bag.display().to_string();
    match &args.bus {
        _ if buses.is_empty() => Err(Failure::Usage(format!(
            "{}: it has no frames of CAN, topics ../can/BUS/sent and ../received of {}; its topics are {}",
            clean(&bag),
            Told::NAME,
            listed(&topics)
        ))),
        Some(name) if !buses.contains(name) => Err(Failure::Usage(format!(
            "--bus: {} has no frames of bus {name:?}; {} is allowed",
            clean(&bag),
            listed(&buses)
        ))),
        _ => Ok(()),
    }
}

/// Lists names for a message.
fn listed(names: &BTreeSet<String>) -> String {
    let mut listed: Vec<_> = names.iter().take(MOST_NAMES).map(|name| clean(&excerpt(name)).into_owned()).collect();
    if names.len() > MOST_NAMES {
        listed.push(format!("and {} more", names.len() - MOST_NAMES));
    }
    if listed.is_empty() { "none".to_owned() } else { listed.join(", ") }
}

/// Returns a frame and its time, in ns; no frame if CANopen does not use this kind.
fn frame(message: &Message<'_>) -> Result<(u64, Option<Frame>), Failure> {
    let sentence =
        |reason| Failure::Usage(format!("{} at {} ns: {reason}", clean(&excerpt(message.topic)), message.log_time));
    let told: Told = message.decode().map_err(sentence)?;
    let stamp = &told.header.stamp;
    let stamp_ns =
        u64::try_from(stamp.sec).unwrap_or(0).saturating_mul(1_000_000_000).saturating_add(stamp.nanosec.into());
    let id =
        u16::try_from(told.id).ok().and_then(|id| Id::new(id).ok()).filter(|_| !told.is_extended && !told.is_error);
    let frame = id.and_then(|id| match told.is_rtr {
        true => Frame::remote(id, told.dlc).ok(),
        false => Frame::data(id, told.data.get(..usize::from(told.dlc))?).ok(),
    });
    Ok((stamp_ns, frame))
}

/// Returns a decoder with the known devices of each bus, and one for buses without a cell.
fn decoders(args: &DumpArgs, run: &Run) -> Result<(BTreeMap<String, Decoder>, Decoder), Failure> {
    let mut decoders = match &args.cell {
        Some(path) => {
            let cell = Cell::load(path).map_err(|problems| problems.to_string().trim_end().to_owned());
            cell.and_then(|cell| of_cell(&cell, path)).map_err(Failure::Usage)?
        }
        None => attached(run)?,
    };
    let mut other = Decoder::default();
    if let (Some(node), Some(path)) = (args.node, &args.eds) {
        let dictionary = device_file("--eds", path, node).map_err(Failure::Usage)?;
        warn(passed_over("--eds", path, &dictionary, &[]));
        decoders.values_mut().chain([&mut other]).for_each(|decoder| decoder.add_dictionary(node, dictionary.clone()));
    }
    Ok((decoders, other))
}

/// Returns the decoders of the cell attached to the bag, with the device files that exist here.
fn attached(run: &Run) -> Result<BTreeMap<String, Decoder>, Failure> {
    let text = run.attachment("cell.yaml")?.and_then(|bytes| String::from_utf8(bytes).ok());
    let files = attached_files(run)?;
    let cell = text.and_then(|text| Cell::parse_recorded("cell.yaml", text, files.as_deref()).ok());
    let known = cell.map(|cell| of_cell(&cell, Path::new("cell.yaml")));
    Ok(match known {
        Some(Ok(decoders)) => decoders,
        Some(Err(sentence)) => {
            let first = sentence.lines().next().unwrap_or_default();
            eprintln!(
                "note: what PDOs carry is not told; --cell names the cell where its EDS files are: {}",
                clean(first)
            );
            BTreeMap::new()
        }
        None => BTreeMap::new(),
    })
}

fn of_cell(cell: &Cell, path: &Path) -> Result<BTreeMap<String, Decoder>, String> {
    let found = cell.on_can().buses_and_warnings(Some(path));
    let (buses, warnings) = found.map_err(|problems| problems.to_string().trim_end().to_owned())?;
    warn(warnings);
    let of = |bus: lineshaft_can::config::BusConfig| {
        let mut decoder = Decoder::default();
        bus.devices.iter().for_each(|device| carry(&mut decoder, device));
        for (node, dictionary) in cell.on_can().dictionaries(&bus.name, path)? {
            decoder.add_dictionary(node, dictionary);
        }
        Ok((bus.name, decoder))
    };
    buses.into_iter().map(of).collect()
}
