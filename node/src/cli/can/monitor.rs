//! `lineshaft can monitor`.

use super::Failure;
use super::args::MonitorArgs;
use super::open::Known;
use crate::recording::clean::clean;
use lineshaft_can::commission::words::hex;
use lineshaft_can::commission::{Carried, Decoder};
use lineshaft_can::config::DeviceConfig;
use lineshaft_can::drive::layout::Pdo;
use lineshaft_can::eds::{Direction, Mapped};
use lineshaft_can::{Frame, NodeId};
use std::io::Write;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

pub(super) fn monitor(args: &MonitorArgs) -> Result<(), Failure> {
    let mut known = Known::of(&args.bus)?;
    if let Some(node) = args.node {
        known = known.with_eds(node, args.eds.as_deref())?;
    }
    let mut decoder = Decoder::default();
    for device in known.config.iter().flat_map(|config| &config.devices) {
        carry(&mut decoder, device);
    }
    for (node, dictionary) in known.dictionaries() {
        decoder.know(node, dictionary.clone());
    }
    let is_over = until_signal().map_err(|error| Failure::Bus(format!("Ctrl-C cannot be heard: {error}")))?;
    let mut session = known.open()?;
    let begin = session.elapsed();
    let mut out = std::io::stdout().lock();
    session.listen(|now, frame| {
        let since = now.saturating_sub(begin);
        if args.time.is_some_and(|time| since >= time) || is_over.load(Ordering::Relaxed) {
            return false;
        }
        let Some(frame) = frame else { return true };
        // What others have said belongs to an exchange, also where it is not shown.
        let words = decoder.words(frame);
        if args.node.is_some_and(|node| !decoder.concerns(frame, node)) {
            return true;
        }
        let (since_s, told) = (since.as_secs_f64(), told(frame, &words));
        // Whoever reads has seen enough.
        writeln!(out, "{since_s:12.6}  {told}").and_then(|()| out.flush()).is_ok()
    })?;
    Ok(())
}

/// A frame, and what it says.
pub(super) fn told(frame: &Frame, words: &str) -> String {
    let bytes = if frame.is_remote() { format!("R{}", frame.length()) } else { hex(frame.bytes()) };
    format!("{:03X}  {bytes:23}  {}", frame.id().get(), clean(words))
}

/// The PDOs that the cell gives a device.
pub(super) fn carry(decoder: &mut Decoder, device: &DeviceConfig) {
    for pdo in &device.layout.asked {
        decoder.carry(pdo.id, carried(device.node, Direction::Receive, pdo));
    }
    for pdo in &device.layout.told {
        decoder.carry(pdo.id, carried(device.node, Direction::Transmit, pdo));
    }
}

fn carried<W>(node: NodeId, direction: Direction, pdo: &Pdo<W>) -> Carried {
    let mapped = pdo.fields.iter().map(|field| Mapped { object: field.object, bits: field.bits as u8 }).collect();
    Carried { node, direction, number: pdo.number.into(), mapped }
}

/// Becomes true with Ctrl-C, or the signal that ends a service.
pub(super) fn until_signal() -> std::io::Result<Arc<AtomicBool>> {
    use tokio::signal::unix::{SignalKind, signal};
    let is_over = Arc::new(AtomicBool::new(false));
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
    let told = Arc::clone(&is_over);
    // From here on, not from when the thread has its turn.
    let inside = runtime.enter();
    let (mut interrupt, mut terminate) = (signal(SignalKind::interrupt())?, signal(SignalKind::terminate())?);
    drop(inside);
    std::thread::Builder::new().name("signals".to_owned()).spawn(move || {
        runtime.block_on(async {
            tokio::select! {
                _ = interrupt.recv() => {}
                _ = terminate.recv() => {}
            }
        });
        told.store(true, Ordering::Relaxed);
    })?;
    Ok(is_over)
}
