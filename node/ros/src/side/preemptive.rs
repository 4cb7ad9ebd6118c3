//! Preemptive ACKNACKs: a writer of Fast DDS is asked for its samples as soon as our library has matched it.
//!
//! A client that has matched the service before the library (0.15.1) has matched the client loses its request, as the library knows no
//! such writer yet. The library then sends an ACKNACK with base 1, upon which Fast DDS waits for its heartbeat period (3 s). It answers
//! one with base 0 at once, but of each reader it takes only ACKNACKs whose counts rise, also those of the library after ours.
//!
//! Sequence  on a match of a reader of ours with a writer of Fast DDS, without built-in ones:
//!           1. our library is sent a HEARTBEAT of no samples, count 1, as if the writer had sent it, to be answered to a socket of ours.
//!              If the library has heard the writer by now, whose counts begin with 1, it ignores that, and nothing is missing
//!           2. the count of its answer is used by nothing else: an ACKNACK with base 0 and this count goes to the writer,
//!              which answers by a HEARTBEAT with a count of at least 2
//! Waits     a moment before that where the writer is latched: its first HEARTBEAT may be on its way, and would be ignored after ours

use std::collections::HashMap;
use std::sync::{Mutex, MutexGuard, PoisonError, Weak};
use std::time::Duration;

use tokio::net::UdpSocket;
use tokio::sync::oneshot;
use tokio::time::{sleep, timeout};

use super::member::Shared;
use super::rtps::{AckNack, Acknowledged, Message, entity, read_acknack};
use crate::link::guid::Guid;

/// How long the first HEARTBEAT of a latched writer may take.
const FIRST_HEARTBEAT: Duration = Duration::from_millis(50);
/// How long our library may take for its answer.
const PATIENCE: Duration = Duration::from_secs(1);
/// After an error of the socket.
const PAUSE: Duration = Duration::from_millis(100);
/// Longest datagram that is read: ACKNACKs are short.
const DATAGRAM: usize = 512;

/// Who waits for an answer of our library, by reader and writer.
#[derive(Default)]
pub(super) struct Answers {
    waiting: Mutex<HashMap<(Guid, Guid), oneshot::Sender<i32>>>,
}

impl Answers {
    fn waiting(&self) -> MutexGuard<'_, HashMap<(Guid, Guid), oneshot::Sender<i32>>> {
        self.waiting.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn expect(&self, reader: Guid, writer: Guid) -> oneshot::Receiver<i32> {
        let (sender, receiver) = oneshot::channel();
        self.waiting().insert((reader, writer), sender);
        receiver
    }

    fn forget(&self, reader: Guid, writer: Guid) {
        self.waiting().remove(&(reader, writer));
    }

    fn came(&self, answer: Acknowledged) {
        if let Some(waiting) = self.waiting().remove(&(answer.reader, answer.writer)) {
            // It may have lost its patience.
            let _ = waiting.send(answer.count);
        }
    }
}

/// Reads the answers of our library.
pub(super) async fn listen(socket: UdpSocket, shared: Weak<Shared>) {
    let mut buffer = [0; DATAGRAM];
    loop {
        let Ok(length) = socket.recv(&mut buffer).await else {
            // A closed port was written to. A socket that has failed must not take all the time.
            sleep(PAUSE).await;
            continue;
        };
        let Some(shared) = shared.upgrade() else { return };
        if let Some(answer) = read_acknack(&buffer[..length]) {
            shared.answers.came(answer);
        }
    }
}

/// Asks a writer for what our reader has missed, if our library has not heard of it yet.
pub(super) async fn ask(shared: Weak<Shared>, reader: Guid, writer: Guid) {
    if shared.upgrade().is_some_and(|shared| shared.participant.is_latched_writer(writer)) {
        sleep(FIRST_HEARTBEAT).await;
    }
    let Some(answer) = shared.upgrade().map(|shared| heartbeat(&shared, reader, writer)) else { return };
    let count = timeout(PATIENCE, answer).await;
    let Some(shared) = shared.upgrade() else { return };
    match count {
        Ok(Ok(count)) => acknack(&shared, reader, writer, count),
        Ok(Err(_)) | Err(_) => shared.answers.forget(reader, writer),
    }
}

/// Step 1.
fn heartbeat(shared: &Shared, reader: Guid, writer: Guid) -> oneshot::Receiver<i32> {
    let answer = shared.answers.expect(reader, writer);
    let mut message = Message::from(writer.prefix());
    message.to(reader.prefix()).reply_to(shared.socket.address());
    message.empty_heartbeat(entity(reader), entity(writer), 1);
    shared.socket.send(&message.bytes(), shared.participant.data_address());
    answer
}

/// Step 2.
fn acknack(shared: &Shared, reader: Guid, writer: Guid, count: i32) {
    let mut message = Message::from(reader.prefix());
    let ack = AckNack { reader: entity(reader), writer: entity(writer), base: 0, count, is_final: false };
    message.to(writer.prefix()).acknack(&ack);
    let datagram = message.bytes();
    for address in shared.participant.addresses_of_writer(writer) {
        shared.socket.send(&datagram, address);
    }
}
