//! Sends ACKNACKs to our own DDS library in the name of a remote reader.
//!
//! The DDS library (0.15.1) keeps a sample of a reliable writer until each reader has acknowledged it. Best-effort readers never
//! acknowledge: if a writer has a best-effort and a reliable reader, the library would keep all samples. The library also sends a
//! sample that was written to one single reader to readers that join later, if the sample fits into one datagram.

use std::sync::Weak;
use std::sync::atomic::{AtomicI32, Ordering};
use std::time::Duration;

use tokio::time::sleep;

use super::guid::Guid;
use super::member::Shared;
use super::rtps::{AckNack, Message, entity};

/// Period of the acknowledgements for best-effort readers.
const PERIOD: Duration = Duration::from_secs(1);

/// Count of the next ACKNACK. The library ignores an ACKNACK with the same count as the one before. Readers count upwards from 0, so
/// this counts downwards.
static COUNT: AtomicI32 = AtomicI32::new(-1);

/// Acknowledges all samples of `writer` before this number in the name of `reader`. All of these samples must have been written.
pub(super) fn acknowledge(shared: &Shared, reader: Guid, writer: Guid, before: i64) {
    let mut message = Message::from(reader.prefix());
    let count = COUNT.fetch_sub(1, Ordering::Relaxed);
    let ack = AckNack { reader: entity(reader), writer: entity(writer), base: before, count, is_final: true };
    message.to(writer.prefix()).acknack(&ack);
    shared.socket.send(&message.bytes(), shared.participant.data_address());
}

/// Acknowledges all samples periodically, in the name of all best-effort readers.
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
