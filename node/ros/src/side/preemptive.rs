//! Preemptive ACKNACKs: requests the samples of a Fast DDS writer as soon as our library has matched it.
//!
//! If a client has matched the service before the library (0.15.1) has matched the client, its request is lost, because the library has not
//! discovered the writer yet. The library then sends an ACKNACK with base 1, and Fast DDS waits for its heartbeat period (3 s). Fast DDS
//! answers an ACKNACK with base 0 at once. But it ignores ACKNACKs of a reader whose counts do not rise, also those that the library sends
//! after ours.
//!
//! Sequence  at a match of one of our readers with a Fast DDS writer, except built-in endpoints: 1. send our library a HEARTBEAT without
//!           samples and with count 1, in the name of the writer; the answer goes to our socket. If the library has already received
//!           messages of the writer, whose counts start with 1, it ignores this HEARTBEAT, and no sample is missing 2. the count of the
//!           library's answer is not used elsewhere. Send the writer an ACKNACK with base 0 and this count. The writer answers with a
//!           HEARTBEAT with a count of at least 2
//! Waits     50 ms before step 1 if the writer is latched: its first HEARTBEAT may be in transit, and would be ignored after ours

use std::collections::HashMap;
use std::sync::{Mutex, MutexGuard, PoisonError, Weak};
use std::time::Duration;

use tokio::net::UdpSocket;
use tokio::sync::oneshot;
use tokio::time::{sleep, timeout};

use super::guid::Guid;
use super::member::Shared;
use super::rtps::{AckNack, Acknowledged, Message, entity, read_acknack};

/// Maximum time until the first HEARTBEAT of a latched writer.
const FIRST_HEARTBEAT: Duration = Duration::from_millis(50);
/// Maximum time until the answer of our library.
const PATIENCE: Duration = Duration::from_secs(1);
/// Pause after an error of the socket.
const PAUSE: Duration = Duration::from_millis(100);
/// Maximum length of a datagram that is read, in bytes: ACKNACKs are short.
const DATAGRAM: usize = 512;

/// Tasks that wait for an answer of our library, by reader and writer.
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
            // Fails if the wait has timed out.
            let _ = waiting.send(answer.count);
        }
    }
}

/// Reads the answers of our library.
pub(super) async fn listen(socket: UdpSocket, shared: Weak<Shared>) {
    let mut buffer = [0; DATAGRAM];
    loop {
        let Ok(length) = socket.recv(&mut buffer).await else {
            // A datagram was sent to a closed port. The pause limits the load if the socket fails permanently.
            sleep(PAUSE).await;
            continue;
        };
        let Some(shared) = shared.upgrade() else { return };
        if let Some(answer) = read_acknack(&buffer[..length]) {
            shared.answers.came(answer);
        }
    }
}

/// Requests the samples that our reader has missed from a writer, if our library has not received any message of the writer yet.
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
