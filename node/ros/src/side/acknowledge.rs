//! ACKNACKs to our own library in the name of a remote reader.
//!
//! The DDS library (0.15.1) keeps a sample of a reliable writer until each reader has acknowledged it. Best-effort readers never do: with
//! one of them and a reliable one next to it, all samples would be kept. Nor does it ask whether a sample was written to one reader
//! before it sends it to a later one, as long as it fits a datagram.

use std::sync::Weak;
use std::sync::atomic::{AtomicI32, Ordering};
use std::time::Duration;

use tokio::time::sleep;

use super::member::Shared;
use super::rtps::{AckNack, Message, entity};
use crate::link::guid::Guid;

/// Between two acknowledgements of best-effort readers.
const PERIOD: Duration = Duration::from_secs(1);

/// Of two ACKNACKs in a row with one count the library ignores the second. Those of readers count upwards from 0.
static COUNT: AtomicI32 = AtomicI32::new(-1);

/// Has the library take for acknowledged by `reader` all samples of `writer` before this number, each of which must have been written.
pub(super) fn acknowledge(shared: &Shared, reader: Guid, writer: Guid, before: i64) {
    let mut message = Message::from(reader.prefix());
    let count = COUNT.fetch_sub(1, Ordering::Relaxed);
    let ack = AckNack { reader: entity(reader), writer: entity(writer), base: before, count, is_final: true };
    message.to(writer.prefix()).acknack(&ack);
    shared.socket.send(&message.bytes(), shared.participant.data_address());
}

/// Acknowledges for all best-effort readers.
pub(super) async fn for_best_effort_readers(shared: Weak<Shared>) {
    loop {
        sleep(PERIOD).await;
        let Some(shared) = shared.upgrade() else { return };
        for (writer, last) in shared.participant.written() {
            for reader in shared.matches.best_effort(writer) {
                acknowledge(&shared, reader, writer, last + 1);
            }
        }
    }
}
