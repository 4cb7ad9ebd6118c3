//! Latched topics: a reader that joins later gets only the newest values.
//!
//! The DDS library keeps all samples of a transient local writer for seconds, or permanently if there is no reader, and sends all of them
//! to each reader that joins later. So samples are written to single readers (`keeper`). When a reader joins, an ACKNACK to the library
//! acknowledges the earlier samples in the name of that reader.

use std::net::SocketAddrV4;
use std::sync::Arc;
use std::time::Duration;

use bytes::Bytes;
use tokio::runtime::Handle;
use tokio::sync::mpsc::{self, UnboundedReceiver, UnboundedSender};
use tokio::time::{Instant, sleep_until};

use super::acknowledge::acknowledge;
use super::dds::{Address, Writer};
use super::guid::Guid;
use super::keeper::{Keeper, Target};
use super::matches::Matches;
use super::member::Shared;
use super::rtps::{Message, entity};
use crate::link::protocol::ReplyFailure;
use crate::link::qos::Qos;

/// Time between two attempts to write.
const RETRY: Duration = Duration::from_millis(10);

/// A writer, with the shared state that sends its GAPs and ACKNACKs.
pub(super) struct DirectedWriter {
    pub(super) writer: Writer,
    pub(super) shared: Arc<Shared>,
}

impl Target for DirectedWriter {
    fn write(&self, value: &Bytes, reader: Guid) -> Result<i64, ReplyFailure> {
        self.writer.write_to(value.clone(), Address { reader, answers: None })
    }

    fn is_owed(&self, reader: Guid) -> bool {
        self.shared.participant.keeps_for(reader)
    }

    fn addresses(&self, reader: Guid) -> Vec<SocketAddrV4> {
        self.shared.participant.addresses_of_reader(reader)
    }

    fn skip(&self, reader: Guid, before: i64) {
        let writer = self.writer.guid();
        // First, so that the library does not send the samples of other readers to this one.
        acknowledge(&self.shared, reader, writer, before);
        let mut message = Message::from(writer.prefix());
        message.to(reader.prefix()).gap(entity(reader), entity(writer), 1, before);
        let datagram = message.bytes();
        for address in self.addresses(reader) {
            self.shared.socket.send(&datagram, address);
        }
    }

    fn guid(&self) -> Guid {
        self.writer.guid()
    }
}

/// Sets the value of a latched topic. Dropping it drops the writer.
pub(super) struct Latched {
    values: UnboundedSender<Bytes>,
}

impl Latched {
    /// Starts the task that writes the values. If values are set within `gather` of each other, only the newest ones are written; if
    /// `gather` is zero, each value is written.
    pub(super) fn start(
        runtime: &Handle,
        target: impl Target,
        matches: &Arc<Matches>,
        qos: Qos,
        gather: Duration,
    ) -> Self {
        let (values, receiver) = mpsc::unbounded_channel();
        let matches = Arc::clone(matches);
        let keeper = Keeper::new(target, usize::from(qos.depth), qos.lifespan);
        runtime.spawn(async move { run(receiver, keeper, &matches, gather).await });
        Self { values }
    }

    /// Sets the value; never blocks.
    pub(super) fn set(&self, value: impl Into<Bytes>) {
        // Fails only if the runtime has ended: otherwise the task runs until this sender is dropped.
        let _ = self.values.send(value.into());
    }
}

async fn run<T: Target>(
    mut values: UnboundedReceiver<Bytes>,
    mut keeper: Keeper<T>,
    matches: &Matches,
    gather: Duration,
) {
    let mut changes = matches.changes();
    let mut has_room = true;
    // Time at which the values that were set since the last write are written.
    let mut due = None;
    loop {
        let again = if has_room { keeper.next_repeat() } else { Some(Instant::now() + RETRY) };
        let wake = due.into_iter().chain(again).min();
        // A reader that joins must not wait: the library would send it the samples that it has.
        let is_due = tokio::select! {
            value = values.recv() => {
                let Some(value) = value else { return };
                keeper.set(value, Instant::now());
                due.get_or_insert(Instant::now() + gather);
                gather.is_zero()
            }
            change = changes.changed() => {
                if change.is_err() {
                    return;
                }
                true
            }
            () = sleep_until(wake.unwrap_or_else(Instant::now)), if wake.is_some() => true,
        };
        while let Ok(value) = values.try_recv() {
            keeper.set(value, Instant::now());
        }
        changes.mark_unchanged();
        keeper.matched(&matches.readers(keeper.guid()), Instant::now());
        keeper.repeat_gaps(Instant::now());
        if is_due {
            has_room = keeper.write(Instant::now());
            due = None;
        }
    }
}
